// The page's side of a pack's worker: opens the pack, and loads the tiles that the Earth requests.

import { newWorker, PACKS } from "./files.js";

/** While tiles are missing that did not come, a frame is drawn so often, milliseconds: the Earth decides which to request again. */
const RETRY_MS = 1000;

class Pack {
  #worker = newWorker(PACKS.worker, "worker-pack.js");
  #globe = null;
  #changed;
  #reported;
  #timer = 0;
  /** Whether a tile did not come since all were there. */
  #hasFailed = false;
  /** Loads that were ended before their tile came. */
  #unwanted = new Set();
  /** Settle the request that is going on. */
  #resolve = () => {};
  #reject = () => {};
  #take = () => {};

  /** `changed` is called when a tile has come, `reported` with the reason why one did not, or with null once one comes again. */
  constructor(changed, reported) {
    this.#changed = changed;
    this.#reported = reported;
    this.#worker.onerror = (event) => this.#reject(new Error(`The worker that reads the pack did not start: ${event.message ?? "worker-pack.js could not be loaded"}.`));
    this.#worker.onmessage = ({ data }) => this.#receive(data);
  }

  /** Reads the pack at an address. */
  open(address, hasBc) {
    return this.#ask({ open: { address, wasm: PACKS.wasm.href, hasBc } });
  }

  /** Passes the bands of the pack's whole maps to `take`. Returns errors of damaged tiles, which finer ones replace. */
  maps(take) {
    this.#take = take;
    return this.#ask({ maps: true });
  }

  /** Loads tiles for an Earth that draws this pack. */
  attach(globe) {
    this.#globe = globe;
  }

  /** Requests what the last frame lacks, and ends what it no longer wants. */
  follow() {
    if (!this.#globe) return;
    for (const number of this.#globe.unwantedTiles()) {
      if (this.#unwanted.has(number)) continue;
      this.#unwanted.add(number);
      this.#worker.postMessage({ abort: number });
    }
    for (let tile = this.#globe.takeTile(); tile; tile = this.#globe.takeTile()) {
      this.#worker.postMessage({ load: [...tile] });
    }
    this.#hasFailed &&= !this.#globe.isSharp();
    clearTimeout(this.#timer);
    if (this.#hasFailed) this.#timer = setTimeout(this.#changed, RETRY_MS);
  }

  /** Ends the worker. What is going on fails with an `AbortError`. */
  end() {
    clearTimeout(this.#timer);
    this.#globe = null;
    this.#worker.terminate();
    this.#reject(new DOMException("The pack is no longer wanted.", "AbortError"));
  }

  #ask(message) {
    return new Promise((resolve, reject) => {
      this.#resolve = resolve;
      this.#reject = reject;
      this.#worker.postMessage(message);
    });
  }

  #receive(data) {
    try {
      if (data.band) this.#take(...data.band);
      else if (data.error) this.#reject(new Error(data.error));
      else if (data.number === undefined) this.#resolve(data.opened ?? data.damaged);
      else if (this.#globe) this.#end(data);
    } catch (error) {
      this.#reject(error);
    }
  }

  #end({ number, texels, failed }) {
    this.#unwanted.delete(number);
    if (texels) {
      this.#globe.endTile(number, texels);
      this.#reported(null);
    } else {
      this.#globe.failTile(number, failed.address, failed.cause, failed.isUnwanted);
      if (!failed.isUnwanted) {
        this.#hasFailed = true;
        this.#reported(failed.cause);
      }
    }
    this.#changed();
  }
}

/** The pack that an Earth is drawn with. Another is opened beside it and takes its place. */
export class ShownPack {
  /** The address that was set last, of a pack that is shown or being opened; null without one. */
  address = null;
  #earth;
  #shown = null;
  #shownAddress = null;
  #opening = null;
  /** Of the last call that sets a pack. */
  #turn = null;
  #why = null;

  /** `earth` has the functions `globe`, the wasm object or null once it is freed; `ready`, which settles when the page's maps are there; `invalidate`; `send`. */
  constructor(earth) {
    this.#earth = earth;
  }

  /** Draws the pack at an address, or none. Returns its name and attribution; undefined if another was set meanwhile. */
  async show(address) {
    const folder = address ? new URL(`${String(address).replace(/\/*$/, "")}/`, document.baseURI).href : null;
    if (folder === this.address) return undefined;
    this.#opening?.end();
    const pack = folder ? new Pack(this.#earth.invalidate, (why) => this.#tell(why)) : null;
    const turn = {};
    [this.#opening, this.#turn, this.address] = [pack, turn, folder];
    const isWanted = () => this.#turn === turn && this.#earth.globe();
    // Memory of wasm is given back by hand.
    let tiled = null;
    try {
      // They are drawn where the pack has none.
      await this.#earth.ready().catch(() => {});
      if (!isWanted()) return undefined;
      const about = await pack?.open(folder, this.#earth.globe().hasBc());
      if (!isWanted()) return undefined;
      tiled = this.#earth.globe().openPack(about?.layout ?? new Uint32Array(), about?.slopeFactor ?? 1);
      const damaged = await pack?.maps((...band) => tiled.band(...band));
      // It consumes itself.
      const made = tiled.finish();
      tiled = null;
      const earth = await made;
      if (!isWanted()) {
        earth.free();
        return undefined;
      }
      this.#earth.globe().showPack(earth);
      this.#shown?.end();
      [this.#shown, this.#shownAddress, this.#opening] = [pack, folder, null];
      pack?.attach(this.#earth.globe());
      this.#tell(damaged?.[0] ?? null);
      this.#earth.invalidate();
      const detail = about ? { name: about.name, attribution: about.attribution } : null;
      this.#earth.send("pack", detail);
      return detail;
    } catch (error) {
      tiled?.free();
      pack?.end();
      if (!isWanted()) return undefined;
      [this.#opening, this.address] = [null, this.#shownAddress];
      this.#earth.send("error", error);
      throw error;
    }
  }

  /** Requests what the last frame lacks. */
  follow() {
    this.#shown?.follow();
  }

  /** Ends what is going on. */
  end() {
    this.#shown?.end();
    this.#opening?.end();
    [this.#shown, this.#opening, this.#turn] = [null, null, null];
  }

  #tell(why) {
    if (why === this.#why) return;
    this.#why = why;
    this.#earth.send("tiles", why);
  }
}
