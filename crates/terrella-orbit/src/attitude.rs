//! Attitudes from files: the orientation of a spacecraft's axes in a frame at an epoch.
//!
//! Supported are attitude ephemeris messages (AEM, CCSDS 504.0-B) in KVN and XML with quaternions or Euler angles, and tables of quaternions in
//! CSV. Between two samples the attitude rotates uniformly about one axis, the shorter way (slerp). Between segments of a message it is unknown.

mod aem;
mod table;

use super::entry::{RecordError, RecordFault, TextPosition};
use super::{Frame, OrbitError, file, text};
use glam::{DMat3, DQuat, DVec4};
use std::path::{Path, PathBuf};
use terrella_frames::{Epoch, Orientation, rfc3339};

/// Most bytes of a file.
const MAX_BYTES: u64 = 256 << 20;
/// Most samples of a file.
const MAX_SAMPLES: usize = 2_000_000;
/// How far the length of a quaternion may be off one: files round.
const LENGTH_TOLERANCE: f64 = 0.01;

/// The attitude of a spacecraft over the time of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct AttitudeHistory {
    path: PathBuf,
    /// In order of time.
    segments: Vec<Segment>,
}

/// Samples between which the attitude is known.
#[derive(Clone, Debug, PartialEq)]
struct Segment {
    frame: Frame,
    /// The time for which it may be used.
    first: Epoch,
    last: Epoch,
    /// Rotations from the body's axes to those of the frame, in order of time; at least one.
    samples: Vec<(Epoch, DQuat)>,
}

/// Why an attitude is not known.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum AttitudeError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] Box<OrbitError>),
    /// An error in a record of the file.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// An epoch outside of the file's time.
    #[error("{}: the attitude is not known at {epoch}; the file has it from {first} to {last}: take a time within, or a file that reaches there", path.display())]
    Outside {
        path: PathBuf,
        epoch: String,
        first: String,
        last: String,
    },
    /// An epoch between two segments.
    #[error("{}: the attitude is not known at {epoch}; the file has none between {from} and {to}: take a time outside of that gap", path.display())]
    Gap {
        path: PathBuf,
        epoch: String,
        from: String,
        to: String,
    },
}

impl AttitudeHistory {
    /// Reads a file, which may be compressed by gzip.
    ///
    /// # Errors
    /// A file that cannot be read, or an error in it, with line and column.
    pub fn open(path: &Path) -> Result<Self, AttitudeError> {
        let text = file::read_text(path, MAX_BYTES).map_err(Box::new)?;
        Ok(Self::of_text(&text, path)?)
    }

    /// Parses the text of a file; `origin` names it in errors.
    ///
    /// # Errors
    /// An error in it, with line and column.
    pub fn of_text(text: &str, origin: &Path) -> Result<Self, RecordError> {
        let text = text::unmarked(text);
        let segments = match aem::is_aem(text) {
            true => aem::segments(text, origin)?,
            false => table::segments(text, origin)?,
        };
        Ok(Self {
            path: origin.to_owned(),
            segments,
        })
    }

    /// First and last epoch at which it is known.
    pub fn validity(&self) -> (Epoch, Epoch) {
        let first = self.segments.first().map(|segment| segment.first);
        let last = self.segments.last().map(|segment| segment.last);
        let none = Epoch::default();
        (first.unwrap_or(none), last.unwrap_or(none))
    }

    /// Times within the validity in which it is not known.
    pub fn gaps(&self) -> impl Iterator<Item = (Epoch, Epoch)> {
        let pairs = self.segments.windows(2);
        pairs.filter_map(|pair| match pair {
            [before, after] if before.last < after.first => Some((before.last, after.first)),
            _ => None,
        })
    }

    /// The frame, and the rotation from the body's axes to it.
    ///
    /// # Errors
    /// An epoch at which the attitude is unknown.
    pub fn frame_from_body(&self, epoch: Epoch) -> Result<(Frame, DQuat), AttitudeError> {
        // Where two segments meet, the later one applies.
        let mut segments = self.segments.iter().rev();
        let segment = segments.find(|one| (one.first..=one.last).contains(&epoch));
        match segment {
            Some(segment) => Ok((segment.frame, segment.at(epoch))),
            None => Err(self.unknown(epoch)),
        }
    }

