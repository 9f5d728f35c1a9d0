//! Mosaics of small maps: positions, layering and errors.

mod nothing;
mod places;
mod virtual_rasters;

use super::*;
use std::fs;
use std::path::Path;

const LIMITS: SourceLimits = SourceLimits {
    buffer_bytes: 32 << 20,
};

fn png(width: u32, height: u32, colour: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
    let texels: Vec<u8> = (0..width * height)
        .flat_map(|n| colour(n % width, n / width))
        .collect();
    encoded(width, height, ::png::ColorType::Rgb, &texels)
}

fn encoded(width: u32, height: u32, kind: ::png::ColorType, texels: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut file, width, height);
    encoder.set_color(kind);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(texels))
        .expect("written");
    file
}

/// Another colour for each texel of a map 64 wide.
fn code(x: u32, y: u32) -> [u8; 3] {
    [(4 * x) as u8, (8 * y) as u8, (x * y % 251) as u8]
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn put(&self, name: &str, contents: &[u8]) {
        let path = self.0.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(path, contents).expect("written");
    }

    fn open(&self, text: &str) -> Result<Mosaic, BuildError> {
        self.put("m.toml", text.as_bytes());
        Mosaic::open(&self.0.path().join("m.toml"), None, LIMITS)
    }

    /// All texels, and the warnings.
    fn read(&self, text: &str) -> (Map, Vec<String>) {
        let mosaic = self.open(text).expect(text);
        read(&mosaic)
    }
}

struct Map {
    width: u32,
    texels: Vec<u8>,
}

impl Map {
    fn at(&self, x: u32, y: u32) -> [u8; 3] {
        let n = 3 * (y * self.width + x) as usize;
        [self.texels[n], self.texels[n + 1], self.texels[n + 2]]
    }
}

fn read(mosaic: &Mosaic) -> (Map, Vec<String>) {
    let info = mosaic.info();
    let mut rows = mosaic.rows(LIMITS);
    let mut texels = vec![0; info.row_bytes() * info.height as usize];
    for row in texels.chunks_exact_mut(info.row_bytes()) {
        rows.next_row(row).expect("a row");
    }
    let notes = mosaic.notes().iter().cloned().chain(rows.notes()).collect();
    (
        Map {
            width: info.width,
            texels,
        },
        notes,
    )
}

fn part(file: &str, bounds: &str, more: &str) -> String {
    format!("[[part]]\nfile = \"{file}\"\nbounds_deg = [{bounds}]\n{more}\n")
}

const EARTH: &str = "-180, -90, 180, 90";

#[test]
fn a_whole_map_comes_through_byte_for_byte() {
    let folder = Folder::new();
    folder.put("a.png", &png(64, 32, code));
    let (map, notes) = folder.read(&part("a.png", EARTH, ""));
    assert_eq!((map.width, notes.len()), (64, 0));
    assert!((0..32).all(|y| (0..64).all(|x| map.at(x, y) == code(x, y))));
    // Half a turn on.
    let (map, _) = folder.read(&part("a.png", "0, -90, 360, 90", ""));
    assert!((0..32).all(|y| (0..64).all(|x| map.at((x + 32) % 64, y) == code(x, y))));
}

#[test]
fn eight_parts_with_nasa_s_names_are_one_map() {
    let folder = Folder::new();
    for (column, letter) in ['A', 'B', 'C', 'D'].into_iter().enumerate() {
        for row in 0..2 {
            let corner = (16 * column as u32, 16 * row);
            let tile = png(16, 16, |x, y| code(corner.0 + x, corner.1 + y));
            folder.put(&format!("nasa/world.200408.{letter}{}.png", row + 1), &tile);
        }
    }
    let mosaic =
        Mosaic::open(&folder.0.path().join("nasa"), None, LIMITS).expect("a folder of maps");
    let (map, notes) = read(&mosaic);
    assert_eq!((map.width, notes.len()), (64, 0));
    assert!((0..32).all(|y| (0..64).all(|x| map.at(x, y) == code(x, y))));
    // A part less, and one that broke.
    fs::remove_file(folder.0.path().join("nasa/world.200408.C1.png")).expect("removed");
    let path = folder.0.path().join("nasa/world.200408.A2.png");
    let whole = fs::read(&path).expect("a file");
    fs::write(&path, &whole[..whole.len() / 2]).expect("written");
    let (map, notes) =
        read(&Mosaic::open(&folder.0.path().join("nasa"), None, LIMITS).expect("a mosaic"));
    assert_eq!(
        (map.at(40, 3), map.at(60, 3), map.at(2, 31)),
        ([0; 3], code(60, 3), [0; 3])
    );
    assert!(
        notes
            .iter()
            .any(|note| note.contains("A2.png") && note.contains("left out")),
        "{notes:?}"
    );
    assert!(
        notes
            .iter()
            .any(|note| note.contains("% of the map lie in no part")),
        "{notes:?}"
    );
}

