//! `[[camera.keys]]`: keyframes of the camera, with smooth interpolation between them.

use super::choices::CameraMode;
use super::error::{SceneError, printable};
use super::field::{RawCameraKey, short_range_text, written};
use super::keys::{LAT_DEG, LON_DEG, MAX_CAMERA_KEYS, TURN_DEG};
use super::record::KeyText;
use super::text::{SceneText, nearest};
use std::fmt::Write;
use std::ops::{Range, RangeInclusive};
use terrella_ground::light::Exposure;
use toml::{Spanned, Value};

/// A camera keyframe. A `None` field is not keyed here: it is interpolated between the previous and the next
/// keyframe that have it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraKey {
    /// The moment, simulated seconds after the scene's start; negative before it.
    pub time_s: f64,
    /// Whether the camera jumps there: what is keyed before counts no more.
    pub cut: bool,
    /// Geodetic mode: latitude and longitude, degrees, and height above the ellipsoid, kilometres.
    pub place: Option<[f64; 3]>,
    /// Geodetic mode: heading, degrees clockwise from north, and pitch, degrees above the horizontal.
    pub facing_deg: Option<[f64; 2]>,
    /// Nadir and horizon mode: how far the head is turned to the right and upwards, degrees.
    pub turn_deg: Option<[f64; 2]>,
    /// Chase mode: where the eye is, seen from the satellite: ahead, to the right and down, metres.
    pub offset_m: Option<[f64; 3]>,
    /// Turn about the direction of view, degrees, clockwise.
    pub roll_deg: Option<f64>,
    /// Vertical field of view, degrees.
    pub fov_deg: Option<f64>,
    /// Exposure value.
    pub exposure_ev: Option<f64>,
}

/// The keys of a keyframe, with range and unit.
pub(super) const NUMBERS: [(&str, RangeInclusive<f64>, &str); 10] = [
    ("time_s", -1e9..=1e9, "seconds after the scene's start"),
    ("lat_deg", LAT_DEG, "degrees, south negative"),
    ("lon_deg", LON_DEG, "degrees, west negative"),
    ("height_km", 0.001..=1e9, "km"),
    (
        "heading_deg",
        -360.0..=360.0,
        "degrees, clockwise from north",
    ),
    (
        "pitch_deg",
        -90.0..=90.0,
        "degrees above the horizontal; -90 looks straight down",
    ),
    ("yaw_deg", -180.0..=180.0, "degrees to the right"),
    ("roll_deg", TURN_DEG, "degrees, clockwise"),
    ("fov_deg", 0.001..=179.999, "degrees"),
    ("exposure_ev", Exposure::RANGE_EV, "exposure values"),
];
/// Starts a new shot.
pub(super) const CUT: &str = "cut";
pub(super) const OFFSET: &str = "offset_m";
/// Range of each offset component, and minimum length of the offset, metres: outside the drawn
/// craft.
pub(super) const OFFSET_M: RangeInclusive<f64> = -1e6..=1e6;
const NEAREST_M: f64 = 15.0;
/// Places farther apart have no unique path between them.
const WIDEST_STEP_DEG: f64 = 170.0;
/// Keys that must be given together.
const PLACE: [&str; 3] = ["lat_deg", "lon_deg", "height_km"];
const FACING: [&str; 2] = ["heading_deg", "pitch_deg"];
const TURN: [&str; 2] = ["yaw_deg", "pitch_deg"];
const LIST: &str = "a keyframe has time_s, and sets any of lat_deg, lon_deg and height_km, heading_deg and pitch_deg (mode = \"geodetic\"), yaw_deg and pitch_deg (\"nadir\", \"horizon\"), offset_m (\"chase\"), roll_deg, fov_deg and exposure_ev; with cut = true the camera jumps there";

/// Whether any keyframe is over the ground.
pub(super) fn stand_on_ground(keys: &[RawCameraKey]) -> bool {
    let mut names = keys.iter().flat_map(|key| key.keys());
    names.any(|name| PLACE.contains(&name.as_str()) || name == FACING[0])
}

