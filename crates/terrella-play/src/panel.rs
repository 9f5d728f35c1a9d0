//! The panel, the help and messages over the picture.

use super::clock::{FASTEST, SLOWEST};
use super::controls::Controls;
use super::flight::Moment;
use super::focus::take_keys;
use super::hand::FreeEye;
use super::icons::{Icon, icon_button};
use super::keys::{Action, tooltip};
use super::map_scale::{self, MapScale};
use super::panel_film;
use super::panel_help;
use super::panel_layers;
use super::picking::{Picked, ReadOut, altitude_text};
use super::place_text::place_text;
use super::satellite_list;
use super::timeline;
use crate::scene::CameraMode;
use egui::{
    Align2, CollapsingHeader, Color32, ComboBox, Context, Grid, LayerId, Pos2, RichText,
    ScrollArea, Slider, Stroke, Ui, Vec2,
};
use glam::DVec2;
use terrella::frames::{Ellipsoid, rfc3339};
use terrella::{AdaptiveQuality, FrameStats};

/// Longer notices take several lines, points.
const NOTICE_WIDTH: f32 = 420.0;
/// With less room in the middle of the window, a message is beside the panel, points.
const MESSAGE_WIDTH: f32 = 320.0;
/// Margin between the window's edge and overlays, points.
const MARGIN: f32 = 8.0;
/// Height of a window of egui without its content: title, frame, spacing, points.
const WINDOW_CHROME: f32 = 44.0;
/// Height of the panel's buttons, which take two lines, points.
const BUTTONS: f32 = 50.0;
/// Most of the window's width that the panel takes.
const PANEL_FRACTION: f32 = 0.55;
/// Width of the panel's names and of its frame, points.
const NAMES_WIDTH: f32 = 150.0;
/// The rates of time that the panel offers, simulated seconds per second.
const RATES: [f64; 6] = [1.0, 10.0, 60.0, 300.0, 1000.0, 3600.0];
/// Radius of the ring around what is selected, points.
const RING_RADIUS: f32 = 9.0;

/// Data for the panel besides the controls.
pub struct PanelData<'p> {
    /// The satellite's name, if there is one.
    pub satellite: Option<&'p str>,
    /// The moment on screen.
    pub moment: &'p Moment,
    /// The figure of the Earth.
    pub ellipsoid: Ellipsoid,
    /// Counts of the frame on screen.
    pub stats: FrameStats,
    /// Whether the tiles of a pack are drawn.
    pub has_tiles: bool,
    /// Adaptive quality, if a frame time is set.
    pub adaptive: Option<&'p AdaptiveQuality>,
    /// Milliseconds between frames, smoothed; `None` before there are two.
    pub interval_ms: Option<f64>,
    /// Milliseconds of this program's own work on a frame, smoothed.
    pub work_ms: f64,
    /// The adapter's name and backend.
    pub adapter: &'p str,
}

/// Lays out everything and returns the user's actions. Nothing exceeds the window's edge down to 640 × 360 points: high content is scrolled, wide
/// content is wrapped.
pub fn show(context: &Context, controls: &Controls, data: &PanelData<'_>) -> Vec<Action> {
    let mut actions = Vec::new();
    let screen = context.content_rect();
    let mut bottom = 2.0 * MARGIN;
    if controls.shows_line() {
        bottom += timeline::show(context, &controls.line, &controls.clock, &mut actions);
    }
    // The message is above the scale.
    let mut message_bottom = bottom;
    if controls.map_scale
        && let Some(scale) = scale_of(context, data)
    {
        message_bottom += map_scale::show(context, &scale, bottom, &mut actions) + MARGIN;
    }
    let mut panel_right = screen.left();
    if controls.panel {
        let height = screen.height() - MARGIN - bottom - WINDOW_CHROME - BUTTONS;
        let window = egui::Window::new("Terrella")
            .anchor(Align2::LEFT_TOP, Vec2::splat(MARGIN))
            .resizable(false)
            .show(context, |ui| {
                panel(ui, controls, data, height, &mut actions)
            });
        panel_right = window.map_or(panel_right, |window| window.response.rect.right());
    }
    let covered = [panel_right - screen.left(), bottom];
    context.data_mut(|data| data.insert_temp(covered_id(), covered));
    let room = screen.right() - panel_right;
    let mut top = MARGIN;
    if let Some(notice) = controls.live.as_ref().and_then(|live| live.notice.as_ref()) {
        top += show_notice(context, notice, room) + MARGIN;
    }
    if let Some(read_out) = &controls.read_out {
        show_read_out(context, read_out, top, room, &mut actions);
    }
    if let Some(message) = &controls.message {
        show_message(
            context,
            message,
            panel_right - screen.left(),
            message_bottom,
        );
    }
    panel_film::show(context, controls, &mut actions);
    if controls.help {
        panel_help::show(context, covered, &mut actions);
    }
    if controls.asks_to_close {
        ask_to_close(context, &mut actions);
    }
    if controls.is_modal() {
        cover(context);
    }
    actions
}

