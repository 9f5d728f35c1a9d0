//! Which module of `src/` may use which. A module is a folder or file directly in `src/`, with all that is in it.

use crate::source::{File, Token, after_group};
use std::collections::{BTreeMap, BTreeSet};

/// Each module with the modules that it may use. A module that is not here may not exist.
#[rustfmt::skip]
const MODULES: &[(&str, &[&str])] = &[
    ("files", &[]),
    ("durable", &[]),
    ("frames", &["files"]),
    ("loaders", &[]),
    ("orbit", &["files", "frames"]),
    ("basilisk", &["files", "frames", "orbit"]),
    ("elevation", &["files", "frames", "loaders"]),
    ("globe", &["frames", "elevation"]),
    ("air", &["frames"]),
    ("light", &["frames", "air"]),
    // Maps and drawables know nothing of satellites.
    ("imagery", &["files", "durable", "loaders", "elevation", "globe"]),
    // Maps from the network, for packs.
    ("fetch", &["files", "durable", "imagery"]),
    ("scene", &["files", "frames", "orbit", "basilisk", "globe", "air", "light"]),
    ("gpu", &["files", "frames", "globe", "air", "light", "imagery"]),
    ("earth", &["files", "frames", "elevation", "globe", "air", "light", "imagery", "gpu"]),
    // Drawn into memory.
    ("offscreen", &["light", "imagery", "gpu", "earth"]),
    // Drawn behind the Earth.
    ("celestial", &["files", "frames", "air", "imagery", "gpu", "earth"]),
    // Drawn with the Earth, for any feed: knows no scene.
    ("tracks", &["frames", "orbit", "globe", "air", "gpu", "earth"]),
    ("play", &["files", "frames", "durable", "orbit", "basilisk", "elevation", "light", "imagery", "scene", "gpu", "earth", "offscreen", "celestial", "tracks"]),
    ("measure", &["files", "frames", "orbit", "elevation", "globe", "air", "light", "imagery", "scene", "gpu", "earth", "offscreen", "play"]),
    ("cli", &["files", "frames", "orbit", "basilisk", "globe", "imagery", "fetch", "scene", "gpu", "play", "measure"]),
];

/// Names that `lib.rs` exports from modules, with their modules: `crate::Earth` is `earth`.
pub fn exports(lib: &File) -> BTreeMap<String, String> {
    let mut exports = BTreeMap::new();
    for start in lib.find(&["pub", "use"]) {
        let path = start + 2;
        let Some(module) = lib.tokens.get(path).and_then(Token::name) else {
            continue;
        };
        for (name, _) in heads(&lib.tokens, path + 1) {
            exports.insert(name.to_string(), module.to_string());
        }
    }
    exports
}

/// The module of a source file; `None` for `lib.rs`, `internals.rs` and `main.rs`, which hold the modules together.
fn module_of(path: &str) -> Option<&str> {
    let inside = path.strip_prefix("src/")?;
    let module = inside.split('/').next()?.trim_end_matches(".rs");
    (!matches!(inside, "lib.rs" | "internals.rs" | "main.rs")).then_some(module)
}

/// How many modules deep the file's own module is: `super` that often leads to the crate.
fn depth(path: &str) -> usize {
    let inside = path.trim_start_matches("src/").trim_end_matches(".rs");
    inside.trim_end_matches("/mod").split('/').count()
}

/// What in this file uses a module that it may not know.
pub fn violations(file: &File, exports: &BTreeMap<String, String>) -> Vec<String> {
    let Some(module) = module_of(&file.path) else {
        return Vec::new();
    };
    let Some((_, allowed)) = MODULES.iter().find(|(name, _)| *name == module) else {
        return vec![format!(
            "{}: module `{module}` is not in the table of tests/house/modules.rs",
            file.path
        )];
    };
    let mut violations = Vec::new();
    for (name, token) in uses(file) {
        let Some(target) = target_of(name, exports) else {
            violations.push(file.at(
                token,
                format!("`{name}` is no module and nothing that lib.rs exports"),
            ));
            continue;
        };
        if target != module && !allowed.contains(&target) {
            violations.push(file.at(
                token,
                format!("`{module}` may not use `{target}` (by `{name}`)"),
            ));
        }
    }
    violations
}

/// What the table allows and no file does.
pub fn unused(files: &[File], exports: &BTreeMap<String, String>) -> Vec<String> {
    let pairs: BTreeSet<_> = files
        .iter()
        .filter_map(|file| Some((module_of(&file.path)?, file)))
        .flat_map(|(module, file)| {
            let names = uses(file).into_iter();
            names.filter_map(move |(name, _)| Some((module, target_of(name, exports)?)))
        })
        .collect();
    let allowed = MODULES
        .iter()
        .flat_map(|(module, allowed)| allowed.iter().map(move |to| (*module, *to)));
    allowed
        .filter(|pair| !pairs.contains(pair))
        .map(|(module, target)| format!("`{module}` is allowed `{target}` and does not use it"))
        .collect()
}

