//! `day_maps`, `cloud_maps`, `night_light_maps` and `map_fade` of `[earth]`: maps for dates or months.

use super::error::{SceneError, printable};
use super::field::{Field, RawDatedMaps};
use super::keys::{MAX_DATED_MAPS, RawEarth};
use super::record::KeyText;
use super::text::SceneText;
use super::time::utc;
use std::path::{Path, PathBuf};
use terrella::frames::{Epoch, utc_from_text};
use toml::{Spanned, Value};

/// Map layers that may change with the date.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DatedLayer {
    /// Colours by day.
    Day,
    /// Cloud cover.
    Clouds,
    /// City lights.
    NightLights,
}

impl DatedLayer {
    /// All layers.
    pub const ALL: [Self; 3] = [Self::Day, Self::Clouds, Self::NightLights];

    /// The key of its maps.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Day => "day_maps",
            Self::Clouds => "cloud_maps",
            Self::NightLights => "night_light_maps",
        }
    }

    /// The key with its table.
    pub(crate) const fn path_key(self) -> &'static str {
        match self {
            Self::Day => "earth.day_maps",
            Self::Clouds => "earth.cloud_maps",
            Self::NightLights => "earth.night_light_maps",
        }
    }
}

/// Times of maps.
#[derive(Clone, Debug, PartialEq)]
pub enum MapTimes {
    /// Twelve maps from January on, each for the middle of its month, every year.
    Months,
    /// Each map at its own date, the earliest first. Before the first date the first map is drawn,
    /// after the last date the last.
    Dates(Vec<Epoch>),
}

/// Maps of one layer that change with the date.
#[derive(Clone, Debug, PartialEq)]
pub struct DatedMaps {
    /// Which map they are.
    pub layer: DatedLayer,
    /// Their files, one at least.
    pub files: Vec<PathBuf>,
    /// When each is drawn.
    pub times: MapTimes,
    /// Whether each passes into the next; else it stands until the next one's date, or for its month.
    pub fades: bool,
}

/// Maps at an epoch: one map, or a blend of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BetweenMaps {
    /// Index of the earlier map in the list.
    pub from: usize,
    /// Index of the later map; the same index without a blend.
    pub to: usize,
    /// Weight of the later map, 0 to below 1.
    pub weight: f64,
}

impl BetweenMaps {
    const fn one(place: usize) -> Self {
        Self {
            from: place,
            to: place,
            weight: 0.0,
        }
    }
}

impl DatedMaps {
    /// The maps at an epoch.
    pub fn at(&self, epoch: Epoch) -> BetweenMaps {
        let between = match &self.times {
            MapTimes::Dates(dates) => between_dates(dates, epoch),
            MapTimes::Months if self.fades => between_months(epoch),
            MapTimes::Months => BetweenMaps::one(month_of(epoch).1),
        };
        match self.fades {
            true => between,
            false => BetweenMaps::one(between.from),
        }
    }

    /// Indices of the maps drawn between two epochs; the second may be earlier.
    pub fn within(&self, start: Epoch, end: Epoch) -> Vec<usize> {
        const MOST_OF_A_YEAR_S: f64 = 300.0 * 86_400.0;
        let count = self.files.len();
        let is_cycle = self.times == MapTimes::Months;
        if is_cycle && (end - start).to_seconds().abs() > MOST_OF_A_YEAR_S {
            return (0..count).collect();
        }
        let is_back = end < start;
        let (first, last) = (self.at(start), self.at(end));
        let (mut place, goal) = match is_back {
            true => (first.to, last.from),
            false => (first.from, last.to),
        };
        let mut places = vec![place];
        while place != goal && places.len() < count {
            let Some(next) = self.next(place, is_back) else {
                break;
            };
            place = next;
            places.push(place);
        }
        places
    }

    /// The next map, if there is one; `back` means that time runs backwards.
    pub fn next(&self, place: usize, back: bool) -> Option<usize> {
        let count = self.files.len();
        match (&self.times, back) {
            (MapTimes::Months, false) => Some((place + 1) % count),
            (MapTimes::Months, true) => Some((place + count - 1) % count),
            (MapTimes::Dates(_), false) => Some(place + 1).filter(|next| *next < count),
            (MapTimes::Dates(_), true) => place.checked_sub(1),
        }
    }
}

