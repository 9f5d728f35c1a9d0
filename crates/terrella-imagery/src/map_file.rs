//! One map file, opened with limits before every allocation.

use super::colour::Said;
use super::decode::{FileKind, Picture, TexelKind, png_size};
use super::error::ImageryError;
use super::texel::{MAX_HEIGHT, MIN_HEIGHT, TexelFormat};
use std::path::Path;
use terrella_files as files;

/// Largest map file, bytes.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// A map file whose header was found good, and whose texels are not decoded.
pub(super) struct MapFile<'a> {
    path: &'a Path,
    picture: Picture<'a>,
    pub said: Said,
}

/// The bytes of a map file.
pub(super) fn read_file(path: &Path, layer: &'static str) -> Result<Vec<u8>, ImageryError> {
    let unreadable = |source: std::io::Error| {
        if source.kind() == std::io::ErrorKind::NotFound {
            ImageryError::Missing {
                path: path.into(),
                layer,
            }
        } else {
            ImageryError::Unreadable {
                path: path.into(),
                source,
            }
        }
    };
    let contents = files::read(path, MAX_FILE_BYTES).map_err(unreadable)?;
    contents.ok_or_else(|| ImageryError::FileTooLarge {
        path: path.into(),
        bytes: std::fs::metadata(path).map_or(MAX_FILE_BYTES, |found| found.len()),
        limit: MAX_FILE_BYTES,
    })
}

impl<'a> MapFile<'a> {
    /// Width in a file's header, texels; `None` if it has none. Reading the map reports the error.
    pub fn width(path: &Path) -> Option<u32> {
        Self::width_of(&files::read(path, MAX_FILE_BYTES).ok()??)
    }

    /// The same of a file's contents.
    pub fn width_of(contents: &[u8]) -> Option<u32> {
        let picture = Picture::open(FileKind::of(contents)?, contents).ok()?;
        Some(picture.size().0)
    }

    /// Opens a map in the bytes of its file. Nothing is allocated for texels before the header is found good.
    pub fn open(
        path: &'a Path,
        contents: &'a [u8],
        layer: &'static str,
        needed: &'static str,
        takes: impl Fn(TexelKind) -> bool,
    ) -> Result<Self, ImageryError> {
        let not_an_image = |cause: String| ImageryError::NotAnImage {
            path: path.into(),
            cause,
        };
        let damaged = damaged(path);
        if contents.is_empty() {
            return Err(not_an_image("the file is empty".into()));
        }
        let Some(kind) = FileKind::of(contents) else {
            return Err(not_an_image(
                "its first bytes are neither PNG's nor JPEG's".into(),
            ));
        };
        if let Some((width, height)) = png_size(contents) {
            check_map_size(path, width, height)?;
        }
        let picture = Picture::open(kind, contents).map_err(&damaged)?;
        let (width, height) = picture.size();
        check_map_size(path, width, height)?;
        check_addressable(path, (width, height), isize::MAX as u64)?;
        let texel_kind = picture.texel_kind();
        if !takes(texel_kind) {
            return Err(ImageryError::TexelKind {
                path: path.into(),
                layer,
                found: texel_kind.to_string(),
                needed,
            });
        }
        // The decoder would silently fill missing parts with grey.
        let said = picture.check_whole().map_err(&damaged)?;
        if let Some(how) = said.turned() {
            return Err(ImageryError::Turned {
                path: path.into(),
                how,
                orientation: said.orientation.unwrap_or_default(),
            });
        }
        Ok(Self {
            path,
            // A colour has four bytes in the map: better made by the decoder than copied.
            picture: picture.with_alpha(),
            said,
        })
    }

    /// Width and height, texels.
    pub fn size(&self) -> (u32, u32) {
        self.picture.size()
    }

    pub fn texel_kind(&self) -> TexelKind {
        self.picture.texel_kind()
    }

    /// Row-major texels; 16-bit ones with the high byte first.
    pub fn texels(self) -> Result<Vec<u8>, ImageryError> {
        self.picture.texels().map_err(damaged(self.path))
    }

    /// The rows from the north, as far as they are complete.
    pub fn rows(self, take: impl FnMut(&[u8])) -> Result<(), ImageryError> {
        self.picture.rows(take).map_err(damaged(self.path))
    }
}

fn damaged(path: &Path) -> impl Fn(String) -> ImageryError {
    |cause| ImageryError::Damaged {
        path: path.into(),
        cause,
    }
}

/// Whether a map with its mip levels can be in one piece of memory, of at most so many bytes: what 32-bit platforms have no room for is
/// rejected before it is allocated.
fn check_addressable(
    path: &Path,
    (width, height): (u32, u32),
    limit: u64,
) -> Result<(), ImageryError> {
    let texels = u64::from(width) * u64::from(height);
    let bytes = texels * TexelFormat::Rgba8Srgb.texel_bytes() as u64;
    // Mip levels add a third.
    if bytes + bytes / 3 <= limit {
        return Ok(());
    }
    Err(ImageryError::AddressSpace {
        path: path.into(),
        width,
        height,
    })
}

/// A map is twice as wide as high, and within the limits.
fn check_map_size(path: &Path, width: u32, height: u32) -> Result<(), ImageryError> {
    if (MIN_HEIGHT..=MAX_HEIGHT).contains(&height) && u64::from(width) == 2 * u64::from(height) {
        return Ok(());
    }
    Err(ImageryError::Size {
        path: path.into(),
        width,
        height,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_beyond_the_address_space_are_rejected() {
        let fits = |width: u32, limit: u64| {
            check_addressable(Path::new("day.jpg"), (width, width / 2), limit).is_ok()
        };
        let (web, native) = (i32::MAX as u64, i64::MAX as u64);
        assert!(fits(2 * MAX_HEIGHT, native));
        assert!(!fits(2 * MAX_HEIGHT, web));
        assert!(fits(16_384, web));
        let error = check_addressable(Path::new("day.jpg"), (32_768, 16_384), web);
        let text = error.expect_err("2.7 GiB").to_string();
        assert!(text.contains("day.jpg") && text.contains("32768"), "{text}");
    }
}
