//! Which parts of blocks a frame requests, for maps with levels that are cut into parts.

use super::tile_rule::{Ladder, NONE, TileRule};
use terrella_ground::globe::{BLOCK_COUNT, Block, BlockSet, Part, PartSight};
use terrella_imagery::residency::PartTables;
use terrella_imagery::stream::TileRequest;
use terrella_imagery::tile::{MAP_LAYERS, MapLayer, TileKey};

/// Levels assigned to the parts of one map's blocks in this and the previous frame, for the hysteresis. If a part was not divided, all parts inside
/// it have its level.
#[derive(Clone, Default)]
pub(super) struct PartLevels {
    depth: u8,
    now: Vec<u8>,
    before: Vec<u8>,
}

impl PartLevels {
    /// Begins a frame.
    pub fn begin(&mut self, ladder: &Ladder) {
        let Some(&depth) = ladder.depths.first() else {
            return;
        };
        let parts = (BLOCK_COUNT as usize) << (2 * depth);
        self.depth = depth;
        self.before.resize(parts, NONE);
        self.now.resize(parts, NONE);
        std::mem::swap(&mut self.now, &mut self.before);
        self.now.fill(NONE);
    }

    /// Index of the first smallest part inside a part, and how many of them its side has.
    fn place(&self, part: Part) -> (usize, usize) {
        let steps = self.depth - part.depth;
        let (row, column) = (
            usize::from(part.row) << steps,
            usize::from(part.column) << steps,
        );
        let of_block = (part.block.index() as usize) << (2 * self.depth);
        (of_block + (row << self.depth) + column, 1 << steps)
    }

    fn before(&self, part: Part) -> u8 {
        self.before[self.place(part).0]
    }

    fn note(&mut self, part: Part, level: u8) {
        let (first, side) = self.place(part);
        for row in 0..side {
            let start = first + (row << self.depth);
            self.now[start..start + side].fill(level);
        }
    }
}

/// A part of a block in sight, and its required level.
#[derive(Clone, Copy, Debug)]
pub(super) struct WantedPart {
    pub layer: MapLayer,
    pub part: Part,
    /// The requested level; its tiles are as large as the part, or larger.
    pub level: u8,
    /// The level that it is drawn with.
    pub drawn: u8,
    pub distance_m: f64,
    /// Size of a pixel on the part, metres.
    pixel_m: f64,
    key: TileKey,
}

/// The parts that a frame's views have in sight, and the parts expected to come into sight soon.
#[derive(Default)]
pub(super) struct PartRequests {
    wanted: Vec<WantedPart>,
    expected: Vec<WantedPart>,
    /// Part and level of each of `wanted`.
    levels: Vec<(Part, u8)>,
    /// The blocks of each map whose parts were searched.
    sought: [BlockSet; MAP_LAYERS],
}

impl PartRequests {
    /// Begins a frame.
    pub fn clear(&mut self) {
        self.wanted.clear();
        self.expected.clear();
        self.levels.clear();
        self.sought = Default::default();
    }

    /// Finds the parts of a block that need a cut level. With `levels` for a visible block, whose selected levels are stored there; without for an
    /// expected one.
    pub fn find(
        &mut self,
        rule: &TileRule,
        ladder: &Ladder,
        sight: &PartSight,
        pixel_rad: f64,
        (layer, block): (MapLayer, Block),
        mut levels: Option<&mut PartLevels>,
    ) {
        let found = match levels {
            Some(_) => {
                self.sought[layer.index()].insert(block.index() as u8);
                &mut self.wanted
            }
            None => &mut self.expected,
        };
        divide(Part::whole(block), &mut |part| {
            let distance_m = sight.distance_m(part)?;
            let before = levels.as_ref().map(|levels| levels.before(part));
            let level = rule.level(ladder, distance_m, pixel_rad, before);
            let depth = ladder.depths.get(usize::from(level)).copied();
            if depth.is_some_and(|depth| depth > part.depth) {
                return Some(());
            }
            if let Some(levels) = &mut levels {
                levels.note(part, level);
            }
            let key = TileKey {
                layer,
                level,
                block: block.index() as u8,
                part: part.index_at(depth?),
            };
            found.push(WantedPart {
                layer,
                part,
                level,
                drawn: ladder.whole(),
                distance_m,
                pixel_m: distance_m * pixel_rad,
                key,
            });
            None
        });
    }

