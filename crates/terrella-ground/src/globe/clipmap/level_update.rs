//! How levels follow the eye: which are wanted, which move, and which wait for samples.

use super::lattice::{Icosahedron, LatticeIndex};
use super::level::{HeightSource, Level};
use super::level_extent::LevelExtent;
use super::{ClipmapCounts, ClipmapOptions, Trim, level};
use crate::elevation::{Bounds, Elevation, HeightRange};
use crate::globe::culling::{Frustum, GroundShell, Horizon};
use crate::globe::surface::GroundView;
use glam::DVec3;
use terrella_frames::Ellipsoid;

/// Largest distance of the eye from a level's middle before the level moves, in quarters of a cell. It is half a cell more than the largest
/// distance to the nearest even point: that is the hysteresis.
const REST: i64 = 6;

/// Largest number of levels that move in one call; the others lag by a few cells meanwhile.
const MAX_MOVES: u32 = 2;

/// Assumed rise of the ground between neighbouring samples, as a fraction of their distance.
const RISE: f64 = 1.0 / 16.0;

/// Cells across a cell of the data from which finer levels help little. Few triangles then cross the edges of the data's cells, where the
/// ground bends. No finer level corrects the error of those triangles for most pixels.
const ACROSS: f64 = 64.0;

/// Largest reach of a level, as a multiple of the angle of `radius` mean cells. The sharp corners of a diamond of 60° are at √3, and cells
/// are up to 1.2 times as long there.
const FARTHEST: f64 = 2.1;

/// A level stays while the data that require it are within this multiple of its reach.
const LINGER: f64 = 1.25;

/// Fraction of its reach that the eye may move before a level searches again for the finest data in it.
const LOOK: f64 = 1.0 / 32.0;

/// Hysteresis: a drawn level is tested with this fraction of the tolerance.
const STAY: f64 = 0.75;

/// From the middle of a diamond of the icosahedron to its sharp corners, radians: atan of the golden ratio.
const SHARP_CORNER_RAD: f64 = 1.017_221_967_897_851_4;

/// Bound of the rounding of buffer origins, metres.
const ROUNDED_M: f64 = 4.0;

/// The point below the eye, and the detail needed there.
pub struct SubEyePoint {
    diamond: u8,
    /// Fractions of the diamond's edges, 0…1.
    x: f64,
    y: f64,
    /// Allowed error of the drawn terrain, metres.
    tolerance_m: f64,
    lat_rad: f64,
    lon_rad: f64,
    radius_m: f64,
}

/// The finest data found about a point.
pub struct FinestData {
    normal: DVec3,
    lingers: bool,
    finest_m: f64,
}

impl SubEyePoint {
    /// `None` if the eye's position is not finite.
    pub fn new(
        icosahedron: &Icosahedron,
        ellipsoid: &Ellipsoid,
        view: &GroundView,
        ground: &dyn Elevation,
    ) -> Option<Self> {
        if !view.eye_itrf_m.is_finite() {
            return None;
        }
        let eye = ellipsoid.geodetic_from_itrf(view.eye_itrf_m);
        if !(eye.lat_rad.is_finite() && eye.lon_rad.is_finite() && eye.height_m.is_finite()) {
            return None;
        }
        let (diamond, x, y) = icosahedron.locate(Ellipsoid::normal(eye.lat_rad, eye.lon_rad));
        let ground_m = ground.height_m(eye.lat_rad, eye.lon_rad, 0.0);
        // Below the ground, the distance to the ground counts too.
        let above_m = (eye.height_m - ground_m).abs().max(1.0);
        let radius_m = ellipsoid.equatorial_radius_m;
        Some(Self {
            diamond,
            x,
            y,
            tolerance_m: (view.tolerance_px * view.pixel_rad * above_m).max(0.0),
            lat_rad: eye.lat_rad,
            lon_rad: eye.lon_rad,
            radius_m,
        })
    }

