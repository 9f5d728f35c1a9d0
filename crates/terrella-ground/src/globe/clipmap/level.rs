//! One level: its samples about a middle, how they follow the eye, and how they blend into the coarser level's surface.

use super::lattice::{Icosahedron, LatticeIndex};
use super::level_extent::LevelExtent;
use super::toroidal::{Slots, ToroidalBuffer};
use super::{Trim, triangles};
use crate::elevation::Elevation;
use crate::globe::surface::{GroundVertex, TriangleList};
use glam::DVec3;
use std::sync::Arc;
use terrella_frames::Ellipsoid;

/// Angle of an edge of the icosahedron at the Earth's centre, radians: 2·atan of the inverse of the golden ratio.
pub const EDGE_RAD: f64 = 1.107_148_717_794_090_4;

/// Source of samples.
pub struct HeightSource<'a> {
    pub ellipsoid: &'a Ellipsoid,
    pub icosahedron: &'a Icosahedron,
    pub ground: &'a dyn Elevation,
}

impl HeightSource<'_> {
    /// The ground at a lattice point, ITRF metres, with height and slope, averaged over half a cell to each side.
    ///
    /// The direction on the icosahedron's sphere is the ellipsoid's outward normal: latitudes are geodetic.
    pub fn sample(&self, index: LatticeIndex, n: i64) -> (DVec3, GroundVertex) {
        let normal = self.icosahedron.direction(index, n);
        let lat_rad = normal.z.atan2(normal.x.hypot(normal.y));
        let lon_rad = normal.y.atan2(normal.x);
        let half_cell_rad = 0.5 * EDGE_RAD / n as f64;
        let height_m = self.ground.height_m(lat_rad, lon_rad, half_cell_rad);
        let slope = self
            .ground
            .slope(self.ellipsoid, lat_rad, lon_rad, half_cell_rad);
        let vertex = GroundVertex {
            from_origin_m: glam::Vec3::ZERO,
            height_m: height_m as f32,
            slope: slope.as_vec2(),
        };
        (
            self.ellipsoid.surface_point(normal) + normal * height_m,
            vertex,
        )
    }
}

/// A level of the clipmap.
pub struct Level {
    /// 0 for the globe in ten buffers, 1 for the coarsest that follows the eye.
    pub number: u32,
    /// Cells along a diamond's edge.
    pub n: i64,
    /// Cells from the middle to the border.
    pub radius: i64,
    trim: Trim,
    /// The drawn extent: complete, and drawn as the buffers' vertices say.
    pub extent: Option<LevelExtent>,
    /// The extent that is being filled while nothing is drawn.
    pending: Option<LevelExtent>,
    pub buffers: Vec<ToroidalBuffer>,
    /// Origin of all buffers, and the middle for which it was chosen.
    origin: Option<(DVec3, LatticeIndex)>,
    /// Drawn samples have been read again, and vertices are not yet updated from them.
    pub is_read_anew: bool,
    /// Blend of the whole level with the coarser one: 0 the level itself, 1 the coarser surface.
    pub fade: f64,
    /// Middles of this level and of the finer one for which the indices were made.
    shape: Option<(LatticeIndex, Option<LatticeIndex>)>,
}

impl Level {
    pub fn new(number: u32, radius: i64, trim: Trim) -> Self {
        Self {
            number,
            n: radius << number,
            radius,
            trim,
            extent: None,
            pending: None,
            buffers: Vec::new(),
            origin: None,
            is_read_anew: false,
            fade: 0.0,
            shape: None,
        }
    }

    /// The grid of positions, metres. Every position of this level and of every coarser level is a multiple of it, and its offset is
    /// exact in single precision. It is at least 2 mm, so that the highest mountain is within [`Self::most_m`] of the ellipsoid.
    pub fn quantum_m(number: u32) -> f64 {
        0.5_f64.powi((number as i32 - 1).min(9))
    }

    /// Offsets beyond this are not exact in single precision, metres.
    pub fn most_m(number: u32) -> f64 {
        Self::quantum_m(number) * f64::from(1 << 24)
    }

