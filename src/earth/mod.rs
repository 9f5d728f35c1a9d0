//! The façade: an Earth that a wgpu host draws into its own pass.
//!
//! | file | what |
//! |---|---|
//! | `mod.rs` | the three verbs |
//! | `options.rs` | what is fixed when an Earth is made |
//! | `plan.rs` | what a frame draws, chosen without a GPU |
//! | `look.rs` | how the surface is drawn with a quality |
//! | `view.rs` | the eye and the target |
//! | `stats.rs` | what a frame drew |
//! | `ground.rs` | ground with relief, where there is any |
//! | `tiles.rs` | which tiles of a pack a frame wants and is drawn with |
//! | `quality.rs` | what can be given up to draw faster, and in what order |
//! | `governor.rs` | when it is given up, to hold a frame time |
//! | `diagnostics.rs` | what is not for pictures: where pixels look, edges of triangles, what the shaders hold |

mod diagnostics;
mod governor;
mod ground;
mod look;
mod options;
mod plan;
mod quality;
mod stats;
mod tiles;
mod view;

use crate::air::Atmosphere;
use crate::frames::{Epoch, Orientation, sun_direction_itrf_oriented};
pub use crate::globe::Shading;
use crate::globe::{DrawKind, Surface};
use crate::gpu::{AirDrawable, FramePlan, PassFormat, SurfaceDrawable};
pub use crate::gpu::{DepthBuffer, SurfaceOutput};
use crate::imagery::tile::TileKey;
pub use diagnostics::{DiagnosticOptions, Diagnostics};
use glam::DVec3;
pub use governor::{Change, Governor};
pub use ground::GroundOptions;
use look::{Style, look};
pub use options::{EarthError, EarthOptions};
use plan::Planner;
pub use quality::{GiveUp, Quality, Rung};
pub use stats::FrameStats;
use std::time::{Duration, Instant};
use tiles::TileDriver;
pub use tiles::{TILED_SUBDIVISION, TileOptions};
pub use view::{EyeView, Viewport, infinite_reversed_z};

/// What lights the Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Vector to the Sun in ITRF axes, of length 1; of any other finite length it is made a unit vector.
    pub sun_itrf: DVec3,
}

impl Sky {
    /// The sky of a date, UT1 taken as UTC and polar motion left out: the Sun is up to 13.5″ off.
    pub fn at(epoch: Epoch) -> Self {
        Self::with_orientation(epoch, &Orientation::default())
    }

    /// The sky of a date over an Earth of that orientation.
    pub fn with_orientation(epoch: Epoch, orientation: &Orientation) -> Self {
        Self {
            sun_itrf: sun_direction_itrf_oriented(epoch, orientation),
        }
    }

    /// The same with a Sun of length 1; `None` where that has no direction or is not finite.
    fn with_unit_sun(self) -> Option<Self> {
        let sun = self.sun_itrf;
        if (sun.length_squared() - 1.0).abs() < 1e-6 {
            return Some(self);
        }
        // By the largest component first: squares of very long vectors are infinite, of very short ones 0.
        let largest = sun.abs().max_element();
        (sun.is_finite() && largest > 0.0).then(|| Self {
            sun_itrf: (sun / largest).normalize(),
        })
    }
}

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
    device: wgpu::Device,
    style: Style,
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
        if options.diagnostics.output == SurfaceOutput::Geolocation {
            quality.atmosphere = Atmosphere::None;
        }
        let planner = Planner::new(options, &quality, &device.limits())?;
        let is_cast =
            |ground: &dyn Surface| matches!(ground.draw_kind(), DrawKind::ContourPages(_));
        if options.diagnostics.wireframe && planner.ground().is_some_and(is_cast) {
            return Err(EarthError::NoEdges);
        }
        let format = PassFormat {
            color: options.color_format,
            samples: options.samples,
            depth: options.depth,
        };
        let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let air = match quality.atmosphere {
            Atmosphere::Billboard => Some(AirDrawable::new(device, queue, format)?),
            Atmosphere::None => None,
        };
        let style = Style {
            shading: options.shading,
            diagnostics: options.diagnostics,
        };
        let look = look(
            device,
            style,
            format,
            &quality,
            (air.as_ref(), planner.ground()),
        );
        let pools = planner.tiles.as_ref().map(TileDriver::pools);
        let grids = planner.meshes().grids();
        let surface = SurfaceDrawable::new(device, queue, grids, &options.layers, pools, &look)?;
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

    /// As [`Self::prepare`], but waits until every tile that the view wants is on the GPU, and ground with relief is as fine
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

    /// Says where the eye is expected soon, the nearest time first, so that tiles are there when it comes. At most four
    /// views are looked at; they stand until others are given. Without tiles it does nothing.
    pub fn expect(&mut self, views: &[EyeView]) {
        if let Some(tiles) = &mut self.planner.tiles {
            tiles.expect(views);
        }
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
        if self.style.diagnostics.output == SurfaceOutput::Geolocation {
            quality.atmosphere = Atmosphere::None;
        }
        let meshes = self.planner.meshes_of(quality.subdivision)?;
        let format = PassFormat {
            samples: quality.samples,
            ..self.format
        };
        let device = self.device.clone();
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        // The air's tables need not be uploaded again where its pipelines fit.
        let fits = quality.samples == self.format.samples;
        let air = match (quality.atmosphere, self.air.take().filter(|_| fits)) {
            (Atmosphere::None, _) => None,
            (Atmosphere::Billboard, Some(air)) => Some(air),
            (Atmosphere::Billboard, None) => Some(AirDrawable::new(&device, queue, format)?),
        };
        let with = (air.as_ref(), self.planner.ground());
        let look = look(&device, self.style, format, &quality, with);
        self.surface.set_look(&device, meshes.grids(), &look)?;
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
            self.surface.texture_bytes + self.air.as_ref().map_or(0, |air| air.texture_bytes);
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
            let air = u32::from(self.plan.air.is_some());
            stats.draw_calls = costs.draw_calls + air;
            stats.triangles = costs.triangles + 2 * air;
            stats.ground_bytes = costs.bytes;
        }
        if let Some((air, plan)) = self.air.as_mut().zip(self.plan.air.as_ref()) {
            stats.uploaded_bytes += air.write(queue, plan);
        }
    }

    /// Draws what [`Self::prepare`] chose into the host's pass: the surface, then the air over it. Draw opaque things
    /// before, so that the air lies over those behind it.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.render_surface(pass);
        self.render_air(pass);
    }

    /// The first part of [`Self::render`], for a host that measures them apart or draws between them what lies beyond the
    /// air's near boundary ([`crate::tracks`]).
    pub fn render_surface(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.drawable {
            self.surface.render(pass, &self.plan);
        }
    }

    /// The second part.
    pub fn render_air(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(air) = self.air.as_ref().filter(|_| self.drawable) {
            air.render(pass);
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

/// The value of a future that is ready at once, as wgpu's error scopes are everywhere but on the web.
fn resolved<T>(future: impl Future<Output = Option<T>>) -> Option<T> {
    let mut future = std::pin::pin!(future);
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    match future.as_mut().poll(&mut context) {
        std::task::Poll::Ready(value) => value,
        std::task::Poll::Pending => None,
    }
}