/// How much of the picture the panel covers on the left and the time line at the bottom, points: what the last [`show`] laid out.
pub fn covered(context: &Context) -> [f32; 2] {
    let covered = context.data(|data| data.get_temp(covered_id()));
    covered.unwrap_or_default()
}

fn covered_id() -> egui::Id {
    egui::Id::new("covered by the panel")
}

/// The ground in the middle of the picture.
fn scale_of(context: &Context, data: &PanelData<'_>) -> Option<MapScale> {
    let size = context.content_rect().size() * context.pixels_per_point();
    let size_px = DVec2::new(f64::from(size.x), f64::from(size.y));
    MapScale::of(&data.moment.view, &data.ellipsoid, size_px)
}

/// An important notice, on the right, in the space beside the panel. Returns its height, points.
fn show_notice(context: &Context, notice: &str, room: f32) -> f32 {
    let width = NOTICE_WIDTH.min(room - 4.0 * MARGIN).max(0.0);
    let area = egui::Area::new("notice".into())
        .anchor(Align2::RIGHT_TOP, Vec2::new(-MARGIN, MARGIN))
        .show(context, |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                // Else it wraps at the width of the notice before.
                ui.set_max_width(width);
                ui.label(RichText::new(notice).color(Color32::GOLD).size(16.0))
            });
        });
    area.response.rect.height()
}

/// A message above what is at the bottom: in the middle of the window, or beside the panel where there is little room.
fn show_message(context: &Context, message: &str, panel_width: f32, bottom: f32) {
    let width = context.content_rect().width();
    let central = width - 2.0 * (panel_width + MARGIN);
    let (shift, room) = match central >= MESSAGE_WIDTH {
        true => (0.0, central - 2.0 * MARGIN),
        false => (0.5 * panel_width, width - panel_width - 4.0 * MARGIN),
    };
    egui::Area::new("message".into())
        .anchor(Align2::CENTER_BOTTOM, Vec2::new(shift, -bottom))
        .show(context, |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(room.max(0.0));
                ui.label(message)
            });
        });
}

/// Information about the selection, on the right, and a ring around it in the image.
fn show_read_out(
    context: &Context,
    read_out: &ReadOut,
    top: f32,
    room: f32,
    actions: &mut Vec<Action>,
) {
    let screen = context.content_rect();
    if let Some(at) = read_out.at {
        let at = Pos2::new(
            screen.left() + at.x as f32 * screen.width(),
            screen.top() + at.y as f32 * screen.height(),
        );
        let painter = context.layer_painter(LayerId::background());
        painter.circle_stroke(at, RING_RADIUS, Stroke::new(1.5, Color32::GOLD));
    }
    egui::Area::new("selection".into())
        .anchor(Align2::RIGHT_TOP, Vec2::new(-MARGIN, top))
        .show(context, |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width((room - 4.0 * MARGIN).max(0.0));
                ui.strong(&read_out.title);
                rows(ui, "selection", &read_out.rows);
                if let Some([lat_deg, lon_deg]) = read_out.passes_over_deg
                    && ui.button("next pass over here").clicked()
                {
                    actions.extend([Action::Place(lat_deg, lon_deg), Action::NextPass]);
                }
            });
        });
}

/// The question that Esc opens.
fn ask_to_close(context: &Context, actions: &mut Vec<Action>) {
    let question = egui::Window::new("Close Terrella?")
        .order(egui::Order::Foreground)
        .anchor(Align2::CENTER_CENTER, Vec2::ZERO)
        .resizable(false)
        .collapsible(false)
        .show(context, |ui| {
            ui.horizontal(|ui| {
                if ui.button("Close (Enter)").clicked() {
                    actions.push(Action::Confirm);
                }
                if ui.button("Stay (Esc)").clicked() {
                    actions.push(Action::Dismiss);
                }
            });
        });
    if let Some(question) = question {
        take_keys(context, &question.response);
    }
}

/// Takes the clicks and the wheel of everything below a dialog.
fn cover(context: &Context) {
    let screen = context.content_rect();
    egui::Area::new("below the dialog".into())
        .order(egui::Order::Middle)
        .fixed_pos(screen.min)
        .show(context, |ui| {
            ui.allocate_response(screen.size(), egui::Sense::click_and_drag())
        });
}

/// `height`: most that the numbers take before they are scrolled, points.
fn panel(
    ui: &mut Ui,
    controls: &Controls,
    data: &PanelData<'_>,
    height: f32,
    actions: &mut Vec<Action>,
) {
    scrolled(ui, height, |ui| {
        numbers(ui, controls, data);
        satellites(ui, controls, actions);
        panel_layers::show(ui, controls, data.stats.exposure_ev, actions);
        details(ui, data);
    });
    buttons(ui, controls, actions);
}

