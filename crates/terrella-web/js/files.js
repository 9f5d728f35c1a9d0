// Addresses of the package's files. Each address is a literal of its own: in that form bundlers find a file and move it.

/** The starter maps by name; all but the first may be missing. */
export const MAPS = {
  "day.jpg": new URL("./maps/day.jpg", import.meta.url),
  "clouds.jpg": new URL("./maps/clouds.jpg", import.meta.url),
  "elevation.png": new URL("./maps/elevation.png", import.meta.url),
  "night_lights.png": new URL("./maps/night_lights.png", import.meta.url),
  "water.png": new URL("./maps/water.png", import.meta.url),
  "stars.bin": new URL("./maps/stars.bin", import.meta.url),
};

/** Small versions of them for the first picture. */
export const PREVIEW_MAPS = {
  "day.jpg": new URL("./maps/preview/day.jpg", import.meta.url),
  "clouds.jpg": new URL("./maps/preview/clouds.jpg", import.meta.url),
  "elevation.png": new URL("./maps/preview/elevation.png", import.meta.url),
  "night_lights.png": new URL("./maps/preview/night_lights.png", import.meta.url),
  "water.png": new URL("./maps/preview/water.png", import.meta.url),
};

/** Tables of the default air, deflated, and the tile of synthetic detail. */
export const AIR = new URL("./data/air.bin", import.meta.url);
export const DETAIL_TILE = new URL("./data/detail_tile.jpg", import.meta.url);

/** The modules and wasm files of the backends. */
export const BACKENDS = {
  webgpu: {
    module: () => import("./webgpu.js"),
    wasm: new URL("./webgpu_bg.wasm", import.meta.url),
  },
  webgl: {
    module: () => import("./webgl.js"),
    wasm: new URL("./webgl_bg.wasm", import.meta.url),
  },
};

/** A worker that decodes maps. */
export function newWorker() {
  try {
    return new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
  } catch {
    // Browsers start no worker from another origin, such as that of a file network, but a worker may import from there.
    const script = `import ${JSON.stringify(new URL("./worker.js", import.meta.url).href)};`;
    const address = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
    const worker = new Worker(address, { type: "module" });
    URL.revokeObjectURL(address);
    return worker;
  }
}
