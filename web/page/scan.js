// Scans: scattered points become a spline surface, or a shell of any shape, judged by the points.
import samples from "samples";
import { check, digits, download, endings, enumerator, group, h, opener, select, slider, table } from "./dom.js";
import { quoted, shellName } from "./code.js";
import { Cancelled } from "./engine.js";
import { divider, scene3d } from "./scene.js";

/** Numbers from 0 to 1 that look random and are always the same. */
const randoms = (seed) => () => {
  seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
  return seed / 2 ** 32;
};
const gauss = (random) => Math.sqrt(-2 * Math.log(1 - random())) * Math.cos(2 * Math.PI * random());
const text = (points) => new TextEncoder().encode(points.map((p) => p.map((value) => value.toFixed(6)).join(" ")).join("\n"));
/** A curved panel, scanned with noise. */
function panel() {
  const random = randoms(7);
  return Array.from({ length: 2600 }, () => {
    const [x, y] = [2 * random() - 1, 1.4 * random() - 0.7];
    const z = 0.35 * Math.sin(2.2 * x + 0.6) * Math.cos(1.9 * y) + 0.22 * Math.exp(-12 * ((x - 0.3) ** 2 + (y + 0.1) ** 2));
    return [x, y, z].map((value) => value + 0.002 * gauss(random));
  });
}
/** A closed body: a bent, thickened figure. */
function body() {
  const random = randoms(11);
  return Array.from({ length: 5000 }, () => {
    const [s, t] = [2 * Math.PI * random(), Math.acos(2 * random() - 1)];
    const r = 1 + 0.22 * Math.sin(3 * t) * Math.cos(2 * s) + 0.12 * Math.cos(4 * t);
    return [1.25 * r * Math.sin(t) * Math.cos(s), r * Math.sin(t) * Math.sin(s), 0.8 * r * Math.cos(t)].map((value) => value + 0.003 * gauss(random));
  });
}
const EXAMPLES = { panel: ["Panel, 2,600 points with noise", panel], body: ["Closed body, 5,000 points", body] };
const KINDS = [["auto", "found"], ["patch", "one patch"], ["trim", "trimmed patch"], ["shell", "shell of any shape"]];
const FORMATS = ["step", "iges", "obj", "json", "xml", "vtk"];
const OF_SHELLS = ["step", "obj"];
const FIRST = { example: "panel", data: 0, kind: "auto", parameters: "auto", tolerance: 0, robust: false, force: false, colour: false };
/** The controls of options that lead out of failures. */
const CONTROLS = { shell: "Surface: shell of any shape", trim: "Surface: trimmed patch", force: "Show it all the same" };

/** Whether a file is compressed LAS. */
const compressed = (bytes) => bytes.length > 104 && new TextDecoder("latin1").decode(bytes.subarray(0, 4)) === "LASF" && (bytes[104] & 0xc0) !== 0;

