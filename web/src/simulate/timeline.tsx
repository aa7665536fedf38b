// The program over time: play, replay, rest, record.
import { counted } from '../counted';
import { Icon } from '../icons';
import {
  following,
  frame,
  inProgram,
  mayDrive,
  online,
  restValue,
  say,
  scene,
  send,
  sendInput,
  toRest as askForRest,
  wanted,
  wantedTime,
} from '../store';
import { text } from './editor';
import { motion, MotionNotes, MotionTrack, RunMotion } from './motion';
import { panel } from './panel';
import { programTime } from './program_time';
import { asProgram, endOf, insertKeys, recorded, recording, startRecording, stopRecording } from './recorder';
import { clearTracks, frames, tracksVersion } from './tracks';
import * as look from './view_state';

export function follow(time: number) {
  following.value = true;
  look.shownFrame.value = null;
  wantedTime.value = inProgram(time);
  sendInput({ type: 'follow', time: wantedTime.value });
}

function toRest() {
  const head = scene.value?.head;
  if (!head) return;
  following.value = true;
  wantedTime.value = 0;
  look.shownFrame.value = null;
  wanted.value = Object.fromEntries(head.actuators.map((a) => [a.name, { kind: a.kind, value: restValue(a.kind) }]));
  askForRest();
  clearTracks();
}

export function Timeline() {
  tracksVersion.value;
  const head = scene.value?.head;
  const playing = frame.value?.head.playing ?? false;
  if (!head) return null;
  const duration = head.program.duration;
  const time = playing ? (frame.value?.head.time ?? 0) : wantedTime.value;
  const shown = look.shownFrame.value ? frames.indexOf(look.shownFrame.value) : frames.length - 1;
  const program = recorded.value.length > 1 && !recording.value;
  return (
    <div class="timeline">
      <button class="round" disabled={!mayDrive.value} aria-label={playing ? 'Pause the program' : 'Play the program'} data-testid="play" onClick={() => {
        following.value = true;
        look.shownFrame.value = null;
        send({ type: 'play', on: !playing });
      }}>
        <Icon name={playing ? 'pause' : 'play'} />
      </button>
      <label class="track">
        <span>Program</span>
        <input type="range" data-testid="program" min={0} max={duration} step={duration / 1000} value={time} disabled={!mayDrive.value} style={{ '--at': `${(100 * time) / duration}%` }} class={following.value ? '' : 'idle'} onInput={(e) => follow(Number(e.currentTarget.value))} />
        <output>{programTime(time, duration, 2)}</output>
      </label>
      {motion.value ? (
        <MotionTrack />
      ) : (
      <label class="track">
        <span>Replay</span>
        <input type="range" data-testid="replay" min={0} max={Math.max(frames.length - 1, 1)} step={1} value={shown} style={{ '--at': `${(100 * shown) / Math.max(frames.length - 1, 1)}%` }} onInput={(e) => {
          const k = Number(e.currentTarget.value);
          look.shownFrame.value = k >= frames.length - 1 ? null : frames[k];
        }} />
        <output data-testid="replay-at">{look.shownFrame.value ? `${shown + 1} of ${frames.length}` : online.value ? 'live' : 'last'}</output>
      </label>
      )}
      <RunMotion />
      <button class="round" disabled={!mayDrive.value} aria-label="Back to rest" title="Back to rest" data-testid="rest" onClick={toRest}>
        <Icon name="rest" />
      </button>
      <button class={`round record ${recording.value ? 'on' : ''}`} aria-label={recording.value ? 'Stop recording' : 'Record a program'} title="Record a program" aria-pressed={recording.value} onClick={() => (recording.value ? stopRecording() : startRecording())}>
        <Icon name={recording.value ? 'stop' : 'record'} />
      </button>
      {program && (
        <button class="small" onClick={() => {
          const keys = asProgram();
          if (!keys) return say('The recording has nothing of the actuators that the robot has now.');
          panel.value = 'file';
          document.getElementById('tab-file')?.focus(); // this button goes away
          void insertKeys(text.value, keys, endOf(keys)).then((done) => done && (recorded.value = []));
        }}>
          Insert {counted(recorded.value.length, 'sample')} as program
        </button>
      )}
      <MotionNotes />
    </div>
  );
}
