//! Polynomials through the samples of a window: their values and first derivatives.

use glam::DVec3;

/// Most samples in a window.
pub(super) const MAX_NODES: usize = 32;

/// The Lagrange polynomials ℓᵢ of a window and their derivatives, at one point.
///
/// ℓᵢ(x) = wᵢ ∏_{j≠i} (x − xⱼ) with the barycentric weights wᵢ = 1 / ∏_{j≠i} (xᵢ − xⱼ): the modified Lagrange formula, which
/// is backward stable at any degree (Berrut & Trefethen, SIAM Review 46, 2004; Higham, IMA J. Numer. Anal. 24, 2004). The
/// products over j < i and j > i are carried along with their derivatives, so that nothing is divided by x − xᵢ and a
/// point near a sample is no special case.
pub(super) struct Basis {
    len: usize,
    node: [f64; MAX_NODES],
    value: [f64; MAX_NODES],
    slope: [f64; MAX_NODES],
}

impl Basis {
    /// For distinct nodes, at most [`MAX_NODES`], and the point `x`. The nodes should be scaled to about −2…2, so that the weights neither overflow
    /// nor underflow.
    pub fn new(nodes: &[f64], x: f64) -> Self {
        let mut basis = Self {
            len: nodes.len().min(MAX_NODES),
            node: [0.0; MAX_NODES],
            value: [0.0; MAX_NODES],
            slope: [0.0; MAX_NODES],
        };
        let nodes = nodes.get(..basis.len).unwrap_or(nodes);
        for (kept, node) in basis.node.iter_mut().zip(nodes) {
            *kept = x - node;
        }
        // Products over the nodes before, then times those behind: (product, its derivative).
        let mut product = (1.0, 0.0);
        for (i, node) in nodes.iter().enumerate() {
            (basis.value[i], basis.slope[i]) = product;
            product = (product.0 * (x - node), product.1 * (x - node) + product.0);
        }
        let mut product = (1.0, 0.0);
        for (i, node) in nodes.iter().enumerate().rev() {
            let (value, slope) = (basis.value[i], basis.slope[i]);
            let others = nodes.iter().enumerate().filter(|&(j, _)| j != i);
            let weight = 1.0 / others.map(|(_, other)| node - other).product::<f64>();
            basis.value[i] = weight * value * product.0;
            basis.slope[i] = weight * (slope * product.0 + value * product.1);
            product = (product.0 * (x - node), product.1 * (x - node) + product.0);
        }
        basis
    }

    /// Σ ℓᵢ fᵢ and Σ ℓᵢ′ fᵢ.
    pub fn lagrange(&self, values: &[DVec3]) -> (DVec3, DVec3) {
        let mut sum = (DVec3::ZERO, DVec3::ZERO);
        for (i, f) in values.iter().enumerate().take(self.len) {
            sum.0 += self.value[i] * *f;
            sum.1 += self.slope[i] * *f;
        }
        sum
    }

    /// The polynomial that has the values fᵢ and the slopes fᵢ′, and its derivative:
    /// Σ [1 − 2 (x − xᵢ) ℓᵢ′(xᵢ)] ℓᵢ² fᵢ + (x − xᵢ) ℓᵢ² fᵢ′.
    pub fn hermite(&self, values: &[DVec3], slopes: &[DVec3]) -> (DVec3, DVec3) {
        let mut sum = (DVec3::ZERO, DVec3::ZERO);
        let samples = values.iter().zip(slopes).enumerate().take(self.len);
        for (i, (f, df)) in samples {
            // ℓᵢ′(xᵢ) = Σ_{j≠i} 1 / (xᵢ − xⱼ).
            let at_node: f64 = (0..self.len)
                .filter(|&j| j != i)
                .map(|j| 1.0 / (self.node[j] - self.node[i]))
                .sum();
            let (l, dl, dx) = (self.value[i], self.slope[i], self.node[i]);
            let (square, square_slope) = (l * l, 2.0 * l * dl);
            let factor = 1.0 - 2.0 * dx * at_node;
            sum.0 += factor * square * *f + dx * square * *df;
            sum.1 += (factor * square_slope - 2.0 * at_node * square) * *f
                + (square + dx * square_slope) * *df;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x^n and its derivative are met by the polynomials of that degree, at nodes and between them.
    #[test]
    fn powers_come_back() {
        for count in 2..=28_usize {
            let nodes: Vec<f64> = (0..count)
                .map(|i| 2.0 * i as f64 / (count - 1) as f64 - 1.0)
                .collect();
            let power = |x: f64, n: usize| DVec3::splat(x.powi(n as i32));
            let slope = |x: f64, n: usize| DVec3::splat(n as f64 * x.powi(n as i32 - 1));
            // In the middle of the window, where it is used.
            for x in [0.0, 0.013, -0.04, nodes[count / 2]] {
                let basis = Basis::new(&nodes, x);
                for n in 1..count {
                    let values: Vec<_> = nodes.iter().map(|&t| power(t, n)).collect();
                    let (value, rate) = basis.lagrange(&values);
                    assert!((value - power(x, n)).length() < 1e-13, "{count} {n} {x}");
                    assert!((rate - slope(x, n)).length() < 1e-11, "{count} {n} {x}");
                }
                for n in (1..2 * count).filter(|_| count <= 14) {
                    let values: Vec<_> = nodes.iter().map(|&t| power(t, n)).collect();
                    let slopes: Vec<_> = nodes.iter().map(|&t| slope(t, n)).collect();
                    let (value, rate) = basis.hermite(&values, &slopes);
                    assert!((value - power(x, n)).length() < 1e-12, "{count} {n} {x}");
                    assert!((rate - slope(x, n)).length() < 1e-10, "{count} {n} {x}");
                }
            }
        }
    }
}
