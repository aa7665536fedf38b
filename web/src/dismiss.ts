// Closes a menu on Escape, or on a click elsewhere.
import type { RefObject } from 'preact';
import { useLayoutEffect } from 'preact/hooks';

export function useDismiss(open: boolean, close: () => void, box: RefObject<HTMLElement>) {
  useLayoutEffect(() => {
    if (!open) return;
    const key = (e: KeyboardEvent) => {
      if (e.key !== 'Escape') return;
      close();
      box.current?.querySelector('button')?.focus();
    };
    const press = (e: PointerEvent) => {
      if (!box.current?.contains(e.target as Node)) close();
    };
    document.addEventListener('keydown', key);
    document.addEventListener('pointerdown', press);
    return () => {
      document.removeEventListener('keydown', key);
      document.removeEventListener('pointerdown', press);
    };
  }, [open]);
}
