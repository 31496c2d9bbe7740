// The engine against the native program, and the package as its users get it.
// Environment: BATTEN, the native program; SOURCE, the folder of the source.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { BattenError, load } from "../npm/index.mjs";

const program = process.env.BATTEN;
const source = process.env.SOURCE;
const data = (name) => join(source, "examples/data", name);
let folder;
let batten;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "batten-web-"));
  batten = await load();
});
after(() => rmSync(folder, { recursive: true, force: true }));

const native = (...command) => execFileSync(program, command, { encoding: "utf8", maxBuffer: 1 << 28 });
/** The numbers of a text, in their order. */
const numbers = (text) => text.match(/[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?/g).map(Number);

/** Compare a text of the engine with a file of the program, number by number. */
function compare(text, file, tolerance) {
  const [ours, theirs] = [numbers(text), numbers(readFileSync(file, "utf8"))];
  assert.equal(ours.length, theirs.length);
  const scale = theirs.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  let worst = 0;
  ours.forEach((value, i) => (worst = Math.max(worst, Math.abs(value - theirs[i]) / scale)));
  assert.ok(worst <= tolerance, `relative difference ${worst}, allowed ${tolerance}`);
  return worst;
}
const decode = (bytes) => new TextDecoder().decode(bytes);
const tolerance = (scheme) => (scheme.startsWith("learned") ? 1e-5 : 1e-12);

describe("equal to the native program", () => {
  const curves = [
    ["outline.csv", "csv", ["learned", "angle-4", "angle-6", "four-point", "chaikin", "cubic", "catmull-rom:parameters=centripetal"]],
    ["hyperbolic.csv", "csv", ["learned", "angle-4", "log-exp-4", "geodesic"]],
    ["iss-track.geojson", "geojson", ["learned", "angle-4", "log-exp-6:base=midpoint"]],
    ["coast.geojson", "geojson", ["learned", "angle-4"]],
    ["quarter-arc.csv", "csv", ["angle-6", "six-point"]],
    ["camera-path.obj", "obj", ["four-point", "lane-riesenfeld"]],
  ];
  for (const [file, format, schemes] of curves)
    for (const scheme of schemes)
      test(`${file} by ${scheme}`, () => {
        const out = join(folder, `curve.${format}`);
        native("curve", data(file), "--scheme", scheme, "--levels", "4", "--precision", "12", "--topology", "separate", "-o", out);
        const coarse = batten.bat_curve_read_memory(readFileSync(data(file)));
        const fine = batten.bat_curve_refine(coarse, { scheme, levels: 4 });
        compare(decode(batten.bat_curve_write_memory(fine, { format, precision: 12 })), out, tolerance(scheme));
      });

  test("a map keeps its shared borders", () => {
    const out = join(folder, "map.geojson");
    native("curve", data("map.geojson"), "--scheme", "angle-4", "--levels", "2", "-o", out);
    const coarse = batten.bat_curve_read_memory(readFileSync(data("map.geojson")));
    const fine = batten.bat_curve_map_refine(coarse, { scheme: "angle-4", levels: 2, find_corners: true });
    assert.ok(fine.report.map && fine.report.shared > 100);
    compare(decode(batten.bat_curve_write_memory(fine)), out, 1e-12);
  });

  test("a camera move", () => {
    const out = join(folder, "frames.tum");
    native("motion", data("camera-keyframes.csv"), "--rate", "25", "-o", out);
    const keys = batten.bat_curve_read_memory(readFileSync(data("camera-keyframes.csv")));
    const frames = batten.bat_motion_curves(keys, { rate: 25 });
    compare(decode(batten.bat_curve_write_memory(frames, { format: "tum" })), out, 1e-12);
  });

  for (const [scheme, levels, fairness] of [["auto", 2], ["learned", 2, 1], ["loop", 2], ["butterfly", 2], ["sqrt3", 2]])
    test(`a cage by ${scheme}`, () => {
      const cage = join(folder, "cage.obj");
      const out = join(folder, "fine.obj");
      native("shape", "cage", "-o", cage);
      native("mesh", cage, "--scheme", scheme, "--levels", String(levels), ...(fairness ? ["--fairness", String(fairness)] : []), "-o", out);
      const fine = batten.bat_mesh_refine(batten.bat_mesh_read_memory(readFileSync(cage)), { scheme, levels, ...(fairness ? { fairness } : {}) });
      const text = decode(batten.bat_mesh_write_memory(fine, { format: "obj" }));
      const vertices = (all) => all.split("\n").filter((line) => line.startsWith("v ")).join("\n");
      const other = join(folder, "vertices.txt");
      writeFileSync(other, vertices(readFileSync(out, "utf8")));
      compare(vertices(text), other, tolerance(scheme === "auto" ? "learned" : scheme));
      const faces = (all) => all.split("\n").filter((line) => line.startsWith("f ")).join("\n");
      assert.equal(faces(text), faces(readFileSync(out, "utf8")));
    });

  for (const [name, options, flags] of [
    ["auto", {}, []],
    ["on the limit surface", { scheme: "catmull-clark", limit: true }, ["--scheme", "catmull-clark", "--limit"]],
    ["with creases by angle", { crease_angle: (50 * Math.PI) / 180 }, ["--crease-angle", "50"]],
    ["with sharp corners of the boundary", { boundary: "corners" }, ["--boundary", "corners"]],
  ])
    test(`a cage of polygons, ${name}`, () => {
      const cage = join(folder, "polygons.obj");
      const out = join(folder, "fine-polygons.obj");
      writeFileSync(cage, POLYGONS);
      native("mesh", cage, ...flags, "--levels", "3", "-o", out);
      const coarse = batten.bat_polygon_mesh_read_memory(POLYGONS);
      const fine = batten.bat_polygon_mesh_refine(coarse, { ...options, levels: 3 });
      assert.equal(fine.offsets.length - 1, fine.faces.length / 4);
      compare(decode(batten.bat_polygon_mesh_write_memory(fine, { format: "obj" })), out, 1e-12);
    });

  test("triangles by catmull-clark", () => {
    const cage = join(folder, "triangles.obj");
    const out = join(folder, "quads.ply");
    native("shape", "cage", "-o", cage);
    native("mesh", cage, "--scheme", "catmull-clark", "--levels", "2", "-o", out);
    const polygons = batten.bat_polygon_mesh_of_triangles(batten.bat_mesh_read_memory(readFileSync(cage)));
    const fine = batten.bat_polygon_mesh_refine(polygons, { scheme: "catmull-clark", levels: 2 });
    const theirs = batten.bat_polygon_mesh_read_memory(readFileSync(out));
    assert.deepEqual([fine.faces, fine.offsets], [theirs.faces, theirs.offsets]);
    fine.positions.forEach((value, i) => assert.ok(Math.abs(value - theirs.positions[i]) < 1e-12));
  });

  test("a decimated mesh", () => {
    const fine = join(folder, "creature.ply");
    const out = join(folder, "coarse.obj");
    native("shape", "creature", "--vertices", "1500", "--seed", "3", "-o", fine);
    native("decimate", fine, "--vertices", "200", "-o", out);
    const coarse = batten.bat_mesh_decimate(batten.bat_mesh_read_memory(readFileSync(fine)), { vertices: 200 });
    compare(decode(batten.bat_mesh_write_memory(coarse, { format: "obj" })), out, 1e-9);
  });

  for (const [name, target] of [["faces", 300], ["ratio", 0.2], ["tolerance", 0.02]])
    test(`a mesh decimated by ${name}`, () => {
      const fine = join(folder, "fine.ply");
      const out = join(folder, "coarse.obj");
      native("shape", "creature", "--vertices", "600", "--seed", "5", "-o", fine);
      native("decimate", fine, `--${name}`, String(target), "-o", out);
      const coarse = batten.bat_mesh_decimate(batten.bat_mesh_read_memory(readFileSync(fine)), { [name]: target });
      compare(decode(batten.bat_mesh_write_memory(coarse, { format: "obj" })), out, 1e-9);
      if (name === "tolerance") assert.ok(coarse.distance > 0 && coarse.distance <= target);
    });

  test("names, texture and values of a mesh go through all calls", () => {
    const given = join(folder, "labels.obj");
    const out = join(folder, "fine-labels.obj");
    writeFileSync(given, TEXTURED);
    native("mesh", given, "--scheme", "loop", "--levels", "1", "-o", out);
    const fine = batten.bat_mesh_refine(batten.bat_mesh_read_memory(TEXTURED), { scheme: "loop", levels: 1 });
    assert.equal(decode(batten.bat_mesh_write_memory(fine, { format: "obj" })), readFileSync(out, "utf8"));
    assert.deepEqual(fine.labels.map(({ material }) => material), ["wood", "steel"]);
    const coloured = { ...cube(), channels: Float64Array.from({ length: 16 }, (_, i) => i), channel_names: ["heat", "load"] };
    const again = batten.bat_mesh_read_memory(batten.bat_mesh_write_memory(coloured, { format: "ply" }));
    assert.deepEqual([again.channels, again.channel_names], [coloured.channels, ["heat", "load"]]);
  });

  test("glTF", () => {
    const out = join(folder, "fine.gltf");
    const given = join(folder, "cage.glb");
    native("shape", "cage", "-o", join(folder, "cage.ply"));
    native("mesh", join(folder, "cage.ply"), "--levels", "0", "-o", given);
    native("mesh", given, "--scheme", "loop", "--levels", "1", "-o", out);
    const fine = batten.bat_mesh_refine(batten.bat_mesh_read_memory(readFileSync(given)), { scheme: "loop", levels: 1 });
    assert.equal(decode(batten.bat_mesh_write_memory(fine, { format: "gltf" })), readFileSync(out, "utf8"));
  });

  test("few points are a doubt", () => {
    const points = Array.from({ length: 49 }, (_, k) => [(k % 7) / 6, Math.floor(k / 7) / 6, ((k % 7) * Math.floor(k / 7)) / 360]);
    const text = points.map((point) => point.join(" ")).join("\n");
    const surface = batten.bat_surface_reconstruct(batten.bat_cloud_read(Buffer.from(text), { format: "xyz" }), {});
    assert.deepEqual([surface.verdict.right, surface.verdict.doubt], [true, "few"]);
    surface.free();
  });

  for (const [name, options, flags] of [
    ["as a rule", {}, []],
    ["by the network", { parameters: "learned", tolerance: 0.002 }, ["--parameterization", "learned", "--tolerance", "0.002"]],
    ["trimmed", { trim: true }, ["--trim"]],
  ])
    test(`a scan ${name}`, () => {
      const given = join(folder, "scan.xyz");
      const out = join(folder, "scan.json");
      native("shape", "hull", "--vertices", "1500", "-o", given);
      native("surface", given, ...flags, "-o", out);
      const surface = batten.bat_surface_reconstruct(batten.bat_cloud_read(readFileSync(given), { format: "xyz" }), options);
      assert.ok(surface.verdict.right);
      assert.deepEqual([surface.verdict.doubt, surface.gaps.length], ["none", 0]);
      compare(decode(batten.bat_surface_write(surface, { format: "json" })), out, 1e-6);
      const step = decode(batten.bat_surface_write(surface, { format: "step" }));
      assert.match(step, /^ISO-10303-21;[\s\S]*END-ISO-10303-21;\s*$/);
      const corners = batten.bat_spline_surface_evaluate(surface, [[0, 0], [1, 1]], 1);
      assert.equal(corners.length, 18);
      surface.free();
      assert.throws(() => batten.bat_surface_write(surface, { format: "step" }), /was freed/);
    });

  test("a closed cloud as a shell", () => {
    const given = join(folder, "stone.ply");
    const cloud = join(folder, "stone.xyz");
    const out = join(folder, "stone.obj");
    native("shape", "stone", "--vertices", "2000", "-o", given);
    const { positions } = batten.bat_mesh_read_memory(readFileSync(given));
    writeFileSync(cloud, Array.from({ length: positions.length / 3 }, (_, i) => positions.slice(3 * i, 3 * i + 3).join(" ")).join("\n"));
    native("surface", cloud, "--shell", "-o", out);
    const read = batten.bat_cloud_read(readFileSync(cloud), { format: "xyz" });
    assert.throws(() => batten.bat_surface_reconstruct(read), (error) => error.remedy === "shell");
    const shell = batten.bat_shell_reconstruct(read);
    assert.ok(shell.closed && shell.pieces === 1 && shell.volume > 0);
    const places = (text) => text.split("\n").filter((line) => line.startsWith("v ")).join("\n");
    const other = join(folder, "stone.txt");
    writeFileSync(other, places(readFileSync(out, "utf8")));
    compare(places(decode(batten.bat_shell_write(shell, { format: "obj" }))), other, 1e-6);
    assert.equal(batten.bat_shell_tessellate(shell, 1).faces.length, 4 * shell.face_count * shell.spans ** 2);
    shell.free();
  });

  test("an analysis", () => {
    for (const scheme of ["chaikin", "four-point", "six-point", "mask:1/8,4/8,6/8,4/8,1/8"]) {
      const theirs = JSON.parse(native("analyze", scheme, "--json"));
      const ours = batten.bat_mask_analyze(scheme);
      const smooth = JSON.stringify(theirs).match(/"smooth_proven":\s*(-?\d+)/);
      if (smooth) assert.equal(ours.smooth_proven, Number(smooth[1]));
      assert.equal(ours.converges, "proven");
      assert.ok(ours.exponent_lower <= ours.exponent_upper);
    }
  });
});

describe("values", () => {
  test("chaikin cuts corners at quarters", () => {
    const fine = batten.bat_curve_refine({ points: [[0, 0], [4, 0], [4, 4]], closed: true }, { scheme: "chaikin", levels: 1 });
    assert.deepEqual([...fine.points].map((v) => Math.round(v * 1e12) / 1e12).sort((a, b) => a - b), [0, 0, 1, 1, 1, 1, 3, 3, 3, 4, 4, 3].sort((a, b) => a - b));
  });
  test("the default limit of points lets a million through", () => {
    const n = 1 << 16;
    const points = Float64Array.from({ length: 2 * n }, (_, i) => (i % 2 ? Math.sin : Math.cos)((Math.PI * (i - (i % 2))) / n));
    assert.equal(batten.bat_curve_refine({ points, closed: true }, { scheme: "four-point", levels: 4, simple: "never" }).points.length, 2 * n * 16);
  });
  test("what auto stands for", () => {
    const octahedron = {
      positions: Float64Array.of(1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1),
      faces: Uint32Array.of(0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5),
    };
    assert.equal(batten.bat_mesh_scheme_for(octahedron), "loop"); // a cage
    assert.equal(batten.bat_mesh_scheme_for(cube()), "learned"); // a solid
    assert.equal(batten.bat_mesh_refine(cube(), { levels: 1, limit: true, limit_normals: true, scheme: "loop" }).limit_normals.length, 3 * 26);
  });
  test("tables name what the functions take", () => {
    const polygons = batten.bat_polygon_mesh_of_triangles(cube());
    for (const { name } of batten.bat_choices("mesh_scheme")) assert.ok(batten.bat_polygon_mesh_refine(polygons, { scheme: name, levels: 1 }).faces.length > 36);
    for (const option of ["boundary", "creasing", "linear"])
      for (const { name } of batten.bat_choices(`mesh_${option}`)) assert.equal(batten.bat_mesh_refine(cube(), { scheme: "loop", levels: 1, [option]: name }).faces.length, 144);
    for (const rows of Object.values(batten.bat_choices())) assert.ok(rows.length > 0);
    assert.throws(() => batten.bat_choices("mesh"), /no family 'mesh'/);
  });
  test("polygons as rows, their triangles and normals", () => {
    const quads = { positions: cube().positions, faces: [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]] };
    assert.equal(batten.bat_polygon_mesh_scheme_for(quads), "catmull-clark");
    assert.equal(batten.bat_polygon_mesh_triangulate(quads).faces.length, 36);
    const fine = batten.bat_polygon_mesh_refine(quads, { levels: 1 });
    assert.deepEqual([...fine.offsets], Array.from({ length: 25 }, (_, i) => 4 * i));
    const normals = batten.bat_polygon_mesh_limit_normals(fine);
    const outward = (at) => [0, 1, 2].reduce((sum, k) => sum + normals[at + k] * fine.positions[at + k], 0);
    for (let i = 0; i < normals.length; i += 3) assert.ok(outward(i) > 0.5);
    const labelled = batten.bat_polygon_mesh_read_memory(`${TEXTURED.replace("f 1/1 2/2 3/3", "f 1/1 2/2 3/3 4/4").split("g side")[0]}`);
    assert.deepEqual([[...labelled.texture_faces], labelled.labels[0].material], [[0, 1, 2, 3], "wood"]);
    assert.equal(batten.bat_polygon_mesh_refine(labelled, { levels: 1 }).texture.length, 18);
  });
  test("memory is given back", () => {
    // Curves that stay would need 160 MB more.
    const points = Float64Array.from({ length: 20000 }, (_, i) => (i % 2 ? Math.sin : Math.cos)((Math.PI * (i - (i % 2))) / 10000));
    const before = process.memoryUsage().arrayBuffers;
    for (let i = 0; i < 60; i++) batten.bat_curve_refine({ points, closed: true }, { scheme: "four-point", levels: 4, simple: "never" });
    globalThis.gc?.();
    assert.ok(process.memoryUsage().arrayBuffers - before < 400e6);
  });
});

