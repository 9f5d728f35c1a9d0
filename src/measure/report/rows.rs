//! What is found, and its tables.

use super::change::Change;
use crate::measure::Spread;
use crate::measure::errors::{Geolocation, Silhouette};
use std::fmt::Write;

/// How far the drawn limb may be from the analytic one, pixels.
pub const SILHOUETTE_MOST_PX: f64 = 0.5;
/// How far from its exact place a pixel may look, pixels.
pub const GEOLOCATION_MOST_PX: f64 = 1.0;

/// One setting from one height.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What is not as in the scene.
    pub change: Change,
    /// Height of the eye, kilometres.
    pub height_km: f64,
    /// Time of a frame, milliseconds.
    pub frame_ms: Spread,
    /// Time of its floor, milliseconds.
    pub floor_ms: Spread,
    /// Frame over floor, each taken in the same moment.
    pub floor_ratio: Spread,
    /// Time of `prepare`, milliseconds.
    pub prepare_ms: f64,
    /// Mean of FLIP.
    pub flip_mean: f64,
    /// 99th percentile of FLIP.
    pub flip_p99: f64,
    /// Error in linear light.
    pub rmse_linear: f64,
    /// The limb.
    pub silhouette: Silhouette,
    /// The places.
    pub geolocation: Geolocation,
    /// Texels of the day map per pixel, where there are fewest.
    pub texels_per_px: f64,
    /// Triangles drawn.
    pub triangles: u32,
}

impl Row {
    /// Whether limb and places are as exact as is asked of a default.
    pub fn is_exact(&self) -> bool {
        self.silhouette.max_px <= SILHOUETTE_MOST_PX
            && self.geolocation.max_px <= GEOLOCATION_MOST_PX
    }
}

/// First line of the table.
pub const CSV_HEADER: &str = "method,parameter,value,height_km,frame_ms_median,floor_ratio,flip_mean,flip_p99,\
                              rmse_linear,silhouette_px,geolocation_m,geolocation_px,texels_per_px";

/// The table of medians and errors. Silhouette and geolocation are the largest found.
pub fn csv(rows: &[Row]) -> String {
    let mut text = format!("{CSV_HEADER}\n");
    for row in rows {
        let numbers = [
            row.height_km,
            row.frame_ms.median,
            row.floor_ratio.median,
            row.flip_mean,
            row.flip_p99,
            row.rmse_linear,
            row.silhouette.max_px,
            row.geolocation.max_m,
            row.geolocation.max_px,
            row.texels_per_px,
        ];
        line(&mut text, row, &numbers);
    }
    text
}

/// The table of spreads: quartiles of times, and what lies below the largest errors.
pub fn spread_csv(rows: &[Row]) -> String {
    let mut text = "method,parameter,value,height_km,frame_ms_q1,frame_ms_median,frame_ms_q3,floor_ms_q1,floor_ms_median,\
                    floor_ms_q3,floor_ratio_q1,floor_ratio_median,floor_ratio_q3,prepare_ms_median,triangles,\
                    silhouette_px_median,silhouette_places,geolocation_pixels,geolocation_m_median,geolocation_m_p99,\
                    geolocation_px_p99\n"
        .to_owned();
    for row in rows {
        let of = |spread: &Spread| [spread.low, spread.median, spread.high];
        let mut numbers = vec![row.height_km];
        for spread in [&row.frame_ms, &row.floor_ms, &row.floor_ratio] {
            numbers.extend(of(spread));
        }
        numbers.extend([
            row.prepare_ms,
            f64::from(row.triangles),
            row.silhouette.median_px,
            row.silhouette.places as f64,
            row.geolocation.pixels as f64,
            row.geolocation.median_m,
            row.geolocation.p99_m,
            row.geolocation.p99_px,
        ]);
        line(&mut text, row, &numbers);
    }
    text
}

fn line(text: &mut String, row: &Row, numbers: &[f64]) {
    let (parameter, value) = (row.change.parameter(), row.change.value());
    // Writing to a string does not fail.
    let _ = write!(text, "earth,{parameter},{value}");
    for value in numbers {
        let _ = write!(text, ",{}", number(*value));
    }
    text.push('\n');
}

/// Six significant digits without an exponent where that is short.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let magnitude = value.abs().log10().floor();
    if !(-6.0..9.0).contains(&magnitude) {
        return format!("{value:.5e}");
    }
    let digits = (5.0 - magnitude).max(0.0) as usize;
    let text = format!("{value:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::Subdivision;

    /// A row of no particular numbers.
    pub fn row(change: Change, height_km: f64, frame_ms: f64, error: f64) -> Row {
        Row {
            change,
            height_km,
            frame_ms: Spread {
                low: 0.9 * frame_ms,
                median: frame_ms,
                high: 1.2 * frame_ms,
            },
            floor_ms: Spread::exact(4.0),
            floor_ratio: Spread::exact(frame_ms / 4.0),
            prepare_ms: 0.1,
            flip_mean: error,
            flip_p99: 3.0 * error,
            rmse_linear: 0.1 * error,
            silhouette: Silhouette {
                max_px: 20.0 * error,
                median_px: 10.0 * error,
                places: 64,
                in_view: true,
            },
            geolocation: Geolocation {
                pixels: 1000,
                median_m: 1.0,
                p99_m: 5.0,
                max_m: 50.0,
                p99_px: 1e-5,
                max_px: 2e-5,
            },
            texels_per_px: 1.25,
            triangles: 2000,
        }
    }

    #[test]
    fn the_table_has_the_columns_of_the_contract() {
        assert_eq!(
            CSV_HEADER,
            "method,parameter,value,height_km,frame_ms_median,floor_ratio,flip_mean,flip_p99,rmse_linear,silhouette_px,geolocation_m,geolocation_px,texels_per_px"
        );
        let rows = [row(
            Change::Subdivision(Subdivision::Cells(6)),
            200.0,
            10.0,
            0.01,
        )];
        let table = csv(&rows);
        assert_eq!(
            table.lines().nth(1),
            Some("earth,subdivision,6,200,10,2.5,0.01,0.03,0.001,0.2,50,0.00002,1.25")
        );
        let spread = spread_csv(&rows);
        let count = |text: &str| {
            text.lines()
                .map(|line| line.split(',').count())
                .collect::<Vec<_>>()
        };
        assert_eq!(count(&spread)[0], count(&spread)[1]);
        assert_eq!(count(&table), [13, 13]);
    }

    #[test]
    fn numbers_have_six_digits() {
        let values = [0.0, 1234567.0, 0.123456789, 1e-9, 1e12, 3.0, f64::INFINITY];
        let texts = values.map(number);
        assert_eq!(
            texts,
            [
                "0",
                "1234567",
                "0.123457",
                "1.00000e-9",
                "1.00000e12",
                "3",
                "inf"
            ]
        );
    }
}
