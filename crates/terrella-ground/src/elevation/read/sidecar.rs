//! Metadata that an elevation file lacks, in a TOML file beside it.

use super::HeightFileError;
use super::error::FileContext;
use crate::elevation::geoid::VerticalDatum;
use crate::elevation::{Bounds, Georeference, GridError, Registration};
use serde::Deserialize;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use terrella_files::{self as files, printable};
use toml::Spanned;

/// Largest sidecar that is read, bytes.
pub const MAX_SIDECAR_BYTES: u64 = 64 << 10;

/// Unit of stored heights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HeightUnit {
    Metres,
    /// International feet of 0.3048 m.
    Feet,
    /// US survey feet, 1200/3937 m.
    UsSurveyFeet,
}

impl HeightUnit {
    pub fn metres(self) -> f64 {
        match self {
            Self::Metres => 1.0,
            Self::Feet => 0.3048,
            Self::UsSurveyFeet => 1200.0 / 3937.0,
        }
    }

    /// The name in sidecars.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metres => "metres",
            Self::Feet => "feet",
            Self::UsSurveyFeet => "us-survey-feet",
        }
    }

    /// The unit of a word used in files.
    pub(super) fn from_word(word: &str) -> Option<Self> {
        match word.trim().to_ascii_lowercase().as_str() {
            "m" | "metre" | "meter" | "metres" | "meters" => Some(Self::Metres),
            "ft" | "foot" | "feet" | "international foot" | "international feet" => {
                Some(Self::Feet)
            }
            "us-ft" | "ftus" | "us survey foot" | "us survey feet" | "us_survey_foot" => {
                Some(Self::UsSurveyFeet)
            }
            _ => None,
        }
    }
}

/// Byte order of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ByteOrder {
    /// The highest byte first, as the PNG standard requires.
    Big,
    /// The lowest byte first, as some programs write PNG by mistake.
    Little,
}

/// Georeference of a file that does not contain one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SidecarGeoreference {
    /// By edges; size and spacing follow from the file's samples.
    Bounds(Bounds, Registration),
    /// By centre (of all cells, or of all posts) and spacings, radians.
    Centre {
        /// Latitude of the centre.
        lat_rad: f64,
        /// Longitude of the centre.
        lon_rad: f64,
        /// Step from row to row.
        lat_step_rad: f64,
        /// Step from column to column.
        lon_step_rad: f64,
        /// Meaning of a sample.
        registration: Registration,
    },
}

impl SidecarGeoreference {
    /// The georeference for a file of this size.
    pub(super) fn georeference(&self, columns: u32, rows: u32) -> Result<Georeference, GridError> {
        match self {
            Self::Bounds(bounds, registration) => {
                Georeference::from_bounds(*registration, bounds, columns, rows)
            }
            Self::Centre {
                lat_rad,
                lon_rad,
                lat_step_rad,
                lon_step_rad,
                registration,
            } => Ok(Georeference {
                columns,
                rows,
                registration: *registration,
                north_rad: lat_rad + 0.5 * f64::from(rows.saturating_sub(1)) * lat_step_rad,
                lat_step_rad: *lat_step_rad,
                west_rad: lon_rad - 0.5 * f64::from(columns.saturating_sub(1)) * lon_step_rad,
                lon_step_rad: *lon_step_rad,
            }),
        }
    }
}

