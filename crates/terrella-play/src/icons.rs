//! The icons of the window's buttons, drawn as shapes: sharp at every scale, and of no font.

use egui::{
    Color32, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, WidgetType,
    pos2, vec2,
};
use std::f32::consts::TAU;

/// Width and height of a button, points.
const BUTTON: Vec2 = Vec2::new(24.0, 20.0);
/// Side of the square that an icon is drawn in, points.
const SIDE: f32 = 12.0;
/// Width of lines, points.
const LINE: f32 = 1.5;
/// Points of a circle.
const CIRCLE: usize = 24;

/// Icon of a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    Play,
    Pause,
    StepBack,
    StepOn,
    Slower,
    Faster,
    Reverse,
    Loop,
    FromHere,
    ToHere,
    Whole,
    RealTime,
    Scene,
    Camera,
    TimeLine,
    Help,
}

/// A button with an icon and a tooltip that describes its action.
pub fn icon_button(ui: &mut Ui, icon: Icon, is_on: bool, is_enabled: bool, does: &str) -> Response {
    let sense = match is_enabled {
        true => Sense::click(),
        false => Sense::hover(),
    };
    let (rect, response) = ui.allocate_exact_size(BUTTON, sense);
    response.widget_info(|| WidgetInfo::selected(WidgetType::Button, is_enabled, is_on, does));
    let visuals = ui.style().interact_selectable(&response, is_on);
    let color = match is_enabled {
        true => visuals.fg_stroke.color,
        false => ui.visuals().weak_text_color().gamma_multiply(0.5),
    };
    let painter = ui.painter();
    painter.rect(
        rect,
        visuals.corner_radius,
        visuals.weak_bg_fill,
        visuals.bg_stroke,
        egui::StrokeKind::Inside,
    );
    Pen {
        painter,
        square: Rect::from_center_size(rect.center(), Vec2::splat(SIDE)),
        color,
    }
    .draw(icon);
    response.on_hover_text(does)
}

/// Draws in a square whose corners are (0, 0), upper left, and (1, 1).
struct Pen<'p> {
    painter: &'p Painter,
    square: Rect,
    color: Color32,
}

