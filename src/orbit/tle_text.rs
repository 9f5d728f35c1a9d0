//! The lines of a two-line element file: which belong together, and whether each is whole.

use super::{LineFault, OrbitError};
use std::path::Path;

/// Characters of an element line.
const LINE_LENGTH: usize = 69;
/// Longest name line; catalogues use 24 characters.
const LONGEST_NAME: usize = 128;

/// One element set as it stands in a file: both lines whole, of one satellite, with good checksums.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElementSet<'t> {
    /// The name line, if there is one, without the leading "0 ".
    pub name: Option<&'t str>,
    /// 69 ASCII characters.
    pub line1: &'t str,
    /// 69 ASCII characters.
    pub line2: &'t str,
    /// Place of `line1` in the file, from 1.
    pub at1: usize,
    /// Place of `line2` in the file, from 1.
    pub at2: usize,
}

impl<'t> ElementSet<'t> {
    /// Columns 3–7, without blanks: a number, or a letter and four digits ("Alpha-5").
    pub fn catalogue(&self) -> &'t str {
        columns(self.line1, 3, 7).trim()
    }

    /// The name, or the catalogue number of a set without one.
    pub fn label(&self) -> &'t str {
        self.name.unwrap_or(self.catalogue())
    }
}

/// The characters of an element line in columns `first` to `last`, counted from 1; empty beyond the end.
pub(super) fn columns(line: &str, first: usize, last: usize) -> &str {
    line.get(first - 1..last).unwrap_or("")
}

/// All sets of a file. Every line is checked, also of satellites that nobody asks for: a file with one spoilt line is
/// not to be trusted.
pub(super) fn element_sets<'t>(
    text: &'t str,
    origin: &Path,
) -> Result<Vec<ElementSet<'t>>, OrbitError> {
    let fault = |at, fault| OrbitError::line(origin, at, None, fault);
    let mut sets = Vec::new();
    let mut name: Option<(usize, &str)> = None;
    let mut first: Option<(usize, &str)> = None;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    for (index, line) in text.lines().enumerate() {
        let (at, line) = (index + 1, line.trim_end());
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        match kind(line).map_err(|f| fault(at, f))? {
            Kind::Line1 => {
                if let Some((earlier, _)) = first {
                    return Err(fault(earlier, LineFault::NoLine2));
                }
                check(line, at, origin)?;
                first = Some((at, line));
            }
            Kind::Line2 => {
                let (at1, line1) = first.take().ok_or_else(|| fault(at, LineFault::NoLine1))?;
                check(line, at, origin)?;
                let set = ElementSet {
                    name: name.take().map(|(_, name)| name),
                    line1,
                    line2: line,
                    at1,
                    at2: at,
                };
                let catalogue2 = columns(line, 3, 7).trim();
                if catalogue2 != set.catalogue() {
                    let mixed = LineFault::Mixed {
                        line1: at1,
                        catalogue1: set.catalogue().to_owned(),
                        catalogue2: catalogue2.to_owned(),
                    };
                    return Err(OrbitError::line(origin, at, Some(3), mixed));
                }
                sets.push(set);
            }
            Kind::Name => {
                if let Some((earlier, _)) = first {
                    return Err(fault(earlier, LineFault::NoLine2));
                }
                if let Some((earlier, text)) = name {
                    return Err(fault(earlier, name_alone(text)));
                }
                name = Some((at, check_name(line, at, origin)?));
            }
        }
    }
    if let Some((at, _)) = first {
        return Err(fault(at, LineFault::NoLine2));
    }
    if let Some((at, text)) = name {
        return Err(fault(at, name_alone(text)));
    }
    if sets.is_empty() {
        return Err(OrbitError::NoElements {
            path: origin.to_owned(),
        });
    }
    Ok(sets)
}

enum Kind {
    Name,
    Line1,
    Line2,
}

fn kind(line: &str) -> Result<Kind, LineFault> {
    let bare = line.trim_start();
    let mut characters = bare.chars();
    let (digit, next) = (characters.next(), characters.next());
    let kind = match (digit, next) {
        (Some('1'), Some(' ') | None) => Kind::Line1,
        (Some('2'), Some(' ') | None) => Kind::Line2,
        // As long as an element line and shaped like one, but not numbered like one.
        (Some(digit @ '3'..='9'), Some(' ')) if bare.len() + 8 > LINE_LENGTH => {
            return Err(LineFault::LineNumber { digit });
        }
        _ => return Ok(Kind::Name),
    };
    if bare.len() == line.len() {
        Ok(kind)
    } else {
        Err(LineFault::Indented)
    }
}

/// Whether an element line is whole: printable ASCII, 69 characters, a checksum that fits.
fn check(line: &str, at: usize, origin: &Path) -> Result<(), OrbitError> {
    let fault = |column, fault| Err(OrbitError::line(origin, at, column, fault));
    if let Some((index, character)) = odd_character(line, |c| matches!(c, ' '..='~')) {
        let expected = "an element line holds ASCII letters, digits, signs and blanks only";
        return fault(
            Some(index + 1),
            LineFault::Character {
                character,
                expected,
            },
        );
    }
    let length = line.len();
    if length < LINE_LENGTH {
        return fault(None, LineFault::Short { length });
    }
    if length > LINE_LENGTH {
        return fault(Some(LINE_LENGTH + 1), LineFault::Long { length });
    }
    let (body, last) = line.split_at(LINE_LENGTH - 1);
    let expected = body.chars().fold(0, |sum, c| {
        sum + c.to_digit(10).unwrap_or(u32::from(c == '-'))
    }) % 10;
    match last.chars().next() {
        Some(found) if found.to_digit(10) != Some(expected) => {
            fault(Some(LINE_LENGTH), LineFault::Checksum { expected, found })
        }
        _ => Ok(()),
    }
}

fn check_name<'t>(line: &'t str, at: usize, origin: &Path) -> Result<&'t str, OrbitError> {
    let fault = |column, fault| Err(OrbitError::line(origin, at, column, fault));
    if let Some((index, character)) = odd_character(line, |c| !c.is_control()) {
        let expected = "a name is printable text";
        return fault(
            Some(index + 1),
            LineFault::Character {
                character,
                expected,
            },
        );
    }
    let length = line.chars().count();
    if length > LONGEST_NAME {
        let limit = LONGEST_NAME;
        return fault(None, LineFault::NameTooLong { length, limit });
    }
    // Three-line sets number the name line 0.
    Ok(line.strip_prefix("0 ").unwrap_or(line).trim())
}

/// The first character that is not allowed, with its place counted in characters.
fn odd_character(line: &str, allowed: fn(char) -> bool) -> Option<(usize, char)> {
    line.chars().enumerate().find(|&(_, c)| !allowed(c))
}

fn name_alone(text: &str) -> LineFault {
    LineFault::NameAlone {
        text: text.to_owned(),
    }
}
