//! Warning before a film of satellites that have no state for part of it.

use super::Flight;
use super::scene::Track;
use terrella::frames::{Epoch, rfc3339};
use terrella_orbit::Feed;

/// How many sentences are said.
const MOST: usize = 10;

/// A sentence for each time of a film at which a satellite is not known of which something is drawn. Times at which the satellite that
/// cameras fly with is not known are left out of the film.
pub(super) fn gap_words(flight: &Flight, film: (Epoch, Epoch)) -> Vec<String> {
    let (first, last) = (film.0.min(film.1), film.0.max(film.1));
    let scene = flight.scene();
    if scene.is_live() {
        return Vec::new();
    }
    let satellites = flight.satellites();
    let followed = satellites.get(flight.followed()).into_iter();
    let left_out = scene.time.left_out.iter();
    let left_out = left_out.filter(|(from, to)| first <= *from && *to <= last);
    let of_followed = followed.flat_map(|satellite| {
        let words = |(from, to): &(Epoch, Epoch)| {
            format!(
                "{} is not known from {} to {}: that time is left out, and the film goes on behind it",
                satellite.name(),
                rfc3339(*from),
                rfc3339(*to)
            )
        };
        left_out.clone().map(words)
    });
    let orbits = scene.orbits.iter().zip(satellites).enumerate();
    let others = orbits.filter(|(index, _)| *index != flight.followed());
    let drawn = others.filter(|(_, (orbit, _))| !Track::is_off(&orbit.track));
    let of_others = drawn.flat_map(|(_, (_, satellite))| {
        let times = unknown(satellite.feed(), (first, last)).into_iter();
        times.map(move |(from, to)| {
            format!(
                "{} is not known from {} to {}: it is not drawn in that time",
                satellite.name(),
                rfc3339(from),
                rfc3339(to)
            )
        })
    });
    let mut all = of_followed.chain(of_others);
    let mut lines: Vec<_> = all.by_ref().take(MOST).collect();
    match all.count() {
        0 => {}
        more => lines.push(format!(
            "satellites are not known at {more} more times of it"
        )),
    }
    lines
}

/// The parts of a time at which a satellite is not known.
fn unknown(feed: &dyn Feed, (first, last): (Epoch, Epoch)) -> Vec<(Epoch, Epoch)> {
    let (begin, end) = feed.validity();
    if end < first || last < begin {
        return vec![(first, last)];
    }
    let before = (first < begin).then_some((first, begin));
    let after = (end < last).then_some((end, last));
    let gaps = feed.gaps().into_iter();
    let within = gaps
        .filter(|(from, to)| *from < last && first < *to)
        .map(|(from, to)| (from.max(first), to.min(last)));
    before.into_iter().chain(within).chain(after).collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::scene::Scene;
    use terrella::frames::utc_from_rfc3339;

    /// A satellite that is known for ten minutes and, after two without, for eight more.
    pub(in super::super) fn with_gap() -> String {
        let mut text = String::from(
            "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = X\n",
        );
        for (from, to) in [(0, 10), (12, 20)] {
            text += "META_START\nOBJECT_NAME = GAPPY\nOBJECT_ID = 2099-001A\nCENTER_NAME = EARTH\nREF_FRAME = EME2000\nTIME_SYSTEM = UTC\n";
            text += &format!(
                "START_TIME = 2026-03-01T00:{from:02}:00\nSTOP_TIME = 2026-03-01T00:{to:02}:00\nMETA_STOP\n"
            );
            for minute in from..=to {
                let (sin, cos) = (f64::from(minute) * 0.0678).sin_cos();
                text += &format!(
                    "2026-03-01T00:{minute:02}:00 {} {} 0 {} {} 0\n",
                    6778.0 * cos,
                    6778.0 * sin,
                    -7.66 * sin,
                    7.66 * cos
                );
            }
        }
        text
    }

    #[test]
    fn a_film_says_when_satellites_are_not_known() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("gap.oem"), with_gap()).expect("written");
        let text = "[time]\nstart = \"2026-03-01T00:05:00Z\"\nduration_s = 1200\n[tracks]\nmarker = true\n\
            [[orbit]]\nsource = \"kepler\"\nperiapsis_km = 7000\n[[orbit]]\nsource = \"oem\"\nfile = \"gap.oem\"\n";
        let scene = Scene::from_toml(text, &folder.path().join("s.toml")).expect("a good scene");
        let flight = Flight::open(scene).expect("opens");
        let at = |time: &str| utc_from_rfc3339(&format!("2026-03-01T{time}Z")).expect("a date");
        let words = |from, to| gap_words(&flight, (at(from), at(to)));
        assert_eq!(
            words("00:05:00", "00:25:00"),
            [
                "GAPPY is not known from 2026-03-01T00:10:00.000Z to 2026-03-01T00:12:00.000Z: it is not drawn in that time",
                "GAPPY is not known from 2026-03-01T00:20:00.000Z to 2026-03-01T00:25:00.000Z: it is not drawn in that time",
            ]
        );
        assert_eq!(words("00:05:00", "00:10:00"), Vec::<String>::new());
        assert_eq!(words("00:19:00", "00:13:00"), Vec::<String>::new());
        assert_eq!(words("00:11:00", "00:13:00").len(), 1);
    }

    #[test]
    fn a_film_goes_on_behind_a_gap_of_the_followed_satellite() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("gap.oem"), with_gap()).expect("written");
        let open = |minute: u32, duration_s: u32, speed: i32| {
            let text = format!(
                "[time]\nstart = \"2026-03-01T00:{minute:02}:00Z\"\nduration_s = {duration_s}\nspeed = {speed}\nframe_rate_hz = 1\n\
                [[orbit]]\nsource = \"oem\"\nfile = \"gap.oem\"\n"
            );
            let scene =
                Scene::from_toml(&text, &folder.path().join("s.toml")).expect("a good scene");
            Flight::open(scene)
        };
        for (minute, speed) in [(5, 30), (18, -30)] {
            let flight = open(minute, 780, speed).expect("opens");
            let time = &flight.scene().time;
            // 11 of 13 minutes.
            assert_eq!(time.frame_count(), 22);
            for n in 0..time.frame_count() {
                let moment = flight.at(crate::clock::frame_epoch(time, n), 1.5);
                assert!(moment.is_ok(), "frame {n} of a speed of {speed}");
            }
            let ends = (time.start, crate::clock::frame_epoch(time, 21));
            assert_eq!(
                gap_words(&flight, ends),
                [
                    "GAPPY is not known from 2026-03-01T00:10:00.000Z to 2026-03-01T00:12:00.000Z: that time is left out, and the film goes on behind it"
                ]
            );
        }
        // It neither starts nor ends in the gap.
        for (minute, duration_s) in [(11, 60), (5, 360)] {
            let error = open(minute, duration_s, 30)
                .map(drop)
                .expect_err("rejected")
                .to_string();
            assert!(error.contains("the ephemeris has a gap"), "{error}");
        }
    }
}
