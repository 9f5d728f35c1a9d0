//! The forest over the Earth: one tree for each of the 16 × 8 blocks, in pages that are read when the eye comes near.

use super::node::{Cut, Domain, Node};
use super::page::{DEPTH, PAGE_NODES, PageReader, SquareInfo, bounds, quarter};
use crate::elevation::{Elevation, HeightChange};
use crate::globe::blocks::{BLOCK_COUNT, COLUMNS, ROWS};
use terrella_frames::Ellipsoid;

/// No page.
const NONE: u32 = u32::MAX;

/// The blocks as roots.
pub const BLOCKS: Domain = Domain {
    columns: COLUMNS as u64,
    rows: ROWS as u64,
    is_globe: true,
};

/// The quarters of a node.
struct Page {
    node: Node,
    infos: [SquareInfo; PAGE_NODES],
    /// Pages of the quarters.
    below: [u32; PAGE_NODES],
    pages_below: u32,
    /// One bit per square that is divided.
    split: u8,
    /// One bit per square that is a patch.
    patch: u8,
    /// The frame in which it was last used.
    asked: u64,
    /// Errors of the quarters according to this page; a page read below one may have a better value.
    own_error_m: [f32; PAGE_NODES],
    /// Error of its node according to this page.
    node_error_m: f32,
    /// Whether heights have changed since it was read.
    is_stale: bool,
}

struct Root {
    info: SquareInfo,
    page: u32,
    is_split: bool,
    is_patch: bool,
}

/// Where a node is stored: a root by its block, another by its page and its index there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    page: u32,
    place: u32,
}

/// The trees, with the squares that are divided and those that are patches.
pub struct Forest {
    ellipsoid: Ellipsoid,
    roots: Vec<Root>,
    pages: Vec<Page>,
    /// Index at which the search for a page to evict continues.
    hand: usize,
    max_pages: usize,
    /// Pages whose heights have changed since they were read.
    stale: u32,
    /// The page that was last checked for that.
    reread: usize,
    frame: u64,
    reader: PageReader,
}

impl Cut for Forest {
    type Place = Slot;

    fn domain(&self) -> Domain {
        BLOCKS
    }

    fn root(&self, node: Node) -> Slot {
        root_slot(node)
    }

    fn is_split(&self, slot: Slot) -> bool {
        match slot.page {
            NONE => self.roots[slot.place as usize].is_split,
            page => self.pages[page as usize].split >> slot.place & 1 == 1,
        }
    }

    fn child(&self, node: Node, slot: Slot, k: u8) -> Option<Slot> {
        let place = quarter(node.child(k));
        let page = self.page_of(slot)?;
        Some(Slot { page, place })
    }
}

impl Forest {
    /// The 128 blocks, each with its first page: all undivided, and each a patch.
    pub fn new(
        ellipsoid: Ellipsoid,
        max_pages: usize,
        is_certain: bool,
        ground: &dyn Elevation,
    ) -> Self {
        let max_pages = max_pages.max(2 * BLOCK_COUNT as usize);
        let mut forest = Self {
            ellipsoid,
            roots: Vec::with_capacity(BLOCK_COUNT as usize),
            // Never reallocated: that would take longer than a frame.
            pages: Vec::with_capacity(max_pages),
            hand: 0,
            max_pages,
            stale: 0,
            reread: 0,
            frame: 0,
            reader: PageReader::new(is_certain),
        };
        for index in 0..BLOCK_COUNT {
            let node = Node {
                level: 0,
                x: u64::from(index % COLUMNS),
                y: u64::from(index / COLUMNS),
            };
            let (info, page) = forest.read(node, ground);
            forest.pages.push(page);
            forest.roots.push(Root {
                info,
                page: index,
                is_split: false,
                is_patch: true,
            });
        }
        forest
    }

    fn read(&mut self, node: Node, ground: &dyn Elevation) -> (SquareInfo, Page) {
        let (own, infos) = self.reader.read(node, &self.ellipsoid, ground);
        let page = Page {
            node,
            infos,
            below: [NONE; PAGE_NODES],
            pages_below: 0,
            split: 0,
            patch: 0,
            asked: self.frame,
            own_error_m: infos.map(|info| info.error_m),
            node_error_m: own.error_m,
            is_stale: false,
        };
        (own, page)
    }

    /// Figure of the Earth that heights are measured from.
    pub fn ellipsoid(&self) -> &Ellipsoid {
        &self.ellipsoid
    }

    /// Starts a frame: pages used from now on are kept through it.
    pub fn start_frame(&mut self) {
        self.frame += 1;
        self.reader.samples_read = 0;
    }

    /// Places read in this frame.
    pub fn samples_read(&self) -> u64 {
        self.reader.samples_read
    }

    /// Bytes of the pages.
    pub fn resident_bytes(&self) -> usize {
        self.pages.len() * size_of::<Page>() + self.roots.capacity() * size_of::<Root>()
    }

    /// Pages in memory.
    #[cfg(test)]
    pub fn pages(&self) -> usize {
        self.pages.len()
    }

