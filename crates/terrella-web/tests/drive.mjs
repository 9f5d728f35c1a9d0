// Opens pages in headless Chromium and compares what they show with native pictures:
//   node drive.mjs ADDRESS NATIVE_FOLDER OUT_FOLDER
// in a folder that has playwright-core. Prints a line for each check, and ends with 1 if one failed.

import fs from "node:fs";
import path from "node:path";
import { check, end, launchWith } from "./page.mjs";

const [address, native, out] = process.argv.slice(2);
const views = JSON.parse(fs.readFileSync(new URL("views.json", import.meta.url)));

const SIZE = { width: 640, height: 360 };
/** How far a channel's mean and each channel of a pixel may be from the native picture's, of 255. Both are drawn on one device, so most are equal. */
const MEAN = 0.01;
const GREATEST = 1;
/** Longest task of the page's thread after the first picture, milliseconds. On WebGL2 this browser reads the canvas back in that thread, and waits for the
 * software device: there only scripts are limited. */
const LONGEST_TASK_MS = 250;
/** Longest run of scripts after the first picture, milliseconds. */
const LONGEST_SCRIPT_MS = 100;
/** What runs scripts, in the browser's trace. */
const SCRIPTS = ["EvaluateScript", "EventDispatch", "FireAnimationFrame", "FireIdleCallback", "FunctionCall", "HandlePostMessage", "RunMicrotasks", "TimerFire"];
const TRACED = ["devtools.timeline", "blink.user_timing"];
const FIRST_PICTURE = "the first picture is drawn";
const PATIENCE_MS = 240_000;
const BACKENDS = {
  webgpu: ["--enable-unsafe-webgpu", "--enable-unsafe-swiftshader"],
  webgl: ["--enable-unsafe-swiftshader"],
  none: ["--disable-gpu", "--disable-3d-apis", "--disable-webgl", "--disable-webgl2"],
};

/** Runs in the page before all else: WebGPU's canvas hands out a texture that can be read back, since this Chromium's compositor does not show
 * a software device's canvas. */
function readable() {
  if (!window.GPUCanvasContext) return;
  const configure = GPUCanvasContext.prototype.configure;
  let target;
  GPUCanvasContext.prototype.configure = function (configuration) {
    target = { ...configuration, canvas: this.canvas };
    return configure.call(this, configuration);
  };
  GPUCanvasContext.prototype.getCurrentTexture = function () {
    const { device, format, viewFormats, canvas } = target;
    const size = [canvas.width, canvas.height];
    if (target.texture?.width !== size[0] || target.texture?.height !== size[1]) {
      const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC;
      target.texture = device.createTexture({ size, format, viewFormats, usage });
    }
    return target.texture;
  };
  window.loseWebGpu = () => target.device.destroy();
  window.readWebGpu = async () => {
    const { device, format, texture } = target;
    const { width, height } = texture;
    const bytesPerRow = Math.ceil((width * 4) / 256) * 256;
    const buffer = device.createBuffer({ size: bytesPerRow * height, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ });
    const encoder = device.createCommandEncoder();
    encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, [width, height]);
    device.queue.submit([encoder.finish()]);
    await buffer.mapAsync(GPUMapMode.READ);
    const rows = new Uint8Array(buffer.getMappedRange());
    const image = new ImageData(width, height);
    const order = format.startsWith("bgra") ? [2, 1, 0] : [0, 1, 2];
    for (let y = 0; y < height; y++)
      for (let x = 0; x < width; x++)
        for (let c = 0; c < 4; c++) image.data[4 * (y * width + x) + c] = c === 3 ? 255 : rows[bytesPerRow * y + 4 * x + order[c]];
    return image;
  };
}

