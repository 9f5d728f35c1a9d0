//! Which module may use which. A module is a folder or file directly in the sources of a crate, with all that is in it; what a crate has
//! there that is no module of this table belongs to the crate's first one.

use crate::source::{File, Token, after_group};
use std::collections::{BTreeMap, BTreeSet};

/// Each module with the modules that it may use. A module that is not here may not exist. That no crate uses one above it, the compiler
/// sees too; within a crate only this table does.
#[rustfmt::skip]
const MODULES: &[(&str, &[&str])] = &[
    ("files", &[]),
    ("durable", &[]),
    ("clock", &[]),
    ("parallel", &[]),
    ("loaders", &[]),
    ("frames", &["files"]),
    ("orbit", &["files", "frames"]),
    ("basilisk", &["files", "frames", "orbit"]),
    ("step", &[]),
    ("height", &[]),
    ("elevation", &["files", "loaders", "frames", "step", "height"]),
    ("globe", &["frames", "height", "elevation"]),
    ("half", &[]),
    ("air", &["parallel", "frames", "half"]),
    ("light", &["frames", "step", "air"]),
    // Maps and drawables know nothing of satellites.
    ("imagery", &["files", "clock", "parallel", "loaders", "elevation", "globe"]),
    // Triangles and materials of spacecraft; knows no scene.
    ("model", &["files", "imagery"]),
    ("shipped", &[]),
    // What a frame draws knows nothing of what draws it.
    ("plan", &["frames", "step", "globe", "air", "light", "imagery"]),
    ("gpu", &["files", "parallel", "frames", "globe", "half", "air", "light", "imagery", "plan"]),
    ("earth", &["files", "clock", "frames", "step", "height", "elevation", "globe", "air", "light", "imagery", "plan", "gpu"]),
    // Drawn into memory.
    ("offscreen", &["light", "imagery", "gpu", "earth"]),
    // Drawn behind the Earth.
    ("celestial", &["files", "frames", "air", "light", "imagery", "plan", "gpu", "earth"]),
    // Drawn with the Earth, for any feed: knows no scene.
    ("tracks", &["files", "frames", "orbit", "globe", "half", "air", "light", "plan", "gpu", "earth"]),
    ("pack", &["files", "durable", "elevation", "globe", "imagery"]),
    // Maps from the network, for packs.
    ("fetch", &["files", "durable", "imagery", "pack"]),
    // Light that others drew; knows no scene.
    ("sensor", &[]),
    ("scene", &["shipped", "files", "frames", "orbit", "basilisk", "globe", "air", "light", "sensor", "plan"]),
    ("play", &["files", "frames", "durable", "orbit", "basilisk", "elevation", "light", "imagery", "model", "sensor", "plan", "scene", "gpu", "earth", "offscreen", "celestial", "tracks"]),
    // The image as it should be. It shares constants with what draws, but no code.
    ("reference", &["frames", "elevation", "globe", "air", "light", "imagery", "plan", "earth"]),
    ("measure", &["files", "frames", "orbit", "elevation", "globe", "air", "light", "imagery", "plan", "scene", "gpu", "earth", "offscreen", "play", "reference"]),
    ("cli", &["files", "frames", "orbit", "basilisk", "globe", "imagery", "pack", "fetch", "scene", "gpu", "play", "reference", "measure"]),
];

/// A crate of the product.
struct Crate {
    /// Its name in paths.
    name: &'static str,
    /// Its sources.
    folder: &'static str,
    /// The module of the files beside its other modules; a crate without one has only modules.
    first: Option<&'static str>,
    modules: &'static [&'static str],
}

#[rustfmt::skip]
const CRATES: &[Crate] = &[
    Crate { name: "terrella_files", folder: "crates/terrella-files/src/", first: Some("files"), modules: &["durable", "clock", "parallel", "loaders"] },
    Crate { name: "terrella_frames", folder: "crates/terrella-frames/src/", first: Some("frames"), modules: &[] },
    Crate { name: "terrella_orbit", folder: "crates/terrella-orbit/src/", first: Some("orbit"), modules: &["basilisk"] },
    Crate { name: "terrella_ground", folder: "crates/terrella-ground/src/", first: None, modules: &["step", "height", "elevation", "globe", "half", "air", "light"] },
    Crate { name: "terrella_imagery", folder: "crates/terrella-imagery/src/", first: Some("imagery"), modules: &[] },
    Crate { name: "terrella_model", folder: "crates/terrella-model/src/", first: Some("model"), modules: &[] },
    Crate { name: "terrella", folder: "src/", first: None, modules: &["shipped", "plan", "gpu", "earth", "offscreen", "celestial", "tracks"] },
    Crate { name: "terrella_pack", folder: "crates/terrella-pack/src/", first: Some("pack"), modules: &["fetch"] },
    Crate { name: "terrella_sensor", folder: "crates/terrella-sensor/src/", first: Some("sensor"), modules: &[] },
    Crate { name: "terrella_play", folder: "crates/terrella-play/src/", first: Some("play"), modules: &["scene"] },
    Crate { name: "terrella_reference", folder: "crates/terrella-reference/src/", first: Some("reference"), modules: &[] },
    Crate { name: "terrella_measure", folder: "crates/terrella-measure/src/", first: Some("measure"), modules: &[] },
    Crate { name: "terrella_cli", folder: "crates/terrella-cli/src/", first: Some("cli"), modules: &[] },
];

