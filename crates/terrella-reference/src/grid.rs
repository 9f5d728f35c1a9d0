//! Numerical tools: Gauss's quadrature and cubic interpolation in equally spaced tables.

use glam::DVec3;
use rayon::prelude::*;

/// Gauss–Legendre quadrature on 0…1.
#[derive(Clone, Debug)]
pub(super) struct Gauss {
    /// Places of the nodes.
    pub nodes: Vec<f64>,
    /// Their weights, sum 1.
    pub weights: Vec<f64>,
    /// Row i holds the weights of ∫ from 0 to node i of the polynomial through the values at all nodes.
    pub running: Vec<Vec<f64>>,
}

impl Gauss {
    /// The rule of `count` nodes, at least 1: exact for polynomials of degree 2·count − 1.
    pub fn new(count: usize) -> Self {
        let (nodes, weights): (Vec<_>, Vec<_>) = (0..count).map(|i| node(count, i)).unzip();
        let running = nodes.iter().map(|end| {
            let basis = |k: usize, x: f64| -> f64 {
                let others = nodes.iter().enumerate().filter(|(j, _)| *j != k);
                others
                    .map(|(_, other)| (x - other) / (nodes[k] - other))
                    .product()
            };
            // The basis polynomials are of degree count − 1: the rule itself integrates them exactly.
            let weight = |k| -> f64 {
                let parts = nodes.iter().zip(&weights);
                parts.map(|(x, w)| end * w * basis(k, end * x)).sum()
            };
            (0..count).map(weight).collect()
        });
        Self {
            running: running.collect(),
            nodes,
            weights,
        }
    }

    /// Nodes and weights on an interval.
    pub fn on(&self, from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> {
        let length = to - from;
        let parts = self.nodes.iter().zip(&self.weights);
        parts.map(move |(x, w)| (from + length * x, length * w))
    }
}

/// Node `i` and its weight: a zero of the Legendre polynomial by Newton's method from Tricomi's first guess.
fn node(count: usize, i: usize) -> (f64, f64) {
    let n = count as f64;
    let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
    let mut slope = 1.0;
    for _ in 0..100 {
        let (mut last, mut value) = (1.0, x);
        for k in 2..=count {
            let k = k as f64;
            (last, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * last) / k);
        }
        slope = n * (last - x * value) / ((1.0 - x) * (1.0 + x));
        let step = value / slope;
        x -= step;
        if step.abs() < 1e-15 {
            break;
        }
    }
    (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
}

/// The first of the four values about a place 0…1 of `count` ≥ 4 equally spaced ones, and Lagrange's weights of them.
fn stencil(at: f64, count: usize) -> (usize, [f64; 4]) {
    let at = at.clamp(0.0, 1.0) * (count - 1) as f64;
    let first = (at as usize).saturating_sub(1).min(count - 4);
    let s = at - first as f64;
    let (a, b, c) = (s - 1.0, s - 2.0, s - 3.0);
    let weights = [
        a * b * c / -6.0,
        s * b * c / 2.0,
        s * a * c / -2.0,
        s * a * b / 6.0,
    ];
    (first, weights)
}

/// Colours at equally spaced places 0…1, between them a cubic through the four nearest.
#[derive(Clone, Debug)]
pub(super) struct Table1d {
    values: Vec<DVec3>,
}

impl Table1d {
    /// Computes `count` ≥ 4 values on all cores.
    pub fn fill(count: usize, value: impl Fn(f64) -> DVec3 + Sync) -> Self {
        let at = |i: usize| i as f64 / (count - 1) as f64;
        Self {
            values: (0..count).into_par_iter().map(|i| value(at(i))).collect(),
        }
    }

    /// The value at a place, which is clamped to 0…1.
    pub fn at(&self, x: f64) -> DVec3 {
        let (first, weights) = stencil(x, self.values.len());
        let values = self.values[first..first + 4].iter();
        values.zip(weights).map(|(v, w)| *v * w).sum()
    }
}

/// Colours at equally spaced places of two coordinates 0…1, between them a bicubic through the sixteen nearest.
#[derive(Clone, Debug)]
pub(super) struct Table2d {
    width: usize,
    height: usize,
    values: Vec<DVec3>,
}

impl Table2d {
    /// Computes `width` × `height` values, both at least 4, on all cores.
    pub fn fill(width: usize, height: usize, value: impl Fn(f64, f64) -> DVec3 + Sync) -> Self {
        let at = |i: usize, count: usize| i as f64 / (count - 1) as f64;
        let places = (0..width * height).into_par_iter();
        let values = places.map(|i| value(at(i % width, width), at(i / width, height)));
        Self {
            width,
            height,
            values: values.collect(),
        }
    }

    /// The value at a place, whose coordinates are clamped to 0…1.
    pub fn at(&self, x: f64, y: f64) -> DVec3 {
        let (column, across) = stencil(x, self.width);
        let (row, down) = stencil(y, self.height);
        let mut sum = DVec3::ZERO;
        for (j, weight) in down.into_iter().enumerate() {
            let start = (row + j) * self.width + column;
            let line = self.values[start..start + 4].iter().zip(across);
            sum += line.map(|(v, w)| *v * w).sum::<DVec3>() * weight;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_is_exact_to_its_degree_and_in_its_running_sums() {
        for count in [1, 2, 5, 12, 40] {
            let rule = Gauss::new(count);
            for power in [0, 1, count - 1, 2 * count - 1] {
                let power = power as i32;
                let sum: f64 = rule
                    .on(1.0, 3.0)
                    .map(|(x, w)| w * (x / 3.0).powi(power))
                    .sum();
                let n = f64::from(power + 1);
                let exact = 3.0 * (1.0 - (1.0_f64 / 3.0).powf(n)) / n;
                assert!(
                    (sum - exact).abs() < 1e-13,
                    "{count} {power}: {sum} {exact}"
                );
            }
            for (end, weights) in rule.nodes.iter().zip(&rule.running) {
                let power = count as i32 - 1;
                let parts = rule.nodes.iter().zip(weights);
                let sum: f64 = parts.map(|(x, w)| x.powi(power) * w).sum();
                let exact = end.powi(power + 1) / f64::from(power + 1);
                // Lagrange's basis of 40 nodes is large between them.
                assert!((sum - exact).abs() < 1e-10, "{count}: {sum} {exact}");
            }
        }
    }

    #[test]
    fn cubics_are_interpolated_exactly_up_to_the_ends() {
        let cubic = |x: f64| 2.0 - x + 3.0 * x * x - 5.0 * x * x * x;
        let line = Table1d::fill(7, |x| DVec3::splat(cubic(x)));
        let plane = Table2d::fill(5, 9, |x, y| DVec3::splat(cubic(x) * cubic(y)));
        for i in 0..=50 {
            let x = f64::from(i) / 50.0;
            let y = (1.7 * x) % 1.0;
            assert!((line.at(x).x - cubic(x)).abs() < 1e-13);
            assert!((plane.at(x, y).y - cubic(x) * cubic(y)).abs() < 1e-13);
        }
        assert_eq!(line.at(-3.0), line.at(0.0));
        assert_eq!(plane.at(9.0, 0.5), plane.at(1.0, 0.5));
    }
}
