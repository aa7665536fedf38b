// The workspace of the markers within the ranges of the actuators, drawn around the robot.
import { computed, effect, signal } from '@preact/signals';
import { counted } from '../counted';
import { NumberField } from '../number_field';
import { mayDrive, scene } from '../store';
import { inputs, Ranges } from './goal';
import { saveBlob } from './save';
import { begin, resultOf, RoughNote, Search } from './search';

interface Reach {
  name: string;
  sheet_points: number[];
  triangles: number[];
  points: number[];
}
interface WorkspaceFound {
  summary: { samples: number; found: number; warnings?: string[]; markers: Record<string, { low_mm: number[]; high_mm: number[] }> };
  reach: Reach[];
  csv: string;
}

const side = signal(7);
const between = signal(20);
const shown = signal<string | null>(null); // the displayed marker; null: the first

const current = computed(() => {
  const last = resultOf('workspace');
  return last?.revision === scene.value?.head.revision ? last : null;
});
const found = computed(() => (current.value?.found as WorkspaceFound | undefined) ?? null);
/// What the view draws; null: nothing.
export const reach = computed<Reach | null>(() => {
  const list = found.value?.reach ?? [];
  return list.find((r) => r.name === shown.value) ?? list[0] ?? null;
});
effect(() => {
  if (found.value === null) shown.value = null;
});

/// Number of samples, as planned in src/simulation/inverse/workspace.cpp: sheets of two inputs with all others at an
/// end, plus the samples in between.
export function samplesOf(count: number, places: number, inBetween: number): number {
  if (count === 1) return places;
  const most = 5;
  const sheets = count > most ? 0 : ((count * (count - 1)) / 2) * 2 ** (count - 2) * places * places;
  return sheets + inBetween;
}

function rangeText(low: number, high: number): string {
  const [from, to] = [low.toFixed(1), high.toFixed(1)];
  return from === to ? from : `${from} to ${to}`;
}

function Found() {
  const f = found.value;
  if (!f) return null;
  return (
    <div class="search" data-testid="workspace-found">
      <RoughNote of={current.value!} />
      <p>
        Equilibrium found at {f.summary.found} of {counted(f.summary.samples, 'sample')}.
      </p>
      {f.summary.warnings?.map((warning) => <p class="limit" key={warning} data-testid="workspace-warning">{warning}</p>)}
      <table class="readings">
        <thead>
          <tr>
            <th>Marker</th>
            <th>x</th>
            <th>y</th>
            <th>z, mm</th>
          </tr>
        </thead>
        <tbody>
          {Object.entries(f.summary.markers).map(([name, box]) => (
            <tr key={name} data-testid={`reach-${name}`}>
              <th>
                <label class="tick">
                  <input type="radio" name="reach" checked={reach.value?.name === name} onChange={() => (shown.value = name)} /> {name}
                </label>
              </th>
              {[0, 1, 2].map((k) => (
                <td key={k}>
                  {rangeText(box.low_mm[k], box.high_mm[k])}
                </td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
      <div class="row left">
        <button class="small" onClick={() => saveBlob(new Blob([f.csv], { type: 'text/csv' }), 'workspace.csv')} data-testid="workspace-csv">
          CSV
        </button>
      </div>
    </div>
  );
}

export function Workspace() {
  const head = scene.value?.head;
  if (!head) return null;
  if (head.markers.length === 0) return <p class="quiet">A workspace is the space that markers can reach. This robot has no marker: add one under Build.</p>;
  if (inputs.value.length === 0) return <p class="quiet">This robot has no cable and no chamber that could move a marker.</p>;
  const used = inputs.value.filter((i) => i.used);
  const count = samplesOf(used.length, side.value, between.value);
  return (
    <div class="search">
      <p class="quiet">Finds the space that the markers can reach, and draws it around the robot.</p>
      <Ranges />
      <label class="row">
        Samples per range
        <NumberField value={side.value} range={{ from: 2, to: 60 }} unit="" step={1} label="Samples along each actuator's range" testId="workspace-side" onValue={(v) => void (side.value = Math.round(v))} />
      </label>
      {used.length > 1 && (
        <label class="row">
          Samples in between
          <NumberField value={between.value} range={{ from: 0, to: 2000 }} unit="" step={1} label="Samples spread in between" testId="workspace-between" onValue={(v) => void (between.value = Math.round(v))} />
        </label>
      )}
      <p class="quiet" data-testid="workspace-count">{counted(count, 'sample')} will be solved.</p>
      <Search
        kind="workspace"
        label="Find the workspace"
        ready={mayDrive.value && used.length > 0}
        onBegin={() => begin('workspace', { inputs: used.map(({ name, low, high }) => ({ name, low, high })), side: side.value, between: between.value })}
      />
      <Found />
    </div>
  );
}

