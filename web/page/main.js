// The page: tabs, the state with undo and redo, the link, the theme, files, commands.
import { Engine, Cancelled } from "./engine.js";
import { h } from "./dom.js";
import { curveTab } from "./curve.js";
import { mapTab } from "./map.js";
import { motionTab } from "./motion.js";
import { meshTab } from "./mesh.js";
import { analyzeTab } from "./analyze.js";
import { scanTab } from "./scan.js";

const $ = (id) => document.getElementById(id);
/** Texts of a state that is longer than this are left out of the link. */
const LINK_LIMIT = 60000;

function binary() {
  const text = atob($("engine").textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes.buffer;
}

const alertBox = $("alert");
const app = {
  tables: null,
  engine: null,
  say(text) {
    $("said").textContent = text;
  },
  /** Tell a failure as the program does: file:line: what. `controls` has the labels of options that may lead out. */
  fail(error, file, controls = {}) {
    if (error instanceof Cancelled) {
      if (error.message === "cancelled") app.say("Cancelled");
      return;
    }
    const place = [file, error.line].filter((part) => part).join(":");
    const control = controls[error.remedy];
    alertBox.textContent = `batten: ${place ? `${place}: ` : ""}${control ? `${error.text}; “${control}” ${error.effect}` : error.message}`;
  },
  /** Results clear the message; that of a broken link stays until the user does something. */
  clear() {
    if (!kept) alertBox.textContent = "";
  },
  /** The state of the current tab changed for good: a step of undo. */
  commit() {
    const text = JSON.stringify({ tab: current, state: tabs[current].state() });
    if (text === past[past.length - 1]) return;
    past.push(text);
    if (past.length > 200) past.shift();
    future.length = 0;
    buttons();
    void writeLink();
    app.commands();
  },
  commands() {
    if (!tabs[current].commands) return;
    const commands = tabs[current].commands();
    for (const name of ["shell", "c", "python"]) $(name).textContent = commands[name];
  },
};

let kept = false;
const past = [];
const future = [];
let current = "curve";
const tabs = {};

function buttons() {
  $("undo").disabled = past.length < 2;
  $("redo").disabled = future.length === 0;
}

/** Restore the newest state; of several steps in a row the last one counts. */
async function step() {
  buttons();
  const { tab, state } = JSON.parse(past[past.length - 1]);
  show(tab);
  await tabs[tab].restore(state);
  void writeLink();
  app.commands();
}

const toBase64 = (bytes) => btoa(String.fromCharCode(...bytes)).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
const through = async (stream, bytes) => new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());

async function encoded() {
  const text = past[past.length - 1];
  if (!text || text.length > LINK_LIMIT) return null;
  return toBase64(await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(text)));
}

let written = "";
async function writeLink() {
  const code = await encoded();
  written = code === null ? `#${current}` : `#s=${code}`;
  try {
    history.replaceState(null, "", written);
  } catch {
    // Some browsers allow no history for files; the link is copied all the same.
  }
}

