//! Files of GeoJSON on the globe.

use crate::{Place, SMALL, words};

/// A square around the middle of the picture, a point, and a feature that is at fault.
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
    place.succeed(&["frame", "small.toml", "-o", "small.png"]);
    let output = place.succeed(&["frame", "areas.toml", "-o", "areas.png"]);
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
                < Some(90)
        };
        pixels().filter(|(_, pixel)| near(pixel)).count()
    };
    let colors = [[255, 0, 255], [0, 255, 0], [0, 64, 0]];
    let [magenta, green, filled] = colors.map(is_of);
    // The square is about 17 by 22 pixels, the ring of the point 9 wide.
    assert!(magenta > 40 && green > 5, "{magenta} {green}");
    assert!((100..300).contains(&filled), "{filled}");
    let middle = drawn.get_pixel(32, 18);
    assert!(pixels().count() < 500, "{middle:?}");
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
