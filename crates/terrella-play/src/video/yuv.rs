//! RGB to planar 4:2:0 in BT.709, limited range (ITU-R BT.709-6, items 3.2 to 3.4).

use image::RgbaImage;

/// Planes of 8-bit 4:2:0, one after another: Y, then Cb and Cr of half width and height.
pub struct YuvPlanes {
    /// Width of the picture, pixels, even.
    pub width: usize,
    /// Height of the picture, pixels, even.
    pub height: usize,
    bytes: Vec<u8>,
}

// E'Y = 0.2126 R + 0.7152 G + 0.0722 B; Y = 16 + 219 E'Y; Cb = 128 + 224 (B − E'Y)/1.8556; Cr = 128 + 224 (R − E'Y)/1.5748,
// for components 0…1. Here for 0…255, in fixed point with 16 bits of fraction.
const LUMA: [f64; 3] = [0.2126, 0.7152, 0.0722];

const fn fixed(value: f64) -> i32 {
    // Round half away from zero; `f64::round` is not const in every toolchain that may build this.
    let scaled = value * 65_536.0;
    (if scaled < 0.0 {
        scaled - 0.5
    } else {
        scaled + 0.5
    }) as i32
}

const Y_ROW: [i32; 3] = [
    fixed(LUMA[0] * 219.0 / 255.0),
    fixed(LUMA[1] * 219.0 / 255.0),
    fixed(LUMA[2] * 219.0 / 255.0),
];
const CB_ROW: [i32; 3] = [
    fixed(-LUMA[0] * 224.0 / 255.0 / 1.8556),
    fixed(-LUMA[1] * 224.0 / 255.0 / 1.8556),
    fixed((1.0 - LUMA[2]) * 224.0 / 255.0 / 1.8556),
];
const CR_ROW: [i32; 3] = [
    fixed((1.0 - LUMA[0]) * 224.0 / 255.0 / 1.5748),
    fixed(-LUMA[1] * 224.0 / 255.0 / 1.5748),
    fixed(-LUMA[2] * 224.0 / 255.0 / 1.5748),
];

fn apply(row: [i32; 3], rgb: [i32; 3], offset: i32) -> i32 {
    (row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2] + (offset << 16) + (1 << 15)) >> 16
}

impl YuvPlanes {
    /// Black planes of an even size.
    pub fn new(width: u32, height: u32) -> Self {
        let (width, height) = (width as usize, height as usize);
        Self {
            width,
            height,
            bytes: vec![0; width * height * 3 / 2],
        }
    }

    /// Fills the planes from a picture of the same size. Each colour sample is the mean of its four pixels.
    pub fn fill(&mut self, picture: &RgbaImage) {
        let (width, height) = (self.width, self.height);
        let (luma, chroma) = self.bytes.split_at_mut(width * height);
        let (blue, red) = chroma.split_at_mut(width * height / 4);
        let pixels = picture.as_raw().as_chunks::<4>().0;
        let pairs = pixels.chunks_exact(2 * width);
        let luma_pairs = luma.chunks_exact_mut(2 * width);
        let chroma_rows = blue
            .chunks_exact_mut(width / 2)
            .zip(red.chunks_exact_mut(width / 2));
        for ((rows, luma), (blue, red)) in pairs.zip(luma_pairs).zip(chroma_rows) {
            for (y, pixel) in luma.iter_mut().zip(rows) {
                *y = apply(Y_ROW, rgb(pixel), 16) as u8;
            }
            let (upper, lower) = rows.split_at(width);
            let quads = upper.chunks_exact(2).zip(lower.chunks_exact(2));
            for ((quad, blue), red) in quads.zip(blue).zip(red) {
                let mut sum = [2; 3];
                for pixel in quad.0.iter().chain(quad.1) {
                    for (sum, value) in sum.iter_mut().zip(rgb(pixel)) {
                        *sum += value;
                    }
                }
                let mean = sum.map(|s| s / 4);
                // Limited range: 16…240, so the cast keeps the value.
                *blue = apply(CB_ROW, mean, 128) as u8;
                *red = apply(CR_ROW, mean, 128) as u8;
            }
        }
    }
}

fn rgb(pixel: &[u8; 4]) -> [i32; 3] {
    [pixel[0].into(), pixel[1].into(), pixel[2].into()]
}

impl openh264::formats::YUVSource for YuvPlanes {
    fn dimensions(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    fn strides(&self) -> (usize, usize, usize) {
        (self.width, self.width / 2, self.width / 2)
    }

    fn y(&self) -> &[u8] {
        &self.bytes[..self.width * self.height]
    }

    fn u(&self) -> &[u8] {
        let luma = self.width * self.height;
        &self.bytes[luma..luma * 5 / 4]
    }

    fn v(&self) -> &[u8] {
        &self.bytes[self.width * self.height * 5 / 4..]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;
    use openh264::formats::YUVSource;

    fn of(rgb: [u8; 3]) -> [u8; 3] {
        let mut planes = YuvPlanes::new(4, 2);
        planes.fill(&RgbaImage::from_pixel(
            4,
            2,
            Rgba([rgb[0], rgb[1], rgb[2], 7]),
        ));
        assert!(planes.y().iter().all(|y| *y == planes.y()[0]));
        [planes.y()[0], planes.u()[1], planes.v()[1]]
    }

    /// 75 % and 100 % colour bars as EBU Tech 3325 and BT.709 give them.
    #[test]
    fn colour_bars_have_their_published_values() {
        assert_eq!(of([0, 0, 0]), [16, 128, 128]);
        assert_eq!(of([255, 255, 255]), [235, 128, 128]);
        assert_eq!(of([255, 0, 0]), [63, 102, 240]);
        assert_eq!(of([0, 255, 0]), [173, 42, 26]);
        assert_eq!(of([0, 0, 255]), [32, 240, 118]);
        assert_eq!(of([255, 255, 0]), [219, 16, 138]);
    }

    #[test]
    fn colour_is_the_mean_of_four_and_brightness_of_each() {
        let mut picture = RgbaImage::from_pixel(4, 4, Rgba([0, 0, 0, 255]));
        picture.put_pixel(2, 1, Rgba([255, 255, 255, 255]));
        picture.put_pixel(0, 2, Rgba([0, 0, 255, 255]));
        let mut planes = YuvPlanes::new(4, 4);
        planes.fill(&picture);
        assert_eq!(planes.y()[4 + 2], 235);
        assert_eq!(planes.y().iter().filter(|y| **y == 16).count(), 14);
        assert_eq!(planes.u(), [128, 128, 156, 128]);
        assert_eq!(planes.y()[2 * 4], 32);
    }
}
