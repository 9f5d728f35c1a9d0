//! The rules of the cache, each in a corner where nothing else does its work.

use super::host::{Host, Loading};
use super::source::layout;
use std::time::Duration;
use terrella_imagery::stream::{TileRequest, plan_pools};
use terrella_imagery::tile::{MapLayer, Storage, TileKey};

const QUICK: Loading = Loading {
    threads: 4,
    limit: u64::MAX,
    failing: 0,
    slowest: 0,
    seed: 1,
};

/// One tile at a time is decoded or waits.
const ONE_BY_ONE: Loading = Loading {
    threads: 1,
    limit: 0,
    ..QUICK
};

fn key(level: u8, block: u8) -> TileKey {
    TileKey {
        layer: MapLayer::Day,
        level,
        block,
        part: 0,
    }
}

fn request(level: u8, block: u8) -> TileRequest {
    TileRequest {
        key: key(level, block),
        drawn: true,
    }
}

fn expect(level: u8, block: u8) -> TileRequest {
    TileRequest {
        key: key(level, block),
        drawn: false,
    }
}

/// A host of one map with two pools above its coarsest level, of so many slots.
fn host(fine: u32, middle: u32, loading: Loading) -> Host {
    let maps = [layout(MapLayer::Day, Storage::Plain, &[24, 20, 16])];
    let mut pools = plan_pools(&maps, u64::MAX);
    (pools[0].slots, pools[1].slots) = (fine, middle);
    Host::new(&maps, &pools, loading)
}

fn frames(host: &mut Host, count: u32, requests: &[TileRequest]) {
    for _ in 0..count {
        host.frame(requests, true, u64::MAX);
    }
}

/// Each of two blocks is drawn with a tile in the slot that the other waits for.
#[test]
fn stand_ins_in_two_pools_do_not_block_each_other() {
    for loading in [QUICK, ONE_BY_ONE] {
        let mut host = host(1, 1, loading);
        frames(&mut host, 20, &[request(0, 1), request(1, 2)]);
        assert!(host.is_resident(key(0, 1)) && host.is_resident(key(1, 2)));
        // Block 1 has its finer tile as a stand-in, block 2 its coarser one.
        frames(&mut host, 20, &[request(1, 1), request(0, 2)]);
        assert_eq!(host.missing(), 0);
        assert!(host.is_resident(key(1, 1)) && host.is_resident(key(0, 2)));
    }
}

/// A finer tile is drawn in place of a coarser one as long as its slot is not needed.
#[test]
fn a_finer_stand_in_is_better_than_none() {
    let mut host = host(1, 1, QUICK);
    frames(&mut host, 10, &[request(0, 1)]);
    host.stuck = vec![key(1, 1)];
    let drawn = host.frame(&[request(1, 1)], true, u64::MAX);
    assert_eq!(drawn[&(MapLayer::Day, 1)], Some(0));
    assert_eq!((host.counters().hits, host.missing()), (1, 1));
    let drawn = host.frame(&[request(1, 1), request(0, 2)], true, u64::MAX);
    assert_eq!(drawn[&(MapLayer::Day, 1)], None);
}

/// The tile that would free a slot is queued behind a decoded one that waits for that slot.
#[test]
fn a_decoded_tile_without_a_slot_does_not_stop_the_rest() {
    let mut host = host(1, 1, ONE_BY_ONE);
    frames(&mut host, 20, &[request(1, 1)]);
    // Block 2 takes the only place for decoded tiles; block 1 is drawn with the tile whose slot block 2 waits for.
    let requests = [request(1, 2), request(0, 1)];
    frames(&mut host, 20, &requests);
    assert_eq!(host.missing(), 0);
    assert!(requests.iter().all(|request| host.is_resident(request.key)));
}

/// The same with a tile that is only expected: it is dropped and comes back when there is room.
#[test]
fn a_decoded_tile_that_is_only_expected_makes_room() {
    let mut host = host(1, 1, ONE_BY_ONE);
    frames(&mut host, 20, &[request(1, 1)]);
    for _ in 0..10 {
        host.frame(&[expect(1, 2)], true, 0);
    }
    assert_eq!(host.counters().waiting_upload, 1);
    let requests = [request(0, 1), expect(1, 2)];
    frames(&mut host, 20, &requests);
    assert!(requests.iter().all(|request| host.is_resident(request.key)));
    assert_eq!(host.counters().cancelled, 1);
}

