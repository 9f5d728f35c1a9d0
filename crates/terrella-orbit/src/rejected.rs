//! Records of a file that cannot be used, kept by name with the reason, for later requests.

use super::OrbitError;
use super::tle_fields::catalogue_number;

/// A record that cannot be used.
#[derive(Debug)]
pub(super) struct Rejected {
    /// Name and number, as far as known.
    names: Vec<String>,
    cause: String,
}

impl Rejected {
    pub fn new(names: Vec<String>, cause: &dyn std::fmt::Display) -> Self {
        let cause = cause.to_string();
        Self { names, cause }
    }

    fn is_of(&self, wanted: &str) -> bool {
        let number = catalogue_number(wanted);
        let mut names = self.names.iter().map(|name| name.trim());
        names.any(|name| {
            name.to_lowercase() == wanted.to_lowercase()
                || number.is_some() && catalogue_number(name) == number
        })
    }

    /// Explains a missing name by the reason why its record was rejected.
    pub fn explain(rejected: &[Self], error: OrbitError) -> OrbitError {
        match error {
            OrbitError::UnknownName { wanted, .. }
                if let Some(one) = rejected.iter().find(|one| one.is_of(&wanted)) =>
            {
                let cause = one.cause.clone();
                OrbitError::Unusable { wanted, cause }
            }
            error => error,
        }
    }
}
