//! How a budget of texture memory is split into pools of tile-sized slots.

use crate::residency::{MAX_PART_SLOTS, Pool};
use crate::tile::{LayerLayout, LevelLayout, MAX_LEVELS};

/// Blocks of one level that a view commonly needs: those about the eye to its horizon, or a row round a pole.
const BLOCKS_OF_A_VIEW: u32 = 24;

/// Splits `texture_bytes` into pools, the finest levels first. Pools without a slot are left out; all pools together never exceed the budget, and
/// none has more slots than there are tiles.
///
/// Near the ground an eye requires a few blocks at the finest level and more at each coarser one; from afar, half the Earth at one of the coarser
/// levels. A block is seldom requested in one map alone, so slots are assigned to levels of all maps together: those with the same number of steps
/// from their coarsest, since a map of less detail has fewer levels. From the coarsest step to the finest:
///
/// - The finest gets half of the budget, the next a quarter, and so on; the coarsest gets as much as the next finer.
/// - If that is not enough for 24 blocks, the number that a view needs, a step takes up to half of the remaining budget to reach it: a small budget
///   goes to the coarse levels, which cover most of an image, but some of it remains for finer ones under the eye.
/// - The remainder of a step goes to the finer ones, and in the end back from the finest to the coarsest.
///
/// Levels that are cut into parts share the pool of the finest uncut level, which then has twice as many slots.
///
/// A map that violates the contract of [`LayerLayout`] gets no pool.
pub fn plan_pools(layers: &[LayerLayout], texture_bytes: u64) -> Vec<Pool> {
    let layers = usable(layers);
    let steps = layers
        .iter()
        .map(|layer| layer.levels.len() - layer.cut_levels() - 1);
    let steps = steps.max().unwrap_or(0);
    let mut plan = Plan {
        steps: (0..steps)
            .rev()
            .map(|step| demands(&layers, step))
            .collect(),
        left: texture_bytes,
    };
    for step in (0..steps).rev() {
        let halvings = if step + 1 == steps { step } else { step + 1 };
        let share = texture_bytes >> halvings;
        let floor = plan.cost(step, BLOCKS_OF_A_VIEW).min(plan.left / 2);
        let allowance = if step == 0 {
            plan.left
        } else {
            share.max(floor)
        };
        plan.grow(step, allowance.min(plan.left));
    }
    for step in 0..steps {
        plan.grow(step, plan.left);
    }
    for step in 0..steps {
        plan.fill(step);
    }
    plan.steps
        .into_iter()
        .flatten()
        .filter(|pool| pool.0.slots > 0)
        .map(|pool| pool.0)
        .collect()
}

/// The maps that keep the contract: one for each [`MapLayer`](crate::tile::MapLayer), 1…[`MAX_LEVELS`] levels, those that
/// are cut into parts first and of one size with the next, which is not the coarsest.
pub(super) fn usable(layers: &[LayerLayout]) -> Vec<&LayerLayout> {
    let mut kept: Vec<&LayerLayout> = Vec::new();
    for layer in layers {
        let is_new = kept.iter().all(|other| other.layer != layer.layer);
        if is_new && (1..=MAX_LEVELS).contains(&layer.levels.len()) && is_cut_well(layer) {
            kept.push(layer);
        }
    }
    kept
}

fn is_cut_well(layer: &LayerLayout) -> bool {
    let cut = layer.cut_levels();
    let Some(own) = layer.levels.get(cut) else {
        return false;
    };
    let falls = |pair: &[LevelLayout]| pair[0].shape.parts > pair[1].shape.parts;
    let of_one_size = |level: &LevelLayout| level.shape.pixels == own.shape.pixels;
    layer.levels[cut..]
        .iter()
        .all(|level| level.shape.parts == 1)
        && (cut == 0
            || cut + 1 < layer.levels.len()
                && layer.levels[..=cut].windows(2).all(falls)
                && layer.levels[..cut].iter().all(of_one_size))
}

