// The robot in 3D. Redraws only when something has changed.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { Line2 } from 'three/addons/lines/Line2.js';
import { LineGeometry } from 'three/addons/lines/LineGeometry.js';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { turnAround } from '../orbit_keys';
import type { Frame, Scene } from '../types';
import { fieldColour } from './colormap';
import { fitPoints, niceBelow } from './fit';
import { Ground, shadowLayer } from './ground';
import { Tube } from './tube';
import type { FieldName, Pick } from './view_state';

export interface ViewOptions {
  field: FieldName;
  scale: number;
  map?: string;
  bands?: number;
  range?: [number, number] | null; // of the colours, in the unit of the legend; null: that of the state
  wireframe: boolean;
  ghost: boolean;
  inside: boolean;
  exploded: number;
  sectionAxis: '' | 'x' | 'y' | 'z';
  sectionAt: number;
  sectionFlipped?: boolean;
  pinned: Float32Array | null;
  beside: boolean;
}

/// What the user has grabbed: a point of the surface, or a marker.
export interface Grab {
  vertex: number;
  marker: number; // -1: none
  to: [number, number, number];
}

const markerReach = 10; // pixels from its dot

const cableColour = 0xcc1a24;
const objectColour = 0xd9a441;
const reachColour = 0x2e86ab;

/// Spacing of the ground grid: 1, 2 or 5 times a power of ten, about ten per length of the robot.
const gridCell = (size: number) => niceBelow(size / 8);

/// Edges make the rotation of an object visible.
function edgesOf(geometry: THREE.BufferGeometry) {
  const lines = new THREE.LineSegments(new THREE.EdgesGeometry(geometry, 24), new THREE.LineBasicMaterial({ color: 0x5c4410, transparent: true, opacity: 0.7 }));
  lines.frustumCulled = false;
  return lines;
}

/// A box of edges drawn over everything, of size 1.
function draftBox() {
  const box = new THREE.LineSegments(new THREE.EdgesGeometry(new THREE.BoxGeometry(1, 1, 1)), new THREE.LineBasicMaterial({ color: 0x2f9bff, depthTest: false, transparent: true }));
  box.visible = false;
  box.renderOrder = 15;
  return box;
}

/// Transparent, but showing only the front of each part: its depth is drawn first, then the nearest surface. A depth
/// offset avoids flicker with coincident surfaces.
function veil(geometry: THREE.BufferGeometry, colour: number, opacity: number, order: number) {
  const offset = { polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8 };
  const veil = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ color: colour, transparent: true, opacity, depthWrite: false, ...offset }));
  const depth = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ colorWrite: false, transparent: true, ...offset }));
  veil.renderOrder = order + 1;
  depth.renderOrder = order;
  depth.frustumCulled = veil.frustumCulled = false;
  veil.add(depth);
  veil.visible = false;
  return veil;
}

export type Side = 'home' | 'front' | 'back' | 'left' | 'right' | 'top' | 'bottom';
const sides: Record<Side, [number, number, number]> = {
  home: [0.55, -1.25, 0.62],
  front: [0, -1, 0.0001],
  back: [0, 1, 0.0001],
  left: [-1, 0, 0.0001],
  right: [1, 0, 0.0001],
  top: [0, -0.0001, 1],
  bottom: [0, -0.0001, -1],
};

/// Makes cut bodies look solid: the inner side of a surface is drawn flat, in the colour of the material.
function insideMaterial(colour: THREE.ColorRepresentation) {
  return new THREE.MeshBasicMaterial({ color: colour, side: THREE.BackSide });
}

