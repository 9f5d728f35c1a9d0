//! Records of a file that cannot be used, kept by name with the reason, for later requests.

use super::OrbitError;
use super::tle_fields::catalogue_number;
use std::collections::HashSet;

/// A record that cannot be used.
#[derive(Debug)]
pub(super) struct Rejected {
    /// Name and number, as far as known.
    names: Vec<String>,
    cause: String,
}

/// Most records whose names are kept.
pub(super) const MAX_REJECTED: usize = 100_000;

/// The first rejected record of each name.
#[derive(Debug, Default)]
pub(super) struct Rejections {
    pub all: Vec<Rejected>,
    names: HashSet<String>,
}

impl Rejections {
    /// Notes a record, unless it has no name or all of its names are known.
    pub fn add(&mut self, names: Vec<String>, cause: &dyn std::fmt::Display) {
        if self.all.len() >= MAX_REJECTED {
            return;
        }
        let mut is_new = false;
        for name in &names {
            is_new |= self.names.insert(name.clone());
        }
        if is_new {
            self.all.push(Rejected::new(names, cause));
        }
    }
}

impl Rejected {
    pub fn new(names: Vec<String>, cause: &dyn std::fmt::Display) -> Self {
        let cause = cause.to_string();
        Self { names, cause }
    }

    fn is_of(&self, wanted: &str) -> bool {
        self.names.iter().any(|name| is_same(name, wanted))
    }

    /// Whether all its names, of which there are some, are these of one satellite.
    pub fn is_only_of(&self, satellite: [&String; 2]) -> bool {
        let is_own = |name: &String| satellite.iter().any(|own| is_same(name, own));
        !self.names.is_empty() && self.names.iter().all(is_own)
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

/// Whether two names or numbers mean the same satellite, letter case aside.
fn is_same(name: &str, wanted: &str) -> bool {
    let number = catalogue_number(wanted);
    name.trim().to_lowercase() == wanted.to_lowercase()
        || number.is_some() && catalogue_number(name.trim()) == number
}
