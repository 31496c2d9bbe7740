// Maps: a GeoJSON file before and after, and where its borders would have torn.
import { geoArea, geoEqualEarth, geoGraticule10, geoPath } from "d3-geo";
import { check, color, digits, download, downloads, formatOf, group, h, notes, opener, select, sized, slider, table } from "./dom.js";
import { imports, quoted, shapesIn, shellName } from "./code.js";
import { divider } from "./scene.js";
import { toDegrees } from "./view.js";

/** The controls of options that lead out of failures. */
const CONTROLS = { levels: "Levels" };
const FORMATS = [["geojson", "GeoJSON"], ["topojson", "TopoJSON"], ["wkt"], ["gpx"], ["csv"], ["obj"]];
/** Of larger files only writing tells whether a format holds them. */
const MAX_TRIED = 2e7;

export function mapTab(app, section) {
  let state = { scheme: "learned", levels: 3, topology: true, keep_area: false, decimals: 6, example: true, data: 0, marks: false, view: null };
  let bytes = null;
  let file = "map.geojson";
  let result = null;
  let zoom = { k: 1, x: 0, y: 0 };
  let started = false;
  let focus = -1;
  let plane = false; // GeoJSON cannot hold the map
  let offered = null; // the file whose formats the buttons offer
  const canvas = h("canvas", { role: "img", "aria-label": "The map before (dashed) and after, with tears marked" });
  const legend = h("div.legend", {}, "");
  const stage = h("div.stage", { tabIndex: 0, role: "group", "aria-label": "Map: arrow keys move, plus and minus zoom" }, canvas, legend);
  const split = divider(stage, () => {
    redraw();
    remember();
  });
  /** The whole map with the slider in the middle. */
  const WHOLE = [1, 0, 0, 50];
  const facts = h("div", {});
  let frame = 0;

  const example = () => new TextEncoder().encode(document.getElementById("map-example").textContent);

  async function compute() {
    await app.ready();
    bytes ??= example();
    try {
      const options = { scheme: state.scheme, levels: state.levels, find_corners: true, topology: state.topology, decimals: state.decimals, keep_area: state.topology && state.keep_area };
      const tried = bytes;
      const formats = tried === offered || tried.length > MAX_TRIED ? [] : FORMATS.map(([name]) => name);
      result = await app.engine.latest("map", "map", { bytes, options, read: formatOf(app.tables.lists.curve_format, file), formats }, "Refining the map");
      if (tried !== offered) {
        files.refuse(result.refused);
        plane = Boolean(result.refused.geojson);
      }
      offered = tried;
      app.clear();
      prepare();
      facts.replaceChildren(
        table(["", ""], [
          ["curves", digits(result.coarse.length)],
          ["points", `${sum(result.coarse)} → ${sum(result.fine)}`],
          ["shared borders", digits(result.report.shared)],
          ["edges drawn back", digits(result.report.drawn_back)],
          [state.topology ? "would have torn" : "torn edges", digits(result.torn)],
          ["widest gap", result.tears.length ? `${digits(result.tears[0].gap * 6371, 3)} km` : "–"],
        ]),
        ...notes(result.notes),
      );
    } catch (error) {
      app.fail(error, state.example ? undefined : file, CONTROLS);
      return error.message === "superseded" ? null : false;
    }
    redraw();
    return true;
  }
  const sum = (curves) => curves.reduce((all, curve) => all + curve.points.length / (result.space === "sphere" ? 3 : 2), 0);

  let lines = { before: null, after: null, areas: { before: [], after: [] } };
  function prepare() {
    const coordinates = ({ points, closed }) => {
      const out = [];
      if (result.space === "sphere") for (let i = 0; i < points.length; i += 3) out.push(toDegrees(points[i], points[i + 1], points[i + 2]));
      else for (let i = 0; i < points.length; i += 2) out.push([points[i], points[i + 1]]);
      if (closed) out.push(out[0]);
      return out;
    };
    /** Polygons with the number of their feature; d3 takes the area to the left of a ring, seen from outside, for the outside. */
    const areas = (all) => {
      const polygons = new Map();
      all.forEach((line, i) => {
        const place = result.polygons?.[i];
        if (!place) return;
        const [polygon, feature] = place;
        if (!polygons.has(polygon)) polygons.set(polygon, { feature, rings: [] });
        polygons.get(polygon).rings.push(line);
      });
      for (const { rings } of polygons.values())
        if (result.space === "sphere")
          rings.forEach((ring, i) => {
            const large = geoArea({ type: "Polygon", coordinates: [ring] }) > 2 * Math.PI;
            if (large === (i === 0)) rings[i] = ring.toReversed();
          });
      return [...polygons.values()].map(({ feature, rings }) => ({ feature, type: "Polygon", coordinates: rings }));
    };
    const [before, after] = [result.coarse, result.fine].map((curves) => curves.map(coordinates));
    lines = { before: { type: "MultiLineString", coordinates: before }, after: { type: "MultiLineString", coordinates: after }, areas: { before: areas(before), after: areas(after) } };
  }

  function projection(width, height) {
    const base = geoEqualEarth().precision(0.1);
    if (result && result.space === "sphere") base.fitExtent([[12, 12], [width - 12, height - 12]], sum(result.coarse) > 20000 ? { type: "Sphere" } : lines.before);
    else base.fitExtent([[12, 12], [width - 12, height - 12]], { type: "Sphere" });
    const [x, y] = base.translate();
    return base.scale(base.scale() * zoom.k).translate([width / 2 + (x - width / 2) * zoom.k + zoom.x, height / 2 + (y - height / 2) * zoom.k + zoom.y]).clipExtent([[-5, -5], [width + 5, height + 5]]);
  }

  /** Pixels of the unit of the view in the state, which holds for stages of any size. */
  function unit() {
    const { width, height } = stage.getBoundingClientRect();
    return result.space === "sphere" ? projection(width, height).scale() / zoom.k : Math.min(width, height);
  }
  let settling = 0;
  /** Put the view into the state once it rests. */
  function remember() {
    clearTimeout(settling);
    settling = setTimeout(() => {
      if (!result || section.hidden) return;
      const view = [zoom.k, zoom.x / unit(), zoom.y / unit(), split.value].map((value) => Number(value.toPrecision(6)));
      state.view = view.join() === WHOLE.join() ? null : view;
      app.amend("map", state.view);
    }, 300);
  }
  /** Look as the state tells. */
  function look() {
    if (!result) return;
    const [k, x, y, share] = state.view ?? WHOLE;
    zoom = { k: 1, x: 0, y: 0 };
    zoom = { k, x: x * unit(), y: y * unit() };
    split.set(share);
    redraw();
  }

  function redraw() {
    cancelAnimationFrame(frame);
    frame = requestAnimationFrame(draw);
  }
  function draw() {
    if (section.hidden) return;
    const { context, width, height } = sized(canvas);
    if (!result) return;
    let path;
    let point;
    if (result.space === "sphere") {
      const project = projection(width, height);
      path = geoPath(project, context);
      point = (p) => project(p);
      context.strokeStyle = color("grid");
      context.lineWidth = 0.8;
      context.beginPath();
      path(geoGraticule10());
      context.stroke();
    } else {
      let [a, b, c, d] = [Infinity, Infinity, -Infinity, -Infinity];
      for (const line of lines.before.coordinates) for (const [x, y] of line) [a, b, c, d] = [Math.min(a, x), Math.min(b, y), Math.max(c, x), Math.max(d, y)];
      const s = 0.92 * zoom.k * Math.min(width / (c - a || 1), height / (d - b || 1));
      point = ([x, y]) => [width / 2 + (x - (a + c) / 2) * s + zoom.x, height / 2 - (y - (b + d) / 2) * s + zoom.y];
      path = ({ coordinates }) => coordinates.forEach((line) => line.forEach((p, i) => (i ? context.lineTo(...point(p)) : context.moveTo(...point(p)))));
    }
    context.lineJoin = "round";
    const side = Math.round(width * split.share);
    const part = (left, right, drawing) => {
      if (right <= left) return;
      context.save();
      context.beginPath();
      context.rect(left, 0, right - left, height);
      context.clip();
      drawing();
      context.restore();
    };
    const fill = (areas) => {
      context.globalAlpha = 0.22;
      for (const area of areas) {
        context.fillStyle = color(`c${area.feature % 8}`);
        context.beginPath();
        path(area);
        context.fill("evenodd");
      }
      context.globalAlpha = 1;
    };
    const outline = (all, stroke, thick, dash) => {
      context.strokeStyle = color(stroke);
      context.lineWidth = thick;
      context.setLineDash(dash);
      context.beginPath();
      path(all);
      context.stroke();
      context.setLineDash([]);
    };
    part(0, side, () => {
      fill(lines.areas.before);
      outline(lines.before, "ink", width < 500 ? 0.7 : 1.1, []);
    });
    part(side, width, () => {
      fill(lines.areas.after);
      if (zoom.k > 2 || lines.before.coordinates.length < 60) outline(lines.before, "given", 1.2, [5, 4]);
      outline(lines.after, "c0", width < 500 ? 1 : 1.6, []);
    });
    context.strokeStyle = color("c1");
    context.lineWidth = 1.6;
    for (const [i, { at }] of (state.marks || focus >= 0 ? result.tears : []).slice(0, zoom.k > 3 ? 5000 : Math.round(width * 0.45)).entries()) {
      const p = point(at);
      if (!p) continue;
      context.beginPath();
      context.arc(p[0], p[1], i === focus ? 14 : width < 500 ? 3 : 4, 0, 2 * Math.PI);
      context.stroke();
    }
    legend.textContent = `left: given; right: refined${state.marks ? `; circles: ${state.topology ? "borders that would have torn" : "torn borders"}` : ""}`;
  }

  // Moving.
  let last = null;
  const touches = new Map();
  stage.addEventListener("pointerdown", (event) => {
    stage.setPointerCapture(event.pointerId);
    touches.set(event.pointerId, [event.clientX, event.clientY]);
    last = [event.clientX, event.clientY];
  });
  stage.addEventListener("pointermove", (event) => {
    if (!touches.has(event.pointerId)) return;
    const before = [...touches.values()];
    touches.set(event.pointerId, [event.clientX, event.clientY]);
    const after = [...touches.values()];
    if (touches.size === 2) {
      const spread = ([p, q]) => Math.hypot(p[0] - q[0], p[1] - q[1]) || 1;
      scale(spread(after) / spread(before));
    } else if (last) {
      zoom.x += event.clientX - last[0];
      zoom.y += event.clientY - last[1];
    }
    last = [event.clientX, event.clientY];
    redraw();
    remember();
  });
  for (const name of ["pointerup", "pointercancel"]) stage.addEventListener(name, (event) => touches.delete(event.pointerId));
  function scale(factor, x = 0, y = 0) {
    const k = Math.max(1, Math.min(300, zoom.k * factor));
    const r = k / zoom.k;
    zoom = k === 1 ? { k, x: 0, y: 0 } : { k, x: x + (zoom.x - x) * r, y: y + (zoom.y - y) * r };
    redraw();
    remember();
  }
  stage.addEventListener("wheel", (event) => {
    event.preventDefault();
    const box = stage.getBoundingClientRect();
    scale(Math.exp(-event.deltaY / 400), event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2);
  }, { passive: false });
  stage.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: [60, 0], ArrowRight: [-60, 0], ArrowUp: [0, 60], ArrowDown: [0, -60] }[event.key];
    if (steps) {
      zoom.x += steps[0];
      zoom.y += steps[1];
    } else if (event.key === "+") scale(1.4);
    else if (event.key === "-") scale(1 / 1.4);
    else return;
    event.preventDefault();
    redraw();
    remember();
  });
  function nextTear() {
    if (!result?.tears.length) return;
    focus = (focus + 1) % result.tears.length;
    zoom = { k: 1, x: 0, y: 0 };
    const { width, height } = stage.getBoundingClientRect();
    const p = projection(width, height)(result.tears[focus].at);
    const k = 40;
    zoom = { k, x: (width / 2 - p[0]) * k, y: (height / 2 - p[1]) * k };
    app.say(`Tear ${focus + 1} of ${result.tears.length}: ${digits(result.tears[focus].gap * 6371, 3)} kilometres`);
    redraw();
    remember();
  }

  const change = async (changes) => {
    const last = { ...state };
    Object.assign(state, changes);
    controls();
    const done = await compute();
    if (done) app.commit();
    else if (done === false) {
      state = last;
      controls();
    }
  };
  const scheme = select("Scheme", app.tables.map_schemes.map(({ name }) => [name]), state.scheme, (value) => change({ scheme: value }));
  const levels = slider(CONTROLS.levels, { min: 1, max: 5, step: 1, value: state.levels, change: () => {}, commit: () => change({ levels: Number(levels.input.value) }) });
  const topology = check("Keep borders shared (topology)", true, (value) => change({ topology: value }));
  const marks = check("Mark borders that would tear", false, (value) => {
    state.marks = value;
    redraw();
    app.commit();
  });
  const area = check("Keep areas", false, (value) => change({ keep_area: value }));
  const controls = () => {
    scheme.set(state.scheme);
    levels.set(state.levels);
    topology.set(state.topology);
    area.set(state.keep_area);
    marks.set(state.marks);
    area.box.disabled = !state.topology;
  };

  /** Take a file, or the example for null. */
  function take(given) {
    bytes = given ? given.bytes : null;
    file = given ? given.name : "map.geojson";
    zoom = { k: 1, x: 0, y: 0 };
    focus = -1;
  }
  async function open(chosen) {
    app.clear();
    const last = { bytes, file, state: { ...state } };
    take({ name: chosen.name, bytes: new Uint8Array(await chosen.arrayBuffer()) });
    Object.assign(state, { example: false, view: null });
    if (await compute()) {
      state.data = app.keep(file, bytes);
      app.commit();
      return true;
    }
    // The last good map stays.
    ({ bytes, file, state } = last);
    redraw();
    return false;
  }
  const files = downloads(FORMATS, save);
  async function save(format) {
    app.clear(true);
    try {
      const options = { scheme: state.scheme, levels: state.levels, find_corners: true, topology: state.topology, decimals: state.decimals, keep_area: state.keep_area };
      const { text } = await app.engine.call("map", { bytes, options, read: formatOf(app.tables.lists.curve_format, file), write: format }, "Writing");
      download(`fine-${file.replace(/\.\w+$/, "")}.${format}`, text);
    } catch (error) {
      app.fail(error, file);
    }
  }
  section.append(
    stage,
    h("div.side", {},
      group("Map", h("div.row", {}, opener("Open file", ".geojson,.json,.topojson,.wkt,.gpx,.csv,.geojsonl", open), h("button", { type: "button", onclick: () => { take(null); void change({ example: true, data: 0, view: null }); } }, "Example")),
        h("p.hint", {}, "Drop a GeoJSON file of countries, parcels or coasts. The example is a map of 200 invented countries."), scheme.element, levels.element, topology.element, area.element, marks.element),
      group("Figures", facts, h("div.row", {}, h("button", { type: "button", onclick: nextTear }, "Next tear"), h("button", { type: "button", onclick: () => { zoom = { k: 1, x: 0, y: 0 }; focus = -1; redraw(); remember(); } }, "Whole map"))),
      group("Download", h("div.row", {}, ...files.elements)),
    ),
  );
  return {
    open, redraw,
    show() {
      if (!started) {
        started = true;
        void compute();
      }
      redraw();
    },
    state: () => state,
    async restore(next) {
      const other = next.example !== state.example || next.data !== state.data;
      state = { ...state, ...next };
      const given = state.example ? null : app.file(state.data);
      if (!given) Object.assign(state, { example: true, data: 0 });
      if (other || !bytes) take(given);
      started = true;
      controls();
      const first = other || !result;
      await compute();
      if (first) look();
      else remember();
    },
    inspect: () => ({ state, result, view: [zoom.k, zoom.x, zoom.y, split.value] }),
    commands: () => ({
      shell: `batten curve ${shellName(file)} --scheme ${state.scheme} --levels ${state.levels}${state.topology ? "" : " --topology separate"}${state.keep_area ? " --keep-area" : ""} -o fine.${plane ? "wkt" : "geojson"} --picture fine.png`,
      c: `bat_curve_set map, fine;\nbat_error error;\nbat_curve_read(${quoted(file)}, NULL, &map, &error);\nbat_curve_map_refine_options options = bat_curve_map_refine_defaults();\noptions.refine.levels = ${state.levels};\noptions.refine.find_corners = true;\noptions.topology = BAT_CURVE_MAP_TOPOLOGY_${state.topology ? "FEATURES" : "SEPARATE"};${state.keep_area ? "\noptions.keep_area = true;" : ""}\nbat_curve_scheme_by_name("${state.scheme}", &options.refine.scheme, &error);\nif (bat_curve_map_refine(&map, &options, &fine, &error) == BAT_OK)\n    bat_curve_write("fine.${plane ? "wkt" : "geojson"}", &fine, NULL, &error);`,
      python: `${imports(shapesIn(file)[0])}\n\n${shapesIn(file)[2] ?? ""}countries = ${shapesIn(file)[1]}\nfine = batten.smooth(countries, scheme="${state.scheme}", levels=${state.levels}, find_corners=True${result?.space === "sphere" && /\.(e?wkt|csv|obj)$/i.test(file) ? ', space="sphere"' : ""}${state.topology ? "" : ', topology="separate"'}${state.keep_area ? ", keep_area=True" : ""})\nfine.to_file("fine.${plane ? "gpkg" : "geojson"}")`,
    }),
  };
}
