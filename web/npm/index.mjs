import { instantiate } from "./engine.mjs";

export { BattenError, CurveSet, instantiate } from "./engine.mjs";

/**
 * Load the library: from the file beside this one, or from a binary or a compiled module that the caller has.
 */
export async function load(source) {
  if (source !== undefined) return instantiate(source);
  const address = new URL("./batten.wasm", import.meta.url);
  if (typeof process === "object" && process.versions?.node) {
    const { readFile } = await import("node:fs/promises");
    return instantiate(await readFile(address));
  }
  return instantiate(await (await fetch(address)).arrayBuffer());
}
