//! `terrella pack fetch` as a user runs it, and killed.

use super::server::{Answer, Server};
use super::{SIDE, colour, description, place, png, tile};
use crate::program::{run, terrella};
use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;
use terrella_ground::elevation::GridLimits;

fn good() -> Server {
    Server::new(|path, _| {
        let [level, row, column] = place(path);
        Answer::picture("image/png", png(&tile(level, row, column, colour)))
    })
}

/// A folder with the description of a server's source.
fn place_of(server: &Server) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("local.toml"), description(server)).expect("written");
    folder
}

const PACK: [&str; 8] = [
    "pack",
    "fetch",
    "local.toml",
    "--level",
    "4",
    "--pixels",
    "day=32,16",
    "-o",
];

#[test]
fn one_command_makes_a_pack_and_names_whose_it_is() {
    let (server, command) = (good(), [&PACK[..], &["earth"]].concat());
    let folder = place_of(&server);
    let (code, reported, complaint) = run(&[&command[..], &["--dry-run"]].concat(), folder.path());
    assert_eq!(code, Some(0), "{complaint}");
    assert!(
        reported.contains("128 files")
            && reported.contains("/4/0/0.png")
            && reported.contains("nothing was downloaded"),
        "{reported}"
    );
    assert_eq!(
        (server.count(), folder.path().join("earth.cache").exists()),
        (0, false)
    );

    let (code, _, complaint) = run(&command, folder.path());
    assert_eq!(code, Some(0), "{complaint}");
    assert!(
        complaint.contains("local, level 4: 128 files downloaded"),
        "{complaint}"
    );
    let (_, reported, _) = run(&["pack", "info", "earth"], folder.path());
    assert!(
        reported.contains("  Waves by the tests") && reported.contains("from local, 512 x 256"),
        "{reported}"
    );
    assert_eq!(
        run(&["--quiet", "pack", "verify", "earth"], folder.path()).0,
        Some(0)
    );

    // From the cache without the network.
    drop(server);
    let again = [
        "--quiet",
        "pack",
        "build",
        "--day",
        "earth.cache/day",
        "--pixels",
        "day=32,16",
        "--name",
        "earth",
        "-o",
        "again",
    ];
    let (code, _, complaint) = run(&again, folder.path());
    assert_eq!(code, Some(0), "{complaint}");
    let manifest = |pack: &str| {
        fs::read_to_string(folder.path().join(pack).join("pack.toml")).expect("a manifest")
    };
    assert_eq!(manifest("earth"), manifest("again"));
}

#[test]
fn a_fetch_that_is_killed_goes_on_to_the_same_pack() {
    let server = Server::new(|path, _| {
        let [level, row, column] = place(path);
        std::thread::sleep(Duration::from_millis(5));
        Answer::picture("image/png", png(&tile(level, row, column, colour)))
    });
    let folder = place_of(&server);
    for tiles in [20, 60] {
        let mut child = terrella(&[&PACK[..], &["killed"]].concat(), folder.path())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program runs");
        while server.count() < tiles {
            assert!(
                child.try_wait().expect("a child").is_none(),
                "over before {tiles} tiles"
            );
            std::thread::sleep(Duration::from_millis(2));
        }
        child.kill().expect("can be killed");
        child.wait().expect("a child");
        assert!(!folder.path().join("killed").join("pack.toml").exists());
    }
    let (code, _, complaint) = run(&[&PACK[..], &["killed"]].concat(), folder.path());
    assert_eq!(code, Some(0), "{complaint}");
    // At each kill three tiles may have been under way.
    assert!(
        server.count() <= 128 + 6,
        "{} requests for 128 tiles",
        server.count()
    );
    let whole = [
        &PACK[..],
        &["whole", "--cache", "killed.cache", "--name", "killed"],
    ]
    .concat();
    assert_eq!(run(&whole, folder.path()).0, Some(0));
    let manifest = |pack: &str| {
        fs::read_to_string(folder.path().join(pack).join("pack.toml")).expect("a manifest")
    };
    assert_eq!(manifest("killed"), manifest("whole"));
}

