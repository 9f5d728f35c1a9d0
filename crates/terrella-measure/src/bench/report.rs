//! JSON output of the harness, which is read again as a baseline.

use super::error::BenchError;
use crate::{GroundPath, Quantiles, median};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use terrella_files::{self as files, printable};

/// The layout of the file. A reader rejects others.
pub const VERSION: u32 = 2;
/// Largest baseline that is read, bytes: twice one with [`MAX_FRAMES`](super::MAX_FRAMES).
const MAX_BYTES: u64 = 64 << 20;

/// One run of the harness.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BenchReport {
    /// Layout of the file: [`VERSION`].
    pub version: u32,
    /// Whether the run was interrupted: rows or features are then missing.
    pub partial: bool,
    /// When the run began, UTC.
    pub date: String,
    /// The command's arguments.
    pub arguments: Vec<String>,
    /// The commit that was checked out where the program was built, with a word where sources differed; "unknown" outside of git.
    pub commit: String,
    /// Name of the adapter.
    pub adapter: String,
    /// vulkan, gl, metal or dx12.
    pub backend: String,
    /// Name and version of its driver, as reported.
    pub driver: String,
    /// Model and number of the processors.
    pub cpu: String,
    /// Name and kernel of the operating system.
    pub os: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Samples a pixel that were really drawn.
    pub samples: u32,
    /// Frames that each row was timed with in each run.
    pub frames: u32,
    /// Runs over all rows and features, one after the other.
    pub repeats: u32,
    /// Settings of the scene that affect the work of a frame, each value as the scene writes it.
    pub scene: BTreeMap<String, String>,
    /// The floor, median of the rows' medians, milliseconds.
    pub floor_ms: f64,
    /// A pass that clears and draws nothing, likewise, milliseconds.
    pub clear_ms: f64,
    /// One for each height and path.
    pub rows: Vec<BenchRow>,
    /// Cost of each layer and effect along each course.
    pub features: Vec<Feature>,
    /// Requests of the scene that this adapter does not support.
    pub unmeasured: Vec<Unmeasured>,
}

/// A request of the scene that the adapter does not support, so that its cost was not measured.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unmeasured {
    /// As in scene files.
    pub name: String,
    /// Why it was not measured.
    pub why: String,
}

/// Times of one run over a row, one for each frame, milliseconds.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RowTimes {
    /// `prepare` on the processor.
    pub prepare_ms: Vec<f64>,
    /// The whole frame, the device waited for.
    pub frame_ms: Vec<f64>,
    /// The floor beside it.
    pub floor_ms: Vec<f64>,
    /// A pass that clears and draws nothing, beside it.
    pub clear_ms: Vec<f64>,
}

/// Times of one run over a feature, one for each frame, milliseconds.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FeatureTimes {
    /// The whole scene.
    pub with_ms: Vec<f64>,
    /// The scene without the feature, beside it.
    pub without_ms: Vec<f64>,
}

/// Course of the eye during the measurement of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Course {
    /// The scene's own flight.
    Flight,
    /// The path along the equator, [`COURSE_HEIGHT_KM`] high.
    Equatorial,
    /// The inclined path, as high.
    Inclined,
}

/// Height of the eye on the paths that features are measured along, kilometres.
pub const COURSE_HEIGHT_KM: f64 = 600.0;

impl Course {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Flight, Self::Equatorial, Self::Inclined];

    /// The path over the ground; `None` for the scene's own flight.
    pub fn path(self) -> Option<GroundPath> {
        match self {
            Self::Flight => None,
            Self::Equatorial => Some(GroundPath::Equatorial),
            Self::Inclined => Some(GroundPath::Inclined),
        }
    }
}

