//! Detail that is made up between the maps' texels.

use crate::common::{Rig, down, gpu, plain};
use glam::DVec3;
use terrella::frames::Geodetic;
use terrella::{
    Atmosphere, EarthLayers, EarthOptions, EyeView, LayerImage, Pipelines, SurfaceLight,
};

const SIZE: (u32, u32) = (96, 96);

/// Even maps: what is uneven is made.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Only {
    Land,
    Snow,
    Mountains,
    Clouds,
    Lamps,
    Sea,
}

fn options(only: Only, detail: bool) -> EarthOptions {
    let even = |value| {
        let map = LayerImage::from_r8(2048, 1024, vec![value; 2048 * 1024]);
        Some(map.expect("a good map"))
    };
    let mut layers = EarthLayers {
        day: LayerImage::from_rgba8(2048, 1024, [120, 110, 60, 255].repeat(2048 * 1024))
            .expect("a good map"),
        ..plain([0; 3])
    };
    match only {
        Only::Land => {}
        // Half covered.
        Only::Snow => {
            layers.day =
                LayerImage::from_rgba8(2048, 1024, [170, 170, 170, 255].repeat(2048 * 1024))
                    .expect("a good map");
        }
        // Slopes of 0.02, stored four times as steep.
        Only::Mountains => {
            let map = LayerImage::from_slopes(2048, 1024, [10, 0].repeat(2048 * 1024));
            layers.normals = Some(map.expect("a good map"));
        }
        Only::Clouds => layers.clouds = even(90),
        Only::Lamps => layers.night_lights = even(200),
        Only::Sea => layers.water = even(255),
    }
    EarthOptions {
        atmosphere: Atmosphere::None,
        light: SurfaceLight {
            detail,
            night_gain: 1e5,
            ..SurfaceLight::PLAIN
        },
        ..EarthOptions::new(layers)
    }
}

fn light(only: Only, detail: bool, view: &EyeView) -> Vec<f64> {
    let sun = match only {
        Only::Lamps => DVec3::NEG_X,
        _ => DVec3::X,
    };
    red(&mut Rig::of_light(&options(only, detail), SIZE), view, sun)
}

