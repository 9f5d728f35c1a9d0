//! Pictures that are no maps, such as textures of models: PNG and JPEG as RGBA, within limits of the caller.

use super::decode::{FileKind, Picture, png_size};

/// Row-major texels of four bytes, red, green, blue and alpha, as the file encodes them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RgbaPicture {
    /// Width and height, texels.
    pub size: (u32, u32),
    /// Four bytes a texel, rows from the top.
    pub rgba: Vec<u8>,
}

/// Decodes a complete file. `accept` gets width and height before anything is allocated for them.
///
/// # Errors
/// The error in the file: neither PNG nor JPEG, truncated or corrupt, or of a size that is not accepted.
pub fn decode_rgba(
    contents: &[u8],
    accept: impl FnOnce(u32, u32) -> Result<(), String>,
) -> Result<RgbaPicture, String> {
    let kind = FileKind::of(contents).ok_or("it is neither PNG nor JPEG")?;
    let mut accept = Some(accept);
    let mut check = |(width, height)| match accept.take() {
        Some(accept) => accept(width, height),
        None => Ok(()),
    };
    // The decoder's error for a size that is too large does not contain it.
    if let (FileKind::Png, Some(size)) = (kind, png_size(contents)) {
        check(size)?;
    }
    let picture = Picture::open(kind, contents)?;
    let size = picture.size();
    check(size)?;
    picture.check_whole()?;
    let texels = picture.texel_kind();
    let (channels, bytes) = (usize::from(texels.channels), usize::from(texels.bits / 8));
    let decoded = picture.texels()?;
    let mut rgba = Vec::with_capacity(size.0 as usize * size.1 as usize * 4);
    for texel in decoded.chunks_exact(channels * bytes) {
        // Of 16-bit values the high byte comes first.
        let channel = |at: usize| texel.get(at * bytes).copied().unwrap_or(255);
        rgba.extend(match channels {
            1 => [channel(0), channel(0), channel(0), 255],
            2 => [channel(0), channel(0), channel(0), channel(1)],
            3 => [channel(0), channel(1), channel(2), 255],
            _ => [channel(0), channel(1), channel(2), channel(3)],
        });
    }
    Ok(RgbaPicture { size, rgba })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(color: png::ColorType, depth: png::BitDepth, data: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 2, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        writer.finish().unwrap();
        file
    }

    #[test]
    fn every_kind_of_texel_becomes_rgba() {
        use png::{BitDepth::*, ColorType::*};
        for (color, depth, data, rgba) in [
            (Grayscale, Eight, &[1, 2][..], [1, 1, 1, 255, 2, 2, 2, 255]),
            (
                GrayscaleAlpha,
                Eight,
                &[1, 9, 2, 8],
                [1, 1, 1, 9, 2, 2, 2, 8],
            ),
            (
                Rgb,
                Eight,
                &[1, 2, 3, 4, 5, 6],
                [1, 2, 3, 255, 4, 5, 6, 255],
            ),
            (
                Rgba,
                Eight,
                &[1, 2, 3, 4, 5, 6, 7, 8],
                [1, 2, 3, 4, 5, 6, 7, 8],
            ),
            (
                Grayscale,
                Sixteen,
                &[1, 99, 2, 99],
                [1, 1, 1, 255, 2, 2, 2, 255],
            ),
        ] {
            let picture = decode_rgba(&png(color, depth, data), |_, _| Ok(()));
            assert_eq!(picture.unwrap().rgba, rgba, "{color:?} {depth:?}");
        }
    }

    #[test]
    fn a_size_is_looked_at_before_it_is_allocated() {
        let mut file = png(png::ColorType::Rgb, png::BitDepth::Eight, &[0; 6]);
        // Width of the header; its checksum is wrong then, but is never reached.
        file[16..20].copy_from_slice(&u32::MAX.to_be_bytes());
        let small = |width: u32, _| match width > 100 {
            true => Err(format!("{width} is too wide")),
            false => Ok(()),
        };
        let error = decode_rgba(&file, small).unwrap_err();
        assert_eq!(error, "4294967295 is too wide");
        assert!(
            decode_rgba(b"GIF89a", small)
                .unwrap_err()
                .contains("neither")
        );
        let whole = png(png::ColorType::Rgb, png::BitDepth::Eight, &[0; 6]);
        assert!(decode_rgba(&whole[..whole.len() - 14], small).is_err());
    }
}
