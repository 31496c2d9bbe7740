/** Rows of numbers, or the same numbers one after the other. */
export type Rows = Float64Array | number[] | number[][];

/** A failure of the library. */
export class BattenError extends Error {
  /** The name of the C status: "invalid argument", "bad file", … */
  status: string;
  /** The point, vertex or face at fault, counted from 0. */
  index: number | null;
  /** The line of the file at fault, counted from 1. */
  line: number | null;
  /** The option at fault. */
  option: string | null;
  /** The option that leads out, and what it does. */
  remedy: string | null;
  effect: string;
  /** The message without the remedy. */
  text: string;
}

/** A polyline in a space. */
export interface Curve {
  /** "plane" (the default), "sphere", "disk", …: bat_choices("space"). */
  space?: string;
  /** Coordinates of a point, for "euclidean", "spd" and "hyperbolic" where `points` is flat. */
  point_dim?: number;
  points: Rows;
  closed?: boolean;
  channels?: Rows | null;
  /** Not 0 at corners. */
  corners?: ArrayLike<number> | null;
}

/** A curve that came out of the library. */
export interface CurveResult extends Curve {
  space: string;
  point_dim: number;
  points: Float64Array;
  closed: boolean;
  channels?: Float64Array;
  corners?: Uint8Array;
}

export interface CurveRefineReport {
  checked: number;
  given_crossing: number;
  crossing: number;
  crossings: number;
  drawn_back: number;
  straight: number;
  left_crossing: number;
  corners: number;
  min_levels: number;
  max_levels: number;
}

export interface CurveMapReport extends CurveRefineReport {
  map: boolean;
  arcs: number;
  shared: number;
  nodes: number;
  snapped: number;
  largest_snap: number;
  largest_area_error: number;
}

/** Curves inside the module, with what their file tells beside them. */
export class CurveSet {
  readonly curves: { points: Float64Array; closed: boolean; channels?: Float64Array; corners?: Uint8Array }[];
  readonly space: string;
  readonly point_dim: number;
  /** What the reader guessed or changed. */
  readonly notes: string[];
  /** Of a file that was read: whether its curves have times. */
  readonly has_times?: boolean;
  /** Of a file that was read: [polygon, feature] of each curve, null for lines. */
  readonly polygons?: ([number, number] | null)[];
  /** Of a refinement. */
  readonly report?: CurveRefineReport | CurveMapReport;
  free(): void;
}

/** A function of the share done; false stops the call with the status "cancelled". */
export interface Progress {
  progress?: (fraction: number) => boolean | void;
}

export interface CurveRefineOptions extends Progress {
  /** A name of bat_choices("curve_scheme") with settings: "learned:fairness=0.8", "mask:1/4,3/4,3/4,1/4". */
  scheme?: string;
  levels?: number;
  ends?: "reflect" | "extrapolate" | "free";
  snap?: boolean;
  simple?: string;
  max_points?: number;
  corner_angle?: number;
  max_edge?: number;
  tolerance?: number;
  max_levels?: number;
  first_level?: number;
  /** A length; NaN: by the noise, which is estimated. */
  smooth?: number;
}

export interface CurveMapOptions extends CurveRefineOptions {
  topology?: string;
  edges?: string;
  join?: string;
  simplify?: number;
  snap_tolerance?: number;
  keep_area?: boolean;
  decimals?: number;
}

export interface CurveReadOptions {
  format?: string;
  space?: string;
  closed?: -1 | 0 | 1;
  strict?: boolean;
  project?: boolean;
  columns?: string;
  group?: string;
  euler?: string;
  translation_weight?: number;
}

export interface CurveWriteOptions {
  format?: string;
  precision?: number;
  crs?: string;
}

/** A value by each name of bat_curve_measures(1, …), the fields of bat_curve_fairness_values. */
export type Fairness = Record<string, number>;

/** A value by each name of bat_curve_measures(2, …), the fields of bat_curve_distance. */
export type CurveDistance = Record<string, number>;

export interface Weights {
  weights: number[];
  first: number;
}

export type Verdict = "undecided" | "proven" | "disproven";

export interface Analysis {
  mask: Weights;
  quotient: Weights;
  multiplicity: number;
  remainder: number;
  is_interpolatory: boolean;
  is_symmetric: boolean;
  shift: number;
  generation_degree: number;
  reproduction_degree: number;
  matrix_first: number;
  matrix_size: number;
  matrix: number[];
  eigenvalues: { real: number; imaginary: number; multiplicity: number; vector_count: number }[];
  converges: Verdict;
  limit: Weights;
  tangent: Weights;
  vertex: Weights;
  radius_lower: number;
  radius_upper: number;
  product: string;
  depth: number;
  is_stable: boolean;
  exponent_lower: number;
  exponent_upper: number;
  smooth_proven: number;
  smooth_disproven: number;
  lipschitz: Verdict;
}

