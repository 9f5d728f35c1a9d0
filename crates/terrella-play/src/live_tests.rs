//! Simulators that are killed, stalled, restarted, flooding or slow, and the display meanwhile.

use super::*;
use crate::camera::HeadTurn;
use crate::scene::Scene;
use std::io::{BufRead, BufReader, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use terrella::frames::utc_from_rfc3339;
use terrella_orbit::live::{Packet, PacketKind};
use terrella_orbit::{Frame, OrbitState};

/// Longest that anything is waited for; a machine under load is slow, not wrong.
const PATIENCE: Duration = Duration::from_secs(20);
/// A frame that takes so long is seen to stumble; far above what a machine under load needs.
const STUMBLE: Duration = Duration::from_millis(500);

fn flight(keys: &str) -> Flight {
    let text = format!(
        "[orbit]\nsource = \"live\"\nlisten = \"tcp://127.0.0.1:0\"\n{keys}\n[camera]\nmode = \"nadir\"\n"
    );
    open(&text)
}

fn open(text: &str) -> Flight {
    let scene = Scene::from_toml(text, Path::new("scene.toml"));
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    Flight::open(scene).unwrap_or_else(|error| panic!("{error}"))
}

fn address(flight: &Flight) -> SocketAddr {
    flight
        .live_clock()
        .and_then(LiveFeed::local_address)
        .expect("a port")
}

fn connect(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).expect("connects");
    stream.set_read_timeout(Some(PATIENCE)).expect("sets");
    stream
}

fn view() -> ViewRequest {
    ViewRequest {
        mode: CameraMode::Nadir,
        look: HeadTurn::default(),
        aspect: 1.5,
    }
}

fn noon(t_s: f64) -> Epoch {
    let noon = utc_from_rfc3339("2018-01-15T12:00:00Z").expect("a date");
    noon + hifitime::Unit::Nanosecond * (t_s * 1e9).round()
}

/// A circle 400 km above the equator, `t_s` seconds after noon.
fn packet(kind: PacketKind, seq: u64, t_s: f64) -> Packet {
    let (radius_m, rate): (f64, f64) = (6_778_137.0, 0.001_131_367);
    let (sin, cos) = (t_s * rate).sin_cos();
    Packet {
        kind,
        seq: Some(seq),
        state: OrbitState {
            epoch: noon(t_s),
            frame: Frame::Gcrf,
            position_m: glam::DVec3::new(cos, sin, 0.0) * radius_m,
            velocity_m_s: glam::DVec3::new(-sin, cos, 0.0) * radius_m * rate,
        },
        name: None,
    }
}

fn send(mut stream: &TcpStream, packet: &Packet) -> bool {
    stream.write_all(packet.to_json().as_bytes()).is_ok()
}

fn answer(stream: &TcpStream) -> serde_json::Value {
    let mut line = String::new();
    let read = BufReader::with_capacity(1, stream).read_line(&mut line);
    read.expect("an answer");
    serde_json::from_str(&line).unwrap_or_else(|error| panic!("{line:?}: {error}"))
}

/// A simulator in real time from `start_s` after noon, until it is stopped; then it dies in the middle of a packet.
struct Simulator {
    stop: Arc<AtomicBool>,
    thread: JoinHandle<()>,
}

impl Simulator {
    fn start(address: SocketAddr, start_s: f64) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let its = Arc::clone(&stop);
        let thread = std::thread::spawn(move || {
            let mut stream = connect(address);
            let begun = Instant::now();
            for seq in 0.. {
                if its.load(Ordering::Relaxed) {
                    let half = packet(PacketKind::State, seq, start_s)
                        .to_bytes()
                        .expect("bytes");
                    let _ = stream.write_all(&half[..40]);
                    return;
                }
                let t_s = start_s + begun.elapsed().as_secs_f64();
                send(&stream, &packet(PacketKind::State, seq, t_s));
                std::thread::sleep(Duration::from_millis(10));
            }
        });
        Self { stop, thread }
    }

    fn kill(self) {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.join().expect("ends");
    }
}

