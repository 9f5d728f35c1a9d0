//! Terrain: the surface that a scene selects, and its elevation data.

use super::view::ItrfView;
use crate::gpu::{GridMesh, PageMesh};
use crate::plan::{DeviceLimits, GroundDraws, SurfaceDraw};
use std::fmt;
use std::sync::Arc;
use std::time::Duration;
use terrella_frames::Ellipsoid;
use terrella_ground::elevation::{
    Bounds, Elevation, Ground, HeightChange, HeightEye, HeightTileKey, HeightTileStats,
    HeightViewer, StreamedGround, TILES_PER_FRAME,
};
use terrella_ground::globe::contours::ContourOptions;
use terrella_ground::globe::projected_grid::GPU_TILES;
use terrella_ground::globe::{
    Block, BlockGrid, BlockSet, DrawKind, Figure, GroundView, Surface, SurfaceError,
    SurfaceSettings, SurfaceStats, select_blocks_between,
};

/// Terrain in place of the smooth ellipsoid.
#[derive(Clone)]
pub struct GroundOptions {
    /// The elevation data: entirely in memory, or streamed ([`StreamedGround`]).
    pub elevation: Arc<dyn Elevation>,
    /// The surface that draws the terrain, with its settings.
    pub surface: SurfaceSettings,
    /// Largest difference of the drawn terrain from its data, pixels, for surfaces that bound it; 0 requests full detail.
    pub tolerance_px: f64,
}

impl GroundOptions {
    /// Whether the terrain is the same: the same surface over the same elevation data.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.elevation, &other.elevation)
            && self.surface == other.surface
            && self.tolerance_px == other.tolerance_px
    }
}

impl fmt::Debug for GroundOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GroundOptions")
            .field("surface", &self.surface)
            .field("tolerance_px", &self.tolerance_px)
            .finish_non_exhaustive()
    }
}

/// Prepares the surface for each frame and reports when it is settled.
pub(super) struct GroundDriver {
    elevation: Arc<dyn Elevation>,
    /// For elevation data that is refined while it is drawn.
    followed: Option<Followed>,
    settings: SurfaceSettings,
    figure: Figure,
    surface: Box<dyn Surface>,
    draws: GroundDraws,
    tolerance_px: f64,
    before: SurfaceStats,
    /// Frames since data was last read or the drawing last changed.
    quiet: u32,
    /// Nothing drawn depends on views or elevation data from before the surface last forgot them.
    has_forgotten: bool,
}

/// Streamed elevation data as of the last frame.
struct Followed {
    viewer: Arc<HeightViewer>,
    version: u64,
    heights: Arc<Ground>,
}

/// Finest spacing of requested elevation samples, pixels, even if the tolerance asks for finer.
const LEAST_SAMPLE_PX: f64 = 0.5;

/// Number of equal frames after which a surface is settled: more than a level needs to fade in.
const QUIET_FRAMES: u32 = 10;

impl GroundDriver {
    /// If the device lacks the capacity, a projected grid is computed on the CPU instead of the GPU, and cast contours are drawn as patches. A
    /// warning is logged.
    pub fn new(
        options: &GroundOptions,
        figure: Figure,
        limits: &DeviceLimits,
    ) -> Result<Self, SurfaceError> {
        let mut surface = options.surface;
        if let SurfaceSettings::ProjectedGrid(grid) = &mut surface
            && grid.on_gpu
            && !GridMesh::fits(limits, GPU_TILES)
        {
            tracing::warn!(
                "this device's textures or uniforms are too small for the projected grid; its vertices are made on the CPU"
            );
            grid.on_gpu = false;
        }
        if let SurfaceSettings::CastContours(pages) = &surface
            && !PageMesh::fits(limits, pages)
        {
            tracing::warn!(
                "this device's fragment shaders cannot read so large a storage buffer; contours are drawn as patches"
            );
            surface = SurfaceSettings::Contours(ContourOptions::default());
        }
        let tolerance_px = options.tolerance_px.max(0.0);
        Self::made(options.elevation.clone(), surface, figure, tolerance_px)
    }

    fn made(
        elevation: Arc<dyn Elevation>,
        settings: SurfaceSettings,
        figure: Figure,
        tolerance_px: f64,
    ) -> Result<Self, SurfaceError> {
        let followed = elevation.streamed().map(|stream| {
            let (version, heights) = stream.now();
            Followed {
                viewer: stream.viewer(),
                version,
                heights,
            }
        });
        Ok(Self {
            elevation,
            followed,
            surface: settings.make(figure)?,
            draws: GroundDraws::default(),
            settings,
            figure,
            tolerance_px,
            before: SurfaceStats::default(),
            quiet: 0,
            has_forgotten: false,
        })
    }

    /// The same terrain for another eye, with nothing built yet.
    pub fn for_another_view(&self) -> Result<Self, SurfaceError> {
        let elevation = self.elevation.clone();
        Self::made(elevation, self.settings, self.figure, self.tolerance_px)
    }

