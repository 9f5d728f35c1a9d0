//! `cargo xtask licences`: may we use, and ship, everything that we depend on?

use crate::process::{repository_root, say};
use crate::{cargo, single};
use anyhow::{Context, bail};
use serde_json::Value;
use spdx::{Expression, LicenseItem, LicenseReq, ParseMode};
use std::collections::BTreeSet;

/// Licences that ask for no more than that their text travels along.
const PLAIN: &[&str] = &[
    "0BSD",
    "Apache-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "MIT-0",
    "NCSA",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// Licences that are fine with a note to the user: source on request, credit, or rules for fonts.
/// A package that cannot be had under a plain licence must be named in THIRD-PARTY.md.
const NOTED: &[&str] = &["IJG", "MPL-2.0", "OFL-1.1", "Ubuntu-font-1.0"];

/// Packages with terms beyond their licence expression, and which. They must be named in THIRD-PARTY.md too.
const EXTRA_TERMS: &[(&str, &str)] = &[
    (
        "sofars",
        "derived from the IAU SOFA software: its six terms",
    ),
    (
        "openh264-sys2",
        "H.264: patent licences are the user's matter",
    ),
];

/// Packages that have a licence file and no expression, each with the reason why it may be used. None so far.
const FILE_ONLY: &[(&str, &str)] = &[];

const NOTES: &str = "THIRD-PARTY.md";

/// What the check reads of one package.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Package {
    name: String,
    version: String,
    expression: Option<String>,
    file: bool,
    ours: bool,
}

/// How free a package is.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Verdict {
    Plain,
    /// Fine with a note, and why.
    Noted(String),
    Refused(String),
}

/// Checks licences and doubled packages.
pub fn run() -> anyhow::Result<()> {
    // With the packages of every platform, because we ship for all of them.
    let metadata = cargo::output(&["metadata", "--format-version", "1", "--locked"])?;
    let packages = packages(&metadata)?;
    let notes_path = repository_root().join(NOTES);
    let notes = std::fs::read_to_string(&notes_path)
        .with_context(|| format!("cannot read {}", notes_path.display()))?;
    let mut problems = problems(&packages, &notes);
    problems.extend(single::problems()?);
    if !problems.is_empty() {
        bail!("{} found:\n  {}", problems.len(), problems.join("\n  "));
    }
    let others = packages.iter().filter(|package| !package.ours).count();
    say(format_args!(
        "the licences of {others} dependencies are fine"
    ));
    Ok(())
}

fn packages(metadata: &str) -> anyhow::Result<Vec<Package>> {
    let json: Value = serde_json::from_str(metadata).context("cargo metadata is not JSON")?;
    let list = json.get("packages").and_then(Value::as_array);
    let list = list.context("cargo metadata has no packages")?;
    if list.is_empty() {
        bail!("cargo metadata names no package: nothing was checked");
    }
    let read = |package: &Value| {
        let text = |key: &str| package.get(key).and_then(Value::as_str).map(str::to_string);
        Some(Package {
            name: text("name")?,
            version: text("version")?,
            expression: text("license"),
            file: text("license_file").is_some(),
            // A registry or repository is named for all packages but those of this workspace.
            ours: text("source").is_none(),
        })
    };
    list.iter()
        .map(|package| read(package).context("a package in cargo metadata lacks name or version"))
        .collect()
}

fn problems(packages: &[Package], notes: &str) -> Vec<String> {
    let mut problems = Vec::new();
    let noted = |name: &str| notes.contains(&format!("`{name}`"));
    for package in packages.iter().filter(|package| !package.ours) {
        let Package { name, version, .. } = package;
        let reason = match verdict(package) {
            Verdict::Refused(why) => {
                problems.push(format!("{name} {version}: {why}"));
                continue;
            }
            Verdict::Noted(why) => Some(why),
            Verdict::Plain => extra_terms(name).map(str::to_string),
        };
        if let Some(why) = reason
            && !noted(name)
        {
            problems.push(format!(
                "{name} {version}: {why}: must be named in {NOTES} as `{name}`"
            ));
        }
    }
    let names: BTreeSet<_> = packages
        .iter()
        .map(|package| package.name.as_str())
        .collect();
    for (name, _) in EXTRA_TERMS.iter().chain(FILE_ONLY) {
        if !names.contains(name) {
            problems.push(format!(
                "{name} is in a list of xtask/src/licences.rs and is no dependency: remove it there"
            ));
        }
    }
    problems
}

fn extra_terms(name: &str) -> Option<&'static str> {
    EXTRA_TERMS
        .iter()
        .find(|(listed, _)| *listed == name)
        .map(|(_, terms)| *terms)
}

fn verdict(package: &Package) -> Verdict {
    let Some(text) = &package.expression else {
        let listed = FILE_ONLY.iter().find(|(name, _)| *name == package.name);
        return match (listed, package.file) {
            (Some((_, reason)), true) => Verdict::Noted((*reason).to_string()),
            (None, true) => Verdict::Refused(
                "it has a licence file and no expression: read it and list it in xtask/src/licences.rs".into(),
            ),
            (_, false) => Verdict::Refused("it states no licence".into()),
        };
    };
    // LAX because older packages still write `MIT/Apache-2.0`.
    let expression = match Expression::parse_mode(text, ParseMode::LAX) {
        Ok(expression) => expression,
        Err(error) => {
            return Verdict::Refused(format!(
                "`{text}` is no licence expression: {}",
                error.reason
            ));
        }
    };
    if expression.evaluate(|requirement| is_one_of(requirement, PLAIN)) {
        Verdict::Plain
    } else if expression.evaluate(|r| is_one_of(r, PLAIN) || is_one_of(r, NOTED)) {
        Verdict::Noted(text.clone())
    } else {
        Verdict::Refused(format!("`{text}` is not allowed"))
    }
}

