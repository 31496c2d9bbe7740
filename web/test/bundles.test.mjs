// The npm package in bundles by esbuild, Vite and webpack, which run in Node, in Chromium and in a worker of it; and its types.
// Environment: SOURCE, the folder of the source; CHROMIUM.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { extname, join } from "node:path";
import { after, before, describe, test } from "node:test";
import { build as esbuild } from "esbuild";
import puppeteer from "puppeteer-core";
import { build as vite } from "vite";
import webpack from "webpack";

const { SOURCE: source, CHROMIUM: chromium } = process.env;
const modules = join(source, "web/node_modules");
/** Points of a square by two levels of Chaikin's scheme, and control points of a fit: what each bundle must say. */
const WORK = `export async function work(load) {
  const batten = await load();
  const fine = batten.bat_curve_refine({ points: [[0, 0], [4, 0], [4, 3], [0, 3]], closed: true }, { scheme: "chaikin", levels: 2 });
  const points = Array.from({ length: 400 }, (_, i) => [(i % 20) / 19, Math.floor(i / 20) / 19, 0.1 * Math.sin((i % 20) / 6) * Math.cos(Math.floor(i / 20) / 8)]);
  const surface = batten.bat_surface_reconstruct(points, { parameters: "uniform", functions: 64 });
  const answer = fine.points.length / 2 + " points, right: " + surface.verdict.right;
  surface.free();
  return answer;
}
`;
const ANSWER = "16 points, right: true";
let folder;
let browser;

/** A user's project: a page with a worker, and a script for Node, that import the package by a name. */
function project(name, from) {
  const home = join(folder, name);
  mkdirSync(join(home, "node_modules"), { recursive: true });
  symlinkSync(join(folder, "batten"), join(home, "node_modules/batten"));
  writeFileSync(join(home, "package.json"), '{ "type": "module" }');
  writeFileSync(join(home, "work.js"), WORK);
  const main = `import { load } from "${from}";\nimport { work } from "./work.js";\n`;
  writeFileSync(join(home, "worker.js"), `${main}work(load).then((answer) => postMessage(answer), (error) => postMessage(String(error)));\n`);
  writeFileSync(
    join(home, "page.js"),
    `${main}window.answers = Promise.all([
  work(load).catch(String),
  new Promise((resolve) => {
    const worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
    worker.onmessage = ({ data }) => resolve(data);
    worker.onerror = ({ message }) => resolve("worker: " + message);
  }),
]);\n`,
  );
  writeFileSync(join(home, "script.js"), `${main}console.log(await work(load));\n`);
  writeFileSync(join(home, "index.html"), '<!doctype html><link rel="icon" href="data:,"><script type="module" src="./page.js"></script>');
  return home;
}

const TYPES = { ".html": "text/html", ".js": "text/javascript", ".mjs": "text/javascript", ".wasm": "application/wasm" };
/** What the page of a folder says, and its worker. */
async function answers(home) {
  const server = createServer((request, response) => {
    const file = join(home, decodeURIComponent(new URL(request.url, "http://x").pathname).replace(/\/$/, "/index.html"));
    if (!existsSync(file)) return response.writeHead(404).end();
    return response.writeHead(200, { "content-type": TYPES[extname(file)] ?? "application/octet-stream" }).end(readFileSync(file));
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const page = await browser.newPage();
  try {
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    await page.waitForFunction("window.answers", { timeout: 60000, polling: 50 });
    return await page.evaluate("window.answers");
  } finally {
    await page.close();
    server.close();
  }
}
const said = (file) => execFileSync(process.execPath, [file], { encoding: "utf8" }).trim();
const run = (config) =>
  new Promise((resolve, reject) =>
    webpack(config, (error, stats) => (error || stats.hasErrors() ? reject(error ?? new Error(stats.toString({ errors: true }))) : resolve())),
  );

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "batten-bundles-"));
  // What is packed, and nothing else.
  const home = join(folder, "batten");
  mkdirSync(home);
  const tarball = execFileSync("npm", ["pack", "--silent", join(source, "web/npm")], { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] }).trim().split("\n").pop();
  execFileSync("tar", ["-xzf", join(folder, tarball), "-C", home, "--strip-components", "1"]);
  browser = await puppeteer.launch({ executablePath: chromium, headless: true, timeout: 120000, protocolTimeout: 240000, args: ["--no-sandbox"] });
});
after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

describe("esbuild", () => {
  const settings = { bundle: true, format: "esm", logLevel: "error" };
  for (const from of ["batten", "batten/inline"])
    test(`${from} in Chromium and Node`, async () => {
      const home = project(`esbuild-${from.replace("/", "-")}`, from);
      const out = join(home, "dist");
      await esbuild({ ...settings, absWorkingDir: home, entryPoints: ["page.js", "worker.js"], outdir: out, platform: "browser" });
      await esbuild({ ...settings, absWorkingDir: home, entryPoints: ["script.js"], outfile: join(out, "script.mjs"), platform: "node" });
      copyFileSync(join(home, "index.html"), join(out, "index.html"));
      if (from === "batten") {
        // The message tells what is missing.
        assert.throws(() => said(join(out, "script.mjs")), /copy it there, or import "batten\/inline"/);
        copyFileSync(join(folder, "batten/batten.wasm"), join(out, "batten.wasm"));
      }
      assert.deepEqual(await answers(out), [ANSWER, ANSWER]);
      assert.equal(said(join(out, "script.mjs")), ANSWER);
    });
});

