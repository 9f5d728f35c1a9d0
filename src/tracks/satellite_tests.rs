//! Curves of real orbits: position, smoothness and ends.

use super::*;
use terrella_frames::{Geodetic, utc_from_rfc3339};
use terrella_orbit::kepler::{Anomaly, KeplerElements, KeplerFeed, KeplerOptions, OrbitSize};
use terrella_orbit::{OrbitError, Sgp4Feed};

const WGS84: Ellipsoid = Ellipsoid::WGS84;
const PASS: PassFormat = PassFormat {
    color: crate::gpu::FrameTargets::COLOR,
    further: &[],
    samples: 1,
    depth: crate::gpu::FrameTargets::REVERSED_DEPTH,
    development: crate::gpu::Development::InPass,
    tone: terrella_ground::light::Tone::Camera,
    bloom: terrella_ground::light::Bloom { strength: 0.0 },
    grade: terrella_ground::light::Grade::NONE,
};

fn utc(text: &str) -> Epoch {
    utc_from_rfc3339(text).unwrap_or_else(|error| panic!("{error}"))
}

fn kepler(periapsis_m: f64, eccentricity: f64, inclination_deg: f64) -> KeplerFeed {
    let elements = KeplerElements {
        size: OrbitSize::Periapsis(periapsis_m),
        eccentricity,
        inclination_rad: f64::to_radians(inclination_deg),
        raan_rad: 1.0,
        argument_of_periapsis_rad: 4.7,
        anomaly: Anomaly::Mean(0.4),
    };
    let options = KeplerOptions {
        drift: terrella_orbit::kepler::Drift::None,
        first: utc("1900-01-01T00:00:00Z"),
        last: utc("2099-12-31T00:00:00Z"),
    };
    KeplerFeed::from_elements(
        "Test",
        Frame::Gcrf,
        utc("2018-01-15T12:00:00Z"),
        &elements,
        options,
    )
    .unwrap_or_else(|error| panic!("{error}"))
}

fn both(trail: TrackSpan, ground_track: TrackSpan) -> TrackStyle {
    TrackStyle {
        trail: Some(trail),
        ground_track: Some(ground_track),
        marker: true,
        subpoint: true,
        ..TrackStyle::new(0)
    }
}

/// Updates a satellite to a time: whether its curves are complete, and the number of states requested.
fn follow(satellite: &mut Satellite, feed: &dyn Feed, at: Epoch) -> (bool, usize) {
    let mut axes = Axes::new(at, Orientation::default(), None);
    let mut budget = 100_000;
    let is_whole = satellite.follow(feed, &mut axes, &WGS84, &mut budget, false);
    (is_whole, 100_000 - budget)
}

/// The trail in the Earth-fixed axes of that time, and the ground track, with seconds relative to it.
fn curves(satellite: &Satellite, at: Epoch) -> [Vec<(f64, DVec3)>; 2] {
    let mut axes = Axes::new(at, Orientation::default(), None);
    let reference = satellite
        .reference
        .unwrap_or_else(|| panic!("nothing is known"));
    let turn = axes.itrf_from(reference.frame);
    let (mut trail, mut ground) = (Vec::new(), Vec::new());
    let now_s = satellite.now_s;
    if let (Some(curve), Some(span)) = (&satellite.trail, satellite.style.trail) {
        curve.walk(
            reference.window(span, now_s),
            satellite.now_m,
            |t_s, place| {
                trail.push((t_s - now_s, turn * place));
            },
        );
    }
    if let (Some(curve), Some(span)) = (&satellite.ground, satellite.style.ground_track) {
        let foot = satellite.now_m.map(|place| subpoint(turn * place, &WGS84));
        curve.walk(reference.window(span, now_s), foot, |t_s, place| {
            ground.push((t_s - now_s, place));
        });
    }
    [trail, ground]
}

/// Largest turn from one chord to the next, radians.
fn sharpest(points: &[(f64, DVec3)]) -> f64 {
    let turns = points.windows(3).filter_map(|three| {
        let (a, b) = (three[1].1 - three[0].1, three[2].1 - three[1].1);
        (a.length() > 1.0 && b.length() > 1.0).then(|| a.angle_between(b))
    });
    turns.fold(0.0, f64::max)
}

#[test]
fn the_trail_of_a_molniya_orbit_is_a_smooth_closed_ellipse_with_the_satellite_on_it() {
    let feed = kepler(6_971_000.0, 0.735, 63.4);
    for hours in 0..12 {
        let at = utc("2018-01-15T12:00:00Z") + Duration::from_seconds(3600.0 * f64::from(hours));
        let mut satellite = Satellite::new(
            &both(TrackSpan::TRAIL, TrackSpan::GROUND_TRACK),
            &PASS,
            16_384,
        );
        let (is_whole, taken) = follow(&mut satellite, &feed, at);
        let [trail, ground] = curves(&satellite, at);
        assert!(is_whole && taken < 3500, "{taken}");
        let place = feed
            .state_at(at)
            .unwrap_or_else(|e| panic!("{e}"))
            .position_itrf_m();
        let last = trail[trail.len() - 1];
        assert_eq!(last.0, 0.0);
        assert!(last.1.distance(place) < 1.0, "{hours}");
        assert!(
            trail[0].1.distance(place) < 5e3,
            "not closed by {}",
            trail[0].1.distance(place)
        );
        // Steps are half a degree of the radius vector; at the apogee the path turns r(1 + e)/(a(1 − e²)) times as fast, a factor of four.
        assert!(sharpest(&trail) < 0.04, "{hours}: {}", sharpest(&trail));
        assert!(ground.len() > 700, "{}", ground.len());
    }
}

