// Before a print: the choice of machine, and the print history of the folder.
import { useEffect, useRef, useState } from 'preact/hooks';
import { counted } from '../counted';
import { useKeptFocus } from '../dismiss';
import { Icon } from '../icons';
import { api, job, mayDrive, post, say, section } from '../store';
import { jobFileName } from '../make/file_name';
import { clock } from '../make/plan';
import { changes, staleText } from '../make/stale';
import { Wizards } from '../wizard/list';
import { Queue } from './queue';

const speeds = [1, 10, 60, 300, 3000];
const usualSpeed = 60;

interface Ports {
  ports: { device: string; name: string }[];
  displays: { number: number; name: string; width: number; height: number }[];
  without: string;
}

interface JournalLine {
  name: string;
  file: string; // file of its job
  virtual: boolean;
  state: 'complete' | 'cancelled' | 'interrupted' | 'not begun' | 'damaged';
  error?: string;
  job?: string;
  printer?: string;
  lights?: number;
  layer?: number;
}

interface Journal extends JournalLine {
  records: { number: number; kind: string; text: string }[];
  open_light: boolean;
}

function TakeTwin() {
  const [speed, setSpeed] = useState(usualSpeed);
  return (
    <section class="card">
      <h3>Virtual printer</h3>
      <p class="quiet">It obeys the same G-code as the real printer. Nothing can break.</p>
      <div class="row left wrap">
        <button class="primary" disabled={!mayDrive.value} data-testid="take-twin" onClick={() => post('/api/print/twin', { speed })}>
          Connect
        </button>
        <label class="inline">
          at
          <select value={speed} onChange={(e) => setSpeed(Number(e.currentTarget.value))} data-testid="take-speed">
            {speeds.map((s) => (
              <option value={s}>{s}×</option>
            ))}
          </select>
          speed
        </label>
      </div>
      {!job.value?.saved && <p class="quiet small-print">Only a saved job keeps a print journal, with which a virtual print can be resumed after the studio has been closed.</p>}
    </section>
  );
}

/// A job that was only sliced has no file yet.
function SaveFirst() {
  const j = job.value!;
  const [name, setName] = useState(jobFileName(j.manifest.name));
  return (
    <form
      class="row left wrap"
      onSubmit={(e) => {
        e.preventDefault();
        void post('/api/job/save', { name });
      }}
    >
      <span class="quiet">The print journal is stored next to the job file. Save the job first:</span>
      <input aria-label="Name of the job file" value={name} onInput={(e) => setName(e.currentTarget.value)} data-testid="save-job-name" />
      <button disabled={!name || !mayDrive.value} data-testid="save-job">
        Save the job
      </button>
    </form>
  );
}

