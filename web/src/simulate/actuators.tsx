// A slider and a number for every actuator.
import { batch } from '@preact/signals';
import { fixed } from '../counted';
import { NumberField, type Range } from '../number_field';
import { driveAll, following, frame, mayDrive, rough, scene, wanted, wantedTime } from '../store';
import type { Actuator } from '../types';
import { shownFrame } from './view_state';

const kinds: Record<string, { label: string; unit: string; step: number }> = {
  length_ratio: { label: 'Length ratio', unit: '', step: 0.005 },
  shortening_mm: { label: 'Shortening', unit: 'mm', step: 0.1 },
  tension_N: { label: 'Tension', unit: 'N', step: 0.1 },
  volume_ratio: { label: 'Volume ratio', unit: '', step: 0.005 },
  volume_change_mm3: { label: 'Volume change', unit: 'mm³', step: 1 },
  pressure_kPa: { label: 'Pressure', unit: 'kPa', step: 0.1 },
  gas_ratio: { label: 'Gas ratio', unit: '', step: 0.005 },
};
/// Unit of each kind, '' for ratios.
export const units: Record<string, string> = Object.fromEntries(Object.entries(kinds).map(([kind, { unit }]) => [kind, unit]));
const kindsOf = {
  cable: ['length_ratio', 'shortening_mm', 'tension_N'],
  chamber: ['volume_ratio', 'volume_change_mm3', 'pressure_kPa', 'gas_ratio'],
};

/// Not of actuators made of elements, which are driven by lengths and volumes only.
const byForce = ['tension_N', 'pressure_kPa', 'gas_ratio'];

/// Of the state that is shown: the present one, or one that is replayed.
const shownHead = () => (shownFrame.value ?? frame.value)?.head;

/// The actuator's value in the state that is shown, in the unit of this kind.
export function reading(actuator: Actuator, kind: string): number {
  const head = shownHead();
  const all = scene.value?.head.actuators ?? [];
  if (!head) return NaN;
  if (actuator.type === 'cable') {
    const c = head.cables[all.indexOf(actuator)];
    if (!c) return NaN;
    if (kind === 'tension_N') return Math.max(c.tension_N, 0); // no slider makes a cable push
    return kind === 'length_ratio' ? c.ratio : c.length_mm / c.ratio - c.length_mm;
  }
  const c = head.chambers[all.indexOf(actuator) - head.cables.length];
  if (!c) return NaN;
  if (kind === 'pressure_kPa') return c.pressure_kPa;
  if (kind === 'volume_change_mm3') return c.volume_mm3 - c.volume_mm3 / c.ratio;
  if (kind === 'gas_ratio') return ((c.pressure_kPa + 101.325) / 101.325) * c.ratio;
  return c.ratio;
}

/// For a file: what was asked for once the robot is there, else the reading without the digits that only say how far the
/// solver went, a hundred-thousandth of the slider.
export function writtenReading(actuator: Actuator, kind: string): number {
  const head = shownHead();
  const asked = head?.arrived ? head.wanted.actuators.find((w) => w.name === actuator.name && w.kind === kind) : undefined;
  if (asked) return asked.value;
  const now = reading(actuator, kind);
  const [low, high] = range(actuator, kind, now);
  const finest = 10 ** Math.floor(Math.log10(1e-5 * (high - low)));
  return Number.isFinite(finest) && finest > 0 ? Math.round(now / finest) * finest : now;
}

function range(actuator: Actuator, kind: string, value: number): [number, number] {
  const target = actuator.kind === kind ? actuator.target : NaN;
  const atLeast = (least: number, factor: number) =>
    Math.max(least, Number.isFinite(target) ? factor * Math.abs(target) : 0, 1.25 * Math.abs(value));
  switch (kind) {
    case 'length_ratio':
      return [Math.max(0.01, Math.min(0.5, Number.isFinite(target) ? target - 0.1 : 1, value)), Math.max(1, target > 1 ? 2 * target - 1 : 1, value)];
    case 'shortening_mm':
      return [Math.min(0, target < 0 ? 2 * target : 0, value), Math.max(0.5 * actuator.rest, value)];
    case 'tension_N':
      return [0, niceAbove(atLeast(10, 1.5))];
    case 'volume_ratio':
      return [Math.min(0.9, value), Math.max(1.5, Number.isFinite(target) ? 1 + 1.5 * (target - 1) : 1, value)];
    case 'volume_change_mm3':
      return [-niceAbove(0.1 * actuator.rest), niceAbove(Math.max(0.5 * actuator.rest, value))];
    case 'pressure_kPa':
      return [-niceAbove(atLeast(5, 0.2)), niceAbove(atLeast(20, 1.5))];
    default:
      return [0.8, Math.max(2, value)];
  }
}

/// All possible values; the slider covers a part of them.
function possible(actuator: Actuator, kind: string): Range {
  switch (kind) {
    case 'shortening_mm':
      return { from: -Infinity, to: +actuator.rest.toPrecision(5), open: true };
    case 'tension_N':
      return { from: 0, to: Infinity };
    case 'volume_change_mm3':
      return { from: -(+actuator.rest.toPrecision(5)), to: Infinity, open: true };
    case 'pressure_kPa':
      return { from: -Infinity, to: Infinity };
    case 'length_ratio':
      return { from: 0, to: 10, open: true }; // as in the robot file
    default:
      return { from: 0, to: Infinity, open: true };
  }
}

