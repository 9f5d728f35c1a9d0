//! From mean electrons to numbers: noise, wells and the converter.

use crate::error::{SensorError, check_count, check_range};
use crate::limits;
use crate::philox::{PixelRandom, Stream};
use rayon::prelude::*;

/// Parameters of a detector. The terms are those of EMVA 1288.
#[derive(Clone, Debug, PartialEq)]
pub struct Detector {
    /// Electrons that a pixel holds.
    pub full_well_e: f64,
    /// Whether electrons beyond a pixel's full well spill to its neighbours in the column; otherwise they are lost.
    pub blooming: bool,
    /// Mean dark current, electrons per second.
    pub dark_current_e_s: f64,
    /// Dark signal nonuniformity (DSNU): standard deviation of the pixels' offsets in the dark, electrons.
    pub dsnu_e: f64,
    /// Photo response nonuniformity (PRNU): standard deviation of the pixels' gains, a part of 1.
    pub prnu: f64,
    /// Fraction of hot pixels, 0…1.
    pub hot_pixel_fraction: f64,
    /// Their dark current, electrons per second.
    pub hot_pixel_e_s: f64,
    /// Standard deviation of the noise of reading, electrons.
    pub read_noise_e: f64,
    /// Electrons for a step of the converter.
    pub gain_e_dn: f64,
    /// The converter's number for no electrons.
    pub bias_dn: f64,
    /// Bits of its numbers.
    pub bits: u32,
}

/// A frame as the converter gives it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawFrame {
    /// Pixels of a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Bits of a number; the greatest is 2^bits − 1.
    pub bits: u32,
    /// Row by row from the top.
    pub data: Vec<u16>,
}

/// Content of the wells before they are read.
#[derive(Clone, Debug, PartialEq)]
pub struct Wells {
    /// Electrons of each pixel, row by row.
    pub electrons: Vec<f64>,
    /// Electrons that left at the ends of columns, or were more than a pixel holds where nothing blooms.
    pub lost_e: f64,
}

/// Most electrons that a mean is taken to be: a disc of the Sun in a long exposure stays finite.
const MOST_MEAN_E: f64 = 1e12;

impl Detector {
    /// Checks all numbers.
    ///
    /// # Errors
    /// The first that is out of range.
    pub fn check(&self) -> Result<(), SensorError> {
        check_range(
            "full_well_e",
            self.full_well_e,
            limits::FULL_WELL_E,
            " electrons",
        )?;
        for (key, current) in [
            ("dark_current_e_s", self.dark_current_e_s),
            ("hot_pixel_e_s", self.hot_pixel_e_s),
        ] {
            check_range(
                key,
                current,
                limits::DARK_CURRENT_E_S,
                " electrons per second",
            )?;
        }
        check_range("dsnu_e", self.dsnu_e, limits::NOISE_E, " electrons")?;
        check_range("prnu", self.prnu, limits::PART, "")?;
        check_range(
            "hot_pixel_fraction",
            self.hot_pixel_fraction,
            limits::PART,
            "",
        )?;
        check_range(
            "read_noise_e",
            self.read_noise_e,
            limits::NOISE_E,
            " electrons",
        )?;
        check_count("bits", self.bits, limits::BITS)?;
        check_range(
            "gain_e_dn",
            self.gain_e_dn,
            limits::GAIN_E_DN,
            " electrons per number",
        )?;
        check_range("bias_dn", self.bias_dn, 0.0..=f64::from(self.white()), "")
    }

    /// The greatest number of the converter.
    pub fn white(&self) -> u16 {
        ((1_u32 << self.bits.clamp(1, 16)) - 1) as u16
    }

    /// Whether a pixel is hot: constant for a seed.
    pub fn is_hot(&self, seed: u64, pixel: u32) -> bool {
        let mut random = PixelRandom::new(seed, pixel, 0, Stream::Hot);
        random.uniform() < self.hot_pixel_fraction
    }

