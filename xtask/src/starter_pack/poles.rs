//! Mends the surroundings of the poles, where a row of texels shrinks to a point.

use super::map::{Map, smooth_step};

/// Settings for the poles. Distances are from the nearer pole.
pub struct PoleMend {
    /// Distance at which the softening begins, degrees.
    pub from_deg: f64,
    /// Distance below which the softening is full, degrees.
    pub full_deg: f64,
    /// East–west size of the finest remaining detail, kilometres.
    pub grain_km: f64,
    /// Distance over which the last rows blend into one value, degrees.
    pub cap_deg: f64,
}

/// Kilometres along a meridian per degree.
const KM_PER_DEG: f64 = 111.2;

impl PoleMend {
    /// Softens each row until no detail is finer than the grain on the ground.
    ///
    /// Streaks and pinches at a pole are detail that is fine from east to west because its row is short there. A row shorter than the grain becomes
    /// its own mean, so that rows fade towards their means as they get shorter.
    pub fn apply(&self, map: &mut Map) {
        let rows_to = |deg: f64| (deg / 180.0 * map.height as f64).ceil() as usize;
        let (softened, cap) = (rows_to(self.from_deg), rows_to(self.cap_deg));
        for south in [false, true] {
            let row_at = |map: &Map, n: usize| if south { map.height - 1 - n } else { n };
            for n in 0..softened.min(map.height / 2) {
                let from_pole_deg = (n as f64 + 0.5) * 180.0 / map.height as f64;
                let grain_km =
                    self.grain_km * smooth_step(self.from_deg, self.full_deg, from_pole_deg);
                let row_km = 360.0 * KM_PER_DEG * sine_of_small_angle(from_pole_deg);
                let (channels, y) = (map.channels, row_at(map, n));
                let grain_texels = grain_km / row_km * map.width as f64;
                soften(map.row_mut(y), channels, grain_texels);
            }
            for channel in 0..map.channels {
                let mut sum = (0.0, 0.0);
                for n in 0..cap {
                    // Weight rows by their area.
                    let weight = n as f64 + 0.5;
                    let (channels, y) = (map.channels, row_at(map, n));
                    let values = map.row_mut(y).iter().skip(channel).step_by(channels);
                    let row: f64 = values.map(|value| f64::from(*value)).sum();
                    sum = (sum.0 + weight, sum.1 + weight * row / map.width as f64);
                }
                let cap_value = sum.1 / sum.0;
                for n in 0..cap {
                    let from_pole_deg = (n as f64 + 0.5) * 180.0 / map.height as f64;
                    let fade = smooth_step(self.cap_deg, self.cap_deg * 0.3, from_pole_deg) as f32;
                    let (channels, y) = (map.channels, row_at(map, n));
                    for value in map.row_mut(y).iter_mut().skip(channel).step_by(channels) {
                        *value += fade * (cap_value as f32 - *value);
                    }
                }
            }
        }
    }
}

/// sin x by its series, exact to 1e-6 up to 25°.
fn sine_of_small_angle(angle_deg: f64) -> f64 {
    let x = angle_deg * (std::f64::consts::PI / 180.0);
    x * (1.0 - x * x / 6.0 * (1.0 - x * x / 20.0 * (1.0 - x * x / 42.0)))
}

/// Two consecutive box means of `size` texels: a triangle filter of this full width at half maximum. Periodic; a box at least as long as the row
/// gives the row's mean.
fn soften(row: &mut [f32], channels: usize, size: f64) {
    if size <= 1.0 {
        // A box of one texel changes nothing.
        return;
    }
    let width = row.len() / channels;
    for channel in 0..channels {
        let mut line: Vec<f64> = row
            .iter()
            .skip(channel)
            .step_by(channels)
            .map(|value| f64::from(*value))
            .collect();
        for _ in 0..2 {
            line = box_mean(&line, size.min(width as f64));
        }
        for (value, soft) in row.iter_mut().skip(channel).step_by(channels).zip(line) {
            *value = soft as f32;
        }
    }
}

/// The mean over `size` texels around each texel, with the outermost ones in part; `size` is 1 to the row's length.
fn box_mean(line: &[f64], size: f64) -> Vec<f64> {
    let width = line.len();
    let mut integral = Vec::with_capacity(width + 1);
    integral.push(0.0);
    for value in line {
        integral.push(integral[integral.len() - 1] + value);
    }
    let total = integral[width];
    // Integral from 0 to t of the periodic line.
    let up_to = |t: f64| {
        let turns = (t / width as f64).floor();
        let t = t - turns * width as f64;
        let texel = (t as usize).min(width - 1);
        turns * total + integral[texel] + (t - texel as f64) * line[texel]
    };
    (0..width)
        .map(|x| {
            let centre = x as f64 + 0.5;
            (up_to(centre + size / 2.0) - up_to(centre - size / 2.0)) / size
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_mean_keeps_the_mean_and_wraps_round() {
        let line: Vec<f64> = (0..16).map(|n| f64::from(n * n % 7)).collect();
        let mean = line.iter().sum::<f64>() / 16.0;
        for size in [1.0, 2.5, 3.0, 15.9, 16.0] {
            let soft = box_mean(&line, size);
            assert!((soft.iter().sum::<f64>() / 16.0 - mean).abs() < 1e-12);
        }
        assert!(
            box_mean(&line, 16.0)
                .iter()
                .all(|v| (v - mean).abs() < 1e-12)
        );
        let mut spike = vec![0.0; 16];
        spike[0] = 3.0;
        let soft = box_mean(&spike, 3.0);
        assert_eq!((soft[15], soft[0], soft[1], soft[2]), (1.0, 1.0, 1.0, 0.0));
    }

    #[test]
    fn a_sector_at_the_pole_becomes_one_value_and_the_rest_is_untouched() {
        let (width, height) = (256, 128);
        let values = (0..width * height)
            .map(|n| if n % width < 60 { 255.0 } else { 0.0 })
            .collect();
        let mut map = Map {
            width,
            height,
            channels: 1,
            values,
        };
        let before = map.values.clone();
        let mend = PoleMend {
            from_deg: 15.0,
            full_deg: 8.0,
            grain_km: 1_500.0,
            cap_deg: 3.0,
        };
        mend.apply(&mut map);
        for y in [0, height - 1] {
            let row = &map.values[y * width..(y + 1) * width];
            assert!(row.iter().all(|value| (value - row[0]).abs() < 1.0));
            assert!((row[0] - 255.0 * 60.0 / 256.0).abs() < 1.0);
        }
        // 15° are 10.7 rows.
        assert_eq!(
            map.values[11 * width..117 * width],
            before[11 * width..117 * width]
        );
        assert_ne!(
            map.values[8 * width..9 * width],
            before[8 * width..9 * width]
        );
    }

    #[test]
    fn the_sine_series_is_the_sine() {
        for tenth_deg in 0..250 {
            let angle_deg = f64::from(tenth_deg) / 10.0;
            let error = sine_of_small_angle(angle_deg) - angle_deg.to_radians().sin();
            assert!(error.abs() < 1e-6, "{angle_deg}");
        }
    }
}
