//! Ephemerides as CSV with a header that names the columns.

use super::Frame;
use super::csv_row::{self, CsvRow};
use super::cut::{CutOff, LastLine};
use super::entry::{
    Entry, Fields, Keys, RecordError, RecordFault, TextPosition, printable, scaled_number,
};
use super::found::{Each, Found};
use super::interpolated::{
    EphemerisFeed, EphemerisSegment, InterpolatedStates, Interpolation, InterpolationError,
    StateSample, doubts, sift,
};
use super::text::csv;
use glam::DVec3;
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;
use terrella_files::excerpt;
use terrella_frames::TimeScale;

/// Most rows of a table.
const MAX_ROWS: usize = 2_000_000;

/// Keys that comments before the header may have.
const KEYS: &Keys = &[
    ("frame", ""),
    ("scale", ""),
    ("name", ""),
    ("interpolation", ""),
    ("degree", ""),
];

/// Whether a text is such a table: its first line without `#` has separators and an epoch column.
pub(super) fn is_table(text: &str) -> bool {
    csv::header(text).is_some_and(|(_, header, _)| header.contains("epoch_"))
}

/// What a table lacks whose header names no epoch; `None` of a text that is no table.
pub(super) fn missing_columns(text: &str, origin: &Path) -> Option<RecordError> {
    let (line, header, separator) = csv::header(text)?;
    let header = csv::fields(header, separator).filter(|fields| fields.len() > 2)?;
    let is_missing = |name: &&str| header.iter().all(|field| field.text != *name);
    let columns = ["epoch_utc", "x_km", "y_km", "z_km"];
    let columns: Vec<_> = columns.into_iter().filter(is_missing).collect();
    let remedy = "; a table of states needs them, with these units (or x_m, epoch_tai …), and a column frame or a line \"# frame = TEME\" before the header";
    let place = TextPosition { line, column: 1 };
    Some(place.error(origin, RecordFault::MissingColumns { columns, remedy }))
}

/// The columns that are used.
struct Columns {
    scale: TimeScale,
    epoch: usize,
    position: [usize; 3],
    velocity: Option<[usize; 3]>,
    /// Of ten, from the columns' unit to metres.
    power: i32,
    /// Columns of the satellite's name and of the frame.
    name: Option<usize>,
    frame: Option<usize>,
    /// Column of how far a state may be off.
    error: Option<usize>,
    count: usize,
}

/// Properties of all rows.
struct Table {
    columns: Columns,
    /// Name of the rows without one.
    name: String,
    /// Of all rows, where they have no column of it.
    frame: Option<Frame>,
    interpolation: Interpolation,
}

/// The rows of one satellite.
struct Rows {
    name: String,
    frame: Frame,
    samples: Vec<StateSample>,
    /// Lines of the samples.
    lines: Vec<usize>,
    /// Uncertainty of each state, metres, if its row has one.
    errors_m: Vec<Option<f64>>,
}

