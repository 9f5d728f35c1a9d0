//! Scale bar and compass: how long the ground is in the middle of the picture, and where north is there.

use super::keys::{Action, tooltip};
use super::orbit_camera::Globe;
use super::picking::{on_screen, ray};
use egui::{
    Align2, Color32, Context, FontId, Id, Painter, Pos2, Rect, Sense, Shape, Stroke, Ui, Vec2, vec2,
};
use glam::{DVec2, DVec3};
use terrella::EyeView;
use terrella::frames::Ellipsoid;

/// Longest bar, points.
const LONGEST: f32 = 110.0;
/// Pixels between the two places that the scale is measured with.
const MEASURED_PX: f64 = 8.0;
/// Radius of the compass, points.
const COMPASS: f32 = 17.0;
const NORTH: Color32 = Color32::from_rgb(232, 92, 76);
const PLATE: Color32 = Color32::from_black_alpha(120);

/// The ground in the middle of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapScale {
    /// Metres of ground that a pixel sideways is wide.
    pub m_per_px: f64,
    /// Where north is on screen, unit: right and down.
    pub north: DVec2,
}

impl MapScale {
    /// Of a view; `None` where the middle shows no ground, or a pole.
    pub fn of(view: &EyeView, ellipsoid: &Ellipsoid, size_px: DVec2) -> Option<Self> {
        let globe = Globe {
            ellipsoid: *ellipsoid,
            ground: None,
        };
        let (eye_itrf_m, _) = view.to_itrf();
        let ground_at = |right_px: f64| {
            let at_px = 0.5 * size_px + DVec2::new(right_px, 0.0);
            globe.meet(eye_itrf_m, ray(view, size_px, at_px)?)
        };
        let (left, right) = (ground_at(-MEASURED_PX)?, ground_at(MEASURED_PX)?);
        let m_per_px = left.distance(right) / (2.0 * MEASURED_PX);
        let middle = ground_at(0.0)?;
        let place = ellipsoid.geodetic_from_itrf(middle);
        let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
        let north = (DVec3::Z - DVec3::Z.dot(up) * up).try_normalize()?;
        let toward = on_screen(view, middle + m_per_px * MEASURED_PX * north)?;
        let north = ((toward - on_screen(view, middle)?) * size_px).try_normalize()?;
        Some(Self { m_per_px, north })
    }
}

/// The longest of 1, 2 and 5 times a power of ten that is no longer.
fn round_length(longest_m: f64) -> f64 {
    let power = longest_m.log10().floor();
    let ten = 10_f64.powf(power);
    [5.0, 2.0]
        .into_iter()
        .map(|times| times * ten)
        .find(|length| *length <= longest_m)
        .unwrap_or(ten)
}

fn length_text(length_m: f64) -> String {
    match length_m {
        long if long >= 1000.0 => format!("{} km", long / 1000.0),
        short if short >= 1.0 => format!("{short} m"),
        shorter => format!("{} cm", (100.0 * shorter).round()),
    }
}

/// Draws both at the right, `bottom` points above the window's lower edge. A click on the compass turns north up. Answers the height, points.
pub fn show(context: &Context, scale: &MapScale, bottom: f32, actions: &mut Vec<Action>) -> f32 {
    let m_per_point = scale.m_per_px * f64::from(context.pixels_per_point());
    let length_m = round_length(m_per_point * f64::from(LONGEST));
    let length = (length_m / m_per_point) as f32;
    let size = vec2(LONGEST + 2.0 * COMPASS + 24.0, 2.0 * COMPASS + 6.0);
    egui::Area::new(Id::new("map scale"))
        .anchor(Align2::RIGHT_BOTTOM, vec2(-8.0, -bottom))
        .show(context, |ui| {
            let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
            ui.painter().rect_filled(rect, 8.0, PLATE);
            let middle = rect.right_center() - vec2(COMPASS + 3.0, 0.0);
            if compass(ui, middle, scale.north) {
                actions.push(Action::NorthUp);
            }
            let right = middle.x - COMPASS - 8.0;
            let bar = Rect::from_min_max(
                Pos2::new(right - length, rect.center().y + 6.0),
                Pos2::new(right, rect.center().y + 10.0),
            );
            draw_bar(ui.painter(), bar, &length_text(length_m));
        });
    size.y
}

