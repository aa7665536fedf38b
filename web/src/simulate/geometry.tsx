// Geometry files dropped onto the page, or picked: uploaded into the project folder, read there, and used as bodies of
// a new or the current robot.
import { signal } from '@preact/signals';
import { useEffect, useRef, useState } from 'preact/hooks';
import { unlessLost } from '../discard';
import { useDialog } from '../dismiss';
import { api, documentState, mayDrive, page, post, say, scene } from '../store';
import { freeName, library } from './build';
import { applyTyped, theirs } from './editor';

/// Contents of a file, as read by the studio.
export interface Content {
  name: string;
  kind: 'surface' | 'step' | '3mf' | 'tets';
  unit_mm: number; // 0: not in the file
  low: [number, number, number];
  high: [number, number, number];
  text: string;
  parts: string[];
  notes: string[];
}

export const endings = '.stl,.obj,.ply,.off,.3mf,.step,.stp,.vtk,.vtu,.mesh,.msh,.inp';
const mostBytes = 256 * 2 ** 20;

export const units: Record<string, number> = { mm: 1, cm: 10, m: 1000, um: 1e-3, in: 25.4 };

type State =
  | { step: 'sending'; file: File; share: number }
  | { step: 'taken'; file: File }
  | { step: 'refused'; why: string }
  | { step: 'ready'; content: Content };
const state = signal<State | null>(null);
let request: XMLHttpRequest | null = null;

/// Uploads one file; the studio reads it before storing it.
function transfer(file: File, replace: boolean) {
  if (file.size > mostBytes) {
    state.value = { step: 'refused', why: `${file.name}: larger than 256 MB; copy it into the project folder yourself` };
    return;
  }
  state.value = { step: 'sending', file, share: 0 };
  const r = (request = new XMLHttpRequest());
  r.open('PUT', `/api/files?name=${encodeURIComponent(file.name)}${replace ? '&replace=1' : ''}`);
  r.setRequestHeader('X-Pliant-Page', page);
  r.setRequestHeader('Content-Type', 'application/octet-stream');
  r.upload.onprogress = (e) => {
    if (state.peek()?.step === 'sending') state.value = { step: 'sending', file, share: e.total ? e.loaded / e.total : 0 };
  };
  r.onerror = () => (state.value = { step: 'refused', why: `${file.name}: the connection to the studio was lost` });
  r.onload = () => {
    const answer = (() => {
      try {
        return JSON.parse(r.responseText) as Content & { error?: string };
      } catch {
        return { error: `${file.name}: the studio answered ${r.status}` } as Content & { error?: string };
      }
    })();
    if (r.status === 200) state.value = { step: 'ready', content: answer };
    else if (r.status === 409 && answer.error?.includes('is there already')) state.value = { step: 'taken', file };
    else state.value = { step: 'refused', why: answer.error ?? `${file.name}: the studio answered ${r.status}` };
  };
  r.send(file);
}

/// Handles dropped or picked files, one at a time: a robot file is opened, geometry is uploaded.
export function takeFiles(files: ArrayLike<File>) {
  const file = files[0];
  if (!file) return;
  if (!mayDrive.peek()) return say('Another page has control: request it first.');
  if (files.length > 1) say(`One file at a time: only ${file.name} is imported.`);
  if (!/\.toml$/i.test(file.name)) return transfer(file, false);
  unlessLost(`Opening ${file.name}`, () => {
    void file
      .text()
      .then((text) => api(`/api/robot/new?name=${encodeURIComponent(file.name)}`, { method: 'POST', headers: { 'Content-Type': 'text/plain' }, body: text }))
      .catch((e: Error) => say(e.message));
  });
}

const quoted = (s: string) => JSON.stringify(s);
/// "finger" of "Finger (2).stl".
export const stem = (file: string) => file.replace(/\.[^.]*$/, '').trim() || 'robot';

