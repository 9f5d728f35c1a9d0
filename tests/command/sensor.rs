//! `terrella frame --raw`, and truth behind the same lens.

use crate::truth::numpy;
use crate::{Place, words};
use serde_json::Value;
use std::path::Path;

/// A camera that has no keys beyond those it needs.
const SHEET: &str = "[sensor]\nsize = [48, 32]\nfocal_length_mm = 0.6\npixel_pitch_um = 10\nf_number = 4\nexposure_s = 2e-5\nfull_well_e = 20000\noversampling = 1\n";
const PLAIN: &str = "[sky]\nstars = false\nsun = false\nmoon = false\n[earth]\nnormals = false\nnight_lights = false\n";

fn page(path: &Path) -> Value {
    let text =
        std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).expect("JSON")
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list");
    list.iter()
        .map(|number| number.as_f64().expect("a number"))
        .collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Numbers of a raw frame in NumPy's format.
fn raw(path: &Path) -> Vec<f64> {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let end = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert!(
        std::str::from_utf8(&bytes[10..end])
            .expect("text")
            .contains("'<u2'")
    );
    let numbers = bytes[end..].as_chunks::<2>().0.iter();
    numbers
        .map(|bytes| f64::from(u16::from_le_bytes(*bytes)))
        .collect()
}

/// A place of WGS84 with height 0, metres: of this file's own.
fn place_m(lat_deg: f64, lon_deg: f64) -> [f64; 3] {
    let (lat, lon) = (lat_deg.to_radians(), lon_deg.to_radians());
    let flattening = 1.0 / 298.257_223_563;
    let e2 = flattening * (2.0 - flattening);
    let normal_m = 6_378_137.0 / (1.0 - e2 * lat.sin().powi(2)).sqrt();
    [
        normal_m * lat.cos() * lon.cos(),
        normal_m * lat.cos() * lon.sin(),
        normal_m * (1.0 - e2) * lat.sin(),
    ]
}

/// The pixel of a place by the page of the frame and the formulas of OpenCV's documentation.
fn pixel_of(camera: &Value, row: u32, place_m: [f64; 3]) -> [f64; 2] {
    let poses = camera["poses"].as_array().expect("poses");
    let holds = |pose: &&Value| {
        let first = pose["first_row"].as_u64().expect("a row");
        let rows = pose["rows"].as_u64().expect("a count");
        (first..first + rows).contains(&u64::from(row))
    };
    let pose = poses.iter().find(holds).expect("a pose for each row");
    let eye = numbers(&pose["eye_itrf_m"]);
    let to: Vec<_> = place_m
        .iter()
        .zip(&eye)
        .map(|(place, eye)| place - eye)
        .collect();
    let [x, y, z] = ["right", "down", "ahead"].map(|axis| dot(&numbers(&pose[axis]), &to));
    let (x, y) = (x / z, y / z);
    let k = numbers(&camera["distortion"]);
    let r2 = x * x + y * y;
    let (u, v) = match camera["distortion_model"].as_str() {
        Some("fisheye") => {
            let r = r2.sqrt();
            let t = r.atan();
            let t_d = t
                * (1.0 + k[0] * t.powi(2) + k[1] * t.powi(4) + k[2] * t.powi(6) + k[3] * t.powi(8));
            (x * t_d / r, y * t_d / r)
        }
        _ => {
            let g = (1.0 + k[0] * r2 + k[1] * r2.powi(2) + k[4] * r2.powi(3))
                / (1.0 + k[5] * r2 + k[6] * r2.powi(2) + k[7] * r2.powi(3));
            (
                x * g + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x),
                y * g + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y,
            )
        }
    };
    let matrix: Vec<_> = camera["camera_matrix"]
        .as_array()
        .expect("rows")
        .iter()
        .map(numbers)
        .collect();
    [
        matrix[0][0] * u + matrix[0][2],
        matrix[1][1] * v + matrix[1][2],
    ]
}