export class RobotView {
  readonly renderer: THREE.WebGLRenderer;
  private readonly world = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(32, 1, 0.1, 10000);
  private readonly controls: OrbitControls;
  private readonly root = new THREE.Group();
  private readonly plane = new THREE.Plane(new THREE.Vector3(-1, 0, 0), 0);
  private readonly key = new THREE.DirectionalLight(0xffffff, 2.2);
  private readonly sky = new THREE.HemisphereLight(0xffffff, 0x8a8f98, 1.5);
  private scene: Scene | null = null;
  private frame: Frame | null = null;
  private body: THREE.BufferGeometry | null = null;
  private meshes: THREE.Mesh[] = [];
  private insides: THREE.Mesh[] = [];
  private wires: THREE.LineSegments | null = null;
  private ghostMesh: THREE.Mesh | null = null;
  private pinnedMesh: THREE.Mesh | null = null;
  private chamberMesh: THREE.Mesh | null = null;
  private supportPoints: THREE.Points | null = null;
  private supportVertices: number[] = [];
  private cables: Tube[] = [];
  private bodyDepth: THREE.Mesh | null = null;
  private readonly ground = new Ground();
  private moved = true; // since the shadow was drawn
  private readonly sectionSheet = new THREE.Group();
  private readonly measure = new THREE.Group();
  private readonly reach = new THREE.Group();
  private readonly draft = draftBox();
  private picks: Pick[] = [];
  private markers: THREE.Mesh[] = [];
  private path: [number, number, number][] = [];
  private wanted: THREE.Mesh[] = [];
  private obstacles: THREE.Object3D[] = [];
  private readonly arrow: Line2;
  private readonly handle: THREE.Mesh;
  private centre = new THREE.Vector3();
  private size = 100;
  private offsets: THREE.Vector3[] = [];
  private options: ViewOptions | null = null;
  private dirty = true;
  private stopped = false;
  private grabbing: { vertex: number; marker: number; plane: THREE.Plane } | null = null;
  onGrab: (grab: Grab | null) => void = () => {};
  mayGrab = () => true;
  /// Called for a press while measuring or placing, with what is under the pointer. True: handled. `rest` is the
  /// position at rest, `inward` the unit normal there into the body.
  onPick: (pick: Pick, rest: [number, number, number], inward: [number, number, number]) => boolean = () => false;
  onRange: (low: number, high: number) => void = () => {};
  /// Called with the field's range in this state, in the legend's unit, whatever range is shown.
  onData: (low: number, high: number) => void = () => {};
  /// Called after a camera rotation.
  onTurned: () => void = () => {};
  onDraw: (project: (p: [number, number, number]) => [number, number], camera: THREE.PerspectiveCamera) => void = () => {};

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.localClippingEnabled = true;
    this.renderer.toneMapping = THREE.NoToneMapping;
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener('change', () => {
      this.invalidate();
      this.onTurned();
    });
    this.key.position.set(0.6, -1, 1.6);
    this.world.add(this.sky, this.key, this.root, this.ground.plane, this.measure, this.reach, this.draft, this.sectionSheet);
    this.buildSheet();
    this.arrow = new Line2(new LineGeometry(), new LineMaterial({ color: 0xf2b705, linewidth: 3, depthTest: false }));
    this.arrow.visible = false;
    this.handle = new THREE.Mesh(
      new THREE.SphereGeometry(1, 24, 16),
      new THREE.MeshBasicMaterial({ color: 0xf2b705, depthTest: false, transparent: true }),
    );
    this.handle.visible = false;
    this.arrow.renderOrder = this.handle.renderOrder = 10;
    this.world.add(this.arrow, this.handle);
    canvas.addEventListener('pointerdown', (e) => this.pointerDown(e), { capture: true });
    canvas.addEventListener('pointermove', (e) => this.pointerMove(e));
    canvas.addEventListener('pointerup', (e) => this.pointerUp(e));
    canvas.addEventListener('pointercancel', (e) => this.pointerUp(e));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement as Element);
    this.resize();
    const loop = () => {
      if (this.stopped) return;
      requestAnimationFrame(loop);
      if (this.dirty) this.draw();
    };
    loop();
  }

  dispose() {
    this.stopped = true;
    this.controls.dispose();
    this.ground.dispose();
    this.renderer.dispose();
  }

  invalidate() {
    this.dirty = true;
  }

  setScene(scene: Scene) {
    const first = this.scene === null || this.scene.head.robot !== scene.head.robot;
    this.scene = scene;
    this.frame = null;
    this.root.clear();
    this.build(scene);
    this.setPath(this.path);
    if (first) this.lookAt('home', 0.62); // leaves room for bending
    if (this.options) this.setOptions(this.options);
    this.invalidate();
  }

  private build(scene: Scene) {
    const rest = scene.f32('rest');
    const triangles = scene.u32('triangles');
    const material = scene.u32('material');
    const box = new THREE.Box3().setFromArray(rest as unknown as number[]);
    box.getCenter(this.centre);
    this.size = box.getSize(new THREE.Vector3()).length();
    const body = new THREE.BufferGeometry();
    body.setAttribute('position', new THREE.BufferAttribute(new Float32Array(rest), 3));
    body.setAttribute('normal', new THREE.BufferAttribute(new Float32Array(rest.length), 3));
    body.setAttribute('color', new THREE.BufferAttribute(new Float32Array(rest.length).fill(1), 3));
    body.setIndex(new THREE.BufferAttribute(new Uint32Array(triangles), 1));
    body.boundingSphere = new THREE.Sphere(this.centre.clone(), 50 * this.size);
    this.body = body;
    // Triangles are sorted by material: one group each.
    scene.head.materials.forEach((_, m) => {
      let begin = -1;
      let end = 0;
      for (let t = 0; t < triangles.length; t += 3) {
        if (material[triangles[t]] !== m) continue;
        if (begin < 0) begin = t;
        end = t + 3;
      }
      if (begin >= 0) body.addGroup(begin, end - begin, m);
    });
    this.meshes = [new THREE.Mesh(body, scene.head.materials.map((m) => this.bodyMaterial(m.colour)))];
    this.insides = [new THREE.Mesh(body, scene.head.materials.map((m) => insideMaterial(m.colour)))];
    this.meshes[0].layers.enable(shadowLayer);
    this.bodyDepth = new THREE.Mesh(body, new THREE.MeshBasicMaterial({ colorWrite: false }));
    this.bodyDepth.visible = false;
    this.bodyDepth.renderOrder = 1;
    this.bodyDepth.frustumCulled = this.meshes[0].frustumCulled = this.insides[0].frustumCulled = false;
    this.root.add(this.meshes[0], this.insides[0], this.bodyDepth);
    this.wires = null;
    this.ghostMesh = veil(this.copyOf(rest), 0x8a93a0, 0.3, 6);
    this.pinnedMesh = veil(this.copyOf(rest), 0xf2a93b, 0.45, 8);
    this.root.add(this.ghostMesh, this.pinnedMesh);
    this.buildOffsets(scene, rest, material);
    this.buildParts(scene);
    this.updateNormals();
  }

  private copyOf(positions: Float32Array) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(positions), 3));
    geometry.setIndex(this.body!.getIndex());
    geometry.computeVertexNormals();
    return geometry;
  }

  private bodyMaterial(colour: string) {
    return new THREE.MeshStandardMaterial({ color: colour, roughness: 0.62, metalness: 0, side: THREE.FrontSide });
  }

  /// Exploded view: each material moves away from the centre of the robot.
  private buildOffsets(scene: Scene, rest: Float32Array, material: Uint32Array) {
    const sums = scene.head.materials.map(() => ({ at: new THREE.Vector3(), n: 0 }));
    for (let v = 0; v < material.length; ++v) {
      sums[material[v]].at.add(new THREE.Vector3(rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]));
      sums[material[v]].n += 1;
    }
    this.offsets = sums.map((s) => (s.n ? s.at.divideScalar(s.n).sub(this.centre) : s.at));
  }

  private buildParts(scene: Scene) {
    this.cables = scene.head.cable_points.map(() => {
      const tube = new Tube(0.0055 * this.size);
      const mesh = new THREE.Mesh(tube.geometry, new THREE.MeshStandardMaterial({ color: cableColour, roughness: 0.45 }));
      mesh.frustumCulled = false;
      mesh.layers.enable(shadowLayer);
      this.root.add(mesh);
      return tube;
    });
    const radius = 0.009 * this.size;
    this.markers = scene.head.markers.map(() => {
      const marker = new THREE.Mesh(
        new THREE.SphereGeometry(radius, 20, 14),
        new THREE.MeshBasicMaterial({ color: 0x11161d, transparent: true, opacity: 0.9, depthTest: false }),
      );
      marker.renderOrder = 5;
      this.root.add(marker);
      return marker;
    });
    const chambers = scene.u32('chamber_triangles');
    this.chamberMesh = null;
    if (chambers.length) {
      const geometry = new THREE.BufferGeometry();
      geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(chambers), 1));
      this.chamberMesh = new THREE.Mesh(
        geometry,
        new THREE.MeshBasicMaterial({ color: 0x2f9bff, transparent: true, opacity: 0.2, depthTest: false, side: THREE.DoubleSide }),
      );
      this.chamberMesh.frustumCulled = false;
      this.chamberMesh.renderOrder = 3;
      this.root.add(this.chamberMesh);
    }
    this.supportVertices = [];
    scene.u32('support').forEach((s, v) => s > 0 && this.supportVertices.push(v));
    const held = new THREE.BufferGeometry();
    held.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * this.supportVertices.length), 3));
    this.supportPoints = new THREE.Points(
      held,
      new THREE.PointsMaterial({ color: 0x6b7580, size: 4, sizeAttenuation: false }),
    );
    this.supportPoints.frustumCulled = false;
    this.root.add(this.supportPoints);
    this.obstacles = scene.head.obstacles.map((_, o) => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(scene.f32(`obstacle_points_${o}`)), 3));
      geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(scene.u32(`obstacle_triangles_${o}`)), 1));
      geometry.computeVertexNormals();
      const { open, object } = scene.head.obstacles[o];
      if (open) return this.groundMesh(geometry);
      const mesh = new THREE.Mesh(
        geometry,
        new THREE.MeshStandardMaterial({ color: object ? objectColour : 0xb3b8bf, roughness: 0.8, side: THREE.DoubleSide }),
      );
      mesh.layers.enable(shadowLayer);
      if (object) mesh.add(edgesOf(geometry));
      this.root.add(mesh);
      return mesh;
    });
  }

  /// A half-space: a sheet with a grid, which fades out towards its rim and is transparent.
  private groundMesh(geometry: THREE.BufferGeometry) {
    const sphere = (geometry.computeBoundingSphere(), geometry.boundingSphere!);
    const material = new THREE.ShaderMaterial({
      uniforms: { middle: { value: sphere.center }, reach: { value: sphere.radius }, cell: { value: gridCell(this.size) }, ink: { value: new THREE.Color(0x7d8794) } },
      vertexShader: 'varying vec3 at; varying vec3 facing; void main() { at = position; facing = abs(normal); gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }',
      fragmentShader: `uniform vec3 middle; uniform float reach; uniform float cell; uniform vec3 ink; varying vec3 at; varying vec3 facing;
        float line(float x) { float d = abs(fract(x / cell - 0.5) - 0.5) * cell; return 1.0 - smoothstep(0.0, 1.4 * fwidth(x), d); }
        void main() {
          float fade = 1.0 - smoothstep(0.45, 1.0, length(at - middle) / reach);
          float lines = facing.z > max(facing.x, facing.y) ? max(line(at.x), line(at.y)) : facing.x > facing.y ? max(line(at.y), line(at.z)) : max(line(at.x), line(at.z));
          gl_FragColor = vec4(ink, fade * (0.16 + 0.4 * lines));
        }`,
      transparent: true,
      depthWrite: false,
      side: THREE.DoubleSide,
    });
    const mesh = new THREE.Mesh(geometry, material);
    mesh.renderOrder = -0.5;
    this.root.add(mesh);
    return mesh;
  }

  /// Draws this state immediately, for a screenshot.
  show(frame: Frame) {
    this.setFrame(frame);
    this.draw();
  }

  /// The workspace of a marker, mm: sheets as surfaces, all positions as dots, or a line of them.
  setReach(reach: { sheet_points: number[]; triangles: number[]; points: number[] } | null) {
    for (const c of this.reach.children as THREE.Mesh[]) {
      c.geometry.dispose();
      (c.material as THREE.Material).dispose();
    }
    this.reach.clear();
    if (reach) {
      const places = new THREE.BufferGeometry();
      places.setAttribute('position', new THREE.Float32BufferAttribute(reach.points, 3));
      const dots = new THREE.Points(places, new THREE.PointsMaterial({ color: reachColour, size: 4, sizeAttenuation: false, transparent: true, opacity: 0.9 }));
      const add = (o: THREE.Object3D) => {
        o.frustumCulled = false;
        o.renderOrder = 4;
        this.reach.add(o);
      };
      add(dots);
      if (reach.triangles.length) {
        const sheets = new THREE.BufferGeometry();
        sheets.setAttribute('position', new THREE.Float32BufferAttribute(reach.sheet_points, 3));
        sheets.setIndex(reach.triangles);
        add(new THREE.Mesh(sheets, new THREE.MeshBasicMaterial({ color: reachColour, transparent: true, opacity: 0.16, side: THREE.DoubleSide, depthWrite: false })));
      } else add(new THREE.Line(places, new THREE.LineBasicMaterial({ color: reachColour })));
    }
    this.invalidate();
  }

  /// A box that is being placed as a chamber, mm at rest; null: none.
  setDraft(box: { centre: [number, number, number]; size: [number, number, number] } | null) {
    this.draft.visible = box !== null;
    if (box) {
      this.draft.position.set(...box.centre);
      this.draft.scale.set(...box.size);
    }
    this.invalidate();
  }

  setFrame(frame: Frame) {
    if (!this.scene || frame.head.revision !== this.scene.head.revision || !this.body) return;
    this.frame = frame;
    const positions = this.body.getAttribute('position') as THREE.BufferAttribute;
    (positions.array as Float32Array).set(frame.f32('positions'));
    this.explode(positions.array as Float32Array);
    positions.needsUpdate = true;
    this.updateNormals();
    this.updateColours();
    this.updateParts(frame);
    this.updateMeasure();
    if (this.options?.sectionAxis) this.placeSection(this.options);
    this.moved = true;
    this.invalidate();
  }

  private explode(positions: Float32Array) {
    const by = 1.1 * (this.options?.exploded ?? 0);
    if (!by || !this.scene) return;
    const material = this.scene.u32('material');
    for (let v = 0; v < material.length; ++v) {
      const offset = this.offsets[material[v]];
      positions[3 * v] += by * offset.x;
      positions[3 * v + 1] += by * offset.y;
      positions[3 * v + 2] += by * offset.z;
    }
  }

  /// Area-weighted; vertices are already duplicated along sharp edges.
  private updateNormals() {
    const body = this.body!;
    const p = body.getAttribute('position').array as Float32Array;
    const normals = body.getAttribute('normal') as THREE.BufferAttribute;
    const n = normals.array as Float32Array;
    const index = body.getIndex()!.array;
    n.fill(0);
    for (let t = 0; t < index.length; t += 3) {
      const a = 3 * index[t];
      const b = 3 * index[t + 1];
      const c = 3 * index[t + 2];
      const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
      const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
      const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
      for (const i of [a, b, c]) {
        n[i] += x;
        n[i + 1] += y;
        n[i + 2] += z;
      }
    }
    for (let i = 0; i < n.length; i += 3) {
      const length = Math.hypot(n[i], n[i + 1], n[i + 2]) || 1;
      n[i] /= length;
      n[i + 1] /= length;
      n[i + 2] /= length;
    }
    normals.needsUpdate = true;
  }

  private fieldValues(): Float32Array | null {
    const frame = this.frame;
    const field = this.options?.field ?? 'material';
    if (!frame || !this.scene || field === 'material') return null;
    if (field !== 'displacement') return frame.has(field) ? frame.f32(field) : null;
    const rest = this.scene.f32('rest');
    const now = frame.f32('positions');
    const values = new Float32Array(rest.length / 3);
    for (let v = 0; v < values.length; ++v)
      values[v] = Math.hypot(now[3 * v] - rest[3 * v], now[3 * v + 1] - rest[3 * v + 1], now[3 * v + 2] - rest[3 * v + 2]);
    return values;
  }

  /// Graded bodies are drawn with a mix of both materials' colours.
  private mixColours() {
    const scene = this.scene!;
    if (!scene.has('share')) return;
    const [own, other, share] = [scene.u32('material'), scene.u32('other'), scene.f32('share')];
    const base = scene.head.materials.map((m) => new THREE.Color(m.colour));
    const colours = this.body!.getAttribute('color') as THREE.BufferAttribute;
    const mixed = new THREE.Color();
    for (let v = 0; v < own.length; ++v) {
      mixed.copy(base[own[v]]).lerp(base[other[v]], share[v]);
      colours.setXYZ(v, mixed.r, mixed.g, mixed.b);
    }
    colours.needsUpdate = true;
  }

  private updateColours() {
    if (this.options?.field === 'material' && this.body && this.scene) this.mixColours();
    const values = this.fieldValues();
    if (!values || !this.body) return;
    const { scale = 1, range = null, map, bands } = this.options ?? {};
    let low = Infinity, high = -Infinity;
    for (const v of values) {
      if (v < low) low = v;
      if (v > high) high = v;
    }
    // Differences this small, in the legend's unit, are the solver's noise, as at rest: one colour, not a pattern.
    const [noise, least] = [1e-6 / scale, 0.01 / scale];
    if (!(high - low > noise)) {
      if (Math.abs(low) <= noise) low = 0;
      high = low + least;
    }
    this.onData(low * scale, high * scale);
    if (range) [low, high] = [range[0] / scale, range[1] / scale];
    this.onRange(low * scale, high * scale);
    const colours = this.body.getAttribute('color') as THREE.BufferAttribute;
    const c = colours.array as Float32Array;
    const linear = new THREE.Color();
    for (let v = 0; v < values.length; ++v) {
      linear.setRGB(...fieldColour((values[v] - low) / (high - low), map, bands), THREE.SRGBColorSpace);
      c[3 * v] = linear.r;
      c[3 * v + 1] = linear.g;
      c[3 * v + 2] = linear.b;
    }
    colours.needsUpdate = true;
  }

  private updateParts(frame: Frame) {
    const cables = frame.f32('cables');
    let at = 0;
    this.cables.forEach((tube, c) => {
      const count = 3 * this.scene!.head.cable_points[c];
      tube.update(cables.subarray(at, at + count));
      at += count;
    });
    frame.head.markers.forEach((p, m) => this.markers[m]?.position.set(...p));
    if (this.chamberMesh) {
      const chambers = new THREE.BufferAttribute(new Float32Array(frame.f32('chambers')), 3);
      this.chamberMesh.geometry.setAttribute('position', chambers);
    }
    const positions = this.body!.getAttribute('position').array as Float32Array;
    const held = this.supportPoints!.geometry.getAttribute('position') as THREE.BufferAttribute;
    this.supportVertices.forEach((v, k) => held.setXYZ(k, positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]));
    held.needsUpdate = true;
    frame.head.obstacles.forEach(([x, y, z, ...turn], o) => {
      this.obstacles[o]?.position.set(x, y, z);
      if (turn.length === 4) this.obstacles[o]?.quaternion.fromArray(turn);
    });
    this.updateArrow();
  }

  private updateArrow() {
    const grab = this.grabbing;
    this.arrow.visible = this.handle.visible = grab !== null;
    if (!grab || !this.body) return;
    const geometry = new LineGeometry();
    geometry.setPositions([...this.placeOf(grab).toArray(), ...this.handle.position.toArray()]);
    this.arrow.geometry.dispose();
    this.arrow.geometry = geometry;
    this.handle.scale.setScalar(0.012 * this.size);
  }

  /// Wanted positions of a marker, as rings drawn over everything.
  setPath(path: [number, number, number][]) {
    this.path = path;
    for (const dot of this.wanted) {
      this.root.remove(dot);
      dot.geometry.dispose();
      (dot.material as THREE.Material).dispose();
    }
    this.wanted = path.map((p) => {
      const dot = new THREE.Mesh(
        new THREE.OctahedronGeometry(0.014 * this.size),
        new THREE.MeshBasicMaterial({ color: 0x2e86ab, wireframe: true, transparent: true, opacity: 0.95, depthTest: false }),
      );
      dot.position.set(...p);
      dot.renderOrder = 6;
      this.root.add(dot);
      return dot;
    });
    this.invalidate();
  }

  private placeOf(grab: { vertex: number; marker: number }) {
    if (grab.marker >= 0) return this.markers[grab.marker].position.clone();
    const p = this.body!.getAttribute('position');
    return new THREE.Vector3(p.getX(grab.vertex), p.getY(grab.vertex), p.getZ(grab.vertex));
  }

  setOptions(options: ViewOptions) {
    this.options = options;
    if (!this.body || !this.scene) return;
    const coloured = options.field !== 'material' || this.scene.has('share');
    this.scene.head.materials.forEach((m, k) => {
      const outside = (this.meshes[0].material as THREE.MeshStandardMaterial[])[k];
      outside.vertexColors = coloured;
      outside.color.set(coloured ? '#ffffff' : m.colour);
      outside.clippingPlanes = options.sectionAxis ? [this.plane] : [];
      outside.needsUpdate = true;
      const inside = (this.insides[0].material as THREE.MeshBasicMaterial[])[k];
      inside.vertexColors = coloured;
      inside.color.set(coloured ? '#ffffff' : m.colour).multiplyScalar(coloured ? 1 : 0.8);
      inside.clippingPlanes = options.sectionAxis ? [this.plane] : [];
      inside.needsUpdate = true;
    });
    this.insides[0].visible = options.sectionAxis !== '';
    this.setTransparent(options);
    if (this.chamberMesh) {
      this.chamberMesh.visible = options.inside;
      (this.chamberMesh.material as THREE.Material).clippingPlanes = options.sectionAxis ? [this.plane] : [];
    }
    this.placeSection(options);
    this.setWires(options.wireframe);
    this.ghostMesh!.visible = options.ghost;
    this.setPinned(options);
    if (this.frame) this.setFrame(this.frame);
    this.invalidate();
  }

  /// Interior parts are drawn first, then the front of the body over them.
  private setTransparent(options: ViewOptions) {
    const body = this.meshes[0];
    this.bodyDepth!.visible = options.inside;
    (this.bodyDepth!.material as THREE.Material).clippingPlanes = options.sectionAxis ? [this.plane] : [];
    body.renderOrder = options.inside ? 2 : 0;
    for (const m of body.material as THREE.MeshStandardMaterial[]) {
      m.transparent = options.inside;
      m.opacity = options.inside ? 0.36 : 1;
    }
    const depth = this.bodyDepth!.material as THREE.MeshBasicMaterial;
    depth.transparent = options.inside; // so that it is drawn after all opaque objects
  }

  private placeSection(options: ViewOptions) {
    this.sectionSheet.visible = options.sectionAxis !== '';
    if (!options.sectionAxis) return;
    const axis = { x: 0, y: 1, z: 2 }[options.sectionAxis];
    const box = new THREE.Box3().setFromArray(this.body!.getAttribute('position').array as unknown as number[]);
    const at = box.min.getComponent(axis) + options.sectionAt * (box.max.getComponent(axis) - box.min.getComponent(axis));
    const keep = (options.sectionAxis === 'y') !== (options.sectionFlipped ?? false) ? 1 : -1;
    this.plane.normal.set(0, 0, 0).setComponent(axis, keep);
    this.plane.constant = -keep * at;
    // The sheet drawn at the section plane, a little larger than the robot.
    const size = box.getSize(new THREE.Vector3()).addScalar(0.08 * this.size);
    const centre = box.getCenter(new THREE.Vector3()).setComponent(axis, at);
    this.sectionSheet.position.copy(centre);
    this.sectionSheet.rotation.set(0, 0, 0);
    if (options.sectionAxis === 'x') this.sectionSheet.rotation.set(Math.PI / 2, Math.PI / 2, 0);
    if (options.sectionAxis === 'y') this.sectionSheet.rotation.set(Math.PI / 2, 0, 0);
    const [w, h] = options.sectionAxis === 'x' ? [size.y, size.z] : options.sectionAxis === 'y' ? [size.x, size.z] : [size.x, size.y];
    this.sectionSheet.scale.set(w, h, 1);
    this.sectionPlace = { centre, axis, low: box.min.getComponent(axis), high: box.max.getComponent(axis) };
  }

  /// Position of the section plane, and the range of its slider, mm.
  sectionPlace: { centre: THREE.Vector3; axis: number; low: number; high: number } | null = null;

  private buildSheet() {
    const corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(([x, y]) => new THREE.Vector3(x, y, 0));
    const edge = new THREE.LineLoop(new THREE.BufferGeometry().setFromPoints(corners), new THREE.LineBasicMaterial({ color: 0x2e86ab, transparent: true, opacity: 0.8 }));
    const fill = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), new THREE.MeshBasicMaterial({ color: 0x2e86ab, transparent: true, opacity: 0.07, side: THREE.DoubleSide, depthWrite: false }));
    edge.renderOrder = fill.renderOrder = 12;
    this.sectionSheet.add(edge, fill);
    this.sectionSheet.visible = false;
  }

  /// Position of a picked point as drawn, mm.
  placeOfPick(pick: Pick): THREE.Vector3 | null {
    if ('marker' in pick) return this.markers[pick.marker]?.position.clone() ?? null;
    const p = this.body?.getAttribute('position');
    return p && pick.vertex < p.count ? new THREE.Vector3().fromBufferAttribute(p as THREE.BufferAttribute, pick.vertex) : null;
  }

  setPicks(picks: Pick[]) {
    this.picks = picks;
    this.updateMeasure();
    this.invalidate();
  }

  private updateMeasure() {
    for (const c of this.measure.children as THREE.Mesh[]) {
      c.geometry.dispose();
      (c.material as THREE.Material).dispose();
    }
    this.measure.clear();
    const points = this.picks.map((p) => this.placeOfPick(p)).filter((p) => p !== null);
    const over = { depthTest: false, transparent: true };
    for (const p of points) {
      const dot = new THREE.Mesh(new THREE.SphereGeometry(0.008 * this.size, 16, 12), new THREE.MeshBasicMaterial({ color: 0xa64d86, ...over }));
      dot.position.copy(p);
      dot.renderOrder = 14;
      this.measure.add(dot);
    }
    if (points.length > 1) {
      const line = new THREE.Line(new THREE.BufferGeometry().setFromPoints(points), new THREE.LineBasicMaterial({ color: 0xa64d86, ...over }));
      line.renderOrder = 13;
      line.frustumCulled = false;
      this.measure.add(line);
    }
  }

  private setWires(on: boolean) {
    if (!on) {
      if (this.wires) this.wires.visible = false;
      return;
    }
    if (!this.wires) {
      const index = this.body!.getIndex()!.array;
      const edges: number[] = [];
      for (let t = 0; t < index.length; t += 3)
        for (const [a, b] of [[0, 1], [1, 2], [2, 0]]) if (index[t + a] < index[t + b]) edges.push(index[t + a], index[t + b]);
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', this.body!.getAttribute('position'));
      geometry.setIndex(edges);
      this.wires = new THREE.LineSegments(
        geometry,
        new THREE.LineBasicMaterial({ color: 0x10151c, transparent: true, opacity: 0.28 }),
      );
      this.wires.frustumCulled = false;
      this.root.add(this.wires);
    }
    this.wires.visible = true;
  }

  private setPinned(options: ViewOptions) {
    const mesh = this.pinnedMesh!;
    const positions = mesh.geometry.getAttribute('position') as THREE.BufferAttribute;
    mesh.visible = options.pinned !== null && options.pinned.length === positions.array.length;
    if (!mesh.visible) return;
    (positions.array as Float32Array).set(options.pinned!);
    positions.needsUpdate = true;
    mesh.geometry.computeVertexNormals();
    const box = new THREE.Box3().setFromArray(this.scene!.f32('rest') as unknown as number[]);
    mesh.position.set(0, options.beside ? 1.6 * (box.max.y - box.min.y) + 0.1 * this.size : 0, 0);
  }

  /// Fits the robot into view from this side or, without one, from the current direction. The margin leaves room for
  /// overlays.
  lookAt(side?: Side, margin = 0.74) {
    const back = side ? new THREE.Vector3(...sides[side]).normalize() : this.camera.getWorldDirection(new THREE.Vector3()).negate();
    const forward = back.clone().negate();
    const right = new THREE.Vector3().crossVectors(forward, new THREE.Vector3(0, 0, 1)).normalize();
    const up = new THREE.Vector3().crossVectors(right, forward);
    const tan = Math.tan((this.camera.fov * Math.PI) / 360);
    const points = this.body ? (this.body.getAttribute('position').array as Float32Array) : new Float32Array();
    const fit = fitPoints(points, right.toArray(), up.toArray(), forward.toArray(), margin * tan * this.camera.aspect, margin * tan);
    this.controls.target.set(...fit.target);
    this.camera.position.set(...fit.camera);
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = distance / 200;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.invalidate();
    this.onTurned();
  }

  /// Position and target of the camera, mm; can be restored.
  get pose(): number[] {
    return [...this.camera.position.toArray(), ...this.controls.target.toArray()].map((v) => +v.toFixed(2));
  }
  set pose(six: number[]) {
    this.camera.position.set(six[0], six[1], six[2]);
    this.controls.target.set(six[3], six[4], six[5]);
    this.controls.update();
    this.invalidate();
  }

  /// Copies the camera of another view.
  lookLike(other: RobotView) {
    this.camera.position.copy(other.camera.position);
    this.controls.target.copy(other.controls.target);
    this.camera.near = other.camera.near;
    this.camera.far = other.camera.far;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.invalidate();
  }

  /// Size of the robot at rest along the axes, mm.
  get extent(): [number, number, number] {
    const rest = this.scene?.f32('rest') ?? new Float32Array();
    return new THREE.Box3().setFromArray(rest as unknown as number[]).getSize(new THREE.Vector3()).toArray();
  }

  /// Pixels per millimetre at the camera's target.
  get pixelsPerMm(): number {
    const distance = this.camera.position.distanceTo(this.controls.target);
    return this.pixels().y / (2 * Math.tan((this.camera.fov * Math.PI) / 360) * distance);
  }

  turn(around: number, up: number, nearer: number) {
    turnAround(this.camera, this.controls, around, up, nearer);
    this.invalidate();
  }

  private ray(e: PointerEvent) {
    const box = this.canvas.getBoundingClientRect();
    const at = new THREE.Vector2(((e.clientX - box.left) / box.width) * 2 - 1, 1 - ((e.clientY - box.top) / box.height) * 2);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(at, this.camera);
    return ray;
  }

  private pointerDown(e: PointerEvent) {
    if (e.button !== 0 || e.shiftKey) return;
    if (this.pick(e)) return;
    if (!this.mayGrab() || !this.frame || this.options?.exploded) return;
    const marker = this.markerAt(e);
    if (marker >= 0) return this.hold(e, { vertex: -1, marker });
    const vertex = this.vertexAt(e);
    if (vertex < 0) return;
    this.hold(e, { vertex, marker: -1 });
  }

  /// The surface vertex nearest to the hit under the pointer, or -1.
  private vertexAt(e: PointerEvent) {
    const hit = this.hitAt(e);
    if (!hit?.face) return -1;
    const p = this.body!.getAttribute('position');
    const distance = (v: number) => hit.point.distanceTo(new THREE.Vector3(p.getX(v), p.getY(v), p.getZ(v)));
    return [hit.face.a, hit.face.b, hit.face.c].sort((a, b) => distance(a) - distance(b))[0];
  }

  /// Ignores what the section has cut away.
  private hitAt(e: PointerEvent) {
    const hits = this.ray(e).intersectObject(this.meshes[0], false);
    return hits.find((hit) => !this.options?.sectionAxis || this.plane.distanceToPoint(hit.point) >= 0);
  }

  private pick(e: PointerEvent) {
    if (!this.body || !this.scene) return false;
    const marker = this.markerAt(e);
    if (marker >= 0) {
      return this.onPick({ marker }, [...this.scene.head.markers[marker].rest], [0, 0, 0]) && this.keep(e);
    }
    const hit = this.hitAt(e);
    if (!hit?.face) return false;
    return this.onPick({ vertex: this.vertexAt(e) }, ...this.restOf(hit)) && this.keep(e);
  }

  /// Keeps the press from the camera controls.
  private keep(e: PointerEvent) {
    e.stopImmediatePropagation();
    return true;
  }

  /// Rest position of a surface point, mm, and the direction into the body there.
  private restOf(hit: THREE.Intersection): [[number, number, number], [number, number, number]] {
    const [p, rest] = [this.body!.getAttribute('position') as THREE.BufferAttribute, this.scene!.f32('rest')];
    const corners = [hit.face!.a, hit.face!.b, hit.face!.c];
    const now = corners.map((v) => new THREE.Vector3().fromBufferAttribute(p, v));
    const shares = THREE.Triangle.getBarycoord(hit.point, now[0], now[1], now[2], new THREE.Vector3())!.toArray();
    const at = corners.map((v) => new THREE.Vector3(rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]));
    const place = new THREE.Vector3();
    at.forEach((p, i) => place.addScaledVector(p, shares[i]));
    const inward = new THREE.Triangle(at[0], at[1], at[2]).getNormal(new THREE.Vector3()).negate();
    return [place.toArray(), inward.toArray()];
  }

  /// The marker whose dot is under the pointer, or -1: dots are drawn over everything.
  private markerAt(e: PointerEvent) {
    const box = this.canvas.getBoundingClientRect();
    let [best, least] = [-1, markerReach];
    this.markers.forEach((marker, m) => {
      const v = marker.position.clone().project(this.camera);
      const away = Math.hypot(((v.x + 1) / 2) * box.width - (e.clientX - box.left), ((1 - v.y) / 2) * box.height - (e.clientY - box.top));
      if (v.z < 1 && away < least) [best, least] = [m, away];
    });
    return best;
  }

  private hold(e: PointerEvent, what: { vertex: number; marker: number }) {
    const facing = this.camera.getWorldDirection(new THREE.Vector3());
    const at = this.placeOf(what);
    this.grabbing = { ...what, plane: new THREE.Plane().setFromNormalAndCoplanarPoint(facing, at) };
    this.handle.position.copy(at);
    this.controls.enabled = false;
    this.canvas.setPointerCapture(e.pointerId);
    this.canvas.style.cursor = 'grabbing';
    this.updateArrow();
    this.invalidate();
  }

  private pointerMove(e: PointerEvent) {
    if (!this.grabbing) return;
    const at = this.ray(e).ray.intersectPlane(this.grabbing.plane, new THREE.Vector3());
    if (!at) return;
    this.handle.position.copy(at);
    this.updateArrow();
    this.onGrab({ vertex: this.grabbing.vertex, marker: this.grabbing.marker, to: at.toArray() });
    this.invalidate();
  }

  private pointerUp(_: PointerEvent) {
    if (!this.grabbing) return;
    this.grabbing = null;
    this.controls.enabled = true;
    this.canvas.style.cursor = '';
    this.updateArrow();
    this.onGrab(null);
    this.invalidate();
  }

  private resize() {
    const box = (this.canvas.parentElement as Element).getBoundingClientRect();
    if (!box.width || !box.height) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(box.width, box.height, false);
    this.camera.aspect = box.width / box.height;
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  private draw() {
    this.dirty = false;
    this.key.position.copy(this.camera.position).add(new THREE.Vector3(-0.4, -0.3, 0.9).multiplyScalar(this.size));
    this.drawShadow();
    this.renderer.render(this.world, this.camera);
    this.onDraw(this.placer(), this.camera);
  }

  /// Size of the canvas; asking the page for it in every frame would make it lay itself out.
  private pixels() {
    return this.renderer.getSize(new THREE.Vector2());
  }

  /// Projects mm to pixels of the canvas, from its top left corner.
  private placer() {
    const { x: width, y: height } = this.pixels();
    return (p: [number, number, number]): [number, number] => {
      const v = new THREE.Vector3(...p).project(this.camera);
      return [((v.x + 1) / 2) * width, ((1 - v.y) / 2) * height];
    };
  }
  placeOnPage(p: [number, number, number]) {
    this.camera.updateMatrixWorld();
    return this.placer()(p);
  }

  private drawShadow() {
    if (!this.moved || !this.body) return;
    this.moved = false;
    const box = new THREE.Box3().setFromArray(this.body.getAttribute('position').array as unknown as number[]);
    this.ground.update(this.renderer, this.world, box);
  }

  /// The current view as PNG; with a width, scaled to that many pixels.
  async png(width?: number): Promise<Blob | null> {
    const ratio = this.renderer.getPixelRatio();
    if (width) this.renderer.setPixelRatio(width / this.canvas.clientWidth);
    this.draw();
    const blob = await new Promise<Blob | null>((resolve) => this.canvas.toBlob(resolve, 'image/png'));
    if (width) this.renderer.setPixelRatio(ratio);
    this.invalidate();
    return blob;
  }
}
