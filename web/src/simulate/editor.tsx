// The robot's materials and its file.
import { batch, effect, signal } from '@preact/signals';
import { useState } from 'preact/hooks';
import { Icon } from '../icons';
import { NumberField } from '../number_field';
import { api, building, documentState, frame, helm, lines, mayDrive, onEvent, post, problems, say, scene } from '../store';
import type { Material, Problem } from '../types';
import { CodeArea } from './code_area';
import { isSameRobot, keep as keepText, type Origin, takeKept } from './kept_texts';
import { SaveAs, saveRobot } from './save_robot';
import { keyOf } from './toml_edit';
import { pinned } from './view_state';

export const text = signal('');
/// The studio's version of the text.
export const theirs = signal('');

/// Discards changes that have not been applied.
export function revert() {
  text.value = theirs.value;
}

let applied: string | null = null; // being sent to the studio
let loads = 0;
let savedLine = 0; // the connection, and whether the text was in a file, at the last update
let wasUnsaved = false;
let ofRobot: Origin | null = null; // what the text in the editor is of
/// Counts the robots whose text the editor has had.
const textOf = signal(0);

/// Changes that have not been applied are kept, whoever has control by now, also those that are typed before the
/// studio's text arrives, and so is text that a restarted studio no longer has. They stay in the editor only beside their
/// own robot: applied to another one, they would be saved into its file.
async function load() {
  const mineBefore = text.value;
  const line = lines.value;
  const nth = ++loads;
  const next = await (await api('/api/robot')).text();
  if (nth !== loads) return; // the studio has a newer text
  const mine = text.value;
  const dirty = (mine !== theirs.value && mine !== applied) || mine !== mineBefore;
  const lost = line !== savedLine && wasUnsaved && next !== theirs.value;
  const keep = (dirty || (lost && helm.value.you)) && mine !== next;
  const overtaken = keep && !lost && !helm.value.you && next !== theirs.value;
  const robot = documentState.value;
  const isAnother = ofRobot !== null && !isSameRobot(ofRobot, robot, line !== savedLine);
  const other = keep && isAnother;
  if (other) keepText(mine, ofRobot!);
  const stays = keep && !other;
  const back = stays ? null : takeKept(robot);
  batch(() => {
    theirs.value = next;
    if (!stays) text.value = back ?? next;
    if (isAnother) textOf.value += 1;
  });
  if (other) say(`Another robot was opened. Your text of ${ofRobot!.title} that was not applied is kept under File.`);
  else if (lost && keep) say('The studio was restarted without your unsaved text. It is still here under File: press Apply to restore it.');
  else if (overtaken) say('Another page has changed the robot. Your text that was not applied is still here under File.');
  applied = null;
  savedLine = line;
  wasUnsaved = documentState.value.unsaved;
  ofRobot = robot;
}
onEvent((event) => {
  if (event.type === 'document') load().catch((e: Error) => say(e.message));
});

export async function apply(next: string): Promise<boolean> {
  applied = next;
  try {
    await api('/api/robot', { method: 'PUT', headers: { 'Content-Type': 'text/plain' }, body: next });
    return true;
  } catch (error) {
    applied = null;
    say((error as Error).message);
    return false;
  }
}

/// Pins the current state, so that a change can be compared with it.
export function pinNow(label: string) {
  const now = frame.peek();
  const head = scene.peek()?.head;
  if (now && head) pinned.value = { label, positions: new Float32Array(now.f32('positions')), frame: now, markers: head.markers.map((m) => m.name), opened: head.opened };
}
// It is not compared with another robot.
effect(() => {
  const head = scene.value?.head;
  if (head && pinned.peek() && pinned.peek()?.opened !== head.opened) pinned.value = null;
});

/// Applies what has been typed, before something else changes the file.
export async function applyTyped(): Promise<boolean> {
  return text.value === theirs.value || apply(text.value);
}

export interface Change {
  key: string;
  value: string | number;
}

/// Values of the robot file; what has been typed into it is applied first.
export async function setValues(changes: Change[]): Promise<boolean> {
  return (await applyTyped()) && post('/api/robot/set', { changes });
}

