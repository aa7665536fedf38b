// A print that was interrupted: resume or discard it.
import { useRef, useState } from 'preact/hooks';
import { useKeptFocus } from '../dismiss';
import { Icon } from '../icons';
import { post } from '../store';
import { flags, host, info, maySteer } from './state';

/// An interrupted print of this job: the journal holds its progress.
export function Interrupted() {
  const [lit, setLit] = useState('');
  const [untouched, setUntouched] = useState(false);
  const [sure, setSure] = useState(false);
  const box = useRef<HTMLDivElement>(null);
  useKeptFocus(box, ['[data-testid=keep-print]', '[data-testid=put-away]']);
  const may = maySteer.value && !flags.value.working;
  const twin = info.value!.twin;
  return (
    <section class="block interrupted" data-testid="interrupted">
      <h3>A print of this job was interrupted</h3>
      <p>
        Its journal records which exposures are complete.
        {twin ? ' The virtual printer stands where it stood then, with its part; the print continues there.' : ' The platform is raised, the axes are homed, and the print continues where it stopped.'}
      </p>
      <div class="row left wrap" ref={box} onKeyDown={(e) => e.key === 'Escape' && setSure(false)}>
        <button
          class="primary"
          data-testid="go-on"
          disabled={!may}
          onClick={() =>
            host('job', {
              command: 'start',
              resume: true,
              ...(lit === '' ? {} : { assumeLit: Number(lit) }),
              ...(untouched ? { assumeVatsUntouched: true } : {}),
            })
          }
        >
          <Icon name="play" /> Resume
        </button>
        {sure ? (
          <>
            <button onClick={() => setSure(false)} data-testid="keep-print">
              Keep it
            </button>
            <button class="danger" data-testid="put-away-sure" disabled={!may} onClick={() => void (twin ? post('/api/print/discard') : host('job', { command: 'cancel' }))}>
              Discard print
            </button>
          </>
        ) : (
          flags.value.ready || twin ? (
            <button disabled={!may} data-testid="put-away" onClick={() => setSure(true)}>
              Discard
            </button>
          ) : (
            <button disabled={!may || flags.value.error} onClick={() => host('connection', { command: 'connect' })} title="Connect without resuming, to discard the print or to inspect the machine first">
              Connect only
            </button>
          )
        )}
      </div>
      <details>
        <summary>If the journal is incomplete</summary>
        <label class="field-row">
          <span>Duration of the interrupted exposure</span>
          <span class="number">
            <input type="number" min={0} step="any" value={lit} onInput={(e) => setLit(e.currentTarget.value)} />
            <span class="unit">s</span>
          </span>
        </label>
        <label class="tick">
          <input type="checkbox" checked={untouched} onChange={(e) => setUntouched(e.currentTarget.checked)} />
          <span>another program has used the controller since, but moved no vat</span>
        </label>
      </details>
    </section>
  );
}
