//! `docs/scene-reference.md`: all scene keys, generated from their declarations, and tests of other statements about keys.

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
`terrella check SCENE --all` the values that a scene comes to. Editors that know TOML schemas complete and check a scene whose first line is
`#:schema` and the path of [`config/terrella.schema.json`](../config/terrella.schema.json).
";

fn page() -> String {
    let mut page = HEAD.to_owned();
    for table in TABLES {
        let note = match table.name {
            "orbit" => " A scene has one for each satellite: `[[orbit]]` where there are several.",
            "station" => {
                " A scene has one for each ground station: `[[station]]` where there are several."
            }
            "geojson" => " A scene has one for each file: `[[geojson]]` where there are several.",
            "caption" => {
                " A scene has one for each caption: `[[caption]]` where there are several."
            }
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

/// Accepted values of a key, with unit.
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

/// A schema as text.
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
    use super::super::schema::{schema, schema_text};
    use super::*;
    use std::path::{Path, PathBuf};

    fn repository() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
    }

    #[test]
    fn the_reference_page_and_the_schema_are_those_of_the_declarations() {
        for (name, text) in [
            ("docs/scene-reference.md", page()),
            ("config/terrella.schema.json", schema_text()),
        ] {
            let path = repository().join(name);
            if std::env::var_os("TERRELLA_UPDATE_REFERENCE").is_some() {
                std::fs::write(&path, &text).expect("written");
            }
            let committed = std::fs::read_to_string(&path).unwrap_or_default();
            assert!(
                committed == text,
                "{name} is not what the declarations of keys say; run `TERRELLA_UPDATE_REFERENCE=1 cargo test -p terrella-play reference`"
            );
        }
    }

    /// Why a value does not conform to a schema; `None` if it does. Panics at an unknown keyword.
    fn fault(value: &Value, schema: &Value, root: &Value) -> Option<String> {
        let rules = schema.as_object().expect("a schema is a table");
        rules.iter().find_map(|(rule, wanted)| {
            let number = value.as_f64();
            let count = value.as_array().map(|items| items.len() as f64);
            let bound = wanted.as_f64().unwrap_or(f64::NAN);
            let is_good = match rule.as_str() {
                "$schema" | "$defs" | "title" | "description" | "default" => true,
                "$ref" => {
                    let pointer = wanted.as_str().expect("a pointer").trim_start_matches('#');
                    return fault(value, root.pointer(pointer).expect("a schema"), root);
                }
                "anyOf" => {
                    let mut schemas = wanted.as_array().expect("a list").iter();
                    schemas.any(|schema| fault(value, schema, root).is_none())
                }
                "const" => value == wanted,
                "enum" => wanted.as_array().expect("a list").contains(value),
                "type" => match wanted.as_str().expect("a name") {
                    "object" => value.is_object(),
                    "array" => value.is_array(),
                    "string" => value.is_string(),
                    "boolean" => value.is_boolean(),
                    "integer" => value.is_i64(),
                    "number" => value.is_number(),
                    other => panic!("no type {other}"),
                },
                "minimum" => number.is_none_or(|number| number >= bound),
                "exclusiveMinimum" => number.is_none_or(|number| number > bound),
                "maximum" => number.is_none_or(|number| number <= bound),
                "minItems" => count.is_none_or(|count| count >= bound),
                "maxItems" => count.is_none_or(|count| count <= bound),
                "items" => {
                    let mut items = value.as_array().into_iter().flatten();
                    return items.find_map(|item| fault(item, wanted, root));
                }
                "properties" => {
                    let mut keys = value.as_object().into_iter().flatten();
                    return keys.find_map(|(key, value)| {
                        let fault = fault(value, wanted.get(key)?, root)?;
                        Some(format!("{key}: {fault}"))
                    });
                }
                "required" => {
                    let mut keys = wanted.as_array().expect("a list").iter();
                    keys.all(|key| value.get(key.as_str().expect("a name")).is_some())
                }
                "additionalProperties" => {
                    let mut keys = value.as_object().into_iter().flatten();
                    keys.all(|(key, _)| schema["properties"].get(key).is_some())
                }
                other => panic!("no rule {other}"),
            };
            (!is_good).then(|| format!("{value} against {rule} {wanted}"))
        })
    }

    /// A scene as JSON, with dates as strings.
    fn json_of(value: toml::Value) -> Value {
        match value {
            toml::Value::Datetime(when) => when.to_string().into(),
            toml::Value::Array(items) => items.into_iter().map(json_of).collect(),
            toml::Value::Table(keys) => {
                let keys = keys.into_iter().map(|(key, value)| (key, json_of(value)));
                Value::Object(keys.collect())
            }
            toml::Value::String(text) => text.into(),
            toml::Value::Integer(whole) => whole.into(),
            toml::Value::Float(number) => number.into(),
            toml::Value::Boolean(flag) => flag.into(),
        }
    }

    fn scene_fault(text: &str) -> Option<String> {
        let scene: toml::Table = text.parse().unwrap_or_else(|error| panic!("{error}"));
        let schema = schema();
        fault(&json_of(scene.into()), &schema, &schema)
    }

    #[test]
    fn shipped_scenes_name_the_schema_and_conform_to_it() {
        let folder = repository().join("config");
        let paths = std::fs::read_dir(folder).expect("config/");
        let paths = paths.map(|entry| entry.expect("an entry").path());
        let scenes = paths.filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
        let mut count = 0;
        for path in scenes {
            let text = std::fs::read_to_string(&path).expect("a scene");
            let first = text.lines().next();
            assert_eq!(
                first,
                Some("#:schema terrella.schema.json"),
                "{}",
                path.display()
            );
            assert_eq!(scene_fault(&text), None, "{}", path.display());
            count += 1;
        }
        assert!(count > 20, "{count} scenes");
    }

    #[test]
    fn what_no_scene_may_have_does_not_conform() {
        for good in [
            "",
            "[time]\nstart = 2018-01-15T12:00:00Z\nduration_s = 1e9\n",
            "[[orbit]]\ntrail = { before_min = 90 }\n[[orbit]]\ntrail = true\n",
            "[earth]\nsubdivision = \"auto\"\n[output]\nexposure_ev = -20\nsamples = 4\n",
            "[[camera.keys]]\ntime_s = 0\noffset_m = [0, 0, -20.5]\n",
        ] {
            assert_eq!(scene_fault(good), None, "{good}");
        }
        for bad in [
            "[times]\n",
            "[time]\nsped = 1\n",
            "[time]\nduration_s = 0\n",
            "[time]\nframe_rate_hz = 241\n",
            "[time]\nspeed = \"fast\"\n",
            "[orbit]\ngravity_degree = 2.5\n",
            "[[orbit]]\n[[orbit]]\nsource = \"tles\"\n",
            "[orbit]\ntrail = { before = 90 }\n",
            "[orbit]\nposition_km = [1, 2]\n",
            "[orbit]\nburns = [{ duration_s = 1 }]\n",
            "[earth]\nsubdivision = \"many\"\n",
            "[earth]\nclipmap = { samples = 100 }\n",
            "[earth]\nelevation = [1]\n",
            "[output]\nsamples = 2\n",
            "[output]\nsize = [0, 720]\n",
            "[[camera.keys]]\nfov_deg = 1\n",
        ] {
            assert!(scene_fault(bad).is_some(), "{bad}");
        }
    }

    /// The defaults stated in a comment: "Default: 512 and 4." has two.
    fn defaults_in(comment: &str) -> Vec<&str> {
        let Some((_, text)) = comment.split_once("Default: ") else {
            return Vec::new();
        };
        let end = text.find(". ").unwrap_or(text.len());
        let text = text[..end].trim_end_matches('.');
        text.split(", ")
            .flat_map(|part| part.trim_start_matches("and ").split(" and "))
            .collect()
    }

    /// A TOML value, if the text is one.
    fn literal(text: &str) -> Option<Value> {
        let table: toml::Table = format!("value = {text}").parse().ok()?;
        let value = json_of(table["value"].clone());
        // 1 and 1.0 are the same default.
        Some(value.as_f64().map_or(value, Value::from))
    }

    /// Keys of a scene whose comment states another default than the declared one, or that are commented out with
    /// another value. Also returns the number of compared defaults.
    fn wrong_defaults(scene: &str) -> (Vec<String>, usize) {
        let (mut table, mut comment, mut keys_below) = (None, String::new(), 0);
        let (mut wrong, mut compared) = (Vec::new(), 0);
        for line in scene.lines() {
            if let Some(name) = line.strip_prefix('[') {
                let name = name.trim_matches(['[', ']']);
                table = TABLES.iter().find(|table| table.name == name);
                (comment, keys_below) = (String::new(), 0);
                continue;
            }
            let is_commented_out = line.starts_with('#');
            let given = line.trim_start_matches("# ").split_once(" = ");
            let key = given.zip(table).and_then(|((name, value), table)| {
                let key = table.keys.iter().find(|key| key.name == name)?;
                Some((key, value))
            });
            let Some((key, value)) = key else {
                if keys_below > 0 {
                    (comment, keys_below) = (String::new(), 0);
                }
                comment.push_str(line.trim_start_matches('#'));
                continue;
            };
            let defaults = defaults_in(&comment);
            let said = defaults.get(keys_below).or(defaults.last());
            let said = said.and_then(|text| literal(text));
            let shown = literal(value).filter(|_| is_commented_out);
            keys_below += 1;
            let Some(default) = default_of(key) else {
                continue;
            };
            let default = default.as_f64().map_or(default, Value::from);
            for value in said.into_iter().chain(shown) {
                compared += 1;
                if value != default {
                    wrong.push(format!("{line}: {value}, declared {default}"));
                }
            }
        }
        (wrong, compared)
    }

    #[test]
    fn the_explained_scene_gives_the_declared_defaults() {
        let path = repository().join("config/iss.toml");
        let text = std::fs::read_to_string(path).expect("a scene");
        let (wrong, compared) = wrong_defaults(&text);
        assert!(wrong.is_empty(), "{wrong:#?}");
        // A smaller number would mean that the comments are no longer parsed.
        assert!(compared > 100, "{compared} defaults were compared");
        for (right, bad) in [
            ("Default: 512 and 4.", "Default: 512 and 8."),
            ("# upload_mb = 4", "# upload_mb = 8"),
        ] {
            assert_eq!(text.matches(right).count(), 1, "{right}");
            let (wrong, _) = wrong_defaults(&text.replace(right, bad));
            assert_eq!(wrong.len(), 1, "{wrong:?}");
        }
    }

    /// Checks the sentences above the keys about defaults that depend on other keys.
    #[test]
    fn the_meaning_of_a_key_names_its_default() {
        let scene = Scene::from_toml("", Path::new("scene.toml")).expect("the empty scene");
        let mut count = 0;
        for table in TABLES {
            let record = match table.name {
                "orbit" => scene.orbit_records.first(),
                name => match scene.lists.get(name) {
                    Some(records) => records.first(),
                    None => scene.records.get(name),
                },
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
