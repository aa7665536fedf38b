// What a sweep has found, ready to be drawn: a curve over one number, or a map over two.

export interface SweepFound {
  axes: { key: string; unit: string; values: number[] }[];
  columns: { key: string; label: string; unit: string }[];
  runs: { inputs: number[]; results: number[]; why: string }[]; // the last axis changes first
}

/// From one number to another, evenly, the ends among them.
export function evenly(from: number, to: number, count: number): number[] {
  if (count < 2) return [from];
  return Array.from({ length: count }, (_, k) => +(from + ((to - from) * k) / (count - 1)).toPrecision(10));
}

/// Round numbers from at most `low` to at least `high`, some five of them.
export function ticks(low: number, high: number, about = 5): number[] {
  if (!(high > low)) return [low];
  const raw = (high - low) / about;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 2.5, 5, 10].find((f) => f * power >= raw * 0.999) ?? 10);
  const list: number[] = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) list.push(+(k * step).toPrecision(12));
  return list;
}

/// The lowest and the highest of what there is; a little room where all are the same.
export function extent(values: number[]): [number, number] {
  const known = values.filter((v) => Number.isFinite(v));
  if (known.length === 0) return [0, 1];
  const [low, high] = [Math.min(...known), Math.max(...known)];
  if (high > low) return [low, high];
  const room = Math.abs(low) * 0.05 || 1;
  return [low - room, high + room];
}

/// Of a column, run by run; not a number where there is no equilibrium.
export const columnOf = (found: SweepFound, column: number): number[] => found.runs.map((r) => r.results[column] ?? NaN);

const cell = (s: string) => (/^[A-Za-z0-9_.-]+$/.test(s) ? s : `"${s.replace(/"/g, '""')}"`);

/// All runs as a table; inputs are named by their keys and units.
export function sweepCsv(found: SweepFound): string {
  const head = [...found.axes.map((a) => (a.unit ? `${a.key}_${a.unit}` : a.key)), ...found.columns.map((c) => c.key)];
  const rows = found.runs.map((r) => [...r.inputs, ...found.columns.map((_, k) => r.results[k] ?? '')].join(','));
  return [head.map(cell).join(','), ...rows].join('\r\n') + '\r\n';
}

/// "12 MPa" as a number and its unit; null where it is none.
export function quantity(shown: string): { value: number; unit: string } | null {
  const m = /^\s*([-+]?[0-9.]+(?:e[-+]?[0-9]+)?)\s*(\S*)\s*$/i.exec(shown);
  return m && Number.isFinite(Number(m[1])) ? { value: Number(m[1]), unit: m[2] } : null;
}