export function scanTab(app, section) {
  let state = { ...FIRST };
  let bytes = null;
  let format;
  let file = "scan.xyz";
  let result = null;
  /** Promises of LAS for files that are compressed. */
  const expanded = new WeakMap();
  let started = false;
  const legend = h("div.legend", {}, "");
  const stage = h("div.stage", { tabIndex: 0, role: "group", "aria-label": "Points and surface; drag to turn, arrow keys turn too" }, legend);
  const facts = h("div", {});
  const verdict = h("p.verdict", { role: "status" });
  const scene = scene3d(stage, section);
  const split = divider(stage, () => scene.redraw());

  async function compute() {
    bytes ??= text(EXAMPLES[state.example || "panel"][1]());
    try {
      const given = bytes;
      if (compressed(given) && !expanded.has(given)) expanded.set(given, app.expand(given).catch((error) => (expanded.delete(given), Promise.reject(error))));
      const las = await (expanded.get(given) ?? given);
      if (given !== bytes) throw new Cancelled("superseded");
      result = await (await app.scanEngine()).latest("scan", "scan", { bytes: las, format: format ?? (state.example ? "xyz" : undefined), ...state }, "Fitting a surface");
      app.clear();
      draw();
      figures();
      controls();
    } catch (error) {
      app.fail(error, state.example ? undefined : file, CONTROLS);
      return error.message === "superseded" ? null : false;
    }
    return true;
  }
  function draw() {
    const { points, mesh, distances } = result;
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    points.forEach((value, i) => {
      low[i % 3] = Math.min(low[i % 3], value);
      high[i % 3] = Math.max(high[i % 3], value);
    });
    const most = scene.show({ low, high, mesh, values: state.colour ? distances : null, cloud: points, split: () => split.share });
    legend.textContent = most === null ? "left: points; right: the surface" : `left: points; right: the surface, by the distance of its points: dark 0, yellow ${digits(most, 3)}`;
  }
  /** The verdict in words: right, right with a doubt, or wrong. */
  function judge() {
    const { report: r, kind } = result;
    if (kind === "shell") return ["good", "Right: judged by the points, both ways."];
    const { right, text, doubt_size: size, doubt_place: place, ...v } = r.verdict;
    if (!right) return ["bad", `Wrong: ${text}`];
    const near = `99 of 100 points are within ${digits(v.distance_from_surface, 3)}, and 99 % of the surface is within ${digits(v.distance_from_points, 3)} of a point.`;
    if (!text) return ["good", `Right: ${near}`];
    const where = place.every(Number.isFinite) ? `, by up to ${digits(size, 3)}, near ${place.map((value) => digits(value, 4)).join(" ")}` : "";
    return ["doubt", `Right, but ${text}${where}. ${near[0].toUpperCase()}${near.slice(1)}`];
  }
  /** Holes and closed gaps of a trimmed surface, each a row. */
  const gaps = ({ gaps: all = [] }) => all.map(({ closed, diameter }) => [closed ? "closed gap" : "hole", `${digits(diameter, 3)} across`]);
  function figures() {
    const { report: r, kind, seconds } = result;
    const shell = kind === "shell";
    const [is, words] = judge();
    verdict.className = `verdict ${is}`;
    verdict.textContent = words;
    const rows = shell
      ? [["points", digits(r.fitted)], ["noise of a coordinate", digits(r.noise, 3)], ["surface", `${r.closed ? "closed" : "open"} shell, ${r.face_count * r.spans ** 2} patches`], ["root mean square distance", digits(r.rms, 3)], ["largest distance", digits(r.largest, 3)], ["held-out points", digits(r.held_out, 3)], ["normals across sides", `${digits(r.normal_jump, 2)}°`], ...(r.closed ? [["volume", digits(r.volume, 4)]] : [["boundary loops", digits(r.holes)]])]
      : [["points", digits(result.points.length / 3)], ["noise of a coordinate", digits(r.noise, 3)], ["parameters", r.chosen], ["functions", `${r.functions} on ${r.levels} level${r.levels > 1 ? "s" : ""}`], ["root mean square distance", digits(r.rms, 3)], ["largest distance", digits(r.largest, 3)], ["held-out points", digits(r.held_out_rms, 3)], ["area", digits(r.verdict.area, 4)], ...gaps(r)];
    facts.replaceChildren(verdict, table(["", "value"], [...rows, ["seconds", digits(seconds, 2)]]));
    for (const [name, button] of buttons) {
      button.disabled = shell && !OF_SHELLS.includes(name);
      button.title = button.disabled ? "holds one patch, and no shell" : "";
    }
  }
  const change = async (changes) => {
    const last = { ...state };
    Object.assign(state, changes);
    controls();
    const done = await compute();
    if (done) app.commit();
    else if (done === false && !changes.example) {
      state = last;
      controls();
    }
  };
  function take(given) {
    ({ bytes, name: file } = given);
    const ending = file.split(".").pop().toLowerCase();
    format = { txt: "xyz", asc: "xyz", tsv: "csv" }[ending] ?? ending;
    if (!samples.tables.cloud_format.some(({ name }) => name === format)) format = undefined;
  }
  async function open(chosen) {
    app.clear();
    const last = { bytes, format, file, state: { ...state } };
    take({ name: chosen.name, bytes: new Uint8Array(await chosen.arrayBuffer()) });
    Object.assign(state, { example: "", kind: "auto" });
    controls();
    const given = bytes;
    const done = await compute();
    if (done) {
      state.data = app.keep(file, bytes);
      app.commit();
      return true;
    }
    if (bytes !== given) return true; // a later file has taken its place
    // The last good state stays.
    ({ bytes, format, file } = last);
    Object.assign(state, last.state);
    controls();
    return false;
  }
  async function save(name) {
    app.clear(true);
    try {
      const data = await (await app.scanEngine()).call("writeScan", { format: name }, "Writing");
      download(`surface.${name}`, data);
    } catch (error) {
      app.fail(error, file, CONTROLS);
    }
  }
  const example = select("Example", [["", "choose …"], ...Object.entries(EXAMPLES).map(([name, [title]]) => [name, title])], state.example, (name) => {
    if (!name) return;
    bytes = null;
    format = undefined;
    file = "scan.xyz";
    void change({ example: name, data: 0, kind: "auto", tolerance: 0 });
  });
  const kind = select("Surface", KINDS, state.kind, (value) => change({ kind: value }));
  const parameters = select("Parameterization", samples.tables.surface_parameters.map(({ name }) => [name]), state.parameters, (value) => change({ parameters: value }));
  const tolerance = slider("Tolerance", { min: 0, max: 50, step: 1, value: 0, format: (value) => (value ? `${value / 1000} of the diagonal` : "as near as the points allow"), change: () => {}, commit: () => change({ tolerance: Number(tolerance.input.value) }) });
  const robust = check("Robust against outliers", false, (value) => change({ robust: value }));
  const colour = check("Colour by the distance of the points", false, (value) => {
    state.colour = value;
    if (result) draw();
    app.commit();
  });
  const force = check(CONTROLS.force, false, (value) => change({ force: value }));
  function controls() {
    example.set(state.example);
    kind.set(state.kind);
    parameters.set(state.parameters);
    parameters.box.disabled = ["trim", "shell"].includes(state.kind);
    tolerance.set(state.tolerance);
    robust.set(state.robust);
    robust.box.disabled = state.kind === "shell";
    force.set(state.force);
    colour.set(state.colour);
    colour.box.disabled = result?.kind === "shell";
  }
  const buttons = FORMATS.map((name) => [name, h("button", { type: "button", onclick: () => save(name) }, { xml: "G+Smo" }[name] ?? name.toUpperCase())]);
  section.append(
    h("div.column", {}, stage, group("Figures", facts)),
    h("div.side", {},
      group("Scan", h("div.row", {}, opener("Open file", endings(samples.tables.cloud_format), open), h("button", { type: "button", onclick: () => scene.picture("scan.png", download) }, "PNG")), example.element, h("p.hint", {}, "Drop points in no order: XYZ, CSV, PLY, OBJ, PCD, LAS, LAZ. Every surface is judged by the points; one that they prove wrong is refused.")),
      group("Fit", kind.element, parameters.element, tolerance.element, robust.element, force.element, colour.element),
      group("Download", h("div.row", {}, ...buttons.map(([, button]) => button))),
    ),
  );
  controls();
  return {
    open,
    redraw: () => scene.redraw(),
    show() {
      if (!started) {
        started = true;
        void compute();
      }
      scene.redraw();
    },
    state: () => state,
    async restore(next) {
      const other = next.example !== state.example || next.data !== state.data;
      state = { ...FIRST, ...next };
      const given = state.example ? null : app.file(state.data);
      if (!given && !EXAMPLES[state.example]) Object.assign(state, { example: FIRST.example, data: 0 });
      if (other || !bytes) {
        bytes = null;
        format = undefined;
        file = "scan.xyz";
        if (given) take(given);
      }
      started = true;
      controls();
      await compute();
    },
    inspect: () => ({ state, result }),
    commands() {
      const packed = bytes !== null && compressed(bytes); // the program reads LAS alone
      const las = packed ? file.replace(/\.las$/i, "-expanded").replace(/\.laz$/i, "") + ".las" : file;
      const shell = result?.kind === "shell";
      const near = result && state.tolerance > 0 ? Number(result.tolerance.toPrecision(3)) : 0;
      const trim = result ? result.kind === "trim" : state.kind === "trim";
      const given = state.parameters !== FIRST.parameters && !shell && !trim;
      const words = [near ? ` --tolerance ${near}` : "", given ? ` --parameterization ${state.parameters}` : "", trim ? " --trim" : "", shell ? " --shell" : "", state.robust && !shell ? " --robust" : "", state.force ? " --force" : ""].join("");
      const fields = (name, fit) => [near ? `${name}.${fit}tolerance = ${near};\n` : "", state.force ? `${name}.force = true;\n` : ""].join("");
      const c = shell
        ? `bat_cloud cloud;\nbat_error error;\nbat_cloud_read(${quoted(las)}, NULL, &cloud, &error);\nbat_shell_reconstruct_options options = bat_shell_reconstruct_defaults();\n${fields("options", "")}bat_shell shell;\nif (bat_shell_reconstruct(cloud.points, cloud.count, NULL, &options, &shell, NULL, &error) == BAT_OK)\n    bat_shell_write("surface.step", &shell, NULL, &error);\nelse\n    fprintf(stderr, "%s\\n", error.text);`
        : `bat_cloud cloud;\nbat_error error;\nbat_cloud_read(${quoted(las)}, NULL, &cloud, &error);\nbat_surface_reconstruct_options options = bat_surface_reconstruct_defaults();\n${fields("options", "fit.")}${given ? `options.parameters = ${enumerator("surface_parameters", state.parameters)};\n` : ""}${trim ? "options.trim = true;\n" : ""}${state.robust ? "options.fit.robust = true;\n" : ""}bat_surface_result result;\nif (bat_surface_reconstruct(&cloud, &options, &result, &error) == BAT_OK)\n    bat_surface_write("surface.step", &result.surface, NULL, &error);\nelse\n    fprintf(stderr, "%s\\n", error.text); // also of a surface that is judged to be wrong`;
      const settings = [near ? `, tolerance=${near}` : "", given ? `, parameters="${state.parameters}"` : "", trim ? ", trim=True" : "", state.robust && !shell ? ", robust=True" : "", state.force ? ", force=True" : ""].join("");
      return {
        shell: `${packed ? `laszip -i ${shellName(file)} -o ${shellName(las)}\n` : ""}batten surface ${shellName(las)}${words} -o surface.step`,
        c,
        python: `import batten\n\npoints = batten.read_points(${quoted(file)})\nsurface = batten.fit_surface(points${shell ? ", shell=True" : ""}${settings})\nsurface.write("surface.step")`,
      };
    },
  };
}
