// For Node.js.
import { readFile } from "node:fs/promises";
import { BattenError, instantiate } from "./engine.mjs";

export { BattenError, CurveSet, Shell, Surface, instantiate } from "./engine.mjs";

/** Load the library: from the file beside this one, or from a binary or a compiled module that the caller has. */
export async function load(source) {
  if (source !== undefined) return instantiate(source);
  const binary = await readFile(new URL("./batten.wasm", import.meta.url)).catch((error) => {
    const text = `batten.wasm is not beside ${import.meta.url}: copy it there, or import "batten/inline", which holds it`;
    throw Object.assign(new BattenError({ name: "file access", text }), { cause: error });
  });
  return instantiate(binary);
}
