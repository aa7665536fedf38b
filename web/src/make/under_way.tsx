// The layers of a job while it is being sliced.
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

const between = 700; // ms between updates
let slicings = 0; // distinguishes the images of different jobs

export function UnderWay() {
  const [soFar, setSoFar] = useState<SoFar | null>(null);
  const run = useRef(0);
  const newest = useRef(true); // show the newest layer, until the user selects another
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
    const timer = setInterval(() => void look().catch(() => {}), between); // retried by the next update
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
