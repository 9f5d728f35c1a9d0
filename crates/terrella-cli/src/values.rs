//! Values of options, read from their text. Clap reports these errors with the option's name and exit code 2.

#[cfg(feature = "measure")]
use terrella::SurfaceKind;
use terrella::frames::{Epoch, Geodetic, utc_from_text, utc_now};
use terrella_play::scene::{Camera, Output};
use terrella_play::{FrameRange, PictureSettings};

/// `1280x720`.
pub fn size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once(['x', 'X', '×']);
    let side = |text: &str| text.trim().parse::<u32>().ok();
    match sides.map(|(width, height)| (side(width), side(height))) {
        Some((Some(width), Some(height))) => {
            for (name, side) in [("width", width), ("height", height)] {
                if !Output::SIDE_PX.contains(&i64::from(side)) {
                    return Err(format!(
                        "the {name} is {side}; it must be from {} to {} pixels",
                        Output::SIDE_PX.start(),
                        Output::SIDE_PX.end()
                    ));
                }
            }
            Ok((width, height))
        }
        _ => Err("must be WIDTHxHEIGHT in pixels, for example 1280x720".into()),
    }
}

/// `240..480`.
pub fn frame_range(text: &str) -> Result<FrameRange, String> {
    text.parse()
}

/// Pixels along each side of one.
pub fn supersample(text: &str) -> Result<u32, String> {
    let number = text.parse::<u32>().ok();
    number
        .filter(|number| PictureSettings::SUPERSAMPLES.contains(number))
        .ok_or_else(|| "must be 1, 2 or 4".into())
}

/// A number of which this holds, or what it must be.
fn number(text: &str, holds: impl Fn(f64) -> bool, must_be: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok();
    let number = number.filter(|number| holds(*number));
    number.ok_or_else(|| must_be.to_owned())
}

/// A part of the time from frame to frame.
pub fn shutter(text: &str) -> Result<f64, String> {
    number(
        text,
        |part| part > 0.0 && part <= 1.0,
        "must be a number greater than 0 and at most 1, for example 0.5",
    )
}

/// A surface with relief, as scenes write it.
#[cfg(feature = "measure")]
pub fn surface(text: &str) -> Result<SurfaceKind, String> {
    let found = SurfaceKind::ALL.iter().find(|kind| kind.name() == text);
    found.copied().ok_or_else(|| {
        let names: Vec<_> = SurfaceKind::ALL.iter().map(|kind| kind.name()).collect();
        format!("unknown surface; must be one of {}", names.join(", "))
    })
}

/// A UTC instant, or `now`.
pub fn instant(text: &str) -> Result<Epoch, String> {
    let read = match text {
        "now" => utc_now(),
        text => utc_from_text(text),
    };
    read.map_err(|error| error.to_string())
}

/// Seconds of wall-clock time, greater than 0 and at most a day.
pub fn seconds(text: &str) -> Result<f64, String> {
    number(
        text,
        |seconds| seconds > 0.0 && seconds <= 86_400.0,
        "must be a number of seconds, greater than 0 and at most 86400",
    )
}

/// Seconds of simulated time. The scene checks the upper limit.
pub fn simulated_seconds(text: &str) -> Result<f64, String> {
    number(
        text,
        |seconds| seconds > 0.0 && seconds.is_finite(),
        "must be a number of seconds, greater than 0",
    )
}

/// `48.2,16.4` or `48.2,16.4,170`: degrees, south and west negative, and metres above the ellipsoid.
pub fn place(text: &str) -> Result<Geodetic, String> {
    let numbers: Vec<_> = text.split(',').map(|n| n.trim().parse::<f64>()).collect();
    let (lat, lon, height) = match numbers[..] {
        [Ok(lat), Ok(lon)] => (lat, lon, 0.0),
        [Ok(lat), Ok(lon), Ok(height)] => (lat, lon, height),
        _ => {
            return Err("must be latitude,longitude in degrees, for example 48.2,16.4, optionally followed by the height in metres above the ellipsoid".into());
        }
    };
    if !Camera::LAT_DEG.contains(&lat) {
        return Err(format!("the latitude is {lat}; it must be from -90 to 90"));
    }
    if !Camera::LON_DEG.contains(&lon) {
        return Err(format!(
            "the longitude is {lon}; it must be from -360 to 360"
        ));
    }
    if !(-12_000.0..=100_000.0).contains(&height) {
        return Err(format!(
            "the height is {height}; it must be from -12000 to 100000 metres"
        ));
    }
    Ok(Geodetic::from_degrees(lat, lon, height))
}

