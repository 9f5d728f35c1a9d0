//! Summary of a scene: every value with its source, and what is used and omitted.

use super::Scene;
use super::captions::NO_CAPTION;
use super::choices::CameraMode;
use super::error::printable;
use super::field::{NO_ORBIT, written};
use super::geojson::NO_GEOJSON;
use super::keys::TABLES;
use super::orbit_check::foreign;
use super::record::Record;
use super::stations::NO_STATION;
use super::table::{Key, Table};
use super::time::{StartSource, utc};
use std::fmt::Write;
use terrella_ground::air::Atmosphere;
use terrella_ground::globe::SurfaceSettings;

/// Why a key has no value if no reader recorded it. A test ensures that this never appears.
const UNKNOWN: &str = "unknown to the summary";

impl Scene {
    /// The scene as text, with a line break after every line. First come the effective keys in scene order, each with its
    /// value and whether it is from the file or a default. Keys of the file without effect follow, and then what the scene
    /// uses and omits. Values are those read from the scene: fields that a host sets later do not change them.
    pub fn summary(&self) -> String {
        self.summary_of(false)
    }

    /// The same with every possible key; unused ones have a reason.
    pub fn full_summary(&self) -> String {
        self.summary_of(true)
    }

    fn summary_of(&self, all: bool) -> String {
        let mut out = format!("{}: good\n", self.path.display());
        let mut hidden = 0;
        for table in TABLES {
            let is_shown = |key: &Key| {
                all || self.value(table, key).is_ok() || self.line(table.name, key.name).is_some()
            };
            let shown = table.keys.iter().filter(|key| is_shown(key)).count();
            hidden += table.keys.len() - shown;
            if shown == 0 {
                continue;
            }
            let head = match table.name {
                "orbit" if self.orbit_records.len() > 1 => "[[orbit]]".to_owned(),
                name if self.list(name).len() > 1 => format!("[[{name}]]"),
                name => format!("[{name}]"),
            };
            line(&mut out, format_args!("\n{head}"));
            for key in table.keys.iter().filter(|key| is_shown(key)) {
                let common = || match table.name {
                    "orbit" => self.line("tracks", key.name),
                    _ => None,
                };
                let from = match self.line(table.name, key.name).or_else(common) {
                    _ if self.is_set(table.name, key.name) => "--set".to_owned(),
                    Some(number) => format!("line {number} of the file"),
                    None => self.default_from(table.name, key.name).to_owned(),
                };
                let from = match (table.name, key.name) {
                    ("time", "start") => self.start_from(from),
                    _ => from,
                };
                match self.value(table, key) {
                    Ok(value) => line(
                        &mut out,
                        format_args!("  {:<18} {value:<28} {from}", key.name),
                    ),
                    Err(why) => {
                        let given = match self.line(table.name, key.name) {
                            Some(number) => format!("line {number} of the file is "),
                            None => String::new(),
                        };
                        line(
                            &mut out,
                            format_args!("  {:<18} {given}not used: {why}", key.name),
                        );
                    }
                }
            }
            match table.name {
                "orbit" => self.other_orbits(&mut out, table),
                _ => self.others(&mut out, table),
            }
        }
        if hidden > 0 {
            line(
                &mut out,
                format_args!(
                    "\n{hidden} more keys have no effect in this scene (--all lists them)"
                ),
            );
        }
        if !self.notices.is_empty() {
            line(&mut out, format_args!("\nnotice"));
        }
        for notice in &self.notices {
            line(&mut out, format_args!("  {notice}"));
        }
        line(&mut out, format_args!("\nuses"));
        for (what, how) in self.uses() {
            line(&mut out, format_args!("  {what:<14} {how}"));
        }
        line(&mut out, format_args!("\nleaves out"));
        let left_out = self.leaves_out();
        if left_out.is_empty() {
            line(&mut out, format_args!("  nothing"));
        }
        for what in left_out {
            line(
                &mut out,
                format_args!("  {what}: off: not loaded, not in the shader"),
            );
        }
        out
    }

