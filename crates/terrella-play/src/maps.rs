//! A scene's maps: a folder of whole maps, or a pack with its tiles.

use super::dated_maps::set_dated_layers;
use super::error::PlayError;
use super::relief::{WaterMap, ground_options};
use crate::scene::{DatedLayer, PackTable, Scene, StartSource, StorageChoice};
use hifitime::Unit;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrella::frames::Epoch;
use terrella::internals::gpu::BcSupport;
use terrella::{
    EarthError, EarthOptions, GpuContext, MapUploader, OffscreenEarth, SurfaceLight, TileOptions,
};
use terrella_imagery::pack::{MANIFEST_FILE, Pack, PackTiles};
use terrella_imagery::tile::{MapLayer, Storage};
use terrella_imagery::{
    CityLights, DamagedLayer, EarthLayers, ImageryError, KeptInMemory, LayerSelection, MapSink,
    PLACES_FILE, SEASONS_FILE, SLOPE_EXAGGERATION, Season, find_textures, load_seasonal_layers,
    slopes_from_clouds,
};

/// Loads the maps of a scene at its start and builds its options. `bc` is the adapter's support of compressed textures.
pub fn earth_options(scene: &Scene, bc: BcSupport) -> Result<EarthOptions, PlayError> {
    earth_options_at(scene, scene.time.start, bc)
}

/// The same with the maps of an epoch, where they change with the date.
pub(super) fn earth_options_at(
    scene: &Scene,
    epoch: Epoch,
    bc: BcSupport,
) -> Result<EarthOptions, PlayError> {
    options_of(scene, epoch, bc, None)
}

/// As [`earth_options`], with maps on this device, which Earths of one program share ([`OffscreenEarth::shared_maps`]).
///
/// # Errors
/// As [`earth_options`].
pub fn shared_options(scene: &Scene, gpu: &GpuContext) -> Result<EarthOptions, PlayError> {
    let is_shared = true;
    options_on(UploadTo { gpu, is_shared }, scene, scene.time.start)
}

/// The device that maps are uploaded to while they are read.
#[derive(Clone, Copy)]
struct UploadTo<'g> {
    gpu: &'g GpuContext,
    /// Whether Earths of the program share them.
    is_shared: bool,
}

/// As [`earth_options`], with maps that are uploaded to this device while they are read, and not kept in memory.
pub(super) fn uploaded_options_at(
    scene: &Scene,
    epoch: Epoch,
    gpu: &GpuContext,
) -> Result<EarthOptions, PlayError> {
    let is_shared = false;
    options_on(UploadTo { gpu, is_shared }, scene, epoch)
}

fn options_on(to: UploadTo<'_>, scene: &Scene, epoch: Epoch) -> Result<EarthOptions, PlayError> {
    let gpu = to.gpu;
    let mut options = options_of(scene, epoch, gpu.bc_support(), Some(to))?;
    let uploaded = options.upload(&gpu.device, &gpu.queue);
    uploaded.map_err(EarthError::from)?;
    Ok(options)
}

/// Loads maps; those of a folder directly to a device, if one is given.
fn options_of(
    scene: &Scene,
    epoch: Epoch,
    bc: BcSupport,
    to: Option<UploadTo<'_>>,
) -> Result<EarthOptions, PlayError> {
    let table = &scene.earth;
    let mut options = match &table.pack {
        Some(pack) => pack_options(scene, pack, bc)?,
        None => folder_options(scene, epoch, to)?,
    };
    set_dated_layers(scene, epoch, &mut options.layers)?;
    options.figure = table.figure;
    options.subdivision = table.subdivision;
    options.visibility = table.visibility;
    options.shading = table.shading;
    options.atmosphere = table.atmosphere;
    options.air.aerosol_optical_depth = table.aerosol_optical_depth;
    if let Some(light) = table.light {
        // For a pack, the options compensate the exaggeration of its stored slopes.
        options.light = SurfaceLight {
            relief_exaggeration: light.relief_exaggeration * options.light.relief_exaggeration,
            eclipses: scene.sky.eclipses,
            ..light
        };
    }
    options.samples = scene.output.samples;
    options.exposure = scene.output.exposure;
    options.tone = scene.output.tone.open()?;
    options.bloom = scene.output.bloom;
    options.grade = scene.output.grade;
    options.ground = match &table.relief {
        Some(relief) => {
            let folder = maps_folder(scene);
            let water = match (&options.layers.water, &folder) {
                (Some(map), _) if map.has_texels() => Some(WaterMap::Map(map)),
                // It has been uploaded.
                (Some(_), Ok(folder)) => Some(WaterMap::Folder(folder)),
                _ => None,
            };
            Some(ground_options(relief, table.pack.as_ref(), water)?)
        }
        None => None,
    };
    Ok(options)
}

