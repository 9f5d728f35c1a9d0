//! Drawing of the time line, and pointer interaction.

use super::super::clock::{AtEnd, Clock};
use super::super::icons::{Icon, icon_button};
use super::super::keys::{Action, tooltip};
use super::fields::{date, place};
use super::ticks::ticks;
use super::{TimeLine, seconds};
use egui::{
    Align2, Color32, Context, CornerRadius, DragValue, FontId, Painter, Pos2, Rect, Response,
    Sense, Stroke, StrokeKind, Ui, Vec2, vec2,
};
use terrella::frames::Epoch;

/// Height of its content while its buttons take one line, points.
const CONTENT_HEIGHT: f32 = 72.0;
/// Height of the bar itself, points.
const BAR_HEIGHT: f32 = 22.0;
/// Positions of bands on the bar, points from its upper edge.
const NIGHT_BAND: [f32; 2] = [0.0, 8.0];
const UMBRA_BAND: [f32; 2] = [8.0, 13.0];
const PASS_BAND: [f32; 2] = [14.0, BAR_HEIGHT];
/// Turn of the wheel that shows half as much, points.
const POINTS_PER_DOUBLING: f32 = 80.0;
/// Room for a tick's label, points.
const TICK_WIDTH: f32 = 76.0;
/// Half the width of the handles of the played part, points.
const HANDLE_HALF_WIDTH: f32 = 5.0;
/// A window as wide has a legend of the bands, points.
const LEGEND_FROM: f32 = 900.0;
/// Side of a colour of the legend, and the room after a word, points.
const SWATCH: f32 = 8.0;
const LEGEND_GAP: f32 = 8.0;

const PLAYED: Color32 = Color32::from_rgb(58, 74, 96);
const LEFT_OUT: Color32 = Color32::from_rgb(34, 36, 42);
const PASS: Color32 = Color32::from_rgb(86, 176, 110);
const NIGHT: Color32 = Color32::from_rgb(16, 22, 44);
const UMBRA: Color32 = Color32::from_rgb(150, 104, 196);
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
            let (from, to) = line.part(clock);
            let at =
                |part: f64| clock.span().0 + hifitime::Unit::Second * (part * clock.duration_s());
            ends(ui, line, clock, (at(from), at(to)));
            bar(ui, line, clock, actions);
            buttons(ui, line, clock, actions);
        });
    window.map_or(0.0, |window| window.response.rect.height())
}

/// Start, current time and end of the visible part, UTC, and the legend between them.
fn ends(ui: &mut Ui, line: &TimeLine, clock: &Clock, shown: (Epoch, Epoch)) {
    let (first, last) = shown;
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
    let colour = ui.visuals().text_color();
    let [start, now, end] = labels.map(|(at, align, text)| {
        ui.painter()
            .text(at, align, text, FontId::monospace(12.0), colour)
    });
    if ui.ctx().content_rect().width() < LEGEND_FROM {
        return;
    }
    let light = [
        (&line.light.night, NIGHT, "night below"),
        (&line.light.umbra, UMBRA, "Earth's shadow"),
    ];
    let light = light.into_iter().filter(|(bands, ..)| !bands.is_empty());
    let light: Vec<_> = light.map(|(_, colour, words)| (colour, words)).collect();
    legend(ui, (start.right(), now.left()), rect.center().y, &light);
    let passes = [(PASS, "passes")];
    let passes = &passes[..usize::from(!line.passes.is_empty())];
    legend(ui, (now.right(), end.left()), rect.center().y, passes);
}

/// Colours with their meaning in the middle of a free part of a line, if they fit.
fn legend(ui: &Ui, (left, right): (f32, f32), y: f32, entries: &[(Color32, &str)]) {
    let faint = ui.visuals().weak_text_color();
    let painter = ui.painter();
    let entries = entries.iter().map(|(colour, words)| {
        let words = painter.layout_no_wrap((*words).to_owned(), FontId::proportional(10.5), faint);
        (*colour, words)
    });
    let entries: Vec<_> = entries.collect();
    let widths = entries.iter().map(|(_, words)| words.size().x);
    let width: f32 = widths.map(|words| SWATCH + 4.0 + words + LEGEND_GAP).sum();
    if width + LEGEND_GAP > right - left {
        return;
    }
    let mut x = 0.5 * (left + right - width + LEGEND_GAP);
    for (colour, words) in entries {
        let swatch = Rect::from_center_size(Pos2::new(x + 0.5 * SWATCH, y), Vec2::splat(SWATCH));
        painter.rect_filled(swatch, CornerRadius::ZERO, colour);
        // Night is nearly as dark as the plate.
        let edge = Stroke::new(1.0, faint);
        painter.rect_stroke(swatch, CornerRadius::ZERO, edge, StrokeKind::Inside);
        let size = words.size();
        painter.galley(Pos2::new(x + SWATCH + 4.0, y - 0.5 * size.y), words, faint);
        x += SWATCH + 4.0 + size.x + LEGEND_GAP;
    }
}

