use super::*;
use crate::scene::Scene;
use egui::{Context, RawInput, Shape};
use std::path::Path;
use terrella::frames::utc_from_rfc3339;

fn scene(text: &str) -> Scene {
    let path = Path::new("test.toml");
    Scene::from_toml(text, path).unwrap_or_else(|error| panic!("{error}"))
}

fn epoch(text: &str) -> Epoch {
    utc_from_rfc3339(text).expect("a date")
}

#[test]
fn values_are_those_of_the_instant() {
    let state = CaptionState {
        epoch: epoch("2018-01-16T01:02:03.456Z"),
        start: epoch("2018-01-15T00:00:00Z"),
        satellite: Some("ISS (ZARYA)"),
        place: Geodetic::from_degrees(-51.236, 5.004, 420_120.0),
        speed_m_s: Some(7658.12),
    };
    let text = |value| {
        let mut text = String::new();
        state.write(value, &mut text);
        text
    };
    assert_eq!(text(CaptionValue::Time), "2018-01-16 01:02:03 UTC");
    assert_eq!(text(CaptionValue::Date), "2018-01-16");
    assert_eq!(text(CaptionValue::Clock), "01:02:03");
    assert_eq!(text(CaptionValue::Elapsed), "1d 01:02:03");
    assert_eq!(text(CaptionValue::Satellite), "ISS (ZARYA)");
    assert_eq!(text(CaptionValue::Lat), "51.24° S");
    assert_eq!(text(CaptionValue::Lon), "5.00° E");
    assert_eq!(text(CaptionValue::AltitudeKm), "420.1");
    assert_eq!(text(CaptionValue::SpeedKmS), "7.658");
}

/// At thirty frames a second, frame times are not whole nanoseconds.
#[test]
fn a_second_begins_with_its_frame() {
    let start = epoch("2018-01-15T00:00:00Z");
    let state = CaptionState {
        epoch: start + 60.0 * Unit::Second - 1.0 * Unit::Nanosecond,
        start,
        satellite: None,
        place: Geodetic::from_degrees(0.0, 0.0, 0.0),
        speed_m_s: None,
    };
    let mut text = String::new();
    state.write(CaptionValue::Clock, &mut text);
    state.write(CaptionValue::Elapsed, &mut text);
    state.write(CaptionValue::Satellite, &mut text);
    assert_eq!(text, "00:01:0000:01:00–");
    assert_eq!(duration_text(-5.5), "−00:00:05");
    assert_eq!(duration_text(f64::NAN), "00:00:00");
}

/// The rectangles of plates and of texts, and whether captions had their size.
fn laid_out(text: &str, size: Vec2) -> (Vec<Rect>, Vec<Rect>, bool) {
    let captions = scene(text).captions.into_iter().map(|table| {
        let CaptionContent::Text {
            parts,
            size_px,
            color,
        } = &table.content
        else {
            panic!("texts alone");
        };
        let text = parts.iter().map(|part| match part {
            CaptionPart::Text(text) => text.clone(),
            CaptionPart::Value(_) => "a value".to_owned(),
        });
        Caption::of(
            &table,
            Shown::Text {
                parts: parts.clone(),
                size_px: *size_px,
                color: *color,
                text: text.collect(),
            },
        )
    });
    painted(&captions.collect::<Vec<_>>(), size)
}

/// The same of these captions.
fn painted(captions: &[Caption], size: Vec2) -> (Vec<Rect>, Vec<Rect>, bool) {
    let captions: Vec<_> = captions.iter().collect();
    let screen = Rect::from_min_size(Pos2::ZERO, size);
    let input = RawInput {
        screen_rect: Some(screen),
        ..RawInput::default()
    };
    let mut fits = true;
    let mut output = Context::default().run_ui(input, |ui| {
        let painter = ui.ctx().layer_painter(egui::LayerId::background());
        fits = paint(&painter, screen, screen, &captions);
    });
    output.textures_delta.clear();
    let (mut plates, mut texts) = (Vec::new(), Vec::new());
    for shape in output.shapes {
        match shape.shape {
            Shape::Rect(rect) => plates.push(rect.rect),
            Shape::Text(text) => texts.push(text.visual_bounding_rect()),
            _ => {}
        }
    }
    (plates, texts, fits)
}

const PLACES: [&str; 8] = [
    "top-left",
    "top",
    "top-right",
    "left",
    "right",
    "bottom-left",
    "bottom",
    "bottom-right",
];

#[test]
fn captions_stand_where_they_should_and_off_each_other() {
    let size = Vec2::new(1280.0, 720.0);
    for (place, x, y) in [
        ("top-left", 0.0, 0.0),
        ("top", 0.5, 0.0),
        ("right", 1.0, 0.5),
        ("bottom", 0.5, 1.0),
        ("bottom-right", 1.0, 1.0),
    ] {
        let text = format!("[[caption]]\ntext = \"Launch\"\nplace = \"{place}\"\n");
        let (plates, texts, fits) = laid_out(&text, size);
        assert!(fits && plates.len() == 1 && texts.len() == 1, "{place}");
        let at = plates[0].center();
        let off = (at.x - x * size.x).abs() / size.x + (at.y - y * size.y).abs() / size.y;
        assert!(off < 0.15, "{place}: {at}");
        assert!(plates[0].contains_rect(texts[0]), "{place}");
    }
    let words = "The ascending node over the Pacific".repeat(2);
    let all: String = PLACES
        .iter()
        .chain(&PLACES)
        .map(|place| format!("[[caption]]\ntext = \"{words}\"\nplace = \"{place}\"\n"))
        .collect();
    let (plates, texts, fits) = laid_out(&all, size);
    assert!(fits);
    assert_eq!((plates.len(), texts.len()), (16, 16));
    for (index, plate) in plates.iter().enumerate() {
        for other in &plates[..index] {
            assert!(
                !plate.shrink(0.5).intersects(*other),
                "{plate} over {other}"
            );
        }
    }
}

