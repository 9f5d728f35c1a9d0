//! Scenes whose states a simulator sends: films of exactly the requested frames, stills, rejections, a player that is killed.

use crate::{Place, frame_names, words};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest that anything is waited for; a machine under load is slow, not wrong.
const PATIENCE: Duration = Duration::from_secs(60);

/// A small scene of at most `frames` frames.
fn scene(listen: &str, keys: &str, frames: u32) -> String {
    format!(
        "[time]\nspeed = 10\nframe_rate_hz = 10\nduration_s = {frames}\n[orbit]\nsource = \"live\"\nlisten = \"{listen}\"\n{keys}\n\
         [camera]\nmode = \"nadir\"\n[earth]\nnormals = false\nnight_lights = false\n\
         [output]\nsize = [64, 36]\nsamples = 1\nwait_s = 2\n"
    )
}

const LOCKSTEP: &str = "pacing = \"lockstep\"\ntimeout_s = 60";

/// One line about a satellite on a circle, five minutes of flight from one number to the next.
fn line(message: &str, seq: u64) -> String {
    let (radius_m, rate): (f64, f64) = (6_778_137.0, 0.001_131_367);
    let minute = 5 * seq % 60;
    // It begins in the morning: at night one picture is as black as the other.
    let (sin, cos) = (minute as f64 * 60.0 * rate - 2.0).sin_cos();
    let (x, y) = (cos * radius_m, sin * radius_m);
    let (vx, vy) = (-y * rate, x * rate);
    format!(
        "{{\"message\":\"{message}\",\"seq\":{seq},\"epoch\":\"2018-01-15T12:{minute:02}:00Z\",\"frame\":\"GCRF\",\
         \"position_m\":[{x},{y},0],\"velocity_m_s\":[{vx},{vy},0]}}\n"
    )
}

/// A player that listens.
struct Player {
    child: Child,
    address: SocketAddr,
    rest: std::thread::JoinHandle<String>,
}

impl Player {
    fn start(place: &Place, arguments: &[&str], display: Option<&str>) -> Self {
        let mut command = place.command(arguments);
        if let Some(display) = display {
            command.env("DISPLAY", display);
        }
        let mut child = command
            .arg("-v")
            .stderr(Stdio::piped())
            .spawn()
            .expect("starts");
        let mut stderr = BufReader::new(child.stderr.take().expect("a pipe"));
        let address = loop {
            let mut said = String::new();
            let length = stderr.read_line(&mut said).expect("reads");
            assert_ne!(length, 0, "it never listened");
            if let Some((_, on)) = said.split_once("is waited for on ") {
                let (_, address) = on.trim().split_once("://").expect("an address");
                break address.parse().expect("an address");
            }
        };
        let rest = std::thread::spawn(move || {
            let mut rest = String::new();
            let _ = stderr.read_to_string(&mut rest);
            rest
        });
        Self {
            child,
            address,
            rest,
        }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).expect("connects");
        stream.set_read_timeout(Some(PATIENCE)).expect("sets");
        stream
    }

    /// Exit code and words.
    fn end(mut self) -> (Option<i32>, String) {
        let begun = Instant::now();
        while self.child.try_wait().expect("asks").is_none() {
            assert!(begun.elapsed() < PATIENCE, "it does not end");
            std::thread::sleep(Duration::from_millis(20));
        }
        let code = self.child.wait().expect("ends").code();
        (code, self.rest.join().expect("reads"))
    }
}

/// Requests an image; returns the reply, which is empty if the connection ended.
fn ask(mut stream: &TcpStream, seq: u64) -> String {
    if stream.write_all(line("frame", seq).as_bytes()).is_err() {
        return String::new();
    }
    let mut answer = String::new();
    let _ = BufReader::with_capacity(1, stream).read_line(&mut answer);
    answer
}

fn is_drawn(answer: &str, seq: u64) -> bool {
    answer == format!("{{\"message\":\"ack\",\"seq\":{seq}}}\n")
}

/// Each is written and no two are equal.
fn assert_frames(place: &Place, count: usize) {
    let files = frame_names(&place.path("frames"));
    let expected: Vec<_> = (0..count).map(|k| format!("frame_{k:05}.png")).collect();
    assert_eq!(files, expected);
    let bytes = |name: &String| std::fs::read(place.path("frames").join(name)).expect("reads");
    let pictures: std::collections::BTreeSet<_> = files.iter().map(bytes).collect();
    assert_eq!(pictures.len(), count, "two frames are the same");
}

/// A simulator that is ended with its test.
struct Simulator(Child);

