// Parameter sweep: one or two numbers of the robot over their ranges, and the results of its program as a response
// plot.
import { effect, signal } from '@preact/signals';
import { counted } from '../counted';
import { NumberField } from '../number_field';
import { api, mayDrive, scene } from '../store';
import { fieldColour, gradientCss } from './colormap';
import { setValues, theirs } from './editor';
import { columnOf, evenly, extent, quantity, sweepCsv, ticks, type SweepFound } from './response';
import { saveBlob } from './save';
import { begin, isOfBefore, isRoughResult, resultOf, RoughNote, Search } from './search';
import { drivenByKeys, keyOf, parametersOf } from './toml_edit';
import { freeRunName, runs } from './tracks';
import * as look from './view_state';

interface Known {
  key: string;
  value: number;
  unit: string;
}
interface Axis {
  key: string; // '': not chosen yet
  other: boolean; // typed by the user
  unit: string;
  from: number;
  to: number;
  count: number;
}

const none: Axis = { key: '', other: false, unit: '', from: 0, to: 1, count: 7 };
const axes = signal<[Axis, Axis | null]>([none, null]);
const known = signal<Known[]>([]);
const column = signal('');
const chosen = signal(-1); // index of the selected run
const mostRuns = 400;

const targets: Record<string, [string, string]> = {
  length_ratio: ['length_ratio', ''],
  shortening_mm: ['shortening', 'mm'],
  tension_N: ['tension', 'N'],
  volume_ratio: ['volume_ratio', ''],
  pressure_kPa: ['pressure', 'kPa'],
};

/// Lists parameters first, then the targets of the actuators, then other numbers of the robot.
async function learn() {
  const head = scene.peek()?.head;
  if (!head) return;
  const list: Known[] = parametersOf(theirs.peek()).map((p) => ({ key: `parameters.${p.name}`, value: p.value, unit: '' }));
  const driven = drivenByKeys(theirs.peek()); // their targets are those of the keys
  for (const a of head.actuators) {
    const [name, unit] = targets[a.kind] ?? [];
    if (name !== undefined && !driven.has(a.name)) list.push({ key: keyOf(a.type, a.name, 'target', name), value: a.target, unit });
  }
  const more = (await (await api('/api/unknowns')).json()) as { key: string; shown: string }[];
  for (const one of more) {
    const q = quantity(one.shown);
    if (q && !list.some((k) => k.key === one.key)) list.push({ key: one.key, ...q });
  }
  known.value = list;
  // Another robot may have no such key.
  const kept = (axis: Axis) => axis.other || axis.key === '' || list.some((k) => k.key === axis.key);
  const [first, second] = axes.peek();
  if (!kept(first) || (second && !kept(second))) axes.value = [kept(first) ? first : none, second && kept(second) ? second : null];
}
effect(() => {
  theirs.value; // parameters are part of the text
  if (scene.value) learn().catch(() => {});
});

/// Default range: from half to one and a half times the current value.
function axisOf(key: string): Axis {
  const k = known.peek().find((one) => one.key === key);
  if (!k) return { ...none, key };
  const ratio = k.key.endsWith('_ratio');
  const whole = k.key.startsWith('parameters.') && Number.isInteger(k.value);
  const round = (v: number) => (whole ? Math.round(v) : +v.toPrecision(4));
  // Above 1 a cable is slack: from rest it is pulled.
  const pulled = k.key.endsWith('.length_ratio') && k.value >= 1;
  const [from, to] = pulled ? [0.7, 1] : ratio ? [k.value, 1] : k.value === 0 ? [0, 1] : [round(0.5 * k.value), round(1.5 * k.value)];
  return { key, other: false, unit: k.unit, from, to: to === from ? from + 1 : to, count: whole ? Math.min(7, Math.abs(to - from) + 1) : 7 };
}

function change(which: 0 | 1, to: Partial<Axis> | null) {
  const next: [Axis, Axis | null] = [...axes.value];
  if (to === null) next[1] = null;
  else next[which] = { ...(next[which] ?? none), ...to } as Axis;
  axes.value = next;
}

const named = (kind: string) => known.value.filter((k) => (kind === 'parameters' ? k.key.startsWith('parameters.') : kind === 'targets' ? k.key.includes('.target.') : !k.key.startsWith('parameters.') && !k.key.includes('.target.')));

