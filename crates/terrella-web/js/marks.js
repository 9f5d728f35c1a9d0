// Stations, lines and times of satellites: the page's words and objects, and the numbers of the wasm functions.

/** Lines on the ground, in the order of the wasm function. */
export const LINES = ["coasts", "borders", "graticule", "twilight"];
/** Those that come from a file. */
export const MAPPED_LINES = ["coasts", "borders"];
/** What is drawn of satellites, likewise. */
export const TRACKS = ["markers", "trails", "ground-tracks", "subpoints", "footprints"];
/** Labels by the number of their kind. */
export const LABEL_KINDS = ["satellite", "station"];
/** Least elevation of a satellite that a station sees, degrees, by default. */
const MASK = 5;

/** Words of an array or a text. `what` completes "There is no …". */
export function chosenWords(words, known, what) {
  const chosen = (Array.isArray(words) ? words : String(words).split(/[\s,]+/)).filter((word) => word);
  const unknown = chosen.find((word) => !known.includes(word));
  if (unknown) throw new TypeError(`There is no ${what(unknown)}; write some of ${known.join(", ")}.`);
  return chosen;
}

/** Stations of an array or a text of JSON, with their defaults. */
export function wholeStations(stations) {
  let list = stations;
  if (typeof stations === "string") {
    try {
      list = stations.trim() ? JSON.parse(stations) : [];
    } catch (error) {
      throw new TypeError(`The stations are no JSON: ${error.message}.`);
    }
  }
  if (!Array.isArray(list)) throw new TypeError("The stations are no list; write [{ \"name\": \"Berlin\", \"lat\": 52.5, \"lon\": 13.4 }].");
  return list.map((station, index) => {
    const { name = "", lat, lon, altitude = 0, mask = MASK } = station ?? {};
    if (![lat, lon, altitude, mask].every(Number.isFinite)) {
      throw new TypeError(`Station ${index + 1} needs lat and lon as numbers, degrees; altitude (metres) and mask (degrees) are numbers too.`);
    }
    return { name: String(name), lat, lon, altitude, mask };
  });
}

export const stationNumbers = (stations) => Float64Array.from(stations.flatMap(({ lat, lon, mask, altitude }) => [lat, lon, mask, altitude]));

/** Rows of so many numbers. */
function* rows(numbers, width) {
  for (let i = 0; i < numbers.length; i += width) yield numbers.subarray(i, i + width);
}

const date = (ms) => new Date(ms);

export const passObjects = (numbers) =>
  Array.from(rows(numbers, 5), ([begin, highest, end, elevation, isVisible]) => ({
    begin: date(begin),
    highest: date(highest),
    end: date(end),
    elevation,
    isVisible: isVisible === 1,
  }));

export const spanObjects = (numbers) => Array.from(rows(numbers, 2), ([begin, end]) => ({ begin: date(begin), end: date(end) }));

/** Labels of a frame. `names` has those of satellites and of stations. */
export const labelObjects = (numbers, names) =>
  Array.from(rows(numbers, 4), ([kind, index, x, y]) => ({ kind: LABEL_KINDS[kind], index, name: names[kind][index], x, y }));
