//! The legend of a map of coverage among the captions: its title, and below it a line for each class with its colour.

use super::coverage_scale::CoverageScale;
use egui::{Color32, FontId, Galley, Painter, Pos2, Rect, Vec2};
use std::sync::Arc;

/// Colour of the words.
const WORDS: Color32 = Color32::WHITE;
/// Width of a patch of colour and its distance from the words, in heights of letters.
const PATCH: f32 = 1.4;
const GAP: f32 = 0.4;
/// Height of a patch, of that of its line.
const PATCH_HEIGHT: f32 = 0.8;

/// A legend as it is drawn.
pub(crate) struct LaidLegend {
    letter: f32,
    title: Arc<Galley>,
    lines: Vec<(Color32, Arc<Galley>)>,
}

impl LaidLegend {
    /// With letters of a height, pixels; words are wrapped at the width.
    pub fn new(painter: &Painter, of: &CoverageScale, letter: f32, width: f32) -> Self {
        let lay_out = |text: &str, width: f32| {
            let font = FontId::proportional(letter);
            painter.layout(text.to_owned(), font, WORDS, width.max(1.0))
        };
        let indent = (PATCH + GAP) * letter;
        let lines = of.classes.iter().map(|class| {
            let words = lay_out(&class.label, width - indent);
            (rgb(class.color), words)
        });
        Self {
            letter,
            title: lay_out(&of.title, width),
            lines: lines.collect(),
        }
    }

    /// Width and height, pixels.
    pub fn size(&self) -> Vec2 {
        let indent = (PATCH + GAP) * self.letter;
        let widths = self.lines.iter().map(|(_, words)| indent + words.size().x);
        let heights = self.lines.iter().map(|(_, words)| words.size().y);
        Vec2::new(
            widths.fold(self.title.size().x, f32::max),
            self.title.size().y + heights.sum::<f32>(),
        )
    }

    /// Draws it from the upper left corner on.
    pub fn paint(&self, painter: &Painter, at: Pos2) {
        painter.galley(at, Arc::clone(&self.title), WORDS);
        let mut top = at.y + self.title.size().y;
        for (color, words) in &self.lines {
            let height = words.size().y;
            let patch = Vec2::new(PATCH, PATCH_HEIGHT) * self.letter;
            let middle = Pos2::new(at.x + 0.5 * patch.x, top + 0.5 * height);
            painter.rect_filled(Rect::from_center_size(middle, patch), 0.0, *color);
            let beside = Pos2::new(at.x + patch.x + GAP * self.letter, top);
            painter.galley(beside, Arc::clone(words), WORDS);
            top += height;
        }
    }
}

/// A colour of display values.
pub(crate) fn rgb([red, green, blue]: [u8; 3]) -> Color32 {
    Color32::from_rgb(red, green, blue)
}
