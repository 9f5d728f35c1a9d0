//! Interprets mouse buttons: clicks, double clicks and drags. Independent of windows; time is a parameter.

use glam::DVec2;
use std::time::{Duration, Instant};

/// How far a pointer may move between press and release of a click, pixels.
pub const CLICK_PX: f64 = 4.0;
/// Longest time between the clicks of a double click.
const DOUBLE_CLICK: Duration = Duration::from_millis(400);

/// A button that holds something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// The left button.
    Grab,
    /// The right button, or the left one with Shift.
    Turn,
}

/// A gesture of the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gesture {
    /// It has moved away from where it was pressed: a drag begins there.
    Begin(Hold, DVec2),
    /// It moves with a button held, from and to these pixels.
    Move(Hold, DVec2, DVec2),
    /// A drag ends.
    End,
    /// Pressed and released at a place.
    Click(DVec2),
    /// The same again, soon.
    DoubleClick(DVec2),
}

#[derive(Clone, Copy, Debug)]
struct Held {
    hold: Hold,
    pressed_px: DVec2,
    /// Where the drag is, once it is one.
    dragged_px: Option<DVec2>,
}

/// A pointer and its buttons.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pointer {
    at_px: Option<DVec2>,
    held: Option<Held>,
    last_click: Option<(Instant, DVec2)>,
}

impl Pointer {
    /// Where it is, pixels; `None` outside of the window.
    pub fn at_px(&self) -> Option<DVec2> {
        self.at_px
    }

    /// A button is pressed over the picture.
    pub fn press(&mut self, hold: Hold) {
        if self.held.is_none() {
            self.held = self.at_px.map(|pressed_px| Held {
                hold,
                pressed_px,
                dragged_px: None,
            });
        }
    }

    /// Releases the pressed button without effect.
    pub fn let_go(&mut self) {
        self.held = None;
    }

    /// The pointer has left the window. A drag continues outside.
    pub fn leave(&mut self) {
        if self.held.is_none() {
            self.at_px = None;
        }
    }

    /// The pointer is at a pixel. Answers what that means, in order.
    pub fn move_to(&mut self, at_px: DVec2) -> [Option<Gesture>; 2] {
        self.at_px = Some(at_px);
        let Some(held) = &mut self.held else {
            return [None; 2];
        };
        let (hold, from) = (held.hold, held.dragged_px.unwrap_or(held.pressed_px));
        if held.dragged_px.is_none() && at_px.distance(from) <= CLICK_PX {
            return [None; 2];
        }
        let begin = held.dragged_px.is_none();
        held.dragged_px = Some(at_px);
        [
            begin.then_some(Gesture::Begin(hold, from)),
            Some(Gesture::Move(hold, from, at_px)),
        ]
    }

    /// A button is released at an instant.
    pub fn release(&mut self, hold: Hold, now: Instant) -> Option<Gesture> {
        // Shift may have been released meanwhile: the button counts, and only one is held at a time.
        let held = self
            .held
            .take_if(|held| held.hold == hold || hold == Hold::Grab)?;
        if held.dragged_px.is_some() {
            return Some(Gesture::End);
        }
        if held.hold != Hold::Grab {
            return None;
        }
        let at = held.pressed_px;
        let is_second = self.last_click.take().is_some_and(|(time, place)| {
            now.saturating_duration_since(time) <= DOUBLE_CLICK && place.distance(at) <= CLICK_PX
        });
        if is_second {
            return Some(Gesture::DoubleClick(at));
        }
        self.last_click = Some((now, at));
        Some(Gesture::Click(at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: DVec2 = DVec2::new(100.0, 80.0);

    fn pointer() -> Pointer {
        let mut pointer = Pointer::default();
        assert_eq!(pointer.move_to(HERE), [None; 2]);
        pointer
    }

    #[test]
    fn a_press_that_moves_little_is_a_click() {
        let (mut pointer, now) = (pointer(), Instant::now());
        pointer.press(Hold::Grab);
        assert_eq!(pointer.move_to(HERE + DVec2::new(2.0, 3.0)), [None; 2]);
        let click = pointer.release(Hold::Grab, now);
        assert_eq!(click, Some(Gesture::Click(HERE)));
        pointer.press(Hold::Turn);
        assert_eq!(pointer.release(Hold::Turn, now), None, "a right click");
    }

    #[test]
    fn a_drag_begins_where_the_button_was_pressed() {
        let (mut pointer, now) = (pointer(), Instant::now());
        pointer.press(Hold::Grab);
        let (first, second) = (HERE + DVec2::new(9.0, 0.0), HERE + DVec2::new(1.0, 0.0));
        assert_eq!(
            pointer.move_to(first),
            [
                Some(Gesture::Begin(Hold::Grab, HERE)),
                Some(Gesture::Move(Hold::Grab, HERE, first))
            ]
        );
        // Back where it began it is still a drag.
        assert_eq!(
            pointer.move_to(second),
            [None, Some(Gesture::Move(Hold::Grab, first, second))]
        );
        assert_eq!(pointer.release(Hold::Grab, now), Some(Gesture::End));
        assert_eq!(pointer.move_to(first), [None; 2]);
        assert_eq!(pointer.release(Hold::Grab, now), None, "nothing is held");
    }

    #[test]
    fn two_clicks_are_a_double_click_if_they_are_close_in_time_and_place() {
        let begin = Instant::now();
        let click = |pointer: &mut Pointer, ms: u64| {
            pointer.press(Hold::Grab);
            pointer.release(Hold::Grab, begin + Duration::from_millis(ms))
        };
        let mut pointer = pointer();
        assert_eq!(click(&mut pointer, 0), Some(Gesture::Click(HERE)));
        assert_eq!(click(&mut pointer, 300), Some(Gesture::DoubleClick(HERE)));
        assert_eq!(
            click(&mut pointer, 500),
            Some(Gesture::Click(HERE)),
            "a third"
        );
        assert_eq!(
            click(&mut pointer, 1500),
            Some(Gesture::Click(HERE)),
            "late"
        );
        let there = HERE + DVec2::new(30.0, 0.0);
        pointer.move_to(there);
        assert_eq!(click(&mut pointer, 1600), Some(Gesture::Click(there)));
    }

    #[test]
    fn a_drag_goes_on_outside_and_ends_where_it_is_let_go() {
        let mut pointer = pointer();
        pointer.press(Hold::Turn);
        pointer.leave();
        let there = DVec2::new(-50.0, 80.0);
        assert!(pointer.move_to(there)[1].is_some());
        pointer.let_go();
        assert_eq!(pointer.release(Hold::Turn, Instant::now()), None);
        pointer.leave();
        assert_eq!(pointer.at_px(), None);
    }
}
