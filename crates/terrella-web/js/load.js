// Files of the page: counted, compiled.

import { fetched, loaded, readBytes, retried } from "./fetching.js";
import { AIR, BACKENDS, DETAIL_TILES, LINES } from "./files.js";

/** The only map that must be there. */
const DAY = "day.jpg";

/** Compiled wasm by address: elements share it. */
const compiled = new Map();
/** Backends whose tables were supplied. */
const supplied = new Map();

/** The bytes of a map, as given or fetched; `undefined` if an optional map is missing. */
async function mapBytes(name, source, signal, count) {
  // A copy: the worker takes the bytes away.
  if (source instanceof ArrayBuffer) return new Uint8Array(source.slice(0));
  if (ArrayBuffer.isView(source)) return new Uint8Array(source.buffer, source.byteOffset, source.byteLength).slice();
  return retried(signal, () => fetchedMap(name, source, signal, count));
}

async function fetchedMap(name, source, signal, count) {
  const what = `The map ${name}`;
  const response = await fetched(what, source, signal, name !== DAY);
  return response.ok ? readBytes(what, source, signal, response, { count }) : undefined;
}

/** Addresses or bytes of maps by name. `maps` is the URL of a folder, or such an object itself. */
export function mapSources(maps, names) {
  if (typeof maps !== "string" && !(maps instanceof URL)) return maps;
  const folder = new URL(maps, document.baseURI);
  if (!folder.pathname.endsWith("/")) folder.pathname += "/";
  return Object.fromEntries(names.map((name) => [name, new URL(name, folder)]));
}

/** The bytes of maps by name. `progress` is called with the part that came. */
export async function loadMaps(sources, signal, progress) {
  let [came, expected] = [0, 0];
  const count = (more, announced) => {
    came += more;
    expected += announced;
    progress(expected ? Math.min(came / expected, 1) : 0);
  };
  const loads = Object.entries(sources).map(async ([name, source]) => [name, await mapBytes(name, source, signal, count)]);
  const files = await Promise.all(loads);
  return Object.fromEntries(files.filter(([, bytes]) => bytes));
}

/** The wasm module of a backend, compiled once per address. */
async function compile(source) {
  if (source instanceof WebAssembly.Module) return source;
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return WebAssembly.compile(source);
  const address = new URL(source, document.baseURI).href;
  if (!compiled.has(address)) {
    const module = loaded("The program", address, (response) => {
      const isWasm = response.headers.get("content-type")?.startsWith("application/wasm");
      return isWasm ? WebAssembly.compileStreaming(response) : response.arrayBuffer().then((bytes) => WebAssembly.compile(bytes));
    });
    compiled.set(address, module);
    // A failed load is tried again by the next element.
    module.catch(() => compiled.delete(address));
  }
  return compiled.get(address);
}

/** The file of coast lines and borders. */
export const loadLines = () => loaded("Coast lines and borders", LINES, async (response) => new Uint8Array(await response.arrayBuffer()));

const inflated = (response) => new Response(response.body.pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();

/** Gives a backend's module the tables of the air and the tiles of detail, once in a page. */
function supply(backend, module) {
  if (!supplied.has(backend)) {
    const files = Promise.all([
      loaded("The tables of the air", AIR, inflated),
      loaded("The tiles of detail", DETAIL_TILES, (response) => response.arrayBuffer()),
    ]);
    const done = Promise.all([module, files]).then(([module, [air, tile]]) => module.supply(new Uint8Array(air), new Uint8Array(tile)));
    supplied.set(backend, done);
    done.catch(() => supplied.delete(backend));
  }
  return supplied.get(backend);
}

/** The module of a backend, ready to run, and its compiled wasm. */
export async function loadBackend(backend, wasm) {
  const compiling = compile(wasm ?? BACKENDS[backend].wasm);
  const module = Promise.all([BACKENDS[backend].module(), compiling]).then(async ([module, compiled]) => {
    await module.default({ module_or_path: compiled });
    return module;
  });
  await supply(backend, module);
  return { module: await module, compiled: await compiling };
}
