//! Maps that packs are built from.

use std::io::Cursor;
use std::path::Path;
use terrella_pack::source::{MAX_SOURCE_HEIGHT, SourceLimits, read_source};

/// The reader's buffer limit, and the limit on bytes of rows read here.
const LIMITS: SourceLimits = SourceLimits {
    buffer_bytes: 256 << 10,
};
const MOST_ROWS_BYTES: usize = 2 << 20;

/// Reads any bytes in the format that they claim.
pub fn run(data: &[u8]) {
    let path = Path::new("map.x");
    let error = match read_source(Cursor::new(data.to_vec()), path, LIMITS) {
        Ok(mut source) => {
            let info = source.info();
            assert!(info.height <= MAX_SOURCE_HEIGHT && info.width <= 2 * MAX_SOURCE_HEIGHT + 1);
            assert!(info.width.abs_diff(2 * info.height) <= 1);
            let mut row = vec![0; info.row_bytes()];
            let rows = (MOST_ROWS_BYTES / row.len()).clamp(1, info.height as usize);
            (0..rows).find_map(|_| source.next_row(&mut row).err())
        }
        Err(error) => Some(error),
    };
    if let Some(error) = error {
        let said = error.to_string();
        assert!(said.starts_with("map.x: "), "{said}");
        assert!(said.len() < 4000, "{said}");
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    let files: [&[u8]; 19] = [
        include_bytes!("../../tests/data/maps/baseline.jpg"),
        include_bytes!("../../tests/data/maps/progressive.jpg"),
        include_bytes!("../../tests/data/maps/grey16.png"),
        include_bytes!("../../tests/data/maps/interlaced.png"),
        include_bytes!("../../tests/data/maps/palette.png"),
        include_bytes!("../../tests/data/maps/big.tif"),
        include_bytes!("../../tests/data/maps/planar.tif"),
        include_bytes!("../../tests/data/maps/tiled_deflate.tif"),
        include_bytes!("../../tests/data/maps/tiled_lzw.tif"),
        include_bytes!("../../tests/data/maps/restarts.jpg"),
        include_bytes!("../../tests/data/maps/palette.tif"),
        include_bytes!("../../tests/data/maps/sparse.tif"),
        include_bytes!("../../tests/data/maps/mask.tif"),
        include_bytes!("../../tests/data/maps/no_data_16.tif"),
        include_bytes!("../../tests/data/gdal/jpeg_mask.tif"),
        include_bytes!("../../tests/data/gdal/webp_rgba.tif"),
        include_bytes!("../../tests/data/gdal/zstd_planar.tif"),
        include_bytes!("../../tests/data/gdal/lerc_u8.tif"),
        include_bytes!("../../tests/data/gdal/palette_2.tif"),
    ];
    files.map(<[u8]>::to_vec).to_vec()
}
