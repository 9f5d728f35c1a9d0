//! When satellites go through the Earth's shadow.

use crate::{config, utc};
use terrella_frames::{
    Duration, Ellipsoid, Epoch, Illumination, Orientation, illumination, sun_position_itrf_m,
};
use terrella_orbit::{Feed, TleFeed};

/// Contacts of the whole disc and the shadow by another program: skyfield 1.55 propagates the sets of `config/orbits`, JPL's DE421 gives the
/// apparent Sun from the Earth, and of 1 440 rays to its limb those count that miss the ellipsoid. The times at which the first and the last of
/// them is hidden were found by bisection to a millisecond.
const CONTACTS: [(&str, Illumination, &str); 12] = {
    use Illumination::{Penumbra, Umbra};
    [
        ("iss.tle", Umbra, "2018-01-20T20:23:08.557Z"),
        ("iss.tle", Penumbra, "2018-01-20T20:23:18.630Z"),
        ("iss.tle", Penumbra, "2018-01-20T21:21:39.307Z"),
        ("iss.tle", Umbra, "2018-01-20T21:21:49.375Z"),
        ("iss.tle", Umbra, "2018-01-20T21:55:50.601Z"),
        ("iss.tle", Penumbra, "2018-01-20T21:56:00.675Z"),
        ("iss.tle", Penumbra, "2018-01-20T22:54:21.466Z"),
        ("iss.tle", Umbra, "2018-01-20T22:54:31.536Z"),
        ("iss.tle", Umbra, "2018-01-20T23:28:32.655Z"),
        ("iss.tle", Penumbra, "2018-01-20T23:28:42.730Z"),
        ("iss.tle", Penumbra, "2018-01-21T00:27:03.617Z"),
        ("iss.tle", Umbra, "2018-01-21T00:27:13.689Z"),
    ]
};

fn state(feed: &TleFeed, epoch: Epoch) -> (Illumination, f64) {
    let position = feed.state_at(epoch).unwrap().position_itrf_m();
    let sun = sun_position_itrf_m(epoch, &Orientation::default());
    illumination(position, sun, &Ellipsoid::WGS84)
}

/// Whether a position is at least as dark.
fn is_in(light: Illumination, shadow: Illumination) -> bool {
    light == shadow || light == Illumination::Umbra
}

#[test]
fn shadows_are_entered_and_left_in_time() {
    let mut worst: f64 = 0.0;
    for (file, shadow, expected) in CONTACTS {
        let (feed, expected) = (config(file), utc(expected));
        let inside = |seconds: f64| {
            let epoch = expected + Duration::from_seconds(seconds);
            is_in(state(&feed, epoch).0, shadow)
        };
        let (mut low, mut high) = (-4.0, 4.0);
        let begins = inside(low);
        assert_ne!(begins, inside(high), "{file} {shadow:?} {expected}");
        while high - low > 1e-3 {
            let middle = 0.5 * (low + high);
            match inside(middle) == begins {
                true => low = middle,
                false => high = middle,
            }
        }
        worst = worst.max(low.abs());
    }
    println!("contacts within {worst:.3} s");
    assert!(worst < 0.1, "{worst} s");
}

#[test]
fn sunlight_fades_through_the_penumbra() {
    let feed = config("iss.tle");
    let begin = utc("2018-01-20T21:21:38Z");
    let mut before = 1.0;
    for step in 0..130 {
        let epoch = begin + Duration::from_seconds(0.1 * f64::from(step));
        let (light, share) = state(&feed, epoch);
        assert!(share <= before && before - share < 0.02, "{share}");
        match light {
            Illumination::Sunlit => assert_eq!(share, 1.0),
            Illumination::Penumbra => assert!(share > 0.0 && share < 1.0),
            Illumination::Umbra => assert_eq!(share, 0.0),
        }
        before = share;
    }
    assert_eq!(before, 0.0);
}
