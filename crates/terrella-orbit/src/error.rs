//! Errors of feeds, each message with the place and the remedy.

use super::RecordError;
use std::path::{Path, PathBuf};

/// Why a feed cannot be made, or has no state at an epoch.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum OrbitError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is compressed by gzip and damaged.
    #[error("{}: cannot be decompressed: {source}; fetch it again", path.display())]
    Compressed {
        path: PathBuf,
        /// The decompressor's reason.
        source: std::io::Error,
    },
    /// The file is packed in a way that is not read.
    #[error("{}: is packed by {packing}; unpack it first, or pack it by gzip", path.display())]
    Packed {
        path: PathBuf,
        /// The program that unpacks it.
        packing: &'static str,
    },
    /// The file is too large for its kind.
    #[error("{}: larger than {limit_mib} MiB; cut out the satellites or the days that you need", path.display())]
    TooLarge { path: PathBuf, limit_mib: u64 },
    /// The file is not text.
    #[error("{}:{line}: not text in UTF-8; files of orbits are plain text: save it in UTF-8", path.display())]
    NotText {
        path: PathBuf,
        /// Line of the first byte that is not UTF-8, or UTF-16 where that is marked, from 1.
        line: usize,
    },
    /// The file declares an encoding that is not supported.
    #[error("{}: its encoding is {encoding:?}; UTF-8, UTF-16, ISO-8859-1 and Windows-1252 are read: save it in UTF-8", path.display())]
    Encoding {
        path: PathBuf,
        /// The name of the encoding.
        encoding: String,
    },
    /// No element set in the file.
    #[error("{}: contains no element set; two-line elements are a line that begins with \"1 \" and one that begins with \"2 \", an OMM is KVN, XML, JSON or CSV", path.display())]
    NoElements { path: PathBuf },
    /// A line of the file is wrong.
    #[error("{}:{line}{}: {fault}", path.display(), At(*column))]
    Line {
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column, from 1, where one is meant.
        column: Option<usize>,
        /// The fault, with its remedy.
        fault: LineFault,
    },
    /// No satellite of that name.
    #[error("{}: no satellite {wanted:?} among its {count}; the nearest name is {nearest:?}", path.display())]
    UnknownName {
        path: PathBuf,
        /// The name looked for.
        wanted: String,
        /// How many sets there are.
        count: usize,
        /// The most similar name.
        nearest: String,
    },
    /// More than one satellite could be meant.
    #[error("{}: {count} {what}{}: {}{}; {remedy}", path.display(), Answering(wanted.as_deref()), names.join(", "), if *count > names.len() { ", …" } else { "" })]
    Ambiguous {
        path: PathBuf,
        /// The choices.
        what: &'static str,
        /// The name looked for, if one was.
        wanted: Option<String>,
        /// How many there are to choose from.
        count: usize,
        /// The first of them, with catalogue number and line.
        names: Vec<String>,
        /// The remedy.
        remedy: &'static str,
    },
    /// The record of the satellite that is wanted cannot be used.
    #[error("{cause}; {wanted:?} has no other record in the file")]
    Unusable {
        /// The name looked for.
        wanted: String,
        /// The error in its record, and its position.
        cause: String,
    },
    /// A file has sets of several epochs of a satellite.
    #[error("{}:{line}: {count} element sets of {satellite}, of {first} to {last}; at each instant the one of the nearest epoch is used", path.display())]
    History {
        path: PathBuf,
        /// Line of the first of them, from 1.
        line: usize,
        satellite: String,
        /// How many epochs there are.
        count: usize,
        /// The earliest epoch, UTC.
        first: String,
        /// The latest, UTC.
        last: String,
    },
    /// SGP4 cannot start from these elements or fails at an epoch.
    #[error("{}:{line}: SGP4 fails for {satellite} at {epoch}: {cause}; the orbit has decayed or the elements are corrupt: take a newer set, or a date nearer to its epoch", path.display())]
    Sgp4 {
        path: PathBuf,
        /// Line of the set's line 1, from 1.
        line: usize,
        satellite: String,
        /// When, UTC.
        epoch: String,
        /// SGP4's reason.
        cause: String,
    },
    /// SGP4 puts the satellite below the ground: it has decayed by then.
    #[error("{}:{line}: {satellite} has decayed by {epoch}: SGP4 puts it {depth_km:.0} km below the equatorial radius; take an earlier date or another satellite", path.display())]
    Decayed {
        path: PathBuf,
        /// Line of the set's line 1, from 1.
        line: usize,
        satellite: String,
        /// When, UTC.
        epoch: String,
        /// How far below 6378.135 km from the Earth's centre, kilometres.
        depth_km: f64,
    },
    /// SGP4 has failed, or put the satellite below the ground, nearer to the epoch of the elements: what it computes here is no orbit.
    #[error("{}:{line}: {satellite} is not known at {epoch}: SGP4 has no valid orbit for it {side} {lost}. Take a date nearer to the elements' epoch, or elements of that time", path.display())]
    Lost {
        path: PathBuf,
        /// Line of the set's line 1, from 1.
        line: usize,
        satellite: String,
        /// When, UTC.
        epoch: String,
        /// Last instant with an orbit, UTC.
        lost: String,
        /// The side without a state: `before` or `after`.
        side: &'static str,
    },
    /// A record of a CCSDS message, of a CZML document or of a table is wrong.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The file has no ephemeris in it.
    #[error("{}: contains no ephemeris; expected an OEM (CCSDS 502.0, KVN or XML), CZML, a table whose header names epoch_utc, x_km, y_km and z_km between commas, semicolons or tabs, SP3, or an ephemeris of STK", path.display())]
    NoEphemeris { path: PathBuf },
    /// A message of another kind.
    #[error("{}: {kind} {remedy}", path.display())]
    NotRead {
        path: PathBuf,
        /// Its kind.
        kind: &'static str,
        /// Why it is not read, and the remedy.
        remedy: &'static str,
    },
    /// The file has contains no orbit parameter message.
    #[error("{}: contains no orbit parameter message; expected an OPM (CCSDS 502.0, KVN or XML)", path.display())]
    NoParameters { path: PathBuf },
    /// The epoch is outside an ephemeris or in one of its gaps.
    #[error(
        "{satellite} is not known at {epoch}: its ephemeris has states {known}; change the date or take an ephemeris of that time"
    )]
    NotCovered {
        satellite: String,
        /// The requested epoch, UTC.
        epoch: String,
        /// When it is known, UTC.
        known: String,
    },
    /// The requested epoch is beyond the orbit's impact on the ground.
    #[error("{satellite} meets the ground at {impact}, {place}; {asked} is beyond that")]
    Impact {
        satellite: String,
        /// Time of impact, UTC.
        impact: String,
        place: String,
        /// The requested epoch, UTC.
        asked: String,
    },
    /// Keplerian elements are wrong.
    #[error(transparent)]
    Kepler(#[from] super::kepler::KeplerError),
    /// An integration cannot be, or cannot go on.
    #[error(transparent)]
    Numerical(#[from] super::numerical::NumericalError),
    /// A live feed has no state for the epoch.
    #[cfg(feature = "live")]
    #[error(transparent)]
    Live(#[from] super::live::LiveError),
    /// The epoch is outside the feed's validity interval.
    #[error(
        "{satellite} is not known at {epoch}: its elements are valid from {first} to {last}; change the date or take elements of that time"
    )]
    OutsideValidity {
        satellite: String,
        /// The requested epoch, UTC.
        epoch: String,
        /// First epoch of the feed's validity, UTC.
        first: String,
        /// Last, UTC.
        last: String,
    },
}

