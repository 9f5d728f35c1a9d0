//! The file of a recorded run: place and method of the measurement, then its results.
//!
//! CSV files begin with lines `# key: value`, JSON files have the keys in an object `recorded` beside the object `run`.

use super::recordings::Recording;
use anyhow::{Context, bail};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Folder of recorded runs, from the repository's root.
pub const FOLDER: &str = "docs/recorded";

/// The metadata keys of every recorded run, in this order.
pub const KEYS: [&str; 8] = [
    "method", "command", "adapter", "driver", "cpu", "os", "commit", "date",
];

/// The columns of a file of single figures.
pub const FIGURES: [&str; 3] = ["name", "value", "command"];

/// A recorded run.
pub struct Recorded {
    file: String,
    head: Vec<(String, String)>,
    body: Body,
}

/// The measured data.
enum Body {
    /// Rows; the first one names the columns.
    Csv(Vec<Vec<String>>),
    Json(Value),
}

impl Recorded {
    /// Reads the file of a recording.
    pub fn load(root: &Path, recording: &Recording) -> anyhow::Result<Self> {
        let file = format!("{FOLDER}/{}", recording.file);
        let text = fs::read_to_string(root.join(&file)).with_context(|| {
            format!(
                "cannot read {file}; `cargo xtask numbers --measure {}` makes it",
                recording.name
            )
        })?;
        Self::read(&file, &text).with_context(|| file)
    }

    /// Reads a recorded run; `file` is its name in messages.
    pub fn read(file: &str, text: &str) -> anyhow::Result<Self> {
        let (head, body) = match file.ends_with(".json") {
            true => json(text)?,
            false => csv(text)?,
        };
        for key in KEYS {
            if !head.iter().any(|(k, v)| k == key && !v.is_empty()) {
                bail!("it does not say its {key}");
            }
        }
        Ok(Self {
            file: file.to_owned(),
            head,
            body,
        })
    }

    /// The file's path from the root.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The metadata value of one of [`KEYS`].
    pub fn says(&self, key: &str) -> &str {
        let found = self.head.iter().find(|(k, _)| k == key);
        found.map_or("", |(_, value)| value)
    }

    /// The columns' names.
    pub fn columns(&self) -> anyhow::Result<&[String]> {
        match &self.body {
            Body::Csv(lines) => Ok(lines.first().map_or(&[], Vec::as_slice)),
            Body::Json(_) => bail!("it is JSON and has no columns"),
        }
    }

    /// Whether it stores single figures, with the columns [`FIGURES`].
    pub fn has_figures(&self) -> bool {
        self.columns().is_ok_and(|columns| columns == FIGURES)
    }

    /// The lines below the columns' names.
    pub fn rows(&self) -> anyhow::Result<Vec<Row<'_>>> {
        let columns = self.columns()?;
        match &self.body {
            Body::Csv(lines) => Ok(lines[1..]
                .iter()
                .map(|fields| Row { columns, fields })
                .collect()),
            Body::Json(_) => Ok(Vec::new()),
        }
    }

    /// The object `run` of a JSON file.
    pub fn run(&self) -> anyhow::Result<&Value> {
        match &self.body {
            Body::Json(run) => Ok(run),
            Body::Csv(_) => bail!("it is no JSON"),
        }
    }
}

/// A line of a CSV file.
#[derive(Clone, Copy)]
pub struct Row<'r> {
    columns: &'r [String],
    /// The fields, in the columns' order.
    pub fields: &'r [String],
}

impl<'r> Row<'r> {
    /// The field of a column.
    pub fn text(&self, column: &str) -> anyhow::Result<&'r str> {
        let place = self.columns.iter().position(|name| name == column);
        let place = place.with_context(|| format!("it has no column {column:?}"))?;
        Ok(&self.fields[place])
    }

    /// The field of a column as a number.
    pub fn number(&self, column: &str) -> anyhow::Result<f64> {
        let text = self.text(column)?;
        text.parse()
            .with_context(|| format!("its column {column:?} has {text:?}, which is no number"))
    }
}

