// Identifies parameters of the robot from a table of measurements.
import { effect, signal } from '@preact/signals';
import { counted } from '../counted';
import { enlarged } from '../print/enlarged';
import { api, mayDrive, say, scene } from '../store';
import { pinNow, setValues } from './editor';
import { begin, type IdentifyFound, isOfBefore, resultNumber, resultOf, RoughNote, Search } from './search';
import { changeOf } from './toml_edit';
import { judgeRows } from './tracks';

interface Unknown {
  key: string;
  shown: string; // its current value
}

const unknowns = signal<Unknown[]>([]);
const chosen = signal<Record<string, { used: boolean; bounds: string }>>({});
const table = signal<{ name: string; csv: string } | null>(null);
const judge = signal('');

effect(() => {
  if (!scene.value) return;
  api('/api/unknowns')
    .then((r) => r.json())
    .then((list: Unknown[]) => (unknowns.value = list))
    .catch((e: Error) => say(e.message));
});

function Unknowns() {
  return (
    <fieldset class="material" disabled={!mayDrive.value}>
      <legend>Parameters to identify</legend>
      <div class="unknowns">
        {unknowns.value.map(({ key, shown }) => {
          const now = chosen.value[key] ?? { used: false, bounds: '' };
          const set = (to: Partial<typeof now>) => (chosen.value = { ...chosen.value, [key]: { ...now, ...to } });
          return (
            <div key={key}>
              <label class="tick">
                <input type="checkbox" checked={now.used} onChange={(e) => set({ used: e.currentTarget.checked })} data-testid={`unknown-${key}`} />
                <span class="key">{key}</span>
                <span class="quiet">{shown}</span>
              </label>
              {now.used && (
                <input type="text" class="bounds" placeholder="bounds, as in 0.1 MPa..2 MPa (optional)" aria-label={`Bounds of ${key}`} value={now.bounds} onChange={(e) => set({ bounds: e.currentTarget.value.trim() })} data-testid={`bounds-${key}`} />
              )}
            </div>
          );
        })}
      </div>
    </fieldset>
  );
}

/// The field is emptied: a file that is chosen again has been edited.
async function takeMeasured(field: HTMLInputElement) {
  const file = field.files?.[0];
  if (!file) return;
  const csv = await file.text();
  field.value = '';
  table.value = { name: file.name, csv };
}

function Table() {
  const head = scene.value!.head;
  const held = table.value ? judgeRows(table.value.csv) : 0;
  const columns = [...head.markers.flatMap((m) => [`${m.name}_x_mm`, `${m.name}_z_mm`]), ...head.actuators.map((a) => (a.type === 'cable' ? `${a.name}_tension_N` : `${a.name}_pressure_kPa`))];
  return (
    <>
      <div class="row">
        <span>Measurements</span>
        <span class="row">
          <span class="given quiet" data-testid="measured-name">
            {table.value?.name ?? 'none'}
          </span>
          <label class="button small">
            Choose a CSV…
            <input class="unseen" type="file" accept=".csv,text/csv" data-testid="measured" onChange={(e) => void takeMeasured(e.currentTarget)} />
          </label>
        </span>
      </div>
      <p class="quiet small-print">
        CSV with one row per instant: a column time or step, and any of {columns.slice(0, 4).join(', ')}
        {columns.length > 4 && ', …'}, as in the exported histories.
      </p>
      <label class="row">
        Held-out rows
        <select value={judge.value} onChange={(e) => (judge.value = e.currentTarget.value)} data-testid="judge">
          <option value="">{held > 0 ? `as in the file (${counted(held, 'row')})` : 'none'}</option>
          <option value="every-second">every second row</option>
          <option value="second-half">the second half</option>
        </select>
      </label>
    </>
  );
}

/// Writes the results into the robot file.
function take(found: IdentifyFound) {
  pinNow('before');
  void setValues(found.assignments.map(changeOf));
}

function Errors({ of, errors }: { of: string; errors: IdentifyFound['fitted'] }) {
  return (
    <>
      {errors.map((e) => (
        <tr key={`${of}${e.unit}`}>
          <th>
            {of} <span class="quiet">{e.values} values</span>
          </th>
          <td>{+e.rms_before.toPrecision(3)}</td>
          <td>{+e.rms_after.toPrecision(3)}</td>
          <td class="unit">{e.unit}</td>
        </tr>
      ))}
    </>
  );
}

function FoundPlot({ address }: { address: string }) {
  return (
    <button class="enlarge" aria-label="Enlarge the plot" onClick={() => (enlarged.value = { address, title: 'Measured and simulated' })} data-testid="enlarge-plot">
      <img class="found-plot" src={address} alt="Measured values, and simulated ones before and after" />
    </button>
  );
}

function Found() {
  const last = resultOf('identify');
  if (!last) return null;
  const found = last.found as IdentifyFound;
  return (
    <div data-testid="identify-found">
      {isOfBefore(last) && <p class="quiet">The robot has been changed since these values were found.</p>}
      <RoughNote of={last} />
      <table class="readings">
        <thead>
          <tr>
            <th>Parameter</th>
            <th>before</th>
            <th>after</th>
          </tr>
        </thead>
        <tbody>
          {found.unknowns.map((one, k) => (
            <>
              <tr key={one.key} data-testid={`found-${one.key}`}>
                <th class="key">{one.key}</th>
                <td>{found.shown[k].start}</td>
                <td>
                  <b>{found.shown[k].value}</b>
                </td>
              </tr>
              <tr class="of-above">
                <td colSpan={3} class="quiet">
                  {!one.matters
                    ? 'no measured quantity depends on it'
                    : found.shown[k].low
                      ? `95 % confidence: ${found.shown[k].low} to ${found.shown[k].high}${one.at_bound ? ', at its bound' : ''}`
                      : one.at_bound
                        ? 'at its bound'
                        : 'no confidence interval from these data'}
                </td>
              </tr>
            </>
          ))}
        </tbody>
      </table>
      <table class="readings">
        <thead>
          <tr>
            <th>Root mean square error</th>
            <th>before</th>
            <th>after</th>
            <th />
          </tr>
        </thead>
        <tbody>
          <Errors of="fitted" errors={found.fitted} />
          <Errors of="held out" errors={found.judged} />
        </tbody>
      </table>
      {found.warnings.map((w) => (
        <p class="limit">{w}</p>
      ))}
      <button class="small" disabled={!mayDrive.value} onClick={() => take(found)} data-testid="identify-use">
        Use these values
      </button>
      {Array.from({ length: found.plots }, (_, k) => (
        <FoundPlot key={k} address={`/api/search/plots/${k}?result=${resultNumber.value}`} />
      ))}
    </div>
  );
}

export function Identify() {
  if (!scene.value) return null;
  const wanted = unknowns.value.filter(({ key }) => chosen.value[key]?.used).map(({ key }) => (chosen.value[key].bounds ? `${key}=${chosen.value[key].bounds}` : key));
  return (
    <div class="search">
      <Unknowns />
      <Table />
      <Search
        kind="identify"
        label="Identify"
        ready={mayDrive.value && wanted.length > 0 && table.value !== null}
        onBegin={() => begin('identify', { unknowns: wanted, csv: table.value!.csv, file: table.value!.name, judge: judge.value })}
      />
      <Found />
    </div>
  );
}
