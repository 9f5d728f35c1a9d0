//! The façade: an Earth that a wgpu host draws into its own pass.
//!
//! | file | what |
//! |---|---|
//! | `earth.rs` | preparation and drawing |
//! | `creation.rs` | creation, in one call or awaited |
//! | `options.rs` | options that are fixed at creation |
//! | `error.rs` | errors |
//! | `plan.rs` | the content of a frame, chosen without a GPU |
//! | `surface_config.rs` | configuration of the surface for a quality |
//! | `view.rs` | the eye and the target |
//! | `frame_request.rs` | what a frame is prepared for |
//! | `earth_view.rs` | the state of one view |
//! | `pixel_lattice.rs` | a lattice of image points, for measurements |
//! | `sky.rs` | Sun, Moon and stars |
//! | `glow.rs` | where airglow is in sight |
//! | `city_lights.rs` | which city lights may be in sight |
//! | `metering.rs` | exposure |
//! | `stats.rs` | statistics of a frame |
//! | `ground.rs` | terrain; `no_ground.rs` without the feature `terrain` |
//! | `tiles.rs` | which tiles of a pack a frame requests and draws; `no_tiles.rs` without the feature `tiles` |
//! | `tile_rule.rs` | the required level of a map |
//! | `tile_parts.rs` | which parts of blocks a frame requests |
//! | `tile_view.rs` | the inputs of tile selection, and the resulting detail |
//! | `changes.rs` | changes while the Earth is drawn |
//! | `appearance.rs` | terrain, light and air |
//! | `change_maker.rs` | prepares another quality or appearance off the frame's thread |
//! | `quality.rs` | quality settings and their reductions |
//! | `quality_ladder.rs`, `quality_ladder/` | the order of the reductions; the recorded measurement |
//! | `adaptive_quality.rs` | reduces quality to hold a frame time |
//! | `truth.rs` | the place that a pixel shows, in f64 |
//! | `diagnostics.rs` | output for measurements: geolocation, wireframe, vertices, shader features |

mod adaptive_quality;
mod appearance;
mod change_maker;
mod changes;
mod city_lights;
mod creation;
mod daylight;
mod diagnostics;
mod earth_view;
mod error;
mod frame_request;
mod glow;
#[cfg_attr(not(feature = "terrain"), path = "earth/no_ground.rs")]
mod ground;
mod metering;
mod options;
mod pixel_lattice;
mod plan;
mod quality;
mod quality_ladder;
mod sky;
mod stats;
mod surface_config;
#[cfg(feature = "tiles")]
mod tile_parts;
#[cfg(feature = "tiles")]
mod tile_rule;
mod tile_view;
#[cfg_attr(not(feature = "tiles"), path = "earth/no_tiles.rs")]
mod tiles;
mod truth;
mod view;

use crate::gpu::{
    AirDrawable, AirTextures, ErrorScope, PassFormat, SurfaceConfig, SurfaceDrawable,
};
pub use crate::gpu::{DepthBuffer, SurfaceOutput};
pub use crate::plan::{AIRGLOW_LUMINANCE, CITY_RADIANCE};
use crate::plan::{ChosenTiles, SurfaceLight};
pub use adaptive_quality::{AdaptiveQuality, QualityChange};
pub use appearance::Appearance;
pub use change_maker::{ChangeMaker, ReadyChange};
#[cfg(feature = "celestial")]
pub(crate) use daylight::{daylight_in_sight, gain_beside, gain_by_night};
pub use diagnostics::{DiagnosticOptions, Diagnostics};
pub use earth_view::EarthView;
pub use error::EarthError;
pub use frame_request::{FrameRequest, ViewFrame};
pub use ground::GroundOptions;
pub use metering::{metered_ev, night_gain_in};
pub use options::{EarthOptions, Pipelines};
pub use pixel_lattice::PixelLattice;
use plan::Planner;
pub use quality::{Quality, QualityReduction, TILED_SUBDIVISION};
pub use quality_ladder::{QualityLadder, QualityLadderError, QualityLevel, QualityStep};
pub use sky::Sky;
#[cfg(feature = "celestial")]
pub(crate) use sky::{moonlight, moonlight_of_phase};
pub use stats::FrameStats;
use std::sync::Arc;
use std::time::Duration;
use surface_config::{SurfaceStyle, surface_config};
use terrella_files::clock::Instant;
pub use terrella_ground::globe::Shading;
use terrella_ground::globe::{BlockSet, Figure};
use terrella_imagery::NeighbourhoodAlbedo;
#[cfg(feature = "tiles")]
use terrella_imagery::stream::TileLoad;
use terrella_imagery::tile::TileKey;
use tiles::TileDriver;
pub use tiles::TileOptions;
pub use truth::{TruthPoint, TruthView};
#[cfg(feature = "celestial")]
pub(crate) use view::ItrfView;
#[cfg(any(feature = "celestial", feature = "tracks"))]
pub(crate) use view::ball_bounds;
pub use view::{EyeView, PixelRays, ViewError, Viewport, infinite_reversed_z};