/// Maps that a scene wants by default but that its folder or pack lacks: they are left out. For a folder they include the file names.
///
/// # Errors
/// With `strict = true` any of them. A pack that cannot be opened. A missing folder is an error only in a strict scene: it is searched again when
/// maps are loaded.
pub(super) fn dropped_layers(scene: &Scene) -> Result<Vec<DroppedLayer>, PlayError> {
    let table = &scene.earth;
    if let Some(pack) = &table.pack {
        let folder = &pack.folder;
        let pack_on_disk = Pack::open(folder)?;
        let has = |layer| pack_on_disk.manifest().layer(layer).is_some();
        let (_, dropped) = wanted_layers(scene, pack, has)?;
        check_heights(scene, pack, &pack_on_disk)?;
        return Ok(dropped);
    }
    let folder = match (&table.textures, table.strict) {
        (Some(folder), _) => folder.clone(),
        (None, true) => find_textures()?,
        (None, false) => match find_textures() {
            Ok(folder) => folder,
            Err(_) => return Ok(Vec::new()),
        },
    };
    let (_, dropped) = selection_in(scene, &folder)?;
    Ok(dropped)
}

/// The files that [`earth_options`] reads of a scene's folder of maps or pack. Of a pack that is the manifest, which has the checksums of
/// its tiles.
pub(super) fn map_files(scene: &Scene) -> Result<Vec<PathBuf>, PlayError> {
    if let Some(pack) = &scene.earth.pack {
        return Ok(vec![pack.folder.join(MANIFEST_FILE)]);
    }
    let folder = maps_folder(scene)?;
    let (selection, _) = selection_in(scene, &folder)?;
    let mut files = selection.files_in(&folder);
    let places = folder.join(PLACES_FILE);
    files.extend((has_city_lights(scene, selection) && places.is_file()).then_some(places));
    let seasons = folder.join(SEASONS_FILE);
    files.extend((scene.earth.seasons && seasons.is_file()).then_some(seasons));
    Ok(files)
}

fn maps_folder(scene: &Scene) -> Result<PathBuf, PlayError> {
    match &scene.earth.textures {
        Some(folder) => Ok(folder.clone()),
        None => Ok(find_textures()?),
    }
}

/// A map that a scene is drawn without because it is not there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DroppedLayer {
    /// Its name, as its key.
    pub layer: &'static str,
    /// The missing item.
    pub missing: String,
}

/// The requested maps that a folder has, and those that it lacks.
fn selection_in(
    scene: &Scene,
    folder: &Path,
) -> Result<(LayerSelection, Vec<DroppedLayer>), PlayError> {
    let table = &scene.earth;
    let wanted = LayerSelection {
        clouds: table.clouds && !is_dated(scene, DatedLayer::Clouds),
        // The paper's normals are those of its clouds.
        normals: table.normals && !table.is_paper(),
        night_lights: table.night_lights && !is_dated(scene, DatedLayer::NightLights),
        water: table.water,
    };
    let missing = wanted.missing_in(folder);
    let dropped = missing.iter().map(|(layer, file)| DroppedLayer {
        layer: layer.name(),
        missing: folder.join(file).display().to_string(),
    });
    let dropped = reported(scene, dropped.collect())?;
    Ok((wanted.without(&missing), dropped))
}

/// Whether a map comes from dated files.
fn is_dated(scene: &Scene, layer: DatedLayer) -> bool {
    let maps = &scene.earth.dated_maps;
    maps.iter().any(|maps| maps.layer == layer)
}

/// Rejects maps that are not there in a strict scene.
fn reported(scene: &Scene, dropped: Vec<DroppedLayer>) -> Result<Vec<DroppedLayer>, PlayError> {
    match dropped.first() {
        Some(DroppedLayer { layer, missing }) if scene.earth.strict => {
            Err(PlayError::MissingLayer {
                scene: scene.path.clone(),
                table: "earth",
                layer,
                missing: format!("{missing} is missing"),
            })
        }
        _ => Ok(dropped),
    }
}

