//! Quality of the window and of images: the scene's resolution, and reductions to hold its frame time.

use super::error::PlayError;
use super::flight::Moment;
use super::offscreen::OffscreenRenderer;
use crate::scene::{QualityTable, Scene};
use terrella::{AdaptiveQuality, Quality, QualityLadder};
use terrella_files as files;

/// Largest file of a ladder, bytes.
const MAX_LADDER_BYTES: u64 = 1 << 16;
/// Frames that a level is timed with for a picture's numbers.
const TIMED_FRAMES: usize = 3;

/// Holds the frame time of a scene.
pub struct QualityControl {
    adaptive: AdaptiveQuality,
}

impl QualityControl {
    /// For an Earth with this full quality; `None` if the scene sets no frame time.
    ///
    /// # Errors
    /// A quality ladder file that cannot be read or is invalid.
    pub fn of(scene: &Scene, full: Quality, has_tiles: bool) -> Result<Option<Self>, PlayError> {
        let Some(target_ms) = scene.quality.target_ms else {
            return Ok(None);
        };
        let levels = ladder_of(scene)?.levels(full, has_tiles);
        Ok(Some(Self {
            adaptive: AdaptiveQuality::new(target_ms, levels),
        }))
    }

    /// Which level is drawn, and why.
    pub fn adaptive(&self) -> &AdaptiveQuality {
        &self.adaptive
    }

    /// Records the costs of frames, milliseconds, in order; returns the new quality if it changes. All costs count; of several changes the last one
    /// applies.
    pub fn observe(&mut self, costs_ms: impl IntoIterator<Item = f64>) -> Option<Quality> {
        let costs_ms = costs_ms.into_iter();
        let change = costs_ms
            .filter_map(|cost_ms| self.adaptive.observe(cost_ms))
            .last()?;
        let given_up = self.given_up();
        tracing::info!(
            "frames take {:.1} ms, {:.1} ms are allowed; reduced: {}",
            change.cost_ms,
            self.adaptive.target_ms(),
            match given_up.is_empty() {
                true => "nothing".to_owned(),
                false => given_up.join(", "),
            }
        );
        Some(self.adaptive.levels()[change.level].quality)
    }

    /// Current reductions, in human-readable form.
    pub fn given_up(&self) -> Vec<String> {
        self.adaptive
            .reductions()
            .map(|what| what.to_string())
            .collect()
    }
}

/// The quality that would hold a scene's frame time for one image.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeldQuality {
    /// The frame time to hold, milliseconds.
    pub target_ms: f64,
    /// Whether even the last level exceeds it.
    pub out_of_reach: bool,
    /// Time of a frame on the first level that holds it, else on the last, milliseconds.
    pub frame_ms: f64,
    /// Reductions of that level.
    pub given_up: Vec<String>,
}

impl HeldQuality {
    /// Draws a moment at one level after another until one holds the scene's frame time; `None` if the scene sets none. The renderer's quality is
    /// restored.
    ///
    /// # Errors
    /// As [`QualityControl::of`]; a lost device.
    pub fn find(
        renderer: &mut OffscreenRenderer,
        scene: &Scene,
        moment: &Moment,
    ) -> Result<Option<Self>, PlayError> {
        let Some(target_ms) = scene.quality.target_ms else {
            return Ok(None);
        };
        let full = *renderer.earth().quality();
        let levels = ladder_of(scene)?.levels(full, renderer.earth().has_tiles());
        let mut found = Self {
            target_ms,
            out_of_reach: true,
            frame_ms: 0.0,
            given_up: Vec::new(),
        };
        for level in &levels {
            renderer.set_quality(&level.quality)?;
            let given_up = level.reductions.iter().map(|what| what.to_string());
            found.given_up.extend(given_up);
            // The first fills caches.
            renderer.time(moment)?;
            let mut times = (0..TIMED_FRAMES)
                .map(|_| Ok(renderer.time(moment)?.frame.as_secs_f64() * 1e3))
                .collect::<Result<Vec<f64>, PlayError>>()?;
            times.sort_by(f64::total_cmp);
            // Rounded to microseconds: further digits would be noise.
            found.frame_ms = (times[TIMED_FRAMES / 2] * 1e3).round() / 1e3;
            found.out_of_reach = found.frame_ms > target_ms;
            if !found.out_of_reach {
                break;
            }
        }
        renderer.set_quality(&full)?;
        Ok(Some(found))
    }
}

/// The quality that a scene sets for an Earth that is created with `made`.
pub fn scene_quality(table: &QualityTable, made: Quality) -> Quality {
    Quality {
        scale: table.scale,
        ..made
    }
}

/// The ladder of a scene, or the one that was recorded.
pub fn ladder_of(scene: &Scene) -> Result<QualityLadder, PlayError> {
    let Some(path) = &scene.quality.ladder else {
        return Ok(QualityLadder::recorded());
    };
    let wrong = |problem: String| PlayError::Ladder {
        path: path.clone(),
        problem,
    };
    let text =
        files::read_text(path, MAX_LADDER_BYTES).map_err(|error| wrong(error.to_string()))?;
    let text = text.ok_or_else(|| wrong(format!("more than {MAX_LADDER_BYTES} bytes")))?;
    QualityLadder::parse(&text).map_err(|error| wrong(error.to_string()))
}
