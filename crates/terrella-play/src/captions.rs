//! Captions over finished images: their text and position.

use super::caption_image::{read_image, scaled};
use super::egui_pass::EguiTarget;
use super::error::PlayError;
use super::flight::{Flight, Moment};
use super::text_overlay::TextOverlay;
use crate::scene::{CaptionContent, CaptionPart, CaptionPlace, CaptionTable, CaptionValue};
use egui::{Color32, FontId, Galley, Painter, Pos2, Rect, TextureHandle, Vec2};
use hifitime::Unit;
use std::fmt::Write;
use std::sync::Arc;
use terrella::frames::{Epoch, Geodetic, TimeScale, ccsds_time};
use terrella::{FrameStats, GpuContext};

/// Default letter height, as a fraction of the image height, and its bounds, pixels.
const LETTER_FRACTION: f32 = 0.03;
const LETTER_PX: std::ops::RangeInclusive<f32> = 12.0..=200.0;
/// Letters are made no smaller than this to fit into a picture, pixels.
const LEAST_PX: f32 = 5.0;
/// And all else no smaller than this part of its size.
const LEAST_SCALE: f32 = 0.02;
/// Factor of each step.
const SHRINKING: f32 = 0.85;
/// Distance from the picture's edges, as a fraction of its shorter side.
const MARGIN_FRACTION: f32 = 0.02;
/// Padding within a plate, and spacing of captions at the same position, in letter heights.
const PADDING: f32 = 0.35;
/// Times of frames are rounded: what is nearly a second is one.
const ROUNDING_S: f64 = 0.0005;
/// Placeholder for an unknown value.
const UNKNOWN: &str = "–";

/// The captions of a scene.
pub struct CaptionLayer {
    overlay: TextOverlay,
    captions: Vec<Caption>,
    start: Epoch,
    satellite: Option<String>,
    has_warned: bool,
}

struct Caption {
    table: CaptionTable,
    /// Text in the last prepared image.
    text: String,
    image: Option<TextureHandle>,
}

/// Values that captions show.
struct CaptionState<'m> {
    epoch: Epoch,
    start: Epoch,
    satellite: Option<&'m str>,
    place: Geodetic,
    speed_m_s: Option<f64>,
}

impl CaptionLayer {
    /// The captions of a flight's scene on images of the format `shown`; `None` if it has none.
    ///
    /// # Errors
    /// An image file that cannot be read.
    pub fn of(
        flight: &Flight,
        gpu: &GpuContext,
        shown: wgpu::TextureFormat,
    ) -> Result<Option<Self>, PlayError> {
        let scene = flight.scene();
        if scene.captions.is_empty() {
            return Ok(None);
        }
        let overlay = TextOverlay::new(&gpu.device, shown);
        let captions = scene.captions.iter().map(|table| {
            let image = match &table.content {
                CaptionContent::Text { .. } => None,
                CaptionContent::Image { file, width_px } => {
                    let image = scaled(read_image(file)?, *width_px);
                    Some(overlay.load(&file.display().to_string(), image))
                }
            };
            Ok(Caption {
                table: table.clone(),
                text: String::new(),
                image,
            })
        });
        let captions = captions.collect::<Result<_, PlayError>>()?;
        Ok(Some(Self {
            captions,
            overlay,
            start: scene.time.start,
            satellite: flight.feed().map(|feed| feed.name().to_owned()),
            has_warned: false,
        }))
    }

    /// Writes down what captions show of an instant.
    pub fn prepare(&mut self, moment: &Moment, stats: &FrameStats) {
        let satellite = moment.satellite;
        let state = CaptionState {
            epoch: moment.epoch,
            start: self.start,
            satellite: self.satellite.as_deref(),
            place: satellite.map_or(stats.eye, |satellite| satellite.place),
            speed_m_s: satellite.map(|satellite| satellite.speed_m_s),
        };
        for caption in &mut self.captions {
            if let CaptionContent::Text { parts, .. } = &caption.table.content {
                caption.text.clear();
                for part in parts {
                    match part {
                        CaptionPart::Text(text) => caption.text.push_str(text),
                        CaptionPart::Value(value) => state.write(*value, &mut caption.text),
                    }
                }
            }
        }
    }