#[test]
fn insets_lie_over_coarser_ground_with_soft_borders() {
    let folder = Folder::new();
    folder.put("ground.png", &png(64, 32, |_, _| [50, 60, 70]));
    folder.put("fine.png", &png(64, 64, |_, _| [200, 190, 180]));
    let inset = "20, -20, 60, 20";
    let ground = part("ground.png", EARTH, "");
    let (map, notes) =
        folder.read(&(ground.clone() + &part("fine.png", inset, "feather_deg = 10")));
    assert_eq!(notes, [""; 0]);
    // As fine as the inset: 40 degrees are 64 texels.
    assert_eq!(map.width, 576);
    let at =
        |lon: f64, lat: f64| map.at(((lon + 180.0) * 1.6) as u32, ((90.0 - lat) * 1.6) as u32)[0];
    assert_eq!((at(0.0, 0.0), at(40.0, 0.0), at(40.0, 30.0)), (50, 200, 50));
    // Light grows evenly from the edge inwards.
    let codes: Vec<u8> = (0..=10).map(|n| at(20.2 + f64::from(n), 0.0)).collect();
    assert!(codes.windows(2).all(|pair| pair[0] < pair[1]), "{codes:?}");
    assert!(codes[0] < 75 && codes[10] == 200, "{codes:?}");
    // The border ends sharply without a feather, and alone it does not fade into nothing.
    let (sharp, _) = folder.read(&(ground + &part("fine.png", inset, "")));
    assert_eq!((sharp.at(319, 144)[0], sharp.at(320, 144)[0]), (50, 200));
    let (alone, notes) = folder.read(&part("fine.png", inset, "feather_deg = 10"));
    assert_eq!(
        (alone.at(319, 144), alone.at(320, 144)),
        ([0; 3], [200, 190, 180])
    );
    assert!(notes[0].contains("97.5"), "{notes:?}");
}

#[test]
fn colours_are_matched_where_that_is_asked_for() {
    let folder = Folder::new();
    folder.put("ground.png", &png(64, 32, |_, _| [100, 120, 140]));
    folder.put(
        "fine.png",
        &png(64, 64, |x, _| {
            if x % 2 == 0 {
                [150, 90, 140]
            } else {
                [160, 80, 140]
            }
        }),
    );
    let text =
        part("ground.png", EARTH, "") + &part("fine.png", "20, -20, 60, 20", "match_colour = true");
    let (map, notes) = folder.read(&text);
    assert!(
        notes[0].contains("light times 0.") && notes[0].contains("1.000"),
        "{notes:?}"
    );
    let (a, b) = (map.at(352, 144), map.at(353, 144));
    let mean = |channel: usize| (u32::from(a[channel]) + u32::from(b[channel])) / 2;
    assert!(
        mean(0).abs_diff(100) <= 1 && mean(1).abs_diff(120) <= 1 && mean(2) == 140,
        "{a:?} {b:?}"
    );
    let (_, notes) = folder.read(&part("fine.png", "20, -20, 60, 20", "match_colour = true"));
    assert!(notes[0].contains("nothing below it"), "{notes:?}");
}

#[test]
fn parts_cross_the_date_line_and_have_holes() {
    let folder = Folder::new();
    folder.put("a.png", &png(16, 16, |x, _| [100 + x as u8; 3]));
    let (map, _) = folder.read(
        &("width = 64\nfill = [9, 8, 7]\n".to_string() + &part("a.png", "135, -45, -135, 45", "")),
    );
    assert_eq!((map.at(56, 16), map.at(63, 16)), ([100; 3], [107; 3]));
    assert_eq!(
        (map.at(0, 16), map.at(7, 16), map.at(8, 16)),
        ([108; 3], [115; 3], [9, 8, 7])
    );
    // A colour that marks missing data, and alpha.
    let texels: Vec<u8> = (0..64 * 32)
        .flat_map(|n| [200, 200, 200, if n % 64 < 32 { 255 } else { 0 }])
        .collect();
    folder.put(
        "alpha.png",
        &encoded(64, 32, ::png::ColorType::Rgba, &texels),
    );
    folder.put(
        "dark.png",
        &png(64, 32, |_, y| if y < 16 { [0; 3] } else { [30; 3] }),
    );
    let text = part("alpha.png", EARTH, "") + &part("dark.png", EARTH, "no_data = [0]");
    let (map, notes) = folder.read(&text);
    assert_eq!(
        (map.at(1, 1), map.at(40, 1), map.at(40, 20)),
        ([200; 3], [0; 3], [30; 3])
    );
    assert!(notes[0].contains("25.00 %"), "{notes:?}");
}