/// Calls `each` for every satellite of a table and for every row that is left out of one.
pub(super) fn each_object(
    text: &str,
    origin: &Path,
    each: &mut Each<'_>,
) -> Result<(), RecordError> {
    let start = TextPosition { line: 1, column: 1 };
    let mut said = Fields::new("the table", start, KEYS);
    let mut table: Option<Table> = None;
    let mut objects: Vec<Rows> = Vec::new();
    let mut by_name: HashMap<String, usize> = HashMap::new();
    let mut count = 0;
    let mut last_line = LastLine::of(text);
    let separator = csv::header(text).map_or(',', |(_, _, separator)| separator);
    for (line, text) in csv::lines(text) {
        let place = TextPosition { line, column: 1 };
        if let Some(comment) = text.strip_prefix('#') {
            if table.is_none() {
                declare(&mut said, comment, line, origin)?;
            }
            continue;
        }
        let row = csv_row::fields(text, separator, place, origin);
        let Some(table) = &table else {
            table = Some(whole_table(&said, header(&row?, line, origin)?, origin)?);
            continue;
        };
        count += 1;
        if count > MAX_ROWS {
            let (what, limit) = ("rows", MAX_ROWS);
            return Err(place.error(origin, RecordFault::TooMany { what, limit }));
        }
        let read = row.and_then(|row| {
            let last = row.last().map_or("", |field| field.text.trim());
            if let Some(cut) = last_line.cut(line, row.len(), last) {
                let is_left_out = cut == CutOff::Line;
                each(Found::BadState(
                    place.error(origin, RecordFault::CutOff(cut)),
                ))?;
                if is_left_out {
                    return Ok(());
                }
            }
            let sample = sample(&table.columns, &row, line, origin)?;
            let error_m = match error_m(&table.columns, &row, line, origin) {
                Ok(error_m) => error_m,
                // The state is good without it.
                Err(error) => {
                    each(Found::BadState(error))?;
                    None
                }
            };
            let (name, frame) = whose(table, &row, line, origin)?;
            let object = *by_name.entry(name).or_insert_with_key(|name| {
                objects.push(Rows {
                    name: name.clone(),
                    frame,
                    samples: Vec::new(),
                    lines: Vec::new(),
                    errors_m: Vec::new(),
                });
                objects.len() - 1
            });
            if let Some(object) = objects.get_mut(object) {
                if object.frame != frame {
                    let fault = RecordFault::Unsupported {
                        key: "frame".to_owned(),
                        text: frame.name().to_owned(),
                        remedy: "the satellite's first row is in another; write one frame for all of its rows",
                    };
                    return Err(place.error(origin, fault));
                }
                object.samples.push(sample);
                object.lines.push(line);
                object.errors_m.push(error_m);
            }
            Ok(())
        });
        if let Err(error) = read {
            // Its satellite may have no other row.
            each(match csv_row::fields(text, separator, place, origin) {
                Ok(row) => Found::BadStateOf(name_of(table, &row), error),
                Err(_) => Found::BadState(error),
            })?;
        }
    }
    let Some(table) = table else {
        return Err(missing(start, "the table", "a header", "", origin));
    };
    if objects.is_empty() {
        let fault = RecordFault::Samples(InterpolationError::Empty);
        return Err(start.error(origin, fault));
    }
    for object in objects {
        let names = vec![object.name.clone()];
        let feed = object.feed(table.interpolation, origin, each);
        each(Found::of(names, feed))?;
    }
    Ok(())
}

impl Rows {
    fn feed(
        self,
        interpolation: Interpolation,
        origin: &Path,
        each: &mut Each<'_>,
    ) -> Result<EphemerisFeed, RecordError> {
        let first = self.lines.first().copied().unwrap_or(1);
        let at_its_line = |error: InterpolationError| {
            let line = error.index().and_then(|i| self.lines.get(i)).copied();
            let place = TextPosition {
                line: line.unwrap_or(first),
                column: 1,
            };
            place.error(origin, RecordFault::Samples(error))
        };
        let samples = sift(&self.samples, |error| {
            each(Found::BadState(at_its_line(error)))
        })?;
        for doubt in doubts(self.frame, &samples) {
            let sample = samples.get(doubt.index());
            let at = self.samples.iter().position(|one| Some(one) == sample);
            let line = at.and_then(|at| self.lines.get(at)).copied();
            let place = TextPosition {
                line: line.unwrap_or(first),
                column: 1,
            };
            each(Found::BadState(
                place.error(origin, RecordFault::Doubt(doubt)),
            ))?;
        }
        // Of the states that are kept, which are in their order.
        let mut rows = self.samples.iter().zip(&self.errors_m);
        let sigma_m = samples.iter().filter_map(|kept| {
            let (_, error_m) = rows.find(|(sample, _)| *sample == kept)?;
            error_m.map(|error_m| (kept.epoch, error_m))
        });
        let sigma_m: Vec<_> = sigma_m.collect();
        let samples =
            InterpolatedStates::new(self.frame, &samples, interpolation).map_err(at_its_line)?;
        let segment = EphemerisSegment {
            sigma_m,
            ..EphemerisSegment::whole(samples)
        };
        let place = TextPosition {
            line: first,
            column: 1,
        };
        EphemerisFeed::new(self.name, None, vec![segment])
            .map(|feed| feed.at_line(first))
            .map_err(|error| place.error(origin, RecordFault::Segments(error)))
    }
}

/// Properties of all rows, from comments and header together.
fn whole_table(said: &Fields, columns: Columns, origin: &Path) -> Result<Table, RecordError> {
    for (key, column) in [("frame", columns.frame), ("name", columns.name)] {
        if let (Some(entry), Some(_)) = (said.get(key), column) {
            let remedy = "the table has a column of that name; leave one of the two out";
            return Err(entry.unsupported(origin, remedy));
        }
    }
    let stem = origin.file_stem().map(|stem| stem.to_string_lossy());
    Ok(Table {
        name: match said.get("name") {
            Some(entry) => printable(&entry.value),
            None => printable(&stem.unwrap_or_default()),
        },
        frame: frame(said, &columns, origin)?,
        interpolation: interpolation(said, &columns, origin)?,
        columns,
    })
}