/** Runs in the page: draws a view or a scene, and compares it with the native picture of its name. */
async function compare({ view, picture }) {
  const element = document.querySelector("terrella-earth");
  const { earth } = element;
  const canvas = element.shadowRoot.querySelector("canvas");
  const { lat, lon, altitude, heading, pitch, fov } = view;
  earth.rate = 0;
  earth.resolution = 1;
  if (view.scene) {
    const missing = await earth.setScene(`scenes/${view.scene}.toml`);
    if (missing.length) return { error: `not in a page: ${missing.join(", ")}` };
  } else {
    earth.view = { lat, lon, altitude, heading, pitch, fov };
    earth.exposure = view.exposure;
    earth.epoch = view.epoch;
  }
  const begin = performance.now();
  earth.draw();
  const first = performance.now() - begin;
  while (earth.compiling) await new Promise((resolve) => setTimeout(resolve, 50));
  const times = [];
  for (let i = 0; i < 5; i++) {
    const begin = performance.now();
    earth.draw();
    times.push(performance.now() - begin);
  }
  const plain = document.createElement("canvas");
  [plain.width, plain.height] = [canvas.width, canvas.height];
  const context = plain.getContext("2d");
  let shown;
  if (earth.backend === "webgpu") {
    shown = await window.readWebGpu();
    context.putImageData(shown, 0, 0);
  } else {
    // In the task that drew: later the canvas is empty.
    context.drawImage(canvas, 0, 0);
    shown = context.getImageData(0, 0, plain.width, plain.height);
  }
  const file = plain.toDataURL("image/png");
  const bytes = Uint8Array.from(atob(picture), (c) => c.charCodeAt(0));
  const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }), { colorSpaceConversion: "none" });
  if (bitmap.width !== plain.width || bitmap.height !== plain.height) return { error: `${bitmap.width} × ${bitmap.height} against ${plain.width} × ${plain.height}` };
  context.drawImage(bitmap, 0, 0);
  const expected = context.getImageData(0, 0, plain.width, plain.height);
  let [sum, greatest] = [0, 0];
  for (let i = 0; i < shown.data.length; i += 4) {
    for (let c = 0; c < 3; c++) {
      const difference = Math.abs(shown.data[i + c] - expected.data[i + c]);
      sum += difference;
      greatest = Math.max(greatest, difference);
    }
  }
  return { mean: (4 * sum) / 3 / shown.data.length, greatest, first, cpu: times.sort((a, b) => a - b)[2], file };
}

/** Runs in the page: starts the element again, with the snow and ice of an instant. */
async function restart(epoch) {
  const element = document.querySelector("terrella-earth");
  element.remove();
  element.removeAttribute("seasons");
  element.setAttribute("epoch", epoch);
  const complete = new Promise((resolve) => element.addEventListener("complete", resolve, { once: true }));
  document.body.append(element);
  await complete;
}

/** Milliseconds after the first picture and durations of the longest runs of scripts in the page's thread, by a trace. */
function longestScripts(trace) {
  const { traceEvents } = JSON.parse(trace);
  const first = traceEvents.find((event) => event.name === FIRST_PICTURE);
  const isLater = (event) => event.pid === first.pid && event.tid === first.tid && event.ts > first.ts;
  const scripts = traceEvents.filter((event) => SCRIPTS.includes(event.name) && isLater(event));
  const times = scripts.map((event) => [event.ts - first.ts, event.dur ?? 0].map((us) => Math.round(us / 1000)));
  return times.sort((a, b) => b[1] - a[1]).slice(0, 5);
}

async function open(backend, page, hook) {
  const browser = await launchWith(BACKENDS[backend]);
  const context = await browser.newContext({ viewport: { width: SIZE.width, height: SIZE.height + 200 }, hasTouch: true });
  const tab = await context.newPage();
  const said = [];
  tab.on("console", (message) => message.type() === "error" && said.push(message.text()));
  tab.on("pageerror", (error) => said.push(error.message));
  tab.on("requestfailed", (request) => said.push(`${request.url()}: ${request.failure()?.errorText}`));
  // A module that does not even parse sends no event of ours.
  const broken = new Promise((resolve) => {
    tab.on("pageerror", (error) => resolve({ error: error.message }));
    setTimeout(() => resolve({ error: `nothing came in ${PATIENCE_MS} ms` }), PATIENCE_MS).unref();
  });
  if (hook) {
    await tab.addInitScript(readable);
    await browser.startTracing(tab, { categories: TRACED });
  }
  await tab.addInitScript((firstPicture) => {
    addEventListener("DOMContentLoaded", () => {
      const element = document.querySelector("terrella-earth");
      window.longTasks = [];
      new PerformanceObserver((list) => {
        for (const task of list.getEntries()) window.longTasks.push([Math.round(task.startTime), Math.round(task.duration)]);
      }).observe({ entryTypes: ["longtask"] });
      window.progress = [];
      window.outcome = new Promise((resolve) => {
        element.addEventListener("ready", () => {
          performance.mark(firstPicture);
          resolve({ ready: performance.now() });
        });
        element.addEventListener("error", (event) => resolve({ error: event.detail.message }));
      });
      element.addEventListener("progress", (event) => window.progress.push([Math.round(performance.now()), event.detail.what]));
    });
  }, FIRST_PICTURE);
  await tab.goto(`${address}${page}`);
  tab.setDefaultTimeout(PATIENCE_MS);
  const outcome = await Promise.race([tab.evaluate(() => window.outcome), broken]);
  return { browser, tab, said, outcome };
}

