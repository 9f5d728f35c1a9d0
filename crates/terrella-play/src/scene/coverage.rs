//! `[coverage]`: a map of the ground that satellite sensors see over a time span.

use super::Scene;
use super::choices::{CaptionPlace, CoverageShow};
use super::coverage_keys::{MAX_NAMES, NO_COVERAGE, REGION_DEG, RawCoverage};
use super::error::{SceneError, printable};
use super::field::range_text;
use super::orbit::Orbit;
use super::record::number_text;
use super::text::SceneText;
use toml::Spanned;

/// Default region: west, south, east and north, degrees.
const WHOLE_EARTH_DEG: [f64; 4] = [-180.0, -90.0, 180.0, 90.0];

/// `[coverage]`
#[derive(Clone, Debug, PartialEq)]
pub struct CoverageTable {
    /// What the colours show.
    pub show: CoverageShow,
    /// Names of satellites; none is all of them.
    pub satellites: Vec<String>,
    /// From the scene's start, hours.
    pub duration_h: f64,
    /// Above the ground's horizon, degrees.
    pub min_elevation_deg: f64,
    /// Side of a cell, degrees.
    pub step_deg: f64,
    /// West, south, east and north, degrees.
    pub region_deg: [f64; 4],
    /// Above 0 to 1.
    pub opacity: f64,
    /// Where the legend stands; `None` is no legend.
    pub legend: Option<CaptionPlace>,
}

impl SceneText<'_> {
    /// Checks `[coverage]`; `None` if no map is drawn.
    pub(super) fn coverage(
        &self,
        raw: &RawCoverage,
        orbits: &[Orbit],
    ) -> Result<Option<CoverageTable>, SceneError> {
        let show = raw.show();
        if !show.is_given() {
            if let Some((key, span)) = raw.given().next() {
                let advice = "is of a map of coverage and the scene has none; add show = \"gap\", \"revisit\" or \"count\", or leave [coverage] out";
                return Err(self.reject_at("coverage", key.name, span, advice));
            }
            show.note(Err("no map of coverage is drawn"));
            for (key, _) in raw.declared() {
                raw.notes.note(key.name, Err(NO_COVERAGE));
            }
            return Ok(None);
        }
        if orbits.is_empty() {
            let advice = "coverage is that of satellites and this scene has none; give it an [orbit] table, or leave [coverage] out";
            return Err(self.reject(&show, advice));
        }
        if orbits.iter().any(Orbit::is_simulated) {
            let advice = "coverage is computed ahead, and here a simulator says where satellites are; leave [coverage] out";
            return Err(self.reject(&show, advice));
        }
        let legend = raw.legend().is_on();
        let place = raw.legend_place();
        let legend = match legend {
            true => Some(self.choice(&place)?),
            false => {
                let advice = "is for legend = true; leave it out, or leave legend = false out";
                self.idle(&place, "only for legend = true", advice)?;
                None
            }
        };
        Ok(Some(CoverageTable {
            show: self.choice_or(&show, CoverageShow::Gap)?,
            satellites: self.names(raw)?,
            duration_h: self.quantity(&raw.duration_h())?,
            min_elevation_deg: self.quantity(&raw.min_elevation_deg())?,
            step_deg: self.quantity(&raw.step_deg())?,
            region_deg: self.region(raw)?,
            opacity: self.quantity(&raw.opacity())?,
            legend,
        }))
    }

    /// The names of satellites. They are validated when the satellites are opened.
    fn names(&self, raw: &RawCoverage) -> Result<Vec<String>, SceneError> {
        let field = raw.satellites();
        let Some(names) = field.given.map(Spanned::get_ref) else {
            field.note(Err("all satellites"));
            return Ok(Vec::new());
        };
        if names.is_empty() || names.len() > MAX_NAMES {
            let advice = format!(
                "must have 1 to {MAX_NAMES} names of satellites; leave it out for all of them"
            );
            return Err(self.reject(&field, advice));
        }
        let shown: Vec<_> = names.iter().map(|name| printable(name)).collect();
        field.note(Ok(format!("[\"{}\"]", shown.join("\", \""))));
        Ok(names.clone())
    }

    fn region(&self, raw: &RawCoverage) -> Result<[f64; 4], SceneError> {
        let field = raw.region_deg();
        let given = field.given.map(|given| given.get_ref().as_slice());
        let region = match given {
            None => WHOLE_EARTH_DEG,
            Some(&[west, south, east, north]) => [west, south, east, north],
            Some(_) => {
                let advice = "must be four numbers, [west, south, east, north]";
                return Err(self.reject(&field, advice));
            }
        };
        let [west, south, east, north] = region;
        let in_range = [west, east].iter().all(|lon| REGION_DEG.contains(lon));
        let is_region = west != east && -90.0 <= south && south < north && north <= 90.0;
        if !(in_range && is_region) {
            let advice = format!(
                "must be [west, south, east, north] with longitudes from {} degrees, latitudes from −90 to 90, and the south below the north",
                range_text(&REGION_DEG)
            );
            return Err(self.reject(&field, advice));
        }
        field.note(Ok(format!("[{}]", region.map(number_text).join(", "))));
        Ok(region)
    }
}

impl Scene {
    /// Description of the coverage map.
    pub(super) fn coverage_uses(&self) -> Option<(&'static str, String)> {
        let table = self.coverage.as_ref()?;
        let what = match table.show {
            CoverageShow::Count => "the number of views",
            CoverageShow::Revisit => "the mean revisit time",
            CoverageShow::Gap => "the longest gap",
        };
        let of = match table.satellites.as_slice() {
            [] => "all satellites".to_owned(),
            names => printable(&names.join(", ")),
        };
        let text = format!(
            "{what} of cells of {}° in {} h by {of}",
            number_text(table.step_deg),
            number_text(table.duration_h)
        );
        Some(("coverage", text))
    }
}
