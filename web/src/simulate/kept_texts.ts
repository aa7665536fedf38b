// Texts that were typed for one robot and not applied before another was opened, by another page or in a studio that was
// started again: each comes back with its own robot, never into the file of another one.
import { signal } from '@preact/signals';

/// The robot in the editor: its file ('': none yet), its title, and its number.
export interface Origin {
  name: string;
  title: string;
  opened: number;
}

export interface KeptText extends Origin {
  text: string;
}

export const keptTexts = signal<KeptText[]>([]);

/// Numbers are given anew by a studio that is started again: then a robot without a file is known by its title.
export function isSameRobot(a: Origin, b: Origin, restarted: boolean): boolean {
  if (a.opened === b.opened && !restarted) return true;
  return a.name !== '' || b.name !== '' ? a.name === b.name : restarted && a.title === b.title;
}

export function keep(text: string, { name, title, opened }: Origin) {
  keptTexts.value = [...keptTexts.value.filter((k) => !isSameRobot(k, { name, title, opened }, false)), { text, name, title, opened }];
}

export function forgetKept(which: KeptText) {
  keptTexts.value = keptTexts.value.filter((k) => k !== which);
}

/// The text that was kept of this robot, which is then no longer kept; null: none.
export function takeKept(robot: Origin): string | null {
  const found = keptTexts.value.find((k) => isSameRobot(k, robot, false));
  if (found) forgetKept(found);
  return found?.text ?? null;
}
