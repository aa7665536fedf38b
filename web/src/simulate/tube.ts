// A round tube along a polyline, for drawing cables.
import * as THREE from 'three';

const sides = 12;

export class Tube {
  readonly geometry = new THREE.BufferGeometry();
  private count = 0;

  constructor(private readonly radius: number) {}

  /// (3n) n points, mm.
  update(points: ArrayLike<number>) {
    const n = points.length / 3;
    if (n !== this.count) this.allocate(n);
    if (n < 2) return;
    const position = this.geometry.getAttribute('position') as THREE.BufferAttribute;
    const normal = this.geometry.getAttribute('normal') as THREE.BufferAttribute;
    const at = (k: number) => new THREE.Vector3(points[3 * k], points[3 * k + 1], points[3 * k + 2]);
    const way = (k: number) => at(k + 1).sub(at(k)).normalize();
    let across = new THREE.Vector3(0, 0, 1);
    for (let k = 0; k < n; ++k) {
      const along = way(Math.min(k, n - 2)).add(way(Math.max(k - 1, 0)));
      if (along.lengthSq() < 1e-12) along.copy(way(Math.min(k, n - 2)));
      along.normalize();
      // Parallel transport of the frame, so that the tube does not twist.
      across.addScaledVector(along, -across.dot(along));
      if (across.lengthSq() < 1e-6) across = new THREE.Vector3(along.y, along.z, -along.x).addScaledVector(along, -along.dot(new THREE.Vector3(along.y, along.z, -along.x)));
      across.normalize();
      const other = new THREE.Vector3().crossVectors(along, across);
      for (let s = 0; s < sides; ++s) {
        const angle = (2 * Math.PI * s) / sides;
        const out = across.clone().multiplyScalar(Math.cos(angle)).addScaledVector(other, Math.sin(angle));
        const p = at(k).addScaledVector(out, this.radius);
        position.setXYZ(k * sides + s, p.x, p.y, p.z);
        normal.setXYZ(k * sides + s, out.x, out.y, out.z);
      }
    }
    position.needsUpdate = normal.needsUpdate = true;
  }

  private allocate(n: number) {
    this.count = n;
    this.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * n * sides), 3));
    this.geometry.setAttribute('normal', new THREE.BufferAttribute(new Float32Array(3 * n * sides), 3));
    const index: number[] = [];
    for (let k = 0; k + 1 < n; ++k)
      for (let s = 0; s < sides; ++s) {
        const [a, b] = [k * sides + s, k * sides + ((s + 1) % sides)];
        index.push(a, b, a + sides, b, b + sides, a + sides);
      }
    this.geometry.setIndex(index);
  }
}
