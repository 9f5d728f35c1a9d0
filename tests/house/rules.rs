//! Rules about one file each. They give a line for each violation.

use crate::modules;
use crate::repository::{Page, Repository};
use crate::source::{File, Word, after_group};

/// A rule about one source file.
pub type Rule = fn(&File) -> Vec<String>;

/// Modules that compile and are tested without a GPU.
const WITHOUT_GPU: &[&str] = &[
    "frames",
    "orbit",
    "elevation",
    "globe",
    "air",
    "light",
    "imagery",
    "model",
    "plan",
    "pack",
    "fetch",
    "sensor",
    "scene",
];

/// Longer files hold more than one concern.
const LINES: usize = 600;

/// Size limits of one tracked file and of all, bytes.
const FILE_BYTES: u64 = 3_000_000;
const ALL_BYTES: u64 = 40_000_000;

fn all(file: &File, words: &[&str], message: &str) -> Vec<String> {
    let found = file.find(words).into_iter();
    found.map(|i| file.at(&file.tokens[i], message)).collect()
}

/// No `wgpu` in a module without a GPU.
pub fn names_no_gpu(file: &File) -> Vec<String> {
    let is_without =
        modules::module_of(&file.path).is_some_and(|module| WITHOUT_GPU.contains(&module));
    if !is_without {
        return Vec::new();
    }
    all(file, &["wgpu"], "this module must not know wgpu")
}

/// A `mod.rs` lists its modules and exports. A module with code is a file beside the folder of its name.
pub fn lists_modules(file: &File) -> Vec<String> {
    if !file.path.ends_with("/mod.rs") {
        return Vec::new();
    }
    let tokens = &file.tokens;
    let is = |i: usize, mark| tokens.get(i).is_some_and(|token| token.is_mark(mark));
    let mut i = 0;
    while i < tokens.len() {
        if is(i, '#') {
            let bracket = i + 1 + usize::from(is(i + 1, '!'));
            i = after_group(tokens, bracket);
            continue;
        }
        let item = i;
        if tokens[i].is_name("pub") {
            i += 1;
            if is(i, '(') {
                i = after_group(tokens, i);
            }
        }
        let name = tokens.get(i).and_then(|token| token.name());
        let is_list = match name {
            Some("mod") => is(i + 2, ';'),
            Some("use") => true,
            _ => false,
        };
        if !is_list {
            let message = "code in mod.rs: put it into a file beside this folder, by its name";
            return vec![file.at(&tokens[item], message)];
        }
        while i < tokens.len() && !is(i, ';') {
            i += 1;
        }
        i += 1;
    }
    Vec::new()
}

/// Descriptors that have no label.
const UNLABELLED: &[&str] = &["InstanceDescriptor"];

/// Every GPU object has a label that begins with `terrella`.
pub fn labels_gpu_objects(file: &File) -> Vec<String> {
    let mut violations = all(
        file,
        &["label", ":", "None"],
        "a GPU object without a label",
    );
    for (i, token) in file.tokens.iter().enumerate() {
        let Some(name) = token.name() else { continue };
        if !name.ends_with("Descriptor") || UNLABELLED.contains(&name) {
            continue;
        }
        let next = |n: usize| file.tokens.get(i + n);
        let is_literal = next(1).is_some_and(|t| t.is_mark('{'));
        // `-> Descriptor {` and `impl … Descriptor {` open a body, not a value.
        let opens_body = i > 0
            && (file.tokens[i - 1].is_mark('>')
                || ["struct", "enum", "impl", "for", "trait"]
                    .iter()
                    .any(|word| file.tokens[i - 1].is_name(word)));
        if is_literal && !opens_body {
            let group = &file.tokens[i + 1..after_group(&file.tokens, i + 1)];
            if !group.iter().any(|t| t.is_name("label")) {
                violations.push(file.at(token, format!("{name} without a label")));
            }
        }
        let is_default = [":", ":", "default"].iter().enumerate().all(|(n, word)| {
            next(n + 1).is_some_and(|t| t.is_name(word) || word.starts_with(':') && t.is_mark(':'))
        });
        if is_default {
            violations.push(file.at(token, format!("{name}::default() has no label")));
        }
    }
    // A description of ours has its label plain, wgpu's an option of one.
    let plain = file.find(&["PipelineDescription", "{", "label", ":"]);
    let optional = file.find(&["label", ":", "Some", "("]);
    for i in plain.into_iter().chain(optional) {
        if let Some(token) = file.tokens.get(i + 4)
            && let Word::Text(label) = &token.word
            && !label.starts_with("terrella")
        {
            violations.push(file.at(
                token,
                format!("label \"{label}\" must begin with `terrella`"),
            ));
        }
    }
    violations
}

