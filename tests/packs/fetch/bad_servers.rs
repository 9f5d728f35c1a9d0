//! Replies of bad servers are reported, requested again if that may help, and never kept.

use super::server::{Answer, Server};
use super::{Notes, colour, description, files, layer, options, place, png, tile};
use std::path::Path;
use std::time::{Duration, Instant};
use terrella_pack::fetch::{FetchError, Fetched, LayerDone};

fn good(path: &str) -> Answer {
    let [level, row, column] = place(path);
    Answer::picture("image/png", png(&tile(level, row, column, colour)))
}

/// The tile that is bad.
fn is_bad(path: &str) -> bool {
    path.ends_with("/2/1/3.png")
}

/// Fetches from a server that always replies this for one tile.
fn fetch(
    folder: &Path,
    bad: impl Fn(&str) -> Answer + Send + Sync + 'static,
) -> (Result<LayerDone, FetchError>, Server) {
    let server = Server::new(move |path, _| if is_bad(path) { bad(path) } else { good(path) });
    let done = layer(&description(&server)).fetch(&options(folder), &());
    (done, server)
}

/// The message about a server that replies this for one tile, and the number of requests.
fn reported(bad: impl Fn(&str) -> Answer + Send + Sync + 'static) -> (String, usize) {
    let folder = tempfile::tempdir().expect("a folder");
    let (done, server) = fetch(folder.path(), bad);
    let said = done.expect_err("a bad tile").to_string();
    let kept = files(folder.path());
    assert!(
        !kept.iter().any(|file| file.ends_with("1/3.png")),
        "{kept:?}"
    );
    assert!(
        !kept
            .iter()
            .any(|file| file.to_string_lossy().contains("part")),
        "{kept:?}"
    );
    assert!(said.contains("/2/1/3.png"), "{said}");
    let asked = server
        .asked()
        .iter()
        .filter(|(path, _)| is_bad(path))
        .map(|(_, count)| *count)
        .sum();
    (said, asked)
}

#[test]
fn what_may_come_right_is_asked_for_again() {
    let cut = |path: &str| {
        let mut answer = good(path);
        answer.body.truncate(answer.body.len() / 2);
        answer
    };
    let unsaid = move |path: &str| Answer {
        length: None,
        ..cut(path)
    };
    let slow = |path: &str| Answer {
        pause: Duration::from_millis(20),
        ..good(path)
    };
    let silent = |path: &str| Answer {
        body: vec![0x89],
        pause: Duration::from_millis(2500),
        ..good(path)
    };
    let garbled = |path: &str| {
        let mut answer = good(path);
        let middle = answer.body.len() / 2;
        answer.body[middle] ^= 0x10;
        answer
    };
    let early = move |path: &str| Answer {
        length: Some(good(path).body.len()),
        ..cut(path)
    };
    for ((said, asked), expected, words) in [
        (
            reported(|_| Answer::failure("500 Internal Server Error")),
            2,
            "the server answers 500",
        ),
        (
            reported(|_| Answer::failure("503 Service Unavailable")),
            2,
            "the server answers 503",
        ),
        (reported(early), 2, "the answer breaks off after"),
        (reported(unsaid), 2, "it breaks off"),
        (reported(garbled), 2, "it cannot be decoded"),
        (reported(slow), 2, "too slow"),
        (reported(silent), 2, "too slow"),
    ] {
        assert_eq!(asked, expected, "{said}");
        assert!(
            said.contains(words) && said.contains("1 of 8 files"),
            "{words}: {said}"
        );
    }
}

#[test]
fn what_will_not_come_right_is_asked_for_once() {
    let wrong_type = |path: &str| Answer {
        headers: vec![("Content-Type", "text/html; charset=utf-8".into())],
        ..good(path)
    };
    let no_type = |path: &str| Answer {
        headers: Vec::new(),
        ..good(path)
    };
    let wrong_kind = |_: &str| Answer::picture("image/png", b"<html>please log in</html>".to_vec());
    let wrong_size = |_: &str| {
        Answer::picture(
            "image/png",
            include_bytes!("../../data/maps/palette.png").to_vec(),
        )
    };
    let compressed = |path: &str| good(path).with("Content-Encoding", "gzip");
    let large = |path: &str| Answer {
        length: Some(9_000_000_000),
        ..good(path)
    };
    let endless = |_: &str| Answer {
        length: None,
        ..Answer::picture("image/png", vec![0; 9_000_000])
    };
    for ((said, asked), words) in [
        (
            reported(|_| Answer::failure("404 Not Found")),
            "the server answers 404",
        ),
        (
            reported(wrong_type),
            "the answer is text/html; charset=utf-8 and must be image/png",
        ),
        (reported(no_type), "the answer is of no type"),
        (
            reported(wrong_kind),
            "begins with \"<html>please log in</ht",
        ),
        (
            reported(wrong_size),
            "it has 64 x 32 texels and must have 32 x 32",
        ),
        (reported(compressed), "the answer is compressed (gzip)"),
        (
            reported(large),
            "more than 8000000 bytes (the server says 9000000000)",
        ),
        (reported(endless), "more than 8000000 bytes"),
    ] {
        assert_eq!(asked, 1, "{said}");
        assert!(
            said.contains(words) && said.contains("1 of 8 files"),
            "{words}: {said}"
        );
    }
}

