// The interactive robot: 3D view, actuators, plots, file.
import { computed, effect, signal } from '@preact/signals';
import { useEffect, useRef, useState } from 'preact/hooks';
import { counted } from '../counted';
import { useDismiss } from '../dismiss';
import { Icon } from '../icons';
import { Lost } from '../lost';
import { orbitHelp, orbitKeys } from '../orbit_keys';
import {
  building,
  following,
  frame,
  frameRate,
  latency,
  lines,
  mayDrive,
  online,
  post,
  problems,
  isRough,
  rough,
  say,
  scene,
  send,
  sendInput,
  wanted,
  wantedTime,
  wantFields,
  documentState,
  restValue,
  toRest as askForRest,
} from '../store';
import type { Accuracy } from '../types';
import { Actuators } from './actuators';
import { CanvasBeside, Compare, Compared, comparing, ranges, tellRange } from './beside';
import { Build, draft, placed, takePlace } from './build';
import { Editor, Materials, pinNow, text, theirs } from './editor';
import { film, filming, gif, stopFilming } from './film';
import { FirstPicture } from './first_picture';
import { Goal, path } from './goal';
import { Identify } from './identify';
import { Plots } from './plots';
import { asProgram, insertKeys, recorded, recording, startRecording, stopRecording } from './recorder';
import { clearTracks, frames, tracksCsv, tracksVersion } from './tracks';
import { Legend } from './legend';
import { linkText, restoreLink } from './link';
import { MotionNotes, MotionTrack, RunMotion, motion } from './motion';
import { saveBlob as save } from './save';
import { Measure, presetKey, ScaleBar, SectionHandle, takePick, ViewCube, ViewMenu } from './stage_tools';
import { Sweep } from './sweep';
import { drawn, theView } from './the_view';
import { hasProgramKeys } from './toml_edit';
import { RobotView } from './view';
import * as look from './view_state';
import { reach, Workspace } from './workspace';

const panel = signal<'move' | 'build' | 'plots' | 'file' | 'goal' | 'workspace' | 'identify' | 'sweep'>('move');

function options() {
  const fixed = look.fixedRange.value;
  return {
    field: look.field.value,
    scale: look.fieldNames.find((f) => f.name === look.field.value)!.scale,
    wireframe: look.wireframe.value,
    ghost: look.ghost.value,
    inside: look.showInside.value,
    exploded: look.exploded.value,
    sectionAxis: look.sectionAxis.value,
    sectionAt: look.sectionAt.value,
    sectionFlipped: look.sectionFlipped.value,
    map: look.map.value,
    bands: look.bands.value,
    range: fixed && fixed.field === look.field.value ? ([fixed.low, fixed.high] as [number, number]) : rangeOfBoth(),
    pinned: look.pinned.value?.positions ?? null,
    beside: look.beside.value,
  };
}

/// A common range, so that a colour means the same value in both robots; null if there is only one.
function rangeOfBoth(): [number, number] | null {
  const [a, b] = ranges.value;
  return comparing.value && a && b ? [Math.min(a[0], b[0]), Math.max(a[1], b[1])] : null;
}

