//! Ephemerides as CSV with a header that says what the columns are.

use super::Frame;
use super::entry::{
    Entry, Fields, Keys, RecordError, RecordFault, TextPosition, scaled_number, shortened,
};
use super::interpolated::{
    EphemerisFeed, EphemerisSegment, InterpolatedStates, Interpolation, StateSample,
};
use super::text::csv;
use crate::frames::TimeScale;
use glam::DVec3;
use std::borrow::Cow;
use std::path::Path;

/// Most rows of a table.
const MAX_ROWS: usize = 2_000_000;

/// What comments before the header may say.
const KEYS: &Keys = &[
    ("frame", ""),
    ("scale", ""),
    ("name", ""),
    ("interpolation", ""),
    ("degree", ""),
];

/// Lines that say something, with their numbers.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let numbered = text.lines().enumerate();
    numbered
        .map(|(index, line)| (index + 1, line.trim_end()))
        .filter(|(_, line)| !line.trim().is_empty())
}

/// Whether a text is such a table: its first line without `#` names an epoch between commas.
pub(super) fn is_table(text: &str) -> bool {
    let header = lines(text).find(|(_, line)| !line.starts_with('#'));
    header.is_some_and(|(_, line)| line.contains(',') && line.contains("epoch_"))
}

/// The columns that are used.
struct Columns {
    scale: TimeScale,
    epoch: usize,
    position: [usize; 3],
    velocity: Option<[usize; 3]>,
    /// Of ten, from the columns' unit to metres.
    power: i32,
    count: usize,
}

/// Reads the object of a table.
pub(super) fn read(text: &str, origin: &Path) -> Result<EphemerisFeed, RecordError> {
    let start = TextPosition { line: 1, column: 1 };
    let mut said = Fields::new("the table", start, KEYS);
    let mut columns: Option<Columns> = None;
    let mut samples = Vec::new();
    let mut places = Vec::new();
    for (line, text) in lines(text) {
        if let Some(comment) = text.strip_prefix('#') {
            if columns.is_none() {
                declare(&mut said, comment, line, origin)?;
            }
            continue;
        }
        let row = csv::fields(text).ok_or_else(|| {
            let fault = RecordFault::Syntax {
                format: "CSV",
                cause: "a quotation mark without its partner".to_owned(),
            };
            TextPosition { line, column: 1 }.error(origin, fault)
        })?;
        let Some(columns) = &columns else {
            columns = Some(header(&row, line, origin)?);
            continue;
        };
        if samples.len() >= MAX_ROWS {
            let (what, limit) = ("rows", MAX_ROWS);
            let fault = RecordFault::TooMany { what, limit };
            return Err(TextPosition { line, column: 1 }.error(origin, fault));
        }
        samples.push(sample(columns, &row, line, origin)?);
        places.push(line);
    }
    let Some(columns) = columns else {
        return Err(missing(start, "the table", "a header", "", origin));
    };
    let sampled = InterpolatedStates::new(
        frame(&said, &columns, origin)?,
        &samples,
        interpolation(&said, &columns, origin)?,
    );
    let sampled = sampled.map_err(|error| {
        let line = error.index().and_then(|i| places.get(i)).copied();
        let place = TextPosition {
            line: line.unwrap_or(1),
            column: 1,
        };
        place.error(origin, RecordFault::Samples(error))
    })?;
    let stem = origin.file_stem().map(|stem| stem.to_string_lossy());
    let name = match said.get("name") {
        Some(entry) => super::entry::printable(&entry.value),
        None => super::entry::printable(&stem.unwrap_or_default()),
    };
    EphemerisFeed::new(name, None, vec![EphemerisSegment::whole(sampled)])
        .map_err(|error| start.error(origin, RecordFault::Segments(error)))
}

/// `key = value, key = value`; comments without an equals sign say nothing.
fn declare(
    said: &mut Fields,
    comment: &str,
    line: usize,
    origin: &Path,
) -> Result<(), RecordError> {
    for part in comment.split(',') {
        if let Some((key, value)) = part.split_once('=') {
            let entry = Entry {
                key: Cow::Owned(key.trim().to_ascii_lowercase()),
                value: Cow::Borrowed(value.trim()),
                unit: None,
                place: TextPosition {
                    line,
                    column: 2 + super::text::offset(comment, value.trim_start()),
                },
            };
            said.add(entry, origin)?;
        }
    }
    Ok(())
}

