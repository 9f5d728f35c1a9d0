// The scene that an Earth shows: the last one that was set.

export class ShownScene {
  /** The address that was set last; null for a text, and without a scene. */
  address = null;
  #earth;
  #isAlive;
  /** Of the last call that sets a scene. */
  #turn = null;

  /** `isAlive` says whether the Earth is not freed. */
  constructor(earth, isAlive) {
    this.#earth = earth;
    this.#isAlive = isAlive;
  }

  /** Shows the scene at an address; with none the Earth stays as it is. */
  async fetch(address) {
    this.address = address ? new URL(address, document.baseURI).href : null;
    this.#turn = {};
    return this.address ? this.#apply(this.#turn, ({ sceneText }) => sceneText(this.address), this.address) : undefined;
  }

  /** Shows a text. */
  show(text, base) {
    this.address = null;
    this.#turn = {};
    return this.#apply(this.#turn, () => text, base);
  }

  async #apply(turn, textOf, base) {
    const isWanted = () => this.#turn === turn && Boolean(this.#isAlive());
    try {
      // Pages without a scene do not load it.
      const module = await import("./scene.js");
      const missing = await module.showScene(this.#earth, await textOf(module), base, isWanted);
      if (missing) this.#earth.dispatchEvent(new CustomEvent("scene", { detail: missing }));
      return missing;
    } catch (error) {
      if (!isWanted()) return undefined;
      this.#earth.dispatchEvent(new CustomEvent("error", { detail: error }));
      throw error;
    }
  }
}
