//! Large images written row by row; they get their final names only when complete.

use anyhow::{Context, Result};
use image::{GenericImageView, Rgb};
use std::cell::RefCell;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// JPEG quality, 4:4:4.
const JPEG_QUALITY: u8 = 92;

/// Fills one row of a picture.
pub type Row<'a> = dyn FnMut(usize, &mut [u8]) -> Result<()> + 'a;

/// Writes a file with `contents`, unless it exists already.
fn file(path: &Path, contents: impl FnOnce(&mut BufWriter<File>) -> Result<()>) -> Result<()> {
    let name = path.display();
    if path.exists() {
        println!("{name} is there already");
        return Ok(());
    }
    let partial = path.with_extension("partial");
    let mut out =
        BufWriter::new(File::create(&partial).with_context(|| partial.display().to_string())?);
    contents(&mut out).with_context(|| name.to_string())?;
    out.flush().with_context(|| name.to_string())?;
    drop(out);
    std::fs::rename(&partial, path).with_context(|| name.to_string())?;
    let bytes = std::fs::metadata(path).map_or(0, |file| file.len());
    println!("{name} ({} MB)", bytes.div_ceil(1_000_000));
    Ok(())
}

/// A grey PNG.
pub fn png(path: &Path, (width, height): (usize, usize), row: &mut Row<'_>) -> Result<()> {
    file(path, |out| {
        let mut encoder = png::Encoder::new(out, width as u32, height as u32);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        let mut writer = encoder.write_header()?;
        let mut stream = writer.stream_writer()?;
        let mut texels = vec![0; width];
        for y in 0..height {
            row(y, &mut texels)?;
            stream.write_all(&texels)?;
        }
        stream.finish()?;
        Ok(())
    })
}

/// A baseline JPEG of colour.
pub fn jpeg(path: &Path, (width, height): (usize, usize), row: &mut Row<'_>) -> Result<()> {
    file(path, |out| {
        let view = Rows {
            width,
            height,
            strip: RefCell::new(Strip {
                first: 0,
                end: 0,
                texels: vec![0; STRIP * width * 3],
                row,
                error: None,
            }),
        };
        let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(out, JPEG_QUALITY);
        encoder.encode_image(&view)?;
        match view.strip.into_inner().error {
            Some(error) => Err(error),
            None => Ok(()),
        }
    })
}

/// Rows that the encoder reads together.
const STRIP: usize = 8;

/// An image that is never complete in memory: the encoder reads it in strips from the top.
struct Rows<'a> {
    width: usize,
    height: usize,
    strip: RefCell<Strip<'a>>,
}

struct Strip<'a> {
    first: usize,
    end: usize,
    texels: Vec<u8>,
    row: &'a mut Row<'a>,
    /// The first error; later rows are ignored.
    error: Option<anyhow::Error>,
}

impl GenericImageView for Rows<'_> {
    type Pixel = Rgb<u8>;

    fn dimensions(&self) -> (u32, u32) {
        (self.width as u32, self.height as u32)
    }

    fn get_pixel(&self, x: u32, y: u32) -> Rgb<u8> {
        let (x, y) = (x as usize, y as usize);
        let strip = &mut *self.strip.borrow_mut();
        assert!(y >= strip.first, "the encoder went back to row {y}");
        while y >= strip.end {
            strip.first = strip.end;
            strip.end = (strip.first + STRIP).min(self.height);
            for (y, texels) in
                (strip.first..strip.end).zip(strip.texels.chunks_exact_mut(3 * self.width))
            {
                if strip.error.is_none() {
                    strip.error = (strip.row)(y, texels).err();
                }
            }
        }
        let place = ((y - strip.first) * self.width + x) * 3;
        let texel = &strip.texels[place..place + 3];
        Rgb([texel[0], texel[1], texel[2]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_written_in_rows() {
        let folder = tempfile::tempdir().unwrap();
        let size = (40, 21);
        let path = folder.path().join("grey.png");
        png(&path, size, &mut |y, row| {
            row.fill(10 * y as u8);
            Ok(())
        })
        .unwrap();
        let grey = image::open(&path).unwrap().into_luma8();
        assert_eq!(grey.dimensions(), (40, 21));
        assert_eq!(grey.get_pixel(39, 20).0, [200]);
        let path = folder.path().join("colour.jpg");
        jpeg(&path, size, &mut |y, row| {
            for texel in row.chunks_exact_mut(3) {
                texel.copy_from_slice(&[10 * y as u8, 100, 50]);
            }
            Ok(())
        })
        .unwrap();
        let colour = image::open(&path).unwrap().into_rgb8();
        for y in [0, 7, 8, 15, 20] {
            let texel = colour.get_pixel(3, y).0;
            assert!(texel[0].abs_diff(10 * y as u8) < 8, "{y}: {texel:?}");
        }
    }

    #[test]
    fn a_row_that_fails_leaves_no_picture() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.jpg");
        let mut fails = |y: usize, _: &mut [u8]| {
            anyhow::ensure!(y < 10, "row {y}");
            Ok(())
        };
        let error = jpeg(&path, (16, 16), &mut fails).unwrap_err();
        assert!(format!("{error:#}").contains("row 10"));
        assert!(!path.exists());
    }
}
