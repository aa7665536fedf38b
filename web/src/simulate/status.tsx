// One line below the view: whether the robot is at equilibrium, at which residual, how fast.
import { building, frame, frameRate, latency, online, rough, scene, unanswered } from '../store';
import { Rough } from './accuracy';
import * as look from './view_state';

/// A length of which only the size matters: 0.03 mm.
const millimetres = (mm: number) => `${mm < 0.01 ? 0.01 : +mm.toPrecision(1)} mm`;

export function Status() {
  const replayed = look.shownFrame.value;
  const head = (replayed ?? frame.value)?.head;
  const s = scene.value?.head;
  if (building.value)
    return (
      <div class="status" role="status" data-testid="status" data-state="building">
        <span class="pulse" /> building: {building.value.stage}
      </div>
    );
  if (!head || !s) return <div class="status" data-testid="status" data-state="none" />;
  if (!online.value)
    return (
      <div class="status" role="status" data-testid="status" data-state="unknown" data-lamp="unknown">
        <span class="lamp unknown" /> last known state
      </div>
    );
  const led = head.lead?.settled ?? false;
  const state = replayed ? 'replay' : head.stuck ? 'stuck' : unanswered.value ? 'solving' : head.arrived ? 'arrived' : head.refining ? 'refining' : led ? 'led' : 'solving';
  const warning = head.warnings.join('. ');
  const near = head.reduced_error_mm === undefined ? '≈ linear preview' : `≈ within ${millimetres(head.reduced_error_mm)}`;
  const words = {
    replay: 'replay',
    stuck: 'did not converge',
    arrived: rough.value ? '≈ linear preview' : 'at equilibrium',
    led: rough.value ? '≈ linear preview' : 'at equilibrium',
    refining: `${near}, computing the quadratic answer…`,
    solving: head.reduced_error_mm !== undefined ? near : rough.value ? '≈ Solving…' : 'Solving…',
  }[state];
  const settled = state === 'arrived' || state === 'led';
  const lamp = settled ? (warning || rough.value ? 'warn' : 'good') : state === 'stuck' ? 'bad' : 'busy';
  return (
    <div class="status" role="status" data-testid="status" data-state={state} data-lamp={lamp} title={head.stuck || warning}>
      <span class={state === 'refining' ? 'pulse' : `lamp ${lamp}`} /> {words}
      {state === 'stuck' && <span data-testid="stuck-why">: {head.stuck}</span>}
      {warning && <span data-testid="state-warning">: {warning}</span>}
      <span class="quiet">
        {head.residual > 0 && `residual ${head.residual.toExponential(0)} · `}
        {s.tets.toLocaleString('en')} tets
        {!replayed && ` · ${head.solve_ms.toFixed(0)} ms`}
        <span class="wide">
          {/* a rate is one while the robot moves: a single frame of a second says nothing */}
          {frameRate.value >= 5 && ` · ${frameRate.value} frames/s`}
          {latency.value > 0 && ` · ${latency.value.toFixed(0)} ms latency`}
        </span>
      </span>
      {rough.value && <Rough />}
    </div>
  );
}
