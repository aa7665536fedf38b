// Playback of the whole program, run like `pliant simulate`: in seconds if the robot moves in time.
import { computed, effect, signal } from '@preact/signals';
import { Icon } from '../icons';
import { readPacket } from '../packet';
import { api, mayDrive, post, say, scene } from '../store';
import type { Frame, FrameHead } from '../types';
import { inSeconds, programTime } from './program_time';
import { begin, refused, result, searching } from './search';
import * as look from './view_state';

interface Found {
  steps: number;
  duration: number;
  timed: boolean;
  message: string;
  warnings: string[];
}
interface Motion extends Found {
  frames: Frame[];
  revision: number;
}

/// The motion available for playback; null: none.
export const motion = signal<Motion | null>(null);
export const loading = signal<number | null>(null); // share of the states that have been loaded
const playing = signal(false);
const at = signal(0); // s
const speed = signal(1);

const serverFields = ['von_mises', 'stretch', 'J', 'energy'];
let wantedLoad = 0;

/// Loads all states, with the current field.
async function load(found: Found, revision: number, field: string) {
  const mine = ++wantedLoad;
  const query = serverFields.includes(field) ? `?field=${field}` : '';
  const frames: Frame[] = [];
  loading.value = 0;
  try {
    for (let k = 0; k < found.steps; ++k) {
      const bytes = await (await api(`/api/motion/${k}${query}`)).arrayBuffer();
      if (mine !== wantedLoad) return;
      frames.push(readPacket<FrameHead>(bytes));
      loading.value = (k + 1) / found.steps;
    }
    const first = motion.peek() === null;
    motion.value = { ...found, frames, revision };
    if (first) {
      at.value = 0;
      playing.value = true;
    }
    show();
  } catch (error) {
    say((error as Error).message);
  } finally {
    if (mine === wantedLoad) loading.value = null;
  }
}

const own = computed(() => (result.value.kind === 'motion' && result.value.revision === scene.value?.head.revision ? result.value : null));
let loaded: unknown = null;
effect(() => {
  const mine = own.value;
  if (!mine) {
    // After a change of robot or result, what was loaded can still be played.
    if (motion.peek() && motion.peek()!.revision !== scene.value?.head.revision) leaveMotion();
    return;
  }
  if (mine === loaded) return;
  loaded = mine;
  void load(mine.found as Found, mine.revision!, look.field.peek());
});
effect(() => {
  const field = look.field.value;
  const m = motion.peek();
  if (m && own.peek() && serverFields.includes(field) && !m.frames[0].has(field)) void load(m, m.revision, field);
});

/// The state at the present time.
function show() {
  const m = motion.peek();
  if (!m) return;
  const frame = m.frames[indexAt(m.frames.map((f) => f.head.time), at.peek())];
  if (frame && look.shownFrame.peek() !== frame) look.shownFrame.value = frame;
}

/// Index of the last state that is not later than t.
export function indexAt(times: number[], t: number): number {
  let [low, high] = [0, times.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= t + 1e-9) low = middle;
    else high = middle - 1;
  }
  return low;
}

let last = 0;
function tick(now: number) {
  const m = motion.peek();
  if (!m || !playing.peek()) return;
  const passed = Math.min((now - last) / 1000, 0.1);
  last = now;
  // A program without seconds is played in three.
  const next = at.peek() + passed * speed.peek() * (inSeconds.peek() ? 1 : m.duration / 3);
  at.value = Math.min(next, lastTime(m));
  if (at.peek() >= lastTime(m)) playing.value = false;
  show();
  requestAnimationFrame(tick);
}
effect(() => {
  if (!playing.value) return;
  last = performance.now();
  requestAnimationFrame(tick);
});

const lastTime = (m: Motion) => m.frames.at(-1)!.head.time;

export function leaveMotion() {
  playing.value = false;
  motion.value = null;
  wantedLoad += 1;
  loading.value = null;
  look.shownFrame.value = null;
}

const words = (seconds: number, m: Motion) => programTime(seconds, m.duration, seconds < 10 ? 2 : 1);

/// Replaces the timeline of the replay while there is a motion.
export function MotionTrack() {
  const m = motion.value;
  if (!m) return null;
  const end = lastTime(m);
  return (
    <>
      <button
        class="round"
        aria-label={playing.value ? 'Pause the motion' : 'Play the motion'}
        data-testid="motion-play"
        onClick={() => {
          if (!playing.value && at.value >= end) at.value = 0;
          playing.value = !playing.value;
        }}
      >
        <Icon name={playing.value ? 'pause' : 'play'} />
      </button>
      <label class="track">
        <span>Motion</span>
        <input
          type="range"
          data-testid="motion-at"
          min={0}
          max={end}
          step={end / 1000}
          value={at.value}
          style={{ '--at': `${(100 * at.value) / (end || 1)}%` }}
          onInput={(e) => {
            playing.value = false;
            at.value = Number(e.currentTarget.value);
            show();
          }}
        />
        <output data-testid="motion-time">{words(at.value, m)}</output>
      </label>
      <select class="chip" aria-label="Speed of the motion" value={speed.value} data-testid="motion-speed" onChange={(e) => (speed.value = Number(e.currentTarget.value))}>
        {[0.1, 0.25, 0.5, 1, 2].map((s) => (
          <option value={s} key={s}>{s}×</option>
        ))}
      </select>
      <button class="bare" aria-label="Close the motion" title="Close the motion" data-testid="motion-leave" onClick={leaveMotion}>
        <Icon name="close" />
      </button>
    </>
  );
}

/// Runs the program in the studio; shows progress and a cancel button meanwhile.
export function RunMotion() {
  const head = scene.value?.head;
  const busy = searching.value;
  if (!head || motion.value) return null;
  if (busy?.kind === 'motion' || loading.value !== null) {
    const share = busy?.kind === 'motion' ? busy.fraction : (loading.value ?? 0);
    return (
      <button class="small" data-testid="motion-cancel" onClick={() => (busy?.kind === 'motion' ? void post('/api/search/cancel') : leaveMotion())}>
        {busy?.kind === 'motion' ? `Running, ${Math.round(100 * share)} %` : 'Loading'}: cancel
      </button>
    );
  }
  return (
    <button
      class="small"
      disabled={!mayDrive.value || busy !== null}
      title={head.program.timed ? 'Dynamic, with inertia and damping, as pliant simulate solves it' : 'All steps of the program, as pliant simulate solves them'}
      data-testid="motion-run"
      onClick={() => {
        loaded = null;
        begin('motion', {});
      }}
    >
      {head.program.timed ? 'Run dynamics' : 'Run program'}
    </button>
  );
}

/// Why there is no motion, and its warnings.
export function MotionNotes() {
  const why = refused.value?.kind === 'motion' ? refused.value.why : '';
  const m = motion.value;
  const notes = [why, m?.message ?? '', ...(m?.warnings ?? [])].filter(Boolean);
  if (notes.length === 0) return null;
  return (
    <p class="limit motion-notes" role="alert" data-testid="motion-notes">
      {notes.join('. ')}
    </p>
  );
}