    /// The same to ITRF.
    ///
    /// # Errors
    /// An epoch at which it is not known.
    pub fn itrf_from_body(
        &self,
        epoch: Epoch,
        orientation: &Orientation,
    ) -> Result<DMat3, AttitudeError> {
        let (frame, frame_from_body) = self.frame_from_body(epoch)?;
        Ok(frame.itrf_from(epoch, orientation) * DMat3::from_quat(frame_from_body))
    }

    /// Whether it is known from one epoch to another, without a gap.
    ///
    /// # Errors
    /// The first epoch at which it is not.
    pub fn check_span(&self, first: Epoch, last: Epoch) -> Result<(), AttitudeError> {
        self.frame_from_body(first)?;
        let mut gaps = self.gaps();
        if let Some((from, _)) = gaps.find(|(from, to)| *from < last && first < *to) {
            return Err(self.unknown(from + terrella_frames::Duration::from_seconds(1e-3)));
        }
        self.frame_from_body(last).map(|_| ())
    }

    fn unknown(&self, epoch: Epoch) -> AttitudeError {
        let path = self.path.clone();
        let mut gaps = self.gaps();
        match gaps.find(|(from, to)| (*from..=*to).contains(&epoch)) {
            Some((from, to)) => AttitudeError::Gap {
                path,
                epoch: rfc3339(epoch),
                from: rfc3339(from),
                to: rfc3339(to),
            },
            None => {
                let (first, last) = self.validity();
                AttitudeError::Outside {
                    path,
                    epoch: rfc3339(epoch),
                    first: rfc3339(first),
                    last: rfc3339(last),
                }
            }
        }
    }
}

impl Segment {
    /// Checks that something is left between the samples and the time for which they may be used.
    fn new(
        frame: Frame,
        samples: Vec<(Epoch, DQuat)>,
        useable: (Option<Epoch>, Option<Epoch>),
        place: TextPosition,
        origin: &Path,
    ) -> Result<Self, RecordError> {
        let (Some((first, _)), Some((last, _))) = (samples.first(), samples.last()) else {
            let fault = RecordFault::Missing {
                what: "the segment",
                key: "attitudes",
                remedy: "; give at least one row",
            };
            return Err(place.error(origin, fault));
        };
        let first = useable.0.map_or(*first, |from| from.max(*first));
        let last = useable.1.map_or(*last, |to| to.min(*last));
        if first > last {
            let fault = RecordFault::Missing {
                what: "the segment",
                key: "attitudes within its useable time",
                remedy: "; correct USEABLE_START_TIME and USEABLE_STOP_TIME",
            };
            return Err(place.error(origin, fault));
        }
        Ok(Self {
            frame,
            first,
            last,
            samples,
        })
    }

    fn at(&self, epoch: Epoch) -> DQuat {
        let after = self.samples.partition_point(|(at, _)| *at <= epoch);
        let before = after.checked_sub(1).and_then(|i| self.samples.get(i));
        match (before, self.samples.get(after)) {
            (Some((t0, q0)), Some((t1, q1))) => {
                let part = (epoch - *t0).to_seconds() / (*t1 - *t0).to_seconds();
                q0.slerp(*q1, part)
            }
            (Some((_, q)), None) | (None, Some((_, q))) => *q,
            (None, None) => DQuat::IDENTITY,
        }
    }
}

/// Adds a sample to those before it, which must be earlier.
fn push(
    samples: &mut Vec<(Epoch, DQuat)>,
    epoch: Epoch,
    quaternion: DVec4,
    place: TextPosition,
    origin: &Path,
) -> Result<(), RecordError> {
    let wrong = |key: &str, text: String, expected| {
        let key = key.to_owned();
        let fault = RecordFault::Field {
            key,
            text,
            expected,
        };
        Err(place.error(origin, fault))
    };
    if samples.last().is_some_and(|(before, _)| *before >= epoch) {
        return wrong(
            "the epoch",
            rfc3339(epoch),
            "one after that of the row before",
        );
    }
    let length = quaternion.length();
    if (length - 1.0).abs().partial_cmp(&LENGTH_TOLERANCE) != Some(std::cmp::Ordering::Less) {
        return wrong(
            "the length of the quaternion",
            format!("{length:.4}"),
            "one, within a hundredth",
        );
    }
    if samples.len() >= MAX_SAMPLES {
        let (what, limit) = ("attitudes", MAX_SAMPLES);
        return Err(place.error(origin, RecordFault::TooMany { what, limit }));
    }
    samples.push((epoch, DQuat::from_vec4(quaternion / length)));
    Ok(())
}

#[cfg(test)]
mod tests;
