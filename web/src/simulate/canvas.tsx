// The 3D view of the robot, and what is shown in it.
import { effect } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { orbitHelp, orbitKeys } from '../orbit_keys';
import { frame, mayDrive, say, scene, send, sendInput, wantFields } from '../store';
import { comparing, ranges, tellRange } from './beside';
import { draft, placed, takePlace } from './build';
import { path } from './goal';
import { restoreLink } from './link';
import { panel } from './panel';
import { presetKey, takePick } from './stage_tools';
import { drawn, theView } from './the_view';
import { RobotView } from './view';
import * as look from './view_state';
import { reach } from './workspace';

export function options() {
  const fixed = look.fixedRange.value;
  return {
    field: look.field.value,
    scale: look.fieldNames.find((f) => f.name === look.field.value)!.scale,
    wireframe: look.wireframe.value,
    ghost: look.ghost.value,
    inside: look.showInside.value,
    exploded: look.exploded.value,
    sectionAxis: look.sectionAxis.value,
    sectionAt: look.sectionAt.value,
    sectionFlipped: look.sectionFlipped.value,
    map: look.map.value,
    bands: look.bands.value,
    range: fixed && fixed.field === look.field.value ? ([fixed.low, fixed.high] as [number, number]) : rangeOfBoth(),
    pinned: look.pinned.value?.positions ?? null,
    beside: look.beside.value,
  };
}

/// A common range, so that a colour means the same value in both robots; null if there is only one.
function rangeOfBoth(): [number, number] | null {
  const [a, b] = ranges.value;
  return comparing.value && a && b ? [Math.min(a[0], b[0]), Math.max(a[1], b[1])] : null;
}

export function Canvas() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const labels = useRef<HTMLDivElement>(null);
  useEffect(() => {
    let made: RobotView;
    try {
      made = theView.value = new RobotView(canvas.current!);
    } catch {
      say('This browser has no WebGL, so the robot cannot be drawn.');
      return;
    }
    let pending = 0;
    let last: Record<string, unknown> | null = null;
    made.pointer.mayGrab = () => mayDrive.value && look.shownFrame.value === null;
    made.pointer.onGrab = (grab) => {
      if (!grab) {
        last = null;
        return send({ type: 'release' });
      }
      const marker = scene.value?.head.markers[grab.marker]?.name;
      last = marker === undefined ? { type: 'pull', vertex: grab.vertex, to: grab.to } : { type: 'lead', marker, to: grab.to };
      pending ||= requestAnimationFrame(() => {
        pending = 0;
        if (last) sendInput(last);
      });
    };
    made.onData = (low, high) => comparing.peek() && tellRange(0, low, high);
    made.onRange = (low, high) => (look.fieldRange.value = [low, high]);
    made.pointer.onPick = (pick, rest, inward) => {
      if (look.measuring.peek()) return takePick(pick), true;
      return takePlace(rest, inward);
    };
    made.onDraw = (project, camera) => {
      drawn(project, camera);
      const shown = look.shownFrame.value ?? frame.value;
      const children = labels.current?.children ?? [];
      shown?.head.markers.forEach((p, k) => {
        const [x, y] = project(p);
        const label = children[k] as HTMLElement | undefined;
        if (label) label.style.transform = `translate(${x + 9}px, ${y - 10}px)`;
      });
    };
    const stops = [
      effect(() => {
        if (!scene.value) {
          look.shownFrame.value = null;
          return made.clear();
        }
        made.setScene(scene.value);
        // The order of the two effects is undefined: a frame before its scene would be lost.
        const shown = look.shownFrame.peek() ?? frame.peek();
        if (shown) made.setFrame(shown);
        void restoreLink();
      }),
      effect(() => made.setOptions(options())),
      effect(() => made.setPicks(look.picks.value)),
      effect(() => made.setDraft(draft.value)),
      effect(() => made.setReach(panel.value === 'workspace' ? reach.value : null)),
      effect(() => made.setPath(panel.value === 'goal' ? path.value : panel.value === 'build' ? placed.value : [])),
      effect(() => {
        const shown = look.shownFrame.value ?? frame.value;
        if (shown) made.setFrame(shown);
      }),
      effect(() => {
        const f = look.field.value;
        wantFields(f === 'material' || f === 'displacement' ? [] : [f]);
      }),
    ];
    return () => {
      for (const stop of stops) stop();
      made.dispose();
      theView.value = null;
    };
  }, []);
  const keys = (e: KeyboardEvent) => {
    if (presetKey(e.key)) return e.preventDefault();
    orbitKeys(e, (around, up, nearer) => theView.value?.turn(around, up, nearer), () => theView.value?.lookAt());
  };
  return (
    <div class="canvas">
      <canvas
        ref={canvas}
        tabIndex={0}
        role="application"
        aria-label={`The robot in 3D. ${orbitHelp} Keys 0 to 6 select a standard view.`}
        onKeyDown={keys}
        data-testid="view"
      />
      <div class="labels" ref={labels} aria-hidden="true">
        {scene.value?.head.markers.map((m) => <span key={m.name}>{m.name}</span>)}
      </div>
    </div>
  );
}
