//! Ephemerides of other programs, drawn: their sub-satellite point is in the middle of the image.

use crate::Place;
use crate::truth::numpy;
use std::path::Path;

/// Name of the file of states; an instant between them; latitude, longitude and height that the program itself gives
/// there (its row in the table beside the file), degrees and metres; how far off they may be, metres.
type Case = (&'static str, &'static str, [f64; 3], f64);

const CASES: [Case; 4] = [
    (
        "orekit_eme2000.oem",
        "2016-12-31T23:46:27.500Z",
        [-4.488_281_178_4, 133.803_179_968_8, 523_957.749_14],
        0.1,
    ),
    // The ellipsoids of GMAT and of nyx's constants are smaller than WGS84's, by 0.7 and 0.4 m.
    (
        "gmat_icrf.oem",
        "2016-12-24T23:43:33Z",
        [-17.405_954_338, 144.530_646_351_2, 620_362.167_27],
        1.0,
    ),
    (
        "nyx_itrf93.oem",
        "2016-12-24T23:57:37.5Z",
        [-72.580_497_102_5, -177.849_553_374_5, 596_954.921_07],
        1.0,
    ),
    (
        "astropy.csv",
        "2016-12-24T23:57:37.5Z",
        [-46.707_753_593_4, -117.215_478_396_7, 420_542.587_34],
        0.3,
    ),
];

#[test]
fn what_is_below_is_in_the_middle_of_the_picture() {
    let data = Path::new(crate::REPOSITORY).join("tests/data/orbit");
    for (file, at, [lat_deg, lon_deg, height_m], most_m) in CASES {
        let place = Place::new();
        let source = if file.ends_with(".csv") { "csv" } else { "oem" };
        let scene = format!(
            "[time]\nstart = {at:?}\nduration_s = 60\norientation = {:?}\n\
             [orbit]\nsource = {source:?}\nfile = {:?}\nstrict = true\n\
             [camera]\nmode = \"nadir\"\n[earth]\nclouds = false\n[output]\nsize = [64, 36]\n",
            data.join("finals2000A.extract"),
            data.join("simulators").join(file),
        );
        place.scene("low.toml", &scene);
        place.succeed(&[
            "frame", "low.toml", "-o", "a.png", "--stats", "a.json", "--truth", "truth",
        ]);
        let text = std::fs::read_to_string(place.path("a.json")).expect("reads");
        let stats: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let eye = |key: &str| stats["eye"][key].as_f64().expect("a number");
        let [lat_m, lon_m] = metres(
            lat_deg,
            [eye("lat_deg") - lat_deg, eye("lon_deg") - lon_deg],
        );
        let off = [lat_m, lon_m, eye("height_km") * 1e3 - height_m];
        println!("{file}: the eye is {off:.3?} m off");
        assert!(off.iter().all(|off| off.abs() < most_m), "{file}: {off:?}");
        // The four pixels about the middle: their mean is what is straight below.
        let middle = |name: &str| {
            let array = numpy(&place.path("truth").join(name));
            assert_eq!(array.shape, [36, 64]);
            [(17, 31), (17, 32), (18, 31), (18, 32)]
                .map(|(row, column)| array.values[row * 64 + column])
                .iter()
                .sum::<f64>()
                / 4.0
        };
        let seen = [
            middle("lat_deg.npy") - lat_deg,
            middle("lon_deg.npy") - lon_deg,
        ];
        let off = metres(lat_deg, seen);
        println!("{file}: the ground in the middle is {off:.1?} m off");
        // A pixel of this picture is 12 km wide.
        assert!(off.iter().all(|off| off.abs() < 20.0), "{file}: {off:?}");
    }
}

/// Northwards and eastwards, of differences of latitude and longitude, on a round Earth.
fn metres(lat_deg: f64, [north_deg, east_deg]: [f64; 2]) -> [f64; 2] {
    let metres = 6.371e6_f64.to_radians();
    [
        north_deg * metres,
        east_deg * metres * lat_deg.to_radians().cos(),
    ]
}
