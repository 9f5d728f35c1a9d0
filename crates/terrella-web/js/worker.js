// Decodes maps beside the page: receives the wasm module and the bytes of maps, and posts bands of rows.

import { BACKENDS } from "./files.js";

let module;

onmessage = async ({ data }) => {
  try {
    if (data.wasm) {
      module = BACKENDS[data.backend].module().then(async (module) => {
        await module.default({ module_or_path: data.wasm });
        return module;
      });
      return;
    }
    const { decodeMaps } = await module;
    decodeMaps(data.maps, (map, width, height, level, first, texels) => {
      postMessage({ band: [map, width, height, level, first, texels] }, [texels.buffer]);
    });
    postMessage({ end: true });
  } catch (error) {
    postMessage({ error: error?.message ?? String(error) });
  }
};
