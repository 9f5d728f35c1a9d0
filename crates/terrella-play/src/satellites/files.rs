//! Satellites of files.

use super::{FileRemark, Integrated, Satellite, Sources, integrated_span, orientation_at};
use crate::error::PlayError;
use crate::scene::{Many, Orbit, OrbitSource, Scene, SceneError};
use std::path::Path;
use std::sync::Arc;
use terrella::frames::rfc3339;
use terrella_orbit::{Feed, FileFormat, OrbitError};

/// How many faults of a file are reported when it is read.
const FAULTS_TOLD: usize = 10;

/// Opens a satellite of a file.
pub(super) fn open(
    scene: &Scene,
    index: usize,
    orbit: &Orbit,
    file: &Path,
    integrated: Integrated,
    Sources { table, files, .. }: &mut Sources<'_>,
) -> Result<Satellite, PlayError> {
    let name = orbit.name.as_deref();
    let check = |format| check_source(scene, index, orbit, file, format);
    let (tracked, faults, faults_left_out, is_new) = match orbit.source {
        OrbitSource::Tle | OrbitSource::Omm => {
            let mut read = files.catalogue(file, orbit.strict)?;
            // Without a name the only satellite is meant, and a bad record may be another one.
            let is_fault = |fault: &OrbitError| !fault.is_notice();
            if name.is_none()
                && read.content.faults.iter().any(is_fault)
                && read.content.is_open_which_is_meant()
            {
                read = files.catalogue(file, true)?;
            }
            let catalogue = &read.content;
            check(catalogue.format)?;
            let feed = catalogue.one(file, name)?;
            let elements = Some(feed.elements().clone());
            let satellite = Satellite {
                elements,
                ..Satellite::of(feed)
            };
            let faults = remarks(&catalogue.faults);
            (satellite, faults, catalogue.faults_left_out, read.is_new)
        }
        OrbitSource::Opm => {
            let read = files.parameters(file, orbit.strict)?;
            let messages = &read.content;
            let message = Arc::new(messages.one(file, name)?.clone());
            let epoch = message.state.epoch;
            let (first, last) = match integrated {
                Integrated::AtEpoch => (epoch, epoch),
                Integrated::OverScene => integrated_span(scene),
            };
            let orientation = orientation_at(*table, epoch).ok_or_else(|| {
                let remedy = format!(
                    "the table of [time] orientation does not reach to the epoch of its state, {}; take one that does, or leave orientation out",
                    rfc3339(epoch)
                );
                scene.reject_orbit(index, "file", &file.display().to_string(), remedy)
            })?;
            let feed = message.propagated(first, last, &orientation)?;
            let satellite = Satellite {
                events: Some(feed.events()),
                state_epoch: Some(epoch),
                ..Satellite::of(feed)
            };
            let faults = remarks(&messages.faults);
            (satellite, faults, messages.faults_left_out, read.is_new)
        }
        _ => {
            let read = files.ephemerides(file, orbit.strict)?;
            let ephemerides = &read.content;
            check(ephemerides.format)?;
            let satellite = Satellite::of(ephemerides.one(file, name)?);
            let faults = remarks(&ephemerides.faults);
            (satellite, faults, ephemerides.faults_left_out, read.is_new)
        }
    };
    // Remarks about a file are reported once, however many satellites come from it.
    if is_new {
        tell(file, &faults, faults_left_out);
    }
    Ok(Satellite {
        faults,
        faults_left_out,
        ..tracked
    })
}

