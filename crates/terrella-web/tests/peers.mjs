// Times frames of the Earth beside those of CesiumJS in one headless Chromium:
//   node peers.mjs TERRELLA_ADDRESS CESIUM_ADDRESS ROUNDS OUT_FOLDER
// in a folder that has playwright-core. The first address serves the pages, the second the folder Build/Cesium of the npm package. Each
// renderer has a tab, and their turns are interleaved. Writes a picture of each renderer at each height, and peers.json: medians of the turns, and
// quartiles of CesiumJS's time over the renderer's own in the same round.

import fs from "node:fs";
import path from "node:path";
import { launch } from "./page.mjs";

const [terrella, cesium, roundsText, out] = process.argv.slice(2);
const rounds = Number(roundsText);

const SIZE = { width: 1280, height: 720 };
const HEIGHTS_KM = [400, 2000, 7000, 20000];
/** Straight down on Sicily, so that a near view has land and sea; about an hour before noon. */
const VIEW = { lat: 38, lon: 14, fov: 45, epoch: "2018-06-01T10:00:00Z" };
/** Timed frames of a turn, after one that is not timed. */
const FRAMES = 5;
const PATIENCE_MS = 240_000;
/** The least of the brightest channel in the middle of a picture, of 255: sky is darker than the Earth by day. */
const LEAST_IN_THE_MIDDLE = 16;
const BASE = "CesiumJS";
/** The maps of an Earth that draws as little as CesiumJS; as shipped it has all of its folder. */
const ONE_MAP = { "day.jpg": "/terrella/maps/day.jpg" };
const RENDERERS = [
  { name: BASE, address: cesium, make: makeCesium, script: '<script src="/Cesium.js"></script>' },
  ...[
    ["Terrella on WebGPU", { backend: "webgpu" }],
    ["Terrella on WebGL2", { backend: "webgl" }],
    ["Terrella with one map on WebGPU", { backend: "webgpu", maps: ONE_MAP }],
    ["Terrella with one map on WebGL2", { backend: "webgl", maps: ONE_MAP }],
  ].map(([name, options]) => ({ name, address: terrella, make: makeTerrella, options, script: "" })),
];

/** The page of a renderer. It has no content policy: CesiumJS compiles text at run time. */
const page = (script) => `<!doctype html>
<html lang="en">
  <head>
    <meta charset="utf-8" />
    <title>Peers</title>
    <link rel="icon" href="data:," />
    <style>
      body { margin: 0; background: #000; }
      canvas { display: block; width: ${SIZE.width}px; height: ${SIZE.height}px; }
    </style>
    ${script}
  </head>
  <body></body>
</html>`;

/** Runs in the page before all else: keeps the WebGPU device. */
function prepare() {
  window.faults = [];
  if (!window.GPUAdapter) return;
  const requestDevice = GPUAdapter.prototype.requestDevice;
  GPUAdapter.prototype.requestDevice = async function (...options) {
    window.device = await requestDevice.apply(this, options);
    window.device.addEventListener("uncapturederror", (event) => window.faults.push(event.error.message));
    window.device.lost.then((loss) => window.faults.push(`the device is lost: ${loss.message}`));
    return window.device;
  };
}

