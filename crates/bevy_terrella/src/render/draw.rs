//! The pass of one camera.

use super::planet::Planets;
use bevy::camera::{MainPassResolutionOverride, Viewport};
use bevy::ecs::system::Res;
use bevy::render::camera::ExtractedCamera;
use bevy::render::diagnostic::RecordDiagnostics;
use bevy::render::render_resource::{RenderPassDescriptor, StoreOp};
use bevy::render::renderer::{RenderContext, ViewQuery};
use bevy::render::view::{ExtractedView, ViewDepthStencilTexture, ViewTarget};

type Parts<'a> = (
    &'a ExtractedCamera,
    &'a ExtractedView,
    &'a ViewTarget,
    &'a ViewDepthStencilTexture,
    Option<&'a MainPassResolutionOverride>,
);

/// Runs between the opaque and the transparent pass. Opaque meshes hide the Earth by depth, and its atmosphere covers those behind
/// it. Transparent meshes cover both.
pub(super) fn draw(view: ViewQuery<Parts>, planets: Res<Planets>, mut context: RenderContext) {
    let (camera, view, target, depth, resolution) = view.into_inner();
    let entity = view.retained_view_entity.main_entity.id();
    if !planets.is_prepared(entity) {
        return;
    }
    let diagnostics = context.diagnostic_recorder();
    let diagnostics = diagnostics.as_deref();
    let mut pass = context.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("terrella earth"),
        color_attachments: &[Some(target.get_color_attachment())],
        depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    });
    let span = diagnostics.pass_span(&mut pass, "terrella earth");
    let viewport = Viewport::from_viewport_and_override(camera.viewport.as_ref(), resolution);
    if let Some(viewport) = &viewport {
        pass.set_camera_viewport(viewport);
    }
    planets.render(entity, pass.wgpu_pass());
    span.end(&mut pass);
}
