// The emergency stop: at a fixed place of the window in every section, for every page, as long as a machine is
// connected.
import { post } from '../store';
import { info } from './state';

export function EmergencyStop() {
  if (!info.value?.machine) return null;
  return (
    <button class="danger emergency" data-testid="emergency" onClick={() => post('/api/print/stop')}>
      Emergency stop
    </button>
  );
}
