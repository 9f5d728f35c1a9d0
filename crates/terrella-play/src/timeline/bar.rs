//! What is drawn of the time line, and what the pointer does on it.

use super::super::clock::{AtEnd, Clock};
use super::super::keys::Action;
use super::super::place_text::place_text;
use super::ticks::ticks;
use super::{TimeLine, seconds};
use egui::{
    Align2, Color32, Context, CornerRadius, DragValue, FontId, Id, Pos2, Rect, Response, RichText,
    Sense, Stroke, TextEdit, Ui, Vec2, vec2,
};
use terrella::frames::{Epoch, utc_from_rfc3339};
use terrella_orbit::Pass;

/// Height of its content while its buttons take one line, points.
const CONTENT_HEIGHT: f32 = 72.0;
/// Height of the bar itself, points.
const BAR_HEIGHT: f32 = 22.0;
/// Room for a tick's label, points.
const TICK_WIDTH: f32 = 76.0;
/// Half the width of the handles of the played part, points.
const HANDLE_HALF_WIDTH: f32 = 5.0;

const PLAYED: Color32 = Color32::from_rgb(58, 74, 96);
const LEFT_OUT: Color32 = Color32::from_rgb(34, 36, 42);
const PASS: Color32 = Color32::from_rgb(86, 176, 110);
const NOW: Color32 = Color32::from_rgb(240, 200, 90);

/// Lays out the time line and adds what the user does to `actions`. Returns how much of the window's bottom it takes, points.
pub fn show(context: &Context, line: &TimeLine, clock: &Clock, actions: &mut Vec<Action>) -> f32 {
    let width = context.content_rect().width() - 16.0;
    let window = egui::Window::new("time line")
        .title_bar(false)
        .resizable(false)
        .anchor(Align2::CENTER_BOTTOM, vec2(0.0, -8.0))
        .fixed_size(vec2(width - 12.0, CONTENT_HEIGHT))
        .show(context, |ui| {
            ends(ui, clock);
            bar(ui, line, clock, actions);
            buttons(ui, line, clock, actions);
        });
    window.map_or(0.0, |window| window.response.rect.height())
}

/// Begin, now and end, UTC.
fn ends(ui: &mut Ui, clock: &Clock) {
    let (first, last) = clock.span();
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 14.0), Sense::hover());
    let labels = [
        (rect.left_center(), Align2::LEFT_CENTER, seconds(first)),
        (
            rect.center(),
            Align2::CENTER_CENTER,
            terrella::frames::rfc3339(clock.now()),
        ),
        (rect.right_center(), Align2::RIGHT_CENTER, seconds(last)),
    ];
    for (at, align, text) in labels {
        let colour = ui.visuals().text_color();
        ui.painter()
            .text(at, align, text, FontId::monospace(12.0), colour);
    }
}

