// A wizard that was left for another section shrinks to a bar at the bottom, with a way back.
import { Icon } from '../icons';
import { section } from '../store';
import { step, titles, waiting, wizard } from './state';

export function GuideBar() {
  const name = wizard.value && section.value !== 'print' ? wizard.value : !wizard.value ? waiting.value : null;
  if (!name) return null;
  const back = () => {
    wizard.value = name;
    waiting.value = null;
    section.value = 'print';
    location.hash = 'print';
  };
  return (
    <div class="guide-bar" role="region" aria-label="Wizard in progress" data-testid="guide-bar">
      <span>
        <b>{titles[name]}</b> <span class="quiet">step {step.value + 1}</span>
      </span>
      <button class="primary small" onClick={back} data-testid="guide-back">
        Continue
      </button>
      <button
        class="bare"
        aria-label={`Leave ${titles[name]}`}
        onClick={() => {
          wizard.value = null;
          waiting.value = null;
        }}
      >
        <Icon name="close" />
      </button>
    </div>
  );
}
