//! The samples of a position, put together from packets in any order.

use super::super::entry::{RecordError, RecordFault};
use super::super::found::{Each, Found};
use super::super::interpolated::{
    InterpolatedStates, Interpolation, InterpolationError, StateSample, doubts, sift,
};
use super::super::text::json::Document;
use super::settings::{ExtrapolationKind, Settings};
use super::spans::{MAX_INTERVALS, Span};
use crate::Frame;
use glam::DVec3;
use serde_json::value::RawValue;
use std::sync::Arc;
use terrella_frames::{Duration, Epoch};

/// Most numbers of a position's samples.
pub const MAX_NUMBERS: usize = 8_000_000;

/// A sample and the value of its time.
#[derive(Clone, Copy)]
pub struct Sample<'t> {
    pub state: StateSample,
    pub place: &'t RawValue,
}

/// Samples of one kind: in one frame, with velocities or without.
pub struct Sampled<'t> {
    pub frame: Frame,
    pub with_velocity: bool,
    pub settings: Settings,
    /// In order of time. Two samples at the same time are a discontinuity.
    samples: Vec<Sample<'t>>,
    /// The array of the first samples, for errors.
    numbers: &'t RawValue,
}

/// Up to when extrapolation may go on either side; `None` where nothing ends it.
pub type Ends = (Option<Epoch>, Option<Epoch>);

impl<'t> Sampled<'t> {
    pub fn new(
        frame: Frame,
        with_velocity: bool,
        settings: Settings,
        samples: Vec<Sample<'t>>,
        numbers: &'t RawValue,
    ) -> Self {
        Self {
            frame,
            with_velocity,
            settings,
            samples: in_order(samples),
            numbers,
        }
    }

