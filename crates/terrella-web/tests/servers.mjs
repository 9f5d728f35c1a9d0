// Pages on servers that are slow, that fail, or that send something else, and many elements in one page, in headless Chromium:
//   node servers.mjs DIST OUT
// Run in a folder that has playwright-core. Prints a line for each check, and ends with 1 if one failed.

import fs from "node:fs";
import path from "node:path";
import { check, end, launch, serve } from "./page.mjs";

const [dist, out] = process.argv.slice(2);
const PATIENCE_MS = 120_000;
/** Elements made and removed, and those after which memory may no longer grow. */
const ELEMENTS = 50;
const WARM = 10;
/** Growth of memory between the two, as a fraction. */
const GROWTH = 0.1;
/** Time in which the graphics process returns memory. */
const SETTLE_MS = 4000;

const PAGE = `<!doctype html><title>t</title><script type="module" src="terrella/terrella.js"></script>`;
fs.mkdirSync(out, { recursive: true });
fs.writeFileSync(path.join(out, "empty.html"), PAGE);
const site = await serve({ "/terrella/": path.join(dist, "terrella"), "/": out });
const browser = await launch("webgpu");

/** A page without an element, whose requests `route` may answer. */
async function page(route) {
  const context = await browser.newContext({ viewport: { width: 320, height: 180 }, deviceScaleFactor: 1 });
  const tab = await context.newPage();
  tab.setDefaultTimeout(PATIENCE_MS);
  if (route) await tab.route("**/*", route);
  await tab.addInitScript(() => {
    // Memory of the program, and devices in use.
    window.memories = new Set();
    for (const name of ["instantiate", "instantiateStreaming"]) {
      const own = WebAssembly[name];
      WebAssembly[name] = async (...parts) => {
        const made = await own.apply(WebAssembly, parts);
        const { memory } = (made.instance ?? made).exports;
        if (memory) window.memories.add(memory);
        return made;
      };
    }
    window.devices = 0;
    const request = window.GPUAdapter?.prototype.requestDevice;
    if (request) {
      GPUAdapter.prototype.requestDevice = async function (...parts) {
        const device = await request.apply(this, parts);
        window.devices += 1;
        return device;
      };
      // The promise `lost` of a device that nobody holds any more may never settle.
      const destroy = GPUDevice.prototype.destroy;
      GPUDevice.prototype.destroy = function () {
        window.devices -= 1;
        return destroy.call(this);
      };
    }
    /** Adds an element; its outcome is an error, or the event that came, and what it says. */
    window.show = (until = "ready") =>
      new Promise((resolve) => {
        const element = document.createElement("terrella-earth");
        element.style.cssText = "display: block; width: 160px; height: 90px";
        const seen = [];
        const said = () => element.shadowRoot.querySelector("[role=alert]")?.textContent ?? "";
        element.addEventListener("progress", () => seen.push(element.shadowRoot.querySelector("[role=status]")?.textContent));
        element.addEventListener(until, () => resolve({ event: until, seen, said: said() }));
        element.addEventListener("error", ({ detail }) => resolve({ error: detail.message, said: said() }));
        document.body.append(element);
      });
  });
  await tab.goto(`${site.address}/empty.html`);
  await tab.evaluate(() => customElements.whenDefined("terrella-earth"));
  return tab;
}

/** Files whose address ends so. */
const ends = (route, name) => new URL(route.request().url()).pathname.endsWith(name);

/** One page whose server answers requests for a file in its own way: `answer` gets the route and the number of the request for that file. */
async function withServer(name, answer, until) {
  let requests = 0;
  const tab = await page((route) => (ends(route, name) ? answer(route, ++requests) : route.continue()));
  const begin = Date.now();
  const outcome = await tab.evaluate((until) => window.show(until), until);
  await tab.context().close();
  return { ...outcome, requests, ms: Date.now() - begin };
}

const busy = (route) => route.fulfill({ status: 503, body: "busy" });

