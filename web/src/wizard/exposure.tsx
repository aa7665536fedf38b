// Exposure finder: one print of many small pieces, each with its own exposure; the best one is saved.
import { signal } from '@preact/signals';
import { useState } from 'preact/hooks';
import { counted } from '../counted';
import { clock } from '../make/plan';
import { info, now } from '../print/state';
import { job, mayDrive, section, slicing } from '../store';
import { coupon, exposureRobot, fins, ramp } from './coupons';
import { PickFile, SetupNumber } from './parts';
import { file, setup, waiting, wizard, write } from './state';
import { sliceTest } from './test_job';
import type { Step } from './wizard';

const resin = signal('');
const low = signal<string | null>(null); // null: the usual one
const high = signal<string | null>(null);
const count = signal('7');
/// The job that was made: its revision, and the exposures of its pieces.
const made = signal<{ revision: number; seconds: number[]; resin: string } | null>(null);
const best = signal(-1);

const known = () => setup.value?.resins.find((r) => r.name === resin.value) ?? setup.value?.resins[0];
const num = (text: string | null, usual: number) => (text === null ? usual : text.trim() === '' ? NaN : Number(text.replace(',', '.')));
const usualLow = () => Math.round(50 * (known()?.exposure_s ?? 2)) / 100;
const usualHigh = () => Math.round(200 * (known()?.exposure_s ?? 2)) / 100;
const seconds = () => ramp(num(low.value, usualLow()), num(high.value, usualHigh()), Math.round(num(count.value, 7)));

function wrong(): string {
  if (!file.value || !setup.value || setup.value.built_in) return 'a printer file of your own is needed';
  const [a, b, n] = [num(low.value, usualLow()), num(high.value, usualHigh()), num(count.value, 7)];
  if (!(a > 0 && b > a)) return 'From must be above 0 s and less than To';
  const most = known()?.longest_exposure_s ?? Infinity;
  if (b > most) return `To: ${setup.value.name} allows exposures up to ${most} s`;
  if (!(Number.isInteger(n) && n >= 2 && n <= 15)) return '2 to 15 pieces';
  return '';
}

function Pieces({ list, children }: { list: number[]; children?: (s: number, k: number) => preact.ComponentChildren }) {
  return (
    <ol class="pieces" data-testid="pieces">
      {list.map((s, k) => (
        <li>
          <Piece number={k + 1} />
          {children ? children(s, k) : <span>{s} s</span>}
        </li>
      ))}
    </ol>
  );
}

/// A piece on the platform, seen from above.
function Piece({ number }: { number: number }) {
  const px = 0.1;
  let at = 1;
  return (
    <svg viewBox={`0 0 ${coupon.width} ${coupon.depth}`} class="piece" aria-hidden="true">
      <rect width={coupon.width} height={coupon.depth} rx={0.4} class="piece-base" />
      {fins.map((w) => {
        const x = at;
        at += Math.max(w * px, 0.4) + 1.2;
        return <rect x={x} y={1} width={w * px} height={coupon.depth - 5} class="piece-fin" />;
      })}
      {Array.from({ length: number }, (_, k) => (
        <rect x={0.6 + 1.6 * (k % 5)} y={coupon.depth - 1.5 - 1.5 * Math.floor(k / 5)} width={1} height={1} class="piece-fin" />
      ))}
    </svg>
  );
}

function Ask() {
  const r = known();
  return (
    <>
      <p>
        Each piece has fins {fins.slice(0, -1).join(', ')} and {fins[fins.length - 1]} pixels wide, and as many studs as its number. All are printed in one go, from one vat.
      </p>
      <PickFile />
      <label class="wizard-field">
        <span>Resin</span>
        <select value={resin.value || r?.name} onChange={(e) => (resin.value = e.currentTarget.value)} data-testid="finder-resin">
          {setup.value?.resins.map((x) => (
            <option value={x.name}>{x.name}</option>
          ))}
        </select>
      </label>
      <label class="wizard-field">
        <span>From</span>
        <SetupNumber label="Shortest exposure" value={low.value ?? String(usualLow())} unit="s" testId="finder-from" onValue={(t) => (low.value = t)} />
      </label>
      <label class="wizard-field">
        <span>To</span>
        <SetupNumber label="Longest exposure" value={high.value ?? String(usualHigh())} unit="s" testId="finder-to" onValue={(t) => (high.value = t)} />
      </label>
      <label class="wizard-field">
        <span>Pieces</span>
        <SetupNumber label="Number of pieces" value={count.value} unit="" testId="finder-count" onValue={(t) => (count.value = t)} />
      </label>
      {r && <p class="quiet small-print">In the file, {r.name} has {r.exposure_s} s, and {r.bottom_exposure_s} s for its bottom layers.</p>}
      {wrong() === '' && <Pieces list={seconds()} />}
    </>
  );
}

