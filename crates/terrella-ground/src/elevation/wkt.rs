//! Coordinate systems as text (well-known text): WKT 1 of GDAL and ESRI (OGC 01-009), and WKT 2 (OGC 18-010r7).

use super::geo_tags::is_near_wgs84;
use super::projection::{Parameters, Projection};
use super::vertical_codes::has_height;

/// Maximum text length, bytes.
pub const MAX_WKT_BYTES: u64 = 64 << 10;

/// Maximum nesting.
const MAX_DEPTH: usize = 16;

/// Maximum length of a foreign name in a message, characters.
const NAME_CHARS: usize = 60;

/// Datums whose degrees are within a few metres of WGS84, for texts without a code; in lower case without
/// punctuation.
const DATUMS: [&str; 38] = [
    "wgs1984",
    "wgs84",
    "dwgs1984",
    "worldgeodeticsystem1984",
    "worldgeodeticsystem1984ensemble",
    "northamericandatum1983",
    "dnorthamerican1983",
    "europeanterrestrialreferencesystem1989",
    "europeanterrestrialreferencesystem1989ensemble",
    "detrs1989",
    // RGF93, GDA94, GDA2020, NZGD2000, SIRGAS 2000, JGD2000 and 2011.
    "reseaugeodesiquefrancais1993",
    "reseaugeodesiquefrancais1993v1",
    "reseaugeodesiquefrancais1993v2",
    "drgf1993",
    "geocentricdatumofaustralia1994",
    "dgda1994",
    "geocentricdatumofaustralia2020",
    "gda2020",
    "newzealandgeodeticdatum2000",
    "dnzgd2000",
    "sistemadereferenciageocentricoparalasamericas2000",
    "dsirgas2000",
    "japanesegeodeticdatum2000",
    "djgd2000",
    "japanesegeodeticdatum2011",
    "djgd2011",
    // NAD83 of 2011, NSRS2007, HARN and CSRS.
    "nad83nationalspatialreferencesystem2011",
    "dnad19832011",
    "nad83nationalspatialreferencesystem2007",
    "dnad1983nsrs2007",
    "nad83highaccuracyreferencenetwork",
    "dnorthamerican1983harn",
    "nad83canadianspatialreferencesystem",
    "dnorthamerican1983csrs",
    // CGCS2000, Hartebeesthoek94.
    "china2000",
    "dchina2000",
    "hartebeesthoek94",
    "dhartebeesthoek1994",
];

/// Names of Web Mercator, in the same form.
const WEB_MERCATOR: [&str; 4] = [
    "wgs84pseudomercator",
    "wgs1984webmercatorauxiliarysphere",
    "wgs1984webmercator",
    "googlemapsglobalmercator",
];

/// Codes of Web Mercator: EPSG's, and those used before it existed.
const WEB_MERCATOR_CODES: [u32; 5] = [3857, 3785, 900_913, 102_100, 102_113];

/// A coordinate system stated in a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TextSystem {
    /// Degrees of WGS84 or of a system close to it.
    Degrees {
        /// Whether it has heights above the ellipsoid too.
        with_height: bool,
    },
    /// Metres of Web Mercator.
    WebMercator,
    /// Metres of a projection with a datum within a few metres of WGS84.
    Projected(Projection),
}

/// Parses the system of a text.
///
/// # Errors
/// The cause: not a text of this kind, or an unsupported system.
pub fn system_of(text: &str) -> Result<TextSystem, String> {
    if is_old_degrees(text) {
        return Ok(TextSystem::Degrees { with_height: false });
    }
    let root = Reader { rest: text }
        .node(0)
        .ok_or("is no well-known text")?;
    let other = || {
        let name: String = root.name().chars().take(NAME_CHARS).collect();
        format!("names the coordinate system {name:?}")
    };
    match root.word.as_str() {
        "PROJCS" | "PROJCRS" | "PROJECTEDCRS" => {
            let is_mercator = match root.code() {
                Some(code) => WEB_MERCATOR_CODES.contains(&code),
                None => WEB_MERCATOR.contains(&plain(root.name()).as_str()),
            };
            match (is_mercator, root.projection()) {
                (true, _) => Ok(TextSystem::WebMercator),
                (false, Some(projection)) => Ok(TextSystem::Projected(projection)),
                (false, None) => Err(other()),
            }
        }
        "GEOGCS" | "GEOGCRS" | "GEOGRAPHICCRS" | "GEODCRS" | "GEODETICCRS" => {
            root.check_geographic()
                .map_err(|why| format!("{}, {why}", other()))?;
            let axes = root.child(&["CS"]).and_then(|axes| axes.number(1));
            Ok(TextSystem::Degrees {
                with_height: axes == Some(3.0) || root.code().is_some_and(has_height),
            })
        }
        _ => Err(other()),
    }
}