/// The largest distance of a pixel from where the formula puts the place that its truth names, pixels; and how many show ground.
fn worst_of(folder: &Path) -> (f64, usize) {
    let page = page(&folder.join("truth.json"));
    let camera = &page["sensor"];
    let (lat, lon) = (
        numpy(&folder.join("lat_deg.npy")),
        numpy(&folder.join("lon_deg.npy")).values,
    );
    let [height, width] = lat.shape[..] else {
        panic!("{:?}", lat.shape);
    };
    assert_eq!(numbers(&page["size"]), [width as f64, height as f64]);
    let (mut worst, mut ground) = (0.0_f64, 0);
    for (i, (lat, lon)) in lat.values.iter().zip(&lon).enumerate() {
        if lat.is_nan() {
            continue;
        }
        let (x, y) = (i % width, i / width);
        let [u, v] = pixel_of(camera, y as u32, place_m(*lat, *lon));
        worst = worst.max((u - x as f64).hypot(v - y as f64));
        ground += 1;
    }
    (worst, ground)
}

#[test]
fn truth_is_where_the_lens_puts_it_at_twenty_eyes() {
    let place = Place::new();
    let lenses = [
        "distortion = [-0.2, 0.05, 0.001, -0.002]\n",
        "distortion = [0.15, -0.08, -0.002, 0.001, 0.02]\nprincipal_point_px = [20.3, 17.8]\n",
        "distortion = [0.4, 0.1, 0.0005, 0.0005, 0.01, 0.7, 0.2, 0.01]\n",
        "distortion_model = \"fisheye\"\ndistortion = [-0.02, 0.01, -0.005, 0.001]\n",
    ];
    let eyes = [
        (0.0, 0.0, 400.0, 0.0, -90.0),
        (50.0, 10.0, 600.0, 30.0, -60.0),
        (-33.0, 151.0, 800.0, 200.0, -40.0),
        (89.9, 0.0, 1000.0, 0.0, -90.0),
        (10.0, 179.9, 35_786.0, 0.0, -90.0),
    ];
    let (mut worst, mut ground) = (0.0_f64, 0);
    for (lens, (lat, lon, height, heading, pitch)) in lenses
        .iter()
        .flat_map(|lens| eyes.iter().map(move |eye| (lens, *eye)))
    {
        let camera = format!(
            "[camera]\nmode = \"geodetic\"\nlat_deg = {lat}\nlon_deg = {lon}\nheight_km = {height}\nheading_deg = {heading}\npitch_deg = {pitch}\n"
        );
        place.scene("a.toml", &format!("{camera}{PLAIN}{SHEET}{lens}"));
        place.succeed(&[
            "frame", "a.toml", "-o", "a.png", "--size", "24x16", "--truth", "truth",
        ]);
        let (of_eye, count) = worst_of(&place.path("truth"));
        worst = worst.max(of_eye);
        ground += count;
        assert!(count > 100, "{lens} {lat}: {count} pixels of ground");
    }
    eprintln!("20 eyes, {ground} pixels: {worst:.1e} px");
    assert!(worst <= 0.02, "{worst}");
}

