// The engine in its own thread. A message is { id, job, arguments }; an answer is { id, result } or { id, error }, and
// before it { id, progress } from time to time.
import { instantiate } from "../npm/engine.mjs";
import * as jobs from "./jobs.js";

let engine = null;

self.onmessage = async ({ data }) => {
  if (data.binary) {
    engine = instantiate(data.binary);
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
    const result = jobs[job](await engine, args, progress);
    self.postMessage({ id, result });
  } catch (error) {
    const { status = "failure", index = null, line = null, message, curve = null, text, remedy, effect } = error;
    self.postMessage({ id, error: { status, index, line, message, curve, text, remedy, effect } });
  }
};