/// A place as [`place`] reads it, and its name, which comes last: `48.2,16.4,Vienna`. Without a name, the text.
pub fn station(text: &str) -> Result<(Geodetic, String), String> {
    let parts: Vec<_> = text.splitn(3, ',').collect();
    let [lat, lon, rest] = parts[..] else {
        return Ok((place(text)?, text.to_owned()));
    };
    let is_number = |text: &str| text.trim().parse::<f64>().is_ok();
    let (height, name) = match rest.split_once(',') {
        Some((height, name)) if is_number(height) => (Some(height), name),
        None if is_number(rest) => (Some(rest), text),
        _ => (None, rest),
    };
    let name = name.trim();
    if name.is_empty() {
        return Err(
            "the name is empty; write one after the last comma, or leave the comma out".into(),
        );
    }
    let numbers: Vec<_> = [lat, lon].into_iter().chain(height).collect();
    Ok((place(&numbers.join(","))?, name.to_owned()))
}

/// An angle above the horizon.
pub fn elevation_deg(text: &str) -> Result<f64, String> {
    number(
        text,
        |degrees| (0.0..90.0).contains(&degrees),
        "must be a number of degrees from 0 to less than 90",
    )
}

/// A height that a line of sight must keep above the ellipsoid.
pub fn grazing_height_km(text: &str) -> Result<f64, String> {
    number(
        text,
        |height| (0.0..=10_000.0).contains(&height),
        "must be a number of kilometres from 0 to 10000",
    )
}

/// A range.
pub fn range_km(text: &str) -> Result<f64, String> {
    number(
        text,
        |range| range > 0.0 && range <= 1e7,
        "must be a number of kilometres, greater than 0 and at most 1e7",
    )
}

/// Half angle of a sensor's cone.
pub fn half_angle_deg(text: &str) -> Result<f64, String> {
    number(
        text,
        |degrees| degrees > 0.0 && degrees <= 90.0,
        "must be a number of degrees, greater than 0 and at most 90",
    )
}

/// `2,15`: half angles of a rectangular field of view along and across the flight.
pub fn half_angles_deg(text: &str) -> Result<[f64; 2], String> {
    let angles = text.split_once(',').and_then(|(along, across)| {
        let angle = |text: &str| half_angle_deg(text.trim()).ok();
        Some([angle(along)?, angle(across)?])
    });
    angles.ok_or_else(|| {
        "must be two numbers of degrees, each greater than 0 and at most 90, for example 2,15"
            .into()
    })
}

/// Angle of a boresight off nadir.
pub fn off_nadir_deg(text: &str) -> Result<f64, String> {
    number(
        text,
        |degrees| (0.0..=90.0).contains(&degrees),
        "must be a number of degrees from 0 to 90",
    )
}

/// An azimuth.
pub fn azimuth_deg(text: &str) -> Result<f64, String> {
    number(
        text,
        |degrees| degrees.abs() <= 360.0,
        "must be a number of degrees from -360 to 360",
    )
}

/// Side of a cell of the ground.
pub fn cell_deg(text: &str) -> Result<f64, String> {
    number(
        text,
        |degrees| (0.01..=45.0).contains(&degrees),
        "must be a number of degrees from 0.01 to 45",
    )
}

/// `5,44,12,48`: west, south, east and north in degrees; a west beyond the east goes across the date line.
pub fn region_deg(text: &str) -> Result<[f64; 4], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    let edges = numbers
        .ok()
        .and_then(|numbers| <[f64; 4]>::try_from(numbers).ok());
    let edges = edges.filter(|[west, south, east, north]| {
        let is_lon = |lon: &f64| lon.abs() <= 360.0;
        is_lon(west)
            && is_lon(east)
            && west != east
            && *south >= -90.0
            && south < north
            && *north <= 90.0
    });
    edges.ok_or_else(|| {
        "must be west, south, east and north in degrees, for example 5,44,12,48".into()
    })
}

/// A standard magnitude.
pub fn magnitude(text: &str) -> Result<f64, String> {
    number(
        text,
        |magnitude| (-30.0..=30.0).contains(&magnitude),
        "must be a magnitude from -30 to 30",
    )
}

