//! Maps handed over row by row as they are read, for hosts that hold them elsewhere than in memory.

use super::layer::LayerImage;
use super::mips::LevelRows;
use super::texel::TexelFormat;
use super::tile::MapLayer;
use terrella_files::parallel::ThreadSync;

/// Stores maps outside this process's memory. Maps are read by several threads at the same time.
pub trait MapSink: ThreadSync {
    /// Begins a map of this size, texels. `None` keeps it in memory.
    fn begin(
        &self,
        layer: MapLayer,
        size: (u32, u32),
        format: TexelFormat,
    ) -> Option<Box<dyn MapRows + '_>>;
}

/// A map that is being taken over, all mip levels of it. Dropped before [`Self::finish`], it is incomplete.
pub trait MapRows {
    /// Takes whole rows of a level, `first` being the number of the northernmost. Rows of a level come once each, from the north or from
    /// the south.
    fn rows(&mut self, level: usize, first: u32, texels: &[u8]);

    /// Called after all rows of all levels.
    fn finish(self: Box<Self>);
}

/// Keeps all maps in memory.
pub struct KeptInMemory;

impl MapSink for KeptInMemory {
    fn begin(&self, _: MapLayer, _: (u32, u32), _: TexelFormat) -> Option<Box<dyn MapRows + '_>> {
        None
    }
}

impl LayerImage {
    /// Passes all rows of all levels, level 0 first.
    pub fn rows_to(&self, to: &mut dyn MapRows) {
        for (level, texels) in self.levels.iter().enumerate() {
            to.rows(level, 0, texels);
        }
    }

    /// Gives the map to a sink. Answers the map itself where the sink keeps it in memory, else its description.
    pub fn given_to(self, sink: &dyn MapSink, layer: MapLayer) -> Self {
        let Some(mut rows) = sink.begin(layer, (self.width, self.height), self.format) else {
            return self;
        };
        self.rows_to(&mut *rows);
        rows.finish();
        self.without_texels()
    }
}

/// A map whose rows come one by one, with its mip levels.
pub(super) struct MapBuilder<'s> {
    /// Its size and format.
    map: LayerImage,
    smaller: LevelRows,
    /// Rows of each level that came.
    taken: Vec<u32>,
    is_from_south: bool,
    target: Target<'s>,
    kept: Option<KeptLevels>,
}

enum Target<'s> {
    Memory(Vec<Vec<u8>>),
    Sink(Box<dyn MapRows + 's>),
}

/// Levels that stay in memory though a sink has the map.
struct KeptLevels {
    finest: usize,
    levels: Vec<Vec<u8>>,
}

impl<'s> MapBuilder<'s> {
    /// For a map of this size, which was found good, in a sink or in memory.
    pub fn new(
        sink: &'s dyn MapSink,
        layer: MapLayer,
        (width, height): (u32, u32),
        format: TexelFormat,
    ) -> Self {
        let (columns, rows) = (width as usize, height as usize);
        let smaller = LevelRows::new(columns, rows, format);
        let target = match sink.begin(layer, (width, height), format) {
            Some(rows) => Target::Sink(rows),
            None => {
                let whole = columns * rows * format.texel_bytes();
                let levels = std::iter::once(whole).chain(smaller.sizes());
                Target::Memory(levels.map(Vec::with_capacity).collect())
            }
        };
        Self {
            map: LayerImage {
                width,
                height,
                format,
                levels: [].into(),
            },
            taken: vec![0; 1 + smaller.sizes().count()],
            smaller,
            is_from_south: false,
            target,
            kept: None,
        }
    }

    /// Whether no sink accepts the map.
    pub fn is_in_memory(&self) -> bool {
        matches!(self.target, Target::Memory(_))
    }

    /// Keeps in memory the last level with at least this width, texels, and all smaller ones; all levels if there is none.
    pub fn keep(&mut self, width: usize) {
        let finest = self.map.level_of_width(width);
        self.kept = Some(KeptLevels {
            finest,
            levels: Vec::new(),
        });
    }

    /// Takes the next row of level 0, from the north.
    pub fn push(&mut self, row: &[u8]) {
        let (target, kept) = (&mut self.target, &mut self.kept);
        let (map, taken, is_from_south) = (&self.map, &mut self.taken, self.is_from_south);
        let mut take = |level: usize, row: &[u8]| match target {
            Target::Memory(levels) => levels[level].extend_from_slice(row),
            Target::Sink(rows) => {
                let mut number = taken[level];
                taken[level] += 1;
                if is_from_south {
                    number = map.level_size(level).1 - 1 - number;
                }
                rows.rows(level, number, row);
                if let Some(kept) = kept {
                    kept.take(level, row);
                }
            }
        };
        take(0, row);
        self.smaller.push(row, &mut take);
    }

