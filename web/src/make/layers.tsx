// The layers of a job, one at a time: in colours, down to the pixel.
import { signal } from '@preact/signals';
import { useEffect, useRef, useState } from 'preact/hooks';
import { cssColour, theme } from '../theme';
import type { Job } from '../types';

export const layer = signal(0);
const difference = signal(false);
/// A pixel to scroll to.
export const goal = signal<{ row: number; column: number } | null>(null);

const cache = new Map<string, Promise<ImageData | null>>();

/// Grey values of one image; null if the material is not in the layer.
export function load(job: Job, l: number, material: number): Promise<ImageData | null> {
  const there = job.manifest.layers[l]?.images.some((i) => i.material === material);
  if (!there) return Promise.resolve(null);
  const address = job.at ? job.at(l, material) : `/api/job/layers/${l}/${material}?job=${job.key}`;
  let entry = cache.get(address);
  if (!entry) {
    entry = read(address);
    cache.set(address, entry);
    if (cache.size > 40) cache.delete(cache.keys().next().value as string);
  }
  return entry;
}

/// Null if the image is not there any more, as of a job that was being sliced, or has been replaced.
async function read(address: string): Promise<ImageData | null> {
  const answer = await fetch(address);
  if (answer.status !== 200) return null;
  const bitmap = await createImageBitmap(await answer.blob());
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const context = canvas.getContext('2d', { willReadFrequently: true })!;
  context.drawImage(bitmap, 0, 0);
  return context.getImageData(0, 0, bitmap.width, bitmap.height);
}

function rgb(hex: string): [number, number, number] {
  const n = parseInt(hex.slice(1), 16);
  return [n >> 16, (n >> 8) & 255, n & 255];
}

/// All materials of a layer in their colours; with `withDifference`, compared with the layer below: new pixels in
/// green, ended ones in red.
async function compose(job: Job, l: number, withDifference: boolean): Promise<ImageData> {
  const { width_px, height_px, materials } = job.manifest;
  const out = new ImageData(width_px, height_px);
  const now = await Promise.all(materials.map((_, m) => load(job, l, m)));
  const below = withDifference && l > 0 ? await Promise.all(materials.map((_, m) => load(job, l - 1, m))) : [];
  const data = out.data;
  now.forEach((image, m) => {
    if (!image) return;
    const [r, g, b] = rgb(job.colours[m]);
    for (let i = 0; i < data.length; i += 4) {
      const v = image.data[i];
      if (!v) continue;
      const a = data[i + 3];
      const share = v / (v + a || 1);
      data[i] += (r - data[i]) * share;
      data[i + 1] += (g - data[i + 1]) * share;
      data[i + 2] += (b - data[i + 2]) * share;
      data[i + 3] = Math.min(255, a + v);
    }
  });
  if (below.length) {
    for (let i = 0; i < data.length; i += 4) {
      let before = 0;
      for (const image of below) before += image ? image.data[i] : 0;
      const change = data[i + 3] - Math.min(before, 255);
      if (change > 20) data.set([34, 160, 90, 255], i);
      else if (change < -20) data.set([214, 60, 60, 255], i);
      else data[i + 3] *= 0.28;
    }
  }
  return out;
}

/// Bounds of all lit pixels, from a sample of layers.
async function lit(job: Job): Promise<[number, number, number, number]> {
  const n = job.manifest.layers.length;
  let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const l of new Set([0, Math.floor(n / 3), Math.floor((2 * n) / 3), n - 1])) {
    for (let m = 0; m < job.manifest.materials.length; ++m) {
      const image = await load(job, l, m);
      if (!image) continue;
      for (let y = 0; y < image.height; ++y)
        for (let x = 0; x < image.width; ++x)
          if (image.data[4 * (y * image.width + x)]) {
            x0 = Math.min(x0, x);
            x1 = Math.max(x1, x + 1);
            y0 = Math.min(y0, y);
            y1 = Math.max(y1, y + 1);
          }
    }
  }
  return x1 > x0 ? [x0, y0, x1, y1] : [0, 0, job.manifest.width_px, job.manifest.height_px];
}

interface Place {
  x: number;
  y: number;
  zoom: number;
}

