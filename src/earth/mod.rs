//! The façade: an Earth that a wgpu host draws into its own pass.
//!
//! | file | what |
//! |---|---|
//! | `mod.rs` | the three verbs |
//! | `options.rs` | what is fixed when an Earth is made |
//! | `error.rs` | what can be wrong with it |
//! | `plan.rs` | what a frame draws, chosen without a GPU |
//! | `surface_light.rs` | what of the light on the surface can be chosen |
//! | `surface_config.rs` | how the surface is drawn with a quality |
//! | `view.rs` | the eye and the target |
//! | `pixel_lattice.rs` | a picture in some of its points alone, for measuring |
//! | `sky.rs` | what lights it |
//! | `metering.rs` | how bright it is shown |
//! | `stats.rs` | what a frame drew |
//! | `ground.rs` | ground with relief, where there is any; `no_ground.rs` without the feature `terrain` |
//! | `tiles.rs` | which tiles of a pack a frame requests and is drawn with; `no_tiles.rs` without the feature `packs` |
//! | `tile_view.rs` | what tiles are chosen by, and how fine they came out |
//! | `quality.rs` | what can be reduced to draw faster |
//! | `quality_ladder.rs`, `quality_ladder/` | in which order, as it was measured; the recorded measurement |
//! | `adaptive_quality.rs` | when quality is reduced, to hold a frame time |
//! | `truth.rs` | what is where a pixel looks, in f64 |
//! | `diagnostics.rs` | what is not for pictures: where pixels look, edges of triangles, what the shaders hold |

mod adaptive_quality;
mod diagnostics;
mod error;
#[cfg_attr(not(feature = "terrain"), path = "no_ground.rs")]
mod ground;
mod metering;
mod options;
#[cfg(feature = "command")]
mod pixel_lattice;
mod plan;
mod quality;
mod quality_ladder;
mod sky;
mod stats;
mod surface_config;
mod surface_light;
mod tile_view;
#[cfg_attr(not(feature = "packs"), path = "no_tiles.rs")]
mod tiles;
mod truth;
mod view;

use crate::air::{AirModel, AirOptions, AirTables, Atmosphere};
pub use crate::globe::Shading;
#[cfg(feature = "celestial")]
use crate::gpu::FrameUniforms;
use crate::gpu::{AirDrawable, AirTextures, FramePlan, PassFormat, SurfaceDrawable};
pub use crate::gpu::{DepthBuffer, SurfaceOutput};
use crate::imagery::NeighbourhoodAlbedo;
use crate::imagery::tile::TileKey;
use crate::light::Exposure;
pub use adaptive_quality::{AdaptiveQuality, QualityChange};
pub use diagnostics::{DiagnosticOptions, Diagnostics};
pub use error::EarthError;
pub use ground::GroundOptions;
#[cfg(feature = "command")]
pub(crate) use metering::metered_ev;
pub use options::EarthOptions;
#[cfg(feature = "command")]
pub use pixel_lattice::PixelLattice;
use plan::Planner;
pub use quality::{Quality, QualityReduction, TILED_SUBDIVISION};
pub use quality_ladder::{QualityLadder, QualityLadderError, QualityLevel, QualityStep};
pub use sky::Sky;
#[cfg(feature = "celestial")]
pub(crate) use sky::{moonlight, moonlight_of_phase};
pub use stats::FrameStats;
use std::time::{Duration, Instant};
use surface_config::{SurfaceStyle, surface_config};
pub use surface_light::{AIRGLOW_LUMINANCE, CITY_RADIANCE, SurfaceLight};
use tiles::TileDriver;
pub use tiles::TileOptions;
pub use truth::{TruthPoint, TruthView};
#[cfg(feature = "celestial")]
pub(crate) use view::ItrfView;
#[cfg(any(feature = "celestial", feature = "tracks"))]
pub(crate) use view::ball_bounds;
pub use view::{EyeView, Viewport, infinite_reversed_z};

/// Bytes of tiles uploaded at once where a picture waits for them.
const WAITING_UPLOAD_BYTES: u64 = 64_000_000;

/// The Earth.
///
/// The host owns device, queue, pass and depth buffer. Once a frame: [`Earth::prepare`], then [`Earth::render`] inside
/// the host's pass. Neither waits for disk or GPU.
pub struct Earth {
    planner: Planner,
    /// What [`Self::render`] draws.
    plan: FramePlan,
    surface: SurfaceDrawable,
    air: Option<AirDrawable>,
    air_options: AirOptions,
    device: wgpu::Device,
    style: SurfaceStyle,
    format: PassFormat,
    quality: Quality,
    /// Bytes of tiles uploaded by the last `prepare`.
    uploaded_tiles: u64,
    stats: FrameStats,
    /// False if the last view was not finite: then nothing is drawn.
    drawable: bool,
}

