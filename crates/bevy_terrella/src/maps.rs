//! Sources of the Earth's maps, and reading them.

#[cfg(feature = "celestial")]
use crate::EarthCelestial;
use crate::EarthFault;
use bevy::asset::io::AssetReaderError;
use bevy::asset::{AssetPath, AssetServer};
use bevy::tasks::futures_lite::AsyncReadExt;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;
#[cfg(feature = "celestial")]
use terrella::celestial::{CelestialOptions, CelestialSelection};
use terrella::{
    CityLights, EarthLayers, LayerSelection, MapFolder, MapUploader, PLACES_FILE, Shading,
    UploadedMaps, find_textures, load_layers_to, wgpu,
};

/// Maximum bytes of all files read from Bevy's assets for one Earth.
const MAX_ASSET_BYTES: u64 = 1 << 30;

/// Source of the Earth's maps.
#[derive(Clone, Debug)]
pub enum EarthMaps {
    /// The starter maps, located by [`find_textures`]; read each time an Earth is built.
    Found(LayerSelection),
    /// A folder of maps; read each time an Earth is built.
    Folder(PathBuf, LayerSelection),
    /// A folder of Bevy's assets, from any source of the [`AssetServer`] (`"earth"`, `"embedded://my_game/earth"`). It is read each time an
    /// Earth is built. The files have the names of those in the repository's `textures`, without processing.
    Assets(AssetPath<'static>, LayerSelection),
    /// Maps in memory.
    Memory(Arc<EarthLayers>),
}

impl Default for EarthMaps {
    fn default() -> Self {
        Self::Found(LayerSelection::default())
    }
}

impl EarthMaps {
    /// A folder of Bevy's assets, with all maps that the library draws by default.
    pub fn assets(folder: impl Into<AssetPath<'static>>) -> Self {
        Self::Assets(folder.into(), LayerSelection::default())
    }
}

/// Maps that were read for an Earth.
pub(crate) struct ReadMaps {
    pub layers: EarthLayers,
    pub uploaded: UploadedMaps,
    pub city_lights: Option<Arc<CityLights>>,
    #[cfg(feature = "celestial")]
    pub celestial: Option<CelestialOptions>,
}

/// Files to read besides the Earth's layers.
#[derive(Clone, Copy, Default)]
pub(crate) struct Beside {
    pub city_lights: bool,
    #[cfg(feature = "celestial")]
    pub celestial: Option<EarthCelestial>,
}

/// A folder, or the contents of its files.
enum Files {
    Disk(PathBuf),
    Memory(HashMap<String, Vec<u8>>),
}

impl Files {
    fn folder(&self) -> MapFolder<'_> {
        match self {
            Self::Disk(folder) => folder.as_path().into(),
            Self::Memory(files) => files.into(),
        }
    }
}

/// Reads maps and uploads them at the same time. Slow.
pub(crate) async fn read(
    maps: &EarthMaps,
    beside: Beside,
    shading: Shading,
    assets: Option<&AssetServer>,
    (device, queue): (&wgpu::Device, &wgpu::Queue),
) -> Result<ReadMaps, EarthFault> {
    let (files, selection) = match maps {
        EarthMaps::Found(selection) => (Files::Disk(find_textures()?), *selection),
        EarthMaps::Folder(folder, selection) => (Files::Disk(folder.clone()), *selection),
        EarthMaps::Assets(folder, selection) => {
            let assets = assets.ok_or(EarthFault::NoAssets)?;
            let files = read_assets(assets, folder, &file_names(*selection, beside)).await?;
            (Files::Memory(files), *selection)
        }
        EarthMaps::Memory(layers) => {
            return Ok(ReadMaps {
                layers: EarthLayers::clone(layers),
                uploaded: UploadedMaps::default(),
                city_lights: None,
                // Maps in memory do not include the sky.
                #[cfg(feature = "celestial")]
                celestial: match beside.celestial {
                    Some(sky) => Some(sky.options(find_textures()?.as_path().into())?),
                    None => None,
                },
            });
        }
    };
    let folder = files.folder();
    let uploader = MapUploader::new(device, queue, shading);
    let (layers, damaged) = load_layers_to(folder, selection, &uploader)?;
    if let Some(damaged) = damaged.into_iter().next() {
        return Err(damaged.error.into());
    }
    let city_lights = match beside.city_lights && selection.night_lights {
        true => CityLights::load(folder)?,
        false => None,
    };
    Ok(ReadMaps {
        layers,
        uploaded: uploader.finish().map_err(terrella::EarthError::from)?,
        city_lights,
        #[cfg(feature = "celestial")]
        celestial: match beside.celestial {
            Some(sky) => Some(sky.options(folder)?),
            None => None,
        },
    })
}

/// Names of all files that may be needed.
fn file_names(selection: LayerSelection, beside: Beside) -> Vec<&'static str> {
    let mut names = selection.file_names();
    if beside.city_lights && selection.night_lights {
        names.push(PLACES_FILE);
    }
    #[cfg(feature = "celestial")]
    if let Some(sky) = beside.celestial {
        names.extend(CelestialSelection::from(sky).file_names());
    }
    names
}

/// The files among these names that exist in an asset folder.
async fn read_assets(
    assets: &AssetServer,
    folder: &AssetPath<'static>,
    names: &[&str],
) -> Result<HashMap<String, Vec<u8>>, EarthFault> {
    let fault = |cause: String| EarthFault::Assets {
        folder: folder.to_string(),
        cause,
    };
    let source = assets.get_source(folder.source().clone_owned());
    let reader = source.map_err(|error| fault(error.to_string()))?.reader();
    let mut files = HashMap::new();
    let mut left = MAX_ASSET_BYTES;
    for name in names {
        let path = folder.path().join(name);
        let opened = match reader.read(&path).await {
            Err(AssetReaderError::NotFound(_)) => continue,
            opened => opened.map_err(|error| fault(error.to_string()))?,
        };
        let mut contents = Vec::new();
        let read = opened.take(left + 1).read_to_end(&mut contents).await;
        read.map_err(|error| fault(format!("{}: {error}", path.display())))?;
        left = left
            .checked_sub(contents.len() as u64)
            .ok_or_else(|| fault(format!("its maps have more than {MAX_ASSET_BYTES} bytes")))?;
        files.insert((*name).to_owned(), contents);
    }
    if files.is_empty() {
        return Err(fault(format!("it has none of {}", names.join(", "))));
    }
    Ok(files)
}
