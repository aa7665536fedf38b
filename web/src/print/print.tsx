// Monitoring and controlling a print.
import { signal } from '@preact/signals';
import { useEffect, useRef, useState } from 'preact/hooks';
import { counted } from '../counted';
import { Icon } from '../icons';
import { Lost } from '../lost';
import { NumberField } from '../number_field';
import { job, post } from '../store';
import { clock } from '../make/plan';
import { changes, staleText } from '../make/stale';
import { orbitHelp } from '../orbit_keys';
import { theme } from '../theme';
import { MachineView } from './machine_view';
import { followPart, part } from './part';
import { Safety } from './safety';
import { busy, events, flags, host, info, isCancelled, known, maySteer, now, verdict } from './state';
import { enlarged } from './enlarged';
import { stopOf } from './stopped';
import { Notifications } from './tell';
import { Webcam } from './webcam';
import { TakeMachine } from './take';
import { NextInQueue } from './queue';
import { Wizard } from '../wizard/wizard';
import { wizard } from '../wizard/state';

const speeds = [1, 10, 60, 300];
const ticks = signal<Record<string, boolean>>({});

/// The results of the studio's own checks.
function Known() {
  const n = now.value!;
  const i = info.value!;
  const connected = known.value && flags.value.operational;
  return (
    <ul class="checklist known" data-testid="known">
      <li class={connected ? 'good' : 'bad'}>
        <Icon name={connected ? 'check' : 'warn'} />
        <span>{!known.value ? 'unknown whether the machine responds' : connected ? `${i.twin ? 'the virtual printer' : i.device} responds: ${n.machine.firmware || 'unnamed firmware'}` : 'the machine does not respond'}</span>
      </li>
      <li class={connected ? 'good' : 'bad'}>
        <Icon name={connected ? 'check' : 'warn'} />
        <span>{!known.value ? 'unknown whether the projector is dark' : !connected ? 'not connected: the projector was last set to dark' : 'the projector is connected and dark'}</span>
      </li>
      <li class="good">
        <Icon name="check" />
        <span>
          the job is verified for this machine: {counted(n.job.layers, 'layer')}, {clock(i.seconds)}
        </span>
      </li>
      {i.warnings.map((text) => (
        <li key={text}>
          <Icon name="warn" />
          <span>{text}</span>
        </li>
      ))}
      {i.refills.length > 0 && (
        <li>
          <Icon name="warn" />
          <span>
            the print will pause {i.refills.length === 1 ? 'once' : `${i.refills.length} times`} for a refill: {i.refills.map((r) => `layer ${r.layer + 1}, ${r.text}`).join('; ')}
          </span>
        </li>
      )}
    </ul>
  );
}

/// Why the job that would be printed is perhaps not the one that is meant; "": no reason.
function oldJob(): string {
  const i = info.value!;
  const j = job.value;
  if (j && j.key !== i.key && !(j.saved && j.file === i.file)) return 'The job at hand is another one: this machine prints the job with which it was connected. To print the other one, disconnect and connect again.';
  return changes.value.length > 0 ? `${staleText(changes.value)} Slice again, or confirm that it is meant.` : '';
}

function Checklist() {
  const i = info.value!;
  const items: [string, string][] = [
    ...i.vats.map((v): [string, string] => [`slot${v.slot}`, `slot ${v.slot} holds at least ${Math.ceil(v.ml)} ml of ${v.resin}`]),
    ['platform', 'the platform is clean, tightened and level'],
    ['path', 'carriage, tower and platform are free to move'],
    ['solution', 'the cleaning solution is full, the drain is clear'],
  ];
  const old = oldJob();
  if (old) items.unshift([old, old]); // another change is to be confirmed again
  const open = items.filter(([key]) => !ticks.value[key]).length;
  const doorOpen = now.value!.machine.door === 'open';
  return (
    <section class="block">
      <h3>Before printing</h3>
      <Known />
      <ul class="checklist">
        {items.map(([key, text]) => (
          <li key={key}>
            <label class={key === old ? 'old-job' : ''} data-testid={`check-${key === old ? 'old' : key}`}>
              <input type="checkbox" checked={ticks.value[key] ?? false} disabled={!maySteer.value} onChange={(e) => (ticks.value = { ...ticks.value, [key]: e.currentTarget.checked })} />
              <span>{text}</span>
            </label>
          </li>
        ))}
      </ul>
      <button class="primary wide-button" data-testid="start" disabled={open > 0 || !maySteer.value || !flags.value.ready || doorOpen} onClick={() => void host('job', { command: 'start' }).then((begun) => begun && (ticks.value = {}))}>
        {doorOpen ? 'Close the door first' : open > 0 ? `Confirm ${counted(open, 'item')}` : 'Start the print'}
      </button>
    </section>
  );
}

