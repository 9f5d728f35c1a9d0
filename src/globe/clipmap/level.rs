//! One level: its samples about a middle, how they follow the eye, and how they give way to the coarser level's surface.

use super::lattice::{Icosahedron, Spot};
use super::reach::Reach;
use super::sheet::{Sheet, Slots};
use super::{Trim, triangles};
use crate::elevation::Elevation;
use crate::frames::Ellipsoid;
use crate::globe::surface::{GroundVertex, TriangleList};
use glam::DVec3;
use std::sync::Arc;

/// Angle of an edge of the icosahedron at the Earth's centre, radians: 2·atan of the inverse of the golden ratio.
pub const EDGE_RAD: f64 = 1.107_148_717_794_090_4;

/// Where samples come from.
pub struct Source<'a> {
    pub ellipsoid: &'a Ellipsoid,
    pub icosahedron: &'a Icosahedron,
    pub ground: &'a dyn Elevation,
}

impl Source<'_> {
    /// The point of the ground at a lattice point, ITRF metres, with height and slope, averaged over half a cell to each
    /// side.
    ///
    /// The direction on the icosahedron's sphere is the ellipsoid's outward normal: latitudes are geodetic.
    fn sample(&self, spot: Spot, n: i64) -> (DVec3, GroundVertex) {
        let normal = self.icosahedron.direction(spot, n);
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
    /// 0 for the globe in ten sheets, 1 for the coarsest that follows the eye.
    pub number: u32,
    /// Cells of a diamond's edge.
    pub n: i64,
    /// Cells from the middle to the border.
    pub radius: i64,
    trim: Trim,
    /// What is drawn: complete, and drawn as far as the sheets' vertices say.
    pub reach: Option<Reach>,
    /// What is being filled while nothing is drawn.
    pending: Option<Reach>,
    pub sheets: Vec<Sheet>,
    /// Where all sheets measure from, and the middle that this was chosen for.
    origin: Option<(DVec3, Spot)>,
    /// How far the whole level is drawn as the coarser one: 0 not at all, 1 altogether.
    pub fade: f64,
    /// What the indices were made for: middles of this level and of the finer one.
    shape: Option<(Spot, Option<Spot>)>,
}

impl Level {
    pub fn new(number: u32, radius: i64, trim: Trim) -> Self {
        Self {
            number,
            n: radius << number,
            radius,
            trim,
            reach: None,
            pending: None,
            sheets: Vec::new(),
            origin: None,
            fade: 0.0,
            shape: None,
        }
    }

    /// The grid that positions lie on, metres: every position of this level is a multiple, as is every one of a coarser
    /// level, and its offset from the origin is exact in single precision. Not below 2 mm, so that the highest mountain is
    /// within [`Self::most_m`] of the ellipsoid.
    pub fn quantum_m(number: u32) -> f64 {
        0.5_f64.powi((number as i32 - 1).min(9))
    }

    /// Offsets beyond this are not exact in single precision, metres.
    pub fn most_m(number: u32) -> f64 {
        Self::quantum_m(number) * f64::from(1 << 24)
    }

    /// Greatest width over which the level gives way to the coarser one, cells.
    pub fn blend(&self) -> i64 {
        self.radius / 4
    }

    /// A reach of this level's size about an even point.
    pub fn reach_about(&self, middle: Spot) -> Reach {
        Reach::new(middle, self.n, self.radius, self.trim)
    }

    fn sheet(&self, diamond: u8) -> Option<&Sheet> {
        self.sheets.iter().find(|sheet| sheet.diamond == diamond)
    }

    /// Slots of a row of a sheet.
    fn side(&self) -> u32 {
        2 * self.radius as u32 + 1
    }

    /// How many samples a reach needs that are not held.
    pub fn missing(&self, reach: &Reach) -> u64 {
        let mut missing = 0;
        for (diamond, span) in reach.boxes() {
            let sheet = self.sheet(diamond);
            let part = reach.in_diamond(diamond).expect("it has a box there");
            let slots = Slots::new(span.least, self.side());
            for i in span.least.0..=span.most.0 {
                for j in span.least.1..=span.most.1 {
                    let held = sheet.is_some_and(|sheet| sheet.has(slots.of(i, j), i, j));
                    if !held && part.distance(i, j) <= reach.radius {
                        missing += 1;
                    }
                }
            }
        }
        missing
    }

