// The robot as the server draws it, which index.html shows from the start, until the 3D view has drawn it.
import { signal } from '@preact/signals';
import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';
import { frame } from '../store';
import { theme } from '../theme';
import { onDrawn } from './the_view';

// The element itself moves into the page: it shows the picture throughout, and a new one would begin empty.
const picture = document.querySelector<HTMLElement>('.first-picture');
const image = picture?.querySelector('img');
const shown = signal(picture !== null);
// Of a file with errors there is none: the browser would draw the frame of a missing image.
const lose = () => (shown.value = false);
if (image?.complete && image.naturalWidth === 0) lose();
image?.addEventListener('error', lose);

export function FirstPicture() {
  const place = useRef<HTMLDivElement>(null);
  useLayoutEffect(() => {
    const source = picture?.querySelector('source'), dark = theme.value === 'dark';
    if (source && matchMedia(source.media).matches !== dark) source.media = dark ? 'all' : 'not all';
    if (picture) place.current?.append(picture);
  }, []);
  useEffect(() => (shown.value ? onDrawn(() => (shown.value = shown.value && !frame.value)) : undefined), [shown.value]);
  return shown.value ? <div ref={place} /> : null;
}
