// The robot in 3D. Redraws only when something has changed.
import * as THREE from 'three';
import type { Frame, Scene } from '../types';
import { fieldColour } from './colormap';
import { draftBox, veil } from './drawn';
import { Ground, shadowLayer } from './ground';
import { Measured } from './measured';
import { Pointer, type PointerTarget } from './pointer';
import { ReachSheets, type Reach } from './reach_sheets';
import { RobotParts } from './robot_parts';
import { SectionPlane, type SectionChoice } from './section_plane';
import { dataRange, displacements, edgesOfTriangles, materialRuns, writeNormals } from './surface';
import type { FieldName, Pick } from './view_state';
import { Viewpoint, type Side } from './viewpoint';

export interface ViewOptions extends SectionChoice {
  field: FieldName;
  scale: number;
  map?: string;
  bands?: number;
  range?: [number, number] | null; // of the colours, in the unit of the legend; null: that of the state
  wireframe: boolean;
  ghost: boolean;
  inside: boolean;
  exploded: number;
  pinned: Float32Array | null;
  beside: boolean;
}

type Place = [number, number, number];
type Project = (p: Place) => [number, number];

/// What is drawn of one scene.
interface Drawn {
  scene: Scene;
  geometry: THREE.BufferGeometry;
  outside: THREE.Mesh<THREE.BufferGeometry, THREE.MeshStandardMaterial[]>;
  /// Makes cut bodies look solid: the inner side of a surface is drawn flat, in the colour of the material.
  inside: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial[]>;
  /// Drawn before a transparent body.
  depth: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;
  wires: THREE.LineSegments | null;
  ghost: THREE.Mesh;
  pinned: THREE.Mesh;
  parts: RobotParts;
  /// Exploded view: each material moves away from the centre of the robot.
  offsets: THREE.Vector3[];
}

