//! The drawable of the surface: blocks of a lattice, patches of terrain, a projected grid, or ray-cast pages, one indexed draw each. This file has
//! the part that all views share; `surface_view.rs` has that of one view.

use super::city_lights::CityPoints;
use super::detail_tiles::DetailTiles;
use super::maps::Maps;
use super::mesh::{MeshForm, SurfaceMesh};
use super::pass_kind::PassKind;
use super::shader::{EarthVariant, ShaderVariant};
use super::situation::Situation;
use super::surface_config::SurfaceConfig;
use super::surface_pipelines::{
    SurfaceMaker, SurfacePipelines, frame_entry, light_entry, reads_detail_tiles, reads_light,
    tiles_entry,
};
use super::surface_view::SurfaceView;
use super::tiles::TileTextures;
use super::{Binding, ErrorScope, GpuMap, MapError, ShaderError, UploadedMaps};
use crate::plan::{ChosenTiles, DrawLight, FramePlan, LIMB_SEGMENTS, SurfaceLightUniforms};
use std::sync::Arc;
use terrella_ground::globe::{BlockSet, Shading};
use terrella_imagery::residency::{Pool, Upload};
use terrella_imagery::tile::MapLayer;
use terrella_imagery::{CityLights, EarthLayers};

pub(crate) struct SurfaceDrawable {
    pipelines: SurfacePipelines,
    maps: Maps,
    imagery: Imagery,
    /// Settings of the surface's light for the shader, the same for all frames and views.
    light: wgpu::Buffer,
    /// Present if a pipeline reads it.
    detail_tiles: Option<DetailTiles>,
    /// City lights as points, in place of their map.
    city_lights: Option<CityPoints>,
    texture_bytes: u64,
}

/// Whether blocks with tiles may be cut into parts.
fn has_parts(pools: Option<&[Pool]>) -> bool {
    pools.is_some_and(|pools| pools.iter().any(|pool| pool.has_parts))
}

/// Imagery of the blocks.
enum Imagery {
    /// Whole maps for all blocks.
    Whole(wgpu::BindGroup),
    Tiles {
        tiles: TileTextures,
        /// Whole maps, for triangles that span several blocks or lie in a block without tiles.
        whole: wgpu::BindGroup,
    },
}

