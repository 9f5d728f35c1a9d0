//! A build shared by several processes: each makes some columns of blocks of a map, and [`super::build`] then finds all tiles and writes the
//! manifest. The output does not depend on the assignment of shares.

use super::folder::{BuildFolder, Disk};
use super::{BuildError, BuildOptions, BuildProgress, Division, Prepared, run};
use std::ops::Range;
use terrella_ground::globe::COLUMNS;
use terrella_imagery::tile::MapLayer;

/// Some columns of blocks of a map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BuildShare {
    /// The map.
    pub layer: MapLayer,
    /// Its columns of blocks, from the west, 16 in all.
    pub columns: Range<u32>,
    /// Approximate cost: the texels of its tiles, of all levels, times the cost of a texel of its map.
    pub cost: u64,
    /// Tiles of it that are not there yet.
    pub missing: u64,
}

/// A build divided into shares.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SharesPlan {
    /// Those of which a tile is missing, the costliest first.
    pub shares: Vec<BuildShare>,
    /// Tiles of the whole pack.
    pub tiles: u64,
}

/// Approximate cost of a map's texel relative to one of water: measured for the starter maps, 10 to 14 ns, in plain, compressed and both kinds of
/// tiles. Colours cost 5, 12 and 11 times that.
fn texel_cost(layer: MapLayer) -> u64 {
    match layer {
        MapLayer::Day => 10,
        MapLayer::Normals => 5,
        MapLayer::Clouds | MapLayer::NightLights => 3,
        MapLayer::Water => 1,
    }
}

impl BuildShare {
    /// Its name among the shares of the build.
    fn name(&self) -> String {
        let Range { start, end } = self.columns;
        format!("{}-{start}-{end}", self.layer.name())
    }
}

/// Begins a build, or continues with one that was stopped, that `workers` processes work at. With [`BuildOptions::restart`] what is there is thrown
/// away; the shares are then made with the same options without it.
///
/// # Errors
/// As [`super::build`].
pub fn begin_shares(
    options: &BuildOptions,
    workers: u32,
    progress: &dyn BuildProgress,
) -> Result<SharesPlan, BuildError> {
    let prepared = Prepared::of(options, progress, Division::default())?;
    let fingerprint = &prepared.fingerprint;
    let folder = BuildFolder::open(&options.out, fingerprint, options.restart, &Disk)?;
    let cost = |map: &super::Map<'_>, columns: u64| {
        let shapes = map.levels.iter();
        let block: u64 = shapes
            .map(|shape| u64::from(shape.block_pixels()).pow(2))
            .sum();
        block * columns * u64::from(terrella_ground::globe::ROWS) * texel_cost(map.layer)
    };
    let all: u64 = prepared
        .maps
        .iter()
        .map(|map| cost(map, u64::from(COLUMNS)))
        .sum();
    let (mut shares, mut tiles) = (Vec::new(), 0);
    for map in &prepared.maps {
        // A share reads all of its map: there are as many as keep every worker busy, and no more.
        let whole = cost(map, u64::from(COLUMNS));
        let due = (whole * u64::from(workers)).div_ceil(all.max(1));
        let count = (due.clamp(1, u64::from(COLUMNS)) as u32).next_power_of_two();
        let width = COLUMNS / count.min(COLUMNS);
        for start in (0..COLUMNS).step_by(width as usize) {
            let columns = start..start + width;
            let job = prepared.job(map, columns.clone(), &options.storages, &folder, progress);
            let missing = job.missing_tiles();
            let of_block = job
                .levels
                .iter()
                .map(|shape| u64::from(shape.tiles_of_block()));
            tiles += of_block.sum::<u64>()
                * u64::from(width * terrella_ground::globe::ROWS)
                * options.storages.len() as u64;
            if missing > 0 {
                let cost = cost(map, u64::from(width));
                let layer = map.layer;
                shares.push(BuildShare {
                    layer,
                    columns,
                    cost,
                    missing,
                });
            }
        }
    }
    shares.sort_by_key(|share| std::cmp::Reverse(share.cost));
    Ok(SharesPlan { shares, tiles })
}

/// Makes the tiles of a share that are not there, beside other processes that make other shares. Answers how many there were to make.
///
/// # Errors
/// As [`super::build`]; a share that another process makes.
pub fn build_share(
    options: &BuildOptions,
    share: &BuildShare,
    progress: &dyn BuildProgress,
) -> Result<u64, BuildError> {
    let is_there = share.columns.start < share.columns.end && share.columns.end <= COLUMNS;
    let prepared = Prepared::of(options, progress, Division::default())?;
    let map = prepared.maps.iter().find(|map| map.layer == share.layer);
    let (Some(map), true) = (map, is_there) else {
        return Err(BuildError::Option {
            option: "share",
            cause: format!("there is no {}", share.name()),
        });
    };
    let fingerprint = &prepared.fingerprint;
    let folder = BuildFolder::open_share(&options.out, fingerprint, &share.name(), &Disk)?;
    let columns = share.columns.clone();
    let job = prepared.job(map, columns, &options.storages, &folder, progress);
    let missing = job.missing_tiles();
    run(&job)?;
    folder.sync()?;
    Ok(missing)
}
