// The page's side of the worker that decodes maps.

import { BACKENDS, newWorker } from "./files.js";

/** Bands that are passed on without waiting. */
const BANDS_AT_ONCE = 4;

export class Decoder {
  #worker;
  #backend;
  #hasEnded = false;
  /** Ends the decoding that is going on. */
  #reject = () => {};

  /** Starts a worker with a compiled wasm module. */
  constructor(backend, wasm) {
    this.#backend = backend;
    this.#worker = newWorker(BACKENDS[backend].worker, `worker-${backend}.js`);
    this.#worker.postMessage({ wasm });
  }

  /** Decodes maps, bytes by name, with the snow and ice of a fraction of a year, and passes bands of rows to `take`, a few each time `ready`
   * has settled. The bytes are gone afterwards. */
  decode(maps, season, take, ready = () => {}) {
    return new Promise((resolve, reject) => {
      let bands = 0;
      const handle = async (data) => {
        if (data.error) throw new Error(data.error);
        if (!data.band) return resolve();
        if (bands++ % BANDS_AT_ONCE === 0) await ready();
        if (!this.#hasEnded) take(...data.band);
      };
      let handled = Promise.resolve();
      this.#reject = reject;
      this.#worker.onerror = (event) => reject(new Error(`The worker that decodes maps did not start: ${event.message ?? `worker-${this.#backend}.js could not be loaded`}.`));
      this.#worker.onmessage = ({ data }) => {
        handled = handled.then(() => handle(data));
        handled.catch(reject);
      };
      const buffers = new Set(Object.values(maps).map((bytes) => bytes.buffer));
      this.#worker.postMessage({ maps, season }, [...buffers]);
    });
  }

  /** Ends the worker. A decoding that is going on fails with an `AbortError`. */
  end() {
    this.#hasEnded = true;
    this.#worker.terminate();
    this.#reject(new DOMException("The maps are no longer wanted.", "AbortError"));
  }
}
