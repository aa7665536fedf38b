// Times of the program, in words: in seconds where the file has them, else as a share of the program.
import { computed } from '@preact/signals';
import { scene } from '../store';
import { theirs } from './editor';
import { hasProgramKeys } from './toml_edit';

export const inSeconds = computed(() => {
  const program = scene.value?.head.program;
  return (program?.timed ?? false) || (program?.duration ?? 1) !== 1 || hasProgramKeys(theirs.value);
});

export function programTime(time: number, duration: number, decimals: number): string {
  return inSeconds.value ? `${time.toFixed(decimals)} s` : `${Math.round((100 * time) / duration)} %`;
}