/// Replaces the text in the editor by `next`, with these values in it, as one change.
export async function changeText(next: string, changes: Change[]): Promise<boolean> {
  applied = text.value; // it is part of `next`
  const done = await post('/api/robot/set', { text: next, changes });
  if (!done) applied = null;
  return done;
}

function change(material: string, key: string, value: string | number, label: string): Promise<boolean> {
  pinNow(label);
  return setValues([{ key: keyOf('material', material, key), value }]);
}

/// Why a material's numbers cannot be changed here; '': they can.
export function whyFixed(m: Material, key: 'youngs_modulus' | 'poisson_ratio'): string {
  if (m.from_library) return `${m.name} comes from the library: to change it, give it a table [material] of its own in the file.`;
  if (key === 'youngs_modulus' && m.has_youngs_modulus === false) return `It follows from the constants of the ${m.law} law, which are in the file.`;
  return '';
}

function Fixed({ label, value, unit, why, testId }: { label: string; value: number; unit: string; why: string; testId: string }) {
  return (
    <p class="row" title={why} data-testid={testId}>
      <span>{label}</span>
      <span>
        {value} <span class="unit">{unit}</span>
      </span>
    </p>
  );
}

export function Materials() {
  const head = scene.value?.head;
  if (!head) return null;
  return (
    <div class="materials">
      {head.materials.map((m) => (
        <fieldset class="material" key={m.name} disabled={!mayDrive.value}>
          <legend>
            <span class="swatch" style={{ background: m.colour }} />
            {m.name}
            <span class="quiet">{m.law}</span>
          </legend>
          {whyFixed(m, 'youngs_modulus') ? (
            <Fixed label="Young's modulus" value={+m.youngs_modulus_MPa.toPrecision(6)} unit="MPa" why={whyFixed(m, 'youngs_modulus')} testId={`fixed-modulus-${m.name}`} />
          ) : (
          <label>
            <span>Young's modulus</span>
            <NumberField
              value={+m.youngs_modulus_MPa.toPrecision(6)}
              range={{ from: 0, to: Infinity, open: true }}
              unit="MPa"
              testId={`modulus-${m.name}`}
              onValue={(v) => change(m.name, 'youngs_modulus', `${v} MPa`, `${m.name}: ${+m.youngs_modulus_MPa.toPrecision(4)} MPa`)}
            />
          </label>
          )}
          {whyFixed(m, 'poisson_ratio') ? (
            <Fixed label="Poisson ratio" value={+m.poisson_ratio.toPrecision(6)} unit="" why={whyFixed(m, 'poisson_ratio')} testId={`fixed-poisson-${m.name}`} />
          ) : (
          <label>
            <span>Poisson ratio</span>
            <NumberField
              value={+m.poisson_ratio.toPrecision(6)}
              range={{ from: -1, to: 0.5, open: true }}
              unit=""
              step={0.01}
              testId={`poisson-${m.name}`}
              onValue={(v) => change(m.name, 'poisson_ratio', v, `${m.name}: Poisson ratio ${m.poisson_ratio}`)}
            />
          </label>
          )}
          {whyFixed(m, 'youngs_modulus') && <p class="quiet small-print">{whyFixed(m, 'youngs_modulus')}</p>}
        </fieldset>
      ))}
    </div>
  );
}

let checking = 0;
let checked = '';
/// Typed text is checked after a short pause, without building it.
effect(() => {
  const next = text.value;
  clearTimeout(checking);
  // Text that the studio has built has been checked, unless there was another error meanwhile.
  if (next === checked || (next === theirs.peek() && checked === '') || !mayDrive.peek()) return;
  checking = window.setTimeout(async () => {
    const response = await api('/api/robot/check', { method: 'POST', headers: { 'Content-Type': 'text/plain' }, body: next }).catch(() => null);
    if (!response || text.peek() !== next) return;
    checked = next === theirs.peek() ? '' : next;
    problems.value = ((await response.json()) as { lines: Problem[] }).lines;
  }, 400);
});

