// Picked points and the line between them, drawn over everything.
import * as THREE from 'three';
import { emptied } from './drawn';

const colour = 0xa64d86;

export class Measured {
  readonly group = new THREE.Group();

  /// Points as drawn, mm; `dot`: radius of the dots.
  show(points: THREE.Vector3[], dot: number) {
    emptied(this.group);
    const over = { depthTest: false, transparent: true };
    for (const p of points) {
      const ball = new THREE.Mesh(new THREE.SphereGeometry(dot, 16, 12), new THREE.MeshBasicMaterial({ color: colour, ...over }));
      ball.position.copy(p);
      ball.renderOrder = 14;
      this.group.add(ball);
    }
    if (points.length < 2) return;
    const line = new THREE.Line(new THREE.BufferGeometry().setFromPoints(points), new THREE.LineBasicMaterial({ color: colour, ...over }));
    line.renderOrder = 13;
    line.frustumCulled = false;
    this.group.add(line);
  }
}