fn bar(ui: &mut Ui, line: &TimeLine, clock: &Clock, actions: &mut Vec<Action>) {
    let size = vec2(ui.available_width(), BAR_HEIGHT + 18.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let bar = Rect::from_min_size(rect.min, vec2(rect.width(), BAR_HEIGHT));
    let x_of = |part: f64| bar.left() + part.clamp(0.0, 1.0) as f32 * bar.width();
    let fraction_at = |at: Pos2| f64::from((at.x - bar.left()) / bar.width());
    let (from, to) = clock.range();
    let painter = ui.painter();
    painter.rect_filled(bar, CornerRadius::same(3), LEFT_OUT);
    let played = Rect::from_x_y_ranges(x_of(from)..=x_of(to), bar.y_range());
    painter.rect_filled(played, CornerRadius::same(3), PLAYED);
    let span_s = clock.duration_s();
    let fraction_of = |epoch: Epoch| (epoch - clock.span().0).to_seconds() / span_s;
    for pass in &line.passes {
        // At least two points wide, so that a pass of minutes is seen in a month.
        let x = x_of(fraction_of(pass.begin));
        let end = x_of(fraction_of(pass.end)).max(x + 2.0);
        let mark = Rect::from_x_y_ranges(x..=end, bar.bottom() - 8.0..=bar.bottom());
        painter.rect_filled(mark, CornerRadius::ZERO, PASS);
    }
    let faint = ui.visuals().weak_text_color();
    for tick in ticks(clock.span(), (bar.width() / TICK_WIDTH) as usize) {
        let x = x_of(tick.fraction);
        painter.vline(x, bar.top()..=bar.bottom() + 3.0, Stroke::new(1.0, faint));
        let label = painter.layout_no_wrap(tick.label, FontId::monospace(10.0), faint);
        let size = label.size();
        // Labels at the ends stay within the bar.
        let left = (x - 0.5 * size.x).min(bar.right() - size.x).max(bar.left());
        let at = Pos2::new(left, bar.bottom() + 10.0 - 0.5 * size.y);
        painter.galley(at, label, faint);
    }
    let x = x_of(clock.progress());
    painter.vline(
        x,
        bar.top() - 3.0..=bar.bottom() + 3.0,
        Stroke::new(2.0, NOW),
    );
    // Handles lie over the bar, so they are asked first.
    let mut held = false;
    for (name, part, action) in [
        (
            "part begin",
            from,
            Action::RangeStart as fn(Option<f64>) -> Action,
        ),
        ("part end", to, Action::RangeEnd),
    ] {
        let at = Pos2::new(x_of(part), bar.top());
        let area =
            Rect::from_center_size(at + vec2(0.0, 4.0), Vec2::splat(2.0 * HANDLE_HALF_WIDTH));
        let handle = ui.interact(area, ui.id().with(name), Sense::drag());
        let colour = match handle.hovered() || handle.dragged() {
            true => NOW,
            false => ui.visuals().text_color(),
        };
        let corners = [
            vec2(-HANDLE_HALF_WIDTH, -3.0),
            vec2(HANDLE_HALF_WIDTH, -3.0),
            vec2(0.0, 6.0),
        ];
        let corners = corners.map(|corner| at + corner).to_vec();
        ui.painter()
            .add(egui::Shape::convex_polygon(corners, colour, Stroke::NONE));
        if let Some(pointer) = handle.interact_pointer_pos().filter(|_| handle.dragged()) {
            actions.push(action(Some(fraction_at(pointer))));
        }
        held |= handle.dragged() || handle.hovered();
        handle.on_hover_text(format!("{name}: drag it"));
    }
    if !held {
        scrub(&response, fraction_at, actions);
    }
    if let Some(at) = response.hover_pos() {
        let here = fraction_at(at).clamp(0.0, 1.0);
        let epoch = clock.span().0 + hifitime::Unit::Second * (here * span_s);
        let pass = line
            .passes
            .iter()
            .find(|pass| pass.begin <= epoch && epoch <= pass.end);
        response.on_hover_text_at_pointer(hover_text(epoch, pass));
    }
}

fn hover_text(epoch: Epoch, pass: Option<&Pass>) -> String {
    match pass {
        Some(pass) => format!(
            "{}\npass, {:.0}° high",
            seconds(epoch),
            pass.elevation_rad.to_degrees()
        ),
        None => seconds(epoch),
    }
}

/// The clock stands where the pointer is for as long as it is held.
fn scrub(response: &Response, fraction_at: impl Fn(Pos2) -> f64, actions: &mut Vec<Action>) {
    let is_held = response.is_pointer_button_down_on() || response.clicked() || response.dragged();
    if let Some(at) = response.interact_pointer_pos().filter(|_| is_held) {
        actions.push(Action::Seek(fraction_at(at)));
    }
}

fn buttons(ui: &mut Ui, line: &TimeLine, clock: &Clock, actions: &mut Vec<Action>) {
    // Several lines in a narrow window.
    ui.horizontal_wrapped(|ui| {
        let pause = if clock.is_paused() { "play" } else { "pause" };
        let loops = clock.at_end() == AtEnd::Loop;
        let is_long_enough = clock.range() != (0.0, 1.0);
        let is_elsewhere = !clock.is_on_scene_span();
        let buttons = [
            (pause, false, true, Action::Pause),
            ("loop", loops, true, Action::Loop),
            ("from here", false, true, Action::RangeStart(None)),
            ("to here", false, true, Action::RangeEnd(None)),
            ("all", false, is_long_enough, Action::RangeAll),
            ("real time", line.is_real_time(), true, Action::RealTime),
            ("scene", false, is_elsewhere, Action::SceneSpan),
        ];
        for (text, is_on, is_enabled, action) in buttons {
            let button = egui::Button::new(text).selected(is_on);
            if ui.add_enabled(is_enabled, button).clicked() {
                actions.push(action);
            }
        }
        date(ui, clock, actions);
        ui.separator();
        ui.label("over");
        place(ui, line, actions);
        let mut min_elevation_deg = line.min_elevation_deg;
        let value = DragValue::new(&mut min_elevation_deg)
            .range(0.0..=89.0)
            .speed(0.2)
            .suffix("°");
        ui.label("above");
        if ui
            .add(value)
            .on_hover_text("least elevation of a pass")
            .changed()
        {
            actions.push(Action::MinElevation(min_elevation_deg));
        }
        if ui.button("next pass").clicked() {
            actions.push(Action::NextPass);
        }
    });
}

/// A date to go to, as a line of text.
fn date(ui: &mut Ui, clock: &Clock, actions: &mut Vec<Action>) {
    let id = Id::new("time line date");
    let typed = ui.data(|data| data.get_temp::<String>(id));
    let mut text = typed.unwrap_or_default();
    let is_wrong = !text.is_empty() && read_date(&text).is_none();
    let mut edit = TextEdit::singleline(&mut text)
        .desired_width(128.0)
        .hint_text("go to date, UTC");
    if is_wrong {
        edit = edit.text_color(ui.visuals().error_fg_color);
    }
    let response = ui.add(edit);
    if response.changed() {
        ui.data_mut(|data| data.insert_temp(id, text.clone()));
    }
    if response.lost_focus() {
        if let Some(epoch) = read_date(&text) {
            actions.push(Action::GoTo(epoch));
        }
        ui.data_mut(|data| data.remove_temp::<String>(id));
    }
    response.on_hover_text(format!("for example {}", seconds(clock.span().0)));
}

/// A date and time of UTC as people write it; without a time, midnight.
pub(super) fn read_date(text: &str) -> Option<Epoch> {
    let text = text.trim().trim_end_matches(['Z', 'z']).replace(' ', "T");
    let whole = match text.len() {
        10 => format!("{text}T00:00:00Z"),
        16 => format!("{text}:00Z"),
        _ => format!("{text}Z"),
    };
    utc_from_rfc3339(&whole).ok()
}

/// The place of passes as a line of text: what is typed is kept here until it is one.
fn place(ui: &mut Ui, line: &TimeLine, actions: &mut Vec<Action>) {
    let id = Id::new("time line place");
    let known = line.place.map(|place| {
        let (lat, lon) = (place.lat_rad.to_degrees(), place.lon_rad.to_degrees());
        format!("{lat:.4}, {lon:.4}")
    });
    let typed = ui.data(|data| data.get_temp::<String>(id));
    let mut text = typed.or(known).unwrap_or_default();
    let read = read_place(&text);
    let mut edit = TextEdit::singleline(&mut text)
        .desired_width(128.0)
        .hint_text("lat, lon in degrees");
    if read.is_none() && !text_is_empty(ui, id) {
        edit = edit.text_color(ui.visuals().error_fg_color);
    }
    let response = ui.add(edit);
    if response.changed() {
        ui.data_mut(|data| data.insert_temp(id, text.clone()));
    }
    if response.lost_focus() {
        if let Some((lat_deg, lon_deg)) = read_place(&text) {
            actions.push(Action::Place(lat_deg, lon_deg));
        }
        ui.data_mut(|data| data.remove_temp::<String>(id));
    }
    let hint = match line.place {
        Some(place) => format!("passes over {}", place_text(place.lat_rad, place.lon_rad)),
        None => "a place: latitude and longitude, south and west negative".to_owned(),
    };
    response.on_hover_text(RichText::new(hint));
}

fn text_is_empty(ui: &Ui, id: Id) -> bool {
    ui.data(|data| data.get_temp::<String>(id))
        .is_none_or(|text| text.is_empty())
}

/// Latitude and longitude in degrees, by a comma or a blank apart.
pub(super) fn read_place(text: &str) -> Option<(f64, f64)> {
    let mut numbers = text
        .split([',', ' ', ';'])
        .filter(|word| !word.is_empty())
        .map(|word| word.trim_end_matches('°').parse::<f64>().ok());
    let (lat, lon) = (numbers.next()??, numbers.next()??);
    let is_place = lat.abs() <= 90.0 && lon.abs() <= 360.0 && numbers.next().is_none();
    is_place.then_some((lat, lon))
}
