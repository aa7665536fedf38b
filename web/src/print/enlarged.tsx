// A picture as large as the window: the current exposure, or the cured block. It covers everything except the emergency
// stop.
import { signal } from '@preact/signals';
import { useLayoutEffect, useRef } from 'preact/hooks';
import { useDialog } from '../dismiss';
import { Icon } from '../icons';

export const enlarged = signal<{ address: string; title: string; pixels?: boolean } | null>(null);

export function Enlarged() {
  const closer = useRef<HTMLButtonElement>(null);
  const picture = enlarged.value;
  useDialog(picture !== null);
  useLayoutEffect(() => {
    if (!picture) return;
    closer.current?.focus();
    const escape = (e: KeyboardEvent) => e.key === 'Escape' && (enlarged.value = null);
    window.addEventListener('keydown', escape);
    return () => window.removeEventListener('keydown', escape);
  }, [picture !== null]);
  if (!picture) return null;
  const close = () => (enlarged.value = null);
  return (
    <div class="enlarged-back" onClick={(e) => e.target === e.currentTarget && close()}>
      <div class="enlarged card" role="dialog" aria-modal="true" aria-label={picture.title} data-testid="enlarged">
        <div class="row">
          <h2>{picture.title}</h2>
          <button class="bare" aria-label="Close" ref={closer} onClick={close}>
            <Icon name="close" />
          </button>
        </div>
        <img class={picture.pixels ? 'pixels' : ''} src={picture.address} alt={picture.title} />
      </div>
    </div>
  );
}
