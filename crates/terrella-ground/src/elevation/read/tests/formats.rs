//! SRTM's `.hgt`, ASCII grids, DTED, and GeoTIFF with GDAL's compressions.

use super::*;
use std::io::Write;

/// Heights of an `.hgt` file of 3″: a plane, with a void, by row from the north and column from the west.
fn height(row: usize, column: usize) -> i16 {
    match (row, column) {
        (100..102, 200..203) => -32_768,
        // Integer values.
        _ => (2 * column) as i16 - (row / 2) as i16 + 700,
    }
}

fn hgt() -> Vec<u8> {
    let all = (0..1201).flat_map(|row| (0..1201).map(move |column| height(row, column)));
    all.flat_map(i16::to_be_bytes).collect()
}

/// A zip file with one deflated file, and another beside it that is ignored.
fn zipped(name: &str, bytes: &[u8]) -> Vec<u8> {
    let mut deflated = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::fast());
    deflated.write_all(bytes).expect("written");
    let deflated = deflated.finish().expect("written");
    let mut crc = flate2::Crc::new();
    crc.update(bytes);
    let (mut file, mut list) = (Vec::new(), Vec::new());
    let entries = [
        ("read.me", 0_u16, b"hello".as_slice(), 5, 0),
        (name, 8, deflated.as_slice(), bytes.len(), crc.sum()),
    ];
    for (name, method, packed, size, crc) in entries {
        let start = file.len() as u32;
        let mut common = Vec::new();
        for short in [20_u16, 0, method, 0, 0] {
            common.extend(short.to_le_bytes());
        }
        for word in [crc, packed.len() as u32, size as u32] {
            common.extend(word.to_le_bytes());
        }
        common.extend((name.len() as u16).to_le_bytes());
        common.extend([0, 0]);
        file.extend(b"PK\x03\x04");
        file.extend(&common);
        file.extend(name.as_bytes());
        file.extend(packed);
        list.extend(b"PK\x01\x02\x14\0");
        list.extend(&common);
        list.extend([0; 10]);
        list.extend(start.to_le_bytes());
        list.extend(name.as_bytes());
    }
    let start = file.len() as u32;
    file.extend(&list);
    file.extend(b"PK\x05\x06\0\0\0\0\x02\0\x02\0");
    file.extend((list.len() as u32).to_le_bytes());
    file.extend(start.to_le_bytes());
    file.extend([0, 0]);
    file
}

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut file = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    file.write_all(bytes).expect("written");
    file.finish().expect("written")
}

fn read_as(name: &str, bytes: Vec<u8>, sidecar: &str) -> Result<HeightFile, HeightFileError> {
    let sidecar = (!sidecar.is_empty())
        .then(|| Sidecar::from_toml(sidecar, Path::new("dem.toml")))
        .transpose()?;
    read_heights(
        Cursor::new(bytes),
        sidecar.as_ref(),
        Path::new(name),
        &GridLimits::default(),
    )
}

#[track_caller]
fn rejected(name: &str, bytes: Vec<u8>, words: &str) {
    let said = read_as(name, bytes, "").expect_err(words).to_string();
    assert!(said.starts_with(name) && said.contains(words), "{said}");
}

fn at(file: &HeightFile, lat_deg: f64, lon_deg: f64) -> f64 {
    file.grid
        .height_m(lat_deg.to_radians(), lon_deg.to_radians(), 0.0)
}

#[test]
fn hgt_lies_where_its_name_says() {
    for (name, bytes, south, west) in [
        ("N45E006.hgt", hgt(), 45.0, 6.0),
        ("maps/s07w123.SRTMGL3.HGT", hgt(), -7.0, -123.0),
        ("N00E179.hgt.gz", gzipped(&hgt()), 0.0, 179.0),
        ("N45E006.zip", zipped("a/S01E010.hgt", &hgt()), -1.0, 10.0),
        (
            "N46E006.SRTMGL3.hgt.zip",
            zipped("tile.hgt", &hgt()),
            46.0,
            6.0,
        ),
    ] {
        let file = read_as(name, bytes, "").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(file.grid.stats().holes, 6, "{name}");
        for (row, column) in [(0, 0), (0, 1200), (1200, 0), (1200, 1200), (640, 17)] {
            let got = at(
                &file,
                south + 1.0 - row as f64 / 1200.0,
                west + column as f64 / 1200.0,
            );
            let right = f64::from(height(row, column));
            assert!(
                (got - right).abs() < 1e-3,
                "{name} {row} {column}: {got} for {right}"
            );
        }
        let bounds = file.grid.bounds();
        assert!((bounds.south_rad - south.to_radians()).abs() < 1e-12);
        assert!((bounds.width_rad - 1f64.to_radians()).abs() < 1e-12);
    }
    // If the name states no position, the sidecar does.
    let place = "bounds = { south_deg = 1, north_deg = 2, west_deg = 3, east_deg = 4 }\nregistration = \"posts\"";
    let file = read_as("tile.hgt", hgt(), place).expect("good");
    assert!((at(&file, 2.0, 3.0) - 700.0).abs() < 1e-3);
}

