//! Position of a raster: its coordinate system, its north-west corner and the size of its texels.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Latitude at which Web Mercator's square ends, degrees: 2·atan(e^π) − 90°.
pub const MERCATOR_END_DEG: f64 = 85.051_128_779_806_59;

/// Coordinate systems of rasters. In both, x is the longitude.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
pub enum Crs {
    /// Latitudes and longitudes (plate carrée).
    #[default]
    #[serde(rename = "EPSG:4326")]
    Geographic,
    /// Web Mercator: y is that of the spherical projection.
    #[serde(rename = "EPSG:3857")]
    WebMercator,
}

impl Crs {
    /// As descriptions name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Geographic => "EPSG:4326",
            Self::WebMercator => "EPSG:3857",
        }
    }

    /// Northing of a latitude, in degrees of longitude: y = ln tan(π/4 + φ/2) in Web Mercator, which is infinite at the poles and
    /// ±180 at [`MERCATOR_END_DEG`].
    pub fn northing_deg(self, latitude_deg: f64) -> f64 {
        match self {
            Self::Geographic => latitude_deg,
            Self::WebMercator => {
                let half = (0.5 * latitude_deg.to_radians()).clamp(-FRAC_PI_4, FRAC_PI_4);
                (half + FRAC_PI_4)
                    .tan()
                    .max(f64::MIN_POSITIVE)
                    .ln()
                    .to_degrees()
            }
        }
    }

    /// Latitude of a northing, degrees: φ = 2·atan(e^y) − π/2.
    pub fn latitude_deg(self, northing_deg: f64) -> f64 {
        match self {
            Self::Geographic => northing_deg,
            Self::WebMercator => {
                (2.0 * northing_deg.to_radians().exp().atan() - FRAC_PI_2).to_degrees()
            }
        }
    }

    /// Northing of the grid's upper edge.
    pub fn top_deg(self) -> f64 {
        match self {
            Self::Geographic => 90.0,
            Self::WebMercator => 180.0,
        }
    }
}

/// Texels of a file that are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First column and first row.
    pub first: (u32, u32),
    /// Columns and rows.
    pub size: (u32, u32),
}

/// Edges of a part of the Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Longitude of the west edge, degrees east, −360…360.
    pub west_deg: f64,
    /// Latitude of the south edge, degrees, −90…90.
    pub south_deg: f64,
    /// Longitude of the east edge: above the west edge's by 360 at most.
    pub east_deg: f64,
    /// Latitude of the north edge, greater than that of the south edge.
    pub north_deg: f64,
}

impl Bounds {
    /// All of the Earth.
    pub const EARTH: Self = Self {
        west_deg: -180.0,
        south_deg: -90.0,
        east_deg: 180.0,
        north_deg: 90.0,
    };

    /// From west, south, east and north in degrees. An east edge at or west of the west edge is increased by 360°.
    ///
    /// # Errors
    /// The error in them.
    pub fn new([west_deg, south_deg, east_deg, north_deg]: [f64; 4]) -> Result<Self, String> {
        let east_deg = if east_deg <= west_deg {
            east_deg + 360.0
        } else {
            east_deg
        };
        let is_good = (-360.0..=360.0).contains(&west_deg)
            && east_deg > west_deg
            && east_deg - west_deg <= 360.0 + 1e-6
            && (-90.0..=90.0).contains(&south_deg)
            && (-90.0..=90.0).contains(&north_deg)
            && north_deg > south_deg;
        if !is_good {
            return Err(format!(
                "bounds {west_deg}, {south_deg}, {east_deg}, {north_deg} are none; give west, south, east and north in \
                 degrees, longitudes from -360 to 360, latitudes from -90 to 90"
            ));
        }
        Ok(Self {
            west_deg,
            south_deg,
            east_deg,
            north_deg,
        })
    }

    /// Degrees from the west edge to the east edge.
    pub fn width_deg(&self) -> f64 {
        self.east_deg - self.west_deg
    }
}

/// Position of a raster. Rows run from north to south, columns from west to east.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RasterPlacement {
    /// Its coordinate system.
    pub crs: Crs,
    /// Longitude of its west edge, degrees.
    pub west_deg: f64,
    /// Northing of its north edge, degrees of longitude.
    pub north_deg: f64,
    /// From column to column, degrees.
    pub column_deg: f64,
    /// From row to row, degrees of northing.
    pub row_deg: f64,
}

