// Closes a menu on Escape, or on a click elsewhere; keeps the keyboard in a dialog.
import { signal } from '@preact/signals';
import type { RefObject } from 'preact';
import { useLayoutEffect, useRef } from 'preact/hooks';

/// Number of open dialogs: while there are any, nothing behind them can be reached but the emergency stop.
export const dialogs = signal(0);

/// For a dialog: the focus returns to where it was before.
export function useDialog(open: boolean) {
  const before = useRef<HTMLElement | null>(null);
  const was = useRef(false);
  if (open && !was.current) before.current = document.activeElement as HTMLElement | null;
  was.current = open;
  useLayoutEffect(() => {
    if (!open) return;
    dialogs.value += 1;
    return () => {
      dialogs.value -= 1;
      // Once what is behind can be reached again.
      requestAnimationFrame(() => before.current?.isConnected && document.activeElement === document.body && before.current.focus());
    };
  }, [open]);
}

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
