//! The projected grid of the 2009 paper: a grid ruled on the screen, cast on the ellipsoid and raised by the ground's heights.
//!
//! The number of vertices is fixed; their positions change in each frame. The view's tolerance is therefore not used. The error of the
//! image depends on the number of samples, and no bound of it is known. A frame has these steps:
//! 1. [`ReliefRings`]: the range of the ground's heights, ring by ring about the eye, and how far ground can be visible;
//! 2. the *base* that rays are cast on: the ellipsoid raised to the ground under the eye, so that samples are spaced by the ground's
//!    distance and not by the ellipsoid's;
//! 3. [`CoverageFinder`]: the rectangle of the screen's plane ([`ScreenPlane`]) whose ground may be in the image;
//! 4. m × n samples over it, evenly in x and y, each cast to a place on the ground ([`Caster`]);
//! 5. each place raised along the ellipsoid's normal by its height, averaged over the sample's spacing.
//!
//! Ground must be covered if it can be visible at some height between the ground's lowest h₁ and highest h₂. That needs θ ≤ acos(R₁/L) +
//! acos(R₁/R₂), where θ is its angle from the eye at the centre. The grid is cast on the base, but does not end at the base's limb: rays
//! above the limb continue to the ground behind it, up to that θ. On flat ground both limits are the limb, and rays that miss end on it
//! exactly.
//!
//! The spacing of a sample is the root of its area of ground, √(along × across). Samples move over the ground with the eye. Heights at
//! fixed places then change, as far as the average leaves terrain finer than the grid. See [`SampleFootprint`] and [`Anchor`] for
//! measurements.

mod cast;
mod coverage;
mod relief;
mod screen;
#[cfg(test)]
mod tests;
mod tiles;
mod triangles;
mod uniforms;

pub use cast::{Cast, Caster, Foot, cast};
pub use coverage::{CoverageFinder, Rect};
pub use relief::{RINGS, ReliefRings, Ring};
pub use screen::ScreenPlane;
pub use tiles::SHARPER;
pub use tiles::{
    HeightTile, HeightTiles, TileCounts, TileWindow, WINDOW_SAMPLES, eye_place, first_density,
    level_of, level_spacing_rad, pyramid_level,
};

pub use super::surface::{
    GridLevel, GridUniforms, LEVELS, NO_SLOT, TILE_CELLS, TILE_SAMPLES, WINDOW_TILES,
};
use super::{
    DrawKind, Figure, GridDraw, GroundVertex, GroundView, IndexRange, Patch, Surface, SurfaceStats,
};
use crate::elevation::{Elevation, HeightChange};
use glam::{DMat4, DVec2, DVec3, UVec2, Vec2};
use std::sync::Arc;
use terrella_frames::{Ellipsoid, Geodetic};
use triangles::indices;

/// Width of ground over which a sample's height is averaged.
///
/// Measured over rough ground (waves from 200 km to 50 m, 1280 × 720), from 2 km, 2 m a frame. Heights at fixed places change by 0.004 px a
/// frame (root mean square; 0.02 px at most) with the mean and by 0.003 px with the longer; without an average by 0.017 px. Their errors
/// compared with the ground itself are 0.66 px, 1.17 px and 0.61 px. From 400 km, 127 m a frame: 0.001, 0.001 and 0.006 px a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SampleFootprint {
    /// √(along × across), the root of the sample's area.
    #[default]
    Mean,
    /// The longer of along and across.
    Longer,
}

/// Reference to which samples are fixed when the eye moves.
///
/// Measured with an eye at 2 km that turns by 0.1° a frame. Heights at fixed places change by 0.009 px a frame with the direction and by
/// 0.015 px with the screen. A third way was worse than both: samples on the nearest node of a fixed lattice of latitude and longitude. Its
/// nodes stay, but triangles jump from node to node (0.062 px, 0.95 px at most).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Anchor {
    /// The direction of the grid's middle, in the Earth's axes. When the view turns, the grid keeps that direction and moves over the
    /// screen by up to half a cell. Then it goes back by a cell, and samples take their neighbours' places.
    #[default]
    Direction,
    /// The screen: samples move over the ground.
    Screen,
}

