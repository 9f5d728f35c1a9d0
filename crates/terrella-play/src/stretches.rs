//! States divided where a motion is not smooth: interpolation must not cross such a time.

use terrella::frames::{Duration, Epoch};
use terrella_orbit::interpolated::StateSample;
use terrella_orbit::{Feed, OrbitError, OrbitState};

/// How long before an instant the motion is as it was before it.
const BEFORE: Duration = Duration::from_parts(0, 1);

/// States of a motion in order of time, as samples from break to break and from gap to gap: each stretch has a sample at both of its ends.
/// `turned` brings a state into the axes of the others.
///
/// A sample at the end of a stretch is of the nanosecond before, 8 µm from it in low orbit.
///
/// # Errors
/// If the motion is not known at an end.
pub(super) fn stretches(
    feed: &dyn Feed,
    states: &[OrbitState],
    turned: impl Fn(&OrbitState) -> OrbitState,
) -> Result<Vec<Vec<StateSample>>, OrbitError> {
    let (Some(first), Some(last)) = (states.first(), states.last()) else {
        return Ok(Vec::new());
    };
    // End of one piece and start of the next.
    let breaks = feed.breaks().into_iter().map(|at| (at, at));
    let mut cuts: Vec<(Epoch, Epoch)> = feed.gaps().into_iter().chain(breaks).collect();
    cuts.retain(|(end, begin)| first.epoch <= *end && first.epoch < *begin && *begin <= last.epoch);
    cuts.sort();
    let mut stretches = Vec::with_capacity(cuts.len() + 1);
    let mut stretch: Vec<StateSample> = Vec::new();
    let mut left = states.iter().peekable();
    for (end, begin) in cuts {
        let is_gap = end < begin;
        while let Some(state) =
            left.next_if(|state| state.epoch < end || is_gap && state.epoch == end)
        {
            stretch.push(sample(state, state.epoch));
        }
        if stretch.last().is_none_or(|sample| sample.epoch < end) {
            let at = if is_gap { end } else { end - BEFORE };
            stretch.push(sample(&turned(&feed.state_at(at)?), end));
        }
        stretches.push(std::mem::take(&mut stretch));
        if left.peek().is_none_or(|state| state.epoch > begin) {
            stretch.push(sample(&turned(&feed.state_at(begin)?), begin));
        }
    }
    stretch.extend(left.map(|state| sample(state, state.epoch)));
    stretches.push(stretch);
    // One instant is no stretch, but where there is nothing else.
    if stretches.iter().any(|stretch| stretch.len() > 1) {
        stretches.retain(|stretch| stretch.len() > 1);
    }
    Ok(stretches)
}

fn sample(state: &OrbitState, epoch: Epoch) -> StateSample {
    StateSample {
        epoch,
        position_m: state.position_m,
        velocity_m_s: Some(state.velocity_m_s),
    }
}
