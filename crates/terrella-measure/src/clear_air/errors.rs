//! Errors of drawn light by kind of view, their bounds, and the table of them.

use super::{AirRow, AirSet, AirTable, color_difference, lab_of_linear};
use crate::SortedSample;
use crate::output::csv_text;
use glam::DVec3;

/// Channels darker than this are not compared: a white sheet that faces the Sun in space is 1.
pub const DARKEST: f64 = 1e-4;

/// How wrong views of a group may be, as parts of the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Bound of the median over all channels.
    pub median: f64,
    /// Bound of the maximum over all channels.
    pub worst: f64,
}

impl Bound {
    const fn new(median: f64, worst: f64) -> Self {
        Self { median, worst }
    }

    /// The same, so many times as wide.
    fn times(self, factor: f64) -> Self {
        Self::new(self.median * factor, self.worst * factor)
    }
}

/// A kind of view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewGroup {
    /// From space, the ground up to 70° from straight below.
    Nadir,
    /// From space, the ground at 80°.
    Slant,
    /// From space, ground near the Earth's edge.
    Edge,
    /// From space, past the edge at 5 to 60 km.
    Limb,
    /// From space, past the edge below 5 km or above 60 km.
    OtherLimb,
    SkyFromGround,
    /// The sky from 10 km.
    SkyFrom10Km,
    /// The sky from 30 km.
    SkyFrom30Km,
    /// Light on the ground, the Sun up to 85° from the zenith.
    Ground,
    /// Light on the ground with a lower Sun.
    DarkGround,
}

impl ViewGroup {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Nadir,
        Self::Slant,
        Self::Edge,
        Self::Limb,
        Self::OtherLimb,
        Self::SkyFromGround,
        Self::SkyFrom10Km,
        Self::SkyFrom30Km,
        Self::Ground,
        Self::DarkGround,
    ];

    pub fn of(row: &AirRow) -> Self {
        match row.table {
            AirTable::Nadir if row.place <= 70.0 => Self::Nadir,
            AirTable::Nadir => Self::Slant,
            AirTable::Limb if row.place < 0.0 => Self::Edge,
            AirTable::Limb if (5.0..=60.0).contains(&row.place) => Self::Limb,
            AirTable::Limb => Self::OtherLimb,
            AirTable::Sky if row.eye_km < 5.0 => Self::SkyFromGround,
            AirTable::Sky if row.eye_km < 20.0 => Self::SkyFrom10Km,
            AirTable::Sky => Self::SkyFrom30Km,
            AirTable::Ground if row.sun_zenith_deg <= 85.0 => Self::Ground,
            AirTable::Ground => Self::DarkGround,
        }
    }

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nadir => "ground from space, view zenith ≤ 70°",
            Self::Slant => "ground from space, 80°",
            Self::Edge => "ground at the Earth's edge",
            Self::Limb => "limb, tangents of 5–60 km",
            Self::OtherLimb => "limb, 2 km, 70 km, 80 km",
            Self::SkyFromGround => "sky from the ground",
            Self::SkyFrom10Km => "sky from 10 km",
            Self::SkyFrom30Km => "sky from 30 km",
            Self::Ground => "light on the ground, Sun zenith ≤ 85°",
            Self::DarkGround => "light on the ground, Sun lower",
        }
    }

    /// How wrong drawn views may be; twice that with haze. Groups without a bound are only reported.
    pub fn bound(self, set: AirSet) -> Option<Bound> {
        let bound = match self {
            Self::Nadir => Bound::new(0.03, 0.10),
            Self::Limb => Bound::new(0.05, 0.15),
            Self::SkyFromGround | Self::SkyFrom10Km | Self::SkyFrom30Km => Bound::new(0.06, 0.20),
            Self::Ground => Bound::new(0.05, 0.05),
            Self::Slant | Self::Edge | Self::OtherLimb | Self::DarkGround => return None,
        };
        Some(match set {
            AirSet::Clear => bound,
            AirSet::Haze => bound.times(2.0),
        })
    }
}

/// A view, what was found in it, and how wrong that is.
#[derive(Clone, Debug, PartialEq)]
pub struct RowError {
    /// The view.
    pub row: AirRow,
    /// True light.
    pub truth: [f64; 3],
    /// Light that was found.
    pub found: [f64; 3],
    /// found/truth − 1 of channels that are not too dark, and in which the truth is known.
    pub errors: [Option<f64>; 3],
}

