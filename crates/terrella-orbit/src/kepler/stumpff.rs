//! Stumpff's functions, which generalise sine and hyperbolic sine to all conics.

/// c0…c3 at one argument: c_k(ψ) = Σ (−ψ)^j / (2j + k)!.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stumpff {
    pub c0: f64,
    pub c1: f64,
    pub c2: f64,
    pub c3: f64,
}

/// Up to this |ψ| the series is summed: beyond it no form below cancels more than three bits.
const SERIES_TO: f64 = 2.0;

impl Stumpff {
    /// At ψ. Infinite where a hyperbolic sine is, never NaN for a number.
    pub fn at(psi: f64) -> Self {
        if psi.abs() <= SERIES_TO {
            return Self::series(psi);
        }
        let z = psi.abs().sqrt();
        let half = if psi > 0.0 {
            (0.5 * z).sin()
        } else {
            (0.5 * z).sinh()
        };
        // c2 = 2 sin²(z/2)/z²: 1 − cos z would cancel near whole turns.
        let c2 = 2.0 * (half / z) * (half / z);
        let (sine, c0) = if psi > 0.0 {
            z.sin_cos()
        } else {
            (z.sinh(), z.cosh())
        };
        Self {
            c0,
            c1: sine / z,
            c2,
            c3: (z - sine) / z / psi,
        }
    }

    fn series(psi: f64) -> Self {
        // c3 and c2 by Horner's scheme from the far end; ψ = 2 leaves 2e-18 after twelve terms.
        let (mut c2, mut c3) = (1.0, 1.0);
        for j in (1..=12).rev() {
            let j = f64::from(j);
            c2 = 1.0 - psi / ((2.0 * j + 1.0) * (2.0 * j + 2.0)) * c2;
            c3 = 1.0 - psi / ((2.0 * j + 2.0) * (2.0 * j + 3.0)) * c3;
        }
        let (c2, c3) = (c2 / 2.0, c3 / 6.0);
        Self {
            c0: 1.0 - psi * c2,
            c1: 1.0 - psi * c3,
            c2,
            c3,
        }
    }
}

/// Universal functions U_k(χ) = χ^k c_k(αχ²): dU_k/dχ = U_{k−1} for k > 0, and dU0/dχ = −αU1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Universal {
    pub u0: f64,
    pub u1: f64,
    pub u2: f64,
    pub u3: f64,
}

impl Universal {
    pub fn at(chi: f64, alpha: f64) -> Self {
        let c = Stumpff::at(alpha * chi * chi);
        Self {
            u0: c.c0,
            u1: chi * c.c1,
            u2: chi * chi * c.c2,
            u3: chi * chi * chi * c.c3,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_closed_forms_join() {
        for sign in [1.0, -1.0] {
            let (inside, outside) = (
                Stumpff::at(sign * SERIES_TO),
                Stumpff::at(sign * (SERIES_TO + 1e-9)),
            );
            for (a, b) in [
                (inside.c0, outside.c0),
                (inside.c1, outside.c1),
                (inside.c2, outside.c2),
                (inside.c3, outside.c3),
            ] {
                assert!((a - b).abs() < 2e-9, "{a} {b}");
            }
        }
    }

    #[test]
    fn values_by_hand() {
        let zero = Stumpff::at(0.0);
        assert_eq!(
            zero,
            Stumpff {
                c0: 1.0,
                c1: 1.0,
                c2: 0.5,
                c3: 1.0 / 6.0
            }
        );
        // ψ = π²: cos π = −1, sin π = 0.
        let pi2 = std::f64::consts::PI.powi(2);
        let half_turn = Stumpff::at(pi2);
        for (found, expected) in [
            (half_turn.c0, -1.0),
            (half_turn.c1, 0.0),
            (half_turn.c2, 2.0 / pi2),
            (half_turn.c3, 1.0 / pi2),
        ] {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
        // ψ = −1: cosh 1, sinh 1, cosh 1 − 1, sinh 1 − 1.
        let one = Stumpff::at(-1.0);
        for (found, expected) in [
            (one.c0, 1.543_080_634_815_243_7),
            (one.c1, 1.175_201_193_643_801_4),
            (one.c2, 0.543_080_634_815_243_7),
            (one.c3, 0.175_201_193_643_801_4),
        ] {
            assert!((found / expected - 1.0).abs() < 1e-15, "{found} {expected}");
        }
    }

    #[test]
    fn identities_hold_over_sixty_decades() {
        for k in -300..=300 {
            let size = 10f64.powf(f64::from(k) / 5.0);
            for psi in [size.min(1e9), -size.min(4e5)] {
                let c = Stumpff::at(psi);
                assert!(c.c3.is_finite() && !c.c2.is_nan(), "{psi}");
                // c_k + ψ c_{k+2} = 1/k!
                let scale = 1.0 + c.c0.abs();
                assert!((c.c0 + psi * c.c2 - 1.0).abs() < 3e-15 * scale, "{psi}");
                assert!((c.c1 + psi * c.c3 - 1.0).abs() < 3e-15 * scale, "{psi}");
            }
        }
    }
}
