//! Virtual rasters, compared with GDAL's output for them.

use super::*;

fn gdal() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/gdal")
}

/// A virtual raster beside the files of tests/data/gdal that it names.
fn changed(from: &str, to: &str) -> Result<Mosaic, String> {
    let folder = Folder::new();
    let text = fs::read_to_string(gdal().join("map.vrt")).expect("a file");
    let other = text.replace(from, to);
    assert_ne!(other, text, "{from}");
    folder.put("map.vrt", other.as_bytes());
    let map = fs::read(gdal().join("webp_rgb.tif")).expect("a file");
    folder.put("webp_rgb.tif", &map);
    Mosaic::open(&folder.0.path().join("map.vrt"), None, LIMITS).map_err(|error| error.to_string())
}

#[test]
fn windows_of_files_lie_where_gdal_puts_them() {
    let mosaic = Mosaic::open(&gdal().join("map.vrt"), None, LIMITS).expect("a mosaic");
    assert_eq!((mosaic.info().width, mosaic.info().height), (72, 36));
    let (map, notes) = read(&mosaic);
    assert!(notes.is_empty(), "{notes:?}");
    let text = fs::read_to_string(gdal().join("expected.txt")).expect("a file");
    let lines = text
        .lines()
        .filter_map(|line| line.strip_prefix("map.vrt "));
    let places = lines.map(|line| {
        let numbers = line.split(' ').map(|n| n.parse().expect("a number"));
        let [x, y, r, g, b] = numbers.collect::<Vec<u32>>()[..] else {
            panic!("{line}");
        };
        assert_eq!(map.at(x, y).map(u32::from), [r, g, b], "{line}");
    });
    assert_eq!(places.count(), 50);
}

#[test]
fn what_a_virtual_raster_does_beside_placing_is_rejected() {
    for (from, to, words) in [
        (
            "<SourceBand>3",
            "<SourceBand>1",
            "puts the bands into another order than",
        ),
        (
            "xSize=\"36\" ySize=\"36\"",
            "xSize=\"99\" ySize=\"36\"",
            "fewer than the .vrt takes",
        ),
        (
            "SrcRect xOff=\"20\"",
            "SrcRect xOff=\"0.5\"",
            "takes parts of texels",
        ),
        (
            "<SRS>EPSG:4326",
            "<SRS>LOCAL_CS[\"a\"]",
            "names the coordinate system",
        ),
        ("-180, 5, 0, 90", "-180, 50, 0, 90", "webp_rgb.tif"),
        ("webp_rgb", "none", "none.tif"),
        ("webp_rgb.tif", "map.vrt", "another virtual raster"),
        (
            "<SourceBand>2",
            "<ScaleOffset>1</ScaleOffset><SourceBand>2",
            "scales",
        ),
    ] {
        let error = changed(from, to)
            .err()
            .unwrap_or_else(|| panic!("{to} is accepted"));
        assert!(error.contains(words), "{to}: {error}");
    }
}
