//! Search for the starter pack.

use super::error::ImageryError;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use terrella_files::read_text;

/// Largest table of mapped files that is read, bytes.
const MAX_TABLE_BYTES: u64 = 16 << 20;

/// Names the folder of maps; comes before every other place.
pub const TEXTURES_VARIABLE: &str = "TERRELLA_TEXTURES";

/// The folder of the starter pack, from any working directory.
///
/// Looks at the environment variable `TERRELLA_TEXTURES`, then at `textures` and `../share/terrella/textures` beside
/// the executable and, on Linux, beside the shared library that contains this code. Then, with the feature `maps`, at the crate `terrella-maps` that
/// this library was built with. A folder counts if it holds a day map.
///
/// # Errors
/// [`ImageryError::FolderMissing`] if the variable is set but names no folder: a wrong setting must not be skipped
/// in silence. [`ImageryError::NotFound`] lists the places looked at.
pub fn find_textures() -> Result<PathBuf, ImageryError> {
    let programs: [fn() -> Option<PathBuf>; 2] = [|| std::env::current_exe().ok(), this_library];
    // The library is searched only where the executable has no maps.
    let programs = programs.into_iter().filter_map(|program| program());
    let folders = programs.filter_map(|program| program.parent().map(Path::to_path_buf));
    find_in(std::env::var_os(TEXTURES_VARIABLE), folders, shipped())
}

/// The file that this code was loaded from: the executable, or a shared library. The system's table of mapped files has it.
fn this_library() -> Option<PathBuf> {
    if !cfg!(target_os = "linux") {
        return None;
    }
    let address = this_library as *const () as usize;
    let table = read_text(Path::new("/proc/self/maps"), MAX_TABLE_BYTES).ok()??;
    // "55d0c8a00000-55d0c8a21000 r-xp 00000000 08:02 173521      /usr/lib/libterrella_c.so"
    table.lines().find_map(|line| {
        let (first, last) = line.split_once(' ')?.0.split_once('-')?;
        let bound = |text| usize::from_str_radix(text, 16).ok();
        if !(bound(first)?..bound(last)?).contains(&address) {
            return None;
        }
        line.find('/').map(|at| PathBuf::from(&line[at..]))
    })
}

/// The folder of `terrella-maps`.
fn shipped() -> Option<&'static Path> {
    #[cfg(feature = "maps")]
    return terrella_maps::FOLDER.map(Path::new);
    #[cfg(not(feature = "maps"))]
    None
}

fn find_in(
    variable: Option<OsString>,
    beside: impl IntoIterator<Item = PathBuf>,
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
    let beside = beside.into_iter().flat_map(|folder| {
        [
            folder.join("textures"),
            folder.join("../share/terrella/textures"),
        ]
    });
    let mut looked = Vec::new();
    for folder in beside.chain(shipped.map(Path::to_path_buf)) {
        if has_day_map(&folder) {
            return Ok(folder);
        }
        // An executable is found twice.
        if !looked.contains(&folder) {
            looked.push(folder);
        }
    }
    Err(ImageryError::NotFound { looked })
}

fn has_day_map(folder: &Path) -> bool {
    let mut names = super::load::DAY_NAMES.iter();
    names.any(|name| folder.join(name).is_file())
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
    fn an_executable_is_the_library_that_contains_this_code() {
        if cfg!(target_os = "linux") {
            let executable = std::env::current_exe().expect("a test program");
            assert_eq!(this_library(), Some(executable));
        }
    }

    #[test]
    fn the_order_is_variable_executable_share_shipped() {
        let root = tempfile::tempdir().expect("temporary folder");
        let (bin, shipped) = (root.path().join("bin"), root.path().join("maps"));
        std::fs::create_dir_all(bin.join("textures")).expect("temporary folder");

        match find_in(None, [bin.clone()], Some(&shipped)) {
            Err(ImageryError::NotFound { looked }) => assert_eq!(looked.len(), 3),
            other => panic!("{other:?}"),
        }
        match find_in(None, [bin.clone()], None) {
            Err(ImageryError::NotFound { looked }) => assert_eq!(looked.len(), 2),
            other => panic!("{other:?}"),
        }
        let source = pack(shipped.clone());
        // The empty folder beside the executable does not count.
        assert_eq!(
            find_in(None, [bin.clone()], Some(&shipped)).expect("found"),
            source
        );
        let share = pack(root.path().join("share/terrella/textures"));
        let found = find_in(None, [bin.clone()], Some(&shipped)).expect("found");
        assert_eq!(
            found.canonicalize().expect("exists"),
            share.canonicalize().expect("exists")
        );
        let beside = pack(bin.join("textures"));
        assert_eq!(
            find_in(None, [bin.clone()], Some(&shipped)).expect("found"),
            beside
        );
        let own = root.path().join("own");
        std::fs::create_dir_all(&own).expect("temporary folder");
        let variable = Some(own.clone().into_os_string());
        assert_eq!(
            find_in(variable, [bin.clone()], Some(&shipped)).expect("found"),
            own
        );
    }

    #[test]
    fn a_wrong_variable_is_an_error_not_a_fallback() {
        let root = tempfile::tempdir().expect("temporary folder");
        pack(root.path().join("textures"));
        let wrong = root.path().join("nowhere");
        let error =
            find_in(Some(wrong.into_os_string()), [], Some(root.path())).expect_err("wrong");
        assert!(matches!(error, ImageryError::FolderMissing { .. }));
        let text = error.to_string();
        assert!(
            text.contains("TERRELLA_TEXTURES") && text.contains("nowhere"),
            "{text}"
        );
    }
}
