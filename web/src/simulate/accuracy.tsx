// Choice between linear and quadratic elements, and the hint where linear ones are shown.
import { documentState, mayDrive, post, scene } from '../store';
import type { Accuracy } from '../types';

const setAccuracy = (accuracy: Accuracy) => void post('/api/accuracy', { accuracy });

/// A hint on the accuracy of linear elements: too stiff in bending, especially with few elements through a wall. If the
/// robot is refined automatically as soon as the input rests, the mark at its numbers is enough.
export function Rough() {
  const accuracy = scene.value?.head.accuracy;
  if (accuracy === 'automatic' && scene.value?.head.order === 2) return null;
  return (
    <span class="rough" data-testid="rough">
      Linear elements are too stiff: forces can be 1.3 to 3 times too large, displacements too small.{' '}
      {accuracy !== 'preview' ? (
        <>
          The file asks for them: <code>mesh.order = 1</code>.
        </>
      ) : (
        <button class="small" disabled={!mayDrive.value} onClick={() => setAccuracy('automatic')} data-testid="refine">
          Refine
        </button>
      )}
    </span>
  );
}

const accuracies: [Accuracy, string, string][] = [
  ['automatic', 'auto', 'Linear elements while you move something, marked ≈, and quadratic ones as soon as it rests'],
  ['preview', '≈ fast', 'Linear elements only: quick, but forces can be 1.3 to 3 times too large'],
  ['fine', 'accurate', 'Quadratic elements only, those of pliant simulate'],
];

export function Accuracies() {
  return (
    <div class="segments" role="group" aria-label="Elements">
      {accuracies.map(([name, label, title]) => (
        <button key={name} title={title} aria-pressed={documentState.value.accuracy === name} disabled={!mayDrive.value} onClick={() => setAccuracy(name)} data-testid={name}>
          {label}
        </button>
      ))}
    </div>
  );
}
