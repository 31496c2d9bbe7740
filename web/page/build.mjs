// Bundle the page into one file: node build.mjs ENGINES OUT. ENGINES is a folder with batten.wasm, page.wasm and scan.wasm.
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { deflateRawSync, gzipSync } from "node:zlib";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { instantiate } from "../npm/engine.mjs";

const here = import.meta.dirname ?? dirname(new URL(import.meta.url).pathname);
const root = resolve(here, "../..");
const [engines, out] = process.argv.slice(2);
const read = (path) => readFileSync(join(root, path), "utf8");

/** The licence of laz-perf, on every Debian. */
const APACHE = "/usr/share/common-licenses/Apache-2.0";

const choices = (await instantiate(readFileSync(join(engines, "batten.wasm")))).bat_choices();

/** Example data and pictures as one module. */
const samples = {
  name: "samples",
  setup({ onResolve, onLoad }) {
    onResolve({ filter: /^samples$/ }, () => ({ path: "samples", namespace: "samples" }));
    onLoad({ filter: /.*/, namespace: "samples" }, () => {
      const files = ["outline.csv", "quarter-arc.csv", "coast.geojson", "iss-track.geojson", "hyperbolic.csv", "camera-keyframes.csv"];
      const all = Object.fromEntries(files.map((name) => [name, read(`examples/data/${name}`)]));
      // What the engine of scans takes: it comes behind all else.
      all.tables = { cloud_format: choices.cloud_format, surface_parameters: choices.surface_parameters };
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
const packedFile = (path) => deflateRawSync(readFileSync(path), { level: 9 }).toString("base64");
const packed = (name) => packedFile(join(engines, `${name}.wasm`));
writeFileSync(join(root, "web/npm/packed.mjs"), `export default "${packed("batten")}";\n`);
const parts = {
  STYLE: readFileSync(join(here, "style.css"), "utf8"),
  ENGINE: packed("page"),
  SCAN: packed("scan"),
  LAZ: inScript(await bundle("laz.js", "iife")),
  LASZIP: packedFile(join(root, "web/node_modules/laz-perf/lib/worker/laz-perf.wasm")),
  WORKER: inScript(await bundle("worker.js", "iife")),
  NOTICES: `${read("web/npm/NOTICES")}== laz-perf\n\n${readFileSync(APACHE, "utf8")}`.replaceAll("</script", ""),
  MAP: read("examples/data/map.geojson"),
  MAIN: inScript(await bundle("main.js", "iife")),
};
let page = readFileSync(join(here, "index.html"), "utf8");
for (const [name, text] of Object.entries(parts)) page = page.replace(`/*${name}*/`, () => text);
// The policy names what may run by its hash.
const hash = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
page = page.replace("SCRIPT_HASH", hash(parts.MAIN)).replace("STYLE_HASH", hash(parts.STYLE));
// Previews of links need a whole address: PAGE_URL, where the page is published.
const address = process.env.PAGE_URL ?? "";
page = page.replaceAll("PAGE_URL", address && !address.endsWith("/") ? `${address}/` : address);
mkdirSync(dirname(out), { recursive: true });
writeFileSync(out, page);
writeFileSync(join(dirname(out), "preview.png"), readFileSync(join(root, "docs/images/web/mesh-light-1280.png")));
// The first view needs no more than what stands before the example of a map.
const first = page.slice(0, page.indexOf('<script id="map-example"'));
console.log(`first view: ${(gzipSync(first, { level: 9 }).length / 1e6).toFixed(2)} MB compressed`);
console.log(`${out}: ${(page.length / 1e6).toFixed(2)} MB, ${(gzipSync(page, { level: 9 }).length / 1e6).toFixed(2)} MB compressed`);
