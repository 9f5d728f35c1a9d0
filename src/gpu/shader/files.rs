//! The files of `shaders/`: compiled in, or read from a folder.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::time::SystemTime;
use terrella_files::{cause, read_text};

/// Most bytes of a file in a folder.
const MOST_BYTES: u64 = 1 << 20;

/// An error in a shader file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("shaders/{file}:{line}: {problem}")]
pub struct ShaderError {
    /// The file, below `shaders/`.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    pub problem: String,
}

/// Where shader files are read from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ShaderFiles {
    /// In the program.
    Embedded,
    /// In a folder, by the same names.
    Folder(PathBuf),
}

impl ShaderFiles {
    /// The folder in the environment variable `TERRELLA_SHADERS`. Without it, a debug build uses the folder it was compiled from, if it still
    /// exists, and a release build uses the embedded files.
    pub fn chosen() -> Self {
        let own = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders"));
        match std::env::var_os("TERRELLA_SHADERS") {
            Some(folder) => Self::Folder(folder.into()),
            None if cfg!(debug_assertions) && own.is_dir() => Self::Folder(own.into()),
            None => Self::Embedded,
        }
    }

    /// The name and the text of a file; `None` if no shader has one of this name.
    pub(super) fn file(
        &self,
        name: &str,
    ) -> Result<Option<(&'static str, Cow<'static, str>)>, ShaderError> {
        let Some((name, embedded)) = FILES.iter().find(|(known, _)| *known == name) else {
            return Ok(None);
        };
        let text = match self {
            Self::Embedded => Cow::Borrowed(*embedded),
            Self::Folder(folder) => {
                let unreadable = |problem| ShaderError {
                    file: (*name).to_owned(),
                    line: 0,
                    problem,
                };
                match read_text(&folder.join(name), MOST_BYTES) {
                    Ok(Some(text)) => Cow::Owned(text),
                    Ok(None) => return Err(unreadable(format!("more than {MOST_BYTES} bytes"))),
                    Err(error) => {
                        let (folder, cause) = (folder.display(), cause(error));
                        let problem = format!("cannot be read from {folder}: {cause}");
                        return Err(unreadable(problem));
                    }
                }
            }
        };
        Ok(Some((name, text)))
    }

    /// The names and texts of files that differ from the embedded ones.
    ///
    /// # Errors
    /// The first file that cannot be read.
    pub fn changed(&self) -> Result<Vec<(&'static str, String)>, ShaderError> {
        let mut changed = Vec::new();
        for (name, embedded) in FILES {
            if let Some((name, text)) = self.file(name)?
                && text != *embedded
            {
                changed.push((name, text.into_owned()));
            }
        }
        Ok(changed)
    }

    /// Modification time of each file of a folder, if it exists: an edit changes the result. Embedded files have none.
    pub fn written(&self) -> Vec<Option<SystemTime>> {
        let Self::Folder(folder) = self else {
            return Vec::new();
        };
        let written = |(name, _): &(&str, &str)| folder.join(name).metadata()?.modified();
        FILES.iter().map(|file| written(file).ok()).collect()
    }
}

#[cfg(not(target_arch = "wasm32"))]
macro_rules! text {
    ($path:expr) => {
        include_str!($path)
    };
}

/// Without comments: browsers load it.
#[cfg(target_arch = "wasm32")]
macro_rules! text {
    ($path:expr) => {{
        const TEXT: &str = include_str!($path);
        const LENGTH: usize = without_comments::<{ TEXT.len() }>(TEXT).1;
        const CODE: [u8; LENGTH] = without_comments(TEXT).0;
        match std::str::from_utf8(&CODE) {
            Ok(code) => code,
            Err(_) => TEXT,
        }
    }};
}