async function pictures(backend) {
  const { browser, tab, said, outcome } = await open(backend, "/test.html", true);
  check(`${backend}: the page is ready`, !outcome.error, outcome.error ?? `${Math.round(outcome.ready)} ms after navigation`);
  if (!outcome.error) {
    const whole = await tab.evaluate(() => document.querySelector("terrella-earth").earth.complete.then(() => performance.now(), (error) => error.message));
    check(`${backend}: the whole maps are drawn`, typeof whole === "number", typeof whole === "number" ? `${Math.round(whole)} ms after navigation` : whole);
    await tab.waitForTimeout(500);
    const scripts = longestScripts(await browser.stopTracing());
    check(`${backend}: no long script after the first picture`, scripts.length > 0 && scripts.every(([, duration]) => duration <= LONGEST_SCRIPT_MS), JSON.stringify(scripts));
    const tasks = await tab.evaluate((ready) => window.longTasks.filter(([start]) => start > ready), outcome.ready);
    if (backend === "webgpu") check(`${backend}: no long task after the first picture`, tasks.every(([, duration]) => duration <= LONGEST_TASK_MS), JSON.stringify(tasks));
    console.log(`     long tasks: ${JSON.stringify(await tab.evaluate(() => window.longTasks))}`);
    const about = await tab.evaluate(() => [document.querySelector("terrella-earth").earth.adapter, JSON.stringify(window.progress)]);
    console.log(`     ${about[0]}; ${about[1]}`);
    // One that restarts the element is the last.
    for (const view of views.toSorted((a, b) => Boolean(a.seasons) - Boolean(b.seasons))) {
      if (view.seasons) await tab.evaluate(restart, view.epoch);
      const picture = fs.readFileSync(path.join(native, `${view.name}.png`)).toString("base64");
      const found = await tab.evaluate(compare, { view, picture });
      const isGood = !found.error && found.mean <= MEAN && found.greatest <= GREATEST;
      const numbers = found.error ?? `mean ${found.mean.toFixed(4)}, greatest ${found.greatest}; processor: first ${found.first.toFixed(1)} ms, then ${found.cpu.toFixed(2)} ms`;
      check(`${backend}: ${view.name} as natively`, isGood, numbers);
      if (found.file) fs.writeFileSync(path.join(out, `${backend}-${view.name}.png`), Buffer.from(found.file.split(",")[1], "base64"));
    }
    await scenes(backend, tab, said);
    await instruments(backend, tab);
    await page(backend, tab);
    // It makes further elements, and the hook reads the canvas that was configured last.
    await moves(backend, tab);
    const faults = await tab.evaluate(() => document.querySelector("terrella-earth").shadowRoot.querySelector(".message").textContent);
    check(`${backend}: no message`, faults === "", faults);
  }
  check(`${backend}: the console is free of errors`, said.length === 0, said.slice(0, 3).join(" | "));
  await browser.close();
}

