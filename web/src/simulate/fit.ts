// Finds the camera position from which all points are visible.

type Vec = readonly [number, number, number];
const dot = (p: Vec, q: Vec) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];

export interface Fit {
  camera: [number, number, number];
  target: [number, number, number];
}

/// For a view along `forward` (unit and orthogonal, as `right` and `up`) with half angles of these tangents: the
/// nearest position that has all points (3n) in view, centred between the frustum planes that touch the points on
/// either side.
export function fitPoints(points: ArrayLike<number>, right: Vec, up: Vec, forward: Vec, tanX: number, tanY: number): Fit {
  const most = [-Infinity, -Infinity, -Infinity, -Infinity];
  let [near, far] = [Infinity, -Infinity];
  for (let i = 0; i + 2 < points.length; i += 3) {
    const p: Vec = [points[i], points[i + 1], points[i + 2]];
    const [a, b, c] = [dot(p, right), dot(p, up), dot(p, forward)];
    most[0] = Math.max(most[0], a - tanX * c);
    most[1] = Math.max(most[1], -a - tanX * c);
    most[2] = Math.max(most[2], b - tanY * c);
    most[3] = Math.max(most[3], -b - tanY * c);
    near = Math.min(near, c);
    far = Math.max(far, c);
  }
  if (!Number.isFinite(near)) return { camera: [-forward[0], -forward[1], -forward[2]], target: [0, 0, 0] };
  const back = Math.min(-(most[0] + most[1]) / (2 * tanX), -(most[2] + most[3]) / (2 * tanY), near - 1e-3 * (far - near) - 1e-9);
  const [a, b] = [(most[0] - most[1]) / 2, (most[2] - most[3]) / 2];
  const place = (c: number): [number, number, number] => [0, 1, 2].map((k) => a * right[k] + b * up[k] + c * forward[k]) as [number, number, number];
  return { camera: place(back), target: place((near + far) / 2) };
}

/// A number on an axis whose ticks are this far apart, with as many digits as tell it from its neighbours, at least 3.
export function tickText(x: number, apart: number): string {
  const place = (v: number) => Math.floor(Math.log10(Math.abs(v)));
  const needed = x !== 0 && apart > 0 ? place(x) - place(apart) + 2 : 3;
  const digits = Math.min(Math.max(needed, 3), 12);
  const long = Math.abs(x) >= 1e4 || (x !== 0 && Math.abs(x) < 1e-3);
  return long ? x.toExponential(digits - 1) : `${+x.toPrecision(digits)}`;
}

/// 1, 2 or 5 times a power of ten, at most `most`.
export function niceBelow(most: number): number {
  const power = 10 ** Math.floor(Math.log10(most));
  return power * ([5, 2].find((f) => f * power <= most) ?? 1);
}
