//! From light to a picture of high dynamic range, on the processor.

use super::develop::LightPicture;
use super::over_light::covered;
use rayon::prelude::*;
use terrella::Hdr;

/// A picture of high dynamic range.
pub struct HdrPicture {
    /// Red, green and blue of BT.2020's primaries, full range, 16 bits a channel, high byte first, rows from the top.
    pub codes: Vec<u8>,
    /// The maximum and the mean of all pixels' brightest channels, cd/m²: MaxCLL and MaxFALL of CTA-861.3.
    pub light_levels_cd_m2: [f64; 2],
}

impl LightPicture {
    /// Encodes for a high dynamic range display.
    pub fn shown_hdr(&self, hdr: &Hdr) -> HdrPicture {
        let mut codes = vec![0; self.pixels.len() * 6];
        let scattered = self.scattered();
        let developer = self.developer();
        let width = self.size.0.max(1) as usize;
        let pixels = scattered.par_iter().zip(codes.par_chunks_exact_mut(6));
        let brightest = pixels.enumerate().map(|(n, (light, codes))| {
            let shown = hdr.shown(self.look.tone, developer.balanced(light));
            let (shown, bare) = covered(self.over.as_ref(), n, shown);
            let luminances_cd_m2 = hdr.luminances_cd_m2(shown);
            let grained = developer.grained((n % width, n / width), bare);
            let values = hdr.encoded(luminances_cd_m2).to_array().map(grained);
            for (value, code) in values.iter().zip(codes.as_chunks_mut::<2>().0) {
                *code = ((value * 65_535.0).round() as u16).to_be_bytes();
            }
            luminances_cd_m2.max_element()
        });
        let levels = brightest.map(|brightest| (brightest, brightest));
        let (largest, sum) = levels.reduce(|| (0.0, 0.0), |a, b| (f64::max(a.0, b.0), a.1 + b.1));
        HdrPicture {
            codes,
            light_levels_cd_m2: [largest, sum / self.pixels.len().max(1) as f64],
        }
    }
}
