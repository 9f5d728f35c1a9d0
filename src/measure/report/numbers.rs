//! What is measured without pictures of a scene: formulas and numerical methods by error and cost, and views that nobody
//! would ask for.

use super::plots::{Plot, push};
use super::rows::number;
use super::words::escaped;
use super::{ReportError, Study};
use crate::EarthError;
use crate::gpu::GpuContext;
use crate::imagery::{EarthLayers, LayerImage};
use crate::measure::extreme::{self, Outcome};
use crate::measure::numeric::{Measurement, Method, StabilityRow, formulas, measure};
use crate::measure::orbits;
use crate::measure::{Chart, Point, Series, pareto_front};
use crate::play::{PlayError, Progress};
use std::fmt::Write;

/// What came of it.
#[derive(Clone, Debug, Default)]
pub struct Numbers {
    /// Every method at every value of its parameter.
    pub measurements: Vec<Measurement>,
    /// Every form of every formula against arbitrary precision.
    pub stability: Vec<StabilityRow>,
    /// The extreme views.
    pub extremes: Vec<Outcome>,
}

impl Numbers {
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
        let rows = self.measurements.iter().map(Measurement::csv_row);
        lines(Measurement::CSV_HEADER, rows)
    }

    /// The table of formulas.
    pub fn stability_csv(&self) -> String {
        lines(
            StabilityRow::CSV_HEADER,
            self.stability.iter().map(StabilityRow::csv_row),
        )
    }
}

fn lines(header: &str, rows: impl Iterator<Item = String>) -> String {
    std::iter::once(header.to_owned())
        .chain(rows)
        .map(|line| line + "\n")
        .collect()
}

/// The maps that the extreme cases are told for: one grey, nothing else.
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
        let words = over.title.clone();
        push(
            &mut plots,
            format!("method_{name}_range"),
            about,
            words,
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
                x_spread: Some((m.cost.lower, m.cost.upper)),
                on_front: is_on_front(m),
                ..Point::new(m.cost.median, m.error)
            }),
        );
        let words = format!("{}. Ringed: the Pareto front.", against.title);
        push(
            &mut plots,
            format!("method_{name}_cost"),
            about,
            words,
            false,
            &against,
        )?;
    }
    Ok(plots)
}

/// What charts of formulas are about, and those of propagators.
const METHODS: &str = "methods";
const ORBITS: &str = "orbits";

fn about(measurement: &Measurement) -> &'static str {
    match measurement.parameter == orbits::TOLERANCE {
        true => ORBITS,
        false => METHODS,
    }
}

/// A cost that changes by less than this factor over a sweep is the same.
const SAME_COST: f64 = 4.0;

/// What errors are held against costs. Where the parameter trades one for the other, every measurement; where it says only
/// how hard a case is, and costs are the same throughout, each variant's worst error.
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

/// The page's part about all this. Writing to a string does not fail.
pub(super) fn section(
    out: &mut String,
    study: &Study,
    plots: &[Plot],
    chart: fn(&mut String, &Plot),
) {
    let numbers = &study.numbers;
    if !numbers.stability.is_empty() {
        stability(out, &numbers.stability);
        out.push_str("<details><summary>Error of each form over its range, and against its cost</summary>\n<div class=\"charts\">\n");
        plots
            .iter()
            .filter(|plot| plot.about == METHODS)
            .for_each(|plot| chart(out, plot));
        out.push_str("</div></details>\n<p>Tables: <a href=\"methods.csv\">methods.csv</a>, <a href=\"stability.csv\">stability.csv</a>.</p>\n");
    }
    let propagators = |m: &&Measurement| about(m) == ORBITS;
    let propagators: Vec<_> = numbers.measurements.iter().filter(propagators).collect();
    if !propagators.is_empty() {
        orbits_section(out, &propagators);
        out.push_str("<div class=\"charts\">\n");
        plots
            .iter()
            .filter(|plot| plot.about == ORBITS && plot.name.ends_with("_cost"))
            .for_each(|plot| chart(out, plot));
        out.push_str("</div>\n<p>Table: <a href=\"methods.csv\">methods.csv</a>. Error over the tolerance: <code>plots/</code>.</p>\n");
    }
    if !numbers.extremes.is_empty() {
        extremes(out, &numbers.extremes);
    }
}

