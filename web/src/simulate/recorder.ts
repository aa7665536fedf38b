// Records what the hands do as a program: [[program.key]] of a robot file.
import { signal } from '@preact/signals';
import { scene } from '../store';
import { reading } from './actuators';

interface Key {
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
    // As the file's own targets count, so that the keys fit it.
    const all = scene.peek()?.head.actuators ?? [];
    const values = Object.fromEntries(all.map((a) => [a.name, { kind: a.kind, value: reading(a, a.kind) }]));
    recorded.value = [...recorded.value, { time: (performance.now() - started) / 1000, values }];
  };
  timer = window.setInterval(take, interval_ms);
}

export function stopRecording() {
  clearInterval(timer);
  recording.value = false;
}

/// Of each actuator only what it was driven by at the end, and of keys in a straight line only the ends.
export function asProgram(): string {
  const keys = recorded.value;
  const names = scene.peek()?.head.actuators.map((a) => a.name) ?? [];
  if (keys.length < 2) return '';
  const kinds = Object.fromEntries(names.map((n) => [n, keys[keys.length - 1].values[n]?.kind]));
  const usable = keys.filter((k) => names.every((n) => k.values[n]?.kind === kinds[n]));
  const kept = usable.filter((k, i) => {
    const before = usable[i - 1];
    const after = usable[i + 1];
    if (!before || !after) return true;
    const share = (k.time - before.time) / (after.time - before.time);
    return names.some((n) => {
      const from = before.values[n].value;
      const to = after.values[n].value;
      return Math.abs(from + share * (to - from) - k.values[n].value) > 1e-3 * Math.max(Math.abs(to), Math.abs(from), 1e-9);
    });
  });
  const bare = (n: string) => (/^[A-Za-z0-9_-]+$/.test(n) ? n : JSON.stringify(n));
  const text = (n: string, v: number) => {
    const u = unit[kinds[n] ?? ''];
    return u ? `"${+v.toPrecision(5)} ${u}"` : `${+v.toPrecision(5)}`;
  };
  return kept
    .filter((k) => k.time > 0)
    .map((k) => ['[[program.key]]', `time = "${k.time.toFixed(2)} s"`, ...names.map((n) => `${bare(n)} = ${text(n, k.values[n].value)}`)].join('\n'))
    .join('\n\n');
}
