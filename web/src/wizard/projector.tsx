// Focus and size of the projector: test patterns, and the pixel size computed from measurements on them.
import { signal } from '@preact/signals';
import { useEffect, useState } from 'preact/hooks';
import { api, mayDrive, post, say } from '../store';
import { PickFile, PickProjector, SetupNumber, usePorts } from './parts';
import { file, projectorAt, setup, write } from './state';
import type { Step } from './wizard';

const lit = signal('');
const seconds = signal('60');
const square = signal('8');

const number = (text: string) => Number(text.trim().replace(',', '.') || NaN);

/// Why no pattern can be shown; "": it can.
function patternWrong(): string {
  const [edge, given] = [number(square.value), number(seconds.value)];
  if (!(Number.isInteger(edge) && edge >= 1)) return 'The square size is a whole number of pixels, 1 or more.';
  if (!(given > 0 && given <= 3600)) return 'The duration is above 0 s and at most 3600 s.';
  return '';
}

async function show(pattern: string) {
  const given = number(seconds.value);
  if (await post('/api/printer/pattern', { name: file.value, projector: projectorAt.value, pattern, square: number(square.value), seconds: given })) {
    lit.value = pattern;
    setTimeout(() => lit.value === pattern && (lit.value = ''), 1000 * given);
  }
}
async function dark() {
  await post('/api/printer/dark');
  lit.value = '';
}

function Pattern({ pattern, children }: { pattern: string; children?: preact.ComponentChildren }) {
  const address = `/api/printer/pattern/${pattern}?name=${encodeURIComponent(file.value)}&square=${Math.max(1, Math.round(number(square.value)) || 1)}`;
  const why = patternWrong();
  return (
    <div class="pattern">
      <img src={address} alt={`Test pattern ${pattern}`} data-testid="pattern-picture" />
      <div>
        {children}
        <label class="wizard-field">
          <span>Duration</span>
          <SetupNumber label="Duration" value={seconds.value} unit="s" onValue={(t) => (seconds.value = t)} testId="pattern-seconds" />
        </label>
        <div class="row left wrap">
          <button class="primary" disabled={!mayDrive.value || !projectorAt.value || why !== ''} onClick={() => void show(pattern)} data-testid="pattern-show">
            Show
          </button>
          <button disabled={!lit.value} onClick={() => void dark()} data-testid="pattern-dark">
            Turn off
          </button>
          <span class="quiet" role="status" data-testid="pattern-state">
            {lit.value ? `${lit.value} is on` : 'dark'}
          </span>
        </div>
        {why && (
          <p class="problems" role="alert" data-testid="pattern-wrong">
            {why}
          </p>
        )}
      </div>
    </div>
  );
}

function Where() {
  const [ports] = usePorts();
  return (
    <>
      <p>
        This light cures resin and is harmful to the eyes: remove the vats, put white paper where the vat’s floor is, and do not look into the lens. The light stays off until you press <i>Show</i>, and turns off by itself.
      </p>
      <PickFile />
      <PickProjector ports={ports} />
    </>
  );
}

interface Measured {
  x_px: number;
  y_px: number;
  x_mm: number;
  y_mm: number;
  pixel_um_now: number;
  pixel_um?: number;
  x_um?: number;
  y_um?: number;
  off_percent?: number;
}
const across = signal('');
const along = signal('');
const found = signal<Measured | null>(null);

const ask = (body: object) =>
  api('/api/printer/measured', { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify({ name: file.value, ...body }) }).then((r) => r.json() as Promise<Measured>);

function sizeText(found: number, before: number): string {
  const percent = 100 * (found / before - 1);
  if (Math.abs(percent) < 0.005) return 'as in the file';
  return `with the value in the file, parts came out ${Math.abs(percent).toFixed(2)} % too ${percent > 0 ? 'large' : 'small'}`;
}

const typed = () => across.value.trim() !== '' || along.value.trim() !== '';
function sizeLacks(): string {
  if (!typed() || found.value?.pixel_um) return '';
  const bad = [across.value, along.value].some((t) => !(number(t) > 0));
  return bad ? 'width and height are lengths above 0, in mm' : 'computing…';
}

function Size() {
  const [usual, setUsual] = useState<Measured | null>(null);
  useEffect(() => {
    ask({}).then(setUsual).catch((e: Error) => say(e.message));
  }, [file.value]);
  useEffect(() => {
    const [x, y] = [across.value, along.value].map(number);
    found.value = null;
    if (!(x > 0 && y > 0)) return;
    ask({ x_mm: x, y_mm: y }).then((m) => (found.value = m)).catch((e: Error) => say(e.message));
  }, [across.value, along.value]);
  const f = found.value;
  return (
    <Pattern pattern="border">
      <p>Measure the inner rectangle, from the middle of a line to the middle of the opposite one.</p>
      <label class="wizard-field">
        <span>Width</span>
        <SetupNumber label="Width" value={across.value} unit="mm" testId="measured-x" onValue={(t) => (across.value = t)} />
      </label>
      <label class="wizard-field">
        <span>Height</span>
        <SetupNumber label="Height" value={along.value} unit="mm" testId="measured-y" onValue={(t) => (along.value = t)} />
      </label>
      {usual && (
        <p class="quiet small-print">
          {usual.x_px} × {usual.y_px} pixels; with the pixel size of {usual.pixel_um_now} µm in the file that would be {usual.x_mm.toFixed(2)} × {usual.y_mm.toFixed(2)} mm.
        </p>
      )}
      {f?.pixel_um && (
        <p data-testid="pixel-found" data-um={f.pixel_um}>
          One pixel is <b>{f.pixel_um.toFixed(3)} µm</b>: {sizeText(f.pixel_um, f.pixel_um_now)}.
          {Math.abs(f.off_percent!) > 0.2 && <span class="problems-inline"> Width and height of a pixel differ by {Math.abs(f.off_percent!).toFixed(2)} %: square the projector to the vat floor first.</span>}
        </p>
      )}
    </Pattern>
  );
}

async function writeSize(tell: (why: string) => void): Promise<boolean> {
  const f = found.value;
  if (!f?.pixel_um) return true; // not measured: unchanged
  const done = await write([{ key: 'projector.pixel', value: `${f.pixel_um.toFixed(3)} um` }], tell);
  if (done) across.value = along.value = '';
  return done;
}

export const projectorSteps = (): Step[] => [
  { name: 'Projector', body: () => <Where />, lacks: () => (file.value && setup.value && !setup.value.built_in ? '' : 'a printer file of your own is needed') },
  {
    name: 'Focus',
    body: () => (
      <Pattern pattern="checkerboard">
        <p>Turn the lens until the edges of the squares are sharp on the paper, in the middle and in all corners. Then make the squares smaller.</p>
        <label class="wizard-field">
          <span>Square size</span>
          <SetupNumber label="Edge of a square" value={square.value} unit="px" testId="pattern-square" onValue={(t) => (square.value = t)} />
        </label>
      </Pattern>
    ),
    leave: async () => (await dark(), true),
  },
  { name: 'Size', body: () => <Size />, lacks: sizeLacks, leave: async (tell) => (await dark(), writeSize(tell)), next: typed() ? 'Save and continue' : 'Leave as it is' },
  {
    name: 'Ready',
    body: () => (
      <p data-testid="projector-ready">
        The pixel size in {file.value} is <b>{setup.value ? (1000 * setup.value.projector.pixel).toFixed(3) : '–'} µm</b>. Jobs sliced before keep the old one: slice them again.
      </p>
    ),
  },
];
