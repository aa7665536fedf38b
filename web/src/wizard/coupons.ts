// Test pieces for machine setup: robots as text, without moving parts.
import type { PrinterSetup } from './state';

const f = (v: number) => String(Number(v.toFixed(4)));
type Box = [number, number, number, number, number, number];
const boxText = ([x0, y0, z0, x1, y1, z1]: Box) => `{ box = [[${f(x0)}, ${f(y0)}, ${f(z0)}], [${f(x1)}, ${f(y1)}, ${f(z1)}]] }`;

export const coupon = { width: 9, depth: 11, base: 0.6, height: 2.6, gap: 2 };
/// Widths of the fins, in pixels.
export const fins = [2, 3, 5, 8];

/// A plate with fins of these widths, and studs at its front that count its number.
function boxesOf(number: number, x: number, y: number, pixel: number): Box[] {
  const { width, depth, base, height } = coupon;
  const boxes: Box[] = [[x, y, 0, x + width, y + depth, base]];
  let at = x + 1;
  for (const px of fins) {
    boxes.push([at, y + 4, 0, at + px * pixel, y + depth - 1, height]);
    at += Math.max(px * pixel, 0.4) + 1.2;
  }
  for (let k = 0; k < number; ++k) {
    const [column, row] = [k % 5, Math.floor(k / 5)];
    boxes.push([x + 0.6 + 1.6 * column, y + 0.5 + 1.5 * row, 0, x + 1.6 + 1.6 * column, y + 1.5 + 1.5 * row, base + 0.8]);
  }
  return boxes;
}

/// Evenly spaced exposures, to a hundredth of a second.
export function ramp(from: number, to: number, count: number): number[] {
  return Array.from({ length: count }, (_, k) => Math.round(100 * (from + ((to - from) * k) / Math.max(count - 1, 1))) / 100);
}

const head = (name: string) => `name = "${name}"\nlength_unit = "mm"\n`;
const quoted = (text: string) => JSON.stringify(text);
const material = (name: string, resin: string, more = '') => `\n[material.${name}]\nyoungs_modulus = "1 MPa"\npoisson_ratio = 0.45\nresin = ${quoted(resin)}\n${more}`;

/// One piece for each exposure, in as many rows as the image needs; the bottom layers of all are exposed equally long.
export function exposureRobot(setup: PrinterSetup, resin: string, seconds: number[], bottom: number): string {
  const p = setup.projector;
  const room = Math.min(p.width * p.pixel, setup.platform.width_mm);
  const columns = Math.max(1, Math.floor((room + coupon.gap) / (coupon.width + coupon.gap)));
  const bodies = seconds.map((s, k) => {
    const x = (k % columns) * (coupon.width + coupon.gap);
    const y = -Math.floor(k / columns) * (coupon.depth + coupon.gap);
    return `\n[[body]]\nname = "piece ${k + 1}"\nmaterial = "test"\nexposure = "${f(s)} s"\ngeometry = { union = [${boxesOf(k + 1, x, y, p.pixel).map(boxText).join(', ')}] }\n`;
  });
  const fixed = `\n[[fixed]]\nname = "base"\nbox = [[0, 0, 0], [${coupon.width}, ${coupon.depth}, 0]]\n`;
  const foot = `bottom_exposure = "${f(Math.max(bottom, ...seconds))} s"\n`;
  return head('exposure finder') + material('test', resin, foot) + bodies.join('') + fixed;
}

/// Two small plates side by side, each in the resin of a different vat if there are two: one swap.
export function swapRobot(setup: PrinterSetup): string {
  const resins = [...new Set(setup.vats.map((v) => v.resin).filter(Boolean))].slice(0, 2);
  const bodies = resins.map((_, k) => `\n[[body]]\nname = "plate ${k + 1}"\nmaterial = "m${k + 1}"\ngeometry = ${boxText([6 * k, 0, 0, 6 * k + 6, 6, 0.5])}\n`);
  const fixed = '\n[[fixed]]\nname = "base"\nbox = [[0, 0, 0], [6, 6, 0]]\n';
  return head('axes and swap') + resins.map((r, k) => material(`m${k + 1}`, r)).join('') + bodies.join('') + fixed;
}