    /// The nearest point of a lattice of `n` cells.
    fn nearest(&self, n: i64) -> LatticeIndex {
        LatticeIndex {
            diamond: self.diamond,
            i: (self.x * n as f64).round() as i64,
            j: (self.y * n as f64).round() as i64,
        }
    }

    /// Distance from a point of a lattice of `n` cells to the eye, in quarters of a cell; very large if out of reach.
    fn lag(&self, middle: LatticeIndex, n: i64) -> i64 {
        let from = LevelExtent::new(middle.scaled(4), 4 * n, 2 * n, Trim::Diamond);
        from.distance(self.nearest(4 * n)).unwrap_or(i64::MAX)
    }

    /// Sample spacing of the finest data within a level's reach, metres; infinite on flat ground. A result stays valid until the eye has
    /// moved some distance.
    fn finest_m(
        &self,
        number: u32,
        lingers: bool,
        found: &mut Option<FinestData>,
        ground: &dyn Elevation,
    ) -> f64 {
        let reach_rad = FARTHEST * level::EDGE_RAD * 0.5_f64.powi(number as i32);
        let normal = Ellipsoid::normal(self.lat_rad, self.lon_rad);
        if let Some(found) = found
            && found.lingers == lingers
            && found.normal.distance(normal) < LOOK * reach_rad
        {
            return found.finest_m;
        }
        let linger = if lingers { LINGER } else { 1.0 };
        let angle_rad = (linger + LOOK) * reach_rad;
        let bounds = Bounds::around(self.lat_rad, self.lon_rad, angle_rad);
        let finest_m = ground.finest_spacing_in(&bounds) * self.radius_m;
        *found = Some(FinestData {
            normal,
            lingers,
            finest_m,
        });
        finest_m
    }

    /// Whether cells of `spacing_m` are too coarse for data of `finest_m`. `part` is the fraction of the tolerance to use.
    fn needs_finer(&self, spacing_m: f64, finest_m: f64, part: f64) -> bool {
        let tolerance_m = self.tolerance_m * part;
        // Depth of a cell's chord below the sphere. A millimetre is not visible.
        let sagitta_m = spacing_m * spacing_m / (8.0 * self.radius_m);
        sagitta_m > tolerance_m.max(1e-3)
            || (spacing_m * ACROSS > finest_m && spacing_m * RISE > tolerance_m)
    }
}

/// Moves, fills, starts and ends levels for an eye.
pub fn update_levels(
    levels: &mut Vec<Level>,
    found: &mut [Option<FinestData>],
    options: &ClipmapOptions,
    eye: &SubEyePoint,
    source: &HeightSource<'_>,
    clock: &mut u64,
    counts: &mut ClipmapCounts,
) {
    let radius = i64::from(options.samples / 2);
    let mut budget = options.samples_per_prepare;
    let fade_step = 1.0 / f64::from(options.fade_prepares.max(1));
    // Whether the coarser level is drawn unblended, so that a finer one may be inside it.
    let mut open = true;
    for number in 1..=options.levels {
        let at = number as usize;
        let spacing_m = level::EDGE_RAD / (radius << (number - 1)) as f64 * eye.radius_m;
        let there = levels.get(at).is_some_and(|level| level.extent.is_some());
        let finest_m = eye.finest_m(number, there, &mut found[at], source.ground);
        let wanted = eye.needs_finer(spacing_m, finest_m, if there { STAY } else { 1.0 });
        counts.wanted += u32::from(wanted);
        if levels.len() <= at {
            if !wanted {
                break;
            }
            levels.push(Level::new(number, radius, options.trim));
        }
        let finer = levels
            .get(at + 1)
            .is_some_and(|finer| finer.extent.is_some());
        let (coarse, fine) = levels.split_at_mut(at);
        let (coarse, level) = (&coarse[at - 1], &mut fine[0]);

        let mut turned = false;
        if let Some(extent) = level.extent.clone() {
            let lag = eye.lag(extent.middle, level.n);
            let mut settled = lag <= 4 * most_lag(radius) && lies_in(coarse, &extent);
            if open && lag > REST && counts.moved < MAX_MOVES {
                let target = target(level, eye);
                if lies_in(coarse, &target) && level.missing(&target) <= budget {
                    level.fill(&target, source, &mut budget, clock);
                    level.extent = Some(target);
                    counts.moved += 1;
                    (settled, turned) = (true, true);
                }
            }
            if !(open && settled) {
                level.suspend();
            }
        }
        if level.extent.is_none() && wanted {
            let near = |aim: &&LevelExtent| eye.lag(aim.middle, level.n) <= 4 * most_lag(radius);
            let aim = level.pending().filter(near).cloned();
            let aim = aim.unwrap_or_else(|| target(level, eye));
            let ready = open && lies_in(coarse, &aim);
            if level.await_extent(aim, source, &mut budget, clock) {
                if ready {
                    level.fade = if options.fade_prepares > 0 { 1.0 } else { 0.0 };
                    turned = true;
                } else {
                    level.hold();
                }
            }
        }
        if level.extent.is_none() && !wanted {
            level.suspend();
        }
        if level.extent.is_some() {
            let before = level.fade;
            if wanted {
                level.fade = (level.fade - fade_step).max(0.0);
            } else if before >= 1.0 || options.fade_prepares == 0 {
                level.suspend();
            } else if !finer {
                level.fade = (level.fade + fade_step).min(1.0);
            }
            if turned || level.fade != before {
                level.blend_into(Some(coarse));
            }
        }
        if level.extent.is_some() {
            counts.finest = number;
        }
        open = level.extent.is_some() && level.fade == 0.0;
    }
    counts.samples = options.samples_per_prepare - budget;
}

