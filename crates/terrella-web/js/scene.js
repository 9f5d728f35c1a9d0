// Scene files in a page: read by a wasm file of their own, which is loaded with the first scene.

import start, { PageScene } from "./scenes.js";
import { fileBytes, loaded, retried } from "./fetching.js";
import { SCENES } from "./files.js";

/** Limits of a scene and of a file of orbits, bytes, as natively. */
const SCENE_BYTES = 16 << 20;
const ORBIT_BYTES = 256 << 20;
/** Keys of a view over the ground, in the order of the reader. */
const VIEW = ["lat", "lon", "altitude", "heading", "pitch"];
const STATION = ["lat", "lon", "mask", "altitude"];

let started;

/** The reader, started once. */
function reader() {
  started ??= loaded("The reader of scenes", SCENES.wasm, async (response) => start({ module_or_path: await response.arrayBuffer() }));
  // The next scene tries again.
  started.catch(() => {
    started = undefined;
  });
  return started;
}

async function fetchedText(what, address, limit) {
  return new TextDecoder().decode(await retried(undefined, () => fileBytes(what, address, limit)));
}

/** The text of a scene. */
export const sceneText = (address) => fetchedText("The scene", address, SCENE_BYTES);

/** Pairs of a flat list. */
const pairs = (list) => Array.from({ length: list.length / 2 }, (_, i) => [list[2 * i], list[2 * i + 1]]);

/** What a scene's text says. Addresses of files are relative to `base`. */
async function readScene(text, base) {
  await reader();
  const scene = PageScene.read(text);
  try {
    const numbers = scene.stationNumbers();
    const stations = scene.stationNames().map((name, i) => ({ name, ...Object.fromEntries(STATION.map((key, k) => [key, numbers[4 * i + k]])) }));
    const view = scene.view();
    const pack = scene.pack();
    return {
      start: scene.start(),
      rate: scene.rate() ?? 0,
      view: view && Object.fromEntries(VIEW.map((key, i) => [key, view[i]])),
      fov: scene.fov(),
      follow: scene.follow(),
      followed: scene.followed(),
      look: scene.look(),
      hide: scene.hidden(),
      lines: scene.lines(),
      tracks: scene.tracks(),
      exposure: scene.exposure() ?? "auto",
      stations,
      satellites: pairs(scene.satellites()),
      pack: pack === undefined ? null : new URL(pack, base).href,
      missing: scene.missing(),
    };
  } finally {
    scene.free();
  }
}

/**
 * Shows a scene on an Earth, unless `isWanted` says meanwhile that another is wanted. Returns the keys that a page does not have; undefined if it was
 * not wanted.
 */
export async function showScene(earth, text, base, isWanted) {
  const scene = await readScene(text, base);
  // All files are there before anything changes. One that several satellites are in is requested once.
  const files = [...new Set(scene.satellites.map(([file]) => file))];
  const texts = await Promise.all(files.map((file) => fetchedText("The file of orbits", new URL(file, base).href, ORBIT_BYTES)));
  if (!isWanted()) return undefined;
  const textOf = new Map(files.map((file, i) => [file, texts[i]]));
  scene.satellites.forEach(([file, name], i) => {
    if (i === 0) earth.setSatellites(textOf.get(file), name || undefined);
    else earth.addSatellites(textOf.get(file), name || undefined);
  });
  if (!scene.satellites.length) earth.setSatellites("");
  for (const key of ["hide", "look", "lines", "tracks", "stations", "exposure", "pack"]) earth[key] = scene[key];
  earth.epoch = scene.start ?? earth.elementsEpoch() ?? "now";
  earth.rate = scene.rate;
  earth.view = { ...scene.view, fov: scene.fov };
  if (scene.follow) {
    const index = scene.followed === undefined ? 0 : earth.satellites.indexOf(scene.followed);
    earth.ride(scene.follow, Math.max(index, 0));
  }
  // Nothing to ride on: the camera keeps its place.
  const isAlone = scene.follow && !earth.satellites.length;
  return isAlone ? [...scene.missing, "camera.mode without a file of orbits"] : scene.missing;
}
