// The slicing form: the options of `pliant slice` in groups. Errors are shown at their fields.
import type { ComponentChildren } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import { counted } from '../counted';
import { Icon } from '../icons';
import { NumberField } from '../number_field';
import { api, documentState, mayDrive, post, say, scene, sliceError, slicing } from '../store';
import { keyOf } from '../simulate/toml_edit';
import { useEstimate } from './estimate';
import { anyVat, type Bond, bonds, commas, copies, fields, forgetProblem, type Light, lights, orderJson, plainPixels, printer, type PrinterInfo, printerInfo, problem, scale, shift, support, turn, unitOf, wholeOrder, wrong } from './order';
import { strokes } from './paint';
import { labels } from './wrong';

function Problem({ option }: { option: string }) {
  if (wrong.value?.option !== option) return null;
  return (
    <p class="problems at-field" role="alert" data-testid={`wrong-${option}`}>
      {wrong.value.text}
    </p>
  );
}

function Field({ option, label, hint, title }: { option: string; label: string; hint?: string; title?: string }) {
  const bad = wrong.value?.option === option;
  const unit = { um: 'µm', mm: 'mm', '': '' }[unitOf[option] ?? 'mm'];
  return (
    <>
      <label title={title}>
        {label}
        <span class="number">
          <input
            inputMode="decimal"
            class="short"
            placeholder={hint}
            value={fields.value[option] ?? ''}
            aria-invalid={bad}
            data-testid={`option-${option}`}
            onInput={(e) => {
              fields.value = { ...fields.value, [option]: e.currentTarget.value };
              if (bad || !wrong.value) forgetProblem(); // that of another field stays with it
            }}
          />
          <span class="unit">{option === 'support-angle' ? '°' : unit}</span>
        </span>
      </label>
      <Problem option={option} />
    </>
  );
}

/// A group is open if it contains an error.
function Group({ name, options, given, children }: { name: string; options: string[]; given: boolean; children: ComponentChildren }) {
  const has = wrong.value !== null && options.includes(wrong.value.option);
  const [open, setOpen] = useState(false);
  return (
    <details class="group" open={open || has} onToggle={(e) => setOpen(e.currentTarget.open)} data-testid={`group-${options[0]}`}>
      <summary>
        {name}
        {given && <span class="dot-given" title="changed" />}
      </summary>
      {children}
    </details>
  );
}

/// The colour in which a material is shown, here and in its job: a key of the robot file.
function ColourOf({ material }: { material: string }) {
  const colour = scene.value?.head.materials.find((x) => x.name === material)?.colour ?? '#888888';
  const set = (value: string) => void post('/api/robot/set', { changes: [{ key: keyOf('material', material, 'colour'), value }] });
  return <input type="color" class="colour" aria-label={`Colour of ${material}`} title="Colour in the views, here and in the job" value={colour} disabled={!mayDrive.value} onChange={(e) => set(e.currentTarget.value)} data-testid={`colour-of-${material}`} />;
}

