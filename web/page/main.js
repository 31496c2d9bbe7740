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
/** Bytes of the longest link. */
const LINK_LIMIT = 60000;
/** Larger files are left out of the link. */
const FILE_LIMIT = 300000;

/** The engine as it lies in the page: compressed, in base64. The worker unpacks it. */
function packed(name) {
  const text = atob($(name).textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes.buffer;
}

const alertBox = $("alert");
const app = {
  /** What stands behind the script is there: the example of a map, the engine of scans. */
  async ready() {
    if (document.readyState === "loading") await new Promise((resolve) => document.addEventListener("DOMContentLoaded", resolve, { once: true }));
  },
  tables: null,
  engine: null,
  /** The page was opened by its bare address, and nothing is drawn yet. */
  opening: !location.hash,
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
    // The library names its own options, of which the page has few.
    alertBox.textContent = `batten: ${place ? `${place}: ` : ""}${error.text ?? error.message}${control ? `; “${control}” ${error.effect}` : ""}`;
  },
  /** Results clear the message; that of a broken link or file stays until the user does something. */
  clear(acted = false) {
    if (acted) kept = false;
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
  /** The view of the newest step changed: no step of undo, but a part of the link. */
  amend(tab, view) {
    const newest = JSON.parse(past[past.length - 1] ?? "null");
    if (newest?.tab !== tab || JSON.stringify(newest.state.view) === JSON.stringify(view)) return;
    newest.state.view = view;
    past[past.length - 1] = JSON.stringify(newest);
    void writeLink();
  },
  commands() {
    if (!tabs[current].commands) return;
    const commands = tabs[current].commands();
    for (const name of ["shell", "c", "python"]) $(name).textContent = commands[name];
  },
};

/** Files that were opened, by the numbers that states have for them: undo brings them back. */
const files = [];
app.keep = (name, bytes) => files.push({ name, bytes });
app.file = (number) => files[number - 1] ?? null;

let scans = null;
let laz = null;
let kept = false;
const past = [];
const future = [];
/** What a bare address shows first: a coarse mesh and its fine one under the slider. */
let current = "mesh";
const tabs = {};

function buttons() {
  $("undo").disabled = past.length < 2;
  $("redo").disabled = future.length === 0;
}

/** Restore the newest state; of several steps in a row the last one counts. */
async function step() {
  kept = false;
  buttons();
  const { tab, state } = JSON.parse(past[past.length - 1]);
  show(tab);
  await tabs[tab].restore(state).catch((error) => app.fail(error, app.file(state.data)?.name)); // a file that was not read
  void writeLink();
  app.commands();
}

const latin = (bytes) => {
  let text = "";
  for (let i = 0; i < bytes.length; i += 8192) text += String.fromCharCode(...bytes.subarray(i, i + 8192));
  return text;
};
const toBase64 = (bytes) => btoa(latin(bytes)).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
const through = async (stream, bytes) => new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());

/** The state as it stands in the link, with the file that it needs; null where that is too large. */
async function encoded() {
  const text = past[past.length - 1];
  if (!text) return null;
  const { tab, state } = JSON.parse(text);
  const file = state.data ? app.file(state.data) : null;
  if (state.data && (!file || file.bytes.length > FILE_LIMIT)) return null;
  const all = file ? JSON.stringify({ tab, state, file: { name: file.name, bytes: toBase64(file.bytes) } }) : text;
  const packed = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(all));
  return packed.length > LINK_LIMIT ? null : toBase64(packed);
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
  const fromBase64 = (text) => Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
  let bytes;
  try {
    bytes = await through(new DecompressionStream("deflate-raw"), fromBase64(hash.slice(2)));
  } catch {
    throw new Error("it is cut off or changed"); // browsers tell of a fetch here, where nothing is fetched
  }
  const { tab, state, file } = JSON.parse(new TextDecoder().decode(bytes));
  if (state.data) state.data = file ? app.keep(String(file.name), fromBase64(file.bytes)) : 0;
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
$("cancel").onclick = () => {
  app.engine.cancel();
  scans?.cancel();
  laz?.cancel();
};
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
  await openFiles([...event.dataTransfer.files]);
});

