// Plots beside the robot: results over the motion, or over one another; stored runs and measurements are overlaid.
import { signal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { counted } from '../counted';
import { Icon } from '../icons';
import { say, scene } from '../store';
import { cssColour, theme } from '../theme';
import { exactCurve } from './exact';
import { axisRange, freeTableName, keepRun, plottedVersion, readTable, runs, tracks, valuesOf, type Channel } from './tracks';

/// Powers of ten, thinned out: grid lines of a logarithmic axis over many decades would merge into a grey block.
function decades(least: number, most: number): number[] {
  const mostLines = 5;
  const [from, to] = [Math.ceil(Math.log10(least) - 1e-9), Math.floor(Math.log10(most) + 1e-9)];
  const stride = Math.max(1, Math.ceil((to - from + 1) / mostLines));
  const lines = [];
  for (let k = from; k <= to; k += stride) lines.push(10 ** k);
  return lines;
}

// Distinguishable with red-green colour blindness (Okabe and Ito), on light and on dark.
const palette = ['#d55e00', '#0072b2', '#009e73', '#b9770e', '#a64d86', '#3f8fc4'];

/// Over time (''), or over a channel.
interface Shown {
  title: string;
  y: string[];
  x: string;
  log?: boolean;
  extra?: string;
}

/// `approximate`: its points that stand alone are hollow.
type Curve = { label: string; x: number[]; y: number[]; colour: string; dash?: number[]; points?: boolean; approximate?: boolean; now?: string };

const channel = (key: string): Channel | undefined => tracks.channels.find((c) => c.key === key);
const shortLabel = (c: Channel, all: boolean) => (all ? c.label.replace(/: [^:]*$/, '') : c.label);
const readable = (v: number | undefined, unit: string, log = false) =>
  v === undefined || !Number.isFinite(v) ? '–' : `${log ? v.toExponential(1) : +v.toPrecision(5)}${unit && ` ${unit}`}`;

/// The curves: for every result the exact states and, if there are any, the approximate ones separately, dashed.
function curvesOf(shown: Shown): Curve[] {
  const sameKind = new Set(shown.y.map((k) => channel(k)?.kind)).size === 1;
  const xs = shown.x ? valuesOf(shown.x) : tracks.seconds;
  const curves: Curve[] = [];
  shown.y.forEach((key, k) => {
    const c = channel(key);
    if (!c) return;
    const ys = valuesOf(key);
    const exact = shown.log ? { x: xs, y: ys } : exactCurve(xs, ys, tracks.rough);
    const colour = palette[k % palette.length];
    const roughNow = tracks.rough.at(-1) ?? false;
    const label = shortLabel(c, sameKind);
    const now = `${roughNow ? '≈ ' : ''}${readable(ys.at(-1), c.unit, shown.log)}`;
    curves.push({ label, ...exact, colour, now });
    if (!shown.log && tracks.rough.includes(true))
      curves.push({ label: `≈ ${label}`, x: xs, y: ys.map((v, i) => (tracks.rough[i] ? v : NaN)), colour, dash: [3, 4], approximate: true });
    for (const [r, run] of runs.value.entries()) {
      const [x, y] = [run.columns[shown.x || 'seconds'] ?? run.columns.time, run.columns[key]];
      if (x && y) curves.push({ label: `${run.name}: ${label}`, x, y, colour: palette[(k + shown.y.length + r) % palette.length], dash: [8, 4], points: x.length < 60 });
    }
  });
  return curves;
}

/// All points sorted by x, for the scales and the cursor.
function aligned(curves: Curve[]): uPlot.AlignedData {
  const x: number[] = [];
  const ys: (number | null | undefined)[][] = curves.map(() => []);
  const rows = curves.flatMap((c, k) => c.x.map((at, i) => ({ at, k, i }))).filter((r) => Number.isFinite(r.at) && Number.isFinite(curves[r.k].y[r.i]));
  rows.sort((a, b) => a.at - b.at);
  for (const { at, k, i } of rows) {
    x.push(at);
    ys.forEach((list, j) => list.push(j === k ? curves[k].y[i] : undefined));
  }
  return [x, ...ys] as uPlot.AlignedData;
}

/// Draws each curve in the order of its states: x may decrease if it is a result.
function drawCurves(u: uPlot, curves: Curve[]) {
  const { ctx } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
  ctx.clip();
  ctx.lineJoin = 'round';
  for (const c of curves) {
    ctx.strokeStyle = ctx.fillStyle = c.colour;
    ctx.lineWidth = (c.dash ? 1.5 : 2) * devicePixelRatio;
    ctx.setLineDash((c.dash ?? []).map((d) => d * devicePixelRatio));
    ctx.beginPath();
    let down = false;
    c.x.forEach((at, i) => {
      const here = Number.isFinite(at) && Number.isFinite(c.y[i]);
      if (here) {
        const [px, py] = [u.valToPos(at, 'x', true), u.valToPos(c.y[i], 'y', true)];
        if (down) ctx.lineTo(px, py);
        else ctx.moveTo(px, py);
      }
      down = here;
    });
    ctx.stroke();
    ctx.setLineDash([]);
    c.x.forEach((at, i) => {
      const alone = !Number.isFinite(c.y[i - 1]) && !Number.isFinite(c.y[i + 1]);
      if (!Number.isFinite(c.y[i]) || !(c.points || alone)) return;
      ctx.beginPath();
      ctx.arc(u.valToPos(at, 'x', true), u.valToPos(c.y[i], 'y', true), 2.5 * devicePixelRatio, 0, 7);
      if (c.approximate) ctx.stroke();
      else ctx.fill();
    });
  }
  ctx.restore();
}

/// uPlot asks for the context of its canvas without options. Drawn by the processor, plots cost little also where there is
/// no graphics card: there, every drawing through WebGL's driver would make the page wait.
function drawnByProcessor<T>(make: () => T): T {
  const canvas = HTMLCanvasElement.prototype;
  const getContext = canvas.getContext;
  canvas.getContext = function (this: HTMLCanvasElement, kind: string, options?: object) {
    return getContext.call(this, kind, { willReadFrequently: true, ...options });
  } as typeof getContext;
  try {
    return make();
  } finally {
    canvas.getContext = getContext;
  }
}

const isEmpty = (curves: Curve[]) => !curves.some((c) => c.y.filter((v) => Number.isFinite(v)).length > 1);

function seriesOf(curves: Curve[]): uPlot.Series[] {
  return [
    {},
    ...curves.map((c): uPlot.Series => ({ label: c.label, stroke: c.colour, paths: () => null, points: { show: false } })),
  ];
}

function Plot({ shown, onClose }: { shown: Shown; onClose?: () => void }) {
  plottedVersion.value;
  const box = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const drawn = useRef<Curve[]>([]);
  const curves = (drawn.current = curvesOf(shown));
  const empty = isEmpty(curves);
  const unit = channel(shown.y[0])?.unit ?? '';
  const x = shown.x ? channel(shown.x) : undefined;
  const key = [...curves.map((c) => c.label + c.colour), theme.value, shown.log, empty, shown.x].join('|');
  useEffect(() => {
    if (empty || !box.current) return;
    const ink = cssColour('--faint');
    const grid = { stroke: cssColour('--line'), width: 1 };
    const axis = { stroke: ink, grid, ticks: { show: false }, font: '11px system-ui', size: 34, gap: 4 };
    const options: uPlot.Options = {
      width: box.current.clientWidth,
      height: 150,
      padding: [8, 8, 0, 0],
      cursor: { points: { size: 7 }, drag: { x: false, y: false } },
      legend: { show: false },
      scales: { x: { time: false }, y: shown.log ? { distr: 3 } : { range: (_: uPlot, least: number, most: number) => uPlot.rangeNum(...axisRange(least, most), 0.1, true) } },
      axes: [
        { ...axis, size: 24, values: (_, v) => v.map((s) => `${+s.toPrecision(4)}`) },
        { ...axis, size: 44, ...(shown.log && { splits: (_: uPlot, __: number, least: number, most: number) => decades(least, most), filter: (_: uPlot, lines: number[]) => lines }), values: (_, v) => v.map((y) => (y == null ? '' : shown.log ? y.toExponential(0) : `${+y.toPrecision(4)}`)) },
      ],
      series: seriesOf(curves),
      hooks: { draw: [(u) => drawCurves(u, drawn.current)] },
    };
    const parent = box.current;
    const made = drawnByProcessor(() => new uPlot(options, aligned(curves), parent));
    plot.current = made;
    for (const canvas of parent.querySelectorAll('canvas')) canvas.ariaHidden = 'true'; // the name is that of its box
    const resize = new ResizeObserver(() => box.current && made.setSize({ width: box.current.clientWidth, height: 150 }));
    resize.observe(box.current);
    return () => {
      resize.disconnect();
      made.destroy();
      plot.current = null;
    };
  }, [key]);
  useEffect(() => plot.current?.setData(aligned(curves)));
  return (
    <figure class="plot" data-testid={`plot-${shown.title}`}>
      <figcaption>
        <span>
          {shown.title} {unit && <span class="quiet">{unit}</span>} {shown.extra && <span class="quiet">{shown.extra}</span>}
        </span>
        {onClose && (
          <button class="bare" aria-label={`Remove the plot ${shown.title}`} onClick={onClose}>
            <Icon name="close" />
          </button>
        )}
      </figcaption>
      {empty ? (
        <p class="plot-empty quiet">Move {scene.value?.head.actuators.length ? 'a slider, or play the program' : 'the robot, or play its program'}: the curve begins with the second state.</p>
      ) : (
        <>
          <div ref={box} role="img" aria-label={`${shown.title} over ${x?.label ?? 'seconds of motion'}`} />
          <p class="plot-foot">
            {curves.map((c) => (
              <span key={c.label} class="curve-name">
                <svg viewBox="0 0 18 6" aria-hidden="true">
                  <path d="M0 3H18" stroke={c.colour} stroke-width="2.4" stroke-dasharray={c.dash?.join(' ')} />
                </svg>
                {c.label} {c.now && <b data-testid={`now-${c.label}`}>{c.now}</b>}
              </span>
            ))}
            <span class="grow" />
            <span class="quiet">over {x ? `${x.label}${x.unit && `, ${x.unit}`}` : 'time in motion, s'}</span>
          </p>
        </>
      )}
    </figure>
  );
}

/// Requested plots: a result over another.
export const asked = signal<{ x: string; y: string }[]>([]);
const wantX = signal('');
const wantY = signal('');

function Ask() {
  const channels = tracks.channels;
  const default_ = channels[0]?.key ?? '';
  const y = wantY.value && channel(wantY.value) ? wantY.value : default_;
  const x = wantX.value && channel(wantX.value) ? wantX.value : (channels[1]?.key ?? '');
  const options = channels.map((c) => (
    <option value={c.key} key={c.key}>
      {c.label}
    </option>
  ));
  return (
    <div class="ask-plot">
      <label>
        Plot
        <select value={y} data-testid="plot-y" onChange={(e) => (wantY.value = e.currentTarget.value)}>
          {options}
        </select>
      </label>
      <label>
        over
        <select value={x} data-testid="plot-x" onChange={(e) => (wantX.value = e.currentTarget.value)}>
          {options}
        </select>
      </label>
      <button class="small" data-testid="plot-add" onClick={() => (asked.value = [...asked.value.filter((a) => a.x !== x || a.y !== y), { x, y }])}>
        Add
      </button>
    </div>
  );
}

async function takeTable(input: HTMLInputElement) {
  const file = input.files?.[0];
  if (!file) return;
  const read = readTable(file.name, await file.text());
  if (typeof read === 'string') say(read);
  else runs.value = [...runs.value, { ...read, name: freeTableName(read.name) }];
  input.value = '';
}

function Runs() {
  const keys = new Set(tracks.channels.map((c) => c.key));
  return (
    <div class="runs">
      <div class="row left wrap">
        <button class="small" data-testid="keep-run" onClick={() => keepRun('run')}>
          Keep this run
        </button>
        <label class="button small">
          Overlay a CSV…
          <input class="unseen" type="file" accept=".csv,text/csv" data-testid="overlay" onChange={(e) => void takeTable(e.currentTarget)} />
        </label>
      </div>
      {runs.value.map((run) => {
        const known = Object.keys(run.columns).filter((c) => keys.has(c));
        return (
          <div class="run" key={run.name} data-testid={`run-${run.name}`}>
            <b>{run.name}</b>
            <span class="quiet">
              {counted(Object.values(run.columns)[0].length, 'state')}{' '}
              {known.length === 0 && `· none of its columns (${Object.keys(run.columns).join(', ')}) is a result of this robot: columns are named as in ${[...keys].slice(0, 2).join(', ')}`}
              {known.length > 0 && !run.columns.seconds && !run.columns.time && '· it has no column time: choose another horizontal axis to see it'}
            </span>
            <button class="bare" aria-label={`Remove ${run.name}`} onClick={() => (runs.value = runs.value.filter((r) => r !== run))}>
              <Icon name="close" />
            </button>
          </div>
        );
      })}
    </div>
  );
}

export function Plots({ all = false }: { all?: boolean }) {
  plottedVersion.value;
  const head = scene.value?.head;
  if (!head) return null;
  const keys = (kind: string) => tracks.channels.filter((c) => c.kind === kind).map((c) => c.key);
  const given: Shown[] = [
    { title: 'Tension', y: keys('tension_N'), x: '' },
    { title: 'Pressure', y: keys('pressure_kPa'), x: '' },
    { title: 'Marker displacement', y: keys('displacement_mm'), x: '' },
  ].filter((s) => s.y.length > 0);
  return (
    <div class="plots" key={head.revision}>
      {all && (
        <>
          <Ask />
          <Runs />
          {asked.value.map((a) => {
            const [x, y] = [channel(a.x), channel(a.y)];
            if (!x || !y) return null;
            return <Plot key={`${a.x}|${a.y}`} shown={{ title: y.label, x: a.x, y: [a.y] }} onClose={() => (asked.value = asked.value.filter((b) => b !== a))} />;
          })}
        </>
      )}
      {given.map((s) => (
        <Plot key={s.title} shown={s} />
      ))}
      {all && <Plot shown={{ title: 'Residual', y: ['residual'], x: '', log: true, extra: `converged below ${head.tolerance}` }} />}
    </div>
  );
}
