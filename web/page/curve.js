// Curves: points on the plane, the sphere and the disk, refined by several schemes at once.
import samples from "samples";
import { check, color, digits, download, downloads, enumerator, formatOf, group, h, notes, opener, select, sized, slider, table } from "./dom.js";
import { MAX_LITERAL, imports, layoutOf, loadtxt, longestIn, quoted, shellName } from "./code.js";
import { VIEWS, toDegrees, toUnit } from "./view.js";

/** More points than this get no handles. */
const MAX_HANDLES = 400;
/** Curves of more points are shown as their file has them, and not edited. */
const MAX_EDITED = 5000;
const HIT = 22;

const csvPoints = (text) =>
  text
    .split("\n")
    .filter((line) => /^[-\d.]/.test(line))
    .map((line) => line.split(",").map(Number));
const lonLat = (text) => {
  const { type, coordinates } = JSON.parse(text).features[0].geometry;
  const line = type === "LineString" ? coordinates : type === "Polygon" ? coordinates[0] : coordinates[0][0];
  return line.slice(0, -1).map(([x, y]) => [x, y]);
};
const star = Array.from({ length: 10 }, (_, i) => {
  const [r, t] = [i % 2 ? 0.42 : 1, (Math.PI * (i + 2.5)) / 5];
  return [Number((r * Math.cos(t)).toFixed(4)), Number((r * Math.sin(t)).toFixed(4))];
});
const letter = [[0, 0], [2.2, 0], [3.3, 0.5], [3.5, 1.4], [3.1, 2.1], [2.6, 2.3], [3.0, 2.7], [3.2, 3.3], [2.9, 4.1], [2.0, 4.5], [0, 4.5]];
const EXAMPLES = {
  guitar: { title: "Guitar (plane)", space: "plane", closed: true, points: csvPoints(samples["outline.csv"]) },
  letter: { title: "Letter B (plane, corners)", space: "plane", closed: true, points: letter, corners: [0, 5, 10] },
  star: { title: "Star (plane)", space: "plane", closed: true, points: star },
  arc: { title: "Quarter arc (plane, open)", space: "plane", closed: false, points: csvPoints(samples["quarter-arc.csv"]) },
  coast: { title: "Coast of Iceland (sphere)", space: "sphere", closed: true, points: lonLat(samples["coast.geojson"]) },
  iss: { title: "ISS track (sphere)", space: "sphere", closed: true, points: lonLat(samples["iss-track.geojson"]) },
  petals: { title: "Petals (Poincaré disk)", space: "disk", closed: true, points: csvPoints(samples["hyperbolic.csv"]) },
};
const FIRST = { points: EXAMPLES.guitar.points, space: "plane", closed: true, corners: [], schemes: ["learned", "four-point"], fairness: 0.25, levels: 5, ends: "reflect", comb: false, data: 0, notes: [], file: null };

/** What a scheme needs beyond its name. */
const SETTINGS = { mask: "mask:1/8,4/8,6/8,4/8,1/8", "corner-cutting": "corner-cutting:r=0.25,s=0.75", angle: "angle:mu=-0.1" };

const FORMATS = [["csv"], ["geojson", "GeoJSON"], ["wkt"], ["gpx"], ["topojson", "TopoJSON"], ["obj"]];
/** The controls of options that lead out of failures. */
const CONTROLS = { levels: "Levels" };

/** Linear schemes that other spaces refuse. */
const PLANE = ["four-point", "six-point", "mask"];