function Materials({ materials }: { materials: string[] }) {
  const p = printerInfo.value;
  const resinOf = (m: string) => scene.value?.head.materials.find((x) => x.name === m)?.resin || m;
  const set = (m: string, change: Partial<Light>) => {
    lights.value = { ...lights.value, [m]: { ...(lights.value[m] ?? { resin: '', time: '', bottom: '' }), ...change } };
    forgetProblem();
  };
  return (
    <Group name="Resins, colours and exposure" options={['exposure', 'resin']} given={anyVat.value || Object.values(lights.value).some((l) => l.resin || l.time)}>
      <datalist id="resins">
        {p?.resins.map((r) => (
          <option value={r.name} />
        ))}
      </datalist>
      {materials.map((m, k) => {
        const resin = lights.value[m]?.resin || resinOf(m);
        const known = p?.resins.find((r) => r.name === resin);
        const bad = wrong.value?.option === 'resin' && wrong.value.value === resin;
        return (
          <fieldset class="light-of" key={m}>
            <legend>
              <ColourOf material={m} />
              {m}
            </legend>
            <label>
              <span>Resin</span>
              <input list="resins" aria-label={`Resin of ${m}`} aria-invalid={bad} placeholder={resinOf(m)} value={lights.value[m]?.resin ?? ''} onInput={(e) => set(m, { resin: e.currentTarget.value })} />
            </label>
            <label>
              <span>Exposure (s)</span>
              <input inputMode="decimal" aria-label={`Exposure of ${m}`} data-testid={`light-${k}`} placeholder={known ? `${known.exposure_s}` : ''} value={lights.value[m]?.time ?? ''} onInput={(e) => set(m, { time: e.currentTarget.value })} />
            </label>
            <label>
              <span>Bottom layers (s)</span>
              <input inputMode="decimal" aria-label={`Exposure of the bottom layers of ${m}`} disabled={!lights.value[m]?.time} placeholder={known ? `${known.bottom_exposure_s}` : ''} value={lights.value[m]?.bottom ?? ''} onInput={(e) => set(m, { bottom: e.currentTarget.value })} />
            </label>
          </fieldset>
        );
      })}
      <Problem option="resin" />
      <label class="tick" title="You fill them in before the print; the plan says into which vats">
        <input
          type="checkbox"
          checked={anyVat.value}
          data-testid="option-any-vat"
          onChange={(e) => {
            anyVat.value = e.currentTarget.checked;
            forgetProblem();
          }}
        />
        <span>{labels.anyVat}</span>
      </label>
      <Problem option="exposure" />
      {p && (
        <p class="quiet small-print" data-testid="mask">
          {p.mask ? `The projector mask ${p.mask} is applied to every image.` : 'No projector mask: the light is assumed to be uniform.'}
        </p>
      )}
    </Group>
  );
}

function Bonds({ materials }: { materials: string[] }) {
  const change = (k: number, by: Partial<Bond>) => {
    bonds.value = bonds.value.map((b, i) => (i === k ? { ...b, ...by } : b));
    forgetProblem();
  };
  const pick = (value: string, set: (v: string) => void, label: string) => (
    <select value={value} aria-label={label} onChange={(e) => set(e.currentTarget.value)}>
      {materials.map((m) => (
        <option value={m}>{m}</option>
      ))}
    </select>
  );
  return (
    <Group name="Bonds between materials" options={['overlap', 'interlock']} given={bonds.value.length > 0}>
      {bonds.value.map((b, k) => (
        <div class="bond" key={k}>
          <div class="row">
            {pick(b.a, (a) => change(k, { a }), 'First material')}
            {pick(b.b, (second) => change(k, { b: second }), 'Second material')}
            <button type="button" class="bare" aria-label="Remove" onClick={() => (bonds.value = bonds.value.filter((_, i) => i !== k))}>
              <Icon name="close" />
            </button>
          </div>
          <div class="row left">
            <select value={b.kind} aria-label="Kind" title="overlap: the first material is also exposed within the second; interlock: teeth of both reach into each other" onChange={(e) => change(k, { kind: e.currentTarget.value as Bond['kind'] })}>
              <option value="overlap">overlap</option>
              <option value="interlock">interlock</option>
            </select>
            <label class="inline">
              <input type="number" min={0} max={1000} step={1} aria-label="Depth in pixels" value={b.pixels} onChange={(e) => change(k, { pixels: Number(e.currentTarget.value) })} />
              px
            </label>
            <label class="inline">
              <input type="number" min={b.kind === 'overlap' ? 0 : 1} max={1000} step={1} aria-label="Layers" value={b.layers} onChange={(e) => change(k, { layers: Number(e.currentTarget.value) })} />
              layers
            </label>
          </div>
        </div>
      ))}
      <Problem option="overlap" />
      <Problem option="interlock" />
      {materials.length > 1 ? (
        <button
          type="button"
          class="small"
          data-testid="add-bond"
          onClick={() => (bonds.value = [...bonds.value, { kind: 'overlap', a: materials[0], b: materials[1], pixels: 3, layers: 1 }])}
        >
          Add a bond
        </button>
      ) : (
        <p class="quiet small-print">This robot has only one material.</p>
      )}
    </Group>
  );
}