fn header(row: &[csv::CsvField], line: usize, origin: &Path) -> Result<Columns, RecordError> {
    let place = TextPosition { line, column: 1 };
    let named = |name: &str| row.iter().position(|field| field.text == name);
    for (index, field) in row.iter().enumerate() {
        let first = named(&field.text).unwrap_or(index);
        if first != index && !field.text.is_empty() {
            let place = TextPosition {
                line,
                column: field.column,
            };
            let key = format!("column {:?}", shortened(&field.text));
            return Err(place.error(origin, RecordFault::Repeated { key, first: line }));
        }
    }
    let scales = TimeScale::ALL.into_iter().filter_map(|scale| {
        let name = format!("epoch_{}", scale.name().to_ascii_lowercase());
        Some((scale, named(&name)?))
    });
    let lacks = |key, remedy| missing(place, "the header", key, remedy, origin);
    let scales: Vec<_> = scales.collect();
    let [(scale, epoch)] = scales.as_slice() else {
        return Err(lacks(
            "one column of time",
            "; expected epoch_utc, epoch_tai, epoch_tt or epoch_gps",
        ));
    };
    let three = |names: [&str; 3]| {
        let [x, y, z] = names.map(named);
        Some([x?, y?, z?])
    };
    let (position, velocity, power) = match three(["x_km", "y_km", "z_km"]) {
        Some(position) => (position, three(["vx_km_s", "vy_km_s", "vz_km_s"]), 3),
        None => match three(["x_m", "y_m", "z_m"]) {
            Some(position) => (position, three(["vx_m_s", "vy_m_s", "vz_m_s"]), 0),
            None => {
                return Err(lacks(
                    "columns of position",
                    "; expected x_km,y_km,z_km or x_m,y_m,z_m",
                ));
            }
        },
    };
    Ok(Columns {
        scale: *scale,
        epoch: *epoch,
        position,
        velocity,
        power,
        count: row.len(),
    })
}

fn sample(
    columns: &Columns,
    row: &[csv::CsvField],
    line: usize,
    origin: &Path,
) -> Result<StateSample, RecordError> {
    if row.len() != columns.count {
        let fault = RecordFault::Unexpected {
            text: format!("{} fields", row.len()),
            expected: "as many as the header has",
        };
        return Err(TextPosition { line, column: 1 }.error(origin, fault));
    }
    let entry = |index: usize, key: &'static str| Entry {
        key: Cow::Borrowed(key),
        value: Cow::Borrowed(row.get(index).map_or("", |field| &field.text)),
        unit: None,
        place: TextPosition {
            line,
            column: row.get(index).map_or(1, |field| field.column),
        },
    };
    let vector = |at: [usize; 3], names: [&'static str; 3]| {
        let mut vector = [0.0; 3];
        for ((slot, index), name) in vector.iter_mut().zip(at).zip(names) {
            let entry = entry(index, name);
            *slot = scaled_number(&entry.value, columns.power)
                .ok_or_else(|| entry.wrong(origin, "a number"))?;
        }
        Ok(DVec3::from_array(vector))
    };
    Ok(StateSample {
        epoch: entry(columns.epoch, "the epoch").epoch(origin, columns.scale)?,
        position_m: vector(columns.position, ["x", "y", "z"])?,
        velocity_m_s: match columns.velocity {
            Some(at) => Some(vector(at, ["vx", "vy", "vz"])?),
            None => None,
        },
    })
}

fn frame(said: &Fields, columns: &Columns, origin: &Path) -> Result<Frame, RecordError> {
    let remedy =
        "; put a line before the header that says it: # frame = TEME (or PEF, ITRF, GCRF, EME2000)";
    let frame = said.must("frame", remedy, origin)?;
    if let Some(scale) = said.get("scale")
        && TimeScale::from_name(&scale.value) != Some(columns.scale)
    {
        return Err(scale.unsupported(origin, "the column of time is of another scale"));
    }
    Frame::from_ccsds_name(&frame.value).ok_or_else(|| {
        frame.unsupported(origin, "known frames are TEME, PEF, ITRF, GCRF and EME2000")
    })
}

fn interpolation(
    said: &Fields,
    columns: &Columns,
    origin: &Path,
) -> Result<Interpolation, RecordError> {
    let otherwise = match columns.velocity {
        Some(_) => Interpolation::WITH_VELOCITIES,
        None => Interpolation::WITHOUT_VELOCITIES,
    };
    let degree = match said.get("degree") {
        Some(entry) => entry
            .value
            .parse::<usize>()
            .ok()
            .filter(|n| (1..=Interpolation::MAX_DEGREE).contains(n))
            .ok_or_else(|| entry.wrong(origin, "a whole number from 1 to 31"))?,
        None => otherwise.degree(),
    };
    let name = match said.get("interpolation") {
        Some(entry) => Interpolation::from_name(&entry.value, degree).ok_or_else(|| {
            entry.unsupported(
                origin,
                "known interpolations are LINEAR, LAGRANGE and HERMITE",
            )
        })?,
        None => Interpolation::from_name(otherwise.name(), degree).unwrap_or(otherwise),
    };
    Ok(name)
}

fn missing(
    place: TextPosition,
    what: &'static str,
    key: &'static str,
    remedy: &'static str,
    origin: &Path,
) -> RecordError {
    place.error(origin, RecordFault::Missing { what, key, remedy })
}