/** Scenes: what a page has of them, a camera that a drag takes off its satellite, and faults. */
async function scenes(backend, tab, said) {
  const before = said.length;
  const found = await tab.evaluate(async () => {
    const { earth } = document.querySelector("terrella-earth");
    const error = async (shown) => shown.then(() => "", (error) => error.message);
    const missing = await earth.setScene("scenes/stations.toml");
    const stations = { missing, names: earth.stations.map(({ name }) => name), lines: earth.lines.join(), tracks: earth.tracks.join(), satellites: earth.satellites, view: earth.view };
    await earth.setScene("scenes/iss.toml");
    const { rate } = earth;
    earth.rate = 0;
    earth.draw();
    const ridden = { follow: earth.follow, altitude: earth.view.altitude, rate, after: earth.epoch - Date.parse("2018-01-14T13:06:40Z") };
    earth.epoch = earth.epoch.getTime() + 600_000;
    const before = earth.view;
    earth.draw();
    const moved = Math.hypot(earth.view.lat - before.lat, earth.view.lon - before.lon);
    earth.tilt(0, 5);
    const after = earth.follow;
    const faults = {
      toml: await error(earth.showScene("[time\n")),
      key: await error(earth.showScene("camera.lat_deg = 100")),
      file: await error(earth.showScene("orbit.file = \"nowhere.tle\"")),
      address: await error(earth.setScene("scenes/nothing.toml")),
    };
    const kept = earth.satellites;
    const last = [earth.setScene("scenes/omm.toml"), earth.setScene("scenes/minimal.toml")];
    const [first, second] = await Promise.all(last);
    const raced = { first, second, hidden: earth.hide.length };
    Object.assign(earth, { hide: [], tracks: "auto", lines: [], stations: [], exposure: "auto" });
    earth.setSatellites("");
    return { stations, ridden, moved, after, faults, kept, raced };
  });
  const { stations, ridden, faults, raced } = found;
  const isShown = stations.names.join() === "Peldehue,Malargüe,Kourou" && stations.lines === "graticule,coasts,borders" && stations.tracks === "markers,ground-tracks";
  check(`${backend}: a scene has its stations, lines and satellite`, isShown && stations.missing.length === 0 && stations.satellites.join() === "ISS (ZARYA)", JSON.stringify(stations));
  check(`${backend}: its camera is over the ground`, Math.abs(stations.view.lat + 19) < 1e-9 && Math.abs(stations.view.altitude - 8e6) < 1, JSON.stringify(stations.view));
  const isRidden = ridden.follow === "horizon" && ridden.altitude > 3.9e5 && ridden.altitude < 4.3e5 && ridden.rate === 180 && ridden.after >= 0 && ridden.after < 60_000;
  check(`${backend}: a camera rides on its satellite`, isRidden && found.moved > 20, `${JSON.stringify(ridden)}, ${found.moved}° in ten minutes`);
  check(`${backend}: a change of the view ends the ride`, found.after === "");
  check(`${backend}: a text that is no scene names its line`, faults.toml.includes("line 1"), faults.toml);
  check(`${backend}: a wrong value names its key`, faults.key.includes("camera.lat_deg"), faults.key);
  check(`${backend}: a missing file of orbits is named`, faults.file.includes("nowhere.tle"), faults.file);
  check(`${backend}: a missing scene is named`, faults.address.includes("nothing.toml answered 404"), faults.address);
  check(`${backend}: a faulty scene changes nothing`, found.kept.join() === "ISS (ZARYA)", found.kept.join());
  check(`${backend}: of two scenes the last is shown`, raced.first === undefined && Array.isArray(raced.second) && raced.hidden === 6, JSON.stringify(raced));
  await tab.evaluate(() => (document.querySelector("terrella-earth").shadowRoot.querySelector(".message").textContent = ""));
  // The browser reports missing files too.
  const others = said.splice(before).filter((line) => !line.includes("404"));
  said.push(...others);
}

