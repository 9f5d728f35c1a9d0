//! Any network input: no panic, no memory growth, no delayed image.

use super::*;
use std::io::Read;
use terrella_orbit::live::LiveError;
use terrella_orbit::{Feed, Freshness, OrbitError};

/// Marsaglia's xorshift: the same numbers on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
}

/// Sends `count` packets, one in twenty of them garbage or damaged, and compares the received states with those sent. Returns the growth of this
/// process's memory, in KiB, which has no meaning while other tests run in it.
fn soak(count: u64) -> u64 {
    let (feed, address) = open(LiveOptions {
        max_packets_per_s: 1_000_000,
        ..tcp()
    });
    let mut stream = connect(address);
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let (mut good, mut corrupt) = (0, 0);
    let mut after_warming = None;
    let mut slowest = Duration::ZERO;
    for seq in 0..count {
        let packet = packet(seq, seq as f64 * 0.01);
        let mut bytes = match random.next() % 2 {
            0 => packet.to_json().into_bytes(),
            _ => packet.to_bytes().unwrap().to_vec(),
        };
        if random.next().is_multiple_of(20) {
            corrupt += 1;
            let at = random.next() as usize % bytes.len();
            match random.next() % 4 {
                0 => bytes.truncate(at),
                1 => bytes.iter_mut().for_each(|b| *b = random.next() as u8),
                2 => bytes = vec![b'{'; at * 20],
                _ => bytes = vec![random.next() as u8; at],
            }
            // A line ends the damage: without it a cut line would take the next with it.
            bytes.push(b'\n');
        } else {
            good += 1;
        }
        stream.write_all(&bytes).unwrap();
        if seq % 100 == 0 {
            let begun = Instant::now();
            if let Some(epoch) = feed.playback_epoch() {
                match feed.state_at(epoch) {
                    Ok(state) => assert!(state.position_m.is_finite()),
                    // 256 states are kept, and as many may come before this thread goes on.
                    Err(OrbitError::Live(LiveError::TooOld { .. })) => {}
                    Err(error) => panic!("{error}"),
                }
            }
            slowest = slowest.max(begun.elapsed());
        }
        if seq == count / 5 {
            after_warming = resident_kib();
        }
    }
    // Damage by chance leaves a packet whole or takes a neighbour: one part in a thousand at most.
    until("nearly all states", || {
        feed.counters().taken + good / 1000 >= good
    });
    std::thread::sleep(Duration::from_millis(100));
    let counters = feed.counters();
    assert!(counters.taken <= good + good / 1000, "{counters:?}");
    assert!(counters.bad * 2 > corrupt, "{counters:?} of {corrupt}");
    assert_eq!((counters.over_rate, counters.connections), (0, 1));
    let grown_kib = match (after_warming, resident_kib()) {
        (Some(before), Some(after)) => after.saturating_sub(before),
        _ => 0,
    };
    println!(
        "{count} packets, {corrupt} corrupt: {counters:?}; memory +{grown_kib} KiB; slowest state {slowest:?}"
    );
    assert!(slowest < Duration::from_secs(1), "{slowest:?}");
    grown_kib
}

#[test]
fn a_feed_with_5_percent_garbage_goes_on() {
    soak(10_000);
}

#[test]
#[ignore = "100 000 packets, for memory; by hand: cargo xtask soak"]
fn a_long_feed_with_5_percent_garbage_keeps_its_memory() {
    let grown_kib = soak(100_000);
    assert!(grown_kib < 4096, "memory grew by {grown_kib} KiB");
}

#[test]
fn a_line_without_an_end_is_one_bad_packet() {
    let (feed, address) = open(tcp());
    let mut stream = connect(address);
    for _ in 0..100 {
        stream.write_all(&[b'{'; 40_000]).unwrap();
    }
    stream.write_all(b"\n").unwrap();
    send_line(&stream, &packet(1, 1.0));
    until("1 state", || feed.counters().taken == 1);
    assert_eq!(feed.counters().bad, 1);
    assert!(
        feed.last_fault()
            .unwrap()
            .contains("longer than 4096 bytes")
    );
}

