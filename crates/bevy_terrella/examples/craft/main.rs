//! A spinning craft over the Earth.
//!
//! ```sh
//! cargo run --example craft                        # a window
//! cargo run --example craft -- --frame craft.png   # one picture, without a window
//! ```

#[path = "../../tests/render/headless.rs"]
pub mod headless;

use bevy::camera::Hdr;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::math::{DAffine3, DMat3, DVec3};
use bevy::prelude::*;
use bevy::render::view::{ColorGrading, ColorGradingGlobal};
use bevy_terrella::{
    Earth, EarthCamera, EarthClock, EarthEpoch, EarthFrame, EarthSun, TerrellaPlugin,
};
use std::error::Error;
use terrella::frames::{Duration, Ellipsoid, Epoch, itrf_from_gcrf};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    match &arguments[..] {
        [] => {
            App::new().add_plugins((DefaultPlugins, fly)).run();
            Ok(())
        }
        [flag, path] if flag == "--frame" => {
            let picture = still((960, 540))?;
            picture.save(path)?;
            Ok(())
        }
        _ => Err("craft takes nothing, or --frame PATH".into()),
    }
}

/// The app: the Earth, a craft in orbit, its camera and its light.
pub fn fly(app: &mut App) {
    app.add_plugins(TerrellaPlugin)
        .insert_resource(ClearColor(Color::BLACK))
        // Light from the Earth on the craft.
        .insert_resource(GlobalAmbientLight {
            color: Color::srgb(0.85, 0.93, 1.0),
            brightness: 300.0,
            ..default()
        })
        .add_systems(Startup, spawn)
        .add_systems(Update, (keep_origin_at_craft, spin));
}

/// One image of the app at its first instant.
pub fn still(size: (u32, u32)) -> Result<headless::Picture, Box<dyn Error>> {
    headless::still(fly, size, 0)
}

/// A circular orbit in the axes of the stars, metres and seconds.
struct Orbit {
    radius_m: f64,
    period_s: f64,
    inclination_rad: f64,
    node_rad: f64,
    begin: Epoch,
}

impl Orbit {
    fn craft() -> Self {
        Self {
            radius_m: Ellipsoid::WGS84.equatorial_radius_m + 420e3,
            period_s: 5_570.0,
            inclination_rad: 0.9,
            node_rad: 0.74,
            begin: Epoch::from_gregorian_utc(2018, 6, 21, 8, 50, 0, 0),
        }
    }

    /// The world of the craft: metres from it, y up, −z forward.
    fn frame(&self, epoch: Epoch) -> EarthFrame {
        let turn = std::f64::consts::TAU * (epoch - self.begin).to_seconds() / self.period_s;
        let plane =
            DMat3::from_rotation_z(self.node_rad) * DMat3::from_rotation_x(self.inclination_rad);
        let up = plane * DVec3::new(turn.cos(), turn.sin(), 0.0);
        let ahead = plane * DVec3::new(-turn.sin(), turn.cos(), 0.0);
        let axes = DMat3::from_cols(ahead.cross(up), up, -ahead);
        let itrf_from_gcrf = itrf_from_gcrf(epoch);
        EarthFrame {
            itrf_from_world: DAffine3::from_mat3_translation(
                itrf_from_gcrf * axes,
                itrf_from_gcrf * up * self.radius_m,
            ),
        }
    }
}

/// Marks the spinning model.
#[derive(Component)]
struct Craft;

fn spawn(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let begin = Orbit::craft().begin + Duration::from_seconds(820.0);
    commands.spawn((
        Earth::default(),
        EarthEpoch(begin),
        EarthClock { rate: 20.0 },
    ));

    // Light of the Earth and of the craft alike: the Sun of the date, dark in the Earth's shadow, with Bevy's exposure for
    // both.
    commands.spawn(EarthSun {
        shadow_at: Some(DVec3::ZERO),
        ..default()
    });
    commands.spawn((
        Camera3d::default(),
        EarthCamera::default(),
        Hdr,
        Tonemapping::KhronosPbrNeutral,
        ColorGrading {
            global: ColorGradingGlobal {
                exposure: 0.3,
                ..default()
            },
            ..default()
        },
        Transform::from_xyz(-14.0, 9.0, -22.0).looking_at(Vec3::new(2.0, -2.0, 0.0), Vec3::Y),
    ));

    let mut part = |size: Vec3, color: Color| {
        let material = StandardMaterial {
            base_color: color,
            perceptual_roughness: 0.7,
            ..default()
        };
        let mesh = meshes.add(Cuboid::from_size(size));
        (Mesh3d(mesh), MeshMaterial3d(materials.add(material)))
    };
    let body = part(Vec3::new(4.0, 4.0, 6.0), Color::srgb(0.85, 0.78, 0.6));
    let panel = part(Vec3::new(12.0, 0.2, 5.0), Color::srgb(0.1, 0.16, 0.5));
    commands
        .spawn((Craft, body, Transform::default()))
        .with_children(|craft| {
            for side in [-8.5, 8.5] {
                craft.spawn((panel.clone(), Transform::from_xyz(side, 0.0, 0.0)));
            }
        });
}

/// A floating origin: the craft stays at zero, and the frame holds its position in f64.
fn keep_origin_at_craft(mut earth: Query<(&EarthEpoch, &mut EarthFrame)>) {
    for (epoch, mut frame) in &mut earth {
        *frame = Orbit::craft().frame(epoch.0);
    }
}

fn spin(mut craft: Query<&mut Transform, With<Craft>>, earth: Query<&EarthEpoch>) {
    for epoch in &earth {
        let turn = (epoch.0 - Orbit::craft().begin).to_seconds() * 0.02;
        for mut transform in &mut craft {
            transform.rotation = Quat::from_rotation_y(turn as f32) * Quat::from_rotation_x(0.4);
        }
    }
}
