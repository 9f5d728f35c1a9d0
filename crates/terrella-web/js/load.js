// Files of the page: fetched, counted, compiled.

import { AIR, BACKENDS, DETAIL_TILE } from "./files.js";

/** The only map that must be there. */
const DAY = "day.jpg";

/** Compiled wasm by address: elements share it. */
const compiled = new Map();
/** Backends whose tables were supplied. */
const supplied = new Map();

/** A fetch whose error names the file and the remedy. */
async function fetched(what, source, signal) {
  const response = await fetch(source, { signal }).catch((cause) => {
    if (signal?.aborted) throw cause;
    throw new Error(`${what} could not be loaded from ${source}: ${cause.message}. Check the address and the connection.`);
  });
  if (!response.ok && response.status !== 404) throw refused(what, source, response);
  return response;
}

const refused = (what, source, response) => new Error(`${what} could not be loaded: ${source} answered ${response.status}. Check the address.`);

/** The bytes of a map, as given or fetched; `undefined` if an optional map is missing. */
async function mapBytes(name, source, signal, count) {
  // A copy: the worker takes the bytes away.
  if (source instanceof ArrayBuffer) return new Uint8Array(source.slice(0));
  if (ArrayBuffer.isView(source)) return new Uint8Array(source.buffer, source.byteOffset, source.byteLength).slice();
  const response = await fetched(`The map ${name}`, source, signal);
  if (response.status === 404) {
    if (name !== DAY) return undefined;
    throw refused(`The map ${name}`, source, response);
  }
  const chunks = [];
  let length = 0;
  const reader = response.body.getReader();
  count(0, Number(response.headers.get("content-length")) || 0);
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    chunks.push(part.value);
    length += part.value.length;
    count(part.value.length, 0);
  }
  const bytes = new Uint8Array(length);
  let at = 0;
  for (const chunk of chunks) {
    bytes.set(chunk, at);
    at += chunk.length;
  }
  return bytes;
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
    const module = fetched("The program", address).then(async (response) => {
      if (!response.ok) throw refused("The program", address, response);
      const isWasm = response.headers.get("content-type")?.startsWith("application/wasm");
      return isWasm ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer());
    });
    compiled.set(address, module);
    // A failed load is tried again by the next element.
    module.catch(() => compiled.delete(address));
  }
  return compiled.get(address);
}

/** Gives a backend's module the tables of the air and the tile of detail, once in a page. */
function supply(backend, module) {
  if (!supplied.has(backend)) {
    const files = Promise.all([
      fetched("The tables of the air", AIR).then(async (response) => {
        if (!response.ok) throw refused("The tables of the air", AIR, response);
        const inflated = new Response(response.body.pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
        return inflated.catch((cause) => {
          throw new Error(`The tables of the air could not be read from ${AIR}: ${cause.message}. Check that the address serves the package's file.`);
        });
      }),
      fetched("The tile of detail", DETAIL_TILE).then((response) => {
        if (!response.ok) throw refused("The tile of detail", DETAIL_TILE, response);
        return response.arrayBuffer();
      }),
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
