// Machine setup: a printer file based on a built-in one, the connected board, axes, vats.
import { signal } from '@preact/signals';
import { useEffect, useState } from 'preact/hooks';
import { counted } from '../counted';
import { hasEnding } from '../file_names';
import { Icon } from '../icons';
import { printer } from '../make/order';
import { api, mayDrive, post, say, section } from '../store';
import { PickPort, SetupNumber, usePorts } from './parts';
import { device, file, open, setup, write, type AxisSetup, type Change } from './state';
import type { Step } from './wizard';

interface BuiltIn {
  name: string;
  title: string;
  store: string;
  vats: number;
  size_mm: [number, number, number];
  pixel_um: number;
  dialect: string;
}

const from = signal('tower');
const fileName = signal('my_printer.toml');
const title = signal('');
const stores: Record<string, string> = { tower: 'tower of vats', wall: 'wall of vats', table: 'turntable or conveyor', none: 'one vat' };

function factsOf(p: BuiltIn): string[] {
  const store = p.store === 'none' ? stores.none : `${stores[p.store]}, ${counted(p.vats, 'vat')}`;
  return [store, `${p.size_mm.map((v) => v.toFixed(0)).join(' × ')} mm`, `pixel ${p.pixel_um.toFixed(0)} µm`, p.dialect.replace(/^m/, 'M')];
}

function Choose() {
  const [list, setList] = useState<BuiltIn[]>([]);
  const [mine, setMine] = useState<string[]>([]);
  useEffect(() => {
    api('/api/printers')
      .then((r) => r.json())
      .then(setList)
      .catch((e: Error) => say(e.message));
    api('/api/project')
      .then((r) => r.json())
      .then((p: { printers: string[] }) => setMine(p.printers.filter((n) => hasEnding(n, '.toml'))))
      .catch((e: Error) => say(e.message));
  }, []);
  return (
    <>
      <p>Choose the printer that is most like yours. Its printer file is copied into the folder and changed step by step; its comments stay.</p>
      <div class="choices" role="radiogroup" aria-label="Printer to start from">
        {list.map((p) => (
          <label class="choice">
            <input type="radio" name="from" checked={from.value === p.name} onChange={() => (from.value = p.name)} data-testid={`from-${p.name}`} />
            <span>
              <b>{p.title}</b>
              <span class="quiet facts">
                {factsOf(p).map((fact) => (
                  <span>{fact}</span>
                ))}
              </span>
            </span>
          </label>
        ))}
        {mine.map((n) => (
          <label class="choice">
            <input type="radio" name="from" checked={from.value === n} onChange={() => (from.value = n)} data-testid={`from-${n}`} />
            <span>
              <b>{n}</b>
              <span class="quiet">in this folder: edit it</span>
            </span>
          </label>
        ))}
      </div>
      {!hasEnding(from.value, '.toml') && (
        <>
          <label class="wizard-field">
            <span>File</span>
            <input value={fileName.value} spellcheck={false} onInput={(e) => (fileName.value = e.currentTarget.value)} data-testid="printer-file-name" />
          </label>
          <label class="wizard-field">
            <span>Name</span>
            <input value={title.value} placeholder={list.find((p) => p.name === from.value)?.title} onInput={(e) => (title.value = e.currentTarget.value)} data-testid="printer-title" />
          </label>
        </>
      )}
    </>
  );
}

async function begin(tell: (why: string) => void): Promise<boolean> {
  if (hasEnding(from.value, '.toml')) {
    file.value = from.value;
    return true;
  }
  if (!(await post('/api/printer/new', { from: from.value, name: fileName.value }, tell))) return false;
  file.value = fileName.value;
  from.value = fileName.value; // going back does not create it again
  return title.value === '' || write([{ key: 'name', value: title.value }], tell);
}

interface Board {
  firmware: string;
  capabilities: Record<string, boolean>;
  switches: string[];
  problems: string[];
}
const baud = signal('');
const board = signal<Board | null>(null);

