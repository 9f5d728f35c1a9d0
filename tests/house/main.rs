//! The house rules, compared with the repository's own files.
//!
//! Rules that clippy can check are checked by clippy (`[workspace.lints]`); this checks the others.

mod circles;
mod licences;
mod modules;
mod packages;
mod pages;
mod platforms;
mod repository;
mod rules;
mod source;

use repository::{Page, Repository};
use rules::Rule;

/// Fails with one line for each violation.
#[track_caller]
fn none(violations: Vec<String>) {
    assert!(
        violations.is_empty(),
        "{} violations:\n  {}\n",
        violations.len(),
        violations.join("\n  ")
    );
}

/// Applies a rule to every source file of `src/` and of the packages for other languages.
#[track_caller]
fn holds_in_products(rule: Rule) {
    holds_in(&["src", "crates"], rule);
}

/// The sources of all crates in the table of modules.
fn sources(repository: &Repository) -> Vec<source::File> {
    let files = modules::folders().map(|folder| repository.rust_files(folder));
    files.flatten().collect()
}

#[track_caller]
fn holds_in(folders: &[&str], rule: Rule) {
    let repository = Repository::open();
    let files = folders.iter().map(|folder| repository.rust_files(folder));
    let files: Vec<_> = files.flatten().collect();
    assert!(!files.is_empty(), "no source file was found");
    none(files.iter().flat_map(rule).collect());
}

#[test]
fn modules_use_only_modules_before_them() {
    let repository = Repository::open();
    let exports = modules::exports(&repository.rust_file("src/lib.rs"));
    assert!(!exports.is_empty(), "src/lib.rs exports nothing");
    let files = sources(&repository);
    none(
        files
            .iter()
            .flat_map(|file| modules::violations(file, &exports))
            .collect(),
    );
}

#[test]
fn modules_are_allowed_only_what_they_use() {
    let repository = Repository::open();
    let exports = modules::exports(&repository.rust_file("src/lib.rs"));
    none(modules::unused(&sources(&repository), &exports));
}

#[test]
fn the_printed_table_of_modules_is_the_enforced_one() {
    let repository = Repository::open();
    let pages = ["src/lib.rs", "docs/architecture.md"];
    let pages = pages.map(|path| (path, repository.text_if_there(path).unwrap_or_default()));
    none(modules::unlike_the_table(&pages));
}

#[test]
fn no_files_use_each_other_in_a_circle() {
    let repository = Repository::open();
    // Cargo allows no circles between crates.
    let others = [
        "crates/bevy_terrella/src",
        "crates/terrella-c/src",
        "crates/terrella-py/src",
    ];
    for folder in modules::folders().chain(others) {
        let files = repository.rust_files(folder);
        assert!(!files.is_empty(), "{folder} holds no source file");
        none(circles::violations(&files, folder));
    }
}

#[test]
fn modules_without_a_gpu_do_not_name_it() {
    holds_in_products(rules::names_no_gpu);
}

#[test]
fn gpu_objects_are_labelled() {
    holds_in_products(rules::labels_gpu_objects);
}

#[test]
fn what_pages_are_built_of_runs_in_them() {
    holds_in(platforms::FOLDERS, platforms::runs_in_pages);
    let repository = Repository::open();
    for path in platforms::KNOWING {
        assert!(
            repository.exists(path),
            "{path}, which the rule lets through, is gone"
        );
    }
}

#[test]
fn files_named_mod_list_modules() {
    holds_in(&["src", "crates", "tests", "xtask"], rules::lists_modules);
}

#[test]
fn files_are_opened_in_one_place() {
    holds_in_products(rules::opens_files_in_one_place);
}

#[test]
fn one_file_asks_servers() {
    holds_in_products(rules::asks_no_server);
    let files = sources(&Repository::open());
    let asking = files
        .iter()
        .filter(|file| !file.find(&["ureq", ":", ":"]).is_empty());
    assert_eq!(
        asking.count(),
        1,
        "the file that the rule lets through is gone"
    );
}

#[test]
fn nothing_is_left_unfinished() {
    holds_in_products(rules::leaves_nothing_unfinished);
}

#[test]
fn errors_of_the_library_are_typed() {
    holds_in_products(rules::keeps_anyhow_in_the_command);
}

#[test]
fn nothing_is_unwrapped() {
    holds_in_products(rules::unwraps_nothing);
}

#[test]
fn files_are_short() {
    let repository = Repository::open();
    let mut files = repository.rust_files("src");
    files.extend(repository.rust_files("xtask/src"));
    files.extend(repository.rust_files("crates"));
    none(files.iter().flat_map(rules::is_short).collect());
}

#[test]
fn every_scene_is_presented() {
    let repository = Repository::open();
    let scenes = repository.file_names("config", "toml");
    let pages = [
        repository.text("README.md"),
        repository
            .text_if_there("config/README.md")
            .unwrap_or_default(),
    ];
    none(rules::unpresented(&scenes, &pages));
}

#[test]
fn links_in_the_pages_lead_somewhere() {
    let repository = Repository::open();
    none(
        repository
            .pages()
            .iter()
            .flat_map(|page| rules::dead_links(page, &repository))
            .collect(),
    );
}

#[test]
fn tracked_files_are_small() {
    let Some(sizes) = Repository::open().tracked_sizes() else {
        eprintln!(
            "SKIPPED: sizes of tracked files were not checked, because this is no git checkout"
        );
        return;
    };
    none(rules::too_large(&sizes));
}

#[test]
fn terms_of_dependencies_are_reported() {
    let repository = Repository::open();
    none(licences::faults(
        &repository.text("deny.toml"),
        &repository.text("Cargo.lock"),
        &repository.text("THIRD-PARTY.md"),
    ));
}

