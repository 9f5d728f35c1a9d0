//! The part of the plane that the grid must cover so that no visible ground is left out.
//!
//! The ground about the eye is divided into cells of rings and azimuths. A cell contains all points between its lowest and its highest
//! height. It is dropped if none of them is in the image and above the floor's horizon. It is skipped if the plane's rectangle already
//! contains it. If the cell is small, the rectangle grows to contain it; otherwise the cell is cut in two. The rectangle therefore contains
//! every place that any heights within the source's ranges could make visible, at any pitch.

use super::cast::Caster;
use super::relief::{RINGS, ReliefRings};
use super::screen::ScreenPlane;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;
use terrella_frames::Ellipsoid;

/// A rectangle of the grid's plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Smallest x and y.
    pub low: DVec2,
    /// Largest x and y.
    pub high: DVec2,
}

impl Rect {
    const EMPTY: Self = Self {
        low: DVec2::INFINITY,
        high: DVec2::NEG_INFINITY,
    };

    /// Width and height.
    pub fn size(&self) -> DVec2 {
        self.high - self.low
    }

    /// Whether the rectangle is empty.
    pub fn is_empty(&self) -> bool {
        !(self.low.x <= self.high.x && self.low.y <= self.high.y)
    }

    /// Whether the rectangle contains another.
    pub fn holds(&self, other: &Self) -> bool {
        self.low.cmple(other.low).all() && other.high.cmple(self.high).all()
    }

    /// The rectangle grown by `by` on each side.
    pub fn grown(&self, by: DVec2) -> Self {
        Self {
            low: self.low - by,
            high: self.high + by,
        }
    }

    fn add(&mut self, other: &Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
    }

    fn of(points: impl Iterator<Item = DVec2>) -> Self {
        points.fold(Self::EMPTY, |mut rect, point| {
            rect.add(&Self {
                low: point,
                high: point,
            });
            rect
        })
    }
}

/// Ground between two angles from the eye's radius and two azimuths about it.
#[derive(Clone, Copy, Debug)]
struct Cell {
    ring: usize,
    theta: (f64, f64),
    azimuth: (f64, f64),
}

/// Number of azimuths that each ring is first divided into.
const SECTORS: u32 = 12;
/// Largest number of cells that a search divides; the remaining cells are added undivided.
const MAX_CELLS: usize = 5_000;
/// A cell is small below this fraction of the rectangle: in the rough search, then in the fine one.
const ROUGH: f64 = 1.0 / 8.0;
const SMALL: f64 = 1.0 / 48.0;
/// Cells that appear larger than this to the eye, radians, skip the test against the rectangle. Their outline is not that of their corners.
const FLAT: f64 = 0.35;

/// Finds the rectangle. Keeps its list of cells from frame to frame.
#[derive(Debug, Default)]
pub struct CoverageFinder {
    cells: Vec<Cell>,
    /// Number of cells that the last search examined.
    pub looked_at: usize,
}

impl CoverageFinder {
    /// Allocates room for all cells that can be pending at once.
    pub fn new() -> Self {
        Self {
            cells: Vec::with_capacity(RINGS * SECTORS as usize + MAX_CELLS),
            looked_at: 0,
        }
    }

    /// Bytes of the list of cells.
    pub fn resident_bytes(&self) -> usize {
        self.cells.capacity() * size_of::<Cell>()
    }

    /// The rectangle for an eye, or `None` if no ground can be visible.
    pub fn find(
        &mut self,
        ellipsoid: &Ellipsoid,
        eye_itrf_m: DVec3,
        screen: &ScreenPlane,
        caster: &Caster,
        relief: &ReliefRings,
    ) -> Option<Rect> {
        let view = View {
            eye_itrf_m,
            screen,
            caster,
            relief,
            axes: caster.level_axes(),
            sides: screen.sides(),
            widest_m: ellipsoid.equatorial_radius_m.max(ellipsoid.polar_radius_m),
        };
        let seed = view.seed();
        // A rough search first, to find the size of a small cell; then a fine one. If the fine search takes too long, the rough result is
        // used: it is no smaller.
        let (rough, rough_cells) = self.search(&view, seed, None);
        if rough.is_empty() {
            self.looked_at = rough_cells;
            return None;
        }
        let small = rough.size().max_element() * SMALL;
        let (fine, fine_cells) = self.search(&view, seed, Some(small));
        self.looked_at = rough_cells + fine_cells;
        let is_whole = fine_cells < MAX_CELLS && !fine.is_empty();
        Some(if is_whole { fine } else { rough })
    }

