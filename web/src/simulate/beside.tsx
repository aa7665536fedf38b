// A second robot for comparison: it receives the same inputs, and its numbers are shown beside those of the first.
import { batch, computed, effect, signal } from '@preact/signals';
import { useEffect, useRef, useState } from 'preact/hooks';
import { useDismiss } from '../dismiss';
import { hasEnding } from '../file_names';
import { Icon } from '../icons';
import { readPacket } from '../packet';
import { api, driveAll, frame, isRough, lines, mayDrive, onBesideFrame, onEvent, post, say, scene } from '../store';
import type { Frame, FrameHead, Problem, Scene, SceneHead } from '../types';
import { channelsOf } from './tracks';
import { theView } from './the_view';
import { RobotView, type ViewOptions } from './view';

/// The file it was opened from; '': there is none.
export const title = signal('');
export const comparing = computed(() => title.value !== '');
const sceneBeside = signal<Scene | null>(null);
const frameBeside = signal<Frame | null>(null);
const stage = signal('');
const problem = signal('');
/// Range of each view, so that a colour means the same value in both.
export const ranges = signal<[[number, number] | null, [number, number] | null]>([null, null]);

/// Writes only what has changed: the colours depend on both ranges, and the range of a view on its colours.
export function tellRange(which: 0 | 1, low: number, high: number) {
  const both: typeof ranges.value = [...ranges.peek()];
  if (both[which]?.[0] === low && both[which]?.[1] === high) return;
  both[which] = [low, high];
  ranges.value = both;
}

async function loadScene() {
  const loaded = readPacket<SceneHead>(await (await api('/api/compare/scene')).arrayBuffer());
  const bytes = await (await api('/api/compare/frame')).arrayBuffer();
  batch(() => {
    sceneBeside.value = loaded;
    const now = bytes.byteLength > 0 ? readPacket<FrameHead>(bytes) : null;
    frameBeside.value = now?.head.revision === loaded.head.revision ? now : null;
  });
}

onEvent((event) => {
  if (event.type === 'comparison') {
    batch(() => {
      title.value = String(event.title ?? '');
      sceneBeside.value = frameBeside.value = null;
      stage.value = problem.value = '';
      ranges.value = [null, null];
    });
  }
  if (event.type !== 'beside') return;
  const inner = event.event as { type: string; stage?: string; lines?: Problem[] };
  if (inner.type === 'scene') loadScene().catch(() => {}); // it was closed meanwhile
  if (inner.type === 'build') stage.value = inner.stage ?? '';
  if (inner.type === 'problem') problem.value = (inner.lines ?? []).map((p) => `${p.line > 0 ? `line ${p.line} ` : ''}${p.text}`).join('; ');
});
onBesideFrame((next) => {
  if (next.head.revision === sceneBeside.peek()?.head.revision) frameBeside.value = next;
});
effect(() => {
  if (lines.value > 0) title.value = '';
});
/// Dragging and releasing a marker applies to both robots.
let wasLed = false;
effect(() => {
  const led = Boolean(frame.value?.head.lead);
  if (wasLed && !led && comparing.peek() && mayDrive.peek()) setTimeout(driveAll, 0);
  wasLed = led;
});
/// After it is built, it is driven to the state of the first one.
effect(() => {
  if (sceneBeside.value && mayDrive.peek()) setTimeout(driveAll, 0);
});

export function Compare() {
  const [project, setProject] = useState<{ files: string[]; examples: string[]; printers: string[] } | null>(null);
  const box = useRef<HTMLDivElement>(null);
  useDismiss(project !== null, () => setProject(null), box);
  if (comparing.value)
    return (
      <span class="chip pinned" data-testid="comparing">
        compared with: {title.value.replace(/_/g, ' ')}
        <button class="bare" aria-label="Stop comparing" disabled={!mayDrive.value} data-testid="compare-leave" onClick={() => void post('/api/compare/leave')}>
          <Icon name="close" />
        </button>
      </span>
    );
  const open = async () => setProject(project ? null : ((await (await api('/api/project')).json()) as { files: string[]; examples: string[]; printers: string[] }));
  const item = (label: string, order: unknown) => (
    <button class="item" key={label} onClick={() => void post('/api/compare', order)}>
      {label}
    </button>
  );
  const robots = (project?.files ?? []).filter((f) => hasEnding(f, '.toml') && !project!.printers.includes(f));
  return (
    <div class="menu" ref={box}>
      <button class="chip" aria-expanded={project !== null} disabled={!mayDrive.value} onClick={() => void open().catch((e: Error) => say(e.message))} data-testid="compare">
        Compare
      </button>
      {project && (
        <div class="popover right compare-list" onClick={() => setProject(null)}>
          <h2>Show beside this robot, driven alike</h2>
          {item('This robot, as it is now', {})}
          {robots.length > 0 && <h2>This folder</h2>}
          {robots.map((name) => item(name, { name }))}
          <h2>Examples</h2>
          {project.examples.map((example) => item(example.replace(/_/g, ' '), { example }))}
        </div>
      )}
    </div>
  );
}

