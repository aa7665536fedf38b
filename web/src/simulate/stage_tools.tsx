// Overlays of the 3D view: cube, axes, scale bar, section handle, measurements.
import { useEffect, useRef, useState } from 'preact/hooks';
import { useDismiss } from '../dismiss';
import { Icon } from '../icons';
import { frame, scene } from '../store';
import { niceBelow } from './fit';
import { onDrawn, theView } from './the_view';
import type { Side } from './viewpoint';
import * as look from './view_state';

const presets: [Side, string, string][] = [
  ['home', 'Isometric', '0'],
  ['front', 'Front', '1'],
  ['back', 'Back', '2'],
  ['left', 'Left', '3'],
  ['right', 'Right', '4'],
  ['top', 'Top', '5'],
  ['bottom', 'Bottom', '6'],
];

/// Number keys select a side view.
export function presetKey(key: string): boolean {
  const found = presets.find(([, , k]) => k === key);
  if (found) theView.value?.lookAt(found[0]);
  return found !== undefined;
}

export function ViewMenu() {
  const [open, setOpen] = useState(false);
  const box = useRef<HTMLDivElement>(null);
  useDismiss(open, () => setOpen(false), box);
  return (
    <div class="menu" ref={box}>
      <button class="chip" aria-expanded={open} onClick={() => setOpen(!open)} data-testid="view-menu">
        View
      </button>
      {open && (
        <div class="popover" onClick={() => setOpen(false)}>
          <button class="item" onClick={() => theView.value?.lookAt()} data-testid="view-fit">
            <span>Fit view</span>
            <span class="quiet">Home</span>
          </button>
          {presets.map(([side, label, key]) => (
            <button class="item" key={side} onClick={() => theView.value?.lookAt(side)} data-testid={`view-${side}`}>
              <span>{label}</span>
              <span class="quiet">{key}</span>
            </button>
          ))}
        </div>
      )}
    </div>
  );
}

type Vec = [number, number, number];
const cross = (a: Vec, b: Vec): Vec => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/// Normal and up direction of each face.
const faces: [Side, string, Vec, Vec][] = [
  ['front', 'Front', [0, -1, 0], [0, 0, 1]],
  ['back', 'Back', [0, 1, 0], [0, 0, 1]],
  ['left', 'Left', [-1, 0, 0], [0, 0, 1]],
  ['right', 'Right', [1, 0, 0], [0, 0, 1]],
  ['top', 'Top', [0, 0, 1], [0, 1, 0]],
  ['bottom', 'Bottom', [0, 0, -1], [0, -1, 0]],
];
const half = 23; // px

/// Screen y points down: the y component of every world axis is negated.
function faceTransform(normal: Vec, up: Vec): string {
  const right = cross(up, normal);
  const flip = ([x, y, z]: Vec): Vec => [x, -y, z];
  const columns = [flip(right), flip(up.map((v) => -v) as Vec), flip(normal), flip(normal.map((v) => half * v) as Vec)];
  return `matrix3d(${columns.map((c, k) => [...c, k === 3 ? 1 : 0].join(',')).join(',')})`;
}

/// The six sides as a cube that rotates with the view. The same views are under "View" and on the number keys.
export function ViewCube() {
  const cube = useRef<HTMLDivElement>(null);
  const axes = useRef<SVGSVGElement>(null);
  useEffect(
    () =>
      void onDrawn((_, camera) => {
        const m = camera.matrixWorldInverse.elements;
        if (cube.current)
          cube.current.style.transform = `matrix3d(${[m[0], -m[1], m[2], 0, -m[4], m[5], -m[6], 0, m[8], -m[9], m[10], 0, 0, 0, 0, 1].join(',')})`;
        // Axes from the lower corner of the cube.
        [0, 1, 2].forEach((k) => {
          const place = (p: Vec) => [0, 1].map((row) => 60 + (row ? -1 : 1) * (m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2]));
          const corner: Vec = [-half, -half, -half];
          const end = corner.map((v, i) => v + (i === k ? 2.75 * half : 0)) as Vec;
          const [[x1, y1], [x2, y2]] = [place(corner), place(end)];
          const line = axes.current?.children[2 * k];
          const name = axes.current?.children[2 * k + 1];
          for (const [key, v] of Object.entries({ x1, y1, x2, y2 })) line?.setAttribute(key, v.toFixed(1));
          name?.setAttribute('x', (x2 + 0.14 * (x2 - x1)).toFixed(1));
          name?.setAttribute('y', (y2 + 0.14 * (y2 - y1)).toFixed(1));
        });
      }),
    [],
  );
  return (
    <div class="view-cube" aria-hidden="true" data-testid="view-cube">
      <svg ref={axes} viewBox="0 0 120 120">
        {['x', 'y', 'z'].flatMap((name) => [<line key={name} class={`axis ${name}`} />, <text key={`${name}t`} class={`axis ${name}`}>{name}</text>])}
      </svg>
      <div class="cube" ref={cube}>
        {faces.map(([side, label, normal, up]) => (
          <button key={side} tabIndex={-1} style={{ transform: faceTransform(normal, up) }} onClick={() => theView.value?.lookAt(side)}>
            {label}
          </button>
        ))}
      </div>
    </div>
  );
}

export function ScaleBar() {
  const bar = useRef<HTMLDivElement>(null);
  useEffect(
    () =>
      void onDrawn(() => {
        const perMm = theView.peek()?.pixelsPerMm ?? 1;
        const mm = niceBelow(130 / perMm);
        if (!bar.current) return;
        bar.current.style.width = `${mm * perMm}px`;
        bar.current.textContent = mm < 1 ? `${+(1000 * mm).toPrecision(3)} µm` : `${+mm.toPrecision(3)} mm`;
      }),
    [],
  );
  return <div class="scale-bar" ref={bar} data-testid="scale-bar" />;
}

