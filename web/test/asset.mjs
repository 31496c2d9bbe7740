// A picture of a mesh and of the asset made of it, drawn by three.js in Chromium: the mesh, the asset's edges, the asset.
// Usage: node asset.mjs MESH.glb ASSET.glb OUT.png [VIEW [UP]], as 1,0,0.3 and 0,0,1; environment: CHROMIUM.
import { readFileSync, writeFileSync } from "node:fs";
import { dirname } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";
import puppeteer from "puppeteer-core";

const WIDTH = 480;
const HEIGHT = 640;
const PANELS = 3;
const [mesh, asset, out, view = "0.5,0.3,1", up = "0,1,0"] = process.argv.slice(2);
const folder = dirname(fileURLToPath(import.meta.url));

const scene = `
import * as three from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { RoomEnvironment } from "three/examples/jsm/environments/RoomEnvironment.js";

async function load(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  return (await new GLTFLoader().parseAsync(bytes.buffer, "")).scene;
}
const plain = (object) => object.traverse((part) => {
  if (part.isMesh && !part.material.map && !part.geometry.attributes.color) part.material = new three.MeshStandardMaterial({ color: 0xffffff, roughness: 1 });
});
const edges = (object) => object.traverse((part) => {
  if (part.isMesh) part.material = new three.MeshStandardMaterial({ color: 0x777777, wireframe: true });
});

window.draw = async (mesh, asset) => {
  const renderer = new three.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.setSize(${PANELS * WIDTH}, ${HEIGHT});
  renderer.toneMapping = three.ACESFilmicToneMapping;
  renderer.toneMappingExposure = 0.7;
  document.body.append(renderer.domElement);
  const light = new three.PMREMGenerator(renderer).fromScene(new RoomEnvironment()).texture;
  const objects = [await load(mesh), await load(asset), await load(asset)];
  plain(objects[0]);
  edges(objects[1]);
  const { center, radius } = new three.Box3().setFromObject(objects[0]).getBoundingSphere(new three.Sphere());
  const camera = new three.PerspectiveCamera(30, ${WIDTH / HEIGHT}, radius / 100, radius * 100);
  camera.up.set(${up});
  camera.position.copy(center).addScaledVector(new three.Vector3(${view}).normalize(), 3.9 * radius);
  camera.lookAt(center);
  renderer.setScissorTest(true);
  objects.forEach((object, i) => {
    const scene = new three.Scene();
    scene.background = new three.Color(0xffffff);
    scene.environment = light;
    const sun = new three.DirectionalLight(0xffffff, 1.5);
    sun.position.set(${view}).applyAxisAngle(camera.up, 1.2).add(camera.up);
    scene.add(object, sun);
    renderer.setViewport(i * ${WIDTH}, 0, ${WIDTH}, ${HEIGHT});
    renderer.setScissor(i * ${WIDTH}, 0, ${WIDTH}, ${HEIGHT});
    renderer.render(scene, camera);
  });
  return renderer.domElement.toDataURL("image/png");
};
`;
const { outputFiles } = await build({ stdin: { contents: scene, resolveDir: folder }, bundle: true, format: "iife", write: false, logLevel: "error" });
const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM,
  headless: true,
  timeout: 120000,
  protocolTimeout: 600000,
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
try {
  const page = await browser.newPage();
  page.on("pageerror", (error) => console.error(error.message));
  await page.setContent("<body></body>");
  await page.addScriptTag({ content: outputFiles[0].text });
  const url = await page.evaluate((a, b) => window.draw(a, b), ...[mesh, asset].map((file) => readFileSync(file).toString("base64")));
  writeFileSync(out, Buffer.from(url.slice(url.indexOf(",") + 1), "base64"));
} finally {
  await browser.close();
}
