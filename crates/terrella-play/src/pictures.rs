//! The pictures of a scene in memory, for programs that call the library and have no window.

use super::error::PlayError;
use super::flight::{Flight, Moment};
use super::offscreen::OffscreenRenderer;
use super::quality_control::scene_quality;
use super::raw_picture::RawPainter;
use super::seen_truth::seen_layers;
use super::sensor_bands::{SensorBands, SensorView};
use crate::scene::{BetweenMaps, Scene, SensorTable};
use std::path::Path;
use std::time::Duration;
use terrella::frames::Epoch;
use terrella::{
    Drawing, EarthOptions, Exposure, EyeView, FrameStats, GpuContext, LayerValues, OffscreenEarth,
    TruthLayer, TruthPicture,
};
use terrella_imagery::tile::TileKey;
use terrella_sensor::{RawFrame, Sensor};

/// Makes a scene use this folder for maps, stars and elevation data without a file name, instead of searching for the starter pack: for programs
/// that include one.
pub fn take_starter_files(scene: &mut Scene, folder: &Path) {
    let earth = &mut scene.earth;
    if earth.textures.is_none() && earth.pack.is_none() {
        earth.textures = Some(folder.to_owned());
    }
    if let Some(relief) = earth
        .relief
        .as_mut()
        .filter(|relief| relief.elevation.is_empty())
    {
        relief.elevation.push(folder.join("elevation.png"));
    }
    if scene.sky.folder.is_none() {
        scene.sky.folder = Some(folder.to_owned());
    }
    scene.layers.folder = Some(folder.to_owned());
}

/// Time, camera and exposure of an image; by default those of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// The instant.
    pub epoch: Epoch,
    /// Position and view of the eye; `None` is the scene's camera. A custom camera is not attached to a satellite: it needs no state at the time,
    /// and no spacecraft is drawn in front of it.
    pub view: Option<EyeView>,
    /// The exposure value; `None` is the scene's exposure.
    pub exposure_ev: Option<f64>,
}

impl From<Epoch> for Shot {
    /// With the scene's camera and exposure.
    fn from(epoch: Epoch) -> Self {
        Self {
            epoch,
            view: None,
            exposure_ev: None,
        }
    }
}

/// A scene with its own device, drawn into memory at any time.
///
/// As in [`OffscreenEarth`], the resources of a kind of image are created on the first request for it. Scenes whose time a simulator controls are
/// rejected: use the command for them.
pub struct ScenePictures {
    flight: Flight,
    gpu: GpuContext,
    size: (u32, u32),
    /// The maps, read with the first picture.
    options: Option<EarthOptions>,
    shown: Option<OffscreenRenderer>,
    light: Option<OffscreenRenderer>,
    truth: Option<(OffscreenEarth, Vec<BetweenMaps>)>,
    sensor: Option<Sensor>,
    raw: Option<RawPainter>,
}

impl ScenePictures {
    /// Reads a scene file, opens its files, and opens an adapter. `size` is width and height in pixels; `None` is the scene's.
    ///
    /// # Errors
    /// An error in the scene or its files; a live scene; no adapter.
    pub fn open(
        path: &Path,
        adapter: Option<&str>,
        size: Option<(u32, u32)>,
    ) -> Result<Self, PlayError> {
        Self::of_scene(Scene::load(path)?, adapter, size)
    }

