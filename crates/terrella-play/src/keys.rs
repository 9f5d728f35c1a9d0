//! Key bindings of the window. One table serves the keyboard and the help.

use super::switches::Layer;
use terrella::frames::Epoch;
use terrella::{Exposure, Tone};
use winit::keyboard::{Key, NamedKey};

/// User actions in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Pauses or resumes time.
    Pause,
    /// Doubles the speed, to the next power of two.
    Faster,
    /// Halves it.
    Slower,
    /// Simulated seconds per second.
    Rate(f64),
    /// Turns time round.
    Reverse,
    /// Sets the clock to a fraction of the span, 0…1.
    Seek(f64),
    /// Sets the clock to a date, and the span with it if that is elsewhere.
    GoTo(Epoch),
    /// Moves the clock by seconds of playback at the present speed.
    Skip(f64),
    /// Stops time and sets the clock by so many frames of a film.
    Step(f64),
    /// Zooms the time line by a factor about a fraction of the span, 0…1, and shifts it by a fraction of the visible part.
    ZoomLine { at: f64, factor: f64, by: f64 },
    /// The next camera that makes sense for the scene.
    NextCamera,
    /// Magnifies by 2 to the power of this.
    Zoom(f64),
    /// Turns the head by pixels of a drag: to the right, downwards.
    Drag(f64, f64),
    /// Resets the camera to the scene's.
    ResetView,
    /// North upwards on screen.
    NorthUp,
    /// Shows or hides a layer.
    Layer(Layer),
    /// Exposes so; `None` as the scene does.
    Expose(Option<Exposure>),
    /// Shows light by this curve.
    Tone(Tone),
    /// Shows light by the next curve.
    NextTone,
    /// Layers, exposure and tone curve as the scene has them.
    SceneLook,
    /// Writes the picture without the panel.
    Screenshot,
    /// Toggles full screen.
    FullScreen,
    /// Shows or hides the help.
    Help,
    /// Shows or hides the panel.
    Panel,
    /// Shows or hides the time line.
    TimeLine,
    /// Shows or hides scale bar and compass.
    MapScale,
    /// Begins again at the end, or stops there.
    Loop,
    /// Sets the start of the playback range as a fraction of the span, 0…1; `None` is the current time.
    RangeStart(Option<f64>),
    /// The played range ends there.
    RangeEnd(Option<f64>),
    /// Plays all of the span.
    RangeAll,
    /// Toggles following the real clock.
    RealTime,
    /// Back to the scene's flight, from real time or from a pass.
    SceneSpan,
    /// Moves to the next pass of the satellite over the place.
    NextPass,
    /// The place of passes: latitude and longitude, degrees.
    Place(f64, f64),
    /// Minimum elevation of a pass, degrees.
    MinElevation(f64),
    /// Shows only passes in which the satellite can be seen, or all.
    VisibleOnly,
    /// Opens the list of satellites, to type a name.
    Search,
    /// Selects a satellite, by its place in the scene.
    Select(usize),
    /// Selects a satellite, and flies with it.
    Follow(usize),
    /// Opens or closes the dialog that makes a film.
    Film,
    /// Makes that film.
    MakeFilm,
    /// Closes the topmost dialog; without one, opens the question to close the window.
    Dismiss,
    /// Confirms that question.
    Confirm,
    /// Closes the window.
    Quit,
}

/// A line of the help: keys and their action.
pub struct Binding {
    /// The keys as the help names them.
    pub keys: &'static str,
    /// Their action.
    pub does: &'static str,
    patterns: &'static [KeyPattern],
    action: Action,
}

impl Binding {
    /// What its keys do.
    pub fn action(&self) -> Action {
        self.action
    }
}