#[test]
fn ground_tracks_are_the_feet_of_later_and_earlier_places() {
    let iss = Sgp4Feed::built_in_iss().unwrap_or_else(|error| panic!("{error}"));
    let polar = kepler(7_100_000.0, 0.0, 90.0);
    let feeds: [&dyn Feed; 2] = [&iss, &polar];
    for feed in feeds {
        let at = utc("2018-01-19T00:30:00Z");
        let span = TrackSpan::Seconds {
            before_s: 12_000.0,
            after_s: 12_000.0,
        };
        let mut satellite = Satellite::new(&both(TrackSpan::TRAIL, span), &PASS, 16_384);
        follow(&mut satellite, feed, at);
        let [_, ground] = curves(&satellite, at);
        assert!((ground[0].0 + 12_000.0).abs() < 1e-6);
        assert!((ground[ground.len() - 1].0 - 12_000.0).abs() < 1e-6);
        let mut crossings = 0;
        for pair in ground.windows(2) {
            // In space there is neither date line nor pole: consecutive points are close.
            assert!(
                pair[0].1.distance(pair[1].1) < 70e3,
                "{} {}",
                feed.name(),
                pair[0].0
            );
            crossings += u32::from(pair[0].1.x < 0.0 && pair[0].1.y * pair[1].1.y < 0.0);
        }
        assert!(crossings >= 2, "{crossings} crossings of the date line");
        for (k, (t_s, place)) in ground.iter().enumerate() {
            let state = feed.state_at(at + Duration::from_seconds(*t_s));
            let there = state
                .unwrap_or_else(|error| panic!("{error}"))
                .position_itrf_m();
            let exact = WGS84.geodetic_from_itrf(there);
            let exact = WGS84.itrf_from_geodetic(Geodetic {
                height_m: 0.0,
                ..exact
            });
            // Cut ends lie on chords; the Earth rotates at its mean rate.
            let allowed = if k == 0 || k + 1 == ground.len() {
                100.0
            } else {
                5.0
            };
            let off = exact.distance(*place);
            assert!(off < allowed, "{} {t_s}: {off} m", feed.name());
            assert!(
                k + 1 == ground.len()
                    || k == 0
                    || WGS84.geodetic_from_itrf(*place).height_m.abs() < 1e-6
            );
        }
    }
}

#[test]
fn in_steady_state_few_states_are_asked_for() {
    let iss = Sgp4Feed::built_in_iss().unwrap_or_else(|error| panic!("{error}"));
    let at = utc("2018-01-19T00:30:00Z");
    let style = both(TrackSpan::TRAIL, TrackSpan::GROUND_TRACK);
    let mut satellite = Satellite::new(&style, &PASS, 16_384);
    let (_, first) = follow(&mut satellite, &iss, at);
    let mut then = 0;
    for frame in 1..=600 {
        // Sixty times real time, sixty frames a second.
        let (is_whole, taken) = follow(
            &mut satellite,
            &iss,
            at + Duration::from_seconds(f64::from(frame)),
        );
        assert!(is_whole && taken <= 4, "{frame}: {taken}");
        then += taken;
    }
    println!("{first} states at first, {then} for 600 s");
    assert!(
        (1200..1800).contains(&first) && then < 200,
        "{first} {then}"
    );
    // A jump to another day starts again; backwards too.
    let (is_whole, taken) = follow(&mut satellite, &iss, at - Duration::from_seconds(86_400.0));
    assert!(is_whole && taken < 2000, "{taken}");
}

/// The space station, with a limited validity.
struct Known {
    iss: Sgp4Feed,
    span: (Epoch, Epoch),
    /// Whether it declares the validity.
    is_honest: bool,
}

impl Feed for Known {
    fn name(&self) -> &str {
        "Known"
    }

    fn validity(&self) -> (Epoch, Epoch) {
        match self.is_honest {
            true => self.span,
            false => self.iss.validity(),
        }
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        let at = match (self.span.0..=self.span.1).contains(&epoch) {
            true => epoch,
            // Far outside SGP4's validity.
            false => utc("2099-01-01T00:00:00Z"),
        };
        self.iss.state_at(at)
    }
}

