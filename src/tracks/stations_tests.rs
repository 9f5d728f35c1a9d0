//! Stations, compared with closed forms and independent geometry.

use super::*;
use glam::{DMat3, DVec2};
use terrella_frames::Duration;
use terrella_orbit::{Feed, Sgp4Feed, passes};

fn station(lat_deg: f64, lon_deg: f64, mask_deg: f64) -> Station {
    Station {
        place: Geodetic::from_degrees(lat_deg, lon_deg, 0.0),
        min_elevation_rad: mask_deg.to_radians(),
        color: [255; 3],
        width_px: 2.0,
    }
}

/// ITRF metres of WGS84, by the prime vertical's radius N = a/√(1 − e² sin²φ) (Torge 2001, 4.28).
fn itrf(lat: f64, lon: f64, height_m: f64) -> DVec3 {
    let flattening = 1.0 / 298.257_223_563;
    let e2 = flattening * (2.0 - flattening);
    let n = 6_378_137.0 / (1.0 - e2 * lat.sin().powi(2)).sqrt();
    DVec3::new(
        (n + height_m) * lat.cos() * lon.cos(),
        (n + height_m) * lat.cos() * lon.sin(),
        (n * (1.0 - e2) + height_m) * lat.sin(),
    )
}

/// Elevation, radians, by rotation into south, east and zenith (Vallado 2013, 3.4.4).
fn elevation(station: &Station, satellite_itrf_m: DVec3) -> f64 {
    let (lat, lon) = (station.place.lat_rad, station.place.lon_rad);
    let line = satellite_itrf_m - itrf(lat, lon, station.place.height_m);
    let colatitude = std::f64::consts::FRAC_PI_2 - lat;
    let sez = DMat3::from_rotation_y(-colatitude) * DMat3::from_rotation_z(-lon) * line;
    sez.z.atan2(DVec2::new(sez.x, sez.y).length())
}

/// On a sphere the circle's radius is λ = arccos(R cos ε / (R + h)) − ε (Wertz and Larson 1999, 5.2).
#[test]
fn circles_on_a_sphere_have_the_radius_of_the_textbook() {
    let sphere = Ellipsoid::PAPER_SPHERE;
    let radius_m = sphere.equatorial_radius_m;
    for (mask_deg, height_m) in [
        (0.0, 420e3),
        (5.0, 420e3),
        (10.0, 20_200e3),
        (30.0, 800e3),
        (85.0, 35_786e3),
    ] {
        let station = station(48.2, 16.4, mask_deg);
        let mask = station.min_elevation_rad;
        let radius = (radius_m * mask.cos() / (radius_m + height_m)).acos() - mask;
        let up = Ellipsoid::normal(station.place.lat_rad, station.place.lon_rad);
        let mut count = 0;
        station.visibility_circle(height_m, &sphere, |point| {
            assert!((point.length() - radius_m).abs() < 1e-6);
            let off_m = radius_m * (point.angle_between(up) - radius);
            assert!(
                off_m.abs() < 0.1,
                "{off_m} m at {mask_deg}° and {height_m} m"
            );
            count += 1;
        });
        assert_eq!(count, CIRCLE_POINTS);
    }
}

/// On the ellipsoid: a satellite above a point of the circle is at the elevation mask, for any station, including poles and date line.
#[test]
fn satellites_above_the_circle_stand_at_the_mask() {
    for (lat_deg, lon_deg) in [(0.0, 0.0), (52.0, 13.0), (-78.0, 179.9), (90.0, 0.0)] {
        for (mask_deg, height_m) in [(0.0, 300e3), (5.0, 420e3), (20.0, 35_786e3)] {
            let station = station(lat_deg, lon_deg, mask_deg);
            station.visibility_circle(height_m, &Ellipsoid::WGS84, |point| {
                let foot = Ellipsoid::WGS84.geodetic_from_itrf(point);
                let above = itrf(foot.lat_rad, foot.lon_rad, height_m);
                let off = elevation(&station, above) - station.min_elevation_rad;
                assert!(off.abs() < 1e-7, "{off} rad at {lat_deg}° {mask_deg}°");
            });
        }
    }
    let high = Station {
        place: Geodetic::from_degrees(0.0, 0.0, 500e3),
        ..station(0.0, 0.0, 5.0)
    };
    for height_m in [400e3, 500e3, f64::NAN, f64::INFINITY] {
        high.visibility_circle(height_m, &Ellipsoid::WGS84, |_| panic!("{height_m}"));
    }
}

/// The space station over a day: in view exactly during passes, and exactly when the brute-force geometry agrees.
#[test]
fn access_is_that_of_passes_and_of_brute_force() {
    let iss = Sgp4Feed::built_in_iss().expect("built in");
    let from = iss.epoch();
    let station = station(48.2, 16.4, 5.0);
    let orientation = |_: Epoch| Orientation::default();
    let ellipsoid = Ellipsoid::WGS84;
    let mask = station.min_elevation_rad;
    let observer = Observer::new(station.place, &ellipsoid, mask, &orientation);
    let until = from + Duration::from_days(1.0);
    let found = passes(&iss, &observer, from, until);
    let found = found.collect::<Result<Vec<_>, _>>().expect("passes");
    assert!((4..=8).contains(&found.len()), "{}", found.len());
    let (mut in_view, mut disagreeing) = (0, 0);
    for step in 0..8640 {
        let at = from + Duration::from_seconds(10.0 * f64::from(step));
        let place = iss.state_at(at).expect("a state").position_itrf_m();
        let is_seen = station.sees(place, &ellipsoid);
        let is_in_pass = found.iter().any(|pass| pass.begin <= at && at <= pass.end);
        let off = elevation(&station, place) - mask;
        if off.abs() > 1e-6 {
            assert_eq!(is_seen, off > 0.0, "{off} rad at {at}");
        }
        disagreeing += usize::from(is_seen != is_in_pass);
        in_view += usize::from(is_seen);
    }
    assert_eq!(disagreeing, 0);
    assert!((80..400).contains(&in_view), "{in_view}");
}

#[test]
fn stations_without_meaning_are_rejected() {
    assert!(station(48.0, 16.0, 5.0).check().is_ok());
    for bad in [
        station(91.0, 0.0, 5.0),
        station(f64::NAN, 0.0, 5.0),
        station(0.0, f64::INFINITY, 5.0),
        station(0.0, 0.0, 90.0),
        station(0.0, 0.0, -1.0),
        Station {
            width_px: 0.0,
            ..station(0.0, 0.0, 5.0)
        },
    ] {
        assert!(bad.check().is_err(), "{bad:?}");
    }
}
