//! `[earth]`: the globe, its layers, its atmosphere, and its optional imagery pack. [`relief`](super::relief)
//! reads its terrain keys.

use super::choices::{Look, StorageChoice};
use super::dated_maps::{DatedLayer, DatedMaps, DatedScene};
use super::error::SceneError;
use super::field::{Field, PathKind, range_text, whole};
use super::keys::{PACK, RawEarth, SCREEN, SUNLIT};
use super::record::quoted;
use super::relief::ReliefTable;
use super::text::SceneText;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use terrella::SurfaceLight;
use terrella_ground::air::{AirOptions, Atmosphere};
use terrella_ground::globe::{Figure, LevelRule, Shading, Subdivision, Visibility};
use toml::Spanned;

/// Default with moonlight: with more, a full Moon would look like an overcast day.
const MOONLIT_NIGHT_GAIN: f64 = 4e4;

/// `[earth]`
#[derive(Clone, Debug, PartialEq)]
pub struct EarthTable {
    /// Which effects are on by default.
    pub look: Look,
    /// Whether a map that is not there rejects the scene.
    pub strict: bool,
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
    /// Open water, if the folder or the pack has its map.
    pub water: bool,
    /// How the air is drawn.
    pub atmosphere: Atmosphere,
    /// Vertical optical depth of the air's haze at 550 nm; 0 is clear air.
    pub aerosol_optical_depth: f64,
    /// The light on the surface; `None` with the paper's shading, which has its own. Eclipses are `[sky]`'s.
    pub light: Option<SurfaceLight>,
    /// Folder of the maps; `None` is the starter pack. Not looked at where there is a pack.
    pub textures: Option<PathBuf>,
    /// The imagery pack; `None` draws whole maps.
    pub pack: Option<PackTable>,
    /// Terrain; `None` draws the smooth ellipsoid.
    pub relief: Option<ReliefTable>,
    /// Maps that change with the date.
    pub dated_maps: Vec<DatedMaps>,
    /// Whether snow and sea ice are those of the time of year, if the folder has their map.
    pub seasons: bool,
}

impl EarthTable {
    /// Whether the atmosphere is drawn.
    pub fn has_air(&self) -> bool {
        self.atmosphere != Atmosphere::None
    }

    /// Whether the surface has the paper's shading.
    pub fn is_paper(&self) -> bool {
        self.shading == Shading::Paper
    }
}

/// Keys of `[earth]` about drawing an imagery pack.
#[derive(Clone, Debug, PartialEq)]
pub struct PackTable {
    /// The pack's folder.
    pub folder: PathBuf,
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

impl SceneText<'_> {
    /// Checks `[earth]`.
    pub(super) fn earth(&self, earth: &RawEarth) -> Result<EarthTable, SceneError> {
        let look = self.choice(&earth.look())?;
        let shading = match look {
            Look::Paper => Shading::Paper,
            Look::Standard | Look::Full => Shading::Sunlit,
        };
        let shading = self.choice_or(&earth.shading(), shading)?;
        let lights = earth.night_lights();
        let night_lights = lights.is_on_or(shading == Shading::Sunlit);
        if night_lights && shading == Shading::Paper {
            let advice = "the paper's shading has no night lights; write false, leave it out, or take look = \"standard\"";
            return Err(self.reject(&lights, advice));
        }
        let water = earth.water();
        if shading == Shading::Paper && water.value() == Some(true) {
            let advice = "the paper's shading has no water; write false, leave it out, or take look = \"standard\"";
            return Err(self.reject(&water, advice));
        }
        let atmosphere = self.choice(&earth.atmosphere())?;
        let aerosol = earth.aerosol_optical_depth();
        if atmosphere == Atmosphere::None {
            aerosol.note(Err("there is no air"));
        }
        let usual_aerosol = match look {
            Look::Paper => 0.0,
            Look::Standard | Look::Full => AirOptions::default().aerosol_optical_depth,
        };
        let without_textures = match earth.pack().is_given() {
            true => "the pack is taken",
            false => "the starter pack is taken",
        };
        let relief = self.relief(earth)?;
        let visibility = match (look, &relief) {
            // The paper's rule drops terrain behind the horizon.
            (Look::Paper, None) => Visibility::Paper,
            _ => Visibility::Conservative,
        };
        let mut table = EarthTable {
            aerosol_optical_depth: self.quantity_or(&aerosol, usual_aerosol)?,
            light: self.surface_light(earth, look, shading)?,
            look,
            strict: earth.strict().is_on(),
            figure: self.choice(&earth.figure())?,
            subdivision: self.subdivision(&earth.subdivision())?,
            visibility: self.choice_or(&earth.visibility(), visibility)?,
            shading,
            clouds: earth.clouds().is_on(),
            normals: earth.normals().is_on(),
            night_lights,
            water: water.is_on_or(shading == Shading::Sunlit),
            atmosphere,
            textures: self.path(&earth.textures(), PathKind::Folder, without_textures)?,
            pack: self.pack(earth, look)?,
            relief,
            dated_maps: Vec::new(),
            seasons: false,
        };
        let dated = DatedScene {
            is_paper: table.is_paper(),
            clouds: table.clouds,
            night_lights: table.night_lights,
            has_pack: table.pack.is_some(),
        };
        table.dated_maps = self.dated_maps(earth, dated)?;
        table.seasons = self.seasons(&earth.seasons(), &table)?;
        Ok(table)
    }

