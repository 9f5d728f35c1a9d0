//! GDAL's virtual rasters (`.vrt`): adjacent tile files, as `gdalbuildvrt` lists them.
//!
//! The reader supports bands of `SimpleSource` and `ComplexSource`: file names, bands, rectangles, no-data values, scale and offset. The format is in
//! GDAL's VRT documentation, <https://gdal.org/drivers/raster/vrt.html>. Other elements that change samples are rejected by name: warped, derived and
//! pansharpened rasters, look-up tables, filters. A source may not be another `.vrt`, or be in an archive or on a server.

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use std::io;
use std::path::{Component, Path, PathBuf};
use terrella_files as files;
use terrella_files::{excerpt, path_complaint, printable};

/// Maximum file size, bytes: the 26 000 tiles of a global 30 m model need three quarters of it.
pub const MAX_VRT_BYTES: u64 = 24 << 20;

/// Maximum sources of a band.
pub const MAX_VRT_SOURCES: usize = 65_536;

/// Maximum number of bands.
pub const MAX_VRT_BANDS: usize = 64;

/// Maximum nesting of elements.
const MAX_DEPTH: usize = 32;

/// Maximum length of a stored element text, bytes. Coordinate systems have the longest.
const MAX_TEXT_BYTES: usize = 64 << 10;

/// Why a virtual raster cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum VrtError {
    #[error(transparent)]
    Unreadable(#[from] io::Error),
    /// Damaged XML.
    #[error("line {line}: {cause}")]
    Damaged {
        /// Line, from 1.
        line: usize,
        cause: String,
    },
    /// An unsupported feature, by name; `gdal_translate` converts the whole raster.
    #[error("line {line}: {cause}")]
    Unsupported {
        /// Line, from 1.
        line: usize,
        cause: String,
    },
}

/// A virtual raster.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vrt {
    /// Pixels per row, and rows.
    pub size: (u32, u32),
    /// Its coordinate system: well-known text, or a name such as `EPSG:4326`.
    pub system: Option<String>,
    /// Georeference in units of the coordinate system. It has the west edge and pixel width, and the north edge and pixel height (see
    /// [`VrtGrid::row`]).
    pub grid: Option<VrtGrid>,
    pub bands: Vec<VrtBand>,
}

/// Georeference of a virtual raster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VrtGrid {
    pub west: f64,
    pub north: f64,
    /// Pixel width.
    pub column: f64,
    /// Pixel height: positive where the northern row comes first.
    pub row: f64,
}

/// A band.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VrtBand {
    pub no_data: Option<f64>,
    /// Pixel values mean offset + scale × stored.
    pub scale: Option<f64>,
    pub offset: Option<f64>,
    /// The files, the lowest first.
    pub sources: Vec<VrtSource>,
}

/// A file of a band.
#[derive(Clone, Debug, PartialEq)]
pub struct VrtSource {
    pub path: PathBuf,
    /// Its band, from 1; `None` for its mask or alpha.
    pub band: Option<u32>,
    /// Size of the whole file, if stated.
    pub size: Option<(u32, u32)>,
    /// Pixels of the file: first column, first row, columns, rows; by default all.
    pub from: Option<[f64; 4]>,
    /// The corresponding pixels of the raster; by default all.
    pub to: Option<[f64; 4]>,
    pub no_data: Option<f64>,
    /// Pixels become offset + scale × pixel.
    pub scale: f64,
    pub offset: f64,
    /// Its line in the file, from 1.
    pub line: usize,
}

impl VrtSource {
    /// Whether the whole file is used.
    pub fn is_whole(&self) -> bool {
        match (self.from, self.size) {
            (None, _) => true,
            (Some([x, y, _, _]), None) => (x, y) == (0.0, 0.0),
            (Some(from), Some((columns, rows))) => {
                from == [0.0, 0.0, f64::from(columns), f64::from(rows)]
            }
        }
    }

    /// Whether pixels are used as stored.
    pub fn is_plain(&self) -> bool {
        (self.scale, self.offset) == (1.0, 0.0)
    }
}

/// Whether a path has the extension of a virtual raster.
pub fn is_vrt(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("vrt"))
}

impl Vrt {
    /// Reads a file; its sources are beside it or absolute.
    ///
    /// # Errors
    /// [`VrtError`] with the line. At most [`MAX_VRT_BYTES`] are held.
    pub fn open(path: &Path) -> Result<Self, VrtError> {
        let text = files::read_text(path, MAX_VRT_BYTES)?;
        let text = text.ok_or_else(|| VrtError::Unsupported {
            line: 1,
            cause: format!("has more than {} MB", MAX_VRT_BYTES / 1_000_000),
        })?;
        Self::read(&text, path.parent().unwrap_or(Path::new("")))
    }

