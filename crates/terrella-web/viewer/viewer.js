// The viewer: the globe, a time line, scenes, satellites from a file, a station with its passes, lines, an imagery pack, and a link that stores all of these.

import "./terrella/terrella.js";

const element = document.querySelector("terrella-earth");
const $ = (id) => document.getElementById(id);
const VIEW = ["lat", "lon", "altitude", "heading", "pitch", "fov"];
/** Limit on the satellite text in a link, characters: servers and browsers truncate longer addresses. */
const LINK_TEXT = 4000;
/** Decimals of a view's numbers in a link. */
const DIGITS = { lat: 6, lon: 6, altitude: 1, heading: 3, pitch: 3, fov: 3 };

/** Half of the time line, and its whole, milliseconds. */
const HALF_DAY = 43_200_000;
const DAY = 2 * HALF_DAY;
/** Passes listed below the time line. */
const LISTED_PASSES = 8;
/** Elevation mask of the station, degrees. */
const MASK = 10;

/** The middle of the time line. */
let middle = Date.now();
let elements = "";

/** Address of a shipped scene. Files of dropped scenes are looked for beside them. */
const sceneAddress = (name) => new URL(`scenes/${name}.toml`, document.baseURI);

const notice = (text) => {
  $("notice").textContent = text;
};

/** What the address holds. */
const state = new URLSearchParams(location.hash.slice(1));
const sharedView = VIEW.map((key) => [key, Number(state.get(key) ?? NaN)]).filter(([, value]) => Number.isFinite(value));

/** Restores view, instant, speed and satellites from the address. */
function restore() {
  for (const [key, value] of sharedView) element.setAttribute(key, value);
  const t = Date.parse(state.get("t") ?? "");
  if (Number.isFinite(t)) middle = t;
  element.setAttribute("epoch", new Date(middle).toISOString());
  const rate = Number(state.get("rate") ?? 0);
  $("rate").value = [...$("rate").options].some((option) => Number(option.value) === rate) ? String(rate) : "0";
  element.setAttribute("rate", $("rate").value);
  elements = state.get("elements") ?? "";
  // A name that is no scene chooses none.
  $("scene").value = state.get("scene") ?? "";
  $("scene").selectedIndex = Math.max($("scene").selectedIndex, 0);
  $("station").value = state.get("station") ?? "";
  $("pack").value = state.get("pack") ?? "";
  const lines = (state.get("lines") ?? "").split(" ");
  for (const box of lineBoxes()) box.checked = lines.includes(box.value);
}

const lineBoxes = () => [...document.querySelectorAll("#lines input")];
const checkedLines = () => lineBoxes().filter((box) => box.checked).map((box) => box.value);

const clock = (date) => date.toISOString().slice(11, 16);
const degrees = (value, [positive, negative]) => `${Math.abs(value).toFixed(2)}° ${value < 0 ? negative : positive}`;

/** Shadows and passes of the first satellite along the time line. */
function showBands() {
  const { earth } = element;
  const search = { from: middle - HALF_DAY, hours: DAY / 3_600_000 };
  let [shadows, passes] = [[], []];
  try {
    [shadows, passes] = [earth.shadows(search), earth.passes(search)];
  } catch (error) {
    notice(error.message);
  }
  const band = ({ begin, end }, kind) => {
    const mark = document.createElement("div");
    mark.className = kind;
    mark.style.left = `${(100 * (begin - search.from)) / DAY}%`;
    mark.style.width = `${Math.max((100 * (end - begin)) / DAY, 0.3)}%`;
    return mark;
  };
  $("bands").replaceChildren(
    ...shadows.map((shadow) => band(shadow, "shadow")),
    ...passes.map((pass) => band(pass, pass.isVisible ? "visible" : "pass")),
  );
  const coming = passes.filter((pass) => pass.end >= middle).slice(0, LISTED_PASSES);
  const buttons = coming.map((pass) => {
    const button = document.createElement("button");
    button.type = "button";
    button.className = pass.isVisible ? "visible" : "";
    button.textContent = `${clock(pass.begin)}–${clock(pass.end)} ${pass.elevation.toFixed(0)}°${pass.isVisible ? " visible" : ""}`;
    button.addEventListener("click", () => setTime(pass.highest.getTime(), false));
    return button;
  });
  $("passes").hidden = buttons.length === 0;
  $("passes").replaceChildren("Passes, UTC:", ...buttons);
}

/** The station of the text field, "latitude, longitude"; none of an empty one. */
function showStation() {
  const text = $("station").value.trim();
  const [lat, lon] = text.split(/[\s,]+/).map(Number);
  try {
    element.earth.stations = text ? [{ name: "Station", lat, lon, mask: MASK }] : [];
    notice("");
  } catch {
    notice("Write the station as latitude and longitude in degrees, such as 52.5, 13.4.");
  }
  showBands();
}

function link() {
  const { view } = element.earth;
  // A camera on a satellite has no view of its own.
  const state = new URLSearchParams(element.earth.follow ? [] : VIEW.map((key) => [key, view[key].toFixed(DIGITS[key])]));
  state.set("t", new Date(element.epoch).toISOString());
  state.set("rate", element.rate);
  if (elements && elements.length <= LINK_TEXT) state.set("elements", elements);
  if ($("scene").value) state.set("scene", $("scene").value);
  if ($("station").value) state.set("station", $("station").value);
  if ($("pack").value) state.set("pack", $("pack").value);
  if (checkedLines().length) state.set("lines", checkedLines().join(" "));
  return new URL(`#${state}`, location.href).href;
}

