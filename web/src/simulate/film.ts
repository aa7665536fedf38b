// The states since rest as a film, drawn as the view shows them and recorded by the browser.
import { signal } from '@preact/signals';
import { frames } from './tracks';
import { theView } from './the_view';
import { shownFrame } from './view_state';

/// Share that has been recorded; null: none is.
export const filming = signal<number | null>(null);

const framesPerSecond = 25;
const shortest_ms = 2000; // a film of few states is slower

/// WebM. Null where there is nothing to show, or the browser cannot record.
export async function film(): Promise<Blob | null> {
  const canvas = theView.peek()?.renderer.domElement;
  const all = frames.slice();
  if (!canvas || all.length < 2 || !('MediaRecorder' in window) || filming.peek() !== null) return null;
  const recorder = new MediaRecorder(canvas.captureStream(framesPerSecond), { mimeType: 'video/webm', videoBitsPerSecond: 12e6 });
  const parts: Blob[] = [];
  recorder.ondataavailable = (e) => parts.push(e.data);
  const ended = new Promise<void>((resolve) => (recorder.onstop = () => resolve()));
  const each_ms = Math.max(1000 / framesPerSecond, shortest_ms / all.length);
  recorder.start();
  try {
    for (const [k, frame] of all.entries()) {
      shownFrame.value = frame;
      filming.value = k / all.length;
      await new Promise((next) => setTimeout(next, each_ms));
    }
  } finally {
    recorder.stop();
    await ended;
    shownFrame.value = null;
    filming.value = null;
  }
  return new Blob(parts, { type: 'video/webm' });
}
