// <terrella-earth>: the Earth as an element of a page. See terrella.d.ts.

import { FIRST_PICTURE, TerrellaEarth } from "./earth.js";

export { TerrellaEarth };

/** Attributes whose changes apply to a live Earth. */
const VIEW = ["lat", "lon", "altitude", "heading", "pitch", "fov"];
const LIVE = [...VIEW, "epoch", "rate", "exposure", "look", "hide", "resolution", "stations", "lines", "tracks", "follow", "pack", "scene"];
/** Limit on labels: more would hide the globe. */
const MAX_LABELS = 50;
/** Estimated width of a letter of a label, and the height of a line, pixels of the page: a name that would cover another moves a line, or is left out. */
const LETTER_PX = 7.5;
const ROW_PX = 15;
/** What screen readers say of the canvas. */
const LABEL = "The Earth";
const LABEL_WITH_CONTROLS = "Globe. Arrow keys turn it, plus and minus approach, shift and arrows tilt, N turns north up.";
/** A device that is lost again within this time is not reopened, milliseconds. */
const RETRY_AFTER_MS = 10_000;

// A constructed style sheet, which a strict content security policy allows.
const sheet = new CSSStyleSheet();
sheet.replaceSync(`
  :host { display: block; position: relative; overflow: hidden; background: #000; min-height: 10em; }
  :host([hidden]) { display: none; }
  canvas { display: block; width: 100%; height: 100%; position: absolute; inset: 0; touch-action: none; cursor: grab; }
  canvas:active { cursor: grabbing; }
  :host([controls="off"]) canvas { touch-action: auto; cursor: auto; }
  canvas:focus-visible { outline: 2px solid #5cc8ff; outline-offset: -2px; }
  .names { position: absolute; inset: 0; pointer-events: none; font: 13px/1 system-ui, sans-serif; color: #fff; text-shadow: 0 0 3px #000, 0 0 3px #000; }
  .names span[hidden] { display: none; }
  .names span { position: absolute; left: 0; top: 0; white-space: nowrap; }
  .note { position: absolute; left: 0; bottom: 0; padding: 0.4em 0.8em; font: 13px/1.4 system-ui, sans-serif; color: #fff; background: #000a; pointer-events: none; }
  .note:empty { display: none; }
  .message { position: absolute; inset: 0; display: grid; place-items: center; padding: 2em; text-align: center; font: 16px/1.5 system-ui, sans-serif; color: #fff; pointer-events: none; }
  .message:empty { display: none; }
`);

export class TerrellaEarthElement extends HTMLElement {
  static observedAttributes = LIVE;

  #root = this.attachShadow({ mode: "open" });
  #names = document.createElement("div");
  #message = document.createElement("div");
  /** What is missing and will come. */
  #note = document.createElement("div");
  #earth = null;
  #abort = null;
  #observers = [];
  #lastLoss = -Infinity;
  #satellites = null;
  /** Values of the properties `maps` and `wasm`: bytes cannot be attributes. */
  #sources = {};

  constructor() {
    super();
    this.#root.adoptedStyleSheets = [sheet];
    this.#names.className = "names";
    this.#names.ariaHidden = "true";
    this.#message.className = "message";
    this.#message.role = "status";
    this.#note.className = "note";
    this.#note.role = "status";
  }

  /** The Earth, once it is ready. */
  get earth() {
    return this.#earth;
  }

  get maps() {
    return this.#sources.maps ?? this.getAttribute("maps") ?? undefined;
  }

  set maps(maps) {
    this.#sources.maps = maps;
  }

  get wasm() {
    return this.#sources.wasm;
  }

  set wasm(wasm) {
    this.#sources.wasm = wasm;
  }

  /** Takes a state that a simulator pushes. Returns the satellite's name; before the Earth is ready the state is dropped. */
  push(packet) {
    return this.#earth?.push(packet);
  }

  /** Draws satellites now, or as soon as the Earth is ready. */
  setSatellites(text, name) {
    const names = this.#earth?.setSatellites(text, name);
    this.#satellites = [text, name];
    return names;
  }

  connectedCallback() {
    this.#start();
  }

  disconnectedCallback() {
    this.#stop();
  }

  attributeChangedCallback(name, before, now) {
    if (!this.#earth || before === now || now === null) return;
    try {
      this.#follow(name, now);
    } catch (error) {
      this.#fail(error);
    }
  }

  #follow(name, value) {
    if (VIEW.includes(name)) this.#earth.view = { [name]: value };
    else this.#earth[name] = value;
  }

