//! NetCDF-4, with files from the libraries' own writers (HDF5 2.0 of h5py 3.16, 2.2 of netCDF4
//! 1.7.5).
//! All files hold the plane of the other files, south first and across the date line, 0.25° apart. `netcdf4_i16.nc` is from
//! netCDF4, packed by 0.5 and 3000, in chunks of 10 × 12 with shuffle, deflate and Fletcher's checksum. It has more attributes than
//! a header holds, and sample (16, 16) is missing. The others are from h5py, by `create_dataset(name, z.shape, kind, …)` with
//! scales attached to both dimensions:
//! missing. The others: h5py, `create_dataset(name, z.shape, kind, …)` with scales attached to both dimensions:
//!
//! | file | `libver` | chunks | |
//! |---|---|---|---|
//! | `hdf5_early_f32.nc` | earliest | 3 × 6 | gzip, shuffle: two levels of the B-tree |
//! | `hdf5_pages_i16.nc` | v110 | 1 × 1 | fixed array of two pages |
//! | `hdf5_group_i16.nc` | earliest | none | in the group `grid`, which has a hard link `back` to the root |
//! | `hdf5_layouts_i16.nc` | v110 | none, 4 × 4 (allocated early), 2 × 3, 1 × 1 (no limit of columns), 2 × 8 (no limits, gzip), 9 × 8 (gzip) | a variable each |
//!
//! `mapping.nc` (classic, a variable `crs` for WGS84) and `netcdf4_moon_i16.nc` (the same for the Moon, of characters): netCDF4, 3 × 4.
//! `netcdf4_groups_i16.nc`: netCDF4, `model/deep/z` of 5 × 6 over dimensions of the root, and `fine/z` of 3 × 4 over those of its group.

use super::*;

/// Latitude of the southernmost row, and longitude of the first column.
const SOUTH_WEST: (f64, f64) = (36.25, 178.0);
const STEP: f64 = 0.25;

/// Compares rows and columns from the south-west with the plane.
#[track_caller]
fn holds_plane(file: &HeightFile, (columns, rows): (u32, u32)) {
    let north = SOUTH_WEST.0 + f64::from(rows - 1) * STEP;
    holds(file, (north, SOUTH_WEST.1), STEP, (columns, rows), plane);
}

#[test]
fn netcdf_4_is_read() {
    let file = open("netcdf4_i16.nc");
    // Filled from its surroundings: the mean of a plane.
    assert_eq!(file.undeclared, 0);
    let (lat, lon) = (40.25_f64, 182.0_f64);
    let filled = file.grid.height_m(lat.to_radians(), lon.to_radians(), 0.0);
    assert!((filled - plane(lat, lon)).abs() < 30.0, "{filled}");
    holds_plane(&file, (32, 16));
    for name in ["hdf5_early_f32.nc", "hdf5_pages_i16.nc"] {
        holds_plane(&open(name), (32, 33));
    }
}

#[test]
fn every_layout_of_hdf5_is_read() {
    let bytes = std::fs::read(data("hdf5_layouts_i16.nc")).expect("a file");
    let names = [
        "contiguous",
        "implicit",
        "fixed",
        "extensible",
        "tree",
        "single",
    ];
    for name in names {
        let file = read(bytes.clone(), &format!("variable = {name:?}"));
        holds_plane(
            &file.unwrap_or_else(|error| panic!("{name}: {error}")),
            (8, 9),
        );
    }
    let several = said(bytes, "");
    assert!(
        several.contains("has several variables over two dimensions"),
        "{several}"
    );
}

#[test]
fn grids_in_groups_are_named_by_their_path() {
    let bytes = std::fs::read(data("netcdf4_groups_i16.nc")).expect("a file");
    for (name, size) in [
        ("model/deep/z", (6, 5)),
        ("/model/deep/z", (6, 5)),
        ("fine/z", (4, 3)),
    ] {
        let file = read(bytes.clone(), &format!("variable = {name:?}"));
        holds_plane(
            &file.unwrap_or_else(|error| panic!("{name}: {error}")),
            size,
        );
    }
    for wanted in ["", "variable = \"z\""] {
        let said = said(bytes.clone(), wanted);
        assert!(said.contains("one of: model/deep/z, fine/z"), "{said}");
    }
    // A single grid needs no name, and a cyclic link ends.
    holds_plane(&open("hdf5_group_i16.nc"), (4, 3));
}

