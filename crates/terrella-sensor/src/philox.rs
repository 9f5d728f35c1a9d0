//! Random numbers that are a function of a key and a counter: the same pixel has the same noise in any order and on any thread.
//!
//! Philox 4×32-10 of Salmon, Moraes, Dror and Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3".

/// Multipliers and Weyl increments of the paper.
const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const ROUNDS: usize = 10;

/// Four words from a counter and a key.
fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..ROUNDS {
        let product = |k: usize| u64::from(MULTIPLIERS[k]) * u64::from(counter[2 * k]);
        let (first, second) = (product(0), product(1));
        let (high, low) = (|p: u64| (p >> 32) as u32, |p: u64| p as u32);
        counter = [
            high(second) ^ counter[1] ^ key[0],
            low(second),
            high(first) ^ counter[3] ^ key[1],
            low(first),
        ];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    counter
}

/// Purpose of a random number. Streams of one pixel are independent of each other.
#[derive(Clone, Copy, Debug)]
#[repr(u32)]
pub(crate) enum Stream {
    /// Photons and dark current.
    Shot,
    /// The amplifier.
    Read,
    /// Offsets of pixels in the dark; the same in all frames.
    DarkPattern,
    /// Gains of pixels; the same in all frames.
    GainPattern,
    /// Which pixels are hot; the same in all frames.
    Hot,
}

/// Random numbers of one pixel, frame and purpose.
#[derive(Clone, Debug)]
pub(crate) struct PixelRandom {
    key: [u32; 2],
    pixel: u32,
    frame: u32,
    stream: u32,
    drawn: u32,
    left: Option<u64>,
}

impl PixelRandom {
    pub(crate) fn new(seed: u64, pixel: u32, frame: u32, stream: Stream) -> Self {
        Self {
            key: [seed as u32, (seed >> 32) as u32],
            pixel,
            frame,
            stream: stream as u32,
            drawn: 0,
            left: None,
        }
    }

    fn word(&mut self) -> u64 {
        if let Some(word) = self.left.take() {
            return word;
        }
        let words = philox([self.pixel, self.frame, self.stream, self.drawn], self.key);
        self.drawn = self.drawn.wrapping_add(1);
        let join = |a: u32, b: u32| u64::from(a) | u64::from(b) << 32;
        self.left = Some(join(words[2], words[3]));
        join(words[0], words[1])
    }

    /// Uniform over the open interval 0…1: 52 bits and a half step, so that neither end is drawn.
    pub(crate) fn uniform(&mut self) -> f64 {
        const STEP: f64 = 1.0 / (1_u64 << 52) as f64;
        ((self.word() >> 12) as f64 + 0.5) * STEP
    }

    /// Normal with mean 0 and standard deviation 1, by Box and Muller.
    pub(crate) fn normal(&mut self) -> f64 {
        let (radius, turn) = (self.uniform(), self.uniform());
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * turn).cos()
    }

    /// Poisson with this mean; 0 for means that are not positive.
    pub(crate) fn poisson(&mut self, mean: f64) -> f64 {
        match mean {
            mean if mean.is_nan() || mean <= 0.0 => 0.0,
            mean if mean < SMALL_MEAN => self.poisson_by_inversion(mean),
            mean => self.poisson_by_rejection(mean),
        }
    }

    /// The distribution function searched from 0 upwards.
    fn poisson_by_inversion(&mut self, mean: f64) -> f64 {
        let target = self.uniform();
        let (mut count, mut term) = (0.0, (-mean).exp());
        let mut sum = term;
        // Terms vanish long before a mean of at most 30 has come to this.
        while sum < target && count < 300.0 {
            count += 1.0;
            term *= mean / count;
            sum += term;
        }
        count
    }

    /// Transformed rejection with squeeze (PTRS) of Hörmann 1993, "The transformed rejection method for generating Poisson random
    /// variables", Insurance: Mathematics and Economics 12, 39.
    fn poisson_by_rejection(&mut self, mean: f64) -> f64 {
        let b = 0.931 + 2.53 * mean.sqrt();
        let a = -0.059 + 0.024_83 * b;
        let inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
        let v_r = 0.9277 - 3.6224 / (b - 2.0);
        loop {
            let u = self.uniform() - 0.5;
            let v = self.uniform();
            let us = 0.5 - u.abs();
            let k = ((2.0 * a / us + b) * u + mean + 0.43).floor();
            if us >= 0.07 && v <= v_r {
                return k;
            }
            if k < 0.0 || us < 0.013 && v > us {
                continue;
            }
            let left = v.ln() + inverse_alpha.ln() - (a / (us * us) + b).ln();
            if left <= k * mean.ln() - mean - ln_factorial(k) {
                return k;
            }
        }
    }
}

