// Manual control of a machine that stands still.
import { useState } from 'preact/hooks';
import { Icon } from '../icons';
import { flags, host, info, maySteer, now } from './state';

export function ByHand() {
  const m = info.value!.machine!;
  const n = now.value!;
  const ready = flags.value.ready && maySteer.value;
  const [step, setStep] = useState(5);
  return (
    <section class="block">
      <h3>Manual control</h3>
      <div class="axes">
        {Object.keys(m.axes).map((axis) => (
          <div class="axis" key={axis}>
            <span>
              {axis}
              {!n.machine.axes[axis]?.homed && <em> not homed</em>}
            </span>
            <output>{(n.machine.axes[axis]?.position ?? 0).toFixed(2)}</output>
            <button class="bare" aria-label={`Move ${axis} by −${step}`} disabled={!ready} onClick={() => host('printer/axes', { command: 'jog', [axis]: -step })}>
              <Icon name="left" />
            </button>
            <button class="bare" aria-label={`Move ${axis} by +${step}`} disabled={!ready} onClick={() => host('printer/axes', { command: 'jog', [axis]: step })}>
              <Icon name="right" />
            </button>
          </div>
        ))}
      </div>
      <div class="row left wrap">
        <span class="segments" role="group" aria-label="Step">
          {[0.1, 1, 5, 20].map((s) => (
            <button aria-pressed={step === s} onClick={() => setStep(s)}>
              {s} mm
            </button>
          ))}
        </span>
        <button class="small" disabled={!ready} data-testid="home" onClick={() => host('printer/axes', { command: 'home' })}>
          Home all
        </button>
        <button class="small" disabled={!ready} onClick={() => host('printer/clean', { seconds: 15 })}>
          Clean 15 s
        </button>
        <button class="small" disabled={!ready} onClick={() => host('printer/prime', { seconds: 10 })}>
          Prime the pump
        </button>
      </div>
      <div class="row left wrap">
        {m.vats.map((v) => (
          <button class="small" disabled={!ready || n.machine.slot === v.slot} onClick={() => host('printer/vat', { slot: v.slot })} title={v.resin}>
            Vat {v.slot}
          </button>
        ))}
        <button class="small" disabled={!ready || n.machine.slot === 0} onClick={() => host('printer/vat', { slot: 0 })}>
          Return the vat
        </button>
      </div>
    </section>
  );
}