function Port() {
  const [ports, look] = usePorts();
  const [asking, setAsking] = useState(false);
  const [why, setWhy] = useState('');
  const rate = baud.value || String(setup.value?.baud_rate ?? '');
  const ask = async () => {
    setAsking(true);
    setWhy('');
    board.value = null;
    try {
      const answer = await api('/api/printer/probe', {
        method: 'POST',
        headers: { 'Content-Type': 'application/json' },
        body: JSON.stringify({ name: file.value, device: device.value, baud_rate: Number(rate) }),
      });
      board.value = (await answer.json()) as Board;
    } catch (error) {
      setWhy((error as Error).message);
    }
    setAsking(false);
  };
  const b = board.value;
  return (
    <>
      <p>
        Plug in the board. It is only asked for its firmware and settings: <b>nothing moves</b>. Opening the port resets most boards. Without a machine, skip this step.
      </p>
      <PickPort ports={ports} look={look} />
      <label class="wizard-field">
        <span>Baud rate</span>
        <input inputMode="numeric" list="rates" value={rate} onInput={(e) => (baud.value = e.currentTarget.value)} data-testid="baud" />
        <datalist id="rates">
          {[115200, 250000, 500000].map((r) => (
            <option value={String(r)} />
          ))}
        </datalist>
      </label>
      <button disabled={!mayDrive.value || !device.value || asking} onClick={() => void ask()} data-testid="ask-board">
        {asking ? 'querying, takes some seconds…' : 'Query board'}
      </button>
      {why && (
        <p class="problems" role="alert">
          {why}
        </p>
      )}
      {b && (
        <div class="board" data-testid="board">
          {b.firmware ? (
            <p class="board-line">
              <Icon name="check" />
              <span>
                <b>{b.firmware}</b> responds
                {b.switches.length > 0 && <span class="quiet"> · reads {b.switches.join(', ')}</span>}
              </span>
            </p>
          ) : (
            <p class="board-line">
              <Icon name="warn" />
              <span>No Marlin firmware responds. Try another baud rate or port.</span>
            </p>
          )}
          {b.firmware && b.problems.length === 0 && <p class="quiet">The firmware is configured as this machine needs it.</p>}
          {b.problems.length > 0 && (
            <>
              <p class="quiet">What does not match this machine yet: the next steps change the printer file; firmware settings take a new firmware build.</p>
              <ul class="reasons" data-testid="board-problems">
                {b.problems.map((p) => (
                  <li>{p}</li>
                ))}
              </ul>
            </>
          )}
        </div>
      )}
    </>
  );
}

const axisTexts = signal<Record<string, string>>({});
const axisFields = ['min', 'max', 'speed', 'acceleration', 'homing_speed'] as const;
type AxisField = (typeof axisFields)[number];
function unitOf(a: AxisSetup, f: AxisField): string {
  const length = a.rotary ? '°' : 'mm';
  return f === 'min' || f === 'max' ? length : f === 'acceleration' ? `${length}/s²` : `${length}/s`;
}
const shownOf = (a: AxisSetup, f: AxisField) => axisTexts.value[`${a.name}.${f}`] ?? String(a[f]);

/// Typed values that differ, as changes of the file.
export function axisChanges(axes: AxisSetup[], texts: Record<string, string>): Change[] {
  const changes: Change[] = [];
  for (const a of axes) {
    const unit = a.rotary ? 'deg' : 'mm';
    const of = (f: AxisField) => texts[`${a.name}.${f}`] ?? String(a[f]);
    const differs = (f: AxisField) => Number(of(f)) !== a[f];
    if (differs('min') || differs('max')) changes.push({ key: `axis.${a.name}.travel`, value: [`${of('min')} ${unit}`, `${of('max')} ${unit}`] });
    if (differs('speed')) changes.push({ key: `axis.${a.name}.speed`, value: `${of('speed')} ${unit}/s` });
    if (differs('acceleration')) changes.push({ key: `axis.${a.name}.acceleration`, value: `${of('acceleration')} ${unit}/s^2` });
    if (differs('homing_speed')) changes.push({ key: `axis.${a.name}.homing_speed`, value: `${of('homing_speed')} ${unit}/s` });
  }
  return changes;
}

