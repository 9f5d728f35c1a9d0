//! Keys of `[orbit]` about the spacecraft itself: its model and its attitude.

use super::articulations::Articulation;
use super::error::SceneError;
use super::field::PathKind;
use super::orbit_keys::RawOrbit;
use super::record::number_text;
use super::text::SceneText;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Why spin keys have no value.
const NO_SPIN: &str = "the spacecraft does not spin";
/// Default spin axis.
const SPIN_AXIS: DVec3 = DVec3::Z;
/// Why model keys have no value.
const NO_MODEL: &str = "only for a model";

/// Appearance of a spacecraft.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CraftOptions {
    /// Its model; `None` draws the built-in one before the chase camera, and nothing before others.
    pub model: Option<CraftModel>,
    /// How it is turned.
    pub attitude: AttitudeSource,
    /// How it spins besides.
    pub spin: Option<Spin>,
}

/// A spin added to an attitude, from the scene's start on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spin {
    /// In the axes of the spacecraft, of any length but 0.
    pub axis: DVec3,
    /// Counter-clockwise about it, degrees a second.
    pub rate_deg_s: f64,
}

/// Source of a spacecraft's attitude.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum AttitudeSource {
    /// An attitude rule.
    Rule(AttitudeName),
    /// A file, absolute or relative to the working directory.
    File(PathBuf),
}

impl Default for AttitudeSource {
    fn default() -> Self {
        Self::Rule(AttitudeName::default())
    }
}

/// Attitude rules. In level flight the axes are x along flight, y to the right and z down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum AttitudeName {
    /// Level: z along the ellipsoid's vertical, x along flight.
    #[default]
    Nadir,
    /// −z to the Sun, x as close to the flight direction as possible.
    Sun,
    /// The axes of GCRF.
    Inertial,
}

/// A model and its drawing options.
#[derive(Clone, Debug, PartialEq)]
pub struct CraftModel {
    /// A glTF file, absolute or relative to the working directory.
    pub file: PathBuf,
    /// Factor on all its lengths.
    pub scale: f64,
    /// Least length on screen, pixels; 0 keeps the true scale.
    pub least_length_px: f64,
    /// How its axes lie in those of the craft.
    pub axes: ModelAxes,
    /// Nodes of the model that turn.
    pub articulations: Vec<Articulation>,
}

/// Orientation of a model's axes in those of its craft: x along flight, y to the right, z down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ModelAxes {
    /// glTF axes: +Z forward, +Y up, −X to the right.
    #[default]
    Gltf,
    /// The axes of the craft.
    Body,
}

