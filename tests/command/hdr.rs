//! High dynamic range images: as decoded by another program, and rejected settings.

use crate::{Place, SMALL};
use std::path::Path;

/// Content of a PNG of 16 bits: fractions of the scale, and its chunks before the data.
struct Read {
    pixels: Vec<[f64; 3]>,
    info: png::Info<'static>,
}

fn read(path: &Path) -> Read {
    let file = std::fs::File::open(path).expect("opens");
    let mut reader = png::Decoder::new(std::io::BufReader::new(file))
        .read_info()
        .expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("small")];
    reader.next_frame(&mut bytes).expect("whole");
    let code = |bytes: &[u8; 2]| f64::from(u16::from_be_bytes(*bytes)) / 65_535.0;
    let pixels = bytes.as_chunks::<6>().0.iter().map(|pixel| {
        let [red, green, blue] = [0, 1, 2].map(|n| code(&pixel.as_chunks::<2>().0[n]));
        [red, green, blue]
    });
    Read {
        pixels: pixels.collect(),
        info: reader.info().clone(),
    }
}

/// The EOTF of SMPTE ST 2084 as it is printed there, cd/m².
fn pq_luminance(code: f64) -> f64 {
    let (m1, m2) = (0.159_301_757_812_5, 78.84375);
    let (c1, c2, c3) = (0.835_937_5, 18.851_562_5, 18.6875);
    let root = code.powf(1.0 / m2);
    10_000.0 * ((root - c1).max(0.0) / (c2 - c3 * root)).powf(1.0 / m1)
}

/// BT.2020 to BT.709: the matrix of ITU-R BT.2407-0, of four digits.
fn bt709([red, green, blue]: [f64; 3]) -> [f64; 3] {
    [
        1.6605 * red - 0.5876 * green - 0.0728 * blue,
        -0.1246 * red + 1.1329 * green - 0.0083 * blue,
        -0.0182 * red - 0.1006 * green + 1.1187 * blue,
    ]
}

fn srgb_light(code: f64) -> f64 {
    match code <= 0.040_45 {
        true => code / 12.92,
        false => ((code + 0.055) / 1.055).powf(2.4),
    }
}

/// Dark parts of an image equal those of ordinary images, bright parts exceed white, and captions are at reference white.
#[test]
fn another_decoder_reads_the_light_of_hdr_pictures() {
    let place = Place::new();
    let caption = "[[caption]]\nimage = \"logo.png\"\nplace = \"top-left\"\nplate_opacity = 0\nwidth_px = 8\n";
    place.scene("captions.toml", &format!("{SMALL}{caption}"));
    let logo = image::RgbImage::from_pixel(16, 8, image::Rgb([255, 255, 255]));
    logo.save(place.path("logo.png")).expect("written");
    let frame = |name: &str, format: &str| {
        // Bright enough that clouds have highlights.
        let exposed = ["--set", "output.exposure_ev=1.5", "--format", format];
        place.succeed(&[&["frame", "captions.toml", "-o", name], &exposed[..]].concat());
        read(&place.path(name))
    };
    let [plain, pq, hlg] = [("a.png", "png16"), ("b.png", "pq"), ("c.png", "hlg")]
        .map(|(name, format)| frame(name, format));
    let transfer = |read: &Read| {
        let points = read
            .info
            .coding_independent_code_points
            .as_ref()
            .expect("cICP");
        assert_eq!((points.color_primaries, points.matrix_coefficients), (9, 0));
        assert!(points.is_video_full_range_image && read.info.srgb.is_none());
        points.transfer_function
    };
    assert_eq!((transfer(&pq), transfer(&hlg)), (16, 18));
    assert!(plain.info.coding_independent_code_points.is_none());

    let (mut dark, mut whites, mut brightest, mut sum) = (0, 0, 0.0_f64, 0.0);
    for ((plain, pq), hlg) in plain.pixels.iter().zip(&pq.pixels).zip(&hlg.pixels) {
        let luminances = pq.map(pq_luminance);
        let top = luminances.iter().copied().fold(0.0, f64::max);
        (brightest, sum) = (brightest.max(top), sum + top);
        let shown = plain.map(srgb_light);
        let light = bt709(luminances).map(|luminance| luminance / 203.0);
        // The camera's curve shows light of 0.5, up to which both are alike, at 0.58 to 0.63.
        if shown.iter().all(|channel| *channel < 0.55) {
            dark += 1;
            for (a, b) in shown.iter().zip(light) {
                assert!((a - b).abs() < 1e-3, "{shown:?} {light:?}");
            }
        }
        if *plain == [1.0; 3] && hlg.iter().all(|code| (code - 0.75).abs() < 1e-3) {
            whites += 1;
            let off = pq.map(|code| (pq_luminance(code) - 203.0).abs());
            assert!(off.iter().all(|off| *off < 0.1), "{off:?}");
        }
    }
    assert!(dark > 500, "{dark} pixels");
    assert_eq!(whites, 32, "the logo");
    assert!((250.0..1000.0).contains(&brightest), "{brightest} cd/m²");
    // MaxCLL and MaxFALL, in 0.0001 cd/m².
    let levels = pq.info.content_light_level.expect("cLLI");
    let mean = sum / pq.pixels.len() as f64;
    for (reported, found) in [
        (levels.max_content_light_level, brightest),
        (levels.max_frame_average_light_level, mean),
    ] {
        assert!(
            (f64::from(reported) * 1e-4 - found).abs() < 0.1,
            "{reported} {found}"
        );
    }
    assert!(hlg.info.content_light_level.is_none());
}