fn stability(out: &mut String, rows: &[StabilityRow]) {
    let kept = rows
        .iter()
        .filter(|row| row.is_stable && row.worst <= row.bound);
    let stable = rows.iter().filter(|row| row.is_stable).count();
    let _ = writeln!(
        out,
        "<h2>Formulas against arbitrary precision</h2>\n<p>{} of {stable} forms that the product uses keep their bound over \
         the whole range that they are needed in. The other forms are there to be compared with.</p>\n<details><summary>All \
         forms</summary>\n<div class=\"scroll\"><table>\n<tr><th>formula</th><th>form</th><th>range</th><th>bound</th>\
         <th>worst</th><th>there</th><th>holds</th></tr>",
        kept.count()
    );
    for row in rows {
        let (class, mark) = match (row.worst <= row.bound, row.is_stable) {
            (true, _) => ("good", "✓"),
            (false, true) => ("bad", "✗"),
            (false, false) => ("spread", "breaks it"),
        };
        let holds = match row.range_holds {
            Some((from, to)) => format!("{} to {}", number(from), number(to)),
            None => "nowhere".into(),
        };
        let _ = writeln!(
            out,
            "<tr{}><td class=\"text\">{}</td><td class=\"text\">{}</td><td class=\"text\">{}</td><td>{:.1e} {}</td>\
             <td><span class=\"{class}\">{:.1e} {mark}</span></td><td>{} = {}</td><td class=\"text\">{holds}</td></tr>",
            if row.is_stable { " class=\"here\"" } else { "" },
            escaped(row.formula),
            escaped(row.form),
            escaped(row.range),
            row.bound,
            escaped(row.unit),
            row.worst,
            escaped(row.parameter),
            number(row.at),
        );
    }
    out.push_str("</table></div></details>\n");
}

/// Every propagator with every tolerance: the charts of error against run time stand below it.
fn orbits_section(out: &mut String, measurements: &[&Measurement]) {
    out.push_str(
        "<h2>Propagators: error against run time</h2>\n<p>From a state to 24 places of a span: by a conic, by DOP853 (explicit) \
         and by Radau IIA (implicit), each point one tolerance. Error: the largest distance from extrapolation in 32 digits. \
         Ringed: the Pareto front, what is beaten in both by none. A sphere of one gram that falls through the air is stiff: \
         there the explicit method pays with evaluations of the force for stability, and error is the instant of the \
         impact.</p>\n<details><summary>All numbers</summary>\n<div class=\"scroll\"><table>\n<tr><th>case</th>\
         <th>method</th><th>tolerance</th><th>error</th><th>cost</th><th>quartiles</th></tr>\n",
    );
    for m in measurements {
        // A flight's time is told in milliseconds.
        let (scale, unit) = match m.cost_unit.as_str() {
            "ns/call" => (1e-6, "ms"),
            other => (1.0, other),
        };
        let _ = writeln!(
            out,
            "<tr><td class=\"text\">{}</td><td class=\"text\">{}</td><td>{:.0e}</td><td>{:.1e} {}</td><td>{} {}</td>\
             <td>{} to {}</td></tr>",
            escaped(&m.method),
            escaped(&m.variant),
            m.value,
            m.error,
            escaped(&m.error_unit),
            number(scale * m.cost.median),
            escaped(unit),
            number(scale * m.cost.lower),
            number(scale * m.cost.upper),
        );
    }
    out.push_str("</table></div></details>\n");
}

fn extremes(out: &mut String, outcomes: &[Outcome]) {
    let passed = outcomes.iter().filter(|outcome| outcome.passed).count();
    let broken: usize = outcomes.iter().map(|outcome| outcome.nan_pixels).sum();
    let _ = writeln!(
        out,
        "<h2>Views that nobody would ask for</h2>\n<p>{passed} of {} show what they must, {broken} pixels are no \
         numbers.</p>\n<details><summary>All views</summary>\n<div class=\"scroll\"><table>\n<tr><th>view</th><th>expected</th>\
         <th>drawn</th><th></th></tr>",
        outcomes.len()
    );
    for outcome in outcomes {
        let (class, mark) = match outcome.passed {
            true => ("good", "✓"),
            false => ("bad", "✗"),
        };
        let _ = writeln!(
            out,
            "<tr><td class=\"text\">{}</td><td class=\"text\">{}</td><td class=\"text\">{}</td><td><span \
             class=\"{class}\">{mark}</span></td></tr>",
            escaped(outcome.name),
            escaped(outcome.expected),
            escaped(&outcome.what_was_drawn),
        );
    }
    out.push_str("</table></div></details>\n");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::numeric::Quartiles;

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
    fn a_trade_is_told_from_a_hard_case() {
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
        let mut numbers = Numbers {
            measurements: measure(fall.as_ref(), 1),
            ..Numbers::default()
        };
        numbers.measurements.extend([
            measurement("a", 1.0, 1e-3, 100.0),
            measurement("b", 1.0, 1e-6, 400.0),
        ]);
        let csv = numbers.methods_csv();
        assert!(
            csv.contains(
                "\na sphere of one gram falls from 120 km,Radau IIA,relative_tolerance,1e-6,"
            ),
            "{csv}"
        );
        let plots = method_plots(&numbers.measurements).expect("draws");
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
        let mut page = String::new();
        let rows: Vec<_> = numbers
            .measurements
            .iter()
            .filter(|m| about_is_orbits(m))
            .collect();
        orbits_section(&mut page, &rows);
        assert!(
            page.contains("error against run time") && page.matches("<tr>").count() == 4,
            "{page}"
        );
    }

    fn about_is_orbits(measurement: &Measurement) -> bool {
        about(measurement) == ORBITS
    }
}
