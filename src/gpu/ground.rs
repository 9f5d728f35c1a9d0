//! Patches of terrain on the GPU: kept from frame to frame, uploaded when they change.

use super::lattice::BlockInstance;
use super::mesh::{BeginDraw, SurfaceMesh};
use super::shader::{PatchTiles, VertexForm};
use crate::plan::{FramePlan, WHOLE_MAP};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use terrella_frames::Ellipsoid;
use terrella_ground::globe::{GroundVertex, Patch, Surface, TriangleList};

/// Number of frames for which a patch out of sight is kept.
const KEPT_FRAMES: u64 = 120;

/// The anchor is the eye, rounded to a multiple of this, metres. Origins on a finer power-of-two grid are exact relative to it, up to 2²⁴ steps
/// away.
const ANCHOR_STEP_M: f64 = 2.0;

/// Per-patch values, one instance a patch.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct PatchInstance {
    reference: BlockInstance,
    /// From the anchor to the patch's origin, ITRF metres. If a surface puts origins on a grid, and vertices are exact relative to them, this is
    /// exact too. The sum is then the same number in all patches that share a vertex: it is rounded alike, and edges are closed to the last bit.
    origin_from_anchor_m: Vec3,
    /// From the eye to the anchor, ITRF metres: the same for all patches.
    anchor_from_eye_m: Vec3,
}

const VERTEX_ATTRIBUTES: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x3, 5 => Float32, 6 => Float32x2];
const INSTANCE_ATTRIBUTES: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
    1 => Float32x2, 2 => Float32x2, 3 => Float32x2, 4 => Uint32, 7 => Float32x3, 8 => Float32x3
];

/// The vertex buffers of `shaders/earth/vertex/relief_patches.wgsl`.
const BUFFERS: [Option<wgpu::VertexBufferLayout<'static>>; 2] = [
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<GroundVertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &VERTEX_ATTRIBUTES,
    }),
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<PatchInstance>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &INSTANCE_ATTRIBUTES,
    }),
];

/// The patches of one surface.
pub(crate) struct GroundMesh {
    device: wgpu::Device,
    held: HashMap<u64, Held>,
    /// Triangles by the address of their source, which is kept alive with them so that the address stays unique.
    triangles: HashMap<usize, Triangles>,
    instances: wgpu::Buffer,
    staging: Vec<PatchInstance>,
    frame: u64,
    /// Whether patches span several blocks.
    crosses_blocks: bool,
}

struct Held {
    vertices: wgpu::Buffer,
    revision: u64,
    reference: BlockInstance,
    origin_itrf_m: DVec3,
    /// Key of its triangles.
    triangles: usize,
    used: u64,
}

struct Triangles {
    _source: Arc<TriangleList>,
    buffer: wgpu::Buffer,
    used: u64,
}

impl GroundMesh {
    pub fn new(device: &wgpu::Device, crosses_blocks: bool) -> Self {
        Self {
            device: device.clone(),
            held: HashMap::new(),
            triangles: HashMap::new(),
            instances: instance_buffer(device, 128),
            staging: Vec::new(),
            frame: 0,
            crosses_blocks,
        }
    }

    fn write_patch(&mut self, queue: &wgpu::Queue, patch: &Patch, ellipsoid: &Ellipsoid) -> u64 {
        let mut written = 0;
        let source = Arc::as_ptr(&patch.indices) as usize;
        let list = self.triangles.entry(source).or_insert_with(|| {
            let bytes: &[u8] = bytemuck::cast_slice(&patch.indices.triangles);
            let buffer = buffer(&self.device, "terrella ground triangles", bytes.len(), {
                wgpu::BufferUsages::INDEX
            });
            queue.write_buffer(&buffer, 0, bytes);
            written += bytes.len() as u64;
            Triangles {
                _source: patch.indices.clone(),
                buffer,
                used: 0,
            }
        });
        list.used = self.frame;
        let bytes: &[u8] = bytemuck::cast_slice(&patch.vertices);
        let before = self.held.get(&patch.key);
        let fits = before.is_some_and(|held| held.vertices.size() == bytes.len() as u64);
        let held_revision = before.filter(|_| fits).map(|held| held.revision);
        if !fits {
            let usage = wgpu::BufferUsages::VERTEX;
            self.held.insert(
                patch.key,
                Held {
                    vertices: buffer(&self.device, "terrella ground", bytes.len(), usage),
                    revision: 0,
                    reference: reference(patch, ellipsoid),
                    origin_itrf_m: patch.origin_itrf_m,
                    triangles: source,
                    used: 0,
                },
            );
        }
        let Some(held) = self.held.get_mut(&patch.key) else {
            return written;
        };
        match held_revision {
            Some(revision) if revision == patch.revision => {}
            Some(revision) if revision.wrapping_add(1) == patch.revision => {
                for range in &patch.changed {
                    let stride = size_of::<GroundVertex>();
                    let part = range.start as usize * stride..range.end as usize * stride;
                    if let Some(bytes) = bytes.get(part.clone()) {
                        queue.write_buffer(&held.vertices, part.start as u64, bytes);
                        written += bytes.len() as u64;
                    }
                }
                held.reference = reference(patch, ellipsoid);
            }
            _ => {
                queue.write_buffer(&held.vertices, 0, bytes);
                written += bytes.len() as u64;
                held.reference = reference(patch, ellipsoid);
            }
        }
        held.revision = patch.revision;
        held.origin_itrf_m = patch.origin_itrf_m;
        held.triangles = source;
        held.used = self.frame;
        written
    }
}

