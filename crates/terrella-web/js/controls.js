// Pointer, wheel and keys on a canvas: the grabbed place stays under the pointer.

/** Distance factor per pixel of wheel motion. */
const WHEEL_FACTOR = 1.0015;
/** Pixels per unit of wheel motion: pixel, line, page. */
const WHEEL_UNITS_PX = [1, 20, 400];
/** Pixels per press of a rotation key, and the distance factor per press of a zoom key. */
const KEY_PX = 40;
const KEY_FACTOR = 1.25;

/** How far a click may move, pixels of the page. */
const CLICK_PX = 4;

export class Controls {
  #canvas;
  #earth;
  /** Positions of the pressed pointers by id, in canvas pixels. */
  #pointers = new Map();
  #isTilting = false;
  /** How far the pointers have moved since the last was pressed, canvas pixels. */
  #travelled = 0;
  #abort = new AbortController();

  constructor(canvas, earth) {
    this.#canvas = canvas;
    this.#earth = earth;
    const listen = (type, listener, options) =>
      canvas.addEventListener(type, listener, { signal: this.#abort.signal, ...options });
    listen("pointerdown", (event) => this.#down(event));
    listen("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) listen(end, (event) => this.#up(event));
    listen("wheel", (event) => this.#wheel(event), { passive: false });
    listen("contextmenu", (event) => event.preventDefault());
    listen("keydown", (event) => this.#key(event));
  }

  detach() {
    this.#abort.abort();
  }

  #pixel(event) {
    const box = this.#canvas.getBoundingClientRect();
    const scale = (length, size) => (length * size[0]) / Math.max(size[1], 1);
    return [
      scale(event.clientX - box.left, [this.#canvas.width, box.width]),
      scale(event.clientY - box.top, [this.#canvas.height, box.height]),
    ];
  }

  /** Centre of the pressed pointers, and their distance from it. */
  #pinch() {
    const all = [...this.#pointers.values()];
    const middle = [0, 1].map((axis) => all.reduce((sum, at) => sum + at[axis], 0) / all.length);
    const spread = all.reduce((sum, at) => sum + Math.hypot(at[0] - middle[0], at[1] - middle[1]), 0) / all.length;
    return { middle, spread };
  }

  #down(event) {
    this.#canvas.focus({ preventScroll: true });
    try {
      this.#canvas.setPointerCapture(event.pointerId);
    } catch {
      // A synthetic pointer cannot be captured.
    }
    this.#travelled = 0;
    this.#isTilting = event.button === 2 || event.shiftKey || event.ctrlKey;
    this.#pointers.set(event.pointerId, this.#pixel(event));
    this.#earth.grab(...this.#pinch().middle);
  }

  #move(event) {
    if (!this.#pointers.has(event.pointerId)) return;
    const before = this.#pinch();
    this.#pointers.set(event.pointerId, this.#pixel(event));
    const after = this.#pinch();
    this.#travelled += Math.hypot(after.middle[0] - before.middle[0], after.middle[1] - before.middle[1]);
    if (this.#isTilting && this.#pointers.size === 1) {
      this.#earth.tilt(after.middle[0] - before.middle[0], after.middle[1] - before.middle[1]);
      return;
    }
    if (before.spread > 0 && after.spread > 0 && this.#pointers.size > 1) {
      this.#earth.approach(...before.middle, before.spread / after.spread);
    }
    this.#earth.drag(...before.middle, ...after.middle);
  }

  #up(event) {
    const isClick = event.type === "pointerup" && this.#pointers.size === 1 && this.#travelled < CLICK_PX * devicePixelRatio;
    if (!this.#pointers.delete(event.pointerId)) return;
    if (this.#pointers.size > 0) this.#earth.grab(...this.#pinch().middle);
    else if (isClick && !this.#isTilting) this.#earth.click(...this.#pixel(event));
  }

  #wheel(event) {
    event.preventDefault();
    const pixels = event.deltaY * (WHEEL_UNITS_PX[event.deltaMode] ?? 1);
    this.#earth.approach(...this.#pixel(event), WHEEL_FACTOR ** pixels);
  }

  #key(event) {
    if (event.altKey || event.metaKey) return;
    const [x, y] = [this.#canvas.width / 2, this.#canvas.height / 2];
    const step = KEY_PX * devicePixelRatio;
    const move = event.shiftKey || event.ctrlKey ? (dx, dy) => this.#earth.tilt(dx, dy) : (dx, dy) => this.#earth.spin(dx, dy);
    const actions = {
      ArrowLeft: () => move(step, 0),
      ArrowRight: () => move(-step, 0),
      ArrowUp: () => move(0, step),
      ArrowDown: () => move(0, -step),
      "+": () => this.#earth.approach(x, y, 1 / KEY_FACTOR),
      "=": () => this.#earth.approach(x, y, 1 / KEY_FACTOR),
      "-": () => this.#earth.approach(x, y, KEY_FACTOR),
      n: () => this.#earth.northUp(),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }
}
