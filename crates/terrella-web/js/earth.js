// The Earth on a canvas: picks a backend, loads maps, draws when something has changed.

import { Controls } from "./controls.js";
import { Decoder } from "./decoder.js";
import { BACKENDS, MAPS, PREVIEW_MAPS } from "./files.js";
import { loadBackend, loadMaps, mapSources } from "./load.js";

/** Interval between checks for device faults while nothing is drawn, milliseconds. */
const FAULT_INTERVAL_MS = 1000;
/** The catalogue of stars among the maps. */
const STARS = "stars.bin";
/** Progress when the first maps are loaded, when they are decoded, and when the first picture can be drawn. */
const PART_LOADED = 0.3;
const PART_DECODED = 0.4;
export const FIRST_PICTURE = 0.5;
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

const milliseconds = (epoch) => {
  const ms = epoch instanceof Date ? epoch.getTime() : typeof epoch === "string" ? (epoch === "now" ? Date.now() : Date.parse(epoch)) : Number(epoch);
  if (!Number.isFinite(ms)) throw new TypeError(`The epoch ${epoch} is no date; write it as 2026-01-31T12:00:00Z, or now.`);
  return ms;
};

/** Parts that can be hidden, in the order of the wasm function. */
const LAYERS = ["clouds", "lights", "relief", "water", "air", "sky"];
const LOOKS = ["standard", "full"];
/** With `resolution` "auto": the longest frame, the time without frames after which the picture is sharpened, milliseconds; and the steps. */
const SLOW_FRAME_MS = 50;
const STILL_MS = 250;
const FINER = 1.25;
const COARSEST = 0.4;
/** Frames whose median time is judged. */
const JUDGED_FRAMES = 8;

export class TerrellaEarth extends EventTarget {
  #globe;
  #canvas;
  #controls;
  #decoder;
  #lostPrefix;
  #faultTimer;
  #request = 0;
  /** Whether the page itself drew since the last due frame. */
  #isDrawnByPage = false;
  #rate = 0;
  #hidden = [];
  #look = "standard";
  #resolution = "auto";
  /** Pixels drawn for each of the canvas, along either axis. */
  #scale = 1;
  #frameTimes = [];
  #lastFrame = -Infinity;
  #sharpening = 0;
  #exposure = "auto";
  /** The displayed instant at a time of the page's clock. */
  #shown = { ms: Date.now(), at: performance.now() };
  #isVisible = true;
  #isLost = false;
  #names = [];
  /** Settles when the whole maps are drawn. */
  complete = Promise.resolve();

