//! Whole cameras on scenes of closed form.

use super::*;
use crate::distortion::Distortion;
use crate::psf::Kernel;
use std::f64::consts::TAU;

fn sensor(size: [u32; 2], psf: Psf, oversampling: u32) -> Sensor {
    Sensor {
        lens: Lens::new(size, 50.0, 5.0, None, Distortion::NONE).expect("a lens"),
        psf,
        oversampling,
        radiometry: Radiometry {
            f_number: 4.0,
            exposure_s: 1e-4,
            transmission: 0.9,
            bands_nm: [[600.0, 700.0], [500.0, 600.0], [400.0, 500.0]],
            quantum_efficiency: [0.4, 0.5, 0.3],
            cos4: false,
            vignetting: [0.0; 3],
        },
        detector: Detector {
            full_well_e: 1e5,
            blooming: false,
            dark_current_e_s: 0.0,
            dsnu_e: 0.0,
            prnu: 0.0,
            hot_pixel_fraction: 0.0,
            hot_pixel_e_s: 0.0,
            read_noise_e: 0.0,
            gain_e_dn: 2.0,
            bias_dn: 0.0,
            bits: 16,
        },
        mosaic: Mosaic::Mono,
        shutter: Shutter::Global,
        seed: 1,
    }
}

/// A scene through the pinhole, exposed.
fn exposed(sensor: &Sensor, scene: impl Fn(DVec2) -> f32) -> Vec<[f32; 3]> {
    let rows = 0..sensor.lens.size()[1];
    let frame = sensor.pinhole(rows.clone()).expect("a frame");
    let step = (frame.rect.most - frame.rect.least) / DVec2::from(frame.size.map(f64::from));
    let light: Vec<_> = (0..frame.len() as u32)
        .map(|i| {
            let (x, y) = (i % frame.size[0], i / frame.size[0]);
            let part = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
            let light = scene(frame.rect.least + part * step);
            [light, 0.5 * light, 0.25, 1.0]
        })
        .collect();
    let picture = PinholePicture::new(frame, &light).expect("fits");
    sensor.expose(rows, &picture).expect("exposes")
}

/// Transfer at a frequency, cycles per pixel, from the edge of a half plane that moves by 1/32 pixel from row to row: 32 rows together are
/// an edge that is sampled 32 times a pixel (ISO 12233's slanted edge, with its place known).
fn edge_transfer(sensor: &Sensor, frequency: f64) -> f64 {
    const ROWS: u32 = 32;
    let [width, height] = sensor.lens.size();
    let (middle, top) = (0.5 * f64::from(width), (height - ROWS) / 2);
    let edge = |row: f64| middle + 0.123 + row / f64::from(ROWS);
    let light = exposed(sensor, |direction| {
        let pixel = sensor.lens.principal_point_px() + sensor.lens.focal_px() * direction;
        f32::from(u8::from(pixel.x > edge(pixel.y)))
    });
    // Distances from the edge, finest first: at column x of row y it is x − edge(y).
    let mut samples: Vec<(f64, f64)> = (top..top + ROWS)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| {
            let value = f64::from(light[(y * width + x) as usize][0]);
            (f64::from(x) - edge(f64::from(y)), value)
        })
        .collect();
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = Complex64::ZERO;
    for pair in samples.windows(2) {
        let place = 0.5 * (pair[0].0 + pair[1].0);
        sum += (pair[1].1 - pair[0].1) * Complex64::cis(-TAU * frequency * place);
    }
    sum.norm()
}

const FREQUENCIES: [f64; 5] = [0.05, 0.1, 0.2, 0.35, 0.5];

fn sinc(x: f64) -> f64 {
    (TAU * 0.5 * x).sin() / (TAU * 0.5 * x)
}

#[test]
fn an_edge_has_the_transfer_of_a_gaussian() {
    for (sigma_px, oversampling) in [(0.5, 4), (0.8, 3), (1.3, 2)] {
        let sensor = sensor([128, 64], Psf::Gaussian { sigma_px }, oversampling);
        sensor.check().expect("good");
        for f in FREQUENCIES {
            let wanted = (-0.5 * (TAU * sigma_px * f).powi(2)).exp() * sinc(f);
            let found = edge_transfer(&sensor, f);
            assert!(
                (found - wanted).abs() < 0.01 * wanted.max(0.1),
                "{sigma_px} {f}: {found} {wanted}"
            );
        }
    }
}

