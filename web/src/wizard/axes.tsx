// Axes and swap: home, jog, limits, and a test swap, on the virtual printer or the machine.
import { signal } from '@preact/signals';
import { useState } from 'preact/hooks';
import { counted } from '../counted';
import { ByHand } from '../print/by_hand';
import { Safety } from '../print/safety';
import { flags, host, info, known, maySteer, now } from '../print/state';
import { mayDrive, post } from '../store';
import { swapRobot } from './coupons';
import { AxesTable, writeAxes } from './machine';
import { PickFile, PickPort, PickProjector, usePorts } from './parts';
import { device, file, projectorAt, setup } from './state';
import { saveTest, sliceTest } from './test_job';
import type { Step } from './wizard';

/// Moves of vats that were requested since the machine was connected.
const moved = signal(0);
const swapMoves = () => ((info.value?.machine?.vats.length ?? 0) > 1 ? 3 : 2);

const connected = () => Boolean(info.value?.machine && now.value);

function Connect() {
  const [ports, look] = usePorts();
  const [why, setWhy] = useState('');
  const [busy, setBusy] = useState(false);
  const begin = async (real: boolean) => {
    setBusy(true);
    moved.value = 0;
    let wrong = await sliceTest(swapRobot(setup.value!), { 'any-vat': true });
    if (!wrong && real) wrong = await saveTest('axes_test');
    if (!wrong) {
      const asked = real ? post('/api/print/port', { device: device.value, projector: projectorAt.value, speed: 1, clock: '' }, (t) => (wrong = t)) : post('/api/print/twin', { speed: 10 }, (t) => (wrong = t));
      await asked;
    }
    setWhy(wrong);
    setBusy(false);
  };
  if (connected())
    return (
      <>
        <p data-testid="axes-connected">
          <b>{info.value!.machine!.name}</b> is connected: {info.value!.twin ? 'the virtual printer' : info.value!.device}.
        </p>
        <button disabled={!mayDrive.value} onClick={() => post('/api/print/leave')}>
          Disconnect
        </button>
      </>
    );
  return (
    <>
      <p>Try it on the virtual printer first: it runs the same G-code with the same printer file, and nothing can break. Connecting moves nothing.</p>
      <PickFile />
      <div class="row left wrap">
        <button class="primary" disabled={!mayDrive.value || busy || !setup.value} onClick={() => void begin(false)} data-testid="axes-twin">
          {busy ? 'making a small job…' : 'Connect the virtual printer'}
        </button>
      </div>
      <details class="wizard-more">
        <summary>Connect the machine</summary>
        <PickPort ports={ports} look={look} />
        <PickProjector ports={ports} />
        <button disabled={!mayDrive.value || busy || !setup.value || !device.value} onClick={() => void begin(true)} data-testid="axes-port">
          Connect
        </button>
      </details>
      {why && (
        <p class="problems" role="alert">
          {why}
        </p>
      )}
    </>
  );
}

/// All axes that this machine has.
const homed = () => connected() && Object.keys(info.value!.machine!.axes).every((name) => now.value!.machine.axes[name]?.homed);

function State() {
  if (!connected()) return <p class="problems">No machine is connected.</p>;
  return (
    <p role="status" data-testid="axes-state">
      {!known.value ? 'The state of the machine is unknown: the connection to the studio is lost.' : `${now.value!.state.text}${now.value!.state.message ? `: ${now.value!.state.message}` : ''}`}
    </p>
  );
}

function Home() {
  return (
    <>
      <p>The axes move to their limit switches one after another, the platform first. Clear their way, and keep the emergency stop within reach.</p>
      <State />
      <button class="primary" disabled={!connected() || !maySteer.value || !flags.value.ready} onClick={() => host('printer/axes', { command: 'home' })} data-testid="axes-home">
        Home all axes
      </button>
      {connected() && <Safety />}
    </>
  );
}

function Jog() {
  return (
    <>
      <p>Jog each axis to both ends and check that it moves in the right direction and by the distance shown. Correct the values below where needed: they are saved when you go on, and take effect at the next connection.</p>
      <State />
      {connected() && <ByHand />}
      <AxesTable />
    </>
  );
}

function Swap() {
  const vats = info.value?.machine?.vats ?? [];
  const slot = connected() ? now.value!.machine.slot : 0;
  const ready = connected() && maySteer.value && flags.value.ready;
  const fetch = (to: number) => void host('printer/vat', { slot: to }).then((done) => done && (moved.value += 1));
  return (
    <>
      <p>Fetch one vat, swap it for the other, then return it: one complete swap. Watch the hooks.</p>
      <State />
      <p data-testid="axes-slot">
        {slot === 0 ? 'No vat is in use.' : <>The vat of slot <b>{slot}</b> is in use.</>}
      </p>
      <div class="row left wrap">
        {vats.slice(0, 2).map((v) => (
          <button disabled={!ready || slot === v.slot} onClick={() => fetch(v.slot)} data-testid={`fetch-${v.slot}`}>
            Fetch vat {v.slot}
          </button>
        ))}
        <button disabled={!ready || slot === 0} onClick={() => fetch(0)} data-testid="fetch-0">
          Return the vat
        </button>
      </div>
      {moved.value > 0 && <p class="quiet">{moved.value < swapMoves() ? `${counted(moved.value, 'move')} requested, ${swapMoves()} make a complete swap.` : 'That was a complete swap.'}</p>}
    </>
  );
}

function Ready() {
  return (
    <>
      <p>
        {moved.value >= swapMoves() ? (
          <>
            Axes and swap of <b>{file.value}</b> have been tested.
          </>
        ) : (
          <>
            The axes of <b>{file.value}</b> are homed; a complete swap has not been tested yet.
          </>
        )}
      </p>
      {connected() && (
        <button disabled={!mayDrive.value} onClick={() => post('/api/print/leave')} data-testid="axes-leave">
          Disconnect
        </button>
      )}
    </>
  );
}

export const axesSteps = (): Step[] => [
  { name: 'Connect', body: () => <Connect />, lacks: () => (connected() ? '' : 'connect a machine') },
  { name: 'Home', body: () => <Home />, lacks: () => (homed() ? '' : 'the axes are not homed') },
  { name: 'Jog and limits', body: () => <Jog />, leave: writeAxes },
  { name: 'Swap', body: () => <Swap /> },
  { name: 'Ready', body: () => <Ready /> },
];
