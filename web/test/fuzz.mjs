// Random calls of the engine with random arguments and mutated files: no trap, no array out of its bounds, every failure a
// BattenError, and the engine works as before afterwards. A call depends on the seed and its number alone.
// Usage: fuzz.mjs [SECONDS [SEED [NUMBER]]]: seconds, default 5; the first number, or with NUMBER that call alone.
import assert from "node:assert/strict";
import { readdirSync, readFileSync, statSync } from "node:fs";
import { join } from "node:path";

const [seconds = 5, seed = 1, only = null] = process.argv.slice(2).map(Number);
const source = process.env.SOURCE;

let memory;
const instantiate = WebAssembly.instantiate;
WebAssembly.instantiate = async (...args) => {
  const made = await instantiate(...args);
  memory = (made.instance ?? made).exports.memory;
  return made;
};
const { BattenError, CurveSet, load } = await import("../npm/index.mjs");
const batten = await load();

// Random choices (mulberry32).
let state = 0;
const random = () => {
  state = (state + 0x6d2b79f5) | 0;
  let t = Math.imul(state ^ (state >>> 15), 1 | state);
  t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
  return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
};
const below = (n) => Math.floor(random() * n);
const chance = (p) => random() < p;
const pick = (list) => list[below(list.length)];
const many = (n, make) => Array.from({ length: n }, (_, i) => make(i));

const NUMBERS = [0, -0, 1, -1, 0.5, 1.5, 1e-9, 1e9, 1e308, -1e308, 2 ** 31, 2 ** 32, 2 ** 53, Number.NaN, Infinity, -Infinity];
const wild = () =>
  pick([
    () => pick(NUMBERS), () => pick(["", "0", "NaN", "\u0000", "é\ud800", "x".repeat(999), "__proto__", "learned"]), () => null, () => undefined,
    () => true, () => [], () => [[]], () => [[1, [2, null]]], () => ({}), () => ({ "": ["f64", 0, 9] }), () => () => 1, () => Symbol("s"), () => 7n,
    () => new Date(0), () => /x/, () => new Uint8Array(below(9)), () => new Float32Array([1, 2, Number.NaN]), () => new BigInt64Array(2),
    () => new DataView(new ArrayBuffer(8)), () => new ArrayBuffer(4), () => new Map([[1, 2]]), () => Object.create(null), () => new Proxy({}, {}),
    () => many(3, () => pick(NUMBERS)), () => new Array(5),
  ])();
/** A value, sometimes another of any type. */
const maybe = (value, p = 0.03) => (chance(p) ? wild() : value);
const real = () => (chance(0.03) ? pick(NUMBERS) : chance(0.2) ? below(4) : 2 * random() - 1);
/** Rows of numbers as rows, as one array, or typed. */
const formed = (rows, Type = Float64Array) => pick([() => rows, () => rows.flat(), () => Type.from(rows.flat()), () => rows.map((row) => Type.from(row))])();

const DIMS = { plane: 2, sphere: 3, disk: 2, rotation: 4, rigid: 7, euclidean: 3, spd: 6, hyperbolic: 3 };
function point(space) {
  const values = many(DIMS[space] ?? 2, real);
  const unit = (part) => part.map((v) => v / Math.hypot(...part));
  if (chance(0.05)) return values;
  if (space === "sphere" || space === "rotation") return unit(values);
  if (space === "disk") return values.map((v) => v / (2 + Math.abs(v)));
  if (space === "rigid") return [...values.slice(0, 3), ...unit(values.slice(3))];
  if (space === "hyperbolic") return [Math.hypot(1, values[1], values[2]), values[1], values[2]];
  if (space === "spd") return [3 + values[0], values[1], values[2], 3 + values[3], values[4], 3 + values[5]];
  return values;
}
function curve(space = chance(0.5) ? "plane" : pick(Object.keys(DIMS))) {
  const n = chance(0.1) ? below(3) : 2 + below(14);
  const made = { points: maybe(formed(many(n, () => point(space)))) };
  if (space !== "plane" || chance(0.3)) made.space = maybe(space);
  if (chance(0.5)) made.closed = maybe(chance(0.5));
  if (chance(0.2)) made.channels = maybe(many(n, () => many(2, real)));
  if (chance(0.2)) made.corners = maybe(Uint8Array.from(many(n, () => below(2))));
  if (chance(0.1)) made.point_dim = maybe(DIMS[space]);
  if (chance(0.1)) made.times = maybe(many(n, (i) => i + 0.5 * random()));
  return made;
}
const curves = () => {
  const space = pick(["plane", "plane", ...Object.keys(DIMS)]);
  return maybe(chance(0.5) ? curve(space) : many(below(4), () => curve(space)));
};