/// Content higher than `height` points is scrolled, with a scroll bar.
fn scrolled(ui: &mut Ui, height: f32, add: impl FnOnce(&mut Ui)) {
    ui.style_mut().spacing.scroll = egui::style::ScrollStyle::solid();
    ScrollArea::vertical().max_height(height).show(ui, add);
}

fn numbers(ui: &mut Ui, controls: &Controls, data: &PanelData<'_>) {
    rows(ui, "numbers", &scene_rows(controls, data));
}

fn satellites(ui: &mut Ui, controls: &Controls, actions: &mut Vec<Action>) {
    let selected = match controls.picked {
        Some(Picked::Satellite(index)) => Some(index),
        _ => None,
    };
    satellite_list::show(ui, &controls.names, selected, controls.searches, actions);
}

fn details(ui: &mut Ui, data: &PanelData<'_>) {
    let details = CollapsingHeader::new("Details").show_unindented(ui, |ui| {
        rows(ui, "details", &detail_rows(data));
    });
    details.header_response.on_hover_text("what a frame costs");
}

fn rows(ui: &mut Ui, name: &str, rows: &[(&str, String)]) {
    let widest = PANEL_FRACTION * ui.ctx().content_rect().width() - NAMES_WIDTH;
    let grid = Grid::new(name).num_columns(2).max_col_width(widest);
    grid.show(ui, |ui| {
        for (name, value) in rows {
            ui.label(*name);
            ui.label(RichText::new(value).monospace());
            ui.end_row();
        }
    });
}

/// Rows about the view and its time.
fn scene_rows<'p>(controls: &'p Controls, data: &PanelData<'_>) -> Vec<(&'p str, String)> {
    let clock = &controls.clock;
    let mut rows = vec![
        ("UTC", rfc3339(data.moment.epoch)),
        (
            "time rate",
            match &controls.live {
                Some(live) => live.pace.clone(),
                None => speed_text(clock.speed(), clock.is_paused()),
            },
        ),
    ];
    if let Some(live) = &controls.live {
        rows.extend(live.rows.iter().cloned());
    }
    if let Some(satellite) = data.moment.satellite {
        let live = controls.live.as_ref().map(|live| live.name.as_str());
        let name = live.or(data.satellite).unwrap_or("unnamed").to_owned();
        let place = satellite.place;
        let speed_km_s = satellite.speed_m_s / 1000.0;
        rows.extend([
            ("satellite", name),
            (
                "sub-satellite point",
                place_text(place.lat_rad, place.lon_rad),
            ),
            ("altitude", altitude_text(place.height_m)),
            ("inertial speed", format!("{speed_km_s:.3} km/s")),
            ("sunlight", satellite.illumination.0.name().to_owned()),
        ]);
        if let Some(error_m) = satellite.error_m {
            rows.push(("uncertainty (1σ)", format!("±{error_m:.1} m")));
        }
    }
    let is_on_satellite = data.moment.satellite.is_some()
        && controls.hand.eye().is_none()
        && controls.mode != CameraMode::Geodetic;
    rows.push(("camera", camera_text(controls).to_owned()));
    if !is_on_satellite {
        let eye = data.stats.eye;
        rows.extend([
            ("camera over", place_text(eye.lat_rad, eye.lon_rad)),
            ("camera altitude", altitude_text(eye.height_m)),
        ]);
    }
    rows.extend([
        (
            "field of view",
            format!("{:.3}°", controls.fov_rad().to_degrees()),
        ),
        ("exposure", format!("{:+.1} EV", data.stats.exposure_ev)),
    ]);
    rows
}

/// Rows about the cost and content of a frame.
fn detail_rows(data: &PanelData<'_>) -> Vec<(&'static str, String)> {
    let mut rows = vec![
        ("frame", frame_text(data.interval_ms, data.work_ms)),
        (
            "blocks",
            format!(
                "{} of {} in sight",
                data.stats.blocks_drawn, data.stats.blocks_visible
            ),
        ),
    ];
    if let Some(error_px) = data.stats.ground.error_px {
        rows.push(("relief", format!("within {error_px:.1} px")));
    }
    if data.has_tiles {
        rows.extend(tile_rows(&data.stats));
    }
    if let Some(adaptive) = data.adaptive {
        rows.push(("quality", quality_text(adaptive)));
    }
    rows.push(("adapter", data.adapter.to_owned()));
    rows
}

