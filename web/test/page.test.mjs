// The page in Chromium: opened from disk, by mouse, touch and keyboard.
// Environment: BATTEN, SOURCE; CHROMIUM; PAGE, the file of the page; BATTEN_PYTHON, a Python with the package,
// numpy, geopandas and shapely (optional); SHOTS, a folder for screenshots (optional), which are
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
/** Handles come with the next frame of a curve. */
const focus = async (point) => {
  await page.waitForFunction((most) => document.querySelectorAll("#curve .stage svg circle").length === most, WAIT, await inspect("state.points.length"));
  await page.$eval(`#curve .stage svg circle:nth-of-type(${point})`, (circle) => circle.focus());
};
const alertText = () => page.$eval("#alert", (box) => box.textContent);

/** Drop a file onto the page. */
const drop = (path, text) => dropAll([path, text]);
async function dropAll(...files) {
  await page.evaluate(
    (list) => {
      const transfer = new DataTransfer();
      for (const [name, content] of list) transfer.items.add(new File([new Uint8Array(content)], name));
      document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
    },
    files.map(([path, text]) => [path.split("/").pop(), [...(text === undefined ? readFileSync(path) : Buffer.from(text))]]),
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
  for (const broken of ["#s=broken", hash.slice(0, -9)]) {
    await open(broken);
    assert.equal(await alertText(), "batten: the link cannot be read: it is cut off or changed");
  }
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

/** A star of many points, on the plane or in degrees. */
const many = (count, names) => `${names}\n${Array.from({ length: count }, (_, i) => {
  const [r, t] = [10 + Math.sin((40 * Math.PI * i) / count), (2 * Math.PI * i) / count];
  return `${(r * Math.cos(t)).toFixed(5)},${(r * Math.sin(t)).toFixed(5)}`;
}).join("\n")}\n`;
/** Do what is a step of undo, and wait until the link tells it. */
const step = async (act) => {
  const link = await page.evaluate("location.hash");
  await act();
  await page.waitForFunction((before) => location.hash !== before, WAIT, link);
};
const idle = () => page.waitForFunction(() => document.getElementById("progress").hidden, WAIT);
const told = (pattern) => page.waitForFunction((source) => new RegExp(source).test(document.getElementById("alert").textContent), WAIT, pattern.source).catch(async () => assert.match(await alertText(), pattern));

test("a curve without a picture is told, and the last good one stays", async () => {
  await open();
  await until("results.length === 2 && results[0].points");
  const shown = () => inspect("JSON.stringify([state, results.map((one) => [one.scheme, one.points.length])])");
  const [before, link] = [await shown(), await page.evaluate("location.hash")];
  await drop("one.csv", "x,y\n1,2\n");
  await told(/^batten: one\.csv: an open curve needs at least 2 points, not 1$/);
  assert.equal(await shown(), before);
  await drop("same.csv", "# closed\nx,y\n0,0\n0,0\n0,0\n");
  await told(/^batten: same\.csv/);
  assert.equal(await shown(), before);
  assert.equal(await page.evaluate("location.hash"), link);
  assert.equal(await page.$eval("#undo", (button) => button.disabled), true);
  // A control that leads nowhere goes back too.
  await drop("two.csv", "x,y\n1,2\n3,4\n");
  await until("state.points.length === 2 && !state.closed && results[0].points.length === 66");
  await page.evaluate(() => [...document.querySelectorAll("#curve .check")].find((label) => label.textContent === "Closed").click());
  await told(/^batten: a closed curve needs at least 3 points, not 2$/);
  await until("state.closed === false && results[0].points.length > 4");
});

test("a large curve changes its space, and undo brings the file back", async () => {
  await open();
  await drop("many.csv", many(6000, "lon,lat"));
  await until('state.space === "sphere" && results[0].points.length > 18000');
  await page.waitForFunction(() => /^6000 points, dashed/.test(document.querySelector("#curve .legend").textContent), WAIT);
  const first = await inspect("[...results[0].points.slice(0, 3)].join()");
  const onPlane = 'state.space === "plane" && results[0].points[0] > 1.5 && results[0].points.length < 100000';
  await choose("Space", "plane");
  await until(onPlane);
  await choose("Space", "disk");
  await until('state.space === "disk" && results[0].points[0] < 0.71');
  assert.equal(await alertText(), "");
  await page.click("#undo");
  await until(onPlane);
  await page.click("#undo");
  await until(`state.space === "sphere" && [...results[0].points.slice(0, 3)].join() === "${first}"`);
  await page.click("#undo");
  await until('state.space === "plane" && state.points.length > 10');
  await page.click("#redo");
  await until(`state.space === "sphere" && [...results[0].points.slice(0, 3)].join() === "${first}"`);
});

test("until undo has read its file, the page stays as it is", async () => {
  /** Hold what reads a file back. */
  const hold = () =>
    page.evaluate(() => {
      const { engine } = window.batten.app;
      const { call } = engine;
      const held = [];
      engine.call = async function (job, ...more) {
        if (/^read/.test(job)) await new Promise((resolve) => held.push(resolve));
        return call.call(this, job, ...more);
      };
      window.release = () => {
        delete engine.call;
        held.forEach((resolve) => resolve());
      };
    });
  const release = () => page.evaluate("window.release()");
  const frames = () => page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(resolve)))));
  const before = complaints.length;

  await open("#motion");
  await until("result.points.length > 0");
  await step(() => drop("many.tum", Array.from({ length: 2500 }, (_, i) => `${i} ${Math.cos(i / 90).toFixed(4)} ${Math.sin(i / 70).toFixed(4)} 0 0 0 0 1\n`).join("")));
  await until("state.data > 0 && result.times.length > 1000");
  await page.$$eval("#motion button", (all) => all.find((one) => one.textContent === "Example").click());
  await until("state.keys.length === 8 && result.times.length < 1000");
  await idle();
  await hold();
  await page.click("#undo");
  await frames();
  assert.deepEqual(complaints.slice(before), []);
  assert.equal(await inspect("state.keys.length"), 8);
  await release();
  await until("state.data > 0 && result.times.length > 1000");

  await open();
  await step(() => drop("many.csv", many(6000, "x,y")));
  await until("state.data > 0 && results[0].points.length > 12000");
  await step(() => choose("Example", "star"));
  await until("state.points.length === 10 && results[0].points.length < 12000");
  await idle();
  await hold();
  await page.click("#undo");
  await frames();
  assert.equal(await inspect("state.points.length"), 10);
  await release();
  await until("state.data > 0 && results[0].points.length > 12000");

  // A later step counts, also while the file of an earlier one is read.
  await open("#mesh");
  await until("result");
  await step(() => drop("body.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"));
  await until("state.data > 0 && result.before.faces === 4");
  await step(() => choose("Example", "bracket"));
  await until('state.example === "bracket" && result.before.faces === 20');
  await idle();
  await hold();
  await page.click("#undo");
  await page.click("#redo");
  await until('state.example === "bracket"');
  await release();
  await frames();
  await idle();
  assert.equal(await inspect("`${state.example} ${result.before.faces}`"), "bracket 20");
  await page.click("#undo");
  await until("state.data > 0 && result.before.faces === 4");
  assert.deepEqual(complaints.slice(before), []);
});

