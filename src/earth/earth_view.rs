//! The state of one view of an Earth. Maps, tables and pipelines are shared by all views.

use super::plan::Planner;
use super::tile_view::TileView;
use super::tiles::TileLevels;
use super::{Earth, EarthError, EyeView, FrameStats, Quality, Sky, Viewport};
use crate::gpu::{AirDrawable, AirTextures, ShaderError, SurfaceView};
use crate::plan::FramePlan;
#[cfg(feature = "celestial")]
use crate::plan::FrameUniforms;
use terrella_ground::globe::{BlockSet, Meshes};
use terrella_ground::light::Exposure;

/// A further view of an [`Earth`]: for split screens, stereo, and the cameras of instruments.
///
/// It shares the maps, tiles, tables and pipelines of its Earth. It owns some buffers (a few MiB), and with terrain the meshes that its eye needs.
/// [`Earth::new_view`] creates it, [`Earth::prepare`] prepares it with the other images of a frame
/// ([`FrameRequest::with_views`](super::FrameRequest::with_views)), [`Earth::render_view`] draws it.
pub struct EarthView {
    pub(super) planner: Planner,
    /// The frame plan of the view.
    pub(super) plan: FramePlan,
    pub(super) surface: SurfaceView,
    pub(super) air: Option<AirDrawable>,
    pub(super) levels: TileLevels,
    /// Inputs of tile selection; `None` if the last view was not finite: then nothing is drawn.
    pub(super) drawn: Option<TileView>,
    pub(super) stats: FrameStats,
    pub(super) version: Version,
    /// Whether the warning that it belongs to another Earth was logged.
    pub(super) is_rejected: bool,
    /// Whether the warning that its eye's view cannot be drawn was logged.
    is_unseen: bool,
}

/// State of an Earth that a view was made for: its terrain, and its pipelines for a quality and appearance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Version {
    pub earth: u64,
    /// How many times the terrain was replaced.
    pub grounds: u64,
    pub pipelines: u64,
}

impl EarthView {
    /// A view that has not been prepared.
    pub(super) fn new(
        planner: Planner,
        surface: SurfaceView,
        air: Option<AirDrawable>,
        version: Version,
    ) -> Self {
        Self {
            plan: planner.empty_plan(),
            planner,
            surface,
            air,
            levels: TileLevels::default(),
            drawn: None,
            stats: FrameStats::default(),
            version,
            is_rejected: false,
            is_unseen: false,
        }
    }

    /// Draws with this quality, its meshes and its air from now on. Nothing is drawn until the view is bound and prepared.
    pub(super) fn set_quality(
        &mut self,
        device: &wgpu::Device,
        quality: &Quality,
        meshes: Meshes,
        air: Option<AirDrawable>,
    ) {
        self.surface.reset(device, meshes.grids());
        self.planner.set_quality(quality, meshes);
        self.plan = self.planner.empty_plan();
        self.air = air;
        self.levels = TileLevels::default();
        self.drawn = None;
    }

    /// Makes the next selection independent of earlier ones.
    pub(super) fn forget_views(&mut self) {
        self.levels = TileLevels::default();
        if let Some(ground) = self.planner.ground_driver_mut() {
            ground.forget_views();
        }
    }

    /// Forgets again if the elevation data has changed since. Returns whether it had.
    pub(super) fn forget_views_again(&mut self) -> bool {
        let ground = self.planner.ground_driver_mut();
        let Some(ground) = ground.filter(|ground| !ground.has_forgotten()) else {
            return false;
        };
        ground.forget_views();
        true
    }

    /// Statistics of the last prepared frame. Tiles and textures are those of the whole Earth.
    pub fn stats(&self) -> &FrameStats {
        &self.stats
    }

    /// Draws with this exposure from the next [`Earth::prepare`] on. A view starts with the exposure of its Earth.
    ///
    /// # Errors
    /// An exposure outside its range. The exposure is then unchanged.
    pub fn set_exposure(&mut self, exposure: Exposure) -> Result<(), EarthError> {
        let exposure = exposure.check().map_err(EarthError::Exposure)?;
        self.planner.exposure.set(exposure);
        Ok(())
    }

    /// Textures of its air for other drawables.
    pub(crate) fn air_textures(&self) -> Option<&AirTextures> {
        self.air.as_ref().map(AirDrawable::textures)
    }

    /// The figure of its Earth.
    #[cfg(feature = "celestial")]
    pub(crate) fn ellipsoid(&self) -> terrella_frames::Ellipsoid {
        self.planner.ellipsoid()
    }

    /// The same uniforms with the exposure of the frame prepared last.
    #[cfg(feature = "celestial")]
    pub(crate) fn exposed(&self, frame: FrameUniforms) -> FrameUniforms {
        FrameUniforms {
            exposure: self.plan.uniforms.exposure,
            ..frame
        }
    }

    /// Selects what it shows, without tiles and without the GPU.
    pub(super) fn choose(&mut self, eye: &EyeView, sky: &Sky, target: Viewport) {
        let view = eye.in_itrf(target);
        if let Err(error) = &view
            && !std::mem::replace(&mut self.is_unseen, true)
        {
            tracing::warn!("the Earth is not drawn: {error}");
        }
        let seen = view.ok().zip(sky.with_unit_sun());
        self.drawn = seen
            .as_ref()
            .map(|(view, sky)| self.planner.tile_view(view, sky));
        self.stats = match &seen {
            Some((view, sky)) => self.planner.plan(view, sky, &mut self.plan),
            None => FrameStats::default(),
        };
    }

