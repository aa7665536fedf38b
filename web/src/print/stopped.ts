// Explains a stop: the firmware's own message says what it did, but not why or what to do.
import { events, info, now } from './state';

export interface Stop {
  title: string;
  text: string;
  cause: string; // the firmware's message, "" if it adds nothing
}

/// True if there was an emergency stop since the machine was last connected or started.
function askedFor(): boolean {
  const list = events.value;
  let since = list.length;
  while (since > 0 && !(list[since - 1].kind === 'state' && /^(Connecting|Operational|Printing|Working)/.test(list[since - 1].text))) --since;
  return list.slice(since).some((e) => e.kind === 'error' && /^emergency stop/.test(e.text));
}

/// Null: the machine is not halted.
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
