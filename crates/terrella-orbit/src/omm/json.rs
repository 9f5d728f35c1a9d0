//! Elements in JSON: an array of objects, one object, an array inside a server's object, or one object per line.

use super::super::entry::{MAX_ENTRIES, RecordError, RecordFault};
use super::super::text::json::Document;
use super::fields::{ElementEntries, OmmSource};
use super::{BadRecord, Each, Read, check_count, elements};
use crate::OrbitError;
use serde_json::value::RawValue;
use std::path::Path;
use terrella_files::excerpt;

/// Maximum number of objects around the array of satellites.
const MAX_WRAPPERS: usize = 4;

/// Calls `each` for every satellite.
pub(super) fn each_elements(
    text: &str,
    origin: &Path,
    each: &mut Each<'_>,
) -> Result<(), OrbitError> {
    let document = Document::new(text, origin);
    let mut count = 0;
    let mut put = |value: Result<&RawValue, RecordError>| -> Result<(), OrbitError> {
        let value = match value {
            Ok(value) => value,
            Err(error) => return each(Err(BadRecord::new(Vec::new(), error))),
        };
        count += 1;
        check_count(count, document.place(value), origin)?;
        each(read(&document, value))
    };
    let list = |part, put: &mut dyn FnMut(_) -> _| {
        document.each_member(part, MAX_ENTRIES, "satellites", &mut |value| put(Ok(value)))
    };
    if !text.trim_start().starts_with('{') {
        return list(text, &mut put);
    }
    document.each_of_stream(&mut |value| {
        let within = value.and_then(|value| Ok((value, wrapped(&document, value)?)));
        match within {
            Ok((_, Some(part))) => list(part, &mut put),
            Ok((value, None)) => put(Ok(value)),
            Err(error) => put(Err(error)),
        }
    })
}

fn read(document: &Document<'_>, value: &RawValue) -> Read {
    let object = document
        .object(value, "an object with the elements of a satellite")
        .map_err(|error| BadRecord::new(Vec::new(), error))?;
    let mut record = ElementEntries::new("the object", document.place(value));
    for (key, value) in &object.0 {
        if let Some(entry) = document.entry(key, value)
            && let Err(error) = record.add(entry, document.origin)
        {
            let names = ElementEntries::NAMES.iter().filter_map(|key| {
                let entry = document.entry(key, object.get(key)?)?;
                Some(entry.value.into_owned())
            });
            return Err(BadRecord::new(names.collect(), error));
        }
    }
    elements(&record, document.origin, OmmSource::Catalogue)
}

/// The array of satellites inside an object that has no elements itself, as `{"results": […]}`. `None` for an object
/// with elements.
fn wrapped<'t>(
    document: &Document<'t>,
    value: &'t RawValue,
) -> Result<Option<&'t str>, RecordError> {
    let mut lists = Vec::new();
    if collect_lists(document, value, MAX_WRAPPERS, &mut lists)? {
        return Ok(None);
    }
    // A list of messages may accompany the list of satellites.
    let has_elements = |list: &&RawValue| list.get().contains("\"MEAN_MOTION\"");
    if lists.iter().any(has_elements) {
        lists.retain(has_elements);
    }
    match lists.as_slice() {
        [list] => Ok(Some(list.get())),
        [] => {
            let (what, key) = ("the object", "MEAN_MOTION");
            let remedy =
                "; expected the elements of a satellite, or under any name a list of such objects";
            Err(document.error(value, RecordFault::Missing { what, key, remedy }))
        }
        [_, second, ..] => {
            let text = excerpt(second.get());
            let expected = "one list of satellites in the object";
            Err(document.error(second, RecordFault::Unexpected { text, expected }))
        }
    }
}

/// Collects the arrays of objects within an object, recursively. Returns whether the object is a satellite itself.
fn collect_lists<'t>(
    document: &Document<'t>,
    value: &'t RawValue,
    depth: usize,
    lists: &mut Vec<&'t RawValue>,
) -> Result<bool, RecordError> {
    if !value.get().starts_with('{') {
        return Ok(true);
    }
    let object = document.object(value, "an object of fewer members")?;
    let is_element = |key: &&str| object.get(key).is_some();
    if ["MEAN_MOTION", "EPOCH", "OBJECT_NAME"]
        .iter()
        .any(is_element)
    {
        return Ok(true);
    }
    for (_, member) in &object.0 {
        let inner = member.get().strip_prefix('[').map(str::trim_start);
        match inner {
            Some(inner) if inner.starts_with('{') => lists.push(member),
            None if member.get().starts_with('{') && depth > 1 => {
                collect_lists(document, member, depth - 1, lists)?;
            }
            _ => {}
        }
    }
    Ok(false)
}