/// Warns of maps that are not there.
fn warn_of(dropped: &[DroppedLayer]) {
    for DroppedLayer { layer, missing } in dropped {
        tracing::warn!("{missing} is missing; {layer} is left out");
    }
}

/// Opens a scene's pack, if it has one, to check that it has the requested content. Reads no tile.
pub(super) fn check_pack(scene: &Scene) -> Result<(), PlayError> {
    let Some(table) = &scene.earth.pack else {
        return Ok(());
    };
    let pack = Pack::open(&table.folder)?;
    wanted_layers(scene, table, |layer| pack.manifest().layer(layer).is_some())?;
    storage_of(&pack, table, BcSupport::None)?;
    Ok(())
}

fn storage_of(pack: &Pack, table: &PackTable, bc: BcSupport) -> Result<(Storage, bool), PlayError> {
    let storages = &pack.manifest().storages;
    choose_storage(storages, table.storage, bc).ok_or_else(|| {
        let kept = storages.iter().map(|kept| kept.name()).collect::<Vec<_>>();
        PlayError::NoStorage {
            folder: table.folder.clone(),
            kept: kept.join(", "),
        }
    })
}

fn folder_options(
    scene: &Scene,
    epoch: Epoch,
    to: Option<UploadTo<'_>>,
) -> Result<EarthOptions, PlayError> {
    let folder = maps_folder(scene)?;
    let table = &scene.earth;
    let is_paper = table.is_paper();
    let (selection, dropped) = selection_in(scene, &folder)?;
    warn_of(&dropped);
    tracing::info!("maps from {}", folder.display());
    let city_lights = city_lights(scene, &folder, selection)?;
    let season = season(scene, epoch, &folder)?;
    let maps = SeasonalMaps {
        folder: &folder,
        selection,
        season,
    };
    let has_cloud_normals = table.normals && is_paper;
    // Normals of clouds are made from clouds in memory.
    if let Some(UploadTo { gpu, is_shared }) = to.filter(|_| !has_cloud_normals) {
        let load = || {
            let uploader = MapUploader::new(&gpu.device, &gpu.queue, table.shading);
            let layers = maps.load(scene, &uploader)?;
            let uploaded = uploader.finish().map_err(EarthError::from)?;
            Ok::<_, PlayError>((layers, uploaded))
        };
        let (layers, uploaded) = match is_shared {
            true => {
                let mut files = selection.files_in(&folder);
                files.extend(maps.season.is_some().then(|| folder.join(SEASONS_FILE)));
                let date = maps.season.is_some().then_some(epoch);
                let variant = format!("{selection:?}, {:?}, {date:?}", table.shading);
                OffscreenEarth::shared_maps(gpu, files, variant, load)?
            }
            false => load()?,
        };
        return Ok(EarthOptions {
            uploaded,
            city_lights,
            ..EarthOptions::new(layers)
        });
    }
    let mut options = EarthOptions::new(maps.load(scene, &KeptInMemory)?);
    options.city_lights = city_lights;
    if has_cloud_normals {
        take_cloud_normals(&mut options)?;
    }
    Ok(options)
}

/// City lights as points, where a scene shows detail that is smaller than its map of night lights. A damaged file is an error in a strict
/// scene, else they are left out with a warning, and the map is drawn.
fn city_lights(
    scene: &Scene,
    folder: &Path,
    selection: LayerSelection,
) -> Result<Option<Arc<CityLights>>, PlayError> {
    if !has_city_lights(scene, selection) {
        return Ok(None);
    }
    match CityLights::load(folder) {
        Err(error) if !scene.earth.strict => {
            tracing::warn!("{error}; city lights are drawn as a map");
            Ok(None)
        }
        lights => Ok(lights?),
    }
}

/// Whether a scene draws its city lights as points.
fn has_city_lights(scene: &Scene, selection: LayerSelection) -> bool {
    let has_detail = scene.earth.light.is_some_and(|light| light.detail);
    has_detail && selection.night_lights && scene.earth.relief.is_none()
}

/// Snow and sea ice at an epoch, where the scene draws them and its date is known. A damaged file is an error in a strict scene, else there are
/// none, with a warning.
fn season(scene: &Scene, epoch: Epoch, folder: &Path) -> Result<Option<Season>, PlayError> {
    let has_no_date = scene.time.start_from == StartSource::Default && epoch == scene.time.start;
    if !scene.earth.seasons || has_no_date {
        return Ok(None);
    }
    let (year, ..) = epoch.to_gregorian_utc();
    let days = (epoch - Epoch::from_gregorian_utc_at_midnight(year, 1, 1)).to_unit(Unit::Day);
    match Season::load(folder, days / 365.25) {
        Err(error @ ImageryError::Damaged { .. }) if !scene.earth.strict => {
            tracing::warn!("{error}; seasons are left out");
            Ok(None)
        }
        season => Ok(season?),
    }
}

