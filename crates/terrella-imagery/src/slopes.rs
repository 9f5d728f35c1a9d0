//! Terrain slopes from elevations, and slopes of cloud tops from their cover.

use super::error::ImageryError;
use super::layer::{LayerImage, check_dimensions};
use super::texel::TexelFormat;

/// Offset of the stored elevations, so that the sea floor is not negative, metres.
pub const ELEVATION_OFFSET_M: u16 = 11_000;

/// Exaggeration of the stored slopes.
///
/// A texel of the starter pack is 20 km wide, over which real slopes are mostly below 1 : 20, and a stored slope has 127 steps: a larger scale
/// loses less precision. The exaggeration in shading is separate (`SurfaceLight::relief_exaggeration`). At 4 none of the starter pack's texels
/// saturates, at 8 it is 36 of two million.
pub const SLOPE_EXAGGERATION: f64 = 4.0;

/// Over this distance from each pole slopes fade to nothing, degrees: the direction "east" turns round there
/// within a few texels.
pub const POLE_FADE_DEG: f64 = 2.0;

/// Latitude beyond which elevations are averaged along their row over the ground size of a texel at this latitude, degrees. Otherwise differences
/// of whole metres between ever closer neighbours would produce rays towards the pole.
const GRAIN_LATITUDE_DEG: f64 = 60.0;

/// IUGG mean radius R1 of the Earth, metres. The ellipsoid differs by 0.6 %, far less than the exaggeration.
const MEAN_RADIUS_M: f64 = 6_371_008.8;

/// Slopes of a map, and the number of saturated ones.
#[derive(Clone, Debug)]
pub struct SlopeMap {
    /// The slopes, `Rg8Snorm`.
    pub image: LayerImage,
    /// Texels of which a slope lay beyond ±1 and was stored as ±1.
    pub saturated_texels: u64,
}

/// Slopes (dh/d east, dh/d north), times `exaggeration`, saturated at ±1.
///
/// `elevation` is width × height values in metres plus [`ELEVATION_OFFSET_M`], cell-centred, north row first, left edge at 180° W. Differences are
/// central and periodic in longitude; spacings are the local ones in metres. Ground below sea level counts as sea: flat at 0 m, also the few dry
/// places that are lower (around the Dead and the Caspian Sea).
///
/// # Errors
/// [`ImageryError::Dimensions`] or [`ImageryError::Length`] if size and values do not match.
pub fn slopes_from_elevation(
    width: u32,
    height: u32,
    elevation: &[u16],
    exaggeration: f64,
) -> Result<SlopeMap, ImageryError> {
    check_dimensions(width, height)?;
    let (columns, rows) = (width as usize, height as usize);
    if elevation.len() != columns * rows {
        return Err(ImageryError::Length {
            width,
            height,
            format: TexelFormat::Rg8Snorm,
            needed: columns * rows,
            got: elevation.len(),
        });
    }
    let mut slopes = SlopeRows::new(columns, rows, exaggeration);
    let mut saturated_texels = 0;
    let mut texels = Vec::with_capacity(columns * rows * 2);
    let mut store = |[east, north]: [f64; 2]| {
        if east.abs() > 1.0 || north.abs() > 1.0 {
            saturated_texels += 1;
        }
        texels.extend_from_slice(&[snorm8(east), snorm8(north)]);
    };
    let mut heights_m = vec![0.0; columns];
    for row in elevation.chunks_exact(columns) {
        for (height_m, value) in heights_m.iter_mut().zip(row) {
            *height_m = f64::from(*value) - f64::from(ELEVATION_OFFSET_M);
        }
        slopes.push(&heights_m, &mut store);
    }
    slopes.finish(&mut store);
    Ok(SlopeMap {
        image: LayerImage::from_slopes(width, height, texels)?,
        saturated_texels,
    })
}

/// How far the tops of the thickest clouds rise over their thinnest edges for [`slopes_from_clouds`], metres.
const CLOUD_TOPS_M: f64 = 6_000.0;