    /// Adds requests for the visible parts, those with the smallest pixels first.
    pub fn request(&mut self, requests: &mut Vec<TileRequest>) {
        push(&mut self.wanted, true, requests);
        // Groups the parts of a block and map. If views request different levels of a part, the finer one comes later and takes precedence.
        self.wanted.sort_unstable_by_key(|wanted| {
            let WantedPart { part, level, .. } = wanted;
            let place = (part.depth, part.row, part.column);
            (order(wanted), u8::MAX - level, place)
        });
        let levels = self.wanted.iter().map(|wanted| (wanted.part, wanted.level));
        self.levels.extend(levels);
    }

    /// Adds requests for the expected parts.
    pub fn request_expected(&mut self, requests: &mut Vec<TileRequest>) {
        push(&mut self.expected, false, requests);
    }

    fn range(&self, layer: MapLayer, block: u8) -> std::ops::Range<usize> {
        let of = (layer.index(), u32::from(block));
        let start = self.wanted.partition_point(|wanted| order(wanted) < of);
        let end = self.wanted.partition_point(|wanted| order(wanted) <= of);
        start..end
    }

    /// Visible parts of a block, each with its level.
    pub fn of(&self, layer: MapLayer, block: u8) -> &[(Part, u8)] {
        &self.levels[self.range(layer, block)]
    }

    /// Visible parts of a block, with the levels that they are drawn with.
    pub fn drawn(&self, layer: MapLayer, block: u8) -> &[WantedPart] {
        &self.wanted[self.range(layer, block)]
    }

    /// Whether no part of a block is visible, although the whole block passes culling.
    pub fn is_out_of_sight(&self, layer: MapLayer, block: u8) -> bool {
        self.sought[layer.index()].contains(block) && self.range(layer, block).is_empty()
    }

    /// Notes what the parts of a block are drawn with.
    pub fn note_drawn(&mut self, layer: MapLayer, block: u8, ladder: &Ladder, tables: &PartTables) {
        let Some(table) = tables.tables.last() else {
            return;
        };
        if (table.layer, table.block) != (layer, block) {
            return;
        }
        let cells = tables.cells(table);
        let range = self.range(layer, block);
        for wanted in &mut self.wanted[range] {
            let part = wanted.part;
            let cell = match table.depth.checked_sub(part.depth) {
                None => part.index_at(table.depth),
                Some(finer) => ((part.row << finer) << table.depth) + (part.column << finer),
            };
            let depth = cells.get(usize::from(cell)).map_or(0, |cell| cell.depth);
            let level = ladder.depths.iter().position(|of_level| *of_level == depth);
            wanted.drawn = level.map_or(ladder.whole(), |level| level as u8);
        }
    }
}

fn order(wanted: &WantedPart) -> (usize, u32) {
    (wanted.layer.index(), wanted.part.block.index())
}

fn push(parts: &mut [WantedPart], drawn: bool, requests: &mut Vec<TileRequest>) {
    parts.sort_unstable_by(|a, b| {
        let by_size = a.pixel_m.total_cmp(&b.pixel_m);
        by_size.then(a.key.cmp(&b.key))
    });
    requests.extend(parts.iter().map(|part| TileRequest {
        key: part.key,
        drawn,
    }));
}

/// Descends into the quarters of a part where `goes_on` returns a value.
fn divide(part: Part, goes_on: &mut impl FnMut(Part) -> Option<()>) {
    if goes_on(part).is_some() {
        for quarter in part.quarters() {
            divide(quarter, goes_on);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_of_parts_are_those_of_the_frame_before() {
        let ladder = Ladder {
            pixels: vec![64, 32, 16, 8],
            depths: vec![2, 1],
        };
        let mut levels = PartLevels::default();
        levels.begin(&ladder);
        let block = Block { column: 3, row: 2 };
        let whole = Part::whole(block);
        let [north_west, _, _, south_east] = whole.quarters();
        levels.note(south_east, 1);
        levels.note(north_west.quarters()[3], 0);
        assert_eq!(levels.before(south_east), NONE);
        levels.begin(&ladder);
        assert_eq!(levels.before(south_east), 1);
        assert!(
            south_east
                .quarters()
                .iter()
                .all(|part| levels.before(*part) == 1)
        );
        assert_eq!(levels.before(north_west.quarters()[3]), 0);
        assert_eq!(levels.before(north_west), NONE);
        levels.begin(&ladder);
        assert_eq!(levels.before(south_east), NONE);
    }
}
