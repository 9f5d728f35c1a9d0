//! The text of a page of frames: its parts, also of one that is cut off or damaged.

use serde_json::value::RawValue;
use std::collections::BTreeMap;

/// What is between the film and its frames.
pub(super) const BEFORE_FRAMES: &str = ",\n  \"frames\": [";
/// What ends the list of frames, and the document.
pub(super) const END: &str = "\n  ]\n}\n";

/// A page in parts. Nothing is known of any of them yet.
#[derive(Debug, PartialEq)]
pub(super) struct PageText {
    /// JSON of what stands before the frames, by its names.
    head: BTreeMap<String, String>,
    /// JSON of the frames.
    pub(super) entries: Vec<String>,
    /// Whether the page is not whole.
    pub(super) is_cut: bool,
}

impl PageText {
    /// Reads a page. Of one that is cut off or damaged behind its head, each line that begins with JSON is an entry: whoever takes one checks it.
    ///
    /// # Errors
    /// What is no JSON, and was not cut off behind the head of a page either.
    pub(super) fn read(text: &str) -> Result<Self, serde_json::Error> {
        Self::whole(text).or_else(|error| Self::cut(text).ok_or(error))
    }

    fn whole(text: &str) -> Result<Self, serde_json::Error> {
        let mut page = raw_map(text)?;
        let frames = page.remove("frames");
        let entries: Vec<Box<RawValue>> = match &frames {
            Some(frames) => serde_json::from_str(frames)?,
            None => Vec::new(),
        };
        Ok(Self {
            head: page,
            entries: entries.iter().map(|entry| entry.get().to_owned()).collect(),
            is_cut: frames.is_none(),
        })
    }

    fn cut(text: &str) -> Option<Self> {
        // No string of JSON has a line feed in it: this is where the list begins.
        let (head, frames) = text.split_once(BEFORE_FRAMES)?;
        Some(Self {
            head: raw_map(&format!("{head}\n}}")).ok()?,
            entries: frames.lines().filter_map(first_value).collect(),
            is_cut: true,
        })
    }

    /// JSON of a part of the head.
    pub(super) fn head(&self, name: &str) -> Option<&str> {
        self.head.get(name).map(String::as_str)
    }
}

/// The JSON that a line begins with: anything may stand behind it where a page was cut off.
fn first_value(line: &str) -> Option<String> {
    let mut values = serde_json::Deserializer::from_str(line).into_iter::<Box<RawValue>>();
    let value = values.next()?.ok()?;
    Some(value.get().to_owned())
}

fn raw_map(text: &str) -> Result<BTreeMap<String, String>, serde_json::Error> {
    let page: BTreeMap<String, Box<RawValue>> = serde_json::from_str(text)?;
    let parts = page.into_iter();
    Ok(parts
        .map(|(name, value)| (name, value.get().to_owned()))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "{\n  \"format\": \"a\",\n  \"film\": {}";

    fn page() -> String {
        [HEAD, BEFORE_FRAMES, "\n    {\"n\":1},\n    {\"n\":2}", END].concat()
    }

    #[test]
    fn a_whole_page_has_its_parts() {
        let page = PageText::read(&page()).expect("whole");
        assert_eq!(page.head("format"), Some("\"a\""));
        assert_eq!(page.entries, ["{\"n\":1}", "{\"n\":2}"]);
        assert!(!page.is_cut);
    }

    #[test]
    fn of_a_cut_page_the_entries_before_the_cut_stay() {
        let text = page();
        let list = HEAD.len() + BEFORE_FRAMES.len();
        // Behind the last brace all is there.
        for length in 0..text.trim_end().len() {
            let page = PageText::read(&text[..length]);
            assert_eq!(page.is_ok(), length >= list, "{length}");
            let Ok(page) = page else { continue };
            assert!(page.is_cut, "{length}");
            assert_eq!(page.head("film"), Some("{}"));
            let ends = ["1}", "2}"].map(|end| text.find(end).expect("an entry") + 2);
            let before = ends.iter().filter(|end| length >= **end).count();
            assert_eq!(page.entries.len(), before, "{length}");
        }
    }

    #[test]
    fn a_damaged_line_costs_that_line() {
        let text = page().replace("{\"n\":1}", "\0\0\u{fffd}");
        let page = PageText::read(&text).expect("a head");
        assert_eq!(page.entries, ["{\"n\":2}"]);
        let text = [HEAD, BEFORE_FRAMES, "\n    {\"n\":1}\0\0"].concat();
        let page = PageText::read(&text).expect("a head");
        assert_eq!(page.entries, ["{\"n\":1}"]);
        PageText::read("[1]").expect_err("no page");
    }
}