  /** Creates the Earth on a canvas without a context; see terrella.d.ts. */
  static async create(canvas, options = {}) {
    const { maps = MAPS, backend = "auto", samples = 4, anisotropy = 8, signal, controls = true } = options;
    const preview = options.preview ?? (options.maps ? undefined : PREVIEW_MAPS);
    const progress = options.progress ?? (() => {});
    progress(0, "loading");
    const kind = backend === "auto" ? await availableBackend() : backend;
    if (!BACKENDS[kind]) throw new TypeError(`There is no backend ${kind}; write auto, webgpu or webgl.`);
    const { [STARS]: stars, ...whole } = mapSources(maps, Object.keys(MAPS));
    const first = preview ? mapSources(preview, Object.keys(PREVIEW_MAPS)) : whole;
    const loading = loadMaps(stars ? { ...first, [STARS]: stars } : first, signal, (part) => progress(PART_LOADED * part, "loading"));
    // It is awaited below, and fails there.
    loading.catch(() => {});
    const { module, compiled } = await loadBackend(kind, options.wasm?.[kind]);
    const decoder = new Decoder(kind, compiled);
    signal?.addEventListener("abort", () => decoder.end(), { once: true });
    const earth = new TerrellaEarth();
    try {
      const opening = module.Opening.open(canvas, samples, anisotropy);
      opening.catch(() => {});
      const { [STARS]: starBytes, ...files } = await loading;
      const opened = await opening;
      progress(PART_LOADED, "maps");
      await decoder.decode(files, (...band) => opened.band(...band));
      signal?.throwIfAborted();
      progress(PART_DECODED, "air");
      earth.#globe = await opened.finish(starBytes);
      signal?.throwIfAborted();
    } catch (error) {
      decoder.end();
      earth.free();
      throw error;
    }
    earth.#canvas = canvas;
    earth.#decoder = decoder;
    earth.backend = kind;
    earth.#lostPrefix = module.Globe.lostPrefix();
    earth.#faultTimer = setInterval(() => earth.#tellFaults(), FAULT_INTERVAL_MS);
    canvas.addEventListener("webglcontextlost", earth.#contextLost);
    document.addEventListener("visibilitychange", earth.#visibilityChanged);
    if (controls) earth.#controls = new Controls(canvas, earth);
    progress(FIRST_PICTURE, "ready");
    earth.complete = preview ? earth.#refine(whole, signal, progress) : Promise.resolve(progress(1, "complete"));
    // An event reports its failure too.
    earth.complete.catch(() => {});
    earth.invalidate();
    return earth;
  }

  /** Replaces the small maps by the whole ones. */
  async #refine(sources, signal, progress) {
    try {
      const part = (part) => progress(FIRST_PICTURE + (1 - FIRST_PICTURE) * part, "refining");
      const files = await loadMaps(sources, signal, (loaded) => part(PART_LOADED * loaded));
      await this.#decoder?.decode(files, (...band) => this.#globe?.band(...band));
      if (!this.#globe) return;
      this.#globe.setMaps();
      progress(1, "complete");
      this.dispatchEvent(new CustomEvent("complete"));
      this.invalidate();
    } catch (error) {
      // A freed Earth wants no maps.
      if (!this.#globe || signal?.aborted) return;
      this.#fail(error);
      throw error;
    } finally {
      this.#decoder?.end();
      this.#decoder = null;
    }
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

  /**
   * Takes over the camera of another program: place and axes in ITRF, metres, and the vertical field of view, degrees. Roll is kept. The next change of
   * the view ends it.
   */
  setCamera({ position, direction, up, fov }) {
    if (!this.#alive.setCamera(Float64Array.from(position), Float64Array.from(direction), Float64Array.from(up), Number(fov))) {
      throw new TypeError("The camera needs position, direction and up as three finite numbers each, and a fov; direction and up must not be parallel.");
    }
    this.invalidate();
  }

  /** Hidden parts, an array or text of the words clouds, lights, relief, water, air, sky. */
  get hide() {
    return [...this.#hidden];
  }

  set hide(parts) {
    const hidden = (Array.isArray(parts) ? parts : String(parts).split(/[\s,]+/)).filter((part) => part);
    const unknown = hidden.find((part) => !LAYERS.includes(part));
    if (unknown) throw new TypeError(`There is no part ${unknown} to hide; write some of ${LAYERS.join(", ")}.`);
    this.#alive.setLayers(...LAYERS.map((layer) => !hidden.includes(layer)));
    this.#hidden = hidden;
    this.invalidate();
  }

  /** "standard", or "full" with cloud shadows, moonlight and airglow. */
  get look() {
    return this.#look;
  }

  set look(look) {
    if (!LOOKS.includes(look)) throw new TypeError(`There is no look ${look}; write standard or full.`);
    this.#alive.setFull(look === "full");
    this.#look = look;
    this.invalidate();
  }

  /** Pixels drawn for each of the canvas, along either axis: 0.25 to 1, or "auto", which draws fewer while frames are slow. */
  get resolution() {
    return this.#resolution;
  }

  set resolution(resolution) {
    const number = resolution === "auto" ? 1 : Number(resolution);
    if (!(number >= 0.25 && number <= 1)) throw new TypeError(`The resolution ${resolution} is no number from 0.25 to 1; write one, or auto.`);
    this.#resolution = resolution === "auto" ? "auto" : number;
    this.#setScale(number);
    this.invalidate();
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

  /** The satellite whose marker in the last frame is nearest to a canvas pixel, within so many pixels; null without one. */
  pickSatellite(x, y, within = 12 * devicePixelRatio) {
    const far = (label) => Math.hypot(label.x - x, label.y - y);
    const nearest = this.labels.reduce((best, label) => (!best || far(label) < far(best) ? label : best), null);
    return nearest && far(nearest) <= within ? { index: nearest.index, name: nearest.name } : null;
  }

  /** Sends the event `pick` for a canvas pixel. */
  click(x, y) {
    this.dispatchEvent(new CustomEvent("pick", { detail: { x, y, place: this.pick(x, y), satellite: this.pickSatellite(x, y) } }));
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
    this.#drawAt();
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
      if (this.#isDrawnByPage) {
        // A page that draws each frame may do so after this callback.
        this.#isDrawnByPage = false;
        this.invalidate();
        return;
      }
      this.#adapt(now);
      this.#drawAt(this.#epochAt(now));
    });
  }

  /** Draws now, in place of the due frame. Returns whether the frame is complete: satellite curves grow over several frames. */
  draw(ms = this.#epochAt(performance.now())) {
    if (!this.#globe || this.#isLost) return true;
    this.#isDrawnByPage = true;
    const now = document.timeline.currentTime;
    // Several pictures within a frame say nothing about the time of one.
    if (now > this.#lastFrame) this.#adapt(now);
    return this.#drawAt(ms);
  }

  /** Draws an instant in place of the due frame. */
  #drawAt(ms = this.#epochAt(performance.now())) {
    if (!this.#globe || this.#isLost) return true;
    cancelAnimationFrame(this.#request);
    this.#request = 0;
    let isWhole = true;
    try {
      isWhole = this.#globe.draw(ms);
    } catch (error) {
      this.#fail(error);
    }
    this.dispatchEvent(new CustomEvent("frame", { detail: { epoch: new Date(ms) } }));
    if (this.#rate !== 0 || !isWhole) this.invalidate();
    return isWhole;
  }

  /** The current image as a file. */
  toBlob(type = "image/png") {
    // A canvas can only be read in the task that drew it.
    this.#drawAt();
    return new Promise((resolve, reject) => {
      this.#canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error(`The browser writes no ${type}.`))), type);
    });
  }

  /** Frees memory and device. */
  free() {
    if (!this.#globe) return;
    this.#decoder?.end();
    this.#decoder = null;
    this.#controls?.detach();
    clearInterval(this.#faultTimer);
    cancelAnimationFrame(this.#request);
    clearTimeout(this.#sharpening);
    this.#canvas?.removeEventListener("webglcontextlost", this.#contextLost);
    document.removeEventListener("visibilitychange", this.#visibilityChanged);
    const globe = this.#globe;
    this.#globe = null;
    globe.destroy();
    globe.free();
  }

  #setScale(scale) {
    if (scale === this.#scale) return;
    this.#alive.setScale(scale);
    this.#scale = scale;
    this.#frameTimes = [];
  }

  /** Draws fewer pixels while frames follow each other too slowly, and all of them once nothing moves. */
  #adapt(now) {
    const since = now - this.#lastFrame;
    this.#lastFrame = now;
    clearTimeout(this.#sharpening);
    if (this.#resolution !== "auto") return;
    if (this.#scale < 1) {
      this.#sharpening = setTimeout(() => {
        if (!this.#globe || this.#isLost) return;
        this.#setScale(1);
        this.#drawAt();
      }, STILL_MS);
    }
    if (since > STILL_MS) {
      this.#frameTimes = [];
      return;
    }
    this.#frameTimes.push(since);
    if (this.#frameTimes.length < JUDGED_FRAMES) return;
    const median = this.#frameTimes.sort((a, b) => a - b)[JUDGED_FRAMES / 2];
    this.#frameTimes = [];
    if (median > SLOW_FRAME_MS) this.#setScale(Math.max(COARSEST, this.#scale / FINER));
    else if (median < SLOW_FRAME_MS / 3) this.#setScale(Math.min(1, this.#scale * FINER));
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
