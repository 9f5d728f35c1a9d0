//! Captions over finished images: their text and position.

use super::caption_image::{read_image, scaled};
use super::caption_legend::{LaidLegend, rgb};
use super::coverage_layer::{CoverageLegend, coverage_legend};
use super::coverage_scale::CoverageScale;
use super::egui_pass::EguiTarget;
use super::error::PlayError;
use super::flight::{Flight, Moment};
use super::text_overlay::TextOverlay;
use crate::scene::{
    CaptionContent, CaptionPart, CaptionPlace, CaptionTable, CaptionTimes, CaptionValue,
};
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
/// Opacity of the plate behind a legend.
const LEGEND_PLATE_OPACITY: f64 = 0.5;
/// What is not known is written so.
const UNKNOWN: &str = "–";

/// The captions of a scene.
pub struct CaptionLayer {
    overlay: TextOverlay,
    captions: Vec<Caption>,
    start: Epoch,
    satellite: Option<String>,
    legend: Option<Caption>,
    /// On the left and at the bottom, pixels.
    covered_px: [f32; 2],
    has_warned: bool,
}

struct Caption {
    place: CaptionPlace,
    plate_opacity: f64,
    times: CaptionTimes,
    /// Of the picture that was prepared last, 0…1.
    opacity: f64,
    shown: Shown,
}

/// What a caption shows.
enum Shown {
    Text {
        parts: Vec<CaptionPart>,
        size_px: Option<f64>,
        color: [u8; 3],
        /// Of the picture that was prepared last.
        text: String,
    },
    Image(TextureHandle),
    Legend(CoverageScale),
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
    /// The captions of a flight's scene on pictures of the format `shown`, with the legend of its map; `None` where it has neither.
    ///
    /// # Errors
    /// An image that cannot be read, and a map that cannot be computed.
    pub fn of(
        flight: &Flight,
        gpu: &GpuContext,
        shown: wgpu::TextureFormat,
    ) -> Result<Option<Self>, PlayError> {
        let scene = flight.scene();
        let has_legend = scene
            .coverage
            .as_ref()
            .is_some_and(|one| one.legend.is_some());
        if scene.captions.is_empty() && !has_legend {
            return Ok(None);
        }
        let overlay = TextOverlay::new(&gpu.device, shown);
        let captions = scene.captions.iter().map(|table| {
            Ok(match &table.content {
                CaptionContent::Text {
                    parts,
                    size_px,
                    color,
                } => Caption::of(
                    table,
                    Shown::Text {
                        parts: parts.clone(),
                        size_px: *size_px,
                        color: *color,
                        text: String::new(),
                    },
                ),
                CaptionContent::Image { file, width_px } => {
                    let image = scaled(read_image(file)?, *width_px);
                    let image = overlay.load(&file.display().to_string(), image);
                    Caption::of(table, Shown::Image(image))
                }
            })
        });
        let captions = captions.collect::<Result<_, PlayError>>()?;
        Ok(Some(Self {
            captions,
            overlay,
            start: scene.time.start,
            satellite: flight.feed().map(|feed| feed.name().to_owned()),
            legend: coverage_legend(scene, flight)?.map(Caption::legend),
            covered_px: [0.0; 2],
            has_warned: false,
        }))
    }

    /// Leaves so much of the picture to the panel, on the left and at the bottom, pixels.
    #[cfg(feature = "window")]
    pub fn leave_to_panel(&mut self, covered_px: [f32; 2]) {
        self.covered_px = covered_px;
    }

