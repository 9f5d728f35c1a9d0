//! How texels of the target are computed from those of a raster, along one axis.
//!
//! If the raster is at least as fine as the target, a texel is the mean over its footprint. If it is coarser, it is interpolated by cubic
//! convolution (Catmull–Rom), clamped between its two neighbours, like the levels of a pack.

/// Edges closer than this to a texel's edge are snapped to it, texels: bounds are written with a few digits.
const SNAP: f64 = 1e-3;

/// Sources of a texel of the target.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Tap {
    /// Weighted mean from this texel on, with weights that add up to 1: parts of the footprint inside the raster.
    Mean(u32, Vec<f32>),
    /// Four texels, and the part of the way from the second to the third.
    Cubic([u32; 4], f32),
    /// It is outside the raster.
    Outside,
}

/// How a raster of `size` texels is read at places given in its texels from its first edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// Texels.
    pub size: u32,
    /// It goes round the Earth: after its last texel comes the first.
    pub is_round: bool,
}

impl Axis {
    /// The source of the interval between two positions. At an edge a footprint belongs to the raster if its middle does: of adjacent rasters each
    /// footprint has exactly one, and neither is blended with the layer beneath.
    pub(super) fn tap(self, from: f64, to: f64) -> Tap {
        let (from, to) = (snapped(from), snapped(to));
        let size = f64::from(self.size);
        if !(from.is_finite() && to.is_finite() && from < to)
            || (!self.is_round && (to <= 0.0 || from >= size))
        {
            return Tap::Outside;
        }
        if to - from < 1.0 - SNAP {
            return self.cubic(0.5 * (from + to) - 0.5);
        }
        let centre = snapped(0.5 * (from + to));
        if !self.is_round && !(0.0..size).contains(&centre) {
            return Tap::Outside;
        }
        let (first, last) = if self.is_round {
            (from.floor(), to.ceil())
        } else {
            (from.floor().max(0.0), to.ceil().min(size))
        };
        // A footprint of more than the whole axis is the whole axis.
        let count = (last - first).clamp(1.0, size) as u32;
        let inside = |n: u32| {
            let texel = first + f64::from(n);
            (to.min(texel + 1.0) - from.max(texel)).max(0.0)
        };
        let all: f64 = (0..count).map(inside).sum();
        let parts = (0..count).map(|n| (inside(n) / all) as f32);
        // In range after the remainder.
        Tap::Mean(first.rem_euclid(size) as u32, parts.collect())
    }

    /// Between the centres about a place, in texels from the first one's centre.
    fn cubic(self, place: f64) -> Tap {
        let left = place.floor();
        let texels = [-1.0, 0.0, 1.0, 2.0].map(|offset| {
            let texel = left + offset;
            let size = f64::from(self.size);
            if self.is_round {
                texel.rem_euclid(size) as u32
            } else {
                texel.clamp(0.0, size - 1.0) as u32
            }
        });
        Tap::Cubic(texels, (place - left) as f32)
    }
}

fn snapped(place: f64) -> f64 {
    let whole = place.round();
    if (place - whole).abs() < SNAP {
        whole
    } else {
        place
    }
}

impl Tap {
    /// The only texel that it is, if it is one.
    pub(super) fn single(&self) -> Option<u32> {
        match self {
            Self::Mean(texel, parts) if parts.len() == 1 && parts[0] == 1.0 => Some(*texel),
            _ => None,
        }
    }

    /// First and last texel that are read; those of a mean that wraps around do not count.
    pub(super) fn span(&self) -> Option<(u32, u32)> {
        match self {
            // Never empty.
            Self::Mean(first, parts) => Some((*first, first + parts.len() as u32 - 1)),
            Self::Cubic(texels, _) => Some((texels[0], texels[3])),
            Self::Outside => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGE: Axis = Axis {
        size: 8,
        is_round: false,
    };
    const ROUND: Axis = Axis {
        size: 8,
        is_round: true,
    };

    #[test]
    fn the_same_grid_is_read_texel_by_texel() {
        for texel in 0..8_u32 {
            let at = f64::from(texel);
            assert_eq!(EDGE.tap(at + 2e-4, at + 1.0 - 2e-4).single(), Some(texel));
        }
    }

    #[test]
    fn footprints_are_shared_out() {
        assert_eq!(EDGE.tap(1.5, 3.0), Tap::Mean(1, vec![1.0 / 3.0, 2.0 / 3.0]));
        // It is where its middle is, of two rasters that touch in the second.
        assert_eq!(EDGE.tap(-1.0, 1.0), Tap::Mean(0, vec![1.0]));
        assert_eq!(EDGE.tap(7.0, 9.0), Tap::Outside);
        assert_eq!(EDGE.tap(6.5, 9.0), Tap::Mean(6, vec![1.0 / 3.0, 2.0 / 3.0]));
        assert_eq!(EDGE.tap(8.0, 9.0), Tap::Outside);
        assert_eq!(EDGE.tap(-2.0, 0.0), Tap::Outside);
        assert_eq!(ROUND.tap(-1.0, 1.0), Tap::Mean(7, vec![0.5, 0.5]));
        assert_eq!(EDGE.tap(f64::NAN, 1.0), Tap::Outside);
        assert_eq!(EDGE.tap(0.0, f64::INFINITY), Tap::Outside);
    }

    #[test]
    fn between_centres_it_is_cubic() {
        assert_eq!(EDGE.tap(0.0, 0.5), Tap::Cubic([0, 0, 0, 1], 0.75));
        assert_eq!(ROUND.tap(0.0, 0.5), Tap::Cubic([6, 7, 0, 1], 0.75));
        assert_eq!(EDGE.tap(7.5, 8.0), Tap::Cubic([6, 7, 7, 7], 0.25));
    }
}