impl Earth {
    /// Makes pipelines and uploads the maps.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        options: &EarthOptions,
    ) -> Result<Self, EarthError> {
        options.check(device)?;
        let mut quality = Quality::of(options);
        if options.diagnostics.output != SurfaceOutput::Color {
            quality.atmosphere = Atmosphere::None;
        }
        let planner = Planner::new(options, &quality, &device.limits())?;
        if options.diagnostics.wireframe && !planner.has_edges() {
            return Err(EarthError::NoEdges);
        }
        let format = PassFormat {
            color: options.color_format,
            further: options.diagnostics.output.further_targets(),
            samples: options.samples,
            depth: options.depth,
            tone: options.tone,
        };
        let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let air = match quality.atmosphere {
            Atmosphere::Billboard => {
                let textures = air_textures(
                    device,
                    queue,
                    &options.air,
                    &options.light,
                    planner.exposure.albedo(),
                    &quality,
                );
                let night = options.light.night_light();
                Some(AirDrawable::new(device, format, textures, night)?)
            }
            Atmosphere::None => None,
        };
        let style = SurfaceStyle {
            shading: options.shading,
            light: options.light,
            diagnostics: options.diagnostics,
        };
        let ground = planner.ground();
        let config = surface_config(device, style, format, &quality, air.as_ref(), ground);
        let pools = planner.tiles.as_ref().map(TileDriver::pools);
        let grids = planner.meshes().grids();
        let surface = SurfaceDrawable::new(device, queue, grids, &options.layers, pools, &config)?;
        let refused = resolved(scope.pop());
        let full = resolved(memory.pop());
        if let Some(error) = full {
            return Err(EarthError::NoRoom {
                mib: surface.texture_bytes >> 20,
                cause: error.to_string(),
            });
        }
        if let Some(error) = refused {
            return Err(EarthError::Refused(error.to_string()));
        }
        Ok(Self {
            plan: planner.empty_plan(),
            planner,
            surface,
            air,
            air_options: options.air,
            device: device.clone(),
            style,
            format,
            quality,
            uploaded_tiles: 0,
            stats: FrameStats::default(),
            drawable: false,
        })
    }

    /// Chooses what the eye sees and writes it to the GPU. Call once a frame, before the pass. Never waits.
    ///
    /// `target` is the target's width and height in pixels, or the [`Viewport`] that the pass sets. Nothing is drawn where
    /// no picture is defined: of a view or sky that is not finite, a Sun without direction, a projection that has no
    /// inverse, and an eye beyond 1e24 m.
    pub fn prepare(
        &mut self,
        queue: &wgpu::Queue,
        view: &EyeView,
        sky: &Sky,
        target: impl Into<Viewport>,
    ) -> FrameStats {
        self.prepare_within(queue, view, sky, target.into(), None)
    }

    /// As [`Self::prepare`], but waits until every tile that the view requests is on the GPU, and ground with relief is as fine
    /// as it will be, at most `timeout`: for
    /// pictures that are kept. Answers what is missing; such blocks are drawn with something coarser. A tile that cannot
    /// be read is not waited for.
    ///
    /// Submits to `queue` what it uploads on the way.
    pub fn prepare_complete(
        &mut self,
        queue: &wgpu::Queue,
        view: &EyeView,
        sky: &Sky,
        target: impl Into<Viewport>,
        timeout: Duration,
    ) -> (FrameStats, Vec<TileKey>) {
        let (target, deadline) = (target.into(), Instant::now() + timeout);
        loop {
            let stats = self.prepare_within(queue, view, sky, target, Some(WAITING_UPLOAD_BYTES));
            let is_settled = !self.drawable || self.planner.is_ground_settled();
            if !is_settled && Instant::now() < deadline {
                queue.submit([]);
                continue;
            }
            let Some(tiles) = self.planner.tiles.as_mut().filter(|_| self.drawable) else {
                return (stats, Vec::new());
            };
            // What was uploaded just now is drawn in the next round.
            let left = deadline.saturating_duration_since(Instant::now());
            if self.uploaded_tiles == 0 && (tiles.is_settled() || left.is_zero()) {
                return (stats, tiles.missing().collect());
            }
            if self.uploaded_tiles == 0 {
                tiles.wait(left);
            }
            // Lets go of the copies that the uploads are made from.
            queue.submit([]);
        }
    }

    /// Has what was prepared last drawn at these points of its picture, until the next [`Self::prepare`]: by a pass of as many
    /// pixels that sets their viewport.
    #[cfg(feature = "command")]
    pub(crate) fn aim_at(&mut self, queue: &wgpu::Queue, view: &EyeView, points: &PixelLattice) {
        let rays = points.rays(view);
        let uniforms = &mut self.plan.uniforms;
        uniforms.corner_ray = rays.corner.as_vec3();
        uniforms.pixel_right = rays.right.as_vec3();
        uniforms.pixel_down = rays.down.as_vec3();
        self.surface.write_frame(queue, uniforms);
    }

    /// Says where the eye is expected soon, the nearest time first, so that tiles are there when it comes. At most four
    /// views are looked at; they stand until others are given. Without tiles it does nothing.
    pub fn expect(&mut self, views: &[EyeView]) {
        if let Some(tiles) = &mut self.planner.tiles {
            tiles.expect(views);
        }
    }

    /// Exposes so from the next [`Self::prepare`] on.
    ///
    /// # Errors
    /// An exposure outside its range; it is then as it was.
    pub fn set_exposure(&mut self, exposure: Exposure) -> Result<(), EarthError> {
        let exposure = exposure.check().map_err(EarthError::Exposure)?;
        self.planner.exposure.set(exposure);
        Ok(())
    }

    /// The exposure that [`Exposure::Auto`] would take for a view, EV; `None` where no picture is defined. For hosts that follow
    /// it in time ([`crate::Adaptation`]) or expose a float target themselves.
    pub fn metered_ev(&mut self, view: &EyeView, sky: &Sky) -> Option<f64> {
        let ellipsoid = self.planner.ellipsoid();
        self.planner.exposure.metered_view(view, sky, &ellipsoid)
    }

    /// How well it is drawn.
    pub fn quality(&self) -> &Quality {
        &self.quality
    }

    /// Draws better or worse from the next [`Self::prepare`] on. Maps and tiles stay on the GPU; pipelines and the
    /// lattice are made anew where they differ, which takes some milliseconds.
    ///
    /// # Errors
    /// As [`Self::new`]; the Earth is then as it was.
    pub fn set_quality(
        &mut self,
        queue: &wgpu::Queue,
        quality: &Quality,
    ) -> Result<(), EarthError> {
        let before = self.quality;
        self.apply(queue, quality).or_else(|failure| {
            self.apply(queue, &before)?;
            Err(failure)
        })
    }

    fn apply(&mut self, queue: &wgpu::Queue, quality: &Quality) -> Result<(), EarthError> {
        let mut quality = *quality;
        if !Quality::SCALES.contains(&quality.scale) {
            return Err(EarthError::Scale(quality.scale));
        }
        if self.style.diagnostics.output != SurfaceOutput::Color {
            quality.atmosphere = Atmosphere::None;
        }
        let meshes = self.planner.meshes_of(quality.subdivision)?;
        let format = PassFormat {
            samples: quality.samples,
            ..self.format
        };
        let device = self.device.clone();
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let fits = quality.samples == self.format.samples;
        let air = match (quality.atmosphere, self.air.take()) {
            (Atmosphere::None, _) => None,
            (Atmosphere::Billboard, Some(air)) if fits => Some(air),
            (Atmosphere::Billboard, before) => {
                let textures = before.map(|air| air.textures().clone());
                let textures = textures.unwrap_or_else(|| {
                    let (air, light) = (&self.air_options, &self.style.light);
                    let albedo = self.planner.exposure.albedo();
                    air_textures(&device, queue, air, light, albedo, &quality)
                });
                let night = self.style.light.night_light();
                Some(AirDrawable::new(&device, format, textures, night)?)
            }
        };
        if let Some(air) = &air {
            let albedo = self.planner.exposure.albedo().texels(&quality.maps);
            air.textures().set_albedo(queue, &albedo);
        }
        let (air_drawn, ground) = (air.as_ref(), self.planner.ground());
        let config = surface_config(&device, self.style, format, &quality, air_drawn, ground);
        self.surface.set_config(&device, meshes.grids(), &config)?;
        (self.air, self.format, self.quality) = (air, format, quality);
        self.planner.set_quality(&quality, meshes);
        self.plan = self.planner.empty_plan();
        self.drawable = false;
        match resolved(scope.pop()) {
            None => Ok(()),
            Some(error) => Err(EarthError::Refused(error.to_string())),
        }
    }

    fn prepare_within(
        &mut self,
        queue: &wgpu::Queue,
        view: &EyeView,
        sky: &Sky,
        target: Viewport,
        upload_bytes: Option<u64>,
    ) -> FrameStats {
        let view = view.in_itrf(target).zip(sky.with_unit_sun());
        self.drawable = view.is_some();
        self.uploaded_tiles = 0;
        self.stats = match &view {
            Some((view, sky)) => self.planner.plan(view, sky, &mut self.plan),
            None => FrameStats::default(),
        };
        self.stats.texture_bytes =
            self.surface.texture_bytes + self.air_textures().map_or(0, AirTextures::bytes);
        if self.drawable {
            self.write(queue, upload_bytes);
        }
        self.stats
    }

    /// Hands the plan and tiles that have come to the GPU, and notes what that costs.
    fn write(&mut self, queue: &wgpu::Queue, upload_bytes: Option<u64>) {
        let stats = &mut self.stats;
        if let Some(tiles) = &mut self.planner.tiles {
            let begin = Instant::now();
            let surface = &self.surface;
            self.uploaded_tiles =
                tiles.upload(upload_bytes, &mut |part| surface.write_tile(queue, &part));
            stats.tile_upload = begin.elapsed();
            stats.tiles = tiles.counters();
        }
        let ground = self.planner.ground();
        let written = self.surface.write(&self.device, queue, &self.plan, ground);
        stats.uploaded_bytes = self.uploaded_tiles + written;
        if let Some(costs) = self.surface.ground_costs() {
            let air = self.plan.air.as_ref();
            stats.draw_calls = costs.draw_calls + u32::from(air.is_some());
            stats.triangles = costs.triangles + air.map_or(0, |air| air.ring.triangles());
            stats.ground_bytes = costs.bytes;
        }
        if let Some((air, plan)) = self.air.as_mut().zip(self.plan.air.as_ref()) {
            stats.uploaded_bytes += air.write(&self.device, queue, plan, &self.plan.uniforms);
        }
    }

    /// Draws what [`Self::prepare`] chose into the host's pass: the surface, seen through the air, then the halo beside it.
    /// Draw opaque things before, so that the halo lies over those behind the Earth.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.render_surface(pass);
        self.render_air(pass);
    }

    /// The first part of [`Self::render`], for a host that measures them apart.
    pub fn render_surface(&self, pass: &mut wgpu::RenderPass<'_>) {
        if !self.drawable {
            return;
        }
        // Where no depths tell that the ground stands before the halo it is drawn over it.
        if self.format.depth == DepthBuffer::None {
            self.render_halo(pass);
        }
        self.surface.render(pass, &self.plan);
    }

    /// The second part.
    pub fn render_air(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.drawable && self.format.depth != DepthBuffer::None {
            self.render_halo(pass);
        }
    }

    fn render_halo(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(air) = &self.air {
            air.render(pass, &self.plan);
        }
    }

    /// The surface that draws ground with relief, as scenes name it; `None` without relief.
    #[cfg(feature = "command")]
    pub(crate) fn surface_name(&self) -> Option<&'static str> {
        self.planner.ground().map(|surface| surface.name())
    }

    /// What others draw through this air with.
    pub(crate) fn air_textures(&self) -> Option<&AirTextures> {
        self.air.as_ref().map(AirDrawable::textures)
    }

    /// The pass that it is drawn in.
    #[cfg(any(feature = "celestial", feature = "tracks"))]
    pub(crate) fn format(&self) -> PassFormat {
        self.format
    }

    /// The figure that it has.
    #[cfg(any(feature = "celestial", feature = "tracks"))]
    pub(crate) fn ellipsoid(&self) -> crate::frames::Ellipsoid {
        self.planner.ellipsoid()
    }

    /// The same uniforms with the exposure of the frame prepared last.
    #[cfg(feature = "celestial")]
    pub(crate) fn exposed(&self, frame: FrameUniforms) -> FrameUniforms {
        FrameUniforms {
            exposure: self.plan.uniforms.exposure,
            ..frame
        }
    }

    /// Whether the air is drawn.
    pub fn has_air(&self) -> bool {
        self.air.is_some()
    }

    /// Whether blocks are drawn with tiles.
    pub fn has_tiles(&self) -> bool {
        self.planner.tiles.is_some()
    }
}

/// The air on the GPU over the ground of a quality.
fn air_textures(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    options: &AirOptions,
    light: &SurfaceLight,
    albedo: &NeighbourhoodAlbedo,
    quality: &Quality,
) -> AirTextures {
    let (model, tables) = (AirModel::new(options), AirTables::shared(options));
    let albedo = albedo.texels(&quality.maps);
    let (clouds_m, moonlight) = (light.cloud_height_m, light.moonlight);
    AirTextures::new(device, queue, model, &tables, &albedo, clouds_m, moonlight)
}

/// The value of a future that is ready at once, as wgpu's error scopes are everywhere but on the web.
fn resolved<T>(future: impl Future<Output = Option<T>>) -> Option<T> {
    let mut future = std::pin::pin!(future);
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    match future.as_mut().poll(&mut context) {
        std::task::Poll::Ready(value) => value,
        std::task::Poll::Pending => None,
    }
}