/// Bytes of tiles uploaded per round while an image waits for them.
const WAITING_UPLOAD_BYTES: u64 = 64_000_000;

/// How long an image waits for elevation data before it refines surfaces again.
const HEIGHTS_WAIT: Duration = Duration::from_millis(2);

/// The Earth.
///
/// The host owns device, queue, pass and depth buffer. Once a frame: [`Earth::prepare`], then [`Earth::render`] inside the host's pass. Neither
/// waits for disk or GPU. An Earth may be moved to another thread, and several threads may draw it at once.
///
/// It is its own first view; [`Earth::new_view`] makes more.
pub struct Earth {
    first: EarthView,
    surface: SurfaceDrawable,
    tiles: Option<TileDriver>,
    /// The blocks in sight of any view, with their tiles. Empty without a pack.
    chosen: ChosenTiles,
    figure: Figure,
    appearance: Appearance,
    device: wgpu::Device,
    style: SurfaceStyle,
    format: PassFormat,
    quality: Quality,
    /// Bytes of tiles uploaded by the last `prepare`.
    uploaded_tiles: u64,
    /// Error of a pipeline that was made for a frame.
    error: Option<EarthError>,
}

impl Earth {
    /// Checks that every pipeline that frames have needed so far was created.
    ///
    /// # Errors
    /// The first pipeline that failed; what it draws is missing from those frames. [`Pipelines::AtOnce`] creates all of them in advance.
    pub fn check_pipelines(&self) -> Result<(), EarthError> {
        match &self.error {
            None => Ok(()),
            Some(error) => Err(EarthError::rejected(error)),
        }
    }

    /// Whether there is a pipeline that would draw the image of the last [`Self::prepare`] faster, with [`Pipelines::Gradually`].
    pub fn has_next_pipeline(&self) -> bool {
        let view = &self.first;
        self.style.pipelines == Pipelines::Gradually
            && view.drawn.is_some()
            && self.surface.has_next(&view.plan)
    }

    /// Creates one of these pipelines. Call it when there is time for it. [`Self::check_pipelines`] returns an error; then a slower pipeline stays.
    pub fn make_next_pipeline(&mut self) {
        if !self.has_next_pipeline() {
            return;
        }
        let view = &mut self.first;
        let air = view.air.as_ref().map(AirDrawable::textures);
        let (style, format, ground) = (self.style, self.format, view.planner.ground());
        let config = surface_config(&self.device, style, format, &self.quality, air, ground);
        let (surface, plan) = (&mut view.surface, &view.plan);
        let made = self.surface.make_next(&self.device, &config, surface, plan);
        let error = match made {
            Ok(rejected) => rejected.map(EarthError::rejected),
            Err(error) => Some(error.into()),
        };
        if let Some(error) = error {
            tracing::warn!("the Earth is drawn more slowly than it could be: {error}");
            self.error = Some(error);
        }
    }

    /// Selects what the eye sees and uploads it to the GPU. Call it once per frame, before the pass. It never waits.
    ///
    /// Nothing is drawn if the image is undefined: the view or the sky is not finite, the Sun has no direction, the projection has no inverse, or
    /// the eye is beyond 1e24 m. A view of another Earth is not drawn; a warning is logged once. The returned statistics are those of the first
    /// image and include the uploaded bytes of all tiles.
    pub fn prepare(
        &mut self,
        queue: &wgpu::Queue,
        mut request: FrameRequest<'_, '_>,
    ) -> FrameStats {
        self.prepare_within(queue, &mut request, None)
    }

