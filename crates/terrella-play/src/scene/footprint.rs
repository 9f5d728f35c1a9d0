//! A satellite's sensor: its field of view, footprint and swath.

use super::error::SceneError;
use super::field::{own_or, range_text};
use super::orbit_keys::{RawOrbit, RawTracks};
use super::record::number_text;
use super::text::SceneText;
use super::track_span::TrackSpan;
use terrella_orbit::{FieldOfView, FieldShape};
use toml::Spanned;

/// Why footprint keys have no value.
const UNSHOWN: &str = "only for footprint = true";

/// The ground visible to a sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// Its field of view; `None` is all the ground in sight.
    pub field: Option<FieldOfView>,
    /// Whether it is tinted.
    pub fill: bool,
    /// Whether lines show the field of view in space.
    pub lines: bool,
    /// Over what time the swath is drawn.
    pub swath: Option<TrackSpan>,
}

impl Footprint {
    /// Description for a summary.
    pub fn words(&self) -> String {
        let tinted = if self.fill { ", tinted" } else { "" };
        let Some(field) = self.field else {
            return format!("footprint to the horizon{tinted}");
        };
        // Degrees as in the scene, without the rounding of radians.
        let deg = |rad: f64| (1e9 * rad.to_degrees()).round() / 1e9;
        let shape = match field.shape {
            FieldShape::Cone { half_angle_rad } => format!("{}°", deg(half_angle_rad)),
            FieldShape::Rectangle {
                along_rad,
                across_rad,
            } => format!("{}° × {}°", deg(along_rad), deg(across_rad)),
        };
        match field.off_nadir_rad {
            0.0 => format!("footprint of {shape} about straight down{tinted}"),
            off => format!("footprint of {shape} {}° off nadir{tinted}", deg(off)),
        }
    }
}

