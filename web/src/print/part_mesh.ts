// The outer faces of the printed part. Coplanar faces of adjacent cells are merged, so that a plain part is cheap
// however many cells it has. It hangs from the platform, whose underside is z = 0.
import * as THREE from 'three';
import type { Part } from './part';
import type { Projector } from '../types';

const grey = new THREE.Color(0x8f99a5);

/// Faces, four corners each, in growing arrays.
class Faces {
  count = 0;
  positions = new Float32Array(0);
  normals = new Int8Array(0);
  colours = new Float32Array(0);

  private reserve(count: number) {
    if (12 * count <= this.positions.length) return;
    const room = 12 * Math.max(1024, 2 * count);
    const grown = <A extends Float32Array | Int8Array>(from: A, to: A) => {
      to.set(from as never);
      return to;
    };
    this.positions = grown(this.positions, new Float32Array(room));
    this.normals = grown(this.normals, new Int8Array(room));
    this.colours = grown(this.colours, new Float32Array(room));
  }

  /// A rectangle normal to `axis` (0 to 2) at `at`, from low to high along the two other axes in order.
  add(axis: number, at: number, towards: 1 | -1, [a0, a1]: [number, number], [b0, b1]: [number, number], colour: THREE.Color) {
    this.reserve(this.count + 1);
    const [u, v] = [[1, 2], [2, 0], [0, 1]][axis];
    const [u0, u1, v0, v1] = u < v ? [a0, a1, b0, b1] : [b0, b1, a0, a1];
    // Counter-clockwise seen from the front: u, v and the axis are right-handed.
    const corners = towards > 0 ? [[u0, v0], [u1, v0], [u1, v1], [u0, v1]] : [[u0, v0], [u0, v1], [u1, v1], [u1, v0]];
    for (let k = 0; k < 4; ++k) {
      const i = 12 * this.count + 3 * k;
      this.positions[i + axis] = at;
      this.positions[i + u] = corners[k][0];
      this.positions[i + v] = corners[k][1];
      this.normals.fill(0, i, i + 3);
      this.normals[i + axis] = 127 * towards;
      this.colours[i] = colour.r;
      this.colours[i + 1] = colour.g;
      this.colours[i + 2] = colour.b;
    }
    ++this.count;
  }
}

/// Merges identical stretches of consecutive rows into one.
class Chains {
  private open = new Map<string, { row: number; end: number; begin: number; to: number; material: number }>();
  constructor(private readonly done: (row: number, end: number, begin: number, to: number, material: number) => void) {}

  add(row: number, begin: number, to: number, material: number) {
    const key = `${begin},${to},${material}`;
    const chain = this.open.get(key);
    if (chain && chain.end === row) {
      chain.end = row + 1;
      return;
    }
    if (chain) this.close(chain);
    this.open.set(key, { row, end: row + 1, begin, to, material });
  }
  private close(c: { row: number; end: number; begin: number; to: number; material: number }) {
    this.done(c.row, c.end, c.begin, c.to, c.material);
  }
  flush() {
    for (const chain of this.open.values()) this.close(chain);
    this.open.clear();
  }
}

export class PartMesh {
  readonly group = new THREE.Group();
  /// Bounds of the part, mm; z downwards from the platform is negative.
  readonly box = new THREE.Box3();
  private readonly faces = new Faces();
  private readonly mesh: THREE.Mesh;
  private starts: number[] = [0]; // index of the first face of each slab
  private revision = -1;
  private columns = 0;
  private rows = 0;

