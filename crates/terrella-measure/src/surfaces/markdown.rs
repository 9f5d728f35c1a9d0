//! Tables and sentences of `docs/surfaces.md`, generated from the recorded tables, so that both agree.

use super::rows::{CAST, ErrorRow};
use super::{FlightSummary, SurfacePath, SurfaceStudy};
use std::collections::BTreeMap;
use std::fmt::Write;
use terrella_ground::globe::SurfaceKind;

/// Column titles of [`numbers`].
pub const COLUMNS: [&str; 19] = [
    "frame, ms",
    "over floor",
    "over blocks",
    "work over blocks",
    "`prepare`, ms",
    "longest",
    "triangles",
    "at most",
    "memory, MB",
    "GPU, MB",
    "written, kB",
    "99 %, m",
    "99 %, px",
    "worst frame, px",
    "reported, px",
    "holes",
    "elsewhere, %",
    "popping, px",
    "at most, px",
];

/// Results of a setting on a flight, as text.
pub fn numbers(row: &ErrorRow, cost: Option<&FlightSummary>) -> [String; COLUMNS.len()] {
    let of_cost = |of: fn(&FlightSummary) -> f64, digits: usize| {
        cost.map_or_else(|| "–".to_owned(), |cost| format!("{:.*}", digits, of(cost)))
    };
    let mb = |bytes: u64| format!("{:.1}", bytes as f64 / 1e6);
    [
        of_cost(|cost| cost.frame_ms.median, 0),
        of_cost(|cost| cost.over_floor.median, 1),
        of_cost(|cost| cost.over_blocks.median, 2),
        of_cost(|cost| cost.work_over_blocks.median, 2),
        format!("{:.2}", row.prepare_ms_median),
        format!("{:.1}", row.prepare_ms_most),
        row.triangles_median.to_string(),
        row.triangles_most.to_string(),
        mb(row.resident_bytes),
        mb(row.gpu_bytes),
        format!("{:.0}", row.written_bytes_median as f64 / 1e3),
        format!("{:.0}", row.error_m_p99),
        format!("{:.2}", row.error_px_p99),
        format!("{:.2}", row.worst_frame_px),
        row.reported_px_most
            .map_or_else(|| "–".to_owned(), |reported| format!("{reported:.2}")),
        row.holes.to_string(),
        format!("{:.2}", row.elsewhere_percent),
        format!("{:.2}", row.popping_px_p999),
        format!("{:.1}", row.popping_px_most),
    ]
}

/// Every text of `docs/surfaces.md` with numbers, by its name there.
pub fn sections(study: &SurfaceStudy) -> BTreeMap<String, String> {
    let grounds = study.data().into_iter().map(|data| {
        let name = data.replace(' ', "_");
        (name, ground_table(study, data))
    });
    let others = [
        ("settings", settings_table(study, "scene", SurfacePath::Low)),
        ("settling", settling_table(study)),
        ("default", default_rule(study)),
        ("findings", findings(study)),
        ("published", published(study)),
    ];
    let others = others.map(|(name, text)| (name.to_owned(), text));
    grounds.chain(others).collect()
}

/// All tables, and the texts generated from them ([`sections`]), as JSON.
pub fn json(study: &SurfaceStudy) -> String {
    let value = serde_json::json!({ "study": study, "sections": sections(study) });
    // Plain values cannot fail to be written; the error is kept for the type's sake.
    serde_json::to_string_pretty(&value).unwrap_or_else(|error| error.to_string())
}

/// A table of Markdown, the first columns words.
fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut text = format!("| {} |\n|{}\n", head.join(" | "), "---|".repeat(head.len()));
    for row in rows {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| {} |", row.join(" | "));
    }
    text
}

/// All flights over a ground, each surface at its default and contours cast.
pub fn ground_table(study: &SurfaceStudy, data: &str) -> String {
    let head = [&["flight", "surface"][..], &COLUMNS].concat();
    let rows = SurfacePath::ALL.into_iter().flat_map(|path| {
        study
            .of(data, path)
            .filter(|row| row.is_shown())
            .map(|row| {
                let mut fields = vec![row.path.name().to_owned(), name(row)];
                fields.extend(numbers(row, study.summary_of(row).as_ref()));
                fields
            })
    });
    table(&head, rows)
}

/// One flight over all settings.
pub fn settings_table(study: &SurfaceStudy, data: &str, path: SurfacePath) -> String {
    let head = [&["surface", "setting"][..], &COLUMNS].concat();
    let rows = study.of(data, path).map(|row| {
        let setting = format!("{} {}", row.parameter, row.value);
        let mut fields = vec![row.surface.name().to_owned(), setting];
        fields.extend(numbers(row, study.summary_of(row).as_ref()));
        fields
    });
    table(&head, rows)
}

/// After a jump, each surface at its default and contours cast.
pub fn settling_table(study: &SurfaceStudy) -> String {
    let head = [
        "ground",
        "surface",
        "frames to double",
        "frames to the end",
        "99 % at first, px",
        "as it stays, px",
        "longest `prepare`, ms",
    ];
    let rows = study
        .settling
        .iter()
        .filter(|row| row.is_shown())
        .map(|row| {
            let is_cast = row.parameter == CAST;
            vec![
                row.data.clone(),
                surface_name(row.surface, is_cast),
                row.frames_to_double.to_string(),
                row.frames.to_string(),
                format!("{:.1}", row.first_px),
                format!("{:.2}", row.settled_px),
                format!("{:.1}", row.prepare_ms_most),
            ]
        });
    table(&head, rows)
}

