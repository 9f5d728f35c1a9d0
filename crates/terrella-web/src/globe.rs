//! The classes that `earth.js` wraps.

mod marks;
mod pack;

use crate::canvas::{Canvas, LOST, Submitted};
use crate::compact::restore;
use crate::eye::{Eye, View};
use crate::maps::Incoming;
use crate::overlay::Overlay;
use crate::ride::Ride;
use crate::thrown;
use glam::{DVec2, DVec3};
use pack::PageTiles;
pub use pack::{PackOpening, PreparedEarth};
use std::sync::Arc;
use terrella::celestial::{Celestial, CelestialMoment, CelestialOptions, StarCatalogue};
use terrella::frames::Orientation;
use terrella::tracks::TrackMoment;
use terrella::{
    Atmosphere, CityLights, Earth, EarthOptions, Epoch, Exposure, FrameRequest, LayerImage,
    MapLayer, Pipelines, Sky, supply_air_tables, supply_detail_tiles,
};
use wasm_bindgen::prelude::{JsValue, wasm_bindgen};

#[wasm_bindgen(start)]
fn start() {
    // A panic would be an `unreachable` without words.
    std::panic::set_hook(Box::new(|panic| {
        web_sys::console::error_1(&JsValue::from_str(&format!("terrella: {panic}")));
    }));
}

/// Takes the tables of the air, as `cargo xtask web` writes them and inflated, and the tiles of synthetic detail. Once in a page, before the first Earth.
///
/// # Errors
/// Files of another version.
#[wasm_bindgen]
pub fn supply(air: &[u8], detail_tiles: &[u8]) -> Result<(), JsValue> {
    supply_air_tables(&restore(air)).map_err(thrown)?;
    supply_detail_tiles(detail_tiles).map_err(thrown)
}

/// A canvas with a device, before the Earth is made.
#[wasm_bindgen]
pub struct Opening {
    canvas: Canvas,
    anisotropy: u16,
    incoming: Incoming,
}

#[wasm_bindgen]
impl Opening {
    /// Opens a device for a canvas that has no context yet.
    ///
    /// # Errors
    /// A browser without an adapter or a device.
    pub async fn open(
        canvas: web_sys::HtmlCanvasElement,
        samples: u32,
        anisotropy: u16,
    ) -> Result<Opening, JsValue> {
        let samples = if samples > 1 { 4 } else { 1 };
        let canvas = Canvas::open(canvas, samples).await.map_err(thrown)?;
        let incoming = Incoming::new(&canvas.device, &canvas.queue);
        Ok(Self {
            canvas,
            anisotropy,
            incoming,
        })
    }

    /// Uploads a band of rows of a map: arguments as [`crate::decode_maps`] gives them.
    ///
    /// # Errors
    /// A map that is too large for the device, city lights of another version.
    pub fn band(
        &mut self,
        map: usize,
        width: u32,
        height: u32,
        level: i32,
        first: u32,
        texels: &[u8],
    ) -> Result<(), JsValue> {
        let device = &self.canvas.device;
        let (map, rows) = ((map, width, height), (level, first));
        let taken = self.incoming.band(device, map, rows, texels);
        taken.map_err(thrown)
    }