/// The folders of all sources in the table.
pub fn folders() -> impl Iterator<Item = &'static str> {
    CRATES.iter().map(|one| one.folder.trim_end_matches('/'))
}

/// Names that `lib.rs` exports, with their modules: `terrella::Earth` is `earth`, `terrella::Epoch` is `frames`.
pub fn exports(lib: &File) -> BTreeMap<String, String> {
    let mut exports = BTreeMap::new();
    for start in lib.find(&["pub", "use"]) {
        let path = start + 2;
        let Some(first) = lib.tokens.get(path).and_then(Token::name) else {
            continue;
        };
        let Some(from) = CRATES.iter().find(|one| one.name == first) else {
            for (name, _) in heads(&lib.tokens, path + 1) {
                exports.insert(name.to_owned(), first.to_owned());
            }
            continue;
        };
        // `pub use terrella_ground::globe::{Figure, Shading};`, and `pub use terrella_frames::Epoch;`.
        for (name, _) in heads(&lib.tokens, path + 1) {
            if !from.modules.contains(&name) {
                let first = from.first.unwrap_or(name);
                exports.insert(name.to_owned(), first.to_owned());
                continue;
            }
            for (inner, _) in heads(&lib.tokens, path + 4) {
                exports.insert(inner.to_owned(), name.to_owned());
            }
        }
    }
    exports
}

/// The crate of a source file, and the file's path below the crate's sources.
fn crate_of(path: &str) -> Option<(&'static Crate, &str)> {
    let inside = |one: &'static Crate| Some((one, path.strip_prefix(one.folder)?));
    CRATES.iter().find_map(inside)
}

/// The module of a source file; `None` for those that hold modules together, and outside of the product.
pub fn module_of(path: &str) -> Option<&str> {
    let (one, inside) = crate_of(path)?;
    let first = inside.split('/').next()?.trim_end_matches(".rs");
    match (one.modules.contains(&first), one.first) {
        (true, _) => Some(first),
        (false, Some(module)) => Some(module),
        (false, None) => (inside != "lib.rs").then_some(first),
    }
}

/// How many modules deep the file's own module is: `super` that often leads to the crate.
fn depth(path: &str) -> usize {
    let inside = crate_of(path).map_or(path, |(_, inside)| inside);
    let inside = inside.trim_end_matches(".rs").trim_end_matches("/mod");
    match inside {
        "lib" | "main" => 0,
        _ => inside.split('/').count(),
    }
}

