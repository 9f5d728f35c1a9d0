//! How a position goes from sample to sample and beyond them.

use super::super::entry::{RecordError, RecordFault, number};
use super::super::interpolated::Interpolation;
use super::super::text::json::{Document, Object};
use serde_json::value::RawValue;
use terrella_files::excerpt;

/// Interpolation and extrapolation; settings of one packet persist for later ones.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    /// Of degree 1, whatever `degree` is.
    algorithm: Option<Interpolation>,
    degree: Option<usize>,
    pub forward: Extrapolation,
    pub backward: Extrapolation,
}

/// Extrapolation beyond the samples on one side.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extrapolation {
    kind: Option<ExtrapolationKind>,
    /// Seconds; 0 is without end.
    duration_s: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExtrapolationKind {
    None,
    Hold,
    Extrapolate,
}

impl Extrapolation {
    /// The kind of extrapolation, and its duration in seconds; infinite if none is given.
    pub fn wanted(self) -> (ExtrapolationKind, f64) {
        let duration_s = self.duration_s.filter(|s| *s > 0.0);
        (
            self.kind.unwrap_or(ExtrapolationKind::None),
            duration_s.unwrap_or(f64::INFINITY),
        )
    }

    fn update(&mut self, later: Self) {
        self.kind = later.kind.or(self.kind);
        self.duration_s = later.duration_s.or(self.duration_s);
    }
}

impl Settings {
    /// Applies the settings of a later packet.
    pub fn update(&mut self, later: &Self) {
        self.algorithm = later.algorithm.or(self.algorithm);
        self.degree = later.degree.or(self.degree);
        self.forward.update(later.forward);
        self.backward.update(later.backward);
    }

    pub fn interpolation(&self, with_velocity: bool) -> Interpolation {
        let degree = self.degree.unwrap_or(1);
        let algorithm = self.algorithm.unwrap_or(Interpolation::Linear);
        match Interpolation::from_name(algorithm.name(), degree) {
            // Without velocities Hermite's polynomial is Lagrange's.
            Some(Interpolation::Hermite { degree }) if !with_velocity => {
                Interpolation::Lagrange { degree }
            }
            other => other.unwrap_or(Interpolation::Linear),
        }
    }

    pub fn of<'t>(document: &Document<'t>, object: &Object<'t>) -> Result<Self, RecordError> {
        let key = "interpolationDegree";
        let degree = match object.get(key) {
            Some(value) => Some(
                number(value.get())
                    .filter(|n| n.fract() == 0.0)
                    .filter(|n| (1.0..=Interpolation::MAX_DEGREE as f64).contains(n))
                    .ok_or_else(|| document.wrong(key, value, "a whole number from 1 to 31"))?
                    as usize,
            ),
            None => None,
        };
        let key = "interpolationAlgorithm";
        let algorithm = match object.get(key) {
            Some(value) => {
                let name = document.entry(key, value).map(|e| e.value);
                let known = Interpolation::from_name(name.as_deref().unwrap_or_default(), 1);
                let remedy = "known algorithms are LINEAR, LAGRANGE and HERMITE";
                Some(known.ok_or_else(|| unsupported(document, key, value, remedy))?)
            }
            None => None,
        };
        Ok(Self {
            algorithm,
            degree,
            forward: extrapolation(
                document,
                object,
                "forwardExtrapolationType",
                "forwardExtrapolationDuration",
            )?,
            backward: extrapolation(
                document,
                object,
                "backwardExtrapolationType",
                "backwardExtrapolationDuration",
            )?,
        })
    }
}

fn extrapolation<'t>(
    document: &Document<'t>,
    object: &Object<'t>,
    kind_key: &'static str,
    duration_key: &'static str,
) -> Result<Extrapolation, RecordError> {
    let kind = match object.get(kind_key) {
        Some(value) => {
            let name = document.entry(kind_key, value).map(|e| e.value);
            Some(match name.as_deref() {
                Some("NONE") => ExtrapolationKind::None,
                Some("HOLD") => ExtrapolationKind::Hold,
                Some("EXTRAPOLATE") => ExtrapolationKind::Extrapolate,
                _ => {
                    let remedy = "known types are NONE, HOLD and EXTRAPOLATE";
                    return Err(unsupported(document, kind_key, value, remedy));
                }
            })
        }
        None => None,
    };
    let duration_s = match object.get(duration_key) {
        Some(value) => {
            let seconds = number(value.get()).filter(|s| *s >= 0.0);
            let expected = "seconds, none below 0";
            Some(seconds.ok_or_else(|| document.wrong(duration_key, value, expected))?)
        }
        None => None,
    };
    Ok(Extrapolation { kind, duration_s })
}

pub fn unsupported(
    document: &Document<'_>,
    key: &str,
    value: &RawValue,
    remedy: &'static str,
) -> RecordError {
    let fault = RecordFault::Unsupported {
        key: key.to_owned(),
        text: excerpt(value.get()),
        remedy,
    };
    document.error(value, fault)
}
