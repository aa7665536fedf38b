// The frame around the three sections.
import { useRef, useState } from 'preact/hooks';
import { counted } from './counted';
import { DiscardQuestion, unlessLost } from './discard';
import { dialogs, useDismiss } from './dismiss';
import { hasEnding } from './file_names';
import { Icon } from './icons';
import { Make } from './make/make';
import { EmergencyStop } from './print/emergency';
import { Print } from './print/print';
import { Enlarged } from './print/enlarged';
import { info } from './print/state';
import './print/tell';
import { SaveQuestion } from './simulate/save_robot';
import { Simulate } from './simulate/simulate';
import { GeometryDrop, PickGeometry } from './simulate/geometry';
import { templates } from './simulate/templates';
import { api, building, documentState, helm, job, newRobot, notice, online, post, problems, say, scene, section, send, type Section } from './store';
import { theme, toggleTheme } from './theme';
import { GuideBar } from './wizard/guide_bar';

interface Project {
  files: string[];
  examples: string[];
  printers: string[];
  folder: string;
}

/// A picture of a robot, drawn by the studio, or of a job; a sign if there is none.
function Thumbnail({ of }: { of: string }) {
  return (
    <span class="thumb" aria-hidden="true">
      <Icon name="layers" />
      <img src={`/api/thumbnail?${of}`} alt="" width={120} height={75} onError={(e) => (e.currentTarget.hidden = true)} />
    </span>
  );
}

/// The name of the job under Print if it is not of the open robot: of the one that the machine has, else of the next.
function otherJob(): string {
  if (section.value !== 'print') return '';
  const name = info.value?.machine ? info.value.job : job.value?.manifest.name;
  const robot = scene.value?.head.robot;
  return name && robot && name !== robot ? name : '';
}

function Open() {
  const [project, setProject] = useState<Project | null>(null);
  const toggle = () => {
    if (project) return setProject(null);
    api('/api/project')
      .then((r) => r.json())
      .then(setProject)
      .catch((e: Error) => say(e.message));
  };
  const d = documentState.value;
  const other = otherJob();
  const title = other || (scene.value?.head.robot ?? (building.value ? 'building…' : 'no robot'));
  const beside = other ? `job; robot: ${scene.value!.head.robot} (${d.title})` : d.title;
  const box = useRef<HTMLDivElement>(null);
  useDismiss(project !== null, () => setProject(null), box);
  const own = (project?.files ?? []).filter((f) => !project!.printers.includes(f));
  return (
    <div class="menu" ref={box}>
      <button class="document" aria-expanded={project !== null} onClick={toggle} title={beside ? `${title} · ${beside}` : title} data-testid="open">
        <span class="title">{title}</span>
        <span class="quiet">{beside}</span>
        {d.unsaved && <span class="unsaved">unsaved</span>}
      </button>
      {project && (
        <div class="popover open-list" onClick={() => setProject(null)}>
          <h2>New robot</h2>
          <div class="gallery">
            {Object.entries(templates).map(([name, text]) => (
              <button class="item plain" key={name} onClick={() => unlessLost(`A new robot`, () => void newRobot(text))}>
                {name}
              </button>
            ))}
          </div>
          <div class="row left pick">
            <PickGeometry label="From STL, STEP, 3MF or a mesh…" testId="pick-geometry" />
            <span class="quiet">or drop it onto the page</span>
          </div>
          <h2 title={project.folder}>This folder</h2>
          {own.length === 0 && <p class="quiet none">no robot files or jobs</p>}
          <div class="gallery">
            {own.map((name) => (
              <button class="item" key={name} onClick={() => (hasEnding(name, '.toml') ? unlessLost(`Opening ${name}`, () => void post('/api/open', { name })) : void post('/api/open', { name }))}>
                <Thumbnail of={`file=${encodeURIComponent(name)}`} />
                <span class="item-name">{name}</span>
              </button>
            ))}
          </div>
          <h2>Examples</h2>
          <div class="gallery">
            {project.examples.map((name) => (
              <button class="item" key={name} onClick={() => unlessLost(`Opening the example ${name.replace(/_/g, ' ')}`, () => void post('/api/example', { name }))}>
                <Thumbnail of={`example=${name}`} />
                <span class="item-name">{name.replace(/_/g, ' ')}</span>
              </button>
            ))}
          </div>
          <p class="quiet">
            <a href="/notices.txt" target="_blank" rel="noopener" data-testid="notices">
              Third-party licences
            </a>
          </p>
        </div>
      )}
    </div>
  );
}