export function curveTab(app, section) {
  let state = structuredClone(FIRST);
  let view = new VIEWS.plane();
  let results = [];
  let given = null;
  let combs = [];
  let held = -1;
  let big = null; // the points of a file that is too large to edit
  let source = null; // that file as it was read: number, space, points
  let good = { state: structuredClone(state), big, source }; // the last that gave a picture
  let wanted = null; // the state that undo or a link asks for, until its file is read
  let drawn = false;
  let working = Promise.resolve(null);
  let opening; // the name of a file that has no picture yet
  let frame = 0;
  const lists = app.tables.lists;

  const canvas = h("canvas", { role: "img", "aria-label": "The given polygon and its refinements" });
  const overlay = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  overlay.setAttribute("role", "group");
  overlay.setAttribute("aria-label", "Points: arrow keys move, Delete removes, C marks a corner");
  const legend = h("div.legend", {}, "");
  const stage = h("div.stage", {}, canvas, overlay, legend);

  // Geometry.
  const coarse = () => {
    if (big) return { space: state.space, points: big, closed: state.closed };
    const points = Float64Array.from(state.points.flatMap((p) => (state.space === "sphere" ? toUnit(p) : p)));
    const curve = { space: state.space, points, closed: state.closed };
    if (state.corners.length) curve.corners = Uint8Array.from(state.points, (_, i) => Number(state.corners.includes(i)));
    return curve;
  };
  const full = (name) => (name === "learned" ? `learned:fairness=${state.fairness}` : (SETTINGS[name] ?? name));

  const dimension = () => (state.space === "sphere" ? 3 : 2);
  const count = () => (big ? big.length / dimension() : state.points.length);
  const snapshot = () => ({ state: structuredClone(state), big, source });
  let settled = working; // all refinements that began
  const compute = () => {
    wanted = null;
    working = refine();
    settled = Promise.allSettled([settled, working]);
    return working;
  };
  /** True once the curve is drawn, null where a newer call takes over, false after a failure, of which the user is told. */
  async function refine() {
    const tried = snapshot();
    const schemes = state.schemes.map(full);
    const needed = state.closed ? 3 : 2;
    if (count() < needed) {
      app.fail(new Error(`${state.closed ? "a closed" : "an open"} curve needs at least ${needed} points, not ${count()}`), opening);
      return false;
    }
    try {
      const options = { levels: state.levels, ends: state.ends };
      const answer = await app.engine.latest("curve", "curve", { coarse: coarse(), schemes, options }, "Refining");
      const bad = answer.results.find((result) => result.error);
      if (bad) app.fail({ ...bad.error, text: `${answer.results.length > 1 ? `${bad.scheme}: ` : ""}${bad.error.text ?? bad.error.message}` }, opening, CONTROLS);
      else app.clear();
      if (bad && answer.results.every((result) => result.error)) return false;
      results = answer.results;
      given = answer.given;
      await offer(tried.state);
      good = tried;
      drawn = true;
      combs = [];
      if (state.comb && state.levels > 0)
        for (const result of results)
          if (result.points && result.points.length < 200000)
            combs.push(await app.engine.call("comb", { fine: { space: state.space, points: result.points, closed: state.closed } }));
          else combs.push(null);
    } catch (error) {
      app.fail(error, opening, CONTROLS);
      return error.message === "superseded" ? null : false;
    }
    redraw();
    figures();
    return true;
  }
  /** Offer the formats that can hold the curve. */
  let offered = "";
  async function offer({ space: name, closed: ring }) {
    if (offered === `${name} ${ring}`) return;
    const some = results.find((result) => result.points);
    const points = some?.points.slice(0, 4 * (name === "sphere" ? 3 : 2));
    files.refuse(points ? await app.engine.call("refusals", { curves: [{ space: name, points, closed: ring }], formats: FORMATS.map(([format]) => format) }) : {});
    offered = `${name} ${ring}`;
  }
  /** A step of undo, once its picture is there; without one the last good state comes back. */
  async function keep() {
    const done = await working;
    if (done) app.commit();
    else if (done === false) {
      await settled;
      back();
    }
  }
  function back() {
    const moved = good.state.space !== state.space || good.big !== big;
    state = structuredClone(good.state);
    ({ big, source } = good);
    if (moved) fit();
    controls();
    if (drawn) redraw();
    else void compute();
  }

  // Drawing.
  function redraw() {
    cancelAnimationFrame(frame);
    frame = requestAnimationFrame(draw);
  }
  function draw() {
    if (section.hidden) return;
    const { context, width, height } = sized(canvas);
    view.resize(width, height);
    overlay.setAttribute("viewBox", `0 0 ${width} ${height}`);
    view.background(context, color("grid"));
    context.lineJoin = "round";
    if (state.comb) results.forEach((result, i) => result.points && combs[i] && drawComb(context, result.points, combs[i], color(`c${index(result.scheme)}`)));
    const first = results.find((result) => result.points);
    if (first && state.closed && state.space !== "sphere") {
      context.strokeStyle = "transparent";
      view.line(context, first.points, true);
      context.fillStyle = color(`c${index(first.scheme)}`);
      context.globalAlpha = 0.09;
      context.fill();
      context.globalAlpha = 1;
    }
    context.strokeStyle = color("given");
    context.lineWidth = 1;
    context.setLineDash([5, 4]);
    if (big) view.line(context, big, state.closed);
    else view.polygon(context, state.points, state.closed);
    context.setLineDash([]);
    for (const result of results) {
      if (!result.points) continue;
      context.strokeStyle = color(`c${index(result.scheme)}`);
      context.lineWidth = 2.2;
      view.line(context, result.points, state.closed);
    }
    handles();
    legend.textContent = `${count()} points, dashed; ${state.space === "plane" ? "double-click adds a point" : "drag beside the curve to turn or move"}`;
  }
  const index = (scheme) => Math.max(0, state.schemes.findIndex((name) => full(name) === scheme)) % 8;

  function drawComb(context, points, curvature, stroke) {
    const dim = state.space === "sphere" ? 3 : 2;
    const n = points.length / dim;
    const at = (i) => (dim === 3 ? view.screen(toDegrees(points[3 * i], points[3 * i + 1], points[3 * i + 2])) : view.screen([points[2 * i], points[2 * i + 1]]));
    const sorted = Float64Array.from(curvature, Math.abs).sort();
    const scale = 42 / (sorted[Math.floor(0.95 * (n - 1))] || 1);
    context.strokeStyle = stroke;
    context.globalAlpha = 0.55;
    context.lineWidth = 0.8;
    context.beginPath();
    const tips = [];
    for (let i = 0; i < n; i++) {
      const [x, y, visible] = at(i);
      const [a, b] = [at((i + n - 1) % n), at((i + 1) % n)];
      const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
      const k = Math.max(-70, Math.min(70, curvature[i] * scale));
      const tip = [x - (k * -(b[1] - a[1])) / length, y - (k * (b[0] - a[0])) / length];
      tips.push(tip);
      if (!visible) continue;
      context.moveTo(x, y);
      context.lineTo(...tip);
    }
    context.stroke();
    context.globalAlpha = 0.9;
    context.beginPath();
    if (dim === 2) tips.forEach((tip, i) => (i ? context.lineTo(...tip) : context.moveTo(...tip)));
    context.stroke();
    context.globalAlpha = 1;
  }

  const circles = [];
  function handles() {
    const count = big || state.points.length > MAX_HANDLES ? 0 : state.points.length;
    while (circles.length > count) circles.pop().remove();
    while (circles.length < count) {
      const circle = document.createElementNS("http://www.w3.org/2000/svg", "circle");
      circle.setAttribute("r", "6");
      circle.setAttribute("tabindex", "0");
      circle.setAttribute("role", "button");
      overlay.append(circle);
      circles.push(circle);
    }
    circles.forEach((circle, i) => {
      const [x, y, visible] = view.screen(state.points[i]);
      circle.setAttribute("cx", x.toFixed(2));
      circle.setAttribute("cy", y.toFixed(2));
      circle.setAttribute("r", count > 80 ? "4" : "6");
      circle.setAttribute("class", `handle${state.corners.includes(i) ? " corner" : ""}${i === held ? " held" : ""}`);
      circle.setAttribute("aria-label", `Point ${i + 1}: ${state.points[i].map((value) => digits(value)).join(", ")}${state.corners.includes(i) ? ", corner" : ""}`);
      circle.style.display = visible ? "" : "none";
    });
  }

  function figures() {
    const rows = [];
    if (given) rows.push(["given", digits(given.fairness.bending, 4), digits(given.fairness.g1, 4), given.simple ? "no" : "yes"]);
    for (const result of results)
      if (result.points) rows.push([result.scheme.split(":")[0], digits(result.fairness.bending, 4), digits(result.fairness.g1, 4), result.simple === null ? "–" : result.simple ? "no" : "yes"]);
    measures.replaceChildren(table(["", "bending", "largest turn", "crosses"], rows), ...notes(state.notes));
  }

  // Editing.
  /** Point i of an array, in degrees on the sphere. */
  const coordinates = (points, name, i) => (name === "sphere" ? toDegrees(points[3 * i], points[3 * i + 1], points[3 * i + 2]) : [points[2 * i], points[2 * i + 1]]);
  /** The same drawing in another space: its box becomes a part of the plane, of the globe or of the disk. */
  function moved(points, name) {
    let [a, b, c, d] = [Infinity, Infinity, -Infinity, -Infinity];
    for (const [x, y] of points) [a, b, c, d] = [Math.min(a, x), Math.min(b, y), Math.max(c, x), Math.max(d, y)];
    const scale = { plane: 4, sphere: 60, disk: 1.4 }[name] / (Math.max(c - a, d - b) || 1);
    return points.map(([x, y]) => [(x - (a + c) / 2) * scale, (y - (b + d) / 2) * scale].map((v) => Number(v.toPrecision(6))));
  }
  /** The points of the large file in a space. */
  function largeIn(name) {
    if (name === source.space) return source.points;
    const all = Array.from({ length: source.points.length / (source.space === "sphere" ? 3 : 2) }, (_, i) => coordinates(source.points, source.space, i));
    return Float64Array.from(moved(all, name).flatMap((p) => (name === "sphere" ? toUnit(p) : p)));
  }
  const set = (changes, { refit = false } = {}) => {
    Object.assign(state, changes);
    if (refit) fit();
    controls();
    return compute();
  };
  function fit() {
    view = new VIEWS[state.space]();
    const shown = Math.min(2000, count());
    view.fit(big ? Array.from({ length: shown }, (_, i) => coordinates(big, state.space, Math.floor((i * count()) / shown))) : state.points);
    const { width, height } = stage.getBoundingClientRect();
    view.resize(width || 1, height || 1);
  }
  const round = (p) => (p ? p.map((value) => Number(value.toPrecision(7))) : null);
  function move(i, point) {
    if (!point) return;
    state.points[i] = round(point);
    state.file = null;
    redraw();
    void compute();
  }
  function add(x, y) {
    const point = round(view.space(x, y));
    if (!point || big) return;
    // Into the nearest edge of the polygon on the screen, or at the nearer end of an open one.
    let best = { distance: Infinity, at: state.points.length };
    const at = state.points.map((p) => view.screen(p));
    for (let i = 0; i < (state.closed ? at.length : at.length - 1); i++) {
      const [p, q] = [at[i], at[(i + 1) % at.length]];
      const [dx, dy] = [q[0] - p[0], q[1] - p[1]];
      const t = Math.max(0, Math.min(1, ((x - p[0]) * dx + (y - p[1]) * dy) / (dx * dx + dy * dy || 1)));
      const distance = Math.hypot(p[0] + t * dx - x, p[1] + t * dy - y);
      const end = !state.closed && ((i === 0 && t === 0) || (i === at.length - 2 && t === 1));
      if (distance < best.distance) best = { distance, at: end ? (t === 0 ? 0 : at.length) : i + 1 };
    }
    state.corners = state.corners.map((i) => (i >= best.at ? i + 1 : i));
    state.points.splice(best.at, 0, point);
    state.file = null;
    void compute();
    redraw();
    void keep();
  }
  function remove(i) {
    if (state.points.length <= (state.closed ? 3 : 2)) return;
    state.points.splice(i, 1);
    state.file = null;
    state.corners = state.corners.filter((k) => k !== i).map((k) => (k > i ? k - 1 : k));
    void compute();
    void keep();
    requestAnimationFrame(() => circles[Math.min(i, circles.length - 1)]?.focus());
  }
  function corner(i) {
    state.file = null;
    state.corners = state.corners.includes(i) ? state.corners.filter((k) => k !== i) : [...state.corners, i].sort((a, b) => a - b);
    void compute();
    void keep();
  }

  const place = (event) => {
    const box = overlay.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const nearest = (x, y) => {
    let [best, least] = [-1, HIT];
    if (!big && state.points.length <= MAX_HANDLES)
      state.points.forEach((p, i) => {
        const [a, b, visible] = view.screen(p);
        const distance = Math.hypot(a - x, b - y);
        if (visible && distance < least) [best, least] = [i, distance];
      });
    return best;
  };
  let drag = null;
  const touches = new Map();
  overlay.addEventListener("pointerdown", (event) => {
    const [x, y] = place(event);
    touches.set(event.pointerId, [x, y]);
    overlay.setPointerCapture(event.pointerId);
    held = touches.size === 1 && event.button === 0 ? nearest(x, y) : -1;
    if (held >= 0) circles[held]?.focus({ preventScroll: true });
    drag = { x, y, moved: false };
    redraw();
  });
  overlay.addEventListener("pointermove", (event) => {
    if (!touches.has(event.pointerId)) return;
    const [x, y] = place(event);
    const before = [...touches.values()];
    touches.set(event.pointerId, [x, y]);
    if (touches.size === 2) {
      const after = [...touches.values()];
      const spread = ([p, q]) => Math.hypot(p[0] - q[0], p[1] - q[1]) || 1;
      view.zoom = Math.max(0.3, Math.min(400, (view.zoom * spread(after)) / spread(before)));
      redraw();
      return;
    }
    if (!drag || (!drag.moved && Math.hypot(x - drag.x, y - drag.y) < 3)) return;
    if (held >= 0) move(held, view.space(x, y));
    else {
      view.pan(x - (drag.lastX ?? drag.x), y - (drag.lastY ?? drag.y));
      redraw();
    }
    drag = { ...drag, moved: true, lastX: x, lastY: y };
  });
  const release = (event) => {
    touches.delete(event.pointerId);
    if (held >= 0 && drag?.moved) void keep();
    held = -1;
    drag = null;
    redraw();
  };
  overlay.addEventListener("pointerup", release);
  overlay.addEventListener("pointercancel", release);
  overlay.addEventListener("dblclick", (event) => {
    const [x, y] = place(event);
    const i = nearest(x, y);
    if (i >= 0) corner(i);
    else add(x, y);
  });
  overlay.addEventListener("contextmenu", (event) => {
    const i = nearest(...place(event));
    event.preventDefault();
    if (i >= 0) remove(i);
  });
  stage.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      view.zoom = Math.max(0.3, Math.min(400, view.zoom * Math.exp(-event.deltaY / 500)));
      redraw();
    },
    { passive: false },
  );
  overlay.addEventListener("keydown", (event) => {
    const i = circles.indexOf(event.target);
    if (i < 0) return;
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (steps) {
      const [x, y] = view.screen(state.points[i]);
      const far = event.shiftKey ? 10 : 3;
      move(i, view.space(x + steps[0] * far, y + steps[1] * far));
      clearTimeout(settle);
      settle = setTimeout(keep, 400);
    } else if (event.key === "Delete" || event.key === "Backspace") remove(i);
    else if (event.key.toLowerCase() === "c" && !event.ctrlKey) corner(i);
    else if (event.key.toLowerCase() === "a" && !event.ctrlKey) {
      const [p, q] = [view.screen(state.points[i]), view.screen(state.points[(i + 1) % state.points.length])];
      add((p[0] + q[0]) / 2, (p[1] + q[1]) / 2);
    } else return;
    event.preventDefault();
  });
  let settle = 0;

  // Controls.
  /** The chosen schemes, without those that need the plane. */
  const schemesOf = (name) => {
    const left = state.schemes.filter((scheme) => name === "plane" || !PLANE.includes(scheme));
    return left.length > 0 ? left : ["learned"];
  };
  const example = select("Example", [["", "choose …"], ...Object.entries(EXAMPLES).map(([name, { title }]) => [name, title])], "", (name) => {
    if (!name) return;
    const { space, points, closed, corners = [] } = EXAMPLES[name];
    big = source = null;
    void set({ space, points: structuredClone(points), closed, corners: [...corners], schemes: schemesOf(space), data: 0, notes: [], file: null }, { refit: true }).then(keep);
    example.set("");
  });
  const space = select("Space", [["plane", "plane"], ["sphere", "sphere"], ["disk", "Poincaré disk"]], "plane", (name) => {
    if (name === state.space) return;
    const points = big ? [] : moved(state.points, name);
    if (big) big = largeIn(name);
    void set({ space: name, points, file: big ? state.file : null, schemes: state.schemes.some((scheme) => name === "plane" || !PLANE.includes(scheme)) ? state.schemes : schemesOf(name) }, { refit: true }).then(keep);
  });
  const closed = check("Closed", true, (value) => void set({ closed: value }).then(keep));
  const comb = check("Curvature comb", false, (value) => void set({ comb: value }).then(keep));
  const levels = slider(CONTROLS.levels, { min: 0, max: 8, step: 1, value: 5, change: (value) => { state.levels = value; void compute(); }, commit: keep });
  const fairness = slider("Fairness of learned", { min: 0, max: 1, step: 0.05, value: 0.25, format: (value) => value.toFixed(2), change: (value) => { state.fairness = value; void compute(); }, commit: keep });
  const ends = select("Ends of open curves", lists.curve_end_rule.map(({ name }) => [name]), "reflect", (value) => void set({ ends: value }).then(keep));
  const boxes = new Map();
  const schemeList = h("div.schemes", { role: "group", "aria-label": "Schemes" });
  for (const { name, summary } of lists.curve_scheme.toSorted((a, b) => (b.name === "learned") - (a.name === "learned"))) {
    const swatch = h("span.swatch");
    const box = h("input", {
      type: "checkbox",
      onchange: () => {
        const schemes = box.checked ? [...state.schemes, name].slice(-8) : state.schemes.filter((other) => other !== name);
        void set({ schemes }).then(keep);
      },
    });
    boxes.set(name, { box, swatch });
    schemeList.append(h("label.check", { title: summary }, box, swatch, h("span", {}, name)));
  }
  const measures = h("div", {});
  function controls() {
    space.set(state.space);
    closed.set(state.closed);
    comb.set(state.comb);
    levels.set(state.levels);
    fairness.set(state.fairness);
    ends.set(state.ends);
    ends.box.disabled = state.closed;
    for (const [name, { box, swatch }] of boxes) {
      const i = state.schemes.indexOf(name);
      box.checked = i >= 0;
      swatch.style.background = i >= 0 ? `var(--c${i % 8})` : "";
    }
  }

  const files = downloads(FORMATS, save);
  async function save(format) {
    app.clear(true);
    const result = results.find((one) => one.points);
    if (!result) return;
    try {
      const curves = [{ space: state.space, points: result.points, closed: state.closed }];
      const text = await app.engine.call("writeCurves", { curves, format }, "Writing");
      download(`fine.${format}`, text);
    } catch (error) {
      app.fail(error);
    }
  }
  function picture() {
    app.clear(true);
    draw();
    const copy = h("canvas", { width: canvas.width, height: canvas.height });
    const context = copy.getContext("2d");
    context.fillStyle = color("stage");
    context.fillRect(0, 0, copy.width, copy.height);
    context.drawImage(canvas, 0, 0);
    copy.toBlob((blob) => download("curve.png", blob));
  }

  section.append(
    h("div.column", {}, stage, group("Figures", measures)),
    h(
      "div.side",
      {},
      group("Curve", h("div.row", {}, example.element, space.element), h("div.row", {}, closed.element, comb.element), h("div.row", {}, opener("Open file", ".csv,.geojson,.json,.obj,.gpx,.wkt,.topojson", (file) => open(file)), h("button", { type: "button", onclick: () => { fit(); redraw(); } }, "Fit view")),
        h("p.hint", {}, "Drag points. Double-click adds a point or marks a corner, a right click removes. Keys on a point: arrows, A adds, Delete removes, C corner.")),
      group("Schemes", schemeList, fairness.element, levels.element, ends.element),
      group("Download", h("div.row", {}, ...files.elements, h("button", { type: "button", onclick: picture }, "PNG")), h("p.hint", {}, "The first scheme's curve.")),
    ),
  );

  async function read(bytes, name) {
    const set_ = await app.engine.call("readCurves", { bytes, options: formatOf(lists.curve_format, name) }, "Reading");
    if (!VIEWS[set_.space]) throw new Error(`this tab shows the plane, the sphere and the disk, not the space '${set_.space}'`);
    const which = set_.curves.reduce((best, curve, i, all) => (curve.points.length > all[best].points.length ? i : best), 0);
    const curve = set_.curves[which];
    const length = curve.points.length / (set_.space === "sphere" ? 3 : 2);
    return { ...curve, which, space: set_.space, length, curves: set_.curves.length, notes: set_.notes };
  }
  async function open(file) {
    app.clear();
    try {
      const bytes = new Uint8Array(await file.arrayBuffer());
      const curve = await read(bytes, file.name);
      big = source = null;
      const next = { space: curve.space, points: [], closed: curve.closed, corners: [], schemes: schemesOf(curve.space), data: 0, notes: curve.notes };
      // How other programs find these points, as long as they stay as they are.
      next.file = { name: file.name, which: curve.which, closed: curve.closed, layout: curve.curves === 1 && /\.(csv|tsv|txt)$/i.test(file.name) ? layoutOf(bytes, 2) : null };
      if (curve.curves > 1) next.notes = [`the longest of ${curve.curves} curves of the file`, ...next.notes];
      if (curve.length > MAX_EDITED) {
        next.data = app.keep(file.name, bytes);
        source = { data: next.data, space: curve.space, points: curve.points };
        big = source.points;
        next.levels = Math.min(state.levels, 3);
      } else {
        next.points = Array.from({ length: curve.length }, (_, i) => coordinates(curve.points, curve.space, i)).map((p) => (curve.space === "sphere" ? round(p) : p));
        if (curve.corners) next.corners = [...curve.corners.keys()].filter((i) => curve.corners[i]);
      }
      app.say(`${curve.length} points read${curve.curves > 1 ? `, the longest of ${curve.curves} curves` : ""}`);
      opening = file.name;
      const done = await set(next, { refit: true });
      await keep();
      return done !== false; // a newer change decides about itself
    } catch (error) {
      app.fail(error, file.name);
      return false;
    } finally {
      opening = undefined;
    }
  }

  fit();
  controls();
  void compute();

  return {
    open,
    redraw,
    show() {
      redraw();
    },
    state: () => ({ ...state, points: big ? [] : state.points }),
    async restore(next) {
      const mine = (wanted = { ...structuredClone(FIRST), ...structuredClone(next) });
      const file = mine.points.length === 0 && mine.data ? app.file(mine.data) : null;
      let found = file && source?.data === mine.data ? source : null;
      if (file && !found) {
        const { space: name, points } = await read(file.bytes, file.name);
        found = { data: mine.data, space: name, points };
        if (wanted !== mine) return; // a later step of undo, or a change
      }
      // Together: the picture is drawn from all three.
      const before = { space: state.space, big };
      [state, source] = [mine, found];
      big = source && largeIn(state.space);
      if (!big && !state.points.length) state = structuredClone(FIRST);
      if (before.space !== state.space || before.big !== big) fit();
      controls();
      if ((await compute()) === false) back();
    },
    /** Drag a point to a place: the milliseconds until its curve is drawn. For measurements. */
    async drag(i, place) {
      const began = performance.now();
      state.points[i] = place;
      await compute();
      draw();
      return performance.now() - began;
    },
    inspect: () => ({ state, results, given, view: state.points.map((p) => view.screen(p)) }),
    commands() {
      const scheme = full(state.schemes[0] ?? "learned");
      const { file, closed: ring, levels: depth, corners } = state;
      const name = big ? source.space : state.space; // a large file is read as it is
      const degrees = name === "sphere";
      const few = !big && state.points.length <= MAX_LITERAL && !corners.length;
      // What is not in the user's file goes into a small one.
      const own = file && !corners.length && (big || !few) ? file : null;
      const header = `${name === "disk" ? "# space: disk\n" : ""}${ring ? "# closed\n" : ""}${degrees ? "lon,lat" : "x,y"}${corners.length ? ",corner" : ""}`;
      const rows = own ? [] : state.points.map((p, i) => [...p, ...(corners.length ? [Number(corners.includes(i))] : [])].join(","));
      const given = own?.name ?? "curve.csv";
      const turned = own && own.closed !== ring;
      const end = ring ? "" : ` --ends ${state.ends}`;
      const shell = `${own ? "" : `cat > curve.csv <<'END'\n${header}\n${rows.join("\n")}\nEND\n`}batten curve ${shellName(given)}${turned ? (ring ? " --closed" : " --open") : ""} --scheme ${scheme} --levels ${depth}${end} -o fine.csv --picture fine.png${state.comb ? " --comb" : ""}`;

      const space = { plane: "bat_euclidean(2)", sphere: "bat_sphere(2)", disk: "bat_disk()" }[name];
      const values = few ? state.points.map((p) => (degrees ? toUnit(p).map((v) => Number(v.toFixed(12))) : p).join(", ")).join(",\n    ") : "";
      const at = `set.curves[${own?.which ?? 0}]`;
      const c = [
        ...(few
          ? [`const bat_space space = ${space};`, `double points[] = {\n    ${values}};`, `const bat_curve coarse = {\n    .space = &space, .points = points, .count = ${state.points.length}, .closed = ${ring}};`]
          : ["bat_curve_set set = {0};"]),
        "bat_curve fine = {0};",
        "bat_error error;",
        "bat_curve_refine_options options = bat_curve_refine_defaults();",
        `options.levels = ${depth};`,
        ...(ring ? [] : [`options.ends = ${enumerator("curve_end_rule", state.ends)};`]),
        `bat_status status = bat_curve_scheme_by_name("${scheme}", &options.scheme, &error);`,
        ...(few ? [] : ["if (status == BAT_OK)", `    status = bat_curve_read(${quoted(given)}, NULL, &set, &error);`]),
        ...(turned ? ["if (status == BAT_OK)", `    ${at}.closed = ${ring};`] : []),
        "if (status == BAT_OK)",
        `    status = bat_curve_refine(&${few ? "coarse" : at}, &options, &fine, &error);`,
        "if (status != BAT_OK)",
        '    fprintf(stderr, "%s\\n", error.text);',
        "bat_curve_free(&fine);",
        ...(few ? [] : ["bat_curve_set_free(&set);"]),
      ];

      let [packages, read] = [[], `points = [${state.points.map((p) => `[${p.join(", ")}]`).join(", ")}]`];
      if (own && !own.layout) [packages, read] = longestIn(own.name, own.closed);
      else if (!few) [packages, read] = [["np"], `points = ${loadtxt(given, own?.layout ?? { skip: header.split("\n").length, delimiter: ",", columns: [0, 1] })}`];
      if (corners.length) read += `\ncorners = ${loadtxt(given, { skip: header.split("\n").length, delimiter: ",", columns: [2] }).replace("(2)", "2")}`;
      const settings = [`space="${name}"`, `closed=${ring ? "True" : "False"}`, ...(corners.length ? ["corners=corners"] : [])].join(", ");
      const python = `${imports(packages)}\n\n${read}\n${degrees ? "points = batten.from_lonlat(points)\n" : ""}fine = batten.refine(points, ${settings},\n                     scheme="${scheme}", levels=${depth}${ring ? "" : `, ends="${state.ends}"`})`;
      return { shell, c: c.join("\n"), python };
    },
  };
}
