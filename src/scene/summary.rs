//! What a scene comes to: every value and where it is from, what will be used and what is left out.

use super::dates::utc;
use super::error::printable;
use super::field::written;
use super::raw::{TABLES, Table};
use super::{CameraMode, PackTable, ReliefTable, Scene, orbit_summary, surfaces};
use crate::air::Atmosphere;
use crate::globe::{LevelRule, Subdivision, SurfaceSettings};
use std::fmt::Write;

impl Scene {
    /// The scene in words, many lines, each ended: every key in scene order with its value and whether that is
    /// from the file or the default; then what the scene uses and what it leaves out.
    pub fn summary(&self) -> String {
        let mut out = format!("{}: good\n", self.path.display());
        for table in TABLES {
            let head = match table.name {
                "orbit" if self.orbits.len() > 1 => "[[orbit]]".to_owned(),
                name => format!("[{name}]"),
            };
            line(&mut out, format_args!("\n{head}"));
            for key in table.keys {
                let common = || match table.name {
                    "orbit" => self.line("tracks", key.name),
                    _ => None,
                };
                let from = match self.line(table.name, key.name).or_else(common) {
                    Some(number) => format!("line {number} of the file"),
                    None => "default".to_owned(),
                };
                match self.value(table.name, key.name) {
                    Ok(value) => line(
                        &mut out,
                        format_args!("  {:<18} {value:<28} {from}", key.name),
                    ),
                    Err(why) => line(&mut out, format_args!("  {:<18} not used: {why}", key.name)),
                }
            }
            if table.name == "orbit" {
                self.other_orbits(&mut out, table);
            }
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

    /// Satellites after the first: only what they use.
    fn other_orbits(&self, out: &mut String, table: &Table) {
        for (index, orbit) in self.orbits.iter().enumerate().skip(1) {
            line(out, format_args!("\n[[orbit]]"));
            for key in table.keys {
                let line_of = self.orbit_line(index, key.name);
                let from = match line_of.or_else(|| self.line("tracks", key.name)) {
                    Some(number) => format!("line {number} of the file"),
                    None => "default".to_owned(),
                };
                if let Ok(value) = orbit_summary::value(orbit, key.name) {
                    line(out, format_args!("  {:<18} {value:<28} {from}", key.name));
                }
            }
        }
    }

    /// A key's value as a scene would write it, or why it has none.
    fn value(&self, table: &str, key: &str) -> Result<String, &'static str> {
        const NO_ORBIT: &str = "the camera stands over a place on the ground";
        const FLYING: &str = "only for mode = \"geodetic\"";
        let (time, camera, earth) = (&self.time, &self.camera, &self.earth);
        let place = |degrees: f64| match camera.mode {
            CameraMode::Geodetic => Ok(degrees.to_string()),
            _ => Err(FLYING),
        };
        let quoted = |text: &str| Ok(format!("\"{}\"", printable(text)));
        match (table, key) {
            ("time", "start") => quoted(&utc(time.start)),
            ("time", "duration_s") => Ok(time.duration_s.to_string()),
            ("time", "speed") => Ok(time.speed.to_string()),
            ("time", "frame_rate_hz") => Ok(time.frame_rate_hz.to_string()),
            ("time", "orientation") => match &time.orientation {
                Some(file) => quoted(&file.display().to_string()),
                None => Err("UT1 is taken as UTC and polar motion as none"),
            },
            ("orbit", key) => {
                let orbit = self.orbits.first().ok_or(NO_ORBIT)?;
                orbit_summary::value(orbit, key)
            }
            ("tracks", key) => self.tracks_value(key),
            ("camera", "follow") => match &camera.follow {
                Some(name) => quoted(name),
                None if self.orbits.is_empty() => Err(NO_ORBIT),
                None => Err("the first satellite is flown with"),
            },
            ("camera", "mode") => quoted(&written(&camera.mode)),
            ("camera", "up") => match camera.mode {
                CameraMode::Nadir => quoted(&written(&camera.up)),
                _ => Err("only for mode = \"nadir\""),
            },
            ("camera", "fov_deg") => Ok(camera.fov_deg.to_string()),
            ("camera", "lat_deg") => place(camera.lat_deg),
            ("camera", "lon_deg") => place(camera.lon_deg),
            ("camera", "height_km") => place(camera.height_km),
            ("camera", "heading_deg") => place(camera.heading_deg),
            ("camera", "pitch_deg") => place(camera.pitch_deg),
            ("earth", "figure") => quoted(&written(&earth.figure)),
            ("earth", "subdivision") => match earth.subdivision {
                Subdivision::Auto => quoted("auto"),
                cells => Ok(cells.to_string()),
            },
            ("earth", "visibility") => quoted(&written(&earth.visibility)),
            ("earth", "shading") => quoted(&written(&earth.shading)),
            ("earth", "clouds") => Ok(earth.clouds.to_string()),
            ("earth", "normals") => Ok(earth.normals.to_string()),
            ("earth", "night_lights") => Ok(earth.night_lights.to_string()),
            ("earth", "atmosphere") => quoted(&written(&earth.atmosphere)),
            ("earth", "textures") => match &earth.textures {
                Some(folder) => quoted(&folder.display().to_string()),
                None if earth.pack.is_some() => Err("the pack is taken"),
                None => Err("the starter pack is taken"),
            },
            (
                "earth",
                "pack" | "water" | "levels" | "texel_px" | "storage" | "texture_mb" | "upload_mb",
            ) => match &earth.pack {
                Some(pack) => pack_value(pack, key),
                None => Err("no pack: whole maps are drawn"),
            },
            (
                "earth",
                "surface" | "elevation" | "tolerance_px" | "sea_floor" | "denoise" | "clipmap"
                | "contours" | "projected_grid",
            ) => relief_value(earth.relief.as_ref(), key),
            ("output", "size") => {
                let [width, height] = self.output.size;
                Ok(format!("[{width}, {height}]"))
            }
            ("output", "samples") => Ok(self.output.samples.to_string()),
            ("output", "wait_s") => match earth.pack {
                None if !self.is_live() => Err("no pack: nothing to wait for"),
                _ => Ok(self.output.wait_s.to_string()),
            },
            ("quality", "target_ms") => match self.quality {
                Some(quality) => Ok(quality.target_ms.to_string()),
                None => Err("everything is drawn however long it takes"),
            },
            // A test holds that no known key comes here.
            _ => Err("unknown to the summary"),
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
                "UT1 and polar motion of {}; what that leaves out is 5 cm on the ground, more where it predicts",
                file.display()
            ),
            None => "UT1 taken as UTC, no polar motion: between the stars and the ground places are up to 420 m off at the \
                 equator by the first and 20 m by the second; give a table by orientation in [time]"
                .to_owned(),
        }));
        uses.extend(self.orbit_uses());
        uses.extend(self.track_uses());
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
        uses.push((
            "camera",
            format!("{eye}; {}° from bottom to top", camera.fov_deg),
        ));
        let maps = match (&self.earth.pack, &self.earth.textures) {
            (Some(pack), _) => format!("the pack {}, those that it has", pack.folder.display()),
            (None, Some(folder)) => folder.display().to_string(),
            (None, None) => "the starter pack".to_owned(),
        };
        let layers: Vec<_> = self.layers().into_iter().filter(|(_, on)| *on).collect();
        let names: Vec<_> = layers.iter().map(|(name, _)| *name).collect();
        uses.push(("layers", format!("{} from {maps}", names.join(", "))));
        if let Some(relief) = &self.earth.relief {
            let files = match relief.elevation.len() {
                0 => "the starter pack's heights".to_owned(),
                1 => "one file of heights".to_owned(),
                count => format!("{count} files of heights"),
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
        if self.earth.atmosphere != Atmosphere::None {
            uses.push(("air", written(&self.earth.atmosphere)));
        }
        uses
    }

    /// The layers in the order in which they are drawn, and whether each is on.
    fn layers(&self) -> Vec<(&'static str, bool)> {
        let mut layers = vec![
            ("day map", true),
            ("clouds", self.earth.clouds),
            ("normals", self.earth.normals),
            ("night lights", self.earth.night_lights),
        ];
        layers.extend(
            self.earth
                .pack
                .as_ref()
                .map(|pack| ("sea glint", pack.water)),
        );
        layers
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

/// The value of one of the keys of relief.
fn relief_value(relief: Option<&ReliefTable>, key: &str) -> Result<String, &'static str> {
    let Some(relief) = relief else {
        return match key {
            "surface" => Ok("\"blocks\"".to_owned()),
            _ => Err("the smooth ellipsoid is drawn"),
        };
    };
    Ok(match key {
        "surface" => format!("\"{}\"", written(&relief.surface)),
        "elevation" if relief.elevation.is_empty() => {
            return Err("the starter pack's heights are taken");
        }
        "elevation" => {
            let files = relief.elevation.iter();
            let files = files.map(|file| format!("\"{}\"", printable(&file.display().to_string())));
            format!("[{}]", files.collect::<Vec<_>>().join(", "))
        }
        "tolerance_px" => relief.tolerance_px.to_string(),
        "sea_floor" => relief.sea_floor.to_string(),
        "denoise" => relief.denoise.to_string(),
        _ => return surfaces::value(&relief.settings, key),
    })
}

/// The value of one of the pack's keys.
fn pack_value(pack: &PackTable, key: &str) -> Result<String, &'static str> {
    Ok(match key {
        "pack" => format!("\"{}\"", printable(&pack.folder.display().to_string())),
        "water" => pack.water.to_string(),
        "levels" => format!("\"{}\"", written(&pack.levels)),
        "texel_px" if pack.levels == LevelRule::Paper => {
            return Err("only for levels = \"screen\"");
        }
        "texel_px" => pack.texel_px.to_string(),
        "storage" => format!("\"{}\"", written(&pack.storage)),
        "texture_mb" => pack.texture_mb.to_string(),
        _ => pack.upload_mb.to_string(),
    })
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
        let summary = Scene::from_toml("", Path::new("scene.toml")).map(|scene| scene.summary());
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

    /// The first scene that a newcomer opens explains every key.
    #[test]
    fn the_default_scene_shows_every_key() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("config/iss.toml");
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
