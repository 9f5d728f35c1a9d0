//! Geometries of GeoJSON: RFC 7946, section 3.1.

use super::{Features, json_fault};
use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny, SeqAccess, Visitor};
use serde_json::value::RawValue;
use std::borrow::Cow;
use std::f64::consts::{PI, TAU};
use std::fmt;
use terrella::frames::Geodetic;

/// Maximum nesting of collections; RFC 7946, 3.1.8, advises against any.
const MAX_DEPTH: usize = 8;
/// Longitudes that are taken, degrees: files that go on beyond the date line have up to one and a half turns.
const MAX_LON_DEG: f64 = 540.0;
/// Rounding of latitudes at the poles, degrees.
const POLE_ROUNDING_DEG: f64 = 1e-6;
/// Rounding of a whole turn, degrees.
const TURN_ROUNDING_DEG: f64 = 1e-6;

/// Rounding of longitudes of the date line, radians.
const DATE_LINE_ROUNDING_RAD: f64 = 1e-9;

/// A part of a geometry.
pub(super) enum Shape {
    Point(Geodetic),
    Line(Vec<Geodetic>),
    /// The first place is the last.
    Ring(Vec<Geodetic>),
}

impl Shape {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Point(_) => 1,
            Self::Line(line) | Self::Ring(line) => line.len(),
        }
    }

    /// Its lines. Ring edges along the date line are the cuts of RFC 7946, 3.1.9, and not part of the outline.
    pub(super) fn into_lines(self) -> Vec<Vec<Geodetic>> {
        let line = match self {
            Self::Point(_) => return Vec::new(),
            Self::Line(line) => return vec![line],
            Self::Ring(line) => line,
        };
        let is_cut = |edge: &[Geodetic]| edge.iter().all(is_on_date_line);
        if !line.windows(2).any(is_cut) {
            return vec![line];
        }
        // A line starts at the position after a cut, so that none is split where the ring starts.
        let first = line.windows(2).position(is_cut).map_or(0, |edge| edge + 1);
        let count = line.len() - 1;
        let round: Vec<Geodetic> = (0..=count).map(|k| line[(first + k) % count]).collect();
        let lines = round.chunk_by(|from, to| !(is_on_date_line(from) && is_on_date_line(to)));
        lines
            .filter(|line| line.len() > 1)
            .map(<[_]>::to_vec)
            .collect()
    }

    /// Position of its name: the middle of a line, or of the area of a ring.
    pub(super) fn anchor(&self) -> Geodetic {
        match self {
            Self::Point(place) => *place,
            Self::Line(line) => {
                // The middle of a segment, as a vertex may have its own name.
                let (from, to) = (line[line.len() / 2 - 1], line[line.len() / 2]);
                let east = to.lon_rad - from.lon_rad;
                let east = east - TAU * (east / TAU).round();
                Geodetic {
                    lat_rad: 0.5 * (from.lat_rad + to.lat_rad),
                    lon_rad: from.lon_rad + 0.5 * east,
                    height_m: 0.0,
                }
            }
            Self::Ring(line) => {
                let corners = &line[1..];
                let count = corners.len() as f64;
                let origin = line[0].lon_rad;
                let lats = corners.iter().map(|place| place.lat_rad);
                // A ring may cross the date line.
                let east = corners.iter().map(|place| place.lon_rad - origin);
                let east = east.map(|lon| lon - TAU * (lon / TAU).round());
                Geodetic {
                    lat_rad: lats.sum::<f64>() / count,
                    lon_rad: origin + east.sum::<f64>() / count,
                    height_m: 0.0,
                }
            }
        }
    }
}

fn is_on_date_line(place: &Geodetic) -> bool {
    (place.lon_rad.abs() - PI).abs() < DATE_LINE_ROUNDING_RAD
}

/// Parts of a geometry.
#[derive(Default)]
pub(super) struct Shapes {
    pub shapes: Vec<Shape>,
    /// The rings of each polygon, which are among the shapes too.
    pub polygons: Vec<Vec<Vec<Geodetic>>>,
    /// Positions that were read.
    pub positions: usize,
    /// Errors of parts that are drawn anyway.
    pub faults: Vec<String>,
    /// Whether an exterior ring is clockwise, against RFC 7946, 3.1.6, which has readers take it anyway.
    pub is_wound_clockwise: bool,
}

