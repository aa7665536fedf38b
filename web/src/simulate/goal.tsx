// The wanted positions of a marker, and the actuators that may be used to reach them.
import { batch, effect, signal } from '@preact/signals';
import { NumberField } from '../number_field';
import { api, frame, mayDrive, say, scene } from '../store';
import { driveTo, units } from './actuators';
import { text } from './editor';
import { insertKeys } from './recorder';
import { begin, resultOf, Search, searching, type WaypointFound } from './search';

type Point = [number, number, number];

interface Input {
  name: string;
  kind: string;
  low: number;
  high: number;
  used: boolean;
  own?: { low?: number; high?: number }; // typed by the user
}

/// Ranges as the robot has them now, with what the user has changed in those before.
export function renewed(list: Omit<Input, 'used' | 'own'>[], before: Input[]): Input[] {
  return list.map((input) => {
    const old = before.find((b) => b.name === input.name && b.kind === input.kind);
    return { ...input, ...old?.own, own: old?.own, used: old?.used ?? true };
  });
}

/// The search uses the element order of the current robot.
const isLinear = () => scene.value?.head.order === 1;

const marker = signal('');
/// The wanted positions in order; shown in the view.
export const path = signal<Point[]>([]);
const tolerance = signal(0.1);
export const inputs = signal<Input[]>([]);

let known = ''; // the robot that the inputs belong to
effect(() => {
  const head = scene.value?.head;
  if (!head) return;
  const now = JSON.stringify([head.robot, head.actuators.map((a) => [a.name, a.kind]), head.markers.map((m) => m.name)]);
  const another = now !== known;
  known = now;
  if (another)
    batch(() => {
      marker.value = head.markers[0]?.name ?? '';
      path.value = [];
      inputs.value = [];
    });
  // The ranges may be others even if the names are the same.
  api('/api/goal/inputs')
    .then((r) => r.json())
    .then((list: Omit<Input, 'used' | 'own'>[]) => {
      if (scene.peek()?.head.revision === head.revision) inputs.value = renewed(list, inputs.peek());
    })
    .catch((e: Error) => say(e.message));
});

function present(): Point | null {
  const index = scene.value?.head.markers.findIndex((m) => m.name === marker.value) ?? -1;
  const at = frame.value?.head.markers[index];
  return at ? (at.map((v) => +v.toFixed(2)) as Point) : null;
}

function change(list: Input[], k: number, to: Partial<Input>) {
  return list.map((input, i) => (i === k ? { ...input, ...to } : input));
}