/// A sidecar:
///
/// ```toml
/// bounds = { south_deg = -90, north_deg = 90, west_deg = -180, east_deg = 180 }
/// # or: centre = { lat_deg = 47.5, lon_deg = 11.0 } and spacing = { lat_deg = 0.001, lon_deg = 0.001 }
/// registration = "cells"      # bounds are edges of cells; or "posts": bounds are the outermost samples
/// unit = "metres"             # or "feet", "us-survey-feet"
/// scale = 1.0                 # heights in the unit are offset + scale × stored
/// offset = -11000.0
/// nodata = 65535              # stored values without data
/// byte_order = "big"          # PNG only; "little" for files whose writer mistook it
/// variable = "data"           # NetCDF only; needed if there are several
/// band = 2                    # TIFF only: which of its bands has the heights; the first by default
/// above = "egm96"             # vertical datum: "egm96", "egm2008", "sea" or "ellipsoid"
/// attribution = "NOAA"        # whom to name for the data, at most 1000 characters
/// ```
///
/// Position and unit may be omitted if the file states them; all other keys are optional. Scale, offset and no-data
/// value override those of the file. 360° is added to an east edge at or west of the west edge.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sidecar {
    /// Position of the file.
    pub georeference: Option<SidecarGeoreference>,
    pub unit: Option<HeightUnit>,
    /// Heights in the unit are offset + scale × stored.
    pub scale: Option<f64>,
    pub offset: Option<f64>,
    /// Stored value that means no data.
    pub no_data: Option<f64>,
    /// Byte order of a PNG's samples.
    pub byte_order: Option<ByteOrder>,
    /// Variable of a NetCDF file.
    pub variable: Option<String>,
    /// Band of a TIFF, from 1.
    pub band: Option<u16>,
    /// Vertical datum of heights.
    pub above: Option<VerticalDatum>,
    /// Credit for the data.
    pub attribution: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSidecar {
    bounds: Option<Spanned<RawBounds>>,
    centre: Option<Spanned<RawPair>>,
    spacing: Option<Spanned<RawPair>>,
    registration: Option<Spanned<RawRegistration>>,
    unit: Option<HeightUnit>,
    scale: Option<Spanned<f64>>,
    offset: Option<Spanned<f64>>,
    nodata: Option<f64>,
    byte_order: Option<ByteOrder>,
    variable: Option<String>,
    band: Option<Spanned<u16>>,
    above: Option<VerticalDatum>,
    attribution: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawBounds {
    south_deg: f64,
    north_deg: f64,
    west_deg: f64,
    east_deg: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPair {
    lat_deg: f64,
    lon_deg: f64,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum RawRegistration {
    Cells,
    Posts,
}

/// A text, and the file name for errors.
struct SidecarText<'a>(&'a str, &'a Path);

impl SidecarText<'_> {
    fn wrong(&self, offset: usize, cause: impl Into<String>) -> HeightFileError {
        let before = self.0.as_bytes().iter().take(offset);
        HeightFileError::Sidecar {
            path: self.1.to_owned(),
            line: before.filter(|byte| **byte == b'\n').count() + 1,
            cause: cause.into(),
        }
    }

    fn finite(&self, value: &Spanned<f64>, key: &str) -> Result<f64, HeightFileError> {
        let number = *value.get_ref();
        let fits = number.is_finite() && number.abs() < 1e9 && (key != "scale" || number != 0.0);
        fits.then_some(number).ok_or_else(|| {
            self.wrong(
                value.span().start,
                format!("{key} is {number}; expected a number below 1e9, a scale other than 0"),
            )
        })
    }
}

impl Sidecar {
    /// Reads a sidecar; `path` is its name in messages.
    ///
    /// # Errors
    /// [`HeightFileError::Sidecar`] with the line.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, HeightFileError> {
        let source = SidecarText(text, path);
        if text.len() as u64 > MAX_SIDECAR_BYTES {
            let cause = format!("longer than {MAX_SIDECAR_BYTES} bytes; expected a few lines");
            return Err(source.wrong(0, cause));
        }
        let raw: RawSidecar = toml::from_str(text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start);
            source.wrong(start, printable(error.message()))
        })?;
        let finite = |value: &Option<Spanned<f64>>, key| {
            let value = value.as_ref();
            value.map(|value| source.finite(value, key)).transpose()
        };
        let attribution = match raw.attribution {
            Some(text) if text.get_ref().chars().count() > 1000 => {
                let cause = "attribution has more than 1000 characters; shorten it";
                return Err(source.wrong(text.span().start, cause));
            }
            text => text.map(Spanned::into_inner),
        };
        let band = match raw.band {
            Some(band) if *band.get_ref() == 0 => {
                let cause = "band is 0; expected the number of a band, from 1";
                return Err(source.wrong(band.span().start, cause));
            }
            band => band.map(Spanned::into_inner),
        };
        Ok(Self {
            scale: finite(&raw.scale, "scale")?,
            offset: finite(&raw.offset, "offset")?,
            georeference: georeference(
                &source,
                raw.bounds,
                raw.centre,
                raw.spacing,
                raw.registration,
            )?,
            unit: raw.unit,
            no_data: raw.nodata,
            byte_order: raw.byte_order,
            variable: raw.variable,
            band,
            above: raw.above,
            attribution,
        })
    }
}