    /// Makes the Earth of the maps that came, with the stars of a catalogue's file.
    ///
    /// # Errors
    /// Maps without a day map, stars that cannot be read, a device without memory.
    pub async fn finish(self, stars: Option<Vec<u8>>) -> Result<Globe, JsValue> {
        let maps = self.incoming.finish().map_err(thrown)?;
        let canvas = self.canvas;
        let mut options = EarthOptions::new(maps.layers);
        options.uploaded = maps.uploaded;
        options.city_lights = maps.city_lights;
        canvas.fit(&mut options);
        options.anisotropy = self.anisotropy;
        options.exposure = Exposure::Auto;
        options.pipelines = Pipelines::Gradually;
        let (device, queue) = (&canvas.device, &canvas.queue);
        let earth = Earth::create(device, queue, &options)
            .await
            .map_err(thrown)?;
        let stars = stars.map(|bytes| StarCatalogue::from_bytes(&bytes));
        let in_sky = CelestialOptions {
            stars: stars.transpose().map_err(thrown)?.map(Arc::new),
            sun: true,
            moon: maps.moon,
            glare: true,
            ..CelestialOptions::NOTHING
        };
        let celestial = Celestial::new(device, queue, &earth, &in_sky).map_err(thrown)?;
        let eye = Eye::new(&View {
            lat_deg: 0.0,
            lon_deg: 0.0,
            altitude_m: 2e7,
            heading_deg: 0.0,
            pitch_deg: -90.0,
            fov_deg: 40.0,
        });
        Ok(Globe {
            canvas,
            options,
            earth,
            tiles: PageTiles::default(),
            in_sky,
            milky_way: maps.milky_way,
            celestial,
            incoming: None,
            city_lights: None,
            awaited: None,
            eye: eye.ok_or_else(|| thrown("the first view is not finite"))?,
            followed: 0,
            overlay: Overlay::default(),
            has_sky: true,
            is_complete: true,
        })
    }
}

/// The Earth on one canvas.
#[wasm_bindgen]
pub struct Globe {
    canvas: Canvas,
    /// Those of an Earth of the page's own maps, without a pack.
    options: EarthOptions,
    earth: Earth,
    tiles: PageTiles,
    in_sky: CelestialOptions,
    /// Its map: drawn with all effects only.
    milky_way: Option<Arc<LayerImage>>,
    celestial: Celestial,
    /// Finer maps that are coming.
    incoming: Option<Incoming>,
    /// City lights that came with maps and are not drawn yet.
    city_lights: Option<Arc<CityLights>>,
    /// Work that the page waits for.
    awaited: Option<Submitted>,
    eye: Eye,
    /// Index of the satellite that the eye rides on.
    followed: usize,
    overlay: Overlay,
    /// Whether stars and Sun are drawn.
    has_sky: bool,
    is_complete: bool,
}

#[wasm_bindgen]
impl Globe {
    /// Uploads a band of rows of a finer map, as [`Opening::band`] does.
    ///
    /// # Errors
    /// A map that is too large for the device, city lights of another version.
    pub fn band(
        &mut self,
        map: usize,
        width: u32,
        height: u32,
        level: i32,
        first: u32,
        texels: &[u8],
    ) -> Result<(), JsValue> {
        let (device, queue) = (&self.canvas.device, &self.canvas.queue);
        let incoming = self
            .incoming
            .get_or_insert_with(|| Incoming::new(device, queue));
        let (map, rows) = ((map, width, height), (level, first));
        incoming.band(device, map, rows, texels).map_err(thrown)
    }

    /// Whether the device has done all work that was submitted before the first of these calls. A `true` ends a series of calls. An upload to a busy device
    /// stops the page.
    #[wasm_bindgen(js_name = isIdle)]
    pub fn is_idle(&mut self) -> bool {
        let awaited = self.awaited.get_or_insert_with(|| self.canvas.submitted());
        let is_done = awaited.is_done(&self.canvas.device);
        if is_done {
            self.awaited = None;
        }
        is_done
    }

    /// Whether there is a pipeline that makes the last image faster.
    #[wasm_bindgen(js_name = hasNextPipeline)]
    pub fn has_next_pipeline(&self) -> bool {
        self.earth.has_next_pipeline()
    }

    /// Creates one of them.
    #[wasm_bindgen(js_name = makeNextPipeline)]
    pub fn make_next_pipeline(&mut self) {
        self.earth.make_next_pipeline();
    }