/// The pools of the levels that have so many streamed ones below them, still without slots, each with the number of its
/// tiles.
fn demands(layers: &[&LayerLayout], coarser: usize) -> Vec<(Pool, u32)> {
    let demand = |layer: &&LayerLayout| {
        let cut = layer.cut_levels();
        let level = (layer.levels.len() - cut).checked_sub(2 + coarser)? + cut;
        let has_parts = cut > 0 && level == cut;
        let held = if has_parts { 0..=level } else { level..=level };
        let tiles = layer.levels[held].iter().map(|level| level.present.len());
        let most = if has_parts { MAX_PART_SLOTS } else { u32::MAX };
        let pool = Pool {
            layer: layer.layer,
            level: level as u8,
            has_parts,
            format: layer.format,
            shape: layer.levels[level].shape,
            slots: 0,
        };
        Some((pool, tiles.sum::<u32>().min(most)))
    };
    layers.iter().filter_map(demand).collect()
}

struct Plan {
    /// The finest step first.
    steps: Vec<Vec<(Pool, u32)>>,
    left: u64,
}

impl Plan {
    /// Bytes of so many blocks of a step in all its maps.
    fn cost(&self, step: usize, blocks: u32) -> u64 {
        let pools = self.steps[step].iter();
        pools
            .map(|(pool, tiles)| slot_bytes(pool) * u64::from(slots_for(pool, blocks).min(*tiles)))
            .sum()
    }

    /// Gives a step blocks for at most so many bytes more.
    fn grow(&mut self, step: usize, allowance: u64) {
        let pools = &self.steps[step];
        let most = pools.iter().map(|(_, tiles)| *tiles).max().unwrap_or(0);
        let have = pools
            .iter()
            .map(|(pool, _)| pool.slots / slots_for(pool, 1));
        let have = have.max().unwrap_or(0);
        let taken = self.cost(step, have);
        let blocks = (have..=most)
            .take_while(|blocks| self.cost(step, *blocks) - taken <= allowance)
            .last();
        let Some(blocks) = blocks else { return };
        self.left -= self.cost(step, blocks) - taken;
        for (pool, tiles) in &mut self.steps[step] {
            pool.slots = slots_for(pool, blocks).min(*tiles);
        }
    }

    /// Gives single maps of a step one slot more, where the rest of the budget holds it.
    fn fill(&mut self, step: usize) {
        for (pool, tiles) in &mut self.steps[step] {
            if pool.slots < *tiles && slot_bytes(pool) <= self.left {
                pool.slots += 1;
                self.left -= slot_bytes(pool);
            }
        }
    }
}

/// Slots for so many blocks: with parts also for as many of these.
fn slots_for(pool: &Pool, blocks: u32) -> u32 {
    if pool.has_parts { 2 * blocks } else { blocks }
}