/// The transfer of a circular aperture, integrated as the overlap of two discs.
#[test]
fn an_edge_has_the_transfer_of_an_airy_disc() {
    let lambda_n_px = 0.8;
    let sensor = sensor([192, 64], Psf::Airy { lambda_n_px }, 4);
    sensor.check().expect("good");
    for f in FREQUENCIES {
        // Area that two unit discs share, 2 λ N f of their radius apart, by a sum over strips.
        let apart = lambda_n_px * f;
        let strips = 200_000;
        let width = (1.0 - apart) / f64::from(strips);
        let shared: f64 = (0..strips)
            .map(|k| {
                let x = apart + (f64::from(k) + 0.5) * width;
                4.0 * (1.0 - x * x).sqrt() * width
            })
            .sum();
        let wanted = shared / (0.5 * TAU) * sinc(f);
        let found = edge_transfer(&sensor, f);
        assert!(
            (found - wanted).abs() < 0.01 * wanted.max(0.1),
            "{f}: {found} {wanted}"
        );
    }
}

#[test]
fn an_edge_has_the_transfer_of_a_measured_kernel() {
    // A triangle of ± 1 pixel across, nothing down: sinc².
    let samples = [0.0, 1.0, 2.0, 3.0, 4.0, 3.0, 2.0, 1.0, 0.0];
    let mut kernel = vec![0.0; 81];
    kernel[36..45].copy_from_slice(&samples);
    let kernel = Kernel::new(9, kernel).expect("a kernel");
    let sensor = sensor([128, 64], Psf::Measured(kernel), 4);
    for f in FREQUENCIES {
        // Of samples at quarters, sin² (4x) / (16 sin² x), x = π f / 4.
        let x = TAU * f / 8.0;
        let wanted = ((4.0 * x).sin() / (4.0 * x.sin())).powi(2) * sinc(f);
        let found = edge_transfer(&sensor, f);
        assert!(
            (found - wanted).abs() < 0.01 * wanted.max(0.1),
            "{f}: {found} {wanted}"
        );
    }
}

#[test]
fn pixels_alone_have_the_transfer_of_their_area() {
    let sensor = sensor([128, 64], Psf::None, 8);
    for f in FREQUENCIES {
        let found = edge_transfer(&sensor, f);
        assert!(
            (found - sinc(f)).abs() < 0.012 * sinc(f),
            "{f}: {found} {}",
            sinc(f)
        );
    }
}

/// A point of the scene lands where the formula puts it, through all steps: blobs in the scene, and their centroids in the frame.
#[test]
fn blobs_land_where_the_formula_has_them() {
    let distortions = [
        Distortion::BrownConrady([-0.31, 0.12, 8e-4, -5e-4, 0.0, 0.0, 0.0, 0.0]),
        Distortion::Fisheye([-0.03, 0.01, -0.004, 0.0]),
    ];
    let mut worst = 0.0_f64;
    for distortion in distortions {
        for (psf, oversampling) in [
            (Psf::None, 3),
            (Psf::Gaussian { sigma_px: 0.7 }, 3),
            (Psf::Gaussian { sigma_px: 0.7 }, 4),
        ] {
            let mut sensor = sensor([160, 120], psf, oversampling);
            sensor.lens =
                Lens::new([160, 120], 0.6, 5.0, Some([82.3, 57.9]), distortion).expect("a lens");
            let targets: Vec<_> = [12.3, 60.7, 100.2, 148.6]
                .into_iter()
                .flat_map(|x| [11.1, 55.5, 106.9].map(|y| DVec2::new(x, y)))
                .collect();
            let directions: Vec<_> = targets
                .iter()
                .map(|pixel| sensor.lens.direction(*pixel).expect("within"))
                .collect();
            let width = 2.0 / sensor.lens.focal_px();
            let light = exposed(&sensor, |direction| {
                let of = |center: &DVec2| {
                    (-0.5 * ((direction - *center) / width).length_squared()).exp()
                };
                directions.iter().map(of).sum::<f64>() as f32
            });
            for (target, direction) in targets.iter().zip(&directions) {
                let (mut sum, mut moment) = (0.0, DVec2::ZERO);
                for y in (target.y as u32).saturating_sub(9)..(target.y as u32 + 10).min(120) {
                    for x in (target.x as u32).saturating_sub(9)..(target.x as u32 + 10).min(160) {
                        let value = f64::from(light[(y * 160 + x) as usize][0]);
                        sum += value;
                        moment += value * DVec2::new(f64::from(x), f64::from(y));
                    }
                }
                // Rays of the blob, each mapped by the formula and weighted by the area that it covers.
                let (mut weights, mut places) = (0.0, DVec2::ZERO);
                for k in 0..41 * 41 {
                    let step = DVec2::new(f64::from(k % 41 - 20), f64::from(k / 41 - 20)) * 0.25;
                    let ray = *direction + width * step;
                    let area = sensor.lens.distortion().jacobian(ray).determinant();
                    let weight = area * (-0.5 * step.length_squared()).exp();
                    weights += weight;
                    places += weight * sensor.lens.project(ray);
                }
                let wanted = places / weights;
                worst = worst.max((moment / sum - wanted).length());
            }
        }
    }
    eprintln!("blobs are off by {worst:.1e} px at most");
    assert!(worst < 0.005, "{worst}");
}