/// Uses of modules in this file that are not allowed.
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
    for (root, name, token) in uses(file) {
        let Some(target) = target_of(root, name, exports) else {
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

/// Allowed uses that no file has.
pub fn unused(files: &[File], exports: &BTreeMap<String, String>) -> Vec<String> {
    let pairs: BTreeSet<_> = files
        .iter()
        .filter_map(|file| Some((module_of(&file.path)?, file)))
        .flat_map(|(module, file)| {
            let names = uses(file).into_iter();
            names.filter_map(move |(root, name, _)| Some((module, target_of(root, name, exports)?)))
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

/// How the table of modules in these pages differs from the enforced one. Pages without one are skipped; one page at
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

/// The module that a name at the root of a crate leads to.
fn target_of<'e>(
    one: &'static Crate,
    name: &'e str,
    exports: &'e BTreeMap<String, String>,
) -> Option<&'e str> {
    if one.modules.contains(&name) {
        return Some(name);
    }
    one.first.or_else(|| {
        let module = MODULES.iter().map(|(module, _)| *module);
        let mut module = module.filter(|module| *module == name);
        let exported = exports.get(name).map(String::as_str);
        exported.or_else(|| module.next())
    })
}

/// All names that the file reaches from the root of a crate, with that crate.
fn uses(file: &File) -> Vec<(&'static Crate, &str, &Token)> {
    let Some((own, _)) = crate_of(&file.path) else {
        return Vec::new();
    };
    let tokens = &file.tokens;
    let mut uses = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let token = &tokens[i];
        // A path's first word: not after `::`, not a field.
        let follows_path =
            i >= 1 && (tokens[i - 1].is_mark(':') && i >= 2 && tokens[i - 2].is_mark(':'));
        let named = CRATES.iter().find(|one| token.is_name(one.name));
        let root = named.or(token.is_name("crate").then_some(own));
        if follows_path {
            i += 1;
        } else if let Some(root) = root {
            // Modules that are hidden from hosts are one name deeper.
            let through_internals =
                is_path(tokens, i + 1) && tokens.get(i + 3).is_some_and(|t| t.is_name("internals"));
            let end = if through_internals { i + 4 } else { i + 1 };
            let heads = heads(tokens, end);
            if heads.is_empty() && root.first.is_some() && named.is_some() {
                // `use terrella_files as files;`
                uses.push((root, root.name, token));
            }
            uses.extend(heads.into_iter().map(|(name, at)| (root, name, at)));
            i = end;
        } else if token.is_name("super") {
            let mut supers = 1;
            let mut end = i + 1;
            while is_path(tokens, end) && tokens.get(end + 2).is_some_and(|t| t.is_name("super")) {
                supers += 1;
                end += 3;
            }
            if supers >= depth(&file.path) + token.inline_modules {
                uses.extend(
                    heads(tokens, end)
                        .into_iter()
                        .map(|(name, at)| (own, name, at)),
                );
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

/// The names after `::` at this place: one name, or the first names of a group in braces.
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
            "pub mod earth; pub use earth::{Earth, EyeView}; pub use terrella_frames::Epoch; pub use terrella_ground::globe::{Figure, quadtree::QuadtreeOptions};",
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
                "crates/terrella-orbit/src/tle.rs",
                "use terrella_frames::Epoch; use super::OrbitState; use terrella_files as files;",
            ),
            (
                "src/earth.rs",
                "use terrella_frames::{Epoch, self}; use crate::{gpu::GpuContext, Epoch};",
            ),
            (
                "crates/terrella-ground/src/globe.rs",
                "mod blocks; use crate::globe::blocks; use crate::elevation::Bounds;",
            ),
            ("src/lib.rs", "use terrella_play::Clock;"),
            (
                "crates/terrella-frames/src/sun.rs",
                "// terrella::earth\nmod tests { use super::*; use super::super::Epoch; }",
            ),
            (
                "src/gpu/air.rs",
                "pub(crate) fn f() {} mod a { use super::super::Targets; }",
            ),
            (
                "crates/terrella-play/src/clock.rs",
                "use crate::film::Key; fn f() { crate::scene::Scene::load() } use terrella::{EyeView, frames};",
            ),
            ("xtask/src/main.rs", "use crate::anything;"),
        ] {
            assert_eq!(check(path, text), [""; 0], "{path}: {text}");
        }
    }

    #[test]
    fn what_may_not_be_used() {
        for (path, text) in [
            ("crates/terrella-frames/src/sun.rs", "use terrella::Earth;"),
            (
                "crates/terrella-frames/src/sun.rs",
                "fn f() -> terrella::internals::earth::Sky {}",
            ),
            (
                "crates/terrella-frames/src/sun.rs",
                "use terrella_orbit as orbit;",
            ),
            ("src/gpu/sun.rs", "use super::super::earth;"),
            ("src/gpu.rs", "use super::earth::Sky;"),
            ("src/gpu.rs", "mod tests { use super::super::earth::Sky; }"),
            (
                "crates/terrella-play/src/scene.rs",
                "use terrella::{frames::Epoch, EyeView};",
            ),
            ("crates/terrella-play/src/scene.rs", "use crate::film::Key;"),
            (
                "crates/terrella-play/src/scene.rs",
                "use crate::{scene::Camera, film};",
            ),
            (
                "crates/terrella-imagery/src/lib.rs",
                "use terrella_orbit::OrbitState;",
            ),
            ("src/gpu/earth.rs", "use terrella_orbit::OrbitState;"),
            ("src/gpu/earth.rs", "use terrella_play::scene::Scene;"),
            (
                "crates/terrella-ground/src/air.rs",
                "use crate::globe::Figure;",
            ),
            (
                "crates/terrella-pack/src/cut.rs",
                "use crate::fetch::Source;",
            ),
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
        let lib = File::new("src/lib.rs", "");
        let files = [
            File::new(
                "crates/terrella-orbit/src/lib.rs",
                "use terrella_frames::Epoch;",
            ),
            File::new("crates/terrella-ground/src/globe.rs", "fn f() {}"),
        ];
        let unused = unused(&files, &exports(&lib));
        assert!(!unused.contains(&"`orbit` is allowed `frames` and does not use it".to_owned()));
        assert!(unused.contains(&"`globe` is allowed `frames` and does not use it".to_owned()));
    }

    #[test]
    fn a_violation_says_where() {
        let found = check("src/gpu/tile.rs", "\nuse crate::earth::X;");
        assert_eq!(
            found,
            ["src/gpu/tile.rs:2: `gpu` may not use `earth` (by `earth`)"]
        );
    }
}