export class RobotView {
  readonly renderer: THREE.WebGLRenderer;
  readonly pointer: Pointer;
  private readonly viewpoint: Viewpoint;
  private readonly world = new THREE.Scene();
  private readonly root = new THREE.Group();
  private readonly key = new THREE.DirectionalLight(0xffffff, 2.2);
  private readonly sky = new THREE.HemisphereLight(0xffffff, 0x8a8f98, 1.5);
  private readonly ground = new Ground();
  private readonly section = new SectionPlane();
  private readonly measured = new Measured();
  private readonly reach = new ReachSheets();
  private readonly draft = draftBox();
  private drawn: Drawn | null = null;
  private robot = ''; // drawn last: the same one is seen from where it was before
  private frame: Frame | null = null;
  private size = 100;
  private picks: Pick[] = [];
  private path: Place[] = [];
  private wanted: THREE.Mesh[] = [];
  private options: ViewOptions | null = null;
  private moved = true; // since the shadow was drawn
  private dirty = true;
  private stopped = false;
  onRange: (low: number, high: number) => void = () => {};
  /// Called with the field's range in this state, in the legend's unit, whatever range is shown.
  onData: (low: number, high: number) => void = () => {};
  /// Called after a camera rotation.
  onTurned: () => void = () => {};
  onDraw: (project: Project, camera: THREE.PerspectiveCamera) => void = () => {};

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.localClippingEnabled = true;
    this.renderer.toneMapping = THREE.NoToneMapping;
    this.viewpoint = new Viewpoint(canvas, () => {
      this.invalidate();
      this.onTurned();
    });
    this.pointer = new Pointer(canvas, this.viewpoint, () => this.underPointer(), () => this.invalidate());
    this.key.position.set(0.6, -1, 1.6);
    this.world.add(this.sky, this.key, this.root, this.ground.plane, this.measured.group, this.reach.group, this.draft, this.section.sheet, this.pointer.group);
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
    this.viewpoint.dispose();
    this.ground.dispose();
    this.renderer.dispose();
  }

  invalidate() {
    this.dirty = true;
  }

  setScene(scene: Scene) {
    const first = this.robot !== scene.head.robot;
    this.robot = scene.head.robot;
    this.frame = null;
    this.forget();
    this.build(scene);
    this.setPath(this.path);
    if (first) this.lookAt('home', 0.62); // leaves room for bending
    if (this.options) this.setOptions(this.options);
    this.invalidate();
  }

  /// Shows nothing.
  clear() {
    this.drawn = this.frame = null;
    this.ground.plane.visible = this.section.sheet.visible = false;
    this.forget();
    this.invalidate();
  }

  /// Frees what the last scene has on the graphics card.
  private forget() {
    this.root.traverse((o) => {
      const { geometry, material } = o as Partial<THREE.Mesh>;
      geometry?.dispose();
      for (const m of [material ?? []].flat()) m.dispose();
    });
    this.root.clear();
  }

  private build(scene: Scene) {
    const rest = scene.f32('rest');
    const box = boxOf(rest);
    const centre = box.getCenter(new THREE.Vector3());
    this.size = box.getSize(new THREE.Vector3()).length();
    const geometry = bodyGeometry(scene, new THREE.Sphere(centre, 50 * this.size));
    const colours = scene.head.materials.map((m) => m.colour);
    const outside = new THREE.Mesh(geometry, colours.map((color) => new THREE.MeshStandardMaterial({ color, roughness: 0.62, metalness: 0, side: THREE.FrontSide })));
    const inside = new THREE.Mesh(geometry, colours.map((color) => new THREE.MeshBasicMaterial({ color, side: THREE.BackSide })));
    const depth = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ colorWrite: false }));
    outside.layers.enable(shadowLayer);
    depth.visible = false;
    depth.renderOrder = 1;
    depth.frustumCulled = outside.frustumCulled = inside.frustumCulled = false;
    const ghost = veil(copyOf(geometry), 0x8a93a0, 0.3, 6);
    const pinned = veil(copyOf(geometry), 0xf2a93b, 0.45, 8);
    const parts = new RobotParts(scene, this.size);
    this.root.add(outside, inside, depth, ghost, pinned, parts.group);
    this.drawn = { scene, geometry, outside, inside, depth, wires: null, ghost, pinned, parts, offsets: offsetsOf(scene, centre) };
    this.ground.plane.visible = true;
    this.updateNormals(this.drawn);
  }

  /// Draws this state immediately, for a screenshot.
  show(frame: Frame) {
    this.setFrame(frame);
    this.draw();
  }

  /// The workspace of a marker.
  setReach(reach: Reach | null) {
    this.reach.show(reach);
    this.invalidate();
  }

  /// A box that is being placed as a chamber, mm at rest; null: none.
  setDraft(box: { centre: Place; size: Place } | null) {
    this.draft.visible = box !== null;
    if (box) {
      this.draft.position.set(...box.centre);
      this.draft.scale.set(...box.size);
    }
    this.invalidate();
  }

  setFrame(frame: Frame) {
    const drawn = this.drawn;
    if (!drawn || frame.head.revision !== drawn.scene.head.revision) return;
    this.frame = frame;
    const positions = drawn.geometry.getAttribute('position') as THREE.BufferAttribute;
    (positions.array as Float32Array).set(frame.f32('positions'));
    explode(drawn, positions.array as Float32Array, 1.1 * (this.options?.exploded ?? 0));
    positions.needsUpdate = true;
    this.updateNormals(drawn);
    this.updateColours(drawn, frame);
    drawn.parts.update(frame, positions.array as Float32Array);
    this.pointer.update();
    this.updateMeasured();
    if (this.options?.sectionAxis) this.placeSection(drawn, this.options);
    this.moved = true;
    this.invalidate();
  }

  private updateNormals({ geometry }: Drawn) {
    const normals = geometry.getAttribute('normal') as THREE.BufferAttribute;
    writeNormals(positionsOf(geometry), geometry.getIndex()!.array, normals.array as Float32Array);
    normals.needsUpdate = true;
  }

  private updateColours({ scene, geometry }: Drawn, frame: Frame) {
    const field = this.options?.field ?? 'material';
    const colours = geometry.getAttribute('color') as THREE.BufferAttribute;
    if (field === 'material') return mixColours(scene, colours);
    const values = fieldValues(scene, frame, field);
    if (!values) return;
    const { scale = 1, range = null, map, bands } = this.options ?? {};
    let [low, high] = dataRange(values, scale);
    this.onData(low * scale, high * scale);
    if (range) [low, high] = [range[0] / scale, range[1] / scale];
    this.onRange(low * scale, high * scale);
    const c = colours.array as Float32Array;
    const linear = new THREE.Color();
    for (let v = 0; v < values.length; ++v) {
      linear.setRGB(...fieldColour((values[v] - low) / (high - low), map, bands), THREE.SRGBColorSpace);
      linear.toArray(c, 3 * v);
    }
    colours.needsUpdate = true;
  }

  /// Wanted positions of a marker, as rings drawn over everything.
  setPath(path: Place[]) {
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

  setOptions(options: ViewOptions) {
    this.options = options;
    const drawn = this.drawn;
    if (!drawn) return;
    const planes = options.sectionAxis ? [this.section.plane] : [];
    const coloured = options.field !== 'material' || drawn.scene.has('share');
    drawn.scene.head.materials.forEach((m, k) => {
      for (const material of [drawn.outside.material[k], drawn.inside.material[k]]) {
        material.vertexColors = coloured;
        material.color.set(coloured ? '#ffffff' : m.colour);
        material.clippingPlanes = planes;
        material.needsUpdate = true;
      }
      if (!coloured) drawn.inside.material[k].color.multiplyScalar(0.8);
    });
    drawn.inside.visible = options.sectionAxis !== '';
    drawn.depth.material.clippingPlanes = planes;
    this.setTransparent(drawn, options.inside);
    drawn.parts.showChambers(options.inside, planes);
    this.placeSection(drawn, options);
    this.setWires(drawn, options.wireframe);
    drawn.ghost.visible = options.ghost;
    this.setPinned(drawn, options);
    if (this.frame) this.setFrame(this.frame);
    this.invalidate();
  }

  /// Interior parts are drawn first, then the front of the body over them.
  private setTransparent({ outside, depth }: Drawn, on: boolean) {
    depth.visible = on;
    depth.material.transparent = on; // so that it is drawn after all opaque objects
    outside.renderOrder = on ? 2 : 0;
    for (const m of outside.material) {
      m.transparent = on;
      m.opacity = on ? 0.36 : 1;
    }
  }

  private placeSection({ geometry }: Drawn, choice: SectionChoice) {
    this.section.cut(choice, boxOf(positionsOf(geometry)), 0.08 * this.size);
  }

  /// Position of the section plane, and the range of its slider.
  get sectionPlace() {
    return this.section.place;
  }

  /// Position of a picked point as drawn, mm.
  placeOfPick(pick: Pick): THREE.Vector3 | null {
    return this.pointer.placeOfPick(pick);
  }

  setPicks(picks: Pick[]) {
    this.picks = picks;
    this.updateMeasured();
    this.invalidate();
  }

  private updateMeasured() {
    this.measured.show(this.picks.map((p) => this.placeOfPick(p)).filter((p) => p !== null), 0.008 * this.size);
  }

  private setWires(drawn: Drawn, on: boolean) {
    if (on && !drawn.wires) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', drawn.geometry.getAttribute('position'));
      geometry.setIndex(edgesOfTriangles(drawn.geometry.getIndex()!.array));
      drawn.wires = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: 0x10151c, transparent: true, opacity: 0.28 }));
      drawn.wires.frustumCulled = false;
      this.root.add(drawn.wires);
    }
    if (drawn.wires) drawn.wires.visible = on;
  }

  private setPinned({ scene, pinned }: Drawn, options: ViewOptions) {
    const positions = pinned.geometry.getAttribute('position') as THREE.BufferAttribute;
    pinned.visible = options.pinned !== null && options.pinned.length === positions.array.length;
    if (!pinned.visible) return;
    (positions.array as Float32Array).set(options.pinned!);
    positions.needsUpdate = true;
    pinned.geometry.computeVertexNormals();
    const width = boxOf(scene.f32('rest')).getSize(new THREE.Vector3()).y;
    pinned.position.set(0, options.beside ? 1.6 * width + 0.1 * this.size : 0, 0);
  }

  private underPointer(): PointerTarget | null {
    if (!this.drawn) return null;
    const { scene, outside, parts } = this.drawn;
    return {
      mesh: outside,
      markers: parts.markers,
      rest: scene.f32('rest'),
      markersAtRest: scene.head.markers.map((m) => m.rest),
      size: this.size,
      keeps: (point) => !this.options?.sectionAxis || this.section.keeps(point),
      canBePulled: this.frame !== null && !this.options?.exploded,
    };
  }

  /// Fits the robot into view from this side or, without one, from the current direction. The margin leaves room for
  /// overlays.
  lookAt(side?: Side, margin = 0.74) {
    this.viewpoint.fit(this.drawn ? positionsOf(this.drawn.geometry) : new Float32Array(), side, margin);
    this.invalidate();
    this.onTurned();
  }

  /// Position and target of the camera, mm; can be restored.
  get pose(): number[] {
    return this.viewpoint.pose;
  }
  set pose(six: number[]) {
    this.viewpoint.pose = six;
    this.invalidate();
  }

  /// Copies the camera of another view.
  lookLike(other: RobotView) {
    this.viewpoint.copy(other.viewpoint);
    this.invalidate();
  }

  turn(around: number, up: number, nearer: number) {
    this.viewpoint.turn(around, up, nearer);
    this.invalidate();
  }

  /// Size of the robot at rest along the axes, mm.
  get extent(): Place {
    return boxOf(this.drawn?.scene.f32('rest') ?? new Float32Array()).getSize(new THREE.Vector3()).toArray();
  }

  /// Pixels per millimetre at the camera's target.
  get pixelsPerMm(): number {
    return this.viewpoint.pixelsPerMm(this.pixels().y);
  }

  private resize() {
    const box = (this.canvas.parentElement as Element).getBoundingClientRect();
    if (!box.width || !box.height) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(box.width, box.height, false);
    this.viewpoint.resize(box.width, box.height);
    this.invalidate();
  }

  private draw() {
    this.dirty = false;
    const { camera } = this.viewpoint;
    this.key.position.copy(camera.position).add(new THREE.Vector3(-0.4, -0.3, 0.9).multiplyScalar(this.size));
    this.drawShadow();
    this.renderer.render(this.world, camera);
    this.onDraw(this.placer(), camera);
  }

  private drawShadow() {
    if (!this.moved || !this.drawn) return;
    this.moved = false;
    this.ground.update(this.renderer, this.world, boxOf(positionsOf(this.drawn.geometry)));
  }

  /// Size of the canvas; asking the page for it in every frame would make it lay itself out.
  private pixels() {
    return this.renderer.getSize(new THREE.Vector2());
  }

  /// Projects mm to pixels of the canvas, from its top left corner.
  private placer(): Project {
    const { x: width, y: height } = this.pixels();
    return (p) => {
      const v = new THREE.Vector3(...p).project(this.viewpoint.camera);
      return [((v.x + 1) / 2) * width, ((1 - v.y) / 2) * height];
    };
  }
  placeOnPage(p: Place) {
    this.viewpoint.camera.updateMatrixWorld();
    return this.placer()(p);
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

const positionsOf = (geometry: THREE.BufferGeometry) => geometry.getAttribute('position').array as Float32Array;

const boxOf = (positions: Float32Array) => new THREE.Box3().setFromArray(positions as unknown as number[]);

function bodyGeometry(scene: Scene, bounds: THREE.Sphere) {
  const rest = scene.f32('rest');
  const body = new THREE.BufferGeometry();
  body.setAttribute('position', new THREE.BufferAttribute(new Float32Array(rest), 3));
  body.setAttribute('normal', new THREE.BufferAttribute(new Float32Array(rest.length), 3));
  body.setAttribute('color', new THREE.BufferAttribute(new Float32Array(rest.length).fill(1), 3));
  body.setIndex(new THREE.BufferAttribute(new Uint32Array(scene.u32('triangles')), 1));
  body.boundingSphere = bounds;
  for (const [begin, count, material] of materialRuns(scene)) body.addGroup(begin, count, material);
  return body;
}

function copyOf(body: THREE.BufferGeometry) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(positionsOf(body)), 3));
  geometry.setIndex(body.getIndex());
  geometry.computeVertexNormals();
  return geometry;
}

