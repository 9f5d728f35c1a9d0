//! Rendering of ground truth: of a pinhole camera row by row, of a sensor through its lens.

use super::error::PlayError;
use super::flight::{Flight, Moment};
use super::sensor_bands::SensorView;
use glam::DVec2;
use rayon::prelude::*;
use std::time::Duration;
use terrella::internals::offscreen::{
    TruthPixel, check_truth_memory, new_truth_targets, set_truth,
};
use terrella::{
    Earth, EarthOptions, FrameRequest, GpuContext, LayerValues, TruthLayer, TruthPoint, TruthTexel,
    TruthView,
};
use terrella_imagery::tile::TileKey;
use terrella_sensor::SensorError;

/// Some truth layers of a sensor's view, in memory, as in the folder of `terrella frame --truth`. Also returns the missing tiles.
///
/// # Errors
/// A sensor whose layers exceed this program's memory limit, or a device that is out of memory.
pub fn seen_layers(
    flight: &Flight,
    gpu: &GpuContext,
    options: EarthOptions,
    seen: &SensorView,
    wanted: &[&TruthLayer],
) -> Result<(Vec<LayerValues>, Vec<TileKey>), PlayError> {
    let [width, height] = seen.sensor.lens.size();
    check_truth_memory((width, height))?;
    let count = width as usize * height as usize;
    let empty = wanted
        .iter()
        .map(|layer| LayerValues::with_room(layer, count));
    let mut values: Vec<_> = empty.collect();
    let missing = seen_rows(flight, gpu, options, seen, |_, pixels| {
        for (layer, values) in wanted.iter().zip(&mut values) {
            values.add(layer, pixels);
        }
        Ok(())
    })?;
    Ok((values, missing))
}

/// How far the place of a sensor's pixel may be from the pixel's ray, pixels.
const MOST_OFF_PX: f64 = 0.01;

/// Draws what a sensor sees band by band and hands over its rows from the top. Answers tiles that are missing.
pub(super) fn seen_rows(
    flight: &Flight,
    gpu: &GpuContext,
    options: EarthOptions,
    seen: &SensorView,
    mut row: impl FnMut(u32, &[TruthPixel]) -> Result<(), PlayError>,
) -> Result<Vec<TileKey>, PlayError> {
    let has_water = options.layers.water.is_some();
    let ellipsoid = options.figure.ellipsoid();
    let lens = &seen.sensor.lens;
    let width = lens.size()[0];
    let mut earth = TruthEarth::new(gpu, options)?;
    let wait = flight.scene().output.wait();
    let mut all_missing = Vec::new();
    for band in &seen.bands.bands {
        let mut texels = Vec::with_capacity(band.frame.len());
        let (view, missing) = earth.draw(&band.pinhole(), band.size(), wait, |_, _, line| {
            texels.extend_from_slice(line);
            Ok(())
        })?;
        all_missing.extend(missing);
        for y in band.rows.clone() {
            let pixels = (0..width).into_par_iter().map(|x| {
                let direction = lens.direction(DVec2::new(f64::from(x), f64::from(y)))?;
                let at = band.frame.at(direction);
                let ray = view.ray_through(at.x, at.y);
                let [column, row] = band.frame.pixel(direction);
                let texel = row as usize * band.frame.size[0] as usize + column as usize;
                // Beside the limb a sample may show ground that the pixel's own ray misses.
                let is_met = |point: &TruthPoint| {
                    let place_m = ellipsoid.itrf_from_geodetic(point.place);
                    let most_m = MOST_OFF_PX * point.range_m / lens.focal_px();
                    place_m.distance(point.place_itrf_m) <= most_m
                };
                let point = view.point_along(ray, &texels[texel]);
                Ok(TruthPixel {
                    point: point.filter(is_met),
                    limb_distance_rad: view.limb_distance_along(ray),
                    has_water,
                })
            });
            row(y, &pixels.collect::<Result<Vec<_>, SensorError>>()?)?;
        }
    }
    Ok(all_missing)
}

/// An Earth of numbers.
pub(super) struct TruthEarth<'g> {
    gpu: &'g GpuContext,
    earth: Earth,
    options: EarthOptions,
}

impl<'g> TruthEarth<'g> {
    pub fn new(gpu: &'g GpuContext, mut options: EarthOptions) -> Result<Self, PlayError> {
        set_truth(&mut options)?;
        Ok(Self {
            gpu,
            earth: Earth::new(&gpu.device, &gpu.queue, &options)?,
            options,
        })
    }

    /// Draws a moment and hands over its texels line by line. Answers the rays of the pixels, and tiles that are missing.
    pub fn draw(
        &mut self,
        moment: &Moment,
        size: (u32, u32),
        wait: Duration,
        mut line: impl FnMut(&TruthView, u32, &[TruthTexel]) -> Result<(), PlayError>,
    ) -> Result<(TruthView, Vec<TileKey>), PlayError> {
        let view = TruthView::new(&moment.view, &moment.sky, self.options.figure, size);
        let view = view.ok_or(PlayError::NoTruth)?;
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let targets = new_truth_targets(self.gpu, size)?;
        let request = FrameRequest::new(&moment.view, &moment.sky, size);
        let (_, missing) = self.earth.prepare_complete(queue, request, wait);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("terrella truth"),
        });
        self.earth.render(&mut targets.begin_pass(&mut encoder));
        queue.submit([encoder.finish()]);
        let (width, height) = size;
        let band = (BAND_BYTES / (BAND_PIXEL_BYTES * u64::from(width.max(1)))).max(1) as u32;
        for first in (0..height).step_by(band as usize) {
            let texels = targets.read(device, queue, first..first.saturating_add(band))?;
            for (y, texels) in (first..).zip(texels.chunks_exact(width as usize)) {
                line(&view, y, texels)?;
            }
        }
        Ok((view, missing))
    }
}

/// Size of the texels that are read back and processed at once, bytes.
const BAND_BYTES: u64 = 64 << 20;
/// Of a pixel, with all copies on the way.
const BAND_PIXEL_BYTES: u64 = 400;
