//! No number that both sides use is written twice.

use super::{Shader, sampled_shaders};
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::{Path, PathBuf};
use terrella::internals::gpu::SHADER_FILES;

/// Folders of code that feeds shaders.
const FEEDING: [&str; 7] = [
    "crates/terrella-frames/src",
    "crates/terrella-ground/src/globe",
    "crates/terrella-ground/src/air",
    "src/plan",
    "src/gpu",
    "src/earth",
    "src/tracks",
];

/// The files of a module: those in its folder, and the file of its name beside it.
fn module_files(module: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(module);
    let own = folder.with_extension("rs");
    let mut files = Vec::from_iter(own.is_file().then_some(own));
    rust_files(&folder, &mut files);
    files
}

fn rust_files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, out);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            out.push(path);
        }
    }
}

/// Names that lines of this text declare as constants.
fn constants(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter_map(|line| {
        let line = line.trim_start();
        let line = line
            .split_once(") ")
            .filter(|_| line.starts_with("@if("))
            .map_or(line, |(_, rest)| rest);
        let line = line.strip_prefix("pub ").unwrap_or(line);
        let line = line
            .strip_prefix("pub(crate) ")
            .or(line.strip_prefix("pub(super) "))
            .unwrap_or(line);
        let name = line.strip_prefix("const ")?.split([':', ' ', '=']).next()?;
        name.chars()
            .all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_')
            .then_some(name)
    })
}

/// A constant of a shader must not have the name of one in the code that feeds shaders: it would be written twice. (The reference renderer and the
/// arithmetic of `measure` are oracles: they share nothing on purpose.)
#[test]
fn no_constant_of_a_shader_stands_in_rust_too() {
    let mut in_rust: BTreeMap<String, PathBuf> = BTreeMap::new();
    for folder in FEEDING.into_iter().chain(["crates/terrella-imagery/src"]) {
        for file in module_files(folder) {
            let text = std::fs::read_to_string(&file).unwrap();
            for name in constants(&text) {
                in_rust.insert(name.to_owned(), file.clone());
            }
        }
    }
    assert!(in_rust.contains_key("WHOLE_MAP") && in_rust.contains_key("BLOCK_COUNT"));
    let mut found = 0;
    for (file, text) in SHADER_FILES {
        for name in constants(text) {
            found += 1;
            let twin = in_rust.get(name);
            assert!(
                twin.is_none(),
                "{name} stands in shaders/{file} and in {twin:?}"
            );
        }
    }
    assert!(found > 5, "{found} constants found in shaders");
}

/// The digits of a number, without point, exponent and zeros around: 0.0031308 and 3.1308e-3 are the same.
fn digits(number: &str) -> String {
    let number = number.split(['e', 'E']).next().unwrap_or_default();
    let digits: String = number.chars().filter(char::is_ascii_digit).collect();
    digits.trim_matches('0').to_owned()
}

fn numbers(text: &str) -> BTreeSet<String> {
    let code = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    code.flat_map(|line| {
        line.split(|c: char| !(c.is_ascii_alphanumeric() || matches!(c, '.' | '_')))
            .filter(|word| {
                word.starts_with(|c: char| c.is_ascii_digit()) && !word.starts_with("0x")
            })
            .map(|word| digits(&word.replace('_', "")))
            .collect::<Vec<_>>()
    })
    .filter(|digits| digits.len() >= 3)
    .collect()
}

/// By value: a number with three digits or more in a shader is not written in the Rust code that feeds it.
#[test]
fn no_number_of_a_shader_stands_in_rust_too() {
    // Formulas of standards, written out on both sides where they are computed: sRGB's curve; the air's phase functions and
    // sizes of GPU types have fewer digits.
    const STANDARDS: [&str; 4] = ["1055", "1292", "31308", "4045"];
    let mut in_rust: BTreeMap<String, PathBuf> = BTreeMap::new();
    for folder in FEEDING {
        for file in module_files(folder) {
            let text = std::fs::read_to_string(&file).unwrap();
            let product = text.split("#[cfg(test)]").next().unwrap_or_default();
            // Tests; weights of a fit and terms of a theory, which have more digits than a name.
            let name = file.file_name().map(|name| name.to_string_lossy());
            let is_other = |name: &str| name.ends_with("tests.rs") || name == "spectrum.rs";
            if name.as_deref().is_some_and(is_other)
                || file
                    .components()
                    .any(|c| c.as_os_str() == "tests" || c.as_os_str() == "series")
            {
                continue;
            }
            in_rust.extend(
                numbers(product)
                    .into_iter()
                    .map(|number| (number, file.clone())),
            );
        }
    }
    assert!(in_rust.contains_key("2126"), "luminance weights are found");
    let mut twice = Vec::new();
    // The craft is a host's own drawable: nothing of these folders feeds it.
    let fed = SHADER_FILES
        .iter()
        .filter(|(file, _)| *file != "craft.wgsl");
    for (file, text) in fed {
        for number in numbers(text) {
            if let Some(twin) = in_rust
                .get(&number)
                .filter(|_| !STANDARDS.contains(&number.as_str()))
            {
                twice.push(format!(
                    "{number} stands in shaders/{file} and in {}",
                    twin.display()
                ));
            }
        }
    }
    super::hold(&twice);
}

/// Imported constants are used, and so are those of a shader itself.
#[test]
fn every_constant_is_used_where_it_is_declared() {
    for shader in sampled_shaders() {
        let unused: Vec<_> = unused_in(shader).collect();
        assert!(
            unused.is_empty(),
            "{} declares {unused:?} and does not use them",
            shader.name
        );
    }
}

/// Constants that a shader declares and does not use.
pub fn unused_in(shader: &Shader) -> impl Iterator<Item = &str> {
    let is_of_a_word = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
    let text = &shader.text.text;
    // Once for all names: there are thousands of variants.
    let (mut once, mut again) = (HashSet::new(), HashSet::new());
    for word in text.as_bytes().split(|byte| !is_of_a_word(*byte)) {
        if !once.insert(word) {
            again.insert(word);
        }
    }
    constants(text).filter(move |name| !again.contains(name.as_bytes()))
}
