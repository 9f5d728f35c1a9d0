//! The whole Earth as contours that rays are cast at: a forest over the blocks of 22.5°, chosen by the view.
//!
//! A *page* is what is built, uploaded and given up as a whole (imagery has the *tiles*). It is a cell of the forest: 17 × 17
//! posts of ground, averaged at its own scale, and a [`ContourTree`] over them about its own origin, fitted in f64 and
//! stored in f32. A page is cut into its four quarters while its error shows by more than the
//! tolerance: half a slab of its leaves, and what finer data would add. Within a page leaves end where slabs are thinner than
//! that, and in a picture where they are thinner than the ray sees.
//!
//! **Watertight.** A column of ground is solid to any depth, so a ray meets either its top or its wall; columns of
//! neighbours overlap ([`Dem::reaching`]), and are widened by what rounding of the eye's place leaves. What is drawn of a
//! page is bounded by a prism, which reaches down as far as a neighbour may lie lower.
//!
//! **Per frame.** Pages are built within a budget, those of the largest errors first, and their parents drawn until all four
//! are there. Nothing waits, and where nothing is built nothing is allocated. At most [`PageOptions::max_pages`] are kept;
//! the one that was longest out of use makes way.
//!
//! [`ContourTree`]: super::tree::ContourTree
//! [`Dem::reaching`]: super::dem::Dem::reaching

mod page;

use super::gpu_layout::{ContourRay, contour_cast};
use super::surface::lattice::{Cell, ball, chord_m};
use super::surface::lookup::KeyMap;
use crate::elevation::{Bounds, Elevation, HeightChange, HeightRange};
use crate::globe::culling::{CullingContext, GroundBound};
use crate::globe::{
    ContourPage, ContourPageSet, DrawKind, GroundView, Patch, Surface, SurfaceStats,
};
use glam::DVec3;
use page::{CELLS, MAX_LEVEL};
pub use page::{MAX_NODES, Page};
use std::f64::consts::FRAC_PI_8;
use terrella_frames::Ellipsoid;

/// How much the surface may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PageOptions {
    /// Figure of the Earth that heights refer to.
    pub ellipsoid: Ellipsoid,
    /// Most pages that are kept, 144…2048. One takes up to 44 kB in memory and as much on the GPU.
    pub max_pages: u32,
    /// Pages that are built in a frame; 1 and more. Those of whole blocks, which every view needs, are built beyond it.
    pub built_per_frame: u32,
}

impl Default for PageOptions {
    fn default() -> Self {
        Self {
            ellipsoid: Ellipsoid::WGS84,
            max_pages: 768,
            built_per_frame: 4,
        }
    }
}

impl PageOptions {
    /// As they are taken: in range.
    pub fn within_limits(self) -> Self {
        Self {
            max_pages: self.max_pages.clamp(144, 2048),
            built_per_frame: self.built_per_frame.max(1),
            ..self
        }
    }

    /// Bytes of all nodes on the GPU.
    pub fn node_bytes(&self) -> u64 {
        let pages = u64::from(self.within_limits().max_pages);
        pages * u64::from(MAX_NODES) * size_of::<super::ContourNode>() as u64
    }
}

/// Once cut, a page stays cut until its error shows by less than this part of the tolerance.
const HYSTERESIS: f64 = 0.8;

/// The part of the tolerance that pages may take. The other quarter is for nodes that count as leaves in a picture because a
/// ray sees half their slab as less.
const PART_OF_PAGES: f64 = 0.75;

/// A page of the last view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnPage {
    /// Which of [`PagesDraw::pages`].
    pub page: u32,
    /// How far the nearest of it may be, metres.
    pub distance_m: f64,
    /// How far its prism reaches down below its own ground, metres: to that of any neighbour.
    pub skirt_m: f64,
}

