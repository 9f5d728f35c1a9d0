//! A directional light that is the Earth's Sun, so that the app's meshes have the same light as the
//! Earth.

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

/// Makes a `DirectionalLight` the Sun, with the Earth's direction and illuminance.
///
/// The entity must be at the top of the hierarchy: its transform is written in world axes.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Clone, Debug, PartialEq)]
#[require(DirectionalLight)]
pub struct EarthSun {
    /// The exposure value of the cameras' Bevy component `Exposure`. A white sheet facing the Sun then appears as bright as one on
    /// the Earth.
    pub ev100: f32,
    /// The exposure value for the Earth: that of [`EarthCamera`](crate::EarthCamera) for cameras without `Hdr`, 0 for cameras with it.
    pub earth_ev: f32,
    /// A place in the world, in its unit, where the Earth's shadow is evaluated: that of the craft. `None` is always sunlit.
    pub shadow_at: Option<DVec3>,
}

impl Default for EarthSun {
    /// For cameras with `Hdr` and Bevy's default exposure, always sunlit.
    fn default() -> Self {
        Self {
            ev100: bevy::camera::Exposure::EV100_BLENDER,
            earth_ev: 0.0,
            shadow_at: None,
        }
    }
}

impl EarthSun {
    /// Illuminance in lux at which a white sheet appears as bright as under the Earth's light, with the whole Sun visible: π / exposure · 2^EV.
    ///
    /// At `Exposure::SUNLIGHT` it is 123 500 lx; the Sun above the atmosphere has 133 100.
    pub fn illuminance_lux(&self) -> f32 {
        let exposure = bevy::camera::Exposure { ev100: self.ev100 };
        // A diffuse sheet of reflectance 1 at E lux has the luminance E / π.
        PI / exposure.exposure() * self.earth_ev.exp2()
    }
}

pub(crate) fn aim_suns(
    earths: Query<(&EarthFrame, &EarthSky), With<Earth>>,
    mut suns: Query<(&EarthSun, &mut DirectionalLight, &mut Transform)>,
) {
    // With several Earths the cameras report the fault.
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
        // Over 0° E on the equator, ITRF's x is the world's up, and z is its north.
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
