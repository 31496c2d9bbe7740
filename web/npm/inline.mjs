// The library with its binary inside, for bundlers that copy no files.
import { instantiate } from "./engine.mjs";
import packed from "./packed.mjs";

export { BattenError, CurveSet, Shell, Surface, instantiate } from "./engine.mjs";

/** Load the library: from the binary inside, or from a binary or a compiled module that the caller has. */
export async function load(source) {
  if (source !== undefined) return instantiate(source);
  const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
  return instantiate(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"))).arrayBuffer());
}
