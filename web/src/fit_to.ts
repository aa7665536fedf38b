// A 3D view takes the size of the element that its canvas lies in.
import type * as THREE from 'three';

/// False if the element is not shown, and so has no size.
export function fitTo(canvas: HTMLCanvasElement, renderer: THREE.WebGLRenderer, camera: THREE.PerspectiveCamera): boolean {
  const box = canvas.parentElement!.getBoundingClientRect();
  if (!box.width) return false;
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  renderer.setSize(box.width, box.height, false);
  camera.aspect = box.width / box.height;
  camera.updateProjectionMatrix();
  return true;
}
