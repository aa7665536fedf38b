// Exports the states since rest as a film, as shown in the view: WebM recorded by the browser, or GIF encoded here.
import { signal } from '@preact/signals';
import { cssColour } from '../theme';
import { animatedGif, type Picture } from './gif';
import { frames } from './tracks';
import { theView } from './the_view';
import { shownFrame } from './view_state';

/// Recorded share; null: not recording.
export const filming = signal<number | null>(null);
let stopped = false;

/// The recording is discarded.
export function stopFilming() {
  stopped = true;
}

const framesPerSecond = 25;
const shortest_ms = 2000; // a film of few states is slowed down

/// WebM. Null if there is nothing to show, it was cancelled, or the browser cannot record.
export async function film(): Promise<Blob | null> {
  const canvas = theView.peek()?.renderer.domElement;
  const all = frames.slice();
  if (!canvas || all.length < 2 || !('MediaRecorder' in window) || filming.peek() !== null) return null;
  stopped = false;
  const recorder = new MediaRecorder(canvas.captureStream(framesPerSecond), { mimeType: 'video/webm', videoBitsPerSecond: 12e6 });
  const parts: Blob[] = [];
  recorder.ondataavailable = (e) => parts.push(e.data);
  const ended = new Promise<void>((resolve) => (recorder.onstop = () => resolve()));
  const each_ms = Math.max(1000 / framesPerSecond, shortest_ms / all.length);
  recorder.start();
  try {
    for (const [k, frame] of all.entries()) {
      if (stopped) break;
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
  return stopped ? null : new Blob(parts, { type: 'video/webm' });
}

const gifWidth = 640;
const mostPictures = 80;
const pause_ms = 1200; // on the last state

/// On the stage's background: GIF has no partial transparency.
function background(context: CanvasRenderingContext2D, width: number, height: number) {
  const fill = context.createLinearGradient(0, 0, 0, height);
  fill.addColorStop(0, cssColour('--stage-top'));
  fill.addColorStop(1, cssColour('--stage-bottom'));
  context.fillStyle = fill;
  context.fillRect(0, 0, width, height);
}

/// At most `most` of the states, including the first and the last.
function thinned<T>(all: T[], most: number): T[] {
  if (all.length <= most) return all;
  return Array.from({ length: most }, (_, k) => all[Math.round((k * (all.length - 1)) / (most - 1))]);
}

/// GIF, 640 pixels wide. Null if there is nothing to show, or it was cancelled.
export async function gif(): Promise<Blob | null> {
  const view = theView.peek();
  const all = thinned(frames.slice(), mostPictures);
  if (!view || all.length < 2 || filming.peek() !== null) return null;
  stopped = false;
  const canvas = view.renderer.domElement;
  const width = Math.min(gifWidth, canvas.width);
  const height = Math.max(1, Math.round((width * canvas.height) / canvas.width));
  const context = Object.assign(document.createElement('canvas'), { width, height }).getContext('2d', { willReadFrequently: true })!;
  context.imageSmoothingQuality = 'high';
  const pictures: Picture[] = [];
  try {
    for (const [k, frame] of all.entries()) {
      filming.value = (0.9 * k) / all.length;
      view.show(frame);
      background(context, width, height);
      context.drawImage(canvas, 0, 0, width, height);
      pictures.push(context.getImageData(0, 0, width, height));
      await new Promise((next) => setTimeout(next, 0)); // keeps the page responsive, so that it can be cancelled
      if (stopped) return null;
    }
    filming.value = 0.95;
    await new Promise((next) => setTimeout(next, 20));
    const each_ms = Math.max(1000 / framesPerSecond, shortest_ms / pictures.length);
    return new Blob([animatedGif(pictures, width, height, each_ms, pause_ms)], { type: 'image/gif' });
  } finally {
    filming.value = null;
    const now = shownFrame.peek() ?? frames.at(-1);
    if (now) view.setFrame(now);
  }
}
