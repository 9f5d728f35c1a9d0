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
/// Ends of the classes of gaps and revisit times but the last, which has none, hours.
const HOURS: [f64; COLORS.len() - 1] = [0.5, 1.0, 3.0, 6.0, 12.0];
/// And how they are written.
const HOUR_LABELS: [&str; COLORS.len()] =
    ["≤ 30 min", "≤ 1 h", "≤ 3 h", "≤ 6 h", "≤ 12 h", "> 12 h"];

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
    /// What the class's values are at most: seconds, or of a count its least value.
    end: f64,
}

/// The colour of a longest gap.
pub(crate) fn gap_color(gap_s: f64) -> [u8; 3] {
    COLORS[hour_class(gap_s)]
}

fn hour_class(seconds: f64) -> usize {
    HOURS.partition_point(|hours| hours * 3600.0 < seconds)
}

impl CoverageScale {
    /// That of a map.
    pub fn of(map: &CoverageCells, show: CoverageShow) -> Self {
        let hours = map.length_s() / 3600.0;
        // Hours as people write them: tenths.
        let length = format!("{} h", (10.0 * hours).round() / 10.0);
        let (title, classes) = match show {
            CoverageShow::Count => ("Views", by_count(map.most_views())),
            CoverageShow::Revisit => ("Mean revisit", by_hours(hours)),
            CoverageShow::Gap => ("Longest gap", by_hours(hours)),
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
        let last = self.classes.len().checked_sub(1)?;
        match self.show {
            CoverageShow::Count => {
                let count = f64::from(one.accesses);
                self.classes.iter().position(|class| class.end <= count)
            }
            CoverageShow::Revisit => Some(hour_class(one.revisit_s?).min(last)),
            CoverageShow::Gap if one.accesses == 0 => None,
            CoverageShow::Gap => Some(hour_class(one.longest_gap_s).min(last)),
        }
    }
}

/// The classes of times, as far as a map of so many hours can have them.
fn by_hours(hours: f64) -> Vec<CoverageClass> {
    let needed = (hour_class(hours * 3600.0) + 1).min(COLORS.len());
    (0..needed)
        .map(|index| CoverageClass {
            color: COLORS[index],
            label: HOUR_LABELS[index].to_owned(),
            end: HOURS
                .get(index)
                .map_or(f64::INFINITY, |hours| hours * 3600.0),
        })
        .collect()
}

/// Classes of the same width, from the greatest count down to 1.
fn by_count(most: u32) -> Vec<CoverageClass> {
    let width = most.div_ceil(COLORS.len() as u32).max(1);
    let count = most.div_ceil(width) as usize;
    let classes = (0..count).rev().map(|index| {
        let least = 1 + index as u32 * width;
        // The last class is the yellow one, however few there are.
        let color = (count - 1 - index) * (COLORS.len() - 1) / (count - 1).max(1);
        CoverageClass {
            color: COLORS[color],
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
    fn times_have_the_classes_that_their_span_can_have() {
        assert_eq!(labels(&by_hours(24.0)), HOUR_LABELS);
        assert_eq!(labels(&by_hours(2.0)), ["≤ 30 min", "≤ 1 h", "≤ 3 h"]);
        assert_eq!(labels(&by_hours(0.2)), ["≤ 30 min"]);
        let gaps = scale(CoverageShow::Gap, by_hours(24.0));
        for (minutes, class) in [(0.0, 0), (30.0, 0), (30.1, 1), (180.0, 2), (1440.0, 5)] {
            assert_eq!(
                gaps.class(&cell(1, minutes, None)),
                Some(class),
                "{minutes}"
            );
        }
        assert_eq!(gaps.class(&cell(0, 1440.0, None)), None);
        let revisits = scale(CoverageShow::Revisit, by_hours(24.0));
        assert_eq!(revisits.class(&cell(2, 1000.0, Some(95.0))), Some(2));
        assert_eq!(revisits.class(&cell(1, 1000.0, None)), None, "seen once");
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
