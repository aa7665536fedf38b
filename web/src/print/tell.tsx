// Shows the state of a print outside the page: in the title and icon of the tab, and as notifications.
import { effect, signal } from '@preact/signals';
import { onEvent } from '../store';
import { busy, flags, info, known, now } from './state';
import { tellingOf, type Telling } from './telling';

const usualTitle = document.title;

/// A progress ring; null: the page's own icon.
function iconOf({ share, colour }: Telling): string | null {
  if (!colour) return null;
  const around = 2 * Math.PI * 11;
  const part = share === null ? 0 : share * around;
  const svg = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32"><circle cx="16" cy="16" r="11" fill="none" stroke="#8a93a0" stroke-opacity=".35" stroke-width="7"/><circle cx="16" cy="16" r="11" fill="none" stroke="${colour}" stroke-width="7" stroke-dasharray="${part.toFixed(1)} ${around.toFixed(1)}" transform="rotate(-90 16 16)"/></svg>`;
  return `data:image/svg+xml,${encodeURIComponent(svg)}`;
}

const link = document.querySelector<HTMLLinkElement>('link[rel~=icon]') ?? document.head.appendChild(Object.assign(document.createElement('link'), { rel: 'icon' }));
const usualIcon = link.getAttribute('href') ?? 'data:,';

effect(() => {
  const n = now.value;
  const telling = tellingOf(
    {
      machine: Boolean(info.value?.machine && n),
      known: known.value,
      busy: busy.value,
      paused: Boolean(flags.value.paused || flags.value.pausing),
      error: Boolean(flags.value.error),
      finished: Boolean(n?.progress.finished),
      completion: n?.progress.completion ?? 0,
      job: info.value?.job ?? '',
    },
    usualTitle,
  );
  document.title = telling.title;
  const icon = iconOf(telling) ?? usualIcon;
  if (link.getAttribute('href') !== icon) link.setAttribute('href', icon);
});

const wanted = signal(localStorage.getItem('pliant_notify') === 'yes' && 'Notification' in window && Notification.permission === 'granted');

onEvent((event) => {
  if (event.type !== 'news' || !wanted.value || !document.hidden) return;
  new Notification('Pliant', { body: String(event.text), tag: 'pliant-print' });
});

/// Setting: notify of the end of a print, and of interventions it waits for.
export function Notifications() {
  if (!('Notification' in window)) return null;
  const toggle = async () => {
    const on = !wanted.value && (await Notification.requestPermission()) === 'granted';
    wanted.value = on;
    localStorage.setItem('pliant_notify', on ? 'yes' : 'no');
  };
  return (
    <button class="small" aria-pressed={wanted.value} title="Notify in this browser when the print has ended or waits for you" data-testid="notify" onClick={() => void toggle()}>
      {wanted.value ? 'Notifications on' : 'Notify me'}
    </button>
  );
}
