//! `[sky]`: objects beyond the Earth.

use super::choices::Look;
use super::earth::EarthTable;
use super::error::SceneError;
use super::field::PathKind;
use super::keys::RawSky;
use super::text::SceneText;
use std::path::PathBuf;

/// `[sky]`
#[derive(Clone, Debug, PartialEq)]
pub struct SkyTable {
    /// Stars.
    pub stars: bool,
    /// The light of stars too faint for that.
    pub milky_way: bool,
    /// The Sun's disc.
    pub sun: bool,
    /// The Moon.
    pub moon: bool,
    /// The Sun's light that a lens scatters.
    pub glare: bool,
    /// The Moon's shadow on the Earth.
    pub eclipses: bool,
    /// How many times brighter than in truth stars and Milky Way are.
    pub star_gain: f64,
    /// Whether they fade to the truth beside daylight: where no gain is given.
    pub stars_fade_by_day: bool,
    /// Folder of the star catalogue and the maps of Milky Way and Moon; `None` is the starter pack.
    pub folder: Option<PathBuf>,
}

impl SkyTable {
    /// Each part of the sky by key, and whether it is on.
    pub fn parts(&self) -> [(&'static str, bool); 5] {
        [
            ("stars", self.stars),
            ("milky_way", self.milky_way),
            ("sun", self.sun),
            ("moon", self.moon),
            ("glare", self.glare),
        ]
    }

    /// Switches a part of the sky off, by key.
    pub fn switch_off(&mut self, key: &str) {
        match key {
            "stars" => self.stars = false,
            "milky_way" => self.milky_way = false,
            "sun" => self.sun = false,
            "moon" => self.moon = false,
            "glare" => self.glare = false,
            _ => {}
        }
    }

    /// Whether any part is on.
    pub fn is_on(&self) -> bool {
        self.parts().iter().any(|(_, on)| *on)
    }
}

impl SceneText<'_> {
    /// Checks `[sky]`, whose defaults depend on `[earth] look`.
    pub(super) fn sky(&self, sky: &RawSky, earth: &EarthTable) -> Result<SkyTable, SceneError> {
        let is_real = earth.look != Look::Paper;
        let is_full = earth.look == Look::Full;
        let is_sunlit = earth.light.is_some();
        let eclipses = sky.eclipses();
        if !is_sunlit && eclipses.value() == Some(true) {
            let advice = "the paper's shading has no eclipses; write false, leave it out, or take look = \"standard\"";
            return Err(self.reject(&eclipses, advice));
        }
        let stars = sky.stars().is_on_or(is_real);
        let milky_way = sky.milky_way().is_on_or(is_full);
        let star_gain = sky.star_gain();
        if !stars && !milky_way {
            star_gain.note(Err("there are no stars"));
        }
        Ok(SkyTable {
            stars,
            milky_way,
            sun: sky.sun().is_on_or(is_real),
            moon: sky.moon().is_on_or(is_real),
            glare: sky.glare().is_on_or(is_full),
            eclipses: eclipses.is_on_or(is_sunlit && is_real),
            star_gain: self.quantity(&star_gain)?,
            stars_fade_by_day: !star_gain.is_given(),
            folder: self.path(&sky.folder(), PathKind::Folder, "the starter pack is taken")?,
        })
    }
}