/// What is drawn in place of patches.
#[derive(Clone, Copy, Debug)]
pub struct PagesDraw<'a> {
    /// All that are kept, at most as many as ever; one stays in its place until another takes it.
    pub pages: &'a [Page],
    /// Those of the last view, near ones first.
    pub drawn: &'a [DrawnPage],
    /// Most pages that there will be.
    pub max_pages: u32,
    /// Angle of a pixel in the middle of the picture, radians.
    pub pixel_rad: f64,
    /// See [`ContourRay::cone`].
    pub cone: f64,
}

/// How much wider columns are for an eye at this place, metres; see [`ContourRay::slack`].
fn slack_m(page: &Page, eye_itrf_m: DVec3) -> f64 {
    let away_m = page.origin_itrf_m.distance(eye_itrf_m) + page.radius_m;
    away_m * 2f64.powi(-20)
}

struct PageSlot {
    used: u64,
    is_cut: bool,
    /// Heights have changed since it was built.
    is_stale: bool,
    cell: Cell,
}

/// Contours as ground that rays are cast at.
pub struct ContourPages {
    options: PageOptions,
    now: u64,
    clock: u64,
    pages: Vec<Page>,
    slots: Vec<PageSlot>,
    by_key: KeyMap,
    queue: Vec<Cell>,
    /// Cells to build, and by how many pixels what is drawn in their place is wrong.
    requests: Vec<(f64, Cell)>,
    drawn: Vec<DrawnPage>,
    /// The eye of the last view.
    eye_itrf_m: DVec3,
    pixel_rad: f64,
    cone: f64,
}

impl ContourPages {
    /// An empty surface.
    pub fn new(options: PageOptions) -> Self {
        let options = options.within_limits();
        let most = options.max_pages as usize;
        Self {
            options,
            now: 0,
            clock: 0,
            pages: Vec::with_capacity(most),
            slots: Vec::with_capacity(most),
            by_key: KeyMap::new(13),
            queue: Vec::with_capacity(4 * most),
            requests: Vec::with_capacity(4 * most),
            drawn: Vec::with_capacity(most),
            eye_itrf_m: DVec3::ZERO,
            pixel_rad: 0.0,
            cone: 0.0,
        }
    }

    fn find(&self, cell: Cell) -> Option<usize> {
        self.by_key.get(cell.key()).map(|slot| slot as usize)
    }

    /// Builds a page, in place of the one longest out of use if there is no more room; false if all are in use.
    fn build(&mut self, cell: Cell, ground: &dyn Elevation, reach: HeightRange) -> bool {
        let slot = if self.slots.len() < self.options.max_pages as usize {
            self.pages.push(Page::default());
            self.slots.push(PageSlot {
                used: 0,
                is_cut: false,
                is_stale: false,
                cell,
            });
            self.slots.len() - 1
        } else {
            let oldest = (0..self.slots.len()).min_by_key(|k| self.slots[*k].used);
            match oldest.filter(|k| self.slots[*k].used < self.now) {
                Some(oldest) => oldest,
                None => return false,
            }
        };
        self.slots[slot] = PageSlot {
            used: self.now,
            is_cut: false,
            is_stale: false,
            cell,
        };
        self.fill(slot, ground, reach);
        true
    }

    /// Makes the page of a slot from the heights of now.
    fn fill(&mut self, slot: usize, ground: &dyn Elevation, reach: HeightRange) {
        self.clock += 1;
        let cell = self.slots[slot].cell;
        self.slots[slot].is_stale = false;
        let page = &mut self.pages[slot];
        page.build(cell, ground, &self.options.ellipsoid, reach);
        page.revision = self.clock;
    }

