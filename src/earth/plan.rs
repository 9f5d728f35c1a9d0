//! The content of a frame: mesh resolution, blocks in sight, their tiles and terrain. Pure code: the plan is passed to the GPU, and nothing is read
//! back.

use super::city_lights::CityLightDriver;
use super::glow::glow_in_sight;
use super::ground::GroundDriver;
use super::metering::ExposureControl;
use super::quality::TILED_SUBDIVISION;
use super::sky::{DEEP_NIGHT, LIGHTS_OUT};
use super::tile_view::TileView;
use super::view::ItrfView;
use super::{Appearance, EarthError, EarthOptions, FrameStats, Quality, Sky};
use crate::gpu::SurfaceOutput;
use crate::plan::{
    AirPlan, AirSide, AuroraUniforms, CellLight, CellLights, DeviceLimits, DrawLight, FramePlan,
    FrameUniforms, MoonShadowUniforms, SurfaceLight, draw_blocks, interpolated_cells,
};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;
use terrella_frames::{Ellipsoid, MoonShadow};
use terrella_ground::air::{
    AirAboveClouds, AirOptions, AirTables, Atmosphere, Billboard, THICKNESS_M, TOP,
};
use terrella_ground::globe::{
    BLOCK_COUNT, Block, BlockGrid, BlockSet, COLUMNS, Meshes, Shading, Subdivision,
    SubdivisionError, Surface, Visibility, sagitta, select_blocks, texels_per_pixel,
};
use terrella_ground::light::{Grade, Tone, exposure_factor};
use terrella_imagery::tile::MapLayer;
use terrella_imagery::{GroundKinds, MOST_PIXEL_M};

/// Turns the views of one eye into frame plans.
pub(super) struct Planner {
    meshes: Meshes,
    visibility: Visibility,
    pub exposure: ExposureControl,
    has_air: bool,
    /// Whether images may interpolate the air's light between vertices where that suffices, and leave out sunlight in deep night.
    interpolates: bool,
    tone: Tone,
    grade: Grade,
    air: AirOptions,
    /// Whether there are clouds under physical light in an image, and whether they are drawn.
    has_clouds: bool,
    shows_clouds: bool,
    /// Light of the cells, created on first use.
    cells: Option<CellLights>,
    /// Where there is only land or only open sea, if known.
    kinds: Option<Arc<GroundKinds>>,
    light: SurfaceLight,
    pub city_lights: CityLightDriver,
    ground: Option<GroundDriver>,
    has_tiles: bool,
    /// Texels of the day map per block side if no tile is drawn.
    whole_day_pixels: u32,
}

impl Planner {
    /// `limits` are those of the device: they determine how it can draw terrain.
    pub fn new(
        options: &EarthOptions,
        quality: &Quality,
        limits: &DeviceLimits,
    ) -> Result<Self, EarthError> {
        let ellipsoid = options.figure.ellipsoid();
        let has_tiles = options.tiles.is_some();
        let has_clouds = options.layers.clouds.is_some()
            && options.shading == Shading::Sunlit
            && options.diagnostics.output == SurfaceOutput::Color;
        let ground = options.ground.as_ref();
        let ground = ground.map(|g| GroundDriver::new(g, options.figure, limits));
        Ok(Self {
            meshes: meshes(ellipsoid, quality.subdivision, has_tiles)?,
            visibility: options.visibility,
            exposure: ExposureControl::new(options, quality.atmosphere),
            has_air: quality.atmosphere == Atmosphere::Billboard,
            interpolates: options.interpolates_air(),
            tone: options.tone,
            grade: options.grade,
            air: options.air,
            has_clouds,
            shows_clouds: has_clouds && quality.maps[MapLayer::Clouds.index()],
            cells: None,
            kinds: options.ground_kinds(),
            light: options.light,
            city_lights: CityLightDriver::new(options),
            has_tiles,
            ground: ground.transpose()?,
            whole_day_pixels: options.layers.day.width / COLUMNS,
        })
    }

    /// The same planner for another eye.
    pub fn for_another_view(&self) -> Result<Self, EarthError> {
        let ground = self.ground.as_ref().map(GroundDriver::for_another_view);
        Ok(Self {
            meshes: self.meshes.clone(),
            exposure: self.exposure.clone(),
            ground: ground.transpose()?,
            cells: None,
            kinds: self.kinds.clone(),
            city_lights: self.city_lights.clone(),
            ..*self
        })
    }

    /// Plans with this quality from now on, with the meshes of its subdivision.
    pub fn set_quality(&mut self, quality: &Quality, meshes: Meshes) {
        self.meshes = meshes;
        self.has_air = quality.atmosphere == Atmosphere::Billboard;
        self.shows_clouds = self.has_clouds && quality.maps[MapLayer::Clouds.index()];
        self.exposure.set_air(quality.atmosphere);
    }