#[test]
fn web_mercator_is_laid_on_latitudes() {
    let folder = Folder::new();
    // Each row has the code of its own latitude.
    let crs = Crs::WebMercator;
    let latitude = |row: u32| crs.latitude_deg(180.0 - (f64::from(row) + 0.5) * 360.0 / 512.0);
    let shade = |latitude_deg: f64| (latitude_deg + 100.0).round() as u8;
    for tile in 0..4 {
        let place = (tile / 2, tile % 2);
        folder.put(
            &format!("t/{}/{}.png", place.0, place.1),
            &png(256, 256, |_, y| [shade(latitude(256 * place.0 + y)); 3]),
        );
    }
    let tiles = "[[part]]\ntiles = \"t/{row}/{column}.png\"\ntile_size = 256\ntile_deg = 180\ncrs = \"EPSG:3857\"\n";
    let (map, notes) = folder.read(tiles);
    assert_eq!(map.width, 512);
    for row in 8..248 {
        let expected = shade(90.0 - (f64::from(row) + 0.5) * 180.0 / 256.0);
        let found = map.at(100, row)[1];
        assert!(
            found.abs_diff(expected) <= 1,
            "row {row}: {found}, {expected}"
        );
    }
    // Beyond its end there is nothing: 4.95 of 90 degrees.
    assert_eq!(map.at(100, 0), [0; 3]);
    assert!(notes[0].starts_with("5.4"), "{notes:?}");
    // A tile that is gone and one that is something else are named.
    fs::remove_file(folder.0.path().join("t/0/1.png")).expect("removed");
    folder.put("t/1/0.png", b"\x89PNG\r\n\x1a\nrubbish");
    let (map, notes) = folder.read(tiles);
    let reported = notes.join("\n");
    assert!(
        reported.contains("1 tiles are not there") && reported.contains("1 tiles are damaged"),
        "{reported}"
    );
    assert_eq!(
        (map.at(300, 100), map.at(100, 100)[0] > 0, map.at(100, 200)),
        ([0; 3], true, [0; 3])
    );
}

#[test]
fn tiles_that_reach_beyond_the_earth_are_cut_there() {
    // As level 1 of GIBS: three columns of 144 degrees, two rows; what is beyond is black.
    let folder = Folder::new();
    for (row, column) in (0..2).flat_map(|row| (0..3).map(move |column| (row, column))) {
        let tile = png(16, 16, |x, y| {
            let is_earth = column * 16 + x < 40 && row * 16 + y < 20;
            if is_earth {
                [10 + 5 * (column * 16 + x) as u8; 3]
            } else {
                [0; 3]
            }
        });
        folder.put(&format!("t/{row}/{column}.png"), &tile);
    }
    let tiles = "[[part]]\ntiles = \"t/{row}/{column}.png\"\ntile_size = 16\ntile_deg = 144\n";
    let (map, notes) = folder.read(tiles);
    assert_eq!((map.width, notes.len()), (40, 0));
    assert!((0..20).all(|y| (0..40).all(|x| map.at(x, y) == [10 + 5 * x as u8; 3])));
}

#[test]
fn what_cannot_be_a_mosaic_is_named() {
    let folder = Folder::new();
    folder.put("a.png", &png(64, 32, code));
    folder.put("grey16.png", &{
        let mut file = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut file, 2, 1);
        encoder.set_depth(::png::BitDepth::Sixteen);
        encoder.set_color(::png::ColorType::Grayscale);
        encoder
            .write_header()
            .and_then(|mut writer| writer.write_image_data(&[0; 4]))
            .expect("written");
        file
    });
    folder.put("turned.png", &png(4, 4, code));
    folder.put("turned.pgw", b"1\n0.2\n0.2\n-1\n0\n0\n");
    folder.put("beyond.png", &png(4, 4, code));
    folder.put("beyond.wld", b"90\n0\n0\n-90\n0\n0\n");
    let earth = part("a.png", EARTH, "");
    for (text, words) in [
        (
            "[[part]]\nfile = \"a.png\"\n".to_string(),
            "has no georeference",
        ),
        (part("gone.png", EARTH, ""), "gone.png"),
        (
            "[[part]]\nfile = \"turned.png\"\n".to_string(),
            "turns its map",
        ),
        (
            "[[part]]\nfile = \"beyond.png\"\n".to_string(),
            "not on the Earth",
        ),
        (
            earth.clone() + &part("grey16.png", EARTH, ""),
            "another kind",
        ),
        (part("m.toml", EARTH, ""), "neither PNG nor JPEG nor TIFF"),
        (format!("width = 30\n{earth}"), "width of 30"),
        (format!("width = 10000000\n{earth}"), "width of 10000000"),
        (
            part("a.png", EARTH, "encoding = \"terrarium\"") + &earth,
            "another kind",
        ),
        (
            "[[part]]\ntiles = \"x/{row}/{column}\"\ntile_size = 16\ntile_deg = 90\n".to_string(),
            "none of the 8 tiles",
        ),
    ] {
        let said = folder.open(&text).expect_err(&text).to_string();
        assert!(said.contains(words), "{words}: {said}");
    }
    let tight = SourceLimits { buffer_bytes: 1000 };
    folder.put("m.toml", earth.as_bytes());
    let error =
        Mosaic::open(&folder.0.path().join("m.toml"), None, tight).expect_err("little memory");
    assert!(error.to_string().contains("MB of memory"), "{error}");
    let empty = Folder::new();
    let error = Mosaic::open(Path::new(empty.0.path()), None, LIMITS).expect_err("no maps");
    assert!(error.to_string().contains("holds 0 maps"), "{error}");
}
