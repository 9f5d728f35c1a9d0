//! Light, attitude and size of the craft, and its shader.

use super::*;
use crate::backends::compile_for_every_backend;
use crate::camera::Pose;
use glam::DVec4;
use std::mem::offset_of;
use terrella::frames::Geodetic;

const WGS84: Ellipsoid = Ellipsoid::WGS84;

/// A satellite over the equator at 0° E that flies east.
fn over_the_equator(height_m: f64) -> OrbitalMotion {
    OrbitalMotion {
        position_itrf_m: WGS84.itrf_from_geodetic(Geodetic::from_degrees(0.0, 0.0, height_m)),
        velocity_m_s: DVec3::Y * 7_600.0,
    }
}

/// The Sun so far from the zenith of that satellite, to the east.
fn sun_at(zenith_distance_rad: f64) -> Sky {
    let (sin, cos) = zenith_distance_rad.sin_cos();
    Sky::new(DVec3::new(cos, sin, 0.0))
}

#[test]
fn the_sun_sets_at_the_limb_and_softly() {
    for height_m in [1_000.0, 420_000.0, 35_786_000.0] {
        let motion = over_the_equator(height_m);
        let radius_m = WGS84.equatorial_radius_m;
        // The limb as seen over the equator, a circle: its zenith distance is 180° − asin(a/r).
        let limb = std::f64::consts::PI - (radius_m / (radius_m + height_m)).asin();
        let light =
            |above_rad: f64| CraftPose::new(&motion, &WGS84, &sun_at(limb - above_rad)).sunlight;
        assert_eq!(light(0.005), 1.0, "{height_m}");
        assert_eq!(light(-0.005), 0.0, "{height_m}");
        // The Sun's parallax from a geostationary craft is a thirtieth of its disc.
        assert!(
            (light(0.0) - 0.5).abs() < 0.05,
            "{height_m}: {}",
            light(0.0)
        );
        assert!(light(0.002) > light(0.001) && light(-0.001) > light(-0.002));
    }
}

#[test]
fn the_earth_shines_by_day_only_and_less_from_afar() {
    let shine = |height_m: f64, zenith_distance_rad: f64| {
        CraftPose::new(
            &over_the_equator(height_m),
            &WGS84,
            &sun_at(zenith_distance_rad),
        )
        .earthshine
    };
    let noon = shine(420_000.0, 0.0);
    assert!((0.2..0.3).contains(&noon), "{noon}");
    assert!(shine(420_000.0, 1.3) < 0.5 * noon);
    assert!(shine(420_000.0, 2.0) < 0.01 * noon);
    assert_eq!(shine(420_000.0, std::f64::consts::PI), 0.0);
    assert!(shine(35_786_000.0, 0.0) < 0.03 * noon);
}

#[test]
fn it_flies_forwards_with_its_instruments_down() {
    let pose = CraftPose::new(&over_the_equator(420_000.0), &WGS84, &sun_at(0.5));
    let axes = pose.itrf_from_craft;
    assert!(axes.x_axis.distance(DVec3::Y) < 1e-12);
    assert!(axes.z_axis.distance(DVec3::NEG_X) < 1e-12);
    assert!((axes.determinant() - 1.0).abs() < 1e-12);
}

#[test]
fn the_wings_turn_to_the_sun() {
    for sun in [
        DVec3::new(0.3, 0.5, -0.8),
        DVec3::new(-0.6, -0.2, 0.7),
        DVec3::X,
    ] {
        let turn = wing_turn(sun).as_dvec2();
        let cells = DVec3::new(-turn.y, 0.0, -turn.x);
        let best = sun.x.hypot(sun.z);
        assert!((cells.dot(sun) - best).abs() < 1e-6, "{sun}: {cells}");
    }
    assert_eq!(wing_turn(DVec3::Y), Vec2::X);
}

#[test]
fn a_chase_picture_has_it_in_the_middle_a_fifth_of_its_height() {
    let motion = over_the_equator(420_000.0);
    let sky = sun_at(0.4);
    let view = Pose::chase(&motion, &WGS84).view(45_f64.to_radians(), 16.0 / 9.0);
    let frame = CraftPose::new(&motion, &WGS84, &sky).frame(&view, &sky, 1.0);
    let clip_from_craft = frame.clip_from_craft.as_dmat4();
    let (mut low, mut high, mut left, mut right) = (1.0_f64, -1.0_f64, 1.0_f64, -1.0_f64);
    for vertex in mesh::vertices() {
        let p = vertex.position_m.as_dvec3();
        let clip = clip_from_craft * DVec4::new(p.x, p.y, p.z, 1.0);
        assert!(clip.w > 20.0, "{vertex:?} is at the eye");
        let (x, y) = (clip.x / clip.w, clip.y / clip.w);
        (low, high) = (low.min(y), high.max(y));
        (left, right) = (left.min(x), right.max(x));
    }
    let (height, width) = (0.5 * (high - low), 0.5 * (right - left));
    assert!((0.15..0.3).contains(&height), "{height} of the height");
    assert!((0.2..0.6).contains(&width), "{width} of the width");
    assert!(
        (low + high).abs() < 0.15 && (left + right).abs() < 0.01,
        "{low} {high}"
    );
    // The eye is behind and above.
    assert!(frame.eye.x < 0.0 && frame.eye.z < 0.0 && frame.eye.y.abs() < 1e-3);
}

#[test]
fn every_backend_takes_the_shader_and_its_struct_is_ours() {
    for target in TargetColor::all() {
        holds(&shader(target).expect("its files are there").text);
    }
}

fn holds(source: &str) {
    let module = compile_for_every_backend(source);
    let mut structs = module.types.iter().map(|(_, ty)| ty);
    let frame = structs.find(|ty| ty.name.as_deref() == Some("CraftFrame"));
    let Some(naga::TypeInner::Struct { members, span }) = frame.map(|ty| &ty.inner) else {
        panic!("no struct CraftFrame");
    };
    let theirs: Vec<_> = members
        .iter()
        .map(|m| (m.name.as_deref().unwrap_or_default(), m.offset as usize))
        .collect();
    macro_rules! ours {
        ($($member:ident),*) => { vec![$((stringify!($member), offset_of!(CraftFrame, $member))),*] };
    }
    let ours = ours![
        clip_from_craft,
        sun,
        sunlight,
        eye,
        earthshine,
        wing,
        exposure,
        padding
    ];
    assert_eq!(theirs, ours);
    assert_eq!(*span as usize, size_of::<CraftFrame>());
}