    /// Draws them over the finished picture.
    pub fn draw(&mut self, target: EguiTarget<'_>) {
        let captions = &self.captions;
        let mut fits = true;
        self.overlay.draw(target, |painter, screen| {
            fits = paint(painter, screen, captions);
        });
        if !fits && !std::mem::replace(&mut self.has_warned, true) {
            tracing::warn!(
                "captions do not fit into the picture at their size: some are drawn smaller or left out; shorten them, or give them size_px or width_px"
            );
        }
    }
}

impl CaptionState<'_> {
    /// Adds a value to a text.
    fn write(&self, value: CaptionValue, text: &mut String) {
        // 2018-01-15T12:00:00.000.
        let utc = || ccsds_time(self.epoch + ROUNDING_S * Unit::Second, TimeScale::Utc);
        let degrees = |angle_rad: f64, signs: [&str; 2]| {
            let degrees = angle_rad.to_degrees();
            let sign = signs[usize::from(degrees < 0.0)];
            format!("{:.2}° {sign}", degrees.abs())
        };
        // Writing to a string cannot fail.
        let _ = match value {
            CaptionValue::Time => {
                let utc = utc();
                write!(text, "{} {} UTC", date(&utc), clock(&utc))
            }
            CaptionValue::Date => write!(text, "{}", date(&utc())),
            CaptionValue::Clock => write!(text, "{}", clock(&utc())),
            CaptionValue::Elapsed => {
                let elapsed_s = (self.epoch - self.start).to_seconds() + ROUNDING_S;
                write!(text, "{}", duration_text(elapsed_s))
            }
            CaptionValue::Satellite => write!(text, "{}", self.satellite.unwrap_or(UNKNOWN)),
            CaptionValue::Lat => write!(text, "{}", degrees(self.place.lat_rad, ["N", "S"])),
            CaptionValue::Lon => write!(text, "{}", degrees(self.place.lon_rad, ["E", "W"])),
            CaptionValue::AltitudeKm => write!(text, "{:.1}", self.place.height_m / 1000.0),
            CaptionValue::SpeedKmS => match self.speed_m_s {
                Some(speed_m_s) => write!(text, "{:.3}", speed_m_s / 1000.0),
                None => write!(text, "{UNKNOWN}"),
            },
        };
    }
}

fn date(utc: &str) -> &str {
    utc.split('T').next().unwrap_or(utc)
}

/// Truncates to whole seconds.
fn clock(utc: &str) -> &str {
    let time = utc.split('T').nth(1).unwrap_or_default();
    time.split('.').next().unwrap_or(time)
}

/// Days, hours, minutes and seconds: `01:02:03`, `2d 01:02:03`.
fn duration_text(seconds: f64) -> String {
    // A cast clamps.
    let whole = seconds.abs().floor() as u64;
    let (days, hours) = (whole / 86_400, whole / 3600 % 24);
    let sign = if seconds < 0.0 && whole > 0 {
        "−"
    } else {
        ""
    };
    let days = match days {
        0 => String::new(),
        days => format!("{days}d "),
    };
    format!(
        "{sign}{days}{hours:02}:{:02}:{:02}",
        whole / 60 % 60,
        whole % 60
    )
}

/// Which part of the width and height a place is at: −1 left or top, 0 middle, 1 right or bottom.
fn sides(place: CaptionPlace) -> (i8, i8) {
    match place {
        CaptionPlace::TopLeft => (-1, -1),
        CaptionPlace::Top => (0, -1),
        CaptionPlace::TopRight => (1, -1),
        CaptionPlace::Left => (-1, 0),
        CaptionPlace::Right => (1, 0),
        CaptionPlace::BottomLeft => (-1, 1),
        CaptionPlace::Bottom => (0, 1),
        CaptionPlace::BottomRight => (1, 1),
    }
}

/// A caption as it is drawn.
enum Laid {
    Text(Arc<Galley>, Color32),
    Image(egui::TextureId, Vec2),
}

impl Laid {
    fn size(&self) -> Vec2 {
        match self {
            Self::Text(galley, _) => galley.size(),
            Self::Image(_, size) => *size,
        }
    }
}

