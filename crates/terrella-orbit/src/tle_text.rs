//! The lines of a two-line element file: which belong together, and whether each is whole.

use super::{LineFault, OrbitError};
use std::path::Path;

/// Characters of an element line.
const LINE_LENGTH: usize = 69;
/// Longest name line; catalogues use 24 characters.
const MAX_NAME_CHARS: usize = 128;

/// One element set in a file: both lines complete, of the same satellite, with valid checksums.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElementSet<'t> {
    /// The name line, if there is one, without the leading "0 ".
    pub name: Option<&'t str>,
    /// 69 ASCII characters.
    pub line1: &'t str,
    /// 69 ASCII characters.
    pub line2: &'t str,
    /// Line of `line1` in the file, from 1.
    pub at1: usize,
    /// Line of `line2` in the file, from 1.
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

/// All sets of a file. Every line is checked, also for other satellites: a file with one corrupt line is not trustworthy.
pub(super) fn element_sets<'t>(
    text: &'t str,
    origin: &Path,
) -> Result<Vec<ElementSet<'t>>, OrbitError> {
    let sets = sets_and_faults(text, origin, &mut |_, error| Err(error))?;
    match sets.is_empty() {
        true => Err(OrbitError::NoElements {
            path: origin.to_owned(),
        }),
        false => Ok(sets),
    }
}

/// Callback for a fault and the names of the satellite that is lost, as far as known; its error ends the reading.
pub(super) type Reject<'r> = dyn FnMut(Vec<String>, OrbitError) -> Result<(), OrbitError> + 'r;

/// The sets that are whole; what is wrong with the others goes to `reject`, which may end the reading.
pub(super) fn sets_and_faults<'t>(
    text: &'t str,
    origin: &Path,
    reject: &mut Reject<'_>,
) -> Result<Vec<ElementSet<'t>>, OrbitError> {
    let mut reader = SetReader {
        origin,
        sets: Vec::new(),
        name: None,
        first: None,
        is_line1_corrupt: false,
    };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    for (index, line) in text.lines().enumerate() {
        let (at, line) = (index + 1, line.trim_end());
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let names = reader.names();
        if let Err(error) = reader.line(at, line) {
            let of_line = matches!(kind(line), Ok(LineKind::Line1 | LineKind::Line2));
            let number = Some(columns(line, 3, 7).trim()).filter(|_| of_line);
            let names = names.into_iter().flatten().chain(number);
            reject(names.map(str::to_owned).collect(), error)?;
            // A set in work may be the one that is corrupt: the next line begins again.
            if let Err(again) = reader.begin_anew(at, line) {
                reject(number.map(str::to_owned).into_iter().collect(), again)?;
            }
        }
    }
    let names = reader.names();
    if let Err(error) = reader.end() {
        let names = names.into_iter().flatten();
        reject(names.map(str::to_owned).collect(), error)?;
    }
    Ok(reader.sets)
}

struct SetReader<'t, 'o> {
    origin: &'o Path,
    sets: Vec<ElementSet<'t>>,
    /// A name line that waits for its set.
    name: Option<(usize, &'t str)>,
    /// A line 1 that waits for its line 2.
    first: Option<(usize, &'t str)>,
    /// A line 1 was rejected: its line 2 is skipped with it.
    is_line1_corrupt: bool,
}

impl<'t> SetReader<'t, '_> {
    /// Names of the current set.
    fn names(&self) -> [Option<&'t str>; 2] {
        let number = self.first.map(|(_, line)| columns(line, 3, 7).trim());
        [self.name.map(|(_, name)| name), number]
    }

    fn fault(&self, at: usize, fault: LineFault) -> OrbitError {
        OrbitError::line(self.origin, at, None, fault)
    }

    fn line(&mut self, at: usize, line: &'t str) -> Result<(), OrbitError> {
        let kind = kind(line).map_err(|f| self.fault(at, f))?;
        let was_corrupt = std::mem::take(&mut self.is_line1_corrupt);
        match kind {
            LineKind::Line1 => {
                if let Some((earlier, _)) = self.first {
                    return Err(self.fault(earlier, LineFault::NoLine2));
                }
                check(line, at, self.origin)?;
                self.first = Some((at, line));
            }
            LineKind::Line2 => {
                let Some((at1, line1)) = self.first.take() else {
                    return match was_corrupt {
                        true => Ok(()),
                        false => Err(self.fault(at, LineFault::NoLine1)),
                    };
                };
                check(line, at, self.origin)?;
                let set = ElementSet {
                    name: self.name.take().map(|(_, name)| name),
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
                    return Err(OrbitError::line(self.origin, at, Some(3), mixed));
                }
                self.sets.push(set);
            }
            LineKind::Name => {
                if let Some((earlier, _)) = self.first {
                    return Err(self.fault(earlier, LineFault::NoLine2));
                }
                if let Some((earlier, text)) = self.name {
                    return Err(self.fault(earlier, name_alone(text)));
                }
                self.name = Some((at, check_name(line, at, self.origin)?));
            }
        }
        Ok(())
    }

    /// Forgets the set in work after a fault at this line; the line itself is looked at again if it was not the cause.
    fn begin_anew(&mut self, at: usize, line: &'t str) -> Result<(), OrbitError> {
        let (had_first, had_name) = (self.first.take().is_some(), self.name.take().is_some());
        match kind(line) {
            Ok(LineKind::Line1) => {
                self.is_line1_corrupt = true;
                if had_first {
                    check(line, at, self.origin)?;
                    self.first = Some((at, line));
                    self.is_line1_corrupt = false;
                }
            }
            Ok(LineKind::Name) if had_first || had_name => {
                self.name = Some((at, check_name(line, at, self.origin)?));
            }
            Err(LineFault::Indented | LineFault::LineNumber { .. }) => self.is_line1_corrupt = true,
            _ => {}
        }
        Ok(())
    }

    fn end(&mut self) -> Result<(), OrbitError> {
        if let Some((at, _)) = self.first {
            return Err(self.fault(at, LineFault::NoLine2));
        }
        if let Some((at, text)) = self.name {
            return Err(self.fault(at, name_alone(text)));
        }
        Ok(())
    }
}

enum LineKind {
    Name,
    Line1,
    Line2,
}

fn kind(line: &str) -> Result<LineKind, LineFault> {
    let bare = line.trim_start();
    let mut characters = bare.chars();
    let (digit, next) = (characters.next(), characters.next());
    let kind = match (digit, next) {
        (Some('1'), Some(' ') | None) => LineKind::Line1,
        (Some('2'), Some(' ') | None) => LineKind::Line2,
        // As long as an element line and shaped like one, but not numbered like one.
        (Some(digit @ '3'..='9'), Some(' ')) if bare.len() + 8 > LINE_LENGTH => {
            return Err(LineFault::LineNumber { digit });
        }
        _ => return Ok(LineKind::Name),
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
    if length > MAX_NAME_CHARS {
        let limit = MAX_NAME_CHARS;
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
