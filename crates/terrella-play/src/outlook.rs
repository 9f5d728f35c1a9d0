//! Lighting of a film, determined before it is drawn.

use super::clock::frame_epoch;
use super::error::PlayError;
use super::flight::{Flight, Moment};
use crate::scene::{Scene, StartSource};
use std::ops::Range;
use terrella::frames::{Duration, Ellipsoid, Epoch, Illumination, rfc3339};

/// Most frames that are looked at; more of a film are looked at evenly spread.
const MOST_FRAMES: u64 = 1_000;
/// How far beyond a film that is dark to its end light is looked for, and in which steps.
const FURTHER: Duration = Duration::from_parts(0, 86_400 * NS_PER_S);
const STEP: Duration = Duration::from_parts(0, 60 * NS_PER_S);
/// Precision of the times.
const TO: Duration = Duration::from_parts(0, NS_PER_S);
const NS_PER_S: u64 = 1_000_000_000;

/// The light of a film: of its satellite, and of the ground below its eye.
#[derive(Clone, Debug, PartialEq)]
pub struct LightOutlook {
    /// When the satellite that cameras fly with is out of the Earth's shadow; `None` where no camera flies with one.
    pub satellite: Option<LightTimes>,
    /// When the Sun is above the horizon of the place below the eye.
    pub ground: LightTimes,
}

/// When there is light in the course of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct LightTimes {
    /// The part of its frames in the dark, 0…1.
    pub dark_share: f64,
    /// The first instant of the film at which it is dark, to a second, if there is one.
    pub dark_from: Option<Epoch>,
    /// The first instant at which it is light, to a second: of the film, or where that is all dark of the day after it.
    pub light_from: Option<Epoch>,
}

/// The place that is lit or dark.
#[derive(Clone, Copy)]
enum Lit {
    Satellite,
    Ground,
}

impl Lit {
    /// Whether it is lit; `None` without a satellite.
    fn is_light(self, moment: &Moment, ellipsoid: &Ellipsoid) -> Option<bool> {
        match self {
            Self::Satellite => {
                let (light, _) = moment.satellite?.illumination;
                Some(light == Illumination::Sunlit)
            }
            Self::Ground => {
                let (eye_itrf_m, _) = moment.view.to_itrf();
                let below = ellipsoid.geodetic_from_itrf(eye_itrf_m);
                let up = Ellipsoid::normal(below.lat_rad, below.lon_rad);
                Some(up.dot(moment.sky.sun_itrf) > 0.0)
            }
        }
    }
}

impl LightOutlook {
    /// Lighting of these frames of a scene's film.
    ///
    /// # Errors
    /// A frame that cannot be drawn because its satellite has no state.
    pub fn of(flight: &Flight, frames: Range<u64>) -> Result<Self, PlayError> {
        let epochs = looked_at(flight, &frames);
        let moments = epochs.iter().map(|epoch| flight.at(*epoch, 1.0));
        let moments = moments.collect::<Result<Vec<_>, _>>()?;
        let of = |place| times_of(flight, place, &moments);
        Ok(Self {
            satellite: of(Lit::Satellite),
            ground: of(Lit::Ground).unwrap_or_else(LightTimes::all_light),
        })
    }

    /// A sentence of the satellite, if there is one, and one of the ground below, without full stops.
    pub fn sentences(&self) -> Vec<String> {
        let satellite = self.satellite.as_ref().map(|times| {
            let words = ["in the Earth's shadow", "in sunlight"];
            format!("the satellite is {}", times.words(words))
        });
        let words = ["in night", "in daylight"];
        let ground = format!("the ground below is {}", self.ground.words(words));
        satellite.into_iter().chain([ground]).collect()
    }
}

impl LightOutlook {
    /// Advice for a film that is entirely at night; `None` for others, and for scenes that ask for the lights of cities.
    pub fn advice(&self, scene: &Scene) -> Option<String> {
        if scene.earth.night_lights && scene.line("earth", "night_lights").is_some() {
            return None;
        }
        let from = self
            .ground
            .light_from
            .filter(|_| self.ground.is_all_dark())?;
        Some(format!(
            "the film begins in the dark; --start {} begins in daylight",
            whole_second(from)
        ))
    }
}

impl LightTimes {
    fn all_light() -> Self {
        Self {
            dark_share: 0.0,
            dark_from: None,
            light_from: None,
        }
    }

    /// Whether all frames are dark.
    pub fn is_all_dark(&self) -> bool {
        self.dark_share == 1.0
    }

