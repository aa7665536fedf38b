// Offers the texts that were not applied to a robot that is no longer open.
import { unlessLost } from '../discard';
import { mayDrive, newRobot, post } from '../store';
import { forgetKept, type KeptText, keptTexts } from './kept_texts';

/// A robot without a file is opened as a new one, with this text.
function openAgain(kept: KeptText) {
  unlessLost(`Opening ${kept.title}`, async () => {
    if (kept.name) await post('/api/open', { name: kept.name });
    else if (await newRobot(kept.text)) forgetKept(kept);
  });
}

export function KeptList() {
  return (
    <>
      {keptTexts.value.map((kept) => (
        <div class="prompt kept" role="status" key={kept.opened} data-testid="kept-text">
          <span>
            <b>The text of {kept.title} that was not applied is kept.</b>
            <button class="small" disabled={!mayDrive.value} onClick={() => openAgain(kept)} data-testid="kept-open">
              Open it again
            </button>{' '}
            <button class="small" onClick={() => forgetKept(kept)} data-testid="kept-discard">
              Discard it
            </button>
          </span>
        </div>
      ))}
    </>
  );
}
