//! The whole Earth as contours at which rays are cast: a forest over the blocks of 22.5°, chosen by the view.
//!
//! A *page* is built, uploaded and evicted as a whole (imagery has *tiles*). It is a cell of the forest: 17 × 17 posts of ground, averaged
//! at its own scale, and a [`ContourTree`] over them. The tree has its own origin, is fitted in f64 and stored in f32. A page is cut into
//! its four quarters while its visible error exceeds the tolerance. That error is half a slab of its leaves, plus what finer data would
//! add. Within a page leaves end where slabs are thinner than that, and in an image where they are thinner than the ray can resolve.
//!
//! **Watertight.** A column of ground is solid to any depth, so a ray hits either its top or its wall. Columns of neighbours overlap
//! ([`Dem::reaching`]), and are widened by the rounding of the eye's position. A prism bounds the terrain drawn for a page; it extends down
//! as far as a neighbour may be lower.
//!
//! **Per frame.** Pages are built within a budget, those of the largest errors first, and their parents are drawn until all four are there.
//! Nothing waits, and where nothing is built nothing is allocated. At most [`PageOptions::max_pages`] are kept; the least recently used one
//! is evicted.
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

/// Budgets of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PageOptions {
    /// Figure of the Earth that heights are measured from.
    pub ellipsoid: Ellipsoid,
    /// Largest number of pages that are kept, 144…2048. One takes up to 44 kB in memory and as much on the GPU.
    pub max_pages: u32,
    /// Pages that are built in a frame; 1 or more. Those of whole blocks, which every view needs, are built in addition.
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
    /// The options clamped to their limits.
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

/// Once cut, a page stays cut until its visible error is below this fraction of the tolerance.
const HYSTERESIS: f64 = 0.8;

/// Fraction of the tolerance that pages may use. The other quarter is for nodes that count as leaves in an image because half their slab is
/// smaller to the ray.
const PART_OF_PAGES: f64 = 0.75;

/// A page of the last view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnPage {
    /// Index in [`PagesDraw::pages`].
    pub page: u32,
    /// Smallest possible distance, metres.
    pub distance_m: f64,
    /// How far the prism extends below the page's own ground, metres: down to the ground of any neighbour.
    pub skirt_m: f64,
}

/// Data that is drawn in place of patches.
#[derive(Clone, Copy, Debug)]
pub struct PagesDraw<'a> {
    /// All kept pages; their number has a fixed limit. A page keeps its index until another page takes it.
    pub pages: &'a [Page],
    /// Pages of the last view, near ones first.
    pub drawn: &'a [DrawnPage],
    /// Largest number of pages.
    pub max_pages: u32,
    /// Angle of a pixel in the middle of the image, radians.
    pub pixel_rad: f64,
    /// See [`ContourRay::cone`].
    pub cone: f64,
}

/// Widening of columns for an eye at this position, metres; see [`ContourRay::slack`].
fn slack_m(page: &Page, eye_itrf_m: DVec3) -> f64 {
    let away_m = page.origin_itrf_m.distance(eye_itrf_m) + page.radius_m;
    away_m * 2f64.powi(-20)
}

struct PageSlot {
    used: u64,
    is_cut: bool,
    /// Heights have changed since the page was built.
    is_stale: bool,
    cell: Cell,
}

/// Terrain as contours at which rays are cast.
pub struct ContourPages {
    options: PageOptions,
    now: u64,
    clock: u64,
    pages: Vec<Page>,
    slots: Vec<PageSlot>,
    by_key: KeyMap,
    queue: Vec<Cell>,
    /// Cells to build, with the error in pixels of what is drawn in their place.
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

    /// Builds a page, in place of the least recently used one if there is no more room; false if all are in use.
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

    /// Fills the page of a slot from the current heights.
    fn fill(&mut self, slot: usize, ground: &dyn Elevation, reach: HeightRange) {
        self.clock += 1;
        let cell = self.slots[slot].cell;
        self.slots[slot].is_stale = false;
        let page = &mut self.pages[slot];
        page.build(cell, ground, &self.options.ellipsoid, reach);
        page.revision = self.clock;
    }

    /// Rebuilds pages of the last view whose heights have changed, drawn ones first. It builds at most half as many as a frame may build,
    /// so that other pages are not delayed. Returns the number of pages.
    fn build_stale(&mut self, ground: &dyn Elevation, reach: HeightRange) -> u64 {
        let mut stale: Vec<(bool, u64, usize)> = (0..)
            .zip(&self.slots)
            .filter(|(_, slot)| slot.is_stale && slot.used + 1 >= self.now)
            .map(|(k, slot)| (slot.is_cut, slot.cell.key(), k))
            .collect();
        // Allocates only where heights have changed.
        stale.sort_unstable();
        stale.truncate(self.options.built_per_frame.div_ceil(2) as usize);
        for (.., k) in &stale {
            self.fill(*k, ground, reach);
        }
        stale.len() as u64
    }

    /// Rebuilds the index of pages by cell.
    fn index(&mut self) {
        self.by_key.clear();
        for (k, slot) in (0u32..).zip(&self.slots) {
            // There is always room: the map is for four times as many.
            let _ = self.by_key.set(slot.cell.key(), k);
        }
    }

    /// Whether all visible quarters are there; requests the missing ones.
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
                // It waits for the others, or is drawn.
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

    /// Where a ray from an eye first hits the ground of the last view, metres along it. It is the shader's result, in f32 about each page's
    /// origin.
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

/// Distance to the nearest point of a bound, at least 1 m; `None` if the bound is certainly not visible.
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

/// Whether a ray passes through a page's prism, as in an image.
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
        // Rays are cast at prisms, which are not clipped by depth.
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
        // A requested page is always built, so that all are there in the end.
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
            // A neighbour is at most this far away, so the error of its ground on the border is at most the worst visible one there. One of
            // the two is lower by at most the sum of both errors. Half as much again is added, since borders are only probed.
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

/// Posts of a page coincide with points of the lattice.
const _: () = assert!(CELLS.is_power_of_two() && CELLS <= 16);
