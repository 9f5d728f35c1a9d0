//! Cloud detail smaller than the cloud map's texels: a tile of the map's own structures, without the weather patterns.
//!
//! The tile repeats without a seam.

use super::land_tile::SIDE;
use super::map::Map;
use super::plane::Plane;

/// Texels over which the tile's end blends into its beginning.
const OVERLAP: usize = 160;
/// Structures larger than about three times this belong to the weather, texels.
const WEATHER: usize = 14;
/// Radius within which the tile's contrast is equalized, texels.
const EVENING: usize = 24;
/// Smallest contrast that is equalized, in ranks 0…1; below it another part of the map is used.
const LEAST: f64 = 0.03;
const ENOUGH: f64 = 0.08;
/// Places of the parts in the source, column and row, best first: trade winds, tropics and the roaring forties.
const PARTS: [(usize, usize); 3] = [(0, 450), (1500, 450), (700, 700)];
/// The tile of the mended source of the cloud map, with mean 0 and variance 1.
pub fn make(clouds: &Map) -> Plane {
    let map = Plane::of(clouds);
    let [first, others @ ..] = PARTS.map(|place| Part::new(&map, place));
    let mut detail = first;
    for other in others {
        detail = detail.filled_with(&other);
    }
    repeating(&detail.values).standardised()
}

/// Detail of a part of the map, and its presence, 0…1.
struct Part {
    values: Plane,
    presence: Plane,
}

impl Part {
    fn new(map: &Plane, place: (usize, usize)) -> Self {
        let ranks = map.cut(place, SIDE + OVERLAP).ranks();
        let fine = ranks.zip(&ranks.blurred(WEATHER, 3), |rank, weather| rank - weather);
        // The grain of the source is no cloud.
        let fine = fine.zip(&fine.blurred(1, 1), |sharp, soft| 0.4 * sharp + 0.6 * soft);
        let power = fine.zip(&fine, |a, b| a * b).blurred(EVENING, 3);
        let contrast = power.with(power.values.iter().map(|p| p.max(0.0).sqrt()).collect());
        let presence = contrast.with(
            contrast
                .values
                .iter()
                .map(|c| ((c - LEAST) / (ENOUGH - LEAST)).clamp(0.0, 1.0))
                .collect(),
        );
        Self {
            values: fine.zip(&contrast, |fine, contrast| fine / contrast.max(0.02)),
            presence: presence.blurred(6, 2),
        }
    }

    /// Fills places of low presence with another part. Variances add up.
    fn filled_with(&self, other: &Self) -> Self {
        let here = self.presence.with(
            self.presence
                .values
                .iter()
                .map(|p| p.clamp(0.0, 1.0))
                .collect(),
        );
        let kept = self.values.zip(&here, |value, p| value * p.sqrt());
        let added = other
            .values
            .zip(&here, |value, p| value * (1.0 - p).max(0.0).sqrt());
        Self {
            values: kept.zip(&added, |a, b| a + b),
            presence: here.zip(&other.presence, |a, b| a + (1.0 - a) * b),
        }
    }
}

/// A square whose end blends into its beginning.
fn repeating(plane: &Plane) -> Plane {
    let rows = plane.width;
    let mut values = plane.values.clone();
    for n in 0..OVERLAP {
        let (begin, end) = passage((n as f64 + 0.5) / OVERLAP as f64);
        for x in 0..rows {
            values[n * rows + x] =
                begin * values[n * rows + x] + end * values[(SIDE + n) * rows + x];
        }
    }
    for y in 0..SIDE {
        for n in 0..OVERLAP {
            let (begin, end) = passage((n as f64 + 0.5) / OVERLAP as f64);
            values[y * rows + n] = begin * values[y * rows + n] + end * values[y * rows + SIDE + n];
        }
    }
    let at = |n: usize| values[n / SIDE * rows + n % SIDE];
    Plane {
        width: SIDE,
        height: SIDE,
        values: (0..SIDE * SIDE).map(at).collect(),
    }
}

/// Blend weights of beginning and end; their squares add up to 1.
fn passage(t: f64) -> (f64, f64) {
    let begins = t * t * (3.0 - 2.0 * t);
    (begins.sqrt(), (1.0 - begins).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_passes_into_the_beginning() {
        let side = SIDE + OVERLAP;
        // Values increase with the column: they may jump only within the overlap.
        let plane = Plane {
            width: side,
            height: side,
            values: (0..side * side).map(|n| (n % side) as f64).collect(),
        };
        let tile = repeating(&plane);
        // The last column is followed by the next column of the source.
        assert_eq!(tile.values[500 * SIDE + SIDE - 1], (SIDE - 1) as f64);
        let first = tile.values[500 * SIDE];
        assert!((first - SIDE as f64).abs() < 0.05 * SIDE as f64, "{first}");
    }
}