/// An interrupted print of this job: the journal holds its progress.
function GoOn() {
  const [lit, setLit] = useState('');
  const [untouched, setUntouched] = useState(false);
  const [sure, setSure] = useState(false);
  const may = maySteer.value && !flags.value.working;
  const twin = info.value!.twin;
  return (
    <section class="block interrupted" data-testid="interrupted">
      <h3>A print of this job was interrupted</h3>
      <p>
        Its journal records which exposures are complete.
        {twin ? ' The virtual printer stands where it stood then, with its part; the print continues there.' : ' The platform is raised, the axes are homed, and the print continues where it stopped.'}
      </p>
      <div class="row left wrap">
        <button
          class="primary"
          data-testid="go-on"
          disabled={!may}
          onClick={() =>
            host('job', {
              command: 'start',
              resume: true,
              ...(lit === '' ? {} : { assumeLit: Number(lit) }),
              ...(untouched ? { assumeVatsUntouched: true } : {}),
            })
          }
        >
          <Icon name="play" /> Resume
        </button>
        {sure ? (
          <>
            <button class="danger" data-testid="put-away-sure" disabled={!may} onClick={() => void (twin ? post('/api/print/discard') : host('job', { command: 'cancel' }))}>
              Discard print
            </button>
            <button onClick={() => setSure(false)}>Keep it</button>
          </>
        ) : (
          flags.value.ready || twin ? (
            <button disabled={!may} data-testid="put-away" onClick={() => setSure(true)}>
              Discard
            </button>
          ) : (
            <button disabled={!may || flags.value.error} onClick={() => host('connection', { command: 'connect' })} title="Connect without resuming, to discard the print or to inspect the machine first">
              Connect only
            </button>
          )
        )}
      </div>
      <details>
        <summary>If the journal is incomplete</summary>
        <label class="field-row">
          <span>Duration of the interrupted exposure</span>
          <span class="number">
            <input type="number" min={0} step="any" value={lit} onInput={(e) => setLit(e.currentTarget.value)} />
            <span class="unit">s</span>
          </span>
        </label>
        <label class="tick">
          <input type="checkbox" checked={untouched} onChange={(e) => setUntouched(e.currentTarget.checked)} />
          <span>another program has used the controller since, but moved no vat</span>
        </label>
      </details>
    </section>
  );
}

/// Exposure of each material from the next layer on, and layers to skip.
function Light() {
  const n = now.value!;
  const i = info.value!;
  const [skip, setSkip] = useState('');
  if (!flags.value.printing && !flags.value.paused) return null;
  return (
    <details class="block fold" data-testid="light">
      <summary>Adjust exposure</summary>
      {i.materials.map(({ name, colour, exposure_s }, m) => (
        <label class="field-row" key={name}>
          <span>
            <span class="swatch" style={{ background: colour }} />
            {name}
            {n.progress.exposures[m] > 0 && <span class="quiet"> changed</span>}
          </span>
          <NumberField
            value={n.progress.exposures[m] || exposure_s}
            range={{ from: 0, to: Infinity, open: true }}
            unit="s"
            disabled={!maySteer.value}
            onValue={(seconds) => host('job/exposure', { material: m, seconds })}
          />
        </label>
      ))}
      <form
        class="field-row"
        onSubmit={(e) => {
          e.preventDefault();
          void host('job/skip', { layer: Number(skip) - 1 }).then((done) => done && setSkip(''));
        }}
      >
        <span>Skip layer</span>
        <span class="number">
          <input type="number" aria-label="Layer to skip" min={(n.progress.layer ?? 0) + 2} max={n.job.layers} step={1} value={skip} onInput={(e) => setSkip(e.currentTarget.value)} />
          <button class="small" disabled={!skip || !maySteer.value}>
            Skip
          </button>
        </span>
      </form>
    </details>
  );
}

