//! Live feeds and simulations: every transport over the machine's own network, both modes, and everything that may go wrong on the way.

mod basilisk;
mod broadcast;
mod hostile;
mod lockstep;
mod splitting;
mod transports;

use std::io::{BufRead, BufReader, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};
use terrella_frames::{Epoch, utc_from_rfc3339};
use terrella_orbit::live::{LiveFeed, LiveOptions, Pacing, Packet, PacketKind, Transport};
use terrella_orbit::{Frame, OrbitState};

/// Longest that anything is waited for; a machine under load is slow, not wrong.
const PATIENCE: Duration = Duration::from_secs(20);

/// A free port of this machine.
fn loopback() -> SocketAddr {
    SocketAddr::from(([127, 0, 0, 1], 0))
}

fn tcp() -> LiveOptions {
    LiveOptions::new(Transport::Tcp(loopback()))
}

fn udp() -> LiveOptions {
    LiveOptions::new(Transport::Udp(loopback()))
}

fn lockstep(options: LiveOptions) -> LiveOptions {
    LiveOptions {
        pacing: Pacing::Lockstep,
        ..options
    }
}

fn open(options: LiveOptions) -> (LiveFeed, SocketAddr) {
    let feed = LiveFeed::open(options).unwrap();
    let address = feed.local_address().unwrap();
    assert_ne!(address.port(), 0);
    (feed, address)
}

fn at(t_s: f64) -> Epoch {
    let start = utc_from_rfc3339("2018-01-15T12:00:00Z").unwrap();
    start + terrella_frames::Duration::from_total_nanoseconds((t_s * 1e9).round() as i128)
}

/// A circle 400 km above the equator, `t_s` seconds after noon.
fn state(t_s: f64) -> OrbitState {
    let (radius_m, rate): (f64, f64) = (6_778_137.0, 0.001_131_367);
    let (sin, cos) = (t_s * rate).sin_cos();
    OrbitState {
        epoch: at(t_s),
        frame: Frame::Gcrf,
        position_m: glam::DVec3::new(cos, sin, 0.0) * radius_m,
        velocity_m_s: glam::DVec3::new(-sin, cos, 0.0) * radius_m * rate,
    }
}

fn packet(seq: u64, t_s: f64) -> Packet {
    Packet {
        kind: PacketKind::State,
        seq: Some(seq),
        state: state(t_s),
        name: None,
    }
}

fn frame(seq: u64, t_s: f64) -> Packet {
    Packet {
        kind: PacketKind::Frame,
        ..packet(seq, t_s)
    }
}

/// Waits until it is so.
#[track_caller]
fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < PATIENCE, "{what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn connect(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream
}

fn send_line(mut stream: &TcpStream, packet: &Packet) {
    stream.write_all(packet.to_json().as_bytes()).unwrap();
}

fn answer_line(stream: &TcpStream) -> serde_json::Value {
    let mut line = String::new();
    BufReader::with_capacity(1, stream)
        .read_line(&mut line)
        .unwrap();
    serde_json::from_str(&line).unwrap_or_else(|e| panic!("{line:?}: {e}"))
}

/// Memory of this process, KiB; `None` if the system does not report it.
fn resident_kib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    line.split_ascii_whitespace().nth(1)?.parse().ok()
}
