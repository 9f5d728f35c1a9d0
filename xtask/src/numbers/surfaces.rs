//! Texts of the comparison of surfaces: `terrella report --surfaces` writes them itself.

use super::record::Recorded;
use anyhow::Context;

/// A text by its name.
pub fn section(run: &Recorded, name: &str) -> anyhow::Result<String> {
    let text = run.run()?.get("sections").and_then(|all| all.get(name));
    let text = text.and_then(|text| text.as_str());
    Ok(text
        .with_context(|| format!("it has no section {name:?}"))?
        .trim_end()
        .to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::record::{KEYS, written};

    #[test]
    fn a_section_is_found_by_its_name() {
        let head = KEYS.map(|key| (key, "x".to_owned()));
        let body = r#"{ "sections": { "one": "| a |\n" } }"#;
        let run = Recorded::read("a.json", &written("a.json", &head, body).unwrap()).unwrap();
        assert_eq!(section(&run, "one").unwrap(), "| a |");
        assert!(
            section(&run, "two")
                .unwrap_err()
                .to_string()
                .contains("\"two\"")
        );
    }
}