/// Maps of a folder at a time of year.
struct SeasonalMaps<'a> {
    folder: &'a Path,
    selection: LayerSelection,
    season: Option<Season>,
}

impl SeasonalMaps<'_> {
    /// Reads them. One that is damaged is an error in a strict scene, else it is left out with a warning; the day map is needed.
    fn load(&self, scene: &Scene, sink: &dyn MapSink) -> Result<EarthLayers, PlayError> {
        let season = self.season.as_ref();
        let (layers, damaged) = load_seasonal_layers(self.folder, self.selection, season, sink)?;
        for DamagedLayer { layer, error } in damaged {
            if scene.earth.strict {
                return Err(error.into());
            }
            tracing::warn!("{error}; {} is left out", layer.name());
        }
        Ok(layers)
    }
}

/// The paper's third layer is a normal map of its clouds.
fn take_cloud_normals(options: &mut EarthOptions) -> Result<(), PlayError> {
    let layers = &mut options.layers;
    layers.normals = match &layers.clouds {
        Some(clouds) => Some(slopes_from_clouds(clouds)?),
        None => None,
    };
    Ok(())
}

fn pack_options(
    scene: &Scene,
    table: &PackTable,
    bc: BcSupport,
) -> Result<EarthOptions, PlayError> {
    let pack = Arc::new(Pack::open(&table.folder)?);
    let (storage, decode) = storage_of(&pack, table, bc)?;
    let has = |layer| pack.manifest().layer(layer).is_some();
    let (mut layers, dropped) = wanted_layers(scene, table, has)?;
    check_heights(scene, table, &pack)?;
    warn_of(&dropped);
    let is_paper = scene.earth.is_paper();
    layers.retain(|layer| *layer != MapLayer::Normals || !is_paper);
    let entry = pack.manifest().layer(MapLayer::Normals);
    // Normals that were supplied as such, not derived from elevation, are not exaggerated.
    let stored = entry.and_then(|entry| entry.exaggeration).unwrap_or(1.0);
    tracing::info!(
        "tiles from {}, {}{}",
        table.folder.display(),
        storage.name(),
        if decode { ", decoded here" } else { "" }
    );
    let tiles = PackTiles::new(pack, storage, decode, &layers)?;
    let (maps, failures) = tiles.coarsest_maps()?;
    for failure in failures {
        tracing::warn!("{failure}; a finer level is used instead");
    }
    let mut options = EarthOptions::new(maps);
    if scene.earth.normals && is_paper {
        take_cloud_normals(&mut options)?;
    }
    options.light.relief_exaggeration *= SLOPE_EXAGGERATION / stored;
    // Bounds of scene files: at most 10¹² bytes.
    let bytes = |mb: f64| (mb * 1e6) as u64;
    options.tiles = Some(TileOptions {
        rule: table.levels,
        max_texel_px: table.texel_px,
        texture_bytes: bytes(table.texture_mb),
        upload_bytes: bytes(table.upload_mb),
        ..TileOptions::new(Arc::new(tiles))
    });
    Ok(options)
}

/// The requested maps that a pack has, and those that it lacks. An explicitly requested one must exist.
fn wanted_layers(
    scene: &Scene,
    table: &PackTable,
    has: impl Fn(MapLayer) -> bool,
) -> Result<(Vec<MapLayer>, Vec<DroppedLayer>), PlayError> {
    let earth = &scene.earth;
    let mut layers = vec![MapLayer::Day];
    let mut dropped = Vec::new();
    for (layer, is_wanted) in [
        (
            MapLayer::Clouds,
            earth.clouds && !is_dated(scene, DatedLayer::Clouds),
        ),
        (MapLayer::Normals, earth.normals),
        (
            MapLayer::NightLights,
            earth.night_lights && !is_dated(scene, DatedLayer::NightLights),
        ),
        (MapLayer::Water, earth.water),
    ] {
        match (is_wanted, has(layer), scene.line("earth", layer.name())) {
            (true, true, _) => layers.push(layer),
            (true, false, Some(line)) => {
                return Err(PlayError::NoLayer {
                    scene: scene.path.clone(),
                    line,
                    layer: layer.name(),
                    folder: table.folder.clone(),
                });
            }
            (true, false, None) => dropped.push(DroppedLayer {
                layer: layer.name(),
                missing: format!("the map of the pack {}", table.folder.display()),
            }),
            (false, ..) => {}
        }
    }
    Ok((layers, reported(scene, dropped)?))
}

