//! Basilisk: messages, connections and saved simulations.

use std::io::{self, Read, Write};
use terrella_orbit::basilisk::{Message, World, ZmtpConnection};

#[path = "../../tests/common/basilisk.rs"]
mod messages;

/// Reads any bytes as one message, as the messages of a saved simulation, and as the input of a connection. Accepted values must be finite. A
/// connection returns no more bytes than its limit.
pub fn run(data: &[u8]) {
    let mut world = World::new(terrella::Epoch::default());
    take(&mut world, data);
    // Messages one after the other, each after its length, as in files.
    let mut rest = data;
    while let Some((&len, after)) = rest.split_first() {
        let (message, after) = after.split_at(usize::from(len).min(after.len()));
        take(&mut world, message);
        rest = after;
    }
    if let Ok(mut connection) = ZmtpConnection::greet(Peer(data), "REP", &["REQ"], MOST, &|| false)
    {
        while let Ok(frames) = connection.receive(&|| false) {
            let bytes: usize = frames.iter().map(Vec::len).sum();
            assert!(bytes <= MOST && frames.len() <= 16);
            for frame in &frames {
                take(&mut world, frame);
            }
        }
    }
    saved(data);
}

/// The largest size of a message, bytes.
const MOST: usize = 4096;

fn take(world: &mut World, bytes: &[u8]) {
    let Ok(message) = Message::read(bytes) else {
        return;
    };
    let Ok(snapshot) = world.take(message) else {
        return;
    };
    assert!(snapshot.sun_m.is_finite() && snapshot.moon_m.is_finite());
    assert!(snapshot.itrf_from_gcrf.is_finite());
    for craft in &snapshot.craft {
        assert!(craft.position_m.is_finite() && craft.velocity_m_s.is_finite());
        assert!(craft.inertial_from_body.is_normalized());
        for camera in snapshot.cameras.iter() {
            if let Some(pose) = terrella_orbit::basilisk::camera_pose(camera, craft) {
                assert!(pose.forward.is_normalized() && pose.up.is_normalized());
                assert!(pose.forward.dot(pose.up).abs() < 1e-9);
            }
        }
    }
    for place in snapshot.places.iter() {
        assert!(place.position_itrf_m.is_finite() && place.up.is_finite());
    }
    assert!(world.notes().len() <= 64);
}

/// Reads the bytes as a saved file and plays it from start to end.
fn saved(data: &[u8]) {
    use terrella_orbit::basilisk::Recording;
    let file = io::Cursor::new(data.to_vec());
    let start = terrella::Epoch::default();
    let Ok(recording) = Recording::read(file, "fuzz".as_ref(), start, None) else {
        return;
    };
    let (first, last) = recording.validity();
    for part in [0.0, 0.5, 1.0] {
        let epoch = first + (last - first) * part;
        // A message may be corrupt inside; that is reported as an error.
        let _ = recording.snapshot_at(epoch);
    }
}

/// A peer that sends these bytes and accepts any reply.
struct Peer<'d>(&'d [u8]);

impl Read for Peer<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl Write for Peer<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    let steps: Vec<_> = (1..=3)
        .map(|n| messages::step(n, 10.0 * n as f64))
        .collect();
    let mut greeting = vec![0; 64];
    (greeting[0], greeting[9], greeting[10], greeting[11]) = (0xff, 0x7f, 3, 1);
    greeting[12..16].copy_from_slice(b"NULL");
    let ready = b"\x05READY\x0bSocket-Type\0\0\0\x03REQ\x08Identity\0\0\0\0";
    let frame = |flags: u8, body: &[u8]| {
        let len = (body.len() as u64).to_be_bytes();
        [&[flags | 2], len.as_slice(), body].concat()
    };
    let update = [
        frame(1, b""),
        frame(1, b"SIM_UPDATE"),
        frame(1, b""),
        frame(1, b""),
        frame(0, &steps[0]),
    ];
    let connection = [greeting, frame(4, ready), update.concat(), update.concat()];
    vec![
        steps[0].clone(),
        steps[1].clone(),
        messages::file(&steps),
        connection.concat(),
    ]
}
