//! Text fields of the time line: a date to go to, and the place of passes.

use super::super::clock::Clock;
use super::super::keys::Action;
use super::super::place_text::place_text;
use super::entry::{date_of, place_of};
use super::{TimeLine, seconds};
use egui::{Align2, Frame, Id, Key, Order, Response, RichText, TextEdit, Ui, vec2};

/// Longest text of a field, characters.
const LONGEST_TEXT: usize = 64;
/// Longer messages take several lines, points.
const MESSAGE_WIDTH: f32 = 360.0;

/// A text that differs from what the field shows by itself.
#[derive(Clone)]
struct Typed {
    text: String,
    /// What the field showed by itself then.
    known: String,
    /// Why the text was rejected when it was entered.
    rejected: Option<String>,
}

/// A field that shows `known` until something is typed. Returns what was entered. A text that cannot be read stays, with the message of
/// `read` above the time line, until it is edited or Esc is pressed.
fn field<T>(
    ui: &mut Ui,
    (name, hint, known): (&str, &str, &str),
    read: impl Fn(&str) -> Result<T, String>,
) -> (Response, Option<T>) {
    let id = Id::new(name);
    let typed = ui.data(|data| data.get_temp::<Typed>(id));
    let typed = typed.filter(|typed| typed.known == known);
    let mut typed = typed.unwrap_or_else(|| Typed {
        text: known.to_owned(),
        known: known.to_owned(),
        rejected: None,
    });
    let is_new = |text: &str| !text.trim().is_empty() && text != known;
    let is_wrong = is_new(&typed.text) && read(&typed.text).is_err();
    let mut edit = TextEdit::singleline(&mut typed.text)
        .desired_width(128.0)
        .char_limit(LONGEST_TEXT)
        .hint_text(hint);
    if is_wrong {
        edit = edit.text_color(ui.visuals().error_fg_color);
    }
    let response = ui.add(edit);
    if response.changed() {
        typed.rejected = None;
    }
    let mut entered = None;
    let mut stays = typed.rejected.is_some() || response.has_focus();
    if response.lost_focus() {
        let pressed = |key| ui.input(|input| input.key_pressed(key));
        let is_entered = !pressed(Key::Escape) && is_new(&typed.text);
        match is_entered.then(|| read(&typed.text)) {
            None => stays = false,
            Some(Ok(value)) => (entered, stays) = (Some(value), false),
            Some(Err(expected)) => {
                (typed.rejected, stays) = (Some(expected), true);
                if pressed(Key::Enter) {
                    response.request_focus();
                }
            }
        }
    }
    if let Some(message) = typed.rejected.as_ref().filter(|_| stays) {
        show_message(ui, id, &response, message);
    }
    if stays {
        ui.data_mut(|data| data.insert_temp(id, typed));
    } else {
        ui.data_mut(|data| data.remove::<Typed>(id));
    }
    (response, entered)
}

/// A message above the time line, over the field that it is about.
fn show_message(ui: &Ui, id: Id, field: &Response, message: &str) {
    let at = egui::pos2(field.rect.left(), ui.clip_rect().top()) - vec2(0.0, 4.0);
    egui::Area::new(id.with("message"))
        .order(Order::Foreground)
        .interactable(false)
        .pivot(Align2::LEFT_BOTTOM)
        .fixed_pos(at)
        .show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(MESSAGE_WIDTH);
                ui.label(RichText::new(message).color(ui.visuals().error_fg_color));
            });
        });
}

/// A date to go to.
pub fn date(ui: &mut Ui, clock: &Clock, actions: &mut Vec<Action>) -> Response {
    let words = ("time line date", "go to date, UTC", "");
    let (response, entered) = field(ui, words, date_of);
    actions.extend(entered.map(Action::GoTo));
    response.on_hover_text(format!("for example {}", seconds(clock.span().0)))
}

/// The place of passes.
pub fn place(ui: &mut Ui, line: &TimeLine, actions: &mut Vec<Action>) -> Response {
    let known = line.place.map(|place| {
        let (lat, lon) = (place.lat_rad.to_degrees(), place.lon_rad.to_degrees());
        format!("{lat:.4}, {lon:.4}")
    });
    let known = known.unwrap_or_default();
    let words = ("time line place", "over lat, lon (°)", &*known);
    let (response, entered) = field(ui, words, |text| place_of(text, &line.cities));
    actions.extend(entered.map(|(lat_deg, lon_deg)| Action::Place(lat_deg, lon_deg)));
    response.on_hover_text(match line.place {
        Some(place) => format!("passes over {}", place_text(place.lat_rad, place.lon_rad)),
        None => "a place: latitude, longitude in degrees, or the name of a city".to_owned(),
    })
}

#[cfg(test)]
#[path = "fields_tests.rs"]
mod tests;