    fn seasons(&self, field: &Field<'_, bool>, table: &EarthTable) -> Result<bool, SceneError> {
        let is_day = |maps: &DatedMaps| maps.layer == DatedLayer::Day;
        let without = if table.is_paper() {
            "the paper's shading has no seasons"
        } else if table.pack.is_some() {
            "a pack has the snow and ice of its own maps"
        } else if table.dated_maps.iter().any(is_day) {
            "day_maps have the snow and ice of their dates"
        } else if table.relief.is_some() {
            "terrain has no ice on the sea"
        } else if !table.water {
            "without water there is no ice on the sea"
        } else {
            return Ok(field.is_on_or(true));
        };
        if field.value() == Some(true) {
            return Err(self.reject(field, format!("{without}; write false, or leave it out")));
        }
        field.note(Err(without));
        Ok(false)
    }

    fn surface_light(
        &self,
        earth: &RawEarth,
        look: Look,
        shading: Shading,
    ) -> Result<Option<SurfaceLight>, SceneError> {
        let is_full = look == Look::Full;
        if shading == Shading::Paper {
            self.only_in_sunlight(&earth.wind_m_s())?;
            self.only_in_sunlight(&earth.relief_exaggeration())?;
            self.only_in_sunlight(&earth.cloud_height_km())?;
            self.only_in_sunlight(&earth.cloud_relief_km())?;
            self.only_in_sunlight(&earth.cloud_shadows())?;
            self.only_in_sunlight(&earth.detail())?;
            self.only_in_sunlight(&earth.directional_reflectance())?;
            self.only_in_sunlight(&earth.moonlight())?;
            self.only_in_sunlight(&earth.airglow())?;
            self.only_in_sunlight(&earth.kp())?;
            self.only_in_sunlight(&earth.night_gain())?;
            return Ok(None);
        }
        let moonlight = earth.moonlight().is_on_or(is_full);
        let usual_gain = match moonlight {
            true => MOONLIT_NIGHT_GAIN,
            false => SurfaceLight::DEFAULT.night_gain,
        };
        Ok(Some(SurfaceLight {
            wind_m_s: self.quantity(&earth.wind_m_s())?,
            relief_exaggeration: self.quantity(&earth.relief_exaggeration())?,
            cloud_height_m: 1000.0 * self.quantity(&earth.cloud_height_km())?,
            cloud_relief_m: 1000.0 * self.quantity(&earth.cloud_relief_km())?,
            cloud_shadows: earth.cloud_shadows().is_on_or(is_full),
            detail: earth.detail().is_on_or(true),
            directional_reflectance: earth.directional_reflectance().is_on_or(true),
            moonlight,
            eclipses: false,
            airglow: earth.airglow().is_on_or(is_full),
            kp: self.kp(&earth.kp())?,
            night_gain: self.quantity_or(&earth.night_gain(), usual_gain)?,
            night_fades_by_day: !earth.night_gain().is_given(),
        }))
    }

