// Decodes maps beside the page, in a worker.

/** Receives the compiled wasm and the bytes of maps, and posts bands of rows. `start` and `decodeMaps` are those of a backend's module. */
export function decodeMessages(start, decodeMaps) {
  let started;
  onmessage = async ({ data }) => {
    try {
      if (data.wasm) {
        started = start({ module_or_path: data.wasm });
        return;
      }
      await started;
      decodeMaps(data.maps, data.season, (map, width, height, level, first, texels) => {
        postMessage({ band: [map, width, height, level, first, texels] }, [texels.buffer]);
      });
      postMessage({ end: true });
    } catch (error) {
      postMessage({ error: error?.message ?? String(error) });
    }
  };
}
