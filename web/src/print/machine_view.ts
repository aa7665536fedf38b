// The machine in 3D, made of simple boxes: tower with its vats, carriage with the cleaning vat, platform with the part.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { fitTo } from '../fit_to';
import { placeLabels } from '../labels';
import { fitPoints } from '../simulate/fit';
import { orbitKeys, turnAround } from '../orbit_keys';
import type { Part } from './part';
import { PartMesh } from './part_mesh';
import type { MachineInfo, Now } from './state';

const grey = 0x8f99a5;

export class MachineView {
  private readonly renderer: THREE.WebGLRenderer;
  private readonly world = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(30, 1, 1, 20000);
  private readonly controls: OrbitControls;
  private readonly vats = new Map<number, THREE.Group>();
  private readonly tower = new THREE.Group();
  private readonly cleaning = new THREE.Group();
  private readonly platform = new THREE.Group();
  private readonly part: PartMesh;
  private readonly shaft: THREE.Mesh;
  private readonly plate: THREE.Mesh;
  private readonly underside: THREE.Mesh;
  private readonly floor: THREE.Mesh;
  private readonly light: THREE.Mesh;
  private readonly spray: THREE.Points;
  private readonly resize: ResizeObserver;
  private fitted = new THREE.Box3(); // what of the machine the camera has in view
  private moved = false; // somebody has turned the view: it stays
  private near = false; // shows the part alone, not the whole machine
  private seen = new THREE.Box3(); // bounds of the part when the camera was last positioned for it
  private last: Now | null = null;
  private shown = ''; // identifies what is currently drawn
  private frame = 0;

