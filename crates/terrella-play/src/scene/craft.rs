//! Keys of `[orbit]` about the spacecraft itself: its model and its attitude.

use super::error::SceneError;
use super::field::PathKind;
use super::orbit_keys::RawOrbit;
use super::text::SceneText;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Why keys of a model have no value.
const NO_MODEL: &str = "only for a model";

/// What is drawn of a spacecraft.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CraftOptions {
    /// Its model; `None` draws the built-in one before the chase camera, and nothing before others.
    pub model: Option<CraftModel>,
    /// How it is turned.
    pub attitude: AttitudeSource,
}

/// What says how a spacecraft is turned.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum AttitudeSource {
    /// A rule.
    Rule(AttitudeName),
    /// A file, absolute or relative to the working directory.
    File(PathBuf),
}

impl Default for AttitudeSource {
    fn default() -> Self {
        Self::Rule(AttitudeName::default())
    }
}

/// Rules of attitude. The axes are x along flight, y to the right and z down where the craft flies level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum AttitudeName {
    /// Level: z along the ellipsoid's vertical, x along flight.
    #[default]
    Nadir,
    /// −z to the Sun, x as near to the direction of flight as it can be.
    Sun,
    /// The axes of GCRF.
    Inertial,
}

/// A model and how it is drawn.
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
}

/// How the axes of a model lie in those of its craft: x along flight, y to the right, z down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ModelAxes {
    /// As glTF has them: +Z forward, +Y up, −X to the right.
    #[default]
    Gltf,
    /// They are the same.
    Body,
}

impl SceneText<'_> {
    /// Checks what is drawn of a spacecraft.
    pub(super) fn craft(&self, orbit: &RawOrbit) -> Result<CraftOptions, SceneError> {
        let attitude = self.attitude(orbit)?;
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
            return Ok(CraftOptions {
                model: None,
                attitude,
            });
        };
        Ok(CraftOptions {
            model: Some(CraftModel {
                file,
                scale: self.quantity(&scale)?,
                least_length_px: self.quantity(&length)?,
                axes: self.choice(&axes)?,
            }),
            attitude,
        })
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
    use crate::scene::Scene;
    use std::path::Path;

    fn craft(keys: &str) -> Result<CraftOptions, String> {
        // Any file of the folder will do: a scene does not read it.
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
        let file = craft("attitude_file = \"Cargo.toml\"").expect("good");
        assert!(
            matches!(file.attitude, AttitudeSource::File(path) if path.ends_with("Cargo.toml"))
        );
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
}
