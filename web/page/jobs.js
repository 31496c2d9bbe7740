// What the page asks of the engine. Each job is a function of the engine, its arguments and a progress function; arguments and
// results are plain data.

const DEGREE = Math.PI / 180;

/** A triangle of the sphere. */
const RING = { space: "sphere", closed: true, points: [[1, 0, 0], [0.8, 0.6, 0], [0.8, 0, 0.6]] };

/** Whether a scheme refines curves of the sphere and keeps their points, as maps need it. */
function keepsPoints(batten, scheme) {
  try {
    const fine = batten.bat_curve_refine(RING, { scheme, levels: 1, simple: "never" }).points;
    return RING.points.every((point, i) => point.every((value, c) => Math.abs(fine[6 * i + c] - value) < 1e-12));
  } catch {
    return false;
  }
}

export function tables(batten) {
  const lists = batten.bat_choices();
  return { version: batten.bat_version(), lists, map_schemes: lists.curve_scheme.filter(({ name }) => keepsPoints(batten, name)) };
}

/** Refine a curve by several schemes, with the measures of each. */
export function curve(batten, { coarse, schemes, options, measure = true }, progress) {
  const results = schemes.map((scheme, i) => {
    try {
      const fine = batten.bat_curve_refine(coarse, {
        ...options,
        scheme,
        progress: (fraction) => progress((i + fraction) / schemes.length),
      });
      const result = { scheme, points: fine.points, crossings: fine.report.left_crossing + fine.report.given_crossing, drawn: fine.report.drawn_back };
      if (measure) {
        result.fairness = batten.bat_curve_fairness(fine);
        result.simple = fine.points.length < 600000 ? batten.bat_curve_is_simple(fine) : null;
      }
      return result;
    } catch (error) {
      const { text, remedy, effect } = error;
      return { scheme, error: { message: error.message, text, remedy, effect } };
    }
  });
  let given = null;
  if (measure)
    try {
      given = { fairness: batten.bat_curve_fairness(coarse), simple: batten.bat_curve_is_simple(coarse) };
    } catch {
      given = null;
    }
  return { results, given };
}

/** The comb: exterior angle over mean edge length at the points of a curve. */
export function comb(batten, { fine }) {
  const angles = batten.bat_curve_exterior_angles(fine);
  const lengths = batten.bat_curve_edge_lengths(fine);
  const count = angles.length;
  const curvature = new Float64Array(count);
  for (let i = 0; i < count; i++) {
    const before = lengths[(i + count - 1) % count] ?? 0;
    const after = lengths[i] ?? before;
    const mean = (before + after) / 2;
    curvature[i] = mean > 0 && (fine.closed || (i > 0 && i < count - 1)) ? angles[i] / mean : 0;
  }
  return curvature;
}

export function readCurves(batten, { bytes, options }) {
  const set = batten.bat_curve_read_memory(bytes, options);
  const { curves, space, point_dim, notes, has_times } = set;
  set.free();
  return { curves, space, point_dim, notes, has_times };
}

/** Why formats cannot hold curves, by their names; nothing of those that can. */
export function refusals(batten, { curves, formats }) {
  const reasons = {};
  for (const format of formats)
    try {
      batten.bat_curve_write_memory(curves, { format });
    } catch (error) {
      reasons[format] = error.text ?? error.message;
    }
  return reasons;
}

export function writeCurves(batten, { curves, format }) {
  return batten.bat_curve_write_memory(curves, { format });
}

/** Where the refined border of one curve differs from that of its neighbour, in a map refined curve by curve. */
function tears(coarse, fine, levels) {
  const step = 2 ** levels;
  const edges = new Map();
  const found = [];
  const key = (p, i) => `${p[3 * i]},${p[3 * i + 1]},${p[3 * i + 2]}`;
  coarse.forEach((curve, c) => {
    const p = curve.points;
    const count = p.length / 3;
    const fineCount = fine[c].points.length / 3;
    for (let i = 0; i < (curve.closed ? count : count - 1); i++) {
      const [a, b] = [key(p, i), key(p, (i + 1) % count)];
      const other = edges.get(`${b};${a}`) ?? edges.get(`${a};${b}`);
      if (!other) {
        edges.set(`${a};${b}`, { c, i, a });
        continue;
      }
      const same = other.a === a;
      const q = fine[other.c].points;
      const otherCount = q.length / 3;
      let worst = 0;
      let at = null;
      for (let k = 1; k < step; k++) {
        const u = 3 * ((i * step + k) % fineCount);
        const v = 3 * ((other.i * step + (same ? k : step - k)) % otherCount);
        const r = fine[c].points;
        const distance = Math.hypot(r[u] - q[v], r[u + 1] - q[v + 1], r[u + 2] - q[v + 2]);
        if (distance > worst) {
          worst = distance;
          at = [Math.atan2(r[u + 1], r[u]) / DEGREE, Math.asin(Math.max(-1, Math.min(1, r[u + 2]))) / DEGREE];
        }
      }
      if (worst > 1e-9) found.push({ at, gap: worst });
    }
  });
  return found.sort((x, y) => y.gap - x.gap);
}

