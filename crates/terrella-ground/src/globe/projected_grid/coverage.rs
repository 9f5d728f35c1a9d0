//! Which part of the plane the grid must cover so that no ground that shows is left out.
//!
//! The ground about the eye is cut into cells of rings and azimuths. Of a cell all points between its lowest and its
//! highest height are taken: if none of them lies in the picture and above the floor's horizon, the cell is dropped; if the
//! plane's rectangle holds it already, it says nothing new; if it is small, the rectangle grows to hold it; else it is cut
//! in two. So the rectangle holds every place that any heights inside the source's ranges could show, at any pitch.

use super::cast::Caster;
use super::relief::{RINGS, ReliefRings};
use super::screen::ScreenPlane;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;
use terrella_frames::Ellipsoid;

/// A rectangle of the grid's plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Least x and y.
    pub low: DVec2,
    /// Greatest x and y.
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

    /// Whether there is anything in it.
    pub fn is_empty(&self) -> bool {
        !(self.low.x <= self.high.x && self.low.y <= self.high.y)
    }

    /// Whether it holds another.
    pub fn holds(&self, other: &Self) -> bool {
        self.low.cmple(other.low).all() && other.high.cmple(self.high).all()
    }

    /// With so much more on each side.
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

/// Azimuths that each ring is cut into at first.
const SECTORS: u32 = 12;
/// Cells that a search looks at; those left over then are taken as they are.
const MAX_CELLS: usize = 5_000;
/// A cell is small when it is this part of the rectangle: at first, and in the end.
const ROUGH: f64 = 1.0 / 8.0;
const SMALL: f64 = 1.0 / 48.0;
/// A cell that the eye sees larger than this, radians, is not asked whether the rectangle holds it: its outline is not that
/// of its corners.
const FLAT: f64 = 0.35;

/// Finds the rectangle. Holds its list of cells from frame to frame.
#[derive(Debug, Default)]
pub struct CoverageFinder {
    cells: Vec<Cell>,
    /// Cells that the last search looked at.
    pub looked_at: usize,
}

impl CoverageFinder {
    /// With room for all cells that can wait at once.
    pub fn new() -> Self {
        Self {
            cells: Vec::with_capacity(RINGS * SECTORS as usize + MAX_CELLS),
            looked_at: 0,
        }
    }

    /// Bytes of its list.
    pub fn resident_bytes(&self) -> usize {
        self.cells.capacity() * size_of::<Cell>()
    }

    /// The rectangle for an eye, or `None` where no ground can show.
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
        // First roughly, to know how large a cell of the answer is small; then finely. Where that would take too long, the
        // rough answer stands: it is no smaller.
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

    /// The rectangle of all cells, from a part of it that is known, and how many cells were looked at. `small` is the size
    /// of cells that are not cut, in units of the plane; `None` goes by the rectangle as it grows.
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

    /// Part of the rectangle that is known to be needed: what the picture's rays meet.
    fn seed(&self) -> Rect {
        const STEPS: u32 = 16;
        let caster = self.caster;
        let rays = (0..=STEPS)
            .flat_map(|j| (0..=STEPS).map(move |i| DVec2::new(f64::from(i), f64::from(j))));
        let hits = rays
            .map(|at| at * (2.0 / f64::from(STEPS)) - 1.0)
            .filter(|at| caster.nadir(self.screen.direction(*at)) < caster.limb_rad);
        // A disc that is small in the picture may lie between those rays.
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

    /// Whether any point of the cell, between its heights, may lie in the picture and before the horizon.
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
        // Ground as far from the cell's middle as its corners, and its normals leaning with it.
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

    /// The cell on the plane, with more to each side than its corners span, and its size along and across.
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