#[test]
fn hgt_that_is_none_is_rejected() {
    rejected("tile.hgt", hgt(), "has no bounds");
    rejected("N90E000.hgt", hgt(), "has no bounds");
    rejected(
        "N45E006.hgt",
        hgt()[2..].to_vec(),
        "has 2884800 bytes of heights",
    );
    rejected(
        "N45E006.hgt.gz",
        gzipped(&hgt()[2..]),
        "has 2884800 bytes of heights",
    );
    let mut broken = gzipped(&hgt());
    let middle = broken.len() / 2;
    broken[middle] ^= 0xFF;
    rejected("N45E006.hgt.gz", broken, "truncated or damaged");
    let whole = zipped("N45E006.hgt", &hgt());
    let mut wrong = whole.clone();
    let list = whole
        .windows(4)
        .rposition(|mark| mark == b"PK\x01\x02")
        .expect("a list");
    wrong[list + 16] ^= 1;
    rejected("a.zip", wrong, "the checksum of its heights is wrong");
    let mut locked = whole.clone();
    locked[list + 8] |= 1;
    rejected("a.zip", locked, "without a password");
    rejected(
        "a.zip",
        whole[..whole.len() - 30].to_vec(),
        "the zip file has no end",
    );
    rejected(
        "a.zip",
        zipped("a.tif", b"II*\0"),
        "without a file whose name ends in .hgt",
    );
    for cut in [4, 20, 50, whole.len() - 22] {
        read_as("a.zip", whole[whole.len() - cut..].to_vec(), "").expect_err("cut");
        read_as(
            "a.zip",
            [b"PK\x03\x04", &whole[whole.len() - cut..]].concat(),
            "",
        )
        .expect_err("cut");
    }
}

const GRID: &str = "ncols 6\nnrows 4\nxllcorner 10\nyllcorner 46\ncellsize 1\nNODATA_value -1\n";

fn numbers() -> String {
    let rows = (0..4).map(|row| (0..6).map(move |column| format!("{}", 100 * (6 * row + column))));
    let rows: Vec<_> = rows.map(|row| row.collect::<Vec<_>>().join(" ")).collect();
    rows.join("\r\n")
}

#[test]
fn ascii_grids_are_read() {
    let right = |lat: f64, lon: f64| 100.0 * ((49.5 - lat) * 6.0 + lon - 10.5);
    let centre = GRID
        .replace("xllcorner 10", "XLLCENTER 10.5")
        .replace("yllcorner 46", "yllcenter 46.5");
    let two = GRID.replace("cellsize 1", "dx 1.0\ndy 1");
    let marked = format!("\u{feff}{GRID}");
    for head in [GRID, &centre, &two, &marked] {
        let file = read_as(
            "g.asc",
            (head.to_owned() + &numbers()).into_bytes(),
            "unit = \"metres\"",
        );
        holds(
            &file.unwrap_or_else(|error| panic!("{error}")),
            NORTH_WEST,
            1.0,
            (6, 4),
            right,
        );
    }
    // One number per line; −9999 means no data unless declared otherwise.
    let text = GRID.replace("NODATA_value -1\n", "")
        + &numbers()
            .replace([' ', '\r'], "\n")
            .replace("\n100\n", "\n-9999\n");
    let file = read_as("g.asc", text.into_bytes(), "unit = \"feet\"").expect("good");
    assert_eq!((file.grid.stats().holes, file.undeclared), (1, 0));
    assert!((at(&file, 46.5, 15.5) - 2300.0 * 0.3048).abs() < 1e-3);

    let with = |from: &str, to: &str| {
        (GRID.to_owned() + &numbers())
            .replace(from, to)
            .into_bytes()
    };
    rejected("g.asc", with("nrows 4\n", ""), "has no nrows in its header");
    rejected(
        "g.asc",
        with("cellsize 1", "cellsize 0"),
        "has cells of 0 x 0",
    );
    rejected(
        "g.asc",
        with("cellsize 1", "cellsize 1,0"),
        "line 5: \"1,0\" is no number",
    );
    rejected(
        "g.asc",
        with("ncols 6", "ncols 6e9"),
        "4294967295 x 4 samples",
    );
    rejected(
        "g.asc",
        with("xllcorner 10", "xllcorner 500000"),
        "no degrees",
    );
    rejected(
        "g.asc",
        with("NODATA_value", "colour"),
        "line 6: \"colour\" is neither a key",
    );
    rejected(
        "g.asc",
        with("", ""),
        "does not state the unit of its elevations",
    );
    let said = |bytes| {
        read_as("g.asc", bytes, "unit = \"metres\"")
            .expect_err("rejected")
            .to_string()
    };
    assert!(said(with("2300", "")).contains("it ends in row 4 of 4"));
    assert!(said(with("2300", "2300 1")).contains("line 10: more heights"));
    assert!(said(with("1100", "11,5")).contains("line 8: \"11,5\" is no number"));
}

