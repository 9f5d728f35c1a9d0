//! The scene table by table: each key's range, its default, and what contradicts what.

use super::error::SceneError;
use super::field::{Field, Wanted, field, flag, in_range, span_of, written};
use super::limits::*;
use super::locate::Source;
use super::raw::{RawCamera, RawEarth, RawOrbit, RawOutput, RawQuality, RawScene, RawTime};
use super::{
    Camera, CameraMode, CameraUp, EarthTable, Lines, Orbit, Output, PackTable, QualityTable, Scene,
    StorageChoice, Time,
};
use crate::air::Atmosphere;
use crate::frames::{Epoch, utc_from_rfc3339};
use crate::globe::{Figure, LevelRule, Shading, Subdivision, Visibility};
use std::ops::RangeInclusive;
use toml::Spanned;

/// Checks a whole scene.
pub(super) fn check(source: Source<'_>, raw: RawScene) -> Result<Scene, SceneError> {
    let time = raw.time.unwrap_or_default();
    let orbits = raw.orbit.map(|orbits| orbits.0).unwrap_or_default();
    let tracks = raw.tracks.unwrap_or_default();
    let camera = raw.camera.unwrap_or_default();
    let earth = raw.earth.unwrap_or_default();
    let output = raw.output.unwrap_or_default();
    let quality = raw.quality.unwrap_or_default();

    let mut lines = Lines::default();
    for (table, given) in [
        ("time", time.given()),
        (
            "orbit",
            orbits.first().map_or_else(Vec::new, RawOrbit::given),
        ),
        ("tracks", tracks.given()),
        ("camera", camera.given()),
        ("earth", earth.given()),
        ("output", output.given()),
        ("quality", quality.given()),
    ] {
        for (key, span) in given {
            lines.insert(table, key, source.line(span.start));
        }
    }

    let orbit_lines = orbits.iter().map(|orbit| {
        let mut lines = Lines::default();
        for (key, span) in orbit.given() {
            lines.insert("orbit", key, source.line(span.start));
        }
        lines
    });
    let orbit_lines = orbit_lines.collect();

    let follow = camera.follow.as_ref();
    if let Some(follow) = follow.filter(|_| orbits.is_empty()) {
        let advice = "follow names one of the scene's own satellites and it has none; give it an [orbit] table, or leave follow out";
        return Err(source.refuse_at("camera", "follow", follow.span(), advice));
    }
    let camera = source.camera(&camera)?;
    let earth = source.earth(&earth)?;
    let time = source.time(&time)?;
    if let Some(orbit) = orbits.get(MAX_ORBITS) {
        let advice = format!("a scene has at most {MAX_ORBITS} satellites; leave some out");
        let field = field!(orbit.source);
        return Err(source.refuse(&field, advice));
    }
    let mut checked = orbits
        .iter()
        .map(|orbit| source.orbit(orbit, &tracks, time.start))
        .collect::<Result<Vec<_>, _>>()?;
    source.live_together(&orbits, &checked)?;
    let has_live = checked.iter().any(|orbit| orbit.live.is_some());
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
        track_px,
        output: source.output(&output, &camera, &earth, has_live)?,
        camera,
        quality: source.quality(&quality)?,
        earth,
        lines,
    })
}

