// Curves: points on the plane, the sphere and the disk, refined by several schemes at once.
import samples from "samples";
import { check, color, digits, download, enumerator, formatOf, group, h, opener, select, sized, slider, table } from "./dom.js";
import { VIEWS, toDegrees, toUnit } from "./view.js";

/** More points than this get no handles. */
const MAX_HANDLES = 400;
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
const FIRST = { points: EXAMPLES.guitar.points, space: "plane", closed: true, corners: [], schemes: ["learned", "four-point"], fairness: 0.25, levels: 5, ends: "reflect", comb: false, data: 0 };

/** What a scheme needs beyond its name. */
const SETTINGS = { mask: "mask:1/8,4/8,6/8,4/8,1/8", "corner-cutting": "corner-cutting:r=0.25,s=0.75", angle: "angle:mu=-0.1" };

/** Linear schemes that other spaces refuse. */
const PLANE = ["four-point", "six-point", "mask"];

export function curveTab(app, section) {
  let state = structuredClone(FIRST);
  let view = new VIEWS.plane();
  let results = [];
  let given = null;
  let combs = [];
  let held = -1;
  let big = null; // the points of a file that is too large for handles
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

  async function compute() {
    const schemes = state.schemes.map(full);
    const points = big ? big.length / (state.space === "sphere" ? 3 : 2) : state.points.length;
    if (points < (state.closed ? 3 : 2)) {
      results = [];
      given = null;
      redraw();
      return;
    }
    try {
      const options = { levels: state.levels, ends: state.ends };
      const answer = await app.engine.latest("curve", "curve", { coarse: coarse(), schemes, options }, "Refining");
      results = answer.results;
      given = answer.given;
      const bad = results.find((result) => result.error);
      if (bad) app.fail(new Error(results.length > 1 ? `${bad.scheme}: ${bad.error}` : bad.error));
      else app.clear();
      combs = [];
      if (state.comb && state.levels > 0)
        for (const result of results)
          if (result.points && result.points.length < 200000)
            combs.push(await app.engine.call("comb", { fine: { space: state.space, points: result.points, closed: state.closed } }));
          else combs.push(null);
    } catch (error) {
      app.fail(error);
      return;
    }
    redraw();
    figures();
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
    legend.textContent = `${big ? big.length / 2 : state.points.length} points, dashed; ${state.space === "plane" ? "double-click adds a point" : "drag beside the curve to turn or move"}`;
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
    measures.replaceChildren(table(["", "bending", "largest turn", "crosses"], rows));
  }

  // Editing.
  const set = (changes, { refit = false } = {}) => {
    Object.assign(state, changes);
    if (refit) fit();
    controls();
    return compute();
  };
  const fit = () => {
    view = new VIEWS[state.space]();
    const shown = big ? Array.from({ length: Math.min(2000, big.length / 2) }, (_, i) => {
      const dim = state.space === "sphere" ? 3 : 2;
      const k = dim * Math.floor((i * (big.length / dim)) / Math.min(2000, big.length / 2));
      return dim === 3 ? toDegrees(big[k], big[k + 1], big[k + 2]) : [big[k], big[k + 1]];
    }) : state.points;
    view.fit(shown);
    const { width, height } = stage.getBoundingClientRect();
    view.resize(width || 1, height || 1);
  };
  const round = (p) => (p ? p.map((value) => Number(value.toPrecision(7))) : null);
  function move(i, point) {
    if (!point) return;
    state.points[i] = round(point);
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
    void compute();
    redraw();
    app.commit();
  }
  function remove(i) {
    if (state.points.length <= (state.closed ? 3 : 2)) return;
    state.points.splice(i, 1);
    state.corners = state.corners.filter((k) => k !== i).map((k) => (k > i ? k - 1 : k));
    void compute();
    app.commit();
    requestAnimationFrame(() => circles[Math.min(i, circles.length - 1)]?.focus());
  }
  function corner(i) {
    state.corners = state.corners.includes(i) ? state.corners.filter((k) => k !== i) : [...state.corners, i].sort((a, b) => a - b);
    void compute();
    app.commit();
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
    if (held >= 0 && drag?.moved) app.commit();
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
      settle = setTimeout(() => app.commit(), 400);
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
    big = null;
    void set({ space, points: structuredClone(points), closed, corners: [...corners], schemes: schemesOf(space) }, { refit: true }).then(() => app.commit());
    example.set("");
  });
  const space = select("Space", [["plane", "plane"], ["sphere", "sphere"], ["disk", "Poincaré disk"]], "plane", (name) => {
    if (name === state.space) return;
    // The same drawing in the other space: its box becomes a part of the globe, or of the disk.
    const xs = state.points.map((p) => p[0]);
    const ys = state.points.map((p) => p[1]);
    const [a, b, c, d] = [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
    const size = Math.max(c - a, d - b) || 1;
    const scale = { plane: 4, sphere: 60, disk: 1.4 }[name] / size;
    big = null;
    void set({ space: name, points: state.points.map(([x, y]) => [(x - (a + c) / 2) * scale, (y - (b + d) / 2) * scale].map((v) => Number(v.toPrecision(6)))) }, { refit: true }).then(() => app.commit());
  });
  const closed = check("Closed", true, (value) => void set({ closed: value }).then(() => app.commit()));
  const comb = check("Curvature comb", false, (value) => void set({ comb: value }).then(() => app.commit()));
  const levels = slider("Levels", { min: 0, max: 8, step: 1, value: 5, change: (value) => { state.levels = value; void compute(); }, commit: () => app.commit() });
  const fairness = slider("Fairness of learned", { min: 0, max: 1, step: 0.05, value: 0.25, format: (value) => value.toFixed(2), change: (value) => { state.fairness = value; void compute(); }, commit: () => app.commit() });
  const ends = select("Ends of open curves", lists.curve_end_rule.map(({ name }) => [name]), "reflect", (value) => void set({ ends: value }).then(() => app.commit()));
  const boxes = new Map();
  const schemeList = h("div.schemes", { role: "group", "aria-label": "Schemes" });
  for (const { name, summary } of lists.curve_scheme.toSorted((a, b) => (b.name === "learned") - (a.name === "learned"))) {
    const swatch = h("span.swatch");
    const box = h("input", {
      type: "checkbox",
      onchange: () => {
        const schemes = box.checked ? [...state.schemes, name].slice(-8) : state.schemes.filter((other) => other !== name);
        void set({ schemes }).then(() => app.commit());
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

  async function save(format) {
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
      group("Download", h("div.row", {}, ...[["csv", "CSV"], ["geojson", "GeoJSON"], ["wkt", "WKT"], ["gpx", "GPX"], ["topojson", "TopoJSON"], ["obj", "OBJ"]].map(([name, title]) => h("button", { type: "button", onclick: () => save(name) }, title)), h("button", { type: "button", onclick: picture }, "PNG")), h("p.hint", {}, "The first scheme's curve.")),
    ),
  );

  async function open(file, fresh = true) {
    app.clear();
    try {
      const bytes = new Uint8Array(await file.arrayBuffer());
      const set_ = await app.engine.call("readCurves", { bytes, options: formatOf(lists.curve_format, file.name) }, "Reading");
      if (!VIEWS[set_.space]) throw new Error(`this tab shows the plane, the sphere and the disk, not the space '${set_.space}'`);
      const curve = set_.curves.reduce((a, b) => (b.points.length > a.points.length ? b : a));
      const dim = set_.space === "sphere" ? 3 : 2;
      const count = curve.points.length / dim;
      big = count > 5000 ? curve.points : null;
      state.data = big ? app.keep(file.name, bytes) : 0;
      const points = big ? [] : Array.from({ length: count }, (_, i) => (dim === 3 ? round(toDegrees(...curve.points.slice(3 * i, 3 * i + 3))) : [...curve.points.slice(2 * i, 2 * i + 2)]));
      const corners = curve.corners && !big ? [...curve.corners.keys()].filter((i) => curve.corners[i]) : [];
      Object.assign(state, { space: set_.space, points, closed: curve.closed, corners, schemes: schemesOf(set_.space) });
      if (big) state.levels = Math.min(state.levels, 3);
      app.say(`${count} points read${set_.curves.length > 1 ? `, the longest of ${set_.curves.length} curves` : ""}`);
      await set({}, { refit: true });
      if (fresh) app.commit();
      return true;
    } catch (error) {
      app.fail(error, file.name);
      return false;
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
      const moved = next.space !== state.space;
      const given = next.data && next.data !== state.data ? app.file(next.data) : null;
      if (given) await open(new File([given.bytes], given.name), false);
      state = { ...structuredClone(FIRST), ...structuredClone(next) };
      if (state.points.length) big = null;
      if (!big && !state.points.length) state = structuredClone(FIRST);
      if (moved) fit();
      controls();
      await compute();
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
      const few = state.points.length > 0 && state.points.length <= 60 && !state.corners.length;
      const degrees = state.space === "sphere";
      const header = `${degrees ? "lon,lat" : "x,y"}${state.corners.length ? ",corner" : ""}`;
      const rows = state.points.map((p, i) => [...p, ...(state.corners.length ? [Number(state.corners.includes(i))] : [])].join(",")).join("\n");
      const data = state.points.length && state.points.length <= 60 ? `cat > curve.csv <<'END'\n${state.space === "disk" ? "# space: disk\n" : ""}${state.closed ? "# closed\n" : ""}${header}\n${rows}\nEND\n` : "";
      const end = state.closed ? "" : ` --ends ${state.ends}`;
      const c = { plane: "bat_euclidean(2)", sphere: "bat_sphere(2)", disk: "bat_disk()" }[state.space];
      const values = few ? state.points.slice(0, 8).flatMap((p) => (degrees ? toUnit(p).map((v) => Number(v.toFixed(6))) : p)).join(", ") + (state.points.length > 8 ? ", …" : "") : "…";
      return {
        shell: `${data}batten curve curve.csv --scheme ${scheme} --levels ${state.levels}${end} -o fine.csv --picture fine.png${state.comb ? " --comb" : ""}`,
        c: `const bat_space space = ${c};\ndouble points[] = {${values}};\nconst bat_curve coarse = {\n    .space = &space, .points = points, .count = ${state.points.length}, .closed = ${state.closed}};\nbat_curve_refine_options options = bat_curve_refine_defaults();\nbat_error error;\nbat_curve fine = {0};\noptions.levels = ${state.levels};${state.closed ? "" : `\noptions.ends = ${enumerator("curve_end_rule", state.ends)};`}\nbat_curve_scheme_by_name("${scheme}", &options.scheme, &error);\nif (bat_curve_refine(&coarse, &options, &fine, &error) != BAT_OK)\n    fprintf(stderr, "%s\\n", error.text);\nbat_curve_free(&fine);`,
        python: `import batten\n\npoints = [${few ? state.points.slice(0, 6).map((p) => `[${(degrees ? toUnit(p).map((v) => Number(v.toFixed(6))) : p).join(", ")}]`).join(", ") + (state.points.length > 6 ? ", ..." : "") : "..."}]\nfine = batten.refine(points, space="${state.space}", closed=${state.closed ? "True" : "False"},\n                     scheme="${scheme}", levels=${state.levels}${state.closed ? "" : `, ends="${state.ends}"`})`,
      };
    },
  };
}
