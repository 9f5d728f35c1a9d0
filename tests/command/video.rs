//! Video by either encoder.

use crate::{Place, SMALL, names, png_size, words};
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// Types of the boxes of an MP4 file, in their order, and the contents of one of them.
fn boxes(file: &[u8]) -> Vec<(String, &[u8])> {
    let mut rest = file;
    let mut found = Vec::new();
    while let Some((head, _)) = rest.split_first_chunk::<8>() {
        let [a, b, c, d, kind @ ..] = *head;
        let length = u32::from_be_bytes([a, b, c, d]) as usize;
        assert!(
            (8..=rest.len()).contains(&length),
            "a box of {length} bytes"
        );
        found.push((
            String::from_utf8_lossy(&kind).into_owned(),
            &rest[8..length],
        ));
        rest = &rest[length..];
    }
    assert!(rest.is_empty(), "{} bytes after the last box", rest.len());
    found
}

fn check_video(path: &Path) {
    check_video_of(path, "h264", ["64", "36"]);
}

/// An index before the data, four frames, and the colour tags for players.
fn check_video_of(path: &Path, codec: &str, [width, height]: [&str; 2]) {
    let file = std::fs::read(path).expect("reads");
    let boxes = boxes(&file);
    let kinds: Vec<_> = boxes.iter().map(|(kind, _)| kind.as_str()).collect();
    assert_eq!(kinds.first(), Some(&"ftyp"));
    let place = |wanted| kinds.iter().position(|kind| *kind == wanted).expect(wanted);
    assert!(
        place("moov") < place("mdat"),
        "the index comes first: {kinds:?}"
    );
    let moov = boxes[place("moov")].1;
    // The sample size table: version and flags, one size for all (0: each its own), and how many there are.
    let table = moov
        .windows(4)
        .position(|kind| kind == b"stsz")
        .expect("stsz")
        + 4;
    assert_eq!(
        moov[table + 8..table + 12],
        4_u32.to_be_bytes(),
        "four frames"
    );
    let asked = Command::new("ffprobe")
        .args(["-v", "error", "-count_frames", "-show_entries"])
        .arg("stream=codec_name,width,height,color_range,color_space,color_transfer,color_primaries,nb_read_frames")
        .args(["-of", "default=noprint_wrappers=1:nokey=1"])
        .arg(path)
        .output();
    match asked {
        Ok(answer) => {
            let text = String::from_utf8_lossy(&answer.stdout).into_owned();
            let values: Vec<_> = text.lines().collect();
            assert_eq!(
                values,
                [codec, width, height, "tv", "bt709", "bt709", "bt709", "4"],
                "{}",
                words(&answer)
            );
        }
        Err(error) => eprintln!("not checked with ffprobe: {error}"),
    }
}

#[test]
fn the_built_in_encoder_writes_a_video() {
    let place = Place::new();
    let output = place.succeed(&[
        "-q",
        "play",
        "small.toml",
        "--video",
        "a.mp4",
        "--encoder",
        "builtin",
    ]);
    // Not the encoder's either.
    if cfg!(unix) {
        assert_eq!(words(&output), "", "quiet has no words");
    }
    assert_eq!(place.names(), ["a.mp4", "small.toml"]);
    check_video(&place.path("a.mp4"));
}

#[test]
fn ffmpeg_writes_a_video_where_it_is_installed() {
    let place = Place::new();
    let arguments = [
        "play",
        "small.toml",
        "--video",
        "a.mp4",
        "--encoder",
        "ffmpeg",
    ];
    let output = place.run(&arguments);
    let said = words(&output);
    if said.contains("--encoder builtin") {
        eprintln!("not checked with ffmpeg: {said}");
        assert_eq!(output.status.code(), Some(1));
        assert_eq!(place.names(), ["small.toml"]);
        return;
    }
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert_eq!(place.names(), ["a.mp4", "small.toml"]);
    check_video(&place.path("a.mp4"));
}