    /// Builds pages of the last view again whose heights have changed: first those that were drawn, and half as many at most as a
    /// frame may build, so that others are not kept waiting. Answers how many.
    fn build_stale(&mut self, ground: &dyn Elevation, reach: HeightRange) -> u64 {
        let mut stale: Vec<(bool, u64, usize)> = (0..)
            .zip(&self.slots)
            .filter(|(_, slot)| slot.is_stale && slot.used + 1 >= self.now)
            .map(|(k, slot)| (slot.is_cut, slot.cell.key(), k))
            .collect();
        // Allocates where heights have changed only.
        stale.sort_unstable();
        stale.truncate(self.options.built_per_frame.div_ceil(2) as usize);
        for (.., k) in &stale {
            self.fill(*k, ground, reach);
        }
        stale.len() as u64
    }

    /// Finds pages by their cells again.
    fn index(&mut self) {
        self.by_key.clear();
        for (k, slot) in (0u32..).zip(&self.slots) {
            // There is room: it is for four times as many.
            let _ = self.by_key.set(slot.cell.key(), k);
        }
    }

    /// Whether all quarters that can be seen are there; asks for those that are not.
    fn has_children(
        &mut self,
        cell: Cell,
        k: usize,
        pixels: f64,
        culling: &CullingContext,
    ) -> bool {
        let (low_m, high_m) = (self.pages[k].low_m, self.pages[k].high_m);
        let more_m = self.pages[k].error_m + 1.0;
        let mut is_complete = true;
        for quarter in cell.children() {
            if let Some(slot) = self.find(quarter) {
                // Waits for the others, or is drawn.
                self.slots[slot].used = self.now;
                continue;
            }
            let range = HeightRange {
                low_m: low_m - more_m,
                high_m: high_m + more_m,
            };
            let bound = bound_of(&self.options.ellipsoid, quarter, range);
            if visible_distance_m(culling, &bound).is_some() {
                is_complete = false;
                self.requests.push((pixels, quarter));
            }
        }
        is_complete
    }

    /// Selects the pages of a view.
    fn select_lod(&mut self, culling: &CullingContext, tolerance_px: f64) {
        while let Some(cell) = self.queue.pop() {
            let Some(k) = self.find(cell) else {
                continue;
            };
            self.slots[k].used = self.now;
            let page = &self.pages[k];
            let bound = GroundBound {
                center_itrf_m: page.center_m,
                radius_m: page.radius_m,
                high_m: page.high_m + page.error_m,
            };
            let Some(distance_m) = visible_distance_m(culling, &bound) else {
                continue;
            };
            let pixels = page.error_m / (distance_m * culling.pixel_rad);
            let most_px = match self.slots[k].is_cut {
                true => HYSTERESIS * tolerance_px,
                false => tolerance_px,
            };
            let is_coarse = pixels > most_px && !page.is_last && cell.level < MAX_LEVEL;
            self.slots[k].is_cut = is_coarse && self.has_children(cell, k, pixels, culling);
            if self.slots[k].is_cut {
                self.queue.extend(cell.children());
            } else if !self.pages[k].nodes.is_empty() {
                self.drawn.push(DrawnPage {
                    page: k as u32,
                    distance_m,
                    skirt_m: 0.0,
                });
            }
        }
    }

    /// Where the ray of an eye first meets the ground of the last view, metres along it: the shader's answer, in f32 about
    /// each page's origin.
    pub fn cast(&self, eye_itrf_m: DVec3, towards: DVec3) -> Option<f64> {
        let mut most = f32::MAX;
        for drawn in &self.drawn {
            let page = &self.pages[drawn.page as usize];
            let ray = ContourRay {
                from: -(page.origin_itrf_m - eye_itrf_m).as_vec3(),
                towards: towards.as_vec3(),
                most,
                cone: self.cone as f32,
                slack: slack_m(page, eye_itrf_m) as f32,
                step: drawn.skirt_m as f32,
            };
            if !enters(page, drawn, &ray) {
                continue;
            }
            if let Some((t, _)) = contour_cast(&page.nodes, 0, &ray) {
                most = t;
            }
        }
        (most < f32::MAX).then_some(f64::from(most))
    }
}