fn slot_bytes(pool: &Pool) -> u64 {
    pool.shape.bytes(pool.format) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tile::{BlockSet, MapLayer, Storage, TileSet, TileShape};

    fn paper(storage: Storage) -> Vec<LayerLayout> {
        let layout = |layer: MapLayer| LayerLayout {
            layer,
            format: layer.tile_format(storage),
            levels: layer
                .paper_pixels()
                .iter()
                .map(|pixels| {
                    let shape = TileShape::new(*pixels).expect("in range");
                    LevelLayout::of_blocks(shape, BlockSet::ALL)
                })
                .collect(),
        };
        MapLayer::ALL.map(layout).to_vec()
    }

    /// Slots of a map's levels.
    fn slots(pools: &[Pool], layer: MapLayer) -> [u32; 4] {
        let of = |level| {
            let mut of_level = pools
                .iter()
                .filter(|pool| pool.layer == layer && pool.level == level);
            of_level.next().map_or(0, |pool| pool.slots)
        };
        [of(0), of(1), of(2), of(3)]
    }

    fn total(pools: &[Pool]) -> u64 {
        pools.iter().map(Pool::bytes).sum()
    }

    #[test]
    fn the_papers_ladder_is_shared_out() {
        let day = |storage, megabytes: u64| {
            let budget = megabytes << 20;
            let pools = plan_pools(&paper(storage), budget);
            assert!(total(&pools) <= budget);
            assert_eq!(pools, plan_pools(&paper(storage), budget));
            slots(&pools, MapLayer::Day)
        };
        // Blocks at the levels of 1350, 675, 450 and 270 texels.
        assert_eq!(day(Storage::Plain, 512), [16, 30, 33, 93]);
        assert_eq!(day(Storage::Plain, 64), [0, 5, 13, 26]);
        assert_eq!(day(Storage::Plain, 8), [0, 0, 2, 6]);
        assert_eq!(day(Storage::Plain, 0), [0; 4]);
        assert_eq!(day(Storage::Bc, 512), [49, 89, 95, 128]);
        assert_eq!(day(Storage::Bc, 64), [3, 15, 24, 32]);
        assert_eq!(day(Storage::Bc, 8), [0, 1, 3, 18]);
        assert_eq!(day(Storage::Bc, 0), [0; 4]);
    }

    #[test]
    fn a_budget_is_used_and_never_exceeded() {
        let layers = paper(Storage::Plain);
        for budget in (0..200).map(|n| n * n * n * 1_000) {
            let pools = plan_pools(&layers, budget);
            assert!(total(&pools) <= budget, "{budget}");
            // The remainder would not hold the smallest tile that has no slot yet.
            let is_full = |layer: MapLayer| slots(&pools, layer).iter().all(|n| *n == 128);
            if budget > 1_000_000 && !MapLayer::ALL.into_iter().all(is_full) {
                assert!(
                    total(&pools) as f64 > 0.8 * budget as f64,
                    "{budget}: {pools:?}"
                );
            }
        }
        let pools = plan_pools(&layers, u64::MAX);
        assert_eq!(pools.len(), 20);
        assert!(pools.iter().all(|pool| pool.slots == 128));
    }

    #[test]
    fn there_are_no_more_slots_than_tiles() {
        let mut layers = paper(Storage::Bc);
        let shape = layers[0].levels[0].shape;
        layers[0].levels[0].present = TileSet::of_blocks(shape, BlockSet(0b111));
        layers[1].levels[2].present = TileSet::none(layers[1].levels[2].shape);
        layers[4].levels.truncate(1);
        let pools = plan_pools(&layers, u64::MAX);
        assert_eq!(slots(&pools, MapLayer::Day), [3, 128, 128, 128]);
        assert_eq!(slots(&pools, MapLayer::Clouds), [128, 128, 0, 128]);
        assert_eq!(slots(&pools, MapLayer::Water), [0; 4]);
        assert!(pools.iter().all(|pool| pool.slots > 0));
    }

    #[test]
    fn a_map_of_less_detail_is_not_starved() {
        let mut layers = paper(Storage::Plain);
        // Slopes of a small elevation map: 375 texels per block at the finest.
        layers[2].levels.remove(0);
        let pools = plan_pools(&layers, 64 << 20);
        let [fine, middle, coarse, _] = slots(&pools, MapLayer::Normals);
        let day = slots(&pools, MapLayer::Day);
        assert!(fine >= day[1] && middle >= day[2] && coarse >= day[3]);
        assert!(fine > 0, "{pools:?}");
    }

    #[test]
    fn layouts_that_break_the_contract_get_nothing() {
        let layers = paper(Storage::Plain);
        let mut none = layers[0].clone();
        none.levels.clear();
        let mut many = layers[1].clone();
        many.levels = vec![many.levels[0].clone(); MAX_LEVELS + 1];
        let twice = [layers[2].clone(), layers[2].clone()];
        let pools = plan_pools(&[none, many], 1 << 30);
        assert_eq!(pools, []);
        assert_eq!(
            plan_pools(&twice, 1 << 30),
            plan_pools(&twice[..1], 1 << 30)
        );
        assert_eq!(plan_pools(&[], 1 << 30), []);
    }
}
