//! Appearance of panel, help and messages: dark, rounded, translucent plates.

use egui::{
    Color32, Context, CornerRadius, FontFamily, FontId, Shadow, Stroke, Style, TextStyle, Theme,
    Vec2, Visuals,
};

/// Background of text. It is blended in linear light: white clouds show through more.
const PLATE: Color32 = Color32::from_rgba_unmultiplied_const(13, 18, 26, 248);
/// Fields of text, rails of sliders and bars.
const WELL: Color32 = Color32::from_rgba_unmultiplied_const(4, 6, 10, 200);
const TEXT: Color32 = Color32::from_rgb(208, 216, 226);
const STRONG_TEXT: Color32 = Color32::from_rgb(244, 248, 252);
/// Accent of selected, hovered or dragged elements.
const ACCENT: Color32 = Color32::from_rgb(92, 168, 236);
/// Corner radius of plates and their elements, points.
const PLATE_RADIUS: u8 = 10;
const WIDGET_RADIUS: u8 = 6;
/// Heights of letters, points.
const SIZES: [(TextStyle, f32, FontFamily); 5] = [
    (TextStyle::Heading, 15.0, FontFamily::Proportional),
    (TextStyle::Body, 13.0, FontFamily::Proportional),
    (TextStyle::Button, 13.0, FontFamily::Proportional),
    (TextStyle::Monospace, 12.0, FontFamily::Monospace),
    (TextStyle::Small, 10.5, FontFamily::Proportional),
];

/// Gives a context this look, whichever the system prefers.
pub fn apply(context: &Context) {
    context.set_theme(Theme::Dark);
    context.style_mut_of(Theme::Dark, style);
}

fn style(style: &mut Style) {
    for (text, size, family) in SIZES {
        style.text_styles.insert(text, FontId::new(size, family));
    }
    style.spacing.button_padding = Vec2::new(7.0, 2.0);
    style.visuals = visuals();
}

fn visuals() -> Visuals {
    let mut visuals = Visuals::dark();
    let plate_radius = CornerRadius::same(PLATE_RADIUS);
    visuals.window_fill = PLATE;
    visuals.panel_fill = PLATE;
    visuals.extreme_bg_color = WELL;
    visuals.window_corner_radius = plate_radius;
    visuals.menu_corner_radius = plate_radius;
    visuals.window_stroke = Stroke::new(1.0, Color32::from_white_alpha(20));
    let shadow = Shadow {
        offset: [0, 3],
        blur: 14,
        spread: 0,
        color: Color32::from_black_alpha(90),
    };
    visuals.window_shadow = shadow;
    visuals.popup_shadow = shadow;
    visuals.slider_trailing_fill = true;
    visuals.hyperlink_color = ACCENT;
    visuals.selection.bg_fill = ACCENT.gamma_multiply(0.45);
    visuals.selection.stroke = Stroke::new(1.0, STRONG_TEXT);
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_stroke.color = Color32::from_white_alpha(18);
    widgets.noninteractive.fg_stroke.color = TEXT;
    for (widget, fill, edge, text) in [
        (
            &mut widgets.inactive,
            Color32::from_white_alpha(14),
            Color32::from_white_alpha(40),
            TEXT,
        ),
        (
            &mut widgets.open,
            Color32::from_white_alpha(22),
            Color32::TRANSPARENT,
            STRONG_TEXT,
        ),
        (
            &mut widgets.hovered,
            ACCENT.gamma_multiply(0.28),
            ACCENT,
            STRONG_TEXT,
        ),
        (
            &mut widgets.active,
            ACCENT.gamma_multiply(0.55),
            ACCENT,
            STRONG_TEXT,
        ),
    ] {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.bg_stroke = Stroke::new(1.0, edge);
        widget.fg_stroke.color = text;
        widget.corner_radius = CornerRadius::same(WIDGET_RADIUS);
    }
    visuals
}