/// Slopes of the clouds' tops (dh/d east, dh/d north), times [`SLOPE_EXAGGERATION`], where a thick cloud is high and a thin
/// one low: the normal map of clouds that the paper draws with.
///
/// # Errors
/// [`ImageryError::Levels`] if `cover` is not whole or no map of one byte a texel.
pub fn slopes_from_clouds(cover: &LayerImage) -> Result<LayerImage, ImageryError> {
    cover.check()?;
    let (width, height) = (cover.width as usize, cover.height as usize);
    let texels = match (cover.format, cover.levels.first()) {
        (TexelFormat::R8Unorm, Some(texels)) => texels,
        _ => {
            return Err(ImageryError::Levels {
                level: 0,
                width: cover.width,
                height: cover.height,
                format: cover.format,
            });
        }
    };
    let mut slopes = SlopeRows::new(width, height, SLOPE_EXAGGERATION);
    let mut bytes = Vec::with_capacity(2 * width * height);
    let mut store = |slope: [f64; 2]| bytes.extend_from_slice(&slope.map(snorm8));
    let mut heights_m = vec![0.0; width];
    for row in texels.chunks_exact(width) {
        for (height_m, cover) in heights_m.iter_mut().zip(row) {
            *height_m = CLOUD_TOPS_M * f64::from(*cover) / 255.0;
        }
        slopes.push(&heights_m, &mut store);
    }
    slopes.finish(&mut store);
    LayerImage::from_slopes(cover.width, cover.height, bytes)
}

/// Computes slopes row by row, with three rows of elevations in memory. Rows are added from the north; each row's slopes are output when the row
/// south of it is known.
pub struct SlopeRows {
    rows: usize,
    row_spacing_m: f64,
    equator_spacing_m: f64,
    exaggeration: f64,
    /// Rows taken so far.
    taken: usize,
    /// Heights of the land two rows and one row back; the sea at 0 m.
    north_m: Vec<f64>,
    middle_m: Vec<f64>,
    /// Which texels of the row before are land.
    is_land: Vec<bool>,
}

impl SlopeRows {
    /// For a map of so many columns and rows, each at least 1.
    pub fn new(columns: usize, rows: usize, exaggeration: f64) -> Self {
        Self {
            rows,
            row_spacing_m: MEAN_RADIUS_M * std::f64::consts::PI / rows as f64,
            equator_spacing_m: MEAN_RADIUS_M * std::f64::consts::TAU / columns as f64,
            exaggeration,
            taken: 0,
            north_m: Vec::new(),
            middle_m: Vec::new(),
            is_land: Vec::new(),
        }
    }

    fn latitude_deg(&self, y: usize) -> f64 {
        90.0 - (y as f64 + 0.5) * 180.0 / self.rows as f64
    }

    /// Takes the next row, metres above the sea, negative in it. `store` gets the slopes of the row before, (east,
    /// north), not saturated; nothing for the first row.
    pub fn push(&mut self, heights_m: &[f64], store: impl FnMut([f64; 2])) {
        let y = self.taken;
        let south_m = self.land_row(y, heights_m);
        if y == 0 {
            // Beyond a pole there is no row: the difference is then taken to the row itself, over one spacing.
            self.north_m = south_m.clone();
            self.middle_m = south_m;
        } else {
            self.slopes(y - 1, &south_m, store);
            self.north_m = std::mem::replace(&mut self.middle_m, south_m);
        }
        // A height that is not a number is where there are no data: sea.
        self.is_land.clear();
        self.is_land
            .extend(heights_m.iter().map(|height_m| *height_m >= 0.0));
        self.taken += 1;
    }

    /// The slopes of the last row; none if there was no row.
    pub fn finish(&mut self, store: impl FnMut([f64; 2])) {
        if let Some(y) = self.taken.checked_sub(1) {
            self.slopes(y, &self.middle_m, store);
        }
    }

