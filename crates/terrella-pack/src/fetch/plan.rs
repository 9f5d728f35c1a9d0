//! Which files of a source are needed for a region and a fineness.

use super::address::{TileNames, of_tile, with_time};
use super::error::FetchError;
use super::source::{Files, MapSource, Tiles};
use crate::mosaic::{Bounds, Crs};
use std::ops::Range;

/// Most tiles of one fetch.
const MOST_TILES: u64 = 4_000_000;

/// A file to fetch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Wanted {
    /// Its address.
    pub url: String,
    /// Its key in the journal.
    pub key: String,
    /// Where it is kept, in its folder.
    pub file: String,
    /// Its BLAKE3, where it is known beforehand.
    pub blake3: Option<String>,
}

/// Tiles of one level: rectangles of columns and rows. Two where the region crosses the date line.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TilePlan {
    pub level: u32,
    /// Degrees of longitude that a tile spans.
    pub tile_deg: f64,
    /// Columns and rows from the north-west.
    pub blocks: Vec<(Range<u32>, Range<u32>)>,
}

/// Which level is fetched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fineness {
    /// The level with this number.
    Level(u32),
    /// The coarsest level with so many texels round the Earth, or the finest there is.
    Width(u32),
}

impl Tiles {
    /// Degrees of longitude that a tile of a level spans.
    pub(super) fn tile_deg(&self, level: u32) -> f64 {
        self.level_0_tile_deg / f64::from(1_u32 << level)
    }

    /// Texels round the Earth at a level.
    pub(super) fn width(&self, level: u32) -> f64 {
        360.0 * f64::from(self.tile_size) / self.tile_deg(level)
    }

    /// Columns and rows of the grid at a level; the last ones may reach beyond the Earth.
    fn grid(&self, level: u32) -> (u32, u32) {
        let count = |whole_deg: f64| (whole_deg / self.tile_deg(level) - 1e-9).ceil().max(1.0);
        // Below 2^24 · 360.
        (count(360.0) as u32, count(2.0 * self.crs.top_deg()) as u32)
    }

    pub(super) fn plan(&self, fineness: Fineness, region: &Bounds) -> Result<TilePlan, FetchError> {
        let [coarsest, finest] = self.levels;
        let level = match fineness {
            Fineness::Level(level) if !(coarsest..=finest).contains(&level) => {
                return Err(FetchError::Option {
                    option: "--level",
                    cause: format!("the source has levels {coarsest} to {finest}"),
                });
            }
            Fineness::Level(level) => level,
            Fineness::Width(width) => (coarsest..=finest)
                .find(|level| self.width(*level) >= f64::from(width) * 0.999)
                .unwrap_or(finest),
        };
        let (columns, rows) = self.grid(level);
        let tile_deg = self.tile_deg(level);
        // A tile that is touched by a thousandth is not needed.
        let range = |from_deg: f64, to_deg: f64, most: u32| {
            let first = (from_deg / tile_deg + 1e-3)
                .floor()
                .clamp(0.0, f64::from(most));
            let end = (to_deg / tile_deg - 1e-3)
                .ceil()
                .clamp(first, f64::from(most));
            first as u32..end as u32
        };
        let top_deg = self.crs.top_deg();
        let row_range = range(
            top_deg - self.crs.northing_deg(region.north_deg).min(top_deg),
            top_deg - self.crs.northing_deg(region.south_deg).max(-top_deg),
            rows,
        );
        // From 180° W on; the part beyond the date line is repeated at the beginning.
        let west_deg = (region.west_deg + 180.0).rem_euclid(360.0);
        let east_deg = west_deg + region.width_deg();
        let mut column_ranges = vec![range(west_deg, east_deg.min(360.0), columns)];
        if east_deg > 360.0 + 1e-6 {
            column_ranges.push(range(0.0, east_deg - 360.0, columns));
        }
        let blocks: Vec<_> = column_ranges
            .into_iter()
            .filter(|columns| !columns.is_empty() && !row_range.is_empty())
            .map(|columns| (columns, row_range.clone()))
            .collect();
        let plan = TilePlan {
            level,
            tile_deg,
            blocks,
        };
        if plan.count() == 0 || plan.count() > MOST_TILES {
            return Err(FetchError::Option {
                option: "--region, --level",
                cause: format!(
                    "{} tiles are needed, and 1 to {MOST_TILES} are allowed",
                    plan.count()
                ),
            });
        }
        Ok(plan)
    }

    /// A tile of a plan.
    pub(super) fn wanted(&self, time: Option<&str>, level: u32, column: u32, row: u32) -> Wanted {
        let number = level.to_string();
        let (_, rows) = self.grid(level);
        let names = TileNames {
            level: self.level_names.get(level as usize).unwrap_or(&number),
            column,
            row,
            row_from_south: rows - 1 - row.min(rows - 1),
        };
        Wanted {
            url: of_tile(&with_time(&self.url, time), names),
            key: format!("{row}/{column}"),
            file: format!("{row}/{column}.{}", self.media.ending()),
            blake3: None,
        }
    }