impl SceneText<'_> {
    /// Checks the appearance of a spacecraft.
    pub(super) fn craft(&self, orbit: &RawOrbit) -> Result<CraftOptions, SceneError> {
        let attitude = self.attitude(orbit)?;
        let spin = self.spin(orbit, &attitude)?;
        let turned = orbit.articulations();
        let without = "no model: the built-in spacecraft before the chase camera";
        let file = self.path(&orbit.model(), PathKind::File, without)?;
        let (scale, length, axes) = (
            orbit.model_scale(),
            orbit.model_length_px(),
            orbit.model_axes(),
        );
        let Some(file) = file else {
            let advice =
                |key: &str| format!("{key} is for a model; add model = \"…\", or leave it out");
            self.idle(&scale, NO_MODEL, advice("model_scale"))?;
            self.idle(&length, NO_MODEL, advice("model_length_px"))?;
            self.idle(&axes, NO_MODEL, advice("model_axes"))?;
            self.idle(&turned, NO_MODEL, advice("articulations"))?;
            return Ok(CraftOptions {
                model: None,
                attitude,
                spin,
            });
        };
        Ok(CraftOptions {
            model: Some(CraftModel {
                file,
                scale: self.quantity(&scale)?,
                least_length_px: self.quantity(&length)?,
                axes: self.choice(&axes)?,
                articulations: self.articulations(&turned)?,
            }),
            attitude,
            spin,
        })
    }

    fn spin(
        &self,
        orbit: &RawOrbit,
        attitude: &AttitudeSource,
    ) -> Result<Option<Spin>, SceneError> {
        let (rate, axis) = (orbit.spin_rate_deg_s(), orbit.spin_axis());
        if let AttitudeSource::File(_) = attitude {
            let advice = "a spin is on top of attitude, and attitude_file says all; leave it out";
            self.idle(&rate, "attitude_file says it", advice)?;
            self.idle(&axis, "attitude_file says it", advice)?;
            return Ok(None);
        }
        if !rate.is_given() {
            rate.note(Err(NO_SPIN));
            let advice = "is the axis of a spin; add spin_rate_deg_s = …, or leave it out";
            self.idle(&axis, NO_SPIN, advice)?;
            return Ok(None);
        }
        let rate_deg_s = self.quantity_or(&rate, 0.0)?;
        let given = axis.given.map(|given| given.get_ref().as_slice());
        let found = match given {
            None => Some(SPIN_AXIS),
            Some(&[x, y, z]) => Some(DVec3::new(x, y, z)),
            Some(_) => None,
        };
        let is_axis = |one: &DVec3| {
            one.to_array().iter().all(|part| axis.rule.contains(part)) && one.length() > 1e-9
        };
        let Some(found) = found.filter(is_axis) else {
            let advice = "must be three numbers, [x, y, z], not all of them 0";
            return Err(self.reject(&axis, advice));
        };
        let numbers = found.to_array().map(number_text).join(", ");
        axis.note(Ok(format!("[{numbers}]")));
        Ok(Some(Spin {
            axis: found,
            rate_deg_s,
        }))
    }

    fn attitude(&self, orbit: &RawOrbit) -> Result<AttitudeSource, SceneError> {
        let rule = orbit.attitude();
        let file = self.path(&orbit.attitude_file(), PathKind::File, "attitude is a rule")?;
        match file {
            None => Ok(AttitudeSource::Rule(self.choice(&rule)?)),
            Some(file) => {
                let advice = "attitude has no meaning with attitude_file; leave one of them out";
                self.idle(&rule, "attitude_file says it", advice)?;
                Ok(AttitudeSource::File(file))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ArticulationTarget, ArticulationTurn, Scene};
    use std::path::Path;

    fn craft(keys: &str) -> Result<CraftOptions, String> {
        // Any file of the folder will do: a scene does not open it.
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("a.toml");
        let text = format!("[orbit]\n{keys}");
        let scene = Scene::from_toml(&text, &scene).map_err(|error| error.to_string())?;
        Ok(scene.orbits[0].craft.clone())
    }

    #[test]
    fn a_model_and_an_attitude_are_as_the_keys_say() {
        assert_eq!(craft(""), Ok(CraftOptions::default()));
        let given = craft(
            "model = \"Cargo.toml\"\nmodel_scale = 0.5\nmodel_length_px = 24\nmodel_axes = \"body\"\nattitude = \"sun\"",
        );
        let given = given.expect("good");
        assert_eq!(given.attitude, AttitudeSource::Rule(AttitudeName::Sun));
        let model = given.model.expect("a model");
        assert!(model.file.ends_with("Cargo.toml"));
        assert_eq!((model.scale, model.least_length_px), (0.5, 24.0));
        assert_eq!(model.axes, ModelAxes::Body);
        assert!(model.articulations.is_empty() && given.spin.is_none());
        let file = craft("attitude_file = \"Cargo.toml\"").expect("good");
        assert!(
            matches!(file.attitude, AttitudeSource::File(path) if path.ends_with("Cargo.toml"))
        );
    }

    #[test]
    fn parts_and_the_whole_turn_as_the_keys_say() {
        let given = craft(
            "model = \"Cargo.toml\"\nspin_rate_deg_s = -6\nspin_axis = [0, 1, 1]\narticulations = [\
             { node = \"Wheel\", axis = [1, 0, 0], rate_deg_s = 360 }, { node = \"Boom\", axis = [0, 0, 2], angle_deg = -45 }, \
             { node = \"Wing\", axis = [0, 1, 0], track = \"sun\" }, { node = \"Dish\", axis = [0, 1, 0], track = \"earth\", normal = [1, 0, 0] }]",
        );
        let given = given.expect("good");
        let spin = Spin {
            axis: DVec3::new(0.0, 1.0, 1.0),
            rate_deg_s: -6.0,
        };
        assert_eq!(given.spin, Some(spin));
        let turned = given.model.expect("a model").articulations;
        let turns: Vec<_> = turned
            .iter()
            .map(|one| (one.node.as_str(), one.turn))
            .collect();
        let even = |angle_deg, rate_deg_s| ArticulationTurn::Even {
            angle_deg,
            rate_deg_s,
        };
        let track = |target, normal| ArticulationTurn::Track { target, normal };
        assert_eq!(
            turns,
            [
                ("Wheel", even(0.0, 360.0)),
                ("Boom", even(-45.0, 0.0)),
                ("Wing", track(ArticulationTarget::Sun, DVec3::Z)),
                ("Dish", track(ArticulationTarget::Earth, DVec3::X)),
            ]
        );
        let spin = craft("spin_rate_deg_s = 30")
            .expect("good")
            .spin
            .expect("a spin");
        assert_eq!(spin.axis, DVec3::Z);
    }

    #[test]
    fn keys_without_a_meaning_are_rejected() {
        for (keys, said) in [
            ("model = \"none.glb\"", "none.glb cannot be opened"),
            ("model_scale = 2", "model_scale is for a model"),
            ("model_length_px = 2", "model_length_px is for a model"),
            ("model_axes = \"gltf\"", "model_axes is for a model"),
            ("model = \"Cargo.toml\"\nmodel_scale = 0", "model_scale"),
            (
                "model = \"Cargo.toml\"\nmodel_length_px = 1e9",
                "model_length_px",
            ),
            ("attitude = \"spin\"", "attitude"),
            ("articulations = []", "articulations is for a model"),
            ("spin_axis = [0, 0, 1]", "add spin_rate_deg_s"),
            ("spin_rate_deg_s = 1e9", "spin_rate_deg_s"),
            (
                "spin_rate_deg_s = 1\nspin_axis = [0, 0, 0]",
                "not all of them 0",
            ),
            (
                "spin_rate_deg_s = 1\nspin_axis = [0, nan, 1]",
                "three numbers",
            ),
            (
                "spin_rate_deg_s = 1\nattitude_file = \"Cargo.toml\"",
                "attitude_file says all",
            ),
            (
                "attitude = \"sun\"\nattitude_file = \"Cargo.toml\"",
                "leave one of them out",
            ),
        ] {
            let error = craft(keys).expect_err(keys);
            assert!(
                error.contains("a.toml:") && error.contains(said),
                "{keys}: {error}"
            );
        }
    }

    #[test]
    fn articulations_that_cannot_be_are_rejected() {
        for (one, said) in [
            (
                "{ axis = [0, 1, 0], angle_deg = 1 }",
                "articulation 1: needs node",
            ),
            (
                "{ node = \"\", axis = [0, 1, 0], angle_deg = 1 }",
                "the name of a node",
            ),
            ("{ node = \"A\", angle_deg = 1 }", "needs axis"),
            (
                "{ node = \"A\", axis = [0, 0, 0], angle_deg = 1 }",
                "not all of them 0",
            ),
            (
                "{ node = \"A\", axis = [0, inf, 0], angle_deg = 1 }",
                "three numbers",
            ),
            (
                "{ node = \"A\", axis = [0, 1, 0] }",
                "needs angle_deg, rate_deg_s or track",
            ),
            (
                "{ node = \"A\", axis = [0, 1, 0], angle_deg = 361 }",
                "from −360 to 360",
            ),
            (
                "{ node = \"A\", axis = [0, 1, 0], track = \"mars\" }",
                "\"sun\" or \"earth\"",
            ),
            (
                "{ node = \"A\", axis = [0, 1, 0], track = \"sun\", rate_deg_s = 1 }",
                "leave angle_deg and rate_deg_s out",
            ),
            (
                "{ node = \"A\", axis = [0, 1, 0], track = \"sun\", normal = [0, -2, 0] }",
                "normal lies along axis",
            ),
            (
                "{ node = \"A\", axis = [0, 1, 0], angle_deg = 1, speed = 2 }",
                "not speed",
            ),
            ("7", "must be a table"),
            (
                "{ node = \"A\", axis = [0, 1, 0], angle_deg = 1 }, { node = \"A\", axis = [1, 0, 0], angle_deg = 1 }",
                "articulation 2: turns the node \"A\" a second time",
            ),
        ] {
            let keys = format!("model = \"Cargo.toml\"\narticulations = [{one}]");
            let error = craft(&keys).expect_err(one);
            assert!(
                error.contains("a.toml:3") && error.contains(said),
                "{one}: {error}"
            );
        }
        let many: String = (0..65)
            .map(|at| format!("{{ node = \"{at}\", axis = [0, 1, 0], angle_deg = 1 }}, "))
            .collect();
        let keys = format!("model = \"Cargo.toml\"\narticulations = [{many}]");
        assert!(craft(&keys).expect_err("many").contains("at most 64"));
    }
}
