//! What the forest does where heights have changed.
//!
//! All vertices there are computed anew by the next view, in all patches at once: so edges stay closed. What is known of squares is
//! widened at once, so that nothing is culled that could be seen, and read anew over the next views: until then squares are divided
//! by what was known of them.

use super::forest::Forest;
use super::patch::step_m;
use super::surface::{PAGE_WORK, Quadtree};
use crate::elevation::{Elevation, HeightChange};

/// Part of a frame's work that goes into squares whose heights have changed.
const PART: u32 = 4;

impl Quadtree {
    /// Reads squares anew whose heights have changed, within a part of the frame's work.
    pub(super) fn read_stale(&mut self, forest: &mut Forest, ground: &dyn Elevation) {
        if !forest.is_stale() {
            return;
        }
        let most = (self.options.work / PART / PAGE_WORK).max(1);
        forest.read_stale(most, ground);
        self.work_done = self.work_done.saturating_add(most * PAGE_WORK);
        // What was found may ask for more, or less.
        self.changes += 1;
    }

    /// Has the patches built anew whose vertices may have changed.
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
            built.is_dirty = true;
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
                self.steps_changed(node, old_m.max(needed_m));
            }
        }
    }
}