    /// Largest width over which the level blends into the coarser one, cells.
    pub fn blend(&self) -> i64 {
        self.radius / 4
    }

    /// An extent of this level's size about an even point.
    pub fn extent_about(&self, middle: LatticeIndex) -> LevelExtent {
        LevelExtent::new(middle, self.n, self.radius, self.trim)
    }

    fn buffer(&self, diamond: u8) -> Option<&ToroidalBuffer> {
        self.buffers.iter().find(|buffer| buffer.diamond == diamond)
    }

    /// Slots of a row of a buffer.
    fn side(&self) -> u32 {
        2 * self.radius as u32 + 1
    }

    /// Number of samples that an extent needs and the buffers do not hold.
    pub fn missing(&self, extent: &LevelExtent) -> u64 {
        let mut missing = 0;
        for (diamond, span) in extent.boxes() {
            let buffer = self.buffer(diamond);
            let part = extent.in_diamond(diamond).expect("it has a box there");
            let slots = Slots::new(span.least, self.side());
            for i in span.least.0..=span.most.0 {
                for j in span.least.1..=span.most.1 {
                    let held = buffer.is_some_and(|buffer| buffer.has(slots.of(i, j), i, j));
                    if !held && part.distance(i, j) <= extent.radius {
                        missing += 1;
                    }
                }
            }
        }
        missing
    }

    /// Reads the missing samples of an extent within the budget; returns true if none is missing any more. Samples outside the extent may
    /// be lost.
    pub fn fill(
        &mut self,
        extent: &LevelExtent,
        source: &HeightSource<'_>,
        budget: &mut u64,
        clock: &mut u64,
    ) -> bool {
        self.settle(extent, source, clock);
        let quantum_m = Self::quantum_m(self.number);
        for (diamond, span) in extent.boxes() {
            let part = extent.in_diamond(diamond).expect("it has a box there");
            let buffer = self.buffers.iter_mut().find(|s| s.diamond == diamond);
            let buffer = buffer.expect("settled");
            let slots = Slots::new(span.least, buffer.side());
            for i in span.least.0..=span.most.0 {
                for j in span.least.1..=span.most.1 {
                    if buffer.has(slots.of(i, j), i, j) || part.distance(i, j) > extent.radius {
                        continue;
                    }
                    if *budget == 0 {
                        return false;
                    }
                    *budget -= 1;
                    let index = LatticeIndex { diamond, i, j };
                    let (point_m, mut vertex) = source.sample(index, self.n);
                    let point_m = (point_m / quantum_m).round() * quantum_m;
                    vertex.from_origin_m = (point_m - buffer.patch.origin_itrf_m).as_vec3();
                    buffer.put(index, vertex);
                }
            }
        }
        true
    }

    /// Ensures that each diamond within the extent has a buffer, and that the origin is near.
    fn settle(&mut self, extent: &LevelExtent, source: &HeightSource<'_>, clock: &mut u64) {
        let near = |index: &LatticeIndex| {
            let steps = extent.distance(*index);
            steps.is_some_and(|steps| steps <= self.radius / 2)
        };
        let origin_m = match self.origin {
            Some((origin_m, middle)) if near(&middle) => origin_m,
            _ => {
                let normal = source.icosahedron.direction(extent.middle, self.n);
                // Round to a multiple of every level's quantum.
                let origin_m = (source.ellipsoid.surface_point(normal) / 2.0).round() * 2.0;
                for buffer in &mut self.buffers {
                    buffer.rebase(origin_m, Self::most_m(self.number));
                }
                self.origin = Some((origin_m, extent.middle));
                origin_m
            }
        };
        let side = self.side();
        for (diamond, _) in extent.boxes() {
            if self.buffer(diamond).is_some() {
                continue;
            }
            let key = u64::from(self.number) * 16 + u64::from(diamond);
            let unused =
                |buffer: &&mut ToroidalBuffer| extent.boxes().all(|(d, _)| d != buffer.diamond);
            if let Some(buffer) = self.buffers.iter_mut().find(unused) {
                *clock += 1 << 32;
                buffer.retake(diamond, key, *clock);
            } else {
                let mut buffer = ToroidalBuffer::new(side, diamond, key, origin_m);
                *clock += 1 << 32;
                buffer.retake(diamond, key, *clock);
                self.buffers.push(buffer);
            }
        }
    }