const TEXTURED = `mtllib parts.mtl
o table
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
g top
usemtl wood
f 1/1 2/2 3/3
g side
usemtl steel
f 1/1 3/3 4/4
`;
/** An L with thickness: hexagons and quads, open at one end. */
const POLYGONS = `v 0 0 0
v 3 0 0
v 3 1 0
v 1 1 0
v 1 3 0
v 0 3 0
v 0 0 1
v 3 0 1
v 3 1 1
v 1 1 1
v 1 3 1
v 0 3 1
f 6 5 4 3 2 1
f 7 8 9 10 11 12
f 1 2 8 7
f 2 3 9 8
f 3 4 10 9
f 4 5 11 10
f 6 1 7 12
`;
const cube = () => ({
  positions: [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
  faces: [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7]],
});

describe("failures", () => {
  const fails = (call, status, text, line) =>
    assert.throws(call, (error) => {
      assert.ok(error instanceof BattenError, String(error));
      assert.equal(error.status, status);
      assert.match(error.message, text);
      if (line !== undefined) assert.equal(error.line, line);
      return true;
    });
  test("points that are no surface", () => {
    // Qhull's errors return by a jump out of it.
    const line = Array.from({ length: 40 }, (_, i) => [i, 0, 0]);
    assert.throws(() => batten.bat_surface_reconstruct(line), (error) => error instanceof BattenError);
    fails(() => batten.bat_surface_reconstruct([[0, 0, 0], [1, Number.NaN, 0]]), "invalid point", /./);
    fails(() => batten.bat_surface_reconstruct([0, 1]), "invalid argument", /threes/);
    fails(() => batten.bat_cloud_read("1 2 3\n4 5\n", { format: "xyz" }), "bad file", /./, 2);
    const plane = Array.from({ length: 400 }, (_, i) => [i % 20, Math.floor(i / 20), 0]);
    assert.ok(batten.bat_surface_reconstruct(plane).verdict.right, "the engine works after failures");
  });
  test("files tell the line", () => {
    fails(() => batten.bat_curve_read_memory("x,y\n0,0\n1,oops\n2,3\n", { format: "csv" }), "bad file", /./, 3);
    fails(() => batten.bat_mesh_read_memory("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", { format: "obj" }), "bad file", /./, 4);
    fails(() => batten.bat_curve_read_memory('{"type":"Feature",\n"geometry": [}'), "bad file", /./, 2);
  });
  test("options", () => {
    const curve = { points: [[0, 0], [1, 0], [1, 1]], closed: true };
    fails(() => batten.bat_curve_refine(curve, { scheme: "nope" }), "invalid argument", /nope/);
    fails(() => batten.bat_curve_refine(curve, { level: 3 }), "invalid argument", /no option 'level'/);
    fails(() => batten.bat_curve_refine(curve, { levels: 61 }), "invalid argument", /levels/);
    fails(() => batten.bat_curve_refine(curve, { levels: 2.5 }), "invalid argument", /levels/);
    fails(() => batten.bat_curve_refine(curve, { levels: 40 }), "too large", /./);
    fails(() => batten.bat_curve_refine({ points: [[0, 0], [1, 0], [1, 0]], closed: true }), "invalid point", /./);
    fails(() => batten.bat_curve_refine({ points: [[0, 0], [Number.NaN, 0], [1, 0]], closed: true }), "invalid point", /./);
    fails(() => batten.bat_mesh_refine({ positions: [0, 0, 0], faces: [0, 1, 2] }), "invalid point", /./);
    fails(() => batten.bat_curve_refine(curve, { levels: () => 3 }), "invalid argument", /levels must not be a function/);
    fails(() => batten.bat_curve_refine(curve, { levels: Number.NaN }), "invalid argument", /levels/);
    fails(() => batten.bat_curve_refine(curve, { progress: 1 }), "invalid argument", /progress/);
    fails(() => batten.bat_curve_refine(curve, { snap: 1 }), "invalid argument", /true or false/);
    fails(() => batten.bat_curve_refine(curve, { scheme: 4 }), "invalid argument", /text/);
    fails(() => batten.bat_mask_analyze("learned"), "unsupported", /no mask/);
    fails(() => batten.bat_mesh_refine(cube(), { scheme: "learned", fairness: 2 }), "invalid argument", /fairness/);
    fails(() => batten.bat_mesh_decimate(cube(), { ratio: 0.5, faces: 4 }), "invalid argument", /./);
    fails(() => batten.bat_mesh_refine({ ...cube(), texture: [[0, 0]], texture_faces: [0, 0, 0] }), "invalid argument", /texture_faces/);
    fails(() => batten.bat_mesh_refine({ positions: cube().positions, faces: [[0, 3, 2, 1]] }), "invalid argument", /takes triangles/);
    fails(() => batten.bat_polygon_mesh_refine({ ...cube(), faces: [0, 3, 2, 1], offsets: [0, 5] }), "invalid argument", /offsets/);
    fails(() => batten.bat_polygon_mesh_refine({ ...cube(), faces: [0, 3, 2, 1, 0], offsets: [0, 4, 3, 5] }), "invalid argument", /offsets/);
    fails(() => batten.bat_polygon_mesh_refine({ ...cube(), faces: [0, 3, 2, 1] }), "invalid argument", /rows/);
    fails(() => batten.bat_polygon_mesh_refine({ ...cube(), faces: [[0, 3, 2, 9]] }), "invalid point", /9/);
    fails(() => batten.bat_polygon_mesh_refine({ ...cube(), faces: [[0, 3, 2, 1]] }, { scheme: "loop" }), "unsupported", /corners/);
    fails(() => batten.bat_mesh_refine({ ...cube(), rules: { boundary: "nope" } }), "invalid argument", /nope/);
    fails(() => batten.bat_mesh_refine({ ...cube(), channels: [1], channel_names: ["s"] }), "invalid argument", /channels/);
  });
  test("a progress function stops a call", () => {
    const n = 20000;
    const points = Float64Array.from({ length: 2 * n }, (_, i) => (i % 2 ? Math.sin : Math.cos)((Math.PI * (i - (i % 2))) / n));
    let calls = 0;
    const progress = () => {
      calls++;
      return false;
    };
    const many = Array.from({ length: 50 }, () => ({ points, closed: true }));
    fails(() => batten.bat_curve_refine(many, { levels: 3, progress }), "cancelled", /./);
    assert.ok(calls > 0);
  });
});