fn between_dates(dates: &[Epoch], epoch: Epoch) -> BetweenMaps {
    let after = dates.partition_point(|date| *date <= epoch);
    let last = dates.len().saturating_sub(1);
    if after == 0 || after > last {
        return BetweenMaps::one(after.min(last));
    }
    between((after - 1, dates[after - 1]), (after, dates[after]), epoch)
}

fn between_months(epoch: Epoch) -> BetweenMaps {
    let (year, month) = month_of(epoch);
    let (before, middle, after) = (
        middle_of(year, month as i32 - 1),
        middle_of(year, month as i32),
        middle_of(year, month as i32 + 1),
    );
    match epoch < middle {
        true => between(((month + 11) % 12, before), (month, middle), epoch),
        false => between((month, middle), ((month + 1) % 12, after), epoch),
    }
}

fn between(from: (usize, Epoch), to: (usize, Epoch), epoch: Epoch) -> BetweenMaps {
    let (whole, part) = ((to.1 - from.1).to_seconds(), (epoch - from.1).to_seconds());
    BetweenMaps {
        from: from.0,
        to: to.0,
        weight: (part / whole).clamp(0.0, 1.0),
    }
}

/// Year and month (0 is January) of an epoch, UTC.
fn month_of(epoch: Epoch) -> (i32, usize) {
    let (year, month, ..) = epoch.to_gregorian_utc();
    (year, usize::from(month.saturating_sub(1)))
}

/// The middle of a month. Months outside 0…11 are in an earlier or later year.
fn middle_of(year: i32, month: i32) -> Epoch {
    let first = |month: i32| {
        let (year, month) = (year + month.div_euclid(12), month.rem_euclid(12));
        Epoch::from_gregorian_utc(year, month as u8 + 1, 1, 0, 0, 0, 0)
    };
    let (begin, end) = (first(month), first(month + 1));
    begin + (end - begin) * 0.5
}

/// Keys of `[earth]` that determine which maps may be given.
#[derive(Clone, Copy)]
pub(super) struct DatedScene {
    pub is_paper: bool,
    pub clouds: bool,
    pub night_lights: bool,
    pub has_pack: bool,
}

const FORMS: &str = "a list of maps with their dates, [{ date = \"2018-01-15T00:00:00Z\", file = \"FILE\" }, …], or of twelve files, from January on";

impl SceneText<'_> {
    /// Checks the keys of maps with dates.
    pub(super) fn dated_maps(
        &self,
        earth: &RawEarth,
        scene: DatedScene,
    ) -> Result<Vec<DatedMaps>, SceneError> {
        let fade = earth.map_fade();
        let mut all = Vec::new();
        for (layer, field, is_on) in [
            (DatedLayer::Day, earth.day_maps(), true),
            (DatedLayer::Clouds, earth.cloud_maps(), scene.clouds),
            (
                DatedLayer::NightLights,
                earth.night_light_maps(),
                scene.night_lights,
            ),
        ] {
            let Some(RawDatedMaps(given)) = field.given.map(Spanned::get_ref) else {
                field.note(Err("this map does not change with the date"));
                continue;
            };
            if scene.is_paper {
                let advice = "the paper's shading has no maps that change with the date; leave them out, or take look = \"standard\"";
                return Err(self.reject(&field, advice));
            }
            if !is_on {
                let advice =
                    "is for a map that the scene leaves out; leave one of the two keys out";
                return Err(self.reject(&field, advice));
            }
            if layer == DatedLayer::Day && scene.has_pack {
                let advice = "a pack draws its own day map; leave out one of the two";
                return Err(self.reject(&field, advice));
            }
            let (files, times) = self.maps_in(&field, given)?;
            let maps = DatedMaps {
                layer,
                files,
                times,
                fades: fade.is_on(),
            };
            field.note(maps_text(&maps));
            all.push(maps);
        }
        if all.is_empty() {
            let advice = "is for day_maps, cloud_maps and night_light_maps, of which there are none; leave it out";
            self.idle(&fade, "no map changes with the date", advice)?;
        }
        Ok(all)
    }

    fn maps_in(
        &self,
        field: &Field<'_, RawDatedMaps>,
        given: &Value,
    ) -> Result<(Vec<PathBuf>, MapTimes), SceneError> {
        let reject = |advice: String| self.reject(field, advice);
        let entries = match given {
            Value::Array(entries) if !entries.is_empty() => entries,
            _ => return Err(reject(format!("must be {FORMS}"))),
        };
        if entries.len() > MAX_DATED_MAPS {
            return Err(reject(format!(
                "has {} maps; at most {MAX_DATED_MAPS} are taken",
                entries.len()
            )));
        }
        let folder = self.path.parent().unwrap_or(Path::new(""));
        if entries.iter().all(Value::is_str) {
            if entries.len() != 12 {
                let count = entries.len();
                return Err(reject(format!(
                    "has {count} files without dates; must be {FORMS}"
                )));
            }
            let files = entries.iter().enumerate().map(|(n, entry)| {
                let name = entry.as_str().unwrap_or_default();
                file_in(folder, name).map_err(|problem| reject(format!("map {}: {problem}", n + 1)))
            });
            return Ok((files.collect::<Result<_, _>>()?, MapTimes::Months));
        }
        let (mut files, mut dates) = (Vec::new(), Vec::<Epoch>::new());
        for (n, entry) in entries.iter().enumerate() {
            let (date, file) = dated(entry, folder)
                .map_err(|problem| reject(format!("map {}: {problem}", n + 1)))?;
            if dates.last().is_some_and(|before| *before >= date) {
                return Err(reject(format!(
                    "map {}: its date {} is not after the one before; write the earliest first, each date once",
                    n + 1,
                    utc(date)
                )));
            }
            files.push(file);
            dates.push(date);
        }
        Ok((files, MapTimes::Dates(dates)))
    }
}

