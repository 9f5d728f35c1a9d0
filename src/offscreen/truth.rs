//! Ground truth of an image as arrays.

use super::error::OffscreenError;
use super::truth_layers::{LayerDtype, TruthLayer, TruthPixel};
use crate::gpu::{SurfaceOutput, TruthTexel};
use crate::{EarthOptions, TruthView};
use rayon::prelude::*;
use terrella_ground::light::Exposure;
use terrella_imagery::LayerImage;

/// Number of rows that are processed at once.
const BAND_LINES: usize = 64;

/// Ground truth of an image.
#[derive(Clone, Debug)]
pub struct TruthPicture {
    view: TruthView,
    size: (u32, u32),
    texels: Vec<TruthTexel>,
    has_water: bool,
}

/// Values of a layer, row by row from the top, in its [`TruthLayer::dtype`].
#[derive(Clone, Debug, PartialEq)]
pub enum LayerValues {
    /// 32-bit floats.
    F32(Vec<f32>),
    /// 64-bit floats.
    F64(Vec<f64>),
}

impl LayerValues {
    /// An empty list for a layer, with capacity for this many pixels.
    pub fn with_room(layer: &TruthLayer, pixels: usize) -> Self {
        let count = pixels * layer.components();
        match layer.dtype {
            LayerDtype::F32 => Self::F32(Vec::with_capacity(count)),
            LayerDtype::F64 => Self::F64(Vec::with_capacity(count)),
        }
    }

    /// Appends the values of the next pixels.
    pub fn add(&mut self, layer: &TruthLayer, pixels: &[TruthPixel]) {
        let components = layer.components();
        let numbers = pixels.iter().flat_map(|pixel| {
            let numbers = layer.values(pixel);
            numbers.into_iter().take(components)
        });
        match self {
            Self::F32(all) => all.extend(numbers.map(|number| number as f32)),
            Self::F64(all) => all.extend(numbers),
        }
    }
}

impl TruthPicture {
    pub(super) fn new(
        view: TruthView,
        size: (u32, u32),
        texels: Vec<TruthTexel>,
        has_water: bool,
    ) -> Self {
        Self {
            view,
            size,
            texels,
            has_water,
        }
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The rays of its pixels, and the Sun.
    pub fn view(&self) -> &TruthView {
        &self.view
    }

    /// Values of some layers, in the given order. Each pixel is evaluated once for all of them. A vector has three consecutive numbers a pixel. NaN
    /// marks a missing value.
    pub fn layers(&self, wanted: &[&TruthLayer]) -> Vec<LayerValues> {
        let count = self.texels.len();
        let empty = wanted
            .iter()
            .map(|layer| LayerValues::with_room(layer, count));
        let mut values: Vec<_> = empty.collect();
        let width = self.size.0 as usize;
        for (first, band) in (0..)
            .step_by(BAND_LINES)
            .zip(self.texels.chunks(BAND_LINES * width))
        {
            let pixels: Vec<TruthPixel> = (0..band.len())
                .into_par_iter()
                .map(|i| self.pixel((i % width) as u32, first + (i / width) as u32, &band[i]))
                .collect();
            for (layer, values) in wanted.iter().zip(&mut values) {
                values.add(layer, &pixels);
            }
        }
        values
    }

    /// Distance of the drawn ground from the eye along the camera's axis, metres: the depth of a pinhole camera. Infinite where no ground is
    /// visible. It is computed in f64 on each pixel's ray; no depth buffer is read.
    pub fn depth_m(&self) -> Vec<f32> {
        let width = self.size.0 as usize;
        let [corner, right, down] = self.view.corner_right_down();
        let texels = self.texels.par_iter().enumerate();
        texels
            .map(|(i, texel)| {
                let (x, y) = ((i % width) as u32, (i / width) as u32);
                let Some(point) = self.view.point(x, y, texel) else {
                    return f32::INFINITY;
                };
                // Rays end on the plane at distance one metre.
                let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                (point.range_m / (corner + x * right + y * down).length()) as f32
            })
            .collect()
    }

    fn pixel(&self, x: u32, y: u32, texel: &TruthTexel) -> TruthPixel {
        TruthPixel {
            point: self.view.point(x, y, texel),
            limb_distance_rad: self.view.limb_distance_rad(x, y),
            has_water: self.has_water,
        }
    }
}

/// Changes the options to ground truth. Layers that do not affect it are removed.
pub fn set_truth(options: &mut EarthOptions) -> Result<(), OffscreenError> {
    // A tile source requires the corresponding whole maps.
    if options.tiles.is_none() {
        options.layers.day = LayerImage::from_rgba8(1, 1, vec![0; 4])?;
        options.layers.night_lights = None;
    }
    options.diagnostics.output = SurfaceOutput::Truth;
    options.color_format = SurfaceOutput::TRUTH[0];
    options.samples = 1;
    options.exposure = Exposure::default();
    if options.light.detail {
        tracing::info!("the truth is without made detail");
        options.light.detail = false;
    }
    Ok(())
}
