// From robot to job: slicing, layers, plan.
import { signal } from '@preact/signals';
import { useEffect, useRef, useState } from 'preact/hooks';
import { counted } from '../counted';
import { Icon } from '../icons';
import { job, mayDrive, post, say, slicing } from '../store';
import { Bed } from './bed';
import { Compare } from './compare';
import { jobFileName } from './file_name';
import { goal, Layers, layer } from './layers';
import { SliceForm } from './slice_form';
import { clock, PlanView } from './plan';
import { Stack } from './stack';
import { changes, staleText } from './stale';
import { UnderWay } from './under_way';

/// Before slicing the robot is shown on the platform.
const tabs = ['bed', 'layers', 'stack', 'plan', 'compare'] as const;
const tab = signal<(typeof tabs)[number]>('layers');

/// Arrow keys, Home and End switch tabs.
function walk(e: KeyboardEvent) {
  const at = tabs.indexOf(tab.value);
  const to = { ArrowRight: (at + 1) % tabs.length, ArrowLeft: (at + tabs.length - 1) % tabs.length, Home: 0, End: tabs.length - 1 }[e.key];
  if (to === undefined) return;
  e.preventDefault();
  tab.value = tabs[to];
  (e.currentTarget as HTMLElement).querySelectorAll<HTMLElement>('[role=tab]')[to].focus();
}

function Issues() {
  const j = job.value!;
  const warnings = j.plan?.warnings ?? [];
  const count = j.issues.length + warnings.length;
  return (
    <div class="issues" data-testid="issues">
      <h3>{count ? counted(count, 'issue') : 'No issues found'}</h3>
      {warnings.map((text) => (
        <button class="issue" key={text} onClick={() => (tab.value = 'plan')}>
          <Icon name="warn" />
          <span>{text}</span>
        </button>
      ))}
      {j.issues.map((issue) => (
        <button
          class={`issue ${issue.severity ?? ''}`}
          disabled={issue.layer < 0}
          onClick={() => {
            tab.value = 'layers';
            layer.value = Math.min(issue.layer, j.manifest.layers.length - 1);
            goal.value = issue.row === undefined ? null : { row: issue.row, column: issue.column ?? 0 };
          }}
        >
          <Icon name="warn" />
          <span>{issue.text}</span>
          {issue.layer >= 0 && (
            <span class="quiet">
              {issue.severity && `${issue.severity} severity, `}layer {issue.layer + 1}
            </span>
          )}
        </button>
      ))}
      {count === 0 && (
        <p class="quiet">
          <Icon name="check" /> No unsupported islands, no trapped resin, no loose pieces.
        </p>
      )}
    </div>
  );
}

/// What people ask first: how long it takes.
function Summary() {
  const { manifest, plan } = job.value!;
  if (!plan) return null;
  return (
    <p class="job-summary" data-testid="job-summary">
      <b>{clock(plan.seconds.total)}</b> <span class="quiet">{counted(manifest.layers.length, 'layer')}, {counted(plan.swaps, 'swap')}</span>
    </p>
  );
}

function Volumes() {
  const j = job.value!;
  return (
    <table class="volumes">
      <tbody>
        {j.manifest.materials.map((m, k) => (
          <tr>
            <th>
              <span class="swatch" style={{ background: j.colours[k] }} />
              {m.name}
            </th>
            <td class="quiet">{m.resin}</td>
            <td>{(m.model_volume_mm3 / 1000).toFixed(2)} ml</td>
            <td>{m.exposure_s} s</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/// The job does not belong to the robot and the form as they are.
function Stale() {
  if (changes.value.length === 0) return null;
  return (
    <div class="prompt" role="status" data-testid="stale">
      <Icon name="warn" />
      <span>
        {staleText(changes.value)}{' '}
        <button class="small" form="slice-form" disabled={!mayDrive.value || slicing.value !== null}>
          Slice again
        </button>
      </span>
    </div>
  );
}

export function Make() {
  const j = job.value;
  const [typed, setName] = useState<string | null>(null);
  const name = typed ?? (j ? jobFileName(j.manifest.name) : '');
  const stage = useRef<HTMLElement>(null);
  const known = useRef(j?.revision);
  const seen = (slicing.value?.layers ?? 0) > 0; // some layers can be viewed before the job is complete
  useEffect(() => {
    // If form and layers are stacked vertically, scroll to a new job.
    if (j && j.revision !== known.current && window.matchMedia('(max-width: 900px)').matches) stage.current?.scrollIntoView({ behavior: 'smooth' });
    // After slicing, show the result.
    if (j && j.revision !== known.current && tab.value === 'bed') tab.value = 'layers';
    known.current = j?.revision;
  }, [j?.revision]);
  return (
    <main class="make">
      <h2 class="unseen">Prepare</h2>
      <aside class="side left">
        <SliceForm />
        {j && (
          <>
            <Stale />
            <Summary />
            <Volumes />
            <Issues />
            <div class="job-file">
              <a class="button" href="/api/job/file" download>
                <Icon name="download" /> Job file
              </a>
              <form
                onSubmit={async (e) => {
                  e.preventDefault();
                  if (await post('/api/job/save', { name })) say(`Saved ${name}`);
                }}
              >
                <input aria-label="Name of the job file" value={name} onInput={(e) => setName(e.currentTarget.value)} />
                <button class="small" disabled={!name || !mayDrive.value}>
                  Save
                </button>
              </form>
            </div>
          </>
        )}
      </aside>
      <section class="stage" ref={stage}>
        {j ? (
          <>
            <div class="tabs floating" role="tablist" aria-label="Views of the job" onKeyDown={walk}>
              {tabs.map((t) => (
                <button role="tab" tabIndex={tab.value === t ? 0 : -1} aria-selected={tab.value === t} onClick={() => (tab.value = t)} data-testid={`make-${t}`}>
                  {{ bed: 'Placement', layers: 'Layers', stack: '3D', plan: 'Plan', compare: 'Compare' }[t]}
                </button>
              ))}
              {changes.value.length > 0 && tab.value !== 'bed' && (
                <span class="out-of-date" data-testid="out-of-date">
                  <Icon name="warn" /> out of date
                </span>
              )}
            </div>
            {tab.value === 'bed' && !seen && <Bed />}
            {tab.value === 'layers' && !seen && <Layers key={j.revision} job={j} />}
            {(tab.value === 'bed' || tab.value === 'layers') && seen && <UnderWay />}
            {tab.value === 'stack' && <Stack key={j.revision} job={j} openLayers={() => (tab.value = 'layers')} />}
            {tab.value === 'plan' && <PlanView key={j.revision} job={j} />}
            {tab.value === 'compare' && <Compare key={j.revision} job={j} />}
          </>
        ) : seen ? (
          <UnderWay />
        ) : (
          <Bed />
        )}
      </section>
    </main>
  );
}
