//! Output files that are either complete or absent.
//!
//! A file is written under a temporary name in its own folder, synced, and renamed when it is complete. Its final name thus never refers to a
//! partial file, whatever stops the program or the machine. The temporary file is created before anything is drawn: an unwritable folder is
//! detected immediately and not after an hour.

use image::{ImageEncoder, RgbaImage};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::TempPath;
use terrella_files::Unfinished;
use terrella_files::durable;

/// Why something cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum OutputError {
    /// The file name has the extension of another format.
    #[error("{}: {what} are written as .{extension}; name it {}{}", path.display(), path.with_extension(extension).display(), format_advice(path, what, extension))]
    Extension {
        /// The requested name.
        path: PathBuf,
        /// The content.
        what: &'static str,
        extension: &'static str,
    },
    /// A light file without a known extension.
    #[error(
        "{}: radiance is written as .npy (NumPy) or .exr (OpenEXR); name it {} or {}",
        path.display(), path.with_extension("npy").display(), path.with_extension("exr").display()
    )]
    RadianceName { path: PathBuf },
    /// A raw frame without a known extension.
    #[error(
        "{}: raw frames are written as .png (16 bits), .tiff or .npy (NumPy); name it {}",
        path.display(), path.with_extension("png").display()
    )]
    RawName { path: PathBuf },
    /// The path is taken by something that is not a file.
    #[error("{}: cannot be written: {found} of that name already exists; choose another name", path.display())]
    InTheWay {
        path: PathBuf,
        /// The object at the path that is not a file.
        found: &'static str,
    },
    /// A file of an earlier run cannot be read.
    #[error("{}: {source}; move it away, or give another folder", path.display())]
    Read {
        path: PathBuf,
        source: std::io::Error,
    },
    /// A file of that name is write-protected.
    #[error("{}: cannot be written: the file there is write-protected; choose another name or allow writing", path.display())]
    Protected { path: PathBuf },
    /// The system rejects.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The disk is full.
    #[error("{}: cannot be written: {source}; free some space. Finished files are kept, and `terrella play --resume` renders the missing frames", path.display())]
    Full {
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A picture could not be put into its format.
    #[error("{}: the image could not be encoded: {source}", path.display())]
    NotEncoded {
        path: PathBuf,
        /// Error of the encoder.
        source: std::io::Error,
    },
    /// A picture could not be encoded.
    #[error("{}: the image could not be encoded: {source}", path.display())]
    Encode {
        path: PathBuf,
        /// Error of the encoder.
        source: image::ImageError,
    },
}

impl OutputError {
    /// For an error of the system with a file or folder.
    pub fn write(path: &Path, source: std::io::Error) -> Self {
        use std::io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
        let path = path.to_owned();
        match source.kind() {
            StorageFull | QuotaExceeded | FileTooLarge => Self::Full { path, source },
            _ => Self::Write { path, source },
        }
    }
}

/// For an image named as one of another format: the option that writes that format.
fn format_advice(path: &Path, what: &str, extension: &str) -> &'static str {
    let is = |name: &str| {
        let given = path.extension();
        given.is_some_and(|given| given.eq_ignore_ascii_case(name))
    };
    match (what, extension) {
        ("images", "png") if is("exr") => ", or give --format exr",
        ("images", "exr") if is("png") => ", or leave --format exr out",
        _ => "",
    }
}

/// A file on its way: it exists under a temporary name beside its final one, and vanishes if it is not committed.
#[derive(Debug)]
pub struct PendingFile {
    temporary: TempPath,
    target: PathBuf,
    _unfinished: Unfinished,
    // After the file: fields are dropped in their order.
    folders: NewFolders,
}

/// Folders that were made for a file, outermost first. They vanish with it as long as nothing else is in them.
#[derive(Debug)]
struct NewFolders(Vec<PathBuf>);

impl NewFolders {
    /// Makes a folder and those above it, where they are not there.
    fn make(folder: &Path) -> Result<Self, OutputError> {
        let is_missing = |path: &&Path| !path.as_os_str().is_empty() && !path.exists();
        let missing = folder.ancestors().take_while(is_missing);
        let mut missing: Vec<_> = missing.map(Path::to_owned).collect();
        missing.reverse();
        let made = Self(missing);
        make_folder(folder)?;
        Ok(made)
    }
}

impl Drop for NewFolders {
    fn drop(&mut self) {
        for folder in self.0.iter().rev() {
            // One that is in use stays.
            let _ = std::fs::remove_dir(folder);
        }
    }
}