export interface MotionOptions extends Progress {
  scheme?: string;
  rate?: number;
  levels?: number;
  tangent_order?: number;
  velocities?: boolean;
  ends?: string;
  shape?: string;
  sigma?: number;
  angle_sigma?: number;
}

export interface Keyframes extends Curve {
  times?: Rows;
}

/** A triangle mesh. */
export interface Mesh {
  /** Three a vertex. */
  positions: Rows;
  /** Three a face. */
  faces: Uint32Array | number[] | number[][];
  /** Texture coordinates, two a row, and those at the corners of the faces. */
  texture?: Rows | null;
  texture_faces?: Uint32Array | number[] | number[][] | null;
  /** Further numbers at the vertices, one a name in each row. */
  channels?: Rows | null;
  channel_names?: string[];
  creases?: [number, number, number][];
  corners?: [number, number][];
  /** The label of each face, and the labels. */
  face_labels?: Uint32Array | number[] | null;
  labels?: MeshLabel[];
  material_files?: string | null;
  material_json?: string | null;
  rules?: MeshRules;
}

/** What a mesh says about its refinement: names of bat_choices("mesh_boundary"), "mesh_creasing" and "mesh_linear". */
export interface MeshRules {
  boundary?: string;
  creasing?: string;
  linear?: string;
}

/** A mesh of polygons: `faces` are rows of corners, or all corners one behind the other with `offsets`. */
export interface PolygonMesh extends Mesh {
  /** Face i has the corners offsets[i] to offsets[i + 1] - 1. */
  offsets?: Uint32Array | number[];
}

/** Names that faces share. */
export interface MeshLabel {
  object: string | null;
  group: string | null;
  material: string | null;
  smoothing: string | null;
}

export interface MeshResult extends Mesh {
  positions: Float64Array;
  faces: Uint32Array;
  texture: Float64Array | null;
  texture_faces: Uint32Array | null;
  channels: Float64Array | null;
  channel_names: string[];
  creases: [number, number, number][];
  corners: [number, number][];
  face_labels: Uint32Array | null;
  labels: MeshLabel[];
  material_files: string | null;
  material_json: string | null;
  rules: Required<MeshRules>;
}

export interface PolygonMeshResult extends MeshResult {
  offsets: Uint32Array;
}

export interface MeshRefineOptions extends Progress {
  /** A name of bat_choices("mesh_scheme"). */
  scheme?: string;
  then?: string;
  /** 0 to 1, of the learned scheme. */
  fairness?: number;
  levels?: number;
  limit?: boolean;
  /** With `limit`: add `limit_normals` to the result. */
  limit_normals?: boolean;
  /** Radians. */
  crease_angle?: number;
  /** Refine adaptively, until faces are as near to the limit surface, or edges as short. */
  tolerance?: number;
  max_edge?: number;
  /** Rules of Loop's and Catmull and Clark's schemes, before those of the mesh. */
  boundary?: string;
  creasing?: string;
  linear?: string;
}

export interface MeshDecimateOptions extends Progress {
  vertices?: number;
  faces?: number;
  ratio?: number;
  tolerance?: number;
  relative_tolerance?: boolean;
  /** A name of bat_choices("mesh_decimate_method"). */
  method?: string;
  candidates?: number;
  seed?: number;
  min_normal?: number;
  min_quality?: number;
  boundary_weight?: number;
  attributes?: number;
}

export interface MeshReadOptions {
  format?: string;
  triangulate?: boolean;
  keep_degenerate?: boolean;
  repair?: boolean;
}

export interface MeshWriteOptions {
  format?: string;
  encoding?: "binary" | "big-endian" | "text";
  normals?: "none" | "angle" | "area";
}

/** A value by each name of bat_mesh_measures(1, …), the fields of bat_mesh_summary: numbers, flags and points. */
export type MeshSummary = Record<string, any>;

/** A value by each name of bat_mesh_measures(2, …), the fields of bat_mesh_distance: numbers and points. */
export type MeshDistance = Record<string, any>;

/** A row of a table of the library. */
export interface Choice {
  name: string;
  settings: string;
  summary: string;
  endings: string;
  reads: boolean;
  writes: boolean;
}

export type CurveInput = Curve | Curve[] | CurveSet;

/** The functions of the library, by their C names; include/batten documents each. */
export interface Batten {
  bat_version(): string;
  /** The choices of a family, "mesh_scheme" for bat_mesh_scheme_family; without a name of all families. */
  bat_choices(family: string): Choice[];
  bat_choices(): Record<string, Choice[]>;