/** Pointer, wheel, keys and touch; and nothing is drawn when nothing moves. */
async function moves(backend, tab) {
  const drawn = () => tab.evaluate(() => new Promise((resolve) => {
    const { earth } = document.querySelector("terrella-earth");
    let frames = 0;
    earth.addEventListener("frame", () => frames++);
    setTimeout(() => resolve(frames), 1500);
  }));
  await tab.evaluate(() => {
    document.querySelector("terrella-earth").earth.view = { lat: 20, lon: 10, altitude: 9e6, heading: 0, pitch: -90, fov: 40 };
  });
  await tab.waitForTimeout(1500);
  check(`${backend}: nothing is drawn while nothing moves`, (await drawn()) === 0);
  const pick = (x, y) => tab.evaluate(([x, y]) => document.querySelector("terrella-earth").earth.pick(x, y), [x, y]);
  const view = () => tab.evaluate(() => document.querySelector("terrella-earth").earth.view);
  const box = await tab.locator("terrella-earth").boundingBox();
  const far = (a, b) => (a && b ? Math.hypot(a.lat - b.lat, a.lon - b.lon) : Infinity);
  const [from, to] = [[300, 150], [380, 210]];
  const held = await pick(...from);
  await tab.mouse.move(box.x + from[0], box.y + from[1]);
  await tab.mouse.down();
  await tab.mouse.move(box.x + to[0], box.y + to[1], { steps: 4 });
  await tab.mouse.up();
  check(`${backend}: a dragged place stays under the pointer`, far(held, await pick(...to)) < 1e-3, `${far(held, await pick(...to)).toExponential(1)}°`);
  const before = await view();
  const under = await pick(...to);
  await tab.mouse.wheel(0, -300);
  await tab.waitForTimeout(1000);
  const after = await view();
  check(`${backend}: the wheel approaches what is under the pointer`, after.altitude < 0.8 * before.altitude && far(under, await pick(...to)) < 1e-3);
  await tab.locator("terrella-earth canvas").focus();
  await tab.keyboard.press("ArrowLeft");
  await tab.keyboard.press("-");
  const keyed = await view();
  check(`${backend}: keys turn and recede`, keyed.lon !== after.lon && keyed.altitude > after.altitude);
  const pinched = await tab.evaluate(() => {
    const element = document.querySelector("terrella-earth");
    const canvas = element.shadowRoot.querySelector("canvas");
    const box = canvas.getBoundingClientRect();
    const point = (type, pointerId, x, y) =>
      canvas.dispatchEvent(new PointerEvent(type, { pointerId, pointerType: "touch", bubbles: true, clientX: box.left + x, clientY: box.top + y }));
    const before = element.earth.view.altitude;
    point("pointerdown", 11, 280, 180);
    point("pointerdown", 12, 360, 180);
    point("pointermove", 11, 200, 180);
    point("pointermove", 12, 440, 180);
    point("pointerup", 11, 200, 180);
    point("pointerup", 12, 440, 180);
    return element.earth.view.altitude / before;
  });
  const moves = (controls) => tab.evaluate((controls) => new Promise((resolve) => {
    const element = document.createElement("terrella-earth");
    if (controls) element.setAttribute("controls", controls);
    element.addEventListener("error", ({ detail }) => resolve({ error: detail.message }));
    // Earlier, its removal would end loads of maps, which the console shows as errors.
    element.addEventListener("complete", () => {
      const canvas = element.shadowRoot.querySelector("canvas");
      const view = () => JSON.stringify(element.earth.view);
      const box = canvas.getBoundingClientRect();
      const at = (type, x) => new PointerEvent(type, { pointerId: 21, button: 0, clientX: box.left + x, clientY: box.top + 60 });
      const events = [
        [new KeyboardEvent("keydown", { key: "ArrowLeft" })],
        [new WheelEvent("wheel", { deltaY: -300, cancelable: true })],
        [at("pointerdown", 200), at("pointermove", 260), at("pointerup", 260)],
      ];
      const moved = events.map((some) => {
        const before = view();
        for (const event of some) canvas.dispatchEvent(event);
        return view() !== before;
      });
      const { role, tabIndex } = canvas;
      element.remove();
      resolve({ moved, role, tabIndex });
    });
    document.body.append(element);
  }), controls);
  const [on, off] = [await moves(), await moves("off")];
  check(`${backend}: without controls, key, wheel and drag change nothing, and with them the view`, on.moved?.every(Boolean) && off.moved?.every((one) => !one), JSON.stringify([on, off]));
  check(`${backend}: without controls the canvas is a picture and no stop of the tab key`, off.role === "img" && off.tabIndex === -1 && on.tabIndex === 0);
  check(`${backend}: two fingers approach`, pinched < 0.6, pinched.toFixed(3));
  const message = await tab.evaluate(() => {
    const { earth } = document.querySelector("terrella-earth");
    try {
      earth.setSatellites("this is no orbit");
    } catch (error) {
      return error.message;
    }
  });
  check(`${backend}: bad elements are explained`, message?.includes("satellites:1"), message);
}

