// What a robot has beside its bodies: cables, markers, chambers, supports, obstacles and free objects.
import * as THREE from 'three';
import type { Frame, Scene } from '../types';
import { edgesOf, groundMesh } from './drawn';
import { shadowLayer } from './ground';
import { Tube } from './tube';

const cableColour = 0xcc1a24;
const objectColour = 0xd9a441;
const obstacleColour = 0xb3b8bf;

export class RobotParts {
  readonly group = new THREE.Group();
  readonly markers: THREE.Mesh[];
  private readonly cables: Tube[];
  private readonly chambers: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial> | null;
  private readonly supportVertices: number[] = [];
  private readonly supports: THREE.Points;
  private readonly obstacles: THREE.Object3D[];

  /// `size`: diagonal of the robot at rest, mm.
  constructor(private readonly scene: Scene, private readonly size: number) {
    this.cables = scene.head.cable_points.map(() => this.cable());
    this.markers = scene.head.markers.map(() => this.marker());
    this.chambers = this.chamberWalls();
    scene.u32('support').forEach((s, v) => s > 0 && this.supportVertices.push(v));
    this.supports = this.supportDots();
    this.obstacles = scene.head.obstacles.map((_, o) => this.obstacle(o));
  }

  private cable() {
    const tube = new Tube(0.0055 * this.size);
    const mesh = new THREE.Mesh(tube.geometry, new THREE.MeshStandardMaterial({ color: cableColour, roughness: 0.45 }));
    mesh.frustumCulled = false;
    mesh.layers.enable(shadowLayer);
    this.group.add(mesh);
    return tube;
  }

  private marker() {
    const dot = new THREE.Mesh(
      new THREE.SphereGeometry(0.009 * this.size, 20, 14),
      new THREE.MeshBasicMaterial({ color: 0x11161d, transparent: true, opacity: 0.9, depthTest: false }),
    );
    dot.renderOrder = 5;
    this.group.add(dot);
    return dot;
  }

  private chamberWalls() {
    const triangles = this.scene.u32('chamber_triangles');
    if (!triangles.length) return null;
    const geometry = new THREE.BufferGeometry();
    geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(triangles), 1));
    const walls = new THREE.Mesh(
      geometry,
      new THREE.MeshBasicMaterial({ color: 0x2f9bff, transparent: true, opacity: 0.2, depthTest: false, side: THREE.DoubleSide }),
    );
    walls.frustumCulled = false;
    walls.renderOrder = 3;
    this.group.add(walls);
    return walls;
  }

  private supportDots() {
    const places = new THREE.BufferGeometry();
    places.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * this.supportVertices.length), 3));
    const dots = new THREE.Points(places, new THREE.PointsMaterial({ color: 0x6b7580, size: 4, sizeAttenuation: false }));
    dots.frustumCulled = false;
    this.group.add(dots);
    return dots;
  }

  private obstacle(o: number) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(this.scene.f32(`obstacle_points_${o}`)), 3));
    geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(this.scene.u32(`obstacle_triangles_${o}`)), 1));
    geometry.computeVertexNormals();
    const { open, object } = this.scene.head.obstacles[o];
    const mesh = open
      ? groundMesh(geometry, this.size)
      : new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ color: object ? objectColour : obstacleColour, roughness: 0.8, side: THREE.DoubleSide }));
    if (!open) mesh.layers.enable(shadowLayer);
    if (object && !open) mesh.add(edgesOf(geometry));
    this.group.add(mesh);
    return mesh;
  }

  /// Chambers are shown where one looks into the body, and cut by these planes.
  showChambers(visible: boolean, planes: THREE.Plane[]) {
    if (!this.chambers) return;
    this.chambers.visible = visible;
    this.chambers.material.clippingPlanes = planes;
  }

  /// `positions`: of the bodies' vertices as drawn, mm.
  update(frame: Frame, positions: Float32Array) {
    const cables = frame.f32('cables');
    let at = 0;
    this.cables.forEach((tube, c) => {
      const count = 3 * this.scene.head.cable_points[c];
      tube.update(cables.subarray(at, at + count));
      at += count;
    });
    frame.head.markers.forEach((p, m) => this.markers[m]?.position.set(...p));
    this.chambers?.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(frame.f32('chambers')), 3));
    const held = this.supports.geometry.getAttribute('position') as THREE.BufferAttribute;
    this.supportVertices.forEach((v, k) => held.setXYZ(k, positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]));
    held.needsUpdate = true;
    frame.head.obstacles.forEach(([x, y, z, ...turn], o) => {
      this.obstacles[o]?.position.set(x, y, z);
      if (turn.length === 4) this.obstacles[o]?.quaternion.fromArray(turn);
    });
  }
}
