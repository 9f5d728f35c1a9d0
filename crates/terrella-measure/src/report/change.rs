//! Sweeps of a report: one setting of a scene at a time.

use crate::EYE_HEIGHTS;
use terrella::{
    Atmosphere, EarthOptions, FrameTargets, GpuContext, LevelRule, Shading, Subdivision,
    TileOptions, Visibility,
};
use terrella_imagery::{EarthLayers, LayerImage};

/// One setting that differs from the scene's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SettingChange {
    /// None: the scene as it is.
    Scene,
    /// Cells per block edge.
    Subdivision(Subdivision),
    /// Which blocks are drawn.
    Visibility(Visibility),
    /// Whole maps without so many of their finest levels, each half as large as the one before.
    TextureLevel(u32),
    /// Tiles of a pack no coarser than so many pixels a texel.
    TexelPx(f64),
    /// How the level of a pack's tiles is chosen.
    Levels(LevelRule),
    /// Most samples of the maps' filter.
    Anisotropy(u16),
    /// Samples a pixel.
    Samples(u32),
    /// The air.
    Atmosphere(Atmosphere),
    Shading(Shading),
    /// Width and height of the picture.
    Size((u32, u32)),
}

/// Names of everything that is swept, as in the tables.
pub const PARAMETERS: [&str; 9] = [
    "subdivision",
    "visibility",
    "texture_level",
    "tile_level",
    "anisotropy",
    "samples",
    "atmosphere",
    "shading",
    "picture_size",
];

impl SettingChange {
    /// The setting's name in tables.
    pub fn parameter(&self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Subdivision(_) => "subdivision",
            Self::Visibility(_) => "visibility",
            Self::TextureLevel(_) => "texture_level",
            Self::TexelPx(_) | Self::Levels(_) => "tile_level",
            Self::Anisotropy(_) => "anisotropy",
            Self::Samples(_) => "samples",
            Self::Atmosphere(_) => "atmosphere",
            Self::Shading(_) => "shading",
            Self::Size(_) => "picture_size",
        }
    }

    /// Its value in tables.
    pub fn value(&self) -> String {
        match self {
            Self::Scene => "as it is".into(),
            Self::Subdivision(cells) => cells.to_string(),
            Self::TextureLevel(n) | Self::Samples(n) => n.to_string(),
            Self::Anisotropy(n) => n.to_string(),
            Self::Visibility(Visibility::Conservative) => "conservative".into(),
            Self::Visibility(Visibility::Paper) => "paper".into(),
            Self::TexelPx(px) => format!("{px} px"),
            Self::Levels(LevelRule::Screen) => "screen".into(),
            Self::Levels(LevelRule::Paper) => "paper".into(),
            Self::Atmosphere(Atmosphere::Billboard) => "billboard".into(),
            Self::Atmosphere(Atmosphere::None) => "none".into(),
            Self::Shading(Shading::Sunlit) => "sunlit".into(),
            Self::Shading(Shading::Paper) => "paper".into(),
            Self::Size((width, height)) => format!("{width}x{height}"),
        }
    }

    /// The options with this setting, and the others as they were.
    pub fn apply(&self, options: &EarthOptions) -> EarthOptions {
        let mut options = options.clone();
        match *self {
            Self::Scene | Self::Size(_) => {}
            Self::Subdivision(cells) => options.subdivision = cells,
            Self::Visibility(rule) => options.visibility = rule,
            Self::TextureLevel(n) => options.layers = reduced(&options.layers, n),
            Self::TexelPx(px) => alter(&mut options.tiles, |tiles| {
                (tiles.rule, tiles.max_texel_px) = (LevelRule::Screen, px);
            }),
            Self::Levels(rule) => alter(&mut options.tiles, |tiles| tiles.rule = rule),
            Self::Anisotropy(n) => options.anisotropy = n,
            Self::Samples(n) => options.samples = n,
            Self::Atmosphere(air) => options.atmosphere = air,
            Self::Shading(shading) => {
                options.shading = shading;
                // The paper has no city lights; a map that nothing reads would count in the floor.
                if shading == Shading::Paper {
                    options.layers.night_lights = None;
                }
            }
        }
        options
    }

    /// The size of its pictures.
    pub fn size(&self, scene: (u32, u32)) -> (u32, u32) {
        match *self {
            Self::Size(size) => size,
            _ => scene,
        }
    }

    /// Whether images with it show the same content as the scene's, so that their errors can be compared.
    pub fn shows_the_same(&self) -> bool {
        !matches!(self, Self::Atmosphere(_) | Self::Shading(_) | Self::Size(_))
    }
}

