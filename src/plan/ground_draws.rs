//! The draws of terrain.

use super::draws::{DrawLight, PER_BLOCK_TILES, SurfaceDraw, WHOLE_MAP};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;
use terrella_frames::Ellipsoid;
use terrella_ground::globe::{
    Block, BlockSet, DrawKind, IndexRange, Patch, Surface, TriangleList, merged_ranges,
    patch_ranges,
};

/// Indices of the faces of a page's prism, for ray-cast contours.
pub(crate) const PRISM_INDICES: u32 = 36;

/// Number of frames for which the ranges of a patch out of sight are kept.
const KEPT_FRAMES: u64 = 120;

/// Lists the draws of one surface, and caches the index ranges of triangles that span several blocks.
#[derive(Default)]
pub(crate) struct GroundDraws {
    /// Ranges by key of the patch.
    patches: HashMap<u64, PatchRanges>,
    grid: Vec<IndexRange>,
    /// Revision of the grid that its ranges were computed for.
    grid_revision: Option<u64>,
    frame: u64,
}

struct PatchRanges {
    ranges: Vec<IndexRange>,
    /// Revision and triangles that the ranges were computed for.
    revision: u64,
    triangles: Arc<TriangleList>,
    used: u64,
}

impl GroundDraws {
    /// Lists the draws of the last view of a surface. `tiled` has the blocks with tiles, if triangles span several blocks.
    pub fn list(
        &mut self,
        surface: &dyn Surface,
        ellipsoid: &Ellipsoid,
        tiled: Option<BlockSet>,
        draws: &mut Vec<SurfaceDraw>,
    ) {
        match surface.draw_kind() {
            DrawKind::Patches => {
                self.frame += 1;
                surface.for_each_patch(&mut |patch| {
                    if !patch.is_empty() {
                        self.draw_patch(patch, ellipsoid, tiled, draws);
                    }
                });
                let oldest = self.frame.saturating_sub(KEPT_FRAMES);
                self.patches.retain(|_, ranges| ranges.used >= oldest);
            }
            DrawKind::Grid(grid) if grid.uniforms.is_some() => match tiled {
                None => draws.push(SurfaceDraw {
                    patch: 0,
                    indices: 0..grid.indices.triangles.len() as u32,
                    is_listed: false,
                    light: DrawLight::Everything,
                    drawn_as: 0,
                    block: None,
                }),
                Some(tiled) => {
                    if self.grid_revision != Some(grid.revision) {
                        self.grid_revision = Some(grid.revision);
                        surface.grid_ranges(&mut self.grid);
                    }
                    draw_ranges(0, &self.grid, tiled, draws);
                }
            },
            DrawKind::Grid(_) => {}
            DrawKind::ContourPages(_) => surface.for_each_contour_page(&mut |page| {
                draws.push(SurfaceDraw {
                    patch: 0,
                    indices: 0..PRISM_INDICES,
                    is_listed: false,
                    light: DrawLight::Everything,
                    drawn_as: page.block.index(),
                    block: Some(page.block),
                });
            }),
        }
    }

    /// Draws a patch once, or once for each of its blocks that has tiles and once for all others.
    fn draw_patch(
        &mut self,
        patch: &Patch,
        ellipsoid: &Ellipsoid,
        tiled: Option<BlockSet>,
        draws: &mut Vec<SurfaceDraw>,
    ) {
        let Some(tiled) = tiled.filter(|_| patch.block.is_none()) else {
            draws.push(SurfaceDraw {
                patch: patch.key,
                indices: 0..patch.indices.triangles.len() as u32,
                is_listed: false,
                light: DrawLight::Everything,
                drawn_as: patch.block.map_or(WHOLE_MAP, Block::index),
                block: patch.block,
            });
            return;
        };
        let mut is_stale = false;
        let held = self.patches.entry(patch.key).or_insert_with(|| {
            is_stale = true;
            PatchRanges {
                ranges: Vec::new(),
                revision: patch.revision,
                triangles: patch.indices.clone(),
                used: 0,
            }
        });
        held.used = self.frame;
        is_stale |= held.revision != patch.revision;
        if is_stale || !Arc::ptr_eq(&held.triangles, &patch.indices) {
            held.revision = patch.revision;
            held.triangles = patch.indices.clone();
            patch_ranges(patch, ellipsoid, &mut held.ranges);
        }
        draw_ranges(patch.key, &held.ranges, tiled, draws);
    }
}

/// Draws triangles that span several blocks, some of which have tiles.
fn draw_ranges(patch: u64, ranges: &[IndexRange], tiled: BlockSet, draws: &mut Vec<SurfaceDraw>) {
    let mut draw = |drawn_as: u32, block: Option<Block>, indices: Range<u32>| {
        draws.push(SurfaceDraw {
            patch,
            indices,
            is_listed: false,
            light: DrawLight::Everything,
            drawn_as,
            block,
        });
    };
    let all = ranges.iter().fold(0, |all, near| all | near.blocks.0);
    let mut left = all & tiled.0;
    while left != 0 {
        let index = left.trailing_zeros();
        let block = Block::of_index(index);
        merged_ranges(ranges, BlockSet(1 << index), |range| {
            draw(PER_BLOCK_TILES + index, Some(block), range);
        });
        left &= left - 1;
    }
    merged_ranges(ranges, BlockSet(!tiled.0), |range| {
        draw(WHOLE_MAP, None, range);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_in_several_blocks_are_drawn_for_each_that_has_tiles_and_once_for_the_others() {
        let (west, east, beyond) = (1 << 3, 1 << 4, 1 << 5);
        let range = |indices, blocks| IndexRange {
            indices,
            blocks: BlockSet(blocks),
        };
        let ranges = [
            range(0..30, west),
            range(30..60, west | east),
            range(60..90, east),
            range(90..120, beyond),
        ];
        let listed = |tiled: u128| {
            let mut draws = Vec::new();
            draw_ranges(7, &ranges, BlockSet(tiled), &mut draws);
            assert!(draws.iter().all(|draw| draw.patch == 7));
            let of = draws.into_iter();
            of.map(|draw| (draw.drawn_as, draw.block.map(Block::index), draw.indices))
                .collect::<Vec<_>>()
        };
        assert_eq!(listed(0), [(WHOLE_MAP, None, 0..120)]);
        assert_eq!(
            listed(east | 1),
            [
                (PER_BLOCK_TILES + 4, Some(4), 30..90),
                (WHOLE_MAP, None, 0..60),
                (WHOLE_MAP, None, 90..120),
            ]
        );
        assert_eq!(
            listed(u128::MAX),
            [
                (PER_BLOCK_TILES + 3, Some(3), 0..60),
                (PER_BLOCK_TILES + 4, Some(4), 30..90),
                (PER_BLOCK_TILES + 5, Some(5), 90..120),
            ]
        );
    }
}
