//! Platform differences are confined to few files: a web page has one thread, no clock of the standard library, and in WebGL2 no base vertex. Code
//! that uses one of them compiles for a page, but panics in it.

use crate::source::{File, Token, after_group};

/// Sources that web pages are built of.
pub const FOLDERS: &[&str] = &[
    "crates/terrella-files/src",
    "crates/terrella-frames/src",
    "crates/terrella-ground/src",
    "crates/terrella-imagery/src",
    "crates/terrella-orbit/src",
    "src",
];

/// The files that use the clock and the threads of a platform.
pub const KNOWING: &[&str] = &[
    "crates/terrella-files/src/clock.rs",
    "crates/terrella-files/src/loaders.rs",
    "crates/terrella-files/src/parallel.rs",
];

/// Sources of features that no page has: sockets, and packs, which are read from disk.
const NOT_IN_PAGES: &[&str] = &[
    "crates/terrella-imagery/src/pack/",
    "crates/terrella-orbit/src/basilisk/",
    "crates/terrella-orbit/src/connections.rs",
    "crates/terrella-orbit/src/live.rs",
    "crates/terrella-orbit/src/live/",
];

/// Clocks, threads and base vertices where they must not be.
pub fn runs_in_pages(file: &File) -> Vec<String> {
    let is_inside = |start: &&str| file.path.starts_with(start);
    // A file of tests beside the code that names it `mod tests`.
    if file.path.ends_with("_tests.rs") {
        return Vec::new();
    }
    if KNOWING.contains(&file.path.as_str()) || NOT_IN_PAGES.iter().any(is_inside) {
        return Vec::new();
    }
    let mut found = Vec::new();
    for i in file.find(&["std", ":", ":", "time", ":", ":"]) {
        let group = i + 6;
        let end = match file.tokens.get(group) {
            Some(token) if token.is_mark('{') => after_group(&file.tokens, group),
            _ => group + 1,
        };
        let names = file.tokens.get(group..end).unwrap_or_default();
        let clock = names.iter().find(|token| token.is_name("Instant"));
        found.extend(clock.map(|token| (token, "the clock is `terrella_files::clock`")));
    }
    let mut all = |words: &[&str], message| {
        let places = file.find(words).into_iter();
        found.extend(places.map(|i| (&file.tokens[i], message)));
    };
    all(
        &["SystemTime", ":", ":", "now"],
        "a page has no `SystemTime`: take the epoch from the host",
    );
    for start in ["spawn", "scope", "Builder"] {
        all(
            &["thread", ":", ":", start],
            "threads are started by `terrella_files::parallel`",
        );
    }
    for i in file.find(&[".", "draw_indexed", "("]) {
        let arguments = &file.tokens[i + 3..after_group(&file.tokens, i + 2)];
        if !has_base_zero(arguments) {
            let message = "WebGL2 has no base vertex: offset the vertex buffer, and draw with 0";
            found.push((&file.tokens[i], message));
        }
    }
    let found = found.into_iter().filter(|(token, _)| !token.in_test);
    found
        .map(|(token, message)| file.at(token, message))
        .collect()
}

/// Whether the second argument is a literal 0.
fn has_base_zero(arguments: &[Token]) -> bool {
    let mut i = 0;
    while let Some(token) = arguments.get(i) {
        if token.is_mark(',') {
            let after = arguments.get(i + 2);
            return arguments.get(i + 1).is_some_and(|token| token.is_name("0"))
                && after.is_some_and(|token| token.is_mark(','));
        }
        i = match token.is_mark('(') || token.is_mark('[') || token.is_mark('{') {
            true => after_group(arguments, i),
            false => i + 1,
        };
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(path: &str, text: &str) -> usize {
        runs_in_pages(&File::new(path, text)).len()
    }

    #[test]
    fn what_a_page_has_not() {
        for text in [
            "use std::time::{Duration, Instant};",
            "let begin = std::time::Instant::now();",
            "let now = std::time::SystemTime::now();",
            "std::thread::scope(|scope| scope.spawn(work));",
            "std::thread::spawn(work);",
            "pass.draw_indexed(f(1, 2)..3, base, 0..1);",
            "pass.draw_indexed(a, 0 + base, 0..1);",
        ] {
            assert_eq!(count("src/gpu/a.rs", text), 1, "{text}");
            assert_eq!(count(KNOWING[0], text), 0, "{text}");
            assert_eq!(count("crates/terrella-orbit/src/live/a.rs", text), 0);
            let test = format!("#[cfg(test)]\nmod tests {{ {text} }}");
            assert_eq!(count("src/gpu/a.rs", &test), 0, "{text}");
        }
    }

    #[test]
    fn what_a_page_has() {
        for text in [
            "use std::time::Duration;",
            "use terrella_files::clock::Instant; let begin = Instant::now();",
            "parallel::map(3, work);",
            "pass.draw_indexed(f(1, 2)..3, 0, 0..1);",
        ] {
            assert_eq!(count("src/gpu/a.rs", text), 0, "{text}");
        }
    }
}