    /// Draws with the finer maps that came, from the next frame on.
    ///
    /// # Errors
    /// A map that the Earth has not, or that the device rejected.
    #[wasm_bindgen(js_name = setMaps)]
    pub fn set_maps(&mut self) -> Result<(), JsValue> {
        let Some(incoming) = self.incoming.take() else {
            return Ok(());
        };
        let maps = incoming.finish().map_err(thrown)?;
        self.earth
            .set_maps(&self.canvas.queue, &maps.uploaded)
            .map_err(thrown)?;
        self.options.replace_uploaded(maps.layers, maps.uploaded);
        self.city_lights = maps.city_lights;
        self.in_sky.moon = maps.moon.or(self.in_sky.moon.take());
        self.milky_way = maps.milky_way.or(self.milky_way.take());
        self.fill_sky()
    }

    /// Draws city lights that came with the maps as points, from the next frame on. This compiles a shader, as [`Self::set_maps`] does: in one task
    /// both would take too long.
    ///
    /// # Errors
    /// A shader that the device rejected.
    #[wasm_bindgen(js_name = setCityLights)]
    pub fn set_city_lights(&mut self) -> Result<(), JsValue> {
        let Some(lights) = self.city_lights.take() else {
            return Ok(());
        };
        let queue = &self.canvas.queue;
        let given = self.earth.set_city_lights(queue, lights.clone());
        given.map_err(thrown)?;
        self.options.city_lights = Some(lights);
        Ok(())
    }

    /// Draws what there is in the sky from the next frame on.
    fn fill_sky(&mut self) -> Result<(), JsValue> {
        let is_full = self.earth.appearance().light.moonlight;
        self.in_sky.milky_way = self.milky_way.clone().filter(|_| is_full);
        let (device, queue) = (&self.canvas.device, &self.canvas.queue);
        let (earth, celestial) = (&self.earth, &mut self.celestial);
        celestial
            .set_options(device, queue, earth, &self.in_sky)
            .map_err(thrown)
    }

    /// The backend and the adapter as text.
    pub fn adapter(&self) -> String {
        self.canvas.adapter.clone()
    }

    /// Resizes with the canvas, pixels.
    ///
    /// # Errors
    /// An invalid shader.
    pub fn resize(&mut self, width: u32, height: u32) -> Result<(), JsValue> {
        self.canvas.resize(width, height).map_err(thrown)
    }

    /// Sets the camera: degrees and metres. Returns false for non-finite values, which change nothing.
    #[wasm_bindgen(js_name = setView)]
    pub fn set_view(
        &mut self,
        lat: f64,
        lon: f64,
        altitude: f64,
        heading: f64,
        pitch: f64,
        fov: f64,
    ) -> bool {
        let eye = Eye::new(&View {
            lat_deg: lat,
            lon_deg: lon,
            altitude_m: altitude,
            heading_deg: heading,
            pitch_deg: pitch,
            fov_deg: fov,
        });
        self.eye = eye.unwrap_or(self.eye);
        eye.is_some()
    }

    /// Latitude, longitude, altitude, heading, pitch and field of view, degrees and metres.
    pub fn view(&self) -> Vec<f64> {
        let view = self.eye.view();
        vec![
            view.lat_deg,
            view.lon_deg,
            view.altitude_m,
            view.heading_deg,
            view.pitch_deg,
            view.fov_deg,
        ]
    }

    /// Sets the camera of another program: its place and axes in ITRF, metres, and its vertical field of view, degrees. Returns false for axes that
    /// are no camera, which change nothing. The next change of the view ends it.
    #[wasm_bindgen(js_name = setCamera)]
    pub fn set_camera(
        &mut self,
        position: &[f64],
        direction: &[f64],
        up: &[f64],
        fov: f64,
    ) -> bool {
        let axes =
            [position, direction, up].map(|axis| axis.try_into().ok().map(DVec3::from_array));
        let [Some(position), Some(direction), Some(up)] = axes else {
            return false;
        };
        let eye = self.eye.free(position, direction, up, fov);
        self.eye = eye.unwrap_or(self.eye);
        eye.is_some()
    }

