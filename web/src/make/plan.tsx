// What the print needs: time, swaps, resin; one swap and the whole job as bars; comparison of material orders and
// printers.
import { useEffect, useState } from 'preact/hooks';
import { millilitres } from '../counted';
import { api, say } from '../store';
import type { Job, Plan } from '../types';
import { Gantt } from './gantt';

export function clock(seconds: number): string {
  const s = Math.round(seconds);
  const h = Math.floor(s / 3600);
  const two = (n: number) => String(n).padStart(2, '0');
  return `${h}:${two(Math.floor(s / 60) % 60)}:${two(s % 60)}`;
}

const kinds = [
  { key: 'expose', label: 'expose', colour: 'var(--c-expose)' },
  { key: 'move', label: 'move', colour: 'var(--c-move)' },
  { key: 'swap', label: 'swap', colour: 'var(--c-swap)' },
  { key: 'clean', label: 'clean', colour: 'var(--c-clean)' },
] as const;

function Figures({ plan }: { plan: Plan }) {
  const total = plan.seconds.total;
  return (
    <>
      <div class="figures">
        <div>
          <b>{clock(total)}</b>
          <span>total</span>
        </div>
        <div>
          <b>{plan.swaps}</b>
          <span>{plan.swaps === 1 ? 'swap' : 'swaps'}, minimum {plan.swap_lower_bound}</span>
        </div>
        <div>
          <b>{millilitres(Object.values(plan.resin_ml).reduce((a, b) => a + b, 0))}</b>
          <span>resin, {millilitres(plan.waste_ml)} wasted</span>
        </div>
        <div>
          <b>{plan.solvent_ml.toFixed(0)} ml</b>
          <span>cleaning solution used up</span>
        </div>
      </div>
      <div class="share" role="img" aria-label={kinds.map((k) => `${k.label} ${clock(plan.seconds[k.key])}`).join(', ')}>
        {kinds.map((k) => (
          <div style={{ flexGrow: plan.seconds[k.key] || 0.0001, background: k.colour }} title={`${k.label} ${clock(plan.seconds[k.key])}`} />
        ))}
      </div>
      <ul class="keys-list">
        {kinds.map((k) => (
          <li>
            <span class="swatch" style={{ background: k.colour }} />
            {k.label} <b>{clock(plan.seconds[k.key])}</b>
          </li>
        ))}
      </ul>
    </>
  );
}

/// Time of each layer as bars from left to right, grouped if there are too many.
function LayerTimes({ plan }: { plan: Plan }) {
  const n = plan.layers;
  const bins = Math.min(n, 160);
  const sums = Array.from({ length: bins }, (_, b) => {
    const from = Math.floor((b * n) / bins);
    const to = Math.max(from + 1, Math.floor(((b + 1) * n) / bins));
    const mean = (list: number[]) => list.slice(from, to).reduce((a, x) => a + x, 0) / (to - from);
    return kinds.map((k) => mean(plan.layer_seconds[k.key]));
  });
  const most = Math.max(...sums.map((s) => s.reduce((a, b) => a + b, 0)), 1e-9);
  return (
    <figure class="chart">
      <figcaption>
        Time per layer <span class="quiet">from the platform up; maximum {most.toFixed(0)} s</span>
      </figcaption>
      <svg viewBox={`0 0 ${bins} 40`} preserveAspectRatio="none" class="bars" role="img" aria-label={`Time of each layer, at most ${most.toFixed(0)} s`}>
        {sums.map((s, b) => {
          let y = 40;
          return s.map((v, k) => {
            const h = (40 * v) / most;
            y -= h;
            return <rect x={b} y={y} width={0.86} height={h} fill={kinds[k].colour} />;
          });
        })}
      </svg>
    </figure>
  );
}

/// Which vat prints what: one row per vat, layers from left to right.
function VatRows({ job, plan }: { job: Job; plan: Plan }) {
  return (
    <figure class="chart">
      <figcaption>Vat use by layer</figcaption>
      {plan.vats.map((vat) => {
        const runs: [number, number][] = [];
        plan.order.forEach((slots, l) => {
          if (!slots.includes(vat.slot)) return;
          const last = runs[runs.length - 1];
          if (last && last[1] === l) last[1] = l + 1;
          else runs.push([l, l + 1]);
        });
        return (
          <div class="vat-row">
            <span>
              slot {vat.slot} <span class="quiet">{vat.resin}</span>
            </span>
            <svg viewBox={`0 0 ${plan.layers} 10`} preserveAspectRatio="none" role="img" aria-label={`Layers with ${vat.resin}`}>
              <rect width={plan.layers} height={10} class="rail" />
              {runs.map(([a, b]) => (
                <rect x={a} width={b - a} height={10} fill={job.colours[vat.materials[0]] ?? 'var(--accent)'} />
              ))}
            </svg>
            <span>
              {millilitres(plan.resin_ml[String(vat.slot)] ?? 0)}{vat.refill && <em> to be filled</em>}
            </span>
          </div>
        );
      })}
    </figure>
  );
}

