// Connection lost: what is shown is the last known state.
import { Icon } from './icons';

export function Lost({ text }: { text: string }) {
  return (
    <div class="prompt bad" role="alert" data-testid="lost">
      <Icon name="warn" />
      <span>
        <b>Connection lost, reconnecting…</b>
        This page has lost its connection to the studio, {text}
      </span>
    </div>
  );
}
