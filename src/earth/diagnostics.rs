//! For measuring and for looking at how an Earth is drawn. Pictures need none of it.

use super::Earth;
use crate::gpu::{AirDrawable, SurfaceOutput};
use crate::plan::{FramePlan, LightEffect};
use glam::{DVec3, Vec3};
use terrella_ground::globe::{BlockGrid, TangentCone};

/// What an Earth draws that is to be examined. The default is the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DiagnosticOptions {
    /// What is written to the target: the picture, where each pixel looks, or what is there.
    pub output: SurfaceOutput,
    /// Draws the edges of triangles alone, for looking at meshes. Needs a device with
    /// [`wgpu::Features::POLYGON_MODE_LINE`].
    pub wireframe: bool,
    /// Looks the air's light up for each pixel, and nowhere interpolates it between vertices: for measuring what that changes. Float
    /// targets, which get light itself, are always drawn so.
    pub per_pixel_air: bool,
}

/// How an Earth is drawn: see [`Earth::diagnostics`].
pub struct Diagnostics<'e> {
    /// Bytes of the WGSL that the driver gets: the surface's, and the air's from outside and from inside it.
    pub shader_bytes: u64,
    /// Names of the features that are on.
    pub features_on: Vec<&'static str>,
    /// Names of the features that are off and cost nothing.
    pub features_off: Vec<&'static str>,
    grid: &'e BlockGrid,
    plan: &'e FramePlan,
}

impl Diagnostics<'_> {
    /// The vertices of blocks that the GPU got for the last frame, from the eye, each beside its exact place; ITRF metres.
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
    /// How it is drawn. Makes lists: not for every frame.
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
        // Tiles come with packs; an Earth without one has nothing to switch off.
        let of_packs: &[&str] = match self.tiles {
            Some(_) if shader.contains(&"parts") => &["tiles", "parts"],
            Some(_) => &["tiles"],
            None => &[],
        };
        let layers = ["clouds", "normals", "night_lights", "water"];
        // Airglow is the air's.
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
