// The state of the page and its connection to the studio.
import { batch, computed, signal } from '@preact/signals';
import { readPacket } from './packet';
import type { Accuracy, Frame, FrameHead, Job, Problem, Scene, SceneHead } from './types';

export type Section = 'simulate' | 'make' | 'print';

const sections: Section[] = ['simulate', 'make', 'print'];
const asked = location.hash.slice(1).split('?')[0] as Section;
export const section = signal<Section>(sections.includes(asked) ? asked : 'simulate');

export const online = signal(false);
/// Number of connections opened so far: what was known before the last one may be outdated.
export const lines = signal(0);
export const helm = signal({ you: true, held: true, asked: false, waiting: false, pages: 1 });
export const mayDrive = computed(() => online.value && helm.value.you);

export const documentState = signal({ name: '', title: 'example', unsaved: false, undo: 0, redo: 0, accuracy: 'automatic' as Accuracy, digest: '', opened: 0 });
export const scene = signal<Scene | null>(null);
/// The latest frame; with linear elements it is a fast preview, too stiff to be a result, and that of a reduced model is
/// nearly one.
export const frame = signal<Frame | null>(null);
export const isRough = (f: Frame | null) => f?.head.reduced_error_mm !== undefined || (f?.head.order ?? scene.value?.head.order) === 1;
export const rough = computed(() => isRough(frame.value));
export const building = signal<{ stage: string; fraction: number } | null>(null);
export const problems = signal<Problem[]>([]);
/// `layers`: number of layers that can be viewed already.
export const slicing = signal<{ stage: string; fraction: number; layers?: number } | null>(null);
export const sliceError = signal('');
export const job = signal<Job | null>(null);
export const notice = signal('');

/// The requested values, by actuator; the frame holds the reached ones.
export interface Wanted {
  kind: string;
  value: number;
}
export const wanted = signal<Record<string, Wanted>>({});
export const wantedTime = signal(0);
export const following = signal(true);
/// Milliseconds from the last input to the frame that showed it.
export const latency = signal(0);
export const frameRate = signal(0);
/// The last input has not been answered by a frame yet: what is shown belongs to the one before.
export const unanswered = signal(false);

const listeners = new Set<(event: Record<string, unknown>) => void>();
export function onEvent(listener: (event: Record<string, unknown>) => void) {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

let takeBeside: (next: Frame) => void = () => {};
/// Frames of the second robot.
export function onBesideFrame(listener: (next: Frame) => void) {
  takeBeside = listener;
}

let socket: WebSocket | null = null;

function newPageKey(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(12));
  const key = Array.from(bytes, (b) => b.toString(16).padStart(2, '0')).join('');
  sessionStorage.setItem('pliant_page', key);
  return key;
}
const keptKey = sessionStorage.getItem('pliant_page');
/// Identifies this page; kept over reloads and lost connections.
export let page = keptKey ?? newPageKey();

const longestAnswer = 150; // ms
/// A duplicated tab has a copy of the key of the other one: if another page answers that the key is its own, this one
/// takes a new one, even where the answer of a busy page comes late.
export function claimPageKey(): Promise<void> {
  const pages = new BroadcastChannel('pliant_pages');
  const asked = page;
  const question = Math.random();
  return new Promise((resolve) => {
    pages.onmessage = ({ data }: MessageEvent<{ whose?: string; question?: number; taken?: number }>) => {
      if (data.whose === page) pages.postMessage({ taken: data.question });
      if (data.taken !== question || page !== asked) return; // several may answer
      page = newPageKey();
      socket?.close(); // and connects again under that key
      resolve();
    };
    pages.postMessage({ whose: asked, question });
    setTimeout(resolve, keptKey ? longestAnswer : 0);
  });
}

let retry = 250;
let sceneKnown = false; // this connection has announced the scene of the frames
let early: Frame | null = null; // the last frame of a scene that is still loading
let fields: string[] = [];
// Tags increase from page to page, so that a frame is never mistaken for the answer to another page's input.
let tag = Math.floor(performance.timeOrigin % 5e8);
const sentAt = new Map<number, number>();
const frameTimes: number[] = [];

export function send(message: Record<string, unknown>) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
}

/// Sends an input that is answered by a frame.
export function sendInput(message: Record<string, unknown>) {
  tag += 1;
  sentAt.set(tag, performance.now());
  unanswered.value = true;
  if (sentAt.size > 500) sentAt.delete(sentAt.keys().next().value as number);
  send({ ...message, tag });
}

export function wantFields(names: string[]) {
  fields = names;
  send({ type: 'fields', names });
}

