//! Strange projections, pictures, Suns and options, and what is not finite.

use super::cases::{ALL, ExtremeCase, Lit, Side, TOWARDS, centred, down, level, over};
use crate::EyeView;
use crate::frames::Ellipsoid;
use glam::{DAffine3, DMat3, DMat4, DVec3};

pub(super) fn cases() -> Vec<ExtremeCase> {
    [
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

fn fields_of_view() -> Vec<ExtremeCase> {
    let case = ExtremeCase::new;
    let view = |fov_rad: f64| EyeView::itrf(TOWARDS * 8e6, -TOWARDS, DVec3::Z, fov_rad, 1.0);
    vec![
        case(
            "field of view 0.001°",
            "the ground fills the picture",
            ALL,
            over(4e5, down, 0.001),
        ),
        case(
            "field of view 0.001° at 1 m",
            "the ground fills the picture",
            ALL,
            over(1.0, down, 0.001),
        ),
        case(
            "field of view 179°",
            "the Earth small in the middle",
            Lit::Pixels(1, 64),
            over(4e5, down, 179.0),
        ),
        case(
            "field of view 179° at 1 m",
            "the ground fills the picture",
            Lit::Share(0.9, 1.0),
            over(1.0, down, 179.0),
        ),
        case(
            "field of view 180°",
            "nothing, or the Earth within four pixels",
            Lit::Pixels(0, 4),
            view(std::f64::consts::PI),
        ),
        case(
            "no field of view",
            "nothing: the projection is not finite",
            Lit::Nothing,
            view(0.0),
        ),
        case(
            "field of view not a number",
            "nothing",
            Lit::Nothing,
            view(f64::NAN),
        ),
    ]
}

fn sizes() -> Vec<ExtremeCase> {
    let case = ExtremeCase::new;
    let view = centred(TOWARDS * 2e7, 20.0);
    vec![
        case("a picture of 1 × 1", "the ground", ALL, view).sides(Side::Pixels(1), Side::Pixels(1)),
        case("a picture of 1 × 4096", "the ground", ALL, view)
            .sides(Side::Pixels(1), Side::Pixels(4096)),
        case("a picture of 4096 × 1", "the ground", ALL, view)
            .sides(Side::Pixels(4096), Side::Pixels(1)),
        case(
            "a picture as wide as the adapter draws, 1 high",
            "the ground",
            ALL,
            view,
        )
        .sides(Side::Most, Side::Pixels(1)),
        case(
            "a picture as high as the adapter draws, 1 wide",
            "the ground",
            ALL,
            view,
        )
        .sides(Side::Pixels(1), Side::Most),
    ]
}

fn suns() -> Vec<ExtremeCase> {
    let case = ExtremeCase::new;
    let far = TOWARDS * 2e7;
    let view = centred(far, 60.0);
    vec![
        case(
            "Sun exactly behind the eye",
            "the full disc",
            Lit::Share(0.2, 0.35),
            view,
        )
        .sun(TOWARDS),
        case(
            "Sun exactly behind the Earth",
            "black: the limb's air stands in the shadow, the Sun 19° below its horizon",
            Lit::Nothing,
            view,
        )
        .sun(-TOWARDS),
        case(
            "Sun exactly behind the Earth at 1e9 m",
            "a ring of lit air about a black disc",
            Lit::Share(0.005, 0.1),
            centred(TOWARDS * 1e9, 0.8),
        )
        .sun(-TOWARDS)
        .sides(Side::Pixels(256), Side::Pixels(256)),
        case(
            "Sun exactly behind the Earth, no air",
            "the night side: black",
            Lit::Nothing,
            view,
        )
        .sun(-TOWARDS)
        .airless(),
        case(
            "looking into the Sun in the zenith from the ground",
            "the sky around the Sun",
            ALL,
            over(1.0, |up| up, 60.0),
        )
        .sun(Ellipsoid::normal(37f64.to_radians(), -52f64.to_radians())),
        case(
            "Sun exactly overhead at 400 km",
            "the ground fills the picture",
            ALL,
            over(4e5, down, 45.0),
        )
        .sun(Ellipsoid::normal(37f64.to_radians(), -52f64.to_radians())),
        case(
            "Sun along the axis, eye over the pole",
            "the full disc",
            Lit::Share(0.2, 0.35),
            centred(DVec3::Z * 2e7, 60.0),
        )
        .sun(DVec3::Z),
        case(
            "no Sun: a direction of length 0",
            "nothing: there is no day and no night",
            Lit::Nothing,
            view,
        )
        .sun(DVec3::ZERO),
        case(
            "a Sun of length 1e30",
            "the full disc, as with a Sun of length 1",
            Lit::Share(0.2, 0.35),
            view,
        )
        .sun(TOWARDS * 1e30),
        case(
            "a Sun of length 1e300",
            "the full disc, as with a Sun of length 1",
            Lit::Share(0.2, 0.35),
            view,
        )
        .sun(TOWARDS * 1e300),
    ]
}

fn looking_away() -> Vec<ExtremeCase> {
    let case = ExtremeCase::new;
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
        case(
            "looking exactly away at 2e7 m",
            "black",
            Lit::Nothing,
            away(2e7),
        ),
        case(
            "looking exactly away at 400 km",
            "black",
            Lit::Nothing,
            away(6.778e6),
        ),
        case(
            "looking exactly away at 1e12 m",
            "black",
            Lit::Nothing,
            away(1e12),
        ),
        case(
            "up on screen along the direction of view",
            "the full disc",
            Lit::Share(0.2, 0.35),
            EyeView::itrf(TOWARDS * 2e7, -TOWARDS, TOWARDS, 60f64.to_radians(), 1.0),
        ),
    ]
}

fn not_finite() -> Vec<ExtremeCase> {
    let good = centred(TOWARDS * 2e7, 60.0);
    let nothing = |name, view| ExtremeCase::new(name, "nothing", Lit::Nothing, view);
    let eye = |eye_world| EyeView { eye_world, ..good };
    vec![
        nothing("eye not a number", eye(DVec3::NAN)),
        nothing("eye infinitely far", eye(DVec3::INFINITY)),
        nothing("Sun not a number", good).sun(DVec3::NAN),
        nothing("Sun infinitely long", good).sun(DVec3::INFINITY),
        nothing(
            "projection not a number",
            EyeView {
                clip_from_view: DMat4::NAN,
                ..good
            },
        ),
        nothing(
            "projection of zeros",
            EyeView {
                clip_from_view: DMat4::ZERO,
                ..good
            },
        ),
        nothing(
            "projection of zeros, eye in the air",
            EyeView {
                clip_from_view: DMat4::ZERO,
                ..over(1e3, level, 60.0)
            },
        ),
        nothing(
            "direction of view not a number",
            EyeView {
                view_from_world: glam::DQuat::from_xyzw(f64::NAN, 0.0, 0.0, 1.0),
                ..good
            },
        ),
        nothing(
            "a world without size",
            EyeView {
                itrf_from_world: DAffine3::from_mat3(DMat3::ZERO),
                ..good
            },
        ),
        nothing(
            "aspect 0",
            EyeView::itrf(TOWARDS * 2e7, -TOWARDS, DVec3::Z, 1.0, 0.0),
        ),
        nothing(
            "aspect infinite",
            EyeView::itrf(TOWARDS * 1e7, -TOWARDS, DVec3::Z, 1.0, f64::INFINITY),
        ),
        nothing("aspect infinite, eye in the air", {
            let view = over(1e3, level, 60.0);
            EyeView::itrf(view.eye_world, DVec3::X, DVec3::Z, 1.0, f64::INFINITY)
        }),
    ]
}

fn options() -> Vec<ExtremeCase> {
    let good = centred(TOWARDS * 2e7, 60.0);
    let refused = |name, part| {
        ExtremeCase::new(
            name,
            "an error that says what is allowed",
            Lit::Refused(part),
            good,
        )
    };
    let exposed = |name, exposure| ExtremeCase {
        exposure,
        ..refused(name, "exposure")
    };
    let subdivided = |name, subdivision| ExtremeCase {
        subdivision,
        ..refused(name, "subdivision")
    };
    vec![
        exposed("exposure not a number", f32::NAN),
        exposed("exposure infinite", f32::INFINITY),
        exposed("exposure below 0", -1.0),
        ExtremeCase {
            exposure: 0.0,
            ..ExtremeCase::new("exposure 0", "black", Lit::Nothing, good)
        },
        subdivided("subdivision 0", 0),
        subdivided("subdivision 49", 49),
    ]
}