const lostText =
  'so the state of the machine is unknown. A print continues without this page as long as the studio runs; if the studio has ended, the light is off and the machine stands still. To stop the machine now, use its own switch.';

const refillOf = (prompt: string | null) => info.value!.refills.find((r) => r.text === prompt);

/// Why a paused print waits, and what the user must do.
function Waiting() {
  const n = now.value!;
  const prompt = n.progress.prompt;
  const open = n.machine.door === 'open';
  const refill = refillOf(prompt);
  const vat = refill && info.value!.machine!.vats.find((v) => v.slot === refill.slot);
  const [title, text] = open
    ? ['The door is open', 'The light, the pump and the fans are off, nothing moves. Close the door; then the print can be resumed.']
    : refill
      ? ['Resin is needed', `Fill the vat of slot ${refill.slot} with ${vat?.resin ?? 'its resin'}${vat ? `, up to ${Math.round(vat.fill_ml)} ml` : ''}. Nothing moves meanwhile.`]
      : prompt?.startsWith('the door')
        ? ['The door is closed again', 'The interrupted exposure is completed when you resume.']
        : prompt
          ? ['The print is waiting for you', prompt]
          : ['Paused', 'The part hangs clear of the vat. Nothing moves until you resume.'];
  return (
    <div class={`prompt ${open ? 'bad' : ''}`} role="alert" data-testid="prompt">
      <Icon name={open || prompt ? 'warn' : 'pause'} />
      <span>
        <b>{title}</b>
        {text}
        {open && !info.value!.twin && ' Do not rely on the switch for safety: an open door should also cut the power of lamp and motors.'}
      </span>
    </div>
  );
}

function Steering() {
  const n = now.value!;
  const f = flags.value;
  const [sure, setSure] = useState(false);
  useEffect(() => {
    if (!busy.value) setSure(false);
  }, [busy.value]);
  const connectable = f.error || (f.closedOrError && !n.job.canResume && n.state.text === 'Offline');
  if (!busy.value && !connectable) return null;
  return (
    <section class="block steering">
      {f.paused && known.value && <Waiting />}
      <div class="row left">
        {(f.printing || f.pausing) && (
          <button data-testid="pause" disabled={!maySteer.value || f.pausing} onClick={() => host('job', { command: 'pause', action: 'pause' })}>
            <Icon name="pause" /> {f.pausing ? 'pausing…' : 'Pause'}
          </button>
        )}
        {f.paused && (
          <button class="primary" data-testid="resume" disabled={!maySteer.value || n.machine.door === 'open'} onClick={() => host('job', { command: 'resume' })}>
            <Icon name="play" /> {refillOf(n.progress.prompt) ? 'Filled, resume' : 'Resume'}
          </button>
        )}
        {busy.value && !sure && (
          <button data-testid="cancel" disabled={!maySteer.value || f.cancelling} onClick={() => setSure(true)}>
            <Icon name="stop" /> {f.cancelling ? 'parking…' : 'Cancel'}
          </button>
        )}
        {connectable && (
          <button class="primary" disabled={!maySteer.value} data-testid="connect" onClick={() => host('connection', { command: 'connect' })}>
            Reconnect
          </button>
        )}
      </div>
      {busy.value && sure && (
        <div class="row left wrap">
          <button
            class="danger"
            data-testid="cancel-sure"
            disabled={!maySteer.value}
            onClick={() => {
              setSure(false);
              void host('job', { command: 'cancel' });
            }}
          >
            Cancel print
          </button>
          <button onClick={() => setSure(false)}>Keep printing</button>
        </div>
      )}
      {f.printing && <p class="quiet small-print">The print continues when this page is closed. Keep the studio running and its computer awake.</p>}
    </section>
  );
}

