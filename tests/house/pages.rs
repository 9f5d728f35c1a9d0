//! Rules for pages of documentation: what they name is there, code in them compiles, and their English is plain.

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

/// Upper limit of the median sentence length of a page, in words.
const MAX_MEDIAN_WORDS: usize = 15;

/// Upper limit of the length of a sentence, in words.
const MAX_SENTENCE_WORDS: usize = 25;

/// Private idioms in lower case, each with the standard wording.
const IDIOMS: [(&str, &str); 20] = [
    ("held against", "compared with"),
    ("held to", "checked against"),
    ("spoilt", "invalid, corrupt"),
    ("refuse", "reject, is an error"),
    ("in vain", "without effect"),
    ("is told", "is reported"),
    ("are told", "are reported"),
    ("told of", "reported"),
    ("turn about", "interleaved"),
    ("by turns", "interleaved"),
    ("in turns", "interleaved"),
    ("ground with relief", "terrain"),
    ("cameras on keys", "camera keyframes"),
    (" anew", "again"),
    ("goes on with", "continues, resumes"),
    ("words that are ours", "project terms"),
    ("of its own accord", "by itself"),
    ("where nothing else is said", "by default"),
    ("if nothing else is said", "by default"),
    ("is passed over", "is skipped"),
];

/// The page's English is measured: it is the first page or one of `docs/` or `config/`, and not generated.
pub fn is_measured(path: &str) -> bool {
    let is_generated = path == "docs/scene-reference.md" || path.starts_with("docs/reference/");
    path == "README.md" || path == "config/README.md" || path.starts_with("docs/") && !is_generated
}

/// Readability faults of the page: long sentences, a high median of their lengths, private idioms.
pub fn hard_to_read(page: &Page) -> Vec<String> {
    let text = without_code(&without_numbers(&page.text));
    let paragraphs = paragraphs(&without_targets(&text));
    let sentences: Vec<_> = paragraphs.iter().flat_map(|one| sentences(one)).collect();
    let mut faults: Vec<_> = sentences
        .iter()
        .filter(|sentence| sentence.len() > MAX_SENTENCE_WORDS)
        .map(|sentence| format!("{} words: {}", sentence.len(), sentence.join(" ")))
        .collect();
    let mut lengths: Vec<_> = sentences.iter().map(Vec::len).collect();
    lengths.sort_unstable();
    let median = lengths.get(lengths.len() / 2).copied().unwrap_or_default();
    if median > MAX_MEDIAN_WORDS {
        faults.push(format!("the median sentence has {median} words"));
    }
    // Tables too; an idiom may go over a line's end.
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let text = text.to_lowercase();
    let found = IDIOMS.iter().filter(|(idiom, _)| text.contains(idiom));
    faults.extend(found.map(|(idiom, plain)| format!("{idiom:?}: write {plain}")));
    let path = &page.path;
    faults
        .iter()
        .map(|fault| format!("{path}: {fault}"))
        .collect()
}

/// The page with one word in place of each number, and a gap in place of each table, that `cargo xtask numbers` writes.
fn without_numbers(text: &str) -> String {
    let mut parts = text.split("<!-- numbers ");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (numbers, after) = part
            .split_once("<!-- end numbers -->")
            .unwrap_or((part, ""));
        let is_table = numbers.contains('\n');
        out.push_str(if is_table { "\n\n" } else { "0" });
        out.push_str(after);
    }
    out
}

/// The page without blocks of code, and with one word in place of each piece of code within a line.
fn without_code(text: &str) -> String {
    let prose: Vec<_> = text.split("```").step_by(2).collect();
    let prose = prose.join("\n\n");
    let prose: Vec<_> = prose.split('`').step_by(2).collect();
    prose.join("code")
}

/// The text with links that lead nowhere.
fn without_targets(text: &str) -> String {
    let mut parts = text.split("](");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        out.push(']');
        out.push_str(part.split_once(')').map_or(part, |(_, after)| after));
    }
    out
}