/// A line with both ends marked, and its length above.
fn draw_bar(painter: &Painter, bar: Rect, text: &str) {
    let stroke = Stroke::new(1.5, Color32::WHITE);
    let corners = [
        bar.left_top(),
        bar.left_bottom(),
        bar.right_bottom(),
        bar.right_top(),
    ];
    painter.add(Shape::line(corners.to_vec(), stroke));
    let above = bar.center_top() - vec2(0.0, 3.0);
    let font = FontId::proportional(12.0);
    painter.text(above, Align2::CENTER_BOTTOM, text, font, Color32::WHITE);
}

/// Draws the compass; returns whether it is clicked.
fn compass(ui: &Ui, middle: Pos2, north: DVec2) -> bool {
    let area = Rect::from_center_size(middle, Vec2::splat(2.0 * COMPASS));
    let response = ui.interact(area, Id::new("compass"), Sense::click());
    let painter = ui.painter();
    let edge = match response.hovered() {
        true => Color32::WHITE,
        false => Color32::from_white_alpha(110),
    };
    painter.circle_stroke(middle, COMPASS - 1.0, Stroke::new(1.0, edge));
    let ahead = vec2(north.x as f32, north.y as f32);
    let aside = vec2(-ahead.y, ahead.x) * 0.2 * COMPASS;
    for (tip, color) in [(ahead, NORTH), (-ahead, Color32::from_gray(190))] {
        let corners = vec![
            middle + tip * 0.55 * COMPASS,
            middle + aside,
            middle - aside,
        ];
        painter.add(Shape::convex_polygon(corners, color, Stroke::NONE));
    }
    let letter = middle + ahead * 0.72 * COMPASS;
    let font = FontId::proportional(9.0);
    painter.text(letter, Align2::CENTER_CENTER, "N", font, Color32::WHITE);
    response.on_hover_text(tooltip(&Action::NorthUp)).clicked()
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella::frames::Geodetic;

    const SIZE: DVec2 = DVec2::new(1280.0, 720.0);
    const FOV_RAD: f64 = 0.8;

    /// Straight down, a pixel is 2 h tan(fov/2) / height wide; north follows from the camera's up axis.
    #[test]
    fn the_scale_is_that_of_a_pinhole_above_the_ground() {
        let ellipsoid = Ellipsoid::WGS84;
        let place = |height_m| Geodetic::from_degrees(48.0, 16.0, height_m);
        let eye = ellipsoid.itrf_from_geodetic(place(2000.0));
        let up = Ellipsoid::normal(place(0.0).lat_rad, place(0.0).lon_rad);
        let east = DVec3::Z.cross(up).normalize();
        let view = |up_axis| EyeView::itrf(eye, -up, up_axis, FOV_RAD, SIZE.x / SIZE.y);
        let scale = MapScale::of(&view(up.cross(east)), &ellipsoid, SIZE).expect("ground");
        let expected = 2.0 * 2000.0 * (0.5 * FOV_RAD).tan() / SIZE.y;
        assert!((scale.m_per_px / expected - 1.0).abs() < 1e-5, "{scale:?}");
        assert!(scale.north.distance(DVec2::new(0.0, -1.0)) < 1e-4);
        // East up: north is at the left.
        let turned = MapScale::of(&view(east), &ellipsoid, SIZE).expect("ground");
        assert!(turned.north.distance(DVec2::new(-1.0, 0.0)) < 1e-4);
        let away = EyeView::itrf(eye, up, east, FOV_RAD, 1.0);
        assert_eq!(MapScale::of(&away, &ellipsoid, SIZE), None);
    }

    #[test]
    fn lengths_are_round_and_no_longer() {
        for (longest, round, text) in [
            (123.0, 100.0, "100 m"),
            (499.0, 200.0, "200 m"),
            (5e3, 5e3, "5 km"),
            (0.07, 0.05, "5 cm"),
            (1.9e6, 1e6, "1000 km"),
        ] {
            let length = round_length(longest);
            assert!((length / round - 1.0).abs() < 1e-9, "{length}");
            assert_eq!(length_text(length), text);
        }
    }
}
