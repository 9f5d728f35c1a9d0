// The page's side of the worker that decodes maps.

import { BACKENDS, newWorker } from "./files.js";

export class Decoder {
  #worker;
  #backend;
  /** Ends the decoding that is going on. */
  #reject = () => {};

  /** Starts a worker with a compiled wasm module. */
  constructor(backend, wasm) {
    this.#backend = backend;
    this.#worker = newWorker(BACKENDS[backend].worker, `worker-${backend}.js`);
    this.#worker.postMessage({ wasm });
  }

  /** Decodes maps, bytes by name, with the snow and ice of a fraction of a year, and passes each band of rows to `take`. The bytes are gone afterwards. */
  decode(maps, season, take) {
    return new Promise((resolve, reject) => {
      this.#reject = reject;
      this.#worker.onerror = (event) => reject(new Error(`The worker that decodes maps did not start: ${event.message ?? `worker-${this.#backend}.js could not be loaded`}.`));
      this.#worker.onmessage = ({ data }) => {
        try {
          if (data.band) take(...data.band);
          else if (data.error) reject(new Error(data.error));
          else resolve();
        } catch (error) {
          reject(error);
        }
      };
      const buffers = new Set(Object.values(maps).map((bytes) => bytes.buffer));
      this.#worker.postMessage({ maps, season }, [...buffers]);
    });
  }

  /** Ends the worker. A decoding that is going on fails with an `AbortError`. */
  end() {
    this.#worker.terminate();
    this.#reject(new DOMException("The maps are no longer wanted.", "AbortError"));
  }
}
