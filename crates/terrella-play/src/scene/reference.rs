//! `docs/scene-reference.md`: all keys of scenes, made from their declarations.

use super::keys::TABLES;
use super::schema::{default_of, parts, value_schema};
use super::table::{Key, Shape};
use serde_json::Value;
use std::fmt::Write;

const HEAD: &str = "# Keys of scenes

<!-- Made from the declarations in crates/terrella-play/src/scene/keys.rs:
     TERRELLA_UPDATE_REFERENCE=1 cargo test -p terrella-play reference -->

A scene is a TOML file. Each table and key may be left out; unknown ones are rejected. Where the column of defaults is empty, the default is
none or depends on other keys, as the last column says. [`config/iss.toml`](../config/iss.toml) shows every key in context,
`terrella check SCENE --all` the values that a scene comes to.
";

fn page() -> String {
    let mut page = HEAD.to_owned();
    for table in TABLES {
        let note = match table.name {
            "orbit" => " A scene has one for each satellite: `[[orbit]]` where there are several.",
            "tracks" => {
                " What holds for all satellites; a key of `[orbit]` goes before the same key here."
            }
            _ => "",
        };
        let head = "| key | value | default | used | meaning |\n|---|---|---|---|---|";
        let note = note.trim_start();
        let gap = if note.is_empty() { "" } else { "\n\n" };
        line(
            &mut page,
            &format!("\n## `[{}]`\n\n{note}{gap}{head}", table.name),
        );
        for key in table.keys {
            let default =
                default_of(key).map_or_else(String::new, |default| format!("`{default}`"));
            let used = key.only.map_or("always", |only| only.why);
            let used = ["is for ", "only for ", "for "]
                .iter()
                .find_map(|start| used.strip_prefix(start))
                .unwrap_or(used);
            let meaning = key.about.meaning.trim().replace("  ", " ");
            let cells = [key.name, &value_cell(key), &default, used, &meaning];
            line(&mut page, &row(cells));
            for part in parts(key.name) {
                let used = if part.is_needed { "required" } else { "" };
                let name = format!("{}.{}", key.name, part.name);
                line(
                    &mut page,
                    &row([&name, &value_text(&part.value), "", used, part.meaning]),
                );
            }
        }
    }
    page
}

fn row([name, cells @ ..]: [&str; 5]) -> String {
    let cells = cells.map(|cell| match cell {
        "" => " ".to_owned(),
        cell => format!(" {cell} "),
    });
    format!("| `{name}` |{}|", cells.join("|"))
}

/// What the value of a key must be, with its unit.
fn value_cell(key: &Key) -> String {
    let schema = value_text(&value_schema(key));
    match (key.about.shape)() {
        Shape::Flag | Shape::Word(_) => schema,
        Shape::Number => format!("{schema} {}", key.about.of),
        Shape::Whole if key.about.range.is_none() => (key.expected)(),
        Shape::Vector | Shape::Pair => format!("{}: {schema}", (key.expected)()),
        Shape::Whole => schema,
        _ => (key.expected)(),
    }
    .trim()
    .to_owned()
}

/// A schema in words.
fn value_text(schema: &Value) -> String {
    if let Some(words) = schema["enum"].as_array() {
        let words: Vec<_> = words.iter().map(|word| format!("`{word}`")).collect();
        return words.join(", ");
    }
    let range = match (
        &schema["minimum"],
        &schema["exclusiveMinimum"],
        &schema["maximum"],
    ) {
        (Value::Null, Value::Null, _) => String::new(),
        (Value::Null, least, most) => format!(", more than {least}, up to {most}"),
        (least, _, most) => format!(", {least} to {most}"),
    };
    match schema["type"].as_str() {
        Some("boolean") => "`true`, `false`".to_owned(),
        Some("number") => format!("number{range}"),
        Some("integer") => format!("whole number{range}"),
        Some("array") => {
            let count = match &schema["minItems"] {
                least if *least == schema["maxItems"] => format!("{least} × "),
                _ => "list: ".to_owned(),
            };
            count + &value_text(&schema["items"])
        }
        _ => "string".to_owned(),
    }
}

fn line(page: &mut String, text: &str) {
    let _ = writeln!(page, "{text}");
}

#[cfg(test)]
mod tests {
    use super::super::Scene;
    use super::*;
    use std::path::{Path, PathBuf};

    fn repository() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
    }

    #[test]
    fn the_reference_page_is_that_of_the_declarations() {
        let path = repository().join("docs/scene-reference.md");
        if std::env::var_os("TERRELLA_UPDATE_REFERENCE").is_some() {
            std::fs::write(&path, page()).expect("written");
        }
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            committed == page(),
            "docs/scene-reference.md is not what the declarations of keys say; run `TERRELLA_UPDATE_REFERENCE=1 cargo test -p terrella-play reference`"
        );
    }

    /// What the sentences above the keys say of defaults that depend on other keys.
    #[test]
    fn the_meaning_of_a_key_names_its_default() {
        let scene = Scene::from_toml("", Path::new("scene.toml")).expect("the empty scene");
        let mut count = 0;
        for table in TABLES {
            let record = match table.name {
                "orbit" => scene.orbit_records.first(),
                name => scene.records.get(name),
            };
            for key in table.keys {
                let value = record.and_then(|record| record.value(key.name));
                let is_flag = (key.about.shape)() == Shape::Flag;
                if let Some(Ok(value)) = value
                    && default_of(key).is_none()
                    && !is_flag
                {
                    let value = if key.name == "start" {
                        value.trim_matches('"')
                    } else {
                        value
                    };
                    let meaning = key.about.meaning;
                    assert!(
                        meaning.contains(value),
                        "[{}] {}: {value} is not in:{meaning}",
                        table.name,
                        key.name
                    );
                    count += 1;
                }
            }
        }
        assert!(count > 10, "{count} keys");
    }
}