    /// Rides on a satellite: "nadir", "horizon" or "chase"; with another word the camera stays where it is. The next change of the view ends it.
    #[wasm_bindgen(js_name = setFollow)]
    pub fn set_follow(&mut self, how: &str, satellite: usize) {
        self.eye.set_ride(Ride::named(how));
        self.followed = satellite;
    }

    /// Whether the camera rides on a satellite.
    #[wasm_bindgen(js_name = isFollowing)]
    pub fn is_following(&self) -> bool {
        self.eye.ride().is_some()
    }

    /// Shows or hides parts of the Earth: clouds, night lights, terrain normals, water, atmosphere, stars and Sun.
    ///
    /// # Errors
    /// A device that cannot draw it so. Nothing has then changed.
    #[wasm_bindgen(js_name = setLayers)]
    pub fn set_layers(
        &mut self,
        clouds: bool,
        lights: bool,
        relief: bool,
        water: bool,
        air: bool,
        sky: bool,
    ) -> Result<(), JsValue> {
        let mut quality = self.earth.quality().clone();
        for (layer, is_shown) in [
            (MapLayer::Clouds, clouds),
            (MapLayer::NightLights, lights),
            (MapLayer::Normals, relief),
            (MapLayer::Water, water),
        ] {
            quality.maps[layer.index()] = is_shown;
        }
        quality.atmosphere = match air {
            true => Atmosphere::Billboard,
            false => Atmosphere::None,
        };
        self.earth
            .set_quality(&self.canvas.queue, &quality)
            .map_err(thrown)?;
        self.has_sky = sky;
        let (device, queue) = (&self.canvas.device, &self.canvas.queue);
        self.celestial
            .follow(device, queue, &self.earth)
            .map_err(thrown)?;
        self.overlay.follow(&self.earth).map_err(thrown)
    }

    /// Draws with all effects, or with the inexpensive ones of the default.
    ///
    /// # Errors
    /// A device that cannot draw it so. Nothing has then changed.
    #[wasm_bindgen(js_name = setFull)]
    pub fn set_full(&mut self, is_full: bool) -> Result<(), JsValue> {
        let mut appearance = self.earth.appearance().clone();
        appearance.light.cloud_shadows = is_full;
        appearance.light.moonlight = is_full;
        appearance.light.airglow = is_full;
        self.earth
            .set_appearance(&self.canvas.queue, &appearance)
            .map_err(thrown)?;
        self.fill_sky()?;
        self.overlay.follow(&self.earth).map_err(thrown)
    }

    /// Draws so many pixels for each of the canvas, along either axis: 0.25 to 1.
    ///
    /// # Errors
    /// An invalid shader.
    #[wasm_bindgen(js_name = setScale)]
    pub fn set_scale(&mut self, scale: f64) -> Result<(), JsValue> {
        self.canvas.set_scale(scale).map_err(thrown)
    }

    /// Exposure value; not a number meters each frame.
    ///
    /// # Errors
    /// A value outside the range.
    #[wasm_bindgen(js_name = setExposure)]
    pub fn set_exposure(&mut self, ev: f64) -> Result<(), JsValue> {
        let exposure = if ev.is_nan() {
            Exposure::Auto
        } else {
            Exposure::Ev(ev)
        };
        self.earth.set_exposure(exposure).map_err(thrown)?;
        self.options.exposure = exposure;
        Ok(())
    }

    /// Latitude and longitude of the ground under a pixel, degrees; none beside the globe.
    pub fn pick(&self, x: f64, y: f64) -> Option<Vec<f64>> {
        let place = self.eye.place_at(self.canvas.size(), DVec2::new(x, y));
        place.map(Vec::from)
    }

    /// A drag begins at a pixel.
    pub fn grab(&mut self, x: f64, y: f64) {
        self.eye.grab(self.canvas.size(), DVec2::new(x, y));
    }

    /// The pointer has moved: the grabbed place comes under it.
    pub fn drag(&mut self, from_x: f64, from_y: f64, x: f64, y: f64) {
        let (from, to) = (DVec2::new(from_x, from_y), DVec2::new(x, y));
        self.eye.drag(self.canvas.size(), from, to);
    }