/// A limit of one kilobyte a file acts like a full disk: a tile has three.
#[cfg(unix)]
#[test]
fn a_disk_that_is_full_is_named_and_nothing_half_written_stays() {
    let server = Server::new(|path, _| {
        let [level, row, column] = place(path);
        let noise = |lon_deg: f64, lat_deg: f64| {
            let code = (lon_deg * 7919.0 + lat_deg * 104_729.0).rem_euclid(251.0);
            [code as u8, (code * 7.0) as u8, (code * 13.0) as u8]
        };
        Answer::picture("image/png", png(&tile(level, row, column, noise)))
    });
    let folder = place_of(&server);
    let script = format!(
        "trap '' XFSZ; ulimit -f 1; exec {:?} pack fetch local.toml --level 2 -o earth",
        env!("CARGO_BIN_EXE_terrella")
    );
    let output = Command::new("bash")
        .args(["-c", &script])
        .current_dir(folder.path())
        .output()
        .expect("bash runs");
    let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{complaint}");
    assert!(
        complaint.contains("earth.cache") && complaint.contains("make room"),
        "{complaint}"
    );
    assert_eq!(super::files(&folder.path().join("earth.cache")).len(), 0);
    assert!(!folder.path().join("earth").exists());
}

#[test]
fn heights_become_a_file_that_relief_reads() {
    // Web Mercator: elevations are the latitude, in tenths of a degree.
    let server = Server::new(|path, _| {
        let [level, row, _] = place(path);
        let step = 360.0 / f64::from(SIDE << level);
        let texels: Vec<u8> = (0..SIDE * SIDE)
            .flat_map(|n| {
                let northing = 180.0 - (f64::from(row * SIDE + n / SIDE) + 0.5) * step;
                let latitude_deg = northing.to_radians().sinh().atan().to_degrees();
                let code = (32_768.0 + 10.0 * latitude_deg) * 256.0;
                let code = code.round() as u32;
                [(code >> 16) as u8, (code >> 8) as u8, code as u8]
            })
            .collect();
        Answer::picture("image/png", png(&texels))
    });
    let folder = tempfile::tempdir().expect("a folder");
    let text = description(&server)
        .replace("{z}/{row}/{column}", "{z}/{y}/{x}")
        .replace("\"day\"", "\"elevation\"")
        .replace(
            "media",
            "crs = \"EPSG:3857\"\nencoding = \"terrarium\"\nmedia",
        );
    fs::write(folder.path().join("local.toml"), text).expect("written");
    let command = [
        "pack",
        "fetch",
        "local.toml",
        "--level",
        "4",
        "--region",
        "-40,20,50,60",
        "--ground-width",
        "0",
        "--heights",
        "alps.tif",
    ];
    let (code, _, complaint) = run(&command, folder.path());
    assert_eq!(code, Some(0), "{complaint}");
    assert!(complaint.contains("ends at 85.05 degrees"), "{complaint}");
    let read = terrella_ground::elevation::open_heights(
        &folder.path().join("alps.tif"),
        &GridLimits::default(),
    );
    let grid = read.expect("heights").grid;
    for latitude_deg in [25.0_f64, 40.0, 55.0] {
        let height_m = grid.height_m(latitude_deg.to_radians(), 0.1, 1e-3);
        assert!(
            (height_m - 10.0 * latitude_deg).abs() < 1.0,
            "{latitude_deg}: {height_m}"
        );
    }
}

#[test]
fn bad_usage_is_named() {
    let server = good();
    let folder = place_of(&server);
    for (arguments, words) in [
        (&["pack", "fetch", "-o", "x"][..], "SOURCE"),
        (&["pack", "fetch", "local.toml"], "--output"),
        (
            &["pack", "fetch", "blue_marbel", "-o", "x"],
            "did you mean blue_marble?",
        ),
        (
            &["pack", "fetch", "blue_marble@2004-13", "-o", "x"],
            "write it as in 2004-08",
        ),
        (
            &["pack", "fetch", "viirs_snpp", "-o", "x"],
            "viirs_snpp@2024-06-21",
        ),
        (
            &["pack", "fetch", "black_marble", "-o", "x"],
            "a pack needs a day map",
        ),
        (
            &["pack", "fetch", "local.toml", "--level", "9", "-o", "x"],
            "levels 0 to 4",
        ),
        (
            &[
                "pack",
                "fetch",
                "local.toml",
                "--region",
                "1,2,3",
                "-o",
                "x",
            ],
            "west, south, east and north",
        ),
        (
            &[
                "pack",
                "fetch",
                "local.toml",
                "--ca",
                "local.toml",
                "-o",
                "x",
            ],
            "holds no certificate",
        ),
        (
            &[
                "pack",
                "fetch",
                "local.toml",
                "--exaggeration",
                "2",
                "-o",
                "x",
            ],
            "--exaggeration",
        ),
        (
            &[
                "pack",
                "fetch",
                "local.toml",
                "--download-only",
                "--cache",
                "c",
                "--restart",
            ],
            "need --output",
        ),
        (
            &["pack", "fetch", "local.toml", "--heights", "x.tif"],
            "only sources of elevation data",
        ),
    ] {
        let (code, _, complaint) = run(arguments, folder.path());
        assert!(
            code != Some(0) && complaint.contains(words),
            "{arguments:?}: {complaint}"
        );
    }
    assert_eq!(server.count(), 0);
    let (code, reported, _) = run(&["pack", "fetch", "--list"], folder.path());
    assert!(
        code == Some(0)
            && reported.contains("attribution: NASA Earth Observatory")
            && reported.contains("terms: "),
        "{reported}"
    );
}

