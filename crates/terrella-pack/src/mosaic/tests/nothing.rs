//! Texels that mark missing data show the map beneath; alpha of scalar maps is the presence of a value.

use super::*;

const BELOW: [u8; 3] = [20, 40, 200];

/// A file of `tests/data/maps` over a map of one colour.
fn over(name: &str) -> Map {
    let folder = Folder::new();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/maps");
    folder.put("a.tif", &fs::read(path.join(name)).expect("a map"));
    folder.put("below.png", &png(64, 32, |_, _| BELOW));
    folder.put("below.pgw", b"5.625\n0\n0\n-5.625\n-177.1875\n87.1875\n");
    let text = "[[part]]\nfile = \"below.png\"\n[[part]]\nfile = \"a.tif\"\n";
    let (map, notes) = folder.read(text);
    assert_eq!(notes, [""; 0]);
    map
}

/// The files were written by GDAL from this formula.
fn formula(x: u32, y: u32) -> [u8; 3] {
    [(x * 4) as u8, (y * 8) as u8, (x * y % 256) as u8]
}

#[test]
fn the_map_below_is_seen_through_masks_and_tiles_that_are_not_there() {
    let masked = over("mask.tif");
    let sparse = over("sparse.tif");
    for (x, y) in (0..32).flat_map(|y| (0..64).map(move |x| (x, y))) {
        let of = |is_there: bool| if is_there { formula(x, y) } else { BELOW };
        assert_eq!(masked.at(x, y), of(!(x + y).is_multiple_of(3)), "{x} {y}");
        let is_written = matches!((x / 16, y / 16), (1, 0) | (3, 1));
        assert_eq!(sparse.at(x, y), of(is_written), "{x} {y}");
    }
}

#[test]
fn a_colour_is_nothing_in_all_its_channels_alone() {
    let folder = Folder::new();
    folder.put(
        "a.png",
        &png(64, 32, |x, _| if x < 32 { [0; 3] } else { [0, 90, 0] }),
    );
    folder.put("below.png", &png(64, 32, |_, _| BELOW));
    let text = part("below.png", EARTH, "") + &part("a.png", EARTH, "no_data = [0]");
    let (map, _) = folder.read(&text);
    assert_eq!((map.at(3, 3), map.at(40, 3)), (BELOW, [0, 90, 0]));
}

#[test]
fn alpha_of_amounts_is_how_much_there_is() {
    let folder = Folder::new();
    // White with the cover in alpha, twice as fine as the mosaic: texels of no cover count.
    let texels: Vec<u8> = (0..128 * 64)
        .flat_map(|n| [255, if n % 2 == 0 { 200 } else { 0 }])
        .collect();
    folder.put(
        "a.png",
        &encoded(128, 64, ::png::ColorType::GrayscaleAlpha, &texels),
    );
    folder.put(
        "m.toml",
        ("width = 64\n".to_string() + &part("a.png", EARTH, "")).as_bytes(),
    );
    let path = folder.0.path().join("m.toml");
    let description = Description::read(&path).expect("good").of_amounts();
    let mosaic = Mosaic::of(description, &path, None, LIMITS).expect("good");
    let (map, notes) = read(&mosaic);
    assert_eq!(notes, [""; 0]);
    assert!(
        map.texels.iter().all(|cover| *cover == 100),
        "{:?}",
        &map.texels[..8]
    );
}

#[test]
fn masks_and_numbers_beside_a_map_take_texels_away() {
    let mut mask = std::io::Cursor::new(Vec::new());
    let bytes: Vec<u8> = (0..64 * 32)
        .map(|n| if n / 64 < 16 { 0 } else { 255 })
        .collect();
    ::tiff::encoder::TiffEncoder::new(&mut mask)
        .and_then(|mut file| file.write_image::<::tiff::encoder::colortype::Gray8>(64, 32, &bytes))
        .expect("written");
    let bands = "<PAMRasterBand><NoDataValue>9</NoDataValue></PAMRasterBand>".repeat(3);
    let below = || {
        let folder = Folder::new();
        folder.put(
            "a.png",
            &png(64, 32, |x, _| if x < 32 { [9; 3] } else { [9, 90, 9] }),
        );
        folder.put("below.png", &png(64, 32, |_, _| BELOW));
        folder
    };
    let text = part("below.png", EARTH, "") + &part("a.png", EARTH, "");
    let (plain, _) = below().read(&text);
    assert_eq!((plain.at(3, 3), plain.at(40, 3)), ([9; 3], [9, 90, 9]));
    let folder = below();
    folder.put("a.png.msk", mask.get_ref());
    let (map, _) = folder.read(&text);
    assert_eq!((map.at(3, 15), map.at(40, 15)), (BELOW, BELOW));
    assert_eq!((map.at(3, 16), map.at(40, 16)), ([9; 3], [9, 90, 9]));
    let folder = below();
    folder.put("a.png.aux.xml", bands.as_bytes());
    let (map, _) = folder.read(&text);
    assert_eq!((map.at(3, 3), map.at(40, 3)), (BELOW, [9, 90, 9]));

    for (ending, contents, words) in [
        (".msk", &mask.get_ref()[..40], "a.png.msk: "),
        (
            ".aux.xml",
            bands.replace('9', "x").as_bytes(),
            "a.png.aux.xml: has the NoDataValue \"x\"",
        ),
        (
            ".aux.xml",
            &bands.as_bytes()[..60],
            "names 1 numbers for nothing",
        ),
    ] {
        let folder = below();
        folder.put(&format!("a.png{ending}"), contents);
        match folder.open(&text) {
            Err(error) => assert!(error.to_string().contains(words), "{error}"),
            // A damaged part is left out and reported.
            Ok(mosaic) => assert!(mosaic.notes()[0].contains(words), "{:?}", mosaic.notes()),
        }
    }
}
