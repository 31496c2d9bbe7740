// The library as JavaScript functions with the names of the C functions. Arrays go into the memory of the WebAssembly module
// and results are copied out of it, so that no result changes or has to be released.

/** A failure of the library: `status` is the name of the C status, `index` and `line` tell the place where there is one,
 * `option` the option at fault, and `remedy` the one that leads out. */
export class BattenError extends Error {
  constructor(failure) {
    super(failure.remedy ? `${failure.text}; the option ${failure.remedy} ${failure.effect}` : failure.text);
    this.name = "BattenError";
    this.status = failure.name;
    this.index = failure.index ?? null;
    this.line = failure.line || null;
    this.option = failure.option || null;
    this.remedy = failure.remedy || null;
    this.text = failure.text; // without the remedy, for pages that name it by a control
    this.effect = failure.effect;
  }
}

const ARRAYS = { f64: Float64Array, u32: Uint32Array, u8: Uint8Array };
const NOT_FINITE = { Infinity, "-Infinity": -Infinity, NaN };

const refused = (text) => new BattenError({ name: "invalid argument", text });
/** Options as JSON; numbers that are not finite have the mark of reports. */
const asJson = (settings) =>
  JSON.stringify(settings, (key, value) => {
    if (typeof value === "number" && !Number.isFinite(value)) return { "": String(value) };
    if (["function", "symbol", "bigint"].includes(typeof value)) throw refused(`${key} must not be a ${typeof value}`);
    return value;
  });

/** What stays inside the module until it is freed. */
class Kept {
  #release;
  constructor(handle, report, release) {
    Object.assign(this, report);
    this.handle = handle;
    this.#release = release;
  }
  /** Give the memory back; the arrays that were copied out stay. */
  free() {
    if (this.handle !== 0) this.#release();
    this.handle = 0;
  }
}
/** Curves, with what their file tells beside them: properties of features, names of columns. */
export class CurveSet extends Kept {}
/** A spline surface with the report of its fit. */
export class Surface extends Kept {}
/** A surface of any shape, of patches, with the report of its fit. */
export class Shell extends Kept {}
const KEPT = { bat_surface_reconstruct: Surface, bat_shell_reconstruct: Shell, bat_shell_reconstruct_mesh: Shell };
/** What a longjmp throws: errors of Qhull return to its caller by one. */
const LONG_JUMP = Symbol("longjmp");
const NO_SYSTEM = -52; // ENOSYS