function showSatellites(text) {
  try {
    const names = element.setSatellites(text);
    elements = text;
    const shown = names.slice(0, 3).join(", ") + (names.length > 3 ? ` and ${names.length - 3} more` : "");
    notice(names.length ? `${shown}. Elements hold for some weeks around their date.` : "");
    const epoch = element.earth.elementsEpoch();
    if (epoch && Math.abs(epoch - element.epoch) > 30 * DAY) setTime(epoch.getTime());
    else showBands();
  } catch (error) {
    notice(error.message);
  }
}

/** Shows an instant, and moves the middle of the time line there. */
function setTime(ms, isMiddle = true) {
  if (isMiddle) middle = ms;
  $("time").value = (ms - middle) / 1000;
  element.epoch = new Date(ms);
  if (isMiddle) showBands();
}

/** Shows a scene: an address, or a text whose files stand beside the shipped scenes. */
async function showScene(scene) {
  const { earth } = element;
  try {
    const missing = scene instanceof URL ? await earth.setScene(scene) : await earth.showScene(scene, sceneAddress("dropped"));
    if (!missing) return;
    elements = "";
    $("station").value = "";
    const names = missing.length > 4 ? `${missing.slice(0, 4).join(", ")} and ${missing.length - 4} more` : missing.join(", ");
    notice(missing.length ? `Not in a page: ${names}.` : "");
    for (const box of lineBoxes()) box.checked = earth.lines.includes(box.value);
    $("pack").value = earth.pack ?? "";
    const rates = [...$("rate").options].map((option) => Number(option.value));
    // The nearest rate of the list.
    earth.rate = rates.reduce((best, rate) => (Math.abs(rate - earth.rate) < Math.abs(best - earth.rate) ? rate : best));
    $("rate").value = String(earth.rate);
    setTime(earth.epoch.getTime());
  } catch {
    // The event has the error.
  }
}

async function readFile(file) {
  const text = await file.text();
  if (!file.name.endsWith(".toml")) return showSatellites(text);
  $("scene").value = "";
  return showScene(text);
}

/** Shows the scene of the address, with the view and the instant that stand beside it. */
async function restoreScene() {
  const [t, rate] = [Date.parse(state.get("t") ?? ""), state.get("rate")];
  await showScene(sceneAddress($("scene").value));
  if (sharedView.length) element.earth.view = Object.fromEntries(sharedView);
  if (Number.isFinite(t)) setTime(t);
  if (rate === null) return;
  $("rate").value = rate;
  element.rate = Number($("rate").value);
}

restore();
/** After a lost device the element restores itself. */
element.addEventListener("ready", start, { once: true });

function start() {
  if ($("scene").value) restoreScene();
  else {
    showStation();
    if (elements) showSatellites(elements);
    element.lines = checkedLines();
  }
  $("scene").addEventListener("change", () => $("scene").value && showScene(sceneAddress($("scene").value)));
  $("station").addEventListener("change", showStation);
  const showPack = () => {
    element.pack = $("pack").value.trim();
  };
  if ($("pack").value) showPack();
  $("pack").addEventListener("change", showPack);
  $("lines").addEventListener("change", () => {
    element.lines = checkedLines();
  });
  $("time").addEventListener("input", () => {
    element.epoch = new Date(middle + 1000 * Number($("time").value));
  });
  $("rate").addEventListener("change", () => {
    element.rate = Number($("rate").value);
  });
  $("now").addEventListener("click", () => setTime(Date.now()));
  $("file").addEventListener("change", () => $("file").files[0] && readFile($("file").files[0]));
  $("share").addEventListener("click", async () => {
    history.replaceState(null, "", link());
    try {
      await navigator.clipboard.writeText(location.href);
      notice("The link is copied.");
    } catch {
      notice("The link stands in the address bar.");
    }
  });
  $("save").addEventListener("click", async () => {
    const anchor = document.createElement("a");
    anchor.href = URL.createObjectURL(await element.earth.toBlob());
    anchor.download = `earth-${new Date(element.epoch).toISOString().replaceAll(":", "")}.png`;
    anchor.click();
    setTimeout(() => URL.revokeObjectURL(anchor.href), 60_000);
  });
  $("full").addEventListener("click", () => element.requestFullscreen().catch((error) => notice(error.message)));
}
element.addEventListener("frame", (event) => {
  $("epoch").textContent = `${event.detail.epoch.toISOString().slice(0, 19).replace("T", " ")} UTC`;
});
element.addEventListener("error", (event) => notice(event.detail.message));
element.addEventListener("pack", ({ detail }) => {
  $("credit").textContent = detail ? [detail.name, ...detail.attribution].join(" · ") : "";
});
element.addEventListener("pick", ({ detail: { place, satellite, station } }) => {
  const name = satellite?.name ?? station?.name;
  const where = place ? `${degrees(place.lat, "NS")}, ${degrees(place.lon, "EW")}` : "";
  notice([name, where].filter(Boolean).join(", "));
});
$("panel").addEventListener("submit", (event) => event.preventDefault());

element.addEventListener("dragover", (event) => {
  event.preventDefault();
  element.classList.add("dropping");
});
element.addEventListener("dragleave", () => element.classList.remove("dropping"));
element.addEventListener("drop", (event) => {
  event.preventDefault();
  element.classList.remove("dropping");
  const file = event.dataTransfer.files[0];
  if (file && element.earth) readFile(file);
});
