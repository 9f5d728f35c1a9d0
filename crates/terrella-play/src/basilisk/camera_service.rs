//! Images that a simulation's own cameras request. They are drawn on a separate thread and device, independently of all other rendering.

use super::depth::{USUAL_CLIP_M, depth_map};
use crate::error::PlayError;
use crate::flight::{Flight, Moment};
use crate::offscreen::OffscreenRenderer;
use crate::quality_control::scene_quality;
use crate::raw_picture::RawPainter;
use crate::scene::SensorTable;
use crate::sensor_bands::{SensorBands, SensorView};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use terrella::GpuContext;
use terrella_orbit::basilisk::{Camera, PictureRequest, Simulation};
use terrella_sensor::{RawFrame, Sensor};

/// Interval at which the service checks whether it must end.
const LOOK: Duration = Duration::from_millis(50);
/// Largest width and height of a camera's picture, pixels.
const MAX_SIDE_PX: i64 = 8192;
/// Size of the textures before the first picture.
const FIRST_SIZE: (u32, u32) = (64, 64);

/// Runs `body` while the cameras of the flight's simulation are served; without a simulation alone.
pub fn with_camera_service<R>(
    flight: &Flight,
    adapter: Option<&str>,
    body: impl FnOnce() -> R,
) -> R {
    let Some(simulation) = flight.simulation() else {
        return body();
    };
    let is_ended = AtomicBool::new(false);
    // Before the thread runs, so that no early image request is rejected.
    let painter = simulation.painter();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let is_ended = || is_ended.load(Ordering::Relaxed);
            let has_cameras = || {
                let latest = simulation.latest();
                latest.is_some_and(|latest| !latest.cameras.is_empty())
            };
            // Nothing is loaded for a simulation without cameras.
            while !has_cameras() {
                if is_ended() || simulation.is_stopped() {
                    return;
                }
                std::thread::sleep(LOOK);
            }
            let drawn = CameraService::open(flight, simulation, adapter).and_then(|mut service| {
                painter.is_ready();
                service.run(&is_ended)
            });
            if let Err(error) = drawn {
                simulation.tell(format!("pictures of cameras are not drawn: {error}"));
            }
            drop(painter);
        });
        let _end = EndsOnDrop(&is_ended);
        body()
    })
}

struct EndsOnDrop<'f>(&'f AtomicBool);

impl Drop for EndsOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// A renderer for the pictures of cameras.
pub struct CameraService<'f> {
    flight: &'f Flight,
    simulation: &'f Simulation,
    renderer: OffscreenRenderer,
    sensor: Option<CameraSensor>,
    /// How long a picture waits for tiles.
    wait: Duration,
}

impl<'f> CameraService<'f> {
    /// Loads the scene's maps onto an adapter.
    pub fn open(
        flight: &'f Flight,
        simulation: &'f Simulation,
        adapter: Option<&str>,
    ) -> Result<Self, PlayError> {
        let sensor = flight.scene().sensor.as_ref();
        let sensor = sensor.map(SensorTable::open).transpose()?;
        let features = match sensor {
            Some(_) => GpuContext::FLOAT_TARGET,
            None => wgpu::Features::empty(),
        };
        let gpu = pollster::block_on(GpuContext::open_with(adapter, features))?;
        let options = flight.uploaded_options(&gpu)?;
        // Half of its patience; the other half is for drawing.
        let most = simulation.options().timeout / 2;
        let sensor = match sensor {
            Some(sensor) => {
                let mut painter = RawPainter::new(flight, gpu.clone(), options.clone())?;
                painter.limit_wait(most);
                Some(CameraSensor { sensor, painter })
            }
            None => None,
        };
        let mut renderer = OffscreenRenderer::open(gpu, options, FIRST_SIZE)?;
        renderer.show_dated_maps(flight)?;
        renderer.show_models(flight)?;
        renderer.show_sky(flight)?;
        let quality = scene_quality(&flight.scene().quality, *renderer.earth().quality());
        renderer.set_quality(&quality)?;
        Ok(Self {
            flight,
            simulation,
            renderer,
            sensor,
            wait: flight.scene().output.wait().min(most),
        })
    }

    /// Name of the adapter that draws.
    pub fn adapter(&self) -> String {
        self.renderer.adapter_info().name
    }

    /// Serves requests until `is_ended`, or until the simulation has stopped.
    ///
    /// # Errors
    /// A lost device: no further image can be drawn.
    pub fn run(&mut self, is_ended: &dyn Fn() -> bool) -> Result<(), PlayError> {
        while !is_ended() && !self.simulation.is_stopped() {
            if let Some(request) = self.simulation.next_picture(LOOK) {
                self.answer(&request)?;
            }
        }
        Ok(())
    }

