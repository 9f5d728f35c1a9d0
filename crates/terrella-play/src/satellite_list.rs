//! The panel's list of satellites, with a search by name and catalogue number.

use super::keys::{Action, tooltip};
use super::satellites::Satellite;
use egui::collapsing_header::CollapsingState;
use egui::{Id, Key, RichText, ScrollArea, TextEdit, TextStyle, Ui};
use std::sync::Arc;

/// Rows of the list that are seen at a time.
const ROWS: usize = 6;
/// Width of the list, points.
const WIDTH: f32 = 220.0;
/// Longest text that is searched for, characters.
const LONGEST_QUERY: usize = 64;

/// Search index of satellites.
#[derive(Clone, Debug, Default)]
pub struct SatelliteNames {
    names: Arc<[Name]>,
}

#[derive(Debug)]
struct Name {
    shown: String,
    /// Name and catalogue number in lower case.
    searched: String,
}

/// The satellites that a text finds, in the order of the scene; kept until the text changes.
#[derive(Clone, Debug)]
struct Found {
    query: String,
    indices: Arc<[usize]>,
}

impl SatelliteNames {
    /// For the satellites of a scene.
    pub fn of(satellites: &[Satellite]) -> Self {
        let named = satellites.iter().map(|satellite| {
            let number = satellite.elements().map(|set| set.catalogue_number);
            (satellite.name(), number.filter(|number| *number != 0))
        });
        Self::new(named)
    }

    fn new<'n>(named: impl Iterator<Item = (&'n str, Option<u64>)>) -> Self {
        let names = named.map(|(name, number)| {
            let shown = match (name, number) {
                ("", None) => "unnamed".to_owned(),
                ("", Some(number)) => number.to_string(),
                (name, None) => name.to_owned(),
                (name, Some(number)) => format!("{name}  {number}"),
            };
            let searched = shown.to_lowercase();
            Name { shown, searched }
        });
        Self {
            names: names.collect(),
        }
    }

    /// The satellites with all words of a text in their name or catalogue number, letter case aside.
    fn find(&self, query: &str) -> Arc<[usize]> {
        let query = query.to_lowercase();
        let words: Vec<&str> = query.split_whitespace().collect();
        let names = self.names.iter().enumerate();
        let found = names.filter(|(_, name)| words.iter().all(|word| name.searched.contains(word)));
        found.map(|(index, _)| index).collect()
    }
}

/// Shows the list if there are several satellites. `selected` is the selected one; `searches` counts how often the user has opened the search.
pub fn show(
    ui: &mut Ui,
    names: &SatelliteNames,
    selected: Option<usize>,
    searches: u32,
    actions: &mut Vec<Action>,
) {
    let count = names.names.len();
    if count < 2 {
        return;
    }
    let asked = Id::new("satellite searches");
    let is_asked = ui.data(|data| data.get_temp::<u32>(asked)).unwrap_or(0) < searches;
    ui.data_mut(|data| data.insert_temp(asked, searches));
    let open = Id::new("satellites");
    let mut header = CollapsingState::load_with_default_open(ui.ctx(), open, false);
    if is_asked {
        header.set_open(true);
    }
    header
        .show_header(ui, |ui| {
            let title = ui.label(format!("Satellites ({count})"));
            title.on_hover_text(tooltip(&Action::Search));
        })
        .body_unindented(|ui| {
            let found = search(ui, names, is_asked, actions);
            list(ui, names, &found, selected, actions);
        });
}

