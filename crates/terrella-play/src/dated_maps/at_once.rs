//! The maps of one epoch, read synchronously: the initial maps of an Earth, and those for rendering without a GPU.

use super::super::error::PlayError;
use crate::scene::{DatedLayer, DatedMaps, Scene};
use std::path::PathBuf;
use terrella::frames::Epoch;
use terrella_imagery::tile::MapLayer;
use terrella_imagery::{
    EarthLayers, ImageryError, LayerImage, LayerSelection, find_textures, load_color_map,
    load_day_map, load_grey_map,
};

/// The map that a key's maps are of.
pub(super) const fn map_layer(layer: DatedLayer) -> MapLayer {
    match layer {
        DatedLayer::Day => MapLayer::Day,
        DatedLayer::Clouds => MapLayer::Clouds,
        DatedLayer::NightLights => MapLayer::NightLights,
    }
}

/// Reads the maps of a layer.
pub(super) struct MapFiles {
    layer: DatedLayer,
    files: Vec<PathBuf>,
    /// Folder of the water map for day maps.
    folder: PathBuf,
    sea: LayerSelection,
}

impl MapFiles {
    pub fn of(scene: &Scene, maps: &DatedMaps) -> Result<Self, PlayError> {
        let folder = match (&scene.earth.textures, maps.layer) {
            (Some(folder), _) => folder.clone(),
            (None, DatedLayer::Day) => find_textures()?,
            (None, DatedLayer::Clouds | DatedLayer::NightLights) => PathBuf::new(),
        };
        Ok(Self {
            layer: maps.layer,
            files: maps.files.clone(),
            folder,
            sea: LayerSelection {
                clouds: false,
                normals: false,
                night_lights: false,
                water: scene.earth.water,
            },
        })
    }

    /// Reads some of them as a check, and keeps none.
    ///
    /// # Errors
    /// The first that cannot be used.
    pub fn check(&self, places: &[usize]) -> Result<(), ImageryError> {
        places.iter().try_for_each(|place| {
            let path = &self.files[*place];
            let map = match self.layer {
                DatedLayer::Day => load_color_map(path, "day"),
                DatedLayer::Clouds => load_grey_map(path, "clouds"),
                DatedLayer::NightLights => load_grey_map(path, "night lights"),
            };
            map.map(drop)
        })
    }

    /// One of them, by its place.
    pub fn load(&self, place: usize) -> Result<LayerImage, ImageryError> {
        let path = &self.files[place];
        match self.layer {
            DatedLayer::Day => load_day_map(path, &self.folder, self.sea),
            DatedLayer::Clouds => load_grey_map(path, "clouds"),
            DatedLayer::NightLights => load_grey_map(path, "night lights"),
        }
    }
}

/// Puts what a scene's maps with dates are at an epoch in the place of its other maps.
pub fn set_dated_layers(
    scene: &Scene,
    epoch: Epoch,
    layers: &mut EarthLayers,
) -> Result<(), PlayError> {
    for maps in &scene.earth.dated_maps {
        let files = MapFiles::of(scene, maps)?;
        let at = maps.at(epoch);
        let mut map = files.load(at.from)?;
        if at.weight > 0.0 {
            let to = files.load(at.to)?;
            map = LayerImage::between(&map, &to, at.weight as f32).ok_or_else(|| {
                PlayError::UnlikeMaps {
                    key: maps.layer.key(),
                    files: Box::new([maps.files[at.from].clone(), maps.files[at.to].clone()]),
                }
            })?;
        }
        match maps.layer {
            DatedLayer::Day => layers.day = map,
            DatedLayer::Clouds => layers.clouds = Some(map),
            DatedLayer::NightLights => layers.night_lights = Some(map),
        }
    }
    Ok(())
}