/** Runs in the page: CesiumJS as its widget starts it, with the imagery of the package and with the light of the Sun. */
async function makeCesium({ size, view }) {
  const { Cesium } = window;
  const host = document.createElement("div");
  document.body.append(host);
  const folder = Cesium.buildModuleUrl("Assets/Textures/NaturalEarthII");
  const imagery = await Cesium.TileMapServiceImageryProvider.fromUrl(folder);
  imagery.errorEvent.addEventListener((error) => window.faults.push(error.message));
  const widget = new Cesium.CesiumWidget(host, {
    baseLayer: new Cesium.ImageryLayer(imagery),
    // It draws 4 samples into a texture of its own; those of the canvas would only make it slower.
    contextOptions: { webgl: { antialias: false } },
    useDefaultRenderLoop: false,
    showRenderLoopErrors: false,
    creditContainer: document.createElement("div"),
  });
  const { scene, canvas } = widget;
  scene.renderError.addEventListener((_, error) => window.faults.push(String(error)));
  scene.globe.enableLighting = true;
  scene.moon.show = false;
  const [time, vertical] = [Cesium.JulianDate.fromIso8601(view.epoch), Cesium.Math.toRadians(view.fov)];
  // CesiumJS's field of view is that of the longer side.
  scene.camera.frustum.fov = 2 * Math.atan(Math.tan(vertical / 2) * (size.width / size.height));
  const gl = canvas.getContext("webgl2");
  const draw = () => {
    scene.initializeFrame();
    scene.render(time);
  };
  const show = async (altitude) => {
    const destination = Cesium.Cartesian3.fromDegrees(view.lon, view.lat, altitude);
    scene.camera.setView({ destination, orientation: { heading: 0, pitch: -Cesium.Math.PI_OVER_TWO, roll: 0 } });
    if (Math.abs(scene.camera.frustum.fovy - vertical) > 1e-9) throw new Error(`CesiumJS has a field of view of ${scene.camera.frustum.fovy}`);
    // Tiles ask for others once they are there.
    for (let calm = 0; calm < 10; calm = scene.globe.tilesLoaded ? calm + 1 : 0) {
      draw();
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
  };
  window.peer = { canvas, gl, draw, show, about: `CesiumJS ${Cesium.VERSION}` };
}

/** Runs in the page: the Earth with these options, else as it is shipped. */
async function makeTerrella({ size, view, options }) {
  const { TerrellaEarth } = await import("/terrella/earth.js");
  const canvas = Object.assign(document.createElement("canvas"), size);
  document.body.append(canvas);
  const earth = await TerrellaEarth.create(canvas, { ...options, controls: false });
  await earth.complete;
  earth.resolution = 1;
  earth.addEventListener("error", (event) => window.faults.push(event.detail.message));
  earth.addEventListener("devicelost", (event) => window.faults.push(event.detail));
  earth.epoch = view.epoch;
  const show = async (altitude) => {
    earth.view = { lat: view.lat, lon: view.lon, altitude, heading: 0, pitch: -90, fov: view.fov };
    // The page draws the new view once by itself.
    await new Promise((resolve) => earth.addEventListener("frame", resolve, { once: true }));
    while (earth.compiling) await new Promise((resolve) => setTimeout(resolve, 50));
  };
  const gl = earth.backend === "webgl" ? canvas.getContext("webgl2") : null;
  window.peer = { canvas, gl, draw: () => earth.draw(), show, about: `Terrella, ${earth.adapter}` };
}

/** Runs in the page: `peer.finish` waits for the graphics, `peer.picture` draws a frame and reads it. */
function complete() {
  const { peer, device } = window;
  const { canvas, gl } = peer;
  const { width, height } = canvas;
  const pixel = new Uint8Array(4);
  const waitForWebGl = () => {
    const bound = gl.getParameter(gl.READ_FRAMEBUFFER_BINDING);
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, null);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, bound);
  };
  peer.finish = gl ? waitForWebGl : () => device.queue.onSubmittedWorkDone();
  peer.picture = () => {
    const plain = Object.assign(document.createElement("canvas"), { width, height });
    const context = plain.getContext("2d");
    // In the task that drew: later the canvas is empty.
    peer.draw();
    context.drawImage(canvas, 0, 0);
    peer.finish();
    const error = gl?.getError();
    if (error) window.faults.push(`WebGL error ${error}`);
    const middle = Math.max(...context.getImageData(width >> 1, height >> 1, 1, 1).data.slice(0, 3));
    return { file: plain.toDataURL("image/png"), middle };
  };
  return [width, height];
}

/** Runs in the page: the milliseconds of each timed frame of a turn. */
async function drawTurn(frames) {
  const { peer } = window;
  const frame = () =>
    new Promise((resolve, reject) => {
      requestAnimationFrame(async () => {
        try {
          const begin = performance.now();
          peer.draw();
          await peer.finish();
          resolve(performance.now() - begin);
        } catch (error) {
          reject(error);
        }
      });
    });
  await frame();
  const times = [];
  for (let i = 0; i < frames; i++) times.push(await frame());
  return times;
}

/** Least, first quartile, median, third quartile and greatest value. */
function quartiles(values) {
  const sorted = [...values].sort((a, b) => a - b);
  return [0, 0.25, 0.5, 0.75, 1].map((part) => {
    const at = part * (sorted.length - 1);
    const low = Math.floor(at);
    return sorted[low] + (at - low) * ((sorted[low + 1] ?? sorted[low]) - sorted[low]);
  });
}

const median = (values) => quartiles(values)[2];

class Peer {
  constructor(browser, renderer) {
    this.browser = browser;
    this.renderer = renderer;
    this.name = renderer.name;
    /** What went wrong outside the page's own reach. */
    this.said = [];
  }

