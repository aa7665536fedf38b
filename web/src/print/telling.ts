// The text and icon of the tab for a print.

export interface Telling {
  title: string;
  share: number | null; // progress of a running print
  colour: string;
}

/// What the tab shows. Nothing about a print if the page does not know its state.
export function tellingOf(is: { machine: boolean; known: boolean; busy: boolean; paused: boolean; error: boolean; finished: boolean; completion: number; job: string }, usual: string): Telling {
  const plain = { title: usual, share: null, colour: '' };
  if (!is.machine) return plain;
  if (!is.known) return { title: `? ${is.job} · ${usual}`, share: null, colour: '#8a93a0' };
  if (is.error) return { title: `Stopped: ${is.job} · ${usual}`, share: 1, colour: '#c62f2f' };
  if (is.busy) {
    const share = Math.min(Math.max(is.completion, 0), 100) / 100;
    const percent = `${Math.floor(100 * share)} %`;
    return { title: `${is.paused ? 'Paused, ' : ''}${percent} ${is.job} · ${usual}`, share, colour: is.paused ? '#c58a12' : '#2d6cdf' };
  }
  return is.finished ? { title: `Printed: ${is.job} · ${usual}`, share: 1, colour: '#1f8a4c' } : plain;
}
