//! A directional light that is the Earth's Sun, so that the app's things are lit as the Earth is.

use crate::{Earth, EarthFrame, EarthSky};
use bevy::ecs::component::Component;
use bevy::ecs::query::With;
use bevy::ecs::reflect::ReflectComponent;
use bevy::ecs::system::Query;
use bevy::light::DirectionalLight;
use bevy::math::{DVec3, Vec3};
use bevy::reflect::Reflect;
use bevy::transform::components::Transform;
use std::f32::consts::PI;
use terrella::frames::{Ellipsoid, illumination};

/// Makes a `DirectionalLight` the Sun: direction and illuminance are the Earth's.
///
/// The entity stands at the top of the hierarchy: its transform is written in the world's axes.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Clone, Debug, PartialEq)]
#[require(DirectionalLight)]
pub struct EarthSun {
    /// The exposure value of the cameras' Bevy component `Exposure`. A white sheet that faces the Sun is then as bright as one on the
    /// Earth would be.
    pub ev100: f32,
    /// The exposure value that the Earth is shown with: that of [`EarthCamera`](crate::EarthCamera) for cameras without `Hdr`, 0 for those
    /// with it.
    pub earth_ev: f32,
    /// A place in the world, in its unit, where the Earth's shadow falls on what is lit: the craft's. `None` is always in the Sun.
    pub shadow_at: Option<DVec3>,
}

impl Default for EarthSun {
    /// For cameras with `Hdr` and Bevy's default exposure, always in the Sun.
    fn default() -> Self {
        Self {
            ev100: bevy::camera::Exposure::EV100_BLENDER,
            earth_ev: 0.0,
            shadow_at: None,
        }
    }
}

impl EarthSun {
    /// Illuminance in lux that shows a white sheet as bright as the Earth's light shows one, all of the Sun in sight: π / exposure · 2^EV.
    ///
    /// At `Exposure::SUNLIGHT` it is 123 500 lx; the Sun above the air gives 133 100.
    pub fn illuminance_lux(&self) -> f32 {
        let exposure = bevy::camera::Exposure { ev100: self.ev100 };
        // A diffuse sheet of reflectance 1 in E lux has the luminance E / π.
        PI / exposure.exposure() * self.earth_ev.exp2()
    }
}

pub(crate) fn aim_suns(
    earths: Query<(&EarthFrame, &EarthSky), With<Earth>>,
    mut suns: Query<(&EarthSun, &mut DirectionalLight, &mut Transform)>,
) {
    // With several Earths the cameras tell what is wrong.
    let Ok((frame, sky)) = earths.single() else {
        return;
    };
    let sun_itrf = sky.0.sun_itrf;
    let towards = frame.world_direction(sun_itrf).as_vec3();
    if towards == Vec3::ZERO {
        return;
    }
    for (sun, mut light, mut transform) in &mut suns {
        transform.rotation = Transform::IDENTITY
            .looking_to(-towards, towards.any_orthonormal_vector())
            .rotation;
        let share = sun.shadow_at.map_or(1.0, |place| {
            let place_itrf_m = frame.itrf_from_world.transform_point3(place);
            let sun_itrf_m = sun_itrf.normalize_or_zero() * sky.0.sun_distance_m;
            illumination(place_itrf_m, sun_itrf_m, &Ellipsoid::WGS84).1
        });
        light.illuminance = sun.illuminance_lux() * share as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::ecs::schedule::Schedule;
    use bevy::ecs::world::World;
    use terrella::Sky;
    use terrella::frames::Geodetic;

    fn lit(sun: EarthSun, sun_itrf: DVec3) -> (Vec3, f32) {
        let mut world = World::new();
        let place = Geodetic::from_degrees(0.0, 0.0, 400e3);
        let sky = EarthSky(Sky::new(sun_itrf));
        world.spawn((Earth::default(), EarthFrame::local(place), sky));
        let light = world.spawn(sun).id();
        let mut schedule = Schedule::default();
        schedule.add_systems(aim_suns);
        schedule.run(&mut world);
        let light = world.entity(light);
        let shines = light.get::<Transform>().expect("a transform").forward();
        let light = light.get::<DirectionalLight>().expect("a light");
        (*shines, light.illuminance)
    }

    #[test]
    fn it_shines_away_from_the_sun_and_a_white_sheet_is_one() {
        let sun = EarthSun::default();
        // Over 0° E on the equator ITRF's x is the world's up, z its north.
        let (shines, lux) = lit(sun, DVec3::new(1.0, 0.0, 1.0).normalize());
        let expected = Vec3::new(0.0, -1.0, 1.0).normalize();
        assert!((shines - expected).length() < 1e-6, "{shines}");
        let exposure = bevy::camera::Exposure::BLENDER.exposure();
        assert!((lux / PI * exposure - 1.0).abs() < 1e-5, "{lux}");
        let brighter = EarthSun {
            earth_ev: 2.0,
            ..sun
        };
        assert!((lit(brighter, DVec3::X).1 / lux - 4.0).abs() < 1e-5);
    }

    #[test]
    fn what_stands_in_the_earths_shadow_is_dark() {
        let sun = EarthSun {
            shadow_at: Some(DVec3::ZERO),
            ..EarthSun::default()
        };
        assert_eq!(lit(sun, DVec3::X).1, sun.illuminance_lux());
        assert_eq!(lit(sun, DVec3::NEG_X).1, 0.0);
        assert_eq!(
            lit(EarthSun::default(), DVec3::NEG_X).1,
            sun.illuminance_lux()
        );
    }
}
