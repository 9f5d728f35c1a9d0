//! The drawable of the surface: blocks of a lattice, patches of ground with relief, a grid, or pages that rays are cast at, one
//! indexed draw each. What all views share stands here, what each has of its own in `surface_view.rs`.

use super::maps::Maps;
use super::mesh::{MeshForm, SurfaceMesh};
use super::shader::{EarthVariant, ShaderVariant};
use super::surface_config::SurfaceConfig;
use super::surface_pipelines::{
    SurfaceMaker, SurfacePass, SurfacePipelines, frame_entry, light_entry, reads_light, tiles_entry,
};
use super::surface_view::{PassGroups, SurfaceView};
use super::tiles::TileTextures;
use super::{Binding, GpuMap, MapError, ShaderError};
use crate::plan::{ChosenTiles, DrawLight, FramePlan, SurfaceLightUniforms};
use terrella_ground::globe::{BlockSet, Shading};
use terrella_imagery::EarthLayers;
use terrella_imagery::residency::{Pool, Upload};

pub(crate) struct SurfaceDrawable {
    pipelines: SurfacePipelines,
    maps: Maps,
    imagery: Imagery,
    /// What the shader is told of the surface's light, whatever frame and view.
    light: wgpu::Buffer,
    pub texture_bytes: u64,
}

/// Whether blocks with tiles may be cut into parts.
fn has_parts(pools: Option<&[Pool]>) -> bool {
    pools.is_some_and(|pools| pools.iter().any(|pool| pool.has_parts))
}

/// What blocks are drawn with.
enum Imagery {
    /// All with the whole maps.
    Whole(wgpu::BindGroup),
    Tiles {
        tiles: TileTextures,
        /// All maps whole, for what lies in several blocks or in one without tiles.
        whole: wgpu::BindGroup,
    },
}

/// The place of what a plan is drawn with among [`SurfacePipelines::passes`].
fn side_of(plan: &FramePlan) -> usize {
    plan.air.as_ref().map_or(0, |air| air.side() as usize)
}