/// What api() throws if the studio refuses a request.
export interface Refusal extends Error {
  changed?: boolean; // a file was changed elsewhere
}

export async function api(path: string, options: RequestInit = {}): Promise<Response> {
  const response = await fetch(path, { ...options, headers: { ...options.headers, 'X-Pliant-Page': page } }).catch(() => {
    throw new Error('The studio does not respond. Is it still running, and is this computer still connected to it?');
  });
  if (!response.ok) {
    const body = (await response.json().catch(() => ({}))) as { error?: string; changed?: boolean };
    const refusal: Refusal = new Error(body.error ?? `the studio answered ${response.status}`);
    refusal.changed = body.changed === true;
    throw refusal;
  }
  return response;
}

/// `tell` receives the reason of a refusal; the default shows a notice.
export async function post(path: string, body?: unknown, tell: (why: string) => void = say): Promise<boolean> {
  try {
    await api(path, {
      method: 'POST',
      headers: { 'Content-Type': 'application/json' },
      body: body === undefined ? undefined : JSON.stringify(body),
    });
    return true;
  } catch (error) {
    tell((error as Error).message);
    return false;
  }
}

/// Opens a robot that has no file yet, with this text.
export async function newRobot(text: string): Promise<boolean> {
  try {
    await api('/api/robot/new', { method: 'POST', headers: { 'Content-Type': 'text/plain' }, body: text });
    return true;
  } catch (error) {
    say((error as Error).message);
    return false;
  }
}

let noticeTimer = 0;
export function say(text: string) {
  notice.value = text;
  clearTimeout(noticeTimer);
  noticeTimer = window.setTimeout(() => (notice.value = ''), 6000);
}

/// Shows the robot's current target, whoever set it; not while an input of this page is pending.
function adopt({ wanted: to, lead }: FrameHead) {
  if (helm.value.you && sentAt.size > 0 && !lead) return; // while dragging a marker, a page requests no actuator values
  wantedTime.value = to.time;
  following.value = to.actuators.length === 0;
  const known = wanted.peek();
  const fresh = to.actuators.filter((a) => known[a.name]?.kind !== a.kind || known[a.name]?.value !== a.value);
  if (fresh.length > 0) wanted.value = { ...known, ...Object.fromEntries(fresh.map((a) => [a.name, { kind: a.kind, value: a.value }])) };
}

async function loadScene() {
  const response = await api('/api/scene');
  const loaded = readPacket<SceneHead>(await response.arrayBuffer());
  const frameResponse = await api('/api/frame');
  const bytes = await frameResponse.arrayBuffer();
  const fetched = bytes.byteLength > 0 ? readPacket<FrameHead>(bytes) : null;
  if (loaded.head.opened !== documentState.value.opened) return; // of the robot before
  // If the robot was rebuilt meanwhile, a newer scene is being loaded.
  if (sceneKnown && scene.value !== null && loaded.head.revision < scene.value.head.revision) return;
  const known = [fetched, early].filter((f) => f?.head.revision === loaded.head.revision) as Frame[];
  const first = known.sort((a, b) => b.head.sequence - a.head.sequence)[0] ?? null;
  early = null;
  batch(() => {
    const same = scene.value !== null && sameActuators(scene.value.head, loaded.head);
    sceneKnown = true;
    scene.value = loaded;
    frame.value = first;
    if (!same) wanted.value = Object.fromEntries(loaded.head.actuators.map((a) => [a.name, { kind: a.kind, value: restValue(a.kind) }]));
    if (frame.value) adopt(frame.value.head);
  });
}

function sameActuators(a: SceneHead, b: SceneHead) {
  return a.actuators.map((x) => x.name).join('\n') === b.actuators.map((x) => x.name).join('\n');
}

export function restValue(kind: string): number {
  return kind.endsWith('ratio') ? 1 : 0;
}

/// The nearest time of the program, which may have become shorter.
export function inProgram(time: number): number {
  return Math.min(Math.max(time, 0), scene.peek()?.head.program.duration ?? time);
}

export function driveAll() {
  const time = inProgram(wantedTime.value);
  if (following.value) return sendInput({ type: 'follow', time });
  const actuators = Object.entries(wanted.value).map(([name, w]) => ({ name, kind: w.kind, value: w.value }));
  sendInput({ type: 'drive', time, actuators });
}

/// Returns to rest and to the program; pending inputs will not be answered.
export function toRest() {
  sentAt.clear();
  unanswered.value = false;
  latency.value = 0;
  send({ type: 'rest' });
}

export async function loadJob() {
  job.value = (await (await api('/api/job')).json()) as Job;
}

