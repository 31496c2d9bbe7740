// Meshes: refined by a scheme, decimated, and compared with another scheme, in three dimensions.
import { Vector3 } from "three";
import { check, color, digits, download, endings, enumerator, group, h, notes, opener, select, slider, table } from "./dom.js";
import { divider, scene3d } from "./scene.js";

/** Meshes made by a formula, as [positions, faces]. */
const grid = (rows, columns, at) => {
  const positions = [];
  const faces = [];
  for (let i = 0; i < rows; i++)
    for (let j = 0; j < columns; j++) {
      positions.push(...at((2 * Math.PI * i) / rows, (2 * Math.PI * j) / columns));
      const id = (a, b) => ((a % rows) * columns) + (b % columns);
      const [p, q, r, s] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
      faces.push(p, q, r, p, r, s);
    }
  return { positions: Float64Array.from(positions), faces: Uint32Array.from(faces) };
};
const polyhedron = (vertices, faces) => ({ positions: Float64Array.from(vertices.flat()), faces: Uint32Array.from(faces.flat()) });
const CUBE = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7]];
function icosahedron() {
  const t = (1 + Math.sqrt(5)) / 2;
  const v = [[-1, t, 0], [1, t, 0], [-1, -t, 0], [1, -t, 0], [0, -1, t], [0, 1, t], [0, -1, -t], [0, 1, -t], [t, 0, -1], [t, 0, 1], [-t, 0, -1], [-t, 0, 1]];
  return polyhedron(v, [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]]);
}
function bracket() {
  // An L with thickness: its edges are creases by angle.
  const outline = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]];
  const triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
  const vertices = [...outline.map(([x, y]) => [x, y, 0]), ...outline.map(([x, y]) => [x, y, 1])];
  const faces = [...triangles.map(([a, b, c]) => [a, c, b]), ...triangles.map((f) => f.map((i) => i + 6))];
  outline.forEach((_, i) => {
    const j = (i + 1) % 6;
    faces.push([i, j, j + 6], [i, j + 6, i + 6]);
  });
  return polyhedron(vertices, faces);
}
function solid() {
  // The bracket's outlines as polygons of six corners, with quads between them: a control cage.
  const { positions } = bracket();
  const sides = Array.from({ length: 6 }, (_, i) => [i, (i + 1) % 6, ((i + 1) % 6) + 6, i + 6]);
  const faces = [[5, 4, 3, 2, 1, 0], [6, 7, 8, 9, 10, 11], ...sides];
  const offsets = new Uint32Array(faces.length + 1);
  faces.forEach((face, i) => (offsets[i + 1] = offsets[i] + face.length));
  return { positions, faces: Uint32Array.from(faces.flat()), offsets };
}
const EXAMPLES = {
  knot: ["Knotted tube, 480 vertices", () => grid(60, 8, (s, t) => {
    const r = 2 + Math.cos(3 * s);
    const c = [r * Math.cos(2 * s), r * Math.sin(2 * s), 1.2 * Math.sin(3 * s)];
    const dr = -3 * Math.sin(3 * s);
    const d = [dr * Math.cos(2 * s) - 2 * r * Math.sin(2 * s), dr * Math.sin(2 * s) + 2 * r * Math.cos(2 * s), 3.6 * Math.cos(3 * s)];
    const T = new Vector3(...d).normalize();
    const U = new Vector3(0, 0, 1).cross(T).normalize();
    const V = U.clone().cross(T);
    return c.map((value, i) => value + 0.55 * (Math.cos(t) * U.getComponent(i) + Math.sin(t) * V.getComponent(i)));
  })],
  torus: ["Torus, 72 vertices", () => grid(12, 6, (s, t) => [(2 + 0.8 * Math.cos(t)) * Math.cos(s), (2 + 0.8 * Math.cos(t)) * Math.sin(s), 0.8 * Math.sin(t)])],
  cube: ["Cube", () => polyhedron([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], CUBE)],
  icosahedron: ["Icosahedron", icosahedron],
  bracket: ["Bracket with creases", bracket],
  polygons: ["Bracket of polygons", solid],
};

/** The controls of options that lead out of failures. */
const CONTROLS = { repair: "Weld and repair first", scheme: "Scheme", levels: "Levels" };
/** Decimation: nothing where `keep` is 100 and `within` is 0. */
const FIRST = { example: "knot", data: 0, scheme: "auto", fairness: 0.25, levels: 2, limit: false, crease: 0, keep: 100, within: 0, against: "", wires: false, flat: false, repair: false };
/** Which schemes have an option. */
const CREASED = ["auto", "learned", "loop", "catmull-clark"];
const LIMITED = (name) => name !== "sqrt3";

