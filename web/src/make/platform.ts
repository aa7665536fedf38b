// The platform of a printer: its border, a grid of 10 mm, its axes, and its size along the near edge.
import * as THREE from 'three';
import { cssColour } from '../theme';

const grey = 0x8a93a0;

function gridOf(width: number, depth: number) {
  const points: THREE.Vector3[] = [];
  const lines = (size: number, line: (t: number) => [THREE.Vector3, THREE.Vector3]) => {
    for (let t = -Math.floor(size / 20) * 10; t <= size / 2; t += 10) points.push(...line(t));
  };
  lines(width, (x) => [new THREE.Vector3(x, -depth / 2, 0), new THREE.Vector3(x, depth / 2, 0)]);
  lines(depth, (y) => [new THREE.Vector3(-width / 2, y, 0), new THREE.Vector3(width / 2, y, 0)]);
  return new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(points), new THREE.LineBasicMaterial({ color: grey, transparent: true, opacity: 0.35 }));
}

/// A line of text that lies in the plane of the platform, read from the near edge; `at` is the middle of its left end.
function flatText(text: string, colour: string, height: number, at: [number, number]) {
  const canvas = document.createElement('canvas');
  const pixels = 64;
  const font = `600 ${0.7 * pixels}px system-ui, sans-serif`;
  const g = canvas.getContext('2d')!;
  g.font = font;
  canvas.width = Math.ceil(g.measureText(text).width) + 4;
  canvas.height = pixels;
  g.font = font; // lost with the new size
  g.fillStyle = colour;
  g.textBaseline = 'middle';
  g.fillText(text, 2, pixels / 2);
  const map = new THREE.CanvasTexture(canvas);
  map.colorSpace = THREE.SRGBColorSpace;
  map.anisotropy = 8;
  const width = (height * canvas.width) / pixels;
  const sheet = new THREE.Mesh(new THREE.PlaneGeometry(width, height), new THREE.MeshBasicMaterial({ map, transparent: true, depthWrite: false, side: THREE.DoubleSide }));
  sheet.position.set(at[0] + width / 2, at[1], 0);
  return sheet;
}

/// The axes of placements, at the near left corner: x to the right, y to the back.
function axesAt(x: number, y: number, length: number, letter: number) {
  const group = new THREE.Group();
  const corner = new THREE.Vector3(x, y, 0.1);
  const axes: [string, THREE.Vector3, string, [number, number]][] = [
    ['x', new THREE.Vector3(1, 0, 0), '#d6453d', [x + length + 0.2 * letter, y]],
    ['y', new THREE.Vector3(0, 1, 0), '#3f9b4f', [x - 0.25 * letter, y + length + 0.6 * letter]],
  ];
  for (const [name, direction, colour, at] of axes)
    group.add(new THREE.ArrowHelper(direction, corner, length, colour, 0.35 * length, 0.2 * length), flatText(name, colour, letter, at));
  return group;
}

/// Width and depth in mm, kept as `userData`; the middle of the platform is the origin.
export function platformMesh(width: number, depth: number) {
  const group = new THREE.Group();
  const plate = new THREE.Mesh(new THREE.PlaneGeometry(width, depth), new THREE.MeshBasicMaterial({ color: grey, transparent: true, opacity: 0.14, side: THREE.DoubleSide, depthWrite: false }));
  const rim = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => new THREE.Vector3((x * width) / 2, (y * depth) / 2, 0));
  const border = new THREE.LineLoop(new THREE.BufferGeometry().setFromPoints(rim), new THREE.LineBasicMaterial({ color: new THREE.Color(cssColour('--faint') || '#8a93a0') }));
  const letter = 0.05 * Math.min(width, depth);
  const arrow = 0.12 * Math.min(width, depth);
  const size = `${+width.toFixed(1)} × ${+depth.toFixed(1)} mm, grid of 10 mm`;
  group.add(plate, gridOf(width, depth), border, axesAt(-width / 2, -depth / 2, arrow, letter));
  group.add(flatText(size, cssColour('--faint') || '#5a6472', letter, [-width / 2 + arrow + 2 * letter, -depth / 2 - 0.8 * letter]));
  group.position.z = -0.05;
  group.userData = { width, depth };
  return group;
}

/// Frees what the platform holds of the graphics card.
export function disposePlatform(platform: THREE.Object3D) {
  platform.traverse((o) => {
    const { geometry, material } = o as THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;
    geometry?.dispose();
    material?.map?.dispose();
    material?.dispose();
  });
}
