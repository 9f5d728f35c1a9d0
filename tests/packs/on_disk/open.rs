//! Opening valid and invalid packs.

use super::fixture::{Fixture, write};
use std::path::Path;
use terrella_imagery::pack::{JOURNAL_FILE, MANIFEST_FILE, MAX_MANIFEST_BYTES, Pack, PackError};

fn rejected(dir: &Path) -> PackError {
    Pack::open(dir).expect_err("no good pack")
}

#[test]
fn a_pack_is_opened() {
    let fixture = Fixture::day();
    let pack = fixture.open();
    assert_eq!(pack.manifest(), &fixture.manifest);
    assert_eq!(pack.dir(), fixture.dir());
    // A journal that was left behind does no harm once there is a manifest.
    write(&fixture.dir().join(JOURNAL_FILE), b"");
    assert!(Pack::open(fixture.dir()).is_ok());
}

#[test]
fn what_is_no_pack_is_distinguished() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let dir = folder.path();
    let error = rejected(&dir.join("nowhere"));
    assert!(matches!(error, PackError::Missing { .. }), "{error}");
    assert!(
        error
            .to_string()
            .contains("nowhere: there is no such folder")
    );

    let file = dir.join("file");
    write(&file, b"");
    let error = rejected(&file);
    assert!(matches!(error, PackError::NotAFolder { .. }), "{error}");

    let error = rejected(dir);
    assert!(matches!(error, PackError::NoManifest { .. }), "{error}");

    write(&dir.join(JOURNAL_FILE), b"");
    let error = rejected(dir);
    assert!(matches!(error, PackError::Unfinished { .. }), "{error}");
    assert!(
        error
            .to_string()
            .contains("run the same `terrella pack build` again")
    );
}

#[test]
fn manifests_that_are_no_text_are_rejected() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let manifest = folder.path().join(MANIFEST_FILE);
    write(&manifest, b"format = 1\nname = \"\xff\"\n");
    let error = rejected(folder.path());
    assert!(
        matches!(error, PackError::NotUtf8 { line: 2, .. }),
        "{error}"
    );
    assert_eq!((error.path(), error.line()), (manifest.as_path(), Some(2)));

    let file = std::fs::File::create(&manifest).expect("made");
    file.set_len(MAX_MANIFEST_BYTES + 1)
        .expect("a long file of nothing");
    let error = rejected(folder.path());
    assert!(matches!(error, PackError::TooLarge { .. }), "{error}");

    std::fs::remove_file(&manifest).expect("removed");
    std::fs::create_dir(&manifest).expect("made");
    let error = rejected(folder.path());
    assert!(
        error
            .to_string()
            .contains("pack.toml: cannot be read: it is a folder, not a file"),
        "{error}"
    );

    std::fs::remove_dir(&manifest).expect("removed");
    write(&manifest, b"format = 1\nname = 7\n");
    let error = rejected(folder.path());
    assert_eq!(error.line(), None, "{error}");
    assert!(
        error.to_string().contains("pack.toml: columns: is missing"),
        "{error}"
    );
}

/// Waiting for a pipe's writer would be for ever.
#[cfg(unix)]
#[test]
fn a_pipe_is_not_waited_for() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let made = std::process::Command::new("mkfifo")
        .arg(folder.path().join(MANIFEST_FILE))
        .status();
    assert!(made.expect("mkfifo").success());
    let error = rejected(folder.path());
    assert!(matches!(error, PackError::Read { .. }), "{error}");
}