/// WGSL without comments, and its length, for which there must be room. Lines keep their numbers.
#[cfg(any(test, target_arch = "wasm32"))]
const fn without_comments<const N: usize>(text: &str) -> ([u8; N], usize) {
    let text = text.as_bytes();
    let (mut code, mut length) = ([0; N], 0);
    let (mut at, mut is_comment) = (0, false);
    while at < text.len() {
        let begins = text[at] == b'/' && at + 1 < text.len() && text[at + 1] == b'/';
        is_comment = text[at] != b'\n' && (is_comment || begins);
        if !is_comment {
            code[length] = text[at];
            length += 1;
        }
        at += 1;
    }
    (code, length)
}

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        /// Name below `shaders/` and text of each shader file.
        pub const FILES: &[(&str, &str)] = &[
            $(($name, text!(concat!("../../../shaders/", $name)))),*
        ];
    };
}

files![
    "air.wgsl",
    "air_view.wgsl",
    "bloom.wgsl",
    "celestial.wgsl",
    "celestial/ghosts.wgsl",
    "celestial/glare.wgsl",
    "celestial/milky_way.wgsl",
    "celestial/moon.wgsl",
    "celestial/stars.wgsl",
    "celestial/sun.wgsl",
    "common/air.wgsl",
    "common/air/airglow.wgsl",
    "common/air/aurora.wgsl",
    "common/air/coordinates.wgsl",
    "common/air/eclipsed.wgsl",
    "common/air/inside.wgsl",
    "common/air/outside.wgsl",
    "common/air/uniforms.wgsl",
    "common/air/view_spacing.wgsl",
    "common/color.wgsl",
    "common/displayed.wgsl",
    "common/eclipse.wgsl",
    "common/frame.wgsl",
    "common/map_uv.wgsl",
    "common/moon_shadow.wgsl",
    "common/ray.wgsl",
    "common/whole_target.wgsl",
    "craft.wgsl",
    "craft_model.wgsl",
    "develop.wgsl",
    "earth.wgsl",
    "earth/bindings.wgsl",
    "earth/blocks.wgsl",
    "earth/city_lights.wgsl",
    "earth/clouds_around.wgsl",
    "earth/clouds_at_limb.wgsl",
    "earth/clouds_overhead.wgsl",
    "earth/fragment.wgsl",
    "earth/maps.wgsl",
    "earth/shading/air_above_clouds.wgsl",
    "earth/shading/air_at_vertices.wgsl",
    "earth/shading/air_before.wgsl",
    "earth/shading/cloud_cover.wgsl",
    "earth/shading/clouds.wgsl",
    "earth/shading/clouds_from_below.wgsl",
    "earth/shading/detail.wgsl",
    "earth/shading/detail_tiles.wgsl",
    "earth/shading/directional.wgsl",
    "earth/shading/lamps.wgsl",
    "earth/shading/land_detail.wgsl",
    "earth/shading/light.wgsl",
    "earth/shading/night_lights.wgsl",
    "earth/shading/open_water.wgsl",
    "earth/shading/paper.wgsl",
    "earth/shading/sea.wgsl",
    "earth/shading/sunlit.wgsl",
    "earth/shading/uneven.wgsl",
    "earth/surface_normal.wgsl",
    "earth/surface_point.wgsl",
    "earth/surface_point/contour_tree.wgsl",
    "earth/surface_point/on_relief.wgsl",
    "earth/surface_point/on_whole_map.wgsl",
    "earth/surface_point/ray_on_ellipsoid.wgsl",
    "earth/varying.wgsl",
    "earth/vertex/block_lattice.wgsl",
    "earth/vertex/contour_prisms.wgsl",
    "earth/vertex/projected_grid.wgsl",
    "earth/vertex/relief_patches.wgsl",
    "glow.wgsl",
    "map_fade.wgsl",
    "tracks.wgsl",
    "tracks/fills.wgsl",
    "tracks/lines.wgsl",
    "tracks/marks.wgsl",
    "tracks/polygons.wgsl",
    "upscale.wgsl",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_go_and_lines_stay() {
        const TEXT: &str = "// Why.\nlet a = b / c; // ½\n\n    // So.\nlet d = 1;";
        let (code, length) = without_comments::<{ TEXT.len() }>(TEXT);
        assert_eq!(
            std::str::from_utf8(&code[..length]),
            Ok("\nlet a = b / c; \n\n    \nlet d = 1;")
        );
        for (name, text) in FILES {
            assert!(!text.contains("/*"), "{name} has a comment of another kind");
        }
    }
}
