//! Where a folder's maps have open water, for those who need no more than that.

use super::error::ImageryError;
use super::grey::GreyFile;
use super::layer::LayerImage;
use super::load::WATER_NAME;
use super::map_folder::MapFolder;
use super::mips::LevelRows;
use super::texel::TexelFormat;
use std::path::Path;

/// Widest map that [`open_water`] returns, texels: 10 km on the equator.
pub const MAX_WATER_COLUMNS: u32 = 4096;

/// The water map of a folder, without smaller levels and at most [`MAX_WATER_COLUMNS`] wide: of a wider map the first mip level that is narrow enough.
/// `None` where the folder has none.
///
/// # Errors
/// A map that fails, with its path, the cause and what to do.
pub fn open_water(folder: &Path) -> Result<Option<LayerImage>, ImageryError> {
    let folder = MapFolder::Disk(folder);
    if !folder.has(WATER_NAME) {
        return Ok(None);
    }
    let file = GreyFile::read(folder, WATER_NAME, "water")?;
    let mut narrowed = Narrowed::default();
    file.rows(|size, row| narrowed.add(size, row))?;
    Ok(Some(LayerImage {
        width: narrowed.size.0,
        height: narrowed.size.1,
        format: TexelFormat::R8Unorm,
        levels: [narrowed.texels].into(),
    }))
}

/// The first mip level that is narrow enough, from rows of level 0.
#[derive(Default)]
struct Narrowed {
    size: (u32, u32),
    texels: Vec<u8>,
    level: usize,
    /// Computes smaller levels; none are needed of a narrow map.
    rows: Option<LevelRows>,
}

impl Narrowed {
    fn add(&mut self, (columns, rows): (u32, u32), row: &[u8]) {
        if self.size == (0, 0) {
            self.level = (0..)
                .take_while(|n| columns >> n > MAX_WATER_COLUMNS)
                .count();
            self.size = ((columns >> self.level).max(1), (rows >> self.level).max(1));
            let smaller = || LevelRows::new(columns as usize, rows as usize, TexelFormat::R8Unorm);
            self.rows = (self.level > 0).then(smaller);
        }
        match &mut self.rows {
            None => self.texels.extend(row),
            Some(rows) => rows.push(row, &mut |level, row| {
                if level == self.level {
                    self.texels.extend(row);
                }
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_maps_are_means_of_squares() {
        let (columns, rows) = (8192_u32, 4_u32);
        let mut narrowed = Narrowed::default();
        for y in 0..rows {
            let row: Vec<u8> = (0..columns).map(|x| (x % 4 * 50 + y) as u8).collect();
            narrowed.add((columns, rows), &row);
        }
        assert_eq!(narrowed.size, (4096, 2));
        // Of 0, 50, 1, 51, and of 100, 150, 101, 151; below of 2, 52, 3, 53.
        assert_eq!(narrowed.texels[..2], [26, 126]);
        assert_eq!(narrowed.texels[4096..4098], [28, 128]);
        let mut narrowed = Narrowed::default();
        narrowed.add((2, 1), &[7, 9]);
        assert_eq!((narrowed.size, narrowed.texels), ((2, 1), vec![7, 9]));
    }
}
