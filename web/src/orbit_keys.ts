// Keyboard control of a view that is orbited with the mouse.
import * as THREE from 'three';
import type { OrbitControls } from 'three/addons/controls/OrbitControls.js';

/// Orbits around the target by these angles, in radians, and multiplies the distance by `nearer`.
export function turnAround(camera: THREE.Camera, controls: OrbitControls, around: number, up: number, nearer: number) {
  const offset = camera.position.clone().sub(controls.target);
  const s = new THREE.Spherical().setFromVector3(new THREE.Vector3(offset.x, offset.z, -offset.y));
  s.theta += around;
  s.phi = Math.min(Math.max(s.phi - up, 0.05), Math.PI - 0.05);
  s.radius *= nearer;
  const back = new THREE.Vector3().setFromSpherical(s);
  camera.position.copy(controls.target).add(new THREE.Vector3(back.x, -back.z, back.y));
  controls.update();
}

/// Arrows orbit, plus and minus zoom, Home fits the view.
export function orbitKeys(e: KeyboardEvent, turn: (around: number, up: number, nearer: number) => void, home: () => void) {
  const step = 0.12;
  const moves: Record<string, () => void> = {
    ArrowLeft: () => turn(-step, 0, 1),
    ArrowRight: () => turn(step, 0, 1),
    ArrowUp: () => turn(0, step, 1),
    ArrowDown: () => turn(0, -step, 1),
    '+': () => turn(0, 0, 0.9),
    '-': () => turn(0, 0, 1.1),
    Home: home,
  };
  if (!moves[e.key]) return;
  moves[e.key]();
  e.preventDefault();
}

export const orbitHelp = 'Arrow keys rotate the view, plus and minus zoom, Home fits the view.';
