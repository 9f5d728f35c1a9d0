/** Bytes of a file, or its address. */
export type Source = string | URL | ArrayBuffer | ArrayBufferView;

/** Maps: the address of a folder with the starter maps, or sources by the names of its files. `day.jpg` must be there. */
export type Maps = string | URL | Record<string, Source>;

/** Sources of the wasm files, by backend. */
export type Wasm = Partial<Record<"webgpu" | "webgl", Source | WebAssembly.Module>>;

/** A camera over the globe: degrees, and metres above the ellipsoid. */
export interface View {
  /** Geodetic latitude of the eye, −90…90. */
  lat: number;
  /** Longitude of the eye, east positive. */
  lon: number;
  /** Height of the eye, metres. */
  altitude: number;
  /** Clockwise from north. */
  heading: number;
  /** Above the horizontal; −90 is straight down. */
  pitch: number;
  /** Vertical field of view, 0.1…150. */
  fov: number;
}

export interface Options {
  /** By default the folder `maps/` beside this module. */
  maps?: Maps;
  /** Small versions of the maps for the first picture; by default the folder `maps/preview/` beside this module, and none for other maps. */
  preview?: Maps;
  /** By default the files beside this module. */
  wasm?: Wasm;
  /** By default WebGPU where the browser has an adapter, else WebGL2. */
  backend?: "auto" | "webgpu" | "webgl";
  /** Samples a pixel, 1 or 4; by default 4. */
  samples?: 1 | 4;
  /** Most samples that a map is filtered with at a grazing view, 1…16; by default 8. */
  anisotropy?: number;
  /** Whether pointer, wheel and keys move the camera; by default they do. */
  controls?: boolean;
  /** The instant shown first, by default now. Snow and sea ice are those of its date. */
  epoch?: Date | number | string;
  /** Whether snow and sea ice are those of the date; by default they are. Otherwise they are those of the day map. */
  seasons?: boolean;
  /** Address of the folder of an imagery pack, drawn after the maps have come. */
  pack?: string | URL;
  /** Ends the loading. */
  signal?: AbortSignal;
  /** How much is loaded, 0…1, and what is going on. The first picture can be drawn at 0.5. */
  progress?: (part: number, what: string) => void;
}

/** A camera of another program: ITRF axes, metres, and the vertical field of view, degrees. */
export interface Camera {
  position: ArrayLike<number>;
  direction: ArrayLike<number>;
  up: ArrayLike<number>;
  fov: number;
}

/** A part of the picture that can be hidden. */
export type Layer = "clouds" | "lights" | "relief" | "water" | "air" | "sky";

/** Lines on the ground. `twilight` is the terminator, and the ends of civil, nautical and astronomical twilight. */
export type Lines = "coasts" | "borders" | "graticule" | "twilight";

/** What is drawn of satellites. */
export type TrackPart = "markers" | "trails" | "ground-tracks" | "subpoints" | "footprints";

/** How the camera rides on a satellite: at it, straight down or forwards to the limb, or some metres behind it. */
export type Ride = "nadir" | "horizon" | "chase";

/** A ground station. */
export interface Station {
  name?: string;
  /** Geodetic, degrees. */
  lat: number;
  /** Degrees, east positive. */
  lon: number;
  /** Metres above the ellipsoid; 0 by default. */
  altitude?: number;
  /** Least elevation of a satellite that it sees, degrees; 5 by default. */
  mask?: number;
}

/** A state that a simulator pushes. */
export interface Packet {
  /** UTC, RFC 3339, with up to nine decimals. */
  epoch: string;
  frame: "GCRF" | "EME2000" | "TEME" | "ITRF" | "PEF";
  /** Metres from the Earth's centre. */
  position_m: [number, number, number];
  /** Metres per second as seen in the frame. */
  velocity_m_s: [number, number, number];
  /** "live" by default. */
  name?: string;
}