    /// The rectangle of all cells, starting from a part that is known, and the number of cells examined. `small` is the size of cells that
    /// are not cut, in units of the plane; `None` derives it from the growing rectangle.
    fn search(&mut self, view: &View, seed: Rect, small: Option<f64>) -> (Rect, usize) {
        let mut rect = seed;
        let rings = &view.relief.rings;
        let sector_rad = TAU / f64::from(SECTORS);
        self.cells.clear();
        for (ring, outer) in rings.iter().enumerate() {
            let inner_rad = ring.checked_sub(1).map_or(0.0, |k| rings[k].outer_rad);
            self.cells.extend((0..SECTORS).map(|sector| {
                let west = f64::from(sector) * sector_rad;
                Cell {
                    ring,
                    theta: (inner_rad, outer.outer_rad),
                    azimuth: (west, west + sector_rad),
                }
            }));
        }
        let mut looked_at = 0;
        while let Some(cell) = self.cells.pop() {
            looked_at += 1;
            if !view.shows(&cell) {
                continue;
            }
            let (outline, along, across) = view.outline(&cell);
            if rect.holds(&outline) && along.max(across) < FLAT {
                continue;
            }
            let small = small.unwrap_or_else(|| {
                let size = if rect.is_empty() {
                    2.0
                } else {
                    rect.size().max_element()
                };
                size * ROUGH
            });
            if outline.size().max_element() <= small || looked_at >= MAX_CELLS {
                rect.add(&outline);
                continue;
            }
            let (mut one, mut other) = (cell, cell);
            if along > across {
                let (inner, outer) = cell.theta;
                let middle = if inner > 0.0 {
                    (inner * outer).sqrt()
                } else {
                    0.25 * outer
                };
                (one.theta.1, other.theta.0) = (middle, middle);
            } else {
                let middle = 0.5 * (cell.azimuth.0 + cell.azimuth.1);
                (one.azimuth.1, other.azimuth.0) = (middle, middle);
            }
            self.cells.extend([one, other]);
        }
        (rect, looked_at)
    }
}

struct View<'a> {
    eye_itrf_m: DVec3,
    screen: &'a ScreenPlane,
    caster: &'a Caster,
    relief: &'a ReliefRings,
    axes: (DVec3, DVec3),
    sides: [DVec3; 5],
    widest_m: f64,
}

impl View<'_> {
    fn aside(&self, azimuth: f64) -> DVec3 {
        let (sin, cos) = azimuth.sin_cos();
        self.axes.0 * cos + self.axes.1 * sin
    }

    /// Part of the rectangle that is known to be needed: the ground that the image's rays hit.
    fn seed(&self) -> Rect {
        const STEPS: u32 = 16;
        let caster = self.caster;
        let rays = (0..=STEPS)
            .flat_map(|j| (0..=STEPS).map(move |i| DVec2::new(f64::from(i), f64::from(j))));
        let hits = rays
            .map(|at| at * (2.0 / f64::from(STEPS)) - 1.0)
            .filter(|at| caster.nadir(self.screen.direction(*at)) < caster.limb_rad);
        // A disc that is small in the image may be between those rays.
        let rings = (0..8_u32).flat_map(|ring| {
            (0..16_u32).filter_map(move |sector| {
                let theta = caster.near_rad * f64::from(ring) / 8.0;
                let at = caster.on_screen(
                    self.screen,
                    theta,
                    self.aside(f64::from(sector) * TAU / 16.0),
                );
                (at.abs().max_element() <= 1.0).then_some(at)
            })
        });
        Rect::of(hits.chain(rings))
    }

    /// Whether any point of the cell, between its heights, may be in the image and before the horizon.
    fn shows(&self, cell: &Cell) -> bool {
        let ring = &self.relief.rings[cell.ring];
        let visible_m = self.relief.horizon.lowest_visible_m(cell.theta.0);
        let low_m = ring.low_m.max(visible_m);
        if low_m > ring.high_m {
            return false;
        }
        let theta = 0.5 * (cell.theta.0 + cell.theta.1);
        let azimuth = 0.5 * (cell.azimuth.0 + cell.azimuth.1);
        let (sin, cos) = theta.sin_cos();
        let place = self.caster.up * cos + self.aside(azimuth) * sin;
        let normal = (place * self.caster.per_radius).normalize();
        let bottom = place * self.caster.radii_m + normal * low_m - self.eye_itrf_m;
        let rise = normal * (ring.high_m - low_m);
        // Ground as far from the cell's middle as its corners, with normals that lean accordingly.
        let half = 0.5 * (cell.theta.1 - cell.theta.0);
        let widest = cell.theta.1.min(std::f64::consts::FRAC_PI_2).sin();
        let turn = 0.5 * (cell.azimuth.1 - cell.azimuth.0) * widest;
        let reach_m = half.hypot(turn) * (self.widest_m + ring.high_m.max(0.0)) * 1.01;
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for side in &self.sides {
            let start = side.dot(bottom) + reach_m;
            let change = side.dot(rise);
            if start < 0.0 && start + change < 0.0 {
                return false;
            }
            // start + part · change ≥ 0.
            if start < 0.0 {
                from = from.max(-start / change);
            } else if start + change < 0.0 {
                to = to.min(-start / change);
            }
        }
        from <= to
    }

    /// The cell on the plane, extended beyond the span of its corners, and its size along and across.
    fn outline(&self, cell: &Cell) -> (Rect, f64, f64) {
        let at = |i: u32, j: u32| {
            let theta = cell.theta.0 + (cell.theta.1 - cell.theta.0) * 0.5 * f64::from(i);
            let azimuth = cell.azimuth.0 + (cell.azimuth.1 - cell.azimuth.0) * 0.5 * f64::from(j);
            self.caster
                .on_screen(self.screen, theta, self.aside(azimuth))
        };
        let corners = [at(0, 0), at(0, 2), at(2, 0), at(2, 2)];
        let middle = at(1, 1);
        let rect = Rect::of(corners.into_iter().chain([middle]));
        let [a, b, c, d] = corners;
        let along = (a.distance(c)).max(0.5 * (a + b).distance(middle + middle));
        let across = (a.distance(b)).max(c.distance(d));
        // In units of the plane's angle.
        let unit = self.screen.right.length().max(self.screen.up.length());
        (rect.grown(rect.size() * 0.4), along * unit, across * unit)
    }
}
