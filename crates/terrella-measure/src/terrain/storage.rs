//! Size of an elevation grid in several storage formats.

use terrella_ground::globe::contours::dem::{Dem, Span, quarters};
use terrella_ground::globe::contours::tree::TreeStats;

/// Bytes of one DEM in several forms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Storage {
    /// Two bytes a sample.
    pub raw: u64,
    /// Equal (within the tolerance) quarters merged in Morton order: two bytes a leaf, one bit a node.
    pub morton: u64,
    /// Contours: three f32 a leaf (two slopes, one height), one bit a node.
    pub contours: u64,
    /// Patches: see [`PatchTree::packed_bytes`](super::patches::PatchTree::packed_bytes).
    pub patches: u64,
}

impl Storage {
    /// Counts what a grid takes with contours and patches of the same tolerance.
    pub fn count(dem: &Dem, tolerance_m: f64, contours: &TreeStats, patch_bytes: u64) -> Self {
        let leaves = morton_leaves(dem, tolerance_m);
        Self {
            raw: 2 * dem.heights_m().len() as u64,
            morton: 2 * leaves + (4 * leaves).div_ceil(3).div_ceil(8),
            contours: 12 * contours.leaves + contours.nodes.div_ceil(8),
            patches: patch_bytes,
        }
    }
}

/// Number of leaves of the quadtree whose four equal children are merged, level by level; equal means that all are within the tolerance of one
/// elevation. Grids that are not a power of two are divided as by [`quarters`], over samples.
pub fn morton_leaves(dem: &Dem, tolerance_m: f64) -> u64 {
    // Samples take the place of cells: a span's last row and column belong to the next.
    fn leaves(dem: &Dem, [w, e, s, n]: Span, tolerance_m: f64) -> (u64, f64, f64) {
        let Some((spans, count)) = quarters([w, e, s, n]) else {
            let z = dem.height_m(w.into(), s.into());
            return (1, z, z);
        };
        let mut sum = (0, f64::INFINITY, f64::NEG_INFINITY);
        for span in &spans[..count] {
            let part = leaves(dem, *span, tolerance_m);
            sum = (sum.0 + part.0, sum.1.min(part.1), sum.2.max(part.2));
        }
        if sum.0 == count as u64 && sum.2 - sum.1 <= 2.0 * tolerance_m {
            sum.0 = 1;
        }
        sum
    }
    leaves(dem, [0, dem.columns(), 0, dem.rows()], tolerance_m).0
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella_ground::globe::contours::dem::DemFrame;

    #[test]
    fn equal_samples_merge() {
        let step_m = glam::DVec2::ONE;
        let dem = |n: u32, f: fn(u32) -> f32| {
            Dem::new(n, n, (0..n * n).map(f).collect(), DemFrame::Flat { step_m }).unwrap()
        };
        assert_eq!(morton_leaves(&dem(64, |_| 5.0), 0.0), 1);
        assert_eq!(morton_leaves(&dem(65, |_| 5.0), 0.0), 1);
        assert_eq!(morton_leaves(&dem(64, |k| k as f32), 0.0), 64 * 64);
        // One odd sample: three quarters stay at each of six levels, and four samples.
        assert_eq!(
            morton_leaves(&dem(64, |k| if k == 0 { 1.0 } else { 0.0 }), 0.0),
            3 * 6 + 1
        );
    }
}
