// The current 3D view, for its overlays.
import { signal } from '@preact/signals';
import type { PerspectiveCamera } from 'three';
import type { RobotView } from './view';

export const theView = signal<RobotView | null>(null);

type Project = (p: [number, number, number]) => [number, number];
const listeners = new Set<(project: Project, camera: PerspectiveCamera) => void>();

/// The listener is called after every drawn frame.
export function onDrawn(listener: (project: Project, camera: PerspectiveCamera) => void) {
  listeners.add(listener);
  theView.peek()?.invalidate();
  return () => listeners.delete(listener);
}

export function drawn(project: Project, camera: PerspectiveCamera) {
  for (const listener of listeners) listener(project, camera);
}