function AxisFields({ which, axis }: { which: 0 | 1; axis: Axis }) {
  const id = `sweep-${which}`;
  return (
    <fieldset class="material" disabled={!mayDrive.value}>
      <legend>{which === 0 ? 'Parameter' : 'Second parameter'}</legend>
      <label class="row">
        Key
        <select value={axis.other ? '?' : axis.key} data-testid={`${id}-key`} onChange={(e) => change(which, e.currentTarget.value === '?' ? { key: '', other: true } : axisOf(e.currentTarget.value))}>
          <option value="" disabled>choose one</option>
          {[['parameters', 'Parameters'], ['targets', 'Actuator targets'], ['others', 'Other keys']].map(([kind, label]) =>
            named(kind).length > 0 && (
              <optgroup label={label} key={kind}>
                {named(kind).map((k) => <option value={k.key} key={k.key}>{k.key.replace(/^parameters\./, '')}</option>)}
              </optgroup>
            ),
          )}
          <option value="?">another key…</option>
        </select>
      </label>
      {axis.other && (
        <>
          <label class="row">
            Key as for --set
            <input value={axis.key} placeholder="body.tip.size" data-testid={`${id}-typed`} onInput={(e) => change(which, { key: e.currentTarget.value.trim() })} />
          </label>
          <label class="row">
            Unit
            <input class="short" value={axis.unit} placeholder="none" data-testid={`${id}-unit`} onInput={(e) => change(which, { unit: e.currentTarget.value.trim() })} />
          </label>
        </>
      )}
      <div class="sweep-range">
        {(['from', 'to'] as const).map((end) => (
          <label key={end}>
            {end}
            <NumberField value={axis[end]} range={{ from: -1e12, to: 1e12 }} unit={axis.unit} label={`${end} of ${axis.key || 'the parameter'}`} testId={`${id}-${end}`} onValue={(v) => change(which, { [end]: v })} />
          </label>
        ))}
        <label>
          values
          <NumberField value={axis.count} range={{ from: 1, to: 100 }} unit="" step={1} label={`number of values of ${axis.key || 'the parameter'}`} testId={`${id}-count`} onValue={(v) => change(which, { count: Math.round(v) })} />
        </label>
      </div>
    </fieldset>
  );
}

const size = { width: 336, height: 220, left: 54, right: 12, top: 10, bottom: 40 };
const show = (v: number) => (Math.abs(v) >= 1e5 || (v !== 0 && Math.abs(v) < 1e-3) ? v.toExponential(1) : `${+v.toPrecision(4)}`);
const shortKey = (a: SweepFound['axes'][0]) => `${a.key.replace(/^parameters\./, '')}${a.unit && `, ${a.unit}`}`;

/// Maps values to positions in the picture.
function scaleOf([low, high]: [number, number], from: number, to: number) {
  return (v: number) => from + ((v - low) / (high - low || 1)) * (to - from);
}

function Curve({ found, values }: { found: SweepFound; values: number[] }) {
  const inputs = found.runs.map((r) => r.inputs[0]);
  const [xs, ys] = [extent(inputs), extent(values)];
  const x = scaleOf(xs, size.left, size.width - size.right);
  const y = scaleOf(ys, size.height - size.bottom, size.top);
  const order = inputs.map((_, k) => k).sort((a, b) => inputs[a] - inputs[b]);
  let down = false;
  const path = order
    .map((k) => {
      if (!Number.isFinite(values[k])) return (down = false), '';
      const move = down ? 'L' : 'M';
      down = true;
      return `${move}${x(inputs[k]).toFixed(1)} ${y(values[k]).toFixed(1)}`;
    })
    .join('');
  return (
    <>
      {ticks(...ys).map((t) => (
        <g key={t}>
          <line class="grid" x1={size.left} x2={size.width - size.right} y1={y(t)} y2={y(t)} />
          <text class="tick-text" x={size.left - 6} y={y(t)} text-anchor="end" dominant-baseline="central">{show(t)}</text>
        </g>
      ))}
      {ticks(...xs).map((t) => (
        <text class="tick-text" key={t} x={x(t)} y={size.height - size.bottom + 14} text-anchor="middle">{show(t)}</text>
      ))}
      <path class="response-line" d={path} />
      {order.map((k) =>
        Number.isFinite(values[k]) ? (
          <circle key={k} class={`response-dot ${chosen.value === k ? 'chosen' : ''} ${found.runs[k].warning ? 'warned' : ''}`} cx={x(inputs[k])} cy={y(values[k])} r={chosen.value === k ? 6 : 4} onClick={() => (chosen.value = k)} />
        ) : (
          <path key={k} class="response-cross" d={`M${x(inputs[k]) - 4} ${size.height - size.bottom - 8}l8 8m0-8l-8 8`} onClick={() => (chosen.value = k)} />
        ),
      )}
    </>
  );
}