function Helm() {
  const h = helm.value;
  if (!online.value)
    return (
      <span class="helm lost" role="status" data-testid="helm" data-state="offline">
        <span class="pulse" /> connection lost, reconnecting
      </span>
    );
  if (h.asked)
    return (
      <span class="helm asked" data-testid="helm" data-state="asked">
        another page requests control
        <button class="primary small" onClick={() => send({ type: 'steer', action: 'give' })}>
          Hand over
        </button>
      </span>
    );
  if (h.you)
    return h.pages > 1 ? (
      <span class="helm" data-testid="helm" data-state="steering">
        <Icon name="helm" /> you have control, {counted(h.pages - 1, 'viewer')}
      </span>
    ) : (
      <span class="helm" data-testid="helm" data-state="steering" />
    );
  return (
    <span class="helm" data-testid="helm" data-state={h.waiting ? 'waiting' : 'watching'}>
      {h.waiting ? 'control requested' : 'View only'}
      {!h.waiting && (
        <button class="small" onClick={() => send({ type: 'steer', action: 'ask' })} data-testid="ask">
          {h.held ? 'Request control' : 'Take control'}
        </button>
      )}
    </span>
  );
}

export function App() {
  const ofFile = problems.value.filter((p) => p.line > 0).length; // the others are no error in it, as when the mesher did not start
  const sections: [Section, string][] = [
    ['simulate', 'Simulate'],
    ['make', 'Prepare'],
    ['print', 'Print'],
  ];
  return (
    <div class={`app ${info.value?.machine ? 'with-machine' : ''}`}>
      <div class="behind-dialogs" inert={dialogs.value > 0}>
        <header>
          <h1 class="brand">
            <svg viewBox="0 0 24 24" aria-hidden="true">
              <path d="M3 17c5.5 0 7-2.2 9-6.2S16.5 4.5 21 4.5" />
              <circle cx="3.5" cy="17" r="1.6" />
              <circle cx="20.5" cy="4.5" r="1.6" />
            </svg>
            Pliant
          </h1>
          <nav class="sections" aria-label="Sections">
            {sections.map(([name, label]) => (
              <a
                href={`#${name}`}
                aria-current={section.value === name ? 'page' : undefined}
                onClick={() => (section.value = name)}
                data-testid={`section-${name}`}
              >
                {label}
              </a>
            ))}
          </nav>
          <Open />
          <span class="grow" />
          {problems.value.length > 0 && (
            <span class="helm lost" data-testid="file-wrong">
              <Icon name="warn" />
              <span>
                {ofFile > 0 ? counted(ofFile, 'error') : 'the robot could not be built'}
                {ofFile > 0 && <span class="where"> in the file</span>}
              </span>
            </span>
          )}
          <Helm />
          <a class="bare" href="/help/" target="_blank" rel="noopener" aria-label="Documentation" title="Documentation" data-testid="help">
            <Icon name="help" />
          </a>
          <button class="bare" aria-label={theme.value === 'dark' ? 'Light theme' : 'Dark theme'} onClick={toggleTheme} data-testid="theme">
            <Icon name={theme.value === 'dark' ? 'sun' : 'moon'} />
          </button>
        </header>
        {section.value === 'simulate' && <Simulate />}
        {section.value === 'make' && <Make />}
        {section.value === 'print' && <Print />}
        <GuideBar />
      </div>
      <EmergencyStop />
      <Enlarged />
      <GeometryDrop />
      <DiscardQuestion />
      <SaveQuestion />
      {notice.value && (
        <div class="notice" role="alert" data-testid="notice">
          {notice.value}
        </div>
      )}
    </div>
  );
}