/// A file size limit, which acts like a full disk for ffmpeg: it ends without an error nevertheless.
#[cfg(target_os = "linux")]
#[test]
fn a_video_by_ffmpeg_on_a_full_disk_is_not_kept() {
    let place = Place::new();
    place.scene(
        "long.toml",
        &SMALL.replace("duration_s = 4", "duration_s = 60"),
    );
    let play = format!(
        "{} -q play long.toml --size 320x180 --video a.mp4 --encoder ffmpeg",
        env!("CARGO_BIN_EXE_terrella")
    );
    let run = |limit: &str| {
        let mut shell = Command::new("sh");
        shell.args(["-c", &format!("{limit} exec {play}")]);
        let output = shell.current_dir(place.path("")).output().expect("a shell");
        let is_ours = |name: &String| !name.ends_with(".toml");
        let files: Vec<_> = names(&place.path("")).into_iter().filter(is_ours).collect();
        (output.status.code(), files, words(&output))
    };
    let (code, files, said) = run("");
    if said.contains("--encoder builtin") {
        eprintln!("not checked with ffmpeg: {said}");
        return;
    }
    assert_eq!((code, files), (Some(0), vec!["a.mp4".to_owned()]), "{said}");
    let bytes = std::fs::metadata(place.path("a.mp4")).expect("there").len();
    std::fs::remove_file(place.path("a.mp4")).expect("removes");
    // From a part of it to all but its end, in blocks of 512 bytes.
    for blocks in [bytes / 5120, bytes / 1024, bytes / 512 - 1] {
        let (code, files, said) = run(&format!("trap '' XFSZ; ulimit -f {blocks};"));
        assert_eq!((code, files), (Some(1), Vec::new()), "{blocks}: {said}");
        assert!(said.contains("a.mp4") && said.contains("ffmpeg"), "{said}");
    }
}

#[test]
fn other_codecs_and_qualities_are_written_by_ffmpeg() {
    let place = Place::new();
    let write = |name: &str, codec: &str, crf: &str| {
        let video = [
            "-q",
            "play",
            "small.toml",
            "--size",
            "320x180",
            "--video",
            name,
        ];
        place.run(&[&video[..], &["--codec", codec, "--crf", crf]].concat())
    };
    let mut sizes = Vec::new();
    for (codec, crf, name) in [
        ("h264", "10", "a.mp4"),
        ("h264", "40", "b.mp4"),
        ("h265", "28", "c.mp4"),
        ("av1", "35", "d.mp4"),
    ] {
        let output = write(name, codec, crf);
        let said = words(&output);
        if output.status.code() != Some(0) {
            assert!(said.contains("install"), "{said}");
            eprintln!("not checked: {said}");
            continue;
        }
        assert_eq!(said, "", "no words but ours");
        sizes.push(std::fs::metadata(place.path(name)).expect("there").len());
        let tag = if codec == "h265" { "hevc" } else { codec };
        check_video_of(&place.path(name), tag, ["320", "180"]);
    }
    if let [best, worst, ..] = sizes[..] {
        assert!(best > 2 * worst, "quality is bytes: {best} {worst}");
    }
    let hdr = place.run(&[
        "-q",
        "play",
        "small.toml",
        "--video",
        "hdr.mp4",
        "--codec",
        "h265",
        "--format",
        "pq",
    ]);
    match hdr.status.code() {
        Some(0) => {
            let bytes = std::fs::read(place.path("hdr.mp4")).expect("there");
            // Primaries and matrix of BT.2020, transfer of SMPTE ST 2084, limited range (ISO/IEC 14496-12, ColourInformationBox).
            let tag = b"colrnclx\0\x09\0\x10\0\x09\0";
            assert!(bytes.windows(tag.len()).any(|found| found == tag));
        }
        _ => assert!(words(&hdr).contains("install"), "{}", words(&hdr)),
    }
    for arguments in [["--codec", "h265"], ["--crf", "20"]] {
        let video = [
            "play",
            "small.toml",
            "--video",
            "x.mp4",
            "--encoder",
            "builtin",
        ];
        let said = place.fail(1, &[&video[..], &arguments].concat());
        assert!(said.contains("one quality"), "{said}");
    }
    assert!(!place.path("x.mp4").exists());
}

