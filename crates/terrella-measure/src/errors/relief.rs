//! Drawn terrain compared with its elevation data.

use super::{GeolocationBuffer, pixel_at};
use crate::SortedSample;
use glam::{DMat4, DVec3};
use rayon::prelude::*;
use terrella::EyeView;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::internals::earth::PixelLattice;
use terrella_ground::elevation::{Bounds, Elevation};
use terrella_reference::{Rays, TrueRelief};

/// A drawn picture of ground: what each pixel shows, and how wrong it is there.
#[derive(Clone, Debug)]
pub struct GroundPicture {
    points: PixelLattice,
    view: EyeView,
    eye_itrf_m: DVec3,
    clip_from_eye: DMat4,
    /// By point, row by row; `None` is space.
    pixels: Vec<Option<DrawnPixel>>,
}

/// The ground that a pixel shows.
#[derive(Clone, Copy, Debug)]
struct DrawnPixel {
    /// The point of the data's ground over the same place, ITRF metres.
    truth_itrf_m: DVec3,
    /// Height drawn less height of the data, metres.
    error_m: f64,
    /// That, seen from the eye, pixels; its sign is the height's.
    error_px: f64,
}

/// Part of a distance by which two count as the same: the ground within a pixel has several.
const SAME_DISTANCE: f64 = 1e-3;

/// Errors over a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GroundErrors {
    /// Pixels that show ground.
    pub pixels: usize,
    /// Median of the vertical distance between drawn ground and data, metres.
    pub median_m: f64,
    /// 99th percentile, metres.
    pub p99_m: f64,
    /// Largest, metres.
    pub max_m: f64,
    /// Median of how far drawn ground appears from where its place should, pixels.
    pub median_px: f64,
    /// 99th percentile, pixels.
    pub p99_px: f64,
    /// Largest, pixels.
    pub max_px: f64,
    /// Pixels of space where ground must be: through the lowest ground there is, or below other ground.
    pub holes: usize,
    /// Pixels that show what is not to be seen there: [`GroundPicture::elsewhere`].
    pub elsewhere: usize,
    /// Number of pixels compared, space included.
    pub looked_at: usize,
}

impl GroundErrors {
    /// Of both pictures: the largest errors, pixels summed.
    pub fn combined(&self, other: &Self) -> Self {
        Self {
            pixels: self.pixels + other.pixels,
            median_m: self.median_m.max(other.median_m),
            p99_m: self.p99_m.max(other.p99_m),
            max_m: self.max_m.max(other.max_m),
            median_px: self.median_px.max(other.median_px),
            p99_px: self.p99_px.max(other.p99_px),
            max_px: self.max_px.max(other.max_px),
            holes: self.holes + other.holes,
            elsewhere: self.elsewhere + other.elsewhere,
            looked_at: self.looked_at + other.looked_at,
        }
    }

    /// Part of the pixels that show what is not to be seen there, %.
    pub fn elsewhere_percent(&self) -> f64 {
        100.0 * self.elsewhere as f64 / (self.looked_at.max(1)) as f64
    }
}

impl GroundPicture {
    /// Holds what was drawn against the data at their finest. `None` for a view without pixels.
    pub fn new(
        places: &GeolocationBuffer,
        view: &EyeView,
        figure: &Ellipsoid,
        ground: &dyn Elevation,
    ) -> Option<Self> {
        let points = PixelLattice::whole(places.size);
        Self::of_points(places, view, &points, figure, ground)
    }

    /// The same of a picture that is looked at in some of its points.
    pub fn of_points(
        places: &GeolocationBuffer,
        view: &EyeView,
        points: &PixelLattice,
        figure: &Ellipsoid,
        ground: &dyn Elevation,
    ) -> Option<Self> {
        let (columns, rows) = points.points;
        let (eye_itrf_m, clip_from_eye) = view.to_itrf();
        let rays = Rays::new(view, points.picture)?;
        let forward = view.view_from_world.inverse() * DVec3::NEG_Z;
        let forward = view.itrf_from_world.transform_vector3(forward).normalize();
        let drawn = |k: u32| {
            let (x, y) = (k % columns, k / columns);
            let along = places.along(x, y)?;
            let at = points.at(x, y);
            let ray = rays.at(at.x, at.y);
            let drawn_m = eye_itrf_m + ray * (along / ray.dot(forward));
            let drawn = figure.geodetic_from_itrf(drawn_m);
            let true_height_m = ground.height_m(drawn.lat_rad, drawn.lon_rad, 0.0);
            let truth_itrf_m = figure.itrf_from_geodetic(Geodetic {
                height_m: true_height_m,
                ..drawn
            });
            let error_m = drawn.height_m - true_height_m;
            let shown = pixel_at(&clip_from_eye, points.picture, truth_itrf_m - eye_itrf_m);
            let error_px = shown.map_or(f64::INFINITY, |shown| shown.distance(at));
            Some(DrawnPixel {
                truth_itrf_m,
                error_m,
                error_px: error_px.copysign(error_m),
            })
        };
        Some(Self {
            points: *points,
            view: *view,
            eye_itrf_m,
            clip_from_eye,
            pixels: (0..columns * rows).into_par_iter().map(drawn).collect(),
        })
    }

    fn at(&self, x: u32, y: u32) -> Option<&DrawnPixel> {
        let (columns, rows) = self.points.points;
        let is_inside = x < columns && y < rows;
        let index = y as usize * columns as usize + x as usize;
        self.pixels.get(index).filter(|_| is_inside)?.as_ref()
    }