enum KeyPattern {
    Named(NamedKey),
    Char(&'static str),
}

use KeyPattern::{Char, Named};

/// All keys.
pub const BINDINGS: &[Binding] = &[
    Binding {
        keys: "Space",
        does: "play or pause",
        patterns: &[Named(NamedKey::Space)],
        action: Action::Pause,
    },
    Binding {
        keys: ". or +",
        does: "faster",
        patterns: &[Char("."), Char("+"), Char("="), Char(">")],
        action: Action::Faster,
    },
    Binding {
        keys: ", or -",
        does: "slower",
        patterns: &[Char(","), Char("-"), Char("<"), Char("_")],
        action: Action::Slower,
    },
    Binding {
        keys: "R",
        does: "reverse time",
        patterns: &[Char("r")],
        action: Action::Reverse,
    },
    Binding {
        keys: "Right",
        does: "forward 5 seconds of playback",
        patterns: &[Named(NamedKey::ArrowRight)],
        action: Action::Skip(5.0),
    },
    Binding {
        keys: "Left",
        does: "back 5 seconds of playback",
        patterns: &[Named(NamedKey::ArrowLeft)],
        action: Action::Skip(-5.0),
    },
    Binding {
        keys: "]",
        does: "pause and go forward one frame",
        patterns: &[Char("]")],
        action: Action::Step(1.0),
    },
    Binding {
        keys: "[",
        does: "pause and go back one frame",
        patterns: &[Char("[")],
        action: Action::Step(-1.0),
    },
    Binding {
        keys: "C",
        does: "next camera; from a moved globe back to the scene's",
        patterns: &[Char("c")],
        action: Action::NextCamera,
    },
    Binding {
        keys: "Up",
        does: "narrow the field of view",
        patterns: &[Named(NamedKey::ArrowUp), Named(NamedKey::PageUp)],
        action: Action::Zoom(0.25),
    },
    Binding {
        keys: "Down",
        does: "widen the field of view",
        patterns: &[Named(NamedKey::ArrowDown), Named(NamedKey::PageDown)],
        action: Action::Zoom(-0.25),
    },
    Binding {
        keys: "Home",
        does: "the scene's own view",
        patterns: &[Named(NamedKey::Home)],
        action: Action::ResetView,
    },
    Binding {
        keys: "U",
        does: "north up",
        patterns: &[Char("u")],
        action: Action::NorthUp,
    },
    Binding {
        keys: "S or F12",
        does: "save a picture in the working folder",
        patterns: &[Char("s"), Named(NamedKey::F12)],
        action: Action::Screenshot,
    },
    Binding {
        keys: "F or F11",
        does: "full screen",
        patterns: &[Char("f"), Named(NamedKey::F11)],
        action: Action::FullScreen,
    },
    Binding {
        keys: "P",
        does: "hide or show the panel",
        patterns: &[Char("p")],
        action: Action::Panel,
    },
    Binding {
        keys: "T",
        does: "hide or show the time line",
        patterns: &[Char("t")],
        action: Action::TimeLine,
    },
    Binding {
        keys: "X",
        does: "show or hide scale bar and compass",
        patterns: &[Char("x")],
        action: Action::MapScale,
    },
    Binding {
        keys: "L",
        does: "at the end begin again, or stop",
        patterns: &[Char("l")],
        action: Action::Loop,
    },
    Binding {
        keys: "I",
        does: "play from here",
        patterns: &[Char("i")],
        action: Action::RangeStart(None),
    },
    Binding {
        keys: "O",
        does: "play to here",
        patterns: &[Char("o")],
        action: Action::RangeEnd(None),
    },
    Binding {
        keys: "A",
        does: "play all",
        patterns: &[Char("a")],
        action: Action::RangeAll,
    },
    Binding {
        keys: "W",
        does: "real time: follow the real clock",
        patterns: &[Char("w")],
        action: Action::RealTime,
    },
    Binding {
        keys: "N",
        does: "next pass over the place of the time line",
        patterns: &[Char("n")],
        action: Action::NextPass,
    },
    Binding {
        keys: "J",
        does: "make a film of what the time line plays",
        patterns: &[Char("j")],
        action: Action::Film,
    },
    Binding {
        keys: "Y",
        does: "show only visible passes, or all passes",
        patterns: &[Char("y")],
        action: Action::VisibleOnly,
    },
    Binding {
        keys: "B",
        does: "back to the scene's flight",
        patterns: &[Char("b")],
        action: Action::SceneSpan,
    },
    Binding {
        keys: "/",
        does: "search the satellites by name or number",
        patterns: &[Char("/")],
        action: Action::Search,
    },
    Binding {
        keys: "G",
        does: "hide or show the graticule",
        patterns: &[Char("g")],
        action: Action::Layer(Layer::Graticule),
    },
    Binding {
        keys: "M",
        does: "hide or show coast lines",
        patterns: &[Char("m")],
        action: Action::Layer(Layer::CoastLines),
    },
    Binding {
        keys: "K",
        does: "hide or show clouds",
        patterns: &[Char("k")],
        action: Action::Layer(Layer::Clouds),
    },
    Binding {
        keys: "D",
        does: "hide or show the atmosphere",
        patterns: &[Char("d")],
        action: Action::Layer(Layer::Atmosphere),
    },
    Binding {
        keys: "V",
        does: "next tone curve",
        patterns: &[Char("v")],
        action: Action::NextTone,
    },
    Binding {
        keys: "E",
        does: "automatic exposure",
        patterns: &[Char("e")],
        action: Action::Expose(Some(Exposure::Auto)),
    },
    Binding {
        keys: "H or F1",
        does: "open or close this help",
        patterns: &[Char("h"), Char("?"), Named(NamedKey::F1)],
        action: Action::Help,
    },
    Binding {
        keys: "Esc",
        does: "close this help, clear the selection, leave full screen, or ask to close the window",
        patterns: &[Named(NamedKey::Escape)],
        action: Action::Dismiss,
    },
    Binding {
        keys: "Enter",
        does: "answer yes when asked to close the window, or make the film",
        patterns: &[Named(NamedKey::Enter)],
        action: Action::Confirm,
    },
    Binding {
        keys: "Q",
        does: "close the window at once",
        patterns: &[Char("q")],
        action: Action::Quit,
    },
];

/// Mouse actions, for the help.
pub const MOUSE: &[(&str, &str)] = &[
    (
        "drag",
        "turn the globe under the pointer, or circle the spacecraft; on the time line: set the clock",
    ),
    (
        "right or Shift drag",
        "tilt and turn the globe around the middle; with the scene's camera: look around",
    ),
    (
        "wheel or pinch",
        "approach the place under the pointer; flying with a satellite: field of view",
    ),
    ("Ctrl and wheel", "field of view"),
    (
        "time line: wheel",
        "show less or more of it; with Shift: move along it",
    ),
    ("click", "select a satellite or a place"),
    (
        "double click",
        "follow the satellite, or bring the place into the middle",
    ),
];

/// The action of a key, letter case aside.
pub fn action_of(key: &Key) -> Option<Action> {
    let means = |pattern: &KeyPattern| match (pattern, key) {
        (Named(wanted), Key::Named(pressed)) => wanted == pressed,
        (Char(wanted), Key::Character(pressed)) => pressed.eq_ignore_ascii_case(wanted),
        _ => false,
    };
    let binding = BINDINGS
        .iter()
        .find(|binding| binding.patterns.iter().any(means));
    binding.map(|binding| binding.action)
}

/// The first binding that does this.
fn binding_of(action: &Action) -> Option<&'static Binding> {
    BINDINGS.iter().find(|binding| binding.action == *action)
}

