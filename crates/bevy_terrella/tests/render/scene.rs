//! One view, for Bevy and for the native host.

use crate::headless::{self, Picture};
use crate::native::{light, maps};
use bevy::asset::Handle;
use bevy::camera::{Hdr, RenderTarget, Viewport};
use bevy::core_pipeline::tonemapping::{DebandDither, Tonemapping};
use bevy::image::Image;
use bevy::math::{DMat4, DVec4};
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy_terrella::{Earth, EarthCamera, EarthEpoch, EarthFrame, EarthMaps, TerrellaPlugin};
use terrella::frames::{Epoch, Geodetic};
use terrella::{Exposure, EyeView, Sky};

/// Near plane of all cameras, units of the world.
pub const NEAR: f32 = 0.1;

/// Width and height of the images, pixels.
pub const SIZE: (u32, u32) = (320, 180);

/// A view of the Earth.
#[derive(Clone, Copy)]
pub struct View {
    pub frame: EarthFrame,
    pub epoch: Epoch,
    pub transform: Transform,
    pub fov_rad: f32,
    pub exposure: Exposure,
    pub hdr: bool,
    pub msaa: Msaa,
}

impl View {
    /// The space station's view: 420 km over Egypt, with the limb in the upper half.
    pub fn station() -> Self {
        let eye = Vec3::new(22.0, 12.0, 30.0);
        Self {
            frame: EarthFrame::local(Geodetic::from_degrees(28.0, 30.0, 420e3)),
            epoch: Epoch::from_gregorian_utc(2018, 6, 21, 9, 0, 0, 0),
            transform: Transform::from_translation(eye)
                .looking_at(Vec3::new(-6.0, 2.0, 0.0), Vec3::Y),
            fov_rad: 0.9,
            exposure: Exposure::default(),
            hdr: false,
            msaa: Msaa::Off,
        }
    }

    /// Format of the texture that it draws to, and of its target.
    pub fn format(&self) -> TextureFormat {
        match self.hdr {
            true => TextureFormat::Rgba16Float,
            false => headless::SRGB,
        }
    }

    /// Lights of the scene.
    pub fn sky(&self) -> Sky {
        Sky::at(self.epoch)
    }

    /// The native host's view: positions and projection in f64.
    pub fn eye(&self, (width, height): (u32, u32)) -> EyeView {
        let aspect = f64::from(width) / f64::from(height);
        let f = 1.0 / (0.5 * f64::from(self.fov_rad)).tan();
        EyeView {
            eye_world: self.transform.translation.as_dvec3(),
            view_from_world: self.transform.rotation.as_dquat().normalize().inverse(),
            clip_from_view: DMat4::from_cols(
                DVec4::new(f / aspect, 0.0, 0.0, 0.0),
                DVec4::new(0.0, f, 0.0, 0.0),
                DVec4::new(0.0, 0.0, 0.0, -1.0),
                DVec4::new(0.0, 0.0, f64::from(NEAR), 0.0),
            ),
            itrf_from_world: self.frame.itrf_from_world,
        }
    }
}

/// Bevy with the plugin, an Earth at a view's frame and date, and nothing else.
pub fn app(view: &View) -> App {
    let earth = Earth {
        light: light(),
        ..Earth::new(EarthMaps::Memory(maps()))
    };
    app_of(headless::app(), view, earth)
}

/// The same in an app with Bevy's plugins and this Earth.
pub fn app_of(mut app: App, view: &View, earth: Earth) -> App {
    app.add_plugins(TerrellaPlugin)
        .insert_resource(ClearColor(Color::BLACK));
    headless::start(&mut app);
    let entity = app
        .world_mut()
        .spawn((earth, view.frame, EarthEpoch(view.epoch)));
    assert!(entity.contains::<EarthFrame>());
    app
}

/// Adds a camera of a view, with its own target or a part of one.
pub fn camera(
    app: &mut App,
    view: &View,
    image: &Handle<Image>,
    part: Option<(UVec2, UVec2)>,
) -> Entity {
    let viewport = part.map(|(physical_position, physical_size)| Viewport {
        physical_position,
        physical_size,
        ..default()
    });
    let order = app.world_mut().query::<&Camera>().iter(app.world()).len() as isize;
    let mut camera = app.world_mut().spawn((
        Camera3d::default(),
        Camera {
            order,
            viewport,
            clear_color: match order {
                0 => ClearColorConfig::Default,
                _ if part.is_some() => ClearColorConfig::None,
                _ => ClearColorConfig::Default,
            },
            ..default()
        },
        EarthCamera {
            exposure: view.exposure,
        },
        RenderTarget::Image(image.clone().into()),
        Projection::Perspective(PerspectiveProjection {
            fov: view.fov_rad,
            near: NEAR,
            // Bevy culls objects beyond it; its depth range is infinite.
            far: 1e9,
            ..default()
        }),
        view.msaa,
        view.transform,
        Tonemapping::None,
        DebandDither::Disabled,
    ));
    if view.hdr {
        camera.insert(Hdr);
    }
    camera.id()
}

/// The image of one camera in a separate app.
pub fn alone(view: &View) -> Picture {
    let mut app = app(view);
    let image = headless::target(&mut app, SIZE, view.format());
    camera(&mut app, view, &image, None);
    headless::draw(&mut app, &image).expect("a picture")
}

/// Adds an unlit box of one colour.
pub fn block(app: &mut App, size: Vec3, at: Vec3, color: Color) -> Entity {
    let mesh = Cuboid::from_size(size);
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    let material = StandardMaterial {
        base_color: color,
        unlit: true,
        ..default()
    };
    let mut materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    let material = materials.add(material);
    let block = (
        Mesh3d(mesh),
        MeshMaterial3d(material),
        Transform::from_translation(at),
    );
    app.world_mut().spawn(block).id()
}
