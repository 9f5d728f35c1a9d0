// Bundles a page with each bundler and opens it in headless Chromium:
//   node bundlers.mjs DIST WORK_FOLDER
// in a folder that has playwright-core, the bundlers and typescript. DIST is the folder that `cargo xtask web` wrote. The package is packed and installed
// as npm does it, and each bundle is made by the commands of docs/web.md. Prints a line for each check, and ends with 1 if one failed.

import { execFileSync, spawn } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import { check, end, launch, open, picture, serve } from "./page.mjs";

const [dist, work] = process.argv.slice(2).map((name) => path.resolve(name));
const tools = process.cwd();
const sources = new URL("bundlers/", import.meta.url).pathname;
const page = new URL("../../../docs/web.md", import.meta.url).pathname;

const PATIENCE_MS = 240_000;
/** The parts of a picture in which an Earth by day and black space are brighter and darker than these, of 255. */
const BRIGHT = 60;
const DARK = 8;
const LEAST_PART = 0.1;
/** Options of TypeScript for programs that a bundler reads, and for those that Node reads. */
const RESOLUTIONS = [
  ["--module", "esnext", "--moduleResolution", "bundler"],
  ["--module", "nodenext"],
];
/** Makes an element whose files are not beside the bundle. */
const ELSEWHERE = `
const element = document.createElement("terrella-earth");
element.maps = "kept/maps/";
element.wasm = { webgpu: "kept/webgpu_bg.wasm", webgl: "kept/webgl_bg.wasm" };
element.epoch = "2026-06-01T12:00:00Z";
document.body.append(element);
`;

