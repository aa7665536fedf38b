// Whether the job is still the one that slicing again would make: what has changed since, in the words of the form.
import { computed, effect } from '@preact/signals';
import { documentState, job, scene } from '../store';
import type { JobSource } from '../types';
import { adoptOrder, wholeOrder } from './order';

type Order = Record<string, unknown>;

const names: Record<string, string> = {
  printer: 'printer',
  layer: 'layer height',
  'least-layer': 'adaptive layers',
  copies: 'copies',
  spacing: 'spacing',
  turn: 'rotation',
  scale: 'scale',
  at: 'position',
  resin: 'resins',
  'any-vat': 'resins',
  exposure: 'exposure',
  overlap: 'bonds',
  interlock: 'bonds',
  support: 'supports',
  'support-paint': 'painted supports',
  lift: 'supports',
  raft: 'supports',
  hollow: 'hollowing',
  drain: 'drain holes',
  'least-feature': 'warning of thin walls',
  threshold: 'coverage threshold',
  'no-anti-alias': 'anti-aliasing',
};
const nameOf = (option: string) => names[option] ?? (option.startsWith('support') ? 'supports' : option);

/// An order with what it leaves out; without empty values.
function complete(order: Order): Order {
  const whole: Order = { printer: 'tower', copies: 1, ...order };
  if (whole.layer_um) whole.layer = `${whole.layer_um} um`;
  delete whole.layer_um;
  return Object.fromEntries(Object.entries(whole).filter(([, v]) => v !== '' && v !== false && !(Array.isArray(v) && v.length === 0)));
}

/// What differs from the robot text (by its digest) and the order that a job was sliced from.
export function changesSince(source: JobSource, digest: string, order: Order | null): string[] {
  const changes = source.robot === digest ? [] : ['robot'];
  if (!order) return changes;
  const [then, now] = [complete(source.order), complete(order)];
  for (const option of Object.keys({ ...then, ...now })) if (JSON.stringify(then[option]) !== JSON.stringify(now[option])) changes.push(nameOf(option));
  return [...new Set(changes)];
}

/// Of the job at hand; empty if it is current, or was opened from a file.
export const changes = computed(() => {
  const source = job.value?.source;
  const materials = scene.value?.head.materials.map((m) => m.name);
  return source ? changesSince(source, documentState.value.digest, materials ? wholeOrder(materials) : null) : [];
});

export const staleText = (what: string[]) => `This job was sliced before the last changes (${what.join(', ')}).`;

// A form that nobody has touched here takes the order of the job: after the page was loaded again, or beside another page.
effect(() => {
  const source = job.value?.source;
  if (source) adoptOrder(source.order);
});
