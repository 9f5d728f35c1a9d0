//! `terrella pack` as a user runs it.

use super::fixture::{Fixture, key, write};
use std::path::Path;
use std::process::{Command, Output};
use terrella_imagery::tile::{MapLayer, Storage};

fn terrella(arguments: &[&str], folder: &Path) -> (Option<i32>, String, String) {
    let Output {
        status,
        stdout,
        stderr,
    } = Command::new(env!("CARGO_BIN_EXE_terrella"))
        .args(arguments)
        .current_dir(folder)
        .env_remove("RUST_LOG")
        .output()
        .expect("the program runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (status.code(), text(stdout), text(stderr))
}

#[test]
fn info_tells_what_is_in_a_pack() {
    let fixture = Fixture::shared();
    let (code, reported, complaint) = terrella(&["pack", "info", "."], fixture.dir());
    assert_eq!((code, complaint.as_str()), (Some(0), ""));
    for part in [
        "Known texels\n  Nobody's data\n  tiles kept as plain and bc\n",
        "\nday  from a formula\n  level 1    33 per block        528 × 264  128 blocks  plain ",
        "\nnormals  from a formula, slopes exaggerated 4 times\n",
        "\nwater  from a formula\n",
        "\n2560 files, ",
    ] {
        assert!(reported.contains(part), "{part:?} is not in {reported}");
    }
}

#[test]
fn verify_names_bad_tiles_and_fails() {
    let fixture = Fixture::small();
    let (code, reported, _) = terrella(&["pack", "verify", "."], fixture.dir());
    assert_eq!(code, Some(0));
    assert!(
        reported.starts_with("2560 of 2560 tiles are good, "),
        "{reported}"
    );
    let quiet = terrella(&["pack", "verify", ".", "--quiet"], fixture.dir());
    assert_eq!(quiet, (Some(0), String::new(), String::new()));

    write(
        &fixture.path(Storage::Bc, key(MapLayer::Normals, 0, 18)),
        b"bad",
    );
    write(&fixture.dir().join("tiles/odd\u{1b}[31m"), b"");
    let (code, reported, complaint) = terrella(&["pack", "verify", "."], fixture.dir());
    assert_eq!(code, Some(1));
    assert!(
        reported.contains("corrupt   tiles/bc/normals/33/r1c2.ktx2: it has 3 bytes"),
        "{reported}"
    );
    assert!(
        reported.contains("unknown   tiles/odd\\u{1b}[31m"),
        "{reported}"
    );
    assert_eq!(
        complaint,
        "error: .: 1 of 2560 tiles are corrupt; build the pack again\n"
    );
}

#[test]
fn preview_writes_a_whole_picture_or_none() {
    let fixture = Fixture::day();
    let sheet = fixture.dir().join("sheet.png");
    let write_sheet = |more: &[&str]| {
        let arguments = [&["pack", "preview", ".", "-o", "sheet.png"], more].concat();
        terrella(&arguments, fixture.dir())
    };
    for storage in ["plain", "bc"] {
        let (code, out, written) = write_sheet(&["--storage", storage]);
        assert_eq!((code, out.as_str()), (Some(0), ""), "{written}");
        assert!(
            written.starts_with("sheet.png: 1328 × 344 pixels, "),
            "{written}"
        );
        let picture = image::open(&sheet).expect("a picture");
        assert_eq!((picture.width(), picture.height()), (4 * 332, 332 + 12));
    }
    let before = std::fs::read(&sheet).expect("there");
    for block in [0, 1] {
        let path = fixture.path(Storage::Plain, key(MapLayer::Day, block, 7));
        write(&path, b"bad");
    }
    let (code, _, complaint) = write_sheet(&[]);
    assert_eq!(code, Some(1));
    assert!(
        complaint.contains("no level of day level 2 block r0c7"),
        "{complaint}"
    );
    assert_eq!(std::fs::read(&sheet).expect("there"), before);
    let left = std::fs::read_dir(fixture.dir()).expect("there").flatten();
    let names: Vec<_> = left.map(|entry| entry.file_name()).collect();
    assert_eq!(names.len(), 3, "{names:?}");

    let (code, _, complaint) =
        terrella(&["pack", "preview", ".", "-o", "sheet.jpg"], fixture.dir());
    assert_eq!(code, Some(1));
    assert!(
        complaint.contains("contact sheets are written as .png"),
        "{complaint}"
    );
}

#[test]
fn bad_packs_and_bad_usage_are_reported() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for command in ["info", "verify"] {
        let (code, _, complaint) = terrella(&["pack", command, "."], folder.path());
        assert_eq!(code, Some(1));
        assert!(
            complaint.starts_with("error: .: is not a pack: there is no pack.toml"),
            "{complaint}"
        );
        assert_eq!(complaint.lines().count(), 1);
    }
    for arguments in [
        &["pack"][..],
        &["pack", "mend", "."],
        &["pack", "info"],
        &["pack", "preview", "."],
    ] {
        assert_eq!(
            terrella(arguments, folder.path()).0,
            Some(2),
            "{arguments:?}"
        );
    }
    let (code, reported, _) = terrella(&["pack", "--help"], folder.path());
    assert_eq!(code, Some(0));
    for word in ["info", "verify", "preview"] {
        assert!(reported.contains(word), "{reported}");
    }
}