    /// The highest latitude of its grid, degrees.
    pub(super) fn end_deg(&self) -> f64 {
        match self.crs {
            Crs::Geographic => 90.0,
            Crs::WebMercator => self.crs.latitude_deg(self.crs.top_deg()),
        }
    }
}

impl TilePlan {
    /// How many tiles.
    pub(super) fn count(&self) -> u64 {
        self.blocks
            .iter()
            .map(|(columns, rows)| columns.len() as u64 * rows.len() as u64)
            .sum()
    }

    /// Column and row of each.
    pub(super) fn tiles(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.blocks.iter().flat_map(|(columns, rows)| {
            rows.clone()
                .flat_map(move |row| columns.clone().map(move |column| (column, row)))
        })
    }
}

impl Files {
    /// All files of a list.
    pub(super) fn wanted(&self) -> Vec<Wanted> {
        let wanted = self.file.iter().map(|file| Wanted {
            url: file.url.clone(),
            key: file.save_as.clone(),
            file: file.save_as.clone(),
            blake3: file.blake3.clone(),
        });
        wanted.collect()
    }
}

impl MapSource {
    /// Folder of its files in a cache, below the cache's own: source, time and level.
    pub(super) fn folder(&self, time: Option<&str>, level: Option<u32>) -> String {
        let time = time.unwrap_or("always");
        let level = level.map_or("files".to_string(), |level| level.to_string());
        format!("{}/{time}/{level}", self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::super::named::named;
    use super::*;

    fn tiles(name: &str) -> Tiles {
        named(name).expect("a source").tiles.expect("tiles")
    }

    fn region(edges: [f64; 4]) -> Bounds {
        Bounds::new(edges).expect("good")
    }

    /// The sizes of the matrix sets of GIBS in EPSG:4326: 2 × 1, 3 × 2, 5 × 3, 10 × 5, 20 × 10, 40 × 20, 80 × 40, 160 × 80.
    #[test]
    fn gibs_has_its_published_matrices() {
        let tiles = tiles("blue_marble");
        let grids: Vec<_> = (0..=7).map(|level| tiles.grid(level)).collect();
        let published = [
            (2, 1),
            (3, 2),
            (5, 3),
            (10, 5),
            (20, 10),
            (40, 20),
            (80, 40),
            (160, 80),
        ];
        assert_eq!(grids, published);
        assert_eq!(tiles.width(7), 81_920.0);
        // The documentation's example: level 6, row 13, column 36 begins at 162 − 180 = −18° E and 90 − 58.5 = 31.5° N.
        let plan = tiles
            .plan(Fineness::Level(6), &region([-18.0, 27.0, -13.5, 31.5]))
            .expect("good");
        assert_eq!(plan.tiles().collect::<Vec<_>>(), [(36, 13)]);
    }

    #[test]
    fn the_level_is_the_coarsest_that_is_fine_enough() {
        let tiles = tiles("blue_marble");
        let level = |width| {
            tiles
                .plan(Fineness::Width(width), &Bounds::EARTH)
                .map(|plan| (plan.level, plan.count()))
        };
        assert_eq!(level(20_480).expect("good"), (5, 800));
        assert_eq!(level(21_600).expect("good"), (6, 3200));
        assert_eq!(level(1_000_000).expect("good"), (7, 12_800));
        assert!(tiles.plan(Fineness::Level(8), &Bounds::EARTH).is_err());
    }

    #[test]
    fn regions_over_the_date_line_are_two_blocks() {
        let tiles = tiles("terrarium");
        let plan = tiles
            .plan(Fineness::Level(3), &region([170.0, -10.0, -170.0, 10.0]))
            .expect("good");
        assert_eq!(plan.blocks, [(7..8, 3..5), (0..1, 3..5)]);
        assert_eq!(plan.count(), 4);
        // Beyond the end of Web Mercator there is nothing.
        assert!(
            tiles
                .plan(Fineness::Level(3), &region([0.0, 86.0, 10.0, 90.0]))
                .is_err()
        );
        let all = tiles
            .plan(Fineness::Level(2), &Bounds::EARTH)
            .expect("good");
        assert_eq!(all.blocks, [(0..4, 0..4)]);
    }

    #[test]
    fn tiles_are_asked_for_by_the_names_of_their_source() {
        let blue = tiles("blue_marble");
        let wanted = blue.wanted(Some("2004-08-01"), 6, 36, 13);
        assert!(
            wanted.url.ends_with("/2004-08-01/500m/6/13/36.jpeg"),
            "{}",
            wanted.url
        );
        assert_eq!(
            (wanted.key.as_str(), wanted.file.as_str()),
            ("13/36", "13/36.jpeg")
        );
        let mut tms = tiles("terrarium");
        tms.url = "https://a/{z}/{x}/{-y}.png".into();
        assert_eq!(tms.wanted(None, 3, 1, 0).url, "https://a/3/1/7.png");
        tms.level_names = ["a", "b", "c", "d"].map(String::from).to_vec();
        assert_eq!(tms.wanted(None, 3, 1, 7).url, "https://a/d/1/0.png");
    }
}
