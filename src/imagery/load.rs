//! A folder of maps, read from disk.

use super::decode::{FileKind, Picture, TexelKind, jpeg_ends, png_size};
use super::error::ImageryError;
use super::layer::{EarthLayers, LayerImage};
use super::slopes::{SLOPE_EXAGGERATION, slopes_from_elevation};
use super::texel::{MAX_HEIGHT, MIN_HEIGHT};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest map file, bytes.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// Names of the day map, first come first taken.
pub(super) const DAY_NAMES: [&str; 2] = ["day.jpg", "day.png"];

/// Which maps are wanted beside the day map, which always is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerSelection {
    /// Cloud cover.
    pub clouds: bool,
    /// Terrain normals, from the elevation map.
    pub normals: bool,
    /// City lights.
    pub night_lights: bool,
}

impl Default for LayerSelection {
    /// Everything.
    fn default() -> Self {
        Self {
            clouds: true,
            normals: true,
            night_lights: true,
        }
    }
}

/// Reads the selected maps of a folder, each on its own thread, and makes their mip levels. Files of maps that are not
/// selected are not opened.
///
/// | map | file | texels |
/// |---|---|---|
/// | day | `day.jpg`, else `day.png` | 8-bit colour or grey, sRGB |
/// | clouds | `clouds.png` | 8-bit grey, cover 0…1 |
/// | night lights | `night_lights.png` | 8-bit grey, intensity 0…1 |
/// | normals | `elevation.png` | 16-bit grey, metres + [`ELEVATION_OFFSET_M`](super::ELEVATION_OFFSET_M) |
///
/// All are equirectangular maps of the whole Earth, north row first, left edge at 180° W, [`MIN_HEIGHT`] to
/// [`MAX_HEIGHT`] texels high and twice as wide. Slopes are exaggerated by [`SLOPE_EXAGGERATION`].
///
/// # Errors
/// The first map that fails, in the order of the table, with its path, the cause and what to do.
pub fn load_layers(dir: &Path, selection: LayerSelection) -> Result<EarthLayers, ImageryError> {
    std::thread::scope(|scope| {
        let start = |wanted: bool, load: fn(&Path) -> Result<LayerImage, ImageryError>| {
            wanted.then(|| scope.spawn(move || load(dir)))
        };
        let clouds = start(selection.clouds, load_clouds);
        let normals = start(selection.normals, load_normals);
        let night_lights = start(selection.night_lights, load_night_lights);
        // The largest map is read by the calling thread. Errors are looked at when all threads have ended.
        let day = load_day(dir);
        let [clouds, normals, night_lights] = [clouds, normals, night_lights].map(|thread| {
            thread.map(|thread| {
                thread
                    .join()
                    .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
            })
        });
        Ok(EarthLayers {
            day: day?,
            clouds: clouds.transpose()?,
            night_lights: night_lights.transpose()?,
            normals: normals.transpose()?,
            // Folders hold none; packs do.
            water: None,
        })
    })
}

fn load_day(dir: &Path) -> Result<LayerImage, ImageryError> {
    let names = DAY_NAMES.map(|name| dir.join(name));
    let path = names.iter().find(|path| path.exists()).unwrap_or(&names[0]);
    let file = MapFile::read(path, "day", "8-bit colour (sRGB)", |texels| {
        texels.bits == 8
    })?;
    let texels = match file.texel_kind.channels {
        4 => file.bytes,
        3 => to_rgba(&file.bytes, |rgb: &[u8; 3]| *rgb),
        2 => to_rgba(&file.bytes, |la: &[u8; 2]| [la[0]; 3]),
        _ => to_rgba(&file.bytes, |grey: &[u8; 1]| [grey[0]; 3]),
    };
    LayerImage::from_rgba8(file.width, file.height, texels)
}

fn to_rgba<const N: usize>(texels: &[u8], rgb_of: impl Fn(&[u8; N]) -> [u8; 3]) -> Vec<u8> {
    let (texels, _) = texels.as_chunks::<N>();
    let mut rgba = Vec::with_capacity(texels.len() * 4);
    for texel in texels {
        let [red, green, blue] = rgb_of(texel);
        rgba.extend_from_slice(&[red, green, blue, 255]);
    }
    rgba
}

fn load_clouds(dir: &Path) -> Result<LayerImage, ImageryError> {
    load_grey(&dir.join("clouds.png"), "clouds")
}

