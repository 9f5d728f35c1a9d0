//! `[output]` and `[quality]`: output images, and the window's frame time target.

use super::camera::Camera;
use super::choices::{CameraMode, Look};
use super::earth::EarthTable;
use super::error::SceneError;
use super::field::{Field, PathKind, range_text, whole};
use super::keys::{DEFAULT_SIZE_PX, EDGE_SAMPLES, RawOutput, RawQuality, SAMPLES, SIDE_PX};
use super::orbit::Orbit;
use super::record::{number_text, quoted};
use super::sensor::SensorTable;
use super::text::SceneText;
use super::tone::ToneTable;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use terrella_ground::air::Atmosphere;
use terrella_ground::light::{Bloom, Exposure, Grade, Tone};
use toml::Spanned;

/// Bloom with look = "full".
const FULL_BLOOM: f64 = 0.03;

/// `[output]`
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Samples per pixel, 1 or 4.
    pub samples: u32,
    /// How bright light is shown.
    pub exposure: Exposure,
    /// By which curve exposed light is shown.
    pub tone: ToneTable,
    /// What the lens does to light before that.
    pub bloom: Bloom,
    /// White balance and grain.
    pub grade: Grade,
    /// How long a picture that is kept waits for the tiles of its pack, and for its satellite's simulator, seconds.
    pub wait_s: f64,
}

/// `[quality]`: resolution, and a frame time that the window maintains by reducing quality. Saved images are affected only by the
/// scale.
#[derive(Clone, Debug, PartialEq)]
pub struct QualityTable {
    /// Most milliseconds that a frame may cost; `None` draws everything however long it takes.
    pub target_ms: Option<f64>,
    /// Part of width and height that is drawn, 0.25…1, and then enlarged to [`Output::size`].
    pub scale: f64,
    /// The file of the steps; `None` takes those that were recorded for the adapter.
    pub ladder: Option<PathBuf>,
}

impl Output {
    /// Widths and heights, pixels.
    pub const SIDE_PX: RangeInclusive<i64> = SIDE_PX;

    /// [`Self::wait_s`] as a duration.
    pub fn wait(&self) -> std::time::Duration {
        // Bounds of scene files: a finite number that is not negative.
        std::time::Duration::try_from_secs_f64(self.wait_s).unwrap_or_default()
    }
}

