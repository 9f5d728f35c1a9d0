//! The Earth as a forest of unfull quadtrees.

use super::forest::{BLOCKS, Forest, Slot, root_slot};
use super::lod::{LodView, SplitRule, seen_ratio};
use super::node::{Cut, Node, Side};
use super::page::side_rad;
use super::patch::{BuiltPatch, PointHasher, Scratch};
use crate::elevation::{Elevation, HeightChange, HeightRange};
use crate::globe::culling::BoundVisibility;
use crate::globe::surface::{GroundView, Patch, Surface, SurfaceStats};
use std::collections::HashMap;
use std::hash::BuildHasherDefault;
use terrella_frames::Ellipsoid;

/// Budgets of a [`Quadtree`], and its split rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadtreeOptions {
    /// Figure of the Earth that heights are measured from.
    pub ellipsoid: Ellipsoid,
    /// Rule by which a leaf is divided.
    pub split_rule: SplitRule,
    /// Largest number of leaves at once, drawn or not: about five triangles and up to 1 kB each. If the tolerance needs more, it is eased,
    /// and the reported error includes that. At least 512.
    pub max_leaves: u32,
    /// Largest number of pages: the quarters of a square each, 300 bytes. At least 256.
    pub max_pages: u32,
    /// Finest level: 0 is the blocks of 22.5°, 24 is 15 cm. At most 32.
    pub max_level: u8,
    /// Work in a frame: a rebuilt leaf counts as 1, a new vertex as 4, a page read as `PAGE_WORK`.
    pub work: u32,
    /// Whether to cull patches that are outside the image, beyond the horizon, or face away with every face.
    pub is_culled: bool,
    /// Whether to bound the data between the posts by their range alone, if the data are finer than the posts. This costs several times the
    /// leaves. Without it, the ground is assumed to be half as rough at half the step, and not to exceed its range. That is enough for
    /// terrain and for spikes, but a narrow ledge on a slope may appear late.
    pub is_certain: bool,
}

/// Cost of reading a page in [`QuadtreeOptions::work`].
pub const PAGE_WORK: u32 = 50;

impl Default for QuadtreeOptions {
    fn default() -> Self {
        Self {
            ellipsoid: Ellipsoid::WGS84,
            split_rule: SplitRule::Tolerance,
            max_leaves: 24_000,
            max_pages: 16_384,
            max_level: 24,
            work: 3_200,
            is_culled: true,
            is_certain: false,
        }
    }
}

/// A leaf is merged again only once its ratio is below the threshold by this factor, so that a hovering eye does not toggle.
const HYSTERESIS: f64 = 0.7;
/// The same at the largest number of leaves: one step of the table of ratios. Kept leaves count in the table, so that coarse leaves never
/// wait for fine ones to be merged.
const FULL_HYSTERESIS: f64 = 0.917;
/// Largest number of patches whose memory is kept for reuse.
pub(super) const MOST_SPARE: usize = 64;
/// Work of a division: eight new points.
const SPLIT_WORK: u32 = 32;
/// Steps of the table of ratios per doubling.
const BINS_PER_DOUBLING: f64 = 8.0;
const BINS: usize = 256;

/// Terrain as a forest of unfull quadtrees.
pub struct Quadtree {
    pub(super) options: QuadtreeOptions,
    pub(super) forest: Option<Forest>,
    pub(super) patches: Vec<BuiltPatch>,
    /// Removed patches whose memory the next ones reuse.
    pub(super) spare: Vec<BuiltPatch>,
    pub(super) by_node: HashMap<Node, u32, BuildHasherDefault<PointHasher>>,
    pub(super) leaves: u32,
    /// Leaves with ratios above this are divided: 1, or more if there would be too many leaves.
    pub(super) error_threshold: f64,
    /// Leaves are merged below this fraction of the threshold.
    pub(super) hysteresis: f64,
    /// Largest error of anything drawn, metres: the Earth hides ground only below that depth.
    pub(super) deepest_m: f64,
    pub(super) revision: u64,
    pub(super) work_done: u32,
    pub(super) order: Vec<u32>,
    pub(super) drawn: Vec<u32>,
    pub(super) stack: Vec<(Node, Slot, BoundVisibility)>,
    pub(super) bins: Vec<u32>,
    /// Work that leaves above a ratio would need.
    pub(super) wanted: Vec<u64>,
    /// Leaves with ratios above this are divided in this frame: the worst ones first, wherever they are.
    pub(super) frame_threshold: f64,
    pub(super) scratch: Scratch,
    pub(super) stats: SurfaceStats,
    pub(super) rebuilt: u32,
    pub(super) changes: u32,
}