/// Rejects a scene that requests elevation data of a pack without any.
fn check_heights(scene: &Scene, table: &PackTable, pack: &Pack) -> Result<(), PlayError> {
    let relief = scene.earth.relief.as_ref();
    let is_wanted = relief.is_some_and(|relief| relief.pack_heights_mb.is_some());
    match scene.line("earth", "pack_heights") {
        Some(line) if is_wanted && pack.manifest().heights.is_none() => {
            Err(PlayError::NoPackHeights {
                scene: scene.path.clone(),
                line,
                folder: table.folder.clone(),
            })
        }
        _ => Ok(()),
    }
}

/// Which of a pack's storage formats is read, and whether tiles are decoded before the upload; `None` if the requested one does not exist.
fn choose_storage(
    kept: &[Storage],
    choice: StorageChoice,
    bc: BcSupport,
) -> Option<(Storage, bool)> {
    let order: &[Storage] = match choice {
        StorageChoice::Plain => &[Storage::Plain],
        StorageChoice::Bc => &[Storage::Bc],
        StorageChoice::Auto if bc == BcSupport::Fast => &[Storage::Bc, Storage::Plain],
        StorageChoice::Auto => &[Storage::Plain, Storage::Bc],
    };
    let storage = *order.iter().find(|storage| kept.contains(storage))?;
    let as_it_is = match choice {
        // Asked for: drawn as it is where that is possible at all.
        StorageChoice::Bc => bc != BcSupport::None,
        _ => bc == BcSupport::Fast,
    };
    Some((storage, storage == Storage::Bc && !as_it_is))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn storages_of(text: &str) -> Vec<Storage> {
        Storage::ALL
            .into_iter()
            .filter(|storage| text.contains(storage.name()))
            .collect()
    }

    #[test]
    fn the_adapter_chooses_the_storage() {
        use BcSupport::{Fast, None as No, Slow};
        use StorageChoice::{Auto, Bc, Plain};
        let plain = Some((Storage::Plain, false));
        let (bc, decoded) = (Some((Storage::Bc, false)), Some((Storage::Bc, true)));
        for (kept, choice, support, expected) in [
            ("plain bc", Auto, Fast, bc),
            ("plain bc", Auto, Slow, plain),
            ("plain bc", Auto, No, plain),
            ("plain", Auto, Fast, plain),
            ("bc", Auto, Slow, decoded),
            ("bc", Auto, No, decoded),
            ("bc", Bc, Slow, bc),
            ("bc", Bc, No, decoded),
            ("plain bc", Plain, Fast, plain),
            ("plain", Bc, Fast, None),
            ("bc", Plain, Fast, None),
        ] {
            let found = choose_storage(&storages_of(kept), choice, support);
            assert_eq!(found, expected, "{kept} {choice:?} {support:?}");
        }
    }

    #[test]
    fn a_layer_asked_for_by_name_must_be_there() {
        let folder = tempfile::tempdir().expect("a folder");
        let scene = |text: &str| {
            let text = format!("[earth]\npack = \".\"\n{text}");
            Scene::from_toml(&text, &folder.path().join("scene.toml")).expect("a good scene")
        };
        let wanted = |text: &str| {
            let scene = scene(text);
            let table = scene.earth.pack.clone().expect("a pack");
            wanted_layers(&scene, &table, |layer| layer != MapLayer::Clouds)
        };
        let (layers, dropped) = wanted("").expect("clouds are not asked for");
        assert_eq!(layers.len(), 4);
        assert_eq!(dropped.len(), 1);
        assert_eq!(dropped[0].layer, "clouds");
        let error = wanted("strict = true").expect_err("no clouds").to_string();
        assert!(
            error.contains("clouds") && error.contains("strict"),
            "{error}"
        );
        let (layers, _) = wanted("water = false\nnormals = false").expect("less is wanted");
        assert_eq!(layers, [MapLayer::Day, MapLayer::NightLights]);
        let error = wanted("clouds = true").expect_err("no clouds").to_string();
        assert!(
            error.contains("scene.toml:3") && error.contains("clouds"),
            "{error}"
        );
    }
}
