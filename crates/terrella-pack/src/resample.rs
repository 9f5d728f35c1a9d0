//! Resampling of a map's rows to another size while they are read.
//!
//! If the source is at least as fine as the level, a texel is the mean over its footprint, with partial weights for source texels at the edge. If
//! it is coarser, values are interpolated by cubic convolution (Catmull–Rom), which passes through the source's texels and has no facets. The
//! result is clamped between the two texels on either side, in each direction, because its overshoot would draw black lines along bright coasts.
//! Longitude is periodic. Beyond a pole the rows continue on the opposite meridian, where slopes have the opposite sign.
//!
//! Each value is computed from its own source texels in one order, whichever columns are requested: passes over parts of a map give the same bits
//! as one pass over all of it.

use std::collections::VecDeque;

/// Width and height of the source and of the level made from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sizes {
    pub source: (u32, u32),
    pub level: (u32, u32),
}

/// The requested columns, and those half a turn away, which are beyond the poles.
pub(super) const LANES: usize = 2;

/// Position of the edge of a texel on a line of the source: whole texels and the fraction, 0…1.
fn edge(texel: u32, source: u32, level: u32) -> (u32, f32) {
    let place = u64::from(texel) * u64::from(source);
    let level = u64::from(level);
    (
        (place / level) as u32,
        ((place % level) as f64 / level as f64) as f32,
    )
}

/// Position of a texel's centre between two centres of the source: the index of the first, and the fraction of the way to the second.
fn centre(texel: u32, source: u32, level: u32) -> (i64, f32) {
    let twice = (2 * i64::from(texel) + 1) * i64::from(source) - i64::from(level);
    let step = 2 * i64::from(level);
    (
        twice.div_euclid(step),
        (twice.rem_euclid(step) as f64 / step as f64) as f32,
    )
}

/// Catmull–Rom between `b` and `c`, held between them.
#[inline]
pub(super) fn cubic([a, b, c, d]: [f32; 4], t: f32) -> f32 {
    let value =
        b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)));
    value.clamp(b.min(c), b.max(c))
}

/// How the columns of a lane are computed from a source row.
enum Columns {
    /// First texel and its weight, the one after the last whole texel and its weight.
    Box(Vec<(u32, f32, u32, f32)>),
    /// Four texels, and the place between the middle two.
    Cubic(Vec<([u32; 4], f32)>),
}

impl Columns {
    /// `count` columns from `first` on, which may extend beyond the edges.
    fn new(source: u32, level: u32, first: i64, count: usize) -> Self {
        let columns = (first..)
            .take(count)
            .map(|column| column.rem_euclid(i64::from(level)) as u32);
        if source >= level {
            Self::Box(
                columns
                    .map(|column| {
                        let (start, skipped) = edge(column, source, level);
                        let (end, last) = edge(column + 1, source, level);
                        (start, 1.0 - skipped, end, last)
                    })
                    .collect(),
            )
        } else {
            Self::Cubic(
                columns
                    .map(|column| {
                        let (left, t) = centre(column, source, level);
                        let texels = [-1, 0, 1, 2]
                            .map(|offset| (left + offset).rem_euclid(i64::from(source)) as u32);
                        (texels, t)
                    })
                    .collect(),
            )
        }
    }

    /// Sums (box) or values (cubic) of the columns.
    fn apply<const C: usize>(&self, row: &[f32], out: &mut [f32]) {
        let (row, _) = row.as_chunks::<C>();
        let (out, _) = out.as_chunks_mut::<C>();
        match self {
            Self::Box(columns) => {
                for (out, (start, first, end, last)) in out.iter_mut().zip(columns) {
                    let texels = &row[*start as usize..*end as usize];
                    let mut sum = texels[0].map(|value| value * first);
                    for texel in &texels[1..] {
                        for channel in 0..C {
                            sum[channel] += texel[channel];
                        }
                    }
                    if *last > 0.0 {
                        let texel = &row[*end as usize];
                        for channel in 0..C {
                            sum[channel] += texel[channel] * last;
                        }
                    }
                    *out = sum;
                }
            }
            Self::Cubic(columns) => {
                for (out, (texels, t)) in out.iter_mut().zip(columns) {
                    let texels = texels.map(|texel| &row[texel as usize]);
                    for channel in 0..C {
                        out[channel] = cubic(texels.map(|texel| texel[channel]), *t);
                    }
                }
            }
        }
    }
}

