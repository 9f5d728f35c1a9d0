//! The cloud map: mends its cuts and polar caps, and converts its values to cover.

use super::map::{Map, smooth_step};
use super::plane::Plane;
use super::poles::PoleMend;
use anyhow::Result;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;
use std::path::Path;

/// Path of the map in the folder of source data.
const SOURCE: &str = "imagery/clouds_alpha_gray_4096x2048.png";

const JPEG_QUALITY: u8 = 75;

/// Cumulative distribution of cover over the Earth's area: clear sky, thin cloud and overcast in the proportions that satellites observe over the
/// sea. The mean is 0.2475.
const COVER_OF_SHARE: [(f64, f64); 8] = [
    (0.0, 0.0),
    (0.20, 0.0),
    (0.35, 0.03),
    (0.52, 0.15),
    (0.66, 0.30),
    (0.80, 0.50),
    (0.91, 0.70),
    (1.0, 1.0),
];

/// The mended source.
pub fn source(data: &Path) -> Result<Map> {
    Ok(mended(Map::read(&data.join(SOURCE), 1)?))
}

/// Generates `clouds.jpg` from the mended source, with cover as values.
pub fn make(mut map: Map) -> Result<Vec<u8>> {
    specify(&mut map);
    let mut jpeg = Vec::new();
    JpegEncoder::new_with_quality(&mut jpeg, JPEG_QUALITY).encode(
        &map.to_bytes(),
        map.width as u32,
        map.height as u32,
        ExtendedColorType::L8,
    )?;
    Ok(jpeg)
}

/// Gives the map the distribution of [`COVER_OF_SHARE`].
///
/// The source ranks places by cloudiness but does not measure it: nearly a third of its texels have one of seven values. So the texels are ordered,
/// equal values by the means of their neighbourhoods (exact histogram specification: Coltuc, Bolon and Chassery 2006, IEEE Trans. Image Process.
/// 15, 1143), and each gets the cover of its rank.
fn specify(map: &mut Map) {
    let plane = Plane::of(map);
    let order = plane.order();
    let areas: Vec<f64> = (0..map.height).map(|y| row_area(y, map.height)).collect();
    let whole = areas.iter().sum::<f64>() * map.width as f64;
    let mut below = 0.0;
    for texel in order {
        let area = areas[texel as usize / map.width];
        let share = (below + 0.5 * area) / whole;
        map.values[texel as usize] = 255.0 * cover_of_share(share) as f32;
        below += area;
    }
}

fn cover_of_share(share: f64) -> f64 {
    let mut pairs = COVER_OF_SHARE.windows(2);
    pairs.find(|pair| share <= pair[1].0).map_or(1.0, |pair| {
        let [(from, low), (to, high)] = [pair[0], pair[1]];
        low + (high - low) * (share - from) / (to - from)
    })
}

/// Area of a row's texels relative to the equator's: the cosine of the latitude by its series, with the same bits on every machine.
fn row_area(y: usize, height: usize) -> f64 {
    let half_turns = (y as f64 + 0.5) / height as f64 - 0.5;
    let square = (half_turns * std::f64::consts::PI) * (half_turns * std::f64::consts::PI);
    let terms = (1..=10).rev();
    terms.fold(1.0, |sum, n| {
        1.0 - sum * square / f64::from((2 * n - 1) * (2 * n))
    })
}

/// The map, at any size, without its cuts and with complete polar caps.
fn mended(mut map: Map) -> Map {
    // The map was assembled from halves: there is a slight step at 0° as well as at 180°.
    let (middle, reach) = (map.width / 2, map.width * 12 / 2048);
    map.mend_step(0, reach);
    map.mend_step(middle, reach);
    mirror_north_cap(&mut map);
    PoleMend {
        from_deg: 14.0,
        full_deg: 4.0,
        grain_km: 45.0,
        cap_deg: 0.5,
    }
    .apply(&mut map);
    map
}

/// Replaces the southern cap by the mirror image of the northern one. The source has one white and one black sector there, with streaks between
/// them that meet at the pole.
///
/// Softening such sectors only turns streaks into rings. Real clouds mirrored at the equator rotate correctly for their hemisphere, and both caps
/// are never visible together. The transition lies from 71° to 78° S; the rotation in longitude minimizes the difference between both maps there.
fn mirror_north_cap(map: &mut Map) {
    const TURN_DEG: f64 = 235.0;
    let (width, height) = (map.width, map.height);
    let turn = (TURN_DEG / 360.0 * width as f64) as usize;
    for y in height / 2..height {
        let latitude_deg = 90.0 - (y as f64 + 0.5) * 180.0 / height as f64;
        let share = smooth_step(-71.0, -78.0, latitude_deg) as f32;
        if share == 0.0 {
            continue;
        }
        let north = map.row_mut(height - 1 - y).to_vec();
        for (x, value) in map.row_mut(y).iter_mut().enumerate() {
            *value += share * (north[(x + width - turn) % width] - *value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_have_the_areas_of_a_sphere() {
        for y in 0..180 {
            let latitude = (f64::from(y) + 0.5 - 90.0).to_radians();
            let area = row_area(y as usize, 180);
            assert!((area - latitude.cos()).abs() < 1e-12, "{y}");
        }
    }

    #[test]
    fn the_map_gets_the_wanted_shares_by_area() {
        // Few distinct values, like the source.
        let (width, height) = (128, 64);
        let value = |n: usize| ((n * 7919) % 9 + (n % width) / 40) as f32;
        let mut map = Map {
            width,
            height,
            channels: 1,
            values: (0..width * height).map(value).collect(),
        };
        let before = map.values.clone();
        specify(&mut map);
        let share = |most: f64| {
            let texels = (0..width * height).filter(|n| f64::from(map.values[*n]) < 255.0 * most);
            let area: f64 = texels.map(|n| row_area(n / width, height)).sum();
            let whole: f64 = (0..height).map(|y| row_area(y, height)).sum();
            area / (whole * width as f64)
        };
        for (expected, cover) in &COVER_OF_SHARE[2..7] {
            assert!((share(*cover) - expected).abs() < 1e-3, "{cover}");
        }
        // The order is preserved.
        let (_, low) = before
            .iter()
            .zip(&map.values)
            .filter(|(b, _)| **b == 2.0)
            .fold((0, 0.0f32), |(n, most), (_, v)| (n + 1, most.max(*v)));
        let high = before
            .iter()
            .zip(&map.values)
            .filter(|(b, _)| **b == 3.0)
            .map(|(_, v)| *v);
        assert!(high.fold(f32::INFINITY, f32::min) >= low);
    }
}