/** Runs a program in a folder; an error has what the program printed. */
function run(folder, program, ...words) {
  try {
    return execFileSync(program, words, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"], env: { ...process.env, PATH: `${tools}/node_modules/.bin:${process.env.PATH}` } });
  } catch (error) {
    throw new Error(`\`${[program, ...words].join(" ")}\` failed in ${folder}: ${error.stdout ?? ""}${error.stderr ?? error.message}`);
  }
}

/** Packs the package and returns the archive. */
function pack() {
  const [{ filename, files }] = JSON.parse(run(work, "npm", "pack", path.join(dist, "terrella"), "--json"));
  const own = new Set(files.map((file) => file.path));
  const meant = walk(path.join(dist, "terrella"));
  const missing = meant.filter((name) => !own.has(name));
  check("npm packs all files of the package", missing.length === 0, missing.join(", ") || `${own.size} files`);
  return path.join(work, filename);
}

/** The files below a folder. */
function walk(folder) {
  const entries = fs.readdirSync(folder, { recursive: true, withFileTypes: true });
  return entries.filter((entry) => entry.isFile()).map((entry) => path.relative(folder, path.join(entry.parentPath ?? entry.path, entry.name)));
}

/** A folder with the sources of a bundler's page and the installed package. */
function prepare(name, archive) {
  const folder = path.join(work, name);
  fs.rmSync(folder, { recursive: true, force: true });
  fs.cpSync(path.join(sources, name), folder, { recursive: true });
  install(folder, archive);
  return folder;
}

/** Installs the package in a folder. */
function install(folder, archive) {
  // Without this file npm would install into a folder above.
  fs.writeFileSync(path.join(folder, "package.json"), '{ "private": true }\n');
  run(folder, "npm", "install", "--offline", "--no-audit", "--no-fund", archive);
}

/** Snippets of the documentation are the files and commands that are tested here. */
function isShown(name) {
  const text = fs.readFileSync(page, "utf8");
  const absent = walk(path.join(sources, name)).filter((file) => !text.includes(fs.readFileSync(path.join(sources, name, file), "utf8").trim()));
  check(`${name}: docs/web.md shows what is tested`, absent.length === 0, absent.join(", "));
}

/** Opens a page on each backend and looks at its picture. */
async function look(name, url) {
  for (const [backend, browser] of Object.entries(browsers)) await lookWith(browser, backend, `${name}, ${backend}`, url);
}

async function lookWith(browser, backend, name, url) {
  const { tab, said, outcome } = await open(browser, url);
  try {
    if (!check(`${name}: ready`, !outcome.error, outcome.error ?? `${Math.round(outcome.ready)} ms after navigation`)) return;
    const own = await tab.evaluate(() => document.querySelector("terrella-earth").earth.backend);
    check(`${name}: on this backend`, own === backend, own);
    const whole = await tab.evaluate(() => document.querySelector("terrella-earth").earth.complete.then(() => "", (error) => error.message));
    check(`${name}: the whole maps are drawn`, whole === "", whole);
    await tab.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    const shown = await picture(tab);
    fs.writeFileSync(path.join(work, `${name}.png`), shown.file);
    let [bright, dark] = [0, 0];
    for (let i = 0; i < shown.data.length; i += 4) {
      const most = Math.max(shown.data[i], shown.data[i + 1], shown.data[i + 2]);
      bright += most > BRIGHT;
      dark += most < DARK;
    }
    const parts = [bright, dark].map((pixels) => (4 * pixels) / shown.data.length);
    check(`${name}: an Earth before black space`, parts.every((part) => part > LEAST_PART), parts.map((part) => `${(100 * part).toFixed(1)} %`).join(" and "));
  } finally {
    check(`${name}: no complaint`, said.length === 0, said.slice(0, 4).join(" | "));
    await tab.context().close();
  }
}

/** Runs Vite's own server while `use` looks at it. */
async function withViteServer(folder, use) {
  const vite = spawn(path.join(tools, "node_modules/.bin/vite"), ["--host", "127.0.0.1", "--port", "0", "--clearScreen", "false"], { cwd: folder, stdio: ["ignore", "pipe", "pipe"] });
  try {
    let text = "";
    const address = await new Promise((resolve, reject) => {
      const hear = (part) => {
        text += String(part).replace(/\x1b\[[0-9;]*m/g, "");
        const found = text.match(/http:\/\/127\.0\.0\.1:\d+\//);
        if (found) resolve(found[0]);
      };
      vite.stdout.on("data", hear);
      vite.stderr.on("data", hear);
      vite.on("exit", () => reject(new Error(`vite ended: ${text}`)));
      setTimeout(() => reject(new Error(`vite said no address in ${PATIENCE_MS} ms: ${text}`)), PATIENCE_MS).unref();
    });
    await use(address);
  } finally {
    vite.kill();
  }
}

async function bundle(name, archive) {
  isShown(name);
  const folder = prepare(name, archive);
  const started = performance.now();
  run(folder, "sh", "-e", "build.sh");
  const out = path.join(folder, "dist");
  const bytes = walk(out).reduce((sum, file) => sum + fs.statSync(path.join(out, file)).size, 0);
  console.log(`     ${name} ${version(name)}: ${Math.round(performance.now() - started)} ms, ${walk(out).length} files, ${(bytes / 1e6).toFixed(1)} MB`);
  const server = await serve({ "/": out });
  await look(name, `${server.address}/`);
  if (name === "esbuild") {
    keepElsewhere(folder);
    await look("esbuild with files elsewhere", `${server.address}/`);
  }
  server.close();
  if (name === "vite") await withViteServer(folder, (address) => look("vite's own server", address));
}

/** Moves maps and wasm away from the bundle, and has the page pass their addresses. */
function keepElsewhere(folder) {
  const out = path.join(folder, "dist");
  const kept = path.join(out, "kept");
  fs.mkdirSync(kept);
  for (const name of ["maps", "webgpu_bg.wasm", "webgl_bg.wasm"]) fs.renameSync(path.join(out, name), path.join(kept, name));
  const page = path.join(out, "index.html");
  fs.writeFileSync(page, fs.readFileSync(page, "utf8").replace(/<terrella-earth.*/, ""));
  fs.appendFileSync(path.join(folder, "main.js"), ELSEWHERE);
  run(folder, "sh", "-e", "build.sh");
  for (const name of ["maps", "webgpu_bg.wasm", "webgl_bg.wasm"]) fs.rmSync(path.join(out, name), { recursive: true });
}

const version = (name) => JSON.parse(fs.readFileSync(path.join(tools, "node_modules", name, "package.json"), "utf8")).version;

function types(archive) {
  const folder = path.join(work, "types");
  fs.rmSync(folder, { recursive: true, force: true });
  fs.mkdirSync(folder);
  fs.copyFileSync(path.join(sources, "types.ts"), path.join(folder, "types.ts"));
  install(folder, archive);
  for (const resolution of RESOLUTIONS) {
    let fault = "";
    try {
      run(folder, "tsc", "--noEmit", "--strict", "--target", "es2022", "--lib", "es2022,dom", ...resolution, "types.ts");
    } catch (error) {
      fault = error.message;
    }
    check(`types: ${resolution.join(" ")}`, fault === "", fault || `typescript ${version("typescript")}`);
  }
}

fs.rmSync(work, { recursive: true, force: true });
fs.mkdirSync(work, { recursive: true });
const archive = pack();
types(archive);
const browsers = { webgpu: await launch("webgpu"), webgl: await launch("webgl") };
try {
  for (const name of ["vite", "webpack", "esbuild"]) {
    await bundle(name, archive).catch((error) => check(`${name}: bundled`, false, error.message));
  }
} finally {
  for (const browser of Object.values(browsers)) await browser.close();
}
end();
