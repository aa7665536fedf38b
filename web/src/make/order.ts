// What the slicing form holds, and the order that it gives: the options of `pliant slice`.
import { batch, computed, signal } from '@preact/signals';
import { onEvent, scene, sliceError } from '../store';
import { orderProblem } from './estimate';
import { paintTable, readPaint, strokes, touches } from './paint';
import type { Room } from './place';
import { wrongOf } from './wrong';

export interface PrinterInfo {
  name: string;
  layer_um: number;
  pixel_um: number;
  mask: string;
  image_mm: [number, number];
  image_offset_mm: [number, number];
  image_turn_deg: number;
  platform: { width_mm: number; depth_mm: number; height_mm: number };
  resins: { name: string; exposure_s: number; bottom_exposure_s: number }[];
  vats: { slot: number; resin: string }[];
}

export const roomOf = (p: PrinterInfo): Room => ({ image: p.image_mm, offset: p.image_offset_mm, turn: p.image_turn_deg, platform: [p.platform.width_mm, p.platform.depth_mm] });

export interface Bond {
  kind: 'overlap' | 'interlock';
  a: string;
  b: string;
  pixels: number;
  layers: number;
}

export interface Light {
  resin: string;
  time: string;
  bottom: string;
}

export const printer = signal('tower');
export const printerInfo = signal<PrinterInfo | null>(null);
export const copies = signal(1);
/// Texts of the fields, by option; "" or none: not set, as the layer height that is then the printer's.
export const fields = signal<Record<string, string>>({});
export const turn = signal<[number, number, number]>([0, 0, 0]);
export const scale = signal(1);
/// Offset of the part's centre from that of the platform, mm.
export const shift = signal<[number, number]>([0, 0]);
export const plainPixels = signal(false);
export const bonds = signal<Bond[]>([]);
export const lights = signal<Record<string, Light>>({});
/// A resin that no vat holds is to be filled into a free one.
export const anyVat = signal(false);
export const support = signal('');

/// The error of the last slicing, or what the studio finds wrong with the form as it is.
export const commas = computed(() => commaProblem(lights.value, scene.value?.head.materials.map((m) => m.name) ?? []));
export const problem = computed(() => sliceError.value || commas.value || orderProblem.value);
/// The option that it refers to, and its message.
export const wrong = computed(() => wrongOf(problem.value));

/// What has been changed is no longer wrong, until the studio says so again.
export function forgetProblem() {
  sliceError.value = '';
  orderProblem.value = '';
}

export const unitOf: Record<string, string> = { layer: 'um', 'least-layer': 'um', 'support-angle': '' };

/// A number with its field's unit; a unit in the text takes precedence.
function quantity(option: string, text: string): string {
  const unit = unitOf[option] ?? 'mm';
  return unit && /^[\d.eE+-]+$/.test(text.trim()) ? `${text.trim()} ${unit}` : text.trim();
}

const seconds = (text: string) => (/^[-+]?[\d.]+(e[-+]?\d+)?$/i.test(text.trim()) ? `${text.trim()} s` : text.trim());

/// Including painted supports, which an estimate does not need.
export const wholeOrder = (materials: string[]) => {
  const order = orderJson(materials);
  const table = support.value ? paintTable(touches()) : '';
  if (table) order['support-paint'] = table;
  return order;
};

/// Everything in the form, to notice whether somebody has touched it.
const formText = () => JSON.stringify([printer, copies, fields, turn, scale, shift, plainPixels, bonds, lights, anyVat, support, strokes].map((s) => s.peek()));
let given = formText(); // by the page itself or by a job

/// A value without the unit that its field adds.
function bare(option: string, text: string): string {
  const unit = unitOf[option] ?? 'mm';
  const number = unit && text.endsWith(` ${unit}`) ? text.slice(0, -unit.length - 1) : text;
  return quantity(option, number) === text ? number : text;
}

const texts = (list: unknown) => (Array.isArray(list) ? list.map(String) : []);
const withoutSeconds = (text: string) => text.trim().replace(/^([\d.]+) s$/, '$1');

function bondsOf(order: Record<string, unknown>): Bond[] {
  return (['overlap', 'interlock'] as const).flatMap((kind) =>
    texts(order[kind]).flatMap((text) => {
      const [, a, b, pixels, layers] = /^(.*)\+(.*)=(\d+),(\d+)$/.exec(text) ?? [];
      return a ? [{ kind, a, b, pixels: Number(pixels), layers: Number(layers) }] : [];
    }),
  );
}

