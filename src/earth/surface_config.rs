//! How the surface is drawn.

use super::{DiagnosticOptions, Quality, SurfaceLight};
use crate::gpu::{AirTextures, PassFormat, SurfaceConfig, SurfaceOutput};
use terrella_ground::globe::{Shading, Surface};
use terrella_imagery::tile::MapLayer;

/// How the surface is drawn, whatever the quality.
#[derive(Clone, Copy)]
pub(super) struct SurfaceStyle {
    pub shading: Shading,
    pub light: SurfaceLight,
    pub diagnostics: DiagnosticOptions,
}

/// How the surface is drawn with a quality.
pub(super) fn surface_config<'a>(
    device: &wgpu::Device,
    style: SurfaceStyle,
    format: PassFormat,
    quality: &Quality,
    air: Option<&'a AirTextures>,
    ground: Option<&'a dyn Surface>,
) -> SurfaceConfig<'a> {
    let software = device.adapter_info().device_type == wgpu::DeviceType::Cpu;
    let is_truth = style.diagnostics.output == SurfaceOutput::Truth;
    let mut light = style.light.uniforms();
    if is_truth && style.shading == Shading::Paper {
        // As the paper draws them: slopes as they are stored, clouds on the ground, but for a hair's breadth, as a ray along the
        // ground would go through their layer nowhere.
        (light.slope_gain, light.cloud_height) = (1.0, 1e-9);
    }
    let mut shown = quality.maps;
    shown[MapLayer::Day.index()] = true;
    SurfaceConfig {
        shading: style.shading,
        light,
        cloud_shadows: style.light.cloud_shadows,
        moonlight: style.light.moonlight,
        eclipses: style.light.eclipses,
        detail: style.light.detail,
        shown,
        output: style.diagnostics.output,
        ground: ground.map(Surface::draw_kind),
        #[cfg(feature = "terrain")]
        crosses_blocks: ground.is_some_and(Surface::crosses_blocks),
        wireframe: style.diagnostics.wireframe,
        anisotropy: if software { 1 } else { quality.anisotropy },
        format,
        air,
    }
}
