// The job as it will stand on the platform: its outer faces, cut at a layer whose image is shown on the cut; and a
// marker for each finding of the slicer.
import { useEffect, useRef, useState } from 'preact/hooks';
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { fitTo } from '../fit_to';
import { Icon } from '../icons';
import { placeLabels, type Label } from '../labels';
import { orbitHelp, orbitKeys, turnAround } from '../orbit_keys';
import { partOf, type Part } from '../print/part';
import { PartMesh } from '../print/part_mesh';
import { api, say } from '../store';
import { theme } from '../theme';
import type { Job } from '../types';
import { AxesCorner, turnAxes } from './axes_corner';
import { goal, layer, load } from './layers';
import { disposePlatform, platformMesh } from './platform';

const mostMarks = 40;
type Issue = Job['issues'][number];
const isMarked = (issue: Issue) => issue.row !== undefined && issue.layer >= 0;

/// Bounding rows and columns of the part, in pixels.
function boundsOf(part: Part) {
  const box = { x0: Infinity, y0: Infinity, x1: 0, y1: 0 };
  for (const { runs } of part.slabs)
    for (let r = 0; r < runs.length; r += 3) {
      box.y0 = Math.min(box.y0, runs[r + 1] * part.cell_px);
      box.y1 = Math.max(box.y1, (runs[r + 1] + 1) * part.cell_px);
      box.x0 = Math.min(box.x0, (runs[r + 2] & 0xffff) * part.cell_px);
      box.x1 = Math.max(box.x1, (runs[r + 2] >>> 16) * part.cell_px);
    }
  return box;
}

/// The layer in its materials' colours, within `box`.
function sheetCanvas(job: Job, images: (ImageData | null)[], { x0, y0, x1, y1 }: ReturnType<typeof boundsOf>) {
  const shrink = Math.max(1, Math.ceil(Math.max(x1 - x0, y1 - y0) / 1024));
  const canvas = document.createElement('canvas');
  canvas.width = Math.max(1, Math.ceil((x1 - x0) / shrink));
  canvas.height = Math.max(1, Math.ceil((y1 - y0) / shrink));
  const g = canvas.getContext('2d')!;
  const data = g.createImageData(canvas.width, canvas.height);
  images.forEach((image, m) => {
    if (!image) return;
    const n = parseInt(job.colours[m].slice(1), 16);
    for (let y = 0; y < canvas.height; ++y)
      for (let x = 0; x < canvas.width; ++x) {
        const from = 4 * (Math.min(y0 + y * shrink, image.height - 1) * image.width + Math.min(x0 + x * shrink, image.width - 1));
        if (image.data[from] >= 128) data.data.set([n >> 16, (n >> 8) & 255, n & 255, 255], 4 * (y * canvas.width + x));
      }
  });
  g.putImageData(data, 0, 0);
  return canvas;
}

class StackView {
  private readonly renderer: THREE.WebGLRenderer;
  private readonly world = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(32, 1, 1, 5000);
  private readonly controls: OrbitControls;
  private readonly mesh: PartMesh;
  private readonly pivot = new THREE.Group(); // the part is shown upright, but modelled as it hangs
  private readonly resize: ResizeObserver;
  private readonly sheet: THREE.Mesh;
  private readonly platform: THREE.Group;
  private readonly keys: (e: KeyboardEvent) => void;
  private bounds = { x0: 0, y0: 0, x1: 1, y1: 1 };
  private labels: Label[] = [];
  private frame = 0;
  private sized = false; // the window size is known