impl SurfaceMesh for GroundMesh {
    fn vertex_form(&self, has_tiles: bool) -> VertexForm {
        VertexForm::ReliefPatches(match (has_tiles, self.crosses_blocks) {
            (false, _) => PatchTiles::None,
            (true, false) => PatchTiles::OfOneBlock,
            (true, true) => PatchTiles::OfSeveralBlocks,
        })
    }

    fn buffers(&self) -> &'static [Option<wgpu::VertexBufferLayout<'static>>] {
        &BUFFERS
    }

    fn write(
        &mut self,
        queue: &wgpu::Queue,
        plan: &FramePlan,
        ground: Option<&dyn Surface>,
    ) -> u64 {
        let Some(surface) = ground else {
            return 0;
        };
        self.frame += 1;
        let mut written = 0;
        surface.for_each_patch(&mut |patch| {
            if !patch.is_empty() {
                written += self.write_patch(queue, patch, &plan.ellipsoid);
            }
        });
        let eye_itrf_m = plan.eye_itrf_m;
        let anchor_itrf_m = (eye_itrf_m / ANCHOR_STEP_M).round() * ANCHOR_STEP_M;
        let instances = plan.draws.iter().filter_map(|draw| {
            let held = self.held.get(&draw.patch)?;
            let mut reference = held.reference;
            reference.block = draw.drawn_as;
            Some(PatchInstance {
                reference,
                origin_from_anchor_m: (held.origin_itrf_m - anchor_itrf_m).as_vec3(),
                anchor_from_eye_m: (anchor_itrf_m - eye_itrf_m).as_vec3(),
            })
        });
        self.staging.clear();
        self.staging.extend(instances);
        let bytes: &[u8] = bytemuck::cast_slice(&self.staging);
        if bytes.len() as u64 > self.instances.size() {
            let places = self.staging.len().next_power_of_two();
            self.instances = instance_buffer(&self.device, places);
        }
        if !bytes.is_empty() {
            queue.write_buffer(&self.instances, 0, bytes);
        }
        let oldest = self.frame.saturating_sub(KEPT_FRAMES);
        self.held.retain(|_, held| held.used >= oldest);
        self.triangles.retain(|_, list| list.used >= oldest);
        written + bytes.len() as u64
    }

    fn ground_bytes(&self) -> u64 {
        let vertex_bytes = self.held.values().map(|held| held.vertices.size());
        let index_bytes = self.triangles.values().map(|list| list.buffer.size());
        vertex_bytes.chain(index_bytes).sum()
    }

    fn render(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        plan: &FramePlan,
        begin_draw: &mut BeginDraw<'_>,
    ) {
        if plan.draws.is_empty() {
            return;
        }
        pass.set_vertex_buffer(1, self.instances.slice(..));
        let held = plan.draws.iter().filter_map(|draw| {
            let held = self.held.get(&draw.patch)?;
            Some((draw, held, self.triangles.get(&held.triangles)?))
        });
        for (instance, (draw, held, list)) in (0..).zip(held) {
            begin_draw(pass, draw);
            pass.set_vertex_buffer(0, held.vertices.slice(..));
            pass.set_index_buffer(list.buffer.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(draw.indices.clone(), 0, instance..instance + 1);
        }
    }
}

/// Reference point of a patch's texture coordinates: its block's centre, or its own position.
fn reference(patch: &Patch, ellipsoid: &Ellipsoid) -> BlockInstance {
    match patch.block {
        Some(block) => BlockInstance::of_block(block),
        None => {
            let place = ellipsoid.geodetic_from_itrf(patch.origin_itrf_m);
            let u = place.lon_rad / TAU + 0.5;
            let v = 0.5 - place.lat_rad / PI;
            BlockInstance::new(
                place.lon_rad,
                place.lat_rad,
                [u as f32, v as f32],
                WHOLE_MAP,
            )
        }
    }
}

fn instance_buffer(device: &wgpu::Device, places: usize) -> wgpu::Buffer {
    let bytes = places * size_of::<PatchInstance>();
    let usage = wgpu::BufferUsages::VERTEX;
    buffer(device, "terrella ground patches", bytes, usage)
}

fn buffer(
    device: &wgpu::Device,
    label: &str,
    bytes: usize,
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