/** Make the functions of a compiled module. */
export async function instantiate(source) {
  const module = source instanceof WebAssembly.Module ? source : await WebAssembly.compile(source);
  let memory;
  let onProgress = null;
  const encoder = new TextEncoder();
  const decoder = new TextDecoder();
  const bytes = (address, size) => new Uint8Array(memory.buffer, address, size);
  const imports = { env: {}, wasi_snapshot_preview1: {} };
  let high = 0; // the upper half of the last result of 64 bits
  for (const { module: space, name, kind } of WebAssembly.Module.imports(module)) {
    if (kind !== "function") continue;
    let call = name.startsWith("__syscall_") ? () => NO_SYSTEM : () => 0;
    if (name.startsWith("invoke_"))
      call = (index, ...args) => {
        const stack = exports.stackSave();
        try {
          return exports.__indirect_function_table.get(index)(...args);
        } catch (error) {
          exports.stackRestore(stack);
          if (error !== LONG_JUMP) throw error;
          exports.setThrew(1, 0);
          return 0;
        }
      };
    else if (name.endsWith("longjmp"))
      call = () => {
        throw LONG_JUMP;
      };
    (imports[space] ??= {})[name] = call;
  }
  imports.env.engine_progress = (fraction) => (onProgress === null || onProgress(fraction) !== false ? 1 : 0);
  imports.env.setTempRet0 = (value) => (high = value);
  imports.env.getTempRet0 = () => high;
  // Standard input is the file of a call, standard output its result.
  let input = new Uint8Array();
  let output = [];
  const parts = (vectors, count) => {
    const words = new Uint32Array(memory.buffer, vectors, 2 * count);
    return Array.from({ length: count }, (_, i) => bytes(words[2 * i], words[2 * i + 1]));
  };
  const count = (address, value) => {
    new Uint32Array(memory.buffer, address, 1)[0] = value;
    return 0;
  };
  imports.wasi_snapshot_preview1.fd_read = (file, vectors, number, read) => {
    let size = 0;
    for (const part of parts(vectors, number)) {
      const taken = input.subarray(0, part.length);
      part.set(taken);
      input = input.subarray(taken.length);
      size += taken.length;
    }
    return count(read, size);
  };
  imports.wasi_snapshot_preview1.fd_write = (file, vectors, number, written) => {
    const all = parts(vectors, number);
    if (file === 1) output.push(...all.map((part) => part.slice()));
    return count(written, all.reduce((size, part) => size + part.length, 0));
  };
  const { exports } = await WebAssembly.instantiate(module, imports);
  memory = exports.memory;
  exports._initialize?.();

  const text = (address) => {
    const all = new Uint8Array(memory.buffer);
    return decoder.decode(all.subarray(address, all.indexOf(0, address)));
  };
  const allocate = (size) => {
    const address = exports.engine_allocate(size);
    if (address === 0) throw new BattenError({ name: "out of memory", text: `no memory for ${size} bytes` });
    return address >>> 0;
  };
  const put = (array) => {
    const address = allocate(array.byteLength);
    bytes(address, array.byteLength).set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
    return address;
  };
  const putText = (string) => put(encoder.encode(`${string}\0`));
  const takeText = (address) => {
    const string = text(address);
    exports.engine_release(address);
    return string;
  };
  const fail = () => {
    throw new BattenError(JSON.parse(takeText(exports.engine_failure())));
  };
  // Reports have keys of their own and texts of files as values: no file makes an object with the key "".
  const parse = (string) =>
    JSON.parse(string, (key, value) => {
      if (typeof value !== "object" || value === null || Array.isArray(value) || !("" in value)) return value;
      if (typeof value[""] === "string") return NOT_FINITE[value[""]];
      const [type, address, length] = value[""];
      const Type = ARRAYS[type];
      return length > 0 ? new Type(memory.buffer, address, length).slice() : new Type();
    });
  const read = (handle) => parse(text(exports.engine_report(handle)));

  /** Numbers in a flat array of a type; `good` tells the numbers that it holds. */
  const asNumbers = (values, Type, good, what) => {
    if (values instanceof Type) return values;
    if (!Array.isArray(values) && !(ArrayBuffer.isView(values) && !(values instanceof DataView)))
      throw refused(`${what} must be an array or a typed array`);
    const flat = Array.isArray(values) ? values.flatMap((row) => (ArrayBuffer.isView(row) ? Array.from(row) : [row].flat(Infinity))) : values;
    for (const value of flat) if (typeof value !== "number" || !good(value)) throw refused(`${what} must not hold ${String(value)}`);
    return Type.from(flat);
  };
  const asDoubles = (values, what = "numbers") => asNumbers(values, Float64Array, () => true, what);
  const asIndices = (values, what = "indices") =>
    asNumbers(values, Uint32Array, (value) => Number.isInteger(value) && value >= 0 && value < 2 ** 32, what);

  /** Handles of inputs, with what to release after the call. */
  function curvesOf(input, temporary) {
    if (input instanceof CurveSet) {
      if (input.handle === 0) throw new BattenError({ name: "invalid argument", text: "the curves were freed" });
      return input.handle;
    }
    const list = Array.isArray(input) ? Array.from(input) : [input];
    if (list.length === 0) throw refused("there are no curves");
    if (list.some((curve) => typeof curve !== "object" || curve === null)) throw refused("a curve must be an object with points");
    const arrays = list.map((curve) => asDoubles(curve.points, "points"));
    const first = list[0];
    const { space = "plane", point_dim = 0 } = first;
    if (typeof space !== "string") throw refused("space must be a text");
    if (!Number.isInteger(point_dim) || point_dim < 0) throw refused("point_dim must be a whole number");
    const dim = pointDim(space, point_dim || (first.points[0]?.length ?? 0));
    const counts = arrays.map((points) => {
      if (points.length % dim !== 0)
        throw new BattenError({ name: "invalid argument", text: `${points.length} numbers are no points of ${dim} each` });
      return points.length / dim;
    });
    const channelled = list.every((curve) => curve.channels != null);
    const cornered = list.some((curve) => curve.corners != null);
    const channels = channelled ? list.map((curve) => asDoubles(curve.channels, "channels")) : [];
    const layout = {
      space,
      point_dim: dim,
      counts,
      closed: list.map((curve) => Boolean(curve.closed)),
      channel_count: channelled ? channels[0].length / counts[0] : 0,
    };
    channels.forEach((values, i) => {
      if (!Number.isInteger(layout.channel_count) || values.length !== layout.channel_count * counts[i])
        throw new BattenError({ name: "invalid argument", text: "channels need as many numbers for each point" });
    });
    const flags = list.map(({ corners }, i) => {
      const row = corners == null ? [] : asNumbers(corners, Uint8Array, Number.isFinite, "corners");
      if (corners != null && row.length !== counts[i]) throw refused("corners need a flag for each point");
      return Uint8Array.from({ length: counts[i] }, (_, k) => (row[k] ? 1 : 0));
    });
    const joined = (parts, Type) => {
      const all = new Type(parts.reduce((sum, part) => sum + part.length, 0));
      let at = 0;
      for (const part of parts) {
        all.set(part, at);
        at += part.length;
      }
      return all;
    };
    const addresses = [putText(asJson(layout)), put(joined(arrays, Float64Array))];
    addresses.push(channelled ? put(joined(channels, Float64Array)) : 0);
    addresses.push(cornered ? put(joined(flags, Uint8Array)) : 0);
    const handle = exports.engine_curves(...addresses);
    addresses.forEach((address) => exports.engine_release(address));
    if (handle === 0) fail();
    temporary.push(handle);
    return handle;
  }

  /** The coordinates of a point of a space; `wanted` where the space has any number of them. */
  function pointDim(space, wanted) {
    const known = { __proto__: null, plane: 2, sphere: 3, disk: 2, rotation: 4, rigid: 7 };
    if (space !== "sphere" && known[space]) return known[space];
    return wanted || { __proto__: null, sphere: 3, euclidean: 3, spd: 6, hyperbolic: 3 }[space] || 1;
  }

  const isRow = (row) => Array.isArray(row) || ArrayBuffer.isView(row);
  /** The offsets of polygons that are rows of corners. */
  function offsetsOf(rows) {
    if (!Array.isArray(rows) || rows.length === 0 || !rows.every(isRow)) throw refused("polygons need rows of corners, or offsets");
    const offsets = new Uint32Array(rows.length + 1);
    rows.forEach((row, i) => (offsets[i + 1] = offsets[i] + row.length));
    return offsets;
  }

  /** `polygons`: the operation takes a mesh of polygons. Without offsets rows of corners have three each elsewhere. */
  function meshOf(mesh, temporary, polygons = false) {
    if (typeof mesh !== "object" || mesh === null) throw refused("a mesh must be an object with positions and faces");
    for (const name of ["channel_names", "creases", "corners", "labels"])
      if (mesh[name] != null && !Array.isArray(mesh[name])) throw refused(`${name} must be an array`);
    const texts = [...(mesh.channel_names ?? []), ...(mesh.labels ?? []).flatMap((label) => Object.values(label ?? {}))];
    if (texts.some((text) => text != null && typeof text !== "string")) throw refused("channel_names and labels must hold texts");
    for (const name of ["material_files", "material_json"])
      if (mesh[name] != null && typeof mesh[name] !== "string") throw refused(`${name} must be a text`);
    const array = (name, convert, values = mesh[name]) => {
      const numbers = values == null ? [] : convert(values, name);
      return numbers.length > 0 ? [put(numbers), numbers.length] : undefined;
    };
    // Rows of vertices and a sharpness; JSON has no infinity.
    const sharp = (name, vertices) =>
      mesh[name]?.map((row) => {
        if (!isRow(row) || row.length !== vertices + 1 || typeof row[vertices] !== "number" || !(row[vertices] >= 0)) throw refused(`${name} must hold rows of ${vertices} vertices and a sharpness`);
        return [...asIndices(row.slice(0, vertices), name), Math.min(row[vertices], Number.MAX_VALUE)];
      });
    const { channel_names, labels, material_files, material_json, rules } = mesh;
    const triangles = mesh.offsets == null && (!isRow(mesh.faces?.[0]) || mesh.faces.every((row) => row?.length === 3));
    const offsets = mesh.offsets ?? (polygons || !triangles ? offsetsOf(mesh.faces) : null);
    // The module takes the arrays.
    const layout = putText(
      asJson({
        positions: array("positions", asDoubles),
        faces: array("faces", asIndices),
        offsets: array("offsets", asIndices, offsets),
        texture: array("texture", asDoubles),
        texture_faces: array("texture_faces", asIndices),
        channels: array("channels", asDoubles),
        face_labels: array("face_labels", asIndices),
        creases: sharp("creases", 2),
        corners: sharp("corners", 1),
        channel_names, labels, material_files, material_json, rules,
      }),
    );
    const handle = exports.engine_mesh(layout);
    exports.engine_release(layout);
    if (handle === 0) fail();
    temporary.push(handle);
    return handle;
  }

  /** A cloud: points alone, or an object with the fields of bat_cloud. */
  function cloudOf(cloud, temporary) {
    if (typeof cloud !== "object" || cloud === null) throw refused("a cloud must be points, or an object with points");
    const { points, triangles, boundary_count = 0, corners = null } = Array.isArray(cloud) || ArrayBuffer.isView(cloud) ? { points: cloud } : cloud;
    if (!Number.isInteger(boundary_count) || boundary_count < 0) throw refused("boundary_count must be a whole number");
    const place = (numbers) => (numbers.length > 0 ? [put(numbers), numbers.length] : undefined);
    const layout = putText(
      JSON.stringify({
        points: place(asDoubles(points, "points")),
        triangles: triangles == null ? undefined : place(asIndices(triangles, "triangles")),
        boundary_count,
        corners: corners === null ? undefined : Array.from(asIndices(corners, "corners")),
      }),
    );
    const handle = exports.engine_cloud(layout);
    exports.engine_release(layout);
    if (handle === 0) fail();
    temporary.push(handle);
    return handle;
  }

  /** What a call takes that stays in the module. */
  const kept = (object, Type, what) => () => {
    if (!(object instanceof Type)) throw refused(`${what} is needed`);
    if (object.handle === 0) throw refused(`${what} was freed`);
    return object.handle;
  };

  /** Run an operation. `keep` leaves the result in the module; `file` gives what it wrote to standard output. */
  function run(name, inputs, options, { data = null, keep = false, file = false } = {}) {
    const temporary = [];
    const addresses = [];
    if (options != null && (typeof options !== "object" || Array.isArray(options))) throw refused("options must be an object");
    const { progress = null, ...settings } = options ?? {};
    if (progress !== null && typeof progress !== "function") throw refused("progress must be a function");
    const previous = onProgress;
    onProgress = progress;
    input = data === null ? new Uint8Array() : data;
    if (file) exports.engine_flush(); // what a failed call left
    output = [];
    try {
      const handles = inputs.map((input) => input(temporary));
      addresses.push(putText(name), putText(asJson(settings)), data === null ? 0 : put(data));
      const result = exports.engine_run(
        addresses[0], addresses[1], handles[0] ?? 0, handles[1] ?? 0, addresses[2], data === null ? 0 : data.byteLength,
      );
      if (result === 0) fail();
      if (!keep) temporary.push(result);
      if (file) {
        exports.engine_flush();
        return joinedBytes(output);
      }
      const report = read(result);
      if (!keep) return report;
      return new (KEPT[name] ?? CurveSet)(result, report, () => exports.engine_free(result));
    } finally {
      onProgress = previous;
      output = [];
      temporary.forEach((handle) => exports.engine_free(handle));
      addresses.forEach((address) => exports.engine_release(address));
    }
  }

  const curves = (input) => (temporary) => curvesOf(input, temporary);
  const mesh = (input) => (temporary) => meshOf(input, temporary);
  const polygons = (input) => (temporary) => meshOf(input, temporary, true);
  const cloud = (any) => (temporary) => cloudOf(any, temporary);
  const joinedBytes = (pieces) => {
    const all = new Uint8Array(pieces.reduce((size, piece) => size + piece.length, 0));
    let at = 0;
    for (const piece of pieces) {
      all.set(piece, at);
      at += piece.length;
    }
    return all;
  };
  const asBytes = (data) => {
    if (typeof data === "string") return encoder.encode(data);
    if (!ArrayBuffer.isView(data) && !(data instanceof ArrayBuffer)) throw refused("a file must be a text, a typed array or an ArrayBuffer");
    return new Uint8Array(data.buffer ?? data, data.byteOffset ?? 0, data.byteLength);
  };
  /** The curves of a result, one for one curve, each with the space of all. */
  const plain = (result, single) => {
    const list = result.curves.map((curve) => ({ space: result.space, point_dim: result.point_dim, ...curve }));
    return single ? Object.assign(list[0], { report: result.report }) : Object.assign(list, { report: result.report });
  };
  const refined = (name) => (coarse, options) => {
    if (coarse instanceof CurveSet) return run(name, [curves(coarse)], options, { keep: true });
    return plain(run(name, [curves(coarse)], options), !Array.isArray(coarse));
  };
  const first = (name, field) => (curve) => run(name, [curves(curve)])[field];

  let families = null;
  const api = {
    /** The options of each call and the names of measures, for the declarations of types. */
    signatures: () => JSON.parse(takeText(exports.engine_signatures())),
    bat_version: () => text(exports.engine_version()),
    bat_choices: (family) => {
      families ??= JSON.parse(takeText(exports.engine_families()));
      if (family !== undefined && !(typeof family === "string" && Object.hasOwn(families, family)))
        throw refused(`no family '${typeof family === "string" ? family : typeof family}'; there are ${Object.keys(families).join(", ")}`);
      return structuredClone(family === undefined ? families : families[family]);
    },
    bat_curve_refine: refined("bat_curve_refine"),
    bat_curve_map_refine: refined("bat_curve_map_refine"),
    bat_curve_read_memory: (data, options) =>
      run("bat_curve_read_memory", [], options, { data: asBytes(data), keep: true }),
    bat_curve_write_memory: (set, options) => run("bat_curve_write_memory", [curves(set)], options).bytes,
    bat_curve_fairness: (curve, options) => {
      const rows = run("bat_curve_fairness", [curves(curve)], options).fairness;
      return Array.isArray(curve) || curve instanceof CurveSet ? rows : rows[0];
    },
    bat_curve_is_simple: (curve) => {
      const rows = first("bat_curve_is_simple", "simple")(curve);
      return Array.isArray(curve) || curve instanceof CurveSet ? rows : rows[0];
    },
    bat_curve_exterior_angles: first("bat_curve_exterior_angles", "values"),
    bat_curve_edge_lengths: first("bat_curve_edge_lengths", "values"),
    bat_curve_compare: (a, b, options) => run("bat_curve_compare", [curves(a), curves(b)], options),
    bat_mask_analyze: (scheme, options) => run("bat_mask_analyze", [], { ...options, scheme }),
    bat_mask_basis: (scheme, level) => run("bat_mask_basis", [], { scheme, ...(level === undefined ? {} : { level }) }),
    bat_motion_curves: (set, options) => {
      if (set instanceof CurveSet) return run("bat_motion_curves", [curves(set)], options, { keep: true });
      return plain(run("bat_motion_curves", [curves(set)], options), !Array.isArray(set));
    },
    bat_motion_spline_sample: (given, at, options) => {
      const { times, ...keys } = given ?? {};
      return run("bat_motion_spline_sample", [curves(times ? { ...keys, channels: times } : keys)], options, { data: asDoubles(at) });
    },
    bat_mesh_refine: (coarse, options) => run("bat_mesh_refine", [mesh(coarse)], options),
    bat_mesh_scheme_for: (coarse) => run("bat_mesh_scheme_for", [mesh(coarse)]).scheme,
    bat_mesh_limit_normals: (refinedMesh) => run("bat_mesh_limit_normals", [mesh(refinedMesh)]).values,
    bat_mesh_decimate: (fine, options) => run("bat_mesh_decimate", [mesh(fine)], options),
    bat_mesh_repair: (broken) => run("bat_mesh_repair", [mesh(broken)]),
    bat_mesh_weld: (soup, distance = 0) => run("bat_mesh_weld", [mesh(soup)], { distance }),
    bat_mesh_read_memory: (data, options) => run("bat_mesh_read_memory", [], options, { data: asBytes(data) }),
    bat_mesh_write_memory: (any, options) => run("bat_mesh_write_memory", [mesh(any)], options).bytes,
    bat_mesh_summarize: (any) => run("bat_mesh_summarize", [mesh(any)]),
    bat_mesh_compare: (a, b, options) => run("bat_mesh_compare", [mesh(a), mesh(b)], options),
    bat_polygon_mesh_refine: (coarse, options) => run("bat_polygon_mesh_refine", [polygons(coarse)], options),
    bat_polygon_mesh_scheme_for: (coarse) => run("bat_polygon_mesh_scheme_for", [polygons(coarse)]).scheme,
    bat_polygon_mesh_limit_normals: (refinedMesh) => run("bat_polygon_mesh_limit_normals", [polygons(refinedMesh)]).values,
    bat_polygon_mesh_triangulate: (any) => run("bat_polygon_mesh_triangulate", [polygons(any)]),
    bat_polygon_mesh_of_triangles: (any) => run("bat_polygon_mesh_of_triangles", [mesh(any)]),
    bat_polygon_mesh_read_memory: (data, options) => run("bat_polygon_mesh_read_memory", [], options, { data: asBytes(data) }),
    bat_polygon_mesh_write_memory: (any, options) => run("bat_polygon_mesh_write_memory", [polygons(any)], options).bytes,
    bat_mesh_vertex_distances: (from, onto) => run("bat_mesh_vertex_distances", [mesh(from), mesh(onto)]).values,
    bat_cloud_read: (data, options) => run("bat_cloud_read", [], options, { data: asBytes(data) }),
    bat_cloud_noise: (points) => run("bat_cloud_noise", [cloud(points)]).noise,
    bat_surface_reconstruct: (points, options) => run("bat_surface_reconstruct", [cloud(points)], options, { keep: true }),
    bat_spline_surface_evaluate: (surface, parameters, derivatives = 0) =>
      run("bat_spline_surface_evaluate", [kept(surface, Surface, "a surface")], { derivatives }, { data: asDoubles(parameters, "parameters") }).values,
    bat_surface_write: (surface, options) => run("bat_surface_write", [kept(surface, Surface, "a surface")], options, { file: true }),
    bat_shell_reconstruct: (given, options) =>
      given?.positions !== undefined
        ? run("bat_shell_reconstruct_mesh", [mesh(given)], options, { keep: true })
        : run("bat_shell_reconstruct", [cloud(given)], options, { keep: true }),
    bat_shell_tessellate: (shell, samples = 4) => run("bat_shell_tessellate", [kept(shell, Shell, "a shell")], { samples }),
    bat_shell_write: (shell, options) => run("bat_shell_write", [kept(shell, Shell, "a shell")], options, { file: true }),
  };
  return api;
}
