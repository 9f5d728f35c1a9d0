//! Output for measurements and for inspecting how an Earth is drawn. Ordinary images need none of it.

use super::Earth;
use crate::gpu::{AirDrawable, SurfaceOutput};
use crate::plan::{FramePlan, LightEffect};
use glam::{DVec3, Vec3};
use terrella_ground::globe::{BlockGrid, TangentCone};

/// Diagnostic output of an Earth. The default is the ordinary image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DiagnosticOptions {
    /// What is written to the target: the image, geolocation or truth.
    pub output: SurfaceOutput,
    /// Draws only the edges of triangles, for inspecting meshes. Needs a device with [`wgpu::Features::POLYGON_MODE_LINE`].
    pub wireframe: bool,
    /// Samples the air's light in each pixel instead of interpolating it between vertices, and sunlight also in deep night, to measure the
    /// difference. Float targets, which store scene-referred light, always do so.
    pub per_pixel_air: bool,
}

/// Shaders and vertices of an Earth: see [`Earth::diagnostics`].
pub struct Diagnostics<'e> {
    /// Bytes of the WGSL that the driver gets: that of the surface, and that of the air from outside and from inside.
    pub shader_bytes: u64,
    /// Names of the features that are on.
    pub features_on: Vec<&'static str>,
    /// Names of the features that are off and cost nothing.
    pub features_off: Vec<&'static str>,
    grid: &'e BlockGrid,
    plan: &'e FramePlan,
}

impl Diagnostics<'_> {
    /// Block vertices that the GPU got for the last frame, relative to the eye, each with its exact position; ITRF metres.
    pub fn vertices(&self) -> impl Iterator<Item = (Vec3, DVec3)> {
        let cone = TangentCone::new(self.plan.eye_itrf_m, &self.plan.ellipsoid);
        let exact = self.plan.blocks.iter().flat_map(move |block| {
            let rows = 0..=self.grid.subdivision();
            let vertices = rows.flat_map(|row| self.grid.vertex_row(*block, row));
            vertices.map(move |vertex| cone.lifted(*vertex))
        });
        self.plan.vertices.iter().copied().zip(exact)
    }
}

impl Earth {
    /// Shaders and vertices of the last frame. It allocates: do not call it every frame.
    pub fn diagnostics(&self) -> Diagnostics<'_> {
        let air_bytes = self.first.air.as_ref().map_or(0, AirDrawable::shader_bytes);
        Diagnostics {
            shader_bytes: self.surface.shader_bytes() + air_bytes,
            features_on: self.features(true),
            features_off: self.features(false),
            grid: self.first.planner.meshes().grid(),
            plan: &self.first.plan,
        }
    }

    fn features(&self, on: bool) -> Vec<&'static str> {
        let shader = self.surface.features();
        // Only packs have tiles: without one, no feature of tiles is listed as off.
        let of_packs: &[&str] = match self.tiles {
            Some(_) if shader.contains(&"parts") => &["tiles", "parts"],
            Some(_) => &["tiles"],
            None => &[],
        };
        let layers = ["clouds", "normals", "night_lights", "water"];
        // Airglow needs the air.
        let effects = LightEffect::ALL
            .iter()
            .filter(|effect| **effect != LightEffect::Airglow)
            .map(|effect| effect.name());
        let effects: Vec<_> = effects.collect();
        layers
            .iter()
            .chain(&effects)
            .chain(of_packs)
            .chain(self.first.planner.ground_features())
            .copied()
            .map(|name| (name, shader.contains(&name)))
            .chain([("atmosphere", self.first.air.is_some())])
            .filter(|(_, is_on)| *is_on == on)
            .map(|(name, _)| name)
            .collect()
    }
}
