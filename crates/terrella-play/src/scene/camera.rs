//! `[camera]`: the eye and its view direction.

use super::camera_keys::{CameraKey, keys_text, stand_on_ground};
use super::choices::{CameraMode, CameraUp};
use super::error::SceneError;
use super::field::{Bounds, Field, NO_ORBIT, RawCameraKey, range_text, written};
use super::keys::{GEODETIC, LAT_DEG, LON_DEG, NADIR, RawCamera};
use super::look_at::LookAt;
use super::record::{number_text, quoted};
use super::sensor::SensorTable;
use super::text::SceneText;
use std::ops::RangeInclusive;

/// `[camera]`
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye looks from.
    pub mode: CameraMode,
    /// The name of the satellite that cameras fly with; `None` is the first.
    pub follow: Option<String>,
    /// Nadir mode: what is upwards on screen.
    pub up: CameraUp,
    /// Vertical field of view, degrees.
    pub fov_deg: f64,
    /// Geodetic mode: latitude, degrees.
    pub lat_deg: f64,
    /// Geodetic mode: longitude east, degrees, −180…180.
    pub lon_deg: f64,
    /// Geodetic mode: height above the ellipsoid, kilometres.
    pub height_km: f64,
    /// Geodetic mode: where the eye looks to, or what is upwards on screen if it looks straight down: degrees clockwise
    /// from north.
    pub heading_deg: f64,
    /// Geodetic mode: how far above the horizontal the eye looks, degrees; −90 is straight down.
    pub pitch_deg: f64,
    /// What it keeps in the middle of the picture; `None` is the mode's own direction of view.
    pub look_at: Option<LookAt>,
    /// Turn about the direction of view, degrees, clockwise.
    pub roll_deg: f64,
    /// What it does at moments of the flight, in their order; none stays as it is.
    pub keys: Vec<CameraKey>,
}

impl Camera {
    /// Latitudes, degrees.
    pub const LAT_DEG: RangeInclusive<f64> = LAT_DEG;
    /// Longitudes that a scene may give, degrees.
    pub const LON_DEG: RangeInclusive<f64> = LON_DEG;
}