/** Stations, lines, passes, shadows, and states that the page pushes. */
async function instruments(backend, tab) {
  const tle = fs.readFileSync(new URL("../../terrella-orbit/data/iss.tle", import.meta.url), "utf8");
  const searched = await tab.evaluate(async (tle) => {
    const { earth } = document.querySelector("terrella-earth");
    earth.setSatellites(tle);
    earth.epoch = earth.elementsEpoch();
    earth.stations = [{ name: "Berlin", lat: 52.5, lon: 13.4, mask: 10 }];
    earth.view = { lat: 52.5, lon: 13.4, altitude: 9e6, heading: 0, pitch: -90, fov: 40 };
    earth.lines = "coasts borders graticule twilight";
    await new Promise((resolve) => setTimeout(resolve, 1500));
    earth.draw();
    const label = earth.labels.find(({ kind }) => kind === "station");
    return { label, picked: label && earth.pickStation(label.x + 3, label.y), passes: earth.passes(), shadows: earth.shadows(), lines: earth.lines };
  }, tle);
  const isMiddle = searched.label && Math.hypot(searched.label.x - SIZE.width / 2, searched.label.y - SIZE.height / 2) < 2;
  const names = await tab.evaluate(() => {
    const spans = [...document.querySelector("terrella-earth").shadowRoot.querySelectorAll(".names span:not([hidden])")];
    return spans.map((span) => [span.textContent, span.getBoundingClientRect().toJSON()]);
  });
  const isApart = ([, a], [, b]) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
  const areApart = names.every((one, i) => names.slice(i + 1).every((other) => isApart(one, other)));
  check(`${backend}: names cover no others`, names.length === 2 && areApart, JSON.stringify(names.map(([name]) => name)));
  check(`${backend}: a station has its name and is picked`, isMiddle && searched.label.name === "Berlin" && searched.picked?.name === "Berlin", JSON.stringify(searched.label));
  const seconds = ({ begin, end }) => (Date.parse(end) - Date.parse(begin)) / 1000;
  // Above 10°, a pass of the space station takes 400 s at most.
  const arePasses = searched.passes.length >= 3 && searched.passes.every((pass) => seconds(pass) > 0 && seconds(pass) < 420 && pass.elevation >= 10);
  check(`${backend}: passes of a day`, arePasses, searched.passes.map((pass) => pass.elevation.toFixed(0)).join(" "));
  const areShadows = searched.shadows.length >= 15 && searched.shadows.slice(1, -1).every((span) => seconds(span) > 1800 && seconds(span) < 2220);
  check(`${backend}: shadows of a day`, areShadows, searched.shadows.length);
  await shoot(tab, `${backend}-lines`);
  const pushed = await tab.evaluate(async () => {
    const { earth } = document.querySelector("terrella-earth");
    const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
    const error = (packet) => {
      try {
        earth.push(packet);
      } catch (error) {
        return error.message;
      }
    };
    earth.setSatellites("");
    earth.stations = [];
    earth.lines = [];
    earth.epoch = "live";
    const start = Date.UTC(2026, 0, 1);
    const state = (seconds) => {
      const [sin, cos] = [Math.sin(1.1e-3 * seconds), Math.cos(1.1e-3 * seconds)];
      return {
        name: "Kestrel",
        epoch: new Date(start + 1000 * seconds).toISOString(),
        frame: "ITRF",
        position_m: [6.9e6 * cos, 6.9e6 * sin, 0],
        velocity_m_s: [-7.59e3 * sin, 7.59e3 * cos, 0],
      };
    };
    earth.view = { lat: 0, lon: 0, altitude: 9e6, heading: 0, pitch: -90, fov: 40 };
    const begin = performance.now();
    let name;
    for (let i = 0; i < 8; i++) {
      name = earth.push(i % 2 ? JSON.stringify(state((performance.now() - begin) / 1000)) : state((performance.now() - begin) / 1000));
      await wait(150);
    }
    const behind = (performance.now() - begin - (earth.epoch - start)) / 1000;
    earth.draw();
    const found = { name, behind, isLive: earth.isLive, names: earth.satellites, labels: earth.labels, error: error({ ...state(0), frame: "MOON" }) };
    earth.setSatellites("");
    earth.epoch = start;
    return found;
  });
  check(`${backend}: pushed states become a satellite`, pushed.name === "Kestrel" && pushed.names.join() === "Kestrel" && pushed.labels[0]?.name === "Kestrel", JSON.stringify(pushed.labels));
  check(`${backend}: the live instant follows them`, pushed.isLive && pushed.behind > 0.05 && pushed.behind < 0.35, `${pushed.behind.toFixed(3)} s behind`);
  check(`${backend}: a packet with another frame is explained`, pushed.error?.includes("frame is"), pushed.error);
}

/** The blocks of JavaScript of a section of docs/web.md run as printed. */
async function page(backend, tab) {
  const text = fs.readFileSync(new URL("../../../docs/web.md", import.meta.url), "utf8");
  const block = (heading) => text.split(`## ${heading}\n`)[1]?.match(/```js\n([^]*?)```/)?.[1] ?? "throw new Error('no block')";
  const tle = fs.readFileSync(new URL("../../terrella-orbit/data/iss.tle", import.meta.url), "utf8");
  await tab.evaluate((tle) => {
    const { earth } = document.querySelector("terrella-earth");
    earth.setSatellites(tle);
    earth.epoch = earth.elementsEpoch();
  }, tle);
  const lines = [];
  const listen = (message) => message.type() === "log" && lines.push(message.text());
  tab.on("console", listen);
  await tab.evaluate(`{${block("Stations, passes and shadows")}}`);
  await tab.waitForTimeout(500);
  tab.off("console", listen);
  check(`${backend}: the page's stations have passes and shadows`, lines.length > 20, `${lines.length} lines`);
  // The content policy of the test allows no socket.
  await tab.routeWebSocket("ws://127.0.0.1:5005", (socket) => {
    const epoch = "2026-01-01T00:00:00Z";
    socket.send(JSON.stringify({ name: "Kite", epoch, frame: "GCRF", position_m: [7e6, 0, 0], velocity_m_s: [0, 7500, 0] }));
  });
  await tab.evaluate(`{${block("States from a simulator")}}`);
  await tab.waitForFunction(() => document.querySelector("terrella-earth").earth.satellites.includes("Kite"));
  const shown = await tab.evaluate(() => document.querySelector("terrella-earth").earth.epoch.toISOString());
  check(`${backend}: the page's socket moves the instant`, shown.startsWith("2026-01-01T00:00"), shown);
  await tab.evaluate(() => {
    document.querySelector("terrella-earth").epoch = "now";
  });
}

