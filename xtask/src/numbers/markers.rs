//! The text between the markers of a page.

use anyhow::{Context, bail};

const BEGIN: &str = "<!-- numbers ";
const BEGIN_END: &str = " -->";
const END: &str = "<!-- end numbers -->";

/// The page with each marker's text replaced by the result of `text_of` for its name.
///
/// If a line ends after the first marker, the text gets lines of its own; otherwise it stays within the line.
pub fn rewritten(
    page: &str,
    text_of: &mut dyn FnMut(&str) -> anyhow::Result<String>,
) -> anyhow::Result<String> {
    let mut out = String::with_capacity(page.len());
    let mut rest = page;
    loop {
        let line_of = |at: usize| 1 + page[..page.len() - rest.len() + at].matches('\n').count();
        let (begin, end) = (rest.find(BEGIN), rest.find(END));
        if let Some(end) = end.filter(|end| begin.is_none_or(|begin| *end < begin)) {
            bail!("line {}: `{END}` ends nothing", line_of(end));
        }
        let Some(begin) = begin else {
            out.push_str(rest);
            return Ok(out);
        };
        let after = &rest[begin + BEGIN.len()..];
        let Some((name, body)) = after.split_once(BEGIN_END) else {
            bail!("line {}: a marker does not end with `-->`", line_of(begin));
        };
        let Some((old, after)) = body.split_once(END) else {
            bail!("the marker {name:?} has no `{END}`");
        };
        if old.contains(BEGIN) {
            bail!("the marker {name:?} has another before its `{END}`");
        }
        let text = text_of(name).with_context(|| format!("line {}", line_of(begin)))?;
        let text = text.trim_end();
        out.push_str(&rest[..begin]);
        out.push_str(BEGIN);
        out.push_str(name);
        out.push_str(BEGIN_END);
        if old.starts_with('\n') {
            out.push('\n');
            out.push_str(text);
            out.push('\n');
        } else if text.contains('\n') {
            bail!("the text of {name:?} has more than a line: end the line after its marker");
        } else {
            out.push_str(text);
        }
        out.push_str(END);
        rest = after;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(page: &str) -> Result<String, String> {
        rewritten(page, &mut |name| match name {
            "a" => Ok("1.5".into()),
            "b" => Ok("| x |\n|---|\n".into()),
            _ => bail!("unknown {name}"),
        })
        .map_err(|error| format!("{error:#}"))
    }

    #[test]
    fn only_text_between_markers_changes() {
        let page = "# b\n\nIt is <!-- numbers a -->9<!-- end numbers --> m, <!-- numbers a --><!-- end numbers -->.\n\
            <!-- numbers b -->\nold\nlines\n<!-- end numbers -->\nend\n";
        let made = of(page).unwrap();
        assert_eq!(
            made,
            "# b\n\nIt is <!-- numbers a -->1.5<!-- end numbers --> m, <!-- numbers a -->1.5<!-- end numbers -->.\n\
            <!-- numbers b -->\n| x |\n|---|\n<!-- end numbers -->\nend\n"
        );
        assert_eq!(of(&made).unwrap(), made);
        assert_eq!(of("no markers\n").unwrap(), "no markers\n");
    }

    #[test]
    fn broken_markers_are_reported() {
        for (page, must_say) in [
            (
                "x\n<!-- numbers c -->1<!-- end numbers -->",
                "line 2: unknown c",
            ),
            ("<!-- numbers a -->1", "no `<!-- end"),
            ("<!-- numbers a", "does not end"),
            ("1<!-- end numbers -->", "ends nothing"),
            (
                "<!-- numbers a -->1<!-- numbers a -->2<!-- end numbers -->",
                "another",
            ),
            (
                "<!-- numbers b -->1<!-- end numbers -->",
                "more than a line",
            ),
        ] {
            let error = of(page).unwrap_err();
            assert!(error.contains(must_say), "{page}: {error}");
        }
    }
}
