//! Ice on the sea, from monthly temperatures of its surface. Ice lies where the water is coldest, and in each month on as much of a hemisphere as
//! the satellites' long-term mean.

use super::climates::{Climates, share};
use super::{COLUMNS, Grid, MONTHS, ROWS, area, blurred, latitude};
use anyhow::{Context, Result, bail, ensure};
use std::path::Path;

/// Mean extent of the ice of each month north and south of the equator, 1981 to 2010, million km²: NSIDC Sea Ice Index (Fetterer and others). Approximate:
/// not checked against the published table.
const EXTENT: [[f64; MONTHS]; 2] = [
    [
        14.4, 15.3, 15.4, 14.7, 13.3, 11.8, 9.5, 7.2, 6.4, 8.4, 10.7, 12.8,
    ],
    [
        5.0, 3.1, 4.0, 6.9, 10.1, 13.4, 16.0, 17.6, 18.5, 18.1, 16.0, 11.2,
    ],
];
/// Latitudes beyond which ice may be, north and south.
const LEAST_LATITUDE: [f64; 2] = [40.0, 45.0];
/// Rise of the temperature from all ice to none, °C, and the cover where the extent ends.
const EDGE: f64 = 0.5;
const COVER_AT_EXTENT: f64 = 0.15;
/// Smoothing of the ice, degrees: its edge shows no cells.
const ICE_EDGE: f64 = 0.7;
/// Smoothing of the temperatures north and south of the equator, degrees: they have a cell for every two, and few ships have measured beside
/// Antarctica.
const SMOOTHED: [f64; 2] = [1.5, 6.0];

/// Distances from the nearest measured water, degrees, between which waters become enclosed: they freeze by the climate of the land about them.
const ENCLOSED: [f64; 2] = [1.5, 3.0];
/// South, north, west and east of waters where nobody has measured in winter, and these months; the source has 1 to 11 °C under their ice: Hudson Bay
/// and its strait, the Canadian Arctic, Baffin Bay, the Kara Sea and the shelf of Siberia, and the north of the Sea of Okhotsk.
const UNMEASURED: [[f64; 4]; 4] = [
    [50.0, 66.0, -96.0, -64.0],
    [66.0, 84.0, -130.0, -50.0],
    [68.0, 80.0, 60.0, 180.0],
    [53.0, 60.0, 134.0, 154.0],
];
const WINTER: [usize; 6] = [11, 0, 1, 2, 3, 4];

/// Cells of the source: two degrees wide, from 89.5° S and 20.5° E.
const SOURCE: (usize, usize) = (180, 90);
const FIRST: (f64, f64) = (20.5, -89.5);
const STEP: f64 = 2.0;

/// Temperatures of the sea.
pub struct Ocean {
    /// At the surface in the middle of each month, °C, on land those of the nearest sea.
    temperatures: Vec<Grid>,
    /// How much a water is enclosed in each month, 0…1.
    enclosed: Vec<Grid>,
}

/// Reads the source.
pub fn read(path: &Path) -> Result<Ocean> {
    let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
    let mut maps = surface(&bytes).with_context(|| path.display().to_string())?;
    for month in WINTER {
        let map = &mut maps[month];
        for (cell, value) in map.iter_mut().enumerate() {
            let (longitude, latitude) = place(cell);
            let is_in = |[south, north, west, east]: &[f64; 4]| {
                (*south..*north).contains(&latitude) && (*west..*east).contains(&longitude)
            };
            if UNMEASURED.iter().any(is_in) {
                *value = None;
            }
        }
    }
    let enclosed = maps.iter().map(|map| enclosed(map)).collect();
    let smooth = |map| smoothed(&resampled(&filled(map)));
    Ok(Ocean {
        temperatures: maps.into_iter().map(smooth).collect(),
        enclosed,
    })
}

/// Longitude and latitude of a cell of the source, degrees.
fn place(cell: usize) -> (f64, f64) {
    let (column, row) = (cell % SOURCE.0, cell / SOURCE.0);
    let longitude = FIRST.0 + STEP * column as f64;
    (
        (longitude + 180.0).rem_euclid(360.0) - 180.0,
        FIRST.1 + STEP * row as f64,
    )
}