    /// Reads what a reach needs and is not held, as far as the budget goes; true if nothing is missing any more. What the
    /// reach does not need may be lost.
    pub fn fill(
        &mut self,
        reach: &Reach,
        source: &Source<'_>,
        budget: &mut u64,
        clock: &mut u64,
    ) -> bool {
        self.settle(reach, source, clock);
        let quantum_m = Self::quantum_m(self.number);
        for (diamond, span) in reach.boxes() {
            let part = reach.in_diamond(diamond).expect("it has a box there");
            let sheet = self.sheets.iter_mut().find(|s| s.diamond == diamond);
            let sheet = sheet.expect("settled");
            let slots = Slots::new(span.least, sheet.side());
            for i in span.least.0..=span.most.0 {
                for j in span.least.1..=span.most.1 {
                    if sheet.has(slots.of(i, j), i, j) || part.distance(i, j) > reach.radius {
                        continue;
                    }
                    if *budget == 0 {
                        return false;
                    }
                    *budget -= 1;
                    let spot = Spot { diamond, i, j };
                    let (point_m, mut vertex) = source.sample(spot, self.n);
                    let point_m = (point_m / quantum_m).round() * quantum_m;
                    vertex.from_origin_m = (point_m - sheet.patch.origin_itrf_m).as_vec3();
                    sheet.put(spot, vertex);
                }
            }
        }
        true
    }

    /// Sees to it that each diamond within reach has a sheet, and that the origin is near.
    fn settle(&mut self, reach: &Reach, source: &Source<'_>, clock: &mut u64) {
        let near = |spot: &Spot| {
            let steps = reach.distance(*spot);
            steps.is_some_and(|steps| steps <= self.radius / 2)
        };
        let origin_m = match self.origin {
            Some((origin_m, middle)) if near(&middle) => origin_m,
            _ => {
                let normal = source.icosahedron.direction(reach.middle, self.n);
                // A multiple of every level's quantum.
                let origin_m = (source.ellipsoid.surface_point(normal) / 2.0).round() * 2.0;
                for sheet in &mut self.sheets {
                    sheet.rebase(origin_m, Self::most_m(self.number));
                }
                self.origin = Some((origin_m, reach.middle));
                origin_m
            }
        };
        let side = self.side();
        for (diamond, _) in reach.boxes() {
            if self.sheet(diamond).is_some() {
                continue;
            }
            let key = u64::from(self.number) * 16 + u64::from(diamond);
            let unused = |sheet: &&mut Sheet| reach.boxes().all(|(d, _)| d != sheet.diamond);
            if let Some(sheet) = self.sheets.iter_mut().find(unused) {
                *clock += 1 << 32;
                sheet.retake(diamond, key, *clock);
            } else {
                let mut sheet = Sheet::new(side, diamond, key, origin_m);
                *clock += 1 << 32;
                sheet.retake(diamond, key, *clock);
                self.sheets.push(sheet);
            }
        }
    }

    /// Fills towards a reach that is not drawn yet; true once it can be.
    pub fn await_reach(
        &mut self,
        reach: Reach,
        source: &Source<'_>,
        budget: &mut u64,
        clock: &mut u64,
    ) -> bool {
        self.reach = None;
        let full = self.fill(&reach, source, budget, clock);
        if full {
            self.pending = None;
            self.reach = Some(reach);
        } else {
            self.pending = Some(reach);
        }
        full
    }

    /// What is being filled.
    pub fn pending(&self) -> Option<&Reach> {
        self.pending.as_ref()
    }

    /// Keeps a reach that is complete for when it may be drawn.
    pub fn hold(&mut self) {
        self.pending = self.reach.take();
    }

    /// Draws nothing from now on; samples stay.
    pub fn suspend(&mut self) {
        self.reach = None;
        self.pending = None;
        self.fade = 0.0;
    }

    /// Sets all vertices within reach as they are to be drawn: as they are, or as far as [`Self::weight`] says as points of
    /// the coarser level's surface.
    pub fn blend_into(&mut self, coarser: Option<&Level>) {
        let Some(reach) = self.reach.take() else {
            return;
        };
        let quantum_m = Self::quantum_m(self.number);
        let (blend, fade) = (self.blend(), self.fade);
        for (diamond, span) in reach.boxes() {
            let part = reach.in_diamond(diamond).expect("it has a box there");
            let sheet = self.sheets.iter_mut().find(|s| s.diamond == diamond);
            let sheet = sheet.expect("filled");
            let below = coarser.and_then(|coarser| coarser.sheet(diamond));
            let slots = Slots::new(span.least, sheet.side());
            for i in span.least.0..=span.most.0 {
                for j in span.least.1..=span.most.1 {
                    let steps = part.distance(i, j);
                    if steps > reach.radius {
                        continue;
                    }
                    let slot = slots.of(i, j);
                    debug_assert!(sheet.has(slot, i, j));
                    let own = *sheet.own_in(slot);
                    let weight = Self::weight(steps, reach.radius, blend).max(fade);
                    let drawn = match below {
                        Some(below) if weight > 0.0 => {
                            let origin_m = sheet.patch.origin_itrf_m;
                            mixed(&own, origin_m, below, (i, j), weight, quantum_m)
                        }
                        _ => own,
                    };
                    sheet.draw(slot, drawn);
                }
            }
        }
        self.reach = Some(reach);
    }