#[test]
fn what_pages_name_is_there() {
    let repository = Repository::open();
    let pages = repository.pages();
    // The list of changes names removed items.
    let pages = pages.iter().filter(|page| page.path != "CHANGELOG.md");
    none(
        pages
            .flat_map(|page| pages::missing_paths(page, &repository))
            .collect(),
    );
}

#[test]
fn pages_are_in_plain_english() {
    let pages = Repository::open().pages();
    let measured = pages.iter().filter(|page| pages::is_measured(&page.path));
    let measured: Vec<_> = measured.collect();
    assert!(measured.len() > 20, "{} pages are measured", measured.len());
    none(measured.into_iter().flat_map(pages::hard_to_read).collect());
}

#[test]
fn code_in_the_readme_is_that_of_an_example() {
    let repository = Repository::open();
    let examples: Vec<_> = repository
        .file_names("examples", "rs")
        .iter()
        .map(|name| repository.text(&format!("examples/{name}")))
        .collect();
    let pages = repository.pages();
    let readme = pages.iter().filter(|page| page.path == "README.md");
    none(
        readme
            .flat_map(|page| pages::lines_of_no_example(page, &examples))
            .collect(),
    );
}

/// So that it compiles as it is printed.
#[test]
fn the_host_in_the_tutorial_is_a_whole_example() {
    let repository = Repository::open();
    let page = repository.text("docs/start/own-renderer.md");
    let printed = page.split("```rust\n").nth(1);
    let printed = printed.and_then(|rest| rest.split("```").next());
    let example = repository.text("examples/minimal.rs");
    let is_header = |line: &&str| line.starts_with("//!") || line.is_empty();
    let code: Vec<_> = example.lines().skip_while(is_header).collect();
    assert!(
        printed.is_some_and(|text| text.lines().eq(code.iter().copied())),
        "docs/start/own-renderer.md does not print examples/minimal.rs"
    );
}

#[test]
fn pages_install_our_own_distribution() {
    let repository = Repository::open();
    let distribution = repository.text("pyproject.toml");
    let distribution = packages::string(&distribution, "project", "name");
    assert_ne!(distribution, "terrella", "another project has that name");
    let mut pages = repository.pages();
    pages.extend(repository.texts("crates/terrella-py/python", "py"));
    none(
        pages
            .iter()
            .flat_map(|page| packages::other_distributions(page, distribution))
            .collect(),
    );
}

#[test]
fn one_address_of_the_source_is_given() {
    let repository = Repository::open();
    let manifest = repository.text("Cargo.toml");
    let address = packages::string(&manifest, "workspace.package", "repository");
    let mut pages = repository.pages();
    for file in [
        "Cargo.toml",
        "pyproject.toml",
        "CITATION.cff",
        ".github/ISSUE_TEMPLATE/config.yml",
    ] {
        pages.extend(repository.text_if_there(file).map(|text| Page {
            path: file.into(),
            text,
        }));
    }
    none(
        pages
            .iter()
            .flat_map(|page| packages::other_sources(page, address, &repository))
            .collect(),
    );
}

#[test]
fn citations_name_the_version() {
    let repository = Repository::open();
    let manifest = repository.text("Cargo.toml");
    let version = packages::string(&manifest, "workspace.package", "version");
    let citation = repository.text("CITATION.cff");
    assert!(citation.contains(&format!("\nversion: {version}\n")));
}

/// crates.io makes links of a package's page lead to the source, PyPI does not.
#[test]
fn pages_of_registries_show_their_pictures() {
    let repository = Repository::open();
    let manifest = repository.text("Cargo.toml");
    assert_eq!(
        packages::value(&manifest, "package", "repository.workspace"),
        Some("true")
    );
    let address = packages::string(&manifest, "workspace.package", "repository");
    assert!(address.starts_with("https://github.com/") && !address.ends_with('/'));
    let project = repository.text("pyproject.toml");
    assert_eq!(
        packages::string(&project, "project", "readme"),
        packages::PYPI_PAGE
    );
    let page = repository.text(packages::PYPI_PAGE);
    let relative = rules::targets(&page)
        .into_iter()
        .filter(|target| !target.starts_with("https://"));
    none(relative.map(str::to_owned).collect());
}

/// A crate's package has only the files in its folder.
#[test]
fn the_built_in_elements_are_the_shipped_ones() {
    let repository = Repository::open();
    let built_in = repository.text("crates/terrella-orbit/data/iss.tle");
    assert_eq!(built_in, repository.text("config/orbits/iss.tle"));
}

#[test]
fn docs_rs_documents_every_feature() {
    none(packages::undocumented_features(
        &Repository::open().text("Cargo.toml"),
    ));
}

#[test]
fn the_first_page_says_how_to_have_the_command() {
    let repository = Repository::open();
    let manifest = repository.text("Cargo.toml");
    let rust = packages::string(&manifest, "workspace.package", "rust-version");
    let first = repository.text("README.md");
    for (page, reported) in [
        ("README.md", format!("Rust {rust} or later")),
        ("docs/embedding/python.md", format!("Rust {rust} or later")),
        ("docs/embedding/bevy.md", format!("is built by {rust} too")),
    ] {
        assert!(
            repository.text(page).contains(&reported),
            "{page}: {reported}"
        );
    }
    let install = first.find("cargo install --path crates/terrella-cli --locked");
    let used = first.find("\nterrella ");
    assert!(install.is_some() && used.is_some() && install < used);
    assert!(first.contains("~/.cargo/bin") && first.contains("PATH"));
}
