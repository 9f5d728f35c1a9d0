//! `[tracks]` and the keys of `[orbit]` about tracks.

use super::{Bad, Folder, scene};
use terrella_orbit::FieldOfView;
use terrella_play::scene::{Footprint, Track, TrackSpan};

#[rustfmt::skip]
const BAD: &[Bad] = &[
    ("[orbit]\ntrial = true", 2, &["[orbit] trial:", "did you mean trail?"]),
    ("[orbit]\ntrail = 90", 2, &["[orbit] trail = 90:", "before_min", "0 to 10080"]),
    ("[orbit]\ntrail = \"yes\"", 2, &["[orbit] trail", "true, false"]),
    ("[orbit]\ntrail = { before = 3 }", 2, &["[orbit] trail", "not before"]),
    ("[orbit]\ntrail = { before_min = -1 }", 2, &["[orbit] trail", "0 to 10080"]),
    ("[orbit]\ntrail = { before_min = nan }", 2, &["[orbit] trail", "0 to 10080"]),
    ("[orbit]\ntrail = {}", 2, &["[orbit] trail", "no time"]),
    ("[tracks]\nground_track = { after_min = 20000 }", 2, &["[tracks] ground_track", "0 to 10080"]),
    ("[orbit]\nmarker = 1", 2, &["[orbit] marker = 1", "true or false"]),
    ("[orbit]\ncolor = \"red\"", 2, &["[orbit] color = \"red\"", "six hexadecimal digits"]),
    ("[orbit]\ncolor = \"#12345é\"", 2, &["[orbit] color", "six hexadecimal digits"]),
    ("[tracks]\ncolor = \"#123456\"", 2, &["[tracks] color:", "belongs in [orbit]"]),
    ("[orbit]\nsensor_half_angle_deg = 0", 2, &["[orbit] sensor_half_angle_deg = 0:", "0.001 to 90"]),
    ("[orbit]\nsensor_half_angle_deg = 91", 2, &["0.001 to 90"]),
    ("[orbit]\nfootprint = false\nsensor_half_angle_deg = 20", 3, &["sensor_half_angle_deg = 20", "footprint = false"]),
    ("[orbit]\nfootprint_fill = true", 2, &["footprint_fill = true", "footprint = true"]),
    ("[tracks]\nwidth_px = 0.1", 2, &["[tracks] width_px = 0.1:", "0.5 to 16"]),
    ("[tracks]\ntrail = true\n[camera]\nmode = \"geodetic\"", 2, &["[tracks] trail = true:", "this scene has none", "[orbit]"]),
    ("tracks = 1", 1, &["tracks = 1", "must be a table"]),
];

#[test]
fn what_is_wrong_is_rejected_where_it_stands() {
    Folder::new().rejects(BAD);
}

#[test]
fn tracks_are_off_by_default() {
    for text in [
        "",
        "[orbit]",
        "[tracks]",
        "[orbit]\ncolor = \"#ff0000\"",
        "[tracks]\nfootprint = false",
    ] {
        let scene = scene(text);
        assert!(
            scene.orbits.iter().all(|orbit| orbit.track.is_off()),
            "{text}"
        );
        assert!(!scene.summary().contains("\n  track "), "{text}");
    }
}

#[test]
fn a_satellite_s_own_key_goes_before_that_of_all() {
    let kepler = "[[orbit]]\nsource = \"kepler\"\nsemi_major_axis_km = 7000\n";
    let text = format!(
        "[tracks]\ntrail = true\nmarker = true\nsensor_half_angle_deg = 30\nwidth_px = 3\n{kepler}\
         {kepler}trail = false\nground_track = {{ before_min = 10, after_min = 2.5 }}\nmarker = false\nfootprint = false\n\
         {kepler}trail = {{ after_min = 90 }}\nfootprint_fill = true\ncolor = \"#0180fF\"\nsubpoint = true\n"
    );
    let scene = scene(&text);
    let tracks: Vec<_> = scene.orbits.iter().map(|orbit| orbit.track).collect();
    let common = Track {
        trail: Some(TrackSpan::Usual),
        marker: true,
        footprint: Some(Footprint {
            field: Some(FieldOfView::nadir(30_f64.to_radians())),
            ..Footprint::default()
        }),
        sensor: Some(FieldOfView::nadir(30_f64.to_radians())),
        ..Track::default()
    };
    assert_eq!(tracks[0], common);
    assert_eq!(
        tracks[1],
        Track {
            ground_track: Some(TrackSpan::Minutes {
                before_min: 10.0,
                after_min: 2.5
            }),
            // It counts for maps of coverage.
            sensor: common.sensor,
            ..Track::default()
        }
    );
    assert_eq!(
        tracks[2],
        Track {
            trail: Some(TrackSpan::Minutes {
                before_min: 0.0,
                after_min: 90.0
            }),
            footprint: Some(Footprint {
                fill: true,
                ..common.footprint.unwrap_or_default()
            }),
            color: Some([1, 128, 255]),
            subpoint: true,
            ..common
        }
    );
    assert_eq!(scene.track_px, 3.0);
    let summary = scene.summary();
    for words in [
        "trail of the last revolution; footprint of 30° about straight down; marker with its name",
        "ground track from 10 min before to 2.5 min after",
        "footprint of 30° about straight down, tinted; sub-satellite point",
        "\"#0180ff\"",
        "width_px",
    ] {
        assert!(summary.contains(words), "{words}:\n{summary}");
    }
}

#[test]
fn the_built_in_station_has_tracks_too() {
    let scene = scene("[tracks]\nground_track = true\nfootprint = true");
    let [orbit] = scene.orbits.as_slice() else {
        panic!("one satellite")
    };
    assert_eq!(orbit.track.ground_track, Some(TrackSpan::Usual));
    assert_eq!(orbit.track.footprint, Some(Footprint::default()));
}
