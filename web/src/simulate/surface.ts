// Numbers of a surface of triangles: normals, edges, and what its vertices are coloured by.
import type { Scene } from '../types';

type Index = ArrayLike<number>;

/// Writes unit normals of the vertices into `n`, weighted by area; vertices are already duplicated along sharp edges.
export function writeNormals(p: Float32Array, index: Index, n: Float32Array) {
  n.fill(0);
  for (let t = 0; t < index.length; t += 3) {
    const a = 3 * index[t];
    const b = 3 * index[t + 1];
    const c = 3 * index[t + 2];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const i of [a, b, c]) {
      n[i] += x;
      n[i + 1] += y;
      n[i + 2] += z;
    }
  }
  for (let i = 0; i < n.length; i += 3) {
    const length = Math.hypot(n[i], n[i + 1], n[i + 2]) || 1;
    n[i] /= length;
    n[i + 1] /= length;
    n[i + 2] /= length;
  }
}

/// Each edge once, as pairs of vertices.
export function edgesOfTriangles(index: Index) {
  const edges: number[] = [];
  for (let t = 0; t < index.length; t += 3)
    for (const [a, b] of [[0, 1], [1, 2], [2, 0]]) if (index[t + a] < index[t + b]) edges.push(index[t + a], index[t + b]);
  return edges;
}

/// Runs of triangles of one material, [first index, count, material]; they are sorted by it.
export function materialRuns(scene: Scene): [number, number, number][] {
  const triangles = scene.u32('triangles');
  const material = scene.u32('material');
  const runs: [number, number, number][] = [];
  scene.head.materials.forEach((_, m) => {
    let begin = -1;
    let end = 0;
    for (let t = 0; t < triangles.length; t += 3) {
      if (material[triangles[t]] !== m) continue;
      if (begin < 0) begin = t;
      end = t + 3;
    }
    if (begin >= 0) runs.push([begin, end - begin, m]);
  });
  return runs;
}

/// How far each vertex has moved, mm.
export function displacements(rest: Float32Array, now: Float32Array) {
  const values = new Float32Array(rest.length / 3);
  for (let v = 0; v < values.length; ++v)
    values[v] = Math.hypot(now[3 * v] - rest[3 * v], now[3 * v + 1] - rest[3 * v + 1], now[3 * v + 2] - rest[3 * v + 2]);
  return values;
}

/// Lowest and highest of the values. Differences this small, in the legend's unit (`scale` times the values), are the
/// solver's noise, as at rest: one colour, not a pattern.
export function dataRange(values: Float32Array, scale: number): [number, number] {
  let low = Infinity, high = -Infinity;
  for (const v of values) {
    if (v < low) low = v;
    if (v > high) high = v;
  }
  const [noise, least] = [1e-6 / scale, 0.01 / scale];
  if (!(high - low > noise)) {
    if (Math.abs(low) <= noise) low = 0;
    high = low + least;
  }
  return [low, high];
}
