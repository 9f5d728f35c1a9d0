//! However this side ends, every waiting peer gets a reply, and the connection ends with a reply and not before.

use super::*;
use crate::until;
use std::time::{Duration, Instant};
use terrella_orbit::basilisk::StepPace;

/// Lets a simulator wait for a picture, does something, and gives what the simulator got and whether the connection ended then.
fn while_a_picture_is_waited_for(
    options: SimulationOptions,
    end: impl FnOnce(Simulation),
) -> (Option<Vec<Vec<u8>>>, bool, Duration) {
    let (simulation, address) = open(options);
    simulation.set_pace(StepPace::Free);
    let painter = simulation.painter();
    painter.is_ready();
    std::mem::forget(painter);
    let waiting = std::thread::spawn(move || {
        let mut peer = Peer::connect(address);
        peer.update(&messages::step(1, 10.0));
        let begun = Instant::now();
        let answer = peer.ask(&[b"REQUEST_IMAGE_1"]);
        let took = begun.elapsed();
        peer.0
            .set_read_timeout(Some(Duration::from_millis(500)))
            .expect("sets");
        let is_closed = matches!(peer.0.read(&mut [0]), Ok(0));
        (answer, is_closed, took)
    });
    {
        // Taken, and never drawn.
        let request = simulation.next_picture(PATIENCE).expect("asked");
        std::mem::forget(request);
    }
    end(simulation);
    waiting.join().expect("no panic")
}

fn none() -> Option<Vec<Vec<u8>>> {
    Some(vec![vec![0; 4], vec![]])
}

#[test]
fn a_drop_answers_and_then_closes() {
    let (answer, is_closed, _) = while_a_picture_is_waited_for(options(), drop);
    assert_eq!((answer, is_closed), (none(), true));
}

#[test]
fn an_interrupt_answers_while_the_program_is_busy() {
    let (answer, is_closed, _) = while_a_picture_is_waited_for(options(), |simulation| {
        // The handler's thread; the main one is in the middle of something long.
        let stop = simulation.stopper();
        std::thread::spawn(stop).join().expect("no panic");
        std::thread::sleep(Duration::from_millis(700));
        drop(simulation);
    });
    assert_eq!((answer, is_closed), (none(), true));
}

#[test]
fn a_panic_answers() {
    let (answer, is_closed, _) = while_a_picture_is_waited_for(options(), |simulation| {
        let broken = std::thread::spawn(move || {
            let _simulation = simulation;
            panic!("the main thread breaks (this is a test)");
        });
        assert!(broken.join().is_err());
    });
    assert_eq!((answer, is_closed), (none(), true));
}

#[test]
fn a_painter_that_breaks_answers_and_the_connection_stays() {
    let (simulation, address) = open(options());
    simulation.set_pace(StepPace::Free);
    std::thread::scope(|scope| {
        let painter = scope.spawn(|| {
            let painter = simulation.painter();
            painter.is_ready();
            let _request = simulation.next_picture(PATIENCE).expect("asked");
            panic!("the painter breaks (this is a test)");
        });
        until("somebody draws", || {
            let mut peer = Peer::connect(address);
            peer.update(&messages::step(1, 10.0));
            assert!(peer.picture(1).is_empty());
            painter.is_finished()
        });
        assert!(painter.join().is_err());
        // And on.
        let mut peer = Peer::connect(address);
        peer.update(&messages::step(2, 20.0));
        assert!(peer.picture(1).is_empty());
        peer.update(&messages::step(3, 30.0));
    });
}

#[test]
fn time_answers() {
    let timeout = Duration::from_millis(300);
    let options = SimulationOptions {
        timeout,
        ..options()
    };
    let (answer, is_closed, took) = while_a_picture_is_waited_for(options, |simulation| {
        std::thread::sleep(Duration::from_millis(1500));
        drop(simulation);
    });
    assert_eq!(answer, none());
    assert!(took >= timeout && took < Duration::from_secs(5), "{took:?}");
    // It was still there half a second later.
    assert!(!is_closed);
}

#[test]
fn a_step_that_waits_is_answered_too() {
    let (simulation, address) = open(options());
    simulation.set_pace(StepPace::Drawn);
    let waiting = std::thread::spawn(move || {
        let mut peer = Peer::connect(address);
        peer.update(&messages::step(1, 10.0));
        peer.receive()
    });
    until("it waits", || simulation.counters().steps == 1);
    drop(simulation);
    assert_eq!(waiting.join().expect("no panic"), None);
}

#[test]
fn one_that_asks_on_is_answered_once_more_and_sees_the_end_with_the_answer() {
    let (simulation, address) = open(options());
    simulation.set_pace(StepPace::Free);
    let mut peer = Peer::connect(address);
    peer.update(&messages::step(1, 10.0));
    let ends = std::thread::spawn(move || drop(simulation));
    std::thread::sleep(Duration::from_millis(200));
    // Within the second in which an idle simulator is still listened to.
    peer.update(&messages::step(2, 20.0));
    assert_eq!(peer.receive(), None, "it goes on after its end");
    ends.join().expect("no panic");
    // A peer without a request delays nothing.
    let (simulation, address) = open(options());
    let mut idle = Peer::connect(address);
    idle.ask(&[b"PING"]).expect("an answer");
    until("it is there", || simulation.counters().connected == 1);
    let begun = Instant::now();
    drop(simulation);
    assert!(
        begun.elapsed() < Duration::from_secs(5),
        "{:?}",
        begun.elapsed()
    );
}