  /** A number that is read once; undefined for the default. */
  #number(name) {
    return this.hasAttribute(name) ? Number(this.getAttribute(name)) : undefined;
  }

  async #start() {
    const abort = (this.#abort = new AbortController());
    const canvas = document.createElement("canvas");
    const controls = this.getAttribute("controls") !== "off";
    if (controls) canvas.tabIndex = 0;
    canvas.role = controls ? "application" : "img";
    canvas.ariaLabel = this.getAttribute("aria-label") ?? (controls ? LABEL_WITH_CONTROLS : LABEL);
    this.#root.replaceChildren(canvas, this.#names, this.#message, this.#note);
    this.#note.textContent = "";
    this.#message.role = "status";
    const size = () => this.getBoundingClientRect();
    canvas.width = Math.max(1, Math.round(size().width * devicePixelRatio));
    canvas.height = Math.max(1, Math.round(size().height * devicePixelRatio));
    try {
      const earth = await TerrellaEarth.create(canvas, {
        maps: this.maps,
        preview: this.getAttribute("preview") ?? undefined,
        wasm: this.wasm,
        backend: this.getAttribute("backend") ?? "auto",
        samples: this.#number("samples"),
        anisotropy: this.#number("anisotropy"),
        controls,
        epoch: this.getAttribute("epoch") ?? undefined,
        seasons: this.getAttribute("seasons") !== "off",
        signal: abort.signal,
        progress: (part, what) => {
          if (abort.signal.aborted) return;
          // Finer maps come behind the first picture.
          this.#message.textContent = part < FIRST_PICTURE ? `Loading the Earth … ${Math.round((100 * part) / FIRST_PICTURE)} %` : "";
          this.dispatchEvent(new CustomEvent("progress", { detail: { part, what } }));
        },
      });
      this.#earth = earth;
      for (const type of ["frame", "viewchange", "complete", "pack", "pick", "scene", "tiles"]) {
        earth.addEventListener(type, (event) => this.dispatchEvent(new CustomEvent(type, { detail: event.detail })));
      }
      earth.addEventListener("frame", () => this.#writeNames(canvas));
      earth.addEventListener("tiles", ({ detail }) => {
        this.#note.textContent = detail ? `Some tiles are missing: ${detail}` : "";
      });
      earth.addEventListener("error", (event) => this.#fail(event.detail));
      earth.addEventListener("devicelost", (event) => this.#restart(event.detail));
      for (const name of LIVE) {
        if (this.hasAttribute(name)) this.#follow(name, this.getAttribute(name));
      }
      if (this.#satellites) earth.setSatellites(...this.#satellites);
      const address = this.getAttribute("satellites");
      if (!this.#satellites && address) await this.#fetchSatellites(address, abort.signal);
      earth.draw();
      this.#observe(canvas, earth);
      this.dispatchEvent(new CustomEvent("ready"));
    } catch (error) {
      if (!abort.signal.aborted) this.#fail(error);
    }
  }

  async #fetchSatellites(address, signal) {
    const response = await fetch(address, { signal });
    if (!response.ok) throw new Error(`The satellites could not be loaded: ${address} answered ${response.status}. Check the address.`);
    this.#earth?.setSatellites(await response.text(), this.getAttribute("satellite"));
  }

  #observe(canvas, earth) {
    const resize = new ResizeObserver(() => {
      const { width, height } = this.getBoundingClientRect();
      earth.resize(width * devicePixelRatio, height * devicePixelRatio);
    });
    const sight = new IntersectionObserver((entries) => {
      earth.isVisible = entries.at(-1).isIntersecting;
    });
    this.#observers = [resize, sight];
    for (const observer of this.#observers) observer.observe(this);
  }

  #stop() {
    this.#abort?.abort();
    for (const observer of this.#observers) observer.disconnect();
    this.#observers = [];
    this.#earth?.free();
    this.#earth = null;
    this.#root.replaceChildren();
    this.#names.replaceChildren();
  }

  #restart(why) {
    this.dispatchEvent(new CustomEvent("devicelost", { detail: why }));
    const view = this.#earth?.view;
    const isFirst = performance.now() - this.#lastLoss > RETRY_AFTER_MS;
    this.#lastLoss = performance.now();
    if (!isFirst) {
      this.#fail(new Error(`The graphics device was lost again: ${why}. Reload the page.`));
      return;
    }
    const kept = Object.fromEntries(LIVE.filter((name) => !VIEW.includes(name)).map((name) => [name, this.#earth?.[name]]));
    if (this.#earth?.isLive) kept.epoch = "live";
    this.#stop();
    this.addEventListener(
      "ready",
      () => {
        // A changed view ends a ride.
        Object.assign(this.#earth, { view, ...kept });
      },
      { once: true },
    );
    this.#start();
  }

  #fail(error) {
    this.#message.role = "alert";
    this.#message.textContent = error?.message ?? String(error);
    this.dispatchEvent(new CustomEvent("error", { detail: error }));
  }

  #writeNames(canvas) {
    const labels = this.#earth.labels.slice(0, MAX_LABELS);
    while (this.#names.childElementCount < labels.length) this.#names.append(document.createElement("span"));
    while (this.#names.childElementCount > labels.length) this.#names.lastChild.remove();
    const scale = canvas.clientWidth / Math.max(canvas.width, 1);
    const placed = [];
    labels.forEach((label, i) => {
      const span = this.#names.children[i];
      const [x, y, width] = [label.x * scale + 9, label.y * scale - 6, LETTER_PX * label.name.length];
      const isFree = (row) => !placed.some((other) => Math.abs(other.y - (y + row)) < ROW_PX && x < other.x + other.width && other.x < x + width);
      const row = [0, ROW_PX, -ROW_PX].find(isFree);
      span.hidden = row === undefined;
      if (span.hidden) return;
      placed.push({ x, y: y + row, width });
      span.textContent = label.name;
      span.style.transform = `translate(${x}px, ${y + row}px)`;
    });
  }
}

function attributeText(name, value) {
  if (value instanceof Date) return value.toISOString();
  return name === "stations" && typeof value !== "string" ? JSON.stringify(value) : String(value);
}

// Numbers, dates and words as properties too: read from the Earth if it exists, else from the attribute.
for (const name of LIVE) {
  Object.defineProperty(TerrellaEarthElement.prototype, name, {
    configurable: true,
    enumerable: true,
    get() {
      const earth = this.earth;
      if (!earth) return this.getAttribute(name);
      return VIEW.includes(name) ? earth.view[name] : earth[name];
    },
    set(value) {
      this.setAttribute(name, attributeText(name, value));
      if (this.earth) VIEW.includes(name) ? (this.earth.view = { [name]: value }) : (this.earth[name] = value);
    },
  });
}

if (!customElements.get("terrella-earth")) customElements.define("terrella-earth", TerrellaEarthElement);