test("npm pack, and ten lines that use the package", () => {
  const npm = (...command) => execFileSync("npm", command, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] });
  const tarball = npm("pack", "--silent", join(source, "web/npm")).trim().split("\n").pop();
  const contents = execFileSync("tar", ["-tzf", join(folder, tarball)], { encoding: "utf8" });
  for (const name of ["index.mjs", "browser.mjs", "inline.mjs", "packed.mjs", "engine.mjs", "index.d.ts", "batten.wasm", "README.md", "LICENSE"]) assert.match(contents, new RegExp(`package/${name}`));
  const home = join(folder, "user/node_modules/batten");
  mkdirSync(home, { recursive: true });
  execFileSync("tar", ["-xzf", join(folder, tarball), "-C", home, "--strip-components", "1"]);
  copyFileSync(join(source, "web/test/ten-lines.mjs"), join(folder, "user/ten-lines.mjs"));
  const said = execFileSync(process.execPath, [join(folder, "user/ten-lines.mjs"), data("outline.csv"), join(folder, "fair.csv")], { encoding: "utf8" });
  assert.match(said, /352 points, closed: true/);
  const out = join(folder, "native.csv");
  native("curve", data("outline.csv"), "--scheme", "learned", "--levels", "4", "-o", out);
  compare(readFileSync(join(folder, "fair.csv"), "utf8"), out, 1e-5);
});