/// One level's rows of one range of columns.
pub(super) struct Resampler<const C: usize> {
    sizes: Sizes,
    lanes: [Lane; LANES],
    /// Source rows before and from which the opposite meridian is looked at.
    north_end: u32,
    south_start: u32,
    scale: f32,
    row: Vec<f32>,
}

struct Lane {
    columns: Columns,
    /// The next row to be made.
    next: u32,
    /// The source row that would follow the last one taken.
    expected: u32,
    /// Minifying: the sum so far of row `next`.
    sum: Vec<f32>,
    /// Magnifying: the last rows taken, each with its place, −2…height + 1.
    rows: VecDeque<(i64, Vec<f32>)>,
}

impl<const C: usize> Resampler<C> {
    /// For `count` columns of the level from `first` on. On the opposite meridian only the first and last `polar_rows` rows are computed.
    pub(super) fn new(sizes: Sizes, first: i64, count: usize, polar_rows: u32) -> Self {
        let (source, level) = (sizes.source, sizes.level);
        let lane = |first: i64| Lane {
            columns: Columns::new(source.0, level.0, first, count),
            next: 0,
            expected: 0,
            sum: vec![0.0; count * C],
            rows: VecDeque::new(),
        };
        // Footprints and the cubic's reach included.
        let reach = edge(polar_rows + 1, source.1, level.1).0 + 4;
        let is_box = source.0 >= level.0;
        let area =
            f64::from(source.0) / f64::from(level.0) * f64::from(source.1) / f64::from(level.1);
        Self {
            sizes,
            lanes: [lane(first), lane(first + i64::from(level.0 / 2))],
            north_end: reach,
            south_start: source.1.saturating_sub(reach),
            scale: if is_box { (1.0 / area) as f32 } else { 1.0 },
            row: vec![0.0; count * C],
        }
    }

    /// Bytes held for so many columns, about.
    pub(super) fn bytes(count: usize) -> u64 {
        (count * (2 * 24 + 14 * 4 * C)) as u64
    }

    fn is_box(&self) -> bool {
        self.sizes.source.0 >= self.sizes.level.0
    }

    /// Takes source row `y` and gives the rows that it completes: `give(lane, row of the level, values)`.
    pub(super) fn push<E>(
        &mut self,
        y: u32,
        source: &[f32],
        give: &mut impl FnMut(usize, u32, &[f32]) -> Result<(), E>,
    ) -> Result<(), E> {
        for lane in 0..LANES {
            if lane == 1 && y >= self.north_end && y < self.south_start {
                continue;
            }
            self.lanes[lane].columns.apply::<C>(source, &mut self.row);
            if self.is_box() {
                self.add(lane, y, give)?;
            } else {
                self.keep(lane, y);
            }
        }
        if !self.is_box() {
            // Both lanes have their rows: the values beyond the north pole are known.
            if y == 1 {
                self.mirror([0, 1], |place| -1 - place, true);
            }
            if y + 1 == self.sizes.source.1 {
                let height = i64::from(self.sizes.source.1);
                self.mirror(
                    [height - 1, height - 2],
                    |place| 2 * height - 1 - place,
                    false,
                );
            }
            if y >= 1 {
                for lane in 0..LANES {
                    self.interpolate(lane, give)?;
                }
            }
        }
        Ok(())
    }

