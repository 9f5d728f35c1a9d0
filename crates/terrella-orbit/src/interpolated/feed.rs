//! A feed of an object's ephemeris, segment by segment.

use super::InterpolatedStates;
use super::segment_error::SegmentError;
use crate::{Feed, OrbitError, OrbitState};
use std::sync::Arc;
use terrella_frames::{Epoch, rfc3339};

/// Samples that belong together: nothing is interpolated across segments, for between two of them an engine may have fired.
#[derive(Clone, Debug)]
pub struct EphemerisSegment {
    /// The samples.
    pub samples: Arc<InterpolatedStates>,
    /// First and last instant that may be used, within the samples' reach.
    pub usable: (Epoch, Epoch),
    /// One standard deviation of the position at instants in rising order, metres: √(σx² + σy² + σz²). May be empty.
    pub sigma_m: Vec<(Epoch, f64)>,
}

impl EphemerisSegment {
    /// All of the samples, without error estimates.
    pub fn whole(samples: InterpolatedStates) -> Self {
        let usable = samples.span();
        Self {
            samples: Arc::new(samples),
            usable,
            sigma_m: Vec::new(),
        }
    }

    /// Whether it has a state at `epoch`.
    fn covers(&self, epoch: Epoch) -> bool {
        self.usable.0 <= epoch && epoch <= self.usable.1
    }

    /// Between two estimates linear in time, before the first and after the last theirs.
    fn error_m(&self, epoch: Epoch) -> Option<f64> {
        let behind = self.sigma_m.partition_point(|(at, _)| *at <= epoch);
        let before = behind.checked_sub(1).and_then(|i| self.sigma_m.get(i));
        match (before, self.sigma_m.get(behind)) {
            (Some((t0, a)), Some((t1, b))) => {
                let share = (epoch - *t0).to_seconds() / (*t1 - *t0).to_seconds();
                Some(a + share * (b - a))
            }
            (Some((_, sigma)), None) | (None, Some((_, sigma))) => Some(*sigma),
            (None, None) => None,
        }
    }
}

/// An object's ephemeris: what OEM, CZML and CSV files are read into.
#[derive(Clone, Debug)]
pub struct EphemerisFeed {
    name: String,
    object_id: Option<String>,
    /// Its identifier in the file, besides its name.
    id: Option<String>,
    /// In order of time, not empty, overlapping at most in a single time.
    segments: Vec<EphemerisSegment>,
    /// Where it begins in its file, from 1.
    line: usize,
}

impl EphemerisFeed {
    /// Creates a feed from segments in order of time that do not overlap; where two meet, the later one applies. Usable intervals are clipped to
    /// the range of the samples.
    ///
    /// # Errors
    /// Names the segment that is not usable or overlaps.
    pub fn new(
        name: String,
        object_id: Option<String>,
        mut segments: Vec<EphemerisSegment>,
    ) -> Result<Self, SegmentError> {
        let mut ended: Option<Epoch> = None;
        for (index, segment) in segments.iter_mut().enumerate() {
            let (first, last) = segment.samples.reach();
            let cut = (segment.usable.0.max(first), segment.usable.1.min(last));
            if cut.0 > cut.1 {
                return Err(SegmentError::Unusable {
                    index,
                    first: rfc3339(segment.usable.0),
                    last: rfc3339(segment.usable.1),
                });
            }
            segment.usable = cut;
            if let Some(ended) = ended.filter(|ended| *ended > cut.0) {
                return Err(SegmentError::Overlap {
                    index,
                    begins: rfc3339(cut.0),
                    ends: rfc3339(ended),
                });
            }
            ended = Some(cut.1);
        }
        match (segments.first(), segments.last()) {
            (Some(first), Some(last)) if first.usable.0 < last.usable.1 => Ok(Self {
                name,
                object_id,
                id: None,
                segments,
                line: 1,
            }),
            (Some(only), _) => Err(SegmentError::Instant {
                at: rfc3339(only.usable.0),
            }),
            _ => Err(SegmentError::Empty),
        }
    }

    /// With the segments of another feed of the object, in order of time; `None` if they overlap.
    pub(crate) fn joined(&self, other: &Self) -> Option<Self> {
        let mut segments = [self.segments.as_slice(), &other.segments].concat();
        segments.sort_by_key(|segment| segment.usable.0);
        let joined = Self::new(self.name.clone(), self.object_id.clone(), segments).ok()?;
        Some(joined.at_line(self.line))
    }

    /// The international designator, `1998-067A`, where the file has one.
    pub fn object_id(&self) -> Option<&str> {
        self.object_id.as_deref()
    }

    pub(crate) fn with_id(self, id: String) -> Self {
        Self {
            id: Some(id),
            ..self
        }
    }

    /// The line of the file at which it begins, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    pub(crate) fn at_line(self, line: usize) -> Self {
        Self { line, ..self }
    }

    /// Its segments, in order of time.
    pub fn segments(&self) -> &[EphemerisSegment] {
        &self.segments
    }

    /// The last segment that covers `epoch`.
    fn segment(&self, epoch: Epoch) -> Option<&EphemerisSegment> {
        let behind = self.segments.partition_point(|s| s.usable.0 <= epoch);
        let segment = self.segments.get(behind.checked_sub(1)?)?;
        segment.covers(epoch).then_some(segment)
    }

    fn not_covered(&self, epoch: Epoch) -> OrbitError {
        let behind = self.segments.partition_point(|s| s.usable.0 <= epoch);
        let before = behind.checked_sub(1).and_then(|i| self.segments.get(i));
        let (first, last) = self.validity();
        let known = match (before, self.segments.get(behind)) {
            (Some(before), Some(after)) => format!(
                "until {} and again from {}",
                rfc3339(before.usable.1),
                rfc3339(after.usable.0)
            ),
            _ => format!("from {} to {}", rfc3339(first), rfc3339(last)),
        };
        OrbitError::NotCovered {
            satellite: self.name.clone(),
            epoch: rfc3339(epoch),
            known,
        }
    }
}

impl Feed for EphemerisFeed {
    fn name(&self) -> &str {
        &self.name
    }

    /// From the first segment's start to the last one's end; there may be gaps between segments.
    fn validity(&self) -> (Epoch, Epoch) {
        let first = self.segments.first().map(|s| s.usable.0);
        let last = self.segments.last().map(|s| s.usable.1);
        (first.unwrap_or_default(), last.unwrap_or_default())
    }

    fn gaps(&self) -> Vec<(Epoch, Epoch)> {
        let pairs = self.segments.iter().zip(self.segments.iter().skip(1));
        let between = pairs.map(|(a, b)| (a.usable.1, b.usable.0));
        between.filter(|(end, begin)| end < begin).collect()
    }

    fn breaks(&self) -> Vec<Epoch> {
        let pairs = self.segments.iter().zip(self.segments.iter().skip(1));
        let meeting = pairs.filter(|(a, b)| a.usable.1 == b.usable.0);
        meeting.map(|(_, b)| b.usable.0).collect()
    }

    fn object_id(&self) -> Option<&str> {
        self.object_id.as_deref()
    }

    fn id(&self) -> Option<&str> {
        self.id.as_deref()
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        self.segment(epoch)
            .and_then(|segment| segment.samples.state_at(epoch))
            .ok_or_else(|| self.not_covered(epoch))
    }

    fn error_m(&self, epoch: Epoch) -> Option<f64> {
        self.segment(epoch)?.error_m(epoch)
    }
}