    /// When it is light and when dark, by the words for both.
    fn words(&self, [dark, light]: [&str; 2]) -> String {
        let (Some(dark_from), true) = (self.dark_from, self.dark_share > 0.0) else {
            return format!("{light} all the time");
        };
        let share = match self.dark_share {
            1.0 => "all the time".to_owned(),
            share => format!("for {} of the film", percent(share)),
        };
        let then = match self.light_from {
            None => format!("not {light} within a day after it"),
            Some(from) if from < dark_from => format!("{light} until {}", whole_second(dark_from)),
            Some(from) => format!("{light} from {} on", whole_second(from)),
        };
        format!("{dark} {share}, {then}")
    }
}

/// Note about an image at a default start time with the ground below in darkness.
pub fn night_note(flight: &Flight) -> Option<String> {
    let scene = flight.scene();
    let is_chosen = !matches!(
        scene.time.start_from,
        StartSource::Clock | StartSource::Satellite(_)
    );
    if is_chosen || scene.is_live() {
        return None;
    }
    let ground = LightOutlook::of(flight, 0..1).ok()?.ground;
    if !ground.is_all_dark() {
        return None;
    }
    let start = whole_second(scene.time.start);
    Some(match ground.light_from {
        None => format!("the ground below is in night at {start}, and for a day after it"),
        Some(from) => {
            let from = whole_second(from);
            format!(
                "the ground below is in night at {start}; in daylight from {from} on: --at {from}"
            )
        }
    })
}

/// Frames of a range, all or evenly spread, the last among them.
fn looked_at(flight: &Flight, frames: &Range<u64>) -> Vec<Epoch> {
    let time = &flight.scene().time;
    let last = frames.end.saturating_sub(1).max(frames.start);
    let steps = (last - frames.start).min(MOST_FRAMES - 1);
    let at = |step: u64| {
        let of_all = u128::from(last - frames.start) * u128::from(step);
        let beyond = of_all.checked_div(u128::from(steps)).unwrap_or(0);
        frame_epoch(time, frames.start + u64::try_from(beyond).unwrap_or(0))
    };
    (0..=steps).map(at).collect()
}

fn times_of(flight: &Flight, place: Lit, moments: &[Moment]) -> Option<LightTimes> {
    let ellipsoid = flight.ellipsoid();
    let lights = moments.iter().map(|one| place.is_light(one, ellipsoid));
    let lights = lights.collect::<Option<Vec<_>>>()?;
    let change = |wanted: bool| {
        let found = lights.iter().position(|light| *light == wanted)?;
        let epoch = moments.get(found)?.epoch;
        match found.checked_sub(1).and_then(|before| moments.get(before)) {
            Some(before) => Some(narrowed(flight, place, before.epoch, epoch, wanted)),
            None => Some(epoch),
        }
    };
    let dark = lights.iter().filter(|light| !**light).count();
    Some(LightTimes {
        dark_share: dark as f64 / lights.len() as f64,
        dark_from: change(false),
        light_from: change(true).or_else(|| light_after(flight, place, moments.last()?.epoch)),
    })
}

/// When it is light after a film that is dark to its end, looked for in the film's direction of time.
fn light_after(flight: &Flight, place: Lit, end: Epoch) -> Option<Epoch> {
    let step = match flight.scene().time.speed < 0.0 {
        true => -STEP,
        false => STEP,
    };
    let steps = (FURTHER.to_seconds() / STEP.to_seconds()) as i64;
    let mut before = end;
    for _ in 0..steps {
        let epoch = before + step;
        if is_light_at(flight, place, epoch)? {
            return Some(narrowed(flight, place, before, epoch, true));
        }
        before = epoch;
    }
    None
}

fn is_light_at(flight: &Flight, place: Lit, epoch: Epoch) -> Option<bool> {
    let moment = flight.at(epoch, 1.0).ok()?;
    place.is_light(&moment, flight.ellipsoid())
}

/// Time of the change to `wanted` between two times, of which the second has it.
fn narrowed(flight: &Flight, place: Lit, before: Epoch, after: Epoch, wanted: bool) -> Epoch {
    let (mut before, mut after) = (before, after);
    while (after - before).abs() > TO {
        let middle = before + (after - before) * 0.5;
        match is_light_at(flight, place, middle) {
            Some(light) if light == wanted => after = middle,
            Some(_) => before = middle,
            None => break,
        }
    }
    after
}

/// A percentage that is not rounded to 0 or 100.
fn percent(share: f64) -> String {
    match share * 100.0 {
        less if less < 1.0 => "less than 1 %".to_owned(),
        most if most > 99.0 => "more than 99 %".to_owned(),
        percent => format!("{percent:.0} %"),
    }
}

