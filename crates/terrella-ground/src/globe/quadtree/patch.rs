//! Patches: parts of the forest with their own origin, and how they are built.

use super::forest::{BLOCKS, Forest, Slot};
use super::node::{Among, Cut, Node, Point, Square, among, child_among, ring};
use super::page::{DEPTH, bounds, lat_lon_rad, side_rad};
use crate::elevation::{COARSEST_STEP_RAD, Elevation, HeightChange};
use crate::globe::blocks::Block;
use crate::globe::culling::NormalCone;
use crate::globe::surface::{GroundVertex, Patch, TriangleList};
use bytemuck::bytes_of;
use glam::DVec3;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::sync::Arc;
use terrella_frames::Geodetic;

/// Finest level of a patch, 15 cm: beyond it a patch only gets more leaves.
pub const MAX_PATCH_LEVEL: u8 = 24;
/// Steps of all origins, metres: a multiple of the steps of all vertices.
const ORIGIN_STEP_M: f64 = 0.25;

/// Hashes the two coordinates of a point.
#[derive(Default)]
pub struct PointHasher(u64);

impl Hasher for PointHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u64(u64::from(*byte));
        }
    }

    fn write_u64(&mut self, value: u64) {
        // Points end in many zero bits, and tables use both ends of the hash.
        let mixed = (self.0.rotate_left(29) ^ value).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = mixed ^ mixed >> 32;
    }
}

type Places = HashMap<Point, u32, BuildHasherDefault<PointHasher>>;

/// A patch and the data needed to build it again.
pub struct BuiltPatch {
    /// The node that it covers.
    pub node: Node,
    /// The patch that is passed on for drawing.
    pub patch: Patch,
    /// Vertices are at multiples of this, metres, so that they are exact in single precision.
    pub step_m: f64,
    /// Leaves at the last evaluation.
    pub leaves: u32,
    /// Whether it must be built again.
    pub is_dirty: bool,
    /// Whether it is drawn in this view.
    pub is_drawn: bool,
    /// Distance from the eye to its ball, metres.
    pub distance_m: f64,
    /// Largest ratio of a leaf that should be divided; 0 if there is none.
    pub urgency: f64,
    /// Largest error of a visible leaf, metres and pixels.
    pub error: (f64, f64),
    /// Whether it has leaves that could be merged.
    pub has_merges: bool,
    /// Cone of the normals of all its faces.
    pub normals: NormalCone,
    /// The patches that touched it at the last build.
    beside: Vec<(Node, f64)>,
    has_new_steps: bool,
    /// By vertex, whether its height has changed since it was computed. Empty if none has.
    stale: Vec<bool>,
    /// Number of stale vertices, and whether some are on the edge.
    stale_vertices: u32,
    has_stale_edge: bool,
    places: Places,
    /// By vertex, the build that last needed it.
    needed: Vec<u32>,
    free: Vec<u32>,
    build: u32,
}

/// Memory that all builds share.
#[derive(Default)]
pub struct Scratch {
    ring: Vec<Point>,
    stack: Vec<Among<Slot>>,
    /// The patches that touch the one being built, including itself, and their steps.
    pub beside: Vec<(Node, f64)>,
    triangles: Vec<u32>,
    loop_: Vec<u32>,
    changed: Vec<u32>,
    renewed: Vec<(u32, GroundVertex)>,
    /// Vertices computed since this was last set to 0.
    pub new_vertices: u64,
}

/// Step between positions of vertices within a ball: an origin near its middle has 2²³ steps or more on either side.
pub fn step_m(radius_m: f32) -> f64 {
    // The origin is rounded by up to √3/8 m; single precision represents whole numbers exactly up to 2²⁴.
    let reach = f64::from(radius_m) + 0.25;
    let exponent = reach.log2().ceil() - 24.0;
    exponent.exp2().min(ORIGIN_STEP_M)
}

/// Key of a node's patch.
fn key(node: Node) -> u64 {
    u64::from(node.level) << 58 | node.x << 29 | node.y
}

impl BuiltPatch {
    /// A patch of a node, not built yet. `revision` must be above all earlier ones of this node's patches.
    pub fn new(node: Node, slot: Slot, forest: &Forest, revision: u64) -> Self {
        let info = forest.info(slot);
        let block = node.ancestor(0);
        let origin = (info.center_itrf_m / ORIGIN_STEP_M).round() * ORIGIN_STEP_M;
        Self {
            node,
            patch: Patch {
                key: key(node),
                revision,
                origin_itrf_m: origin,
                vertices: Vec::new(),
                changed: Vec::new(),
                indices: Arc::default(),
                block: Some(Block {
                    column: block.x as u32,
                    row: block.y as u32,
                }),
            },
            step_m: step_m(info.radius_m),
            leaves: 1,
            is_dirty: true,
            is_drawn: false,
            distance_m: 0.0,
            urgency: 0.0,
            error: (0.0, 0.0),
            has_merges: false,
            normals: NormalCone::ALL,
            beside: Vec::new(),
            has_new_steps: true,
            stale: Vec::new(),
            stale_vertices: 0,
            has_stale_edge: false,
            places: Places::default(),
            needed: Vec::new(),
            free: Vec::new(),
            build: 0,
        }
    }

