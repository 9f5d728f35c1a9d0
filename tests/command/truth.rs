//! `terrella frame --truth`: a folder that is whole or not there.

use crate::{Place, SMALL, names};
use std::path::Path;

/// Header and numbers of an array.
pub(crate) struct Array {
    pub(crate) shape: Vec<usize>,
    pub(crate) values: Vec<f64>,
}

pub(crate) fn numpy(path: &Path) -> Array {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
    let end = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let header = std::str::from_utf8(&bytes[10..end]).expect("text");
    let shape = header.split("'shape': (").nth(1).expect("a shape");
    let shape = shape.split(')').next().expect("an end").split(',');
    let shape: Vec<_> = shape.map(|n| n.trim().parse().expect("a number")).collect();
    let values: Vec<_> = match header.contains("'<f8'") {
        true => {
            let all = bytes[end..].as_chunks::<8>().0.iter();
            all.map(|bytes| f64::from_le_bytes(*bytes)).collect()
        }
        false => {
            assert!(header.contains("'<f4'"), "{header}");
            let all = bytes[end..].as_chunks::<4>().0.iter();
            all.map(|bytes| f64::from(f32::from_le_bytes(*bytes)))
                .collect()
        }
    };
    assert_eq!(values.len(), shape.iter().product::<usize>(), "{header}");
    Array { shape, values }
}

const FILES: [&str; 13] = [
    "cloud_cover.npy",
    "height_m.npy",
    "land.npy",
    "lat_deg.npy",
    "limb_distance_deg.npy",
    "lit.npy",
    "lon_deg.npy",
    "moon_shadow.npy",
    "normal_itrf.npy",
    "range_m.npy",
    "sun_elevation_deg.npy",
    "truth.exr",
    "truth.json",
];

#[test]
fn a_folder_of_truth_says_what_each_pixel_shows() {
    let place = Place::new();
    // Everything beyond the limb is black.
    let dark = "[sky]\nstars = false\nsun = false\nmoon = false\n";
    place.scene("dark.toml", &(SMALL.to_owned() + dark));
    let arguments = ["frame", "dark.toml", "-o", "a.png", "--truth", "new/truth"];
    place.succeed(&arguments);
    let folder = place.path("new/truth");
    assert_eq!(names(&folder), FILES);
    let text = std::fs::read_to_string(folder.join("truth.json")).expect("reads");
    let page: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(page["size"], serde_json::json!([64, 36]));
    let layers = page["layers"].as_array().expect("a list");
    assert_eq!(layers.len(), FILES.len() - 2);
    let read = |name: &str| {
        let array = numpy(&folder.join(format!("{name}.npy")));
        let entry = layers.iter().find(|layer| layer["name"] == name);
        let entry = entry.unwrap_or_else(|| panic!("{name} is not on the page"));
        assert_eq!(entry["shape"], serde_json::json!(array.shape), "{name}");
        array
    };
    let limb = read("limb_distance_deg").values;
    assert!(limb.iter().all(|value| value.is_finite()));
    let picture = image::open(place.path("a.png")).expect("opens").to_rgb8();
    let lat = read("lat_deg").values;
    // 12 000 km over 20° N, 15° E: the centre shows that place, and the corner no ground.
    let middle = 18 * 64 + 32;
    assert!((lat[middle] - 20.0).abs() < 5.0, "{}", lat[middle]);
    assert!(lat[0].is_nan() && limb[0] > 0.0);
    let lon = read("lon_deg").values;
    assert!((lon[middle] - 15.0).abs() < 5.0, "{}", lon[middle]);
    let range = read("range_m").values[middle];
    assert!((1.2e7..1.25e7).contains(&range), "{range}");
    for name in ["height_m", "lit", "moon_shadow", "land", "cloud_cover"] {
        let values = read(name).values;
        let (low, high) = (0.0, 1.0);
        for (value, lat) in values.iter().zip(&lat) {
            assert_eq!(value.is_nan(), lat.is_nan(), "{name}");
            assert!(
                value.is_nan() || (low..=high).contains(value),
                "{name}: {value}"
            );
        }
    }
    let normal = read("normal_itrf");
    assert_eq!(normal.shape, [36, 64, 3]);
    // Pixels far beyond the limb and its air are black; those well inside and lit are not.
    let sun = read("sun_elevation_deg").values;
    let mut days = 0;
    for (n, (x, y, pixel)) in picture.enumerate_pixels().enumerate() {
        let light: u32 = pixel.0.iter().map(|value| u32::from(*value)).sum();
        if limb[n] > 2.0 {
            assert!(light < 10, "{x}, {y}: {light}");
        }
        if limb[n] < -0.7 && sun[n] > 15.0 {
            assert!(light > 30, "{x}, {y}: {light}");
            days += 1;
        }
        // A pixel is 1.25° wide.
        assert!(
            (limb[n] < 0.0) == lat[n].is_finite() || limb[n].abs() < 0.7,
            "{x}, {y}"
        );
    }
    assert!(days > 100, "{days}");
    // The image's channels are in the order of their names; the two of latitude add up to the full value.
    let exr = std::fs::read(folder.join("truth.exr")).expect("reads");
    let mut channels: Vec<String> = layers
        .iter()
        .flat_map(|layer| layer["channels"].as_array().expect("a list"))
        .map(|name| name.as_str().expect("a name").to_owned())
        .collect();
    channels.sort();
    let line = 8 + 4 * 64 * channels.len();
    let first = exr.len() - 36 * line;
    let value = |name: &str, (x, y): (usize, usize)| {
        let channel = channels.iter().position(|channel| channel == name);
        let at = first + y * line + 8 + 4 * (64 * channel.expect("there") + x);
        f64::from(f32::from_le_bytes(
            exr[at..at + 4].try_into().expect("four bytes"),
        ))
    };
    let both = value("lat_deg", (32, 18)) + value("lat_deg_rest", (32, 18));
    assert!((both - lat[middle]).abs() < 1e-13, "{both}");
    assert!((both - value("lat_deg", (32, 18))).abs() > 1e-10);
    assert_eq!(
        value("normal_itrf.z", (32, 18)),
        normal.values[3 * middle + 2]
    );
    // Once more: what is there is replaced.
    place.succeed(&arguments);
    assert_eq!(names(&folder), FILES);
}

