// The layers of a job while it is being sliced: the first ones are seen before the last one is made.
import { useEffect, useRef, useState } from 'preact/hooks';
import { api, slicing } from '../store';
import type { Job } from '../types';
import { layer, Layers } from './layers';

interface SoFar {
  layers: number;
  count: number;
  colours: string[];
  manifest: Job['manifest'];
}

const between = 700; // ms from one look to the next
let slicings = 0; // tells the images of one from those of the next

export function UnderWay() {
  const [soFar, setSoFar] = useState<SoFar | null>(null);
  const run = useRef(0);
  const newest = useRef(true); // nobody has gone to another layer
  const shown = useRef(-1);
  useEffect(() => {
    run.current = ++slicings;
    let gone = false;
    const look = async () => {
      const told = (await (await api('/api/job/under-way')).json()) as SoFar | null;
      if (gone || !told) return;
      newest.current = newest.current && (shown.current < 0 || layer.value === shown.current);
      if (newest.current) layer.value = shown.current = told.manifest.layers.length - 1;
      setSoFar(told);
    };
    const timer = setInterval(() => void look().catch(() => {}), between); // the next look may find it
    void look().catch(() => {});
    return () => {
      gone = true;
      clearInterval(timer);
    };
  }, []);
  if (!soFar) return null;
  const job = {
    revision: -run.current,
    colours: soFar.colours,
    manifest: soFar.manifest,
    at: (l: number, m: number) => `/api/job/under-way/${soFar.manifest.layers[l].number}/${m}?slicing=${run.current}`,
  } as Job;
  return (
    <div data-testid="under-way" data-layers={soFar.layers}>
      <Layers job={job} of={soFar.count} />
      <p class="under-way" role="status">
        {slicing.value?.stage ?? 'slice'}: {soFar.layers} of {soFar.count} layers
      </p>
    </div>
  );
}
