// The Earth on a canvas: picks a backend, loads maps, draws when something has changed.

import { Controls } from "./controls.js";
import { Decoder } from "./decoder.js";
import { milliseconds, yearFraction } from "./epochs.js";
import { BACKENDS, MAPS, PREVIEW_MAPS } from "./files.js";
import { loadBackend, loadLines, loadMaps, mapSources } from "./load.js";
import { ShownPack } from "./pack.js";
import { ShownScene } from "./shown-scene.js";
import { chosenWords, labelObjects, LINES, MAPPED_LINES, passObjects, spanObjects, stationNumbers, TRACKS, wholeStations } from "./marks.js";

/** Interval between checks for device faults while nothing is drawn, milliseconds. */
const FAULT_INTERVAL_MS = 1000;
/** The catalogue of stars, and the snow and ice of each month, among the maps. */
const STARS = "stars.bin";
const SEASONS = "seasons.png";
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

/** Milliseconds in an hour. */
const HOUR = 3_600_000;

/** Parts that can be hidden, in the order of the wasm function. */
const LAYERS = ["clouds", "lights", "relief", "water", "air", "sky"];
const LOOKS = ["standard", "full"];
/** How the camera rides on a satellite. */
const RIDES = ["nadir", "horizon", "chase"];
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
  /** Whether pushed states set the instant, and the one that was drawn last. */
  #isLive = false;
  #drawnLive = NaN;
  #isVisible = true;
  #isLost = false;
  #isSpeedingUp = false;
  #names = [];
  #stations = [];
  #lines = [];
  #tracks = "auto";
  #ride = "";
  #scene = new ShownScene(this, () => this.#globe);
  /** Settles when coast lines and borders are there. */
  #vectorMap = null;
  #pack = new ShownPack({
    globe: () => this.#globe,
    ready: () => this.complete,
    invalidate: () => this.invalidate(),
    send: (type, detail) => this.dispatchEvent(new CustomEvent(type, { detail })),
  });
  /** Settles when the whole maps are drawn. */
  complete = Promise.resolve();

  /** Creates the Earth on a canvas without a context; see terrella.d.ts. */
  static async create(canvas, options = {}) {
    const { maps = MAPS, backend = "auto", samples = 4, anisotropy = 8, signal, controls = true, epoch = "now", seasons = true } = options;
    const shown = epoch === "live" ? Date.now() : milliseconds(epoch);
    const season = seasons ? yearFraction(shown) : undefined;
    const preview = options.preview ?? (options.maps ? undefined : PREVIEW_MAPS);
    const progress = options.progress ?? (() => {});
    progress(0, "loading");
    const kind = backend === "auto" ? await availableBackend() : backend;
    if (!BACKENDS[kind]) throw new TypeError(`There is no backend ${kind}; write auto, webgpu or webgl.`);
    const { [STARS]: stars, [SEASONS]: months, ...years } = mapSources(maps, Object.keys(MAPS));
    const seasonal = (sources) => (seasons && months ? { ...sources, [SEASONS]: months } : sources);
    const whole = seasonal(years);
    const first = preview ? seasonal(mapSources(preview, Object.keys(PREVIEW_MAPS))) : whole;
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
      await decoder.decode(files, season, (...band) => opened.band(...band));
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
    earth.epoch = epoch;
    earth.#lostPrefix = module.Globe.lostPrefix();
    earth.#faultTimer = setInterval(() => earth.#tellFaults(), FAULT_INTERVAL_MS);
    canvas.addEventListener("webglcontextlost", earth.#contextLost);
    document.addEventListener("visibilitychange", earth.#visibilityChanged);
    if (controls) earth.#controls = new Controls(canvas, earth);
    progress(FIRST_PICTURE, "ready");
    earth.complete = preview ? earth.#refine(whole, season, signal, progress) : Promise.resolve(progress(1, "complete"));
    // An event reports its failure too.
    earth.complete.catch(() => {});
    if (options.pack) earth.pack = options.pack;
    earth.invalidate();
    return earth;
  }

  /** Replaces the small maps by the whole ones. */
  async #refine(sources, season, signal, progress) {
    try {
      const part = (part) => progress(FIRST_PICTURE + (1 - FIRST_PICTURE) * part, "refining");
      const files = await loadMaps(sources, signal, (loaded) => part(PART_LOADED * loaded));
      await this.#decoder?.decode(files, season, (...band) => this.#globe?.band(...band), () => this.#idle());
      if (!this.#globe) return;
      this.#globe.setMaps();
      await this.#idle();
      if (!this.#globe) return;
      this.#globe.setCityLights();
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

  /** Settles when the device has drawn what it has been given. */
  async #idle() {
    while (!this.#isLost && this.#globe?.isIdle() === false) await new Promise((resolve) => setTimeout(resolve));
  }

  /** Creates the pipelines that make further frames faster, one at a time, while the page has nothing to do. */
  async #speedUp() {
    if (this.#isSpeedingUp) return;
    this.#isSpeedingUp = true;
    try {
      while (!this.#isLost && this.#globe?.hasNextPipeline()) {
        await this.#idle();
        // Safari has no such callback.
        await new Promise((resolve) => (window.requestIdleCallback ?? setTimeout)(resolve));
        this.#globe?.makeNextPipeline();
      }
    } catch (error) {
      this.#fail(error);
    } finally {
      this.#isSpeedingUp = false;
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

  /** Whether shaders are still to be compiled that draw the last picture faster. */
  get compiling() {
    return this.#alive.hasNextPipeline();
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

  /** How the camera rides on a satellite: "nadir", "horizon", "chase", or "" for a camera over the ground. A change of the view ends it. */
  get follow() {
    return this.#alive.isFollowing() ? this.#ride : "";
  }

  set follow(how) {
    this.ride(how);
  }

  /** The same on a satellite of the list. */
  ride(how, satellite = 0) {
    const word = how ?? "";
    if (word && !RIDES.includes(word)) throw new TypeError(`A camera does not follow as ${word}; write ${RIDES.join(", ")} or nothing.`);
    this.#alive.setFollow(word, Number(satellite));
    this.#ride = word;
    this.invalidate();
  }

  /** Hidden parts, an array or text of the words clouds, lights, relief, water, air, sky. */
  get hide() {
    return [...this.#hidden];
  }

  set hide(parts) {
    const hidden = chosenWords(parts, LAYERS, (part) => `part ${part} to hide`);
    this.#alive.setLayers(...LAYERS.map((layer) => !hidden.includes(layer)));
    this.#hidden = hidden;
    this.invalidate();
  }

  /** "standard", or "full" with cloud shadows, moonlight, airglow and the Milky Way. */
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
    const isLive = epoch === "live";
    if (!isLive) this.#shown = { ms: milliseconds(epoch), at: performance.now() };
    this.#isLive = isLive;
    this.invalidate();
  }

  /** Whether pushed states set the instant. */
  get isLive() {
    return this.#isLive;
  }

  get rate() {
    return this.#rate;
  }

  set rate(rate) {
    if (!Number.isFinite(Number(rate))) throw new TypeError(`The rate ${rate} is no number; write simulated seconds per second.`);
    if (!this.#isLive) this.epoch = this.epoch;
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

  /** Address of the imagery pack; null without one. */
  get pack() {
    return this.#pack.address;
  }

  set pack(address) {
    // An event reports its failure too.
    this.setPack(address).catch(() => {});
  }

  /** Draws the tiles of an imagery pack, once its coarsest maps are there; none without an address. Returns its name and attribution. */
  setPack(address) {
    return this.#pack.show(address);
  }

  /** Whether the last frame was drawn with all tiles that it needs. */
  get isSharp() {
    return this.#alive.isSharp();
  }

  /** Draws the satellites of two-line elements or an OMM; only the one of `name`, if given. An empty text removes them. */
  setSatellites(text, name) {
    return this.#takeSatellites(text, name, false);
  }

  /** Draws satellites of a text beside the others. */
  addSatellites(text, name) {
    return this.#takeSatellites(text, name, true);
  }

  #takeSatellites(text, name, areBeside) {
    this.#names = this.#alive.setSatellites(text, name ?? undefined, areBeside);
    this.invalidate();
    return this.satellites;
  }

  /** What is drawn of satellites, an array or text of the words markers, trails, ground-tracks, subpoints, footprints; or "auto", by their number. */
  get tracks() {
    return this.#tracks === "auto" ? "auto" : [...this.#tracks];
  }

  set tracks(tracks) {
    const isChosen = tracks !== "auto";
    const chosen = isChosen ? chosenWords(tracks, TRACKS, (part) => `part ${part} of tracks`) : [];
    this.#alive.setTracks(isChosen, ...TRACKS.map((part) => chosen.includes(part)));
    this.#tracks = isChosen ? chosen : "auto";
    this.invalidate();
  }

  /** Address of the scene that was set last; null without one. */
  get scene() {
    return this.#scene.address;
  }

  set scene(address) {
    // An event reports its failure too.
    this.setScene(address).catch(() => {});
  }

  /** Shows the scene at an address. Returns the keys that a page does not have; undefined if another was set meanwhile. */
  setScene(address) {
    return this.#scene.fetch(address);
  }

  /** Shows a scene's text, whose files are relative to `base`. */
  showScene(text, base = document.baseURI) {
    return this.#scene.show(text, base);
  }

  /** The epoch of a satellite's elements. */
  elementsEpoch(index = 0) {
    const ms = this.#alive.epochOf(index);
    return ms === undefined ? undefined : new Date(ms);
  }

  /** Takes a state that a simulator pushes, as an object or a line of JSON. Returns the satellite's name. */
  push(packet) {
    const text = typeof packet === "string" ? packet : JSON.stringify(packet);
    const index = this.#alive.push(text ?? "", performance.now(), this.#rate || 1);
    if (index >= this.#names.length) this.#names = this.#alive.names();
    this.invalidate();
    return this.#names[index];
  }

  /** Ground stations, an array or a text of JSON. */
  get stations() {
    return this.#stations.map((station) => ({ ...station }));
  }

  set stations(stations) {
    const whole = wholeStations(stations);
    this.#alive.setStations(stationNumbers(whole));
    this.#stations = whole;
    this.invalidate();
  }

  /** Lines on the ground, an array or text of the words coasts, borders, graticule, twilight. */
  get lines() {
    return [...this.#lines];
  }

  set lines(lines) {
    this.#lines = chosenWords(lines, LINES, (line) => `kind of lines ${line}`);
    if (!this.#vectorMap && this.#lines.some((line) => MAPPED_LINES.includes(line))) {
      this.#vectorMap = loadLines().then((file) => {
        this.#globe?.supplyLines(file);
        this.#showLines();
      });
      this.#vectorMap.catch((error) => {
        // The next change tries again.
        this.#vectorMap = null;
        this.#fail(error);
      });
    }
    this.#showLines();
  }

  #showLines() {
    this.#globe?.setLines(...LINES.map((line) => this.#lines.includes(line)));
    this.invalidate();
  }

  /** Passes of a satellite over a station. */
  passes({ satellite = 0, station = 0, from = this.epoch, hours = 24 } = {}) {
    const begin = milliseconds(from);
    return passObjects(this.#alive.passes(satellite, station, begin, begin + hours * HOUR));
  }

  /** The times at which a satellite is in the Earth's shadow. */
  shadows({ satellite = 0, from = this.epoch, hours = 24 } = {}) {
    const begin = milliseconds(from);
    return spanObjects(this.#alive.shadows(satellite, begin, begin + hours * HOUR));
  }

  /** Label positions in the last frame, in canvas pixels. */
  get labels() {
    return labelObjects(this.#alive.labels(), [this.#names, this.#stations.map(({ name }) => name)]);
  }

  /** Latitude and longitude of the surface under a canvas pixel, degrees; null off the globe. */
  pick(x, y) {
    const place = this.#alive.pick(x, y);
    return place ? { lat: place[0], lon: place[1] } : null;
  }

  /** The satellite whose marker in the last frame is nearest to a canvas pixel, within so many pixels; null without one. */
  pickSatellite(x, y, within) {
    return this.#nearest("satellite", x, y, within);
  }

  /** The same of stations. */
  pickStation(x, y, within) {
    return this.#nearest("station", x, y, within);
  }

  #nearest(kind, x, y, within = 12 * devicePixelRatio) {
    const far = (label) => Math.hypot(label.x - x, label.y - y);
    const labels = this.labels.filter((label) => label.kind === kind);
    const nearest = labels.reduce((best, label) => (!best || far(label) < far(best) ? label : best), null);
    return nearest && far(nearest) <= within ? { index: nearest.index, name: nearest.name } : null;
  }

  /** Sends the event `pick` for a canvas pixel. */
  click(x, y) {
    const found = { place: this.pick(x, y), satellite: this.pickSatellite(x, y), station: this.pickStation(x, y) };
    this.dispatchEvent(new CustomEvent("pick", { detail: { x, y, ...found } }));
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
    this.#pack.follow();
    this.dispatchEvent(new CustomEvent("frame", { detail: { epoch: new Date(ms) } }));
    this.#speedUp();
    // Pushed states reach only so far.
    const moves = this.#isLive ? ms !== this.#drawnLive : this.#rate !== 0;
    this.#drawnLive = this.#isLive ? ms : NaN;
    if (moves || !isWhole) this.invalidate();
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
    this.#pack.end();
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
    // Before the first state it is now.
    if (this.#isLive) return this.#globe?.liveEpoch(now) ?? Date.now();
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
