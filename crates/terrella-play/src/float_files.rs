//! Numbers of pixels as files, line by line from the top: little endian, no compression.
//!
//! - NPY, NumPy's format 1.0.
//! - OpenEXR 2 with one scan line a block and channels of 32-bit floats. Written here: it is sixty lines, and a crate for it
//!   brings ten more with its compressors.

use std::io::{self, Write};

/// Length of a header before the array, bytes; the format requires a multiple of 64.
pub(super) const NPY_HEADER: usize = 128;

/// Begins an array of numbers of this type (`<f4`, `<f8`), the last axis varying fastest; it follows.
pub(super) fn write_npy_header(out: &mut impl Write, dtype: &str, shape: &[u32]) -> io::Result<()> {
    let axes: Vec<_> = shape.iter().map(u32::to_string).collect();
    let axes = axes.join(", ");
    let text = format!("{{'descr': '{dtype}', 'fortran_order': False, 'shape': ({axes}), }}");
    let length = NPY_HEADER - 10;
    out.write_all(b"\x93NUMPY\x01\x00")?;
    out.write_all(&(length as u16).to_le_bytes())?;
    // Padded with spaces, ended by a line's end.
    writeln!(out, "{text:<pad$}", pad = length - 1)
}

/// OpenEXR's number of a channel of 32-bit floats.
const EXR_FLOAT: u32 = 2;

/// Begins a picture with these channels, which must be in the order of their names' bytes; its lines follow.
pub(super) fn write_exr_header(
    out: &mut impl Write,
    (width, height): (u32, u32),
    channels: &[&str],
) -> io::Result<()> {
    debug_assert!(channels.is_sorted());
    let header = exr_header(width, height, channels);
    out.write_all(&header)?;
    // Where each line begins, from the file's start.
    let first = header.len() as u64 + 8 * u64::from(height);
    for line in 0..u64::from(height) {
        let at = first + line * (8 + line_bytes(width, channels.len()));
        out.write_all(&at.to_le_bytes())?;
    }
    Ok(())
}

/// Writes the next row, channel after channel.
pub(super) fn write_exr_line<'c>(
    out: &mut impl Write,
    y: u32,
    channels: impl ExactSizeIterator<Item = &'c [f32]> + Clone,
) -> io::Result<()> {
    let bytes: usize = channels.clone().map(size_of_val).sum();
    out.write_all(&y.to_le_bytes())?;
    out.write_all(&(bytes as u32).to_le_bytes())?;
    for value in channels.flatten() {
        out.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}

fn line_bytes(width: u32, channels: usize) -> u64 {
    4 * u64::from(width) * channels as u64
}

fn exr_header(width: u32, height: u32, names: &[&str]) -> Vec<u8> {
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
    for name in names {
        channels.extend(name.as_bytes());
        channels.push(0);
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

    #[test]
    fn the_largest_header_has_room() {
        let mut file = Vec::new();
        write_npy_header(&mut file, "<f8", &[u32::MAX, u32::MAX, 3]).expect("writes");
        assert_eq!(file.len(), NPY_HEADER);
    }

    #[test]
    fn a_header_says_type_and_shape() {
        let mut file = Vec::new();
        write_npy_header(&mut file, "<f8", &[2, 3]).expect("writes");
        assert_eq!(&file[..8], b"\x93NUMPY\x01\x00");
        assert_eq!(
            usize::from(u16::from_le_bytes([file[8], file[9]])) + 10,
            NPY_HEADER
        );
        let text = std::str::from_utf8(&file[10..]).expect("text");
        assert!(text.starts_with("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }"));
        assert!(text.ends_with(" \n"));
    }

    /// Line by line where the table says, channel after channel.
    #[test]
    fn scan_lines_stand_where_the_table_says() {
        let lines = [[[0.5, 1.0], [2.0, 3.0]], [[4.0, 5.0], [6.0, 7.0]]];
        let mut file = Vec::new();
        write_exr_header(&mut file, (2, 2), &["a", "b.c"]).expect("writes");
        for (y, line) in (0..).zip(&lines) {
            let channels = line.iter().map(|channel: &[f32; 2]| &channel[..]);
            write_exr_line(&mut file, y, channels).expect("writes");
        }
        let table = exr_header(2, 2, &["a", "b.c"]).len();
        for (y, line) in lines.iter().enumerate() {
            let entry = table + 8 * y;
            let at = u64::from_le_bytes(file[entry..entry + 8].try_into().expect("eight bytes"));
            let at = at as usize;
            assert_eq!(file[at..at + 4], (y as u32).to_le_bytes());
            assert_eq!(file[at + 4..at + 8], 16_u32.to_le_bytes());
            let values = file[at + 8..at + 24].as_chunks::<4>().0.iter();
            let values: Vec<_> = values.map(|bytes| f32::from_le_bytes(*bytes)).collect();
            assert_eq!(values, line.concat());
        }
        assert_eq!(file.len(), table + 2 * (8 + 8 + 16));
    }
}
