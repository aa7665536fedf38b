// The robot on the platform before slicing: moved, rotated, scaled, copied, in the colours of its materials. Clicking a
// face lays it on the platform, and supports can be painted on the part.
import { useEffect, useRef } from 'preact/hooks';
import { counted, millilitres } from '../counted';
import { orbitHelp } from '../orbit_keys';
import { scene } from '../store';
import { theme } from '../theme';
import { AxesCorner } from './axes_corner';
import { BedView, isBrush, tool } from './bed_view';
import { Brush } from './brush';
import { estimate } from './estimate';
import { copies, fields, printer, printerInfo, roomOf, scale, shift, turn } from './order';
import { strokes, touches } from './paint';
import { area, layOnFace, placed, type Degrees } from './place';
import { clock } from './plan';

/// "2", "2 mm" or "0.2 cm" in millimetres; the default for texts that the slicer will refuse.
function millimetres(text: string | undefined, usual: number): number {
  const match = /^\s*([\d.eE+-]+)\s*(um|µm|mm|cm|m|in)?\s*$/.exec(text ?? '');
  const value = match ? Number(match[1]) : NaN;
  const scale = { um: 1e-3, µm: 1e-3, mm: 1, cm: 10, m: 1000, in: 25.4 }[match?.[2] ?? 'mm'] ?? 1;
  return Number.isFinite(value) && value >= 0 ? value * scale : usual;
}

export function Bed() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const axes = useRef<SVGSVGElement>(null);
  const shown = useRef<BedView | null>(null);
  const s = scene.value;
  const p = printerInfo.value;
  const spacing = millimetres(fields.value.spacing, 2);
  const count = Math.max(1, Math.min(1000, Math.round(copies.value) || 1));
  const where = s && p ? placed(s.f32('rest'), turn.value, count, spacing, roomOf(p), p.platform.height_mm, scale.value, shift.value) : null;
  const materials = s?.head.materials.map((m) => m.name) ?? [];
  const e = estimate.value;
  const angle = Number(fields.value['support-angle'] || 45);
  const flattest = isBrush(tool.value) && Number.isFinite(angle) ? angle : -1;

  useEffect(() => {
    if (!s) return;
    let view: BedView;
    try {
      view = new BedView(canvas.current!, axes.current!, s, {
        move: (dx, dy) => (shift.value = [shift.value[0] + dx, shift.value[1] + dy].map((v) => Math.round(10 * v) / 10) as [number, number]),
        face: (normal) => {
          tool.value = 'move';
          turn.value = layOnFace(turn.value, normal);
        },
        paint: (touch, first) => {
          const all = strokes.value;
          strokes.value = first || all.length === 0 ? [...all, { touches: [touch] }] : [...all.slice(0, -1), { touches: [...all[all.length - 1].touches, touch] }];
        },
      });
    } catch {
      return; // no WebGL: form and estimate still work
    }
    shown.current = view;
    if (where && p) view.show(where, turn.value, scale.value, shift.value, p);
    view.paint(touches(), flattest);
    return () => {
      shown.current = null;
      view.dispose();
    };
  }, [s?.head.revision, theme.value]);
  useEffect(() => {
    if (where && p) shown.current?.show(where, turn.value, scale.value, shift.value, p);
  }, [JSON.stringify(where?.size), JSON.stringify(turn.value), scale.value, JSON.stringify(shift.value), count, spacing, printer.value, p]);
  useEffect(() => shown.current?.paint(touches(), flattest), [strokes.value, flattest]);

  const quarter = (axis: number) => (turn.value = turn.value.map((t, k) => (k === axis ? ((t + 90 + 180) % 360) - 180 : t)) as Degrees);
  const asDrawn = turn.value.every((t) => t === 0) && scale.value === 1 && shift.value.every((v) => v === 0);
  if (!s) return <div class="empty"><h2>No robot</h2></div>;
  const help = isBrush(tool.value) ? `Enter paints at the middle of the view. ${orbitHelp}` : tool.value === 'face' ? `Enter lays down the face at the middle of the view. ${orbitHelp}` : `Drag the robot to move it. ${orbitHelp}`;
  return (
    <div class="layers" data-testid="bed" data-fits={where?.fits ?? true} data-tool={tool.value}>
      <div class={`canvas ${tool.value === 'move' ? '' : 'picking'}`}>
        <canvas ref={canvas} tabIndex={0} aria-label={`The robot on the platform. ${help}`} data-testid="bed-view" />
        <AxesCorner drawing={axes} />
      </div>
      <div class="bed-foot">
        {isBrush(tool.value) ? (
          <p class="estimate">
            <span class="swatch" style={{ background: '#a3317f' }} />
            undersides flatter than {angle}° are supported automatically; only downward-facing faces can be painted
          </p>
        ) : (
          e && (
            <p class="estimate" role="status" data-testid="estimate">
              about <b>{clock(e.seconds)}</b> · {counted(e.layers, 'layer')} · {counted(e.swaps, 'swap')}
              {Object.entries(e.resin_ml).map(([resin, ml]) => ` · ${millilitres(ml)} ${resin}`)}
            </p>
          )
        )}
        <div class="row left wrap">
          {!isBrush(tool.value) && (
            <>
              <button class="chip" aria-pressed={tool.value === 'face'} onClick={() => (tool.value = tool.value === 'face' ? 'move' : 'face')} data-testid="lay-on-face">
                {tool.value === 'face' ? 'Click the face to lay down' : 'Lay on face'}
              </button>
              {['x', 'y', 'z'].map((axis, k) => (
                <button class="chip" onClick={() => quarter(k)} aria-label={`Rotate by 90 degrees about ${axis}`} data-testid={`turn-${axis}`}>
                  {axis} 90°
                </button>
              ))}
              <button
                class="chip"
                disabled={asDrawn}
                data-testid="reset-placement"
                onClick={() => {
                  turn.value = [0, 0, 0];
                  scale.value = 1;
                  shift.value = [0, 0];
                }}
              >
                Reset placement
              </button>
            </>
          )}
          <Brush materials={materials} lookUp={() => shown.current?.lookUp()} />
        </div>
      </div>
      {where && (
        <div class="layer-info">
          <b>{where.size.map((v) => v.toFixed(1)).join(' × ')} mm</b>
          {where.fits && <span class="quiet">on {area(roomOf(p!)).map((v) => +v.toFixed(1)).join(' × ')} mm, grid of 10 mm</span>}
          {!where.fits && <span class="problems-inline" role="alert">does not fit {area(roomOf(p!)).map((v) => v.toFixed(1)).join(' × ')} × {p!.platform.height_mm.toFixed(0)} mm{shift.value.some((v) => v !== 0) && ' there'}</span>}
        </div>
      )}
    </div>
  );
}
