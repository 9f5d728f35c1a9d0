//! Random eye paths over a simulated loader that is slow, fails and is told to stop.

use super::host::{Host, Loading};
use super::source::{layout, scramble};
use proptest::prelude::*;
use std::collections::HashMap;
use terrella::internals::imagery::stream::{Pool, TileRequest, plan_pools};
use terrella::internals::imagery::tile::{
    BlockSet, LayerLayout, MapLayer, Storage, TileKey, TileSet,
};

/// One frame of an eye path.
#[derive(Clone, Debug)]
struct Step {
    /// Block below the eye.
    eye: u8,
    /// Level asked for there.
    level: u8,
    /// Blocks further away than this are not in the picture.
    reach: u32,
    /// What else is asked for.
    noise: u64,
    /// How long it lasts, frames.
    frames: u32,
    /// A frame that is not drawn: an export that only loads.
    draws: bool,
    budget: u64,
}

/// Columns and rows between two blocks, the larger.
fn distance(one: u8, other: u8) -> u32 {
    let columns = (one % 16).abs_diff(other % 16);
    let rows = (one / 16).abs_diff(other / 16);
    u32::from(columns.min(16 - columns).max(rows))
}

/// What an eye requests: nearest blocks first and finest, then what is expected beyond.
fn requests(layers: &[LayerLayout], step: &Step) -> Vec<TileRequest> {
    let mut blocks: Vec<u8> = (0..128)
        .filter(|block| distance(*block, step.eye) <= step.reach + 1)
        .collect();
    blocks.sort_by_key(|block| (distance(*block, step.eye), *block));
    let mut requests = Vec::new();
    for block in blocks {
        let away = distance(block, step.eye);
        for layer in layers {
            let noise = scramble(step.noise ^ u64::from(block) << 8 ^ layer.layer.index() as u64);
            let key = TileKey {
                layer: layer.layer,
                level: step.level + away as u8 + u8::from(noise.is_multiple_of(7)),
                block,
                part: 0,
            };
            let drawn = away <= step.reach;
            requests.push(TileRequest { key, drawn });
            if noise % 5 == 1 {
                // The same block is soon to be asked for finer.
                let level = key.level.saturating_sub(1);
                let key = TileKey { level, ..key };
                requests.push(TileRequest { key, drawn: false });
            }
        }
    }
    if step.noise.is_multiple_of(3) {
        // Hosts may err: what does not exist, the same twice, an order that is no order.
        let key = TileKey {
            layer: MapLayer::Water,
            level: 255,
            block: 255,
            part: 0,
        };
        requests.push(TileRequest { key, drawn: true });
        requests.extend_from_within(..requests.len() / 2);
        let turn = (step.noise >> 8) as usize % requests.len();
        requests.rotate_left(turn);
    }
    requests
}

/// What the rules say that each map of each block is allocated to when every tile can be read: the oracle.
fn allocated(
    layers: &[LayerLayout],
    pools: &[Pool],
    requests: &[TileRequest],
) -> HashMap<TileKey, bool> {
    let mut promised: HashMap<TileKey, bool> = HashMap::new();
    let mut seen = Vec::new();
    for drawn in [true, false] {
        for request in requests.iter().filter(|request| request.drawn == drawn) {
            let TileKey { layer, block, .. } = request.key;
            let Some(layout) = layers.iter().find(|layout| layout.layer == layer) else {
                continue;
            };
            if block > 127 || drawn && seen.contains(&(layer, block)) {
                continue;
            }
            if drawn {
                seen.push((layer, block));
            }
            let coarsest = layout.levels.len() as u8 - 1;
            for level in request.key.level.min(coarsest)..coarsest {
                let key = TileKey {
                    level,
                    ..request.key
                };
                let pool = pools.iter().find(|p| (p.layer, p.level) == (layer, level));
                let full = promised
                    .keys()
                    .filter(|k| (k.layer, k.level) == (layer, level))
                    .count();
                let has_room = promised.contains_key(&key)
                    || pool.is_some_and(|pool| full < pool.slots as usize);
                if has_room && layout.levels[usize::from(level)].present.contains(block, 0) {
                    promised.entry(key).or_insert(drawn);
                    break;
                }
            }
        }
    }
    promised
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let budgets = prop_oneof![0_u64..3, 20_u64..3_000, Just(u64::MAX)];
    // A small country, so that a path comes back to where it was; across the date line.
    let eye = prop::sample::select(vec![48_u8, 49, 50, 63, 62, 64, 65, 79]);
    let step = (
        (eye, 0_u8..3, 0_u32..3),
        any::<u64>(),
        1_u32..12,
        prop::bool::weighted(0.9),
        budgets,
    );
    let step = step.prop_map(|((eye, level, reach), noise, frames, draws, budget)| Step {
        eye,
        level,
        reach,
        noise,
        frames,
        draws,
        budget,
    });
    prop::collection::vec(step, 1..14)
}

