//! The colours of maps of coverage, and the classes of values that they stand for.

use super::coverage_cells::CoverageCells;
use crate::scene::CoverageShow;
use terrella_orbit::CellCoverage;

/// From what is covered best to what is covered least: yellow, green, blue, violet, which people who see few colours tell apart by lightness.
const COLORS: [[u8; 3]; 6] = [
    [0xfd, 0xe7, 0x25],
    [0x7a, 0xd1, 0x51],
    [0x22, 0xa8, 0x84],
    [0x2a, 0x78, 0x8e],
    [0x41, 0x44, 0x87],
    [0x44, 0x01, 0x54],
];
/// Ends of the classes of a map for other programs but the last, which has none, hours.
const FIXED_HOURS: [f64; COLORS.len() - 1] = [0.5, 1.0, 3.0, 6.0, 12.0];
/// Times that a class can end at, minutes: as many of them as a map's values need.
const MINUTES: [u32; 20] = [
    1, 2, 5, 10, 15, 30, 60, 120, 180, 360, 540, 720, 1080, 1440, 2160, 2880, 4320, 7200, 14_400,
    43_200,
];

/// The classes of a map's values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CoverageScale {
    show: CoverageShow,
    /// What the values are.
    pub title: String,
    /// From what is covered best to what is covered least.
    pub classes: Vec<CoverageClass>,
}

/// A class of values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CoverageClass {
    /// Display values (sRGB).
    pub color: [u8; 3],
    /// Its values, in words.
    pub label: String,
    /// What its values are at most, seconds, or of a count at least.
    end: f64,
}

/// The colour of a longest gap in a map for other programs.
pub(crate) fn gap_color(gap_s: f64) -> [u8; 3] {
    COLORS[FIXED_HOURS.partition_point(|hours| hours * 3600.0 < gap_s)]
}

/// The value of a cell that a map of times shows, seconds; `None` where there is none.
fn time_s(show: CoverageShow, one: &CellCoverage) -> Option<f64> {
    match show {
        CoverageShow::Revisit => one.revisit_s,
        _ => (one.accesses > 0).then_some(one.longest_gap_s),
    }
}

impl CoverageScale {
    /// That of a map.
    pub fn of(map: &CoverageCells, show: CoverageShow) -> Self {
        let hours = map.length_s() / 3600.0;
        // Hours as people write them: tenths.
        let length = format!("{} h", (10.0 * hours).round() / 10.0);
        let times = map.cells.iter().filter_map(|(_, one)| time_s(show, one));
        let (title, classes) = match show {
            CoverageShow::Count => ("Views", by_count(map.most_views())),
            CoverageShow::Revisit => ("Mean revisit", by_time(times)),
            CoverageShow::Gap => ("Longest gap", by_time(times)),
        };
        Self {
            show,
            title: format!("{title} in {length}"),
            classes,
        }
    }

    /// That of counts up to this one.
    #[cfg(test)]
    pub fn of_count(most: u32) -> Self {
        Self {
            show: CoverageShow::Count,
            title: "Views in 24 h".to_owned(),
            classes: by_count(most),
        }
    }

    /// The place of a cell's class; `None` where the cell has no value: it is never in view, or not often enough.
    pub fn class(&self, one: &CellCoverage) -> Option<usize> {
        let mut classes = self.classes.iter();
        match self.show {
            CoverageShow::Count => {
                let count = f64::from(one.accesses);
                classes.position(|class| class.end <= count)
            }
            CoverageShow::Revisit | CoverageShow::Gap => {
                let seconds = time_s(self.show, one)?;
                classes.position(|class| seconds <= class.end)
            }
        }
    }
}

/// The colour of a class of several, from the best on.
fn color(index: usize, count: usize) -> [u8; 3] {
    COLORS[index * (COLORS.len() - 1) / (count - 1).max(1)]
}

/// The classes of these times, seconds: those of the usual ends that have values, and where these are too many, some of them together.
fn by_time(times: impl Iterator<Item = f64>) -> Vec<CoverageClass> {
    let class = |seconds: f64| {
        let place = MINUTES.partition_point(|minutes| f64::from(*minutes) * 60.0 < seconds);
        place.min(MINUTES.len() - 1)
    };
    let mut is_there = [false; MINUTES.len()];
    times.for_each(|seconds| is_there[class(seconds)] = true);
    let wanted: Vec<_> = (0..MINUTES.len())
        .filter(|place| is_there[*place])
        .collect();
    let together = wanted.len().div_ceil(COLORS.len()).max(1);
    // The last of each group, so that the greatest value has a class.
    let groups = wanted.rchunks(together).rev();
    let ends: Vec<_> = groups.filter_map(|group| group.last().copied()).collect();
    let classes = ends.iter().enumerate();
    let classes = classes.map(|(index, place)| CoverageClass {
        color: color(index, ends.len()),
        label: format!("≤ {}", time_text(MINUTES[*place])),
        end: match place + 1 == MINUTES.len() {
            true => f64::INFINITY,
            false => f64::from(MINUTES[*place]) * 60.0,
        },
    });
    classes.collect()
}

