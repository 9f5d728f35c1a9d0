//! A picture's light as a file: linear, scene-referred, before exposure and tone curve.
//!
//! Two kinds, both with 32-bit floats, little endian, rows from the top, no compression:
//! - `.npy`, NumPy's format 1.0: an array of height × width × 3, red, green and blue.
//! - `.exr`, OpenEXR 2 with one scan line a block and channels R, G and B; no chromaticities are stated, which means those of
//!   Rec. 709, the maps' own. Written here: it is sixty lines, and a crate for it brings ten more with its compressors.

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
    /// As many as width × height; what stands after the third channel is not written.
    pub pixels: &'p [[f32; 4]],
}

impl RadianceFile {
    /// Begins the file whose name's ending says of which kind it is.
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
        written.map_err(|source| OutputError::Write {
            path: self.file.target().into(),
            source,
        })?;
        self.file.commit()
    }
}

/// Most bytes of a header before the array; a multiple of 64, as the format asks for.
const NPY_HEADER: usize = 128;

fn write_npy(out: &mut impl Write, light: Radiance<'_>) -> io::Result<()> {
    let Radiance { width, height, .. } = light;
    let text =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({height}, {width}, 3), }}");
    let length = NPY_HEADER - 10;
    out.write_all(b"\x93NUMPY\x01\x00")?;
    out.write_all(&(length as u16).to_le_bytes())?;
    // Padded with spaces, ended by a line's end.
    writeln!(out, "{text:<pad$}", pad = length - 1)?;
    for [red, green, blue, _] in light.pixels {
        for value in [red, green, blue] {
            out.write_all(&value.to_le_bytes())?;
        }
    }
    Ok(())
}

/// OpenEXR's number of a channel of 32-bit floats.
const EXR_FLOAT: u32 = 2;

fn write_exr(out: &mut impl Write, light: Radiance<'_>) -> io::Result<()> {
    let Radiance { width, height, .. } = light;
    let header = exr_header(width, height);
    out.write_all(&header)?;
    // Where each line begins, from the file's start.
    let line_bytes = 12 * u64::from(width);
    let first = header.len() as u64 + 8 * u64::from(height);
    for line in 0..u64::from(height) {
        out.write_all(&(first + line * (8 + line_bytes)).to_le_bytes())?;
    }
    let lines = light.pixels.chunks_exact(width.max(1) as usize);
    for (y, line) in (0_u32..).zip(lines) {
        out.write_all(&y.to_le_bytes())?;
        out.write_all(&(line_bytes as u32).to_le_bytes())?;
        // In the alphabet's order: B, G, R.
        for channel in [2, 1, 0] {
            for pixel in line {
                out.write_all(&pixel[channel].to_le_bytes())?;
            }
        }
    }
    Ok(())
}

fn exr_header(width: u32, height: u32) -> Vec<u8> {
    let mut header = Vec::new();
    // Magic number, version 2, one part of scan lines.
    header.extend([0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]);
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        for text in [name, kind] {
            header.extend(text.as_bytes());
            header.push(0);
        }
        header.extend((value.len() as u32).to_le_bytes());
        header.extend(value);
    };
    let mut channels = Vec::new();
    for name in [b'B', b'G', b'R'] {
        channels.extend([name, 0]);
        // Its type; whether it is perceptually linear, and three reserved bytes; one value a pixel across and down.
        for value in [EXR_FLOAT, 0, 1, 1] {
            channels.extend(value.to_le_bytes());
        }
    }
    channels.push(0);
    let corners = [0, 0, width.saturating_sub(1), height.saturating_sub(1)];
    let window: Vec<u8> = corners.into_iter().flat_map(u32::to_le_bytes).collect();
    attribute("channels", "chlist", &channels);
    attribute("compression", "compression", &[0]);
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1_f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1_f32.to_le_bytes());
    header.push(0);
    header
}

#[cfg(test)]
mod tests {
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
        assert_eq!(&file[..8], b"\x93NUMPY\x01\x00");
        assert_eq!(
            usize::from(u16::from_le_bytes([file[8], file[9]])) + 10,
            NPY_HEADER
        );
        let text = std::str::from_utf8(&file[10..NPY_HEADER]).expect("text");
        assert!(text.starts_with("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 3), }"));
        assert!(text.ends_with(" \n"));
        assert_eq!(file.len(), NPY_HEADER + 6 * 12);
        for (n, pixel) in PIXELS.iter().enumerate() {
            for (channel, value) in pixel[..3].iter().enumerate() {
                assert_eq!(float(&file, NPY_HEADER + 12 * n + 4 * channel), *value);
            }
        }
    }

    #[test]
    fn the_largest_header_has_room() {
        let mut file = Vec::new();
        let (width, height) = (u32::MAX, u32::MAX);
        let none = Radiance {
            width,
            height,
            pixels: &[],
        };
        write_npy(&mut file, none).expect("writes");
        assert_eq!(file.len(), NPY_HEADER);
    }

    /// Line by line where the table says, channels in the alphabet's order.
    #[test]
    fn scan_lines_stand_where_the_table_says() {
        let mut file = Vec::new();
        write_exr(&mut file, light()).expect("writes");
        let table = exr_header(3, 2).len();
        for (y, pixels) in PIXELS.chunks(3).enumerate() {
            let entry = table + 8 * y;
            let at = u64::from_le_bytes(file[entry..entry + 8].try_into().expect("eight bytes"));
            let at = at as usize;
            assert_eq!(file[at..at + 4], (y as u32).to_le_bytes());
            assert_eq!(file[at + 4..at + 8], 36_u32.to_le_bytes());
            for (n, channel) in [2, 1, 0].into_iter().enumerate() {
                for (x, pixel) in pixels.iter().enumerate() {
                    let value = float(&file, at + 8 + 4 * (3 * n + x));
                    assert_eq!(value, pixel[channel], "{x}, {y}, {channel}");
                }
            }
        }
        assert_eq!(file.len(), table + 2 * (8 + 8 + 36));
    }

    #[test]
    fn only_two_endings_are_taken() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["a.npy", "a.NPY", "b.exr"] {
            RadianceFile::create(&folder.path().join(name)).expect(name);
        }
        for name in ["a.png", "a", "a.npz"] {
            let refused = RadianceFile::create(&folder.path().join(name)).expect_err(name);
            let text = refused.to_string();
            assert!(text.contains(".npy") && text.contains(".exr"), "{text}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 0);
    }
}
