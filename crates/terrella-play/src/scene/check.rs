//! Checks a scene: each table, and the consistency between tables.

use super::Scene;
use super::choices::CameraMode;
use super::error::SceneError;
use super::keys::{MAX_ORBITS, RawEarth, RawScene};
use super::orbit::Orbit;
use super::orbit_keys::RawOrbit;
use super::text::SceneText;

/// Checks a whole scene.
pub(super) fn check(source: SceneText<'_>, raw: RawScene) -> Result<Scene, SceneError> {
    let mut orbits = raw.orbit.0;
    if let Some(orbit) = orbits.get(MAX_ORBITS) {
        let advice = format!(
            "a scene has at most {MAX_ORBITS} satellites and this one {}; leave some out",
            orbits.len()
        );
        return Err(source.reject(&orbit.source(), advice));
    }

    let follow = raw.camera.follow().given;
    if let Some(follow) = follow.filter(|_| orbits.is_empty()) {
        let advice = "follow names one of the scene's own satellites and it has none; give it an [orbit] table, or leave follow out";
        return Err(source.reject_at("camera", "follow", follow.span(), advice));
    }
    let raw_keys = raw.camera.keys().given.map(toml::Spanned::span);
    let sensor = source.sensor(&raw.sensor)?;
    let camera = source.camera(&raw.camera, !orbits.is_empty(), sensor.as_ref())?;
    let earth = source.earth(&raw.earth)?;
    let mut notices = deprecated(&raw.earth);
    let sky = source.sky(&raw.sky, &earth)?;
    let (aperture, ghosts) = source.lens_table(&raw.lens, &sky)?;
    let time = source.time(&raw.time)?;
    if orbits.is_empty() && camera.mode != CameraMode::Geodetic {
        // The space station, with built-in elements.
        orbits.push(RawOrbit::default());
    }
    let has_coverage = raw.coverage.show().is_given();
    let checked = orbits
        .iter()
        .map(|orbit| source.orbit(orbit, &raw.tracks, time.start, has_coverage))
        .collect::<Result<Vec<_>, _>>()?;
    source.live_together(&orbits, &checked)?;
    source.basilisk_alone(&orbits, &checked)?;
    let has_live = checked.iter().any(Orbit::is_simulated);
    if let Some(keys) = raw_keys {
        if sensor.is_some() && camera.keys.iter().any(|key| key.fov_deg.is_some()) {
            let advice = "a keyframe sets fov_deg, and the focal length of [sensor] gives the field of view; leave one of them out";
            return Err(source.reject_at("camera", "keys", keys, advice));
        }
        if has_live {
            let advice = "keyframes have times of the scene, and here a simulator gives the time; leave them out";
            return Err(source.reject_at("camera", "keys", keys, advice));
        }
        let exposure = raw.output.exposure_ev().given;
        let exposure = exposure.filter(|_| camera.keys.iter().any(|key| key.exposure_ev.is_some()));
        if exposure.is_some_and(|ev| ev.get_ref().as_str() == Some("auto")) {
            let advice = "a keyframe sets exposure_ev, and [output] has exposure_ev = \"auto\"; leave one of them out";
            return Err(source.reject_at("camera", "keys", keys, advice));
        }
        if exposure.is_some() {
            notices.push(
                "[output] exposure_ev: without effect, as keyframes of the camera set it; leave one of them out"
                    .into(),
            );
        }
    }
    let track_px = source.tracks(&raw.tracks, !checked.is_empty(), has_coverage)?;
    let layers = source.layers(&raw.layers)?;
    let raw_stations = raw.station.0;
    let stations = source.stations(&raw_stations)?;
    let raw_geojson = raw.geojson.0;
    let geojson = source.geojson(&raw_geojson)?;
    let coverage = source.coverage(&raw.coverage, &checked)?;
    let raw_captions = raw.caption.0;
    let captions = source.captions(&raw_captions, !checked.is_empty())?;
    let output = source.output(&raw.output, &camera, sensor.as_ref(), &earth, &checked)?;
    let quality = source.quality(&raw.quality)?;
    let records = [
        ("time", raw.time.record(source)),
        ("tracks", raw.tracks.record(source)),
        ("layers", raw.layers.record(source)),
        ("coverage", raw.coverage.record(source)),
        ("camera", raw.camera.record(source)),
        ("sensor", raw.sensor.record(source)),
        ("earth", raw.earth.record(source)),
        ("sky", raw.sky.record(source)),
        ("lens", raw.lens.record(source)),
        ("output", raw.output.record(source)),
        ("quality", raw.quality.record(source)),
    ];
    let orbit_records = orbits.into_iter().map(|orbit| orbit.record(source));
    let stations_read = raw_stations.into_iter();
    let geojson_read = raw_geojson.into_iter();
    let captions_read = raw_captions.into_iter();
    let lists: [(_, Vec<_>); _] = [
        (
            "station",
            stations_read.map(|one| one.record(source)).collect(),
        ),
        (
            "geojson",
            geojson_read.map(|one| one.record(source)).collect(),
        ),
        (
            "caption",
            captions_read.map(|one| one.record(source)).collect(),
        ),
    ];
    Ok(Scene {
        path: source.path.to_owned(),
        time,
        orbits: checked,
        notices,
        track_px,
        stations,
        layers,
        geojson,
        coverage,
        camera,
        sensor,
        earth,
        sky,
        aperture,
        ghosts,
        captions,
        output,
        quality,
        records: records.into(),
        orbit_records: orbit_records.collect(),
        orbit_tables: Vec::new(),
        lists: lists.into(),
        text: None,
        settings: Vec::new(),
    })
}

/// Notices for the given keys that `look` has replaced.
fn deprecated(earth: &RawEarth) -> Vec<String> {
    let given = [
        ("shading", earth.shading().is_given()),
        ("visibility", earth.visibility().is_given()),
        ("levels", earth.levels().is_given()),
    ];
    let given = given.into_iter().filter(|(_, is_given)| *is_given);
    given
        .map(|(key, _)| {
            format!(
                "[earth] {key}: deprecated, and an error from version 0.2 on; look = \"paper\" chooses shading, visibility and levels of the 2011 paper"
            )
        })
        .collect()
}
