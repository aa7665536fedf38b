// The machine in 3D, and the image that is exposed.
import { useEffect, useRef, useState } from 'preact/hooks';
import { orbitHelp } from '../orbit_keys';
import { theme } from '../theme';
import { enlarged } from './enlarged';
import { MachineView } from './machine_view';
import { followPart, part } from './part';
import { info, known, now } from './state';

export function Picture() {
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

export function Machine3D() {
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