/// Paragraphs and items of lists; headings, tables, images and HTML are excluded.
fn paragraphs(text: &str) -> Vec<String> {
    let mut paragraphs = vec![String::new()];
    for line in text.lines().map(str::trim) {
        let is_other = line.starts_with(['|', '#', '!', '<']);
        let (marker, rest) = line.split_once(' ').unwrap_or((line, ""));
        let is_number = |digits: &str| digits.parse::<u32>().is_ok();
        let is_item = marker == "-" || marker.strip_suffix('.').is_some_and(is_number);
        if line.is_empty() || is_other || is_item {
            paragraphs.push(String::new());
        }
        if let Some(paragraph) = paragraphs.last_mut().filter(|_| !is_other) {
            paragraph.push_str(if is_item { rest } else { line });
            paragraph.push(' ');
        }
    }
    paragraphs
}

/// The words of each sentence of a paragraph.
fn sentences(paragraph: &str) -> Vec<Vec<&str>> {
    let ends = |word: &&str| {
        word.trim_end_matches(['"', '*', ')'])
            .ends_with(['.', '?', '!'])
    };
    let words: Vec<_> = paragraph.split_whitespace().collect();
    let is_word = |word: &&str| word.chars().any(char::is_alphanumeric);
    let sentences = words.split_inclusive(|word| ends(word));
    let sentences =
        sentences.map(|words| words.iter().copied().filter(is_word).collect::<Vec<_>>());
    sentences.filter(|words| !words.is_empty()).collect()
}

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

/// Lines of Rust on the page that no example has: the lines of each block must occur in one of the examples, in the same order. The examples are
/// compiled and run, so such lines cannot become stale.
pub fn lines_of_no_example(page: &Page, examples: &[String]) -> Vec<String> {
    let blocks = page.text.split("```rust").skip(1);
    let blocks = blocks.filter_map(|rest| rest.split_once('\n')?.1.split("```").next());
    blocks
        .filter_map(|block| {
            let furthest = examples
                .iter()
                .map(|example| first_line_not_in(block, example));
            // For the example that has most of the block.
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
    fn long_sentences_are_found() {
        let found = |text: &str| hard_to_read(&page(text));
        let words = |count: usize| format!("{}end.", "word ".repeat(count - 1));
        let short = words(5) + " " + &words(6) + " ";
        assert_eq!(found(&(short.clone() + &words(25))), [""; 0]);
        let faults = found(&(short.clone() + &words(26)));
        assert!(
            faults.len() == 1 && faults[0].contains("26 words"),
            "{faults:?}"
        );
        // Over two lines, and with code, a link and a number as one word each.
        let line = "word ".repeat(11);
        let long = |link| {
            format!(
                "{short}word {line}\n{line}`a. b` {link} <!-- numbers n -->1. 2<!-- end numbers -->."
            )
        };
        assert_eq!(found(&long("[x](y z)")).len(), 1);
        assert_eq!(found(&long("")), [""; 0]);
        // Not prose.
        for other in ["| ", "## ", "```sh\n", "<!-- numbers n -->\n"] {
            let end = if other.starts_with('<') {
                "\n<!-- end numbers -->"
            } else {
                ""
            };
            assert_eq!(
                found(&format!("{short}\n{other}{}{end}", words(26))),
                [""; 0]
            );
        }
        let list = format!(
            "- {}\n- {}\n12. {}",
            "word ".repeat(15),
            "word ".repeat(15),
            "word ".repeat(15)
        );
        assert_eq!(found(&list), [""; 0]);
    }

    #[test]
    fn a_high_median_is_found() {
        let found = |text: &str| hard_to_read(&page(text));
        let sentence = |count: usize| format!("{}end. ", "word ".repeat(count - 1));
        assert_eq!(
            found(&(sentence(24) + &sentence(15) + &sentence(3))),
            [""; 0]
        );
        let faults = found(&(sentence(24) + &sentence(16) + &sentence(3)));
        assert!(
            faults.len() == 1 && faults[0].contains("16 words"),
            "{faults:?}"
        );
    }

    #[test]
    fn private_idioms_are_found() {
        let count = |text| hard_to_read(&page(text)).len();
        assert_eq!(
            count("It rejects the file, compared with `refused` ones."),
            0
        );
        assert_eq!(
            count("```\nrefused\n```\n<!-- numbers n -->spoilt<!-- end numbers -->"),
            0
        );
        assert_eq!(count("It Refuses the file."), 1);
        assert_eq!(count("| held\nagainst |"), 1);
        for other in [
            "docs/scene-reference.md",
            "docs/reference/command.md",
            "CHANGELOG.md",
        ] {
            assert!(!is_measured(other), "{other}");
        }
        assert!(is_measured("docs/embedding/c.md") && is_measured("README.md"));
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
