//! Development of an image: exposed light becomes displayable colour, once, after all layers have added theirs.

use super::full_pass::FullPass;
use super::{DevelopVariant, PassFormat, ShaderError, filled_buffer};
use bytemuck::{Pod, Zeroable};
use terrella_ground::light::Grade;

/// Bindings of a measured response, and of white balance and grain.
const RESPONSE_BINDING: u32 = 2;
const GRADE_BINDING: u32 = 3;

/// Draws the displayable colour of exposed light over a whole target: the last pass of an image whose layers are drawn with
/// [`Development::AfterPass`](super::Development::AfterPass).
///
/// [`ScaledTarget::developing`](super::ScaledTarget::developing) includes one, with the texture that is rendered to before it. A host that has its
/// own float texture, and its own passes over the light, calls this in any pass of its own that has drawn nothing yet.
pub struct Developer {
    pass: FullPass,
    grade: Grade,
}

/// Exposed light that a [`Developer`] reads.
pub struct UndevelopedPicture(wgpu::BindGroup);

impl Developer {
    /// For passes of this format, with 8 bits a colour channel, and its tone curve. Set `is_enlarging` if targets are larger than the light
    /// texture, which is then enlarged bilinearly.
    ///
    /// # Errors
    /// An invalid shader file.
    pub fn new(
        device: &wgpu::Device,
        format: PassFormat,
        is_enlarging: bool,
    ) -> Result<Self, ShaderError> {
        Ok(Self {
            pass: developing_pass(device, format, is_enlarging)?,
            grade: format.grade,
        })
    }

    /// Selects the film grain of a frame for passes that are submitted from now on; frame numbers may start anywhere. No effect without grain.
    pub fn set_frame(&self, queue: &wgpu::Queue, frame: u32) {
        set_frame(&self.pass, queue, &self.grade, frame);
    }

    /// Exposed light to be developed: a single-sampled float texture that shaders can read.
    pub fn picture(&self, device: &wgpu::Device, light: &wgpu::TextureView) -> UndevelopedPicture {
        UndevelopedPicture(self.pass.bind(device, light))
    }

    /// Draws the developed light over the pass's whole target. Alpha is not changed.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>, picture: &UndevelopedPicture) {
        self.pass.render(pass, &picture.0);
    }
}

/// White balance and grain of a frame, as `shaders/develop.wgsl` reads them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct GradeUniforms {
    pub balance_x: [f32; 3],
    pub grain: f32,
    pub balance_y: [f32; 3],
    pub grain_size_px: f32,
    pub balance_z: [f32; 3],
    pub grain_seed: u32,
}

impl GradeUniforms {
    fn new(grade: &Grade, frame: u32) -> Self {
        let columns = grade.balance().unwrap_or_default().to_cols_array_2d();
        let [balance_x, balance_y, balance_z] = columns.map(|column| column.map(|n| n as f32));
        let grain = &grade.grain;
        Self {
            balance_x,
            grain: 4.0 * grain.strength as f32,
            balance_y,
            grain_size_px: grain.size_px as f32,
            balance_z,
            grain_seed: grain.frame_seed(frame),
        }
    }
}

/// The pass of a [`Developer`].
pub(super) fn developing_pass(
    device: &wgpu::Device,
    format: PassFormat,
    is_enlarging: bool,
) -> Result<FullPass, ShaderError> {
    let variant = DevelopVariant::new(format.target_color(), is_enlarging, &format.grade);
    let mut uniforms = Vec::new();
    if let Some(response) = format.tone.response() {
        let samples = bytemuck::cast_slice(response.samples());
        let usage = wgpu::BufferUsages::UNIFORM;
        let buffer = filled_buffer(device, "terrella response", samples, usage);
        uniforms.push((RESPONSE_BINDING, buffer));
    }
    if variant.is_graded() {
        let grade = GradeUniforms::new(&format.grade, 0);
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let buffer = filled_buffer(device, "terrella grade", bytemuck::bytes_of(&grade), usage);
        uniforms.push((GRADE_BINDING, buffer));
    }
    FullPass::with_uniforms(
        device,
        "terrella development",
        &variant,
        format,
        None,
        is_enlarging,
        uniforms,
    )
}

/// Selects the film grain of a frame for a developing pass with this grade.
pub(super) fn set_frame(pass: &FullPass, queue: &wgpu::Queue, grade: &Grade, frame: u32) {
    if grade.grain.strength > 0.0
        && let Some(buffer) = pass.uniform(GRADE_BINDING)
    {
        let uniforms = GradeUniforms::new(grade, frame);
        queue.write_buffer(buffer, 0, bytemuck::bytes_of(&uniforms));
    }
}