fn red(rig: &mut Rig, view: &EyeView, sun: DVec3) -> Vec<f64> {
    let light = rig.draw_light(view, sun);
    light.iter().map(|light| f64::from(light[0])).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard deviation as a part of the mean.
fn spread(values: &[f64]) -> f64 {
    let mean = mean(values);
    let squares = values.iter().map(|value| (value - mean).powi(2));
    (squares.sum::<f64>() / values.len() as f64).sqrt() / mean
}

fn from(height_m: f64, fov_deg: f64) -> EyeView {
    down(Geodetic::from_degrees(4.0, 7.0, height_m), fov_deg, 1.0)
}

#[test]
fn detail_is_uneven_and_keeps_the_mean() {
    // 580 km of ground: hundreds of the largest grains.
    let view = from(8e5, 40.0);
    for (only, least, off) in [
        (Only::Land, 0.1, 0.02),
        (Only::Snow, 0.2, 0.05),
        (Only::Mountains, 0.1, 0.03),
        (Only::Clouds, 0.2, 0.1),
        (Only::Lamps, 0.3, 0.2),
    ] {
        let even = light(only, false, &view);
        let made = light(only, true, &view);
        assert!(spread(&even) < 0.02, "{}", spread(&even));
        assert!(spread(&made) > least, "{}", spread(&made));
        let ratio = mean(&made) / mean(&even);
        assert!((ratio - 1.0).abs() < off, "{only:?}: {ratio}");
    }
}

#[test]
fn pixels_that_show_no_texel_show_no_detail() {
    // Texels of 20 km: grains are no larger, and go where pixels are as large.
    let view = from(2e7, 40.0);
    for only in [Only::Land, Only::Clouds, Only::Lamps] {
        assert_eq!(light(only, false, &view), light(only, true, &view));
    }
}

/// The same ground in pixels of half the size is the same ground, for all that shows in both.
#[test]
fn detail_is_fixed_to_the_ground_and_fades_in() {
    let wide = light(Only::Land, true, &from(3e5, 20.0));
    // Half the tangent of half the angle.
    let half = 2.0 * (0.5 * 10_f64.to_radians().tan()).atan().to_degrees();
    let near = light(Only::Land, true, &from(3e5, half));
    let even = mean(&light(Only::Land, false, &from(3e5, half)));
    let (mut same, mut off) = (0.0, 0.0);
    let columns = SIZE.0 as usize;
    for row in 0..columns / 2 {
        for column in 0..columns / 2 {
            let four = [(0, 0), (0, 1), (1, 0), (1, 1)];
            let four = four.map(|(y, x)| near[(2 * row + y) * columns + 2 * column + x]);
            let wide = wide[(columns / 4 + row) * columns + columns / 4 + column];
            same += (wide - even).powi(2);
            off += (wide - mean(&four)).powi(2);
        }
    }
    assert!(off < 0.15 * same, "{off} of {same}");
}

/// The structures' cube has edges at 45° W and 45° E.
#[test]
fn no_side_of_an_edge_reflects_the_other() {
    for lon_deg in [-45.0, 45.0] {
        let view = down(Geodetic::from_degrees(5.0, lon_deg, 3e5), 40.0, 1.0);
        let even = light(Only::Clouds, false, &view);
        let made = light(Only::Clouds, true, &view);
        let made: Vec<f64> = made
            .iter()
            .zip(&even)
            .map(|(made, even)| made - even)
            .collect();
        let reflected = made
            .chunks(SIZE.0 as usize)
            .flat_map(|row| row.iter().rev());
        let product: f64 = made.iter().zip(reflected).map(|(a, b)| a * b).sum();
        let alike = product / made.iter().map(|value| value * value).sum::<f64>();
        assert!(alike.abs() < 0.3, "{alike} at {lon_deg}°");
    }
}

#[test]
fn the_wind_makes_the_glint_uneven() {
    let [mut calm, mut windy] =
        [false, true].map(|detail| Rig::of_light(&options(Only::Sea, detail), SIZE));
    let (mut spreads, mut ratios) = (Vec::new(), Vec::new());
    for lon_deg in [0.0_f64, 70.0, 160.0, 250.0] {
        let (sin, cos) = lon_deg.to_radians().sin_cos();
        let sun = DVec3::new(cos, sin, 0.0);
        let view = down(Geodetic::from_degrees(4.0, lon_deg + 7.0, 4e5), 40.0, 1.0);
        let [even, made] = [&mut calm, &mut windy].map(|rig| red(rig, &view, sun));
        let brightest = even.iter().copied().fold(0.0, f64::max);
        let middle: Vec<f64> = even
            .iter()
            .zip(&made)
            .filter(|(even, _)| **even > 0.5 * brightest)
            .map(|(even, made)| made / even)
            .collect();
        assert!(middle.len() > 300, "{} pixels of glint", middle.len());
        spreads.push(spread(&middle));
        ratios.push(mean(&made) / mean(&even));
    }
    assert!(mean(&spreads) > 0.2, "{spreads:?}");
    // For Gaussian slopes the mean increases with the variance of the wind.
    assert!((0.95..1.15).contains(&mean(&ratios)), "{ratios:?}");
}

/// The Sun 20° high over clouds of even thickness on the map. Light inside of a cloud is spread: flanks of single clouds are soft.
#[test]
fn tops_of_clouds_are_soft() {
    let view = down(Geodetic::from_degrees(0.0, 70.0, 5e4), 40.0, 1.0);
    let drawn = |relief_m: f64| {
        let mut options = options(Only::Clouds, true);
        options.layers.day = plain([0; 3]).day;
        options.light.cloud_relief_m = relief_m;
        red(&mut Rig::of_light(&options, SIZE), &view, DVec3::X)
    };
    let shading: Vec<f64> = drawn(4000.0)
        .iter()
        .zip(drawn(0.0))
        .map(|(high, flat)| high / flat)
        .collect();
    assert!(
        (0.1..0.4).contains(&spread(&shading)),
        "{}",
        spread(&shading)
    );
    assert!((mean(&shading) - 1.0).abs() < 0.1, "{}", mean(&shading));
}

/// The Sun 20° high. Where the map has no slopes, terrain has none.
#[test]
fn mountains_have_lit_and_shaded_slopes() {
    let view = down(Geodetic::from_degrees(0.0, 70.0, 2e5), 40.0, 1.0);
    let shading = |only: Only| {
        let [made, even] = [true, false].map(|detail| spread(&light(only, detail, &view)));
        (made, even)
    };
    let ((mountains, _), (plain, even)) = (shading(Only::Mountains), shading(Only::Land));
    assert!(
        even < 0.1 && mountains > 1.3 * plain,
        "{even} {plain} {mountains}"
    );
}

#[test]
fn scales_that_no_pixel_shows_change_nothing() {
    // Texels are 20 km, and fine detail ends at 4 km: with 7 km pixels it is left out, with 30 km pixels all detail is.
    for height_m in [4e5, 1.2e6, 5e6] {
        let view = from(height_m, 30.0);
        let drawn = |pipelines| {
            let options = EarthOptions {
                pipelines,
                color_format: gpu().float_format(),
                ..options(Only::Clouds, true)
            };
            Rig::with_pipelines(&options, SIZE).draw_light(&view, DVec3::X)
        };
        let [all, shown] = [Pipelines::AtOnce, Pipelines::WhenNeeded].map(drawn);
        for (all, shown) in all.iter().zip(&shown) {
            for (all, shown) in all.iter().zip(shown) {
                let off = (all - shown).abs();
                assert!(off <= 2e-3 * all.abs(), "{height_m} m: {all} {shown}");
            }
        }
    }
}
