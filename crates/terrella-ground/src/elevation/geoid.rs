//! The geoid, and the vertical datums of files.
//!
//! Heights of the ground are metres above mean sea level. Heights of files above the ellipsoid are reduced to mean sea level; otherwise the ground of
//! two files could differ by up to 106 m. The geoid is EGM96 at every 30′, interpolated by cubic convolution. Compared with EGM96 at every
//! 15′, the error is 0.07 m rms and at most 2 m. EGM2008 differs from EGM96 by 0.5 m rms.
//!
//! Source of `egm96_30min.bin`: the 15′ grid WW15MGH.DAC (National Geospatial-Intelligence Agency, public domain), every second row and column.
//! The file holds big-endian centimetres from 90° N to 90° S, each row from 0° to 359.5° E.

use super::vertical_codes::has_height;
use serde::Deserialize;
use std::f64::consts::{FRAC_PI_2, TAU};

const GRID: &[u8] = include_bytes!("geoid/egm96_30min.bin");
const ROWS: i64 = 361;
const COLUMNS: i64 = 720;
/// Nodes of the grid per degree.
const NODES_PER_DEGREE: f64 = 2.0;

/// Vertical datum of heights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum VerticalDatum {
    /// The geoid EGM96.
    Egm96,
    /// The geoid EGM2008.
    Egm2008,
    /// National mean sea level, or an unspecified one: within a metre or two of the geoid.
    Sea,
    /// The ellipsoid of WGS84.
    Ellipsoid,
}

impl VerticalDatum {
    /// The name in sidecars.
    pub fn name(self) -> &'static str {
        match self {
            Self::Egm96 => "egm96",
            Self::Egm2008 => "egm2008",
            Self::Sea => "sea",
            Self::Ellipsoid => "ellipsoid",
        }
    }

    /// The datum of a vertical system, or of a geographic system with heights, by EPSG code. `None` for other codes.
    pub(super) fn of_code(code: u16) -> Option<Self> {
        match code {
            5773 => Some(Self::Egm96),
            3855 => Some(Self::Egm2008),
            // EGM84, mean sea level, NAVD88 in three units, NGVD29, EVRF2000 and 2007, DHHN2016, ODN.
            5798 | 5714 | 5703 | 6360 | 8228 | 5702 | 5730 | 5621 | 7837 | 5701 => Some(Self::Sea),
            // The codes of GeoTIFF 1.0 for heights above WGS84 and GRS80.
            5030 | 5019 => Some(Self::Ellipsoid),
            code if has_height(code.into()) => Some(Self::Ellipsoid),
            _ => None,
        }
    }

    /// The correction from these heights to heights above mean sea level at a place, metres.
    pub fn to_sea_m(self, lat_rad: f64, lon_rad: f64) -> f64 {
        match self {
            Self::Ellipsoid => -geoid_m(lat_rad, lon_rad),
            Self::Egm96 | Self::Egm2008 | Self::Sea => 0.0,
        }
    }
}

/// Height of the geoid above the ellipsoid of WGS84 at a place, metres.
pub fn geoid_m(lat_rad: f64, lon_rad: f64) -> f64 {
    let row = (FRAC_PI_2 - lat_rad)
        .clamp(0.0, 2.0 * FRAC_PI_2)
        .to_degrees()
        * NODES_PER_DEGREE;
    let column = lon_rad.rem_euclid(TAU).to_degrees() * NODES_PER_DEGREE;
    let (top, left) = (row.floor(), column.floor());
    let across = |n: i64| {
        let four = [-1, 0, 1, 2].map(|m| node_m(top as i64 + n, left as i64 + m));
        cubic(four, column - left)
    };
    cubic([-1, 0, 1, 2].map(across), row - top)
}

/// The grid's value at a row and a column; beyond a pole, that of the opposite meridian.
fn node_m(row: i64, column: i64) -> f64 {
    let (row, column) = match row {
        ..0 => (-row, column + COLUMNS / 2),
        ROWS.. => (2 * (ROWS - 1) - row, column + COLUMNS / 2),
        row => (row, column),
    };
    let at = 2 * (row * COLUMNS + column.rem_euclid(COLUMNS)) as usize;
    f64::from(i16::from_be_bytes([GRID[at], GRID[at + 1]])) * 0.01
}

/// Cubic convolution (Catmull–Rom) between the second and the third value.
fn cubic([a, b, c, d]: [f64; 4], t: f64) -> f64 {
    b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The agency's test values of EGM96 (OUTPUT.DAT of its program F477), degrees and metres.
    #[test]
    fn the_geoid_is_that_of_the_agency() {
        for (lat_deg, lon_deg, right_m) in [
            (38.628_155, 269.779_155, -31.628),
            (-14.621_217, 305.021_114, -2.969),
            (46.874_319, 102.448_729, -43.575),
            (-23.617_446, 133.874_712, 15.871),
            (38.625_473, 359.9995, 50.066),
            (-0.466_744, 0.0023, 17.329),
        ] {
            let got_m = geoid_m(f64::to_radians(lat_deg), f64::to_radians(lon_deg));
            assert!(
                (got_m - right_m).abs() < 0.2,
                "{lat_deg} {lon_deg}: {got_m}"
            );
            let turned_m = geoid_m(f64::to_radians(lat_deg), f64::to_radians(lon_deg - 720.0));
            assert!((got_m - turned_m).abs() < 1e-9);
        }
        // WW15MGH.DAC between the nodes, where the geoid is steepest: the Andes, Nepal, Hawaii, the Bonin trench, the Canary Islands.
        for (lat_deg, lon_deg, right_m) in [
            (6.75, -72.25, 11.44),
            (-24.75, -70.25, 35.66),
            (28.75, 85.75, -27.95),
            (19.25, -155.25, 19.0),
            (27.25, 142.75, 40.33),
            (28.25, -16.75, 50.47),
        ] {
            let got_m = geoid_m(f64::to_radians(lat_deg), f64::to_radians(lon_deg));
            assert!(
                (got_m - right_m).abs() < 2.0,
                "{lat_deg} {lon_deg}: {got_m}"
            );
        }
        // Nodes: both poles at several longitudes, the low of the Indian Ocean, and the date line
        // from both sides.
        for lon_rad in [0.0, 1.0, -3.0] {
            assert!((geoid_m(FRAC_PI_2, lon_rad) - 13.61).abs() < 1e-9);
            assert!((geoid_m(-FRAC_PI_2, lon_rad) + 29.53).abs() < 1e-9);
        }
        assert!(geoid_m(4.7_f64.to_radians(), 78.8_f64.to_radians()) < -105.0);
        let step =
            geoid_m(0.3, std::f64::consts::PI - 1e-9) - geoid_m(0.3, 1e-9 - std::f64::consts::PI);
        assert!(step.abs() < 1e-6);
    }
}
