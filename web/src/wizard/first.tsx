// First print: from the robot to the part, always showing the next step.
import { signal } from '@preact/signals';
import { counted } from '../counted';
import { printer, printerInfo } from '../make/order';
import { clock } from '../make/plan';
import { busy, info, now } from '../print/state';
import { job, scene, section, type Section } from '../store';
import { PickFile } from './parts';
import { file, setup, waiting, wizard } from './state';
import type { Step } from './wizard';

/// Revision of the job when slicing was requested.
const before = signal(0);

/// Revision of a job of another part that was chosen all the same.
const accepted = signal(-1);
const ofAnother = () => Boolean(scene.value && job.value && job.value.manifest.name !== scene.value.head.robot && job.value.revision !== accepted.value);

function go(to: Section) {
  section.value = to;
  location.hash = to;
}

/// Opens the print section, to which this step belongs: the wizard shrinks to its bar.
function toPrint() {
  waiting.value = 'first';
  wizard.value = null;
  go('print');
}

export const firstSteps = (): Step[] => {
  const i = info.value;
  const connected = Boolean(i?.machine && now.value);
  const printed = connected && now.value!.progress.finished && !busy.value;
  return [
    {
      name: 'Machine',
      body: () => (
        <>
          <p>Which machine will print? If you have none, choose a built-in one: it prints on the virtual printer.</p>
          <PickFile builtIn />
          {setup.value && (
            <p class="quiet small-print">
              {setup.value.title}: {counted(setup.value.vats.length, 'vat')}, {setup.value.platform.width_mm.toFixed(0)} × {setup.value.platform.depth_mm.toFixed(0)} × {setup.value.platform.height_mm.toFixed(0)} mm
            </p>
          )}
        </>
      ),
      lacks: () => (setup.value ? '' : 'choose a machine'),
      leave: () => {
        printer.value = file.value;
        before.value = job.value?.revision ?? 0;
        return Promise.resolve(true);
      },
    },
    {
      name: 'Place and slice',
      body: () => (
        <>
          <p>
            <b>{scene.value?.head.robot ?? 'The robot'}</b> stands on the platform of {printerInfo.value?.name ?? file.value}. Lay it on a flat face, see that it fits, and slice it.
          </p>
          <button class="primary" onClick={() => go('make')} data-testid="first-prepare">
            Go to Prepare
          </button>
          {job.value && (
            <p class="quiet" data-testid="first-job">
              Current job: {job.value.manifest.name}, {counted(job.value.manifest.layers.length, 'layer')}
              {job.value.plan && `, ${clock(job.value.plan.seconds.total)}`}, {job.value.issues.length === 0 ? 'no issues found' : counted(job.value.issues.length, 'issue')}.
            </p>
          )}
          {job.value && ofAnother() && (
            <button onClick={() => (accepted.value = job.value!.revision)} data-testid="first-use-job">
              Print this job instead
            </button>
          )}
        </>
      ),
      lacks: () => (!job.value ? 'slice the robot' : ofAnother() ? 'the current job is of another part: slice the robot' : ''),
    },
    {
      name: 'Print',
      body: () => (
        <>
          <p>
            Connect the virtual printer and print there once: it takes a minute and shows whether the part cures as drawn. Then connect the machine, go through the checklist, and start.
          </p>
          <button class="primary" onClick={toPrint} data-testid="first-print">
            Go to Print
          </button>
          {connected && (
            <p class="quiet" role="status">
              {i!.machine!.name}: {now.value!.state.text}
            </p>
          )}
        </>
      ),
      lacks: () => (printed ? '' : 'the print is not complete'),
    },
    {
      name: 'Remove part',
      body: () => (
        <ol class="reasons" data-testid="first-done">
          <li>Disconnect, or leave the platform up: the part hangs clear of the vat.</li>
          <li>Detach the part with a scraper; wash it in the cleaning solution, and let it dry.</li>
          <li>Post-cure it as its resin requires.</li>
          <li>Keep the report: it records what was printed, and how.</li>
        </ol>
      ),
    },
  ];
};
