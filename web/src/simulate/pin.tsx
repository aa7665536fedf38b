// The state that is kept visible for comparison.
import { Icon } from '../icons';
import { pinNow } from './editor';
import * as look from './view_state';

export function Pin() {
  const p = look.pinned.value;
  if (!p)
    return (
      <button class="chip" onClick={() => pinNow('pinned')} data-testid="pin">
        <Icon name="pin" /> Pin to compare
      </button>
    );
  return (
    <span class="chip pinned" data-testid="pinned">
      <span class="swatch" style={{ background: '#f2a93b' }} /> {p.label}
      <button class="bare" aria-pressed={look.beside.value} onClick={() => (look.beside.value = !look.beside.value)}>
        {look.beside.value ? 'overlay' : 'side by side'}
      </button>
      <button class="bare" aria-label="Unpin" onClick={() => (look.pinned.value = null)}>
        ×
      </button>
    </span>
  );
}