impl Drop for Simulator {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn the_simulator_of_the_page_is_drawn() {
    let page = include_str!("../../docs/live.md");
    let (_, program) = page.split_once("```python\n").expect("a program");
    let (program, _) = program.split_once("```").expect("its end");
    if Command::new("python3").arg("--version").output().is_err() {
        eprintln!("SKIPPED: docs/live.md is not run: there is no python3");
        return;
    }
    let place = Place::new();
    place.scene("live.toml", &scene("udp://127.0.0.1:0", "", 10));
    let arguments = ["frame", "live.toml", "-o", "a.png", "--stats", "a.json"];
    let player = Player::start(&place, &arguments, None);
    let program = program.replace("5005", &player.address.port().to_string());
    let mut python = Command::new("python3");
    let simulator = python.args(["-c", &program]).spawn().expect("starts");
    let _simulator = Simulator(simulator);
    let (code, said) = player.end();
    assert_eq!(code, Some(0), "{said}");
    let stats = std::fs::read_to_string(place.path("a.json")).expect("reads");
    let stats: serde_json::Value = serde_json::from_str(&stats).expect("JSON");
    // The page's satellite: 6 778 137 m from the centre, where the ellipsoid is 6 357 to 6 378 km from it.
    let height_km = stats["eye"]["height_km"].as_f64().expect("a height");
    assert!((395.0..425.0).contains(&height_km), "{height_km}");
}

#[test]
fn a_lockstep_film_has_one_frame_for_each_that_is_asked_for() {
    let place = Place::new();
    place.scene("live.toml", &scene("tcp://127.0.0.1:0", LOCKSTEP, 1000));
    let arguments = [
        "play",
        "live.toml",
        "--frames",
        "frames",
        "--video",
        "a.mp4",
        "--encoder",
        "builtin",
    ];
    let player = Player::start(&place, &arguments, None);
    let stream = player.connect();
    // Meanwhile: garbage, a simulator that dies, another that continues.
    assert!(is_drawn(&ask(&stream, 1), 1));
    (&stream).write_all(b"{\"garbage\n").expect("sends");
    let mut answer = String::new();
    BufReader::with_capacity(1, &stream)
        .read_line(&mut answer)
        .expect("an error");
    assert!(answer.contains("\"error\""), "{answer}");
    assert!(is_drawn(&ask(&stream, 2), 2));
    drop(stream);
    let stream = player.connect();
    for seq in 3..=5 {
        assert!(is_drawn(&ask(&stream, seq), seq));
    }
    drop(stream);
    // It is silent for wait_s: the film ends whole.
    let (code, said) = player.end();
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("5 frames"), "{said}");
    assert_frames(&place, 5);
    assert_eq!(
        place.names(),
        ["a.mp4", "frames", "live.toml", "small.toml"]
    );
}

#[test]
fn a_film_ends_with_its_scene_and_says_so_to_the_simulator() {
    let place = Place::new();
    place.scene("live.toml", &scene("tcp://127.0.0.1:0", LOCKSTEP, 3));
    let player = Player::start(&place, &["play", "live.toml", "--frames", "frames"], None);
    let stream = player.connect();
    for seq in 1..=3 {
        assert!(is_drawn(&ask(&stream, seq), seq));
    }
    let begun = Instant::now();
    let answer = ask(&stream, 4);
    assert!(
        answer.is_empty() || answer.contains("the feed is closed"),
        "{answer}"
    );
    assert!(
        begun.elapsed() < Duration::from_secs(30),
        "{:?}",
        begun.elapsed()
    );
    let (code, said) = player.end();
    assert_eq!(code, Some(0), "{said}");
    assert_frames(&place, 3);
}