    /// Minifying: adds the row at `self.row` to the rows that it overlaps.
    fn add<E>(
        &mut self,
        lane: usize,
        y: u32,
        give: &mut impl FnMut(usize, u32, &[f32]) -> Result<(), E>,
    ) -> Result<(), E> {
        let ((_, source), (_, level)) = (self.sizes.source, self.sizes.level);
        let Lane {
            next,
            expected,
            sum,
            ..
        } = &mut self.lanes[lane];
        if *expected != y {
            // Rows were left out: go on with the first row that begins at this one or later.
            sum.fill(0.0);
            while *next < level && edge(*next, source, level) < (y, 0.0) {
                *next += 1;
            }
        }
        *expected = y + 1;
        while *next < level {
            let (start, skipped) = edge(*next, source, level);
            let (end, last) = edge(*next + 1, source, level);
            if start > y {
                break;
            }
            let from = if start == y { skipped } else { 0.0 };
            let to = if end == y { last } else { 1.0 };
            let weight = to - from;
            for (sum, value) in sum.iter_mut().zip(&self.row) {
                *sum += weight * value;
            }
            let is_done = end == y || (end == y + 1 && last == 0.0);
            if !is_done {
                break;
            }
            for value in sum.iter_mut() {
                *value *= self.scale;
            }
            give(lane, *next, sum)?;
            sum.fill(0.0);
            *next += 1;
        }
        Ok(())
    }

    /// Magnifying: remembers the row at `self.row`.
    fn keep(&mut self, lane: usize, y: u32) {
        let Lane { expected, rows, .. } = &mut self.lanes[lane];
        if *expected != y {
            rows.clear();
        }
        *expected = y + 1;
        let mut row = if rows.len() >= 6 {
            rows.pop_front().map(|(_, row)| row).unwrap_or_default()
        } else {
            Vec::new()
        };
        row.clear();
        row.extend_from_slice(&self.row);
        rows.push_back((i64::from(y), row));
    }

    /// Magnifying: puts rows of each lane beyond the pole of the other.
    fn mirror(&mut self, places: [i64; 2], beyond: impl Fn(i64) -> i64, in_front: bool) {
        // Only slopes have a direction; they alone have two channels.
        let sign = if C == 2 { -1.0 } else { 1.0 };
        let mirrored: Vec<Vec<(i64, Vec<f32>)>> = (0..LANES)
            .map(|lane| {
                let others = &self.lanes[1 - lane].rows;
                let found = places.iter().filter_map(|place| {
                    let (place, row) = others.iter().find(|(at, _)| at == place)?;
                    Some((
                        beyond(*place),
                        row.iter().map(|value| value * sign).collect(),
                    ))
                });
                found.collect()
            })
            .collect();
        for (lane, rows) in self.lanes.iter_mut().zip(mirrored) {
            for row in rows {
                if in_front {
                    lane.rows.push_front(row);
                } else {
                    lane.rows.push_back(row);
                }
            }
        }
    }

    /// Magnifying: gives all rows whose four source rows are there.
    fn interpolate<E>(
        &mut self,
        lane: usize,
        give: &mut impl FnMut(usize, u32, &[f32]) -> Result<(), E>,
    ) -> Result<(), E> {
        let ((_, source), (_, level)) = (self.sizes.source, self.sizes.level);
        let Lane {
            next, rows, sum, ..
        } = &mut self.lanes[lane];
        let (Some((first, _)), Some((last, _))) = (rows.front(), rows.back()) else {
            return Ok(());
        };
        while *next < level {
            let (above, t) = centre(*next, source, level);
            if above + 2 > *last {
                break;
            }
            if above > *first {
                let at = (above - 1 - first) as usize;
                let taps = [0, 1, 2, 3].map(|offset| rows[at + offset].1.as_slice());
                for (x, value) in sum.iter_mut().enumerate() {
                    *value = cubic(taps.map(|row| row[x]), t);
                }
                give(lane, *next, sum)?;
            }
            *next += 1;
        }
        Ok(())
    }
}
