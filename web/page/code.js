// How the user's own file is read elsewhere: names of files in commands, and Python for files of lines and maps.

/** More points than this are read from a file instead of being written out. */
export const MAX_LITERAL = 60;

export const shellName = (name) => (/^[\w./-]+$/.test(name) && !name.startsWith("-") ? name : `'${name.replaceAll("'", "'\\''")}'`);
export const quoted = (name) => JSON.stringify(name);
const ending = (name) => name.toLowerCase().match(/\.[a-z0-9]+$/)?.[0] ?? "";

const MEANINGS = [/^(x|e|east(ing)?|lon|lng|long|longitude)\b/i, /^(y|n|north(ing)?|lat|latitude)\b/i, /^(z|h|height|elevation|altitude)\b/i];

/**
 * The layout of a table of `dimension` coordinates: the lines before its numbers, the delimiter (none for blanks) and the
 * columns; null for what np.loadtxt() cannot read.
 */
export function layoutOf(bytes, dimension) {
  const lines = new TextDecoder().decode(bytes.subarray(0, 100000)).replace(/^\ufeff/, "").split(/\r?\n/);
  const skip = lines.findIndex((line) => /^\s*[-+]?\.?\d/.test(line));
  if (skip < 0) return null;
  const delimiter = ["\t", ";", ","].find((mark) => lines[skip].includes(mark));
  const cells = (line) => (delimiter ? line.split(delimiter) : line.trim().split(/\s+/)).map((cell) => cell.trim().replace(/^"(.*)"$/, "$1"));
  const numbers = cells(lines[skip]);
  if (numbers.length < dimension || numbers.some((cell) => cell === "" || !Number.isFinite(Number(cell)))) return null;
  const names = skip > 0 && !/^\s*(#|$)/.test(lines[skip - 1]) ? cells(lines[skip - 1]) : null;
  const first = Array.from({ length: dimension }, (_, i) => i);
  const columns = names ? MEANINGS.slice(0, dimension).map((meaning) => names.findIndex((name) => meaning.test(name))) : first;
  if (columns.includes(-1)) return numbers.length === dimension ? { skip, delimiter, columns: first } : null;
  return { skip, delimiter, columns };
}
export const loadtxt = (name, { skip, delimiter, columns }) =>
  `np.loadtxt(${quoted(name)}${delimiter ? `, delimiter=${quoted(delimiter)}` : ""}${skip ? `, skiprows=${skip}` : ""}, usecols=(${columns.join(", ")}))`;

/** Shapes of a map: [packages, expression]. The program turns what Python has no reader for into WKT. */
export function shapesIn(name) {
  const kind = ending(name);
  const wkt = (file) => `geopandas.GeoSeries(shapely.from_wkt(open(${quoted(file)}).read().splitlines()))`;
  if ([".wkt", ".ewkt"].includes(kind)) return [["geopandas", "shapely"], wkt(name)];
  if (kind === ".gpx") return [["geopandas"], `geopandas.read_file(${quoted(name)}, layer="tracks")`];
  if (/^\.(geo|topo)?jsonl?$/.test(kind)) return [["geopandas"], `geopandas.read_file(${quoted(name)})`];
  return [["geopandas", "shapely", "subprocess"], wkt("given.wkt"), `subprocess.run(["batten", "curve", ${quoted(name)}, "--levels", "0", "-o", "given.wkt", "--quiet"], check=True)\n`];
}

/** The longest line or ring of a file, [packages, statements]; `closed` tells which of both. */
export function longestIn(name, closed) {
  const [packages, read, before = ""] = shapesIn(name);
  return [
    [...new Set([...packages, "shapely"])],
    `${before}shapes = shapely.get_parts(${read}.geometry)\nlines = shapely.get_parts(${closed ? "shapely.get_rings(shapes)" : "shapes"})\npoints = shapely.get_coordinates(max(lines, key=shapely.get_num_coordinates))`,
  ];
}

/** Import statements in their order. */
export const imports = (...names) => ["batten", ...new Set(names.flat())].sort().map((name) => `import ${name === "np" ? "numpy as np" : name}`).join("\n");
