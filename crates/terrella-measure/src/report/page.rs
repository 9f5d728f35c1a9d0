//! Results as one page that needs only the images beside it.

use super::Study;
use super::change::PARAMETERS;
use super::format::{QuartilesText, digits, number};
use super::method_plots::METHODS;
use super::page_standalone;
use super::plots::Plot;
use super::rows::{MAX_GEOLOCATION_PX, MAX_SILHOUETTE_PX, SweepRow};
use super::run::picture_name;
use super::text::{subdivision_advice, verdict};
use crate::html::{self, ChartFigure, Marked, PageError, STYLE};
use serde::Serialize;

/// Number of heights whose images are shown; the others are collapsed.
const SHOWN_PICTURES: usize = 3;

/// Values of `page.html`: numbers are formatted, and parts without measurements are empty.
#[derive(Serialize)]
struct Values<'s> {
    style: &'static str,
    version: &'static str,
    title: String,
    adapter: &'s str,
    size: (u32, u32),
    repeats: u32,
    samples: u32,
    partial: Option<Partial>,
    notes: &'s [String],
    verdict: String,
    max_silhouette_px: String,
    max_geolocation_px: String,
    scene_rows: Vec<RowText>,
    has_pictures: bool,
    shown_pictures: Vec<View>,
    folded_pictures: Vec<View>,
    has_rows: bool,
    main_charts: Vec<ChartFigure<'s>>,
    heights_km: Vec<String>,
    subdivisions: Vec<SubdivisionRow>,
    advice: Option<String>,
    sweeps: Vec<Sweep<'s>>,
    /// HTML.
    standalone: String,
}

/// How much of a run that was stopped is there.
#[derive(Serialize)]
struct Partial {
    done: usize,
    wanted: usize,
}

/// A row of the study.
#[derive(Serialize)]
struct RowText {
    value: String,
    height_km: String,
    frame_ms: QuartilesText,
    floor_ratio: QuartilesText,
    flip_mean: String,
    flip_p99: String,
    rmse_linear: String,
    limb_px: Marked,
    limb_max_px: String,
    place_px: Marked,
    place_max_px: String,
    place_median_m: String,
    place_max_m: String,
    place_max_m_rounded: String,
    texels_per_px: String,
}

/// The pictures from one height.
#[derive(Serialize)]
struct View {
    height_km: String,
    pictures: [Picture; 3],
}

#[derive(Serialize)]
struct Picture {
    file: String,
    caption: String,
}

/// Effect of a mesh on the limb and the time: the basis of a default.
#[derive(Serialize)]
struct SubdivisionRow {
    value: String,
    /// One for each height; empty where nothing was measured.
    cells: Vec<Option<SubdivisionCell>>,
}

#[derive(Serialize)]
struct SubdivisionCell {
    limb_px: Marked,
    times_scene: String,
}

/// One sweep with all its numbers and the charts that are not above, or why it could not be done.
#[derive(Serialize)]
struct Sweep<'s> {
    name: String,
    unavailable: Option<&'s str>,
    rows: Vec<RowText>,
    charts: Vec<ChartFigure<'s>>,
}

/// The page as HTML.
///
/// # Errors
/// As [`html::page`].
pub(super) fn page(study: &Study, plots: &[Plot]) -> Result<String, PageError> {
    let charts = |wanted: &dyn Fn(&Plot) -> bool| -> Vec<_> {
        let plots = plots.iter().filter(|plot| wanted(plot));
        plots.map(Plot::figure).collect()
    };
    let shown_km = study.some_heights(SHOWN_PICTURES);
    let folded_km = study.pictured_km.iter().filter(|km| !shown_km.contains(km));
    let view = |height_km: &f64| View::new(study, *height_km);
    let values = Values {
        style: STYLE,
        version: env!("CARGO_PKG_VERSION"),
        title: format!("Error against run time: {}", study.scene),
        adapter: &study.adapter,
        size: study.size,
        repeats: study.repeats,
        samples: study.samples,
        partial: (!study.is_complete()).then_some(Partial {
            done: study.rows.len(),
            wanted: study.wanted,
        }),
        notes: &study.notes,
        verdict: verdict(study),
        max_silhouette_px: MAX_SILHOUETTE_PX.to_string(),
        max_geolocation_px: MAX_GEOLOCATION_PX.to_string(),
        scene_rows: study.scene_rows().map(RowText::from).collect(),
        has_pictures: !study.pictured_km.is_empty(),
        shown_pictures: shown_km.iter().map(view).collect(),
        folded_pictures: folded_km.map(view).collect(),
        has_rows: !study.rows.is_empty(),
        main_charts: charts(&|plot| plot.is_main && plot.about != METHODS),
        heights_km: study.heights_km.iter().map(f64::to_string).collect(),
        subdivisions: SubdivisionRow::all(study),
        advice: subdivision_advice(study),
        sweeps: PARAMETERS
            .into_iter()
            .filter_map(|parameter| {
                let sweep = Sweep::new(study, parameter)?;
                Some(Sweep {
                    charts: charts(&|plot| plot.about == parameter && !plot.is_main),
                    ..sweep
                })
            })
            .collect(),
        standalone: page_standalone::section(&study.standalone, plots)?,
    };
    html::page("page.html", include_str!("page.html"), &values)
}

