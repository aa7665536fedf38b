// The state of the print, and how far it is.
import { counted } from '../counted';
import { clock } from '../make/plan';
import { busy, flags, isCancelled, known, now } from './state';
import { stopOf } from './stopped';
import { Verdict } from './verdict';

/// The last print was cancelled for good.
const wasCancelled = () => known.value && isCancelled(now.value!);

function Headline() {
  const n = now.value!;
  const stop = known.value ? stopOf() : null;
  const printed = n.progress.finished && !busy.value;
  const cancelled = !stop && wasCancelled();
  return (
    <>
      <div class="row">
        <b class="state" data-testid="print-state">
          {!known.value ? 'Unknown' : stop ? stop.title : printed ? 'Printed' : cancelled ? `Cancelled at layer ${n.progress.layer! + 1} of ${n.job.layers}` : n.state.text}
        </b>
        <span class="quiet">{n.job.file.name}</span>
      </div>
      {!known.value && <p class="quiet">last known state: {n.state.text}</p>}
      {stop ? (
        <p class="problems" data-testid="stopped">
          {stop.text} {stop.cause && <span class="quiet">({stop.cause})</span>}
        </p>
      ) : (
        known.value && n.state.message && <p class={n.progress.failed || flags.value.error ? 'problems' : 'quiet'}>{n.state.message}</p>
      )}
      {cancelled && <p data-testid="cancelled">Remove the part from the platform.</p>}
      <Verdict />
    </>
  );
}

export function Progress() {
  const n = now.value!;
  const p = n.progress;
  const done = p.completion ?? 0;
  const told = (text: string | number) => (known.value ? text : '–');
  return (
    <section class="block">
      <Headline />
      <div
        class={`progress tall ${known.value ? '' : 'old'}`}
        role="progressbar"
        aria-label="Progress of the print"
        aria-valuenow={known.value ? Math.round(done) : undefined}
        aria-valuemin={0}
        aria-valuemax={100}
      >
        <div style={{ width: `${done}%` }} />
      </div>
      <div class="figures small-figures">
        <div>
          <b data-testid="print-layer">{told(p.layer === null ? '–' : p.layer + 1)}</b>
          <span>of {counted(n.job.layers, 'layer')}</span>
        </div>
        <div>
          <b data-testid="time-left">{told(wasCancelled() ? '–' : clock(p.printTimeLeft ?? 0))}</b>
          <span>left</span>
        </div>
        <div>
          <b>{told(clock(p.printTime ?? 0))}</b>
          <span>elapsed</span>
        </div>
        <div>
          <b>{told(n.machine.slot || '–')}</b>
          <span>slot in use</span>
        </div>
      </div>
    </section>
  );
}
