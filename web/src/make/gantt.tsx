// Gantt chart of the whole print, device by device: zoomed with the wheel or keys, panned by dragging.
import { useEffect, useRef, useState } from 'preact/hooks';
import { api, say } from '../store';
import { cssColour, theme } from '../theme';
import type { Job, Plan } from '../types';
import { clock } from './plan';

interface Timeline {
  seconds: number;
  devices: { name: string; times: number[] }[];
  visits: [number, number, number, number][]; // layer, slot, begin, end
}

const rowHeight = 24;
const scaleHeight = 24;

/// Length of a round time step, with at most `most` steps in `span` seconds.
export function timeStep(span: number, most: number): number {
  for (const step of [1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600, 7200, 14400, 28800, 86400]) if (span / step <= most) return step;
  return Math.ceil(span / most / 86400) * 86400;
}

function tickText(seconds: number, step: number): string {
  const h = Math.floor(seconds / 3600);
  const m = Math.floor(seconds / 60) % 60;
  const s = Math.floor(seconds % 60);
  const two = (n: number) => String(n).padStart(2, '0');
  if (step >= 3600) return `${h} h`;
  if (step >= 60) return `${h}:${two(m)}`;
  return `${h}:${two(m)}:${two(s)}`;
}

/// Index of the first entry that begins at or after t; `begin(k)` is the begin of entry k.
function firstAt(count: number, begin: (k: number) => number, t: number): number {
  let low = 0;
  let high = count;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (begin(middle) < t) low = middle + 1;
    else high = middle;
  }
  return low;
}