/// How much a water is enclosed, by its distance from the nearest cell that has a value.
fn enclosed(map: &[Option<f64>]) -> Grid {
    let known = map.iter().enumerate().filter(|(_, value)| value.is_some());
    let known: Vec<_> = known.map(|(cell, _)| place(cell)).collect();
    let cells = 0..COLUMNS * ROWS;
    let values = cells.map(|cell| {
        let (x, y) = (
            (cell % COLUMNS) as f64 + 0.5 - 180.0,
            latitude(cell / COLUMNS),
        );
        let width = y.to_radians().cos();
        let far = |(longitude, latitude): &(f64, f64)| {
            let east = (longitude - x + 540.0).rem_euclid(360.0) - 180.0;
            (east * width).hypot(latitude - y)
        };
        let nearest = known.iter().map(far).fold(f64::INFINITY, f64::min);
        share(ENCLOSED, nearest)
    });
    values.collect()
}

/// The variable TEMP of a netCDF file in the classic format, (time, depth, latitude, longitude): its first depth.
fn surface(bytes: &[u8]) -> Result<Vec<Vec<Option<f64>>>> {
    let mut header = Header { bytes, at: 4 };
    ensure!(
        bytes.starts_with(b"CDF\x01"),
        "it is no netCDF file of the first version"
    );
    let _records = header.word()?;
    let mut sizes = Vec::new();
    for _ in 0..header.list()? {
        header.name()?;
        sizes.push(header.word()? as usize);
    }
    header.skip_attributes()?;
    let (mut found, mut record_bytes) = (None, 0);
    for _ in 0..header.list()? {
        let name = header.name()?;
        let mut shape = Vec::new();
        for _ in 0..header.word()? {
            let dimension = header.word()? as usize;
            shape.push(*sizes.get(dimension).context("a dimension is missing")?);
        }
        header.skip_attributes()?;
        let [kind, bytes, begin] = [header.word()?, header.word()?, header.word()?];
        if shape.first() == Some(&0) {
            record_bytes += bytes as usize;
        }
        if name == b"TEMP" {
            ensure!(kind == 5, "TEMP has no 32-bit floating-point numbers");
            found = Some((shape, begin as usize));
        }
    }
    let Some((shape, begin)) = found else {
        bail!("it has no variable TEMP")
    };
    let [months, depths, rows, columns] = shape[..] else {
        bail!("TEMP has {} dimensions", shape.len())
    };
    ensure!(
        (columns, rows) == SOURCE,
        "TEMP has {columns} × {rows} cells"
    );
    ensure!(months == 0 || months == MONTHS, "TEMP has {months} months");
    let stride = if months == 0 {
        record_bytes
    } else {
        depths * rows * columns * 4
    };
    (0..MONTHS)
        .map(|month| {
            let from = begin + month * stride;
            let values = bytes
                .get(from..from + rows * columns * 4)
                .context("it ends early")?;
            let (values, _) = values.as_chunks::<4>();
            Ok(values
                .iter()
                .map(|value| Some(f64::from(f32::from_be_bytes(*value))).filter(|t| *t > -100.0))
                .collect())
        })
        .collect()
}

/// A header that is read from its start.
struct Header<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Header<'a> {
    fn word(&mut self) -> Result<u32> {
        let bytes = self
            .bytes
            .get(self.at..self.at + 4)
            .context("its header ends early")?;
        self.at += 4;
        Ok(u32::from_be_bytes(bytes.try_into()?))
    }

    /// The length of a list, after its tag.
    fn list(&mut self) -> Result<u32> {
        self.word()?;
        self.word()
    }

    fn name(&mut self) -> Result<&'a [u8]> {
        let length = self.word()? as usize;
        let name = self
            .bytes
            .get(self.at..self.at + length)
            .context("its header ends early")?;
        self.at += length.next_multiple_of(4);
        Ok(name)
    }

    fn skip_attributes(&mut self) -> Result<()> {
        for _ in 0..self.list()? {
            self.name()?;
            let bytes = [0, 1, 1, 2, 4, 4, 8].get(self.word()? as usize).copied();
            let length =
                self.word()? as usize * bytes.context("an attribute of an unknown type")?;
            self.at += length.next_multiple_of(4);
        }
        Ok(())
    }
}

