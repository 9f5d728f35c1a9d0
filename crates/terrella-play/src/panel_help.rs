//! The help: all keys, in as many columns as fit beside the panel or on the whole screen.

use super::keys::{Action, BINDINGS, MOUSE};
use egui::{
    Align2, Context, Galley, Id, RichText, ScrollArea, Sense, TextStyle, TextWrapMode, Ui, Vec2,
    WidgetText, vec2,
};
use std::sync::Arc;

/// Margin between the window's edge and the help, points.
const MARGIN: f32 = 8.0;
/// Its title, frame and last line, points.
const CHROME: f32 = 72.0;
/// Its frame at both sides and a scroll bar, points.
const SIDES: f32 = 32.0;
const SCROLL_BAR: f32 = 14.0;
/// Least and greatest width of a column, points.
const COLUMN_WIDTH: [f32; 2] = [400.0, 560.0];
/// Most columns.
const MAX_COLUMNS: f32 = 3.0;
/// Gaps between columns, between keys and their action, and between lines, points.
const COLUMN_GAP: f32 = 20.0;
const KEYS_GAP: f32 = 10.0;
const LINE_GAP: f32 = 2.0;
/// Actions whose keys are first: those that close something.
const FIRST: [Action; 4] = [Action::Help, Action::Dismiss, Action::Confirm, Action::Quit];

/// A line of the help, laid out.
struct Line {
    keys: Arc<Galley>,
    does: Arc<Galley>,
}

impl Line {
    fn height(&self) -> f32 {
        self.keys.size().y.max(self.does.size().y) + LINE_GAP
    }
}

/// All lines in columns.
struct Columns {
    columns: Vec<Vec<Line>>,
    width: f32,
    /// Width of the keys in all columns.
    keys_width: f32,
}

impl Columns {
    /// In a width in points.
    fn of(ui: &Ui, width: f32) -> Self {
        let [least, greatest] = COLUMN_WIDTH;
        let count = ((width + COLUMN_GAP) / (least + COLUMN_GAP)).floor();
        let count = count.clamp(1.0, MAX_COLUMNS);
        let width = ((width + COLUMN_GAP) / count - COLUMN_GAP).min(greatest);
        let lay_out = |text: WidgetText, width: f32| {
            text.into_galley(ui, Some(TextWrapMode::Wrap), width, TextStyle::Body)
        };
        let keys: Vec<_> = texts()
            .map(|(keys, _)| lay_out(RichText::new(keys).strong().into(), f32::INFINITY))
            .collect();
        let widths = keys.iter().map(|keys| keys.size().x);
        let keys_width = widths.fold(0.0, f32::max);
        let does_width = (width - keys_width - KEYS_GAP).max(keys_width);
        let lines = keys.into_iter().zip(texts()).map(|(keys, (_, does))| Line {
            keys,
            does: lay_out(does.into(), does_width),
        });
        Self {
            columns: balanced(lines.collect(), count as usize),
            width,
            keys_width,
        }
    }

    fn height(&self) -> f32 {
        let heights = self.columns.iter().map(|lines| height_of(lines));
        heights.fold(0.0, f32::max)
    }

    fn show(self, ui: &mut Ui) {
        let count = self.columns.len() as f32;
        let width = count * (self.width + COLUMN_GAP) - COLUMN_GAP;
        let (rect, _) = ui.allocate_exact_size(vec2(width, self.height()), Sense::hover());
        let colour = ui.visuals().text_color();
        for (index, lines) in self.columns.into_iter().enumerate() {
            let mut at = rect.min + vec2(index as f32 * (self.width + COLUMN_GAP), 0.0);
            for line in lines {
                let below = at + vec2(0.0, line.height());
                let does_at = at + vec2(self.keys_width + KEYS_GAP, 0.0);
                ui.painter().galley(at, line.keys, colour);
                ui.painter().galley(does_at, line.does, colour);
                at = below;
            }
        }
    }
}

/// Keys and actions in the order of the help.
fn texts() -> impl Iterator<Item = (&'static str, &'static str)> {
    let keys = |is_first: bool| {
        let bindings = BINDINGS.iter();
        let bindings =
            bindings.filter(move |binding| FIRST.contains(&binding.action()) == is_first);
        bindings.map(|binding| (binding.keys, binding.does))
    };
    keys(true).chain(MOUSE.iter().copied()).chain(keys(false))
}

fn height_of(lines: &[Line]) -> f32 {
    lines.iter().map(Line::height).sum()
}

/// The lines in columns of about equal height.
fn balanced(lines: Vec<Line>, count: usize) -> Vec<Vec<Line>> {
    let column_height = height_of(&lines) / count as f32;
    let mut columns: Vec<Vec<Line>> = (0..count).map(|_| Vec::new()).collect();
    let mut above = 0.0;
    for line in lines {
        let middle = above + 0.5 * line.height();
        above += line.height();
        let index = (middle / column_height) as usize;
        columns[index.min(count - 1)].push(line);
    }
    columns
}

/// Shows the keys with two ways to close them. The help is beside the panel and above the time line, which take `covered` points on the left
/// and at the bottom; if it does not fit there, it is over them.
pub fn show(context: &Context, covered: [f32; 2], actions: &mut Vec<Action>) {
    let screen = context.content_rect().size();
    let room = |covered: Vec2| screen - covered - vec2(2.0 * MARGIN + SIDES, 2.0 * MARGIN + CHROME);
    let [left, below] = covered;
    let (beside, whole) = (room(vec2(left, below)), room(Vec2::ZERO));
    let id = Id::new("help is beside the panel");
    let offset = match context.data(|data| data.get_temp(id)) {
        Some(true) => 0.5 * vec2(left, -below),
        _ => Vec2::ZERO,
    };
    let (mut is_open, mut is_beside) = (true, false);
    egui::Window::new("Keys")
        .open(&mut is_open)
        .order(egui::Order::Foreground)
        .anchor(Align2::CENTER_CENTER, offset)
        .resizable(false)
        .collapsible(false)
        .show(context, |ui| {
            let fitting = (beside.x >= COLUMN_WIDTH[0]).then(|| Columns::of(ui, beside.x));
            let fitting = fitting.filter(|columns| columns.height() <= beside.y);
            is_beside = fitting.is_some();
            let columns = fitting.unwrap_or_else(|| Columns::of(ui, whole.x));
            ui.set_max_width(whole.x + SCROLL_BAR);
            ui.style_mut().spacing.scroll = egui::style::ScrollStyle::solid();
            ScrollArea::vertical()
                .max_height(whole.y)
                .show(ui, |ui| columns.show(ui));
            ui.label("Esc, H or the cross closes this help.");
        });
    context.data_mut(|data| data.insert_temp(id, is_beside));
    if !is_open {
        actions.push(Action::Dismiss);
    }
}
