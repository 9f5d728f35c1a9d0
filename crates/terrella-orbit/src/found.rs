//! Results of the readers of ephemerides.

use super::entry::RecordError;
use super::interpolated::EphemerisFeed;

/// One find.
pub(super) enum Found {
    /// An object that can be flown.
    Object(EphemerisFeed),
    /// An object that is where another one is, such as a satellite's sensor.
    Follower(EphemerisFeed),
    /// An object that cannot, and why.
    Corrupt(RecordError),
    /// A state or an error estimate that its object is flown without, and why.
    BadState(RecordError),
}

impl From<Result<EphemerisFeed, RecordError>> for Found {
    fn from(object: Result<EphemerisFeed, RecordError>) -> Self {
        match object {
            Ok(feed) => Self::Object(feed),
            Err(error) => Self::Corrupt(error),
        }
    }
}

/// Callback for each result; its error ends the reading.
pub(super) type Each<'e> = dyn FnMut(Found) -> Result<(), RecordError> + 'e;