#[test]
fn truth_of_ground_with_relief_has_its_heights() {
    let place = Place::new();
    place.scene(
        "relief.toml",
        "[camera]\nmode = \"geodetic\"\nlat_deg = 46\nlon_deg = 8\nheight_km = 300\n\
         [earth]\nsurface = \"quadtree\"\nwater = false\n[output]\nsize = [64, 36]\nsamples = 1\n",
    );
    place.succeed(&["frame", "relief.toml", "-o", "a.png", "--truth", "truth"]);
    let heights = numpy(&place.path("truth/height_m.npy")).values;
    let highest = heights.iter().copied().fold(f64::NAN, f64::max);
    assert!((1500.0..4900.0).contains(&highest), "{highest}");
    // Without a map of open water the land fraction is unknown.
    let land = numpy(&place.path("truth/land.npy")).values;
    assert!(land.iter().all(|value| value.is_nan()));
}

#[test]
fn truth_that_cannot_be_written_is_rejected_before_drawing() {
    let place = Place::new();
    std::fs::write(place.path("file"), "here").expect("writes");
    let frame = |code, folder: &str, more: &[&str]| {
        let mut arguments = vec!["frame", "small.toml", "-o", "a.png", "--truth", folder];
        arguments.extend(more);
        place.fail(code, &arguments)
    };
    let words = frame(1, "file", &[]);
    assert!(
        words.contains("file") && words.contains("already exists"),
        "{words}"
    );
    let words = frame(1, "file/truth", &[]);
    assert!(words.contains("cannot be written"), "{words}");
    std::fs::create_dir_all(place.path("taken/lat_deg.npy")).expect("made");
    let words = frame(1, "taken", &[]);
    assert!(words.contains("lat_deg.npy"), "{words}");
    assert_eq!(names(&place.path("taken")), ["lat_deg.npy"]);
    std::fs::remove_dir_all(place.path("taken")).expect("removes");
    let words = frame(1, "truth", &["--size", "16384x16384"]);
    assert!(words.contains("16384") && words.contains("MiB"), "{words}");
    for more in [&["--renderer", "reference"][..], &["--wireframe"]] {
        let words = frame(2, "truth", more);
        assert!(words.contains("--truth"), "{words}");
    }
    // A picture that cannot be written takes the folder of its truth with it.
    let arguments = [
        "frame",
        "small.toml",
        "-o",
        "small.toml/a.png",
        "--truth",
        "truth",
    ];
    place.fail(1, &arguments);
    let arguments = [
        "frame",
        "small.toml",
        "-o",
        "a.png",
        "--truth",
        "truth",
        "--adapter",
        "none of this name",
    ];
    place.fail(1, &arguments);
    assert_eq!(place.names(), ["file", "small.toml"]);
}
