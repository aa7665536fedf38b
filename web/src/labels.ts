// Labels of things in a 3D view: page elements that follow the projected positions of their points.
import * as THREE from 'three';

export interface Label {
  element: HTMLElement;
  at: THREE.Vector3; // in world coordinates
}

/// Hides labels behind the camera or outside the picture, and of two that would overlap the later one. A label at the
/// edge moves inwards, so that all of it can be read.
export function placeLabels(labels: Label[], camera: THREE.Camera, width: number, height: number) {
  const taken: [number, number, number, number][] = [];
  for (const { element, at } of labels) {
    const p = at.clone().project(camera);
    const [x, y] = [((p.x + 1) / 2) * width, ((1 - p.y) / 2) * height];
    const [w, h] = [element.offsetWidth || 60, element.offsetHeight || 20];
    const inside = (middle: number, size: number, room: number) => Math.max(0, Math.min(middle - size / 2, room - size));
    const [left, top] = [inside(x, w, width), inside(y, h, height)];
    const box: [number, number, number, number] = [left, top, left + w, top + h];
    const covers = taken.some((t) => box[0] < t[2] && t[0] < box[2] && box[1] < t[3] && t[1] < box[3]);
    const seen = p.z < 1 && x > 0 && y > 0 && x < width && y < height && !covers;
    element.style.visibility = seen ? 'visible' : 'hidden';
    if (!seen) continue;
    taken.push(box);
    element.style.transform = `translate(${Math.round(box[0])}px, ${Math.round(box[1])}px)`;
  }
}