/// The line to type in. Enter follows the first satellite found.
fn search(
    ui: &mut Ui,
    names: &SatelliteNames,
    is_asked: bool,
    actions: &mut Vec<Action>,
) -> Arc<[usize]> {
    let id = Id::new("satellite search");
    let kept = ui.data(|data| data.get_temp::<Found>(id));
    let mut found = kept.unwrap_or_else(|| Found {
        query: String::new(),
        indices: names.find(""),
    });
    let edit = TextEdit::singleline(&mut found.query)
        .char_limit(LONGEST_QUERY)
        .desired_width(WIDTH)
        .hint_text("name or catalogue number");
    let response = ui.add(edit);
    if is_asked {
        response.request_focus();
    }
    if response.changed() {
        found.indices = names.find(&found.query);
    }
    if response.lost_focus()
        && ui.input(|input| input.key_pressed(Key::Enter))
        && let Some(first) = found.indices.first()
    {
        actions.push(Action::Follow(*first));
    }
    let indices = Arc::clone(&found.indices);
    ui.data_mut(|data| data.insert_temp(id, found));
    indices
}

fn list(
    ui: &mut Ui,
    names: &SatelliteNames,
    found: &[usize],
    selected: Option<usize>,
    actions: &mut Vec<Action>,
) {
    if found.is_empty() {
        ui.label("none has this name or number");
        return;
    }
    let height = ui.text_style_height(&TextStyle::Body);
    let rows = ScrollArea::vertical()
        .id_salt("satellite list")
        .max_height(ROWS as f32 * (height + ui.spacing().item_spacing.y))
        .auto_shrink([false, true])
        .max_width(WIDTH);
    rows.show_rows(ui, height, found.len(), |ui, range| {
        for index in found[range].iter().copied() {
            let text = RichText::new(&names.names[index].shown);
            let row = ui.selectable_label(selected == Some(index), text);
            if row.double_clicked() {
                actions.push(Action::Follow(index));
            } else if row.clicked() {
                actions.push(Action::Select(index));
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_find_names_and_catalogue_numbers() {
        let names = [
            ("ISS (ZARYA)", Some(25544)),
            ("STARLINK-1007", Some(44713)),
            ("STARLINK-1008", Some(44714)),
            ("", Some(99999)),
            ("", None),
        ];
        let names = SatelliteNames::new(names.into_iter());
        assert_eq!(names.find("")[..], [0, 1, 2, 3, 4]);
        assert_eq!(names.find("starlink")[..], [1, 2]);
        assert_eq!(names.find(" 1008  StarLink ")[..], [2]);
        assert_eq!(names.find("447")[..], [1, 2]);
        assert_eq!(names.find("25544")[..], [0]);
        assert_eq!(names.find("99999")[..], [3]);
        assert_eq!(names.find("unnamed")[..], [4]);
        assert!(names.find("hubble").is_empty());
    }

    /// One layout with these events, at a separate second.
    fn lay_out(
        context: &egui::Context,
        names: &SatelliteNames,
        second: f64,
        searches: u32,
        events: Vec<egui::Event>,
    ) -> Vec<Action> {
        let mut actions = Vec::new();
        let input = egui::RawInput {
            time: Some(second),
            events,
            ..egui::RawInput::default()
        };
        let mut output = context.run_ui(input, |ui| {
            show(ui, names, None, searches, &mut actions);
        });
        output.textures_delta.clear();
        actions
    }

    #[test]
    fn what_is_typed_is_found_and_enter_follows_it() {
        let names = (0..30_000).map(|number| format!("SAT-{number}"));
        let names: Vec<String> = names.collect();
        let names = SatelliteNames::new(names.iter().map(|name| (name.as_str(), None)));
        let context = egui::Context::default();
        assert!(lay_out(&context, &names, 0.0, 0, vec![]).is_empty());
        assert!(!context.text_edit_focused());
        // The key of the search opens the list and puts the cursor there.
        lay_out(&context, &names, 1.0, 1, vec![]);
        lay_out(&context, &names, 2.0, 1, vec![]);
        assert!(context.text_edit_focused());
        let typed = egui::Event::Text("29999".to_owned());
        lay_out(&context, &names, 3.0, 1, vec![typed]);
        let enter = egui::Event::Key {
            key: Key::Enter,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: egui::Modifiers::NONE,
        };
        let actions = lay_out(&context, &names, 4.0, 1, vec![enter]);
        assert_eq!(actions, [Action::Follow(29_999)]);
        assert!(!context.text_edit_focused());
    }
}
