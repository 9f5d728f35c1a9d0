//! Elevation files: GeoTIFF, PNG and NetCDF.

use std::io::Cursor;
use std::path::Path;
use terrella_ground::elevation::read::{HeightFile, HeightFileError, Sidecar, read_heights};
use terrella_ground::elevation::{Bounds, Elevation, GridLimits, Ground};

/// Largest size of a grid, bytes.
const LIMITS: GridLimits = GridLimits { bytes: 2 << 20 };

/// For files without a georeference or a unit.
const SIDECAR: &str = include_str!("../../tests/data/heights/globe_u16.toml");

/// Reads any bytes in the format that they claim.
pub fn run(data: &[u8]) {
    let sidecar = Sidecar::from_toml(SIDECAR, Path::new("dem.toml")).expect("a good sidecar");
    let read = |sidecar| read_heights(Cursor::new(data), sidecar, Path::new("dem.x"), &LIMITS);
    let result = match read(None) {
        Err(HeightFileError::NoPlace { .. } | HeightFileError::NoUnit { .. }) => {
            read(Some(&sidecar))
        }
        result => result,
    };
    match result {
        Ok(HeightFile { grid, .. }) => {
            let stats = grid.stats();
            assert!(stats.bytes <= LIMITS.bytes);
            let bounds = grid.bounds();
            let ground = Ground::from(grid);
            let range = ground.range_m(&Bounds::GLOBE);
            for (v, u) in [(0.0, 0.0), (0.5, 0.5), (1.0, 0.3), (0.2, 1.0)] {
                let lat = bounds.south_rad + v * (bounds.north_rad - bounds.south_rad);
                let lon = bounds.west_rad + u * bounds.width_rad;
                for spacing in [0.0, 0.01, 1.0] {
                    let height = ground.height_m(lat, lon, spacing);
                    assert!(
                        range.low_m <= height && height <= range.high_m,
                        "{height} {range:?}"
                    );
                }
            }
        }
        Err(error) => {
            let said = error.to_string();
            assert!(said.starts_with("dem.x: "), "{said}");
            assert!(said.len() < 4000, "{said}");
        }
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    let files: [&[u8]; 14] = [
        include_bytes!("../../tests/data/heights/strips_i16_lzw.tif"),
        include_bytes!("../../tests/data/heights/tiles_f32_deflate_be.tif"),
        include_bytes!("../../tests/data/heights/points_big_i32.tif"),
        include_bytes!("../../tests/data/heights/feet_f64.tif"),
        include_bytes!("../../tests/data/heights/gdal_u16.tif"),
        include_bytes!("../../tests/data/heights/globe_u16.png"),
        include_bytes!("../../tests/data/heights/south_first_f32.nc"),
        include_bytes!("../../tests/data/heights/packed_i16.nc"),
        include_bytes!("../../tests/data/heights/netcdf4_i16.nc"),
        include_bytes!("../../tests/data/heights/hdf5_early_f32.nc"),
        include_bytes!("../../tests/data/gdal/zstd_i16_predictor_2.tif"),
        include_bytes!("../../tests/data/gdal/lerc_f32_holes.tif"),
        include_bytes!("../../tests/data/gdal/lerc_f64_zstd.tif"),
        include_bytes!("../../tests/data/gdal/deflate_f32_predictor_3.tif"),
    ];
    files.map(<[u8]>::to_vec).to_vec()
}
