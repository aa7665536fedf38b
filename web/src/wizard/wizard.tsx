// The frame of a wizard: its steps, back and next. Nothing moves or lights up before it is requested.
import type { ComponentChildren } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';
import { Icon } from '../icons';
import { mayDrive } from '../store';
import { axesSteps } from './axes';
import { exposureSteps } from './exposure';
import { firstSteps } from './first';
import { machineSteps } from './machine';
import { projectorSteps } from './projector';
import { step, titles, wizard, type WizardName } from './state';

export interface Step {
  name: string;
  body: () => ComponentChildren;
  /// Why the wizard cannot continue yet; "": it can.
  lacks?: () => string;
  /// Writes the entries of the step. False: refused, with the reason given to `tell`.
  leave?: (tell: (why: string) => void) => Promise<boolean>;
  next?: string; // label of the button
}

const steps: Record<WizardName, () => Step[]> = {
  machine: machineSteps,
  projector: projectorSteps,
  exposure: exposureSteps,
  axes: axesSteps,
  first: firstSteps,
};

export function Wizard() {
  const name = wizard.value!;
  const all = steps[name]();
  const at = Math.min(step.value, all.length - 1);
  const now = all[at];
  const [why, setWhy] = useState('');
  const [busy, setBusy] = useState(false);
  const heading = useRef<HTMLHeadingElement>(null);
  const first = useRef(true);
  useEffect(() => {
    setWhy('');
    if (!first.current) heading.current?.focus();
    first.current = false;
  }, [at, name]);
  const close = () => (wizard.value = null);
  const next = async () => {
    setWhy('');
    setBusy(true);
    const may = !now.leave || (await now.leave(setWhy));
    setBusy(false);
    if (!may) return;
    if (at === all.length - 1) close();
    else step.value = at + 1;
  };
  const lacks = now.lacks?.() ?? '';
  return (
    <div class="wizard" data-testid="wizard" data-step={at}>
      <div class="row">
        <h2>{titles[name]}</h2>
        <button class="bare" aria-label={`Leave ${titles[name]}`} onClick={close} data-testid="wizard-close">
          <Icon name="close" />
        </button>
      </div>
      <ol class="wizard-steps" aria-label="Steps">
        {all.map((s, k) => (
          <li class={k < at ? 'done' : ''} aria-current={k === at ? 'step' : undefined}>
            {k < at ? <Icon name="check" /> : <span class="step-number">{k + 1}</span>}
            <span>{s.name}</span>
          </li>
        ))}
      </ol>
      <section class="card">
        <h3 tabIndex={-1} ref={heading}>
          {now.name}
        </h3>
        {now.body()}
        {why && (
          <p class="problems" role="alert" data-testid="wizard-why">
            {why}
          </p>
        )}
      </section>
      <div class="row wizard-foot">
        <button disabled={at === 0} onClick={() => (step.value = at - 1)} data-testid="wizard-back">
          <Icon name="left" /> Back
        </button>
        {lacks && <span class="quiet" data-testid="wizard-lacks">{lacks}</span>}
        <button class="primary" disabled={Boolean(lacks) || busy || !mayDrive.value} onClick={() => void next()} data-testid="wizard-next">
          {now.next ?? (at === all.length - 1 ? 'Done' : 'Next')}
        </button>
      </div>
    </div>
  );
}
