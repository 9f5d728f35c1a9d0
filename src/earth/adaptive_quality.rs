//! Holds a frame time by reducing quality: a state machine without a clock.

use super::quality_ladder::QualityLevel;

/// Number of frames whose median cost decides a change.
const WINDOW: usize = 15;
/// Frames after a change that do not count: the first frame of a pipeline takes longer.
const SETTLING: u32 = 3;
/// A step up is taken only if it is expected to need at most this part of the target.
const HEADROOM: f64 = 0.85;
/// Frames between a change and the first step up.
const SHORTEST_HOLD: u32 = 60;
/// The measured cost ratio of a step is trusted for this many hold times.
const TRUSTED_HOLDS: f64 = 8.0;
/// Upper limit of the hold after failed steps up, in frames: some minutes.
const LONGEST_HOLD: u32 = 1 << 14;

/// Chooses among the levels of a [`super::QualityLadder`] by the measured cost of frames.
///
/// - **Down** one level as soon as the median cost of the last 15 frames exceeds the target.
/// - **Up** one level when the level above is expected to need at most 0.85 of the target, and at least 60 frames have passed since the last
///   change. The expected cost is the highest cost of the current level in that time, multiplied by the cost ratio of the two levels that was
///   measured when the level above was left. The load may have changed at that moment, so the ratio is trusted for eight times the wait. After n
///   times that, its nth root is used.
/// - **Hysteresis**: each step up that has to be reverted doubles the wait before the next, up to 16 384 frames. A step that lasts that long resets
///   the wait to 60.
///
/// It keeps no clock: the same costs give the same steps.
#[derive(Clone, Debug)]
pub struct AdaptiveQuality {
    target_ms: f64,
    levels: Vec<QualityLevel>,
    level: usize,
    recent: Vec<f64>,
    next: usize,
    since_change: u32,
    hold: u32,
    /// Largest median of the current and of the previous stretch of `hold` frames, and the age of the current one.
    peaks: [f64; 2],
    peak_age: u32,
    /// Whether the last change was a step up.
    climbed: bool,
    /// For each level, its cost relative to the level below, as measured at the last step between the two.
    ratio_to_next: Vec<Option<f64>>,
    /// Cost before the last change, for the ratio.
    cost_before: Option<f64>,
    /// Median cost of the last frames of the last level, where it exceeds the target.
    out_of_reach_ms: Option<f64>,
}

/// A change of level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QualityChange {
    /// The level to draw from now on, 0 the full quality.
    pub level: usize,
    /// Median cost of the last frames, milliseconds.
    pub cost_ms: f64,
}

impl AdaptiveQuality {
    /// Holds frames to `target_ms` milliseconds. `levels` has at least one level. It starts on the first.
    pub fn new(target_ms: f64, levels: Vec<QualityLevel>) -> Self {
        Self {
            target_ms,
            ratio_to_next: vec![None; levels.len()],
            levels,
            level: 0,
            recent: Vec::with_capacity(WINDOW),
            next: 0,
            since_change: 0,
            hold: SHORTEST_HOLD,
            peaks: [0.0; 2],
            peak_age: 0,
            climbed: false,
            cost_before: None,
            out_of_reach_ms: None,
        }
    }

    /// The target frame time, milliseconds.
    pub fn target_ms(&self) -> f64 {
        self.target_ms
    }

    /// The current level.
    pub fn level(&self) -> usize {
        self.level
    }

    /// All levels, the full quality first.
    pub fn levels(&self) -> &[QualityLevel] {
        &self.levels
    }

