//! Where each pixel of the drawn Earth looks, by its own account, against the exact ray.

use super::pixel_of;
use crate::SortedSample;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::time::Duration;
use terrella::frames::Ellipsoid;
use terrella::internals::earth::PixelLattice;
use terrella::internals::gpu::{Attachments, GpuContext, color_texture, read_floats};
use terrella::{
    DiagnosticOptions, Earth, EarthError, EarthOptions, EyeView, Figure, FrameRequest, FrameStats,
    GroundOptions, Sky, Subdivision, SurfaceOutput, Visibility,
};
use terrella_imagery::{EarthLayers, LayerImage};
use terrella_play::PlayError;
use terrella_reference::ground_point;

/// Draws an Earth's geolocation buffer: places instead of colours, on the same mesh.
pub struct GeolocationRenderer {
    gpu: GpuContext,
    earth: Earth,
    targets: Vec<Targets>,
    stats: FrameStats,
}

struct Targets {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    attachments: Attachments,
}

/// Geolocation of the pixels of an image.
#[derive(Clone, Debug)]
pub struct GeolocationBuffer {
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// Row by row: texture coordinates from the block's centre, and the centre's; all 0 where space is drawn.
    texels: Vec<[f32; 4]>,
}

impl GeolocationRenderer {
    /// Makes it with a figure, so many cells per block edge and a visibility rule. One sample a pixel, its middle.
    ///
    /// # Errors
    /// As [`Earth::new`].
    pub fn new(
        gpu: &GpuContext,
        figure: Figure,
        cells: u32,
        visibility: Visibility,
    ) -> Result<Self, PlayError> {
        Self::of(gpu, |options| {
            options.figure = figure;
            options.subdivision = Subdivision::Cells(cells);
            options.visibility = visibility;
        })
    }

    /// Makes it with ground that has relief.
    ///
    /// # Errors
    /// As [`Earth::new`].
    pub fn with_ground(gpu: &GpuContext, ground: &GroundOptions) -> Result<Self, PlayError> {
        Self::of(gpu, |options| options.ground = Some(ground.clone()))
    }

    fn of(gpu: &GpuContext, set: impl FnOnce(&mut EarthOptions)) -> Result<Self, PlayError> {
        let day = LayerImage::from_rgba8(1, 1, vec![0; 4]).map_err(EarthError::from)?;
        let mut options = EarthOptions {
            diagnostics: DiagnosticOptions {
                output: SurfaceOutput::Geolocation,
                ..DiagnosticOptions::default()
            },
            color_format: SurfaceOutput::GEOLOCATION,
            ..EarthOptions::new(EarthLayers {
                day,
                clouds: None,
                normals: None,
                night_lights: None,
                water: None,
            })
        };
        set(&mut options);
        Ok(Self {
            earth: Earth::new(&gpu.device, &gpu.queue, &options)?,
            gpu: gpu.clone(),
            targets: Vec::new(),
            stats: FrameStats::default(),
        })
    }

    /// Statistics of the last frame.
    pub fn stats(&self) -> FrameStats {
        self.stats
    }

    /// Lets terrain become as fine as it will be for a view, at most `wait`.
    pub fn settle(&mut self, view: &EyeView, size: (u32, u32), wait: Duration) {
        let sky = Sky::new(DVec3::X);
        let queue = &self.gpu.queue;
        self.earth
            .prepare_complete(queue, FrameRequest::new(view, &sky, size), wait);
    }

    /// Chooses what a view of so many pixels draws, a frame's work.
    pub fn prepare(&mut self, view: &EyeView, size: (u32, u32)) -> FrameStats {
        // Nothing is lit.
        let sky = Sky::new(DVec3::X);
        self.stats = self
            .earth
            .prepare(&self.gpu.queue, FrameRequest::new(view, &sky, size));
        self.stats
    }

    /// Draws a view and reads it back.
    ///
    /// # Errors
    /// A lost device.
    pub fn draw(
        &mut self,
        view: &EyeView,
        size: (u32, u32),
    ) -> Result<GeolocationBuffer, PlayError> {
        self.prepare(view, size);
        self.draw_points(view, &PixelLattice::whole(size))
    }

    /// Draws points of the picture of the view that was prepared last, and reads them back.
    ///
    /// # Errors
    /// A lost device.
    pub fn draw_points(
        &mut self,
        view: &EyeView,
        points: &PixelLattice,
    ) -> Result<GeolocationBuffer, PlayError> {
        let (device, queue, size) = (&self.gpu.device, &self.gpu.queue, points.points);
        self.earth.aim_at(queue, view, points);
        let targets = match self
            .targets
            .iter()
            .position(|targets| targets.size() == size)
        {
            Some(place) => self.targets.swap_remove(place),
            None => Targets::new(&self.gpu, size),
        };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("terrella geolocation"),
        });
        let mut pass = targets.attachments.begin_pass(&mut encoder, &targets.view);
        let [x, y, width, height] = points.viewport();
        pass.set_viewport(x, y, width, height, 0.0, 1.0);
        self.earth.render(&mut pass);
        drop(pass);
        queue.submit([encoder.finish()]);
        let texels = read_floats(device, queue, &targets.texture)?;
        self.targets.truncate(MAX_TARGETS - 1);
        self.targets.push(targets);
        Ok(GeolocationBuffer { size, texels })
    }
}

