//! The large dependencies must occur once in the program: their types cross crate borders, and two of them double the build.

use crate::cargo;
use std::collections::{BTreeMap, BTreeSet};

/// One version of each.
const SINGLE: &[&str] = &["egui", "glam", "hifitime", "image", "naga", "wgpu", "winit"];

/// What is doubled or not found in the program as it is really compiled, on all platforms.
pub fn problems() -> anyhow::Result<Vec<String>> {
    // `cargo tree` resolves features as the build does; the lock file also names packages that nothing compiles.
    let tree = cargo::output(&[
        "tree",
        "--locked",
        "--package",
        "terrella",
        "--edges",
        "normal,build",
        "--target",
        "all",
        "--prefix",
        "none",
        "--format",
        "{p}",
    ])?;
    Ok(doubled(&tree, SINGLE))
}

fn doubled(tree: &str, names: &[&str]) -> Vec<String> {
    let mut versions: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for line in tree.lines() {
        let mut words = line.split_whitespace();
        if let (Some(name), Some(version)) = (words.next(), words.next()) {
            versions.entry(name).or_default().insert(version);
        }
    }
    let problem = |name: &&str| match versions.get(*name) {
        Some(found) if found.len() == 1 => None,
        Some(found) => {
            let list = found.iter().copied().collect::<Vec<_>>().join(" and ");
            Some(format!(
                "{name} is compiled as {list}: `cargo tree --package terrella --invert {name}` names who asks"
            ))
        }
        // A name that is never met would make the check pass for ever.
        None => Some(format!(
            "{name} is no dependency: remove it from xtask/src/single.rs"
        )),
    };
    names.iter().filter_map(problem).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TREE: &str = "terrella v0.1.0 (/somewhere)\nwgpu v30.0.1\nnaga v30.0.1\nglam v0.33.12\nwgpu v30.0.1 (*)\n";

    #[test]
    fn one_version_is_fine_however_often() {
        assert_eq!(doubled(TREE, &["wgpu", "naga", "glam"]), [""; 0]);
    }

    #[test]
    fn two_versions_are_not() {
        let tree = format!("{TREE}wgpu v29.0.4\n");
        let found = doubled(&tree, &["wgpu", "naga"]);
        assert_eq!(found.len(), 1);
        assert!(found[0].contains("v29.0.4 and v30.0.1"), "{found:?}");
    }

    #[test]
    fn a_name_that_is_never_met_is_reported() {
        assert_eq!(doubled(TREE, &["winit"]).len(), 1);
        assert_eq!(doubled("", SINGLE).len(), SINGLE.len());
    }
}