/// A map with its date, or the error.
fn dated(entry: &Value, folder: &Path) -> Result<(Epoch, PathBuf), String> {
    let Value::Table(keys) = entry else {
        return Err(format!(
            "is {}; must be one of {FORMS}",
            printable(&entry.to_string())
        ));
    };
    if let Some(key) = keys
        .keys()
        .find(|key| !["date", "file"].contains(&key.as_str()))
    {
        return Err(format!("a map has date and file, not {}", printable(key)));
    }
    let needed = |key: &str| keys.get(key).ok_or_else(|| format!("needs {key}"));
    let date = match needed("date")? {
        Value::String(text) => text.clone(),
        Value::Datetime(when) => when.to_string(),
        _ => String::new(),
    };
    let date = utc_from_text(&date).map_err(|error| format!("date: {error}"))?;
    let name = needed("file")?;
    let name = name
        .as_str()
        .ok_or_else(|| "file must be a string, the path of a map".to_owned())?;
    Ok((date, file_in(folder, name)?))
}

fn file_in(folder: &Path, name: &str) -> Result<PathBuf, String> {
    let path = folder.join(name);
    let shown = printable(&path.display().to_string());
    match std::fs::metadata(&path) {
        Ok(found) if found.is_file() && !name.is_empty() => Ok(path),
        Ok(_) => Err(format!("{shown} is no file; give the path of a map")),
        Err(error) => Err(format!(
            "{shown} cannot be opened: {error}; give the path of a map, relative to the scene's folder"
        )),
    }
}

