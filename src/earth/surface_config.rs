//! Configuration of the surface.

use super::{DiagnosticOptions, Pipelines, Quality, SurfaceLight};
use crate::gpu::{AirTextures, PassFormat, SurfaceConfig, SurfaceOutput};
use terrella_ground::globe::{Shading, Surface};
use terrella_imagery::tile::MapLayer;

/// Configuration of the surface that is independent of quality.
#[derive(Clone, Copy)]
pub(super) struct SurfaceStyle {
    pub shading: Shading,
    pub light: SurfaceLight,
    pub diagnostics: DiagnosticOptions,
    /// Of [`super::EarthOptions`]: whether the air's light may be interpolated.
    pub interpolates_air: bool,
    pub pipelines: Pipelines,
    /// Whether there are city lights as points.
    pub has_city_lights: bool,
}

/// Configuration of the surface for a quality.
pub(super) fn surface_config<'a>(
    device: &wgpu::Device,
    style: SurfaceStyle,
    format: PassFormat,
    quality: &Quality,
    air: Option<&'a AirTextures>,
    ground: Option<&'a dyn Surface>,
) -> SurfaceConfig<'a> {
    let software = device.adapter_info().device_type == wgpu::DeviceType::Cpu;
    let mut shown = quality.maps;
    shown[MapLayer::Day.index()] = true;
    let city_lights = style.has_city_lights
        && style.light.detail
        && style.shading == Shading::Sunlit
        && style.diagnostics.output == SurfaceOutput::Color
        && shown[MapLayer::NightLights.index()];
    SurfaceConfig {
        shading: style.shading,
        city_lights,
        light: style.light,
        shown,
        output: style.diagnostics.output,
        ground: ground.map(Surface::draw_kind),
        #[cfg(feature = "terrain")]
        crosses_blocks: ground.is_some_and(Surface::crosses_blocks),
        interpolates_air: style.interpolates_air,
        is_gradual: style.pipelines == Pipelines::Gradually,
        // A GPU skips them by itself, and pipelines made in advance would be three times as many.
        leaves_out_scales: software
            && style.pipelines != Pipelines::AtOnce
            && style.light.detail
            && style.shading == Shading::Sunlit
            && style.diagnostics.output == SurfaceOutput::Color,
        wireframe: style.diagnostics.wireframe,
        anisotropy: if software { 1 } else { quality.anisotropy },
        format,
        air,
    }
}