    fn land_row(&self, y: usize, heights_m: &[f64]) -> Vec<f64> {
        let columns = heights_m.len();
        let land_m: Vec<f64> = heights_m.iter().map(|height_m| height_m.max(0.0)).collect();
        let shrink = self.latitude_deg(y).to_radians().cos();
        let grain = GRAIN_LATITUDE_DEG.to_radians().cos() / shrink;
        if grain > 1.0 {
            box_mean(&land_m, grain.min(columns as f64))
        } else {
            land_m
        }
    }

    /// Slopes of row `y`, which is `middle_m`.
    fn slopes(&self, y: usize, south_m: &[f64], mut store: impl FnMut([f64; 2])) {
        let spacings = usize::from(y > 0) + usize::from(y + 1 < self.rows);
        let latitude_deg = self.latitude_deg(y);
        let gain = self.exaggeration * pole_fade(latitude_deg);
        let east_gain = gain / (2.0 * self.equator_spacing_m * latitude_deg.to_radians().cos());
        let north_gain = gain / (spacings.max(1) as f64 * self.row_spacing_m);

        let columns = self.middle_m.len();
        for (x, is_land) in self.is_land.iter().enumerate() {
            if !*is_land {
                store([0.0, 0.0]);
                continue;
            }
            let west = if x == 0 { columns - 1 } else { x - 1 };
            let east = if x + 1 == columns { 0 } else { x + 1 };
            let slope_east = (self.middle_m[east] - self.middle_m[west]) * east_gain;
            let slope_north = (self.north_m[x] - south_m[x]) * north_gain;
            store([slope_east, slope_north]);
        }
    }
}

/// The mean over `size` texels round each texel of a periodic row, the outermost counted in part; `size` from 1 to the
/// row's length.
fn box_mean(row: &[f64], size: f64) -> Vec<f64> {
    let width = row.len();
    let mut integral = Vec::with_capacity(width + 1);
    let mut total = 0.0;
    integral.push(total);
    for value in row {
        total += value;
        integral.push(total);
    }
    // ∫ from 0 to t of the row, continued periodically.
    let up_to = |t: f64| {
        let turns = (t / width as f64).floor();
        let t = t - turns * width as f64;
        let texel = (t as usize).min(width - 1);
        turns * total + integral[texel] + (t - texel as f64) * row[texel]
    };
    (0..width)
        .map(|x| {
            let centre = x as f64 + 0.5;
            (up_to(centre + size / 2.0) - up_to(centre - size / 2.0)) / size
        })
        .collect()
}

