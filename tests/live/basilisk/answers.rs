//! Replies to each request, and their timing.

use super::*;
use crate::until;
use std::time::Duration;
use terrella_orbit::Feed;
use terrella_orbit::basilisk::StepPace;

#[test]
fn requests_are_answered_as_basilisk_expects() {
    let (simulation, address) = open(options());
    simulation.set_pace(StepPace::Free);
    let mut peer = Peer::connect(address);
    for _ in 0..2 {
        assert_eq!(peer.ask(&[b"PING"]).expect("an answer").len(), 1);
    }
    peer.update(&messages::step(1, 10.0));
    let input = peer.ask(&[b"REQUEST_INPUT"]).expect("an answer");
    assert_eq!(input, [b"VIZARD_INPUT".to_vec(), vec![0x08, 1]]);
    peer.update(&messages::step(300, 20.0));
    let input = peer.ask(&[b"REQUEST_INPUT"]).expect("an answer");
    assert_eq!(input[1], [0x08, 0xac, 0x02]);
    // Nobody draws; and there is no camera 9.
    for id in [1, 9] {
        assert!(peer.picture(id).is_empty());
    }
    assert_eq!(peer.ask(&[b"WHAT"]), Some(vec![b"ERROR".to_vec()]));
    assert_eq!(peer.ask(&[]), Some(vec![b"ERROR".to_vec()]));
    let latest = simulation.latest().expect("a step");
    assert_eq!((latest.frame_number, latest.craft.len()), (300, 2));
    let counters = simulation.counters();
    assert_eq!((counters.steps, counters.no_pictures), (2, 2));
    let feed = simulation.craft_feed(Some("sat-1"));
    let state = feed.state_at(latest.epoch).expect("known");
    assert_eq!(state.position_m, latest.craft[0].position_m);
    assert!(feed.state_at(start()).is_err());
}

/// The settings of a script that listens to keys.
fn listening(frame: u64, keys: &str) -> Vec<u8> {
    let settings = messages::bytes(52, keys.as_bytes());
    let parts = [
        messages::earth([0.0; 3], [0.0; 3], 0.0),
        messages::bytes(7, &settings),
    ];
    messages::message(frame, frame as f64, &parts)
}

#[test]
fn keys_are_passed_to_the_script_that_listens_to_them() {
    let (simulation, address) = open(options());
    simulation.set_pace(StepPace::Free);
    let input = |peer: &mut Peer| peer.ask(&[b"REQUEST_INPUT"]).expect("an answer")[1].clone();
    let mut deaf = Peer::connect(address);
    deaf.update(&messages::step(1, 10.0));
    assert_eq!(simulation.press('b'), None);
    let mut peer = Peer::connect(address);
    peer.update(&listening(1, "bé"));
    assert_eq!(simulation.heard_keys(), "bé");
    let reported = ['B', 'é', 'x'].map(|key| simulation.press(key));
    assert_eq!(reported, [Some('b'), Some('é'), None]);
    assert_eq!(input(&mut deaf), [0x08, 1]);
    assert_eq!(input(&mut peer), b"\x08\x01\x12\x05\x0a\x03b\xc3\xa9");
    // Once.
    assert_eq!(input(&mut peer), [0x08, 1]);
    // Settings come only at first; the keys stay.
    peer.update(&messages::step(2, 20.0));
    assert_eq!(simulation.press('b'), Some('b'));
    peer.update(&listening(3, ""));
    assert_eq!(simulation.press('b'), None);
}

