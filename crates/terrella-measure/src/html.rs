//! Pages of reports: HTML templates, filled with what was measured. All text is escaped but charts, which are SVG.

use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{Environment, UndefinedBehavior};
use serde::Serialize;

/// Colours and sizes of all pages.
pub(super) const STYLE: &str = include_str!("page.css");

/// A page could not be made of its template.
#[derive(Debug, thiserror::Error)]
#[error("the page {name} cannot be made: {cause}")]
pub struct PageError {
    /// The template.
    name: &'static str,
    /// What the template engine says.
    cause: minijinja::Error,
}

/// Fills a template, an HTML file's text, with values by name. A value that the template asks for and is not given is an
/// error; text is escaped unless the template says otherwise.
///
/// # Errors
/// A template that does not fit its values: the page's tests see to it that there is none.
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
    /// The SVG element without its first tag's name, so that attributes can stand before the others.
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

/// A value with a mark that says whether it is good enough.
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
