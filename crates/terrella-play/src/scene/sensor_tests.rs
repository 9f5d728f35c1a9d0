//! `[sensor]` in scenes: accepted data sheets, and those rejected by key.

use super::*;
use crate::scene::Scene;

const SHEET: &str = "[sensor]\nsize = [640, 480]\nfocal_length_mm = 12\npixel_pitch_um = 5\nf_number = 2.8\nexposure_s = 0.002\nfull_well_e = 20000\n";

fn scene(text: &str) -> Result<Scene, SceneError> {
    Scene::from_toml(text, Path::new("a.toml"))
}

fn sensor(more: &str) -> Sensor {
    let scene = scene(&format!("{SHEET}{more}")).unwrap_or_else(|error| panic!("{error}"));
    let table = scene.sensor.expect("a sensor");
    table.open().expect("opens")
}

#[test]
fn a_data_sheet_is_a_sensor() {
    let sensor = sensor(
        "principal_point_px = [318.2, 241]\ndistortion = [-0.1, 0.02, 1e-4, -2e-4, 3e-3]\nquantum_efficiency = [0.4, 0.6, 0.5]\npsf = \"airy\"\npsf_wavelength_nm = 600\noversampling = 6\nbits = 10\nbias_dn = 23\nmosaic = \"grbg\"\nshutter = \"rolling\"\nline_time_us = -15\nseed = 7\nread_noise_e = 9\n",
    );
    assert_eq!(sensor.lens.size(), [640, 480]);
    assert_eq!(sensor.lens.focal_px(), 2400.0);
    assert_eq!(sensor.lens.principal_point_px().to_array(), [318.2, 241.0]);
    let coefficients = [-0.1, 0.02, 1e-4, -2e-4, 3e-3, 0.0, 0.0, 0.0];
    assert_eq!(
        *sensor.lens.distortion(),
        Distortion::BrownConrady(coefficients)
    );
    assert_eq!(
        sensor.psf,
        Psf::Airy {
            lambda_n_px: 0.6 * 2.8 / 5.0
        }
    );
    assert_eq!((sensor.mosaic, sensor.seed), (Mosaic::Grbg, 7));
    assert_eq!(sensor.detector.gain_e_dn, 20.0);
    let rolling = Shutter::Rolling {
        line_time_s: 1e-6 * 15.0,
        from_below: true,
    };
    assert_eq!(sensor.shutter, rolling);
}

#[test]
fn field_of_view_and_size_follow_from_the_sensor() {
    let read = scene(SHEET).expect("good");
    let wanted = 2.0 * (1.2_f64 / 12.0).atan().to_degrees();
    assert!(
        (read.camera.fov_deg - wanted).abs() < 1e-12,
        "{}",
        read.camera.fov_deg
    );
    assert_eq!(read.output.size, [640, 480]);
    let other = scene(&format!("{SHEET}[output]\nsize = [64, 36]\n")).expect("good");
    assert_eq!(other.output.size, [64, 36]);
    assert_eq!(scene("").expect("good").sensor, None);
    assert_eq!(scene("[sensor]\n").expect("good").sensor, None);
}

/// Each with the key in its message, and the remedy.
#[test]
fn impossible_sheets_are_rejected_by_key() {
    for (more, key, remedy) in [
        ("distortion = [-10, 0, 0, 0]\n", "distortion", "would work"),
        ("distortion = [0.1, 0.2]\n", "distortion", "4, 5 or 8"),
        (
            "distortion_model = \"fisheye\"\ndistortion = [0, 0, 0, 0, 0]\n",
            "distortion",
            "4 numbers",
        ),
        (
            "psf = \"gaussian\"\npsf_sigma_px = 0.1\n",
            "psf",
            "oversampling of 10 would work",
        ),
        ("psf_sigma_px = 0.5\n", "psf_sigma_px", "gaussian"),
        ("psf = \"measured\"\n", "psf_kernel", "needs the file"),
        ("bits = 17\n", "bits", "1 to 16"),
        ("bias_dn = 4095\n", "bias_dn", "below 4095"),
        (
            "quantum_efficiency = [0.5, 1.5, 0.5]\n",
            "quantum_efficiency",
            "0 to 1",
        ),
        (
            "bands_nm = [[600, 700], [500, 600]]\n",
            "bands_nm",
            "red, green and blue",
        ),
        (
            "bands_nm = [[600, 700], [600, 500], [400, 500]]\n",
            "bands_nm",
            "shorter",
        ),
        (
            "hot_pixel_e_s = 10\n",
            "hot_pixel_e_s",
            "hot_pixel_fraction",
        ),
        ("line_time_us = 5\n", "line_time_us", "rolling"),
        (
            "shutter = \"rolling\"\nline_time_us = 0\n",
            "line_time_us",
            "global",
        ),
        ("vignetting = [-1e5, 0, 0]\n", "vignetting", "corners"),
        (
            "[camera]\nfov_deg = 30\n",
            "fov_deg",
            "focal_length_mm of [sensor]",
        ),
        (
            "[camera]\nmode = \"geodetic\"\n[[camera.keys]]\ntime_s = 0\nfov_deg = 3\n",
            "keys",
            "[sensor]",
        ),
    ] {
        let text = scene(&format!("{SHEET}{more}"))
            .expect_err(more)
            .to_string();
        assert!(
            text.contains(&format!("] {key} = ")) && text.contains(remedy),
            "{text}"
        );
        assert!(text.starts_with("a.toml:"), "{text}");
    }
    for key in [
        "size",
        "focal_length_mm",
        "pixel_pitch_um",
        "f_number",
        "exposure_s",
        "full_well_e",
    ] {
        let lines = SHEET.lines().filter(|line| !line.starts_with(key));
        let text = lines.collect::<Vec<_>>().join("\n");
        let error = scene(&text).expect_err(key).to_string();
        assert!(error.contains(&format!("[sensor] {key}")), "{error}");
    }
    let zero = scene(&SHEET.replace("full_well_e = 20000", "full_well_e = 0"));
    let zero = zero.expect_err("no well").to_string();
    assert!(
        zero.contains("full_well_e = 0") && zero.contains("1 to 1e9"),
        "{zero}"
    );
    let wide = scene(&SHEET.replace("focal_length_mm = 12", "focal_length_mm = 0.3"));
    let wide = wide.expect_err("too wide").to_string();
    assert!(
        wide.contains("focal_length_mm") && wide.contains("would work"),
        "{wide}"
    );
}

#[test]
fn a_kernel_is_read_from_its_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("kernel.txt");
    let open = |kernel: &str| {
        std::fs::write(&path, kernel).expect("writes");
        let text = format!("{SHEET}psf = \"measured\"\npsf_kernel = \"kernel.txt\"\n");
        let scene = Scene::from_toml(&text, &folder.path().join("a.toml")).expect("good");
        scene.sensor.expect("a sensor").open()
    };
    let sensor = open("# measured\n0 1, 0\n1 4 1\n\n0 1 0\n").expect("a kernel");
    let Psf::Measured(kernel) = sensor.psf else {
        panic!("{:?}", sensor.psf);
    };
    assert_eq!((kernel.side(), kernel.weights()[4]), (3, 0.5));
    for (text, problem) in [
        ("1 2\n3 4\n", "odd"),
        ("1 2 3\n", "3 samples"),
        ("1\n\nx\n", "line 3"),
        ("0\n", "positive"),
    ] {
        let error = open(text).expect_err(text).to_string();
        assert!(
            error.contains("kernel.txt") && error.contains(problem),
            "{error}"
        );
    }
}