/// Options of a projected grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridOptions {
    /// Samples across and down, 2…1025 each; other values are clamped.
    pub samples: (u32, u32),
    /// The figure of the Earth.
    pub figure: Figure,
    /// Width of ground over which a height is averaged.
    pub footprint: SampleFootprint,
    /// Reference to which samples are fixed.
    pub anchor: Anchor,
    /// Whether the GPU computes the vertices, with heights from cached tiles. Otherwise the CPU computes them, and reads the heights again.
    ///
    /// At 1280 × 720, from 500 m to 30 km over mountains, the GPU form takes 1.1 to 1.3 ms to prepare. The CPU form takes 4.4 ms and more.
    /// It writes 7 kB a frame instead of 400 kB, plus new tiles. On a software adapter, frames took equally long with both. Errors (99 % of
    /// pixels) differ there by less than a tenth. Near a pole, where windows of tiles are cut, the CPU form's errors are several times
    /// smaller.
    pub on_gpu: bool,
}

/// Height tiles that the GPU form holds: more than any view needs, 8.4 MB. 31 rows of 16 are a texture that every device supports.
pub const GPU_TILES: u32 = 496;
/// Largest number of tiles loaded in a frame: fewer heights than the CPU form reads.
pub const GPU_LOADS: u32 = 3;
/// The same if most tiles of a view are missing: the eye has then come from elsewhere.
pub const GPU_FIRST_LOADS: u32 = 64;

impl GridOptions {
    /// The defaults, with vertices made on the CPU.
    pub fn on_cpu() -> Self {
        Self {
            on_gpu: false,
            ..Self::default()
        }
    }
}

impl Default for GridOptions {
    fn default() -> Self {
        Self {
            samples: (129, 129),
            figure: Figure::default(),
            footprint: SampleFootprint::default(),
            anchor: Anchor::default(),
            on_gpu: true,
        }
    }
}

/// Smallest distance between the eye and the base, metres. An eye in the ground is treated as this far above it.
pub const MIN_CLEARANCE_M: f64 = 0.5;
/// Farthest eye for which ground is drawn, metres.
const FARTHEST_M: f64 = 1e24;
/// Largest part of the grid's angle used for the limb (κ of [`Caster`]), radians.
const MAX_SPREAD_RAD: f64 = 0.15;
/// Smallest such part where ground behind the limb can be visible, cells. From far away all terrain at the limb is smaller than a cell. If
/// the ground ended at the last ray that hits, part of a pixel of its outline would be missing.
const LIMB_CELLS: f64 = 2.0;
/// The rectangle's margin, in cells, for the chords of its edge.
const MARGIN_CELLS: f64 = 1.5;
/// Additional margin of a new rectangle, in cells, so that it suffices for later frames.
const SLACK_CELLS: f64 = 2.0;
/// The size of the frame before is kept while a new rectangle would be at least this fraction of it, each way.
const KEPT: f64 = 0.9;

/// One frame's grid in f64: all data that a vertex is computed from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridFrame {
    pub ellipsoid: Ellipsoid,
    pub eye_itrf_m: DVec3,
    /// Takes eye-relative ITRF metres to clip space.
    pub clip_from_eye: DMat4,
    /// Rays of the screen.
    pub screen: ScreenPlane,
    /// Casts those rays at the ground.
    pub caster: Caster,
    /// The part of the plane that the grid covers.
    pub rect: Rect,
    /// Step from one sample to the next, across and upwards.
    pub step: DVec2,
    /// Samples across and down.
    pub samples: (u32, u32),
    /// Width of ground over which a height is averaged.
    pub footprint: SampleFootprint,
}

/// A grid point before it is raised.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GridSample {
    /// Position on the unit sphere of scaled space.
    pub place: DVec3,
    /// Half the width of ground over which its height is averaged, radians.
    pub spacing_rad: f64,
}

impl GridFrame {
    /// The sample of a column, from the left, and a row, from the bottom.
    pub fn sample(&self, column: u32, row: u32) -> GridSample {
        // A mirrored image is ruled from right to left, so that triangles stay counter-clockwise from above.
        let column = if self.screen.mirrored {
            self.samples.0 - 1 - column
        } else {
            column
        };
        let at = self.rect.low + self.step * DVec2::new(f64::from(column), f64::from(row));
        let (direction, area) = self.screen.ray(at);
        let foot = self.caster.foot(direction);
        let (along, across) = foot.stretch;
        let square = match self.footprint {
            SampleFootprint::Mean => along * across,
            SampleFootprint::Longer => along.max(across).powi(2),
        };
        let area = area * self.step.x * self.step.y;
        GridSample {
            place: foot.place,
            spacing_rad: (area * square).sqrt().min(1.0),
        }
    }
}