    /// Turns the globe by pixels of a drag that holds no place.
    pub fn spin(&mut self, x: f64, y: f64) {
        self.eye.let_go();
        let by = DVec2::new(x, y);
        self.eye.drag(self.canvas.size(), DVec2::ZERO, by);
    }

    /// Multiplies the distance; the place under the pixel stays there if it can.
    pub fn approach(&mut self, x: f64, y: f64, factor: f64) {
        self.eye
            .approach(self.canvas.size(), DVec2::new(x, y), factor);
    }

    /// Moves around the place in the middle by pixels of a drag.
    pub fn tilt(&mut self, x: f64, y: f64) {
        self.eye.tilt(self.canvas.size(), DVec2::new(x, y));
    }

    /// North upwards.
    #[wasm_bindgen(js_name = northUp)]
    pub fn north_up(&mut self) {
        self.eye.north_up(self.canvas.size());
    }

    /// Draws the frame of an instant, milliseconds since 1970 (UTC). Answers whether it is whole: curves of satellites grow over some frames, and
    /// tiles that have come are drawn in the next one.
    ///
    /// # Errors
    /// A canvas that gives no frame.
    pub fn draw(&mut self, unix_ms: f64) -> Result<bool, JsValue> {
        let epoch = Epoch::from_unix_milliseconds(unix_ms);
        let followed = self.overlay.satellites.get(self.followed);
        if let (Some(ride), Some(satellite)) = (self.eye.ride(), followed)
            && let Some(pose) = ride.pose(satellite.feed(), epoch, self.eye.fov_rad())
        {
            self.eye = self.eye.carried(&pose);
        }
        let size = self.canvas.drawn_size();
        let view = self.eye.eye_view(size);
        let (queue, orientation) = (&self.canvas.queue, Orientation::default());
        let sky = Sky::at(epoch);
        let frame = FrameRequest::new(&view, &sky, size);
        let stats = self.earth.prepare(queue, frame);
        let has_new_tiles = self.tiles.note_uploads(&stats.tiles);
        self.celestial.prepare(
            queue,
            &self.earth,
            &CelestialMoment {
                epoch,
                orientation,
                view: &view,
                target: size.into(),
                velocity_m_s: None,
            },
        );
        let moment = TrackMoment {
            epoch,
            orientation,
            turn: None,
            view: &view,
            target: size.into(),
        };
        self.is_complete = self.overlay.prepare(queue, &moment, &sky) && !has_new_tiles;
        let (earth, celestial, overlay) = (&self.earth, &self.celestial, &self.overlay);
        let has_sky = self.has_sky;
        let drawn = self.canvas.draw(|pass| {
            earth.render_surface(pass);
            earth.render_air(pass);
            if has_sky {
                celestial.render(pass);
            }
            earth.render_clouds_overhead(pass);
            overlay.render(pass);
        });
        drawn.map_err(thrown)?;
        Ok(self.is_complete)
    }

    /// Where names belong in the frame drawn last: of each 0 for a satellite or 1 for a station, its place in the list, and x and y, pixels.
    pub fn labels(&self) -> Vec<f64> {
        let scale = f64::from(self.canvas.drawn_size().0) / f64::from(self.canvas.size().0);
        let labels = self.overlay.labels();
        let parts = labels.map(|[kind, index, x, y]| [kind, index, x / scale, y / scale]);
        parts.flatten().collect()
    }

    /// Errors of the device since the last call.
    #[wasm_bindgen(js_name = takeFaults)]
    pub fn take_faults(&self) -> Vec<String> {
        self.canvas.faults.take()
    }

    /// Prefix of an error after which no frame can be drawn.
    #[wasm_bindgen(js_name = lostPrefix)]
    pub fn lost_prefix() -> String {
        LOST.to_owned()
    }

    /// Releases the device immediately; nothing can be drawn any more.
    pub fn destroy(&self) {
        self.canvas.device.destroy();
    }
}
