//! Maps of one byte a texel: cover, intensity, open water.

use super::error::ImageryError;
use super::layer::LayerImage;
use super::map_file::{MapFile, read_file};
use super::map_folder::MapFolder;
use super::map_rows::{KeptInMemory, MapBuilder, MapSink};
use super::srgb::luminance;
use super::texel::TexelFormat;
use super::tile::MapLayer;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// A file of such a map.
pub(super) struct GreyFile<'a> {
    pub path: PathBuf,
    pub contents: Cow<'a, [u8]>,
    /// Name of the map in messages.
    pub layer: &'static str,
}

impl<'a> GreyFile<'a> {
    /// Reads a file of a folder.
    pub fn read(
        folder: MapFolder<'a>,
        name: &str,
        layer: &'static str,
    ) -> Result<Self, ImageryError> {
        Ok(Self {
            path: folder.path(name),
            contents: folder.read(name, layer)?,
            layer,
        })
    }

    /// The same file, with owned contents.
    pub fn into_owned(self) -> GreyFile<'static> {
        GreyFile {
            path: self.path,
            contents: self.contents.into_owned().into(),
            layer: self.layer,
        }
    }

    /// Gives a sink the map. Answers beside the map its levels of at least a width that are kept in memory ([`MapBuilder::finish`]).
    pub fn map(
        &self,
        (layer, sink): (MapLayer, &dyn MapSink),
        kept_width: Option<usize>,
    ) -> Result<(LayerImage, LayerImage), ImageryError> {
        let file = self.open()?;
        let mut map = MapBuilder::new(sink, layer, file.size(), TexelFormat::R8Unorm);
        if let Some(width) = kept_width {
            map.keep(width);
        }
        rows(file, |row| map.push(row))?;
        Ok(map.finish())
    }

    /// The map without smaller levels.
    pub fn level_0(&self) -> Result<LayerImage, ImageryError> {
        let file = self.open()?;
        let (width, height) = file.size();
        let mut texels = Vec::with_capacity(width as usize * height as usize);
        rows(file, |row| texels.extend_from_slice(row))?;
        Ok(LayerImage {
            width,
            height,
            format: TexelFormat::R8Unorm,
            levels: [texels].into(),
        })
    }

    /// Hands over its rows, with its width and height.
    pub fn rows(&self, mut take: impl FnMut((u32, u32), &[u8])) -> Result<(), ImageryError> {
        let file = self.open()?;
        let size = file.size();
        rows(file, |row| take(size, row))
    }

    /// Decodes all of it and keeps nothing.
    pub fn check(&self) -> Result<(), ImageryError> {
        rows(self.open()?, |_| ())
    }

    fn open(&self) -> Result<MapFile<'_>, ImageryError> {
        let needed = "8-bit grey, or 8-bit grey or colour with alpha";
        MapFile::open(&self.path, &self.contents, self.layer, needed, |texels| {
            texels.bits == 8 && texels.channels != 3
        })
    }
}

/// Rows of amounts, 0…255: what is shown times alpha, where there is alpha.
fn rows(file: MapFile<'_>, mut take: impl FnMut(&[u8])) -> Result<(), ImageryError> {
    let channels = file.texel_kind().channels;
    let mut row_amounts = Vec::with_capacity(file.size().0 as usize);
    file.rows(|row| {
        row_amounts.clear();
        let row = match channels {
            4 => {
                amounts(
                    row,
                    &mut row_amounts,
                    |[red, green, blue, alpha]: &[u8; 4]| {
                        (luminance([*red, *green, *blue].map(f32::from)), *alpha)
                    },
                );
                &row_amounts
            }
            2 => {
                amounts(row, &mut row_amounts, |[grey, alpha]: &[u8; 2]| {
                    (f32::from(*grey), *alpha)
                });
                &row_amounts
            }
            _ => row,
        };
        take(row);
    })
}

/// Adds what is shown, 0…255, times alpha.
fn amounts<const N: usize>(texels: &[u8], to: &mut Vec<u8>, parts: impl Fn(&[u8; N]) -> (f32, u8)) {
    let (texels, _) = texels.as_chunks::<N>();
    to.extend(texels.iter().map(|texel| {
        let (shown, alpha) = parts(texel);
        (shown * f32::from(alpha) / 255.0).round() as u8
    }));
}

/// Loads a map of cover or intensity (8-bit grey) of the whole Earth; `layer` is its name in messages. For a map with alpha it is the value times
/// alpha: white with the cover in alpha, like most cloud maps, or grey.
///
/// # Errors
/// An invalid map, with its path, the cause and the remedy.
pub fn load_grey_map(path: &Path, layer: &'static str) -> Result<LayerImage, ImageryError> {
    let file = GreyFile {
        path: path.into(),
        contents: read_file(path, layer)?.into(),
        layer,
    };
    Ok(file.map((MapLayer::Clouds, &KeptInMemory), None)?.0)
}
