// The platform of a printer: its border and a grid of 10 mm.
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

/// Width and depth in mm, kept as `userData`; the middle of the platform is the origin.
export function platformMesh(width: number, depth: number) {
  const group = new THREE.Group();
  const plate = new THREE.Mesh(new THREE.PlaneGeometry(width, depth), new THREE.MeshBasicMaterial({ color: grey, transparent: true, opacity: 0.14, side: THREE.DoubleSide, depthWrite: false }));
  const rim = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => new THREE.Vector3((x * width) / 2, (y * depth) / 2, 0));
  const border = new THREE.LineLoop(new THREE.BufferGeometry().setFromPoints(rim), new THREE.LineBasicMaterial({ color: new THREE.Color(cssColour('--faint') || '#8a93a0') }));
  group.add(plate, gridOf(width, depth), border);
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
