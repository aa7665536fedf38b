// The print queue. A person must remove each part, so that no print starts by itself.
import { signal } from '@preact/signals';
import { useEffect, useState } from 'preact/hooks';
import { counted } from '../counted';
import { Icon } from '../icons';
import { clock } from '../make/plan';
import { api, job, mayDrive, onEvent, post, say } from '../store';
import { busy, flags, info, known, now } from './state';

interface Waiting {
  name: string;
  error?: string;
  title?: string;
  printer?: string;
  layers?: number;
  seconds?: number;
}

export const queue = signal<string[]>([]);
onEvent((event) => {
  if (event.type === 'queue') queue.value = event.jobs as string[];
});

const set = (jobs: string[]) => post('/api/print/queue', { jobs });

/// Details of each job; the names are available at once.
function useLines(): Waiting[] {
  const [lines, setLines] = useState<Waiting[]>([]);
  const names = queue.value;
  useEffect(() => {
    let gone = false;
    if (names.length)
      api('/api/print/queue')
        .then((r) => r.json())
        .then((q: { jobs: Waiting[] }) => gone || setLines(q.jobs))
        .catch((e: Error) => say(e.message));
    return () => {
      gone = true;
    };
  }, [JSON.stringify(names)]);
  return names.map((name) => lines.find((l) => l.name === name) ?? { name });
}

export function Queue() {
  const lines = useLines();
  const j = job.value;
  const here = j?.saved ? j.file : '';
  const move = (k: number, by: number) => {
    const jobs = [...queue.value];
    jobs.splice(k + by, 0, ...jobs.splice(k, 1));
    void set(jobs);
  };
  if (lines.length === 0 && !here) return null;
  const total = lines.reduce((sum, l) => sum + (l.seconds ?? 0), 0);
  return (
    <section class="card wide-card" data-testid="queue">
      <div class="row">
        <h3>Print queue</h3>
        {here && (
          <button class="small" disabled={!mayDrive.value} onClick={() => void set([...queue.value, here])} data-testid="queue-add">
            Add {here}
          </button>
        )}
      </div>
      {lines.length === 0 ? (
        <p class="quiet">The queue is empty. Jobs are printed one after another; you start each one after removing the previous part.</p>
      ) : (
        <>
          <ol class="queue">
            {lines.map((l, k) => (
              <li key={`${l.name}${k}`} data-testid="queued">
                <span>
                  <b>{l.name.replace(/\.zip$/, '')}</b>
                  <span class="quiet">
                    {l.error ?? (l.layers === undefined ? '' : `${counted(l.layers, 'layer')}${l.seconds ? `, ${clock(l.seconds)}` : ''}, ${l.printer}`)}
                  </span>
                </span>
                <button class="bare" disabled={!mayDrive.value || k === 0} aria-label={`Move ${l.name} up`} onClick={() => move(k, -1)}>
                  <Icon name="up" />
                </button>
                <button class="bare" disabled={!mayDrive.value || k === lines.length - 1} aria-label={`Move ${l.name} down`} onClick={() => move(k, 1)}>
                  <Icon name="down" />
                </button>
                <button class="small" disabled={!mayDrive.value || l.name === here || Boolean(l.error)} onClick={() => post('/api/open', { name: l.name })} data-testid="queue-open">
                  {l.name === here ? 'Current' : 'Open'}
                </button>
                <button class="bare" disabled={!mayDrive.value} aria-label={`Remove ${l.name} from the queue`} onClick={() => void set(queue.value.filter((_, i) => i !== k))}>
                  <Icon name="close" />
                </button>
              </li>
            ))}
          </ol>
          {lines.length > 1 && total > 0 && <p class="quiet small-print">{clock(total)} in total, not counting the time between prints.</p>}
        </>
      )}
    </section>
  );
}

/// Shown after a completed print: the next job, on the same machine.
export function NextInQueue() {
  const next = queue.value[0];
  const i = info.value;
  if (!next || !i?.machine || !known.value || busy.value || !now.value?.progress.finished) return null;
  const take = async () => {
    // The person who removes the part and starts the next job is at the machine: reconnect it with the next job.
    if (!(await post('/api/print/leave')) || !(await post('/api/open', { name: next }))) return;
    if (i.twin) await post('/api/print/twin', { speed: i.speed });
  };
  return (
    <section class="block" data-testid="next-in-queue">
      <h3>Next in the queue</h3>
      <div class="row">
        <span>
          <b>{next.replace(/\.zip$/, '')}</b>
          <span class="quiet"> once the part is off the platform</span>
        </span>
        <button class="primary small" disabled={!mayDrive.value || flags.value.error} onClick={() => void take()} data-testid="queue-next">
          {i.twin ? 'Open and connect' : 'Open'}
        </button>
      </div>
    </section>
  );
}