describe("untrusted input", () => {
  const ply = (properties) =>
    ["ply", "format ascii 1.0", "element vertex 3", "property double x", "property double y", "property double z",
     ...properties.map((name) => `property double ${name}`), "element face 1", "property list uchar int vertex_indices", "end_header",
     ...["0 0 0", "1 0 0", "0 1 0"].map((place) => [place, ...properties.map(() => 7)].join(" ")), "3 0 1 2", ""].join("\n");
  test("names in a file stay texts", () => {
    for (const names of [["f64", "0", "5000"], ["u32", "8", "99999999999"], ["NaN", "Infinity"], ["batten", "NaN"], ['{"":["f64",0,8]}', '{"":"NaN"}']])
      assert.deepEqual(batten.bat_mesh_read_memory(ply(names)).channel_names, names);
    const obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\ng NaN\nusemtl Infinity\nf 1 2 3\n";
    const [label] = batten.bat_mesh_read_memory(obj).labels;
    assert.deepEqual([label.group, label.material], ["NaN", "Infinity"]);
  });
  test("no property of a file is taken for an array", () => {
    const feature = { type: "Feature", properties: { "": ["f64", 8, 1000], a: { "": "NaN" } }, geometry: { type: "LineString", coordinates: [[0, 0], [1, 0], [1, 1]] } };
    const set = batten.bat_curve_read_memory(JSON.stringify(feature));
    assert.deepEqual(JSON.parse(decode(batten.bat_curve_write_memory(set, { format: "geojson" }))).properties, feature.properties);
    set.free();
  });
  test("numbers that are none come out as numbers", () => {
    const open = { positions: [0, 0, 0, 1, 0, 0, 0, 1, 0], faces: [0, 1, 2] };
    assert.ok(Number.isNaN(batten.bat_mesh_summarize(open).volume));
  });
  test("arguments of other types are refused", () => {
    const mesh = { positions: [0, 0, 0, 1, 0, 0, 0, 1, 0], faces: [0, 1, 2] };
    const refuses = (call) => assert.throws(call, (error) => error instanceof BattenError && error.status === "invalid argument");
    refuses(() => batten.bat_mesh_summarize({ ...mesh, faces: [0, 1.5, 2] }));
    refuses(() => batten.bat_mesh_summarize({ ...mesh, faces: [0, -1, 2] }));
    refuses(() => batten.bat_mesh_summarize({ ...mesh, faces: [0, "1", 2] }));
    refuses(() => batten.bat_mesh_summarize({ ...mesh, faces: "0 1 2" }));
    refuses(() => batten.bat_mesh_refine({ ...mesh, labels: "text", face_labels: [0] }));
    refuses(() => batten.bat_mesh_refine({ ...mesh, labels: [{ group: 5 }], face_labels: [0] }));
    refuses(() => batten.bat_mesh_refine(mesh, 5));
    refuses(() => batten.bat_mesh_refine(mesh, { levels: 1.5 }));
    refuses(() => batten.bat_mesh_refine(null));
    refuses(() => batten.bat_curve_refine({}));
    refuses(() => batten.bat_curve_refine(null));
    refuses(() => batten.bat_curve_refine({ points: [0, "1"] }));
    refuses(() => batten.bat_curve_refine({ points: [[0, 0], [1, 0], [1, 1]], channels: "text" }));
    const curve = { points: [[0, 0], [1, 0], [1, 1]] };
    for (const other of [[], new Array(2), { ...curve, space: Symbol("s") }, { ...curve, space: {} }, { ...curve, point_dim: 2n }, { ...curve, corners: 1 }, { ...curve, corners: [1] }])
      refuses(() => batten.bat_curve_refine(other));
    for (const creases of [[["0", 1, 3]], [[0, 2 ** 32 + 1, 3]], [[0, 1, Number.NaN]], [[0, 1]], [[0, 1n, 2]], [7]]) refuses(() => batten.bat_mesh_refine({ ...mesh, creases }));
    refuses(() => batten.bat_mesh_refine({ ...mesh, corners: [[0, "1"]] }));
    refuses(() => batten.bat_mesh_refine({ ...mesh, rules: { boundary: 1n } }));
    refuses(() => batten.bat_polygon_mesh_refine({ ...mesh, faces: [[0, 1, 2], null] }));
    refuses(() => batten.bat_mesh_read_memory(5));
    refuses(() => batten.bat_motion_spline_sample(null, [0]));
    refuses(() => batten.bat_choices(Symbol("s")));
  });
  test("an infinite sharpness lasts for ever", () => {
    const [crease] = batten.bat_mesh_refine({ ...cube(), creases: [[0, 1, Infinity]] }, { scheme: "loop", levels: 1 }).creases;
    assert.ok(crease[2] >= 10);
  });
  test("more candidates than edges are all edges", () => {
    const coarse = (candidates) => batten.bat_mesh_decimate(cube(), { vertices: 6, candidates }).positions;
    assert.deepEqual(coarse(2 ** 31), coarse(0));
  });
  test("2,000,000 faces are refined", () => {
    const side = 1000;
    const positions = new Float64Array(3 * (side + 1) ** 2);
    for (let i = 0; i < positions.length / 3; i++) positions.set([i % (side + 1), Math.floor(i / (side + 1)), 0], 3 * i);
    const faces = new Uint32Array(6 * side * side);
    for (let j = 0, at = 0; j < side; j++)
      for (let i = 0; i < side; i++, at += 6) {
        const a = j * (side + 1) + i;
        faces.set([a, a + 1, a + side + 2, a, a + side + 2, a + side + 1], at);
      }
    assert.equal(batten.bat_mesh_refine({ positions, faces }, { scheme: "loop", levels: 1 }).faces.length, 3 * 8e6);
  });
  test("20,000 faces are refined by the network, twice", () => {
    const side = 100;
    const positions = Array.from({ length: (side + 1) ** 2 }, (_, i) => [i % (side + 1), Math.floor(i / (side + 1)), 0]);
    const faces = [];
    for (let j = 0; j < side; j++)
      for (let i = 0; i < side; i++) {
        const a = j * (side + 1) + i;
        faces.push([a, a + 1, a + side + 2], [a, a + side + 2, a + side + 1]);
      }
    assert.equal(batten.bat_mesh_refine({ positions, faces }, { scheme: "learned", levels: 2 }).faces.length, 3 * 320000);
  });
});