impl Quadtree {
    /// A surface that has read nothing yet. The first view reads the first 128 pages, about 10 000 heights.
    pub fn new(options: QuadtreeOptions) -> Self {
        let options = QuadtreeOptions {
            max_leaves: options.max_leaves.max(512),
            max_level: options.max_level.min(32),
            ..options
        };
        Self {
            options,
            forest: None,
            patches: Vec::new(),
            spare: Vec::new(),
            by_node: HashMap::default(),
            leaves: 0,
            error_threshold: 1.0,
            hysteresis: HYSTERESIS,
            deepest_m: f64::INFINITY,
            revision: 1,
            work_done: 0,
            order: Vec::new(),
            drawn: Vec::new(),
            stack: Vec::new(),
            bins: vec![0; BINS],
            wanted: vec![0; BINS],
            frame_threshold: 1.0,
            scratch: Scratch::default(),
            stats: SurfaceStats::default(),
            rebuilt: 0,
            changes: 0,
        }
    }

    /// Number of leaves, drawn or not.
    pub fn leaves(&self) -> u32 {
        self.leaves
    }

    /// Number of patches that the last view built again.
    pub fn rebuilt(&self) -> u32 {
        self.rebuilt
    }

    /// Prepares a view repeatedly, without a budget of work, until nothing changes: for stills.
    pub fn settle(&mut self, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats {
        let work = std::mem::replace(&mut self.options.work, u32::MAX);
        // Each round goes as deep as it may; more than a few are needed only if leaves run out.
        for _ in 0..64 {
            self.prepare(view, ground);
            if self.changes == 0 {
                break;
            }
        }
        self.options.work = work;
        self.stats
    }

    fn start(&mut self, ground: &dyn Elevation) {
        let forest = Forest::new(
            self.options.ellipsoid,
            self.options.max_pages as usize,
            self.options.is_certain,
            ground,
        );
        self.add_blocks(&forest);
        self.forest = Some(forest);
    }

    /// Makes a patch of each block.
    fn add_blocks(&mut self, forest: &Forest) {
        for y in 0..BLOCKS.rows {
            for x in 0..BLOCKS.columns {
                let node = Node { level: 0, x, y };
                self.by_node.insert(node, self.patches.len() as u32);
                let patch = BuiltPatch::new(node, root_slot(node), forest, self.revision);
                self.patches.push(patch);
            }
        }
        self.leaves = self.patches.len() as u32;
    }

    /// Evaluates all patches, or only those that have changed: visibility, remaining work and error. Returns the largest visible error,
    /// metres.
    fn evaluate_errors(&mut self, forest: &Forest, lod: &LodView, is_all: bool) -> f64 {
        self.bins.fill(0);
        self.wanted.fill(0);
        let (mut error_m, mut error_px) = (0.0_f64, 0.0_f64);
        for index in 0..self.patches.len() {
            if is_all || self.patches[index].is_dirty {
                self.evaluate_patch(index, forest, lod);
            }
            let (patch_m, patch_px) = self.patches[index].error;
            (error_m, error_px) = (error_m.max(patch_m), error_px.max(patch_px));
        }
        (self.stats.error_m, self.stats.error_px) = (Some(error_m), Some(error_px));
        error_m
    }

    fn evaluate_patch(&mut self, index: usize, forest: &Forest, lod: &LodView) {
        let built = &mut self.patches[index];
        let Some(slot) = forest.slot(built.node) else {
            return;
        };
        let info = forest.info(slot);
        built.distance_m = lod.distance_m(info);
        let visibility = lod.visibility(info);
        built.is_drawn = lod.draws(info, &built.normals);
        (built.urgency, built.has_merges, built.leaves) = (0.0, false, 0);
        built.error = (0.0, 0.0);
        self.stack.clear();
        self.stack.push((built.node, slot, visibility));
        while let Some((node, slot, above)) = self.stack.pop() {
            let info = forest.info(slot);
            let side_m = side_m(&self.options.ellipsoid, node);
            let distance_m = lod.distance_m(info);
            let full_ratio = lod.full_ratio(info, distance_m, side_m);
            let is_split = forest.is_split(slot);
            let error_m = f64::from(info.error_m);
            let error_px = lod.error_px(error_m, distance_m);
            built.leaves += u32::from(!is_split);
            let is_larger = error_m > built.error.0 || error_px > built.error.1;
            if !is_split && full_ratio <= 1.0 && !is_larger {
                // Visible or not, it changes nothing.
                continue;
            }
            let visibility = lod.visibility_within(above, info);
            let ratio = seen_ratio(full_ratio, visibility);
            let bin = match ratio > 1.0 {
                true => ((ratio.log2() * BINS_PER_DOUBLING) as usize).min(BINS - 1),
                false => 0,
            };
            self.bins[bin] += u32::from(ratio > 1.0);
            if is_split {
                built.has_merges |= ratio < self.hysteresis * self.error_threshold;
                if let Some(below) = forest.children(slot) {
                    let below = (0..4).zip(below);
                    self.stack
                        .extend(below.map(|(k, slot)| (node.child(k), slot, visibility)));
                }
                continue;
            }
            if ratio > self.error_threshold && node.level < self.options.max_level {
                built.urgency = built.urgency.max(ratio);
                let is_known = forest.has_children(slot);
                let work = if is_known { 0 } else { PAGE_WORK } + 2 * SPLIT_WORK;
                self.wanted[bin] += u64::from(work);
            }
            if visibility.is_visible() {
                let (most_m, most_px) = built.error;
                built.error = (most_m.max(error_m), most_px.max(error_px));
            }
        }
    }

    /// Evaluates the view with a horizon below all drawn terrain: terrain that is drawn too low must not hide what is behind it.
    fn evaluate_view(&mut self, forest: &Forest, view: &GroundView) -> Option<LodView> {
        let options = self.options;
        let (low_m, high_m) = forest.range_m();
        loop {
            let drawn = HeightRange {
                low_m: low_m - self.deepest_m,
                high_m,
            };
            let lod = LodView::new(
                view,
                options.split_rule,
                &options.ellipsoid,
                drawn,
                options.is_culled,
            )?;
            let error_m = self.evaluate_errors(forest, &lod, true);
            if error_m <= self.deepest_m {
                // Half as much again, so that later evaluations need not be repeated.
                self.deepest_m = self.deepest_m.min(1.5 * error_m);
                return Some(lod);
            }
            self.deepest_m = 1.5 * error_m;
        }
    }

    /// Eases the tolerance if it would need too many leaves, and finds the leaves that can be divided in one frame.
    fn set_thresholds(&mut self) {
        let roots = BLOCKS.columns * BLOCKS.rows;
        let most = u64::from(self.options.max_leaves).saturating_sub(roots) / 3;
        let (mut count, mut threshold) = (0, 1.0);
        self.hysteresis = HYSTERESIS;
        for bin in (0..BINS).rev() {
            count += u64::from(self.bins[bin]);
            if count > most {
                // The kept leaves, one step below the threshold, are then within the limit.
                threshold = ((bin + 2) as f64 / BINS_PER_DOUBLING).exp2();
                self.hysteresis = FULL_HYSTERESIS;
                break;
            }
        }
        self.error_threshold = threshold;
        let (mut wanted, mut floor) = (0, threshold);
        for bin in (0..BINS).rev() {
            wanted += self.wanted[bin];
            if wanted >= u64::from(self.options.work) {
                floor = (bin as f64 / BINS_PER_DOUBLING).exp2();
                break;
            }
        }
        self.frame_threshold = floor.max(threshold);
    }

    /// Divides and merges below a node. Returns whether the node is divided.
    fn refine(
        &mut self,
        forest: &mut Forest,
        lod: &LodView,
        ground: &dyn Elevation,
        (node, slot, above): (Node, Slot, BoundVisibility),
        max_work: u32,
    ) -> bool {
        let info = *forest.info(slot);
        let side_m = side_m(&self.options.ellipsoid, node);
        // As in `evaluate_patch`: leaves that it waits for must be divided here, or the others would wait forever.
        let visibility = lod.visibility_within(above, &info);
        let ratio = lod.split_ratio(&info, side_m, visibility);
        let was_split = forest.is_split(slot);
        if !was_split {
            let is_wanted = ratio > self.frame_threshold
                && node.level < self.options.max_level
                && self.leaves + 3 <= self.options.max_leaves
                && self.work_done < max_work;
            if !is_wanted {
                return false;
            }
            if !forest.has_children(slot) {
                self.work_done = self.work_done.saturating_add(PAGE_WORK);
                if !forest.read_children(node, slot, ground) {
                    return false;
                }
                // With its page read, the error may be small enough.
                if lod.split_ratio(forest.info(slot), side_m, visibility) <= self.frame_threshold {
                    return false;
                }
            }
            forest.set_split(slot, true);
            self.leaves += 3;
            self.changed(forest, node);
        }
        let mut is_deeper = false;
        for k in 0..4 {
            if let Some(slot) = forest.child(node, slot, k) {
                let child = (node.child(k), slot, visibility);
                is_deeper |= self.refine(forest, lod, ground, child, max_work);
            }
        }
        let is_spare = was_split && !is_deeper && ratio < self.hysteresis * self.error_threshold;
        if is_spare && self.work_done < max_work {
            forest.set_split(slot, false);
            forest.touch(slot);
            self.leaves -= 3;
            self.changed(forest, node);
            return false;
        }
        true
    }

    /// Records that a node was divided or merged. Its patch is built again, and so are patches of adjacent leaves that share points.
    fn changed(&mut self, forest: &Forest, node: Node) {
        self.changes += 1;
        self.work_done = self.work_done.saturating_add(SPLIT_WORK);
        self.must_build(forest, node);
        for side in Side::ALL {
            if let Some(beside) = BLOCKS.neighbour(node, side)
                && let Some(leaf) = forest.leaf_of(beside)
            {
                self.must_build(forest, leaf);
            }
        }
    }

    fn must_build(&mut self, forest: &Forest, node: Node) {
        let index = forest
            .patch_of(node)
            .and_then(|patch| self.by_node.get(&patch));
        if let Some(index) = index {
            let built = &mut self.patches[*index as usize];
            if !built.is_dirty {
                built.is_dirty = true;
                self.work_done = self.work_done.saturating_add(built.leaves);
            }
        }
    }

    /// Divides and merges leaves, the worst patches first, while work is left.
    fn improve(&mut self, forest: &mut Forest, lod: &LodView, ground: &dyn Elevation) {
        let floor = self.frame_threshold;
        let mut order = std::mem::take(&mut self.order);
        order.clear();
        order.extend(0..self.patches.len() as u32);
        order.retain(|index| {
            let built = &self.patches[*index as usize];
            built.urgency > floor || built.has_merges
        });
        order.sort_unstable_by(|a, b| {
            let [a, b] = [a, b].map(|index| &self.patches[*index as usize]);
            b.urgency.total_cmp(&a.urgency).then(a.node.cmp(&b.node))
        });
        for index in &order {
            let built = &self.patches[*index as usize];
            // A part of the work is reserved for merging.
            let max_work = if built.urgency > floor {
                self.options.work - self.options.work / 4
            } else {
                self.options.work
            };
            if self.work_done >= max_work {
                continue;
            }
            let node = built.node;
            if let Some(slot) = forest.slot(node) {
                let top = (node, slot, BoundVisibility::Intersecting);
                self.refine(forest, lod, ground, top, max_work);
            }
        }
        self.order = order;
    }

    /// Builds every patch that a change touched, all in one frame, so that no crack opens between two.
    fn build(&mut self, forest: &Forest, lod: &LodView, ground: &dyn Elevation) {
        self.rebuilt = 0;
        self.scratch.new_vertices = 0;
        for index in 0..self.patches.len() {
            let built = &self.patches[index];
            if !built.is_dirty {
                continue;
            }
            let node = built.node;
            let Some(slot) = forest.slot(node) else {
                continue;
            };
            self.scratch.beside.clear();
            forest.patches_beside(node, &mut |patch| {
                if let Some(index) = self.by_node.get(&patch) {
                    let step_m = self.patches[*index as usize].step_m;
                    self.scratch.beside.push((patch, step_m));
                }
            });
            // In a fixed order, so that an unchanged list compares equal.
            self.scratch.beside.sort_unstable_by_key(|(node, _)| *node);
            let built = &mut self.patches[index];
            built.build(forest, slot, ground, &mut self.scratch);
            built.is_drawn = lod.draws(forest.info(slot), &built.normals);
            self.rebuilt += 1;
        }
    }

    fn count(&mut self, forest: &Forest) {
        self.drawn.clear();
        let (mut vertices, mut triangles, mut bytes) = (0, 0, 0);
        for (index, built) in self.patches.iter().enumerate() {
            bytes += built.resident_bytes();
            if built.is_drawn {
                self.drawn.push(index as u32);
                vertices += built.patch.vertices.len() as u32;
                triangles += built.patch.indices.triangles.len() as u32 / 3;
            }
        }
        let patches = &self.patches;
        self.drawn.sort_unstable_by(|a, b| {
            let [a, b] = [a, b].map(|index| &patches[*index as usize]);
            let by_distance = a.distance_m.total_cmp(&b.distance_m);
            by_distance.then(a.node.cmp(&b.node))
        });
        bytes += self
            .spare
            .iter()
            .map(BuiltPatch::resident_bytes)
            .sum::<usize>();
        // A vertex is read once for its height and four times for its slope.
        self.stats.samples_read = forest.samples_read() + 5 * self.scratch.new_vertices;
        self.stats.patches = self.drawn.len() as u32;
        (self.stats.vertices, self.stats.triangles) = (vertices, triangles);
        self.stats.resident_bytes = (bytes + forest.resident_bytes()) as u64;
    }
}

impl Surface for Quadtree {
    fn name(&self) -> &'static str {
        "quadtree"
    }

