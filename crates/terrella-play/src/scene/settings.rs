//! Keys set on the command line in place of a scene's. They change the text, so normal reading and checking applies.

use super::error::SceneError;
use super::text::line_starts;
use std::str::FromStr;
use toml::de::{DeTable, DeValue};

/// One key of a scene and its value, written `table.key=value`: `earth.look=full`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    table: String,
    key: String,
    /// Value in TOML syntax.
    value: String,
}

impl FromStr for Setting {
    type Err = String;

    /// The value is TOML. Text that is not valid TOML, such as a word or a date, becomes a string.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "write it as table.key=value, for example earth.look=full".to_owned();
        let (name, value) = text.split_once('=').ok_or_else(wrong)?;
        let (table, key) = name.trim().split_once('.').ok_or_else(wrong)?;
        let is_name = |name: &str| {
            let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
            !name.is_empty() && name.chars().all(is_letter)
        };
        let value = value.trim();
        if !is_name(table) || !is_name(key) || value.is_empty() || value.contains('\n') {
            return Err(wrong());
        }
        let line = format!("v = {value}");
        let is_toml = DeTable::parse(&line).is_ok_and(|table| {
            let value = table.get_ref().get("v").map(|value| value.get_ref());
            !matches!(value, Some(DeValue::Datetime(_)) | None)
        });
        Ok(Self {
            table: table.to_owned(),
            key: key.to_owned(),
            value: match is_toml {
                true => value.to_owned(),
                false => toml::Value::from(value).to_string(),
            },
        })
    }
}

/// The syntax of `--set`.
impl std::fmt::Display for Setting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}.{}={}", self.table, self.key, self.value)
    }
}

impl Setting {
    /// Creates a setting from a table, a key and a TOML value.
    pub fn new(table: &str, key: &str, value: impl ToString) -> Self {
        Self {
            table: table.to_owned(),
            key: key.to_owned(),
            value: value.to_string(),
        }
    }

    /// The table and the key.
    pub fn of(&self) -> (&str, &str) {
        (&self.table, &self.key)
    }

    /// Whether it sets this key.
    pub(super) fn is_of(&self, table: &str, key: &str) -> bool {
        self.table == table && self.key == key
    }
}

/// A scene's text with keys set. The original lines keep their numbers.
pub(super) struct SetText {
    pub text: String,
    /// Result of [`line_starts`], without inserted lines.
    pub line_starts: Vec<usize>,
}

impl SetText {
    pub fn new(text: &str, settings: &[Setting]) -> Self {
        let mut set = Self {
            text: text.to_owned(),
            line_starts: line_starts(text),
        };
        for setting in settings {
            set.set(setting);
        }
        set
    }

    fn set(&mut self, setting: &Setting) {
        let Setting { table, key, value } = setting;
        let (range, new) = match self.place(table, key) {
            Place::Value(range) => {
                let lines = self.text[range.clone()].matches('\n').count();
                (range, format!("{value}{}", "\n".repeat(lines)))
            }
            Place::LineBefore(at) => (at..at, format!("{key} = {value}\n")),
            // The table does not exist, or the text is invalid; the parser then reports it.
            Place::End => {
                let end = self.text.len();
                (end..end, format!("\n[{table}]\n{key} = {value}\n"))
            }
        };
        let is_line = range.is_empty() && range.end < self.text.len();
        let moved = |start: usize| start - range.len() + new.len();
        let starts = self.line_starts.iter().map(|start| match *start {
            // An inserted line counts as the end of the previous one.
            start if start >= range.end && (is_line || start > range.start) => moved(start),
            start => start,
        });
        let mut starts: Vec<_> = starts.collect();
        if !is_line {
            let inside = new.match_indices('\n').map(|(at, _)| range.start + at + 1);
            starts.retain(|start| !(range.start + 1..range.start + new.len()).contains(start));
            starts.extend(inside);
            starts.sort_unstable();
            starts.dedup();
        }
        self.text.replace_range(range, &new);
        self.line_starts = starts;
    }

    fn place(&self, table: &str, key: &str) -> Place {
        let Ok(document) = DeTable::parse(&self.text) else {
            return Place::End;
        };
        let Some(DeValue::Table(entries)) =
            document.get_ref().get(table).map(|table| table.get_ref())
        else {
            return Place::End;
        };
        if let Some(value) = entries.get(key) {
            return Place::Value(value.span());
        }
        let line_start = |at: usize| self.text[..at].rfind('\n').map_or(0, |end| end + 1);
        let first = entries.keys().map(|key| key.span().start).min();
        let first = first.map(|at| (line_start(at), at));
        match first.filter(|(start, at)| self.text[*start..*at].trim().is_empty()) {
            Some((start, _)) => Place::LineBefore(start),
            // Written within a line, or empty.
            None => self.after_head(table).map_or(Place::End, Place::LineBefore),
        }
    }

