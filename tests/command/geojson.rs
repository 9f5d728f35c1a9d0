//! Files of GeoJSON on the globe.

use crate::{Place, SMALL, words};

/// A square around the middle of the image, a point, and an invalid feature.
const AREAS: &str = r##"{"type":"FeatureCollection","features":[
  {"type":"Feature","properties":{"stroke":"#ff00ff","stroke-width":3,"stroke-opacity":1,"fill":"#004000","fill-opacity":1,"marker-symbol":"x"},
   "geometry":{"type":"Polygon","coordinates":[[[0,0],[30,0],[30,40],[0,40],[0,0]]]}},
  {"type":"Feature","properties":{"title":"Nowhere"},"geometry":{"type":"Point","coordinates":[15,NaN]}},
  {"type":"Feature","properties":{"marker-color":"#00ff00"},"geometry":{"type":"Point","coordinates":[15,20]}}
]}"##;

#[test]
fn a_file_is_drawn_and_what_is_wrong_in_it_is_named() {
    let place = Place::new();
    std::fs::write(place.path("areas.geojson"), AREAS).expect("written");
    let table = "[[geojson]]\nfile = \"areas.geojson\"\n";
    place.scene("areas.toml", &format!("{SMALL}{table}"));
    let strict = SMALL.replace("[earth]", "[earth]\nstrict = true");
    place.scene("strict.toml", &format!("{strict}{table}"));
    let draw =
        |scene, picture| place.succeed(&["frame", scene, "-o", picture, "--size", "192x108"]);
    draw("small.toml", "small.png");
    let output = draw("areas.toml", "areas.png");
    let said = words(&output);
    for expected in [
        "areas.geojson: feature 1: a coordinate is not a finite number; left out",
        "areas.geojson: these properties are not drawn: marker-symbol",
    ] {
        assert!(said.contains(expected), "{said}");
    }
    let picture = |name: &str| image::open(place.path(name)).expect("a picture").to_rgb8();
    let (plain, drawn) = (picture("small.png"), picture("areas.png"));
    let pixels = || {
        plain
            .pixels()
            .zip(drawn.pixels())
            .filter(|(one, other)| one != other)
    };
    let is_of = |color: [i32; 3]| {
        let near = move |pixel: &image::Rgb<u8>| {
            let channels = pixel.0.iter().zip(color);
            channels
                .map(|(one, other)| (i32::from(*one) - other).abs())
                .max()
                < Some(60)
        };
        pixels().filter(|(_, pixel)| near(pixel)).count()
    };
    // Through the air.
    let colors = [[255, 80, 255], [80, 240, 100], [60, 100, 105]];
    let [magenta, green, filled] = colors.map(is_of);
    // The square is about 36 by 52 pixels, its outline 3 wide and the ring of the point 9 across.
    assert!(magenta > 300 && green > 20, "{magenta} {green}");
    assert!((800..2000).contains(&filled), "{filled}");
    assert!(pixels().count() < 3000);
    let check = place.succeed(&["check", "areas.toml"]);
    let check = String::from_utf8_lossy(&check.stdout).into_owned();
    assert!(
        check.contains("missing, so left out\n  geojson        areas.geojson: feature 1: "),
        "{check}"
    );

    let output = place.run(&["frame", "strict.toml", "-o", "strict.png"]);
    let said = words(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains("[geojson] file: areas.geojson: feature 1: "),
        "{said}"
    );
    assert!(!place.path("strict.png").exists());
}
