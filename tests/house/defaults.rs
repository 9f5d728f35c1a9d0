//! Defaults that `config/iss.toml` tells users, against those that `crates/terrella-play/src/scene/keys.rs` declares.

use std::collections::BTreeMap;

/// A number or a truth value as written in either file; `None` for anything else.
#[derive(Clone, Debug, PartialEq)]
enum Literal {
    Number(f64),
    Bool(bool),
}

fn literal(text: &str) -> Option<Literal> {
    match text.trim() {
        "true" => Some(Literal::Bool(true)),
        "false" => Some(Literal::Bool(false)),
        number => number.parse().ok().map(Literal::Number),
    }
}

/// Declared defaults by table and key, where they are literals.
fn declared(keys: &str) -> BTreeMap<(&str, &str), Literal> {
    let mut table = "";
    let mut found = BTreeMap::new();
    for line in keys.lines() {
        if line.starts_with("table") && line.contains("!(Raw") {
            table = line.split('"').nth(1).unwrap_or_default();
        }
        let key = line.trim().split_once(": ").map(|(key, _)| key);
        let default = line.split_once(", default ").map(|(_, value)| value);
        let value = default.and_then(|value| value.split([',', ';']).next());
        let value = value.and_then(literal);
        if let (Some(key), Some(value)) = (key, value) {
            found.insert((table, key), value);
        }
    }
    found
}

/// A key that a scene gives, or shows in a comment.
fn key_of(line: &str) -> Option<&str> {
    let line = line.strip_prefix("# ").unwrap_or(line);
    let (key, value) = line.split_once(" = ")?;
    let is_key = key
        .chars()
        .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    // A sentence may have an equals sign in it.
    (is_key && !value.ends_with('.')).then_some(key)
}

/// The defaults that a comment tells: "Default: 512 and 4." is two.
fn told(comment: &str) -> Vec<&str> {
    let Some((_, text)) = comment.split_once("Default: ") else {
        return Vec::new();
    };
    let end = text.find(". ").unwrap_or(text.len());
    let text = text[..end].trim_end_matches('.');
    text.split(", ")
        .flat_map(|part| part.trim_start_matches("and ").split(" and "))
        .collect()
}

/// What a scene's comments tell wrongly, and how many defaults were compared.
pub fn differences(keys: &str, scene: &str) -> (Vec<String>, usize) {
    let declared = declared(keys);
    let (mut table, mut comment, mut keys_below) = ("", String::new(), 0);
    let (mut wrong, mut compared) = (Vec::new(), 0);
    for (number, line) in scene.lines().enumerate() {
        if line.starts_with('[') {
            table = line.trim_matches(['[', ']']);
            (comment, keys_below) = (String::new(), 0);
        } else if let Some(key) = key_of(line) {
            let defaults = told(&comment);
            let default = defaults.get(keys_below).or(defaults.last());
            let default = default.and_then(|text| literal(text));
            if let (Some(told), Some(declared)) = (default, declared.get(&(table, key))) {
                compared += 1;
                if told != *declared {
                    let number = number + 1;
                    wrong.push(format!(
                        "config/iss.toml:{number}: [{table}] {key} is told to be {told:?} by default and declared as {declared:?}"
                    ));
                }
            }
            keys_below += 1;
        } else {
            if keys_below > 0 {
                (comment, keys_below) = (String::new(), 0);
            }
            comment.push_str(line.trim_start_matches('#'));
        }
    }
    (wrong, compared)
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEYS: &str = "table!(RawPack = \"pack\" {\n    size_mb: f64, in 1.0..=2.0, default 512.0, for PACK;\n    upload_mb: f64, default 4.0;\n    fade: bool, default true;\n});\n";

    #[test]
    fn a_wrong_default_is_found() {
        let scene = |upload: u32| {
            format!(
                "[pack]\n# Memory, and uploads. Default: 512 and {upload}.\n# size_mb = 256\nupload_mb = 4\n# Default: true.\n# fade = false\n"
            )
        };
        assert_eq!(differences(KEYS, &scene(4)), (Vec::new(), 3));
        let (wrong, compared) = differences(KEYS, &scene(8));
        assert_eq!((wrong.len(), compared), (1, 3));
        assert!(
            wrong[0].starts_with("config/iss.toml:4: [pack] upload_mb"),
            "{wrong:?}"
        );
    }
}