function niceAbove(x: number): number {
  const power = 10 ** Math.floor(Math.log10(x));
  return power * ([1, 2, 5, 10].find((f) => f * power >= x) ?? 10);
}

export function drive(name: string, kind: string, value: number) {
  driveTo({ [name]: { kind, value } });
}

/// Several at once.
export function driveTo(values: Record<string, { kind: string; value: number }>) {
  batch(() => {
    if (following.value) holdOthers(Object.keys(values));
    following.value = false;
    shownFrame.value = null;
    wanted.value = { ...wanted.value, ...values };
  });
  driveAll();
}

/// Takes over from the program: everything else keeps its current value.
function holdOthers(names: string[]) {
  const all = scene.value?.head.actuators ?? [];
  wanted.value = Object.fromEntries(
    all.map((a) => {
      const kind = wanted.value[a.name]?.kind ?? a.kind;
      const now = reading(a, kind);
      return [a.name, { kind, value: names.includes(a.name) || !Number.isFinite(now) ? (wanted.value[a.name]?.value ?? 1) : now }];
    }),
  );
}

function Control({ actuator }: { actuator: Actuator }) {
  const want = wanted.value[actuator.name] ?? { kind: actuator.kind, value: 1 };
  const now = reading(actuator, want.kind);
  // If the program or another page controls it, or a state is replayed, show the value there rather than this page's last
  // request.
  const value = (following.value || !mayDrive.value || shownFrame.value) && Number.isFinite(now) ? now : want.value;
  const kind = kinds[want.kind];
  const [low, high] = range(actuator, want.kind, value);
  const head = shownHead();
  const index = scene.value!.head.actuators.indexOf(actuator);
  const force =
    actuator.type === 'cable'
      ? `${fixed(head?.cables[index]?.tension_N ?? 0, 2)} N`
      : `${fixed(head?.chambers[index - (head?.cables.length ?? 0)]?.pressure_kPa ?? 0, 2)} kPa`;
  const id = `actuator-${index}`;
  const limit = head?.lead?.limits.find((l) => l.startsWith(`${actuator.name} `))?.slice(actuator.name.length + 1);
  return (
    <div class={`actuator ${actuator.type}`} data-testid={`actuator-${actuator.name}`}>
      <div class="row">
        <label class="name" for={id}>
          <span class={`dot ${actuator.type}`} />
          {actuator.name}
        </label>
        <output class="force" data-testid={`force-${actuator.name}`}>
          {rough.value && '≈ '}
          {force}
        </output>
      </div>
      <input
        id={id}
        type="range"
        min={low}
        max={high}
        step={(high - low) / 1000}
        value={value}
        disabled={!mayDrive.value}
        style={{ '--at': `${(100 * (value - low)) / (high - low || 1)}%` }}
        onInput={(e) => drive(actuator.name, want.kind, Number(e.currentTarget.value))}
      />
      <div class="row">
        <select
          aria-label={`Control mode of ${actuator.name}`}
          value={want.kind}
          disabled={!mayDrive.value}
          onChange={(e) => {
            const next = e.currentTarget.value;
            const at = reading(actuator, next);
            drive(actuator.name, next, Number.isFinite(at) ? at : 1);
          }}
        >
          {kindsOf[actuator.type].filter((k) => !actuator.elements || !byForce.includes(k)).map((k) => (
            <option value={k} key={k}>
              {kinds[k].label}
            </option>
          ))}
        </select>
        <NumberField
          value={+value.toPrecision(5)}
          range={possible(actuator, want.kind)}
          unit={kind.unit}
          step={kind.step}
          label={`${kind.label} of ${actuator.name}`}
          testId={`number-${actuator.name}`}
          disabled={!mayDrive.value}
          onValue={(v) => drive(actuator.name, want.kind, v)}
        />
      </div>
      {limit && (
        <p class="limit" data-testid={`limit-${actuator.name}`}>
          {limit}
        </p>
      )}
    </div>
  );
}

export function Actuators() {
  const head = scene.value?.head;
  if (!head) return null;
  return (
    <div class="actuators">
      {head.actuators.map((a) => (
        <Control actuator={a} key={a.name} />
      ))}
      {head.loaded && !following.value && (
        <div class="actuator">
          <div class="row">
            <label class="name" for="loads">
              Loads and supports
            </label>
            <output class="force">{Math.round((100 * wantedTime.value) / head.program.duration)} %</output>
          </div>
          <input
            id="loads"
            type="range"
            min={0}
            max={head.program.duration}
            step={head.program.duration / 1000}
            value={wantedTime.value}
            disabled={!mayDrive.value}
            style={{ '--at': `${(100 * wantedTime.value) / head.program.duration}%` }}
            onInput={(e) => {
              wantedTime.value = Number(e.currentTarget.value);
              driveAll();
            }}
          />
        </div>
      )}
      {head.actuators.length === 0 && <p class="quiet">This robot has no cable and no chamber. Play its program, or drag its body.</p>}
    </div>
  );
}
