//! `[layers]` and `[[station]]`.

use super::{Bad, Folder, scene};
use terrella::frames::Geodetic;
use terrella_play::scene::{LineLook, StationTable};

const STATION: &str = "[[station]]\nname = \"A\"\nlat_deg = 1\nlon_deg = 2\n";

#[rustfmt::skip]
const BAD: &[Bad] = &[
    ("[layers]\ngraticule = 10", 2, &["[layers] graticule = 10:", "step_deg", "1 to 90"]),
    ("[layers]\ngraticule = { step_deg = 0 }", 2, &["[layers] graticule", "1 to 90"]),
    ("[layers]\ngraticule = { step_deg = nan }", 2, &["[layers] graticule", "1 to 90"]),
    ("[layers]\ngraticule = { step_deg = \"ten\" }", 2, &["[layers] graticule", "1 to 90"]),
    ("[layers]\ngraticule = { step = 10 }", 2, &["[layers] graticule", "not step"]),
    ("[layers]\ngraticule_opacity = 0.5", 2, &["[layers] graticule_opacity", "graticule = true"]),
    ("[layers]\ncoast_lines = true\ncoast_lines_opacity = 0", 3, &["[layers] coast_lines_opacity = 0:", "0.01 to 1"]),
    ("[layers]\nborders = true\nborders_color = \"white\"", 3, &["[layers] borders_color", "six hexadecimal digits"]),
    ("[layers]\nborders_color = \"#ffffff\"", 2, &["[layers] borders_color", "borders = true"]),
    ("[layers]\nterminator_opacity = 0.5", 2, &["[layers] terminator_opacity", "terminator = true"]),
    ("[layers]\nborders = 1", 2, &["[layers] borders = 1", "true or false"]),
    ("[layers]\nvector_map = \"a.bin\"", 2, &["[layers] vector_map", "coast_lines = true"]),
    ("[layers]\nborders = true\nvector_map = \"none.bin\"", 3, &["[layers] vector_map", "none.bin", "cannot be opened"]),
    ("[layers]\nborders = true\nwidth_px = 0", 3, &["[layers] width_px = 0:", "0.5 to 16"]),
    ("[layers]\ncoastlines = true", 2, &["[layers] coastlines:", "did you mean coast_lines?"]),
    ("[overlays]\nborders = true", 1, &["[overlays]:", "did you mean [layers]?"]),
    ("[[station]]\nlat_deg = 1\nlon_deg = 2", 2, &["[station] name: ", "needs a name"]),
    ("[[station]]\nname = \" \"\nlat_deg = 1\nlon_deg = 2", 2, &["[station] name", "must not be empty"]),
    ("[[station]]\nname = \"A\"\nlon_deg = 2", 2, &["[station] lat_deg: ", "needs its latitude"]),
    ("[station]\nname = \"A\"\nlat_deg = 1", 2, &["[station] lon_deg: ", "needs its longitude"]),
    ("[[station]]\nname = \"A\"\nlat_deg = 91\nlon_deg = 2", 3, &["[station] lat_deg = 91:", "−90 to 90"]),
    ("[[station]]\nname = \"A\"\nlat_deg = 1\nlon_deg = 2\nmin_elevation_deg = 90", 5, &["[station] min_elevation_deg = 90:", "0 to 89"]),
    ("[[station]]\nname = \"A\"\nlat_deg = 1\nlon_deg = 2\nheight_m = 1e6", 5, &["[station] height_m", "metres"]),
    ("[[station]]\nname = \"A\"\nlat_deg = 1\nlon_deg = 2\ncolour = \"#ffffff\"", 5, &["[station] colour:", "did you mean color?"]),
    ("[ground_station]\nname = \"A\"", 1, &["[ground_station]:", "did you mean [station]?"]),
];

#[test]
fn what_is_wrong_is_rejected_where_it_stands() {
    Folder::new().rejects(BAD);
}

#[test]
fn lines_and_stations_are_off_by_default() {
    for text in [
        "",
        "[layers]",
        "[layers]\ngraticule = false\nborders = false",
    ] {
        let scene = scene(text);
        assert!(!scene.layers.is_on() && scene.stations.is_empty(), "{text}");
        let summary = scene.summary();
        assert!(!summary.contains("\n  lines ") && !summary.contains("\n  station "));
    }
}

#[test]
fn lines_have_defaults_and_what_a_scene_says() {
    let usual = scene("[layers]\ngraticule = true\ncoast_lines = true\nborders = true\n");
    let layers = &usual.layers;
    let white = |opacity| LineLook {
        color: [255; 3],
        opacity,
    };
    assert_eq!(layers.graticule, Some((10.0, white(0.3))));
    assert_eq!(layers.borders, Some(white(0.6)));
    assert_eq!(layers.coast_lines.map(|look| look.opacity), Some(0.8));
    assert_eq!(layers.width_px, 1.0);
    let said = scene(
        "[layers]\ngraticule = { step_deg = 15 }\ngraticule_color = \"#0180fF\"\ngraticule_opacity = 1\nwidth_px = 2\n",
    );
    let look = LineLook {
        color: [1, 128, 255],
        opacity: 1.0,
    };
    assert_eq!(said.layers.graticule, Some((15.0, look)));
    assert!(!said.layers.needs_vector_map());
    let twilight = scene("[layers]\nterminator = true\n");
    assert_eq!(
        twilight.layers.terminator.map(|look| look.opacity),
        Some(0.8)
    );
    assert!(
        twilight
            .summary()
            .contains("\n  lines          terminator and twilight\n")
    );
    let summary = said.summary();
    assert!(
        summary.contains("\n  lines          graticule of 15°\n"),
        "{summary}"
    );
}

#[test]
fn stations_stand_where_a_scene_says() {
    let text = format!(
        "{STATION}[[station]]\nname = \"Süd\"\nlat_deg = -90\nlon_deg = 190\nheight_m = 2800.5\nmin_elevation_deg = 10\ncolor = \"#0180ff\"\n"
    );
    let scene = scene(&text);
    assert_eq!(
        scene.stations,
        [
            StationTable {
                name: "A".to_owned(),
                place: Geodetic::from_degrees(1.0, 2.0, 0.0),
                min_elevation_deg: 5.0,
                color: None,
            },
            StationTable {
                name: "Süd".to_owned(),
                place: Geodetic::from_degrees(-90.0, -170.0, 2800.5),
                min_elevation_deg: 10.0,
                color: Some([1, 128, 255]),
            },
        ]
    );
    let summary = scene.summary();
    let lists = summary.matches("\n[[station]]\n").count();
    assert_eq!(lists, 2, "{summary}");
    assert!(
        summary
            .contains("\n  station        Süd: -90.0000° latitude, -170.0000° longitude, 2800.5 m")
    );
}
