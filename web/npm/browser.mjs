// For browsers and workers. Vite and webpack copy the file of the URL.
import { BattenError, instantiate } from "./engine.mjs";

export { BattenError, CurveSet, Shell, Surface, instantiate } from "./engine.mjs";

/** Load the library: from the file beside this one, or from a binary or a compiled module that the caller has. */
export async function load(source) {
  if (source !== undefined) return instantiate(source);
  const address = new URL("./batten.wasm", import.meta.url);
  const answer = await fetch(address);
  if (!answer.ok) throw new BattenError({ name: "file access", text: `${address} is missing: copy batten.wasm there, or import "batten/inline", which holds it` });
  return instantiate(await answer.arrayBuffer());
}
