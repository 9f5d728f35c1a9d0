//! AgX: Sobotka's curve in Rec. 2020, as in three.js and Filament. Its contrast is Wrensch's polynomial (mean square error 3.7e-6).

use glam::{DMat3, DVec3};

/// Rec. 2020 from Rec. 709, linear.
const REC2020_FROM_REC709: [[f64; 3]; 3] = [
    [0.6274, 0.0691, 0.0164],
    [0.3293, 0.9195, 0.0880],
    [0.0433, 0.0113, 0.8956],
];
/// Pulls colours together before the curve, in Rec. 2020.
const TOGETHER: [[f64; 3]; 3] = [
    [
        0.856_627_153_315_983,
        0.137_318_972_929_847,
        0.111_898_212_999_95,
    ],
    [
        0.095_121_240_538_158_8,
        0.761_241_990_602_591,
        0.076_799_418_603_190_3,
    ],
    [
        0.048_251_606_145_858_3,
        0.101_439_036_467_562,
        0.811_302_368_396_859,
    ],
];
/// Input of the curve, from light in Rec. 709.
pub const INSET: DMat3 = DMat3::from_cols_array_2d(&product(&TOGETHER, &REC2020_FROM_REC709));
/// Pushes colours apart after the curve.
pub const OUTSET: DMat3 = DMat3::from_cols_array_2d(&[
    [
        1.127_100_581_814_436_8,
        -0.141_329_763_498_438_3,
        -0.141_329_763_498_438_26,
    ],
    [
        -0.110_606_643_096_603_23,
        1.157_823_702_216_272,
        -0.110_606_643_096_602_94,
    ],
    [
        -0.016_493_938_717_834_573,
        -0.016_493_938_717_834_257,
        1.251_936_406_595_040_5,
    ],
]);
/// Rec. 709 from Rec. 2020, linear.
pub const REC709_FROM_REC2020: DMat3 = DMat3::from_cols_array_2d(&[
    [1.6605, -0.1246, -0.0182],
    [-0.5876, 1.1329, -0.1006],
    [-0.0728, -0.0083, 1.1187],
]);
/// Binary logarithms of light at the ends of the curve: 10 steps below and 6.5 above a middle grey of 0.18.
pub const LEAST_LOG: f64 = -12.473_93;
pub const MOST_LOG: f64 = 4.026_069;
/// Polynomial of the contrast over 0…1, starting with the constant term.
pub const CONTRAST: [f64; 7] = [-0.002_32, 0.1191, 0.4298, -6.868, 31.96, -40.14, 15.5];
/// The curve returns display values; this power converts them to light.
pub const DISPLAY_POWER: f64 = 2.2;

/// Product of two column-major matrices.
const fn product(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut out = [[0.0; 3]; 3];
    let mut place = 0;
    while place < 27 {
        let (column, row, k) = (place / 9, place / 3 % 3, place % 3);
        out[column][row] += a[k][row] * b[column][k];
        place += 1;
    }
    out
}

fn contrast(x: f64) -> f64 {
    CONTRAST.iter().rev().fold(0.0, |sum, term| sum * x + term)
}

/// Display light, 0…1, of light that is not negative.
pub fn agx(light: DVec3) -> DVec3 {
    let curved = (INSET * light).map(|value| {
        let log = value.max(1e-10).log2();
        contrast(((log - LEAST_LOG) / (MOST_LOG - LEAST_LOG)).clamp(0.0, 1.0))
    });
    let shown = (OUTSET * curved).max(DVec3::ZERO).powf(DISPLAY_POWER);
    REC709_FROM_REC2020 * shown
}

/// Light that this curve shows as this display light. For a colour that it cannot show, light of a
/// similar one.
pub fn light_by_agx(shown: DVec3) -> DVec3 {
    let shown = (REC709_FROM_REC2020.inverse() * shown).max(DVec3::ZERO);
    let curved = OUTSET.inverse() * shown.powf(1.0 / DISPLAY_POWER);
    let light = curved.map(|wanted| {
        let (mut least, mut most) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (least + most);
            match contrast(middle) < wanted {
                true => least = middle,
                false => most = middle,
            }
        }
        // The darkest light shows as black; for black, zero light is returned.
        match least > 1e-3 {
            true => (LEAST_LOG + least * (MOST_LOG - LEAST_LOG)).exp2(),
            false => 0.0,
        }
    });
    (INSET.inverse() * light).max(DVec3::ZERO)
}