/// Maps times to positions on the bar.
struct Scale {
    bar: Rect,
    /// The span, its length in seconds, and the part of it that is shown.
    first: Epoch,
    span_s: f64,
    part: (f64, f64),
}

impl Scale {
    /// Position of a fraction of the span; clamped to the ends.
    fn x(&self, fraction: f64) -> f32 {
        let (from, to) = self.part;
        let at = ((fraction - from) / (to - from)).clamp(0.0, 1.0);
        self.bar.left() + at as f32 * self.bar.width()
    }

    fn fraction_at(&self, at: Pos2) -> f64 {
        let (from, to) = self.part;
        let at = f64::from((at.x - self.bar.left()) / self.bar.width());
        from + at * (to - from)
    }

    fn fraction_of(&self, epoch: Epoch) -> f64 {
        (epoch - self.first).to_seconds() / self.span_s
    }

    fn epoch(&self, fraction: f64) -> Epoch {
        self.first + hifitime::Unit::Second * (fraction * self.span_s)
    }

    /// A mark from one instant to another, two points wide or more so that minutes are seen in a month.
    fn mark(
        &self,
        painter: &Painter,
        times: (Epoch, Epoch),
        [above, below]: [f32; 2],
        color: Color32,
    ) {
        let (begin, end) = (self.fraction_of(times.0), self.fraction_of(times.1));
        if end < self.part.0 || begin > self.part.1 {
            return;
        }
        let x = self.x(begin);
        let end = self.x(end).max(x + 2.0);
        let [top, bottom] = [above, below].map(|y| self.bar.top() + y);
        let mark = Rect::from_x_y_ranges(x..=end, top..=bottom).intersect(self.bar);
        painter.rect_filled(mark, CornerRadius::ZERO, color);
    }
}