/// Minutes as people write them.
fn time_text(minutes: u32) -> String {
    match minutes {
        minutes if minutes < 60 => format!("{minutes} min"),
        minutes if minutes <= 2880 => format!("{} h", minutes / 60),
        minutes => format!("{} d", minutes / 1440),
    }
}

/// Classes of the same width, from the greatest count down to 1.
fn by_count(most: u32) -> Vec<CoverageClass> {
    let width = most.div_ceil(COLORS.len() as u32).max(1);
    let count = most.div_ceil(width) as usize;
    let classes = (0..count).rev().map(|index| {
        let least = 1 + index as u32 * width;
        CoverageClass {
            color: color(count - 1 - index, count),
            label: match width {
                1 => least.to_string(),
                _ => format!("{least}–{}", least.saturating_add(width - 1)),
            },
            end: f64::from(least),
        }
    });
    classes.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(classes: &[CoverageClass]) -> Vec<&str> {
        classes.iter().map(|class| class.label.as_str()).collect()
    }

    fn scale(show: CoverageShow, classes: Vec<CoverageClass>) -> CoverageScale {
        CoverageScale {
            show,
            title: String::new(),
            classes,
        }
    }

    fn cell(accesses: u32, gap_min: f64, revisit_min: Option<f64>) -> CellCoverage {
        CellCoverage {
            accesses,
            longest_gap_s: 60.0 * gap_min,
            revisit_s: revisit_min.map(|minutes| 60.0 * minutes),
            ..CellCoverage::default()
        }
    }

    #[test]
    fn times_have_the_classes_that_have_values() {
        let of = |minutes: &[f64]| by_time(minutes.iter().map(|minutes| 60.0 * minutes));
        assert_eq!(
            labels(&of(&[200.0, 20.0, 30.0, 700.0])),
            ["≤ 30 min", "≤ 6 h", "≤ 12 h"]
        );
        assert_eq!(labels(&of(&[3000.0])), ["≤ 3 d"]);
        assert!(of(&[]).is_empty());
        // Seven ends in groups of two, the greatest values in the last.
        let many = of(&[1.0, 4.0, 14.0, 50.0, 170.0, 500.0, 1000.0]);
        assert_eq!(labels(&many), ["≤ 1 min", "≤ 15 min", "≤ 3 h", "≤ 18 h"]);
        assert_eq!((many[0].color, many[3].color), (COLORS[0], COLORS[5]));
        let gaps = scale(CoverageShow::Gap, many);
        for (minutes, class) in [(0.0, 0), (1.0, 0), (1.1, 1), (60.0, 2), (1000.0, 3)] {
            assert_eq!(
                gaps.class(&cell(1, minutes, None)),
                Some(class),
                "{minutes}"
            );
        }
        assert_eq!(gaps.class(&cell(0, 1440.0, None)), None);
        // Every value is in a class, a year too.
        let year = scale(CoverageShow::Gap, of(&[366.0 * 1440.0]));
        assert_eq!(year.class(&cell(1, 366.0 * 1440.0, None)), Some(0));
        let revisits = scale(CoverageShow::Revisit, of(&[95.0, 500.0]));
        assert_eq!(revisits.class(&cell(2, 1000.0, Some(95.0))), Some(0));
        assert_eq!(revisits.class(&cell(1, 1000.0, None)), None, "seen once");
    }

    #[test]
    fn maps_for_other_programs_have_fixed_classes() {
        assert_eq!(gap_color(0.0), COLORS[0]);
        assert_eq!(gap_color(1800.0), COLORS[0]);
        assert_eq!(gap_color(1801.0), COLORS[1]);
        assert_eq!(gap_color(1e9), COLORS[5]);
    }

    #[test]
    fn counts_have_classes_of_one_width_from_the_greatest_down() {
        assert_eq!(labels(&by_count(3)), ["3", "2", "1"]);
        assert_eq!(labels(&by_count(7)), ["7–8", "5–6", "3–4", "1–2"]);
        assert_eq!(by_count(1)[0].color, COLORS[0]);
        let counts = scale(CoverageShow::Count, by_count(7));
        assert_eq!(counts.classes[0].color, COLORS[0]);
        assert_eq!(counts.classes[3].color, COLORS[5]);
        for (count, class) in [
            (0, None),
            (1, Some(3)),
            (2, Some(3)),
            (3, Some(2)),
            (7, Some(0)),
        ] {
            assert_eq!(counts.class(&cell(count, 0.0, None)), class, "{count}");
        }
        // A place that is never seen is never in a class, and nothing seen has none.
        assert!(by_count(0).is_empty());
        assert_eq!(
            scale(CoverageShow::Count, by_count(0)).class(&cell(0, 0.0, None)),
            None
        );
        let most = by_count(u32::MAX);
        assert!(most.len() <= COLORS.len() && most[0].color == COLORS[0]);
    }
}
