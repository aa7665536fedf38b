// Compares two jobs: time and resin, and the differences of their layers.
import { signal } from '@preact/signals';
import { useEffect, useRef, useState } from 'preact/hooks';
import { hasEnding } from '../file_names';
import { api } from '../store';
import { cssColour, theme } from '../theme';
import type { Job, Plan } from '../types';
import { layer, load } from './layers';
import { clock } from './plan';

/// "": the previous job.
const chosen = signal('');

const noJobBefore = 'There is no previous job yet: slice again with other settings, or choose a job from the folder.';

interface Line {
  name: string;
  of: (job: Job) => number | null;
  show: (v: number) => string;
}

const whole = (v: number) => String(Math.round(v));
const ml = (v: number) => `${v.toFixed(2)} ml`;

/// Total of one resin, which may be in several vats.
const resinMl = (plan: Plan, resin: string) =>
  plan.vats.filter((v) => v.resin === resin).reduce((sum, v) => sum + (plan.resin_ml[String(v.slot)] ?? 0), 0);

/// The compared quantities, in order; resins of both jobs.
export function linesOf(a: Job, b: Job): Line[] {
  const plan = (pick: (p: NonNullable<Job['plan']>) => number) => (j: Job) => (j.plan ? pick(j.plan) : null);
  const resins = [...new Set([a, b].flatMap((j) => j.plan?.vats.map((v) => v.resin) ?? []))];
  return [
    { name: 'total time', of: plan((p) => p.seconds.total), show: clock },
    { name: 'exposure', of: plan((p) => p.seconds.expose), show: clock },
    { name: 'moving', of: plan((p) => p.seconds.move), show: clock },
    { name: 'swapping', of: plan((p) => p.seconds.swap), show: clock },
    { name: 'cleaning', of: plan((p) => p.seconds.clean), show: clock },
    { name: 'swaps', of: plan((p) => p.swaps), show: whole },
    { name: 'layers', of: (j) => j.manifest.layers.length, show: whole },
    { name: 'height', of: (j) => (j.manifest.layers[j.manifest.layers.length - 1]?.z_um ?? 0) / 1000, show: (v) => `${v.toFixed(2)} mm` },
    { name: 'part volume', of: (j) => j.manifest.materials.reduce((sum, m) => sum + m.model_volume_mm3, 0) / 1000, show: ml },
    ...resins.map((r): Line => ({ name: `resin ${r}`, of: plan((p) => resinMl(p, r)), show: ml })),
    { name: 'wasted', of: plan((p) => p.waste_ml), show: ml },
    { name: 'issues', of: (j) => j.issues.length, show: whole },
  ];
}

/// With its sign; "" if undefined, "same" if equal to the displayed digits.
export function differenceText({ show }: Line, a: number | null, b: number | null): string {
  if (a === null || b === null) return '';
  if (show(a) === show(b)) return 'same';
  return `${a > b ? '+' : '−'}${show(Math.abs(a - b))}`;
}

/// The layer of `other` at the height of layer `l` of `job`; -1: it is lower than that.
export function sameHeight(job: Job, other: Job, l: number): number {
  const { z_um, thickness_um } = job.manifest.layers[l];
  const middle = z_um - thickness_um / 2;
  return other.manifest.layers.findIndex((o) => o.z_um >= middle && o.z_um - o.thickness_um <= middle);
}

async function solid(job: Job, l: number): Promise<Uint8Array> {
  const { width_px, height_px, materials } = job.manifest;
  const out = new Uint8Array(width_px * height_px);
  if (l < 0) return out;
  const images = await Promise.all(materials.map((_, m) => load(job, l, m)));
  images.forEach((image, m) => {
    if (image) for (let i = 0; i < out.length; ++i) if (image.data[4 * i] >= 128) out[i] = m + 1;
  });
  return out;
}

const here = [34, 110, 200];
const there = [214, 110, 20];
const changed = [150, 60, 170];

/// Number of pixels only in this job, only in the other, in different resins, and in both.
async function drawDifference(canvas: HTMLCanvasElement, job: Job, other: Job, l: number): Promise<string> {
  const { width_px, height_px, pixel_um } = job.manifest;
  const [a, b] = await Promise.all([solid(job, l), solid(other, sameHeight(job, other, l))]);
  const resin = (j: Job, m: number) => (m === 0 ? '' : j.manifest.materials[m - 1].resin);
  let [x0, y0, x1, y1] = [width_px, height_px, 0, 0];
  const image = new ImageData(width_px, height_px);
  const both = parseInt(cssColour('--faint').slice(1) || '888888', 16);
  const count = { here: 0, there: 0, changed: 0 };
  for (let i = 0; i < a.length; ++i) {
    if (!a[i] && !b[i]) continue;
    const [x, y] = [i % width_px, Math.floor(i / width_px)];
    [x0, x1, y0, y1] = [Math.min(x0, x), Math.max(x1, x + 1), Math.min(y0, y), Math.max(y1, y + 1)];
    const which = !b[i] ? 'here' : !a[i] ? 'there' : resin(job, a[i]) !== resin(other, b[i]) ? 'changed' : '';
    if (which) ++count[which];
    image.data.set(which ? [...{ here, there, changed }[which], 255] : [both >> 16, (both >> 8) & 255, both & 255, 90], 4 * i);
  }
  const margin = 6;
  [x0, y0, x1, y1] = x1 > x0 ? [Math.max(0, x0 - margin), Math.max(0, y0 - margin), Math.min(width_px, x1 + margin), Math.min(height_px, y1 + margin)] : [0, 0, width_px, height_px];
  canvas.width = x1 - x0;
  canvas.height = y1 - y0;
  canvas.getContext('2d')!.putImageData(image, -x0, -y0);
  const mm2 = (n: number) => `${((n * pixel_um * pixel_um) / 1e6).toFixed(2)} mm²`;
  return `only in this job ${mm2(count.here)}, only in the other ${mm2(count.there)}, in another resin ${mm2(count.changed)}`;
}

