//! Pages of contours on the GPU: one buffer of nodes with a slot per page, and the prisms of the pages in sight. Behind a prism's faces the shader
//! casts each pixel's ray at the page's tree.

use super::DepthBuffer;
use super::lattice::BlockInstance;
use super::mesh::{BeginDraw, SurfaceMesh};
use super::shader::VertexForm;
use crate::plan::{DeviceLimits, FramePlan, PRISM_INDICES};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use terrella_ground::globe::contours::{ContourNode, MAX_NODES, PageOptions};
use terrella_ground::globe::{ContourPageSet, DrawKind, Surface};

/// Corners of a page's prism.
const PRISM_CORNERS: usize = 8;

/// The binding of the nodes.
const BINDING: u32 = 6;

/// Per-page values, one instance a page.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct PageInstance {
    reference: BlockInstance,
    /// From the page's origin to the eye, ITRF metres: subtracted in f64.
    eye_from_origin_m: Vec3,
    /// Index of its tree's root among all nodes.
    root: u32,
    /// See [`terrella_ground::globe::contours::ContourRay`].
    slack_m: f32,
    cone: f32,
    step_m: f32,
}

const VERTEX_ATTRIBUTES: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![0 => Float32x3];
const INSTANCE_ATTRIBUTES: [wgpu::VertexAttribute; 7] = wgpu::vertex_attr_array![
    1 => Float32x2, 2 => Float32x2, 3 => Float32x2, 4 => Uint32, 5 => Float32x3, 6 => Uint32, 7 => Float32x3
];

/// The vertex buffers of `shaders/earth/vertex/contour_prisms.wgsl`.
const BUFFERS: [Option<wgpu::VertexBufferLayout<'static>>; 2] = [
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<Vec3>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &VERTEX_ATTRIBUTES,
    }),
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<PageInstance>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &INSTANCE_ATTRIBUTES,
    }),
];

/// Faces of a prism, counter-clockwise from outside: bottom, top, south, east, north, west. Corners are SW, SE, NW, NE at the bottom, then at the
/// top.
const FACES: [u16; PRISM_INDICES as usize] = [
    0, 3, 1, 0, 2, 3, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 1, 3, 7, 1, 7, 5, 3, 2, 6, 3, 6, 7, 2, 0,
    4, 2, 4, 6,
];

/// Margin by which a prism is drawn larger than its page, so that it covers all samples of a pixel whose centre it covers.
const MARGIN_PX: f64 = 2.0;

/// The pages of one surface.
pub(crate) struct PageMesh {
    nodes: wgpu::Buffer,
    /// Revision of the page in each slot.
    held: Vec<u64>,
    corners: wgpu::Buffer,
    corner_staging: Vec<Vec3>,
    instances: wgpu::Buffer,
    instance_staging: Vec<PageInstance>,
    faces: wgpu::Buffer,
    /// Without a depth buffer, pages are drawn back to front.
    far_first: bool,
}

impl PageMesh {
    /// Whether a device with these limits can cast rays at so many pages.
    pub fn fits(limits: &DeviceLimits, options: &PageOptions) -> bool {
        options.node_bytes() <= limits.storage_bytes && limits.bindings > BINDING
    }

    pub fn new(device: &wgpu::Device, pages: &ContourPageSet, depth: DepthBuffer) -> Self {
        let most = pages.max_pages as usize;
        let buffer = |label: &'static str, bytes: usize, usage: wgpu::BufferUsages| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes as u64,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let slot = MAX_NODES as usize * size_of::<ContourNode>();
        let vertex = wgpu::BufferUsages::VERTEX;
        let storage = wgpu::BufferUsages::STORAGE;
        Self {
            nodes: buffer("terrella contours", most * slot, storage),
            held: vec![0; most],
            corners: buffer(
                "terrella page corners",
                PRISM_CORNERS * most * size_of::<Vec3>(),
                vertex,
            ),
            corner_staging: Vec::with_capacity(PRISM_CORNERS * most),
            instances: buffer("terrella pages", most * size_of::<PageInstance>(), vertex),
            instance_staging: Vec::with_capacity(most),
            faces: super::filled_buffer(
                device,
                "terrella page faces",
                bytemuck::cast_slice(&FACES),
                wgpu::BufferUsages::INDEX,
            ),
            far_first: depth == DepthBuffer::None,
        }
    }
}

