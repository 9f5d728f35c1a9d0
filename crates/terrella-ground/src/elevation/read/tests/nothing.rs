//! Samples without data: by an undeclared number, by the text beside a file, by a mask in a separate file.

use super::*;

/// 24 heights of 500 m, except the first, which has this value.
fn first_is(first: f32) -> Plain {
    let mut heights = [500.0_f32; 24];
    heights[0] = first;
    let bytes = heights.iter().flat_map(|height| height.to_le_bytes());
    Plain::new().samples(32, 3, bytes.collect())
}

#[test]
fn numbers_that_usually_mean_no_data_are_holes_and_reported() {
    for first in [-9999.0, -32_768.0, -32_767.0, -99_999.0, f32::MIN] {
        let file = read(first_is(first).bytes(), "").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(
            (file.undeclared, file.grid.stats().holes),
            (1, 1),
            "{first}"
        );
        assert_eq!(file.grid.stats().range.low_m, 500.0, "{first}");
    }
    // With a declared value, the other usual values are heights.
    let declared = first_is(-9999.0).with(42_113, (2, b"-32768\0".to_vec()));
    for (bytes, sidecar) in [
        (declared.bytes(), ""),
        (first_is(-9999.0).bytes(), "nodata = nan"),
        (first_is(-9998.0).bytes(), ""),
    ] {
        let file = read(bytes, sidecar).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((file.undeclared, file.grid.stats().holes), (0, 0));
        assert!(file.grid.stats().range.low_m < -9997.0);
    }
    // In feet too: the stored number counts.
    let feet = keys(&[(1024, 2), (1025, 1), (2048, 4326), (4099, 9002)]);
    let file = read(first_is(-9999.0).with(34_735, feet).bytes(), "").expect("good");
    assert_eq!(file.undeclared, 1);
}

/// A file in a folder with another file beside it.
fn beside(bytes: Vec<u8>, ending: &str, other: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dem.tif");
    std::fs::write(&path, bytes).expect("written");
    std::fs::write(folder.path().join(format!("dem.tif{ending}")), other).expect("written");
    (folder, path)
}

#[test]
fn the_text_beside_a_file_counts() {
    let keys = keys(&[(1024, 2), (1025, 1), (2048, 4326)]);
    let bare = first_is(-5000.0).with(34_735, keys);
    let text = b"<PAMDataset><PAMRasterBand band=\"1\"><NoDataValue>-5.0E+03</NoDataValue><UnitType>ft</UnitType>\
                 <Offset>100</Offset><Scale>2</Scale></PAMRasterBand></PAMDataset>";
    let (_folder, path) = beside(bare.bytes(), ".aux.xml", text);
    let file =
        open_heights(&path, &GridLimits::default()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((file.undeclared, file.grid.stats().holes), (0, 1));
    // (100 + 2 × 500) ft.
    assert!((file.grid.stats().range.low_m - 335.28).abs() < 1e-3);
    assert_eq!(height_files(&path).len(), 2);

    let rejected = |text: &[u8], words: &str| {
        let (_folder, path) = beside(first_is(0.0).bytes(), ".aux.xml", text);
        let said = open_heights(&path, &GridLimits::default())
            .expect_err(words)
            .to_string();
        assert!(said.contains(words), "{said}");
    };
    rejected(
        b"<PAMRasterBand><UnitType>ft</UnitType></PAMRasterBand>",
        "has heights in metres, but its .aux.xml says feet",
    );
    rejected(
        b"<PAMRasterBand><UnitType>fathom</UnitType></PAMRasterBand>",
        "dem.tif.aux.xml: has heights of the unit \"fathom\"",
    );
    rejected(
        b"<PAMRasterBand><NoDataValue>none</NoDataValue></PAMRasterBand>",
        "dem.tif.aux.xml: has the NoDataValue \"none\"",
    );
}

#[test]
fn a_mask_in_a_file_of_its_own_counts() {
    let mask = |bytes: &[u8]| Plain::new().samples(8, 1, bytes.to_vec()).bytes();
    let mut there = [255; 24];
    // The second row, from its third sample on.
    there[8..12].fill(0);
    let heights: Vec<u8> = (0..24_i16)
        .flat_map(|n| {
            if (8..12).contains(&n) {
                -5000_i16
            } else {
                10 * n
            }
            .to_le_bytes()
        })
        .collect();
    for is_south_first in [false, true] {
        let mut plain = Plain::new().samples(16, 2, heights.clone());
        if is_south_first {
            plain = plain
                .with(33_550, doubles(&[1.0, -1.0, 0.0]))
                .with(33_922, doubles(&[0.0, 0.0, 0.0, 10.0, 46.0, 0.0]));
        }
        let (_folder, path) = beside(plain.bytes(), ".msk", &mask(&there));
        let file =
            open_heights(&path, &GridLimits::default()).unwrap_or_else(|error| panic!("{error}"));
        let stats = file.grid.stats();
        assert_eq!(
            (stats.holes, stats.range.low_m, stats.range.high_m),
            (4, 0.0, 230.0)
        );
        assert_eq!(height_files(&path).len(), 2);
    }
    for (other, words) in [
        (mask(&there[..20]), "dem.tif.msk: truncated or damaged"),
        (b"GIF89a".to_vec(), "dem.tif.msk: "),
        (
            Plain::new()
                .with(256, shorts(&[3]))
                .samples(8, 1, there[..12].to_vec())
                .bytes(),
            "a mask of 3 x 4 pixels over an image of 6 x 4",
        ),
    ] {
        let (_folder, path) = beside(Plain::new().bytes(), ".msk", &other);
        let said = open_heights(&path, &GridLimits::default())
            .expect_err(words)
            .to_string();
        assert!(said.contains(words), "{said}");
    }
}
