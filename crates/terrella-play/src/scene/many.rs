//! `all` of `[orbit]`: one table for many satellites of a file.

use super::Scene;
use super::choices::OrbitSource;
use super::error::{SceneError, printable};
use super::field::Field;
use super::orbit_keys::RawOrbit;
use super::text::SceneText;
use super::walker::Walker;
use std::ops::RangeInclusive;
use std::path::Path;
use toml::Spanned;

/// Maximum satellites of a scene: several times all tracked objects.
const MAX_SATELLITES: usize = 200_000;

/// Selection of satellites from a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Many {
    /// All satellites.
    All,
    /// Satellites whose name or designator matches a pattern, ignoring case: `*` is any text, `?` any one
    /// character.
    Named(String),
    /// Satellites with catalogue numbers in a range.
    Numbered(RangeInclusive<u64>),
    /// Satellites of a pattern that the scene describes, without a file.
    Pattern(Walker),
}

impl Many {
    /// Parses the string of a scene.
    fn of_text(text: &str) -> Result<Self, &'static str> {
        let text = text.trim();
        if text.is_empty() {
            return Err("must not be empty; write true for all satellites of the file");
        }
        let Some((first, last)) = text.split_once("..") else {
            return Ok(Self::Named(text.to_owned()));
        };
        let bounds = (first.trim().parse(), last.trim().parse());
        match bounds {
            (Ok(first), Ok(last)) if first <= last => Ok(Self::Numbered(first..=last)),
            (Ok(_), Ok(_)) => Err("the range is empty; write the smaller number first"),
            _ => Err(
                "a range is two catalogue numbers, like \"44713..44772\"; names are given by a pattern, like \"STARLINK*\"",
            ),
        }
    }

    /// Whether a satellite with these names and this catalogue number is selected.
    pub fn has<'n>(
        &self,
        mut names: impl Iterator<Item = &'n str>,
        catalogue_number: Option<u64>,
    ) -> bool {
        match self {
            Self::All | Self::Pattern(_) => true,
            Self::Named(pattern) => names.any(|name| matches(pattern, name)),
            Self::Numbered(range) => catalogue_number.is_some_and(|number| range.contains(&number)),
        }
    }

    /// Description of the selection, to precede the name of the file.
    pub fn text(&self) -> String {
        match self {
            Self::All => "all satellites".to_owned(),
            Self::Named(pattern) => format!("satellites that match \"{}\"", printable(pattern)),
            Self::Numbered(range) => {
                format!("satellites numbered {} to {}", range.start(), range.end())
            }
            Self::Pattern(walker) => walker.text(),
        }
    }
}

/// Whether a text matches a pattern. On a mismatch the last `*` is extended by one character. The work is at most the product of both
/// lengths.
fn matches(pattern: &str, text: &str) -> bool {
    let fold = |text: &str| text.trim().to_lowercase().chars().collect::<Vec<_>>();
    let (pattern, text) = (fold(pattern), fold(text));
    let (mut p, mut t) = (0, 0);
    // Position after the last `*`, and the text position when it was reached.
    let mut star: Option<(usize, usize)> = None;
    while let Some(&character) = text.get(t) {
        match (pattern.get(p), star) {
            (Some('*'), _) => {
                p += 1;
                star = Some((p, t));
            }
            (Some(&wanted), _) if wanted == '?' || wanted == character => {
                p += 1;
                t += 1;
            }
            (_, Some((behind, met))) => {
                p = behind;
                t = met + 1;
                star = Some((behind, t));
            }
            (_, None) => return false,
        }
    }
    pattern.iter().skip(p).all(|&left| left == '*')
}

impl SceneText<'_> {
    /// Checks `all`; `has_name` tells whether the table names one satellite.
    pub(super) fn many(
        &self,
        orbit: &RawOrbit,
        source: OrbitSource,
        has_file: bool,
        has_name: bool,
    ) -> Result<Option<Many>, SceneError> {
        let field = orbit.all();
        let many = self.many_of(&field)?;
        field.note(match &many {
            None if !field.is_given() => Err("one satellite is flown"),
            None => Ok("false".to_owned()),
            Some(Many::All) => Ok("true".to_owned()),
            Some(Many::Named(pattern)) => super::record::quoted(pattern),
            // This key cannot hold a pattern.
            Some(Many::Pattern(_)) => Err("walker says which satellites are flown"),
            Some(Many::Numbered(range)) => Ok(format!("\"{}..{}\"", range.start(), range.end())),
        });
        if many.is_none() {
            return Ok(None);
        }
        if !has_file {
            let advice = "all takes satellites of a file; add file = \"…\" to [orbit]";
            return Err(self.reject(&field, advice));
        }
        if has_name {
            let advice = "name and all both say which satellites are flown; leave one out";
            return Err(self.reject(&field, advice));
        }
        let has_numbers = matches!(source, OrbitSource::Tle | OrbitSource::Omm);
        if matches!(many, Some(Many::Numbered(_))) && !has_numbers {
            let advice = "only satellites of source = \"tle\" and \"omm\" have catalogue numbers; give a pattern of names";
            return Err(self.reject(&field, advice));
        }
        Ok(many)
    }

    fn many_of(&self, field: &Field<'_, toml::Value>) -> Result<Option<Many>, SceneError> {
        match field.given.map(Spanned::get_ref) {
            None | Some(toml::Value::Boolean(false)) => Ok(None),
            Some(toml::Value::Boolean(true)) => Ok(Some(Many::All)),
            Some(toml::Value::String(text)) => match Many::of_text(text) {
                Ok(many) => Ok(Some(many)),
                Err(advice) => Err(self.reject(field, advice)),
            },
            Some(_) => {
                let advice = "must be true, false, a pattern of names like \"STARLINK*\" or a range of catalogue numbers like \"44713..44772\"";
                Err(self.reject(field, advice))
            }
        }
    }
}

