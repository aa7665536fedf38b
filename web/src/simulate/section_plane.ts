// The section through a robot: the plane that cuts it, and the sheet that shows where it lies.
import * as THREE from 'three';

export interface SectionChoice {
  sectionAxis: '' | 'x' | 'y' | 'z';
  sectionAt: number; // 0 to 1, along the robot
  sectionFlipped?: boolean;
}

/// Where the plane lies, and the range of its slider, mm.
export interface SectionPlace {
  centre: THREE.Vector3;
  axis: number;
  low: number;
  high: number;
}

export class SectionPlane {
  readonly plane = new THREE.Plane(new THREE.Vector3(-1, 0, 0), 0);
  readonly sheet = new THREE.Group();
  place: SectionPlace | null = null;

  constructor() {
    const corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(([x, y]) => new THREE.Vector3(x, y, 0));
    const edge = new THREE.LineLoop(new THREE.BufferGeometry().setFromPoints(corners), new THREE.LineBasicMaterial({ color: 0x2e86ab, transparent: true, opacity: 0.8 }));
    const fill = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), new THREE.MeshBasicMaterial({ color: 0x2e86ab, transparent: true, opacity: 0.07, side: THREE.DoubleSide, depthWrite: false }));
    edge.renderOrder = fill.renderOrder = 12;
    this.sheet.add(edge, fill);
    this.sheet.visible = false;
  }

  /// Puts the plane into a robot of these bounds as drawn. The sheet is larger than it by `rim`.
  cut(choice: SectionChoice, box: THREE.Box3, rim: number) {
    this.sheet.visible = choice.sectionAxis !== '';
    if (!choice.sectionAxis) return;
    const axis = { x: 0, y: 1, z: 2 }[choice.sectionAxis];
    const at = box.min.getComponent(axis) + choice.sectionAt * (box.max.getComponent(axis) - box.min.getComponent(axis));
    const keep = (choice.sectionAxis === 'y') !== (choice.sectionFlipped ?? false) ? 1 : -1;
    this.plane.normal.set(0, 0, 0).setComponent(axis, keep);
    this.plane.constant = -keep * at;
    const size = box.getSize(new THREE.Vector3()).addScalar(rim);
    const centre = box.getCenter(new THREE.Vector3()).setComponent(axis, at);
    this.sheet.position.copy(centre);
    this.sheet.rotation.set(0, 0, 0);
    if (choice.sectionAxis === 'x') this.sheet.rotation.set(Math.PI / 2, Math.PI / 2, 0);
    if (choice.sectionAxis === 'y') this.sheet.rotation.set(Math.PI / 2, 0, 0);
    const [w, h] = choice.sectionAxis === 'x' ? [size.y, size.z] : choice.sectionAxis === 'y' ? [size.x, size.z] : [size.x, size.y];
    this.sheet.scale.set(w, h, 1);
    this.place = { centre, axis, low: box.min.getComponent(axis), high: box.max.getComponent(axis) };
  }

  /// True for points that the section has left.
  keeps(point: THREE.Vector3) {
    return this.plane.distanceToPoint(point) >= 0;
  }
}