/// The cured block beside the drawing; a click enlarges it.
function VerdictPicture() {
  const [failed, setFailed] = useState(false);
  if (failed) return null;
  const address = `/api/print/verdict/picture?taken=${info.value!.taken}&at=${now.value!.progress.begun ?? 0}`;
  return (
    <button class="verdict-picture" data-testid="verdict-picture" aria-label="Enlarge the picture of the drawing and the cured block" onClick={() => (enlarged.value = { address, title: 'Drawing and cured block' })}>
      <img src={address} alt="Drawing and cured block" onError={() => setFailed(true)} />
    </button>
  );
}

/// The verdict on the print, if known.
function Verdict() {
  if (!known.value || busy.value || !now.value!.progress.finished) return null;
  if (!info.value!.twin) return <p class="quiet">Everything was exposed as planned. Inspect the part to see whether it cured.</p>;
  if (!verdict.value) return <p class="quiet">The cured block is compared with the drawing…</p>;
  const { passed, reasons } = verdict.value;
  return (
    <>
    <p class={`verdict ${passed ? 'good' : 'bad'}`} data-testid="verdict" data-passed={passed}>
      <Icon name={passed ? 'check' : 'warn'} />
      {passed ? 'As drawn: every pixel of the cured block matches its image.' : 'Not as drawn: see the report for where and how.'}
    </p>
    {!passed && reasons.length > 0 && (
      <ul class="reasons" data-testid="reasons">
        {reasons.slice(0, 5).map((r) => (
          <li>{r}</li>
        ))}
      </ul>
    )}
    <VerdictPicture />
    </>
  );
}

/// The last print was cancelled for good.
const wasCancelled = () => known.value && isCancelled(now.value!);

function Headline() {
  const n = now.value!;
  const stop = known.value ? stopOf() : null;
  const printed = n.progress.finished && !busy.value;
  const cancelled = !stop && wasCancelled();
  return (
    <>
      <div class="row">
        <b class="state" data-testid="print-state">
          {!known.value ? 'Unknown' : stop ? stop.title : printed ? 'Printed' : cancelled ? `Cancelled at layer ${n.progress.layer! + 1} of ${n.job.layers}` : n.state.text}
        </b>
        <span class="quiet">{n.job.file.name}</span>
      </div>
      {!known.value && <p class="quiet">last known state: {n.state.text}</p>}
      {stop ? (
        <p class="problems" data-testid="stopped">
          {stop.text} {stop.cause && <span class="quiet">({stop.cause})</span>}
        </p>
      ) : (
        known.value && n.state.message && <p class={n.progress.failed || flags.value.error ? 'problems' : 'quiet'}>{n.state.message}</p>
      )}
      {cancelled && <p data-testid="cancelled">Remove the part from the platform.</p>}
      <Verdict />
    </>
  );
}

function Progress() {
  const n = now.value!;
  const p = n.progress;
  const done = p.completion ?? 0;
  const told = (text: string | number) => (known.value ? text : '–');
  return (
    <section class="block">
      <Headline />
      <div
        class={`progress tall ${known.value ? '' : 'old'}`}
        role="progressbar"
        aria-label="Progress of the print"
        aria-valuenow={known.value ? Math.round(done) : undefined}
        aria-valuemin={0}
        aria-valuemax={100}
      >
        <div style={{ width: `${done}%` }} />
      </div>
      <div class="figures small-figures">
        <div>
          <b data-testid="print-layer">{told(p.layer === null ? '–' : p.layer + 1)}</b>
          <span>of {counted(n.job.layers, 'layer')}</span>
        </div>
        <div>
          <b data-testid="time-left">{told(wasCancelled() ? '–' : clock(p.printTimeLeft ?? 0))}</b>
          <span>left</span>
        </div>
        <div>
          <b>{told(clock(p.printTime ?? 0))}</b>
          <span>elapsed</span>
        </div>
        <div>
          <b>{told(n.machine.slot || '–')}</b>
          <span>slot in use</span>
        </div>
      </div>
    </section>
  );
}