impl Scene {
    /// Selects all satellites of an orbit file used in place of a scene, if none is named.
    pub fn take_all(&mut self) {
        let is_of_orbits = self.is_of_orbits();
        let orbits = self.orbits.iter_mut().zip(&mut self.orbit_records);
        for (orbit, record) in orbits.filter(|_| is_of_orbits) {
            if orbit.name.is_none() && orbit.source != OrbitSource::Opm {
                orbit.all = Some(Many::All);
                record.set("all", Ok("true".to_owned()));
            }
        }
    }

    /// Replaces each table by its satellites. Each entry has the index of its table, and a name if the table selects many.
    ///
    /// # Errors
    /// Too many satellites.
    pub(crate) fn expand(
        &mut self,
        satellites: Vec<(usize, Option<String>)>,
    ) -> Result<(), SceneError> {
        if satellites.len() > MAX_SATELLITES {
            let table = satellites.iter().find(|(_, name)| name.is_some());
            let table = table.map_or(0, |(table, _)| *table);
            let remedy = format!(
                "the scene has {} satellites; at most {MAX_SATELLITES} are flown: give a pattern of names or a range of numbers",
                satellites.len()
            );
            return Err(self.reject_orbit(table, "all", "true", remedy));
        }
        let mut member = (0, 0);
        let orbits = satellites.iter().filter_map(|(table, name)| {
            let mut orbit = self.orbits.get(*table)?.clone();
            if name.is_some() {
                orbit.name.clone_from(name);
            }
            member = match member {
                (same, before) if same == *table => (same, before + 1),
                _ => (*table, 1),
            };
            orbit.take_place(member.1 - 1);
            Some(orbit)
        });
        self.orbits = orbits.collect();
        self.orbit_tables = satellites.into_iter().map(|(table, _)| table).collect();
        Ok(())
    }

    /// The index of a satellite's table among the `[[orbit]]` tables.
    pub fn orbit_table(&self, orbit: usize) -> usize {
        self.orbit_tables.get(orbit).copied().unwrap_or(orbit)
    }

    /// The first satellite of each table, with the table's number of satellites.
    pub(super) fn first_of_tables(&self) -> Vec<(usize, usize)> {
        let mut firsts: Vec<(usize, usize)> = Vec::new();
        let mut table_before = None;
        for index in 0..self.orbits.len() {
            let table = self.orbit_table(index);
            match firsts.last_mut().filter(|_| table_before == Some(table)) {
                Some((_, count)) => *count += 1,
                None => firsts.push((index, 1)),
            }
            table_before = Some(table);
        }
        firsts
    }

    /// The error for a table that selects many satellites but finds none.
    pub(crate) fn none_of_many(&self, orbit: usize, many: &Many, file: &Path) -> SceneError {
        let remedy = format!(
            "{} has no such satellite; terrella orbit {} --names lists those that it has",
            file.display(),
            file.display()
        );
        self.reject_orbit(orbit, "all", &many.text(), remedy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_as_those_of_a_shell() {
        for (pattern, text, is_match) in [
            ("STARLINK*", "starlink-1008", true),
            ("STARLINK*", "STARLINK", true),
            ("starlink-10?8", "STARLINK-1008", true),
            ("starlink-10?8", "STARLINK-108", false),
            ("*DEB", "FENGYUN 1C DEB", true),
            ("*DEB", "FENGYUN 1C DEB X", false),
            ("*a*b*", "xaxxbx", true),
            ("*a*b*", "xbxxax", false),
            ("ISS (ZARYA)", "ISS (ZARYA)", true),
            ("", "x", false),
            ("*", "", true),
        ] {
            assert_eq!(matches(pattern, text), is_match, "{pattern} {text}");
        }
        // No input takes exponential time.
        assert!(!matches(
            &"*a".repeat(64),
            &"a".repeat(63).repeat(2).replace('a', "b")
        ));
    }

    #[test]
    fn ranges_are_two_numbers() {
        assert_eq!(Many::of_text("1..9"), Ok(Many::Numbered(1..=9)));
        assert_eq!(Many::of_text(" X* "), Ok(Many::Named("X*".to_owned())));
        for bad in ["", "9..1", "a..b", "1..", "..", "1..2..3"] {
            assert!(Many::of_text(bad).is_err(), "{bad}");
        }
        let numbered = Many::Numbered(5..=7);
        assert!(numbered.has([].into_iter(), Some(7)) && !numbered.has([].into_iter(), None));
    }
}
