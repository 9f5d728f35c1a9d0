//! Lenses against OpenCV, and those that fold.

use super::*;

const OPENCV: &str = include_str!("../tests/data/opencv_project_points.csv");

fn lens_of(model: &str, focal_px: f64, principal: [f64; 2], coefficients: &[f64]) -> Lens {
    let take = |n: usize| coefficients.get(n).copied().unwrap_or(0.0);
    let distortion = match model {
        "fisheye" => Distortion::Fisheye(std::array::from_fn(take)),
        _ => Distortion::BrownConrady(std::array::from_fn(take)),
    };
    Lens::new(
        [1280, 1024],
        0.01 * focal_px,
        10.0,
        Some(principal),
        distortion,
    )
    .expect("a lens")
}

/// Every point of the table, forwards and back.
#[test]
fn pixels_are_those_of_opencv() {
    let (mut rows, mut worst, mut worst_back) = (0, 0.0_f64, 0.0_f64);
    for line in OPENCV.lines().skip(2) {
        let fields: Vec<_> = line.split(',').collect();
        let number = |n: usize| fields[n].parse::<f64>().expect("a number");
        let coefficients: Vec<f64> = fields[4]
            .split(' ')
            .map(|k| k.parse().expect("a number"))
            .collect();
        let lens = lens_of(fields[0], number(1), [number(2), number(3)], &coefficients);
        let direction = DVec2::new(number(5), number(6));
        let pixel = DVec2::new(number(7), number(8));
        worst = worst.max(lens.project(direction).distance(pixel));
        rows += 1;
        // Beyond the sensor there need be no inverse.
        if lens.clamped(pixel) == pixel {
            let back = lens.direction(pixel).expect("within");
            worst_back = worst_back.max(number(1) * back.distance(direction));
        }
    }
    eprintln!("{rows} points of OpenCV: {worst:.1e} px, inverse {worst_back:.1e} px");
    assert!(
        rows == 150 && worst < 1e-8 && worst_back < 1e-7,
        "{rows} {worst} {worst_back}"
    );
}

/// Brown–Conrady with k1 alone folds where 1 + 3 k1 r² = 0.
#[test]
fn a_lens_that_folds_is_rejected_with_the_scale_that_works() {
    let make = |k1: f64| {
        let distortion = Distortion::BrownConrady([k1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        Lens::new([800, 600], 5.0, 10.0, None, distortion)
    };
    // The corner is at 500 px, r' = 1 of the focal length of 500 px: r (1 + k1 r²) reaches 1 at most where 1/√(−3 k1) · 2/3 = 1,
    // k1 = −4/27.
    let error = make(-0.3).expect_err("folds");
    let SensorError::Folds { scale, .. } = error else {
        panic!("{error}");
    };
    let wanted = 4.0 / 27.0 / 0.3;
    assert!((scale - wanted).abs() < 0.003, "{scale} {wanted}");
    make(-0.3 * scale).expect("the scale works");
    make(-0.3 * (scale + 0.01)).expect_err("a greater one does not");
    assert_eq!(make(-0.3).expect_err("folds").key(), "distortion");
}

#[test]
fn a_field_too_wide_is_rejected_with_the_focal_length_that_works() {
    let make = |focal_length_mm: f64| {
        Lens::new(
            [1000, 1000],
            focal_length_mm,
            10.0,
            None,
            Distortion::Fisheye([0.0; 4]),
        )
    };
    let error = make(4.0).expect_err("101°");
    let SensorError::FieldTooWide {
        half_field_deg,
        focal_mm,
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert!((half_field_deg - 101.3).abs() < 0.1, "{half_field_deg}");
    make(focal_mm).expect("works");
    let plain =
        |focal_length_mm: f64| Lens::new([640, 480], focal_length_mm, 5.0, None, Distortion::NONE);
    // 81.5° at the corners.
    let error = plain(0.3).expect_err("beyond 80°");
    let SensorError::FieldTooWide { focal_mm, .. } = error else {
        panic!("{error}");
    };
    plain(focal_mm).expect("works");
}

#[test]
fn a_sensor_of_too_many_pixels_is_rejected() {
    let make = |side: u32| Lens::new([side, side], 50.0, 10.0, None, Distortion::NONE);
    make(8192).expect("works");
    let error = make(8193).expect_err("too many");
    assert!(
        error.key() == "size" && error.to_string().contains("67108864"),
        "{error}"
    );
}

/// The determinant by differences, everywhere in the picture.
#[test]
fn jacobians_are_the_slopes() {
    let models = [
        Distortion::BrownConrady([-0.28, 0.095, 0.0007, -0.0004, -0.013, 0.02, 0.01, -0.003]),
        Distortion::Fisheye([-0.012, 0.031, -0.027, 0.0072]),
    ];
    for model in models {
        for point in [
            DVec2::ZERO,
            DVec2::new(1e-6, 0.0),
            DVec2::new(0.3, -0.5),
            DVec2::new(-1.0, 0.2),
        ] {
            let h = 1e-5;
            let slope = |step: DVec2| {
                (model.distort(point + step) - model.distort(point - step)) / (2.0 * h)
            };
            let found = model.jacobian(point);
            let off = (found.x_axis - slope(DVec2::X * h)).length()
                + (found.y_axis - slope(DVec2::Y * h)).length();
            assert!(off < 1e-8, "{model:?} {point}: {off}");
        }
    }
}

#[test]
fn the_bounds_hold_all_rays() {
    let distortion = Distortion::BrownConrady([-0.25, 0.08, 1e-3, -2e-3, 0.0, 0.0, 0.0, 0.0]);
    let lens = Lens::new([640, 480], 4.0, 10.0, Some([300.0, 250.0]), distortion).expect("a lens");
    let rect = lens.bounds(100..140, 2.0).expect("bounds");
    for y in 98..142 {
        for x in 0..640 {
            let direction = lens
                .direction(DVec2::new(f64::from(x), f64::from(y)))
                .expect("within");
            let slack = 0.1 / lens.focal_px();
            assert!(
                direction.cmpge(rect.least - slack).all()
                    && direction.cmple(rect.most + slack).all(),
                "{x} {y}"
            );
        }
    }
}
