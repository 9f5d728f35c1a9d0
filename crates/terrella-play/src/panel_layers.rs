//! The panel's switches: layers, exposure, tone curve.

use super::controls::Controls;
use super::keys::{Action, tooltip};
use super::switches::{Layer, MEASURED, tone_name};
use egui::{CollapsingHeader, ComboBox, Grid, Slider, Ui};
use terrella::{Exposure, Tone};

/// Check boxes in a row.
const COLUMNS: usize = 3;
/// Step of the exposure's slider, EV.
const EXPOSURE_STEP_EV: f64 = 0.1;
/// In a window at least as high the switches are unfolded at first, points.
const UNFOLDED_FROM: f32 = 600.0;

/// Shows the switches; `exposure_ev` is the picture's.
pub fn show(ui: &mut Ui, controls: &Controls, exposure_ev: f64, actions: &mut Vec<Action>) {
    let is_high = ui.ctx().content_rect().height() >= UNFOLDED_FROM;
    let header = CollapsingHeader::new("Layers and exposure").default_open(is_high);
    header.show_unindented(ui, |ui| {
        layers(ui, controls, actions);
        exposure(ui, controls, exposure_ev, actions);
        look(ui, controls, actions);
        let mut shows_scale = controls.map_scale;
        let scale = ui.checkbox(&mut shows_scale, "scale bar and compass");
        if scale.on_hover_text(tooltip(&Action::MapScale)).clicked() {
            actions.push(Action::MapScale);
        }
    });
}

fn layers(ui: &mut Ui, controls: &Controls, actions: &mut Vec<Action>) {
    let switches = &controls.switches;
    let offered = Layer::ALL.into_iter();
    let offered = offered.filter(|layer| switches.is_offered(*layer));
    Grid::new("layers").num_columns(COLUMNS).show(ui, |ui| {
        for (index, layer) in offered.enumerate() {
            if index > 0 && index % COLUMNS == 0 {
                ui.end_row();
            }
            let mut is_on = switches.is_on(layer);
            if ui.checkbox(&mut is_on, layer.name()).clicked() {
                actions.push(Action::Layer(layer));
            }
        }
    });
}

fn exposure(ui: &mut Ui, controls: &Controls, shown_ev: f64, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        ui.label("exposure");
        let mut is_metered = controls.meters_exposure();
        if ui.checkbox(&mut is_metered, "automatic").clicked() {
            actions.push(Action::Expose(Some(match is_metered {
                true => Exposure::Auto,
                false => Exposure::Ev(shown_ev),
            })));
        }
        let mut ev = match controls.switches.exposure {
            Some(Exposure::Ev(ev)) => ev,
            _ => shown_ev,
        };
        let slider = Slider::new(&mut ev, Exposure::RANGE_EV)
            .step_by(EXPOSURE_STEP_EV)
            .suffix(" EV");
        if ui.add(slider).changed() {
            actions.push(Action::Expose(Some(Exposure::Ev(ev))));
        }
    });
}

fn look(ui: &mut Ui, controls: &Controls, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        ui.label("tone curve");
        let tone = controls.switches.tone;
        let list = ComboBox::from_id_salt("tone").selected_text(tone.map_or(MEASURED, tone_name));
        list.show_ui(ui, |ui| {
            for one in Tone::ALL {
                if ui
                    .selectable_label(Some(one) == tone, tone_name(one))
                    .clicked()
                {
                    actions.push(Action::Tone(one));
                }
            }
        });
        let reset = egui::Button::new("as in the scene");
        if ui.add_enabled(controls.is_switched(), reset).clicked() {
            actions.push(Action::SceneLook);
        }
    });
}
