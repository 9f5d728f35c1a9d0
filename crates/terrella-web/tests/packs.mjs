// Imagery packs on a static server, in headless Chromium:
//   node packs.mjs DIST OUT PACK NATIVE VIEW
// PACK is a pack's folder, NATIVE has pictures of the view from each of its storages, VIEW the attributes of the view. Run in a folder that has
// playwright-core. Prints a line for each check, and ends with 1 if one failed.

import fs from "node:fs";
import path from "node:path";
import { check, end, launch, picture, serve } from "./page.mjs";

const [dist, out, pack, natives, view] = process.argv.slice(2);
/** How far a channel's mean and each channel of a pixel may be from the native picture's, of 255: both are drawn on one device. */
const MEAN = 0.01;
const GREATEST = 1;
const PATIENCE_MS = 60_000;
const SIZE = { width: 640, height: 360 };

fs.mkdirSync(out, { recursive: true });
const site = await serve({ "/terrella/": path.join(dist, "terrella"), "/pack/": pack, "/": out });
const attributes = (more) => Object.entries({ ...JSON.parse(view), ...more }).map(([name, value]) => `${name}="${value}"`).join(" ");
const html = (more) => `<!doctype html><title>t</title><link rel="icon" href="data:,">
<style>body { margin: 0 } terrella-earth { width: 640px; height: 360px }</style>
<script type="module" src="terrella/terrella.js"></script><terrella-earth ${attributes(more)}></terrella-earth>`;
const tiles = (url) => new URL(url).pathname.startsWith("/pack/tiles/");

/** Folders of the coarsest levels. */
const coarsest = fs
  .readFileSync(path.join(pack, "pack.toml"), "utf8")
  .split("[[layer]]")
  .slice(1)
  .map((layer) => `/${/name = "(\w+)"/.exec(layer)[1]}/${[...layer.matchAll(/^pixels = (\d+)/gm)].at(-1)[1]}/`);

/** Opens a page whose requests `route` may answer. `requests` has the addresses of all. */
async function open(browser, more, { route = (one) => one.continue(), hasBc = true } = {}) {
  fs.writeFileSync(path.join(out, "page.html"), html(more));
  const context = await browser.newContext({ viewport: SIZE, deviceScaleFactor: 1 });
  const tab = await context.newPage();
  tab.setDefaultTimeout(PATIENCE_MS);
  const requests = [];
  await tab.route("**/*", (one) => {
    requests.push(one.request().url());
    return route(one);
  });
  await tab.addInitScript(({ patience, hasBc }) => {
    const features = window.GPUAdapter && Object.getOwnPropertyDescriptor(GPUAdapter.prototype, "features").get;
    if (features && !hasBc) {
      const without = function () {
        return new Set([...features.call(this)].filter((name) => name !== "texture-compression-bc"));
      };
      Object.defineProperty(GPUAdapter.prototype, "features", { get: without });
    }
    window.said = [];
    for (const type of ["ready", "complete", "pack", "tiles", "error"]) {
      document.addEventListener(type, ({ target, detail }) => target.localName === "terrella-earth" && window.said.push({ type, detail: detail?.message ?? detail }), true);
    }
    /** Waits for an event that is as it should be. */
    window.heard = async (type, words) => {
      for (let waited = 0; waited < patience; waited += 50) {
        const found = window.said.find((one) => one.type === type && (words === undefined ? true : words === null ? one.detail === null : one.detail?.includes?.(words)));
        if (found) return found.detail;
        await new Promise((resolve) => setTimeout(resolve, 50));
      }
      return `nothing came; ${JSON.stringify(window.said)}`;
    };
    window.sharp = async () => {
      const element = document.querySelector("terrella-earth");
      const pause = () => new Promise((resolve) => setTimeout(resolve, 50));
      for (let waited = 0; waited < patience && !element.earth?.isSharp; waited += 50) await pause();
      // Until the frame is on the screen.
      for (let n = 0; n < 3; n++) await new Promise((resolve) => requestAnimationFrame(resolve));
    };
  }, { patience: PATIENCE_MS, hasBc });
  await tab.goto(`${site.address}/page.html`);
  return { tab, requests };
}

const decoded = async (tab, file) => {
  const page = await tab.context().newPage();
  await page.setViewportSize(SIZE);
  await page.setContent(`<style>body { margin: 0 }</style><img src="data:image/png;base64,${fs.readFileSync(file).toString("base64")}">`);
  await page.waitForFunction(() => document.images[0].complete);
  const shown = await picture(page);
  await page.close();
  return shown;
};

function differences(a, b) {
  let [sum, greatest] = [0, 0];
  for (let i = 0; i < a.data.length; i += 4) {
    for (let c = 0; c < 3; c++) {
      const difference = Math.abs(a.data[i + c] - b.data[i + c]);
      sum += difference;
      greatest = Math.max(greatest, difference);
    }
  }
  return { mean: (4 * sum) / 3 / a.data.length, greatest };
}

/** Pixels that are black. */
const holes = ({ data }) => data.reduce((count, value, i) => count + (i % 4 === 0 && value + data[i + 1] + data[i + 2] === 0), 0);