export function meshTab(app, section) {
  let state = structuredClone(FIRST);
  let coarse = EXAMPLES.knot[1]();
  let file = "mesh.obj";
  let result = null;
  let started = false;
  let wanted = null; // the state that undo or a link asks for, until its file is read
  const schemes = app.tables.lists.mesh_scheme;
  const stage = h("div.stage", { tabIndex: 0, role: "group", "aria-label": "The mesh; drag to turn, arrow keys turn too" });
  const legend = h("div.legend", {}, "");
  const facts = h("div", {});

  stage.append(legend);
  const scene = scene3d(stage, section);
  const split = divider(stage, () => scene.redraw());
  const redraw = () => scene.redraw();

  /** Options of decimation; null for none. */
  const decimation = () => (state.within > 0 ? { tolerance: state.within / 100, relative_tolerance: true } : state.keep < 100 ? { ratio: state.keep / 100 } : null);
  async function compute() {
    wanted = null;
    const refine = { scheme: state.scheme, levels: state.levels, fairness: state.fairness, limit: state.limit, crease_angle: (state.crease * Math.PI) / 180 };
    try {
      result = await app.engine.latest("mesh", "mesh", { coarse, decimate: decimation(), refine, against: state.against, repair: state.repair }, "Refining the mesh");
      app.clear();
      build();
      if (app.opening) split.sweep();
      app.opening = false;
      figures();
      return true;
    } catch (error) {
      app.fail(error, state.example ? undefined : file, CONTROLS);
      return error.message === "superseded" ? null : false;
    }
  }

  function build() {
    const { drawn, base, cage, before, summary, distances } = result;
    const low = summary.low.map((value, i) => Math.min(value, before.low[i]));
    const high = summary.high.map((value, i) => Math.max(value, before.high[i]));
    const most = scene.show({ low, high, mesh: drawn, values: distances, flat: state.flat, before: cage, wired: base, wires: state.wires, split: () => split.share });
    legend.textContent = distances ? `distance from ${result.against}: dark 0, yellow ${digits(most, 3)}` : "left: the coarse mesh; right: the fine one";
  }
  function figures() {
    const { before, summary, fine } = result;
    facts.replaceChildren(
      table(["", "coarse", "fine"], [
        ["vertices", digits(before.vertices), digits(summary.vertices)],
        ["faces", digits(before.faces), digits(summary.faces)],
        ["boundary loops", digits(before.boundary_loops), digits(summary.boundary_loops)],
        ["genus", before.genus < 0 ? "–" : digits(before.genus), summary.genus < 0 ? "–" : digits(summary.genus)],
        ["area", digits(before.area), digits(summary.area)],
        ["volume", digits(before.volume), digits(summary.volume)],
        ["scheme", "", result.scheme],
        ["mean quality of triangles", digits(before.mean_quality, 3), digits(summary.mean_quality, 3)],
      ]),
      ...notes(coarse.notes),
      ...(result.base.distance === undefined ? [] : [h("p.hint", {}, `Decimated by at most ${digits(result.base.distance, 3)}, proven.`)]),
      ...(result.triangulated ? [h("p.hint", {}, "The polygons were cut into triangles; catmull-clark refines them as they are.")] : []),
      ...(fine.fallback ? [h("p.hint", {}, `${fine.fallback} places fell back to a classical rule.`)] : []),
    );
  }
  const change = async (changes) => {
    const last = { coarse, file, state: structuredClone(state) };
    Object.assign(state, changes);
    controls();
    const done = await compute();
    if (done) app.commit();
    else if (done === false && !changes.example) restoreLast(last);
  };
  const example = select("Example", [["", "choose …"], ...Object.entries(EXAMPLES).map(([name, [title]]) => [name, title])], "knot", (name) => {
    if (!name) return;
    coarse = EXAMPLES[name][1]();
    void change({ example: name, data: 0, ...(name === "bracket" ? { crease: 40 } : {}), keep: 100, within: 0 });
  });
  const scheme = select(CONTROLS.scheme, schemes.map(({ name }) => [name]), state.scheme, (value) => change({ scheme: value }));
  const against = select("Colour by distance from", [["", "nothing"], ...schemes.map(({ name }) => [name])], "", (value) => change({ against: value }));
  const levels = slider(CONTROLS.levels, { min: 0, max: 5, step: 1, value: state.levels, change: () => {}, commit: () => change({ levels: Number(levels.input.value) }) });
  const fairness = slider("Fairness of learned", { min: 0, max: 1, step: 0.05, value: state.fairness, format: (value) => value.toFixed(2), change: () => {}, commit: () => change({ fairness: Number(fairness.input.value) }) });
  const crease = slider("Creases above", { min: 0, max: 120, step: 5, value: 0, format: (value) => (value ? `${value}°` : "none"), change: () => {}, commit: () => change({ crease: Number(crease.input.value) }) });
  const keep = slider("Decimate first to", { min: 2, max: 100, step: 1, value: 100, format: (value) => `${value} % of the faces`, change: () => {}, commit: () => change({ keep: Number(keep.input.value), within: 0 }) });
  const within = slider("Decimate first within", { min: 0, max: 5, step: 0.1, value: 0, format: (value) => (value ? `${value} % of the diagonal` : "no distance"), change: () => {}, commit: () => change({ within: Number(within.input.value), keep: 100 }) });
  const limit = check("On the limit surface", false, (value) => change({ limit: value }));
  const wires = check("Wires of the coarse mesh", false, (value) => change({ wires: value }));
  const flat = check("Flat normals", false, (value) => change({ flat: value }));
  const repair = check(CONTROLS.repair, false, (value) => change({ repair: value }));
  function controls() {
    example.set(state.example);
    scheme.set(state.scheme);
    against.set(state.against);
    levels.set(state.levels);
    crease.set(state.crease);
    crease.input.disabled = !CREASED.includes(state.scheme);
    fairness.set(state.fairness);
    fairness.input.disabled = !["auto", "learned"].includes(state.scheme);
    limit.box.disabled = !LIMITED(state.scheme);
    keep.set(state.keep);
    within.set(state.within);
    limit.set(state.limit);
    wires.set(state.wires);
    flat.set(state.flat);
    repair.set(state.repair);
  }
  async function open(chosen) {
    app.clear();
    let last = null;
    try {
      const bytes = new Uint8Array(await chosen.arrayBuffer());
      const answer = await app.engine.call("readMesh", { bytes, options: {} }, "Reading");
      last = { coarse, file, state: structuredClone(state) };
      coarse = answer.mesh;
      file = chosen.name;
      app.say((coarse.notes ?? []).join("; "));
      Object.assign(state, { example: "", data: 0, keep: 100, within: 0, repair: !answer.summary.manifold || /\.stl$/i.test(file) });
      if (coarse.faces.length / 3 > 60000) state.levels = Math.min(state.levels, 1);
      controls();
      if (await compute()) {
        state.data = app.keep(file, bytes);
        app.commit();
        return true;
      }
      restoreLast(last);
    } catch (error) {
      app.fail(error, chosen.name, CONTROLS);
    }
    return false;
  }
  /** The last good state stays on the screen, in the controls and in the commands. */
  function restoreLast(last) {
    ({ coarse, file, state } = last);
    controls();
  }
  async function save(format) {
    if (!result) return;
    app.clear(true);
    try {
      download(`fine.${format}`, await app.engine.call("writeMesh", { mesh: result.fine, format, encoding: "binary" }, "Writing"));
    } catch (error) {
      app.fail(error);
    }
  }
  section.append(
    h("div.column", {}, stage, group("Figures", facts)),
    h("div.side", {},
      group("Mesh", h("div.row", {}, opener("Open file", endings(app.tables.lists.mesh_format), open), h("button", { type: "button", onclick: () => scene.picture("mesh.png", download) }, "PNG")), example.element, keep.element, within.element, repair.element, h("p.hint", {}, "Drop OBJ, PLY, OFF, STL or glTF. Drag turns, the wheel zooms.")),
      group("Refine", scheme.element, fairness.element, levels.element, crease.element, limit.element, wires.element, flat.element, against.element),
      group("Download", h("div.row", {}, ...["obj", "ply", "off", "stl", "gltf", "glb"].map((format) => h("button", { type: "button", onclick: () => save(format) }, format.toUpperCase())))),
    ),
  );
  controls();
  return {
    open, redraw,
    show() {
      if (!started) {
        started = true;
        void compute();
      }
      redraw();
    },
    state: () => state,
    async restore(next) {
      const mine = (wanted = { ...FIRST, ...next });
      started = true;
      const given = mine.example ? null : app.file(mine.data);
      if (!given && !EXAMPLES[mine.example]) Object.assign(mine, { example: FIRST.example, data: 0 });
      let found = coarse;
      if (EXAMPLES[mine.example]) found = EXAMPLES[mine.example][1]();
      else if (mine.data !== state.data) {
        found = (await app.engine.call("readMesh", { bytes: given.bytes, options: {} }, "Reading")).mesh;
        if (wanted !== mine) return; // a later step of undo, or a change
      }
      // Together: the commands are made of all three.
      [state, coarse, file] = [mine, found, given?.name ?? file];
      controls();
      await compute();
    },
    inspect: () => ({ state, result }),
    commands() {
      const creases = state.crease > 0 && CREASED.includes(state.scheme);
      const fair = state.fairness !== FIRST.fairness && (result?.scheme ?? state.scheme) === "learned";
      const limits = state.limit && LIMITED(state.scheme);
      const input = state.example ? "mesh.obj" : file;
      const less = decimation();
      const { triangulated = false, scheme: made = state.scheme } = result ?? {};
      const quads = made === "catmull-clark"; // the fine mesh has polygons
      const cuts = triangulated ? " --triangulate" : "";
      const repairs = state.repair ? " --repair" : "";
      const target = less && (less.tolerance ? `--tolerance ${Number(less.tolerance.toFixed(4))}%` : `--ratio ${less.ratio}`);
      const shell = [
        ...(less ? [`batten decimate ${input} ${target}${cuts}${repairs} -o coarse.ply`] : []),
        `batten mesh ${less ? "coarse.ply" : input} --scheme ${state.scheme}${fair ? ` --fairness ${state.fairness}` : ""} --levels ${state.levels}${creases ? ` --crease-angle ${state.crease}` : ""}${limits ? " --limit" : ""}${less ? "" : cuts + repairs}${state.against ? ` --beside ${state.against}` : ""} -o fine.obj --picture fine.png`,
      ];

      // Triangles are read and decimated; polygons are read as they are.
      const direct = quads && !less; // polygons from the file on
      const read = triangulated || state.repair || direct ? "&read" : "NULL";
      const c = [
        "bat_mesh coarse, fine;", "bat_error error;",
        ...(read === "NULL" ? [] : ["bat_mesh_read_options read = bat_mesh_read_defaults();"]),
        ...(direct ? ["read.polygons = true;"] : []),
        ...(triangulated ? ["read.triangulate = true;"] : []),
        ...(state.repair ? ["read.repair = true;"] : []),
        `bat_mesh_read("${input}", ${read}, &coarse, &error);`,
        ...(less ? ["bat_mesh_decimate_options less = bat_mesh_decimate_defaults();", ...(less.tolerance ? [`less.tolerance = ${less.tolerance};`, "less.relative_tolerance = true;"] : [`less.ratio = ${less.ratio};`]), "bat_mesh small;", "bat_mesh_decimate(&coarse, &less, &small, NULL, &error);"] : []),
        "bat_mesh_refine_options options = bat_mesh_refine_defaults();",
        `options.scheme = ${enumerator("mesh_scheme", state.scheme)};`, `options.levels = ${state.levels};`,
        ...(fair ? [`options.fairness = ${state.fairness};`] : []),
        ...(creases ? [`options.crease_angle = ${state.crease} * 3.14159265358979 / 180;`] : []),
        ...(limits ? ["options.limit = true;"] : []),
        `if (bat_mesh_refine(&${less ? "small" : "coarse"}, &options, &fine, NULL, &error) != BAT_OK)`, '    fprintf(stderr, "%s\\n", error.text);',
      ];

      const own = direct || triangulated || state.repair; // else any package can read the file
      const reading = [...(triangulated ? [", triangulate=True"] : []), ...(state.repair ? [", repair=True"] : [])].join("");
      const python = [
        "import batten", ...(creases ? ["import math"] : []), ...(own ? [] : ["import trimesh"]), "",
        own ? `mesh = batten.${direct ? "PolygonMesh" : "Mesh"}.read("${input}"${reading})` : `mesh = trimesh.load("${input}")`,
        ...(less ? [`mesh = batten.decimate(mesh, ${less.tolerance ? `tolerance=${less.tolerance}, relative_tolerance=True` : `ratio=${less.ratio}`}, map=False).mesh`] : []),
        `fine = batten.refine_mesh(mesh, scheme="${state.scheme}", levels=${state.levels}${fair ? `, fairness=${state.fairness}` : ""}${creases ? `, crease_angle=math.radians(${state.crease})` : ""}${limits ? ", limit=True" : ""})`,
      ];
      return { shell: shell.join("\n"), c: c.join("\n"), python: python.join("\n") };
    },
  };
}
