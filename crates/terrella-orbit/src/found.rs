//! Results of the readers of ephemerides.

use super::entry::RecordError;
use super::interpolated::EphemerisFeed;

/// One find.
pub(super) enum Found {
    /// An object that can be flown.
    Object(EphemerisFeed),
    /// An object that is where another one is, such as a satellite's sensor.
    Follower(EphemerisFeed),
    /// An object that cannot, by its names as far as they are known, and why.
    Corrupt(Vec<String>, RecordError),
    /// A state or an error estimate that its object is flown without, and why.
    BadState(RecordError),
    /// A state that cannot be used, of an object of this name, which may have no other.
    BadStateOf(String, RecordError),
}

impl Found {
    /// An object of these names, or why it cannot be flown.
    pub fn of(names: Vec<String>, object: Result<EphemerisFeed, RecordError>) -> Self {
        match object {
            Ok(feed) => Self::Object(feed),
            Err(error) => Self::Corrupt(names, error),
        }
    }

    /// A fault of something without a name.
    pub fn corrupt(error: RecordError) -> Self {
        Self::Corrupt(Vec::new(), error)
    }
}

/// Callback for each result; its error ends the reading.
pub(super) type Each<'e> = dyn FnMut(Found) -> Result<(), RecordError> + 'e;
