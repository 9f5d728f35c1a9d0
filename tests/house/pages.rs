//! Rules for pages of documentation: what they name is there, and code in them compiles.

use crate::repository::{Page, Repository};

/// Folders whose paths are checked where a page names them.
const FOLDERS: [&str; 10] = [
    "src/",
    "crates/",
    "xtask/",
    "shaders/",
    "tests/",
    "docs/",
    "examples/",
    "fuzz/",
    "config/",
    "benches/",
];

/// Files and folders of the repository that the page names in code type, as `src/lib.rs`, and that are not there.
pub fn missing_paths(page: &Page, repository: &Repository) -> Vec<String> {
    let is_path = |span: &&str| {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
        FOLDERS.iter().any(|folder| span.starts_with(folder)) && span.chars().all(is_plain)
    };
    let spans = page.text.split('`').skip(1).step_by(2);
    spans
        .filter(is_path)
        .filter(|path| !repository.exists(path))
        .map(|path| format!("{}: {path} is not there", page.path))
        .collect()
}

/// Lines of Rust on the page that no example has: the lines of each block must stand in one of the examples, in the same order.
/// The examples are compiled and run, so such lines cannot rot.
pub fn lines_of_no_example(page: &Page, examples: &[String]) -> Vec<String> {
    let blocks = page.text.split("```rust").skip(1);
    let blocks = blocks.filter_map(|rest| rest.split_once('\n')?.1.split("```").next());
    blocks
        .filter_map(|block| {
            let furthest = examples
                .iter()
                .map(|example| first_line_not_in(block, example));
            // Of the example that has most of the block.
            let missing = furthest.min_by_key(|missing| missing.map_or(0, |(left, _)| left))??;
            Some(format!("{}: no example has {:?}", page.path, missing.1))
        })
        .collect()
}

/// The first line of a block that does not follow in the example, and how many lines are left there; indents aside.
fn first_line_not_in<'b>(block: &'b str, example: &str) -> Option<(usize, &'b str)> {
    let lines = |text: &'b str| text.lines().map(str::trim).filter(|line| !line.is_empty());
    let mut example = example.lines().map(str::trim);
    let mut left = lines(block).count();
    for line in lines(block) {
        if !example.any(|other| other == line) {
            return Some((left, line));
        }
        left -= 1;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(text: &str) -> Page {
        Page {
            path: "README.md".into(),
            text: text.into(),
        }
    }

    #[test]
    fn paths_in_code_type_must_be_there() {
        let count = |text| missing_paths(&page(text), &Repository::open()).len();
        assert_eq!(
            count("`src/lib.rs` src/gone.rs `src/a b` `cargo` `src/`"),
            0
        );
        assert_eq!(count("`src/gone.rs` and `shaders/gone/`"), 2);
    }

    #[test]
    fn code_must_stand_in_an_example() {
        let examples = [
            "fn a() {}\n  let b = 1;\nc(b);".to_owned(),
            "d();".to_owned(),
        ];
        let found = |text| lines_of_no_example(&page(text), &examples);
        assert_eq!(
            found("```sh\nls\n```\n```rust\nfn a() {}\n\nc(b);\n```"),
            [""; 0]
        );
        assert_eq!(found("```rust\nd();\n```\n```rust\nc(b);\n```"), [""; 0]);
        assert!(found("```rust\nfn a() {}\ne();\n```")[0].contains("e();"));
        // In another order, or from two examples.
        assert_eq!(found("```rust\nc(b);\nfn a() {}\n```").len(), 1);
        assert_eq!(found("```rust\nd();\nc(b);\n```").len(), 1);
    }
}