function Swap({ job }: { job: Job }) {
  const s = job.swap;
  if (!s || s.stretches.length === 0) return null;
  return (
    <figure class="chart">
      <figcaption>
        Longest swap <span class="quiet">slot {s.from} to {s.to}, {s.seconds.toFixed(1)} s</span>
      </figcaption>
      {s.devices.map((device) => (
        <div class="gantt-row">
          <span>{device}</span>
          <svg viewBox={`0 0 ${s.seconds} 10`} preserveAspectRatio="none" role="img" aria-label={`When ${device} works`}>
            <rect width={s.seconds} height={10} class="rail" />
            {s.stretches
              .filter((x) => x.device === device)
              .map((x) => (
                <rect x={x.begin} width={Math.max(x.end - x.begin, s.seconds / 500)} height={10} class="stretch">
                  <title>{`${device}: ${x.begin.toFixed(1)} to ${x.end.toFixed(1)} s`}</title>
                </rect>
              ))}
          </svg>
        </div>
      ))}
      <div class="gantt-row scale">
        <span />
        <div>
          {[0, 0.25, 0.5, 0.75, 1].map((t) => (
            <span>{(t * s.seconds).toFixed(0)} s</span>
          ))}
        </div>
      </div>
    </figure>
  );
}

interface Row {
  file: string;
  printer: string;
  error?: string;
  swaps?: number;
  total_s?: number;
  waste_ml?: number;
}

function Compare({ job, plan }: { job: Job; plan: Plan }) {
  const [rows, setRows] = useState<Row[]>([]);
  useEffect(() => {
    api('/api/job/compare')
      .then((r) => r.json())
      .then(setRows)
      .catch((e: Error) => say(e.message));
  }, [job.revision]);
  const names: Record<string, string> = { naive: 'as listed', thesis: 'thesis rule', 'least-cost': 'minimum time' };
  return (
    <div class="tables">
      <table>
        <caption>Vat order</caption>
        <thead>
          <tr>
            <th>order</th>
            <th>swaps</th>
            <th>swap time</th>
          </tr>
        </thead>
        <tbody>
          {Object.entries(plan.orders).map(([rule, cost]) => (
            <tr class={rule === plan.order_rule ? 'chosen' : ''}>
              <td>{names[rule] ?? rule}</td>
              <td>{cost.swaps}</td>
              <td>{clock(cost.change_s)}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <table>
        <caption>The same job on other printers</caption>
        <thead>
          <tr>
            <th>printer</th>
            <th>swaps</th>
            <th>time</th>
            <th>wasted</th>
          </tr>
        </thead>
        <tbody>
          {rows.map((r) => (
            <tr title={r.error} class={r.printer === job.printer ? 'chosen' : ''}>
              <td>{r.file.replace(/_/g, ' ')}</td>
              {r.error ? (
                <td colSpan={3} class="quiet">
                  {/projector/.test(r.error) ? 'different projector: slice again for this printer' : 'cannot print this job'}
                </td>
              ) : (
                <>
                  <td>{r.swaps}</td>
                  <td>{clock(r.total_s ?? 0)}</td>
                  <td>{millilitres(r.waste_ml ?? 0)}</td>
                </>
              )}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

export function PlanView({ job }: { job: Job }) {
  if (!job.plan) return <p class="problems">{job.plan_error}</p>;
  return (
    <div class="plan" data-testid="plan">
      <Figures plan={job.plan} />
      <LayerTimes plan={job.plan} />
      <VatRows job={job} plan={job.plan} />
      <Gantt job={job} plan={job.plan} />
      <Swap job={job} />
      <Compare job={job} plan={job.plan} />
      {job.plan.warnings.map((w) => (
        <p class="quiet">{w}</p>
      ))}
    </div>
  );
}
