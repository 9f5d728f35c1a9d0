//! The models of a scene's satellites, read once however many satellites have the same.

use super::error::PlayError;
use crate::scene::Scene;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;
use terrella_model::Model;

/// The models of a scene, and which satellite has which.
#[derive(Default)]
pub struct CraftModels {
    models: Vec<Arc<Model>>,
    /// For each satellite of the scene.
    places: Vec<Option<usize>>,
}

impl CraftModels {
    /// Reads all models that a scene names.
    pub fn open(scene: &Scene) -> Result<Self, PlayError> {
        let mut all = Self::default();
        let mut by_file: HashMap<PathBuf, usize> = HashMap::new();
        for orbit in &scene.orbits {
            let Some(wanted) = &orbit.craft.model else {
                all.places.push(None);
                continue;
            };
            let place = match by_file.get(&wanted.file) {
                Some(place) => *place,
                None => {
                    let model = Model::load(&wanted.file)?;
                    if !model.ignored.is_empty() {
                        let names: Vec<_> = model.ignored.iter().map(String::as_str).collect();
                        let names = names.join(", ");
                        tracing::warn!("{}: not drawn: {names}", wanted.file.display());
                    }
                    all.models.push(Arc::new(model));
                    by_file.insert(wanted.file.clone(), all.models.len() - 1);
                    all.models.len() - 1
                }
            };
            all.places.push(Some(place));
        }
        Ok(all)
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
