//! A simulation that publishes and does not wait.

use super::*;
use crate::until;
use std::net::TcpListener;
use terrella_orbit::basilisk::StepPace;

fn publish(listener: &TcpListener) -> Peer {
    let (stream, _) = listener.accept().expect("a subscriber");
    let mut peer = Peer::of(stream).greet("PUB");
    let (flags, subscription) = peer.frame().expect("a subscription");
    assert_eq!((flags, subscription), (0, vec![1]));
    peer
}

#[test]
fn steps_are_taken_as_they_come_and_a_new_publisher_is_found() {
    let listener = TcpListener::bind(crate::loopback()).expect("binds");
    let endpoint = Endpoint::Tcp(listener.local_addr().expect("bound"));
    let options = SimulationOptions::new(Meeting::Subscribe(endpoint));
    let simulation = Simulation::open(options, start()).expect("opens");
    simulation.set_pace(StepPace::Free);
    let mut peer = publish(&listener);
    for frame in 1..=50 {
        peer.send(&[b"SIM_UPDATE", &messages::step(frame, frame as f64)]);
        peer.send(&[b"SYNC_SETTINGS", b"whatever"]);
    }
    until("all have come", || simulation.counters().steps == 50);
    assert_eq!(
        simulation
            .latest()
            .expect("a step")
            .epoch
            .to_gregorian_utc()
            .0,
        2026
    );
    // Rubbish ends the connection and nothing else.
    peer.0.write_all(&[0xff; 100]).expect("writes");
    let mut peer = publish(&listener);
    peer.send(&[b"SIM_UPDATE", &messages::step(60, 60.0)]);
    until("it goes on", || simulation.counters().steps == 51);
    drop(peer);
    until("it is gone", || simulation.counters().connected == 0);
}