function TakePort() {
  const j = job.value!;
  const [known, setKnown] = useState<Ports | null>(null);
  const [device, setDevice] = useState('');
  const [projector, setProjector] = useState('');
  const [speed, setSpeed] = useState(1);
  const [ownClock, setOwnClock] = useState('');
  const look = () =>
    api('/api/print/ports')
      .then((r) => r.json())
      .then((p: Ports) => {
        setKnown(p);
        // A suggestion must not replace what the user is typing.
        const typing = document.activeElement?.tagName === 'INPUT' || document.activeElement?.tagName === 'TEXTAREA';
        if (typing) return;
        setDevice((d) => d || p.ports[0]?.device || '');
        setProjector((o) => o || (p.displays.length > 1 ? String(p.displays[p.displays.length - 1].number) : 'light'));
      })
      .catch((e: Error) => say(e.message));
  useEffect(() => void look(), []);
  const display = known?.displays.find((d) => String(d.number) === projector);
  const wrong = display && (display.width !== j.manifest.width_px || display.height !== j.manifest.height_px);
  return (
    <section class="card">
      <h3>Serial printer</h3>
      {!j.saved ? (
        <SaveFirst />
      ) : (
        <form
          class="fields"
          onSubmit={(e) => {
            e.preventDefault();
            void post('/api/print/port', { device, projector, speed, clock: ownClock });
          }}
        >
          <label>
            <span>Port</span>
            <span class="with-button">
              <input list="ports" value={device} placeholder="/dev/ttyACM0" spellcheck={false} onInput={(e) => setDevice(e.currentTarget.value)} data-testid="device" />
              <button type="button" class="small" onClick={() => void look()}>
                Refresh
              </button>
            </span>
            <datalist id="ports">
              {known?.ports.map((p) => (
                <option value={p.device}>{p.name}</option>
              ))}
            </datalist>
          </label>
          <p class="quiet under">
            {known === null
              ? 'searching…'
              : known.ports.length === 0
                ? 'No device found on any serial port. Plug in the printer and press Refresh.'
                : known.ports.map((p) => `${p.device} ${p.name}`).join(' · ')}
          </p>
          <label>
            <span>Projector</span>
            <input list="displays" value={projector} spellcheck={false} onInput={(e) => setProjector(e.currentTarget.value)} data-testid="projector" />
            <datalist id="displays">
              {known?.displays.map((d) => (
                <option value={String(d.number)}>{`${d.name}, ${d.width} × ${d.height}`}</option>
              ))}
            </datalist>
          </label>
          <p class={wrong ? 'problems' : 'quiet under'}>
            {wrong
              ? `${display.name} has ${display.width} × ${display.height} pixels, the job ${j.manifest.width_px} × ${j.manifest.height_px}.`
              : display
                ? `Display ${display.number}: ${display.name}, ${display.width} × ${display.height}. It is black except during exposure.`
                : /^\d+$/.test(projector)
                  ? 'This computer has no such display.'
                  : `Images are written to the folder “${projector}”, for a machine that reads them from there. For a projector, enter the number of its display${known?.displays.length ? `: ${known.displays.map((d) => `${d.number} ${d.name}`).join(', ')}` : ''}.`}
          </p>
          <details>
            <summary>For a virtual printer on this port (pliant twin)</summary>
            <label>
              <span>Speed</span>
              <span class="number">
                <input type="number" min={0.1} max={10000} step="any" value={speed} onChange={(e) => setSpeed(Number(e.currentTarget.value))} data-testid="port-speed" />
                <span class="unit">×</span>
              </span>
            </label>
            <label>
              <span>Clock file</span>
              <input placeholder="a file in the folder, as for pliant twin --clock" value={ownClock} spellcheck={false} onInput={(e) => setOwnClock(e.currentTarget.value)} data-testid="port-clock" />
            </label>
          </details>
          <button class="primary" disabled={!mayDrive.value || !device || !projector} data-testid="take-port">
            Connect
          </button>
        </form>
      )}
    </section>
  );
}

function JournalView({ name, close }: { name: string; close: () => void }) {
  const [journal, setJournal] = useState<Journal | null>(null);
  useEffect(() => {
    api(`/api/print/journal?name=${encodeURIComponent(name)}`)
      .then((r) => r.json())
      .then(setJournal)
      .catch((e: Error) => say(e.message));
  }, [name]);
  if (!journal) return null;
  return (
    <div class="journal" data-testid="journal">
      <div class="row">
        <b>{name}</b>
        <button class="bare" aria-label="Close the journal" onClick={close}>
          <Icon name="close" />
        </button>
      </div>
      <p class="quiet">
        {journal.job} on {journal.printer}: {counted(journal.lights ?? 0, 'exposure')}, {journal.state}
        {journal.open_light && ', interrupted during an exposure'}.
      </p>
      <ol class="log records">
        {journal.records.map((r) => (
          <li key={r.number}>
            <time>{r.number}</time>
            <b>{r.kind}</b>
            <span>{r.text}</span>
          </li>
        ))}
      </ol>
      <div class="row left wrap">
        {journal.state === 'interrupted' && (
          <button class="primary" disabled={!mayDrive.value} data-testid="open-interrupted" onClick={() => post('/api/open', { name: journal.file })}>
            Open its job to resume
          </button>
        )}
        <a class="button" href={`/api/print/report?name=${encodeURIComponent(name)}`} download>
          <Icon name="download" /> Report
        </a>
      </div>
    </div>
  );
}