/// A star of constant flux gives the same electrons at any position, except for the foreshortened aperture: neither distortion nor point spread
/// creates or loses light.
#[test]
fn a_star_keeps_its_energy_through_the_lens() {
    for distortion in [
        Distortion::NONE,
        Distortion::BrownConrady([-0.31, 0.12, 8e-4, -5e-4, 0.0, 0.0, 0.0, 0.0]),
        Distortion::BrownConrady([0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        Distortion::Fisheye([-0.03, 0.01, -0.004, 0.0]),
    ] {
        for psf in [Psf::None, Psf::Gaussian { sigma_px: 0.7 }] {
            let mut sensor = sensor([96, 72], psf.clone(), 4);
            sensor.lens =
                Lens::new([96, 72], 0.6, 5.0, Some([49.3, 34.9]), distortion).expect("a lens");
            sensor.radiometry.cos4 = true;
            // The third band holds a sheet.
            let sheet = vec![[0.0, 0.0, 0.25]; 96 * 72];
            let sheet = sensor.mean_electrons(&sheet, 1.0).expect("fits");
            let mut fluxes = Vec::new();
            for target in [9.3, 36.7, 49.3, 87.6]
                .into_iter()
                .flat_map(|x| [9.1, 34.9, 62.9].map(|y| DVec2::new(x, y)))
            {
                let center = sensor.lens.direction(target).expect("within");
                let width = 1.5 / sensor.lens.focal_px();
                let cos = |direction: DVec2| (1.0 + direction.length_squared()).sqrt().recip();
                // A small disc whose radiance is that of a constant flux: a solid angle is cos³ θ of the plane's area.
                let light = exposed(&sensor, |direction| {
                    let away = (direction - center) / width;
                    (0.01 * (-0.5 * away.length_squared()).exp() / cos(direction).powi(3)) as f32
                });
                let electrons = sensor.mean_electrons(&light, 1.0).expect("fits");
                let all: f64 = electrons.iter().zip(&sheet).map(|(a, b)| a - b).sum();
                fluxes.push(all / cos(center));
            }
            let [least, most] = [f64::min, f64::max].map(|of| fluxes.iter().copied().reduce(of));
            let (least, most) = (least.expect("some"), most.expect("some"));
            eprintln!("{distortion:?}, {psf:?}: {:.4}", most / least);
            assert!(most / least < 1.005, "{distortion:?} {psf:?}: {fluxes:?}");
        }
    }
}

/// Mean electrons of a white sheet follow the radiometric equation; with a mosaic each pixel has its own band.
#[test]
fn a_white_sheet_makes_the_electrons_of_the_equation() {
    let mut sensor = sensor([8, 6], Psf::None, 1);
    let light = vec![[1.0, 0.5, 2.0]; 48];
    let photons = sensor.radiometry.photons(&sensor.lens, 1.0);
    let bands = [
        photons[0] * 0.4,
        0.5 * photons[1] * 0.5,
        2.0 * photons[2] * 0.3,
    ];
    let mono = sensor.mean_electrons(&light, 1.0).expect("fits");
    assert!(
        mono.iter()
            .all(|e| (e - bands.iter().sum::<f64>()).abs() < 1e-6)
    );
    sensor.mosaic = Mosaic::Grbg;
    let bayer = sensor.mean_electrons(&light, 1.0).expect("fits");
    for (pixel, band) in [(0, 1), (1, 0), (8, 2), (9, 1)] {
        assert!((bayer[pixel] - bands[band]).abs() < 1e-6, "{pixel}");
    }
    sensor
        .mean_electrons(&light[1..], 1.0)
        .expect_err("one pixel short");
}

#[test]
fn a_narrow_point_spread_is_rejected_with_the_oversampling_that_works() {
    let rejection = |psf, oversampling| {
        let error = sensor([8, 8], psf, oversampling)
            .check()
            .expect_err("rejected");
        assert_eq!(error.key(), "psf");
        error.to_string()
    };
    let narrow = rejection(Psf::Gaussian { sigma_px: 0.25 }, 3);
    assert!(narrow.contains("oversampling of 4"), "{narrow}");
    let airy = rejection(Psf::Airy { lambda_n_px: 0.5 }, 3);
    assert!(airy.contains("oversampling of 4"), "{airy}");
    let none = rejection(Psf::Airy { lambda_n_px: 0.05 }, 3);
    assert!(none.contains("psf = \"none\""), "{none}");
    sensor([8, 8], Psf::Airy { lambda_n_px: 0.5 }, 4)
        .check()
        .expect("works");
    sensor([8, 8], Psf::Gaussian { sigma_px: 0.25 }, 4)
        .check()
        .expect("works");
}

/// Vizard's numbers of a camera: 60° over 100 rows, 0.4 mm, f/2.
#[test]
fn a_sensor_fits_a_simulators_camera() {
    let mut airy = sensor([128, 64], Psf::Airy { lambda_n_px: 1.0 }, 4);
    airy.radiometry.f_number = 4.0;
    let (before, fov_rad) = (airy.lens.pixel_pitch_um(), 60.0_f64.to_radians());
    let fitted = airy.fitted([150, 100], fov_rad, Some(0.4), Some(2.0));
    let fitted = fitted.expect("fits");
    // 50 pixels over tan 30°.
    assert!((fitted.lens.focal_px() - 50.0 * 3.0_f64.sqrt()).abs() < 1e-9);
    assert_eq!(fitted.lens.principal_point_px(), DVec2::new(74.5, 49.5));
    assert_eq!(
        (fitted.lens.focal_length_mm(), fitted.radiometry.f_number),
        (0.4, 2.0)
    );
    let Psf::Airy { lambda_n_px } = fitted.psf else {
        panic!("{:?}", fitted.psf);
    };
    let wanted = 0.5 * before / fitted.lens.pixel_pitch_um();
    assert!((lambda_n_px - wanted).abs() < 1e-12, "{lambda_n_px}");
    let error = airy.fitted([150, 100], fov_rad, None, Some(-1.0));
    assert_eq!(error.expect_err("no aperture").key(), "f_number");
}

/// Bands of rows are the whole frame.
#[test]
fn rows_that_are_exposed_apart_are_the_same() {
    let mut sensor = sensor([60, 40], Psf::Gaussian { sigma_px: 0.6 }, 3);
    let distortion = Distortion::BrownConrady([-0.2, 0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    sensor.lens = Lens::new([60, 40], 0.3, 5.0, None, distortion).expect("a lens");
    let scene = |d: DVec2| (0.5 + 0.4 * (9.0 * d.x).sin() * (7.0 * d.y).cos()) as f32;
    let whole = exposed(&sensor, scene);
    let frame = sensor.pinhole(13..20).expect("a frame");
    let step = (frame.rect.most - frame.rect.least) / DVec2::from(frame.size.map(f64::from));
    let light: Vec<_> = (0..frame.len() as u32)
        .map(|i| {
            let part = DVec2::new(f64::from(i % frame.size[0]), f64::from(i / frame.size[0])) + 0.5;
            let light = scene(frame.rect.least + part * step);
            [light, 0.5 * light, 0.25, 1.0]
        })
        .collect();
    let picture = PinholePicture::new(frame, &light).expect("fits");
    let band = sensor.expose(13..20, &picture).expect("exposes");
    for (apart, together) in band.iter().zip(&whole[13 * 60..]) {
        assert!(
            (apart[0] - together[0]).abs() < 1e-3,
            "{apart:?} {together:?}"
        );
    }
}
