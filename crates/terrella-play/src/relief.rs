//! A scene's elevation data.

use super::error::PlayError;
use crate::scene::{MAX_ELEVATION_FILES, PackTable, ReliefTable};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrella::GroundOptions;
use terrella_ground::elevation::{
    Denoise, Elevation, GridLimits, Ground, HeightGrid, HeightStreamOptions, LandShares,
    StreamedGround, check_heights, height_files, height_set, open_heights_denoised,
};
use terrella_imagery::pack::Pack;
use terrella_imagery::{LayerImage, MAX_WATER_COLUMNS, find_textures, open_water};

/// Reads the elevation files that a scene names, or the starter pack's; elevation data of its imagery pack is streamed. `water` is the map of open
/// water that is drawn: it decides where land may lie below the sea.
pub(super) fn ground_options(
    table: &ReliefTable,
    pack: Option<&PackTable>,
    water: Option<WaterMap<'_>>,
) -> Result<GroundOptions, PlayError> {
    let (over, land) = std::thread::scope(|scope| {
        let water = water.filter(|_| !table.sea_floor);
        let land = scope.spawn(|| water.map_or(Ok(None), |water| water.land()));
        let over = named_heights(table).and_then(|files| read_grids(&files, table.denoise));
        (over, land.join())
    });
    let land = land.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
    let over = over_the_sea(over?, table.sea_floor, land);
    let elevation: Arc<dyn Elevation> = match (table.pack_heights_mb, pack) {
        (Some(megabytes), Some(pack)) => {
            let pack = Pack::open(&pack.folder)?;
            let tiles = pack.height_tiles()?;
            let options = HeightStreamOptions {
                memory_bytes: (1e6 * megabytes) as u64,
                ..HeightStreamOptions::default()
            };
            Arc::new(StreamedGround::new(Arc::new(tiles), over, &options)?)
        }
        _ => Arc::new(over),
    };
    Ok(GroundOptions {
        elevation,
        surface: table.settings,
        tolerance_px: table.tolerance_px,
    })
}

/// Where a scene's map of open water is.
pub(super) enum WaterMap<'m> {
    /// In a folder of maps.
    Folder(&'m Path),
    /// In memory.
    Map(&'m LayerImage),
}

impl WaterMap<'_> {
    /// The land that it leaves; `None` without a map.
    fn land(self) -> Result<Option<Arc<LandShares>>, PlayError> {
        let read;
        let map = match self {
            Self::Map(map) => map,
            Self::Folder(folder) => match open_water(folder)? {
                None => return Ok(None),
                Some(map) => {
                    read = map;
                    &read
                }
            },
        };
        let mut levels = (0..).zip(map.levels.iter());
        let level = levels.find(|(level, _)| map.level_size(*level).0 <= MAX_WATER_COLUMNS);
        let shares = level.and_then(|(level, texels)| {
            let (columns, rows) = map.level_size(level);
            LandShares::of_water(columns, rows, texels)
        });
        Ok(shares.map(Arc::new))
    }
}

/// The elevation files that a scene names; by default the starter pack's, unless its imagery pack has elevation data.
fn named_heights(table: &ReliefTable) -> Result<Vec<PathBuf>, PlayError> {
    let named = match table.pack_heights_mb {
        Some(_) => table.elevation.clone(),
        None => or_the_starter_packs(&table.elevation)?,
    };
    let sets = named.iter().map(|path| height_set(path));
    let files = sets.collect::<Result<Vec<_>, _>>()?.concat();
    match files.len() > MAX_ELEVATION_FILES {
        true => Err(PlayError::ManyHeights { count: files.len() }),
        false => Ok(files),
    }
}

fn or_the_starter_packs(files: &[PathBuf]) -> Result<Vec<PathBuf>, PlayError> {
    match files.is_empty() {
        true => Ok(vec![find_textures()?.join("elevation.png")]),
        false => Ok(files.to_owned()),
    }
}

/// The files that [`ground_options`] reads, except the tiles of a pack.
pub(super) fn relief_files(table: &ReliefTable) -> Result<Vec<PathBuf>, PlayError> {
    let named = named_heights(table)?;
    Ok(named.iter().flat_map(|file| height_files(file)).collect())
}

/// Rejects elevation files with invalid headers or sidecars.
pub(super) fn check_ground(table: &ReliefTable) -> Result<(), PlayError> {
    if table.pack_heights_mb.is_some() && table.elevation.is_empty() {
        return Ok(());
    }
    for file in &named_heights(table)? {
        check_heights(file, &GridLimits::default())?;
    }
    Ok(())
}

/// The grids of these files, or the starter pack's, layered; with `denoise`, isolated outliers are removed.
pub fn read_ground(files: &[PathBuf], sea_floor: bool, denoise: bool) -> Result<Ground, PlayError> {
    let grids = read_grids(&or_the_starter_packs(files)?, denoise)?;
    Ok(over_the_sea(grids, sea_floor, None))
}