function Canvas() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const labels = useRef<HTMLDivElement>(null);
  useEffect(() => {
    let made: RobotView;
    try {
      made = theView.value = new RobotView(canvas.current!);
    } catch {
      say('This browser has no WebGL, so the robot cannot be drawn.');
      return;
    }
    let pending = 0;
    let last: Record<string, unknown> | null = null;
    made.pointer.mayGrab = () => mayDrive.value && look.shownFrame.value === null;
    made.pointer.onGrab = (grab) => {
      if (!grab) {
        last = null;
        return send({ type: 'release' });
      }
      const marker = scene.value?.head.markers[grab.marker]?.name;
      last = marker === undefined ? { type: 'pull', vertex: grab.vertex, to: grab.to } : { type: 'lead', marker, to: grab.to };
      pending ||= requestAnimationFrame(() => {
        pending = 0;
        if (last) sendInput(last);
      });
    };
    made.onData = (low, high) => comparing.peek() && tellRange(0, low, high);
    made.onRange = (low, high) => (look.fieldRange.value = [low, high]);
    made.pointer.onPick = (pick, rest, inward) => {
      if (look.measuring.peek()) return takePick(pick), true;
      return takePlace(rest, inward);
    };
    made.onDraw = (project, camera) => {
      drawn(project, camera);
      const shown = look.shownFrame.value ?? frame.value;
      const children = labels.current?.children ?? [];
      shown?.head.markers.forEach((p, k) => {
        const [x, y] = project(p);
        const label = children[k] as HTMLElement | undefined;
        if (label) label.style.transform = `translate(${x + 9}px, ${y - 10}px)`;
      });
    };
    const stops = [
      effect(() => {
        if (!scene.value) return;
        made.setScene(scene.value);
        // The order of the two effects is undefined: a frame before its scene would be lost.
        const shown = look.shownFrame.peek() ?? frame.peek();
        if (shown) made.setFrame(shown);
        void restoreLink();
      }),
      effect(() => made.setOptions(options())),
      effect(() => made.setPicks(look.picks.value)),
      effect(() => made.setDraft(draft.value)),
      effect(() => made.setReach(panel.value === 'workspace' ? reach.value : null)),
      effect(() => made.setPath(panel.value === 'goal' ? path.value : panel.value === 'build' ? placed.value : [])),
      effect(() => {
        const shown = look.shownFrame.value ?? frame.value;
        if (shown) made.setFrame(shown);
      }),
      effect(() => {
        const f = look.field.value;
        wantFields(f === 'material' || f === 'displacement' ? [] : [f]);
      }),
    ];
    return () => {
      for (const stop of stops) stop();
      made.dispose();
      theView.value = null;
    };
  }, []);
  const keys = (e: KeyboardEvent) => {
    if (presetKey(e.key)) return e.preventDefault();
    orbitKeys(e, (around, up, nearer) => theView.value?.turn(around, up, nearer), () => theView.value?.lookAt());
  };
  return (
    <div class="canvas">
      <canvas
        ref={canvas}
        tabIndex={0}
        role="application"
        aria-label={`The robot in 3D. ${orbitHelp} Keys 0 to 6 select a standard view.`}
        onKeyDown={keys}
        data-testid="view"
      />
      <div class="labels" ref={labels} aria-hidden="true">
        {scene.value?.head.markers.map((m) => <span key={m.name}>{m.name}</span>)}
      </div>
    </div>
  );
}

function Toggle({ on, label }: { on: typeof look.ghost; label: string }) {
  return (
    <button class="chip" aria-pressed={on.value} onClick={() => (on.value = !on.value)}>
      {label}
    </button>
  );
}

function LookBar() {
  const [more, setMore] = useState(false);
  return (
    <div class="lookbar">
      <select class="chip" aria-label="Colour by" data-testid="field" value={look.field.value} onChange={(e) => (look.field.value = e.currentTarget.value as look.FieldName)}>
        {look.fieldNames.map((f) => (
          <option value={f.name} key={f.name}>
            {f.label}
          </option>
        ))}
      </select>
      <Toggle on={look.wireframe} label="Mesh" />
      <Toggle on={look.ghost} label="Rest shape" />
      <Toggle on={look.showInside} label="Transparent" />
      <button class="chip" aria-pressed={more || look.sectionAxis.value !== ''} aria-expanded={more} onClick={() => setMore(!more)}>
        Section
      </button>
      <ViewMenu />
      <button
        class="chip"
        aria-pressed={look.measuring.value}
        data-testid="measure-toggle"
        onClick={() => {
          look.measuring.value = !look.measuring.value;
          look.picks.value = [];
        }}
      >
        Measure
      </button>
      {more && (
        <div class="popover">
          <div class="segments" role="group" aria-label="Section plane">
            {(['', 'x', 'y', 'z'] as const).map((a) => (
              <button aria-pressed={look.sectionAxis.value === a} onClick={() => (look.sectionAxis.value = a)}>
                {a || 'off'}
              </button>
            ))}
          </div>
          <button class="small" aria-pressed={look.sectionFlipped.value} disabled={!look.sectionAxis.value} onClick={() => (look.sectionFlipped.value = !look.sectionFlipped.value)}>
            Flip
          </button>
          <label>
            Cut at
            <input type="range" min={0} max={1} step={0.002} value={look.sectionAt.value} disabled={!look.sectionAxis.value} style={{ '--at': `${100 * look.sectionAt.value}%` }} onInput={(e) => (look.sectionAt.value = Number(e.currentTarget.value))} />
          </label>
          <label>
            Explode
            <input type="range" min={0} max={1} step={0.01} value={look.exploded.value} style={{ '--at': `${100 * look.exploded.value}%` }} onInput={(e) => (look.exploded.value = Number(e.currentTarget.value))} />
          </label>
        </div>
      )}
    </div>
  );
}

