// Messages and data of the studio, described in docs/reference/studio.md.
import type { Packet } from './packet';

export interface Material {
  name: string;
  colour: string;
  law: string;
  from_library?: boolean; // the file has no table of it
  has_youngs_modulus?: boolean; // among the constants of its law
  youngs_modulus_MPa: number;
  poisson_ratio: number;
  density_kg_m3: number;
  resin: string;
}

export interface Actuator {
  type: 'cable' | 'chamber';
  name: string;
  kind: string;
  target: number;
  rest: number;
  elements?: boolean; // made of elements of the mesh
}

/// Element order: linear, quadratic, or linear during interaction and quadratic as soon as the input rests.
export type Accuracy = 'preview' | 'automatic' | 'fine';

export interface SceneHead {
  revision: number;
  opened: number; // number of the robot: another one was opened, or this one changed, if it has another revision only
  accuracy: Accuracy;
  robot: string;
  materials: Material[];
  bodies?: { name: string; material: number }[];
  unit_mm?: number; // per unit of the robot file's coordinates
  graded: { body: string; material: number; other: number }[];
  actuators: Actuator[];
  cable_points: number[];
  supports: string[];
  markers: { name: string; rest: [number, number, number] }[];
  sensors?: { name: string; readings: { name: string; unit: string }[] }[];
  obstacles: { name: string; open: boolean; object?: boolean }[];
  loaded: boolean;
  program: { steps: number; duration: number; timed?: boolean };
  tolerance: number;
  nodes: number;
  tets: number;
  order: number;
}

export interface FrameHead {
  revision: number;
  sequence: number;
  tag: number;
  time: number;
  order?: number; // element order of this state; missing: that of the scene
  refining?: boolean; // an approximate result is shown, the quadratic one is being computed
  reduced_error_mm?: number; // the state is that of a reduced model: its estimated error
  arrived: boolean;
  stuck: string;
  warnings: string[]; // reasons not to trust the state
  playing: boolean;
  wanted: { time: number; actuators: { name: string; kind: string; value: number }[] }; // no actuators: they follow the
                                                                                        // program
  residual: number;
  min_J: number;
  energy_mJ: number;
  iterations: number;
  solve_ms: number;
  cables: { ratio: number; length_mm: number; tension_N: number }[];
  chambers: { ratio: number; volume_mm3: number; pressure_kPa: number }[];
  markers: [number, number, number][];
  supports: [number, number, number][];
  sensors?: number[][]; // in the order of the scene's readings
  obstacles: [number, number, number, ...number[]][];
  contacts?: [number, number, number][]; // N, of obstacles on the robot, then of everything that touches an object on
                                         // it
  self_contact_N?: number;
  beside?: boolean; // a frame of the second robot
  pull?: { vertex: number; force_N: [number, number, number] };
  lead?: Lead; // a dragged marker, which the actuators follow
}

export interface Lead {
  marker: string;
  to_mm: [number, number, number];
  settled: boolean; // it cannot get closer
  reached: boolean;
  error_mm: number;
  limits: string[]; // what limits it
}

export type Scene = Packet<SceneHead>;
export type Frame = Packet<FrameHead>;

export interface Problem {
  line: number;
  text: string;
}

export interface JobMaterial {
  name: string;
  resin: string;
  exposure_s: number;
  model_volume_mm3: number;
}

export interface Plan {
  layers: number;
  swaps: number;
  swap_lower_bound: number;
  order_rule: string;
  orders: Record<string, { swaps: number; change_s: number }>;
  seconds: Record<'total' | 'swap' | 'clean' | 'expose' | 'move', number>;
  layer_seconds: Record<'total' | 'swap' | 'clean' | 'expose' | 'move', number[]>;
  resin_ml: Record<string, number>;
  waste_ml: number;
  solvent_ml: number;
  vats: { slot: number; resin: string; refill: boolean; first_layer: number; last_layer: number; waste_ml: number; materials: number[] }[];
  order: number[][];
  warnings: string[];
}

/// Position of images on the platform.
export interface Projector {
  width: number;
  height: number;
  pixel: number;
  mirror_x: boolean;
  mirror_y: boolean;
  rotation: number;
  offset_x: number;
  offset_y: number;
}

/// What a job was sliced from.
export interface JobSource {
  robot: string; // digest of the robot file's text
  order: Record<string, unknown>; // body of /api/job/slice
}

export interface Job {
  /** Source of its images, if not the current job. */
  at?: (layer: number, material: number) => string;
  revision: number;
  /** In the addresses of its images: they change with their content, also over restarts of the studio. */
  key: string;
  file: string;
  saved: boolean;
  /** Null: not sliced from the robot in the editor. */
  source: JobSource | null;
  printer: string;
  colours: string[];
  issues: { text: string; severity?: string; layer: number; row?: number; column?: number }[];
  platform: { width_mm: number; depth_mm: number };
  projector: Projector;
  manifest: {
    name: string;
    width_px: number;
    height_px: number;
    pixel_um: number;
    materials: JobMaterial[];
    layers: { number?: number; z_um: number; thickness_um: number; images: { material: number; file: string; area_mm2: number }[] }[];
  };
  plan?: Plan;
  plan_error?: string;
  swap?: { from: number; to: number; seconds: number; devices: string[]; stretches: { device: string; begin: number; end: number }[] };
}