/// Faults of a line in a file of two-line elements.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum LineFault {
    /// Fewer than 69 characters.
    #[error("short line: {length} characters where an element line has 69; copy the whole line")]
    Short { length: usize },
    /// More than 69 characters.
    #[error(
        "long line: {length} characters where an element line has 69; remove what follows the checksum"
    )]
    Long { length: usize },
    /// An element line that does not begin in the first column.
    #[error(
        "the element line begins with a blank; its fields are found by column, so move it to the left margin"
    )]
    Indented,
    /// Something that is not printable ASCII.
    #[error("{character:?} is not allowed here; {expected}")]
    Character {
        character: char,
        /// The accepted characters.
        expected: &'static str,
    },
    /// A name line of a length that no name has.
    #[error("neither an element line nor a name: {length} characters; names have at most {limit}")]
    NameTooLong {
        /// Its length in characters.
        length: usize,
        limit: usize,
    },
    /// A line that looks like elements but has another line number than 1 or 2.
    #[error("line number {digit:?} where an element line has 1 or 2")]
    LineNumber {
        /// The character found.
        digit: char,
    },
    /// Line 1 without a line 2 after it.
    #[error("line 1 of a set is not followed by its line 2; put the two lines together")]
    NoLine2,
    /// Line 2 without a line 1 before it.
    #[error("line 2 of a set has no line 1 before it; put the two lines together")]
    NoLine1,
    /// A name without a set.
    #[error(
        "{text:?} is neither an element line nor a name followed by an element set; begin a comment with #"
    )]
    NameAlone { text: String },
    /// The checksum does not fit.
    #[error(
        "bad checksum: that of the line is {expected} and it ends in {found:?}; a character of it is wrong, copy it again"
    )]
    Checksum {
        /// Sum of the digits, with 1 for each minus sign, modulo 10.
        expected: u32,
        /// The last character.
        found: char,
    },
    /// The two lines name different satellites.
    #[error(
        "mixed satellites: line 1 (line {line1} of the file) is of {catalogue1}, line 2 of {catalogue2}; put lines of one set together"
    )]
    Mixed {
        /// Where line 1 is, from 1.
        line1: usize,
        /// Catalogue number on line 1.
        catalogue1: String,
        /// Catalogue number on line 2.
        catalogue2: String,
    },
    /// A field is not what it should be.
    #[error("{field} is {text:?}; expected {expected}")]
    Field {
        /// Name of the field.
        field: &'static str,
        /// The text found.
        text: String,
        /// The expected text.
        expected: &'static str,
    },
}

impl OrbitError {
    /// Whether it is only a notice about a file that is used completely.
    pub fn is_notice(&self) -> bool {
        match self {
            Self::Record(record) => record.is_notice(),
            Self::History { .. } => true,
            _ => false,
        }
    }

    pub(super) fn line(
        origin: &Path,
        line: usize,
        column: Option<usize>,
        fault: LineFault,
    ) -> Self {
        Self::Line {
            path: origin.to_owned(),
            line,
            column,
            fault,
        }
    }
}

/// `:column`, or nothing.
struct At(Option<usize>);

impl std::fmt::Display for At {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.map_or(Ok(()), |column| write!(f, ":{column}"))
    }
}

/// ` for "name"`, or nothing.
struct Answering<'n>(Option<&'n str>);

impl std::fmt::Display for Answering<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.map_or(Ok(()), |name| write!(f, " for {name:?}"))
    }
}
