//! The façade: an Earth that a wgpu host draws into its own pass.
//!
//! | file | what |
//! |---|---|
//! | `mod.rs` | the three verbs |
//! | `options.rs` | what is fixed when an Earth is made |
//! | `look.rs` | how the surface is drawn with a quality |
//! | `view.rs` | the eye and the target |
//! | `stats.rs` | what a frame drew |
//! | `ground.rs` | ground with relief, where there is any |
//! | `tiles.rs` | which tiles of a pack a frame wants and is drawn with |
//! | `quality.rs` | what can be given up to draw faster, and in what order |
//! | `governor.rs` | when it is given up, to hold a frame time |

mod governor;
mod ground;
mod look;
mod options;
mod quality;
mod stats;
mod tiles;
mod view;

use crate::air::{Atmosphere, Billboard, EARTH_AIR};
use crate::frames::{Epoch, Orientation, sun_direction_itrf_oriented};
pub use crate::globe::Shading;
use crate::globe::{COLUMNS, GroundForm, Meshes, Visibility, select_blocks, texels_per_pixel};
use crate::gpu::{AirDrawable, Frame, PassFormat, SurfaceDrawable};
pub use crate::gpu::{DepthBuffer, SurfaceOutput};
use crate::imagery::tile::{LayerLayout, MapLayer, TileKey};
use glam::{DMat4, DVec3, Vec3};
pub use governor::{Change, Governor};
use ground::GroundDriver;
pub use ground::GroundOptions;
use look::{Style, look};
pub use options::{EarthError, EarthOptions};
pub use quality::{GiveUp, Quality, Rung};
pub use stats::FrameStats;
use std::time::{Duration, Instant};
use tiles::{Eye, TileDriver};
pub use tiles::{TILED_SUBDIVISION, TileOptions};
pub use view::{EyeView, Viewport, infinite_reversed_z};
pub(crate) use view::{PixelRays, can_be_drawn};

/// What lights the Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Vector to the Sun in ITRF axes, of length 1; of any other finite length it is made a unit vector.
    pub sun_itrf: DVec3,
}

impl Sky {
    /// The sky of a date, UT1 taken as UTC and polar motion left out: the Sun is up to 13.5″ off.
    pub fn at(epoch: Epoch) -> Self {
        Self::with_orientation(epoch, &Orientation::default())
    }

    /// The sky of a date over an Earth of that orientation.
    pub fn with_orientation(epoch: Epoch, orientation: &Orientation) -> Self {
        Self {
            sun_itrf: sun_direction_itrf_oriented(epoch, orientation),
        }
    }

    /// The same with a Sun of length 1; `None` where that has no direction or is not finite.
    fn with_unit_sun(self) -> Option<Self> {
        let sun = self.sun_itrf;
        if (sun.length_squared() - 1.0).abs() < 1e-6 {
            return Some(self);
        }
        // By the largest component first: squares of very long vectors are infinite, of very short ones 0.
        let largest = sun.abs().max_element();
        (sun.is_finite() && largest > 0.0).then(|| Self {
            sun_itrf: (sun / largest).normalize(),
        })
    }
}

/// Bytes of tiles uploaded at once where a picture waits for them.
const WAITING_UPLOAD_BYTES: u64 = 64_000_000;

/// The Earth.
///
/// The host owns device, queue, pass and depth buffer. Once a frame: [`Earth::prepare`], then [`Earth::render`] inside
/// the host's pass. Neither waits for disk or GPU.
pub struct Earth {
    meshes: Meshes,
    visibility: Visibility,
    exposure: f32,
    surface: SurfaceDrawable,
    ground: Option<GroundDriver>,
    air: Option<AirDrawable>,
    tiles: Option<TileDriver>,
    /// Texels of the day map per block side where no tile is drawn.
    whole_day_pixels: u32,
    device: wgpu::Device,
    style: Style,
    format: PassFormat,
    quality: Quality,
    /// Bytes of tiles uploaded by the last `prepare`.
    uploaded_tiles: u64,
    stats: FrameStats,
    /// False if the last view was not finite: then nothing is drawn.
    drawable: bool,
}