impl RasterPlacement {
    /// Of a raster of this size between these edges.
    pub fn from_bounds(crs: Crs, bounds: &Bounds, (columns, rows): (u32, u32)) -> Self {
        let north_deg = crs.northing_deg(bounds.north_deg);
        let south_deg = crs.northing_deg(bounds.south_deg);
        Self {
            crs,
            west_deg: bounds.west_deg,
            north_deg,
            column_deg: bounds.width_deg() / f64::from(columns),
            row_deg: (north_deg - south_deg) / f64::from(rows),
        }
    }

    /// Degrees of longitude that so many columns cover.
    pub fn width_deg(&self, columns: u32) -> f64 {
        self.column_deg * f64::from(columns)
    }

    /// The error for a raster of this size, if any.
    pub fn complaint(&self, (columns, rows): (u32, u32)) -> Option<String> {
        let south_deg = self.north_deg - self.row_deg * f64::from(rows);
        let numbers = [
            self.west_deg,
            self.north_deg,
            self.column_deg,
            self.row_deg,
            south_deg,
        ];
        let texel = 1.001 * self.column_deg.max(self.row_deg);
        let top_deg = self.crs.top_deg();
        let is_good = numbers.iter().all(|number| number.is_finite())
            && self.column_deg > 0.0
            && self.row_deg > 0.0
            && self.west_deg.abs() <= 360.0 + texel
            && self.width_deg(columns) <= 360.0 + 2.0 * texel
            && self.north_deg <= top_deg + texel
            && south_deg >= -top_deg - texel;
        (!is_good).then(|| {
            format!(
                "would lie from longitude {:.4} to {:.4} and from northing {south_deg:.4} to {:.4}, which is not on the Earth",
                self.west_deg,
                self.west_deg + self.width_deg(columns),
                self.north_deg
            )
        })
    }
}

/// Position of NASA's maps of eight parts, from their names: `….A1.jpg` to `….D2.png`. Letters are quarters from 180° W, 1 is north.
pub fn place_in_name(stem: &str) -> Option<Bounds> {
    let part = stem.rsplit(['.', '_', '-']).next()?;
    let [letter @ b'A'..=b'D', digit @ (b'1' | b'2')] = *part.as_bytes() else {
        return None;
    };
    let west_deg = -180.0 + 90.0 * f64::from(letter - b'A');
    let south_deg = if digit == b'1' { 0.0 } else { -90.0 };
    Some(Bounds {
        west_deg,
        south_deg,
        east_deg: west_deg + 90.0,
        north_deg: south_deg + 90.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mercator_goes_there_and_back() {
        let crs = Crs::WebMercator;
        assert!((crs.northing_deg(MERCATOR_END_DEG) - 180.0).abs() < 1e-9);
        for latitude_deg in [-85.0, -45.0, -1e-6, 0.0, 12.5, 60.0, 84.9] {
            let back = crs.latitude_deg(crs.northing_deg(latitude_deg));
            assert!((back - latitude_deg).abs() < 1e-9, "{latitude_deg}: {back}");
        }
        // gd(y): 45° N is at asinh(1) = 50.4989 degrees.
        assert!((crs.northing_deg(45.0) - 1.0_f64.asinh().to_degrees()).abs() < 1e-9);
        assert!(crs.northing_deg(90.0) > 1e3 && crs.northing_deg(-90.0) < -1e3);
    }

    #[test]
    fn nasa_s_names_tell_the_place() {
        let place = place_in_name("world.200408.3x21600x21600.C2").expect("a part");
        assert_eq!(
            place,
            Bounds {
                west_deg: 0.0,
                south_deg: -90.0,
                east_deg: 90.0,
                north_deg: 0.0
            }
        );
        assert_eq!(place_in_name("gebco_08_rev_elev_A1_grey"), None);
        for other in ["world", "E1", "A3", "world.A", ""] {
            assert_eq!(place_in_name(other), None, "{other}");
        }
    }

    #[test]
    fn edges_that_cannot_be_are_rejected() {
        assert!(Bounds::new([170.0, -10.0, -170.0, 10.0]).is_ok_and(|b| b.east_deg == 190.0));
        for bad in [
            [0.0, 10.0, 10.0, 10.0],
            [0.0, -91.0, 10.0, 10.0],
            [f64::NAN, 0.0, 10.0, 10.0],
            [-400.0, 0.0, 10.0, 10.0],
            [-180.0, 0.0, 200.0, 10.0],
        ] {
            assert!(Bounds::new(bad).is_err(), "{bad:?}");
        }
    }
}