/// The one file that reaches the network on its own account.
const HTTP_FILE: &str = "crates/terrella-pack/src/fetch/http.rs";

/// Only one file sends requests to servers: there is no network access except in `pack fetch` and `elements fetch`.
pub fn asks_no_server(file: &File) -> Vec<String> {
    if file.path == HTTP_FILE {
        return Vec::new();
    }
    all(file, &["ureq"], &format!("only {HTTP_FILE} may use HTTP"))
}

/// The module whose opener rejects pipes, devices and folders.
const FILES_FOLDER: &str = "crates/terrella-files/src/";

/// It reads no user files, only the system's description of itself.
const MACHINE_FILE: &str = "crates/terrella-measure/src/machine.rs";

/// Files are opened and read by one opener.
pub fn opens_files_in_one_place(file: &File) -> Vec<String> {
    if file.path.starts_with(FILES_FOLDER)
        || file.path == MACHINE_FILE
        || file.path.contains("tests")
        || modules::module_of(&file.path).is_none()
    {
        return Vec::new();
    }
    let ways = [["File", "open"], ["fs", "read"], ["fs", "read_to_string"]];
    let found = ways
        .iter()
        .flat_map(|[from, name]| file.find(&[from, ":", ":", name, "("]));
    found
        .filter(|i| !file.tokens[*i].in_test)
        .map(|i| {
            file.at(
                &file.tokens[i],
                "open files by `files`: it never waits for a pipe",
            )
        })
        .collect()
}

/// No marker of unfinished work.
pub fn leaves_nothing_unfinished(file: &File) -> Vec<String> {
    ["todo", "unimplemented", "dbg"]
        .iter()
        .flat_map(|name| all(file, &[name, "!"], &format!("`{name}!` is left here")))
        .collect()
}

/// `anyhow` only in the command.
pub fn keeps_anyhow_in_the_command(file: &File) -> Vec<String> {
    if file.path.starts_with("crates/terrella-cli/") {
        return Vec::new();
    }
    all(
        file,
        &["anyhow"],
        "the library's errors are typed: no anyhow here",
    )
}

/// No `unwrap()` outside tests: `expect` gives the reason why it cannot fail, an error gives the remedy.
pub fn unwraps_nothing(file: &File) -> Vec<String> {
    let found = file.find(&[".", "unwrap", "("]).into_iter();
    found
        .map(|i| &file.tokens[i])
        .filter(|token| !token.in_test)
        .map(|token| file.at(token, "`unwrap()` outside a test"))
        .collect()
}

/// A file is one concern.
pub fn is_short(file: &File) -> Vec<String> {
    let lines = file.lines;
    let long = lines > LINES;
    long.then(|| format!("{}: {lines} lines, more than {LINES}: split it", file.path))
        .into_iter()
        .collect()
}

/// Scenes that no page names.
pub fn unpresented(scenes: &[String], pages: &[String]) -> Vec<String> {
    let is_named = |scene: &&String| pages.iter().any(|page| page.contains(scene.as_str()));
    let missing = scenes.iter().filter(|scene| !is_named(scene));
    missing
        .map(|scene| {
            format!("config/{scene} is named neither in README.md nor in config/README.md")
        })
        .collect()
}