    /// Takes all rows of level 0 for a sink, and frees them meanwhile where that changes nothing.
    pub fn push_all(&mut self, mut texels: Vec<u8>) {
        let row_bytes = self.map.width as usize * self.map.format.texel_bytes();
        // Sums of two rows are the same from the south, and sums of three are not.
        self.is_from_south = self.map.height.is_power_of_two();
        if !self.is_from_south {
            texels
                .chunks_exact(row_bytes)
                .for_each(|row| self.push(row));
            return;
        }
        // Allocators give back the end of a large vector without a copy.
        const FREED_BYTES: usize = 1 << 20;
        let rows_at_once = (FREED_BYTES / row_bytes).max(1);
        while !texels.is_empty() {
            let rows = texels.len() / row_bytes;
            let left = rows.saturating_sub(rows_at_once) * row_bytes;
            let tail = texels[left..].rchunks_exact(row_bytes);
            tail.for_each(|row| self.push(row));
            texels.truncate(left);
            texels.shrink_to_fit();
        }
    }

    /// The map, or its description if the sink has it, and the map requested by [`Self::keep`]; without that, a second description.
    pub fn finish(self) -> (LayerImage, LayerImage) {
        let mut map = self.map;
        match self.target {
            Target::Memory(levels) => {
                map.levels = levels.into();
                (map.clone(), map)
            }
            Target::Sink(rows) => {
                rows.finish();
                let kept = self.kept.map(|kept| kept.of(&map));
                let kept = kept.unwrap_or_else(|| map.clone());
                (map, kept)
            }
        }
    }
}

impl KeptLevels {
    fn take(&mut self, level: usize, row: &[u8]) {
        let Some(place) = level.checked_sub(self.finest) else {
            return;
        };
        if self.levels.len() <= place {
            self.levels.resize_with(place + 1, Vec::new);
        }
        self.levels[place].extend_from_slice(row);
    }

    /// The kept part of a map as a map.
    fn of(self, map: &LayerImage) -> LayerImage {
        let (width, height) = map.level_size(self.finest);
        LayerImage {
            width,
            height,
            format: map.format,
            levels: self.levels.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[derive(Default)]
    struct Kept(Mutex<Vec<Vec<u8>>>);

    struct Taken<'s>(&'s Kept, Vec<Vec<u8>>);

    impl MapSink for Kept {
        fn begin(
            &self,
            _: MapLayer,
            _: (u32, u32),
            _: TexelFormat,
        ) -> Option<Box<dyn MapRows + '_>> {
            Some(Box::new(Taken(self, vec![Vec::new(); 20])))
        }
    }

    impl MapRows for Taken<'_> {
        fn rows(&mut self, level: usize, first: u32, texels: &[u8]) {
            let (levels, at) = (&mut self.1[level], first as usize * texels.len());
            match at == 0 && levels.is_empty() || at == levels.len() {
                true => levels.extend_from_slice(texels),
                // From the south: the missing rows are north of it.
                false => {
                    levels.resize(levels.len().max(at + texels.len()), 0);
                    levels[at..at + texels.len()].copy_from_slice(texels);
                }
            }
        }

        fn finish(mut self: Box<Self>) {
            self.1.retain(|level| !level.is_empty());
            *self.0.0.lock().expect("no panic") = self.1;
        }
    }

    #[test]
    fn rows_give_the_levels_of_the_whole_map() {
        for (width, height, format) in [
            (64, 32, TexelFormat::Rgba8Srgb),
            (50, 25, TexelFormat::R8Unorm),
            (7, 3, TexelFormat::Rg8Snorm),
            (1, 1, TexelFormat::R8Unorm),
        ] {
            let row_bytes = width as usize * format.texel_bytes();
            let texels: Vec<u8> = (0..row_bytes * height as usize)
                .map(|n| ((n * 2_654_435_761) >> 11) as u8)
                .collect();
            let map = match format {
                TexelFormat::Rgba8Srgb => LayerImage::from_rgba8(width, height, texels.clone()),
                TexelFormat::R8Unorm => LayerImage::from_r8(width, height, texels.clone()),
                TexelFormat::Rg8Snorm => LayerImage::from_slopes(width, height, texels.clone()),
            };
            let map = map.expect("a good map");
            let kept = Kept::default();
            for sink in [&kept as &dyn MapSink, &KeptInMemory] {
                let size = (width, height);
                let mut builder = MapBuilder::new(sink, MapLayer::Day, size, format);
                builder.keep(width as usize / 2);
                texels
                    .chunks_exact(row_bytes)
                    .for_each(|row| builder.push(row));
                let (built, kept) = builder.finish();
                if built.has_texels() {
                    assert_eq!((&built, &kept), (&map, &map));
                } else {
                    let kept_from = map.levels.len() - kept.levels.len();
                    assert_eq!(kept_from, usize::from(width > 1));
                    assert_eq!(kept.levels[..], map.levels[kept_from..]);
                    kept.check().expect("a whole map");
                }
            }
            assert_eq!(*kept.0.lock().expect("no panic"), *map.levels);
            *kept.0.lock().expect("no panic") = Vec::new();
            let mut builder = MapBuilder::new(&kept, MapLayer::Day, (width, height), format);
            builder.push_all(texels);
            assert!(!builder.finish().0.has_texels());
            assert_eq!(*kept.0.lock().expect("no panic"), *map.levels);
            *kept.0.lock().expect("no panic") = Vec::new();
            let described = map.clone().given_to(&kept, MapLayer::Day);
            assert_eq!(described, map.without_texels());
            assert!(!described.has_texels() && map.has_texels());
            assert_eq!(*kept.0.lock().expect("no panic"), *map.levels);
        }
    }
}
