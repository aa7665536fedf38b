// The pointer in the view: picks points of the surface and markers, and grabs them to pull the robot.
import * as THREE from 'three';
import { Line2 } from 'three/addons/lines/Line2.js';
import { LineGeometry } from 'three/addons/lines/LineGeometry.js';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import type { Pick } from './view_state';
import type { Viewpoint } from './viewpoint';

/// What the user has grabbed: a point of the surface, or a marker.
export interface Grab {
  vertex: number;
  marker: number; // -1: none
  to: [number, number, number];
}

/// What can be under the pointer.
export interface PointerTarget {
  mesh: THREE.Mesh;
  markers: THREE.Mesh[];
  rest: Float32Array; // mm, of the mesh's vertices
  markersAtRest: [number, number, number][]; // mm
  size: number; // of the robot, mm
  keeps: (point: THREE.Vector3) => boolean; // false: a section has cut it away
  canBePulled: boolean;
}

type Held = { vertex: number; marker: number };

const markerReach = 10; // pixels from its dot
const yellow = 0xf2b705;

export class Pointer {
  /// The line from what is grabbed to the pointer.
  readonly group = new THREE.Group();
  private readonly arrow = new Line2(new LineGeometry(), new LineMaterial({ color: yellow, linewidth: 3, depthTest: false }));
  private readonly handle = new THREE.Mesh(
    new THREE.SphereGeometry(1, 24, 16),
    new THREE.MeshBasicMaterial({ color: yellow, depthTest: false, transparent: true }),
  );
  private grabbing: (Held & { plane: THREE.Plane }) | null = null;
  onGrab: (grab: Grab | null) => void = () => {};
  mayGrab = () => true;
  /// Called for a press while measuring or placing, with what is under the pointer. True: handled. `rest` is the
  /// position at rest, `inward` the unit normal there into the body.
  onPick: (pick: Pick, rest: [number, number, number], inward: [number, number, number]) => boolean = () => false;

