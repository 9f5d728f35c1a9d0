// Requests: tried again where that may help, and errors that name the file and the remedy.

/** Waits before further attempts, milliseconds. */
const RETRY_DELAYS_MS = [500, 2000];
const HTTP_MISSING = 404;
/** Too many requests. */
const HTTP_BUSY = 429;

/** A failure that a later attempt may not have: a lost connection, a busy server. */
class TransientError extends Error {}

/** The result of the first attempt that succeeds. Transient failures are tried again. */
export async function retried(signal, attempt) {
  for (const delay of RETRY_DELAYS_MS) {
    try {
      return await attempt();
    } catch (error) {
      if (!(error instanceof TransientError)) throw error;
    }
    await new Promise((resolve) => setTimeout(resolve, delay));
    signal?.throwIfAborted();
  }
  return attempt();
}

/** Waits for a part of an answer. Its error names the file and the remedy. */
function received(what, source, signal, part) {
  return part.catch((cause) => {
    if (signal?.aborted) throw cause;
    if (cause instanceof WebAssembly.CompileError) throw new Error(`${what} from ${source} is not WebAssembly: ${cause.message}. Check the address.`);
    throw new TransientError(`${what} could not be loaded from ${source}: ${cause.message}. Check the address and the connection.`);
  });
}

export async function fetched(what, source, signal, isOptional = false) {
  const response = await received(what, source, signal, fetch(source, { signal }));
  if (response.ok || (isOptional && response.status === HTTP_MISSING)) return response;
  const isTransient = response.status >= 500 || response.status === HTTP_BUSY;
  const message = `${what} could not be loaded: ${source} answered ${response.status}. Check the address.`;
  throw isTransient ? new TransientError(message) : new Error(message);
}

/** A file that must be there, as `read` makes it from the answer. */
export const loaded = (what, source, read) => retried(undefined, async () => received(what, source, undefined, read(await fetched(what, source))));

/** The body of an answer. `count` is called with the bytes that came and those that were announced. More than `limit` bytes are an error. */
export async function readBytes(what, source, signal, response, { count = () => {}, limit = Infinity } = {}) {
  const chunks = [];
  let length = 0;
  const reader = response.body.getReader();
  const announced = Number(response.headers.get("content-length")) || 0;
  count(0, announced);
  const next = () => received(what, source, signal, reader.read());
  try {
    for (let part = await next(); !part.done; part = await next()) {
      chunks.push(part.value);
      length += part.value.length;
      count(part.value.length, 0);
      if (length > limit) {
        reader.cancel().catch(() => {});
        throw new Error(`${what} from ${source} is longer than ${limit} bytes. Check the address.`);
      }
    }
  } catch (error) {
    // Another attempt counts from the start.
    count(-length, -announced);
    throw error;
  }
  const bytes = new Uint8Array(length);
  let at = 0;
  for (const chunk of chunks) {
    bytes.set(chunk, at);
    at += chunk.length;
  }
  return bytes;
}

/** The bytes of a file that has at most so many. */
export async function fileBytes(what, source, limit, signal) {
  return readBytes(what, source, signal, await fetched(what, source, signal), { limit });
}