/// Drags the section plane along its axis; arrow keys do the same.
export function SectionHandle() {
  const handle = useRef<HTMLDivElement>(null);
  const axis = look.sectionAxis.value;
  const along = useRef<[number, number]>([1, 0]); // screen vector in pixels from one end of the robot to the other
  useEffect(() => {
    if (!axis) return;
    const stop = onDrawn((project) => {
      const place = theView.peek()?.sectionPlace;
      if (!place || !handle.current) return;
      const at = (v: number) => project(place.centre.clone().setComponent(place.axis, v).toArray() as Vec);
      const [x, y] = project(place.centre.toArray() as Vec);
      const [low, high] = [at(place.low), at(place.high)];
      along.current = [high[0] - low[0], high[1] - low[1]];
      handle.current.style.transform = `translate(${x}px, ${y}px) rotate(${Math.atan2(along.current[1], along.current[0])}rad)`;
    });
    return () => void stop();
  }, [axis]);
  if (!axis) return null;
  const set = (v: number) => (look.sectionAt.value = Math.min(Math.max(v, 0), 1));
  const drag = (e: PointerEvent) => {
    const [dx, dy] = along.current;
    const square = dx * dx + dy * dy;
    if (e.buttons & 1 && square > 25) set(look.sectionAt.peek() + (e.movementX * dx + e.movementY * dy) / square);
  };
  return (
    <div
      ref={handle}
      class="section-handle"
      role="slider"
      tabIndex={0}
      aria-label={`Section across ${axis}`}
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={Math.round(100 * look.sectionAt.value)}
      aria-valuetext={`${Math.round(100 * look.sectionAt.value)} % of the way along ${axis}`}
      data-testid="section-handle"
      onPointerDown={(e) => e.currentTarget.setPointerCapture(e.pointerId)}
      onPointerMove={drag}
      onKeyDown={(e) => {
        const step = { ArrowRight: 0.01, ArrowUp: 0.01, ArrowLeft: -0.01, ArrowDown: -0.01, PageUp: 0.1, PageDown: -0.1 }[e.key];
        if (step === undefined) return;
        e.preventDefault();
        set(look.sectionAt.peek() + step);
      }}
    />
  );
}

const subtract = (a: Vec, b: Vec): Vec => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const length = (v: Vec) => Math.hypot(...v);
function angle(a: Vec, at: Vec, b: Vec): number {
  const [u, v] = [subtract(a, at), subtract(b, at)];
  return (Math.atan2(length(cross(u, v)), u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) * 180) / Math.PI;
}

/// Two points give a distance, three an angle at the middle one. They move with the robot.
export function Measure() {
  frame.value; // measured values change with the frame
  look.shownFrame.value;
  if (!look.measuring.value) return null;
  const markers = scene.value?.head.markers ?? [];
  const picks = look.picks.value;
  const places = picks.map((p) => theView.value?.placeOfPick(p)?.toArray() as Vec | undefined).filter((p) => p !== undefined);
  const name = (p: look.Pick) => ('marker' in p ? markers[p.marker]?.name : 'point of the surface');
  const [a, b, c] = places;
  const pickMarker = (k: number, value: string) => {
    const next = picks.slice();
    next[k] = { marker: Number(value) };
    look.picks.value = next.filter((p) => p !== undefined);
  };
  return (
    <section class="measure card" aria-label="Measure" data-testid="measure">
      <div class="row">
        <b>Measure</b>
        <button class="bare" aria-label="Stop measuring" onClick={() => ((look.measuring.value = false), (look.picks.value = []))}>
          <Icon name="close" />
        </button>
      </div>
      {a && b ? (
        <table>
          <tbody>
            {c ? (
              <>
                <tr data-testid="measured-angle"><th>angle</th><td>{angle(a, b, c).toFixed(2)}°</td></tr>
                <tr><th>first to second</th><td>{length(subtract(b, a)).toFixed(3)} mm</td></tr>
                <tr><th>second to third</th><td>{length(subtract(c, b)).toFixed(3)} mm</td></tr>
              </>
            ) : (
              <>
                <tr data-testid="measured-distance"><th>distance</th><td>{length(subtract(b, a)).toFixed(3)} mm</td></tr>
                <tr><th>along x, y, z</th><td>{subtract(b, a).map((v) => v.toFixed(3)).join(', ')} mm</td></tr>
              </>
            )}
          </tbody>
        </table>
      ) : (
        <p class="quiet">Click two points of the robot for a distance, three for an angle. A marker is taken if it is near.</p>
      )}
      {picks.map((p, k) => (
        <p class="quiet" key={k}>{k + 1}: {name(p)}</p>
      ))}
      {markers.length > 1 && (
        <div class="row left wrap">
          {[0, 1].map((k) => (
            <select key={k} aria-label={k ? 'to marker' : 'from marker'} data-testid={`measure-marker-${k}`} value="" onChange={(e) => pickMarker(k, e.currentTarget.value)}>
              <option value="" disabled>{k ? 'to marker' : 'from marker'}</option>
              {markers.map((m, i) => <option value={i} key={m.name}>{m.name}</option>)}
            </select>
          ))}
        </div>
      )}
      {picks.length > 0 && <button class="small" onClick={() => (look.picks.value = [])}>Clear</button>}
    </section>
  );
}

/// A fourth point starts a new measurement.
export function takePick(pick: look.Pick) {
  look.picks.value = look.picks.value.length >= 3 ? [pick] : [...look.picks.value, pick];
}
