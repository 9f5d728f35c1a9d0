//! The class that `terrella.js` wraps.

use crate::canvas::{Canvas, LOST};
use crate::eye::{Eye, View};
use crate::satellites;
use glam::DVec2;
use std::collections::HashMap;
use std::sync::Arc;
use terrella::celestial::{Celestial, CelestialMoment, CelestialOptions, StarCatalogue};
use terrella::frames::Orientation;
use terrella::orbit::{Feed, Sgp4Feed};
use terrella::tracks::{TrackMoment, Tracks, TracksOptions};
use terrella::{
    Earth, EarthOptions, Epoch, Exposure, FrameRequest, LayerSelection, MapUploader, Pipelines,
    Sky, load_layers_to,
};
use wasm_bindgen::prelude::{JsCast, JsValue, wasm_bindgen};
use wasm_bindgen_futures::JsFuture;

/// The file of stars among the maps.
const STARS: &str = "stars.bin";

/// An error of the page.
fn thrown(error: impl std::fmt::Display) -> JsValue {
    js_sys::Error::new(&error.to_string()).into()
}

#[wasm_bindgen(start)]
fn start() {
    // A panic would be an `unreachable` without words.
    std::panic::set_hook(Box::new(|panic| {
        web_sys::console::error_1(&JsValue::from_str(&format!("terrella: {panic}")));
    }));
}

/// The Earth on one canvas.
#[wasm_bindgen]
pub struct Globe {
    canvas: Canvas,
    earth: Earth,
    celestial: Celestial,
    eye: Eye,
    satellites: Vec<Sgp4Feed>,
    tracks: Option<Tracks>,
    is_complete: bool,
}

