//! `[camera] look_at`: the target in the centre of the image.

use super::camera_keys::number_of;
use super::error::{SceneError, printable};
use super::field::{Field, RawLookAt, look_at_forms};
use super::keys::{LAT_DEG, LON_DEG};
use super::record::{KeyText, quoted};
use super::text::SceneText;
use std::ops::RangeInclusive;
use toml::{Spanned, Table, Value};

/// `[camera] look_at`
#[derive(Clone, Debug, PartialEq)]
pub enum LookAt {
    /// The centre of the Sun.
    Sun,
    /// The centre of the Moon.
    Moon,
    /// A satellite of the scene by name; `None` is the one named by `follow`.
    Satellite(Option<String>),
    /// A place: latitude and longitude, degrees, and height above the ellipsoid, kilometres.
    Place([f64; 3]),
}

/// Why a camera cannot look at the satellite that carries it.
pub(super) const ON_BOARD: &str = "is the satellite that the camera is on; give another's name, or write mode = \"chase\" or \"geodetic\"";
/// Height of a place above the ellipsoid, kilometres.
pub(super) const PLACE_HEIGHT_KM: RangeInclusive<f64> = 0.0..=1e9;
/// Keys of a place.
const PLACE: [&str; 3] = ["lat_deg", "lon_deg", "height_km"];

impl LookAt {
    /// The value in scene syntax.
    fn text(&self) -> KeyText {
        match self {
            Self::Sun => quoted("sun"),
            Self::Moon => quoted("moon"),
            Self::Satellite(name) => quoted(name.as_deref().unwrap_or("satellite")),
            Self::Place([lat, lon, height]) => Ok(format!(
                "{{ lat_deg = {lat}, lon_deg = {lon}, height_km = {height} }}"
            )),
        }
    }

    /// Description of the target.
    pub(super) fn words(&self) -> String {
        match self {
            Self::Sun => "the Sun".to_owned(),
            Self::Moon => "the Moon".to_owned(),
            Self::Satellite(None) => "the satellite".to_owned(),
            Self::Satellite(Some(name)) => printable(name),
            Self::Place([lat, lon, _]) => format!("{lat}° latitude, {lon}° longitude"),
        }
    }
}

impl SceneText<'_> {
    pub(super) fn look_at(
        &self,
        field: &Field<'_, RawLookAt>,
        is_on_board: bool,
    ) -> Result<Option<LookAt>, SceneError> {
        let target = match field.given.map(Spanned::get_ref) {
            None => None,
            Some(RawLookAt(Value::String(word))) => Some(match word.trim() {
                "" => {
                    return Err(self.reject(field, format!("must be {}", look_at_forms())));
                }
                "sun" => LookAt::Sun,
                "moon" => LookAt::Moon,
                "satellite" => LookAt::Satellite(None),
                name => LookAt::Satellite(Some(name.to_owned())),
            }),
            Some(RawLookAt(Value::Table(place))) => {
                let place = place_of(place).map_err(|advice| self.reject(field, advice))?;
                Some(LookAt::Place(place))
            }
            Some(_) => return Err(self.reject(field, format!("must be {}", look_at_forms()))),
        };
        if is_on_board && target == Some(LookAt::Satellite(None)) {
            return Err(self.reject(field, ON_BOARD));
        }
        field.note(match &target {
            Some(target) => target.text(),
            None => Err("the mode gives the direction of view"),
        });
        Ok(target)
    }
}

fn place_of(keys: &Table) -> Result<[f64; 3], String> {
    if let Some(key) = keys.keys().find(|key| !PLACE.contains(&key.as_str())) {
        return Err(format!(
            "a place has lat_deg, lon_deg and height_km, not {}",
            printable(key)
        ));
    }
    let number = |name: &str, range: &RangeInclusive<f64>, unit: &str| {
        let Some(value) = keys.get(name) else {
            return Ok(None);
        };
        let value = number_of(value).ok_or_else(|| format!("{name} must be a number of {unit}"))?;
        let (low, high) = (range.start(), range.end());
        let message = || format!("{name} must be from {low} to {high} {unit}");
        range
            .contains(&value)
            .then_some(Some(value))
            .ok_or_else(message)
    };
    let needed = |name: &str| format!("{name} is missing: a place has lat_deg and lon_deg");
    let lat = number(PLACE[0], &LAT_DEG, "degrees")?.ok_or_else(|| needed(PLACE[0]))?;
    let lon = number(PLACE[1], &LON_DEG, "degrees")?.ok_or_else(|| needed(PLACE[1]))?;
    let height = number(PLACE[2], &PLACE_HEIGHT_KM, "kilometres")?.unwrap_or(0.0);
    Ok([lat, lon, height])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn camera(text: &str) -> Result<Scene, SceneError> {
        Scene::from_toml(&format!("[orbit]\n[camera]\n{text}"), "a.toml".as_ref())
    }

    #[test]
    fn targets_are_read() {
        for (text, wanted) in [
            ("look_at = \"sun\"", LookAt::Sun),
            ("look_at = \"moon\"", LookAt::Moon),
            (
                "mode = \"geodetic\"\nlook_at = \"satellite\"",
                LookAt::Satellite(None),
            ),
            (
                "look_at = \"ISS (ZARYA)\"",
                LookAt::Satellite(Some("ISS (ZARYA)".to_owned())),
            ),
            (
                "look_at = { lat_deg = 48, lon_deg = 16.5 }",
                LookAt::Place([48.0, 16.5, 0.0]),
            ),
        ] {
            let scene = camera(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!(scene.camera.look_at, Some(wanted));
        }
        assert_eq!(camera("").expect("a good scene").camera.look_at, None);
    }

    #[test]
    fn what_is_no_target_is_named_with_its_remedy() {
        for (text, part) in [
            ("look_at = \"\"", "\"sun\""),
            ("look_at = 3", "\"sun\""),
            ("look_at = \"satellite\"", "another's name"),
            ("look_at = { lat_deg = 91, lon_deg = 0 }", "from -90 to 90"),
            ("look_at = { lat_deg = 1 }", "lon_deg is missing"),
            ("look_at = { lat_deg = 1, lon_deg = 1, alt = 3 }", "not alt"),
            ("look_at = { lat_deg = nan, lon_deg = 1 }", "from -90 to 90"),
            (
                "mode = \"geodetic\"\nlook_at = \"sun\"\npitch_deg = 0",
                "look_at",
            ),
            (
                "look_at = \"sun\"\nkeys = [{ time_s = 0, lat_deg = 1, lon_deg = 1, height_km = 1, heading_deg = 1, pitch_deg = 0 }]",
                "look_at",
            ),
            ("roll_deg = 400", "from −360 to 360"),
        ] {
            let error = camera(text).expect_err(text).to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
