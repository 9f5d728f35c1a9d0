//! Ephemerides as other programs write them, against the positions of those programs at times between the states.
//!
//! `tests/data/orbit/simulators` holds the files, the tables, and the scripts of the runs that wrote both.

use crate::utc;
use glam::DVec3;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use terrella_frames::{Duration, EarthOrientation, Ellipsoid, Epoch, Geodetic};
use terrella_orbit::{Ephemerides, EphemerisFeed, Feed, Frame};

fn data(file: &str) -> PathBuf {
    let folder = Path::new(crate::REPOSITORY).join("tests/data/orbit");
    folder.join(file)
}

/// The one satellite of a file in which nothing is left out.
fn flown(file: &str) -> EphemerisFeed {
    let path = data("simulators").join(file);
    let mut read = Ephemerides::from_file(&path, true).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((read.feeds.len(), read.faults.len()), (1, 0), "{file}");
    read.feeds.remove(0)
}

/// A row of a program's own table.
struct Place {
    epoch: Epoch,
    numbers: HashMap<String, f64>,
}

impl Place {
    fn position_m(&self, frame: &str) -> DVec3 {
        let [x, y, z] = ["x", "y", "z"].map(|axis| self.numbers[&format!("{frame}_{axis}_m")]);
        DVec3::new(x, y, z)
    }

    fn geodetic(&self) -> Geodetic {
        let [lat_deg, lon_deg, height_m] =
            ["lat_deg", "lon_deg", "height_m"].map(|key| self.numbers[key]);
        Geodetic::from_degrees(lat_deg, lon_deg, height_m)
    }
}

fn places(file: &str) -> Vec<Place> {
    let text = std::fs::read_to_string(data("simulators").join(file)).unwrap();
    let mut lines = text.lines();
    let names: Vec<_> = lines.next().unwrap().split(',').skip(1).collect();
    let place = |line: &str| {
        let (date, numbers) = line.split_once(',').unwrap();
        let numbers = numbers.split(',').map(|number| number.parse().unwrap());
        Place {
            epoch: utc(date),
            numbers: names.iter().map(|n| (*n).to_owned()).zip(numbers).collect(),
        }
    };
    let places: Vec<_> = lines.map(place).collect();
    assert!(places.len() > 60, "{file}: {}", places.len());
    places
}

/// The largest distance between our positions and the program's, metres, over all rows of the file: in the file's own frame, and in ITRF by the
/// Earth's measured orientation.
fn worst_m(feed: &EphemerisFeed, frame: Frame, columns: &str, places: &[Place]) -> (f64, f64) {
    let extract = data("finals2000A.extract");
    let orientation = EarthOrientation::from_file(&extract).unwrap();
    let (from, to) = feed.validity();
    let (mut count, mut own_m, mut fixed_m) = (0, 0.0_f64, 0.0_f64);
    for place in places {
        if !(from..=to).contains(&place.epoch) {
            continue;
        }
        let state = feed.state_at(place.epoch).unwrap();
        assert_eq!(state.frame, frame);
        own_m = own_m.max(state.position_m.distance(place.position_m(columns)));
        let earth = orientation.at(place.epoch).unwrap();
        let fixed = state.in_frame(Frame::Itrf, &earth).position_m;
        fixed_m = fixed_m.max(fixed.distance(place.position_m("itrf")));
        count += 1;
    }
    assert!(count * 10 > places.len() * 9, "{count} of {}", places.len());
    (own_m, fixed_m)
}

/// File, its frame, the table's columns of that, the most that positions may differ in them and in ITRF, metres.
type Case = (&'static str, Frame, &'static str, f64, f64);

