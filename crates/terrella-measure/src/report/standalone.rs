//! Measurements without images of a scene: formulas and numerical methods by error and cost, and extreme views.

use super::ReportError;
use crate::extreme::{self, CaseResult};
use crate::numeric::{Measurement, Method, StabilityRow, formulas, measure};
use crate::orbits;
use crate::output::csv_text;
use terrella::{EarthError, GpuContext};
use terrella_imagery::{EarthLayers, LayerImage};
use terrella_play::{PlayError, Progress};

/// Results.
#[derive(Clone, Debug, Default)]
pub struct StandaloneStudy {
    /// Every method at every value of its parameter.
    pub measurements: Vec<Measurement>,
    /// Every form of every formula against arbitrary precision.
    pub stability: Vec<StabilityRow>,
    /// The extreme views and whether they show what they must.
    pub extremes: Vec<CaseResult>,
}

impl StandaloneStudy {
    /// Measures everything; what is not reached before a stop is left out. `quick` takes fewer propagators' cases.
    pub(super) fn gather(
        gpu: &GpuContext,
        quick: bool,
        repeats: u32,
        progress: &dyn Progress,
    ) -> Result<Self, ReportError> {
        let (formulas, cases) = (formulas(), extreme::cases());
        let propagators = orbits::for_report(quick);
        progress.begin(
            "formulas, propagators, extreme views",
            Some((formulas.len() + propagators.len() + cases.len()) as u64),
        );
        let mut found = Self::default();
        for formula in &formulas {
            if progress.cancelled() {
                return Ok(found);
            }
            let method: &dyn Method = formula.as_ref();
            found.measurements.extend(measure(method, repeats));
            found.stability.extend(formula.rows());
            progress.step();
        }
        for propagator in &propagators {
            if progress.cancelled() {
                return Ok(found);
            }
            found
                .measurements
                .extend(measure(propagator.as_ref(), repeats));
            progress.step();
        }
        let layers = grey().map_err(PlayError::from)?;
        for case in &cases {
            if progress.cancelled() {
                return Ok(found);
            }
            found.extremes.push(extreme::run(case, gpu, &layers));
            progress.step();
        }
        progress.end();
        Ok(found)
    }

    /// The table of methods.
    pub fn methods_csv(&self) -> String {
        let head = Measurement::CSV_COLUMNS.map(str::to_owned);
        let lines = self.measurements.iter().map(Measurement::csv_fields);
        csv_text(std::iter::once(head).chain(lines))
    }

    /// The table of formulas.
    pub fn stability_csv(&self) -> String {
        let head = StabilityRow::CSV_COLUMNS.map(str::to_owned);
        let lines = self.stability.iter().map(StabilityRow::csv_fields);
        csv_text(std::iter::once(head).chain(lines))
    }
}

/// The maps that the extreme cases expect: one grey, nothing else.
fn grey() -> Result<EarthLayers, EarthError> {
    let texels = [120, 130, 140, 255].repeat(64 * 32);
    Ok(EarthLayers {
        day: LayerImage::from_rgba8(64, 32, texels)?,
        clouds: None,
        normals: None,
        night_lights: None,
        water: None,
    })
}