/// Few slots or many; a pool of none is left out, as [`plan_pools`] does.
fn pools(maps: &[LayerLayout], seed: u64) -> Vec<Pool> {
    let mut pools = plan_pools(maps, u64::MAX);
    for pool in &mut pools {
        let name = pool.layer.index() as u64 * 8 + u64::from(pool.level);
        let few = scramble(seed ^ name) % (2 + seed % 12);
        pool.slots = pool.slots.min(few as u32);
    }
    pools.retain(|pool| pool.slots > 0);
    pools
}

fn maps() -> impl Strategy<Value = Vec<LayerLayout>> {
    let levels = prop::sample::select(vec![
        &[40_u32, 24, 20, 16][..],
        &[24, 16, 16],
        &[20, 16],
        &[16],
    ]);
    let absent = any::<u64>();
    let map = (levels, prop::bool::ANY, absent);
    prop::collection::vec(map, 1..4).prop_map(|maps| {
        let places = maps.into_iter().zip(MapLayer::ALL);
        let map = |((pixels, is_bc, absent), layer): ((&[u32], bool, u64), MapLayer)| {
            let storage = if is_bc { Storage::Bc } else { Storage::Plain };
            let mut map = layout(layer, storage, pixels);
            let streamed = map.levels.len() - 1;
            for (level, entry) in map.levels[..streamed].iter_mut().enumerate() {
                // A third of all maps lack some tiles.
                if absent.is_multiple_of(3) {
                    let seed = absent ^ level as u64;
                    let bits = u128::from(scramble(seed)) << 64 | u128::from(scramble(!seed));
                    entry.present = TileSet::of_blocks(entry.shape, BlockSet(bits));
                }
            }
            map
        };
        places.map(map).collect()
    })
}

fn loading() -> impl Strategy<Value = Loading> {
    (
        1_usize..5,
        prop_oneof![Just(0_u64), 1_000_u64..40_000],
        prop_oneof![Just(0_u64), 0_u64..256],
        0_u64..9,
        any::<u64>(),
    )
        .prop_map(|(threads, limit, failing, slowest, seed)| Loading {
            threads,
            limit,
            failing,
            slowest,
            seed,
        })
}

proptest! {
    // A failure is printed with its input; no file of past failures is kept.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn promises_hold_on_any_path(
        maps in maps(),
        seed in any::<u64>(),
        loading in loading(),
        steps in steps(),
    ) {
        let pools = pools(&maps, seed);
        let mut host = Host::new(&maps, &pools, loading);
        for step in &steps {
            let requests = requests(&maps, step);
            for _ in 0..step.frames {
                host.frame(&requests, step.draws, step.budget);
            }
        }
        // The disk is mended and the eye stands still: in the end everything that fits is there.
        let still = requests(&maps, steps.last().expect("one at least"));
        host.heal();
        let promised = allocated(&maps, &pools, &still);
        let is_done = |host: &Host| {
            let counters = host.counters();
            counters.queued + counters.loading + counters.waiting_upload == 0
        };
        let bytes: u64 = promised.keys().map(|key| host.bytes(*key)).sum();
        // Each tile in turn: its load, its upload a few rows a frame, and as many frames as stand-ins wait in a chain.
        let most = 100 + bytes / 100 + promised.len() as u64 * 16;
        let mut frames = 0;
        while !is_done(&host) || frames < 2 {
            host.frame(&still, true, 150);
            frames += 1;
            prop_assert!(frames < most, "nothing comes of {:?}", host.counters());
        }
        prop_assert_eq!(host.missing(), 0);
        let before = host.counters();
        let drawn = host.frame(&still, true, 150);
        for ((layer, block), level) in drawn {
            let of_block = |key: &&TileKey| (key.layer, key.block) == (layer, block);
            let mut drawn_keys = promised.iter().filter(|(_, drawn)| **drawn);
            let expected = drawn_keys.find(|(key, _)| of_block(key)).map(|(key, _)| key.level);
            prop_assert_eq!(level, expected, "{:?} {}", layer, block);
        }
        for key in promised.keys() {
            prop_assert!(host.is_resident(*key), "{} was promised", key);
        }
        let after = host.counters();
        prop_assert_eq!(after.fallbacks, 0);
        prop_assert_eq!((before.loads, before.uploaded_bytes), (after.loads, after.uploaded_bytes));
    }
}