/// DTED of 1° by 1° with 31 columns and 61 rows.
fn dted() -> Vec<u8> {
    let mut file = format!(
        "{:<80}",
        "UHL10060000E0450000S12000600NA  U              003100610"
    )
    .into_bytes();
    let mut description = vec![b' '; 648];
    description[..3].copy_from_slice(b"DSI");
    description[141..149].copy_from_slice(b"E96WGS84");
    file.extend(description);
    file.extend([b' '; 2700]);
    for column in 0..31_u16 {
        let mut record = vec![0xAA, 0, 0, column as u8];
        record.extend(column.to_be_bytes());
        record.extend([0, 0]);
        for row in 0..61_u16 {
            let height = 10 * i32::from(row) - 300 + i32::from(column);
            let magnitude = height.unsigned_abs() as u16;
            let bits = if (column, row) == (5, 5) {
                0xFFFF
            } else {
                magnitude | if height < 0 { 0x8000 } else { 0 }
            };
            record.extend(bits.to_be_bytes());
        }
        let sum: u32 = record.iter().map(|byte| u32::from(*byte)).sum();
        record.extend(sum.to_be_bytes());
        file.extend(record);
    }
    file
}

#[test]
fn dted_is_read() {
    let labelled = [[b'V', b'O', b'L', b'1'].as_slice(), &[b' '; 76], &dted()].concat();
    for bytes in [dted(), labelled] {
        let file = read_as("s45.dt0", bytes, "").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((file.grid.size(), file.grid.stats().holes), ((31, 61), 1));
        for (row, column) in [(0, 0), (0, 30), (60, 0), (60, 30), (17, 4)] {
            let got = at(
                &file,
                -45.0 + f64::from(row) / 60.0,
                6.0 + f64::from(column) / 30.0,
            );
            let right = 10.0 * f64::from(row) - 300.0 + f64::from(column);
            assert!(
                (got - right).abs() < 1e-3,
                "{row} {column}: {got} for {right}"
            );
        }
    }
    let with = |at: usize, bytes: &[u8]| {
        let mut file = dted();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        file
    };
    rejected("a.dt2", with(47, b"9001"), "is DTED of 9001 x 61 heights");
    rejected("a.dt2", with(47, b"x   "), "the number of columns \"x\"");
    rejected("a.dt2", with(4, b"0060000Q"), "the longitude \"0060000Q\"");
    rejected("a.dt2", with(80 + 144, b"NAD27"), "the datum \"NAD27\"");
    rejected(
        "a.dt2",
        with(3428 + 50, &[1]),
        "the checksum of column 0 is wrong",
    );
    rejected("a.dt2", with(3428 + 5, &[9]), "column 9");
    rejected(
        "a.dt2",
        dted()[..4000].to_vec(),
        "its columns do not end with the file",
    );
    rejected("a.dt2", dted()[..3000].to_vec(), "the file ends too early");
}

