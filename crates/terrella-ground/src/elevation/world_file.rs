//! World files: six numbers beside a raster that give its georeference, in the unit of an unnamed system (Esri).

use std::path::{Path, PathBuf};

/// Maximum size of a world file, bytes.
pub const WORLD_FILE_BYTES: u64 = 4096;

/// Georeference of a raster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldFile {
    /// Centre of the first sample of the first row.
    pub x: f64,
    pub y: f64,
    /// Step from column to column, to the east.
    pub column: f64,
    /// Step from row to row, to the south; negative where the southern row comes first.
    pub row: f64,
}

impl WorldFile {
    /// Reads a world file.
    ///
    /// # Errors
    /// The cause, as the end of a sentence that begins with the file.
    pub fn of_text(text: &str) -> Result<Self, String> {
        let words: Vec<_> = text.split_whitespace().collect();
        let numbers = words.iter().map_while(|word| word.parse::<f64>().ok());
        let numbers: Vec<_> = numbers.filter(|number| number.is_finite()).collect();
        let [column, turn_y, turn_x, row, x, y] = numbers.as_slice() else {
            return Err(format!("has {} numbers and must have six", numbers.len()));
        };
        if *turn_x != 0.0 || *turn_y != 0.0 {
            return Err("turns its map (its second and third number are not 0)".to_string());
        }
        Ok(Self {
            x: *x,
            y: *y,
            column: *column,
            row: -row,
        })
    }

    /// Possible names of a raster's world file. The extension is two letters of the raster's plus w, the raster's plus w, or wld;
    /// also in capitals.
    pub fn names(raster: &Path) -> Vec<PathBuf> {
        let ending = raster.extension().unwrap_or_default().to_string_lossy();
        let mut letters = ending.chars();
        let mut names = vec![format!("{ending}w"), "wld".to_string()];
        if let (Some(first), Some(last)) = (letters.next(), letters.next_back()) {
            names.insert(0, format!("{first}{last}w"));
        }
        let capitals: Vec<_> = names.iter().map(|name| name.to_uppercase()).collect();
        let all = names.iter().chain(&capitals);
        all.map(|name| raster.with_extension(name)).collect()
    }

    /// The world file of a raster, if it exists.
    pub fn beside(raster: &Path) -> Option<PathBuf> {
        Self::names(raster).into_iter().find(|file| file.is_file())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_numbers_are_read_and_turned_rasters_rejected() {
        let good = WorldFile::of_text("0.5\n0\n0.0\n-0.25\r\n-179.75\n89.875\n").expect("good");
        assert_eq!(
            (good.x, good.y, good.column, good.row),
            (-179.75, 89.875, 0.5, 0.25)
        );
        let wrong = |text: &str| WorldFile::of_text(text).expect_err(text);
        assert!(wrong("0.5\n0.1\n0\n-0.5\n0\n0").contains("turns"));
        for bad in [
            "",
            "1 2 3",
            "1 0 0 -1 5 x",
            "1 0 0 -1 5 5 5",
            "1 0 0 -1 nan 5",
        ] {
            assert!(wrong(bad).contains("six"), "{bad}");
        }
    }

    #[test]
    fn names_are_the_usual_ones() {
        let names = WorldFile::names(Path::new("d/a.tif"));
        assert_eq!(
            names[..4],
            ["d/a.tfw", "d/a.tifw", "d/a.wld", "d/a.TFW"].map(PathBuf::from)
        );
        assert_eq!(WorldFile::names(Path::new("a.jpeg"))[0], Path::new("a.jgw"));
        assert_eq!(
            WorldFile::names(Path::new("a"))[..2],
            ["a.w", "a.wld"].map(PathBuf::from)
        );
    }
}
