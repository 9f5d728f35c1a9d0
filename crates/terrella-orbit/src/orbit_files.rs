//! Files from which several satellites are taken: each is read once.

use super::{Catalogue, Ephemerides, OrbitError, ParameterMessages};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Cache of parsed orbit files, from which satellites are selected.
///
/// A file is read again if another strictness is requested. Changes on disk are not detected.
#[derive(Debug, Default)]
pub struct OrbitFiles {
    catalogues: HashMap<(PathBuf, bool), Arc<Catalogue>>,
    ephemerides: HashMap<(PathBuf, bool), Arc<Ephemerides>>,
    parameters: HashMap<(PathBuf, bool), Arc<ParameterMessages>>,
}

/// A file that has been read.
#[derive(Clone, Debug)]
pub struct OrbitFile<T> {
    /// Its content.
    pub content: Arc<T>,
    /// Whether it has just been read, so that its faults have not been reported.
    pub is_new: bool,
}

impl OrbitFiles {
    /// A file of elements, as [`Catalogue::from_file`] reads it.
    ///
    /// # Errors
    /// As [`Catalogue::from_file`]; a file with an error is read again the next time.
    pub fn catalogue(
        &mut self,
        path: &Path,
        is_strict: bool,
    ) -> Result<OrbitFile<Catalogue>, OrbitError> {
        taken(&mut self.catalogues, path, is_strict, Catalogue::from_file)
    }

    /// A file of states, as [`Ephemerides::from_file`] reads it.
    ///
    /// # Errors
    /// As [`Ephemerides::from_file`]; a file with an error is read again the next time.
    pub fn ephemerides(
        &mut self,
        path: &Path,
        is_strict: bool,
    ) -> Result<OrbitFile<Ephemerides>, OrbitError> {
        taken(
            &mut self.ephemerides,
            path,
            is_strict,
            Ephemerides::from_file,
        )
    }

    /// A file of orbit parameter messages, as [`ParameterMessages::from_file`] reads it.
    ///
    /// # Errors
    /// As [`ParameterMessages::from_file`]; a file with an error is read again the next time.
    pub fn parameters(
        &mut self,
        path: &Path,
        is_strict: bool,
    ) -> Result<OrbitFile<ParameterMessages>, OrbitError> {
        taken(
            &mut self.parameters,
            path,
            is_strict,
            ParameterMessages::from_file,
        )
    }
}

fn taken<T>(
    files: &mut HashMap<(PathBuf, bool), Arc<T>>,
    path: &Path,
    is_strict: bool,
    read: fn(&Path, bool) -> Result<T, OrbitError>,
) -> Result<OrbitFile<T>, OrbitError> {
    let key = (path.to_owned(), is_strict);
    if let Some(known) = files.get(&key) {
        return Ok(OrbitFile {
            content: Arc::clone(known),
            is_new: false,
        });
    }
    let content = Arc::new(read(path, is_strict)?);
    files.insert(key, Arc::clone(&content));
    Ok(OrbitFile {
        content,
        is_new: true,
    })
}
