//! Georeferencing tags of a GeoTIFF (OGC 19-008r4), and the coordinate systems accepted for elevation data and maps.

use super::projection::{Parameters, Projection};
use super::vertical_codes::has_height;
use std::io::{Read, Seek};
use tiff::decoder::Decoder;
use tiff::tags::Tag;

/// The key of the model type: 1 is projected, 2 geographic, 3 geocentric.
pub const MODEL_TYPE: u16 = 1024;
/// The key of the raster type: 1 is areas, 2 points.
pub const RASTER_TYPE: u16 = 1025;
/// The key of the geographic coordinate system, an EPSG code.
pub(crate) const GEOGRAPHIC_TYPE: u16 = 2048;
const DATUM: u16 = 2050;
const PRIME_MERIDIAN: u16 = 2051;
const ANGULAR_UNITS: u16 = 2054;
const ANGULAR_UNIT_SIZE: u16 = 2055;
const ELLIPSOID: u16 = 2056;
const SEMI_MAJOR_AXIS: u16 = 2057;
const PRIME_MERIDIAN_LONGITUDE: u16 = 2061;
const PROJECTED_TYPE: u16 = 3072;
const LINEAR_UNITS: u16 = 3076;
const TRANSFORMATION: u16 = 3075;
const FIRST_PARALLEL: u16 = 3078;
const SECOND_PARALLEL: u16 = 3079;
const NATURAL_LONGITUDE: u16 = 3080;
const NATURAL_LATITUDE: u16 = 3081;
const FALSE_EAST: u16 = 3082;
const FALSE_NORTH: u16 = 3083;
const FALSE_LONGITUDE: u16 = 3084;
const FALSE_LATITUDE: u16 = 3085;
const ORIGIN_EAST: u16 = 3086;
const ORIGIN_NORTH: u16 = 3087;
const NATURAL_SCALE: u16 = 3092;
const POLE_LONGITUDE: u16 = 3095;
const USER_DEFINED: u16 = 32_767;

/// Geographic coordinate systems (EPSG) within a few metres of WGS84.
const NEAR_WGS84: &[u16] = &[
    4326, // WGS84
    9057, 9755, // WGS84 G1762, G2139
    4322, // WGS72
    4269, 4617, 4152, 4759, 6318, // NAD83: original, CSRS, HARN, NSRS2007, 2011
    4258, // ETRS89
    4283, 7844, // GDA94, GDA2020
    4167, // NZGD2000
    4612, 6668, // JGD2000, JGD2011
    4674, // SIRGAS2000
    4490, // CGCS2000
    4148, // Hartebeesthoek94
    4171, 4624, // RGF93, RGFG95
    4737, // Korea 2000
    7789, 9000, 8999, // ITRF2014, ITRF2008
];

/// Datums accepted without a named system: WGS84, WGS72, NAD83 and ETRS89.
const DATUMS: &[u16] = &[6326, 6322, 6269, 6258];

/// Accepted ellipsoids: WGS84, GRS80, WGS72, CGCS2000.
const ELLIPSOIDS: &[u16] = &[7030, 7019, 7043, 1024];

/// Their semi-axes differ by two metres; those of older surveys differ by 70 m and more.
const EQUATOR_M: f64 = 6_378_137.0;
const EQUATOR_TOLERANCE_M: f64 = 10.0;

/// An accepted coordinate system of elevation data or maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum System {
    /// Latitudes and longitudes of WGS84 or of a system close to it.
    Geographic {
        /// Radians per unit.
        unit_rad: f64,
        /// Whether a code names the system. If false, no key contradicts WGS84.
        is_named: bool,
    },
    /// Web Mercator, EPSG:3857, in metres.
    WebMercator,
}

/// Whether a geographic system (EPSG), with heights or without, is within a few metres of WGS84.
pub fn is_near_wgs84(code: u32) -> bool {
    u16::try_from(code).is_ok_and(|code| NEAR_WGS84.contains(&code)) || has_height(code)
}

/// The tags, as far as present.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GeoTags {
    /// Size of a sample, to the east and to the south.
    pub scale: Option<Vec<f64>>,
    /// Column, row, (level) and longitude, latitude, (height) of points.
    pub tie: Option<Vec<f64>>,
    /// The affine map from columns and rows, 4 × 4 row-major.
    pub matrix: Option<Vec<f64>>,
    /// Pairs of (key, value) of the keys whose value is a whole number.
    pub keys: Vec<(u16, u16)>,
    /// Pairs of (key, value) of the keys whose value is a double.
    pub doubles: Vec<(u16, f64)>,
}