#[wasm_bindgen]
impl Globe {
    /// Opens a device for a canvas that has no context yet, and makes the Earth of maps: an object of `Uint8Array`s by the names of the
    /// starter maps (`day.jpg`, `clouds.jpg`, `elevation.png`, `night_lights.png`, `water.png`, `stars.bin`), of which the first must be
    /// there. `step` is called with a word before each long step and awaited, so that the page can draw meanwhile.
    ///
    /// # Errors
    /// A browser without an adapter, maps that cannot be read, a device without memory for them.
    pub async fn create(
        canvas: web_sys::HtmlCanvasElement,
        maps: js_sys::Object,
        samples: u32,
        anisotropy: u16,
        step: js_sys::Function,
    ) -> Result<Globe, JsValue> {
        let samples = if samples > 1 { 4 } else { 1 };
        let canvas = Canvas::open(canvas, samples).await.map_err(thrown)?;
        let mut files = HashMap::new();
        for entry in js_sys::Object::entries(&maps).iter() {
            let pair: js_sys::Array = entry.unchecked_into();
            let name = pair.get(0).as_string().unwrap_or_default();
            let bytes: js_sys::Uint8Array = pair.get(1).dyn_into().map_err(|_| {
                thrown(format!(
                    "the map {name} is no Uint8Array; give the bytes of its file"
                ))
            })?;
            files.insert(name, bytes.to_vec());
        }
        drop(maps);
        said(&step, "maps").await?;
        let has = |name: &str| files.contains_key(name);
        let selection = LayerSelection {
            clouds: has("clouds.jpg") || has("clouds.png"),
            normals: has("elevation.png"),
            night_lights: has("night_lights.png"),
            water: has("water.png"),
        };
        let stars = files.remove(STARS);
        let (device, queue) = (&canvas.device, &canvas.queue);
        let uploader = MapUploader::new(device, queue, Default::default());
        let (layers, damaged) = load_layers_to(&files, selection, &uploader).map_err(thrown)?;
        drop(files);
        if let Some(damaged) = damaged.into_iter().next() {
            return Err(thrown(damaged.error));
        }
        said(&step, "air").await?;
        let mut options = EarthOptions::new(layers);
        options.uploaded = uploader.finish().map_err(thrown)?;
        canvas.fit(&mut options);
        options.anisotropy = anisotropy;
        options.exposure = Exposure::Auto;
        options.pipelines = Pipelines::WhenNeeded;
        let earth = Earth::create(device, queue, &options)
            .await
            .map_err(thrown)?;
        said(&step, "sky").await?;
        let stars = stars.map(|bytes| StarCatalogue::from_bytes(&bytes));
        let what = CelestialOptions {
            stars: stars.transpose().map_err(thrown)?.map(Arc::new),
            sun: true,
            glare: true,
            ..CelestialOptions::NOTHING
        };
        let celestial = Celestial::new(device, queue, &earth, &what).map_err(thrown)?;
        let eye = Eye::new(&View {
            lat_deg: 0.0,
            lon_deg: 0.0,
            altitude_m: 2e7,
            heading_deg: 0.0,
            pitch_deg: -90.0,
            fov_deg: 40.0,
        });
        Ok(Self {
            canvas,
            earth,
            celestial,
            eye: eye.ok_or_else(|| thrown("the first view is not finite"))?,
            satellites: Vec::new(),
            tracks: None,
            is_complete: true,
        })
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
        self.earth.set_exposure(exposure).map_err(thrown)
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

    /// Draws the satellites of two-line elements or an OMM, or one of them by name or catalogue number; an empty text draws none. Returns their
    /// names.
    ///
    /// # Errors
    /// The error in the text, with its line. The satellites are then unchanged.
    #[wasm_bindgen(js_name = setSatellites)]
    pub fn set_satellites(
        &mut self,
        text: &str,
        name: Option<String>,
    ) -> Result<Vec<String>, JsValue> {
        let feeds = match text.trim().is_empty() {
            true => Vec::new(),
            false => satellites::read(text, name.as_deref()).map_err(thrown)?,
        };
        self.tracks = match feeds.is_empty() {
            true => None,
            false => {
                let styles = satellites::styles(feeds.len());
                let options = TracksOptions::of(&self.earth);
                Some(Tracks::new(&self.canvas.device, &options, &styles).map_err(thrown)?)
            }
        };
        self.satellites = feeds;
        let names = self.satellites.iter().map(|feed| feed.name().to_owned());
        Ok(names.collect())
    }

    /// The instant of a satellite's newest elements, milliseconds since 1970.
    #[wasm_bindgen(js_name = epochOf)]
    pub fn epoch_of(&self, satellite: usize) -> Option<f64> {
        let feed = self.satellites.get(satellite)?;
        Some(feed.epoch().to_unix_milliseconds())
    }

    /// Draws the frame of an instant, milliseconds since 1970 (UTC). Answers whether it is whole: curves of satellites grow over some frames.
    ///
    /// # Errors
    /// A canvas that gives no frame.
    pub fn draw(&mut self, unix_ms: f64) -> Result<bool, JsValue> {
        let epoch = Epoch::from_unix_milliseconds(unix_ms);
        let size = self.canvas.size();
        let view = self.eye.eye_view(size);
        let (queue, orientation) = (&self.canvas.queue, Orientation::default());
        let sky = Sky::at(epoch);
        self.earth
            .prepare(queue, FrameRequest::new(&view, &sky, size));
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
        self.is_complete = true;
        if let Some(tracks) = &mut self.tracks {
            let moment = TrackMoment {
                epoch,
                orientation,
                turn: None,
                view: &view,
                target: size.into(),
            };
            let feeds = self.satellites.iter().map(|feed| feed as &dyn Feed);
            self.is_complete = tracks.prepare(queue, &moment, feeds).is_complete;
        }
        let (earth, celestial, tracks) = (&self.earth, &self.celestial, &self.tracks);
        let drawn = self.canvas.draw(|pass| {
            earth.render_surface(pass);
            earth.render_air(pass);
            celestial.render(pass);
            earth.render_clouds_overhead(pass);
            if let Some(tracks) = tracks {
                tracks.render(pass);
            }
        });
        drawn.map_err(thrown)?;
        Ok(self.is_complete)
    }

    /// Where names of satellites belong in the frame drawn last: of each its place in the list, and x and y, pixels.
    pub fn labels(&self) -> Vec<f64> {
        let labels = self.tracks.iter().flat_map(|tracks| tracks.labels());
        let parts = labels.map(|label| {
            let [x, y] = label.at_px;
            [label.satellite as f64, x.into(), y.into()]
        });
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

/// Reports the next step to the page, and lets it draw.
async fn said(step: &js_sys::Function, what: &str) -> Result<(), JsValue> {
    let answer = step.call1(&JsValue::NULL, &JsValue::from_str(what))?;
    JsFuture::from(js_sys::Promise::resolve(&answer)).await?;
    Ok(())
}
