//! `terrella elements fetch` against a server of elements on this machine.

use super::server::{Answer, Server};
use crate::program::run;
use std::fs;
use std::time::{Duration, SystemTime};

const ISS: &str = "ISS (ZARYA)\r
1 25544U 98067A   18020.89808844  .00002078  00000-0  38550-4 0  9992\r
2 25544  51.6424  32.9776 0003646  28.7227  39.5332 15.54190080 95614\r
";

/// A server with one satellite and one group, and a folder with its description.
fn place() -> (Server, tempfile::TempDir) {
    let server = Server::new(|path, asked| match path {
        "/gp?n=25544" | "/gp?g=stations" => {
            Answer::picture("text/plain; charset=utf-8", ISS.into())
        }
        "/gp?n=1" => Answer::picture("text/plain", b"No GP data found".to_vec()),
        "/gp?n=2" => Answer::failure("403 Forbidden"),
        "/gp?n=3" if asked == 0 => Answer::failure("503 Service Unavailable"),
        "/gp?n=3" => Answer::picture("text/plain", ISS.into()),
        _ => Answer::failure("404 Not Found"),
    });
    let folder = tempfile::tempdir().expect("a folder");
    let url = format!("http://127.0.0.1:{}/gp", server.port);
    let text = format!(
        "name = \"local\"\ntitle = \"One satellite\"\ncitation = \"the tests\"\nsatellite_url = \"{url}?n={{number}}\"\n\
         group_url = \"{url}?g={{group}}\"\nmedia = \"text/plain\"\nmin_age_s = 7200\nrequests_per_s = 10\n"
    );
    fs::write(folder.path().join("local.toml"), text).expect("written");
    (server, folder)
}

#[test]
fn elements_are_fetched_once_in_two_hours_and_flown() {
    let (server, folder) = place();
    let fetch = |more: &[&str]| {
        let command = [
            "elements",
            "fetch",
            "--source",
            "local.toml",
            "--cache",
            "cache",
        ];
        run(&[&command[..], more].concat(), folder.path())
    };
    let (code, _, said) = fetch(&["25544"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(
        said.contains("downloaded from http://127.0.0.1")
            && said.contains("25544.tle: ISS (ZARYA)"),
        "{said}"
    );
    let text = fs::read_to_string(folder.path().join("25544.tle")).expect("written");
    assert_eq!(text.lines().count(), 3, "{text:?}");
    // Again, into another file: without a request, and its age is stated.
    let (code, _, said) = fetch(&["25544", "-o", "iss.tle"]);
    assert_eq!((code, server.count()), (Some(0), 1), "{said}");
    assert!(said.contains("downloaded 0 min ago"), "{said}");
    assert_eq!(
        fs::read_to_string(folder.path().join("iss.tle")).expect("written"),
        text
    );
    // Two hours later.
    let kept = fs::read_dir(folder.path().join("cache")).expect("a cache");
    let kept: Vec<_> = kept.map(|entry| entry.expect("readable").path()).collect();
    let [kept] = kept.as_slice() else {
        panic!("{kept:?}")
    };
    let old = SystemTime::now() - Duration::from_secs(7201);
    let file = fs::File::options().write(true).open(kept).expect("there");
    file.set_modified(old).expect("set");
    assert_eq!(fetch(&["25544"]).0, Some(0));
    assert_eq!(server.count(), 2);
    // A group, and orbits of it.
    let (code, _, said) = fetch(&["--group", "stations"]);
    assert_eq!(code, Some(0), "{said}");
    let states = ["orbit", "stations.tle", "--at", "2018-01-20T06:00:00Z"];
    let (code, reported, said) = run(&states, folder.path());
    assert_eq!(code, Some(0), "{reported} {said}");
}

#[test]
fn what_a_server_answers_otherwise_is_named_and_nothing_is_written() {
    let (server, folder) = place();
    fs::write(folder.path().join("3.tle"), "before").expect("written");
    for (number, expected) in [
        (
            "1",
            "it answers \"No GP data found\", which has no elements",
        ),
        (
            "2",
            "the server answers 403; it does not want to be asked so often",
        ),
        ("3", "the server answers 503; try again later"),
        ("3", "the answer has no elements of 3"),
        ("4", "the server answers 404; check the catalogue number"),
    ] {
        let command = [
            "elements",
            "fetch",
            "--source",
            "local.toml",
            "--cache",
            "cache",
            number,
        ];
        let (code, _, said) = run(&command, folder.path());
        assert_eq!(code, Some(1), "{said}");
        assert!(said.contains(expected), "{said}");
        assert!(!folder.path().join("cache").exists(), "{number}");
    }
    assert_eq!(server.count(), 5, "no request is repeated");
    let names = fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(names, 2, "the description and the file that was there");
    assert_eq!(
        fs::read_to_string(folder.path().join("3.tle")).expect("there"),
        "before"
    );
    let several = ["elements", "fetch", "--source", "local.toml", "1", "2"];
    let (_, _, said) = run(&several, folder.path());
    assert!(said.contains("--output: give the file"), "{said}");
}
