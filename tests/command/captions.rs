//! Captions in images and films, and not in measurements.

use crate::{Place, SMALL, names, words};
use std::path::Path;

const CAPTIONS: &str = "[[caption]]\ntext = \"T+{elapsed}\"\nsize_px = 9\nplace = \"bottom-right\"\n\
                        [[caption]]\nimage = \"logo.png\"\nplace = \"top-left\"\nplate_opacity = 0\nwidth_px = 8\n";

/// The small scene, and the same with captions.
fn place() -> Place {
    let place = Place::new();
    place.scene("captions.toml", &format!("{SMALL}{CAPTIONS}"));
    let logo = image::RgbImage::from_pixel(16, 8, image::Rgb([255, 0, 255]));
    logo.save(place.path("logo.png")).expect("written");
    place
}

fn picture(path: &Path) -> image::RgbImage {
    image::open(path).expect("a picture").to_rgb8()
}

#[test]
fn captions_are_in_films() {
    let place = place();
    place.succeed(&["play", "captions.toml", "--frames", "film"]);
    let names = names(&place.path("film")).into_iter();
    let frames = names.filter(|name| name.ends_with(".png"));
    let frames: Vec<_> = frames
        .map(|name| picture(&place.path("film").join(name)))
        .collect();
    assert_eq!(frames.len(), 4);
    for frame in &frames {
        let magenta = frame.pixels().filter(|pixel| pixel.0 == [255, 0, 255]);
        assert_eq!(magenta.count(), 32);
    }
}

#[test]
fn captions_are_left_out_of_light_and_transparent_images_with_one_notice() {
    let place = place();
    for (options, ending) in [
        (&["--format", "exr"][..], "exr"),
        (&["--alpha"], "png"),
        (&["--alpha", "--format", "png16"], "png"),
    ] {
        let notices = |scene: &str, folder: &str| {
            let film = ["play", scene, "--frames", folder, "--overwrite"];
            let said = words(&place.succeed(&[&film[..], options].concat()));
            said.matches("captions are left out").count()
        };
        assert_eq!(notices("small.toml", "plain"), 0, "{options:?}");
        assert_eq!(notices("captions.toml", "film"), 1, "{options:?}");
        let frames = names(&place.path("plain")).into_iter();
        let frames: Vec<_> = frames.filter(|name| name.ends_with(ending)).collect();
        assert_eq!(frames.len(), 4);
        for frame in &frames {
            let bytes = |folder: &str| std::fs::read(place.path(folder).join(frame));
            assert_eq!(
                bytes("plain").expect("there"),
                bytes("film").expect("there")
            );
        }
        let still = ["frame", "captions.toml", "-o"];
        let file = format!("still.{ending}");
        let output = place.succeed(&[&still[..], &[file.as_str()], options].concat());
        let said = words(&output);
        assert_eq!(said.matches("captions are left out").count(), 1, "{said}");
    }
}

#[test]
fn captions_are_in_pictures_and_not_in_what_is_measured() {
    let place = place();
    for scene in ["small", "captions"] {
        let of = |rest: &str| format!("{scene}{rest}");
        place.succeed(&[
            "frame",
            &of(".toml"),
            "-o",
            &of(".png"),
            "--radiance",
            &of(".npy"),
            "--truth",
            &of(".truth"),
        ]);
    }
    let [plain, written] = ["small.png", "captions.png"].map(|name| picture(&place.path(name)));
    let mut counts = [0; 2];
    for (x, y, pixel) in plain.enumerate_pixels() {
        if *written.get_pixel(x, y) == *pixel {
            continue;
        }
        let is_logo = x < 14 && y < 10;
        let is_text = y >= 18;
        assert!(is_logo || is_text, "{x} {y}");
        counts[usize::from(is_text)] += 1;
    }
    // The logo covers 8 × 4 pixels. The plate of the text is of 9 pixels high letters and is darker than the sky behind it nowhere.
    assert_eq!(counts[0], 32);
    assert!(counts[1] > 60, "{counts:?}");
    let magenta = written.pixels().filter(|pixel| pixel.0 == [255, 0, 255]);
    assert_eq!(magenta.count(), 32);
    let bytes = |name: &str| std::fs::read(place.path(name)).expect("written");
    assert_eq!(bytes("small.npy"), bytes("captions.npy"));
    let mut layers = 0;
    for entry in std::fs::read_dir(place.path("small.truth")).expect("a folder") {
        let name = entry.expect("an entry").file_name();
        let name = name.to_str().expect("a name");
        if name.ends_with(".npy") {
            layers += 1;
            let layer = |scene: &str| bytes(&format!("{scene}.truth/{name}"));
            assert_eq!(layer("small"), layer("captions"), "{name}");
        }
    }
    assert!(layers > 2, "{layers} layers");
}
