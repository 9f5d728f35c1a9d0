//! Colour spaces of a scene's map files: other spaces than sRGB are reported, not converted.

use super::sky_parts::map_files;
use crate::scene::{DatedLayer, Scene};
use std::path::PathBuf;
use terrella_imagery::{colour_note, day_file, find_textures};

/// Differences from sRGB of the files that a scene draws, according to their headers.
pub(super) fn colour_notes(scene: &Scene) -> Vec<String> {
    let earth = &scene.earth;
    let days = earth.dated_maps.iter();
    let days = days.filter(|maps| maps.layer == DatedLayer::Day);
    let mut files: Vec<PathBuf> = days.flat_map(|maps| maps.files.clone()).collect();
    let shipped = || find_textures().ok();
    if earth.pack.is_none()
        && files.is_empty()
        && let Some(folder) = earth.textures.clone().or_else(shipped)
    {
        files.extend(day_file(&folder));
    }
    if let Some(folder) = scene.sky.folder.clone().or_else(shipped) {
        files.extend(map_files(scene, &folder));
    }
    let notes = files.iter().filter_map(|file| {
        let note = colour_note(file)?;
        Some(format!("{} {note}", file.display()))
    });
    notes.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_colours_of_a_day_map_are_reported() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |gamma: Option<f32>| {
            let path = folder.path().join("day.png");
            let file = std::fs::File::create(&path).expect("made");
            let mut encoder = png::Encoder::new(file, 4, 2);
            encoder.set_color(png::ColorType::Grayscale);
            if let Some(gamma) = gamma {
                encoder.set_source_gamma(png::ScaledFloat::new(gamma));
            }
            let mut writer = encoder.write_header().expect("written");
            writer.write_image_data(&[9; 8]).expect("written");
        };
        let notes = || {
            let text = "[earth]\ntextures = \".\"\n[sky]\nstars = false\n";
            let scene = Scene::from_toml(text, &folder.path().join("scene.toml"));
            colour_notes(&scene.expect("a good scene"))
        };
        write(None);
        assert_eq!(notes(), [""; 0]);
        write(Some(1.0));
        let notes = notes();
        assert_eq!(notes.len(), 1, "{notes:?}");
        assert!(
            notes[0].contains("day.png") && notes[0].contains("gamma of 1.000"),
            "{notes:?}"
        );
    }
}
