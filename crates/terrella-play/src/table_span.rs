//! The time of a table: from the scene's first epoch on, as far as a satellite is known.

use super::{Flight, PlayError, Satellite};
use terrella::frames::{Duration, Epoch, rfc3339};

/// From the scene's first epoch, for this length or to the scene's last epoch, within the satellite's validity.
///
/// # Errors
/// If it is known at none of these times; the error states its validity.
pub(super) fn table_span(
    flight: &Flight,
    satellite: &Satellite,
    length: Option<Duration>,
) -> Result<(Epoch, Epoch), PlayError> {
    let (first, last) = flight.scene().time.span(length);
    let known = satellite.feed().validity();
    let span = (first.max(known.0), last.min(known.1));
    if span.0 > span.1 {
        satellite.feed().state_at(first)?;
    }
    Ok(span)
}

/// A sentence, without a full stop, if the satellite is known for less than this length, or than the scene's, from the scene's first epoch on.
pub fn early_end(
    flight: &Flight,
    satellite: &Satellite,
    length: Option<Duration>,
) -> Option<String> {
    if satellite.live().is_some() || satellite.simulation().is_some() {
        return None;
    }
    let (_, last) = flight.scene().time.span(length);
    let (_, end) = satellite.feed().validity();
    let (what, remedy) = match (satellite.elements(), satellite.events()) {
        (Some(_), _) => ("elements", "; take newer elements for later times"),
        // Motion is integrated over the time of the scene.
        (None, Some(_)) => ("integration", "; set a longer time.duration_s"),
        (None, None) => ("states", ""),
    };
    let verb = if what == "integration" { "ends" } else { "end" };
    let name = satellite.name();
    let end_text = rfc3339(end);
    (end < last).then(|| format!("{name}: the {what} {verb} at {end_text}{remedy}"))
}

/// An error if a simulator gives the satellite's states.
pub(super) fn reject_live(flight: &Flight, satellite: &Satellite) -> Result<(), PlayError> {
    let Some(feed) = satellite.live() else {
        return Ok(());
    };
    Err(PlayError::Live {
        scene: flight.scene().path.clone(),
        listens_on: feed.options().transport.to_string(),
        work: "its states are known when they come, not before",
        remedy: "have the simulator write them down, or choose another satellite by --satellite",
    })
}
