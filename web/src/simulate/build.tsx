// Edits the robot file without typing: parameters, materials, and things placed by clicking on the robot. The studio
// makes each change in the text, keeping comments and order.
import { computed, effect, signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { counted } from '../counted';
import { Icon } from '../icons';
import { NumberField } from '../number_field';
import { api, documentState, mayDrive, post, problems, scene } from '../store';
import { text, theirs } from './editor';
import { PickGeometry } from './geometry';
import { theView } from './the_view';
import { keyOf, parametersOf } from './toml_edit';

type Point = [number, number, number];
type Kind = 'marker' | 'support' | 'cable' | 'chamber';

const placing = signal<Kind | null>(null);
/// Points of an unfinished cable, mm.
export const placed = signal<Point[]>([]);
const depth = signal(2); // mm below the surface
const radius = signal(3); // mm

interface LibraryEntry {
  name: string;
  title: string;
  hardness: string;
}
export const library = signal<LibraryEntry[]>([]);

const lists: Record<Kind, string> = { marker: 'marker', support: 'fixed', cable: 'cable', chamber: 'chamber' };
const words: Record<Kind, string> = {
  marker: 'Click the robot where you want the marker.',
  support: 'Click the robot where it is to be held: everything within the radius is fixed.',
  cable: 'Click the guide points in order, then press Finish cable.',
  chamber: '',
};

/// Shape of a chamber: a ball or box of air in a body, or an existing cavity.
type Shape = 'ball' | 'box' | 'cavity';
const shape = signal<Shape>('ball');
const shapes: [Shape, string, string][] = [
  ['ball', 'Round', 'Click the robot: a round chamber is created below that point.'],
  ['box', 'Box', 'Click the robot where you want the centre of the box, set its size, then create the chamber.'],
  ['cavity', 'Cavity', 'Click a wall of an existing closed cavity (use Section to cut the robot open): all the air in it becomes the chamber.'],
];
const boxSize = [10, 6, 6].map((v) => signal(v)); // mm
const boxPlace = signal<{ at: Point; inward: Point } | null>(null);
/// The box that is being placed; null: none.
export const draft = computed(() => {
  const p = boxPlace.value;
  if (!p || placing.value !== 'chamber' || shape.value !== 'box') return null;
  const size = boxSize.map((s) => s.value) as Point;
  // Its nearest wall is at this depth below the surface.
  const half = 0.5 * p.inward.reduce((sum, n, k) => sum + Math.abs(n) * size[k], 0);
  return { centre: p.at.map((v, k) => v + (depth.value + half) * p.inward[k]) as Point, size };
});

/// A name not used by any actuator, marker or support.
export function freeName(kind: string, taken: string[]): string {
  for (let k = 1; ; ++k) if (!taken.includes(`${kind} ${k}`)) return `${kind} ${k}`;
}

function taken(): string[] {
  const head = scene.peek()?.head;
  return head ? [...head.actuators.map((a) => a.name), ...head.markers.map((m) => m.name), ...head.supports] : [];
}

/// In the unit of the file, with the significant digits only.
const inFile = (p: readonly number[]) => p.map((v) => +(v / (scene.peek()?.head.unit_mm ?? 1)).toPrecision(6));
const add = (kind: Kind, entry: Record<string, unknown>) => post('/api/robot/add', { list: lists[kind], entry: { name: freeName(kind, taken()), ...entry } });

/// Handles a clicked position. False if none is expected.
export function takePlace(rest: Point, inward: Point): boolean {
  const kind = placing.peek();
  if (!kind || !mayDrive.peek()) return false;
  const below = rest.map((v, k) => v + depth.peek() * inward[k]) as Point;
  const unit = scene.peek()?.head.unit_mm ?? 1;
  if (kind === 'cable') placed.value = [...placed.value, below];
  if (kind === 'marker') void add(kind, { point: inFile(rest) });
  if (kind === 'support') void add(kind, { sphere: { center: inFile(rest), radius: +(radius.peek() / unit).toPrecision(6) } });
  if (kind === 'chamber' && shape.peek() === 'box') {
    boxPlace.value = { at: rest, inward };
    return true; // created once its size is confirmed
  }
  if (kind === 'chamber' && shape.peek() === 'cavity') {
    // The body is behind the wall, and the air in front of it.
    const size = Math.hypot(...[0, 1, 2].map((k) => theView.peek()?.extent[k] ?? 10));
    void add(kind, { inside: inFile(rest.map((v, k) => v - 2e-3 * size * inward[k])), target: { pressure: '10 kPa' } });
  }
  if (kind === 'chamber' && shape.peek() === 'ball') {
    const middle = rest.map((v, k) => v + (depth.peek() + radius.peek()) * inward[k]);
    void add(kind, { geometry: { sphere: { center: inFile(middle), radius: +(radius.peek() / unit).toPrecision(6) } }, target: { pressure: '10 kPa' } });
  }
  if (kind !== 'cable') placing.value = null;
  return true;
}

function makeBox() {
  const box = draft.peek();
  if (!box) return;
  const corners = [-0.5, 0.5].map((side) => inFile(box.centre.map((v, k) => v + side * box.size[k])));
  void add('chamber', { geometry: { box: corners }, target: { pressure: '10 kPa' } });
  boxPlace.value = null;
  placing.value = null;
}

function finishCable() {
  void add('cable', { points: placed.peek().map(inFile), anchor: 'first', target: { length_ratio: 0.9 } });
  placed.value = [];
  placing.value = null;
}

function stopPlacing() {
  placed.value = [];
  boxPlace.value = null;
  placing.value = null;
}

function Placing() {
  const kind = placing.value;
  useEffect(() => stopPlacing, []); // on another panel nothing tells that a click would place something
  const start = (k: Kind) => {
    const again = placing.value === k;
    stopPlacing();
    if (!again) placing.value = k;
  };
  const field = (label: string, s: typeof depth, id: string) => (
    <label class="row" key={id}>
      {label}
      <NumberField value={s.value} range={{ from: 0, to: 1000 }} unit="mm" testId={id} onValue={(v) => void (s.value = v)} />
    </label>
  );
  return (
    <>
      <h3>Add by clicking</h3>
      <div class="row left wrap">
        {(Object.keys(lists) as Kind[]).map((k) => (
          <button key={k} class="small" aria-pressed={kind === k} disabled={!mayDrive.value} onClick={() => start(k)} data-testid={`place-${k}`}>
            {k[0].toUpperCase() + k.slice(1)}
          </button>
        ))}
      </div>
      {kind && (
        <div class="placing" role="status">
          {kind === 'chamber' && (
            <div class="segments" role="group" aria-label="Shape of the chamber">
              {shapes.map(([name, label]) => (
                <button key={name} aria-pressed={shape.value === name} onClick={() => (shape.value = name)} data-testid={`chamber-${name}`}>
                  {label}
                </button>
              ))}
            </div>
          )}
          <p>{kind === 'chamber' ? shapes.find(([name]) => name === shape.value)![2] : words[kind]}</p>
          {(kind === 'cable' || (kind === 'chamber' && shape.value !== 'cavity')) && field('Depth below the surface', depth, 'place-depth')}
          {(kind === 'support' || (kind === 'chamber' && shape.value === 'ball')) && field('Radius', radius, 'place-radius')}
          {kind === 'chamber' && shape.value === 'box' && (
            <>
              {['x', 'y', 'z'].map((axis, k) => field(`Size along ${axis}`, boxSize[k], `box-${axis}`))}
              <div class="row left">
                <button class="primary small" disabled={!boxPlace.value} onClick={makeBox} data-testid="make-box">
                  Create chamber
                </button>
                <span class="quiet">{boxPlace.value ? 'shown in the view' : 'no position yet'}</span>
              </div>
            </>
          )}
          {kind === 'cable' && (
            <div class="row left">
              <button class="primary small" disabled={placed.value.length < 2} onClick={finishCable} data-testid="finish-cable">
                Finish cable
              </button>
              <span class="quiet">{counted(placed.value.length, 'point')}</span>
            </div>
          )}
        </div>
      )}
    </>
  );
}

let waiting = 0;
const moved = new Map<string, number>(); // not sent yet
/// Only the latest of several moves of a slider is sent.
export function setParameter(name: string, value: number) {
  moved.set(name, value);
  clearTimeout(waiting);
  waiting = window.setTimeout(() => {
    const changes = [...moved].map(([of, v]) => ({ key: `parameters.${of}`, value: v }));
    moved.clear();
    void post('/api/robot/set', { changes });
  }, 150);
}

/// Whole numbers stay whole; the slider ranges from zero to twice the value first seen.
const seen = new Map<string, number>();
function Parameters() {
  const list = parametersOf(theirs.value);
  if (list.length === 0) return null;
  return (
    <>
      <h3>Parameters</h3>
      {list.map(({ name, value }) => {
        const key = `${documentState.value.name} ${name}`;
        if (!seen.has(key)) seen.set(key, value || 1);
        const most = 2 * Math.abs(seen.get(key)!);
        const whole = Number.isInteger(seen.get(key)!);
        const [low, high] = [value < 0 ? -most : whole ? Math.min(1, value) : 0, Math.max(most, value)];
        return (
          <div class="parameter" key={name}>
            <label for={`parameter-${name}`}>{name}</label>
            <NumberField value={value} range={{ from: -Infinity, to: Infinity }} unit="" label={name} testId={`parameter-number-${name}`} disabled={!mayDrive.value} onValue={(v) => setParameter(name, v)} />
            <input
              id={`parameter-${name}`}
              data-testid={`parameter-${name}`}
              type="range"
              min={low}
              max={high}
              step={whole ? 1 : (high - low) / 200}
              value={value}
              disabled={!mayDrive.value}
              style={{ '--at': `${(100 * (value - low)) / (high - low || 1)}%` }}
              onChange={(e) => setParameter(name, +Number(e.currentTarget.value).toPrecision(6))}
            />
          </div>
        );
      })}
    </>
  );
}

function BodyMaterials() {
  const head = scene.value?.head;
  if (!head?.bodies?.length) return null;
  return (
    <>
      <h3>Materials of the bodies</h3>
      {head.bodies.map((b) => {
        const now = head.materials[b.material]?.name ?? '';
        return (
          <label class="row" key={b.name}>
            <span class="given">{b.name}</span>
            <select value={now} disabled={!mayDrive.value} data-testid={`material-of-${b.name}`} onChange={(e) => void post('/api/robot/set', { changes: [{ key: keyOf('body', b.name, 'material'), value: e.currentTarget.value }] })}>
              <optgroup label="In the file">
                {head.materials.map((m) => (
                  <option value={m.name} key={m.name}>
                    {m.name}
                  </option>
                ))}
              </optgroup>
              <optgroup label="Library">
                {library.value
                  .filter((m) => !head.materials.some((own) => own.name === m.name))
                  .map((m) => (
                    <option value={m.name} key={m.name} title={m.title}>
                      {m.name} {m.hardness && `(${m.hardness})`}
                    </option>
                  ))}
              </optgroup>
            </select>
          </label>
        );
      })}
    </>
  );
}

effect(() => {
  if (scene.value && library.peek().length === 0)
    api('/api/materials')
      .then(async (r) => (library.value = (await r.json()) as LibraryEntry[]))
      .catch(() => {});
});

export function Build() {
  const changed = text.value !== theirs.value;
  if (changed)
    return <p class="quiet">The text under File has unapplied changes: apply or revert them first.</p>;
  return (
    <div class="build">
      <div class="row left">
        <button class="small" disabled={!documentState.value.undo || !mayDrive.value} onClick={() => post('/api/robot/undo')} data-testid="build-undo">
          <Icon name="undo" /> Undo
        </button>
        <button class="small" disabled={!documentState.value.redo || !mayDrive.value} onClick={() => post('/api/robot/redo')} data-testid="build-redo">
          <Icon name="redo" /> Redo
        </button>
        <span class="grow" />
        <PickGeometry label="Add geometry…" testId="build-geometry" />
      </div>
      {problems.value.length > 0 && scene.value && (
        <div class="problems" role="alert" data-testid="build-problems">
          <p>With the last change the file has an error, and the robot is still the one before:</p>
          <ul>
            {problems.value.map((p) => (
              <li>{p.text}</li>
            ))}
          </ul>
          <button class="small" disabled={!documentState.value.undo || !mayDrive.value} onClick={() => post('/api/robot/undo')} data-testid="build-undo-problem">
            <Icon name="undo" /> Undo the change
          </button>
        </div>
      )}
      <Placing />
      <Parameters />
      <BodyMaterials />
    </div>
  );
}