    /// Where a node is stored, if its page is in memory.
    pub fn slot(&self, node: Node) -> Option<Slot> {
        let mut slot = root_slot(node.ancestor(0));
        for level in 1..=node.level {
            let page = self.page_of(slot)?;
            let place = quarter(node.ancestor(level));
            slot = Slot { page, place };
        }
        Some(slot)
    }

    /// The page of a node's quarters.
    fn page_of(&self, slot: Slot) -> Option<u32> {
        let page = if slot.page == NONE {
            self.roots[slot.place as usize].page
        } else {
            self.pages[slot.page as usize].below[slot.place as usize]
        };
        (page != NONE).then_some(page)
    }

    /// Where the quarters of a node are stored, in Morton order.
    pub fn children(&self, slot: Slot) -> Option<[Slot; PAGE_NODES]> {
        let page = self.page_of(slot)?;
        Some([0, 1, 2, 3].map(|place| Slot { page, place }))
    }

    /// Properties of a node.
    pub fn info(&self, slot: Slot) -> &SquareInfo {
        match slot.page {
            NONE => &self.roots[slot.place as usize].info,
            page => &self.pages[page as usize].infos[slot.place as usize],
        }
    }

    /// Divides a node or makes it a leaf.
    pub fn set_split(&mut self, slot: Slot, is_split: bool) {
        match slot.page {
            NONE => self.roots[slot.place as usize].is_split = is_split,
            page => set_bit(&mut self.pages[page as usize].split, slot.place, is_split),
        }
    }

    /// Whether the node is a patch.
    pub fn is_patch(&self, slot: Slot) -> bool {
        match slot.page {
            NONE => self.roots[slot.place as usize].is_patch,
            page => self.pages[page as usize].patch >> slot.place & 1 == 1,
        }
    }

    /// Makes a node a patch, or makes it no longer one.
    pub fn set_patch(&mut self, slot: Slot, is_patch: bool) {
        match slot.page {
            NONE => self.roots[slot.place as usize].is_patch = is_patch,
            page => set_bit(&mut self.pages[page as usize].patch, slot.place, is_patch),
        }
    }

    /// The child of `at` that contains a finer node, with its slot.
    fn towards(&self, at: Node, slot: Slot, node: Node) -> Option<(Node, Slot)> {
        let (next, k) = at.child_towards(node);
        Some((next, self.child(at, slot, k)?))
    }

    /// The patch that contains a node, or is the node.
    pub fn patch_of(&self, node: Node) -> Option<Node> {
        let mut at = node.ancestor(0);
        let mut slot = root_slot(at);
        loop {
            if self.is_patch(slot) {
                return Some(at);
            }
            if at.level == node.level {
                return None;
            }
            (at, slot) = self.towards(at, slot, node)?;
        }
    }

    /// The patches that share a point with a square, including itself if it is one.
    pub fn patches_beside(&self, node: Node, found: &mut impl FnMut(Node)) {
        for index in 0..BLOCK_COUNT {
            let block = Node {
                level: 0,
                x: u64::from(index % COLUMNS),
                y: u64::from(index / COLUMNS),
            };
            self.patches_within(block, root_slot(block), node, found);
        }
    }

    fn patches_within(&self, at: Node, slot: Slot, beside: Node, found: &mut impl FnMut(Node)) {
        if !BLOCKS.is_adjacent(at, beside) {
            return;
        }
        if self.is_patch(slot) {
            return found(at);
        }
        for k in 0..4 {
            if let Some(slot) = self.child(at, slot, k) {
                self.patches_within(at.child(k), slot, beside, found);
            }
        }
    }

    /// The leaf that contains a node, or is the node; `None` if the node is divided.
    pub fn leaf_of(&self, node: Node) -> Option<Node> {
        let mut at = node.ancestor(0);
        let mut slot = root_slot(at);
        while self.is_split(slot) {
            if at.level == node.level {
                return None;
            }
            (at, slot) = self.towards(at, slot, node)?;
        }
        Some(at)
    }

    /// Whether the page below a node is in memory.
    pub fn has_children(&self, slot: Slot) -> bool {
        self.page_of(slot).is_some()
    }

    /// Reads the page below a node. Returns false if all pages are in use.
    pub fn read_children(&mut self, node: Node, slot: Slot, ground: &dyn Elevation) -> bool {
        if self.has_children(slot) {
            return true;
        }
        let Some(index) = self.room() else {
            return false;
        };
        let (own, page) = self.read(node, ground);
        if index as usize == self.pages.len() {
            self.pages.push(page);
        } else {
            self.pages[index as usize] = page;
        }
        let holder = &mut self.pages[slot.page as usize];
        holder.below[slot.place as usize] = index;
        holder.pages_below += 1;
        // At the finer reading, the same square may be smoother than the first bound.
        let info = &mut holder.infos[slot.place as usize];
        info.error_m = info.error_m.min(own.error_m);
        true
    }

    /// Marks the page below a node as used.
    pub fn touch(&mut self, slot: Slot) {
        if let Some(page) = self.page_of(slot) {
            self.pages[page as usize].asked = self.frame;
        }
    }

