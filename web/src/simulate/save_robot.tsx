// Saves the robot file, also under another name, and asks before changes are written over that were made elsewhere.
import { signal } from '@preact/signals';
import { useEffect, useRef, useState } from 'preact/hooks';
import { useDialog, useFocusBack } from '../dismiss';
import { api, documentState, post, say, type Refusal } from '../store';

/// The file that was changed elsewhere; '': none.
const changed = signal('');

/// `name`: of a new file; '': that of the robot. False: nothing is saved, or not yet.
export async function saveRobot(name = '', overwrite = false): Promise<boolean> {
  const order = { ...(name && { name }), ...(overwrite && { overwrite }) };
  try {
    await api('/api/robot/save', { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(order) });
    return true;
  } catch (error) {
    if ((error as Refusal).changed) changed.value = documentState.value.name;
    else say((error as Error).message);
    return false;
  }
}

/// Asks for the name of a new file; `first`: a suggestion.
export function SaveAs({ first, close }: { first: string; close: () => void }) {
  const [name, setName] = useState(first);
  const field = useRef<HTMLInputElement>(null);
  useFocusBack(true);
  useEffect(() => field.current?.focus(), []);
  return (
    <form
      class="saveas"
      onKeyDown={(e) => e.key === 'Escape' && close()}
      onSubmit={async (e) => {
        e.preventDefault();
        if (await saveRobot(name)) close();
      }}
    >
      <input value={name} aria-label="File name" onInput={(e) => setName(e.currentTarget.value)} data-testid="save-name" ref={field} />
      <button class="primary small" disabled={!name.trim()}>
        Save
      </button>
      <button class="small" type="button" onClick={close}>
        Cancel
      </button>
    </form>
  );
}

export function SaveQuestion() {
  const name = changed.value;
  useDialog(name !== '');
  if (!name) return null;
  const close = () => (changed.value = '');
  return (
    <div class="question-back" onKeyDown={(e) => e.key === 'Escape' && close()}>
      <div class="question card" role="alertdialog" aria-modal="true" aria-labelledby="changed-title" data-testid="changed-question">
        <h2 id="changed-title">The file was changed elsewhere</h2>
        <p>
          <b>{name}</b> is no longer as it was opened or saved here. Overwriting it discards those changes; opening it again discards yours.
        </p>
        <div class="row left wrap">
          <button class="primary" ref={(b) => b?.focus()} onClick={close} data-testid="keep-unsaved">
            Do not save
          </button>
          <button
            class="danger"
            data-testid="overwrite"
            onClick={() => {
              close();
              void saveRobot('', true);
            }}
          >
            Overwrite
          </button>
          <button
            class="danger"
            data-testid="open-again"
            onClick={() => {
              close();
              void post('/api/open', { name });
            }}
          >
            Open again
          </button>
        </div>
      </div>
    </div>
  );
}