/** Writes the canvas to a file. */
async function shoot(tab, name) {
  const file = await tab.evaluate(async () => {
    const element = document.querySelector("terrella-earth");
    const canvas = element.shadowRoot.querySelector("canvas");
    element.earth.draw();
    const plain = document.createElement("canvas");
    [plain.width, plain.height] = [canvas.width, canvas.height];
    if (element.earth.backend === "webgpu") plain.getContext("2d").putImageData(await window.readWebGpu(), 0, 0);
    else plain.getContext("2d").drawImage(canvas, 0, 0);
    return plain.toDataURL("image/png");
  });
  fs.writeFileSync(path.join(out, `${name}.png`), Buffer.from(file.split(",")[1], "base64"));
}

async function viewer(backend) {
  const { browser, tab, said, outcome } = await open(backend, "/#lat=20&lon=-30&altitude=15000000&t=2018-01-14T13:06:40Z", true);
  check(`${backend}: the viewer is ready`, !outcome.error, outcome.error);
  const tle = fs.readFileSync(new URL("../../terrella-orbit/data/iss.tle", import.meta.url), "utf8");
  await tab.locator("#file").setInputFiles({ name: "iss.tle", mimeType: "text/plain", buffer: Buffer.from(tle) });
  await tab.waitForFunction(() => document.querySelector("terrella-earth").earth.satellites.length === 1);
  await tab.waitForTimeout(3000);
  const labels = await tab.evaluate(() => document.querySelector("terrella-earth").earth.labels.map((label) => label.name));
  check(`${backend}: a satellite from a file has its name`, labels.join() === "ISS (ZARYA)", labels.join());
  await shoot(tab, `${backend}-viewer`);
  await instrumented(backend, tab);
  await tab.locator("#share").click();
  const hash = await tab.evaluate(() => location.hash);
  const isWhole = ["altitude=15000000", "25544", "station=52.5", "lines=coasts"].every((part) => hash.includes(part));
  check(`${backend}: the link holds the view, the satellite, the station and the lines`, isWhole, hash.slice(0, 120));
  await tab.screenshot({ path: path.join(out, `${backend}-page.png`) });
  await loses(backend, tab);
  const left = await tab.evaluate(async () => {
    const element = document.querySelector("terrella-earth");
    element.remove();
    return element.earth;
  });
  check(`${backend}: an element that is removed gives its Earth back`, left === null);
  check(`${backend}: the viewer's console is free of errors`, said.length === 0, said.slice(0, 3).join(" | "));
  await browser.close();
}

/** Scenes in the viewer: of the address, of the list, and of a file. */
async function viewedScenes(backend) {
  const { browser, tab, said, outcome } = await open(backend, "/#scene=stations&lat=-25&rate=1", true);
  check(`${backend}: the viewer with a scene is ready`, !outcome.error, outcome.error);
  const earth = (read) => tab.evaluate(`(({ earth }) => ${read})(document.querySelector("terrella-earth"))`);
  await tab.waitForFunction(() => document.querySelector("terrella-earth").earth.stations.length === 3);
  await tab.waitForFunction(() => document.querySelector("terrella-earth").earth.rate === 1);
  const view = await earth("earth.view");
  check(`${backend}: a link with a scene has its camera, but for what the link says`, Math.abs(view.lat + 25) < 1e-9 && Math.abs(view.altitude - 8e6) < 1, JSON.stringify(view));
  const boxes = await tab.locator("#lines input:checked").count();
  check(`${backend}: boxes of lines are those of the scene`, boxes === 3, boxes);
  await tab.locator("#share").click();
  const hash = await tab.evaluate(() => location.hash);
  check(`${backend}: the link holds the scene`, hash.includes("scene=stations"), hash);
  await tab.locator("#scene").selectOption("night_europe");
  await tab.waitForFunction(() => document.querySelector("terrella-earth").earth.look === "full");
  await tab.waitForFunction(() => document.querySelector("#notice").textContent.includes("Not in a page"));
  const chosen = { view: await earth("earth.view"), stations: await earth("earth.stations.length"), notice: await tab.locator("#notice").textContent() };
  check(`${backend}: a scene of the list is shown`, chosen.view.lat === 40 && chosen.stations === 0 && chosen.notice.includes("earth.night_gain"), JSON.stringify(chosen));
  await tab.waitForTimeout(1500);
  await shoot(tab, `${backend}-viewer-scene`);
  const drop = (text) => tab.locator("#file").setInputFiles({ name: "a.toml", mimeType: "text/plain", buffer: Buffer.from(text) });
  await drop('[camera]\nmode = "nadir"\n[orbit]\nfile = "orbits/molniya.tle"\nname = "MOLNIYA 1-53"\n');
  await tab.waitForFunction(() => document.querySelector("terrella-earth").earth.follow === "nadir");
  const ridden = await earth("earth.satellites.join()");
  check(`${backend}: a scene of a file finds orbits beside the list's`, ridden === "MOLNIYA 1-53", ridden);
  await drop("camera.fov_deg = 400");
  await tab.waitForFunction(() => document.querySelector("#notice").textContent.includes("camera.fov_deg"));
  check(`${backend}: a faulty scene is explained`, true);
  check(`${backend}: the console is free of errors with scenes`, said.length === 0, said.slice(0, 3).join(" | "));
  await browser.close();
}