/// Draws until it is so; every picture must be one. Gives the last and how long the slowest took to be found.
#[track_caller]
fn play_until(
    what: &str,
    play: &mut LivePlay<'_>,
    mut is_so: impl FnMut(&Moment, &LiveStatus) -> bool,
) -> (Moment, Duration) {
    let begun = Instant::now();
    let mut slowest = Duration::ZERO;
    loop {
        let frame = Instant::now();
        assert!(play.is_due(false, false) || play.is_lockstep());
        let moment = play.moment(&view(), false);
        play.drawn();
        let status = play.status(false);
        slowest = slowest.max(frame.elapsed());
        let view = &moment.view;
        let is_finite = view.clip_from_view.is_finite() && view.view_from_world.is_finite();
        assert!(is_finite && view.eye_world.is_finite(), "{moment:?}");
        if is_so(&moment, &status) {
            return (moment, slowest);
        }
        assert!(begun.elapsed() < PATIENCE, "{what}: {status:?}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn notice(status: &LiveStatus) -> &str {
    status.notice.as_deref().unwrap_or_default()
}

#[test]
fn before_the_first_state_the_earth_is_drawn_and_the_window_says_what_is_missing() {
    let flight = flight("");
    let mut play = LivePlay::of(&flight).expect("live");
    let moment = play.moment(&view(), false);
    assert_eq!(moment.epoch, flight.scene().time.start);
    assert_eq!(moment.satellite, None);
    let height_m = flight
        .ellipsoid()
        .geodetic_from_itrf(moment.view.eye_world)
        .height_m;
    assert!((height_m - 2e7).abs() < 1.0, "{height_m}");
    let reported = format!("waiting for states on tcp://{}", address(&flight));
    let status = play.status(false);
    assert_eq!(notice(&status), reported);
    assert!(
        status
            .rows
            .contains(&("states", "nothing has come yet".to_owned()))
    );
}

#[test]
fn a_simulator_that_is_killed_and_started_again_never_stops_the_picture() {
    let flight = flight("stale_after_s = 0.3\nextrapolate_s = 0.8\nplayback_delay_s = 0.05");
    let mut play = LivePlay::of(&flight).expect("live");
    for (run, start_s) in [0.0, 86_400.0, -3600.0].into_iter().enumerate() {
        let simulator = Simulator::start(address(&flight), start_s);
        let is_its = |moment: &Moment| {
            let t_s = (moment.epoch - noon(start_s)).to_seconds();
            moment.satellite.is_some() && (0.1..100.0).contains(&t_s)
        };
        let (_, slowest) = play_until("the run", &mut play, |moment, status| {
            is_its(moment) && status.notice.is_none()
        });
        assert!(slowest < STUMBLE, "{slowest:?}");
        simulator.kill();
        let (stale, _) = play_until("stale", &mut play, |_, status| {
            notice(status).starts_with("stale: the last state came")
        });
        assert!(is_its(&stale));
        let words = &play.status(false).rows;
        assert!(
            words.iter().any(|(_, value)| value.starts_with("STALE")),
            "{words:?}"
        );
        // It is extrapolated to the limit and stays there.
        let newest = flight
            .live_clock()
            .and_then(LiveFeed::newest)
            .expect("states");
        play_until("the limit", &mut play, |moment, _| {
            (moment.epoch - newest.epoch).to_seconds() > 0.79
        });
        std::thread::sleep(Duration::from_millis(100));
        let last = play.moment(&view(), false);
        let beyond_s = (last.epoch - newest.epoch).to_seconds();
        assert!((beyond_s - 0.8).abs() < 1e-6, "{beyond_s}");
        std::thread::sleep(Duration::from_millis(100));
        let still = play.moment(&view(), false);
        assert_eq!(
            (still.epoch, still.view),
            (last.epoch, last.view),
            "run {run}"
        );
        assert!(still.satellite.is_some());
    }
    let counters = flight.live_clock().expect("live").counters();
    assert_eq!(
        (counters.restarts, counters.connections),
        (2, 3),
        "{counters:?}"
    );
    // A simulator that dies in the middle of a packet leaves a bad one.
    assert!(counters.bad >= 2, "{counters:?}");
}

#[test]
fn a_flood_and_garbage_in_the_middle_of_a_flight_are_dropped_and_counted() {
    let flight = flight("packets_per_s = 200");
    let to = address(&flight);
    let mut play = LivePlay::of(&flight).expect("live");
    let simulator = Simulator::start(to, 0.0);
    play_until("states", &mut play, |moment, _| moment.satellite.is_some());
    let stop = Arc::new(AtomicBool::new(false));
    let flooders: Vec<_> = [
        b"\x89TRL\x01\x01garbage {[\n".to_vec(),
        packet(PacketKind::State, 1, -5.0).to_json().into_bytes(),
    ]
    .into_iter()
    .map(|bytes| {
        let stop = Arc::clone(&stop);
        std::thread::spawn(move || {
            let mut stream = connect(to);
            let bytes = bytes.repeat(200);
            while !stop.load(Ordering::Relaxed) && stream.write_all(&bytes).is_ok() {}
        })
    })
    .collect();
    let feed = flight.live_clock().expect("live");
    let before = feed.playback_epoch().expect("states");
    let (_, slowest) = play_until("the flight", &mut play, |moment, _| {
        let counters = feed.counters();
        let dropped = counters.over_rate > 1000 && counters.bad > 100;
        dropped && (moment.epoch - before).to_seconds() > 1.0
    });
    assert!(slowest < STUMBLE, "{slowest:?}");
    // The true simulator gets through, and the dropped packets are reported.
    assert!((feed.newest().expect("states").epoch - before).to_seconds() > 0.5);
    let rows = play.status(false).rows;
    let packets = rows
        .iter()
        .find(|(name, _)| *name == "packets")
        .expect("a row");
    assert!(
        packets.1.contains("over the rate") && packets.1.contains("bad"),
        "{packets:?}"
    );
    stop.store(true, Ordering::Relaxed);
    simulator.kill();
    drop(play);
    drop(flight);
    flooders
        .into_iter()
        .for_each(|thread| thread.join().expect("ends"));
}

#[test]
fn the_user_may_hold_the_picture_and_learns_what_only_the_simulator_can_do() {
    let flight = flight("");
    let mut play = LivePlay::of(&flight).expect("live");
    let simulator = Simulator::start(address(&flight), 0.0);
    play_until("states", &mut play, |moment, _| moment.satellite.is_some());
    let held = play.moment(&view(), true);
    std::thread::sleep(Duration::from_millis(300));
    let wider = ViewRequest {
        aspect: 2.0,
        ..view()
    };
    let still = play.moment(&wider, true);
    assert_eq!(still.epoch, held.epoch);
    assert_ne!(still.view, held.view, "the user may look around meanwhile");
    assert!(play.pause(true).is_some() && play.pause(false).is_none());
    // The first state is shown until the delay is over.
    assert!((play.moment(&view(), false).epoch - held.epoch).to_seconds() > 0.15);
    assert_eq!(play.denial(Action::Pause), None);
    assert_eq!(play.denial(Action::NextCamera), None);
    for action in [
        Action::Faster,
        Action::Slower,
        Action::Reverse,
        Action::Seek(0.5),
        Action::Skip(5.0),
    ] {
        let reported = play.denial(action).expect("a message");
        assert!(
            reported.contains("simulator on tcp://127.0.0.1:"),
            "{reported}"
        );
    }
    simulator.kill();
}

#[test]
fn in_lockstep_each_picture_is_of_the_frame_that_is_asked_for() {
    let flight = flight("pacing = \"lockstep\"");
    let to = address(&flight);
    let mut play = LivePlay::of(&flight).expect("live");
    let begins = format!("waiting for frames on tcp://{to}");
    assert_eq!(notice(&play.status(false)), begins);
    let times = [5.0, 1e6, 3.0, 3.5];
    let partner = std::thread::spawn(move || {
        let stream = connect(to);
        for (seq, t_s) in (0..).zip(times) {
            send(&stream, &packet(PacketKind::Frame, seq, t_s));
            let got = answer(&stream);
            assert_eq!(
                (&got["message"], &got["seq"]),
                (&"ack".into(), &seq.into()),
                "{got}"
            );
        }
    });
    let mut seen = Vec::new();
    let begun = Instant::now();
    while seen.len() < times.len() {
        assert!(begun.elapsed() < PATIENCE, "{seen:?}");
        if play.is_due(false, false) && play.request.is_some() {
            let moment = play.moment(&view(), false);
            assert!(moment.satellite.is_some());
            seen.push(moment.epoch);
            play.drawn();
        }
        // Nothing is requested: the same image again.
        let again = play.moment(&view(), false).epoch;
        assert!(seen.last().is_none_or(|last| *last == again));
    }
    partner.join().expect("four answers");
    assert_eq!(seen, times.map(noon));
    let reported = play.denial(Action::Pause).expect("a message");
    assert!(reported.contains("stopped"), "{reported}");
}

#[test]
fn a_lockstep_partner_gets_an_error_when_the_player_is_slow_hidden_or_gone() {
    let flight = flight("pacing = \"lockstep\"\ntimeout_s = 0.4");
    let stream = connect(address(&flight));
    let mut play = LivePlay::of(&flight).expect("live");
    // Slow: no one draws.
    let begun = Instant::now();
    send(&stream, &packet(PacketKind::Frame, 1, 1.0));
    assert_eq!(answer(&stream)["error"], "not drawn within 0.4 s");
    assert!(
        begun.elapsed() < Duration::from_secs(5),
        "{:?}",
        begun.elapsed()
    );
    // Hidden: immediately.
    send(&stream, &packet(PacketKind::Frame, 2, 2.0));
    let begun = Instant::now();
    while flight.live_clock().expect("live").counters().frames < 2 {
        assert!(begun.elapsed() < PATIENCE);
        assert!(!play.is_due(true, false));
    }
    let reported = answer(&stream)["error"].to_string();
    assert!(reported.contains("hidden"), "{reported}");
    // Gone, in the middle of drawing.
    send(&stream, &packet(PacketKind::Frame, 3, 3.0));
    let begun = Instant::now();
    while !(play.is_due(false, false) && play.request.is_some()) {
        assert!(begun.elapsed() < PATIENCE);
    }
    drop(play);
    let begun = Instant::now();
    drop(flight);
    assert_eq!(answer(&stream)["error"], "the feed is closed");
    assert!(
        begun.elapsed() < Duration::from_secs(5),
        "{:?}",
        begun.elapsed()
    );
}

#[test]
fn a_satellite_that_is_not_known_at_the_simulators_time_ends_nothing() {
    // The built-in station's elements hold for 2018.
    let flight = open(
        "[[orbit]]\n[[orbit]]\nsource = \"live\"\nlisten = \"tcp://127.0.0.1:0\"\npacing = \"lockstep\"\n[camera]\nfollow = \"ISS (ZARYA)\"\n",
    );
    let stream = connect(address(&flight));
    let mut play = LivePlay::of(&flight).expect("live");
    let mut ask = |seq, t_s| {
        send(&stream, &packet(PacketKind::Frame, seq, t_s));
        let feed = flight.live_clock().expect("live");
        let drawn = play_until("an answer", &mut play, |_, _| feed.counters().frames == seq).0;
        (
            drawn,
            answer(&stream),
            notice(&play.status(false)).to_owned(),
        )
    };
    let (known, got, _) = ask(1, 0.0);
    assert!(
        known.satellite.is_some() && got["message"] == "ack",
        "{got}"
    );
    let (last, got, reported) = ask(2, 1e9);
    assert_eq!(last.epoch, known.epoch, "the last picture stays");
    assert!(got["error"].to_string().contains("2049"), "{got}");
    assert!(reported.contains("2049"), "{reported}");
    let (next, got, reported) = ask(3, 60.0);
    assert_eq!((next.epoch, &got["message"]), (noon(60.0), &"ack".into()));
    assert_eq!(reported, "");
}

#[test]
fn a_scene_that_is_only_looked_at_listens_to_nobody() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = taken.local_addr().expect("a port").port();
    let text = format!("[orbit]\nsource = \"live\"\nlisten = \"tcp://127.0.0.1:{port}\"\n");
    let scene = || Scene::from_toml(&text, Path::new("scene.toml")).expect("a good scene");
    let deaf = Flight::open_without_listening(scene()).expect("opens");
    assert!(deaf.live_clock().is_some());
    let rejection = Flight::open(scene())
        .err()
        .expect("the port is taken")
        .to_string();
    for part in ["scene.toml:3: [orbit] listen", "another port"] {
        assert!(rejection.contains(part), "{rejection}");
    }
}
