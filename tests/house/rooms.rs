//! Which room of `src/` may use which.

use crate::source::{File, Token, after_group};
use std::collections::BTreeMap;

/// Each room with the rooms that it may use. A room that is not here may not exist.
#[rustfmt::skip]
const ROOMS: &[(&str, &[&str])] = &[
    ("frames", &[]),
    ("orbit", &["frames"]),
    ("elevation", &["frames"]),
    ("globe", &["frames", "elevation"]),
    ("air", &["frames", "orbit"]),
    // Maps and drawables know nothing of satellites.
    ("imagery", &["frames", "elevation", "globe", "air"]),
    ("scene", &["frames", "orbit", "elevation", "globe", "air", "imagery"]),
    ("gpu", &["frames", "elevation", "globe", "air", "imagery", "scene"]),
    ("earth", &["frames", "orbit", "elevation", "globe", "air", "imagery", "scene", "gpu"]),
    // Drawn with the Earth, for any feed: knows no scene.
    ("tracks", &["frames", "orbit", "globe", "air", "gpu", "earth"]),
    ("play", &["frames", "orbit", "elevation", "globe", "air", "imagery", "scene", "gpu", "earth", "tracks"]),
    ("measure", &["frames", "orbit", "elevation", "globe", "air", "imagery", "scene", "gpu", "earth", "tracks", "play"]),
    ("cli", &["frames", "orbit", "elevation", "globe", "air", "imagery", "scene", "gpu", "earth", "tracks", "play", "measure"]),
];

/// Names that `lib.rs` exports from rooms, with their rooms: `crate::Earth` is `earth`.
pub fn exports(lib: &File) -> BTreeMap<String, String> {
    let mut exports = BTreeMap::new();
    for start in lib.find(&["pub", "use"]) {
        let path = start + 2;
        let Some(room) = lib.tokens.get(path).and_then(Token::name) else {
            continue;
        };
        for (name, _) in heads(&lib.tokens, path + 1) {
            exports.insert(name.to_string(), room.to_string());
        }
    }
    exports
}

/// The room of a source file; `None` for `lib.rs` and `main.rs`, which hold the rooms together.
fn room_of(path: &str) -> Option<&str> {
    let inside = path.strip_prefix("src/")?;
    let room = inside.split('/').next()?.trim_end_matches(".rs");
    (!matches!(inside, "lib.rs" | "main.rs")).then_some(room)
}

/// How many modules deep the file's own module is: `super` that often leads to the crate.
fn depth(path: &str) -> usize {
    let inside = path.trim_start_matches("src/").trim_end_matches(".rs");
    inside.trim_end_matches("/mod").split('/').count()
}

/// What in this file uses a room that it may not know.
pub fn violations(file: &File, exports: &BTreeMap<String, String>) -> Vec<String> {
    let Some(room) = room_of(&file.path) else {
        return Vec::new();
    };
    let Some((_, allowed)) = ROOMS.iter().find(|(name, _)| *name == room) else {
        return vec![format!(
            "{}: room `{room}` is not in the table of tests/house/rooms.rs",
            file.path
        )];
    };
    let mut violations = Vec::new();
    for (name, token) in uses(file) {
        let target = match ROOMS.iter().find(|(room, _)| *room == name) {
            Some((target, _)) => *target,
            None => match exports.get(name) {
                Some(target) => target.as_str(),
                None => {
                    violations.push(file.at(
                        token,
                        format!("`{name}` is no room and nothing that lib.rs exports"),
                    ));
                    continue;
                }
            },
        };
        if target != room && !allowed.contains(&target) {
            violations.push(file.at(
                token,
                format!("`{room}` may not use `{target}` (by `{name}`)"),
            ));
        }
    }
    violations
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
            uses.extend(heads(tokens, i + 1));
            i += 1;
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
        for (i, (room, allowed)) in ROOMS.iter().enumerate() {
            for target in *allowed {
                let place = ROOMS.iter().position(|(name, _)| name == target);
                assert!(place.is_some_and(|place| place < i), "{room} uses {target}");
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
            ("src/main.rs", "use terrella::play;"),
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
            ("src/earth.rs", "use super::play::Clock;"),
            ("src/earth.rs", "use terrella::play::Clock;"),
            ("src/air/mod.rs", "use crate::globe::Figure;"),
            ("src/new/mod.rs", "fn f() {}"),
            ("src/new.rs", "fn f() {}"),
            ("src/earth.rs", "use crate::nothing;"),
        ] {
            assert_eq!(check(path, text).len(), 1, "{path}: {text}");
        }
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
