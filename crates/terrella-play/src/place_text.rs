//! Places as a person reads them.

/// A place on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundPlace {
    /// Geodetic latitude, degrees.
    pub lat_deg: f64,
    /// Longitude east, degrees, −180…180.
    pub lon_deg: f64,
}

impl std::fmt::Display for GroundPlace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&place_text(
            self.lat_deg.to_radians(),
            self.lon_deg.to_radians(),
        ))
    }
}

pub(super) fn place_text(lat_rad: f64, lon_rad: f64) -> String {
    let (lat, lon) = (lat_rad.to_degrees(), lon_rad.to_degrees());
    format!(
        "{:.3}° {}, {:.3}° {}",
        lat.abs(),
        if lat < 0.0 { "S" } else { "N" },
        lon.abs(),
        if lon < 0.0 { "W" } else { "E" }
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_read_well() {
        let text = place_text((-33.5_f64).to_radians(), (-70.25_f64).to_radians());
        assert_eq!(text, "33.500° S, 70.250° W");
    }
}
