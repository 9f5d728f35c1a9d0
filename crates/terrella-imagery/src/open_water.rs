//! Where a folder's maps have open water, for those who need no more than that.

use super::error::ImageryError;
use super::grey::GreyFile;
use super::layer::LayerImage;
use super::load::WATER_NAME;
use super::map_folder::MapFolder;
use super::texel::TexelFormat;
use std::path::Path;

/// Widest map that is given, texels.
const MOST_COLUMNS: u32 = 4096;

/// The water map of a folder, without smaller levels and at most 4096 texels wide: of wider ones means of 2 × 2 texels, 4 × 4 and so on.
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
    let mut sums = Sums::default();
    file.rows(|size, row| sums.add(size, row))?;
    Ok(Some(LayerImage {
        width: sums.size.0,
        height: sums.size.1,
        format: TexelFormat::R8Unorm,
        levels: [sums.texels].into(),
    }))
}

/// Means of squares of texels.
#[derive(Default)]
struct Sums {
    /// Of what is made.
    size: (u32, u32),
    texels: Vec<u8>,
    row: Vec<u32>,
    rows: u32,
}

impl Sums {
    fn add(&mut self, (columns, rows): (u32, u32), row: &[u8]) {
        let mut side = 1;
        while columns / side > MOST_COLUMNS {
            side *= 2;
        }
        self.size = ((columns / side).max(1), (rows / side).max(1));
        self.row.resize(self.size.0 as usize, 0);
        let squares = row.chunks_exact(side as usize);
        for (sum, texels) in self.row.iter_mut().zip(squares) {
            *sum += texels.iter().map(|texel| u32::from(*texel)).sum::<u32>();
        }
        self.rows += 1;
        if self.rows == side {
            let count = side * side;
            let means = self.row.iter().map(|sum| ((sum + count / 2) / count) as u8);
            self.texels.extend(means);
            self.row.fill(0);
            self.rows = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_maps_are_means_of_squares() {
        let (columns, rows) = (8192_u32, 4_u32);
        let mut sums = Sums::default();
        for y in 0..rows {
            let row: Vec<u8> = (0..columns).map(|x| (x % 4 * 50 + y) as u8).collect();
            sums.add((columns, rows), &row);
        }
        assert_eq!(sums.size, (4096, 2));
        // Of 0, 50, 1, 51, and of 100, 150, 101, 151; below of 2, 52, 3, 53.
        assert_eq!(sums.texels[..2], [26, 126]);
        assert_eq!(sums.texels[4096..4098], [28, 128]);
        let mut sums = Sums::default();
        sums.add((2, 1), &[7, 9]);
        assert_eq!((sums.size, sums.texels), ((2, 1), vec![7, 9]));
    }
}
