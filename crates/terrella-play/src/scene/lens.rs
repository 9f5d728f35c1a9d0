//! `[lens]`: the aperture, which diffracts sunlight into spikes, and ghosts.

use super::error::SceneError;
use super::field::{Bounds, Field, range_text, whole};
use super::record::{Notes, Record};
use super::sky::SkyTable;
#[cfg(test)]
use super::table::About;
use super::table::{Key, Only, Table, Value, given_or, method, table};
use super::text::SceneText;
use serde::Deserialize;
#[cfg(test)]
use serde_json::json;
use std::ops::{Range, RangeInclusive};
use terrella_ground::light::{Aperture, Ghosts};
use toml::Spanned;

const GLARE: &Only = &Only {
    why: "only for glare = true in [sky]",
    sources: &[],
};
const BLADES: &Only = &Only {
    why: "only with blades",
    sources: &[],
};

table!(RawLens = "lens" {
    /// Blades of the aperture: a regular polygon, whose edges diffract the Sun's light to spikes. By default the Sun has none.
    blades: i64, of "a whole number from 3 to 18", in Aperture::BLADES, for GLARE;
    /// The f-number. A larger one spreads the pattern wider over the sensor, of which the picture is 24 mm high.
    f_number: f64, in Aperture::F_NUMBERS, default 16.0, for BLADES;
    /// Part of the aperture that dust covers, in specks of a hundredth of its diameter. Its light is a corona about the Sun.
    dust: f64, in Aperture::DUSTS, default 0.0, for BLADES;
    /// Part of the Sun's light in ghosts: images of the aperture that reflections inside the lens make, mirrored about the picture's middle. 0 draws none.
    ghosts: f64, in Ghosts::PARTS, default 0.0, for GLARE;
});

impl SceneText<'_> {
    /// Checks `[lens]`: the drawn diffraction of the aperture, and ghosts.
    pub(super) fn lens_table(
        &self,
        lens: &RawLens,
        sky: &SkyTable,
    ) -> Result<(Option<Aperture>, Option<Ghosts>), SceneError> {
        let aperture = self.aperture(lens, sky)?;
        let field = lens.ghosts();
        if !sky.glare {
            let advice = "needs the Sun's glare; write glare = true in [sky], or leave ghosts out";
            self.idle(&field, GLARE.why, advice)?;
            return Ok((aperture, None));
        }
        let part = self.quantity(&field)?;
        let ghosts = Ghosts {
            part,
            blades: aperture.map(|aperture| aperture.blades),
        };
        Ok((aperture, Some(ghosts).filter(|_| part > 0.0)))
    }

    fn aperture(&self, lens: &RawLens, sky: &SkyTable) -> Result<Option<Aperture>, SceneError> {
        let (field, f_number, dust) = (lens.blades(), lens.f_number(), lens.dust());
        let blades = match sky.glare {
            true => self.blades(&field)?,
            false => {
                let advice =
                    "needs the Sun's glare; write glare = true in [sky], or leave blades out";
                self.idle(&field, GLARE.why, advice)?;
                None
            }
        };
        let Some(blades) = blades else {
            let advice = "has a meaning with blades alone; give them too, or leave this key out";
            self.idle(&f_number, BLADES.why, advice)?;
            self.idle(&dust, BLADES.why, advice)?;
            return Ok(None);
        };
        Ok(Some(Aperture {
            blades,
            f_number: self.quantity(&f_number)?,
            dust: self.quantity(&dust)?,
        }))
    }

    fn blades(
        &self,
        field: &Field<'_, i64, RangeInclusive<i64>>,
    ) -> Result<Option<u32>, SceneError> {
        let Some(given) = field.value() else {
            field.note(Err("the Sun has no spikes"));
            return Ok(None);
        };
        let blades = whole(given, &field.rule).ok_or_else(|| {
            let range = range_text(&field.rule);
            let advice = format!(
                "must be from {range}: fewer blades close no polygon; most lenses have 5 to 9"
            );
            self.reject(field, advice)
        })?;
        field.note(Ok(blades.to_string()));
        Ok(Some(blades))
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::Scene;
    use std::path::Path;

    fn aperture(text: &str) -> Result<Option<super::Aperture>, String> {
        let scene = Scene::from_toml(text, Path::new("a.toml"));
        scene
            .map(|scene| scene.aperture)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn an_aperture_is_read_or_rejected_by_key() {
        let glare = "[sky]\nglare = true\n[lens]\n";
        let read = aperture(&format!("{glare}blades = 7\nf_number = 8\n")).expect("good");
        let read = read.expect("an aperture");
        assert_eq!((read.blades, read.f_number, read.dust), (7, 8.0, 0.0));
        assert_eq!(aperture(glare), Ok(None));
        for (keys, words) in [
            ("blades = 2", ["blades = 2", "3 to 18"]),
            ("blades = 6\nf_number = 0", ["f_number = 0", "1 to 64"]),
            ("blades = 6\ndust = 0.1", ["dust = 0.1", "0 to 0.005"]),
            ("blades = 6\nf_number = nan", ["f_number", "finite"]),
            ("f_number = 8", ["f_number", "blades"]),
            ("ghosts = 0.01", ["ghosts = 0.01", "0 to 0.001"]),
        ] {
            let said = aperture(&format!("{glare}{keys}\n")).expect_err(keys);
            assert!(words.iter().all(|word| said.contains(word)), "{said}");
        }
        let scene = format!("{glare}blades = 5\nghosts = 5e-4\n");
        let scene = Scene::from_toml(&scene, Path::new("a.toml")).expect("good");
        let (part, blades) = (5e-4, Some(5));
        assert_eq!(scene.ghosts, Some(super::Ghosts { part, blades }));
        let dark = aperture("[sky]\nglare = false\n[lens]\nghosts = 1e-4\n").expect_err("none");
        assert!(dark.contains("glare = true"), "{dark}");
        let dark = aperture("[sky]\nglare = false\n[lens]\nblades = 6\n").expect_err("none");
        assert!(dark.contains("glare = true"), "{dark}");
    }
}
