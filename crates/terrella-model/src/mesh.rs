//! Triangles of placed meshes, in the axes of the model, sorted by material.

use super::container::Container;
use super::error::{ModelError, ModelFault};
use super::json::Primitive;
use super::nodes::PlacedMesh;
use super::{MAX_INDICES, MAX_VERTICES, Part, Vertex};
use glam::{DMat3, DMat4, DVec3, Vec2, Vec3, Vec4};
use std::collections::{BTreeSet, HashMap};
use terrella_files::printable;

/// Most primitives after nodes are flattened, and most materials that they use.
const MAX_PRIMITIVES: u64 = 100_000;
const MAX_MATERIALS: u64 = 4096;
/// Most rows of accessors that are read: primitives may share accessors, which are then read more than once.
const MAX_ROWS: u64 = 16 * MAX_VERTICES;
/// Limit of names of ignored features.
const MAX_IGNORED: usize = 64;

/// Modes of primitives that are triangles.
const TRIANGLES: u64 = 4;
const STRIP: u64 = 5;
const FAN: u64 = 6;

pub struct Drawn {
    pub vertices: Vec<Vertex>,
    pub indices: Vec<u32>,
    pub parts: Vec<Part>,
    /// Index of each part's material in the document; `None` is the default material.
    pub materials: Vec<Option<u64>>,
}

/// The rows of a primitive's accessors.
struct Rows {
    positions: Vec<[f32; 3]>,
    normals: Option<Vec<[f32; 3]>>,
    uvs: Option<Vec<[f32; 2]>>,
    tangents: Option<Vec<[f32; 4]>>,
}

/// Which accessors those are.
#[derive(Clone, Copy, PartialEq, Eq)]
struct RowKey {
    position: u64,
    normal: Option<u64>,
    uv: Option<u64>,
    tangent: Option<u64>,
}

/// Indices of one material that turn with one joint.
struct Group {
    material: usize,
    joint: Option<usize>,
    indices: Vec<u32>,
}

struct Builder<'c> {
    container: &'c Container,
    vertices: Vec<Vertex>,
    materials: Vec<Option<u64>>,
    material_places: HashMap<Option<u64>, usize>,
    /// Triangles by material and joint.
    groups: Vec<Group>,
    group_places: HashMap<(usize, Option<usize>), usize>,
    index_count: u64,
    rows_read: u64,
    last: Option<(RowKey, Rows)>,
}

pub fn triangles(
    container: &Container,
    placed: &[PlacedMesh],
    ignored: &mut BTreeSet<String>,
) -> Result<Drawn, ModelError> {
    let mut builder = Builder {
        container,
        vertices: Vec::new(),
        materials: Vec::new(),
        material_places: HashMap::new(),
        groups: Vec::new(),
        group_places: HashMap::new(),
        index_count: 0,
        rows_read: 0,
        last: None,
    };
    let mut primitives = 0;
    for placed in placed {
        let meshes = &container.document.meshes;
        let mesh = container.object(meshes, "mesh", placed.mesh, &placed.pointer)?;
        for (index, primitive) in mesh.primitives.iter().enumerate() {
            let pointer = format!("/meshes/{}/primitives/{index}", placed.mesh);
            primitives += 1;
            builder.check("primitives", primitives, MAX_PRIMITIVES, &pointer)?;
            note_ignored(primitive, ignored);
            builder.add(primitive, placed, &pointer)?;
        }
    }
    builder.finish()
}

fn note_ignored(primitive: &Primitive, ignored: &mut BTreeSet<String>) {
    let read = ["POSITION", "NORMAL", "TEXCOORD_0", "TANGENT"];
    let unread = primitive.attributes.keys();
    for name in unread.filter(|name| !read.contains(&name.as_str())) {
        if ignored.len() < MAX_IGNORED {
            ignored.insert(printable(name));
        }
    }
    if !primitive.targets.is_empty() {
        ignored.insert("morph targets".to_owned());
    }
    let name = match primitive.mode {
        Some(0) => "points",
        Some(1..=3) => "lines",
        _ => return,
    };
    ignored.insert(name.to_owned());
}

