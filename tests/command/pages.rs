//! The shell blocks of the pages, run as they are printed.
//!
//! The blocks of a page run one after another in one folder, with the program on the PATH: pages of `docs/start/` in an empty folder, others in one
//! that contains the scenes of `config/`. A block whose fence says `sh no-run: REASON` is listed and not run. A `text` block below a shell block is
//! its expected output, both streams together, where a line `…` matches any lines. Sizes in bytes, and seconds at the end of a line, depend on the
//! machine and are not compared. The maps are the small ones of the other tests.

use crate::{REPOSITORY, small_maps};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A page by its path from the repository's root.
struct Page {
    path: String,
    text: String,
}

/// A shell block of a page.
#[derive(Debug, PartialEq, Eq)]
struct Block {
    /// Line of its fence.
    line: usize,
    /// Why it is not run.
    no_run: Option<String>,
    script: String,
    /// Its expected output, if the page shows it.
    printed: Option<String>,
}

fn pages() -> Vec<Page> {
    let root = Path::new(REPOSITORY);
    let mut files = Vec::new();
    collect(root, &["README.md"], &mut files);
    collect(&root.join("config"), &[], &mut files);
    collect(&root.join("docs"), &[], &mut files);
    collect(&root.join("crates/terrella-py"), &["README.md"], &mut files);
    let pages = files.into_iter().map(|file| Page {
        text: std::fs::read_to_string(&file).expect("a page"),
        path: relative(&file, root),
    });
    pages.collect()
}

fn relative(file: &Path, root: &Path) -> String {
    let path = file.strip_prefix(root).expect("below the root");
    path.to_string_lossy().replace('\\', "/")
}

/// Pages in a folder and below it, or only those with these names.
fn collect(folder: &Path, names: &[&str], files: &mut Vec<PathBuf>) {
    if !names.is_empty() {
        files.extend(names.iter().map(|name| folder.join(name)));
        return;
    }
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<_> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            collect(&path, names, files);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            files.push(path);
        }
    }
}

/// The shell blocks of a page. A fence of another language between a shell block and a `text` block separates them.
fn blocks(text: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut is_open = false;
    let mut lines = text.lines().zip(1..);
    while let Some((fence, line)) = lines.next() {
        let Some(info) = fence.strip_prefix("```") else {
            continue;
        };
        let inside = lines.by_ref().map(|(line, _)| line);
        let inside: Vec<_> = inside.take_while(|line| *line != "```").collect();
        let inside = inside.join("\n");
        match info.split_once(' ').unwrap_or((info, "")) {
            ("sh", marker) => blocks.push(Block {
                line,
                no_run: match marker {
                    "" => None,
                    marker => Some(marker.to_owned()),
                },
                script: inside,
                printed: None,
            }),
            ("text", _) if is_open => {
                if let Some(block) = blocks.last_mut() {
                    block.printed = Some(inside);
                }
            }
            _ => {}
        }
        is_open = info.starts_with("sh");
    }
    blocks
}

/// Failures of a page: blocks that end with an error, that print something else, and markers without a reason.
fn faults(page: &Page) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let home = tempfile::tempdir().expect("a temporary folder");
    if !page.path.starts_with("docs/start/") {
        let scenes = Path::new(REPOSITORY).join("config").canonicalize();
        let link = folder.path().join("config");
        std::os::unix::fs::symlink(scenes.expect("there"), link).expect("a link");
    }
    let mut faults = Vec::new();
    for block in blocks(&page.text) {
        let place = format!("{}:{}", page.path, block.line);
        if let Some(marker) = block.no_run {
            match marker.strip_prefix("no-run: ") {
                Some(reason) if !reason.trim().is_empty() => eprintln!("{place} not run: {reason}"),
                _ => faults.push(format!("{place}: {marker:?} is not \"no-run: REASON\"")),
            }
            continue;
        }
        let output = shell(&block.script, folder.path(), home.path());
        let printed = String::from_utf8_lossy(&output.stdout);
        if !output.status.success() {
            faults.push(format!("{place} fails:\n{}\n{printed}", block.script));
        }
        if let Some(shown) = block.printed
            && !is_printed(&shown, &printed)
        {
            faults.push(format!(
                "{place} prints something else than the page:\n{printed}"
            ));
        }
    }
    faults
}

/// Runs a block in bash, both streams into one.
fn shell(script: &str, folder: &Path, home: &Path) -> std::process::Output {
    let program = Path::new(env!("CARGO_BIN_EXE_terrella"));
    let own = program.parent().expect("a folder").to_owned();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::iter::once(own).chain(std::env::split_paths(&path)));
    Command::new("bash")
        .args(["--norc", "-eu", "-o", "pipefail", "-c"])
        .arg(format!("exec 2>&1\n{script}"))
        .current_dir(folder)
        .env("PATH", path.expect("no colon in a folder's name"))
        .env("HOME", home)
        .env("TERRELLA_TEXTURES", small_maps::folder())
        .env("XDG_RUNTIME_DIR", home)
        .env_remove("RUST_LOG")
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .expect("bash starts")
}