/// A grid on the screen, cast on the ellipsoid. It belongs to one source of heights: a frame equal to the one before is not read again,
/// unless its heights have changed.
#[derive(Debug)]
pub struct ProjectedGrid {
    options: GridOptions,
    finder: CoverageFinder,
    frame: Option<GridFrame>,
    /// Increases with each change of the frame.
    revision: u64,
    /// The frame's data for the GPU.
    uniforms: Option<Box<GridUniforms>>,
    /// Heights for the GPU, which then computes the vertices: there are none here.
    tiles: Option<HeightTiles>,
    /// The frame of the patch's vertices.
    raised: Option<GridFrame>,
    samples: Vec<RaisedPoint>,
    patch: Patch,
}

/// A grid point with its height.
#[derive(Clone, Copy, Debug, Default)]
struct RaisedPoint {
    /// The foot on the ellipsoid, eye-relative ITRF metres.
    foot_m: DVec3,
    /// Outward normal.
    normal: DVec3,
    height_m: f64,
}

impl RaisedPoint {
    fn of(frame: &GridFrame, sample: &GridSample, ground: &dyn Elevation) -> Self {
        let radii_m = frame.caster.radii_m;
        let normal = (sample.place * frame.caster.per_radius).normalize();
        let lat_rad = normal.z.atan2(normal.truncate().length());
        let lon_rad = normal.y.atan2(normal.x);
        Self {
            foot_m: sample.place * radii_m - frame.eye_itrf_m,
            normal,
            height_m: ground.height_m(lat_rad, lon_rad, sample.spacing_rad),
        }
    }
}

impl ProjectedGrid {
    /// Allocates all memory that it will need.
    pub fn new(options: &GridOptions) -> Self {
        let clamp = |n: u32| n.clamp(2, 1025);
        let samples = (clamp(options.samples.0), clamp(options.samples.1));
        let count = match options.on_gpu {
            true => 0,
            false => samples.0 as usize * samples.1 as usize,
        };
        Self {
            options: GridOptions {
                samples,
                ..*options
            },
            finder: CoverageFinder::new(),
            frame: None,
            revision: 0,
            uniforms: None,
            tiles: options.on_gpu.then(|| HeightTiles::new(GPU_TILES)),
            raised: None,
            samples: vec![RaisedPoint::default(); count],
            patch: Patch {
                key: 0,
                revision: 0,
                origin_itrf_m: DVec3::ZERO,
                vertices: vec![GroundVertex::default(); count],
                changed: Vec::with_capacity(1),
                indices: Arc::new(indices(samples)),
                block: None,
            },
        }
    }

    /// The grid of the last view, `None` if no ground is visible.
    pub fn frame(&self) -> Option<&GridFrame> {
        self.frame.as_ref()
    }

    /// Chooses the grid for a view without reading the heights of its samples, as the GPU form needs.
    pub fn aim(&mut self, view: &GroundView, ground: &dyn Elevation) -> Option<GridFrame> {
        let last = self.frame.take();
        let eye_itrf_m = view.eye_itrf_m;
        // A comparison with NaN is false.
        if !(eye_itrf_m.is_finite() && eye_itrf_m.abs().max_element() < FARTHEST_M) {
            return None;
        }
        let ellipsoid = self.options.figure.ellipsoid();
        let eye = eye_itrf_m * ellipsoid.scaled_from_itrf();
        if eye.length() < 0.5 {
            return None;
        }
        let screen = ScreenPlane::new(&view.clip_from_eye)?;
        let relief = ReliefRings::new(&ellipsoid, eye_itrf_m, ground);
        let clearance_m = clearance(&ellipsoid, eye_itrf_m, ground);
        let mut caster = Caster::new(&ellipsoid, eye_itrf_m, clearance_m);
        caster.far_rad = relief.horizon.far_rad().max(caster.near_rad);
        let limb_m = caster.cos_limb * eye_itrf_m.length();
        if caster.far_rad > caster.near_rad {
            let least_rad = LIMB_CELLS * self.cell_rad(&screen, &caster);
            caster.spread_rad = (relief.span_m / limb_m.max(1.0))
                .max(least_rad)
                .min(MAX_SPREAD_RAD);
        }
        let needed = self
            .finder
            .find(&ellipsoid, eye_itrf_m, &screen, &caster, &relief)?;
        let rect = self.place_rect(&needed, last.as_ref(), &screen);
        let (columns, rows) = self.options.samples;
        self.frame = Some(GridFrame {
            ellipsoid,
            eye_itrf_m,
            clip_from_eye: view.clip_from_eye,
            screen,
            caster,
            rect,
            step: rect.size() / UVec2::new(columns - 1, rows - 1).as_dvec2(),
            samples: self.options.samples,
            footprint: self.options.footprint,
        });
        self.frame
    }

