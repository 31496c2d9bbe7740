// Analysis of a mask: its basic limit function, eigenvalues and smoothness.
import { color, digits, group, h, select, sized, table } from "./dom.js";

const EXAMPLES = [
  ["1/4, 3/4, 3/4, 1/4", "Chaikin"],
  ["-1/16, 0, 9/16, 1, 9/16, 0, -1/16", "four-point"],
  ["3/256, 0, -25/256, 0, 75/128, 1, 75/128, 0, -25/256, 0, 3/256", "six-point"],
  ["1/8, 4/8, 6/8, 4/8, 1/8", "cubic B-spline"],
  ["-1/8, 0, 5/8, 1, 5/8, 0, -1/8", "four-point, w = 1/8"],
  ["1/2, 1, 1/2", "linear interpolation"],
];

export function analyzeTab(app, section) {
  let state = { mask: EXAMPLES[1][0] };
  let result = null;
  let started = false;
  const canvas = h("canvas", { role: "img", "aria-label": "The basic limit function" });
  const legend = h("div.legend", { style: "top:8px;bottom:auto" }, "The basic limit function: the limit of 1 at point 0 and 0 elsewhere");
  const stage = h("div.stage", {}, canvas, legend);
  const facts = h("div", {});
  const values = h("div", {});
  const stencils = h("div.stencils", {});
  const input = h("textarea", { rows: 3, spellcheck: false, onchange: () => set(input.value), onkeydown: (event) => { if (event.key === "Enter" && !event.shiftKey) { event.preventDefault(); set(input.value); } } });
  const name = () => `mask:${state.mask.trim().split(/[\s,]+/).join(",")}`;
  function set(mask) {
    state.mask = mask;
    input.value = mask;
    void compute().then(() => app.commit());
  }
  async function compute() {
    input.value = state.mask;
    try {
      result = await app.engine.latest("analyze", "analyze", { scheme: name(), level: 8 }, "Analyzing");
      app.clear();
    } catch (error) {
      app.fail(error);
      if (error.message === "superseded") return;
      result = null;
    }
    show();
  }
  function show() {
    if (!result) {
      for (const part of [facts, values, stencils]) part.replaceChildren();
      redraw();
      return;
    }
    const { analysis, refused } = result;
    const smooth = analysis.smooth_proven;
    facts.replaceChildren(
      table(["", ""], [
        ["converges", analysis.converges],
        ["smoothness", smooth < 0 ? "none proven" : `C${smooth} proven${analysis.smooth_disproven > 0 ? `, not C${analysis.smooth_disproven}` : ""}`],
        ["Hölder exponent", Math.abs(analysis.exponent_lower - analysis.exponent_upper) < 1e-7 ? digits(analysis.exponent_lower, 7) : `${digits(analysis.exponent_lower, 6)} to ${digits(analysis.exponent_upper, 6)}`],
        ["keeps the points", analysis.is_interpolatory ? "yes" : "no"],
        ["symmetric", analysis.is_symmetric ? "yes" : "no"],
        ["reproduces degree", digits(analysis.reproduction_degree)],
        ["generates degree", digits(analysis.generation_degree)],
        ["factor (1 + z)", `power ${analysis.multiplicity}`],
      ]),
      ...(refused ? [h("p.hint", {}, refused)] : []),
    );
    values.replaceChildren(table(["eigenvalue", "times"], analysis.eigenvalues.slice(0, 10).map((v) => [Math.abs(v.imaginary) > 1e-12 ? `${digits(v.real, 6)} ${v.imaginary > 0 ? "+" : "−"} ${digits(Math.abs(v.imaginary), 6)} i` : digits(v.real, 8), digits(v.multiplicity)])));
    const row = (title, { weights, first }) => (weights.length ? [[title, weights.map((w) => digits(w, 5)).join("  "), String(first)]] : []);
    stencils.replaceChildren(table(["stencil", "weights", "from"], [...row("limit at a point", analysis.vertex), ...row("tangent", analysis.tangent)]));
    redraw();
  }
  let frame = 0;
  function redraw() {
    cancelAnimationFrame(frame);
    frame = requestAnimationFrame(draw);
  }
  function draw() {
    if (section.hidden) return;
    const { context, width, height } = sized(canvas);
    if (!result?.basis) return;
    const { values: ys, level, first, last } = result.basis;
    let [low, high] = [0, 0];
    for (const y of ys) [low, high] = [Math.min(low, y), Math.max(high, y)];
    const pad = 58;
    context.font = "12px system-ui, sans-serif";
    const label = (v) => digits(v, 3).replace("-", "−");
    const left = Math.max(pad, ...[low, high].map((v) => context.measureText(label(v)).width + 24));
    const x = (t) => left + ((t - first) / (last - first || 1)) * (width - left - pad);
    const y = (v) => height - pad - ((v - low) / (high - low || 1)) * (height - 2 * pad);
    context.fillStyle = color("soft");
    context.textAlign = "center";
    context.strokeStyle = color("grid");
    for (let t = first; t <= last; t++) {
      context.beginPath();
      context.moveTo(x(t), y(low));
      context.lineTo(x(t), y(high));
      context.stroke();
      context.fillText(String(t).replace("-", "−"), x(t), height - pad + 18);
    }
    context.textAlign = "right";
    for (const v of [...new Set([low, 0, high])]) {
      context.beginPath();
      context.moveTo(left, y(v));
      context.lineTo(width - pad, y(v));
      context.stroke();
      context.fillText(label(v), left - 6, y(v) + 4);
    }
    context.strokeStyle = color("c0");
    context.lineWidth = 2.2;
    context.lineJoin = "round";
    context.beginPath();
    ys.forEach((v, i) => (i ? context.lineTo(x(first + i / 2 ** level), y(v)) : context.moveTo(x(first), y(v))));
    context.stroke();
  }
  const example = select("Example", [["", "choose …"], ...EXAMPLES], "", (mask) => {
    if (mask) set(mask);
    example.set("");
  });
  section.append(
    h("div.column", {}, stage, group("Stencils", stencils)),
    h("div.side", {},
      group("Mask", h("label.field", {}, h("span", {}, "Coefficients, numbers or fractions"), input), h("div.row", {}, h("button.main", { type: "button", onclick: () => set(input.value) }, "Analyze"), example.element), h("p.hint", {}, "New point i is the sum of a(i − 2j) times old point j. The mask is centred; 1/4,3/4,3/4,1/4@-2 begins at −2.")),
      group("Proven", facts),
      group("Local matrix", values),
    ),
  );
  return {
    redraw,
    show() {
      if (!started) {
        started = true;
        void compute();
      }
      redraw();
    },
    state: () => state,
    async restore(next) {
      state = { ...next };
      started = true;
      await compute();
    },
    inspect: () => ({ state, result }),
    commands: () => ({
      shell: `batten analyze ${name()} --picture basis.png`,
      c: `// #include <batten/research/curve_analysis.h>, which batten-research has\nbat_curve_scheme scheme;\nbat_analysis analysis;\nbat_error error;\nbat_curve_scheme_by_name("${name()}", &scheme, &error);\nif (bat_mask_analyze(&scheme.mask, NULL, &analysis, &error) == BAT_OK)\n    printf("C%d\\n", analysis.smooth_proven);\nbat_analysis_free(&analysis);`,
      python: `import batten\n\nanalysis = batten.analyze("${name()}")\nprint(analysis)`,
    }),
  };
}
