// Safety devices of the machine, according to its printer file: door, limit switches, the emergency line.
import { post } from '../store';
import { flags, info, known, maySteer, now, type MachineInfo } from './state';

/// The effect of an emergency stop.
function lineText(line: MachineInfo['emergency'], twin: boolean): string {
  const on = line.device ? ` (${line.device})` : '';
  if (line.signal === 'controller') return `a relay at pin ${line.pin} of the board cuts the power when the firmware is killed`;
  if (line.signal === 'none') return 'none: an emergency stop relies on the firmware (M112)';
  const what = line.signal === 'file' ? `a pin of this computer${on}` : `the ${line.signal.toUpperCase()} line of a separate port${on}`;
  return twin ? `${what}; not used by the virtual printer` : `${what} cuts the power, whatever the firmware does`;
}

function Door() {
  const door = known.value ? now.value!.machine.door : null;
  const twin = info.value!.twin;
  return (
    <li class={door === 'open' ? 'bad' : ''} data-testid="door" data-state={door ?? 'unknown'}>
      <span class={`lamp ${door === 'open' ? 'bad' : door === 'shut' ? 'good' : 'unknown'}`} />
      <span>
        <b>Door</b> {door === 'open' ? 'open' : door === 'shut' ? 'closed' : 'unknown'}
      </span>
      {twin && now.value!.machine.door !== null && (
        <button class="small" disabled={!maySteer.value} data-testid="move-door" onClick={() => post('/api/print/door', { open: door !== 'open' })}>
          {door === 'open' ? 'Close' : 'Open'}
        </button>
      )}
    </li>
  );
}

export function Safety() {
  const m = info.value!.machine!;
  const read: Record<string, boolean> = known.value ? now.value!.machine.switches : {};
  const connected = known.value && flags.value.operational;
  return (
    <section class="block" data-testid="safety">
      <h3>Safety</h3>
      <ul class="switches">
        {m.door && <Door />}
        {m.switches.map((s) => {
          const pressed = read[s.name];
          return (
            <li key={s.name} title={`M119 calls it ${s.name}`} data-testid={`switch-${s.name}`} data-state={pressed === undefined ? 'unknown' : pressed ? 'pressed' : 'free'}>
              <span class={`lamp ${pressed === undefined ? 'unknown' : pressed ? 'pressed' : 'free'}`} />
              <span>
                <b>{s.axis}</b> {s.end} {pressed === undefined ? (connected ? 'not read yet' : 'unknown') : pressed ? 'pressed' : 'free'}
              </span>
            </li>
          );
        })}
        {m.switches.length === 0 && <li class="quiet">The printer file lists no limit switches: they are not monitored.</li>}
        <li data-testid="emergency-line">
          <span class={`lamp ${m.emergency.signal === 'none' ? 'unknown' : 'good'}`} />
          <span>
            <b>Emergency line</b> {lineText(m.emergency, info.value!.twin)}
          </span>
        </li>
      </ul>
    </section>
  );
}