function Supports({ materials }: { materials: string[] }) {
  return (
    <Group name="Supports" options={['support', 'support-angle', 'support-spacing', 'support-tip', 'support-pillar', 'support-paint', 'lift', 'raft']} given={support.value !== ''}>
      <label>
        Material
        <select value={support.value} data-testid="option-support" onChange={(e) => (support.value = e.currentTarget.value)}>
          <option value="">no supports</option>
          {materials.map((m) => (
            <option value={m}>{m}</option>
          ))}
        </select>
      </label>
      <Problem option="support" />
      {support.value && (
        <>
          <Field option="support-angle" label="Overhang angle" hint="45" title="Undersides flatter than this are supported; 0: islands only" />
          <Field option="support-spacing" label="Max tip spacing" hint="3" />
          <Field option="support-tip" label="Tip diameter" hint="0.4" />
          <Field option="support-pillar" label="Pillar diameter" hint="1" />
          <Field option="lift" label="Lift above platform" hint="0" />
          <Field option="raft" label="Raft thickness" hint="none" />
          <p class="quiet small-print" data-testid="painted">
            {strokes.value.length === 0 ? 'None painted by hand yet: use Paint supports below the 3D view.' : `${counted(strokes.value.length, 'stroke')} painted by hand.`}
          </p>
          <Problem option="support-paint" />
        </>
      )}
    </Group>
  );
}

function Placement() {
  return (
    <Group name="Placement and copies" options={['turn', 'scale', 'at', 'copies', 'spacing']} given={copies.value !== 1 || scale.value !== 1 || shift.value.some((v) => v !== 0) || turn.value.some((t) => t !== 0)}>
      <label>
        Copies
        <input
          type="number"
          min={1}
          max={1000}
          step={1}
          value={copies.value}
          aria-invalid={wrong.value?.option === 'copies'}
          data-testid="option-copies"
          onChange={(e) => {
            e.currentTarget.value ||= '1'; // an emptied field: as before anything was entered
            copies.value = Number(e.currentTarget.value);
          }}
        />
      </label>
      <Problem option="copies" />
      <Field option="spacing" label="Spacing" hint="2" />
      <label>
        Rotation about x, y, z
        <span class="number three">
          {[0, 1, 2].map((k) => (
            <input
              type="number"
              step={15}
              aria-label={`Rotation about ${'xyz'[k]}`}
              value={turn.value[k]}
              onChange={(e) => (turn.value = turn.value.map((t, i) => (i === k ? Number(e.currentTarget.value) : t)) as [number, number, number])}
            />
          ))}
          <span class="unit">°</span>
        </span>
      </label>
      <Problem option="turn" />
      <label>
        Scale
        <NumberField value={Math.round(1e4 * scale.value) / 100} range={{ from: 1, to: 10000 }} unit="%" label="Scale" testId="option-scale" onValue={(v) => void (scale.value = v / 100)} />
      </label>
      <Problem option="scale" />
      <label>
        Position x, y
        <span class="number three">
          {[0, 1].map((k) => (
            <input
              type="number"
              step={1}
              aria-label={`Position ${'xy'[k]} from the middle of the platform`}
              data-testid={`option-at-${'xy'[k]}`}
              value={shift.value[k]}
              onChange={(e) => (shift.value = shift.value.map((v, i) => (i === k ? e.currentTarget.valueAsNumber || 0 : v)) as [number, number])}
            />
          ))}
          <span class="unit">mm</span>
        </span>
      </label>
      <Problem option="at" />
    </Group>
  );
}

function Fine() {
  return (
    <Group name="Layers and pixels" options={['least-layer', 'least-feature', 'threshold']} given={Boolean(fields.value['least-layer'] || fields.value['least-feature']) || plainPixels.value}>
      <Field option="least-layer" label="Adaptive layers, minimum" hint="off" title="Layers get as thin as this where the surface is flat" />
      <Field option="least-feature" label="Warn of walls thinner than" hint="off" />
      <label class="tick">
        <input type="checkbox" checked={plainPixels.value} onChange={(e) => (plainPixels.value = e.currentTarget.checked)} />
        <span>No anti-aliasing</span>
      </label>
      {plainPixels.value && (
        <label>
          Coverage threshold
          <input type="number" min={0.01} max={1} step={0.05} value={fields.value.threshold ?? '0.5'} onChange={(e) => (fields.value = { ...fields.value, threshold: e.currentTarget.value })} />
        </label>
      )}
      <Problem option="threshold" />
    </Group>
  );
}

