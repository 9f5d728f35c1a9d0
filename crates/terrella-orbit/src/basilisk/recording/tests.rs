use super::index::MAX_NOTED;
use super::*;

use crate::basilisk::messages;

fn start() -> Epoch {
    "2018-01-15T12:00:00Z".parse().expect("a date")
}

/// A file of these bytes that is gone with the test.
struct Saved(PathBuf);

impl Drop for Saved {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn saved(name: &str, bytes: &[u8]) -> Saved {
    let path = std::env::temp_dir().join(format!("terrella-{name}-{}.bin", std::process::id()));
    std::fs::write(&path, bytes).expect("writes");
    Saved(path)
}

fn open(saved: &Saved) -> Result<Recording, RecordingError> {
    Recording::open(&saved.0, start(), None)
}

fn flight(count: u64) -> Vec<Vec<u8>> {
    (1..=count)
        .map(|frame| messages::step(frame, 10.0 * frame as f64))
        .collect()
}

#[test]
fn a_file_is_played_where_it_is_asked_for() {
    let file = saved("played", &messages::file(&flight(100)));
    let recording = Arc::new(open(&file).expect("opens"));
    let craft = RecordedCraft::new(Arc::clone(&recording), None);
    let (first, last) = craft.validity();
    assert_eq!((last - first).to_seconds(), 990.0);
    assert_eq!((craft.name(), recording.messages()), ("sat-1", 100));
    assert!(recording.notes().is_empty(), "{:?}", recording.notes());
    // To and fro, at messages and between them.
    for elapsed_s in [10.0, 1000.0, 505.0, 500.0, 12.5, 999.9] {
        let epoch = recording.at(elapsed_s);
        let state = craft.state_at(epoch).expect("known");
        let (s, c) = (elapsed_s * 0.001_f64).sin_cos();
        let off_m = (state.position_m - 7e6 * glam::DVec3::new(c, s, 0.0)).length();
        assert!(off_m < 1e-3, "{off_m} m at {elapsed_s} s");
        // Said once, in the first message.
        let snapshot = recording.snapshot_at(epoch).expect("reads").expect("known");
        assert_eq!(snapshot.places.len(), 1);
    }
    let outside = craft.state_at(last + seconds(1.0)).expect_err("unknown");
    assert!(
        outside.to_string().contains("2026-03-20T15:02:40"),
        "{outside}"
    );
}

#[test]
fn a_corrupt_file_is_played_up_to_where_it_is_corrupt() {
    let good = messages::file(&flight(10));
    let tails: [&[u8]; 5] = [
        // A length without its message, one message's as Basilisk writes with noDisplay.
        &[0xb0, 3, 0xb0, 3, 0xb0, 3],
        // Longer than the file, longer than a message may be, no length at all.
        &[0xff, 0x7f, 1, 2, 3],
        &[0xff, 0xff, 0xff, 0xff, 0x7f],
        &[0xff; 11],
        // A message without a time.
        &[0],
    ];
    for tail in tails {
        let file = saved("corrupt", &[good.as_slice(), tail].concat());
        let recording = open(&file).expect("opens");
        assert_eq!(recording.messages(), 10);
        let notes = recording.notes().join("\n");
        assert!(notes.contains(&format!("byte {}", good.len())), "{notes}");
        assert!(
            recording
                .snapshot_at(recording.at(100.0))
                .expect("reads")
                .is_some()
        );
    }
    // Cut anywhere: what is whole is played.
    let first = messages::file(&flight(1)).len();
    for cut in 1..good.len() {
        let file = saved("cut", &good[..cut]);
        match open(&file) {
            Ok(recording) => assert!(recording.messages() <= 10),
            Err(RecordingError::Empty { .. }) => assert!(cut < first),
            Err(error) => panic!("{cut}: {error}"),
        }
    }
    let back = messages::file(&[flight(10), flight(3)].concat());
    assert_eq!(open(&saved("back", &back)).expect("opens").messages(), 10);
    for empty in [b"".as_slice(), b"hello, world", &[0; 100]] {
        let rejected = open(&saved("empty", empty));
        assert!(matches!(rejected, Err(RecordingError::Empty { .. })));
    }
}

#[test]
fn a_long_file_is_noted_in_part_and_found_all_the_same() {
    let count = MAX_NOTED as u64 * 3;
    let mut bytes = Vec::new();
    for frame in 1..=count {
        let parts = [messages::craft(
            "a",
            [7e6, frame as f64, 0.0],
            [0.0, 1.0, 0.0],
            [0.0; 3],
        )];
        let message = messages::message(frame, frame as f64, &parts);
        bytes.extend(messages::varint(message.len() as u64));
        bytes.extend(message);
    }
    let recording = open(&saved("long", &bytes)).expect("opens");
    assert_eq!(recording.messages(), count);
    assert!(recording.index.noted.len() <= MAX_NOTED);
    for elapsed_s in [1.0, 2.0, 65_537.0, 131_073.5, count as f64] {
        let snapshot = recording.snapshot_at(recording.at(elapsed_s));
        let snapshot = snapshot.expect("reads").expect("known");
        assert!((snapshot.craft[0].position_m.y - elapsed_s).abs() < 1e-6);
    }
    let kept = recording.reader.lock().expect("not poisoned").kept.len();
    assert!(kept <= MAX_KEPT);
}