impl RowError {
    /// `albedo` is that of the ground for which `found` was computed.
    pub fn new(row: AirRow, albedo: f64, found: [f64; 3]) -> Self {
        let truth = row.light_over(albedo);
        let is_held = |i: usize| truth[i] > DARKEST && row.is_sure(i);
        let error = |i: usize| is_held(i).then(|| found[i] / truth[i] - 1.0);
        Self {
            row,
            truth,
            found,
            errors: [0, 1, 2].map(error),
        }
    }

    /// The largest of its errors, by size.
    pub fn worst(&self) -> f64 {
        // A non-finite error counts as the largest.
        let sizes = self.errors.iter().flatten().map(|error| error.abs());
        sizes.fold(
            0.0,
            |a, b| if b.is_nan() { f64::INFINITY } else { a.max(b) },
        )
    }

    /// ΔE₀₀ of both on a display of this exposure.
    fn color_difference(&self, exposure: f64) -> f64 {
        let shown = |light: [f64; 3]| {
            lab_of_linear((DVec3::from(light) * exposure).clamp(DVec3::ZERO, DVec3::ONE))
        };
        color_difference(shown(self.found), shown(self.truth))
    }
}

/// Errors of one set's views.
#[derive(Clone, Debug, PartialEq)]
pub struct AirErrors {
    pub set: AirSet,
    /// All views.
    pub rows: Vec<RowError>,
}

impl AirErrors {
    /// Sizes of the errors of a group, for red, green and blue.
    pub fn sizes(&self, group: ViewGroup) -> [SortedSample; 3] {
        [0, 1, 2].map(|channel| {
            let rows = self
                .rows
                .iter()
                .filter(|found| ViewGroup::of(&found.row) == group);
            let sizes = rows.filter_map(|found| found.errors[channel].map(f64::abs));
            SortedSample::new(sizes.collect())
        })
    }

    /// Mean ΔE₀₀ of all views on a display of this exposure.
    pub fn mean_color_difference(&self, exposure: f64) -> f64 {
        let all = self
            .rows
            .iter()
            .map(|found| found.color_difference(exposure));
        all.sum::<f64>() / self.rows.len().max(1) as f64
    }

    /// Groups and channels beyond their bounds, scaled by `factor`, as text.
    pub fn beyond_bounds(&self, factor: f64) -> Vec<String> {
        let mut beyond = Vec::new();
        for group in ViewGroup::ALL {
            let Some(bound) = group.bound(self.set).map(|bound| bound.times(factor)) else {
                continue;
            };
            for (channel, sizes) in ["red", "green", "blue"].into_iter().zip(self.sizes(group)) {
                for (what, found, most) in [
                    ("median", sizes.median(), bound.median),
                    ("worst", sizes.max(), bound.worst),
                ] {
                    // A sample that is no number is beyond every bound.
                    if found.is_nan() || found > most {
                        let set = self.set.letter();
                        beyond.push(format!(
                            "set {set}, {}, {channel}: {what} error {:.1} %, allowed {:.0} %",
                            group.name(),
                            100.0 * found,
                            100.0 * most
                        ));
                    }
                }
            }
        }
        beyond
    }

    /// The worst views of the groups that have a bound, worst first.
    pub fn worst(&self, count: usize) -> Vec<&RowError> {
        let bound = |found: &&RowError| ViewGroup::of(&found.row).bound(self.set).is_some();
        let mut rows: Vec<_> = self.rows.iter().filter(bound).collect();
        rows.sort_by(|a, b| b.worst().total_cmp(&a.worst()));
        rows.truncate(count);
        rows
    }