impl GeoTags {
    /// Ignores tags that are absent or of the wrong kind.
    pub fn read<R: Read + Seek>(decoder: &mut Decoder<R>) -> Self {
        let mut numbers = |tag| decoder.get_tag_f64_vec(tag).ok();
        let scale = numbers(Tag::ModelPixelScaleTag);
        let tie = numbers(Tag::ModelTiepointTag);
        let matrix = numbers(Tag::ModelTransformationTag);
        let doubles = numbers(Tag::GeoDoubleParamsTag).unwrap_or_default();
        let keys = decoder.get_tag_u16_vec(Tag::GeoKeyDirectoryTag);
        let keys = keys.unwrap_or_default();
        Self {
            scale,
            tie,
            matrix,
            keys: Self::read_keys(&keys),
            doubles: Self::read_doubles(&keys, &doubles),
        }
    }

    /// The keys of a key directory: a header of four numbers, then four numbers per key.
    fn read_keys(directory: &[u16]) -> Vec<(u16, u16)> {
        let (entries, _) = directory.get(4..).unwrap_or(&[]).as_chunks::<4>();
        entries
            .iter()
            .filter(|[_, place, count, _]| *place == 0 && *count == 1)
            .map(|[key, _, _, value]| (*key, *value))
            .collect()
    }

    /// The keys whose value is stored among the doubles.
    fn read_doubles(directory: &[u16], doubles: &[f64]) -> Vec<(u16, f64)> {
        let tag = Tag::GeoDoubleParamsTag.to_u16();
        let (entries, _) = directory.get(4..).unwrap_or(&[]).as_chunks::<4>();
        entries
            .iter()
            .filter(|[_, place, count, _]| *place == tag && *count == 1)
            .filter_map(|[key, _, _, at]| Some((*key, *doubles.get(usize::from(*at))?)))
            .collect()
    }

    /// Whether the tags name no system and map pixels to their own indices, as libraries write without a georeference.
    pub fn is_unplaced(&self) -> bool {
        if !matches!(self.system(), Ok(None)) {
            return false;
        }
        const IDENTITY: [f64; 16] = [
            1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
        ];
        match (
            self.matrix.as_deref(),
            self.scale.as_deref(),
            self.tie.as_deref(),
        ) {
            // Some writers leave the scale of heights at 0.
            (Some(matrix), ..) => {
                let mut pairs = matrix.iter().zip(&IDENTITY).enumerate();
                matrix.len() == 16 && pairs.all(|(n, (one, other))| n == 10 || one == other)
            }
            (None, Some([1.0, 1.0, ..]), Some([column, row, _, x, y, _])) => {
                *column == *x && *row == *y
            }
            _ => false,
        }
    }

    /// The value of a key, if present.
    pub fn key(&self, key: u16) -> Option<u16> {
        self.keys.iter().find(|(k, _)| *k == key).map(|(_, v)| *v)
    }

    fn double(&self, key: u16) -> Option<f64> {
        let found = self.doubles.iter().find(|(k, _)| *k == key);
        found.map(|(_, value)| *value)
    }

    /// The coordinate system; `None` if no key states it.
    ///
    /// # Errors
    /// The name of a system that is not Web Mercator and not within a few metres of WGS84 in degrees or radians.
    pub fn system(&self) -> Result<Option<System>, String> {
        let projected = self.key(PROJECTED_TYPE);
        let geographic = self.key(GEOGRAPHIC_TYPE);
        match self.key(MODEL_TYPE) {
            Some(2) => self.geographic().map(Some),
            Some(1) => self.projected(projected).map(Some),
            Some(3) => Err("geocentric coordinates".to_string()),
            Some(other) => Err(format!("coordinates of the unknown model {other}")),
            None if projected.is_some() => self.projected(projected).map(Some),
            None if geographic.is_some() => self.geographic().map(Some),
            None => Ok(None),
        }
    }

    /// The projection, if known, of a system in metres within a few metres of WGS84.
    pub fn projection(&self) -> Option<Projection> {
        let is_projected = matches!(self.key(MODEL_TYPE), None | Some(1));
        if !is_projected || !matches!(self.key(LINEAR_UNITS), None | Some(9001)) {
            return None;
        }
        match self.key(PROJECTED_TYPE)? {
            USER_DEFINED => self.own_projection(),
            code => Projection::of_code(code),
        }
    }