async function makeJob(tell: (why: string) => void): Promise<boolean> {
  const list = seconds();
  const of = resin.value || known()!.name;
  const same = made.value && job.value?.revision === made.value.revision && JSON.stringify([list, of]) === JSON.stringify([made.value.seconds, made.value.resin]);
  if (same) return true;
  const why = await sliceTest(exposureRobot(setup.value!, of, list, known()!.bottom_exposure_s));
  if (why) return tell(why), false;
  made.value = { revision: job.value!.revision, seconds: list, resin: of };
  best.value = -1;
  return true;
}

function PrintIt() {
  const j = job.value;
  const ours = made.value && j?.revision === made.value.revision;
  const done = now.value?.progress.finished && info.value?.job === j?.manifest.name;
  const go = () => {
    waiting.value = 'exposure';
    wizard.value = null;
    section.value = 'print';
    location.hash = 'print';
  };
  return (
    <>
      {j && (
        <p data-testid="finder-job">
          <b>{j.manifest.name}</b>: {counted(j.manifest.materials.length, 'piece')}, {counted(j.manifest.layers.length, 'layer')}
          {j.plan && `, ${clock(j.plan.seconds.total)}`}.
        </p>
      )}
      <p>{done ? 'The pieces are printed.' : 'Print it on the machine like any other job; this wizard waits at the bottom of the page.'}</p>
      <button class={done ? '' : 'primary'} disabled={!mayDrive.value || !ours} onClick={go} data-testid="finder-print">
        Go to Print
      </button>
    </>
  );
}

function Pick() {
  const m = made.value;
  if (!m) return <p class="quiet">No test print was made.</p>;
  return (
    <>
      <p>Wash the pieces and look at them. Choose the shortest exposure at which the 3-pixel fin stands, the studs have sharp edges, and the gaps are open.</p>
      <div role="radiogroup" aria-label="Best piece">
        <Pieces list={m.seconds}>
          {(s, k) => (
            <label class="inline">
              <input type="radio" name="piece" checked={best.value === k} onChange={() => (best.value = k)} data-testid={`piece-${k + 1}`} />
              {s} s
            </label>
          )}
        </Pieces>
      </div>
    </>
  );
}

/// The bottom layers keep their exposure ratio.
async function writeBest(tell: (why: string) => void): Promise<boolean> {
  const m = made.value!;
  const r = setup.value?.resins.find((x) => x.name === m.resin);
  if (!r) return tell(`${file.value} no longer has a resin ${m.resin}`), false;
  const s = m.seconds[best.value];
  const bottom = Math.round((100 * s * r.bottom_exposure_s) / r.exposure_s) / 100;
  return write(
    [
      { key: `resin.${m.resin}.exposure`, value: `${s} s` },
      { key: `resin.${m.resin}.bottom_exposure`, value: `${bottom} s` },
    ],
    tell,
  );
}

function Kept() {
  const [r] = useState(() => made.value?.resin);
  const k = setup.value?.resins.find((x) => x.name === r);
  return (
    <p data-testid="finder-kept">
      In {file.value}, <b>{r}</b> now has {k?.exposure_s} s, and {k?.bottom_exposure_s} s for its bottom layers. Slice again whatever is to be printed with it.
    </p>
  );
}

export const exposureSteps = (): Step[] => [
  { name: 'Pieces', body: () => <Ask />, lacks: wrong, leave: makeJob, next: slicing.value ? 'slicing…' : 'Create test job' },
  { name: 'Print', body: () => <PrintIt />, next: 'Printed' },
  { name: 'Choose', body: () => <Pick />, lacks: () => (made.value && best.value >= 0 ? '' : 'choose the best piece'), leave: writeBest, next: 'Save' },
  { name: 'Ready', body: () => <Kept /> },
];
