//! `[earth]`: the keys of terrain.

use super::error::SceneError;
use super::field::{Field, PathKind, RawPath};
use super::keys::{MAX_ELEVATION_FILES, PACK, RELIEF, RawEarth};
use super::record::list_text;
use super::surfaces;
use super::text::SceneText;
use std::path::PathBuf;
use terrella_ground::globe::{Subdivision, SurfaceKind, SurfaceSettings, Visibility};

/// Keys of `[earth]` about drawing terrain.
#[derive(Clone, Debug, PartialEq)]
pub struct ReliefTable {
    /// The surface that draws the ground.
    pub surface: SurfaceKind,
    /// And how, as `[earth.clipmap]` and the like set it.
    pub settings: SurfaceSettings,
    /// Files of heights, folders of them, and patterns of their names; none takes the starter pack's, of the whole Earth, unless the scene's pack has them.
    pub elevation: Vec<PathBuf>,
    /// Memory for the heights of the scene's pack, megabytes, where they lie beneath those of the files.
    pub pack_heights_mb: Option<f64>,
    /// Most pixels by which the drawn ground may differ from its data.
    pub tolerance_px: f64,
    /// Whether the sea's floor is drawn, and not its surface, where a file of the whole Earth has it.
    pub sea_floor: bool,
    /// Whether single wrong heights are taken out of the files before anything is made of them.
    pub denoise: bool,
}

impl SceneText<'_> {
    /// Terrain is drawn if a scene gives elevation data, or a surface other than blocks. Blocks need no
    /// elevation data.
    pub(super) fn relief(&self, earth: &RawEarth) -> Result<Option<ReliefTable>, SceneError> {
        let elevation_field = earth.elevation();
        let pack_heights_mb = self.pack_heights_mb(earth)?;
        // A smooth Earth is drawn as blocks.
        let names_heights = elevation_field.is_given() || pack_heights_mb.is_some();
        let usual = match names_heights {
            true => SurfaceKind::default(),
            false => SurfaceKind::Blocks,
        };
        let surface = self.choice_or(&earth.surface(), usual)?;
        let settings = self.surface_settings(earth, surface)?;
        let elevation = self.paths(&elevation_field)?;
        let (tolerance_px, sea_floor) = (earth.tolerance_px(), earth.sea_floor());
        let denoise = earth.denoise();
        if surface == SurfaceKind::Blocks && !names_heights {
            elevation_field.note(Err(RELIEF.why));
            self.only_with_relief(&tolerance_px)?;
            self.only_with_relief(&sea_floor)?;
            self.only_with_relief(&denoise)?;
            return Ok(None);
        }
        self.only_of_the_smooth_earth(earth, surface)?;
        elevation_field.note(match (elevation.is_empty(), pack_heights_mb) {
            (false, _) => Ok(list_text(elevation.iter().map(|file| file.display()))),
            (true, Some(_)) => Err("only the pack's elevation data is used"),
            (true, None) => Err("the starter pack's elevation data is used"),
        });
        if let Some(why) = surfaces::without_tolerance(&settings) {
            tolerance_px.note(Err(why));
        }
        Ok(Some(ReliefTable {
            surface,
            settings,
            elevation,
            pack_heights_mb,
            tolerance_px: self.number(&tolerance_px, |_, range| {
                format!("must be from {range} pixels")
            })?,
            sea_floor: sea_floor.is_on(),
            denoise: denoise.is_on(),
        }))
    }

    /// Rejects a key without meaning if there is no terrain.
    fn only_with_relief<T, R>(&self, field: &Field<'_, T, R>) -> Result<(), SceneError> {
        let advice = format!(
            "{} is for terrain; leave it out, or set elevation = [] (the starter pack's) or [\"FILE\", …]",
            field.key
        );
        self.idle(field, RELIEF.why, advice)
    }

    /// Memory limit for the pack's heights, if the scene uses them.
    fn pack_heights_mb(&self, earth: &RawEarth) -> Result<Option<f64>, SceneError> {
        let (pack_heights, ground_mb) = (earth.pack_heights(), earth.ground_mb());
        if !earth.pack().is_given() {
            self.only_with_a_pack(&pack_heights, PACK.why)?;
            self.only_with_a_pack(&ground_mb, PACK.why)?;
        }
        if !pack_heights.is_on() {
            let advice =
                "ground_mb is for elevation data of a pack; omit it, or write pack_heights = true";
            self.idle(&ground_mb, "no elevation data of a pack is used", advice)?;
            return Ok(None);
        }
        let megabytes = self.number(&ground_mb, |_, range| {
            format!("must be from {range} megabytes")
        })?;
        Ok(Some(megabytes))
    }

    /// Rejects a key that terrain ignores.
    fn only_of_the_smooth_earth(
        &self,
        earth: &RawEarth,
        surface: SurfaceKind,
    ) -> Result<(), SceneError> {
        let subdivision = earth.subdivision();
        let cells = self.subdivision(&subdivision)?;
        if cells != Subdivision::Auto && surface != SurfaceKind::Blocks {
            let advice =
                "a number of cells is for surface = \"blocks\"; leave it out, or give tolerance_px";
            return Err(self.reject(&subdivision, advice));
        }
        let visibility = earth.visibility();
        if self.choice_or(&visibility, Visibility::Conservative)? == Visibility::Paper {
            let advice = "the paper's rule loses ground behind the horizon; leave it out, or leave out elevation and surface";
            return Err(self.reject(&visibility, advice));
        }
        Ok(())
    }

    /// Existing files relative to the scene's folder.
    fn paths(
        &self,
        field: &Field<'_, Vec<toml::Spanned<RawPath>>>,
    ) -> Result<Vec<PathBuf>, SceneError> {
        let Some(given) = field.given else {
            return Ok(Vec::new());
        };
        if given.get_ref().len() > MAX_ELEVATION_FILES {
            let advice = format!("must be at most {MAX_ELEVATION_FILES} files; join some of them");
            return Err(self.reject(field, advice));
        }
        let mut paths = Vec::new();
        for given in given.get_ref() {
            let one = Field {
                table: field.table,
                key: field.key,
                of: field.of,
                given: Some(given),
                rule: (),
                notes: field.notes,
            };
            paths.push(self.existing(&one, given.get_ref(), PathKind::Set)?);
        }
        Ok(paths)
    }
}
