//! The façade: an Earth that a wgpu host draws into its own pass.

use crate::air::{Atmosphere, Billboard, EARTH_AIR};
use crate::frames::{Epoch, Geodetic, sun_direction_itrf};
pub use crate::globe::Shading;
use crate::globe::{BlockGrid, Figure, SubdivisionError, Visibility, select_blocks};
pub use crate::gpu::DepthBuffer;
use crate::gpu::{AirDrawable, Frame, PassFormat, ShaderError, SurfaceDrawable, SurfaceParts};
use crate::imagery::{EarthLayers, ImageryError};
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3, DVec4, Vec3};

/// What is fixed when an Earth is made.
#[derive(Clone, Debug)]
pub struct EarthOptions {
    /// The maps. A layer that is `None` costs nothing.
    pub layers: EarthLayers,
    /// The figure.
    pub figure: Figure,
    /// Cells per block edge, 1…48.
    pub subdivision: u32,
    /// Which blocks are drawn.
    pub visibility: Visibility,
    /// How they are shaded.
    pub shading: Shading,
    /// How the air is drawn.
    pub atmosphere: Atmosphere,
    /// Format of the colour target.
    pub color_format: wgpu::TextureFormat,
    /// Sample count of the pass.
    pub samples: u32,
    /// Depth buffer of the pass.
    pub depth: DepthBuffer,
    /// Most samples that a map is filtered with at a grazing view, 1…16; 1 is trilinear. A software adapter always
    /// filters trilinearly: each sample costs it time, and Mesa's returns wrong texels at the limb.
    pub anisotropy: u16,
    /// What a white sheet that faces the Sun in space is drawn with; the target's white is 1. The paper's shading
    /// works in display values and is not touched by it, the air is.
    pub exposure: f32,
}

impl EarthOptions {
    /// The defaults for a picture of [`crate::gpu::FrameTargets`] with these maps.
    pub fn new(layers: EarthLayers) -> Self {
        Self {
            layers,
            figure: Figure::default(),
            subdivision: 6,
            visibility: Visibility::default(),
            shading: Shading::default(),
            atmosphere: Atmosphere::default(),
            color_format: crate::gpu::FrameTargets::COLOR,
            samples: 1,
            depth: DepthBuffer::ReversedZ(crate::gpu::FrameTargets::DEPTH),
            anisotropy: 8,
            exposure: 1.4,
        }
    }
}

/// Where the eye is and what it sees, in the host's own world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyeView {
    /// The eye in the host's world and unit.
    pub eye_world: DVec3,
    /// Rotation from world axes to view axes: x right, y up, −z forward.
    pub view_from_world: DQuat,
    /// The host's projection from view space (host's unit) to wgpu clip space, z in 0…1.
    pub clip_from_view: DMat4,
    /// Where the Earth stands: takes the host's world to ITRF metres. A rotation, a uniform scale and a shift.
    pub itrf_from_world: DAffine3,
}

impl EyeView {
    /// An eye in ITRF metres that looks along `forward` with `up` upwards on screen; infinite reversed-Z projection.
    ///
    /// `fov_y_rad` is the vertical field of view, `aspect` width over height. Defined for every direction: a zero
    /// `forward` looks down, an `up` along `forward` is replaced by any direction across it.
    pub fn itrf(eye_itrf_m: DVec3, forward: DVec3, up: DVec3, fov_y_rad: f64, aspect: f64) -> Self {
        let down = (-eye_itrf_m).normalize_or(DVec3::NEG_Z);
        let forward = forward.normalize_or(down);
        let right = forward
            .cross(up)
            .try_normalize()
            .unwrap_or_else(|| forward.any_orthonormal_vector());
        let world_from_view = DMat3::from_cols(right, right.cross(forward), -forward);
        Self {
            eye_world: eye_itrf_m,
            view_from_world: DQuat::from_mat3(&world_from_view).inverse(),
            clip_from_view: infinite_reversed_z(fov_y_rad, aspect, Self::NEAR_M),
            itrf_from_world: DAffine3::IDENTITY,
        }
    }

    /// Near plane of [`Self::itrf`], metres.
    pub const NEAR_M: f64 = 0.1;

    /// The eye in ITRF metres, and the matrix from eye-relative ITRF metres to clip space.
    pub fn to_itrf(&self) -> (DVec3, DMat4) {
        let eye_itrf_m = self.itrf_from_world.transform_point3(self.eye_world);
        let world_from_itrf = self.itrf_from_world.matrix3.inverse();
        let view_from_itrf = DMat3::from_quat(self.view_from_world) * world_from_itrf;
        (
            eye_itrf_m,
            self.clip_from_view * DMat4::from_mat3(view_from_itrf),
        )
    }

