//! `[earth]`: the globe, its layers and its air, and the imagery pack that they may come from. Its keys of ground with relief
//! are read in [`relief`](super::relief).

use super::error::{SceneError, printable};
use super::field::{Field, KeyText, PathKind, UNKNOWN, quoted, range_text, whole, written};
use super::keys::RawEarth;
use super::relief::{ReliefTable, relief_value};
use super::text::SceneText;
use crate::air::Atmosphere;
use crate::globe::{Figure, LevelRule, Shading, Subdivision, Visibility};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use toml::Spanned;

/// `[earth]`
#[derive(Clone, Debug, PartialEq)]
pub struct EarthTable {
    /// The Earth's figure.
    pub figure: Figure,
    /// Cells per block edge.
    pub subdivision: Subdivision,
    /// Which blocks are drawn.
    pub visibility: Visibility,
    /// How the surface is shaded.
    pub shading: Shading,
    /// Cloud layer.
    pub clouds: bool,
    /// Terrain normals.
    pub normals: bool,
    /// City lights.
    pub night_lights: bool,
    /// How the air is drawn.
    pub atmosphere: Atmosphere,
    /// Folder of the maps; `None` is the starter pack. Not looked at where there is a pack.
    pub textures: Option<PathBuf>,
    /// The imagery pack; `None` draws whole maps.
    pub pack: Option<PackTable>,
    /// Ground with relief; `None` draws the smooth ellipsoid.
    pub relief: Option<ReliefTable>,
}

/// The keys of `[earth]` that say how an imagery pack is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct PackTable {
    /// The pack's folder.
    pub folder: PathBuf,
    /// Whether the sea glints, if the pack has a water map.
    pub water: bool,
    /// How the level of a block is chosen.
    pub levels: LevelRule,
    /// `levels = "screen"`: most screen pixels that a texel may cover.
    pub texel_px: f64,
    /// Which of the pack's storages is read.
    pub storage: StorageChoice,
    /// Textures of maps and tiles, megabytes.
    pub texture_mb: f64,
    /// Tiles uploaded in one frame, megabytes.
    pub upload_mb: f64,
}

/// Which of a pack's storages is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum StorageChoice {
    /// Compressed on graphics hardware that reads it, plain on software adapters; whichever there is otherwise.
    #[default]
    Auto,
    /// Plain texels.
    Plain,
    /// BC7, BC5 and BC4.
    Bc,
}

