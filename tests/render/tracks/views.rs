//! Tracks in a further view of an Earth.

use super::rig::{Circle, Rig, aspect, options};
use crate::common;
use terrella::Atmosphere;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::tracks::{TrackSpan, TrackStyle};

#[test]
fn tracks_of_a_further_view_are_those_of_an_earth_of_its_own() {
    let circle = Circle {
        radius_m: 7e6,
        inclination_rad: 0.9,
    };
    let style = TrackStyle {
        trail: Some(TrackSpan::TRAIL),
        marker: true,
        ..TrackStyle::new(0)
    };
    // From outside the air and from within, below the satellite: the pipelines of both are shared.
    let below = Ellipsoid::WGS84.geodetic_from_itrf(circle.as_seen_now(0.0));
    let below = Geodetic {
        height_m: 2e4,
        ..below
    };
    let eyes = [
        common::down(Geodetic::from_degrees(10.0, 20.0, 2e7), 50.0, aspect()),
        common::tilted(below, 90.0, 60.0, 70.0, aspect()),
    ];
    for atmosphere in [Atmosphere::Billboard, Atmosphere::None] {
        let make = || Rig::new(options(atmosphere), style);
        for (first, eye) in [(0, 1), (1, 0)] {
            let (alone, without, _) = make().draw(&eyes[eye], &circle);
            assert!(alone != without, "tracks are seen");
            let mut rig = make();
            let (before, _, sampled) = rig.draw(&eyes[first], &circle);
            let (further, stats) = rig.draw_further(&eyes[first], &eyes[eye], &circle);
            assert!(further == alone, "{atmosphere:?}, eye {eye}");
            // The samples are those that the first took.
            assert!(sampled.samples > 100);
            assert_eq!(stats.samples, 0);
            assert!(rig.draw(&eyes[first], &circle).0 == before);
        }
    }
}
