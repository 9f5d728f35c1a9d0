//! Exposure: the factor applied to light before display.

use std::ops::RangeInclusive;

/// Brightness of the displayed light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// A fixed exposure value (EV): light is multiplied by 2 to this power. In [`Self::RANGE_EV`].
    Ev(f64),
    /// Metered for each frame on the CPU from the visible scene. A grid of rays samples the view. The mean luminance of the brightest
    /// tenth of visible ground and atmosphere is displayed as 0.7, limited to −4…6 EV. The result depends only on the view, the Sun and
    /// the maps, never on earlier frames: equal frames have equal bytes.
    Auto,
}

impl Exposure {
    /// Accepted exposure values.
    pub const RANGE_EV: RangeInclusive<f64> = -20.0..=20.0;

    /// The default: sunlit clouds appear just below white.
    pub const DEFAULT_EV: f64 = 0.5;

    /// The exposure value; for a metered exposure without a view, the default.
    pub fn fixed_ev(self) -> f64 {
        match self {
            Self::Ev(ev) => ev,
            Self::Auto => Self::DEFAULT_EV,
        }
    }

    /// Accepts a metered exposure or a value in its range. Otherwise the error is the value.
    pub fn check(self) -> Result<Self, f64> {
        match self {
            Self::Ev(ev) if !Self::RANGE_EV.contains(&ev) => Err(ev),
            good => Ok(good),
        }
    }
}

impl Default for Exposure {
    fn default() -> Self {
        Self::Ev(Self::DEFAULT_EV)
    }
}

/// Factor of light at an exposure value.
pub fn exposure_factor(ev: f64) -> f64 {
    ev.exp2()
}

/// Follows a metered exposure over time, as eyes and cameras do, so that consecutive frames do not jump.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Adaptation {
    ev: Option<f64>,
}

impl Adaptation {
    /// Time after which 63 % of a change is applied, seconds.
    pub const TIME_CONSTANT_S: f64 = 0.8;

    /// The exposure of a frame, EV. The first frame uses `metered_ev`; later ones depend on the time since the previous
    /// frame, seconds; infinity adapts at once. The same sequence of times gives the same values, independent of drawing speed.
    pub fn follow(&mut self, metered_ev: f64, elapsed_s: f64) -> f64 {
        let part = 1.0 - (-elapsed_s.max(0.0) / Self::TIME_CONSTANT_S).exp();
        let ev = match self.ev {
            Some(before) => before + part * (metered_ev - before),
            None => metered_ev,
        };
        self.ev = Some(ev);
        ev
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_outside_the_range_are_none() {
        for ev in [-20.0, 0.0, 20.0] {
            assert_eq!(Exposure::Ev(ev).check(), Ok(Exposure::Ev(ev)));
        }
        for ev in [-20.1, 20.1, f64::INFINITY, f64::NAN] {
            assert!(Exposure::Ev(ev).check().is_err(), "{ev}");
        }
        assert_eq!(Exposure::Auto.check(), Ok(Exposure::Auto));
    }

    #[test]
    fn after_an_infinite_time_nothing_is_left_of_the_exposure_before() {
        let mut adaptation = Adaptation::default();
        adaptation.follow(1.0, 0.0);
        assert_eq!(adaptation.follow(-7.5, f64::INFINITY), -7.5);
    }

    #[test]
    fn a_change_is_followed_the_same_at_any_frame_rate() {
        let follow = |frames: u32| {
            let mut adaptation = Adaptation::default();
            assert_eq!(adaptation.follow(1.0, 5.0), 1.0);
            let step = Adaptation::TIME_CONSTANT_S / f64::from(frames);
            (0..frames).fold(1.0, |_, _| adaptation.follow(3.0, step))
        };
        let expected = 3.0 - 2.0 * (-1.0_f64).exp();
        for frames in [1, 7, 240] {
            assert!((follow(frames) - expected).abs() < 1e-9, "{frames}");
        }
    }
}