    /// The rays of a target's pixels, ITRF axes.
    fn pixel_rays(&self, viewport: Viewport) -> PixelRays {
        let itrf_from_view =
            self.itrf_from_world.matrix3 * DMat3::from_quat(self.view_from_world.inverse());
        let axes = [
            itrf_from_view.x_axis,
            itrf_from_view.y_axis,
            itrf_from_view.z_axis,
        ]
        .map(DVec3::normalize_or_zero);
        let p = &self.clip_from_view;
        let (width, height) = (
            f64::from(viewport.size.0.max(1)),
            f64::from(viewport.size.1.max(1)),
        );
        let right = axes[0] * (2.0 / (p.x_axis.x * width));
        let down = axes[1] * (-2.0 / (p.y_axis.y * height));
        // Upper left: x_clip = −w, y_clip = w at one unit ahead; the third column shifts an off-centre projection.
        let upper_left = axes[0] * ((p.z_axis.x - 1.0) / p.x_axis.x)
            + axes[1] * ((p.z_axis.y + 1.0) / p.y_axis.y)
            - axes[2];
        let (x, y) = (f64::from(viewport.origin.0), f64::from(viewport.origin.1));
        PixelRays {
            corner: upper_left - right * x - down * y,
            right,
            down,
        }
    }
}

/// The part of the target that the host's pass draws to, pixels. A size alone is a viewport at the corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewport {
    /// Upper left corner, as given to `set_viewport`.
    pub origin: (f32, f32),
    /// Width and height.
    pub size: (u32, u32),
}

impl From<(u32, u32)> for Viewport {
    fn from(size: (u32, u32)) -> Self {
        Self {
            origin: (0.0, 0.0),
            size,
        }
    }
}

/// Rays on the plane one unit in front of the eye: through pixel (0, 0)'s corner, and to the next pixel.
struct PixelRays {
    corner: DVec3,
    right: DVec3,
    down: DVec3,
}

/// Perspective projection to wgpu clip space with the near plane at depth 1 and infinity at 0.
pub fn infinite_reversed_z(fov_y_rad: f64, aspect: f64, near: f64) -> DMat4 {
    let f = 1.0 / (0.5 * fov_y_rad).tan();
    DMat4::from_cols(
        DVec4::new(f / aspect, 0.0, 0.0, 0.0),
        DVec4::new(0.0, f, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 0.0, -1.0),
        DVec4::new(0.0, 0.0, near, 0.0),
    )
}

/// What lights the Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Unit vector to the Sun in ITRF axes.
    pub sun_itrf: DVec3,
}

impl Sky {
    /// The sky of a date.
    pub fn at(epoch: Epoch) -> Self {
        Self {
            sun_itrf: sun_direction_itrf(epoch),
        }
    }
}

/// What one frame drew.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// Blocks left by the horizon test.
    pub blocks_visible: u32,
    /// Blocks left by the frustum test too.
    pub blocks_drawn: u32,
    /// Triangles drawn, air included.
    pub triangles: u32,
    /// Draw calls, air included.
    pub draw_calls: u32,
    /// Bytes written to the GPU by this `prepare`.
    pub uploaded_bytes: u64,
    /// Bytes of all textures held, mip levels included.
    pub texture_bytes: u64,
    /// The eye's place.
    pub eye: Geodetic,
    /// Metres on the ground that a pixel would cover straight below the eye; 0 at and below the surface.
    pub pixel_m: f64,
}

/// What can be wrong with the options.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EarthError {
    /// Subdivision outside 1…48.
    #[error(transparent)]
    Subdivision(#[from] SubdivisionError),
    /// A map is larger than the device takes.
    #[error(
        "the {layer} map is {width} × {height}; this device takes at most {limit} pixels a side"
    )]
    TooLarge {
        /// Which map.
        layer: &'static str,
        /// Its width.
        width: u32,
        /// Its height.
        height: u32,
        /// The device's limit.
        limit: u32,
    },
    /// A map does not hold what it says.
    #[error(transparent)]
    Layer(#[from] ImageryError),
    /// A shader file is at fault.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// A shader or pipeline was refused by the device, for instance for a colour format it cannot draw to.
    #[error("the device refused the Earth's pipelines: {0}")]
    Refused(String),
}