#[test]
fn an_ascii_grid_lies_in_the_system_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("g.asc");
    let text = GRID
        .replace("xllcorner 10", "xllcorner 400000")
        .replace("yllcorner 46", "yllcorner 5200000");
    let rows = |row: usize| {
        (0..24)
            .map(|column| format!("{}", 10 * column + row))
            .collect::<Vec<_>>()
            .join(" ")
    };
    let numbers: Vec<_> = (0..24).map(rows).collect();
    let text = text
        .replace("ncols 6", "ncols 24")
        .replace("nrows 4", "nrows 24")
        .replace("cellsize 1", "cellsize 100");
    std::fs::write(&path, text + &numbers.join("\n")).expect("written");
    std::fs::write(folder.path().join("folder.toml"), "unit = \"metres\"").expect("written");
    let open = || open_heights(&path, &GridLimits::default()).map_err(|error| error.to_string());
    assert!(open().is_err_and(|said| said.contains("no degrees") && said.contains(".prj")));
    let utm = "PROJCS[\"WGS 84 / UTM zone 33N\",AUTHORITY[\"EPSG\",\"32633\"]]";
    std::fs::write(folder.path().join("g.prj"), utm).expect("written");
    let file = open().expect("good");
    // The centre of the cell in row 11 and column 12, of 24 from the north.
    let projection = crate::elevation::projection::Projection::of_code(32_633).expect("known");
    let (lat_rad, lon_rad) = projection.inverse_rad(401_250.0, 5_201_250.0);
    let got = file.grid.height_m(lat_rad, lon_rad, 0.0);
    assert!((got - 131.0).abs() < 0.05, "{got}");
    std::fs::write(folder.path().join("g.prj"), "LOCAL_CS[\"here\"]").expect("written");
    assert!(open().is_err_and(|said| said.contains("g.prj: names the coordinate system \"here\"")));
}

#[test]
fn heights_of_gdal_are_read_however_they_are_compressed() {
    let folder = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/data/gdal"
    ));
    let text = std::fs::read_to_string(folder.join("expected.txt")).expect("expected.txt");
    let sidecar = Sidecar::from_toml("unit = \"metres\"", Path::new("dem.toml")).expect("good");
    let mut files = BTreeMap::new();
    let is_heights =
        |name: &str| name.ends_with(".tif") && (name.contains("16") || name.contains("_f"));
    let lines = text
        .lines()
        .filter(|line| line.split(' ').next().is_some_and(is_heights));
    for line in lines {
        let (name, numbers) = line.split_once(' ').expect("numbers");
        let numbers: Vec<f64> = numbers
            .split(' ')
            .map(|n| n.parse().expect("a number"))
            .collect();
        let file = files.entry(name).or_insert_with(|| {
            let path = folder.join(name);
            let bytes = Cursor::new(std::fs::read(&path).expect("a file"));
            let file = read_heights(bytes, Some(&sidecar), &path, &GridLimits::default());
            file.unwrap_or_else(|error| panic!("{error}")).grid
        });
        // The centre of a cell of 5 degrees.
        let (lon, lat) = (numbers[0] * 5.0 - 177.5, 87.5 - numbers[1] * 5.0);
        let got = file.height_m(lat.to_radians(), lon.to_radians(), 0.0);
        assert!(
            (got - numbers[2]).abs() < 1e-3 || numbers[2].is_nan(),
            "{line}: {got}"
        );
    }
    assert_eq!(files.len(), 11);
}

#[test]
fn the_files_of_a_virtual_raster_are_read_as_gdal_reads_it() {
    let folder = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/data/gdal"
    ));
    let text = std::fs::read_to_string(folder.join("expected.txt")).expect("expected.txt");
    let files = crate::elevation::height_set(&folder.join("heights.vrt"));
    let files = files.unwrap_or_else(|error| panic!("{error}"));
    let names: Vec<_> = files.iter().filter_map(|file| file.file_name()).collect();
    assert_eq!(names, ["part_east.tif", "part_west.tif"]);
    let open = |path: &PathBuf| {
        open_heights(path, &GridLimits::default())
            .expect("heights")
            .grid
    };
    let grids: Vec<_> = files.iter().map(open).collect();
    let mut places = 0;
    for line in text.lines().filter(|line| line.starts_with("heights.vrt")) {
        let numbers = line
            .split(' ')
            .skip(1)
            .map(|n| n.parse::<f64>().expect("a number"));
        let [column, row, right] = numbers.collect::<Vec<_>>()[..] else {
            panic!("{line}");
        };
        let (lon, lat) = (column * 5.0 - 177.5, 87.5 - row * 5.0);
        // The hole of the uppermost file is filled from that file, not from the one below.
        let file = grids
            .iter()
            .find(|grid| grid.bounds().contains(lat.to_radians(), lon.to_radians()));
        let got = file
            .expect("a file")
            .height_m(lat.to_radians(), lon.to_radians(), 0.0);
        assert!(
            (got - right).abs() < 1e-3 || right == -32_768.0,
            "{line}: {got}"
        );
        places += 1;
    }
    assert_eq!(places, 50);
}
