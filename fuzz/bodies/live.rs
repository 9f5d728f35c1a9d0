//! Packets from simulators, alone and in a stream.

use terrella_orbit::live::{MAX_PACKET_BYTES, Packet, Splitter};

/// Reads any bytes as one packet of either form and as a stream. An accepted packet must be finite and equal bit for bit after it is written and
/// read again. A stream must give the same packets in one piece and in many, and buffer at most one packet.
pub fn run(data: &[u8]) {
    for packet in [Packet::from_json(data), Packet::from_bytes(data)] {
        match packet {
            Ok(packet) => comes_back(&packet),
            Err(fault) => assert!(!fault.to_string().is_empty()),
        }
    }
    let whole = packets(data, data.len().max(1));
    assert_eq!(whole, packets(data, 7));
    whole.iter().for_each(comes_back);
}

fn packets(data: &[u8], step: usize) -> Vec<Packet> {
    let mut splitter = Splitter::default();
    let mut good = Vec::new();
    for chunk in data.chunks(step) {
        splitter.push(chunk);
        while let Some(received) = splitter.next() {
            good.extend(received.packet);
        }
        assert!(splitter.waiting() <= MAX_PACKET_BYTES);
    }
    while let Some(received) = splitter.finish() {
        good.extend(received.packet);
    }
    assert_eq!(splitter.waiting(), 0);
    good
}

fn comes_back(packet: &Packet) {
    let state = &packet.state;
    assert!(state.position_m.is_finite() && state.velocity_m_s.is_finite());
    let json = packet.to_json();
    assert_eq!(
        Packet::from_json(json.as_bytes()).as_ref(),
        Ok(packet),
        "{json}"
    );
    // The binary form has no names, and stores 0 where there is no sequence number.
    let mut nameless = packet.clone();
    nameless.name = None;
    nameless.seq = Some(packet.seq.unwrap_or_default());
    let bytes = packet
        .to_bytes()
        .expect("dates that are read can be written");
    assert_eq!(Packet::from_bytes(&bytes), Ok(nameless));
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    use terrella_orbit::{Frame, OrbitState};
    let line = br#"{"message":"frame","seq":1,"name":"Sonde","epoch":"2018-01-15T12:00:00.000Z","frame":"GCRF","position_m":[6778136.3,-1e-3,0],"velocity_m_s":[0,7668.6,0]}"#;
    let packet = Packet::from_json(line).expect("a good line");
    let mut seeds = vec![line.to_vec()];
    for frame in Frame::ALL {
        let state = OrbitState {
            frame,
            ..packet.state
        };
        let packet = Packet {
            state,
            ..packet.clone()
        };
        let binary = packet.to_bytes().expect("a date of this century").to_vec();
        let both = [
            packet.to_json().into_bytes(),
            binary.clone(),
            binary.clone(),
        ]
        .concat();
        seeds.extend([binary, both]);
    }
    seeds
}