    /// Approximate angle of a cell, radians: for an image full of ground, or for the whole disc in it.
    fn cell_rad(&self, screen: &ScreenPlane, caster: &Caster) -> f64 {
        let (columns, rows) = self.options.samples;
        let across = screen.right.length().min(caster.limb_rad) / f64::from(columns - 1);
        let down = screen.up.length().min(caster.limb_rad) / f64::from(rows - 1);
        2.0 * across.max(down)
    }

    /// The rectangle of the grid: the needed part with a margin. The size of the frame before is kept while it suffices. With
    /// [`Anchor::Direction`] the rectangle is shifted by less than half a cell each way.
    fn place_rect(&self, needed: &Rect, last: Option<&GridFrame>, screen: &ScreenPlane) -> Rect {
        let (columns, rows) = self.options.samples;
        let cells = DVec2::new(f64::from(columns - 1), f64::from(rows - 1));
        let least = needed.grown(needed.size() * MARGIN_CELLS / cells);
        let fresh = needed.grown(needed.size() * (MARGIN_CELLS + SLACK_CELLS) / cells);
        let Some(last) = last else {
            return fresh;
        };
        let (size, step) = (last.rect.size(), last.step);
        // Half a cell on each side is reserved for the shift.
        let will_do = step.min_element() > 0.0
            && (least.size() + step).cmple(size).all()
            && (size * KEPT).cmple(fresh.size()).all();
        if !will_do {
            return fresh;
        }
        if self.options.anchor != Anchor::Direction {
            if last.rect.holds(&least) {
                return last.rect;
            }
            return fresh;
        }
        let low = 0.5 * (needed.low + needed.high - size);
        let at = last.rect.low + step * (0.5 * cells).floor();
        let direction = last.screen.direction(at);
        let now = screen.place_of(direction);
        let cell = (now - low) / step;
        let low = low + (cell - cell.round()) * step;
        Rect {
            low,
            high: low + size,
        }
    }

    fn raise(&mut self, frame: &GridFrame, ground: &dyn Elevation) {
        let (columns, rows) = frame.samples;
        let mut index = 0;
        for row in 0..rows {
            for column in 0..columns {
                let sample = frame.sample(column, row);
                self.samples[index] = RaisedPoint::of(frame, &sample, ground);
                index += 1;
            }
        }
        let step = |index: u32, count: u32| (index.saturating_sub(1), (index + 1).min(count - 1));
        let at = |column: u32, row: u32| (row * columns + column) as usize;
        for row in 0..rows {
            let (below, over) = step(row, rows);
            for column in 0..columns {
                let (left, right) = step(column, columns);
                let here = &self.samples[at(column, row)];
                let pair = |one: usize, other: usize| {
                    let (one, other) = (&self.samples[one], &self.samples[other]);
                    (other.foot_m - one.foot_m, other.height_m - one.height_m)
                };
                let slope = slope(
                    here.normal,
                    pair(at(left, row), at(right, row)),
                    pair(at(column, below), at(column, over)),
                );
                self.patch.vertices[at(column, row)] = GroundVertex {
                    from_origin_m: (here.foot_m + here.normal * here.height_m).as_vec3(),
                    height_m: here.height_m as f32,
                    slope,
                };
            }
        }
    }
}

/// Depth of the base below the eye, metres: down to the ground there, averaged over a width equal to that distance.
fn clearance(ellipsoid: &Ellipsoid, eye_itrf_m: DVec3, ground: &dyn Elevation) -> f64 {
    let Geodetic {
        lat_rad,
        lon_rad,
        height_m,
    } = ellipsoid.geodetic_from_itrf(eye_itrf_m);
    let over = |spacing_m: f64| {
        let spacing_rad = (spacing_m / ellipsoid.polar_radius_m).min(1.0);
        height_m - ground.height_m(lat_rad, lon_rad, spacing_rad)
    };
    let first = over(height_m.abs());
    over(first.abs()).max(MIN_CLEARANCE_M)
}