fn alter(tiles: &mut Option<TileOptions>, change: impl FnOnce(&mut TileOptions)) {
    if let Some(tiles) = tiles {
        change(tiles);
    }
}

/// Maps without their finest levels.
fn reduced(layers: &EarthLayers, levels: u32) -> EarthLayers {
    let drop = |image: &LayerImage| {
        let first = (levels as usize).min(image.levels.len().saturating_sub(1));
        let (width, height) = image.level_size(first);
        LayerImage {
            width,
            height,
            format: image.format,
            levels: image.levels[first..].into(),
        }
    };
    EarthLayers {
        day: drop(&layers.day),
        clouds: layers.clouds.as_ref().map(drop),
        normals: layers.normals.as_ref().map(drop),
        night_lights: layers.night_lights.as_ref().map(drop),
        water: layers.water.as_ref().map(drop),
    }
}

/// A sweep that the adapter or the scene does not allow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnavailableSweep {
    /// The setting.
    pub parameter: &'static str,
    pub why: String,
}

/// Plan of the measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepPlan {
    /// Heights of the eye, kilometres.
    pub heights_km: Vec<f64>,
    /// Those of them that pictures larger than the scene's are drawn from.
    pub large_picture_km: Vec<f64>,
    /// Settings, the scene's own first.
    pub changes: Vec<SettingChange>,
    /// Omitted sweeps.
    pub unavailable: Vec<UnavailableSweep>,
}

/// Heights of a quick report, and of the largest pictures of a full one, kilometres.
const QUICK_KM: [f64; 3] = [200.0, 2_000.0, 20_000.0];

impl SweepPlan {
    /// The sweeps of a scene that an adapter supports. `size` is that of the images.
    pub fn new(
        gpu: &GpuContext,
        options: &EarthOptions,
        size: (u32, u32),
        quick: bool,
        heights_km: Option<&[f64]>,
    ) -> Self {
        let mut unavailable = Vec::new();
        let mut changes = vec![SettingChange::Scene];
        let subdivisions: &[u32] = match quick {
            true => &[1, 3, 6, 12, 16, 24, 48],
            false => &[1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48],
        };
        changes.push(SettingChange::Subdivision(Subdivision::Auto));
        let cells = subdivisions.iter().map(|n| Subdivision::Cells(*n));
        changes.extend(cells.map(SettingChange::Subdivision));
        changes
            .extend([Visibility::Conservative, Visibility::Paper].map(SettingChange::Visibility));
        match options.tiles {
            Some(_) => {
                changes.extend([0.5, 1.0, 2.0, 4.0].map(SettingChange::TexelPx));
                changes.push(SettingChange::Levels(LevelRule::Paper));
            }
            None => {
                let levels: &[u32] = if quick { &[0, 1, 3] } else { &[0, 1, 2, 3, 4] };
                changes.extend(levels.iter().map(|n| SettingChange::TextureLevel(*n)));
            }
        }
        if gpu.is_software() {
            unavailable.push(UnavailableSweep {
                parameter: "anisotropy",
                why: "not available on this adapter: a software adapter always filters trilinearly"
                    .into(),
            });
        } else {
            changes.extend([1, 2, 4, 8, 16].map(SettingChange::Anisotropy));
        }
        if does_samples(gpu, 4) {
            changes.extend([1, 4].map(SettingChange::Samples));
        } else {
            unavailable.push(UnavailableSweep {
                parameter: "samples",
                why: "not available on this adapter: it draws one sample a pixel only".into(),
            });
        }
        changes.extend([Atmosphere::Billboard, Atmosphere::None].map(SettingChange::Atmosphere));
        changes.extend([Shading::Sunlit, Shading::Paper].map(SettingChange::Shading));
        let sizes: &[(u32, u32)] = match quick {
            true => &[(1, 2), (1, 1)],
            false => &[(1, 4), (1, 2), (1, 1), (2, 1)],
        };
        let limit = gpu.device.limits().max_texture_dimension_2d;
        let scaled = |side: u32, (up, down): (u32, u32)| (side * up / down).max(1);
        changes.extend(
            sizes
                .iter()
                .map(|part| (scaled(size.0, *part), scaled(size.1, *part)))
                .filter(|(width, height)| *width.max(height) <= limit)
                .map(SettingChange::Size),
        );
        let all = || EYE_HEIGHTS.iter().map(|height| height.height_km).collect();
        Self {
            heights_km: match (heights_km, quick) {
                (Some(heights_km), _) => heights_km.to_vec(),
                (None, true) => QUICK_KM.to_vec(),
                (None, false) => all(),
            },
            large_picture_km: heights_km.unwrap_or(&QUICK_KM).to_vec(),
            changes,
            unavailable,
        }
    }

