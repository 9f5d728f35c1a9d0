//! A tile source for tests: in memory, sparse, with correct means, and as slow as a test requests.

use crate::elevation::{
    Bounds, Georeference, GridLimits, HeightGrid, HeightRange, HeightSamples, HeightTileError,
    HeightTileKey, HeightTileLayout, HeightTileSource, Registration,
};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicI64, AtomicUsize, Ordering};
use std::time::Duration;

pub(crate) struct TestTiles {
    layout: HeightTileLayout,
    /// Heights of all samples by level, row by row.
    levels: Vec<Vec<f32>>,
    ranges: BTreeMap<HeightTileKey, HeightRange>,
    /// Number of reads below the coarsest level that may complete; the others wait.
    permits: AtomicI64,
    /// Number of completed reads below the coarsest level.
    pub reads: AtomicUsize,
}

impl TestTiles {
    /// Rough ground in tiles of `side` samples. Below the coarsest level, only tiles with `is_present` and their ancestors exist.
    pub fn new(levels: u8, side: u32, is_present: impl Fn(HeightTileKey) -> bool) -> Self {
        let layout = HeightTileLayout::new(levels, 16, side, 1).expect("sound");
        let size = |level: u8| {
            let columns = (layout.columns(level) * side) as usize;
            (columns, columns / 2)
        };
        let (columns, rows) = size(0);
        let height = |n: usize| {
            let (i, j) = (n % columns, n / columns);
            let (x, y) = (i as f64 / columns as f64, j as f64 / rows as f64);
            let wave = (x * 40.0).sin() * (y * 31.0).cos() + (x * 190.0 + y * 230.0).sin() * 0.4;
            let mixed = (n as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
            (2000.0 * wave + mixed as f64 * (900.0 / 16_777_216.0)) as f32
        };
        let mut all: Vec<Vec<f32>> = vec![(0..columns * rows).map(height).collect()];
        for level in 1..levels {
            let (columns, rows) = size(level);
            let fine = &all[usize::from(level) - 1];
            let mean = |n: usize| {
                let (i, j) = (2 * (n % columns), 2 * (n / columns));
                let at = |i: usize, j: usize| fine[j * 2 * columns + i];
                0.25 * (at(i, j) + at(i + 1, j) + at(i, j + 1) + at(i + 1, j + 1))
            };
            let means = (0..columns * rows).map(mean).collect();
            all.push(means);
        }
        let mut tiles = Self {
            layout,
            levels: all,
            ranges: BTreeMap::new(),
            permits: AtomicI64::new(i64::MAX / 2),
            reads: AtomicUsize::new(0),
        };
        for level in 0..levels {
            for row in 0..layout.rows(level) {
                for column in 0..layout.columns(level) {
                    let key = HeightTileKey { level, column, row };
                    let exists = level + 1 == levels || is_present(key);
                    let below = (0..4).filter_map(|k| key.child(k));
                    let mut below: Vec<_> = below
                        .filter_map(|k| tiles.ranges.get(&k).copied())
                        .collect();
                    if exists || !below.is_empty() {
                        let samples = tiles.samples(key);
                        let low = samples.iter().copied().fold(f32::INFINITY, f32::min);
                        let high = samples.iter().copied().fold(f32::NEG_INFINITY, f32::max);
                        below.push(HeightRange {
                            low_m: low.into(),
                            high_m: high.into(),
                        });
                        let range = HeightRange {
                            low_m: below.iter().map(|r| r.low_m).fold(f64::INFINITY, f64::min),
                            high_m: below
                                .iter()
                                .map(|r| r.high_m)
                                .fold(f64::NEG_INFINITY, f64::max),
                        };
                        tiles.ranges.insert(key, range);
                    }
                }
            }
        }
        tiles
    }

    /// Blocks all reads until [`Self::allow`].
    pub fn gated(self) -> Self {
        self.permits.store(0, Ordering::SeqCst);
        self
    }

    /// Lets this many more reads complete.
    pub fn allow(&self, reads: i64) {
        self.permits.fetch_add(reads, Ordering::SeqCst);
    }

    /// Whether a new read may complete.
    pub fn may_read(&self) -> bool {
        self.permits.load(Ordering::SeqCst) > 0
    }

    /// Number of tiles below the coarsest level.
    pub fn count(&self) -> usize {
        let finer = |key: &&HeightTileKey| key.level < self.layout.coarsest();
        self.ranges.keys().filter(finer).count()
    }

    /// The finest level as one grid, without tiles.
    pub fn grid(&self) -> HeightGrid {
        let columns = self.layout.columns(0) * self.layout.side();
        let place =
            Georeference::from_bounds(Registration::Cells, &Bounds::GLOBE, columns, columns / 2);
        let place = place.expect("the whole Earth");
        HeightGrid::new(&place, self.levels[0].clone(), &GridLimits::default()).expect("sound")
    }

    fn samples(&self, key: HeightTileKey) -> Vec<f32> {
        let side = i64::from(self.layout.side());
        let columns = i64::from(self.layout.columns(key.level)) * side;
        let (x, y) = (i64::from(key.column) * side, i64::from(key.row) * side);
        let level = &self.levels[usize::from(key.level)];
        let around = -1..side + 1;
        let rows = around.clone().map(|j| (y + j).clamp(0, columns / 2 - 1));
        rows.flat_map(|j| {
            let columns = around.clone().map(move |i| (x + i).rem_euclid(columns));
            columns.map(move |i| (j, i))
        })
        .map(|(j, i)| level[(j * columns + i) as usize])
        .collect()
    }
}

impl HeightTileSource for TestTiles {
    fn layout(&self) -> HeightTileLayout {
        self.layout
    }

    fn range_m(&self, key: HeightTileKey) -> Option<HeightRange> {
        self.ranges.get(&key).copied()
    }

    fn read(
        &self,
        key: HeightTileKey,
        cancelled: &dyn Fn() -> bool,
    ) -> Result<HeightSamples, HeightTileError> {
        if !self.ranges.contains_key(&key) {
            return Err(HeightTileError::Absent(key));
        }
        if key.level < self.layout.coarsest() {
            let take = |permits: i64| (permits > 0).then(|| permits - 1);
            while self
                .permits
                .fetch_update(Ordering::SeqCst, Ordering::SeqCst, take)
                .is_err()
            {
                if cancelled() {
                    return Err(HeightTileError::Cancelled(key));
                }
                std::thread::sleep(Duration::from_micros(200));
            }
            self.reads.fetch_add(1, Ordering::SeqCst);
        }
        Ok(HeightSamples::F32(self.samples(key)))
    }
}
