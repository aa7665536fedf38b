// Prepares the results of a sweep for drawing: a curve over one number, or a map over two.

export interface SweepFound {
  axes: { key: string; unit: string; values: number[] }[];
  columns: { key: string; label: string; unit: string }[];
  runs: { inputs: number[]; results: number[]; why: string; warning?: string }[]; // the last axis varies fastest
}

/// `count` evenly spaced numbers, including both ends.
export function evenly(from: number, to: number, count: number): number[] {
  if (count < 2) return [from];
  return Array.from({ length: count }, (_, k) => +(from + ((to - from) * k) / (count - 1)).toPrecision(10));
}

/// About five round numbers from at most `low` to at least `high`.
export function ticks(low: number, high: number, about = 5): number[] {
  if (!(high > low)) return [low];
  const raw = (high - low) / about;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 2.5, 5, 10].find((f) => f * power >= raw * 0.999) ?? 10);
  const list: number[] = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) list.push(+(k * step).toPrecision(12));
  return list;
}

/// Minimum and maximum; widened a little if all values are equal.
export function extent(values: number[]): [number, number] {
  const known = values.filter((v) => Number.isFinite(v));
  if (known.length === 0) return [0, 1];
  const [low, high] = [Math.min(...known), Math.max(...known)];
  if (high > low) return [low, high];
  const room = Math.abs(low) * 0.05 || 1;
  return [low - room, high + room];
}

/// A column, run by run; NaN if there is no equilibrium.
export const columnOf = (found: SweepFound, column: number): number[] => found.runs.map((r) => r.results[column] ?? NaN);

const cell = (s: string) => (/^[A-Za-z0-9_.-]+$/.test(s) ? s : `"${s.replace(/"/g, '""')}"`);

/// All runs as a table; inputs are named by key and unit. As in exported histories, `elements` tells linear ones.
export function sweepCsv(found: SweepFound, linear = false): string {
  const warned = found.runs.some((r) => r.warning);
  const quoted = (s: string) => (s === '' ? '' : `"${s.replace(/"/g, '""')}"`);
  const head = [...found.axes.map((a) => (a.unit ? `${a.key}_${a.unit}` : a.key)), ...found.columns.map((c) => c.key), ...(linear ? ['elements'] : []), ...(warned ? ['warning'] : [])];
  const rows = found.runs.map((r) => [...r.inputs, ...found.columns.map((_, k) => r.results[k] ?? ''), ...(linear ? [1] : []), ...(warned ? [quoted(r.warning ?? '')] : [])].join(','));
  return [head.map(cell).join(','), ...rows].join('\r\n') + '\r\n';
}

/// "12 MPa" as a number and its unit; null if invalid.
export function quantity(shown: string): { value: number; unit: string } | null {
  const m = /^\s*([-+]?[0-9.]+(?:e[-+]?[0-9]+)?)\s*(\S*)\s*$/i.exec(shown);
  return m && Number.isFinite(Number(m[1])) ? { value: Number(m[1]), unit: m[2] } : null;
}
