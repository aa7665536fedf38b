// A small job for a wizard: sliced, saved if a real machine needs that, and connected.
import { effect } from '@preact/signals';
import { api, job, onEvent, post, sliceError, slicing } from '../store';
import { file, setup } from './state';

/// Resolves when slicing has ended, with its error: "" if there is a new job.
function endOfSlicing(before: number): Promise<string> {
  return new Promise((resolve) => {
    let begun = false;
    const stop: { now?: () => void } = {};
    const check = () => {
      begun ||= slicing.value !== null;
      const made = job.value !== null && job.value.revision !== before && slicing.value === null;
      const failed = sliceError.value !== '' && slicing.value === null;
      if (!made && !failed) return;
      setTimeout(() => stop.now?.());
      resolve(failed ? sliceError.value : '');
    };
    stop.now = effect(check);
    const deaf = onEvent((event) => {
      if (event.type !== 'slicing' || event.stage) return;
      deaf(); // whatever has been made, its job is announced
      if (event.cancelled) stop.now?.(), resolve('slicing was cancelled');
    });
  });
}

/// "" or the error.
export async function sliceTest(robot: string, more: object = {}): Promise<string> {
  const before = job.value?.revision ?? 0;
  let refused = '';
  sliceError.value = '';
  const ended = endOfSlicing(before);
  const layer = `${setup.value?.layer_um ?? 50} um`;
  if (!(await post('/api/job/slice', { printer: file.value, robot, layer, ...more }, (text) => (refused = text)))) return refused;
  return ended;
}

/// Saves under the first free name of name.zip, name_2.zip, ... "" or the error.
export async function saveTest(name: string): Promise<string> {
  if (job.value?.saved) return '';
  let why = '';
  for (let k = 1; k < 100; ++k) {
    const free = `${name}${k === 1 ? '' : `_${k}`}.zip`;
    const taken = ((await (await api('/api/project')).json()) as { files: string[] }).files.includes(free);
    if (!taken) return (await post('/api/job/save', { name: free }, (text) => (why = text))) ? '' : why;
  }
  return 'there are too many test jobs in this folder';
}