impl SurfaceDrawable {
    /// Uploads the maps. `pools` are those of tiles, if blocks are drawn with tiles; `first` is a view of it, which is bound.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layers: &EarthLayers,
        pools: Option<&[Pool]>,
        config: &SurfaceConfig<'_>,
        first: &mut SurfaceView,
    ) -> Result<Self, ShaderError> {
        let display_values = config.shading == Shading::Paper;
        let maps = Maps::upload(
            device,
            queue,
            layers,
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
        let drawable = Self {
            pipelines: maker.make(device, config)?,
            maps,
            imagery,
            light,
            texture_bytes,
        };
        drawable.bind_view(device, config, first);
        Ok(drawable)
    }

    /// What makes other pipelines for it, of the form of this view.
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

    /// Draws from now on with these pipelines, which were made for this configuration, and binds this view for them; others have to be
    /// bound before they are drawn. Maps and tiles stay where they are.
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
        self.pipelines = pipelines;
        self.bind_maps(device);
        self.bind_view(device, config, first);
    }

    /// Draws with another whole map from now on. Answers the one before.
    ///
    /// # Errors
    /// A map that there is none of, or that is drawn with tiles.
    pub fn set_map(&mut self, device: &wgpu::Device, map: &GpuMap) -> Result<GpuMap, MapError> {
        let layer = map.layer();
        if !self.maps.there()[layer.index()] {
            return Err(MapError::NotDrawn(layer.name()));
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

    /// Binds what a view is drawn with.
    pub fn bind_view(
        &self,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        view: &mut SurfaceView,
    ) {
        let group = |pass: &SurfacePass| {
            let bindings = self.bindings(view, config, &pass.variant);
            super::bind_to(device, "terrella earth", &pass.layout, bindings)
        };
        let passes = self.pipelines.passes.iter();
        let groups = passes.map(|passes| PassGroups {
            all: group(&passes.all),
            daylit: passes.daylit.as_ref().map(group),
            eclipsed: passes.eclipsed.as_ref().map(group),
            interpolated: passes.interpolated.as_ref().map(group),
            land: passes.land.as_ref().map(group),
            open_sea: passes.open_sea.as_ref().map(group),
        });
        let groups = groups.collect();
        view.set_groups(groups);
    }

    /// Makes ready what draws a frame that the Moon's shadow is in. Without it such a frame is drawn as others.
    pub fn prepare_eclipse(
        &mut self,
        device: &wgpu::Device,
        config: &SurfaceConfig<'_>,
        view: &mut SurfaceView,
        plan: &FramePlan,
    ) -> Result<(), ShaderError> {
        let side = side_of(plan);
        let maker = self.maker(view);
        self.pipelines.make_eclipsed(&maker, device, config, side)?;
        let passes = self.pipelines.passes.get(side);
        if let Some(pass) = passes.and_then(|passes| passes.eclipsed.as_ref())
            && view
                .groups(side)
                .is_some_and(|groups| groups.eclipsed.is_none())
        {
            let bindings = self.bindings(view, config, &pass.variant);
            let group = super::bind_to(device, "terrella earth", &pass.layout, bindings);
            view.set_eclipsed(side, group);
        }
        Ok(())
    }

    /// What shaders of the surface have.
    pub fn features(&self) -> Vec<&'static str> {
        let Some(first) = self.pipelines.passes.first() else {
            return Vec::new();
        };
        let mut features = first.all.variant.conditions_met();
        features.extend(first.eclipsed_variant.map(|_| "eclipses"));
        features
    }

    /// Bytes of their texts as the driver gets them.
    pub fn shader_bytes(&self) -> u64 {
        self.pipelines.shader_bytes
    }

    /// Writes a part of a tile; does nothing where whole maps are drawn.
    pub fn write_tile(&self, queue: &wgpu::Queue, part: &Upload<'_>) {
        if let Imagery::Tiles { tiles, .. } = &self.imagery {
            tiles.write(queue, part);
        }
    }

    /// Has blocks drawn from now on with these tiles. `tiled` are those that have any, where triangles lie in several. Answers the bytes
    /// written.
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

    /// Draws the plan that was written to a view last.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>, view: &SurfaceView, plan: &FramePlan) {
        let side = side_of(plan);
        let Some((passes, groups)) = self.pipelines.passes.get(side).zip(view.groups(side)) else {
            return;
        };
        let all = (&passes.all, &groups.all);
        let eclipsed = passes.eclipsed.as_ref().zip(groups.eclipsed.as_ref());
        let eclipsed = eclipsed.filter(|_| plan.has_moon_shadow);
        let daylit = passes.daylit.as_ref().zip(groups.daylit.as_ref());
        let interpolated = passes.interpolated.as_ref();
        let interpolated = interpolated.zip(groups.interpolated.as_ref());
        let by_day = daylit.unwrap_or(all);
        let interpolated = interpolated.unwrap_or(by_day);
        let land = passes.land.as_ref().zip(groups.land.as_ref());
        let sea = passes.open_sea.as_ref().zip(groups.open_sea.as_ref());
        let (land, sea) = (land.unwrap_or(interpolated), sea.unwrap_or(interpolated));
        // In the order of their lights.
        let drawn = match eclipsed {
            Some(eclipsed) => [eclipsed; DrawLight::ALL.len()],
            None => [all, by_day, interpolated, land, sea],
        };
        let mut chosen = None;
        let mut by_light = |pass: &mut wgpu::RenderPass<'_>, light: DrawLight| {
            if chosen != Some(light) {
                chosen = Some(light);
                let (drawn, group) = drawn[light as usize];
                pass.set_pipeline(&drawn.pipeline);
                pass.set_bind_group(0, group, &[]);
            }
        };
        let mesh: &dyn SurfaceMesh = view.mesh();
        match &self.imagery {
            Imagery::Whole(maps) => {
                pass.set_bind_group(1, maps, &[]);
                mesh.render(pass, plan, &mut |pass, draw| by_light(pass, draw.light));
            }
            Imagery::Tiles { tiles, whole } => mesh.render(pass, plan, &mut |pass, draw| {
                by_light(pass, draw.light);
                let maps = draw.block.map_or(whole, |block| tiles.bind_group(block));
                pass.set_bind_group(1, maps, &[]);
            }),
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
        bindings.extend(view.mesh().bindings());
        bindings
    }
}