/// Draws all captions; returns whether they fit at the intended size.
fn paint(painter: &Painter, screen: Rect, captions: &[Caption]) -> bool {
    let usual = (LETTER_FRACTION * screen.height()).clamp(*LETTER_PX.start(), *LETTER_PX.end());
    let margin = MARGIN_FRACTION * screen.width().min(screen.height());
    let room = screen.shrink(margin);
    let mut places: Vec<_> = captions.iter().map(|one| one.table.place).collect();
    places.sort_unstable();
    places.dedup();
    let mut fits = true;
    for place in &places {
        let (across, down) = sides(*place);
        let row = || places.iter().filter(|other| sides(**other).1 == down);
        let columns = match (row().count(), row().any(|other| sides(*other).0 == 0)) {
            // Those at the sides leave the middle third to the one there.
            (2.., true) => 3.0,
            (count, _) => count as f32,
        };
        let width = room.width() / columns;
        let own: Vec<_> = captions
            .iter()
            .filter(|one| one.table.place == *place)
            .collect();
        // All of a place shrink together until they fit.
        let mut scale = 1.0;
        let laid = loop {
            let laid: Vec<_> = own
                .iter()
                .map(|one| lay_out(painter, one, usual, width, scale))
                .collect();
            let height: f32 = laid
                .iter()
                .map(|(laid, padding)| laid.size().y + 2.0 * padding)
                .sum();
            let widest = laid
                .iter()
                .map(|(laid, padding)| laid.size().x + 2.0 * padding);
            let is_wide = widest.fold(0.0, f32::max) > width + 0.5;
            if (height <= room.height() && !is_wide) || scale < LEAST_SCALE {
                break laid;
            }
            scale *= SHRINKING;
            fits = false;
        };
        let height: f32 = laid
            .iter()
            .map(|(laid, padding)| laid.size().y + 2.0 * padding)
            .sum();
        let mut top = match down {
            -1 => room.top(),
            0 => room.center().y - 0.5 * height,
            _ => room.bottom() - height,
        };
        for ((laid, padding), caption) in laid.iter().zip(&own) {
            let size = laid.size() + Vec2::splat(2.0 * padding);
            let left = match across {
                -1 => room.left(),
                0 => room.center().x - 0.5 * size.x,
                _ => room.right() - size.x,
            };
            let plate = Rect::from_min_size(Pos2::new(left, top), size);
            top += size.y;
            // Even at the smallest letters there is no room.
            if !screen.contains_rect(plate) {
                fits = false;
                continue;
            }
            paint_one(painter, laid, plate, *padding, caption.table.plate_opacity);
        }
    }
    fits
}

/// A caption within a width, at part of its size, and the space around it, pixels.
fn lay_out(
    painter: &Painter,
    caption: &Caption,
    usual: f32,
    width: f32,
    scale: f32,
) -> (Laid, f32) {
    match &caption.table.content {
        CaptionContent::Text { size_px, color, .. } => {
            let letter = (size_px.map_or(usual, |size| size as f32) * scale).max(LEAST_PX);
            let padding = PADDING * letter;
            let [red, green, blue] = *color;
            let color = Color32::from_rgb(red, green, blue);
            let font = FontId::proportional(letter);
            let wrapped = (width - 2.0 * padding).max(1.0);
            let galley = painter.layout(caption.text.clone(), font, color, wrapped);
            (Laid::Text(galley, color), padding)
        }
        CaptionContent::Image { .. } => {
            let padding = PADDING * usual * scale;
            let image = caption.image.as_ref();
            let size = image.map_or(Vec2::ZERO, TextureHandle::size_vec2) * scale;
            let id = image.map_or_else(egui::TextureId::default, TextureHandle::id);
            (Laid::Image(id, size), padding)
        }
    }
}

fn paint_one(painter: &Painter, laid: &Laid, plate: Rect, padding: f32, opacity: f64) {
    // A cast clamps.
    let alpha = (255.0 * opacity).round() as u8;
    if alpha > 0 {
        painter.rect_filled(plate, 0.5 * padding, Color32::from_black_alpha(alpha));
    }
    let at = (plate.min + Vec2::splat(padding)).round();
    match laid {
        Laid::Text(galley, color) => {
            painter.galley(at, Arc::clone(galley), *color);
        }
        Laid::Image(id, size) => {
            let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            painter.image(*id, Rect::from_min_size(at, *size), whole, Color32::WHITE);
        }
    }
}

#[cfg(test)]
#[path = "captions_tests.rs"]
mod tests;