export const autosave = signal(localStorage.getItem('pliant_autosave') === 'on');
autosave.subscribe((on) => localStorage.setItem('pliant_autosave', on ? 'on' : 'off'));
let digest = ''; // of the text that is known last
let builtBefore = -1; // revision of the robot that was shown when it came
let tried = ''; // digest of the text that was to be saved last: where that is refused, it is not asked for again
/// A text is saved once it has been built: until then nobody knows whether it has errors.
effect(() => {
  const d = documentState.value;
  const revision = scene.value?.head.revision ?? -1;
  if (d.digest !== digest) {
    digest = d.digest;
    builtBefore = revision;
  }
  const isBuilt = revision > builtBefore && problems.value.length === 0 && !building.value;
  const wanted = autosave.value && d.unsaved && d.name !== '' && mayDrive.value;
  if (!wanted) tried = '';
  if (!wanted || !isBuilt || tried === d.digest) return;
  tried = d.digest;
  void saveRobot();
});

/// A name for a file that the robot does not have yet.
function newName(): string {
  const name = documentState.peek().name;
  if (name) return name.replace(/(\.toml)?$/i, '_copy.toml');
  return `${(scene.peek()?.head.robot ?? 'robot').replace(/[^a-z0-9]+/gi, '_')}.toml`;
}

export function Editor() {
  /// The name that the form begins with; null: there is no form.
  const [saveAs, setSaveAs] = useState<string | null>(null);
  const d = documentState.value;
  const changed = text.value !== theirs.value;
  const askForName = () => setSaveAs(newName());
  const saveTyped = async () => {
    if (mayDrive.peek() && (await applyTyped())) documentState.peek().name ? void saveRobot() : askForName();
  };
  const canBuildAgain = !changed && problems.value.length > 0;
  return (
    <div class="editor">
      <div class="tools">
        <button class="primary small" disabled={!changed || !mayDrive.value} onClick={() => apply(text.value)} data-testid="apply">
          Apply
        </button>
        {canBuildAgain && (
          <button class="small" disabled={!mayDrive.value || building.value !== null} onClick={() => apply(text.value)} data-testid="build-again">
            Build again
          </button>
        )}
        {changed && (
          <button class="small" onClick={revert} data-testid="revert">
            Revert
          </button>
        )}
        {!canBuildAgain && <span class="quiet keys">Ctrl+Enter</span>}
        <span class="grow" />
        <button class="bare" title="Undo" aria-label="Undo" disabled={!d.undo || changed || !mayDrive.value} onClick={() => post('/api/robot/undo')}>
          <Icon name="undo" />
        </button>
        <button class="bare" title="Redo" aria-label="Redo" disabled={!d.redo || changed || !mayDrive.value} onClick={() => post('/api/robot/redo')}>
          <Icon name="redo" />
        </button>
        <button class="bare" title="Save" aria-label="Save" disabled={changed || !mayDrive.value || (!d.unsaved && !!d.name)} onClick={() => (d.name ? saveRobot() : askForName())}>
          <Icon name="save" />
        </button>
        {d.name && (
          <button class="bare" title="Save under another name" aria-label="Save under another name" disabled={changed || !mayDrive.value} onClick={askForName}>
            <Icon name="save_as" />
          </button>
        )}
      </div>
      {saveAs !== null && <SaveAs first={saveAs} close={() => setSaveAs(null)} />}
      {problems.value.length > 0 && (
        <div class="problems" role="alert" data-testid="problems">
          <ul>
            {problems.value.map((p) => (
              <li>
                {p.line > 0 && <b>line {p.line}</b>} {p.text}
              </li>
            ))}
          </ul>
        </div>
      )}
      <CodeArea text={text} origin={textOf} problems={problems} readOnly={!mayDrive.value} onApply={() => void apply(text.peek())} onSave={() => void saveTyped()} />
      <label class="tick autosave">
        <input type="checkbox" checked={autosave.value} onChange={(e) => (autosave.value = e.currentTarget.checked)} data-testid="autosave" />
        Save every applied change to the file
      </label>
    </div>
  );
}