#[test]
fn what_no_file_can_mend_ends_the_fetch() {
    for ((said, asked), words) in [
        (
            reported(|_| Answer::failure("403 Forbidden")),
            "may want a key",
        ),
        (
            reported(|_| Answer::failure("400 Bad Request")),
            "correct layer, level, time",
        ),
        (
            reported(|_| Answer::failure("302 Found").with("Location", "http://127.0.0.1:1/x.png")),
            "sends on to http://127.0.0.1:1/x.png",
        ),
        (
            reported(|_| Answer::failure("301 Moved").with("Location", "file:///etc/passwd")),
            "sends on to file:///etc/passwd",
        ),
        (
            reported(|_| Answer::failure("429 Too Many Requests").with("Retry-After", "86400")),
            "come back when the server says so",
        ),
    ] {
        assert_eq!(asked, 1, "{said}");
        assert!(
            said.contains(words) && said.contains("What was fetched is kept"),
            "{words}: {said}"
        );
    }
    // Round and round on its own host.
    let (said, asked) = reported(|path| Answer::failure("302 Found").with("Location", path));
    assert!(
        said.contains("more than 5 times") && asked == 6,
        "{asked}: {said}"
    );
}

#[test]
fn a_server_that_asks_for_patience_gets_it() {
    let server = Server::new(|path, nth| {
        if is_bad(path) && nth == 0 {
            Answer::failure("429 Too Many Requests").with("Retry-After", "1")
        } else if path.ends_with("/2/0/0.png") && nth == 0 {
            Answer::failure("500 Internal Server Error")
        } else if path.ends_with("/2/0/1.png") && nth == 0 {
            // An allowed redirect.
            Answer::failure("307 Temporary Redirect").with("Location", "/moved/2/0/1.png")
        } else {
            good(path)
        }
    });
    let (folder, begun) = (tempfile::tempdir().expect("a folder"), Instant::now());
    let done = layer(&description(&server))
        .fetch(&options(folder.path()), &())
        .expect("fetched");
    assert!(
        begun.elapsed() >= Duration::from_secs(1),
        "{:?}",
        begun.elapsed()
    );
    let Fetched {
        new,
        retries,
        failed,
        ..
    } = done.fetched[0].1;
    assert_eq!((new, retries, failed), (8, 2, 0));
}

#[test]
fn what_is_missing_is_left_out_where_that_is_allowed() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::new(|path, _| {
        if is_bad(path) {
            Answer::failure("404 Not Found")
        } else {
            good(path)
        }
    });
    let notes = Notes::default();
    let text = description(&server) + "may_be_missing = true\n";
    let done = layer(&text)
        .fetch(&options(folder.path()), &notes)
        .expect("fetched");
    assert_eq!((done.fetched[0].1.new, done.fetched[0].1.missing), (7, 1));
    let reported = notes.texts.into_inner().expect("whole").join("\n");
    assert!(reported.contains("nothing for 1 of 8 tiles"), "{reported}");
    // It is remembered.
    layer(&text)
        .fetch(&options(folder.path()), &())
        .expect("fetched");
    assert_eq!(server.count(), 8);

    let folder = tempfile::tempdir().expect("a folder");
    let mut options = options(folder.path());
    options.allow_missing = true;
    let notes = Notes::default();
    let done = layer(&description(&server))
        .fetch(&options, &notes)
        .expect("fetched");
    assert_eq!((done.fetched[0].1.new, done.fetched[0].1.failed), (7, 1));
    let reported = notes.texts.into_inner().expect("whole").join("\n");
    assert!(
        reported.contains("1 of 8 files are left out") && reported.contains("404"),
        "{reported}"
    );
}