function Path() {
  const add = () => {
    const at = path.value.at(-1) ?? present();
    if (at) path.value = [...path.value, at];
  };
  const here = () => {
    const at = present();
    if (at) path.value = [...path.value, at];
  };
  return (
    <>
      {path.value.length > 0 && (
        <table class="points" data-testid="goal-path">
          <thead>
            <tr>
              <th />
              <th>x</th>
              <th>y</th>
              <th>z</th>
              <th class="unit">mm</th>
            </tr>
          </thead>
          <tbody>
            {path.value.map((point, k) => (
              <tr key={k}>
                <th>{k + 1}</th>
                {point.map((v, axis) => (
                  <td>
                    <NumberField
                      value={v}
                      range={{ from: -1e6, to: 1e6 }}
                      unit=""
                      label={`${'xyz'[axis]} of point ${k + 1}`}
                      testId={`goal-${k}-${'xyz'[axis]}`}
                      onValue={(to) => {
                        path.value = path.value.map((p, i) => (i === k ? (p.map((c, a) => (a === axis ? to : c)) as Point) : p));
                      }}
                    />
                  </td>
                ))}
                <td>
                  <button class="bare" aria-label={`Remove point ${k + 1}`} title="Remove" onClick={() => (path.value = path.value.filter((_, i) => i !== k))}>
                    ×
                  </button>
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      <div class="row left wrap">
        <button class="small" onClick={here} disabled={!present()} data-testid="goal-here">
          Add current position
        </button>
        <button class="small" onClick={add} disabled={!present()} data-testid="goal-add">
          Add point
        </button>
        {path.value.length > 0 && (
          <button class="small" onClick={() => (path.value = [])}>
            Clear
          </button>
        )}
      </div>
    </>
  );
}

export function Ranges() {
  return (
    <fieldset class="material" disabled={!mayDrive.value}>
      <legend>Actuators that may move</legend>
      {inputs.value.map((input, k) => (
        <div class="range" key={input.name}>
          <label class="tick">
            <input type="checkbox" checked={input.used} onChange={(e) => (inputs.value = change(inputs.value, k, { used: e.currentTarget.checked }))} data-testid={`goal-use-${input.name}`} />
            <span class="given">{input.name}</span>
          </label>
          <span class="ends">
            {(['low', 'high'] as const).map((end) => (
              <NumberField
                key={end}
                value={+input[end].toPrecision(5)}
                range={{ from: -1e9, to: 1e9 }}
                unit={end === 'high' ? units[input.kind] : ''}
                label={`${end === 'low' ? 'Minimum' : 'Maximum'} value of ${input.name}`}
                testId={`goal-${end}-${input.name}`}
                disabled={!input.used}
                onValue={(v) => {
                  inputs.value = change(inputs.value, k, { [end]: v, own: { ...input.own, [end]: v } });
                }}
              />
            ))}
          </span>
        </div>
      ))}
    </fieldset>
  );
}

/// Less than a nanometre is noise of the solver.
const awayText = (mm: number) => (mm < 1e-6 ? '0 mm away' : `${+mm.toPrecision(2)} mm away`);

function Waypoint({ at }: { at: WaypointFound }) {
  const kinds = Object.fromEntries((scene.value?.head.actuators ?? []).map((a) => [a.name, a.kind]));
  const values = Object.entries(at.inputs);
  return (
    <li data-testid={`waypoint-${at.index}`} data-reached={at.reached}>
      <div class="row">
        <span>
          <span class={`lamp ${at.reached ? (isLinear() ? 'warn' : 'good') : 'bad'}`} /> {at.index}: {isLinear() && '≈ '}
          {at.reached ? 'reached' : 'nearest point'}, {awayText(at.error_mm)}
        </span>
        <button class="small" disabled={!mayDrive.value} onClick={() => driveTo(Object.fromEntries(values.map(([name, value]) => [name, { kind: kinds[name], value }])))} data-testid={`go-${at.index}`}>
          Go there
        </button>
      </div>
      <p class="quiet">{values.map(([name, value]) => `${name} ${+value.toPrecision(4)}${units[kinds[name]] ? ` ${units[kinds[name]]}` : ''}`).join(', ')}</p>
      {!at.reached && <p class="limit">{at.reasons.join('; ') || 'no small change of the inputs brings it nearer'}</p>}
    </li>
  );
}

/// What was searched for last, to notice that the points have changed since.
const asked = signal('');
const order = () => JSON.stringify([marker.value, path.value]);

interface GoalFound {
  waypoints: WaypointFound[];
  message?: string; // why waypoints are missing
  notes?: string[]; // reservations about the result
}

function Found() {
  const last = resultOf('goal');
  if (!last || last.revision !== scene.value?.head.revision) return null;
  if (searching.value?.kind === 'goal') return null;
  if (asked.value && asked.value !== order()) return <p class="quiet" data-testid="goal-changed">The points have changed since the last search.</p>;
  const { waypoints, message, notes } = last.found as GoalFound;
  return (
    <>
      <ol class="waypoints" data-testid="goal-found">
        {waypoints.map((at) => (
          <Waypoint at={at} key={at.index} />
        ))}
      </ol>
      {message && <p class="limit" role="alert" data-testid="goal-message">{message}</p>}
      {notes?.map((note) => <p class="quiet" key={note} data-testid="goal-note">{note}</p>)}
      {waypoints.length > 0 && (
        <button
          class="small"
          disabled={!mayDrive.value}
          data-testid="goal-program"
          onClick={() => {
            const { keys, changes, error } = last.program ?? {};
            if (keys && changes) void insertKeys(text.value, keys, changes);
            else say(error ?? 'There is no program for this.');
          }}
        >
          Use as program
        </button>
      )}
    </>
  );
}

export function Goal() {
  const head = scene.value?.head;
  if (!head) return null;
  if (head.markers.length === 0) return <p class="quiet">A goal is a place for a marker. This robot has no marker: add a [[marker]] to its file.</p>;
  if (inputs.value.length === 0) return <p class="quiet">This robot has no cable and no chamber that could move a marker.</p>;
  return (
    <div class="search">
      <label class="row">
        Marker
        <select value={marker.value} onChange={(e) => (marker.value = e.currentTarget.value)} data-testid="goal-marker">
          {head.markers.map((m) => (
            <option key={m.name}>{m.name}</option>
          ))}
        </select>
      </label>
      <Path />
      <label class="row">
        Tolerance
        <NumberField value={tolerance.value} range={{ from: 0, to: 1e6, open: true }} unit="mm" testId="goal-tolerance" onValue={(v) => void (tolerance.value = v)} />
      </label>
      <Ranges />
      <Search
        kind="goal"
        label="Find inputs"
        ready={mayDrive.value && path.value.length > 0 && inputs.value.some((i) => i.used)}
        onBegin={() => {
          asked.value = order();
          begin('goal', {
            marker: marker.value,
            path: path.value,
            tolerance: tolerance.value,
            inputs: inputs.value.filter((i) => i.used).map(({ name, low, high }) => ({ name, low, high })),
          });
        }}
      />
      <Found />
    </div>
  );
}