{
  const { event, error, seen, requests } = await withServer("preview/day.jpg", async (route) => {
    await new Promise((resolve) => setTimeout(resolve, 3000));
    await route.continue();
  });
  const isTold = seen?.some((text) => /^Loading the Earth … \d+ %$/.test(text));
  check("a slow server: the page shows progress, then the Earth", event === "ready" && isTold && requests === 1, error ?? seen?.at(0));
}
{
  const { event, error, requests } = await withServer("preview/clouds.jpg", (route) => route.fulfill({ status: 404, body: "" }));
  check("a missing map of clouds: an Earth without clouds, and no second attempt", event === "ready" && requests === 1, error);
}
for (const [what, fail] of [
  ["an answer 503", busy],
  ["a lost connection", (route) => route.abort("connectionreset")],
]) {
  for (const name of ["preview/day.jpg", "webgpu_bg.wasm", "data/air.bin", "data/detail_tiles.jpg"]) {
    const { event, error, requests } = await withServer(name, (route, n) => (n <= 2 ? fail(route) : route.continue()));
    check(`${what} twice for ${name}: the third attempt succeeds`, event === "ready" && requests === 3, error);
  }
  const { error, said, requests } = await withServer("preview/day.jpg", fail);
  const isNamed = error?.includes("The map day.jpg could not be loaded") && error.includes("preview/day.jpg") && error.includes("Check the address");
  check(`${what} always: the message names the map and a remedy, on the page too`, isNamed && said === error && requests === 3, error);
}
for (const [what, name, body, expected] of [
  ["a page in place of a map", "preview/day.jpg", "<!doctype html>", "day.jpg"],
  ["a page in place of the tables", "data/air.bin", "<!doctype html>", "air.bin"],
  ["a page in place of the program", "webgpu_bg.wasm", "<!doctype html>", "webgpu_bg.wasm"],
]) {
  const { error, said } = await withServer(name, (route) => route.fulfill({ status: 200, contentType: name.endsWith("wasm") ? "application/wasm" : "text/html", body }));
  check(`${what}: the message names the file`, error?.includes(expected) && said === error, error ?? "no error came");
}
{
  const half = fs.readFileSync(path.join(dist, "terrella/maps/preview/day.jpg"));
  const { error } = await withServer("preview/day.jpg", (route) => route.fulfill({ status: 200, body: half.subarray(0, half.length >> 1) }));
  check("half a map: the message names the map", error?.includes("day.jpg"), error ?? "no error came");
}
{
  let isDown = true;
  const tab = await page((route) => (isDown && ends(route, "webgpu_bg.wasm") ? route.abort("failed") : route.continue()));
  const first = await tab.evaluate(() => window.show());
  isDown = false;
  const second = await tab.evaluate(() => window.show());
  check("after a failure, the next element in the page starts", first.error && second.event === "ready", second.error);
  await tab.context().close();
}
{
  let n = 0;
  const tab = await page((route) => (ends(route, "/maps/day.jpg") ? (n += 1, busy(route)) : route.continue()));
  const { error, said } = await tab.evaluate(() => window.show("complete"));
  const isDrawn = await tab.evaluate(() => document.querySelector("terrella-earth").earth?.adapter !== undefined);
  check("the whole map fails after the first picture: the Earth stays, and the page says it", error?.includes("/maps/day.jpg") && said === error && isDrawn && n === 3, error);
  await tab.context().close();
}

/** Megabytes that a process holds. */
const residentMb = (pid) => Number(/VmRSS:\s+(\d+)/.exec(fs.readFileSync(`/proc/${pid}/status`, "utf8"))[1]) / 1024;

{
  const tab = await page();
  const devtools = await tab.context().newCDPSession(tab);
  const system = await browser.newBrowserCDPSession();
  const { processInfo } = await system.send("SystemInfo.getProcessInfo");
  const gpu = processInfo.find(({ type }) => type === "GPU").id;
  const measured = [];
  for (let n = 1; n <= ELEMENTS; n++) {
    const { error } = await tab.evaluate(() => window.show());
    if (error) check(`element ${n}`, false, error);
    await tab.evaluate(() => document.querySelector("terrella-earth").remove());
    if (n !== WARM && n !== ELEMENTS) continue;
    await devtools.send("HeapProfiler.collectGarbage");
    await tab.waitForTimeout(SETTLE_MS);
    const { usedSize } = await devtools.send("Runtime.getHeapUsage");
    const inPage = await tab.evaluate(() => ({ devices: window.devices, wasm: [...window.memories].reduce((sum, memory) => sum + memory.buffer.byteLength, 0) / 2 ** 20 }));
    measured.push({ ...inPage, heap: usedSize / 2 ** 20, gpu: residentMb(gpu), workers: tab.workers().length });
  }
  const [warm, last] = measured;
  for (const what of ["wasm", "heap", "gpu"]) {
    const numbers = `${warm[what].toFixed(1)} MiB after ${WARM}, ${last[what].toFixed(1)} MiB after ${ELEMENTS}`;
    check(`${ELEMENTS} elements made and removed: memory of ${what} is flat`, last[what] <= warm[what] * (1 + GROWTH), numbers);
  }
  check(`${ELEMENTS} elements made and removed: no device and no worker is left`, last.devices === 0 && last.workers === 0, `${last.devices} devices, ${last.workers} workers`);
  await tab.context().close();
}

await browser.close();
site.close();
end();