function Heat({ found, values }: { found: SweepFound; values: number[] }) {
  const [a, b] = found.axes;
  const range = extent(values);
  const w = (size.width - size.left - size.right) / a.values.length;
  const h = (size.height - size.bottom - size.top) / b.values.length;
  const shown = (list: number[], most: number) => list.map((v, k) => ({ v, k })).filter(({ k }) => k % Math.ceil(list.length / most) === 0);
  return (
    <>
      {found.runs.map((_, k) => {
        const [i, j] = [Math.floor(k / b.values.length), k % b.values.length];
        const v = values[k];
        const fill = Number.isFinite(v) ? `rgb(${fieldColour((v - range[0]) / (range[1] - range[0]), look.map.value).map((c) => Math.round(255 * c)).join(' ')})` : 'none';
        const at = { x: size.left + i * w, y: size.height - size.bottom - (j + 1) * h };
        return (
          <g key={k} onClick={() => (chosen.value = k)}>
            <rect class={`heat ${chosen.value === k ? 'chosen' : ''}`} {...at} width={w} height={h} style={{ fill }} />
            {!Number.isFinite(v) && <path class="response-cross" d={`M${at.x + w / 2 - 4} ${at.y + h / 2 - 4}l8 8m0-8l-8 8`} />}
            {found.runs[k].warning && <text class="heat-warned" x={at.x + w / 2} y={at.y + h / 2} text-anchor="middle" dominant-baseline="central">!</text>}
          </g>
        );
      })}
      {shown(a.values, 6).map(({ v, k }) => (
        <text class="tick-text" key={`a${k}`} x={size.left + (k + 0.5) * w} y={size.height - size.bottom + 14} text-anchor="middle">{show(v)}</text>
      ))}
      {shown(b.values, 8).map(({ v, k }) => (
        <text class="tick-text" key={`b${k}`} x={size.left - 6} y={size.height - size.bottom - (k + 0.5) * h} text-anchor="end" dominant-baseline="central">{show(v)}</text>
      ))}
    </>
  );
}

const assignment = (axis: SweepFound['axes'][0], value: number) => ({ key: axis.key, value: axis.unit ? `${value} ${axis.unit}` : value });

function Chosen({ found }: { found: SweepFound }) {
  const run = found.runs[chosen.value];
  if (!run) return <p class="quiet">Click a point of the plot, or a row of the table, to use its values.</p>;
  return (
    <div data-testid="sweep-chosen">
      <div class="chosen-run">
        <p>{found.axes.map((a, k) => `${shortKey(a).split(',')[0]} ${show(run.inputs[k])}${a.unit && ` ${a.unit}`}`).join(', ')}</p>
        <button class="small" disabled={!mayDrive.value} data-testid="sweep-use" onClick={() => void setValues(found.axes.map((a, k) => assignment(a, run.inputs[k])))}>
          Use these values
        </button>
      </div>
      {run.why && <p class="limit">{run.why}</p>}
      {run.warning && <p class="limit" data-testid="sweep-warning">{run.warning}</p>}
    </div>
  );
}

/// The sweep as a run that plots can overlay.
function overlay(found: SweepFound, rough: boolean) {
  const columns: Record<string, number[]> = Object.fromEntries(found.columns.map((c, k) => [c.key, columnOf(found, k)]));
  found.axes.forEach((a, k) => (columns[a.key] = found.runs.map((r) => r.inputs[k])));
  runs.value = [...runs.value, { name: freeRunName(rough ? '≈ sweep' : 'sweep'), columns }];
}