impl Builder<'_> {
    fn check(
        &self,
        what: &'static str,
        count: u64,
        limit: u64,
        pointer: &str,
    ) -> Result<(), ModelError> {
        match count <= limit {
            true => Ok(()),
            false => {
                let fault = ModelFault::TooMany { what, count, limit };
                Err(self.container.error(fault, pointer))
            }
        }
    }

    fn add(
        &mut self,
        primitive: &Primitive,
        placed: &PlacedMesh,
        pointer: &str,
    ) -> Result<(), ModelError> {
        let mode = primitive.mode.unwrap_or(TRIANGLES);
        match mode {
            0..=3 => return Ok(()),
            TRIANGLES | STRIP | FAN => {}
            _ => {
                let expected = "0 to 6";
                return Err(self
                    .container
                    .wrong("mode", mode.to_string(), expected, pointer));
            }
        }
        let attribute = |name: &str| primitive.attributes.get(name).copied();
        let Some(position) = attribute("POSITION") else {
            let missing = ModelFault::Missing("attribute POSITION");
            return Err(self.container.error(missing, pointer));
        };
        let key = RowKey {
            position,
            normal: attribute("NORMAL"),
            uv: attribute("TEXCOORD_0"),
            // Those of flat normals are not the file's (section 3.7.2.1).
            tangent: attribute("NORMAL").and(attribute("TANGENT")),
        };
        let rows = match self.last.take().filter(|(last, _)| *last == key) {
            Some((_, rows)) => rows,
            None => self.rows(key, pointer)?,
        };
        let count = rows.positions.len();
        let order = match primitive.indices {
            Some(accessor) => {
                let rows = self.container.accessor(accessor, pointer)?.count;
                self.check("indices", rows, MAX_INDICES, pointer)?;
                self.container.indices(accessor, count, pointer)?
            }
            None => (0..count as u32).collect(),
        };
        let corners = corners(mode, &order);
        self.index_count += corners.len() as u64;
        self.check("indices", self.index_count, MAX_INDICES, pointer)?;
        let slot = self.slot(primitive.material, placed.joint, pointer)?;
        let placing = Placing::new(placed.model_from_mesh);
        match &rows.normals {
            Some(normals) => {
                let mut seen = vec![None; count];
                for corner in placing.wound(&corners) {
                    let at = corner as usize;
                    let index = match seen.get(at).copied().flatten() {
                        Some(index) => index,
                        None => {
                            let normal = normals.get(at).copied().unwrap_or([0.0, 0.0, 1.0]);
                            let normal = placing.normal(DVec3::from_array(normal.map(f64::from)));
                            let index = self.vertex(&rows, at, &placing, normal, pointer)?;
                            if let Some(slot) = seen.get_mut(at) {
                                *slot = Some(index);
                            }
                            index
                        }
                    };
                    self.push(slot, index);
                }
            }
            // "When normals are not specified, client implementations MUST calculate flat normals" (section 3.7.2.1).
            None => {
                for triangle in placing.wound(&corners).collect::<Vec<_>>().chunks_exact(3) {
                    let at = |corner: usize| {
                        let index = triangle.get(corner).copied().unwrap_or_default();
                        let position = rows.positions.get(index as usize);
                        placing.position(position.copied().unwrap_or_default())
                    };
                    let (a, b, c) = (at(0), at(1), at(2));
                    let normal = (b - a).cross(c - a).normalize_or_zero();
                    // A triangle without area shows nothing.
                    if normal == DVec3::ZERO {
                        continue;
                    }
                    for corner in triangle {
                        let normal = normal.as_vec3();
                        let index =
                            self.vertex(&rows, *corner as usize, &placing, normal, pointer)?;
                        self.push(slot, index);
                    }
                }
            }
        }
        self.last = Some((key, rows));
        Ok(())
    }

    fn rows(&mut self, key: RowKey, pointer: &str) -> Result<Rows, ModelError> {
        let container = self.container;
        let count = container.accessor(key.position, pointer)?.count;
        self.check("vertices", count, MAX_VERTICES, pointer)?;
        self.rows_read += count;
        self.check("vertices", self.rows_read, MAX_ROWS, pointer)?;
        for other in [key.normal, key.uv, key.tangent].into_iter().flatten() {
            let others = container.accessor(other, pointer)?.count;
            if others != count {
                let expected = "as many as there are positions";
                let pointer = format!("/accessors/{other}");
                return Err(container.wrong("count", others.to_string(), expected, &pointer));
            }
        }
        let rows = Rows {
            positions: container.vectors(key.position, pointer)?,
            normals: match key.normal {
                Some(accessor) => Some(container.vectors(accessor, pointer)?),
                None => None,
            },
            uvs: match key.uv {
                Some(accessor) => Some(container.vectors(accessor, pointer)?),
                None => None,
            },
            tangents: match key.tangent {
                Some(accessor) => Some(container.vectors(accessor, pointer)?),
                None => None,
            },
        };
        self.check_finite("position", key.position, &rows.positions)?;
        if let (Some(accessor), Some(normals)) = (key.normal, &rows.normals) {
            self.check_finite("normal", accessor, normals)?;
        }
        if let (Some(accessor), Some(uvs)) = (key.uv, &rows.uvs) {
            self.check_finite("texture coordinate", accessor, uvs)?;
        }
        if let (Some(accessor), Some(tangents)) = (key.tangent, &rows.tangents) {
            self.check_finite("tangent", accessor, tangents)?;
        }
        Ok(rows)
    }

    fn check_finite<const N: usize>(
        &self,
        what: &'static str,
        accessor: u64,
        rows: &[[f32; N]],
    ) -> Result<(), ModelError> {
        let bad = rows
            .iter()
            .position(|row| !row.iter().all(|x| x.is_finite()));
        match bad {
            None => Ok(()),
            Some(at) => {
                let fault = ModelFault::NotFinite { what, at };
                Err(self
                    .container
                    .error(fault, format!("/accessors/{accessor}")))
            }
        }
    }

    /// Adds a vertex and returns its index.
    fn vertex(
        &mut self,
        rows: &Rows,
        at: usize,
        placing: &Placing,
        normal: Vec3,
        pointer: &str,
    ) -> Result<u32, ModelError> {
        let position = rows.positions.get(at).copied().unwrap_or_default();
        let position_m = placing.position(position).as_vec3();
        if !position_m.is_finite() {
            let what = "the placed position";
            let fault = ModelFault::NotFinite { what, at };
            return Err(self.container.error(fault, pointer));
        }
        let index = self.vertices.len() as u64;
        self.check("vertices", index + 1, MAX_VERTICES, pointer)?;
        let uv = rows.uvs.as_ref().and_then(|uvs| uvs.get(at));
        let tangent = rows.tangents.as_ref().and_then(|all| all.get(at));
        self.vertices.push(Vertex {
            position_m,
            normal,
            uv: uv.map_or(Vec2::ZERO, |uv| Vec2::from_array(*uv)),
            tangent: tangent.map_or(Vec4::ZERO, |tangent| placing.tangent(*tangent)),
        });
        Ok(index as u32)
    }

    fn push(&mut self, slot: usize, index: u32) {
        if let Some(group) = self.groups.get_mut(slot) {
            group.indices.push(index);
        }
    }

    /// The place of the group of a material and a joint.
    fn slot(
        &mut self,
        material: Option<u64>,
        joint: Option<usize>,
        pointer: &str,
    ) -> Result<usize, ModelError> {
        let material = self.material(material, pointer)?;
        let next = self.groups.len();
        let slot = *self.group_places.entry((material, joint)).or_insert(next);
        if slot == next {
            self.groups.push(Group {
                material,
                joint,
                indices: Vec::new(),
            });
        }
        Ok(slot)
    }

    /// The place of a material among those that are used.
    fn material(&mut self, material: Option<u64>, pointer: &str) -> Result<usize, ModelError> {
        if let Some(place) = self.material_places.get(&material) {
            return Ok(*place);
        }
        if let Some(index) = material {
            let materials = &self.container.document.materials;
            self.container
                .object(materials, "material", index, pointer)?;
        }
        let place = self.materials.len();
        self.check("materials", place as u64 + 1, MAX_MATERIALS, pointer)?;
        self.material_places.insert(material, place);
        self.materials.push(material);
        Ok(place)
    }

    fn finish(self) -> Result<Drawn, ModelError> {
        if self.groups.iter().all(|group| group.indices.is_empty()) {
            return Err(self.container.error(ModelFault::Empty, ""));
        }
        let mut parts = Vec::new();
        let mut indices = Vec::new();
        for group in self.groups {
            let begin = indices.len() as u32;
            indices.extend(group.indices);
            let end = indices.len() as u32;
            if begin < end {
                parts.push(Part {
                    material: group.material,
                    joint: group.joint,
                    indices: begin..end,
                });
            }
        }
        Ok(Drawn {
            vertices: self.vertices,
            indices,
            parts,
            materials: self.materials,
        })
    }
}