/// The name of a row's satellite.
fn name_of(table: &Table, row: &[csv::CsvField<'_>]) -> String {
    let field = table.columns.name.and_then(|column| row.get(column));
    let named = field.map(|field| printable(field.text.trim()));
    let name = named.filter(|name| !name.is_empty());
    name.unwrap_or_else(|| table.name.clone())
}

/// The name of a row's satellite, and the frame of its state.
fn whose(
    table: &Table,
    row: &[csv::CsvField<'_>],
    line: usize,
    origin: &Path,
) -> Result<(String, Frame), RecordError> {
    let field = table.columns.frame.and_then(|column| row.get(column));
    let frame = match (field, table.frame) {
        (Some(field), _) => known_frame(
            &Entry {
                key: Cow::Borrowed("frame"),
                value: Cow::Borrowed(&field.text),
                unit: None,
                place: TextPosition {
                    line,
                    column: field.column,
                },
            },
            origin,
        )?,
        (None, Some(frame)) => frame,
        // The header may lack this column only if a comment gives the frame.
        (None, None) => return Err(no_frame(TextPosition { line, column: 1 }, origin)),
    };
    Ok((name_of(table, row), frame))
}

/// `key = value, key = value`; comments without an equals sign are ignored.
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

fn header(row: &[csv::CsvField<'_>], line: usize, origin: &Path) -> Result<Columns, RecordError> {
    let place = TextPosition { line, column: 1 };
    let named = |name: &str| row.iter().position(|field| field.text == name);
    for (index, field) in row.iter().enumerate() {
        let first = named(&field.text).unwrap_or(index);
        if first != index && !field.text.is_empty() {
            let place = TextPosition {
                line,
                column: field.column,
            };
            let key = format!("column {:?}", excerpt(&field.text));
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
        name: named("name"),
        frame: named("frame"),
        error: named("error_m"),
        count: row.len(),
    })
}

fn sample(
    columns: &Columns,
    row: &[csv::CsvField<'_>],
    line: usize,
    origin: &Path,
) -> Result<StateSample, RecordError> {
    let row = CsvRow::new(row, columns.count, line, origin)?;
    let vector = |at: [usize; 3], names: [&'static str; 3]| {
        row.numbers(at, names, columns.power).map(DVec3::from_array)
    };
    Ok(StateSample {
        epoch: row
            .entry(columns.epoch, "the epoch")
            .epoch(origin, columns.scale)?,
        position_m: vector(columns.position, ["x", "y", "z"])?,
        velocity_m_s: match columns.velocity {
            Some(at) => Some(vector(at, ["vx", "vy", "vz"])?),
            None => None,
        },
    })
}

/// Uncertainty of a row's state, metres; `None` if the row has none.
fn error_m(
    columns: &Columns,
    row: &[csv::CsvField<'_>],
    line: usize,
    origin: &Path,
) -> Result<Option<f64>, RecordError> {
    let field = columns.error.and_then(|index| row.get(index));
    let Some(field) = field.filter(|field| !field.text.trim().is_empty()) else {
        return Ok(None);
    };
    let error_m = scaled_number(field.text.trim(), 0).filter(|error_m| *error_m >= 0.0);
    let entry = Entry {
        key: Cow::Borrowed("error_m"),
        value: Cow::Borrowed(&field.text),
        unit: None,
        place: TextPosition {
            line,
            column: field.column,
        },
    };
    error_m
        .map(Some)
        .ok_or_else(|| entry.wrong(origin, "metres, 0 or more"))
}

/// The frame of all rows; `None` if each row has its own.
fn frame(said: &Fields, columns: &Columns, origin: &Path) -> Result<Option<Frame>, RecordError> {
    if let Some(scale) = said.get("scale")
        && TimeScale::from_name(&scale.value) != Some(columns.scale)
    {
        return Err(scale.unsupported(origin, "the column of time is of another scale"));
    }
    match (said.get("frame"), columns.frame) {
        (None, Some(_)) => Ok(None),
        (None, None) => Err(no_frame(said.place(), origin)),
        (Some(entry), _) => known_frame(entry, origin).map(Some),
    }
}

fn known_frame(entry: &Entry<'_>, origin: &Path) -> Result<Frame, RecordError> {
    Frame::from_ccsds_name(&entry.value).ok_or_else(|| {
        entry.unsupported(origin, "known frames are TEME, PEF, ITRF, GCRF and EME2000")
    })
}

fn no_frame(place: TextPosition, origin: &Path) -> RecordError {
    let remedy = "; add a column frame that says it in every row: TEME, PEF, ITRF, GCRF or EME2000; or put a line before the header: # frame = TEME";
    missing(place, "the table", "frame", remedy, origin)
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