for (const [backend, storage] of [["webgpu", "bc"], ["webgpu", "plain"], ["webgl", "bc"]]) {
  const browser = await launch(backend);
  const hasBc = storage === "bc";
  const native = path.join(natives, `${storage}.png`);
  const name = (what) => `${backend}, ${storage}: ${what}`;
  {
    const { tab, requests } = await open(browser, { backend }, { hasBc });
    await tab.evaluate(() => window.heard("complete"));
    const packs = requests.filter((url) => /packs|worker-pack|pack.toml/.test(url));
    check(name("a page without a pack loads nothing of packs"), packs.length === 0, packs.join(" "));
    const own = await picture(tab);
    await tab.evaluate(() => (document.querySelector("terrella-earth").pack = "pack"));
    const about = await tab.evaluate(() => window.heard("pack"));
    check(name("a pack opens by its property, with name and attribution"), about?.name === "pattern" && about.attribution.includes("Nobody"), JSON.stringify(about));
    await tab.evaluate(() => window.sharp());
    const shown = await picture(tab);
    fs.writeFileSync(path.join(out, `${backend}-${storage}.png`), shown.file);
    const { mean, greatest } = differences(shown, await decoded(tab, native));
    check(name("the picture is the native one"), mean <= MEAN && greatest <= GREATEST, `mean ${mean.toFixed(4)}, greatest ${greatest}`);
    const streamed = requests.filter((url) => tiles(url));
    check(name("each tile is requested once"), new Set(streamed).size === streamed.length, `${streamed.length} requests`);
    check(name("the tiles are those that the device reads"), streamed.every((url) => url.includes(`/tiles/${storage}/`)));
    await tab.evaluate(() => (document.querySelector("terrella-earth").pack = ""));
    await tab.evaluate(() => window.heard("pack", null));
    await tab.waitForTimeout(500);
    const back = differences(await picture(tab), own);
    check(name("without the pack the page's own maps are drawn again"), back.mean === 0, `mean ${back.mean.toFixed(3)}`);
    check(name("its worker has ended"), tab.workers().length === 0, `${tab.workers().length} workers`);
    await tab.context().close();
  }
  {
    let isDown = true;
    // The coarsest level of each map comes, the tiles of the others do not.
    const isFine = (url) => tiles(url) && !coarsest.some((folder) => url.includes(folder));
    const { tab, requests } = await open(browser, { backend, pack: "pack" }, { hasBc, route: (one) => (isDown && isFine(one.request().url()) ? one.abort("connectionreset") : one.continue()) });
    await tab.evaluate(() => window.heard("tiles", "/pack/tiles/"));
    const shown = await picture(tab);
    fs.writeFileSync(path.join(out, `${backend}-${storage}-lost.png`), shown.file);
    const note = await tab.evaluate(() => document.querySelector("terrella-earth").shadowRoot.querySelector(".note").textContent);
    check(name("a lost connection: the page says so and has no hole"), note.includes("Check the address and the connection") && holes(shown) === 0, note);
    isDown = false;
    await tab.evaluate(() => window.sharp());
    await tab.evaluate(() => window.heard("tiles", null));
    const isSharp = await tab.evaluate(() => document.querySelector("terrella-earth").earth.isSharp);
    const { mean } = differences(await picture(tab), await decoded(tab, native));
    check(name("once it is back, the tiles come"), isSharp && mean <= MEAN, `mean ${mean.toFixed(3)}, ${requests.filter(isFine).length} requests`);
    await tab.context().close();
  }
  await browser.close();
}

const browser = await launch("webgpu");
for (const [what, ends, body, words] of [
  ["no pack at the address", "pack.toml", { status: 404, body: "" }, ["pack.toml answered 404", "Check the address"]],
  ["a page in place of the manifest", "pack.toml", { status: 200, body: "<!doctype html>" }, ["pack.toml:1:"]],
  ["an unknown version", "pack.toml", { status: 200, body: "format = 99\n" }, ["pack.toml:1:", "format"]],
]) {
  const { tab } = await open(browser, { pack: "pack" }, { route: (one) => (new URL(one.request().url()).pathname.endsWith(ends) ? one.fulfill(body) : one.continue()) });
  const message = await tab.evaluate(() => window.heard("error"));
  const isDrawn = await tab.evaluate(() => document.querySelector("terrella-earth").earth?.adapter !== undefined);
  check(`${what}: the message names place and remedy, and the Earth stays`, words.every((word) => message.includes(word)) && isDrawn, message);
  check(`${what}: the worker has ended`, tab.workers().length === 0);
  await tab.context().close();
}
{
  const lie = { status: 200, body: Buffer.alloc(100, 7) };
  const { tab } = await open(browser, { pack: "pack" }, { route: (one) => (/\/256\//.test(one.request().url()) ? one.fulfill(lie) : one.continue()) });
  const message = await tab.evaluate(() => window.heard("tiles", ".ktx2"));
  check("tiles that lie: the message names file and remedy, coarser ones are drawn", message.includes("terrella pack verify") && holes(await picture(tab)) === 0, message);
  await tab.evaluate(() => document.querySelector("terrella-earth").remove());
  await tab.waitForTimeout(500);
  check("a removed element leaves no worker", tab.workers().length === 0, `${tab.workers().length}`);
  await tab.context().close();
}
{
  const { tab } = await open(browser, { pack: "pack" });
  await tab.evaluate(() => window.heard("pack"));
  await tab.evaluate(() => (document.querySelector("terrella-earth").pack = "nowhere"));
  const message = await tab.evaluate(() => window.heard("error"));
  // A place that needs other tiles.
  await tab.evaluate(() => (document.querySelector("terrella-earth").lon = 60));
  await tab.evaluate(() => window.sharp());
  const { address, isSharp } = await tab.evaluate(() => {
    const { pack, earth } = document.querySelector("terrella-earth");
    return { address: pack, isSharp: earth.isSharp };
  });
  const stays = message.includes("nowhere/pack.toml answered 404") && address.endsWith("/pack/") && isSharp && tab.workers().length === 1;
  check("another pack that is not there: the message names it, and the first stays and streams", stays, `${message} ${address} ${isSharp}`);
  await tab.context().close();
}
await browser.close();
site.close();
end();
