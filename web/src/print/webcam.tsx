// The camera image of the machine, if `pliant studio --webcam` gives an address.
import { useEffect, useState } from 'preact/hooks';
import { api } from '../store';

const every = 2000; // ms between still pictures; a stream updates itself

/// Streams are shown as they are, still pictures are reloaded.
const isStream = (address: string) => /stream|mjpe?g|\.cgi|action=/i.test(address);

export function Webcam() {
  const [address, setAddress] = useState('');
  const [count, setCount] = useState(0);
  const [lost, setLost] = useState(false);
  useEffect(() => {
    api('/api/project')
      .then((r) => r.json())
      .then((p: { webcam?: string }) => setAddress(p.webcam ?? ''))
      .catch(() => setAddress(''));
  }, []);
  useEffect(() => {
    if (!address || (isStream(address) && !lost)) return;
    const timer = setInterval(() => setCount((n) => n + 1), every);
    return () => clearInterval(timer);
  }, [address, lost]);
  if (!address) return null;
  const source = isStream(address) && count === 0 ? address : `${address}${address.includes('?') ? '&' : '?'}pliant=${count}`;
  return (
    <figure class="webcam" data-testid="webcam" data-state={lost ? 'lost' : 'shown'}>
      <img src={source} alt="The machine, seen by its camera" onError={() => setLost(true)} onLoad={() => setLost(false)} hidden={lost} />
      {lost && <div class="dark">no picture from the camera</div>}
      <figcaption>camera</figcaption>
    </figure>
  );
}