function Picture() {
  const p = now.value!.progress;
  const i = info.value!;
  const begun = p.layer !== null && p.material !== null;
  const lit = p.lit && known.value;
  const name = begun ? i.materials[p.material!]?.name : '';
  const address = `/api/print/image/${p.layer}/${p.material}?taken=${i.taken}`;
  return (
    <figure class={`picture ${lit ? 'lit' : ''}`}>
      {begun ? (
        <button class="enlarge" aria-label={`Enlarge the image of layer ${p.layer! + 1}, ${name}`} data-testid="enlarge-light" onClick={() => (enlarged.value = { address, title: `Layer ${p.layer! + 1}, ${name}`, pixels: true })}>
          <img alt={`Layer ${p.layer! + 1}, ${name}`} src={address} />
        </button>
      ) : (
        <div class="dark">no exposure yet</div>
      )}
      <figcaption>
        {name}
        <span>{!known.value ? 'light unknown' : lit ? `exposure ${p.litTime.toFixed(1)} of ${p.exposureTime.toFixed(1)} s` : 'dark'}</span>
      </figcaption>
    </figure>
  );
}

/// Caption: what the 3D view shows of the part.
function PartCaption() {
  const p = part.value;
  if (!p || p.slabs.length === 0) return null;
  const runs = p.slabs.reduce((sum, slab) => sum + slab.runs.length / 3, 0);
  return (
    <p class="part-caption" data-testid="part" data-runs={runs} data-height={p.height}>
      <b>{p.height.toFixed(2)} mm</b> {p.kind === 'cured' ? 'cured in the virtual printer' : 'exposed; whether it cured is unknown'}
    </p>
  );
}

function Machine3D() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const shown = useRef<MachineView | null>(null);
  const names = useRef<HTMLDivElement>(null);
  const [near, setNear] = useState(false);
  const i = info.value!;
  useEffect(() => {
    if (!i.machine) return;
    const colours: Record<string, string> = {};
    for (const m of i.materials) colours[m.resin] ??= m.colour;
    let view: MachineView;
    try {
      view = new MachineView(canvas.current!, i.machine, colours, i.materials.map((m) => m.colour), names.current!);
    } catch {
      return; // no WebGL: the print can be controlled without the picture
    }
    shown.current = view;
    const stops = [followPart(), part.subscribe((p) => view.showPart(p)), now.subscribe((n) => n && view.show(n))];
    view.lookAt(near);
    return () => {
      for (const stop of stops) stop();
      shown.current = null;
      view.dispose();
    };
  }, [i.machine, theme.value]);
  return (
    <>
      <div class="machine-view">
        <canvas ref={canvas} tabIndex={0} aria-label={`The machine in 3D. ${orbitHelp}`} data-testid="machine-view" />
        <div class="names" ref={names} aria-hidden="true" />
      </div>
      <span class="segments view-of" role="group" aria-label="3D view of">
        {([[false, 'Machine'], [true, 'Part']] as const).map(([only, name]) => (
          <button
            aria-pressed={near === only}
            data-testid={`view-${name.toLowerCase()}`}
            onClick={() => {
              setNear(only);
              shown.current?.lookAt(only);
            }}
          >
            {name}
          </button>
        ))}
      </span>
      <PartCaption />
    </>
  );
}

export function ByHand() {
  const m = info.value!.machine!;
  const n = now.value!;
  const ready = flags.value.ready && maySteer.value;
  const [step, setStep] = useState(5);
  return (
    <section class="block">
      <h3>Manual control</h3>
      <div class="axes">
        {Object.keys(m.axes).map((axis) => (
          <div class="axis" key={axis}>
            <span>
              {axis}
              {!n.machine.axes[axis]?.homed && <em> not homed</em>}
            </span>
            <output>{(n.machine.axes[axis]?.position ?? 0).toFixed(2)}</output>
            <button class="bare" aria-label={`Move ${axis} by −${step}`} disabled={!ready} onClick={() => host('printer/axes', { command: 'jog', [axis]: -step })}>
              <Icon name="left" />
            </button>
            <button class="bare" aria-label={`Move ${axis} by +${step}`} disabled={!ready} onClick={() => host('printer/axes', { command: 'jog', [axis]: step })}>
              <Icon name="right" />
            </button>
          </div>
        ))}
      </div>
      <div class="row left wrap">
        <span class="segments" role="group" aria-label="Step">
          {[0.1, 1, 5, 20].map((s) => (
            <button aria-pressed={step === s} onClick={() => setStep(s)}>
              {s} mm
            </button>
          ))}
        </span>
        <button class="small" disabled={!ready} data-testid="home" onClick={() => host('printer/axes', { command: 'home' })}>
          Home all
        </button>
        <button class="small" disabled={!ready} onClick={() => host('printer/clean', { seconds: 15 })}>
          Clean 15 s
        </button>
        <button class="small" disabled={!ready} onClick={() => host('printer/prime', { seconds: 10 })}>
          Prime the pump
        </button>
      </div>
      <div class="row left wrap">
        {m.vats.map((v) => (
          <button class="small" disabled={!ready || n.machine.slot === v.slot} onClick={() => host('printer/vat', { slot: v.slot })} title={v.resin}>
            Vat {v.slot}
          </button>
        ))}
        <button class="small" disabled={!ready || n.machine.slot === 0} onClick={() => host('printer/vat', { slot: 0 })}>
          Return the vat
        </button>
      </div>
    </section>
  );
}