function follow(time: number) {
  following.value = true;
  look.shownFrame.value = null;
  wantedTime.value = time;
  sendInput({ type: 'follow', time });
}

function toRest() {
  const head = scene.value?.head;
  if (!head) return;
  following.value = true;
  wantedTime.value = 0;
  look.shownFrame.value = null;
  wanted.value = Object.fromEntries(head.actuators.map((a) => [a.name, { kind: a.kind, value: restValue(a.kind) }]));
  askForRest();
  clearTracks();
}

const inSeconds = computed(() => (scene.value?.head.program.timed ?? false) || hasProgramKeys(theirs.value));

function Timeline() {
  tracksVersion.value;
  const head = scene.value?.head;
  const playing = frame.value?.head.playing ?? false;
  if (!head) return null;
  const duration = head.program.duration;
  const time = playing ? (frame.value?.head.time ?? 0) : wantedTime.value;
  const shown = look.shownFrame.value ? frames.indexOf(look.shownFrame.value) : frames.length - 1;
  const program = recorded.value.length > 1 && !recording.value;
  return (
    <div class="timeline">
      <button class="round" disabled={!mayDrive.value} aria-label={playing ? 'Pause the program' : 'Play the program'} data-testid="play" onClick={() => {
        following.value = true;
        look.shownFrame.value = null;
        send({ type: 'play', on: !playing });
      }}>
        <Icon name={playing ? 'pause' : 'play'} />
      </button>
      <label class="track">
        <span>Program</span>
        <input type="range" data-testid="program" min={0} max={duration} step={duration / 1000} value={time} disabled={!mayDrive.value} style={{ '--at': `${(100 * time) / duration}%` }} class={following.value ? '' : 'idle'} onInput={(e) => follow(Number(e.currentTarget.value))} />
        <output>{duration === 1 && !inSeconds.value ? `${Math.round(100 * time)} %` : `${time.toFixed(2)} s`}</output>
      </label>
      {motion.value ? (
        <MotionTrack />
      ) : (
      <label class="track">
        <span>Replay</span>
        <input type="range" data-testid="replay" min={0} max={Math.max(frames.length - 1, 1)} step={1} value={shown} style={{ '--at': `${(100 * shown) / Math.max(frames.length - 1, 1)}%` }} onInput={(e) => {
          const k = Number(e.currentTarget.value);
          look.shownFrame.value = k >= frames.length - 1 ? null : frames[k];
        }} />
        <output data-testid="replay-at">{look.shownFrame.value ? `${shown + 1} of ${frames.length}` : online.value ? 'live' : 'last'}</output>
      </label>
      )}
      <RunMotion />
      <button class="round" disabled={!mayDrive.value} aria-label="Back to rest" title="Back to rest" data-testid="rest" onClick={toRest}>
        <Icon name="rest" />
      </button>
      <button class={`round record ${recording.value ? 'on' : ''}`} aria-label={recording.value ? 'Stop recording' : 'Record a program'} title="Record a program" aria-pressed={recording.value} onClick={() => (recording.value ? stopRecording() : startRecording())}>
        <Icon name={recording.value ? 'stop' : 'record'} />
      </button>
      {program && (
        <button class="small" onClick={() => {
          const keys = asProgram();
          if (!keys) return;
          panel.value = 'file';
          void insertKeys(text.value, keys).then((done) => done && (recorded.value = []));
        }}>
          Insert {counted(recorded.value.length, 'sample')} as program
        </button>
      )}
      <MotionNotes />
    </div>
  );
}