function Found() {
  const last = resultOf('sweep');
  if (!last) return null;
  const found = last.found as SweepFound;
  const at = Math.max(found.columns.findIndex((c) => c.key === column.value), 0);
  const values = columnOf(found, at);
  const of = found.columns[at];
  const rough = isRoughResult(last);
  const sign = rough ? '≈ ' : '';
  const failed = found.runs.filter((r) => r.why).length;
  const warned = found.runs.filter((r) => r.warning).length;
  const two = found.axes.length === 2;
  const [low, high] = extent(values);
  return (
    <div class="search" data-testid="sweep-found">
      {isOfBefore(last) && <p class="quiet">The robot has been changed since this sweep.</p>}
      <RoughNote of={last} />
      <label class="row">
        Result
        <select value={of.key} onChange={(e) => (column.value = e.currentTarget.value)} data-testid="sweep-result">
          {found.columns.map((c) => (
            <option value={c.key} key={c.key}>{c.label}{c.unit && `, ${c.unit}`}</option>
          ))}
        </select>
      </label>
      <figure class="response">
        <svg viewBox={`0 0 ${size.width} ${size.height}`} role="img" aria-label={`${of.label} over ${found.axes.map((a) => a.key).join(' and ')}; the table below has its numbers`} data-testid="sweep-plot">
          {two ? <Heat found={found} values={values} /> : <Curve found={found} values={values} />}
          <text class="axis-text" x={(size.left + size.width - size.right) / 2} y={size.height - 6} text-anchor="middle">{shortKey(found.axes[0])}</text>
          <text class="axis-text" transform={`translate(11 ${(size.top + size.height - size.bottom) / 2}) rotate(-90)`} text-anchor="middle">{two ? shortKey(found.axes[1]) : `${sign}${of.label}${of.unit && `, ${of.unit}`}`}</text>
        </svg>
        {two && (
          <div class="heat-legend">
            <span>{show(low)}</span>
            <span class="bar" style={{ background: gradientCss(look.map.value, 0, 'to right') }} />
            <span>{sign}{show(high)} {of.unit}</span>
          </div>
        )}
      </figure>
      {failed > 0 && <p class="limit">{failed} of {counted(found.runs.length, 'run')} {failed === 1 ? 'has' : 'have'} no result, marked ×: choose one to see why.</p>}
      {warned > 0 && (
        <p class="limit" data-testid="sweep-warned">
          {warned} of {counted(found.runs.length, 'run')} {warned === 1 ? 'has' : 'have'} a result with a warning not to trust it, marked {two ? '!' : 'by a hollow point'}: choose one to read it.
        </p>
      )}
      <Chosen found={found} />
      <div class="row left wrap">
        <button class="small" onClick={() => saveBlob(new Blob([sweepCsv(found, rough)], { type: 'text/csv' }), 'sweep.csv')} data-testid="sweep-csv">CSV</button>
        <button class="small" onClick={() => overlay(found, rough)} data-testid="sweep-overlay">Overlay on plots</button>
      </div>
      <details>
        <summary>Table</summary>
        <div class="sweep-table" tabIndex={0} role="region" aria-label="Runs of the sweep">
          <table class="readings">
            <thead>
              <tr>
                {found.axes.map((a) => <th key={a.key}>{shortKey(a)}</th>)}
                <th>{sign}{of.label}{of.unit && `, ${of.unit}`}</th>
                <th><span class="unseen">Choose</span></th>
              </tr>
            </thead>
            <tbody>
              {found.runs.map((r, k) => (
                <tr key={k} class={chosen.value === k ? 'chosen' : ''}>
                  {r.inputs.map((v, i) => <td key={i}>{show(v)}</td>)}
                  <td>{Number.isFinite(values[k]) ? `${show(values[k])}${r.warning ? ' !' : ''}` : '×'}</td>
                  <td><button class="small" aria-pressed={chosen.value === k} aria-label={`Choose run ${k + 1}`} onClick={() => (chosen.value = k)} data-testid={`sweep-run-${k}`}>choose</button></td>
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      </details>
    </div>
  );
}

export function Sweep() {
  const [first, second] = axes.value;
  const used = [first, ...(second ? [second] : [])];
  const count = used.reduce((n, a) => n * a.count, 1);
  const ready = mayDrive.value && used.every((a) => a.key !== '') && count <= mostRuns;
  return (
    <div class="search">
      <p class="quiet">Runs the program once for each value, from rest, and plots the final state.</p>
      <AxisFields which={0} axis={first} />
      {second ? <AxisFields which={1} axis={second} /> : null}
      <div class="row left">
        <button class="small" onClick={() => change(1, second ? null : none)} data-testid="sweep-second">
          {second ? 'Remove second parameter' : 'Add second parameter'}
        </button>
        <span class={count > mostRuns ? 'limit' : 'quiet'}>{count === 1 ? '1 run' : `${count} runs`}{count > mostRuns && `, at most ${mostRuns}`}</span>
      </div>
      <Search
        kind="sweep"
        label="Run the sweep"
        ready={ready}
        onBegin={() => {
          chosen.value = -1;
          begin('sweep', { axes: used.map((a) => ({ key: a.key, unit: a.unit, values: evenly(a.from, a.to, a.count) })) });
        }}
      />
      <Found />
    </div>
  );
}
