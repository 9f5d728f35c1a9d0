//! The Earth as a forest of unfull quadtrees.

use super::eye::{Eye, Refine, Sight};
use super::forest::{BLOCKS, Forest, Slot, root_slot};
use super::node::{Cut, Node, Side};
use super::page::side_rad;
use super::patch::{Built, MOST_PATCH_LEVEL, Scratch};
use crate::elevation::Elevation;
use crate::frames::Ellipsoid;
use crate::globe::surface::{GroundView, Patch, Surface, SurfaceStats};
use std::collections::HashMap;

/// What a [`Quadtree`] may take, and by which rule it divides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadtreeOptions {
    /// The figure.
    pub ellipsoid: Ellipsoid,
    /// When a leaf is divided.
    pub refine: Refine,
    /// Most leaves at once, drawn or not: about five triangles and up to 1 kB each. Where the tolerance asks for more, it is
    /// eased, and the error that is reported tells. At least 512.
    pub most_leaves: u32,
    /// Most pages: the quarters of a square each, 300 bytes. At least 256.
    pub most_pages: u32,
    /// Finest level: 0 are the blocks of 22.5°, 24 is 15 cm. At most 32.
    pub most_level: u8,
    /// Work in a frame: a leaf built anew counts as 1, a new vertex as 4, a page read as [`PAGE_WORK`].
    pub work: u32,
    /// Leave out patches that lie outside the picture, beyond the horizon, or face away with every face.
    pub is_culled: bool,
    /// Bound what the data do between the posts that were read by their range alone, where they are finer than the posts.
    /// Costs several times the leaves. Without it, the ground is taken to be half as rough at half the step, and to
    /// reach no further than its range: enough for terrain and for spikes, but a narrow ledge on a slope may be seen late.
    pub is_certain: bool,
}

/// What reading a page counts as in [`QuadtreeOptions::work`].
pub const PAGE_WORK: u32 = 50;

impl Default for QuadtreeOptions {
    fn default() -> Self {
        Self {
            ellipsoid: Ellipsoid::WGS84,
            refine: Refine::Tolerance,
            most_leaves: 24_000,
            most_pages: 16_384,
            most_level: 24,
            work: 4_000,
            is_culled: true,
            is_certain: false,
        }
    }
}

/// A leaf is merged again only once it is this much finer than it must be, so that an eye that hovers does not toggle.
const HYSTERESIS: f64 = 0.7;
/// A patch with more leaves is divided into four.
const MOST_PATCH_LEAVES: u32 = 256;
/// Four patches with fewer become one.
const LEAST_PATCH_LEAVES: u32 = 80;
/// A patch is divided where the ball about it is larger than so many distances: single precision then holds its vertices
/// to a thousandth of a pixel.
const MOST_BALLS: f64 = 6.0;
/// Work of a division: eight new points.
const SPLIT_WORK: u32 = 32;
/// Steps of the table of ratios, for each doubling.
const BINS_PER_DOUBLING: f64 = 8.0;
const BINS: usize = 256;

/// Ground as a forest of unfull quadtrees.
pub struct Quadtree {
    options: QuadtreeOptions,
    pub(super) forest: Option<Forest>,
    pub(super) patches: Vec<Built>,
    /// Patches that are no more; their memory serves the next.
    spare: Vec<Built>,
    by_node: HashMap<Node, u32>,
    leaves: u32,
    /// Ratios above this are divided: 1, or more where there would be too many leaves.
    relax: f64,
    /// Most that anything drawn is off by, metres: the Earth hides ground only below that.
    deepest_m: f64,
    revision: u64,
    spent: u32,
    order: Vec<u32>,
    drawn: Vec<u32>,
    stack: Vec<(Node, Slot, Sight)>,
    bins: Vec<u32>,
    /// Work that leaves above a ratio would take.
    wanted: Vec<u64>,
    /// Ratios above this are divided in this frame: the worst leaves first, wherever they are.
    floor: f64,
    scratch: Scratch,
    stats: SurfaceStats,
    rebuilt: u32,
    changes: u32,
}

impl Quadtree {
    /// A surface that has read nothing yet. The first view reads the 128 first pages, about 10 000 heights.
    pub fn new(options: QuadtreeOptions) -> Self {
        let options = QuadtreeOptions {
            most_leaves: options.most_leaves.max(512),
            most_level: options.most_level.min(32),
            ..options
        };
        Self {
            options,
            forest: None,
            patches: Vec::new(),
            spare: Vec::new(),
            by_node: HashMap::new(),
            leaves: 0,
            relax: 1.0,
            deepest_m: f64::INFINITY,
            revision: 1,
            spent: 0,
            order: Vec::new(),
            drawn: Vec::new(),
            stack: Vec::new(),
            bins: vec![0; BINS],
            wanted: vec![0; BINS],
            floor: 1.0,
            scratch: Scratch::default(),
            stats: SurfaceStats::default(),
            rebuilt: 0,
            changes: 0,
        }
    }