function Export() {
  const [open, setOpen] = useState(false);
  const box = useRef<HTMLDivElement>(null);
  useDismiss(open, () => setOpen(false), box);
  const head = scene.value?.head;
  if (!head) return null;
  const items: [string, string, () => void][] = [
    ['Image', 'PNG', () => void theView.value?.png().then((b) => b && save(b, 'robot.png'))],
    ['Picture for print, 3840 pixels wide', 'PNG', () => void theView.value?.png(3840).then((b) => b && save(b, 'robot_print.png'))],
    ['Video of the states since rest', 'WebM', () => void film().then((b) => (b ? save(b, 'robot.webm') : say('There is no motion to record yet: move the robot first.')))],
    ['Video for slides and chats, 640 pixels wide', 'GIF', () => void gif().then((b) => (b ? save(b, 'robot.gif') : say('There is no motion to record yet: move the robot first.')))],
    ['Link to this state', 'copy', () => void navigator.clipboard.writeText(linkText()).then(() => say('Link copied to the clipboard.'), () => say(linkText()))],
    ['Plot data', 'CSV', () => save(new Blob([tracksCsv()], { type: 'text/csv' }), 'plots.csv')],
    ['Force history', 'CSV', () => (location.href = '/api/export/steps.csv')],
    ['Marker history', 'CSV', () => (location.href = '/api/export/markers.csv')],
    ['Animation', 'GLB', () => (location.href = '/api/export/robot.glb')],
    ['Current state with fields', 'VTU', () => (location.href = '/api/export/robot.vtu')],
  ];
  return (
    <div class="menu" ref={box}>
      {filming.value === null ? (
        <button class="chip" aria-expanded={open} onClick={() => setOpen(!open)}>
          <Icon name="download" /> Export
        </button>
      ) : (
        <button class="chip" onClick={stopFilming} data-testid="stop-filming">
          Rendering video, {Math.round(100 * filming.value)} %: cancel
        </button>
      )}
      {open && (
        <div class="popover right" onClick={() => setOpen(false)}>
          {items.map(([label, kind, go]) => (
            <button class="item" onClick={go}>
              <span>{label}</span>
              <span class="quiet">{kind}</span>
            </button>
          ))}
        </div>
      )}
    </div>
  );
}

const setAccuracy = (accuracy: Accuracy) => void post('/api/accuracy', { accuracy });

/// A hint on the accuracy of linear elements: too stiff in bending, especially with few elements through a wall. If the
/// robot is refined automatically as soon as the input rests, the mark at its numbers is enough.
function Rough() {
  const accuracy = scene.value?.head.accuracy;
  if (accuracy === 'automatic' && scene.value?.head.order === 2) return null;
  return (
    <span class="rough" data-testid="rough">
      Linear elements are too stiff: forces can be 1.3 to 3 times too large, displacements too small.{' '}
      {accuracy !== 'preview' ? (
        <>
          The file asks for them: <code>mesh.order = 1</code>.
        </>
      ) : (
        <button class="small" disabled={!mayDrive.value} onClick={() => setAccuracy('automatic')} data-testid="refine">
          Refine
        </button>
      )}
    </span>
  );
}

/// A length of which only the size matters: 0.03 mm.
const millimetres = (mm: number) => `${mm < 0.01 ? 0.01 : +mm.toPrecision(1)} mm`;

function Status() {
  const head = frame.value?.head;
  const s = scene.value?.head;
  if (building.value)
    return (
      <div class="status" role="status" data-testid="status" data-state="building">
        <span class="pulse" /> building: {building.value.stage}
      </div>
    );
  if (!head || !s) return <div class="status" data-testid="status" data-state="none" />;
  if (!online.value)
    return (
      <div class="status" role="status" data-testid="status" data-state="unknown" data-lamp="unknown">
        <span class="lamp unknown" /> last known state
      </div>
    );
  const led = head.lead?.settled ?? false;
  const state = look.shownFrame.value ? 'replay' : head.stuck ? 'stuck' : head.arrived ? 'arrived' : head.refining ? 'refining' : led ? 'led' : 'solving';
  const warning = head.warnings.join('. ');
  const near = head.reduced_error_mm === undefined ? '≈ linear preview' : `≈ within ${millimetres(head.reduced_error_mm)}`;
  const words = {
    replay: 'replay',
    stuck: 'did not converge',
    arrived: rough.value ? '≈ linear preview' : 'at equilibrium',
    led: rough.value ? '≈ linear preview' : 'at equilibrium',
    refining: `${near}, computing the quadratic answer…`,
    solving: head.reduced_error_mm !== undefined ? near : rough.value ? '≈ Solving…' : 'Solving…',
  }[state];
  const settled = state === 'arrived' || state === 'led';
  const lamp = settled ? (warning || rough.value ? 'warn' : 'good') : state === 'stuck' ? 'bad' : 'busy';
  return (
    <div class="status" role="status" data-testid="status" data-state={state} data-lamp={lamp} title={head.stuck || warning}>
      <span class={state === 'refining' ? 'pulse' : `lamp ${lamp}`} /> {words}
      {state === 'stuck' && <span data-testid="stuck-why">: {head.stuck}</span>}
      {warning && <span data-testid="state-warning">: {warning}</span>}
      <span class="quiet">
        residual {head.residual.toExponential(0)} · {s.tets.toLocaleString('en')} tets · {head.solve_ms.toFixed(0)} ms
        <span class="wide">
          {/* a rate is one while the robot moves: a single frame of a second says nothing */}
          {frameRate.value >= 5 && ` · ${frameRate.value} frames/s`}
          {latency.value > 0 && ` · ${latency.value.toFixed(0)} ms latency`}
        </span>
      </span>
      {rough.value && <Rough />}
    </div>
  );
}

