//! Names beside markers, in egui's fonts, on the finished picture.

use crate::egui_pass::EguiTarget;
use crate::text_overlay::TextOverlay;
use egui::{Align2, Color32, FontId, Pos2, Rect, Vec2};
use terrella::tracks::TrackLabel;

/// Height of letters as a fraction of the picture's.
const LETTER_FRACTION: f32 = 0.02;
/// Bounds of the height of letters, pixels.
const LETTER_PX: std::ops::RangeInclusive<f32> = 12.0..=48.0;
/// Distance of a name from its marker's centre, in letter heights.
const MARKER_DISTANCE: f32 = 0.7;
/// Free space at which a city's name begins to appear and is fully opaque, in letter heights.
const CITY_ROOM: [f32; 2] = [4.0, 5.5];
/// Letter height of a city relative to that of other names.
const CITY_LETTER: f32 = 0.8;
/// Radius of a city's dot, in its letter heights.
const DOT: f32 = 0.2;
/// Opacity of the plate below a city's name, of 255.
const PLATE: f32 = 120.0;
/// Characters after which a name is cut.
const MAX_NAME_CHARS: usize = 48;

/// Position of a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NamePlace {
    /// Beside a mark, over other names where there is no room.
    Beside,
    /// Beside the marker, if no other name is there: there may be more names than an image has room for.
    BesideIfRoom,
    /// In the middle of an area or a line, if no other name is there.
    MiddleIfRoom,
    /// A city's, beside a dot, on a dark plate.
    City(CityName),
}

/// How a city's name is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CityName {
    /// Whether its dot is a square, as atlases mark capitals.
    pub is_capital: bool,
    /// Distance to the nearest more important city on screen, pixels.
    pub room_px: f32,
}

impl CityName {
    /// How much of the name is seen, 0…1, between letters of this height: names appear as their distance grows.
    fn opacity(&self, letter: f32) -> f32 {
        let [least, full] = CITY_ROOM.map(|letters| letters * letter);
        ((self.room_px - least) / (full - least)).clamp(0.0, 1.0)
    }
}

/// Draws names.
pub struct Labels(TextOverlay);

impl Labels {
    /// For images of this format.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        Self(TextOverlay::new(device, format))
    }

    /// Writes names over a picture, of cities at most `most_cities`.
    pub fn write<'n>(
        &mut self,
        target: EguiTarget<'_>,
        most_cities: usize,
        names: impl Iterator<Item = (TrackLabel, &'n str, NamePlace)>,
    ) {
        let names = names.map(|(label, name, place)| (label, one_line(name), place));
        let names: Vec<_> = names.collect();
        if !names.is_empty() {
            let paint =
                |painter: &egui::Painter, screen| paint(painter, screen, most_cities, &names);
            self.0.draw(target, paint);
        }
    }
}

/// A feed's name as it can be written: control characters are blanks, and it ends somewhere.
fn one_line(name: &str) -> String {
    let blank = |c: char| if c.is_control() { ' ' } else { c };
    let text: String = name
        .trim()
        .chars()
        .take(MAX_NAME_CHARS)
        .map(blank)
        .collect();
    let mut text = text.trim().to_owned();
    if name.trim().chars().nth(MAX_NAME_CHARS).is_some() {
        text.push('…');
    }
    text
}

