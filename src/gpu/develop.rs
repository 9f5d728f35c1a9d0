//! The development of a picture: exposed light becomes what is shown of it, once, when all layers have added theirs.

use super::full_pass::FullPass;
use super::{DevelopVariant, PassFormat, ShaderError, filled_buffer};

/// Binding of a measured response.
const RESPONSE_BINDING: u32 = 2;

/// Draws what is shown of exposed light over all of a target: the last pass of a picture whose layers are drawn with
/// [`Development::AfterPass`](super::Development::AfterPass).
///
/// [`ScaledTarget::developing`](super::ScaledTarget::developing) has one, with the texture that is drawn to before it. A host that has such a
/// texture of its own, and passes over its light, calls this in any pass of its own that has drawn nothing yet.
pub struct Developer(FullPass);

/// Exposed light that a [`Developer`] reads.
pub struct UndevelopedPicture(wgpu::BindGroup);

impl Developer {
    /// For passes of this format, whose colour is of 8 bits a channel, and its tone curve. `is_enlarging` where targets are larger than the light
    /// that is read, which is then enlarged, bilinear.
    ///
    /// # Errors
    /// A shader file that is at fault.
    pub fn new(
        device: &wgpu::Device,
        format: PassFormat,
        is_enlarging: bool,
    ) -> Result<Self, ShaderError> {
        developing_pass(device, format, is_enlarging).map(Self)
    }

    /// Exposed light to be developed: a float texture without samples, which shaders can read.
    pub fn picture(&self, device: &wgpu::Device, light: &wgpu::TextureView) -> UndevelopedPicture {
        UndevelopedPicture(self.0.bind(device, light))
    }

    /// Draws what is shown of the light over all of the pass's target. Its alpha stays.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>, picture: &UndevelopedPicture) {
        self.0.render(pass, &picture.0);
    }
}

/// The pass of a [`Developer`].
pub(super) fn developing_pass(
    device: &wgpu::Device,
    format: PassFormat,
    is_enlarging: bool,
) -> Result<FullPass, ShaderError> {
    let variant = DevelopVariant::new(format.target_color(), is_enlarging);
    let response = format.tone.response().map(|response| {
        let samples = bytemuck::cast_slice(response.samples());
        let usage = wgpu::BufferUsages::UNIFORM;
        (
            RESPONSE_BINDING,
            filled_buffer(device, "terrella response", samples, usage),
        )
    });
    FullPass::with_uniforms(
        device,
        "terrella development",
        &variant,
        format,
        None,
        is_enlarging,
        response.into_iter().collect(),
    )
}