function Readings() {
  const at = look.shownFrame.value ?? frame.value;
  const shown = at?.head;
  const head = scene.value?.head;
  if (!shown || !head) return null;
  const mark = isRough(at) && '≈ ';
  const pull = shown.pull;
  return (
    <table class="readings">
      <tbody>
        {head.markers.map((m, k) => (
          <tr key={m.name} data-testid={`marker-${m.name}`}>
            <th>
              {mark}
              {m.name}
            </th>
            {(shown.markers[k] ?? []).map((v) => (
              <td>{v.toFixed(2)}</td>
            ))}
            <td class="unit">mm</td>
          </tr>
        ))}
        {look.pinned.value?.frame.head.markers.map((p, k) => (
          <tr class="pinned-row" key={`pin${k}`}>
            <th>{head.markers[k]?.name} pinned</th>
            {p.map((v) => (
              <td>{v.toFixed(2)}</td>
            ))}
            <td class="unit">mm</td>
          </tr>
        ))}
        {shown.lead && (
          <tr data-testid="lead">
            <th>{mark}distance to the target</th>
            <td colSpan={3}>{shown.lead.error_mm.toFixed(2)}</td>
            <td class="unit">mm</td>
          </tr>
        )}
        {shown.lead?.settled && !shown.lead.reached && (
          <tr class="limits" data-testid="lead-limits">
            <td colSpan={5}>
              Out of reach, this is the nearest point:{' '}
              {shown.lead.limits.join('; ') || 'the actuators move it in other directions only'}
            </td>
          </tr>
        )}
        {head.obstacles.map((o, k) => {
          const force = shown.contacts?.[k];
          if (!force || Math.hypot(...force) < 1e-9) return null;
          return (
            <tr key={`contact${k}`} data-testid={`contact-${o.name}`}>
              <th>
                {mark}
                {o.object ? `force on ${o.name}` : `force of ${o.name}`}
              </th>
              {force.map((v) => (
                <td>{v.toFixed(2)}</td>
              ))}
              <td class="unit">N</td>
            </tr>
          );
        })}
        {pull && (
          <tr>
            <th>{mark}applied force</th>
            {pull.force_N.map((v) => (
              <td>{v.toFixed(2)}</td>
            ))}
            <td class="unit">N</td>
          </tr>
        )}
      </tbody>
    </table>
  );
}

function Pin() {
  const p = look.pinned.value;
  if (!p)
    return (
      <button class="chip" onClick={() => pinNow('pinned')} data-testid="pin">
        <Icon name="pin" /> Pin to compare
      </button>
    );
  return (
    <span class="chip pinned" data-testid="pinned">
      <span class="swatch" style={{ background: '#f2a93b' }} /> {p.label}
      <button class="bare" aria-pressed={look.beside.value} onClick={() => (look.beside.value = !look.beside.value)}>
        {look.beside.value ? 'overlay' : 'side by side'}
      </button>
      <button class="bare" aria-label="Unpin" onClick={() => (look.pinned.value = null)}>
        ×
      </button>
    </span>
  );
}

const hints = [
  'Drag a slider to pull a cable or to inflate a chamber. While you drag, numbers marked ≈ are approximate; let go, and the exact ones follow.',
  'Drag a marker: the actuators bring it there. Drag the body to apply a force. Drag the background to rotate the view, scroll to zoom.',
  'Change a material under File: the previous state stays visible as a ghost for comparison. Then continue under Prepare.',
];
const hintsSeen = signal(Number(localStorage.getItem('pliant_hints') ?? 0));

