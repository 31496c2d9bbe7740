// The page in Chromium: opened from disk, by mouse, touch and keyboard.
// Environment: BATTEN, SOURCE; CHROMIUM; PAGE, the file of the page; SHOTS, a folder for screenshots (optional), which are
// compared with those of docs/images/web.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { createHash } from "node:crypto";
import { gzipSync } from "node:zlib";
import puppeteer from "puppeteer-core";

const { SOURCE: source, CHROMIUM: chromium, PAGE: file, SHOTS: shots } = process.env;
const program = resolve(process.env.BATTEN); // some commands run in another folder
/** Screenshots are compared by the mean colours of square blocks, so that fonts and smoothing hardly count. */
const BLOCK = 20;
const BLOCKS_THAT_DIFFER = 0.05;
const MAX_DIFFERENCE = 16;
const TABS = ["curve", "map", "motion", "mesh", "analyze", "scan"];
const data = (name) => join(source, "examples/data", name);
/** The limit of what the first view needs, compressed, in bytes. The engine of scans follows behind it. */
const FIRST_VIEW = 1.5e6;
/** No motion of the page's own. */
const STILL = { name: "prefers-reduced-motion", value: "reduce" };
const WAIT = { timeout: 120000, polling: 50 };

let browser;
let page;
let folder;
const requests = [];
const complaints = [];

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "batten-page-"));
  browser = await puppeteer.launch({
    executablePath: chromium,
    headless: true,
    timeout: 120000,
    protocolTimeout: 240000,
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
  page = await browser.newPage();
  page.setDefaultNavigationTimeout(120000);
  await page.setViewport({ width: 1280, height: 900 });
  await page.emulateMediaFeatures([STILL]);
  page.on("request", (request) => requests.push(request.url()));
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("console", (message) => {
    if (["error", "warn", "warning"].includes(message.type()) && !/GPU stall|swiftshader|WebGL/i.test(message.text())) complaints.push(message.text());
  });
  await open();
});
after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

async function open(hash = "#curve") {
  await page.goto("about:blank");
  await page.goto(pathToFileURL(file).href + hash, { waitUntil: "domcontentloaded", timeout: 120000 });
  await page.waitForFunction("window.batten", WAIT);
}
const tab = async (name) => {
  await page.click(`#tab-${name}`);
  await page.waitForFunction(
    (which) => {
      const { result, results } = window.batten.tabs[which].inspect();
      return which === "scan" || result || results?.length;
    },
    WAIT,
    name,
  );
};
const inspect = (expression) => page.evaluate(`(() => { const { state, results, result, given, view } = window.batten.tabs[window.batten.current()].inspect(); return ${expression}; })()`);
/** Wait until an expression of the current tab's state holds; it may throw as long as a part of it is missing. */
const until = (expression) =>
  page
    .waitForFunction(`(() => { const { state, results, result, given, view } = window.batten.tabs[window.batten.current()].inspect(); try { return ${expression}; } catch { return false; } })()`, WAIT)
    .catch(async (error) => assert.fail(`${expression} did not hold: ${error.message}; ${await inspect("JSON.stringify({ ...state, points: undefined })")} ${await alertText()}`));
/** The share of blocks in which two pictures, PNG in base64, differ visibly; 1 for pictures of two sizes. */
const difference = (a, b) =>
  page.evaluate(
    async (files, block, most) => {
      const pictures = await Promise.all(
        files.map(async (file) => {
          const picture = new Image();
          picture.src = `data:image/png;base64,${file}`;
          await picture.decode();
          const canvas = document.createElement("canvas");
          [canvas.width, canvas.height] = [Math.ceil(picture.width / block), Math.ceil(picture.height / block)];
          const context = canvas.getContext("2d");
          context.imageSmoothingQuality = "high";
          context.drawImage(picture, 0, 0, canvas.width, canvas.height);
          return { size: `${picture.width} ${picture.height}`, colours: context.getImageData(0, 0, canvas.width, canvas.height).data };
        }),
      );
      const [one, two] = pictures;
      if (one.size !== two.size) return 1;
      let count = 0;
      for (let i = 0; i < one.colours.length; i += 4) count += [0, 1, 2].some((c) => Math.abs(one.colours[i + c] - two.colours[i + c]) > most);
      return (4 * count) / one.colours.length;
    },
    [a, b],
    BLOCK,
    MAX_DIFFERENCE,
  );