/// `of`: for a job that is still being sliced, its final number of layers.
export function Layers({ job, of }: { job: Job; of?: number }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const image = useRef<OffscreenCanvas | null>(null);
  const place = useRef<Place | null>(null);
  const [pixel, setPixel] = useState('');
  const [loading, setLoading] = useState(true);
  const count = job.manifest.layers.length;
  const l = Math.min(layer.value, count - 1);
  const info = job.manifest.layers[l];

  const draw = () => {
    const c = canvas.current;
    const source = image.current;
    if (!c || !source || !place.current) return;
    const ratio = Math.min(devicePixelRatio, 2);
    const box = c.parentElement!.getBoundingClientRect();
    c.width = Math.round(box.width * ratio);
    c.height = Math.round(box.height * ratio);
    const g = c.getContext('2d')!;
    const { x, y, zoom } = place.current;
    const z = zoom * ratio;
    g.setTransform(z, 0, 0, z, c.width / 2 - x * z, c.height / 2 - y * z);
    g.fillStyle = cssColour('--plate');
    g.fillRect(0, 0, source.width, source.height);
    g.imageSmoothingEnabled = zoom < 1.5;
    g.drawImage(source, 0, 0);
    if (zoom >= 10) {
      g.strokeStyle = cssColour('--line');
      g.lineWidth = 1 / z;
      g.beginPath();
      const [left, top] = [x - c.width / 2 / z, y - c.height / 2 / z];
      for (let i = Math.max(0, Math.floor(left)); i <= Math.min(source.width, left + c.width / z + 1); ++i) {
        g.moveTo(i, Math.max(0, top));
        g.lineTo(i, Math.min(source.height, top + c.height / z));
      }
      for (let j = Math.max(0, Math.floor(top)); j <= Math.min(source.height, top + c.height / z + 1); ++j) {
        g.moveTo(Math.max(0, left), j);
        g.lineTo(Math.min(source.width, left + c.width / z), j);
      }
      g.stroke();
    }
  };

  const fit = async () => {
    const [x0, y0, x1, y1] = await lit(job);
    const box = canvas.current?.parentElement?.getBoundingClientRect();
    if (!box) return;
    place.current = { x: (x0 + x1) / 2, y: (y0 + y1) / 2, zoom: 0.8 * Math.min(box.width / (x1 - x0), box.height / (y1 - y0)) };
    draw();
  };

  useEffect(() => {
    let gone = false;
    const timer = setTimeout(() => setLoading(true), 150);
    compose(job, l, difference.value).then(async (data) => {
      clearTimeout(timer);
      if (gone) return;
      const off = new OffscreenCanvas(data.width, data.height);
      off.getContext('2d')!.putImageData(data, 0, 0);
      image.current = off;
      if (!place.current) await fit();
      if (goal.value) {
        place.current = { x: goal.value.column + 0.5, y: goal.value.row + 0.5, zoom: 12 };
        goal.value = null;
      }
      setLoading(false);
      draw();
    });
    return () => {
      gone = true;
      clearTimeout(timer);
    };
  }, [l, info?.number, difference.value, job.revision, goal.value]);

  useEffect(() => {
    draw();
    const resize = new ResizeObserver(draw);
    resize.observe(canvas.current!.parentElement!);
    return () => resize.disconnect();
  }, [theme.value]);

  const at = (e: MouseEvent): [number, number] => {
    const box = canvas.current!.getBoundingClientRect();
    const p = place.current!;
    return [p.x + (e.clientX - box.left - box.width / 2) / p.zoom, p.y + (e.clientY - box.top - box.height / 2) / p.zoom];
  };
  const wheel = (e: WheelEvent) => {
    if (!place.current) return;
    e.preventDefault();
    const [x, y] = at(e);
    const factor = Math.exp(-e.deltaY * 0.0016);
    const zoom = Math.min(Math.max(place.current.zoom * factor, 0.05), 60);
    const f = zoom / place.current.zoom;
    place.current = { x: x + (place.current.x - x) / f, y: y + (place.current.y - y) / f, zoom };
    draw();
  };
  const move = (e: PointerEvent) => {
    if (!place.current) return;
    if (e.buttons & 1) {
      place.current.x -= e.movementX / place.current.zoom;
      place.current.y -= e.movementY / place.current.zoom;
      draw();
    }
    const [x, y] = at(e).map(Math.floor);
    const g = image.current?.getContext('2d') as OffscreenCanvasRenderingContext2D | null;
    if (!g || x < 0 || y < 0 || x >= job.manifest.width_px || y >= job.manifest.height_px) return setPixel('');
    const grey = g.getImageData(x, y, 1, 1).data[3];
    setPixel(`column ${x}, row ${y}: grey ${grey}`);
  };
  const step = (by: number) => (layer.value = Math.min(Math.max(l + by, 0), count - 1));
  const number = (info?.number ?? l) + 1;
  const area = info?.images.reduce((sum, i) => sum + i.area_mm2, 0) ?? 0;
  return (
    <div class="layers">
      <div class="canvas">
        <canvas
          ref={canvas}
          tabIndex={0}
          aria-label={`Layer ${number} of ${of ?? count}. Arrow keys step through the layers.`}
          data-testid="layer-view"
          onWheel={wheel}
          onPointerMove={move}
          onDblClick={() => void fit()}
          onKeyDown={(e) => {
            const by = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 10, PageDown: -10 }[e.key];
            if (by) {
              step(by);
              e.preventDefault();
            }
          }}
        />
      </div>
      <div class="lookbar second">
        <button class="chip" aria-pressed={difference.value} onClick={() => (difference.value = !difference.value)} data-testid="difference">
          Difference from the layer below
        </button>
        <button class="chip" onClick={() => void fit()}>
          Fit
        </button>
        <button class="chip" onClick={() => {
          if (place.current) place.current.zoom = 16;
          draw();
        }}>
          Pixels
        </button>
      </div>
      <div class="layer-info">
        <b>
          layer {number} of {of ?? count}
        </b>
        <span class="quiet">
          {((info?.z_um ?? 0) / 1000).toFixed(2)} mm · {area.toFixed(1)} mm² {pixel && `· ${pixel}`} {loading && '· loading'}
        </span>
        {difference.value && (
          <span class="quiet">
            <span class="swatch" style={{ background: '#22a05a' }} /> new <span class="swatch" style={{ background: '#d63c3c' }} /> removed
          </span>
        )}
      </div>
      <input
        class="upright"
        type="range"
        aria-label="Layer"
        data-testid="layer"
        min={1}
        max={Math.max(count, 2)}
        step={1}
        value={l + 1}
        style={{ '--at': `${(100 * l) / Math.max(count - 1, 1)}%` }}
        onInput={(e) => (layer.value = Math.min(Number(e.currentTarget.value), count) - 1)}
      />
    </div>
  );
}
