// The part printed so far: slabs of cells, fetched piece by piece as it grows.
import { signal } from '@preact/signals';
import { readPacket } from '../packet';
import { api, onEvent } from '../store';

interface Head {
  kind: 'cured' | 'exposed' | 'drawn';
  revision: number;
  from: number;
  closed: number;
  cell_px: number;
  height_mm: number;
}

export interface Slab {
  bottom: number; // mm below the platform
  top: number;
  runs: Uint32Array; // three numbers per run, see docs/reference/studio.md
}

export interface Part {
  kind: 'cured' | 'exposed' | 'drawn';
  height: number;
  cell_px: number;
  revision: number;
  slabs: Slab[];
  changedFrom: number; // slabs before this index are unchanged, if the revision is the same
}

export const part = signal<Part | null>(null);

let closed = 0;
let fetching = false;
let stale = false;
let wanted = 0; // number of views that show it

/// Decodes a packet; `known` is the part received before.
export function partOf(buffer: ArrayBuffer, known: Part | null): { part: Part; closed: number } {
  const packet = readPacket<Head>(buffer);
  const { head } = packet;
  const same = known !== null && known.revision === head.revision;
  const slabs = same ? known.slabs.slice(0, head.from) : [];
  const heights = packet.f32('slabs');
  const runs = packet.u32('runs');
  let at = 0;
  for (let s = 0; s < heights.length / 2; ++s) {
    const first = at;
    while (at < runs.length && (runs[at] & 0xffffff) === head.from + s) at += 3;
    slabs.push({ bottom: heights[2 * s], top: heights[2 * s + 1], runs: runs.slice(first, at) });
  }
  const { kind, height_mm: height, cell_px, revision } = head;
  return { part: { kind, height, cell_px, revision, slabs, changedFrom: same ? head.from : 0 }, closed: head.closed };
}

function take(buffer: ArrayBuffer) {
  const read = partOf(buffer, part.value);
  closed = read.closed;
  part.value = read.part;
}

/// One request at a time: on a slow connection the increments are larger.
async function fetchPart() {
  if (fetching) {
    stale = true;
    return;
  }
  fetching = true;
  do {
    stale = false;
    try {
      const known = part.value;
      const answer = await api(`/api/print/part?revision=${known?.revision ?? -1}&from=${known ? closed : 0}`);
      const bytes = answer.status === 204 ? null : await answer.arrayBuffer(); // 204: no machine
      // An increment of a part that has been cleared meanwhile would be a part without its first slabs.
      if (part.value !== known) stale = true;
      else if (!bytes) part.value = null;
      else take(bytes);
    } catch {
      part.value = null; // no studio: requested again after the next event
    }
  } while (stale);
  fetching = false;
}

onEvent((event) => {
  if (event.type === 'machine') part.value = null;
  if (wanted > 0 && event.type === 'part') void fetchPart();
});

/// Keeps the part up to date while a view is open.
export function followPart() {
  ++wanted;
  void fetchPart();
  return () => {
    --wanted;
  };
}