    /// A projection whose parameters are given as keys.
    fn own_projection(&self) -> Option<Projection> {
        if self.geographic().is_err()
            || (self.named_geographic().is_none() && self.key(DATUM).is_none())
        {
            return None;
        }
        let first = |keys: &[u16]| keys.iter().find_map(|key| self.double(*key));
        let parameters = Parameters {
            lat_0_deg: first(&[NATURAL_LATITUDE, FALSE_LATITUDE]).unwrap_or(0.0),
            lon_0_deg: first(&[NATURAL_LONGITUDE, FALSE_LONGITUDE, POLE_LONGITUDE]).unwrap_or(0.0),
            false_east_m: first(&[FALSE_EAST, ORIGIN_EAST]).unwrap_or(0.0),
            false_north_m: first(&[FALSE_NORTH, ORIGIN_NORTH]).unwrap_or(0.0),
        };
        let scale = self.double(NATURAL_SCALE).unwrap_or(1.0);
        let parallels = (self.double(FIRST_PARALLEL), self.double(SECOND_PARALLEL));
        // GeoTIFF methods: transverse Mercator, Lambert with two parallels and with one, polar stereographic.
        match (self.key(TRANSFORMATION)?, parallels) {
            (1, _) => Some(Projection::transverse_mercator(parameters, scale)),
            (8, (Some(one), Some(two))) => Some(Projection::lambert(parameters, [one, two], 1.0)),
            (9, _) => Some(Projection::lambert(
                parameters,
                [parameters.lat_0_deg; 2],
                scale,
            )),
            (15, _) if parameters.lat_0_deg.abs() > 1.0 => {
                Some(Projection::polar(parameters, parameters.lat_0_deg, scale))
            }
            _ => None,
        }
    }

    fn projected(&self, code: Option<u16>) -> Result<System, String> {
        match (code, self.key(LINEAR_UNITS)) {
            (Some(3857), None | Some(9001)) => Ok(System::WebMercator),
            (Some(3857), Some(unit)) => Err(format!("lengths of the unit EPSG:{unit}")),
            (code, _) => Err(named("the projected coordinates", code)),
        }
    }

    /// The code of the geographic system; `None` if it has none of its own and its datum counts.
    fn named_geographic(&self) -> Option<u16> {
        let code = self.key(GEOGRAPHIC_TYPE)?;
        let has_datum = self.key(DATUM).is_some_and(|datum| datum != USER_DEFINED);
        (code != USER_DEFINED || !has_datum).then_some(code)
    }

    /// A geographic system near WGS84 by its code, or without a code if no key contradicts WGS84.
    fn geographic(&self) -> Result<System, String> {
        let code = self.named_geographic();
        if code.is_some_and(|code| !is_near_wgs84(code.into())) {
            return Err(named("the geographic coordinates", code));
        }
        self.check_figure()?;
        let unit_rad = match self.key(ANGULAR_UNITS) {
            None | Some(9102 | 9122) => 1f64.to_radians(),
            Some(9101) => 1.0,
            Some(unit) => return Err(format!("angles of the unit EPSG:{unit}")),
        };
        let size = self.double(ANGULAR_UNIT_SIZE).unwrap_or(unit_rad);
        if (size - unit_rad).abs() > 1e-9 {
            return Err(format!("angles of a unit of {size} radians"));
        }
        Ok(System::Geographic {
            unit_rad,
            is_named: code.is_some(),
        })
    }

    /// Checks the keys of datum, ellipsoid and prime meridian; they may contradict the system's code.
    fn check_figure(&self) -> Result<(), String> {
        let other = |key: u16, known: &[u16]| self.key(key).filter(|code| !known.contains(code));
        if self.named_geographic().is_none()
            && let Some(datum) = other(DATUM, DATUMS)
        {
            return Err(named("the datum", Some(datum)));
        }
        if let Some(ellipsoid) = other(ELLIPSOID, ELLIPSOIDS) {
            return Err(named("the ellipsoid", Some(ellipsoid)));
        }
        let equator_m = self.double(SEMI_MAJOR_AXIS).unwrap_or(EQUATOR_M);
        let apart_m = (equator_m - EQUATOR_M).abs();
        if apart_m.is_nan() || apart_m > EQUATOR_TOLERANCE_M {
            return Err(format!("an ellipsoid of {equator_m} m"));
        }
        if let Some(meridian) = other(PRIME_MERIDIAN, &[GREENWICH]) {
            return Err(named("longitudes from the meridian", Some(meridian)));
        }
        let longitude = self.double(PRIME_MERIDIAN_LONGITUDE).unwrap_or(0.0);
        match longitude == 0.0 {
            true => Ok(()),
            false => Err(format!("longitudes from a meridian at {longitude}")),
        }
    }
}

/// Code of the Greenwich prime meridian.
const GREENWICH: u16 = 8901;