fn whole_second(epoch: Epoch) -> String {
    let text = rfc3339(epoch);
    match text.split_once('.') {
        Some((second, _)) => format!("{second}Z"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn flight(text: &str) -> Flight {
        let scene = Scene::from_toml(text, Path::new("test.toml")).expect("a good scene");
        Flight::open(scene).expect("opens")
    }

    fn outlook(text: &str) -> LightOutlook {
        let flight = flight(text);
        LightOutlook::of(&flight, 0..flight.scene().time.frame_count()).expect("is known")
    }

    /// An equatorial circle at an equinox has the Sun in its plane: the shadow is as wide as the Earth's disc, an arc of
    /// 2 asin(R / a), and the penumbra makes it half a degree wider.
    #[test]
    fn the_share_of_shadow_is_that_of_plane_geometry() {
        let axis_km = 6_778.0_f64;
        let period_s = std::f64::consts::TAU * (axis_km.powi(3) / 398_600.441_8).sqrt();
        let reported = outlook(&format!(
            "[time]\nstart = \"2018-03-20T16:15:00Z\"\nduration_s = {period_s}\n[orbit]\nsource = \"kepler\"\nsemi_major_axis_km = {axis_km}\n"
        ));
        let satellite = reported.satellite.clone().expect("a satellite");
        let share = 2.0 * (6_378.137 / axis_km).asin() / std::f64::consts::TAU;
        let penumbra = 0.533_f64.to_radians() / std::f64::consts::TAU;
        let wanted = share + penumbra;
        assert!(
            (satellite.dark_share - wanted).abs() < 2e-3,
            "{} for {wanted}",
            satellite.dark_share
        );
        // Straight below it is night on half of the equator.
        assert!(
            (reported.ground.dark_share - 0.5).abs() < 2e-3,
            "{reported:?}"
        );
        // Perigee at the Sun's right ascension of 0°: sunlit from the start to beyond a quarter of the orbit.
        let (light, dark) = (satellite.light_from, satellite.dark_from.expect("shadow"));
        let start = flight("[time]\nstart = \"2018-03-20T16:15:00Z\"\n")
            .scene()
            .time
            .start;
        assert_eq!(light, Some(start));
        let until = (dark - start).to_seconds() / period_s;
        assert!((until - (1.0 - wanted) / 2.0).abs() < 2e-3, "{until}");
    }

    /// Sunrise at the north pole is about the equinox; over Greenwich at noon it is day.
    #[test]
    fn light_is_looked_for_beyond_a_dark_film() {
        let place = |start: &str, lat_deg: f64| {
            outlook(&format!(
                "[time]\nstart = \"{start}\"\nduration_s = 600\n[camera]\nmode = \"geodetic\"\nlat_deg = {lat_deg}\nlon_deg = 0\n"
            ))
        };
        let noon = place("2018-03-20T12:00:00Z", 0.0);
        assert_eq!(noon.satellite, None);
        assert_eq!(
            noon.sentences(),
            ["the ground below is in daylight all the time"]
        );
        // The equation of time is −7.6 min then: the Sun's centre rises at 6 h 7.6 min.
        let midnight = place("2018-03-20T00:00:00Z", 0.0).ground;
        assert!(midnight.is_all_dark(), "{midnight:?}");
        let rises = rfc3339(midnight.light_from.expect("a sunrise"));
        assert!(
            ("2018-03-20T06:07:00".."2018-03-20T06:08:30").contains(&rises.as_str()),
            "{rises}"
        );
        let polar = place("2018-12-21T00:00:00Z", 89.0);
        assert_eq!(
            polar.sentences(),
            ["the ground below is in night all the time, not in daylight within a day after it"]
        );
    }

    #[test]
    fn daylight_is_advised_for_dark_films_that_do_not_ask_for_night() {
        let advice = |hour: u32, more: &str| {
            let flight = flight(&format!(
                "[time]\nstart = \"2018-03-20T{hour:02}:00:00Z\"\nduration_s = 600\n[camera]\nmode = \"geodetic\"\nlat_deg = 0\nlon_deg = 0\n{more}"
            ));
            let light = LightOutlook::of(&flight, 0..flight.scene().time.frame_count());
            light.expect("is known").advice(flight.scene())
        };
        let dark = advice(0, "").expect("advice");
        assert!(
            dark.starts_with("the film begins in the dark; --start 2018-03-20T06:")
                && dark.ends_with(" begins in daylight"),
            "{dark}"
        );
        assert_eq!(advice(0, "[earth]\nnight_lights = true"), None);
        assert!(advice(0, "[earth]\nnight_lights = false").is_some());
        assert_eq!(advice(12, ""), None);
    }

    #[test]
    fn shares_are_neither_nothing_nor_all_unless_they_are() {
        assert_eq!(percent(0.001), "less than 1 %");
        assert_eq!(percent(0.999), "more than 99 %");
        assert_eq!(percent(0.386), "39 %");
    }
}