function Hollow() {
  return (
    <Group name="Hollow" options={['hollow', 'drain']} given={Boolean(fields.value.hollow)}>
      <Field option="hollow" label={labels.wall} hint="solid" />
      <Field option="drain" label="Drain hole diameter" hint="none" />
    </Group>
  );
}

export function SliceForm() {
  const [printers, setPrinters] = useState<string[]>([]);
  useEffect(() => {
    api('/api/project')
      .then((r) => r.json())
      .then((p: { printers: string[] }) => setPrinters(p.printers))
      .catch((e: Error) => say(e.message));
  }, []);
  useEffect(() => {
    api(`/api/printer?name=${encodeURIComponent(printer.value)}`)
      .then((r) => r.json())
      .then((p: PrinterInfo) => (printerInfo.value = p))
      .catch((e: Error) => {
        printerInfo.value = null;
        say(e.message);
      });
  }, [printer.value]);
  const busy = slicing.value;
  const materials = scene.value?.head.materials.map((m) => m.name) ?? [];
  const placed = ['layer', 'least-layer', 'least-feature', 'threshold', 'turn', 'scale', 'at', 'copies', 'spacing', 'hollow', 'drain', 'overlap', 'interlock', 'resin', 'exposure', 'support', 'support-angle', 'support-spacing', 'support-tip', 'support-pillar', 'support-paint', 'lift', 'raft'];
  const elsewhere = problem.value && !(wrong.value && placed.includes(wrong.value.option));
  useEstimate(JSON.stringify(orderJson(materials)), documentState.value.digest, scene.value !== null && mayDrive.value && !busy && !commas.value);
  return (
    <form
      class="slice-form"
      id="slice-form"
      onKeyDown={(e) => {
        // Enter confirms a value, as in any other field of the page; only the button slices.
        if (e.key !== 'Enter' || !(e.target instanceof HTMLInputElement)) return;
        e.preventDefault();
        e.target.dispatchEvent(new Event('change', { bubbles: true }));
      }}
      onSubmit={(e) => {
        e.preventDefault();
        forgetProblem();
        if (commas.value) return;
        // Errors in the order itself are shown at their field too.
        const form = e.currentTarget;
        void post('/api/job/slice', wholeOrder(materials), (text) => {
          sliceError.value = text;
          requestAnimationFrame(() => form.querySelector('[aria-invalid=true], .at-field')?.scrollIntoView({ block: 'center' }));
        });
      }}
    >
      <label>
        Printer
        <select value={printer.value} onChange={(e) => (printer.value = e.currentTarget.value)} data-testid="printer">
          {printers.map((p) => (
            <option value={p}>{p.replace(/_/g, ' ').replace(/\.toml$/, '')}</option>
          ))}
        </select>
      </label>
      <Field option="layer" label="Layer height" hint={printerInfo.value ? String(printerInfo.value.layer_um) : ''} title="Left empty: the layer height of the printer file, for which its exposures are" />
      <div class="groups">
        <Placement />
        <Materials materials={materials} />
        <Bonds materials={materials} />
        <Supports materials={materials} />
        <Hollow />
        <Fine />
      </div>
      {busy ? (
        <button type="button" onClick={() => post('/api/job/cancel')} data-testid="cancel-slice">
          Cancel
        </button>
      ) : (
        <button class="primary" disabled={!mayDrive.value || !scene.value} data-testid="slice">
          Slice {scene.value?.head.robot ?? 'the robot'}
        </button>
      )}
      {busy && (
        <div class="progress" role="progressbar" aria-valuenow={Math.round(100 * busy.fraction)} aria-valuemin={0} aria-valuemax={100}>
          <div style={{ width: `${100 * busy.fraction}%` }} />
          <span>{busy.stage}</span>
        </div>
      )}
      {elsewhere && (
        <p class="problems" role="alert" data-testid="slice-problem">
          {problem.value}
        </p>
      )}
      {documentState.value.unsaved && <p class="quiet">The robot is sliced with its unsaved changes.</p>}
    </form>
  );
}