impl SurfaceDrawable {
    /// Uploads the maps; creates no pipeline yet. `pools` are those of the tiles, if there are tiles; `first` is a view of the surface.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        maps: (&EarthLayers, &UploadedMaps),
        pools: Option<&[Pool]>,
        config: &SurfaceConfig<'_>,
        first: &mut SurfaceView,
    ) -> Self {
        let display_values = config.shading == Shading::Paper;
        let maps = Maps::upload(
            device,
            queue,
            maps,
            display_values,
            config.shown,
            config.anisotropy,
            has_parts(pools),
        );
        let imagery = match pools {
            Some(pools) => Imagery::Tiles {
                tiles: TileTextures::new(device, &maps, pools, display_values),
                whole: maps.bind_whole(device),
            },
            None => Imagery::Whole(maps.bind_whole(device)),
        };
        let tile_bytes = match &imagery {
            Imagery::Tiles { tiles, .. } => tiles.bytes,
            Imagery::Whole(_) => 0,
        };
        let texture_bytes = maps.bytes() + tile_bytes;
        let light = super::uniform_buffer::<SurfaceLightUniforms>(device, "terrella surface light");
        queue.write_buffer(&light, 0, bytemuck::bytes_of(&config.light_uniforms()));
        let maker = SurfaceMaker {
            mesh: MeshForm::of(first.mesh(), pools.is_some()),
            maps: maps.there(),
            has_tiles: pools.is_some(),
            has_parts: has_parts(pools),
        };
        let pipelines = maker.plan(device, config);
        let detail_tiles = pipelines
            .read_detail_tiles()
            .then(|| DetailTiles::upload(device, queue));
        let drawable = Self {
            pipelines,
            maps,
            imagery,
            light,
            detail_tiles,
            city_lights: None,
            texture_bytes,
        };
        drawable.bind_view(first);
        drawable
    }

    /// Uses these city lights from now on, for pipelines that draw them.
    pub fn set_city_lights(&mut self, lights: Arc<CityLights>) {
        self.city_lights = Some(CityPoints::new(lights));
    }

    /// Bytes of all its textures.
    pub fn texture_bytes(&self) -> u64 {
        let detail = self.detail_tiles.as_ref().map_or(0, DetailTiles::bytes);
        self.texture_bytes + detail
    }

    /// A maker of further pipelines for this surface, for the mesh of this view.
    pub fn maker(&self, view: &SurfaceView) -> SurfaceMaker {
        let has_tiles = matches!(self.imagery, Imagery::Tiles { .. });
        SurfaceMaker {
            mesh: MeshForm::of(view.mesh(), has_tiles),
            maps: self.maps.there(),
            has_tiles,
            has_parts: match &self.imagery {
                Imagery::Tiles { tiles, .. } => tiles.has_parts(),
                Imagery::Whole(_) => false,
            },
        }
    }

    /// Uses these pipelines, which were made for this configuration, from now on, and binds this view for them. Other views must be bound before
    /// they are drawn. Maps and tiles stay in place.
    ///
    /// Nothing may be drawn until the next frame is written.
    pub fn set_pipelines(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: SurfacePipelines,
        config: &SurfaceConfig<'_>,
        first: &mut SurfaceView,
    ) {
        queue.write_buffer(&self.light, 0, bytemuck::bytes_of(&config.light_uniforms()));
        self.maps.arrange(pipelines.maps.clone());
        self.detail_tiles = pipelines.read_detail_tiles().then(|| {
            let before = self.detail_tiles.take();
            before.unwrap_or_else(|| DetailTiles::upload(device, queue))
        });
        self.pipelines = pipelines;
        self.bind_maps(device);
        self.bind_view(first);
    }

    /// Replaces a whole map from now on. Returns the previous one.
    ///
    /// # Errors
    /// A map that does not exist, or that is drawn with tiles.
    pub fn set_map(&mut self, device: &wgpu::Device, map: &GpuMap) -> Result<GpuMap, MapError> {
        let layer = map.layer();
        if !self.maps.there()[layer.index()] {
            return Err(MapError::NotDrawn(layer.name()));
        }
        if layer == MapLayer::NightLights && self.pipelines.draws(PassKind::CityLights) {
            return Err(MapError::AsPoints);
        }
        if let Imagery::Tiles { tiles, .. } = &self.imagery
            && tiles.has(layer)
        {
            return Err(MapError::Tiled(layer.name()));
        }
        self.texture_bytes -= self.maps.bytes();
        let before = self.maps.replace(layer, map.held.clone());
        self.texture_bytes += self.maps.bytes();
        self.bind_maps(device);
        Ok(GpuMap::of_layer(layer, before))
    }

    fn bind_maps(&mut self, device: &wgpu::Device) {
        match &mut self.imagery {
            Imagery::Tiles { tiles, whole } => {
                tiles.bind_again(device, &self.maps);
                *whole = self.maps.bind_whole(device);
            }
            Imagery::Whole(bind_group) => *bind_group = self.maps.bind_whole(device),
        }
    }

    /// Binds a view again, for the existing pipelines.
    pub fn bind_view(&self, view: &mut SurfaceView) {
        view.unbind(self.pipelines.sides());
    }

    /// Creates all pipelines, so that no frame waits for one.
    pub fn make_all(
        &mut self,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        view: &SurfaceView,
    ) -> Result<(), ShaderError> {
        if let Some(lights) = &mut self.city_lights {
            lights.make_all(device);
        }
        let maker = self.maker(view);
        self.pipelines.make_all(&maker, device, config)
    }

    /// What the choice of a plan's pipelines depends on.
    fn situation(&self, plan: &FramePlan) -> Situation {
        self.pipelines.situation(plan, self.maps.largest_texel())
    }

    /// Whether the pipelines of a plan are created and bound.
    pub fn is_ready(&self, view: &SurfaceView, plan: &FramePlan) -> bool {
        let at = self.situation(plan);
        let lights = plan.draws.iter().map(|draw| draw.light);
        let kinds = lights.map(|light| self.pipelines.kind_of(at, light, plan.has_moon_shadow));
        let city_lights = self.city_lights_of(at, plan);
        let points = self.city_lights.as_ref().filter(|_| city_lights.is_some());
        if !points.is_none_or(|points| points.are_ready(&plan.city_lights)) {
            return false;
        }
        let clouds = self.clouds_beside_ground(at, plan).into_iter().flatten();
        let mut kinds = kinds.chain(city_lights).chain(clouds);
        kinds.all(|kind| self.pipelines.pass(at, kind).is_some() && view.group(at, kind).is_some())
    }

    /// The kind of draw for a plan's city lights, if it has any.
    fn city_lights_of(&self, at: Situation, plan: &FramePlan) -> Option<PassKind> {
        let kind = PassKind::CityLights;
        let is_drawn = !plan.city_lights.is_empty()
            && self.city_lights.is_some()
            && self.pipelines.has(at, kind);
        is_drawn.then_some(kind)
    }

    /// The kinds of draws for a plan's clouds beside the ground: those in the sky or at the limb, and those around the eye.
    fn clouds_beside_ground(&self, at: Situation, plan: &FramePlan) -> [Option<PassKind>; 2] {
        let in_sky = match plan {
            plan if plan.is_below_clouds => Some(PassKind::CloudsOverhead),
            plan if !plan.has_clouds_at_limb => None,
            plan if plan.has_moon_shadow => Some(PassKind::EclipsedCloudsAtLimb),
            _ => Some(PassKind::CloudsAtLimb),
        };
        let around = plan.has_clouds_around.then_some(PassKind::CloudsAround);
        [in_sky, around].map(|kind| {
            let kinds = [kind, kind.and_then(PassKind::instead)];
            let mut kinds = kinds.into_iter().flatten();
            kinds.find(|kind| self.pipelines.has(at, *kind))
        })
    }

    /// Creates and binds the missing pipelines of a plan.
    pub fn make_ready(
        &mut self,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        view: &mut SurfaceView,
        plan: &FramePlan,
    ) -> Result<(), ShaderError> {
        let at = self.situation(plan);
        let kinds = DrawLight::ALL.into_iter().filter(|light| {
            let mut draws = plan.draws.iter();
            draws.any(|draw| draw.light == *light)
        });
        let kinds = kinds.map(|light| self.pipelines.kind_of(at, light, plan.has_moon_shadow));
        let city_lights = self.city_lights_of(at, plan);
        if let Some(points) = self.city_lights.as_mut().filter(|_| city_lights.is_some()) {
            points.make_ready(device, &plan.city_lights);
        }
        let kinds = kinds.chain(city_lights);
        let wanted: Vec<_> = kinds
            .chain(self.clouds_beside_ground(at, plan).into_iter().flatten())
            .collect();
        let maker = self.maker(view);
        let missing = wanted.iter().map(|kind| (at, *kind));
        self.pipelines
            .make_passes(&maker, device, config, missing)?;
        for kind in wanted {
            self.bind_pass(device, config, view, (at, kind));
        }
        Ok(())
    }

    /// Whether there is a pipeline that makes a plan faster and is not created.
    pub fn has_next(&self, plan: &FramePlan) -> bool {
        self.next_kind(plan).is_some()
    }

    fn next_kind(&self, plan: &FramePlan) -> Option<PassKind> {
        let at = self.situation(plan);
        let mut lights = plan.draws.iter().map(|draw| draw.light);
        lights.find_map(|light| {
            let best = self.pipelines.best_kind_of(at, light, plan.has_moon_shadow);
            self.pipelines.pass(at, best).is_none().then_some(best)
        })
    }

    /// Creates and binds it, if there is one. Returns the error of a device that rejects it: then it is not tried again.
    pub fn make_next(
        &mut self,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        view: &mut SurfaceView,
        plan: &FramePlan,
    ) -> Result<Option<wgpu::Error>, ShaderError> {
        let Some(kind) = self.next_kind(plan) else {
            return Ok(None);
        };
        let (at, maker) = (self.situation(plan), self.maker(view));
        let scope = ErrorScope::open(device, wgpu::ErrorFilter::Validation);
        let made = self.pipelines.make_pass(&maker, device, config, (at, kind));
        let rejected = scope.error();
        made?;
        match &rejected {
            Some(_) => self.pipelines.give_up((at, kind)),
            None => self.bind_pass(device, config, view, (at, kind)),
        }
        Ok(rejected)
    }

    /// Binds a pass that was created.
    fn bind_pass(
        &self,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        view: &mut SurfaceView,
        (at, kind): (Situation, PassKind),
    ) {
        if let Some(pass) = self.pipelines.pass(at, kind)
            && view.group(at, kind).is_none()
        {
            let bindings = self.bindings(view, config, &pass.variant);
            let group = super::bind_to(device, "terrella earth", &pass.layout, bindings);
            view.set_group(at, kind, group);
        }
    }

    /// Names of the features of the surface's shaders.
    pub fn features(&self) -> Vec<&'static str> {
        let mut features = Vec::new();
        for (kind, variant) in self.pipelines.variants() {
            match kind {
                PassKind::Everything => features.extend(variant.conditions_met()),
                PassKind::Eclipsed => features.push("eclipses"),
                PassKind::CityLights => features.push(MapLayer::NightLights.name()),
                _ => {}
            }
        }
        features
    }

    /// Total length of the WGSL that the driver gets, bytes.
    pub fn shader_bytes(&self) -> u64 {
        self.pipelines.shader_bytes()
    }

    /// Writes a part of a tile; does nothing where whole maps are drawn.
    pub fn write_tile(&self, queue: &wgpu::Queue, part: &Upload<'_>) {
        if let Imagery::Tiles { tiles, .. } = &self.imagery {
            tiles.write(queue, part);
        }
    }

    /// Uses these tiles for blocks from now on. `tiled` has the blocks with tiles, if triangles span several blocks. Returns the bytes written.
    pub fn choose_tiles(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        chosen: &ChosenTiles,
        tiled: Option<BlockSet>,
    ) -> u64 {
        let Imagery::Tiles { tiles, .. } = &mut self.imagery else {
            return 0;
        };
        for (block, chosen) in &chosen.blocks {
            tiles.choose(device, &self.maps, *block, *chosen);
        }
        tiles.place_parts(&chosen.parts);
        if let Some(tiled) = tiled {
            tiles.set_tiled(tiled);
        }
        tiles.flush(queue)
    }

    /// Draws the plan that was last written to a view. Parts whose pipelines failed are not drawn.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>, view: &SurfaceView, plan: &FramePlan) {
        if !self.is_ready(view, plan) {
            return;
        }
        let at = self.situation(plan);
        let mut chosen = None;
        let mut by_light = |pass: &mut wgpu::RenderPass<'_>, light: DrawLight| {
            if chosen == Some(light) {
                return;
            }
            chosen = Some(light);
            let kind = self.pipelines.kind_of(at, light, plan.has_moon_shadow);
            let drawn = self.pipelines.pass(at, kind);
            if let Some((drawn, group)) = drawn.zip(view.group(at, kind)) {
                pass.set_pipeline(&drawn.pipeline);
                pass.set_bind_group(0, group, &[]);
            }
        };
        let mesh: &dyn SurfaceMesh = view.mesh();
        match &self.imagery {
            Imagery::Whole(maps) => {
                pass.set_bind_group(1, maps, &[]);
                mesh.render(pass, plan, &mut |pass, draw| by_light(pass, draw.light));
                self.render_city_lights(pass, at, view, plan);
            }
            Imagery::Tiles { tiles, whole } => mesh.render(pass, plan, &mut |pass, draw| {
                by_light(pass, draw.light);
                let maps = draw.block.map_or(whole, |block| tiles.bind_group(block));
                pass.set_bind_group(1, maps, &[]);
            }),
        }
    }

    /// Draws the clouds overhead of the plan that was last written to a view, over the sky, and those around the eye, over everything.
    pub fn render_clouds_overhead(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        view: &SurfaceView,
        plan: &FramePlan,
    ) {
        self.render_clouds(pass, view, plan, |kind| !kind.is_at_limb());
    }

    /// Draws the clouds above the edge of the ground, over the air.
    pub fn render_clouds_at_limb(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        view: &SurfaceView,
        plan: &FramePlan,
    ) {
        self.render_clouds(pass, view, plan, PassKind::is_at_limb);
    }

    fn render_clouds(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        view: &SurfaceView,
        plan: &FramePlan,
        is_drawn: fn(PassKind) -> bool,
    ) {
        let at = self.situation(plan);
        let kinds = self.clouds_beside_ground(at, plan).into_iter().flatten();
        for kind in kinds.filter(|kind| is_drawn(*kind)) {
            let group = view.group(at, kind);
            let Some((drawn, group)) = self.pipelines.pass(at, kind).zip(group) else {
                continue;
            };
            let (Imagery::Whole(maps) | Imagery::Tiles { whole: maps, .. }) = &self.imagery;
            pass.set_pipeline(&drawn.pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.set_bind_group(1, maps, &[]);
            let vertices = match kind.is_at_limb() {
                true => 6 * LIMB_SEGMENTS,
                false => 3,
            };
            pass.draw(0..vertices, 0..1);
        }
    }

    /// Draws city lights over the surface; the whole maps are bound.
    fn render_city_lights(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        at: Situation,
        view: &SurfaceView,
        plan: &FramePlan,
    ) {
        let drawn = self.city_lights_of(at, plan).and_then(|kind| {
            let pass = self.pipelines.pass(at, kind)?;
            Some((pass, view.group(at, kind)?, self.city_lights.as_ref()?))
        });
        if let Some((drawn, group, points)) = drawn {
            pass.set_pipeline(&drawn.pipeline);
            pass.set_bind_group(0, group, &[]);
            points.draw(pass, &plan.city_lights);
        }
    }

    /// Group 0 of a view.
    fn bindings<'a>(
        &'a self,
        view: &'a SurfaceView,
        config: &SurfaceConfig<'a>,
        variant: &EarthVariant,
    ) -> Vec<Binding<'a>> {
        let bound = |binding, buffer: &'a wgpu::Buffer| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        };
        let mut bindings = vec![(frame_entry(), bound(0, view.uniforms()))];
        if let Some((air, side)) = config.air.zip(variant.air()) {
            bindings.extend(air.bindings(side));
            if config.shading == Shading::Sunlit {
                bindings.push(air.sunlight_binding());
            }
        }
        if let Imagery::Tiles { tiles, .. } = &self.imagery {
            bindings.push((tiles_entry(tiles.has_parts()), bound(3, tiles.placements())));
        }
        if reads_light(variant) {
            bindings.push((light_entry(), bound(12, &self.light)));
        }
        if let Some(detail) = self
            .detail_tiles
            .as_ref()
            .filter(|_| reads_detail_tiles(variant))
        {
            bindings.extend(detail.bindings());
        }
        bindings.extend(view.mesh().bindings());
        bindings
    }
}