  async open() {
    const { address, make, script, options } = this.renderer;
    const context = await this.browser.newContext({ viewport: SIZE, deviceScaleFactor: 1 });
    const tab = (this.tab = await context.newPage());
    tab.on("console", (message) => message.type() === "error" && this.said.push(message.text()));
    tab.on("pageerror", (error) => this.said.push(error.message));
    // Nothing may come from elsewhere: it would be another load, and other pictures.
    await context.route("**/*", (route) => {
      const url = route.request().url();
      if (url === `${address}/peers`) return route.fulfill({ contentType: "text/html", body: page(script) });
      if (url.startsWith(`${address}/`)) return route.continue();
      this.said.push(`the page asks for ${url}`);
      return route.abort();
    });
    await tab.addInitScript(prepare);
    await tab.goto(`${address}/peers`);
    await this.ask(make, { size: SIZE, view: VIEW, options });
    const [width, height] = await this.ask(complete);
    if (width !== SIZE.width || height !== SIZE.height) throw new Error(`${this.name} has a canvas of ${width} × ${height} pixels`);
    this.about = await this.ask(() => window.peer.about);
    this.adapter = await this.ask(() => {
      const { gl } = window.peer;
      if (gl) return gl.getParameter(gl.getExtension("WEBGL_debug_renderer_info").UNMASKED_RENDERER_WEBGL);
      const { vendor, architecture, description } = window.device.adapterInfo;
      return [vendor, architecture, description].filter(Boolean).join(" ");
    });
    await this.check();
  }

  /** Runs a function in the page, which must answer in time. */
  async ask(work, argument) {
    let timer;
    const late = new Promise((_, reject) => {
      timer = setTimeout(() => reject(new Error(`${this.name} did not answer in ${PATIENCE_MS} ms: ${this.said}`)), PATIENCE_MS);
    });
    return Promise.race([this.tab.evaluate(work, argument), late]).finally(() => clearTimeout(timer));
  }

  /** Ends the run if the page has complained. */
  async check() {
    const faults = [...this.said, ...(await this.ask(() => window.faults))];
    if (faults.length > 0) throw new Error(`${this.name}: ${faults.slice(0, 3).join(" | ")}`);
  }

  async show(km) {
    await this.tab.bringToFront();
    await this.ask((altitude) => window.peer.show(altitude), 1000 * km);
    const { file, middle } = await this.ask(() => window.peer.picture());
    fs.writeFileSync(path.join(out, `${km} km, ${this.name}.png`), Buffer.from(file.split(",")[1], "base64"));
    // A picture without an Earth would be drawn quickly.
    if (middle < LEAST_IN_THE_MIDDLE) throw new Error(`${this.name} draws no Earth from ${km} km: the middle has ${middle} of 255`);
    await this.check();
  }

  /** The median of a turn's frames, milliseconds. */
  async turn() {
    await this.tab.bringToFront();
    const times = await this.ask(drawTurn, FRAMES);
    await this.check();
    return median(times);
  }
}

async function measure(peers) {
  const rows = [];
  for (const km of HEIGHTS_KM) {
    for (const peer of peers) await peer.show(km);
    const times = new Map(peers.map((peer) => [peer.name, []]));
    for (let round = 0; round < rounds; round++) {
      // The first of a round is not always the same.
      const first = round % peers.length;
      for (const peer of [...peers.slice(first), ...peers.slice(0, first)]) times.get(peer.name).push(await peer.turn());
    }
    for (const [name, own] of times) {
      const ratios = times.get(BASE).map((base, round) => base / own[round]);
      const [, first, ratio, third] = quartiles(ratios);
      rows.push({ height_km: km, renderer: name, ms: median(own), ratio, first_quartile: first, third_quartile: third });
      console.log(`${km} km, ${name}: ${own.map((ms) => ms.toFixed(1)).join(", ")} ms; ${ratio.toFixed(2)} × (${first.toFixed(2)} to ${third.toFixed(2)})`);
    }
  }
  return rows;
}

fs.mkdirSync(out, { recursive: true });
const browser = await launch("webgpu");
try {
  const peers = RENDERERS.map((renderer) => new Peer(browser, renderer));
  for (const peer of peers) {
    await peer.open();
    console.log(`${peer.name}: ${peer.about}; ${peer.adapter}`);
  }
  const rows = await measure(peers);
  const result = { version: peers[0].about, adapter: peers[0].adapter, browser: `Chromium ${browser.version()}`, frames: FRAMES, rows };
  fs.writeFileSync(path.join(out, "peers.json"), `${JSON.stringify(result, null, 2)}\n`);
} finally {
  await browser.close();
}
