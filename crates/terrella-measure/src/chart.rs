//! Charts of measurements as SVG: linear or logarithmic axes, error bars, the Pareto front ringed.

use super::axis::Axis;
use plotters::coord::ranged1d::Ranged;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::fmt::Debug;

/// A value on a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Across.
    pub x: f64,
    /// Up.
    pub y: f64,
    /// Ends of the error bar across, if it has any.
    pub x_error_bar: Option<(f64, f64)>,
    /// A short text beside it; empty for none.
    pub label: String,
    /// Whether it is on the Pareto front.
    pub on_front: bool,
}

impl Point {
    /// A bare point.
    pub fn new(x: f64, y: f64) -> Self {
        Self {
            x,
            y,
            x_error_bar: None,
            label: String::new(),
            on_front: false,
        }
    }
}

/// Points of one colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// As in the legend.
    pub name: String,
    /// The points, in the order in which they are joined.
    pub points: Vec<Point>,
    /// Whether a line connects them.
    pub joined: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Above it.
    pub title: String,
    /// Name and unit of the horizontal axis.
    pub x_name: String,
    /// Name and unit of the vertical axis.
    pub y_name: String,
    /// Whether the horizontal axis is logarithmic.
    pub x_log: bool,
    /// Whether the vertical axis is logarithmic.
    pub y_log: bool,
    /// Data series.
    pub series: Vec<Series>,
}

/// A chart could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum ChartError {
    /// No point has finite values (above zero on logarithmic axes).
    #[error("the chart \"{0}\" has nothing to show")]
    Empty(String),
    /// The drawing library rejected.
    #[error("the chart \"{title}\" cannot be drawn: {cause}")]
    Drawing {
        title: String,
        /// Error message of the library.
        cause: String,
    },
}

/// Width and height, SVG pixels.
const SIZE: (u32, u32) = (840, 520);
/// Width of the legend, of [`SIZE`].
const LEGEND_PX: u32 = 150;
/// Drawing area of the legend.
type LegendArea<'t> = DrawingArea<SVGBackend<'t>, plotters::coord::Shift>;
/// Colours that are distinct for people with red-green colour blindness (Okabe and Ito 2008).
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

impl Chart {
    /// The chart as an SVG document. Points that an axis cannot show (not finite; zero or less on a logarithmic one)
    /// are left out.
    ///
    /// # Errors
    /// No point left.
    pub fn to_svg(&self) -> Result<String, ChartError> {
        let ends = |p: &Point| match p.x_error_bar {
            Some((low, high)) if low.is_finite() && high.is_finite() => [p.x, low, high],
            _ => [p.x; 3],
        };
        let x = Axis::new(self.range(self.x_log, ends)?, self.x_log);
        let y = Axis::new(self.range(self.y_log, |p| [p.y; 3])?, self.y_log);
        let mut text = String::new();
        self.draw(&mut text, x, y)
            .map_err(|cause| ChartError::Drawing {
                title: self.title.clone(),
                cause,
            })?;
        Ok(text)
    }

    fn can_show(&self, point: &Point) -> bool {
        let fits = |value: f64, log: bool| value.is_finite() && (!log || value > 0.0);
        fits(point.x, self.x_log) && fits(point.y, self.y_log)
    }

    /// From below the smallest to above the largest value.
    fn range(
        &self,
        log: bool,
        of: impl Fn(&Point) -> [f64; 3],
    ) -> Result<std::ops::Range<f64>, ChartError> {
        let points = self.series.iter().flat_map(|series| &series.points);
        let values = points.filter(|point| self.can_show(point)).flat_map(of);
        let values = values.filter(|value| !log || *value > 0.0);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        if low > high {
            return Err(ChartError::Empty(self.title.clone()));
        }
        Ok(if log {
            low / 1.6..high * 1.6
        } else {
            let margin = 0.08 * (high - low).max(0.1 * high.abs()).max(1e-12);
            low - margin..high + margin
        })
    }