impl Pen<'_> {
    fn draw(&self, icon: Icon) {
        match icon {
            Icon::Play => self.area(&[(0.15, 0.0), (1.0, 0.5), (0.15, 1.0)]),
            Icon::Pause => {
                self.bar(0.12, 0.38);
                self.bar(0.62, 0.88);
            }
            Icon::StepOn => {
                self.area(&[(0.1, 0.1), (0.65, 0.5), (0.1, 0.9)]);
                self.bar(0.72, 0.88);
            }
            Icon::StepBack => {
                self.area(&[(0.9, 0.1), (0.35, 0.5), (0.9, 0.9)]);
                self.bar(0.12, 0.28);
            }
            Icon::Faster => {
                self.area(&[(0.0, 0.15), (0.5, 0.5), (0.0, 0.85)]);
                self.area(&[(0.5, 0.15), (1.0, 0.5), (0.5, 0.85)]);
            }
            Icon::Slower => {
                self.area(&[(1.0, 0.15), (0.5, 0.5), (1.0, 0.85)]);
                self.area(&[(0.5, 0.15), (0.0, 0.5), (0.5, 0.85)]);
            }
            Icon::Reverse => {
                self.line(&[(0.25, 0.3), (1.0, 0.3)]);
                self.area(&[(0.35, 0.05), (0.0, 0.3), (0.35, 0.55)]);
                self.line(&[(0.0, 0.75), (0.7, 0.75)]);
            }
            Icon::Loop => {
                self.arc((0.5, 0.5), 0.42, (0.12, 0.92));
                self.area(&[(0.62, 0.12), (1.05, 0.16), (0.84, 0.5)]);
            }
            Icon::FromHere => {
                self.bar(0.05, 0.2);
                self.line(&[(0.3, 0.5), (0.75, 0.5)]);
                self.area(&[(0.65, 0.2), (1.0, 0.5), (0.65, 0.8)]);
            }
            Icon::ToHere => {
                self.bar(0.8, 0.95);
                self.line(&[(0.0, 0.5), (0.45, 0.5)]);
                self.area(&[(0.35, 0.2), (0.7, 0.5), (0.35, 0.8)]);
            }
            Icon::Whole => {
                self.line(&[(0.05, 0.1), (0.05, 0.9)]);
                self.line(&[(0.95, 0.1), (0.95, 0.9)]);
                self.line(&[(0.2, 0.5), (0.8, 0.5)]);
                self.area(&[(0.42, 0.25), (0.15, 0.5), (0.42, 0.75)]);
                self.area(&[(0.58, 0.25), (0.85, 0.5), (0.58, 0.75)]);
            }
            Icon::RealTime => {
                self.arc((0.5, 0.5), 0.48, (0.0, 1.0));
                self.line(&[(0.5, 0.2), (0.5, 0.52), (0.72, 0.66)]);
            }
            Icon::Scene => {
                self.line(&[(0.0, 0.55), (0.5, 0.05), (1.0, 0.55)]);
                self.line(&[(0.18, 0.42), (0.18, 0.95), (0.82, 0.95), (0.82, 0.42)]);
            }
            Icon::Camera => {
                let frame = [
                    (0.0, 0.25),
                    (0.7, 0.25),
                    (0.7, 0.8),
                    (0.0, 0.8),
                    (0.0, 0.25),
                ];
                self.line(&frame);
                self.area(&[(0.72, 0.52), (1.0, 0.28), (1.0, 0.77)]);
            }
            Icon::TimeLine => {
                self.line(&[(0.0, 0.7), (1.0, 0.7)]);
                for x in [0.05, 0.35, 0.65, 0.95] {
                    self.line(&[(x, 0.5), (x, 0.9)]);
                }
                self.area(&[(0.3, 0.1), (0.7, 0.1), (0.5, 0.42)]);
            }
            Icon::Help => {
                self.arc((0.5, 0.28), 0.25, (0.5, 1.15));
                self.line(&[(0.65, 0.48), (0.5, 0.6), (0.5, 0.74)]);
                self.dot((0.5, 0.95), 0.09);
            }
        }
    }

    fn at(&self, (x, y): (f32, f32)) -> Pos2 {
        let size = self.square.size();
        self.square.min + vec2(x * size.x, y * size.y)
    }

    /// A convex area.
    fn area(&self, corners: &[(f32, f32)]) {
        let corners = corners.iter().map(|corner| self.at(*corner)).collect();
        let shape = Shape::convex_polygon(corners, self.color, Stroke::NONE);
        self.painter.add(shape);
    }

    /// An upright bar between two abscissae.
    fn bar(&self, from: f32, to: f32) {
        self.area(&[(from, 0.05), (to, 0.05), (to, 0.95), (from, 0.95)]);
    }

    fn line(&self, points: &[(f32, f32)]) {
        let points = points.iter().map(|point| self.at(*point)).collect();
        let stroke = Stroke::new(LINE, self.color);
        self.painter.add(Shape::line(points, stroke));
    }

    /// A part of a circle, in turns clockwise from the right.
    fn arc(&self, center: (f32, f32), radius: f32, (from, to): (f32, f32)) {
        let points = (0..=CIRCLE).map(|k| {
            let turn = TAU * (from + (to - from) * k as f32 / CIRCLE as f32);
            (
                center.0 + radius * turn.cos(),
                center.1 + radius * turn.sin(),
            )
        });
        self.line(&points.collect::<Vec<_>>());
    }

    fn dot(&self, center: (f32, f32), radius: f32) {
        let Pos2 { x, y } = self.at(center);
        let radius = radius * self.square.width();
        self.painter.circle_filled(pos2(x, y), radius, self.color);
    }
}
