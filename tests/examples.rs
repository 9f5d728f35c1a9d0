//! The hosts of `examples/`, run: each opens its own device and draws the starter pack's Earth.

#[allow(dead_code)]
#[path = "../examples/embed.rs"]
mod embed;
#[allow(dead_code)]
#[path = "../examples/minimal.rs"]
mod minimal;
#[allow(dead_code)]
#[path = "../examples/orbit.rs"]
mod orbit;
#[allow(dead_code)]
#[path = "../examples/views.rs"]
mod views;

use image::RgbaImage;

/// Whether the picture's middle is lit ground and its corners are space.
#[track_caller]
fn shows_the_earth(picture: &RgbaImage) {
    let (width, height) = picture.dimensions();
    let brightest = |x, y| picture.get_pixel(x, y).0[..3].iter().max().copied();
    assert!(brightest(width / 2, height / 2) > Some(40));
    for (x, y) in [(0, 0), (width - 1, 0), (0, height - 1)] {
        assert_eq!(brightest(x, y), Some(0), "({x}, {y})");
    }
}

#[test]
fn the_smallest_host_draws_the_earth() {
    let rgba = pollster::block_on(minimal::draw()).expect("a picture");
    let (width, height) = minimal::SIZE;
    shows_the_earth(&RgbaImage::from_raw(width, height, rgba).expect("of that size"));
}

#[test]
fn a_host_with_its_own_formats_units_and_axes_draws_the_earth() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    embed::draw(1, folder.path()).expect("a picture");
    let picture = image::open(folder.path().join("embed.png")).expect("a PNG");
    let picture = picture.into_rgb8();
    let lit = picture.pixels().filter(|pixel| pixel[2] > 40).count();
    // The limb with its air crosses the image, and the ground below it is in daylight.
    assert!(lit > picture.pixels().len() / 10, "{lit} pixels are lit");
}

#[test]
fn four_views_of_one_earth_are_drawn_side_by_side() {
    let rgba = pollster::block_on(views::draw()).expect("a picture");
    let (width, height) = views::SIZE;
    let picture = RgbaImage::from_raw(width, height, rgba).expect("of that size");
    let lit = |x: u32, y: u32| {
        let (x, y) = (x * width / 2, y * height / 2);
        let pixels = (0..height / 2).flat_map(|dy| (0..width / 2).map(move |dx| (x + dx, y + dy)));
        let is_lit = |(x, y): &(u32, u32)| picture.get_pixel(*x, *y).0[..3].iter().any(|c| *c > 30);
        f64::from(pixels.filter(is_lit).count() as u32) / f64::from(width * height / 4)
    };
    // The telescope sees ground alone; the whole disc has space about it, the others the limb.
    assert!(lit(0, 1) > 0.99, "telescope {}", lit(0, 1));
    for (x, y, name) in [(0, 0, "station"), (1, 0, "disc"), (1, 1, "limb")] {
        assert!((0.15..0.95).contains(&lit(x, y)), "{name} {}", lit(x, y));
    }
}

#[test]
fn a_satellite_flies_before_the_stars() {
    let rgba = pollster::block_on(orbit::draw()).expect("a picture");
    let (width, height) = orbit::SIZE;
    let picture = RgbaImage::from_raw(width, height, rgba).expect("of that size");
    // The trail's colour, over the ground and beyond it.
    let is_trail = |p: &image::Rgba<u8>| p[0] > 220 && (150..240).contains(&p[1]) && p[2] < 110;
    let trail = picture.pixels().filter(|pixel| is_trail(pixel)).count();
    let corner = (0..height / 8).flat_map(|y| (0..width / 8).map(move |x| (x, y)));
    let stars = corner.filter(|(x, y)| picture.get_pixel(*x, *y)[2] > 12);
    println!("{trail} pixels of the trail");
    assert!(trail > 200 && stars.count() > 2, "{trail}");
}
