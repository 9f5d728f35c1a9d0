//! Formulas of which several forms are known, compared with the oracle over a range.

use super::method::{Method, Sweep, Work};
use super::oracle::Real;

type ErrorOf<I, O> = dyn Fn(&I, &O) -> f64;

/// Measure of a result's error.
pub struct ErrorMeasure<I, O = f64> {
    unit: &'static str,
    error: Box<ErrorOf<I, O>>,
}

impl<I: 'static> ErrorMeasure<I> {
    /// |value − exact|/|exact|.
    pub fn relative(exact: fn(&I) -> Real) -> Self {
        Self::by("relative", move |input, value| {
            exact(input).relative_error(*value)
        })
    }

    /// |value − exact|.
    pub fn absolute(unit: &'static str, exact: fn(&I) -> Real) -> Self {
        Self::by(unit, move |input, value| {
            exact(input).absolute_error(*value)
        })
    }
}

impl<I, O> ErrorMeasure<I, O> {
    /// By a function that computes the error from input and result.
    pub fn by(unit: &'static str, error: impl Fn(&I, &O) -> f64 + 'static) -> Self {
        Self {
            unit,
            error: Box::new(error),
        }
    }
}

/// One way to write a formula.
pub struct Form<I, O = f64> {
    /// Its name: `as printed: L − R²/L`.
    pub name: &'static str,
    /// The largest error that it must keep over the whole range; `None` for a form that is there to be compared with.
    pub bound: Option<f64>,
    /// The formula.
    pub value: fn(&I) -> O,
}

/// A formula in several forms, its required range, and its exact result.
///
/// `I` is the input of a form, to the bit: the oracle starts from the same floats. `O` is its result.
pub struct Formula<I, O = f64> {
    /// Name of the computed quantity.
    pub name: &'static str,
    /// The range, as text.
    pub range: &'static str,
    /// Name of the swept parameter, with its unit.
    pub parameter: &'static str,
    pub values: Vec<f64>,
    /// The inputs for a value. The error at the value is the largest of theirs.
    pub inputs: fn(f64) -> Vec<I>,
    pub error_measure: ErrorMeasure<I, O>,
    /// The forms; the first is the printed or obvious one.
    pub forms: Vec<Form<I, O>>,
}

/// Accuracy of one form of a formula compared with the oracle.
#[derive(Clone, Debug, PartialEq)]
pub struct StabilityRow {
    pub formula: &'static str,
    /// The form: `as printed: …` or `stable: …`.
    pub form: &'static str,
    /// The range, as text.
    pub range: &'static str,
    /// Name of the parameter, with its unit.
    pub parameter: &'static str,
    /// The longest run of swept values over which the bound is kept: first and last; `None` if it is kept nowhere.
    pub range_holds: Option<(f64, f64)>,
    /// The bound that the stable form keeps over the whole range. All forms are compared with it.
    pub bound: f64,
    /// Whether this form must meet the bound.
    pub is_stable: bool,
    /// Unit of bound and error.
    pub unit: &'static str,
    /// Worst error in the range; infinite where the form gives no number.
    pub worst: f64,
    /// The parameter there.
    pub at: f64,
}

impl StabilityRow {
    /// Columns of a table of rows.
    pub const CSV_COLUMNS: [&'static str; 11] = [
        "formula",
        "form",
        "range",
        "parameter",
        "holds_from",
        "holds_to",
        "bound",
        "stable",
        "worst",
        "at",
        "unit",
    ];

    /// Its line of the table.
    pub fn csv_fields(&self) -> [String; Self::CSV_COLUMNS.len()] {
        let (from, to) = match self.range_holds {
            Some((from, to)) => (format!("{from:e}"), format!("{to:e}")),
            None => (String::new(), String::new()),
        };
        [
            self.formula.to_owned(),
            self.form.to_owned(),
            self.range.to_owned(),
            self.parameter.to_owned(),
            from,
            to,
            format!("{:e}", self.bound),
            self.is_stable.to_string(),
            format!("{:e}", self.worst),
            format!("{:e}", self.at),
            self.unit.to_owned(),
        ]
    }

    /// One line of plain text.
    pub fn text(&self) -> String {
        let holds = match self.range_holds {
            Some((from, to)) => format!("holds {from:.3e} to {to:.3e}"),
            None => "holds nowhere".into(),
        };
        format!(
            "{}, {}: {holds} of {}; worst {:.2e} at {} = {:.3e}, bound {:.1e} ({})",
            self.formula,
            self.form,
            self.range,
            self.worst,
            self.parameter,
            self.at,
            self.bound,
            self.unit
        )
    }
}

/// A formula whose input type does not matter.
pub trait AnyFormula: Method {
    /// One row for each form.
    fn rows(&self) -> Vec<StabilityRow>;
}

/// The worst of errors, what is not a number counted as infinite.
fn worst_of(errors: impl Iterator<Item = f64>) -> f64 {
    errors
        .map(|e| if e.is_nan() { f64::INFINITY } else { e })
        .fold(0.0, f64::max)
}

