//! WGSL with imports and features: a feature that is off is not in the text that the driver sees.
//!
//! Three directives, each alone on its line:
//! - `#import common/NAME.wgsl` puts that file here, once per shader;
//! - `#if FEATURE` … `#else` … `#endif` keeps one of two parts; they nest.
//!
//! Nothing else: no expressions, no macros. The folder `shaders/` is embedded in the library. Set
//! `TERRELLA_SHADER_DUMP` to a folder to have every shader written there as the driver gets it.

use std::collections::BTreeSet;

/// The surface's shader file.
pub const EARTH_SHADER: &str = "earth.wgsl";
/// The air's shader file.
pub const AIR_SHADER: &str = "air.wgsl";
/// The shader file of satellites' tracks.
pub const TRACKS_SHADER: &str = "tracks.wgsl";

/// The projected grid's vertices: a part of the surface's shader.
pub const PROJECTED_GRID_SHADER: &str = "common/projected_grid.wgsl";

const FILES: &[(&str, &str)] = &[
    (EARTH_SHADER, include_str!("../../shaders/earth.wgsl")),
    (
        PROJECTED_GRID_SHADER,
        include_str!("../../shaders/common/projected_grid.wgsl"),
    ),
    (
        "common/contours.wgsl",
        include_str!("../../shaders/common/contours.wgsl"),
    ),
    (AIR_SHADER, include_str!("../../shaders/air.wgsl")),
    (TRACKS_SHADER, include_str!("../../shaders/tracks.wgsl")),
    (
        "common/air.wgsl",
        include_str!("../../shaders/common/air.wgsl"),
    ),
    (
        "common/color.wgsl",
        include_str!("../../shaders/common/color.wgsl"),
    ),
    (
        "common/frame.wgsl",
        include_str!("../../shaders/common/frame.wgsl"),
    ),
];

/// Features that a shader may ask for.
const FEATURES: &[&str] = &[
    "paper",
    "clouds",
    "normals",
    "night_lights",
    "water",
    "tiles",
    "air",
    "encode",
    "decode",
    "inside",
    "depth",
    "standard_z",
    "places",
    "marks",
    "fill",
    "relief",
    "grid",
    "crossing",
    "cast",
];

/// What is wrong with a shader file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("shaders/{file}:{line}: {what}")]
pub struct ShaderError {
    /// The file, below `shaders/`.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// What is wrong.
    pub what: String,
}

/// One shader file with a set of features.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ShaderVariant {
    /// The file, below `shaders/`.
    pub file: &'static str,
    /// Features that are on, in order.
    pub features: Vec<&'static str>,
}

impl ShaderVariant {
    /// The variant with those features whose flag is set.
    pub fn new(file: &'static str, features: &[(&'static str, bool)]) -> Self {
        let features: BTreeSet<_> = features
            .iter()
            .filter(|(_, on)| *on)
            .map(|(name, _)| *name)
            .collect();
        Self {
            file,
            features: features.into_iter().collect(),
        }
    }

    /// A name for labels and dumps: `earth+clouds+normals`.
    pub fn name(&self) -> String {
        let stem = self.file.trim_end_matches(".wgsl");
        std::iter::once(stem)
            .chain(self.features.iter().copied())
            .collect::<Vec<_>>()
            .join("+")
    }

    /// The WGSL text that the driver gets.
    pub fn source(&self) -> Result<String, ShaderError> {
        let mut out = String::new();
        let on = self.features.iter().copied().collect();
        include(self.file, &on, &mut BTreeSet::new(), &mut out)?;
        Ok(out)
    }

    /// Compiles it. Answers the length of its text too, bytes.
    pub(super) fn module(
        &self,
        device: &wgpu::Device,
    ) -> Result<(wgpu::ShaderModule, u64), ShaderError> {
        let source = self.source()?;
        if let Some(folder) = std::env::var_os("TERRELLA_SHADER_DUMP") {
            let path = std::path::Path::new(&folder).join(self.name() + ".wgsl");
            if let Err(error) = std::fs::write(&path, &source) {
                tracing::warn!("shader not dumped to {}: {error}", path.display());
            }
        }
        let bytes = source.len() as u64;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(&format!("terrella {}", self.name())),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        Ok((module, bytes))
    }
}

fn include(
    file: &str,
    on: &BTreeSet<&str>,
    seen: &mut BTreeSet<String>,
    out: &mut String,
) -> Result<(), ShaderError> {
    let error = |line: usize, what: String| ShaderError {
        file: file.to_owned(),
        line,
        what,
    };
    let Some((_, text)) = FILES.iter().find(|(name, _)| *name == file) else {
        return Err(error(0, "no such shader file".into()));
    };
    // One entry per open `#if`: is this part kept, was `#else` seen, and the line it began on.
    let mut open: Vec<(bool, bool, usize)> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let number = index + 1;
        let kept = open.iter().all(|(kept, ..)| *kept);
        let mut words = line.split_whitespace();
        match (words.next(), words.next()) {
            (Some("#if"), Some(feature)) => {
                if !FEATURES.contains(&feature) {
                    return Err(error(number, format!("unknown feature {feature}")));
                }
                open.push((on.contains(feature), false, number));
            }
            (Some("#else"), None) => match open.last_mut() {
                Some((kept, seen_else @ false, _)) => (*kept, *seen_else) = (!*kept, true),
                _ => return Err(error(number, "#else without #if".into())),
            },
            (Some("#endif"), None) => {
                open.pop()
                    .ok_or_else(|| error(number, "#endif without #if".into()))?;
            }
            (Some("#import"), Some(path)) if kept && seen.insert(path.to_owned()) => {
                include(path, on, seen, out).map_err(|inner| match inner.line {
                    0 => error(number, format!("{}: {}", inner.file, inner.what)),
                    _ => inner,
                })?;
            }
            (Some("#import"), Some(_)) => {}
            (Some(word), _) if word.starts_with('#') => {
                return Err(error(number, format!("unknown directive {word}")));
            }
            _ if kept => {
                out.push_str(line);
                out.push('\n');
            }
            _ => {}
        }
    }
    match open.last() {
        Some((_, _, line)) => Err(error(*line, "#if without #endif".into())),
        None => Ok(()),
    }
}