  bat_curve_refine(coarse: Curve, options?: CurveRefineOptions): CurveResult & { report: CurveRefineReport };
  bat_curve_refine(coarse: Curve[], options?: CurveRefineOptions): CurveResult[] & { report: CurveRefineReport };
  bat_curve_refine(coarse: CurveSet, options?: CurveRefineOptions): CurveSet;
  bat_curve_map_refine(coarse: Curve[], options?: CurveMapOptions): CurveResult[] & { report: CurveMapReport };
  bat_curve_map_refine(coarse: CurveSet, options?: CurveMapOptions): CurveSet;
  bat_curve_read_memory(data: string | ArrayBuffer | ArrayBufferView, options?: CurveReadOptions): CurveSet;
  bat_curve_write_memory(set: CurveInput, options?: CurveWriteOptions): Uint8Array;
  bat_curve_fairness(curve: Curve): Fairness;
  bat_curve_fairness(curves: Curve[] | CurveSet): Fairness[];
  bat_curve_is_simple(curve: Curve): boolean;
  bat_curve_is_simple(curves: Curve[] | CurveSet): boolean[];
  bat_curve_exterior_angles(curve: Curve): Float64Array;
  bat_curve_edge_lengths(curve: Curve): Float64Array;
  bat_curve_compare(
    first: Curve,
    second: Curve,
    options?: Progress & { geodesic?: boolean; to_segments?: boolean },
  ): CurveDistance;
  bat_mask_analyze(scheme: string, options?: { depth?: number; tolerance?: number; vertices?: number }): Analysis;
  bat_mask_basis(scheme: string, level?: number): { values: Float64Array; level: number; first: number; last: number };

  bat_motion_curves(set: CurveSet, options?: MotionOptions): CurveSet;
  bat_motion_spline_sample(
    keys: Keyframes,
    times: Rows,
    options?: { ends?: string; shape?: string; sigma?: number; angle_sigma?: number; max_speed?: number; max_acceleration?: number;
      max_angular_speed?: number; max_angular_acceleration?: number; extrapolate?: boolean },
  ): { points: Float64Array; velocities: Float64Array; accelerations: Float64Array };

  bat_mesh_refine(coarse: Mesh, options?: MeshRefineOptions): MeshResult & { fallback: number };
  bat_mesh_scheme_for(coarse: Mesh): string;
  bat_mesh_limit_normals(mesh: Mesh): Float64Array;
  bat_mesh_decimate(fine: Mesh, options?: MeshDecimateOptions): MeshResult;
  bat_mesh_repair(broken: Mesh): MeshResult & { repairs: Record<string, number> };
  bat_mesh_weld(mesh: Mesh, distance?: number): MeshResult & { merged: number };
  bat_mesh_read_memory(
    data: string | ArrayBuffer | ArrayBufferView,
    options?: MeshReadOptions,
  ): MeshResult & { repairs: Record<string, number> };
  bat_mesh_write_memory(mesh: Mesh, options?: MeshWriteOptions): Uint8Array;
  bat_mesh_summarize(mesh: Mesh): MeshSummary;
  bat_mesh_compare(
    first: Mesh,
    second: Mesh,
    options?: Progress & { vertices?: boolean; samples?: number; tolerance?: number },
  ): MeshDistance;
  bat_mesh_vertex_distances(from: Mesh, onto: Mesh): Float64Array;

  bat_polygon_mesh_refine(coarse: PolygonMesh, options?: MeshRefineOptions): PolygonMeshResult & { fallback: number };
  bat_polygon_mesh_scheme_for(coarse: PolygonMesh): string;
  bat_polygon_mesh_limit_normals(mesh: PolygonMesh): Float64Array;
  bat_polygon_mesh_triangulate(mesh: PolygonMesh): MeshResult;
  bat_polygon_mesh_of_triangles(mesh: Mesh): PolygonMeshResult;
  bat_polygon_mesh_read_memory(
    data: string | ArrayBuffer | ArrayBufferView,
    options?: MeshReadOptions,
  ): PolygonMeshResult & { repairs: Record<string, number> };
  bat_polygon_mesh_write_memory(mesh: PolygonMesh, options?: MeshWriteOptions): Uint8Array;
}

/** Load the library from the file beside the package, or from the content of batten.wasm. */
export function load(source?: ArrayBuffer | ArrayBufferView | WebAssembly.Module): Promise<Batten>;
/** The same, from a binary only. */
export function instantiate(source: ArrayBuffer | ArrayBufferView | WebAssembly.Module): Promise<Batten>;