/// The page's lines are those that were printed, by the rule at the top of this file.
fn is_printed(shown: &str, printed: &str) -> bool {
    let [shown, printed] =
        [shown, printed].map(|text| text.trim_end().lines().map(comparable).collect::<Vec<_>>());
    has_lines(&shown, &printed)
}

fn has_lines(shown: &[String], printed: &[String]) -> bool {
    match shown {
        [] => printed.is_empty(),
        [any, rest @ ..] if any == "…" => {
            (0..=printed.len()).any(|skipped| has_lines(rest, &printed[skipped..]))
        }
        [line, rest @ ..] => printed.first() == Some(line) && has_lines(rest, &printed[1..]),
    }
}

/// A line without what depends on the machine.
fn comparable(line: &str) -> String {
    let words: Vec<_> = line.trim_end().split(' ').collect();
    let is_size = |word: &str| {
        let unit = word.trim_end_matches([',', ')']);
        ["bytes", "kB", "MB"].contains(&unit)
    };
    let word = |n: usize| {
        let is_last = n + 2 == words.len();
        let next = words.get(n + 1).copied().unwrap_or_default();
        let is_measured = is_size(next) || is_last && next == "s";
        let digit = words[n].find(|c: char| c.is_ascii_digit());
        match digit.filter(|_| is_measured) {
            Some(digit) => format!("{}#", &words[n][..digit]),
            None => words[n].to_owned(),
        }
    };
    (0..words.len()).map(word).collect::<Vec<_>>().join(" ")
}

#[test]
fn shell_blocks_of_the_pages_run_as_printed() {
    let pages = pages();
    let count = |start: &str| {
        let pages = pages.iter().filter(|page| page.path.starts_with(start));
        let blocks = pages.flat_map(|page| blocks(&page.text));
        blocks.filter(|block| block.no_run.is_none()).count()
    };
    assert!(count("docs/start/") >= 10 && count("docs/command.md") > 0);
    // Two at a time: most of a start is one thread.
    let (left, right) = pages.split_at(pages.len() / 2);
    let run = |pages: &[Page]| pages.iter().flat_map(faults).collect::<Vec<_>>();
    let faults = std::thread::scope(|scope| {
        let left = scope.spawn(|| run(left));
        let mut faults = run(right);
        faults.extend(left.join().expect("no panic"));
        faults
    });
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
}

#[test]
fn a_page_that_teaches_what_fails_is_found() {
    let found = |text: &str| {
        faults(&Page {
            path: "docs/start/wrong.md".into(),
            text: text.into(),
        })
    };
    let none: [String; 0] = [];
    let good = "```sh\nterrella orbit --names\n```\nIt says:\n```text\nISS (ZARYA)…\n…\n```\n";
    assert_eq!(found(&good.replace("ISS (ZARYA)…\n", "")), none);
    assert!(found(good)[0].contains("docs/start/wrong.md:1 prints something else"));
    for wrong in [
        "terrella frame --out a.png",
        "terrella orbit --names --fps 3 | head -1",
        "ls nowhere",
        "ls config",
        "echo $UNKNOWN",
    ] {
        let faults = found(&format!("\n```sh\n{wrong}\ntrue\n```\n"));
        assert!(
            faults.len() == 1 && faults[0].starts_with("docs/start/wrong.md:2 fails"),
            "{wrong}: {faults:?}"
        );
    }
    assert_eq!(found("```sh no-run: opens a window\nfalse\n```\n"), none);
    for marker in ["no-run", "no-run: ", "ignore"] {
        assert_eq!(
            found(&format!("```sh {marker}\nfalse\n```\n")).len(),
            1,
            "{marker}"
        );
    }
}

#[test]
fn printed_lines_are_compared_but_for_sizes_and_times() {
    let line = "a.png: 64 × 36 pixels, 1.5 kB (1500 bytes), 1.8 s";
    assert!(is_printed(
        line,
        "a.png: 64 × 36 pixels, 2.5 kB (2500 bytes), 0.4 s\n"
    ));
    assert!(!is_printed(
        line,
        "a.png: 64 × 37 pixels, 1.5 kB (1500 bytes), 1.8 s"
    ));
    assert!(!is_printed("2.0 s at 24 frames", "3.0 s at 24 frames"));
    assert!(is_printed("a\n…\nd", "a\nb\nc\nd") && is_printed("a\n…", "a"));
    assert!(!is_printed("a\n…\nd", "a\nb\nc") && !is_printed("a", "a\nb"));
}

#[test]
fn a_text_block_belongs_to_the_shell_block_above_it() {
    let text = "```sh\na\n```\nIt prints:\n```text\nb\n```\n```sh no-run: c\nd\n```\n```toml\n```\n```text\ne\n```\n";
    let block = |line, no_run: Option<&str>, script: &str, printed: Option<&str>| Block {
        line,
        no_run: no_run.map(str::to_owned),
        script: script.into(),
        printed: printed.map(str::to_owned),
    };
    let expected = [
        block(1, None, "a", Some("b")),
        block(8, Some("no-run: c"), "d", None),
    ];
    assert_eq!(blocks(text), expected);
}
