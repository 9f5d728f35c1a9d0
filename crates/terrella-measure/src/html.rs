//! HTML pages of reports: templates filled with measurements. All text is escaped except charts, which are SVG.

use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{Environment, UndefinedBehavior};
use serde::Serialize;

/// Colours and sizes of all pages.
pub(super) const STYLE: &str = include_str!("page.css");

/// A page template could not be rendered.
#[derive(Debug, thiserror::Error)]
#[error("the page {name} cannot be made: {cause}")]
pub struct PageError {
    /// The template.
    name: &'static str,
    /// Error of the template engine.
    cause: minijinja::Error,
}

/// Renders a template, an HTML file's text, with values by name. A missing value is an error; text is escaped unless the template disables it.
///
/// # Errors
/// A template that does not match its values: tests of the pages prevent it.
pub(super) fn page(
    name: &'static str,
    template: &str,
    values: &impl Serialize,
) -> Result<String, PageError> {
    let failed = |cause| PageError { name, cause };
    // Lines that hold nothing but a statement leave nothing behind.
    let syntax = SyntaxConfig::builder()
        .trim_blocks(true)
        .lstrip_blocks(true)
        .keep_trailing_newline(true)
        .build()
        .map_err(failed)?;
    let mut environment = Environment::new();
    environment.set_syntax(syntax);
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    // Names that end in `.html` are escaped as HTML.
    environment.add_template(name, template).map_err(failed)?;
    let template = environment.get_template(name).map_err(failed)?;
    template.render(Serde(values)).map_err(failed)
}

/// A chart for a page.
#[derive(Debug, Serialize)]
pub(super) struct ChartFigure<'p> {
    name: &'p str,
    alt_text: &'p str,
    /// The SVG element without the name of its first tag, so that attributes can be inserted.
    svg_rest: &'p str,
}

impl<'p> ChartFigure<'p> {
    /// Of an SVG document.
    pub fn new(name: &'p str, alt_text: &'p str, svg: &'p str) -> Self {
        let (_, svg_rest) = svg.split_once("<svg ").unwrap_or_default();
        Self {
            name,
            alt_text,
            svg_rest,
        }
    }
}

/// A value with a mark whether it is good enough.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub(super) struct Marked {
    text: String,
    is_good: bool,
}

impl Marked {
    /// A value that is written already.
    pub fn new(text: String, is_good: bool) -> Self {
        Self { text, is_good }
    }
}
