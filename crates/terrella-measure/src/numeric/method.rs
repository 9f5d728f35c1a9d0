//! Methods compared by error and cost.

use crate::Quartiles;
use std::time::Instant;

/// The parameter that a method is swept over.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Its name with its unit: `height_m`.
    pub parameter: &'static str,
    /// Its values, in order.
    pub values: Vec<f64>,
}

/// A family of numerical methods, with a parameter that trades error for cost or sets the difficulty of the case.
pub trait Method {
    /// Name of the problem.
    fn name(&self) -> &str;

    /// Unit of [`Self::error`]: `relative`, `m`, `px`.
    fn error_unit(&self) -> &str;

    /// Unit of the cost. Anything but the default goes with [`Work::Counted`].
    fn cost_unit(&self) -> &str {
        "ns/call"
    }

    /// The ways to compute it.
    fn variants(&self) -> Vec<&str>;

    /// The swept parameter.
    fn sweep(&self) -> Sweep;

    /// Error of a variant at a value of the parameter. Infinite or NaN if the variant's result is.
    ///
    /// An expensive reference is computed once and cached by the method, for example in a `OnceCell`.
    fn error(&self, variant: usize, at: f64) -> f64;

    /// Cost of a variant at a value of the parameter.
    fn work(&self, variant: usize, at: f64) -> Work<'_>;
}

/// Cost of one variant at one value.
pub enum Work<'m> {
    Timed {
        /// How many calls one run makes: the time is divided by it. Enough of them to fill some 10 µs.
        calls: u32,
        /// Makes them, their results in [`std::hint::black_box`].
        run: Box<dyn FnMut() + 'm>,
    },
    /// A cost that does not vary, such as evaluations of a force, in [`Method::cost_unit`].
    Counted(f64),
}

/// One variant at one value of the parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// [`Method::name`].
    pub method: String,
    pub variant: String,
    /// Name of the parameter, with its unit.
    pub parameter: &'static str,
    /// Value of the parameter.
    pub value: f64,
    pub error: f64,
    pub error_unit: String,
    pub cost: Quartiles,
    pub cost_unit: String,
}

impl Measurement {
    /// Columns of a table of measurements.
    pub const CSV_COLUMNS: [&'static str; 10] = [
        "method",
        "variant",
        "parameter",
        "value",
        "error",
        "error_unit",
        "cost_median",
        "cost_lower_quartile",
        "cost_upper_quartile",
        "cost_unit",
    ];

    /// Its line of the table.
    pub fn csv_fields(&self) -> [String; Self::CSV_COLUMNS.len()] {
        [
            self.method.clone(),
            self.variant.clone(),
            self.parameter.to_owned(),
            format!("{:e}", self.value),
            format!("{:e}", self.error),
            self.error_unit.clone(),
            format!("{:.3}", self.cost.median),
            format!("{:.3}", self.cost.lower),
            format!("{:.3}", self.cost.upper),
            self.cost_unit.clone(),
        ]
    }
}

/// Measures every variant at every value, each cost `repeats` times after one discarded run.
///
/// At one value the variants are interleaved, so that variations of the machine's speed affect all of them.
pub fn measure(method: &dyn Method, repeats: u32) -> Vec<Measurement> {
    let sweep = method.sweep();
    let variants = method.variants();
    let mut out = Vec::with_capacity(sweep.values.len() * variants.len());
    for &value in &sweep.values {
        let mut works: Vec<_> = (0..variants.len())
            .map(|variant| (method.work(variant, value), Vec::new()))
            .collect();
        for round in 0..=repeats {
            for (work, costs) in &mut works {
                let cost = match work {
                    Work::Counted(cost) => *cost,
                    Work::Timed { calls, run } => {
                        let start = Instant::now();
                        run();
                        start.elapsed().as_nanos() as f64 / f64::from((*calls).max(1))
                    }
                };
                if round > 0 {
                    costs.push(cost);
                }
            }
        }
        for (index, (variant, (_, costs))) in variants.iter().zip(works).enumerate() {
            out.push(Measurement {
                method: method.name().to_owned(),
                variant: (*variant).to_owned(),
                parameter: sweep.parameter,
                value,
                error: method.error(index, value),
                error_unit: method.error_unit().to_owned(),
                cost: Quartiles::of(costs),
                cost_unit: method.cost_unit().to_owned(),
            });
        }
    }
    out
}

/// `per_decade` values a decade from `first` to `last`, both included, evenly spaced in the logarithm; both above 0.
pub fn log_spaced(first: f64, last: f64, per_decade: u32) -> Vec<f64> {
    let decades = (last / first).log10();
    let steps = (decades * f64::from(per_decade)).round().max(1.0);
    let mut values: Vec<_> = (0..=steps as u32)
        .map(|k| first * 10f64.powf(decades * f64::from(k) / steps))
        .collect();
    if let Some(end) = values.last_mut() {
        *end = last;
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::csv_text;
    use std::cell::Cell;

    /// Sums of 1/k², which fall short of π²/6 by 1/n: backwards, and counted.
    struct Basel {
        runs: Cell<u32>,
    }

    impl Method for Basel {
        fn name(&self) -> &str {
            "sum, of squares"
        }
        fn error_unit(&self) -> &str {
            "relative"
        }
        fn variants(&self) -> Vec<&str> {
            vec!["timed", "counted"]
        }
        fn sweep(&self) -> Sweep {
            Sweep {
                parameter: "terms",
                values: vec![10.0, 100.0],
            }
        }
        fn error(&self, _: usize, at: f64) -> f64 {
            let sum: f64 = (1..=at as u32).map(|k| f64::from(k).powi(-2)).sum();
            1.0 - sum * 6.0 / std::f64::consts::PI.powi(2)
        }
        fn work(&self, variant: usize, at: f64) -> Work<'_> {
            match variant {
                0 => Work::Timed {
                    calls: 4,
                    run: Box::new(|| {
                        self.runs.set(self.runs.get() + 1);
                        std::thread::sleep(std::time::Duration::from_micros(400));
                    }),
                },
                _ => Work::Counted(at),
            }
        }
    }

    #[test]
    fn every_variant_is_measured_at_every_value() {
        let method = Basel { runs: Cell::new(0) };
        let found = measure(&method, 3);
        assert_eq!(found.len(), 4);
        // One run is thrown away for each value.
        assert_eq!(method.runs.get(), 8);
        // 400 µs and more, by four calls.
        assert!(found[0].cost.lower >= 1e5 && found[0].cost.upper < 1e8);
        assert!(found[0].cost.lower <= found[0].cost.median);
        assert_eq!(found[3].cost.median, 100.0);
        assert!((found[1].error - 0.0578).abs() < 1e-4, "{}", found[1].error);
        assert!(found[2].error < 0.2 * found[0].error);
        let line = csv_text([found[1].csv_fields()]);
        assert!(line.starts_with("\"sum, of squares\",counted,terms,1e1,"));
    }

    #[test]
    fn spacing_is_even_in_the_logarithm_and_keeps_both_ends() {
        let values = log_spaced(1e-3, 1e12, 2);
        assert_eq!((values.len(), values[0], values[30]), (31, 1e-3, 1e12));
        assert!((values[6] - 1.0).abs() < 1e-12);
    }
}