impl Earth {
    /// Makes pipelines and uploads the maps.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        options: &EarthOptions,
    ) -> Result<Self, EarthError> {
        let least = least_cells(options.tiles.is_some());
        let meshes = Meshes::new(options.figure.ellipsoid(), options.subdivision, least)?;
        if !(options.exposure.is_finite() && options.exposure >= 0.0) {
            return Err(EarthError::Exposure(options.exposure));
        }
        let lines = wgpu::Features::POLYGON_MODE_LINE;
        if options.wireframe && !device.features().contains(lines) {
            return Err(EarthError::NoLines);
        }
        let layers = &options.layers;
        let limit = device.limits().max_texture_dimension_2d;
        for layer in MapLayer::ALL {
            let image = layers.get(layer);
            let layer = layer.name();
            let Some(image) = image else { continue };
            image.check()?;
            let (width, height) = (image.width, image.height);
            if width.max(height) > limit {
                return Err(EarthError::TooLarge {
                    layer,
                    width,
                    height,
                    limit,
                });
            }
        }
        let format = PassFormat {
            color: options.color_format,
            samples: options.samples,
            depth: options.depth,
        };
        let tiles = match &options.tiles {
            Some(tiles) if !reads(device, tiles) => return Err(EarthError::NoBc),
            Some(tiles) => Some(TileDriver::new(tiles, layers, options.visibility)?),
            None => None,
        };
        let ground = options.ground.as_ref();
        let ground = ground.map(|g| GroundDriver::new(g, options.figure, &device.limits()));
        let ground = ground.transpose()?;
        let is_cast =
            |ground: &GroundDriver| matches!(ground.surface().form(), GroundForm::Pages(_));
        if options.wireframe && ground.as_ref().is_some_and(is_cast) {
            return Err(EarthError::NoEdges);
        }
        let mut quality = Quality::of(options);
        if options.output == SurfaceOutput::Places {
            quality.atmosphere = Atmosphere::None;
        }
        let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let air = match quality.atmosphere {
            Atmosphere::Billboard => Some(AirDrawable::new(device, queue, format)?),
            Atmosphere::None => None,
        };
        let style = Style {
            shading: options.shading,
            output: options.output,
            wireframe: options.wireframe,
        };
        let with = (air.as_ref(), ground.as_ref());
        let look = look(device, style, format, &quality, with);
        let pools = tiles.as_ref().map(TileDriver::pools);
        let surface = SurfaceDrawable::new(device, queue, meshes.grids(), layers, pools, &look)?;
        let refused = resolved(scope.pop());
        let full = resolved(memory.pop());
        if let Some(error) = full {
            return Err(EarthError::NoRoom {
                mib: surface.texture_bytes >> 20,
                cause: error.to_string(),
            });
        }
        if let Some(error) = refused {
            return Err(EarthError::Refused(error.to_string()));
        }
        let texture_bytes = surface.texture_bytes + air.as_ref().map_or(0, |air| air.texture_bytes);
        let stats = FrameStats {
            texture_bytes,
            ..FrameStats::default()
        };
        Ok(Self {
            meshes,
            visibility: options.visibility,
            exposure: options.exposure,
            surface,
            ground,
            air,
            tiles,
            whole_day_pixels: layers.day.width / COLUMNS,
            device: device.clone(),
            style,
            format,
            quality,
            uploaded_tiles: 0,
            stats,
            drawable: false,
        })
    }

    /// Chooses what the eye sees and writes it to the GPU. Call once a frame, before the pass. Never waits.
    ///
    /// `target` is the target's width and height in pixels, or the [`Viewport`] that the pass sets. Nothing is drawn where
    /// no picture is defined: of a view or sky that is not finite, a Sun without direction, a projection that has no
    /// inverse, and an eye beyond 1e24 m.
    pub fn prepare(
        &mut self,
        queue: &wgpu::Queue,
        view: &EyeView,
        sky: &Sky,
        target: impl Into<Viewport>,
    ) -> FrameStats {
        self.prepare_within(queue, view, sky, target.into(), None)
    }

    /// As [`Self::prepare`], but waits until every tile that the view wants is on the GPU, and ground with relief is as fine
    /// as it will be, at most `timeout`: for
    /// pictures that are kept. Answers what is missing; such blocks are drawn with something coarser. A tile that cannot
    /// be read is not waited for.
    ///
    /// Submits to `queue` what it uploads on the way.
    pub fn prepare_complete(
        &mut self,
        queue: &wgpu::Queue,
        view: &EyeView,
        sky: &Sky,
        target: impl Into<Viewport>,
        timeout: Duration,
    ) -> (FrameStats, Vec<TileKey>) {
        let (target, deadline) = (target.into(), Instant::now() + timeout);
        loop {
            let stats = self.prepare_within(queue, view, sky, target, Some(WAITING_UPLOAD_BYTES));
            let ground = self.ground.as_ref().filter(|_| self.drawable);
            if ground.is_some_and(|ground| !ground.is_settled()) && Instant::now() < deadline {
                queue.submit([]);
                continue;
            }
            let Some(tiles) = self.tiles.as_mut().filter(|_| self.drawable) else {
                return (stats, Vec::new());
            };
            // What was uploaded just now is drawn in the next round.
            let left = deadline.saturating_duration_since(Instant::now());
            if self.uploaded_tiles == 0 && (tiles.is_settled() || left.is_zero()) {
                return (stats, tiles.missing().collect());
            }
            if self.uploaded_tiles == 0 {
                tiles.wait(left);
            }
            // Lets go of the copies that the uploads are made from.
            queue.submit([]);
        }
    }

    /// Says where the eye is expected soon, the nearest time first, so that tiles are there when it comes. At most four
    /// views are looked at; they stand until others are given. Without tiles it does nothing.
    pub fn expect(&mut self, views: &[EyeView]) {
        if let Some(tiles) = &mut self.tiles {
            tiles.expect(views);
        }
    }

    /// How well it is drawn.
    pub fn quality(&self) -> &Quality {
        &self.quality
    }

    /// Draws better or worse from the next [`Self::prepare`] on. Maps and tiles stay on the GPU; pipelines and the
    /// lattice are made anew where they differ, which takes some milliseconds.
    ///
    /// # Errors
    /// As [`Self::new`]; the Earth is then as it was.
    pub fn set_quality(
        &mut self,
        queue: &wgpu::Queue,
        quality: &Quality,
    ) -> Result<(), EarthError> {
        let before = self.quality;
        self.apply(queue, quality).or_else(|failure| {
            self.apply(queue, &before)?;
            Err(failure)
        })
    }

    fn apply(&mut self, queue: &wgpu::Queue, quality: &Quality) -> Result<(), EarthError> {
        let mut quality = *quality;
        if self.style.output == SurfaceOutput::Places {
            quality.atmosphere = Atmosphere::None;
        }
        let ellipsoid = self.meshes.grid().ellipsoid();
        let least = least_cells(self.tiles.is_some());
        let meshes = Meshes::new(ellipsoid, quality.subdivision, least)?;
        let format = PassFormat {
            samples: quality.samples,
            ..self.format
        };
        let device = self.device.clone();
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        // The air's tables need not be uploaded again where its pipelines fit.
        let fits = quality.samples == self.format.samples;
        let air = match (quality.atmosphere, self.air.take().filter(|_| fits)) {
            (Atmosphere::None, _) => None,
            (Atmosphere::Billboard, Some(air)) => Some(air),
            (Atmosphere::Billboard, None) => Some(AirDrawable::new(&device, queue, format)?),
        };
        let with = (air.as_ref(), self.ground.as_ref());
        let look = look(&device, self.style, format, &quality, with);
        self.surface.set_look(&device, meshes.grids(), &look)?;
        (self.meshes, self.air, self.format, self.quality) = (meshes, air, format, quality);
        if let Some(tiles) = &mut self.tiles {
            tiles.set_quality(&quality);
        }
        self.drawable = false;
        self.stats.texture_bytes =
            self.surface.texture_bytes + self.air.as_ref().map_or(0, |air| air.texture_bytes);
        match resolved(scope.pop()) {
            None => Ok(()),
            Some(error) => Err(EarthError::Refused(error.to_string())),
        }
    }

    fn prepare_within(
        &mut self,
        queue: &wgpu::Queue,
        view: &EyeView,
        sky: &Sky,
        target: Viewport,
        upload_bytes: Option<u64>,
    ) -> FrameStats {
        let rays = view.pixel_rays(target);
        let (eye_itrf_m, clip_from_eye) = self.plan(view, rays.down.length());
        let sky = sky
            .with_unit_sun()
            .filter(|_| can_be_drawn(eye_itrf_m, &clip_from_eye, &rays));
        self.drawable = sky.is_some();
        let Some(sky) = &sky else {
            self.uploaded_tiles = 0;
            self.stats = FrameStats {
                texture_bytes: self.stats.texture_bytes,
                ..FrameStats::default()
            };
            return self.stats;
        };
        self.choose_maps(queue, eye_itrf_m, &rays, sky, upload_bytes);
        self.stats.pixel_m = self.stats.eye.height_m.max(0.0) * rays.down.length();
        let ellipsoid = self.meshes.grid().ellipsoid();
        let scale = ellipsoid.itrf_from_scaled();
        let eye_scaled = eye_itrf_m / scale;
        let distance = eye_scaled.length();
        let frame = Frame {
            clip_from_eye: clip_from_eye.as_mat4(),
            eye_scaled: eye_scaled.as_vec3(),
            above: ((distance - 1.0) * (distance + 1.0)) as f32,
            sun_itrf: sky.sun_itrf.as_vec3(),
            radius_m: ellipsoid.equatorial_radius_m as f32,
            corner_ray: rays.corner.as_vec3(),
            polar_stretch: (ellipsoid.equatorial_radius_m / ellipsoid.polar_radius_m) as f32,
            pixel_right: rays.right.as_vec3(),
            exposure: self.exposure,
            pixel_down: rays.down.as_vec3(),
            air_below: EARTH_AIR.part_below(self.stats.eye.height_m) as f32,
        };
        self.stats.uploaded_bytes = self.uploaded_tiles + self.surface.write(queue, &frame);
        if let Some(ground) = &self.ground {
            let surface = ground.surface();
            self.stats.uploaded_bytes += self
                .surface
                .write_ground(queue, surface, &ellipsoid, eye_itrf_m);
        }
        if let Some((calls, triangles, bytes)) = self.surface.ground_costs() {
            let air = u32::from(self.air.is_some());
            self.stats.draw_calls = calls + air;
            self.stats.triangles = triangles + 2 * air;
            self.stats.ground_bytes = bytes;
        }
        if let Some(air) = &mut self.air {
            let square = Billboard::new(eye_scaled, EARTH_AIR.top(), &clip_from_eye, scale);
            self.stats.uploaded_bytes +=
                air.write(queue, &square, sky.sun_itrf / scale, self.exposure);
        }
        self.stats
    }

    /// Chooses what map each block is drawn with.
    fn choose_maps(
        &mut self,
        queue: &wgpu::Queue,
        eye_itrf_m: DVec3,
        rays: &PixelRays,
        sky: &Sky,
        upload_bytes: Option<u64>,
    ) {
        let pixel_rad = rays.down.length();
        let Some(tiles) = &mut self.tiles else {
            let nearest_m = self.surface.drawn().iter();
            let nearest_m = nearest_m
                .map(|block| self.meshes.grid().distance_m(*block, eye_itrf_m))
                .fold(f64::INFINITY, f64::min);
            let radius_m = self.meshes.grid().ellipsoid().equatorial_radius_m;
            self.stats.texels_per_pixel = if nearest_m.is_finite() {
                texels_per_pixel(self.whole_day_pixels, radius_m, nearest_m, pixel_rad)
            } else {
                0.0
            };
            return;
        };
        let eye = Eye {
            itrf_m: eye_itrf_m,
            sun_itrf: sky.sun_itrf,
            pixel_rad,
        };
        let frame = tiles.prepare(
            self.meshes.grid(),
            &eye,
            upload_bytes,
            &mut self.surface,
            &self.device,
            queue,
        );
        self.uploaded_tiles = frame.uploaded_bytes;
        self.stats.day_levels = frame.day_levels;
        self.stats.tiles = frame.counters;
        self.stats.texels_per_pixel = frame.texels_per_pixel;
        self.stats.tile_upload = frame.upload;
    }

    /// The part of [`Self::prepare`] that needs no GPU: selection and the eye-relative vertices. Allocates nothing.
    fn plan(&mut self, view: &EyeView, pixel_rad: f64) -> (DVec3, DMat4) {
        let (eye_itrf_m, clip_from_eye) = view.to_itrf();
        self.stats.eye = self
            .meshes
            .grid()
            .ellipsoid()
            .geodetic_from_itrf(eye_itrf_m);
        let air = u32::from(self.air.is_some());
        if let Some(ground) = &mut self.ground {
            let drawn = self.surface.drawn_mut();
            let grid = self.meshes.grid();
            let ground = ground.prepare(grid, eye_itrf_m, &clip_from_eye, pixel_rad, drawn);
            let blocks = drawn.len() as u32;
            self.stats.ground = ground;
            (self.stats.blocks_visible, self.stats.blocks_drawn) = (blocks, blocks);
            self.stats.triangles = ground.triangles + 2 * air;
            return (eye_itrf_m, clip_from_eye);
        }
        let place = self.meshes.choose(self.stats.eye.height_m, pixel_rad);
        self.surface.choose_grid(place);
        self.stats.subdivision = self.meshes.grid().subdivision();
        let selection = select_blocks(
            self.meshes.grid(),
            self.visibility,
            eye_itrf_m,
            &clip_from_eye,
            self.surface.drawn_mut(),
        );
        self.surface.stage(self.meshes.grid(), eye_itrf_m);
        let drawn = self.surface.drawn();
        self.stats.blocks_visible = selection.visible;
        self.stats.blocks_drawn = drawn.len() as u32;
        self.stats.triangles = drawn
            .iter()
            .map(|block| self.meshes.grid().triangles(block.kind()))
            .sum::<u32>()
            + 2 * air;
        self.stats.draw_calls = drawn.len() as u32 + air;
        (eye_itrf_m, clip_from_eye)
    }

    /// Draws what [`Self::prepare`] chose into the host's pass: the surface, then the air over it. Draw opaque things
    /// before, so that the air lies over those behind it.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.render_surface(pass);
        self.render_air(pass);
    }

    /// The first part of [`Self::render`], for a host that measures them apart or draws between them what lies beyond the
    /// air's near boundary ([`crate::tracks`]).
    pub fn render_surface(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.drawable {
            self.surface.render(pass);
        }
    }

    /// The second part.
    pub fn render_air(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(air) = self.air.as_ref().filter(|_| self.drawable) {
            air.render(pass);
        }
    }

    /// The vertices that the GPU gets, eye-relative ITRF metres, each beside its exact ITRF position.
    pub fn vertices(&self) -> impl Iterator<Item = (Vec3, DVec3)> {
        let exact = self.surface.drawn().iter().flat_map(|block| {
            (0..=self.meshes.grid().subdivision())
                .flat_map(|row| self.meshes.grid().vertex_row(*block, row).iter().copied())
        });
        self.surface.staged().iter().copied().zip(exact)
    }

    /// Bytes of the WGSL that the driver got: the surface's, and the air's from outside and from inside it.
    pub fn shader_bytes(&self) -> u64 {
        self.surface.shader_bytes() + self.air.as_ref().map_or(0, |air| air.shader_bytes)
    }

    /// Whether the air is drawn.
    pub fn has_air(&self) -> bool {
        self.air.is_some()
    }

    /// Whether blocks are drawn with tiles.
    pub fn has_tiles(&self) -> bool {
        self.tiles.is_some()
    }

    /// Names of the features that are on.
    pub fn features_on(&self) -> Vec<&'static str> {
        self.features(true)
    }

    /// Names of the features that are off and cost nothing.
    pub fn features_off(&self) -> Vec<&'static str> {
        self.features(false)
    }

    fn features(&self, on: bool) -> Vec<&'static str> {
        let shader = &self.surface.variant().features;
        // Water and tiles come with packs; an Earth without one has nothing to switch off.
        let of_packs: &[&str] = match self.tiles {
            Some(_) => &["water", "tiles"],
            None => &[],
        };
        let form = self.ground.as_ref().map(|ground| ground.surface().form());
        let of_ground: &[&str] = match form {
            Some(GroundForm::Grid(_)) => &["relief", "grid"],
            Some(GroundForm::Pages(_)) => &["relief", "cast"],
            Some(GroundForm::Patches) => &["relief"],
            None => &[],
        };
        ["clouds", "normals", "night_lights"]
            .iter()
            .chain(of_packs)
            .chain(of_ground)
            .copied()
            .map(|name| (name, shader.contains(&name)))
            .chain([("atmosphere", self.air.is_some())])
            .filter(|(_, is_on)| *is_on == on)
            .map(|(name, _)| name)
            .collect()
    }
}

/// Fewest cells per block edge that are chosen automatically.
fn least_cells(has_tiles: bool) -> u32 {
    if has_tiles { TILED_SUBDIVISION } else { 1 }
}

/// Whether the device reads the tiles' formats.
fn reads(device: &wgpu::Device, tiles: &TileOptions) -> bool {
    let is_plain = |layer: &LayerLayout| layer.format.unit_side() == 1;
    let has_bc = device.features();
    tiles.source.layers().iter().all(is_plain)
        || has_bc.contains(wgpu::Features::TEXTURE_COMPRESSION_BC)
}

/// The value of a future that is ready at once, as wgpu's error scopes are everywhere but on the web.
fn resolved<T>(future: impl Future<Output = Option<T>>) -> Option<T> {
    let mut future = std::pin::pin!(future);
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    match future.as_mut().poll(&mut context) {
        std::task::Poll::Ready(value) => value,
        std::task::Poll::Pending => None,
    }
}
