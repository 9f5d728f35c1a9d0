//! Prepares another quality or appearance on any thread while the Earth is drawn.

use super::creation::air_textures;
use super::earth_view::Version;
use super::ground::GroundDriver;
use super::surface_config::{SurfaceStyle, surface_config};
use super::{Appearance, Earth, EarthError, EyeView, Pipelines, Quality, Viewport};
use crate::gpu::{
    AirDrawable, AirTextures, ErrorScope, PassFormat, SurfaceConfig, SurfaceMaker, SurfaceOutput,
    SurfacePipelines, SurfaceView, device_limits,
};
use std::sync::Arc;
use std::time::Duration;
use terrella_files::clock::Instant;
use terrella_ground::air::Atmosphere;
use terrella_ground::globe::{BLOCK_COUNT, Figure, Meshes};
use terrella_imagery::{CityLights, NeighbourhoodAlbedo};

/// Prepares other qualities and appearances of one Earth, on any thread: [`Earth::change_maker`].
///
/// ```no_run
/// # fn frame(earth: &mut terrella::Earth, queue: &terrella::wgpu::Queue, wanted: terrella::Quality) -> Result<(), terrella::EarthError> {
/// let maker = earth.change_maker(queue);
/// let making = std::thread::spawn(move || maker.quality(&wanted));
/// // Frames go on as before, until `making.is_finished()`.
/// let ready = making.join().expect("it does not panic")?;
/// earth.set_ready(queue, ready)
/// # }
/// ```
#[derive(Clone)]
pub struct ChangeMaker {
    device: wgpu::Device,
    queue: wgpu::Queue,
    surface: SurfaceMaker,
    /// The existing textures; `None` if the Earth was made without air.
    air: Option<AirTextures>,
    albedo: Arc<NeighbourhoodAlbedo>,
    style: SurfaceStyle,
    appearance: Appearance,
    quality: Quality,
    format: PassFormat,
    figure: Figure,
    has_tiles: bool,
    version: Version,
}

/// All resources for drawing an Earth with another quality or appearance: [`Earth::set_ready`].
pub struct ReadyChange {
    quality: Quality,
    appearance: Appearance,
    format: PassFormat,
    meshes: Meshes,
    ground: ReadyGround,
    air: ReadyAir,
    surface: SurfacePipelines,
    version: Version,
}

/// The air after a change.
enum ReadyAir {
    None,
    Kept,
    Made(Box<AirDrawable>),
}

/// The ground after a change.
enum ReadyGround {
    Kept,
    Made(Box<MadeGround>),
}

struct MadeGround {
    /// `None` for the smooth ellipsoid.
    driver: Option<GroundDriver>,
    view: SurfaceView,
}

impl ReadyChange {
    /// The quality after the change.
    pub fn quality(&self) -> &Quality {
        &self.quality
    }

    /// The appearance after the change.
    pub fn appearance(&self) -> &Appearance {
        &self.appearance
    }

    /// Refines changed terrain for an eye before it is drawn, for at most `timeout`. Without this call such terrain starts coarse, as after a jump
    /// of the eye. Returns whether it is fully refined; terrain that the change does not affect counts as refined.
    pub fn settle(
        &mut self,
        view: &EyeView,
        target: impl Into<Viewport>,
        timeout: Duration,
    ) -> bool {
        let (ReadyGround::Made(made), Ok(view)) = (&mut self.ground, view.in_itrf(target.into()))
        else {
            return true;
        };
        let Some(driver) = &mut made.driver else {
            return true;
        };
        let deadline = Instant::now() + timeout;
        let mut blocks = Vec::with_capacity(BLOCK_COUNT as usize);
        while !driver.is_settled() && Instant::now() < deadline {
            blocks.clear();
            driver.take_over(true);
            driver.plan(self.meshes.grid(), &view, &mut blocks);
            // Wait only if nothing else is left to do.
            if !driver.is_settled() {
                driver.wait(Duration::from_millis(1));
            }
        }
        driver.is_settled()
    }
}

impl ChangeMaker {
    /// Makes pipelines and meshes for a quality. It takes tens of milliseconds, and much more with drivers that compile slowly.
    ///
    /// # Errors
    /// As [`Earth::new`].
    pub fn quality(&self, quality: &Quality) -> Result<ReadyChange, EarthError> {
        self.make(quality, &self.appearance)
    }

