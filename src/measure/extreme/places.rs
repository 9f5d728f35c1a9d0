//! Eyes in strange places.

use super::cases::{ALL, ExtremeCase, Lit, TOWARDS, centred, down, level, over};
use crate::EyeView;
use crate::frames::Ellipsoid;
use glam::DVec3;

pub(super) fn cases() -> Vec<ExtremeCase> {
    [near_the_ground(), on_the_axis(), inside(), far_away()]
        .into_iter()
        .flatten()
        .collect()
}

fn near_the_ground() -> Vec<ExtremeCase> {
    let case = ExtremeCase::new;
    vec![
        case(
            "eye 1 m above the ground, straight down",
            "the ground fills the picture",
            ALL,
            over(1.0, down, 60.0),
        ),
        case(
            "eye 1 m above the ground, level",
            "day sky above, ground below, a dark line between: the mesh ends 0.5° short of the horizon",
            ALL,
            over(1.0, level, 60.0),
        ),
        case(
            "eye 1 m above the ground, level, no air",
            "black above the horizon, ground below",
            Lit::Share(0.45, 0.55),
            over(1.0, level, 60.0),
        )
        .airless(),
        case(
            "eye 1 mm above the ground, straight down",
            "the ground fills the picture",
            ALL,
            over(1e-3, down, 60.0),
        ),
        case(
            "eye on the ground, level",
            "day sky above, ground below, a dark line between",
            Lit::Share(0.95, 1.0),
            over(0.0, level, 60.0),
        ),
        case(
            "eye 1 m above the ground at midnight",
            "black ground under a black sky",
            Lit::Nothing,
            over(1.0, level, 60.0),
        )
        .sun(-over(1.0, down, 60.0).eye_world.normalize()),
    ]
}

fn on_the_axis() -> Vec<ExtremeCase> {
    let case = ExtremeCase::new;
    let b = Ellipsoid::WGS84.polar_radius_m;
    let z = |height_m: f64| DVec3::new(0.0, 0.0, b + height_m);
    vec![
        case(
            "eye exactly over the north pole at 400 km",
            "the ground fills the picture",
            ALL,
            centred(z(4e5), 45.0),
        ),
        case(
            "eye exactly over the south pole at 400 km",
            "the ground fills the picture",
            ALL,
            centred(-z(4e5), 45.0),
        ),
        case(
            "eye 1 m above the north pole",
            "the ground fills the picture",
            ALL,
            centred(z(1.0), 60.0),
        ),
        case(
            "eye 1 m above the south pole",
            "the ground fills the picture",
            ALL,
            centred(-z(1.0), 60.0),
        ),
        case(
            "eye on the axis, far, up along the axis",
            "the whole disc in the middle",
            Lit::Share(0.25, 0.40),
            EyeView::itrf(z(2e7), -z(2e7), DVec3::Z, 40f64.to_radians(), 1.0),
        ),
        case(
            "eye 1 m above the pole, level",
            "day sky above, ground below",
            ALL,
            EyeView::itrf(z(1.0), DVec3::X, DVec3::Z, 1.0, 1.0),
        ),
    ]
}

fn inside() -> Vec<ExtremeCase> {
    let case = ExtremeCase::new;
    let deep = DVec3::new(2e6, -1e6, 1.5e6);
    vec![
        case(
            "eye inside the Earth, looking down, no air",
            "nothing: the ground is seen from above only",
            Lit::Nothing,
            centred(deep, 60.0),
        )
        .airless(),
        case(
            "eye inside the Earth, looking up, no air",
            "nothing: the ground is seen from above only",
            Lit::Nothing,
            EyeView::itrf(deep, deep, DVec3::Z, 1.0, 1.0),
        )
        .airless(),
        case(
            "eye inside the Earth, looking up",
            "the sky as from the ground above",
            ALL,
            EyeView::itrf(deep, deep, DVec3::Z, 1.0, 1.0),
        ),
        case(
            "eye inside the Earth, looking down",
            "no ground and no air towards it",
            Lit::Nothing,
            centred(deep, 60.0),
        ),
        case(
            "eye 1 mm below the ground, looking up",
            "the sky as from the ground",
            ALL,
            over(-1e-3, |up| up, 60.0),
        ),
        case(
            "eye at the centre",
            "a defined picture, with or without sky",
            Lit::Share(0.0, 1.0),
            EyeView::itrf(DVec3::ZERO, DVec3::X, DVec3::Z, 1.0, 1.0),
        ),
        case(
            "eye at the centre, no direction, no air",
            "nothing",
            Lit::Nothing,
            EyeView::itrf(DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, 1.0, 1.0),
        )
        .airless(),
    ]
}

fn far_away() -> Vec<ExtremeCase> {
    let case = ExtremeCase::new;
    let eye = |distance_m: f64| TOWARDS * distance_m;
    vec![
        case(
            "eye at 1e12 m",
            "black, or the Earth as one point",
            Lit::Pixels(0, 1),
            centred(eye(1e12), 45.0),
        ),
        case(
            "eye at 1e12 m through 0.001°",
            "the Earth's disc, 0.0007° wide",
            Lit::Share(0.30, 0.55),
            centred(eye(1e12), 0.001),
        ),
        case(
            "eye at 1e20 m",
            "black",
            Lit::Nothing,
            centred(eye(1e20), 45.0),
        ),
        case(
            "eye at 1e30 m",
            "black",
            Lit::Nothing,
            centred(eye(1e30), 45.0),
        ),
        case(
            "eye at 1e300 m",
            "black",
            Lit::Nothing,
            centred(eye(1e300), 45.0),
        ),
    ]
}
