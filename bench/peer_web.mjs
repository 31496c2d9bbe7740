// The peer of bench_web: the same work by the engine of the npm package, without the copies from and to JavaScript. Prints the
// least processor seconds of each case, a line each.
import { readFileSync } from "node:fs";

const ROUNDS = 12;
const module = new WebAssembly.Module(readFileSync(new URL("../web/npm/batten.wasm", import.meta.url)));
const imports = {};
for (const { module: space, name } of WebAssembly.Module.imports(module)) (imports[space] ??= {})[name] = () => 0;
imports.env.engine_progress = () => 1;
const { exports: engine } = new WebAssembly.Instance(module, imports);
engine._initialize?.();

const put = (array) => {
  const address = engine.engine_allocate(array.byteLength);
  new Uint8Array(engine.memory.buffer, address, array.byteLength).set(new Uint8Array(array.buffer));
  return address;
};
const text = (string) => put(new TextEncoder().encode(`${string}\0`));

/** A torus of two triangles a cell, as make_torus() of bench_web.c. */
function torus(rows, columns) {
  const positions = new Float64Array(3 * rows * columns);
  const faces = new Uint32Array(6 * rows * columns);
  for (let i = 0; i < rows; i++)
    for (let j = 0; j < columns; j++) {
      const [s, t] = [(2 * Math.PI * i) / rows, (2 * Math.PI * j) / columns];
      const [next, beside] = [((i + 1) % rows) * columns, (j + 1) % columns];
      const at = i * columns + j;
      positions.set([(2 + Math.cos(t)) * Math.cos(s), (2 + Math.cos(t)) * Math.sin(s), Math.sin(t)], 3 * at);
      faces.set([at, next + j, next + beside, at, next + beside, i * columns + beside], 6 * at);
    }
  const layout = { positions: [put(positions), positions.length], faces: [put(faces), faces.length] };
  return engine.engine_mesh(text(JSON.stringify(layout)));
}
function wave(count) {
  const points = new Float64Array(2 * count);
  for (let i = 0; i < count; i++) {
    const t = (2 * Math.PI * i) / count;
    const r = 1 + 0.1 * Math.sin(7 * t);
    points.set([r * Math.cos(t), r * Math.sin(t)], 2 * i);
  }
  const layout = { space: "plane", point_dim: 2, counts: [count], closed: [true], channel_count: 0 };
  return engine.engine_curves(text(JSON.stringify(layout)), put(points), 0, 0);
}

const curve = wave(31250);
const cases = [
  ["bat_mesh_refine", torus(250, 200), { scheme: "loop", levels: 2 }],
  ["bat_curve_refine", curve, { scheme: "angle-4", levels: 5, simple: "never" }],
  ["bat_curve_refine", curve, { scheme: "four-point", levels: 5, simple: "never" }],
  ["bat_curve_refine", wave(100), { scheme: "learned", levels: 5, simple: "never" }],
];
for (const [name, input, options] of cases) {
  const [operation, settings] = [text(name), text(JSON.stringify(options))];
  let least = Infinity;
  for (let round = 0; round < ROUNDS; round++) {
    const begin = process.cpuUsage();
    const result = engine.engine_run(operation, settings, input, 0, 0, 0);
    const { user, system } = process.cpuUsage(begin);
    engine.engine_free(result);
    least = Math.min(least, (user + system) / 1e6);
  }
  console.log(least.toFixed(6));
}
