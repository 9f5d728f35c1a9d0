//! Keys of `[output]` about white balance and grain.

use super::earth::EarthTable;
use super::error::SceneError;
use super::keys::RawOutput;
use super::record::number_text;
use super::text::SceneText;
use terrella_ground::light::{Grade, Grain, WhiteBalance};

impl SceneText<'_> {
    pub(super) fn grade(
        &self,
        output: &RawOutput,
        earth: &EarthTable,
    ) -> Result<Grade, SceneError> {
        if earth.light.is_none() {
            self.only_in_sunlight(&output.white_balance_k())?;
            self.only_in_sunlight(&output.tint())?;
            self.only_in_sunlight(&output.grain())?;
            self.only_in_sunlight(&output.grain_size_px())?;
            self.only_in_sunlight(&output.grain_seed())?;
            return Ok(Grade::NONE);
        }
        Ok(Grade {
            white_balance: self.white_balance(output)?,
            grain: self.grain(output)?,
        })
    }

    fn white_balance(&self, output: &RawOutput) -> Result<Option<WhiteBalance>, SceneError> {
        let (field, tint) = (output.white_balance_k(), output.tint());
        let Some(temperature_k) = field.value() else {
            field.note(Err("colours are as they are"));
            let advice =
                "has a meaning with white_balance_k alone; give that too, or leave tint out";
            self.idle(&tint, "there is no white balance", advice)?;
            return Ok(None);
        };
        let range = &field.rule;
        let temperature_k = self.in_range(&field, temperature_k, range, |_| {
            format!("must be from {} to {} kelvins", range.start(), range.end())
        })?;
        field.note(Ok(number_text(temperature_k)));
        Ok(Some(WhiteBalance {
            temperature_k,
            tint: self.quantity(&tint)?,
        }))
    }

    fn grain(&self, output: &RawOutput) -> Result<Grain, SceneError> {
        let strength = self.quantity(&output.grain())?;
        let (size, seed) = (output.grain_size_px(), output.grain_seed());
        if strength == 0.0 {
            let advice = "has no meaning without grain; give grain, or leave it out";
            self.idle(&size, "there is no grain", advice)?;
            self.idle(&seed, "there is no grain", advice)?;
            return Ok(Grain::NONE);
        }
        Ok(Grain {
            strength,
            size_px: self.quantity(&size)?,
            seed: self.count(&seed, |range| format!("must be from {range}"))?,
        })
    }
}
