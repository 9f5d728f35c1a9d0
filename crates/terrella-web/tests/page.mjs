// What the tests in a browser share: checks, a server of folders, and pages in headless Chromium. Run in a folder that has playwright-core.

import fs from "node:fs";
import http from "node:http";
import path from "node:path";
import { createRequire } from "node:module";

const { chromium } = createRequire(`${process.cwd()}/`)("playwright-core");

const SIZE = { width: 640, height: 360 };
const PATIENCE_MS = 240_000;
/** Nothing but the page is loaded. */
const QUIET = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];
/** Vulkan in software for the page, WebGL and WebGPU alike: without it, this browser shows no canvas of a software WebGPU device. */
const VULKAN = ["--enable-features=Vulkan", "--use-vulkan=swiftshader", "--use-angle=swiftshader"];
const KINDS = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".json": "application/json",
  ".svg": "image/svg+xml",
  ".jpg": "image/jpeg",
  ".png": "image/png",
  ".wasm": "application/wasm",
};

let failures = 0;

/** Prints a line, and remembers a failure. */
export function check(what, isGood, numbers = "") {
  failures += isGood ? 0 : 1;
  console.log(`${isGood ? "ok  " : "FAIL"} ${what}${numbers ? `: ${numbers}` : ""}`);
  return isGood;
}

/** Ends the program: with 1 if a check failed. */
export function end() {
  console.log(failures === 0 ? "all passed" : `${failures} failed`);
  process.exit(failures === 0 ? 0 : 1);
}

/** Serves folders of this machine by the beginnings of their addresses, the longest first. */
export async function serve(folders) {
  const starts = Object.keys(folders).sort((a, b) => b.length - a.length);
  const server = http.createServer((request, response) => {
    const { pathname } = new URL(request.url, "http://localhost");
    const name = decodeURIComponent(pathname.endsWith("/") ? `${pathname}index.html` : pathname);
    const start = starts.find((start) => name.startsWith(start));
    const file = start && path.join(folders[start], name.slice(start.length));
    const isInside = file?.startsWith(path.join(folders[start], "/"));
    if (!isInside || !fs.statSync(file, { throwIfNoEntry: false })?.isFile()) {
      response.writeHead(404).end("not found");
      return;
    }
    response.writeHead(200, { "content-type": KINDS[path.extname(file)] ?? "application/octet-stream", "content-length": fs.statSync(file).size });
    fs.createReadStream(file).pipe(response);
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  return { address: `http://127.0.0.1:${server.address().port}`, close: () => server.closeAllConnections() ?? server.close() };
}

/** Starts a browser with more flags. */
export const launchWith = (flags) => chromium.launch({ executablePath: process.env.CHROMIUM, args: [...QUIET, ...flags] });

/** Starts a browser that shows this backend's canvas. */
export const launch = (backend) => launchWith(backend === "webgpu" ? [...VULKAN, "--enable-unsafe-webgpu"] : VULKAN);

/** Opens a page with one `<terrella-earth>` and waits for its first picture. `said` has all complaints; `outcome.error` is why there is no picture. */
export async function open(browser, url) {
  const context = await browser.newContext({ viewport: SIZE, deviceScaleFactor: 1 });
  const tab = await context.newPage();
  tab.setDefaultTimeout(PATIENCE_MS);
  const said = [];
  tab.on("console", (message) => message.type() === "error" && said.push(message.text()));
  tab.on("pageerror", (error) => said.push(error.message));
  tab.on("requestfailed", (request) => said.push(`${request.url()}: ${request.failure()?.errorText}`));
  tab.on("response", (response) => response.status() >= 400 && said.push(`${response.url()} answered ${response.status()}`));
  // Nothing may come from elsewhere.
  tab.on("request", (request) => {
    const isOwn = request.url().startsWith(new URL(url).origin) || /^(data|blob):/.test(request.url());
    if (!isOwn) said.push(`the page asks for ${request.url()}`);
  });
  await tab.addInitScript(() => {
    window.outcome = new Promise((resolve) => {
      const isOwn = (event) => event.target.localName === "terrella-earth";
      document.addEventListener("ready", (event) => isOwn(event) && resolve({ ready: performance.now() }), true);
      document.addEventListener("error", (event) => isOwn(event) && resolve({ error: event.detail.message }), true);
    });
  });
  let timer;
  // A module that does not even parse sends no event of ours.
  const broken = new Promise((resolve) => {
    tab.on("pageerror", (error) => resolve({ error: error.message }));
    timer = setTimeout(() => resolve({ error: `nothing came in ${PATIENCE_MS} ms` }), PATIENCE_MS);
  });
  try {
    await tab.goto(url);
    return { tab, said, outcome: await Promise.race([tab.evaluate(() => window.outcome), broken]) };
  } finally {
    clearTimeout(timer);
  }
}

/** A screenshot of a page once no shader is left to be compiled: its file, and its pixels as an `ImageData`'s. */
export async function picture(tab) {
  await tab.evaluate(async () => {
    const earth = document.querySelector("terrella-earth")?.earth;
    while (earth?.compiling) await new Promise((resolve) => setTimeout(resolve, 50));
    earth?.draw();
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
  });
  const file = await tab.screenshot();
  const numbers = await tab.evaluate(async (text) => {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }), { colorSpaceConversion: "none" });
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    let binary = "";
    for (let i = 0; i < data.length; i += 0x8000) binary += String.fromCharCode(...data.subarray(i, i + 0x8000));
    return [bitmap.width, bitmap.height, btoa(binary)];
  }, file.toString("base64"));
  return { file, width: numbers[0], height: numbers[1], data: Buffer.from(numbers[2], "base64") };
}
