//! The stream with real threads: slow, failing, panicking and stuck sources.

use super::source::{layout, tile};
use std::collections::{HashMap, HashSet};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use terrella_imagery::stream::{
    ResidentTile, StreamOptions, TileLoading, TileRequest, TileSlot, TileStream,
};
use terrella_imagery::tile::{
    LayerLayout, MapLayer, Storage, Tile, TileError, TileKey, TileSource,
};

type Read = dyn Fn(TileKey, &dyn Fn() -> bool) -> Result<Tile, TileError> + Send + Sync;

/// A source of small tiles with a side effect, which checks that no tile is read twice at the same time.
struct Source {
    layers: Vec<LayerLayout>,
    under_way: Mutex<HashSet<TileKey>>,
    reads: AtomicU32,
    /// A tile was read twice at the same time. A panic in a read would be caught.
    is_doubled: AtomicBool,
    read: Box<Read>,
}

impl TileSource for Source {
    fn layers(&self) -> &[LayerLayout] {
        &self.layers
    }

    fn read(&self, key: TileKey, cancelled: &dyn Fn() -> bool) -> Result<Tile, TileError> {
        struct Done<'a>(&'a Source, TileKey);
        impl Drop for Done<'_> {
            fn drop(&mut self) {
                self.0.under_way.lock().unwrap().remove(&self.1);
            }
        }
        let is_first = self.under_way.lock().unwrap().insert(key);
        self.is_doubled.fetch_or(!is_first, Ordering::Relaxed);
        let _done = Done(self, key);
        self.reads.fetch_add(1, Ordering::Relaxed);
        (self.read)(key, cancelled)
    }
}

fn maps() -> Vec<LayerLayout> {
    vec![
        layout(MapLayer::Day, Storage::Plain, &[40, 20, 16]),
        layout(MapLayer::Clouds, Storage::Bc, &[24, 16]),
    ]
}

/// A source that does this first; an error is given instead of the tile.
fn source(
    before: impl Fn(TileKey, &dyn Fn() -> bool) -> Result<(), TileError> + Send + Sync + 'static,
) -> Arc<Source> {
    let read = move |key, cancelled: &dyn Fn() -> bool| {
        before(key, cancelled)?;
        Ok(tile(&maps(), key))
    };
    Arc::new(Source {
        layers: maps(),
        under_way: Mutex::default(),
        reads: AtomicU32::new(0),
        is_doubled: AtomicBool::new(false),
        read: Box::new(read),
    })
}

fn options() -> StreamOptions {
    StreamOptions {
        texture_bytes: 100_000,
        decoded_bytes: 20_000,
        loading: TileLoading::Threads(Some(3)),
    }
}

fn request(layer: MapLayer, level: u8, block: u8) -> TileRequest {
    let key = TileKey {
        layer,
        level,
        block,
        part: 0,
    };
    TileRequest { key, drawn: true }
}

fn day(block: u8) -> TileRequest {
    request(MapLayer::Day, 0, block)
}

/// Frames without drawing until the stream has nothing to do, or `time` is over.
fn settle(stream: &mut TileStream, requests: &[TileRequest], time: Duration) {
    let start = Instant::now();
    loop {
        stream.update(Instant::now(), requests);
        stream.upload(u64::MAX, &mut |_| {});
        let counters = stream.counters();
        let open = counters.queued + counters.loading + counters.waiting_upload;
        if open == 0 && stream.missing().next().is_none() || start.elapsed() > time {
            return;
        }
        stream.wait(Duration::from_millis(20));
    }
}

const LONG: Duration = Duration::from_secs(20);