/// Distance to the nearest of a bound, at least 1 m; none if it is certainly not seen.
fn visible_distance_m(culling: &CullingContext, bound: &GroundBound) -> Option<f64> {
    let is_visible = culling.visibility(bound).is_visible();
    is_visible.then(|| culling.distance_m(bound).max(1.0))
}

/// The ground of a cell between two heights.
fn bound_of(ellipsoid: &Ellipsoid, cell: Cell, range: HeightRange) -> GroundBound {
    let (center_itrf_m, radius_m) = ball(ellipsoid, cell, range.low_m, range.high_m);
    GroundBound {
        center_itrf_m,
        radius_m,
        high_m: range.high_m,
    }
}

/// Whether a ray goes through a page's prism, as a picture shows it.
fn enters(page: &Page, drawn: &DrawnPage, ray: &ContourRay) -> bool {
    let up = page.axes[2];
    let (from, towards) = (ray.from.as_dvec3(), ray.towards.as_dvec3());
    let [low, high] = [0, 4].map(|k| up.dot(page.corners_m[k]));
    let mut stretch = (0.0f64, f64::MAX);
    let root = page.nodes[0].walls.map(|wall| wall.as_dvec4());
    let slab = [up.extend(low - drawn.skirt_m), (-up).extend(-high)];
    for wall in root.into_iter().chain(slab) {
        let lacks = wall.w - wall.truncate().dot(from) - f64::from(ray.slack);
        let gains = wall.truncate().dot(towards);
        if gains > 0.0 {
            stretch.0 = stretch.0.max(lacks / gains);
        } else if gains < 0.0 {
            stretch.1 = stretch.1.min(lacks / gains);
        } else if lacks > 0.0 {
            return false;
        }
    }
    stretch.0 <= stretch.1
}

impl ContourPages {
    /// The pages of the last view.
    pub fn draw(&self) -> PagesDraw<'_> {
        PagesDraw {
            pages: &self.pages,
            drawn: &self.drawn,
            max_pages: self.options.max_pages,
            pixel_rad: self.pixel_rad,
            cone: self.cone,
        }
    }
}