    /// The reductions in effect, in the order in which they were applied; empty at full quality.
    pub fn reductions(&self) -> impl Iterator<Item = super::QualityReduction> + '_ {
        let levels = self.levels.iter().take(self.level + 1);
        levels.flat_map(|level| level.reductions.iter().copied())
    }

    /// Median cost of the last 15 frames, milliseconds, if it exceeds the target even on the last level. Otherwise `None`, also in the first frames
    /// after a change, before the median is known.
    pub fn out_of_reach_ms(&self) -> Option<f64> {
        self.out_of_reach_ms
    }

    /// Records the cost of a frame, milliseconds. Returns the change to apply before the next frame, if any. A non-finite cost is skipped.
    pub fn observe(&mut self, cost_ms: f64) -> Option<QualityChange> {
        if !cost_ms.is_finite() {
            return None;
        }
        self.since_change = self.since_change.saturating_add(1);
        if self.since_change <= SETTLING {
            return None;
        }
        if self.recent.len() < WINDOW {
            self.recent.push(cost_ms);
        } else {
            self.recent[self.next] = cost_ms;
        }
        self.next = (self.next + 1) % WINDOW;
        if self.recent.len() < WINDOW {
            return None;
        }
        let cost = self.median();
        let is_last = self.level + 1 >= self.levels.len();
        self.out_of_reach_ms = (is_last && cost > self.target_ms).then_some(cost);
        self.learn(cost);
        self.keep_peak(cost);
        if self.climbed && self.since_change >= LONGEST_HOLD {
            self.hold = SHORTEST_HOLD;
        }
        if cost > self.target_ms && !is_last {
            if self.climbed && self.since_change < LONGEST_HOLD {
                self.hold = (2 * self.hold).min(LONGEST_HOLD);
            }
            return Some(self.change(self.level + 1, cost));
        }
        let above = self.level.checked_sub(1)?;
        let rested = self.since_change >= self.hold;
        let trust = TRUSTED_HOLDS * f64::from(self.hold) / f64::from(self.since_change);
        let ratio = self.ratio_to_next[above].unwrap_or(1.0);
        let worst = self.peaks[0].max(self.peaks[1]);
        let expected = worst * ratio.powf(trust.min(1.0));
        (rested && expected <= HEADROOM * self.target_ms).then(|| self.change(above, cost))
    }

    fn change(&mut self, level: usize, cost_ms: f64) -> QualityChange {
        self.climbed = level < self.level;
        self.level = level;
        self.cost_before = Some(cost_ms);
        self.since_change = 0;
        self.out_of_reach_ms = None;
        self.peaks = [0.0; 2];
        self.peak_age = 0;
        self.recent.clear();
        self.next = 0;
        QualityChange { level, cost_ms }
    }

    fn keep_peak(&mut self, cost: f64) {
        self.peak_age += 1;
        if self.peak_age >= self.hold {
            self.peaks = [cost, self.peaks[0]];
            self.peak_age = 0;
        }
        self.peaks[0] = self.peaks[0].max(cost);
    }

    /// The first full window after a change gives the cost ratio of the two levels.
    fn learn(&mut self, cost: f64) {
        let Some(before) = self.cost_before.take() else {
            return;
        };
        let (upper, ratio) = match self.climbed {
            true => (self.level, cost / before),
            false => (self.level - 1, before / cost),
        };
        if ratio.is_finite() {
            // Noise may make a level appear more expensive than the one above.
            self.ratio_to_next[upper] = Some(ratio.max(1.0));
        }
    }

    fn median(&self) -> f64 {
        let mut sorted = [0.0; WINDOW];
        sorted.copy_from_slice(&self.recent);
        sorted.sort_unstable_by(f64::total_cmp);
        sorted[WINDOW / 2]
    }
}

#[cfg(test)]
mod tests {
    use super::super::quality::{Quality, QualityReduction};
    use super::*;
    use terrella_ground::air::Atmosphere;

    const FULL: Quality = Quality {
        subdivision: terrella_ground::globe::Subdivision::Auto,
        anisotropy: 8,
        samples: 4,
        texel_px: 1.0,
        maps: [true; terrella_imagery::tile::MAP_LAYERS],
        atmosphere: Atmosphere::Billboard,
        scale: 1.0,
    };

    /// Five levels that cost 30, 24, 16, 10 and 6 ms at a load of 1.
    const COSTS: [f64; 5] = [30.0, 24.0, 16.0, 10.0, 6.0];

    fn adaptive(target_ms: f64) -> AdaptiveQuality {
        let level = |(n, cost): (usize, &f64)| QualityLevel {
            reductions: vec![QualityReduction::Relief; n.min(1)],
            quality: FULL,
            cost: cost / COSTS[0],
            error: 0.0,
        };
        AdaptiveQuality::new(target_ms, COSTS.iter().enumerate().map(level).collect())
    }

    /// Draws frames under this load and returns the levels that were changed to.
    fn draw(
        adaptive: &mut AdaptiveQuality,
        frames: usize,
        load: impl Fn(usize) -> f64,
    ) -> Vec<usize> {
        (0..frames)
            .filter_map(|frame| {
                let cost = COSTS[adaptive.level()] * load(frame);
                adaptive.observe(cost).map(|change| change.level)
            })
            .collect()
    }