/// Means below are drawn by inversion; rejection holds from 10 upwards.
const SMALL_MEAN: f64 = 30.0;

/// ln k!, by Stirling's series (Abramowitz and Stegun 6.1.41) at k + 1 ≥ 10, and by products below.
fn ln_factorial(k: f64) -> f64 {
    let mut x = k + 1.0;
    let mut product = 1.0;
    while x < 10.0 {
        product *= x;
        x += 1.0;
    }
    let z = 1.0 / (x * x);
    let series = (1.0 / 12.0 - z * (1.0 / 360.0 - z * (1.0 / 1260.0 - z / 1680.0))) / x;
    (x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series - f64::ln(product)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `kat_vectors` of the authors' Random123 1.14: philox4x32 10.
    #[test]
    fn the_published_vectors_come_out() {
        let ones = u32::MAX;
        for (counter, key, wanted) in [
            (
                [0; 4],
                [0; 2],
                [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8],
            ),
            (
                [ones; 4],
                [ones; 2],
                [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd],
            ),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ] {
            assert_eq!(philox(counter, key), wanted);
        }
    }

    /// The distribution function at integers against sums in f64 of its definition, by Kolmogorov's distance.
    #[test]
    fn counts_are_poisson_on_both_sides_of_the_switch() {
        const DRAWS: u32 = 200_000;
        for mean in [0.05, 1.0, 8.0, 29.9, 30.1, 100.0, 3000.0] {
            let mut counts = std::collections::BTreeMap::<u64, u32>::new();
            for pixel in 0..DRAWS {
                let drawn = PixelRandom::new(7, pixel, 0, Stream::Shot).poisson(mean);
                *counts.entry(drawn as u64).or_default() += 1;
            }
            let (mut expected, mut seen, mut worst) = (0.0_f64, 0.0_f64, 0.0_f64);
            let last = *counts.keys().last().expect("draws");
            let mut ln_k = 0.0;
            for k in 0..=last {
                ln_k += if k > 0 { (k as f64).ln() } else { 0.0 };
                expected += (k as f64 * f64::ln(mean) - mean - ln_k).exp();
                seen += f64::from(counts.get(&k).copied().unwrap_or(0)) / f64::from(DRAWS);
                worst = worst.max((expected - seen).abs());
            }
            // 1.95/√n is passed once in a thousand times.
            assert!(worst < 1.95 / f64::from(DRAWS).sqrt(), "{mean}: {worst}");
        }
    }

    #[test]
    fn factorials_are_those_of_products() {
        let mut exact = 0.0;
        for k in 1..400_u32 {
            exact += f64::from(k).ln();
            let found = ln_factorial(f64::from(k));
            assert!(
                (found - exact).abs() < 1e-10 * exact.max(1.0),
                "{k}: {found} {exact}"
            );
        }
    }

    #[test]
    fn normals_have_their_moments() {
        let draws = (0..400_000).map(|pixel| PixelRandom::new(3, pixel, 1, Stream::Read).normal());
        let [mut mean, mut square, mut fourth] = [0.0; 3];
        for x in draws {
            mean += x / 4e5;
            square += x * x / 4e5;
            fourth += x.powi(4) / 4e5;
        }
        assert!(
            mean.abs() < 0.006 && (square - 1.0).abs() < 0.009,
            "{mean} {square}"
        );
        assert!((fourth - 3.0).abs() < 0.06, "{fourth}");
    }
}
