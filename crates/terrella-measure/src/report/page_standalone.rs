//! The page's part about formulas, propagators and extreme views, which need no scene.

use super::StandaloneStudy;
use super::format::number;
use super::method_plots::{METHODS, ORBITS, about};
use super::plots::Plot;
use crate::extreme::CaseResult;
use crate::html::{self, ChartFigure, PageError};
use crate::numeric::{Measurement, StabilityRow};
use serde::Serialize;

/// Values of `standalone.html`. Parts without measurements are omitted.
#[derive(Serialize)]
struct Values<'s> {
    stability: Option<Stability<'s>>,
    propagators: Option<Propagators<'s>>,
    extremes: Option<Extremes<'s>>,
}

#[derive(Serialize)]
struct Stability<'s> {
    /// Forms that the product uses.
    stable: usize,
    /// Those of them that keep their bound.
    kept: usize,
    rows: Vec<FormRow<'s>>,
    charts: Vec<ChartFigure<'s>>,
}

#[derive(Serialize)]
struct FormRow<'s> {
    formula: &'s str,
    form: &'s str,
    range: &'s str,
    bound: String,
    unit: &'s str,
    worst: String,
    class: &'static str,
    mark: &'static str,
    parameter: &'s str,
    at: String,
    holds: String,
    is_stable: bool,
}

#[derive(Serialize)]
struct Propagators<'s> {
    rows: Vec<PropagatorRow<'s>>,
    charts: Vec<ChartFigure<'s>>,
}

#[derive(Serialize)]
struct PropagatorRow<'s> {
    case: &'s str,
    method: &'s str,
    tolerance: String,
    error: String,
    error_unit: &'s str,
    cost: String,
    cost_unit: &'s str,
    lower: String,
    upper: String,
}

#[derive(Serialize)]
struct Extremes<'s> {
    passed: usize,
    broken_pixels: usize,
    rows: Vec<ExtremeRow<'s>>,
}

#[derive(Serialize)]
struct ExtremeRow<'s> {
    name: &'s str,
    expected: &'s str,
    drawn: &'s str,
    passed: bool,
}

/// The part as HTML.
///
/// # Errors
/// As [`html::page`].
pub(super) fn section(study: &StandaloneStudy, plots: &[Plot]) -> Result<String, PageError> {
    let charts = |wanted: &dyn Fn(&Plot) -> bool| -> Vec<_> {
        let plots = plots.iter().filter(|plot| wanted(plot));
        plots.map(Plot::figure).collect()
    };
    let propagators: Vec<_> = study
        .measurements
        .iter()
        .filter(|measurement| about(measurement) == ORBITS)
        .map(PropagatorRow::new)
        .collect();
    let values = Values {
        stability: (!study.stability.is_empty()).then(|| Stability {
            stable: study.stability.iter().filter(|row| row.is_stable).count(),
            kept: study
                .stability
                .iter()
                .filter(|row| row.is_stable && row.worst <= row.bound)
                .count(),
            rows: study.stability.iter().map(FormRow::new).collect(),
            charts: charts(&|plot| plot.about == METHODS),
        }),
        propagators: (!propagators.is_empty()).then(|| Propagators {
            rows: propagators,
            charts: charts(&|plot| plot.about == ORBITS && plot.name.ends_with("_cost")),
        }),
        extremes: (!study.extremes.is_empty()).then(|| Extremes {
            passed: study.extremes.iter().filter(|case| case.passed).count(),
            broken_pixels: study.extremes.iter().map(|case| case.nan_pixels).sum(),
            rows: study.extremes.iter().map(ExtremeRow::new).collect(),
        }),
    };
    html::page("standalone.html", include_str!("standalone.html"), &values)
}

impl<'s> FormRow<'s> {
    fn new(row: &'s StabilityRow) -> Self {
        let (class, mark) = match (row.worst <= row.bound, row.is_stable) {
            (true, _) => ("good", "✓"),
            (false, true) => ("bad", "✗"),
            (false, false) => ("spread", "breaks it"),
        };
        Self {
            formula: row.formula,
            form: row.form,
            range: row.range,
            bound: format!("{:.1e}", row.bound),
            unit: row.unit,
            worst: format!("{:.1e}", row.worst),
            class,
            mark,
            parameter: row.parameter,
            at: number(row.at),
            holds: match row.range_holds {
                Some((from, to)) => format!("{} to {}", number(from), number(to)),
                None => "nowhere".into(),
            },
            is_stable: row.is_stable,
        }
    }
}

impl<'s> PropagatorRow<'s> {
    fn new(measurement: &'s Measurement) -> Self {
        let cost = &measurement.cost;
        // A flight's time reads better in milliseconds.
        let (scale, cost_unit) = match measurement.cost_unit.as_str() {
            "ns/call" => (1e-6, "ms"),
            other => (1.0, other),
        };
        Self {
            case: &measurement.method,
            method: &measurement.variant,
            tolerance: format!("{:.0e}", measurement.value),
            error: format!("{:.1e}", measurement.error),
            error_unit: &measurement.error_unit,
            cost: number(scale * cost.median),
            cost_unit,
            lower: number(scale * cost.lower),
            upper: number(scale * cost.upper),
        }
    }
}

impl<'s> ExtremeRow<'s> {
    fn new(case: &'s CaseResult) -> Self {
        Self {
            name: case.name,
            expected: case.expected,
            drawn: &case.what_was_drawn,
            passed: case.passed,
        }
    }
}