#[test]
fn a_flood_is_dropped_and_the_picture_goes_on() {
    let (feed, address) = open(LiveOptions {
        max_packets_per_s: 100,
        ..tcp()
    });
    let stop = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
    let its = stop.clone();
    let flooder = std::thread::spawn(move || {
        let mut stream = connect(address);
        let line = packet(1, 0.5).to_json().repeat(200);
        while !its.load(std::sync::atomic::Ordering::Relaxed) {
            if stream.write_all(line.as_bytes()).is_err() {
                return;
            }
        }
    });
    until("a flood", || feed.counters().over_rate > 10_000);
    // A second simulator, within its own rate, is heard meanwhile.
    let calm = connect(address);
    let begun = Instant::now();
    for seq in 1..=20 {
        send_line(&calm, &packet(seq, seq as f64));
        until("its state", || {
            feed.newest().is_some_and(|s| s.epoch >= at(seq as f64))
        });
        feed.state_at(at(seq as f64)).unwrap();
    }
    assert!(
        begun.elapsed() < Duration::from_secs(10),
        "{:?}",
        begun.elapsed()
    );
    assert!(feed.counters().taken + feed.counters().duplicates < 10_000);
    stop.store(true, std::sync::atomic::Ordering::Relaxed);
    drop(feed);
    flooder.join().unwrap();
}

#[test]
fn silent_connections_make_room_for_one_another() {
    let (feed, address) = open(tcp());
    let simulator = connect(address);
    send_line(&simulator, &packet(1, 1.0));
    until("1 state", || feed.counters().taken == 1);
    let mut silent: Vec<_> = (0..50).map(|_| connect(address)).collect();
    // Eight of them are kept, beside those that have sent something.
    until("42 are dismissed", || feed.counters().rejected == 42);
    assert_eq!(feed.counters().connections, 51);
    assert!(matches!(silent[0].read(&mut [0]), Ok(0) | Err(_)));
    send_line(&silent[49], &packet(2, 2.0));
    send_line(&simulator, &packet(3, 3.0));
    until("3 states", || feed.counters().taken == 3);
}

#[test]
fn a_stalled_simulator_is_stale_and_comes_back() {
    let (feed, address) = open(LiveOptions {
        stale_after_s: 0.1,
        ..tcp()
    });
    let mut stream = connect(address);
    send_line(&stream, &packet(1, 1.0));
    // Stalled in the middle of a packet.
    let next = packet(2, 2.0).to_bytes().unwrap();
    stream.write_all(&next[..40]).unwrap();
    until("stale", || {
        matches!(feed.freshness(), Freshness::Stale { .. })
    });
    feed.state_at(at(20.0)).unwrap();
    stream.write_all(&next[40..]).unwrap();
    until("2 states", || feed.counters().taken == 2);
    assert_eq!(feed.counters().bad, 0);
}

#[test]
fn a_web_page_that_posts_states_is_rejected() {
    let (feed, address) = open(tcp());
    let body = packet(1, 1.0).to_json();
    let mut stream = connect(address);
    write!(
        stream,
        "POST / HTTP/1.1\r\nHost: x\r\nContent-Length: {}\r\n\r\n{body}",
        body.len()
    )
    .unwrap();
    let mut rest = Vec::new();
    let _ = stream.read_to_end(&mut rest);
    assert_eq!(rest, b"");
    until("rejected", || feed.counters().rejected == 1);
    assert_eq!(feed.counters().taken, 0);
}

#[test]
fn a_flood_of_datagrams_is_dropped_and_what_comes_after_it_is_taken() {
    let (feed, address) = open(LiveOptions {
        max_packets_per_s: 100,
        ..udp()
    });
    let socket = std::net::UdpSocket::bind(loopback()).unwrap();
    let mut random = Random(0x2545_f491_4f6c_dd1d);
    let begun = Instant::now();
    for seq in 0..20_000 {
        let mut bytes = packet(seq, seq as f64 * 1e-3).to_bytes().unwrap();
        if random.next().is_multiple_of(2) {
            bytes.iter_mut().for_each(|b| *b = random.next() as u8);
        }
        socket.send_to(&bytes, address).unwrap();
    }
    until("a flood", || feed.counters().over_rate > 10);
    let counters = feed.counters();
    let most = 100 + 100 * (begun.elapsed().as_secs() + 1);
    assert!(counters.taken + counters.bad <= most * 10, "{counters:?}");
    assert!(counters.taken <= most, "{counters:?}");
    // The system holds back what the feed did not read yet; behind it comes this.
    until("the last state", || {
        let last = packet(30_000, 30.0).to_bytes().unwrap();
        socket.send_to(&last, address).unwrap();
        feed.newest() == Some(state(30.0))
    });
}
