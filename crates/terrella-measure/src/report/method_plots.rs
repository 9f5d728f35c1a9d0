//! Charts of formulas and numerical methods: error over the range, and error against cost.

use super::ReportError;
use super::plots::{Plot, push};
use crate::numeric::Measurement;
use crate::orbits;
use crate::{Chart, Point, Series, pareto_front};

/// Charts of methods: error against the parameter, and against cost with the Pareto front.
///
/// # Errors
/// The drawing library's.
pub fn method_plots(measurements: &[Measurement]) -> Result<Vec<Plot>, ReportError> {
    let mut plots = Vec::new();
    let mut methods: Vec<&str> = measurements.iter().map(|m| m.method.as_str()).collect();
    methods.dedup();
    for method in methods {
        let of_it: Vec<_> = measurements.iter().filter(|m| m.method == method).collect();
        let Some(first) = of_it.first() else { continue };
        let name: String = method
            .chars()
            .map(|c| if c.is_alphanumeric() { c } else { '_' })
            .collect();
        let about = about(first);
        let chart = |title: String, x_name: String, series: Vec<Series>| Chart {
            title,
            x_name,
            y_name: format!("error, {}", first.error_unit),
            x_log: true,
            y_log: true,
            series,
        };
        let over = chart(
            format!("{method}: error over the range"),
            first.parameter.replace('_', " "),
            variants(&of_it, true, |m| Point::new(m.value.abs(), m.error)),
        );
        let alt_text = over.title.clone();
        push(
            &mut plots,
            format!("method_{name}_range"),
            about,
            alt_text,
            about == METHODS,
            &over,
        )?;
        let costs = costs(&of_it);
        let points: Vec<_> = costs.iter().map(|c| (c.cost.median, c.error)).collect();
        let front = pareto_front(&points);
        let is_on_front = |m: &Measurement| {
            let place = costs.iter().position(|other| std::ptr::eq(other, m));
            place.is_some_and(|place| front[place])
        };
        let against = chart(
            format!("{method}: error against cost"),
            first.cost_unit.clone(),
            variants(&costs.iter().collect::<Vec<_>>(), false, |m| Point {
                x_error_bar: Some((m.cost.lower, m.cost.upper)),
                on_front: is_on_front(m),
                ..Point::new(m.cost.median, m.error)
            }),
        );
        let alt_text = format!("{}. Ringed: the Pareto front.", against.title);
        push(
            &mut plots,
            format!("method_{name}_cost"),
            about,
            alt_text,
            false,
            &against,
        )?;
    }
    Ok(plots)
}

/// Subject of the charts of formulas, and of those of propagators.
pub(super) const METHODS: &str = "methods";
pub(super) const ORBITS: &str = "orbits";

/// Subject of a measurement's charts.
pub(super) fn about(measurement: &Measurement) -> &'static str {
    match measurement.parameter == orbits::TOLERANCE {
        true => ORBITS,
        false => METHODS,
    }
}

/// A cost that changes by less than this factor over a sweep is the same.
const SAME_COST: f64 = 4.0;

/// Data for charts of error against cost. If the parameter trades one for the other, every measurement; if it only sets the difficulty of the case,
/// at constant cost, each variant's largest error.
fn costs(measurements: &[&Measurement]) -> Vec<Measurement> {
    let mut worst: Vec<Measurement> = Vec::new();
    let mut is_trade = false;
    for measurement in measurements {
        let known = worst.iter_mut().find(|w| w.variant == measurement.variant);
        let Some(known) = known else {
            worst.push((*measurement).clone());
            continue;
        };
        let (cost, other) = (measurement.cost.median, known.cost.median);
        is_trade |= cost.max(other) > SAME_COST * cost.min(other);
        if measurement.error > known.error || measurement.error.is_nan() {
            *known = (*measurement).clone();
        }
    }
    match is_trade {
        true => measurements.iter().map(|m| (*m).clone()).collect(),
        false => worst,
    }
}

/// One series for each variant.
fn variants(
    measurements: &[&Measurement],
    joined: bool,
    point: impl Fn(&Measurement) -> Point,
) -> Vec<Series> {
    let mut names: Vec<&str> = Vec::new();
    for measurement in measurements {
        if !names.contains(&measurement.variant.as_str()) {
            names.push(&measurement.variant);
        }
    }
    let series = names.into_iter().map(|name| {
        let of_it = measurements.iter().filter(|m| m.variant == name);
        Series {
            name: name.split(':').next().unwrap_or_default().to_owned(),
            points: of_it.map(|m| point(m)).collect(),
            joined,
        }
    });
    series.collect()
}

#[cfg(test)]
mod tests {
    use super::super::{StandaloneStudy, page_standalone};
    use super::*;
    use crate::Quartiles;
    use crate::numeric::measure;

    fn measurement(variant: &str, value: f64, error: f64, cost: f64) -> Measurement {
        Measurement {
            method: "m: n".into(),
            variant: variant.into(),
            parameter: "step_s",
            value,
            error,
            error_unit: "m".into(),
            cost: Quartiles {
                lower: 0.9 * cost,
                median: cost,
                upper: 1.1 * cost,
            },
            cost_unit: "calls".into(),
        }
    }

    #[test]
    fn a_trade_is_distinguished_from_a_hard_case() {
        let trade = [
            measurement("a", 1.0, 1e-3, 100.0),
            measurement("a", 10.0, 1e-1, 10.0),
            measurement("b", 1.0, 1e-6, 400.0),
        ];
        let hard = [
            measurement("a", 1.0, 1e-3, 10.0),
            measurement("a", 10.0, 1e-1, 12.0),
            measurement("b", 1.0, 1e-6, 11.0),
        ];
        let of = |all: &[Measurement]| costs(&all.iter().collect::<Vec<_>>()).len();
        assert_eq!((of(&trade), of(&hard)), (3, 2));
        let worst = costs(&hard.iter().collect::<Vec<_>>());
        assert_eq!((worst[0].error, worst[1].error), (1e-1, 1e-6));
        let plots = method_plots(&trade).expect("draws");
        let names: Vec<_> = plots.iter().map(|plot| plot.name.as_str()).collect();
        assert_eq!(names, ["method_m__n_range", "method_m__n_cost"]);
        assert!(plots[1].svg.contains("calls"));
        assert!(plots.iter().all(|plot| plot.about == METHODS));
    }

    #[test]
    fn propagators_stand_in_the_table_and_on_charts_of_their_own() {
        let fall = orbits::for_report(true).pop().expect("the stiff fall");
        let mut study = StandaloneStudy {
            measurements: measure(fall.as_ref(), 1),
            ..StandaloneStudy::default()
        };
        study.measurements.extend([
            measurement("a", 1.0, 1e-3, 100.0),
            measurement("b", 1.0, 1e-6, 400.0),
        ]);
        let csv = study.methods_csv();
        assert!(
            csv.contains(
                "\na sphere of one gram falls from 120 km,Radau IIA,relative_tolerance,1e-6,"
            ),
            "{csv}"
        );
        let plots = method_plots(&study.measurements).expect("draws");
        let about: Vec<_> = plots
            .iter()
            .map(|plot| (plot.about, plot.is_main))
            .collect();
        assert_eq!(
            about,
            [
                (ORBITS, false),
                (ORBITS, false),
                (METHODS, true),
                (METHODS, false)
            ]
        );
        let page = page_standalone::section(&study, &plots).expect("a good template");
        assert!(
            page.contains("error against run time") && page.matches("<tr>").count() == 4,
            "{page}"
        );
    }
}
