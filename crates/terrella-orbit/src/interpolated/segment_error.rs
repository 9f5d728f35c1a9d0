//! Why segments are no ephemeris.

/// Why segments are no ephemeris: which of them, from 0, and how.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SegmentError {
    /// No segment at all.
    #[error("no segment")]
    Empty,
    /// There is nothing between which to interpolate.
    #[error("one state alone, of {at}; an orbit needs two or more, in order of time")]
    Instant {
        /// Its time, UTC.
        at: String,
    },
    /// The usable interval does not overlap the samples.
    #[error("the usable interval, {first} to {last}, is outside its states")]
    Unusable {
        /// Which segment, from 0.
        index: usize,
        /// Its beginning, UTC.
        first: String,
        /// Its end, UTC.
        last: String,
    },
    /// Two segments cover the same time.
    #[error(
        "the segment begins at {begins}, before the one before it ends ({ends}); give each its own USEABLE_START_TIME and USEABLE_STOP_TIME"
    )]
    Overlap {
        /// Which segment, from 0.
        index: usize,
        /// Where it begins, UTC.
        begins: String,
        /// Where the one before it ends, UTC.
        ends: String,
    },
}

impl SegmentError {
    /// Which segment is meant, from 0.
    pub fn index(&self) -> usize {
        match self {
            Self::Empty | Self::Instant { .. } => 0,
            Self::Unusable { index, .. } | Self::Overlap { index, .. } => *index,
        }
    }
}
