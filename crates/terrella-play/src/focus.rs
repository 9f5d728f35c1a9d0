//! Which keys are typed into a text field, and which are keys of the window.

use egui::{Context, Event, Key, Response};

/// Whether these events can move the focus to a text field or away from it. A later key belongs to the window or to a field only once
/// they are laid out.
pub fn can_move_focus(events: &[Event]) -> bool {
    events.iter().any(|event| match event {
        Event::PointerButton { .. } | Event::Touch { .. } => true,
        Event::Key {
            key, pressed: true, ..
        } => moves_focus(*key),
        _ => false,
    })
}

fn moves_focus(key: Key) -> bool {
    use Key::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp, Enter, Escape, Tab};
    matches!(
        key,
        Enter | Escape | Tab | ArrowUp | ArrowDown | ArrowLeft | ArrowRight
    )
}

/// Whether keys are typed into a text field.
pub fn is_typing(context: &Context) -> bool {
    context.text_edit_focused()
}

/// Keys go to this dialog, and to nothing below it.
pub fn take_keys(context: &Context, dialog: &Response) {
    context.memory_mut(|memory| memory.set_modal_layer(dialog.layer_id));
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Modifiers, PointerButton, Pos2, RawInput, Rect, TextEdit, Vec2};

    /// A text field, and events that egui has not had yet.
    struct Field {
        context: Context,
        text: String,
        rect: Rect,
        pending: Vec<Event>,
        layouts: usize,
    }

    impl Field {
        fn new() -> Self {
            let mut field = Self {
                context: Context::default(),
                text: String::new(),
                rect: Rect::NOTHING,
                pending: Vec::new(),
                layouts: 0,
            };
            field.lay_out();
            field.lay_out();
            field
        }

        fn lay_out(&mut self) {
            let input = RawInput {
                screen_rect: Some(Rect::from_min_size(Pos2::ZERO, Vec2::splat(400.0))),
                time: Some(self.layouts as f64),
                events: std::mem::take(&mut self.pending),
                ..RawInput::default()
            };
            let (text, rect) = (&mut self.text, &mut self.rect);
            let mut output = self.context.run_ui(input, |ui| {
                *rect = ui.add(TextEdit::singleline(text)).rect;
            });
            output.textures_delta.clear();
            self.layouts += 1;
        }

        /// A key as the window takes it. Returns whether it is the window's.
        fn press(&mut self, key: Key, text: Option<&str>) -> bool {
            if can_move_focus(&self.pending) {
                self.lay_out();
            }
            let is_typed = is_typing(&self.context);
            self.pending.push(Event::Key {
                key,
                physical_key: None,
                pressed: true,
                repeat: false,
                modifiers: Modifiers::NONE,
            });
            let text = text.map(|text| Event::Text(text.to_owned()));
            self.pending.extend(text);
            !is_typed
        }

        fn click(&mut self, pos: Pos2) {
            self.pending.push(Event::PointerMoved(pos));
            for pressed in [true, false] {
                self.pending.push(Event::PointerButton {
                    pos,
                    button: PointerButton::Primary,
                    pressed,
                    modifiers: Modifiers::NONE,
                });
            }
        }
    }

    #[test]
    fn keys_in_the_frame_of_a_click_are_typed_where_it_puts_the_focus() {
        let mut field = Field::new();
        assert!(field.press(Key::K, Some("k")), "nothing is typed yet");
        field.click(field.rect.center());
        assert!(!field.press(Key::E, Some("e")));
        let laid_out = field.layouts;
        assert!(!field.press(Key::N, Some("n")));
        assert_eq!(field.layouts, laid_out, "letters wait for the frame");
        assert!(!field.press(Key::Enter, None));
        assert!(field.press(Key::X, Some("x")), "Enter ends the field");
        field.lay_out();
        assert_eq!(field.text, "en");
        field.click(field.rect.center());
        field.lay_out();
        field.click(Pos2::new(300.0, 300.0));
        assert!(field.press(Key::T, Some("t")), "clicked elsewhere");
        field.lay_out();
        assert_eq!(field.text, "en");
    }
}
