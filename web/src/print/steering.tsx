// Pause, resume and cancel a print; why a paused print waits.
import { useEffect, useState } from 'preact/hooks';
import { Icon } from '../icons';
import { busy, flags, host, info, known, maySteer, now } from './state';

const refillOf = (prompt: string | null) => info.value!.refills.find((r) => r.text === prompt);

/// Why a paused print waits, and what the user must do.
function Waiting() {
  const n = now.value!;
  const prompt = n.progress.prompt;
  const open = n.machine.door === 'open';
  const refill = refillOf(prompt);
  const vat = refill && info.value!.machine!.vats.find((v) => v.slot === refill.slot);
  const [title, text] = open
    ? ['The door is open', 'The light, the pump and the fans are off, nothing moves. Close the door; then the print can be resumed.']
    : refill
      ? ['Resin is needed', `Fill the vat of slot ${refill.slot} with ${vat?.resin ?? 'its resin'}${vat ? `, up to ${Math.round(vat.fill_ml)} ml` : ''}. Nothing moves meanwhile.`]
      : prompt?.startsWith('the door')
        ? ['The door is closed again', 'The interrupted exposure is completed when you resume.']
        : prompt
          ? ['The print is waiting for you', prompt]
          : ['Paused', 'The part hangs clear of the vat. Nothing moves until you resume.'];
  return (
    <div class={`prompt ${open ? 'bad' : ''}`} role="alert" data-testid="prompt">
      <Icon name={open || prompt ? 'warn' : 'pause'} />
      <span>
        <b>{title}</b>
        {text}
        {open && !info.value!.twin && ' Do not rely on the switch for safety: an open door should also cut the power of lamp and motors.'}
      </span>
    </div>
  );
}

export function Steering() {
  const n = now.value!;
  const f = flags.value;
  const [sure, setSure] = useState(false);
  useEffect(() => {
    if (!busy.value) setSure(false);
  }, [busy.value]);
  const connectable = f.error || (f.closedOrError && !n.job.canResume && n.state.text === 'Offline');
  if (!busy.value && !connectable) return null;
  return (
    <section class="block steering">
      {f.paused && known.value && <Waiting />}
      <div class="row left">
        {(f.printing || f.pausing) && (
          <button data-testid="pause" disabled={!maySteer.value || f.pausing} onClick={() => host('job', { command: 'pause', action: 'pause' })}>
            <Icon name="pause" /> {f.pausing ? 'pausing…' : 'Pause'}
          </button>
        )}
        {f.paused && (
          <button class="primary" data-testid="resume" disabled={!maySteer.value || n.machine.door === 'open'} onClick={() => host('job', { command: 'resume' })}>
            <Icon name="play" /> {refillOf(n.progress.prompt) ? 'Filled, resume' : 'Resume'}
          </button>
        )}
        {busy.value && !sure && (
          <button data-testid="cancel" disabled={!maySteer.value || f.cancelling} onClick={() => setSure(true)}>
            <Icon name="stop" /> {f.cancelling ? 'parking…' : 'Cancel'}
          </button>
        )}
        {connectable && (
          <button class="primary" disabled={!maySteer.value} data-testid="connect" onClick={() => host('connection', { command: 'connect' })}>
            Reconnect
          </button>
        )}
      </div>
      {busy.value && sure && (
        <div class="row left wrap">
          <button
            class="danger"
            data-testid="cancel-sure"
            disabled={!maySteer.value}
            onClick={() => {
              setSure(false);
              void host('job', { command: 'cancel' });
            }}
          >
            Cancel print
          </button>
          <button onClick={() => setSure(false)}>Keep printing</button>
        </div>
      )}
      {f.printing && <p class="quiet small-print">The print continues when this page is closed. Keep the studio running and its computer awake.</p>}
    </section>
  );
}