#[test]
fn frames_come_through_a_pipe_and_the_film_ends_with_it() {
    let place = Place::new();
    // It waits for more, were there not the end.
    let text = scene("stdin", LOCKSTEP, 1000).replace("wait_s = 2", "wait_s = 60");
    place.scene("live.toml", &text);
    let mut child = place
        .command(&["play", "live.toml", "--frames", "frames", "-q"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let mut input = child.stdin.take().expect("a pipe");
    let mut output: BufReader<ChildStdout> = BufReader::new(child.stdout.take().expect("a pipe"));
    for seq in 1..=4 {
        input
            .write_all(line("frame", seq).as_bytes())
            .expect("sends");
        let mut answer = String::new();
        output.read_line(&mut answer).expect("reads");
        assert!(is_drawn(&answer, seq), "{answer:?}");
    }
    drop(input);
    let begun = Instant::now();
    let mut rest = String::new();
    output.read_to_string(&mut rest).expect("reads");
    let output = child.wait_with_output().expect("ends");
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    assert!(
        begun.elapsed() < Duration::from_secs(30),
        "{:?}",
        begun.elapsed()
    );
    assert_eq!(rest, "", "standard output holds answers alone");
    assert_frames(&place, 4);
}

#[test]
fn a_simulator_that_never_comes_leaves_nothing_behind() {
    let place = Place::new();
    for (keys, arguments) in [
        (
            LOCKSTEP,
            &[
                "play",
                "live.toml",
                "--video",
                "a.mp4",
                "--encoder",
                "builtin",
            ][..],
        ),
        (LOCKSTEP, &["frame", "live.toml", "-o", "a.png"]),
        ("", &["frame", "live.toml", "-o", "a.png"]),
    ] {
        place.scene("live.toml", &scene("tcp://127.0.0.1:0", keys, 10));
        let said = place.fail(1, arguments);
        assert!(
            said.contains("nothing came from a simulator on tcp://127.0.0.1:"),
            "{said}"
        );
        assert!(
            said.contains("within 2 s") && said.contains("wait_s"),
            "{said}"
        );
        assert_eq!(place.names(), ["live.toml", "small.toml"]);
    }
}

#[test]
fn one_picture_is_of_the_state_that_comes() {
    let place = Place::new();
    place.scene(
        "live.toml",
        &scene("udp://127.0.0.1:0", "", 10).replace("wait_s = 2", "wait_s = 60"),
    );
    let arguments = ["frame", "live.toml", "-o", "a.png", "--stats", "a.json"];
    let player = Player::start(&place, &arguments, None);
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
    socket.send_to(b"garbage", player.address).expect("sends");
    socket
        .send_to(line("state", 1).as_bytes(), player.address)
        .expect("sends");
    let (code, said) = player.end();
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(crate::png_size(&place.path("a.png")), (64, 36));
    let stats = std::fs::read_to_string(place.path("a.json")).expect("reads");
    assert!(stats.contains("2018-01-15T12:0"), "{stats}");

    place.scene(
        "live.toml",
        &scene("tcp://127.0.0.1:0", LOCKSTEP, 10).replace("wait_s = 2", "wait_s = 60"),
    );
    let player = Player::start(&place, &["frame", "live.toml", "-o", "b.png"], None);
    assert!(is_drawn(&ask(&player.connect(), 7), 7));
    let (code, said) = player.end();
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(crate::png_size(&place.path("b.png")), (64, 36));
}

#[test]
fn what_has_no_meaning_with_a_simulators_time_is_rejected_with_advice() {
    let place = Place::new();
    // Somebody listens there: what only looks at the scene does not.
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let listen = format!("tcp://{}", taken.local_addr().expect("a port"));
    place.scene("taken.toml", &scene(&listen, "", 10));
    place.scene("live.toml", &scene("tcp://127.0.0.1:0", "", 10));
    for (arguments, part) in [
        (
            &["play", "live.toml", "--video", "a.mp4"][..],
            "pacing = \"lockstep\"",
        ),
        (
            &["play", "live.toml", "--frames", "frames"],
            "pacing = \"lockstep\"",
        ),
        (
            &[
                "frame",
                "live.toml",
                "-o",
                "a.png",
                "--at",
                "2018-01-15T12:00:00Z",
            ],
            "leave the instant out",
        ),
        (
            &[
                "frame",
                "live.toml",
                "-o",
                "a.png",
                "--renderer",
                "reference",
            ],
            "--renderer gpu",
        ),
        (&["orbit", "taken.toml"], "--satellite"),
        (&["orbit", "taken.toml", "--oem", "a.oem"], "--satellite"),
        (&["orbit", "taken.toml", "--omm", "a.omm"], "mean elements"),
        (&["bench", "taken.toml"], "another source"),
        (&["report", "taken.toml", "-o", "report"], "another source"),
        (&["play", "taken.toml"], "take another port"),
    ] {
        let said = place.fail(2, arguments);
        assert!(said.contains(part), "{arguments:?}: {said}");
    }
    let reported = place.succeed(&["check", "taken.toml"]);
    let reported = String::from_utf8(reported.stdout).expect("UTF-8");
    assert!(
        reported.contains("when a simulator sends on tcp://127.0.0.1:"),
        "{reported}"
    );
    assert_eq!(place.names(), ["live.toml", "small.toml", "taken.toml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_window_in_lockstep_answers_and_when_it_is_killed_its_partner_is_not_left_waiting() {
    let Some(display) = crate::window::Display::start() else {
        return;
    };
    let place = Place::new();
    let text = scene("tcp://127.0.0.1:0", LOCKSTEP, 10).replace("[64, 36]", "[200, 120]");
    place.scene("live.toml", &text);
    let mut player = Player::start(&place, &["play", "live.toml"], Some(&display.name));
    let stream = player.connect();
    for seq in 1..=5 {
        let answer = ask(&stream, seq);
        assert!(is_drawn(&answer, seq), "{answer}");
    }
    player.child.kill().expect("stops");
    let begun = Instant::now();
    assert_eq!(ask(&stream, 6), "");
    assert!(
        begun.elapsed() < Duration::from_secs(20),
        "{:?}",
        begun.elapsed()
    );
    assert!(!player.end().1.contains("panicked"));
}
