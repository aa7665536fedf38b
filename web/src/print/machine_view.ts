// The machine in 3D, from simple boxes: tower with its vats, carriage with the cleaning vat, platform with the part.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
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
  private readonly part: THREE.Mesh;
  private readonly light: THREE.Mesh;
  private readonly spray: THREE.Points;
  private readonly resize: ResizeObserver;

  constructor(canvas: HTMLCanvasElement, private readonly machine: MachineInfo, colours: Record<string, string>, partSize: [number, number]) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.draw());
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x8a8f98, 1.7));
    const key = new THREE.DirectionalLight(0xffffff, 1.8);
    key.position.set(-1, -2, 3);
    this.world.add(key);
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
    this.platform.add(this.box(width, depth, 8, grey, 4));
    this.platform.add(this.box(22, 22, machine.platform.height, 0x6b7580, 8 + machine.platform.height / 2));
    this.part = this.box(partSize[0], partSize[1], 1, 0xd98f5c, -0.5);
    this.platform.add(this.part);
    this.world.add(this.platform);
    this.light = new THREE.Mesh(
      new THREE.PlaneGeometry(partSize[0], partSize[1]),
      new THREE.MeshBasicMaterial({ color: 0xffd75a, transparent: true, opacity: 0.95, side: THREE.DoubleSide }),
    );
    this.light.position.z = -2;
    this.world.add(this.light);
    this.spray = this.makeSpray(width, depth);
    this.cleaning.add(this.spray);
    const floor = new THREE.Mesh(new THREE.CircleGeometry(4 * w, 64), new THREE.MeshBasicMaterial({ color: grey, transparent: true, opacity: 0.08 }));
    floor.position.z = -h - 40 - this.depth();
    this.world.add(floor);
    this.look(w);
    this.resize = new ResizeObserver(() => {
      const box = canvas.parentElement!.getBoundingClientRect();
      if (!box.width) return;
      this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
      this.renderer.setSize(box.width, box.height, false);
      this.camera.aspect = box.width / box.height;
      this.camera.updateProjectionMatrix();
      this.draw();
    });
    this.resize.observe(canvas.parentElement!);
  }

  private look(w: number) {
    const reach = this.machine.store === 'tower' ? this.machine.carriage.tower - this.machine.carriage.print : 0;
    const size = Math.abs(reach) + 1.6 * w;
    // All of the tower is in sight: its vats hang below the one at hand.
    const deep = this.depth();
    const far = Math.max(2.1 * size, 1.15 * size + 1.5 * deep);
    this.controls.target.set(0.3 * reach, 0, 0.1 * size - 0.42 * deep);
    this.camera.position.set(0.3 * reach - 0.4 * size, -far, 0.1 * size - 0.42 * deep + 0.5 * far);
    this.controls.update();
  }

  /// How far the tower reaches below the vat at hand, mm.
  private depth() {
    return this.machine.store === 'tower' ? Math.max(...this.machine.vats.map((v) => v.slot)) * this.machine.tower.pitch : 0;
  }

  private box(w: number, d: number, h: number, colour: number, z: number) {
    const mesh = new THREE.Mesh(new THREE.BoxGeometry(w, d, h), new THREE.MeshStandardMaterial({ color: colour, roughness: 0.7 }));
    mesh.position.z = z;
    return mesh;
  }

  /// A vat: glass walls and what is in it. Its rim is at z = 0.
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

  show(now: Now, partHeight: number, partColour: string) {
    const { carriage, tower, store } = this.machine;
    const at = (axis: string) => now.machine.axes[axis]?.position ?? 0;
    const reach = carriage.tower - carriage.print;
    this.cleaning.visible = store === 'tower';
    this.cleaning.position.x = at('carriage') - carriage.tower;
    for (const [slot, group] of this.vats) {
      const used = slot === now.machine.slot;
      if (store !== 'tower') {
        group.visible = used || this.vats.size === 1 || (now.machine.slot === 0 && slot === 1);
        continue;
      }
      const level = at('tower') - (tower.first + (slot - 1) * tower.pitch);
      group.position.set(used ? at('carriage') - carriage.print : reach, 0, used ? 0 : level);
    }
    this.tower.position.set(reach, 0, at('tower') - tower.first);
    const z = at('platform') - Math.max(this.machine.wall, 20) * 0.62;
    this.platform.position.z = z;
    const height = Math.max(partHeight, 0.01);
    this.part.scale.z = height;
    this.part.position.z = -height / 2;
    this.part.visible = partHeight > 0;
    (this.part.material as THREE.MeshStandardMaterial).color.set(partColour);
    this.light.visible = now.progress.lit;
    this.light.position.z = z - height - 0.6;
    this.spray.visible = now.machine.pump;
    this.draw();
  }

  private draw() {
    this.renderer.render(this.world, this.camera);
  }

  dispose() {
    this.resize.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
  }
}
