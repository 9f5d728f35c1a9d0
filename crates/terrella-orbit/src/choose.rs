//! Which satellite of a file is meant.

use super::OrbitError;
use super::tle_fields::catalogue_number;
use std::borrow::Cow;
use std::path::Path;

/// How many names an error lists.
const NAMES_LISTED: usize = 5;

/// One of several satellites to choose from.
pub(super) struct Candidate<'c> {
    pub label: Cow<'c, str>,
    /// A unique key for repeated names, as the file writes it.
    pub key: Option<Cow<'c, str>>,
    pub line: usize,
}

impl Candidate<'_> {
    /// Whether nothing in the file says which it is.
    fn is_nameless(&self) -> bool {
        self.label.is_empty() && self.key.is_none()
    }
}

/// The key of satellites in a file, besides their names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Key {
    /// The number in the US catalogue.
    CatalogueNumber,
    /// The international designator.
    Designator,
    /// The identifier of CZML.
    Id,
}

/// The index of the requested satellite, or an error that lists the choices.
pub(super) fn choose(
    sets: &[Candidate<'_>],
    key: Key,
    origin: &Path,
    wanted: Option<&str>,
) -> Result<usize, OrbitError> {
    let matching = match wanted.map(str::trim) {
        None => (0..sets.len()).collect(),
        Some(wanted) => matching(sets, key, wanted),
    };
    match matching.as_slice() {
        [only] => Ok(*only),
        [] => {
            let wanted = shortened(wanted.unwrap_or_default());
            Err(OrbitError::UnknownName {
                path: origin.to_owned(),
                count: sets.len(),
                nearest: nearest(sets, &wanted),
                wanted,
            })
        }
        several => {
            let several: Vec<_> = several.iter().filter_map(|&i| sets.get(i)).collect();
            let has_keys = several.iter().all(|set| set.key.is_some())
                && several
                    .windows(2)
                    .any(|pair| pair.first().map(|s| &s.key) != pair.last().map(|s| &s.key));
            let is_unnamed = key == Key::CatalogueNumber
                && several
                    .iter()
                    .all(|set| Some(&set.label) == set.key.as_ref());
            Err(OrbitError::Ambiguous {
                path: origin.to_owned(),
                what: match key {
                    Key::CatalogueNumber => "element sets",
                    Key::Designator | Key::Id => "satellites",
                },
                wanted: wanted.map(shortened),
                count: several.len(),
                names: several
                    .iter()
                    .take(NAMES_LISTED)
                    .map(|set| described(set, key))
                    .collect(),
                remedy: match (wanted, key) {
                    (None, _) if several.iter().all(|set| set.is_nameless()) => {
                        "give each a name in the file"
                    }
                    (None, Key::Designator) if !has_keys && is_one_name(&several) => {
                        "they overlap in time: keep one of them in the file"
                    }
                    (None, _) if is_unnamed => "name one of these numbers",
                    (None, Key::CatalogueNumber) => {
                        "name the satellite or give its catalogue number"
                    }
                    (None, _) => "name the satellite",
                    (Some(_), Key::CatalogueNumber) if !has_keys => {
                        "keep only the set nearest to the date"
                    }
                    (Some(_), _) if !has_keys => "give each a name of its own in the file",
                    (Some(_), Key::CatalogueNumber) => "give the catalogue number instead",
                    (Some(_), Key::Designator) => "give the designator instead",
                    (Some(_), Key::Id) => "give the id instead",
                },
            })
        }
    }
}

/// Whether all have the same name.
fn is_one_name(sets: &[&Candidate<'_>]) -> bool {
    sets.windows(2)
        .all(|pair| matches!(pair, [one, next] if one.label == next.label))
}

/// Matches for a name: those whose key is equal; else those whose name is equal; else those whose name or key is equal, letter case aside.
fn matching(sets: &[Candidate<'_>], key: Key, wanted: &str) -> Vec<usize> {
    let folded = wanted.to_lowercase();
    let number = match key {
        Key::CatalogueNumber => catalogue_number(wanted),
        _ => None,
    };
    let is_key = |set: &Candidate<'_>| set.key.as_deref() == Some(wanted);
    let is_name = |set: &Candidate<'_>| set.label == wanted;
    let answers = |set: &Candidate<'_>| {
        let key = set.key.as_deref();
        set.label.to_lowercase() == folded
            || key.is_some_and(|key| key.to_lowercase() == folded)
            || number.is_some() && key.and_then(catalogue_number) == number
    };
    let all = |is: &dyn Fn(&Candidate<'_>) -> bool| -> Vec<usize> {
        let found = sets.iter().enumerate().filter(|(_, set)| is(set));
        found.map(|(index, _)| index).collect()
    };
    let ways: [&dyn Fn(&Candidate<'_>) -> bool; 3] = [&is_key, &is_name, &answers];
    let mut found = ways.into_iter().map(all);
    found.find(|found| !found.is_empty()).unwrap_or_default()
}

/// A satellite for a list of those that could be meant.
fn described(set: &Candidate<'_>, key: Key) -> String {
    match (&set.key, key) {
        (Some(id), Key::Id) => format!("{} (id {id:?}, line {})", set.label, set.line),
        (Some(number), _) => format!("{} ({number}, line {})", set.label, set.line),
        (None, _) if set.label.is_empty() => format!("one without a name (line {})", set.line),
        (None, _) => format!("{} (line {})", set.label, set.line),
    }
}

/// The name, or catalogue number, that is most like `wanted`.
fn nearest(sets: &[Candidate<'_>], wanted: &str) -> String {
    let folded = wanted.to_lowercase();
    let likeness = |set: &Candidate<'_>| {
        let name = strsim::jaro_winkler(&folded, &set.label.to_lowercase());
        let key = set.key.as_deref().map(str::to_lowercase);
        let key = key.map_or(0.0, |key| strsim::jaro_winkler(&folded, &key));
        name.max(key)
    };
    sets.iter()
        .map(|set| (likeness(set), &set.label))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map_or_else(String::new, |(_, name)| name.to_string())
}

/// A name from outside, short enough for a message and for comparing with every name of a large file.
fn shortened(name: &str) -> String {
    name.trim().chars().take(128).collect()
}
