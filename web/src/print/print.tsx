// Monitoring and controlling a print.
import { useRef } from 'preact/hooks';
import { counted } from '../counted';
import { useKeptFocus } from '../dismiss';
import { Icon } from '../icons';
import { Lost } from '../lost';
import { post } from '../store';
import { wizard } from '../wizard/state';
import { Wizard } from '../wizard/wizard';
import { ByHand } from './by_hand';
import { Checklist } from './checklist';
import { Exposure } from './exposure';
import { Interrupted } from './interrupted';
import { Log } from './log';
import { Progress } from './progress';
import { NextInQueue } from './queue';
import { Safety } from './safety';
import { busy, info, known, maySteer, now } from './state';
import { Steering } from './steering';
import { TakeMachine } from './take';
import { Notifications } from './tell';
import { Machine3D, Picture } from './watch';
import { Webcam } from './webcam';

const speeds = [1, 10, 60, 300];

const lostText =
  'so the state of the machine is unknown. A print continues without this page as long as the studio runs; if the studio has ended, the light is off and the machine stands still. To stop the machine now, use its own switch.';

export function Print() {
  const i = info.value;
  const main = useRef<HTMLElement>(null); // the same element all the time
  useKeptFocus(main, ['.steering button:enabled', '.landing']);
  if (wizard.value)
    return (
      <main class="page" ref={main}>
        <Wizard />
      </main>
    );
  if (!i?.machine || !now.value)
    return (
      <main class="page" ref={main}>
        <TakeMachine />
      </main>
    );
  return (
    <main class="print" ref={main}>
      <h2 class="unseen">Print</h2>
      <div class="watch">
        <Machine3D />
        <Picture />
        <Webcam />
      </div>
      <div class="steer">
        <div class="row machine-name landing" tabIndex={-1}>
          <b>{i.machine.name}</b>
          <span class="quiet">{i.twin ? 'virtual printer' : i.device}</span>
        </div>
        {!known.value && <Lost text={lostText} />}
        <Progress />
        <Steering />
        {!busy.value && (now.value.job.canResume ? <Interrupted /> : <Checklist />)}
        <Exposure />
        <Safety />
        <section class="block row wrap">
          {i.twin && (
            <span class="segments" role="group" aria-label="Speed of the virtual printer">
              {speeds.map((s) => (
                <button
                  aria-pressed={i.speed === s}
                  disabled={!maySteer.value}
                  onClick={async () => {
                    if (await post('/api/print/speed', { speed: s })) info.value = { ...i, speed: s };
                  }}
                >
                  {s}×
                </button>
              ))}
            </span>
          )}
          <Notifications />
          <a class="button small" href="/api/print/report" download data-testid="print-report">
            <Icon name="download" /> Report
          </a>
          {!busy.value && (
            <button class="small" disabled={!maySteer.value} data-testid="leave" onClick={() => post('/api/print/leave')}>
              Disconnect
            </button>
          )}
        </section>
        <NextInQueue />
        {!busy.value && !now.value.job.canResume && <ByHand />}
        <Log />
        <p class="quiet">
          {now.value.machine.firmware && `${now.value.machine.firmware} · `}
          {counted(now.value.machine.linesSent, 'line')} sent · {now.value.machine.resends} resent
        </p>
      </div>
    </main>
  );
}