    /// The source of a value that the file does not give.
    fn default_from(&self, table: &str, key: &str) -> &'static str {
        match self.is_of_orbits() {
            false => "default",
            true if table == "orbit"
                && ["source", "file", "name", "all", "strict"].contains(&key) =>
            {
                "the command line"
            }
            true => "the built-in scene",
        }
    }

    /// The source of the scene's start; `place` is the location of its key.
    fn start_from(&self, place: String) -> String {
        match &self.time.start_from {
            StartSource::Given | StartSource::Default => place,
            StartSource::Clock => format!("{place}, \"now\""),
            StartSource::Caller => "the command line".to_owned(),
            StartSource::Satellite(from) => printable(from),
        }
    }

    /// Tables after the first: only their used keys.
    fn other_orbits(&self, out: &mut String, table: &Table) {
        for (index, _) in self.first_of_tables().into_iter().skip(1) {
            line(out, format_args!("\n[[orbit]]"));
            for key in table.keys {
                let line_of = self.orbit_line(index, key.name);
                let from = match line_of.or_else(|| self.line("tracks", key.name)) {
                    Some(number) => format!("line {number} of the file"),
                    None => self.default_from(table.name, key.name).to_owned(),
                };
                if let Ok(value) = self.orbit_value(index, key) {
                    line(out, format_args!("  {:<18} {value:<28} {from}", key.name));
                }
            }
        }
    }

    /// The records of a list other than that of satellites.
    fn list(&self, table: &str) -> &[Record] {
        self.lists.get(table).map_or(&[], Vec::as_slice)
    }

    /// The tables of a list after the first.
    fn others(&self, out: &mut String, table: &Table) {
        for record in self.list(table.name).iter().skip(1) {
            line(out, format_args!("\n[[{}]]", table.name));
            for key in table.keys {
                let from = match record.line(key.name) {
                    Some(number) => format!("line {number} of the file"),
                    None => "default".to_owned(),
                };
                if let Ok(value) = recorded(Some(record), key) {
                    line(out, format_args!("  {:<18} {value:<28} {from}", key.name));
                }
            }
        }
    }

    /// The effective value of a key.
    fn value(&self, table: &Table, key: &Key) -> Result<&str, &'static str> {
        let record = match table.name {
            "orbit" => return self.orbit_value(0, key),
            name => match self.lists.get(name) {
                Some(records) => Some(records.first().ok_or(none_of(name))?),
                None => self.records.get(name),
            },
        };
        recorded(record, key)
    }

    /// The same for the satellite at this index.
    fn orbit_value(&self, index: usize, key: &Key) -> Result<&str, &'static str> {
        let orbit = self.orbits.get(index).ok_or(NO_ORBIT)?;
        match foreign(orbit.source, key) {
            Some(why) => Err(why),
            None => recorded(self.orbit_records.get(self.orbit_table(index)), key),
        }
    }

    fn uses(&self) -> Vec<(&'static str, String)> {
        let time = &self.time;
        let frames = time.frame_count();
        let length = format!(
            "{frames} frame{} in {:.1} s",
            if frames == 1 { "" } else { "s" },
            time.duration_s / time.speed.abs(),
        );
        let (start, end) = (utc(time.start), utc(time.end()));
        let mut uses = vec![(
            "playback",
            match self.is_live() {
                true => format!(
                    "the time that the simulator sends, {start} until it does; a film has at most {length}"
                ),
                false => format!("{start} to {end}, {length}"),
            },
        )];
        uses.push(("orientation", match &time.orientation {
            Some(file) => format!(
                "UT1 and polar motion of {}; the remaining error is 5 cm on the ground, more where the table is a prediction",
                file.display()
            ),
            None => "UT1 is set to UTC, which rotates the Earth by up to 420 m at the equator; polar motion is left out, which \
                 is up to 20 m; set orientation in [time] to a table of both"
                .to_owned(),
        }));
        uses.extend(self.orbit_uses());
        uses.extend(self.track_uses());
        uses.extend(self.station_uses());
        uses.extend(self.line_uses());
        uses.extend(self.geojson_uses());
        uses.extend(self.coverage_uses());
        let camera = &self.camera;
        let eye = match camera.mode {
            CameraMode::Nadir => format!(
                "at the satellite, straight down, {} upwards on screen",
                written(&camera.up)
            ),
            CameraMode::Horizon => "at the satellite, forwards to the horizon".to_owned(),
            CameraMode::Chase => "behind and above the satellite, looking at it".to_owned(),
            CameraMode::Geodetic => {
                let looks = match (camera.pitch_deg, camera.heading_deg) {
                    (-90.0, 0.0) => "straight down, north upwards on screen".to_owned(),
                    (-90.0, heading) => {
                        format!("straight down, {heading}° from north upwards on screen")
                    }
                    (pitch, heading) => {
                        format!("to {heading}° from north, {pitch}° above the horizontal")
                    }
                };
                format!(
                    "{} km above {}° latitude, {}° longitude, {looks}",
                    camera.height_km, camera.lat_deg, camera.lon_deg
                )
            }
        };
        let eye = match &camera.look_at {
            None => eye,
            Some(target) => format!("{eye}; turned to {}", target.words()),
        };
        uses.push((
            "camera",
            match camera.keys.len() {
                0 => format!("{eye}; {}° vertical field of view", camera.fov_deg),
                keys => format!(
                    "{eye}; {}° vertical field of view; its {keys} keyframes override these",
                    camera.fov_deg
                ),
            },
        ));
        if let Some(table) = &self.sensor {
            let (lens, radiometry) = (table.lens(), table.radiometry());
            let [width, height] = lens.size();
            uses.push((
                "sensor",
                format!(
                    "{width} × {height} pixels of {} µm behind {} mm at f/{}, {} s; raw frames by `terrella frame --raw`",
                    lens.pixel_pitch_um(),
                    lens.focal_length_mm(),
                    radiometry.f_number,
                    radiometry.exposure_s
                ),
            ));
        }
        let maps = match (&self.earth.pack, &self.earth.textures) {
            (Some(pack), _) => format!("the pack {}, those that it has", pack.folder.display()),
            (None, Some(folder)) => folder.display().to_string(),
            (None, None) => "the starter pack".to_owned(),
        };
        let layers: Vec<_> = self.layers().into_iter().filter(|(_, on)| *on).collect();
        let names: Vec<_> = layers.iter().map(|(name, _)| *name).collect();
        uses.push(("layers", format!("{} from {maps}", names.join(", "))));
        if self.earth.light.is_some_and(|light| light.detail) {
            let made = "synthesized between the maps' texels, not measured";
            uses.push(("detail", made.to_owned()));
        }
        if let Some(relief) = &self.earth.relief {
            let files = match relief.elevation.len() {
                0 if relief.pack_heights_mb.is_some() => "the pack's elevation data".to_owned(),
                0 => "the starter pack's elevation data".to_owned(),
                1 => "one elevation file".to_owned(),
                count => format!("{count} elevation files"),
            };
            let files = match relief.pack_heights_mb {
                Some(_) if !relief.elevation.is_empty() => format!("{files} over the pack's"),
                _ => files,
            };
            uses.push((
                "relief",
                match relief.settings {
                    SurfaceSettings::CastContours(_) => {
                        format!("contours from {files}, a ray cast at each pixel")
                    }
                    _ => format!("{} from {files}", written(&relief.surface)),
                },
            ));
        }
        uses.extend(self.caption_uses());
        if self.earth.atmosphere != Atmosphere::None {
            uses.push(("air", written(&self.earth.atmosphere)));
        }
        uses
    }

    /// The layers in drawing order, and whether each is on.
    fn layers(&self) -> Vec<(&'static str, bool)> {
        vec![
            ("day map", true),
            ("clouds", self.earth.clouds),
            ("normals", self.earth.normals),
            ("night lights", self.earth.night_lights),
            ("water", self.earth.water),
            ("seasons", self.earth.seasons),
        ]
    }

    fn leaves_out(&self) -> Vec<&'static str> {
        let mut names: Vec<_> = self
            .layers()
            .into_iter()
            .filter(|(_, on)| !on)
            .map(|(name, _)| name)
            .collect();
        if self.earth.atmosphere == Atmosphere::None {
            names.push("atmosphere");
        }
        names
    }
}