#[test]
fn curves_end_with_what_is_known() {
    let at = utc("2018-01-19T00:30:00Z");
    let hour = Duration::from_seconds(3600.0);
    let style = both(
        TrackSpan::Seconds {
            before_s: 1000.0,
            after_s: 1000.0,
        },
        TrackSpan::Seconds {
            before_s: 1000.0,
            after_s: 1000.0,
        },
    );
    for is_honest in [true, false] {
        let iss = Sgp4Feed::built_in_iss().unwrap_or_else(|error| panic!("{error}"));
        let feed = Known {
            iss,
            span: (
                at - Duration::from_seconds(300.0),
                at + Duration::from_seconds(200.0),
            ),
            is_honest,
        };
        let mut satellite = Satellite::new(&style, &PASS, 16_384);
        assert!(follow(&mut satellite, &feed, at).0);
        for curve in curves(&satellite, at) {
            let (first, last) = (curve[0].0, curve[curve.len() - 1].0);
            assert!((-300.0..-285.0).contains(&first), "{is_honest}: {first}");
            assert!((185.0..=200.0).contains(&last), "{is_honest}: {last}");
            assert!(
                !is_honest || (first == -300.0 && last == 200.0),
                "{first} {last}"
            );
        }
        // After the validity: past samples remain, and there is no current position.
        let later = at + Duration::from_seconds(700.0);
        assert!(follow(&mut satellite, &feed, later).0);
        assert_eq!(satellite.now_m, None);
        let [trail, _] = curves(&satellite, later);
        assert!(trail[trail.len() - 1].0 <= -500.0);
        // Long after, nothing is left.
        follow(&mut satellite, &feed, later + hour);
        assert!(curves(&satellite, later + hour)[0].is_empty());
    }
}

#[test]
fn spans_count_revolutions_by_the_energy() {
    let state = |position_m: DVec3, velocity_m_s: DVec3| OrbitState {
        epoch: Epoch::default(),
        frame: Frame::Gcrf,
        position_m,
        velocity_m_s,
    };
    let radius_m: f64 = 42_164_000.0;
    let circular = state(
        DVec3::X * radius_m,
        DVec3::Y * (EARTH_GM_M3_S2 / radius_m).sqrt(),
    );
    assert!((revolution_s(&circular) - 86_164.0).abs() < 20.0);
    // An escape orbit, and a period of a year: a day.
    assert_eq!(
        revolution_s(&state(DVec3::X * 7e6, DVec3::Y * 2e4)),
        86_400.0
    );
    assert_eq!(
        revolution_s(&state(DVec3::X * 4e9, DVec3::Y * 10.0)),
        86_400.0
    );
}

/// The edges of a swath at each time, compared with all points of the footprint of that state: none lies farther out.
#[test]
fn a_swath_reaches_as_far_as_the_footprint_at_each_instant() {
    let feed = Sgp4Feed::built_in_iss().unwrap_or_else(|error| panic!("{error}"));
    let field = FieldOfView {
        shape: terrella_orbit::FieldShape::Rectangle {
            along_rad: 0.1,
            across_rad: 0.3,
        },
        off_nadir_rad: 0.4,
        azimuth_rad: 1.2,
    };
    let span = TrackSpan::Seconds {
        before_s: 900.0,
        after_s: 300.0,
    };
    let style = TrackStyle {
        footprint: Some(crate::tracks::Footprint {
            field: Some(field),
            swath: Some(span),
            ..Default::default()
        }),
        ..TrackStyle::new(0)
    };
    let at = utc("2018-01-20T22:00:00Z");
    let mut satellite = Satellite::new(&style, &PASS, 16_384);
    assert!(follow(&mut satellite, &feed, at).0);
    let reference = satellite.reference.unwrap_or_else(|| panic!("known"));
    let window = reference.window(span, satellite.now_s);
    let (mut times, mut farthest) = (Vec::new(), 0.0_f64);
    let swath = satellite
        .swath
        .as_ref()
        .unwrap_or_else(|| panic!("a swath"));
    swath.walk(window, None, |t_s, edges| {
        times.push(t_s);
        // The ends are interpolated between samples.
        if t_s == window.from_s || t_s == window.to_s {
            return;
        }
        let state = feed.state_at(at + Duration::from_seconds(t_s - satellite.now_s));
        let state = state.unwrap_or_else(|error| panic!("{error}"));
        let (place, flight) = state.inertial_in_itrf_axes(&Orientation::default());
        let right = flight.cross(place).normalize();
        let aimed = field.aimed(place, flight, &WGS84);
        let aimed = aimed.unwrap_or_else(|| panic!("above the ground"));
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        aimed.outline(|point| {
            least = least.min(point.dot(right));
            most = most.max(point.dot(right));
        });
        // Points of the outline are kilometres apart; near an extremum the outline is flat, and corners are exact.
        for (edge, outline) in edges.into_iter().zip([least, most]) {
            farthest = farthest.max((edge.dot(right) - outline).abs());
        }
    });
    assert!(times.len() > 50 && times[0] == window.from_s, "{times:?}");
    assert!(farthest < 30.0, "{farthest} m");
}
