// What is to be confirmed before a print, and what the studio has checked itself.
import { effect, signal } from '@preact/signals';
import { counted } from '../counted';
import { Icon } from '../icons';
import { clock } from '../make/plan';
import { changes, staleText } from '../make/stale';
import { job } from '../store';
import { busy, flags, host, info, known, maySteer, now } from './state';

const ticks = signal<Record<string, boolean>>({});
/// They are of one print.
effect(() => {
  if (busy.value) ticks.value = {};
});

/// The results of the studio's own checks.
function Known() {
  const n = now.value!;
  const i = info.value!;
  const connected = known.value && flags.value.operational;
  return (
    <ul class="checklist known" data-testid="known">
      <li class={connected ? 'good' : 'bad'}>
        <Icon name={connected ? 'check' : 'warn'} />
        <span>{!known.value ? 'unknown whether the machine responds' : connected ? `${i.twin ? 'the virtual printer' : i.device} responds: ${n.machine.firmware || 'unnamed firmware'}` : 'the machine does not respond'}</span>
      </li>
      <li class={connected ? 'good' : 'bad'}>
        <Icon name={connected ? 'check' : 'warn'} />
        <span>{!known.value ? 'unknown whether the projector is dark' : !connected ? 'not connected: the projector was last set to dark' : 'the projector is connected and dark'}</span>
      </li>
      <li class="good">
        <Icon name="check" />
        <span>
          the job is verified for this machine: {counted(n.job.layers, 'layer')}, {clock(i.seconds)}
        </span>
      </li>
      {i.warnings.map((text) => (
        <li key={text}>
          <Icon name="warn" />
          <span>{text}</span>
        </li>
      ))}
      {i.refills.length > 0 && (
        <li>
          <Icon name="warn" />
          <span>
            the print will pause {i.refills.length === 1 ? 'once' : `${i.refills.length} times`} for a refill: {i.refills.map((r) => `layer ${r.layer + 1}, ${r.text}`).join('; ')}
          </span>
        </li>
      )}
    </ul>
  );
}

/// Why the job that would be printed is perhaps not the one that is meant; "": no reason.
function oldJob(): string {
  const i = info.value!;
  const j = job.value;
  if (j && j.key !== i.key && !(j.saved && j.file === i.file)) return 'The job at hand is another one: this machine prints the job with which it was connected. To print the other one, disconnect and connect again.';
  return changes.value.length > 0 ? `${staleText(changes.value)} Slice again, or confirm that it is meant.` : '';
}

export function Checklist() {
  const i = info.value!;
  const items: [string, string][] = [
    ...i.vats.map((v): [string, string] => [`slot${v.slot}`, `slot ${v.slot} holds ${v.needed} of ${v.resin}`]),
    ['platform', 'the platform is clean, tightened and level'],
    ['path', 'carriage, tower and platform are free to move'],
    ['solution', 'the cleaning solution is full, the drain is clear'],
  ];
  const old = oldJob();
  if (old) items.unshift([old, old]); // another change is to be confirmed again
  const open = items.filter(([key]) => !ticks.value[key]).length;
  const doorOpen = now.value!.machine.door === 'open';
  return (
    <section class="block">
      <h3>Before printing</h3>
      <Known />
      <ul class="checklist">
        {items.map(([key, text]) => (
          <li key={key}>
            <label class={key === old ? 'old-job' : ''} data-testid={`check-${key === old ? 'old' : key}`}>
              <input type="checkbox" checked={ticks.value[key] ?? false} disabled={!maySteer.value} onChange={(e) => (ticks.value = { ...ticks.value, [key]: e.currentTarget.checked })} />
              <span>{text}</span>
            </label>
          </li>
        ))}
      </ul>
      <button class="primary wide-button" data-testid="start" disabled={open > 0 || !maySteer.value || !flags.value.ready || doorOpen} onClick={() => host('job', { command: 'start' })}>
        {doorOpen ? 'Close the door first' : open > 0 ? `Confirm ${counted(open, 'item')}` : 'Start the print'}
      </button>
    </section>
  );
}