    /// Reads the geomagnetic activity of the aurora; `None` without an aurora.
    fn kp(&self, field: &Field<'_, f64, RangeInclusive<f64>>) -> Result<Option<f64>, SceneError> {
        if !field.is_given() {
            field.note(Err("there is no aurora"));
            return Ok(None);
        }
        self.quantity_or(field, 0.0).map(Some)
    }

    /// Rejects a key without effect under the paper's shading.
    pub(super) fn only_in_sunlight<T, R>(&self, field: &Field<'_, T, R>) -> Result<(), SceneError> {
        let advice = format!(
            "the paper's shading has no {}; leave it out, or take look = \"standard\"",
            field.key
        );
        self.idle(field, SUNLIT.why, advice)
    }

    fn pack(&self, earth: &RawEarth, look: Look) -> Result<Option<PackTable>, SceneError> {
        let folder = self.path(
            &earth.pack(),
            PathKind::Folder,
            "no pack: maps are loaded whole",
        )?;
        let (levels, texel_px, storage) = (earth.levels(), earth.texel_px(), earth.storage());
        let (texture_mb, upload_mb) = (earth.texture_mb(), earth.upload_mb());
        let Some(folder) = folder else {
            self.only_with_a_pack(&levels, PACK.why)?;
            self.only_with_a_pack(&texel_px, PACK.why)?;
            self.only_with_a_pack(&storage, PACK.why)?;
            self.only_with_a_pack(&texture_mb, PACK.why)?;
            self.only_with_a_pack(&upload_mb, PACK.why)?;
            return Ok(None);
        };
        let textures = earth.textures();
        if textures.is_given() {
            let advice = "a scene draws a folder of maps or a pack; leave out textures or pack";
            return Err(self.reject(&textures, advice));
        }
        let rule = match look {
            Look::Paper => LevelRule::Paper,
            Look::Standard | Look::Full => LevelRule::default(),
        };
        let rule = self.choice_or(&levels, rule)?;
        if rule == LevelRule::Paper {
            let advice = "texel_px has no meaning with look = \"paper\", where distances alone decide; leave it out or take look = \"standard\"";
            self.idle(&texel_px, SCREEN.why, advice)?;
        }
        let within =
            |unit: &'static str| move |_, range: &str| format!("must be from {range} {unit}");
        Ok(Some(PackTable {
            folder,
            levels: rule,
            texel_px: self.number(&texel_px, within("screen pixels a texel"))?,
            storage: self.choice(&storage)?,
            texture_mb: self.number(&texture_mb, within("megabytes"))?,
            upload_mb: self.number(&upload_mb, within("megabytes a frame"))?,
        }))
    }

    /// Rejects a key without effect if there is no pack.
    pub(super) fn only_with_a_pack<T, R>(
        &self,
        field: &Field<'_, T, R>,
        why: &'static str,
    ) -> Result<(), SceneError> {
        let advice = format!(
            "{} is for imagery packs; leave it out, or name the pack's folder by pack = \"…\"",
            field.key
        );
        self.idle(field, why, advice)
    }

    /// Reads the number of cells per block edge.
    pub(super) fn subdivision(
        &self,
        field: &Field<'_, toml::Value, RangeInclusive<i64>>,
    ) -> Result<Subdivision, SceneError> {
        let cells = match field.given.map(Spanned::get_ref) {
            None => Some(Subdivision::Auto),
            Some(toml::Value::String(text)) if text == "auto" => Some(Subdivision::Auto),
            Some(toml::Value::Integer(cells)) => whole(*cells, &field.rule).map(Subdivision::Cells),
            Some(_) => None,
        };
        let cells = cells.ok_or_else(|| {
            let advice = format!(
                "must be \"auto\" or from {} cells per block edge",
                range_text(&field.rule)
            );
            self.reject(field, advice)
        })?;
        field.note(match cells {
            Subdivision::Auto => quoted("auto"),
            cells => Ok(cells.to_string()),
        });
        Ok(cells)
    }
}
