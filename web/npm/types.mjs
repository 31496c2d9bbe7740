// Write index.d.ts: node types.mjs. The declarations of index.d.ts.in get the options, choices and measures of the tables inside
// batten.wasm, with the comments of the fields in include/batten.
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { instantiate } from "./engine.mjs";

const here = new URL(".", import.meta.url);
const headers = new URL("../../include/batten/", here);

/** The comments of the fields of all structs: { struct: { field: text } }. */
const structs = {};
for (const name of readdirSync(headers).filter((file) => file.endsWith(".h")))
  for (const [, struct, body] of readFileSync(new URL(name, headers), "utf8").matchAll(/typedef struct (\w+)\s*\{(.*?)\n\}/gs)) {
    const fields = (structs[struct] = {});
    let before = [];
    let last = null;
    for (const line of body.split("\n")) {
      const [, code, mark, text] = line.match(/^\s*(.*?)\s*(?:(\/\/\/<?)\s?(.*))?$/);
      const field = code.match(/(\w+)(?:\[\d+\])?;$/)?.[1];
      if (field) {
        fields[field] = [...before, ...(mark ? [text] : [])].join(" ");
        before = [];
        last = field;
      } else if (code !== "") before = [];
      else if (mark === "///<") fields[last] = `${fields[last] ?? ""} ${text}`.trim();
      else if (mark) before.push(text);
    }
  }

const STRUCTS = {
  bat_curve_refine: ["bat_curve_refine_options"],
  bat_curve_map_refine: ["bat_curve_map_refine_options", "bat_curve_refine_options"],
  bat_curve_read_memory: ["bat_curve_read_options"],
  bat_curve_write_memory: ["bat_curve_write_options"],
  bat_curve_compare: ["bat_curve_measure_options"],
  bat_curve_fairness: ["bat_curve_measure_options"],
  bat_mask_analyze: ["bat_mask_analyze_options"],
  bat_motion_curves: ["bat_motion_curves_options", "bat_motion_spline_options", "bat_curve_refine_options"],
  bat_motion_spline_sample: ["bat_motion_spline_options"],
  bat_mesh_refine: ["bat_mesh_refine_options", "bat_mesh_rules"],
  bat_mesh_decimate: ["bat_mesh_decimate_options"],
  bat_mesh_compare: ["bat_mesh_compare_options"],
  bat_mesh_read_memory: ["bat_mesh_read_options"],
  bat_mesh_write_memory: ["bat_mesh_write_options"],
  bat_cloud_read: ["bat_cloud_read_options"],
  bat_surface_reconstruct: ["bat_surface_reconstruct_options", "bat_surface_fit_options"],
  bat_surface_write: ["bat_surface_write_options"],
  bat_shell_reconstruct: ["bat_shell_reconstruct_options"],
};
/** Options that an operation reads by itself. */
const OWN = {
  bat_curve_refine: { scheme: "CurveScheme" },
  bat_curve_map_refine: { scheme: "CurveScheme" },
  bat_motion_curves: { scheme: "MotionScheme" },
  bat_mesh_refine: { limit_normals: "boolean" },
};
const TYPES = { size: "number", int: "number", uint64: "number", number: "number", bool: "boolean", text: "string" };
const NARROWER = { closed: "-1 | 0 | 1", space: "Space" };

const batten = await instantiate(readFileSync(new URL("batten.wasm", here)));
const signatures = batten.signatures();
const families = batten.bat_choices();
const camel = (name) => name.replace(/(?:^|_)(\w)/g, (_, letter) => letter.toUpperCase());
const comment = (text, indent) => (text ? `${indent}/** ${text.replaceAll("*/", "* /").replace(/^./, (first) => first.toUpperCase())} */\n` : "");

function options(operation) {
  if (!STRUCTS[operation]) throw new Error(`types.mjs knows no struct of ${operation}`);
  const about = Object.assign({}, ...STRUCTS[operation].toReversed().map((name) => structs[name] ?? {}));
  return signatures.operations[operation]
    .filter(([name, type]) => type !== "own" || OWN[operation]?.[name])
    .map(([name, type, family]) => {
      const words = type === "own" ? OWN[operation][name] : type === "choice" ? camel(family) : (type === "int" || type === "text") && NARROWER[name] ? NARROWER[name] : TYPES[type];
      return `${comment(about[name], "  ")}  ${name}?: ${words};\n`;
    })
    .join("");
}

const MEASURES = { number: "number", count: "number | null", point: "[number, number, number]", flag: "boolean" };
const measures = (list) => signatures[list].map(([name, form, title]) => `${comment(title.trim(), "  ")}  ${name}: ${MEASURES[form]};\n`).join("");

/** A union of names; a name with settings may be followed by them. */
function choices(family) {
  const names = families[family].flatMap(({ name, settings }) => [JSON.stringify(name), ...(settings ? [`\`${name}:\${string}\``] : [])]);
  if (signatures.automatic.includes(family) && !names.includes('"auto"')) names.unshift('"auto"');
  return `export type ${camel(family)} = ${names.join(" | ")};\n`;
}

const all = Object.keys(families);
const text = readFileSync(new URL("index.d.ts.in", here), "utf8")
  .replace("/* choices */\n", () => `${all.map(choices).join("")}/** The tables of the library. */\nexport type Family = ${all.map((name) => JSON.stringify(name)).join(" | ")};\n`)
  .replace(/ {2}\/\* options of (\w+) \*\/\n/g, (_, operation) => options(operation))
  .replace(/ {2}\/\* measures of (\w+) \*\/\n/g, (_, list) => measures(list));
writeFileSync(new URL("index.d.ts", here), text);