/** A span of time of which a search finds something. */
export interface Search {
  /** Index of the satellite; 0 by default. */
  satellite?: number;
  /** By default the instant shown. */
  from?: Date | number | string;
  /** Length of the span; 24 by default, 744 at most. */
  hours?: number;
}

/** A pass of a satellite over a station. */
export interface Pass {
  begin: Date;
  highest: Date;
  end: Date;
  /** Greatest elevation, degrees. */
  elevation: number;
  /** Whether the satellite is in sunlight under a dark sky (the Sun 6° below the horizon) in some part of it. */
  isVisible: boolean;
}

/** An imagery pack. */
export interface PackAbout {
  name: string;
  /** Whom to name beside the picture, a line each. */
  attribution: string[];
}

/** What a click met. */
export interface Pick {
  x: number;
  y: number;
  /** The ground there, degrees; null beside the globe. */
  place: { lat: number; lon: number } | null;
  satellite: { index: number; name: string } | null;
  station: { index: number; name: string } | null;
}

/** A name beside a satellite or a station, in pixels of the canvas. */
export interface Label {
  kind: "satellite" | "station";
  index: number;
  name: string;
  x: number;
  y: number;
}

/** Events of an Earth. */
export interface TerrellaEarthEventMap {
  /** A frame was drawn. */
  frame: CustomEvent<{ epoch: Date }>;
  /** The view was changed, but not by `setCamera`. */
  viewchange: CustomEvent<null>;
  /** The whole maps are drawn. */
  complete: CustomEvent<null>;
  /** An imagery pack is drawn, or with null none any more. */
  pack: CustomEvent<PackAbout | null>;
  /** A scene is shown: its keys that a page does not have. */
  scene: CustomEvent<string[]>;
  /** Why tiles of the pack are missing, or null once they come again. Coarser ones are drawn in their place, and they are requested again. */
  tiles: CustomEvent<string | null>;
  /** A click. */
  pick: CustomEvent<Pick>;
  error: CustomEvent<Error>;
  /** Why the device was lost. Nothing is drawn any more; make another Earth on a new canvas. */
  devicelost: CustomEvent<string>;
}

/** Events of `<terrella-earth>`: those of its Earth, and those of its start. After `devicelost` it starts again by itself. */
export interface TerrellaEarthElementEventMap extends Omit<HTMLElementEventMap, "error" | "progress">, TerrellaEarthEventMap {
  /** How much is loaded, 0…1, and what is going on. */
  progress: CustomEvent<{ part: number; what: string }>;
  /** The first picture is drawn. */
  ready: CustomEvent<null>;
}