pub(super) fn is_geometry(kind: &str) -> bool {
    matches!(
        kind,
        "Point"
            | "MultiPoint"
            | "LineString"
            | "MultiLineString"
            | "Polygon"
            | "MultiPolygon"
            | "GeometryCollection"
    )
}

/// The parts of a geometry with at most so many positions, or what is wrong with it.
pub(super) fn shapes(text: &str, most: usize) -> Result<Shapes, String> {
    let mut shapes = Shapes::default();
    shapes.add(text, most, 0)?;
    Ok(shapes)
}

#[derive(Deserialize)]
struct RawGeometry<'a> {
    #[serde(rename = "type", borrow, default)]
    kind: Option<Cow<'a, str>>,
    #[serde(borrow, default)]
    coordinates: Option<&'a RawValue>,
    #[serde(borrow, default)]
    geometries: Option<Features<'a>>,
}

/// Longitude and latitude, degrees; what is no number is NaN.
#[derive(Clone, Copy)]
struct Position([f64; 2]);

impl<'de> Deserialize<'de> for Position {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Numbers;
        impl<'de> Visitor<'de> for Numbers {
            type Value = Position;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a position, [longitude, latitude]")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Position, A::Error> {
                let mut numbers = [f64::NAN; 2];
                for (index, number) in numbers.iter_mut().enumerate() {
                    match list.next_element::<Option<f64>>()? {
                        Some(given) => *number = given.unwrap_or(f64::NAN),
                        None => return Err(serde::de::Error::invalid_length(index, &self)),
                    }
                }
                // Heights, and other values that programs add.
                while list.next_element::<IgnoredAny>()?.is_some() {}
                Ok(Position(numbers))
            }
        }
        deserializer.deserialize_seq(Numbers)
    }
}

impl Shapes {
    fn add(&mut self, text: &str, most: usize, depth: usize) -> Result<(), String> {
        if depth > MAX_DEPTH {
            return Err("its geometries are nested too deeply".to_owned());
        }
        let raw: RawGeometry<'_> = serde_json::from_str(text).map_err(|e| json_fault(&e))?;
        let kind = raw.kind.as_deref().unwrap_or("missing");
        if kind == "GeometryCollection" {
            let inner = raw
                .geometries
                .ok_or("its GeometryCollection has no geometries")?;
            for one in inner.kept {
                self.add(one, most, depth + 1)?;
            }
            return Ok(());
        }
        if !is_geometry(kind) {
            let kind: String = kind.chars().take(40).collect();
            return Err(format!(
                "its geometry's type is {kind:?}, which GeoJSON has not"
            ));
        }
        let text = raw
            .coordinates
            .ok_or("its geometry has no coordinates")?
            .get();
        // Each position has a bracket: so there is a limit before they are read.
        let brackets = text.bytes().filter(|byte| *byte == b'[').count();
        if self.positions + brackets > 2 * most {
            return Err("the file has more than 1 000 000 positions; simplify it".to_owned());
        }
        match kind {
            "Point" => self.point(coordinates(text)?)?,
            "MultiPoint" => {
                for position in coordinates::<Vec<Position>>(text)? {
                    self.point(position)?;
                }
            }
            "LineString" => self.line(&coordinates::<Vec<Position>>(text)?)?,
            "MultiLineString" => {
                for line in coordinates::<Vec<Vec<Position>>>(text)? {
                    self.line(&line)?;
                }
            }
            "Polygon" => self.polygon(&coordinates::<Vec<Vec<Position>>>(text)?)?,
            _ => {
                for polygon in coordinates::<Vec<Vec<Vec<Position>>>>(text)? {
                    self.polygon(&polygon)?;
                }
            }
        }
        match self.positions > most {
            true => Err("the file has more than 1 000 000 positions; simplify it".to_owned()),
            false => Ok(()),
        }
    }

    fn point(&mut self, position: Position) -> Result<(), String> {
        self.positions += 1;
        self.shapes.push(Shape::Point(place(position)?));
        Ok(())
    }