impl From<&SweepRow> for RowText {
    fn from(row: &SweepRow) -> Self {
        let (limb, place) = (&row.silhouette, &row.geolocation);
        Self {
            value: row.change.value(),
            height_km: number(row.height_km),
            frame_ms: (&row.frame_ms).into(),
            floor_ratio: (&row.floor_ratio).into(),
            flip_mean: digits(row.flip_mean, 3),
            flip_p99: digits(row.flip_p99, 3),
            rmse_linear: digits(row.rmse_linear, 3),
            limb_px: marked_limb(limb.max_px),
            limb_max_px: digits(limb.max_px, 3),
            place_px: Marked::new(digits(place.max_px, 2), place.max_px <= MAX_GEOLOCATION_PX),
            place_max_px: digits(place.max_px, 3),
            place_median_m: digits(place.median_m, 2),
            place_max_m: digits(place.max_m, 3),
            place_max_m_rounded: digits(place.max_m, 2),
            texels_per_px: digits(row.texels_per_px, 3),
        }
    }
}

/// A limb's error, which is measured to 1/64 pixel.
fn marked_limb(error_px: f64) -> Marked {
    if error_px < 1.0 / 64.0 {
        return Marked::new("< 1/64".into(), true);
    }
    Marked::new(digits(error_px, 2), error_px <= MAX_SILHOUETTE_PX)
}

impl View {
    fn new(study: &Study, height_km: f64) -> Self {
        let row = study.scene_rows().find(|row| row.height_km == height_km);
        let flip = digits(row.map_or(f64::NAN, |row| row.flip_mean), 3);
        let picture = |what: &str, caption: String| Picture {
            file: picture_name(height_km, what),
            caption,
        };
        Self {
            height_km: height_km.to_string(),
            pictures: [
                picture("drawn", "drawn".into()),
                picture("true", "true: exact rays".into()),
                picture(
                    "flip",
                    format!("FLIP, mean {flip}: black for none, yellow for most"),
                ),
            ],
        }
    }
}

impl SubdivisionRow {
    fn all(study: &Study) -> Vec<Self> {
        let values = study.values_of("subdivision").into_iter();
        let rows = values.map(|value| Self {
            cells: study
                .heights_km
                .iter()
                .map(|height_km| {
                    let row = study.row("subdivision", &value, *height_km)?;
                    let scene = study.scene_mesh(*height_km)?;
                    let times = row.floor_ratio.median / scene.floor_ratio.median;
                    Some(SubdivisionCell {
                        limb_px: marked_limb(row.silhouette.max_px),
                        times_scene: format!("{times:.2}"),
                    })
                })
                .collect(),
            value,
        });
        rows.collect()
    }
}

impl<'s> Sweep<'s> {
    /// Without its charts; `None` where nothing was measured and nothing hindered it.
    fn new(study: &'s Study, parameter: &str) -> Option<Self> {
        let missing = study.unavailable.iter().find(|m| m.parameter == parameter);
        let rows = study.rows.iter();
        let rows: Vec<_> = rows
            .filter(|row| missing.is_none() && row.change.parameter() == parameter)
            .map(RowText::from)
            .collect();
        (missing.is_some() || !rows.is_empty()).then(|| Self {
            name: parameter.replace('_', " "),
            unavailable: missing.map(|missing| missing.why.as_str()),
            rows,
            charts: Vec::new(),
        })
    }
}
