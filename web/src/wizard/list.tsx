// The list of wizards.
import { Icon } from '../icons';
import { mayDrive } from '../store';
import { open, titles, type WizardName } from './state';

const about: Record<WizardName, string> = {
  machine: 'your own printer file: controller board, axes and vats',
  projector: 'test patterns; the pixel size follows from what you measure',
  exposure: 'one print with many exposures; the best one is kept',
  axes: 'homing, jogging, limits, and one swap as a test',
  first: 'from the robot to the part, step by step',
};

export function Wizards() {
  return (
    <section class="card wide-card">
      <h3>Step-by-step setup</h3>
      <ul class="journals wizards" data-testid="wizards">
        {(Object.keys(titles) as WizardName[]).map((name) => (
          <li>
            <button class="item" disabled={!mayDrive.value} onClick={() => open(name)} data-testid={`wizard-${name}`}>
              <b>{titles[name]}</b>
              <span class="quiet">{about[name]}</span>
              <Icon name="right" />
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}