    /// Like [`Self::prepare`], but waits until every requested tile is on the GPU and the terrain is fully refined, for at most `timeout`. Use it
    /// for images that are kept. It returns the missing tiles; their blocks are drawn with coarser ones. It does not wait for a tile that cannot be
    /// read. `missing_heights` lists the missing elevation tiles. Tile levels and terrain triangles depend on this view only, not on earlier
    /// frames: the same view gives the same image.
    ///
    /// It submits its uploads to `queue`.
    pub fn prepare_complete(
        &mut self,
        queue: &wgpu::Queue,
        mut request: FrameRequest<'_, '_>,
        timeout: Duration,
    ) -> (FrameStats, Vec<TileKey>) {
        let deadline = Instant::now() + timeout;
        self.first.forget_views();
        for other in request.views.iter_mut() {
            other.view.forget_views();
        }
        loop {
            let budget = Some(WAITING_UPLOAD_BYTES);
            let stats = self.prepare_within(queue, &mut request, budget);
            let views = || request.views.iter().map(|other| &*other.view);
            let is_settled = self.first.is_settled() && views().all(EarthView::is_settled);
            let is_drawn = self.first.drawn.is_some() || views().any(|view| view.drawn.is_some());
            let is_in_time = Instant::now() < deadline;
            if !is_settled && is_in_time {
                if let Some(ground) = self.first.planner.ground_driver() {
                    ground.wait(HEIGHTS_WAIT);
                }
                queue.submit([]);
                continue;
            }
            // Surfaces that were refined while elevation data arrived depend on its order of arrival.
            let mut is_begun_anew = false;
            if is_settled && is_in_time {
                is_begun_anew = self.first.forget_views_again();
                for other in request.views.iter_mut() {
                    is_begun_anew |= other.view.forget_views_again();
                }
            }
            if is_begun_anew {
                continue;
            }
            let Some(tiles) = self.tiles.as_mut().filter(|_| is_drawn) else {
                return (stats, Vec::new());
            };
            // The tiles uploaded in this round are drawn in the next one.
            let left = deadline.saturating_duration_since(Instant::now());
            if self.uploaded_tiles == 0 && (tiles.is_settled() || left.is_zero()) {
                return (stats, tiles.missing().collect());
            }
            if self.uploaded_tiles == 0 {
                tiles.wait(left);
            }
            // Frees the staging copies of the uploads.
            queue.submit([]);
        }
    }

    /// Elevation tiles that would have refined the terrain of the last [`Self::prepare`]: tiles still loading, tiles that exceed the
    /// budget, and tiles that cannot be read.
    #[cfg(feature = "terrain")]
    pub fn missing_heights(&self) -> Vec<terrella_ground::elevation::HeightTileKey> {
        let ground = self.first.planner.ground_driver();
        ground.map_or_else(Vec::new, ground::GroundDriver::missing)
    }

    /// Restricts the prepared image to these points until the next [`Self::prepare`]. The pass must have one pixel per point and set the lattice's
    /// viewport.
    pub fn aim_at(&mut self, queue: &wgpu::Queue, view: &EyeView, points: &PixelLattice) {
        let rays = points.rays(view);
        let uniforms = &mut self.first.plan.uniforms;
        uniforms.corner_ray = rays.corner.as_vec3();
        uniforms.pixel_right = rays.right.as_vec3();
        uniforms.pixel_down = rays.down.as_vec3();
        self.first.surface.write_frame(queue, uniforms);
    }

    /// Announces where the eye is expected soon, the nearest time first, so that tiles are resident when it arrives. At most four views are used.
    /// They stay in effect until the next call. Without tiles it does nothing.
    pub fn prefetch(&mut self, views: &[EyeView]) {
        if let Some(tiles) = &mut self.tiles {
            tiles.prefetch(views);
        }
    }

    /// The exposure that [`Exposure::Auto`](terrella_ground::light::Exposure::Auto) would choose for a view, EV; `None` if the view has no image.
    /// For hosts that adapt it over time ([`terrella_ground::light::Adaptation`]) or expose a float target themselves.
    pub fn metered_ev(&mut self, view: &EyeView, sky: &Sky) -> Option<f64> {
        let planner = &mut self.first.planner;
        let ellipsoid = planner.ellipsoid();
        planner.exposure.metered_view(view, sky, &ellipsoid)
    }