    /// Makes pipelines for an appearance and the tables of changed air, which take most of a second.
    ///
    /// # Errors
    /// As [`Earth::new`].
    pub fn appearance(&self, appearance: &Appearance) -> Result<ReadyChange, EarthError> {
        appearance.check()?;
        self.make(&self.quality, appearance)
    }

    fn make(&self, quality: &Quality, appearance: &Appearance) -> Result<ReadyChange, EarthError> {
        let mut quality = *quality;
        if !Quality::SCALES.contains(&quality.scale) {
            return Err(EarthError::Scale(quality.scale));
        }
        if self.style.diagnostics.output != SurfaceOutput::Color {
            quality.atmosphere = Atmosphere::None;
        }
        let style = SurfaceStyle {
            light: appearance.light,
            ..self.style
        };
        let ellipsoid = self.figure.ellipsoid();
        let meshes = super::plan::meshes(ellipsoid, quality.subdivision, self.has_tiles)?;
        let format = PassFormat {
            samples: quality.samples,
            ..self.format
        };
        let device = &self.device;
        let scope = ErrorScope::open(device, wgpu::ErrorFilter::Validation);
        let air = self.make_air(&quality, appearance, format)?;
        let textures = match &air {
            ReadyAir::None => None,
            ReadyAir::Kept => self.air.as_ref(),
            ReadyAir::Made(air) => Some(air.textures()),
        };
        let (ground, surface) = if appearance.has_ground_of(&self.appearance) {
            let config = surface_config(device, style, format, &quality, textures, None);
            let pipelines = self.pipelines(&self.surface, &config)?;
            (ReadyGround::Kept, pipelines)
        } else {
            let driver = appearance.ground.as_ref();
            let limits = device_limits(&device.limits());
            let driver = driver.map(|ground| GroundDriver::new(ground, self.figure, &limits));
            let driver = driver.transpose()?;
            if style.diagnostics.wireframe && driver.as_ref().is_some_and(|d| !d.has_edges()) {
                return Err(EarthError::NoEdges);
            }
            let drawn = driver.as_ref().map(GroundDriver::surface);
            let config = surface_config(device, style, format, &quality, textures, drawn);
            let view = SurfaceView::new(device, meshes.grids(), &config);
            let pipelines = self.pipelines(&self.surface.for_view(&view), &config)?;
            let made = Box::new(MadeGround { driver, view });
            (ReadyGround::Made(made), pipelines)
        };
        if let Some(error) = scope.error() {
            return Err(EarthError::rejected(error));
        }
        Ok(ReadyChange {
            quality,
            appearance: appearance.clone(),
            format,
            meshes,
            ground,
            air,
            surface,
            version: self.version,
        })
    }

    /// Pipelines of the surface, created now or on first use.
    fn pipelines(
        &self,
        maker: &SurfaceMaker,
        config: &SurfaceConfig<'_>,
    ) -> Result<SurfacePipelines, EarthError> {
        let mut pipelines = maker.plan(&self.device, config);
        match self.style.pipelines {
            Pipelines::AtOnce => pipelines.make_all(maker, &self.device, config)?,
            // An error of the device appears here and not in the middle of a frame.
            Pipelines::WhenNeeded | Pipelines::Gradually => {
                pipelines.make_one(maker, &self.device, config)?;
            }
        }
        Ok(pipelines)
    }

    fn make_air(
        &self,
        quality: &Quality,
        appearance: &Appearance,
        format: PassFormat,
    ) -> Result<ReadyAir, EarthError> {
        let has_textures = appearance.has_air_textures_of(&self.appearance);
        let light = &appearance.light;
        let fits = quality.samples == self.format.samples
            && has_textures
            && light.has_air_of(&self.appearance.light);
        Ok(match (quality.atmosphere, &self.air) {
            (Atmosphere::None, _) => ReadyAir::None,
            (Atmosphere::Billboard, Some(_)) if fits => ReadyAir::Kept,
            (Atmosphere::Billboard, before) => {
                let before = before.clone().filter(|_| has_textures);
                let textures = before.unwrap_or_else(|| {
                    air_textures(&self.device, &self.queue, appearance, &self.albedo, quality)
                });
                let mut air = AirDrawable::new(&self.device, format, textures, light);
                if self.style.pipelines == Pipelines::AtOnce {
                    air.make_all(&self.device)?;
                }
                ReadyAir::Made(Box::new(air))
            }
        })
    }
}

impl Earth {
    /// The quality that it is drawn with.
    pub fn quality(&self) -> &Quality {
        &self.quality
    }

    /// The terrain, light and air that it is drawn with.
    pub fn appearance(&self) -> &Appearance {
        &self.appearance
    }