/// How the table of modules in these pages differs from the enforced one. Pages without one are passed over; one page at
/// least must have it.
pub fn unlike_the_table(pages: &[(&str, String)]) -> Vec<String> {
    let names: Vec<_> = MODULES.iter().map(|(name, _)| *name).collect();
    let tables: Vec<_> = pages
        .iter()
        .filter_map(|(path, text)| Some((path, printed_modules(text, names[0])?)))
        .collect();
    if tables.is_empty() {
        return vec!["no page has the table of modules".to_owned()];
    }
    let wrong = tables.iter().filter(|(_, printed)| *printed != names);
    wrong
        .map(|(path, printed)| {
            format!("{path}: the modules are {names:?}, the table has {printed:?}")
        })
        .collect()
}

/// The first column of the table, in Markdown or in a module's documentation, whose first row is about this module.
fn printed_modules(text: &str, first: &str) -> Option<Vec<String>> {
    let cells = text.lines().map(|line| {
        let row = line.trim_start_matches("//!").trim().strip_prefix('|')?;
        let cell = row.split('|').next()?;
        Some(cell.replace(['[', ']', '`'], "").trim().to_owned())
    });
    let cells: Vec<Option<String>> = cells.collect();
    let start = cells
        .iter()
        .position(|cell| cell.as_deref() == Some(first))?;
    Some(cells[start..].iter().map_while(Clone::clone).collect())
}

/// The module that a name from the crate's root leads to.
fn target_of<'e>(name: &str, exports: &'e BTreeMap<String, String>) -> Option<&'e str> {
    let module = MODULES.iter().map(|(module, _)| *module);
    module
        .into_iter()
        .find(|module| *module == name)
        .or_else(|| exports.get(name).map(String::as_str))
}

/// All names that the file reaches from the crate's root.
fn uses(file: &File) -> Vec<(&str, &Token)> {
    let tokens = &file.tokens;
    let mut uses = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let token = &tokens[i];
        // A path's first word: not after `::`, not a field.
        let follows_path =
            i >= 1 && (tokens[i - 1].is_mark(':') && i >= 2 && tokens[i - 2].is_mark(':'));
        if follows_path {
            i += 1;
        } else if token.is_name("crate") || token.is_name("terrella") {
            // The modules that hosts do not see stand one name deeper, for all outside of the library.
            let through_internals =
                is_path(tokens, i + 1) && tokens.get(i + 3).is_some_and(|t| t.is_name("internals"));
            let end = if through_internals { i + 4 } else { i + 1 };
            uses.extend(heads(tokens, end));
            i = end;
        } else if token.is_name("super") {
            let mut supers = 1;
            let mut end = i + 1;
            while is_path(tokens, end) && tokens.get(end + 2).is_some_and(|t| t.is_name("super")) {
                supers += 1;
                end += 3;
            }
            if supers >= depth(&file.path) + token.inline_modules {
                uses.extend(heads(tokens, end));
            }
            i = end;
        } else {
            i += 1;
        }
    }
    uses
}

fn is_path(tokens: &[Token], i: usize) -> bool {
    [i, i + 1]
        .iter()
        .all(|i| tokens.get(*i).is_some_and(|t| t.is_mark(':')))
}

