// Where the wizards begin.
import { mayDrive } from '../store';
import { open, titles, type WizardName } from './state';

const about: Record<WizardName, string> = {
  machine: 'a printer file of your own, the board that answers, its axes and vats',
  projector: 'test patterns; what you measure becomes the size of a pixel',
  exposure: 'one print with many exposures; the one that comes out right is kept',
  axes: 'home, jog, limits, and one swap tried',
  first: 'from the robot to the part, step by step',
};

export function Wizards() {
  return (
    <section class="card wide-card">
      <h3>Set up, step by step</h3>
      <ul class="journals wizards" data-testid="wizards">
        {(Object.keys(titles) as WizardName[]).map((name) => (
          <li>
            <button class="item" disabled={!mayDrive.value} onClick={() => open(name)} data-testid={`wizard-${name}`}>
              <b>{titles[name]}</b>
              <span class="quiet">{about[name]}</span>
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}