/** Refine a map with its topology, and each curve by itself to see what would have torn. */
export function map(batten, { bytes, options, read, write, formats = [] }, progress) {
  const set = batten.bat_curve_read_memory(bytes, read);
  const owned = [set];
  try {
    const { topology, ...rest } = options;
    const fine = batten.bat_curve_map_refine(set, {
      ...rest,
      topology: topology ? "shared" : "separate",
      progress: (fraction) => progress(fraction * 0.8),
    });
    owned.push(fine);
    if (write) return { text: batten.bat_curve_write_memory(fine, { format: write }) };
    const alone = topology
      ? batten.bat_curve_map_refine(set, { ...rest, keep_area: false, topology: "separate", progress: (f) => progress(0.8 + f * 0.2) })
      : fine;
    if (topology) owned.push(alone);
    const torn = set.space === "sphere" ? tears(set.curves, alone.curves, rest.levels ?? 5) : [];
    return {
      coarse: set.curves,
      fine: fine.curves,
      polygons: set.polygons,
      space: set.space,
      notes: set.notes,
      report: fine.report,
      refused: refusals(batten, { curves: set, formats }),
      tears: torn.slice(0, 5000),
      torn: torn.length,
    };
  } finally {
    owned.forEach((one) => one.free());
  }
}

/** A mesh of triangles; polygons have `offsets`. */
const cut = (batten, mesh) => (mesh.offsets ? batten.bat_polygon_mesh_triangulate(mesh) : mesh);

/** The summary of a mesh, or of its triangles with the number of polygons. */
function summarize(batten, mesh, triangles) {
  const summary = batten.bat_mesh_summarize(triangles);
  return mesh.offsets ? { ...summary, faces: mesh.offsets.length - 1 } : summary;
}

export function readMesh(batten, { bytes, options }) {
  const { offsets, ...rest } = batten.bat_polygon_mesh_read_memory(bytes, options);
  const mesh = rest.faces.length === 3 * (offsets.length - 1) ? rest : { ...rest, offsets };
  return { mesh, summary: summarize(batten, mesh, cut(batten, mesh)) };
}

/** Decimate, refine, and measure the distance from another scheme. */
export function mesh(batten, { coarse, decimate, refine, against, repair }, progress) {
  let base = coarse;
  if (repair || decimate) base = cut(batten, base);
  if (repair) base = batten.bat_mesh_repair(batten.bat_mesh_weld(base, 0));
  const parts = (decimate ? 1 : 0) + 1 + (against ? 1 : 0);
  let done = 0;
  const part = (fraction) => progress((done + fraction) / parts);
  if (decimate) {
    base = batten.bat_mesh_decimate(base, { ...decimate, progress: part });
    done++;
  }
  const settings = (name) => {
    const { fairness, limit, crease_angle, ...rest } = refine;
    const all = { ...rest, scheme: name, progress: part };
    if (name === "learned") all.fairness = fairness;
    if (["learned", "loop", "catmull-clark"].includes(name)) all.crease_angle = crease_angle;
    if (name !== "sqrt3") all.limit = limit;
    return all;
  };
  const byScheme = (given, name) =>
    name === "catmull-clark"
      ? batten.bat_polygon_mesh_refine(given.offsets ? given : batten.bat_polygon_mesh_of_triangles(given), settings(name))
      : batten.bat_mesh_refine(cut(batten, given), settings(name));
  const automatic = () => (base.offsets ? batten.bat_polygon_mesh_scheme_for(base) : batten.bat_mesh_scheme_for(base));
  const scheme = refine.scheme === "auto" ? automatic() : refine.scheme;
  const fine = byScheme(base, scheme);
  const drawn = cut(batten, fine);
  const triangulated = Boolean(coarse.offsets) && (!base.offsets || scheme !== "catmull-clark");
  done++;
  const result = { base, cage: cut(batten, base), fine, drawn, scheme, triangulated, summary: summarize(batten, fine, drawn), before: summarize(batten, base, cut(batten, base)) };
  if (against && against !== scheme) {
    result.distances = batten.bat_mesh_vertex_distances(drawn, cut(batten, byScheme(base, against)));
    result.against = against;
  }
  return result;
}

export function writeMesh(batten, { mesh, format, encoding }) {
  const write = mesh.offsets ? batten.bat_polygon_mesh_write_memory : batten.bat_mesh_write_memory;
  return write(mesh, { format, encoding });
}

/** Sample the spline through keyframes. */
export function motion(batten, { keys, samples, options }) {
  const [begin, end] = [keys.times[0], keys.times[keys.times.length - 1]];
  const times = Float64Array.from({ length: samples }, (_, i) => (i === samples - 1 ? end : begin + ((end - begin) * i) / (samples - 1)));
  return { times, ...batten.bat_motion_spline_sample(keys, times, options) };
}