    /// How far a vertex so many steps from the middle is drawn as the coarser level: 0 up to `radius − blend` steps, 1 at
    /// the border.
    fn weight(steps: i64, radius: i64, blend: i64) -> f64 {
        ((steps - (radius - blend)) as f64 / blend as f64).clamp(0.0, 1.0)
    }

    /// Makes the triangles anew if the reach of this level or of the finer one has changed.
    pub fn cut(&mut self, finer: Option<&Level>) {
        let hole = finer
            .and_then(|finer| finer.reach.as_ref())
            .map(Reach::halved);
        let middle = self.reach.as_ref().map(|reach| reach.middle);
        let Some(middle) = middle.or((self.number == 0).then_some(Spot {
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
        let reach = self.reach.as_ref().map(Reach::halved);
        for sheet in &mut self.sheets {
            let mut triangles = Vec::with_capacity(sheet.patch.indices.triangles.len() * 9 / 8);
            let diamond = sheet.diamond;
            let span = self.reach.as_ref().and_then(|reach| reach.box_in(diamond));
            let least = span.map_or((0, 0), |span| span.least);
            let slots = Slots::new(least, sheet.side());
            let slot = |i, j| slots.of(i, j) as u32;
            match &reach {
                Some(reach) => triangles::ring(reach, diamond, hole.as_ref(), slot, &mut triangles),
                None => triangles::full(self.n, diamond, hole.as_ref(), slot, &mut triangles),
            }
            if triangles != sheet.patch.indices.triangles {
                sheet.patch.indices = Arc::new(TriangleList { triangles });
                sheet.is_dirty = true;
            }
        }
    }

    /// Fills all ten diamonds, for the level that never moves.
    pub fn fill_globe(&mut self, source: &Source<'_>, clock: &mut u64) -> u64 {
        let quantum_m = Self::quantum_m(self.number);
        let mut read = 0;
        for diamond in 0..super::lattice::DIAMONDS {
            let half = self.n / 2;
            let middle = Spot {
                diamond,
                i: half,
                j: half,
            };
            let normal = source.icosahedron.direction(middle, self.n);
            let origin_m = (source.ellipsoid.surface_point(normal) / 2.0).round() * 2.0;
            let mut sheet = Sheet::new(self.n as u32 + 1, diamond, u64::from(diamond), origin_m);
            *clock += 1 << 32;
            sheet.retake(diamond, u64::from(diamond), *clock);
            for i in 0..=self.n {
                for j in 0..=self.n {
                    let spot = Spot { diamond, i, j };
                    let (point_m, mut vertex) = source.sample(spot, self.n);
                    let point_m = (point_m / quantum_m).round() * quantum_m;
                    vertex.from_origin_m = (point_m - origin_m).as_vec3();
                    sheet.put(spot, vertex);
                    sheet.draw(sheet.slot(i, j), vertex);
                    read += 1;
                }
            }
            self.sheets.push(sheet);
        }
        read
    }

    pub fn bytes(&self) -> usize {
        self.sheets
            .iter()
            .map(|sheet| {
                sheet.bytes() + sheet.patch.indices.triangles.capacity() * size_of::<u32>()
            })
            .sum()
    }
}

/// A vertex between its own place and that of the coarser surface: the coarser level's vertex, or the middle of one of its
/// edges. At weight 1 the sum of origin and offset is that of the coarser one to the last bit.
fn mixed(
    own: &GroundVertex,
    origin_m: DVec3,
    below: &Sheet,
    (i, j): (i64, i64),
    weight: f64,
    quantum_m: f64,
) -> GroundVertex {
    // The coarser edge that the point lies on; for a cell's diagonal, from B's side to C's.
    let (i0, i1, j0, j1) = (i / 2, (i + 1) / 2, j / 2, (j + 1) / 2);
    let (x, y) = (below.own(i1, j0), below.own(i0, j1));
    let middle_m = 0.5 * (x.from_origin_m.as_dvec3() + y.from_origin_m.as_dvec3());
    // Both origins are multiples of 2 m: nothing is rounded in this.
    let target_m = middle_m + (below.patch.origin_itrf_m - origin_m);
    let own_m = own.from_origin_m.as_dvec3();
    // On to the grid by a step that does not depend on the origin.
    let step_m = ((target_m - own_m) * (weight / quantum_m) + 0.5).floor() * quantum_m;
    let w = weight as f32;
    GroundVertex {
        from_origin_m: (own_m + step_m).as_vec3(),
        height_m: own.height_m + (0.5 * (x.height_m + y.height_m) - own.height_m) * w,
        slope: own.slope + (0.5 * (x.slope + y.slope) - own.slope) * w,
    }
}
