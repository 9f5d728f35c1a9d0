//! Sets of elevation files, given by a folder or by a name with `*` or `?`.

use super::HeightFileError;
use super::error::FileContext;
use super::vrt::vrt_files;
use crate::elevation::vrt::is_vrt;
use std::path::{Path, PathBuf};

/// Maximum number of files in a set.
pub const MAX_SET_FILES: usize = 65_536;

/// File name endings of elevation files.
const ENDINGS: [&str; 14] = [
    ".tif", ".tiff", ".png", ".nc", ".nc4", ".hgt", ".hgt.gz", ".hgt.zip", ".zip", ".asc", ".dt0",
    ".dt1", ".dt2", ".grd",
];

/// The files that a path refers to: itself, or those of a folder or of a virtual raster (`.vrt`). The last part may be a pattern: `*` matches any
/// characters, `?` matches one. The order is by name; for a virtual raster, the uppermost file is first.
///
/// # Errors
/// [`HeightFileError`] for an unreadable folder or virtual raster, for no file, and for more than [`MAX_SET_FILES`].
pub fn height_set(path: &Path) -> Result<Vec<PathBuf>, HeightFileError> {
    let name = path
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    let is_pattern = name.contains(['*', '?']) && !path.exists();
    let folder = match (path.is_dir(), is_pattern) {
        (true, _) => path,
        (false, true) => match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        },
        (false, false) if is_vrt(path) => return vrt_files(path),
        (false, false) => return Ok(vec![path.to_owned()]),
    };
    let context = FileContext::new(path);
    let unreadable = |error| FileContext::new(folder).unreadable(error);
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let of_file = entry.file_name();
        let of_file = of_file.to_string_lossy();
        let is_wanted = match is_pattern {
            true => matches(name.as_bytes(), of_file.as_bytes()) && !is_beside(&of_file),
            false => is_heights(&of_file),
        };
        if is_wanted && entry.path().is_file() {
            files.push(entry.path());
        }
        if files.len() > MAX_SET_FILES {
            return Err(context.rejected(
                format!("stands for more than {MAX_SET_FILES} files"),
                "fewer",
                "join them (`gdal_merge.py`), or give parts of them",
            ));
        }
    }
    if files.is_empty() {
        return Err(context.rejected(
            "matches no elevation file",
            format!("files whose names end in {}", ENDINGS.join(", ")),
            "correct the path, or give the files by their names",
        ));
    }
    files.sort();
    Ok(files)
}

fn is_heights(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    !name.starts_with('.') && ENDINGS.iter().any(|ending| name.ends_with(ending))
}

/// Whether a file only describes another.
fn is_beside(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    let endings = [".toml", ".aux.xml", ".msk", ".ovr", ".prj", ".tfw", ".wld"];
    name.starts_with('.') || endings.iter().any(|ending| name.ends_with(ending))
}

/// Whether a name matches a pattern. Takes at most the product of both lengths.
fn matches(pattern: &[u8], name: &[u8]) -> bool {
    let (mut p, mut n) = (0, 0);
    // Position of the last star, and the end of its shortest match.
    let mut star: Option<(usize, usize)> = None;
    while n < name.len() {
        match pattern.get(p) {
            Some(b'*') => {
                star = Some((p, n));
                p += 1;
            }
            Some(byte) if *byte == b'?' || *byte == name[n] => {
                p += 1;
                n += 1;
            }
            _ => {
                let Some((at, from)) = star else {
                    return false;
                };
                star = Some((at, from + 1));
                p = at + 1;
                n = from + 1;
            }
        }
    }
    pattern[p..].iter().all(|byte| *byte == b'*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match() {
        let fits = |pattern: &str, name: &str| matches(pattern.as_bytes(), name.as_bytes());
        for (pattern, name) in [
            ("*", ""),
            ("*.hgt", "N45E006.hgt"),
            ("N4?E*", "N45E006.hgt"),
            ("a*b*c", "aXbYbZc"),
        ] {
            assert!(fits(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in [("*.hgt", "a.hgt.gz"), ("?", ""), ("a*b", "ac"), ("", "a")] {
            assert!(!fits(pattern, name), "{pattern} {name}");
        }
        assert!(!fits(
            &"*a".repeat(64),
            &"a".repeat(4096).replace("aaaa", "aaab")
        ));
    }

    #[test]
    fn folders_and_patterns_stand_for_their_files() {
        let folder = tempfile::tempdir().expect("a folder");
        let names = [
            "N46E006.hgt",
            "N45E006.hgt",
            "N45E007.hgt.zip",
            "n45.toml",
            "n45.tif",
            "n45.tif.aux.xml",
            ".n.tif",
            "read.me",
        ];
        for name in names {
            std::fs::write(folder.path().join(name), "").expect("written");
        }
        let set = |name: &str| {
            let files = height_set(&folder.path().join(name)).map_err(|error| error.to_string())?;
            let names = files.iter().map(|file| {
                file.file_name()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned()
            });
            Ok::<_, String>(names.collect::<Vec<_>>())
        };
        let all = ["N45E006.hgt", "N45E007.hgt.zip", "N46E006.hgt", "n45.tif"];
        assert_eq!(set("").expect("files"), all);
        assert_eq!(set("N45*").expect("files"), all[..2]);
        assert_eq!(set("n45*").expect("files"), all[3..]);
        assert_eq!(set("none.tif").expect("itself"), ["none.tif"]);
        assert!(
            set("*.asc")
                .expect_err("none")
                .contains("matches no elevation file")
        );
        assert!(set("none/*.asc").expect_err("none").contains("none"));
    }
}