  constructor(
    private readonly projector: Projector,
    private readonly colours: THREE.Color[],
  ) {
    // Adjacent faces of different lengths leave hairline gaps: double-sided, so that the far side of the part shows
    // through, not the background.
    this.mesh = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshStandardMaterial({ roughness: 0.62, vertexColors: true, side: THREE.DoubleSide }));
    this.mesh.frustumCulled = false;
    this.group.add(this.mesh);
    // Images are rotated with the part.
    this.group.rotation.z = (-projector.rotation * Math.PI) / 180;
  }

  /// Position of a layer's pixel in the group.
  placeOf(row: number, column: number, z_mm: number) {
    const { width, height, pixel, mirror_x, mirror_y, offset_x, offset_y } = this.projector;
    const x = (mirror_x ? -1 : 1) * (column - width / 2) * pixel - offset_x;
    const y = (mirror_y ? 1 : -1) * (row - height / 2) * pixel - offset_y;
    return new THREE.Vector3(x, y, -z_mm);
  }

  show(part: Part | null) {
    this.group.visible = part !== null && part.slabs.length > 0;
    if (!part || part.slabs.length === 0) {
      this.starts = [0];
      this.revision = -1;
      this.box.makeEmpty();
      return;
    }
    this.columns = Math.ceil(this.projector.width / part.cell_px);
    this.rows = Math.ceil(this.projector.height / part.cell_px);
    // The slab before the first new one is covered by it.
    const same = part.revision === this.revision;
    const from = same ? Math.max(0, Math.min(part.changedFrom, this.starts.length - 1) - 1) : 0;
    if (from === 0) this.box.makeEmpty();
    this.revision = part.revision;
    this.starts.length = from + 1;
    this.faces.count = this.starts[from];
    let below = from > 0 ? this.grid(part, from - 1) : null;
    let here: Uint8Array | null = this.grid(part, from);
    for (let s = from; s < part.slabs.length; ++s) {
      const next = s + 1 < part.slabs.length ? this.grid(part, s + 1) : null;
      this.addSlab(part, s, below, here!, next);
      this.starts.push(this.faces.count);
      below = here;
      here = next;
    }
    this.upload();
  }

  private grid(part: Part, s: number) {
    const grid = new Uint8Array(this.columns * this.rows);
    const runs = part.slabs[s].runs;
    for (let r = 0; r < runs.length; r += 3) grid.fill(1, runs[r + 1] * this.columns + (runs[r + 2] & 0xffff), runs[r + 1] * this.columns + (runs[r + 2] >>> 16));
    return grid;
  }

  private addSlab(part: Part, s: number, below: Uint8Array | null, here: Uint8Array, next: Uint8Array | null) {
    const { width, height, pixel, mirror_x, mirror_y, offset_x, offset_y } = this.projector;
    const slab = part.slabs[s];
    const cell = part.cell_px * pixel;
    const right = mirror_x ? -1 : 1;
    const down = mirror_y ? 1 : -1;
    const x = (column: number) => right * (column * cell - (width * pixel) / 2) - offset_x;
    const y = (row: number) => down * (row * cell - (height * pixel) / 2) - offset_y;
    const span = (a: number, b: number): [number, number] => (a < b ? [a, b] : [b, a]);
    const [z0, z1] = [-slab.top, -slab.bottom]; // it hangs
    const colour = (material: number) => this.colours[material] ?? grey;
    const { columns, rows } = this;
    const solid = (grid: Uint8Array | null, row: number, column: number) => grid !== null && row >= 0 && column >= 0 && row < rows && column < columns && grid[row * columns + column] === 1;
    const flat = (at: number, towards: 1 | -1) => new Chains((row, end, b, e, m) => this.faces.add(2, at, towards, span(x(b), x(e)), span(y(row), y(end)), colour(m)));
    const upright = (towards: 1 | -1) => new Chains((row, end, at, _, m) => this.faces.add(0, x(at), (right * towards) as 1 | -1, span(y(row), y(end)), [z0, z1], colour(m)));
    const platformSide = flat(z1, 1);
    const windowSide = flat(z0, -1);
    const begins = upright(-1);
    const ends = upright(1);
    const stretches = (begin: number, end: number, covered: (c: number) => boolean, done: (b: number, e: number) => void) => {
      for (let c = begin; c < end; ) {
        const b = c;
        const hidden = covered(c);
        while (c < end && covered(c) === hidden) ++c;
        if (!hidden) done(b, c);
      }
    };
    for (let r = 0; r < slab.runs.length; r += 3) {
      const material = slab.runs[r] >>> 24;
      const row = slab.runs[r + 1];
      const begin = slab.runs[r + 2] & 0xffff;
      const end = slab.runs[r + 2] >>> 16;
      stretches(begin, end, (c) => solid(below, row, c), (b, e) => platformSide.add(row, b, e, material));
      stretches(begin, end, (c) => solid(next, row, c), (b, e) => windowSide.add(row, b, e, material));
      for (const side of [-1, 1] as const)
        stretches(begin, end, (c) => solid(here, row + side, c), (b, e) =>
          this.faces.add(1, y(side < 0 ? row : row + 1), (down * side) as 1 | -1, span(x(b), x(e)), [z0, z1], colour(material)),
        );
      if (!solid(here, row, begin - 1)) begins.add(row, begin, 0, material);
      if (!solid(here, row, end)) ends.add(row, end, 0, material);
      this.box.expandByPoint(new THREE.Vector3(x(begin), y(row), z0));
      this.box.expandByPoint(new THREE.Vector3(x(end), y(row + 1), z1));
    }
    for (const chains of [platformSide, windowSide, begins, ends]) chains.flush();
  }

  private upload() {
    const { positions, normals, colours, count } = this.faces;
    const geometry = this.mesh.geometry;
    const known = geometry.getAttribute('position') as THREE.BufferAttribute | undefined;
    if (known?.array === positions) {
      for (const name of ['position', 'normal', 'color']) geometry.getAttribute(name).needsUpdate = true;
    } else {
      this.mesh.geometry = new THREE.BufferGeometry();
      this.mesh.geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
      this.mesh.geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3, true));
      this.mesh.geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3));
      const faces = positions.length / 12;
      const index = new Uint32Array(6 * faces);
      for (let f = 0; f < faces; ++f) index.set([4 * f, 4 * f + 1, 4 * f + 2, 4 * f, 4 * f + 2, 4 * f + 3], 6 * f);
      this.mesh.geometry.setIndex(new THREE.BufferAttribute(index, 1));
      geometry.dispose();
    }
    this.mesh.geometry.setDrawRange(0, 6 * count);
  }

  dispose() {
    this.mesh.geometry.dispose();
    (this.mesh.material as THREE.Material).dispose();
  }
}
