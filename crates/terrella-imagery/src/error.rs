//! Errors of maps, with path, cause and remedy.

use super::texel::{MAX_HEIGHT, MIN_HEIGHT, TexelFormat};
use std::fmt;
use std::path::{Path, PathBuf};

/// Errors of a map.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum ImageryError {
    /// No starter pack in any of the places looked at.
    #[error(
        "no textures found; looked for day.jpg or day.png in {}; set TERRELLA_TEXTURES to the folder that holds them",
        looked.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", ")
    )]
    NotFound {
        /// The folders looked at.
        looked: Vec<PathBuf>,
    },
    /// The environment names a folder that is not there.
    #[error(
        "TERRELLA_TEXTURES is set to {}, which is not a folder; correct it or unset it to use the starter pack",
        path.display()
    )]
    FolderMissing {
        /// Value of the variable.
        path: PathBuf,
    },
    /// A requested map is not in the folder.
    #[error("the {layer} map {} is missing{}", path.display(), Remedy { path, layer })]
    Missing {
        /// The file looked for.
        path: PathBuf,
        /// Which map it is.
        layer: &'static str,
    },
    /// The operating system rejected.
    #[error("{} could not be read: {source}; check that it is a file and its permissions", path.display())]
    Unreadable {
        path: PathBuf,
        source: std::io::Error,
    },
    /// A file of places that cannot be used.
    #[error("{}: {error}; take the file of the starter pack or remove it", path.display())]
    Places {
        path: PathBuf,
        error: super::cities::PlacesError,
    },
    /// The file is larger than any map may be.
    #[error("{} has {bytes} bytes; a map file may have at most {limit}", path.display())]
    FileTooLarge {
        path: PathBuf,
        /// Its length.
        bytes: u64,
        /// The largest size taken.
        limit: u64,
    },
    /// The map is larger than the platform can address.
    #[error(
        "{} has {width} × {height} texels, more than a program of this platform can address; use a smaller map",
        path.display()
    )]
    AddressSpace {
        path: PathBuf,
        width: u32,
        height: u32,
    },
    /// Neither PNG nor JPEG.
    #[error("{} is not an image: {cause}; a map is a PNG or JPEG file", path.display())]
    NotAnImage {
        path: PathBuf,
        /// The evidence against it.
        cause: String,
    },
    /// Not an equirectangular map of the whole Earth, or too small or large.
    #[error(
        "{} is {width} x {height} texels; a map of the whole Earth is twice as wide as high, \
         with a height from {MIN_HEIGHT} to {MAX_HEIGHT}: resample it",
        path.display()
    )]
    Size {
        path: PathBuf,
        /// Width in its header.
        width: u32,
        /// Height in its header.
        height: u32,
    },
    /// A file of seasons that cannot hold its maps.
    #[error(
        "{} is {width} x {height} texels; it holds 5 x 5 maps, so both numbers are multiples of 5: make it again",
        path.display()
    )]
    Seasons {
        path: PathBuf,
        /// Width in its header.
        width: u32,
        /// Height in its header.
        height: u32,
    },
    /// The texels are not of the kind that this map needs.
    #[error("{} holds {found} texels; the {layer} map needs {needed}: convert it", path.display())]
    TexelKind {
        path: PathBuf,
        /// Which map it is.
        layer: &'static str,
        /// The format of the file.
        found: String,
        needed: &'static str,
    },
    /// Its texels are not stored upright.
    #[error(
        "{} is stored {how} (orientation {orientation}); rotate it (`magick IN -auto-orient OUT`)",
        path.display()
    )]
    Turned {
        path: PathBuf,
        /// Orientation of its texels.
        how: &'static str,
        /// The number in the file, 2…8.
        orientation: u16,
    },
    /// It began well and then broke.
    #[error("{} is truncated or damaged: {cause}; copy or make it again", path.display())]
    Damaged {
        path: PathBuf,
        /// The decoder's words.
        cause: String,
    },
    /// Texels given in memory do not fill the stated size.
    #[error("a {width} x {height} {format:?} map needs {needed} bytes of texels and got {got}")]
    Length {
        /// Stated width.
        width: u32,
        /// Stated height.
        height: u32,
        /// Stated format.
        format: TexelFormat,
        /// Bytes (for elevations: values) required by the size.
        needed: usize,
        /// Those given.
        got: usize,
    },
    /// A map in memory has no texels or more than can be.
    #[error("a map in memory is {width} x {height} texels; it must be from 1 x 1 to {max_width} x {MAX_HEIGHT}",
        max_width = 2 * MAX_HEIGHT)]
    Dimensions {
        /// Stated width.
        width: u32,
        /// Stated height.
        height: u32,
    },
    /// A map in memory has the wrong mip levels.
    #[error(
        "mip level {level} of a {width} x {height} {format:?} map is wrong or missing; \
         make maps with LayerImage::from_rgba8, from_r8 or from_slopes"
    )]
    Levels {
        /// The first wrong level.
        level: usize,
        /// Width of level 0.
        width: u32,
        /// Height of level 0.
        height: u32,
        format: TexelFormat,
    },
}

/// Cause and remedy of a missing map.
struct Remedy<'a> {
    path: &'a Path,
    layer: &'a str,
}

impl fmt::Display for Remedy<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let folder = self.path.parent();
        let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
        if let Some(folder) = folder.filter(|folder| !folder.exists()) {
            let folder = folder.display();
            return write!(
                f,
                ": the folder {folder} does not exist; give a folder of maps"
            );
        }
        // Nothing is drawn without the day map.
        match self.layer {
            "day" => f.write_str("; add it"),
            _ => f.write_str("; add it or turn the layer off"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_map_has_the_remedy_that_fits() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let words = |path: &Path, layer| {
            let path = path.to_owned();
            ImageryError::Missing { path, layer }.to_string()
        };
        let day = words(&folder.path().join("day.jpg"), "day");
        assert!(day.ends_with("day.jpg is missing; add it"), "{day}");
        let clouds = words(&folder.path().join("clouds.png"), "clouds");
        let both = "clouds.png is missing; add it or turn the layer off";
        assert!(clouds.ends_with(both), "{clouds}");
        let nowhere = folder.path().join("nowhere");
        for layer in ["day", "clouds"] {
            let none = words(&nowhere.join("day.jpg"), layer);
            let cause = format!("the folder {} does not exist", nowhere.display());
            assert!(none.contains(&cause) && !none.contains("add it"), "{none}");
        }
        // In memory there is no folder.
        let memory = words(Path::new("day.jpg"), "day");
        assert_eq!(memory, "the day map day.jpg is missing; add it");
    }
}