fn paint(
    painter: &egui::Painter,
    screen: Rect,
    most_cities: usize,
    names: &[(TrackLabel, String, NamePlace)],
) {
    let mut cities_left = most_cities;
    let letter = (LETTER_FRACTION * screen.height()).clamp(*LETTER_PX.start(), *LETTER_PX.end());
    let font = FontId::proportional(letter);
    let mut taken: Vec<Rect> = Vec::with_capacity(names.len());
    for (label, name, kind) in names {
        if let NamePlace::City(city) = kind {
            let opacity = city.opacity(CITY_LETTER * letter);
            if cities_left > 0 && opacity > 0.0 {
                let is_written = paint_city(
                    painter,
                    screen,
                    label,
                    name,
                    (city, opacity),
                    letter,
                    &mut taken,
                );
                cities_left -= usize::from(is_written);
            }
            continue;
        }
        let [red, green, blue] = label.color;
        let color = Color32::from_rgb(red, green, blue);
        let galley = painter.layout_no_wrap(name.clone(), font.clone(), color);
        let at = Pos2::from(label.at_px);
        let size = galley.size();
        let Some(place) = free_place(*kind, at, size, letter, screen, &taken) else {
            continue;
        };
        taken.push(place);
        // A dark edge, for names over clouds.
        let edge = 0.06 * letter;
        for (x, y) in [
            (-1.0, 0.0),
            (1.0, 0.0),
            (0.0, -1.0),
            (0.0, 1.0),
            (0.7, 0.7),
            (-0.7, 0.7),
        ] {
            let shadow = place.min + Vec2::new(x, y) * edge.max(1.0);
            painter.galley_with_override_text_color(
                shadow,
                galley.clone(),
                Color32::from_black_alpha(150),
            );
        }
        painter.galley(place.min, galley, color);
    }
}

/// Position of a name that is not a city's; `None` if there is no room.
fn free_place(
    kind: NamePlace,
    at: Pos2,
    size: Vec2,
    letter: f32,
    screen: Rect,
    taken: &[Rect],
) -> Option<Rect> {
    let place = match kind {
        NamePlace::Beside | NamePlace::BesideIfRoom => {
            place(at, size, MARKER_DISTANCE * letter, screen, taken)
        }
        _ => Rect::from_center_size(at, size),
    };
    (kind == NamePlace::Beside || is_free(place, screen, taken)).then_some(place)
}

fn is_free(place: Rect, screen: Rect, taken: &[Rect]) -> bool {
    screen.contains_rect(place) && !taken.iter().any(|other| other.intersects(place))
}

/// Marks a city and writes its name beside it with this opacity, if there is room for both; returns whether there was.
fn paint_city(
    painter: &egui::Painter,
    screen: Rect,
    label: &TrackLabel,
    name: &str,
    (city, opacity): (&CityName, f32),
    letter: f32,
    taken: &mut Vec<Rect>,
) -> bool {
    let letter = CITY_LETTER * letter;
    let [red, green, blue] = label.color;
    let color = Color32::from_rgb(red, green, blue).gamma_multiply(opacity);
    let galley = painter.layout_no_wrap(name.to_owned(), FontId::proportional(letter), color);
    let at = Pos2::from(label.at_px);
    let margin = Vec2::new(0.35, 0.1) * letter;
    let size = galley.size() + 2.0 * margin;
    let plate = place(at, size, MARKER_DISTANCE * letter, screen, taken);
    let dot = Rect::from_center_size(at, Vec2::splat(2.0 * DOT * letter));
    if !(is_free(plate, screen, taken) && is_free(dot, screen, taken)) {
        return false;
    }
    taken.extend([plate, dot]);
    // Faded letters are lost on bright ground sooner than their plate: it fades faster.
    let dark = Color32::from_black_alpha((PLATE * opacity * opacity) as u8);
    painter.rect_filled(plate, 0.3 * letter, dark);
    let edge = dot.expand(0.08 * letter);
    let corner = |rect: Rect| {
        if city.is_capital {
            0.0
        } else {
            0.5 * rect.width()
        }
    };
    painter.rect_filled(edge, corner(edge), dark);
    painter.rect_filled(dot, corner(dot), color);
    painter.galley(plate.min + margin, galley, color);
    true
}