#[test]
fn pictures_that_stand_for_nothing_are_noticed_and_left_out_where_they_are_named() {
    // Row 0 has one picture with a pattern, row 1 one of a plain colour.
    let server = Server::new(|path, _| {
        let [level, row, _] = place(path);
        let plain = |_: f64, _: f64| [9, 9, 9];
        let texels = match row {
            0 => tile(level, 0, 0, colour),
            _ => tile(level, 0, 0, plain),
        };
        Answer::picture("image/png", png(&texels))
    });
    let folder = tempfile::tempdir().expect("a folder");
    let (options, text) = (options(folder.path()), description(&server));
    let notes = Notes::default();
    layer(&text).fetch(&options, &notes).expect("fetched");
    let reported = notes.texts.into_inner().expect("whole").join("\n");
    assert!(
        reported.contains("4 of 8 tiles are one and the same picture"),
        "{reported}"
    );
    let key = reported.split('`').nth(1).expect("the key to give");
    assert!(reported.matches("same picture").count() == 1, "{reported}");

    // In the cache already, and in a separate fetch.
    let named = format!("{text}{key}\n");
    let elsewhere = tempfile::tempdir().expect("a folder");
    for cache in [folder.path(), elsewhere.path()] {
        let options = super::options(cache);
        for _ in 0..2 {
            let notes = Notes::default();
            let done = layer(&named).fetch(&options, &notes).expect("fetched");
            assert_eq!(
                (done.fetched[0].1.missing, done.fetched[0].1.failed),
                (4, 0)
            );
            let reported = notes.texts.into_inner().expect("whole").join("\n");
            assert!(
                reported.contains("nothing for 4 of 8 tiles") && !reported.contains("same picture"),
                "{reported}"
            );
        }
        let tiles = files(cache);
        let is_tile = |file: &&std::path::PathBuf| file.extension().is_some_and(|e| e == "png");
        assert_eq!(tiles.iter().filter(is_tile).count(), 4, "{tiles:?}");
    }
    assert_eq!(server.count(), 16);
}

#[test]
fn a_server_that_is_gone_is_not_asked_for_ever() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = {
        let server = Server::new(|path, _| good(path));
        description(&server)
    };
    let mut options = options(folder.path());
    options.fineness = terrella_pack::fetch::Fineness::Level(4);
    options.retries = 0;
    let error = layer(&text).fetch(&options, &()).expect_err("gone");
    let said = error.to_string();
    assert!(
        said.contains("20 failures in a row") && said.contains("no connection"),
        "{said}"
    );
}

#[test]
fn descriptions_and_caches_of_others_are_rejected() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::new(|path, _| good(path));
    layer(&description(&server))
        .fetch(&options(folder.path()), &())
        .expect("fetched");
    let other = description(&server).replace("{z}/{row}", "other/{z}/{row}");
    let error = layer(&other)
        .fetch(&options(folder.path()), &())
        .expect_err("another address");
    assert!(matches!(error, FetchError::OtherAddress { .. }), "{error}");
    // A file where a folder must be.
    let blocked = folder.path().join("blocked");
    std::fs::write(&blocked, b"x").expect("written");
    let error = layer(&description(&server))
        .fetch(&options(&blocked), &())
        .expect_err("no folder");
    assert!(matches!(error, FetchError::Cache { .. }), "{error}");
}

#[test]
fn certificates_are_looked_at() {
    let server = Server::with_tls(|path, _| good(path));
    let text = description(&server).replace("http://", "https://");
    let folder = tempfile::tempdir().expect("a folder");
    let mut options = options(folder.path());
    let error = layer(&text)
        .fetch(&options, &())
        .expect_err("an unknown authority");
    let said = error.to_string();
    assert!(
        matches!(error, FetchError::Rejected { .. })
            && said.contains("certificate is not good")
            && said.contains("--ca"),
        "{said}"
    );
    assert_eq!((server.count(), files(folder.path()).len()), (0, 0));

    let authority = Path::new(crate::REPOSITORY).join("tests/data/tls/authority.pem");
    options.client.authorities = Some(authority);
    let done = layer(&text).fetch(&options, &()).expect("fetched");
    assert_eq!(done.fetched[0].1.new, 8);
    // A name that the certificate has not.
    let other = text
        .replace("127.0.0.1", "localhost")
        .replace("\"local\"", "\"other\"");
    let said = layer(&other)
        .fetch(&options, &())
        .expect_err("another name")
        .to_string();
    assert!(
        said.contains("certificate") && said.contains("not valid for name"),
        "{said}"
    );
}