/** The Earth on a canvas. */
export class TerrellaEarth extends EventTarget {
  /** Loads maps and wasm, and makes the Earth on a canvas that has no context yet. */
  static create(canvas: HTMLCanvasElement, options?: Options): Promise<TerrellaEarth>;
  readonly backend: "webgpu" | "webgl";
  readonly adapter: string;
  /** Whether shaders are still to be compiled that draw the last picture faster. That happens while the page has nothing to do. */
  readonly compiling: boolean;
  /** Reading gives all numbers; what is assigned may have some of them. */
  get view(): View;
  set view(change: Partial<View>);
  /** Takes over the camera of another program, roll included, until the view is changed. */
  setCamera(camera: Camera): void;
  /** Parts that are not drawn. Takes text with blanks between the words too. */
  get hide(): Layer[];
  set hide(parts: Layer[] | string);
  /** "full" adds cloud shadows, moonlight, airglow and the Milky Way. */
  look: "standard" | "full";
  /** Pixels drawn for each of the canvas, along either axis: 0.25…1, or "auto", the default, which draws fewer while frames are slow. */
  resolution: number | "auto";
  /** Settles when the whole maps are drawn in place of the first, small ones. */
  readonly complete: Promise<void>;
  /**
   * The instant shown. Takes milliseconds since 1970 (UTC), RFC 3339 text, "now", and "live", which follows pushed states: 0.1 s behind them, so that late
   * ones still come in time, and at most a minute beyond the last.
   */
  get epoch(): Date;
  set epoch(epoch: Date | number | string);
  /** Whether the epoch is "live". */
  readonly isLive: boolean;
  /** Simulated seconds per second; 0 stands still, and nothing is drawn while nothing moves. With "live" it is the simulator's rate, and 0 is 1. */
  rate: number;
  /** Exposure value, −20…20, or "auto", which meters each frame and is the default. */
  exposure: number | "auto";
  /**
   * Address of the folder of an imagery pack; null without one. An address or null may be assigned: the event `pack` comes when it is drawn, and
   * `error` if it cannot be opened.
   */
  get pack(): string | null;
  set pack(address: string | URL | null);
  /** The same with a promise. It is undefined if another pack was set meanwhile. */
  setPack(address: string | URL | null): Promise<PackAbout | null | undefined>;
  /** Whether the last frame was drawn with all tiles that it needs. */
  readonly isSharp: boolean;
  /** Names of the satellites drawn. */
  readonly satellites: string[];
  /**
   * Draws the satellites of a text: two-line elements, OMM, OEM, CZML, SP3, an STK ephemeris or states in columns; with a name or catalogue number that
   * one alone; none of an empty text.
   */
  setSatellites(text: string, name?: string): string[];
  /** Draws satellites of a text beside the others. */
  addSatellites(text: string, name?: string): string[];
  /** What is drawn of satellites, or "auto", by their number, which is the default. Takes text with blanks between the words too. */
  get tracks(): TrackPart[] | "auto";
  set tracks(tracks: TrackPart[] | string);
  /** How the camera rides on the first satellite; "" for a camera over the ground, which every change of the view makes of it. */
  get follow(): Ride | "";
  set follow(how: Ride | "" | null);
  /** The same on a satellite of the list. */
  ride(how: Ride | "", satellite?: number): void;
  /** Address of the scene file that was set last; null without one. The event `scene` comes when it is shown, and `error` if it cannot be. */
  get scene(): string | null;
  set scene(address: string | URL | null);
  /** The same with a promise of the keys that a page does not have. It is undefined if another scene was set meanwhile. */
  setScene(address: string | URL | null): Promise<string[] | undefined>;
  /** Shows the text of a scene. Addresses of its files are relative to `base`, by default the page. */
  showScene(text: string, base?: string | URL): Promise<string[] | undefined>;
  /** The epoch of a satellite's elements, or that of its first state. */
  elementsEpoch(index?: number): Date | undefined;
  /**
   * Takes a state that a simulator pushes, or its line of JSON, and answers with the satellite's name. A new name becomes a new satellite. The last 256
   * states of each are kept. `setSatellites` removes pushed satellites too.
   */
  push(packet: Packet | string): string;
  /** Ground stations, each with the area in which it sees the first satellite, and a line to each satellite in view. Takes a text of JSON too. */
  get stations(): Required<Station>[];
  set stations(stations: Station[] | string);
  /** Lines drawn on the ground. Takes text with blanks between the words too. Coast lines and borders are loaded first. */
  get lines(): Lines[];
  set lines(lines: Lines[] | string);
  /** Passes of a satellite over a station, in order. */
  passes(search?: Search & { station?: number }): Pass[];
  /** The times at which a satellite is in the Earth's umbra, in order. */
  shadows(search?: Search): { begin: Date; end: Date }[];
  readonly labels: Label[];
  /** The ground under a pixel of the canvas, degrees; null beside the globe. */
  pick(x: number, y: number): { lat: number; lon: number } | null;
  /** The satellite whose marker is nearest to a pixel of the canvas, within so many pixels. */
  pickSatellite(x: number, y: number, within?: number): { index: number; name: string } | null;
  /** The station whose mark is nearest to a pixel of the canvas, within so many pixels. */
  pickStation(x: number, y: number, within?: number): { index: number; name: string } | null;
  /** Sends the event `pick` for a pixel of the canvas, as a click does. */
  click(x: number, y: number): void;
  /** Holds the place under a pixel for the drags that follow. */
  grab(x: number, y: number): void;
  drag(fromX: number, fromY: number, x: number, y: number): void;
  spin(x: number, y: number): void;
  /** Multiplies the distance; the place under the pixel stays there if it can. */
  approach(x: number, y: number, factor: number): void;
  tilt(x: number, y: number): void;
  northUp(): void;
  /** Follows the canvas to another size in pixels. */
  resize(width: number, height: number): void;
  /** Whether the canvas is in sight: out of sight nothing is drawn. */
  set isVisible(isVisible: boolean);
  invalidate(): void;
  /**
   * Draws now, in place of the frame that is due; answers whether the frame is whole. A page that calls it in each animation frame has its picture
   * together with those of other libraries, and no frame is drawn twice.
   */
  draw(ms?: number): boolean;
  toBlob(type?: string): Promise<Blob>;
  /** Gives memory and device back. */
  free(): void;
  addEventListener<K extends keyof TerrellaEarthEventMap>(
    type: K,
    listener: (this: TerrellaEarth, event: TerrellaEarthEventMap[K]) => void,
    options?: boolean | AddEventListenerOptions,
  ): void;
  addEventListener(type: string, listener: EventListenerOrEventListenerObject | null, options?: boolean | AddEventListenerOptions): void;
  removeEventListener<K extends keyof TerrellaEarthEventMap>(
    type: K,
    listener: (this: TerrellaEarth, event: TerrellaEarthEventMap[K]) => void,
    options?: boolean | EventListenerOptions,
  ): void;
  removeEventListener(type: string, listener: EventListenerOrEventListenerObject | null, options?: boolean | EventListenerOptions): void;
}