const round = (v: number, digits = 4) => +v.toPrecision(digits);
/// For lengths: the largest of 1, 2, 2.5, 5 times a power of ten that is not above `v`.
function nice(v: number): number {
  const power = 10 ** Math.floor(Math.log10(v));
  return round(power * ([5, 2.5, 2].find((f) => f * power <= v) ?? 1));
}

export type Side = 'x' | '-x' | 'y' | '-y' | 'z' | '-z';
export const sides: [Side, string][] = [
  ['-x', 'its low x end'],
  ['x', 'its high x end'],
  ['-y', 'its low y end'],
  ['y', 'its high y end'],
  ['-z', 'its bottom (low z)'],
  ['z', 'its top (high z)'],
];

/// One end of the longest side: long parts are usually held at one end.
export function usualSide({ low, high }: Pick<Content, 'low' | 'high'>): Side {
  const size = [0, 1, 2].map((k) => high[k] - low[k]);
  return `-${'xyz'[size.indexOf(Math.max(...size))]}` as Side;
}

/// The bodies of a file as [[body]] entries: one, or one for each of its parts.
export function bodiesOf(content: Content, path: string, material: string, taken: string[], scale = 1): Record<string, unknown>[] {
  const names = [...taken];
  const named = (wish: string) => {
    const name = names.includes(wish) ? freeName(wish, names) : wish;
    names.push(name);
    return name;
  };
  const place = scale === 1 ? {} : { place: { scale } };
  if (content.kind === 'tets') return content.parts.map((region) => ({ name: named(region), material, region }));
  if (content.parts.length === 0) return [{ name: named(stem(content.name)), material, geometry: path, ...place }];
  return content.parts.map((part) => ({ name: named(part), material, geometry: path, part, ...place }));
}

const toml = (v: unknown): string => (typeof v === 'object' && v !== null ? `{ ${Object.entries(v).map(([k, w]) => `${k} = ${toml(w)}`).join(', ')} }` : typeof v === 'string' ? quoted(v) : `${v}`);

/// A robot made of this file alone, held at one side, with a marker in the middle of the opposite side.
export function robotOf(content: Content, unit: string, material: string, side: Side): string {
  const { low, high } = content;
  // The reader converts a file with its own unit to the robot's.
  const per = content.unit_mm > 0 ? content.unit_mm / units[unit] : 1;
  const [from, to] = [low, high].map((p) => p.map((v) => v * per));
  const size = [0, 1, 2].map((k) => to[k] - from[k]);
  const longest = Math.max(...size);
  const axis = 'xyz'.indexOf(side.at(-1)!);
  const edge = side.startsWith('-') ? from[axis] : to[axis];
  const margin = 0.02 * longest;
  // Of a thin sheet only the held side is in the box, and not the other one.
  const slab = Math.min(margin, 0.25 * size[axis]);
  const bounds = (k: number, end: number) => {
    const out = k === axis ? slab : margin;
    const at = k === axis ? edge : (end ? to : from)[k];
    return round(at + (end ? out : -out), 9);
  };
  const box = [0, 1].map((end) => `[${[0, 1, 2].map((k) => bounds(k, end)).join(', ')}]`).join(', ');
  const bodies = bodiesOf(content, content.name, material, []);
  const entry = (body: Record<string, unknown>) => ['[[body]]', ...Object.entries(body).map(([key, v]) => `${key} = ${toml(v)}`)].join('\n');
  const mesh = content.kind === 'tets' ? `file = ${quoted(content.name)}` : `size = "${nice(longest / 12)} ${unit}"    # a smaller size is more accurate, but slower`;
  return [
    `name = ${quoted(stem(content.name))}`,
    `length_unit = ${quoted(unit)}`,
    '',
    bodies.map(entry).join('\n\n'),
    '',
    '[mesh]',
    mesh,
    '',
    '[[fixed]]',
    'name = "base"',
    `box = [${box}]`,
    '',
  ].join('\n');
}