function lightsOf(order: Record<string, unknown>): Record<string, Light> {
  const all: Record<string, Light> = {};
  const of = (m: string) => (all[m] ??= { resin: '', time: '', bottom: '' });
  const split = (text: string) => [text.slice(0, text.indexOf('=')), text.slice(text.indexOf('=') + 1)];
  for (const [m, resin] of texts(order.resin).map(split)) of(m).resin = resin;
  for (const [m, times] of texts(order.exposure).map(split)) [of(m).time, of(m).bottom] = [...times.split(',').map(withoutSeconds), ''];
  return all;
}

/// The form that gives this order.
export function setOrder(order: Record<string, unknown>) {
  const other = ['printer', 'copies', 'turn', 'scale', 'at', 'support', 'support-paint', 'layer_um'];
  const given = Object.entries(order).filter(([k, v]) => !other.includes(k) && (typeof v === 'string' || typeof v === 'number'));
  batch(() => {
    printer.value = String(order.printer ?? 'tower');
    copies.value = Number(order.copies ?? 1);
    fields.value = { ...(order.layer_um ? { layer: String(order.layer_um) } : {}), ...Object.fromEntries(given.map(([k, v]) => [k, bare(k, String(v))])) };
    turn.value = (order.turn as typeof turn.value | undefined) ?? [0, 0, 0];
    scale.value = Number(order.scale ?? 1);
    shift.value = (order.at as typeof shift.value | undefined) ?? [0, 0];
    plainPixels.value = order['no-anti-alias'] === true;
    bonds.value = bondsOf(order);
    lights.value = lightsOf(order);
    anyVat.value = order['any-vat'] === true;
    support.value = String(order.support ?? '');
    strokes.value = order['support-paint'] ? [{ touches: readPaint(String(order['support-paint'])) }] : [];
  });
}

/// Likewise, but only over a form that nobody has touched.
export function adoptOrder(order: Record<string, unknown>) {
  if (formText() !== given) return;
  setOrder(order);
  given = formText();
}

/// What belongs to one robot, not to the printer: another one does not begin with it.
export function forgetPart() {
  const untouched = formText() === given;
  batch(() => {
    turn.value = [0, 0, 0];
    scale.value = 1;
    shift.value = [0, 0];
    bonds.value = [];
    anyVat.value = false;
    support.value = '';
    strokes.value = [];
  });
  if (untouched) given = formText();
}

let opened: unknown; // number of the open document
let digest: unknown; // of its text
onEvent((event) => {
  if (event.type !== 'document') return;
  if (opened !== undefined && event.opened !== opened) forgetPart();
  if (digest !== undefined && event.digest !== digest) forgetProblem();
  [opened, digest] = [event.opened, event.digest];
});

/// In an order a comma separates two exposures: a decimal one would be taken for that.
export function commaProblem(all: Record<string, Light>, materials: string[]): string {
  for (const m of materials)
    for (const typed of [all[m]?.time, all[m]?.bottom]) if (typed?.includes(',')) return `--exposure ${m}: "${typed}" has a comma; the decimal sign is a point, as in 2.5`;
  return '';
}

export function orderJson(materials: string[]) {
  const order: Record<string, unknown> = { printer: printer.value, copies: copies.value };
  const needSupport = ['support-angle', 'support-spacing', 'support-tip', 'support-pillar', 'lift', 'raft'];
  for (const [option, text] of Object.entries(fields.value)) {
    if (!text.trim() || (needSupport.includes(option) && !support.value)) continue;
    order[option] = option === 'threshold' ? Number(text) : quantity(option, text);
  }
  if (support.value) order.support = support.value;
  if (turn.value.some((t) => t !== 0)) order.turn = turn.value;
  if (scale.value !== 1) order.scale = scale.value;
  if (shift.value.some((v) => v !== 0)) order.at = shift.value;
  if (plainPixels.value) order['no-anti-alias'] = true;
  else delete order.threshold;
  const used = Object.entries(lights.value).filter(([m]) => materials.includes(m));
  order.resin = used.filter(([, l]) => l.resin).map(([m, l]) => `${m}=${l.resin}`);
  order.exposure = used.filter(([, l]) => l.time).map(([m, l]) => `${m}=${seconds(l.time)}${l.bottom ? `,${seconds(l.bottom)}` : ''}`);
  if (anyVat.value) order['any-vat'] = true;
  for (const kind of ['overlap', 'interlock'] as const)
    order[kind] = bonds.value.filter((b) => b.kind === kind).map((b) => `${b.a}+${b.b}=${b.pixels},${b.layers}`);
  return order;
}
