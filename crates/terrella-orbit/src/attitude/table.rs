//! Quaternions in CSV: a header with an epoch and `qx`, `qy`, `qz`, `qw`, after a comment that names the frame.
//!
//! The quaternion rotates vectors from the body's axes to those of the frame, v_frame = q v_body q*; `qw` is its scalar part.

use super::super::Frame;
use super::super::csv_row::{self, CsvRow};
use super::super::entry::{Entry, Fields, Keys, RecordError, RecordFault, TextPosition};
use super::super::text::{csv, offset};
use super::{Segment, push};
use glam::DVec4;
use std::borrow::Cow;
use std::path::Path;
use terrella_frames::TimeScale;

const KEYS: &Keys = &[("frame", "")];
const HEADER: &str = "the columns epoch_utc (or epoch_tai, epoch_tt, epoch_gps), qx, qy, qz and qw";

/// The columns that are used.
struct Columns {
    scale: TimeScale,
    epoch: usize,
    quaternion: [usize; 4],
    count: usize,
}

pub fn segments(text: &str, origin: &Path) -> Result<Vec<Segment>, RecordError> {
    let start = TextPosition { line: 1, column: 1 };
    let mut said = Fields::new("the table", start, KEYS);
    let mut columns: Option<Columns> = None;
    let mut separator = None;
    let mut samples = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        let place = TextPosition { line, column: 1 };
        if text.trim().is_empty() {
            continue;
        }
        if let Some(comment) = text.strip_prefix('#') {
            if let Some((key, value)) = comment.split_once('=') {
                said.add(
                    Entry {
                        key: Cow::Owned(key.trim().to_ascii_lowercase()),
                        value: Cow::Borrowed(value.trim()),
                        unit: None,
                        place: TextPosition {
                            line,
                            column: 2 + offset(comment, value.trim_start()),
                        },
                    },
                    origin,
                )?;
            }
            continue;
        }
        let separator = *separator.get_or_insert_with(|| csv::separator(text).unwrap_or(','));
        let row = csv_row::fields(text, separator, place, origin)?;
        match &columns {
            None => columns = Some(header(&row, place, origin)?),
            Some(columns) => sample(columns, &row, line, &mut samples, origin)?,
        }
    }
    if columns.is_none() {
        let fault = RecordFault::Missing {
            what: "the file",
            key: "attitudes",
            remedy: "; read are AEM (CCSDS 504.0) in KVN, and CSV whose header has the columns epoch_utc, qx, qy, qz and qw",
        };
        return Err(start.error(origin, fault));
    }
    let remedy = "; write \"# frame = GCRF\" (or EME2000, TEME, ITRF) before the header";
    let frame = said.must("frame", remedy, origin)?;
    let frame = Frame::from_ccsds_name(&frame.value).ok_or_else(|| {
        frame.unsupported(origin, "known frames are GCRF, EME2000, TEME, ITRF and PEF")
    })?;
    Ok(vec![Segment::new(
        frame,
        samples,
        (None, None),
        start,
        origin,
    )?])
}

fn header(
    row: &[csv::CsvField<'_>],
    place: TextPosition,
    origin: &Path,
) -> Result<Columns, RecordError> {
    let named = |name: &str| row.iter().position(|field| field.text.trim() == name);
    let scales = TimeScale::ALL.into_iter().filter_map(|scale| {
        let name = format!("epoch_{}", scale.name().to_ascii_lowercase());
        Some((scale, named(&name)?))
    });
    let scales: Vec<_> = scales.collect();
    let quaternion = ["qx", "qy", "qz", "qw"].map(named);
    match (scales.as_slice(), quaternion) {
        ([(scale, epoch)], [Some(x), Some(y), Some(z), Some(w)]) => Ok(Columns {
            scale: *scale,
            epoch: *epoch,
            quaternion: [x, y, z, w],
            count: row.len(),
        }),
        _ => {
            let text = row.first().map_or("", |field| &field.text);
            let text = terrella_files::excerpt(text);
            let expected = HEADER;
            Err(place.error(origin, RecordFault::Unexpected { text, expected }))
        }
    }
}

fn sample(
    columns: &Columns,
    row: &[csv::CsvField<'_>],
    line: usize,
    samples: &mut Vec<(terrella_frames::Epoch, glam::DQuat)>,
    origin: &Path,
) -> Result<(), RecordError> {
    let row = CsvRow::new(row, columns.count, line, origin)?;
    let quaternion = row.numbers(columns.quaternion, ["qx", "qy", "qz", "qw"], 0)?;
    let epoch = row
        .entry(columns.epoch, "the epoch")
        .epoch(origin, columns.scale)?;
    push(
        samples,
        epoch,
        DVec4::from_array(quaternion),
        row.place(),
        origin,
    )
}
