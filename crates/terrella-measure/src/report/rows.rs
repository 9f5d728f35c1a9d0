//! Results and their tables.

use super::change::SettingChange;
use super::format::number;
use crate::Quartiles;
use crate::errors::{GeolocationErrors, SilhouetteErrors};
use crate::output::csv_text;

/// How far the drawn limb may be from the analytic one, pixels.
pub const MAX_SILHOUETTE_PX: f64 = 0.5;
/// How far from its exact place a pixel may look, pixels.
pub const MAX_GEOLOCATION_PX: f64 = 1.0;

/// One setting from one height.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepRow {
    /// Difference from the scene.
    pub change: SettingChange,
    /// Height of the eye, kilometres.
    pub height_km: f64,
    /// Time of a frame, milliseconds.
    pub frame_ms: Quartiles,
    /// Time of its floor, milliseconds.
    pub floor_ms: Quartiles,
    /// Frame over floor, each taken in the same moment.
    pub floor_ratio: Quartiles,
    /// Time of `prepare`, milliseconds.
    pub prepare_ms: f64,
    pub flip_mean: f64,
    /// 99th percentile of FLIP.
    pub flip_p99: f64,
    /// Error in linear light.
    pub rmse_linear: f64,
    /// The limb.
    pub silhouette: SilhouetteErrors,
    /// The places.
    pub geolocation: GeolocationErrors,
    /// Texels of the day map per pixel, where there are fewest.
    pub texels_per_px: f64,
    /// Triangles drawn.
    pub triangles: u32,
}

impl SweepRow {
    /// Whether limb and geolocation have the accuracy required of a default.
    pub fn is_exact(&self) -> bool {
        self.silhouette.max_px <= MAX_SILHOUETTE_PX && self.geolocation.max_px <= MAX_GEOLOCATION_PX
    }
}

/// The columns of the table of medians and errors.
pub const CSV_COLUMNS: [&str; 13] = [
    "method",
    "parameter",
    "value",
    "height_km",
    "frame_ms_median",
    "floor_ratio",
    "flip_mean",
    "flip_p99",
    "rmse_linear",
    "silhouette_px",
    "geolocation_m",
    "geolocation_px",
    "texels_per_px",
];

/// The columns of the table of spreads.
const SPREAD_COLUMNS: [&str; 21] = [
    "method",
    "parameter",
    "value",
    "height_km",
    "frame_ms_q1",
    "frame_ms_median",
    "frame_ms_q3",
    "floor_ms_q1",
    "floor_ms_median",
    "floor_ms_q3",
    "floor_ratio_q1",
    "floor_ratio_median",
    "floor_ratio_q3",
    "prepare_ms_median",
    "triangles",
    "silhouette_px_median",
    "silhouette_places",
    "geolocation_pixels",
    "geolocation_m_median",
    "geolocation_m_p99",
    "geolocation_px_p99",
];

/// The table of medians and errors. Silhouette and geolocation are the largest found.
pub fn csv(rows: &[SweepRow]) -> String {
    table(&CSV_COLUMNS, rows, |row| {
        [
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
        ]
    })
}

/// The table of spreads: quartiles of times, and percentiles of errors.
pub fn spread_csv(rows: &[SweepRow]) -> String {
    table(&SPREAD_COLUMNS, rows, |row| {
        let (frame, floor, ratio) = (&row.frame_ms, &row.floor_ms, &row.floor_ratio);
        [
            row.height_km,
            frame.lower,
            frame.median,
            frame.upper,
            floor.lower,
            floor.median,
            floor.upper,
            ratio.lower,
            ratio.median,
            ratio.upper,
            row.prepare_ms,
            f64::from(row.triangles),
            row.silhouette.median_px,
            row.silhouette.places as f64,
            row.geolocation.pixels as f64,
            row.geolocation.median_m,
            row.geolocation.p99_m,
            row.geolocation.p99_px,
        ]
    })
}

/// A table whose lines start with setting and value, followed by numbers.
fn table<const NUMBERS: usize>(
    columns: &[&str],
    rows: &[SweepRow],
    numbers: fn(&SweepRow) -> [f64; NUMBERS],
) -> String {
    let head: Vec<String> = columns.iter().map(|name| (*name).to_owned()).collect();
    let lines = rows.iter().map(|row| {
        let setting = [
            "earth".to_owned(),
            row.change.parameter().to_owned(),
            row.change.value(),
        ];
        let numbers = numbers(row).map(number);
        setting.into_iter().chain(numbers).collect::<Vec<_>>()
    });
    csv_text(std::iter::once(head).chain(lines))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use terrella::Subdivision;

    /// A row of no particular numbers.
    pub fn row(change: SettingChange, height_km: f64, frame_ms: f64, error: f64) -> SweepRow {
        SweepRow {
            change,
            height_km,
            frame_ms: Quartiles {
                lower: 0.9 * frame_ms,
                median: frame_ms,
                upper: 1.2 * frame_ms,
            },
            floor_ms: Quartiles::exact(4.0),
            floor_ratio: Quartiles::exact(frame_ms / 4.0),
            prepare_ms: 0.1,
            flip_mean: error,
            flip_p99: 3.0 * error,
            rmse_linear: 0.1 * error,
            silhouette: SilhouetteErrors {
                max_px: 20.0 * error,
                median_px: 10.0 * error,
                places: 64,
                in_view: true,
            },
            geolocation: GeolocationErrors {
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
            CSV_COLUMNS.join(","),
            "method,parameter,value,height_km,frame_ms_median,floor_ratio,flip_mean,flip_p99,rmse_linear,silhouette_px,geolocation_m,geolocation_px,texels_per_px"
        );
        let rows = [row(
            SettingChange::Subdivision(Subdivision::Cells(6)),
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
}