/// Sizes that are drawn interleaved without making textures again.
const MAX_TARGETS: usize = 2;

impl Targets {
    fn size(&self) -> (u32, u32) {
        (self.texture.width(), self.texture.height())
    }

    fn new(gpu: &GpuContext, size: (u32, u32)) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let format = SurfaceOutput::GEOLOCATION;
        let texture = color_texture(&gpu.device, "terrella geolocation", size, format, 1, usage);
        Self {
            view: texture.create_view(&wgpu::TextureViewDescriptor {
                label: Some("terrella geolocation"),
                ..Default::default()
            }),
            texture,
            attachments: Attachments::new(&gpu.device, size, format, 1),
        }
    }
}

impl GeolocationBuffer {
    /// Whether a pixel shows ground.
    pub fn is_ground(&self, x: u32, y: u32) -> bool {
        self.texel(x, y)[2] != 0.0
    }

    /// Geodetic latitude and longitude that maps are read at for a pixel, radians; `None` in space.
    pub fn lat_lon_rad(&self, x: u32, y: u32) -> Option<(f64, f64)> {
        let texel = self.texel(x, y).map(f64::from);
        let [u, v, center_u, center_v] = texel;
        (center_u != 0.0).then(|| {
            let lon_rad = (u + (center_u - 0.5)) * TAU;
            (FRAC_PI_2 - (v + center_v) * PI, lon_rad)
        })
    }

    /// The point of the ground that maps are read at for a pixel, ITRF metres; `None` in space.
    pub fn point_itrf_m(&self, x: u32, y: u32, figure: &Ellipsoid) -> Option<DVec3> {
        let (lat_rad, lon_rad) = self.lat_lon_rad(x, y)?;
        Some(figure.surface_point(Ellipsoid::normal(lat_rad, lon_rad)))
    }

    /// Of terrain: how many times the pixel's ray, to the plane one metre in front of the eye, the drawn ground is
    /// away; `None` in space.
    pub fn along(&self, x: u32, y: u32) -> Option<f64> {
        let [_, _, is_ground, along] = self.texel(x, y);
        (is_ground != 0.0).then_some(f64::from(along))
    }

    fn texel(&self, x: u32, y: u32) -> [f32; 4] {
        let index = y as usize * self.size.0 as usize + x as usize;
        self.texels.get(index).copied().unwrap_or_default()
    }
}

/// Errors of geolocation, over the pixels that show ground and whose exact ray, through their centre, meets it.
///
/// In metres they are distances between the pixel's place in the buffer and the place that the exact ray meets. At the limb the ground is seen edge
/// on, and a tiny angle is a long distance on the ground. Errors are therefore also given in pixels of the image: the distance from the pixel's
/// centre to the position where the buffer's place appears.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GeolocationErrors {
    /// Pixels compared.
    pub pixels: usize,
    pub median_m: f64,
    /// 99th percentile, metres.
    pub p99_m: f64,
    /// Largest, metres.
    pub max_m: f64,
    /// 99th percentile, pixels.
    pub p99_px: f64,
    /// Largest, pixels.
    pub max_px: f64,
}

/// Compares drawn places with those of a view's exact rays.
pub fn geolocation(
    places: &GeolocationBuffer,
    view: &EyeView,
    figure: &Ellipsoid,
) -> GeolocationErrors {
    let (eye_itrf_m, _) = view.to_itrf();
    let (width, height) = places.size;
    let (mut metres, mut pixels) = (Vec::new(), Vec::new());
    for y in 0..height {
        for x in 0..width {
            let Some(drawn) = places.point_itrf_m(x, y, figure) else {
                continue;
            };
            let middle = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let Some(exact) = ground_point(view, *figure, places.size, middle) else {
                continue;
            };
            let shown = pixel_of(view, places.size, drawn - eye_itrf_m);
            metres.push(drawn.distance(exact));
            pixels.push(shown.map_or(f64::INFINITY, |shown| shown.distance(middle)));
        }
    }
    let (metres, pixels) = (SortedSample::new(metres), SortedSample::new(pixels));
    GeolocationErrors {
        pixels: pixels.len(),
        median_m: metres.median(),
        p99_m: metres.quantile(0.99),
        max_m: metres.max(),
        p99_px: pixels.quantile(0.99),
        max_px: pixels.max(),
    }
}
