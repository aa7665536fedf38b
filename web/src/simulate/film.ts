// Exports the states since rest as a film, as shown in the view: WebM encoded by the browser, or GIF encoded here.
import { signal } from '@preact/signals';
import { ArrayBufferTarget, Muxer } from 'webm-muxer';
import { cssColour } from '../theme';
import type { Frame } from '../types';
import { animatedGif, type Picture } from './gif';
import { frames } from './tracks';
import { theView } from './the_view';
import type { RobotView } from './view';
import { shownFrame } from './view_state';

/// Recorded share; null: not recording.
export const filming = signal<number | null>(null);
let stopped = false;

/// The recording is discarded.
export function stopFilming() {
  stopped = true;
}

const pause_ms = 1200; // on the last state
const framesPerSecond = 25;
const shortest_ms = 2000; // a film of few states is slowed down

/// The stage's background: the view's own picture is transparent there.
function background(context: CanvasRenderingContext2D, width: number, height: number) {
  const fill = context.createLinearGradient(0, 0, 0, height);
  fill.addColorStop(0, cssColour('--stage-top'));
  fill.addColorStop(1, cssColour('--stage-bottom'));
  context.fillStyle = fill;
  context.fillRect(0, 0, width, height);
}

/// A canvas for states, as wide as given and as high as the view asks for.
function pictureOf(view: RobotView, width: number) {
  const shown = view.renderer.domElement;
  const height = Math.max(2, Math.round((width * shown.height) / shown.width) & ~1);
  const canvas = Object.assign(document.createElement('canvas'), { width, height });
  const context = canvas.getContext('2d', { willReadFrequently: true })!;
  context.imageSmoothingQuality = 'high';
  const draw = (frame: Frame) => {
    view.show(frame);
    background(context, width, height);
    context.drawImage(shown, 0, 0, width, height);
  };
  return { canvas, context, draw };
}

type Drawing = ReturnType<typeof pictureOf>;

/// The view shows again what it showed.
function finish(view: RobotView) {
  filming.value = null;
  const now = shownFrame.peek() ?? frames.at(-1);
  if (now) view.setFrame(now);
}

/// What is filmed: the states, and the last one again until the end. Milliseconds from the beginning.
function timesOf(count: number): { each_ms: number; duration_ms: number } {
  const each_ms = Math.max(1000 / framesPerSecond, shortest_ms / count);
  return { each_ms, duration_ms: (count - 1) * each_ms + pause_ms };
}

const bitsPerSecond = 12e6;

/// Every state is a frame, however slow the computer is. Null: cancelled.
async function encoded(picture: Drawing, all: Frame[]): Promise<Blob | null> {
  const { width, height } = picture.canvas;
  const { each_ms, duration_ms } = timesOf(all.length);
  const file = new Muxer({ target: new ArrayBufferTarget(), video: { codec: 'V_VP8', width, height, frameRate: 1000 / each_ms } });
  let wrong: Error | null = null;
  const encoder = new VideoEncoder({
    output: (chunk, about) => file.addVideoChunk(chunk, about),
    error: (e) => (wrong = e),
  });
  encoder.configure({ codec: 'vp8', width, height, bitrate: bitsPerSecond, framerate: 1000 / each_ms });
  const add = (k: number, time_ms: number) => {
    const frame = new VideoFrame(picture.canvas, { timestamp: Math.round(1000 * time_ms) });
    encoder.encode(frame, { keyFrame: k % 100 === 0 });
    frame.close();
  };
  try {
    for (const [k, state] of all.entries()) {
      if (stopped || wrong) break;
      picture.draw(state);
      add(k, k * each_ms);
      filming.value = k / all.length;
      await new Promise((next) => setTimeout(next, 0)); // keeps the page responsive, so that it can be cancelled
    }
    if (stopped) return null;
    add(all.length, duration_ms); // players end with the last frame
    await encoder.flush();
  } finally {
    if (encoder.state !== 'closed') encoder.close();
  }
  if (wrong) throw wrong;
  file.finalize();
  return new Blob([file.target.buffer], { type: 'video/webm' });
}

/// Where the browser's encoder may not be used, as on a page from another computer: recorded as it is shown.
async function recorded(picture: Drawing, all: Frame[]): Promise<Blob | null> {
  const recorder = new MediaRecorder(picture.canvas.captureStream(framesPerSecond), { mimeType: 'video/webm', videoBitsPerSecond: bitsPerSecond });
  const parts: Blob[] = [];
  recorder.ondataavailable = (e) => parts.push(e.data);
  const ended = new Promise<void>((resolve) => (recorder.onstop = () => resolve()));
  const { each_ms } = timesOf(all.length);
  recorder.start();
  for (const [k, state] of [...all, all[all.length - 1]].entries()) {
    if (stopped) break;
    picture.draw(state);
    filming.value = k / (all.length + 1);
    await new Promise((next) => setTimeout(next, k + 1 < all.length ? each_ms : pause_ms / 2));
  }
  recorder.stop();
  await ended;
  return stopped ? null : new Blob(parts, { type: 'video/webm' });
}

/// WebM. Null if there is nothing to show, it was cancelled, or the browser cannot record.
export async function film(): Promise<Blob | null> {
  const view = theView.peek();
  const all = frames.slice();
  const encodes = 'VideoEncoder' in window;
  if (!view || all.length < 2 || !(encodes || 'MediaRecorder' in window) || filming.peek() !== null) return null;
  stopped = false;
  filming.value = 0;
  try {
    const picture = pictureOf(view, view.renderer.domElement.width & ~1); // encoders want even sizes
    return await (encodes ? encoded(picture, all) : recorded(picture, all));
  } finally {
    finish(view);
  }
}

const gifWidth = 640;
const mostPictures = 80;

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
  const { canvas, context, draw } = pictureOf(view, Math.min(gifWidth, view.renderer.domElement.width));
  const { width, height } = canvas;
  const pictures: Picture[] = [];
  try {
    for (const [k, frame] of all.entries()) {
      filming.value = (0.9 * k) / all.length;
      draw(frame);
      pictures.push(context.getImageData(0, 0, width, height));
      await new Promise((next) => setTimeout(next, 0)); // keeps the page responsive, so that it can be cancelled
      if (stopped) return null;
    }
    filming.value = 0.95;
    await new Promise((next) => setTimeout(next, 20));
    const { each_ms } = timesOf(pictures.length);
    return new Blob([animatedGif(pictures, width, height, each_ms, pause_ms)], { type: 'image/gif' });
  } finally {
    finish(view);
  }
}