  /// `target`: null while there is no robot. `changed`: something has to be drawn.
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly viewpoint: Viewpoint,
    private readonly target: () => PointerTarget | null,
    private readonly changed: () => void,
  ) {
    this.arrow.visible = this.handle.visible = false;
    this.arrow.renderOrder = this.handle.renderOrder = 10;
    this.group.add(this.arrow, this.handle);
    canvas.addEventListener('pointerdown', (e) => this.down(e), { capture: true });
    canvas.addEventListener('pointermove', (e) => this.move(e));
    canvas.addEventListener('pointerup', () => this.up());
    canvas.addEventListener('pointercancel', () => this.up());
  }

  /// Draws the line again: the robot has moved.
  update() {
    const grab = this.grabbing;
    this.arrow.visible = this.handle.visible = grab !== null;
    const target = this.target();
    if (!grab || !target) return;
    const geometry = new LineGeometry();
    geometry.setPositions([...this.placeOf(target, grab).toArray(), ...this.handle.position.toArray()]);
    this.arrow.geometry.dispose();
    this.arrow.geometry = geometry;
    this.handle.scale.setScalar(0.012 * target.size);
  }

  /// Position of a picked point as drawn, mm.
  placeOfPick(pick: Pick): THREE.Vector3 | null {
    const target = this.target();
    if (!target) return null;
    if ('marker' in pick) return target.markers[pick.marker]?.position.clone() ?? null;
    return pick.vertex < target.mesh.geometry.getAttribute('position').count ? vertexOf(target.mesh, pick.vertex) : null;
  }

  private placeOf(target: PointerTarget, what: Held) {
    return what.marker >= 0 ? target.markers[what.marker].position.clone() : vertexOf(target.mesh, what.vertex);
  }

  private ray(e: PointerEvent) {
    const box = this.canvas.getBoundingClientRect();
    const at = new THREE.Vector2(((e.clientX - box.left) / box.width) * 2 - 1, 1 - ((e.clientY - box.top) / box.height) * 2);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(at, this.viewpoint.camera);
    return ray;
  }

  private down(e: PointerEvent) {
    if (e.button !== 0 || e.shiftKey) return;
    const target = this.target();
    if (!target || this.pick(e, target) || !this.mayGrab() || !target.canBePulled) return;
    const marker = this.markerAt(e, target);
    if (marker >= 0) return this.hold(e, target, { vertex: -1, marker });
    const hit = this.hitAt(e, target);
    if (hit?.face) this.hold(e, target, { vertex: nearestVertex(target.mesh, hit), marker: -1 });
  }

  private move(e: PointerEvent) {
    if (!this.grabbing) return;
    const at = this.ray(e).ray.intersectPlane(this.grabbing.plane, new THREE.Vector3());
    if (!at) return;
    this.handle.position.copy(at);
    this.update();
    this.onGrab({ vertex: this.grabbing.vertex, marker: this.grabbing.marker, to: at.toArray() });
    this.changed();
  }

  private up() {
    if (!this.grabbing) return;
    this.grabbing = null;
    this.viewpoint.controls.enabled = true;
    this.canvas.style.cursor = '';
    this.update();
    this.onGrab(null);
    this.changed();
  }

  private hold(e: PointerEvent, target: PointerTarget, what: Held) {
    const facing = this.viewpoint.camera.getWorldDirection(new THREE.Vector3());
    const at = this.placeOf(target, what);
    this.grabbing = { ...what, plane: new THREE.Plane().setFromNormalAndCoplanarPoint(facing, at) };
    this.handle.position.copy(at);
    this.viewpoint.controls.enabled = false;
    this.canvas.setPointerCapture(e.pointerId);
    this.canvas.style.cursor = 'grabbing';
    this.update();
    this.changed();
  }

  private pick(e: PointerEvent, target: PointerTarget) {
    const marker = this.markerAt(e, target);
    if (marker >= 0) return this.onPick({ marker }, [...target.markersAtRest[marker]], [0, 0, 0]) && keep(e);
    const hit = this.hitAt(e, target);
    if (!hit?.face) return false;
    return this.onPick({ vertex: nearestVertex(target.mesh, hit) }, ...atRest(target, hit)) && keep(e);
  }

  private hitAt(e: PointerEvent, target: PointerTarget) {
    return this.ray(e).intersectObject(target.mesh, false).find((hit) => target.keeps(hit.point));
  }

  /// The marker whose dot is under the pointer, or -1: dots are drawn over everything.
  private markerAt(e: PointerEvent, target: PointerTarget) {
    const box = this.canvas.getBoundingClientRect();
    let [best, least] = [-1, markerReach];
    target.markers.forEach((marker, m) => {
      const v = marker.position.clone().project(this.viewpoint.camera);
      const away = Math.hypot(((v.x + 1) / 2) * box.width - (e.clientX - box.left), ((1 - v.y) / 2) * box.height - (e.clientY - box.top));
      if (v.z < 1 && away < least) [best, least] = [m, away];
    });
    return best;
  }
}

function vertexOf(mesh: THREE.Mesh, vertex: number) {
  return new THREE.Vector3().fromBufferAttribute(mesh.geometry.getAttribute('position') as THREE.BufferAttribute, vertex);
}

/// The vertex of the hit triangle that is nearest to the hit.
function nearestVertex(mesh: THREE.Mesh, hit: THREE.Intersection) {
  const distance = (v: number) => hit.point.distanceTo(vertexOf(mesh, v));
  return [hit.face!.a, hit.face!.b, hit.face!.c].sort((a, b) => distance(a) - distance(b))[0];
}

/// Rest position of a surface point, mm, and the direction into the body there.
function atRest({ mesh, rest }: PointerTarget, hit: THREE.Intersection): [[number, number, number], [number, number, number]] {
  const corners = [hit.face!.a, hit.face!.b, hit.face!.c];
  const now = corners.map((v) => vertexOf(mesh, v));
  const shares = THREE.Triangle.getBarycoord(hit.point, now[0], now[1], now[2], new THREE.Vector3())!.toArray();
  const at = corners.map((v) => new THREE.Vector3(rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]));
  const place = new THREE.Vector3();
  at.forEach((p, i) => place.addScaledVector(p, shares[i]));
  const inward = new THREE.Triangle(at[0], at[1], at[2]).getNormal(new THREE.Vector3()).negate();
  return [place.toArray(), inward.toArray()];
}

/// Keeps the press from the camera controls.
function keep(e: PointerEvent) {
  e.stopImmediatePropagation();
  return true;
}
