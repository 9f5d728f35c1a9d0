//! Checks a scene: table by table, and what the tables say of each other.

use super::choices::CameraMode;
use super::error::SceneError;
use super::keys::{MAX_ORBITS, RawOrbit, RawScene};
use super::orbit::Orbit;
use super::text::SceneText;
use super::{KeyLines, Scene};

/// Checks a whole scene.
pub(super) fn check(source: SceneText<'_>, raw: RawScene) -> Result<Scene, SceneError> {
    let time = raw.time.unwrap_or_default();
    let orbits = raw.orbit.map(|orbits| orbits.0).unwrap_or_default();
    let tracks = raw.tracks.unwrap_or_default();
    let camera = raw.camera.unwrap_or_default();
    let earth = raw.earth.unwrap_or_default();
    let sky = raw.sky.unwrap_or_default();
    let output = raw.output.unwrap_or_default();
    let quality = raw.quality.unwrap_or_default();
    if let Some(orbit) = orbits.get(MAX_ORBITS) {
        let advice = format!(
            "a scene has at most {MAX_ORBITS} satellites and this one {}; leave some out",
            orbits.len()
        );
        return Err(source.refuse(&orbit.source(), advice));
    }

    let mut lines = KeyLines::default();
    for (table, given) in [
        ("time", time.given()),
        (
            "orbit",
            orbits.first().map_or_else(Vec::new, RawOrbit::given),
        ),
        ("tracks", tracks.given()),
        ("camera", camera.given()),
        ("earth", earth.given()),
        ("sky", sky.given()),
        ("output", output.given()),
        ("quality", quality.given()),
    ] {
        for (key, span) in given {
            lines.insert(table, key.name, source.line(span.start));
        }
    }

    let orbit_lines = orbits.iter().map(|orbit| {
        let mut lines = KeyLines::default();
        for (key, span) in orbit.given() {
            lines.insert("orbit", key.name, source.line(span.start));
        }
        lines
    });
    let orbit_lines = orbit_lines.collect();

    let follow = camera.follow().given;
    if let Some(follow) = follow.filter(|_| orbits.is_empty()) {
        let advice = "follow names one of the scene's own satellites and it has none; give it an [orbit] table, or leave follow out";
        return Err(source.refuse_at("camera", "follow", follow.span(), advice));
    }
    let raw_keys = camera.keys().given.map(toml::Spanned::span);
    let camera = source.camera(&camera)?;
    let earth = source.earth(&earth)?;
    let sky = source.sky(&sky, &earth)?;
    let time = source.time(&time)?;
    let mut checked = orbits
        .iter()
        .map(|orbit| source.orbit(orbit, &tracks, time.start))
        .collect::<Result<Vec<_>, _>>()?;
    source.live_together(&orbits, &checked)?;
    source.basilisk_alone(&orbits, &checked)?;
    let is_met = |orbit: &Orbit| orbit.live.is_some() || orbit.basilisk.is_some();
    let has_live = checked.iter().any(is_met);
    if let Some(keys) = raw_keys {
        if has_live {
            let advice = "keys are moments of the scene's own time, and here a simulator gives the time; leave them out";
            return Err(source.refuse_at("camera", "keys", keys, advice));
        }
        if output
            .exposure_ev()
            .given
            .is_some_and(|ev| ev.get_ref().as_str() == Some("auto"))
            && camera.keys.iter().any(|key| key.exposure_ev.is_some())
        {
            let advice = "keys that set exposure_ev have no meaning with exposure_ev = \"auto\" in [output]; leave the one or the other out";
            return Err(source.refuse_at("camera", "keys", keys, advice));
        }
    }
    if checked.is_empty() && camera.mode != CameraMode::Geodetic {
        checked.push(Orbit {
            track: source.track(&RawOrbit::default(), &tracks)?,
            ..Orbit::built_in()
        });
    }
    let track_px = source.tracks(&tracks, !checked.is_empty())?;
    Ok(Scene {
        path: source.path.to_owned(),
        time,
        orbits: checked,
        orbit_lines,
        notices: Vec::new(),
        track_px,
        output: source.output(&output, &camera, &earth, has_live)?,
        camera,
        sky,
        quality: source.quality(&quality)?,
        earth,
        lines,
        text: None,
    })
}