/// Why keys of an empty list have no value.
fn none_of(list: &str) -> &'static str {
    match list {
        "caption" => NO_CAPTION,
        "geojson" => NO_GEOJSON,
        _ => NO_STATION,
    }
}

fn recorded<'r>(record: Option<&'r Record>, key: &Key) -> Result<&'r str, &'static str> {
    match record.and_then(|record| record.value(key.name)) {
        Some(Ok(value)) => Ok(value),
        Some(Err(why)) => Err(why),
        None => Err(UNKNOWN),
    }
}

fn line(out: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(out, "{text}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn every_key_has_a_value_or_a_reason_in_the_summary() {
        let summary =
            Scene::from_toml("", Path::new("scene.toml")).map(|scene| scene.full_summary());
        let summary = summary.unwrap_or_else(|error| panic!("{error}"));
        assert!(!summary.contains("unknown"), "{summary}");
        for key in TABLES.iter().flat_map(|table| table.keys) {
            let wanted = format!("\n  {} ", key.name);
            assert!(
                summary.contains(&wanted),
                "{} is not in:\n{summary}",
                key.name
            );
        }
    }

    /// The first scene of a new user explains every key.
    #[test]
    fn the_default_scene_shows_every_key() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/iss.toml");
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{error}"));
        for key in TABLES.iter().flat_map(|table| table.keys) {
            let shown = text.lines().any(|line| {
                let line = line.trim_start_matches("# ");
                line.strip_prefix(key.name)
                    .is_some_and(|rest| rest.starts_with(" = "))
            });
            assert!(shown, "{} is not in {}", key.name, path.display());
        }
    }
}