    /// Adds samples; they replace existing ones at the same time.
    ///
    /// # Errors
    /// Too many samples.
    pub fn add(
        &mut self,
        document: &Document<'t>,
        samples: Vec<Sample<'t>>,
        numbers: &'t RawValue,
    ) -> Result<(), RecordError> {
        let limit = MAX_NUMBERS / 4;
        if self.samples.len() + samples.len() > limit {
            let what = "samples of one object";
            return Err(document.error(numbers, RecordFault::TooMany { what, limit }));
        }
        let later = in_order(samples);
        let is_behind = match (self.samples.last(), later.first()) {
            (Some(last), Some(first)) => last.state.epoch < first.state.epoch,
            _ => true,
        };
        if is_behind {
            self.samples.extend(later);
            return Ok(());
        }
        let is_replaced = |sample: &Sample<'_>| {
            let epoch = sample.state.epoch;
            later
                .binary_search_by(|one| one.state.epoch.cmp(&epoch))
                .is_ok()
        };
        self.samples.retain(|sample| !is_replaced(sample));
        self.samples.extend(later);
        self.samples.sort_by_key(|sample| sample.state.epoch);
        Ok(())
    }

    /// Pieces for interpolation, from discontinuity to discontinuity. Unusable samples go to `each`.
    ///
    /// # Errors
    /// If none is left, or they are not a valid ephemeris.
    pub fn pieces(
        &self,
        document: &Document<'t>,
        ends: Ends,
        each: &mut Each<'_>,
    ) -> Result<Vec<Arc<InterpolatedStates>>, RecordError> {
        let interpolation = self.settings.interpolation(self.with_velocity);
        let mut pieces = Vec::new();
        for run in self.runs() {
            if pieces.len() >= MAX_INTERVALS {
                let (what, limit) = ("jumps", MAX_INTERVALS);
                return Err(document.error(self.numbers, RecordFault::TooMany { what, limit }));
            }
            pieces.extend(self.piece(document, run, interpolation, each)?);
        }
        if pieces.is_empty() {
            let fault = RecordFault::Samples(InterpolationError::Empty);
            return Err(document.error(self.numbers, fault));
        }
        self.extrapolate(document, pieces, ends, each)
    }

    /// The samples between jumps.
    fn runs(&self) -> impl Iterator<Item = &[Sample<'t>]> {
        self.samples
            .chunk_by(|one, next| one.state.epoch != next.state.epoch)
    }

    fn piece(
        &self,
        document: &Document<'t>,
        run: &[Sample<'t>],
        interpolation: Interpolation,
        each: &mut Each<'_>,
    ) -> Result<Option<InterpolatedStates>, RecordError> {
        let states: Vec<StateSample> = run.iter().map(|sample| sample.state).collect();
        let at_its_place = |error: InterpolationError| {
            let sample = error.index().and_then(|index| run.get(index));
            let place = sample.map_or(self.numbers, |sample| sample.place);
            document.error(place, RecordFault::Samples(error))
        };
        let kept = sift(&states, |error| each(Found::BadState(at_its_place(error))))?;
        for doubt in doubts(self.frame, &kept) {
            let sample = kept.get(doubt.index());
            let at = states.iter().position(|one| Some(one) == sample);
            let place = at.and_then(|at| run.get(at)).map(|sample| sample.place);
            let fault = RecordFault::Doubt(doubt);
            each(Found::BadState(
                document.error(place.unwrap_or(self.numbers), fault),
            ))?;
        }
        match kept.is_empty() {
            true => Ok(None),
            false => InterpolatedStates::new(self.frame, &kept, interpolation)
                .map(Some)
                .map_err(at_its_place),
        }
    }

    /// Adds the extrapolation before and after the samples.
    fn extrapolate(
        &self,
        document: &Document<'t>,
        mut pieces: Vec<InterpolatedStates>,
        (earliest, latest): Ends,
        each: &mut Each<'_>,
    ) -> Result<Vec<Arc<InterpolatedStates>>, RecordError> {
        let mut length_s = |key, (kind, duration_s): (ExtrapolationKind, f64), end_s| {
            if kind == ExtrapolationKind::None {
                return Ok(0.0);
            }
            let length_s = duration_s.min(end_s);
            if length_s.is_finite() {
                return Ok(f64::max(length_s, 0.0));
            }
            let fault = RecordFault::NotFollowed {
                key,
                text: format!("{kind:?}").to_uppercase(),
                why: "neither a duration, an interval nor an availability ends it, so the object is known within its samples; add a duration",
            };
            each(Found::BadState(document.error(self.numbers, fault)))?;
            Ok(0.0)
        };
        let (backward, forward) = (
            self.settings.backward.wanted(),
            self.settings.forward.wanted(),
        );
        let begin = pieces.first().map(|piece| piece.span().0);
        let end = pieces.last().map(|piece| piece.span().1);
        let (Some(begin), Some(end)) = (begin, end) else {
            return Ok(Vec::new());
        };
        let before_s = length_s(
            "backwardExtrapolationType",
            backward,
            earliest.map_or(f64::INFINITY, |at| (begin - at).to_seconds()),
        )?;
        let after_s = length_s(
            "forwardExtrapolationType",
            forward,
            latest.map_or(f64::INFINITY, |at| (at - end).to_seconds()),
        )?;
        let is_polynomial = |kind| kind == ExtrapolationKind::Extrapolate;
        if let Some(first) = pieces.first_mut().filter(|_| is_polynomial(backward.0)) {
            *first = first.clone().extrapolated(before_s, 0.0);
        }
        let is_single = pieces.len() == 1 && is_polynomial(backward.0);
        if let Some(last) = pieces.last_mut().filter(|_| is_polynomial(forward.0)) {
            *last = last
                .clone()
                .extrapolated(if is_single { before_s } else { 0.0 }, after_s);
        }
        let mut all: Vec<_> = Vec::with_capacity(pieces.len() + 2);
        let seconds = Duration::from_seconds;
        if backward.0 == ExtrapolationKind::Hold && before_s > 0.0 {
            let first = pieces.first().and_then(|piece| piece.samples().next());
            if let Some(state) = first {
                let span = (begin - seconds(before_s), begin);
                all.push(self.at_rest(document, state.position_m, span)?);
            }
        }
        let last = pieces.last().and_then(|piece| piece.samples().last());
        all.extend(pieces.into_iter().map(Arc::new));
        if forward.0 == ExtrapolationKind::Hold
            && after_s > 0.0
            && let Some(state) = last
        {
            let span = (end, end + seconds(after_s));
            all.push(self.at_rest(document, state.position_m, span)?);
        }
        Ok(all)
    }

    fn at_rest(
        &self,
        document: &Document<'t>,
        position_m: DVec3,
        span: Span,
    ) -> Result<Arc<InterpolatedStates>, RecordError> {
        at_rest(self.frame, position_m, span)
            .map_err(|error| document.error(self.numbers, RecordFault::Samples(error)))
    }
}

/// A point that is fixed for a time.
pub fn at_rest(
    frame: Frame,
    position_m: DVec3,
    (from, to): Span,
) -> Result<Arc<InterpolatedStates>, InterpolationError> {
    let sample = |epoch| StateSample {
        epoch,
        position_m,
        velocity_m_s: Some(DVec3::ZERO),
    };
    let samples = [sample(from), sample(to)];
    let samples = if from < to {
        &samples[..]
    } else {
        &samples[..1]
    };
    InterpolatedStates::new(frame, samples, Interpolation::Linear).map(Arc::new)
}

/// Samples of one array in order of time.
///
/// Two consecutive samples at the same time are a discontinuity: writers mark a change of element set or a burn in this way, and a polynomial
/// across it would oscillate. Otherwise the later of two samples at the same time applies.
fn in_order(mut samples: Vec<Sample<'_>>) -> Vec<Sample<'_>> {
    let is_rising = samples.windows(2).all(|pair| match pair {
        [one, next] => one.state.epoch <= next.state.epoch,
        _ => true,
    });
    if is_rising {
        return samples;
    }
    let mut numbered: Vec<_> = samples.drain(..).enumerate().collect();
    numbered.sort_by_key(|(at, sample)| (sample.state.epoch, *at));
    let mut kept: Vec<(usize, Sample<'_>)> = Vec::with_capacity(numbered.len());
    for (at, sample) in numbered {
        while let Some((before, last)) = kept.last()
            && last.state.epoch == sample.state.epoch
            && before + 1 != at
        {
            kept.pop();
        }
        kept.push((at, sample));
    }
    kept.into_iter().map(|(_, sample)| sample).collect()
}