const CUBE = [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]];
const QUADS = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
function mesh(polygons = chance(0.2)) {
  let positions = CUBE;
  let faces = polygons ? QUADS : QUADS.flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]);
  if (chance(0.4)) {
    const n = 2 + below(6);
    positions = many(n * n, (i) => [i % n, Math.floor(i / n), 0]);
    faces = many((n - 1) ** 2, (k) => k + Math.floor(k / (n - 1))).flatMap((a) => (polygons ? [[a, a + 1, a + n + 1, a + n]] : [[a, a + 1, a + n], [a + 1, a + n + 1, a + n]]));
  }
  if (chance(0.6)) positions = positions.map((row) => row.map((v) => v + 0.3 * real()));
  faces = faces.filter(() => !chance(0.05)).map((row) => row.map((v) => (chance(0.01) ? below(positions.length + 2) : v)));
  const made = { positions: maybe(formed(positions)), faces: maybe(polygons ? faces : formed(faces, Uint32Array)) };
  const corners = faces.flat().length;
  if (chance(0.1)) Object.assign(made, { texture: maybe(many(6, () => [random(), random()])), texture_faces: maybe(many(corners, () => below(6))) });
  if (chance(0.1)) Object.assign(made, { channels: maybe(many(positions.length, () => [real()])), channel_names: maybe(["heat"]) });
  if (chance(0.1)) made.creases = maybe(many(below(4), () => maybe([below(8), below(8), pick([0, 1, 2.5, Infinity])])));
  if (chance(0.1)) made.corners = maybe(many(below(4), () => maybe([below(9), 2])));
  if (chance(0.1)) Object.assign(made, { labels: maybe([maybe({ group: maybe("a"), material: "b" })]), face_labels: maybe(many(faces.length, () => below(2))) });
  if (chance(0.05)) made.rules = maybe({ boundary: maybe("corners") });
  if (chance(0.05)) made.material_json = maybe('{"materials":[]}');
  if (chance(0.05)) made.offsets = maybe(Uint32Array.from(many(faces.length + 1, (i) => (polygons ? 4 : 3) * i)));
  return maybe(made);
}
function cloud() {
  const n = pick([0, 1, 3, 8, 40, 200]);
  const flat = chance(0.5);
  const points = formed(many(n, () => (flat ? [random(), random(), 0.1 * real()] : many(3, real))));
  if (chance(0.7)) return maybe(points);
  return maybe({ points: maybe(points), boundary_count: maybe(below(n + 2)), ...(chance(0.3) ? { corners: maybe(many(4, () => below(n + 1))) } : {}), ...(chance(0.2) ? { triangles: maybe(many(3, () => many(3, () => below(n + 1)))) } : {}) });
}

/** Files of the project, by what reads them. */
const files = {};
for (const folder of readdirSync(join(source, "fuzz/corpus")).sort()) {
  const reads = { cloud: "cloud", csv: "curve", geojson: "curve", gpx: "curve", obj: "curve", topojson: "curve", wkt: "curve" }[folder] ?? (folder.startsWith("mesh_") ? "mesh" : null);
  for (const name of reads ? readdirSync(join(source, "fuzz/corpus", folder)).sort() : []) {
    const path = join(source, "fuzz/corpus", folder, name);
    if (statSync(path).size < 4096) (files[reads] ??= []).push(readFileSync(path));
  }
}
const WORDS = ["0", "-1", "1e999", "nan", "4294967296", "{", "]", ",", "\n", "\0", '""', "x", "-0"];
function file(kind) {
  let bytes = Uint8Array.from(pick(files[chance(0.9) ? kind : pick(Object.keys(files))]));
  for (let changes = below(5); changes > 0 && bytes.length > 0; changes--) {
    const at = below(bytes.length);
    const word = new TextEncoder().encode(pick(WORDS));
    const end = chance(0.5) ? at : Math.min(bytes.length, at + below(20));
    if (chance(0.4)) bytes[at] ^= 1 << below(8);
    else if (chance(0.2)) bytes = bytes.slice(0, at);
    else bytes = Uint8Array.from([...bytes.slice(0, at), ...(chance(0.7) ? word : bytes.slice(at, at + 20)), ...bytes.slice(end)]);
  }
  return maybe(chance(0.3) ? new TextDecoder().decode(bytes) : bytes);
}

