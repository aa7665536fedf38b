// Components shared by several wizards.
import { useEffect, useState } from 'preact/hooks';
import { hasEnding } from '../file_names';
import { api, say } from '../store';
import { device, file, projectorAt } from './state';

export interface Ports {
  ports: { device: string; name: string }[];
  displays: { number: number; name: string; width: number; height: number }[];
  without: string;
}

/// Somebody is about to type there: nothing is put in under their hands.
const isTypedIn = (field: string) => (document.activeElement as HTMLElement | null)?.dataset.testid === field;

export function usePorts(): [Ports | null, () => void] {
  const [ports, setPorts] = useState<Ports | null>(null);
  const look = () =>
    void api('/api/print/ports')
      .then((r) => r.json())
      .then((p: Ports) => {
        setPorts(p);
        if (!device.value && !isTypedIn('wizard-device')) device.value = p.ports[0]?.device ?? '';
        if (!projectorAt.value && !isTypedIn('wizard-projector')) projectorAt.value = p.displays.length > 1 ? String(p.displays[p.displays.length - 1].number) : 'light';
      })
      .catch((e: Error) => say(e.message));
  useEffect(look, []);
  return [ports, look];
}

/// Printer files of the folder; with `builtIn` also those of the program, which a wizard can show but not change.
export function PickFile({ builtIn }: { builtIn?: boolean }) {
  const [names, setNames] = useState<string[] | null>(null);
  useEffect(() => {
    api('/api/project')
      .then((r) => r.json())
      .then((p: { printers: string[] }) => {
        const mine = p.printers.filter((n) => hasEnding(n, '.toml'));
        const all = builtIn ? p.printers : mine;
        setNames(all);
        if (!all.includes(file.value)) file.value = mine[0] ?? all[0] ?? '';
      })
      .catch((e: Error) => say(e.message));
  }, []);
  if (names?.length === 0)
    return (
      <p class="problems" data-testid="no-printer-file">
        This folder has no printer file yet. <i>Set up a machine</i> creates one.
      </p>
    );
  return (
    <label class="wizard-field">
      <span>Printer file</span>
      <select value={file.value} onChange={(e) => (file.value = e.currentTarget.value)} data-testid="wizard-file">
        {names?.map((n) => (
          <option value={n}>{n.replace(/\.toml$/, '').replace(/_/g, ' ')}</option>
        ))}
      </select>
    </label>
  );
}

export function PickPort({ ports, look }: { ports: Ports | null; look: () => void }) {
  return (
    <>
      <label class="wizard-field">
        <span>Port</span>
        <span class="with-button">
          <input list="wizard-ports" value={device.value} placeholder="/dev/ttyACM0" spellcheck={false} onInput={(e) => (device.value = e.currentTarget.value)} data-testid="wizard-device" />
          <button type="button" class="small" onClick={look}>
            Refresh
          </button>
        </span>
        <datalist id="wizard-ports">
          {ports?.ports.map((p) => (
            <option value={p.device}>{p.name}</option>
          ))}
        </datalist>
      </label>
      <p class="quiet small-print">
        {ports === null ? 'searching…' : ports.ports.length === 0 ? 'No device found on any serial port. Plug in the board and press Refresh.' : ports.ports.map((p) => `${p.device} ${p.name}`).join(' · ')}
      </p>
    </>
  );
}

export function PickProjector({ ports }: { ports: Ports | null }) {
  return (
    <>
      <label class="wizard-field">
        <span>Projector</span>
        <input list="wizard-displays" value={projectorAt.value} spellcheck={false} onInput={(e) => (projectorAt.value = e.currentTarget.value)} data-testid="wizard-projector" />
        <datalist id="wizard-displays">
          {ports?.displays.map((d) => (
            <option value={String(d.number)}>{`${d.name}, ${d.width} × ${d.height}`}</option>
          ))}
        </datalist>
      </label>
      <p class="quiet small-print">
        {ports?.displays.length
          ? `Number of the display: ${ports.displays.map((d) => `${d.number} ${d.name}, ${d.width} × ${d.height}`).join(' · ')}. Anything else is a folder of the project, for a machine that reads its images from there.`
          : 'No display found: images are written to this folder of the project, for a machine that reads them from there.'}
      </p>
    </>
  );
}

/// A number that is written when its step is left.
export function SetupNumber({ label, value, unit, testId, onValue }: { label: string; value: string; unit: string; testId?: string; onValue: (text: string) => void }) {
  return (
    <span class="number">
      <input inputMode="decimal" class="short" aria-label={label} value={value} data-testid={testId} onInput={(e) => onValue(e.currentTarget.value)} />
      <span class="unit">{unit}</span>
    </span>
  );
}