    /// Plans with this light and air from now on; terrain is not changed.
    pub fn set_appearance(&mut self, appearance: &Appearance) {
        let height_m = self.light.cloud_height_m;
        self.light = appearance.light;
        if self.air != appearance.air || self.light.cloud_height_m != height_m {
            self.air = appearance.air;
            self.cells = None;
        }
        self.exposure.set_appearance(appearance);
    }

    /// Where there is only land or only open sea, if known.
    pub fn kinds(&self) -> Option<&Arc<GroundKinds>> {
        self.kinds.as_ref()
    }

    /// Sets or clears the ground kinds.
    pub fn set_kinds(&mut self, kinds: Option<Arc<GroundKinds>>) {
        self.kinds = kinds;
    }

    /// Counts texels of a whole day map of this width.
    pub fn set_day_width(&mut self, texels: u32) {
        self.whole_day_pixels = texels / COLUMNS;
    }

    /// Plans with this terrain from now on, or with the smooth ellipsoid.
    pub fn set_ground(&mut self, ground: Option<GroundDriver>) {
        self.ground = ground;
    }

    /// The figure of the Earth.
    pub fn ellipsoid(&self) -> Ellipsoid {
        self.meshes.grid().ellipsoid()
    }

    /// The meshes that blocks are drawn with, one of them at a time.
    pub fn meshes(&self) -> &Meshes {
        &self.meshes
    }

    /// Terrain, if there is any.
    pub fn ground(&self) -> Option<&dyn Surface> {
        self.ground.as_ref().map(GroundDriver::surface)
    }

    /// Whether the surface has triangles, which have edges to draw.
    pub fn has_edges(&self) -> bool {
        self.ground.as_ref().is_none_or(GroundDriver::has_edges)
    }