fn georeference(
    source: &SidecarText<'_>,
    bounds: Option<Spanned<RawBounds>>,
    centre: Option<Spanned<RawPair>>,
    spacing: Option<Spanned<RawPair>>,
    registration: Option<Spanned<RawRegistration>>,
) -> Result<Option<SidecarGeoreference>, HeightFileError> {
    let starts = [
        bounds.as_ref().map(|value| value.span().start),
        centre.as_ref().map(|value| value.span().start),
        spacing.as_ref().map(|value| value.span().start),
        registration.as_ref().map(|value| value.span().start),
    ];
    let Some(start) = starts.into_iter().flatten().next() else {
        return Ok(None);
    };
    let Some(registration) = registration else {
        let cause = "registration is missing; expected \"cells\" or \"posts\"";
        return Err(source.wrong(start, cause));
    };
    let registration = match registration.into_inner() {
        RawRegistration::Cells => Registration::Cells,
        RawRegistration::Posts => Registration::Posts,
    };
    match (bounds, centre, spacing) {
        (Some(bounds), None, None) => {
            let start = bounds.span().start;
            from_bounds(source, start, bounds.get_ref(), registration).map(Some)
        }
        (None, Some(centre), Some(spacing)) => {
            let (centre, start) = (centre.get_ref(), spacing.span().start);
            let spacing = spacing.get_ref();
            let positive = |step: f64| step > 0.0 && step <= 360.0;
            if !(centre.lat_deg.abs() <= 90.0
                && centre.lon_deg.abs() <= 360.0
                && positive(spacing.lat_deg)
                && positive(spacing.lon_deg))
            {
                let cause = "centre or spacing is no place; expected latitudes of -90 to 90 and positive spacings, degrees";
                return Err(source.wrong(start, cause));
            }
            Ok(Some(SidecarGeoreference::Centre {
                lat_rad: centre.lat_deg.to_radians(),
                lon_rad: centre.lon_deg.to_radians(),
                lat_step_rad: spacing.lat_deg.to_radians(),
                lon_step_rad: spacing.lon_deg.to_radians(),
                registration,
            }))
        }
        _ => {
            let cause = "a place is given in part or twice; expected bounds, or centre and spacing";
            Err(source.wrong(start, cause))
        }
    }
}

fn from_bounds(
    source: &SidecarText<'_>,
    start: usize,
    bounds: &RawBounds,
    registration: Registration,
) -> Result<SidecarGeoreference, HeightFileError> {
    let RawBounds {
        south_deg,
        north_deg,
        west_deg,
        east_deg,
    } = *bounds;
    let is_placed = -90.0 <= south_deg && south_deg < north_deg && north_deg <= 90.0;
    if !(is_placed && west_deg.abs() <= 360.0 && east_deg.abs() <= 360.0) {
        let cause = "bounds are no place; expected -90 <= south_deg < north_deg <= 90 and longitudes of -360 to 360";
        return Err(source.wrong(start, cause));
    }
    let mut width_deg = east_deg - west_deg;
    if width_deg <= 0.0 {
        width_deg += 360.0;
    }
    if !(0.0 < width_deg && width_deg <= 360.0) {
        let cause =
            "bounds are wider than a turn; expected an east_deg at most 360 east of west_deg";
        return Err(source.wrong(start, cause));
    }
    let bounds = Bounds {
        south_rad: south_deg.to_radians(),
        north_rad: north_deg.to_radians(),
        west_rad: west_deg.to_radians(),
        width_rad: width_deg.to_radians(),
    };
    Ok(SidecarGeoreference::Bounds(bounds, registration))
}

/// Path of a file's sidecar.
pub(super) fn sidecar_of(path: &Path) -> PathBuf {
    path.with_extension("toml")
}

/// Name of the sidecar for all files of a folder that have none of their own.
const FOLDER_SIDECAR: &str = "folder.toml";

/// The sidecar of a folder, if there is one; it states no position.
pub(super) fn folder_sidecar(path: &Path) -> Result<Option<Sidecar>, HeightFileError> {
    let of_folder = path.with_file_name(FOLDER_SIDECAR);
    let sidecar = read_sidecar(&of_folder)?;
    match &sidecar {
        Some(said) if said.georeference.is_some() => Err(FileContext::new(&of_folder).rejected(
            "says where all files of its folder lie",
            "unit, scale, offset, nodata or attribution, which files share",
            "write the place into a sidecar of each file",
        )),
        _ => Ok(sidecar),
    }
}

/// The sidecar at a path, if the file exists.
pub(super) fn read_sidecar(path: &Path) -> Result<Option<Sidecar>, HeightFileError> {
    let context = FileContext::new(path);
    let file = match files::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(context.unreadable(error)),
    };
    let mut text = Vec::new();
    file.take(MAX_SIDECAR_BYTES + 1)
        .read_to_end(&mut text)
        .map_err(|error| context.unreadable(error))?;
    let Ok(text) = String::from_utf8(text) else {
        return Err(context.rejected("is no text", "TOML", "write it again as UTF-8"));
    };
    Sidecar::from_toml(&text, path).map(Some)
}
