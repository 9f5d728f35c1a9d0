// Addresses of the package's files. Each address is a literal of its own: in that form bundlers find a file and move it.

/** The starter maps by name; all but the first may be missing. */
export const MAPS = {
  "day.jpg": new URL("./maps/day.jpg", import.meta.url),
  "clouds.jpg": new URL("./maps/clouds.jpg", import.meta.url),
  "elevation.png": new URL("./maps/elevation.png", import.meta.url),
  "night_lights.png": new URL("./maps/night_lights.png", import.meta.url),
  "water.png": new URL("./maps/water.png", import.meta.url),
  "seasons.png": new URL("./maps/seasons.png", import.meta.url),
  "moon.jpg": new URL("./maps/moon.jpg", import.meta.url),
  "milky_way.jpg": new URL("./maps/milky_way.jpg", import.meta.url),
  "places.bin": new URL("./maps/places.bin", import.meta.url),
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

/** Tables of the default air, deflated, and the tiles of synthetic detail. */
export const AIR = new URL("./data/air.bin", import.meta.url);
export const DETAIL_TILES = new URL("./data/detail_tiles.jpg", import.meta.url);

/** Coast lines and borders. */
export const LINES = new URL("./data/lines.bin", import.meta.url);

/** The modules, wasm files and workers of the backends. */
export const BACKENDS = {
  webgpu: {
    module: () => import("./webgpu.js"),
    wasm: new URL("./webgpu_bg.wasm", import.meta.url),
    worker: () => new Worker(new URL("./worker-webgpu.js", import.meta.url), { type: "module" }),
  },
  webgl: {
    module: () => import("./webgl.js"),
    wasm: new URL("./webgl_bg.wasm", import.meta.url),
    worker: () => new Worker(new URL("./worker-webgl.js", import.meta.url), { type: "module" }),
  },
};

/** The wasm file and the worker that read packs. */
export const PACKS = {
  wasm: new URL("./packs_bg.wasm", import.meta.url),
  worker: () => new Worker(new URL("./worker-pack.js", import.meta.url), { type: "module" }),
};

/** The wasm file that reads scenes. */
export const SCENES = { wasm: new URL("./scenes_bg.wasm", import.meta.url) };

/** Starts a worker, which is the file of this name. */
export function newWorker(start, file) {
  try {
    return start();
  } catch {
    // Browsers start no worker from another origin, such as that of a file network, but a worker may import from there. The address is derived
    // from that of another file, because a bundler would copy a worker that is named a second time as it is.
    const script = `import ${JSON.stringify(new URL(`../${file}`, AIR).href)};`;
    const address = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
    const worker = new Worker(address, { type: "module" });
    URL.revokeObjectURL(address);
    return worker;
  }
}
