use super::*;
use crate::flight::Flight;
use crate::scene::Scene;
use egui::{Context, Event, Modifiers, PointerButton, Pos2, RawInput, Rect, Shape, Vec2};
use std::path::Path;

/// Both fields, laid out one by one.
struct Fields {
    context: Context,
    line: TimeLine,
    clock: Clock,
    frame: u32,
    rects: [Rect; 2],
    texts: Vec<String>,
}

const DATE: usize = 0;
const PLACE: usize = 1;

impl Fields {
    fn new() -> Self {
        let scene = "[orbit]\n[camera]\nmode = \"nadir\"\n";
        let scene = Scene::from_toml(scene, Path::new("test.toml")).expect("a good scene");
        let clock = Clock::new(&scene.time, crate::clock::AtEnd::Loop);
        let mut fields = Self {
            context: Context::default(),
            line: TimeLine::new(&Flight::open(scene).expect("opens")),
            clock,
            frame: 0,
            rects: [Rect::NOTHING; 2],
            texts: Vec::new(),
        };
        fields.lay_out(Vec::new());
        fields.lay_out(Vec::new());
        fields
    }

    fn lay_out(&mut self, events: Vec<Event>) -> Vec<Action> {
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, Vec2::new(900.0, 400.0))),
            // Pressed for a second, a button is not clicked.
            time: Some(0.1 * f64::from(self.frame)),
            events,
            ..RawInput::default()
        };
        let mut actions = Vec::new();
        let (line, clock, rects) = (&self.line, &self.clock, &mut self.rects);
        let mut output = self.context.run_ui(input, |ui| {
            // The message is above them.
            ui.add_space(200.0);
            ui.horizontal(|ui| {
                *rects = [
                    date(ui, clock, &mut actions).rect,
                    place(ui, line, &mut actions).rect,
                ];
            });
        });
        output.textures_delta.clear();
        let shapes = output.shapes.into_iter();
        let texts = shapes.filter_map(|shape| match shape.shape {
            Shape::Text(text) => Some(text.galley.text().to_owned()),
            _ => None,
        });
        self.texts = texts.collect();
        self.frame += 1;
        actions
    }

    fn click(&mut self, pos: Pos2) -> Vec<Action> {
        let button = |pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        self.lay_out(vec![Event::PointerMoved(pos)]);
        let mut actions = self.lay_out(vec![button(true)]);
        actions.extend(self.lay_out(vec![button(false)]));
        actions
    }

    fn key(&mut self, key: Key) -> Vec<Action> {
        let event = Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        let mut actions = self.lay_out(vec![event]);
        // A message is invisible while its size is found out.
        actions.extend(self.lay_out(Vec::new()));
        actions
    }

    fn enter(&mut self, field: usize, text: &str) -> Vec<Action> {
        self.click(self.rects[field].center());
        self.lay_out(vec![Event::Text(text.to_owned())]);
        self.key(Key::Enter)
    }

    fn shows(&self, words: &str) -> bool {
        self.texts.iter().any(|text| text.contains(words))
    }
}

#[test]
fn a_text_that_cannot_be_read_stays_with_what_is_expected() {
    for (field, text, expected) in [
        (
            PLACE,
            "95, 15",
            "latitude, longitude in degrees, for example 78.2, 15.4",
        ),
        (
            PLACE,
            "Xyzzyville",
            "no known city begins with \"Xyzzyville\"",
        ),
        (
            DATE,
            "tomorrow",
            "for example 2018-01-20 or 2018-01-20 06:05",
        ),
    ] {
        let mut fields = Fields::new();
        assert_eq!(fields.enter(field, text), [], "{text}");
        assert!(fields.shows(expected), "{text}: {:?}", fields.texts);
        assert!(fields.texts.iter().any(|shown| shown == text), "{text}");
        // The field is still typed into, and the message goes with the first letter.
        assert!(fields.context.text_edit_focused());
        fields.lay_out(vec![Event::Text("x".to_owned())]);
        assert!(!fields.shows(expected) && fields.shows(text), "{text}");
        fields.key(Key::Enter);
        assert!(fields.shows("expected"), "{text}");
        assert_eq!(fields.key(Key::Escape), [], "{text}");
        assert!(!fields.shows("expected") && !fields.shows(text), "{text}");
        assert!(!fields.context.text_edit_focused());
    }
}

#[test]
fn a_text_that_cannot_be_read_stays_after_a_click_elsewhere() {
    let mut fields = Fields::new();
    fields.click(fields.rects[PLACE].center());
    fields.lay_out(vec![Event::Text("95, 15".to_owned())]);
    assert_eq!(fields.click(Pos2::new(700.0, 350.0)), []);
    fields.lay_out(Vec::new());
    // A message is invisible while its size is found out.
    fields.lay_out(Vec::new());
    let is_shown = fields.shows("95, 15") && fields.shows("latitude, longitude in degrees");
    assert!(is_shown, "{:?}", fields.texts);
    // A place from elsewhere takes its place.
    fields.line.place = Some(terrella::frames::Geodetic::from_degrees(1.0, 2.0, 0.0));
    fields.lay_out(Vec::new());
    assert!(fields.shows("1.0000, 2.0000") && !fields.shows("expected"));
}

#[test]
fn what_is_entered_is_done_and_esc_enters_nothing() {
    let mut fields = Fields::new();
    let place = fields.enter(PLACE, "78.23N 15.39E");
    assert_eq!(place, [Action::Place(78.23, 15.39)]);
    let date = fields.enter(DATE, "2018-01-20 06:05");
    assert!(matches!(date[..], [Action::GoTo(_)]), "{date:?}");
    fields.click(fields.rects[PLACE].center());
    fields.lay_out(vec![Event::Text("48.2, 16.4".to_owned())]);
    assert_eq!(fields.key(Key::Escape), []);
    assert!(!fields.shows("48.2, 16.4"));
}
