//! XML as a stream of elements: those with text are values, those with elements open and close.

use super::super::entry::{Entry, RecordError, RecordFault};
use super::Lines;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use std::borrow::Cow;
use std::path::Path;
use terrella_files::printable;

/// Elements within elements; messages of the CCSDS have nine.
const MAX_DEPTH: usize = 32;

/// Longest text of an element that is looked at, bytes.
const MAX_TEXT_BYTES: usize = 4096;

/// Items of a document, in order.
pub enum XmlItem<'t> {
    /// An element with others in it begins.
    Open(&'t str, usize),
    /// An element with others in it ends.
    Close(&'t str),
    /// An element with text only; `units` is its unit.
    Value(Entry<'t>),
}

/// An element that has begun.
struct Begun {
    name: String,
    unit: Option<String>,
    text: String,
    /// Where its content begins, in bytes.
    at: usize,
    has_children: bool,
}

/// Calls `each` for the elements of a text in their order; ends at its first error. The number beside the name of an
/// opened element is its line. Document types, which could define entities, are rejected.
pub fn walk<E: From<RecordError>>(
    text: &str,
    origin: &Path,
    each: &mut dyn FnMut(XmlItem<'_>) -> Result<(), E>,
) -> Result<(), E> {
    let lines = Lines::of(text);
    let syntax = |at: usize, cause: String| {
        let fault = RecordFault::Syntax {
            format: "XML",
            cause: printable(&cause),
        };
        E::from(lines.place(at).error(origin, fault))
    };
    let mut reader = Reader::from_str(text);
    reader.config_mut().expand_empty_elements = true;
    let mut open: Vec<Begun> = Vec::new();
    let mut had_root = false;
    loop {
        let at = reader.buffer_position() as usize;
        let event = reader.read_event();
        let behind = reader.buffer_position() as usize;
        match event {
            Ok(Event::Start(start)) => {
                if open.len() >= MAX_DEPTH || (open.is_empty() && had_root) {
                    let cause = match open.is_empty() {
                        true => "a second root element".to_owned(),
                        false => format!("more than {MAX_DEPTH} elements within each other"),
                    };
                    return Err(syntax(at, cause));
                }
                had_root = true;
                if let Some(parent) = open.last_mut()
                    && !parent.has_children
                {
                    parent.has_children = true;
                    each(XmlItem::Open(&parent.name, lines.place(parent.at).line))?;
                }
                let unit = units(&start).map_err(|cause| syntax(at, cause))?;
                open.push(Begun {
                    name: start.local_name().as_ref().to_owned(),
                    unit,
                    text: String::new(),
                    at: behind,
                    has_children: false,
                });
            }
            Ok(Event::End(_)) => {
                // Names have been compared by the parser.
                let Some(element) = open.pop() else { continue };
                match element.has_children {
                    true => each(XmlItem::Close(&element.name))?,
                    false => each(XmlItem::Value(entry(&element, text, &lines)))?,
                }
            }
            Ok(Event::Text(piece)) => add(&mut open, &piece.xml10_content()),
            Ok(Event::CData(piece)) => add(&mut open, &piece.xml10_content()),
            Ok(Event::GeneralRef(reference)) => {
                let name = reference.xml10_content();
                let character = match reference.resolve_char_ref() {
                    Ok(Some(character)) => Some(character.to_string()),
                    _ => quick_xml::escape::resolve_xml_entity(&name).map(str::to_owned),
                };
                let character =
                    character.ok_or_else(|| syntax(at, format!("unknown entity &{name};")))?;
                add(&mut open, &character);
            }
            Ok(Event::DocType(_)) => {
                return Err(syntax(
                    at,
                    "a document type, as web pages have; expected a message of the CCSDS"
                        .to_owned(),
                ));
            }
            Ok(Event::Empty(_) | Event::Comment(_) | Event::Decl(_) | Event::PI(_)) => {}
            Ok(Event::Eof) => {
                return match open.last() {
                    Some(element) => Err(syntax(at, format!("<{}> is not closed", element.name))),
                    None if !had_root => Err(syntax(at, "no element".to_owned())),
                    None => Ok(()),
                };
            }
            Err(error) => {
                let at = reader.error_position() as usize;
                return Err(syntax(at, error.to_string()));
            }
        }
    }
}

/// The value of an element, with the place of its first character that is not blank.
fn entry<'b>(element: &'b Begun, text: &str, lines: &Lines<'_>) -> Entry<'b> {
    let blank = text
        .get(element.at..)
        .map_or(0, |rest| rest.len() - rest.trim_start().len());
    Entry {
        key: Cow::Borrowed(&element.name),
        value: Cow::Borrowed(element.text.trim()),
        unit: element.unit.as_deref().map(Cow::Borrowed),
        place: lines.place(element.at + blank),
    }
}

/// Adds text to the innermost element, if it is read.
fn add(open: &mut [Begun], piece: &str) {
    let Some(element) = open.last_mut() else {
        return;
    };
    if element.text.len() + piece.len() <= MAX_TEXT_BYTES {
        element.text.push_str(piece);
    } else if !element.text.ends_with('…') {
        // So that what is left cannot be taken for a whole value.
        element.text.push('…');
    }
}

/// The attribute `units`.
fn units(start: &BytesStart<'_>) -> Result<Option<String>, String> {
    for attribute in start.attributes() {
        let attribute = attribute.map_err(|e| e.to_string())?;
        if attribute.key.local_name().as_ref() == "units" {
            let value = attribute
                .normalized_value(XmlVersion::Implicit1_0)
                .map_err(|e| e.to_string())?;
            return Ok(Some(value.into_owned()));
        }
    }
    Ok(None)
}
