// Opens the examples in headless Chromium and measures how the picture of the other library fits that of the Earth:
//   node examples.mjs DIST OUT_FOLDER
// in a folder that has playwright-core, three and cesium. DIST is the folder that `cargo xtask web` wrote. The mark that the other library draws at a known
// place is found in a screenshot. It must be where the Earth picks that place, and where the Earth draws a satellite at that place.

import fs from "node:fs";
import path from "node:path";
import { check, end, launch, open, picture, serve } from "./page.mjs";
import { itrf } from "../examples/geodesy.js";

const [dist, out] = process.argv.slice(2).map((name) => path.resolve(name));
const modules = path.join(process.cwd(), "node_modules");
const examples = new URL("../examples/", import.meta.url).pathname;

/** How far the mark may be from the place, pixels: it is a square of whole ones. */
const MOST_PX = 1;
/** Channels of the mark's colour, of 255. */
const isMark = (r, g, b) => r > 200 && g < 80 && b > 200;
const LEAST_MARK_PX = 30;
/** The part of the picture that is brighter than this, of 255, at least. */
const BRIGHT = 60;
const LEAST_PART = 0.1;
const FRAMES = 12;
/** Views of the mark: the eye, the place it looks at, its upward axis (north, or so many degrees from it), and the vertical field of view. */
const POSES = [
  { name: "globe", eye: [25, -15, 9_000_000], at: [30, -12, 0], fov: 40 },
  { name: "wide", eye: [10, 20, 6_000_000], at: [20, 8, 0], fov: 70 },
  { name: "oblique", eye: [31, -9, 700_000], at: [36.8, -4, 0], fov: 50 },
  { name: "near", eye: [35.98, -5.6, 40_000], at: [36.02, -5.65, 0], fov: 35 },
  { name: "rolled", eye: [30, -20, 3_000_000], at: [34, -2, 0], fov: 45, roll: 50 },
];
const BEHIND = { name: "behind", eye: [-30, 170, 9_000_000], at: [-25, 172, 0], fov: 40 };

