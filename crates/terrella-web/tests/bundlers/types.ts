// What the package's types allow and reject, for `tsc --noEmit --strict`: a line below `@ts-expect-error` that compiles is an error.

import { TerrellaEarth, TerrellaEarthElement, type Camera, type Maps, type View, type Wasm } from "terrella";

const element = document.querySelector("terrella-earth");
if (!(element instanceof TerrellaEarthElement)) throw new Error("no element");
const made: TerrellaEarthElement = document.createElement("terrella-earth");
const maps: Maps = { "day.jpg": new Uint8Array(4), "clouds.jpg": new URL("clouds.jpg", location.href), "stars.bin": "stars.bin" };
const wasm: Wasm = { webgpu: "webgpu_bg.wasm", webgl: new ArrayBuffer(8) };
made.maps = maps;
made.wasm = wasm;
made.hide = ["clouds", "air"];
made.epoch = "now";
// @ts-expect-error: there is no such part
made.hide = ["oceans"];
// @ts-expect-error: a number
made.lat = "20";
made.lines = ["coasts", "twilight"];
made.stations = [{ name: "Kiruna", lat: 67.9, lon: 21 }];
// @ts-expect-error: a station has a place
made.stations = [{ name: "Kiruna" }];
made.push({ epoch: "2026-01-01T00:00:00Z", frame: "GCRF", position_m: [7e6, 0, 0], velocity_m_s: [0, 7500, 0] })?.concat();
// @ts-expect-error: there is no such frame
made.push({ epoch: "2026-01-01T00:00:00Z", frame: "MOON", position_m: [7e6, 0, 0], velocity_m_s: [0, 7500, 0] });

made.addEventListener("ready", () => made.earth?.invalidate());
made.addEventListener("progress", (event) => event.detail.what.concat(event.detail.part.toFixed(1)));
made.addEventListener("frame", ({ detail }) => detail.epoch.getTime());
made.addEventListener("error", ({ detail }) => detail.message.length);
made.addEventListener("devicelost", ({ detail }) => detail.length);
made.addEventListener("pointerdown", (event) => event.clientX);
made.addEventListener("pick", function ({ detail: { place, satellite, x, y } }) {
  // @ts-expect-error: the place may be null
  place.lat;
  this.heading = (place?.lat ?? 0) + (satellite?.index ?? 0) + x + y;
});
// @ts-expect-error: the detail is no text
made.addEventListener("pick", ({ detail }: CustomEvent<string>) => detail);
const onFrame = (event: CustomEvent<{ epoch: Date }>) => event.detail.epoch;
made.addEventListener("frame", onFrame);
made.removeEventListener("frame", onFrame);

export async function draw(canvas: HTMLCanvasElement, signal: AbortSignal): Promise<boolean> {
  const progress = (part: number, what: string) => console.log(part, what);
  const earth = await TerrellaEarth.create(canvas, { maps, wasm, backend: "webgl", samples: 1, controls: false, signal, progress });
  // @ts-expect-error: four samples or one
  await TerrellaEarth.create(canvas, { samples: 2 });
  const camera: Camera = { position: new Float64Array(3), direction: [1, 0, 0], up: [0, 0, 1], fov: 40 };
  earth.setCamera(camera);
  // @ts-expect-error: without a field of view
  earth.setCamera({ position: [7e6, 0, 0], direction: [-1, 0, 0], up: [0, 0, 1] });
  earth.addEventListener("complete", () => earth.draw(Date.now()));
  earth.addEventListener("pick", ({ detail }) => detail.place?.lon.toFixed(2));
  // @ts-expect-error: the Earth itself has no such event
  earth.addEventListener("ready", (event: CustomEvent<number>) => event.detail);
  earth.view = { lat: 20 };
  const view: View = earth.view;
  earth.epoch = view.lat;
  const shown: Date = earth.epoch;
  earth.epoch = "live";
  const heights: number[] = earth.passes({ station: 1, hours: 2 }).filter((pass) => pass.isVisible).map((pass) => pass.elevation);
  const dark: Date[] = earth.shadows({ from: shown }).map(({ begin }) => begin);
  earth.pack = new URL("https://tiles.example/earth/");
  earth.addEventListener("pack", ({ detail }) => detail?.attribution.join("; "));
  const about = await earth.setPack(null);
  console.log(about?.name, earth.isSharp, earth.pack?.length);
  console.log(heights, dark, earth.stations[0]?.mask, earth.labels[0]?.kind);
  await earth.complete;
  return earth.draw(shown.getTime());
}