fn csv(text: &str) -> anyhow::Result<(Vec<(String, String)>, Body)> {
    let mut head = Vec::new();
    let mut body = text;
    while let Some(line) = body.strip_prefix("# ") {
        let (line, rest) = line.split_once('\n').unwrap_or((line, ""));
        let (key, value) = line
            .split_once(": ")
            .with_context(|| format!("`# {line}` is no `# key: value`"))?;
        head.push((key.to_owned(), value.trim().to_owned()));
        body = rest;
    }
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(body.as_bytes());
    let mut lines = Vec::new();
    for record in reader.records() {
        lines.push(record?.iter().map(str::to_owned).collect());
    }
    if lines.len() < 2 {
        bail!("it has no rows");
    }
    Ok((head, Body::Csv(lines)))
}

fn json(text: &str) -> anyhow::Result<(Vec<(String, String)>, Body)> {
    let mut value: Value = serde_json::from_str(text)?;
    let head = value.get("recorded").and_then(Value::as_object);
    let head = head.context("it has no object \"recorded\"")?;
    let head = head
        .iter()
        .filter_map(|(key, value)| Some((key.clone(), value.as_str()?.to_owned())))
        .collect();
    let run = value.get_mut("run").map(Value::take);
    Ok((head, Body::Json(run.context("it has no \"run\"")?)))
}

/// The text of a file with this metadata and body; the body of a JSON file is JSON.
pub fn written(file: &str, head: &[(&str, String)], body: &str) -> anyhow::Result<String> {
    let mut text = String::new();
    if file.ends_with(".json") {
        text.push_str("{\n  \"recorded\": {\n");
        for (n, (key, value)) in head.iter().enumerate() {
            let comma = if n + 1 < head.len() { "," } else { "" };
            text.push_str(&format!("    {key:?}: {}{comma}\n", Value::from(&**value)));
        }
        text.push_str("  },\n  \"run\": ");
        text.push_str(body.trim());
        text.push_str("\n}\n");
    } else {
        for (key, value) in head {
            text.push_str(&format!("# {key}: {value}\n"));
        }
        text.push_str(body.trim_end());
        text.push('\n');
    }
    // Check that the pages can read the text.
    Recorded::read(file, &text)?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head() -> Vec<(&'static str, String)> {
        KEYS.map(|key| (key, format!("a \"{key}\""))).into()
    }

    #[test]
    fn what_is_written_is_read_again() {
        let text = written("a.csv", &head(), "x,y\n1,\"a, b\"\n").unwrap();
        let found = Recorded::read("a.csv", &text).unwrap();
        assert_eq!(found.says("cpu"), "a \"cpu\"");
        let rows = found.rows().unwrap();
        assert_eq!(
            (rows[0].number("x").unwrap(), rows[0].text("y").unwrap()),
            (1.0, "a, b")
        );
        assert!(rows[0].number("y").is_err() && rows[0].text("z").is_err() && found.run().is_err());
        let text = written("a.json", &head(), "{\"z\": [1, 2]}\n").unwrap();
        let found = Recorded::read("a.json", &text).unwrap();
        assert_eq!(
            (found.says("os"), &found.run().unwrap()["z"][1]),
            ("a \"os\"", &2.into())
        );
        assert!(found.columns().is_err());
    }

    #[test]
    fn a_run_that_does_not_say_where_it_is_from_is_rejected() {
        for missing in KEYS {
            let mut head = head();
            head.retain(|(key, _)| *key != missing);
            for (file, body) in [("a.csv", "x\n1\n"), ("a.json", "{}")] {
                let error = written(file, &head, body).unwrap_err();
                assert!(error.to_string().contains(missing), "{error}");
            }
        }
        assert!(written("a.csv", &head(), "x\n").is_err());
        assert!(written("a.csv", &head(), "x,y\n1\n").is_err());
        assert!(written("a.json", &head(), "{").is_err());
    }
}