    /// Takes over elevation data that has arrived, for all users of the same stream. Call it between frames. If an image waits (`waits`), it takes
    /// over everything available.
    pub fn take_over(&self, waits: bool) {
        if let Some(stream) = self.elevation.streamed() {
            stream.take_over(if waits { usize::MAX } else { TILES_PER_FRAME });
        }
    }

    /// Waits until elevation data requested by a view has arrived, or until the timeout; returns at once if none is being loaded.
    pub fn wait(&self, timeout: Duration) {
        let stream = self.elevation.streamed();
        if let Some(stream) = stream.filter(|stream| !stream.is_settled()) {
            stream.wait(timeout);
        }
    }

    /// Elevation tiles that were requested and are not resident.
    pub fn missing(&self) -> Vec<HeightTileKey> {
        let stream = self.elevation.streamed();
        stream.map_or_else(Vec::new, StreamedGround::missing)
    }

    /// Counters of the elevation stream.
    pub fn height_tiles(&self) -> HeightTileStats {
        let stream = self.elevation.streamed();
        stream.map_or_else(HeightTileStats::default, StreamedGround::counters)
    }

    /// Switches to the current elevation data, and reports changes to the surface.
    fn follow(&mut self, eye_itrf_m: glam::DVec3, pixel_rad: f64) {
        let (Some(stream), Some(followed)) = (self.elevation.streamed(), &mut self.followed) else {
            return;
        };
        followed.viewer.look(HeightEye {
            eye_itrf_m,
            tolerance_rad: pixel_rad * self.tolerance_px.max(LEAST_SAMPLE_PX),
        });
        let (version, heights) = stream.now();
        if version == followed.version {
            return;
        }
        // If the log of changes does not reach back far enough, anything may have changed.
        let everywhere = || HeightChange {
            bounds: Bounds::GLOBE,
            below_rad: f64::INFINITY,
            range: heights.range_m(&Bounds::GLOBE),
        };
        let changes = stream.changes_since(followed.version);
        let changes = changes.unwrap_or_else(|| vec![everywhere()]);
        self.surface.heights_changed(&changes, heights.as_ref());
        (followed.version, followed.heights) = (version, heights);
        self.quiet = 0;
        self.has_forgotten = false;
    }

    /// Selects what is drawn, and the blocks in sight, whose tiles it is drawn with. Returns statistics, and the upper limit of the elevation of all
    /// terrain, metres above the ellipsoid.
    pub fn plan(
        &mut self,
        grid: &BlockGrid,
        view: &ItrfView,
        blocks: &mut Vec<Block>,
    ) -> (SurfaceStats, f64) {
        let (eye_itrf_m, clip_from_eye) = (view.eye_itrf_m, view.clip_from_eye);
        self.follow(eye_itrf_m, view.pixel_rad());
        let heights: &dyn Elevation = match &self.followed {
            Some(followed) => followed.heights.as_ref(),
            None => self.elevation.as_ref(),
        };
        let range = heights.range_m(&Bounds::GLOBE);
        select_blocks_between(grid, range, eye_itrf_m, &clip_from_eye, blocks);
        let view = GroundView {
            eye_itrf_m,
            clip_from_eye,
            pixel_rad: view.pixel_rad(),
            tolerance_px: self.tolerance_px,
        };
        let stats = self.surface.prepare(&view, heights);
        let is_quiet = stats.samples_read == 0 && stats == self.before;
        self.quiet = if is_quiet { self.quiet + 1 } else { 0 };
        self.before = stats;
        (stats, range.high_m)
    }

    /// Lists the draws of the selection. `tiled` has the blocks with tiles, if triangles span several blocks.
    pub fn list_draws(
        &mut self,
        ellipsoid: &Ellipsoid,
        tiled: Option<BlockSet>,
        draws: &mut Vec<SurfaceDraw>,
    ) {
        let surface = self.surface.as_ref();
        self.draws.list(surface, ellipsoid, tiled, draws);
    }

    /// Makes the next selection independent of earlier views.
    pub fn forget_views(&mut self) {
        self.surface.forget_views();
        (self.quiet, self.has_forgotten) = (0, true);
    }

    /// Whether elevation data is unchanged since views were forgotten.
    pub fn has_forgotten(&self) -> bool {
        self.has_forgotten
    }

    /// Whether a static view would be drawn the same again.
    pub fn is_settled(&self) -> bool {
        let stream = self.elevation.streamed();
        self.quiet >= QUIET_FRAMES && stream.is_none_or(StreamedGround::is_settled)
    }

    pub fn surface(&self) -> &dyn Surface {
        self.surface.as_ref()
    }

    /// Whether it is drawn as triangles, which have edges to draw.
    pub fn has_edges(&self) -> bool {
        !matches!(self.surface.draw_kind(), DrawKind::ContourPages(_))
    }

    /// Names of the shader features that the surface turns on.
    pub fn features(&self) -> &'static [&'static str] {
        match self.surface.draw_kind() {
            DrawKind::Grid(_) => &["relief", "grid"],
            DrawKind::ContourPages(_) => &["relief", "cast"],
            DrawKind::Patches => &["relief"],
        }
    }
}