impl Source<'_> {
    fn time(&self, time: &RawTime) -> Result<Time, SceneError> {
        let start_field = field!(time.start);
        let default_start =
            utc_from_rfc3339(DEFAULT_START).map_err(|error| self.refuse(&start_field, error))?;
        let start = self.instant(&start_field, default_start)?;
        let above_zero = f64::MIN_POSITIVE..=MAX_DURATION_S;
        let duration = field!(time.duration_s);
        let duration_s = self.number(&duration, DEFAULT_DURATION_S, above_zero, |_| {
            format!("must be more than 0 and at most {MAX_DURATION_S} seconds")
        })?;
        let speed_field = field!(time.speed);
        let speed = self.number(&speed_field, DEFAULT_SPEED, -MAX_SPEED..=MAX_SPEED, |_| {
            format!("must be from −{MAX_SPEED} to {MAX_SPEED} simulated seconds per second")
        })?;
        if speed == 0.0 {
            return Err(self.refuse(
                &speed_field,
                "a scene at speed 0 would never end; give 1 for real time, a negative speed to play backwards",
            ));
        }
        let rate = field!(time.frame_rate_hz);
        let frame_rate_hz = self.number(&rate, DEFAULT_FRAME_RATE_HZ, FRAME_RATE_HZ, |_| {
            format!("must be from {} frames per second", span_of(&FRAME_RATE_HZ))
        })?;
        let time = Time {
            start,
            duration_s,
            speed,
            frame_rate_hz,
            orientation: self.path(&field!(time.orientation), Wanted::File)?,
        };
        if time.frames_exact() > MAX_FRAMES {
            let advice = format!(
                "duration_s {duration_s} × frame_rate_hz {frame_rate_hz} / speed {} makes more than {MAX_FRAMES} frames; \
                 shorten the duration, lower the frame rate or raise the speed",
                speed.abs()
            );
            // With the default duration only slow motion comes here, so the field that is named is one that is given.
            let guilty = if speed.abs() < 1.0 {
                &speed_field
            } else {
                &duration
            };
            return Err(self.refuse(guilty, advice));
        }
        let (end_year, ..) = time.end().to_gregorian_utc();
        if !YEARS.contains(&end_year) {
            let advice = format!(
                "the flight would end in {end_year}; it must stay in the years {}",
                span_of(&YEARS)
            );
            return Err(match duration.is_given() {
                true => self.refuse(&duration, advice),
                false => self.refuse(&start_field, advice),
            });
        }
        Ok(time)
    }

    pub(super) fn instant(
        &self,
        field: &Field<'_, toml::Value>,
        default: Epoch,
    ) -> Result<Epoch, SceneError> {
        const ADVICE: &str = "write UTC like \"2018-01-15T12:00:00Z\"";
        let text = match field.given.map(Spanned::get_ref) {
            None => return Ok(default),
            Some(toml::Value::String(text)) => text.clone(),
            Some(toml::Value::Datetime(when)) => {
                let mut when = *when;
                if when.date.is_none() || when.time.is_none() || when.offset.is_none() {
                    let advice =
                        format!("must have a date, a time of day and the zone Z; {ADVICE}");
                    return Err(self.refuse(field, advice));
                }
                // TOML lets the seconds be left out, RFC 3339 does not.
                if let Some(time) = &mut when.time {
                    time.second.get_or_insert(0);
                }
                when.to_string()
            }
            Some(_) => {
                return Err(
                    self.refuse(field, format!("must be a date and a time of day; {ADVICE}"))
                );
            }
        };
        utc_from_rfc3339(&text).map_err(|error| self.refuse(field, error))
    }

    fn camera(&self, camera: &RawCamera) -> Result<Camera, SceneError> {
        let (lat, lon, height) = (
            field!(camera.lat_deg),
            field!(camera.lon_deg),
            field!(camera.height_km),
        );
        let (heading, pitch) = (field!(camera.heading_deg), field!(camera.pitch_deg));
        let stands = [&lat, &lon, &height, &heading, &pitch]
            .into_iter()
            .find(|field| field.is_given());
        let default_mode = match stands {
            Some(_) => CameraMode::Geodetic,
            None => CameraMode::Nadir,
        };
        let mode = self.choice(&field!(camera.mode), default_mode)?;
        if let Some(field) = stands
            && mode != CameraMode::Geodetic
        {
            let advice = format!(
                "{} has no meaning with mode = \"{}\", where the eye is the satellite's; leave it out or write mode = \"geodetic\"",
                field.key,
                written(&mode)
            );
            return Err(self.refuse(field, advice));
        }
        let up = field!(camera.up);
        if up.is_given() && mode != CameraMode::Nadir {
            let advice = format!(
                "up has no meaning with mode = \"{}\"; leave it out or write mode = \"nadir\"",
                written(&mode)
            );
            return Err(self.refuse(&up, advice));
        }
        let up = self.choice(&up, CameraUp::default())?;
        let fov_deg = self.number(&field!(camera.fov_deg), DEFAULT_FOV_DEG, FOV_DEG, |_| {
            format!(
                "the field of view must be more than 0 and less than 180 degrees (from {})",
                span_of(&FOV_DEG)
            )
        })?;
        let lat_deg = self.number(&lat, 0.0, LAT_DEG, |_| {
            format!("must be from {} degrees, south negative", span_of(&LAT_DEG))
        })?;
        let lon_deg = self.number(&lon, 0.0, LON_DEG, |_| {
            format!("must be from {} degrees, west negative", span_of(&LON_DEG))
        })?;
        let height_km = self.number(&height, DEFAULT_HEIGHT_KM, HEIGHT_KM, |height_km| {
            let why = match height_km {
                h if h < 0.0 => "the eye would be inside the Earth",
                h if h < *HEIGHT_KM.start() => "the eye would stand in the surface it looks at",
                _ => "nothing would be seen from so far",
            };
            format!("{why}; must be from {} km", span_of(&HEIGHT_KM))
        })?;
        let heading_deg = self.number(&heading, 0.0, HEADING_DEG, |_| {
            format!(
                "must be from {} degrees, clockwise from north",
                span_of(&HEADING_DEG)
            )
        })?;
        let pitch_deg = self.number(&pitch, DEFAULT_PITCH_DEG, PITCH_DEG, |_| {
            format!(
                "must be from {} degrees: -90 looks straight down, 0 level",
                span_of(&PITCH_DEG)
            )
        })?;
        let follow_field = field!(camera.follow);
        let follow = follow_field.given.map(|name| name.get_ref().clone());
        if follow.as_ref().is_some_and(|name| name.trim().is_empty()) {
            let advice = "must not be empty; give the name of a satellite of the scene, or leave follow out for the first";
            return Err(self.refuse(&follow_field, advice));
        }
        Ok(Camera {
            mode,
            follow,
            up,
            fov_deg,
            lat_deg,
            lon_deg: half_turn(lon_deg),
            height_km,
            heading_deg,
            pitch_deg,
        })
    }

    fn earth(&self, earth: &RawEarth) -> Result<EarthTable, SceneError> {
        let shading = self.choice(&field!(earth.shading), Shading::default())?;
        let lights = field!(earth.night_lights);
        let night_lights = flag(&lights, shading == Shading::Sunlit);
        if night_lights && shading == Shading::Paper {
            let advice = "the paper's shading has no night lights; write false, leave it out, or take shading = \"sunlit\"";
            return Err(self.refuse(&lights, advice));
        }
        Ok(EarthTable {
            figure: self.choice(&field!(earth.figure), Figure::default())?,
            subdivision: self.subdivision(&field!(earth.subdivision))?,
            visibility: self.choice(&field!(earth.visibility), Visibility::default())?,
            shading,
            clouds: flag(&field!(earth.clouds), true),
            normals: flag(&field!(earth.normals), true),
            night_lights,
            atmosphere: self.choice(&field!(earth.atmosphere), Atmosphere::default())?,
            textures: self.path(&field!(earth.textures), Wanted::Folder)?,
            pack: self.pack(earth, shading)?,
            relief: self.relief(earth)?,
        })
    }

    fn pack(&self, earth: &RawEarth, shading: Shading) -> Result<Option<PackTable>, SceneError> {
        let folder = self.path(&field!(earth.pack), Wanted::Folder)?;
        let (water, levels, texel_px, storage) = (
            field!(earth.water),
            field!(earth.levels),
            field!(earth.texel_px),
            field!(earth.storage),
        );
        let (texture_mb, upload_mb) = (field!(earth.texture_mb), field!(earth.upload_mb));
        let Some(folder) = folder else {
            self.only_with_a_pack(&water)?;
            self.only_with_a_pack(&levels)?;
            self.only_with_a_pack(&texel_px)?;
            self.only_with_a_pack(&storage)?;
            self.only_with_a_pack(&texture_mb)?;
            self.only_with_a_pack(&upload_mb)?;
            return Ok(None);
        };
        let textures = field!(earth.textures);
        if textures.is_given() {
            let advice = "a scene draws a folder of maps or a pack; leave out textures or pack";
            return Err(self.refuse(&textures, advice));
        }
        if shading == Shading::Paper && flag(&water, false) {
            let advice = "the paper's shading has no glint; write false, leave it out, or take shading = \"sunlit\"";
            return Err(self.refuse(&water, advice));
        }
        let rule = self.choice(&levels, LevelRule::default())?;
        if rule == LevelRule::Paper && texel_px.is_given() {
            let advice = "texel_px has no meaning with levels = \"paper\", where distances alone decide; leave it out or write levels = \"screen\"";
            return Err(self.refuse(&texel_px, advice));
        }
        let within = |range: RangeInclusive<f64>, unit: &'static str| {
            move |_| format!("must be from {} {unit}", span_of(&range))
        };
        let (px, mb, frame_mb) = (TEXEL_PX, TEXTURE_MB, UPLOAD_MB);
        Ok(Some(PackTable {
            folder,
            water: flag(&water, shading == Shading::Sunlit),
            levels: rule,
            texel_px: self.number(
                &texel_px,
                DEFAULT_TEXEL_PX,
                px.clone(),
                within(px, "screen pixels a texel"),
            )?,
            storage: self.choice(&storage, StorageChoice::default())?,
            texture_mb: self.number(
                &texture_mb,
                DEFAULT_TEXTURE_MB,
                mb.clone(),
                within(mb, "megabytes"),
            )?,
            upload_mb: self.number(
                &upload_mb,
                DEFAULT_UPLOAD_MB,
                frame_mb.clone(),
                within(frame_mb, "megabytes a frame"),
            )?,
        }))
    }

    fn only_with_a_pack<T>(&self, field: &Field<'_, T>) -> Result<(), SceneError> {
        if !field.is_given() {
            return Ok(());
        }
        let advice = format!(
            "{} is for imagery packs; leave it out, or name the pack's folder by pack = \"…\"",
            field.key
        );
        Err(self.refuse(field, advice))
    }

    pub(super) fn subdivision(
        &self,
        field: &Field<'_, toml::Value>,
    ) -> Result<Subdivision, SceneError> {
        let cells = match field.given.map(Spanned::get_ref) {
            None => return Ok(Subdivision::Auto),
            Some(toml::Value::String(text)) if text == "auto" => return Ok(Subdivision::Auto),
            Some(toml::Value::Integer(cells)) => in_range(*cells, &SUBDIVISION),
            Some(_) => None,
        };
        cells.map(Subdivision::Cells).ok_or_else(|| {
            let advice = format!(
                "must be \"auto\" or from {} cells per block edge",
                span_of(&SUBDIVISION)
            );
            self.refuse(field, advice)
        })
    }

    fn output(
        &self,
        output: &RawOutput,
        camera: &Camera,
        earth: &EarthTable,
        has_live: bool,
    ) -> Result<Output, SceneError> {
        let size_field = field!(output.size);
        let size = match size_field.given.map(|given| given.get_ref().as_slice()) {
            None => DEFAULT_SIZE_PX,
            Some(&[width, height]) => match (in_range(width, &SIDE_PX), in_range(height, &SIDE_PX))
            {
                (Some(width), Some(height)) => [width, height],
                _ => {
                    let advice = format!(
                        "width and height must each be from {} pixels",
                        span_of(&SIDE_PX)
                    );
                    return Err(self.refuse(&size_field, advice));
                }
            },
            Some(other) => {
                let advice = format!("must be two numbers, [width, height], not {}", other.len());
                return Err(self.refuse(&size_field, advice));
            }
        };
        let samples_field = field!(output.samples);
        let samples = match samples_field.given.map(|given| *given.get_ref()) {
            // The air hides the limb's edge; a craft's edges and a bare limb are seen.
            None if camera.mode == CameraMode::Chase || earth.atmosphere == Atmosphere::None => {
                EDGE_SAMPLES
            }
            None => 1,
            Some(count) => u32::try_from(count)
                .ok()
                .filter(|count| SAMPLES.contains(count))
                .ok_or_else(|| {
                    let advice = "must be 1 (edges as they fall) or 4 (smooth edges), the counts that every adapter can do";
                    self.refuse(&samples_field, advice)
                })?,
        };
        let wait = field!(output.wait_s);
        if earth.pack.is_none() && !has_live {
            self.only_with_a_pack(&wait)?;
        }
        let wait_s = self.number(&wait, DEFAULT_WAIT_S, WAIT_S, |_| {
            format!("must be from {} seconds", span_of(&WAIT_S))
        })?;
        Ok(Output {
            size,
            samples,
            wait_s,
        })
    }
}

impl Source<'_> {
    fn quality(&self, quality: &RawQuality) -> Result<Option<QualityTable>, SceneError> {
        let target = field!(quality.target_ms);
        if !target.is_given() {
            return Ok(None);
        }
        // The default is not looked at where a value is given.
        let target_ms = self.number(&target, *TARGET_MS.end(), TARGET_MS, |_| {
            format!(
                "must be from {} milliseconds (16.7 is 60 frames per second)",
                span_of(&TARGET_MS)
            )
        })?;
        Ok(Some(QualityTable { target_ms }))
    }
}

/// A longitude of −360…360 in −180…180, exact where it is there already.
fn half_turn(lon_deg: f64) -> f64 {
    match lon_deg {
        lon if lon > 180.0 => lon - 360.0,
        lon if lon < -180.0 => lon + 360.0,
        lon => lon,
    }
}