    /// Draws with another quality from the next [`Self::prepare`] on. Maps and tiles stay on the GPU. Pipelines and the lattice are made again,
    /// which takes longer than a frame: [`Self::change_maker`] does it on another thread.
    ///
    /// # Errors
    /// As [`Self::new`]. The Earth is then unchanged.
    pub fn set_quality(
        &mut self,
        queue: &wgpu::Queue,
        quality: &Quality,
    ) -> Result<(), EarthError> {
        let ready = self.change_maker(queue).quality(quality)?;
        self.set_ready(queue, ready)
    }

    /// Draws with other terrain, light or air from the next [`Self::prepare`] on, as [`Self::set_quality`] does: maps and tiles stay on the GPU.
    ///
    /// # Errors
    /// As [`Self::new`]. The Earth is then unchanged.
    pub fn set_appearance(
        &mut self,
        queue: &wgpu::Queue,
        appearance: &Appearance,
    ) -> Result<(), EarthError> {
        let ready = self.change_maker(queue).appearance(appearance)?;
        self.set_ready(queue, ready)
    }

    /// Draws these city lights as points from the next [`Self::prepare`] on, in all views, as if the Earth had been made with
    /// [`EarthOptions::city_lights`](super::EarthOptions::city_lights). Pipelines are made again, as by [`Self::set_appearance`].
    ///
    /// # Errors
    /// As [`Self::new`]. The Earth is then unchanged.
    pub fn set_city_lights(
        &mut self,
        queue: &wgpu::Queue,
        lights: Arc<CityLights>,
    ) -> Result<(), EarthError> {
        let mut maker = self.change_maker(queue);
        maker.style.has_city_lights = true;
        let ready = maker.appearance(&self.appearance)?;
        self.style.has_city_lights = true;
        let driver = &mut self.first.planner.city_lights;
        driver.set_lights(Some(lights.clone()));
        self.surface.set_city_lights(lights);
        self.set_ready(queue, ready)
    }

    /// Prepares other qualities and appearances for this Earth in its present state.
    pub fn change_maker(&self, queue: &wgpu::Queue) -> ChangeMaker {
        ChangeMaker {
            device: self.device.clone(),
            queue: queue.clone(),
            surface: self.surface.maker(&self.first.surface),
            air: self.air_textures().cloned(),
            albedo: self.first.planner.exposure.albedo().clone(),
            style: self.style,
            appearance: self.appearance.clone(),
            quality: self.quality,
            format: self.format,
            figure: self.figure,
            has_tiles: self.tiles.is_some(),
            version: self.first.version,
        }
    }

    /// Applies a prepared change from the next [`Self::prepare`] on. Nothing is compiled: it binds textures and makes some buffers. If the sample
    /// count differs, the next pass must have the new one, and other drawables that use this air (`Celestial`, `Tracks`) must be made again.
    ///
    /// # Errors
    /// [`EarthError::OutOfDate`] if the change was prepared for another Earth or before this one was changed. The Earth is then unchanged.
    pub fn set_ready(&mut self, queue: &wgpu::Queue, ready: ReadyChange) -> Result<(), EarthError> {
        let first = &mut self.first;
        if ready.version != first.version {
            return Err(EarthError::OutOfDate);
        }
        let (device, quality) = (&self.device, ready.quality);
        let air = match ready.air {
            ReadyAir::None => None,
            ReadyAir::Kept => first.air.take(),
            ReadyAir::Made(air) => Some(*air),
        };
        if let Some(air) = &air {
            let albedo = first.planner.exposure.albedo().texels(&quality.maps);
            air.textures().set_albedo(queue, &albedo);
        }
        (self.style.light, self.appearance) = (ready.appearance.light, ready.appearance);
        first.planner.set_appearance(&self.appearance);
        if let ReadyGround::Made(made) = ready.ground {
            first.planner.set_ground(made.driver);
            first.surface = made.view;
            first.version.grounds += 1;
        }
        first.set_quality(device, &quality, ready.meshes, air);
        let ground = first.planner.ground();
        let air = first.air.as_ref().map(AirDrawable::textures);
        let config = surface_config(device, self.style, ready.format, &quality, air, ground);
        self.surface
            .set_pipelines(device, queue, ready.surface, &config, &mut first.surface);
        first.version.pipelines += 1;
        if let Some(tiles) = &mut self.tiles {
            tiles.set_quality(&quality);
        }
        (self.format, self.quality) = (ready.format, quality);
        Ok(())
    }
}