/// One height along one path. Counts are the maxima over all frames.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BenchRow {
    /// Height of the eye above the ellipsoid, kilometres.
    pub height_km: f64,
    /// The way that it flies.
    pub path: GroundPath,
    /// Blocks left by the scene's own rule for the horizon.
    pub blocks_visible: u32,
    /// Blocks left by the frustum too.
    pub blocks_drawn: u32,
    /// Blocks that the paper's rule leaves.
    pub blocks_paper_rule: u32,
    /// Blocks of which a point of the ellipsoid is above the horizon.
    pub blocks_exact: u32,
    /// Most blocks of the exact count that the scene's rule left out in one frame.
    pub blocks_lost: u32,
    /// Most blocks of the exact count that the paper's rule left out in one frame.
    pub blocks_lost_paper_rule: u32,
    /// Blocks in daylight by level of the day map, the finest first; empty without a pack.
    pub levels: Vec<u32>,
    /// Triangles drawn, air included.
    pub triangles: u32,
    /// Draw calls, air included.
    pub draw_calls: u32,
    /// Bytes written to the GPU in one frame. Tiles have come before.
    pub uploaded_bytes: u64,
    /// `prepare` on the processor, milliseconds.
    pub prepare_ms: Quantiles,
    /// Median time of "surface", "air" and "development" on the device, each as a separate pass, in separate frames, milliseconds; empty if the
    /// device has no timestamps.
    pub gpu_ms: BTreeMap<String, f64>,
    /// The whole frame, the device waited for, milliseconds.
    pub frame_ms: Quantiles,
    /// Time beyond twice the median, summed over the frames, milliseconds.
    pub jank_ms: f64,
    /// The floor, median, milliseconds.
    pub floor_ms: f64,
    /// A pass that clears and draws nothing, median, milliseconds.
    pub clear_ms: f64,
    /// Median of each frame over the floor beside it.
    pub floor_ratio: f64,
    /// Range of the runs' medians of that, relative to `floor_ratio`; `None` for a single run.
    pub floor_ratio_spread: Option<f64>,
    /// 1 over the median frame.
    pub frames_per_s: f64,
    /// The paper's value for this height, on its machine of 2011.
    pub paper_frames_per_s: Option<f64>,
    pub runs: Vec<RowTimes>,
}

/// A layer or an effect: the scene with it, and the same without it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Feature {
    /// As in scene files; `multisampling` is `samples`, `tiles` the pack's levels above the coarsest.
    pub name: String,
    /// Course of the eye.
    pub course: Course,
    /// Median frame of the whole scene, milliseconds.
    pub frame_ms_with: f64,
    /// Median frame without the feature, each drawn beside one of the whole scene, milliseconds.
    pub frame_ms_without: f64,
    /// Median of each frame with it over the one without it beside it.
    pub frame_ratio: f64,
    /// Range of the runs' medians of that, relative to `frame_ratio`; `None` for a single run.
    pub frame_ratio_spread: Option<f64>,
    /// Bytes of textures that are held for it alone.
    pub texture_bytes: i64,
    /// Bytes of WGSL that the driver gets for it alone.
    pub shader_bytes: i64,
    pub runs: Vec<FeatureTimes>,
}

impl BenchReport {
    /// As indented JSON with a line end.
    pub fn to_json(&self) -> String {
        // Numbers, strings, lists and maps of strings cannot fail to be written; the error is kept for the type's sake.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_else(|error| error.to_string());
        text.push('\n');
        text
    }

    /// Reads a report for comparison.
    ///
    /// # Errors
    /// A file that cannot be read or is too large, text that is not a report of this version, or impossible values.
    pub fn load(path: &Path) -> Result<Self, BenchError> {
        let unreadable = |source| BenchError::BaselineUnreadable {
            path: path.into(),
            source,
        };
        let bytes = files::read(path, MAX_BYTES).map_err(unreadable)?;
        let rejected = |what: String| BenchError::NoBaseline {
            path: path.into(),
            what,
        };
        let bytes =
            bytes.ok_or_else(|| rejected(format!("it is larger than {MAX_BYTES} bytes")))?;
        let unlike = |error: serde_json::Error| rejected(printable(&error.to_string()));
        // First, so that an older file is rejected for its version and not for its keys.
        let layout: Layout = serde_json::from_slice(&bytes).map_err(unlike)?;
        if layout.version != VERSION {
            return Err(rejected(format!(
                "its layout is version {}, this program's is {VERSION}",
                layout.version
            )));
        }
        let report: Self = serde_json::from_slice(&bytes).map_err(unlike)?;
        report.check().map_err(rejected)?;
        Ok(report)
    }

