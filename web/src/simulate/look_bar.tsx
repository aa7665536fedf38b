// Buttons over the view: colours, mesh, section, measuring.
import { useState } from 'preact/hooks';
import { ViewMenu } from './stage_tools';
import * as look from './view_state';

function Toggle({ on, label }: { on: typeof look.ghost; label: string }) {
  return (
    <button class="chip" aria-pressed={on.value} onClick={() => (on.value = !on.value)}>
      {label}
    </button>
  );
}

export function LookBar() {
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
      <button class="chip" aria-pressed={more || look.sectionAxis.value !== ''} aria-expanded={more} onClick={() => {
          setMore(!more);
          look.measuring.value = false; // both would lie over the same place
        }}>
        Section
      </button>
      <ViewMenu />
      <button
        class="chip"
        aria-pressed={look.measuring.value}
        data-testid="measure-toggle"
        onClick={() => {
          look.measuring.value = !look.measuring.value;
          setMore(false);
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