/** Choose in a list of the current tab, by its label. */
const choose = (label, value) =>
  page.evaluate(
    (title, chosen) => {
      const box = [...document.querySelectorAll(`#${window.batten.current()} label`)].find((one) => one.textContent.startsWith(title)).querySelector("select");
      box.value = chosen;
      box.dispatchEvent(new Event("change"));
    },
    label,
    value,
  );
const focus = (point) => page.$eval(`#curve .stage svg circle:nth-of-type(${point})`, (circle) => circle.focus());
const alertText = () => page.$eval("#alert", (box) => box.textContent);

/** Drop a file onto the page. */
async function drop(path, text) {
  const name = path.split("/").pop();
  const bytes = [...(text === undefined ? readFileSync(path) : Buffer.from(text))];
  await page.evaluate(
    (fileName, content) => {
      const transfer = new DataTransfer();
      transfer.items.add(new File([new Uint8Array(content)], fileName));
      document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
    },
    name,
    bytes,
  );
}

test("the page is one file, whose first view is small", () => {
  const text = readFileSync(file, "utf8");
  const size = gzipSync(text.slice(0, text.indexOf('<script id="map-example"')), { level: 9 }).length;
  assert.ok(size < FIRST_VIEW, `${size} bytes`);
  assert.doesNotMatch(text.replace(/<script[\s\S]*<\/script>/g, ""), /(?:src|href)="(?!data:|#)/);
});

test("the policy names what runs by its hash", () => {
  const text = readFileSync(file, "utf8");
  const policy = text.match(/Content-Security-Policy" content="([^"]*)"/)[1];
  assert.doesNotMatch(policy, /unsafe-inline|'unsafe-eval'|\*/);
  const hash = (content) => `'sha256-${createHash("sha256").update(content).digest("base64")}'`;
  assert.ok(policy.includes(hash(text.match(/<style>([\s\S]*?)<\/style>/)[1])));
  assert.ok(policy.includes(hash(text.match(/<script>([\s\S]*?)<\/script>/)[1])));
  assert.match(text, /property="og:image" content="[^"]*preview\.png"/);
});

test("a bare address shows a mesh under a slider, which moves by itself where motion is allowed", async () => {
  await open("");
  await until('window.batten.current() === "mesh" && result?.summary.faces > 10 * result.before.faces');
  const share = () => page.$eval("#mesh .divide", (slider) => Number(slider.value));
  assert.equal(await share(), 50);
  await page.emulateMediaFeatures([{ name: STILL.name, value: "no-preference" }]);
  const { identifier } = await page.evaluateOnNewDocument(() => {
    window.widest = 0;
    const watch = () => {
      window.widest = Math.max(window.widest, Number(document.querySelector("#mesh .divide")?.value ?? 0));
      requestAnimationFrame(watch);
    };
    requestAnimationFrame(watch);
  });
  await open("");
  await page.waitForFunction("window.widest > 60", WAIT);
  await page.waitForFunction(() => Number(document.querySelector("#mesh .divide").value) === 50, WAIT);
  await page.removeScriptToEvaluateOnNewDocument(identifier);
  await page.emulateMediaFeatures([STILL]);
  await open();
});

test("without WebGL there are figures, and words instead of the picture", async () => {
  const { identifier } = await page.evaluateOnNewDocument(() => {
    const before = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
      return /webgl/.test(kind) ? null : before.call(this, kind, ...more);
    };
  });
  await open("#mesh");
  await until("result?.summary.faces > 0");
  assert.match(await page.$eval("#mesh .stage", (box) => box.textContent), /WebGL is off or missing/);
  assert.match(await page.$eval("#mesh table", (box) => box.textContent), /15360/);
  await page.removeScriptToEvaluateOnNewDocument(identifier);
  await open();
});

test("the first curve equals the native one", async () => {
  const out = join(folder, "outline.csv");
  execFileSync(program, ["curve", data("outline.csv"), "--scheme", "four-point", "--levels", "5", "-o", out]);
  await until("results.length === 2");
  const ours = await inspect('[...results.find((one) => one.scheme === "four-point").points]');
  const theirs = readFileSync(out, "utf8").split("\n").filter((line) => /^[-\d.]/.test(line)).flatMap((line) => line.split(",").map(Number));
  assert.equal(ours.length, theirs.length);
  ours.forEach((value, i) => assert.ok(Math.abs(value - theirs[i]) < 1e-12 * 50));
});

test("a dragged point moves the curve; undo and redo take it back and forth", async () => {
  const stage = await (await page.$("#curve .stage svg")).boundingBox();
  const [x, y] = await inspect("view[0]");
  const given = await inspect("[...state.points[0]]");
  await page.mouse.move(stage.x + x, stage.y + y);
  await page.mouse.down();
  await page.mouse.move(stage.x + x + 40, stage.y + y - 25, { steps: 5 });
  await page.mouse.up();
  const moved = await inspect("[...state.points[0]]");
  assert.notDeepEqual(moved, given);
  await until(`Math.abs(results[0].points[0] - ${moved[0]}) < 1e-9`);
  await page.click("#undo");
  await until(`state.points[0][0] === ${given[0]}`);
  await page.keyboard.down("Control");
  await page.keyboard.press("y");
  await page.keyboard.up("Control");
  await until(`state.points[0][0] === ${moved[0]}`);
  await page.click("#undo");
  await until(`state.points[0][0] === ${given[0]}`);
});

test("keys move, add, mark and remove a point", async () => {
  const count = await inspect("state.points.length");
  await focus(3);
  const before = await inspect("state.points[2][0]");
  await page.keyboard.press("ArrowRight");
  await until(`state.points[2][0] > ${before}`);
  await page.keyboard.press("a");
  await until(`state.points.length === ${count + 1}`);
  await focus(4);
  await page.keyboard.press("c");
  await until("state.corners.includes(3)");
  await page.keyboard.press("Delete");
  await until(`state.points.length === ${count} && state.corners.length === 0`);
});

test("touch drags a point", async () => {
  const stage = await (await page.$("#curve .stage svg")).boundingBox();
  const [x, y] = await inspect("view[5]");
  const before = await inspect("[...state.points[5]]");
  await page.touchscreen.touchStart(stage.x + x, stage.y + y);
  await page.touchscreen.touchMove(stage.x + x + 30, stage.y + y + 10);
  await page.touchscreen.touchEnd();
  await until(`state.points[5][0] !== ${before[0]}`);
});

test("schemes, spaces and the comb", async () => {
  for (const space of ["sphere", "disk", "plane"]) {
    await page.evaluate((name) => {
      const box = [...document.querySelectorAll("#curve select")].find((one) => [...one.options].some((option) => option.value === "disk"));
      box.value = name;
      box.dispatchEvent(new Event("change"));
    }, space);
    await until(`state.space === "${space}" && results.some((one) => one.scheme.startsWith("learned") && one.points)`);
  }
  const boxes = await page.$$("#curve .schemes input");
  const before = await inspect("state.schemes.length");
  await boxes[1].click();
  await until(`results.length === ${before + 1}`);
  await page.evaluate(() => [...document.querySelectorAll("#curve .check")].find((label) => label.textContent === "Curvature comb").click());
  await until("state.comb");
  assert.equal(await alertText(), "");
});

test("a link restores the state", async () => {
  await page.waitForFunction("location.hash.startsWith('#s=')", WAIT);
  await new Promise((resolve) => setTimeout(resolve, 500));
  const [hash, state] = await page.evaluate(() => [location.hash, JSON.stringify(window.batten.tabs.curve.state())]);
  await open(hash);
  assert.equal(await page.evaluate(() => JSON.stringify(window.batten.tabs.curve.state())), state);
  await open("#s=broken");
  assert.match(await alertText(), /the link cannot be read/);
  await open();
});

test("good and broken files", async () => {
  await drop(data("coast.geojson"));
  await until('state.space === "sphere" && state.points.length > 200 && results[0].points');
  await drop("broken.csv", "x,y\n0,0\n1,oops\n2,3\n");
  await page.waitForFunction(() => /broken\.csv:3: /.test(document.getElementById("alert").textContent), WAIT);
  await drop("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  await tab("mesh");
  await drop("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  await page.waitForFunction(() => /broken\.obj:4: /.test(document.getElementById("alert").textContent), WAIT);
  const cage = join(folder, "cage.ply");
  execFileSync(program, ["shape", "cage", "-o", cage]);
  await drop(cage);
  await until("result.before.vertices === 162");
  assert.equal(await alertText(), "");
  // Polygons stay polygons, and so do the edges that are drawn.
  const cube = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  await drop("cube.obj", cube);
  await until('result.before.faces === 6 && result.scheme === "catmull-clark"');
  assert.equal(await inspect("result.summary.faces"), 6 * 4 ** (await inspect("state.levels")));
  const commands = () => page.evaluate(() => window.batten.tabs.mesh.commands());
  assert.match((await commands()).python, /PolygonMesh\.read\("cube\.obj"\)/);
  writeFileSync(join(folder, "cube.obj"), cube);
  const [verb, ...words] = (await commands()).shell.replace("batten ", "").split(" ");
  execFileSync(program, [verb, ...words, "--quiet"], { cwd: folder });
  const theirs = readFileSync(join(folder, "fine.obj"), "utf8").split("\n").filter((line) => line.startsWith("v ")).flatMap((line) => line.split(" ").slice(1).map(Number));
  const ours = await inspect("[...result.fine.positions]");
  assert.equal(ours.length, theirs.length);
  ours.forEach((value, i) => assert.ok(Math.abs(value - theirs[i]) < 1e-12));
  await choose("Scheme", "loop");
  await until("result.triangulated && result.summary.faces === 12 * 4 ** state.levels");
  assert.match((await commands()).shell, /--triangulate/);
  assert.match((await commands()).c, /read\.triangulate = true/);
  await choose("Scheme", "auto");
  await tab("map");
  await drop("broken.geojson", '{"type":"FeatureCollection",\n"features":[}');
  await page.waitForFunction(() => /broken\.geojson:2: /.test(document.getElementById("alert").textContent), WAIT);
});

test("a file goes to its tab, from any tab", async () => {
  const scan = join(folder, "hull.xyz");
  execFileSync(program, ["shape", "hull", "--vertices", "1200", "-o", scan]);
  const shown = () => page.evaluate("window.batten.current()");
  await tab("analyze");
  await drop(scan);
  await page.waitForFunction('window.batten.current() === "scan" && window.batten.tabs.scan.inspect().state.data > 0', WAIT);
  const cube = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  for (const [name, text, where] of [
    ["body.obj", cube, "mesh"],
    ["line.wkt", "LINESTRING (0 0, 2 1, 4 0, 5 3)", "curve"],
    ["poses.txt", Array.from({ length: 5 }, (_, i) => `${i} ${i} ${i * i} 0 0 0 0 1`).join("\n"), "motion"],
    ["map.json", readFileSync(data("coast.geojson"), "utf8"), "map"],
    ["points.ply", `ply\nformat ascii 1.0\nelement vertex 400\nproperty double x\nproperty double y\nproperty double z\nend_header\n${Array.from({ length: 400 }, (_, i) => `${i % 20} ${Math.floor(i / 20)} ${(i % 20) ** 2 / 40}`).join("\n")}\n`, "scan"],
  ]) {
    await tab("analyze");
    await drop(name, text);
    await page.waitForFunction((tabName) => window.batten.current() === tabName && document.getElementById("progress").hidden, WAIT, where);
    await page.waitForFunction(() => document.getElementById("alert").textContent === "", WAIT);
  }
  // What no tab reads is told in words, and the page stays.
  const before = await page.evaluate("JSON.stringify([window.batten.current(), window.batten.tabs.scan.state()])");
  await drop("photo.dat", "\x89PNG\r\n\x1a\n\0\0");
  await page.waitForFunction(() => /photo\.dat: this page reads lines, maps/.test(document.getElementById("alert").textContent), WAIT);
  await drop("bad.xyz", "0 0 0\n1 1\n");
  await page.waitForFunction(() => /bad\.xyz:2: /.test(document.getElementById("alert").textContent), WAIT);
  assert.equal(await page.evaluate("JSON.stringify([window.batten.current(), window.batten.tabs.scan.state()])"), before);
  // Undo brings back the file that was open before.
  assert.equal(await shown(), "scan");
  const second = await inspect("state.data");
  for (let steps = 0; steps < 40; steps++) {
    await page.click("#undo");
    await new Promise((resolve) => setTimeout(resolve, 100));
    await page.waitForFunction(() => document.getElementById("progress").hidden, WAIT);
    if ((await page.evaluate("window.batten.tabs.scan.state().data")) !== second) break;
  }
  assert.equal(await page.evaluate("window.batten.app.file(window.batten.tabs.scan.state().data).name"), "hull.xyz");
});

test("a scan becomes the program's surface", async () => {
  const scan = join(folder, "side.xyz");
  execFileSync(program, ["shape", "hull", "--vertices", "1500", "--seed", "4", "-o", scan]);
  await tab("scan");
  await drop(scan);
  await page.waitForFunction((name) => window.batten.tabs.scan.commands().shell.includes(name) && document.getElementById("progress").hidden, WAIT, "side.xyz");
  const out = join(folder, "side.json");
  const [verb, ...words] = (await page.evaluate("window.batten.tabs.scan.commands()")).shell.replace("batten ", "").split(" ");
  execFileSync(program, [verb, ...words.map((word) => (word === "surface.step" ? "side.json" : word)), "--quiet"], { cwd: folder });
  const ours = await page.evaluate(async () => new TextDecoder().decode(await (await window.batten.app.scanEngine()).call("writeScan", { format: "json" })));
  const numbers = (text) => text.match(/[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?/g).map(Number);
  const [mine, theirs] = [numbers(ours), numbers(readFileSync(out, "utf8"))];
  assert.equal(mine.length, theirs.length);
  const size = theirs.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  mine.forEach((value, i) => assert.ok(Math.abs(value - theirs[i]) <= 1e-6 * size));
  assert.match(await page.$eval("#scan .verdict", (box) => box.textContent), /^Right/);
});

test("before and after, by the keyboard", async () => {
  for (const name of ["map", "mesh", "scan"]) {
    await tab(name);
    await page.focus(`#${name} .divide`);
    const line = () => page.$eval(`#${name} .divider`, (box) => box.getBoundingClientRect().left);
    const before = await line();
    for (let i = 0; i < 10; i++) await page.keyboard.press("ArrowRight");
    assert.ok((await line()) > before + 20, name);
    for (let i = 0; i < 10; i++) await page.keyboard.press("ArrowLeft");
  }
});

test("the C of every tab compiles", async () => {
  const lines = [];
  for (const name of TABS) lines.push(`static void ${name}_tab(void)\n{\n${(await page.evaluate((key) => window.batten.tabs[key].commands().c, name)).replaceAll("…", "0")}\n}`);
  const path = join(folder, "tabs.c");
  writeFileSync(path, `#include "batten/batten.h"\n#include "batten/research/curve_analysis.h"\n#include <stdio.h>\n${lines.join("\n")}\nint main(void)\n{\n${TABS.map((name) => `${name}_tab();`).join("\n")}\nreturn 0;\n}\n`);
  const built = join(program, "../include");
  execFileSync("gcc", ["-std=c11", "-fsyntax-only", "-Werror=incompatible-pointer-types", `-I${join(source, "include")}`, `-I${join(source, "research/include")}`, `-I${built}`, path], { stdio: "pipe" });
});

test("a large file can be cancelled", async () => {
  await tab("curve");
  const n = 100000;
  const rows = Array.from({ length: n }, (_, i) => {
    const t = (2 * Math.PI * i) / n;
    return `${((1 + 0.1 * Math.sin(40 * t)) * Math.cos(t)).toFixed(6)},${((1 + 0.1 * Math.sin(40 * t)) * Math.sin(t)).toFixed(6)}`;
  });
  const path = join(folder, "large.csv");
  writeFileSync(path, `# closed\nx,y\n${rows.join("\n")}\n`);
  // By the file chooser: a hundred thousand points are too many for an argument of a call.
  const input = await page.$("#curve input[type=file]");
  // The bar without delay, and a click when it first names the refinement: on a fast machine the work is done before a call of
  // this test gets there.
  await page.evaluate(() => {
    const engine = window.batten.app.engine;
    const bar = document.getElementById("progress");
    engine.delay = 0;
    window.cancelled = false;
    new MutationObserver((_, observer) => {
      if (bar.hidden || document.getElementById("working").textContent !== "Refining") return;
      observer.disconnect();
      engine.delay = 300;
      window.cancelled = true;
      document.getElementById("cancel").click();
    }).observe(bar, { attributes: true, childList: true, subtree: true });
  });
  await input.uploadFile(path);
  await page.waitForFunction(() => window.cancelled && document.getElementById("progress").hidden, WAIT);
  assert.ok((await inspect("results.every((one) => !one.points || one.points.length < 200000)")));
  // The network takes seconds for so many points, and minutes on a busy machine.
  await page.evaluate(() => {
    for (const label of document.querySelectorAll("#curve .schemes label")) if (label.querySelector("input").checked !== (label.textContent === "four-point")) label.click();
  });
  await until('state.schemes.join() === "four-point"');
  await input.uploadFile(path);
  await until("results.length === 1 && results[0].points && results[0].points.length >= 200000");
});

test("every tab, both themes, wide and narrow: nothing overflows, and axe finds nothing serious", async () => {
  const axe = readFileSync(new URL("../node_modules/axe-core/axe.min.js", import.meta.url), "utf8");
  const different = [];
  await open();
  for (const theme of ["light", "dark"])
    for (const width of [1280, 360]) {
      await page.setViewport({ width, height: width > 500 ? 900 : 780 });
      await page.emulateMediaFeatures([STILL, { name: "prefers-color-scheme", value: theme }]);
      if ((await page.evaluate(() => document.documentElement.dataset.theme)) !== theme) await page.click("#theme");
      for (const name of TABS) {
        await tab(name);
        await page.waitForFunction((which) => ((made) => made.result || made.results?.length)(window.batten.tabs[which].inspect()) && document.getElementById("progress").hidden, WAIT, name);
        await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
        assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= width, `${name} overflows ${width} pixels`);
        assert.ok((await page.$eval("#shell", (box) => box.textContent)).includes("batten"), `${name} has no command`);
        // The stage is not empty.
        assert.ok(
            await page.evaluate((which) => {
              const canvas = document.querySelector(`#${which} canvas`);
              const copy = document.createElement("canvas");
              [copy.width, copy.height] = [canvas.width, canvas.height];
              const context = copy.getContext("2d");
              context.drawImage(canvas, 0, 0);
              return context.getImageData(0, 0, copy.width, copy.height).data.some((value, i) => i % 4 === 3 && value > 0);
            }, name),
            `${name} draws nothing`,
          );
        const picture = await page.screenshot({ encoding: "base64" });
        const title = `${name}-${theme}-${width}.png`;
        if (shots) {
          mkdirSync(shots, { recursive: true });
          writeFileSync(join(shots, title), picture, "base64");
        }
        const share = await difference(picture, readFileSync(join(source, "docs/images/web", title), "base64"));
        if (share > BLOCKS_THAT_DIFFER) different.push(`${title}: ${(100 * share).toFixed(1)} % of the blocks`);
        // Each theme in one width: colours do not depend on the width, and a run takes seconds.
        if ((theme === "light") !== width > 500) continue;
        if (!(await page.evaluate("Boolean(window.axe)"))) await page.evaluate(axe);
        const { violations } = await page.evaluate(() => window.axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"] }));
        const serious = violations.filter(({ impact }) => ["serious", "critical"].includes(impact));
        assert.deepEqual(serious.map(({ id, nodes }) => `${name} ${theme} ${width}: ${id}: ${nodes[0].html.slice(0, 120)}`), []);
      }
    }
  assert.deepEqual(different, [], "the page looks otherwise than in docs/images/web; if it should, take the pictures of SHOTS");
});

test("no request left, nothing was complained of", () => {
  assert.deepEqual(requests.filter((address) => !/^(file:|blob:|data:|about:)/.test(address)), []);
  assert.equal(new Set(requests.filter((address) => address.startsWith("file:")).map((address) => address.split("#")[0])).size, 1);
  assert.deepEqual(complaints, []);
});
