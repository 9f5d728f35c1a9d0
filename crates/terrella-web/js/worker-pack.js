// The worker of a pack: fetches its files, checks and decodes them.

import start, { PackReader } from "./packs.js";
import { fileBytes, retried } from "./fetching.js";

/** Limit of a manifest, bytes, as natively. */
const MANIFEST_BYTES = 32 << 20;
/** Requests at once for the first maps. */
const AT_ONCE = 6;
/** Blocks of a map. */
const BLOCKS = 128;

let reader;
/** Ends loads of tiles, by their numbers. */
const aborts = new Map();

async function open({ address, wasm, hasBc }) {
  await start({ module_or_path: wasm });
  const manifest = new URL("pack.toml", address);
  const bytes = await retried(undefined, () => fileBytes("The pack", manifest, MANIFEST_BYTES));
  reader = PackReader.open(bytes, address.replace(/\/$/, ""), hasBc);
  postMessage({ opened: { name: reader.name(), attribution: reader.attribution(), layout: reader.layout(), slopeFactor: reader.slopeFactor() } });
}

/** The bytes of a tile's file. */
function tileBytes(key, signal) {
  const address = reader.file(...key);
  return fileBytes("The tile", address, reader.fileBytes(...key), signal);
}

/** Adds a block to a map: from its coarsest tile, or from a finer one if that is damaged. Returns the first error. */
async function addBlock(map, levels, block) {
  let first;
  for (const level of levels) {
    const key = [map, level, block, 0];
    if (!reader.fileBytes(...key)) continue;
    const bytes = await retried(undefined, () => tileBytes(key));
    try {
      reader.addBlock(level, block, bytes);
      return first;
    } catch (error) {
      first ??= error;
    }
  }
  throw first ?? new Error(`The pack has no tile of block ${block}.`);
}

/** Assembles the coarsest level of each map and posts it in bands. */
async function maps() {
  const damaged = [];
  for (let place = 0; ; place++) {
    const levels = [...reader.beginMap(place)];
    if (!levels.length) break;
    const map = reader.map();
    let next = 0;
    const work = async () => {
      while (next < BLOCKS) {
        const error = await addBlock(map, levels, next++);
        if (error) damaged.push(error.message);
      }
    };
    await Promise.all(Array.from({ length: AT_ONCE }, work));
    reader.endMap((...band) => postMessage({ band }, [band[5].buffer]));
  }
  postMessage({ damaged });
}

async function load([number, ...key]) {
  const abort = new AbortController();
  aborts.set(number, abort);
  let address = "";
  try {
    address = reader.file(...key);
    const bytes = await tileBytes(key, abort.signal);
    const texels = reader.tile(...key, bytes);
    postMessage({ number, texels }, [texels.buffer]);
  } catch (error) {
    const isUnwanted = abort.signal.aborted;
    postMessage({ number, failed: { address, cause: error?.message ?? String(error), isUnwanted } });
  } finally {
    aborts.delete(number);
  }
}

onmessage = async ({ data }) => {
  try {
    if (data.open) await open(data.open);
    else if (data.maps) await maps();
    else if (data.load) await load(data.load);
    else aborts.get(data.abort)?.abort();
  } catch (error) {
    postMessage({ error: error?.message ?? String(error) });
  }
};
