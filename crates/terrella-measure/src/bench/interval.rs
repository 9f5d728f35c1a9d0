//! By how much a row has become slower, and the uncertainty of that ratio.

use crate::{SortedSample, median};

/// A ratio of times with an interval of confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The ratio found.
    pub median: f64,
    /// Least and largest ratio that noise leaves open; `None` of too few pairs.
    pub bounds: Option<(f64, f64)>,
}

/// Pairs of frames below which nothing is said.
const LEAST_PAIRS: usize = 8;
/// Number of bootstrap samples.
const RESAMPLED: usize = 4000;
/// Fixed, so that the same two files give the same result.
const SEED: u64 = 0x7e22_e11a;

impl Interval {
    /// The median of now ÷ before over all pairs, frame by frame, with the interval of the percentile bootstrap (Efron and Tibshirani 1993, chapter
    /// 13) at this confidence (0…1).
    ///
    /// Both have a list of frames for each run; frames of the same number show the same view. Resampling, with replacement, draws first a run of
    /// each side and then frames, so that the interval reflects the variation between runs and between frames. With a single run on a side, the
    /// variation between runs is unknown.
    pub fn of(before: &[Vec<f64>], now: &[Vec<f64>], confidence: f64) -> Self {
        let frames = before.iter().chain(now).map(Vec::len).min().unwrap_or(0);
        let quotients = |a: &[f64], b: &[f64], of: &mut Vec<f64>| {
            of.extend(a.iter().zip(b).map(|(before, now)| now / before.max(1e-9)));
        };
        let mut all = Vec::new();
        for before in before {
            for now in now {
                quotients(before, now, &mut all);
            }
        }
        let found = median(&all);
        if frames < LEAST_PAIRS {
            return Self {
                median: found,
                bounds: None,
            };
        }
        let mut random = SplitMix(SEED);
        let runs = before.len().max(now.len());
        let mut medians = Vec::with_capacity(RESAMPLED);
        let mut drawn = Vec::with_capacity(runs * frames);
        for _ in 0..RESAMPLED {
            drawn.clear();
            for _ in 0..runs {
                let before = &before[random.below(before.len())];
                let now = &now[random.below(now.len())];
                for _ in 0..frames {
                    let n = random.below(frames);
                    drawn.push(now[n] / before[n].max(1e-9));
                }
            }
            medians.push(median(&drawn));
        }
        let medians = SortedSample::new(medians);
        let tail = 0.5 * (1.0 - confidence);
        Self {
            median: found,
            bounds: Some((medians.quantile(tail), medians.quantile(1.0 - tail))),
        }
    }

    /// Whether all of it is above 1 + `effect`.
    pub fn is_slower(&self, effect: f64) -> bool {
        self.bounds.is_some_and(|(least, _)| least > 1.0 + effect)
    }

    /// Whether all of it is below 1/(1 + `effect`).
    pub fn is_faster(&self, effect: f64) -> bool {
        let most = 1.0 / (1.0 + effect);
        self.bounds.is_some_and(|(_, largest)| largest < most)
    }
}

impl std::fmt::Display for Interval {
    /// As per cent: "+30 %, from +22 to +38".
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let percent = |times: f64| 100.0 * (times - 1.0);
        write!(f, "{:+.0} %", percent(self.median))?;
        match self.bounds {
            Some((least, most)) => {
                write!(f, ", from {:+.0} to {:+.0}", percent(least), percent(most))
            }
            None => write!(f, ", too few frames to tell"),
        }
    }
}

/// Steele, Lea and Flood 2014.
struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `count`, which is more than 0.
    fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.next()) * count as u128) >> 64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frame over floor with noise of a part, `runs` runs of `frames`, each run off by up to `apart`.
    fn noisy(seed: u64, level: f64, frames: usize, runs: usize, apart: f64) -> Vec<Vec<f64>> {
        let mut random = SplitMix(seed);
        let mut part = || random.next() as f64 / u64::MAX as f64 - 0.5;
        (0..runs)
            .map(|_| {
                let run = level * (1.0 + 2.0 * apart * part());
                (0..frames).map(|_| run * (1.0 + 0.2 * part())).collect()
            })
            .collect()
    }

    #[test]
    fn a_change_beyond_the_noise_is_found_and_noise_is_not() {
        let confidence = 1.0 - 0.05 / 24.0;
        let mut wrong = 0;
        for seed in 0..60 {
            let before = noisy(2 * seed, 1.5, 24, 3, 0.05);
            let same = noisy(2 * seed + 1, 1.5, 24, 3, 0.05);
            wrong += u32::from(Interval::of(&before, &same, confidence).is_slower(0.05));
            let slower = noisy(2 * seed + 1, 1.5 * 1.3, 24, 3, 0.05);
            let found = Interval::of(&before, &slower, confidence);
            assert!(
                found.is_slower(0.05) && !found.is_faster(0.05),
                "{seed}: {found:?}"
            );
            let back = Interval::of(&slower, &before, confidence);
            assert!(
                back.is_faster(0.05) && !back.is_slower(0.05),
                "{seed}: {back:?}"
            );
        }
        assert_eq!(wrong, 0);
    }

    #[test]
    fn runs_that_differ_widen_the_interval() {
        let wide = |apart: f64| {
            let runs = [noisy(1, 1.0, 24, 3, apart), noisy(2, 1.0, 24, 3, apart)];
            let (least, most) = Interval::of(&runs[0], &runs[1], 0.95)
                .bounds
                .expect("enough");
            most - least
        };
        assert!(wide(0.2) > 2.0 * wide(0.0), "{} {}", wide(0.2), wide(0.0));
    }

    #[test]
    fn few_frames_say_nothing_and_the_same_data_the_same() {
        let few = Interval::of(&[vec![1.0; 7]], &[vec![9.0; 7]], 0.95);
        assert_eq!((few.median, few.bounds), (9.0, None));
        assert!(!few.is_slower(0.05) && !few.is_faster(0.05));
        let data = [noisy(3, 1.0, 24, 1, 0.0), noisy(4, 1.1, 24, 1, 0.0)];
        let first = Interval::of(&data[0], &data[1], 0.99);
        assert_eq!(first, Interval::of(&data[0], &data[1], 0.99));
        let (least, most) = first.bounds.expect("enough");
        assert!(least < first.median && first.median < most, "{first:?}");
    }
}
