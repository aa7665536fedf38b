// The 3D view that is on the page, for what stands over it.
import { signal } from '@preact/signals';
import type { PerspectiveCamera } from 'three';
import type { RobotView } from './view';

export const theView = signal<RobotView | null>(null);

type Project = (p: [number, number, number]) => [number, number];
const listeners = new Set<(project: Project, camera: PerspectiveCamera) => void>();

/// Hears of every picture that is drawn.
export function onDrawn(listener: (project: Project, camera: PerspectiveCamera) => void) {
  listeners.add(listener);
  theView.peek()?.invalidate();
  return () => listeners.delete(listener);
}

export function drawn(project: Project, camera: PerspectiveCamera) {
  for (const listener of listeners) listener(project, camera);
}
