// The menu of files that the current robot can be written to.
import { useRef, useState } from 'preact/hooks';
import { useDismiss } from '../dismiss';
import { Icon } from '../icons';
import { api, say, scene } from '../store';
import { film, filming, gif, stopFilming } from './film';
import { linkText } from './link';
import { saveBlob as save } from './save';
import { theView } from './the_view';
import { tracksCsv } from './tracks';

/// Fetched first, since a navigation would show a refusal in the place of the page.
const fetched = (name: string) =>
  void api(`/api/export/${name}`)
    .then((r) => r.blob())
    .then((b) => save(b, name))
    .catch((e: Error) => say(e.message));

export function Export() {
  const [open, setOpen] = useState(false);
  const box = useRef<HTMLDivElement>(null);
  useDismiss(open, () => setOpen(false), box);
  const head = scene.value?.head;
  if (!head) return null;
  const items: [string, string, () => void][] = [
    ['Image', 'PNG', () => void theView.value?.png().then((b) => b && save(b, 'robot.png'))],
    ['Picture for print, 3840 pixels wide', 'PNG', () => void theView.value?.png(3840).then((b) => b && save(b, 'robot_print.png'))],
    ['Video of the states since rest', 'WebM', () => void film().then((b) => (b ? save(b, 'robot.webm') : say('There is no motion to record yet: move the robot first.')))],
    ['Video for slides and chats, 640 pixels wide', 'GIF', () => void gif().then((b) => (b ? save(b, 'robot.gif') : say('There is no motion to record yet: move the robot first.')))],
    ['Link to this state', 'copy', () => void navigator.clipboard.writeText(linkText()).then(() => say('Link copied to the clipboard.'), () => say(linkText()))],
    ['Plot data', 'CSV', () => save(new Blob([tracksCsv()], { type: 'text/csv' }), 'plots.csv')],
    ['Force history', 'CSV', () => fetched('steps.csv')],
    ['Marker history', 'CSV', () => fetched('markers.csv')],
    ['Animation', 'GLB', () => fetched('robot.glb')],
    ['Current state with fields', 'VTU', () => fetched('robot.vtu')],
  ];
  return (
    <div class="menu" ref={box}>
      {filming.value === null ? (
        <button class="chip" aria-expanded={open} onClick={() => setOpen(!open)}>
          <Icon name="download" /> Export
        </button>
      ) : (
        <button class="chip" onClick={stopFilming} data-testid="stop-filming">
          Rendering video, {Math.round(100 * filming.value)} %: cancel
        </button>
      )}
      {open && (
        <div class="popover right" onClick={() => setOpen(false)}>
          {items.map(([label, kind, go]) => (
            <button class="item" onClick={go}>
              <span>{label}</span>
              <span class="quiet">{kind}</span>
            </button>
          ))}
        </div>
      )}
    </div>
  );
}
