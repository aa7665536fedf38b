// Tension, pressure, markers and residual beside the robot.
import { useEffect, useRef } from 'preact/hooks';
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { rough, scene } from '../store';
import { cssColour, theme } from '../theme';
import { pinned } from './view_state';
import { tracks, tracksVersion } from './tracks';

interface Line {
  label: string;
  colour: string;
  values: () => number[];
  unit: string;
}

/// Powers of ten, few enough to be told apart: every line of a logarithmic axis over many decades is a grey block.
function decades(least: number, most: number): number[] {
  const mostLines = 5;
  const [from, to] = [Math.ceil(Math.log10(least) - 1e-9), Math.floor(Math.log10(most) + 1e-9)];
  const stride = Math.max(1, Math.ceil((to - from + 1) / mostLines));
  const lines = [];
  for (let k = from; k <= to; k += stride) lines.push(10 ** k);
  return lines;
}

const palette = ['#d1495b', '#2e86ab', '#e08e2b', '#4c956c', '#8e6bbf', '#5f6b7a'];

function Plot({ title, lines, log, extra }: { title: string; lines: Line[]; log?: boolean; extra?: string }) {
  const box = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const key = lines.map((l) => l.label).join('|') + theme.value;
  useEffect(() => {
    const ink = cssColour('--faint');
    const grid = { stroke: cssColour('--line'), width: 1 };
    const axis = { stroke: ink, grid, ticks: { show: false }, font: '11px system-ui', size: 34, gap: 4 };
    const made = new uPlot(
      {
        width: box.current!.clientWidth,
        height: 132,
        padding: [8, 8, 0, 0],
        cursor: { points: { size: 7 }, drag: { x: false, y: false } },
        legend: { show: true, live: true },
        scales: { x: { time: false }, y: log ? { distr: 3 } : {} },
        axes: [
          { ...axis, size: 24, values: (_, v) => v.map((s) => `${s} s`) },
          { ...axis, size: 44, ...(log && { splits: (_: uPlot, __: number, least: number, most: number) => decades(least, most), filter: (_: uPlot, lines: number[]) => lines }), values: (_, v) => v.map((x) => (x == null ? '' : log ? x.toExponential(0) : `${+x.toPrecision(4)}`)) },
        ],
        series: [
          { label: 'time', value: (_, v) => (v == null ? '–' : `${v.toFixed(2)} s`) },
          ...lines.map((l) => ({
            label: l.label,
            stroke: l.colour,
            width: 2,
            points: { show: false },
            value: (_: uPlot, v: number | null) => (v == null ? '–' : `${log ? v.toExponential(1) : v.toPrecision(5)} ${l.unit}`),
          })),
        ],
      },
      [[], ...lines.map(() => [])] as uPlot.AlignedData,
      box.current!,
    );
    plot.current = made;
    const resize = new ResizeObserver(() => made.setSize({ width: box.current!.clientWidth, height: 132 }));
    resize.observe(box.current!);
    return () => {
      resize.disconnect();
      made.destroy();
    };
  }, [key]);
  useEffect(() => {
    let waiting = 0;
    const stop = tracksVersion.subscribe(() => {
      waiting ||= requestAnimationFrame(() => {
        waiting = 0;
        plot.current?.setData([tracks.seconds, ...lines.map((l) => l.values())] as uPlot.AlignedData);
      });
    });
    return () => {
      cancelAnimationFrame(waiting);
      stop();
    };
  }, [key]);
  return (
    <figure class="plot">
      <figcaption>
        {rough.value && !log && '≈ '}
        {title} {extra && <span class="quiet">{extra}</span>}
      </figcaption>
      <div ref={box} />
    </figure>
  );
}

export function Plots() {
  const head = scene.value?.head;
  if (!head) return null;
  const cables = head.actuators.filter((a) => a.type === 'cable');
  const chambers = head.actuators.filter((a) => a.type === 'chamber');
  const before = pinned.value?.frame.head;
  const line = (label: string, k: number, unit: string, values: () => number[]): Line => ({
    label,
    colour: palette[k % palette.length],
    unit,
    values,
  });
  return (
    <div class="plots" key={head.revision}>
      {cables.length > 0 && (
        <Plot
          title="Tension"
          extra={before && `pinned: ${before.cables.map((c) => c.tension_N.toPrecision(4)).join(', ')} N`}
          lines={cables.map((c, k) => line(c.name, k, 'N', () => tracks.cables[k] ?? []))}
        />
      )}
      {chambers.length > 0 && (
        <Plot
          title="Pressure"
          extra={before && `pinned: ${before.chambers.map((c) => c.pressure_kPa.toPrecision(4)).join(', ')} kPa`}
          lines={chambers.map((c, k) => line(c.name, k, 'kPa', () => tracks.chambers[k] ?? []))}
        />
      )}
      {head.markers.length > 0 && (
        <Plot title="Marker displacement" lines={head.markers.map((m, k) => line(m.name, k, 'mm', () => tracks.markers[k] ?? []))} />
      )}
      <Plot title="Residual" extra={`converged below ${head.tolerance}`} log lines={[line('residual', 5, '', () => tracks.residual)]} />
    </div>
  );
}