    fn line(&mut self, line: &[Position]) -> Result<(), String> {
        if line.len() < 2 {
            return Err(format!("a line has {} positions and needs 2", line.len()));
        }
        let places = self.places(line)?;
        self.shapes.push(Shape::Line(places));
        Ok(())
    }

    fn polygon(&mut self, rings: &[Vec<Position>]) -> Result<(), String> {
        let mut polygon = Vec::with_capacity(rings.len());
        for (index, ring) in rings.iter().enumerate() {
            let is_closed = match (ring.first(), ring.last()) {
                (Some(first), Some(last)) => first.0 == last.0,
                _ => false,
            };
            let corners = ring.len() - usize::from(is_closed && !ring.is_empty());
            if corners < 3 {
                return Err(format!("a ring has {corners} corners and needs 3"));
            }
            let mut closed = ring.clone();
            if !is_closed {
                closed.push(ring[0]);
                self.fault("a ring is not closed; it is drawn closed");
            }
            self.is_wound_clockwise |= index == 0 && is_clockwise(&closed);
            let places = self.places(&closed)?;
            polygon.push(places.clone());
            self.shapes.push(Shape::Ring(places));
        }
        self.polygons.push(polygon);
        Ok(())
    }

    /// A line, with places put in where a segment goes around the whole Earth.
    fn places(&mut self, line: &[Position]) -> Result<Vec<Geodetic>, String> {
        self.positions += line.len();
        let mut places: Vec<Geodetic> = Vec::with_capacity(line.len());
        let mut before: Option<Position> = None;
        for position in line {
            let at = place(*position)?;
            if let Some(Position([lon, lat])) = before {
                let Position([to_lon, to_lat]) = *position;
                let turn = (to_lon - lon).abs();
                if turn >= 360.0 - TURN_ROUNDING_DEG {
                    // Straight in longitude and latitude, in thirds that are each shorter than half a turn.
                    for third in [1.0 / 3.0, 2.0 / 3.0] {
                        let part = |from: f64, to: f64| from + third * (to - from);
                        let put_in = [part(lon, to_lon), part(lat, to_lat)];
                        places.push(place(Position(put_in))?);
                    }
                } else if turn > 180.0 {
                    self.fault(&format!(
                        "a segment goes from longitude {lon} to {to_lon}; it is drawn the shorter way, across the date line, where RFC 7946, 3.1.9, has it cut"
                    ));
                }
            }
            places.push(at);
            before = Some(*position);
        }
        Ok(places)
    }

    /// Notes a fault, one of a kind for each feature.
    fn fault(&mut self, what: &str) {
        let kind = |text: &str| text.chars().take(12).collect::<String>();
        if self.faults.iter().all(|other| kind(other) != kind(what)) {
            self.faults.push(what.to_owned());
        }
    }
}

fn coordinates<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    serde_json::from_str(text).map_err(|error| format!("its coordinates: {}", json_fault(&error)))
}

fn place(Position([lon_deg, lat_deg]): Position) -> Result<Geodetic, String> {
    if !(lon_deg.is_finite() && lat_deg.is_finite()) {
        return Err("a coordinate is not a finite number".to_owned());
    }
    if lat_deg.abs() > 90.0 + POLE_ROUNDING_DEG {
        return Err(format!(
            "latitude {lat_deg} is out of range; a position is [longitude, latitude]"
        ));
    }
    if lon_deg.abs() > MAX_LON_DEG {
        return Err(format!("longitude {lon_deg} is out of range"));
    }
    Ok(Geodetic::from_degrees(
        lat_deg.clamp(-90.0, 90.0),
        lon_deg,
        0.0,
    ))
}

/// By the area in longitude and latitude, each step the shorter way around: the shoelace formula.
fn is_clockwise(ring: &[Position]) -> bool {
    let Some(Position(origin)) = ring.first() else {
        return false;
    };
    let (mut lon, mut lat, mut twice_area) = (0.0, 0.0, 0.0);
    for Position([to_lon, to_lat]) in ring {
        let step = to_lon - origin[0] - lon;
        let next = lon + step - 360.0 * (step / 360.0).round();
        let to_lat = to_lat - origin[1];
        twice_area += lon * to_lat - next * lat;
        (lon, lat) = (next, to_lat);
    }
    twice_area < 0.0
}