/// Whether a text in the old ArcInfo format, with a key and a value per line, states degrees of
/// WGS84 or NAD83.
fn is_old_degrees(text: &str) -> bool {
    let value = |key: &str| {
        let mut lines = text.lines().map(str::split_whitespace);
        let mut line = lines.find(|words| {
            words
                .clone()
                .next()
                .is_some_and(|word| word.eq_ignore_ascii_case(key))
        })?;
        line.nth(1).map(plain)
    };
    let is = |key: &str, values: &[&str]| {
        value(key).is_some_and(|value| values.contains(&value.as_str()))
    };
    is("projection", &["geographic"])
        && is("datum", &["wgs84", "wgs1984", "nad83"])
        && is("units", &["dd", "degrees", "decimaldegrees"])
}

/// A keyword with the contents of its brackets.
#[derive(Default)]
struct Node {
    word: String,
    /// Texts and numbers.
    values: Vec<String>,
    nodes: Vec<Node>,
}

impl Node {
    fn name(&self) -> &str {
        self.values.first().map_or("", String::as_str)
    }

    fn child(&self, words: &[&str]) -> Option<&Self> {
        self.nodes
            .iter()
            .find(|node| words.contains(&node.word.as_str()))
    }

    /// The node's own registry code.
    fn code(&self) -> Option<u32> {
        let code = self.child(&["AUTHORITY", "ID"])?;
        code.values.get(1)?.parse().ok()
    }

    fn number(&self, at: usize) -> Option<f64> {
        self.values.get(at)?.parse().ok()
    }

    /// The projection, stated by parameters or by code, of a system in metres near WGS84.
    fn projection(&self) -> Option<Projection> {
        if let Some(code) = self.code() {
            return Projection::of_code(u16::try_from(code).ok()?);
        }
        let geographic = self.child(&["GEOGCS", "BASEGEOGCRS", "BASEGEODCRS"])?;
        let unit = self
            .child(&["UNIT", "LENGTHUNIT"])
            .and_then(|unit| unit.number(1));
        if geographic.check_geographic().is_err() || unit.is_some_and(|metres| metres != 1.0) {
            return None;
        }
        let number = |names: &[&str]| {
            let of = |node: &&Node| {
                node.word == "PARAMETER" && names.contains(&plain(node.name()).as_str())
            };
            self.nodes.iter().find(of).and_then(|node| node.number(1))
        };
        let parameters = Parameters {
            lat_0_deg: number(&["latitudeoforigin"]).unwrap_or(0.0),
            lon_0_deg: number(&["centralmeridian", "longitudeoforigin"])?,
            false_east_m: number(&["falseeasting"]).unwrap_or(0.0),
            false_north_m: number(&["falsenorthing"]).unwrap_or(0.0),
        };
        let scale = number(&["scalefactor"]).unwrap_or(1.0);
        let parallels = (
            number(&["standardparallel1"]),
            number(&["standardparallel2"]),
        );
        let method = plain(self.child(&["PROJECTION"])?.name());
        match (method.as_str(), parallels) {
            ("transversemercator" | "gausskruger", _) => {
                Some(Projection::transverse_mercator(parameters, scale))
            }
            ("lambertconformalconic" | "lambertconformalconic2sp", (Some(one), Some(two))) => {
                Some(Projection::lambert(parameters, [one, two], scale))
            }
            ("lambertconformalconic1sp", _) => Some(Projection::lambert(
                parameters,
                [parameters.lat_0_deg; 2],
                scale,
            )),
            ("stereographicnorthpole" | "stereographicsouthpole", (Some(lat_deg), _)) => {
                Some(Projection::polar(parameters, lat_deg, scale))
            }
            ("polarstereographic", _) if parameters.lat_0_deg != 0.0 => {
                Some(Projection::polar(parameters, parameters.lat_0_deg, scale))
            }
            _ => None,
        }
    }