#[test]
fn a_slow_failing_and_panicking_source_gives_what_it_can() {
    let tries = Mutex::new(HashMap::<TileKey, u32>::new());
    let source = source(move |key, _| {
        let mut tries = tries.lock().unwrap();
        let count = tries.entry(key).or_default();
        *count += 1;
        let is_first = *count == 1;
        drop(tries);
        std::thread::sleep(Duration::from_millis(u64::from(key.block % 3)));
        match key.block % 8 {
            0 if is_first => panic!("on purpose"),
            1 if is_first => Err(TileError::Absent(key)),
            2 => Err(TileError::Absent(key)),
            _ => Ok(()),
        }
    });
    let mut stream = TileStream::new(source.clone(), &options());
    let mut slots: HashMap<TileSlot, Vec<u8>> = HashMap::new();
    let (mut now, start) = (Instant::now(), Instant::now());
    let mut drawn_fine = 0;
    for frame in 0_u32.. {
        // Every simulated frame is a tenth of a second: failures fall due without sleeping.
        now += Duration::from_millis(100);
        let eye = (frame / 150 % 4 * 20) as u8;
        let requests: Vec<_> = (eye..eye + 8)
            .flat_map(|block| [request(MapLayer::Clouds, 0, block), day(block)])
            .collect();
        stream.update(now, &requests);
        let mut pictures = Vec::new();
        for request in &requests {
            let TileKey { layer, block, .. } = request.key;
            let Some(ResidentTile { level, slot }) = stream.draw(layer, block) else {
                continue;
            };
            assert!(block % 8 != 2, "block {block} cannot be read");
            let texels = tile(
                &maps(),
                TileKey {
                    level,
                    ..request.key
                },
            )
            .texels;
            assert!(slots[&slot] == texels);
            pictures.push((slot, texels));
            drawn_fine += u32::from(level == 0);
        }
        let written = stream.upload(3_000, &mut |part| {
            let held = slots.entry(part.slot).or_default();
            if (part.mip, part.first_row) == (0, 0) {
                held.clear();
            }
            held.extend(part.texels);
        });
        assert!(written <= 3_000);
        for (slot, texels) in pictures {
            assert!(slots[&slot] == texels, "overwritten while drawn");
        }
        std::thread::sleep(Duration::from_micros(300));
        let is_through = frame > 1_200 && drawn_fine > 5_000;
        assert!(start.elapsed() < LONG, "{:?}", stream.counters());
        if is_through {
            break;
        }
    }
    let counters = stream.counters();
    assert!(
        counters.failures > 4 && counters.evictions > 0,
        "{counters:?}"
    );
    let ended = counters.completed + counters.cancelled + counters.failures;
    let open = u64::from(counters.loading + counters.waiting_upload);
    assert_eq!(counters.loads, ended + open);
    assert!(u64::from(source.reads.load(Ordering::Relaxed)) >= counters.loads);
    drop(stream);
    assert!(source.under_way.lock().unwrap().is_empty());
    assert!(!source.is_doubled.load(Ordering::Relaxed));
}

