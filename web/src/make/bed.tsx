// The robot on the platform before it is sliced: turned, copied and in the colours of its materials. A face that is
// pointed at is laid down.
import { signal } from '@preact/signals';
import { useEffect, useRef, useState } from 'preact/hooks';
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { counted } from '../counted';
import { orbitHelp, orbitKeys, turnAround } from '../orbit_keys';
import { api, mayDrive, scene } from '../store';
import { theme } from '../theme';
import type { Scene } from '../types';
import { copies, fields, orderJson, printer, printerInfo, turn, type PrinterInfo } from './order';
import { layOnFace, placed, rotationOf, type Degrees } from './place';
import { clock } from './plan';
import { platformMesh } from './stack';

const picking = signal(false);

/// "2", "2 mm" or "0.2 cm" as millimetres; what the slicer will refuse is the usual.
function millimetres(text: string | undefined, usual: number): number {
  const match = /^\s*([\d.eE+-]+)\s*(um|µm|mm|cm|m|in)?\s*$/.exec(text ?? '');
  const value = match ? Number(match[1]) : NaN;
  const scale = { um: 1e-3, µm: 1e-3, mm: 1, cm: 10, m: 1000, in: 25.4 }[match?.[2] ?? 'mm'] ?? 1;
  return Number.isFinite(value) && value >= 0 ? value * scale : usual;
}

class BedView {
  private readonly renderer: THREE.WebGLRenderer;
  private readonly world = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(32, 1, 1, 5000);
  private readonly controls: OrbitControls;
  private readonly parts = new THREE.Group();
  private readonly geometry = new THREE.BufferGeometry();
  private readonly material = new THREE.MeshStandardMaterial({ roughness: 0.6, vertexColors: true, side: THREE.DoubleSide, flatShading: true });
  private readonly resize: ResizeObserver;
  private readonly keys: (e: KeyboardEvent) => void;
  private platform: THREE.Group | null = null;
  private seen = '';
  private frame = 0;

  constructor(private readonly canvas: HTMLCanvasElement, part: Scene) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.camera.up.set(0, 0, 1);
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x8a8f98, 1.9));
    const key = new THREE.DirectionalLight(0xffffff, 1.6);
    key.position.set(-1, -2, 3);
    this.world.add(key, this.parts);
    this.build(part);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.draw());
    this.keys = (e) => orbitKeys(e, (around, up, nearer) => turnAround(this.camera, this.controls, around, up, nearer), () => this.home());
    canvas.addEventListener('keydown', this.keys);
    this.resize = new ResizeObserver(() => {
      const box = canvas.parentElement!.getBoundingClientRect();
      if (!box.width) return;
      this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
      this.renderer.setSize(box.width, box.height, false);
      this.camera.aspect = box.width / box.height;
      this.camera.updateProjectionMatrix();
      if (!this.sized) this.home();
      this.sized = true;
      this.draw();
    });
    this.resize.observe(canvas.parentElement!);
  }

  private build(part: Scene) {
    const colours = part.head.materials.map((m) => new THREE.Color(m.colour));
    const material = part.u32('material');
    const colour = new Float32Array(3 * material.length);
    material.forEach((m, v) => (colours[m] ?? new THREE.Color(0x8f99a5)).toArray(colour, 3 * v));
    this.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(part.f32('rest')), 3));
    this.geometry.setAttribute('color', new THREE.BufferAttribute(colour, 3));
    this.geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(part.u32('triangles')), 1));
  }

  show(where: ReturnType<typeof placed>, degrees: Degrees, p: PrinterInfo) {
    if (this.platform) this.world.remove(this.platform);
    this.platform = platformMesh(p.image_mm[0], p.image_mm[1]);
    this.world.add(this.platform);
    this.parts.clear();
    for (const [x, y] of where.shifts.slice(0, 200)) {
      const mesh = new THREE.Mesh(this.geometry, this.material);
      mesh.matrixAutoUpdate = false;
      mesh.matrix
        .makeTranslation(x - where.least.x - where.size[0] / 2, y - where.least.y - where.size[1] / 2, -where.least.z)
        .multiply(rotationOf(degrees));
      this.parts.add(mesh);
    }
    const key = JSON.stringify([where.size, p.image_mm]);
    if (key !== this.seen) {
      this.seen = key;
      this.size = Math.max(Math.hypot(...where.size), 0.5 * Math.hypot(...p.image_mm));
      this.height = where.size[2];
      this.home();
    }
    this.draw();
  }
  private sized = false; // the shape of the window is known
  private size = 100;
  private height = 0;

  private home() {
    this.controls.target.set(0, 0, this.height / 3);
    const far = this.size * Math.max(1, 1.4 / this.camera.aspect); // a narrow window sees less
    this.camera.position.set(0.5 * far, -1.35 * far, 0.85 * far);
    this.controls.update();
    this.draw();
  }

  /// The outward normal of the face under the pointer, as it is turned now; null: there is none.
  normalAt(e: MouseEvent): THREE.Vector3 | null {
    const box = this.canvas.getBoundingClientRect();
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(((e.clientX - box.left) / box.width) * 2 - 1, 1 - ((e.clientY - box.top) / box.height) * 2), this.camera);
    const hit = ray.intersectObjects(this.parts.children)[0];
    return hit?.face ? hit.face.normal.clone().transformDirection(hit.object.matrix) : null;
  }

  private draw() {
    if (this.frame) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.renderer.render(this.world, this.camera);
    });
  }

  dispose() {
    cancelAnimationFrame(this.frame);
    this.canvas.removeEventListener('keydown', this.keys);
    this.resize.disconnect();
    this.geometry.dispose();
    this.material.dispose();
    this.controls.dispose();
    this.renderer.dispose();
  }
}

