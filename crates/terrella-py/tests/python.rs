//! Runs the tests in Python with pytest on this package, by the machine's `python3` or that of TERRELLA_PYTHON. Without Python 3.10, numpy and
//! pytest they are skipped with a message.

#[path = "../../../tests/common/small_maps.rs"]
mod small_maps;

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The package with the module that cargo has just built.
fn lay_out(folder: &Path, package: &Path) {
    let this = std::env::current_exe().expect("this program");
    let built = this
        .parent()
        .expect("a folder")
        .join("libterrella_native.so");
    assert!(built.is_file(), "no {}", built.display());
    let sources = folder.join("python/terrella");
    for (from, to) in [
        (sources.clone(), package.to_owned()),
        (sources.join("farm"), package.join("farm")),
    ] {
        fs::create_dir_all(&to).expect("made");
        for file in fs::read_dir(&from).expect("the package").flatten() {
            if file.path().is_file() {
                fs::copy(file.path(), to.join(file.file_name())).expect("copied");
            }
        }
    }
    fs::copy(built, package.join("_native.abi3.so")).expect("copied");
    let maps = package.join("textures");
    fs::create_dir_all(&maps).expect("made");
    for file in fs::read_dir(sources.join("textures"))
        .expect("maps")
        .flatten()
    {
        fs::copy(file.path(), maps.join(file.file_name())).expect("a map, or a link to one");
    }
}

#[test]
#[cfg_attr(
    not(target_os = "linux"),
    ignore = "the module is looked for as Linux names it"
)]
fn the_package_passes_its_tests() {
    let wanted = "import sys, numpy, pytest; sys.exit(sys.version_info < (3, 10))";
    let is_ready = |python: &OsString| {
        let output = Command::new(python).args(["-c", wanted]).output();
        output.is_ok_and(|output| output.status.success())
    };
    let chosen = std::env::var_os("TERRELLA_PYTHON").map(|python| vec![python]);
    let pythons = chosen.unwrap_or_else(|| vec!["python3".into(), "/usr/bin/python3".into()]);
    let Some(python) = pythons.into_iter().find(is_ready) else {
        eprintln!(
            "SKIPPED: there is no Python 3.10 or later with numpy and pytest; `cargo xtask prepare` installs them where it can"
        );
        return;
    };
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let out = tempfile::tempdir().expect("a folder");
    lay_out(&folder, &out.path().join("terrella"));
    let mut command = Command::new(&python);
    // Beside which films and packs of many workers are held. Cargo builds it with the tests of the whole workspace.
    let this = std::env::current_exe().expect("this program");
    if let Some(program) = this.ancestors().nth(2).map(|debug| debug.join("terrella"))
        && program.is_file()
    {
        command.env("TERRELLA_COMMAND", program);
    }
    // The caller's packages after it.
    let found = std::env::var_os("PYTHONPATH").unwrap_or_default();
    let folders = std::iter::once(out.path().to_owned())
        .chain(std::env::split_paths(&found).filter(|folder| !folder.as_os_str().is_empty()));
    let search = std::env::join_paths(folders).expect("paths without colons");
    let status = command
        .args(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider"])
        .arg(folder.join("tests"))
        .current_dir(out.path())
        .env("PYTHONPATH", search)
        .env("TERRELLA_TEXTURES", small_maps::folder())
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .status();
    assert!(
        status.expect("python runs").success(),
        "pytest found failures"
    );
}