    /// Rejects values that no complete run of this version writes; returns the reason.
    fn check(&self) -> Result<(), String> {
        if self.partial {
            return Err("its run was interrupted and rows are missing".into());
        }
        let time = |name: &str, value: f64| match value.is_finite() && value >= 0.0 {
            true => Ok(()),
            false => Err(format!("{name} is {value}; it must be 0 or more")),
        };
        time("floor_ms", self.floor_ms)?;
        time("clear_ms", self.clear_ms)?;
        let mut known = BTreeSet::new();
        for row in &self.rows {
            time("height_km", row.height_km)?;
            let name = row.name();
            if !known.insert(name.clone()) {
                return Err(format!("it has two rows for {name}"));
            }
            let in_row = |what: String| format!("{name}: {what}");
            for (key, value) in [
                ("jank_ms", row.jank_ms),
                ("floor_ms", row.floor_ms),
                ("clear_ms", row.clear_ms),
                ("frames_per_s", row.frames_per_s),
                ("frame_ms", row.frame_ms.median),
                ("prepare_ms", row.prepare_ms.median),
            ] {
                time(key, value).map_err(in_row)?;
            }
            if !row.floor_ratio.is_finite() || row.floor_ratio <= 0.0 {
                return Err(in_row(format!(
                    "floor_ratio is {}; it must be more than 0",
                    row.floor_ratio
                )));
            }
            row.check_runs().map_err(in_row)?;
        }
        Ok(())
    }
}

impl BenchRow {
    /// Height and path, as in messages.
    pub fn name(&self) -> String {
        format!("{} km, {}", self.height_km, self.path.name())
    }

    /// Frame over floor of each frame, by run.
    pub fn ratios(&self) -> Vec<Vec<f64>> {
        let runs = self.runs.iter();
        runs.map(|run| ratios(&run.frame_ms, &run.floor_ms))
            .collect()
    }

    /// Rejects times that no run gives.
    fn check_runs(&self) -> Result<(), String> {
        let frames = self.runs.first().map_or(0, |run| run.frame_ms.len());
        for run in &self.runs {
            for times in [&run.prepare_ms, &run.frame_ms, &run.floor_ms, &run.clear_ms] {
                if times.len() != frames || frames == 0 {
                    return Err("its runs have no frames, or not as many of each time".into());
                }
                if let Some(time) = times.iter().find(|time| !time.is_finite() || **time < 0.0) {
                    return Err(format!("a time is {time}; it must be 0 or more"));
                }
            }
        }
        match self.runs.is_empty() {
            true => Err("it has no runs".into()),
            false => Ok(()),
        }
    }
}

/// The part of a report that is read first.
#[derive(serde::Deserialize)]
struct Layout {
    version: u32,
}

/// Each time over the one beside it.
pub(super) fn ratios(times: &[f64], beside: &[f64]) -> Vec<f64> {
    let pairs = times.iter().zip(beside);
    pairs
        .map(|(time, beside)| time / beside.max(1e-6))
        .collect()
}

/// Range of the runs' medians, relative to the median of all; `None` for a single run.
pub(super) fn spread(runs: &[Vec<f64>], of_all: f64) -> Option<f64> {
    let medians = runs.iter().map(|run| median(run));
    let (least, most) = medians.fold((f64::INFINITY, 0.0_f64), |(least, most), median| {
        (least.min(median), most.max(median))
    });
    (runs.len() > 1).then(|| (most - least) / of_all.max(1e-6))
}