    /// Offset of the line after `[table]`.
    fn after_head(&self, table: &str) -> Option<usize> {
        let head = format!("[{table}]");
        let mut at = 0;
        for line in self.text.split_inclusive('\n') {
            at += line.len();
            if line.trim_start().starts_with(&head) && line.ends_with('\n') {
                return Some(at);
            }
        }
        None
    }
}

/// Position of a setting in the text.
enum Place {
    Value(std::ops::Range<usize>),
    LineBefore(usize),
    End,
}

/// Replaces the file by the option's name in an error about a setting or its table.
pub(super) fn of_setting(mut error: SceneError, settings: &[Setting]) -> SceneError {
    if let SceneError::Unknown { place, .. }
    | SceneError::Missing { place, .. }
    | SceneError::Value { place, .. } = &mut error
        && settings.iter().any(|setting| {
            setting.table == place.table && (place.key.is_empty() || setting.key == place.key)
        })
    {
        (place.path, place.line) = ("--set".into(), None);
    }
    error
}

#[cfg(test)]
mod tests {
    use super::super::Scene;
    use super::*;
    use std::path::Path;

    fn settings(texts: &[&str]) -> Vec<Setting> {
        texts.iter().map(|text| text.parse().expect(text)).collect()
    }

    fn scene(text: &str, set: &[&str]) -> Result<Scene, SceneError> {
        Scene::from_toml_with(text, Path::new("a.toml"), &settings(set))
    }

    const TEXT: &str =
        "[time]\nduration_s = 5 # short\n\n[camera]\nmode = \"geodetic\"\nlat_deg = 1\n[output]\n";

    #[test]
    fn keys_are_set_whether_the_scene_has_them_or_not() {
        let all = [
            "time.duration_s=90",
            "camera.lon_deg=7.5",
            "output.fps=12",
            "earth.look=full",
        ];
        let set = scene(TEXT, &all[..2]).expect("a good scene");
        assert_eq!(set.time.duration_s, 90.0);
        assert_eq!((set.camera.lat_deg, set.camera.lon_deg), (1.0, 7.5));
        assert!(scene(TEXT, &all[3..]).is_ok());
        // The last of several settings wins.
        let last = scene(TEXT, &["time.duration_s=90", "time.duration_s=60"]);
        assert_eq!(last.expect("good").time.duration_s, 60.0);
        assert!(scene("", &["time.start=2026-01-01T00:00:00Z"]).is_ok());
        assert!(scene("", &["time.start=\"2026-01-01T00:00:00Z\""]).is_ok());
    }

    #[test]
    fn lines_of_the_file_keep_their_numbers() {
        let text = "[earth]\nlook = \"full\"\n[camera]\nmode = \"geodetic\"\nlat_deg = 100\n";
        for set in [
            &[
                "earth.water=true",
                "camera.lon_deg=7",
                "time.speed=2",
                "earth.clouds=true",
            ][..],
            &["earth.look=standard", "camera.lon_deg=7"],
        ] {
            let error = scene(text, set).expect_err("100 degrees");
            assert_eq!(error.line(), Some(5), "{error}");
        }
        let several = "[output]\nsize = [\n640,\n360]\n[camera]\nlat_deg = 100\n";
        let set = SetText::new(several, &settings(&["output.size=[64, 36]"]));
        assert_eq!(set.line_starts.len(), line_starts(several).len());
        assert!(
            set.text.contains("size = [64, 36]\n\n\n[camera]"),
            "{}",
            set.text
        );
    }

    #[test]
    fn errors_name_the_option() {
        for (set, words) in [
            (
                "camera.lat_deg=100",
                &["--set: [camera] lat_deg = 100: "][..],
            ),
            ("earth.look=nice", &["--set: [earth] look = \"nice\": "]),
            ("earth.loook=full", &["--set: [earth] loook: ", "look"]),
            ("erth.look=full", &["--set: [erth]", "[earth]"]),
        ] {
            let error = scene(TEXT, &[set]).expect_err(set).to_string();
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        }
        for text in [
            "look=full",
            "earth.look",
            "earth.=1",
            "a b.c=1",
            "earth.look=",
            "a.b=1\n[x]",
        ] {
            let error = text.parse::<Setting>().expect_err(text);
            assert!(error.contains("table.key=value"), "{error}");
        }
    }
}