  constructor(private readonly canvas: HTMLCanvasElement, private readonly axes: SVGSVGElement, private readonly job: Job) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.camera.up.set(0, 0, 1);
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x8a8f98, 1.9));
    const key = new THREE.DirectionalLight(0xffffff, 1.6);
    key.position.set(-1, -2, 3);
    this.world.add(key);
    this.mesh = new PartMesh(job.projector, job.colours.map((c) => new THREE.Color(c)));
    this.pivot.scale.z = -1;
    this.pivot.add(this.mesh.group);
    this.world.add(this.pivot);
    const { width_mm, depth_mm } = job.platform;
    this.platform = platformMesh(width_mm, depth_mm);
    this.world.add(this.platform);
    this.sheet = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), new THREE.MeshBasicMaterial({ alphaTest: 0.5, side: THREE.DoubleSide }));
    this.sheet.visible = false;
    this.mesh.group.add(this.sheet);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.draw());
    this.keys = (e) => orbitKeys(e, (around, up, nearer) => turnAround(this.camera, this.controls, around, up, nearer), () => this.home());
    canvas.addEventListener('keydown', this.keys);
    this.resize = new ResizeObserver(() => this.fit());
    this.resize.observe(canvas.parentElement!);
  }

  show(part: Part) {
    this.mesh.show(part);
    this.bounds = boundsOf(part);
    this.home();
  }

  mark(labels: { element: HTMLElement; issue: Issue }[]) {
    this.world.updateMatrixWorld(true);
    this.labels = labels.map(({ element, issue }) => {
      const z = this.job.manifest.layers[Math.min(issue.layer, this.job.manifest.layers.length - 1)].z_um / 1000;
      return { element, at: this.mesh.group.localToWorld(this.mesh.placeOf(issue.row!, issue.column ?? 0, z)) };
    });
    this.draw();
  }

  /// Hides everything above this height; null: nothing.
  cut(z_mm: number | null) {
    this.renderer.clippingPlanes = z_mm === null ? [] : [new THREE.Plane(new THREE.Vector3(0, 0, -1), z_mm + 1e-3)];
    this.sheet.visible = false;
    this.draw();
  }

  /// Sets the image of the layer at the cut.
  lay(images: (ImageData | null)[], z_mm: number) {
    const material = this.sheet.material as THREE.MeshBasicMaterial;
    material.map?.dispose();
    const texture = new THREE.CanvasTexture(sheetCanvas(this.job, images, this.bounds));
    texture.colorSpace = THREE.SRGBColorSpace;
    texture.magFilter = THREE.NearestFilter;
    material.map = texture;
    material.needsUpdate = true;
    const [a, b] = [this.mesh.placeOf(this.bounds.y0, this.bounds.x0, z_mm), this.mesh.placeOf(this.bounds.y1, this.bounds.x1, z_mm)];
    this.sheet.position.copy(a).add(b).multiplyScalar(0.5);
    // The image's columns run along +x of the plane, its rows along -y.
    this.sheet.scale.set(b.x - a.x, a.y - b.y, 1);
    this.sheet.visible = true;
    this.draw();
  }

  private home() {
    const box = this.mesh.box;
    if (box.isEmpty()) return;
    const size = box.getSize(new THREE.Vector3());
    const far = size.length();
    this.pivot.updateMatrixWorld(true);
    const centre = this.mesh.group.localToWorld(box.getCenter(new THREE.Vector3()));
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).add(new THREE.Vector3(0.6, -1.5, 0.9).multiplyScalar(1.1 * far * Math.max(1, 1.4 / this.camera.aspect)));
    this.controls.update();
    this.draw();
  }

  private fit() {
    if (!fitTo(this.canvas, this.renderer, this.camera)) return;
    if (!this.sized) this.home();
    this.sized = true;
    this.draw();
  }

  private draw() {
    if (this.frame) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.renderer.render(this.world, this.camera);
      turnAxes(this.axes, this.camera);
      placeLabels(this.labels, this.camera, this.canvas.clientWidth, this.canvas.clientHeight);
    });
  }

  dispose() {
    cancelAnimationFrame(this.frame);
    this.canvas.removeEventListener('keydown', this.keys);
    this.resize.disconnect();
    this.mesh.dispose();
    disposePlatform(this.platform);
    this.controls.dispose();
    this.renderer.dispose();
  }
}

