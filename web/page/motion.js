// Motions: keyframes on a timeline, the body that flies along, and its speed.
import samples from "samples";
import { quoted, shellName } from "./code.js";
import { check, color, digits, download, enumerator, formatOf, group, h, notes, opener, select, sized, slider, table } from "./dom.js";

/** Places at which a motion is sampled: of motions with few and with many keyframes. */
const SAMPLES = 600;
const MANY_SAMPLES = 6000;
/** Motions of more keyframes are shown as their file has them, and not edited. */
const MAX_EDITED = 2000;
const MAX_KEYS = 100000;
/** Of more keyframes some are marked. */
const MAX_MARKS = 120;
/** The controls of options that lead out of failures. */
const CONTROLS = { shape: "Shape" };
const parse = (text) =>
  text
    .split("\n")
    .filter((line) => /^[-\d.]/.test(line))
    .map((line) => line.split(",").map(Number))
    .map((row) => {
      // Files have few digits; quaternions are of unit length to 1e-9.
      const length = Math.hypot(...row.slice(4));
      return row.map((value, i) => (i < 4 ? value : value / length));
    });

export function motionTab(app, section) {
  const first = parse(samples["camera-keyframes.csv"]);
  const lists = app.tables.lists;
  let state = { keys: first, shape: "resting", ends: "auto", rate: 25, notes: [], data: 0 };
  let result = null;
  let big = null; // the keyframes of a file that is too large to edit
  let good = { state: structuredClone(state), big }; // the last that gave a picture
  let wanted = null; // the state that undo or a link asks for, until its file is read
  let started = false;
  let now = 0.35;
  let playing = 0;
  let held = -1;
  let turn = { yaw: 0.7, tilt: 0.55, zoom: 1 };
  const canvas = h("canvas", { role: "img", "aria-label": "The path of the body, with keyframes" });
  const legend = h("div.legend", {}, "");
  const stage = h("div.stage", { tabIndex: 0, role: "group", "aria-label": "Motion in space; arrow keys turn the view" }, canvas, legend);
  const chart = h("canvas", { role: "img", "aria-label": "Speed over time" });
  const speedBox = h("div.chart", {}, chart);
  const line = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  line.setAttribute("role", "group");
  line.setAttribute("aria-label", "Timeline: left and right arrow move a keyframe in time, Delete removes it");
  const timeline = h("div.chart", { style: "height:64px" }, line);
  const facts = h("div", {});

  const rows = () => big ?? state.keys;
  /** The keyframes that have a mark. */
  const marked = () => {
    const all = rows();
    return big ? Array.from({ length: MAX_MARKS }, (_, i) => all[Math.round((i * (all.length - 1)) / (MAX_MARKS - 1))]) : all;
  };
  const keys = () => {
    const all = rows();
    const points = new Float64Array(7 * all.length);
    all.forEach((row, i) => points.set(row.slice(1), 7 * i));
    return { space: "rigid", points, times: Float64Array.from(all, (row) => row[0]) };
  };
  const sampled = () => result.times.length;
  let opening; // the name of a file that has no picture yet
  let working = Promise.resolve(null);
  const compute = () => {
    wanted = null;
    return (working = sample());
  };
  /** True once the motion is drawn, null where a newer call takes over, false after a failure, of which the user is told. */
  async function sample() {
    const tried = { state: structuredClone(state), big };
    try {
      if (rows().length < 2) throw new Error(`a motion needs at least 2 keyframes, not ${rows().length}`);
      result = await app.engine.latest("motion", "motion", { keys: keys(), samples: big ? MANY_SAMPLES : SAMPLES, options: { shape: state.shape, ends: state.ends } }, "Sampling");
      good = tried;
      app.clear();
      figures();
    } catch (error) {
      app.fail(error, opening, CONTROLS);
      return error.message === "superseded" ? null : false;
    }
    redraw();
    return true;
  }
  /** A step of undo, once its picture is there; without one the last good state comes back. */
  async function keep() {
    const done = await working;
    if (done) app.commit();
    else if (done === false) back();
    return done;
  }
  function back() {
    state = structuredClone(good.state);
    ({ big } = good);
    controls();
    if (result) redraw();
    else void compute();
  }
  const speed = (i) => Math.hypot(...result.velocities.subarray(6 * i, 6 * i + 3));
  const spin = (i) => Math.hypot(...result.velocities.subarray(6 * i + 3, 6 * i + 6));
  function figures() {
    let [fast, slow, fastest] = [0, Infinity, 0];
    let length = 0;
    for (let i = 0; i < sampled(); i++) {
      fast = Math.max(fast, speed(i));
      slow = Math.min(slow, speed(i));
      fastest = Math.max(fastest, spin(i));
      if (i) length += Math.hypot(...[0, 1, 2].map((c) => result.points[7 * i + c] - result.points[7 * i - 7 + c]));
    }
    facts.replaceChildren(table(["", ""], [["keyframes", `${digits(rows().length)}${big ? `, ${MAX_MARKS} marked` : ""}`], ["length of the path", digits(length)], ["speed", `${digits(slow, 3)} to ${digits(fast, 3)}`], ["fastest turn", `${digits((fastest * 180) / Math.PI, 3)} °/s`]]), ...notes(state.notes));
  }

  // Drawing.
  let frame = 0;
  function redraw() {
    cancelAnimationFrame(frame);
    frame = requestAnimationFrame(draw);
  }
  let project = null;
  function camera(width, height) {
    let [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    for (let i = 0; i < sampled(); i++)
      for (let c = 0; c < 3; c++) {
        low[c] = Math.min(low[c], result.points[7 * i + c]);
        high[c] = Math.max(high[c], result.points[7 * i + c]);
      }
    const middle = low.map((value, c) => (value + high[c]) / 2);
    const size = Math.max(...high.map((value, c) => value - low[c]), 1e-9);
    const [cy, sy, ct, st] = [Math.cos(turn.yaw), Math.sin(turn.yaw), Math.cos(turn.tilt), Math.sin(turn.tilt)];
    const scale = (0.72 * turn.zoom * Math.min(width, height * 1.5)) / size;
    return {
      size,
      low,
      to: (p) => {
        const [x, y, z] = p.map((value, c) => value - middle[c]);
        const [a, b] = [cy * x + sy * y, -sy * x + cy * y];
        return [width / 2 + a * scale, height / 2 - (b * st + z * ct) * scale];
      },
    };
  }
  const rotated = ([w, x, y, z], [a, b, c]) => {
    const [tx, ty, tz] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
    return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
  };
  function body(context, pose, size, fill, width) {
    const [p, q] = [pose.slice(0, 3), pose.slice(3, 7)];
    const corner = (x, y, z) => project.to(rotated(q, [x * size, y * size, z * size]).map((value, c) => value + p[c]));
    const eye = project.to(p);
    const frustum = [corner(-0.7, -0.5, -1), corner(0.7, -0.5, -1), corner(0.7, 0.5, -1), corner(-0.7, 0.5, -1)];
    context.strokeStyle = fill;
    context.lineWidth = width;
    context.beginPath();
    frustum.forEach((c, i) => {
      context.moveTo(...eye);
      context.lineTo(...c);
      context.lineTo(...frustum[(i + 1) % 4]);
    });
    context.moveTo(...corner(0, 0.5, -1));
    context.lineTo(...corner(0, 0.85, -1));
    context.stroke();
  }
  function draw() {
    if (section.hidden || !result) return;
    const { context, width, height } = sized(canvas);
    project = camera(width, height);
    const at = (i) => project.to([...result.points.subarray(7 * i, 7 * i + 3)]);
    // The ground below the path.
    context.strokeStyle = color("grid");
    context.lineWidth = 1;
    const ground = project.low[2];
    context.beginPath();
    for (let i = 0; i < sampled(); i++) {
      const p = project.to([result.points[7 * i], result.points[7 * i + 1], ground]);
      if (i) context.lineTo(...p);
      else context.moveTo(...p);
      if (i % (sampled() / 20) === 0) {
        context.lineTo(...at(i));
        context.moveTo(...p);
      }
    }
    context.stroke();
    context.strokeStyle = color("c0");
    context.lineWidth = 2.2;
    context.beginPath();
    for (let i = 0; i < sampled(); i++) if (i) context.lineTo(...at(i));
      else context.moveTo(...at(i));
    context.stroke();
    for (const row of marked()) {
      body(context, row.slice(1), 0.055 * project.size, color("given"), 1.1);
      context.fillStyle = color("ink");
      context.beginPath();
      context.arc(...project.to(row.slice(1, 4)), 3.5, 0, 7);
      context.fill();
    }
    const i = Math.round(now * (sampled() - 1));
    body(context, [...result.points.subarray(7 * i, 7 * i + 7)], 0.1 * project.size, color("c1"), 2.4);
    legend.textContent = `time ${digits(result.times[i], 3)}, speed ${digits(speed(i), 3)}, turning ${digits((spin(i) * 180) / Math.PI, 3)} °/s`;
    plot();
    ticks();
  }
  function plot() {
    const { context, width, height } = sized(chart);
    const pad = 14;
    const most = Math.max(...Array.from({ length: sampled() }, (_, i) => speed(i)), 1e-12);
    const turning = Math.max(...Array.from({ length: sampled() }, (_, i) => spin(i)), 1e-12);
    const x = (i) => pad + (i / (sampled() - 1)) * (width - 2 * pad);
    const curve = (value, top, stroke, dash) => {
      context.strokeStyle = stroke;
      context.lineWidth = 2;
      context.setLineDash(dash);
      context.beginPath();
      for (let i = 0; i < sampled(); i++) {
        const y = height - 10 - (value(i) / top) * (height - 40);
        if (i) context.lineTo(x(i), y);
        else context.moveTo(x(i), y);
      }
      context.stroke();
      context.setLineDash([]);
    };
    curve(speed, most, color("c0"), []);
    curve(spin, turning, color("c3"), [6, 4]);
    context.font = "12px system-ui, sans-serif";
    context.fillStyle = color("c0");
    context.fillText(`speed, to ${digits(most, 3)}`, pad, 16);
    context.fillStyle = color("c3");
    context.textAlign = "right";
    context.fillText(`turning (dashed), to ${digits((turning * 180) / Math.PI, 3)} °/s`, width - pad, 16);
    context.textAlign = "left";
    context.strokeStyle = color("c1");
    context.beginPath();
    context.moveTo(x(now * (sampled() - 1)), 22);
    context.lineTo(x(now * (sampled() - 1)), height);
    context.stroke();
  }
  const marks = [];
  const range = () => [rows()[0][0], rows()[rows().length - 1][0]];
  function ticks() {
    const { width } = timeline.getBoundingClientRect();
    line.setAttribute("viewBox", `0 0 ${width} 64`);
    const shown = marked();
    while (marks.length > shown.length || (marks.length > 0 && marks[0].hasAttribute("tabindex") === Boolean(big))) marks.pop().remove();
    while (marks.length < shown.length) {
      const mark = document.createElementNS("http://www.w3.org/2000/svg", "circle");
      // Marks of a few keyframes among many are no handles.
      for (const [name, value] of [["r", big ? 2 : 8], ["cy", 34], ...(big ? [["aria-hidden", true]] : [["tabindex", 0], ["role", "button"]])]) mark.setAttribute(name, value);
      line.append(mark);
      marks.push(mark);
    }
    const [begin, end] = range();
    marks.forEach((mark, i) => {
      mark.setAttribute("cx", 14 + ((shown[i][0] - begin) / (end - begin || 1)) * (width - 28));
      mark.setAttribute("class", big ? "mark" : `handle${i === held ? " held" : ""}`);
      if (!big) mark.setAttribute("aria-label", `Keyframe ${i + 1} at time ${digits(shown[i][0], 4)}`);
    });
  }
  function shift(i, time) {
    const gap = 0.02 * (range()[1] - range()[0]);
    const low = i > 0 ? state.keys[i - 1][0] + gap : -Infinity;
    const high = i < state.keys.length - 1 ? state.keys[i + 1][0] - gap : Infinity;
    state.keys[i][0] = Number(Math.max(low, Math.min(high, time)).toPrecision(5));
    void compute();
  }
  const remove = (i) => {
    if (state.keys.length <= 2) return;
    state.keys.splice(i, 1);
    void compute();
    void keep();
  };
  const timeAt = (event) => {
    const box = line.getBoundingClientRect();
    const [begin, end] = range();
    return begin + ((event.clientX - box.left - 14) / (box.width - 28)) * (end - begin);
  };
  line.addEventListener("pointerdown", (event) => {
    held = big ? -1 : marks.indexOf(event.target);
    line.setPointerCapture(event.pointerId);
    if (held < 0) seek(timeAt(event));
    else marks[held].focus();
  });
  line.addEventListener("pointermove", (event) => {
    if (!line.hasPointerCapture(event.pointerId)) return;
    // The ends stay: the axis would move under the hand.
    if (held > 0 && held < state.keys.length - 1) shift(held, timeAt(event));
    else if (held < 0) seek(timeAt(event));
  });
  line.addEventListener("pointerup", () => {
    if (held >= 0) void keep();
    held = -1;
    redraw();
  });
  line.addEventListener("keydown", (event) => {
    const i = big ? -1 : marks.indexOf(event.target);
    const step = (range()[1] - range()[0]) / 100;
    if (i < 0) return;
    if (event.key === "ArrowLeft") shift(i, state.keys[i][0] - step);
    else if (event.key === "ArrowRight") shift(i, state.keys[i][0] + step);
    else if (event.key === "Delete") remove(i);
    else return;
    event.preventDefault();
    void keep();
  });
  function seek(time) {
    const [begin, end] = range();
    now = Math.max(0, Math.min(1, (time - begin) / (end - begin)));
    redraw();
  }
  let last = null;
  stage.addEventListener("pointerdown", (event) => {
    stage.setPointerCapture(event.pointerId);
    last = [event.clientX, event.clientY];
  });
  stage.addEventListener("pointermove", (event) => {
    if (!stage.hasPointerCapture(event.pointerId) || !last) return;
    turn.yaw -= (event.clientX - last[0]) / 150;
    turn.tilt = Math.max(0.02, Math.min(1.55, turn.tilt + (event.clientY - last[1]) / 200));
    last = [event.clientX, event.clientY];
    redraw();
  });
  stage.addEventListener("pointerup", () => (last = null));
  stage.addEventListener("wheel", (event) => {
    event.preventDefault();
    turn.zoom = Math.max(0.3, Math.min(20, turn.zoom * Math.exp(-event.deltaY / 500)));
    redraw();
  }, { passive: false });
  stage.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: [0.12, 0], ArrowRight: [-0.12, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
    if (!steps) return;
    event.preventDefault();
    turn.yaw += steps[0];
    turn.tilt = Math.max(0.02, Math.min(1.55, turn.tilt + steps[1]));
    redraw();
  });

  function play() {
    if (playing) {
      cancelAnimationFrame(playing);
      playing = 0;
    } else {
      let before = performance.now();
      const tick = (time) => {
        const [begin, end] = range();
        now = (now + (time - before) / 1000 / Math.min(12, Math.max(3, end - begin))) % 1;
        before = time;
        draw();
        playing = section.hidden ? 0 : requestAnimationFrame(tick);
      };
      playing = requestAnimationFrame(tick);
    }
    button.textContent = playing ? "Pause" : "Play";
    button.setAttribute("aria-pressed", String(Boolean(playing)));
  }
  const button = h("button.main", { type: "button", onclick: play, "aria-pressed": "false" }, "Play");
  const change = (changes) => {
    Object.assign(state, changes);
    controls();
    void compute();
    return keep();
  };
  const shape = select(CONTROLS.shape, lists.motion_shape.map(({ name }) => [name]), state.shape, (value) => change({ shape: value }));
  const ends = select("Ends", lists.motion_ends.map(({ name }) => [name]), state.ends, (value) => change({ ends: value }));
  const rate = slider("Poses a second in files", { min: 1, max: 100, step: 1, value: 25, change: (value) => (state.rate = value), commit: () => app.commit() });
  function controls() {
    adder.disabled = Boolean(big);
    adder.title = big ? `more than ${MAX_EDITED} keyframes are not edited here` : "";
    shape.set(state.shape);
    ends.set(state.ends);
    rate.set(state.rate);
  }
  const adder = h("button", { type: "button", onclick: add }, "Add a keyframe here");
  function add() {
    const i = Math.round(now * (sampled() - 1));
    const row = [Number(result.times[i].toPrecision(6)), ...Array.from(result.points.subarray(7 * i, 7 * i + 7))];
    if (!state.keys.some((key) => Math.abs(key[0] - row[0]) < 1e-9)) void change({ keys: [...state.keys, row].sort((a, b) => a[0] - b[0]) });
  }
  const csv = () => `# space: rigid\ntime,tx,ty,tz,qw,qx,qy,qz\n${state.keys.map((row) => row.join(",")).join("\n")}\n`;
  async function read(bytes, name) {
    const set = await app.engine.call("readCurves", { bytes, options: formatOf(lists.curve_format, name) }, "Reading");
    const { points, channels } = set.curves[0];
    if (set.space !== "rigid") throw new Error(`this tab flies poses, of the space 'rigid', not of '${set.space}'`);
    const count = points.length / 7;
    if (count > MAX_KEYS) throw new Error(`${count} keyframes are too many for this page; the program takes them`);
    const width = channels ? channels.length / count : 0;
    return { keys: Array.from({ length: count }, (_, i) => [set.has_times && width ? channels[i * width] : i, ...points.slice(7 * i, 7 * i + 7)]), notes: set.notes };
  }
  async function open(file) {
    app.clear();
    try {
      const bytes = new Uint8Array(await file.arrayBuffer());
      const { keys: next, notes: told } = await read(bytes, file.name);
      opening = file.name;
      big = next.length > MAX_EDITED ? next : null;
      return (await change({ keys: big ? [] : next, notes: told, data: big ? app.keep(file.name, bytes) : 0 })) === true;
    } catch (error) {
      app.fail(error, file.name);
      return false;
    } finally {
      opening = undefined;
    }
  }
  const given = () => (big ? { bytes: app.file(state.data).bytes, read: formatOf(lists.curve_format, app.file(state.data).name) } : { bytes: csv(), read: { format: "csv" } });
  async function save(format) {
    app.clear(true);
    try {
      download(`motion.${{ tum: "tum", csv: "csv" }[format] ?? `${format}.txt`}`, await app.engine.call("motionFile", { ...given(), options: { rate: state.rate, shape: state.shape, ends: state.ends }, format }, "Writing"));
    } catch (error) {
      app.fail(error);
    }
  }
  section.append(
    h("div.column", {}, stage, timeline, speedBox),
    h("div.side", {},
      group("Motion", h("div.row", {}, button, opener("Open file", ".csv,.tum,.txt", open), h("button", { type: "button", onclick: () => { big = null; void change({ keys: parse(samples["camera-keyframes.csv"]), notes: [], data: 0 }); } }, "Example")), h("p.hint", {}, "A camera circles a table. Drag keyframes on the timeline; the ends stay. Drag the view to turn it."), shape.element, ends.element, adder),
      group("Figures", facts),
      group("Download", rate.element, h("div.row", {}, ...["csv", "tum", "euroc", "kitti"].map((format) => h("button", { type: "button", onclick: () => save(format) }, format.toUpperCase())))),
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
      const mine = (wanted = structuredClone(next));
      started = true;
      const file = next.keys.length === 0 && next.data ? app.file(next.data) : null;
      let found = file && state.data === next.data ? big : null;
      if (file && !found) {
        found = (await read(file.bytes, file.name)).keys;
        if (wanted !== mine) return; // a later step of undo, or a change
      }
      // Together: the timeline is drawn from both.
      [state, big] = [mine, found];
      controls();
      if ((await compute()) === false) back();
    },
    inspect: () => ({ state, result }),
    commands() {
      const own = big ? app.file(state.data)?.name : null;
      const file = own ?? "keyframes.csv";
      return {
        shell: `${own ? "" : `cat > keyframes.csv <<'END'\n${csv()}END\n`}batten motion ${shellName(file)} --rate ${state.rate}${state.ends === "auto" ? "" : ` --ends ${state.ends}`}${state.shape === "resting" ? "" : ` --tangents ${state.shape}`} -o frames.tum`,
        c: `bat_curve_set keys, frames;\nbat_error error;\nbat_curve_read(${quoted(file)}, NULL, &keys, &error);\nbat_motion_curves_options options = bat_motion_curves_defaults();\noptions.rate = ${state.rate};\noptions.spline.shape = ${enumerator("motion_shape", state.shape)};\noptions.spline.ends = ${enumerator("motion_ends", state.ends)};\nif (bat_motion_curves(&keys, &options, &frames, &error) == BAT_OK)\n    bat_curve_write("frames.tum", &frames, NULL, &error);`,
        python: own
          ? `import batten\nimport numpy as np\n\npose = batten.Motion.read(${quoted(own)}, shape="${state.shape}", ends="${state.ends}")\nframes = pose(np.arange(*pose.range, 1 / ${state.rate}))`
          : `import batten\nimport numpy as np\n\nkeys = np.loadtxt("keyframes.csv", delimiter=",", skiprows=2)\npose = batten.Motion(keys[:, 0], keys[:, 1:], space="rigid", shape="${state.shape}", ends="${state.ends}")\nframes = pose(np.arange(keys[0, 0], keys[-1, 0], 1 / ${state.rate}))`,
      };
    },
  };
}