impl SceneText<'_> {
    /// Checks `[output]`. Some defaults depend on the drawn content.
    pub(super) fn output(
        &self,
        output: &RawOutput,
        camera: &Camera,
        sensor: Option<&SensorTable>,
        earth: &EarthTable,
        orbits: &[Orbit],
    ) -> Result<Output, SceneError> {
        let size_field = output.size();
        let range = &size_field.rule;
        let size = match size_field.given.map(|given| given.get_ref().as_slice()) {
            None => sensor.map_or(DEFAULT_SIZE_PX, SensorTable::size),
            Some(&[width, height]) => match (whole(width, range), whole(height, range)) {
                (Some(width), Some(height)) => [width, height],
                _ => {
                    let advice = format!(
                        "width and height must each be from {} pixels",
                        range_text(range)
                    );
                    return Err(self.reject(&size_field, advice));
                }
            },
            Some(other) => {
                let advice = format!("must be two numbers, [width, height], not {}", other.len());
                return Err(self.reject(&size_field, advice));
            }
        };
        size_field.note(Ok(format!("[{}, {}]", size[0], size[1])));
        let has_live = orbits.iter().any(Orbit::is_simulated);
        let has_model = orbits.iter().any(|orbit| orbit.craft.model.is_some());
        let has_craft = camera.mode == CameraMode::Chase || has_model;
        let samples_field = output.samples();
        let samples = match samples_field.value() {
            // The atmosphere hides the limb's edge; edges of a craft and of a bare limb are
            // visible.
            None if has_craft || earth.atmosphere == Atmosphere::None => {
                EDGE_SAMPLES
            }
            None => 1,
            Some(count) => u32::try_from(count)
                .ok()
                .filter(|count| SAMPLES.contains(count))
                .ok_or_else(|| {
                    let advice = "must be 1 (edges as they fall) or 4 (smooth edges), the counts that every adapter can do";
                    self.reject(&samples_field, advice)
                })?,
        };
        samples_field.note(Ok(samples.to_string()));
        let wait = output.wait_s();
        if earth.pack.is_none() && !has_live {
            self.only_with_a_pack(&wait, "no pack: nothing to wait for")?;
        }
        let wait_s = self.number(&wait, |_, range| format!("must be from {range} seconds"))?;
        let usual_tone = match earth.look {
            Look::Paper => Tone::Neutral,
            Look::Standard | Look::Full => Tone::Camera,
        };
        Ok(Output {
            size,
            samples,
            exposure: self.exposure(&output.exposure_ev())?,
            tone: self.tone(&output.tone(), usual_tone, earth)?,
            bloom: self.bloom(&output.bloom(), earth)?,
            grade: self.grade(output, earth)?,
            wait_s,
        })
    }

    fn bloom(
        &self,
        bloom: &Field<'_, f64, RangeInclusive<f64>>,
        earth: &EarthTable,
    ) -> Result<Bloom, SceneError> {
        if earth.light.is_none() {
            self.only_in_sunlight(bloom)?;
            return Ok(Bloom::default());
        }
        let usual = match earth.look {
            Look::Full => FULL_BLOOM,
            Look::Paper | Look::Standard => 0.0,
        };
        Ok(Bloom {
            strength: self.quantity_or(bloom, usual)?,
        })
    }

    fn exposure(&self, field: &Field<'_, toml::Value>) -> Result<Exposure, SceneError> {
        let exposure = self.exposure_of(field)?;
        field.note(match exposure {
            Exposure::Ev(ev) => Ok(number_text(ev)),
            Exposure::Auto => quoted("auto"),
        });
        Ok(exposure)
    }

    fn exposure_of(&self, field: &Field<'_, toml::Value>) -> Result<Exposure, SceneError> {
        let ev = match field.given.map(Spanned::get_ref) {
            None => return Ok(Exposure::default()),
            Some(toml::Value::String(word)) if word == "auto" => return Ok(Exposure::Auto),
            Some(toml::Value::Integer(ev)) => *ev as f64,
            Some(toml::Value::Float(ev)) => *ev,
            Some(_) => f64::NAN,
        };
        let range = Exposure::RANGE_EV;
        if range.contains(&ev) {
            return Ok(Exposure::Ev(ev));
        }
        let advice = format!(
            "must be a number of exposure values from {}, each of which doubles the light, or \"auto\"",
            range_text(&range)
        );
        Err(self.reject(field, advice))
    }

    /// Checks `[quality]`.
    pub(super) fn quality(&self, quality: &RawQuality) -> Result<QualityTable, SceneError> {
        let target = quality.target_ms();
        let range = &target.rule;
        let advice = |_| {
            format!(
                "must be from {} milliseconds (16.7 is 60 frames per second)",
                range_text(range)
            )
        };
        let target_ms = target
            .value()
            .map(|target_ms| self.in_range(&target, target_ms, range, advice))
            .transpose()?;
        target.note(match target_ms {
            Some(target_ms) => Ok(number_text(target_ms)),
            None => Err("quality is constant, whatever a frame takes"),
        });
        let scale = self.number(&quality.scale(), |_, range| {
            format!("must be from {range}, a part of width and height")
        })?;
        let ladder = quality.ladder();
        if ladder.given.is_some() && target_ms.is_none() {
            let advice = "ladder needs a frame time to keep; set target_ms too, or omit ladder";
            return Err(self.reject(&ladder, advice));
        }
        let without = match target_ms {
            Some(_) => "the one that was recorded for the adapter",
            None => "quality is not reduced",
        };
        let ladder = self.path(&ladder, PathKind::File, without)?;
        Ok(QualityTable {
            target_ms,
            scale,
            ladder,
        })
    }
}
