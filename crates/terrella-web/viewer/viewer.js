// The viewer: the globe, a time line, satellites from a file, and a link that stores all of these.

import "./terrella/terrella.js";

const element = document.querySelector("terrella-earth");
const $ = (id) => document.getElementById(id);
const VIEW = ["lat", "lon", "altitude", "heading", "pitch", "fov"];
/** Limit on the satellite text in a link, characters: servers and browsers truncate longer addresses. */
const LINK_TEXT = 4000;
/** Decimals of a view's numbers in a link. */
const DIGITS = { lat: 6, lon: 6, altitude: 1, heading: 3, pitch: 3, fov: 3 };

/** The middle of the time line. */
let middle = Date.now();
let elements = "";

const notice = (text) => {
  $("notice").textContent = text;
};

/** Restores view, instant, speed and satellites from the address. */
function restore() {
  const state = new URLSearchParams(location.hash.slice(1));
  const view = VIEW.filter((key) => state.has(key)).map((key) => [key, Number(state.get(key))]);
  for (const [key, value] of view) if (Number.isFinite(value)) element.setAttribute(key, value);
  const t = Date.parse(state.get("t") ?? "");
  if (Number.isFinite(t)) middle = t;
  element.setAttribute("epoch", new Date(middle).toISOString());
  const rate = Number(state.get("rate") ?? 0);
  $("rate").value = [...$("rate").options].some((option) => Number(option.value) === rate) ? String(rate) : "0";
  element.setAttribute("rate", $("rate").value);
  elements = state.get("elements") ?? "";
}

function link() {
  const { view } = element.earth;
  const state = new URLSearchParams(VIEW.map((key) => [key, view[key].toFixed(DIGITS[key])]));
  state.set("t", new Date(element.epoch).toISOString());
  state.set("rate", element.rate);
  if (elements && elements.length <= LINK_TEXT) state.set("elements", elements);
  return new URL(`#${state}`, location.href).href;
}

function showSatellites(text) {
  try {
    const names = element.earth.setSatellites(text);
    elements = text;
    const shown = names.slice(0, 3).join(", ") + (names.length > 3 ? ` and ${names.length - 3} more` : "");
    notice(names.length ? `${shown}. Elements hold for some weeks around their date.` : "");
    const epoch = element.earth.elementsEpoch();
    if (epoch && Math.abs(epoch - element.epoch) > 30 * 86_400_000) setTime(epoch.getTime());
  } catch (error) {
    notice(error.message);
  }
}

function setTime(ms) {
  middle = ms;
  $("time").value = 0;
  element.epoch = new Date(ms);
}

const readFile = async (file) => showSatellites(await file.text());

restore();
element.addEventListener("ready", () => {
  if (elements) showSatellites(elements);
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
});
element.addEventListener("frame", (event) => {
  $("epoch").textContent = `${event.detail.epoch.toISOString().slice(0, 19).replace("T", " ")} UTC`;
});
element.addEventListener("error", (event) => notice(event.detail.message));

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