/// Its view: same settings, and the camera follows that of the first one.
export function CanvasBeside({ options }: { options: () => ViewOptions }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    let made: RobotView;
    try {
      made = new RobotView(canvas.current!);
    } catch {
      return; // the first view has shown the reason
    }
    made.pointer.mayGrab = () => false;
    made.onData = (low, high) => tellRange(1, low, high);
    let following = false;
    const follow = () => {
      const first = theView.peek();
      if (!first || following) return;
      following = true;
      made.lookLike(first);
      following = false;
    };
    made.onTurned = () => {
      if (following) return;
      following = true;
      theView.peek()?.lookLike(made);
      following = false;
    };
    const stops = [
      effect(() => {
        if (!sceneBeside.value) return;
        made.setScene(sceneBeside.value);
        const now = frameBeside.peek();
        if (now) made.setFrame(now);
        follow();
      }),
      effect(() => made.setOptions({ ...options(), pinned: null })),
      effect(() => {
        if (frameBeside.value) made.setFrame(frameBeside.value);
      }),
      effect(() => {
        const first = theView.value;
        if (first) first.onTurned = follow;
      }),
    ];
    return () => {
      for (const stop of stops) stop();
      const first = theView.peek();
      if (first) first.onTurned = () => {};
      made.dispose();
    };
  }, []);
  const head = frameBeside.value?.head;
  const state = problem.value ? problem.value : stage.value ? `building: ${stage.value}` : !head ? '' : head.stuck ? `did not converge: ${head.stuck}` : head.arrived ? (isRough(frameBeside.value) ? '≈ linear preview' : 'at equilibrium') : 'Solving…';
  return (
    <div class="canvas second" data-testid="beside" data-state={head?.arrived ? 'arrived' : problem.value ? 'problem' : 'busy'}>
      <canvas ref={canvas} role="img" aria-label={`The second robot, ${title.value}, in 3D. Its camera follows that of the first one.`} data-testid="view-beside" />
      <p class="beside-name" role="status">
        <b>{sceneBeside.value?.head.robot ?? title.value.replace(/_/g, ' ')}</b> <span class={problem.value ? 'problems-inline' : 'quiet'}>{state}</span>
      </p>
    </div>
  );
}

const show = (v: number) => (Number.isFinite(v) ? `${+v.toPrecision(4)}` : '–');
const wantedKinds = ['tension_N', 'pressure_kPa', 'displacement_mm', 'force_N', 'energy_mJ'];

/// The results that both have, and further ones of the second.
export function Compared() {
  const [a, b] = [frame.value, frameBeside.value];
  const [one, other] = [scene.value?.head, sceneBeside.value?.head];
  if (!comparing.value || !one) return null;
  if (!b || !other || !a) return <p class="quiet">The second robot is being built…</p>;
  const channels = channelsOf(one).filter((c) => wantedKinds.includes(c.kind));
  const others = new Map(channelsOf(other).map((c) => [c.key, c]));
  const missing = one.actuators.filter((x) => !other.actuators.some((y) => y.name === x.name && y.type === x.type));
  const more = other.actuators.filter((x) => !one.actuators.some((y) => y.name === x.name && y.type === x.type));
  return (
    <section aria-label="Comparison" data-testid="compared">
      <table class="readings">
        <thead>
          <tr>
            <th>Quantity</th>
            <th>{one.robot}</th>
            <th>{other.robot === one.robot ? title.value.replace(/_/g, ' ') : other.robot}</th>
            <th>
              <span class="unseen">Unit</span>
            </th>
          </tr>
        </thead>
        <tbody>
          {channels
            .filter((c) => others.has(c.key))
            .map((c) => (
              <tr key={c.key} data-testid={`compared-${c.key}`}>
                <th>{c.label}</th>
                <td>{`${isRough(a) ? '≈ ' : ''}${show(c.read(a.head))}`}</td>
                <td>{`${(b.head.order ?? other.order) === 1 ? '≈ ' : ''}${show(others.get(c.key)!.read(b.head))}`}</td>
                <td class="unit">{c.unit}</td>
              </tr>
            ))}
        </tbody>
      </table>
      {missing.length > 0 && <p class="limit">The second robot has no {missing.map((m) => `${m.type} "${m.name}"`).join(', ')}: it does not follow this input.</p>}
      {more.length > 0 && <p class="limit">The first robot has no {more.map((m) => `${m.type} "${m.name}"`).join(', ')}: it stays at rest in the second one.</p>}
    </section>
  );
}