/// From the robot's centre to that of each material.
function offsetsOf(scene: Scene, centre: THREE.Vector3) {
  const rest = scene.f32('rest');
  const material = scene.u32('material');
  const sums = scene.head.materials.map(() => ({ at: new THREE.Vector3(), n: 0 }));
  for (let v = 0; v < material.length; ++v) {
    sums[material[v]].at.add(new THREE.Vector3(rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]));
    sums[material[v]].n += 1;
  }
  return sums.map((s) => (s.n ? s.at.divideScalar(s.n).sub(centre) : s.at));
}

function explode({ scene, offsets }: Drawn, positions: Float32Array, by: number) {
  if (!by) return;
  const material = scene.u32('material');
  for (let v = 0; v < material.length; ++v) {
    const offset = offsets[material[v]];
    positions[3 * v] += by * offset.x;
    positions[3 * v + 1] += by * offset.y;
    positions[3 * v + 2] += by * offset.z;
  }
}

function fieldValues(scene: Scene, frame: Frame, field: FieldName): Float32Array | null {
  if (field === 'displacement') return displacements(scene.f32('rest'), frame.f32('positions'));
  return frame.has(field) ? frame.f32(field) : null;
}

/// Graded bodies are drawn with a mix of both materials' colours.
function mixColours(scene: Scene, colours: THREE.BufferAttribute) {
  if (!scene.has('share')) return;
  const [own, other, share] = [scene.u32('material'), scene.u32('other'), scene.f32('share')];
  const base = scene.head.materials.map((m) => new THREE.Color(m.colour));
  const mixed = new THREE.Color();
  for (let v = 0; v < own.length; ++v) {
    mixed.copy(base[own[v]]).lerp(base[other[v]], share[v]);
    colours.setXYZ(v, mixed.r, mixed.g, mixed.b);
  }
  colours.needsUpdate = true;
}
