//! One channel of a map or of a part of it: blurring and ordering.
//!
//! As in `map.rs`, only operations with the same bits on every machine are used; the square root is one of them.

use super::map::Map;

/// A plane of values, rows from the north.
pub struct Plane {
    pub width: usize,
    pub height: usize,
    pub values: Vec<f64>,
}

impl Plane {
    /// The plane of a one-channel map.
    pub fn of(map: &Map) -> Self {
        Self {
            width: map.width,
            height: map.height,
            values: map.values.iter().map(|value| f64::from(*value)).collect(),
        }
    }

    /// A square part from a column and a row on; columns wrap round the Earth.
    pub fn cut(&self, (left, top): (usize, usize), size: usize) -> Self {
        let at = |n: usize| {
            let (x, y) = (left + n % size, top + n / size);
            self.values[y * self.width + x % self.width]
        };
        Self {
            width: size,
            height: size,
            values: (0..size * size).map(at).collect(),
        }
    }

    /// Indices of the values in ascending order; equal values are ordered by the means of their 3 × 3 and then 7 × 7 neighbourhoods.
    pub fn order(&self) -> Vec<u32> {
        let keys = self.keys();
        let mut order: Vec<u32> = (0..keys.len() as u32).collect();
        order.sort_by(|a, b| {
            let (a, b) = (*a as usize, *b as usize);
            keys[a].total_cmp(&keys[b]).then(a.cmp(&b))
        });
        order
    }

    /// Rank of each value, 0…1; equal keys share their mean rank.
    pub fn ranks(&self) -> Self {
        let keys = self.keys();
        let mut order: Vec<u32> = (0..keys.len() as u32).collect();
        order.sort_by(|a, b| keys[*a as usize].total_cmp(&keys[*b as usize]));
        let mut values = vec![0.0; keys.len()];
        let mut first = 0;
        for same in order.chunk_by(|a, b| keys[*a as usize] == keys[*b as usize]) {
            let middle = first as f64 + 0.5 * same.len() as f64;
            for n in same {
                values[*n as usize] = middle / keys.len() as f64;
            }
            first += same.len();
        }
        self.with(values)
    }

    /// Sort keys: values plus neighbourhood means, scaled so that they never exceed the distance of two different values, and rounded so that
    /// blurring preserves equality.
    fn keys(&self) -> Vec<f64> {
        let (near, wide) = (self.blurred(1, 1), self.blurred(3, 1));
        let means = near.values.iter().zip(&wide.values);
        let keys = self.values.iter().zip(means).map(|(value, (near, wide))| {
            ((value + near / 256.0 + wide / 65536.0) * 65536.0).round()
        });
        keys.collect()
    }

    /// Replaces each value by the mean of the square of this radius around it, `times` times; the border is mirrored.
    pub fn blurred(&self, radius: usize, times: usize) -> Self {
        let mut values = self.values.clone();
        for _ in 0..times {
            for row in values.chunks_exact_mut(self.width) {
                let blurred = box_mean(row, radius);
                row.copy_from_slice(&blurred);
            }
            let mut column = vec![0.0; self.height];
            for x in 0..self.width {
                for (y, value) in column.iter_mut().enumerate() {
                    *value = values[y * self.width + x];
                }
                for (y, value) in box_mean(&column, radius).into_iter().enumerate() {
                    values[y * self.width + x] = value;
                }
            }
        }
        self.with(values)
    }

    /// The same with mean 0 and variance 1.
    pub fn standardised(&self) -> Self {
        let count = self.values.len() as f64;
        let mean = self.values.iter().sum::<f64>() / count;
        let squares = self.values.iter().map(|v| (v - mean) * (v - mean));
        let scale = 1.0 / (squares.sum::<f64>() / count).sqrt();
        self.with(self.values.iter().map(|v| (v - mean) * scale).collect())
    }

    /// Other values in the same size.
    pub fn with(&self, values: Vec<f64>) -> Self {
        Self {
            width: self.width,
            height: self.height,
            values,
        }
    }

    /// Combines two planes value by value.
    pub fn zip(&self, other: &Self, of: impl Fn(f64, f64) -> f64) -> Self {
        let values = self.values.iter().zip(&other.values);
        self.with(values.map(|(a, b)| of(*a, *b)).collect())
    }
}

fn box_mean(line: &[f64], radius: usize) -> Vec<f64> {
    let len = line.len() as isize;
    let at = |n: isize| {
        // Mirrored, with the last value repeated.
        let n = n.rem_euclid(2 * len);
        line[n.min(2 * len - 1 - n) as usize]
    };
    let radius = radius as isize;
    let mut sum: f64 = (-radius..=radius).map(at).sum();
    let mut means = Vec::with_capacity(line.len());
    for n in 0..len {
        means.push(sum / (2 * radius + 1) as f64);
        sum += at(n + radius + 1) - at(n - radius);
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(values: &[f64], width: usize) -> Plane {
        Plane {
            width,
            height: values.len() / width,
            values: values.to_vec(),
        }
    }

    #[test]
    fn blurring_keeps_the_mean_and_takes_means() {
        let line = [0.0, 0.0, 9.0, 0.0, 0.0, 0.0];
        assert_eq!(box_mean(&line, 1), [0.0, 3.0, 3.0, 3.0, 0.0, 0.0]);
        let blurred = plane(&[1.0, 5.0, 2.0, 8.0], 2).blurred(1, 3);
        assert!((blurred.values.iter().sum::<f64>() - 16.0).abs() < 1e-9);
    }

    #[test]
    fn equal_values_go_by_their_neighbourhoods() {
        // The middle one of the three ones has the brighter neighbours.
        let order = plane(&[1.0, 0.0, 0.0, 1.0, 3.0, 1.0], 6).order();
        assert_eq!(order[..2], [1, 2]);
        assert_eq!(order[5], 4);
        assert_eq!(order[2], 0);
    }

    #[test]
    fn ranks_are_shared_by_equal_values() {
        let ranks = plane(&[4.0; 9], 3).ranks();
        assert_eq!(ranks.values, [0.5; 9]);
    }
}