    /// Of each point that shows ground, how far the drawn ground is off, metres and pixels.
    pub fn distances(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let drawn = self.pixels.iter().flatten();
        drawn.map(|drawn| (drawn.error_m.abs(), drawn.error_px.abs()))
    }

    /// How wrong it is. `exact` is the true picture of the same view and size; without it nothing is looked for elsewhere.
    pub fn errors(
        &self,
        figure: &Ellipsoid,
        ground: &dyn Elevation,
        exact: Option<&TrueRelief>,
    ) -> GroundErrors {
        let drawn = self.pixels.iter().flatten();
        let sorted = |of: fn(&DrawnPixel) -> f64| {
            SortedSample::new(drawn.clone().map(|drawn| of(drawn).abs()).collect())
        };
        let (metres, pixels) = (sorted(|d| d.error_m), sorted(|d| d.error_px));
        GroundErrors {
            pixels: metres.len(),
            median_m: metres.median(),
            p99_m: metres.quantile(0.99),
            max_m: metres.max(),
            median_px: pixels.median(),
            p99_px: pixels.quantile(0.99),
            max_px: pixels.max(),
            holes: self.holes(figure, ground),
            elsewhere: exact.map_or(0, |exact| self.elsewhere(exact)),
            looked_at: exact.map_or(0, |_| self.inner_points()),
        }
    }

    /// Pixels whose content is not visible within a pixel of that position in the exact image: a place that should appear more than a pixel away or
    /// is hidden by other ground; space where there is only ground, or ground where there is only space. It counts a missing or a spurious peak and
    /// what either hides, but not an outline that is off by less than a pixel. The border is excluded. For adjacent pixels, with `exact` at the
    /// same points.
    pub fn elsewhere(&self, exact: &TrueRelief) -> usize {
        let (width, height) = self.points.points;
        let mut count = 0;
        for y in 1..height.saturating_sub(1) {
            for x in 1..width.saturating_sub(1) {
                let around = (0..9).map(|k| exact.distance_m(x + k % 3 - 1, y + k / 3 - 1));
                let farthest_m = around.clone().flatten().fold(0.0_f64, f64::max);
                let (mut has_space, mut has_ground) = (false, false);
                for distance in around {
                    has_space |= distance.is_none();
                    has_ground |= distance.is_some();
                }
                let is_seen = match self.at(x, y) {
                    None => has_space,
                    Some(drawn) => {
                        let away_m = drawn.truth_itrf_m.distance(self.eye_itrf_m);
                        let is_hidden = away_m > farthest_m * (1.0 + SAME_DISTANCE) && !has_space;
                        has_ground && !is_hidden && drawn.error_px.abs() <= 1.0
                    }
                };
                count += usize::from(!is_seen);
            }
        }
        count
    }

    /// How many points [`Self::elsewhere`] looks at.
    pub fn inner_points(&self) -> usize {
        let (width, height) = self.points.points;
        width.saturating_sub(2) as usize * height.saturating_sub(2) as usize
    }

    /// Pixels of space whose ray goes through the lowest ground there is, or which have ground above them where the view's
    /// upper edge is the sky's.
    pub fn holes(&self, figure: &Ellipsoid, ground: &dyn Elevation) -> usize {
        let Some(rays) = Rays::new(&self.view, self.points.picture) else {
            return 0;
        };
        let low_m = ground.range_m(&Bounds::GLOBE).low_m;
        let lowered = Ellipsoid {
            equatorial_radius_m: figure.equatorial_radius_m + low_m,
            polar_radius_m: figure.polar_radius_m + low_m,
        };
        let scale = lowered.scaled_from_itrf();
        let eye = self.eye_itrf_m * scale;
        // And so by a pixel all round: an outline that is too low by less is an error in pixels and no hole.
        let goes_through = |x: u32, y: u32| {
            [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
                .into_iter()
                .all(|(right, down)| {
                    let at = self.points.at(x, y);
                    let ray = rays.at(at.x + right, at.y + down) * scale;
                    let toward = -eye.dot(ray);
                    toward > 0.0 && eye.cross(ray).length_squared() < ray.length_squared()
                })
        };
        // Up on screen is away from the Earth's centre.
        let is_upright = (self.clip_from_eye * self.eye_itrf_m.extend(0.0)).y > 0.0;
        let mut holes = 0;
        for x in 0..self.points.points.0 {
            let mut below_ground = false;
            for y in 0..self.points.points.1 {
                match self.at(x, y) {
                    Some(_) => below_ground = is_upright,
                    None if below_ground || goes_through(x, y) => {
                        tracing::debug!("hole at {x}, {y}, below ground: {below_ground}");
                        holes += 1;
                    }
                    None => {}
                }
            }
        }
        holes
    }

    /// How much the error of each place changed from an earlier picture to this one, pixels: what an eye sees jump that moves
    /// with the ground. Of places that are seen in both.
    pub fn jumps_px(&self, before: &Self) -> impl Iterator<Item = f64> {
        before.pixels.iter().flatten().filter_map(|drawn| {
            let direction = drawn.truth_itrf_m - self.eye_itrf_m;
            let shown = pixel_at(&self.clip_from_eye, self.points.picture, direction)?;
            let (x, y) = self.points.index_of(shown)?;
            let now = self.at(x, y)?;
            // Hidden now by ground in front of it.
            let apart_m = now.truth_itrf_m.distance(drawn.truth_itrf_m);
            let is_same = apart_m <= 2e-2 * direction.length();
            is_same.then(|| (now.error_px - drawn.error_px).abs())
        })
    }

    /// The maximum of [`Self::jumps_px`], 0 if there is none.
    pub fn popping_px(&self, before: &Self) -> f64 {
        self.jumps_px(before).fold(0.0, f64::max)
    }
}