/// 1 away from the poles, 0 at them, smooth between.
pub fn pole_fade(latitude_deg: f64) -> f64 {
    let t = ((90.0 - latitude_deg.abs()) / POLE_FADE_DEG).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The signed byte nearest to a value in −1…1, saturating.
pub fn snorm8(value: f64) -> u8 {
    (value.clamp(-1.0, 1.0) * 127.0).round() as i8 as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 256;
    const HEIGHT: usize = 128;

    /// Elevations from a height in metres at (longitude, latitude) in degrees.
    fn elevations(height_m: impl Fn(f64, f64) -> f64) -> Vec<u16> {
        let mut values = Vec::new();
        for y in 0..HEIGHT {
            for x in 0..WIDTH {
                let longitude_deg = (x as f64 + 0.5) * 360.0 / WIDTH as f64 - 180.0;
                let latitude_deg = 90.0 - (y as f64 + 0.5) * 180.0 / HEIGHT as f64;
                let height_m = height_m(longitude_deg, latitude_deg);
                values.push((height_m + f64::from(ELEVATION_OFFSET_M)).round() as u16);
            }
        }
        values
    }

    fn slopes(height_m: impl Fn(f64, f64) -> f64, exaggeration: f64) -> SlopeMap {
        let values = elevations(height_m);
        slopes_from_elevation(WIDTH as u32, HEIGHT as u32, &values, exaggeration)
            .expect("good size")
    }

    /// (east, north) stored at the texel that holds a place.
    fn at(map: &SlopeMap, longitude_deg: f64, latitude_deg: f64) -> (f64, f64) {
        let x = ((longitude_deg + 180.0) / 360.0 * WIDTH as f64) as usize;
        let y = ((90.0 - latitude_deg) / 180.0 * HEIGHT as f64) as usize;
        let texel = &map.image.levels[0][(y * WIDTH + x) * 2..];
        (
            f64::from(texel[0] as i8) / 127.0,
            f64::from(texel[1] as i8) / 127.0,
        )
    }

    #[test]
    fn a_hill_has_the_slopes_of_its_formula() {
        // h = A exp(−(dλ² + dφ²)/2s²): dh/dφ = −h dφ/s², in metres along the meridian divided by R; east by R cos φ.
        let (amplitude_m, spread_deg) = (6_000.0, 12.0);
        let hill = |lon: f64, lat: f64| {
            amplitude_m
                * (-(lon.powi(2) + (lat - 40.0).powi(2)) / (2.0 * spread_deg * spread_deg)).exp()
        };
        let exaggeration = 100.0;
        let map = slopes(hill, exaggeration);
        let mut steepest: f64 = 0.0;
        for (lon, lat) in [
            (-12.0, 40.0),
            (12.0, 40.0),
            (0.7, 52.0),
            (0.7, 28.0),
            (9.0, 47.0),
            (-14.0, 61.0),
        ] {
            let lon_centre = ((lon + 180.0f64) / 360.0 * WIDTH as f64).floor() + 0.5;
            let lat_centre = ((90.0 - lat) / 180.0 * HEIGHT as f64).floor() + 0.5;
            let lon_centre = lon_centre * 360.0 / WIDTH as f64 - 180.0;
            let lat_centre = 90.0 - lat_centre * 180.0 / HEIGHT as f64;
            let metres_per_deg = MEAN_RADIUS_M.to_radians();
            let steep = -hill(lon_centre, lat_centre) / (spread_deg * spread_deg * metres_per_deg);
            let east = exaggeration * steep * lon_centre / lat_centre.to_radians().cos();
            let north = exaggeration * steep * (lat_centre - 40.0);
            let stored = at(&map, lon, lat);
            assert!(
                (stored.0 - east).abs() < 0.012,
                "{lon} {lat} east {east} {stored:?}"
            );
            assert!(
                (stored.1 - north).abs() < 0.012,
                "{lon} {lat} north {north} {stored:?}"
            );
            steepest = steepest.max(east.abs()).max(north.abs());
        }
        assert!(
            steepest > 0.25,
            "the hill must be steep enough to tell: {steepest}"
        );
        assert_eq!(map.saturated_texels, 0);
    }

    #[test]
    fn signs_are_uphill_to_the_east_and_to_the_north() {
        let eastward = slopes(|lon, _| 1_000.0 + 20.0 * lon.clamp(-50.0, 50.0), 1_000.0);
        let (east, north) = at(&eastward, 10.0, 30.0);
        assert!(east > 0.1 && north == 0.0, "{east} {north}");
        let northward = slopes(|_, lat| 2_000.0 + 20.0 * lat, 1_000.0);
        for lat in [-60.0, 0.0, 60.0] {
            let (east, north) = at(&northward, 10.0, lat);
            assert!(north > 0.1 && east == 0.0, "{lat}: {east} {north}");
        }
    }

    #[test]
    fn the_same_rise_per_degree_is_steeper_towards_the_poles() {
        let map = slopes(|lon, _| 3_000.0 + 20.0 * lon.clamp(-50.0, 50.0), 2_000.0);
        let ratio = at(&map, 10.0, 60.0).0 / at(&map, 10.0, 0.5).0;
        assert!((ratio - 2.0).abs() < 0.05, "{ratio}");
    }

    #[test]
    fn the_sea_is_flat_and_shores_rise_from_sea_level() {
        // Land of 500 m east of the prime meridian, a trench west of it.
        let spacing_m = MEAN_RADIUS_M * std::f64::consts::TAU / WIDTH as f64;
        let rise = 500.0 / (2.0 * spacing_m * 10f64.to_radians().cos());
        let map = slopes(|lon, _| if lon < 0.0 { -8_000.0 } else { 500.0 }, 100.0);
        assert_eq!(at(&map, -0.5, 10.0), (0.0, 0.0));
        assert!((at(&map, 0.5, 10.0).0 - rise * 100.0).abs() < 0.01);
        assert_eq!(at(&map, 90.0, 10.0), (0.0, 0.0));
    }

    #[test]
    fn the_date_line_is_no_edge() {
        // Periodic in longitude: the slope across the seam follows the cosine there.
        let wave = |lon: f64, _| 3_000.0 + 2_000.0 * lon.to_radians().sin();
        let map = slopes(wave, 1_000.0);
        let expected = -(1_000.0 * 2_000.0) / MEAN_RADIUS_M;
        for lon in [-179.5, 179.5] {
            let (east, _) = at(&map, lon, 0.5);
            assert!((east - expected).abs() < 0.02, "{lon}: {east} {expected}");
        }
    }

    #[test]
    fn rows_near_the_poles_are_averaged_to_one_ground_size() {
        let comb: Vec<f64> = (0..64).map(|n| f64::from(n % 4)).collect();
        assert_eq!(box_mean(&comb, 1.0), comb);
        assert!(
            box_mean(&comb, 64.0)
                .iter()
                .all(|m| (m - 1.5).abs() < 1e-12)
        );
        assert!(box_mean(&comb, 8.0).iter().all(|m| (m - 1.5).abs() < 1e-12));
        let mut spike = vec![0.0; 8];
        spike[0] = 2.0;
        let mean = box_mean(&spike, 2.0);
        assert_eq!(mean[..3], [1.0, 0.5, 0.0]);
        assert_eq!(mean[7], 0.5);
    }

    #[test]
    fn slopes_stay_small_near_the_poles_and_end_at_them() {
        // Neighbours two apart differ by one metre everywhere, as rounding alone makes them do.
        let (width, height) = (4096, 2048);
        let values: Vec<u16> = (0..width * height)
            .map(|n| ELEVATION_OFFSET_M + u16::from(n % width / 2 % 2 == 1))
            .collect();
        let map = slopes_from_elevation(width as u32, height as u32, &values, 100.0).expect("good");
        let steepest_of_row = |y: usize| {
            let row = &map.image.levels[0][y * width * 2..(y + 1) * width * 2];
            row.iter()
                .map(|byte| (*byte as i8).unsigned_abs())
                .max()
                .unwrap_or(0)
        };
        // At 50° the true slope; beyond 60° at most that of the texel at 60°.
        assert!(steepest_of_row(455) >= 1);
        for y in (0..341).chain(1707..height) {
            assert!(steepest_of_row(y) <= 2, "row {y}: {}", steepest_of_row(y));
        }
        assert_eq!((steepest_of_row(0), steepest_of_row(height - 1)), (0, 0));
        assert_eq!(pole_fade(90.0), 0.0);
        assert_eq!(pole_fade(-88.0), 1.0);
    }

    #[test]
    fn saturated_texels_are_counted_once_each() {
        let mut values = elevations(|_, _| 0.0);
        values[64 * WIDTH + 100] += 9_000;
        // The four neighbours of the peak see 9 000 m over two spacings of about 156 km.
        let map = slopes_from_elevation(WIDTH as u32, HEIGHT as u32, &values, 50.0).expect("good");
        assert_eq!(map.saturated_texels, 4);
        let map = slopes_from_elevation(WIDTH as u32, HEIGHT as u32, &values, 30.0).expect("good");
        assert_eq!(map.saturated_texels, 0);
    }

    #[test]
    fn a_wrong_number_of_values_is_rejected() {
        assert!(matches!(
            slopes_from_elevation(4, 2, &[0; 7], 1.0),
            Err(ImageryError::Length {
                needed: 8,
                got: 7,
                ..
            })
        ));
    }
}