#[test]
fn degrees_of_other_figures_are_named() {
    let good = std::fs::read(data("mapping.nc")).expect("a file");
    holds_plane(&read(good.clone(), "").expect("of WGS84"), (4, 3));
    let with = |old: &[u8], new: &[u8]| {
        let at = good.windows(old.len()).position(|bytes| bytes == old);
        let mut bytes = good.clone();
        bytes[at.expect("there")..][..new.len()].copy_from_slice(new);
        said(bytes, "")
    };
    let radius_m = 6_378_137_f64.to_be_bytes();
    let of_clarke = with(&radius_m, &6_378_206.4_f64.to_be_bytes());
    assert!(
        of_clarke.contains("an equatorial radius of 6378206.4 m"),
        "{of_clarke}"
    );
    let of_none = with(&radius_m, &f64::NAN.to_be_bytes());
    assert!(
        of_none.contains("an equatorial radius of NaN m"),
        "{of_none}"
    );
    let from_paris = with(&(-1.0e-30_f64).to_be_bytes(), &2.337_f64.to_be_bytes());
    assert!(
        from_paris.contains("a meridian at 2.337° of Greenwich's"),
        "{from_paris}"
    );
    let turned = with(b"latitude_longitude", b"rotated_latitude_l");
    assert!(
        turned.contains("the grid mapping \"rotated_latitude_l\""),
        "{turned}"
    );
    let of_moon = said(
        std::fs::read(data("netcdf4_moon_i16.nc")).expect("a file"),
        "",
    );
    assert!(
        of_moon.contains("an equatorial radius of 1737400 m"),
        "{of_moon}"
    );
}

#[test]
fn a_standard_name_says_what_heights_stand_above() {
    let named = |name| {
        let attributes = [METRES, ("standard_name", name)];
        let file = cdf5(
            [("lat", "degrees_north"), ("lon", "degrees_east")],
            &attributes,
        );
        read(file, "").expect("heights").above
    };
    let ellipsoid = named("height_above_reference_ellipsoid");
    assert_eq!(ellipsoid, Some(VerticalDatum::Ellipsoid));
    assert_eq!(named("surface_altitude"), None);
}

#[test]
fn a_standard_name_of_depths_turns_them() {
    let high_m = |name| {
        let attributes = [METRES, ("standard_name", name)];
        let file = cdf5(
            [("lat", "degrees_north"), ("lon", "degrees_east")],
            &attributes,
        );
        read(file, "").expect("heights").grid.stats().range
    };
    let (up, down) = (high_m("surface_altitude"), high_m("depth"));
    assert_eq!((up.low_m, up.high_m), (-down.high_m, -down.low_m));
}

#[test]
fn grids_of_early_gmt_are_named() {
    let said = said(std::fs::read(data("gmt_3.grd")).expect("a file"), "");
    assert!(
        said.contains("GMT before version 4.1") && said.contains("gmt grdconvert"),
        "{said}"
    );
}

#[test]
fn damaged_netcdf_4_is_reported_with_its_place() {
    let good = std::fs::read(data("hdf5_pages_i16.nc")).expect("a file");
    let after = |signature: &[u8; 4], more: usize| {
        let at = good.windows(4).position(|bytes| bytes == signature);
        let at = at.expect("there");
        let mut bytes = good.clone();
        bytes[at + more] ^= 0x10;
        (at, said(bytes, ""))
    };
    // The root group, the header of the array, its first element.
    for (signature, more) in [(b"OHDR", 10), (b"FAHD", 9), (b"FADB", 23)] {
        let (at, said) = after(signature, more);
        assert!(
            said.contains("truncated or damaged: a block with a wrong checksum at byte "),
            "{said}"
        );
        let said_at = said
            .split("at byte ")
            .nth(1)
            .and_then(|rest| rest.split(';').next());
        let said_at: usize = said_at.and_then(|at| at.parse().ok()).expect("a byte");
        assert!((at..at + 64).contains(&said_at), "{said_at} for {at}");
    }
    let cut = said(good[..good.len() - 100].to_vec(), "");
    assert!(cut.contains("a block that ends beyond the file"), "{cut}");
    let none = said(b"\x89HDF\r\n\x1a\n\x09\0\0\0\0\0\0\0".to_vec(), "");
    assert!(none.contains("truncated or damaged"), "{none}");
}

#[test]
fn filters_that_are_not_read_are_named() {
    // Changes deflate, which version 1 of the message names, to another filter.
    let mut bytes = std::fs::read(data("hdf5_early_f32.nc")).expect("a file");
    let deflate = [
        1, 0, 8, 0, 1, 0, 1, 0, b'd', b'e', b'f', b'l', b'a', b't', b'e', 0,
    ];
    let at = bytes.windows(16).position(|bytes| bytes == deflate);
    let at = at.expect("a filter");
    bytes[at] = 6;
    let said = said(bytes, "");
    assert!(
        said.contains("is compressed by the HDF5 filter 6 (scaleoffset)"),
        "{said}"
    );
    assert!(said.contains("h5repack -f GZIP=1"), "{said}");
}