async function readLink() {
  const hash = location.hash.slice(1);
  if (tabs[hash]) {
    show(hash);
    return null;
  }
  if (!hash.startsWith("s=")) return null;
  const code = atob(hash.slice(2).replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = await through(new DecompressionStream("deflate-raw"), Uint8Array.from(code, (letter) => letter.charCodeAt(0)));
  const { tab, state } = JSON.parse(new TextDecoder().decode(bytes));
  if (!tabs[tab]) throw new Error("the link names no tab of this page");
  show(tab);
  await tabs[tab].restore(state);
  return tab;
}

function show(name) {
  current = name;
  for (const [key, tab] of Object.entries(tabs)) {
    tab.section.hidden = key !== name;
    const button = $(`tab-${key}`);
    button.setAttribute("aria-selected", String(key === name));
    button.tabIndex = key === name ? 0 : -1;
  }
  app.clear();
  tabs[name].show?.();
  app.commands();
}

function makeTabs(list) {
  for (const [name, title, make] of list) {
    const section = h("section", { id: name, role: "tabpanel", "aria-labelledby": `tab-${name}`, hidden: true });
    const tab = make(app, section);
    tabs[name] = Object.assign(tab, { section });
    const button = h("button", { id: `tab-${name}`, type: "button", role: "tab", "aria-controls": name, onclick: () => choose(name) }, title);
    $("tabs").append(button);
    $("main").append(section);
  }
  $("tabs").addEventListener("keydown", (event) => {
    const names = list.map(([name]) => name);
    const at = names.indexOf(current);
    const next = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: names.length - 1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    const name = names[(next + names.length) % names.length];
    choose(name);
    $(`tab-${name}`).focus();
  });
}

function choose(name) {
  kept = false;
  show(name);
  app.commit();
}

function theme(name) {
  document.documentElement.dataset.theme = name;
  $("theme").textContent = name === "dark" ? "Light" : "Dark";
  for (const tab of Object.values(tabs)) tab.redraw?.();
}

$("undo").onclick = () => {
  if (past.length < 2) return;
  future.push(past.pop());
  void step();
};
$("redo").onclick = () => {
  if (future.length === 0) return;
  past.push(future.pop());
  void step();
};
$("link").onclick = async () => {
  const code = await encoded();
  if (code === null) {
    app.fail(new Error("the data are too large for a link; download the result instead"));
    return;
  }
  const address = `${location.href.split("#")[0]}#s=${code}`;
  try {
    await navigator.clipboard.writeText(address);
  } catch {
    location.hash = `s=${code}`;
  }
  $("link").textContent = "Copied";
  app.say("Link copied");
  setTimeout(() => ($("link").textContent = "Copy link"), 1500);
};
$("theme").onclick = () => theme(document.documentElement.dataset.theme === "dark" ? "light" : "dark");
$("cancel").onclick = () => app.engine.cancel();
for (const button of document.querySelectorAll("[data-copy]"))
  button.onclick = async () => {
    await navigator.clipboard.writeText($(button.dataset.copy).textContent).catch(() => {
      getSelection().selectAllChildren($(button.dataset.copy));
    });
    button.textContent = "Copied";
    setTimeout(() => (button.textContent = "Copy"), 1500);
  };

document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || /^(INPUT|TEXTAREA)$/.test(event.target.tagName) && event.target.type !== "range" && event.target.type !== "checkbox") return;
  const key = event.key.toLowerCase();
  if (key === "z" && !event.shiftKey) {
    event.preventDefault();
    $("undo").click();
  } else if (key === "y" || (key === "z" && event.shiftKey)) {
    event.preventDefault();
    $("redo").click();
  }
});

let depth = 0;
addEventListener("dragenter", (event) => {
  event.preventDefault();
  depth++;
  $("drop").hidden = false;
});
addEventListener("dragleave", () => {
  if (--depth <= 0) $("drop").hidden = true;
});
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", async (event) => {
  event.preventDefault();
  depth = 0;
  $("drop").hidden = true;
  const file = event.dataTransfer.files[0];
  if (file) await openFile(file);
});

/** Open a file in the current tab, or in the one that its ending names. */
async function openFile(file) {
  kept = false;
  app.clear();
  const ending = file.name.toLowerCase().match(/\.[a-z0-9]+$/)?.[0] ?? "";
  if (/^\.(ply|stl|off|gltf|glb)$/.test(ending)) show("mesh");
  else if (ending === ".obj" && current !== "curve") show("mesh");
  else if (/^\.(geo)?json$/.test(ending) && current !== "curve") show("map");
  else if (ending === ".csv" && !["curve", "motion"].includes(current)) show("curve");
  if (!tabs[current].open) show("curve");
  await tabs[current].open(file);
}

let resizing = 0;
addEventListener("resize", () => {
  cancelAnimationFrame(resizing);
  resizing = requestAnimationFrame(() => tabs[current].redraw?.());
});
addEventListener("hashchange", () => {
  if (location.hash !== written) readLink().catch((error) => app.fail(error));
});

async function start() {
  app.engine = new Engine($("worker").textContent, binary(), (title, fraction) => {
    $("progress").hidden = title === null;
    $("working").textContent = title ?? "";
    $("bar").value = fraction ?? 0;
  });
  app.tables = await app.engine.call("tables", {});
  $("version").textContent = app.tables.version;
  makeTabs([
    ["curve", "Curve", curveTab],
    ["map", "Map", mapTab],
    ["motion", "Motion", motionTab],
    ["mesh", "Mesh", meshTab],
    ["analyze", "Analyze", analyzeTab],
    ["scan", "Scan", scanTab],
  ]);
  theme(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
  try {
    if ((await readLink()) === null && !location.hash.slice(1)) show("curve");
    else if (!tabs[current].section.hidden) void 0;
  } catch (error) {
    show("curve");
    app.fail(new Error(`the link cannot be read: ${error.message}`));
    kept = true;
  }
  if (tabs[current].section.hidden) show(current);
  app.commit();
  buttons();
  // For tests: what the page shows, as numbers.
  window.batten = { app, tabs, current: () => current };
}

start().catch((error) => app.fail(error));
