// Exposure of each material from the next layer on, and layers to skip, during a print.
import { useState } from 'preact/hooks';
import { NumberField } from '../number_field';
import { flags, host, info, maySteer, now } from './state';

/// Exposure of each material from the next layer on, and layers to skip.
export function Exposure() {
  const n = now.value!;
  const i = info.value!;
  const [skip, setSkip] = useState('');
  if (!flags.value.printing && !flags.value.paused) return null;
  return (
    <details class="block fold" data-testid="light">
      <summary>Adjust exposure</summary>
      <p class="quiet">Of a normal layer, from the next layer on. Bottom layers and others with their own exposure change by the same factor.</p>
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