const minus = (a, b) => a.map((x, i) => x - b[i]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((x) => x / Math.hypot(...a));

/** The eye, the place and the upward axis of a pose in ITRF. Without roll the upward axis is the vertical of the eye, or north if that is too near the direction. */
function placed({ eye, at, fov, roll }) {
  const [position, target] = [itrf(...eye), itrf(...at)];
  const direction = unit(minus(target, position));
  const vertical = unit(minus(itrf(eye[0], eye[1], 1000), itrf(eye[0], eye[1], 0)));
  const right = unit(cross(direction, vertical));
  const level = cross(right, direction);
  const turn = ((roll ?? 0) * Math.PI) / 180;
  const up = level.map((x, i) => Math.cos(turn) * x + Math.sin(turn) * right[i]);
  return { position, target, direction, up, fov };
}

/** Runs in the page: the camera of the three.js example. */
async function poseThree({ position, target, up, fov }) {
  const { camera, controls } = await import("/three.js");
  controls.minDistance = 0;
  camera.position.set(...position);
  camera.up.set(...up);
  camera.fov = fov;
  controls.target.set(...target);
}

/** Runs in the page: the camera of the CesiumJS example. Its field of view is that of the longer side. */
async function poseCesium({ position, direction, up, fov }) {
  const { widget } = await import("/cesium.js");
  const { Cartesian3 } = window.Cesium;
  const { camera, canvas } = widget;
  camera.setView({ destination: Cartesian3.fromArray(position), orientation: { direction: Cartesian3.fromArray(direction), up: Cartesian3.fromArray(up) } });
  const longer = Math.max(1, canvas.clientWidth / canvas.clientHeight);
  camera.frustum.fov = 2 * Math.atan(Math.tan((fov * Math.PI) / 360) * longer);
}

/** Runs in the page: waits for so many animation frames. Returns how many frames the Earth drew meanwhile. */
function frames(count) {
  return new Promise((resolve) => {
    const { earth } = document.querySelector("terrella-earth");
    let drawn = 0;
    const heard = () => drawn++;
    earth.addEventListener("frame", heard);
    const tick = () => {
      if (count-- > 0) return requestAnimationFrame(tick);
      earth.removeEventListener("frame", heard);
      resolve(drawn);
    };
    requestAnimationFrame(tick);
  });
}

/** Runs in the page: the pixel under which the Earth picks a place, by Newton's steps from another, and the degrees for a pixel to the right and down. */
function pixelOf({ lat, lon, from }) {
  const { earth } = document.querySelector("terrella-earth");
  let [x, y] = from;
  let jacobian;
  for (let step = 0; step < 20; step++) {
    const [here, right, below] = [earth.pick(x, y), earth.pick(x + 0.5, y), earth.pick(x, y + 0.5)];
    if (!here || !right || !below) return null;
    const [a, b, c, d] = [2 * (right.lat - here.lat), 2 * (below.lat - here.lat), 2 * (right.lon - here.lon), 2 * (below.lon - here.lon)];
    jacobian = [a, b, c, d];
    const [u, v, det] = [lat - here.lat, lon - here.lon, a * d - b * c];
    const by = [(d * u - b * v) / det, (a * v - c * u) / det];
    [x, y] = [x + by[0], y + by[1]];
    if (Math.hypot(...by) < 1e-6) break;
  }
  return { at: [x, y], jacobian };
}

/** The middle of the mark in a picture, and its pixels. */
function findMark({ data, width }) {
  let [count, x, y] = [0, 0, 0];
  for (let i = 0; i < data.length; i += 4) {
    if (!isMark(data[i], data[i + 1], data[i + 2])) continue;
    count += 1;
    x += ((i / 4) % width) + 0.5;
    y += Math.floor(i / 4 / width) + 0.5;
  }
  return { count, at: [x / count, y / count] };
}

const bright = ({ data }) => data.filter((value, i) => i % 4 === 1 && value > BRIGHT).length / (data.length / 4);
const apart = (a, b) => (a && b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : Infinity);
const inPixels = (px) => `${px.toFixed(2)} px`;

/** A satellite that stays a metre above a place, as CZML. */
function still(lat, lon, epoch) {
  const place = itrf(lat, lon, 1);
  const samples = [0, 3600, 7200].flatMap((s) => [s, ...place]);
  const start = new Date(epoch - 3_600_000).toISOString();
  return JSON.stringify([{ id: "document", version: "1.0" }, { id: "mark", name: "mark", position: { epoch: start, referenceFrame: "FIXED", cartesian: samples } }]);
}

async function measure(tab, name, pose, setPose, mark) {
  await tab.evaluate(() => delete window.picked);
  await tab.evaluate(setPose, placed(pose));
  await tab.evaluate(frames, 4);
  const shown = await picture(tab);
  fs.writeFileSync(path.join(out, `${name}-${pose.name}.png`), shown.file);
  const found = findMark(shown);
  const label = `${name}, ${pose.name}`;
  if (pose === BEHIND) {
    check(`${label}: a mark behind the Earth is hidden`, found.count === 0, `${found.count} pixels`);
    return;
  }
  if (!check(`${label}: mark and Earth are there`, found.count >= LEAST_MARK_PX && bright(shown) > LEAST_PART, `${found.count} pixels, ${(100 * bright(shown)).toFixed(1)} % bright`)) return;
  const labels = await tab.evaluate(() => document.querySelector("terrella-earth").earth.labels.map(({ x, y }) => [x, y]));
  check(`${label}: the Earth draws a satellite on the mark`, apart(labels[0], found.at) <= MOST_PX, labels[0] ? inPixels(apart(labels[0], found.at)) : "it is not drawn");
  const picked = await tab.evaluate(pixelOf, { ...mark, from: found.at });
  check(`${label}: the Earth picks the place there`, apart(picked?.at, found.at) <= MOST_PX, picked ? inPixels(apart(picked.at, found.at)) : "no ground");
  if (!picked) return;
  const clicked = found.at.map(Math.round);
  await tab.evaluate(() => document.querySelector("terrella-earth").addEventListener("pick", (event) => (window.picked = event.detail), { once: true }));
  await tab.mouse.click(...clicked);
  await tab.waitForFunction(() => window.picked);
  const { lat, lon } = (await tab.evaluate(() => window.picked.place)) ?? { lat: NaN, lon: NaN };
  const [a, b, c, d] = picked.jacobian;
  const [u, v, det] = [lat - mark.lat, lon - mark.lon, a * d - b * c];
  const off = apart([found.at[0] + (d * u - b * v) / det, found.at[1] + (a * v - c * u) / det], clicked);
  check(`${label}: a click reports the place`, off <= MOST_PX, `${lat.toFixed(4)}°, ${lon.toFixed(4)}°, ${inPixels(off)}`);
}

async function example(browser, server, name, setPose) {
  const { tab, said, outcome } = await open(browser, `${server.address}/${name}.html`);
  if (check(`${name}: ready`, !outcome.error, outcome.error ?? `${Math.round(outcome.ready)} ms after navigation`)) {
    await tab.evaluate(() => document.querySelector("terrella-earth").earth.complete);
    const mark = await tab.evaluate(async (file) => (await import(file)).MARK, `/${name}.js`);
    const epoch = await tab.evaluate(() => Number(document.querySelector("terrella-earth").earth.epoch));
    await tab.evaluate((text) => document.querySelector("terrella-earth").earth.setSatellites(text), still(mark.lat, mark.lon, epoch));
    for (const pose of [...POSES, BEHIND]) await measure(tab, name, pose, setPose, mark);
    await tab.evaluate(() => (document.querySelector("terrella-earth").earth.rate = 10));
    const drawn = await tab.evaluate(frames, FRAMES);
    check(`${name}: each frame is drawn once`, Math.abs(drawn - FRAMES) <= 1, `${drawn} in ${FRAMES}`);
  }
  check(`${name}: no complaint`, said.length === 0, said.slice(0, 4).join(" | "));
  await tab.context().close();
}

/** The examples name the versions that are tested. */
const { dependencies } = JSON.parse(fs.readFileSync(path.join(examples, "package.json"), "utf8"));
for (const name of ["three", "cesium"]) {
  const { version } = JSON.parse(fs.readFileSync(path.join(modules, name, "package.json"), "utf8"));
  check(`${name} ${version} is what the examples name`, dependencies[name] === version, dependencies[name]);
}
fs.mkdirSync(out, { recursive: true });
const server = await serve({ "/": examples, "/node_modules/": modules, "/node_modules/terrella/": path.join(dist, "terrella") });
const browser = await launch("webgpu");
try {
  await example(browser, server, "three", poseThree);
  await example(browser, server, "cesium", poseCesium);
} finally {
  await browser.close();
  server.close();
}
end();
