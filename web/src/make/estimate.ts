// What the print will take, and what is wrong with the form, before slicing.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { api } from '../store';

interface Estimate {
  layers: number;
  seconds: number;
  swaps: number;
  resin_ml: Record<string, number>;
}

/// Null: there is none, or it is being computed.
export const estimate = signal<Estimate | null>(null);
/// Why the form cannot be sliced as it is; "": nothing known.
export const orderProblem = signal('');

const pause = 350; // ms, while somebody types

/// Asks for another estimate whenever the order or the robot has changed.
export function useEstimate(order: string, robot: string, can: boolean) {
  useEffect(() => {
    if (!can) return;
    const stop = new AbortController();
    const timer = setTimeout(() => {
      api('/api/job/estimate', { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: order, signal: stop.signal })
        .then((r) => r.json())
        .then((e: Estimate & { problem?: string }) => {
          estimate.value = e.problem ? null : e;
          orderProblem.value = e.problem ?? '';
        })
        .catch(() => stop.signal.aborted || (estimate.value = null)); // a lost connection is shown elsewhere
    }, pause);
    return () => {
      clearTimeout(timer);
      stop.abort();
    };
  }, [order, robot, can]);
}
