//! Exposure: what light is multiplied by before it is shown.

use std::ops::RangeInclusive;

/// How bright light is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// Always the same exposure value (EV): light is multiplied by 2 to the power of it. In [`Self::RANGE_EV`].
    Ev(f64),
    /// Each frame's own, metered on the processor from what is in view: of a grid of rays, the mean luminance of the
    /// brightest tenth of ground and air in sight is shown as 0.7, with at least −4 EV and at most 6. Only the view, the Sun and the maps
    /// decide, never the frames before: the same frame gives the same bytes.
    Auto,
}

impl Exposure {
    /// Exposure values that are taken.
    pub const RANGE_EV: RangeInclusive<f64> = -20.0..=20.0;

    /// The default: clouds in full sunlight are shown just below white.
    pub const DEFAULT_EV: f64 = 0.5;

    /// The value; of a metered exposure, where there is no view to meter, the default.
    pub fn fixed_ev(self) -> f64 {
        match self {
            Self::Ev(ev) => ev,
            Self::Auto => Self::DEFAULT_EV,
        }
    }

    /// The value, where it is a finite number in its range or metered; else what is wrong is the number itself.
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

/// What light is multiplied by at an exposure value.
pub fn exposure_factor(ev: f64) -> f64 {
    ev.exp2()
}

/// A metered exposure that is followed in time as eyes and cameras do: frames that come one after another do not jump.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Adaptation {
    ev: Option<f64>,
}

impl Adaptation {
    /// After this time 63 % of a change has been followed, seconds.
    pub const TIME_CONSTANT_S: f64 = 0.8;

    /// The exposure of a frame, EV: `metered_ev` for the first, later ones by the time since the frame before, seconds.
    /// Frames in order of the same times give the same values, however fast they are drawn.
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
