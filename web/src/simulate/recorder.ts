// Records the user's actions as a program: [[program.key]] of a robot file.
import { effect, signal } from '@preact/signals';
import { scene } from '../store';
import { writtenReading } from './actuators';
import { type Change, changeText } from './editor';
import { replaceEntries } from './toml_edit';

export interface Key {
  time: number;
  values: Record<string, { kind: string; value: number }>;
}

export const recording = signal(false);
export const recorded = signal<Key[]>([]);
let started = 0;
let timer = 0;
const interval_ms = 200;

const unit: Record<string, string> = { shortening_mm: 'mm', tension_N: 'N', pressure_kPa: 'kPa', volume_change_mm3: 'mm^3' };

export function startRecording() {
  recorded.value = [];
  recording.value = true;
  started = performance.now();
  const take = () => {
    // In the units of the file's own targets, so that the keys fit it.
    const all = scene.peek()?.head.actuators ?? [];
    const values = Object.fromEntries(all.map((a) => [a.name, { kind: a.kind, value: writtenReading(a, a.kind) }]));
    recorded.value = [...recorded.value, { time: (performance.now() - started) / 1000, values }];
  };
  timer = window.setInterval(take, interval_ms);
}

export function stopRecording() {
  clearInterval(timer);
  recording.value = false;
}

let robot = -1; // what the recording is of
effect(() => {
  const opened = scene.value?.head.opened;
  if (opened === undefined || opened === robot) return;
  robot = opened;
  stopRecording();
  recorded.value = [];
});

/// True if all keys between two lie on the straight line from one to the other, to a thousandth.
function isStraight(keys: Key[], from: number, to: number, names: string[]): boolean {
  const a = keys[from];
  const b = keys[to];
  return names.every((n) => {
    const v0 = a.values[n].value;
    const v1 = b.values[n].value;
    const room = 1e-3 * Math.max(Math.abs(v0), Math.abs(v1), 1e-9);
    for (let i = from + 1; i < to; ++i) {
      const share = (keys[i].time - a.time) / (b.time - a.time);
      if (Math.abs(v0 + share * (v1 - v0) - keys[i].values[n].value) > room) return false;
    }
    return true;
  });
}

/// The keys needed for linear interpolation of the others. Each stretch is checked against all of its keys: in a slowly
/// bending motion no three neighbours show the bend. A stretch is doubled as long as it is straight, and its end is then
/// found by halving: checked key by key, a robot that stands still for long would take the square of that time.
function corners(keys: Key[], names: string[]): Key[] {
  const kept = keys.slice(0, 1);
  const last = keys.length - 1;
  for (let from = 0; from < last; ) {
    let end = from + 1;
    let beyond = last + 1;
    for (let length = 2; end < last && beyond > last; length *= 2) {
      const to = Math.min(from + length, last);
      if (isStraight(keys, from, to, names)) end = to;
      else beyond = to;
    }
    while (beyond - end > 1) {
      const middle = (end + beyond) >> 1;
      if (isStraight(keys, from, middle, names)) end = middle;
      else beyond = middle;
    }
    from = end;
    kept.push(keys[from]);
  }
  return kept;
}

/// A [[program.key]] for each, with the values that drive the actuators.
function programKeys(keys: Key[]): string {
  const bare = (n: string) => (/^[A-Za-z0-9_-]+$/.test(n) ? n : JSON.stringify(n));
  const text = ({ kind, value }: { kind: string; value: number }) => {
    const u = unit[kind];
    return u ? `"${+value.toPrecision(5)} ${u}"` : `${+value.toPrecision(5)}`;
  };
  return keys
    .map((k) => ['[[program.key]]', `time = "${k.time.toFixed(2)} s"`, ...Object.entries(k.values).map(([n, v]) => `${bare(n)} = ${text(v)}`)].join('\n'))
    .join('\n\n');
}

/// Puts these in the place of the keys of the file, and other values with them.
export function insertKeys(file: string, keys: string, changes: Change[]): Promise<boolean> {
  return changeText(replaceEntries(file, 'program.key', keys.trim()), changes);
}

/// A program ends with its last key: the file may have a duration that is shorter.
export function endOf(keys: string): Change[] {
  const time = [...keys.matchAll(/^time = "([^"]+)"$/gm)].at(-1)?.[1];
  return time ? [{ key: 'program.duration', value: time }] : [];
}

/// Uses for each actuator only the kind that drove it last, and drops collinear keys.
export function asProgram(): string {
  const keys = recorded.value;
  if (keys.length < 2) return '';
  // Some may be new in the file, or have other names by now.
  const names = (scene.peek()?.head.actuators ?? []).map((a) => a.name).filter((n) => keys.every((k) => n in k.values));
  if (names.length === 0) return '';
  const kinds = Object.fromEntries(names.map((n) => [n, keys[keys.length - 1].values[n].kind]));
  const usable = keys
    .filter((k) => names.every((n) => k.values[n].kind === kinds[n]))
    .map((k) => ({ time: k.time, values: Object.fromEntries(names.map((n) => [n, k.values[n]])) }));
  return programKeys(corners(usable, names).filter((k) => k.time > 0));
}