const signatures = batten.signatures();
const names = (family) => batten.bat_choices(family).map(({ name }) => name);
const SIZES = [0, 1, 2, 3, 4, 6];
function options(call) {
  if (chance(0.05)) return wild();
  const made = {};
  for (const [name, type, family] of signatures.operations[call] ?? []) {
    // Those that lead to as much as memory holds are rare.
    if (!chance(["max_edge", "max_levels", "max_points", "tolerance"].includes(name) ? 0.03 : 0.2)) continue;
    const own = name === "scheme" ? names(chance(0.9) && call.includes("mesh") ? "mesh_scheme" : "curve_scheme") : [true, false];
    made[name] = maybe(
      { size: () => (chance(0.05) ? pick(NUMBERS) : pick(SIZES)), int: () => below(6) - 1, uint64: () => below(99), number: () => pick([0, 0.01, 0.1, 0.5, 1, 2, real()]),
        bool: () => chance(0.5), choice: () => pick(names(family)), text: () => pick(["plane", "sphere", "x,y", "a", "EPSG:25833", "zyx,degrees"]), own: () => pick(own) }[type](),
      0.05,
    );
  }
  if (chance(0.05)) made[pick(["level", "", "__proto__", "f64"])] = wild();
  if (chance(0.2) || call.startsWith("bat_shell")) {
    let left = below(5);
    made.progress = maybe(() => left-- > 0);
  }
  return made;
}

const CALLS = {
  ...Object.fromEntries(["bat_curve_refine", "bat_curve_map_refine", "bat_curve_fairness", "bat_motion_curves", "bat_curve_write_memory"].map((name) => [name, () => [chance(0.3) ? read() : curves(), options(name)]])),
  ...Object.fromEntries(["bat_curve_is_simple", "bat_curve_exterior_angles", "bat_curve_edge_lengths"].map((name) => [name, () => [curves()]])),
  bat_curve_compare: () => [curves(), curves(), options("bat_curve_compare")],
  bat_curve_read_memory: () => [file("curve"), options("bat_curve_read_memory")],
  bat_mask_analyze: () => [maybe(pick([...names("curve_scheme"), "mask:1/8,4/8,6/8,4/8,1/8", `mask:${real()},${real()},1`])), options("bat_mask_analyze")],
  bat_mask_basis: () => [maybe(pick(names("curve_scheme"))), maybe(below(8))],
  bat_motion_spline_sample: () => [maybe(curve()), maybe(many(below(5), () => 3 * random())), options("bat_motion_spline_sample")],
  ...Object.fromEntries(["bat_mesh_refine", "bat_mesh_decimate", "bat_mesh_write_memory"].map((name) => [name, () => [mesh(false), options(name)]])),
  ...Object.fromEntries(["bat_mesh_scheme_for", "bat_mesh_limit_normals", "bat_mesh_repair", "bat_mesh_summarize", "bat_polygon_mesh_of_triangles"].map((name) => [name, () => [mesh()]])),
  bat_mesh_weld: () => [mesh(), maybe(pick([0, 0.1, 1]))],
  bat_mesh_compare: () => [mesh(false), mesh(false), options("bat_mesh_compare")],
  bat_mesh_vertex_distances: () => [mesh(false), mesh(false)],
  bat_mesh_read_memory: () => [file("mesh"), options("bat_mesh_read_memory")],
  bat_polygon_mesh_read_memory: () => [file("mesh"), options("bat_polygon_mesh_read_memory")],
  ...Object.fromEntries(["bat_polygon_mesh_refine", "bat_polygon_mesh_write_memory"].map((name) => [name, () => [mesh(true), options(name)]])),
  ...Object.fromEntries(["bat_polygon_mesh_scheme_for", "bat_polygon_mesh_limit_normals", "bat_polygon_mesh_triangulate"].map((name) => [name, () => [mesh(true)]])),
  bat_cloud_read: () => [file("cloud"), options("bat_cloud_read")],
  bat_cloud_noise: () => [cloud()],
  bat_surface_reconstruct: () => [cloud(), options("bat_surface_reconstruct")],
  bat_shell_reconstruct: () => (chance(0.5) ? [mesh(false), options("bat_shell_reconstruct")] : [cloud(), options("bat_shell_reconstruct")]),
  bat_choices: () => [wild()],
};
/** Calls of what another call gives. */
const NEXT = {
  CurveSet: ["bat_curve_write_memory", "bat_curve_refine", "bat_curve_map_refine", "bat_motion_curves", "bat_curve_fairness"],
  Surface: ["bat_surface_write", "bat_spline_surface_evaluate"],
  Shell: ["bat_shell_write", "bat_shell_tessellate"],
  mesh: ["bat_mesh_refine", "bat_mesh_write_memory", "bat_mesh_decimate", "bat_mesh_summarize", "bat_polygon_mesh_of_triangles"],
  polygons: ["bat_polygon_mesh_refine", "bat_polygon_mesh_write_memory", "bat_polygon_mesh_triangulate"],
};

