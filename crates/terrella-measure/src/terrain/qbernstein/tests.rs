//! The basis against itself and, with long arithmetic at hand, against its definition.

mod oracle;

use super::*;

const QS: [f64; 13] = [
    1e-6,
    1e-3,
    0.1,
    0.5,
    0.9,
    0.999_999_999_9,
    1.0,
    1.000_000_000_1,
    1.1,
    2.0,
    10.0,
    1e3,
    1e6,
];

fn wave(n: usize) -> Vec<f64> {
    (0..=n).map(|i| (1.7 * i as f64 + 0.3).sin()).collect()
}

#[test]
fn at_one_everything_is_bernstein_to_the_last_bit() {
    for n in 1..=MAX_DEGREE {
        let basis = QBasis::new(n, 1.0).unwrap();
        let mut binomial = 1.0;
        for i in 0..=n {
            assert_eq!(basis.binomials[i].to_bits(), f64::to_bits(binomial));
            binomial = binomial * (n - i) as f64 / (i + 1) as f64;
            for j in 0..=n {
                let identity = if i == j { 1.0 } else { 0.0 };
                assert_eq!(basis.bernstein_from_q().get(i, j), identity);
                assert_eq!(basis.q_from_bernstein().get(i, j), identity);
            }
        }
        let control = wave(n);
        for k in 0..=64 {
            let t = f64::from(k) / 64.0;
            for (i, value) in basis.values(t).into_iter().enumerate().take(n + 1) {
                let mut plain = basis.binomials[i];
                (0..i).for_each(|_| plain *= t);
                (i..n).for_each(|_| plain *= 1.0 - t);
                assert_eq!(value.to_bits(), plain.to_bits());
            }
            let mut c = control.clone();
            for m in (1..=n).rev() {
                (0..m).for_each(|i| c[i] += (c[i + 1] - c[i]) * t);
            }
            assert_eq!(basis.point(&control, t).to_bits(), c[0].to_bits());
        }
    }
}

#[test]
fn basis_adds_up_to_one() {
    let mut worst: f64 = 0.0;
    for n in 1..=MAX_DEGREE {
        for q in QS {
            let basis = QBasis::new(n, q).unwrap();
            for k in 0..=100 {
                let values = basis.values(f64::from(k) / 100.0);
                let size: f64 = values.iter().map(|b| b.abs()).sum();
                assert!(!size.is_nan());
                if size.is_finite() {
                    let off = (values.iter().sum::<f64>() - 1.0).abs() / size;
                    worst = worst.max(off);
                    assert!(q > 1.0 || values.iter().all(|b| *b >= 0.0));
                }
            }
        }
    }
    println!("partition of unity: {worst:.1e} of the sum of sizes");
    assert!(worst < 4e-15);
}

#[test]
fn curves_meet_their_end_control_values_and_equal_ones() {
    for n in 1..=MAX_DEGREE {
        for q in QS {
            let basis = QBasis::new(n, q).unwrap();
            let control = wave(n);
            assert_eq!(basis.point(&control, 0.0), control[0]);
            let end = basis.point(&control, 1.0);
            let size = 10f64.powf(basis.condition().log10_lebesgue).min(1e290);
            let allowed = 4e-16 * n as f64 * size;
            assert!((end - control[n]).abs() <= allowed, "{n} {q}: {end}");
            let level = vec![4_322.1; n + 1];
            for k in 0..=10 {
                let t = f64::from(k) / 10.0;
                assert_eq!(basis.point_and_slope(&level, t), (4_322.1, 0.0));
            }
        }
    }
}

#[test]
fn there_and_back_errs_no_more_than_the_condition_says() {
    println!(" n        q  log10 κ1  log10 κ∞  log10 Λ   round trip   allowed");
    for n in [3, 6, 12] {
        for q in QS {
            let basis = QBasis::new(n, q).unwrap();
            let condition = basis.condition();
            let control = wave(n);
            let there = basis.bernstein_from_q().apply(&control);
            let back = basis.q_from_bernstein().apply(&there);
            let off = control
                .iter()
                .zip(back)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            let allowed = 4.0 * n as f64 * f64::EPSILON * 10f64.powf(condition.log10_rows);
            println!(
                "{n:2} {q:9.3e} {:9.2} {:9.2} {:8.2}  {off:11.2e} {allowed:9.2e}",
                condition.log10_columns, condition.log10_rows, condition.log10_lebesgue
            );
            if there.iter().all(|b| b.is_finite()) {
                assert!(off <= allowed, "{n} {q}: {off:e} > {allowed:e}");
            }
            assert!(!back.iter().any(|c| c.is_nan()) || there.iter().any(|b| b.is_infinite()));
        }
    }
}

#[test]
fn slope_is_that_of_the_converted_curve() {
    for n in [1, 3, 7, 12] {
        for q in [0.01, 0.5, 1.0, 1.3, 2.0] {
            let basis = QBasis::new(n, q).unwrap();
            let control = wave(n);
            let bezier = basis.bernstein_from_q().apply(&control);
            let plain = QBasis::new(n, 1.0).unwrap();
            let size = bezier.iter().fold(1.0, |a: f64, b| a.max(b.abs()));
            for k in 0..=20 {
                let t = f64::from(k) / 20.0;
                let (value, slope) = basis.point_and_slope(&control, t);
                let (v, s) = plain.point_and_slope(&bezier, t);
                assert!((value - v).abs() < 1e-13 * size, "{n} {q} {t}: {value} {v}");
                assert!((slope - s).abs() < 1e-12 * size, "{n} {q} {t}: {slope} {s}");
            }
        }
    }
}

#[test]
fn what_is_not_offered_is_rejected() {
    assert_eq!(QBasis::new(0, 1.0), Err(QError::Degree(0)));
    assert_eq!(QBasis::new(13, 1.0), Err(QError::Degree(13)));
    assert_eq!(QBasis::new(3, 0.0), Err(QError::Q(0.0)));
    assert!(QBasis::new(3, f64::NAN).is_err());
    assert!(QBasis::new(3, f64::INFINITY).is_err());
    assert!(QBasis::new(12, 1e6).is_ok() && QBasis::new(12, 1e-6).is_ok());
}
