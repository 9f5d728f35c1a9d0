//! `[output] tone`: a named tone curve, or a measured camera response from a file.

use super::earth::EarthTable;
use super::error::{SceneError, printable};
use super::field::{Field, PathKind, RawPath, RawTone, tone_forms, written};
use super::record::quoted;
use super::text::SceneText;
use std::path::{Path, PathBuf};
use terrella_files as files;
use terrella_ground::light::{MAX_RESPONSE_BYTES, Response, Tone};
use toml::Spanned;

/// `[output] tone`
#[derive(Clone, Debug, PartialEq)]
pub enum ToneTable {
    /// A curve without a file.
    Named(Tone),
    /// A measured response.
    Measured {
        /// The file that has it.
        file: PathBuf,
        /// Which of the file; `None` for the only one.
        name: Option<String>,
    },
}

/// Why a measured response cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}: {problem}; tone in [output] takes a file of camera responses as Columbia University publishes them (DoRF)", path.display())]
pub struct ToneError {
    /// The file.
    pub path: PathBuf,
    /// The problem, with the line if known.
    pub problem: String,
}

impl ToneTable {
    /// The curve; a measured one is read from its file.
    ///
    /// # Errors
    /// An unreadable file, or one without such a response.
    pub fn open(&self) -> Result<Tone, ToneError> {
        match self {
            Self::Named(tone) => Ok(*tone),
            Self::Measured { file, name } => {
                let response = read_response(file, name.as_deref());
                let response = response.map_err(|problem| ToneError {
                    path: file.clone(),
                    problem,
                });
                response.map(Tone::Measured)
            }
        }
    }

    /// The file of a measured response.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Named(_) => None,
            Self::Measured { file, .. } => Some(file),
        }
    }
}

fn read_response(path: &Path, name: Option<&str>) -> Result<Response, String> {
    let text = files::read_text(path, MAX_RESPONSE_BYTES).map_err(|error| error.to_string())?;
    let text = text.ok_or_else(|| format!("has more than {} MiB", MAX_RESPONSE_BYTES >> 20))?;
    Response::read(&text, name).map_err(|error| error.to_string())
}

impl SceneText<'_> {
    pub(super) fn tone(
        &self,
        field: &Field<'_, RawTone>,
        usual: Tone,
        earth: &EarthTable,
    ) -> Result<ToneTable, SceneError> {
        let table = match field.given.map(Spanned::get_ref) {
            None => ToneTable::Named(usual),
            Some(RawTone(toml::Value::String(word))) => ToneTable::Named(self.named(field, word)?),
            Some(RawTone(toml::Value::Table(keys))) => self.measured(field, keys, earth)?,
            Some(_) => return Err(self.reject(field, format!("must be {}", tone_forms()))),
        };
        field.note(match &table {
            ToneTable::Named(tone) => quoted(&written(tone)),
            ToneTable::Measured { file, name } => {
                let name = name.as_ref().map(|name| format!(", name = {name:?}"));
                let name = name.unwrap_or_default();
                Ok(format!(
                    "{{ file = {:?}{name} }}",
                    file.display().to_string()
                ))
            }
        });
        Ok(table)
    }

    fn measured(
        &self,
        field: &Field<'_, RawTone>,
        keys: &toml::Table,
        earth: &EarthTable,
    ) -> Result<ToneTable, SceneError> {
        if earth.light.is_none() {
            let advice = "the paper's shading has no measured response; give a curve by name, or take look = \"standard\"";
            return Err(self.reject(field, advice));
        }
        let known = ["file", "name"];
        if let Some(key) = keys.keys().find(|key| !known.contains(&key.as_str())) {
            let advice = format!("a tone has file and name, not {}", printable(key));
            return Err(self.reject(field, advice));
        }
        let text = |key: &str| match keys.get(key) {
            None => Ok(None),
            Some(toml::Value::String(text)) => Ok(Some(text.clone())),
            Some(_) => Err(self.reject(field, format!("{key} must be a string"))),
        };
        let (file, name) = (text("file")?, text("name")?);
        let file = file.ok_or_else(|| self.reject(field, format!("must be {}", tone_forms())))?;
        Ok(ToneTable::Measured {
            file: self.existing(field, &RawPath(file), PathKind::File)?,
            name,
        })
    }
}