    #[test]
    fn it_goes_down_until_the_target_is_held_and_no_farther() {
        let mut adaptive = adaptive(17.0);
        assert_eq!(draw(&mut adaptive, 100, |_| 1.0), [1, 2]);
        assert_eq!(draw(&mut adaptive, 10_000, |_| 1.0), [0_usize; 0]);
        assert_eq!(adaptive.reductions().count(), 2);
    }

    #[test]
    fn a_target_that_is_held_changes_nothing_and_one_out_of_reach_ends_at_the_last_rung() {
        let mut easy = adaptive(31.0);
        assert_eq!(draw(&mut easy, 1_000, |_| 1.0), [0_usize; 0]);
        let mut hopeless = adaptive(1.0);
        assert_eq!(draw(&mut hopeless, 1_000, |_| 1.0), [1, 2, 3, 4]);
    }

    #[test]
    fn it_says_when_the_target_is_out_of_reach() {
        let mut adaptive = adaptive(5.0);
        // No step before the last reports that the target is out of reach.
        while adaptive.level() < 4 {
            draw(&mut adaptive, 1, |_| 1.0);
            assert_eq!(adaptive.out_of_reach_ms(), None);
        }
        draw(&mut adaptive, 17, |_| 1.0);
        assert_eq!(adaptive.out_of_reach_ms(), None, "too early to say");
        draw(&mut adaptive, 1, |_| 1.0);
        assert_eq!(adaptive.out_of_reach_ms(), Some(6.0));
        draw(&mut adaptive, 15, |_| 0.8);
        assert_eq!(adaptive.out_of_reach_ms(), None, "it is held again");
    }

    #[test]
    fn it_comes_back_when_the_load_falls() {
        let mut adaptive = adaptive(17.0);
        draw(&mut adaptive, 100, |_| 1.0);
        // Twice as fast: full quality costs 15 ms, and 0.85 × 17 ms is 14.45.
        assert_eq!(draw(&mut adaptive, 400, |_| 0.5), [1]);
        assert_eq!(draw(&mut adaptive, 400, |_| 0.4), [0]);
    }

    #[test]
    fn single_long_frames_change_nothing() {
        let mut adaptive = adaptive(17.0);
        draw(&mut adaptive, 100, |_| 1.0);
        let spikes = |frame: usize| if frame.is_multiple_of(4) { 5.0 } else { 1.0 };
        assert_eq!(draw(&mut adaptive, 1_000, spikes), [0_usize; 0]);
        assert_eq!(adaptive.observe(f64::NAN), None);
    }

    #[test]
    fn a_load_that_hovers_does_not_toggle() {
        // 17 ms lies within the swing of the second level; the load swings a hundred times.
        let mut adaptive = adaptive(17.0);
        let swing = |frame: usize| 1.0 + 0.1 * (frame as f64 / 32.0).sin();
        let changes = draw(&mut adaptive, 20_000, swing);
        assert!(changes.len() <= 12, "{changes:?}");
    }

    #[test]
    fn a_load_that_falls_with_a_step_down_does_not_hold_it_down() {
        let mut adaptive = adaptive(17.0);
        let mut frames = 0;
        // From the first step on, everything is ten times as fast: the step seems to save ten times as much as it does.
        while frames < 2_000 && (frames < 40 || adaptive.level() > 0) {
            let load = if adaptive.level() == 0 { 1.0 } else { 0.1 };
            let load = if frames < 40 { load } else { 0.1 };
            adaptive.observe(COSTS[adaptive.level()] * load);
            frames += 1;
        }
        assert!(frames < 1_000, "{frames}");
    }

    #[test]
    fn steps_up_that_fail_become_rare() {
        // The learned ratio is wrong each time: the load falls only while the lower level is drawn.
        let mut adaptive = adaptive(17.0);
        let mut changes = 0;
        for _ in 0..100_000 {
            let load = if adaptive.level() >= 2 { 0.4 } else { 1.0 };
            changes += usize::from(adaptive.observe(COSTS[adaptive.level()] * load).is_some());
        }
        assert!((4..40).contains(&changes), "{changes}");
    }
}