/// The basis of the default, as a table of scores and a sentence.
pub fn default_rule(study: &SurfaceStudy) -> String {
    let scores: Vec<_> = SurfaceKind::ALL
        .iter()
        .filter_map(|kind| study.score(*kind))
        .collect();
    let head = [
        "surface",
        "holes over real ground",
        "worst flight, 99 %, px",
        "over blocks",
        "worst case, 99 %, px",
    ];
    let rows = scores.iter().map(|score| {
        vec![
            score.surface.name().to_owned(),
            if score.is_sound { "none" } else { "some" }.to_owned(),
            format!("{:.2}", score.real_px),
            format!("{:.2}", score.cost),
            format!("{:.2}", score.worst_px),
        ]
    });
    let mut text = table(&head, rows);
    if let Some(surface) = study.default_surface() {
        let _ = write!(
            text,
            "\nBy this rule near the ground: `{}`.\n",
            surface.name()
        );
    }
    text
}

/// Published results compared with these measurements.
pub fn published(study: &SurfaceStudy) -> String {
    let of = |kind: SurfaceKind, is_cast: bool| {
        let rows = study.errors.iter();
        rows.filter(move |row| {
            row.surface == kind && row.is_shown() && (row.parameter == CAST) == is_cast
        })
    };
    let span = |values: Vec<f64>, digits: usize| {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(0.0, f64::max);
        match values.is_empty() {
            true => "–".to_owned(),
            false => format!("{least:.digits$} to {most:.digits$}"),
        }
    };
    let prepare = |kind, is_cast| {
        span(
            of(kind, is_cast).map(|row| row.prepare_ms_median).collect(),
            1,
        )
    };
    let cost = |kind, is_cast| {
        let costs = of(kind, is_cast).filter_map(|row| study.summary_of(row));
        span(costs.map(|cost| cost.over_blocks.median).collect(), 2)
    };
    let line = |words: [&str; 3], here: String| {
        let mut fields = words.map(str::to_owned).to_vec();
        fields.push(here);
        fields
    };
    let rows = [
        line(
            [
                "unfull quadtree, 2005",
                "35 frames/s over 2049², against 8 without LOD",
                "Pentium III 933 MHz, 256 MB, GeForce 32 MB; a DEM on a plane",
            ],
            format!(
                "`prepare` {} ms; a frame {} times one of blocks",
                prepare(SurfaceKind::Quadtree, false),
                cost(SurfaceKind::Quadtree, false)
            ),
        ),
        line(
            [
                "projected grid, 2009",
                "cost independent of height, 129 × 129",
                "Pentium 4 2 GHz, GeForce3 Ti 500",
            ],
            format!(
                "the same 129 × 129 at every height; `prepare` {} ms; a frame {} times one of blocks",
                prepare(SurfaceKind::ProjectedGrid, false),
                cost(SurfaceKind::ProjectedGrid, false)
            ),
        ),
        line(
            [
                "clipmap on an icosahedron, 2014",
                "60 frames/s at 6 levels of 129², 99 846 vertices",
                "Core i5-2400, GeForce GTX 460",
            ],
            format!(
                "up to 12 levels of 129² and the rest of the globe; `prepare` {} ms; a frame {} times one of blocks",
                prepare(SurfaceKind::Clipmap, false),
                cost(SurfaceKind::Clipmap, false)
            ),
        ),
        line(
            [
                "q-Bézier contours, 2017",
                "102 against 86 frames/s of chunked LOD, 1024 × 768, 2/3 px; rays cast",
                "Core i7 950, GeForce GTX 480",
            ],
            format!(
                "cast: a frame {} times one of blocks on a processor; bicubic patches: {}",
                cost(SurfaceKind::Contours, true),
                cost(SurfaceKind::Contours, false)
            ),
        ),
    ];
    table(
        &["publication", "its figure", "its machine", "here"],
        rows.into_iter(),
    )
}

/// The cheapest, most accurate and steadiest surfaces, counted over the flights.
pub fn findings(study: &SurfaceStudy) -> String {
    let mut text = String::new();
    for (title, data) in [("Over real ground", true), ("Over the worst case", false)] {
        let rows = || {
            let of_it = study.errors.iter();
            of_it.filter(move |row| (row.data != super::study::WORST) == data && row.is_shown())
        };
        let mut parts = Vec::new();
        for kind in SurfaceKind::ALL {
            let of_kind: Vec<_> = rows()
                .filter(|row| row.surface == *kind && row.is_default)
                .collect();
            if of_kind.is_empty() {
                continue;
            }
            let exact = of_kind.iter().filter(|row| row.error_px_p99 <= 1.0).count();
            let most = of_kind
                .iter()
                .map(|row| row.worst_frame_px)
                .fold(0.0, f64::max);
            parts.push(format!(
                "`{}` is within a pixel in 99 of a hundred on {exact} of {} flights, {most:.2} px in its worst frame",
                kind.name(),
                of_kind.len(),
            ));
        }
        let holes: u64 = rows().map(|row| row.holes).sum();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{title}: {}. Holes: {holes}.\n", parts.join("; "));
    }
    let prepare = study.errors.iter().filter(|row| row.is_shown());
    if let Some(row) = prepare.max_by(|a, b| a.prepare_ms_most.total_cmp(&b.prepare_ms_most)) {
        let _ = writeln!(
            text,
            "The longest `prepare` of all flights: {:.1} ms, {} on {} over {}.",
            row.prepare_ms_most,
            name(row),
            row.path.name(),
            row.data,
        );
    }
    text
}

fn name(row: &ErrorRow) -> String {
    surface_name(row.surface, row.parameter == CAST)
}

fn surface_name(surface: SurfaceKind, is_cast: bool) -> String {
    let cast = if is_cast { ", cast" } else { "" };
    format!("{}{cast}", surface.name())
}