/// Name of an object with an EPSG code.
fn named(kind: &str, code: Option<u16>) -> String {
    match code {
        Some(code) if code != USER_DEFINED && code != 0 => format!("{kind} EPSG:{code}"),
        _ => format!("{kind} of its own making"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_with_values_elsewhere_are_passed_over() {
        let directory = [1, 1, 0, 2, 1024, 0, 1, 2, 2049, 34737, 7, 0, 1025, 0];
        assert_eq!(GeoTags::read_keys(&directory), [(1024, 2)]);
        assert_eq!(GeoTags::read_keys(&[1]), []);
        let directory = [
            1, 1, 0, 2, 2057, 34_736, 1, 1, 2059, 34_736, 1, 9, 2048, 0, 1, 4326,
        ];
        let doubles = GeoTags::read_doubles(&directory, &[298.257, 6_378_137.0]);
        assert_eq!(doubles, [(2057, 6_378_137.0)]);
    }

    #[test]
    fn pixels_at_their_own_numbers_have_no_place() {
        let of = |scale: &[f64], tie: &[f64], matrix: Option<Vec<f64>>, keys: &[(u16, u16)]| {
            let tags = GeoTags {
                scale: (!scale.is_empty()).then(|| scale.to_vec()),
                tie: (!tie.is_empty()).then(|| tie.to_vec()),
                matrix,
                keys: keys.to_vec(),
                ..GeoTags::default()
            };
            tags.is_unplaced()
        };
        let identity = |height| {
            let mut matrix = vec![0.0; 16];
            for n in [0, 5, 15] {
                matrix[n] = 1.0;
            }
            matrix[10] = height;
            matrix
        };
        let (one, origin) = ([1.0, 1.0, 0.0], [0.0; 6]);
        assert!(of(&[], &[], Some(identity(0.0)), &[]));
        assert!(of(&[], &[], Some(identity(1.0)), &[(1025, 1)]));
        assert!(of(&one, &origin, None, &[]));
        assert!(!of(
            &[],
            &[],
            Some(identity(0.0)),
            &[(1024, 2), (2048, 4326)]
        ));
        assert!(!of(&one, &[0.0, 0.0, 0.0, 7.0, 0.0, 0.0], None, &[]));
        assert!(!of(&[0.5, 1.0, 0.0], &origin, None, &[]));
        assert!(!of(&[], &[], None, &[]));
    }

    /// Codes and constants of the EPSG registry.
    #[test]
    fn systems_near_wgs84_are_taken_and_others_are_named() {
        let system = |keys: &[(u16, u16)], doubles: &[(u16, f64)]| {
            GeoTags {
                keys: keys.to_vec(),
                doubles: doubles.to_vec(),
                ..GeoTags::default()
            }
            .system()
        };
        let degrees = |is_named| {
            Ok(Some(System::Geographic {
                unit_rad: 1f64.to_radians(),
                is_named,
            }))
        };
        let wgs84: &[(u16, u16)] = &[(1024, 2), (2048, 4326), (2054, 9102)];
        assert_eq!(system(wgs84, &[(2057, 6_378_137.0)]), degrees(true));
        assert_eq!(system(&[(2048, 4269)], &[(2061, 0.0)]), degrees(true));
        assert_eq!(system(&[(1024, 2)], &[]), degrees(false));
        assert_eq!(system(&[], &[]), Ok(None));
        assert_eq!(
            system(&[(1024, 1), (3072, 3857)], &[]),
            Ok(Some(System::WebMercator))
        );
        type Case<'c> = (&'c [(u16, u16)], &'c [(u16, f64)], &'c str);
        let all: &[Case<'_>] = &[
            (&[(1024, 2), (2048, 4267)], &[], "EPSG:4267"),
            (&[(1024, 2), (2048, 4807), (2054, 9105)], &[], "EPSG:4807"),
            (wgs84, &[(2057, 6_378_206.4)], "6378206.4 m"),
            (
                &[(1024, 2), (2048, 32_767)],
                &[(2057, 1_737_400.0)],
                "of its own making",
            ),
            (&[(1024, 2)], &[(2057, 1_737_400.0)], "1737400 m"),
            (&[(1024, 2), (2050, 6267)], &[], "the datum EPSG:6267"),
            (&[(1024, 2), (2056, 7008)], &[], "the ellipsoid EPSG:7008"),
            (
                &[(1024, 2), (2048, 4326), (2051, 8903)],
                &[],
                "meridian EPSG:8903",
            ),
            (
                &[(1024, 2), (2048, 4326)],
                &[(2061, 2.337_229_17)],
                "at 2.33722917",
            ),
            (
                &[(1024, 2), (2048, 4326), (2054, 9105)],
                &[],
                "unit EPSG:9105",
            ),
            (
                &[(1024, 2), (2054, 9102)],
                &[(2055, 0.015_707_963)],
                "0.015707963 radians",
            ),
            (&[(1024, 1), (3072, 32_633)], &[], "EPSG:32633"),
            (&[(3072, 32_633)], &[], "EPSG:32633"),
            (
                &[(1024, 1), (3072, 3857), (3076, 9002)],
                &[],
                "lengths of the unit EPSG:9002",
            ),
            (&[(1024, 3)], &[], "geocentric"),
        ];
        for (keys, doubles, words) in all {
            let said = system(keys, doubles).expect_err(words);
            assert!(said.contains(words), "{words}: {said}");
        }
    }
}