    /// Becomes the patch of another node, and reuses its memory.
    pub fn reset(&mut self, node: Node, slot: Slot, forest: &Forest, revision: u64) {
        let fresh = Self::new(node, slot, forest, revision);
        let old = std::mem::replace(self, fresh);
        let Self {
            patch,
            mut places,
            mut needed,
            mut free,
            ..
        } = old;
        let Patch {
            mut vertices,
            mut changed,
            ..
        } = patch;
        vertices.clear();
        changed.clear();
        places.clear();
        needed.clear();
        free.clear();
        self.patch.vertices = vertices;
        self.patch.changed = changed;
        (self.places, self.needed, self.free) = (places, needed, free);
    }

    /// Bytes of vertices, indices and tables.
    pub fn resident_bytes(&self) -> usize {
        let places = self.places.capacity() * (size_of::<(Point, u32)>() + 1);
        let vertices = self.patch.vertices.capacity() * size_of::<GroundVertex>();
        let numbers = self.needed.capacity() + self.free.capacity();
        let triangles = self.patch.indices.triangles.capacity();
        places + vertices + 4 * (numbers + triangles) + size_of::<Self>()
    }

    /// The points of its vertices, each once.
    #[cfg(test)]
    pub fn points(&self) -> impl Iterator<Item = Point> {
        self.places.keys().copied()
    }

    /// Builds vertices and triangles for the current leaves. Returns the number of leaves.
    pub fn build(
        &mut self,
        forest: &Forest,
        slot: Slot,
        ground: &dyn Elevation,
        scratch: &mut Scratch,
    ) -> u32 {
        self.build += 1;
        self.is_dirty = false;
        scratch.triangles.clear();
        scratch.changed.clear();
        scratch.stack.clear();
        scratch.stack.push(among(forest, (self.node, slot)));
        self.has_new_steps = self.beside != scratch.beside;
        if self.has_new_steps {
            self.beside.clone_from(&scratch.beside);
        }
        let mut ring_points = std::mem::take(&mut scratch.ring);
        let mut leaves = 0;
        while let Some(square) = scratch.stack.pop() {
            let (node, slot) = square.at;
            if forest.is_split(slot) {
                let children = (0..4).rev();
                let children = children.filter_map(|k| child_among(forest, &square, k));
                scratch.stack.extend(children);
                continue;
            }
            leaves += 1;
            ring(forest, &square, DEPTH, &mut ring_points);
            let center = self.place(node.square(DEPTH).center(), forest, ground, scratch);
            scratch.loop_.clear();
            for point in &ring_points {
                let place = self.place(*point, forest, ground, scratch);
                scratch.loop_.push(place);
            }
            for (i, a) in scratch.loop_.iter().enumerate() {
                let b = scratch.loop_[(i + 1) % scratch.loop_.len()];
                // The two corners at a pole are the same point.
                if *a != b {
                    scratch.triangles.extend([center, *a, b]);
                }
            }
        }
        scratch.ring = ring_points;
        self.leaves = leaves;
        self.forget_stale();
        self.give_up_unneeded();
        self.hand_over(scratch);
        leaves
    }

    /// The vertex at a point: kept from the last build, or computed.
    fn place(
        &mut self,
        point: Point,
        forest: &Forest,
        ground: &dyn Elevation,
        scratch: &mut Scratch,
    ) -> u32 {
        if let Some(place) = self.places.get(&point).copied() {
            let index = place as usize;
            if self.needed[index] != self.build {
                self.needed[index] = self.build;
                if self.stale.get(index).copied().unwrap_or(false) {
                    let vertex = self.vertex(point, forest, ground);
                    scratch.new_vertices += 1;
                    if bytes_of(&vertex) != bytes_of(&self.patch.vertices[index]) {
                        self.patch.vertices[index] = vertex;
                        scratch.changed.push(place);
                    }
                } else if self.has_new_steps && is_on_edge(self.node, point) {
                    // The steps of a neighbour may have changed.
                    let height_m = self.patch.vertices[index].height_m;
                    let from_origin = self.place_from_origin(point, height_m, forest);
                    if from_origin != self.patch.vertices[index].from_origin_m.as_dvec3() {
                        self.patch.vertices[index].from_origin_m = from_origin.as_vec3();
                        scratch.changed.push(place);
                    }
                }
            }
            return place;
        }
        let vertex = self.vertex(point, forest, ground);
        scratch.new_vertices += 1;
        let place = if let Some(place) = self.free.pop() {
            self.patch.vertices[place as usize] = vertex;
            self.needed[place as usize] = self.build;
            place
        } else {
            self.patch.vertices.push(vertex);
            self.needed.push(self.build);
            self.patch.vertices.len() as u32 - 1
        };
        self.places.insert(point, place);
        scratch.changed.push(place);
        place
    }

