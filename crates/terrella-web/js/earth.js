// The Earth on a canvas: picks a backend, loads maps, draws when something has changed.

import { Controls } from "./controls.js";

/** Files of the maps; all but the first may be missing. */
const MAP_FILES = ["day.jpg", "clouds.jpg", "elevation.png", "night_lights.png", "water.png", "stars.bin"];

/** The wasm files of the backends, relative to this module. Literals, so that bundlers find them. */
const BACKENDS = {
  webgpu: {
    module: () => import("./webgpu.js"),
    wasm: () => new URL("./webgpu_bg.wasm", import.meta.url),
  },
  webgl: {
    module: () => import("./webgl.js"),
    wasm: () => new URL("./webgl_bg.wasm", import.meta.url),
  },
};

/** Interval between checks for device faults while nothing is drawn, milliseconds. */
const FAULT_INTERVAL_MS = 1000;
/** Names of a view's numbers, in order. */
const VIEW_KEYS = ["lat", "lon", "altitude", "heading", "pitch", "fov"];

/** The backend of this browser. A canvas never gives a second type of context, so no canvas is touched here. */
async function availableBackend() {
  // `navigator.gpu` may exist without an adapter.
  const adapter = await navigator.gpu?.requestAdapter().catch(() => null);
  if (adapter) return "webgpu";
  const probe = document.createElement("canvas").getContext("webgl2");
  probe?.getExtension("WEBGL_lose_context")?.loseContext();
  if (probe) return "webgl";
  throw new Error(
    "This browser gives the page neither WebGPU nor WebGL2. Turn hardware acceleration on in its settings, or take another browser.",
  );
}

/** The bytes of a map, as given or fetched; `undefined` if an optional map is missing. */
async function mapBytes(name, source, signal, count) {
  if (source instanceof ArrayBuffer) return new Uint8Array(source);
  if (ArrayBuffer.isView(source)) return new Uint8Array(source.buffer, source.byteOffset, source.byteLength);
  const response = await fetch(source, { signal }).catch((cause) => {
    if (signal?.aborted) throw cause;
    throw new Error(`The map ${name} could not be loaded from ${source}: ${cause.message}. Check the address and the connection.`);
  });
  if (response.status === 404 && name !== MAP_FILES[0]) return undefined;
  if (!response.ok) {
    throw new Error(`The map ${name} could not be loaded: ${source} answered ${response.status}. Check the address.`);
  }
  const chunks = [];
  let length = 0;
  const reader = response.body.getReader();
  count(0, Number(response.headers.get("content-length")) || 0);
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    chunks.push(part.value);
    length += part.value.length;
    count(part.value.length, 0);
  }
  const bytes = new Uint8Array(length);
  let at = 0;
  for (const chunk of chunks) {
    bytes.set(chunk, at);
    at += chunk.length;
  }
  return bytes;
}

/** All maps by name. `maps` is the URL of a folder, or an object of URLs or bytes. */
async function loadMaps(maps, signal, progress) {
  const isFolder = typeof maps === "string" || maps instanceof URL;
  const folder = isFolder ? new URL(maps, document.baseURI) : null;
  if (folder && !folder.pathname.endsWith("/")) folder.pathname += "/";
  const wanted = folder ? MAP_FILES.map((name) => [name, new URL(name, folder)]) : Object.entries(maps);
  let [came, expected] = [0, 0];
  const count = (more, announced) => {
    came += more;
    expected += announced;
    progress(expected ? Math.min(came / expected, 1) : 0);
  };
  const loads = wanted.map(async ([name, source]) => [name, await mapBytes(name, source, signal, count)]);
  const files = await Promise.all(loads);
  return Object.fromEntries(files.filter(([, bytes]) => bytes));
}

/** Lets the page draw before a long step. */
const breathe = () => new Promise((resolve) => setTimeout(resolve));

const milliseconds = (epoch) => {
  const ms = epoch instanceof Date ? epoch.getTime() : typeof epoch === "string" ? (epoch === "now" ? Date.now() : Date.parse(epoch)) : Number(epoch);
  if (!Number.isFinite(ms)) throw new TypeError(`The epoch ${epoch} is no date; write it as 2026-01-31T12:00:00Z, or now.`);
  return ms;
};