    /// Leaves there are, drawn or not.
    pub fn leaves(&self) -> u32 {
        self.leaves
    }

    /// Patches that the last view built anew.
    pub fn rebuilt(&self) -> u32 {
        self.rebuilt
    }

    /// Prepares a view again and again, without a budget of work, until it asks for nothing more: for stills.
    pub fn settle(&mut self, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats {
        let work = std::mem::replace(&mut self.options.work, u32::MAX);
        // Each round goes as deep as it may; more than a few are needed only where leaves run out.
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
            self.options.most_pages as usize,
            self.options.is_certain,
            ground,
        );
        for y in 0..BLOCKS.rows {
            for x in 0..BLOCKS.columns {
                let node = Node { level: 0, x, y };
                self.by_node.insert(node, self.patches.len() as u32);
                let patch = Built::new(node, root_slot(node), &forest, self.revision);
                self.patches.push(patch);
            }
        }
        self.leaves = self.patches.len() as u32;
        self.forest = Some(forest);
    }

    /// Looks at patches, or only at those that have changed: are they seen, do they need work, how far are they off. Answers
    /// the largest error of what is seen, metres.
    fn look(&mut self, forest: &Forest, eye: &Eye, is_all: bool) -> f64 {
        self.bins.fill(0);
        self.wanted.fill(0);
        let (mut error_m, mut error_px) = (0.0_f64, 0.0_f64);
        for index in 0..self.patches.len() {
            if is_all || self.patches[index].is_dirty {
                self.look_at(index, forest, eye);
            }
            let (patch_m, patch_px) = self.patches[index].error;
            (error_m, error_px) = (error_m.max(patch_m), error_px.max(patch_px));
        }
        (self.stats.error_m, self.stats.error_px) = (Some(error_m), Some(error_px));
        error_m
    }

    fn look_at(&mut self, index: usize, forest: &Forest, eye: &Eye) {
        let built = &mut self.patches[index];
        let Some(slot) = forest.slot(built.node) else {
            return;
        };
        let info = forest.info(slot);
        built.distance_m = eye.distance_m(info);
        let sight = eye.sight(info);
        built.is_drawn = eye.draws(info, built.cone);
        (built.urgency, built.has_merges, built.leaves) = (0.0, false, 0);
        built.error = (0.0, 0.0);
        self.stack.clear();
        self.stack.push((built.node, slot, sight));
        while let Some((node, slot, above)) = self.stack.pop() {
            let info = forest.info(slot);
            let sight = if above == Sight::Part {
                eye.sight(info)
            } else {
                above
            };
            let side_m = side_m(&self.options.ellipsoid, node);
            let ratio = eye.ratio(info, side_m, sight);
            let bin = (ratio.max(1.0).log2() * BINS_PER_DOUBLING) as usize;
            let bin = bin.min(BINS - 1);
            self.bins[bin] += u32::from(ratio > 1.0);
            if forest.is_split(slot) {
                built.has_merges |= ratio < HYSTERESIS * self.relax;
                for k in 0..4 {
                    if let Some(slot) = forest.child(node, slot, k) {
                        self.stack.push((node.child(k), slot, sight));
                    }
                }
                continue;
            }
            built.leaves += 1;
            if ratio > self.relax && node.level < self.options.most_level {
                built.urgency = built.urgency.max(ratio);
                let is_known = forest.has_children(slot);
                let work = if is_known { 0 } else { PAGE_WORK } + 2 * SPLIT_WORK;
                self.wanted[bin] += u64::from(work);
            }
            if matches!(sight, Sight::Whole | Sight::Part) {
                let (error_m, error_px) = built.error;
                let leaf_px = eye.error_px(info);
                built.error = (error_m.max(f64::from(info.error_m)), error_px.max(leaf_px));
            }
        }
    }

    /// Looks with a horizon below all that is drawn: what is drawn too low must not be taken to hide what is behind.
    fn look_over(&mut self, forest: &Forest, view: &GroundView) -> Option<Eye> {
        let options = self.options;
        let lowest_m = forest.range_m().0;
        loop {
            let below_m = lowest_m - self.deepest_m;
            let eye = Eye::new(
                view,
                options.refine,
                &options.ellipsoid,
                below_m,
                options.is_culled,
            )?;
            let error_m = self.look(forest, &eye, true);
            if error_m <= self.deepest_m {
                // Half as much again, so that the next looks need not be repeated.
                self.deepest_m = self.deepest_m.min(1.5 * error_m);
                return Some(eye);
            }
            self.deepest_m = 1.5 * error_m;
        }
    }