/// Position of a name of this size: right of its marker, left, above or below, the first that is inside the image and overlaps no other name; else
/// to the right, moved into the image.
fn place(at: Pos2, size: Vec2, away: f32, screen: Rect, taken: &[Rect]) -> Rect {
    let beside = [
        (Align2::LEFT_CENTER, Vec2::new(away, 0.0)),
        (Align2::RIGHT_CENTER, Vec2::new(-away, 0.0)),
        (Align2::CENTER_BOTTOM, Vec2::new(0.0, -away)),
        (Align2::CENTER_TOP, Vec2::new(0.0, away)),
    ]
    .map(|(align, off)| align.anchor_size(at + off, size));
    let fits = |rect: &&Rect| {
        screen.contains_rect(**rect) && !taken.iter().any(|other| other.intersects(**rect))
    };
    let chosen = *beside.iter().find(fits).unwrap_or(&beside[0]);
    let max_corner = (screen.max - size).max(screen.min);
    Rect::from_min_size(chosen.min.clamp(screen.min, max_corner), size)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCREEN: Rect = Rect {
        min: Pos2::ZERO,
        max: Pos2::new(640.0, 360.0),
    };

    #[test]
    fn names_stay_in_the_picture_and_off_each_other() {
        let size = Vec2::new(100.0, 15.0);
        let at = |x, y, taken: &[Rect]| place(Pos2::new(x, y), size, 10.0, SCREEN, taken);
        let middle = at(320.0, 180.0, &[]);
        assert_eq!(middle.min, Pos2::new(330.0, 172.5));
        // The same spot again goes to the left, then above.
        let second = at(320.0, 180.0, &[middle]);
        assert_eq!(second.max.x, 310.0);
        let third = at(320.0, 180.0, &[middle, second]);
        assert!(third.max.y < 180.0 && !third.intersects(middle));
        for (x, y) in [
            (0.0, 0.0),
            (639.0, 359.0),
            (639.0, 2.0),
            (1.0, 359.0),
            (600.0, 180.0),
        ] {
            assert!(SCREEN.contains_rect(at(x, y, &[])), "{x} {y}");
        }
        // Wider than the picture: it begins where the picture does.
        let wide = place(
            Pos2::new(5.0, 5.0),
            Vec2::new(900.0, 15.0),
            10.0,
            SCREEN,
            &[],
        );
        assert_eq!(wide.min.x, 0.0);
    }

    #[test]
    fn names_without_room_are_left_out_the_last_first() {
        let size = Vec2::new(100.0, 15.0);
        let mut taken: Vec<Rect> = Vec::new();
        let mut written = Vec::new();
        for n in 0..60 {
            // In a heap, as satellites that were launched together.
            let at = Pos2::new(300.0 + (n * 7 % 40) as f32, 150.0 + (n * 11 % 60) as f32);
            let kind = if n == 0 {
                NamePlace::Beside
            } else {
                NamePlace::BesideIfRoom
            };
            if let Some(place) = free_place(kind, at, size, 14.0, SCREEN, &taken) {
                assert!(!taken.iter().any(|other| other.intersects(place)), "{n}");
                taken.push(place);
                written.push(n);
            }
        }
        assert_eq!(written[..4], [0, 1, 2, 3]);
        assert!((8..40).contains(&written.len()), "{written:?}");
    }

    #[test]
    fn names_of_cities_appear_with_room() {
        let opacity = |room_px| {
            let city = CityName {
                is_capital: false,
                room_px,
            };
            city.opacity(20.0)
        };
        assert_eq!(
            [0.0, 80.0, 95.0, 110.0, 1e9].map(opacity),
            [0.0, 0.0, 0.5, 1.0, 1.0]
        );
    }

    #[test]
    fn any_name_is_one_line() {
        assert_eq!(one_line(" A\nB\u{7}\t "), "A B");
        assert_eq!(one_line("天宫 🚀 \u{202e}x"), "天宫 🚀 \u{202e}x");
        let long = one_line(&"ü".repeat(500));
        assert_eq!(long.chars().count(), MAX_NAME_CHARS + 1);
    }
}
