// Recorded since the robot was built: numbers for the plots, frames for the replay.
import { effect, signal } from '@preact/signals';
import { frame, isRough, scene } from '../store';
import type { Frame, FrameHead, SceneHead } from '../types';

const mostPoints = 4000;
const mostFrames = 900;

/// A number of each state that can be plotted.
export interface Channel {
  key: string; // also the column of a table
  label: string;
  unit: string;
  group: 'cable' | 'chamber' | 'marker' | 'support' | 'sensor' | 'robot';
  kind: string;
  read: (head: FrameHead) => number;
}

const length = (p: readonly number[]) => Math.hypot(...p);

/// All channels of a robot.
export function channelsOf(head: SceneHead): Channel[] {
  const cables = head.actuators.filter((a) => a.type === 'cable');
  const chambers = head.actuators.filter((a) => a.type === 'chamber');
  const list: Channel[] = [];
  cables.forEach((c, k) => {
    const add = (kind: string, label: string, unit: string, read: (h: FrameHead) => number) =>
      list.push({ key: `${c.name}_${kind}`, label: `${c.name}: ${label}`, unit, group: 'cable', kind, read });
    add('tension_N', 'tension', 'N', (h) => h.cables[k]?.tension_N);
    add('shortening_mm', 'shortening', 'mm', (h) => c.rest - h.cables[k]?.length_mm);
    add('length_ratio', 'length ratio', '', (h) => h.cables[k]?.ratio);
  });
  chambers.forEach((c, k) => {
    const add = (kind: string, label: string, unit: string, read: (h: FrameHead) => number) =>
      list.push({ key: `${c.name}_${kind}`, label: `${c.name}: ${label}`, unit, group: 'chamber', kind, read });
    add('pressure_kPa', 'pressure', 'kPa', (h) => h.chambers[k]?.pressure_kPa);
    add('volume_change_mm3', 'volume change', 'mm³', (h) => h.chambers[k]?.volume_mm3 - c.rest);
    add('volume_ratio', 'volume ratio', '', (h) => h.chambers[k]?.ratio);
  });
  head.markers.forEach((m, k) => {
    const add = (kind: string, label: string, read: (h: FrameHead) => number) =>
      list.push({ key: `${m.name}_${kind}`, label: `${m.name}: ${label}`, unit: 'mm', group: 'marker', kind, read });
    add('displacement_mm', 'displacement', (h) => length((h.markers[k] ?? []).map((v, i) => v - m.rest[i])));
    ['x', 'y', 'z'].forEach((axis, i) => add(`${axis}_mm`, axis, (h) => h.markers[k]?.[i]));
  });
  head.supports.forEach((name, k) =>
    list.push({ key: `${name}_force_N`, label: `${name}: reaction`, unit: 'N', group: 'support', kind: 'force_N', read: (h) => length(h.supports?.[k] ?? []) }),
  );
  head.sensors?.forEach((s, k) =>
    s.readings.forEach((r, i) =>
      list.push({ key: `${s.name}_${r.name}`, label: `${s.name}: ${r.name}`, unit: r.unit, group: 'sensor', kind: r.name, read: (h) => h.sensors?.[k]?.[i] ?? NaN }),
    ),
  );
  head.obstacles.forEach((o, k) =>
    list.push({ key: `${o.name}_contact_N`, label: `${o.name}: contact force`, unit: 'N', group: 'robot', kind: 'contact_N', read: (h) => length(h.contacts?.[k] ?? []) }),
  );
  list.push(
    { key: 'energy_mJ', label: 'energy', unit: 'mJ', group: 'robot', kind: 'energy_mJ', read: (h) => h.energy_mJ },
    { key: 'time', label: 'time of the program', unit: 's', group: 'robot', kind: 'time', read: (h) => h.time },
    { key: 'residual', label: 'residual', unit: '', group: 'robot', kind: 'residual', read: (h) => Math.max(h.residual, 1e-16) },
  );
  return list;
}

export interface Tracks {
  seconds: number[]; // seconds of motion: time without motion is not counted
  rough: boolean[]; // approximate: of linear elements or of a reduced model
  elements: number[]; // order of the elements: 1 linear, 2 quadratic, 0 a reduced model
  channels: Channel[];
  values: number[][]; // (channels)(states)
}

export let tracks: Tracks = empty(null);
export let frames: Frame[] = [];
/// Incremented with every change of the two.
export const tracksVersion = signal(0);
/// Follows it, at most ten times a second: for what is costly to draw.
export const plottedVersion = signal(0);
const plotPause_ms = 100;
let plotTimer = 0;
let plottedAt = -Infinity;

effect(() => {
  const version = tracksVersion.value;
  if (plotTimer || version === plottedVersion.peek()) return;
  const show = () => {
    plotTimer = 0;
    plottedAt = performance.now();
    plottedVersion.value = tracksVersion.peek();
  };
  const wait = plottedAt + plotPause_ms - performance.now();
  if (wait > 0) plotTimer = window.setTimeout(show, wait);
  else show();
});

function empty(head: SceneHead | null): Tracks {
  const channels = head ? channelsOf(head) : [];
  return { seconds: [], rough: [], elements: [], channels, values: channels.map(() => []) };
}

export function clearTracks() {
  tracks = empty(scene.peek()?.head ?? null);
  frames = [];
  tracksVersion.value = tracksVersion.peek() + 1;
}

/// The values of one channel; empty if it does not exist.
export function valuesOf(key: string): number[] {
  return tracks.values[tracks.channels.findIndex((c) => c.key === key)] ?? [];
}

const longestStep = 0.1; // s between two states: longer pauses count as no motion
let last = 0;
let seenRevision = -1;