impl SceneText<'_> {
    /// Checks the drawn parts of a satellite's sensor, and returns them with its field of view. In a scene with a coverage map the field of view
    /// counts even if it is not drawn.
    pub(super) fn footprint(
        &self,
        orbit: &RawOrbit,
        tracks: &RawTracks,
        has_coverage: bool,
    ) -> Result<(Option<Footprint>, Option<FieldOfView>), SceneError> {
        let shown = own_or(orbit.footprint(), tracks.footprint());
        let field = self.field_of_view(orbit, tracks)?;
        let swath = own_or(orbit.swath(), tracks.swath());
        let swath_span = self.span(&swath)?;
        let fill = own_or(orbit.footprint_fill(), tracks.footprint_fill());
        let lines = own_or(orbit.sensor_lines(), tracks.sensor_lines());
        // A given sensor or swath is shown by default.
        let is_shown = shown.is_on_or(field.is_some() || swath_span.is_some());
        if is_shown {
            let footprint = Footprint {
                field,
                fill: fill.is_on(),
                lines: lines.is_on(),
                swath: swath_span,
            };
            return Ok((Some(footprint), field));
        }
        // `footprint = false` of one satellite overrides the keys of `[tracks]`.
        let is_meant = |table: &str| !shown.is_given() || shown.table == table;
        let is_idle = |table: &str| !has_coverage && is_meant(table);
        let angle = own_or(
            orbit.sensor_half_angle_deg(),
            tracks.sensor_half_angle_deg(),
        );
        let advice = "a sensor's field of view has no meaning with footprint = false and without [coverage]; leave one of them out";
        if angle.is_given() && is_idle(angle.table) {
            return Err(self.reject(&angle, advice));
        }
        let angles = own_or(
            orbit.sensor_half_angles_deg(),
            tracks.sensor_half_angles_deg(),
        );
        if angles.is_given() && is_idle(angles.table) {
            return Err(self.reject(&angles, advice));
        }
        if swath_span.is_some() && is_meant(swath.table) {
            let advice = "a swath is drawn with its footprint; leave footprint = false out";
            return Err(self.reject(&swath, advice));
        }
        for (key, does) in [
            (&fill, "tints a footprint"),
            (&lines, "leads to a footprint"),
        ] {
            if key.is_on() && is_meant(key.table) {
                let advice = format!(
                    "{} {does} and there is none; write footprint = true, or give sensor_half_angle_deg",
                    key.key
                );
                return Err(self.reject(key, advice));
            }
            key.note(Err(UNSHOWN));
        }
        angle.note(Err(UNSHOWN));
        angles.note(Err(UNSHOWN));
        Ok((None, field))
    }

    /// Checks the field of view; `None` means all visible ground.
    fn field_of_view(
        &self,
        orbit: &RawOrbit,
        tracks: &RawTracks,
    ) -> Result<Option<FieldOfView>, SceneError> {
        let cone = own_or(
            orbit.sensor_half_angle_deg(),
            tracks.sensor_half_angle_deg(),
        );
        let rectangle = own_or(
            orbit.sensor_half_angles_deg(),
            tracks.sensor_half_angles_deg(),
        );
        let off_nadir = own_or(orbit.sensor_off_nadir_deg(), tracks.sensor_off_nadir_deg());
        let azimuth = own_or(orbit.sensor_azimuth_deg(), tracks.sensor_azimuth_deg());
        // A satellite's own shape overrides the other shape in `[tracks]`.
        let (has_cone, has_rectangle) = match (cone.is_given(), rectangle.is_given()) {
            (true, true) if cone.table != rectangle.table => {
                (cone.table == "orbit", rectangle.table == "orbit")
            }
            (true, true) => {
                let advice = "sensor_half_angle_deg and sensor_half_angles_deg both give the form of the field of view; leave one out";
                return Err(self.reject(&rectangle, advice));
            }
            given => given,
        };
        let shape = if has_rectangle {
            let given = rectangle.given.map(Spanned::get_ref).map(Vec::as_slice);
            let Some([along, across]) = given else {
                return Err(self.reject(&rectangle, "must be two numbers, [along, across]"));
            };
            if ![along, across]
                .iter()
                .all(|angle| rectangle.rule.contains(angle))
            {
                let advice = format!(
                    "each half angle of the sensor must be from {} degrees",
                    range_text(&rectangle.rule)
                );
                return Err(self.reject(&rectangle, advice));
            }
            cone.note(Err("the field of view is rectangular"));
            rectangle.note(Ok(format!("[{along}, {across}]")));
            FieldShape::Rectangle {
                along_rad: along.to_radians(),
                across_rad: across.to_radians(),
            }
        } else if let Some(degrees) = cone.value().filter(|_| has_cone) {
            let degrees = self.in_range(&cone, degrees, &cone.rule, |_| {
                format!(
                    "the half angle of the sensor's cone must be from {} degrees",
                    range_text(&cone.rule)
                )
            })?;
            cone.note(Ok(number_text(degrees)));
            rectangle.note(Err("the field of view is a cone"));
            FieldShape::Cone {
                half_angle_rad: degrees.to_radians(),
            }
        } else {
            for key in [&off_nadir, &azimuth] {
                if key.is_given() && key.table == "orbit" {
                    let advice = "it turns a field of view; give sensor_half_angle_deg or sensor_half_angles_deg";
                    return Err(self.reject(key, advice));
                }
                key.note(Err("only for a sensor with a field of view"));
            }
            cone.note(Err("all the ground in sight"));
            rectangle.note(Err("all the ground in sight"));
            return Ok(None);
        };
        let off_nadir_deg = self.number(&off_nadir, |_, range| {
            format!("the boresight must be from {range} degrees off nadir")
        })?;
        let azimuth_deg = self.number(&azimuth, |_, range| {
            format!("the azimuth of the boresight must be from {range} degrees")
        })?;
        Ok(Some(FieldOfView {
            shape,
            off_nadir_rad: off_nadir_deg.to_radians(),
            azimuth_rad: azimuth_deg.to_radians(),
        }))
    }
}
