// What has been seen since the robot was built: numbers for the plots, frames for the replay.
import { effect, signal } from '@preact/signals';
import { frame, scene } from '../store';
import type { Frame, SceneHead } from '../types';

const mostPoints = 4000;
const mostFrames = 900;

export interface Tracks {
  seconds: number[];
  cables: number[][]; // tension, N
  chambers: number[][]; // pressure, kPa
  markers: number[][]; // way from rest, mm
  places: [number, number, number][][];
  residual: number[];
}

export let tracks: Tracks = empty(null);
export let frames: Frame[] = [];
/// Counts up with every change of the two.
export const tracksVersion = signal(0);

function empty(head: SceneHead | null): Tracks {
  const lists = (n: number) => Array.from({ length: n }, () => [] as never[]);
  const cables = head?.actuators.filter((a) => a.type === 'cable').length ?? 0;
  const chambers = (head?.actuators.length ?? 0) - cables;
  return {
    seconds: [],
    cables: lists(cables),
    chambers: lists(chambers),
    markers: lists(head?.markers.length ?? 0),
    places: lists(head?.markers.length ?? 0),
    residual: [],
  };
}

export function clearTracks() {
  tracks = empty(scene.peek()?.head ?? null);
  frames = [];
  tracksVersion.value = tracksVersion.peek() + 1;
}

let started = 0;
let seenRevision = -1;

/// After a pause the last values are written down once more, so that the line does not lean into the next change.
function holdLast(seconds: number) {
  const n = tracks.seconds.length;
  if (n === 0 || seconds - tracks.seconds[n - 1] < 0.3) return;
  tracks.seconds.push(seconds - 0.02);
  for (const list of [tracks.residual, ...tracks.cables, ...tracks.chambers, ...tracks.markers]) list.push(list[n - 1]);
  for (const list of tracks.places) list.push(list[n - 1]);
}

function add(next: Frame) {
  const head = next.head;
  const rest = scene.peek()!.head.markers;
  if (tracks.seconds.length === 0) started = performance.now();
  const seconds = (performance.now() - started) / 1000;
  holdLast(seconds);
  tracks.seconds.push(seconds);
  head.cables.forEach((c, k) => tracks.cables[k]?.push(c.tension_N));
  head.chambers.forEach((c, k) => tracks.chambers[k]?.push(c.pressure_kPa));
  head.markers.forEach((p, k) => {
    const r = rest[k].rest;
    tracks.markers[k]?.push(Math.hypot(p[0] - r[0], p[1] - r[1], p[2] - r[2]));
    tracks.places[k]?.push(p);
  });
  tracks.residual.push(Math.max(head.residual, 1e-16));
  frames.push(next);
  if (frames.length > mostFrames) frames.shift();
  if (tracks.seconds.length > mostPoints) {
    for (const list of [tracks.seconds, tracks.residual, ...tracks.cables, ...tracks.chambers, ...tracks.markers, ...tracks.places])
      list.shift();
  }
  tracksVersion.value = tracksVersion.peek() + 1;
}

effect(() => {
  const next = frame.value;
  if (!next || !scene.peek()) return;
  if (next.head.revision !== seenRevision) {
    seenRevision = next.head.revision;
    clearTracks();
  }
  if (frames.length && frames[frames.length - 1].head.sequence === next.head.sequence) return;
  add(next);
});

/// Everything the plots show, as a table.
export function tracksCsv(head: SceneHead): string {
  const cables = head.actuators.filter((a) => a.type === 'cable');
  const chambers = head.actuators.filter((a) => a.type === 'chamber');
  const quoted = (s: string) => `"${s.replace(/"/g, '""')}"`;
  const columns = [
    'seconds',
    ...cables.map((c) => quoted(`${c.name}_tension_N`)),
    ...chambers.map((c) => quoted(`${c.name}_pressure_kPa`)),
    ...head.markers.flatMap((m) => ['x', 'y', 'z'].map((a) => quoted(`${m.name}_${a}_mm`))),
    'residual',
  ];
  const rows = tracks.seconds.map((t, i) =>
    [
      t.toFixed(4),
      ...tracks.cables.map((c) => c[i]),
      ...tracks.chambers.map((c) => c[i]),
      ...tracks.places.flatMap((p) => p[i]),
      tracks.residual[i],
    ].join(','),
  );
  return [columns.join(','), ...rows].join('\r\n') + '\r\n';
}