    fn vertex(&self, point: Point, forest: &Forest, ground: &dyn Elevation) -> GroundVertex {
        let (lat, lon) = lat_lon_rad(point);
        // Rounded first, so that every patch computes the same position from it.
        let height_m = ground.height_m(lat, lon, 0.0) as f32;
        let slope = ground.slope(forest.ellipsoid(), lat, lon, self.slope_rad());
        GroundVertex {
            from_origin_m: self.place_from_origin(point, height_m, forest).as_vec3(),
            height_m,
            slope: slope.as_vec2(),
        }
    }

    /// Half-width over which slopes are computed, radians, unless the data are coarser.
    fn slope_rad(&self) -> f64 {
        side_rad(self.node.level) / 64.0
    }

    /// Marks the vertices whose heights or slopes may have changed. Returns whether there are any.
    pub fn heights_changed(&mut self, changes: &[HeightChange], ground: &dyn Elevation) -> bool {
        let bounds = bounds(self.node.square(DEPTH));
        let beyond_rad = self.slope_rad().max(COARSEST_STEP_RAD);
        let is_near = |change: &&HeightChange| change.touches(&bounds, beyond_rad, 0.0);
        if !changes.iter().any(|change| is_near(&change)) {
            return false;
        }
        let slope_rad = self.slope_rad();
        self.stale.resize(self.patch.vertices.len(), false);
        let mut has_any = false;
        for (point, place) in &self.places {
            let (lat, lon) = lat_lon_rad(*point);
            // Queried only if a change is near and does not contain the place.
            let mut reach_rad = None;
            let mut touches = |change: &HeightChange| {
                change.bounds.contains(lat, lon) || {
                    let reach_rad = reach_rad.get_or_insert_with(|| {
                        slope_rad.max(ground.finest_spacing_rad(lat, lon).min(COARSEST_STEP_RAD))
                    });
                    change.touches_place(lat, lon, *reach_rad)
                }
            };
            if changes.iter().filter(is_near).any(&mut touches) {
                let stale = &mut self.stale[*place as usize];
                self.stale_vertices += u32::from(!*stale);
                *stale = true;
                has_any = true;
                self.has_stale_edge |= is_on_edge(self.node, *point);
            }
        }
        has_any
    }

    /// Whether stale vertices are left.
    pub fn is_stale(&self) -> bool {
        self.stale_vertices > 0
    }

    fn forget_stale(&mut self) {
        self.stale.clear();
        (self.stale_vertices, self.has_stale_edge) = (0, false);
    }

    /// Computes stale vertices again. At most `most` of those inside are computed. Those on the edge are all computed, since other patches
    /// share them. Returns the number of computed vertices.
    pub fn renew(
        &mut self,
        most: u32,
        forest: &Forest,
        ground: &dyn Elevation,
        scratch: &mut Scratch,
    ) -> u32 {
        let mut renewed = std::mem::take(&mut scratch.renewed);
        renewed.clear();
        let mut left = most;
        if left > 0 || self.has_stale_edge {
            for (point, place) in &self.places {
                if !self.stale[*place as usize] {
                    continue;
                }
                if !is_on_edge(self.node, *point) {
                    if left == 0 {
                        continue;
                    }
                    left -= 1;
                }
                renewed.push((*place, self.vertex(*point, forest, ground)));
            }
        }
        self.has_stale_edge = false;
        self.stale_vertices -= renewed.len() as u32;
        scratch.new_vertices += renewed.len() as u64;
        scratch.changed.clear();
        for (place, vertex) in &renewed {
            let index = *place as usize;
            self.stale[index] = false;
            if bytes_of(vertex) != bytes_of(&self.patch.vertices[index]) {
                self.patch.vertices[index] = *vertex;
                scratch.changed.push(*place);
            }
        }
        if self.stale_vertices == 0 {
            self.stale.clear();
        }
        let count = renewed.len() as u32;
        scratch.renewed = renewed;
        if !scratch.changed.is_empty() {
            self.tell_changed(scratch);
            // While the patch is still changing, any face may be visible.
            self.normals = NormalCone::ALL;
            self.patch.revision += 1;
        }
        if self.stale_vertices == 0 && count > 0 {
            self.normals = normal_cone(&self.patch);
        }
        count
    }

