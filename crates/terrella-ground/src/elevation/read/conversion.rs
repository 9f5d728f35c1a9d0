//! Conversion from stored numbers to metres.

use super::error::FileContext;
use super::missing::Missing;
use super::{Header, HeightFileError, Sidecar, sidecar_of};
use std::cell::Cell;

/// Numbers that programs write for no data, and that are rarely or never heights: GDAL, ArcGIS, SRTM, DTED, floats.
const USUAL: [f64; 7] = [
    -9999.0,
    -32_768.0,
    -32_767.0,
    -99_999.0,
    -3.402_823_466_385_288_6e38,
    -3.402_823_4e38,
    f64::MIN,
];

/// Conversion from stored numbers to metres.
pub(in crate::elevation) struct Conversion {
    scale_m: f64,
    offset_m: f64,
    missing: Missing,
    /// Number of samples treated as no data without a declaration, and the value of the first.
    undeclared: Cell<(u64, f64)>,
}

impl Conversion {
    pub(super) fn of(
        header: &Header,
        said: &Sidecar,
        context: &FileContext,
    ) -> Result<Self, HeightFileError> {
        let unit = match (header.unit, said.unit) {
            (Some(of_file), Some(of_sidecar)) if of_file != of_sidecar => {
                return Err(HeightFileError::TwoUnits {
                    path: context.path().to_owned(),
                    of_file: of_file.name(),
                    of_sidecar: of_sidecar.name(),
                });
            }
            (Some(unit), _) | (None, Some(unit)) => unit,
            (None, None) => {
                return Err(HeightFileError::NoUnit {
                    path: context.path().to_owned(),
                    sidecar: sidecar_of(context.path()),
                });
            }
        };
        let unit_m = unit.metres();
        Ok(Self {
            scale_m: said.scale.or(header.scale).unwrap_or(1.0) * unit_m,
            offset_m: said.offset.or(header.offset).unwrap_or(0.0) * unit_m,
            missing: match said.no_data {
                Some(no_data) => header.missing.but(no_data),
                None => header.missing,
            },
            undeclared: Cell::new((0, 0.0)),
        })
    }

    /// Height in metres; NaN without data.
    #[inline]
    pub(super) fn metres(&self, stored: f64) -> f32 {
        if self.missing.has(stored) {
            return f32::NAN;
        }
        if stored <= USUAL[0] && !self.missing.is_declared() && USUAL.contains(&stored) {
            let (count, first) = self.undeclared.get();
            let first = if count == 0 { stored } else { first };
            self.undeclared.set((count + 1, first));
            return f32::NAN;
        }
        (self.offset_m + self.scale_m * stored) as f32
    }

    /// Whether a stored number means no data.
    pub(super) fn is_missing(&self, stored: f64) -> bool {
        let is_usual = !self.missing.is_declared() && USUAL.contains(&stored);
        stored.is_nan() || self.missing.has(stored) || is_usual
    }

    /// Number of samples so far that were treated as no data without a declaration.
    pub(super) fn undeclared(&self) -> u64 {
        self.undeclared.get().0
    }

    /// The same as text.
    pub(super) fn note(&self, context: &FileContext) -> Option<String> {
        let (count, first) = self.undeclared.get();
        (count > 0).then(|| {
            format!(
                "{}: {count} samples hold {first} or another number that usually means no data, and nothing declares it: they are taken \
                 for no data; write nodata = {first} in {} to say so, or nodata = nan to keep them as heights",
                context.path().display(),
                sidecar_of(context.path()).display()
            )
        })
    }
}