function Log() {
  const list = useRef<HTMLOListElement>(null);
  const atEnd = useRef(true); // do not scroll if the user has scrolled up
  const top = useRef(0);
  const shown = events.value.filter((e) => e.kind !== 'dark').slice(-120);
  const begun = now.value!.progress.begun;
  // Counted like the elapsed time: from the start of the print.
  const at = (e: { clock: number }) => (begun === null || e.clock < begun - 0.5 ? '' : clock(Math.max(0, e.clock - begun)));
  const last = shown[shown.length - 1]?.number;
  useEffect(() => {
    if (list.current && atEnd.current) list.current.scrollTop = list.current.scrollHeight;
  }, [last]);
  return (
    <section class="block">
      <h3>Log</h3>
      <ol
        class="log"
        ref={list}
        tabIndex={0}
        aria-label="Log of the print"
        data-testid="log"
        onScroll={(e) => {
          const { scrollTop, scrollHeight, clientHeight } = e.currentTarget;
          if (scrollHeight - scrollTop - clientHeight < 30) atEnd.current = true;
          else if (scrollTop < top.current - 2) atEnd.current = false;
          top.current = scrollTop;
        }}
      >
        {shown.map((e) => (
          <li class={e.kind} key={e.number}>
            <time>{at(e)}</time>
            <span>{e.kind === 'layer' ? `layer ${e.text}` : e.text}</span>
          </li>
        ))}
      </ol>
    </section>
  );
}

export function Print() {
  const i = info.value;
  if (wizard.value)
    return (
      <main class="page">
        <Wizard />
      </main>
    );
  if (!i?.machine || !now.value)
    return (
      <main class="page">
        <TakeMachine />
      </main>
    );
  return (
    <main class="print">
      <h2 class="unseen">Print</h2>
      <div class="watch">
        <Machine3D />
        <Picture />
        <Webcam />
      </div>
      <div class="steer">
        <div class="row machine-name">
          <b>{i.machine.name}</b>
          <span class="quiet">{i.twin ? 'virtual printer' : i.device}</span>
        </div>
        {!known.value && <Lost text={lostText} />}
        <Progress />
        <Steering />
        {!busy.value && (now.value.job.canResume ? <GoOn /> : <Checklist />)}
        <Light />
        <Safety />
        <section class="block row wrap">
          {i.twin && (
            <span class="segments" role="group" aria-label="Speed of the virtual printer">
              {speeds.map((s) => (
                <button
                  aria-pressed={i.speed === s}
                  disabled={!maySteer.value}
                  onClick={async () => {
                    if (await post('/api/print/speed', { speed: s })) info.value = { ...i, speed: s };
                  }}
                >
                  {s}×
                </button>
              ))}
            </span>
          )}
          <Notifications />
          <a class="button small" href="/api/print/report" download data-testid="print-report">
            <Icon name="download" /> Report
          </a>
          {!busy.value && (
            <button class="small" disabled={!maySteer.value} data-testid="leave" onClick={() => post('/api/print/leave')}>
              Disconnect
            </button>
          )}
        </section>
        <NextInQueue />
        {!busy.value && !now.value.job.canResume && <ByHand />}
        <Log />
        <p class="quiet">
          {now.value.machine.firmware} · {counted(now.value.machine.linesSent, 'line')} sent · {now.value.machine.resends} resent
        </p>
      </div>
    </main>
  );
}