fn is_one_of(requirement: &LicenseReq, list: &[&str]) -> bool {
    let LicenseItem::Spdx { id, .. } = &requirement.license else {
        return false;
    };
    match &requirement.addition {
        None => list.contains(&id.name),
        // An exception changes the terms: the one that is known to only widen them.
        Some(_) => {
            requirement.to_string() == "Apache-2.0 WITH LLVM-exception" && list.contains(&id.name)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn package(expression: &str) -> Package {
        Package {
            name: "thing".into(),
            version: "1.0.0".into(),
            expression: Some(expression.into()),
            ..Package::default()
        }
    }

    fn listed() -> Vec<Package> {
        let named = |(name, _): &(&str, &str)| Package {
            name: (*name).to_string(),
            ..package("MIT")
        };
        EXTRA_TERMS.iter().map(named).collect()
    }

    const NOTES_TEXT: &str = "`sofars` `openh264-sys2`";

    #[test]
    fn what_is_allowed() {
        for text in [
            "MIT OR Apache-2.0",
            "MIT/Apache-2.0",
            "Apache-2.0 WITH LLVM-exception",
            "(MIT OR Apache-2.0) AND Unicode-3.0",
            "Apache-2.0 OR GPL-2.0-only",
            "MIT OR Apache-2.0 OR LGPL-2.1-or-later",
            "Unlicense OR MIT",
        ] {
            assert_eq!(verdict(&package(text)), Verdict::Plain, "{text}");
        }
    }

    #[test]
    fn what_needs_a_note() {
        for text in [
            "MPL-2.0",
            "(MIT OR Apache-2.0) AND OFL-1.1 AND Ubuntu-font-1.0",
        ] {
            assert_eq!(verdict(&package(text)), Verdict::Noted(text.into()));
            let all = [listed(), vec![package(text)]].concat();
            assert_eq!(problems(&all, NOTES_TEXT).len(), 1, "{text}");
            let with_note = format!("{NOTES_TEXT} `thing`");
            assert_eq!(problems(&all, &with_note), [""; 0]);
        }
        // A package of our own needs none.
        let ours = Package {
            ours: true,
            ..package("GPL-3.0-only")
        };
        assert_eq!(
            problems(&[listed(), vec![ours]].concat(), NOTES_TEXT),
            [""; 0]
        );
    }

    #[test]
    fn what_is_refused() {
        for text in [
            "GPL-3.0-only",
            "GPL-2.0-or-later",
            "AGPL-3.0-only",
            "LGPL-2.1-or-later",
            "MIT AND GPL-3.0-only",
            "GPL-2.0-only WITH Classpath-exception-2.0",
            "MIT WITH LLVM-exception",
            "CC-BY-NC-4.0",
            "LicenseRef-own",
            "my own licence",
            "",
        ] {
            assert!(
                matches!(verdict(&package(text)), Verdict::Refused(_)),
                "{text}"
            );
            let all = [listed(), vec![package(text)]].concat();
            assert_eq!(problems(&all, NOTES_TEXT).len(), 1, "{text}");
        }
    }

    #[test]
    fn a_licence_file_alone_must_be_listed() {
        let without = Package {
            expression: None,
            ..package("")
        };
        assert_eq!(
            verdict(&without),
            Verdict::Refused("it states no licence".into())
        );
        let with_file = Package {
            file: true,
            ..without
        };
        assert!(matches!(verdict(&with_file), Verdict::Refused(why) if why.contains("list it")));
    }

    #[test]
    fn extra_terms_are_noted_and_lists_do_not_go_stale() {
        assert_eq!(problems(&listed(), "").len(), EXTRA_TERMS.len());
        let stale = problems(&[], NOTES_TEXT);
        assert!(
            stale
                .iter()
                .all(|problem| problem.contains("no dependency"))
        );
        assert_eq!(stale.len(), EXTRA_TERMS.len() + FILE_ONLY.len());
    }

    #[test]
    fn metadata_is_read() {
        let text = r#"{"packages": [
            {"name": "a", "version": "1.0.0", "license": "MIT", "license_file": null, "source": "registry+x"},
            {"name": "b", "version": "2.0.0", "license": null, "license_file": "LICENSE", "source": null}]}"#;
        let read = packages(text).unwrap();
        assert_eq!(read[0].expression.as_deref(), Some("MIT"));
        assert!(!read[0].ours && !read[0].file);
        assert!(read[1].ours && read[1].file && read[1].expression.is_none());
        for bad in [
            "",
            "{}",
            r#"{"packages": []}"#,
            r#"{"packages": [{"name": "a"}]}"#,
        ] {
            assert!(packages(bad).is_err(), "{bad}");
        }
    }
}
