//! The true pictures that drawn ones are compared with, each computed once for all settings that show the same.

use super::ReportError;
use super::change::SettingChange;
use std::sync::Arc;
use terrella::{Atmosphere, EarthOptions, EyeView, Shading, Sky};
use terrella_imagery::tile::TileError;
use terrella_play::Progress;
use terrella_reference::{FullMaps, Reference, ReferenceOptions, ReferencePicture, whole_maps};

/// Most bytes of maps put together of a pack's tiles, for each of at most three reference renderers.
const MAX_MAP_BYTES: u64 = 256 << 20;

/// Settings that a true image depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TruthKey {
    height_km: f64,
    shading: Shading,
    atmosphere: Atmosphere,
    /// Width and height, pixels.
    pub size: (u32, u32),
}

impl TruthKey {
    /// Of a change of the scene's options and size.
    pub fn new(
        change: &SettingChange,
        scene: &EarthOptions,
        height_km: f64,
        scene_size: (u32, u32),
    ) -> Self {
        let (mut shading, mut atmosphere) = (scene.shading, scene.atmosphere);
        match *change {
            SettingChange::Shading(other) => shading = other,
            SettingChange::Atmosphere(other) => atmosphere = other,
            _ => {}
        }
        Self {
            height_km,
            shading,
            atmosphere,
            size: change.size(scene_size),
        }
    }
}

/// Reference renderers of a scene and the pictures that they have made.
pub(super) struct TruePictures<'r> {
    /// Options of the scene's Earth, before a setting is changed.
    pub options: &'r EarthOptions,
    /// Rays along each side of a pixel.
    pub samples: u32,
    pub sky: Sky,
    pub progress: &'r dyn Progress,
    renderers: Vec<Reference>,
    pictures: Vec<(TruthKey, Arc<ReferencePicture>)>,
    /// Remarks for the reader about them, one sentence each.
    pub notes: Vec<String>,
}

impl<'r> TruePictures<'r> {
    /// None yet.
    pub fn new(
        options: &'r EarthOptions,
        samples: u32,
        sky: Sky,
        progress: &'r dyn Progress,
    ) -> Self {
        Self {
            options,
            samples,
            sky,
            progress,
            renderers: Vec::new(),
            pictures: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// The true picture of a view, computed once; `None` if that was stopped.
    pub fn picture(
        &mut self,
        key: TruthKey,
        view: &EyeView,
    ) -> Result<Option<Arc<ReferencePicture>>, ReportError> {
        if let Some((_, picture)) = self.pictures.iter().find(|(known, _)| *known == key) {
            return Ok(Some(picture.clone()));
        }
        let wanted = ReferenceOptions {
            shading: key.shading,
            atmosphere: key.atmosphere,
            ..ReferenceOptions::of(self.options, self.samples)
        };
        let known = self.renderers.iter().position(|r| *r.options() == wanted);
        let index = match known {
            Some(index) => index,
            None => {
                let Some(maps) = self.maps()? else {
                    return Ok(None);
                };
                self.renderers.push(Reference::with_maps(maps, wanted)?);
                self.renderers.len() - 1
            }
        };
        let stop = || self.progress.cancelled();
        let renderer = &self.renderers[index];
        let picture = renderer.render_unless(view, &self.sky, key.size, &|| (), &stop);
        Ok(picture.map(|picture| {
            let picture = Arc::new(picture);
            self.pictures.push((key, picture.clone()));
            picture
        }))
    }

    /// The scene's maps, which also serve settings with fewer maps; `None` if reading them was stopped.
    fn maps(&mut self) -> Result<Option<FullMaps>, ReportError> {
        let Some(tiles) = &self.options.tiles else {
            return Ok(Some(FullMaps::copied(&self.options.layers)?));
        };
        let stop = || self.progress.cancelled();
        let found = match whole_maps(tiles.source.as_ref(), MAX_MAP_BYTES, &stop) {
            Err(TileError::Cancelled) => return Ok(None),
            found => found?,
        };
        if self.notes.is_empty() {
            let coarser = found.coarser.iter();
            self.notes.extend(coarser.map(|(layer, width)| {
                format!(
                    "The true pictures have the {layer} map {width} texels wide, less than the pack has: finer ones do not \
                     fit into {} MiB.",
                    MAX_MAP_BYTES >> 20
                )
            }));
        }
        Ok(Some(found.maps))
    }
}