test("a motion without a picture is told, and the last good one stays", async () => {
  await open("#motion");
  await until("result.points.length > 0");
  const shown = () => inspect("JSON.stringify(state)");
  const before = await shown();
  await drop("one.tum", "0 0 0 0 0 0 0 1\n");
  await told(/^batten: one\.tum: a motion needs at least 2 keyframes, not 1$/);
  assert.equal(await shown(), before);
  await drop("same.tum", "1 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n1 2 0 0 0 0 0 1\n");
  await told(/^batten: same\.tum/);
  assert.equal(await shown(), before);
  assert.equal(await page.$eval("#undo", (button) => button.disabled), true);
  assert.ok(!(await page.$eval("#motion svg", (svg) => svg.innerHTML)).includes("NaN"));
});

test("failures name controls of the page, and no options of the program", async () => {
  await open();
  for (const [name, text, pattern] of [
    ["nan.csv", "x,y\n0,0\nnan,0\n1,1\n2,0\n", /^batten: nan\.csv:3: column 1: 'nan' is not a number$/],
    ["utm.geojson", '{"type":"Polygon","coordinates":[[[500000,5000000],[500100,5000000],[500100,5000100],[500000,5000000]]]}', /^batten: utm\.geojson: ring 0, position 0: a latitude outside -90 to 90 degrees$/],
  ]) {
    await drop(name, text);
    await told(pattern);
  }
  // A remedy that the page has: its control by its name.
  await page.evaluate(() => window.batten.app.fail({ message: "no; the option scheme helps", text: "no", remedy: "scheme", effect: "helps" }, "a.obj", { scheme: "Scheme" }));
  assert.equal(await alertText(), "batten: a.obj: no; “Scheme” helps");
});

