// From where the robot is seen: the camera, and the mouse and keys that move it.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { turnAround } from '../orbit_keys';
import { fitPoints } from './fit';

export type Side = 'home' | 'front' | 'back' | 'left' | 'right' | 'top' | 'bottom';
const sides: Record<Side, [number, number, number]> = {
  home: [0.55, -1.25, 0.62],
  front: [0, -1, 0.0001],
  back: [0, 1, 0.0001],
  left: [-1, 0, 0.0001],
  right: [1, 0, 0.0001],
  top: [0, -0.0001, 1],
  bottom: [0, -0.0001, -1],
};

export class Viewpoint {
  readonly camera = new THREE.PerspectiveCamera(32, 1, 0.1, 10000);
  readonly controls: OrbitControls;

  constructor(canvas: HTMLCanvasElement, onChange: () => void) {
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener('change', onChange);
  }

  dispose() {
    this.controls.dispose();
  }

  resize(width: number, height: number) {
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  /// Fits these points into view from this side or, without one, from the current direction. The margin leaves room for
  /// overlays.
  fit(points: Float32Array, side: Side | undefined, margin: number) {
    const back = side ? new THREE.Vector3(...sides[side]).normalize() : this.camera.getWorldDirection(new THREE.Vector3()).negate();
    const forward = back.clone().negate();
    const right = new THREE.Vector3().crossVectors(forward, new THREE.Vector3(0, 0, 1)).normalize();
    const up = new THREE.Vector3().crossVectors(right, forward);
    const tan = Math.tan((this.camera.fov * Math.PI) / 360);
    const fit = fitPoints(points, right.toArray(), up.toArray(), forward.toArray(), margin * tan * this.camera.aspect, margin * tan);
    this.controls.target.set(...fit.target);
    this.camera.position.set(...fit.camera);
    const distance = this.distance();
    this.camera.near = distance / 200;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  /// Position and target of the camera, mm; can be restored.
  get pose(): number[] {
    return [...this.camera.position.toArray(), ...this.controls.target.toArray()].map((v) => +v.toFixed(2));
  }
  set pose(six: number[]) {
    this.camera.position.set(six[0], six[1], six[2]);
    this.controls.target.set(six[3], six[4], six[5]);
    this.controls.update();
  }

  copy(other: Viewpoint) {
    this.camera.position.copy(other.camera.position);
    this.controls.target.copy(other.controls.target);
    this.camera.near = other.camera.near;
    this.camera.far = other.camera.far;
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  turn(around: number, up: number, nearer: number) {
    turnAround(this.camera, this.controls, around, up, nearer);
  }

  /// Pixels per millimetre at the camera's target, on a canvas so many pixels high.
  pixelsPerMm(height: number) {
    return height / (2 * Math.tan((this.camera.fov * Math.PI) / 360) * this.distance());
  }

  private distance() {
    return this.camera.position.distanceTo(this.controls.target);
  }
}