impl SceneText<'_> {
    /// Checks `[[camera.keys]]` of a camera of this mode.
    pub(super) fn camera_keys(
        &self,
        given: Option<&Spanned<Vec<RawCameraKey>>>,
        mode: CameraMode,
    ) -> Result<Vec<CameraKey>, SceneError> {
        let Some(given) = given else {
            return Ok(Vec::new());
        };
        let raw = given.get_ref();
        if raw.is_empty() || raw.len() > MAX_CAMERA_KEYS {
            let advice =
                format!("must have 1 to {MAX_CAMERA_KEYS} keyframes; add one, or leave keys out");
            return Err(self.reject_at("camera", "keys", given.span(), advice));
        }
        let mut keys: Vec<CameraKey> = Vec::new();
        let mut place: Option<[f64; 3]> = None;
        for entries in raw {
            let key = self.camera_key(entries, mode, given.span())?;
            if let Some(before) = keys.last()
                && key.time_s <= before.time_s
            {
                let advice = format!(
                    "must be later than the keyframe before it, {}; write keyframes in the order of their times",
                    before.time_s
                );
                return Err(self.reject_key(entries, "time_s", given.span(), advice));
            }
            if let (Some(from), Some(to), false) = (place, key.place, key.cut)
                && angle_deg(from, to) > WIDEST_STEP_DEG
            {
                let advice = "is on the other side of the Earth from the place before, and no way there is the shortest; give a key between them";
                return Err(self.reject_key(entries, "lon_deg", given.span(), advice));
            }
            place = match key.cut {
                true => key.place,
                false => key.place.or(place),
            };
            keys.push(key);
        }
        Ok(keys)
    }

    fn reject_key(
        &self,
        entries: &RawCameraKey,
        name: &str,
        all: Range<usize>,
        advice: impl std::fmt::Display,
    ) -> SceneError {
        let span = entries.get(name).map_or(all, Spanned::span);
        self.reject_at("camera.keys", name, span, advice)
    }

    fn camera_key(
        &self,
        entries: &RawCameraKey,
        mode: CameraMode,
        all: Range<usize>,
    ) -> Result<CameraKey, SceneError> {
        let reject =
            |name: &str, advice: String| self.reject_key(entries, name, all.clone(), advice);
        let known = || NUMBERS.iter().map(|(name, ..)| *name).chain([OFFSET, CUT]);
        for name in entries.keys() {
            if !known().any(|known| known == name) {
                let hint = match nearest(name, known()) {
                    Some(near) => format!("unknown key; did you mean {near}?"),
                    None => format!("unknown key. {LIST}"),
                };
                return Err(self.reject_at(
                    "camera.keys",
                    &printable(name),
                    entries.get(name).map_or(all, Spanned::span),
                    hint,
                ));
            }
        }
        let number = |name: &str| -> Result<Option<f64>, SceneError> {
            let Some(value) = entries.get(name) else {
                return Ok(None);
            };
            let rule = NUMBERS.iter().find(|(known, ..)| *known == name);
            let (_, range, unit) = rule.ok_or_else(|| reject(name, LIST.to_owned()))?;
            let number = number_of(value.get_ref()).filter(|number| range.contains(number));
            let advice = || format!("must be a number from {} {unit}", short_range_text(range));
            number.map(Some).ok_or_else(|| reject(name, advice()))
        };
        let only_in = |name: &str, modes: &[CameraMode]| match entries.contains_key(name)
            && !modes.contains(&mode)
        {
            false => Ok(()),
            true => {
                let modes: Vec<_> = modes
                    .iter()
                    .map(|mode| format!("\"{}\"", written(mode)))
                    .collect();
                Err(reject(
                    name,
                    format!(
                        "has no meaning with mode = \"{}\"; it is for mode = {}",
                        written(&mode),
                        modes.join(" or ")
                    ),
                ))
            }
        };
        for name in PLACE.into_iter().chain([FACING[0]]) {
            only_in(name, &[CameraMode::Geodetic])?;
        }
        only_in(TURN[0], &[CameraMode::Nadir, CameraMode::Horizon])?;
        only_in(
            TURN[1],
            &[CameraMode::Geodetic, CameraMode::Nadir, CameraMode::Horizon],
        )?;
        only_in(OFFSET, &[CameraMode::Chase])?;
        // All keys of a group, or none.
        let together = |names: &[&str]| -> Result<Option<Vec<f64>>, SceneError> {
            let Some(first) = names.iter().find(|name| entries.contains_key(**name)) else {
                return Ok(None);
            };
            let mut numbers = Vec::new();
            for name in names {
                let missing = || {
                    reject(
                        first,
                        format!(
                            "needs {name} with it: {} are given together",
                            names.join(", ")
                        ),
                    )
                };
                numbers.push(number(name)?.ok_or_else(missing)?);
            }
            Ok(Some(numbers))
        };
        let facing = match mode {
            CameraMode::Geodetic => together(&FACING)?,
            _ => together(&TURN)?,
        };
        let facing = facing.map(|numbers| [numbers[0], numbers[1]]);
        let is_on_ground = mode == CameraMode::Geodetic;
        let key = CameraKey {
            time_s: number("time_s")?.ok_or_else(|| reject("time_s", format!("is missing; {LIST}")))?,
            cut: match entries.get(CUT).map(Spanned::get_ref) {
                None => false,
                Some(Value::Boolean(cut)) => *cut,
                Some(_) => return Err(reject(CUT, "must be true or false".to_owned())),
            },
            place: together(&PLACE)?.map(|numbers| [numbers[0], numbers[1], numbers[2]]),
            facing_deg: facing.filter(|_| is_on_ground),
            turn_deg: facing.filter(|_| !is_on_ground),
            offset_m: match entries.get(OFFSET) {
                None => None,
                Some(value) => Some(offset(value.get_ref()).ok_or_else(|| {
                    reject(OFFSET, format!("must be [ahead, right, down], three numbers of metres from {}, together {NEAREST_M} m or more from the satellite", short_range_text(&OFFSET_M)))
                })?),
            },
            roll_deg: number("roll_deg")?,
            fov_deg: number("fov_deg")?,
            exposure_ev: number("exposure_ev")?,
        };
        let sets_nothing = CameraKey {
            time_s: key.time_s,
            cut: key.cut,
            ..CameraKey::default()
        };
        if key == sets_nothing {
            return Err(reject("time_s", format!("sets nothing; {LIST}")));
        }
        Ok(key)
    }
}

