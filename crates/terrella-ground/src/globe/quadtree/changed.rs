//! Updates of the forest where heights have changed.
//!
//! The next view computes changed vertices that two patches share again, in all patches at once, so edges stay closed. Vertices inside
//! patches follow over the next views, near ones first. The properties of squares are widened at once, so that nothing visible is culled.
//! They are read again over the next views; until then squares are divided by the old properties.

use super::forest::Forest;
use super::lod::LodView;
use super::patch::step_m;
use super::surface::{PAGE_WORK, Quadtree};
use crate::elevation::{Elevation, HeightChange};

/// Divisor of a frame's work that gives the part for squares whose heights have changed.
const PART: u32 = 4;

/// Number of changed vertices inside patches that a view computes again: about a millisecond.
const RENEWED: u32 = 1200;

impl Quadtree {
    /// Reads squares again whose heights have changed, within a part of the frame's work.
    pub(super) fn read_stale(&mut self, forest: &mut Forest, ground: &dyn Elevation) {
        if !forest.is_stale() {
            return;
        }
        let most = (self.options.work / PART / PAGE_WORK).max(1);
        forest.read_stale(most, ground);
        self.work_done = self
            .work_done
            .saturating_add(most.saturating_mul(PAGE_WORK));
        // The new heights may need more leaves, or fewer.
        self.changes += 1;
    }

    /// Computes changed vertices again, in the patches that are not rebuilt as a whole.
    pub(super) fn renew(&mut self, forest: &Forest, lod: &LodView, ground: &dyn Elevation) {
        let mut order = std::mem::take(&mut self.order);
        order.clear();
        order.extend(0..self.patches.len() as u32);
        order.retain(|index| self.patches[*index as usize].is_stale());
        order.sort_unstable_by(|a, b| {
            let [a, b] = [a, b].map(|index| &self.patches[*index as usize]);
            let by_sight = b.is_drawn.cmp(&a.is_drawn);
            let by_distance = || a.distance_m.total_cmp(&b.distance_m);
            by_sight.then_with(by_distance).then(a.node.cmp(&b.node))
        });
        let mut left = RENEWED;
        for index in &order {
            let built = &mut self.patches[*index as usize];
            left = left.saturating_sub(built.renew(left, forest, ground, &mut self.scratch));
            if let Some(slot) = forest.slot(built.node) {
                built.is_drawn = lod.draws(forest.info(slot), &built.normals);
            }
            // The next view continues with it.
            self.changes += u32::from(built.is_stale());
        }
        self.order = order;
    }

    /// Marks the vertices that may have changed, to be computed again.
    pub(super) fn mark_changed(
        &mut self,
        forest: &Forest,
        changes: &[HeightChange],
        ground: &dyn Elevation,
    ) {
        for index in 0..self.patches.len() {
            let built = &mut self.patches[index];
            if !built.heights_changed(changes, ground) {
                continue;
            }
            let node = built.node;
            let Some(slot) = forest.slot(node) else {
                continue;
            };
            // Higher ground may not fit into its steps any more.
            let needed_m = step_m(forest.info(slot).radius_m);
            if needed_m > built.step_m {
                let old_m = built.step_m;
                self.revision += 2;
                self.revision = self.revision.max(built.patch.revision + 2);
                let is_drawn = built.is_drawn;
                built.reset(node, slot, forest, self.revision);
                built.is_drawn = is_drawn;
                self.steps_changed(forest, node, old_m.max(needed_m));
            }
        }
    }
}
