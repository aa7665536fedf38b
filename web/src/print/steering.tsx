// Pause, resume and cancel a print; why a paused print waits.
import { useRef, useState } from 'preact/hooks';
import { useKeptFocus } from '../dismiss';
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

/// Pause, then Resume: one button, so that it keeps the focus.
function PauseOrResume() {
  const n = now.value!;
  const f = flags.value;
  const blocked = f.paused ? n.machine.door === 'open' : f.pausing;
  const press = () => {
    if (blocked) return;
    void host('job', f.paused ? { command: 'resume' } : { command: 'pause', action: 'pause' });
  };
  return (
    <button class={f.paused ? 'primary' : ''} data-testid={f.paused ? 'resume' : 'pause'} disabled={!maySteer.value} aria-disabled={blocked} onClick={press}>
      <Icon name={f.paused ? 'play' : 'pause'} /> {f.pausing ? 'pausing…' : !f.paused ? 'Pause' : refillOf(n.progress.prompt) ? 'Filled, resume' : 'Resume'}
    </button>
  );
}

/// Cancel, and the question whether that is meant. One button asks it and takes it back: it keeps the focus, and who
/// presses twice cancels nothing.
function CancelPrint() {
  const [sure, setSure] = useState(false);
  const box = useRef<HTMLDivElement>(null);
  const cancelling = flags.value.cancelling;
  const asks = sure && !cancelling;
  useKeptFocus(box, ['button']);
  return (
    <div class="row left" ref={box} onKeyDown={(e) => e.key === 'Escape' && setSure(false)}>
      <button data-testid={asks ? 'keep-printing' : 'cancel'} disabled={!maySteer.value} aria-disabled={cancelling} onClick={() => cancelling || setSure(!sure)}>
        {!asks && <Icon name="stop" />} {asks ? 'Keep printing' : cancelling ? 'parking…' : 'Cancel'}
      </button>
      {asks && (
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
      )}
    </div>
  );
}

export function Steering() {
  const f = flags.value;
  const connectable = f.error || (f.closedOrError && !now.value!.job.canResume && now.value!.state.text === 'Offline');
  if (!busy.value && !connectable) return null;
  return (
    <section class="block steering">
      {f.paused && known.value && <Waiting />}
      <div class="row left wrap">
        {(f.printing || f.pausing || f.paused) && <PauseOrResume />}
        {busy.value && <CancelPrint />}
        {connectable && (
          <button class="primary" disabled={!maySteer.value} data-testid="connect" onClick={() => host('connection', { command: 'connect' })}>
            Reconnect
          </button>
        )}
      </div>
      {f.printing && <p class="quiet small-print">The print continues when this page is closed. Keep the studio running and its computer awake.</p>}
    </section>
  );
}