#[test]
fn a_long_text_is_wrapped_then_smaller_and_never_off_the_picture() {
    let long = "supercalifragilistic ".repeat(45);
    let one_word = "x".repeat(900);
    for (size, whole) in [
        (Vec2::new(1280.0, 720.0), true),
        (Vec2::new(320.0, 180.0), false),
        (Vec2::new(64.0, 36.0), false),
        (Vec2::new(8.0, 4.0), false),
    ] {
        for words in [&long, &one_word] {
            for place in PLACES {
                let text = format!("[[caption]]\ntext = \"{words}\"\nplace = \"{place}\"\n");
                let (plates, texts, fits) = laid_out(&text, size);
                assert_eq!(fits, whole, "{place} {size}");
                let screen = Rect::from_min_size(Pos2::ZERO, size);
                for rect in plates.iter().chain(&texts) {
                    assert!(screen.contains_rect(*rect), "{place}: {rect} off {screen}");
                }
            }
        }
    }
}

#[test]
fn no_plate_is_drawn_at_opacity_0() {
    let text = "[[caption]]\ntext = \"Launch\"\nplate_opacity = 0\nsize_px = 40\n";
    let (plates, texts, _) = laid_out(text, Vec2::new(1280.0, 720.0));
    assert!(plates.is_empty());
    assert!((25.0..45.0).contains(&texts[0].height()), "{}", texts[0]);
}

/// A plate, on it the title and a patch of colour with its words for each class; also in the smallest window. It stands off captions of
/// its place.
#[test]
fn a_legend_has_its_classes_on_its_plate() {
    let scale = CoverageScale::of_count(6);
    let classes = scale.classes.len();
    assert_eq!(classes, 6);
    let legend = CoverageLegend {
        scale,
        place: CaptionPlace::BottomRight,
    };
    let beside = CaptionTable {
        content: CaptionContent::Text {
            parts: Vec::new(),
            size_px: None,
            color: [255; 3],
        },
        place: CaptionPlace::BottomRight,
        plate_opacity: 0.5,
        times: CaptionTimes::ALWAYS,
    };
    let text = Shown::Text {
        parts: Vec::new(),
        size_px: None,
        color: [255; 3],
        text: "Views of the space station".to_owned(),
    };
    let captions = [Caption::of(&beside, text), Caption::legend(legend)];
    for size in [Vec2::new(640.0, 360.0), Vec2::new(3840.0, 2160.0)] {
        let (plates, texts, fits) = painted(&captions, size);
        assert!(fits, "{size}");
        assert_eq!((plates.len(), texts.len()), (2 + classes, 2 + classes));
        let [caption, legend] = [plates[0], plates[1]];
        assert!(
            !caption.shrink(0.5).intersects(legend),
            "{caption} {legend}"
        );
        for inside in plates[2..].iter().chain(&texts[1..]) {
            assert!(legend.contains_rect(*inside), "{inside} off {legend}");
        }
        for (patch, words) in plates[2..].iter().zip(&texts[2..]) {
            assert!(patch.right() < words.left());
            assert!(patch.y_range().contains(words.center().y));
        }
    }
}

#[test]
fn a_caption_appears_fades_and_disappears() {
    let text = |keys: &str| format!("[[caption]]\ntext = \"a\"\n{keys}");
    let times = |keys: &str| scene(&text(keys)).captions[0].times;
    let faded = times("start_s = 10\nend_s = 20\nfade_s = 2");
    let expected = [
        (9.99, 0.0),
        (10.0, 0.0),
        (11.0, 0.5),
        (12.0, 1.0),
        (15.0, 1.0),
    ];
    for (time_s, opacity) in expected {
        assert_eq!(faded.opacity(time_s), opacity, "{time_s}");
    }
    assert_eq!((faded.opacity(19.0), faded.opacity(20.0)), (0.5, 0.0));
    let hard = times("start_s = 10");
    assert_eq!((hard.opacity(9.99), hard.opacity(10.0)), (0.0, 1.0));
    assert_eq!(hard.opacity(1e9), 1.0);
    assert_eq!(times(""), CaptionTimes::ALWAYS);
    let rejected = |keys: &str| {
        let read = Scene::from_toml(&text(keys), Path::new("test.toml"));
        read.expect_err("rejected").to_string()
    };
    let said = rejected("start_s = 5\nend_s = 5");
    assert!(said.contains("must be more than start_s, 5"), "{said}");
    let said = rejected("fade_s = 5");
    assert!(said.contains("needs start_s or end_s"), "{said}");
}