    /// Rejects degrees of a system that is not close to WGS84.
    fn check_geographic(&self) -> Result<(), String> {
        let datum = self.child(&["DATUM", "GEODETICDATUM", "TRF", "ENSEMBLE"]);
        let is_known = match self.code() {
            Some(code) => is_near_wgs84(code),
            None => datum.is_some_and(|datum| DATUMS.contains(&plain(datum.name()).as_str())),
        };
        if !is_known {
            return Err("whose degrees are not those of WGS84".to_string());
        }
        let meridian = self.child(&["PRIMEM", "PRIMEMERIDIAN"]);
        if meridian.is_some_and(|meridian| meridian.number(1) != Some(0.0)) {
            return Err("whose longitudes do not begin at Greenwich".to_string());
        }
        let axes = self
            .nodes
            .iter()
            .find_map(|node| node.child(&["ANGLEUNIT"]));
        let unit = self.child(&["UNIT", "ANGLEUNIT"]).or(axes);
        let is_degree = |unit: &Self| {
            let size = unit.number(1);
            size.is_some_and(|size| (size - 1f64.to_radians()).abs() < 1e-9)
        };
        match unit.is_none_or(is_degree) {
            true => Ok(()),
            false => Err("whose angles are no degrees".to_string()),
        }
    }
}

/// Keeps lower-case letters and digits only.
fn plain(name: &str) -> String {
    let kept = name.chars().filter(char::is_ascii_alphanumeric);
    kept.map(|c| c.to_ascii_lowercase()).collect()
}

struct Reader<'a> {
    rest: &'a str,
}

