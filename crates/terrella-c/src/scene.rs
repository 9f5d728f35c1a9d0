//! Scene files, drawn at any instant.

use crate::failure::{Failure, TerrellaStatus, answer};
use crate::handles;
use crate::options::folder;
use crate::picture::{Draws, TerrellaDrawn, TerrellaFormat, draw_into, tell_drawn};
use crate::pointers::{check_out, text, text_if_any, write};
use crate::time::TerrellaTime;
use crate::truth::{TerrellaLayerBuffer, WantedLayers, depth_buffer};
use std::ffi::{c_char, c_void};
use std::path::Path;
use terrella::Drawing;
use terrella::frames::Epoch;
use terrella_orbit::Feed;
use terrella_play::scene::{Scene, SceneError};
use terrella_play::{ScenePictures, take_starter_files};

/// A scene file with its own device. An opaque handle. Any thread may use it; calls from several threads are serialised.
pub struct TerrellaScene {
    _private: [u8; 0],
}

const KIND: &str = "a scene";

/// Image size, playback time and satellites of a scene.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TerrellaSceneInfo {
    /// Width of pictures, pixels.
    pub width: u32,
    /// Height of pictures, pixels.
    pub height: u32,
    /// The first frame.
    pub start: TerrellaTime,
    /// Where playback ends.
    pub end: TerrellaTime,
    /// Frames of one playback.
    pub frames: u64,
    /// Frames per second of playback.
    pub frame_rate_hz: f64,
    /// Satellites.
    pub satellites: usize,
}

/// Reads a scene file and the files that it names, and opens a graphics adapter. In place of a scene `path` may name an orbit file of one
/// satellite, as for the command: the scene is then the default one with this satellite. `width` and `height` are the image size; with both
/// 0 it is the scene's. `textures` is the folder of default maps, null as in `TerrellaOptions`. `adapter` is a part of the adapter's name,
/// null takes the best. Free the scene with `terrella_scene_free`. On failure `*scene` is unchanged.
///
/// # Safety
/// Texts end with zero bytes; `scene` points to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_scene_open(
    path: *const c_char,
    width: u32,
    height: u32,
    textures: *const c_char,
    adapter: *const c_char,
    scene: *mut *mut TerrellaScene,
) -> TerrellaStatus {
    answer(|| {
        check_out(scene, "scene")?;
        // SAFETY: the caller's promise about its texts, here and below.
        let path = Path::new(unsafe { text(path, "path") }?);
        let read = Scene::load_or_orbits(path, &[]);
        // SAFETY: the same.
        unsafe { open(read, (width, height), textures, adapter, scene) }
    })
}

/// As `terrella_scene_open`, but from the text of a scene. Messages name `path`, and paths in the text are relative to its folder; the file
/// itself is not read.
///
/// # Safety
/// As `terrella_scene_open`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_scene_parse(
    toml: *const c_char,
    path: *const c_char,
    width: u32,
    height: u32,
    textures: *const c_char,
    adapter: *const c_char,
    scene: *mut *mut TerrellaScene,
) -> TerrellaStatus {
    answer(|| {
        check_out(scene, "scene")?;
        // SAFETY: the caller's promise about its texts, here and below.
        let toml = unsafe { text(toml, "toml") }?;
        // SAFETY: the same.
        let path = Path::new(unsafe { text(path, "path") }?);
        let read = Scene::from_toml(toml, path);
        // SAFETY: the same.
        unsafe { open(read, (width, height), textures, adapter, scene) }
    })
}

/// Opens a scene's inputs, and an adapter.
///
/// # Safety
/// Texts end with zero bytes; `scene` points to writable memory.
unsafe fn open(
    read: Result<Scene, SceneError>,
    size: (u32, u32),
    textures: *const c_char,
    adapter: *const c_char,
    scene: *mut *mut TerrellaScene,
) -> Result<(), Failure> {
    // SAFETY: the caller's promise about its texts, here and below.
    let textures = unsafe { text_if_any(textures, "textures") }?;
    // SAFETY: the same.
    let adapter = unsafe { text_if_any(adapter, "adapter") }?;
    let mut read =
        read.map_err(|error| Failure::new(TerrellaStatus::TERRELLA_SCENE, error.to_string()))?;
    take_starter_files(&mut read, &folder(textures, "textures")?);
    let size = Some(size).filter(|size| *size != (0, 0));
    let pictures = ScenePictures::of_scene(read, adapter, size)?;
    // SAFETY: the caller's promise.
    unsafe { write(scene, "scene", handles::insert(KIND, pictures)) }
}

/// Calls `work` with the images of a scene.
pub(crate) fn with_scene<T>(
    scene: *mut TerrellaScene,
    work: impl FnOnce(&mut ScenePictures) -> Result<T, Failure>,
) -> Result<T, Failure> {
    handles::with(scene, KIND, "scene", work)
}

/// Frees a scene. A null or freed handle is an error. Any thread may call it, as `terrella_earth_free`.
#[unsafe(no_mangle)]
pub extern "C" fn terrella_scene_free(scene: *mut TerrellaScene) -> TerrellaStatus {
    answer(|| handles::remove(scene, KIND, "scene"))
}