fn load_night_lights(dir: &Path) -> Result<LayerImage, ImageryError> {
    load_grey(&dir.join("night_lights.png"), "night lights")
}

fn load_grey(path: &Path, layer: &'static str) -> Result<LayerImage, ImageryError> {
    let file = MapFile::read(path, layer, "8-bit grey", |texels| {
        texels == TexelKind::grey(8)
    })?;
    LayerImage::from_r8(file.width, file.height, file.bytes)
}

fn load_normals(dir: &Path) -> Result<LayerImage, ImageryError> {
    let path = dir.join("elevation.png");
    let file = MapFile::read(
        &path,
        "elevation",
        "16-bit grey (metres + 11000)",
        |texels| texels == TexelKind::grey(16),
    )?;
    let (pairs, _) = file.bytes.as_chunks::<2>();
    let elevation: Vec<u16> = pairs.iter().map(|pair| u16::from_be_bytes(*pair)).collect();
    drop(file.bytes);
    let slopes = slopes_from_elevation(file.width, file.height, &elevation, SLOPE_EXAGGERATION)?;
    tracing::debug!(
        path = %path.display(),
        saturated_texels = slopes.saturated_texels,
        "slopes made, {SLOPE_EXAGGERATION} times exaggerated"
    );
    Ok(slopes.image)
}

/// A decoded file, its size and texel kind checked.
struct MapFile {
    width: u32,
    height: u32,
    texel_kind: TexelKind,
    /// Row-major texels; 16-bit ones with the high byte first.
    bytes: Vec<u8>,
}

impl MapFile {
    /// Reads a map. Nothing is allocated for texels before the header is found good.
    fn read(
        path: &Path,
        layer: &'static str,
        needed: &'static str,
        takes: impl Fn(TexelKind) -> bool,
    ) -> Result<Self, ImageryError> {
        let contents = read_file(path, layer)?;
        let not_an_image = |cause: String| ImageryError::NotAnImage {
            path: path.into(),
            cause,
        };
        let damaged = |cause: String| ImageryError::Damaged {
            path: path.into(),
            cause,
        };
        if contents.is_empty() {
            return Err(not_an_image("the file is empty".into()));
        }
        let Some(kind) = FileKind::of(&contents) else {
            return Err(not_an_image(
                "its first bytes are neither PNG's nor JPEG's".into(),
            ));
        };
        if kind == FileKind::Jpeg && !jpeg_ends(&contents) {
            // The decoder would fill what is missing with grey and say nothing.
            return Err(damaged("the JPEG data has no end marker".into()));
        }
        if let Some((width, height)) = png_size(&contents) {
            check_map_size(path, width, height)?;
        }
        let picture = Picture::open(kind, &contents).map_err(damaged)?;
        let (width, height) = picture.size();
        check_map_size(path, width, height)?;
        let texel_kind = picture.texel_kind();
        if !takes(texel_kind) {
            return Err(ImageryError::TexelKind {
                path: path.into(),
                layer,
                found: texel_kind.to_string(),
                needed,
            });
        }
        let bytes = picture.texels().map_err(damaged)?;
        Ok(Self {
            width,
            height,
            texel_kind,
            bytes,
        })
    }
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

/// The whole file, if it is one and not too large.
fn read_file(path: &Path, layer: &'static str) -> Result<Vec<u8>, ImageryError> {
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
    // Looked at before opening: to open a pipe would wait for its writer.
    let metadata = std::fs::metadata(path).map_err(unreadable)?;
    if !metadata.is_file() {
        let cause = std::io::Error::other("it is not a regular file");
        return Err(unreadable(cause));
    }
    let too_large = |bytes: u64| ImageryError::FileTooLarge {
        path: PathBuf::from(path),
        bytes,
        limit: MAX_FILE_BYTES,
    };
    if metadata.len() > MAX_FILE_BYTES {
        return Err(too_large(metadata.len()));
    }
    let file = std::fs::File::open(path).map_err(unreadable)?;
    let mut contents = Vec::with_capacity(metadata.len() as usize);
    // A file that grows while it is read must not pass the limit either.
    file.take(MAX_FILE_BYTES + 1)
        .read_to_end(&mut contents)
        .map_err(unreadable)?;
    if contents.len() as u64 > MAX_FILE_BYTES {
        return Err(too_large(contents.len() as u64));
    }
    Ok(contents)
}