test("Vite, in Chromium and Node", async () => {
  const home = project("vite", "batten");
  const settings = { root: home, logLevel: "error", configFile: false };
  await vite({ ...settings, worker: { format: "es" }, build: { outDir: "dist", target: "es2022" } });
  assert.deepEqual(await answers(join(home, "dist")), [ANSWER, ANSWER]);
  await vite({ ...settings, ssr: { noExternal: true }, build: { ssr: "script.js", outDir: "node", target: "node18" } });
  copyFileSync(join(folder, "batten/batten.wasm"), join(home, "node/batten.wasm"));
  const [script] = readdirSync(join(home, "node")).filter((name) => /\.m?js$/.test(name));
  assert.equal(said(join(home, "node", script)), ANSWER);
});

test("webpack, in Chromium and Node", async () => {
  const home = project("webpack", "batten");
  const settings = { context: home, mode: "production", performance: false, optimization: { minimize: false } };
  await run({ ...settings, entry: "./page.js", output: { path: join(home, "dist"), filename: "page.js" } });
  copyFileSync(join(home, "index.html"), join(home, "dist/index.html"));
  assert.deepEqual(await answers(join(home, "dist")), [ANSWER, ANSWER]);
  await run({ ...settings, entry: "./script.js", target: "node18", experiments: { outputModule: true }, output: { path: join(home, "node"), filename: "script.mjs", module: true } });
  assert.equal(said(join(home, "node/script.mjs")), ANSWER);
});

describe("types", () => {
  /** What tsc --strict says of a script. */
  function check(name, text) {
    const home = join(folder, `types-${name}`);
    mkdirSync(join(home, "node_modules"), { recursive: true });
    symlinkSync(join(folder, "batten"), join(home, "node_modules/batten"));
    writeFileSync(join(home, "script.mts"), text);
    const compilerOptions = { strict: true, noEmit: true, skipLibCheck: false, target: "es2022", lib: ["es2022", "dom"], module: "nodenext", types: [] };
    writeFileSync(join(home, "tsconfig.json"), JSON.stringify({ compilerOptions, files: ["script.mts"] }));
    try {
      execFileSync(process.execPath, [join(modules, "typescript/bin/tsc"), "-p", "."], { cwd: home, encoding: "utf8", stdio: "pipe" });
      return [];
    } catch (error) {
      return error.stdout.split("\n").filter((line) => /error TS/.test(line));
    }
  }
  const head = 'import { BattenError, load } from "batten";\nconst batten = await load();\nconst line = { points: [[0, 0], [1, 0], [1, 1]], closed: true };\nconst mesh = batten.bat_mesh_read_memory("");\n';
  test("a user's script has no fault", () => {
    const script = `${head}
const fine = batten.bat_curve_refine(line, { scheme: "learned:fairness=0.5", levels: 3, smooth: NaN, progress: (share) => share < 1 });
const first: number = fine.points[0] + fine.report.crossings;
const many = batten.bat_curve_refine([line, line], { scheme: "four-point" }).map((curve) => curve.points.length);
const smooth = batten.bat_mesh_refine(mesh, { scheme: "loop", boundary: "corners", crease_angle: 0.7 });
const volume: number = batten.bat_mesh_summarize(smooth).volume;
const fair: number = batten.bat_curve_fairness(line).bending;
const surface = batten.bat_surface_reconstruct([[0, 0, 0]], { parameters: "learned", tolerance: 0.1, trim: false });
const file: Uint8Array = batten.bat_surface_write(surface, { format: "step", unit: "m" });
const shell = batten.bat_shell_reconstruct(mesh, { tolerance: 1 });
const rows = batten.bat_choices("mesh_scheme").map(({ name }) => name.toUpperCase());
try { surface.free(); } catch (error) { if (error instanceof BattenError) console.log(error.remedy?.length, error.line); }
console.log(first, many, volume, fair, file, shell.closed, rows);
`;
    assert.deepEqual(check("right", script), []);
  });
  const MISTAKES = [
    "batten.bat_curve_refine(line, { levls: 3 });",
    'batten.bat_curve_refine(line, { levels: "3" });',
    'batten.bat_curve_refine(line, { scheme: "lerned" });',
    'batten.bat_mesh_refine(mesh, { scheme: "four-point" });',
    'batten.bat_mesh_refine(mesh, { boundary: "sharp" });',
    'batten.bat_surface_reconstruct([[0, 0, 0]], { parameters: "chord" });',
    'batten.bat_surface_write({ free() {} }, { format: "step" });',
    'batten.bat_mesh_write_memory(mesh, { format: "step" });',
    'batten.bat_choices("meshes");',
    "const text: string = batten.bat_mesh_summarize(mesh).volume;",
    "batten.bat_curve_fairness(line).bendng;",
    "batten.bat_curve_refine({ vertices: [] });",
  ];
  test("planted mistakes are told, each at its line", () => {
    const lines = check("wrong", head + MISTAKES.join("\n")).map((line) => Number(line.match(/\((\d+),/)[1]));
    const offset = head.split("\n").length;
    MISTAKES.forEach((text, i) => assert.ok(lines.includes(i + offset), text));
    assert.ok(lines.every((line) => line >= offset), "and nothing else");
  });
});
