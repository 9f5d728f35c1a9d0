//! Samples of an object from jump to jump, put together into its ephemeris.

use super::Frame;
use super::entry::{RecordError, RecordFault, TextPosition};
use super::found::{Each, Found};
use super::interpolated::{
    EphemerisFeed, EphemerisSegment, InterpolatedStates, Interpolation, InterpolationError,
    StateSample, doubts, sift,
};
use std::path::Path;

/// Most runs of an object.
pub(super) const MAX_RUNS: usize = 100_000;

/// Samples that are interpolated together, with their lines.
#[derive(Clone, Debug, Default)]
pub(super) struct Run {
    pub samples: Vec<StateSample>,
    pub lines: Vec<usize>,
}

/// Properties of all runs of an object.
pub(super) struct Motion<'o> {
    pub name: String,
    pub frame: Frame,
    pub interpolation: Interpolation,
    pub origin: &'o Path,
    /// Position of the object's first character.
    pub place: TextPosition,
}

impl Motion<'_> {
    /// The object's feed; samples that are left out go to `each`.
    pub fn feed(self, runs: Vec<Run>, each: &mut Each<'_>) -> Result<EphemerisFeed, RecordError> {
        let mut segments = Vec::new();
        for run in &runs {
            let line_of = |index: Option<usize>| {
                let line = index.and_then(|index| run.lines.get(index));
                line.map_or(self.place, |&line| TextPosition { line, column: 1 })
            };
            let at_its_line = |error: InterpolationError| {
                let place = line_of(error.index());
                place.error(self.origin, RecordFault::Samples(error))
            };
            let kept = sift(&run.samples, |error| {
                each(Found::BadState(at_its_line(error)))
            })?;
            for doubt in doubts(self.frame, &kept) {
                let sample = kept.get(doubt.index());
                let index = run.samples.iter().position(|one| Some(one) == sample);
                let fault = RecordFault::Doubt(doubt);
                each(Found::BadState(line_of(index).error(self.origin, fault)))?;
            }
            if kept.is_empty() {
                continue;
            }
            let samples = InterpolatedStates::new(self.frame, &kept, self.interpolation)
                .map_err(at_its_line)?;
            segments.push(EphemerisSegment::whole(samples));
        }
        let feed = EphemerisFeed::new(self.name, None, segments);
        match feed {
            Ok(feed) => Ok(feed.at_line(self.place.line)),
            Err(error) => Err(self.place.error(self.origin, RecordFault::Segments(error))),
        }
    }
}
