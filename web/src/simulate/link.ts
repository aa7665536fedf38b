// A link that restores robot, view and state.
import { unlessLost } from '../discard';
import { documentState, driveAll, following, inProgram, post, scene, say, sendInput, wanted, wantedTime, type Wanted } from '../store';
import { theView } from './the_view';
import * as look from './view_state';

interface Kept {
  file: string; // '' if the robot has no file in the folder
  robot: string;
  pose: number[];
  field: look.FieldName;
  section: ['' | 'x' | 'y' | 'z', number];
  time: number;
  following: boolean;
  wanted: Record<string, Wanted>;
}

export function linkText(): string {
  const kept: Kept = {
    file: documentState.peek().name,
    robot: scene.peek()?.head.robot ?? '',
    pose: theView.peek()?.pose ?? [],
    field: look.field.peek(),
    section: [look.sectionAxis.peek(), look.sectionAt.peek()],
    time: wantedTime.peek(),
    following: following.peek(),
    wanted: wanted.peek(),
  };
  return `${location.origin}${location.pathname}#simulate?${encodeURIComponent(JSON.stringify(kept))}`;
}

/// The state requested by the address; null if there is none, or it is invalid.
export function readLink(hash: string): Kept | null {
  const at = hash.indexOf('?');
  if (at < 0) return null;
  try {
    const kept = JSON.parse(decodeURIComponent(hash.slice(at + 1))) as Kept;
    const numbers = (list: unknown, n: number) => Array.isArray(list) && list.length === n && list.every((v) => Number.isFinite(v));
    const known = look.fieldNames.some((f) => f.name === kept.field) && ['', 'x', 'y', 'z'].includes(kept.section?.[0]);
    return known && numbers(kept.pose, 6) && Number.isFinite(kept.time) && typeof kept.wanted === 'object' && kept.wanted ? kept : null;
  } catch {
    return null;
  }
}

let pending = readLink(location.hash);
if (location.hash.includes('?') && !pending) setTimeout(() => say('The link cannot be read: its state is ignored.'), 0);

/// Applies it once robot and view are ready; a robot from a file is opened first.
export async function restoreLink() {
  const kept = pending;
  const head = scene.peek()?.head;
  const view = theView.peek();
  if (!kept || !head || !view) return;
  pending = null;
  history.replaceState(null, '', '#simulate');
  if (kept.file !== documentState.peek().name && kept.file) {
    return unlessLost(`Opening the link to ${kept.file}`, async () => {
      pending = kept;
      if (!(await post('/api/open', { name: kept.file }))) pending = null;
    });
  }
  if (head.robot !== kept.robot) return say(`The link is for "${kept.robot}", but the open robot is "${head.robot}".`);
  view.pose = kept.pose;
  look.field.value = kept.field;
  [look.sectionAxis.value, look.sectionAt.value] = kept.section;
  wantedTime.value = inProgram(kept.time);
  following.value = kept.following;
  if (kept.following) return sendInput({ type: 'follow', time: wantedTime.value });
  wanted.value = Object.fromEntries(head.actuators.map((a) => [a.name, kept.wanted[a.name] ?? wanted.peek()[a.name]]));
  driveAll();
}
