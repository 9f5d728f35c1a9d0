//! The files of the sky, with their names in a folder of maps.

use super::{CelestialError, CelestialOptions, StarCatalogue};
use std::path::Path;
use std::sync::Arc;
use terrella_imagery::{ImageryError, LayerImage, MapFolder, load_color_map_in};

/// The star catalogue's file in a folder of maps.
pub const STARS_FILE: &str = "stars.bin";
/// The file of the map of the Milky Way.
pub const MILKY_WAY_FILE: &str = "milky_way.jpg";
/// The file of the Moon's map.
pub const MOON_FILE: &str = "moon.jpg";

/// The parts of the sky that are drawn: everything by default.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CelestialSelection {
    /// Stars of the catalogue.
    pub stars: bool,
    /// The Milky Way.
    pub milky_way: bool,
    /// The Sun's disc.
    pub sun: bool,
    /// The Moon.
    pub moon: bool,
    /// Sunlight that lens and eye scatter around the Sun.
    pub glare: bool,
}

impl Default for CelestialSelection {
    fn default() -> Self {
        Self {
            stars: true,
            milky_way: true,
            sun: true,
            moon: true,
            glare: true,
        }
    }
}

impl CelestialSelection {
    /// Names of its files in a folder of maps: for programs that fetch the files themselves and pass them as [`MapFolder::Memory`].
    pub fn file_names(self) -> Vec<&'static str> {
        let files = [
            (self.stars, STARS_FILE),
            (self.milky_way, MILKY_WAY_FILE),
            (self.moon, MOON_FILE),
        ];
        let files = files.into_iter();
        files
            .filter_map(|(is_on, name)| is_on.then_some(name))
            .collect()
    }
}

impl CelestialOptions {
    /// Reads the selected files, star catalogue and maps, from a folder. It blocks while it reads.
    ///
    /// # Errors
    /// A file that is missing or cannot be used.
    pub fn load<'f>(
        folder: impl Into<MapFolder<'f>>,
        selection: CelestialSelection,
    ) -> Result<Self, CelestialError> {
        let folder = folder.into();
        let map = |is_on: bool, name, layer| -> Result<Option<Arc<LayerImage>>, ImageryError> {
            match is_on {
                true => Ok(Some(Arc::new(load_color_map_in(folder, name, layer)?))),
                false => Ok(None),
            }
        };
        let stars = match selection.stars {
            true => Some(Arc::new(read_stars(folder)?)),
            false => None,
        };
        Ok(Self {
            stars,
            milky_way: map(selection.milky_way, MILKY_WAY_FILE, "milky_way")?,
            sun: selection.sun,
            moon: map(selection.moon, MOON_FILE, "moon")?,
            glare: selection.glare,
            ..Self::NOTHING
        })
    }
}

fn read_stars(folder: MapFolder<'_>) -> Result<StarCatalogue, CelestialError> {
    let (path, read) = match folder {
        MapFolder::Disk(dir) => {
            let path = dir.join(STARS_FILE);
            let read = StarCatalogue::read(&path);
            (path, read)
        }
        MapFolder::Memory(files) => {
            let path = Path::new(STARS_FILE).to_owned();
            let Some(bytes) = files.get(STARS_FILE) else {
                return Err(ImageryError::Missing {
                    path,
                    layer: "stars",
                }
                .into());
            };
            (path, StarCatalogue::from_bytes(bytes))
        }
    };
    read.map_err(|error| CelestialError::Stars { path, error })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;
    use terrella_imagery::find_textures;

    #[test]
    fn files_in_memory_are_those_of_the_folder() {
        let folder = find_textures().expect("the starter maps");
        let all = CelestialSelection::default();
        let read = |name: &str| std::fs::read(folder.join(name)).expect("a file of the sky");
        let names = all.file_names();
        assert_eq!(names, [STARS_FILE, MILKY_WAY_FILE, MOON_FILE]);
        let mut files: HashMap<String, Vec<u8>> = names
            .iter()
            .map(|name| (name.to_string(), read(name)))
            .collect();
        let disk = CelestialOptions::load(&*folder, all).expect("the starter sky");
        let memory = CelestialOptions::load(&files, all).expect("the same sky");
        let stars = |options: &CelestialOptions| options.stars.clone().expect("stars");
        assert_eq!(stars(&disk), stars(&memory));
        assert!(stars(&disk).stars().len() > 5000);
        for (a, b) in [
            (&disk.moon, &memory.moon),
            (&disk.milky_way, &memory.milky_way),
        ] {
            let texels = |map: &Option<Arc<LayerImage>>| map.clone().expect("a map").levels.clone();
            assert!(texels(a) == texels(b) && !texels(a)[0].is_empty());
        }

        // Only what is selected is needed.
        files.remove(MOON_FILE);
        let without = CelestialSelection { moon: false, ..all };
        assert!(CelestialOptions::load(&files, without).is_ok());
        let error = CelestialOptions::load(&files, all).expect_err("no Moon");
        assert!(error.to_string().contains(MOON_FILE), "{error}");
        files.insert(STARS_FILE.into(), b"TRSTARS1\xff\xff\xff\xff".to_vec());
        let error = CelestialOptions::load(&files, without).expect_err("no stars");
        assert!(error.to_string().contains(STARS_FILE), "{error}");
        files.remove(STARS_FILE);
        let error = CelestialOptions::load(&files, without).expect_err("no stars");
        assert!(error.to_string().contains(STARS_FILE), "{error}");
    }
}