/// The tooltip of a button: its action and its key, as in the help.
pub fn tooltip(action: &Action) -> String {
    binding_of(action).map_or(String::new(), |binding| {
        format!("{} ({})", binding.does, binding.keys)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_do_what_the_help_says() {
        let char = |c: &str| action_of(&Key::Character(c.into()));
        let named = |name| action_of(&Key::Named(name));
        assert_eq!(named(NamedKey::Space), Some(Action::Pause));
        assert_eq!(char("C"), Some(Action::NextCamera));
        assert_eq!(char("c"), Some(Action::NextCamera));
        assert_eq!(char("+"), Some(Action::Faster));
        assert_eq!(char("-"), Some(Action::Slower));
        assert_eq!(named(NamedKey::F12), Some(Action::Screenshot));
        assert_eq!(named(NamedKey::Escape), Some(Action::Dismiss));
        assert_eq!(named(NamedKey::Enter), Some(Action::Confirm));
        assert_eq!(char("q"), Some(Action::Quit));
        assert_eq!(char("z"), None);
        assert_eq!(named(NamedKey::Tab), None);
    }

    #[test]
    fn the_help_is_in_plain_words() {
        let does = |action| binding_of(&action).map(|binding| binding.does);
        assert_eq!(
            does(Action::Skip(5.0)),
            Some("forward 5 seconds of playback")
        );
        assert_eq!(does(Action::Skip(-5.0)), Some("back 5 seconds of playback"));
        for binding in BINDINGS {
            for idiom in ["on the wall", "alone", "playback on", "frame on"] {
                assert!(!binding.does.contains(idiom), "{}", binding.does);
            }
        }
    }

    #[test]
    fn no_key_does_two_things() {
        for binding in BINDINGS {
            for pattern in binding.patterns {
                let key = match pattern {
                    Named(name) => Key::Named(*name),
                    Char(text) => Key::Character((*text).into()),
                };
                assert_eq!(action_of(&key), Some(binding.action), "{}", binding.keys);
            }
        }
    }
}