    /// The same of a scene that is already read.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn of_scene(
        scene: Scene,
        adapter: Option<&str>,
        size: Option<(u32, u32)>,
    ) -> Result<Self, PlayError> {
        if let Some(live) = scene.orbits.iter().find_map(|orbit| orbit.live.as_ref()) {
            return Err(PlayError::Live {
                scene: scene.path.clone(),
                listens_on: live.transport.to_string(),
                work: "no other instant can be drawn",
                remedy: "play it with the command `terrella`",
            });
        }
        let flight = Flight::open(scene)?;
        let gpu = OffscreenEarth::open_gpu(adapter)?;
        let size = size.unwrap_or(flight.scene().output.size.into());
        terrella::internals::offscreen::check_size(&gpu, size)?;
        Ok(Self {
            flight,
            gpu,
            size,
            options: None,
            shown: None,
            light: None,
            truth: None,
            sensor: None,
            raw: None,
        })
    }

    /// The scene made ready.
    pub fn flight(&self) -> &Flight {
        &self.flight
    }

    /// Adapter, device and queue.
    pub fn gpu(&self) -> &GpuContext {
        &self.gpu
    }

    /// Width and height of the pictures, pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The view that is pictured.
    ///
    /// # Errors
    /// An instant at which the satellite that the scene's camera flies with is not known.
    pub fn moment(&self, shot: impl Into<Shot>) -> Result<Moment, PlayError> {
        let shot = shot.into();
        let mut moment = match shot.view {
            None => self.flight.at(shot.epoch, self.aspect())?,
            Some(view) => Moment {
                epoch: shot.epoch,
                frame: self.flight.scene().time.nearest_frame(shot.epoch),
                view,
                sky: self.flight.sky_at(shot.epoch),
                satellite: None,
                craft: None,
                eye_velocity_m_s: None,
                turn: None,
                is_starless: false,
                exposure_ev: None,
                shot: 0,
            },
        };
        moment.exposure_ev = shot.exposure_ev.or(moment.exposure_ev);
        Ok(moment)
    }

    /// Width over height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.size.0) / f64::from(self.size.1)
    }

    /// Draws a moment as displayed colour into `rgba`: four bytes a pixel, rows from the top. It includes all layers of the scene: spacecraft, sky,
    /// tracks and names. Waits for tiles up to the scene's timeout.
    ///
    /// # Errors
    /// A time at which the satellite has no state, maps that cannot be read, a buffer of the wrong length, or a device that is out of memory.
    pub fn draw_color(
        &mut self,
        shot: impl Into<Shot>,
        rgba: &mut [u8],
    ) -> Result<Drawing, PlayError> {
        self.check_buffer(rgba.len())?;
        let moment = self.moment(shot)?;
        let wait = self.flight.scene().output.wait();
        let exposure = match moment.exposure_ev {
            Some(ev) => Exposure::Ev(ev),
            None => self.options()?.exposure,
        };
        let shown = self.shown()?;
        shown.set_exposure(exposure)?;
        let drawing = draw(shown, &moment, wait);
        shown.read_into(rgba)?;
        Ok(drawing)
    }

    /// Draws the light of an instant and writes it to `light`: four 32-bit floats a pixel, scene-referred and linear. Tracks are no
    /// light and are not in it; the ground is without made detail.
    ///
    /// # Errors
    /// As [`Self::draw_color`].
    pub fn draw_light(
        &mut self,
        shot: impl Into<Shot>,
        light: &mut [f32],
    ) -> Result<Drawing, PlayError> {
        self.check_buffer(light.len())?;
        let moment = self.moment(shot)?;
        let wait = self.flight.scene().output.wait();
        let renderer = match self.light.take() {
            Some(renderer) => renderer,
            None => {
                let mut options = self.options()?.clone();
                // Measurements use data only.
                options.light.detail = false;
                let gpu = self.gpu.clone();
                let mut made = OffscreenRenderer::open_for_radiance(gpu, options, self.size)?;
                made.show_dated_maps(&self.flight)?;
                made.show_models(&self.flight)?;
                made.show_sky(&self.flight)?;
                made
            }
        };
        let renderer = self.light.insert(renderer);
        let drawing = draw(renderer, &moment, wait);
        renderer.read_light_into(light)?;
        Ok(drawing)
    }

    /// Draws what is where each pixel of an instant looks: of the Earth alone, without craft.
    ///
    /// # Errors
    /// As [`Self::draw_color`].
    pub fn draw_truth(
        &mut self,
        shot: impl Into<Shot>,
    ) -> Result<(TruthPicture, Drawing), PlayError> {
        let moment = self.moment(shot)?;
        let epoch = moment.epoch;
        let wait = self.flight.scene().output.wait();
        let dated = self.flight.scene().earth.dated_maps.iter();
        let maps: Vec<_> = dated.map(|maps| maps.at(epoch)).collect();
        let made = self.truth.take().filter(|(_, made_for)| *made_for == maps);
        let earth = match made {
            Some((earth, _)) => earth,
            None => {
                let options = match maps.is_empty() {
                    true => self.options()?.clone(),
                    // It has no maps that pass into each other.
                    false => self.flight.uploaded_options_at(epoch, &self.gpu)?,
                };
                OffscreenEarth::new(self.gpu.clone(), options, self.size)?
            }
        };
        let (earth, _) = self.truth.insert((earth, maps));
        Ok(earth.draw_truth(&moment.view, &moment.sky, wait)?)
    }

    /// Width and height of the scene's sensor, pixels: of its raw frames and their truth.
    ///
    /// # Errors
    /// A scene without a sensor.
    pub fn sensor_size(&self) -> Result<(u32, u32), PlayError> {
        Ok(self.sensor_table()?.size().into())
    }

    /// Draws the raw frame of the scene's sensor at a time: with the scene's camera it is the frame of `terrella frame --raw`. Its size is the
    /// sensor's. A custom camera is at rest while rows are exposed; its field of view and exposure are the sensor's. Also returns the tiles that
    /// its light lacks.
    ///
    /// # Errors
    /// A scene without a sensor; a time at which the satellite has no state, maps that cannot be read, or a device that is out of memory.
    pub fn draw_raw(
        &mut self,
        shot: impl Into<Shot>,
    ) -> Result<(RawFrame, Vec<TileKey>), PlayError> {
        let (seen, moment) = self.seen(shot.into())?;
        let mut painter = match self.raw.take() {
            Some(painter) => painter,
            None => {
                let options = self.options()?.clone();
                RawPainter::new(&self.flight, self.gpu.clone(), options)?
            }
        };
        let drawn = painter.draw(&seen, &moment);
        self.raw = Some(painter);
        let picture = drawn?;
        Ok((picture.raw, picture.missing))
    }

    /// Draws what is where each pixel of the scene's sensor looks at an instant, through its lens and row by row: some layers, in their
    /// order, of the sensor's size, and tiles that are missing. The ground's maps are uploaded for each call.
    ///
    /// # Errors
    /// As [`Self::draw_raw`].
    pub fn draw_raw_truth(
        &mut self,
        shot: impl Into<Shot>,
        wanted: &[&TruthLayer],
    ) -> Result<(Vec<LayerValues>, Vec<TileKey>), PlayError> {
        let shot = shot.into();
        let epoch = shot.epoch;
        let (seen, _) = self.seen(shot)?;
        let options = match self.flight.scene().earth.dated_maps.is_empty() {
            true => self.options()?.clone(),
            false => self.flight.uploaded_options_at(epoch, &self.gpu)?,
        };
        seen_layers(&self.flight, &self.gpu, options, &seen, wanted)
    }

    fn sensor_table(&self) -> Result<&SensorTable, PlayError> {
        let scene = self.flight.scene();
        let lacks = || PlayError::NoSensor {
            scene: scene.path.clone(),
        };
        scene.sensor.as_ref().ok_or_else(lacks)
    }

    /// The sensor's view at a time, and the moment of its first row.
    fn seen(&mut self, shot: Shot) -> Result<(SensorView, Moment), PlayError> {
        let sensor = match self.sensor.take() {
            Some(sensor) => sensor,
            None => self.sensor_table()?.open()?,
        };
        let sensor = self.sensor.insert(sensor).clone();
        let [width, height] = self.flight.scene().output.size;
        let aspect = f64::from(width) / f64::from(height);
        let (moment, bands) = match shot.view {
            None => {
                let moment = self.flight.at(shot.epoch, aspect)?;
                let bands = SensorBands::new(&self.flight, &sensor, &moment, aspect, &self.gpu)?;
                (moment, bands)
            }
            Some(_) => {
                let at = |epoch| self.moment(Shot { epoch, ..shot });
                let ellipsoid = self.flight.ellipsoid();
                let moment = at(shot.epoch)?;
                let bands = SensorBands::along(&at, ellipsoid, &sensor, &moment, &self.gpu)?;
                (moment, bands)
            }
        };
        Ok((SensorView { sensor, bands }, moment))
    }

    fn options(&mut self) -> Result<&EarthOptions, PlayError> {
        let options = match self.options.take() {
            Some(options) => options,
            None => self.flight.uploaded_options(&self.gpu)?,
        };
        Ok(self.options.insert(options))
    }

    fn shown(&mut self) -> Result<&mut OffscreenRenderer, PlayError> {
        let renderer = match self.shown.take() {
            Some(renderer) => renderer,
            None => {
                let options = self.options()?.clone();
                let flight = &self.flight;
                let mut made = OffscreenRenderer::open(self.gpu.clone(), options, self.size)?;
                made.show_dated_maps(flight)?;
                made.show_models(flight)?;
                made.show_sky(flight)?;
                made.show_tracks(flight)?;
                made.show_captions(flight)?;
                let quality = scene_quality(&flight.scene().quality, *made.earth().quality());
                made.set_quality(&quality)?;
                made
            }
        };
        Ok(self.shown.insert(renderer))
    }

    fn check_buffer(&self, got: usize) -> Result<(), PlayError> {
        Ok(terrella::internals::offscreen::check_length(
            self.size, 4, got,
        )?)
    }
}

fn draw(renderer: &mut OffscreenRenderer, moment: &Moment, wait: Duration) -> Drawing {
    let (stats, missing): (FrameStats, Vec<TileKey>) = renderer.draw_complete(moment, wait);
    Drawing { stats, missing }
}