#[test]
fn a_picture_is_of_the_step_just_received() {
    let (simulation, address) = open(options());
    simulation.set_pace(StepPace::Free);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let painter = simulation.painter();
            painter.is_ready();
            for _ in 0..20 {
                let request = simulation.next_picture(PATIENCE).expect("asked");
                let file = format!("{} {}", request.snapshot.frame_number, request.camera.id);
                assert!(request.answer(file.into_bytes()));
            }
        });
        let peers = [Peer::connect(address), Peer::connect(address)];
        for (peer, offset) in peers.into_iter().zip([1, 1001]) {
            scope.spawn(move || {
                let mut peer = peer;
                for frame in offset..offset + 10 {
                    peer.update(&messages::step(frame, frame as f64));
                    let file = peer.picture(1);
                    // Until the painter is there pictures are rejected.
                    let wanted = format!("{frame} 1").into_bytes();
                    assert!(file == wanted || file.is_empty(), "{file:?}");
                }
            });
        }
        until("all are drawn", || {
            let counters = simulation.counters();
            counters.pictures + counters.no_pictures == 20
        });
        // Requests from before the painter are repeated, so that it ends.
        let mut peer = Peer::connect(address);
        peer.update(&messages::step(1, 1.0));
        for _ in 0..simulation.counters().no_pictures {
            peer.picture(1);
        }
    });
    assert_eq!(simulation.counters().pictures, 20);
}

#[test]
fn a_step_that_is_to_be_drawn_is_answered_when_it_is() {
    let (simulation, address) = open(options());
    let peer = std::thread::spawn(move || {
        let mut peer = Peer::connect(address);
        for frame in 1..=30 {
            peer.update(&messages::step(frame, frame as f64));
        }
        peer
    });
    // Nothing is lost while it is undecided whether steps are drawn.
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(simulation.counters().steps, 1);
    simulation.set_pace(StepPace::Drawn);
    for frame in 1..=30 {
        let step = simulation.next_step(PATIENCE).expect("a step");
        assert_eq!(step.snapshot.frame_number, frame);
        assert_eq!(simulation.counters().steps, frame as u64);
        assert!(step.drawn());
        assert!(!step.drawn(), "it is drawn once");
    }
    drop(peer.join().expect("no panic"));
    until("it has left", || simulation.counters().connected == 0);
}

#[test]
fn a_simulation_that_goes_on_with_another_connection_need_not_say_its_epoch_again() {
    let (simulation, address) = open(options());
    simulation.set_pace(StepPace::Free);
    let mut peer = Peer::connect(address);
    peer.update(&messages::step(1, 10.0));
    drop(peer);
    until("it has left", || simulation.counters().connected == 0);
    // No PING, no epoch, no places.
    let mut peer = Peer::connect(address);
    peer.update(&messages::step(2, 20.0));
    let latest = simulation.latest().expect("a step");
    assert_eq!(latest.epoch.to_gregorian_utc().0, 2026);
    assert_eq!(latest.places.len(), 1);
    assert!(simulation.notes().is_empty(), "{:?}", simulation.notes());
}

#[test]
fn a_simulation_may_end_its_viewer() {
    let (simulation, address) = open(options());
    simulation.set_pace(StepPace::Free);
    let mut peer = Peer::connect(address);
    peer.update(&messages::step(1, 10.0));
    assert!(!simulation.is_over());
    let settings = messages::bytes(10, &messages::whole(3, 1));
    peer.update(&[messages::step(2, 20.0), settings].concat());
    assert!(simulation.is_over());
}

/// Steps without images per second, over the local network; printed, and far above the requirement.
#[test]
fn steps_go_by_quickly() {
    let (simulation, address) = open(options());
    simulation.set_pace(StepPace::Free);
    let mut peer = Peer::connect(address);
    let begun = std::time::Instant::now();
    for frame in 1..=2000 {
        peer.update(&messages::step(frame, frame as f64));
        peer.ask(&[b"REQUEST_INPUT"]).expect("an answer");
    }
    let per_s = 2000.0 / begun.elapsed().as_secs_f64();
    let counters = simulation.counters();
    println!(
        "{per_s:.0} steps a second, the slowest {} µs",
        counters.slowest_step_us
    );
    assert!(per_s > 50.0, "{per_s}");
}
