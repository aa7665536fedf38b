// The layers as they will stand on the platform: every so many of them as a sheet.
import { useEffect, useRef, useState } from 'preact/hooks';
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { orbitHelp, orbitKeys, turnAround } from '../orbit_keys';
import { theme } from '../theme';
import type { Job } from '../types';
import { layer, load } from './layers';

const mostSheets = 90;

/// A material's image with its colour, shrunk.
function sheetCanvas(job: Job, images: (ImageData | null)[], box: number[], shrink: number): HTMLCanvasElement {
  const [x0, y0, x1, y1] = box;
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
        if (image.data[from] < 128) continue;
        data.data.set([n >> 16, (n >> 8) & 255, n & 255, 255], 4 * (y * canvas.width + x));
      }
  });
  g.putImageData(data, 0, 0);
  return canvas;
}

async function bounds(job: Job, layers: number[]): Promise<number[]> {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const l of layers)
    for (let m = 0; m < job.manifest.materials.length; ++m) {
      const image = await load(job, l, m);
      if (!image) continue;
      for (let y = 0; y < image.height; y += 2)
        for (let x = 0; x < image.width; x += 2)
          if (image.data[4 * (y * image.width + x)]) {
            box[0] = Math.min(box[0], x);
            box[1] = Math.min(box[1], y);
            box[2] = Math.max(box[2], x + 2);
            box[3] = Math.max(box[3], y + 2);
          }
    }
  return box;
}

/// At the first layer, where the slider stands in the beginning, the whole part is seen.
const isSeen = (l: number, upTo: number) => upTo === 0 || l <= upTo;

export function Stack({ job }: { job: Job }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const sheets = useRef<{ layer: number; mesh: THREE.Mesh }[]>([]);
  const redraw = useRef(() => {});
  const [done, setDone] = useState(0);

  useEffect(() => {
    const renderer = new THREE.WebGLRenderer({ canvas: canvas.current!, antialias: true, alpha: true });
    const world = new THREE.Scene();
    const camera = new THREE.PerspectiveCamera(32, 1, 1, 5000);
    camera.up.set(0, 0, 1);
    const controls = new OrbitControls(camera, canvas.current!);
    const draw = () => renderer.render(world, camera);
    let home = () => {};
    const keys = (e: KeyboardEvent) => orbitKeys(e, (around, up, nearer) => turnAround(camera, controls, around, up, nearer), home);
    const view = canvas.current!;
    view.addEventListener('keydown', keys);
    redraw.current = draw;
    controls.addEventListener('change', draw);
    const resize = new ResizeObserver(() => {
      const box = canvas.current!.parentElement!.getBoundingClientRect();
      renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
      renderer.setSize(box.width, box.height, false);
      camera.aspect = box.width / box.height;
      camera.updateProjectionMatrix();
      draw();
    });
    resize.observe(canvas.current!.parentElement!);
    let gone = false;
    void (async () => {
      const layers = job.manifest.layers;
      const every = Math.max(1, Math.ceil(layers.length / mostSheets));
      const shown = layers.map((_, l) => l).filter((l) => l % every === 0);
      const box = await bounds(job, [0, 1, 2, 3, 4].map((k) => Math.floor((k * (layers.length - 1)) / 4)));
      const pixel = job.manifest.pixel_um / 1000;
      const [width, depth] = [(box[2] - box[0]) * pixel, (box[3] - box[1]) * pixel];
      const height = layers[layers.length - 1].z_um / 1000;
      const shrink = Math.max(1, Math.floor(Math.max(box[2] - box[0], box[3] - box[1]) / 640));
      const size = Math.hypot(width, depth, height);
      const plate = new THREE.Mesh(
        new THREE.PlaneGeometry(job.platform.width_mm, job.platform.depth_mm),
        new THREE.MeshBasicMaterial({ color: 0x8a93a0, transparent: true, opacity: 0.16, side: THREE.DoubleSide }),
      );
      plate.position.z = -0.3;
      world.add(plate);
      home = () => {
        controls.target.set(0, 0, height / 2);
        camera.position.set(0.7 * size, -1.5 * size, 1.0 * size);
        controls.update();
      };
      home();
      const geometry = new THREE.PlaneGeometry(width, depth);
      for (const l of shown) {
        const images = await Promise.all(job.manifest.materials.map((_, m) => load(job, l, m)));
        if (gone) return;
        const texture = new THREE.CanvasTexture(sheetCanvas(job, images, box, shrink));
        texture.colorSpace = THREE.SRGBColorSpace;
        texture.magFilter = THREE.NearestFilter;
        texture.minFilter = THREE.LinearFilter;
        texture.generateMipmaps = false;
        const shade = 0.72 + 0.28 * (l / layers.length);
        const mesh = new THREE.Mesh(
          geometry,
          new THREE.MeshBasicMaterial({ map: texture, alphaTest: 0.5, side: THREE.DoubleSide, color: new THREE.Color(shade, shade, shade) }),
        );
        mesh.position.z = layers[l].z_um / 1000;
        mesh.visible = isSeen(l, layer.peek());
        sheets.current.push({ layer: l, mesh });
        world.add(mesh);
        setDone((100 * sheets.current.length) / shown.length);
        draw();
      }
    })();
    return () => {
      gone = true;
      view.removeEventListener('keydown', keys);
      resize.disconnect();
      controls.dispose();
      renderer.dispose();
      sheets.current = [];
    };
  }, [job.revision, theme.value]);

  useEffect(() => {
    for (const s of sheets.current) s.mesh.visible = isSeen(s.layer, layer.value);
    redraw.current();
  }, [layer.value]);

  const count = job.manifest.layers.length;
  const top = Math.min(layer.value, count - 1);
  return (
    <div class="layers">
      <div class="canvas">
        <canvas ref={canvas} tabIndex={0} aria-label={`The layers in 3D. ${orbitHelp}`} data-testid="stack-view" data-done={done >= 100} />
      </div>
      <div class="layer-info">
        <b>{layer.value === 0 ? `all ${count} layers` : `up to layer ${top}`}</b>
        <span class="quiet">{done < 100 ? `Building preview, ${Math.round(done)} %` : `${((job.manifest.layers[layer.value === 0 ? count - 1 : top]?.z_um ?? 0) / 1000).toFixed(2)} mm`}</span>
      </div>
      <input class="upright" type="range" aria-label="Layer" min={0} max={Math.max(count - 1, 1)} step={1} value={layer.value} style={{ '--at': `${(100 * layer.value) / Math.max(count - 1, 1)}%` }} onInput={(e) => (layer.value = Number(e.currentTarget.value))} />
    </div>
  );
}
