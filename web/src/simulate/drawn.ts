// How the things around a robot are drawn: builders of three.js objects that keep no state.
import * as THREE from 'three';
import { niceBelow } from './fit';

/// Frees what a group has drawn, and empties it.
export function emptied(group: THREE.Group) {
  for (const c of group.children as THREE.Mesh[]) {
    c.geometry.dispose();
    (c.material as THREE.Material).dispose();
  }
  group.clear();
}

/// Edges make the rotation of an object visible.
export function edgesOf(geometry: THREE.BufferGeometry) {
  const lines = new THREE.LineSegments(new THREE.EdgesGeometry(geometry, 24), new THREE.LineBasicMaterial({ color: 0x5c4410, transparent: true, opacity: 0.7 }));
  lines.frustumCulled = false;
  return lines;
}

/// A box of edges drawn over everything, of size 1.
export function draftBox() {
  const box = new THREE.LineSegments(new THREE.EdgesGeometry(new THREE.BoxGeometry(1, 1, 1)), new THREE.LineBasicMaterial({ color: 0x2f9bff, depthTest: false, transparent: true }));
  box.visible = false;
  box.renderOrder = 15;
  return box;
}

/// Transparent, but showing only the front of each part: its depth is drawn first, then the nearest surface. A depth
/// offset avoids flicker with coincident surfaces.
export function veil(geometry: THREE.BufferGeometry, colour: number, opacity: number, order: number) {
  const offset = { polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8 };
  const veil = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ color: colour, transparent: true, opacity, depthWrite: false, ...offset }));
  const depth = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ colorWrite: false, transparent: true, ...offset }));
  veil.renderOrder = order + 1;
  depth.renderOrder = order;
  depth.frustumCulled = veil.frustumCulled = false;
  veil.add(depth);
  veil.visible = false;
  return veil;
}

/// A half-space: a sheet with a grid, which fades out towards its rim and is transparent. The spacing of its lines is
/// 1, 2 or 5 times a power of ten, about ten per length of the robot.
export function groundMesh(geometry: THREE.BufferGeometry, robotSize: number) {
  const sphere = (geometry.computeBoundingSphere(), geometry.boundingSphere!);
  const material = new THREE.ShaderMaterial({
    uniforms: { middle: { value: sphere.center }, reach: { value: sphere.radius }, cell: { value: niceBelow(robotSize / 8) }, ink: { value: new THREE.Color(0x7d8794) } },
    vertexShader: 'varying vec3 at; varying vec3 facing; void main() { at = position; facing = abs(normal); gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }',
    fragmentShader: `uniform vec3 middle; uniform float reach; uniform float cell; uniform vec3 ink; varying vec3 at; varying vec3 facing;
        float line(float x) { float d = abs(fract(x / cell - 0.5) - 0.5) * cell; return 1.0 - smoothstep(0.0, 1.4 * fwidth(x), d); }
        void main() {
          float fade = 1.0 - smoothstep(0.45, 1.0, length(at - middle) / reach);
          float lines = facing.z > max(facing.x, facing.y) ? max(line(at.x), line(at.y)) : facing.x > facing.y ? max(line(at.y), line(at.z)) : max(line(at.x), line(at.z));
          gl_FragColor = vec4(ink, fade * (0.16 + 0.4 * lines));
        }`,
    transparent: true,
    depthWrite: false,
    side: THREE.DoubleSide,
  });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.renderOrder = -0.5;
  return mesh;
}