/// Two rows of two 64-bit numbers in the layout of the CDF-5 specification. The arguments are names and units of both dimensions, and
/// attributes of the variable.
fn cdf5(dimensions: [(&str, &str); 2], of_variable: &[(&str, &str)]) -> Vec<u8> {
    let mut file = b"CDF\x05".to_vec();
    let text = |file: &mut Vec<u8>, text: &str| {
        file.extend((text.len() as u64).to_be_bytes());
        file.extend(text.bytes());
        file.resize(file.len().next_multiple_of(4), 0);
    };
    let list = |file: &mut Vec<u8>, tag: u32, count: usize| {
        file.extend(tag.to_be_bytes());
        file.extend((count as u64).to_be_bytes());
    };
    file.extend([0; 8]);
    list(&mut file, 10, 2);
    for (name, _) in dimensions {
        text(&mut file, name);
        file.extend(2_u64.to_be_bytes());
    }
    list(&mut file, 0, 0);
    list(&mut file, 11, 3);
    let mut begins = Vec::new();
    let [(first, of_first), (second, of_second)] = dimensions;
    for (name, dimensions, attributes) in [
        (first, &[0_u64][..], &[("units", of_first)][..]),
        (second, &[1], &[("units", of_second)]),
        ("z", &[0, 1], of_variable),
    ] {
        text(&mut file, name);
        file.extend((dimensions.len() as u64).to_be_bytes());
        dimensions.iter().for_each(|n| file.extend(n.to_be_bytes()));
        list(&mut file, 12, attributes.len());
        for (name, value) in attributes {
            text(&mut file, name);
            file.extend(2_u32.to_be_bytes());
            text(&mut file, value);
        }
        // Signed numbers of 64 bits.
        file.extend(10_u32.to_be_bytes());
        file.extend([0; 8]);
        begins.push(file.len());
        file.extend([0; 8]);
    }
    let values = [&[1_i64, 2][..], &[3, 4], &[121, 128, 221, 228]];
    for (begin, values) in begins.into_iter().zip(values) {
        let at = file.len() as u64;
        file[begin..begin + 8].copy_from_slice(&at.to_be_bytes());
        values
            .iter()
            .for_each(|value| file.extend(value.to_be_bytes()));
    }
    file
}

const METRES: (&str, &str) = ("units", "m");

#[test]
fn netcdf_of_64_bit_data_is_read() {
    // All units that the CF Conventions allow for degrees, and plain degrees with a name that
    // identifies the axis.
    for (lat, lon) in [
        ("degrees_north", "degrees_east"),
        ("degree_N", "degreesE"),
        ("degrees", "degree"),
    ] {
        let file = read(cdf5([("lat", lat), ("lon", lon)], &[METRES]), "");
        holds(
            &file.unwrap_or_else(|error| panic!("{lat}: {error}")),
            (2.0, 3.0),
            1.0,
            (2, 2),
            plane,
        );
    }
}

#[test]
fn depths_are_below_the_sea() {
    let depth = |lat: f64, lon: f64| -plane(lat, lon);
    for attribute in [
        ("positive", "down"),
        ("standard_name", "sea_floor_depth_below_geoid"),
    ] {
        let file = cdf5(
            [("lat", "degrees_north"), ("lon", "degrees_east")],
            &[METRES, attribute],
        );
        let file = read(file, "").unwrap_or_else(|error| panic!("{error}"));
        holds(&file, (2.0, 3.0), 1.0, (2, 2), depth);
    }
}

#[test]
fn columns_in_place_of_rows_are_named() {
    let file = cdf5([("x", "degrees_east"), ("y", "degrees_north")], &[METRES]);
    let said = said(file, "");
    assert!(
        said.contains("over longitude and latitude") && said.contains("ncpdq -a y,x"),
        "{said}"
    );
}

