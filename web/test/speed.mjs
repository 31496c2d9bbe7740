// The page's speed in Chromium, each as a share of its limit: opening until the first curve is drawn (1 second), and a frame of
// dragging a point of 100 by the learned scheme, 5 levels (8 milliseconds). Shares below 1 are within the limit.
// Environment: CHROMIUM, PAGE as of page.test.mjs.
import { pathToFileURL } from "node:url";
import puppeteer from "puppeteer-core";

const { CHROMIUM: executablePath, PAGE: file } = process.env;
const OPENING = 1000;
const FRAME = 8;
const browser = await puppeteer.launch({ executablePath, headless: true, args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
const page = await browser.newPage();
await page.setViewport({ width: 1280, height: 900 });

let opening = Infinity;
for (let round = 0; round < 5; round++) {
  await page.goto("about:blank");
  await page.goto(`${pathToFileURL(file).href}#curve`, { waitUntil: "domcontentloaded" });
  // Milliseconds since the page was opened, once the curve is on the canvas.
  const time = await page.evaluate(
    () =>
      new Promise((resolve) => {
        const look = () => {
          if (window.batten?.tabs.curve.inspect().results.length > 0) requestAnimationFrame(() => requestAnimationFrame(() => resolve(performance.now())));
          else setTimeout(look, 1);
        };
        look();
      }),
  );
  opening = Math.min(opening, time);
}

const frames = await page.evaluate(async () => {
  const { tabs } = window.batten;
  const points = Array.from({ length: 100 }, (_, i) => [1 + 0.1 * Math.sin((14 * Math.PI * i) / 100), (2 * Math.PI * i) / 100]).map(([r, t]) => [r * Math.cos(t), r * Math.sin(t)]);
  await tabs.curve.restore({ ...tabs.curve.state(), points, schemes: ["learned"], levels: 5 });
  const times = [];
  for (let i = 0; i < 60; i++) times.push(await tabs.curve.drag(0, [1 + 0.001 * i, 0]));
  return times.sort((a, b) => a - b);
});
console.log(`opening until the first curve is drawn: ${(opening / OPENING).toFixed(2)} of the limit`);
console.log(`dragging a point of 100, learned, 5 levels: ${(frames[0] / FRAME).toFixed(2)} of the limit at best, ${(frames[30] / FRAME).toFixed(2)} in the median`);
await browser.close();