impl PendingFile {
    /// Makes the temporary file, and its folder where that is missing. `what` are the things that are written with `extension`, for the message.
    pub fn create(
        target: &Path,
        what: &'static str,
        extension: &'static str,
    ) -> Result<Self, OutputError> {
        Self::create_as(target, what, extension, ".terrella-")
    }

    /// The same with a temporary name that begins so.
    pub(super) fn create_as(
        target: &Path,
        what: &'static str,
        extension: &'static str,
        prefix: &str,
    ) -> Result<Self, OutputError> {
        let fits = target
            .extension()
            .is_some_and(|given| given.eq_ignore_ascii_case(extension));
        if target.is_dir() {
            return Err(OutputError::InTheWay {
                path: target.into(),
                found: "a folder",
            });
        }
        if !fits {
            return Err(OutputError::Extension {
                path: target.into(),
                what,
                extension,
            });
        }
        if let Ok(found) = std::fs::metadata(target) {
            if !found.is_file() {
                return Err(OutputError::InTheWay {
                    path: target.into(),
                    found: "something that is not a file",
                });
            }
            if found.permissions().readonly() {
                return Err(OutputError::Protected {
                    path: target.into(),
                });
            }
        }
        let folder = match target.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let folders = NewFolders::make(folder)?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(prefix).suffix(".part");
        // Created by hand to get the permissions of an ordinary new file: those of the crate are for secrets.
        let made = builder.make_in(folder, |path| {
            Unfinished::create(path, |path| File::create_new(path))
        });
        let made = made.map_err(|source| OutputError::write(target, source))?;
        let ((_, unfinished), temporary) = made.into_parts();
        Ok(Self {
            temporary,
            target: target.into(),
            _unfinished: unfinished,
            folders,
        })
    }

    /// The final name.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// The temporary name, for programs that write by name.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Opens the temporary file for writing.
    pub fn open(&self) -> Result<BufWriter<File>, OutputError> {
        match File::options().write(true).open(&self.temporary) {
            Ok(file) => Ok(BufWriter::new(file)),
            Err(source) => Err(self.write_error(source)),
        }
    }

    /// Writes all of the file and gives it its name.
    pub fn write_whole(self, contents: &[u8]) -> Result<(), OutputError> {
        let mut file = self.open()?;
        file.write_all(contents)
            .and_then(|()| file.flush())
            .map_err(|source| self.write_error(source))?;
        self.commit()
    }

    /// Writes a picture as PNG and gives the file its name. Space is opaque: the alpha channel is not kept.
    pub fn write_png(self, picture: &RgbaImage) -> Result<(), OutputError> {
        let png = png_of(picture).map_err(|source| OutputError::Encode {
            path: self.target.clone(),
            source,
        })?;
        self.write_whole(&png)
    }

    /// Gives the complete file its name, replacing what had it. It then outlasts a power failure.
    pub fn commit(self) -> Result<(), OutputError> {
        let Self {
            temporary,
            target,
            _unfinished,
            mut folders,
        } = self;
        let failed = |source| OutputError::write(&target, source);
        durable::sync_file(&temporary).map_err(failed)?;
        temporary
            .persist(&target)
            .map_err(|error| failed(error.error))?;
        folders.0.clear();
        durable::sync_folder_of(&target).map_err(failed)
    }

    fn write_error(&self, source: std::io::Error) -> OutputError {
        OutputError::write(&self.target, source)
    }
}

/// A picture as the bytes of a PNG, without its alpha channel. In memory: an encoder that writes to a file may lose what the disk
/// rejects at its end.
pub(super) fn png_of(picture: &RgbaImage) -> Result<Vec<u8>, image::ImageError> {
    png_bytes(picture.dimensions(), picture.as_raw())
}

/// The PNG that the command writes for an image: width and height in pixels, and four bytes a pixel (red, green and blue in sRGB, and an opacity
/// that is dropped), rows from the top.
///
/// # Errors
/// A number of pixels that does not match the size, or a size that PNG does not support.
pub fn png_bytes((width, height): (u32, u32), rgba: &[u8]) -> Result<Vec<u8>, image::ImageError> {
    let (pixels, rest) = rgba.as_chunks::<4>();
    if rest.is_empty() && pixels.len() as u64 == u64::from(width) * u64::from(height) {
        let rgb: Vec<u8> = pixels.iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
        let mut png = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new(&mut png);
        encoder.write_image(&rgb, width, height, image::ExtendedColorType::Rgb8)?;
        return Ok(png);
    }
    let kind = image::error::ParameterErrorKind::DimensionMismatch;
    let error = image::error::ParameterError::from_kind(kind);
    Err(image::ImageError::Parameter(error))
}

