//! Against long arithmetic, straight from the definitions.

use super::super::*;
use astro_float_num::{BigFloat, RoundingMode};

/// 320 for values; inverting a matrix of entries from 1 to 10³⁹⁶ by substitution needs the rest.
const BITS: usize = 2_048;
const RM: RoundingMode = RoundingMode::ToEven;

fn big(x: f64) -> BigFloat {
    BigFloat::from_f64(x, BITS)
}
fn mul(a: &BigFloat, b: &BigFloat) -> BigFloat {
    a.mul(b, BITS, RM)
}
fn sub(a: &BigFloat, b: &BigFloat) -> BigFloat {
    a.sub(b, BITS, RM)
}

fn q_int(r: usize, q: &BigFloat) -> BigFloat {
    let mut sum = big(0.0);
    for _ in 0..r {
        sum = mul(&sum, q).add(&big(1.0), BITS, RM);
    }
    sum
}

/// The definition, with qˢ multiplied out.
fn value(n: usize, i: usize, q: f64, t: f64) -> BigFloat {
    let (q, t) = (big(q), big(t));
    let mut out = big(1.0);
    for k in 1..=i {
        out = mul(&out, &q_int(n - k + 1, &q)).div(&q_int(k, &q), BITS, RM);
        out = mul(&out, &t);
    }
    let mut power = big(1.0);
    for _ in 0..n - i {
        out = mul(&out, &sub(&big(1.0), &mul(&power, &t)));
        power = mul(&power, &q);
    }
    out
}

/// |x − exact| as a part of `unit`. All go through f64 only after the subtraction.
fn off(x: f64, exact: &BigFloat, unit: &BigFloat) -> f64 {
    let off = sub(&big(x), exact).abs().div(unit, BITS, RM);
    off.to_string().parse::<f64>().unwrap()
}

const QS: [f64; 11] = [
    1e-6,
    1e-3,
    0.3,
    0.999,
    1.0 - 1e-12,
    1.0 + 1e-12,
    1.001,
    1.7,
    30.0,
    1e3,
    1e6,
];

#[test]
fn values_hold_against_long_arithmetic() {
    let (mut below, mut above): (f64, f64) = (0.0, 0.0);
    for n in [1, 2, 3, 5, 8, 12] {
        for q in QS {
            let basis = QBasis::new(n, q).unwrap();
            for t in [0.0, 1e-9, 0.1, 1.0 / 3.0, 0.5, 0.77, 1.0 - 1e-9, 1.0] {
                let values = basis.values(t);
                for (i, b) in values.iter().enumerate().take(n + 1) {
                    if !b.is_finite() {
                        assert!(basis.powers[MAX_DEGREE] > 1e50);
                        continue;
                    }
                    let exact = value(n, i, q, t);
                    if q <= 1.0 {
                        // Relative to the value itself.
                        if exact.is_zero() {
                            assert_eq!(*b, 0.0);
                        } else if b.abs() > 1e-290 {
                            below = below.max(off(*b, &exact, &exact.abs()));
                        }
                    } else {
                        // A factor can vanish inside: relative to the value with its factors as 1 + qˢt.
                        let mut unit = big(basis.binomials[i]);
                        (0..i).for_each(|_| unit = mul(&unit, &big(t)));
                        (0..n - i).for_each(|s| {
                            unit = mul(&unit, &big(1.0 + basis.powers[s] * t));
                        });
                        if !unit.is_zero() && b.abs() > 1e-290 {
                            above = above.max(off(*b, &exact, &unit));
                        }
                    }
                }
            }
        }
    }
    println!(
        "basis against 2048 bits: {below:.1e} relative for q < 1, {above:.1e} of its terms above"
    );
    assert!(below < 2e-14 && above < 2e-14);
}

#[test]
fn matrices_hold_against_long_arithmetic() {
    // M from the power basis: expand both bases exactly, entry by entry; M⁻¹ by substitution.
    let mut worst: f64 = 0.0;
    for n in [2, 3, 6, 12] {
        for q in QS {
            let basis = QBasis::new(n, q).unwrap();
            let (to, back) = (basis.bernstein_from_q(), basis.q_from_bernstein());
            // Exact M: Bernstein coefficients of tⁱ Π((1 − t) + t w_s), w_s = 1 − qˢ.
            let qb = big(q);
            let mut exact = vec![vec![big(0.0); n + 1]; n + 1];
            for i in 0..=n {
                let mut e = vec![big(0.0); n + 2];
                e[0] = big(1.0);
                let mut power = big(1.0);
                for s in 0..n - i {
                    let w = sub(&big(1.0), &power);
                    for k in (1..=s + 1).rev() {
                        e[k] = e[k].add(&mul(&e[k - 1], &w), BITS, RM);
                    }
                    power = mul(&power, &qb);
                }
                let mut binomial = big(1.0);
                for k in 1..=i {
                    binomial = mul(&binomial, &q_int(n - k + 1, &qb)).div(&q_int(k, &qb), BITS, RM);
                }
                for k in 0..=n - i {
                    let mut plain = big(1.0);
                    for l in 1..=i + k {
                        plain = mul(&plain, &big((n - l + 1) as f64)).div(&big(l as f64), BITS, RM);
                    }
                    exact[i + k][i] = mul(&binomial, &e[k]).div(&plain, BITS, RM);
                }
            }
            // Exact inverse by forward substitution.
            let inverse: Vec<Vec<BigFloat>> = (0..=n)
                .map(|c| {
                    let mut column = vec![big(0.0); n + 1];
                    for r in c..=n {
                        let mut rest = big(if r == c { 1.0 } else { 0.0 });
                        for k in c..r {
                            rest = sub(&rest, &mul(&exact[r][k], &column[k]));
                        }
                        column[r] = rest.div(&exact[r][r], BITS, RM);
                    }
                    column
                })
                .collect();
            for r in 0..=n {
                for c in 0..=n {
                    for (entry, exact) in [
                        (to.get(r, c), &exact[r][c]),
                        (back.get(r, c), &inverse[c][r]),
                    ] {
                        let size = exact.abs();
                        if exact.is_zero() || (q - 1.0).abs() < 1e-9 && entry.abs() < 1e-60 {
                            assert!(entry.abs() < 1e-60, "{n} {q} {r} {c}: {entry}");
                        } else if entry.is_finite() && entry.abs() > 1e-290 {
                            let part = off(entry, exact, &size);
                            worst = worst.max(part);
                            assert!(part < 1e-13, "{n} {q} {r} {c}: {part:e}");
                        }
                    }
                }
            }
        }
    }
    println!("conversion matrices against 2048 bits: {worst:.1e} relative, entry by entry");
}
