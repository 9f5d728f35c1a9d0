//! Garbage, floods and deaths: the viewer stays, and so does a simulation beside them.

use super::*;
use crate::{resident_kib, until};
use std::time::Duration;
use terrella_orbit::basilisk::StepPace;

/// Numbers that are the same every time.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn bytes(&mut self, len: usize) -> Vec<u8> {
        (0..len).map(|_| self.next() as u8).collect()
    }
}

fn throw(address: SocketAddr, bytes: &[u8]) {
    // It may be turned away at any byte.
    if let Ok(mut stream) = TcpStream::connect(address) {
        let _ = stream.set_write_timeout(Some(Duration::from_millis(200)));
        let _ = stream.write_all(bytes);
    }
}

#[test]
fn garbage_and_deaths_leave_it_as_it_was() {
    let (simulation, address) = open(options());
    simulation.set_pace(StepPace::Free);
    let mut good = Peer::connect(address);
    good.update(&messages::step(1, 10.0));
    let mut random = Random(7);
    for round in 0..60 {
        let len = (random.next() % 3000) as usize;
        throw(address, &random.bytes(len));
        // A greeting, and then nonsense; announced gigabytes; a death in the middle of a frame.
        let mut greeting = vec![0; 64];
        (greeting[0], greeting[9], greeting[10]) = (0xff, 0x7f, 3);
        greeting[12..16].copy_from_slice(b"NULL");
        let ready = frame(4, b"\x05READY\x0bSocket-Type\0\0\0\x03REQ");
        let tail = match round % 4 {
            0 => random.bytes(500),
            1 => vec![3, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff],
            2 => frame(1, b"SIM_UPDATE")[..5].to_vec(),
            _ => [frame(1, b""), frame(0, &random.bytes(100))].concat(),
        };
        throw(address, &[greeting, ready, tail].concat());
    }
    // Good frames with bad messages in them are answered, and counted.
    let mut peer = Peer::connect(address);
    for seed in 1..200 {
        let mut message = messages::step(seed, 10.0);
        let at = (random.next() as usize) % message.len();
        match seed % 3 {
            0 => message.truncate(at),
            1 => message[at] ^= random.next() as u8,
            _ => message = random.bytes(at),
        }
        peer.update(&message);
        peer.ask(&[b"REQUEST_INPUT"]).expect("an answer");
    }
    let counters = simulation.counters();
    assert!(counters.bad > 50 && counters.steps > 20, "{counters:?}");
    // The strangers have not displaced the one that was idle meanwhile.
    good.update(&messages::step(2, 20.0));
    assert_eq!(simulation.latest().expect("a step").frame_number, 2);
}

#[test]
fn a_flood_takes_no_memory_and_stops_nobody() {
    let (simulation, address) = open(options());
    simulation.set_pace(StepPace::Free);
    let mut good = Peer::connect(address);
    good.update(&messages::step(1, 10.0));
    let before_kib = resident_kib();
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(move || {
                // Asks on and on and reads nothing.
                let peer = Peer::connect(address);
                let timeout = Some(Duration::from_millis(300));
                peer.0.set_write_timeout(timeout).expect("sets");
                let flood = [
                    frame(1, b""),
                    frame(1, b"SIM_UPDATE"),
                    frame(1, b""),
                    frame(1, b""),
                    frame(0, &messages::step(7, 70.0)),
                ];
                let flood = flood.concat().repeat(100);
                let begun = std::time::Instant::now();
                let mut stream = &peer.0;
                while begun.elapsed() < Duration::from_secs(2) && stream.write_all(&flood).is_ok() {
                }
            });
        }
        scope.spawn(move || {
            for _ in 0..200 {
                throw(address, b"");
                std::thread::sleep(Duration::from_millis(5));
            }
        });
        // Meanwhile the good one goes on.
        for frame in 2..200 {
            good.update(&messages::step(frame, 10.0 * frame as f64));
            std::thread::sleep(Duration::from_millis(5));
        }
    });
    if let (Some(before), Some(after)) = (before_kib, resident_kib()) {
        assert!(after < before + 150_000, "{before} KiB, then {after} KiB");
    }
    until("they are gone", || simulation.counters().connected <= 1);
    good.update(&messages::step(1000, 1e4));
    assert_eq!(simulation.latest().expect("a step").frame_number, 1000);
}

/// Whether the peer has closed the connection; waits a little for it.
fn is_closed(peer: &mut Peer, patience: Duration) -> bool {
    peer.0.set_read_timeout(Some(patience)).expect("sets");
    matches!(peer.0.read(&mut [0]), Ok(0))
}

#[test]
fn of_more_simulators_than_there_is_room_for_the_longest_silent_leaves() {
    let (simulation, address) = open(options());
    simulation.set_pace(StepPace::Free);
    let mut peers: Vec<_> = (0..5)
        .map(|_| {
            let mut peer = Peer::connect(address);
            peer.ask(&[b"PING"]).expect("an answer");
            std::thread::sleep(Duration::from_millis(5));
            peer
        })
        .collect();
    assert!(is_closed(&mut peers[0], PATIENCE), "the first is kept");
    until("4 are there", || simulation.counters().connected == 4);
    for (frame, peer) in (1..).zip(&mut peers[1..]) {
        peer.update(&messages::step(frame, 10.0));
    }
}

#[test]
fn connections_that_ask_nothing_leave_a_simulator_alone() {
    let (simulation, address) = open(options());
    simulation.set_pace(StepPace::Drawn);
    let mut simulator = Peer::connect(address);
    simulator.ask(&[b"PING"]).expect("an answer");
    // Six that are silent, six that greet, six with invalid requests: more than are kept of each.
    let _silent: Vec<_> = (0..6).map(|_| TcpStream::connect(address)).collect();
    let _greeted: Vec<_> = (0..6).map(|_| Peer::connect(address)).collect();
    let _strangers: Vec<_> = (0..6)
        .map(|_| {
            let mut peer = Peer::connect(address);
            peer.ask(&[b"WHAT"]).expect("an answer");
            peer
        })
        .collect();
    assert_eq!(
        simulation.counters().connected,
        1,
        "who asks nothing counts"
    );
    // While it waits for its step more come, and while it waits for nothing.
    simulator.send(&[b"", b"SIM_UPDATE", b"", b"", &messages::step(1, 10.0)]);
    let step = simulation.next_step(PATIENCE).expect("a step");
    let _more: Vec<_> = (0..6).map(|_| Peer::connect(address)).collect();
    assert!(step.drawn());
    assert_eq!(simulator.receive().expect("an answer")[1], b"OK");
    let mut late = Peer::connect(address);
    assert!(!is_closed(&mut simulator, Duration::from_millis(1500)));
    simulation.set_pace(StepPace::Free);
    simulator.update(&messages::step(2, 20.0));
    late.update(&messages::step(3, 30.0));
}
