// The log of the print.
import { useEffect, useRef } from 'preact/hooks';
import { clock } from '../make/plan';
import { events, now } from './state';

export function Log() {
  const list = useRef<HTMLOListElement>(null);
  const atEnd = useRef(true); // do not scroll if the user has scrolled up
  const top = useRef(0);
  const shown = events.value.filter((e) => e.kind !== 'dark').slice(-120);
  const begun = now.value!.progress.begun;
  // Counted like the elapsed time: from the start of the print.
  const at = (e: { clock: number }) => (begun === null || e.clock < begun - 0.5 ? '' : clock(Math.max(0, e.clock - begun)));
  const last = shown[shown.length - 1]?.number;
  useEffect(() => {
    if (list.current && atEnd.current) list.current.scrollTop = list.current.scrollHeight;
  }, [last]);
  return (
    <section class="block">
      <h3>Log</h3>
      <ol
        class="log"
        ref={list}
        tabIndex={0}
        aria-label="Log of the print"
        data-testid="log"
        onScroll={(e) => {
          const { scrollTop, scrollHeight, clientHeight } = e.currentTarget;
          if (scrollHeight - scrollTop - clientHeight < 30) atEnd.current = true;
          else if (scrollTop < top.current - 2) atEnd.current = false;
          top.current = scrollTop;
        }}
      >
        {shown.map((e) => (
          <li class={e.kind} key={e.number}>
            <time>{at(e)}</time>
            <span>{e.kind === 'layer' ? `layer ${e.text}` : e.text}</span>
          </li>
        ))}
      </ol>
    </section>
  );
}
