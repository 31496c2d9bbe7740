// What workers share: they answer messages { id, job, args } by { id, result } or { id, error }, and before it by
// { id, progress } from time to time. The first message is { binary }: a packed WebAssembly file.

const unpack = (packed) => new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"))).arrayBuffer();

/** The memory of all arrays of a result: it moves to the page instead of being copied. */
function buffersOf(value, found = new Set()) {
  if (ArrayBuffer.isView(value)) found.add(value.buffer);
  else if (typeof value === "object" && value !== null) for (const part of Object.values(value)) buffersOf(part, found);
  return found;
}

/** Answer messages by `jobs`, functions of what `start` makes of the WebAssembly file, of arguments and of a report of progress. */
export function serve(start, jobs) {
  let engine = null;
  self.onmessage = async ({ data }) => {
    if (data.binary) {
      engine = unpack(data.binary).then(start);
      return;
    }
    const { id, job, args } = data;
    let last = 0;
    const progress = (fraction) => {
      const now = performance.now();
      if (now - last > 50) {
        last = now;
        self.postMessage({ id, progress: fraction });
      }
      return true;
    };
    try {
      const result = await jobs[job](await engine, args, progress);
      self.postMessage({ id, result }, [...buffersOf(result)]);
    } catch (error) {
      const { status = "failure", index = null, line = null, message, curve = null, text, remedy, effect } = error;
      self.postMessage({ id, error: { status, index, line, message, curve, text, remedy, effect } });
    }
  };
}
