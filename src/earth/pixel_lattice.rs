//! A lattice of image points, for measuring an image at a part of its cost.

use super::view::{EyeView, PixelRays};
use glam::DVec2;

/// Points of an image in rows and columns with equal spacing in both directions.
///
/// Drawn into a target of [`Self::points`] pixels with [`Self::viewport`], each pixel shows what the image shows at the corresponding point, on the
/// mesh of the whole image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelLattice {
    /// Width and height of the image, pixels.
    pub picture: (u32, u32),
    /// Number of points across and down.
    pub points: (u32, u32),
    /// The first point, pixels right and down of the image's upper left corner.
    pub first: DVec2,
    /// Spacing of the points, pixels.
    pub step: f64,
}

impl PixelLattice {
    /// The centre of every pixel.
    pub fn whole(picture: (u32, u32)) -> Self {
        Self::window(picture, (0, 0), picture)
    }

    /// The centres of a block of adjacent pixels. `corner` is its first pixel.
    pub fn window(picture: (u32, u32), corner: (u32, u32), points: (u32, u32)) -> Self {
        Self {
            picture,
            points,
            first: DVec2::new(f64::from(corner.0), f64::from(corner.1)) + 0.5,
            step: 1.0,
        }
    }

    /// The centre of one pixel in each square of `step` × `step`: the one at `within`, which is less than `step` in both directions.
    pub fn spread(picture: (u32, u32), step: u32, within: (u32, u32)) -> Self {
        let step = step.max(1);
        let count = |side: u32, within: u32| side.saturating_sub(within).div_ceil(step).max(1);
        Self {
            points: (count(picture.0, within.0), count(picture.1, within.1)),
            step: f64::from(step),
            ..Self::window(picture, within, (1, 1))
        }
    }

    /// A point, pixels right and down of the image's upper left corner.
    pub fn at(&self, x: u32, y: u32) -> DVec2 {
        self.first + DVec2::new(f64::from(x), f64::from(y)) * self.step
    }

    /// Index of the point whose pixel contains a place of the image; `None` if no point's does.
    pub fn index_of(&self, place: DVec2) -> Option<(u32, u32)> {
        let from_first = (place - self.first) / self.step;
        let nearest = from_first.round();
        let is_near = ((from_first - nearest) * self.step).abs().max_element() <= 0.5;
        let limit = DVec2::new(f64::from(self.points.0), f64::from(self.points.1));
        let is_inside = nearest.min_element() >= 0.0 && nearest.cmplt(limit).all();
        (is_near && is_inside).then_some((nearest.x as u32, nearest.y as u32))
    }

    /// The viewport that a pass over the points sets: left, top, width and height in pixels of the target. It may extend beyond the target.
    pub fn viewport(&self) -> [f32; 4] {
        let corner = 0.5 - self.first / self.step;
        let side = |pixels: u32| (f64::from(pixels) / self.step) as f32;
        let (width, height) = (side(self.picture.0), side(self.picture.1));
        [corner.x as f32, corner.y as f32, width, height]
    }

    /// The rays of the target's pixels.
    pub(super) fn rays(&self, view: &EyeView) -> PixelRays {
        let rays = view.pixel_rays(self.picture.into());
        let corner = self.first - 0.5 * self.step;
        PixelRays {
            corner: rays.corner + rays.right * corner.x + rays.down * corner.y,
            right: rays.right * self.step,
            down: rays.down * self.step,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_spread_of_all_shifts_has_every_pixel_once() {
        let size = (37, 21);
        let mut seen = vec![0; 37 * 21];
        for (dx, dy) in (0..8).flat_map(|dx| (0..8).map(move |dy| (dx, dy))) {
            let lattice = PixelLattice::spread(size, 8, (dx, dy));
            for (x, y) in
                (0..lattice.points.0).flat_map(|x| (0..lattice.points.1).map(move |y| (x, y)))
            {
                let at = lattice.at(x, y);
                assert_eq!(lattice.index_of(at), Some((x, y)));
                assert_eq!(lattice.index_of(at + DVec2::new(1.0, 0.0)), None);
                seen[at.y as usize * 37 + at.x as usize] += 1;
            }
        }
        assert!(seen.iter().all(|count| *count == 1));
    }

    #[test]
    fn points_have_the_rays_of_their_pixels() {
        let view = EyeView::itrf(DVec3::new(7e6, 1e5, -2e5), -DVec3::X, DVec3::Z, 0.7, 1.6);
        let size = (320, 200);
        let whole = view.pixel_rays(size.into());
        for lattice in [
            PixelLattice::spread(size, 16, (3, 11)),
            PixelLattice::window(size, (100, 40), (20, 10)),
        ] {
            let rays = lattice.rays(&view);
            let ray = rays.corner + rays.right * 7.5 + rays.down * 4.5;
            let at = lattice.at(7, 4);
            let expected = whole.corner + whole.right * at.x + whole.down * at.y;
            assert!(ray.distance(expected) < 1e-12, "{ray} {expected}");
            // The viewport puts the same point of clip space there.
            let [left, _, width, _] = lattice.viewport().map(f64::from);
            let across = left + width * at.x / f64::from(size.0);
            assert!((across - 7.5).abs() < 1e-5, "{across}");
        }
    }
}