/// End of a print whose journal was kept, in local time; "": the last print of its job.
function endOf(name: string): string {
  const m = /\.(\d{4}-\d{2}-\d{2})_(\d{2})(\d{2})(\d{2})\.journal$/.exec(name);
  return m ? new Date(`${m[1]}T${m[2]}:${m[3]}:${m[4]}Z`).toLocaleString() : '';
}

/// Opens the job of an interrupted print; a virtual printer is connected at once, so that Resume is offered.
async function openToResume(line: JournalLine) {
  if (!(await post('/api/open', { name: line.file }))) return;
  section.value = 'print';
  if (line.virtual) await post('/api/print/twin', { speed: usualSpeed });
  else say('Connect the printer; then the print can be resumed.');
}

function Journals() {
  const [lines, setLines] = useState<JournalLine[]>([]);
  const [open, setOpen] = useState('');
  useEffect(() => {
    api('/api/print/journals')
      .then((r) => r.json())
      .then(setLines)
      .catch((e: Error) => say(e.message));
  }, []);
  if (lines.length === 0) return null;
  const colour = { complete: 'good', interrupted: 'busy', cancelled: '', 'not begun': '', damaged: 'bad' };
  return (
    <section class="card wide-card">
      <h3>Print history</h3>
      <ul class="journals" data-testid="journals">
        {lines.map((l) => (
          <li key={l.name}>
            <button class="item" aria-expanded={open === l.name} onClick={() => setOpen(open === l.name ? '' : l.name)}>
              <span class={`lamp ${colour[l.state]}`} />
              <span>
                {l.file.replace(/\.zip$/, '')}
                {l.virtual && <span class="quiet"> · virtual printer</span>}
                {endOf(l.name) && <span class="quiet"> · {endOf(l.name)}</span>}
              </span>
              <span class="quiet">{l.error ?? `${l.state}${l.layer !== undefined && l.layer >= 0 ? `, last layer ${l.layer + 1}` : ''}`}</span>
            </button>
            {l.state === 'interrupted' && (
              <button class="small" disabled={!mayDrive.value} data-testid="open-and-resume" onClick={() => void openToResume(l)}>
                Open and resume
              </button>
            )}
          </li>
        ))}
      </ul>
      {open && <JournalView key={open} name={open} close={() => setOpen('')} />}
    </section>
  );
}

export function TakeMachine() {
  const j = job.value;
  const box = useRef<HTMLDivElement>(null);
  useKeptFocus(box, ['[data-testid=device]', '.landing']); // once the job was saved
  return (
    <div class="take" ref={box}>
      <h2 class="landing" tabIndex={-1}>
        Print
      </h2>
      {j ? (
        <>
          <p>
            <b>{j.manifest.name}</b>, {counted(j.manifest.layers.length, 'layer')}, for {j.printer}
            {j.plan && `: ${clock(j.plan.seconds.total)}, ${counted(j.plan.swaps, 'swap')}`}.
          </p>
          {changes.value.length > 0 && (
            <div class="prompt" role="status" data-testid="stale-job">
              <Icon name="warn" />
              <span>
                {staleText(changes.value)}{' '}
                <a href="#make" onClick={() => (section.value = 'make')}>
                  Slice again
                </a>{' '}
                under Prepare.
              </span>
            </div>
          )}
          <div class="cards">
            <TakeTwin />
            <TakePort key={j.revision} />
          </div>
        </>
      ) : (
        <p>
          There is no job yet. <a href="#make" onClick={() => (section.value = 'make')}>Slice the robot</a>, or open a job file.
        </p>
      )}
      <Queue />
      <Wizards />
      <Journals />
    </div>
  );
}
