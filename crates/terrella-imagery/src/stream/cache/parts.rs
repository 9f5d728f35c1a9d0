//! Parts of blocks: their slots, and their selection for drawing.
//!
//! Parts share a pool with the tiles of their blocks, which stand in for all of them. Parts therefore get slots only if their block's own tile has
//! one, and parts without an allocation are released for those that have one.

use super::{TileCache, TileStage};
use crate::residency::{PartCell, PartTable, PartTables, ResidentTile};
use crate::stream::TileRequest;
use crate::tile::{MapLayer, TileKey};
use terrella_files::clock::Instant;
use terrella_ground::globe::Part;

impl TileCache {
    /// Promises a slot to a part, or to a coarser one that holds it.
    pub(super) fn allocate_part(&mut self, now: Instant, request: &TileRequest) {
        let (frame, key) = (self.frame, request.key);
        if self.level(key).is_none() {
            return;
        }
        let cut = self.maps[key.layer.index()].cut as u8;
        let own = TileKey::whole(key.layer, cut, key.block);
        let (is_own_promised, own_fails) = {
            let own = self.tile(own);
            (own.is_promised(frame), own.retry_at.is_some())
        };
        let state = self.tile_mut(key);
        if state.asked == frame {
            return;
        }
        (state.asked, state.target) = (frame, cut);
        self.counters.requested[usize::from(key.level)] += 1;
        if !is_own_promised || own_fails {
            return;
        }
        let (mut target, mut goal, mut retry) = (None, None, None);
        for level in key.level..cut {
            let key = self.ancestor(key, level);
            if !self.can_promise(key) {
                continue;
            }
            target.get_or_insert(key);
            match self.tile(key).retry_at {
                None => {
                    goal = Some(key);
                    break;
                }
                Some(due) if due <= now && retry.is_none() => retry = Some(key),
                Some(_) => {}
            }
        }
        for key in [goal, retry].into_iter().flatten() {
            if self.can_promise(key) {
                self.promise(key, request.drawn);
            }
        }
        let Some(target) = target else { return };
        self.tile_mut(key).target = target.level;
        if request.drawn {
            self.targets.push(target);
            self.stand_ins.extend(goal.filter(|goal| *goal != target));
        }
    }

    /// The part of a coarser level that holds a part.
    fn ancestor(&self, key: TileKey, level: u8) -> TileKey {
        let levels = &self.maps[key.layer.index()].levels;
        let parts = |level: u8| levels[usize::from(level)].shape.parts as u16;
        let (fine, coarse) = (parts(key.level), parts(level));
        let steps = fine / coarse;
        let (row, column) = (key.part / fine / steps, key.part % fine / steps);
        TileKey {
            level,
            part: row * coarse + column,
            ..key
        }
    }

    /// Adds a table with the tiles of the parts of a block: see [`super::super::TileStream::draw_parts`].
    pub fn draw_parts(
        &mut self,
        layer: MapLayer,
        block: u8,
        own: ResidentTile,
        wanted: &[(Part, u8)],
        tables: &mut PartTables,
    ) {
        let map = &self.maps[layer.index()];
        let cut = map.cut;
        if cut == 0 || usize::from(own.level) != cut {
            return;
        }
        let depth = map.levels[0].shape.parts.trailing_zeros() as u8;
        let side = 1_usize << depth;
        let first = tables.cells.len();
        let own = PartCell {
            index: own.slot.index,
            depth: 0,
        };
        let cells = if wanted.is_empty() { 1 } else { side * side };
        tables.cells.resize(first + cells, own);
        for (part, level) in wanted {
            let level = usize::from(*level).min(cut - 1);
            let level = self.count_part(TileKey {
                layer,
                level: level as u8,
                block,
                part: part.index_at(self.depth_of(layer, level)),
            });
            if level >= cut {
                continue;
            }
            let span = side >> part.depth.min(depth);
            let (north, west) = (
                usize::from(part.row) * span,
                usize::from(part.column) * span,
            );
            for row in north..(north + span).min(side) {
                for column in west..(west + span).min(side) {
                    let cell = Part {
                        depth,
                        row: row as u16,
                        column: column as u16,
                        ..*part
                    };
                    if let Some(drawn) = self.drawn_part(layer, cell, level) {
                        tables.cells[first + row * side + column] = drawn;
                    }
                }
            }
        }
        let depth = match cells {
            1 => 0,
            _ => merge(&mut tables.cells, first, depth),
        };
        tables.tables.push(PartTable {
            layer,
            block,
            own: own.index,
            depth,
            first: first as u32,
        });
    }

    fn depth_of(&self, layer: MapLayer, level: usize) -> u8 {
        let level = &self.maps[layer.index()].levels[level];
        level.shape.parts.trailing_zeros() as u8
    }

    /// The part that a cell is drawn with: at the level that a slot is promised at, or else the nearest finer one, which is there only until
    /// others need its slot, or else the nearest coarser one.
    fn drawn_part(&mut self, layer: MapLayer, cell: Part, promised: usize) -> Option<PartCell> {
        let cut = self.maps[layer.index()].cut;
        let levels = (0..=promised).rev().chain(promised + 1..cut);
        for level in levels {
            let depth = self.depth_of(layer, level);
            let key = TileKey {
                layer,
                level: level as u8,
                block: cell.block.index() as u8,
                part: cell.index_at(depth),
            };
            if let Some(slot) = self.drawable(key, true) {
                let index = slot.index;
                return Some(PartCell { index, depth });
            }
        }
        None
    }

    /// Counts a requested part as resident at its allocated level, or as missing. Returns that level.
    fn count_part(&mut self, key: TileKey) -> usize {
        let state = self.tile(key);
        if state.asked != self.frame {
            return usize::from(key.level);
        }
        let cut = self.maps[key.layer.index()].cut as u8;
        let target = state.target.max(key.level);
        let is_hit = target >= cut
            || matches!(
                self.tile(self.ancestor(key, target)).stage,
                TileStage::Resident(_)
            );
        if is_hit {
            self.counters.hits += 1;
        } else {
            self.counters.fallbacks += 1;
        }
        usize::from(target)
    }
}

/// Merges the last cells of a list, 2^depth × 2^depth from `first` on, as often as all fours are alike. Answers how often they are
/// halved then.
fn merge(cells: &mut Vec<PartCell>, first: usize, mut depth: u8) -> u8 {
    while depth > 0 {
        let side = 1_usize << depth;
        let half = side / 2;
        let four = |place: usize| {
            let north_west = first + place / half * 2 * side + place % half * 2;
            [0, 1, side, side + 1].map(|step| north_west + step)
        };
        let are_alike = |place: usize| {
            let four = four(place).map(|n| cells[n]);
            four.iter().all(|cell| *cell == four[0])
        };
        if !(0..half * half).all(are_alike) {
            break;
        }
        for place in 0..half * half {
            cells[first + place] = cells[four(place)[0]];
        }
        cells.truncate(first + half * half);
        depth -= 1;
    }
    depth
}