/// Space is dark: bias, dark current and read noise are all that a frame of it holds.
#[test]
fn a_frame_of_space_has_the_noise_that_was_asked_for() {
    let place = Place::new();
    let dark = "[camera]\nmode = \"geodetic\"\nheight_km = 3000\npitch_deg = 80\n";
    let scene = |seed: u32| {
        let sheet = SHEET
            .replace("[48, 32]", "[320, 200]")
            .replace("exposure_s = 2e-5", "exposure_s = 0.5");
        format!(
            "{dark}{PLAIN}{sheet}read_noise_e = 20\ndark_current_e_s = 600\nbias_dn = 200\ngain_e_dn = 2\nbits = 14\nseed = {seed}\n"
        )
    };
    place.scene("a.toml", &scene(3));
    place.scene("b.toml", &scene(4));
    let draw = |scene: &str, file: &str| {
        place.succeed(&[
            "frame", scene, "-o", "a.png", "--size", "32x20", "--raw", file,
        ]);
    };
    draw("a.toml", "a.npy");
    let numbers = raw(&place.path("a.npy"));
    assert_eq!(numbers.len(), 64_000);
    let mean = numbers.iter().sum::<f64>() / 64_000.0;
    let variance = numbers
        .iter()
        .map(|number| (number - mean).powi(2))
        .sum::<f64>()
        / 64_000.0;
    // 300 electrons of dark current, at 2 electrons a number.
    assert!((mean - 350.0).abs() < 0.2, "{mean}");
    let wanted = (400.0 + 300.0) / 4.0 + 1.0 / 12.0;
    assert!(
        (variance / wanted - 1.0).abs() < 0.02,
        "{variance} {wanted}"
    );
    let page = page(&place.path("a.json"));
    assert_eq!(
        (page["seed"].as_u64(), page["file"].as_str()),
        (Some(3), Some("a.npy"))
    );
    assert_eq!(page["detector"]["read_noise_e"], 20.0);
    // The same seed is the same frame, whatever the file; another is another.
    draw("a.toml", "b.tiff");
    draw("a.toml", "c.png");
    draw("b.toml", "d.npy");
    let png = image::open(place.path("c.png")).expect("opens").to_luma16();
    assert!(
        png.into_raw()
            .iter()
            .zip(&numbers)
            .all(|(png, number)| f64::from(*png) == *number)
    );
    assert!(raw(&place.path("d.npy")) != numbers);
    // Uncompressed, so that the values are stored directly.
    let tiff = std::fs::read(place.path("b.tiff")).expect("reads");
    let row: Vec<u8> = numbers[..320]
        .iter()
        .flat_map(|number| (*number as u16).to_le_bytes())
        .collect();
    assert!(tiff.windows(row.len()).any(|bytes| bytes == row));
}

/// Electrons of a white sheet, through the whole chain: light of the pinhole image times the page's electrons of white.
#[test]
fn a_frame_has_the_electrons_of_its_light() {
    let place = Place::new();
    let camera = "[camera]\nmode = \"geodetic\"\nlat_deg = 10\nlon_deg = 0\nheight_km = 20000\n";
    let sheet = SHEET.replace("focal_length_mm = 0.6", "focal_length_mm = 1.2");
    place.scene(
        "a.toml",
        &format!("{camera}{PLAIN}{sheet}cos4 = false\nbits = 16\ngain_e_dn = 0.5\nquantum_efficiency = [0.3, 0.5, 0.4]\n"),
    );
    place.succeed(&[
        "frame",
        "a.toml",
        "-o",
        "a.png",
        "--radiance",
        "light.npy",
        "--raw",
        "a.npy",
    ]);
    let light = numpy(&place.path("light.npy"));
    assert_eq!(light.shape, [32, 48, 3]);
    let page = page(&place.path("a.json"));
    let white = numbers(&page["electrons_of_white"]);
    let mut deviations = Vec::new();
    for (light, number) in light.values.chunks_exact(3).zip(raw(&place.path("a.npy"))) {
        let wanted = dot(light, &white);
        if wanted > 500.0 && wanted < 18_000.0 {
            deviations.push((0.5 * number - wanted) / wanted.sqrt());
        }
    }
    let count = deviations.len() as f64;
    assert!(count > 400.0, "{count}");
    let mean = deviations.iter().sum::<f64>() / count;
    let square = deviations.iter().map(|d| d * d).sum::<f64>() / count;
    // Poisson: of mean 0 and variance 1 in units of the square root.
    assert!(
        mean.abs() < 4.0 / count.sqrt() && (square - 1.0).abs() < 0.2,
        "{mean} {square}"
    );
}