/// Relative path from the folder of the current robot file to the project folder, where the file is.
const upwards = () => '../'.repeat(documentState.peek().name.split('/').length - 1);

function Ready({ content, close }: { content: Content; close: () => void }) {
  const first = useRef<HTMLDivElement>(null);
  useEffect(() => first.current?.querySelector<HTMLElement>('select')?.focus(), []);
  const says = content.unit_mm > 0;
  const [unit, setUnit] = useState('mm');
  const [material, setMaterial] = useState('dragon-skin-30');
  const [side, setSide] = useState<Side>(usualSide(content));
  const size = [0, 1, 2].map((k) => (content.high[k] - content.low[k]) * (says ? content.unit_mm : units[unit]));
  const unlikely = Math.max(...size) > 3000 || Math.max(...size) < 1;
  const mayAdd = scene.value !== null && content.kind !== 'tets' && !/^\s*file\s*=/m.test(theirs.value);
  const create = () =>
    unlessLost('A new robot', () => {
      close();
      void api('/api/robot/new', { method: 'POST', headers: { 'Content-Type': 'text/plain' }, body: robotOf(content, unit, material, side) }).catch((e: Error) => say(e.message));
    });
  const add = async () => {
    close();
    const robotUnit = scene.peek()?.head.unit_mm ?? 1;
    const bodies = bodiesOf(content, `${upwards()}${content.name}`, material, (scene.peek()?.head.bodies ?? []).map((b) => b.name), says ? 1 : round(units[unit] / robotUnit, 9));
    if (!(await applyTyped())) return;
    for (const entry of bodies) if (!(await post('/api/robot/add', { list: 'body', entry }))) return;
  };
  return (
    <>
      <h2 id="geometry-title">{content.name}</h2>
      <p class="quiet" data-testid="geometry-text">
        {content.text}
        {content.parts.length > 0 && `, ${content.parts.length === 1 ? 'one body' : `${content.parts.length} bodies`}: ${content.parts.join(', ')}`}. It is in the project folder.
      </p>
      {content.notes.slice(0, 3).map((note) => (
        <p class="quiet" key={note}>{note}</p>
      ))}
      <div class="fields geometry-fields" ref={first}>
        {says ? (
          <p class="quiet">The file states its unit.</p>
        ) : (
          <label>
            Unit
            <select value={unit} onChange={(e) => setUnit(e.currentTarget.value)} data-testid="geometry-unit">
              {Object.keys(units).map((u) => (
                <option key={u}>{u}</option>
              ))}
            </select>
          </label>
        )}
        <p class={unlikely ? 'limit' : 'quiet'} data-testid="geometry-size">
          {size.map((v) => round(v)).join(' × ')} mm{unlikely && ': is the unit right?'}
        </p>
        <label>
          Material
          <select value={material} onChange={(e) => setMaterial(e.currentTarget.value)} data-testid="geometry-material">
            {(library.value.length ? library.value : [{ name: material, title: '', hardness: '' }]).map((m) => (
              <option value={m.name} key={m.name} title={m.title}>
                {m.name} {m.hardness && `(${m.hardness})`}
              </option>
            ))}
          </select>
        </label>
        <label>
          Held at
          <select value={side} onChange={(e) => setSide(e.currentTarget.value as Side)} data-testid="geometry-side">
            {sides.map(([value, label]) => (
              <option value={value} key={value}>{label}</option>
            ))}
          </select>
        </label>
      </div>
      <div class="row left wrap">
        <button class="primary" onClick={create} data-testid="geometry-new">
          New robot
        </button>
        {mayAdd && (
          <button onClick={() => void add()} data-testid="geometry-add">
            Add to {scene.value!.head.robot}
          </button>
        )}
        <button onClick={close}>Cancel</button>
      </div>
    </>
  );
}