/// Two rows of two heights of the plane in the classic format over `before`, latitude and longitude. A length of 0 makes a dimension
/// the record dimension.
fn classic(before: &[(&str, u32)], records: u32) -> Vec<u8> {
    let mut file = b"CDF\x01".to_vec();
    let word = |file: &mut Vec<u8>, word: u32| file.extend(word.to_be_bytes());
    let text = |file: &mut Vec<u8>, text: &str| {
        file.extend((text.len() as u32).to_be_bytes());
        file.extend(text.bytes());
        file.resize(file.len().next_multiple_of(4), 0);
    };
    word(&mut file, records);
    let all: Vec<_> = before
        .iter()
        .copied()
        .chain([("lat", 2), ("lon", 2)])
        .collect();
    word(&mut file, 10);
    word(&mut file, all.len() as u32);
    for (name, length) in &all {
        text(&mut file, name);
        word(&mut file, *length);
    }
    file.extend([0; 8]);
    let (lat, lon) = (before.len() as u32, before.len() as u32 + 1);
    let of_z: Vec<u32> = (0..all.len() as u32).collect();
    // Bounds of latitudes also have two dimensions.
    let variables = [
        ("lat", vec![lat], "degrees_north", vec![1.0, 2.0]),
        ("lon", vec![lon], "degrees_east", vec![3.0, 4.0]),
        ("lat_bnds", vec![lat, lat], "", vec![0.5, 1.5, 1.5, 2.5]),
        ("z", of_z, "m", vec![121.0, 128.0, 221.0, 228.0]),
    ];
    word(&mut file, 11);
    word(&mut file, variables.len() as u32);
    let mut begins = Vec::new();
    for (name, dimensions, unit, _) in &variables {
        text(&mut file, name);
        word(&mut file, dimensions.len() as u32);
        dimensions.iter().for_each(|n| word(&mut file, *n));
        word(&mut file, 12);
        word(&mut file, 1);
        text(&mut file, "units");
        word(&mut file, 2);
        text(&mut file, unit);
        // Floats.
        word(&mut file, 5);
        word(&mut file, 16);
        begins.push(file.len());
        word(&mut file, 0);
    }
    for (begin, (_, _, _, values)) in begins.into_iter().zip(variables) {
        let at = file.len() as u32;
        file[begin..begin + 4].copy_from_slice(&at.to_be_bytes());
        file.extend(values.iter().flat_map(|value: &f32| value.to_be_bytes()));
    }
    file
}

#[test]
fn other_dimensions_of_length_1_are_skipped() {
    for (before, records) in [
        (&[][..], 0),
        (&[("time", 1)][..], 0),
        (&[("time", 1), ("level", 1)][..], 0),
        (&[("time", 0)][..], 1),
    ] {
        let file = read(classic(before, records), "");
        let file = file.unwrap_or_else(|error| panic!("{before:?}: {error}"));
        holds(&file, (2.0, 3.0), 1.0, (2, 2), plane);
    }
    for (before, records) in [(&[("time", 12)][..], 0), (&[("time", 0)][..], 12)] {
        let said = said(classic(before, records), "variable = \"z\"");
        assert!(
            said.contains("has no variable \"z\" over two dimensions"),
            "{said}"
        );
    }
}

/// `netcdf4_times_i16.nc`: netCDF4, variables of 16 × 32 of the plane over `time` (no limit, length 1) and others, as their names say.
/// `bare` has dimensions without coordinates.
#[test]
fn netcdf_4_of_one_time_is_read() {
    let bytes = std::fs::read(data("netcdf4_times_i16.nc")).expect("a file");
    for name in ["plain", "chunks", "long_chunks", "two"] {
        let file = read(bytes.clone(), &format!("variable = {name:?}"));
        let file = file.unwrap_or_else(|error| panic!("{name}: {error}"));
        holds(&file, (40.0, 178.0), 0.25, (32, 16), plane);
    }
    // Dimensions without coordinates have no position.
    let bare = "variable = \"bare\"\nunit = \"metres\"\nregistration = \"posts\"\n\
                bounds = { south_deg = 36.25, north_deg = 40, west_deg = 178, east_deg = 185.75 }";
    let file = read(bytes.clone(), bare).unwrap_or_else(|error| panic!("bare: {error}"));
    holds(&file, (40.0, 178.0), 0.25, (32, 16), plane);
    let said = said(bytes, "variable = \"months\"");
    assert!(said.contains("has no variable \"months\""), "{said}");
}

/// Prints how fast the file named by `TERRELLA_NETCDF` is read: its stored values per time of one thread.
#[test]
#[ignore = "prints a time"]
fn print_reading_speed() {
    let path = PathBuf::from(std::env::var_os("TERRELLA_NETCDF").expect("TERRELLA_NETCDF"));
    for _ in 0..3 {
        let reader = HeightReader::open(&path).expect("a file");
        let (columns, rows) = reader.size();
        let Decoder::NetCdf(file) = &reader.decoder else {
            panic!("no NetCDF");
        };
        let bytes = u64::from(columns) * u64::from(rows) * file.value_bytes() as u64;
        let conversion = reader.conversion().expect("metres");
        let start = cpu_time::ThreadTime::now();
        let mut sum = 0.0;
        reader
            .read(&conversion, |_, _, heights_m: &mut [f32]| {
                sum += f64::from(heights_m[0]);
                Ok::<_, HeightFileError>(())
            })
            .expect("heights");
        let megabytes_a_second = bytes as f64 / 1e6 / start.elapsed().as_secs_f64();
        println!("{columns} x {rows} heights read at {megabytes_a_second:.0} MB/s ({sum:.0})");
    }
}