/// A satellite over the equator flies across the rows: each row is displaced by its time times the ground speed.
#[test]
fn a_rolling_shutter_shears_the_ground_by_the_motion() {
    const ROWS: usize = 64;
    const WIDTH: usize = 128;
    let place = Place::new();
    let scene = |shutter: &str| {
        let sheet = SHEET
            .replace("[48, 32]", "[128, 64]")
            .replace("focal_length_mm = 0.6", "focal_length_mm = 16");
        format!(
            "[time]\nstart = 2018-03-20T12:00:00Z\nduration_s = 60\n[orbit]\nsource = \"kepler\"\nsemi_major_axis_km = 12000\ntrue_anomaly_deg = 7\n[camera]\nmode = \"nadir\"\nup = \"north\"\n{PLAIN}clouds = false\n{}bits = 16\nfull_well_e = 4e7\nexposure_s = 0.05\nseed = 1\n{shutter}",
            sheet
                .replace("full_well_e = 20000\n", "")
                .replace("exposure_s = 2e-5\n", "")
        )
    };
    place.scene("global.toml", &scene(""));
    place.scene(
        "rolling.toml",
        &scene("shutter = \"rolling\"\nline_time_us = 150000\n"),
    );
    for name in ["global", "rolling"] {
        let (toml, file) = (format!("{name}.toml"), format!("{name}.npy"));
        place.succeed(&[
            "frame", &toml, "-o", "a.png", "--size", "16x8", "--raw", &file, "--truth", name,
        ]);
    }
    let poses = page(&place.path("rolling.json"))["camera"]["poses"]
        .as_array()
        .expect("poses")
        .len();
    assert!(poses > 30, "{poses}");
    let (worst, _) = worst_of(&place.path("rolling"));
    assert!(worst <= 0.02, "{worst}");
    // n = √(µ/a³) less the turn of the Earth, radians a second of longitude.
    let rate = (3.986_004_418e14 / 12e6_f64.powi(3)).sqrt() - 7.292_115e-5;
    let per_row_deg = (rate * 0.15).to_degrees();
    let lon = |name: &str| numpy(&place.path(name).join("lon_deg.npy")).values;
    let (still, moving) = (lon("global"), lon("rolling"));
    let pixel_deg = still[WIDTH / 2 + 1] - still[WIDTH / 2];
    for row in 0..ROWS {
        let at = row * WIDTH + WIDTH / 2;
        let moved_px = (moving[at] - still[at]) / pixel_deg;
        let wanted_px = row as f64 * per_row_deg / pixel_deg;
        assert!(
            (moved_px - wanted_px).abs() < 0.06,
            "row {row}: {moved_px} {wanted_px}"
        );
    }
    // The light is sheared by as much: what row y of the one shows at x, the other shows at x + k y, with k where they differ least.
    let (still, moving) = (
        raw(&place.path("global.npy")),
        raw(&place.path("rolling.npy")),
    );
    let difference = |k: f64| {
        let rows = (0..ROWS).flat_map(|row| (10..WIDTH - 30).map(move |x| (row, x)));
        let squares = rows.map(|(row, x)| {
            let at = x as f64 + k * row as f64;
            let left = row * WIDTH + at as usize;
            let shown = still[left] + at.fract() * (still[left + 1] - still[left]);
            (moving[row * WIDTH + x] - shown).powi(2)
        });
        squares.sum::<f64>()
    };
    let shears = (0..2000).map(|k| f64::from(k) * 1e-4);
    let found = shears.min_by(|a, b| difference(*a).total_cmp(&difference(*b)));
    let (found, wanted) = (found.expect("shears"), per_row_deg / pixel_deg);
    eprintln!("a row is shifted by {found:.4} px, by the motion {wanted:.4} px");
    assert!((found / wanted - 1.0).abs() < 0.02, "{found} {wanted}");
}

