//! A sensor's raw frame as a file, and the page beside it that describes it.
//!
//! Values are those of the converter, from 0 to 2^bits − 1, not scaled to 16 bits:
//! - `.png`: greyscale of 16 bits.
//! - `.tiff`, `.tif`: greyscale of 16 bits, without compression.
//! - `.npy`, NumPy's: an array of height × width of unsigned 16-bit integers.

use super::float_files::write_npy_header;
use super::output::{OutputError, PendingFile};
use super::raw_format::RawFormat;
use super::raw_manifest::RawManifest;
use std::io::{self, Write};
use std::path::Path;
use terrella_sensor::RawFrame;

/// A raw frame and its page on their way.
#[derive(Debug)]
pub struct RawFile {
    file: PendingFile,
    kind: RawFormat,
    manifest: PendingFile,
}

/// File name extensions in lower case, and their formats.
const ENDINGS: [(&str, RawFormat); 4] = [
    ("png", RawFormat::Png),
    ("tiff", RawFormat::Tiff),
    ("tif", RawFormat::Tiff),
    ("npy", RawFormat::Npy),
];

impl RawFile {
    /// Creates the file in the format of its extension, and a page of the same name with the extension `.json`.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let given = path.extension().unwrap_or_default();
        let mut endings = ENDINGS.iter();
        let found = endings.find(|(ending, _)| given.eq_ignore_ascii_case(ending));
        let (ending, kind) = found.ok_or_else(|| OutputError::RawName { path: path.into() })?;
        Ok(Self {
            file: PendingFile::create(path, "raw frames", ending)?,
            kind: *kind,
            manifest: PendingFile::create(&path.with_extension("json"), "manifests", "json")?,
        })
    }

    /// The frame's file.
    pub fn target(&self) -> &Path {
        self.file.target()
    }

    /// Writes both and gives them their names, the page last. Answers the bytes of the frame's file.
    pub fn write(self, frame: &RawFrame, manifest: &RawManifest) -> Result<Vec<u8>, OutputError> {
        let path = self.file.target().to_owned();
        let bytes = encoded(frame, self.kind);
        let bytes = bytes.map_err(|source| OutputError::NotEncoded { path, source })?;
        // The page of an earlier frame describes another one.
        match std::fs::remove_file(self.manifest.target()) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                return Err(OutputError::write(self.manifest.target(), source));
            }
            _ => {}
        }
        self.file.write_whole(&bytes)?;
        self.manifest.write_whole(manifest.to_json().as_bytes())?;
        Ok(bytes)
    }
}

fn encoded(frame: &RawFrame, kind: RawFormat) -> io::Result<Vec<u8>> {
    let mut file = Vec::new();
    match kind {
        RawFormat::Png => {
            let mut encoder = png::Encoder::new(&mut file, frame.width, frame.height);
            encoder.set_color(png::ColorType::Grayscale);
            encoder.set_depth(png::BitDepth::Sixteen);
            let mut writer = encoder.write_header()?;
            let bytes: Vec<u8> = frame
                .data
                .iter()
                .flat_map(|number| number.to_be_bytes())
                .collect();
            writer.write_image_data(&bytes)?;
            writer.finish()?;
        }
        RawFormat::Tiff => {
            let mut out = io::Cursor::new(&mut file);
            let mut encoder =
                tiff::encoder::TiffEncoder::new(&mut out).map_err(io::Error::other)?;
            encoder
                .write_image::<tiff::encoder::colortype::Gray16>(
                    frame.width,
                    frame.height,
                    &frame.data,
                )
                .map_err(io::Error::other)?;
        }
        RawFormat::Npy => {
            write_npy_header(&mut file, "<u2", &[frame.height, frame.width])?;
            for number in &frame.data {
                file.write_all(&number.to_le_bytes())?;
            }
        }
    }
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::super::float_files::NPY_HEADER;
    use super::*;

    fn frame() -> RawFrame {
        RawFrame {
            width: 3,
            height: 2,
            bits: 12,
            data: vec![0, 1, 256, 4095, 2048, 7],
        }
    }

    #[test]
    fn files_hold_the_numbers() {
        let png = encoded(&frame(), RawFormat::Png).expect("encodes");
        let read = image::load_from_memory(&png).expect("a PNG");
        let image::DynamicImage::ImageLuma16(read) = read else {
            panic!("{:?}", read.color());
        };
        assert_eq!(
            (read.width(), read.height(), read.into_raw()),
            (3, 2, frame().data)
        );
        let npy = encoded(&frame(), RawFormat::Npy).expect("encodes");
        let text = std::str::from_utf8(&npy[10..NPY_HEADER]).expect("text");
        assert!(text.contains("'<u2'") && text.contains("(2, 3)"), "{text}");
        assert_eq!(npy[NPY_HEADER..], [0, 0, 1, 0, 0, 1, 255, 15, 0, 8, 7, 0]);
        let bytes = encoded(&frame(), RawFormat::Tiff).expect("encodes");
        let mut decoder = tiff::decoder::Decoder::new(io::Cursor::new(bytes)).expect("a TIFF");
        assert_eq!(decoder.dimensions().expect("a size"), (3, 2));
        let tiff::decoder::DecodingResult::U16(read) = decoder.read_image().expect("numbers")
        else {
            panic!("not 16 bits");
        };
        assert_eq!(read, frame().data);
    }

    #[test]
    fn only_three_kinds_are_taken() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["a.png", "a.TIF", "a.tiff", "b.npy"] {
            RawFile::create(&folder.path().join(name)).expect(name);
        }
        let error = RawFile::create(&folder.path().join("a.raw")).expect_err("no kind");
        let text = error.to_string();
        assert!(text.contains(".npy") && text.contains("a.png"), "{text}");
        assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 0);
    }
}
