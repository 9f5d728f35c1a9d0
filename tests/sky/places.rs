//! Apparent positions of stars, Sun and Moon, compared with tables of other programs in `tests/data/sky`, whose heads describe how they were made.

use crate::{stars, utc};
use glam::{DMat3, DVec3};
use terrella::frames::{Ellipsoid, Geodetic, Observer, Orientation};

const ARCSEC: f64 = std::f64::consts::PI / 648_000.0;

/// Julian years of TT since J1991.25.
fn years(tt_days: f64) -> f64 {
    (tt_days - 2_448_349.062_5) / 365.25
}

fn numbers(fields: &[&str]) -> Vec<f64> {
    let number = |field: &&str| field.parse().expect("a number");
    fields.iter().map(number).collect()
}

/// astropy and ERFA: three dates, three eyes, eleven stars.
#[test]
fn stars_are_where_astropy_sees_them() {
    let table = include_str!("../data/sky/star_places.txt");
    let catalogue = stars();
    let (mut date, mut tt, mut rows) = (String::new(), 0.0, [DVec3::ZERO; 3]);
    let mut observer = None;
    let (mut worst, mut seen) = (0.0_f64, 0);
    for line in table.lines().filter(|line| !line.starts_with('#')) {
        let fields: Vec<_> = line.split_whitespace().collect();
        match fields[0] {
            "T" => {
                date = fields[2].to_owned();
                tt = numbers(&fields[4..6]).iter().sum();
            }
            "M" => {
                let row: usize = fields[2].parse().expect("a row");
                rows[row] = DVec3::from_slice(&numbers(&fields[3..6]));
            }
            "E" => {
                let itrf_from_gcrf = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
                let eye = itrf_from_gcrf * DVec3::from_slice(&numbers(&fields[6..9]));
                let velocity = itrf_from_gcrf * DVec3::from_slice(&numbers(&fields[11..14]));
                let (epoch, none) = (utc(&date), Orientation::default());
                observer = Some(match fields[2] {
                    "B" => Observer::moving(epoch, &none, eye, velocity),
                    // At rest on the rotating Earth, like the table's velocity.
                    _ => Observer::at_rest(epoch, &none, eye),
                });
            }
            "S" => {
                let observer = observer.expect("an eye");
                let hip: u32 = fields[4].parse().expect("a number");
                let Some(star) = catalogue.stars().iter().find(|star| star.hip == hip) else {
                    // Fainter than the catalogue goes.
                    assert_eq!(hip, 57_939);
                    continue;
                };
                let places = fields
                    .iter()
                    .position(|field| *field == "I")
                    .expect("a place");
                let expected = DVec3::from_slice(&numbers(&fields[places + 1..places + 4]));
                let found = observer.itrf_from_gcrf() * observer.seen(star.direction_at(years(tt)));
                worst = worst.max(found.cross(expected).length() / ARCSEC);
                seen += 1;
            }
            _ => {}
        }
    }
    println!("{seen} places, at most {:.3} mas off", worst * 1e3);
    assert_eq!(seen, 99);
    // The catalogue's rounding, and IAU 2000B for 2006: 0.1 px would be 1 200 mas at a field of view of 1° on 300 pixels.
    assert!(worst < 2e-3, "{worst}");
}

/// skyfield with JPL's DE421: eight eyes at eight dates.
#[test]
fn sun_and_moon_are_where_jpl_has_them() {
    let table = include_str!("../data/sky/apparent.csv");
    let (mut sun, mut moon, mut moon_km, mut rows) = (0.0_f64, 0.0_f64, 0.0_f64, 0);
    for line in table
        .lines()
        .filter(|line| line.starts_with(char::is_numeric))
    {
        let fields: Vec<_> = line.split(',').collect();
        let n = numbers(&fields[4..]);
        let place = Geodetic::from_degrees(n[0], n[1], n[2]);
        let eye = Ellipsoid::WGS84.itrf_from_geodetic(place);
        let observer = Observer::at_rest(utc(fields[0]), &Orientation::default(), eye);
        let off = |found: DVec3, expected: &[f64]| {
            found
                .normalize()
                .cross(DVec3::from_slice(expected))
                .length()
                / ARCSEC
        };
        sun = sun.max(off(observer.sun_m(), &n[3..6]));
        moon = moon.max(off(observer.moon_m(), &n[7..10]));
        moon_km = moon_km.max((observer.moon_m().length() - n[10]).abs() / 1e3);
        rows += 1;
    }
    println!("{rows} rows: Sun {sun:.4}″, Moon {moon:.2}″ and {moon_km:.1} km");
    assert_eq!(rows, 64);
    assert!(sun < 0.1 && moon < 0.7 && moon_km < 1.2);
}

/// The Moon's libration, phase and axis by DE421's own integration.
#[test]
fn the_moon_turns_its_face_as_jpl_has_it() {
    let table = include_str!("../data/sky/moon_disc.csv");
    let (mut turned, mut lit, mut axis, mut rows) = (0.0_f64, 0.0_f64, 0.0_f64, 0);
    for line in table
        .lines()
        .filter(|line| line.starts_with(char::is_numeric))
    {
        let fields: Vec<_> = line.split(',').collect();
        let n = numbers(&fields[3..]);
        let eye = match fields[1] {
            "geocentre" => DVec3::ZERO,
            _ => {
                let place = Geodetic::from_degrees(36.97, -87.65, 4e5);
                Ellipsoid::WGS84.itrf_from_geodetic(place)
            }
        };
        let observer = Observer::at_rest(utc(fields[0]), &Orientation::default(), eye);
        let (sun, moon) = (observer.sun_m(), observer.moon_m());
        let phase = (sun - moon).angle_between(-moon).to_degrees();
        lit = lit.max((phase - n[0]).abs());
        let sub_eye = observer.moon_from_itrf() * -moon.normalize();
        let lon = sub_eye.y.atan2(sub_eye.x).to_degrees();
        let lat = sub_eye.z.asin().to_degrees();
        turned = turned.max((lon - n[3]).abs()).max((lat - n[4]).abs());
        // The pole's position angle from ICRF north, eastward.
        let gcrf_from_itrf = observer.itrf_from_gcrf().transpose();
        let pole = gcrf_from_itrf * observer.moon_from_itrf().transpose() * DVec3::Z;
        let to_moon = gcrf_from_itrf * moon.normalize();
        let east = DVec3::Z.cross(to_moon).normalize();
        let angle = pole
            .dot(east)
            .atan2(pole.dot(to_moon.cross(east)))
            .to_degrees();
        let apart = (angle - n[6] + 540.0).rem_euclid(360.0) - 180.0;
        axis = axis.max(apart.abs());
        rows += 1;
    }
    println!("{rows} rows: libration {turned:.4}°, axis {axis:.4}°, phase {lit:.5}°");
    assert!(rows >= 9, "{rows}");
    // The table has the phase without aberration, 0.006° for either.
    assert!(turned < 0.03 && axis < 0.03 && lit < 0.02);
}