impl SceneText<'_> {
    /// Checks `[camera]`.
    pub(super) fn camera(
        &self,
        camera: &RawCamera,
        has_orbits: bool,
        sensor: Option<&SensorTable>,
    ) -> Result<Camera, SceneError> {
        let (lat, lon, height) = (camera.lat_deg(), camera.lon_deg(), camera.height_km());
        let (heading, pitch) = (camera.heading_deg(), camera.pitch_deg());
        let of_places = [&lat, &lon, &height, &heading, &pitch];
        let stands = of_places.into_iter().find(|field| field.is_given());
        let keys = camera.keys();
        let raw_keys = keys.given.map_or(&[][..], |keys| keys.get_ref());
        let default_mode = match stands.is_some() || stand_on_ground(raw_keys) {
            true => CameraMode::Geodetic,
            false => CameraMode::Nadir,
        };
        let mode = self.choice_or(&camera.mode(), default_mode)?;
        if mode != CameraMode::Geodetic {
            for field in of_places {
                let advice = format!(
                    "{} has no meaning with mode = \"{}\", where the eye is the satellite's; leave it out or write mode = \"geodetic\"",
                    field.key,
                    written(&mode)
                );
                self.idle(field, GEODETIC.why, advice)?;
            }
        }
        let up = camera.up();
        if mode != CameraMode::Nadir {
            let advice = format!(
                "up has no meaning with mode = \"{}\"; leave it out or write mode = \"nadir\"",
                written(&mode)
            );
            self.idle(&up, NADIR.why, advice)?;
        }
        let up = self.choice(&up)?;
        let fov = camera.fov_deg();
        let fov_deg = match sensor {
            Some(sensor) => {
                let advice = "fov_deg of [camera] and focal_length_mm of [sensor] both give a field of view; leave the one out, or the [sensor]";
                self.idle(&fov, "the focal length of [sensor] gives it", advice)?;
                sensor.fov_deg()
            }
            None => self.number(&fov, |_, range| {
                format!(
                    "the field of view must be more than 0 and less than 180 degrees (from {range})"
                )
            })?,
        };
        let lat_deg = self.number(&lat, |_, range| {
            format!("must be from {range} degrees, south negative")
        })?;
        let Bounds { range, default } = &lon.rule;
        let lon_deg = lon.value().unwrap_or(*default);
        let lon_deg = half_turn(self.in_range(&lon, lon_deg, range, |_| {
            format!("must be from {} degrees, west negative", range_text(range))
        })?);
        lon.note(Ok(number_text(lon_deg)));
        let lowest_km = *height.rule.range.start();
        let height_km = self.number(&height, |height_km, range| {
            let why = match height_km {
                h if h < 0.0 => "the camera would be inside the Earth",
                h if h < lowest_km => "the camera would be below the surface that it looks at",
                _ => "nothing would be seen from so far",
            };
            format!("{why}; must be from {range} km")
        })?;
        let heading_deg = self.number(&heading, |_, range| {
            format!("must be from {range} degrees, clockwise from north")
        })?;
        let pitch_deg = self.number(&pitch, |_, range| {
            format!("must be from {range} degrees: -90 looks straight down, 0 level")
        })?;
        let follow_field = camera.follow();
        let follow = follow_field.given.map(|name| name.get_ref().clone());
        if follow.as_ref().is_some_and(|name| name.trim().is_empty()) {
            let advice = "must not be empty; give the name of a satellite of the scene, or leave follow out for the first";
            return Err(self.reject(&follow_field, advice));
        }
        follow_field.note(match &follow {
            Some(name) => quoted(name),
            None if has_orbits || mode != CameraMode::Geodetic => {
                Err("the first satellite is flown with")
            }
            None => Err(NO_ORBIT),
        });
        let is_on_board = matches!(mode, CameraMode::Nadir | CameraMode::Horizon);
        let look_at = self.look_at(&camera.look_at(), is_on_board)?;
        let roll_deg = self.number(&camera.roll_deg(), |_, range| {
            format!("must be from {range} degrees, clockwise")
        })?;
        let keys_of_mode = self.camera_keys(keys.given, mode)?;
        if look_at.is_some() {
            self.reject_direction(&[&heading, &pitch], &keys, &keys_of_mode)?;
        }
        keys.note(keys_text(&keys_of_mode));
        Ok(Camera {
            mode,
            follow,
            up,
            fov_deg,
            lat_deg,
            lon_deg,
            height_km,
            heading_deg,
            pitch_deg,
            look_at,
            roll_deg,
            keys: keys_of_mode,
        })
    }

    /// Rejects view directions besides `look_at`, which determines the direction.
    fn reject_direction(
        &self,
        given: &[&Field<'_, f64, Bounds<f64>>],
        keys: &Field<'_, Vec<RawCameraKey>>,
        keys_of_mode: &[CameraKey],
    ) -> Result<(), SceneError> {
        let advice = "look_at gives the direction of view; leave one of them out";
        if let Some(field) = given.iter().find(|field| field.is_given()) {
            return Err(self.reject(field, advice));
        }
        match keys_of_mode.iter().any(|key| key.facing_deg.is_some()) {
            true => Err(self.reject(
                keys,
                "have heading_deg and pitch_deg, and look_at gives the direction of view; leave one of them out",
            )),
            false => Ok(()),
        }
    }
}

/// Wraps a longitude of −360…360 to −180…180; exact if it is already inside.
fn half_turn(lon_deg: f64) -> f64 {
    match lon_deg {
        lon if lon > 180.0 => lon - 360.0,
        lon if lon < -180.0 => lon + 360.0,
        lon => lon,
    }
}
