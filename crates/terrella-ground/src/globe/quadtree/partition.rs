//! Partition of squares into patches: neither too many nor too large.

use super::forest::{BLOCKS, Forest, Slot};
use super::lod::LodView;
use super::node::{Cut, Node};
use super::patch::{BuiltPatch, MAX_PATCH_LEVEL};
use super::surface::{MOST_SPARE, Quadtree};

/// A patch with more leaves is divided into four.
const MAX_PATCH_LEAVES: u32 = 256;
/// Four patches with fewer leaves become one.
const MIN_PATCH_LEAVES: u32 = 80;
/// A patch is divided if its ball is larger than this many distances. Single precision then represents its vertices to a thousandth of a
/// pixel.
const MAX_BALLS: f64 = 6.0;

impl Quadtree {
    /// Divides patches that are too large, and joins small ones.
    pub(super) fn repartition(&mut self, forest: &mut Forest, lod: &LodView) {
        let mut index = 0;
        while index < self.patches.len() {
            let built = &self.patches[index];
            let (node, leaves, distance_m) = (built.node, built.leaves, built.distance_m);
            index += 1;
            let Some(slot) = forest.slot(node) else {
                continue;
            };
            let ball_m = f64::from(forest.info(slot).radius_m);
            if forest.is_split(slot) && node.level < MAX_PATCH_LEVEL {
                let is_large = leaves > MAX_PATCH_LEAVES || ball_m > MAX_BALLS * distance_m;
                // It may exceed the work of a frame by half, so that it is never postponed forever.
                if is_large && self.work_done / 3 < self.options.work / 2 {
                    self.changes += 1;
                    self.divide(forest, lod, node, slot);
                    // The last patch is now at this index.
                    index -= 1;
                }
                if leaves > MIN_PATCH_LEAVES {
                    continue;
                }
            }
            if node.x & 1 == 0 && node.y & 1 == 0 && self.work_done < self.options.work {
                self.join(forest, lod, node);
            }
        }
    }

    /// Makes a patch of each quarter of a patch.
    fn divide(&mut self, forest: &mut Forest, lod: &LodView, node: Node, slot: Slot) {
        let old_step_m = self.remove(node);
        forest.set_patch(slot, false);
        for k in 0..4 {
            if let Some(slot) = forest.child(node, slot, k) {
                forest.set_patch(slot, true);
                self.add(forest, lod, node.child(k), slot);
            }
        }
        self.steps_changed(forest, node, old_step_m);
    }

    /// Makes one patch of four, if four small ones are adjacent.
    fn join(&mut self, forest: &mut Forest, lod: &LodView, first: Node) {
        let Some(parent) = first.parent() else {
            return;
        };
        let mut leaves = 0;
        for child in parent.children() {
            let Some(index) = self.by_node.get(&child) else {
                return;
            };
            leaves += self.patches[*index as usize].leaves;
        }
        let Some(slot) = forest.slot(parent) else {
            return;
        };
        let info = forest.info(slot);
        let is_near = f64::from(info.radius_m) > 0.5 * MAX_BALLS * lod.distance_m(info);
        if leaves >= MIN_PATCH_LEAVES || is_near {
            return;
        }
        self.changes += 1;
        for (k, child) in parent.children().into_iter().enumerate() {
            self.remove(child);
            if let Some(slot) = forest.child(parent, slot, k as u8) {
                forest.set_patch(slot, false);
            }
        }
        forest.set_patch(slot, true);
        let index = self.add(forest, lod, parent, slot);
        let step_m = self.patches[index].step_m;
        self.steps_changed(forest, parent, step_m);
    }

    /// Marks patches to be built again that are adjacent to a node and whose steps are finer than the current or previous ones.
    pub(super) fn steps_changed(&mut self, forest: &Forest, node: Node, step_m: f64) {
        let mut beside = std::mem::take(&mut self.order);
        beside.clear();
        forest.patches_beside(node, &mut |patch| beside.extend(self.by_node.get(&patch)));
        // Hundreds of patches may end at a pole. Their common point there uses the coarsest step of all of them: if that is another
        // patch's, the point stays.
        let is_pole_kept = beside.iter().any(|index| {
            let built = &self.patches[*index as usize];
            built.node != node && built.step_m >= step_m && BLOCKS.shares_pole(built.node, node)
        });
        for index in &beside {
            let built = &mut self.patches[*index as usize];
            let is_touched = !is_pole_kept || BLOCKS.is_beside(built.node, node);
            if !built.is_dirty && built.step_m < step_m && is_touched {
                built.is_dirty = true;
                self.work_done = self.work_done.saturating_add(built.leaves);
            }
        }
        self.order = beside;
    }

    fn add(&mut self, forest: &Forest, lod: &LodView, node: Node, slot: Slot) -> usize {
        // Above all revisions that any patch of this node had before.
        self.revision += 2;
        let mut built = match self.spare.pop() {
            Some(mut built) => {
                built.reset(node, slot, forest, self.revision);
                built
            }
            None => BuiltPatch::new(node, slot, forest, self.revision),
        };
        let info = forest.info(slot);
        built.distance_m = lod.distance_m(info);
        built.leaves = count_leaves(forest, node, slot);
        self.work_done = self.work_done.saturating_add(8 * built.leaves);
        let index = self.patches.len();
        self.by_node.insert(node, index as u32);
        self.patches.push(built);
        index
    }

    /// Removes a patch. Returns its step.
    fn remove(&mut self, node: Node) -> f64 {
        let Some(index) = self.by_node.remove(&node) else {
            return 0.0;
        };
        let built = self.patches.swap_remove(index as usize);
        if let Some(moved) = self.patches.get(index as usize) {
            self.by_node.insert(moved.node, index);
        }
        let step_m = built.step_m;
        self.revision = self.revision.max(built.patch.revision);
        if self.spare.len() < MOST_SPARE {
            self.spare.push(built);
        }
        step_m
    }
}

fn count_leaves(forest: &Forest, node: Node, slot: Slot) -> u32 {
    if !forest.is_split(slot) {
        return 1;
    }
    let children = (0..4).filter_map(|k| Some((node.child(k), forest.child(node, slot, k)?)));
    children
        .map(|(child, slot)| count_leaves(forest, child, slot))
        .sum()
}