function read() {
  try {
    return kept(batten.bat_curve_read_memory(pick(files.curve)));
  } catch (error) {
    checkFailure(error);
    return curves();
  }
}
let held = [];
const kept = (result) => {
  if (typeof result?.free === "function") held.push(result);
  return result;
};

function checkFailure(error) {
  assert.ok(error instanceof BattenError, `${error?.stack ?? error}`);
  assert.ok(typeof error.status === "string" && error.message.length > 0);
}
/** Every array is a copy of its own; indices name what is there. */
function check(result) {
  if (ArrayBuffer.isView(result)) {
    assert.ok(result.buffer !== memory.buffer && result.byteOffset + result.byteLength <= result.buffer.byteLength);
    return;
  }
  if (typeof result !== "object" || result === null) return;
  Object.values(result).forEach(check);
  const within = (indices, end) => indices?.forEach((index) => assert.ok(index < end, `${index} of ${end}`));
  const finite = (values) => values?.forEach((value) => assert.ok(Number.isFinite(value), `${value}`));
  if (result.positions && result.faces) {
    const count = result.positions.length / 3;
    finite(result.positions);
    within(result.faces, count);
    if (result.offsets) result.offsets.forEach((end, i) => assert.ok(end <= result.faces.length && (i === 0 || end > result.offsets[i - 1])));
    else assert.equal(result.faces.length % 3, 0);
    if (result.channel_names) assert.equal(result.channels?.length ?? 0, count * result.channel_names.length);
    if (result.face_labels?.length) within(result.face_labels, result.labels.length);
    if (result.texture_faces?.length) within(result.texture_faces, result.texture.length / 2);
  }
  const dim = result.point_dim;
  for (const { points, channels, corners } of result.curves ?? (result.points && dim ? [result] : [])) {
    finite(points);
    assert.equal(points.length % dim, 0);
    if (channels) assert.equal(channels.length % (points.length / dim), 0);
    if (corners) assert.equal(corners.length, points.length / dim);
  }
}

const REFERENCE = () => [
  ...batten.bat_curve_refine({ points: [[0, 0], [4, 0], [4, 4], [0, 3]], closed: true }, { levels: 2 }).points,
  ...batten.bat_mesh_refine({ positions: CUBE, faces: QUADS.flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]) }, { levels: 1 }).positions,
];
const before = REFERENCE();
const counts = { calls: 0, results: 0 };
let slowest = [0];

function call(name, args, number) {
  counts.calls++;
  const began = Date.now();
  try {
    const result = kept(batten[name](...args));
    check(result);
    counts.results++;
    return result;
  } catch (error) {
    checkFailure(error);
    return null;
  } finally {
    if (Date.now() - began > slowest[0]) slowest = [Date.now() - began, name, number];
  }
}

const end = Date.now() + 1000 * seconds;
for (let number = only ?? 0; only === null ? Date.now() < end : number === only; number++) {
  state = Math.imul(seed, 0x9e3779b1) ^ Math.imul(number + 1, 0x85ebca6b);
  let name = pick(Object.keys(CALLS));
  if (name === "bat_shell_reconstruct" && !chance(0.02)) name = "bat_cloud_read"; // shells take seconds
  let args = [];
  try {
    args = CALLS[name]();
    const result = call(name, args, number);
    const kind = result instanceof CurveSet || NEXT[result?.constructor?.name] ? result.constructor.name : result?.positions && result.faces ? (result.offsets ? "polygons" : "mesh") : null;
    if (kind !== null && chance(0.5)) {
      name = pick(NEXT[kind]);
      const more = { bat_spline_surface_evaluate: () => [many(below(4), () => [random(), random()]), maybe(below(3))], bat_shell_tessellate: () => [maybe(below(5))] };
      args = [result, ...(more[name] ?? (() => [options(name)]))()];
      call(name, args, number);
    }
  } catch (error) {
    console.error(`seed ${seed}, call ${number}, ${name}:`, args);
    throw error;
  }
  held.forEach((result) => result.free());
  held = [];
  if (number % 200 === 0) assert.deepEqual(REFERENCE(), before);
}
assert.deepEqual(REFERENCE(), before);
console.log(`${counts.calls} calls, ${counts.results} results; the heap has ${memory.buffer.byteLength >> 20} MiB; longest: ${slowest.join(", ")}`);