/** The tabs that may take a file, the likeliest first: by its ending and its first bytes. Null for what no tab reads. */
async function tabsFor(file) {
  const ending = file.name.toLowerCase().match(/\.[a-z0-9]+$/)?.[0] ?? "";
  const bytes = new Uint8Array(await file.slice(0, 200000).arrayBuffer());
  const text = new TextDecoder("latin1").decode(bytes);
  const rows = text.split(/\r?\n/).filter((line) => /^\s*[-+.\d]/.test(line));
  const columns = rows.slice(0, 20).map((line) => line.trim().split(/[\s,;]+/).filter((word) => word !== "").length);
  const wide = (count) => columns.length > 0 && columns.every((number) => number === count);
  if (/^(.PNG|%PDF|GIF8|PK\x03\x04|\xff\xd8\xff|\x1f\x8b)/.test(text) && ending !== ".3mf") return null;
  if ([".pcd", ".las", ".laz", ".xyz", ".asc"].includes(ending)) return ["scan"];
  if ([".stl", ".off", ".gltf", ".glb"].includes(ending)) return ["mesh"];
  if (ending === ".ply") return /element face [1-9]/.test(text) ? ["mesh"] : ["scan"];
  if (ending === ".obj") {
    // Faces may come far behind the points.
    const all = /^f /m.test(text) || file.size <= bytes.length ? text : new TextDecoder("latin1").decode(await file.arrayBuffer());
    return /^f /m.test(all) ? ["mesh"] : /^l /m.test(all) ? ["curve"] : ["scan"];
  }
  if (/^\.(geo|topo)?json$/.test(ending) || [".topojson", ".geojsonl"].includes(ending)) return current === "curve" ? ["curve", "map"] : ["map", "curve"];
  if (ending === ".gpx" || ending === ".wkt") return ["curve"];
  if (ending === ".tum" || /space: rigid/.test(text) || /\bq[wxyz]\b/.test(text.slice(0, 500))) return ["motion"];
  if (ending === ".txt" && wide(8)) return ["motion"];
  if ([".csv", ".txt", ".tsv"].includes(ending)) return (wide(3) && rows.length > 300) || wide(6) ? ["scan", "curve"] : wide(8) ? ["motion", "curve"] : ["curve", "motion", "scan"];
  return text.includes("\0") ? null : [current, ...["curve", "map", "mesh", "scan"].filter((name) => name !== current)].filter((name) => tabs[name].open);
}

/** Open a file in the tab that it belongs to. What no tab reads is told, and the page stays as it is. */
async function openFile(file, names) {
  kept = false;
  app.clear();
  if (names === null) {
    app.fail(new Error("this page reads lines, maps, poses, meshes and points: CSV, GeoJSON, GPX, TUM, OBJ, PLY, OFF, STL, glTF, XYZ, PCD, LAS, LAZ"), file.name);
    kept = true;
    return null;
  }
  const before = current;
  let told = "";
  for (const name of names) {
    show(name);
    if (await tabs[name].open(file)) return name;
    told ||= alertBox.textContent;
  }
  show(before);
  alertBox.textContent = told;
  kept = told !== "";
  return null;
}

/** Open files, each in its tab, and show the first. A tab holds one file; the others are told. */
async function openFiles(list) {
  const chosen = await Promise.all(list.map(tabsFor));
  const opened = new Map();
  const told = [];
  for (const [i, file] of list.entries()) {
    const other = opened.get(chosen[i]?.[0]);
    if (other) {
      told.push(`batten: ${file.name}: not opened, because the tab ${$(`tab-${chosen[i][0]}`).textContent} shows one file, now ${other}`);
      continue;
    }
    const name = await openFile(file, chosen[i]);
    if (name) opened.set(name, opened.get(name) ?? file.name);
    else told.push(alertBox.textContent);
  }
  if (list.length < 2) return;
  kept = false;
  if (opened.size > 0) show([...opened.keys()][0]);
  alertBox.textContent = told.join("\n");
  kept = told.length > 0;
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
  const busy = (title, fraction) => {
    $("progress").hidden = title === null;
    $("working").textContent = title ?? "";
    $("bar").value = fraction ?? 0;
  };
  app.engine = new Engine($("worker").textContent, packed("engine"), busy);
  /** The engine of scans, which stands at the end of the page and may still be on its way. */
  app.scanEngine = async () => {
    await app.ready();
    return (scans ??= new Engine($("worker").textContent, packed("engine-scan"), busy));
  };
  /** LAS of the bytes of compressed LAS. */
  app.expand = async (bytes) => {
    await app.ready();
    laz ??= new Engine($("laz").textContent, packed("engine-laz"), busy);
    return laz.call("expand", { bytes }, "Decompressing");
  };
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
    if ((await readLink()) === null && !location.hash.slice(1)) show(current);
    else if (!tabs[current].section.hidden) void 0;
  } catch (error) {
    show(current);
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