    /// Collects electrons: `mean_e` are those that light makes on average, row by row.
    pub fn collect(
        &self,
        mean_e: &[f64],
        width: u32,
        exposure_s: f64,
        seed: u64,
        frame: u32,
    ) -> Wells {
        let pixels = mean_e.par_iter().zip(0..mean_e.len() as u32);
        let electrons = pixels.map(|(mean_e, pixel)| {
            let pattern = |stream| PixelRandom::new(seed, pixel, 0, stream).normal();
            let gain = match self.prnu > 0.0 {
                true => (1.0 + self.prnu * pattern(Stream::GainPattern)).max(0.0),
                false => 1.0,
            };
            let dark_e_s = match self.is_hot(seed, pixel) {
                true => self.hot_pixel_e_s,
                false => self.dark_current_e_s,
            };
            let mean = (mean_e * gain + dark_e_s * exposure_s).min(MOST_MEAN_E);
            PixelRandom::new(seed, pixel, frame, Stream::Shot).poisson(mean)
        });
        let mut electrons: Vec<f64> = electrons.collect();
        let lost_e = match self.blooming {
            true => self.bloom(&mut electrons, width as usize),
            false => self.clip(&mut electrons),
        };
        Wells { electrons, lost_e }
    }

    fn clip(&self, electrons: &mut [f64]) -> f64 {
        let mut lost = 0.0;
        for electrons in electrons {
            lost += (*electrons - self.full_well_e).max(0.0);
            *electrons = electrons.min(self.full_well_e);
        }
        lost
    }

    /// Half of a pixel's excess charge goes up its column and half down, to the first pixels with free capacity.
    fn bloom(&self, electrons: &mut [f64], width: usize) -> f64 {
        let height = electrons.len() / width.max(1);
        let mut lost = 0.0;
        let mut excess = vec![0.0; height];
        for x in 0..width {
            for (y, excess) in excess.iter_mut().enumerate() {
                let pixel = &mut electrons[y * width + x];
                *excess = (*pixel - self.full_well_e).max(0.0);
                *pixel = pixel.min(self.full_well_e);
            }
            // Electrons are whole: the odd one goes down.
            let mut flow = |rows: &mut dyn Iterator<Item = usize>, part: fn(f64) -> f64| {
                let mut carried = 0.0;
                for y in rows {
                    let pixel = &mut electrons[y * width + x];
                    let taken = f64::min(carried, self.full_well_e - *pixel).max(0.0);
                    *pixel += taken;
                    carried += part(excess[y]) - taken;
                }
                carried
            };
            lost += flow(&mut (0..height), |excess| (0.5 * excess).ceil());
            lost += flow(&mut (0..height).rev(), |excess| (0.5 * excess).floor());
        }
        lost
    }

    /// Reads the wells out.
    pub fn read(&self, wells: &Wells, width: u32, seed: u64, frame: u32) -> RawFrame {
        let white = f64::from(self.white());
        let pixels = wells
            .electrons
            .par_iter()
            .zip(0..wells.electrons.len() as u32);
        let data: Vec<u16> = pixels
            .map(|(electrons, pixel)| {
                let offset = match self.dsnu_e > 0.0 {
                    true => {
                        self.dsnu_e * PixelRandom::new(seed, pixel, 0, Stream::DarkPattern).normal()
                    }
                    false => 0.0,
                };
                let noise = match self.read_noise_e > 0.0 {
                    true => {
                        self.read_noise_e
                            * PixelRandom::new(seed, pixel, frame, Stream::Read).normal()
                    }
                    false => 0.0,
                };
                let number = self.bias_dn + (electrons + offset + noise) / self.gain_e_dn;
                (number + 0.5).floor().clamp(0.0, white) as u16
            })
            .collect();
        RawFrame {
            width,
            height: data.len() as u32 / width.max(1),
            bits: self.bits,
            data,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: u32 = 500;
    const PIXELS: usize = 250_000;

    fn quiet() -> Detector {
        Detector {
            full_well_e: 20_000.0,
            blooming: false,
            dark_current_e_s: 0.0,
            dsnu_e: 0.0,
            prnu: 0.0,
            hot_pixel_fraction: 0.0,
            hot_pixel_e_s: 0.0,
            read_noise_e: 0.0,
            gain_e_dn: 2.0,
            bias_dn: 100.0,
            bits: 14,
        }
    }

    /// Mean and temporal variance of flat fields, from the difference of two frames as in EMVA 1288.
    fn flat(detector: &Detector, mean_e: f64) -> (f64, f64) {
        let frames = [0, 1].map(|frame| {
            let wells = detector.collect(&[mean_e; PIXELS], WIDTH, 0.01, 42, frame);
            detector.read(&wells, WIDTH, 42, frame).data
        });
        let count = PIXELS as f64;
        let [first, second] =
            [0, 1].map(|k: usize| frames[k].iter().map(|n| f64::from(*n)).sum::<f64>() / count);
        let pairs = frames[0].iter().zip(&frames[1]);
        let squares: f64 = pairs
            .map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2))
            .sum();
        let variance = 0.5 * (squares / count - (first - second).powi(2));
        (0.5 * (first + second), variance)
    }