/** The viewer's station, passes, time line and lines. */
async function instrumented(backend, tab) {
  const station = async (text) => {
    await tab.locator("#station").fill(text);
    await tab.locator("#station").press("Enter");
    return tab.locator("#notice").textContent();
  };
  const said = await station("somewhere");
  check(`${backend}: a station that is none is explained`, said.includes("latitude and longitude"), said);
  await station("52.5, 13.4");
  const shadows = await tab.locator("#bands .shadow").count();
  const passes = tab.locator("#passes button");
  const listed = await passes.allTextContents();
  check(`${backend}: the time line has shadows, and the station passes`, shadows >= 15 && listed.length > 0, `${shadows} shadows; ${listed.join(", ")}`);
  await passes.first().click();
  const shown = await tab.evaluate(() => document.querySelector("terrella-earth").epoch.toISOString());
  const [begin, end] = listed[0]?.slice(0, 11).split("–") ?? [];
  check(`${backend}: a pass is shown at its highest`, shown.slice(11, 16) >= begin && shown.slice(11, 16) <= end, `${shown} in ${listed[0]}`);
  await tab.locator('#lines input[value="coasts"]').check();
  await tab.waitForTimeout(1500);
  const lines = await tab.evaluate(() => document.querySelector("terrella-earth").earth.lines.join());
  check(`${backend}: lines are switched on`, lines === "coasts", lines);
}

/** A lost device is reported, and the element starts again with the same view. */
async function loses(backend, tab) {
  const found = await tab.evaluate(async () => {
    const element = document.querySelector("terrella-earth");
    const before = [element.earth.view.altitude, element.earth.satellites.join()];
    const next = (type) => new Promise((resolve) => element.addEventListener(type, (event) => resolve(event.detail ?? type), { once: true }));
    const [lost, ready] = [next("devicelost"), next("ready")];
    if (element.earth.backend === "webgpu") window.loseWebGpu();
    else element.shadowRoot.querySelector("canvas").getContext("webgl2").getExtension("WEBGL_lose_context").loseContext();
    const why = await lost;
    await ready;
    await new Promise((resolve) => setTimeout(resolve, 500));
    return { why, before, after: [element.earth.view.altitude, element.earth.satellites.join()] };
  });
  check(`${backend}: a lost device is reported and opened again`, String(found.before) === String(found.after), `${found.why}; ${found.after}`);
}

/** Without a GPU the page says so. */
async function none() {
  const { browser, tab, outcome } = await open("none", "/test.html", false);
  const shown = await tab.evaluate(() => document.querySelector("terrella-earth").shadowRoot.querySelector("[role=alert]")?.textContent);
  check("none: the page says that there is no graphics", outcome.error?.includes("neither WebGPU nor WebGL2") && shown === outcome.error, shown ?? outcome.error);
  await browser.close();
}

fs.mkdirSync(out, { recursive: true });
const only = (process.env.ONLY ?? "webgpu,webgl,viewer,none").split(",");
const backends = ["webgpu", "webgl"].filter((backend) => only.includes(backend));
for (const backend of backends) await pictures(backend);
if (only.includes("viewer")) {
  for (const backend of backends.length ? backends : ["webgpu"]) {
    await viewer(backend);
    await viewedScenes(backend);
  }
}
if (only.includes("none")) await none();
end();