function add(next: Frame) {
  const now = performance.now() / 1000;
  const n = tracks.seconds.length;
  tracks.seconds.push(n === 0 ? 0 : tracks.seconds[n - 1] + Math.min(now - last, longestStep));
  last = now;
  tracks.rough.push(isRough(next));
  tracks.elements.push(next.head.reduced_error_mm !== undefined ? 0 : isRough(next) ? 1 : 2);
  tracks.channels.forEach((c, k) => tracks.values[k].push(c.read(next.head) ?? NaN));
  frames.push(next);
  if (frames.length > mostFrames) frames.shift();
  if (tracks.seconds.length > mostPoints) for (const list of [tracks.seconds, tracks.rough, tracks.elements, ...tracks.values]) list.shift();
  tracksVersion.value = tracksVersion.peek() + 1;
}

effect(() => {
  const next = frame.value;
  if (!next || !scene.peek()) return;
  if (next.head.revision !== seenRevision) {
    seenRevision = next.head.revision;
    clearTracks();
  }
  if (frames.length && frames[frames.length - 1].head.sequence === next.head.sequence) return;
  add(next);
});

/// All channels as a table; `elements` is 1 (linear, only a preview), 2, or 0 (a reduced model).
export function tracksCsv(): string {
  const quoted = (s: string) => (/^[A-Za-z0-9_]+$/.test(s) ? s : `"${s.replace(/"/g, '""')}"`);
  const columns = ['seconds', 'elements', ...tracks.channels.map((c) => quoted(c.key))];
  const rows = tracks.seconds.map((t, i) => [t.toFixed(4), tracks.elements[i], ...tracks.values.map((v) => v[i])].join(','));
  return [columns.join(','), ...rows].join('\r\n') + '\r\n';
}

/// A stored run for comparison, or a table of measurements.
export interface Run {
  name: string;
  columns: Record<string, number[]>; // by channel key
}
export const runs = signal<Run[]>([]);

const isRunName = (name: string) => runs.value.some((run) => run.name === name);

/// "run 2": the first of its kind that no run has. Runs may have been removed meanwhile.
export function freeRunName(kind: string): string {
  for (let k = 1; ; ++k) if (!isRunName(`${kind} ${k}`)) return `${kind} ${k}`;
}

/// The name of a file, with a number if a run has that name.
export function freeTableName(file: string): string {
  for (let k = 1; ; ++k) {
    const name = k === 1 ? file : `${file} (${k})`;
    if (!isRunName(name)) return name;
  }
}

/// Approximate states are left out, unless the robot has no others, as one with linear elements: then the name says so.
export function keepRun(kind: string) {
  const fine = tracks.rough.map((r, i) => (r ? -1 : i)).filter((i) => i >= 0);
  const kept = fine.length > 0 ? fine : tracks.rough.map((_, i) => i);
  const name = freeRunName(fine.length > 0 ? kind : `≈ ${kind}`);
  const pick = (list: number[]) => kept.map((i) => list[i]);
  const columns = Object.fromEntries(tracks.channels.map((c, k) => [c.key, pick(tracks.values[k])]));
  runs.value = [...runs.value, { name, columns: { ...columns, seconds: pick(tracks.seconds) } }];
}

/// The cells of a line, separated by commas, semicolons or tabs.
const cells = (l: string) => [...l.matchAll(/(?:"((?:[^"]|"")*)"|([^,;\t"]*))(?:[,;\t]|$)/g)].map((m) => (m[1]?.replace(/""/g, '"') ?? m[2]).trim()).slice(0, l.match(/[,;\t]$/) ? undefined : -1);

/// The lines of a table, with their numbers; those that begin with # are comments.
const linesOf = (text: string) =>
  text
    .split(/\r?\n/)
    .map((line, i) => ({ line, number: i + 1 }))
    .filter(({ line }) => line.trim() !== '' && !line.trimStart().startsWith('#'));

/// Parses a table of measurements: a header of names, then numbers. Errors name the line.
export function readTable(name: string, text: string): Run | string {
  const [header, ...lines] = linesOf(text);
  const head = cells(header?.line ?? '');
  const first = header?.number ?? 1;
  if (head.length < 2 || head.some((h) => h === '')) return `${name}:${first}: a header line with at least two column names is needed`;
  if (head.every((h) => Number.isFinite(Number(h)))) return `${name}:${first}: the first line must name the columns, as in shortening_mm,tension_N`;
  const twice = head.find((h, k) => head.indexOf(h) < k);
  if (twice !== undefined) return `${name}:${first}: two columns are named ${twice}; every column needs a name of its own`;
  const columns: Record<string, number[]> = Object.fromEntries(head.map((h) => [h, []]));
  for (const { line, number } of lines) {
    const row = cells(line);
    if (row.length !== head.length) return `${name}:${number}: ${row.length} columns, but the header line names ${head.length}`;
    for (const [k, text] of row.entries()) {
      const value = text === '' ? NaN : Number(text);
      if (text !== '' && !Number.isFinite(value)) return `${name}:${number}: "${text}" is not a number`;
      columns[head[k]].push(value);
    }
  }
  return columns[head[0]].length ? { name, columns } : `${name}: there are no rows`;
}

/// Rows that a table holds out itself: "judge" in its column use.
export function judgeRows(csv: string): number {
  const rows = linesOf(csv).map(({ line }) => cells(line));
  const use = rows[0]?.indexOf('use') ?? -1;
  return use < 0 ? 0 : rows.filter((row) => row[use] === 'judge').length;
}

/// The range of an axis: noise of the solver is no curve, and gets a range of one unit.
export function axisRange(low: number, high: number): [number, number] {
  const noise = 1e-6;
  const middle = Math.round((low + high) / 2 / noise) * noise;
  return high - low >= noise ? [low, high] : [middle - 0.5, middle + 0.5];
}