impl Surface for ContourPages {
    fn name(&self) -> &'static str {
        "contours"
    }

    fn prepare(&mut self, view: &GroundView, ground: &dyn Elevation) -> SurfaceStats {
        self.now += 1;
        self.drawn.clear();
        self.requests.clear();
        self.queue.clear();
        let reach = ground.range_m(&Bounds::GLOBE);
        let pixel_rad = view.pixel_rad.max(1e-9);
        let drawn = HeightRange {
            low_m: reach.low_m - chord_m(&self.options.ellipsoid, FRAC_PI_8 / f64::from(CELLS)),
            ..reach
        };
        let view = GroundView { pixel_rad, ..*view };
        // Rays are cast at prisms, which depth does not clip.
        let culling = CullingContext::new(&view, &self.options.ellipsoid, drawn).without_depth();
        let mut built = 0;
        for root in Cell::roots() {
            let bound = bound_of(&self.options.ellipsoid, root, reach);
            if visible_distance_m(&culling, &bound).is_none() {
                continue;
            }
            if self.find(root).is_none() && self.build(root, ground, reach) {
                built += 1;
            }
            self.queue.push(root);
        }
        if built > 0 {
            self.index();
        }
        let renewed = self.build_stale(ground, reach);
        built += renewed;
        let tolerance_px = view.tolerance_px.max(0.0);
        self.select_lod(&culling, PART_OF_PAGES * tolerance_px);
        self.requests
            .sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.key().cmp(&b.1.key())));
        // One that is asked for is always built, that all be there at last.
        let most = u64::from(self.options.built_per_frame).saturating_sub(renewed);
        for k in 0..self.requests.len().min(most.max(1) as usize) {
            if !self.build(self.requests[k].1, ground, reach) {
                break;
            }
            built += 1;
        }
        if built > 0 {
            self.index();
        }
        self.drawn.sort_unstable_by(|a, b| {
            a.distance_m
                .total_cmp(&b.distance_m)
                .then(a.page.cmp(&b.page))
        });
        let mut stats = SurfaceStats {
            patches: self.drawn.len() as u32,
            vertices: 8 * self.drawn.len() as u32,
            triangles: 12 * self.drawn.len() as u32,
            samples_read: built * Page::READS,
            ..SurfaceStats::default()
        };
        let of_nodes_px = (1.0 - PART_OF_PAGES) * tolerance_px;
        let (mut error_m, mut error_px, mut border_px) = (0.0f64, 0.0f64, 0.0f64);
        for drawn in &self.drawn {
            let page = &self.pages[drawn.page as usize];
            let px_per_m = 1.0 / (drawn.distance_m * pixel_rad);
            error_m = error_m.max(page.error_m);
            error_px = error_px.max(page.error_m * px_per_m + of_nodes_px);
            border_px = border_px.max(page.border_m * px_per_m + of_nodes_px);
        }
        for drawn in &mut self.drawn {
            // A neighbour is no farther than this, so on the border its ground is wrong by no more than the worst shows
            // there: of the two one lies lower by no more than both are wrong. And a half more, as borders are probed.
            let page = &self.pages[drawn.page as usize];
            let away_m = drawn.distance_m + 2.0 * page.radius_m;
            drawn.skirt_m = 1.5 * (page.border_m + border_px * pixel_rad * away_m) + 1.0;
        }
        (stats.error_m, stats.error_px) = (Some(error_m), Some(error_px));
        self.eye_itrf_m = view.eye_itrf_m;
        self.pixel_rad = pixel_rad;
        self.cone = 2.0 * of_nodes_px * pixel_rad;
        let nodes: usize = self.pages.iter().map(|page| page.nodes.capacity()).sum();
        stats.resident_bytes = (nodes * size_of::<super::ContourNode>()
            + self.pages.len() * (size_of::<Page>() + size_of::<PageSlot>()))
            as u64
            + self.by_key.bytes();
        stats
    }

    fn heights_changed(&mut self, changes: &[HeightChange], _: &dyn Elevation) {
        for (slot, page) in self.slots.iter_mut().zip(&mut self.pages) {
            // Posts are read one beyond the cell's edges, and slopes between them.
            let (bounds, beyond_rad) =
                (slot.cell.bounds(), slot.cell.side_rad() / f64::from(CELLS));
            let touches = |change: &&HeightChange| change.touches(&bounds, beyond_rad, 0.0);
            for change in changes.iter().filter(touches) {
                slot.is_stale = true;
                page.widen(change.range);
            }
        }
    }

    fn forget_views(&mut self) {
        for slot in &mut self.slots {
            slot.is_cut = false;
        }
    }

    fn for_each_patch(&self, _: &mut dyn FnMut(&Patch)) {}

    fn for_each_contour_page(&self, draw: &mut dyn FnMut(&ContourPage<'_>)) {
        for drawn in &self.drawn {
            let page = &self.pages[drawn.page as usize];
            draw(&ContourPage {
                slot: drawn.page,
                revision: page.revision,
                block: page.block(),
                origin_itrf_m: page.origin_itrf_m,
                nodes: bytemuck::cast_slice(&page.nodes),
                corners_m: page.corners_m,
                axes: page.axes,
                skirt_m: drawn.skirt_m,
                slack_m: slack_m(page, self.eye_itrf_m),
            });
        }
    }

    fn draw_kind(&self) -> DrawKind<'_> {
        DrawKind::ContourPages(ContourPageSet {
            max_pages: self.options.max_pages,
            pixel_rad: self.pixel_rad,
            cone: self.cone,
        })
    }
}

/// Posts of a page do not lie between those of the lattice.
const _: () = assert!(CELLS.is_power_of_two() && CELLS <= 16);