/// Without ffmpeg on the search path the built-in encoder is taken, and asking for ffmpeg is rejected.
#[test]
fn without_ffmpeg_the_built_in_encoder_is_taken() {
    let place = Place::new();
    let empty = place.path("empty");
    std::fs::create_dir(&empty).expect("makes");
    let arguments = ["play", "small.toml", "--video", "a.mp4"];
    let output = place
        .command(&arguments)
        .env("PATH", &empty)
        .output()
        .expect("starts");
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    check_video(&place.path("a.mp4"));
    for (more, way) in [
        (["--encoder", "ffmpeg"], "choose --encoder builtin"),
        (["--codec", "h265"], "leave --codec out"),
        (["--crf", "20"], "leave --crf out"),
    ] {
        let output = place
            .command(&[&arguments[..], &more].concat())
            .env("PATH", &empty)
            .output()
            .expect("starts");
        assert_eq!(output.status.code(), Some(1));
        let said = words(&output);
        assert!(said.contains("install it") && said.contains(way), "{said}");
    }
}

/// A film of many frames, and the same as images, interrupted in the middle. `folder` is the output folder of the images.
#[cfg(unix)]
fn in_the_middle_of_a_film(place: &Place, encoder: &str, folder: &str) -> std::process::Child {
    place.scene(
        "long.toml",
        &SMALL.replace("duration_s = 4", "duration_s = 100000"),
    );
    let video = ["--video", "a.mp4", "--encoder", encoder];
    let frames = ["--frames", folder];
    let mut child = place
        .command(&[&["play", "long.toml"][..], &video, &frames].concat())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("starts");
    let second = place.path(folder).join("frame_00001.png");
    let begin = Instant::now();
    while !second.exists() {
        assert!(
            begin.elapsed() < Duration::from_secs(60),
            "no frame in a minute"
        );
        assert!(
            child.try_wait().expect("asks").is_none(),
            "it ended by itself"
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    child
}

/// Killed: no file has a final name.
#[cfg(unix)]
#[test]
fn a_film_that_is_killed_leaves_nothing_under_its_name() {
    let place = Place::new();
    for encoder in ["builtin", "auto"] {
        let mut child = in_the_middle_of_a_film(&place, encoder, encoder);
        child.kill().expect("stops");
        child.wait().expect("ends");
        assert!(!place.path("a.mp4").exists());
        let shown = names(&place.path(encoder));
        for name in shown.iter().filter(|name| name.starts_with("frame_")) {
            assert_eq!(
                png_size(&place.path(encoder).join(name)),
                (64, 36),
                "{name}"
            );
        }
    }
}

/// Stopped by Ctrl-C: nothing unfinished is left at all, hidden files included.
#[cfg(unix)]
#[test]
fn a_film_that_is_interrupted_takes_its_unfinished_files_away() {
    for encoder in ["builtin", "auto"] {
        let place = Place::new();
        let child = in_the_middle_of_a_film(&place, encoder, "frames");
        let sent = Command::new("kill")
            .args(["-INT", &child.id().to_string()])
            .status();
        assert!(sent.expect("kill starts").success());
        let output = child.wait_with_output().expect("ends");
        assert_eq!(output.status.code(), Some(130), "{}", words(&output));
        let said = words(&output);
        assert!(said.contains("interrupted after"), "{said}");
        assert!(said.contains("--resume without --video"), "{said}");
        assert_eq!(place.names(), ["frames", "long.toml", "small.toml"]);
        let frames = names(&place.path("frames"));
        assert!(frames.len() >= 2);
        assert!(
            frames
                .iter()
                .all(|name| name.starts_with("frame_") || name == "frames.json"),
            "{frames:?}"
        );
    }
}
