//! Nobody waits: packets that are lost, late, doubled or out of order, and a feed that is silent.

use super::*;
use std::net::UdpSocket;
use terrella_orbit::live::Extrapolation;
use terrella_orbit::{Feed, Freshness};

fn send(socket: &UdpSocket, to: SocketAddr, packet: &Packet) {
    socket.send_to(&packet.to_bytes().unwrap(), to).unwrap();
}

#[test]
fn lost_late_doubled_and_swapped_packets_leave_a_smooth_path() {
    let (feed, address) = open(udp());
    let socket = UdpSocket::bind(loopback()).unwrap();
    // 0…99 at 0.1 s; every seventh is lost, neighbours are swapped in threes, every fifth comes twice.
    let mut order: Vec<u64> = (0..100).filter(|seq| seq % 7 != 3).collect();
    for three in order.chunks_mut(3) {
        three.reverse();
    }
    let sent = order.len() as u64;
    let mut doubled = 0;
    for &seq in &order {
        send(&socket, address, &packet(seq, seq as f64 * 0.1));
        if seq % 5 == 0 {
            doubled += 1;
            send(&socket, address, &packet(seq, seq as f64 * 0.1));
        }
    }
    let all = || feed.counters().taken + feed.counters().duplicates;
    until("all packets", || all() == sent + doubled);
    let counters = feed.counters();
    assert_eq!((counters.taken, counters.duplicates), (sent, doubled));
    assert_eq!(counters.bad + counters.too_late + counters.apart, 0);
    assert!(counters.late >= sent / 2, "{counters:?}");
    // 14 of 100 were not sent, the first three in reversed order begin the count.
    assert!((12..=14).contains(&counters.lost), "{counters:?}");
    for k in 0..990 {
        let t_s = f64::from(k) * 0.01;
        let got = feed.state_at(at(t_s)).unwrap();
        let off_m = (got.position_m - state(t_s).position_m).length();
        // The cubic over a gap of 0.2 s.
        assert!(off_m < 1e-6, "{off_m} m at {t_s} s");
    }
    // Before the first state nothing is known.
    let error = feed.state_at(at(-1.0)).unwrap_err().to_string();
    assert!(error.contains("oldest state"), "{error}");
}

#[test]
fn a_silent_feed_goes_on_stale_and_then_says_so() {
    let (feed, address) = open(LiveOptions {
        stale_after_s: 1.0,
        extrapolation_limit_s: 30.0,
        ..tcp()
    });
    let stream = connect(address);
    send_line(&stream, &packet(1, 0.0));
    until("1 state", || feed.counters().taken == 1);
    until(
        "stale",
        || matches!(feed.freshness(), Freshness::Stale { age_s } if age_s > 1.0),
    );
    let got = feed.state_at(at(30.0)).unwrap();
    // The circle's rate is rounded: 9 digits of it.
    assert!((got.position_m - state(30.0).position_m).length() < 0.1);
    assert!(got.epoch == at(30.0) && got.frame == Frame::Gcrf);
    let error = feed.state_at(at(30.1)).unwrap_err().to_string();
    for part in [
        "2018-01-15T12:00:30.100Z",
        "2018-01-15T12:00:00.000Z",
        "for 30 s only",
        "extrapolation_limit_s",
    ] {
        assert!(error.contains(part), "{error}");
    }
    send_line(&stream, &packet(2, 10.0));
    until("2 states", || feed.counters().taken == 2);
    assert_eq!(feed.freshness(), Freshness::Live);
    feed.state_at(at(30.1)).unwrap();
}

#[test]
fn what_does_not_fall_goes_straight_on() {
    let (feed, address) = open(LiveOptions {
        extrapolation: Extrapolation::Linear,
        ..tcp()
    });
    send_line(&connect(address), &packet(1, 0.0));
    until("1 state", || feed.counters().taken == 1);
    let begun = state(0.0);
    let expected = begun.position_m + begun.velocity_m_s * 10.0;
    assert_eq!(feed.state_at(at(10.0)).unwrap().position_m, expected);
}

#[test]
fn the_playback_follows_the_simulator_at_its_delay() {
    let (feed, address) = open(LiveOptions {
        rate: 10.0,
        playback_delay_s: 0.2,
        extrapolation_limit_s: 5.0,
        ..tcp()
    });
    assert_eq!(feed.playback_epoch(), None);
    let stream = connect(address);
    let begun = Instant::now();
    let mut last_s = 0.0;
    for seq in 0..40 {
        last_s = begun.elapsed().as_secs_f64() * 10.0;
        send_line(&stream, &packet(seq, last_s));
        until("it", || feed.counters().taken == seq + 1);
        let before_s = begun.elapsed().as_secs_f64() * 10.0;
        let shown_s = (feed.playback_epoch().unwrap() - at(0.0)).to_seconds();
        let after_s = begun.elapsed().as_secs_f64() * 10.0;
        // Ten times real time, 0.2 s late: 2 s behind, plus the latency of the fastest packet. Earlier it stays at the first state.
        if last_s > 3.0 {
            assert!(shown_s < after_s - 2.0 + 1e-6, "{shown_s} at {after_s}");
            assert!(shown_s > before_s - 2.0 - 3.0, "{shown_s} at {before_s}");
        }
        feed.state_at(feed.playback_epoch().unwrap()).unwrap();
        std::thread::sleep(Duration::from_millis(15));
    }
    // Silent: it stays at the limit, where there still is a state.
    until("the limit", || {
        feed.playback_epoch().unwrap() >= at(last_s + 4.999)
    });
    std::thread::sleep(Duration::from_millis(200));
    let shown = feed.playback_epoch().unwrap();
    assert!((shown - at(last_s)).to_seconds() < 5.001);
    feed.state_at(shown).unwrap();
}

#[test]
fn a_simulator_that_begins_anew_is_followed() {
    let (feed, address) = open(tcp());
    for (run, start_s) in [0.0, 86_400.0, -3600.0, 0.0].into_iter().enumerate() {
        // Killed at the end of each run, in the middle of a line.
        let mut stream = connect(address);
        for seq in 0..10 {
            send_line(&stream, &packet(seq, start_s + seq as f64 * 0.1));
        }
        stream.write_all(b"{\"epoch\":\"2018").unwrap();
        drop(stream);
        let runs = run as u64 + 1;
        until("all states", || {
            feed.counters().taken + feed.counters().apart == 10 * runs
        });
        until("the cut line", || feed.counters().bad == runs);
        assert_eq!(feed.counters().restarts, run as u64);
        assert_eq!(
            feed.state_at(at(start_s + 0.9)).unwrap(),
            state(start_s + 0.9)
        );
    }
    assert_eq!(feed.counters().connections, 4);
}

#[test]
fn one_wild_epoch_does_not_move_the_picture() {
    let (feed, address) = open(tcp());
    let stream = connect(address);
    for seq in 0..10 {
        send_line(&stream, &packet(seq, seq as f64));
        send_line(&stream, &packet(seq, 1e7 * (seq as f64 + 1.0)));
    }
    until("all", || {
        feed.counters().taken + feed.counters().apart == 20
    });
    assert_eq!(feed.counters().restarts, 0);
    assert_eq!(feed.newest().unwrap(), state(9.0));
}
