// The colour legend, and its settings.
import { useRef, useState } from 'preact/hooks';
import { useDismiss } from '../dismiss';
import { NumberField } from '../number_field';
import { scene } from '../store';
import { gradientCss, maps } from './colormap';
import { tickText } from './fit';
import * as look from './view_state';

function Materials() {
  return (
    <ul class="legend materials-legend">
      {scene.value?.head.materials.map((m) => (
        <li key={m.name}>
          <span class="swatch" style={{ background: m.colour }} />
          {m.name}
        </li>
      ))}
      {scene.value?.head.graded.map((g) => {
        const [a, b] = [g.material, g.other].map((m) => scene.value!.head.materials[m]);
        return (
          <li key={`graded ${g.body}`} data-testid={`graded-${g.body}`}>
            <span class="swatch wide" style={{ background: `linear-gradient(to right, ${a.colour}, ${b.colour})` }} />
            {g.body}: {a.name} to {b.name}
          </li>
        );
      })}
    </ul>
  );
}

function Settings({ f }: { f: (typeof look.fieldNames)[number] }) {
  const [low, high] = look.fieldRange.value;
  const fixed = look.fixedRange.value;
  const set = (l: number, h: number) => {
    if (!(h > l)) return false;
    look.fixedRange.value = { field: f.name, low: l, high: h };
    return true;
  };
  const shown = (v: number) => +v.toPrecision(5);
  const field = (label: string, id: string, value: number, range: { from: number; to: number }, take: (v: number) => boolean) => (
    <label class="row">
      {label}
      <NumberField value={shown(value)} range={{ ...range, open: true }} unit={f.unit} testId={id} onValue={take} />
    </label>
  );
  return (
    <div class="popover legend-settings" data-testid="legend-settings">
      <label>
        Colours
        <select value={look.map.value} data-testid="colour-map" onChange={(e) => (look.map.value = e.currentTarget.value)}>
          {Object.entries(maps).map(([name, m]) => (
            <option value={name} key={name}>
              {m.label}
            </option>
          ))}
        </select>
      </label>
      <label>
        Bands
        <select value={look.bands.value} data-testid="colour-bands" onChange={(e) => (look.bands.value = Number(e.currentTarget.value))}>
          <option value={0}>continuous</option>
          {[5, 8, 10, 16].map((n) => (
            <option value={n} key={n}>
              {n}
            </option>
          ))}
        </select>
      </label>
      {field('Maximum', 'range-high', high, { from: shown(low), to: Infinity }, (v) => set(low, v))}
      {field('Minimum', 'range-low', low, { from: -Infinity, to: shown(high) }, (v) => set(v, high))}
      <button class="small" disabled={!fixed} onClick={() => (look.fixedRange.value = null)} data-testid="range-auto">
        Fit range to data
      </button>
    </div>
  );
}

export function Legend() {
  const [open, setOpen] = useState(false);
  const box = useRef<HTMLDivElement>(null);
  useDismiss(open, () => setOpen(false), box);
  const f = look.fieldNames.find((n) => n.name === look.field.value)!;
  if (f.name === 'material') return <Materials />;
  const [low, high] = look.fieldRange.value;
  return (
    <div class="legend" ref={box} data-testid="legend">
      <button class="field-legend" aria-expanded={open} aria-label={`Legend of ${f.label}: colours and range`} onClick={() => setOpen(!open)} data-testid="legend-button">
        <span class="bar" style={{ background: gradientCss(look.map.value, look.bands.value, 'var(--along, to top)') }} />
        <span class="ticks">
          {[1, 0.75, 0.5, 0.25, 0].map((t) => (
            <span key={t}>{tickText(low + t * (high - low), (high - low) / 4)}</span>
          ))}
        </span>
        <span class="what">
          {f.label}
          {f.unit && <span class="quiet"> {f.unit}</span>}
        </span>
      </button>
      {open && <Settings f={f} />}
    </div>
  );
}
