// The printed part as boxes, one for each run of cells. It hangs from the platform, whose underside is z = 0.
import * as THREE from 'three';
import type { Part } from './part';
import type { MachineInfo } from './state';

export class PartMesh {
  readonly group = new THREE.Group();
  /// Of all that is there, mm; z downwards from the platform is negative.
  readonly box = new THREE.Box3();
  private mesh: THREE.InstancedMesh | null = null;
  private starts: number[] = [0]; // first box of each slab
  private revision = -1;
  private cells = 0;

  constructor(
    private readonly projector: MachineInfo['projector'],
    private readonly colours: THREE.Color[],
  ) {
    // Images are turned with the part.
    this.group.rotation.z = (-projector.rotation * Math.PI) / 180;
  }

  show(part: Part | null) {
    if (!part || part.slabs.length === 0) {
      this.group.visible = false;
      this.starts = [0];
      this.revision = part?.revision ?? -1;
      this.box.makeEmpty();
      return;
    }
    this.group.visible = true;
    const from = part.revision === this.revision ? Math.min(part.changedFrom, this.starts.length - 1) : 0;
    if (from === 0) this.box.makeEmpty();
    this.revision = part.revision;
    this.starts.length = from + 1;
    this.cells = part.slabs.reduce((sum, slab) => sum + slab.runs.length / 3, 0);
    this.reserve(this.cells);
    for (let s = from; s < part.slabs.length; ++s) {
      this.place(part, s);
      this.starts.push(this.starts[s] + part.slabs[s].runs.length / 3);
    }
    this.mesh!.count = this.cells;
    this.mesh!.instanceMatrix.needsUpdate = true;
    if (this.mesh!.instanceColor) this.mesh!.instanceColor.needsUpdate = true;
  }

  private reserve(count: number) {
    const old = this.mesh;
    if (old && old.instanceMatrix.count >= count) return;
    const mesh = new THREE.InstancedMesh(new THREE.BoxGeometry(1, 1, 1), new THREE.MeshStandardMaterial({ roughness: 0.62 }), Math.max(1024, 2 * count));
    mesh.frustumCulled = false;
    mesh.setColorAt(0, new THREE.Color());
    if (old) {
      (mesh.instanceMatrix.array as Float32Array).set(old.instanceMatrix.array);
      (mesh.instanceColor!.array as Float32Array).set(old.instanceColor!.array);
      this.group.remove(old);
      old.geometry.dispose();
      old.dispose();
    }
    this.mesh = mesh;
    this.group.add(mesh);
  }

  private place(part: Part, s: number) {
    const { width, height, pixel, mirror_x, mirror_y, offset_x, offset_y } = this.projector;
    const slab = part.slabs[s];
    const cell = part.cell_px * pixel;
    const right = mirror_x ? -1 : 1;
    const down = mirror_y ? 1 : -1;
    const matrix = new THREE.Matrix4();
    const grey = new THREE.Color(0x8f99a5);
    const high = slab.top - slab.bottom;
    for (let r = 0; r < slab.runs.length; r += 3) {
      const material = slab.runs[r] >>> 24;
      const row = slab.runs[r + 1];
      const begin = slab.runs[r + 2] & 0xffff;
      const end = slab.runs[r + 2] >>> 16;
      const x = right * (((begin + end) / 2) * cell - (width * pixel) / 2) - offset_x;
      const y = down * ((row + 0.5) * cell - (height * pixel) / 2) - offset_y;
      const z = -(slab.bottom + high / 2);
      const index = this.starts[s] + r / 3;
      matrix.makeScale((end - begin) * cell, cell, high).setPosition(x, y, z);
      this.mesh!.setMatrixAt(index, matrix);
      this.mesh!.setColorAt(index, this.colours[material] ?? grey);
      const half = ((end - begin) * cell) / 2;
      this.box.expandByPoint(new THREE.Vector3(x - half, y - cell / 2, z - high / 2));
      this.box.expandByPoint(new THREE.Vector3(x + half, y + cell / 2, z + high / 2));
    }
  }

  dispose() {
    this.mesh?.geometry.dispose();
    (this.mesh?.material as THREE.Material | undefined)?.dispose();
    this.mesh?.dispose();
  }
}