export function AxesTable() {
  const heads: Record<AxisField, string> = { min: 'from', max: 'to', speed: 'speed', acceleration: 'acceleration', homing_speed: 'homing' };
  return (
    <div class="scroll-x">
      <table class="axes-table" data-testid="axes-table">
        <thead>
          <tr>
            <th scope="col">axis</th>
            {axisFields.map((f) => (
              <th scope="col">{heads[f]}</th>
            ))}
            <th scope="col">homes to</th>
          </tr>
        </thead>
        <tbody>
          {setup.value?.axes.map((a) => (
            <tr>
              <th scope="row">
                {a.name} <span class="quiet">{a.letter}</span>
              </th>
              {axisFields.map((f) => (
                <td data-head={heads[f]}>
                  <SetupNumber
                    label={`${a.name}: ${heads[f]}`}
                    value={shownOf(a, f)}
                    unit={unitOf(a, f)}
                    testId={`axis-${a.name}-${f}`}
                    onValue={(text) => (axisTexts.value = { ...axisTexts.value, [`${a.name}.${f}`]: text })}
                  />
                </td>
              ))}
              <td data-head="homes to">{a.home}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

export async function writeAxes(tell: (why: string) => void): Promise<boolean> {
  const done = await write(axisChanges(setup.value?.axes ?? [], axisTexts.value), tell);
  if (done) axisTexts.value = {};
  return done;
}

const vatTexts = signal<Record<number, string>>({});

function Vats() {
  const s = setup.value;
  return (
    <>
      <p>Which resin is in each vat? For a resin that the file does not have yet, choose one of those that it has, and find the exposure with the exposure finder.</p>
      <datalist id="wizard-resins">
        {s?.resins.map((r) => (
          <option value={r.name} />
        ))}
      </datalist>
      {s?.vats.map((v, k) => (
        <label class="wizard-field">
          <span>Slot {v.slot}</span>
          <input list="wizard-resins" value={vatTexts.value[k] ?? v.resin} onInput={(e) => (vatTexts.value = { ...vatTexts.value, [k]: e.currentTarget.value })} data-testid={`vat-${v.slot}`} />
        </label>
      ))}
    </>
  );
}

async function writeVats(tell: (why: string) => void): Promise<boolean> {
  const vats = setup.value?.vats ?? [];
  const changes = Object.entries(vatTexts.value)
    .filter(([k, text]) => vats[Number(k)] && text !== vats[Number(k)].resin)
    .map(([k, text]) => ({ key: `vat.${k}.resin`, value: text }));
  const done = await write(changes, tell);
  if (done) vatTexts.value = {};
  return done;
}

function Done() {
  return (
    <>
      <p>
        <b>{file.value}</b> is set up. From now on, Prepare slices for it.
      </p>
      <div class="row left wrap">
        <button onClick={() => open('projector')}>Focus and size of the projector</button>
        <button onClick={() => open('axes')}>Axes and swap</button>
        <button onClick={() => open('exposure')}>Exposure finder</button>
        <button
          class="primary"
          data-testid="to-prepare"
          onClick={() => {
            section.value = 'make';
            location.hash = 'make';
          }}
        >
          Prepare a print
        </button>
      </div>
    </>
  );
}

export const machineSteps = (): Step[] => [
  { name: 'Machine', body: () => <Choose />, leave: begin, lacks: () => (hasEnding(from.value, '.toml') || /\.toml$/.test(fileName.value) ? '' : 'the name of a printer file ends with .toml') },
  {
    name: 'Port',
    body: () => <Port />,
    leave: (tell) => (baud.value && Number(baud.value) !== setup.value?.baud_rate ? write([{ key: 'controller.baud_rate', value: Number(baud.value) }], tell) : Promise.resolve(true)),
  },
  {
    name: 'Axes',
    body: () => (
      <>
        <p>Pliant enforces the travel as soft limits; speeds are at most what the firmware allows.</p>
        <AxesTable />
      </>
    ),
    leave: writeAxes,
  },
  { name: 'Vats', body: () => <Vats />, leave: writeVats },
  {
    name: 'Ready',
    body: () => <Done />,
    leave: () => {
      printer.value = file.value;
      return Promise.resolve(true);
    },
  },
];