  /// `colours` of the vats' contents, by resin; `materials`: those of the job.
  constructor(canvas: HTMLCanvasElement, private readonly machine: MachineInfo, colours: Record<string, string>, materials: string[], private readonly names: HTMLElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.draw());
    this.controls.addEventListener('start', () => (this.moved = true));
    canvas.addEventListener('keydown', (e) =>
      orbitKeys(e, (around, up, nearer) => ((this.moved = true), turnAround(this.camera, this.controls, around, up, nearer)), () => this.lookAt(this.near)),
    );
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x8a8f98, 1.7));
    const key = new THREE.DirectionalLight(0xffffff, 1.8);
    key.position.set(-1, -2, 3);
    this.world.add(key);
    // Hanging parts are also seen from below.
    const lamp = new THREE.DirectionalLight(0xffffff, 0.9);
    lamp.position.set(0, 0, 1);
    this.camera.add(lamp);
    this.world.add(this.camera);
    const { width, depth } = machine.platform;
    const [w, d, h] = [width * 1.15, depth * 1.2, Math.max(machine.wall, 20)];
    for (const vat of machine.vats) {
      const group = this.openBox(w, d, h, colours[vat.resin] ?? '#b9c0c8');
      this.vats.set(vat.slot, group);
      this.world.add(group);
    }
    this.cleaning.add(this.openBox(w, d, h, '#7fb7c9', true));
    this.world.add(this.cleaning);
    this.buildTower(w, d);
    this.plate = this.box(width, depth, 8, grey, 4);
    this.underside = new THREE.Mesh(
      new THREE.PlaneGeometry(width, depth),
      new THREE.MeshBasicMaterial({ color: grey, transparent: true, opacity: 0.14, side: THREE.DoubleSide, depthWrite: false }),
    );
    this.platform.add(this.plate, this.underside);
    this.shaft = this.box(22, 22, machine.platform.height, 0x6b7580, 8 + machine.platform.height / 2);
    this.platform.add(this.shaft);
    this.part = new PartMesh(machine.projector, materials.map((c) => new THREE.Color(c)));
    this.platform.add(this.part.group);
    this.world.add(this.platform);
    this.light = new THREE.Mesh(
      new THREE.PlaneGeometry(1, 1),
      new THREE.MeshBasicMaterial({ color: 0xffd75a, transparent: true, opacity: 0.95, side: THREE.DoubleSide }),
    );
    this.light.position.z = -2;
    this.world.add(this.light);
    this.spray = this.makeSpray(width, depth);
    this.cleaning.add(this.spray);
    this.floor = new THREE.Mesh(new THREE.CircleGeometry(4 * w, 64), new THREE.MeshBasicMaterial({ color: grey, transparent: true, opacity: 0.08 }));
    this.floor.position.z = -h - 40 - this.depth();
    this.world.add(this.floor);
    this.nameParts();
    this.resize = new ResizeObserver(() => {
      if (!fitTo(canvas, this.renderer, this.camera)) return;
      this.fitted.makeEmpty();
      this.fit();
      this.draw();
    });
    this.resize.observe(canvas.parentElement!);
  }

  /// Shows the whole machine, or the part alone.
  lookAt(near: boolean) {
    this.near = near;
    this.shown = '';
    this.seen.makeEmpty();
    if (this.last) this.show(this.last);
    this.moved = false;
    this.fitted.makeEmpty();
    if (near) this.lookAtPart();
    else this.fit();
    this.draw();
  }

  /// Repositions the camera whenever the part has outgrown the view, or is much smaller than it.
  private lookAtPart() {
    const box = this.part.box.isEmpty() ? new THREE.Box3(new THREE.Vector3(-20, -20, -20), new THREE.Vector3(20, 20, 0)) : this.part.box.clone();
    const size = box.getSize(new THREE.Vector3()).length();
    if (this.seen.containsBox(box) && size > 0.35 * this.seen.getSize(new THREE.Vector3()).length()) return;
    this.seen = box.clone().expandByScalar(0.25 * size);
    const centre = box.getCenter(new THREE.Vector3()).add(new THREE.Vector3(0, 0, this.platform.position.z));
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).add(new THREE.Vector3(-0.7, -1.5, -0.35).multiplyScalar(1.5 * size));
    this.controls.update();
  }

  /// Moves the camera back until platform and vats are in view; again whenever one of them has left the view.
  private fit() {
    if (this.near || this.moved) return;
    const box = this.bounds();
    if (!this.fitted.isEmpty() && this.fitted.containsBox(box)) return;
    const { min, max } = this.fitted.union(box);
    const corners = [min.x, max.x].flatMap((x) => [min.y, max.y].flatMap((y) => [min.z, max.z].flatMap((z) => [x, y, z])));
    const forward = new THREE.Vector3(0.18, 1, -0.5).normalize();
    const right = new THREE.Vector3().crossVectors(forward, this.camera.up).normalize();
    const up = new THREE.Vector3().crossVectors(right, forward);
    const tan = Math.tan((this.camera.fov * Math.PI) / 360);
    const [margin, names] = [0.94, 50]; // names: room for half of one beside its vat, px
    const across = Math.min(margin, Math.max(0.5, 1 - names / Math.max(1, this.renderer.domElement.clientWidth)));
    const place = fitPoints(corners, right.toArray(), up.toArray(), forward.toArray(), across * tan * this.camera.aspect, margin * tan);
    this.controls.target.set(...place.target);
    this.camera.position.set(...place.camera);
    this.controls.update();
  }

  /// Of platform and vats as they stand, with room for the platform's name.
  private bounds() {
    this.world.updateMatrixWorld(true);
    const box = new THREE.Box3();
    for (const object of [this.plate, this.cleaning, ...this.vats.values()]) if (object.visible) box.expandByObject(object);
    box.max.z += 30;
    return box;
  }

  /// Extent of the tower below the current vat, mm.
  private depth() {
    return this.machine.store === 'tower' ? Math.max(...this.machine.vats.map((v) => v.slot)) * this.machine.tower.pitch : 0;
  }

  private box(w: number, d: number, h: number, colour: number, z: number) {
    const mesh = new THREE.Mesh(new THREE.BoxGeometry(w, d, h), new THREE.MeshStandardMaterial({ color: colour, roughness: 0.7 }));
    mesh.position.z = z;
    return mesh;
  }

  /// A vat: glass walls and its contents. Its rim is at z = 0.
  private openBox(w: number, d: number, h: number, colour: string, empty = false) {
    const group = new THREE.Group();
    const glass = new THREE.Mesh(
      new THREE.BoxGeometry(w, d, h),
      new THREE.MeshStandardMaterial({ color: 0xbfc8d2, transparent: true, opacity: 0.32, depthWrite: false }),
    );
    glass.position.z = -h / 2;
    const edges = new THREE.LineSegments(new THREE.EdgesGeometry(glass.geometry), new THREE.LineBasicMaterial({ color: 0x6b7580 }));
    edges.position.z = -h / 2;
    const content = new THREE.Mesh(
      new THREE.BoxGeometry(w * 0.97, d * 0.96, h * (empty ? 0.12 : 0.5)),
      new THREE.MeshStandardMaterial({ color: colour, roughness: 0.4 }),
    );
    content.position.z = -h * (empty ? 0.92 : 0.73);
    group.add(content, glass, edges);
    return group;
  }

  private buildTower(w: number, d: number) {
    const { tower, store } = this.machine;
    if (store !== 'tower') return;
    const height = tower.slots * tower.pitch;
    for (const x of [-w / 2 - 8, w / 2 + 8])
      for (const y of [-d / 2 - 8, d / 2 + 8]) {
        const post = this.box(8, 8, height + 40, 0x59636e, -height / 2 + tower.pitch / 2);
        post.position.x = x;
        post.position.y = y;
        this.tower.add(post);
      }
    this.world.add(this.tower);
  }

  private makeSpray(width: number, depth: number) {
    const n = 260;
    const points = new Float32Array(3 * n);
    for (let i = 0; i < n; ++i) {
      points[3 * i] = (Math.random() - 0.5) * width * 0.8;
      points[3 * i + 1] = (Math.random() - 0.5) * depth * 0.8;
      points[3 * i + 2] = Math.random() * 60 - 20;
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
    const spray = new THREE.Points(geometry, new THREE.PointsMaterial({ color: 0x3fa7d6, size: 3, sizeAttenuation: false, transparent: true, opacity: 0.8 }));
    spray.visible = false;
    return spray;
  }

  showPart(part: Part | null) {
    this.part.show(part);
    if (this.near) this.lookAtPart();
    this.shown = '';
    if (this.last) this.show(this.last);
    else this.draw();
  }

  /// Only redraws what has changed.
  show(now: Now) {
    this.last = now;
    const { axes, slot, pump } = now.machine;
    const picture = JSON.stringify([Object.values(axes).map((a) => a.position), slot, pump, now.progress.lit, this.near, this.part.box.min.z]);
    if (picture === this.shown) return;
    this.shown = picture;
    const { carriage, tower, store } = this.machine;
    const at = (axis: string) => now.machine.axes[axis]?.position ?? 0;
    const reach = carriage.tower - carriage.print;
    this.cleaning.visible = store === 'tower' && !this.near;
    this.underside.visible = this.near;
    this.tower.visible = this.plate.visible = this.shaft.visible = this.floor.visible = !this.near;
    this.cleaning.position.x = at('carriage') - carriage.tower;
    for (const [slot, group] of this.vats) {
      const used = slot === now.machine.slot;
      if (store !== 'tower' || this.near) {
        group.visible = !this.near && ( used || this.vats.size === 1 || (now.machine.slot === 0 && slot === 1));
        continue;
      }
      group.visible = true;
      const level = at('tower') - (tower.first + (slot - 1) * tower.pitch);
      group.position.set(used ? at('carriage') - carriage.print : reach, 0, used ? 0 : level);
    }
    this.tower.position.set(reach, 0, at('tower') - tower.first);
    const z = at('platform') - Math.max(this.machine.wall, 20) * 0.62;
    // The part alone stays in place, and so does the camera.
    this.platform.position.z = this.near ? 0 : z;
    this.fit();
    this.showLight(now);
    this.spray.visible = now.machine.pump;
    this.draw();
  }

  /// Below the part, as wide as it is; below the whole platform while there is no part.
  private showLight(now: Now) {
    this.light.visible = now.progress.lit;
    (this.light.material as THREE.MeshBasicMaterial).opacity = this.near ? 0.4 : 0.95; // so that the part is visible
                                                                                       // through it
    const { width, depth } = this.machine.platform;
    const box = this.part.box.isEmpty() ? new THREE.Box3(new THREE.Vector3(-0.3 * width, -0.3 * depth, 0), new THREE.Vector3(0.3 * width, 0.3 * depth, 0)) : this.part.box;
    this.light.position.set((box.min.x + box.max.x) / 2, (box.min.y + box.max.y) / 2, this.platform.position.z + box.min.z - 0.3);
    this.light.scale.set(box.max.x - box.min.x, box.max.y - box.min.y, 1);
  }

  /// Labels: the vats with slot and resin, and the moving parts.
  private nameParts() {
    this.names.replaceChildren();
    const add = (text: string, of: THREE.Object3D, up: number) => {
      const element = document.createElement('span');
      element.textContent = text;
      this.names.append(element);
      this.named.push({ element, of, up });
    };
    const h = Math.max(this.machine.wall, 20);
    add('platform', this.platform, 30);
    for (const vat of this.machine.vats) {
      const group = this.vats.get(vat.slot);
      if (group) add(`${vat.slot} ${vat.resin}`, group, -h / 2);
    }
    if (this.machine.store === 'tower') add('cleaning vat', this.cleaning, -h / 2);
  }
  private readonly named: { element: HTMLElement; of: THREE.Object3D; up: number }[] = [];

  private placeNames() {
    const side = 0.5 * this.machine.platform.depth;
    const seen = this.named.filter(({ element, of }) => {
      const shows = of.visible && !this.near;
      if (!shows) element.style.visibility = 'hidden';
      return shows;
    });
    const labels = seen.map(({ element, of, up }) => ({ element, at: of.getWorldPosition(new THREE.Vector3()).add(new THREE.Vector3(0, -side, up)) }));
    const canvas = this.renderer.domElement;
    placeLabels(labels, this.camera, canvas.clientWidth, canvas.clientHeight);
  }

  /// At most once per frame.
  private draw() {
    if (this.frame) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.renderer.render(this.world, this.camera);
      this.placeNames();
    });
  }

  dispose() {
    cancelAnimationFrame(this.frame);
    this.resize.disconnect();
    this.part.dispose();
    this.controls.dispose();
    this.renderer.dispose();
    this.names.replaceChildren();
  }
}