fn read_grids(files: &[PathBuf], denoise: bool) -> Result<Vec<Arc<HeightGrid>>, PlayError> {
    let denoise = denoise.then(Denoise::default);
    let mut grids = Vec::new();
    for file in files {
        let heights = open_heights_denoised(file, &GridLimits::default(), denoise.as_ref())?;
        let stats = heights.grid.stats();
        tracing::info!(
            "elevation from {}: {:.0} to {:.0} m, {:.0} MB",
            file.display(),
            stats.range.low_m,
            stats.range.high_m,
            stats.bytes as f64 / 1e6
        );
        let holes = stats.holes - heights.around.min(stats.holes);
        if holes > 0 {
            let beneath = match (heights.around, stats.left_holes) {
                (0, left) => format!("{left} of them are filled from the data beneath"),
                _ => "large holes are filled from the data beneath".to_owned(),
            };
            let file = file.display();
            tracing::warn!("{file}: {holes} samples have no data; {beneath}");
        }
        match heights.denoised {
            Some(found) if found.replaced > 0 => tracing::warn!(
                "{}: {} outliers of up to {:.0} m were removed; {} others agree with their neighbours",
                file.display(),
                found.replaced,
                found.moved_m,
                found.kept
            ),
            Some(_) => tracing::info!("{}: no outliers", file.display()),
            None => {}
        }
        grids.push(Arc::new(heights.grid));
    }
    Ok(grids)
}

fn over_the_sea(
    grids: Vec<Arc<HeightGrid>>,
    sea_floor: bool,
    land: Option<Arc<LandShares>>,
) -> Ground {
    let ground = Ground::new(grids);
    match sea_floor {
        true => ground,
        false => ground.with_sea_surface(land),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The starter pack's elevations, ETOPO1 in cells of a sixth of a degree, and its water map.
    #[test]
    fn dry_land_below_the_sea_stays_and_the_sea_ends_at_its_coast() {
        let textures = find_textures().expect("the starter pack");
        let grids = read_grids(&or_the_starter_packs(&[]).expect("files"), false).expect("heights");
        let land = WaterMap::Folder(&textures).land().expect("a map");
        assert!(land.is_some());
        let alone = over_the_sea(grids.clone(), false, None);
        let ground = over_the_sea(grids.clone(), false, land);
        let floor = over_the_sea(grids, true, None);
        let at = |ground: &Ground, lat: f64, lon: f64| {
            ground.height_m(lat.to_radians(), lon.to_radians(), 0.0)
        };
        // Dry land, with the heights of the file: known basins, polders, deltas, and the Fens.
        for (name, lat, lon, lowest_m, highest_m) in [
            ("Turpan", 42.63, 89.56, -160.0, -80.0),
            ("the shore of the Dead Sea", 31.2, 35.42, -430.0, -200.0),
            ("Qattara", 29.44, 26.81, -140.0, -60.0),
            ("Flevoland", 52.65, 6.0, -8.0, -0.5),
            ("the delta of the Danube", 45.26, 29.27, -10.0, -2.0),
            ("the delta of the Po", 44.85, 11.95, -10.0, -0.5),
            ("the Kuban's delta", 45.3, 37.95, -10.0, -0.5),
        ] {
            let (kept_m, of_file_m) = (at(&ground, lat, lon), at(&floor, lat, lon));
            assert!(
                (kept_m - of_file_m).abs() < 0.5,
                "{name}: {kept_m} for {of_file_m}"
            );
            assert!(kept_m > lowest_m && kept_m < highest_m, "{name}: {kept_m}");
        }
        // Without the map these would be at the sea's level.
        assert_eq!(at(&alone, 45.26, 29.27), 0.0);
        // The sea, from the coast on.
        for (name, lat, lon) in [
            ("off Gaza", 31.5, 34.0),
            ("off Haarlem", 52.4, 4.2),
            ("off the Po", 44.85, 12.9),
            ("off the Danube", 44.9, 30.2),
            ("the Red Sea", 20.0, 38.5),
            ("the Dead Sea's longitude in the Gulf of Aqaba", 28.9, 34.75),
            ("the Mariana Trench", 11.3, 142.2),
        ] {
            assert_eq!(at(&ground, lat, lon), 0.0, "{name}");
            assert!(at(&floor, lat, lon) < 0.0, "{name}");
        }
        // Beds of lakes are no pits: the map has no lakes.
        for (name, lat, lon) in [
            ("Lake Superior", 47.55, -87.1),
            ("Lake Ontario", 43.51, -77.08),
        ] {
            let height_m = at(&ground, lat, lon);
            assert!((-10.0..=0.0).contains(&height_m), "{name}: {height_m}");
        }
        assert!(at(&ground, 39.11, 50.71) >= -30.0, "the Caspian Sea");
    }
}
