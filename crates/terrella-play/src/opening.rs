//! Opens the satellites of a scene, in an order that allows one of them to set the start of the scene.
//!
//! Files have their own times and are opened first. A scene without a start then begins at the followed satellite's time ([`Scene::begin_at`]). All
//! other sources get that start: motions described in the scene, simulations, stand-ins.

use super::error::PlayError;
use super::satellites::{self, Integrated, Listener, Satellite, Sources, stand_in};
use crate::scene::{Many, Orbit, Scene};
use terrella::frames::{EarthOrientation, Epoch};
use terrella_orbit::OrbitFiles;

/// The satellites of a scene, in its order; of the scene, what follows from them of its start.
pub(super) fn open_all(
    scene: &mut Scene,
    table: Option<&EarthOrientation>,
    listener: Listener,
) -> Result<Vec<Satellite>, PlayError> {
    let mut sources = Sources {
        table,
        listener,
        files: OrbitFiles::default(),
    };
    let many = open_many(scene, &mut sources)?;
    let orbits = scene.orbits.iter().zip(many).enumerate();
    let files = orbits.map(|(index, (orbit, opened))| {
        if opened.is_some() {
            return Ok(opened);
        }
        let is_file = orbit.file.is_some();
        let open = || satellites::open(scene, index, orbit, Integrated::AtEpoch, &mut sources);
        is_file.then(open).transpose()
    });
    let files = files.collect::<Result<Vec<_>, _>>()?;
    if !scene.is_live()
        && let Some((start, from)) = own_start(scene, &files)
    {
        scene.begin_at(start, from)?;
    }
    if let Some(table) = table
        && !scene.is_live()
    {
        scene.check_orientation(table.span())?;
    }
    stand_in(scene)?;
    let all = scene.orbits.iter().zip(files).enumerate();
    all.map(|(index, (orbit, opened))| match opened {
        // A state without propagation is valid at its epoch only.
        Some(satellite) if satellite.state_epoch().is_none() => Ok(satellite),
        _ => satellites::open(scene, index, orbit, Integrated::OverScene, &mut sources),
    })
    .collect()
}

/// Opens what tables fly that fly many satellites of a file, and gives each of these an orbit of the scene. Answers which satellites
/// of the scene are open by that.
fn open_many(
    scene: &mut Scene,
    sources: &mut Sources<'_>,
) -> Result<Vec<Option<Satellite>>, PlayError> {
    let (mut opened, mut orbits) = (Vec::new(), Vec::new());
    for (index, orbit) in scene.orbits.iter().enumerate() {
        if let Some(Many::Pattern(walker)) = &orbit.all {
            let pattern = orbit.name.as_deref().unwrap_or("Walker");
            for member in 0..walker.count() {
                orbits.push((index, Some(walker.name(pattern, member))));
                opened.push(None);
            }
            continue;
        }
        let (Some(many), Some(file)) = (&orbit.all, &orbit.file) else {
            opened.push(None);
            orbits.push((index, None));
            continue;
        };
        for satellite in satellites::open_many(scene, index, orbit, (many, file), sources)? {
            orbits.push((index, Some(satellite.name().to_owned())));
            opened.push(Some(satellite));
        }
    }
    scene.expand(orbits)?;
    Ok(opened)
}

/// Default start of a scene, and its source: the followed satellite, or, if that is valid at any time, the first of the others that is not.
fn own_start(scene: &Scene, files: &[Option<Satellite>]) -> Option<(Epoch, String)> {
    let all = scene.orbits.iter().zip(files);
    let names = all.clone().map(|(orbit, opened)| match opened {
        Some(satellite) => satellite.name(),
        None => orbit.name.as_deref().unwrap_or_default(),
    });
    let names: Vec<_> = names.collect();
    // An unknown name is rejected after all are open.
    let followed = scene.followed(&names).unwrap_or(0);
    let backwards = scene.time.speed < 0.0;
    let is_given = |index| scene.orbit_line(index, "epoch").is_some();
    let of = |index: usize| {
        let orbit = scene.orbits.get(index)?;
        match files.get(index)? {
            Some(satellite) => Some(start_of(satellite, backwards)),
            None => start_of_motion(orbit).filter(|_| is_given(index)),
        }
    };
    if scene.orbits.get(followed)?.is_built_in() {
        return None;
    }
    of(followed).or_else(|| (0..files.len()).find_map(of))
}

fn start_of(satellite: &Satellite, backwards: bool) -> (Epoch, String) {
    let name = satellite.name();
    if let Some(elements) = satellite.elements() {
        return (elements.epoch, format!("epoch of the elements of {name}"));
    }
    if let Some(epoch) = satellite.state_epoch() {
        return (epoch, format!("epoch of the state of {name}"));
    }
    let (first, last) = satellite.feed().validity();
    match backwards {
        false => (first, format!("first state of {name}")),
        true => (last, format!("last state of {name}")),
    }
}

fn start_of_motion(orbit: &Orbit) -> Option<(Epoch, String)> {
    let start = orbit.motion.as_ref()?.start();
    let name = orbit.name.as_deref().unwrap_or("the orbit");
    Some((start.epoch, format!("epoch of {name}")))
}
