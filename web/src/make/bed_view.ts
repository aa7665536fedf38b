// The drawing of the robot on the platform, and what the pointer does to it: moves it, lays a face down, paints
// supports.
import { signal } from '@preact/signals';
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { fitTo } from '../fit_to';
import { orbitKeys, turnAround } from '../orbit_keys';
import { mayDrive } from '../store';
import type { Scene } from '../types';
import { turnAxes } from './axes_corner';
import { roomOf, type PrinterInfo } from './order';
import { painted, refined, wishColours, type Touch, type Wish } from './paint';
import { area, placed, rotationOf, type Degrees } from './place';
import { disposePlatform, platformMesh } from './platform';

/// What the pointer does to the part.
export type Tool = 'move' | 'face' | 'enforce' | 'block' | 'usual';
export const tool = signal<Tool>('move');
export const brush = signal(2); // radius in mm, in the coordinates of the drawn part
export const isBrush = (t: Tool): t is Wish => t === 'enforce' || t === 'block' || t === 'usual';

export interface Hands {
  move: (dx: number, dy: number) => void;
  face: (normal: THREE.Vector3) => void;
  paint: (touch: Touch, first: boolean) => void;
}

export class BedView {
  private readonly renderer: THREE.WebGLRenderer;
  private readonly world = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(32, 1, 1, 5000);
  private readonly controls: OrbitControls;
  private readonly parts = new THREE.Group();
  private readonly geometry = new THREE.BufferGeometry();
  private readonly material = new THREE.MeshStandardMaterial({ roughness: 0.6, vertexColors: true, side: THREE.DoubleSide, flatShading: true });
  private readonly ring = new THREE.Mesh(new THREE.RingGeometry(0.93, 1, 48), new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, depthTest: false, transparent: true, opacity: 0.9 }));
  private readonly resize: ResizeObserver;
  private readonly listeners: [string, (e: Event) => void, boolean][];
  private platform: THREE.Group | null = null;
  private seen = '';
  private frame = 0;
  private points = new Float32Array(0); // of the drawn part, three corners per triangle
  private normals = new Float32Array(0);
  private plain = new Float32Array(0); // colours without paint
  private codes = new Uint8Array(0); // paint code of each corner
  private fine = false; // the triangles are small enough to be painted
  private list: Touch[] = [];
  private down = new THREE.Vector3(); // downward direction of the platform, in the coordinates of the drawn part
  private flattest = -1; // degrees: undersides flatter than this are highlighted; below 0: none
  private held: { at: THREE.Vector3 } | null = null;
  private last: Touch | null = null;

  constructor(private readonly canvas: HTMLCanvasElement, private readonly axes: SVGSVGElement, private readonly part: Scene, private readonly hands: Hands) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.camera.up.set(0, 0, 1);
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x8a8f98, 1.9));
    const key = new THREE.DirectionalLight(0xffffff, 1.6);
    key.position.set(-1, -2, 3);
    const below = new THREE.DirectionalLight(0xffffff, 0.7); // lights undersides, where supports are painted
    below.position.set(1, -1, -2);
    this.ring.visible = false;
    this.ring.renderOrder = 2;
    this.world.add(key, below, this.parts, this.ring);
    this.build(false);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.draw());
    // Registered before those of the controls, which would rotate the view.
    this.listeners = [
      ['pointerdown', (e) => this.grasp(e as PointerEvent), true],
      ['pointermove', (e) => this.follow(e as PointerEvent), true],
      ['pointerup', () => this.letGo(), false],
      ['pointercancel', () => this.letGo(), false],
      ['pointerleave', () => this.hideRing(), false],
      ['keydown', (e) => this.key(e as KeyboardEvent), false],
    ];
    for (const [name, listener, early] of this.listeners) canvas.addEventListener(name, listener, early);
    this.resize = new ResizeObserver(() => {
      if (!fitTo(canvas, this.renderer, this.camera)) return;
      if (!this.sized) this.home();
      this.sized = true;
      this.draw();
    });
    this.resize.observe(canvas.parentElement!);
  }

  /// The part's triangles as they are, or divided into small ones, which take paint at its place. Small ones are many, and
  /// are drawn once per copy: they are made for the first touch of a brush.
  private build(fine: boolean) {
    const part = this.part;
    const colours = part.head.materials.map((m) => new THREE.Color(m.colour));
    const material = part.u32('material');
    const rest = part.f32('rest');
    const triangles = part.u32('triangles');
    const box = new THREE.Box3().setFromArray(rest as unknown as number[]);
    const side = fine ? Math.max(box.getSize(new THREE.Vector3()).length() / 130, 0.4) : Infinity;
    const { points, from } = refined(rest, triangles, side);
    this.fine = fine;
    this.geometry.dispose();
    this.points = points;
    this.plain = new Float32Array(points.length);
    this.normals = new Float32Array(points.length);
    this.codes = new Uint8Array(points.length / 3);
    const grey = new THREE.Color(0x8f99a5);
    const [a, b, c] = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
    for (let t = 0; t < from.length; ++t) {
      const colour = colours[material[triangles[3 * from[t]]]] ?? grey;
      a.fromArray(points, 9 * t);
      b.fromArray(points, 9 * t + 3).sub(a);
      c.fromArray(points, 9 * t + 6).sub(a);
      const normal = b.cross(c).normalize();
      for (let k = 0; k < 3; ++k) {
        colour.toArray(this.plain, 9 * t + 3 * k);
        normal.toArray(this.normals, 9 * t + 3 * k);
      }
    }
    this.geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
    this.geometry.setAttribute('color', new THREE.BufferAttribute(new Float32Array(this.plain), 3));
    this.geometry.computeBoundingSphere();
  }

  /// The platform under the part; it is made again when its size is another.
  private stand(width: number, depth: number) {
    if (this.platform?.userData.width === width && this.platform.userData.depth === depth) return;
    this.leave();
    this.platform = platformMesh(width, depth);
    this.world.add(this.platform);
  }
  private leave() {
    if (!this.platform) return;
    this.world.remove(this.platform);
    disposePlatform(this.platform);
    this.platform = null;
  }

  show(where: ReturnType<typeof placed>, degrees: Degrees, size: number, at: [number, number], p: PrinterInfo) {
    this.stand(...area(roomOf(p)));
    this.parts.clear();
    const turned = rotationOf(degrees);
    for (const [x, y] of where.shifts.slice(0, 200)) {
      const mesh = new THREE.Mesh(this.geometry, this.material);
      mesh.matrixAutoUpdate = false;
      mesh.matrix
        .makeTranslation(x + at[0] - where.least.x - where.size[0] / 2, y + at[1] - where.least.y - where.size[1] / 2, -where.least.z)
        .multiply(turned)
        .scale(new THREE.Vector3(size, size, size));
      mesh.updateMatrixWorld(true);
      this.parts.add(mesh);
    }
    const down = new THREE.Vector3(0, 0, -1).transformDirection(turned.clone().invert());
    if (down.distanceTo(this.down) > 1e-6) {
      this.down = down;
      this.colour();
    }
    const key = JSON.stringify([where.size, area(roomOf(p))]);
    if (key !== this.seen) {
      this.seen = key;
      this.size = Math.max(Math.hypot(...where.size), 0.5 * Math.hypot(...area(roomOf(p))));
      this.height = where.size[2];
      this.home();
    }
    this.draw();
  }
  private sized = false; // the window size is known
  private size = 100;
  private height = 0;

  /// `flattest`: undersides flatter than this angle, in degrees, are highlighted; below 0: none.
  paint(list: Touch[], flattest: number) {
    const refines = list.length > 0 && !this.fine;
    if (refines) this.build(true);
    const grows = !refines && list.length >= this.list.length && this.list.every((t, k) => t === list[k]);
    if (!grows) this.codes.fill(0);
    painted(this.points, this.normals, list, this.codes, grows ? this.list.length : 0);
    this.list = list;
    this.flattest = flattest;
    this.colour();
    this.draw();
  }

  private colour() {
    const out = (this.geometry.getAttribute('color') as THREE.BufferAttribute).array as Float32Array;
    const paints = [null, new THREE.Color(wishColours.enforce), new THREE.Color(wishColours.block)];
    const hang = new THREE.Color('#a3317f');
    const least = this.flattest < 0 ? 2 : Math.cos((this.flattest * Math.PI) / 180);
    out.set(this.plain);
    for (let i = 0; i < this.codes.length; ++i) {
      const paint = paints[this.codes[i]];
      const looksDown = this.normals[3 * i] * this.down.x + this.normals[3 * i + 1] * this.down.y + this.normals[3 * i + 2] * this.down.z;
      const over = paint ?? (looksDown > least ? hang : null);
      if (!over) continue;
      const share = paint ? 0.86 : 0.4;
      out[3 * i] += (over.r - out[3 * i]) * share;
      out[3 * i + 1] += (over.g - out[3 * i + 1]) * share;
      out[3 * i + 2] += (over.b - out[3 * i + 2]) * share;
    }
    this.geometry.getAttribute('color').needsUpdate = true;
  }

  private home() {
    this.controls.target.set(0, 0, this.height / 3);
    const far = this.size * Math.max(1, 1.4 / this.camera.aspect); // move back if the window is narrow
    this.camera.position.set(0.5 * far, -1.35 * far, 0.85 * far);
    this.controls.update();
    this.draw();
  }

  /// Views the part from below, where supports are.
  lookUp() {
    const far = this.size * Math.max(1, 1.4 / this.camera.aspect);
    this.controls.target.set(0, 0, this.height / 3);
    this.camera.position.set(0.4 * far, -1.15 * far, -0.75 * far);
    this.controls.update();
    this.draw();
  }

  private ray(x: number, y: number) {
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(x, y), this.camera);
    return ray;
  }
  private under(e: PointerEvent) {
    const box = this.canvas.getBoundingClientRect();
    return this.ray(((e.clientX - box.left) / box.width) * 2 - 1, 1 - ((e.clientY - box.top) / box.height) * 2);
  }
  private hit(ray: THREE.Raycaster) {
    return ray.intersectObjects(this.parts.children)[0];
  }

  private grasp(e: PointerEvent) {
    if (e.button !== 0 || !mayDrive.peek()) return;
    const hit = this.hit(this.under(e));
    if (!hit?.face) return;
    const t = tool.peek();
    if (t === 'face') return this.hands.face(hit.face.normal.clone().transformDirection(hit.object.matrix));
    this.controls.enabled = false;
    this.canvas.setPointerCapture(e.pointerId);
    this.held = { at: hit.point.clone() };
    this.last = null;
    if (isBrush(t)) this.touch(hit, t, true);
  }

  private follow(e: PointerEvent) {
    const t = tool.peek();
    const ray = this.under(e);
    const hit = isBrush(t) ? this.hit(ray) : undefined;
    this.showRing(hit, t);
    if (!this.held) return;
    if (hit && isBrush(t)) return this.touch(hit, t, false);
    if (t !== 'move') return;
    // In the plane of the grabbed point.
    const to = ray.ray.intersectPlane(new THREE.Plane(new THREE.Vector3(0, 0, 1), -this.held.at.z), new THREE.Vector3());
    if (!to) return;
    const step = [to.x - this.held.at.x, to.y - this.held.at.y].map((v) => Math.round(10 * v) / 10);
    if (step.every((v) => v === 0)) return;
    this.held.at.add(new THREE.Vector3(step[0], step[1], 0));
    this.hands.move(step[0], step[1]);
  }

  private letGo() {
    this.held = null;
    this.last = null;
    this.controls.enabled = true;
  }

  private touch(hit: THREE.Intersection, wish: Wish, first: boolean) {
    const at = hit.object.worldToLocal(hit.point.clone());
    const normal = hit.face!.normal;
    if (!first && this.last && at.distanceTo(new THREE.Vector3(...this.last.at)) < brush.peek() / 3) return;
    const touch: Touch = { wish, at: at.toArray() as Touch['at'], normal: normal.toArray() as Touch['normal'], radius: brush.peek() };
    const begins = first || this.last === null;
    this.last = touch;
    this.hands.paint(touch, begins);
  }

  private showRing(hit: THREE.Intersection | undefined, t: Tool) {
    const was = this.ring.visible;
    this.ring.visible = Boolean(hit?.face);
    if (hit?.face) {
      const normal = hit.face.normal.clone().transformDirection(hit.object.matrix);
      const scaled = brush.peek() * new THREE.Vector3().setFromMatrixScale(hit.object.matrix).x;
      this.ring.position.copy(hit.point).addScaledVector(normal, 0.05);
      this.ring.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), normal);
      this.ring.scale.setScalar(scaled);
      (this.ring.material as THREE.MeshBasicMaterial).color.set(t === 'usual' ? '#ffffff' : wishColours[t as 'enforce' | 'block']);
    }
    if (was || this.ring.visible) this.draw();
  }
  private hideRing() {
    if (!this.ring.visible) return;
    this.ring.visible = false;
    this.draw();
  }

  private key(e: KeyboardEvent) {
    const t = tool.peek();
    if ((e.key === 'Enter' || e.key === ' ') && t !== 'move' && mayDrive.peek()) {
      // The point at the centre of the view.
      const hit = this.hit(this.ray(0, 0));
      e.preventDefault();
      if (!hit?.face) return;
      if (t === 'face') return this.hands.face(hit.face.normal.clone().transformDirection(hit.object.matrix));
      this.last = null;
      return this.touch(hit, t, true);
    }
    orbitKeys(e, (around, up, nearer) => turnAround(this.camera, this.controls, around, up, nearer), () => this.home());
  }

  private draw() {
    if (this.frame) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.renderer.render(this.world, this.camera);
      turnAxes(this.axes, this.camera);
    });
  }

  dispose() {
    cancelAnimationFrame(this.frame);
    for (const [name, listener, early] of this.listeners) this.canvas.removeEventListener(name, listener, early);
    this.resize.disconnect();
    this.leave();
    this.geometry.dispose();
    this.material.dispose();
    this.controls.dispose();
    this.renderer.dispose();
  }
}