    /// Eases the tolerance as far as the leaves that it would take are too many, and finds which can be divided in one
    /// frame.
    fn ease(&mut self) {
        let roots = BLOCKS.columns * BLOCKS.rows;
        let most = u64::from(self.options.most_leaves).saturating_sub(roots) / 3;
        let (mut count, mut relax) = (0, 1.0);
        for bin in (0..BINS).rev() {
            count += u64::from(self.bins[bin]);
            if count > most {
                relax = ((bin + 1) as f64 / BINS_PER_DOUBLING).exp2();
                break;
            }
        }
        self.relax = relax;
        let (mut wanted, mut floor) = (0, relax);
        for bin in (0..BINS).rev() {
            wanted += self.wanted[bin];
            if wanted >= u64::from(self.options.work) {
                floor = (bin as f64 / BINS_PER_DOUBLING).exp2();
                break;
            }
        }
        self.floor = floor.max(relax);
    }

    /// Divides and merges below a node. Answers whether it is divided.
    fn refine(
        &mut self,
        forest: &mut Forest,
        eye: &Eye,
        ground: &dyn Elevation,
        (node, slot): (Node, Slot),
        most_work: u32,
    ) -> bool {
        let info = *forest.info(slot);
        let side_m = side_m(&self.options.ellipsoid, node);
        let ratio = eye.ratio(&info, side_m, eye.sight(&info));
        let was_split = forest.is_split(slot);
        if !was_split {
            let is_wanted = ratio > self.floor
                && node.level < self.options.most_level
                && self.leaves + 3 <= self.options.most_leaves
                && self.spent < most_work;
            if !is_wanted {
                return false;
            }
            if !forest.has_children(slot) {
                self.spent = self.spent.saturating_add(PAGE_WORK);
                if !forest.read_children(node, slot, ground) {
                    return false;
                }
                // Seen closer it may do as it is.
                if eye.ratio(forest.info(slot), side_m, eye.sight(&info)) <= self.floor {
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
                let child = (node.child(k), slot);
                is_deeper |= self.refine(forest, eye, ground, child, most_work);
            }
        }
        let is_spare = was_split && !is_deeper && ratio < HYSTERESIS * self.relax;
        if is_spare && self.spent < most_work {
            forest.set_split(slot, false);
            forest.touch(slot);
            self.leaves -= 3;
            self.changed(forest, node);
            return false;
        }
        true
    }

    /// Notes that a node was divided or merged: its patch is built anew, and those of leaves beside that share points.
    fn changed(&mut self, forest: &Forest, node: Node) {
        self.changes += 1;
        self.spent = self.spent.saturating_add(SPLIT_WORK);
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
                self.spent = self.spent.saturating_add(built.leaves);
            }
        }
    }

    /// Divides and merges leaves, the worst patches first, while there is work left.
    fn improve(&mut self, forest: &mut Forest, eye: &Eye, ground: &dyn Elevation) {
        let floor = self.floor;
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
            // A part of the work is kept for merging.
            let most_work = if built.urgency > floor {
                self.options.work - self.options.work / 4
            } else {
                self.options.work
            };
            if self.spent >= most_work {
                continue;
            }
            let node = built.node;
            if let Some(slot) = forest.slot(node) {
                self.refine(forest, eye, ground, (node, slot), most_work);
            }
        }
        self.order = order;
    }

    /// Divides patches that are too large, and joins those that are small.
    fn rearrange(&mut self, forest: &mut Forest, eye: &Eye) {
        let mut index = 0;
        while index < self.patches.len() {
            let built = &self.patches[index];
            let (node, leaves, distance_m) = (built.node, built.leaves, built.distance_m);
            index += 1;
            let Some(slot) = forest.slot(node) else {
                continue;
            };
            let ball_m = f64::from(forest.info(slot).radius_m);
            if forest.is_split(slot) && node.level < MOST_PATCH_LEVEL {
                if leaves > MOST_PATCH_LEAVES || ball_m > MOST_BALLS * distance_m {
                    self.changes += 1;
                    self.divide(forest, eye, node, slot);
                    // The last patch now has this place.
                    index -= 1;
                }
                if leaves > LEAST_PATCH_LEAVES {
                    continue;
                }
            }
            if node.x & 1 == 0 && node.y & 1 == 0 && self.spent < self.options.work {
                self.join(forest, eye, node);
            }
        }
    }

    /// Makes a patch of each quarter of a patch.
    fn divide(&mut self, forest: &mut Forest, eye: &Eye, node: Node, slot: Slot) {
        let old_step_m = self.remove(node);
        forest.set_patch(slot, false);
        for k in 0..4 {
            if let Some(slot) = forest.child(node, slot, k) {
                forest.set_patch(slot, true);
                self.add(forest, eye, node.child(k), slot);
            }
        }
        self.steps_changed(node, old_step_m);
    }

    /// Makes one patch of four, if there are four beside each other and they are small.
    fn join(&mut self, forest: &mut Forest, eye: &Eye, first: Node) {
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
        let is_near = f64::from(info.radius_m) > 0.5 * MOST_BALLS * eye.distance_m(info);
        if leaves >= LEAST_PATCH_LEAVES || is_near {
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
        let index = self.add(forest, eye, parent, slot);
        let step_m = self.patches[index].step_m;
        self.steps_changed(parent, step_m);
    }

    /// Patches that touch a node and stand on finer steps than there are or were must be built anew.
    fn steps_changed(&mut self, node: Node, step_m: f64) {
        for built in &mut self.patches {
            if !built.is_dirty && built.step_m < step_m && touches(built.node, node) {
                built.is_dirty = true;
                self.spent = self.spent.saturating_add(built.leaves);
            }
        }
    }

    fn add(&mut self, forest: &Forest, eye: &Eye, node: Node, slot: Slot) -> usize {
        // Above all that any patch of this node had before.
        self.revision += 2;
        let mut built = match self.spare.pop() {
            Some(mut built) => {
                built.reset(node, slot, forest, self.revision);
                built
            }
            None => Built::new(node, slot, forest, self.revision),
        };
        let info = forest.info(slot);
        built.distance_m = eye.distance_m(info);
        built.leaves = count_leaves(forest, node, slot);
        self.spent = self.spent.saturating_add(8 * built.leaves);
        let index = self.patches.len();
        self.by_node.insert(node, index as u32);
        self.patches.push(built);
        index
    }

    /// Takes a patch away. Answers its steps.
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
        if self.spare.len() < 64 {
            self.spare.push(built);
        }
        step_m
    }

    /// Builds every patch that a change touched: all in one frame, so that no edge is open between two.
    fn build(&mut self, forest: &Forest, eye: &Eye, ground: &dyn Elevation) {
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
            let all = self.patches.iter();
            let beside = all.filter(|other| touches(other.node, node));
            let beside = beside.map(|other| (other.node, other.step_m));
            self.scratch.beside.extend(beside);
            // In an order of their own, so that the same ones are known again.
            self.scratch.beside.sort_unstable_by_key(|(node, _)| *node);
            let built = &mut self.patches[index];
            built.build(forest, slot, ground, &mut self.scratch);
            built.is_drawn = eye.draws(forest.info(slot), built.cone);
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
        bytes += self.spare.iter().map(Built::resident_bytes).sum::<usize>();
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
        if let Some(mut eye) = self.look_over(&forest, view) {
            forest.start_frame();
            (self.spent, self.changes) = (0, 0);
            self.ease();
            self.improve(&mut forest, &eye, ground);
            // Leaves, and what is seen of them, have changed; very rarely for the worse.
            if self.changes > 0
                && self.look(&forest, &eye, false) > self.deepest_m
                && let Some(again) = self.look_over(&forest, view)
            {
                eye = again;
            }
            self.rearrange(&mut forest, &eye);
            self.build(&forest, &eye, ground);
            self.count(&forest);
        }
        self.forest = Some(forest);
        self.stats
    }

    fn visit(&self, draw: &mut dyn FnMut(&Patch)) {
        for index in &self.drawn {
            draw(&self.patches[*index as usize].patch);
        }
    }
}

/// Side of a node along a meridian, metres.
fn side_m(ellipsoid: &Ellipsoid, node: Node) -> f64 {
    side_rad(node.level) * ellipsoid.equatorial_radius_m
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

/// Whether two squares have a point in common, across the date line and at the poles too.
fn touches(a: Node, b: Node) -> bool {
    let depth = a.level.max(b.level);
    let (a, b) = (a.square(depth), b.square(depth));
    let (columns, rows) = (BLOCKS.columns << depth, BLOCKS.rows << depth);
    let is_near = |a: u64, a_size: u64, b: u64, b_size: u64| a <= b + b_size && b <= a + a_size;
    let at_pole = |y: u64, size: u64| (y == 0, y + size == rows);
    let (a_pole, b_pole) = (at_pole(a.y, a.size), at_pole(b.y, b.size));
    let across = is_near(a.x, a.size, b.x, b.size)
        || is_near(a.x + columns, a.size, b.x, b.size)
        || is_near(a.x, a.size, b.x + columns, b.size);
    is_near(a.y, a.size, b.y, b.size) && across || a_pole.0 && b_pole.0 || a_pole.1 && b_pole.1
}