export function Gantt({ job, plan }: { job: Job; plan: Plan }) {
  const [line, setLine] = useState<Timeline | null>(null);
  const [range, setRange] = useState<[number, number]>([0, 1]);
  const [under, setUnder] = useState('');
  const canvas = useRef<HTMLCanvasElement>(null);
  const [width, setWidth] = useState(0);
  useEffect(() => {
    api('/api/job/timeline')
      .then((r) => r.json())
      .then((t: Timeline) => {
        setLine(t);
        setRange([0, t.seconds]);
      })
      .catch((e: Error) => say(e.message));
  }, [job.revision]);
  useEffect(() => {
    const box = canvas.current?.parentElement;
    if (!box) return;
    const resize = new ResizeObserver(() => setWidth(box.clientWidth));
    resize.observe(box);
    return () => resize.disconnect();
  }, [line]);

  const [from, to] = range;
  const span = to - from;
  // Aligned with the rows above and below.
  const labelWidth = width < 600 ? 106 : 164;
  const inner = Math.max(width - labelWidth, 1);
  const x = (t: number) => labelWidth + ((t - from) / span) * inner;
  const colourOfSlot = (slot: number) => job.colours[plan.vats.find((v) => v.slot === slot)?.materials[0] ?? 0] ?? '#888';
  const rows = line ? line.devices.length + 1 : 0;

  useEffect(() => {
    const c = canvas.current;
    if (!c || !line || width === 0) return;
    const ratio = Math.min(devicePixelRatio, 2);
    const height = rows * rowHeight + scaleHeight;
    c.width = Math.round(width * ratio);
    c.height = Math.round(height * ratio);
    const g = c.getContext('2d')!;
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.font = `12px ${getComputedStyle(c).fontFamily}`;
    const ink = cssColour('--ink');
    const faint = cssColour('--faint');
    const step = timeStep(span, inner / 84);
    g.textBaseline = 'middle';
    g.strokeStyle = cssColour('--line');
    g.lineWidth = 1;
    for (let t = Math.ceil(from / step) * step; t <= to; t += step) {
      const at = Math.round(x(t)) + 0.5;
      g.beginPath();
      g.moveTo(at, 0);
      g.lineTo(at, rows * rowHeight + 4);
      g.stroke();
      g.fillStyle = faint;
      g.textAlign = at < labelWidth + 20 ? 'left' : at > width - 24 ? 'right' : 'center';
      g.fillText(tickText(t, step), at, rows * rowHeight + 14);
    }
    const bar = (row: number, begin: number, end: number, colour: string) => {
      const left = Math.max(x(begin), labelWidth);
      const right = Math.min(x(end), width);
      g.fillStyle = colour;
      g.fillRect(left, row * rowHeight + 5, Math.max(right - left, 0.7), rowHeight - 10);
    };
    const label = (row: number, text: string) => {
      g.textAlign = 'left';
      g.fillStyle = ink;
      g.fillText(text, 0, (row + 0.5) * rowHeight);
    };
    label(0, 'vat in use');
    const visits = line.visits;
    for (let k = Math.max(firstAt(visits.length, (i) => visits[i][2], from) - 1, 0); k < visits.length && visits[k][2] <= to; ++k) {
      if (visits[k][3] < from) continue;
      bar(0, visits[k][2], visits[k][3], colourOfSlot(visits[k][1]));
      const [left, right] = [Math.max(x(visits[k][2]), labelWidth), Math.min(x(visits[k][3]), width)];
      if (right - left > 54) {
        g.fillStyle = '#101418';
        g.textAlign = 'center';
        g.fillText(`layer ${visits[k][0] + 1}`, (left + right) / 2, 0.5 * rowHeight);
      }
    }
    const kinds: Record<string, string> = { light: '--c-expose', spray: '--c-clean', fans: '--c-clean' };
    line.devices.forEach(({ name, times }, d) => {
      label(d + 1, name);
      const colour = cssColour(kinds[name] ?? (name === 'platform' ? '--c-move' : '--c-swap'));
      // Bars that fall into the same pixel are drawn once.
      let drawn = -1;
      for (let k = Math.max(firstAt(times.length / 2, (i) => times[2 * i], from) - 1, 0); 2 * k < times.length && times[2 * k] <= to; ++k) {
        const [begin, end] = [times[2 * k], times[2 * k + 1]];
        if (end < from || x(end) < drawn + 0.5) continue;
        bar(d + 1, begin, end, colour);
        drawn = x(end);
      }
    });
  }, [line, range, width, theme.value]);

  if (!line) return null;
  const within = (a: number, b: number): [number, number] => {
    const size = Math.min(Math.max(b - a, 2), line.seconds);
    const begin = Math.min(Math.max(a, 0), line.seconds - size);
    return [begin, begin + size];
  };
  const zoom = (factor: number, at = (from + to) / 2) => setRange(within(at - (at - from) * factor, at + (to - at) * factor));
  const timeAt = (e: MouseEvent) => from + ((e.clientX - canvas.current!.getBoundingClientRect().left - labelWidth) / inner) * span;
  const hover = (e: PointerEvent) => {
    if (e.buttons & 1) {
      const by = (-e.movementX / inner) * span;
      return setRange(within(from + by, to + by));
    }
    const t = timeAt(e);
    const k = line.visits.findIndex((v) => v[2] <= t && t <= v[3]);
    setUnder(t < 0 || t > line.seconds ? '' : `${clock(t)} · ${k < 0 ? 'no vat under the platform' : `layer ${line.visits[k][0] + 1}, slot ${line.visits[k][1]}`}`);
  };
  const keys: Record<string, () => void> = {
    '+': () => zoom(0.6),
    '=': () => zoom(0.6),
    '-': () => zoom(1 / 0.6),
    ArrowLeft: () => setRange(within(from - 0.2 * span, to - 0.2 * span)),
    ArrowRight: () => setRange(within(from + 0.2 * span, to + 0.2 * span)),
    Home: () => setRange([0, line.seconds]),
  };
  return (
    <figure class="chart gantt" data-testid="gantt">
      <figcaption class="row">
        <span>
          Timeline <span class="quiet">{under || `${clock(from)} to ${clock(to)}`}</span>
        </span>
        <span class="row left">
          <button class="small" aria-label="Zoom in" onClick={() => zoom(0.4)} data-testid="gantt-nearer">
            +
          </button>
          <button class="small" aria-label="Zoom out" onClick={() => zoom(2.5)}>
            −
          </button>
          <button class="small" onClick={() => setRange([0, line.seconds])}>
            All
          </button>
        </span>
      </figcaption>
      <div>
        <canvas
          ref={canvas}
          tabIndex={0}
          aria-label={`Every device over the whole print, ${clock(from)} to ${clock(to)} of ${clock(line.seconds)}. Plus and minus zoom, arrow keys scroll, Home shows all.`}
          style={{ height: `${rows * rowHeight + scaleHeight}px` }}
          onWheel={(e) => {
            e.preventDefault();
            zoom(Math.exp(e.deltaY * 0.0018), timeAt(e));
          }}
          onPointerMove={hover}
          onPointerLeave={() => setUnder('')}
          onDblClick={() => setRange([0, line.seconds])}
          onKeyDown={(e) => {
            if (!keys[e.key]) return;
            keys[e.key]();
            e.preventDefault();
          }}
        />
      </div>
    </figure>
  );
}
