// What a stop was, in words: the firmware's own say what it did, not what has happened or what to do.
import { events, info, now } from './state';

export interface Stop {
  title: string;
  text: string;
  cause: string; // the firmware's words, "" where they add nothing
}

/// An emergency stop since the machine was last connected or set to work.
function askedFor(): boolean {
  const list = events.value;
  let since = list.length;
  while (since > 0 && !(list[since - 1].kind === 'state' && /^(Connecting|Operational|Printing|Working)/.test(list[since - 1].text))) --since;
  return list.slice(since).some((e) => e.kind === 'error' && /^emergency stop/.test(e.text));
}

/// Null: the machine has not been halted.
export function stopOf(): Stop | null {
  const n = now.value;
  if (!n?.state.flags.error) return null;
  const halted = /kill\(\) called|Printer halted/i.test(n.state.message);
  const asked = /^emergency stop/i.test(n.state.message) || askedFor();
  if (!halted && !asked) return null;
  const next = n.job.canResume ? 'then press Resume' : 'then press Reconnect';
  const board = info.value?.twin ? 'Check the machine' : 'Check the machine and reset its board (the reset button, or power off and on)';
  return {
    title: asked ? 'Emergency stop' : 'The firmware has stopped the machine',
    text: `The light is off and nothing moves. ${board}; ${next}.`,
    cause: asked ? '' : n.state.message,
  };
}
