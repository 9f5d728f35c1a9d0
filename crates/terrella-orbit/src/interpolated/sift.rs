//! Samples that cannot be interpolated, distinguished from their neighbours.

use super::{InterpolationError, StateSample, ns_between};
use terrella_frames::rfc3339;

/// The samples that can be interpolated together, in order; the others go to `fault`, whose error ends the work.
///
/// A sample is left out if it is no state, if its instant has been before, or if it is out of the order of time. Of two
/// neighbours in the wrong order the one is meant that does not fit in with the sample after them: one slip of a date
/// costs one sample.
pub(crate) fn sift<E>(
    samples: &[StateSample],
    mut fault: impl FnMut(InterpolationError) -> Result<(), E>,
) -> Result<Vec<StateSample>, E> {
    let mut kept: Vec<(usize, StateSample)> = Vec::with_capacity(samples.len());
    for (index, sample) in samples.iter().enumerate() {
        if !sample.is_state() {
            fault(InterpolationError::NotAState { index })?;
            continue;
        }
        let epoch = sample.epoch;
        if let Some(&(last_index, last)) = kept.last()
            && epoch <= last.epoch
        {
            let before_last = kept.len().checked_sub(2).and_then(|at| kept.get(at));
            let fits_before = before_last.is_none_or(|(_, sample)| sample.epoch < epoch);
            let next = samples.get(index + 1..).unwrap_or_default();
            let next = next.iter().find(|sample| sample.is_state());
            let is_ahead = next.is_some_and(|next| next.epoch <= last.epoch);
            if epoch == last.epoch || !(fits_before && is_ahead) {
                let (epoch, before) = (rfc3339(epoch), rfc3339(last.epoch));
                fault(InterpolationError::Order {
                    index,
                    epoch,
                    before,
                })?;
                continue;
            }
            let (index, after) = (last_index, rfc3339(epoch));
            let epoch = rfc3339(last.epoch);
            fault(InterpolationError::Ahead {
                index,
                epoch,
                after,
            })?;
            kept.pop();
        }
        let first = kept.first().map_or(epoch, |(_, sample)| sample.epoch);
        if ns_between(first, epoch).is_none() {
            let epoch = rfc3339(epoch);
            fault(InterpolationError::TooLong { index, epoch })?;
            continue;
        }
        kept.push((index, *sample));
    }
    Ok(kept.into_iter().map(|(_, sample)| sample).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use terrella_frames::{Duration, Epoch};

    /// Which samples are left out of those at these seconds.
    fn left_out(seconds: &[f64]) -> Vec<usize> {
        let samples: Vec<_> = seconds
            .iter()
            .map(|&s| StateSample {
                epoch: Epoch::from_tai_seconds(3e9) + Duration::from_seconds(s),
                position_m: match s < 0.0 {
                    true => DVec3::NAN,
                    false => DVec3::X * 7e6,
                },
                velocity_m_s: None,
            })
            .collect();
        let mut out = Vec::new();
        let kept = sift::<()>(&samples, |error| {
            out.extend(error.index());
            Ok(())
        });
        assert_eq!(kept.map(|kept| kept.len()), Ok(samples.len() - out.len()));
        out
    }

    #[test]
    fn one_slip_costs_one_sample() {
        for (seconds, bad) in [
            (&[0.0, 1.0, 2.0, 3.0][..], &[][..]),
            (&[0.0, 1.0, -1.0, 3.0], &[2]),
            // The same instant twice.
            (&[0.0, 1.0, 1.0, 2.0, 3.0], &[2]),
            // A date too late, among others, as the first and next to the last.
            (&[0.0, 900.0, 2.0, 3.0, 4.0], &[1]),
            (&[900.0, 1.0, 2.0, 3.0], &[0]),
            (&[0.0, 1.0, 2.0, 900.0, 4.0, 5.0], &[3]),
            // Too early.
            (&[100.0, 101.0, 2.0, 103.0, 104.0], &[2]),
            (&[100.0, 1.0, 102.0, 103.0], &[1]),
            (&[100.0, 101.0, 102.0, 3.0], &[3]),
            // Centuries away.
            (&[0.0, 1.0, 1e10], &[2]),
        ] {
            assert_eq!(left_out(seconds), bad, "{seconds:?}");
        }
    }
}
