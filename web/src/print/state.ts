// The print, as reported by the studio.
import { batch, computed, effect, signal } from '@preact/signals';
import { api, lines, mayDrive, onEvent, online, post, say } from '../store';
import type { Projector } from '../types';

export interface Now {
  state: { text: string; message: string; flags: Record<string, boolean> };
  job: { file: { name: string | null }; estimatedPrintTime: number | null; layers: number; canResume: boolean };
  progress: {
    completion: number | null;
    printTime: number | null;
    begun: number | null; // on the clock of the events
    printTimeLeft: number | null;
    layer: number | null;
    material: number | null;
    image: string | null;
    lit: boolean;
    litTime: number;
    exposureTime: number;
    exposures: number[];
    prompt: string | null;
    finished: boolean;
    failed: boolean;
  };
  machine: {
    axes: Record<string, { position: number; homed: boolean }>;
    slot: number;
    pump: boolean;
    door: 'open' | 'shut' | null;
    switches: Record<string, boolean>;
    firmware: string;
    linesSent: number;
    resends: number;
  };
  events: { number: number; clock: number; kind: string; text: string }[];
}

export interface MachineInfo {
  name: string;
  store: 'tower' | 'wall' | 'table' | 'none';
  axes: Record<string, { min: number; max: number; speed: number; rotary: boolean }>;
  vats: { slot: number; resin: string; fill_ml: number }[];
  carriage: { print: number; tower: number };
  platform: { width: number; depth: number; height: number };
  tower: { slots: number; first: number; pitch: number };
  wall: number;
  projector: Projector;
  switches: { axis: string; end: 'min' | 'max'; name: string }[];
  door: string | null; // the input that its switch is connected to
  emergency: { signal: 'none' | 'controller' | 'dtr' | 'rts' | 'file'; device: string; pin: number };
}

export interface PrintInfo {
  machine: MachineInfo | null;
  twin: boolean;
  device: string;
  speed: number;
  file: string;
  materials: { name: string; resin: string; exposure_s: number; colour: string }[];
  taken: number; // distinguishes this machine's pictures from those of an earlier one
  job: string;
  key: string; // of the job as it was when the machine was connected
  seconds: number;
  /** What of the job could not be verified. */
  warnings: string[];
  vats: { slot: number; resin: string; needed: string; materials: number[] }[];
  refills: { layer: number; slot: number; text: string }[];
}

export const info = signal<PrintInfo | null>(null);
export const now = signal<Now | null>(null);
export const events = signal<Now['events']>([]);
export const flags = computed(() => now.value?.state.flags ?? {});
export const busy = computed(() => ['printing', 'pausing', 'paused', 'cancelling'].some((f) => flags.value[f]));

/// True after a print that was begun, is neither complete nor failed, and cannot be resumed.
export function isCancelled({ state: { flags: f }, job: j, progress: p }: Now): boolean {
  const working = ['printing', 'pausing', 'paused', 'cancelling', 'error', 'closedOrError'].some((flag) => f[flag]);
  return !working && p.layer !== null && !p.finished && !p.failed && !j.canResume;
}

/// Verdict on a complete print; null: unknown.
export const verdict = signal<{ passed: boolean; reasons: string[] } | null>(null);

/// The connection over which the studio last reported the print.
const toldBy = signal(0);
/// False: the display dates from a lost connection, and the studio may have ended.
export const known = computed(() => online.value && toldBy.value === lines.value);
export const maySteer = computed(() => mayDrive.value && known.value);

const mostEvents = 400;

function take(next: Now) {
  const last = events.value[events.value.length - 1]?.number ?? 0;
  const fresh = next.events.filter((e) => e.number > last);
  if (fresh.length) events.value = [...events.value, ...fresh].slice(-mostEvents);
  now.value = next;
}

let loading = 0;
let meanwhile: Now[] = [];

/// Events that arrive while a response is pending may be newer than it: they are applied after it.
async function load() {
  const mine = ++loading;
  const line = lines.value;
  meanwhile = [];
  const loaded = (await (await api('/api/print')).json()) as PrintInfo & { now: Now };
  if (mine !== loading) return;
  loading = 0;
  if (busy.value && !loaded.machine) say('The studio was restarted: the print shown here was interrupted. If its job was saved, the print history can resume it.');
  batch(() => {
    info.value = loaded;
    events.value = [];
    now.value = null;
    toldBy.value = line;
    if (loaded.machine) [loaded.now, ...meanwhile].forEach(take);
  });
}

const retryAfter = 1000; // ms
function loadSurely() {
  load().catch((e: Error) => {
    if (!online.value) return; // requested again on the next connection
    say(e.message);
    setTimeout(loadSurely, retryAfter);
  });
}

onEvent((event) => {
  if (event.type === 'machine') loadSurely();
  if (event.type !== 'print' || !event.current) return;
  if (loading) meanwhile.push(event.current as Now);
  else take(event.current as Now);
});

const complete = computed(() => known.value && (now.value?.progress.finished ?? false) && !busy.value);
effect(() => {
  if (!complete.value) {
    verdict.value = null;
    return;
  }
  api('/api/print/verdict')
    .then((r) => r.json())
    .then((v: { passed: boolean; reasons: string[] } | null) => complete.value && (verdict.value = v))
    .catch((e: Error) => say(e.message));
});

export const host = (path: string, body: unknown) => post(`/api/print/host/${path}`, body);
