//! Errors of sensors. Each names the parameter and a value that would work.

/// Why a sensor is rejected, or a picture for it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum SensorError {
    /// A number outside its range.
    #[error("{key} = {value} must be from {least:?} to {most:?}{unit}")]
    Range {
        key: &'static str,
        value: f64,
        least: f64,
        most: f64,
        /// With a leading space; empty for plain numbers.
        unit: &'static str,
    },
    /// A list of coefficients of a length that the model does not have.
    #[error("{model} distortion has {wanted} coefficients, not {count}")]
    CoefficientCount {
        model: &'static str,
        wanted: &'static str,
        count: usize,
    },
    /// A pixel that shows several directions of the scene, or none.
    #[error(
        "the coefficients fold the picture over itself: at pixel ({x:.0}, {y:.0}) they have no unique inverse; all of them times {scale:.3} \
         would work"
    )]
    Folds {
        /// The first pixel that has no inverse.
        x: f64,
        y: f64,
        /// The largest scale of all coefficients that works, to 0.001.
        scale: f64,
    },
    /// A field of view that one plane cannot show.
    #[error(
        "the picture reaches {half_field_deg:.1}° from the axis, and at most {most_deg}° can be drawn; a focal length of {focal_mm:.3} mm would work"
    )]
    FieldTooWide {
        half_field_deg: f64,
        most_deg: f64,
        focal_mm: f64,
    },
    /// A point spread too narrow for the samples.
    #[error(
        "the point spread has detail that {oversampling} samples per pixel cannot show; {remedy}"
    )]
    Undersampled { oversampling: u32, remedy: String },
    /// An invalid kernel.
    #[error("the kernel of the point spread {problem}")]
    Kernel { problem: String },
    /// A band outside the solar spectrum.
    #[error(
        "the band {first} to {last} nm must lie within {least} to {most} nm, its shorter wavelength first"
    )]
    Band {
        first: f64,
        last: f64,
        least: f64,
        most: f64,
    },
    /// An image whose size or extent differs from the sensor's request.
    #[error("the picture has {found} pixels, not {wanted}")]
    PictureSize { found: usize, wanted: usize },
}

impl SensorError {
    /// The invalid parameter, by its name in scene files.
    pub fn key(&self) -> &'static str {
        match self {
            Self::Range { key, .. } => key,
            Self::CoefficientCount { .. } | Self::Folds { .. } => "distortion",
            Self::FieldTooWide { .. } => "focal_length_mm",
            Self::Undersampled { .. } => "psf",
            Self::Kernel { .. } => "psf_kernel",
            Self::Band { .. } => "bands_nm",
            Self::PictureSize { .. } => "size",
        }
    }
}

/// Checks that a number is in a range.
pub(crate) fn check_range(
    key: &'static str,
    value: f64,
    range: std::ops::RangeInclusive<f64>,
    unit: &'static str,
) -> Result<(), SensorError> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(SensorError::Range {
        key,
        value,
        least: *range.start(),
        most: *range.end(),
        unit,
    })
}

/// The same of whole numbers.
pub(crate) fn check_count(
    key: &'static str,
    value: u32,
    range: std::ops::RangeInclusive<i64>,
) -> Result<(), SensorError> {
    let range = *range.start() as f64..=*range.end() as f64;
    check_range(key, f64::from(value), range, "")
}
