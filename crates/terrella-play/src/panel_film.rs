//! The dialog that makes a film of what the time line plays.

use super::controls::Controls;
use super::film_plan::FilmPlan;
use super::focus::take_keys;
use super::keys::Action;
use egui::{Align2, Context, RichText, Vec2};

/// Widest dialog, points.
const WIDTH: f32 = 520.0;
/// Highest command before it is scrolled, points.
const HEIGHT: f32 = 140.0;

/// Shows the dialog where it is open.
pub fn show(context: &Context, controls: &Controls, actions: &mut Vec<Action>) {
    let Some(source) = controls.film.as_ref().filter(|_| controls.asks_for_film) else {
        return;
    };
    let plan = FilmPlan::new(source, &controls.film_view());
    let mut is_open = true;
    let dialog = egui::Window::new("Film")
        .open(&mut is_open)
        .order(egui::Order::Foreground)
        .anchor(Align2::CENTER_CENTER, Vec2::ZERO)
        .resizable(false)
        .collapsible(false)
        .show(context, |ui| {
            ui.set_max_width(WIDTH.min(context.content_rect().width() - 40.0));
            ui.label(format!(
                "A film of {:.1} s: the span and the rate of the time line, this view, these layers.",
                plan.length_s
            ));
            let is_making = controls.film_in_work.is_some();
            ui.horizontal(|ui| {
                let make = egui::Button::new("make the film");
                if ui.add_enabled(controls.makes_films && !is_making, make).clicked() {
                    actions.push(Action::MakeFilm);
                }
                ui.label(match &controls.film_in_work {
                    Some(work) => work.clone(),
                    None => plan.file.display().to_string(),
                });
            });
            ui.label("The same film from a terminal:");
            egui::ScrollArea::vertical().max_height(HEIGHT).show(ui, |ui| {
                let command = RichText::new(plan.command()).monospace();
                ui.add(egui::Label::new(command).wrap().selectable(true));
            });
        });
    if let Some(dialog) = dialog {
        take_keys(context, &dialog.response);
    }
    if !is_open {
        actions.push(Action::Film);
    }
}