/// An expected tile takes no slot from the image, even if it is first in the list.
#[test]
fn what_is_expected_evicts_nothing_that_is_drawn() {
    let mut host = host(2, 1, QUICK);
    frames(&mut host, 20, &[request(0, 1), request(0, 2)]);
    let requests = [expect(0, 3), expect(0, 4), request(0, 1), request(0, 2)];
    frames(&mut host, 20, &requests);
    assert!(host.is_resident(key(0, 1)) && host.is_resident(key(0, 2)));
    assert_eq!(host.counters().evictions, 0);
    frames(&mut host, 20, &[expect(0, 3), request(0, 1)]);
    assert!(host.is_resident(key(0, 1)) && host.is_resident(key(0, 3)));
    assert_eq!(host.counters().evictions, 1);
}

/// It leaves an empty slot to a tile of the picture that is not there yet.
#[test]
fn what_is_expected_waits_for_the_picture() {
    let mut host = host(1, 2, QUICK);
    frames(&mut host, 10, &[request(1, 1)]);
    // One of the two slots holds block 1's stand-in; block 2 must get the other.
    host.stuck = vec![key(0, 1), key(1, 2)];
    let requests = [request(0, 1), request(1, 2), expect(1, 3)];
    frames(&mut host, 10, &requests);
    assert_eq!(host.counters().waiting_upload, 1);
    host.stuck.pop();
    frames(&mut host, 10, &requests);
    assert!(host.is_resident(key(1, 2)) && !host.is_resident(key(1, 3)));
    host.stuck.pop();
    frames(&mut host, 10, &requests);
    assert!(requests.iter().all(|request| host.is_resident(request.key)));
}

#[test]
fn the_tile_used_longest_ago_goes() {
    let mut host = host(3, 1, QUICK);
    for block in [1, 2, 3, 1] {
        frames(&mut host, 5, &[request(0, block)]);
    }
    frames(&mut host, 5, &[request(0, 4)]);
    assert!(!host.is_resident(key(0, 2)));
    frames(&mut host, 5, &[request(0, 5)]);
    assert!(!host.is_resident(key(0, 3)));
    assert!(
        [1, 4, 5]
            .iter()
            .all(|block| host.is_resident(key(0, *block)))
    );
}

/// Uploads follow the order of the requests, once a tile that is begun is done.
#[test]
fn the_most_urgent_is_uploaded_first() {
    let mut host = host(4, 1, QUICK);
    let bytes = host.bytes(key(0, 1));
    for _ in 0..5 {
        host.frame(&[request(0, 1), request(0, 2), request(0, 3)], true, 0);
    }
    let begun = [request(0, 1), request(0, 2), request(0, 3)];
    host.frame(&begun, true, bytes / 2);
    let turned = [request(0, 3), request(0, 2), request(0, 1)];
    let mut order = Vec::new();
    for _ in 0..3 {
        host.frame(&turned, true, bytes);
        let resident = (1..4).filter(|block| host.is_resident(key(0, *block)));
        order.push(resident.collect::<Vec<u8>>());
    }
    assert_eq!(order, [vec![1], vec![1, 3], vec![1, 2, 3]]);
}

/// A tile that cannot be read is tried again after 1, 2, 4 … 60 s, and its block is drawn coarser meanwhile.
#[test]
fn failures_are_tried_again_more_and_more_seldom() {
    let mut host = host(4, 4, QUICK);
    host.bad = Some(key(0, 9));
    // The stand-in takes longer than the first pauses.
    host.stuck = vec![key(1, 9)];
    let requests = [request(0, 9)];
    let start = host.now;
    let mut failed_at = Vec::new();
    while host.now - start < Duration::from_secs(260) {
        host.now += Duration::from_millis(40);
        let failures = host.counters().failures;
        let drawn = host.frame(&requests, true, u64::MAX);
        let since = host.now - start;
        if host.counters().failures > failures {
            failed_at.push(since.as_secs_f64());
        }
        if since > Duration::from_secs(40) {
            host.stuck.clear();
        }
        if since > Duration::from_secs(41) {
            assert_eq!(drawn[&(MapLayer::Day, 9)], Some(1));
            assert_eq!((host.counters().fallbacks, host.missing()), (1, 1));
        }
    }
    // The retry did not cancel the stand-in's load.
    assert_eq!(host.counters().cancelled, 0);
    let pauses: Vec<_> = failed_at.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let due = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 60.0, 60.0, 60.0];
    assert_eq!(pauses.len(), due.len(), "{pauses:?}");
    for (pause, due) in pauses.iter().zip(due) {
        assert!((due..due + 0.3).contains(pause), "{pauses:?}");
    }
    host.bad = None;
    host.now += Duration::from_secs(60);
    frames(&mut host, 10, &requests);
    assert!(host.is_resident(key(0, 9)));
    assert_eq!((host.counters().hits, host.missing()), (1, 0));
}