impl<I, O> Formula<I, O> {
    fn error_of(&self, form: &Form<I, O>, at: f64) -> f64 {
        let inputs = (self.inputs)(at);
        worst_of(
            inputs
                .iter()
                .map(|input| (self.error_measure.error)(input, &(form.value)(input))),
        )
    }
}

impl<I, O> AnyFormula for Formula<I, O> {
    fn rows(&self) -> Vec<StabilityRow> {
        let bound = self
            .forms
            .iter()
            .find_map(|form| form.bound)
            .unwrap_or(f64::INFINITY);
        self.forms
            .iter()
            .map(|form| {
                let bound = form.bound.unwrap_or(bound);
                let errors: Vec<_> = self
                    .values
                    .iter()
                    .map(|at| (*at, self.error_of(form, *at)))
                    .collect();
                let (at, worst) = errors
                    .iter()
                    .copied()
                    .max_by(|a, b| a.1.total_cmp(&b.1))
                    .unwrap_or((f64::NAN, f64::NAN));
                StabilityRow {
                    formula: self.name,
                    form: form.name,
                    range: self.range,
                    parameter: self.parameter,
                    range_holds: longest_run(&errors, bound),
                    bound,
                    is_stable: form.bound.is_some(),
                    unit: self.error_measure.unit,
                    worst,
                    at,
                }
            })
            .collect()
    }
}

/// First and last value of the longest run of errors within the bound.
fn longest_run(errors: &[(f64, f64)], bound: f64) -> Option<(f64, f64)> {
    errors
        .split(|(_, error)| *error > bound)
        .max_by_key(|run| run.len())
        .and_then(|run| Some((run.first()?.0, run.last()?.0)))
}

/// Calls in one timed run.
const CALLS: usize = 512;

impl<I, O> Method for Formula<I, O> {
    fn name(&self) -> &str {
        self.name
    }

    fn error_unit(&self) -> &str {
        self.error_measure.unit
    }

    fn variants(&self) -> Vec<&str> {
        self.forms.iter().map(|form| form.name).collect()
    }

    fn sweep(&self) -> Sweep {
        Sweep {
            parameter: self.parameter,
            values: self.values.clone(),
        }
    }

    fn error(&self, variant: usize, at: f64) -> f64 {
        self.forms
            .get(variant)
            .map_or(f64::NAN, |form| self.error_of(form, at))
    }

    fn work(&self, variant: usize, at: f64) -> Work<'_> {
        let inputs = (self.inputs)(at);
        let Some(form) = self.forms.get(variant) else {
            return Work::Counted(f64::NAN);
        };
        let rounds = CALLS.div_ceil(inputs.len().max(1));
        Work::Timed {
            calls: (rounds * inputs.len()) as u32,
            run: Box::new(move || {
                for _ in 0..rounds {
                    for input in &inputs {
                        std::hint::black_box((form.value)(std::hint::black_box(input)));
                    }
                }
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// √(x + 1) − √x.
    fn difference_of_roots() -> Formula<f64> {
        Formula {
            name: "difference of roots",
            range: "1 to 1e16",
            parameter: "x",
            values: (0..=16).map(|k| 10f64.powi(k)).collect(),
            inputs: |x| vec![x],
            error_measure: ErrorMeasure::relative(|x| {
                let x = Real::from(*x);
                (&x + Real::from(1.0)).sqrt() - x.sqrt()
            }),
            forms: vec![
                Form {
                    name: "as printed",
                    bound: None,
                    value: |x| (x + 1.0).sqrt() - x.sqrt(),
                },
                Form {
                    name: "stable",
                    bound: Some(4e-16),
                    value: |x| 1.0 / ((x + 1.0).sqrt() + x.sqrt()),
                },
            ],
        }
    }

    #[test]
    fn a_cancelling_form_is_distinguished_from_a_stable_one() {
        let rows = difference_of_roots().rows();
        let [printed, stable] = rows.as_slice() else {
            panic!("two forms")
        };
        assert!(!printed.is_stable && printed.worst == 1.0 && printed.at == 1e16);
        let (from, to) = printed.range_holds.expect("good near 1");
        assert!(from <= 10.0 && to <= 100.0, "{from} {to}");
        assert!(stable.is_stable && stable.worst <= 4e-16);
        assert_eq!(stable.range_holds, Some((1.0, 1e16)));
        assert!(printed.text().contains("worst 1.00e0 at x = 1.000e16"));
        assert_eq!(printed.csv_fields()[8..10], ["1e0", "1e16"]);
    }

    #[test]
    fn what_is_not_a_number_is_the_worst_error() {
        let mut formula = difference_of_roots();
        formula.forms[0].value = |x| {
            if *x > 5.0 {
                f64::NAN
            } else {
                0.414_213_562_373_095_1
            }
        };
        let row = &formula.rows()[0];
        assert_eq!(
            (row.worst, row.range_holds),
            (f64::INFINITY, Some((1.0, 1.0)))
        );
    }

    #[test]
    fn a_formula_is_a_method() {
        let formula = difference_of_roots();
        let found = super::super::measure(&formula, 2);
        assert_eq!(found.len(), 34);
        assert!(
            found
                .iter()
                .all(|m| m.cost.median > 0.0 && m.cost.median < 1e6)
        );
        assert_eq!(found[32].error, 1.0);
    }
}