impl SurfaceMesh for PageMesh {
    fn vertex_form(&self, tiles: bool) -> VertexForm {
        VertexForm::ContourPrisms {
            tiles,
            writes_depth: !self.far_first,
        }
    }

    fn buffers(&self) -> &'static [Option<wgpu::VertexBufferLayout<'static>>] {
        &BUFFERS
    }

    /// Culls the front faces of prisms: through the back faces an eye inside still sees the page.
    fn culled(&self) -> wgpu::Face {
        wgpu::Face::Front
    }

    fn bindings(&self) -> Vec<(wgpu::BindGroupLayoutEntry, wgpu::BindGroupEntry<'_>)> {
        let layout = wgpu::BindGroupLayoutEntry {
            binding: BINDING,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: true },
                has_dynamic_offset: false,
                min_binding_size: wgpu::BufferSize::new(size_of::<ContourNode>() as u64),
            },
            count: None,
        };
        let entry = wgpu::BindGroupEntry {
            binding: BINDING,
            resource: self.nodes.as_entire_binding(),
        };
        vec![(layout, entry)]
    }

    /// Bytes of the nodes, and of the largest number of prisms in sight.
    fn ground_bytes(&self) -> u64 {
        self.nodes.size() + self.corners.size() + self.instances.size()
    }

    /// Uploads the prisms of pages in sight, and the nodes of missing pages.
    fn write(
        &mut self,
        queue: &wgpu::Queue,
        plan: &FramePlan,
        ground: Option<&dyn Surface>,
    ) -> u64 {
        let Some(surface) = ground else {
            return 0;
        };
        let DrawKind::ContourPages(pages) = surface.draw_kind() else {
            return 0;
        };
        let eye_itrf_m = plan.eye_itrf_m;
        self.corner_staging.clear();
        self.instance_staging.clear();
        let mut written = 0;
        surface.for_each_contour_page(&mut |page| {
            let Some(held) = self.held.get_mut(page.slot as usize) else {
                return;
            };
            let root = page.slot * MAX_NODES;
            if *held != page.revision {
                *held = page.revision;
                let at = u64::from(root) * size_of::<ContourNode>() as u64;
                queue.write_buffer(&self.nodes, at, page.nodes);
                written += page.nodes.len() as u64;
            }
            let origin_from_eye_m = page.origin_itrf_m - eye_itrf_m;
            let [east, north, up] = page.axes;
            for (k, corner) in (0..).zip(page.corners_m) {
                let sign = |bit: u32| if k & bit == 0 { -1.0 } else { 1.0 };
                let outward = east * sign(1) + north * sign(2) + up * sign(4);
                let from_eye_m = origin_from_eye_m + corner;
                let more_m = MARGIN_PX * pages.pixel_rad * from_eye_m.length() + page.slack_m;
                let down_m = if k < 4 { page.skirt_m } else { 0.0 };
                let moved_m = from_eye_m + outward * more_m - up * down_m;
                self.corner_staging.push(moved_m.as_vec3());
            }
            self.instance_staging.push(PageInstance {
                reference: BlockInstance::of_block(page.block),
                eye_from_origin_m: (-origin_from_eye_m).as_vec3(),
                root,
                slack_m: page.slack_m as f32,
                cone: pages.cone as f32,
                step_m: page.skirt_m as f32,
            });
        });
        let corners: &[u8] = bytemuck::cast_slice(&self.corner_staging);
        let instances: &[u8] = bytemuck::cast_slice(&self.instance_staging);
        for (buffer, bytes) in [(&self.corners, corners), (&self.instances, instances)] {
            if !bytes.is_empty() {
                queue.write_buffer(buffer, 0, bytes);
                written += bytes.len() as u64;
            }
        }
        written
    }

    fn render(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        plan: &FramePlan,
        begin_draw: &mut BeginDraw<'_>,
    ) {
        pass.set_vertex_buffer(1, self.instances.slice(..));
        pass.set_index_buffer(self.faces.slice(..), wgpu::IndexFormat::Uint16);
        let count = plan.draws.len();
        for n in 0..count {
            let k = if self.far_first { count - 1 - n } else { n };
            let draw = &plan.draws[k];
            begin_draw(pass, draw);
            let place = k as u32;
            // An offset instead of a base vertex, which WebGL2 does not have.
            let begin = PRISM_CORNERS * k * size_of::<Vec3>();
            pass.set_vertex_buffer(0, self.corners.slice(begin as u64..));
            pass.draw_indexed(draw.indices.clone(), 0, place..place + 1);
        }
    }
}
