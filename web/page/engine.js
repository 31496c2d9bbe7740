// The page's side of the worker.

export class Cancelled extends Error {}

/**
 * An engine in a worker. `busy(title, fraction)` is called when a job has run for `delay` milliseconds and ten times a second
 * from then on, and with null when nothing is under way.
 */
export class Engine {
  delay = 300;
  #source;
  #binary;
  #worker = null;
  #waiting = new Map();
  #next = 0;
  #latest = new Map();

  constructor(source, binary, busy) {
    this.#source = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
    this.#binary = binary;
    this.busy = busy;
    this.#start();
  }

  #start() {
    this.#worker = new Worker(this.#source);
    this.#worker.onmessage = ({ data }) => {
      const waiting = this.#waiting.get(data.id);
      if (!waiting) return;
      if (data.progress !== undefined) {
        waiting.fraction = data.progress;
        return;
      }
      this.#waiting.delete(data.id);
      clearTimeout(waiting.timer);
      if (this.#waiting.size === 0) this.busy(null);
      if (data.error) waiting.reject(Object.assign(new Error(data.error.message), data.error));
      else waiting.resolve(data.result);
    };
    this.#worker.onerror = (event) => {
      const message = event.message || "the engine stopped";
      for (const waiting of this.#waiting.values()) waiting.reject(new Error(message));
      this.#waiting.clear();
    };
    this.#worker.postMessage({ binary: this.#binary });
  }

  /** Run a job. */
  call(job, args, title = "Working") {
    const id = this.#next++;
    return new Promise((resolve, reject) => {
      const waiting = { resolve, reject, fraction: 0 };
      const show = () => {
        this.busy(title, waiting.fraction);
        waiting.timer = setTimeout(show, 100);
      };
      waiting.timer = setTimeout(show, this.delay);
      this.#waiting.set(id, waiting);
      this.#worker.postMessage({ id, job, args });
    });
  }

  /** Run a job of which only the newest counts: while one runs, all but the last of the others are dropped. */
  async latest(channel, job, args, title) {
    const slot = this.#latest.get(channel) ?? { running: false, next: null };
    this.#latest.set(channel, slot);
    if (slot.running) {
      slot.next?.drop(new Cancelled("superseded"));
      await new Promise((resolve, reject) => {
        slot.next = { go: resolve, drop: reject };
      });
    }
    slot.running = true;
    try {
      return await this.call(job, args, title);
    } finally {
      slot.running = false;
      const next = slot.next;
      slot.next = null;
      next?.go();
    }
  }

  /** Stop what is under way, with the worker, and start a fresh one. */
  cancel() {
    this.#worker.terminate();
    const all = [...this.#waiting.values()];
    this.#waiting.clear();
    this.#start();
    for (const waiting of all) {
      clearTimeout(waiting.timer);
      waiting.reject(new Cancelled("cancelled"));
    }
    this.busy(null);
  }
}
