//! The list of cases: extreme eyes, projections, sizes, Suns and options, and non-finite values.
//!
//! Each row of the table is a case: name, expected result as text and as a number, the view.

use super::case::{ExtremeCase, Lit, Side};
use glam::{DAffine3, DMat3, DMat4, DVec3};
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{Exposure, EyeView, Subdivision};

/// Every case, in the order of the report.
pub fn cases() -> Vec<ExtremeCase> {
    [
        near_the_ground(),
        on_the_axis(),
        inside(),
        far_away(),
        fields_of_view(),
        sizes(),
        suns(),
        looking_away(),
        not_finite(),
        options(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Every pixel.
const ALL: Lit = Lit::Share(1.0, 1.0);
/// No particular direction, of length 1.
const TOWARDS: DVec3 = DVec3::new(0.36, -0.48, 0.8);

fn case(name: &'static str, expected: &'static str, lit: Lit, view: EyeView) -> ExtremeCase {
    ExtremeCase::new(name, expected, lit, view)
}

/// An eye at `height_m` over 37° N, 52° W that looks along `forward`, a function of the direction upwards.
fn over(height_m: f64, forward: impl Fn(DVec3) -> DVec3, fov_deg: f64) -> EyeView {
    let place = Geodetic::from_degrees(37.0, -52.0, height_m);
    let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let eye = Ellipsoid::WGS84.itrf_from_geodetic(place);
    EyeView::itrf(eye, forward(up), DVec3::Z, fov_deg.to_radians(), 1.0)
}

/// An eye that looks at the Earth's centre.
fn centred(eye: DVec3, fov_deg: f64) -> EyeView {
    EyeView::itrf(eye, -eye, DVec3::Z, fov_deg.to_radians(), 1.0)
}

/// An eye with a field of view of one radian.
fn looking(eye: DVec3, forward: DVec3) -> EyeView {
    EyeView::itrf(eye, forward, DVec3::Z, 1.0, 1.0)
}

/// Straight down.
fn down(up: DVec3) -> DVec3 {
    -up
}

/// West along the ground.
fn level(up: DVec3) -> DVec3 {
    up.cross(DVec3::Z).normalize_or_zero()
}

#[rustfmt::skip]
fn near_the_ground() -> Vec<ExtremeCase> {
    vec![
        case("eye 1 m above the ground, straight down", "the ground fills the picture", ALL, over(1.0, down, 60.0)),
        case("eye 1 m above the ground, level", "day sky above, ground below", ALL, over(1.0, level, 60.0)),
        case("eye 1 m above the ground, level, no air", "black above the horizon, ground below",
            Lit::Share(0.45, 0.55), over(1.0, level, 60.0)).airless(),
        case("eye 1 mm above the ground, straight down", "the ground fills the picture", ALL, over(1e-3, down, 60.0)),
        case("eye on the ground, level", "day sky above, ground below", Lit::Share(0.99, 1.0), over(0.0, level, 60.0)),
        case("eye 1 m above the ground at midnight", "black ground under a black sky",
            Lit::Nothing, over(1.0, level, 60.0)).sun(-over(1.0, down, 60.0).eye_world.normalize()),
    ]
}

#[rustfmt::skip]
fn on_the_axis() -> Vec<ExtremeCase> {
    let b = Ellipsoid::WGS84.polar_radius_m;
    let z = |height_m: f64| DVec3::new(0.0, 0.0, b + height_m);
    vec![
        case("eye exactly over the north pole at 400 km", "the ground fills the picture", ALL, centred(z(4e5), 45.0)),
        case("eye exactly over the south pole at 400 km", "the ground fills the picture", ALL, centred(-z(4e5), 45.0)),
        case("eye 1 m above the north pole", "the ground fills the picture", ALL, centred(z(1.0), 60.0)),
        case("eye 1 m above the south pole", "the ground fills the picture", ALL, centred(-z(1.0), 60.0)),
        case("eye on the axis, far, up along the axis", "the whole disc in the middle",
            Lit::Share(0.25, 0.40), EyeView::itrf(z(2e7), -z(2e7), DVec3::Z, 40f64.to_radians(), 1.0)),
        case("eye 1 m above the pole, level", "day sky above, ground below", ALL, looking(z(1.0), DVec3::X)),
    ]
}

#[rustfmt::skip]
fn inside() -> Vec<ExtremeCase> {
    let deep = DVec3::new(2e6, -1e6, 1.5e6);
    vec![
        case("eye inside the Earth, looking down, no air", "nothing: the ground is seen from above only",
            Lit::Nothing, centred(deep, 60.0)).airless(),
        case("eye inside the Earth, looking up, no air", "nothing: the ground is seen from above only",
            Lit::Nothing, looking(deep, deep)).airless(),
        case("eye inside the Earth, looking up", "the sky as from the ground above", ALL, looking(deep, deep)),
        case("eye inside the Earth, looking down", "no ground and no air towards it", Lit::Nothing, centred(deep, 60.0)),
        case("eye 1 mm below the ground, looking up", "the sky as from the ground", ALL, over(-1e-3, |up| up, 60.0)),
        case("eye at the centre", "a defined picture, with or without sky", Lit::Share(0.0, 1.0), looking(DVec3::ZERO, DVec3::X)),
        case("eye at the centre, no direction, no air", "nothing",
            Lit::Nothing, EyeView::itrf(DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, 1.0, 1.0)).airless(),
    ]
}

#[rustfmt::skip]
fn far_away() -> Vec<ExtremeCase> {
    let eye = |distance_m: f64| TOWARDS * distance_m;
    vec![
        case("eye at 1e12 m", "black, or the Earth as one point", Lit::Pixels(0, 1), centred(eye(1e12), 45.0)),
        case("eye at 1e12 m through 0.001°", "the Earth's disc, 0.0007° wide", Lit::Share(0.30, 0.55), centred(eye(1e12), 0.001)),
        case("eye at 1e20 m", "black", Lit::Nothing, centred(eye(1e20), 45.0)),
        case("eye at 1e30 m", "black", Lit::Nothing, centred(eye(1e30), 45.0)),
        case("eye at 1e300 m", "black", Lit::Nothing, centred(eye(1e300), 45.0)),
    ]
}

#[rustfmt::skip]
fn fields_of_view() -> Vec<ExtremeCase> {
    let view = |fov_rad: f64| EyeView::itrf(TOWARDS * 8e6, -TOWARDS, DVec3::Z, fov_rad, 1.0);
    vec![
        case("field of view 0.001°", "the ground fills the picture", ALL, over(4e5, down, 0.001)),
        case("field of view 0.001° at 1 m", "the ground in part: corners kilometres off are rounded by more than a pixel", Lit::Share(0.2, 1.0),
            over(1.0, down, 0.001)),
        case("field of view 179°", "the Earth small in the middle", Lit::Pixels(1, 64), over(4e5, down, 179.0)),
        case("field of view 179° at 1 m", "the ground fills the picture", Lit::Share(0.9, 1.0), over(1.0, down, 179.0)),
        case("field of view 180°", "nothing, or the Earth within four pixels", Lit::Pixels(0, 4), view(std::f64::consts::PI)),
        case("no field of view", "nothing: the projection is not finite", Lit::Nothing, view(0.0)),
        case("field of view not a number", "nothing", Lit::Nothing, view(f64::NAN)),
    ]
}

#[rustfmt::skip]
fn sizes() -> Vec<ExtremeCase> {
    let view = centred(TOWARDS * 2e7, 20.0);
    vec![
        case("a picture of 1 × 1", "the ground", ALL, view).sides(Side::Pixels(1), Side::Pixels(1)),
        case("a picture of 1 × 4096", "the ground", ALL, view).sides(Side::Pixels(1), Side::Pixels(4096)),
        case("a picture of 4096 × 1", "the ground", ALL, view).sides(Side::Pixels(4096), Side::Pixels(1)),
        case("a picture as wide as the adapter draws, 1 high", "the ground", ALL, view).sides(Side::Max, Side::Pixels(1)),
        case("a picture as high as the adapter draws, 1 wide", "the ground", ALL, view).sides(Side::Pixels(1), Side::Max),
    ]
}

#[rustfmt::skip]
fn suns() -> Vec<ExtremeCase> {
    let far = TOWARDS * 2e7;
    let view = centred(far, 60.0);
    vec![
        case("Sun exactly behind the eye", "the full disc", Lit::Share(0.2, 0.35), view).sun(TOWARDS),
        case("Sun exactly behind the Earth", "black: the limb's air stands in the shadow, the Sun 19° below its horizon",
            Lit::Nothing, view).sun(-TOWARDS),
        case("Sun exactly behind the Earth at 1e9 m", "a ring of lit air about a black disc",
            Lit::Share(0.005, 0.1), centred(TOWARDS * 1e9, 0.8)).sun(-TOWARDS).sides(Side::Pixels(256), Side::Pixels(256)),
        case("Sun exactly behind the Earth, no air", "the night side: black", Lit::Nothing, view).sun(-TOWARDS).airless(),
        case("looking into the Sun in the zenith from the ground", "the sky around the Sun",
            ALL, over(1.0, |up| up, 60.0)).sun(Ellipsoid::normal(37f64.to_radians(), -52f64.to_radians())),
        case("Sun exactly overhead at 400 km", "the ground fills the picture",
            ALL, over(4e5, down, 45.0)).sun(Ellipsoid::normal(37f64.to_radians(), -52f64.to_radians())),
        case("Sun along the axis, eye over the pole", "the full disc",
            Lit::Share(0.2, 0.35), centred(DVec3::Z * 2e7, 60.0)).sun(DVec3::Z),
        case("no Sun: a direction of length 0", "nothing: there is no day and no night", Lit::Nothing, view).sun(DVec3::ZERO),
        case("a Sun of length 1e30", "the full disc, as with a Sun of length 1", Lit::Share(0.2, 0.35), view).sun(TOWARDS * 1e30),
        case("a Sun of length 1e300", "the full disc, as with a Sun of length 1", Lit::Share(0.2, 0.35), view).sun(TOWARDS * 1e300),
    ]
}

#[rustfmt::skip]
fn looking_away() -> Vec<ExtremeCase> {
    let away = |distance_m: f64| {
        EyeView::itrf(
            TOWARDS * distance_m,
            TOWARDS,
            DVec3::Z,
            60f64.to_radians(),
            1.0,
        )
    };
    vec![
        case("looking exactly away at 2e7 m", "black", Lit::Nothing, away(2e7)),
        case("looking exactly away at 400 km", "black", Lit::Nothing, away(6.778e6)),
        case("looking exactly away at 1e12 m", "black", Lit::Nothing, away(1e12)),
        case("up on screen along the direction of view", "the full disc",
            Lit::Share(0.2, 0.35), EyeView::itrf(TOWARDS * 2e7, -TOWARDS, TOWARDS, 60f64.to_radians(), 1.0)),
    ]
}

#[rustfmt::skip]
fn not_finite() -> Vec<ExtremeCase> {
    let good = centred(TOWARDS * 2e7, 60.0);
    let nothing = |name, view| case(name, "nothing", Lit::Nothing, view);
    let eye = |eye_world| EyeView { eye_world, ..good };
    vec![
        nothing("eye not a number", eye(DVec3::NAN)),
        nothing("eye infinitely far", eye(DVec3::INFINITY)),
        nothing("Sun not a number", good).sun(DVec3::NAN),
        nothing("Sun infinitely long", good).sun(DVec3::INFINITY),
        nothing("projection not a number", EyeView { clip_from_view: DMat4::NAN, ..good }),
        nothing("projection of zeros", EyeView { clip_from_view: DMat4::ZERO, ..good }),
        nothing("projection of zeros, eye in the air", EyeView { clip_from_view: DMat4::ZERO, ..over(1e3, level, 60.0) }),
        nothing("direction of view not a number", EyeView { view_from_world: glam::DQuat::from_xyzw(f64::NAN, 0.0, 0.0, 1.0), ..good }),
        nothing("a world without size", EyeView { itrf_from_world: DAffine3::from_mat3(DMat3::ZERO), ..good }),
        nothing("aspect 0", EyeView::itrf(TOWARDS * 2e7, -TOWARDS, DVec3::Z, 1.0, 0.0)),
        nothing("aspect infinite", EyeView::itrf(TOWARDS * 1e7, -TOWARDS, DVec3::Z, 1.0, f64::INFINITY)),
        nothing("aspect infinite, eye in the air", { let view = over(1e3, level, 60.0); EyeView::itrf(view.eye_world, DVec3::X, DVec3::Z, 1.0, f64::INFINITY) }),
    ]
}

#[rustfmt::skip]
fn options() -> Vec<ExtremeCase> {
    let good = centred(TOWARDS * 2e7, 60.0);
    let rejected = |name, part| {
        case(
            name,
            "an error that says what is allowed",
            Lit::Rejected(part),
            good,
        )
    };
    let exposed = |name, ev| ExtremeCase {
        exposure: Exposure::Ev(ev),
        ..rejected(name, "exposure")
    };
    let subdivided = |name, subdivision| ExtremeCase {
        subdivision: Subdivision::Cells(subdivision),
        ..rejected(name, "subdivision")
    };
    vec![
        exposed("exposure not a number", f64::NAN),
        exposed("exposure infinite", f64::INFINITY),
        exposed("exposure too large", 20.1),
        ExtremeCase { exposure: Exposure::Ev(-20.0), ..case("exposure −20 EV", "black but for a few dithered pixels", Lit::Pixels(0, 10), good) },
        ExtremeCase { exposure: Exposure::Ev(20.0), ..case("exposure 20 EV", "the disc and its air in white", Lit::Share(0.2, 0.4), good) },
        subdivided("subdivision 0", 0),
        subdivided("subdivision 49", 49),
    ]
}