/**
 * `<terrella-earth>`. Attributes: `maps`, `preview`, `backend`, `samples`, `anisotropy`, `seasons`, `satellites` (an address), `satellite` (a name), which
 * are read at the start; and those that are properties too.
 */
export class TerrellaEarthElement extends HTMLElement {
  /** The Earth, once it is ready. */
  readonly earth: TerrellaEarth | null;
  /** To be set before the element is in the page. */
  maps: Maps | undefined;
  wasm: Wasm | undefined;
  lat: number;
  lon: number;
  altitude: number;
  heading: number;
  pitch: number;
  fov: number;
  epoch: Date | number | string;
  rate: number;
  exposure: number | "auto";
  look: "standard" | "full";
  hide: Layer[] | string;
  resolution: number | "auto";
  stations: Station[] | string;
  lines: Lines[] | string;
  tracks: TrackPart[] | string;
  follow: Ride | "" | null;
  pack: string | null;
  scene: string | null;
  /** As that of the Earth; before that is ready the state is dropped. */
  push(packet: Packet | string): string | undefined;
  /** Draws satellites now, or as soon as the Earth is ready. */
  setSatellites(text: string, name?: string): string[] | undefined;
  addEventListener<K extends keyof TerrellaEarthElementEventMap>(
    type: K,
    listener: (this: TerrellaEarthElement, event: TerrellaEarthElementEventMap[K]) => void,
    options?: boolean | AddEventListenerOptions,
  ): void;
  addEventListener(type: string, listener: EventListenerOrEventListenerObject, options?: boolean | AddEventListenerOptions): void;
  removeEventListener<K extends keyof TerrellaEarthElementEventMap>(
    type: K,
    listener: (this: TerrellaEarthElement, event: TerrellaEarthElementEventMap[K]) => void,
    options?: boolean | EventListenerOptions,
  ): void;
  removeEventListener(type: string, listener: EventListenerOrEventListenerObject, options?: boolean | EventListenerOptions): void;
}

declare global {
  interface HTMLElementTagNameMap {
    "terrella-earth": TerrellaEarthElement;
  }
}
