//! An image's light as a file: linear, scene-referred, before exposure and tone curve.
//!
//! Two kinds, both with 32-bit floats, rows from the top:
//! - `.npy`, NumPy's: an array of height × width × 3, red, green and blue.
//! - `.exr`, OpenEXR's, with channels R, G and B; no chromaticities are stated, which means those of Rec. 709, the maps' own.

use super::float_files::{write_exr_header, write_exr_line, write_npy_header};
use super::output::{OutputError, PendingFile};
use std::io::{self, Write};
use std::path::Path;

/// A file of light on its way.
#[derive(Debug)]
pub struct RadianceFile {
    file: PendingFile,
    kind: RadianceKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RadianceKind {
    Npy,
    Exr,
}

/// Light of a picture: red, green and blue of each pixel, rows from the top.
#[derive(Clone, Copy, Debug)]
pub struct Radiance<'p> {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Width × height pixels; values after the third channel are not written.
    pub pixels: &'p [[f32; 4]],
}

impl RadianceFile {
    /// Creates the file in the format of its extension.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let ends = |ending: &str| {
            let given = path.extension();
            given.is_some_and(|given| given.eq_ignore_ascii_case(ending))
        };
        let (kind, ending) = match (ends("npy"), ends("exr")) {
            (true, _) => (RadianceKind::Npy, "npy"),
            (_, true) => (RadianceKind::Exr, "exr"),
            _ => return Err(OutputError::RadianceName { path: path.into() }),
        };
        let file = PendingFile::create(path, "radiance files", ending)?;
        Ok(Self { file, kind })
    }

    /// Writes all of it and gives it its name.
    pub fn write(self, light: Radiance<'_>) -> Result<(), OutputError> {
        let mut out = self.file.open()?;
        let written = match self.kind {
            RadianceKind::Npy => write_npy(&mut out, light),
            RadianceKind::Exr => write_exr(&mut out, light),
        };
        let written = written.and_then(|()| out.flush());
        written.map_err(|source| OutputError::write(self.file.target(), source))?;
        self.file.commit()
    }
}

fn write_npy(out: &mut impl Write, light: Radiance<'_>) -> io::Result<()> {
    write_npy_header(out, "<f4", &[light.height, light.width, 3])?;
    for [red, green, blue, _] in light.pixels {
        for value in [red, green, blue] {
            out.write_all(&value.to_le_bytes())?;
        }
    }
    Ok(())
}

fn write_exr(out: &mut impl Write, light: Radiance<'_>) -> io::Result<()> {
    write_exr_header(out, (light.width, light.height), &["B", "G", "R"])?;
    let lines = light.pixels.chunks_exact(light.width.max(1) as usize);
    for (y, line) in (0_u32..).zip(lines) {
        let channel = |n: usize| line.iter().map(|pixel| pixel[n]).collect::<Vec<_>>();
        let channels = [2, 1, 0].map(channel);
        write_exr_line(out, y, channels.iter().map(Vec::as_slice))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::float_files::NPY_HEADER;
    use super::*;

    const PIXELS: [[f32; 4]; 6] = [
        [0.0, 0.5, 1.0, 1.0],
        [1.0, 2.0, 3.0, 1.0],
        [4.0, 5.0, 6.0, 1.0],
        [7.0, 8.0, 9.0, 1.0],
        [1e-9, 1e9, 0.25, 0.0],
        [10.0, 11.0, 12.0, 0.0],
    ];

    fn light() -> Radiance<'static> {
        Radiance {
            width: 3,
            height: 2,
            pixels: &PIXELS,
        }
    }

    fn float(bytes: &[u8], at: usize) -> f32 {
        f32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
    }

    #[test]
    fn an_array_has_its_shape_and_order() {
        let mut file = Vec::new();
        write_npy(&mut file, light()).expect("writes");
        let text = std::str::from_utf8(&file[10..NPY_HEADER]).expect("text");
        assert!(text.starts_with("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 3), }"));
        assert_eq!(file.len(), NPY_HEADER + 6 * 12);
        for (n, pixel) in PIXELS.iter().enumerate() {
            for (channel, value) in pixel[..3].iter().enumerate() {
                assert_eq!(float(&file, NPY_HEADER + 12 * n + 4 * channel), *value);
            }
        }
    }

    /// In the alphabet's order, B, G, R, at the end of the file.
    #[test]
    fn a_scan_line_has_its_channels_in_order() {
        let mut file = Vec::new();
        write_exr(&mut file, light()).expect("writes");
        let at = file.len() - 36;
        assert_eq!(file[at - 8..at - 4], 1_u32.to_le_bytes());
        for (n, channel) in [2, 1, 0].into_iter().enumerate() {
            for (x, pixel) in PIXELS[3..].iter().enumerate() {
                let value = float(&file, at + 4 * (3 * n + x));
                assert_eq!(value, pixel[channel], "{x}, {channel}");
            }
        }
    }

    #[test]
    fn only_two_endings_are_taken() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["a.npy", "a.NPY", "b.exr"] {
            RadianceFile::create(&folder.path().join(name)).expect(name);
        }
        for name in ["a.png", "a", "a.npz"] {
            let rejected = RadianceFile::create(&folder.path().join(name)).expect_err(name);
            let text = rejected.to_string();
            assert!(text.contains(".npy") && text.contains(".exr"), "{text}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 0);
    }
}
