// Compressed LAS (LAZ) becomes LAS, in its own thread, by laz-perf.
import create from "laz-perf/lib/worker/laz-perf.js";
import { serve } from "./serve.js";

/** Places in the header: where points begin, their format. */
const AT_BEGIN = 96;
const AT_FORMAT = 104;
/** Bits of the format that compression sets. */
const COMPRESSED = 0xc0;
/** Points that are copied at once. */
const BLOCK = 4096;

/** LAS of LAZ. A failure of laz-perf has no text, and leaves memory behind: each file has a module of its own. */
async function expand(binary, { bytes }, progress) {
  const laz = await create({ wasmBinary: binary, printErr: () => {} });
  let done = 0;
  let count = null;
  try {
    const given = laz._malloc(bytes.length);
    laz.HEAPU8.set(bytes, given);
    const file = new laz.LASZip();
    file.open(given, bytes.length);
    const size = file.getPointLength();
    count = file.getCount();
    const begin = new DataView(bytes.buffer, bytes.byteOffset).getUint32(AT_BEGIN, true);
    const las = new Uint8Array(begin + count * size);
    las.set(bytes.subarray(0, begin));
    las[AT_FORMAT] &= ~COMPRESSED;
    const block = laz._malloc(BLOCK * size);
    while (done < count) {
      const first = done;
      for (const end = Math.min(first + BLOCK, count); done < end; done++) file.getPoint(block + (done - first) * size);
      las.set(laz.HEAPU8.subarray(block, block + (done - first) * size), begin + first * size);
      progress(done / count);
    }
    return las;
  } catch (error) {
    if (error instanceof RangeError) throw new Error("the compressed points are more than this page has memory for");
    throw new Error(count === null ? "the file is damaged: its compressed points cannot be read" : `the file is damaged: point ${done} of ${count} cannot be decompressed`);
  }
}

serve((binary) => binary, { expand });
