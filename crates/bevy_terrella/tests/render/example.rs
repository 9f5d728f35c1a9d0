//! Runs the examples.

use crate::craft;
use crate::native::Native;
use crate::sensor_example;

#[test]
fn a_craft_is_drawn_before_the_earth() {
    if Native::open().is_none() {
        return;
    }
    let picture = craft::still((320, 180)).expect("a picture");
    let pixels = picture.bytes.as_chunks::<4>().0;
    let part = |is_it: fn(&[u8; 4]) -> bool| {
        let found = pixels.iter().filter(|pixel| is_it(pixel)).count();
        found as f64 / pixels.len() as f64
    };
    // The craft's panels are deep blue, the daylit Earth below is lighter, and space above is black.
    let panels = part(|[r, g, b, _]| *b > 90 && *r < 40 && *g < 55);
    let (lit, space) = (part(|p| p[2] > 50), part(|p| p[..3] == [0, 0, 0]));
    assert!((0.01..0.15).contains(&panels), "panels {panels}");
    assert!((0.2..0.7).contains(&lit), "lit {lit}");
    assert!((0.2..0.7).contains(&space), "space {space}");
}

#[test]
fn a_raw_frame_is_taken() {
    if Native::open().is_none() {
        return;
    }
    let sensor = sensor_example::sensor([160, 120]).expect("a sensor");
    let frame = sensor_example::frame(sensor).expect("a frame");
    let mut numbers = frame.data;
    numbers.sort_unstable();
    let part = |part: usize| numbers[numbers.len() * part / 100];
    // Bias and noise in space, haze and land below the horizon, no saturation.
    assert!((60..70).contains(&part(5)), "{}", part(5));
    assert!((150..4000).contains(&part(95)), "{}", part(95));
}

#[test]
fn code_on_the_page_stands_in_the_examples() {
    let page = include_str!("../../../../docs/embedding/bevy.md");
    let examples = [
        include_str!("../../examples/orbit.rs"),
        include_str!("../../examples/sensor.rs"),
        include_str!("../../examples/smallest.rs"),
        include_str!("../../examples/craft/main.rs"),
    ];
    let blocks: Vec<_> = page.split("```rust\n").skip(1).collect();
    assert!(blocks.len() >= 2, "{} blocks of Rust", blocks.len());
    for block in blocks {
        let (block, _) = block.split_once("```").expect("an end of the block");
        let lines = |text: &'static str| text.lines().map(str::trim).filter(|l| !l.is_empty());
        let stands_in = |example: &'static str| {
            let mut rest = lines(example);
            lines(block).all(|line| rest.any(|other| other == line))
        };
        assert!(
            examples.into_iter().any(stands_in),
            "not in an example:\n{block}"
        );
    }
}
