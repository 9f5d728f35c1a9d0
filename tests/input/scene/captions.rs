//! `[[caption]]`.

use super::{Bad, Folder, scene};
use std::path::Path;
use terrella_play::scene::{CaptionContent, CaptionPart, CaptionPlace, CaptionValue, Scene};

#[rustfmt::skip]
const BAD: &[Bad] = &[
    ("[[caption]]\nplace = \"top\"", 2, &["[caption] text: ", "needs its text"]),
    ("[[caption]]\ntext = \" \"", 2, &["[caption] text", "must not be empty"]),
    ("[[caption]]\ntext = \"{tim}\"", 2, &["[caption] text", "unknown value {tim}; did you mean {time}?", "{altitude_km}"]),
    ("[[caption]]\ntext = \"{velocity!}\"", 2, &["[caption] text", "unknown value {velocity!}", "{speed_km_s}"]),
    ("[[caption]]\ntext = \"{time\"", 2, &["[caption] text", "without its other half", "{{"]),
    ("[[caption]]\ntext = \"time}\"", 2, &["[caption] text", "without its other half"]),
    ("[[caption]]\ntext = \"A\"\nplace = \"center\"", 3, &["[caption] place = \"center\"", "\"top-left\"", "\"bottom-right\""]),
    ("[[caption]]\ntext = \"A\"\nsize_px = 5", 3, &["[caption] size_px = 5", "6 to 200"]),
    ("[[caption]]\ntext = \"A\"\nplate_opacity = 1.5", 3, &["[caption] plate_opacity", "0 to 1"]),
    ("[[caption]]\ntext = \"A\"\ncolor = \"white\"", 3, &["[caption] color", "six hexadecimal digits"]),
    ("[[caption]]\ntext = \"A\"\nwidth_px = 20", 3, &["[caption] width_px", "image ="]),
    ("[[caption]]\nimage = \"none.png\"", 2, &["[caption] image", "none.png", "cannot be opened"]),
    ("[[caption]]\ntext = \"A\"\nimage = \"none.png\"", 3, &["[caption] image", "a text or an image"]),
    ("[[caption]]\ntext = \"A\"\ncolour = \"#ffffff\"", 3, &["[caption] colour:", "did you mean color?"]),
    ("[title]\ntext = \"A\"", 1, &["[title]:", "did you mean [caption]?"]),
    ("[camera]\nmode = \"geodetic\"\n[[caption]]\ntext = \"{satellite}\"", 4, &["[caption] text", "has none", "[orbit]"]),
];

#[test]
fn what_is_wrong_is_rejected_where_it_stands() {
    Folder::new().rejects(BAD);
}

#[test]
fn captions_have_defaults_and_what_a_scene_says() {
    assert!(scene("").captions.is_empty());
    let scene = scene(
        "[[caption]]\ntext = \"{satellite} at {altitude_km} km {{now}}\"\n\
         [[caption]]\ntext = \"B\"\nplace = \"top\"\nsize_px = 30\ncolor = \"#0180ff\"\nplate_opacity = 0\n",
    );
    let [first, second] = scene.captions.as_slice() else {
        panic!("{:?}", scene.captions);
    };
    let text = |text: &str| CaptionPart::Text(text.to_owned());
    assert_eq!(
        first.content,
        CaptionContent::Text {
            parts: vec![
                CaptionPart::Value(CaptionValue::Satellite),
                text(" at "),
                CaptionPart::Value(CaptionValue::AltitudeKm),
                text(" km {now}"),
            ],
            size_px: None,
            color: [255; 3],
        }
    );
    assert_eq!(first.place, CaptionPlace::BottomLeft);
    assert_eq!(
        second.content,
        CaptionContent::Text {
            parts: vec![text("B")],
            size_px: Some(30.0),
            color: [1, 128, 255],
        }
    );
    assert_eq!(second.plate_opacity, 0.0);
    let summary = scene.summary();
    assert_eq!(summary.matches("\n[[caption]]\n").count(), 2, "{summary}");
    assert!(
        summary.contains("\n  caption        a text at top of the picture"),
        "{summary}"
    );
}

#[test]
fn there_are_at_most_32() {
    let many = "[[caption]]\ntext = \"A\"\n".repeat(33);
    let error = Scene::from_toml(&many, Path::new("a.toml")).expect_err("too many");
    let said = error.to_string();
    let expected =
        "a.toml:66: [caption] text = \"A\": a scene has at most 32 captions and this one 33";
    assert!(said.starts_with(expected), "{said}");
}
