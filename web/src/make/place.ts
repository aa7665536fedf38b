// Placement of a part before slicing: rotation, position on the platform, copies. Same as in the slicer.
import * as THREE from 'three';

export type Degrees = [number, number, number];

/// Rotation about x, then y, then z.
export function rotationOf([x, y, z]: Degrees): THREE.Matrix4 {
  const rad = Math.PI / 180;
  return new THREE.Matrix4().makeRotationFromEuler(new THREE.Euler(x * rad, y * rad, z * rad, 'ZYX'));
}

/// A direction of the part after rotation.
export function turned(degrees: Degrees, { x, y, z }: { x: number; y: number; z: number }): THREE.Vector3 {
  return new THREE.Vector3(x, y, z).transformDirection(rotationOf(degrees));
}

/// The angles of a rotation, rounded to a thousandth of a degree.
export function degreesOf(rotation: THREE.Matrix4): Degrees {
  const e = new THREE.Euler().setFromRotationMatrix(rotation, 'ZYX');
  const tidy = (rad: number) => {
    const degrees = Math.round((rad * 180e3) / Math.PI) / 1000;
    return degrees === 0 || degrees === -180 ? Math.abs(degrees) : degrees;
  };
  return [tidy(e.x), tidy(e.y), tidy(e.z)];
}

/// The rotation after which the face with this outward normal (of the currently rotated part) lies on the platform.
export function layOnFace(now: Degrees, normal: { x: number; y: number; z: number }): Degrees {
  const down = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(normal.x, normal.y, normal.z).normalize(), new THREE.Vector3(0, 0, -1));
  return degreesOf(new THREE.Matrix4().makeRotationFromQuaternion(down).multiply(rotationOf(now)));
}

export interface Placed {
  size: [number, number, number]; // of all copies, mm
  least: THREE.Vector3; // minimum corner of the rotated part
  shifts: [number, number][]; // offset of each copy from the first
  fits: boolean;
}

/// What can be printed on: the image, turned and off the platform's middle as the printer file says, on the platform; mm.
export interface Room {
  image: [number, number];
  offset: [number, number];
  turn: number; // degrees
  platform: [number, number];
}

function cosineAndSine(degrees: number): [number, number] {
  const exact = degrees % 90 === 0;
  const round = (v: number) => (exact ? Math.round(v) : v);
  return [round(Math.cos((degrees * Math.PI) / 180)), round(Math.sin((degrees * Math.PI) / 180))];
}

/// Its size around the middle of the platform; of an image that is turned by no quarter turn, that of its bounding box.
export function area({ image, offset, turn, platform }: Room): [number, number] {
  const [c, s] = cosineAndSine(turn).map(Math.abs);
  const [columns, rows] = image.map((size, i) => Math.max(0, size - 2 * Math.abs(offset[i])));
  return [Math.min(c * columns + s * rows, platform[0]), Math.min(s * columns + c * rows, platform[1])];
}

/// Whether a part of this size fits with its centre there.
function holds({ image, offset, turn, platform }: Room, [width, depth]: [number, number], [x, y]: [number, number]): boolean {
  const slack = 1e-3;
  const [c, s] = cosineAndSine(turn);
  return (
    width + 2 * Math.abs(x) <= platform[0] + slack &&
    depth + 2 * Math.abs(y) <= platform[1] + slack &&
    Math.abs(c) * width + Math.abs(s) * depth + 2 * Math.abs(c * x - s * y + offset[0]) <= image[0] + slack &&
    Math.abs(s) * width + Math.abs(c) * depth + 2 * Math.abs(s * x + c * y + offset[1]) <= image[1] + slack
  );
}

/// The grid of copies in as few rows as what can be printed on allows, as placed by `pliant slice --copies`.
export function placed(points: Float32Array, turn: Degrees, copies: number, spacing: number, room: Room, height: number, scale = 1, at: [number, number] = [0, 0]): Placed {
  const m = rotationOf(turn).scale(new THREE.Vector3(scale, scale, scale));
  const box = new THREE.Box3();
  const p = new THREE.Vector3();
  for (let i = 0; i < points.length; i += 3) box.expandByPoint(p.set(points[i], points[i + 1], points[i + 2]).applyMatrix4(m));
  const part = box.getSize(new THREE.Vector3());
  const length = (count: number, size: number) => count * size + (count - 1) * spacing;
  const fits = (columns: number, rows: number) => holds(room, [length(columns, part.x), length(rows, part.y)], [0, 0]);
  const most = (rows: number) => {
    let columns = 0;
    while (columns < copies && fits(columns + 1, rows)) ++columns;
    return columns;
  };
  let columns = most(1);
  for (let rows = 2; columns * (rows - 1) < copies; ++rows) {
    const narrower = most(rows);
    if (narrower === 0) break;
    columns = narrower;
  }
  columns = Math.max(1, columns);
  const rows = Math.ceil(copies / columns);
  const shifts: [number, number][] = [];
  for (let n = 0; n < copies; ++n) shifts.push([(n % columns) * (part.x + spacing), Math.floor(n / columns) * (part.y + spacing)]);
  const size: [number, number, number] = [length(columns, part.x), length(rows, part.y), part.z];
  return { size, least: box.min, shifts, fits: holds(room, [size[0], size[1]], at) && size[2] <= height + 1e-3 };
}