/// Rise to the east and to the north, from the differences in foot and height between two pairs of neighbours. 0 if they span no ground.
fn slope(normal: DVec3, one: (DVec3, f64), other: (DVec3, f64)) -> Vec2 {
    let level = normal.truncate().length();
    // East and north, both as long as `level`. At a pole, where all ways are north or south, east is along y.
    let (level, east) = if level > 1e-9 {
        (level, DVec3::new(-normal.y, normal.x, 0.0))
    } else {
        (1.0, DVec3::Y)
    };
    let north = normal.cross(east);
    let on_ground = |v: DVec3| DVec2::new(v.dot(east), v.dot(north));
    let (a, b) = (on_ground(one.0), on_ground(other.0));
    let determinant = a.perp_dot(b);
    let (a_squared, b_squared) = (a.length_squared(), b.length_squared());
    let rise = if determinant.abs() > 1e-3 * (a_squared * b_squared).sqrt() && determinant != 0.0 {
        DVec2::new(one.1 * b.y - other.1 * a.y, other.1 * a.x - one.1 * b.x) / determinant
    } else if a_squared.max(b_squared) > 0.0 {
        // Collinear, as at the edge where rays end: use the rise along the line.
        if a_squared > b_squared {
            a * (one.1 / a_squared)
        } else {
            b * (other.1 / b_squared)
        }
    } else {
        DVec2::ZERO
    };
    (rise * level).as_vec2()
}

impl Surface for ProjectedGrid {
    fn name(&self) -> &'static str {
        "projected-grid"
    }

    fn prepare(&mut self, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats {
        let (columns, rows) = self.options.samples;
        let resident_bytes = self.samples.len()
            * (size_of::<RaisedPoint>() + size_of::<GroundVertex>())
            + size_of_val(self.patch.indices.triangles.as_slice())
            + self.finder.resident_bytes()
            + self.tiles.as_ref().map_or(0, HeightTiles::resident_bytes);
        let mut stats = SurfaceStats {
            resident_bytes: resident_bytes as u64,
            ..SurfaceStats::default()
        };
        let before = self.frame;
        let Some(frame) = self.aim(view, ground) else {
            return stats;
        };
        self.revision += u64::from(before != Some(frame));
        stats.patches = 1;
        stats.vertices = columns * rows;
        stats.triangles = (self.patch.indices.triangles.len() / 3) as u32;
        if let Some(tiles) = &mut self.tiles {
            let counts = tiles.update(&frame, ground, GPU_LOADS);
            let mut loaded = counts.loaded;
            if 2 * counts.missing > counts.wanted {
                loaded += tiles.update(&frame, ground, GPU_FIRST_LOADS).loaded;
            }
            stats.samples_read = u64::from(loaded * TILE_SAMPLES * TILE_SAMPLES);
            let uniforms = GridUniforms::new(&frame, tiles);
            match &mut self.uniforms {
                Some(held) => **held = uniforms,
                None => self.uniforms = Some(Box::new(uniforms)),
            }
        } else if self.raised != Some(frame) {
            self.raise(&frame, ground);
            self.raised = Some(frame);
            self.patch.origin_itrf_m = frame.eye_itrf_m;
            self.patch.revision += 1;
            self.patch.changed.clear();
            self.patch.changed.push(0..stats.vertices);
            stats.samples_read = u64::from(stats.vertices);
        }
        stats
    }

    fn heights_changed(&mut self, changes: &[HeightChange], _: &dyn Elevation) {
        self.raised = None;
        // The old heights determined the grid's placement. It is chosen again, as if the new heights had always been there.
        self.frame = None;
        if let Some(tiles) = &mut self.tiles {
            tiles.heights_changed(changes);
        }
    }

    fn forget_views(&mut self) {
        // The next frame would keep its size.
        self.frame = None;
    }

    fn crosses_blocks(&self) -> bool {
        true
    }

    fn for_each_patch(&self, draw: &mut dyn FnMut(&Patch)) {
        if self.frame.is_some() && self.tiles.is_none() {
            draw(&self.patch);
        }
    }

    fn grid_ranges(&self, ranges: &mut Vec<IndexRange>) {
        match &self.frame {
            Some(frame) => triangles::grid_ranges(frame, ranges),
            None => ranges.clear(),
        }
    }

    fn draw_kind(&self) -> DrawKind<'_> {
        match &self.tiles {
            Some(tiles) => DrawKind::Grid(GridDraw {
                uniforms: self.frame.and(self.uniforms.as_deref()),
                revision: self.revision,
                heights_m: tiles.heights_m(),
                written: tiles.written(),
                indices: &self.patch.indices,
            }),
            None => DrawKind::Patches,
        }
    }
}
