//! A picture looked at in some of its points alone, for measuring: as it would be drawn whole, at a part of the cost.

use super::view::{EyeView, PixelRays};
use glam::DVec2;

/// Points of a picture that lie in rows and columns, as far apart both ways.
///
/// Drawn into a target of [`Self::points`] pixels with [`Self::viewport`], each pixel of it shows what the picture shows in
/// that point, on the mesh that the whole picture has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelLattice {
    /// Width and height of the picture, pixels.
    pub picture: (u32, u32),
    /// Points across and down.
    pub points: (u32, u32),
    /// Where the first is, pixels right and down of the picture's upper left corner.
    pub first: DVec2,
    /// From each to the next, pixels.
    pub step: f64,
}

impl PixelLattice {
    /// The middle of every pixel.
    pub fn whole(picture: (u32, u32)) -> Self {
        Self::window(picture, (0, 0), picture)
    }

    /// The middles of so many pixels beside each other, the first right and down of the corner by `corner`.
    pub fn window(picture: (u32, u32), corner: (u32, u32), points: (u32, u32)) -> Self {
        Self {
            picture,
            points,
            first: DVec2::new(f64::from(corner.0), f64::from(corner.1)) + 0.5,
            step: 1.0,
        }
    }

    /// The middles of one pixel in `step` × `step`: in each of these squares the one at `within`, less than `step` both ways.
    pub fn spread(picture: (u32, u32), step: u32, within: (u32, u32)) -> Self {
        let step = step.max(1);
        let count = |side: u32, within: u32| side.saturating_sub(within).div_ceil(step).max(1);
        Self {
            points: (count(picture.0, within.0), count(picture.1, within.1)),
            step: f64::from(step),
            ..Self::window(picture, within, (1, 1))
        }
    }

    /// A point, pixels right and down of the picture's upper left corner.
    pub fn at(&self, x: u32, y: u32) -> DVec2 {
        self.first + DVec2::new(f64::from(x), f64::from(y)) * self.step
    }

    /// The point whose pixel a place of the picture lies in; `None` where there is none, or it is none of the points'.
    pub fn index_of(&self, place: DVec2) -> Option<(u32, u32)> {
        let from_first = (place - self.first) / self.step;
        let nearest = from_first.round();
        let is_near = ((from_first - nearest) * self.step).abs().max_element() <= 0.5;
        let limit = DVec2::new(f64::from(self.points.0), f64::from(self.points.1));
        let is_inside = nearest.min_element() >= 0.0 && nearest.cmplt(limit).all();
        (is_near && is_inside).then_some((nearest.x as u32, nearest.y as u32))
    }

    /// The viewport that a pass over the points sets: left, top, width and height in pixels of the target. It may reach beyond
    /// the target.
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