/// The satellites of a file for one table, in the file's order. Remarks about the file are attached to the first of them.
///
/// # Errors
/// If the file cannot be read, has another format, or has none of them.
pub fn open_many(
    scene: &Scene,
    index: usize,
    orbit: &Orbit,
    (many, file): (&Many, &Path),
    sources: &mut Sources<'_>,
) -> Result<Vec<Satellite>, PlayError> {
    let check = |format| check_source(scene, index, orbit, file, format);
    let (mut satellites, faults, left_out) = match orbit.source {
        OrbitSource::Tle | OrbitSource::Omm => {
            let read = sources.files.catalogue(file, orbit.strict)?;
            let catalogue = &read.content;
            check(catalogue.format)?;
            let feeds = catalogue.feeds.iter().filter(|feed| {
                let elements = feed.elements();
                let names = [Some(elements.name.as_str()), elements.object_id.as_deref()];
                many.has(names.into_iter().flatten(), Some(feed.catalogue_number()))
            });
            let satellites: Vec<_> = feeds
                .map(|feed| Satellite {
                    elements: Some(feed.elements().clone()),
                    ..Satellite::of(feed.clone())
                })
                .collect();
            (
                satellites,
                remarks(&catalogue.faults),
                catalogue.faults_left_out,
            )
        }
        _ => {
            let read = sources.files.ephemerides(file, orbit.strict)?;
            let ephemerides = &read.content;
            check(ephemerides.format)?;
            let feeds = ephemerides.feeds.iter().filter(|feed| {
                let names = [Some(feed.name()), feed.id(), feed.object_id()];
                many.has(names.into_iter().flatten(), None)
            });
            let satellites: Vec<_> = feeds.map(|feed| Satellite::of(feed.clone())).collect();
            (
                satellites,
                remarks(&ephemerides.faults),
                ephemerides.faults_left_out,
            )
        }
    };
    tell(file, &faults, left_out);
    match satellites.first_mut() {
        Some(first) => {
            first.faults = faults;
            first.faults_left_out = left_out;
            Ok(satellites)
        }
        None => Err(scene.none_of_many(index, many, file).into()),
    }
}

fn remarks(faults: &[OrbitError]) -> Vec<FileRemark> {
    faults.iter().map(FileRemark::of).collect()
}

/// Rejects a file whose format differs from the table's.
fn check_source(
    scene: &Scene,
    index: usize,
    orbit: &Orbit,
    file: &Path,
    format: FileFormat,
) -> Result<(), SceneError> {
    let source = OrbitSource::of(format);
    if source == orbit.source {
        return Ok(());
    }
    let given = source_key(orbit.source);
    let remedy = format!(
        "{} holds {}; write source = \"{}\"",
        file.display(),
        format_name(format),
        source_key(source)
    );
    Err(scene.reject_orbit(index, "source", given, remedy))
}

/// Logs warnings and notices about a file.
fn tell(file: &Path, faults: &[FileRemark], left_out: usize) {
    for FileRemark { label, text } in faults.iter().take(FAULTS_TOLD) {
        tracing::warn!("{label}: {text}");
    }
    match faults.len().saturating_sub(FAULTS_TOLD) + left_out {
        0 => {}
        more => tracing::warn!(
            "skipped: {more} more of {}; terrella check lists them, --strict rejects them",
            file.display()
        ),
    }
}

fn source_key(source: OrbitSource) -> &'static str {
    match source {
        OrbitSource::Tle => "tle",
        OrbitSource::Omm => "omm",
        OrbitSource::Oem => "oem",
        OrbitSource::Opm => "opm",
        OrbitSource::Czml => "czml",
        OrbitSource::Csv => "csv",
        OrbitSource::Sp3 => "sp3",
        OrbitSource::Stk => "stk",
        OrbitSource::Kepler => "kepler",
        OrbitSource::Numerical => "numerical",
        OrbitSource::Live => "live",
        OrbitSource::Basilisk => "basilisk",
    }
}

fn format_name(format: FileFormat) -> &'static str {
    match format {
        FileFormat::Tle => "two-line elements",
        FileFormat::Omm => "an orbit mean-elements message",
        FileFormat::Oem => "an orbit ephemeris message",
        FileFormat::Opm => "an orbit parameter message",
        FileFormat::Czml => "CZML",
        FileFormat::Csv => "states in columns",
        FileFormat::Sp3 => "orbits in SP3",
        FileFormat::Stk => "an ephemeris of STK",
    }
}
