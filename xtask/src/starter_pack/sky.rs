//! Stars, the Milky Way and the Moon.

use super::map::Map;
use anyhow::{Context, Result, ensure};
use image::ExtendedColorType;
use image::ImageEncoder;
use image::codecs::jpeg::JpegEncoder;
use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::Path;

/// Magnitude limit, Hp.
const FAINTEST_HP: f64 = 6.5;
/// Corrected Hp of three stars: Sirius, which saturated, and α Cen B and α¹ CVn, whose values include a neighbour's light.
const HP: [(u32, f64); 3] = [(32_349, -1.450), (71_681, 1.509), (63_121, 5.692)];
/// Stars whose Hp is that of a group, which another entry represents: θ¹ Ori A and D (26221), σ Ori D (26549).
const OF_OTHERS: [u32; 3] = [26_220, 26_224, 26_551];
/// A star without B − V, which the catalogue gives as 0.
const B_V: (u32, f64) = (32_609, 0.480);

/// Makes `stars.bin`.
pub fn stars(data: &Path) -> Result<Vec<u8>> {
    let path = data.join("sky/hipparcos_hp8.csv");
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let mut stars = Vec::new();
    let mut seen = BTreeSet::new();
    for (line, row) in (1..).zip(text.lines()).skip(1) {
        let place = || format!("{}:{line}", path.display());
        let (hip, rest) = row.split_once(',').with_context(place)?;
        let hip: u32 = hip.parse().with_context(place)?;
        let numbers = rest.split(',').map(|field| field.parse::<f64>());
        let numbers = numbers.collect::<Result<Vec<_>, _>>().with_context(place)?;
        let [ra, dec, pm_ra, pm_dec, mut hp, mut b_v] = numbers[..] else {
            anyhow::bail!("{}: not seven columns", place());
        };
        let is_sound = (0.0..TAU).contains(&ra)
            && dec.abs() <= FRAC_PI_2
            && pm_ra.abs().max(pm_dec.abs()) < 11_000.0
            && (-2.0..9.0).contains(&hp)
            && (-0.5..6.0).contains(&b_v);
        ensure!(is_sound && seen.insert(hip), "{}: no star", place());
        if let Some((_, right)) = HP.iter().find(|(of, _)| *of == hip) {
            hp = *right;
        }
        if B_V.0 == hip {
            b_v = B_V.1;
        }
        if hp > FAINTEST_HP || OF_OTHERS.contains(&hip) {
            continue;
        }
        let turn = 2_f64.powi(32) / TAU;
        let millis = |value: f64| (1e3 * value).round_ties_even() as i16;
        let mut record = Vec::with_capacity(24);
        record.extend(hip.to_le_bytes());
        record.extend(((ra * turn).round_ties_even() as u64 as u32).to_le_bytes());
        record.extend(((dec * turn).round_ties_even() as i32).to_le_bytes());
        for motion in [pm_ra, pm_dec] {
            record.extend(((100.0 * motion).round_ties_even() as i32).to_le_bytes());
        }
        record.extend(millis(hp).to_le_bytes());
        record.extend(millis(b_v).to_le_bytes());
        stars.push((millis(hp), hip, record));
    }
    stars.sort();
    let mut bytes = b"TRSTARS1".to_vec();
    bytes.extend((stars.len() as u32).to_le_bytes());
    bytes.extend(stars.into_iter().flat_map(|(.., record)| record));
    Ok(bytes)
}

/// Generates `moon.jpg` at a quarter of the size. The source's encoded values, not their decoded light, match the Moon's albedo (mare to highland 1
/// : 1.8), so they are used as linear light.
pub fn moon(data: &Path) -> Result<Vec<u8>> {
    let map = Map::read(&data.join("sky/moon_4096x2048_stellarium-data.jpg"), 3)?;
    let mut map = map.halved().halved();
    for value in &mut map.values {
        *value = (255.0 * encoded(f64::from(*value) / 255.0)) as f32;
    }
    jpeg(&map, 90)
}

