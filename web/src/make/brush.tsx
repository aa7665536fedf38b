// The support brush: what it paints, its radius, and undo.
import { mayDrive, say } from '../store';
import { brush, isBrush, tool, type Tool } from './bed_view';
import { support } from './order';
import { paintTable, readPaint, strokes, touches, wishColours } from './paint';

export function Brush({ materials, lookUp }: { materials: string[]; lookUp: () => void }) {
  const on = isBrush(tool.value);
  const pick = (t: Tool) => {
    if (tool.value === t) {
      tool.value = 'move';
      return;
    }
    if (isBrush(t) && !support.value) support.value = materials[0] ?? '';
    if (!on) lookUp();
    tool.value = t;
  };
  const save = () => {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([paintTable(touches())], { type: 'text/csv' }));
    link.download = 'supports.csv';
    link.click();
    URL.revokeObjectURL(link.href);
  };
  const load = async (file: File | undefined) => {
    if (!file) return;
    try {
      strokes.value = [...strokes.value, { touches: readPaint(await file.text()) }];
    } catch (error) {
      say(`${file.name}: ${(error as Error).message}`);
    }
  };
  if (!on)
    return (
      <button class="chip" disabled={!mayDrive.value} onClick={() => pick('enforce')} data-testid="paint">
        Paint supports{strokes.value.length > 0 && ` (${strokes.value.length})`}
      </button>
    );
  return (
    <div class="brush" role="group" aria-label="Paint supports" data-testid="brush">
      <span class="segments" role="group" aria-label="What the brush paints">
        {([['enforce', 'Enforce'], ['block', 'Block'], ['usual', 'Erase']] as const).map(([t, label]) => (
          <button aria-pressed={tool.value === t} onClick={() => (tool.value = t)} data-testid={`brush-${t}`}>
            {t !== 'usual' && <span class="swatch" style={{ background: wishColours[t] }} />}
            {label}
          </button>
        ))}
      </span>
      <label class="inline">
        Radius
        <input type="range" min={0.5} max={10} step={0.5} value={brush.value} onInput={(e) => (brush.value = Number(e.currentTarget.value))} data-testid="brush-radius" />
        <output>{brush.value} mm</output>
      </label>
      <label class="inline">
        in
        <select value={support.value} aria-label="Material of supports" onChange={(e) => (support.value = e.currentTarget.value)}>
          {materials.map((m) => (
            <option value={m}>{m}</option>
          ))}
        </select>
      </label>
      <button class="small" disabled={strokes.value.length === 0} onClick={() => (strokes.value = strokes.value.slice(0, -1))} data-testid="brush-undo">
        Undo stroke
      </button>
      <button class="small" disabled={strokes.value.length === 0} onClick={() => (strokes.value = [])} data-testid="brush-clear">
        Clear
      </button>
      <button class="small" disabled={strokes.value.length === 0} onClick={save} title="CSV file for pliant slice --support-paint" data-testid="brush-save">
        Save
      </button>
      <label class="button small file-button">
        Load
        <input type="file" accept=".csv" class="unseen" onChange={(e) => void load(e.currentTarget.files?.[0])} data-testid="brush-load" />
      </label>
      <button class="primary small" onClick={() => (tool.value = 'move')} data-testid="brush-done">
        Done
      </button>
    </div>
  );
}
