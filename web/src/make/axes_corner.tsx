// The directions x, y and z of the platform in a corner of the view, which rotate with it.
import type { Ref } from 'preact';
import type { Camera } from 'three';

const names = ['x', 'y', 'z'];
const middle = 36; // px
const arm = 24;

/// Rotates the drawing of `AxesCorner` to the directions in which this camera sees them.
export function turnAxes(drawing: SVGSVGElement, camera: Camera) {
  const m = camera.matrixWorldInverse.elements;
  names.forEach((_, k) => {
    const [x, y] = [m[4 * k], -m[4 * k + 1]]; // on the screen y points down
    const [line, name] = [drawing.children[2 * k], drawing.children[2 * k + 1]];
    line.setAttribute('x2', (middle + arm * x).toFixed(1));
    line.setAttribute('y2', (middle + arm * y).toFixed(1));
    name.setAttribute('x', (middle + 1.35 * arm * x).toFixed(1));
    name.setAttribute('y', (middle + 1.35 * arm * y).toFixed(1));
  });
}

export function AxesCorner({ drawing }: { drawing: Ref<SVGSVGElement> }) {
  return (
    <svg class="axes-corner" viewBox="0 0 72 72" aria-hidden="true" ref={drawing} data-testid="axes-corner">
      {names.flatMap((name) => [
        <line key={name} class={`axis ${name}`} x1={middle} y1={middle} x2={middle} y2={middle} />,
        <text key={`${name}t`} class={`axis ${name}`}>{name}</text>,
      ])}
    </svg>
  );
}
