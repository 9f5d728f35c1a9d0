//! A picture of a film, drawn, and its file.

use super::develop::LightPicture;
use super::hdr::HdrPicture;
use super::settings::{PictureFormat, PictureSettings};
use crate::float_files::{write_exr_header, write_exr_line};
use crate::output::png_of;
use image::RgbaImage;
use std::borrow::Cow;
use std::io;
use terrella::{Hdr, HdrTransfer};

/// A picture, as it was drawn.
#[derive(Clone, Debug)]
pub enum FilmPicture {
    /// As a screen shows it.
    Shown(RgbaImage),
    /// Light.
    Light(LightPicture),
}

impl FilmPicture {
    /// With 8 bits a channel, opaque.
    pub fn shown(&self) -> Cow<'_, RgbaImage> {
        match self {
            Self::Shown(picture) => Cow::Borrowed(picture),
            Self::Light(light) => Cow::Owned(light.shown_8(false)),
        }
    }

    /// For a display of high dynamic range; `None` of a picture that is no light.
    pub fn shown_hdr(&self, hdr: &Hdr) -> Option<HdrPicture> {
        match self {
            Self::Shown(_) => None,
            Self::Light(light) => Some(light.shown_hdr(hdr)),
        }
    }

    /// The bytes of its file, in memory: they are written in one go.
    ///
    /// # Errors
    /// What the encoder says.
    pub fn file(&self, settings: &PictureSettings) -> io::Result<Vec<u8>> {
        let light = match self {
            Self::Shown(picture) => return png_of(picture).map_err(io::Error::other),
            Self::Light(light) => light,
        };
        let alpha = settings.alpha;
        if let Some(hdr) = settings.hdr() {
            return hdr_png(light.size, &hdr, &light.shown_hdr(&hdr));
        }
        match settings.format {
            PictureFormat::Png if alpha => png(
                light.size,
                true,
                png::BitDepth::Eight,
                light.shown_8(true).as_raw(),
            ),
            PictureFormat::Exr => exr(light, alpha),
            PictureFormat::Png16 => png(
                light.size,
                alpha,
                png::BitDepth::Sixteen,
                &light.shown_16(alpha),
            ),
            // Those of high dynamic range are written above.
            PictureFormat::Png | PictureFormat::Pq | PictureFormat::Hlg => {
                png_of(&light.shown_8(false)).map_err(io::Error::other)
            }
        }
    }
}

fn png(
    (width, height): (u32, u32),
    alpha: bool,
    depth: png::BitDepth,
    pixels: &[u8],
) -> io::Result<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(match alpha {
        true => png::ColorType::Rgba,
        false => png::ColorType::Rgb,
    });
    encoder.set_depth(depth);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(file)
}

/// With the chunks of the PNG specification's third edition that say how codes are to be read. There is no mDCV, as no display mastered it.
fn hdr_png((width, height): (u32, u32), hdr: &Hdr, picture: &HdrPicture) -> io::Result<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Sixteen);
    let mut writer = encoder.write_header()?;
    let transfer = match hdr.transfer {
        HdrTransfer::Pq => 16,
        HdrTransfer::Hlg => 18,
    };
    // ITU-T H.273: primaries of BT.2020, the transfer, no matrix, full range.
    writer.write_chunk(png::chunk::cICP, &[9, transfer, 0, 1])?;
    if hdr.transfer == HdrTransfer::Pq {
        // In units of 0.0001 cd/m².
        let levels = picture.light_levels_cd_m2;
        let levels = levels.map(|level| ((level * 1e4).round() as u32).to_be_bytes());
        writer.write_chunk(png::chunk::cLLI, levels.as_flattened())?;
    }
    writer.write_image_data(&picture.codes)?;
    writer.finish()?;
    Ok(file)
}

fn exr(light: &LightPicture, alpha: bool) -> io::Result<Vec<u8>> {
    // In the order of their names: alpha, blue, green, red.
    let (names, order): (&[&str], &[usize]) = match alpha {
        true => (&["A", "B", "G", "R"], &[3, 2, 1, 0]),
        false => (&["B", "G", "R"], &[2, 1, 0]),
    };
    let mut file = Vec::new();
    write_exr_header(&mut file, light.size, names)?;
    let lines = light.pixels.chunks_exact(light.size.0.max(1) as usize);
    for (y, line) in (0..).zip(lines) {
        let channel = |n: &usize| line.iter().map(|pixel| pixel[*n]).collect::<Vec<_>>();
        let channels: Vec<_> = order.iter().map(channel).collect();
        write_exr_line(&mut file, y, channels.iter().map(Vec::as_slice))?;
    }
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::develop::PictureLook;
    use terrella::Tone;

    #[test]
    fn files_hold_what_they_say() {
        let light = LightPicture {
            size: (2, 1),
            pixels: vec![[1.0, 0.5, 0.25, 0.5], [2.0, 4.0, 8.0, 1.0]],
            look: PictureLook {
                factor: 1.0,
                tone: Tone::Linear,
                bloom: Default::default(),
                grade: Default::default(),
                frame: 0,
            },
            over: None,
        };
        let picture = FilmPicture::Light(light);
        let file = |format, alpha| {
            let settings = PictureSettings {
                format,
                alpha,
                ..PictureSettings::default()
            };
            picture.file(&settings).expect("encodes")
        };
        for (format, alpha, color) in [
            (PictureFormat::Png, false, image::ColorType::Rgb8),
            (PictureFormat::Png, true, image::ColorType::Rgba8),
            (PictureFormat::Png16, false, image::ColorType::Rgb16),
            (PictureFormat::Png16, true, image::ColorType::Rgba16),
        ] {
            let read = image::load_from_memory(&file(format, alpha)).expect("a PNG");
            assert_eq!((read.color(), read.width(), read.height()), (color, 2, 1));
        }
        let read = image::load_from_memory(&file(PictureFormat::Png16, true)).expect("a PNG");
        // Light of 1 is shown, so it hides: alpha is raised from 0.5.
        assert_eq!(
            read.to_rgba16().get_pixel(0, 0).0,
            [65535, 48192, 35199, 65535]
        );
        // Its light as it is, alpha first, at the end of the file.
        let exr = file(PictureFormat::Exr, true);
        let floats = exr[exr.len() - 32..].as_chunks::<4>().0;
        let floats: Vec<_> = floats.iter().map(|b| f32::from_le_bytes(*b)).collect();
        assert_eq!(floats, [0.5, 1.0, 0.25, 8.0, 0.5, 4.0, 1.0, 2.0]);
        assert_eq!(exr.len() - file(PictureFormat::Exr, false).len(), 8 + 18);
    }
}