/// Files that are too large, and the whole if it is.
pub fn too_large(sizes: &[(String, u64)]) -> Vec<String> {
    let large = sizes.iter().filter(|(_, bytes)| *bytes > FILE_BYTES);
    let mut found: Vec<_> = large
        .map(|(path, bytes)| format!("{path}: {bytes} bytes, more than {FILE_BYTES}"))
        .collect();
    let sum: u64 = sizes.iter().map(|(_, bytes)| bytes).sum();
    if sum > ALL_BYTES {
        found.push(format!(
            "all tracked files: {sum} bytes, more than {ALL_BYTES}"
        ));
    }
    found
}

/// Links to files that are not there.
pub fn dead_links(page: &Page, repository: &Repository) -> Vec<String> {
    let folder = page.path.rsplit_once('/').map_or("", |(folder, _)| folder);
    targets(&page.text)
        .into_iter()
        .filter(|target| {
            !target.contains("://")
                && !target.starts_with(['#', '/'])
                && !target.starts_with("mailto:")
        })
        .filter_map(|target| {
            let file = target.split(['#', '?']).next().unwrap_or(target);
            let path = if folder.is_empty() {
                file.to_string()
            } else {
                format!("{folder}/{file}")
            };
            (!repository.exists(&path)).then(|| format!("{}: {target} is not there", page.path))
        })
        .collect()
}

