// A view in three dimensions: a surface with colours, lines and points; what was given beside what was made.
import { BufferAttribute, BufferGeometry, Color, DirectionalLight, HemisphereLight, LineBasicMaterial, LineSegments, Mesh, MeshStandardMaterial, PerspectiveCamera, Points, PointsMaterial, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { color, h } from "./dom.js";

/** Of the camera, in degrees. */
const VIEW_ANGLE = 35;
/** Colours from 0 to 1, readable on light and dark (Viridis, sampled). */
const RAMP = ["#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"].map((c) => new Color(c));
/** Meshes with more corners than this get no lines. */
const MAX_WIRED = 900000;

/** Colours of values from 0 to the largest. */
function ramp(values) {
  const most = values.reduce((a, b) => Math.max(a, b), 0) || 1;
  const colors = new Float32Array(3 * values.length);
  const shade = new Color();
  values.forEach((value, i) => {
    const t = (Math.max(0, value) / most) * (RAMP.length - 1);
    const k = Math.min(RAMP.length - 2, Math.floor(t));
    shade.copy(RAMP[k]).lerp(RAMP[k + 1], t - k);
    colors.set([shade.r, shade.g, shade.b], 3 * i);
  });
  return { colors, most };
}

/** The edges of faces, each once. */
function edgesOf({ faces, offsets }) {
  const edges = new Set();
  const count = offsets ? offsets.length - 1 : faces.length / 3;
  for (let f = 0; f < count && faces.length < MAX_WIRED; f++) {
    const [begin, end] = offsets ? [offsets[f], offsets[f + 1]] : [3 * f, 3 * f + 3];
    for (let c = begin; c < end; c++) {
      const [a, b] = [faces[c], faces[c + 1 < end ? c + 1 : begin]];
      edges.add(Math.min(a, b) * 2 ** 26 + Math.max(a, b));
    }
  }
  const indices = new Uint32Array(2 * edges.size);
  let at = 0;
  for (const edge of edges) {
    indices[at++] = Math.floor(edge / 2 ** 26);
    indices[at++] = edge % 2 ** 26;
  }
  return indices;
}

/** Half the width of the slider's thumb. */
const INSET = 17;
/** Milliseconds in which the slider shows itself. */
const SWEEP = 1200;

/** A slider over a stage: to its left what was given, to its right the result. */
export function divider(stage, change) {
  const line = h("div.divider", { "aria-hidden": "true" });
  const input = h("input.divide", { type: "range", min: 0, max: 100, step: 1, value: 50, "aria-label": "Before and after: the given to the left, the result to the right" });
  const set = (value) => {
    input.value = value;
    line.style.left = `calc(${INSET}px + (100% - ${2 * INSET}px) * ${value / 100})`;
    line.hidden = Number(value) <= 0 || Number(value) >= 100;
  };
  input.addEventListener("input", () => {
    set(input.value);
    change();
  });
  for (const name of ["pointerdown", "dblclick"]) input.addEventListener(name, (event) => event.stopPropagation());
  input.addEventListener("keydown", (event) => event.stopPropagation());
  stage.append(line, input);
  set(50);
  return {
    get value() {
      return Number(input.value);
    },
    get share() {
      const value = Number(input.value) / 100;
      if (input.hidden || value === 0 || value === 1) return input.hidden ? 0 : value;
      const { width } = stage.getBoundingClientRect();
      return (INSET + (width - 2 * INSET) * value) / (width || 1);
    },
    set,
    /** Move from the right to the middle, where the reader allows motion. */
    sweep() {
      if (matchMedia("(prefers-reduced-motion: reduce)").matches) return;
      let start = null; // of the first frame, which a large mesh delays
      let last = input.value;
      const step = (now) => {
        if (input.value !== last) return; // the reader took it
        start ??= now;
        const rest = Math.max(0, 1 - (now - start) / SWEEP);
        set(Math.round(50 + 45 * rest ** 2));
        last = input.value;
        change();
        if (rest > 0) requestAnimationFrame(step);
      };
      requestAnimationFrame(step);
    },
    hide(hidden) {
      input.hidden = hidden;
      line.hidden = hidden;
    },
  };
}

export function scene3d(stage, section) {
  let made = null;
  let missing = false;
  let frame = 0;
  function setup() {
    let renderer;
    try {
      renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true, alpha: true });
    } catch {
      missing = true;
      stage.append(h("p.missing", {}, "This browser draws nothing in three dimensions: WebGL is off or missing. Figures and downloads are there all the same."));
      return;
    }
    renderer.setPixelRatio(Math.min(devicePixelRatio || 1, 2));
    stage.prepend(renderer.domElement);
    renderer.domElement.setAttribute("aria-hidden", "true");
    renderer.setClearColor(0, 0);
    const camera = new PerspectiveCamera(VIEW_ANGLE, 1, 0.01, 100);
    camera.position.set(1.75, -2.55, 1.65);
    camera.up.set(0, 0, 1);
    const world = new Scene();
    world.add(new HemisphereLight(0xffffff, 0x556070, 1.6));
    const light = new DirectionalLight(0xffffff, 2.2);
    light.position.set(1, -1, 2);
    camera.add(light);
    world.add(camera);
    const solid = () => new Mesh(new BufferGeometry(), new MeshStandardMaterial({ roughness: 0.55, metalness: 0.05, side: 2, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
    const surface = solid();
    const before = solid();
    before.material.flatShading = true;
    const wires = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ transparent: true, opacity: 0.35 }));
    const points = new Points(new BufferGeometry(), new PointsMaterial({ size: 2.5, sizeAttenuation: false }));
    world.add(surface, before, wires, points);
    const controls = new OrbitControls(camera, renderer.domElement);
    controls.addEventListener("change", redraw);
    made = { renderer, camera, world, surface, before, wires, points, controls, split: () => 0 };
  }
  stage.addEventListener("keydown", (event) => {
    if (!made || event.target !== stage) return;
    const turn = { ArrowLeft: [0.15, 0], ArrowRight: [-0.15, 0], ArrowUp: [0, 0.15], ArrowDown: [0, -0.15] }[event.key];
    const nearer = { "+": 0.85, "-": 1.18 }[event.key];
    if (!turn && !nearer) return;
    event.preventDefault();
    const p = made.camera.position;
    if (turn) {
      p.applyAxisAngle(new Vector3(0, 0, 1), -turn[0]);
      p.applyAxisAngle(new Vector3(0, 0, 1).cross(p).normalize(), -turn[1]);
    } else p.multiplyScalar(nearer);
    made.controls.update();
    redraw();
  });
  const replace = (object, geometry) => {
    object.geometry.dispose();
    object.geometry = geometry;
  };
  const geometryOf = (positions, faces) => {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    if (faces) geometry.setIndex(new BufferAttribute(faces, 1));
    return geometry;
  };

  /**
   * Show a mesh of triangles, with colours by values at its vertices; beside it the mesh or the points that it was made of.
   * Gives the largest value.
   */
  function show({ low, high, mesh = null, values = null, flat = false, before = null, wired = null, cloud = null, wires = true, split = () => 0 }) {
    if (!made && !missing) setup();
    if (missing) return null;
    const size = Math.max(...high.map((value, i) => value - low[i])) || 1;
    const middle = low.map((value, i) => (value + high[i]) / 2);
    const place = (positions) => Float32Array.from(positions, (value, i) => ((value - middle[i % 3]) * 2) / size);
    let most = null;
    let shown = mesh ? geometryOf(place(mesh.positions), mesh.faces) : new BufferGeometry();
    if (mesh && values) {
      const painted = ramp(values);
      most = painted.most;
      shown.setAttribute("color", new BufferAttribute(painted.colors, 3));
    }
    if (mesh && flat) shown = shown.toNonIndexed();
    if (mesh) shown.computeVertexNormals();
    replace(made.surface, shown);
    made.surface.material.vertexColors = Boolean(values);
    made.surface.material.needsUpdate = true;
    const old = before ? geometryOf(place(before.positions), before.faces) : new BufferGeometry();
    if (before) old.computeVertexNormals();
    replace(made.before, old);
    replace(made.wires, wired ? geometryOf(place(wired.positions), edgesOf(wired)) : new BufferGeometry());
    replace(made.points, cloud ? geometryOf(place(cloud)) : new BufferGeometry());
    Object.assign(made, { split, wired: wires, hasMesh: Boolean(mesh), hasBefore: Boolean(before), hasCloud: Boolean(cloud) });
    redraw();
    return most;
  }

  function redraw() {
    cancelAnimationFrame(frame);
    frame = requestAnimationFrame(draw);
  }
  function draw() {
    if (section.hidden || !made) return;
    const { renderer, camera, world, surface, before, wires, points } = made;
    const { width, height } = stage.getBoundingClientRect();
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    // The same width of the scene also where the picture is narrow.
    camera.fov = (360 / Math.PI) * Math.atan(Math.tan((VIEW_ANGLE * Math.PI) / 360) / Math.min(1, width / height / 1.15));
    camera.updateProjectionMatrix();
    // The lines, of the theme's ink, must stand out from the surface.
    const [shade, other] = surface.material.vertexColors ? ["#ffffff", "#ffffff"] : [color("c0"), color("stage")];
    surface.material.color.set(shade).lerp(new Color(other), 0.4);
    before.material.color.set(color("given")).lerp(new Color(color("stage")), 0.35);
    wires.material.color.set(color("ink"));
    points.material.color.set(color("ink"));
    renderer.setScissorTest(true);
    const at = Math.round(width * made.split());
    for (const [left, right, given] of [[0, at, true], [at, width, false]]) {
      if (right <= left) continue;
      renderer.setScissor(left, 0, right - left, height);
      before.visible = given && made.hasBefore;
      surface.visible = !given && made.hasMesh;
      wires.visible = made.wired || given;
      wires.material.opacity = given ? 0.7 : 0.35;
      wires.material.depthTest = given; // the fine surface is beside the coarse edges
      points.visible = made.hasCloud && (given || !made.hasMesh);
      renderer.render(world, camera);
    }
  }
  return { show, redraw, picture: (name, download) => made?.renderer.domElement.toBlob((blob) => download(name, blob)) };
}
