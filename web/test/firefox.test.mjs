// The page in Firefox: every tab draws, by clicks and keys as a person would.
// Environment: FIREFOX; PAGE, the file of the page. WebGL needs a display, which web/test/run makes.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import puppeteer from "puppeteer-core";

const { FIREFOX: firefox, PAGE: file } = process.env;
const WAIT = { timeout: 60000, polling: 100 };
const complaints = [];
let browser;
let page;

before(async () => {
  const extraPrefsFirefox = { "webgl.force-enabled": true };
  browser = await puppeteer.launch({ browser: "firefox", executablePath: firefox, headless: false, timeout: 120000, protocolTimeout: 240000, extraPrefsFirefox });
  page = await browser.newPage();
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  await page.setViewport({ width: 1280, height: 900 });
  await page.goto(pathToFileURL(file).href, { timeout: 120000 });
  await page.waitForFunction("window.batten", WAIT);
});
after(() => browser?.close());

const inspect = (expression) => page.evaluate(`(() => { const { state, results, result, view } = window.batten.tabs[window.batten.current()].inspect(); return ${expression}; })()`);
const until = (expression) =>
  page.waitForFunction(`(() => { const { state, results, result, view } = window.batten.tabs[window.batten.current()].inspect(); return ${expression}; })()`, WAIT);
/** Colours on the canvas of the current tab: an empty one has one. */
const colours = () =>
  page.evaluate(() => {
    const canvas = document.querySelector(`#${window.batten.current()} .stage canvas`);
    const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
    const context = copy.getContext("2d");
    context.drawImage(canvas, 0, 0);
    return new Set(new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer)).size;
  });

test("the page opens with a mesh", async () => {
  await until("result?.summary.faces === 15360");
  await page.waitForFunction(() => document.querySelector("#mesh .divide").value === "50", WAIT);
});

for (const name of ["mesh", "curve", "map", "motion", "analyze", "scan"])
  test(`${name} draws and has its commands`, async () => {
    await page.click(`#tab-${name}`);
    await until("Boolean(result || results?.length) && document.getElementById('progress').hidden");
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    assert.ok((await colours()) > 20, "the stage is empty");
    assert.match(await page.$eval("#shell", (box) => box.textContent), /batten/);
    assert.equal(await page.$eval("#alert", (box) => box.textContent), "");
  });

test("a point is dragged, moved by keys, and undone", async () => {
  await page.click("#tab-curve");
  const given = await inspect("[...state.points[0]]");
  const stage = await (await page.$("#curve .stage svg")).boundingBox();
  const [x, y] = await inspect("view[0]");
  await page.mouse.move(stage.x + x, stage.y + y);
  await page.mouse.down();
  await page.mouse.move(stage.x + x + 30, stage.y + y - 20, { steps: 4 });
  await page.mouse.up();
  await until(`state.points[0][0] !== ${given[0]}`);
  await page.click("#undo");
  await until(`state.points[0][0] === ${given[0]}`);
  await page.$eval("#curve .stage svg circle", (circle) => circle.focus());
  await page.keyboard.press("ArrowRight");
  await until(`state.points[0][0] > ${given[0]}`);
});

test("a file of the user's is refined, and a picture is told in words", async () => {
  const give = (name, bytes) =>
    page.evaluate(
      (title, content) => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([new Uint8Array(content)], title));
        document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
      },
      name,
      [...bytes],
    );
  await give("square.obj", Buffer.from("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"));
  await page.waitForFunction(() => window.batten.current() === "mesh" && window.batten.tabs.mesh.inspect().result.summary.faces === 32, WAIT);
  await give("photo.png", Buffer.from("\x89PNG\r\n\x1a\n", "latin1"));
  await page.waitForFunction(() => /photo\.png.*this page reads/.test(document.getElementById("alert").textContent), WAIT);
  assert.equal(await inspect("result.summary.faces"), 32);
});

test("nothing was complained of", () => assert.deepEqual(complaints, []));
