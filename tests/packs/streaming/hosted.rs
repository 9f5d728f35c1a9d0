//! Loads that the host does itself, without threads, as a web page does.

use super::source::{layout, tile};
use std::sync::Arc;
use std::time::{Duration, Instant};
use terrella_imagery::stream::{
    HostedTiles, StreamOptions, TileLoad, TileLoading, TileRequest, TileStream,
};
use terrella_imagery::tile::{LayerLayout, MapLayer, Storage, TileError, TileKey};

fn maps() -> Vec<LayerLayout> {
    vec![layout(MapLayer::Day, Storage::Plain, &[40, 16])]
}

fn stream(at_once: usize) -> TileStream {
    let options = StreamOptions {
        texture_bytes: 1_000_000,
        decoded_bytes: 1_000_000,
        loading: TileLoading::Host(at_once),
    };
    TileStream::new(Arc::new(HostedTiles(maps())), &options)
}

fn day(block: u8) -> TileRequest {
    TileRequest {
        key: TileKey::whole(MapLayer::Day, 0, block),
        drawn: true,
    }
}

fn blocks(loads: &[TileLoad]) -> Vec<u8> {
    loads.iter().map(|load| load.key().block).collect()
}

/// A frame: what it lacks, and the loads that it begins.
fn frame(stream: &mut TileStream, now: Instant, requests: &[TileRequest]) -> Vec<TileLoad> {
    stream.update(now, requests);
    stream.upload(u64::MAX, &mut |_| {});
    std::iter::from_fn(|| stream.take()).collect()
}

fn deliver(loads: Vec<TileLoad>) {
    for load in loads {
        let tile = tile(&maps(), load.key());
        load.end(Ok(tile));
    }
}

#[test]
fn the_most_urgent_tiles_are_taken_so_many_at_once() {
    let mut stream = stream(2);
    let now = Instant::now();
    let requests = [9, 4, 7, 5, 1].map(day);
    let first = frame(&mut stream, now, &requests);
    assert_eq!(blocks(&first), [9, 4]);
    assert!(frame(&mut stream, now, &requests).is_empty());
    assert!(first.iter().all(TileLoad::is_wanted));
    deliver(first);
    let second = frame(&mut stream, now, &requests);
    assert_eq!(blocks(&second), [7, 5]);
    deliver(second);
    deliver(frame(&mut stream, now, &requests));
    assert!(frame(&mut stream, now, &requests).is_empty());
    assert_eq!(stream.missing().count(), 0);
    assert!(stream.is_settled());
    let counters = stream.counters();
    assert_eq!((counters.loads, counters.completed), (5, 5));
}

#[test]
fn a_load_that_is_no_longer_wanted_says_so_and_makes_room() {
    let mut stream = stream(2);
    let now = Instant::now();
    let loads = frame(&mut stream, now, &[day(1), day(2)]);
    assert!(frame(&mut stream, now, &[day(2), day(3)]).is_empty());
    assert_eq!(
        loads.iter().map(TileLoad::is_wanted).collect::<Vec<_>>(),
        [false, true]
    );
    for load in loads {
        match load.is_wanted() {
            true => deliver(vec![load]),
            false => load.end(Err(TileError::Cancelled)),
        }
    }
    let loads = frame(&mut stream, now, &[day(2), day(3)]);
    assert_eq!(blocks(&loads), [3]);
    let counters = stream.counters();
    assert_eq!((counters.cancelled, counters.failures), (1, 0));
    // It is wanted again, and loaded.
    deliver(loads);
    let again = frame(&mut stream, now, &[day(1)]);
    assert_eq!(blocks(&again), [1]);
}

#[test]
fn what_did_not_come_is_requested_again_after_a_pause() {
    let mut stream = stream(3);
    let now = Instant::now();
    let requests = [day(1), day(2), day(3)];
    let mut loads = frame(&mut stream, now, &requests).into_iter();
    let lost = TileError::NotReceived {
        address: "https://tiles.example/r0c1.ktx2".into(),
        cause: "connection reset".into(),
    };
    loads.next().expect("block 1").end(Err(lost));
    // A host that forgets a load.
    drop(loads.next().expect("block 2"));
    // Texels of another size.
    let load = loads.next().expect("block 3");
    let mut wrong = tile(&maps(), load.key());
    wrong.texels.pop();
    load.end(Ok(wrong));
    assert!(frame(&mut stream, now, &requests).is_empty());
    assert_eq!(stream.counters().failures, 3);
    assert_eq!(stream.missing().count(), 3);
    let later = now + Duration::from_secs(2);
    let mut again = blocks(&frame(&mut stream, later, &requests));
    again.sort_unstable();
    assert_eq!(again, [1, 2, 3]);
}

#[test]
fn tiles_that_come_after_the_stream_is_gone_are_dropped() {
    let mut stream = stream(2);
    let loads = frame(&mut stream, Instant::now(), &[day(1), day(2)]);
    drop(stream);
    assert!(!loads.iter().any(TileLoad::is_wanted));
    deliver(loads);
}