/// Targets of the links and images of a Markdown text. Those in listings belong to the reader's own pages.
pub fn targets(text: &str) -> Vec<&str> {
    let after = |opening: &'static str, closing: [char; 2]| {
        let prose = text.split("```").step_by(2);
        let parts = prose.flat_map(move |prose| prose.split(opening).skip(1));
        parts
            .filter_map(move |rest| rest.split(closing).next())
            .filter(|target| !target.is_empty())
    };
    after("](", [')', ' '])
        .chain(after("src=\"", ['"', '"']))
        .chain(after("href=\"", ['"', '"']))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How often the rule is broken in a text.
    fn count(rule: Rule, path: &str, text: &str) -> usize {
        rule(&File::new(path, text)).len()
    }

    #[test]
    fn gpu_names() {
        let text = "//! no wgpu here\nuse wgpu::Device;";
        assert_eq!(
            count(names_no_gpu, "crates/terrella-frames/src/sun.rs", text),
            1
        );
        assert_eq!(
            count(names_no_gpu, "crates/terrella-ground/src/air.rs", text),
            1
        );
        assert_eq!(count(names_no_gpu, "src/gpu/air.rs", text), 0);
        assert_eq!(count(names_no_gpu, "src/airship/mod.rs", text), 0);
        assert_eq!(
            count(
                names_no_gpu,
                "crates/terrella-frames/src/sun.rs",
                "// wgpu\nlet a = \"wgpu\";"
            ),
            0
        );
    }

    #[test]
    fn lists() {
        let count = |text| count(lists_modules, "src/a/mod.rs", text);
        let list = "//! A.\n#![allow(dead_code)]\n#[cfg(test)]\nmod b;\npub(crate) mod c;\npub use b::{C, D as E};";
        assert_eq!(count(list), 0);
        assert_eq!(count("mod b { struct A; }"), 1);
        assert_eq!(count("mod b;\npub fn f() {}"), 1);
        assert_eq!(count("mod b;\n#[derive(Clone)]\nstruct A;"), 1);
        assert!(lists_modules(&File::new("src/a.rs", "pub fn f() {}")).is_empty());
    }

    #[test]
    fn labels() {
        let count = |text| count(labels_gpu_objects, "src/gpu/a.rs", text);
        assert_eq!(count("wgpu::BufferDescriptor { label: None, size }"), 1);
        assert_eq!(
            count("wgpu::BufferDescriptor { size, ..Default::default() }"),
            1
        );
        assert_eq!(count("&wgpu::TextureViewDescriptor::default()"), 1);
        assert_eq!(
            count("BufferDescriptor { label: Some(\"vertices\"), size }"),
            1
        );
        assert_eq!(
            count("BufferDescriptor { label: Some(\"terrella vertices\"), size }"),
            0
        );
        assert_eq!(count("BufferDescriptor { label, size }"), 0);
        assert_eq!(count("BufferDescriptor { label: Some(&name), size }"), 0);
        assert_eq!(count("InstanceDescriptor { flags }"), 0);
        assert_eq!(count("fn f() -> BufferDescriptor { g() }"), 0);
    }

    #[test]
    fn servers() {
        let text = "//! no ureq here\nuse ureq::Agent;";
        assert_eq!(
            count(
                asks_no_server,
                "crates/terrella-pack/src/fetch/download.rs",
                text
            ),
            1
        );
        assert_eq!(count(asks_no_server, HTTP_FILE, text), 0);
    }

    #[test]
    fn unfinished_work() {
        let count = |text| count(leaves_nothing_unfinished, "src/a.rs", text);
        assert_eq!(
            count("fn f() { todo!() } fn g() { unimplemented!(\"x\"); dbg!(1); }"),
            3
        );
        assert_eq!(count("// todo!()\nlet todo = \"todo!\";"), 0);
    }

    #[test]
    fn typed_errors() {
        let text = "use anyhow::Context;";
        assert_eq!(
            count(
                keeps_anyhow_in_the_command,
                "crates/terrella-play/src/video.rs",
                text
            ),
            1
        );
        assert_eq!(
            count(
                keeps_anyhow_in_the_command,
                "crates/terrella-cli/src/frame.rs",
                text
            ),
            0
        );
    }

    #[test]
    fn unwraps() {
        let count = |text| count(unwraps_nothing, "src/a.rs", text);
        assert_eq!(
            count("fn f() { a.unwrap(); b.unwrap_or(1); c.expect(\"held\"); }"),
            1
        );
        assert_eq!(
            count("#[cfg(test)] mod tests { fn f() { a.unwrap(); } } fn g() { a\n.unwrap(); }"),
            1
        );
    }

    #[test]
    fn lengths() {
        assert_eq!(count(is_short, "src/a.rs", &"\n".repeat(LINES)), 0);
        assert_eq!(count(is_short, "src/a.rs", &"\n".repeat(LINES + 1)), 1);
    }

    #[test]
    fn scenes() {
        let scenes = ["iss.toml".to_string(), "moon.toml".to_string()];
        let found = unpresented(&scenes, &["run config/iss.toml".to_string(), String::new()]);
        assert_eq!(found.len(), 1);
        assert!(found[0].contains("moon.toml"));
    }

    #[test]
    fn sizes() {
        let file = |name: &str, bytes| (name.to_string(), bytes);
        assert_eq!(too_large(&[file("a", FILE_BYTES)]), [""; 0]);
        assert_eq!(
            too_large(&[file("a", 1), file("b", FILE_BYTES + 1)]).len(),
            1
        );
        assert_eq!(too_large(&vec![file("a", FILE_BYTES); 14]).len(), 1);
    }

    #[test]
    fn links() {
        let page = |path: &str, text: &str| Page {
            path: path.into(),
            text: text.into(),
        };
        let dead = |path, text| dead_links(&page(path, text), &Repository::open()).len();
        assert_eq!(
            dead(
                "README.md",
                "[a](src/lib.rs) [b](https://a.b/c) [c](#d) <img src=\"Cargo.toml\">"
            ),
            0
        );
        assert_eq!(
            dead(
                "README.md",
                "[a](src/gone.rs#x) ![b](gone.png \"title\") <img src=\"gone.png\">"
            ),
            3
        );
        let listed = "```html\n<a href=\"gone.html\">\n```\n[a](gone.rs)";
        assert_eq!(dead("README.md", listed), 1);
        assert_eq!(dead("src/README.md", "[a](../Cargo.toml) [b](lib.rs)"), 0);
        assert_eq!(dead("src/README.md", "[a](Cargo.toml)"), 1);
    }
}
