//! Random eye paths over a simulated loader that is slow, fails and is cancelled.

use super::host::{Host, Loading};
use super::source::{cut_layout, layout, scramble};
use proptest::prelude::*;
use std::collections::{HashMap, HashSet};
use terrella_ground::globe::Part;
use terrella_imagery::stream::{Pool, TileRequest, plan_pools};
use terrella_imagery::tile::{BlockSet, LayerLayout, MapLayer, Storage, TileKey, TileSet};

/// One frame of an eye path.
#[derive(Clone, Debug)]
struct Step {
    /// Block below the eye.
    eye: u8,
    level: u8,
    /// Blocks further away than this are not in the picture.
    reach: u32,
    /// Additional requests.
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

/// Requests parts of a part, none in another, and leaves some of it out.
fn push_parts(
    layer: &LayerLayout,
    part: Part,
    finest: u8,
    drawn: bool,
    noise: u64,
    requests: &mut Vec<TileRequest>,
) {
    let noise = scramble(noise ^ u64::from(part.index_at(part.depth)) << 8);
    let depth = |level: u8| layer.levels[usize::from(level)].shape.parts.ilog2() as u8;
    let level = (finest..layer.cut_levels() as u8).find(|level| depth(*level) == part.depth);
    match level {
        Some(level) if !noise.is_multiple_of(3) || level == finest => {
            if !noise.is_multiple_of(5) {
                let key = TileKey {
                    layer: layer.layer,
                    level,
                    block: part.block.index() as u8,
                    part: part.index_at(part.depth),
                };
                requests.push(TileRequest { key, drawn });
            }
        }
        _ => {
            for quarter in part.quarters() {
                push_parts(layer, quarter, finest, drawn, noise, requests);
            }
        }
    }
}

/// Requests of an eye: nearest blocks first and finest, then those expected beyond.
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
            let cut = layer.cut_levels() as u8;
            if key.level < cut {
                let part = Part::whole(key.block());
                push_parts(layer, part, key.level, drawn, noise, &mut requests);
            }
            let key = TileKey {
                level: key.level.max(cut),
                ..key
            };
            requests.push(TileRequest { key, drawn });
            if noise % 5 == 1 {
                // The same block will be requested at a finer level soon.
                let level = key.level.saturating_sub(1).max(cut);
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

/// The same for a part, or the next coarser one.
fn promise_part(
    layout: &LayerLayout,
    request: &TileRequest,
    slots: usize,
    promised: &mut HashMap<TileKey, bool>,
) {
    let cut = layout.cut_levels() as u8;
    let asked = request.key;
    let parts = |level: u8| layout.levels[usize::from(level)].shape.parts as u16;
    for level in asked.level..cut {
        let (fine, coarse) = (parts(asked.level), parts(level));
        let step = fine / coarse;
        let key = TileKey {
            level,
            part: asked.part / fine / step * coarse + asked.part % fine / step,
            ..asked
        };
        let of_pool = |k: &&TileKey| k.layer == key.layer && k.level <= cut;
        let has_room =
            promised.contains_key(&key) || promised.keys().filter(of_pool).count() < slots;
        let present = &layout.levels[usize::from(level)].present;
        if has_room && present.contains(key.block, key.part) {
            promised.entry(key).or_insert(request.drawn);
            return;
        }
    }
}

/// Whether a part is another, or holds it.
fn holds(layout: &LayerLayout, key: TileKey, other: TileKey) -> bool {
    let parts = |key: TileKey| layout.levels[usize::from(key.level)].shape.parts as u16;
    let (coarse, fine) = (parts(key), parts(other));
    let is_near = (key.layer, key.block) == (other.layer, other.block) && key.level >= other.level;
    is_near && {
        let step = fine / coarse;
        let (row, column) = (other.part / fine / step, other.part % fine / step);
        key.part == row * coarse + column
    }
}

/// Allocation of each map of each block by the rules when every tile can be read: the oracle.
fn allocated(
    layers: &[LayerLayout],
    pools: &[Pool],
    requests: &[TileRequest],
) -> HashMap<TileKey, bool> {
    let mut promised: HashMap<TileKey, bool> = HashMap::new();
    let mut seen = Vec::new();
    let mut seen_parts: HashSet<TileKey> = HashSet::new();
    // Whole blocks before parts.
    let turns = [(true, false), (true, true), (false, false), (false, true)];
    for (drawn, of_parts) in turns {
        for request in requests.iter().filter(|request| request.drawn == drawn) {
            let TileKey { layer, block, .. } = request.key;
            let Some(layout) = layers.iter().find(|layout| layout.layer == layer) else {
                continue;
            };
            let cut = layout.cut_levels() as u8;
            if block > 127 || (request.key.level < cut) != of_parts {
                continue;
            }
            if of_parts {
                let own = TileKey::whole(layer, cut, block);
                if seen_parts.insert(request.key) && promised.contains_key(&own) {
                    let slots = pools.iter().find(|p| (p.layer, p.level) == (layer, cut));
                    let slots = slots.map_or(0, |pool| pool.slots as usize);
                    promise_part(layout, request, slots, &mut promised);
                }
                continue;
            }
            if drawn && seen.contains(&(layer, block)) {
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
                    .filter(|k| (k.layer, k.level.max(cut)) == (layer, level))
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

/// Few slots or many; an empty pool is left out, as in [`plan_pools`].
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
    let parts = prop::sample::select(vec![&[][..], &[2_u32], &[4, 2], &[4], &[8, 2]]);
    let map = (levels, prop::bool::ANY, absent, parts);
    prop::collection::vec(map, 1..4).prop_map(|maps| {
        let places = maps.into_iter().zip(MapLayer::ALL);
        type Map<'a> = (&'a [u32], bool, u64, &'a [u32]);
        let map = |((pixels, is_bc, absent, parts), layer): (Map<'_>, MapLayer)| {
            let storage = if is_bc { Storage::Bc } else { Storage::Plain };
            let mut map = match parts.is_empty() {
                true => layout(layer, storage, pixels),
                false => cut_layout(layer, 20, parts, &[16, 16]),
            };
            let streamed = map.levels.len() - 1;
            let cut = map.cut_levels();
            for (level, entry) in map.levels[..streamed].iter_mut().enumerate() {
                // A third of all maps lack some tiles.
                if absent.is_multiple_of(3) {
                    let seed = absent ^ level as u64;
                    let bits = u128::from(scramble(seed)) << 64 | u128::from(scramble(!seed));
                    entry.present = TileSet::of_blocks(entry.shape, BlockSet(bits));
                    if level < cut {
                        // Some parts of every block.
                        entry.present = TileSet::none(entry.shape);
                        for tile in (0..)
                            .filter(|n| !scramble(seed ^ n).is_multiple_of(3))
                            .take(1 << 13)
                        {
                            let of_block = u64::from(entry.shape.tiles_of_block());
                            let (block, part) = (tile / of_block, tile % of_block);
                            entry.present.insert(block.min(255) as u8, part as u16);
                        }
                    } else if level == cut && cut > 0 {
                        entry.present = TileSet::all(entry.shape);
                    }
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
        // All loads succeed and the eye is at rest: in the end everything that fits is resident.
        let still = requests(&maps, steps.last().expect("one at least"));
        host.heal();
        let promised = allocated(&maps, &pools, &still);
        // Between a tile and the next of a chain nothing is queued for a frame.
        let is_done = |host: &Host| {
            let counters = host.counters();
            counters.queued + counters.loading + counters.waiting_upload == 0 && host.missing() == 0
        };
        let bytes: u64 = promised.keys().map(|key| host.bytes(*key)).sum();
        // Each tile in sequence: its load, its upload a few rows a frame, and as many frames as a chain of waiting stand-ins.
        let most = 100 + bytes / 100 + promised.len() as u64 * 16;
        let mut frames = 0;
        while !is_done(&host) || frames < 2 {
            host.frame(&still, true, 150);
            frames += 1;
            prop_assert!(frames < most, "nothing comes of {:?}", host.counters());
        }
        let before = host.counters();
        let drawn = host.frame(&still, true, 150);
        for ((layer, block), level) in drawn {
            let layout = maps.iter().find(|map| map.layer == layer);
            let cut = layout.map_or(0, |layout| layout.cut_levels()) as u8;
            let of_block = |key: &&TileKey| {
                (key.layer, key.block) == (layer, block) && key.level >= cut
            };
            let mut drawn_keys = promised.iter().filter(|(_, drawn)| **drawn);
            let expected = drawn_keys.find(|(key, _)| of_block(key)).map(|(key, _)| key.level);
            prop_assert_eq!(level, expected, "{:?} {}", layer, block);
        }
        for key in promised.keys() {
            prop_assert!(host.is_resident(*key), "{} was promised", key);
        }
        for (asked, level) in &host.parts_drawn {
            // The allocated replacement, or the block's own tile; or a finer one that is still resident.
            let layout = maps.iter().find(|map| map.layer == asked.layer).expect("a map");
            let holders = promised.keys().filter(|key| holds(layout, **key, *asked));
            let target = holders.map(|key| key.level).min();
            let own = layout.cut_levels() as u8;
            prop_assert!(*level <= target.unwrap_or(own), "{}: {}", asked, level);
        }
        let after = host.counters();
        prop_assert_eq!(after.fallbacks, 0);
        prop_assert_eq!((before.loads, before.uploaded_bytes), (after.loads, after.uploaded_bytes));
    }
}