/// Makes a folder and those above it, where they are not there.
pub(super) fn make_folder(folder: &Path) -> Result<(), OutputError> {
    if folder.exists() && !folder.is_dir() {
        return Err(OutputError::InTheWay {
            path: folder.into(),
            found: "a file",
        });
    }
    durable::make_folders(folder).map_err(|source| OutputError::write(folder, source))
}

/// `STEM.EXTENSION`, with a number where that is taken.
#[cfg(feature = "window")]
pub fn free_name(stem: &Path, extension: &str) -> PathBuf {
    let named = |end: &str| {
        let mut name = stem.as_os_str().to_owned();
        name.push(format!("{end}.{extension}"));
        PathBuf::from(name)
    };
    let mut numbered = (2_u32..).map(|n| named(&format!("-{n}")));
    let first = named("");
    match first.exists() {
        true => numbered.find(|path| !path.exists()).unwrap_or(first),
        false => first,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let mut names: Vec<_> = entries
            .map(|entry| {
                entry
                    .expect("an entry")
                    .file_name()
                    .into_string()
                    .expect("UTF-8")
            })
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_appears_whole_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("a.png");
        let pending = PendingFile::create(&target, "pictures", "png").expect("writable");
        assert!(!target.exists());
        pending
            .open()
            .expect("opens")
            .write_all(b"half")
            .expect("writes");
        drop(pending);
        assert!(
            names(folder.path()).is_empty(),
            "{:?}",
            names(folder.path())
        );

        std::fs::write(&target, b"old").expect("writes");
        let pending = PendingFile::create(&target, "pictures", "png").expect("writable");
        assert_eq!(std::fs::read(&target).expect("reads"), b"old");
        pending.write_whole(b"new").expect("commits");
        assert_eq!(std::fs::read(&target).expect("reads"), b"new");
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_file_is_as_readable_as_any_other() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a folder");
        let (ours, plain) = (folder.path().join("a.png"), folder.path().join("b"));
        let pending = PendingFile::create(&ours, "pictures", "png").expect("writable");
        pending.commit().expect("commits");
        std::fs::write(&plain, b"").expect("writes");
        let mode = |path: &Path| std::fs::metadata(path).expect("there").permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[test]
    fn what_cannot_be_written_is_rejected_before() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let rejection = |path: PathBuf| {
            PendingFile::create(&path, "images", "png")
                .expect_err("rejected")
                .to_string()
        };
        let jpg = rejection(at("a.jpg"));
        assert!(jpg.contains(".png") && jpg.contains("a.png"), "{jpg}");
        let exr = rejection(at("a.EXR"));
        assert!(exr.ends_with("a.png, or give --format exr"), "{exr}");
        let png = PendingFile::create(&at("a.png"), "images", "exr").expect_err("rejected");
        assert!(
            png.to_string().ends_with("or leave --format exr out"),
            "{png}"
        );
        let other = PendingFile::create(&at("a.exr"), "charts", "png").expect_err("rejected");
        assert!(!other.to_string().contains("--format"), "{other}");
        std::fs::create_dir(at("b.png")).expect("makes");
        assert!(rejection(at("b.png")).contains("a folder"));
        std::fs::write(at("file"), b"").expect("writes");
        assert!(rejection(at("file/c.png")).contains("a file of that name"));
        std::fs::write(at("d.png"), b"").expect("writes");
        let mut rights = std::fs::metadata(at("d.png")).expect("there").permissions();
        rights.set_readonly(true);
        std::fs::set_permissions(at("d.png"), rights).expect("sets");
        assert!(rejection(at("d.png")).contains("write-protected"));
        assert_eq!(names(folder.path()), ["b.png", "d.png", "file"]);
    }

    #[test]
    fn missing_folders_are_made_and_stay_only_with_a_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("new/deep/a.png");
        let pending = PendingFile::create(&target, "images", "png").expect("writable");
        assert!(folder.path().join("new/deep").is_dir());
        drop(pending);
        assert!(
            names(folder.path()).is_empty(),
            "{:?}",
            names(folder.path())
        );

        let pending = PendingFile::create(&target, "images", "png").expect("writable");
        let other = target.with_file_name("b.png");
        let other = PendingFile::create(&other, "images", "png").expect("writable");
        drop(other);
        pending.write_whole(b"new").expect("commits");
        assert_eq!(std::fs::read(&target).expect("reads"), b"new");
        assert_eq!(names(&folder.path().join("new/deep")), ["a.png"]);

        let wrong = folder.path().join("other/a.jpg");
        PendingFile::create(&wrong, "images", "png").expect_err("rejected");
        assert_eq!(names(folder.path()), ["new"]);
    }
}
