//! Search for the starter pack.

use super::error::ImageryError;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Names the folder of maps; comes before every other place.
pub const TEXTURES_VARIABLE: &str = "TERRELLA_TEXTURES";

/// The folder of the starter pack, from any working directory.
///
/// Looks at the environment variable `TERRELLA_TEXTURES`, then at `textures` and `../share/terrella/textures` beside
/// the executable, then, with the feature `maps`, at the crate `terrella-maps` that this library was built with. A folder counts if it holds
/// a day map.
///
/// # Errors
/// [`ImageryError::FolderMissing`] if the variable is set but names no folder: a wrong setting must not be skipped
/// in silence. [`ImageryError::NotFound`] lists the places looked at.
pub fn find_textures() -> Result<PathBuf, ImageryError> {
    let executable = std::env::current_exe().ok();
    find_in(
        std::env::var_os(TEXTURES_VARIABLE),
        executable.as_deref().and_then(Path::parent),
        shipped(),
    )
}

/// The folder of `terrella-maps`.
fn shipped() -> Option<&'static Path> {
    #[cfg(feature = "maps")]
    return Some(Path::new(terrella_maps::FOLDER));
    #[cfg(not(feature = "maps"))]
    None
}

fn find_in(
    variable: Option<OsString>,
    executable_dir: Option<&Path>,
    shipped: Option<&Path>,
) -> Result<PathBuf, ImageryError> {
    if let Some(value) = variable {
        let path = PathBuf::from(value);
        return if path.is_dir() {
            Ok(path)
        } else {
            Err(ImageryError::FolderMissing { path })
        };
    }
    let mut looked = Vec::new();
    if let Some(dir) = executable_dir {
        looked.push(dir.join("textures"));
        looked.push(dir.join("../share/terrella/textures"));
    }
    looked.extend(shipped.map(Path::to_path_buf));
    match looked.iter().find(|dir| {
        super::load::DAY_NAMES
            .iter()
            .any(|name| dir.join(name).is_file())
    }) {
        Some(dir) => Ok(dir.clone()),
        None => Err(ImageryError::NotFound { looked }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with a file in place of the day map.
    fn pack(dir: PathBuf) -> PathBuf {
        std::fs::create_dir_all(&dir).expect("temporary folder");
        std::fs::write(dir.join("day.jpg"), b"x").expect("temporary file");
        dir
    }

    #[test]
    fn the_order_is_variable_executable_share_shipped() {
        let root = tempfile::tempdir().expect("temporary folder");
        let (bin, shipped) = (root.path().join("bin"), root.path().join("maps"));
        std::fs::create_dir_all(bin.join("textures")).expect("temporary folder");

        match find_in(None, Some(&bin), Some(&shipped)) {
            Err(ImageryError::NotFound { looked }) => assert_eq!(looked.len(), 3),
            other => panic!("{other:?}"),
        }
        match find_in(None, Some(&bin), None) {
            Err(ImageryError::NotFound { looked }) => assert_eq!(looked.len(), 2),
            other => panic!("{other:?}"),
        }
        let source = pack(shipped.clone());
        // The empty folder beside the executable does not count.
        assert_eq!(
            find_in(None, Some(&bin), Some(&shipped)).expect("found"),
            source
        );
        let share = pack(root.path().join("share/terrella/textures"));
        let found = find_in(None, Some(&bin), Some(&shipped)).expect("found");
        assert_eq!(
            found.canonicalize().expect("exists"),
            share.canonicalize().expect("exists")
        );
        let beside = pack(bin.join("textures"));
        assert_eq!(
            find_in(None, Some(&bin), Some(&shipped)).expect("found"),
            beside
        );
        let own = root.path().join("own");
        std::fs::create_dir_all(&own).expect("temporary folder");
        let variable = Some(own.clone().into_os_string());
        assert_eq!(
            find_in(variable, Some(&bin), Some(&shipped)).expect("found"),
            own
        );
    }

    #[test]
    fn a_wrong_variable_is_an_error_not_a_fallback() {
        let root = tempfile::tempdir().expect("temporary folder");
        pack(root.path().join("textures"));
        let wrong = root.path().join("nowhere");
        let error =
            find_in(Some(wrong.into_os_string()), None, Some(root.path())).expect_err("wrong");
        assert!(matches!(error, ImageryError::FolderMissing { .. }));
        let text = error.to_string();
        assert!(
            text.contains("TERRELLA_TEXTURES") && text.contains("nowhere"),
            "{text}"
        );
    }
}