/// The raw frames of a film are those that are drawn one by one.
#[test]
fn a_film_has_the_raw_frames_of_its_instants() {
    let place = Place::new();
    let noisy = "read_noise_e = 5\nseed = 3\n";
    place.scene(
        "film.toml",
        &format!(
            "[time]\nduration_s = 120\nspeed = 60\nframe_rate_hz = 1.5\n{SHEET}{noisy}{PLAIN}"
        ),
    );
    let play = ["play", "film.toml", "--raw", "raw", "--range", "1..3"];
    place.succeed(&play);
    let names = crate::names(&place.path("raw"));
    let wanted = [
        "frame_00001.json",
        "frame_00001.tiff",
        "frame_00002.json",
        "frame_00002.tiff",
        "frames.json",
    ];
    assert_eq!(names, wanted);
    // 40 s of the scene from frame to frame.
    place.succeed(&[
        "frame",
        "film.toml",
        "-o",
        "a.png",
        "--at",
        "2018-01-15T12:01:20Z",
        "--raw",
        "one.tiff",
    ]);
    let read = |name: &str| std::fs::read(place.path(name)).expect("reads");
    assert!(read("one.tiff") == read("raw/frame_00002.tiff"));
    assert!(read("raw/frame_00001.tiff") != read("raw/frame_00002.tiff"));
    let mut one = page(&place.path("one.json"));
    one["file"] = "frame_00002.tiff".into();
    assert_eq!(one, page(&place.path("raw/frame_00002.json")));
    // A folder that holds frames is not written to unless that is wanted.
    let rejection = place.fail(1, &play);
    assert!(
        rejection.contains("--overwrite") && rejection.contains("--resume"),
        "{rejection}"
    );
    // A frame that is lost, or whose page is, is drawn again, and no other.
    let resume = [&play[..], &["--resume"]].concat();
    let said = |arguments: &[&str]| words(&place.succeed(arguments));
    let loud = [&["-v"], &resume[..]].concat();
    assert!(said(&loud).contains("already there"));
    let before = read("raw/frame_00001.tiff");
    std::fs::remove_file(place.path("raw/frame_00001.tiff")).expect("removes");
    std::fs::remove_file(place.path("raw/frame_00002.json")).expect("removes");
    let drawn = said(&loud);
    assert!(drawn.contains("2 raw frames"), "{drawn}");
    assert!(read("raw/frame_00001.tiff") == before);
    assert_eq!(one, page(&place.path("raw/frame_00002.json")));
    let other = place.fail(1, &[&resume[..], &["--raw-format", "npy"]].concat());
    assert!(other.contains("another --raw-format"), "{other}");
    place.succeed(&[&play[..], &["--overwrite"]].concat());
    for (bad, words) in [
        (&["--raw", "other", "--video", "a.mp4"][..], "--video"),
        (&["--raw", "other", "--supersample", "2"], "--supersample"),
        (&["--raw-format", "png"], "--raw"),
        (&["--overwrite"], "--overwrite needs --frames or --raw"),
    ] {
        let rejection = place.fail(2, &[&["play", "film.toml"], bad].concat());
        assert!(rejection.contains(words), "{rejection}");
    }
    let rejection = place.fail(2, &["play", "small.toml", "--raw", "other"]);
    assert!(rejection.contains("[sensor]"), "{rejection}");
    assert!(!place.path("other").exists());
}

#[test]
fn raw_frames_that_cannot_be_are_rejected() {
    let place = Place::new();
    let camera = "[camera]\nmode = \"geodetic\"\n";
    place.scene("plain.toml", camera);
    place.scene("a.toml", &format!("{camera}{SHEET}"));
    place.scene(
        "none.toml",
        &format!("{camera}{SHEET}").replace("full_well_e = 20000", "full_well_e = 0"),
    );
    place.scene(
        "fine.toml",
        &format!("{camera}{SHEET}psf = \"measured\"\npsf_kernel = \"kernel.txt\"\n"),
    );
    place.scene("kernel.txt", "1 2\n");
    let rejection = |code: i32, scene: &str, file: &str| {
        place.fail(
            code,
            &[
                "frame", scene, "-o", "b.png", "--size", "16x9", "--raw", file,
            ],
        )
    };
    assert!(rejection(2, "plain.toml", "a.npy").contains("[sensor]"));
    let none = rejection(2, "none.toml", "a.npy");
    assert!(
        none.contains("full_well_e = 0") && none.contains("1 to 1e9"),
        "{none}"
    );
    let kernel = rejection(2, "fine.toml", "a.npy");
    assert!(
        kernel.contains("kernel.txt") && kernel.contains("psf_kernel"),
        "{kernel}"
    );
    assert!(rejection(1, "a.toml", "a.jpg").contains("a.png"));
    assert!(rejection(2, "a.toml", "b.png").contains("--raw"));
    let stats = [
        "frame", "a.toml", "-o", "b.png", "--raw", "c.png", "--stats", "c.json",
    ];
    assert!(place.fail(2, &stats).contains("--raw"));
    assert_eq!(place.names().len(), 6, "{:?}", place.names());
}