    /// Names of the shader features that the terrain surface turns on.
    pub fn ground_features(&self) -> &'static [&'static str] {
        self.ground.as_ref().map_or(&[], GroundDriver::features)
    }

    /// Whether triangles may span several blocks.
    pub fn crosses_blocks(&self) -> bool {
        self.ground().is_some_and(Surface::crosses_blocks)
    }

    /// The driver of the terrain, if any.
    pub fn ground_driver(&self) -> Option<&GroundDriver> {
        self.ground.as_ref()
    }

    /// The driver of the terrain, mutable.
    pub fn ground_driver_mut(&mut self) -> Option<&mut GroundDriver> {
        self.ground.as_mut()
    }

    /// Whether a static view would get the same terrain again.
    pub fn is_ground_settled(&self) -> bool {
        self.ground.as_ref().is_none_or(GroundDriver::is_settled)
    }

    /// An empty plan with capacity for everything that this planner may put into it.
    pub fn empty_plan(&self) -> FramePlan {
        let per_block = self
            .meshes
            .grids()
            .iter()
            .map(BlockGrid::vertices_per_block);
        let vertices = match self.ground {
            Some(_) => 0,
            None => BLOCK_COUNT * per_block.max().unwrap_or(0),
        };
        FramePlan::new(self.ellipsoid(), vertices as usize)
    }

    /// Fills the plan for a view, and returns the statistics that do not depend on the GPU. Allocates nothing.
    pub fn plan(&mut self, view: &ItrfView, sky: &Sky, plan: &mut FramePlan) -> FrameStats {
        let ellipsoid = self.ellipsoid();
        let eye = ellipsoid.geodetic_from_itrf(view.eye_itrf_m);
        let pixel_rad = view.pixel_rad();
        let mut stats = FrameStats {
            eye,
            pixel_m: eye.height_m.max(0.0) * pixel_rad,
            ..FrameStats::default()
        };
        let light = self.exposure.light_in(view, sky, &ellipsoid);
        stats.night_gain = light.night_gain;
        stats.exposure_ev = self.exposure.ev(view, sky, &ellipsoid, &light);
        let exposure = exposure_factor(stats.exposure_ev) as f32;
        plan.clear();
        plan.eye_itrf_m = view.eye_itrf_m;
        let highest_m = match &mut self.ground {
            Some(ground) => {
                let highest_m;
                (stats.ground, highest_m) = ground.plan(self.meshes.grid(), view, &mut plan.blocks);
                stats.height_tiles = ground.height_tiles();
                stats.blocks_visible = plan.blocks.len() as u32;
                highest_m
            }
            None => {
                self.plan_blocks(view, plan, &mut stats);
                0.0
            }
        };
        let nearest_m = (eye.height_m - highest_m).max(0.0);
        plan.least_pixel = view.least_pixel_rad() * nearest_m / ellipsoid.equatorial_radius_m;
        stats.blocks_drawn = plan.blocks.len() as u32;
        let grid = self.meshes.grid();
        for block in &plan.blocks {
            let (lowest, highest) = grid.sun_range(*block, sky.sun_itrf);
            if lowest > LIGHTS_OUT {
                plan.daylit.insert(block.index() as u8);
            }
            if self.interpolates && highest < DEEP_NIGHT {
                plan.night.insert(block.index() as u8);
            }
        }
        if self.ground.is_none() {
            self.city_lights.list(view, sky, exposure, &light, plan);
        }
        if !self.has_tiles {
            stats.texels_per_pixel = self.whole_texels_per_pixel(view, &plan.blocks);
        }
        let (moon_itrf, moon_light) = sky.moonlight();
        let shadow = self.moon_shadow_in_view(view, sky);
        plan.has_moon_shadow = shadow.is_some();
        let clouds_before = match self.shows_clouds {
            true => self.light.clouds_before(eye.height_m),
            false => 1.0,
        };
        plan.is_below_clouds = clouds_before < 1.0;
        // Bodies behind a mountain would cover it.
        let clouds_around = match self.shows_clouds && self.ground.is_none() {
            true => self.light.clouds_around(eye.height_m),
            false => 0.0,
        };
        plan.has_clouds_around = clouds_around > 0.0;
        let clouds_at_limb = match self.shows_clouds && view.may_see_limb(&ellipsoid) {
            true => self.light.clouds_at_limb(eye.height_m, pixel_rad),
            false => 0.0,
        };
        plan.has_clouds_at_limb = clouds_at_limb > 0.0;
        stats.moon_shadow = shadow.is_some();
        plan.uniforms = FrameUniforms {
            sun_itrf: sky.sun_itrf.as_vec3(),
            exposure,
            moon_itrf: moon_itrf.as_vec3(),
            moon_light: (light.moon_gain() * moon_light) as f32,
            shadow: MoonShadowUniforms::new(shadow.as_ref(), &ellipsoid),
            lamp_light: light.lamp_light() as f32,
            clouds_before: clouds_before as f32,
            clouds_at_limb: clouds_at_limb as f32,
            clouds_around: clouds_around as f32,
            clouds_reach: (self.light.clouds_reach_m() / ellipsoid.equatorial_radius_m) as f32,
            ..view.uniforms(&ellipsoid)
        };
        if self.has_air {
            let scale = ellipsoid.itrf_from_scaled();
            let eye_scaled = view.eye_itrf_m / scale;
            let short = self.short_of_limb();
            let ring = Billboard::new(eye_scaled, TOP, short, &view.clip_from_eye, scale);
            let glow = glow_in_sight(view, &ring, sky, &ellipsoid, &light);
            let kp = self.light.kp.filter(|_| glow.is_some());
            plan.air = Some(AirPlan {
                ring,
                eye_up: Ellipsoid::normal(eye.lat_rad, eye.lon_rad),
                glow,
                aurora: kp.map(|kp| AuroraUniforms::new(kp, sky.epoch, sky.sun_itrf)),
            });
        }
        stats
    }

    /// Lists the draws of the surface and counts them. `tiled` has the blocks with tiles, if triangles span several blocks. Allocates nothing in
    /// steady state.
    pub fn list_draws(
        &mut self,
        tiled: Option<BlockSet>,
        plan: &mut FramePlan,
        stats: &mut FrameStats,
    ) {
        let interpolates = self.interpolates_in(plan);
        match &mut self.ground {
            Some(ground) => ground.list_draws(&plan.ellipsoid, tiled, &mut plan.draws),
            None if interpolates => {
                let cells = self.cells.get_or_insert_with(|| {
                    let height_m = self.light.cloud_height_m;
                    let clouds = self
                        .has_clouds
                        .then(|| AirAboveClouds::shared(&self.air, height_m));
                    CellLights::new(AirTables::shared(&self.air), clouds, self.tone, &self.grade)
                });
                let light = CellLight {
                    sun_itrf: plan.uniforms.sun_itrf,
                    exposure: plan.uniforms.exposure,
                    day_sin: LIGHTS_OUT as f32,
                };
                let kinds = self
                    .kinds
                    .as_deref()
                    .filter(|_| stats.pixel_m < MOST_PIXEL_M);
                cells.list(self.meshes.grid(), &light, kinds, plan);
            }
            None => draw_blocks(self.meshes.grid(), &plan.blocks, &mut plan.draws),
        }
        for draw in &mut plan.draws {
            let is_daylit = |block: Block| plan.daylit.contains(block.index() as u8);
            if draw.block.is_some_and(is_daylit) {
                draw.light = draw.light.max(DrawLight::Daylit);
            }
            let is_dark = |block: Block| plan.night.contains(block.index() as u8);
            if draw.block.is_some_and(is_dark) {
                draw.light = DrawLight::Night;
            }
        }
        let costs = plan.costs();
        (stats.draw_calls, stats.triangles) = (costs.draw_calls, costs.triangles);
    }

    /// Whether a frame may interpolate the air's light between vertices: the eye is above the air and no shadow is in view.
    fn interpolates_in(&self, plan: &FramePlan) -> bool {
        let side = plan.air.as_ref().map(AirPlan::side);
        self.interpolates && side == Some(AirSide::Outside) && !plan.has_moon_shadow
    }

    /// The Moon's shadow, if it may fall on ground, clouds or air in sight.
    fn moon_shadow_in_view(&self, view: &ItrfView, sky: &Sky) -> Option<MoonShadow> {
        let ellipsoid = self.ellipsoid();
        let top_m = TOP * ellipsoid.equatorial_radius_m;
        let shadow = sky.moon_shadow().filter(|_| self.light.eclipses)?;
        let eye = view.eye_itrf_m;
        // To the limb, and from there to the top of the air.
        let least_m = ellipsoid.polar_radius_m;
        let to_limb = |m: f64| ((m + least_m) * (m - least_m).max(0.0)).sqrt();
        let sight_m = to_limb(eye.length()) + to_limb(top_m);
        let is_in_view = shadow.reaches(DVec3::ZERO, top_m) && shadow.reaches(eye, sight_m);
        // Behind the Earth the cone continues without effect.
        let to_limb_rad = |m: f64| (least_m / m).min(1.0).acos();
        let to_night_rad = FRAC_PI_2 + to_limb_rad(eye.length()) + to_limb_rad(top_m);
        let sees_day = eye.angle_between(sky.sun_itrf) < to_night_rad;
        (is_in_view && sees_day).then_some(shadow)
    }

    /// How far inside the limb the outline of the ground may be, radii: for terrain the depth of the sea, for blocks the depth of a facet's middle
    /// below the ellipsoid.
    fn short_of_limb(&self) -> f64 {
        const DEEPEST: f64 = 2e-3;
        match self.ground {
            Some(_) => DEEPEST,
            None => sagitta(self.meshes.grid().subdivision()),
        }
    }

    /// Selects the mesh and the blocks of the smooth ellipsoid.
    fn plan_blocks(&mut self, view: &ItrfView, plan: &mut FramePlan, stats: &mut FrameStats) {
        let height_m = stats.eye.height_m;
        let is_above_air = self.has_air && height_m > THICKNESS_M;
        let least_cells = match self.interpolates && is_above_air {
            true => interpolated_cells(height_m),
            false => 0,
        };
        plan.mesh = self
            .meshes
            .select_lod(height_m, view.pixel_rad(), least_cells);
        let grid = self.meshes.grid();
        let selection = select_blocks(
            grid,
            self.visibility,
            view.eye_itrf_m,
            &view.clip_from_eye,
            &mut plan.blocks,
        );
        plan.place_vertices(grid);
        stats.subdivision = grid.subdivision();
        stats.blocks_visible = selection.visible;
    }

    /// Inputs of tile selection for a view.
    pub fn tile_view(&self, view: &ItrfView, sky: &Sky) -> TileView {
        let (moon_itrf, moon_light) = sky.moonlight();
        TileView {
            eye_itrf_m: view.eye_itrf_m,
            sun_itrf: sky.sun_itrf,
            moon_itrf: (self.light.moon_gain() * moon_light > 0.0).then_some(moon_itrf),
            pixel_rad: view.pixel_rad(),
            clip_from_eye: view.clip_from_eye,
        }
    }

    /// Texels per pixel of the whole map at the nearest of these blocks; 0 without any.
    fn whole_texels_per_pixel(&self, view: &ItrfView, blocks: &[Block]) -> f64 {
        let grid = self.meshes.grid();
        let distances = blocks.iter();
        let distances = distances.map(|block| grid.distance_m(*block, view.eye_itrf_m));
        let nearest_m = distances.fold(f64::INFINITY, f64::min);
        if !nearest_m.is_finite() {
            return 0.0;
        }
        let radius_m = grid.ellipsoid().equatorial_radius_m;
        texels_per_pixel(self.whole_day_pixels, radius_m, nearest_m, view.pixel_rad())
    }
}

/// Meshes for a subdivision setting, for an Earth with tiles or without.
pub(super) fn meshes(
    ellipsoid: Ellipsoid,
    subdivision: Subdivision,
    has_tiles: bool,
) -> Result<Meshes, SubdivisionError> {
    let least = if has_tiles { TILED_SUBDIVISION } else { 1 };
    Meshes::new(ellipsoid, subdivision, least)
}

#[cfg(test)]
mod tests;