impl Reader<'_> {
    fn skip_blanks(&mut self) {
        let is_blank = |c: char| c.is_whitespace() || matches!(c, '\0' | '\u{feff}');
        self.rest = self.rest.trim_start_matches(is_blank);
    }

    fn takes(&mut self, marks: &[char]) -> bool {
        self.skip_blanks();
        let rest = self.rest.strip_prefix(marks);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    /// Characters up to one of these delimiters.
    fn until(&mut self, marks: &[char]) -> String {
        let end = self.rest.find(marks).unwrap_or(self.rest.len());
        let (text, rest) = self.rest.split_at(end);
        self.rest = rest;
        text.trim().to_string()
    }

    /// A keyword with brackets; `None` otherwise.
    fn node(&mut self, depth: usize) -> Option<Node> {
        self.skip_blanks();
        let word = self.until(&['[', '(', ']', ')', ',', '"']);
        let is_node = depth < MAX_DEPTH && self.takes(&['[', '(']);
        is_node.then_some(())?;
        let mut node = Node {
            word: word.to_ascii_uppercase(),
            ..Node::default()
        };
        loop {
            self.argument(&mut node, depth)?;
            if self.takes(&[']', ')']) {
                return Some(node);
            }
            self.takes(&[',']).then_some(())?;
        }
    }

    fn argument(&mut self, node: &mut Node, depth: usize) -> Option<()> {
        if self.takes(&['"']) {
            node.values.push(self.until(&['"']));
            return self.takes(&['"']).then_some(());
        }
        let before = self.rest;
        let value = self.until(&['[', '(', ']', ')', ',']);
        if self.rest.starts_with(['[', '(']) {
            self.rest = before;
            node.nodes.push(self.node(depth + 1)?);
        } else {
            node.values.push(value);
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Written by GDAL 3.8 and ArcGIS.
    #[test]
    fn degrees_of_wgs84_and_web_mercator_are_known() {
        let esri = "GEOGCS[\"GCS_WGS_1984\",DATUM[\"D_WGS_1984\",SPHEROID[\"WGS_1984\",6378137.0,298.257223563]],\
                    PRIMEM[\"Greenwich\",0.0],UNIT[\"Degree\",0.0174532925199433]]";
        let gdal = "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563,AUTHORITY[\"EPSG\",\"7030\"]],\
                    AUTHORITY[\"EPSG\",\"6326\"]],PRIMEM[\"Greenwich\",0,AUTHORITY[\"EPSG\",\"8901\"]],\
                    UNIT[\"degree\",0.0174532925199433,AUTHORITY[\"EPSG\",\"9122\"]],AXIS[\"Latitude\",NORTH],\
                    AXIS[\"Longitude\",EAST],AUTHORITY[\"EPSG\",\"4326\"]]";
        let second = "GEOGCRS[\"WGS 84\",\n    ENSEMBLE[\"World Geodetic System 1984 ensemble\",\n        MEMBER[\"World Geodetic \
                      System 1984 (Transit)\"],\n        ELLIPSOID[\"WGS 84\",6378137,298.257223563,\n            \
                      LENGTHUNIT[\"metre\",1]],\n        ENSEMBLEACCURACY[2.0]],\n    PRIMEM[\"Greenwich\",0,\n        \
                      ANGLEUNIT[\"degree\",0.0174532925199433]],\n    CS[ellipsoidal,2],\n        AXIS[\"geodetic latitude \
                      (Lat)\",north,\n            ORDER[1],\n            ANGLEUNIT[\"degree\",0.0174532925199433]],\n    \
                      ID[\"EPSG\",4326]]\n";
        for text in [esri, gdal, second] {
            let degrees = TextSystem::Degrees { with_height: false };
            assert_eq!(system_of(text), Ok(degrees), "{text}");
        }
        let esri = "PROJCS[\"WGS_1984_Web_Mercator_Auxiliary_Sphere\",GEOGCS[\"GCS_WGS_1984\",DATUM[\"D_WGS_1984\",\
                    SPHEROID[\"WGS_1984\",6378137.0,298.257223563]],PRIMEM[\"Greenwich\",0.0],UNIT[\"Degree\",\
                    0.0174532925199433]],PROJECTION[\"Mercator_Auxiliary_Sphere\"],UNIT[\"Meter\",1.0]]";
        let gdal = "PROJCS[\"WGS 84 / Pseudo-Mercator\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,\
                    298.257223563]],AUTHORITY[\"EPSG\",\"4326\"]],PROJECTION[\"Mercator_1SP\"],UNIT[\"metre\",1],\
                    AUTHORITY[\"EPSG\",\"3857\"]]";
        for text in [esri, gdal] {
            assert_eq!(system_of(text), Ok(TextSystem::WebMercator), "{text}");
        }
    }

    /// Texts without codes as PROJ writes them, and coordinates as it computes them.
    #[test]
    fn national_datums_near_wgs84_are_known() {
        let text = |name: &str, datum: &str, projection: &str| {
            format!(
                "PROJCS[\"{name}\",GEOGCS[\"GCS\",DATUM[\"{datum}\",SPHEROID[\"GRS_1980\",6378137.0,298.257222101]],\
                 PRIMEM[\"Greenwich\",0.0],UNIT[\"Degree\",0.0174532925199433]],{projection},UNIT[\"Meter\",1.0]]"
            )
        };
        let transverse = |lon: f64, lat: f64, scale: f64, east: f64, north: f64| {
            format!(
                "PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"False_Easting\",{east}],PARAMETER[\"False_Northing\",{north}],\
                 PARAMETER[\"Central_Meridian\",{lon}],PARAMETER[\"Scale_Factor\",{scale}],PARAMETER[\"Latitude_Of_Origin\",{lat}]"
            )
        };
        let lambert = "PROJECTION[\"Lambert_Conformal_Conic\"],PARAMETER[\"False_Easting\",700000.0],PARAMETER[\"False_Northing\",6600000.0],\
                       PARAMETER[\"Central_Meridian\",3.0],PARAMETER[\"Standard_Parallel_1\",49.0],PARAMETER[\"Standard_Parallel_2\",44.0],\
                       PARAMETER[\"Latitude_Of_Origin\",46.5]";
        for (text, place_deg, metres) in [
            (
                text("RGF_1993_Lambert_93", "D_RGF_1993", lambert),
                (48.85, 2.35),
                (652_301.564_8, 6_861_302.725_9),
            ),
            (
                text(
                    "NZTM",
                    "New_Zealand_Geodetic_Datum_2000",
                    &transverse(173.0, 0.0, 0.9996, 1.6e6, 1e7),
                ),
                (-41.29, 174.78),
                (1_749_045.802_9, 5_427_521.383_4),
            ),
            (
                text(
                    "JGD_2011_Japan_Zone_9",
                    "D_JGD_2011",
                    &transverse(139.833_333_333_333, 36.0, 0.9999, 0.0, 0.0),
                ),
                (35.7, 139.7),
                (-12_065.988_6, -33_275.345_7),
            ),
        ] {
            let Ok(TextSystem::Projected(projection)) = system_of(&text) else {
                panic!("{text}: {:?}", system_of(&text));
            };
            let (lat_deg, lon_deg): (f64, f64) = place_deg;
            let got = projection.forward_m(lat_deg.to_radians(), lon_deg.to_radians());
            let off_m = (got.0 - metres.0).hypot(got.1 - metres.1);
            assert!(off_m < 1e-3, "{got:?}, not {metres:?}");
        }
        let with_height = "GEOGCRS[\"WGS 84\",ENSEMBLE[\"World Geodetic System 1984 ensemble\"],CS[ellipsoidal,3],\
                           AXIS[\"geodetic latitude (Lat)\",north,ANGLEUNIT[\"degree\",0.0174532925199433]]]";
        let degrees = TextSystem::Degrees { with_height: true };
        assert_eq!(system_of(with_height), Ok(degrees));
        let by_code = with_height
            .replace("3]", "2]")
            .replace("]]]", "]],ID[\"EPSG\",4937]]");
        assert_eq!(system_of(&by_code), Ok(degrees));
    }

    #[test]
    fn others_are_named() {
        let utm = "PROJCS[\"WGS 84 / UTM zone 33N\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
                   PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],\
                   UNIT[\"metre\",1]]";
        let nad27 = "GEOGCS[\"GCS_North_American_1927\",DATUM[\"D_North_American_1927\",SPHEROID[\"Clarke_1866\",6378206.4,\
                     294.9786982]],PRIMEM[\"Greenwich\",0.0],UNIT[\"Degree\",0.0174532925199433]]";
        let moon = "GEOGCS[\"GCS_Moon_2000\",DATUM[\"D_Moon_2000\",SPHEROID[\"Moon_2000_IAU_IAG\",1737400.0,0.0]],\
                    PRIMEM[\"Reference_Meridian\",0.0],UNIT[\"Degree\",0.0174532925199433]]";
        let paris = "GEOGCS[\"WGS 84 of Paris\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
                     PRIMEM[\"Paris\",2.33722917],UNIT[\"degree\",0.0174532925199433]]";
        let grads = "GEOGCS[\"WGS 84 in grads\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
                     PRIMEM[\"Greenwich\",0],UNIT[\"grad\",0.01570796326794897]]";
        let deep = "GEOGCS[".repeat(100_000);
        for (text, words) in [
            (utm, "\"WGS 84 / UTM zone 33N\""),
            (nad27, "\"GCS_North_American_1927\", whose degrees"),
            (moon, "\"GCS_Moon_2000\", whose degrees"),
            (paris, "do not begin at Greenwich"),
            (grads, "no degrees"),
            ("LOCAL_CS[\"here\"]", "\"here\""),
            ("GEOGCS[\"cut", "no well-known text"),
            ("", "no well-known text"),
            (&deep, "no well-known text"),
        ] {
            let said = system_of(text).expect_err(words);
            assert!(said.contains(words) && said.len() < 200, "{words}: {said}");
        }
    }

    #[test]
    fn projections_and_old_texts_are_known() {
        let utm = "PROJCS[\"WGS_1984_UTM_Zone_33N\",GEOGCS[\"GCS_WGS_1984\",DATUM[\"D_WGS_1984\",SPHEROID[\"WGS_1984\",6378137.0,\
                   298.257223563]],PRIMEM[\"Greenwich\",0.0],UNIT[\"Degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],\
                   PARAMETER[\"False_Easting\",500000.0],PARAMETER[\"False_Northing\",0.0],PARAMETER[\"Central_Meridian\",15.0],\
                   PARAMETER[\"Scale_Factor\",0.9996],PARAMETER[\"Latitude_Of_Origin\",0.0],UNIT[\"Meter\",1.0]]";
        let known = Projection::of_code(32_633).map(TextSystem::Projected);
        assert_eq!(system_of(utm).ok(), known);
        assert!(system_of(&utm.replace("\"Meter\",1.0", "\"Foot_US\",0.3048006")).is_err());
        assert!(system_of(&utm.replace("D_WGS_1984", "D_OSGB_1936")).is_err());
        let polar = utm
            .replace("Transverse_Mercator", "Stereographic_North_Pole")
            .replace("\"Scale_Factor\",0.9996", "\"Standard_Parallel_1\",70.0")
            .replace("500000.0", "0.0")
            .replace("15.0", "-45.0");
        assert_eq!(
            system_of(&polar).ok(),
            Projection::of_code(3413).map(TextSystem::Projected)
        );
        let old = "Projection    GEOGRAPHIC\nDatum         WGS84\nSpheroid      WGS84\nUnits         DD\nZunits        NO\nParameters\n";
        assert_eq!(
            system_of(old),
            Ok(TextSystem::Degrees { with_height: false })
        );
        assert!(system_of(&old.replace("WGS84", "NAD27")).is_err());
    }
}