/// All content below a folder, journals too, as text where possible.
fn contents(folder: &std::path::Path) -> String {
    let mut all = String::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        all += &path.to_string_lossy();
        if path.is_dir() {
            all += &contents(&path);
        } else {
            all += &String::from_utf8_lossy(&fs::read(&path).expect("a file"));
        }
    }
    all
}

#[test]
fn tokens_come_from_the_environment_and_stand_in_no_file_and_no_message() {
    const SECRET: &str = "ab+cd/0123456789";
    let fetch = |description: String, is_set: bool| {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("local.toml"), description).expect("written");
        let mut command = terrella(&[&PACK[..], &["earth"]].concat(), folder.path());
        command.env_remove("TERRELLA_TEST_TOKEN");
        if is_set {
            command.env("TERRELLA_TEST_TOKEN", SECRET);
        }
        let done = command.output().expect("the program runs");
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        let all = said.clone() + &contents(folder.path());
        for secret in [SECRET, "ab%2Bcd%2F0123456789"] {
            assert!(!all.contains(secret), "{all}");
        }
        (done.status.code(), said)
    };
    let with_token = |server: &Server| {
        "token_env = \"TERRELLA_TEST_TOKEN\"\n".to_string() + &description(server)
    };
    // In the address.
    let server = Server::new(|path, _| match path.split_once("?key=") {
        Some((path, "ab%2Bcd%2F0123456789")) => {
            let [level, row, column] = place(path);
            Answer::picture(
                "application/octet-stream",
                png(&tile(level, row, column, colour)),
            )
        }
        _ => Answer::failure("302 Found")
            .with("Location", "http://127.0.0.1:1/?key=ab%2Bcd%2F0123456789"),
    });
    let in_address = with_token(&server).replace(".png\"", ".png?key={token}\"");
    let (code, said) = fetch(in_address.clone(), true);
    assert_eq!(code, Some(0), "{said}");
    // Servers repeat the request in replies.
    let (code, said) = fetch(in_address.replace("?key=", "?other="), true);
    assert!(
        code == Some(1) && said.contains("sends on to http://127.0.0.1:1/?key={token}"),
        "{said}"
    );
    let (code, said) = fetch(in_address, false);
    assert!(
        code == Some(1) && said.contains("TERRELLA_TEST_TOKEN is not set"),
        "{said}"
    );
    // In the header.
    let server = good();
    let (code, said) = fetch(with_token(&server), true);
    assert_eq!(code, Some(0), "{said}");
    let sent = server.authorizations();
    assert_eq!(sent.len(), 128);
    assert!(sent.iter().all(|sent| *sent == format!("Bearer {SECRET}")));
    // A place for it without a name.
    let (code, said) = fetch(description(&server).replace("{row}", "{token}/{row}"), true);
    assert!(
        code == Some(1) && said.contains("token_env"),
        "{code:?}: {said}"
    );
}

#[test]
fn a_strict_fetch_fails_where_a_tile_is_missing() {
    let server = Server::new(|path, _| match place(path) {
        [_, 3, 5] => Answer::failure("404 Not Found"),
        [level, row, column] => {
            Answer::picture("image/png", png(&tile(level, row, column, colour)))
        }
    });
    let folder = tempfile::tempdir().expect("a folder");
    let text = description(&server) + "may_be_missing = true\n";
    fs::write(folder.path().join("local.toml"), text).expect("written");
    let command = [&PACK[..], &["earth"]].concat();
    let (code, _, said) = run(&[&command[..], &["--strict"]].concat(), folder.path());
    assert!(
        code == Some(1)
            && said.contains("nothing for 1 of 128 tiles")
            && said.contains("--strict: 1 notes"),
        "{said}"
    );
    assert!(!folder.path().join("earth").exists());
    let (code, _, said) = run(&command, folder.path());
    assert_eq!(code, Some(0), "{said}");
}
