//! A scene's maps: a folder of whole maps, or a pack with its tiles.

use super::error::PlayError;
use super::relief::ground_options;
use crate::gpu::BcSupport;
use crate::imagery::pack::{Pack, PackTiles};
use crate::imagery::tile::{MapLayer, Storage};
use crate::imagery::{LayerSelection, find_textures, load_layers};
use crate::scene::{EarthTable, PackTable, Scene, StorageChoice};
use crate::{EarthOptions, TileOptions};

use std::sync::Arc;

/// Loads the maps that a scene wants and no others, and gathers its options. `bc` is what the adapter does with
/// compressed textures.
pub fn earth_options(scene: &Scene, bc: BcSupport) -> Result<EarthOptions, PlayError> {
    let table = &scene.earth;
    let mut options = match &table.pack {
        Some(pack) => pack_options(scene, pack, bc)?,
        None => folder_options(table)?,
    };
    options.figure = table.figure;
    options.subdivision = table.subdivision;
    options.visibility = table.visibility;
    options.shading = table.shading;
    options.atmosphere = table.atmosphere;
    options.samples = scene.output.samples;
    options.ground = match &table.relief {
        Some(relief) => Some(ground_options(relief)?),
        None => None,
    };
    Ok(options)
}

/// Opens a scene's pack, if it has one, to see that it holds what the scene asks for. Reads no tile.
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

fn folder_options(table: &EarthTable) -> Result<EarthOptions, PlayError> {
    let folder = match &table.textures {
        Some(folder) => folder.clone(),
        None => find_textures()?,
    };
    let selection = LayerSelection {
        clouds: table.clouds,
        normals: table.normals,
        night_lights: table.night_lights,
    };
    tracing::info!("maps from {}", folder.display());
    Ok(EarthOptions::new(load_layers(&folder, selection)?))
}

fn pack_options(
    scene: &Scene,
    table: &PackTable,
    bc: BcSupport,
) -> Result<EarthOptions, PlayError> {
    let pack = Arc::new(Pack::open(&table.folder)?);
    let (storage, decode) = storage_of(&pack, table, bc)?;
    let layers = wanted_layers(scene, table, |layer| pack.manifest().layer(layer).is_some())?;
    tracing::info!(
        "tiles from {}, {}{}",
        table.folder.display(),
        storage.name(),
        if decode { ", decoded here" } else { "" }
    );
    let tiles = PackTiles::new(pack, storage, decode, &layers)?;
    let (maps, failures) = tiles.coarsest_maps()?;
    for failure in failures {
        tracing::warn!("{failure}; a finer level is drawn in its place");
    }
    let mut options = EarthOptions::new(maps);
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

/// The maps that the scene wants of a pack. One that the scene does not name is drawn if the pack has it; one that it
/// asks for by name must be there.
fn wanted_layers(
    scene: &Scene,
    table: &PackTable,
    has: impl Fn(MapLayer) -> bool,
) -> Result<Vec<MapLayer>, PlayError> {
    let earth = &scene.earth;
    let mut layers = vec![MapLayer::Day];
    for (layer, is_wanted) in [
        (MapLayer::Clouds, earth.clouds),
        (MapLayer::Normals, earth.normals),
        (MapLayer::NightLights, earth.night_lights),
        (MapLayer::Water, table.water),
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
            (true, false, None) => {
                tracing::info!("{} has no {} map", table.folder.display(), layer.name());
            }
            (false, ..) => {}
        }
    }
    Ok(layers)
}

/// Which of the storages that a pack keeps is read, and whether it is decoded before it goes to the adapter; `None` if
/// the one asked for is not kept.
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
        let layers = wanted("").expect("clouds are not asked for");
        assert_eq!(layers.len(), 4);
        let layers = wanted("water = false\nnormals = false").expect("less is wanted");
        assert_eq!(layers, [MapLayer::Day, MapLayer::NightLights]);
        let error = wanted("clouds = true").expect_err("no clouds").to_string();
        assert!(
            error.contains("scene.toml:3") && error.contains("clouds"),
            "{error}"
        );
    }
}