    /// Fills an extent that is not drawn yet; returns true once it can be drawn.
    pub fn await_extent(
        &mut self,
        extent: LevelExtent,
        source: &HeightSource<'_>,
        budget: &mut u64,
        clock: &mut u64,
    ) -> bool {
        self.extent = None;
        let full = self.fill(&extent, source, budget, clock);
        if full {
            self.pending = None;
            self.extent = Some(extent);
        } else {
            self.pending = Some(extent);
        }
        full
    }

    /// The extent that is being filled.
    pub fn pending(&self) -> Option<&LevelExtent> {
        self.pending.as_ref()
    }

    /// Keeps a complete extent undrawn until it may be drawn.
    pub fn hold(&mut self) {
        self.pending = self.extent.take();
    }

    /// Stops drawing; samples stay.
    pub fn suspend(&mut self) {
        self.extent = None;
        self.pending = None;
        self.fade = 0.0;
    }

    /// Stops drawing, and chooses a new origin when it is drawn next; samples stay.
    pub fn forget_view(&mut self) {
        self.suspend();
        self.origin = None;
    }

    /// Sets all drawn vertices within the extent: the level's own samples, blended by [`Self::weight`] with the coarser level's surface.
    pub fn blend_into(&mut self, coarser: Option<&Level>) {
        let Some(extent) = self.extent.take() else {
            return;
        };
        let quantum_m = Self::quantum_m(self.number);
        let (blend, fade) = (self.blend(), self.fade);
        for (diamond, span) in extent.boxes() {
            let part = extent.in_diamond(diamond).expect("it has a box there");
            let buffer = self.buffers.iter_mut().find(|s| s.diamond == diamond);
            let buffer = buffer.expect("filled");
            let below = coarser.and_then(|coarser| coarser.buffer(diamond));
            let slots = Slots::new(span.least, buffer.side());
            for i in span.least.0..=span.most.0 {
                for j in span.least.1..=span.most.1 {
                    let steps = part.distance(i, j);
                    if steps > extent.radius {
                        continue;
                    }
                    let slot = slots.of(i, j);
                    debug_assert!(buffer.has(slot, i, j));
                    let own = *buffer.own_in(slot);
                    let weight = Self::weight(steps, extent.radius, blend).max(fade);
                    let drawn = match below {
                        Some(below) if weight > 0.0 => {
                            let origin_m = buffer.patch.origin_itrf_m;
                            mixed(&own, origin_m, below, (i, j), weight, quantum_m)
                        }
                        _ => own,
                    };
                    buffer.draw(slot, drawn);
                }
            }
        }
        self.extent = Some(extent);
    }

    /// Weight of the coarser level for a vertex `steps` steps from the middle: 0 up to `radius − blend` steps, 1 at the border.
    fn weight(steps: i64, radius: i64, blend: i64) -> f64 {
        ((steps - (radius - blend)) as f64 / blend as f64).clamp(0.0, 1.0)
    }