/// The Earth.
///
/// The host owns device, queue, pass and depth buffer. Once a frame: [`Earth::prepare`], then [`Earth::render`] inside
/// the host's pass. Neither waits for disk or GPU.
pub struct Earth {
    grid: BlockGrid,
    visibility: Visibility,
    exposure: f32,
    surface: SurfaceDrawable,
    air: Option<AirDrawable>,
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
        let grid = BlockGrid::new(options.figure.ellipsoid(), options.subdivision)?;
        let layers = &options.layers;
        let limit = device.limits().max_texture_dimension_2d;
        let maps = [
            ("day", Some(&layers.day)),
            ("cloud", layers.clouds.as_ref()),
            ("normal", layers.normals.as_ref()),
            ("night light", layers.night_lights.as_ref()),
        ];
        for (layer, image) in maps {
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
        let software = device.adapter_info().device_type == wgpu::DeviceType::Cpu;
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let air = match options.atmosphere {
            Atmosphere::Billboard => Some(AirDrawable::new(device, queue, format)?),
            Atmosphere::None => None,
        };
        let parts = SurfaceParts {
            layers,
            shading: options.shading,
            anisotropy: if software { 1 } else { options.anisotropy },
            format,
            sunlight: air
                .as_ref()
                .filter(|_| options.shading == Shading::Sunlit)
                .map(|air| &air.sunlight),
        };
        let surface = SurfaceDrawable::new(device, queue, &grid, &parts)?;
        if let Some(error) = resolved(scope.pop()) {
            return Err(EarthError::Refused(error.to_string()));
        }
        let texture_bytes = surface.texture_bytes + air.as_ref().map_or(0, |air| air.texture_bytes);
        let stats = FrameStats {
            texture_bytes,
            ..FrameStats::default()
        };
        Ok(Self {
            grid,
            visibility: options.visibility,
            exposure: options.exposure,
            surface,
            air,
            stats,
            drawable: false,
        })
    }

    /// Chooses what the eye sees and writes it to the GPU. Call once a frame, before the pass. Never waits.
    ///
    /// `target` is the target's width and height in pixels, or the [`Viewport`] that the pass sets. A view or
    /// sky that is not finite draws nothing.
    pub fn prepare(
        &mut self,
        queue: &wgpu::Queue,
        view: &EyeView,
        sky: &Sky,
        target: impl Into<Viewport>,
    ) -> FrameStats {
        let (eye_itrf_m, clip_from_eye) = self.plan(view);
        self.drawable =
            eye_itrf_m.is_finite() && clip_from_eye.is_finite() && sky.sun_itrf.is_finite();
        if !self.drawable {
            self.stats = FrameStats {
                texture_bytes: self.stats.texture_bytes,
                ..FrameStats::default()
            };
            return self.stats;
        }
        let rays = view.pixel_rays(target.into());
        self.stats.pixel_m = self.stats.eye.height_m.max(0.0) * rays.down.length();
        let ellipsoid = self.grid.ellipsoid();
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
            padding: 0.0,
        };
        self.stats.uploaded_bytes = self.surface.write(queue, &frame);
        if let Some(air) = &mut self.air {
            let square = Billboard::new(eye_scaled, EARTH_AIR.top(), &clip_from_eye, scale);
            self.stats.uploaded_bytes +=
                air.write(queue, &square, sky.sun_itrf / scale, self.exposure);
        }
        self.stats
    }

    /// The part of [`Self::prepare`] that needs no GPU: selection and the eye-relative vertices. Allocates nothing.
    fn plan(&mut self, view: &EyeView) -> (DVec3, DMat4) {
        let (eye_itrf_m, clip_from_eye) = view.to_itrf();
        let selection = select_blocks(
            &self.grid,
            self.visibility,
            eye_itrf_m,
            &clip_from_eye,
            self.surface.drawn_mut(),
        );
        self.surface.stage(&self.grid, eye_itrf_m);
        let drawn = self.surface.drawn();
        let air = u32::from(self.air.is_some());
        self.stats.blocks_visible = selection.visible;
        self.stats.blocks_drawn = drawn.len() as u32;
        self.stats.triangles = drawn
            .iter()
            .map(|block| self.grid.triangles(block.kind()))
            .sum::<u32>()
            + 2 * air;
        self.stats.draw_calls = drawn.len() as u32 + air;
        self.stats.eye = self.grid.ellipsoid().geodetic_from_itrf(eye_itrf_m);
        (eye_itrf_m, clip_from_eye)
    }

    /// Draws what [`Self::prepare`] chose into the host's pass: the surface, then the air over it. Draw opaque things
    /// before, so that the air lies over those behind it.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        if !self.drawable {
            return;
        }
        self.surface.render(pass);
        if let Some(air) = &self.air {
            air.render(pass);
        }
    }

    /// The vertices that the GPU gets, eye-relative ITRF metres, each beside its exact ITRF position.
    pub fn vertices(&self) -> impl Iterator<Item = (Vec3, DVec3)> {
        let exact = self.surface.drawn().iter().flat_map(|block| {
            (0..=self.grid.subdivision())
                .flat_map(|row| self.grid.vertex_row(*block, row).iter().copied())
        });
        self.surface.staged().iter().copied().zip(exact)
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
        let shader = &self.surface.variant.features;
        ["clouds", "normals", "night_lights"]
            .into_iter()
            .map(|name| (name, shader.contains(&name)))
            .chain([("atmosphere", self.air.is_some())])
            .filter(|(_, is_on)| *is_on == on)
            .map(|(name, _)| name)
            .collect()
    }
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