    /// An index for a page: a new one, or that of an unneeded page that was not used lately.
    fn room(&mut self) -> Option<u32> {
        if self.pages.len() < self.max_pages {
            return Some(self.pages.len() as u32);
        }
        // Pages used in this frame or the last are kept.
        for _ in 0..self.pages.len() {
            self.hand = (self.hand + 1) % self.pages.len();
            let page = &self.pages[self.hand];
            let node = page.node;
            let is_idle = page.pages_below == 0 && page.asked + 1 < self.frame;
            if node.level == 0 || !is_idle {
                continue;
            }
            let holder = self.slot(node)?;
            if self.is_split(holder) {
                continue;
            }
            let holding = &mut self.pages[holder.page as usize];
            holding.below[holder.place as usize] = NONE;
            holding.pages_below -= 1;
            let was_stale = std::mem::take(&mut self.pages[self.hand].is_stale);
            self.stale -= u32::from(was_stale);
            return Some(self.hand as u32);
        }
        None
    }

    /// Reports where heights have changed. Properties of squares there are extended at once to contain the new heights, and are read again
    /// by [`Self::read_stale`].
    pub fn heights_changed(&mut self, changes: &[HeightChange]) {
        let Self {
            ellipsoid,
            roots,
            pages,
            stale,
            ..
        } = self;
        // A touched square is inside a touched square; others are skipped with everything below them.
        let mut below: Vec<u32> = (0..BLOCK_COUNT).collect();
        while let Some(index) = below.pop() {
            let page = &mut pages[index as usize];
            let bounds_of = |node: Node| bounds(node.square(DEPTH));
            let of_page = bounds_of(page.node);
            let mut is_touched = false;
            for change in changes.iter().filter(|c| c.touches(&of_page, 0.0, 0.0)) {
                is_touched = true;
                *stale += u32::from(!page.is_stale);
                page.is_stale = true;
                for (info, child) in page.infos.iter_mut().zip(page.node.children()) {
                    if change.touches(&bounds_of(child), 0.0, 0.0) {
                        info.widen(child, ellipsoid, &change.range);
                    }
                }
                if page.node.level == 0 {
                    let root = root_slot(page.node).place as usize;
                    roots[root].info.widen(page.node, ellipsoid, &change.range);
                }
            }
            if is_touched {
                below.extend(page.below.iter().filter(|index| **index != NONE));
            }
        }
    }

    /// Whether some pages were read before their heights changed.
    pub fn is_stale(&self) -> bool {
        self.stale > 0
    }

    /// Reads pages again whose heights have changed, at most `most`.
    pub fn read_stale(&mut self, most: u32, ground: &dyn Elevation) {
        let mut left = most;
        for _ in 0..self.pages.len() {
            if left == 0 || self.stale == 0 {
                return;
            }
            // Continues where the last call ended, so that pages that change repeatedly do not delay others.
            self.reread = (self.reread + 1) % self.pages.len();
            if self.pages[self.reread].is_stale {
                left -= 1;
                self.stale -= 1;
                self.read_again(self.reread, ground);
            }
        }
    }

    fn read_again(&mut self, index: usize, ground: &dyn Elevation) {
        let node = self.pages[index].node;
        let (own, mut page) = self.read(node, ground);
        let before = &mut self.pages[index];
        // Keep the errors of squares whose own quarters have been read.
        (page.below, page.pages_below) = (before.below, before.pages_below);
        (page.split, page.patch, page.asked) = (before.split, before.patch, before.asked);
        *before = page;
        for place in 0..PAGE_NODES {
            let below = self.pages[index].below[place];
            if below != NONE {
                let known_m = self.pages[below as usize].node_error_m;
                let info = &mut self.pages[index].infos[place];
                info.error_m = info.error_m.min(known_m);
            }
        }
        if node.level == 0 {
            self.roots[root_slot(node).place as usize].info = own;
        } else if let Some(slot) = self.slot(node) {
            let holder = &mut self.pages[slot.page as usize];
            let place = slot.place as usize;
            holder.infos[place].error_m = holder.own_error_m[place].min(own.error_m);
        }
    }

    /// Merges everything: each block is one leaf and a patch. Properties of squares are kept.
    pub fn merge_all(&mut self) {
        for root in &mut self.roots {
            (root.is_split, root.is_patch) = (false, true);
        }
        for page in &mut self.pages {
            (page.split, page.patch) = (0, 0);
        }
    }

    /// Lowest and highest height of the Earth, metres.
    pub fn range_m(&self) -> (f64, f64) {
        let infos = self.roots.iter().map(|root| &root.info);
        infos.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), info| {
            (
                low.min(f64::from(info.low_m)),
                high.max(f64::from(info.high_m)),
            )
        })
    }
}

/// Where a root is stored.
pub fn root_slot(block: Node) -> Slot {
    Slot {
        page: NONE,
        place: (block.y * u64::from(COLUMNS) + block.x) as u32,
    }
}

fn set_bit(bits: &mut u8, place: u32, value: bool) {
    *bits = *bits & !(1 << place) | u8::from(value) << place;
}