function Hints() {
  const k = hintsSeen.value;
  if (k >= hints.length) return null;
  const next = (to: number) => {
    hintsSeen.value = to;
    localStorage.setItem('pliant_hints', String(to));
  };
  return (
    <div class="hint" data-testid="hint">
      <b>{k + 1} of 3</b>
      <p>{hints[k]}</p>
      <div>
        <button class="primary small" onClick={() => next(k + 1)}>
          {k + 1 < hints.length ? 'Next' : 'Done'}
        </button>
        {k + 1 < hints.length && (
          <button class="small" onClick={() => next(hints.length)}>
            Skip
          </button>
        )}
      </div>
    </div>
  );
}

const accuracies: [Accuracy, string, string][] = [
  ['automatic', 'auto', 'Linear elements while you move something, marked ≈, and quadratic ones as soon as it rests'],
  ['preview', '≈ fast', 'Linear elements only: quick, but forces can be 1.3 to 3 times too large'],
  ['fine', 'accurate', 'Quadratic elements only, those of pliant simulate'],
];

function Accuracies() {
  return (
    <div class="segments" role="group" aria-label="Elements">
      {accuracies.map(([name, label, title]) => (
        <button key={name} title={title} aria-pressed={documentState.value.accuracy === name} disabled={!mayDrive.value} onClick={() => setAccuracy(name)} data-testid={name}>
          {label}
        </button>
      ))}
    </div>
  );
}

export function Simulate() {
  const tabs: [typeof panel.value, string][] = [
    ['move', 'Move'],
    ['build', 'Build'],
    ['plots', 'Plots'],
    ['file', 'File'],
    ['goal', 'Goal'],
    ['workspace', 'Workspace'],
    ['identify', 'Identify'],
    ['sweep', 'Sweep'],
  ];
  /// Arrow keys, Home and End move between them.
  const walk = (e: KeyboardEvent) => {
    const step = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: 4, ArrowUp: -4 }[e.key];
    const now = tabs.findIndex(([name]) => name === panel.value);
    const to = e.key === 'Home' ? 0 : e.key === 'End' ? tabs.length - 1 : step === undefined ? -1 : (now + step + tabs.length) % tabs.length;
    if (to < 0) return;
    e.preventDefault();
    panel.value = tabs[to][0];
    (e.currentTarget as HTMLElement).querySelectorAll<HTMLElement>('[role=tab]')[to]?.focus();
  };
  return (
    <main class="simulate">
      <h2 class="unseen">Simulate</h2>
      <section class="stage">
        <FirstPicture />
        <div class={comparing.value ? 'views two' : 'views'}>
          <Canvas />
          {comparing.value && <CanvasBeside options={options} />}
        </div>
        <SectionHandle />
        <div class="stage-top">
          <LookBar />
          <div class="stage-right">
            <Pin />
            <Compare />
            <Export />
          </div>
        </div>
        <Legend />
        <ViewCube />
        <Measure />
        <div class="stage-foot">
          {online.value || lines.value === 0 ? <Hints /> : <Lost text="so the robot is shown as it was last known." />}
          <ScaleBar />
          <Status />
        </div>
      </section>
      <aside class="side">
        <div class="tabs">
          <div class="tab-list four" role="tablist" aria-label="Panels" onKeyDown={walk}>
            {tabs.map(([name, label]) => (
              <button key={name} id={`tab-${name}`} role="tab" aria-selected={panel.value === name} aria-controls="panel" tabIndex={panel.value === name ? 0 : -1} onClick={() => (panel.value = name)} data-testid={`tab-${name}`}>
                {label}
                {name === 'file' && problems.value.length > 0 && <span class="badge">{problems.value.length}</span>}
              </button>
            ))}
          </div>
          <div class="row elements">
            <span class="quiet">Elements</span>
            <Accuracies />
          </div>
        </div>
        <div class="panel" key={panel.value} id="panel" role="tabpanel" aria-labelledby={`tab-${panel.value}`}>
          {panel.value === 'move' && (
            <>
              <Actuators />
              <Readings />
              <Compared />
              <Plots />
            </>
          )}
          {panel.value === 'build' && <Build />}
          {panel.value === 'goal' && <Goal />}
          {panel.value === 'workspace' && <Workspace />}
          {panel.value === 'identify' && <Identify />}
          {panel.value === 'sweep' && <Sweep />}
          {panel.value === 'plots' && <Plots all />}
          {panel.value === 'file' && (
            <>
              <Materials />
              <Editor />
            </>
          )}
        </div>
      </aside>
      <Timeline />
    </main>
  );
}