    /// Rebuilds the triangles if the extent of this level or of the finer one has changed.
    pub fn cut(&mut self, finer: Option<&Level>) {
        let hole = finer
            .and_then(|finer| finer.extent.as_ref())
            .map(LevelExtent::halved);
        let middle = self.extent.as_ref().map(|extent| extent.middle);
        let Some(middle) = middle.or((self.number == 0).then_some(LatticeIndex {
            diamond: 0,
            i: 0,
            j: 0,
        })) else {
            self.shape = None;
            return;
        };
        let shape = Some((middle, hole.as_ref().map(|hole| hole.middle)));
        if self.shape == shape {
            return;
        }
        self.shape = shape;
        let extent = self.extent.as_ref().map(LevelExtent::halved);
        for buffer in &mut self.buffers {
            let mut triangles = Vec::with_capacity(buffer.patch.indices.triangles.len() * 9 / 8);
            let diamond = buffer.diamond;
            let span = self
                .extent
                .as_ref()
                .and_then(|extent| extent.box_in(diamond));
            let least = span.map_or((0, 0), |span| span.least);
            let slots = Slots::new(least, buffer.side());
            let slot = |i, j| slots.of(i, j) as u32;
            match &extent {
                Some(extent) => {
                    triangles::ring(extent, diamond, hole.as_ref(), slot, &mut triangles)
                }
                None => triangles::full(self.n, diamond, hole.as_ref(), slot, &mut triangles),
            }
            if triangles != buffer.patch.indices.triangles {
                buffer.patch.indices = Arc::new(TriangleList { triangles });
                buffer.is_dirty = true;
            }
        }
    }

    /// Fills all ten diamonds, for the level that never moves.
    pub fn fill_globe(&mut self, source: &HeightSource<'_>, clock: &mut u64) -> u64 {
        let quantum_m = Self::quantum_m(self.number);
        let mut read = 0;
        for diamond in 0..super::lattice::DIAMONDS {
            let half = self.n / 2;
            let middle = LatticeIndex {
                diamond,
                i: half,
                j: half,
            };
            let normal = source.icosahedron.direction(middle, self.n);
            let origin_m = (source.ellipsoid.surface_point(normal) / 2.0).round() * 2.0;
            let mut buffer =
                ToroidalBuffer::new(self.n as u32 + 1, diamond, u64::from(diamond), origin_m);
            *clock += 1 << 32;
            buffer.retake(diamond, u64::from(diamond), *clock);
            for i in 0..=self.n {
                for j in 0..=self.n {
                    let index = LatticeIndex { diamond, i, j };
                    let (point_m, mut vertex) = source.sample(index, self.n);
                    let point_m = (point_m / quantum_m).round() * quantum_m;
                    vertex.from_origin_m = (point_m - origin_m).as_vec3();
                    buffer.put(index, vertex);
                    buffer.draw(buffer.slot(i, j), vertex);
                    read += 1;
                }
            }
            self.buffers.push(buffer);
        }
        read
    }

    pub fn bytes(&self) -> usize {
        self.buffers
            .iter()
            .map(|buffer| {
                buffer.bytes() + buffer.patch.indices.triangles.capacity() * size_of::<u32>()
            })
            .sum()
    }
}

/// A vertex between its own position and that of the coarser surface: the coarser level's vertex, or the midpoint of one of its edges. At
/// weight 1 the sum of origin and offset equals the coarser one to the last bit.
fn mixed(
    own: &GroundVertex,
    origin_m: DVec3,
    below: &ToroidalBuffer,
    (i, j): (i64, i64),
    weight: f64,
    quantum_m: f64,
) -> GroundVertex {
    // The coarser edge that contains the point; for a cell's diagonal, from B's side to C's.
    let (i0, i1, j0, j1) = (i / 2, (i + 1) / 2, j / 2, (j + 1) / 2);
    let (x, y) = (below.own(i1, j0), below.own(i0, j1));
    let middle_m = 0.5 * (x.from_origin_m.as_dvec3() + y.from_origin_m.as_dvec3());
    // Both origins are multiples of 2 m, so this is exact.
    let target_m = middle_m + (below.patch.origin_itrf_m - origin_m);
    let own_m = own.from_origin_m.as_dvec3();
    // Snap to the grid by a step that does not depend on the origin.
    let step_m = ((target_m - own_m) * (weight / quantum_m) + 0.5).floor() * quantum_m;
    let w = weight as f32;
    GroundVertex {
        from_origin_m: (own_m + step_m).as_vec3(),
        height_m: own.height_m + (0.5 * (x.height_m + y.height_m) - own.height_m) * w,
        slope: own.slope + (0.5 * (x.slope + y.slope) - own.slope) * w,
    }
}