#[test]
fn what_is_no_longer_wanted_is_cancelled() {
    let source = source(|key, cancelled| {
        let start = Instant::now();
        while key.block == 7 && start.elapsed() < LONG {
            if cancelled() {
                return Err(TileError::Cancelled);
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(())
    });
    let mut stream = TileStream::new(source, &options());
    let start = Instant::now();
    while stream.counters().loading == 0 {
        stream.update(Instant::now(), &[day(7)]);
        assert!(start.elapsed() < LONG);
    }
    settle(&mut stream, &[day(5)], LONG);
    let counters = stream.counters();
    assert!(start.elapsed() < LONG);
    assert_eq!((counters.cancelled, counters.completed), (1, 1));
    assert_eq!((counters.failures, counters.loads), (0, 2));
}

#[test]
fn wrong_tiles_are_failures() {
    let read = |key: TileKey, _: &dyn Fn() -> bool| {
        let mut tile = tile(&maps(), key);
        match key.block {
            1 => tile.texels.truncate(100),
            2 => tile.texels.push(0),
            3 => tile.format = tile.format.decoded(),
            4 => tile.shape = maps()[0].levels[1].shape,
            // Without a request to cancel.
            5 => return Err(TileError::Cancelled),
            _ => {}
        }
        Ok(tile)
    };
    let source = Source {
        layers: maps(),
        under_way: Mutex::default(),
        reads: AtomicU32::new(0),
        is_doubled: AtomicBool::new(false),
        read: Box::new(read),
    };
    let mut stream = TileStream::new(Arc::new(source), &options());
    let clouds = |block| request(MapLayer::Clouds, 0, block);
    let requests: Vec<_> = (1..7).map(clouds).collect();
    let start = Instant::now();
    while stream.counters().completed + stream.counters().failures < 6 {
        // The clock is stopped: there are no retries.
        stream.update(start, &requests);
        stream.upload(u64::MAX, &mut |part| assert_eq!(part.key.block, 6));
        stream.wait(Duration::from_millis(20));
        assert!(start.elapsed() < LONG);
    }
    let missing: Vec<_> = stream.missing().map(|key| key.block).collect();
    assert_eq!(missing, [1, 2, 3, 4, 5]);
    assert_eq!(stream.counters().failures, 5);
}

#[test]
fn decoded_tiles_are_bounded() {
    let source = source(|_, _| Ok(()));
    let bytes = tile(&maps(), day(0).key).texels.len() as u64;
    let options = StreamOptions {
        texture_bytes: u64::MAX,
        decoded_bytes: 3 * bytes,
        loading: TileLoading::Threads(Some(2)),
    };
    let mut stream = TileStream::new(source.clone(), &options);
    let requests: Vec<_> = (0..40).map(day).collect();
    for _ in 0..60 {
        stream.update(Instant::now(), &requests);
        std::thread::sleep(Duration::from_millis(1));
    }
    // Nothing is uploaded: three are decoded and no thread takes another.
    assert_eq!(source.reads.load(Ordering::Relaxed), 3);
    assert_eq!(stream.counters().waiting_bytes, 3 * bytes);
    settle(&mut stream, &requests, LONG);
    assert_eq!(stream.counters().resident[0], 40);
    assert_eq!(source.reads.load(Ordering::Relaxed), 40);
}

#[test]
fn a_stream_can_be_dropped_while_it_loads() {
    let source = source(|_, cancelled| {
        let start = Instant::now();
        while !cancelled() && start.elapsed() < LONG {
            std::thread::sleep(Duration::from_millis(1));
        }
        Err(TileError::Cancelled)
    });
    for _ in 0..20 {
        let mut stream = TileStream::new(source.clone(), &options());
        let requests: Vec<_> = (0..40).map(day).collect();
        let (reads, start) = (source.reads.load(Ordering::Relaxed), Instant::now());
        while source.reads.load(Ordering::Relaxed) == reads {
            stream.update(Instant::now(), &requests);
            assert!(start.elapsed() < LONG);
        }
        let start = Instant::now();
        drop(stream);
        assert!(start.elapsed() < Duration::from_secs(1));
        // All threads have ended: none references the source.
        assert_eq!(Arc::strong_count(&source), 1);
    }
}

#[test]
fn a_stuck_source_does_not_hang_the_program() {
    let is_over = Arc::new(AtomicBool::new(false));
    let stays = Arc::clone(&is_over);
    let source = source(move |_, _| {
        while !stays.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(5));
        }
        Ok(())
    });
    let mut stream = TileStream::new(source.clone(), &options());
    while source.reads.load(Ordering::Relaxed) == 0 {
        stream.update(Instant::now(), &[day(1)]);
    }
    let start = Instant::now();
    assert!(!stream.wait(Duration::from_millis(50)));
    assert!(start.elapsed() >= Duration::from_millis(50));
    drop(stream);
    assert!(start.elapsed() < Duration::from_secs(5));
    is_over.store(true, Ordering::Relaxed);
}

/// Threads take work while the frame re-orders it, as often as can be.
#[test]
fn a_busy_queue_doubles_and_loses_nothing() {
    let source = source(|_, _| Ok(()));
    let mut stream = TileStream::new(source.clone(), &options());
    let start = Instant::now();
    for frame in 0_u32.. {
        let eye = frame / 3 % 100;
        let requests: Vec<_> = (eye..eye + 20).map(|block| day(block as u8)).collect();
        stream.update(Instant::now(), &requests);
        stream.upload(u64::MAX, &mut |_| {});
        let is_enough = stream.counters().loads > 1_000;
        if is_enough && start.elapsed() > Duration::from_millis(1_500) {
            break;
        }
        assert!(start.elapsed() < LONG, "{:?}", stream.counters());
    }
    let requests: Vec<_> = (0..4).map(day).collect();
    settle(&mut stream, &requests, LONG);
    // Threads may still be about to report cancelled loads.
    for _ in 0..100 {
        stream.update(Instant::now(), &requests);
        std::thread::sleep(Duration::from_millis(1));
    }
    let counters = stream.counters();
    assert_eq!(
        counters.loads,
        u64::from(source.reads.load(Ordering::Relaxed))
    );
    assert_eq!(counters.loads, counters.completed + counters.cancelled);
    assert!(!source.is_doubled.load(Ordering::Relaxed));
}