/// A time zone as minutes east of UTC: `+05:30`, `-3`, `Z`.
pub fn time_zone_min(text: &str) -> Result<i32, String> {
    if ["Z", "UTC"].contains(&text) {
        return Ok(0);
    }
    let (sign, rest) = match text.split_at_checked(1) {
        Some(("+", rest)) => (1, rest),
        Some(("-", rest)) => (-1, rest),
        _ => (0, ""),
    };
    let (hours, minutes) = rest.split_once(':').unwrap_or((rest, "00"));
    let number = |digits: &str, most: i32| {
        let is_whole =
            (1..=2).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit());
        let number = digits.parse::<i32>().ok().filter(|_| is_whole);
        number.filter(|number| *number <= most)
    };
    match (sign, number(hours, 14), number(minutes, 59)) {
        (1 | -1, Some(hours), Some(minutes)) => Ok(sign * (60 * hours + minutes)),
        _ => Err("must be an offset from UTC, for example +01:00, -03:30 or Z".into()),
    }
}

/// Days, greater than 0 and at most ten years.
pub fn days(text: &str) -> Result<f64, String> {
    number(
        text,
        |days| days > 0.0 && days <= 3653.0,
        "must be a number of days, greater than 0 and at most 3653",
    )
}

/// A height in kilometres from which the whole Earth can be looked at.
#[cfg(feature = "measure")]
pub fn height_km(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(km) if (1.0..=1e6).contains(&km) => Ok(km),
        _ => Err("must be a number of kilometres from 1 to 1000000".into()),
    }
}

/// A part of a whole, 0 and more, at most tenfold.
#[cfg(feature = "measure")]
pub fn part(text: &str) -> Result<f64, String> {
    number(
        text,
        |part| (0.0..=10.0).contains(&part),
        "must be a number from 0 to 10, for example 0.25 for a quarter",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("1280x720"), Ok((1280, 720)));
        assert_eq!(size("64X36"), Ok((64, 36)));
        for bad in [
            "",
            "x",
            "12",
            "0x10",
            "10x0",
            "-1x5",
            "1e3x5",
            "100000x10",
            "99999999999x1",
        ] {
            assert!(size(bad).is_err(), "{bad}");
        }
        assert!(size("0x10").is_err_and(|words| words.contains("width")));
    }

    #[test]
    fn places_elevations_and_days() {
        let vienna = place("48.2, 16.4,170").expect("a place");
        assert_eq!(vienna, Geodetic::from_degrees(48.2, 16.4, 170.0));
        assert_eq!(place("-33.5,-70.25").map(|place| place.height_m), Ok(0.0));
        for bad in [
            "", "1", "1,2,3,4", "91,0", "0,400", "nan,0", "0,0,1e9", "a,b",
        ] {
            assert!(place(bad).is_err(), "{bad}");
        }
        assert!(place("91,0").is_err_and(|words| words.contains("latitude is 91")));
        assert_eq!((elevation_deg("0"), days("30")), (Ok(0.0), Ok(30.0)));
        for bad in ["-1", "90", "nan", ""] {
            assert!(elevation_deg(bad).is_err(), "{bad}");
        }
        for (zone, minutes) in [
            ("+01:00", 60),
            ("-3", -180),
            ("+05:45", 345),
            ("Z", 0),
            ("UTC", 0),
            ("-00:30", -30),
        ] {
            assert_eq!(time_zone_min(zone), Ok(minutes), "{zone}");
        }
        for bad in [
            "1", "", "+", "+15", "+1:60", "CET", "+1:2:3", "+ 1", "+1:+5",
        ] {
            assert!(time_zone_min(bad).is_err(), "{bad}");
        }
        assert_eq!(magnitude("-1.8"), Ok(-1.8));
        assert!(magnitude("nan").is_err() && magnitude("31").is_err());
        for bad in ["0", "1e9", "inf", "-3"] {
            assert!(days(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn instants_and_seconds() {
        assert!(instant("2018-01-15T12:00:00Z").is_ok());
        assert!(instant("yesterday").is_err() && instant("NOW").is_err());
        for (text, same) in [
            ("2026-11-26 12:30", "2026-11-26T12:30:00Z"),
            ("2018-01-01", "2018-01-01T00:00:00Z"),
        ] {
            assert_eq!(instant(text), instant(same), "{text}");
        }
        let years =
            instant("now").expect("a clock") - instant("2018-01-15T12:00:00Z").expect("UTC");
        assert!(years.to_seconds() > 5.0 * 365.25 * 86_400.0);
        assert_eq!(seconds("2.5"), Ok(2.5));
        for bad in ["0", "-1", "nan", "inf", "1e9", ""] {
            assert!(seconds(bad).is_err(), "{bad}");
        }
        assert_eq!(part("0.25"), Ok(0.25));
        for bad in ["-0.1", "nan", "inf", "11", "", "15%"] {
            assert!(part(bad).is_err(), "{bad}");
        }
    }
}
