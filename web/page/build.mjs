// Bundle the page into one file: node build.mjs WASM OUT.
import { build } from "esbuild";
import { gzipSync } from "node:zlib";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";

const here = import.meta.dirname ?? dirname(new URL(import.meta.url).pathname);
const root = resolve(here, "../..");
const [wasm, out] = process.argv.slice(2);
const read = (path) => readFileSync(join(root, path), "utf8");

/** Example data and pictures as one module. */
const samples = {
  name: "samples",
  setup({ onResolve, onLoad }) {
    onResolve({ filter: /^samples$/ }, () => ({ path: "samples", namespace: "samples" }));
    onLoad({ filter: /.*/, namespace: "samples" }, () => {
      const files = ["outline.csv", "quarter-arc.csv", "coast.geojson", "iss-track.geojson", "hyperbolic.csv", "camera-keyframes.csv"];
      const all = Object.fromEntries(files.map((name) => [name, read(`examples/data/${name}`)]));
      all["scan.png"] = `data:image/png;base64,${readFileSync(join(here, "scan.png")).toString("base64")}`;
      return { contents: JSON.stringify(all), loader: "json" };
    });
  },
};
async function bundle(entry, format) {
  const result = await build({
    entryPoints: [join(here, entry)],
    bundle: true,
    minify: true,
    write: false,
    format,
    target: ["chrome110", "firefox110", "safari16.4"],
    charset: "utf8",
    legalComments: "none",
    logLevel: "warning",
    plugins: [samples],
  });
  return result.outputFiles[0].text;
}
const inScript = (code) => code.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
const parts = {
  STYLE: readFileSync(join(here, "style.css"), "utf8"),
  ENGINE: readFileSync(wasm).toString("base64"),
  WORKER: inScript(await bundle("worker.js", "iife")),
  MAP: read("examples/data/map.geojson"),
  MAIN: inScript(await bundle("main.js", "iife")),
};
let page = readFileSync(join(here, "index.html"), "utf8");
for (const [name, text] of Object.entries(parts)) page = page.replace(`/*${name}*/`, () => text);
mkdirSync(dirname(out), { recursive: true });
writeFileSync(out, page);
console.log(`${out}: ${(page.length / 1e6).toFixed(2)} MB, ${(gzipSync(page, { level: 9 }).length / 1e6).toFixed(2)} MB compressed`);