    /// Draws this legend from now on, or none.
    pub fn show_legend(&mut self, legend: Option<CoverageLegend>) {
        self.legend = legend.map(Caption::legend);
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
            caption.opacity = caption.times.opacity(state.elapsed_s());
            if let Shown::Text { parts, text, .. } = &mut caption.shown {
                text.clear();
                for part in parts {
                    match part {
                        CaptionPart::Text(always) => text.push_str(always),
                        CaptionPart::Value(value) => state.write(*value, text),
                    }
                }
            }
        }
    }

    /// Draws them over the finished picture.
    pub fn draw(&mut self, target: EguiTarget<'_>) {
        let all = self.captions.iter().chain(&self.legend);
        let all: Vec<_> = all.filter(|one| one.opacity > 0.0).collect();
        let [left, bottom] = self.covered_px;
        let mut fits = true;
        self.overlay.draw(target, |painter, screen| {
            let free = Rect::from_min_max(
                screen.min + Vec2::new(left.min(0.9 * screen.width()), 0.0),
                screen.max - Vec2::new(0.0, bottom.min(0.9 * screen.height())),
            );
            fits = paint(painter, screen, free, &all);
        });
        if !fits && !std::mem::replace(&mut self.has_warned, true) {
            tracing::warn!(
                "captions do not fit into the picture at their size: some are drawn smaller or left out; shorten them, or give them size_px or width_px"
            );
        }
    }
}

impl Caption {
    fn of(table: &CaptionTable, shown: Shown) -> Self {
        Self {
            place: table.place,
            plate_opacity: table.plate_opacity,
            times: table.times,
            opacity: 1.0,
            shown,
        }
    }

    fn legend(legend: CoverageLegend) -> Self {
        Self {
            place: legend.place,
            plate_opacity: LEGEND_PLATE_OPACITY,
            times: CaptionTimes::ALWAYS,
            opacity: 1.0,
            shown: Shown::Legend(legend.scale),
        }
    }
}

impl CaptionState<'_> {
    /// Since the scene's start.
    fn elapsed_s(&self) -> f64 {
        (self.epoch - self.start).to_seconds() + ROUNDING_S
    }

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
                write!(text, "{}", duration_text(self.elapsed_s()))
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
    Legend(LaidLegend),
}

impl Laid {
    fn size(&self) -> Vec2 {
        match self {
            Self::Text(galley, _) => galley.size(),
            Self::Image(_, size) => *size,
            Self::Legend(legend) => legend.size(),
        }
    }
}

/// Draws all captions in the free part of the picture; answers whether they have the size that they should.
fn paint(painter: &Painter, screen: Rect, free: Rect, captions: &[&Caption]) -> bool {
    let usual = (LETTER_FRACTION * screen.height()).clamp(*LETTER_PX.start(), *LETTER_PX.end());
    let margin = MARGIN_FRACTION * screen.width().min(screen.height());
    let room = free.shrink(margin);
    let mut places: Vec<_> = captions.iter().map(|one| one.place).collect();
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
        let own: Vec<_> = captions.iter().filter(|one| one.place == *place).collect();
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
            let mut painter = painter.clone();
            painter.multiply_opacity(caption.opacity as f32);
            paint_one(&painter, laid, plate, *padding, caption.plate_opacity);
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
    match &caption.shown {
        Shown::Text {
            size_px,
            color,
            text,
            ..
        } => {
            let letter = (size_px.map_or(usual, |size| size as f32) * scale).max(LEAST_PX);
            let padding = PADDING * letter;
            let color = rgb(*color);
            let font = FontId::proportional(letter);
            let wrapped = (width - 2.0 * padding).max(1.0);
            let galley = painter.layout(text.clone(), font, color, wrapped);
            (Laid::Text(galley, color), padding)
        }
        Shown::Image(image) => {
            let padding = PADDING * usual * scale;
            (Laid::Image(image.id(), image.size_vec2() * scale), padding)
        }
        Shown::Legend(of) => {
            let letter = (usual * scale).max(LEAST_PX);
            let padding = PADDING * letter;
            let legend = LaidLegend::new(painter, of, letter, width - 2.0 * padding);
            (Laid::Legend(legend), padding)
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
        Laid::Legend(legend) => legend.paint(painter, at),
    }
}

#[cfg(test)]
#[path = "captions_tests.rs"]
mod tests;