let helmTimer = 0;
const helmKept = 10_000; // ms that the studio keeps control for a page without a connection
/// A page that is gone loses control when another page is heard after that.
function askForLostHelm() {
  clearTimeout(helmTimer);
  if (!helm.value.you && !helm.value.held) helmTimer = window.setTimeout(() => send({ type: 'ping' }), helmKept);
}

/// Where another robot was opened, the one before is shown no longer: this one may take long to build, or have an error.
function takeDocument(next: typeof documentState.value) {
  batch(() => {
    documentState.value = next;
    if (scene.peek() && scene.peek()!.head.opened !== next.opened) scene.value = frame.value = null;
  });
}

function receiveText(text: string) {
  const event = JSON.parse(text) as Record<string, unknown> & { type: string };
  if (event.type === 'helm') {
    helm.value = event as never;
    if (!helm.value.you) {
      sentAt.clear();
      unanswered.value = false;
    }
    askForLostHelm();
  }
  if (event.type === 'document') takeDocument(event as never);
  if (event.type === 'scene') {
    sentAt.clear(); // inputs to the robot before
    unanswered.value = false;
    loadScene().catch((e: Error) => say(e.message));
  }
  if (event.type === 'build') {
    building.value = event.stage ? (event as never) : null;
    if (event.stage === 'read') problems.value = [];
  }
  if (event.type === 'problem') problems.value = (event as unknown as { lines: Problem[] }).lines;
  if (event.type === 'slicing') {
    slicing.value = event.stage ? (event as never) : null;
    sliceError.value = (event.error as string) ?? '';
  }
  if (event.type === 'job' && event.revision === 0) job.value = null;
  else if (event.type === 'job') loadJob().catch((e: Error) => say(e.message));
  if (event.type === 'error') {
    sentAt.delete(Number(event.tag)); // a refused input is not answered by a frame
    unanswered.value = sentAt.size > 0;
    say(String(event.error));
  }
  if (event.type === 'news') say(String(event.text));
  for (const listener of listeners) listener(event);
}

function receiveFrame(buffer: ArrayBuffer) {
  const next = readPacket<FrameHead>(buffer);
  if (next.head.beside) return takeBeside(next);
  // A robot at rest sends a single frame, which may arrive before its scene.
  if (!sceneKnown || scene.value === null || next.head.revision !== scene.value.head.revision) {
    early = next;
    return;
  }
  const now = performance.now();
  frameTimes.push(now);
  while (frameTimes.length > 0 && frameTimes[0] < now - 1000) frameTimes.shift();
  batch(() => {
    const sent = sentAt.get(next.head.tag);
    if (sent !== undefined) {
      latency.value = now - sent;
      for (const key of sentAt.keys()) if (key <= next.head.tag) sentAt.delete(key);
    }
    frameRate.value = frameTimes.length;
    unanswered.value = sentAt.size > 0;
    frame.value = next;
    adopt(next.head);
  });
}

/// On a new connection everything known is outdated, possibly from another studio. The studio sends its whole state
/// again; anything not sent no longer exists.
function forget() {
  sceneKnown = false;
  early = null;
  sentAt.clear();
  batch(() => {
    unanswered.value = false;
    building.value = null;
    problems.value = [];
    slicing.value = null;
    online.value = true;
    lines.value += 1;
  });
}

const pingEvery = 5000; // ms
const mostSilentPings = 3; // unanswered pings before the connection counts as dead: a computer may be busy


export function connect() {
  const opened = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/live`);
  opened.binaryType = 'arraybuffer';
  socket = opened;
  let silentPings = 0;
  const lost = () => {
    clearInterval(ping);
    if (socket !== opened) return;
    socket = null;
    online.value = false;
    opened.close();
    setTimeout(connect, retry);
    retry = Math.min(2 * retry, 4000);
  };
  // A crashed computer does not close its connections: only missing answers reveal it.
  const ping = window.setInterval(() => {
    if (silentPings >= mostSilentPings) return lost();
    silentPings += 1;
    send({ type: 'ping' });
  }, pingEvery);
  opened.onopen = () => {
    retry = 250;
    forget();
    send({ type: 'hello', page });
    if (fields.length) send({ type: 'fields', names: fields });
  };
  opened.onmessage = (event: MessageEvent) => {
    silentPings = 0;
    if (typeof event.data === 'string') receiveText(event.data);
    else receiveFrame(event.data as ArrayBuffer);
  };
  opened.onclose = lost;
}

/// Gives up control at once when the page is closed.
window.addEventListener('pagehide', () => send({ type: 'steer', action: 'leave' }));

/// For tests: drops the connection as a network failure would.
export function dropLine() {
  socket?.close();
}