    /// The photon transfer curve of Janesick: variance over mean is 1/K below the full well, the intercept is the read noise, and
    /// variance breaks down at the full well.
    #[test]
    fn flat_fields_give_the_photon_transfer_curve() {
        let detector = Detector {
            read_noise_e: 12.0,
            dark_current_e_s: 50.0,
            dsnu_e: 5.0,
            prnu: 0.01,
            ..quiet()
        };
        let (dark_mean, dark_variance) = flat(&detector, 0.0);
        // Rounding adds 1/12 of a number².
        let read_e = ((dark_variance - 1.0 / 12.0) * 4.0 - 0.5).sqrt();
        assert!((read_e / 12.0 - 1.0).abs() < 0.01, "read noise {read_e} e");
        assert!((dark_mean - 100.25).abs() < 0.05, "{dark_mean}");
        let points = [500.0, 2000.0, 5000.0, 10_000.0, 15_000.0].map(|mean| flat(&detector, mean));
        let (x, y): (Vec<f64>, Vec<f64>) = points
            .iter()
            .map(|(mean, variance)| (mean - dark_mean, variance - dark_variance))
            .unzip();
        let slope = x.iter().zip(&y).map(|(x, y)| x * y).sum::<f64>()
            / x.iter().map(|x| x * x).sum::<f64>();
        eprintln!(
            "photon transfer: {:.4} e/DN, read noise {read_e:.3} e",
            1.0 / slope
        );
        assert!(
            (slope * detector.gain_e_dn - 1.0).abs() < 0.01,
            "slope {slope}"
        );
        let (full, left) = flat(&detector, 40_000.0);
        let full_well_e = (full - dark_mean) * detector.gain_e_dn;
        eprintln!("full well {full_well_e:.1} e, variance there {left:.2} DN²");
        assert!((full_well_e / 20_000.0 - 1.0).abs() < 0.01, "{full_well_e}");
        assert!(left < 1.05 * dark_variance, "{left}");
    }

    #[test]
    fn patterns_stay_from_frame_to_frame() {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let detector = Detector {
            prnu: 0.05,
            dsnu_e: 30.0,
            gain_e_dn: 0.5,
            bias_dn: 1000.0,
            bits: 16,
            ..quiet()
        };
        // Mean of 16 frames of one pixel each leaves the pattern.
        let spread = |light: f64| {
            let mut sums = vec![0.0; 20_000];
            for frame in 0..16 {
                let wells = detector.collect(&vec![light; sums.len()], 200, 1.0, 9, frame);
                let raw = detector.read(&wells, 200, 9, frame);
                for (sum, number) in sums.iter_mut().zip(raw.data) {
                    *sum += f64::from(number) * 0.5 / 16.0;
                }
            }
            let middle = mean(&sums);
            mean(
                &sums
                    .iter()
                    .map(|sum| (sum - middle).powi(2))
                    .collect::<Vec<_>>(),
            )
        };
        // Of 16 frames, rounding and shot noise are a sixteenth.
        let dark = spread(0.0).sqrt();
        assert!((dark / 30.0 - 1.0).abs() < 0.02, "{dark}");
        let lit = spread(8000.0) - 8000.0 / 16.0 - 900.0;
        assert!((lit.sqrt() / 400.0 - 1.0).abs() < 0.02, "{}", lit.sqrt());
    }