    fn prepare_within(
        &mut self,
        queue: &wgpu::Queue,
        request: &mut FrameRequest<'_, '_>,
        upload_bytes: Option<u64>,
    ) -> FrameStats {
        if let Some(ground) = self.first.planner.ground_driver() {
            ground.take_over(upload_bytes.is_some());
        }
        let others = &mut *request.views;
        self.first.choose(request.eye, request.sky, request.target);
        for other in others.iter_mut() {
            if self.follow(other.view) {
                other.view.choose(other.eye, other.sky, other.target);
            } else {
                if !std::mem::replace(&mut other.view.is_rejected, true) {
                    tracing::warn!("a view of another Earth is not drawn");
                }
                other.view.drawn = None;
            }
        }
        let tiled = self.choose_tiles(queue, others, upload_bytes);
        let shared = self.surface.texture_bytes();
        for view in views(&mut self.first, others) {
            view.stats.texture_bytes = shared + view.air_textures().map_or(0, AirTextures::bytes);
            view.list_draws(tiled);
            let surface = &mut self.surface;
            if !surface.is_ready(&view.surface, &view.plan) || !view.is_air_ready() {
                let air = view.air.as_ref().map(AirDrawable::textures);
                let (style, format, ground) = (self.style, self.format, view.planner.ground());
                let config =
                    surface_config(&self.device, style, format, &self.quality, air, ground);
                let scope = ErrorScope::open(&self.device, wgpu::ErrorFilter::Validation);
                let ready =
                    surface.make_ready(&self.device, &config, &mut view.surface, &view.plan);
                let ready = ready.and_then(|()| view.make_air_ready(&self.device));
                let rejected = scope.error();
                let rejected = rejected.map(EarthError::rejected);
                if let Some(error) = ready.err().map(EarthError::from).or(rejected) {
                    tracing::warn!("a part of the Earth is not drawn: {error}");
                    self.error = Some(error);
                }
            }
            view.write(&self.device, queue);
        }
        self.first.stats
    }

    /// Selects resident tiles for all views, uploads those that have arrived, and records the cost in the statistics of the first view. Returns the
    /// blocks that have tiles if triangles span several blocks, else `None`.
    fn choose_tiles(
        &mut self,
        queue: &wgpu::Queue,
        others: &mut [ViewFrame<'_>],
        upload_bytes: Option<u64>,
    ) -> Option<BlockSet> {
        self.uploaded_tiles = 0;
        let tiles = self.tiles.as_mut()?;
        let first = &mut self.first;
        tiles.begin();
        let mut is_drawn = false;
        for view in views(first, others) {
            if let Some(seen) = &view.drawn {
                is_drawn = true;
                let grid = view.planner.meshes().grid();
                tiles.add(grid, seen, &view.plan.blocks, &mut view.levels);
            }
        }
        if !is_drawn {
            return None;
        }
        let grid = first.planner.meshes().grid();
        tiles.choose(grid, first.drawn.as_ref(), &mut self.chosen);
        let begin = Instant::now();
        let surface = &self.surface;
        let uploaded = tiles.upload(upload_bytes, &mut |part| surface.write_tile(queue, &part));
        let tile_upload = begin.elapsed();
        self.uploaded_tiles = uploaded;
        let tiled = first.planner.crosses_blocks();
        let tiled = tiled.then(|| self.chosen.tiled());
        let placed = self
            .surface
            .choose_tiles(&self.device, queue, &self.chosen, tiled);
        for view in views(first, others) {
            let Some(seen) = &view.drawn else {
                continue;
            };
            let grid = view.planner.meshes().grid();
            let detail = tiles.detail(grid, seen, &view.plan.blocks);
            view.stats.day_levels = detail.day_levels;
            view.stats.texels_per_pixel = detail.texels_per_pixel;
            view.stats.tiles = tiles.counters();
        }
        first.stats.tile_upload = tile_upload;
        first.stats.uploaded_bytes = uploaded + placed;
        tiled
    }

    /// Configuration of the surface for this air and this planner's terrain.
    fn config<'a>(&self, air: Option<&'a AirDrawable>, planner: &'a Planner) -> SurfaceConfig<'a> {
        let (style, format, ground) = (self.style, self.format, planner.ground());
        let air = air.map(AirDrawable::textures);
        surface_config(&self.device, style, format, &self.quality, air, ground)
    }

    /// Draws what [`Self::prepare`] selected into the host's pass: the surface through the atmosphere, then the halo and the clouds at the
    /// limb, and clouds over an eye below them. Draw opaque objects first: the halo then covers those behind the Earth.
    ///
    /// A host that draws Sun and stars calls the three parts instead, with the sky before the third: clouds hide it.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.render_surface(pass);
        self.render_air(pass);
        self.render_clouds_overhead(pass);
    }

    /// The first part of [`Self::render`].
    pub fn render_surface(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.render_surface_of(&self.first, pass);
    }