/// Three indices for each triangle (specification, section 3.7.2.1).
fn corners(mode: u64, order: &[u32]) -> Vec<u32> {
    let triangles = order.windows(3).enumerate();
    match mode {
        STRIP => triangles
            .flat_map(|(i, three)| match (i % 2, three) {
                (0, [a, b, c]) => [*a, *b, *c],
                (_, [a, b, c]) => [*a, *c, *b],
                _ => [0; 3],
            })
            .collect(),
        FAN => {
            let Some((hub, rim)) = order.split_first() else {
                return Vec::new();
            };
            let pairs = rim.windows(2);
            let triangles = pairs.flat_map(|pair| [pair[0], pair[1], *hub]);
            triangles.collect()
        }
        _ => {
            let whole = order.len() / 3 * 3;
            order.iter().take(whole).copied().collect()
        }
    }
}

/// How a mesh comes into the axes of the model.
struct Placing {
    model_from_mesh: DMat4,
    /// Takes normals: the matrix of cofactors, by the sign of the determinant, which exists for any scale.
    model_from_normal: DMat3,
    is_mirrored: bool,
}

impl Placing {
    fn new(model_from_mesh: DMat4) -> Self {
        let turn = DMat3::from_mat4(model_from_mesh);
        let (x, y, z) = (turn.x_axis, turn.y_axis, turn.z_axis);
        let is_mirrored = turn.determinant() < 0.0;
        let sign = if is_mirrored { -1.0 } else { 1.0 };
        Self {
            model_from_mesh,
            model_from_normal: DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign,
            is_mirrored,
        }
    }

