// A robot on a page of its own, as shown in notebooks: the studio's view, with the states embedded in the page. The
// page holds <script type="application/json" id="robot"> with packets in base64; nothing is loaded.
import { orbitHelp, orbitKeys } from './orbit_keys';
import { readPacket } from './packet';
import { gradientCss } from './simulate/colormap';
import { RobotView } from './simulate/view';
import { fieldNames, type FieldName } from './simulate/view_state';
import type { FrameHead, SceneHead } from './types';

interface Shown {
  scene: string;
  frames: string[];
  labels: string[];
  field: FieldName;
}

function bytes(text: string): ArrayBuffer {
  return Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
}

function make<K extends keyof HTMLElementTagNameMap>(tag: K, parent: HTMLElement, more: object = {}): HTMLElementTagNameMap[K] {
  const element = Object.assign(document.createElement(tag), more);
  parent.append(element);
  return element;
}

const number = (v: number) => (Math.abs(v) >= 1e4 || (v !== 0 && Math.abs(v) < 1e-2) ? v.toExponential(2) : v.toPrecision(3));

function show(root: HTMLElement, shown: Shown) {
  const stage = make('div', root, { className: 'stage' });
  const canvas = make('canvas', stage, { tabIndex: 0, title: orbitHelp });
  canvas.setAttribute('aria-label', 'the robot in 3D');
  const view = new RobotView(canvas);
  view.pointer.mayGrab = () => false;
  view.setScene(readPacket<SceneHead>(bytes(shown.scene)));
  const frames = shown.frames.map((f) => readPacket<FrameHead>(bytes(f)));
  canvas.addEventListener('keydown', (e) =>
    orbitKeys(e, (a, u, n) => view.turn(a, u, n), () => view.lookAt('home')),
  );

  const bar = make('div', root, { className: 'bar' });
  const legend = make('div', stage, { className: 'legend' });
  legend.style.background = gradientCss();
  const high = make('span', legend, { className: 'high' });
  const low = make('span', legend, { className: 'low' });

  const field = make('select', bar, { ariaLabel: 'colours' });
  for (const { name, label, unit } of fieldNames) make('option', field, { value: name, text: unit ? `${label} (${unit})` : label });
  field.value = shown.field;
  const wires = check(bar, 'mesh');
  const ghost = check(bar, 'rest shape');
  const play = make('button', bar, { textContent: '▶', title: 'play', hidden: frames.length < 2 });
  const slider = make('input', bar, { type: 'range', min: '0', max: String(frames.length - 1), ariaLabel: 'state', hidden: frames.length < 2 });
  const label = make('span', bar, { className: 'label' });

  view.onRange = (from, to) => {
    low.textContent = number(from);
    high.textContent = number(to);
  };
  const look = () => {
    const name = field.value as FieldName;
    legend.hidden = name === 'material';
    view.setOptions({
      field: name,
      scale: fieldNames.find((f) => f.name === name)!.scale,
      wireframe: wires.checked,
      ghost: ghost.checked,
      inside: false,
      exploded: 0,
      sectionAxis: '',
      sectionAt: 0.5,
      pinned: null,
      beside: false,
    });
  };
  const turn = (k: number) => {
    slider.value = String(k);
    view.setFrame(frames[k]);
    label.textContent = shown.labels[k] ?? '';
  };
  for (const input of [field, wires, ghost]) input.addEventListener('change', look);
  slider.addEventListener('input', () => turn(Number(slider.value)));
  let timer = 0;
  const stop = () => {
    clearInterval(timer);
    timer = 0;
    play.textContent = '▶';
  };
  play.addEventListener('click', () => {
    if (timer) return stop();
    play.textContent = '❚❚';
    timer = window.setInterval(() => turn((Number(slider.value) + 1) % frames.length), 120);
  });
  look();
  turn(frames.length - 1);
}

function check(parent: HTMLElement, text: string): HTMLInputElement {
  const label = make('label', parent);
  const box = make('input', label, { type: 'checkbox' });
  label.append(text);
  return box;
}

const root = document.getElementById('viewer')!;
try {
  show(root, JSON.parse(document.getElementById('robot')!.textContent!) as Shown);
} catch (error) {
  root.textContent = `The robot cannot be shown: ${error instanceof Error ? error.message : error}`;
}