    /// The second part.
    pub fn render_air(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.render_air_of(&self.first, pass);
    }

    /// The third part. It draws nothing for an eye more than 1 km above the clouds.
    pub fn render_clouds_overhead(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.render_clouds_overhead_of(&self.first, pass);
    }

    fn render_clouds_overhead_of(&self, view: &EarthView, pass: &mut wgpu::RenderPass<'_>) {
        if view.drawn.is_some() && view.version == self.first.version {
            self.surface
                .render_clouds_overhead(pass, &view.surface, &view.plan);
        }
    }

    fn render_surface_of(&self, view: &EarthView, pass: &mut wgpu::RenderPass<'_>) {
        if view.drawn.is_none() || view.version != self.first.version {
            return;
        }
        // Without a depth buffer, the ground is drawn after the halo.
        if self.format.depth == DepthBuffer::None {
            render_halo(view, pass);
        }
        self.surface.render(pass, &view.surface, &view.plan);
    }

    fn render_air_of(&self, view: &EarthView, pass: &mut wgpu::RenderPass<'_>) {
        if view.drawn.is_none() || view.version != self.first.version {
            return;
        }
        if self.format.depth != DepthBuffer::None {
            render_halo(view, pass);
        }
        self.surface
            .render_clouds_at_limb(pass, &view.surface, &view.plan);
        if let Some(air) = &view.air {
            air.render_glow(pass, &view.plan);
        }
    }

    /// Name of the terrain surface, as scenes write it; `None` without terrain.
    #[cfg(feature = "terrain")]
    pub fn surface_name(&self) -> Option<&'static str> {
        self.first.planner.ground().map(|surface| surface.name())
    }

    /// Textures of the air for other drawables.
    pub(crate) fn air_textures(&self) -> Option<&AirTextures> {
        self.first.air_textures()
    }

    /// Mean albedo of neighbourhoods of the ground, clouds included: for hosts that light their own objects with the Earth.
    pub fn neighbourhood_albedo(&self) -> &Arc<NeighbourhoodAlbedo> {
        self.first.planner.exposure.albedo()
    }

    /// Format of the pass that the Earth is drawn in.
    pub fn format(&self) -> PassFormat {
        self.format
    }

    /// When pipelines are created.
    #[cfg(feature = "celestial")]
    pub(crate) fn pipelines(&self) -> Pipelines {
        self.style.pipelines
    }

    #[cfg(feature = "celestial")]
    pub(crate) fn first_view(&self) -> &EarthView {
        &self.first
    }

    /// Its figure.
    #[cfg(feature = "tracks")]
    pub(crate) fn ellipsoid(&self) -> terrella_frames::Ellipsoid {
        self.first.planner.ellipsoid()
    }

    /// Whether the air is drawn.
    pub fn has_air(&self) -> bool {
        self.first.air.is_some()
    }

    /// Whether its own view, as last prepared, is complete: its tiles are resident and its terrain is fully refined. A host can thus prepare an
    /// Earth of another pack beside the drawn one, and then swap them.
    pub fn is_settled(&self) -> bool {
        let has_tiles = self.tiles.as_ref().is_none_or(TileDriver::is_settled);
        self.first.is_settled() && self.uploaded_tiles == 0 && has_tiles
    }

    /// With [`TileLoading::Host`](terrella_imagery::stream::TileLoading::Host): the most urgent tile for the host to load, as of the last
    /// [`Self::prepare`]. `None` if there is nothing to load now.
    #[cfg(feature = "tiles")]
    pub fn take_tile(&self) -> Option<TileLoad> {
        self.tiles.as_ref()?.take()
    }

    /// Tiles that the last frame of all views should have been drawn with, but was not: they are loading, or could not be read.
    pub fn missing_tiles(&self) -> impl Iterator<Item = TileKey> + '_ {
        self.tiles.iter().flat_map(TileDriver::missing)
    }

    /// Whether blocks are drawn with tiles.
    pub fn has_tiles(&self) -> bool {
        self.tiles.is_some()
    }
}

/// All views of a frame.
fn views<'a>(
    first: &'a mut EarthView,
    others: &'a mut [ViewFrame<'_>],
) -> impl Iterator<Item = &'a mut EarthView> {
    let others = others.iter_mut().map(|other| &mut *other.view);
    std::iter::once(first).chain(others)
}

fn render_halo(view: &EarthView, pass: &mut wgpu::RenderPass<'_>) {
    if let Some(air) = &view.air {
        air.render(pass, &view.plan);
    }
}
