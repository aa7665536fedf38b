// Asks before unsaved changes are discarded, whether something else is opened or the page is closed.
import { computed, signal } from '@preact/signals';
import { useDialog } from './dismiss';
import { documentState, helm } from './store';
import { theirs, text, revert } from './simulate/editor';
import { keptTexts } from './simulate/kept_texts';

/// True if there is text that the studio does not have, or that is in no file. The latter is left to the page that has
/// control.
export const unsaved = computed(() => text.value !== theirs.value || (helm.value.you && documentState.value.unsaved));

const question = signal<{ what: string; go: () => void } | null>(null);

/// Runs `go` at once if nothing would be lost, else after confirmation.
export function unlessLost(what: string, go: () => void) {
  if (unsaved.value) question.value = { what, go };
  else go();
}

window.addEventListener('beforeunload', (e) => {
  if (unsaved.value || keptTexts.value.length > 0) e.preventDefault();
});

export function DiscardQuestion() {
  const q = question.value;
  useDialog(q !== null);
  if (!q) return null;
  const close = () => (question.value = null);
  return (
    <div class="question-back" onKeyDown={(e) => e.key === 'Escape' && close()}>
      <div class="question card" role="alertdialog" aria-modal="true" aria-labelledby="discard-title" data-testid="discard-question">
        <h2 id="discard-title">Discard unsaved changes?</h2>
        <p>
          The robot file {documentState.value.name && <b>{documentState.value.name}</b>} has changes that are not saved. {q.what} discards them.
        </p>
        <div class="row left">
          <button class="primary" ref={(b) => b?.focus()} onClick={close} data-testid="keep-editing">
            Keep editing
          </button>
          <button
            class="danger"
            data-testid="discard"
            onClick={() => {
              close();
              revert();
              q.go();
            }}
          >
            Discard changes
          </button>
        </div>
      </div>
    </div>
  );
}
