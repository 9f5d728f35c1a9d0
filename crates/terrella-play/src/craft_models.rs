//! The models and attitudes of a scene's satellites, each file read once however many satellites have it.

use super::attitude::Attitude;
use super::error::PlayError;
use crate::scene::{AttitudeName, AttitudeSource, Scene};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;
use terrella::frames::Epoch;
use terrella_model::Model;
use terrella_orbit::AttitudeError;

/// The models of a scene, and which satellite has which.
#[derive(Default)]
pub struct CraftModels {
    models: Vec<Arc<Model>>,
    /// Index of the model for each satellite of the scene.
    places: Vec<Option<usize>>,
    /// For each satellite, too.
    attitudes: Vec<Attitude>,
    /// Those of files, each once: checked in each frame, of thousands of satellites.
    files: Vec<Attitude>,
}

impl CraftModels {
    /// Reads all models that a scene names.
    pub fn open(scene: &Scene) -> Result<Self, PlayError> {
        let mut all = Self::default();
        let mut by_file: HashMap<(PathBuf, Vec<&str>), usize> = HashMap::new();
        let mut read: HashMap<&AttitudeSource, Attitude> = HashMap::new();
        for orbit in &scene.orbits {
            let source = &orbit.craft.attitude;
            let attitude = match read.get(source) {
                Some(attitude) => attitude.clone(),
                None => {
                    let attitude = Attitude::open(source)?;
                    if matches!(attitude, Attitude::File(_)) {
                        all.files.push(attitude.clone());
                    }
                    read.insert(source, attitude.clone());
                    attitude
                }
            };
            let attitude = match (attitude, orbit.craft.spin) {
                (Attitude::Rule(rule), Some(spin)) => {
                    Attitude::Spinning(rule, spin, scene.time.start)
                }
                (attitude, _) => attitude,
            };
            all.attitudes.push(attitude);
            let Some(wanted) = &orbit.craft.model else {
                all.places.push(None);
                continue;
            };
            let turned = wanted.articulations.iter();
            let turned: Vec<_> = turned.map(|one| one.node.as_str()).collect();
            let wanted = (wanted.file.clone(), turned);
            let place = match by_file.get(&wanted) {
                Some(place) => *place,
                None => {
                    let model = Model::load_jointed(&wanted.0, &wanted.1)?;
                    if !model.ignored.is_empty() {
                        let names: Vec<_> = model.ignored.iter().map(String::as_str).collect();
                        let names = names.join(", ");
                        tracing::warn!("{}: not drawn: {names}", wanted.0.display());
                    }
                    all.models.push(Arc::new(model));
                    by_file.insert(wanted, all.models.len() - 1);
                    all.models.len() - 1
                }
            };
            all.places.push(Some(place));
        }
        Ok(all)
    }

    /// How a satellite is turned.
    pub fn attitude(&self, satellite: usize) -> Attitude {
        let attitude = self.attitudes.get(satellite).cloned();
        attitude.unwrap_or(Attitude::Rule(AttitudeName::default()))
    }

    /// Checks that all attitudes are known from one epoch to another.
    ///
    /// # Errors
    /// The first epoch at which one is unknown, and the time span of its file.
    pub fn check_span(&self, first: Epoch, last: Epoch) -> Result<(), AttitudeError> {
        let mut files = self.files.iter();
        files.try_for_each(|file| file.check_span(first, last))
    }

    /// All models.
    pub fn models(&self) -> &[Arc<Model>] {
        &self.models
    }

    /// The place among them of a satellite's model, if it has one.
    pub fn of_satellite(&self, satellite: usize) -> Option<usize> {
        self.places.get(satellite).copied().flatten()
    }
}

/// The files that attitudes come from, in the scene's order.
pub fn attitude_files(scene: &Scene) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = Vec::new();
    for orbit in &scene.orbits {
        if let AttitudeSource::File(file) = &orbit.craft.attitude
            && !files.contains(file)
        {
            files.push(file.clone());
        }
    }
    files
}

/// The files that models come from, in the scene's order.
pub fn model_files(scene: &Scene) -> Vec<PathBuf> {
    let models = scene
        .orbits
        .iter()
        .filter_map(|orbit| orbit.craft.model.as_ref());
    let mut files: Vec<PathBuf> = Vec::new();
    for model in models {
        if !files.contains(&model.file) {
            files.extend(terrella_model::model_files(&model.file));
        }
    }
    files
}
