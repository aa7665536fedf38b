// Painted supports: brush touches on the drawn part, in the format of `pliant slice --support-paint`.
import { signal } from '@preact/signals';
import * as THREE from 'three';

export type Wish = 'enforce' | 'block' | 'usual';

export interface Touch {
  wish: Wish;
  at: [number, number, number]; // mm, in the coordinates of the drawn part
  normal: [number, number, number]; // outward, of length 1
  radius: number; // mm
}

export interface Stroke {
  touches: Touch[];
}

export const strokes = signal<Stroke[]>([]);
export const touches = () => strokes.value.flatMap((s) => s.touches);

export const columns = 'wish,x (mm),y (mm),z (mm),nx,ny,nz,radius (mm)';

const text = (v: number, digits: number) => String(Number(v.toFixed(digits)));

/// The table; "" if nothing is painted.
export function paintTable(list: Touch[]): string {
  if (list.length === 0) return '';
  const rows = list.map((t) => [t.wish, ...t.at.map((v) => text(v, 4)), ...t.normal.map((v) => text(v, 4)), text(t.radius, 3)].join(','));
  return `${columns}\n${rows.join('\n')}\n`;
}

/// Parses a table written by this page or by hand. Throws an error that names the line.
export function readPaint(table: string): Touch[] {
  const lines = table.split(/\r?\n/).map((l) => l.trim());
  const rows = lines.map((l, k) => ({ l, k })).filter(({ l }) => l && !l.startsWith('#'));
  if (rows.shift()?.l !== columns) throw new Error(`the first line must be: ${columns}`);
  return rows.map(({ l, k }) => {
    const [wish, ...cells] = l.split(',');
    const n = cells.map(Number);
    if (!['enforce', 'block', 'usual'].includes(wish) || n.length !== 7 || !n.every(Number.isFinite)) throw new Error(`line ${k + 1}: enforce, block or usual and seven numbers are needed`);
    return { wish: wish as Wish, at: [n[0], n[1], n[2]], normal: [n[3], n[4], n[5]], radius: n[6] };
  });
}

/// Subdivides triangles until no side is longer than `side`, up to some 100,000 triangles, so that paint on large faces
/// is visible. `from`: the original triangle of each new one.
export function refined(points: Float32Array, triangles: Uint32Array, side: number): { points: Float32Array; from: Uint32Array } {
  const most = 100_000;
  const corner = (i: number) => new THREE.Vector3(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
  const parts = (longest: number, s: number) => Math.max(1, Math.min(40, Math.ceil(longest / s)));
  const longest = new Float32Array(triangles.length / 3);
  for (let t = 0; t < longest.length; ++t) {
    const [a, b, c] = [0, 1, 2].map((k) => corner(triangles[3 * t + k]));
    longest[t] = Math.max(a.distanceTo(b), b.distanceTo(c), c.distanceTo(a));
  }
  const count = (s: number) => longest.reduce((sum, l) => sum + parts(l, s) ** 2, 0);
  let s = side;
  while (count(s) > most && s < 1e4 * side) s *= 1.3;
  const total = count(s);
  const out = new Float32Array(9 * total);
  const from = new Uint32Array(total);
  let at = 0;
  for (let t = 0; t < longest.length; ++t) {
    const [a, b, c] = [0, 1, 2].map((k) => corner(triangles[3 * t + k]));
    const n = parts(longest[t], s);
    const place = (i: number, j: number) => a.clone().addScaledVector(b.clone().sub(a), i / n).addScaledVector(c.clone().sub(a), j / n);
    const put = (...corners: THREE.Vector3[]) => {
      corners.forEach((p, k) => p.toArray(out, 9 * at + 3 * k));
      from[at++] = t;
    };
    for (let i = 0; i < n; ++i)
      for (let j = 0; i + j < n; ++j) {
        put(place(i, j), place(i + 1, j), place(i, j + 1));
        if (i + j < n - 1) put(place(i + 1, j), place(i + 1, j + 1), place(i, j + 1));
      }
  }
  return { points: out, from };
}

export const wishColours: Record<Exclude<Wish, 'usual'>, string> = { enforce: '#1668d8', block: '#d9780b' };

/// The paint on each corner of these triangles: that of the last touch whose ball contains it, on a face with a similar
/// normal. 0: none, 1: enforce, 2: block.
export function painted(points: Float32Array, normals: Float32Array, list: Touch[], into: Uint8Array, first = 0) {
  for (const t of list.slice(first)) {
    const code = { usual: 0, enforce: 1, block: 2 }[t.wish];
    const r2 = t.radius * t.radius;
    const [x, y, z] = t.at;
    const [nx, ny, nz] = t.normal;
    for (let i = 0; i < into.length; ++i) {
      const dx = points[3 * i] - x;
      const dy = points[3 * i + 1] - y;
      const dz = points[3 * i + 2] - z;
      if (dx * dx + dy * dy + dz * dz > r2) continue;
      if (normals[3 * i] * nx + normals[3 * i + 1] * ny + normals[3 * i + 2] * nz <= 0) continue;
      into[i] = code;
    }
  }
}