/// Cells without a value get the mean of their neighbours, ring by ring.
fn filled(mut map: Vec<Option<f64>>) -> Vec<f64> {
    let (columns, rows) = SOURCE;
    while map.iter().any(Option::is_none) && map.iter().any(Option::is_some) {
        let old = map.clone();
        for (cell, value) in map
            .iter_mut()
            .enumerate()
            .filter(|(_, value)| value.is_none())
        {
            let (column, row) = (cell % columns, cell / columns);
            let beside = [(column + 1) % columns, (column + columns - 1) % columns];
            let beside = beside.map(|column| row * columns + column);
            let above = [row.saturating_sub(1), (row + 1).min(rows - 1)];
            let above = above.map(|row| row * columns + column);
            let near: Vec<_> = beside
                .iter()
                .chain(&above)
                .filter_map(|cell| old[*cell])
                .collect();
            if !near.is_empty() {
                *value = Some(near.iter().sum::<f64>() / near.len() as f64);
            }
        }
    }
    map.into_iter().map(Option::unwrap_or_default).collect()
}

/// Smoothed; south of the equator no cell is warmer than one to the north of it, so that there are no holes in the ice.
fn smoothed(map: &Grid) -> Grid {
    let [north, south] = SMOOTHED.map(|sigma| blurred(map, sigma));
    let equator = COLUMNS * ROWS / 2;
    let mut map = [&north[..equator], &south[equator..]].concat();
    for cell in equator + COLUMNS..map.len() {
        map[cell] = map[cell].min(map[cell - COLUMNS]);
    }
    map
}

/// Bilinear values at the middles of the grid's cells.
fn resampled(map: &[f64]) -> Grid {
    let (columns, rows) = SOURCE;
    let cells = 0..COLUMNS * ROWS;
    let values = cells.map(|cell| {
        let longitude = (cell % COLUMNS) as f64 + 0.5 - 180.0;
        let x = (longitude - FIRST.0).rem_euclid(360.0) / STEP;
        let y = ((latitude(cell / COLUMNS) - FIRST.1) / STEP).clamp(0.0, (rows - 1) as f64);
        let (west, south) = (x as usize % columns, (y as usize).min(rows - 2));
        let (u, v) = (x.fract(), y - south as f64);
        let along = |row: usize| {
            let [west, east] =
                [west, (west + 1) % columns].map(|column| map[row * columns + column]);
            west + u * (east - west)
        };
        along(south) + v * (along(south + 1) - along(south))
    });
    values.collect()
}

impl Ocean {
    /// Cover with ice in a month, 0…1; on land that of the nearest sea. Enclosed waters are frozen by the land's climate, as few ships have measured
    /// there in winter; their ice is a part of the extent.
    pub fn ice(&self, climates: &Climates, month: usize) -> Grid {
        let by_land = climates.ice(month);
        let (temperatures, enclosed) = (&self.temperatures[month], &self.enclosed[month]);
        let side = |cell: usize| usize::from(latitude(cell / COLUMNS) < 0.0);
        let is_within = |cell: usize| latitude(cell / COLUMNS).abs() > LEAST_LATITUDE[side(cell)];
        let sea = |cell: usize| (1.0 - climates.land[cell]) * area(cell);
        let mut left = EXTENT.map(|extent| extent[month]);
        let mut open = Vec::new();
        for cell in (0..temperatures.len()).filter(|cell| is_within(*cell)) {
            if enclosed[cell] < 0.5 {
                open.push(cell);
            } else if by_land[cell] > COVER_AT_EXTENT {
                left[side(cell)] -= sea(cell);
            }
        }
        open.sort_by(|a, b| temperatures[*a].total_cmp(&temperatures[*b]));
        // The warmest water with ice of each hemisphere.
        let mut warmest = [f64::NEG_INFINITY; 2];
        for cell in open {
            let side = side(cell);
            if left[side] > 0.0 {
                left[side] -= sea(cell);
                warmest[side] = temperatures[cell];
            }
        }
        let cover = (0..temperatures.len()).map(|cell| {
            if !is_within(cell) {
                return 0.0;
            }
            let colder = warmest[side(cell)] - temperatures[cell];
            let open = (colder / EDGE + COVER_AT_EXTENT).clamp(0.0, 1.0);
            open + enclosed[cell] * (by_land[cell] - open)
        });
        blurred(&cover.collect(), ICE_EDGE)
    }
}