    fn answer(&mut self, request: &PictureRequest<'_>) -> Result<(), PlayError> {
        let file = match self.draw(request) {
            Ok(file) => file,
            Err(error @ PlayError::DeviceLost(_)) => return Err(error),
            Err(error) => {
                self.simulation.tell(error.to_string());
                Vec::new()
            }
        };
        request.answer(file);
        Ok(())
    }

    fn draw(&mut self, request: &PictureRequest<'_>) -> Result<Vec<u8>, PlayError> {
        let (camera, snapshot) = (&request.camera, &request.snapshot);
        let reject = |cause: String| PlayError::NoCameraPicture { cause };
        let is_side = |side: i64| (1..=MAX_SIDE_PX).contains(&side);
        let size = match camera.size {
            Some([width, height]) if is_side(width) && is_side(height) => {
                (width as u32, height as u32)
            }
            size => {
                return Err(reject(format!(
                    "camera {} asks for {size:?} pixels; widths and heights are from 1 to {MAX_SIDE_PX}",
                    camera.id
                )));
            }
        };
        let moment = self.flight.seen_by(snapshot, camera, size);
        let moment = moment.map_err(reject)?;
        let not_encoded = |error| reject(format!("an image could not be encoded: {error}"));
        if camera.is_depth {
            let clip_m = camera.clip_m.unwrap_or(USUAL_CLIP_M);
            let [near_m, far_m] = clip_m;
            if !(far_m.is_finite() && (0.0..far_m).contains(&near_m)) {
                return Err(reject(format!(
                    "camera {} clips depth to {clip_m:?} m, which is no range",
                    camera.id
                )));
            }
            let map = depth_map(&moment, self.flight.ellipsoid(), clip_m, size);
            return png(&map, size, ExtendedColorType::Rgb8).map_err(not_encoded);
        }
        if let Some(sensor) = &mut self.sensor {
            let moment = Moment {
                // Noise differs from step to step.
                frame: snapshot.frame_number as u32,
                ..moment
            };
            let gpu = self.renderer.gpu();
            let frame = sensor.read_out(self.flight, gpu, (camera, size), &moment)?;
            return png(&eight_bits(&frame), size, ExtendedColorType::L8).map_err(not_encoded);
        }
        self.renderer.resize(size)?;
        self.renderer.draw_complete(&moment, self.wait);
        let picture = image::DynamicImage::from(self.renderer.read()?).into_rgb8();
        png(&picture, size, ExtendedColorType::Rgb8).map_err(not_encoded)
    }
}

/// The scene's sensor, and the resources for its frames.
struct CameraSensor {
    sensor: Sensor,
    painter: RawPainter,
}

impl CameraSensor {
    /// Reads out a frame for a camera.
    fn read_out(
        &mut self,
        flight: &Flight,
        gpu: &GpuContext,
        (camera, size): (&Camera, (u32, u32)),
        moment: &Moment,
    ) -> Result<RawFrame, PlayError> {
        let fitted = self.sensor.fitted(
            size.into(),
            camera.fov_deg.to_radians(),
            camera.focal_length_mm,
            camera.f_number,
        );
        let sensor = fitted.map_err(|error| PlayError::NoCameraPicture {
            cause: format!(
                "camera {} does not fit [sensor]: {}: {error}",
                camera.id,
                error.key()
            ),
        })?;
        let aspect = f64::from(size.0) / f64::from(size.1);
        let bands = SensorBands::new(flight, &sensor, moment, aspect, gpu)?;
        let seen = SensorView { sensor, bands };
        Ok(self.painter.draw(&seen, moment)?.raw)
    }
}

/// The eight most significant bits of the numbers of a raw frame: Basilisk reads images of 8 bits.
fn eight_bits(frame: &RawFrame) -> Vec<u8> {
    let numbers = frame.data.iter().map(|number| match frame.bits {
        bits @ 0..8 => number << (8 - bits),
        bits => number >> (bits - 8),
    });
    numbers.map(|number| number as u8).collect()
}

/// A picture as a file, quickly.
fn png(
    pixels: &[u8],
    (width, height): (u32, u32),
    color: ExtendedColorType,
) -> Result<Vec<u8>, image::ImageError> {
    let mut file = Vec::new();
    let encoder =
        PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Adaptive);
    encoder.write_image(pixels, width, height, color)?;
    Ok(file)
}