    /// Removes every setting except the scene's own and those of `parameters`.
    pub fn keep(&mut self, parameters: &[&str]) {
        self.changes.retain(|change| {
            *change == SettingChange::Scene || parameters.contains(&change.parameter())
        });
        self.unavailable
            .retain(|sweep| parameters.contains(&sweep.parameter));
    }

    /// Heights that a change is measured from: pictures larger than the scene's take long, and are drawn from few.
    pub fn heights_of(&self, change: &SettingChange, scene: (u32, u32)) -> Vec<f64> {
        let is_large = change.size(scene).1 > scene.1;
        let wanted = |km: &&f64| !is_large || self.large_picture_km.contains(km);
        self.heights_km.iter().filter(wanted).copied().collect()
    }
}

/// Whether the device supports this sample count.
fn does_samples(gpu: &GpuContext, samples: u32) -> bool {
    [FrameTargets::COLOR, FrameTargets::DEPTH]
        .into_iter()
        .all(|format| {
            let flags = gpu.adapter.get_texture_format_features(format).flags;
            flags.sample_count_supported(samples)
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_changes_one_setting_and_names_it() {
        let day = LayerImage::from_rgba8(64, 32, vec![7; 64 * 32 * 4]).expect("a good map");
        let options = EarthOptions::new(EarthLayers {
            day,
            clouds: None,
            normals: None,
            night_lights: None,
            water: None,
        });
        let with = |change: SettingChange| change.apply(&options);
        assert_eq!(
            with(SettingChange::Subdivision(Subdivision::Cells(24))).subdivision,
            Subdivision::Cells(24)
        );
        assert_eq!(with(SettingChange::Samples(4)).samples, 4);
        assert_eq!(
            with(SettingChange::Samples(4)).subdivision,
            options.subdivision
        );
        let halved = with(SettingChange::TextureLevel(2)).layers.day;
        assert_eq!((halved.width, halved.height), (16, 8));
        halved.check().expect("all its levels are there");
        // More levels than there are: the last one stays.
        let least = with(SettingChange::TextureLevel(40)).layers.day;
        least.check().expect("one level");
        assert_eq!((least.width, least.height), (1, 1));
        for change in [
            SettingChange::Subdivision(Subdivision::Cells(1)),
            SettingChange::Size((4, 5)),
            SettingChange::Levels(LevelRule::Paper),
            SettingChange::Shading(Shading::Paper),
        ] {
            assert!(PARAMETERS.contains(&change.parameter()));
            assert!(!change.value().contains([',', '"']));
        }
    }
}