fn bar(ui: &mut Ui, line: &TimeLine, clock: &Clock, actions: &mut Vec<Action>) {
    let size = vec2(ui.available_width(), BAR_HEIGHT + 18.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let (first, _) = clock.span();
    let scale = Scale {
        bar: Rect::from_min_size(rect.min, vec2(rect.width(), BAR_HEIGHT)),
        first,
        span_s: clock.duration_s(),
        part: line.part(clock),
    };
    let bar = scale.bar;
    let (from, to) = clock.range();
    let painter = ui.painter();
    painter.rect_filled(bar, CornerRadius::same(3), LEFT_OUT);
    let played = Rect::from_x_y_ranges(scale.x(from)..=scale.x(to), bar.y_range());
    painter.rect_filled(played, CornerRadius::same(3), PLAYED);
    for (bands, height, color) in [
        (&line.light.night, NIGHT_BAND, NIGHT),
        (&line.light.umbra, UMBRA_BAND, UMBRA),
    ] {
        for band in bands {
            scale.mark(painter, *band, height, color);
        }
    }
    for pass in &line.passes {
        scale.mark(painter, (pass.begin, pass.end), PASS_BAND, PASS);
    }
    let faint = ui.visuals().weak_text_color();
    let shown = (scale.epoch(scale.part.0), scale.epoch(scale.part.1));
    for tick in ticks(shown, (bar.width() / TICK_WIDTH) as usize) {
        let x = bar.left() + tick.fraction as f32 * bar.width();
        painter.vline(x, bar.top()..=bar.bottom() + 3.0, Stroke::new(1.0, faint));
        let label = painter.layout_no_wrap(tick.label, FontId::monospace(10.0), faint);
        let size = label.size();
        // Labels at the ends stay within the bar.
        let left = (x - 0.5 * size.x).min(bar.right() - size.x).max(bar.left());
        let at = Pos2::new(left, bar.bottom() + 10.0 - 0.5 * size.y);
        painter.galley(at, label, faint);
    }
    let is_shown = |fraction: f64| (scale.part.0..=scale.part.1).contains(&fraction);
    if is_shown(clock.progress()) {
        let x = scale.x(clock.progress());
        let stroke = Stroke::new(2.0, NOW);
        painter.vline(x, bar.top() - 3.0..=bar.bottom() + 3.0, stroke);
    }
    let is_held = handles(ui, &scale, &is_shown, (from, to), actions);
    if !is_held {
        scrub(&response, &scale, actions);
    }
    zoom(ui, &response, &scale, actions);
    if let Some(at) = response.hover_pos() {
        let epoch = scale.epoch(scale.fraction_at(at).clamp(0.0, 1.0));
        response.on_hover_text_at_pointer(hover_text(epoch, line));
    }
}

/// The handles of the playback range. Returns whether one is dragged. They are above the bar, so they are tested first.
fn handles(
    ui: &Ui,
    scale: &Scale,
    is_shown: &dyn Fn(f64) -> bool,
    (from, to): (f64, f64),
    actions: &mut Vec<Action>,
) -> bool {
    let mut is_held = false;
    for (name, part, action) in [
        (
            "part begin",
            from,
            Action::RangeStart as fn(Option<f64>) -> Action,
        ),
        ("part end", to, Action::RangeEnd),
    ] {
        if !is_shown(part) {
            continue;
        }
        let at = Pos2::new(scale.x(part), scale.bar.top());
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
        if let Some(at) = handle.interact_pointer_pos().filter(|_| handle.dragged()) {
            actions.push(action(Some(scale.fraction_at(at))));
        }
        is_held |= handle.dragged() || handle.hovered();
        handle.on_hover_text(format!("{name}: drag it"));
    }
    is_held
}

/// The wheel shows less or more, or with Shift or sideways moves along.
fn zoom(ui: &Ui, response: &Response, scale: &Scale, actions: &mut Vec<Action>) {
    let Some(at) = response.hover_pos() else {
        return;
    };
    // Ctrl and the wheel, and a pinch, are egui's own zoom.
    let (scrolled, pinched) = ui.input(|input| (input.smooth_scroll_delta, input.zoom_delta()));
    let factor = (scrolled.y / POINTS_PER_DOUBLING).exp2() * pinched;
    let by = -scrolled.x / scale.bar.width();
    if factor != 1.0 || by != 0.0 {
        actions.push(Action::ZoomLine {
            at: scale.fraction_at(at),
            factor: f64::from(factor),
            by: f64::from(by),
        });
    }
}

/// Tooltip at a time.
fn hover_text(epoch: Epoch, line: &TimeLine) -> String {
    let is_in = |times: &(Epoch, Epoch)| times.0 <= epoch && epoch <= times.1;
    let mut text = seconds(epoch);
    let mut passes = line.passes.iter();
    if let Some(pass) = passes.find(|pass| is_in(&(pass.begin, pass.end))) {
        let elevation_deg = pass.elevation_rad.to_degrees();
        text += &format!("\npass, maximum elevation {elevation_deg:.0}°");
    }
    for (bands, words) in [
        (&line.light.night, "night below"),
        (&line.light.umbra, "in the Earth's shadow"),
    ] {
        if bands.iter().any(is_in) {
            text += "\n";
            text += words;
        }
    }
    text
}

/// The clock follows the pointer while the button is held.
fn scrub(response: &Response, scale: &Scale, actions: &mut Vec<Action>) {
    let is_held = response.is_pointer_button_down_on() || response.clicked() || response.dragged();
    if let Some(at) = response.interact_pointer_pos().filter(|_| is_held) {
        actions.push(Action::Seek(scale.fraction_at(at)));
    }
}

fn buttons(ui: &mut Ui, line: &TimeLine, clock: &Clock, actions: &mut Vec<Action>) {
    // Several lines in a narrow window.
    ui.horizontal_wrapped(|ui| {
        let pause = match clock.is_paused() {
            true => Icon::Play,
            false => Icon::Pause,
        };
        let loops = clock.at_end() == AtEnd::Loop;
        let is_long_enough = clock.range() != (0.0, 1.0);
        let is_elsewhere = !clock.is_on_scene_span();
        for (icon, is_on, is_enabled, action) in [
            (Icon::StepBack, false, true, Action::Step(-1.0)),
            (pause, false, true, Action::Pause),
            (Icon::StepOn, false, true, Action::Step(1.0)),
            (Icon::Loop, loops, true, Action::Loop),
            (Icon::FromHere, false, true, Action::RangeStart(None)),
            (Icon::ToHere, false, true, Action::RangeEnd(None)),
            (Icon::Whole, false, is_long_enough, Action::RangeAll),
            (Icon::RealTime, line.is_real_time(), true, Action::RealTime),
            (Icon::Scene, false, is_elsewhere, Action::SceneSpan),
        ] {
            if icon_button(ui, icon, is_on, is_enabled, &tooltip(&action)).clicked() {
                actions.push(action);
            }
        }
        date(ui, clock, actions);
        ui.separator();
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
        let mut visible_only = line.visible_only;
        let visible = ui.checkbox(&mut visible_only, "visible");
        if visible
            .on_hover_text(tooltip(&Action::VisibleOnly))
            .clicked()
        {
            actions.push(Action::VisibleOnly);
        }
        let next = ui.button("next pass");
        if next.on_hover_text(tooltip(&Action::NextPass)).clicked() {
            actions.push(Action::NextPass);
        }
        let film = ui.button("film");
        if film.on_hover_text(tooltip(&Action::Film)).clicked() {
            actions.push(Action::Film);
        }
    });
}