/// Tracks have their display colours, with white at 203 cd/m², where other pictures show them: craft and globe hide them.
#[test]
fn tracks_stand_over_hdr_light() {
    let place = Place::new();
    let tracks = SMALL
        .replace("mode = \"geodetic\"", "mode = \"chase\"")
        .replace("lat_deg = 20\nlon_deg = 15\nheight_km = 12000\n", "")
        .replace("size = [64, 36]", "size = [192, 108]");
    let own = "[orbit]\ncolor = \"#00ff00\"\n[tracks]\ntrail = true\nground_track = true\n";
    place.scene("tracks.toml", &format!("{tracks}{own}"));
    let frame = |name: &str, format: &str| {
        place.succeed(&["frame", "tracks.toml", "-o", name, "--format", format]);
        read(&place.path(name)).pixels
    };
    let (fine, pq) = (frame("a.png", "png16"), frame("b.png", "pq"));
    place.succeed(&["frame", "tracks.toml", "-o", "c.png"]);
    let usual = image::open(place.path("c.png")).expect("a PNG").to_rgb8();
    let is_green = |[red, green, blue]: [f64; 3]| green > 0.3 && red < 0.1 && blue < 0.1;
    let (mut both, mut either, mut whole) = (0, 0, 0);
    for ((usual, fine), pq) in usual.pixels().zip(fine).zip(pq) {
        let usual = usual.0.map(|code| srgb_light(f64::from(code) / 255.0));
        let shown = bt709(pq.map(pq_luminance)).map(|luminance| luminance / 203.0);
        let (a, b) = (is_green(usual), is_green(shown));
        both += usize::from(a && b);
        either += usize::from(a || b);
        if fine == [0.0, 1.0, 0.0] {
            whole += 1;
            for (part, wanted) in shown.into_iter().zip([0.0, 1.0, 0.0]) {
                assert!((part - wanted).abs() < 2e-3, "{shown:?}");
            }
        }
    }
    println!("{both} of {either} pixels alike, {whole} covered wholly");
    assert!(both > 100 && 10 * both > 9 * either, "{both} of {either}");
    assert!(whole > 20, "{whole}");
}

#[test]
fn hdr_that_nothing_can_show_is_rejected_by_option() {
    let place = Place::new();
    let still = ["frame", "small.toml", "-o", "a.png"];
    for (options, words) in [
        (&["--peak", "600"][..], "--format pq"),
        (&["--format", "hlg", "--peak", "600"], "always 1000"),
        (&["--format", "pq", "--peak", "100"], "400 to 10000"),
        (&["--format", "pq", "--peak", "nan"], "400 to 10000"),
        (&["--format", "pq", "--alpha"], "exr"),
    ] {
        let said = place.fail(2, &[&still[..], options].concat());
        assert!(said.contains(words), "{options:?}: {said}");
    }
    let film = ["play", "small.toml", "--video", "a.mp4", "--format", "pq"];
    for more in [&[][..], &["--encoder", "builtin"]] {
        let said = place.fail(1, &[&film[..], more].concat());
        assert!(said.contains("--codec h265"), "{said}");
    }
    assert_eq!(place.names(), ["small.toml"]);
}
