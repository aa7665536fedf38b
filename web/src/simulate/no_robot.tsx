// What a panel says as long as there is no robot: why, and where that is put right.
import { Icon } from '../icons';
import { building, problems } from '../store';
import { panel } from './panel';

export function NoRobot() {
  if (building.value) return <p class="quiet">The robot is being built.</p>;
  const first = problems.value[0];
  if (!first) return null;
  return (
    <div class="problems" role="alert" data-testid="no-robot">
      <p>The robot could not be built:</p>
      <ul>
        <li>
          {first.line > 0 && <b>line {first.line}</b>} {first.text}
        </li>
      </ul>
      <button class="small" onClick={() => (panel.value = 'file')} data-testid="to-file">
        <Icon name="warn" /> Open File
      </button>
    </div>
  );
}