fn buttons(ui: &mut Ui, controls: &Controls, actions: &mut Vec<Action>) {
    let clock = &controls.clock;
    ui.horizontal_wrapped(|ui| {
        let pause = match clock.is_paused() {
            true => Icon::Play,
            false => Icon::Pause,
        };
        for (icon, is_on, action) in [
            (Icon::Slower, false, Action::Slower),
            (pause, false, Action::Pause),
            (Icon::Faster, false, Action::Faster),
            (Icon::Reverse, clock.speed() < 0.0, Action::Reverse),
            (Icon::Camera, false, Action::NextCamera),
            (Icon::TimeLine, controls.line.shown, Action::TimeLine),
            (Icon::Help, controls.help, Action::Help),
        ] {
            if icon_button(ui, icon, is_on, true, &tooltip(&action)).clicked() {
                actions.push(action);
            }
        }
    });
    if controls.live.is_none() {
        ui.horizontal(|ui| rates(ui, clock.speed(), actions));
    }
}

/// The rate of time: the usual ones, and all between by a slider.
fn rates(ui: &mut Ui, speed: f64, actions: &mut Vec<Action>) {
    let chosen = ComboBox::from_id_salt("rate").width(56.0);
    let list = chosen.selected_text("rate").show_ui(ui, |ui| {
        for rate in RATES {
            let is_present = speed.abs() == rate;
            if ui
                .selectable_label(is_present, format!("{rate} ×"))
                .clicked()
            {
                actions.push(Action::Rate(rate));
            }
        }
    });
    let does = "simulated seconds per second";
    list.response.on_hover_text(does);
    let mut rate = speed.abs();
    let slider = Slider::new(&mut rate, SLOWEST..=FASTEST)
        .logarithmic(true)
        .max_decimals(2)
        .suffix(" ×");
    if ui.add(slider).on_hover_text(does).changed() {
        actions.push(Action::Rate(rate));
    }
}

/// The panel's lines about tiles.
fn tile_rows(stats: &FrameStats) -> [(&'static str, String); 4] {
    let tiles = &stats.tiles;
    let by_level = |counts: &[u32]| {
        let last = counts.iter().rposition(|n| *n > 0).map_or(1, |n| n + 1);
        let counts: Vec<_> = counts[..last].iter().map(u32::to_string).collect();
        counts.join(" ")
    };
    let mb = |bytes: u64| format!("{:.0} MB", bytes as f64 / 1e6);
    let failures = match tiles.failures {
        0 => String::new(),
        n => format!(", {n} unreadable"),
    };
    [
        (
            "texels",
            format!("{:.2} a pixel at least", stats.texels_per_pixel),
        ),
        (
            "tiles",
            format!(
                "{} wanted, {} held, finest first",
                by_level(&tiles.requested),
                by_level(&tiles.resident)
            ),
        ),
        (
            "loading",
            format!(
                "{} queued, {} decoding, {} to upload, {} stand-ins{failures}",
                tiles.queued, tiles.loading, tiles.waiting_upload, tiles.fallbacks
            ),
        ),
        (
            "so far",
            format!(
                "{} decoded, {} uploaded, {} replaced",
                mb(tiles.decoded_bytes),
                mb(tiles.uploaded_bytes),
                tiles.evictions
            ),
        ),
    ]
}

fn camera_text(controls: &Controls) -> &'static str {
    match controls.hand.eye() {
        Some(FreeEye::Orbit(_)) => return "orbit (C: back)",
        Some(FreeEye::Follow(_)) => return "follow (C: back)",
        None => {}
    }
    match controls.mode {
        CameraMode::Nadir => "nadir",
        CameraMode::Horizon => "horizon",
        CameraMode::Chase => "chase",
        CameraMode::Geodetic => "geodetic",
    }
}

fn speed_text(speed: f64, paused: bool) -> String {
    let times = if speed.abs() < 1.0 {
        format!("{speed} × real time")
    } else {
        format!("{speed:.0} × real time")
    };
    if paused {
        format!("{times}, paused")
    } else {
        times
    }
}

fn frame_text(interval_ms: Option<f64>, work_ms: f64) -> String {
    match interval_ms {
        Some(interval) => format!(
            "{interval:.1} ms ({:.0} per second), {work_ms:.1} ms of it here",
            1000.0 / interval
        ),
        None => format!("{work_ms:.1} ms"),
    }
}

fn quality_text(adaptive: &AdaptiveQuality) -> String {
    let reductions: Vec<_> = adaptive.reductions().map(|what| what.to_string()).collect();
    let target_ms = adaptive.target_ms();
    let drawn = match reductions.is_empty() {
        true => format!("full, held to {target_ms} ms"),
        false => format!("without {}", reductions.join(", ")),
    };
    match adaptive.out_of_reach_ms() {
        Some(cost_ms) => {
            format!("{drawn}; {target_ms} ms is out of reach, frames cost {cost_ms:.1}")
        }
        None => drawn,
    }
}

#[cfg(test)]
#[path = "panel_tests.rs"]
mod tests;

#[cfg(test)]
#[path = "panel_pictures.rs"]
mod pictures;
