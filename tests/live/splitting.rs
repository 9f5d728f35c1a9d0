//! Streams cut into packets, however they arrive.

use super::*;
use terrella_orbit::live::{PacketFault, Splitter};

fn all(splitter: &mut Splitter) -> (Vec<u64>, Vec<PacketFault>) {
    let (mut good, mut bad) = (Vec::new(), Vec::new());
    while let Some(received) = splitter.next() {
        match received.packet {
            Ok(packet) => good.push(packet.seq.unwrap()),
            Err(fault) => bad.push(fault),
        }
    }
    (good, bad)
}

#[test]
fn a_wrong_piece_costs_itself_only() {
    let json = |seq| packet(seq, seq as f64).to_json().into_bytes();
    let binary = |seq| packet(seq, seq as f64).to_bytes().unwrap().to_vec();
    let mut corrupt = binary(9);
    corrupt[40] ^= 1;
    let mut wrong_frame = packet(9, 9.0).to_bytes().unwrap().to_vec();
    wrong_frame[24] = 200;
    let pieces: [(&str, Vec<u8>); 8] = [
        ("text", b"hello world\n".to_vec()),
        ("zeros", vec![0; 1000]),
        ("half a line", json(9)[..60].to_vec()),
        ("half a packet", binary(9)[..50].to_vec()),
        ("a changed bit", corrupt),
        ("magic", b"\x89TRL".to_vec()),
        ("a wrong field", b"{\"epoch\":1}\n".to_vec()),
        ("a brace", b"{".to_vec()),
    ];
    for (what, piece) in pieces {
        let mut bytes = [json(1), binary(2)].concat();
        bytes.extend(&piece);
        bytes.extend([binary(3), json(4)].concat());
        for step in [1, 7, bytes.len()] {
            let mut splitter = Splitter::default();
            let (mut good, mut bad) = (Vec::new(), Vec::new());
            for chunk in bytes.chunks(step) {
                splitter.push(chunk);
                let (more, worse) = all(&mut splitter);
                good.extend(more);
                bad.extend(worse);
            }
            assert_eq!(good, [1, 2, 3, 4], "{what} by {step}: {bad:?}");
            assert!((1..=3).contains(&bad.len()), "{what} by {step}: {bad:?}");
            assert_eq!(splitter.waiting(), 0, "{what} by {step}");
        }
    }
}

#[test]
fn lines_without_an_end_are_not_kept() {
    let mut splitter = Splitter::default();
    let mut faults = 0;
    for _ in 0..1000 {
        splitter.push(&[b'{'; 8192]);
        faults += all(&mut splitter).1.len();
        assert!(splitter.waiting() <= 4096, "{}", splitter.waiting());
    }
    assert_eq!(faults, 1, "one line is one fault");
    splitter.push(b"\n");
    splitter.push(packet(1, 1.0).to_json().as_bytes());
    assert_eq!(all(&mut splitter).0, [1]);
}
