// Display settings of the robot view.
import { signal } from '@preact/signals';
import type { Frame } from '../types';

export type FieldName = 'material' | 'displacement' | 'von_mises' | 'stretch' | 'J' | 'energy';
export const fieldNames: { name: FieldName; label: string; unit: string; scale: number }[] = [
  { name: 'material', label: 'Materials', unit: '', scale: 1 },
  { name: 'displacement', label: 'Displacement', unit: 'mm', scale: 1 },
  { name: 'von_mises', label: 'Von Mises stress', unit: 'kPa', scale: 1e-3 },
  { name: 'stretch', label: 'Maximum stretch', unit: '', scale: 1 },
  { name: 'J', label: 'Volume ratio J', unit: '', scale: 1 },
  { name: 'energy', label: 'Strain energy density', unit: 'kJ/m³', scale: 1e-3 },
];

export const field = signal<FieldName>('material');
export const wireframe = signal(false);
export const ghost = signal(false);
export const exploded = signal(0);
export const showInside = signal(false);
export const sectionAxis = signal<'' | 'x' | 'y' | 'z'>('');
export const sectionAt = signal(0.5);
export const sectionFlipped = signal(false);
/// Displayed range, in the legend's unit.
export const fieldRange = signal<[number, number]>([0, 1]);
/// Fixed range of the colours; null: the range of the state.
export const fixedRange = signal<{ field: FieldName; low: number; high: number } | null>(null);
export const map = signal('pliant');
export const bands = signal(0);
/// End points of a measurement, in order: a surface point, or a marker.
export type Pick = { vertex: number } | { marker: number };
export const measuring = signal(false);
export const picks = signal<Pick[]>([]);
/// A recorded frame shown instead of the live one.
export const shownFrame = signal<Frame | null>(null);
/// A pinned state for comparison.
export interface Pinned {
  label: string;
  positions: Float32Array;
  frame: Frame;
  markers: string[]; // their names: the file may have others by now
  opened: number; // the robot that it is of
}
export const pinned = signal<Pinned | null>(null);
export const beside = signal(false);
