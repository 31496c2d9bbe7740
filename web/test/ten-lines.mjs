// The package in ten lines: the body of a guitar, smooth, as CSV.
import { readFileSync, writeFileSync } from "node:fs";
import { load } from "batten";

const batten = await load();
const [input, output] = process.argv.slice(2);
const outline = batten.bat_curve_read_memory(readFileSync(input));
const fair = batten.bat_curve_refine(outline, { scheme: "learned", levels: 4 });
writeFileSync(output, batten.bat_curve_write_memory(fair));
console.log(`${batten.bat_version()}: ${fair.curves[0].points.length / 2} points, closed: ${fair.curves[0].closed}`);
