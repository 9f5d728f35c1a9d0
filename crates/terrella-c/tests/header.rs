//! `include/terrella.h` matches the output of cbindgen and names the version. `docs/reference/c.md` matches the header, and
//! `docs/reference/truth.md` the truth layers.

use std::ffi::CStr;
use std::fmt::Write;
use std::path::Path;
use terrella::TRUTH_LAYERS;
use terrella_c::{
    TERRELLA_VERSION_MAJOR, TERRELLA_VERSION_MINOR, TERRELLA_VERSION_PATCH, terrella_version,
};

#[test]
fn the_version_is_that_of_the_package() {
    let parts = [
        TERRELLA_VERSION_MAJOR,
        TERRELLA_VERSION_MINOR,
        TERRELLA_VERSION_PATCH,
    ];
    let text = parts.map(|part| part.to_string()).join(".");
    assert_eq!(text, env!("CARGO_PKG_VERSION"));
    // SAFETY: the function returns a text that ends with a zero byte and lives as long as the library.
    let loaded = unsafe { CStr::from_ptr(terrella_version()) };
    assert_eq!(loaded.to_str(), Ok(text.as_str()));
    // Before 1.0 a minor version may change interfaces.
    let series = match TERRELLA_VERSION_MAJOR {
        0 => format!("0.{TERRELLA_VERSION_MINOR}"),
        major => major.to_string(),
    };
    let soname = format!("libterrella_c.so.{series}");
    assert_eq!(soname, env!("TERRELLA_SONAME"));
    for path in ["cmake/terrella-config.cmake.in", "../../xtask/src/faces.rs"] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
        let file = std::fs::read_to_string(file).expect("there");
        assert!(file.contains(&format!("\"{soname}\"")), "{path}: {soname}");
    }
}

#[test]
fn the_header_is_that_of_the_sources() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).expect("cbindgen.toml");
    let made = cbindgen::Builder::new()
        .with_config(config)
        .with_crate(folder)
        .generate()
        .expect("the sources are read");
    let mut text = Vec::new();
    made.write(&mut text);
    let text = String::from_utf8(text).expect("UTF-8");
    is_committed("include/terrella.h", &text);
    is_committed("../../docs/reference/c.md", &reference(&text));
    is_committed("../../docs/reference/truth.md", &truth_layers());
}

/// Asserts that a file of the repository equals the generated text, or writes the file if the environment requests it.
#[track_caller]
fn is_committed(path: &str, made: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("TERRELLA_UPDATE_HEADER").is_some() {
        std::fs::write(&path, made).expect("written");
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == made,
        "{} is not what is made of the sources; run `TERRELLA_UPDATE_HEADER=1 cargo test -p terrella-c --test header`",
        path.display()
    );
}

/// A declaration of the header with the comment above it.
struct Declaration {
    name: String,
    comment: Vec<String>,
    lines: Vec<String>,
}

/// The declarations of a header, in order.
fn declarations(header: &str) -> Vec<Declaration> {
    let mut found = Vec::new();
    let (mut comment, mut lines): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
    for line in header.lines() {
        if lines.is_empty() {
            if let Some(words) = line.strip_prefix("//") {
                comment.push(words.strip_prefix(' ').unwrap_or(words).to_owned());
                continue;
            }
            // Include guards have no comment; a blank line ends the comment of the file.
            if line.trim().is_empty() || comment.is_empty() {
                comment.clear();
                continue;
            }
        }
        lines.push(line.to_owned());
        let is_inside = lines[0].ends_with('{') && !line.starts_with('}');
        if line.starts_with("#define") || line.ends_with(';') && !is_inside {
            found.push(Declaration {
                name: name(&lines),
                comment: std::mem::take(&mut comment),
                lines: std::mem::take(&mut lines),
            });
        }
    }
    found
}

/// The declared name.
fn name(lines: &[String]) -> String {
    let (first, last) = (&lines[0], &lines[lines.len() - 1]);
    let declared = if let Some(constant) = first.strip_prefix("#define ") {
        constant.split(' ').next()
    } else if first.starts_with("typedef") {
        last.trim_end_matches(';').rsplit([' ', '}']).next()
    } else {
        let called = first.split('(').next().unwrap_or_default();
        called.rsplit([' ', '*']).next()
    };
    declared.unwrap_or_default().to_owned()
}

/// The page of the header: functions, types and constants, each with its comment.
fn reference(header: &str) -> String {
    let mut page = String::from(
        "# C reference\n\n\
         Generated from `crates/terrella-c/include/terrella.h`; do not edit. [Terrella from C and C++](../embedding/c.md) explains how to use it.\n",
    );
    let all = declarations(header);
    let is_function = |one: &&Declaration| one.name.starts_with("terrella_");
    let is_constant = |one: &&Declaration| one.lines[0].starts_with("#define");
    let is_type = |one: &&Declaration| !is_function(one) && !is_constant(one);
    let functions: Vec<_> = all.iter().filter(is_function).collect();
    let types: Vec<_> = all.iter().filter(is_type).collect();
    let constants: Vec<_> = all.iter().filter(is_constant).collect();
    for (title, declarations) in [
        ("Functions", functions),
        ("Types", types),
        ("Constants", constants),
    ] {
        let _ = write!(page, "\n## {title}\n");
        for one in declarations {
            let comment = one
                .comment
                .join("\n")
                .replace("\n# Safety\n", "\nSafety:\n");
            let lines = one.lines.join("\n");
            let name = &one.name;
            let _ = write!(page, "\n### {name}\n\n{comment}\n\n```text\n{lines}\n```\n");
        }
    }
    page
}

/// The page of the truth layers.
fn truth_layers() -> String {
    let mut page = String::from(
        "# Truth layers\n\n\
         Generated from their declarations; do not edit. [Truth layers](../truth.md) explains how they are computed and how accurate they are.\n\n\
         | layer | numbers per pixel | type | unit | meaning |\n|---|---|---|---|---|\n",
    );
    for layer in TRUTH_LAYERS {
        let (name, unit, what) = (layer.name, layer.unit, layer.what);
        let (count, dtype) = (layer.components(), layer.dtype.name());
        let _ = writeln!(page, "| `{name}` | {count} | `{dtype}` | {unit} | {what} |");
    }
    page
}

#[test]
fn declarations_of_a_header_are_distinguished() {
    let header = "// The file.\n\n#ifndef A\n#include <b.h>\n\n// One.\n// More.\n#define ONE 1\n\n// A thing.\ntypedef struct {\n  // Its part.\n  int part;\n\n  int other;\n} Thing;\n\n// Opaque.\ntypedef struct Hidden Hidden;\n\n#ifdef __cplusplus\n#endif\n// Gives.\nconst char *terrella_give(int a,\n    int b);\n";
    let found = declarations(header);
    let names: Vec<_> = found.iter().map(|one| one.name.as_str()).collect();
    assert_eq!(names, ["ONE", "Thing", "Hidden", "terrella_give"]);
    assert_eq!(found[0].comment, ["One.", "More."]);
    assert_eq!(found[1].lines.len(), 6);
    assert_eq!(found[3].lines.len(), 2);
    let page = reference(header);
    assert!(page.contains("### terrella_give\n\nGives.\n"), "{page}");
    let place = |text: &str| page.find(text).expect("on the page");
    assert!(place("## Functions") < place("### terrella_give"));
    assert!(place("### terrella_give") < place("### Hidden"));
    assert!(place("### Hidden") < place("### ONE"));
}