pub(super) fn number_of(value: &Value) -> Option<f64> {
    match value {
        // Numbers in scenes are far inside the exact range of f64.
        Value::Integer(whole) => Some(*whole as f64),
        Value::Float(number) => Some(*number),
        _ => None,
    }
}

fn offset(value: &Value) -> Option<[f64; 3]> {
    let Value::Array(parts) = value else {
        return None;
    };
    let parts: Option<Vec<f64>> = parts.iter().map(number_of).collect();
    let [x, y, z] = parts?.try_into().ok()?;
    let is_far = (x * x + y * y + z * z).sqrt() >= NEAREST_M;
    (is_far && [x, y, z].iter().all(|part| OFFSET_M.contains(part))).then_some([x, y, z])
}

/// Angle between two places, degrees, on a sphere.
fn angle_deg(from: [f64; 3], to: [f64; 3]) -> f64 {
    let direction = |[lat, lon, _]: [f64; 3]| {
        let (sin_lat, cos_lat) = lat.to_radians().sin_cos();
        let (sin_lon, cos_lon) = lon.to_radians().sin_cos();
        glam::DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat)
    };
    direction(from).angle_between(direction(to)).to_degrees()
}

/// Keyframes in scene syntax.
pub(super) fn keys_text(keys: &[CameraKey]) -> KeyText {
    if keys.is_empty() {
        return Err("the camera stays as it is");
    }
    let text = |key: &CameraKey| {
        let mut text = format!("{{ time_s = {}", key.time_s);
        let groups = [
            (&PLACE[..], key.place.map(|place| place.to_vec())),
            (&FACING[..], key.facing_deg.map(|facing| facing.to_vec())),
            (&TURN[..], key.turn_deg.map(|turn| turn.to_vec())),
            (&["roll_deg"][..], key.roll_deg.map(|roll| vec![roll])),
            (&["fov_deg"][..], key.fov_deg.map(|fov| vec![fov])),
            (&["exposure_ev"][..], key.exposure_ev.map(|ev| vec![ev])),
        ];
        for (names, values) in groups {
            for (name, value) in names.iter().zip(values.iter().flatten()) {
                // Writing to a string cannot fail.
                let _ = write!(text, ", {name} = {value}");
            }
        }
        if key.cut {
            text.push_str(", cut = true");
        }
        if let Some([x, y, z]) = key.offset_m {
            let _ = write!(text, ", {OFFSET} = [{x}, {y}, {z}]");
        }
        text + " }"
    };
    let texts: Vec<_> = keys.iter().map(text).collect();
    Ok(format!("[{}]", texts.join(", ")))
}
