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

/// The grid of copies in as few rows as the width of what can be printed on allows, as placed by `pliant slice --copies`.
export function placed(points: Float32Array, turn: Degrees, copies: number, spacing: number, [width, depth]: [number, number], height: number, scale = 1, at: [number, number] = [0, 0]): Placed {
  const m = rotationOf(turn).scale(new THREE.Vector3(scale, scale, scale));
  const box = new THREE.Box3();
  const p = new THREE.Vector3();
  for (let i = 0; i < points.length; i += 3) box.expandByPoint(p.set(points[i], points[i + 1], points[i + 2]).applyMatrix4(m));
  const part = box.getSize(new THREE.Vector3());
  const fitting = (room: number, size: number) => Math.max(0, Math.min(10000, Math.floor((room + spacing + 1e-3) / (size + spacing))));
  const columns = Math.max(1, Math.min(copies, fitting(width, part.x)));
  const rows = Math.ceil(copies / columns);
  const shifts: [number, number][] = [];
  for (let n = 0; n < copies; ++n) shifts.push([(n % columns) * (part.x + spacing), Math.floor(n / columns) * (part.y + spacing)]);
  const size: [number, number, number] = [columns * part.x + (columns - 1) * spacing, rows * part.y + (rows - 1) * spacing, part.z];
  const slack = 1e-3;
  return { size, least: box.min, shifts, fits: size[0] + 2 * Math.abs(at[0]) <= width + slack && size[1] + 2 * Math.abs(at[1]) <= depth + slack && size[2] <= height + slack };
}