/// Maps in scene syntax.
fn maps_text(maps: &DatedMaps) -> KeyText {
    let file = |path: &PathBuf| format!("\"{}\"", printable(&path.display().to_string()));
    let texts: Vec<_> = match &maps.times {
        MapTimes::Months => maps.files.iter().map(file).collect(),
        MapTimes::Dates(dates) => dates
            .iter()
            .zip(&maps.files)
            .map(|(date, path)| format!("{{ date = \"{}\", file = {} }}", utc(*date), file(path)))
            .collect(),
    };
    Ok(format!("[{}]", texts.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn date(text: &str) -> Epoch {
        utc_from_text(text).expect("a date")
    }

    fn maps(times: MapTimes, fades: bool) -> DatedMaps {
        let count = match &times {
            MapTimes::Months => 12,
            MapTimes::Dates(dates) => dates.len(),
        };
        DatedMaps {
            layer: DatedLayer::Clouds,
            files: vec![PathBuf::new(); count],
            times,
            fades,
        }
    }

    fn close(found: BetweenMaps, from: usize, to: usize, weight: f64) {
        assert_eq!((found.from, found.to), (from, to), "{found:?}");
        assert!((found.weight - weight).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn between_two_dates_each_has_its_part() {
        let dates = [
            "2018-01-15T00:00:00Z",
            "2018-01-15T06:00:00Z",
            "2018-01-17T06:00:00Z",
        ];
        let dates: Vec<_> = dates.into_iter().map(date).collect();
        let fading = maps(MapTimes::Dates(dates.clone()), true);
        close(fading.at(date("2010-01-01T00:00:00Z")), 0, 0, 0.0);
        close(fading.at(dates[0]), 0, 1, 0.0);
        close(fading.at(date("2018-01-15T01:30:00Z")), 0, 1, 0.25);
        close(fading.at(dates[1]), 1, 2, 0.0);
        close(fading.at(date("2018-01-16T06:00:00Z")), 1, 2, 0.5);
        close(fading.at(dates[2]), 2, 2, 0.0);
        close(fading.at(date("2030-01-01T00:00:00Z")), 2, 2, 0.0);
        let hard = maps(MapTimes::Dates(dates.clone()), false);
        close(hard.at(date("2018-01-15T05:59:59Z")), 0, 0, 0.0);
        close(hard.at(dates[1]), 1, 1, 0.0);
        let single = maps(MapTimes::Dates(dates[..1].to_vec()), true);
        close(single.at(date("2018-06-01T00:00:00Z")), 0, 0, 0.0);
        assert_eq!(
            (fading.next(1, false), fading.next(2, false)),
            (Some(2), None)
        );
        assert_eq!(
            (fading.next(1, true), fading.next(0, true)),
            (Some(0), None)
        );
    }

    #[test]
    fn months_stand_in_their_middles_and_go_round() {
        let months = maps(MapTimes::Months, true);
        // January has 31 days, February of 2018 28, of 2020 29.
        close(months.at(date("2018-01-16T12:00:00Z")), 0, 1, 0.0);
        close(months.at(date("2018-02-15T00:00:00Z")), 1, 2, 0.0);
        close(months.at(date("2020-02-15T12:00:00Z")), 1, 2, 0.0);
        close(months.at(date("2018-01-31T06:00:00Z")), 0, 1, 14.75 / 29.5);
        // There are 31 days from the middle of December to that of January.
        close(months.at(date("2018-01-01T00:00:00Z")), 11, 0, 0.5);
        close(months.at(date("2017-12-31T12:00:00Z")), 11, 0, 15.0 / 31.0);
        assert_eq!(
            (months.next(11, false), months.next(0, true)),
            (Some(0), Some(11))
        );
        let hard = maps(MapTimes::Months, false);
        close(hard.at(date("2018-01-31T23:59:59Z")), 0, 0, 0.0);
        close(hard.at(date("2018-02-01T00:00:00Z")), 1, 1, 0.0);
    }

    #[test]
    fn maps_of_a_span_are_those_it_draws() {
        let months = maps(MapTimes::Months, true);
        let within = |start, end| months.within(date(start), date(end));
        // From the second half of December to the first half of January.
        assert_eq!(
            within("2018-12-20T00:00:00Z", "2019-01-05T00:00:00Z"),
            [11, 0]
        );
        assert_eq!(
            within("2018-12-20T00:00:00Z", "2019-03-01T00:00:00Z"),
            [11, 0, 1, 2]
        );
        assert_eq!(
            within("2019-03-01T00:00:00Z", "2018-12-20T00:00:00Z"),
            [2, 1, 0, 11]
        );
        assert_eq!(
            within("2018-01-20T00:00:00Z", "2019-01-19T00:00:00Z").len(),
            12
        );
        let days = [
            "2018-06-01T00:00:00Z",
            "2018-06-02T00:00:00Z",
            "2018-06-03T00:00:00Z",
        ];
        let dated = maps(MapTimes::Dates(days.map(date).to_vec()), true);
        let within = |start, end| dated.within(date(start), date(end));
        assert_eq!(
            within("2018-06-01T06:00:00Z", "2018-06-01T12:00:00Z"),
            [0, 1]
        );
        assert_eq!(
            within("2018-05-01T00:00:00Z", "2018-07-01T00:00:00Z"),
            [0, 1, 2]
        );
        assert_eq!(within("2018-07-01T00:00:00Z", "2018-08-01T00:00:00Z"), [2]);
    }
}