    #[test]
    fn hot_pixels_are_as_many_as_asked_for_and_as_hot() {
        let detector = Detector {
            hot_pixel_fraction: 0.01,
            hot_pixel_e_s: 3000.0,
            ..quiet()
        };
        let wells = detector.collect(&[0.0; PIXELS], WIDTH, 1.0, 5, 3);
        let hot: Vec<f64> = wells
            .electrons
            .iter()
            .copied()
            .filter(|e| *e > 0.0)
            .collect();
        assert!(
            (hot.len() as f64 / 2500.0 - 1.0).abs() < 0.06,
            "{}",
            hot.len()
        );
        let mean = hot.iter().sum::<f64>() / hot.len() as f64;
        assert!((mean / 3000.0 - 1.0).abs() < 0.002, "{mean}");
        let again = detector.collect(&[0.0; PIXELS], WIDTH, 1.0, 5, 4);
        let same = wells.electrons.iter().zip(&again.electrons);
        assert!(same.clone().all(|(a, b)| (*a > 0.0) == (*b > 0.0)));
        assert!(same.filter(|(a, b)| a != b).count() > 2000);
    }

    /// A bright spot in a column fills its neighbours; all electrons are accounted for.
    #[test]
    fn blooming_conserves_charge() {
        let detector = Detector {
            blooming: true,
            ..quiet()
        };
        let mut mean = vec![100.0; 9 * 41];
        mean[20 * 9 + 4] = 205_000.0;
        mean[4] = 90_000.0;
        let wells = detector.collect(&mean, 9, 0.1, 1, 0);
        let unlimited = Detector {
            full_well_e: 1e9,
            ..detector.clone()
        };
        let before: f64 = unlimited
            .collect(&mean, 9, 0.1, 1, 0)
            .electrons
            .iter()
            .sum();
        let after: f64 = wells.electrons.iter().sum();
        assert_eq!(after + wells.lost_e, before);
        let full = |y: usize| wells.electrons[y * 9 + 4] == 20_000.0;
        assert!((16..=24).all(full) && !full(14) && !full(26));
        assert!(
            wells.lost_e > 30_000.0 && wells.lost_e < 40_000.0,
            "{}",
            wells.lost_e
        );
        assert!(
            wells
                .electrons
                .iter()
                .all(|e| *e <= 20_000.0 && e.fract() == 0.0)
        );
        assert!((0..41).all(|y| wells.electrons[y * 9 + 3] < 200.0));
    }

    #[test]
    fn impossible_detectors_are_rejected_by_key() {
        let keys = [
            Detector {
                full_well_e: 0.0,
                ..quiet()
            },
            Detector {
                bits: 17,
                ..quiet()
            },
            Detector {
                read_noise_e: f64::NAN,
                ..quiet()
            },
            Detector {
                bias_dn: 20_000.0,
                ..quiet()
            },
        ]
        .map(|detector| detector.check().expect_err("rejected").key());
        assert_eq!(keys, ["full_well_e", "bits", "read_noise_e", "bias_dn"]);
    }

    /// One thread or many, the same numbers.
    #[test]
    fn a_seed_is_a_frame() {
        let detector = Detector {
            read_noise_e: 3.0,
            ..quiet()
        };
        let frame = |threads: usize, seed: u64| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            pool.install(|| {
                let wells = detector.collect(&[500.0; 10_000], 100, 0.1, seed, 2);
                detector.read(&wells, 100, seed, 2)
            })
        };
        assert_eq!(frame(1, 8), frame(3, 8));
        assert_ne!(frame(1, 8), frame(1, 9));
    }
}