    fn position(&self, position: [f32; 3]) -> DVec3 {
        let position = DVec3::from_array(position.map(f64::from));
        self.model_from_mesh.transform_point3(position)
    }

    fn normal(&self, normal: DVec3) -> Vec3 {
        let normal = self.model_from_normal * normal;
        normal.normalize_or(DVec3::Z).as_vec3()
    }

    /// A tangent with its sign. In a mirror n × t turns round, and with it the sign.
    fn tangent(&self, [x, y, z, sign]: [f32; 4]) -> Vec4 {
        let along = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
        let along = self.model_from_mesh.transform_vector3(along);
        let along = along.normalize_or_zero().as_vec3();
        let is_turned = (sign < 0.0) != self.is_mirrored;
        match along.length_squared() > 0.0 {
            true => along.extend(if is_turned { -1.0 } else { 1.0 }),
            false => Vec4::ZERO,
        }
    }

    /// Corners in an order that is counter-clockwise from outside.
    fn wound<'c>(&self, corners: &'c [u32]) -> impl Iterator<Item = u32> + use<'c> {
        let is_mirrored = self.is_mirrored;
        let triangles = corners.chunks_exact(3);
        triangles.flat_map(move |three| match (is_mirrored, three) {
            (true, [a, b, c]) => [*a, *c, *b],
            (_, [a, b, c]) => [*a, *b, *c],
            _ => [0; 3],
        })
    }
}

/// Lower and upper corner of the box around vertices, metres.
pub fn bounds_m(vertices: &[Vertex]) -> [Vec3; 2] {
    let mut bounds = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    for vertex in vertices {
        bounds[0] = bounds[0].min(vertex.position_m);
        bounds[1] = bounds[1].max(vertex.position_m);
    }
    bounds
}