    fn draw(&self, text: &mut String, x: Axis, y: Axis) -> Result<(), String> {
        let whole = SVGBackend::with_string(text, SIZE).into_drawing_area();
        whole.fill(&WHITE).map_err(error_text)?;
        // The legend is beside the chart, where it covers nothing.
        let (root, legend) = match self.series.len() {
            0 | 1 => (whole.clone(), None),
            _ => {
                let (root, legend) = whole.split_horizontally(SIZE.0 - LEGEND_PX);
                (root, Some(legend))
            }
        };
        let mut chart = ChartBuilder::on(&root)
            .caption(&self.title, ("sans-serif", 20))
            .margin(14)
            .x_label_area_size(46)
            .y_label_area_size(72)
            .build_cartesian_2d(x.clone(), y)
            .map_err(error_text)?;
        chart
            .configure_mesh()
            .x_desc(&self.x_name)
            .y_desc(&self.y_name)
            .x_labels(8)
            .y_labels(8)
            .x_label_formatter(&|value| short(*value))
            .y_label_formatter(&|value| short(*value))
            .label_style(("sans-serif", 14))
            .axis_desc_style(("sans-serif", 15))
            .light_line_style(RGBColor(240, 240, 240))
            .bold_line_style(RGBColor(215, 215, 215))
            .draw()
            .map_err(error_text)?;
        for (n, series) in self.series.iter().enumerate() {
            let color = COLORS[n % COLORS.len()];
            let points: Vec<_> = series.points.iter().filter(|p| self.can_show(p)).collect();
            if series.joined {
                let line = points.iter().map(|p| (p.x, p.y));
                chart
                    .draw_series(LineSeries::new(line, color.stroke_width(2)))
                    .map_err(error_text)?;
            }
            let error_bars = points.iter().filter_map(|p| {
                let (low, high) = p.x_error_bar?;
                let shown = low.is_finite() && high.is_finite() && (!self.x_log || low > 0.0);
                shown.then(|| PathElement::new([(low, p.y), (high, p.y)], color.mix(0.6)))
            });
            chart.draw_series(error_bars).map_err(error_text)?;
            let rings = points.iter().filter(|p| p.on_front);
            chart
                .draw_series(rings.map(|p| Circle::new((p.x, p.y), 7, color.stroke_width(2))))
                .map_err(error_text)?;
            let labels = points.iter().filter(|p| !p.label.is_empty());
            chart
                .draw_series(labels.map(|p| {
                    // Text beside a point at the right edge is placed on its left.
                    let (side, offset) = match x.map(&p.x, (0, 100)) > 80 {
                        true => (HPos::Right, -7),
                        false => (HPos::Left, 7),
                    };
                    let style = ("sans-serif", 12).into_font().color(&color);
                    let style = style.pos(Pos::new(side, VPos::Top));
                    EmptyElement::at((p.x, p.y)) + Text::new(p.label.clone(), (offset, -13), style)
                }))
                .map_err(error_text)?;
            if n < COLORS.len() {
                let marks = points.iter();
                let marks = marks.map(|p| Circle::new((p.x, p.y), 4, color.filled()));
                chart.draw_series(marks).map_err(error_text)?;
            } else {
                // Colours repeat: different markers distinguish the series.
                let marks = points.iter();
                let marks = marks.map(|p| TriangleMarker::new((p.x, p.y), 6, color.filled()));
                chart.draw_series(marks).map_err(error_text)?;
            }
        }
        if let Some(legend) = legend {
            self.draw_legend(&legend)?;
        }
        whole.present().map_err(error_text)
    }

    fn draw_legend(&self, area: &LegendArea<'_>) -> Result<(), String> {
        for ((n, series), row) in self.series.iter().enumerate().zip(0..) {
            let color = COLORS[n % COLORS.len()];
            let at = (8, 64 + 22 * row);
            if n < COLORS.len() {
                area.draw(&Circle::new(at, 4, color.filled()))
            } else {
                area.draw(&TriangleMarker::new(at, 6, color.filled()))
            }
            .map_err(error_text)?;
            let style = ("sans-serif", 13).into_font().color(&BLACK);
            let name = Text::new(series.name.clone(), (at.0 + 12, at.1 - 7), style);
            area.draw(&name).map_err(error_text)?;
        }
        Ok(())
    }
}

fn error_text(error: impl Debug) -> String {
    format!("{error:?}")
}

/// A number of few characters.
fn short(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        return format!("{value:.0e}");
    }
    let text = format!("{value:.3}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    text.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        let mut best = Point::new(10.0, 1e-3);
        best.on_front = true;
        best.label = "6 × 6 <best>".into();
        best.x_error_bar = Some((9.0, 12.0));
        Chart {
            title: "Error against time".into(),
            x_name: "frame, ms".into(),
            y_name: "RMSE".into(),
            x_log: true,
            y_log: true,
            series: vec![
                Series {
                    name: "subdivision".into(),
                    points: vec![Point::new(5.0, 1e-1), best, Point::new(40.0, 1e-5)],
                    joined: true,
                },
                Series {
                    name: "unseen".into(),
                    points: vec![Point::new(1.0, 0.0), Point::new(f64::NAN, 1.0)],
                    joined: false,
                },
            ],
        }
    }

    #[test]
    fn a_chart_shows_its_points_and_words() {
        for (x_log, y_log) in [(true, true), (true, false), (false, true), (false, false)] {
            let svg = Chart {
                x_log,
                y_log,
                ..chart()
            }
            .to_svg()
            .expect("draws");
            assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
            assert!(svg.contains("Error against time") && svg.contains("frame, ms"));
            assert!(svg.contains("6 × 6 &lt;best&gt;"), "escaped");
        }
        // Three points, one ring, two marks of the legend.
        let svg = chart().to_svg().expect("draws");
        assert_eq!(svg.matches("<circle").count(), 6);
    }

    #[test]
    fn a_chart_of_nothing_is_rejected() {
        let mut chart = chart();
        chart.series.remove(0);
        assert!(matches!(chart.to_svg(), Err(ChartError::Empty(_))));
        chart.y_log = false;
        chart.x_log = false;
        chart.to_svg().expect("one point is enough");
    }

    #[test]
    fn numbers_are_short() {
        let numbers = [0.0, 1.0, 0.25, 1500.0, 1e-7, 2e6, 60.0].map(short);
        assert_eq!(numbers, ["0", "1", "0.25", "1500", "1e-7", "2e6", "60"]);
    }
}