    /// Position of a point relative to the origin, metres, rounded to the coarsest step of all patches that share the point. It is a
    /// multiple of this patch's step that single precision represents exactly. Origin plus position is therefore the same in all of them.
    fn place_from_origin(&self, point: Point, height_m: f32, forest: &Forest) -> DVec3 {
        let (lat_rad, lon_rad) = lat_lon_rad(point);
        let itrf_m = forest.ellipsoid().itrf_from_geodetic(Geodetic {
            lat_rad,
            lon_rad,
            height_m: f64::from(height_m),
        });
        let step = if is_on_edge(self.node, point) {
            self.coarsest_step_m(point)
        } else {
            self.step_m
        };
        (itrf_m / step).round() * step - self.patch.origin_itrf_m
    }

    /// Coarsest step of the patches that meet in a point on the edge.
    fn coarsest_step_m(&self, (x, y): Point) -> f64 {
        let (columns, rows) = (BLOCKS.columns << DEPTH, BLOCKS.rows << DEPTH);
        let has = |node: Node| {
            let square = node.square(DEPTH);
            let (x_end, y_end) = (square.x + square.size, square.y + square.size);
            if y == 0 || y == rows {
                return y == square.y || y == y_end;
            }
            let is_within = (square.x..=x_end).contains(&x) || x == 0 && x_end == columns;
            is_within && (square.y..=y_end).contains(&y)
        };
        let steps = self.beside.iter().filter(|(node, _)| has(*node));
        steps.fold(self.step_m, |most, (_, step)| most.max(*step))
    }

    /// Frees the vertices that this build did not need.
    fn give_up_unneeded(&mut self) {
        let Self {
            places,
            needed,
            free,
            build,
            ..
        } = self;
        places.retain(|_, place| {
            let stays = needed[*place as usize] == *build;
            if !stays {
                free.push(*place);
            }
            stays
        });
    }

    /// Stores the triangles and the list of changes in the patch.
    fn hand_over(&mut self, scratch: &mut Scratch) {
        let is_first = self.build == 1;
        let is_new = self.patch.indices.triangles != scratch.triangles;
        if is_new {
            // Never in place: holders of the old list identify it by its address.
            self.patch.indices = Arc::new(TriangleList {
                triangles: scratch.triangles.clone(),
            });
            self.normals = normal_cone(&self.patch);
        } else if !scratch.changed.is_empty() {
            self.normals = normal_cone(&self.patch);
        }
        self.tell_changed(scratch);
        if !is_first && (is_new || !scratch.changed.is_empty()) {
            self.patch.revision += 1;
        }
    }

    /// Stores the list of changes in the patch.
    fn tell_changed(&mut self, scratch: &mut Scratch) {
        self.patch.changed.clear();
        scratch.changed.sort_unstable();
        for place in &scratch.changed {
            match self.patch.changed.last_mut() {
                Some(last) if last.end == *place => last.end += 1,
                _ => self.patch.changed.push(*place..place + 1),
            }
        }
    }
}

/// Whether a point is on the edge of a patch. Points are normalised by [`super::node::Domain::point`].
fn is_on_edge(node: Node, (x, y): Point) -> bool {
    let Square { x: x0, y: y0, size } = node.square(DEPTH);
    let all = BLOCKS.columns << DEPTH;
    let is_pole = y == 0 || y == BLOCKS.rows << DEPTH;
    is_pole || x == x0 || x == (x0 + size) % all || y == y0 || y == y0 + size
}

/// Cone of the normals of all faces of a patch.
fn normal_cone(patch: &Patch) -> NormalCone {
    let at = |place: u32| patch.vertices[place as usize].from_origin_m.as_dvec3();
    let normals = || {
        let triangles = patch.indices.triangles.as_chunks::<3>().0;
        triangles.iter().map(|[a, b, c]| {
            let origin = at(*a);
            (at(*b) - origin).cross(at(*c) - origin)
        })
    };
    let Some(axis) = normals().sum::<DVec3>().try_normalize() else {
        return NormalCone::ALL;
    };
    let least = normals()
        .filter_map(DVec3::try_normalize)
        .map(|normal| normal.dot(axis))
        .fold(1.0, f64::min);
    NormalCone {
        axis,
        half_angle_rad: least.clamp(-1.0, 1.0).acos() + 1e-6,
    }
}
