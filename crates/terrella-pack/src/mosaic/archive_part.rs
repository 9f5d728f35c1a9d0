//! A file that holds tiles as a set of them.

use super::archive::{Archive, tile_name};
use super::place::{Crs, RasterPlacement};
use super::tiles::{MAX_TILE_SIDE, TileSet};
use crate::error::BuildError;
use crate::source::{Extent, FileContext, MAX_PIECE_SIDE, SourceLimits, read_extent};
use std::io::Cursor;
use std::path::Path;

/// The tiles of an archive, and their position.
///
/// # Errors
/// [`BuildError`], also if no tile can be read.
pub(super) fn archive_tiles(path: &Path) -> Result<(TileSet, RasterPlacement), BuildError> {
    let context = FileContext::new(path);
    let mut archive = Archive::open(path)?;
    let level = archive.level().clone();
    let limits = SourceLimits {
        buffer_bytes: u64::from(MAX_TILE_SIDE) * u64::from(MAX_TILE_SIDE) * 4,
    };
    let mut side = None;
    'all: for row in level.rows.clone() {
        for column in level.columns.clone() {
            let Some(bytes) = archive.tile(row, column)? else {
                continue;
            };
            let name = tile_name(path, level.level, row, column);
            // Damaged ones are left out, as among files.
            match read_extent(Cursor::new(bytes), &name, limits, Extent::Piece) {
                Ok(tile) => {
                    side = Some(tile.info().width);
                    break 'all;
                }
                Err(BuildError::Damaged { .. }) => {}
                Err(error) => return Err(error),
            }
        }
    }
    let side = side
        .filter(|side| *side <= MAX_TILE_SIDE)
        .ok_or_else(|| context.rejected("has no tile that can be read", "make it again"))?;
    let tile_deg = 360.0 / f64::from(1_u32 << level.level);
    let too_wide = level.columns.len() as u64 * u64::from(side) > u64::from(MAX_PIECE_SIDE)
        || level.rows.len() as u64 * u64::from(side) > u64::from(MAX_PIECE_SIDE);
    if too_wide {
        return Err(context.rejected(
            format!(
                "has {} x {} tiles of {side} texels at level {}",
                level.columns.len(),
                level.rows.len(),
                level.level
            ),
            "cut out a region (`pmtiles extract --bbox`) or a coarser level (`--maxzoom`)",
        ));
    }
    let place = RasterPlacement {
        crs: Crs::WebMercator,
        west_deg: -180.0 + tile_deg * f64::from(level.columns.start),
        north_deg: 180.0 - tile_deg * f64::from(level.rows.start),
        column_deg: tile_deg / f64::from(side),
        row_deg: tile_deg / f64::from(side),
    };
    let set = TileSet {
        path: path.to_owned(),
        tile_size: side,
        // At most `MAX_PIECE_SIDE`.
        width: level.columns.len() as u32 * side,
        columns: level.columns,
        rows: level.rows,
        grid_rows: 1 << level.level,
        archive_level: Some(level.level),
    };
    Ok((set, place))
}