export class TerrellaEarth extends EventTarget {
  #globe;
  #canvas;
  #controls;
  #lostPrefix;
  #faultTimer;
  #request = 0;
  #rate = 0;
  #exposure = "auto";
  /** The displayed instant at a time of the page's clock. */
  #shown = { ms: Date.now(), at: performance.now() };
  #isVisible = true;
  #isLost = false;
  #names = [];

  /** Creates the Earth on a canvas without a context; see terrella.d.ts. */
  static async create(canvas, options = {}) {
    const { maps = new URL("./maps/", import.meta.url), backend = "auto", samples = 4, anisotropy = 8, signal, controls = true } = options;
    const progress = options.progress ?? (() => {});
    progress(0, "loading");
    const kind = backend === "auto" ? await availableBackend() : backend;
    if (!BACKENDS[kind]) throw new TypeError(`There is no backend ${kind}; write auto, webgpu or webgl.`);
    const wasm = options.wasm?.[kind] ?? BACKENDS[kind].wasm();
    const [module, files] = await Promise.all([
      BACKENDS[kind].module().then(async (module) => {
        await module.default({ module_or_path: wasm });
        return module;
      }),
      loadMaps(maps, signal, (part) => progress(0.7 * part, "loading")),
    ]);
    signal?.throwIfAborted();
    const parts = { maps: 0.75, air: 0.85, sky: 0.95 };
    const step = (what) => {
      progress(parts[what] ?? 0.7, what);
      signal?.throwIfAborted();
      return breathe();
    };
    const earth = new TerrellaEarth();
    earth.#canvas = canvas;
    earth.backend = kind;
    earth.#globe = await module.Globe.create(canvas, files, samples, anisotropy, step);
    if (signal?.aborted) {
      earth.free();
      signal.throwIfAborted();
    }
    earth.#lostPrefix = module.Globe.lostPrefix();
    earth.#faultTimer = setInterval(() => earth.#tellFaults(), FAULT_INTERVAL_MS);
    canvas.addEventListener("webglcontextlost", earth.#contextLost);
    document.addEventListener("visibilitychange", earth.#visibilityChanged);
    if (controls) earth.#controls = new Controls(canvas, earth);
    progress(1, "ready");
    earth.invalidate();
    return earth;
  }

  #contextLost = (event) => {
    event.preventDefault();
    this.#lose("the browser took the WebGL context away");
  };

  #visibilityChanged = () => this.invalidate();

  /** The wasm object; throws after it is freed. */
  get #alive() {
    if (!this.#globe) throw new Error("This Earth was freed; make another.");
    return this.#globe;
  }

  /** Name of the adapter. */
  get adapter() {
    return this.#alive.adapter();
  }

  get view() {
    const numbers = this.#alive.view();
    return Object.fromEntries(VIEW_KEYS.map((key, i) => [key, numbers[i]]));
  }

  set view(change) {
    const view = { ...this.view, ...change };
    if (!this.#alive.setView(...VIEW_KEYS.map((key) => Number(view[key])))) {
      throw new TypeError(`The view ${JSON.stringify(change)} has something that is no finite number.`);
    }
    this.#moved();
  }

  get epoch() {
    return new Date(this.#epochAt(performance.now()));
  }

  set epoch(epoch) {
    this.#shown = { ms: milliseconds(epoch), at: performance.now() };
    this.invalidate();
  }

  get rate() {
    return this.#rate;
  }

  set rate(rate) {
    if (!Number.isFinite(Number(rate))) throw new TypeError(`The rate ${rate} is no number; write simulated seconds per second.`);
    this.epoch = this.epoch;
    this.#rate = Number(rate);
    this.invalidate();
  }

  get exposure() {
    return this.#exposure;
  }

  set exposure(exposure) {
    this.#alive.setExposure(exposure === "auto" ? NaN : Number(exposure));
    this.#exposure = exposure === "auto" ? "auto" : Number(exposure);
    this.invalidate();
  }

  /** Names of the drawn satellites. */
  get satellites() {
    return [...this.#names];
  }

  /** Draws the satellites of two-line elements or an OMM; only the one of `name`, if given. An empty text removes them. */
  setSatellites(text, name) {
    this.#names = this.#alive.setSatellites(text, name ?? undefined);
    this.invalidate();
    return this.satellites;
  }

  /** The epoch of a satellite's elements. */
  elementsEpoch(index = 0) {
    const ms = this.#alive.epochOf(index);
    return ms === undefined ? undefined : new Date(ms);
  }

  /** Label positions in the last frame, in canvas pixels. */
  get labels() {
    const numbers = this.#alive.labels();
    const labels = [];
    for (let i = 0; i < numbers.length; i += 3) {
      labels.push({ index: numbers[i], name: this.#names[numbers[i]], x: numbers[i + 1], y: numbers[i + 2] });
    }
    return labels;
  }

  /** Latitude and longitude of the surface under a canvas pixel, degrees; null off the globe. */
  pick(x, y) {
    const place = this.#alive.pick(x, y);
    return place ? { lat: place[0], lon: place[1] } : null;
  }

  grab(x, y) {
    this.#alive.grab(x, y);
  }

  drag(fromX, fromY, x, y) {
    this.#alive.drag(fromX, fromY, x, y);
    this.#moved();
  }

  spin(x, y) {
    this.#alive.spin(x, y);
    this.#moved();
  }

  approach(x, y, factor) {
    this.#alive.approach(x, y, factor);
    this.#moved();
  }

  tilt(x, y) {
    this.#alive.tilt(x, y);
    this.#moved();
  }

  northUp() {
    this.#alive.northUp();
    this.#moved();
  }

  /** Resizes the canvas, in pixels. */
  resize(width, height) {
    this.#canvas.width = Math.max(1, Math.round(width));
    this.#canvas.height = Math.max(1, Math.round(height));
    this.#alive.resize(this.#canvas.width, this.#canvas.height);
    this.draw();
  }

  /** Whether the canvas is visible; otherwise nothing is drawn. */
  set isVisible(isVisible) {
    this.#isVisible = isVisible;
    this.invalidate();
  }

  /** Draws before the next paint, if the canvas is visible. */
  invalidate() {
    const isSeen = this.#isVisible && document.visibilityState === "visible";
    if (this.#request || !this.#globe || this.#isLost || !isSeen) return;
    this.#request = requestAnimationFrame((now) => {
      this.#request = 0;
      const isWhole = this.draw(this.#epochAt(now));
      if (this.#rate !== 0 || !isWhole) this.invalidate();
    });
  }

  /** Draws now. Returns whether the frame is complete: satellite curves grow over several frames. */
  draw(ms = this.#epochAt(performance.now())) {
    if (!this.#globe || this.#isLost) return true;
    let isWhole = true;
    try {
      isWhole = this.#globe.draw(ms);
    } catch (error) {
      this.#fail(error);
    }
    this.dispatchEvent(new CustomEvent("frame", { detail: { epoch: new Date(ms) } }));
    return isWhole;
  }

  /** The current image as a file. */
  toBlob(type = "image/png") {
    // A canvas can only be read in the task that drew it.
    this.draw();
    return new Promise((resolve, reject) => {
      this.#canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error(`The browser writes no ${type}.`))), type);
    });
  }

  /** Frees memory and device. */
  free() {
    if (!this.#globe) return;
    this.#controls?.detach();
    clearInterval(this.#faultTimer);
    cancelAnimationFrame(this.#request);
    this.#canvas.removeEventListener("webglcontextlost", this.#contextLost);
    document.removeEventListener("visibilitychange", this.#visibilityChanged);
    const globe = this.#globe;
    this.#globe = null;
    globe.destroy();
    globe.free();
  }

  #epochAt(now) {
    return this.#shown.ms + (now - this.#shown.at) * this.#rate;
  }

  #moved() {
    this.dispatchEvent(new CustomEvent("viewchange"));
    this.invalidate();
  }

  #fail(error) {
    this.dispatchEvent(new CustomEvent("error", { detail: error }));
  }

  #lose(why) {
    if (this.#isLost) return;
    this.#isLost = true;
    this.dispatchEvent(new CustomEvent("devicelost", { detail: why }));
  }

  #tellFaults() {
    for (const fault of this.#globe?.takeFaults() ?? []) {
      if (fault.startsWith(this.#lostPrefix)) this.#lose(fault.slice(this.#lostPrefix.length));
      else this.#fail(new Error(fault));
    }
  }
}
