//! Output of commands, as bodies of CSV files.

use anyhow::{Context, bail};

/// The recorded part of a command's output.
#[derive(Clone, Copy, Debug)]
pub enum Printed {
    /// The lines between `--- begin csv` and `--- end csv`, in all such blocks; all blocks have the same columns.
    Csv,
    /// Lines that match a template: a name in braces is a column and matches everything up to the next literal text; text after the last one must
    /// end the line; `{}` is skipped. Whitespace at the ends of the line is ignored.
    Lines(&'static str),
}

impl Printed {
    /// The CSV of an output.
    pub fn csv(self, output: &str) -> anyhow::Result<String> {
        match self {
            Self::Csv => blocks(output),
            Self::Lines(template) => lines(template, output),
        }
    }
}

/// The figures in an output, by name, with their values as printed: each is the largest of all lines that match the template.
pub fn figures(template: &str, output: &str) -> anyhow::Result<Vec<(String, String)>> {
    let csv = lines(template, output)?;
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let mut figures: Vec<_> = reader
        .headers()?
        .iter()
        .map(|name| (name.to_owned(), f64::NEG_INFINITY, String::new()))
        .collect();
    for record in reader.records() {
        for ((name, largest, text), field) in figures.iter_mut().zip(record?.iter()) {
            let value: f64 = field
                .replace(' ', "")
                .parse()
                .with_context(|| format!("the figure {name:?} is {field:?}, which is no number"))?;
            if value > *largest {
                (*largest, *text) = (value, field.to_owned());
            }
        }
    }
    let figures = figures.into_iter();
    Ok(figures.map(|(name, _, text)| (name, text)).collect())
}

fn blocks(output: &str) -> anyhow::Result<String> {
    let mut csv = String::new();
    let mut head = None;
    for block in output.split("--- begin csv\n").skip(1) {
        let (block, _) = block
            .split_once("--- end csv")
            .context("the command printed no `--- end csv`")?;
        let (columns, rows) = block.split_once('\n').context("a block of CSV is empty")?;
        match head {
            None => csv.push_str(block),
            Some(head) if head == columns => csv.push_str(rows),
            Some(head) => bail!("the columns of blocks of CSV differ: {head} and {columns}"),
        }
        head = head.or(Some(columns));
    }
    if csv.is_empty() {
        bail!("the command printed no `--- begin csv`");
    }
    Ok(csv)
}

fn lines(template: &str, output: &str) -> anyhow::Result<String> {
    let parts = parts(template);
    let columns = parts.iter().filter_map(|(_, column)| *column);
    let columns: Vec<_> = columns.filter(|column| !column.is_empty()).collect();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&columns)?;
    let mut count = 0;
    for line in output.lines() {
        // A test that runs alone has its name at the start of its first line.
        let line = line
            .rsplit_once(" ... ")
            .map_or(line, |(_, line)| line)
            .trim();
        if let Some(fields) = fields(&parts, line) {
            writer.write_record(fields)?;
            count += 1;
        }
    }
    if count == 0 {
        bail!("the command printed no line like `{template}`");
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

/// The literal texts of a template, each with the column that follows it.
fn parts(template: &str) -> Vec<(&str, Option<&str>)> {
    let mut parts = Vec::new();
    let mut rest = template;
    while let Some((text, (column, after))) = rest
        .split_once('{')
        .and_then(|(text, after)| Some((text, after.split_once('}')?)))
    {
        parts.push((text, Some(column)));
        rest = after;
    }
    parts.push((rest, None));
    parts
}

/// The fields of a line; `None` if it does not match the template.
fn fields<'l>(parts: &[(&str, Option<&str>)], line: &'l str) -> Option<Vec<&'l str>> {
    let mut fields = Vec::new();
    let mut rest = line.strip_prefix(parts[0].0)?;
    for pair in parts.windows(2) {
        let (column, next) = (pair[0].1?, pair[1].0);
        let end = match (next, pair[1].1) {
            ("", _) => rest.len(),
            // The last literal text ends the line.
            (next, None) => rest.strip_suffix(next)?.len(),
            (next, Some(_)) => rest.find(next)?,
        };
        if !column.is_empty() {
            fields.push(rest[..end].trim());
        }
        rest = &rest[end + next.len()..];
    }
    Some(fields)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_joined() {
        let output = "running 2 tests\n--- begin csv\na,b\n1,2\n--- end csv\nok\n--- begin csv\na,b\n3,4\n--- end csv\n";
        assert_eq!(Printed::Csv.csv(output).unwrap(), "a,b\n1,2\n3,4\n");
        for bad in [
            "a,b\n",
            "--- begin csv\na\n1",
            "--- begin csv\na\n1\n--- end csv\n--- begin csv\nb\n1\n--- end csv",
        ] {
            assert!(Printed::Csv.csv(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_figure_is_the_largest_of_all_lines() {
        let found = figures(
            "worst {px} px, {m} m",
            "worst 2e-1 px, 7 m\nworst 0.1 px, 9 m\n",
        )
        .unwrap();
        let found: Vec<_> = found
            .iter()
            .map(|(name, text)| (&**name, &**text))
            .collect();
        assert_eq!(found, [("px", "2e-1"), ("m", "9")]);
        assert!(figures("worst {px} px", "worst one px\n").is_err());
        assert!(figures("worst {px} px", "nothing\n").is_err());
    }

    #[test]
    fn lines_are_taken_apart_by_their_template() {
        let template =
            Printed::Lines("n = {cells}, {} m: worst {worst_px} px over {vertices} vertices");
        let output = "test precision ... n = 6, 100 m: worst 0.0003 px over 7 vertices\nother\n\
            n = 48, 1e4 m: worst 0.1 px over 9 vertices  \nn = 1: worst 2 px over 3 vertices\n";
        assert_eq!(
            template.csv(output).unwrap(),
            "cells,worst_px,vertices\n6,0.0003,7\n48,0.1,9\n"
        );
        assert!(template.csv("nothing\n").is_err());
        let end = Printed::Lines("{name}: {rest}");
        assert_eq!(
            end.csv("a, b: c: d\n").unwrap(),
            "name,rest\n\"a, b\",c: d\n"
        );
    }
}
