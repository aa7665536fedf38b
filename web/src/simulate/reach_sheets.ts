// The workspace of a marker in the view: sheets as surfaces, all positions as dots, or a line of them.
import * as THREE from 'three';
import { emptied } from './drawn';

const colour = 0x2e86ab;

export interface Reach {
  sheet_points: number[]; // mm
  triangles: number[];
  points: number[]; // mm
}

export class ReachSheets {
  readonly group = new THREE.Group();

  show(reach: Reach | null) {
    emptied(this.group);
    if (!reach) return;
    const places = new THREE.BufferGeometry();
    places.setAttribute('position', new THREE.Float32BufferAttribute(reach.points, 3));
    this.add(new THREE.Points(places, new THREE.PointsMaterial({ color: colour, size: 4, sizeAttenuation: false, transparent: true, opacity: 0.9 })));
    if (reach.triangles.length) {
      const sheets = new THREE.BufferGeometry();
      sheets.setAttribute('position', new THREE.Float32BufferAttribute(reach.sheet_points, 3));
      sheets.setIndex(reach.triangles);
      this.add(new THREE.Mesh(sheets, new THREE.MeshBasicMaterial({ color: colour, transparent: true, opacity: 0.16, side: THREE.DoubleSide, depthWrite: false })));
    } else this.add(new THREE.Line(places, new THREE.LineBasicMaterial({ color: colour })));
  }

  private add(o: THREE.Object3D) {
    o.frustumCulled = false;
    o.renderOrder = 4;
    this.group.add(o);
  }
}