/// The extent that a level should have.
fn target(level: &Level, eye: &SubEyePoint) -> LevelExtent {
    level.extent_about(eye.nearest(level.n / 2).scaled(2))
}

/// Largest distance of the eye from the middle of a drawn level, cells.
fn most_lag(radius: i64) -> i64 {
    radius / 10
}

/// Whether an extent is where the coarser level is drawn unblended, outside the zone where that blends into the next one.
fn lies_in(coarse: &Level, extent: &LevelExtent) -> bool {
    match &coarse.extent {
        Some(around) => around
            .distance(extent.middle.halved())
            .is_some_and(|steps| steps + extent.radius / 2 <= around.radius - coarse.blend()),
        None => coarse.number == 0,
    }
}

/// Whether any part of a diamond of level 0 may be in the image; `middle_m` is the diamond's middle, ITRF metres.
pub fn is_base_visible(
    middle_m: DVec3,
    view: &GroundView,
    ellipsoid: &Ellipsoid,
    range: HeightRange,
    cell_rad: f64,
) -> bool {
    let (a, b) = (ellipsoid.equatorial_radius_m, ellipsoid.polar_radius_m);
    // Triangles are below their corners by up to 1 − cos r of the Earth's radius, with r = e/√3 about their middle. Their sides are up to
    // 1.2 times as long as the mean.
    let sag_m = a.max(b) * 0.25 * cell_rad * cell_rad;
    let drawn = HeightRange {
        low_m: range.low_m - sag_m,
        ..range
    };
    let horizon = Horizon::new(
        ellipsoid,
        view.eye_itrf_m,
        GroundShell::new(ellipsoid, drawn),
    );
    // The lattice consists of normals. Angles between feet in scaled space are larger by at most the ratio of the axes.
    let half_rad = SHARP_CORNER_RAD * a.max(b) / a.min(b);
    let axis = (middle_m * ellipsoid.scaled_from_itrf()).normalize();
    if horizon.hides_cap(axis, half_rad) {
        return false;
    }
    let relief_m = drawn.low_m.abs().max(drawn.high_m.abs());
    let radius_m = 2.0 * (0.5 * half_rad).sin() * a.max(b) + relief_m + ROUNDED_M;
    !Frustum::new(&view.clip_from_eye).excludes_ball(middle_m - view.eye_itrf_m, radius_m)
}