function LayerDifference({ job, other }: { job: Job; other: Job }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [text, setText] = useState('');
  const count = job.manifest.layers.length;
  const l = Math.min(layer.value, count - 1);
  const alike = job.manifest.width_px === other.manifest.width_px && job.manifest.height_px === other.manifest.height_px && job.manifest.pixel_um === other.manifest.pixel_um;
  useEffect(() => {
    if (!alike) return;
    let gone = false;
    void drawDifference(canvas.current!, job, other, l)
      .then((t) => gone || setText(t))
      .catch((e: Error) => gone || setText(e.message));
    return () => {
      gone = true;
    };
  }, [l, other, alike, theme.value]);
  if (!alike) return <p class="quiet">The images of the two jobs differ in size: their layers cannot be overlaid.</p>;
  return (
    <figure class="layer-difference">
      <figcaption>
        <b>layer {l + 1}</b> of {count}
        <span class="quiet" role="status" data-testid="compare-layer">
          {text}
        </span>
      </figcaption>
      <input type="range" aria-label="Layer" data-testid="compare-slider" min={1} max={Math.max(count, 2)} step={1} value={l + 1} onInput={(e) => (layer.value = Math.min(Number(e.currentTarget.value), count) - 1)} />
      <canvas ref={canvas} role="img" aria-label={`Difference of layer ${l + 1}: ${text}`} data-testid="compare-view" />
      <ul class="keys-list">
        {([[here, 'only in this job'], [there, 'only in the other'], [changed, 'in another resin']] as const).map(([c, name]) => (
          <li>
            <span class="swatch" style={{ background: `rgb(${c.join(' ')})` }} />
            {name}
          </li>
        ))}
      </ul>
    </figure>
  );
}

export function Compare({ job }: { job: Job }) {
  const [names, setNames] = useState<string[]>([]);
  const [other, setOther] = useState<Job | null>(null);
  const [why, setWhy] = useState('');
  useEffect(() => {
    void api('/api/project')
      .then((r) => r.json())
      .then((p: { files: string[] }) => setNames(p.files.filter((f) => hasEnding(f, '.zip') && f !== job.file)))
      .catch(() => setNames([]));
  }, [job.revision]);
  useEffect(() => {
    const name = encodeURIComponent(chosen.value);
    setOther(null);
    setWhy('');
    api(`/api/job/other?name=${name}`)
      .then((r) => r.json())
      .then((o: Job | null) => !o ? setWhy(noJobBefore) : setOther({ ...o, at: (l, m) => `/api/job/other/${l}/${m}?name=${name}&job=${o.key}` }))
      .catch((e: Error) => setWhy(e.message));
  }, [chosen.value, job.revision]);
  return (
    <div class="plan compare" data-testid="compare">
      <label class="inline">
        Compare with
        <select value={chosen.value} onChange={(e) => (chosen.value = e.currentTarget.value)} data-testid="compare-with">
          <option value="">the previous job</option>
          {names.map((n) => (
            <option value={n}>{n}</option>
          ))}
        </select>
      </label>
      {why && <p class="quiet" data-testid="compare-none">{why}</p>}
      {other && (
        <>
          <table class="compare-table">
            <thead>
              <tr>
                <th />
                <th scope="col">this job</th>
                <th scope="col">{other.saved ? other.file : 'previous job'}</th>
                <th scope="col">difference</th>
              </tr>
            </thead>
            <tbody>
              {linesOf(job, other).map((line) => {
                const [a, b] = [line.of(job), line.of(other)];
                const d = differenceText(line, a, b);
                return (
                  <tr>
                    <th scope="row">{line.name}</th>
                    <td>{a === null ? '–' : line.show(a)}</td>
                    <td>{b === null ? '–' : line.show(b)}</td>
                    <td class={d === 'same' ? 'quiet' : ''}>{d}</td>
                  </tr>
                );
              })}
            </tbody>
          </table>
          <LayerDifference job={job} other={other} />
        </>
      )}
    </div>
  );
}
