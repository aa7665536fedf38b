// Whether the cured block is as drawn.
import { useState } from 'preact/hooks';
import { Icon } from '../icons';
import { enlarged } from './enlarged';
import { busy, info, known, now, verdict } from './state';

/// The cured block beside the drawing; a click enlarges it.
function VerdictPicture() {
  const [failed, setFailed] = useState(false);
  if (failed) return null;
  const address = `/api/print/verdict/picture?taken=${info.value!.taken}&at=${now.value!.progress.begun ?? 0}`;
  return (
    <button class="verdict-picture" data-testid="verdict-picture" aria-label="Enlarge the picture of the drawing and the cured block" onClick={() => (enlarged.value = { address, title: 'Drawing and cured block' })}>
      <img src={address} alt="Drawing and cured block" onError={() => setFailed(true)} />
    </button>
  );
}

/// The verdict on the print, if known.
export function Verdict() {
  if (!known.value || busy.value || !now.value!.progress.finished) return null;
  if (!info.value!.twin) return <p class="quiet">Everything was exposed as planned. Inspect the part to see whether it cured.</p>;
  if (!verdict.value) return <p class="quiet">The cured block is compared with the drawing…</p>;
  const { passed, reasons } = verdict.value;
  return (
    <>
    <p class={`verdict ${passed ? 'good' : 'bad'}`} data-testid="verdict" data-passed={passed}>
      <Icon name={passed ? 'check' : 'warn'} />
      {passed ? 'As drawn: every pixel of the cured block matches its image.' : 'Not as drawn: see the report for where and how.'}
    </p>
    {!passed && reasons.length > 0 && (
      <ul class="reasons" data-testid="reasons">
        {reasons.slice(0, 5).map((r) => (
          <li>{r}</li>
        ))}
      </ul>
    )}
    <VerdictPicture />
    </>
  );
}