    /// Reads a text whose relative file names refer to `folder`.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn read(text: &str, folder: &Path) -> Result<Self, VrtError> {
        let mut walk = Walk {
            text,
            folder,
            at: 0,
            line: 1,
            open: Vec::new(),
            vrt: Self::default(),
            source: None,
        };
        walk.run()?;
        Ok(walk.vrt)
    }
}

/// An open element.
struct Begun {
    name: String,
    text: String,
    /// Whether its contents are skipped.
    is_skipped: bool,
}

/// State of parsing.
struct Walk<'t> {
    text: &'t str,
    folder: &'t Path,
    /// Start of the current element, byte, and its line, from 1.
    at: usize,
    line: usize,
    open: Vec<Begun>,
    vrt: Vrt,
    source: Option<VrtSource>,
}

impl Walk<'_> {
    fn damaged(&self, cause: impl Into<String>) -> VrtError {
        VrtError::Damaged {
            line: self.line,
            cause: cause.into(),
        }
    }

    fn unsupported(&self, cause: impl Into<String>) -> VrtError {
        VrtError::Unsupported {
            line: self.line,
            cause: cause.into(),
        }
    }

    fn run(&mut self) -> Result<(), VrtError> {
        let mut reader = Reader::from_str(self.text);
        reader.config_mut().expand_empty_elements = true;
        let mut had_root = false;
        loop {
            let at = (reader.buffer_position() as usize).min(self.text.len());
            let passed = self.text.as_bytes().get(self.at..at).unwrap_or_default();
            self.line += passed.iter().filter(|byte| **byte == b'\n').count();
            self.at = at;
            let event = reader.read_event();
            match event.map_err(|error| self.damaged(printable(&error.to_string())))? {
                Event::Start(start) => {
                    if self.open.is_empty() && had_root {
                        return Err(self.damaged("a second root element"));
                    }
                    had_root = true;
                    self.begin(&start)?;
                }
                Event::End(_) => self.end()?,
                Event::Text(piece) => self.add(&piece.xml10_content())?,
                Event::CData(piece) => self.add(&piece.xml10_content())?,
                Event::GeneralRef(reference) => {
                    let name = reference.xml10_content();
                    let character = match reference.resolve_char_ref() {
                        Ok(Some(character)) => Some(character.to_string()),
                        _ => quick_xml::escape::resolve_xml_entity(&name).map(str::to_owned),
                    };
                    let unknown = || self.damaged(format!("unknown entity &{};", excerpt(&name)));
                    let character = character.ok_or_else(unknown)?;
                    self.add(&character)?;
                }
                Event::DocType(_) => return Err(self.unsupported("has a document type")),
                Event::Eof if self.open.is_empty() && had_root => return Ok(()),
                Event::Eof => return Err(self.damaged("the file ends too early")),
                _ => {}
            }
        }
    }

    fn add(&mut self, piece: &str) -> Result<(), VrtError> {
        let too_long = self.damaged(format!("a text of more than {MAX_TEXT_BYTES} bytes"));
        let Some(element) = self.open.last_mut() else {
            return Ok(());
        };
        if element.is_skipped {
            return Ok(());
        }
        if element.text.len() + piece.len() > MAX_TEXT_BYTES {
            return Err(too_long);
        }
        element.text.push_str(piece);
        Ok(())
    }

    fn attribute(&self, start: &BytesStart<'_>, name: &str) -> Result<Option<String>, VrtError> {
        for attribute in start.attributes() {
            let attribute = attribute.map_err(|error| self.damaged(error.to_string()))?;
            if attribute.key.local_name().as_ref() == name {
                let value = attribute.normalized_value(XmlVersion::Implicit1_0);
                let value = value.map_err(|error| self.damaged(error.to_string()))?;
                return Ok(Some(value.into_owned()));
            }
        }
        Ok(None)
    }

    fn number(&self, start: &BytesStart<'_>, name: &str) -> Result<f64, VrtError> {
        let text = self.attribute(start, name)?.unwrap_or_default();
        self.parsed(&text, name)
    }

    fn parsed(&self, text: &str, name: &str) -> Result<f64, VrtError> {
        let number = text.trim().parse::<f64>();
        number.map_err(|_| self.damaged(format!("{name} is {:?}, not a number", excerpt(text))))
    }

    /// A size from attributes.
    fn size(&self, start: &BytesStart<'_>, names: [&str; 2]) -> Result<(u32, u32), VrtError> {
        let mut sides = [0; 2];
        for (side, name) in sides.iter_mut().zip(names) {
            let text = self.attribute(start, name)?.unwrap_or_default();
            *side = text
                .parse::<u32>()
                .ok()
                .filter(|side| *side > 0)
                .ok_or_else(|| self.damaged(format!("{name} is {:?}", excerpt(&text))))?;
        }
        Ok((sides[0], sides[1]))
    }

    /// First column, first row, columns, rows.
    fn rectangle(&self, start: &BytesStart<'_>) -> Result<[f64; 4], VrtError> {
        let mut all = [0.0; 4];
        for (number, name) in all.iter_mut().zip(["xOff", "yOff", "xSize", "ySize"]) {
            *number = self.number(start, name)?;
        }
        match all.iter().all(|n| n.is_finite()) && all[2] > 0.0 && all[3] > 0.0 {
            true => Ok(all),
            false => Err(self.damaged("a rectangle of no size")),
        }
    }

    fn begin(&mut self, start: &BytesStart<'_>) -> Result<(), VrtError> {
        if self.open.len() >= MAX_DEPTH {
            return Err(self.damaged(format!("more than {MAX_DEPTH} elements within each other")));
        }
        let name = start.local_name().as_ref().to_owned();
        let parents: Vec<&str> = self.open.iter().map(|begun| begun.name.as_str()).collect();
        let is_skipped = match (parents.as_slice(), name.as_str()) {
            _ if self.open.last().is_some_and(|begun| begun.is_skipped) => true,
            ([], "VRTDataset") => {
                if let Some(kind) = self.attribute(start, "subClass")? {
                    return Err(self.unsupported(format!("is a {}", excerpt(&kind))));
                }
                self.vrt.size = self.size(start, ["rasterXSize", "rasterYSize"])?;
                false
            }
            ([], _) => return Err(self.damaged("no <VRTDataset>")),
            (["VRTDataset"], "VRTRasterBand") => {
                let kind = self.attribute(start, "subClass")?.unwrap_or_default();
                if !matches!(kind.as_str(), "" | "VRTSourcedRasterBand") {
                    return Err(self.unsupported(format!("has a {}", excerpt(&kind))));
                }
                if self.vrt.bands.len() >= MAX_VRT_BANDS {
                    let cause = format!("has more than {MAX_VRT_BANDS} bands");
                    return Err(self.unsupported(cause));
                }
                self.vrt.bands.push(VrtBand::default());
                false
            }
            (["VRTDataset"], "GCPList" | "Group") => {
                return Err(self.unsupported(format!("has a <{name}>")));
            }
            (["VRTDataset"], "SRS" | "GeoTransform") => false,
            (["VRTDataset", "VRTRasterBand"], "NoDataValue" | "Scale" | "Offset") => false,
            (["VRTDataset", "VRTRasterBand"], "SimpleSource" | "ComplexSource") => {
                let band = self.vrt.bands.last();
                if band.is_some_and(|band| band.sources.len() >= MAX_VRT_SOURCES) {
                    let cause = format!("has more than {MAX_VRT_SOURCES} sources in a band");
                    return Err(self.unsupported(cause));
                }
                self.source = Some(VrtSource {
                    path: PathBuf::new(),
                    band: Some(1),
                    size: None,
                    from: None,
                    to: None,
                    no_data: None,
                    scale: 1.0,
                    offset: 0.0,
                    line: self.line,
                });
                false
            }
            (["VRTDataset", "VRTRasterBand"], other) => {
                // Elements with these names produce samples in another way.
                if other.ends_with("Source") || other == "PixelFunctionType" {
                    return Err(self.unsupported(format!("has a <{}>", excerpt(other))));
                }
                true
            }
            (["VRTDataset", "VRTRasterBand", _], _) if self.source.is_some() => {
                self.begin_of_source(&name, start)?
            }
            _ => true,
        };
        self.open.push(Begun {
            name,
            text: String::new(),
            is_skipped,
        });
        Ok(())
    }

    /// Starts an element of a source. Returns whether its contents are ignored.
    fn begin_of_source(&mut self, name: &str, start: &BytesStart<'_>) -> Result<bool, VrtError> {
        match name {
            "SourceProperties" => {
                let size = self.size(start, ["RasterXSize", "RasterYSize"])?;
                if let Some(source) = &mut self.source {
                    source.size = Some(size);
                }
            }
            "SrcRect" | "DstRect" => {
                let rectangle = self.rectangle(start)?;
                if let Some(source) = &mut self.source {
                    match name {
                        "SrcRect" => source.from = Some(rectangle),
                        _ => source.to = Some(rectangle),
                    }
                }
            }
            "SourceFilename" | "SourceBand" | "NODATA" | "ScaleRatio" | "ScaleOffset" => {}
            // Masks of files always apply.
            "UseMaskBand" | "RectType" => return Ok(true),
            other => {
                let cause = format!("has a source with <{}>", excerpt(other));
                return Err(self.unsupported(cause));
            }
        }
        Ok(false)
    }

    fn end(&mut self) -> Result<(), VrtError> {
        // The parser has compared the names.
        let Some(Begun {
            name,
            text,
            is_skipped: false,
        }) = self.open.pop()
        else {
            return Ok(());
        };
        let text = text.trim();
        match (self.open.len(), name.as_str()) {
            (1, "SRS") => self.vrt.system = Some(text.to_owned()).filter(|text| !text.is_empty()),
            (1, "GeoTransform") => self.vrt.grid = Some(self.grid(text)?),
            (2, "NoDataValue") => {
                let number = self.parsed(text, &name)?;
                self.band().no_data = Some(number);
            }
            (2, "Scale") => {
                let number = self.parsed(text, &name)?;
                self.band().scale = Some(number);
            }
            (2, "Offset") => {
                let number = self.parsed(text, &name)?;
                self.band().offset = Some(number);
            }
            (2, "SimpleSource" | "ComplexSource") => {
                let source = self.source.take();
                let source = source.filter(|source| !source.path.as_os_str().is_empty());
                let source = source.ok_or_else(|| self.damaged("a source without a file"))?;
                self.band().sources.push(source);
            }
            (3, "SourceFilename") => {
                let path = self.path(text)?;
                if let Some(source) = &mut self.source {
                    source.path = path;
                }
            }
            (3, "SourceBand") => {
                let band = match text.starts_with("mask") {
                    true => None,
                    false => {
                        let band = text.parse().ok().filter(|band| *band > 0);
                        let wrong = || self.damaged(format!("band {:?}", excerpt(text)));
                        Some(band.ok_or_else(wrong)?)
                    }
                };
                if let Some(source) = &mut self.source {
                    source.band = band;
                }
            }
            (3, "NODATA" | "ScaleRatio" | "ScaleOffset") => {
                let number = self.parsed(text, &name)?;
                if let Some(source) = &mut self.source {
                    match name.as_str() {
                        "NODATA" => source.no_data = Some(number),
                        "ScaleRatio" => source.scale = number,
                        _ => source.offset = number,
                    }
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn band(&mut self) -> &mut VrtBand {
        // Band elements end only inside a band.
        if self.vrt.bands.is_empty() {
            self.vrt.bands.push(VrtBand::default());
        }
        let last = self.vrt.bands.len() - 1;
        &mut self.vrt.bands[last]
    }

    fn grid(&self, text: &str) -> Result<VrtGrid, VrtError> {
        let numbers = text
            .split(',')
            .map(|text| self.parsed(text, "GeoTransform"));
        let numbers = numbers.collect::<Result<Vec<_>, _>>()?;
        let [west, column, turned_x, north, turned_y, row] = numbers[..] else {
            return Err(self.damaged("a GeoTransform of other than six numbers"));
        };
        if numbers.iter().any(|number| !number.is_finite()) {
            return Err(self.damaged("a GeoTransform without end"));
        }
        match turned_x == 0.0 && turned_y == 0.0 && column > 0.0 && row < 0.0 {
            true => Ok(VrtGrid {
                west,
                north,
                column,
                row: -row,
            }),
            false => {
                Err(self
                    .unsupported("is rotated, or runs from east to west or from south to north"))
            }
        }
    }

    /// The path of a source's file name.
    fn path(&self, text: &str) -> Result<PathBuf, VrtError> {
        let path = Path::new(text);
        if text.is_empty() {
            return Err(self.damaged("a source without a file"));
        }
        if text.starts_with("/vsi") || text.contains("://") {
            let cause = format!(
                "has a source in an archive or on a server: {:?}",
                excerpt(text)
            );
            return Err(self.unsupported(cause));
        }
        let is_drive = matches!(path.components().next(), Some(Component::Prefix(_)));
        if text.contains(':') && !is_drive || text.starts_with('<') {
            let cause = format!("has a source that is not a file: {:?}", excerpt(text));
            return Err(self.unsupported(cause));
        }
        if let Some(complaint) = path_complaint(path) {
            return Err(self.damaged(format!("a source: {complaint}")));
        }
        if is_vrt(path) {
            let cause = format!(
                "has another virtual raster as a source: {:?}",
                excerpt(text)
            );
            return Err(self.unsupported(cause));
        }
        // GDAL resolves other relative names from its working directory; here they are also
        // relative to the file.
        Ok(self.folder.join(path))
    }
}

#[cfg(test)]
mod tests;
