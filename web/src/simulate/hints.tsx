// Three hints for the first visit.
import { signal } from '@preact/signals';
import { mayDrive } from '../store';

const hints = [
  'Drag a slider to pull a cable or to inflate a chamber. While you drag, numbers marked ≈ are approximate; let go, and the exact ones follow.',
  'Drag a marker: the actuators bring it there. Drag the body to apply a force. Drag the background to rotate the view, scroll to zoom.',
  'Change a material under File: the previous state stays visible as a ghost for comparison. Then continue under Prepare.',
];

const hintsSeen = signal(Number(localStorage.getItem('pliant_hints') ?? 0));

export function Hints() {
  const k = hintsSeen.value;
  if (k >= hints.length || !mayDrive.value) return null;
  const next = (to: number) => {
    hintsSeen.value = to;
    localStorage.setItem('pliant_hints', String(to));
  };
  return (
    <div class="hint" data-testid="hint">
      <b>{k + 1} of 3</b>
      <p>{hints[k]}</p>
      <div>
        <button class="primary small" onClick={() => next(k + 1)}>
          {k + 1 < hints.length ? 'Next' : 'Done'}
        </button>
        {k + 1 < hints.length && (
          <button class="small" onClick={() => next(hints.length)}>
            Skip
          </button>
        )}
      </div>
    </div>
  );
}