    /// Comma-separated values, a line for each kind of view: sizes of errors, %, and the bounds; `by` is the source of the light.
    pub fn csv(&self, by: &str) -> String {
        let head = CSV_COLUMNS.map(str::to_owned);
        let air = match self.set {
            AirSet::Clear => "clear",
            AirSet::Haze => "hazy",
        };
        let lines = ViewGroup::ALL.into_iter().filter_map(|group| {
            let sizes = self.sizes(group);
            let count: usize = sizes.iter().map(SortedSample::len).sum();
            let bound = group.bound(self.set);
            let percent = |part: f64, digits| format!("{:.digits$}", 100.0 * part);
            let allowed =
                |of: fn(Bound) -> f64| bound.map_or(String::new(), |bound| percent(of(bound), 0));
            let [red, green, blue] = sizes.map(|sizes| {
                [sizes.median(), sizes.quantile(0.9), sizes.max()].map(|error| percent(error, 2))
            });
            let line = [
                by.to_owned(),
                air.to_owned(),
                group.name().to_owned(),
                count.to_string(),
            ]
            .into_iter()
            .chain(red)
            .chain(green)
            .chain(blue)
            .chain([allowed(|bound| bound.median), allowed(|bound| bound.worst)]);
            (count > 0).then(|| line.collect::<Vec<_>>())
        });
        csv_text(std::iter::once(head.to_vec()).chain(lines))
    }
}

/// The columns of [`AirErrors::csv`].
const CSV_COLUMNS: [&str; 15] = [
    "by",
    "air",
    "view",
    "channels",
    "red_median",
    "red_90",
    "red_worst",
    "green_median",
    "green_90",
    "green_worst",
    "blue_median",
    "blue_90",
    "blue_worst",
    "allowed_median",
    "allowed_worst",
];

#[cfg(test)]
mod tests {
    use super::*;

    fn found(place: f64, light: [f64; 3]) -> RowError {
        let row = AirRow {
            table: AirTable::Nadir,
            sun_zenith_deg: 30.0,
            azimuth_deg: 0.0,
            place,
            eye_km: 400.0,
            albedo: 0.3,
            light: [0.2, 0.1, 1e-5],
            albedo_slope: [1.0, 0.0, 0.0],
        };
        RowError::new(row, 0.25, light)
    }

    #[test]
    fn errors_are_ratios_of_what_is_bright_enough() {
        let one = found(30.0, [0.18, 0.1, 1.0]);
        assert!((one.truth[0] - 0.15).abs() < 1e-12);
        assert!((one.errors[0].expect("bright") - 0.2).abs() < 1e-12);
        assert_eq!((one.errors[1], one.errors[2]), (Some(0.0), None));
        assert!(found(30.0, [f64::NAN, 0.1, 0.0]).worst().is_infinite());
        // Where the tables are unreliable in blue.
        let row = AirRow {
            table: AirTable::Limb,
            sun_zenith_deg: 93.0,
            light: [0.1; 3],
            ..found(5.0, [0.0; 3]).row
        };
        let errors = RowError::new(row, 0.3, [0.1; 3]).errors;
        assert_eq!(errors, [Some(0.0), Some(0.0), None]);
    }

    #[test]
    fn what_is_beyond_a_bound_is_named() {
        let errors = |light| AirErrors {
            set: AirSet::Clear,
            rows: vec![found(30.0, light), found(80.0, [9.0, 9.0, 9.0])],
        };
        // The view at 80° has no bound.
        assert!(errors([0.153, 0.101, 9.0]).beyond_bounds(1.0).is_empty());
        let beyond = errors([0.16, 0.101, 9.0]).beyond_bounds(1.0);
        assert_eq!(beyond.len(), 1);
        assert!(
            beyond[0].contains("median error 6.7 %, allowed 3 %"),
            "{beyond:?}"
        );
        assert!(beyond[0].contains("red"), "{beyond:?}");
        assert_eq!(errors([f64::NAN, 0.1, 0.0]).beyond_bounds(9.0).len(), 2);
        let csv = errors([0.15, 0.101, 0.0]).csv("drawn");
        assert!(
            csv.contains("\ndrawn,clear,\"ground from space, view zenith ≤ 70°\",2,0.00,0.00,0.00,1.00,1.00,1.00,"),
            "{csv}"
        );
        assert!(
            csv.contains("\ndrawn,clear,\"ground from space, 80°\",2,"),
            "{csv}"
        );
    }

    #[test]
    fn equal_light_is_of_equal_colour() {
        let same = AirErrors {
            set: AirSet::Clear,
            rows: vec![found(30.0, [0.15, 0.1, 1e-5])],
        };
        assert!(same.mean_color_difference(1.4) < 1e-9);
        let other = AirErrors {
            set: AirSet::Clear,
            rows: vec![found(30.0, [0.15, 0.12, 0.1])],
        };
        assert!(other.mean_color_difference(1.4) > 5.0);
    }
}