    fn prepare(&mut self, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats {
        if self.forest.is_none() {
            self.start(ground);
        }
        let Some(mut forest) = self.forest.take() else {
            return self.stats;
        };
        if let Some(mut lod) = self.evaluate_view(&forest, view) {
            forest.start_frame();
            (self.work_done, self.changes) = (0, 0);
            self.read_stale(&mut forest, ground);
            self.set_thresholds();
            self.improve(&mut forest, &lod, ground);
            // Leaves and their visibility have changed; very rarely for the worse.
            if self.changes > 0
                && self.evaluate_errors(&forest, &lod, false) > self.deepest_m
                && let Some(again) = self.evaluate_view(&forest, view)
            {
                lod = again;
            }
            self.repartition(&mut forest, &lod);
            self.build(&forest, &lod, ground);
            self.renew(&forest, &lod, ground);
            self.count(&forest);
        }
        self.forest = Some(forest);
        self.stats
    }

    fn heights_changed(&mut self, changes: &[HeightChange], ground: &dyn Elevation) {
        if let Some(mut forest) = self.forest.take() {
            forest.heights_changed(changes);
            self.mark_changed(&forest, changes, ground);
            self.forest = Some(forest);
        }
    }

    fn forget_views(&mut self) {
        let Some(mut forest) = self.forest.take() else {
            return;
        };
        forest.merge_all();
        self.by_node.clear();
        self.drawn.clear();
        for built in self.patches.drain(..) {
            self.revision = self.revision.max(built.patch.revision);
            if self.spare.len() < MOST_SPARE {
                self.spare.push(built);
            }
        }
        self.revision += 2;
        self.add_blocks(&forest);
        self.deepest_m = f64::INFINITY;
        self.error_threshold = 1.0;
        self.forest = Some(forest);
    }

    fn for_each_patch(&self, draw: &mut dyn FnMut(&Patch)) {
        for index in &self.drawn {
            draw(&self.patches[*index as usize].patch);
        }
    }
}

/// Side of a node along a meridian, metres.
fn side_m(ellipsoid: &Ellipsoid, node: Node) -> f64 {
    side_rad(node.level) * ellipsoid.equatorial_radius_m
}