test("what is offered for download can be downloaded, and what cannot says why", async () => {
  const saved = [];
  await page.exposeFunction("onSaved", (name, size) => saved.push([name, size]));
  const { identifier } = await page.evaluateOnNewDocument(() => {
    const make = URL.createObjectURL;
    let last = null;
    URL.createObjectURL = (blob) => make.call(URL, (last = blob));
    HTMLAnchorElement.prototype.click = function () {
      window.onSaved(this.download, last.size);
    };
  });
  await open();
  const buttons = (name) => page.$$eval(`#${name} section[aria-label="Download"] button`, (all) => all.map(({ textContent, disabled, title }) => [textContent, disabled, title]));
  for (const [name, refused] of [["curve", { GeoJSON: /plane coordinates/, GPX: /longitude and latitude/ }], ["map", { GPX: /no polygons/ }], ["motion", {}], ["mesh", {}], ["scan", {}]]) {
    await tab(name);
    await page.waitForFunction((which) => ((made) => made.result || made.results?.length)(window.batten.tabs[which].inspect()) && document.getElementById("progress").hidden, WAIT, name);
    for (const [label, off, title] of await buttons(name)) {
      assert.equal(off, label in refused, `${name}: ${label}`);
      if (off) {
        assert.match(title, refused[label]);
        continue;
      }
      const before = saved.length;
      await page.evaluate(() => window.batten.app.fail(new Error("an old message")));
      await page.$$eval(`#${name} section[aria-label="Download"] button`, (all, text) => all.find((one) => one.textContent === text).click(), label);
      for (let i = 0; i < 200 && saved.length === before; i++) await new Promise((resolve) => setTimeout(resolve, 50));
      assert.ok(saved.length === before + 1 && saved.at(-1)[1] > 10, `${name}: ${label}: ${await alertText()}`);
      assert.equal(await alertText(), "");
    }
  }
  // On the sphere all formats are there.
  await tab("curve");
  await drop(data("coast.geojson"));
  await page.waitForFunction(() => window.batten.current() === "curve" && window.batten.tabs.curve.inspect().state.space === "sphere", WAIT);
  await page.waitForFunction(() => [...document.querySelectorAll('#curve section[aria-label="Download"] button')].every((button) => !button.disabled && !button.title), WAIT);
  await page.removeScriptToEvaluateOnNewDocument(identifier);
});

