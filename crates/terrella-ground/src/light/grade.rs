//! Camera processing besides the tone curve: white balance before it, grain after it.

use super::grain::Grain;
use super::white_balance::WhiteBalance;
use glam::{DMat3, DVec3};

/// White balance and grain, applied when the light is developed after the pass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grade {
    /// The light that appears white. `None` leaves colours unchanged at no cost.
    pub white_balance: Option<WhiteBalance>,
    /// Film grain; a strength of 0 disables it at no cost.
    pub grain: Grain,
}

impl Grade {
    /// No change of light.
    pub const NONE: Self = Self {
        white_balance: None,
        grain: Grain::NONE,
    };

    /// Matrix of the white balance for exposed light; `None` without one. It is applied before the tone curve. Negative results are
    /// displayed as black.
    pub fn balance(&self) -> Option<DMat3> {
        self.white_balance.map(|balance| balance.matrix())
    }

    /// Largest growth of an error of light in each channel by a white balance, for an equal error in
    /// all channels.
    pub(super) fn gains(balance: &DMat3) -> DVec3 {
        let [x, y, z] = [balance.x_axis, balance.y_axis, balance.z_axis].map(DVec3::abs);
        x + y + z
    }

    /// Largest gain of a channel by the white balance; 1 without one.
    pub fn largest_gain(&self) -> f64 {
        let balance = self.balance();
        balance.map_or(1.0, |matrix| Self::gains(&matrix).max_element())
    }

    /// Exposed light before the white balance, for light after it.
    pub fn before_balance(&self, light: DVec3) -> DVec3 {
        match self.balance() {
            Some(matrix) => matrix.inverse() * light,
            None => light,
        }
    }

    /// The first key outside its range, with its value and the range.
    pub fn fault(&self) -> Option<(&'static str, f64, [f64; 2])> {
        let grain = &self.grain;
        let of_balance = self.white_balance.map(|balance| {
            [
                (
                    "white_balance_k",
                    balance.temperature_k,
                    &WhiteBalance::TEMPERATURES_K,
                ),
                ("tint", balance.tint, &WhiteBalance::TINTS),
            ]
        });
        let of_grain = [
            ("grain", grain.strength, &Grain::STRENGTHS),
            ("grain_size_px", grain.size_px, &Grain::SIZES_PX),
        ];
        let all = of_balance.into_iter().flatten().chain(of_grain);
        let mut faults = all.filter(|(_, value, range)| !range.contains(value));
        faults
            .next()
            .map(|(key, value, range)| (key, value, [*range.start(), *range.end()]))
    }
}
