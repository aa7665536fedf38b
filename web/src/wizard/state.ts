// The open wizard, its progress, and the printer file that it writes.
import { effect, signal } from '@preact/signals';
import { api, post, say } from '../store';
import type { Projector } from '../types';

export type WizardName = 'machine' | 'projector' | 'exposure' | 'axes' | 'first';

export const titles: Record<WizardName, string> = {
  machine: 'Set up a machine',
  projector: 'Focus and size of the projector',
  exposure: 'Exposure finder',
  axes: 'Axes and swap',
  first: 'First print',
};

export const wizard = signal<WizardName | null>(null);
/// The wizard left for another section, or for a print that it requires.
export const waiting = signal<WizardName | null>(null);
export const step = signal(0);

export interface AxisSetup {
  name: string;
  letter: string;
  min: number;
  max: number;
  speed: number;
  acceleration: number;
  homing_speed: number;
  home: 'min' | 'max' | 'hand';
  rotary: boolean;
}

export interface PrinterSetup {
  name: string;
  title: string;
  built_in: boolean;
  store: string;
  layer_um: number;
  baud_rate: number;
  dialect: string;
  axes: AxisSetup[];
  slots: number;
  vats: { slot: number; resin: string; fill_ml: number }[];
  resins: { name: string; exposure_s: number; bottom_exposure_s: number; bottom_layers: number; longest_exposure_s: number }[];
  switches: { axis: string; end: string; name: string }[];
  platform: { width_mm: number; depth_mm: number; height_mm: number };
  projector: Projector;
}

/// The current printer file, "" before one is chosen; and its contents.
export const file = signal('');
export const setup = signal<PrinterSetup | null>(null);
export const device = signal('');
export const projectorAt = signal('');

let asked = 0;
export async function read(name = file.value) {
  const mine = ++asked;
  try {
    const told = (await (await api(`/api/printer/setup?name=${encodeURIComponent(name)}`)).json()) as PrinterSetup;
    if (mine === asked) setup.value = told;
  } catch (error) {
    if (mine !== asked) return;
    setup.value = null;
    say((error as Error).message);
  }
}

effect(() => {
  if (file.value) void read(file.value);
  else setup.value = null;
});

export interface Change {
  key: string;
  value: unknown;
}

/// Writes values in place into the printer file. False: refused, with the reason given to `tell`.
export async function write(changes: Change[], tell?: (why: string) => void): Promise<boolean> {
  if (changes.length === 0) return true;
  if (!(await post('/api/printer/set', { name: file.value, changes }, tell))) return false;
  await read();
  return true;
}

export function open(name: WizardName) {
  wizard.value = name;
  waiting.value = null;
  step.value = 0;
}