/// Markers are buttons that open the layer and pixel.
function Marks({ issues, marks, open }: { issues: Issue[]; marks: { current: (HTMLElement | null)[] }; open: () => void }) {
  return (
    <div class="marks">
      {issues.map((issue, k) => (
        <button
          key={k}
          class={`mark ${issue.severity ?? ''}`}
          ref={(e) => void (marks.current[k] = e)}
          title={`${issue.text}, layer ${issue.layer + 1}`}
          aria-label={`${issue.text}, layer ${issue.layer + 1}: show it`}
          onClick={() => {
            layer.value = issue.layer;
            goal.value = { row: issue.row!, column: issue.column ?? 0 };
            open();
          }}
        >
          <Icon name="warn" />
        </button>
      ))}
    </div>
  );
}

export function Stack({ job, openLayers }: { job: Job; openLayers: () => void }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const axes = useRef<SVGSVGElement>(null);
  const shown = useRef<StackView | null>(null);
  const marks = useRef<(HTMLElement | null)[]>([]);
  const [state, setState] = useState<'loading' | 'shown' | 'failed'>('loading');
  const count = job.manifest.layers.length;
  const [upTo, setUpTo] = useState(count - 1);
  const issues = job.issues.filter(isMarked).slice(0, mostMarks);

  useEffect(() => {
    let gone = false;
    let view: StackView;
    try {
      view = new StackView(canvas.current!, axes.current!, job);
    } catch {
      setState('failed');
      return;
    }
    shown.current = view;
    api(`/api/job/part?job=${job.key}`)
      .then((r) => r.arrayBuffer())
      .then((buffer) => {
        if (gone || !buffer.byteLength) return; // empty: of a job that has been replaced
        view.show(partOf(buffer, null).part);
        view.mark(issues.flatMap((issue, k) => (marks.current[k] ? [{ element: marks.current[k]!, issue }] : [])));
        setState('shown');
      })
      .catch((e: Error) => {
        setState('failed');
        say(e.message);
      });
    return () => {
      gone = true;
      shown.current = null;
      view.dispose();
    };
  }, [job.revision, theme.value]);

  useEffect(() => {
    const view = shown.current;
    if (!view || state !== 'shown') return;
    if (upTo >= count - 1) return view.cut(null);
    const z = job.manifest.layers[upTo].z_um / 1000;
    view.cut(z);
    let gone = false;
    void Promise.all(job.manifest.materials.map((_, m) => load(job, upTo, m))).then((images) => gone || view.lay(images, z));
    return () => {
      gone = true;
    };
  }, [upTo, state, theme.value]);

  return (
    <div class="layers">
      <div class="canvas">
        <canvas ref={canvas} tabIndex={0} aria-label={`The job in 3D. ${orbitHelp}`} data-testid="stack-view" data-state={state} />
        <AxesCorner drawing={axes} />
        <Marks issues={issues} marks={marks} open={openLayers} />
      </div>
      <div class="layer-info">
        <b>{upTo >= count - 1 ? `all ${count} layers` : `up to layer ${upTo + 1} of ${count}`}</b>
        <span class="quiet">
          {state === 'loading' ? 'Building preview' : state === 'failed' ? 'No preview: this browser has no WebGL' : `${(job.manifest.layers[upTo].z_um / 1000).toFixed(2)} mm`}
        </span>
      </div>
      <input
        class="upright"
        type="range"
        aria-label="Cut at layer"
        data-testid="stack-layer"
        min={1}
        max={Math.max(count, 2)}
        step={1}
        value={upTo + 1}
        style={{ '--at': `${(100 * upTo) / Math.max(count - 1, 1)}%` }}
        onInput={(e) => {
          const l = Math.min(Number(e.currentTarget.value), count) - 1;
          setUpTo(l);
          layer.value = l;
        }}
      />
    </div>
  );
}