/// Holds files to the table of the same run, and our latitude, longitude and height to the program's, so many metres.
fn hold(table: &str, most_below_m: f64, cases: &[Case]) {
    let places = places(table);
    let below_m = places.iter().map(|place| {
        let said = Ellipsoid::WGS84.itrf_from_geodetic(place.geodetic());
        said.distance(place.position_m("itrf"))
    });
    let below_m = below_m.fold(0.0, f64::max);
    println!("{table}: {below_m:.1e} m from its latitudes, longitudes and heights");
    assert!(below_m < most_below_m, "{table}: {below_m}");
    let mut wrong = Vec::new();
    for (file, frame, columns, most_own_m, most_fixed_m) in cases {
        let (own_m, fixed_m) = worst_m(&flown(file), *frame, columns, &places);
        println!("{file}: {own_m:.1e} m in its frame, {fixed_m:.1e} m in ITRF");
        if own_m > *most_own_m || fixed_m > *most_fixed_m {
            wrong.push((file, own_m, fixed_m));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// States of a minute or two by Hermite's polynomials: the remaining error is the tolerance of Orekit's own integrator. The leap second
/// 2016-12-31T23:59:60 is inside. Our axes of the equator of date are 0.03″ from those that the IERS measures.
#[test]
fn orekit() {
    hold(
        "orekit.places.csv",
        1e-3,
        &[
            ("orekit_eme2000.oem", Frame::Eme2000, "eme2000", 1e-3, 0.06),
            ("orekit_gcrf_tai.oem", Frame::Gcrf, "gcrf", 1e-3, 0.06),
            ("orekit_teme_tt.oem", Frame::Teme, "teme", 1e-3, 1.2),
            ("orekit_itrf.xml", Frame::Itrf, "itrf", 1e-3, 1e-3),
            ("orekit_gtod.oem", Frame::Pef, "gtod", 1e-3, 0.03),
        ],
    );
}

/// GMAT writes times to the millisecond, 4 m of flight, which shows where its steps do not end on whole ones. Its EME2000 goes with
/// the precession and nutation of 1976 and 1980. Its ellipsoid is 0.7 m smaller.
#[test]
fn gmat() {
    hold(
        "gmat.places.csv",
        1.0,
        &[
            ("gmat_eme2000.oem", Frame::Eme2000, "eme2000", 0.03, 1.2),
            ("gmat_icrf.oem", Frame::Gcrf, "gcrf", 0.03, 0.04),
            ("gmat_steps.oem", Frame::Eme2000, "eme2000", 6.0, 7.0),
            // Positions in ITRF that GMAT calls TDR, which is without polar motion.
            ("gmat_fixed.oem", Frame::Pef, "itrf", 0.03, 15.0),
        ],
    );
}

/// The axes that nyx calls ICRS are turned from J2000 against the sense of the IERS.
#[test]
fn nyx_space() {
    hold(
        "nyx.places.csv",
        1.0,
        &[
            ("nyx_steps.oem", Frame::Eme2000, "eme2000", 1e-3, 1.0),
            ("nyx_icrs.oem", Frame::Gcrf, "gcrf", 1e-3, 1.5),
            ("nyx_teme.oem", Frame::Teme, "teme", 1e-3, 1.5),
            ("nyx_itrf93.oem", Frame::Itrf, "itrf", 1e-3, 1e-3),
        ],
    );
}

/// The velocities of SGP4 are not exactly the derivatives of its positions. skyfield neglects polar motion by default.
#[test]
fn tables_of_skyfield_and_astropy() {
    hold(
        "skyfield.places.csv",
        1e-2,
        &[("skyfield.csv", Frame::Gcrf, "gcrf", 0.2, 11.0)],
    );
    hold(
        "astropy.places.csv",
        1e-3,
        &[("astropy.csv", Frame::Itrf, "itrf", 0.2, 0.2)],
    );
}

/// Covariances of 25 m² an axis grow by the hour; Orekit writes them in KVN and XML alike.
#[test]
fn covariances_of_orekit() {
    for file in ["orekit_gcrf_tai.oem", "orekit_itrf.xml"] {
        let feed = flown(file);
        // √75 m at the start; the second matrix is that of the twentieth state, and those of XML are two minutes apart.
        let hours = 20.0 / 60.0 * if file.ends_with("xml") { 2.0 } else { 1.0 };
        let start = utc("2016-12-31T23:10:00Z");
        let epoch = start + Duration::from_seconds(hours * 3600.0);
        let error_m = feed.error_m(epoch).unwrap();
        let sigma_m = 75.0_f64.sqrt() * (1.0 + hours);
        assert!((error_m - sigma_m).abs() < 1e-6, "{file}: {error_m}");
    }
}
