// A search that runs in the studio: its progress, end and result. One at a time, for all pages.
import { effect, signal } from '@preact/signals';
import { api, lines, onEvent, post, say, scene } from '../store';
import type { Change } from './editor';

export type Kind = 'goal' | 'identify' | 'workspace' | 'sweep' | 'motion';

export interface WaypointFound {
  index: number;
  reached: boolean;
  error_mm: number;
  inputs: Record<string, number>; // in the units of the actuators' targets
  reasons: string[];
}

export interface IdentifyFound {
  unknowns: { key: string; unit: string; start: number; value: number; at_bound: boolean; matters: boolean }[];
  shown: { start: string; value: string; low: string; high: string }[];
  fitted: { unit: string; values: number; rms_before: number; rms_after: number }[];
  judged: { unit: string; values: number; rms_before: number; rms_after: number }[];
  assignments: string[]; // KEY=VALUE
  warnings: string[];
  plots: number;
  converged: boolean;
}

/// The waypoints of a goal as a program: its keys, and what else the file must say; or why there is none.
export interface GoalProgram {
  keys?: string;
  changes?: Change[];
  error?: string;
}

interface Result {
  kind?: Kind;
  revision?: number; // of the robot that was searched
  opened?: number; // its number
  order?: number; // of its elements
  found?: unknown;
  program?: GoalProgram;
}

export const searching = signal<{ kind: Kind; stage: string; fraction: number } | null>(null);
export const refused = signal<{ kind: Kind; why: string } | null>(null);
export const result = signal<Result>({});
/// The last result, if it is of this kind and of the robot that is open, and no later search of the kind was refused or
/// has failed.
export const resultOf = (kind: Kind): Result | null =>
  result.value.kind === kind && result.value.opened === scene.value?.head.opened && refused.value?.kind !== kind ? result.value : null;
/// The robot was changed after this search.
export const isOfBefore = (last: Result) => last.revision !== scene.value?.head.revision;
/// Computed with linear elements, which are too stiff.
export const isRoughResult = (last: Result) => last.order === 1;
export const RoughNote = ({ of }: { of: Result }) =>
  isRoughResult(of) ? <p class="quiet" data-testid="rough-result">≈ Computed with linear elements: forces come out too large, displacements too small.</p> : null;
/// Counts results, so that pictures of different results have different addresses.
export const resultNumber = signal(0);

async function load(number: number) {
  result.value = (await (await api('/api/search')).json()) as Result;
  resultNumber.value = number;
}

onEvent((event) => {
  if (event.type === 'search') {
    const { kind, stage, fraction, error } = event as unknown as { kind: Kind; stage: string; fraction: number; error?: string };
    searching.value = stage ? { kind, stage, fraction } : null;
    if (!stage) refused.value = error ? { kind, why: error } : null;
  }
  if (event.type === 'searched') load(event.result as number).catch((e: Error) => say(e.message));
});
// A restarted studio has no search.
effect(() => {
  if (lines.value > 0) searching.value = null;
});

export function begin(kind: Kind, order: unknown) {
  refused.value = null;
  void post(`/api/${kind}`, order, (why) => (refused.value = { kind, why }));
}

/// The start button, or progress with a cancel button, and the error of a failed search.
export function Search({ kind, label, ready, onBegin }: { kind: Kind; label: string; ready: boolean; onBegin: () => void }) {
  const busy = searching.value;
  const mine = busy?.kind === kind;
  return (
    <>
      {mine ? (
        <button type="button" onClick={() => post('/api/search/cancel')} data-testid={`cancel-${kind}`}>
          Cancel
        </button>
      ) : (
        <button class="primary" type="button" disabled={!ready || busy !== null} onClick={onBegin} data-testid={`find-${kind}`}>
          {label}
        </button>
      )}
      {mine && (
        <div class="progress" role="progressbar" aria-label={label} aria-valuenow={Math.round(100 * busy.fraction)} aria-valuemin={0} aria-valuemax={100}>
          <div style={{ width: `${100 * busy.fraction}%` }} />
          <span>{busy.stage}</span>
        </div>
      )}
      {refused.value?.kind === kind && (
        <p class="problems" role="alert" data-testid={`refused-${kind}`}>
          {refused.value.why}
        </p>
      )}
    </>
  );
}
