// The interactive robot: 3D view, panels, timeline.
import { Lost } from '../lost';
import { narrow } from '../narrow';
import { lines, online, problems, scene } from '../store';
import { Accuracies } from './accuracy';
import { Actuators } from './actuators';
import { CanvasBeside, Compare, Compared, comparing } from './beside';
import { Build } from './build';
import { Canvas, options } from './canvas';
import { Editor, Materials } from './editor';
import { Export } from './export';
import { FirstPicture } from './first_picture';
import { Goal } from './goal';
import { Hints } from './hints';
import { Identify } from './identify';
import { KeptList } from './kept_list';
import { Legend } from './legend';
import { LookBar } from './look_bar';
import { NoRobot } from './no_robot';
import { panel } from './panel';
import { Pin } from './pin';
import { Plots } from './plots';
import { Readings } from './readings';
import { Measure, ScaleBar, SectionHandle, ViewCube } from './stage_tools';
import { Status } from './status';
import { Sweep } from './sweep';
import { Timeline } from './timeline';
import { Workspace } from './workspace';

export function Simulate() {
  const tabs: [typeof panel.value, string][] = [
    ['move', 'Move'],
    ['build', 'Build'],
    ['plots', 'Plots'],
    ['file', 'File'],
    ['goal', 'Goal'],
    ['workspace', 'Workspace'],
    ['identify', 'Identify'],
    ['sweep', 'Sweep'],
  ];
  /// Arrow keys, Home and End move between them.
  const walk = (e: KeyboardEvent) => {
    const step = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: 4, ArrowUp: -4 }[e.key];
    const now = tabs.findIndex(([name]) => name === panel.value);
    const to = e.key === 'Home' ? 0 : e.key === 'End' ? tabs.length - 1 : step === undefined ? -1 : (now + step + tabs.length) % tabs.length;
    if (to < 0) return;
    e.preventDefault();
    panel.value = tabs[to][0];
    (e.currentTarget as HTMLElement).querySelectorAll<HTMLElement>('[role=tab]')[to]?.focus();
  };
  return (
    <main class="simulate">
      <h2 class="unseen">Simulate</h2>
      <section class="stage">
        <FirstPicture />
        <div class={comparing.value ? 'views two' : 'views'}>
          <Canvas />
          {comparing.value && <CanvasBeside options={options} />}
        </div>
        <SectionHandle />
        <div class="stage-top">
          <LookBar />
          <div class="stage-right">
            <Pin />
            <Compare />
            <Export />
          </div>
        </div>
        <Legend />
        {scene.value && <ViewCube />}
        <Measure />
        <div class="stage-foot">
          {online.value || lines.value === 0 ? scene.value && !narrow.value && <Hints /> : <Lost text="so the robot is shown as it was last known." />}
          {scene.value && <ScaleBar />}
          <Status />
        </div>
      </section>
      <aside class="side">
        {narrow.value && scene.value && online.value && <Hints />}
        <div class="tabs">
          <div class="tab-list four" role="tablist" aria-label="Panels" onKeyDown={walk}>
            {tabs.map(([name, label]) => (
              <button key={name} id={`tab-${name}`} role="tab" aria-selected={panel.value === name} aria-controls="panel" tabIndex={panel.value === name ? 0 : -1} onClick={() => (panel.value = name)} data-testid={`tab-${name}`}>
                {label}
                {name === 'file' && problems.value.length > 0 && <span class="badge">{problems.value.length}</span>}
              </button>
            ))}
          </div>
          <div class="row elements">
            <span class="quiet">Elements</span>
            <Accuracies />
          </div>
        </div>
        <div class="panel" key={panel.value} id="panel" role="tabpanel" aria-labelledby={`tab-${panel.value}`}>
          {!scene.value && panel.value !== 'file' && <NoRobot />}
          {panel.value === 'move' && scene.value && (
            <>
              <Actuators />
              <Readings />
              <Compared />
              <Plots />
            </>
          )}
          {panel.value === 'build' && <Build />}
          {panel.value === 'goal' && <Goal />}
          {panel.value === 'workspace' && <Workspace />}
          {panel.value === 'identify' && <Identify />}
          {panel.value === 'sweep' && scene.value && <Sweep />}
          {panel.value === 'plots' && scene.value && <Plots all />}
          {panel.value === 'file' && (
            <>
              <Materials />
              <KeptList />
              <Editor />
            </>
          )}
        </div>
      </aside>
      <Timeline />
    </main>
  );
}