/// What follows `::` at this place: one name, or the first names of a group in braces.
fn heads(tokens: &[Token], i: usize) -> Vec<(&str, &Token)> {
    let named = |i: usize| tokens.get(i).and_then(|t| Some((t.name()?, t)));
    if !is_path(tokens, i) {
        return Vec::new();
    }
    let first = i + 2;
    if !tokens.get(first).is_some_and(|t| t.is_mark('{')) {
        return named(first).into_iter().collect();
    }
    let end = after_group(tokens, first);
    let mut heads = Vec::new();
    let mut at_start = true;
    let mut i = first + 1;
    while i < end {
        if tokens[i].is_mark('{') {
            i = after_group(tokens, i);
            continue;
        }
        if at_start {
            heads.extend(named(i).filter(|(name, _)| *name != "self"));
        }
        at_start = tokens[i].is_mark(',');
        i += 1;
    }
    heads
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(path: &str, text: &str) -> Vec<String> {
        let lib = File::new(
            "src/lib.rs",
            "pub mod earth; pub use earth::{Earth, EyeView}; pub use frames::Epoch;",
        );
        violations(&File::new(path, text), &exports(&lib))
    }

    #[test]
    fn the_table_points_one_way() {
        for (i, (module, allowed)) in MODULES.iter().enumerate() {
            for target in *allowed {
                let place = MODULES.iter().position(|(name, _)| name == target);
                assert!(
                    place.is_some_and(|place| place < i),
                    "{module} uses {target}"
                );
            }
        }
    }

    #[test]
    fn what_may_be_used() {
        for (path, text) in [
            (
                "src/orbit/tle.rs",
                "use crate::frames::Epoch; use super::OrbitState;",
            ),
            (
                "src/earth.rs",
                "use crate::{frames::{Epoch, self}, gpu::GpuContext};",
            ),
            (
                "src/globe/mod.rs",
                "mod blocks; use crate::globe::blocks; use crate::Epoch;",
            ),
            ("src/lib.rs", "use crate::play::Clock;"),
            ("src/main.rs", "use terrella_play;"),
            (
                "src/frames/sun.rs",
                "// crate::earth\nmod tests { use super::*; use super::super::Epoch; }",
            ),
            (
                "src/gpu/air.rs",
                "pub(crate) fn f() {} mod a { use super::super::Targets; }",
            ),
            (
                "src/play/clock.rs",
                "fn f() { crate::scene::Scene::load() }",
            ),
        ] {
            assert_eq!(check(path, text), [""; 0], "{path}: {text}");
        }
    }

    #[test]
    fn what_may_not_be_used() {
        for (path, text) in [
            ("src/frames/sun.rs", "use crate::earth::Sky;"),
            ("src/frames/sun.rs", "fn f() -> crate::earth::Sky {}"),
            ("src/frames/sun.rs", "use super::super::earth;"),
            ("src/frames/mod.rs", "use super::earth::Sky;"),
            (
                "src/frames/mod.rs",
                "mod tests { use super::super::earth::Sky; }",
            ),
            (
                "src/scene/mod.rs",
                "use crate::{frames::Epoch, earth::{Sky, Shading}};",
            ),
            ("src/scene/mod.rs", "use crate::EyeView;"),
            ("src/imagery/mod.rs", "use crate::orbit::OrbitState;"),
            ("src/gpu/earth.rs", "use crate::orbit::OrbitState;"),
            ("src/gpu/earth.rs", "use crate::scene::Scene;"),
            ("src/earth.rs", "use crate::scene::Scene;"),
            ("src/air/mod.rs", "use crate::orbit::OrbitState;"),
            ("src/earth.rs", "use super::play::Clock;"),
            ("src/earth.rs", "use terrella_play::Clock;"),
            ("src/air/mod.rs", "use crate::globe::Figure;"),
            ("src/new/mod.rs", "fn f() {}"),
            ("src/new.rs", "fn f() {}"),
            ("src/earth.rs", "use crate::nothing;"),
        ] {
            assert_eq!(check(path, text).len(), 1, "{path}: {text}");
        }
    }

    #[test]
    fn a_table_is_compared_name_by_name() {
        let table = |modules: &[&str]| {
            let rows: Vec<_> = modules
                .iter()
                .map(|name| format!("//! | [`{name}`] | it |\n"))
                .collect();
            format!(
                "//! Text.\n//! | module | knows |\n//! |---|---|\n{}//!\n//! | a | b |\n",
                rows.concat()
            )
        };
        let names: Vec<_> = MODULES.iter().map(|(name, _)| *name).collect();
        let no_table = ("README.md", "frames".to_owned());
        let check =
            |modules: &[&str]| unlike_the_table(&[no_table.clone(), ("lib.rs", table(modules))]);
        assert_eq!(check(&names), [""; 0]);
        assert_eq!(check(&names[..names.len() - 1]).len(), 1);
        let mut swapped = names.clone();
        swapped.swap(1, 2);
        assert_eq!(check(&swapped).len(), 1);
        assert_eq!(unlike_the_table(std::slice::from_ref(&no_table)).len(), 1);
    }

    #[test]
    fn what_is_allowed_must_be_used() {
        let lib = File::new("src/lib.rs", "pub use frames::Epoch;");
        let files = [
            File::new("src/orbit/mod.rs", "use crate::Epoch;"),
            File::new("src/globe/mod.rs", "fn f() {}"),
        ];
        let unused = unused(&files, &exports(&lib));
        assert!(!unused.contains(&"`orbit` is allowed `frames` and does not use it".to_owned()));
        assert!(unused.contains(&"`globe` is allowed `frames` and does not use it".to_owned()));
    }

    #[test]
    fn a_violation_says_where() {
        let found = check("src/orbit/tle.rs", "\nuse crate::gpu::X;");
        assert_eq!(
            found,
            ["src/orbit/tle.rs:2: `orbit` may not use `gpu` (by `gpu`)"]
        );
    }
}