export function motionFile(batten, { bytes, read, options, format }) {
  const set = batten.bat_curve_read_memory(bytes, read);
  let fine = null;
  try {
    fine = batten.bat_motion_curves(set, options);
    return batten.bat_curve_write_memory(fine, { format });
  } finally {
    set.free();
    fine?.free();
  }
}

export function analyze(batten, { scheme, level }) {
  const analysis = batten.bat_mask_analyze(scheme);
  let basis = null;
  let refused = null;
  try {
    basis = batten.bat_mask_basis(scheme, level);
  } catch (error) {
    refused = error.text ?? error.message;
  }
  return { analysis, basis, refused };
}

/** The surface or shell that was made last; it stays in the engine for its files. */
let made = null;

/** Triangles of a grid of samples of a surface over the square, and its parameters. */
function gridOf(n) {
  const parameters = new Float64Array(2 * (n + 1) ** 2);
  const faces = new Uint32Array(6 * n * n);
  let at = 0;
  for (let j = 0; j <= n; j++)
    for (let i = 0; i <= n; i++) {
      const k = j * (n + 1) + i;
      parameters.set([i / n, j / n], 2 * k);
      if (i < n && j < n) {
        faces.set([k, k + 1, k + n + 2, k, k + n + 2, k + n + 1], at);
        at += 6;
      }
    }
  return { parameters, faces };
}

/** Of places the values of the nearest points, by a grid of cells. */
function nearestValues(places, points, values, spacing) {
  const cells = new Map();
  const side = spacing * 2 || 1;
  const key = (x, y, z) => `${x},${y},${z}`;
  const cell = (value) => Math.floor(value / side);
  for (let i = 0; i < points.length; i += 3) {
    const name = key(cell(points[i]), cell(points[i + 1]), cell(points[i + 2]));
    if (!cells.has(name)) cells.set(name, []);
    cells.get(name).push(i);
  }
  const most = 4 * side;
  return Float64Array.from({ length: places.length / 3 }, (_, k) => {
    const [x, y, z] = places.subarray(3 * k, 3 * k + 3);
    let best = most * most;
    let value = 0;
    for (let r = 0; r <= 4 && best > ((r - 1) * side) ** 2 * (r > 1); r++)
      for (let a = -r; a <= r; a++)
        for (let b = -r; b <= r; b++)
          for (let c = -r; c <= r; c++) {
            if (Math.max(Math.abs(a), Math.abs(b), Math.abs(c)) !== r) continue;
            for (const i of cells.get(key(cell(x) + a, cell(y) + b, cell(z) + c)) ?? []) {
              const distance = (points[i] - x) ** 2 + (points[i + 1] - y) ** 2 + (points[i + 2] - z) ** 2;
              if (distance < best) [best, value] = [distance, values[i / 3]];
            }
          }
    return value;
  });
}

/** Fit a surface to the points of a file: a patch, or a trimmed patch or a shell where the points need one. */
export function scan(batten, { bytes, format, kind, parameters, tolerance, robust, force }, progress) {
  const cloud = batten.bat_cloud_read(bytes, format ? { format } : {});
  const { points } = cloud;
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  points.forEach((value, i) => {
    low[i % 3] = Math.min(low[i % 3], value);
    high[i % 3] = Math.max(high[i % 3], value);
  });
  const near = (tolerance / 1000) * Math.hypot(...high.map((value, i) => value - low[i]));
  const began = performance.now();
  const patch = (trim) => batten.bat_surface_reconstruct(cloud, { ...(trim ? { trim } : { parameters }), tolerance: near, robust, force, progress });
  const shell = () => batten.bat_shell_reconstruct(cloud, { tolerance: near, force, progress });
  let next;
  let found = kind === "auto" ? "patch" : kind;
  const make = () => (found === "shell" ? shell() : patch(found === "trim"));
  try {
    next = make();
  } catch (error) {
    if (kind !== "auto" || !["shell", "trim"].includes(error.remedy)) throw error;
    found = error.remedy;
    next = make();
  }
  const seconds = (performance.now() - began) / 1000;
  made?.free();
  made = next;
  let mesh;
  if (found === "shell") mesh = cut(batten, batten.bat_shell_tessellate(made, Math.max(2, Math.round(160 / Math.sqrt(made.face_count * made.spans ** 2)))));
  else if (found === "trim") mesh = batten.bat_mesh_read_memory(batten.bat_surface_write(made, { format: "obj" }), { format: "obj" });
  else {
    const grid = gridOf(120);
    mesh = { positions: batten.bat_spline_surface_evaluate(made, grid.parameters), faces: grid.faces };
  }
  const distances = found === "shell" ? null : nearestValues(mesh.positions, made.points, made.distances, made.verdict.spacing);
  const { handle, control, patches, points: ordered, parameters: places, distances: residuals, ...report } = made;
  return { kind: found, points, mesh: { positions: mesh.positions, faces: mesh.faces }, distances, report, seconds, tolerance: near };
}

export function writeScan(batten, { format }) {
  if (made === null) throw new Error("there is no surface yet");
  return made.face_count === undefined ? batten.bat_surface_write(made, { format }) : batten.bat_shell_write(made, { format });
}