interface Estimate {
  layers: number;
  seconds: number;
  swaps: number;
  resin_ml: Record<string, number>;
}

/// What the print will take, as the planner sees it before anything is sliced.
function useEstimate(order: string, can: boolean): Estimate | null {
  const [estimate, setEstimate] = useState<Estimate | null>(null);
  useEffect(() => {
    if (!can) return;
    const stop = new AbortController();
    const timer = setTimeout(() => {
      api('/api/job/estimate', { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: order, signal: stop.signal })
        .then((r) => r.json())
        .then((e: Estimate) => setEstimate(e))
        .catch(() => stop.signal.aborted || setEstimate(null)); // what is wrong is said when it is sliced
    }, 350);
    return () => {
      clearTimeout(timer);
      stop.abort();
    };
  }, [order, can]);
  return estimate;
}

export function Bed() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const shown = useRef<BedView | null>(null);
  const s = scene.value;
  const p = printerInfo.value;
  const spacing = millimetres(fields.value.spacing, 2);
  const count = Math.max(1, Math.min(1000, Math.round(copies.value) || 1));
  const where = s && p ? placed(s.f32('rest'), turn.value, count, spacing, p.image_mm, p.platform.height_mm) : null;
  const order = JSON.stringify(orderJson(s?.head.materials.map((m) => m.name) ?? []));
  const estimate = useEstimate(`${order}`, Boolean(s && p && mayDrive.value));

  useEffect(() => {
    if (!s) return;
    let view: BedView;
    try {
      view = new BedView(canvas.current!, s);
    } catch {
      return; // no WebGL: the form and the estimate remain
    }
    shown.current = view;
    if (where && p) view.show(where, turn.value, p);
    return () => {
      shown.current = null;
      view.dispose();
    };
  }, [s?.head.revision, theme.value]);
  useEffect(() => {
    if (where && p) shown.current?.show(where, turn.value, p);
  }, [JSON.stringify(where?.size), JSON.stringify(turn.value), count, spacing, printer.value, p]);

  const pick = (e: MouseEvent) => {
    if (!picking.value) return;
    const normal = shown.current?.normalAt(e);
    picking.value = false;
    if (normal) turn.value = layOnFace(turn.value, normal);
  };
  const quarter = (axis: number) => (turn.value = turn.value.map((t, k) => (k === axis ? ((t + 90 + 180) % 360) - 180 : t)) as Degrees);
  if (!s) return <div class="empty"><h2>No robot</h2></div>;
  return (
    <div class="layers" data-testid="bed" data-fits={where?.fits ?? true}>
      <div class={`canvas ${picking.value ? 'picking' : ''}`}>
        <canvas ref={canvas} tabIndex={0} onClick={pick} aria-label={`The robot on the platform. ${orbitHelp}`} data-testid="bed-view" />
      </div>
      <div class="bed-foot">
      {estimate && (
        <p class="estimate" role="status" data-testid="estimate">
          about <b>{clock(estimate.seconds)}</b> · {counted(estimate.layers, 'layer')} · {counted(estimate.swaps, 'swap')}
          {Object.entries(estimate.resin_ml).map(([resin, ml]) => ` · ${ml.toFixed(1)} ml ${resin}`)}
        </p>
      )}
        <div class="row left wrap">
        <button class="chip" aria-pressed={picking.value} onClick={() => (picking.value = !picking.value)} data-testid="lay-on-face">
          {picking.value ? 'Click the face to lay down' : 'Lay on face'}
        </button>
        {['x', 'y', 'z'].map((axis, k) => (
          <button class="chip" onClick={() => quarter(k)} aria-label={`Rotate by 90 degrees about ${axis}`} data-testid={`turn-${axis}`}>
            {axis} 90°
          </button>
        ))}
        <button class="chip" disabled={turn.value.every((t) => t === 0)} onClick={() => (turn.value = [0, 0, 0])}>
          Reset rotation
        </button>
        </div>
      </div>
      {where && (
        <div class="layer-info">
          <b>{where.size.map((v) => v.toFixed(1)).join(' × ')} mm</b>
          {!where.fits && <span class="problems-inline" role="alert">does not fit {p!.image_mm.map((v) => v.toFixed(1)).join(' × ')} × {p!.platform.height_mm.toFixed(0)} mm</span>}
        </div>
      )}
    </div>
  );
}