function Body({ now, close }: { now: State; close: () => void }) {
  if (now.step === 'ready') return <Ready content={now.content} close={close} key={now.content.name} />;
  if (now.step === 'sending')
    return (
      <>
        <h2 id="geometry-title">{now.file.name}</h2>
        <div class="progress" role="progressbar" aria-label="File upload" aria-valuenow={Math.round(100 * now.share)} aria-valuemin={0} aria-valuemax={100}>
          <div style={{ width: `${100 * now.share}%` }} />
          <span>{now.share < 1 ? `uploading, ${Math.round(100 * now.share)} %` : 'reading…'}</span>
        </div>
        <div class="row left">
          <button ref={(b) => b?.focus()} onClick={() => (request?.abort(), close())}>Cancel</button>
        </div>
      </>
    );
  if (now.step === 'taken')
    return (
      <>
        <h2 id="geometry-title">Replace {now.file.name}?</h2>
        <p>The project folder already has a different file of this name. Robots that use it will get the new one.</p>
        <div class="row left wrap">
          <button class="primary" ref={(b) => b?.focus()} onClick={close} data-testid="geometry-keep">
            Keep the old one
          </button>
          <button onClick={() => transfer(new File([now.file], now.file.name.replace(/(\.[^.]*)$/, ` ${new Date().toISOString().slice(11, 19).replace(/:/g, '')}$1`)), false)} data-testid="geometry-both">
            Keep both
          </button>
          <button class="danger" onClick={() => transfer(now.file, true)} data-testid="geometry-replace">
            Replace
          </button>
        </div>
      </>
    );
  return (
    <>
      <h2 id="geometry-title">The file was not imported</h2>
      <p class="problems" role="alert" data-testid="geometry-refused">{now.why}</p>
      <div class="row left">
        <button class="primary" ref={(b) => b?.focus()} onClick={close}>Close</button>
      </div>
    </>
  );
}

/// The whole page accepts dropped files.
export function GeometryDrop() {
  const [over, setOver] = useState(false);
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => {
    let timer = 0;
    const carries = (e: DragEvent) => Array.from(e.dataTransfer?.types ?? []).includes('Files');
    const drag = (e: DragEvent) => {
      if (!carries(e)) return;
      e.preventDefault();
      setOver(true);
      clearTimeout(timer);
      timer = window.setTimeout(() => setOver(false), 300); // dragover is repeated as long as something is held over
                                                            // the page
    };
    const drop = (e: DragEvent) => {
      if (!carries(e)) return;
      e.preventDefault();
      setOver(false);
      takeFiles(e.dataTransfer!.files);
    };
    window.addEventListener('dragover', drag);
    window.addEventListener('drop', drop);
    return () => {
      window.removeEventListener('dragover', drag);
      window.removeEventListener('drop', drop);
    };
  }, []);
  const close = () => (state.value = null);
  const now = state.value;
  useDialog(now !== null);
  return (
    <>
      {over && !now && (
        <div class="drop-here" data-testid="drop-here">
          <p>Drop it here: STL, OBJ, PLY, OFF, 3MF, STEP, a tet mesh, or a robot file</p>
        </div>
      )}
      {now && (
        <div class="question-back" onKeyDown={(e) => e.key === 'Escape' && close()}>
          <div class="question card" role="dialog" aria-modal="true" aria-labelledby="geometry-title" data-testid="geometry" ref={box}>
            <Body now={now} close={close} />
          </div>
        </div>
      )}
    </>
  );
}

/// For users without a mouse.
export function PickGeometry({ label, testId }: { label: string; testId: string }) {
  return (
    <label class="button small">
      {label}
      <input
        class="unseen"
        type="file"
        accept={`${endings},.toml`}
        disabled={!mayDrive.value}
        data-testid={testId}
        onClick={(e) => e.stopPropagation()}
        onChange={(e) => {
          const files = Array.from(e.currentTarget.files ?? []);
          e.currentTarget.value = '';
          takeFiles(files);
        }}
      />
    </label>
  );
}

