// Where the keyboard is: closes a menu on Escape, or where the user goes elsewhere; keeps the focus in a dialog, and gives
// it back.
import { signal } from '@preact/signals';
import type { RefObject } from 'preact';
import { useLayoutEffect, useRef } from 'preact/hooks';

/// Number of open dialogs: while there are any, nothing behind them can be reached but the emergency stop.
export const dialogs = signal(0);

/// Where the focus goes back to: `element`, or the button of the menu that it was chosen from, which has closed since.
function placesOf(element: HTMLElement | null): HTMLElement[] {
  return [element, element?.closest('.menu')?.querySelector('button')].filter((e) => e instanceof HTMLElement);
}

/// Once `open` has ended the focus returns to where it was before, unless it has gone elsewhere.
export function useFocusBack(open: boolean) {
  const before = useRef<HTMLElement[]>([]);
  const was = useRef(false);
  if (open && !was.current) before.current = placesOf(document.activeElement as HTMLElement | null);
  was.current = open;
  useLayoutEffect(() => {
    if (!open) return;
    return () => {
      // Once what is behind can be reached again.
      requestAnimationFrame(() => document.activeElement === document.body && before.current.find((e) => e.isConnected)?.focus());
    };
  }, [open]);
}

/// For a dialog: the focus returns to where it was before.
export function useDialog(open: boolean) {
  useFocusBack(open);
  useLayoutEffect(() => {
    if (!open) return;
    dialogs.value += 1;
    return () => {
      dialogs.value -= 1;
    };
  }, [open]);
}

/// For a menu, whose button is the first of `box`: that has the focus again once something was chosen.
export function useDismiss(open: boolean, close: () => void, box: RefObject<HTMLElement>) {
  const was = useRef(false);
  const chosen = useRef(false);
  if (!open && was.current) chosen.current = box.current?.contains(document.activeElement) ?? false;
  was.current = open;
  useLayoutEffect(() => {
    if (!open) return;
    const toButton = () => box.current?.querySelector('button')?.focus();
    const key = (e: KeyboardEvent) => {
      if (e.key !== 'Escape') return;
      close();
      toButton();
    };
    const elsewhere = (e: Event) => {
      if (!box.current?.contains(e.target as Node)) close();
    };
    document.addEventListener('keydown', key);
    document.addEventListener('pointerdown', elsewhere);
    document.addEventListener('focusin', elsewhere);
    return () => {
      document.removeEventListener('keydown', key);
      document.removeEventListener('pointerdown', elsewhere);
      document.removeEventListener('focusin', elsewhere);
      if (chosen.current && document.activeElement === document.body) toButton();
    };
  }, [open]);
}

/// Where the thing in `box` that has the focus goes away, the focus goes to the first of the places `next`: else whoever
/// uses the keyboard would begin at the top of the page again.
export function useKeptFocus(box: RefObject<HTMLElement>, next: string[]) {
  const inside = box.current?.contains(document.activeElement) ?? false;
  useLayoutEffect(() => {
    if (!inside || document.activeElement !== document.body) return;
    const places = next.map((place) => box.current?.querySelector<HTMLElement>(place));
    places.find((place) => place)?.focus();
  });
}