    /// Whether it is complete except for tiles.
    pub(super) fn is_settled(&self) -> bool {
        self.drawn.is_none() || self.planner.is_ground_settled()
    }

    /// Whether the pipelines of its air exist.
    pub(super) fn is_air_ready(&self) -> bool {
        let air = self.air.as_ref().zip(self.plan.air.as_ref());
        air.is_none_or(|(air, plan)| air.is_ready(plan, self.plan.has_moon_shadow))
    }

    /// Creates the pipelines of its air.
    pub(super) fn make_air_ready(&mut self, device: &wgpu::Device) -> Result<(), ShaderError> {
        match self.air.as_mut().zip(self.plan.air.as_ref()) {
            Some((air, plan)) => air.make_ready(device, plan, self.plan.has_moon_shadow),
            None => Ok(()),
        }
    }

    /// Lists the draws of the selection. `tiled` has the blocks with tiles, if triangles span several blocks.
    pub(super) fn list_draws(&mut self, tiled: Option<BlockSet>) {
        if self.drawn.is_some() {
            self.planner
                .list_draws(tiled, &mut self.plan, &mut self.stats);
        }
    }

    /// Uploads the listed draws.
    pub(super) fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) {
        if self.drawn.is_none() {
            return;
        }
        let stats = &mut self.stats;
        let ground = self.planner.ground();
        stats.uploaded_bytes += self.surface.write(queue, &self.plan, ground);
        stats.ground_bytes = self.surface.ground_bytes();
        if let Some((air, plan)) = self.air.as_mut().zip(self.plan.air.as_ref()) {
            stats.uploaded_bytes += air.write(device, queue, plan, &self.plan.uniforms);
        }
    }
}

impl Earth {
    /// Creates another view of this Earth, with its exposure. It makes buffers, but no pipelines, and loads no map.
    ///
    /// # Errors
    /// None beyond those of [`Self::new`].
    pub fn new_view(&self) -> Result<EarthView, EarthError> {
        let planner = self.first.planner.for_another_view()?;
        let air = self.first.air.as_ref();
        let air = air.map(|air| air.for_another_view(&self.device));
        let config = self.config(air.as_ref(), &planner);
        let grids = planner.meshes().grids();
        let mut surface = SurfaceView::new(&self.device, grids, &config);
        self.surface.bind_view(&mut surface);
        Ok(EarthView::new(planner, surface, air, self.first.version))
    }

    /// Brings a view up to the Earth's present pipelines. Returns false for a view of another Earth.
    pub(super) fn follow(&self, view: &mut EarthView) -> bool {
        let now = self.first.version;
        if view.version.earth != now.earth {
            return false;
        }
        let first = &self.first.planner;
        if view.version == now {
            view.planner.exposure.set_albedo(first.exposure.albedo());
            view.planner.set_kinds(first.kinds().cloned());
            return true;
        }
        if view.version.grounds != now.grounds {
            let Ok(another) = self.new_view() else {
                tracing::warn!("a view is not drawn: its ground could not be made");
                return false;
            };
            let before = std::mem::replace(view, another);
            view.planner.exposure.share(&before.planner.exposure);
            return true;
        }
        // Before the air is set, so that existing parts are not made again.
        view.planner.exposure.share(&first.exposure);
        view.planner.set_appearance(&self.appearance);
        let lights = first.city_lights.lights().cloned();
        view.planner.city_lights.set_lights(lights);
        let meshes = first.meshes().clone();
        let air = self.first.air.as_ref();
        let air = air.map(|air| air.for_another_view(&self.device));
        view.set_quality(&self.device, &self.quality, meshes, air);
        self.surface.bind_view(&mut view.surface);
        view.version = now;
        true
    }

    /// Draws a view that [`Self::prepare`] prepared, as [`Self::render`] draws the first. A view that belongs to another Earth, or was not prepared
    /// since the quality changed, is not drawn.
    ///
    /// A host that draws Sun and stars calls the three parts instead, with the sky before the third.
    pub fn render_view(&self, view: &EarthView, pass: &mut wgpu::RenderPass<'_>) {
        self.render_view_surface(view, pass);
        self.render_view_air(view, pass);
        self.render_view_clouds_overhead(view, pass);
    }

    /// The first part of [`Self::render_view`].
    pub fn render_view_surface(&self, view: &EarthView, pass: &mut wgpu::RenderPass<'_>) {
        self.render_surface_of(view, pass);
    }

    /// The second part.
    pub fn render_view_air(&self, view: &EarthView, pass: &mut wgpu::RenderPass<'_>) {
        self.render_air_of(view, pass);
    }

    /// The third part. It draws nothing for an eye more than 1 km above the clouds.
    pub fn render_view_clouds_overhead(&self, view: &EarthView, pass: &mut wgpu::RenderPass<'_>) {
        self.render_clouds_overhead_of(view, pass);
    }
}