impl SceneText<'_> {
    /// Checks `[earth]`.
    pub(super) fn earth(&self, earth: &RawEarth) -> Result<EarthTable, SceneError> {
        let shading = self.choice(&earth.shading(), Shading::default())?;
        let lights = earth.night_lights();
        let night_lights = lights.value().unwrap_or(shading == Shading::Sunlit);
        if night_lights && shading == Shading::Paper {
            let advice = "the paper's shading has no night lights; write false, leave it out, or take shading = \"sunlit\"";
            return Err(self.refuse(&lights, advice));
        }
        Ok(EarthTable {
            figure: self.choice(&earth.figure(), Figure::default())?,
            subdivision: self.subdivision(&earth.subdivision())?,
            visibility: self.choice(&earth.visibility(), Visibility::default())?,
            shading,
            clouds: earth.clouds().is_on(),
            normals: earth.normals().is_on(),
            night_lights,
            atmosphere: self.choice(&earth.atmosphere(), Atmosphere::default())?,
            textures: self.path(&earth.textures(), PathKind::Folder)?,
            pack: self.pack(earth, shading)?,
            relief: self.relief(earth)?,
        })
    }

    fn pack(&self, earth: &RawEarth, shading: Shading) -> Result<Option<PackTable>, SceneError> {
        let folder = self.path(&earth.pack(), PathKind::Folder)?;
        let (water, levels, texel_px, storage) = (
            earth.water(),
            earth.levels(),
            earth.texel_px(),
            earth.storage(),
        );
        let (texture_mb, upload_mb) = (earth.texture_mb(), earth.upload_mb());
        let Some(folder) = folder else {
            self.only_with_a_pack(&water)?;
            self.only_with_a_pack(&levels)?;
            self.only_with_a_pack(&texel_px)?;
            self.only_with_a_pack(&storage)?;
            self.only_with_a_pack(&texture_mb)?;
            self.only_with_a_pack(&upload_mb)?;
            return Ok(None);
        };
        let textures = earth.textures();
        if textures.is_given() {
            let advice = "a scene draws a folder of maps or a pack; leave out textures or pack";
            return Err(self.refuse(&textures, advice));
        }
        if shading == Shading::Paper && water.value() == Some(true) {
            let advice = "the paper's shading has no glint; write false, leave it out, or take shading = \"sunlit\"";
            return Err(self.refuse(&water, advice));
        }
        let rule = self.choice(&levels, LevelRule::default())?;
        if rule == LevelRule::Paper && texel_px.is_given() {
            let advice = "texel_px has no meaning with levels = \"paper\", where distances alone decide; leave it out or write levels = \"screen\"";
            return Err(self.refuse(&texel_px, advice));
        }
        let within =
            |unit: &'static str| move |_, range: &str| format!("must be from {range} {unit}");
        Ok(Some(PackTable {
            folder,
            water: water.value().unwrap_or(shading == Shading::Sunlit),
            levels: rule,
            texel_px: self.number(&texel_px, within("screen pixels a texel"))?,
            storage: self.choice(&storage, StorageChoice::default())?,
            texture_mb: self.number(&texture_mb, within("megabytes"))?,
            upload_mb: self.number(&upload_mb, within("megabytes a frame"))?,
        }))
    }

    /// Refuses a key that does nothing without a pack.
    pub(super) fn only_with_a_pack<T, R>(&self, field: &Field<'_, T, R>) -> Result<(), SceneError> {
        if !field.is_given() {
            return Ok(());
        }
        let advice = format!(
            "{} is for imagery packs; leave it out, or name the pack's folder by pack = \"…\"",
            field.key
        );
        Err(self.refuse(field, advice))
    }

    /// Reads the number of cells per block edge.
    pub(super) fn subdivision(
        &self,
        field: &Field<'_, toml::Value, RangeInclusive<i64>>,
    ) -> Result<Subdivision, SceneError> {
        let cells = match field.given.map(Spanned::get_ref) {
            None => return Ok(Subdivision::Auto),
            Some(toml::Value::String(text)) if text == "auto" => return Ok(Subdivision::Auto),
            Some(toml::Value::Integer(cells)) => whole(*cells, &field.rule),
            Some(_) => None,
        };
        cells.map(Subdivision::Cells).ok_or_else(|| {
            let advice = format!(
                "must be \"auto\" or from {} cells per block edge",
                range_text(&field.rule)
            );
            self.refuse(field, advice)
        })
    }
}

/// The value of a key as a scene would write it, or why it has none.
pub(super) fn value(earth: &EarthTable, key: &str) -> KeyText {
    match key {
        "figure" => quoted(&written(&earth.figure)),
        "subdivision" => match earth.subdivision {
            Subdivision::Auto => quoted("auto"),
            cells => Ok(cells.to_string()),
        },
        "visibility" => quoted(&written(&earth.visibility)),
        "shading" => quoted(&written(&earth.shading)),
        "clouds" => Ok(earth.clouds.to_string()),
        "normals" => Ok(earth.normals.to_string()),
        "night_lights" => Ok(earth.night_lights.to_string()),
        "atmosphere" => quoted(&written(&earth.atmosphere)),
        "textures" => match &earth.textures {
            Some(folder) => quoted(&folder.display().to_string()),
            None if earth.pack.is_some() => Err("the pack is taken"),
            None => Err("the starter pack is taken"),
        },
        "pack" | "water" | "levels" | "texel_px" | "storage" | "texture_mb" | "upload_mb" => {
            match &earth.pack {
                Some(pack) => pack_value(pack, key),
                None => Err("no pack: whole maps are drawn"),
            }
        }
        "surface" | "elevation" | "tolerance_px" | "sea_floor" | "denoise" | "clipmap"
        | "contours" | "projected_grid" => relief_value(earth.relief.as_ref(), key),
        _ => Err(UNKNOWN),
    }
}

/// The value of one of the pack's keys.
fn pack_value(pack: &PackTable, key: &str) -> KeyText {
    Ok(match key {
        "pack" => format!("\"{}\"", printable(&pack.folder.display().to_string())),
        "water" => pack.water.to_string(),
        "levels" => format!("\"{}\"", written(&pack.levels)),
        "texel_px" if pack.levels == LevelRule::Paper => {
            return Err("only for levels = \"screen\"");
        }
        "texel_px" => pack.texel_px.to_string(),
        "storage" => format!("\"{}\"", written(&pack.storage)),
        "texture_mb" => pack.texture_mb.to_string(),
        _ => pack.upload_mb.to_string(),
    })
}