/// Image size, playback time and satellites of a scene.
///
/// # Safety
/// `info` points to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_scene_info(
    scene: *mut TerrellaScene,
    info: *mut TerrellaSceneInfo,
) -> TerrellaStatus {
    answer(|| {
        with_scene(scene, |pictures| {
            let (flight, (width, height)) = (pictures.flight(), pictures.size());
            let time = &flight.scene().time;
            let reported = TerrellaSceneInfo {
                width,
                height,
                start: TerrellaTime::of(time.start),
                end: TerrellaTime::of(time.end()),
                frames: time.frame_count(),
                frame_rate_hz: time.frame_rate_hz,
                satellites: flight.satellites().len(),
            };
            // SAFETY: the caller's promise.
            unsafe { write(info, "info", reported) }
        })
    })
}

/// Position and velocity of a satellite of a scene at an instant: Earth-fixed axes (ITRF), metres and metres per second, three numbers
/// each. The velocity is relative to the rotating Earth. `index` counts from 0 in the scene's order; `velocity_m_s` may be null.
///
/// # Safety
/// Each points to writable memory for three numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_scene_satellite(
    scene: *mut TerrellaScene,
    index: usize,
    time: TerrellaTime,
    position_m: *mut f64,
    velocity_m_s: *mut f64,
) -> TerrellaStatus {
    answer(|| {
        let epoch = time.epoch("time")?;
        let itrf = with_satellite(scene, index, |feed| Ok(feed.state_at(epoch)?.in_itrf()))?;
        // SAFETY: the caller's promise: room for three numbers.
        unsafe { write(position_m.cast(), "position_m", itrf.position_m.to_array()) }?;
        if velocity_m_s.is_null() {
            return Ok(());
        }
        // SAFETY: the same.
        unsafe {
            write(
                velocity_m_s.cast(),
                "velocity_m_s",
                itrf.velocity_m_s.to_array(),
            )
        }
    })
}

/// Calls `work` with the feed of a scene's satellite.
pub(crate) fn with_satellite<T>(
    scene: *mut TerrellaScene,
    index: usize,
    work: impl FnOnce(&dyn Feed) -> Result<T, Failure>,
) -> Result<T, Failure> {
    with_scene(scene, |pictures| {
        let satellites = pictures.flight().satellites();
        let satellite = satellites.get(index).ok_or_else(|| {
            Failure::argument(format!("index: {index} is not below {}", satellites.len()))
        })?;
        work(satellite.feed())
    })
}

struct Instant<'p> {
    pictures: &'p mut ScenePictures,
    epoch: Epoch,
}

impl Draws for Instant<'_> {
    fn size(&self) -> (u32, u32) {
        self.pictures.size()
    }

    fn color(&mut self, rgba: &mut [u8]) -> Result<Drawing, Failure> {
        Ok(self.pictures.draw_color(self.epoch, rgba)?)
    }

    fn light(&mut self, light: &mut [f32]) -> Result<Drawing, Failure> {
        Ok(self.pictures.draw_light(self.epoch, light)?)
    }
}

/// Draws an instant of a scene as the command `terrella` draws it, and writes it to `pixels` as `terrella_earth_draw` does. Waits for tiles
/// as long as the scene says. `drawn` may be null.
///
/// # Safety
/// As `terrella_earth_draw`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_scene_draw(
    scene: *mut TerrellaScene,
    time: TerrellaTime,
    format: TerrellaFormat,
    pixels: *mut c_void,
    bytes: usize,
    drawn: *mut TerrellaDrawn,
) -> TerrellaStatus {
    answer(|| {
        let epoch = time.epoch("time")?;
        with_scene(scene, |pictures| {
            let mut source = Instant { pictures, epoch };
            // SAFETY: the caller's promise.
            unsafe { draw_into(&mut source, format, pixels, bytes, drawn) }
        })
    })
}

/// As `terrella_earth_depth`, with the scene's camera: of the ground, without a spacecraft before it.
///
/// # Safety
/// As `terrella_earth_depth`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_scene_depth(
    scene: *mut TerrellaScene,
    time: TerrellaTime,
    depth_m: *mut f32,
    count: usize,
) -> TerrellaStatus {
    answer(|| {
        let epoch = time.epoch("time")?;
        with_scene(scene, |pictures| {
            // SAFETY: the caller's promise.
            let to = unsafe { depth_buffer(depth_m, count, pictures.size()) }?;
            let (truth, _) = pictures.draw_truth(epoch)?;
            to.copy_from_slice(&truth.depth_m());
            Ok(())
        })
    })
}

/// As `terrella_earth_truth`, with the scene's camera: of the ground, without a spacecraft before it.
///
/// # Safety
/// As `terrella_earth_truth`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_scene_truth(
    scene: *mut TerrellaScene,
    time: TerrellaTime,
    layers: *const TerrellaLayerBuffer,
    count: usize,
    drawn: *mut TerrellaDrawn,
) -> TerrellaStatus {
    answer(|| {
        let epoch = time.epoch("time")?;
        with_scene(scene, |pictures| {
            // SAFETY: the caller's promise.
            let wanted = unsafe { WantedLayers::read(layers, count, pictures.size()) }?;
            let (truth, drawing) = pictures.draw_truth(epoch)?;
            wanted.fill_from(&truth);
            // SAFETY: the caller's promise.
            unsafe { tell_drawn(drawn, &drawing) }
        })
    })
}