test("notes about a file stand beside the figures", async () => {
  await open();
  const square = (x, y) => `[[${x},${y}],[${x + 1},${y}],[${x + 1},${y}],[${x + 1},${y + 1}],[${x},${y}]]`;
  for (const [name, file, text, words] of [
    ["curve", "table.csv", "a;b\n0,5;1,5\n1,5;2,5\n3,0;1,0\n", "Decimal commas were read as points."],
    ["curve", "two.wkt", "LINESTRING (0 0, 2 1, 4 0, 5 3)\nLINESTRING (0 0, 2 1, 4 0)\n", "The longest of 2 curves of the file."],
    ["map", "doubled.geojson", `{"type":"MultiPolygon","coordinates":[[${square(0, 0)}],[${square(3, 0)}]]}`, "Dropped 2 repeated points"],
    ["mesh", "lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nl 1 2\n", "Statements that a mesh does not hold are left out: l."],
    ["motion", "millis.csv", "time_ms,tx,ty,tz,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1000,1,0,0,1,0,0,0\n2000,2,1,0,1,0,0,0\n", "Times in milliseconds"],
  ]) {
    await tab(name);
    await drop(file, text);
    await page.waitForFunction((which, part) => window.batten.current() === which && [...document.querySelectorAll(`#${which} .note`)].some((box) => box.textContent.startsWith(part)), WAIT, name, words)
      .catch(async () => assert.fail(`${file}: ${await page.$eval(`#${name}`, (box) => [...box.querySelectorAll(".note")].map((one) => one.textContent).join("|"))} ${await alertText()}`));
  }
  // They go with their file.
  await page.$$eval("#motion button", (all) => all.find((one) => one.textContent === "Example").click());
  await page.waitForFunction(() => !document.querySelector("#motion .note"), WAIT);
  await page.click("#undo");
  await page.waitForFunction(() => document.querySelector("#motion .note"), WAIT);
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
  await until(`result.points.length === ${3 * readFileSync(scan, "utf8").match(/^[-\d]/gm).length}`);
  await idle();
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

test("compressed LAS is read as LAS", async () => {
  await tab("scan");
  const truth = Array.from({ length: 400 }, (_, i) => {
    const [x, y] = [(i % 20) / 20 + 0.01 * Math.sin(7 * i), Math.floor(i / 20) / 20 + 0.01 * Math.cos(5 * i)];
    return [500000 + x, 5400000 + y, 0.3 * Math.sin(2 * x) * Math.cos(1.7 * y)];
  }).flat();
  // Records of LAS 1.2, then of 1.4. Points 400 and 401 are noise by their classes.
  for (const name of ["scan-3.laz", "scan-6.laz"]) {
    await drop(join(source, "web/test", name));
    await page.waitForFunction((which) => window.batten.tabs.scan.commands().shell.includes(which) && document.getElementById("progress").hidden, WAIT, name);
    await until(`result.points.length === 1200 && window.batten.app.file(state.data)?.name === "${name}"`);
    const points = Object.values(await inspect("[...result.points]"));
    points.forEach((value, i) => assert.ok(Math.abs(value - truth[i]) < 1.2e-4, `${name}: ${i}: ${value}, not ${truth[i]}`));
    const { shell, python } = await page.evaluate("window.batten.tabs.scan.commands()");
    const plain = name.replace("laz", "las");
    assert.ok(shell.startsWith(`laszip -i ${name} -o ${plain}\nbatten surface ${plain} `), shell);
    assert.match(python, new RegExp(`^points = batten\\.read_points\\("${name}"\\)$`, "m"));
    // A file that is cut off is told in one line, and the last good one stays.
    const content = readFileSync(join(source, "web/test", name));
    for (const size of [content.length - 200, 1500, 300]) {
      await drop("cut.laz", content.subarray(0, size));
      await told(/^batten: cut\.laz: the file is damaged: (its compressed points cannot be read|point \d+ of 402 cannot be decompressed)$/);
      assert.equal(await inspect("window.batten.app.file(state.data).name"), name);
      await drop("no.bin", "\0");
      await told(/^batten: no\.bin: this page reads /);
    }
  }
});

test("a scan tells doubts, holes and gaps in words", async () => {
  const grid = Array.from({ length: 1500 }, (_, i) => {
    const [x, y] = [(i % 50) / 25 - 1 + 0.01 * Math.sin(7 * i), Math.floor(i / 50) / 22 - 0.7 + 0.01 * Math.cos(5 * i)];
    return [x, y, 0.3 * Math.sin(2 * x) * Math.cos(1.7 * y)];
  });
  const put = async (name, points) => {
    await drop(name, points.map((p) => p.map((value) => value.toFixed(6)).join(" ")).join("\n"));
    await until(`result.points.length === ${3 * points.length}`);
    await idle();
  };
  const told = () => page.$eval("#scan .verdict", (box) => `${box.className}: ${box.textContent}`);
  await tab("scan");
  await put("stray.xyz", [...grid, [0.1, 0.1, 0.9]]);
  assert.match(await told(), /^verdict doubt: Right, but a point lies far off and bends it, which robust weights prevent, by up to 0\.7\d*, near 0\.1 0\.1 0\.9\. 99 of 100 points are within /);
  // A scan with a hole is trimmed without being asked.
  await put("hole.xyz", grid.filter(([x, y]) => Math.hypot(x - 0.1, y) > 0.3));
  assert.match(await told(), /^verdict good: Right: /);
  assert.match(await page.$eval("#scan table", (box) => box.textContent), /hole0\.[67]\d* across/);
  assert.match((await page.evaluate("window.batten.tabs.scan.commands()")).shell, /^batten surface hole\.xyz --trim /);
  await choose("Surface", "patch");
  await page.waitForFunction(() => /“Surface: trimmed patch” cuts the holes out$/.test(document.getElementById("alert").textContent), WAIT);
  await choose("Surface", "auto");
  await idle();
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

/** Python that runs a script: BATTEN_PYTHON, which has the package and those of maps; without it the grammar is checked. */
function runPython(script, where) {
  writeFileSync(join(where, "script.py"), script);
  const python = process.env.BATTEN_PYTHON;
  if (python) execFileSync(python, ["script.py"], { cwd: where, stdio: "pipe" });
  else execFileSync("python3", ["-c", "compile(open('script.py').read(), 'script.py', 'exec')"], { cwd: where, stdio: "pipe" });
}
/** Run what the current tab shows in a folder with the user's file. Gives the texts. */
async function runShown(where) {
  const { shell, c, python } = await page.evaluate(() => window.batten.tabs[window.batten.current()].commands());
  for (const text of [shell, c, python]) assert.doesNotMatch(text, /…|\.\.\./);
  execFileSync("sh", ["-ec", shell], { cwd: where, stdio: "pipe", env: { ...process.env, PATH: `${join(program, "..")}:${process.env.PATH}` } });
  runPython(python, where);
  writeFileSync(join(where, "shown.c"), `#include "batten/batten.h"\n#include <stdio.h>\nint main(void)\n{\n${c}\nreturn 0;\n}\n`);
  execFileSync("gcc", ["-std=c11", "-fsyntax-only", "-Wall", "-Werror", `-I${join(source, "include")}`, `-I${join(program, "../include")}`, "shown.c"], { cwd: where, stdio: "pipe" });
  return { shell, c, python };
}

test("a motion of many keyframes is drawn with some marks", async () => {
  const where = mkdtempSync(join(folder, "motion-"));
  const flight = (count) => Array.from({ length: count }, (_, i) => `${(i / 20).toFixed(2)} ${(9 * Math.cos(i / 90)).toFixed(4)} ${(9 * Math.sin(i / 70)).toFixed(4)} ${(i / 900).toFixed(4)} 0 0 ${Math.sin(i / 180).toFixed(9)} ${Math.cos(i / 180).toFixed(9)}\n`).join("");
  await open("#motion");
  await until("result.points.length > 0");
  const input = await page.$("#motion input[type=file]");
  const put = async (count) => {
    writeFileSync(join(where, `flight${count}.tum`), flight(count));
    await input.uploadFile(join(where, `flight${count}.tum`));
    await page.waitForFunction((words) => document.querySelector("#motion table").textContent.includes(words) && document.getElementById("progress").hidden, WAIT, `keyframes${count}`).catch(async () => assert.fail(await alertText()));
  };
  await put(100000);
  await put(6000);
  await page.waitForFunction(() => document.querySelectorAll("#motion svg circle").length === 120, WAIT);
  await runShown(where);
  // Undo and the link bring the file back, and the example its handles.
  await page.$$eval("#motion button", (all) => all.find((one) => one.textContent === "Example").click());
  await until("state.keys.length > 2");
  await page.waitForFunction(() => document.querySelectorAll("#motion svg circle[tabindex]").length === document.querySelectorAll("#motion svg circle").length, WAIT);
  await page.click("#undo");
  await page.waitForFunction(() => document.querySelector("#motion table").textContent.includes("keyframes6000"), WAIT);
  writeFileSync(join(where, "more.tum"), flight(100001));
  await input.uploadFile(join(where, "more.tum"));
  await told(/^batten: more\.tum: 100001 keyframes are too many for this page/);
  await page.waitForFunction(() => document.querySelector("#motion table").textContent.includes("keyframes6000"), WAIT);
});

test("the link of a map has its view", async () => {
  await open("#map");
  await until("result.fine.length > 0");
  const stage = await (await page.$("#map .stage")).boundingBox();
  await page.mouse.move(stage.x + 300, stage.y + 200);
  for (let i = 0; i < 5; i++) await page.mouse.wheel({ deltaY: -200 });
  await until("state.view?.[0] === Number(view[0].toPrecision(6)) && view[0] > 2");
  await new Promise((resolve) => setTimeout(resolve, 800));
  const before = await page.evaluate("location.hash");
  await page.focus("#map .divide");
  for (let i = 0; i < 7; i++) await page.keyboard.press("ArrowRight");
  await until("view[3] === 57 && state.view[3] === 57");
  await page.waitForFunction((old) => location.hash !== old, WAIT, before);
  const [hash, view] = [await page.evaluate("location.hash"), await inspect("view")];
  assert.equal(await page.$eval("#undo", (button) => button.disabled), true);
  await open(hash);
  await until("result && view[0] > 2");
  (await inspect("view")).forEach((value, i) => assert.ok(Math.abs(value - view[i]) < 1e-3 * (1 + Math.abs(view[i])), `${i}: ${value} for ${view[i]}`));
  // A step of undo leaves the view of the same map where it is.
  await choose("Scheme", "angle-4");
  await until('state.scheme === "angle-4" && result');
  await idle();
  await page.click("#undo");
  await until('state.scheme === "learned"');
  assert.ok((await inspect("view[0]")) > 2);
});

test("stencils fit a narrow page", async () => {
  await page.setViewport({ width: 390, height: 844 });
  await open("#analyze");
  await until("result");
  await page.waitForFunction(() => ((box) => box && box.querySelector("table") && box.scrollWidth <= box.clientWidth)(document.querySelector("#analyze .column section .scroll")), WAIT).catch(async () => assert.fail(await page.$eval("#analyze .column section .scroll", (box) => `${box.scrollWidth} in ${box.clientWidth}`)));
  await page.setViewport({ width: 1280, height: 900 });
  await open();
});

test("several files go to their tabs, and what finds no place is told", async () => {
  await open();
  await until("results.length === 2");
  const cube = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  await dropAll(["a.csv", "x,y\n0,0\n1,1\n2,0\n"], ["body.obj", cube], ["b.csv", "x,y\n0,0\n5,5\n2,0\n"], ["photo.dat", "\0\0"]);
  await told(/^batten: b\.csv: not opened, because the tab Curve shows one file, now a\.csv\nbatten: photo\.dat: this page reads/);
  assert.equal(await page.evaluate("window.batten.current()"), "curve");
  assert.equal(await inspect("JSON.stringify(state.points)"), "[[0,0],[1,1],[2,0]]");
  await tab("mesh");
  assert.equal(await inspect("result.before.faces"), 4);
  // The message stays until the user does something.
  await drop("photo.dat", "\0\0");
  await told(/^batten: photo\.dat: this page reads/);
  await page.click("#undo");
  await page.waitForFunction(() => document.getElementById("alert").textContent === "", WAIT);
});

test("what is shown of curves, maps and scans runs, and reads the user's file", async () => {
  const where = mkdtempSync(join(folder, "shown-"));
  await open();
  for (const [name, title] of [["star", "10 points in the code"], ["letter", "corners"], ["coast", "a file from the command line"], ["petals", "the disk"]]) {
    await choose("Example", name);
    await until(`results[0].points && JSON.stringify(state.points).length > 20`);
    await idle();
    const { shell, python } = await runShown(where);
    assert.match(shell, /^cat > curve\.csv/, title);
    if (name === "star") assert.equal(python.match(/\[-?[\d.]+, -?[\d.]+\]/g).length, 10);
    if (name === "coast") assert.match(python, /from_lonlat/);
  }
  const put = async (tabName, name, text, test = "true") => {
    writeFileSync(join(where, name), text);
    const input = await page.$(`#${tabName} input[type=file]`);
    await input.uploadFile(join(where, name));
    await page.waitForFunction((which, file) => window.batten.tabs[which].commands().shell.includes(file) && document.getElementById("progress").hidden, WAIT, tabName, name).catch(async () => assert.fail(`${name}: ${await alertText()}`));
    await until(test);
    const shown = await runShown(where);
    for (const text of Object.values(shown)) assert.ok(text.includes(name), `${name}: ${text}`);
    return shown;
  };
  const rows = Array.from({ length: 90 }, (_, i) => [i / 9, Math.sin(i / 9)].map((value) => value.toFixed(4)));
  await put("curve", "my track.csv", `lat;lon\n${rows.map(([x, y]) => `${y};${x}`).join("\n")}\n`, 'state.space === "sphere"');
  await put("curve", "large.csv", many(6000, "x,y"), "results[0].points.length > 12000");
  await put("curve", "coast.geojson", readFileSync(data("coast.geojson")), "state.points.length > 100");
  await put("curve", "lines.wkt", `LINESTRING (0 0, 1 1)\nLINESTRING (${rows.map((row) => row.join(" ")).join(", ")})\n`, "state.points.length === 90");
  // An edited file is written anew.
  await focus(3);
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => window.batten.tabs.curve.commands().shell.startsWith("cat > curve.csv"), WAIT);
  await runShown(where);
  await tab("map");
  await idle();
  await put("map", "plane.wkt", "POLYGON ((0 0, 1000 0, 1000 1000, 0 1000, 0 0))\nPOLYGON ((1000 0, 2000 0, 2000 1000, 1000 1000, 1000 0))\n", 'result.space === "plane"');
  await put("map", "land.geojson", readFileSync(data("coast.geojson")), 'result.space === "sphere"');
  await tab("scan");
  const grid = Array.from({ length: 900 }, (_, i) => [(i % 30) / 30, Math.floor(i / 30) / 30, ((i % 30) * Math.floor(i / 30)) / 900]);
  await put("scan", "scan.csv", `id,x,y,z\n${grid.map((p, i) => [i, ...p].join(",")).join("\n")}\n`, "result.points.length === 2700");
  await put("scan", "vertices.obj", grid.map((p) => `v ${p.join(" ")}`).join("\n"), "result.points.length === 2700");
  await put("scan", "plain.xyz", `# x y z\n${grid.map((p) => p.join(" ")).join("\n")}\n`, "result.points.length === 2700");
});

test("the C of every tab compiles", async () => {
  const lines = [];
  for (const name of TABS) lines.push(`static void ${name}_tab(void)\n{\n${(await page.evaluate((key) => window.batten.tabs[key].commands().c, name))}\n}`);
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
  const cancelled = async () => {
    await idle();
    const shown = () => inspect("JSON.stringify([state, results.map((one) => [one.scheme, one.points.length])])");
    const before = await shown();
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
    await page.waitForFunction(() => window.cancelled && document.getElementById("progress").hidden && document.getElementById("said").textContent === "Cancelled", WAIT);
    assert.equal(await shown(), before);
    assert.equal(await alertText(), "");
  };
  const fourPoint = () =>
    page.evaluate(() => {
      for (const label of document.querySelectorAll("#curve .schemes label")) if (label.querySelector("input").checked !== (label.textContent === "four-point")) label.click();
    });
  // The last good curve stays, also in another space than that of the file.
  await choose("Example", "coast");
  const drawn = (dimension) => `results.length === 1 && results[0].points.length === ${dimension} * state.points.length * 2 ** state.levels`;
  await until(`state.space === "sphere" && ${drawn(3)}`);
  await cancelled();
  await fourPoint();
  await told(/a linear scheme needs a Euclidean space, not the sphere/);
  await choose("Example", "guitar");
  await until(`state.space === "plane" && ${drawn(2)}`);
  await cancelled();
  // The network takes seconds for so many points, and minutes on a busy machine.
  await fourPoint();
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
        assert.equal(await page.$eval(`#${name} select`, (box) => getComputedStyle(box).colorScheme), theme);
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