/// Generates `milky_way.jpg`. The source is processed for the eye: decoded, its contrast in magnitudes is twice that of the sky, and its colours
/// are far too strong. So the square root of its light is used, and a third of its saturation.
pub fn milky_way(data: &Path) -> Result<Vec<u8>> {
    /// Light below which the source has too few steps and is blurred, and the blur in texels.
    const FAINT: f64 = 0.004;
    const BLUR: usize = 8;
    /// Light added before the square root, so that it does not amplify noise near zero.
    const FOOT: f64 = 8e-4;
    const COLOR: f64 = 0.35;
    let path = data.join("sky/milkyway_2048x1024_stellarium-data.png");
    let mut map = Map::read(&path, 3)?;
    for value in &mut map.values {
        *value = (255.0 * decoded(f64::from(*value) / 255.0)) as f32;
    }
    let mut map = map.halved();
    // Rows at the poles are black.
    let row = map.width * 3;
    for (from, to) in [(4, 0..4), (map.height - 5, map.height - 4..map.height)] {
        let source = map.values[from * row..(from + 1) * row].to_vec();
        let mean = |channel: usize| {
            let values = source.iter().skip(channel).step_by(3);
            values.sum::<f32>() / map.width as f32
        };
        let mean = [mean(0), mean(1), mean(2)];
        for y in to {
            let texels = map.row_mut(y).chunks_exact_mut(3);
            texels.for_each(|texel| texel.copy_from_slice(&mean));
        }
    }
    let smooth = blurred(&map, BLUR);
    let (texels, _) = map.values.as_chunks_mut::<3>();
    for (texel, smooth) in texels.iter_mut().zip(smooth.as_chunks::<3>().0) {
        let light = texel.map(|value| f64::from(value) / 255.0);
        let t = (luminance(light) / FAINT).clamp(0.0, 1.0);
        let part = t * t * (3.0 - 2.0 * t);
        let light = [0, 1, 2].map(|n| part * light[n] + (1.0 - part) * smooth[n] / 255.0);
        let y = luminance(light);
        let shown = (y + FOOT).sqrt() - FOOT.sqrt();
        let strength = COLOR * (y / 0.002).min(1.0);
        let color = light.map(|value| (1.0 + strength * (value / y.max(1e-6) - 1.0)).max(0.0));
        let even = luminance(color);
        *texel = color.map(|value| (255.0 * encoded(shown * value / even)) as f32);
    }
    jpeg(&map, 90)
}

fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Linear light of an sRGB value, both 0…1.
fn decoded(value: f64) -> f64 {
    match value <= 0.04045 {
        true => value / 12.92,
        false => ((value + 0.055) / 1.055).powf(2.4),
    }
}

/// The sRGB value of linear light, both 0…1.
fn encoded(light: f64) -> f64 {
    match light.clamp(0.0, 1.0) {
        light if light <= 0.003_130_8 => 12.92 * light,
        light => 1.055 * light.powf(1.0 / 2.4) - 0.055,
    }
}

/// Blurs with a Gaussian of this deviation in texels; wraps in longitude, ends at the poles.
fn blurred(map: &Map, texels: usize) -> Vec<f64> {
    let reach = 3 * texels as isize;
    let weight = |n: isize| (-0.5 * (n as f64 / texels as f64).powi(2)).exp();
    let sum: f64 = (-reach..=reach).map(weight).sum();
    let weights: Vec<_> = (-reach..=reach).map(|n| weight(n) / sum).collect();
    let (width, height) = (map.width as isize, map.height as isize);
    let at = |values: &dyn Fn(isize) -> f64| {
        let parts = weights.iter().zip(-reach..=reach);
        parts.map(|(weight, n)| weight * values(n)).sum::<f64>()
    };
    let mut across = Vec::with_capacity(map.values.len());
    for n in 0..map.values.len() as isize {
        let (texel, channel) = (n / 3, n % 3);
        let (x, y) = (texel % width, texel / width);
        across.push(at(&|off| {
            let from = y * width + (x + off).rem_euclid(width);
            f64::from(map.values[(from * 3 + channel) as usize])
        }));
    }
    let mut out = Vec::with_capacity(across.len());
    for n in 0..across.len() as isize {
        let (texel, channel) = (n / 3, n % 3);
        let (x, y) = (texel % width, texel / width);
        out.push(at(&|off| {
            let from = (y + off).clamp(0, height - 1) * width + x;
            across[(from * 3 + channel) as usize]
        }));
    }
    out
}

fn jpeg(map: &Map, quality: u8) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality).write_image(
        &map.to_bytes(),
        map.width as u32,
        map.height as u32,
        ExtendedColorType::Rgb8,
    )?;
    Ok(bytes)
}
