//! Scene files: what is refused and in which words, what is taken, what the defaults are.

mod orbits;
mod tracks;

use proptest::prelude::*;
use std::path::{Path, PathBuf};
use terrella::air::Atmosphere;
use terrella::earth::Shading;
use terrella::frames::{Epoch, utc_from_rfc3339};
use terrella::globe::clipmap::Trim;
use terrella::globe::{Figure, LevelRule, Subdivision, SurfaceKind, SurfaceSettings, Visibility};
use terrella::scene::{CameraMode, Scene, SceneError, StorageChoice};

/// A folder with what the scenes of these tests refer to: `sat.tle` and `maps/`.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let dir = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(dir.path().join("sat.tle"), "elements").expect("a file");
        std::fs::create_dir(dir.path().join("maps")).expect("a folder");
        Self(dir)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn load(&self, bytes: impl AsRef<[u8]>) -> Result<Scene, SceneError> {
        let path = self.path("scene.toml");
        std::fs::write(&path, bytes).expect("a scene file");
        Scene::load(&path)
    }

    /// Holds that each scene is refused where it is wrong, in one line that has the words.
    fn refuses(&self, bad: &[Bad]) {
        let file = self.path("scene.toml").display().to_string();
        let mut wrong = Vec::new();
        for (text, line, needles) in bad {
            let error = match self.load(text) {
                Ok(_) => {
                    wrong.push(format!("taken: {text:?}"));
                    continue;
                }
                Err(error) => error,
            };
            let message = error.to_string();
            println!("{}", message.replace(&file, "scene.toml"));
            let start = format!("{file}:{line}:");
            let mut lacks: Vec<&str> = needles.to_vec();
            lacks.retain(|needle| !message.contains(needle));
            if !message.starts_with(&start) || error.line() != Some(*line) {
                lacks.push(&start);
            }
            if message.chars().any(char::is_control) {
                lacks.push("one printable line");
            }
            if !lacks.is_empty() {
                wrong.push(format!("{text:?}\n  says {message}\n  without {lacks:?}"));
            }
            assert_eq!(error.path(), self.path("scene.toml"), "{error}");
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}

/// A scene without a file of its own.
fn scene(text: &str) -> Scene {
    match Scene::from_toml(text, Path::new("scene.toml")) {
        Ok(scene) => scene,
        Err(error) => panic!("refused: {error}"),
    }
}

fn utc(text: &str) -> Epoch {
    utc_from_rfc3339(text).unwrap_or_else(|error| panic!("{error}"))
}

/// Text, the line to be named, and what the message must hold: key, value, remedy.
type Bad = (&'static str, usize, &'static [&'static str]);

#[rustfmt::skip]
const BAD: &[Bad] = &[
    // Unknown names.
    ("\n[camera]\nfov = 45", 3, &["[camera] fov:", "did you mean fov_deg?", "height_km"]),
    ("[camera]\nFOV_DEG = 45", 2, &["[camera] FOV_DEG:", "did you mean fov_deg?"]),
    ("[camera]\nspeed = 45", 2, &["[camera] speed:", "belongs in [time]"]),
    ("[output]\nqwxz = 1", 2, &["[output] qwxz: unknown key.", "[output] has size, samples"]),
    ("[time]\n\n[camra]\nmode = \"nadir\"", 3, &["[camra]:", "did you mean [camera]?"]),
    ("[weather]\nrain = true", 1, &["[weather]: unknown table", "[time], [orbit], [tracks], [camera], [earth], [output]"]),
    ("fov_deg = 45\n[time]", 1, &["fov_deg:", "outside its table", "[camera]"]),
    ("cloud = false", 1, &["cloud: unknown key", "did you mean clouds in [earth]?"]),
    ("\"\\u001b[31m\" = 1", 1, &["\\u{1b}[31m: unknown key"]),
    ("[time.zone]\nname = \"CET\"", 1, &["[time] zone: unknown key"]),
    // Wrong types.
    ("[camera]\n# wide\nfov_deg = \"wide\"", 3, &["[camera] fov_deg = \"wide\"", "must be a number of degrees, not a string"]),
    ("[camera]\nfov_deg = true", 2, &["[camera] fov_deg = true", "must be a number of degrees"]),
    ("[camera]\nfov_deg = [45]", 2, &["[camera] fov_deg = [45]", "must be a number of degrees, not a list"]),
    ("[camera.fov_deg]\nx = 1", 1, &["[camera] fov_deg", "must be a number of degrees, not a table"]),
    ("[camera]\nmode = 1", 2, &["[camera] mode = 1", "must be a string", "\"nadir\", \"horizon\", \"chase\" or \"geodetic\""]),
    ("[earth]\nclouds = \"yes\"", 2, &["[earth] clouds = \"yes\"", "must be true or false, not a string"]),
    ("[earth]\nclouds = 1", 2, &["[earth] clouds = 1", "must be true or false"]),
    ("[earth]\nsubdivision = 6.5", 2, &["[earth] subdivision = 6.5", "must be \"auto\" or from 1 to 48"]),
    ("[earth]\nsubdivision = 99999999999999999999", 2, &["[earth] subdivision", "too large to be read"]),
    ("[time]\nspeed = 99999999999999999999", 2, &["[time] speed", "too large to be read"]),
    ("[time]\nspeed = 1e400", 2, &["[time] speed = 1e400", "too large to be read"]),
    ("[output]\nsize = \"1280x720\"", 2, &["[output] size = \"1280x720\"", "[width, height]"]),
    ("[output]\nsize = [1280,\n \"720\"]", 2, &["[output] size", "two whole numbers of pixels"]),
    ("[output]\nsize = [640.0, 360.0]", 2, &["[output] size", "two whole numbers of pixels"]),
    ("time = 5", 1, &["time = 5", "must be a table, not a whole number", "[time]"]),
    ("[[time]]\nspeed = 1", 1, &["time", "must be a table, not a list"]),
    ("[time]\nstart = 5", 2, &["[time] start = 5", "2018-01-15T12:00:00Z"]),
    ("[time.start]\nx = 1", 1, &["[time] start", "2018-01-15T12:00:00Z"]),
    // Not finite.
    ("[time]\nspeed = nan", 2, &["[time] speed = nan", "finite"]),
    ("[time]\nspeed = inf", 2, &["[time] speed = inf", "finite"]),
    ("[time]\nduration_s = nan", 2, &["[time] duration_s = nan", "finite"]),
    ("[time]\nframe_rate_hz = -inf", 2, &["[time] frame_rate_hz = -inf", "finite"]),
    ("[camera]\nfov_deg = nan", 2, &["[camera] fov_deg = nan", "finite"]),
    ("[camera]\nlat_deg = nan", 2, &["[camera] lat_deg = nan", "finite"]),
    ("[camera]\nlon_deg = inf", 2, &["[camera] lon_deg = inf", "finite"]),
    ("[camera]\nheight_km = nan", 2, &["[camera] height_km = nan", "finite"]),
    // Out of range.
    ("[camera]\nfov_deg = 0", 2, &["[camera] fov_deg = 0:", "must be more than 0 and less than 180 degrees", "0.001 to 179.999"]),
    ("[camera]\nfov_deg = 180", 2, &["[camera] fov_deg = 180:", "must be more than 0 and less than 180 degrees", "0.001 to 179.999"]),
    ("[camera]\nfov_deg = -45", 2, &["[camera] fov_deg = -45:", "must be more than 0"]),
    ("[camera]\nlat_deg = 91", 2, &["[camera] lat_deg = 91:", "must be from −90 to 90 degrees"]),
    ("[camera]\nlat_deg = -90.000001", 2, &["[camera] lat_deg = -90.000001:", "must be from −90 to 90 degrees"]),
    ("[camera]\nlon_deg = 361", 2, &["[camera] lon_deg = 361:", "must be from −360 to 360 degrees"]),
    ("[camera]\nheight_km = -5", 2, &["[camera] height_km = -5:", "inside the Earth", "0.001 to 1000000000 km"]),
    ("[camera]\nheight_km = 0", 2, &["[camera] height_km = 0:", "in the surface", "0.001 to 1000000000 km"]),
    ("[camera]\nheight_km = 2e9", 2, &["[camera] height_km = 2e9:", "0.001 to 1000000000 km"]),
    ("[camera]\npitch_deg = 91", 2, &["[camera] pitch_deg = 91:", "from −90 to 90 degrees", "straight down"]),
    ("[camera]\nheading_deg = 361", 2, &["[camera] heading_deg = 361:", "from −360 to 360 degrees", "clockwise from north"]),
    ("[camera]\nmode = \"chase\"\npitch_deg = 0", 3, &["[camera] pitch_deg = 0:", "no meaning with mode = \"chase\"", "mode = \"geodetic\""]),
    ("[earth]\nsubdivision = 0", 2, &["[earth] subdivision = 0:", "from 1 to 48"]),
    ("[earth]\nsubdivision = 49", 2, &["[earth] subdivision = 49:", "from 1 to 48"]),
    ("[earth]\nsubdivision = -6", 2, &["[earth] subdivision = -6:", "from 1 to 48"]),
    ("[output]\nsize = [0, 720]", 2, &["[output] size = [0, 720]:", "each be from 1 to 16384 pixels"]),
    ("[output]\nsize = [1280, 0]", 2, &["[output] size = [1280, 0]:", "each be from 1 to 16384 pixels"]),
    ("[output]\nsize = [100000, 720]", 2, &["[output] size = [100000, 720]:", "each be from 1 to 16384 pixels"]),
    ("[output]\nsize = [1280, 16385]", 2, &["[output] size = [1280, 16385]:", "each be from 1 to 16384 pixels"]),
    ("[output]\nsize = [-1280, 720]", 2, &["[output] size = [-1280, 720]:", "each be from 1 to 16384 pixels"]),
    ("[output]\nsize = [1280]", 2, &["[output] size = [1280]:", "two numbers, [width, height], not 1"]),
    ("[output]\nsize = [1280, 720, 3]", 2, &["[output] size = [1280, 720, 3]:", "two numbers, [width, height], not 3"]),
    ("[output]\nsamples = 2", 2, &["[output] samples = 2:", "must be 1", "or 4"]),
    ("[time]\nspeed = 0", 2, &["[time] speed = 0:", "never end"]),
    ("[time]\nspeed = -0.0", 2, &["[time] speed = -0.0:", "never end"]),
    ("[time]\nspeed = 1000001", 2, &["[time] speed = 1000001:", "−1000000 to 1000000"]),
    ("[time]\nduration_s = 0", 2, &["[time] duration_s = 0:", "more than 0"]),
    ("[time]\nduration_s = -60", 2, &["[time] duration_s = -60:", "more than 0"]),
    ("[time]\nduration_s = 2e9", 2, &["[time] duration_s = 2e9:", "at most 1000000000 seconds"]),
    ("[time]\nframe_rate_hz = 0.5", 2, &["[time] frame_rate_hz = 0.5:", "1 to 240 frames per second"]),
    ("[time]\nframe_rate_hz = 241", 2, &["[time] frame_rate_hz = 241:", "1 to 240 frames per second"]),
    ("[time]\nduration_s = 1e8", 2, &["[time] duration_s = 1e8:", "more than 10000000 frames", "shorten the duration"]),
    ("[time]\nspeed = -1e-9", 2, &["[time] speed = -1e-9:", "more than 10000000 frames", "raise the speed"]),
    // Dates.
    ("[time]\nstart = \"yesterday\"", 2, &["[time] start = \"yesterday\":", "2018-01-15T12:00:00Z"]),
    ("[time]\nstart = \"2018-02-30T12:00:00Z\"", 2, &["[time] start = \"2018-02-30T12:00:00Z\":", "is not a UTC date"]),
    ("[time]\nstart = 2018-01-15", 2, &["[time] start = 2018-01-15:", "a time of day", "2018-01-15T12:00:00Z"]),
    ("[time]\nstart = 2018-01-15T12:00:00", 2, &["[time] start = 2018-01-15T12:00:00:", "the zone Z"]),
    ("[time]\nstart = \"1066-10-14T09:00:00Z\"", 2, &["[time] start = \"1066-10-14T09:00:00Z\":", "1900 to 2099"]),
    ("[time]\nstart = \"2099-06-01T00:00:00Z\"\nduration_s = 1e9\nspeed = 1e6", 3, &["[time] duration_s = 1e9:", "1900 to 2099"]),
    ("[time]\nstart = 2099-12-31T23:00:00Z", 2, &["[time] start = 2099-12-31T23:00:00Z:", "end in 2100"]),
    // Names.
    ("[camera]\nmode = \"nadr\"", 2, &["[camera] mode = \"nadr\":", "\"nadir\", \"horizon\", \"chase\", \"geodetic\"", "did you mean \"nadir\"?"]),
    ("[earth]\nfigure = \"flat\"", 2, &["[earth] figure = \"flat\":", "\"wgs84\", \"sphere\""]),
    ("[earth]\nvisibility = \"\"", 2, &["[earth] visibility = \"\":", "\"conservative\", \"paper\""]),
    ("[earth]\nshading = \"Paper\"", 2, &["[earth] shading = \"Paper\":", "did you mean \"paper\"?"]),
    ("[earth]\natmosphere = \"off\"", 2, &["[earth] atmosphere = \"off\":", "\"billboard\", \"none\""]),
    ("[orbit]\nsource = \"gps\"", 2, &["[orbit] source = \"gps\":", "\"tle\"", "\"numerical\""]),
    // Conflicts.
    ("[camera]\nmode = \"horizon\"\nup = \"north\"", 3, &["[camera] up = \"north\":", "no meaning with mode = \"horizon\""]),
    ("[camera]\nup = \"left\"", 2, &["[camera] up", "left", "flight", "north"]),
    ("[camera]\nmode = \"nadir\"\nlat_deg = 10", 3, &["[camera] lat_deg = 10:", "no meaning with mode = \"nadir\"", "mode = \"geodetic\""]),
    ("[camera]\nheight_km = 400\nmode = \"chase\"", 2, &["[camera] height_km = 400:", "no meaning with mode = \"chase\""]),
    ("[earth]\nshading = \"paper\"\nnight_lights = true", 3, &["[earth] night_lights = true:", "no night lights", "shading = \"sunlit\""]),
    ("[orbit]\nname = \"ISS (ZARYA)\"", 2, &["[orbit] name = \"ISS (ZARYA)\":", "add file"]),
    ("[orbit]\nfile = \"sat.tle\"\nname = \" \"", 3, &["[orbit] name = \" \":", "must not be empty"]),
    // Files and folders.
    ("[orbit]\nfile = \"nowhere.tle\"", 2, &["[orbit] file = \"nowhere.tle\":", "cannot be opened", "relative to the scene's folder"]),
    ("[orbit]\nfile = \"maps\"", 2, &["[orbit] file = \"maps\":", "is a folder", "a file"]),
    ("[orbit]\nfile = \"\"", 2, &["[orbit] file = \"\":", "must not be empty"]),
    ("[orbit]\nfile = \"a\\u0000b\"", 2, &["[orbit] file", "cannot be opened"]),
    ("[earth]\ntextures = \"nowhere\"", 2, &["[earth] textures = \"nowhere\":", "cannot be opened", "relative to the scene's folder"]),
    ("[earth]\ntextures = \"sat.tle\"", 2, &["[earth] textures = \"sat.tle\":", "is a file", "a folder"]),
    // Packs.
    ("[earth]\npack = \"nowhere\"", 2, &["[earth] pack = \"nowhere\":", "cannot be opened"]),
    ("[earth]\npack = \"maps\"\ntextures = \"maps\"", 3, &["[earth] textures", "leave out textures or pack"]),
    ("[earth]\nlevels = \"screen\"", 2, &["[earth] levels", "for imagery packs", "pack = \"…\""]),
    ("[earth]\ntexture_mb = 64", 2, &["[earth] texture_mb = 64", "for imagery packs"]),
    ("[earth]\nwater = true", 2, &["[earth] water = true", "for imagery packs"]),
    ("[earth]\npack = \"maps\"\nlevels = \"fine\"", 3, &["[earth] levels = \"fine\":", "\"screen\", \"paper\""]),
    ("[earth]\npack = \"maps\"\nlevels = \"paper\"\ntexel_px = 2", 4, &["[earth] texel_px = 2", "distances alone decide"]),
    ("[earth]\npack = \"maps\"\ntexel_px = 0", 3, &["[earth] texel_px = 0:", "must be from 0.25 to 16"]),
    ("[earth]\npack = \"maps\"\ntexture_mb = 0.5", 3, &["[earth] texture_mb = 0.5:", "must be from 1 to 1000000 megabytes"]),
    ("[earth]\npack = \"maps\"\nupload_mb = -1", 3, &["[earth] upload_mb = -1:", "must be from 0.01 to 10000"]),
    ("[earth]\npack = \"maps\"\nstorage = \"dds\"", 3, &["[earth] storage = \"dds\":", "\"auto\", \"plain\", \"bc\""]),
    ("[earth]\npack = \"maps\"\nshading = \"paper\"\nwater = true", 4, &["[earth] water = true:", "no glint"]),
    ("[output]\nwait_s = 5", 2, &["[output] wait_s = 5", "for imagery packs"]),
    ("[earth]\npack = \"maps\"\n[output]\nwait_s = 5000", 4, &["[output] wait_s = 5000:", "must be from 0 to 3600"]),
    ("[quality]\ntarget_ms = 0", 2, &["[quality] target_ms = 0:", "must be from 1 to 1000 milliseconds"]),
    ("[quality]\ntarget = 16", 2, &["[quality] target", "target_ms"]),
    // Not TOML.
    ("[time]\nspeed 60", 2, &["is not TOML", "`"]),
    ("[time]\nspeed = 60\nspeed = 70", 3, &["is not TOML", "duplicate", "`speed`"]),
    ("[time]\n[camera]\n[time]", 3, &["is not TOML", "duplicate"]),
    ("[time\nspeed = 60", 1, &["is not TOML"]),
    ("[camera]\nmode = \"nadir", 2, &["is not TOML"]),
    ("[camera]\nmode =", 2, &["is not TOML"]),
];

#[test]
fn edges_that_are_seen_are_smoothed() {
    let samples = |text: &str| {
        Folder::new()
            .load(text)
            .expect("a good scene")
            .output
            .samples
    };
    assert_eq!(samples("[camera]\nmode = \"horizon\""), 1);
    assert_eq!(samples("[camera]\nmode = \"chase\""), 4);
    assert_eq!(samples("[earth]\natmosphere = \"none\""), 4);
    assert_eq!(
        samples("[camera]\nmode = \"chase\"\n[output]\nsamples = 1"),
        1
    );
}

#[test]
fn every_bad_scene_is_refused_with_file_line_key_and_remedy() {
    Folder::new().refuses(BAD);
}

#[test]
fn a_file_that_cannot_be_a_scene_is_named_and_refused() {
    let folder = Folder::new();

    let path = folder.path("nowhere.toml");
    let error = Scene::load(&path).expect_err("no such file");
    assert!(matches!(error, SceneError::Read { .. }));
    let message = error.to_string();
    assert!(
        message.starts_with(&path.display().to_string()),
        "{message}"
    );
    assert!(message.contains("config/iss.toml"), "{message}");

    let error = Scene::load(&folder.path("maps")).expect_err("a folder");
    assert!(matches!(error, SceneError::Folder { .. }), "{error}");

    let error = folder
        .load(b"[camera]\nmode = \"\xff\"")
        .expect_err("not UTF-8");
    assert!(
        matches!(error, SceneError::NotUtf8 { line: 2, .. }),
        "{error}"
    );

    let mut text = "#".repeat(Scene::MAX_FILE_BYTES as usize);
    assert!(folder.load(&text).is_ok(), "the limit itself is allowed");
    text.push('#');
    let error = folder.load(&text).expect_err("one byte too many");
    assert!(matches!(error, SceneError::TooLarge { .. }), "{error}");
    assert!(error.to_string().contains("1048576 bytes"), "{error}");
}

/// A pipe or a device has no length to be refused by: the reading itself is bounded.
#[cfg(unix)]
#[test]
fn an_endless_file_is_refused() {
    let error = Scene::load(Path::new("/dev/zero")).expect_err("endless");
    assert!(matches!(error, SceneError::TooLarge { .. }), "{error}");
}

#[test]
fn an_empty_scene_is_all_defaults() {
    let scene = scene("");
    assert_eq!(scene.time.start, utc("2018-01-15T12:00:00Z"));
    assert_eq!(scene.time.duration_s, 5580.0);
    assert_eq!(scene.time.speed, 60.0);
    assert_eq!(scene.time.frame_rate_hz, 30.0);
    assert_eq!(scene.time.frame_count(), 2790);
    assert_eq!(scene.time.end(), utc("2018-01-15T13:33:00Z"));
    let orbit = scene.orbits.first().expect("the built-in elements");
    assert_eq!((&orbit.file, &orbit.name), (&None, &None));
    assert_eq!(scene.camera.mode, CameraMode::Nadir);
    assert_eq!(scene.camera.fov_deg, 45.0);
    assert_eq!(scene.earth.figure, Figure::Wgs84);
    assert_eq!(scene.earth.subdivision, Subdivision::Auto);
    assert_eq!(scene.earth.visibility, Visibility::Conservative);
    assert_eq!(scene.earth.shading, Shading::Sunlit);
    assert!(scene.earth.clouds && scene.earth.normals && scene.earth.night_lights);
    assert_eq!(scene.earth.atmosphere, Atmosphere::Billboard);
    assert_eq!(scene.earth.textures, None);
    assert_eq!(scene.earth.pack, None);
    assert_eq!(scene.output.size, [1280, 720]);
    assert_eq!(scene.output.samples, 1);
    assert_eq!(scene.line("time", "speed"), None);
}

#[test]
fn every_key_is_read() {
    let folder = Folder::new();
    let scene = folder.load(
        "[time]\nstart = \"2018-01-19T01:02:03.25Z\"\nduration_s = 12.5\nspeed = -2\n\
         frame_rate_hz = 29.97\n\
         [orbit]\nsource = \"tle\"\nfile = \"sat.tle\"\nname = \"A\"\nstrict = true\n\
         color = \"#ffffff\"\ntrail = true\nground_track = true\nmarker = true\nsubpoint = true\n\
         footprint = true\nsensor_half_angle_deg = 30\nfootprint_fill = true\n\
         [tracks]\nwidth_px = 4\n\
         [camera]\nmode = \"geodetic\"\nfov_deg = 179.999\nlat_deg = -90\nlon_deg = 350\n\
         height_km = 0.001\nheading_deg = -360\npitch_deg = 90\n\
         [earth]\nfigure = \"sphere\"\nsubdivision = 48\nvisibility = \"paper\"\n\
         shading = \"paper\"\nclouds = false\nnormals = false\nnight_lights = false\n\
         atmosphere = \"none\"\ntextures = \"maps\"\nsurface = \"blocks\"\n\
         [output]\nsize = [16384, 1]\nsamples = 1\n",
    );
    let scene = scene.expect("a good scene");
    assert_eq!(scene.time.start, utc("2018-01-19T01:02:03.25Z"));
    assert_eq!(scene.time.end(), utc("2018-01-19T01:01:50.75Z"));
    assert_eq!(scene.time.duration_s, 12.5);
    assert_eq!(scene.time.speed, -2.0);
    assert_eq!(scene.time.frame_rate_hz, 29.97);
    let orbit = scene.orbits.first().expect("an orbit that was asked for");
    assert_eq!(orbit.file, Some(folder.path("sat.tle")));
    assert_eq!(orbit.name.as_deref(), Some("A"));
    assert_eq!(scene.camera.mode, CameraMode::Geodetic);
    assert_eq!(scene.camera.fov_deg, 179.999);
    assert_eq!(scene.camera.lat_deg, -90.0);
    assert_eq!(scene.camera.lon_deg, -10.0);
    assert_eq!(scene.camera.height_km, 0.001);
    assert_eq!(
        (scene.camera.heading_deg, scene.camera.pitch_deg),
        (-360.0, 90.0)
    );
    assert_eq!(scene.earth.relief, None);
    assert_eq!(scene.earth.figure, Figure::Sphere);
    assert_eq!(scene.earth.subdivision, Subdivision::Cells(48));
    assert_eq!(scene.earth.visibility, Visibility::Paper);
    assert_eq!(scene.earth.shading, Shading::Paper);
    assert!(!scene.earth.clouds && !scene.earth.normals && !scene.earth.night_lights);
    assert_eq!(scene.earth.atmosphere, Atmosphere::None);
    assert_eq!(scene.earth.textures, Some(folder.path("maps")));
    assert_eq!(scene.output.size, [16384, 1]);
    assert_eq!(scene.output.samples, 1);
    assert_eq!(scene.line("output", "samples"), Some(42));
    let summary = scene.summary();
    assert!(!summary.contains("default"), "{summary}");
}

#[test]
fn relief_is_drawn_where_heights_or_its_surface_are_named() {
    let folder = Folder::new();
    let relief = |text: &str| folder.load(text).expect("good").earth.relief;
    assert_eq!(relief("[earth]\nsurface = \"blocks\"\n"), None);
    let starter = relief("[earth]\nsurface = \"clipmap\"\n").expect("relief");
    assert_eq!(starter.surface, SurfaceKind::Clipmap);
    assert_eq!((starter.elevation.len(), starter.tolerance_px), (0, 1.0));
    let heights = relief("[earth]\nelevation = []\n").expect("relief");
    assert_eq!(heights.surface, SurfaceKind::Quadtree);
    let given = "[earth]\nsurface = \"blocks\"\nelevation = [\"sat.tle\"]\ntolerance_px = 0\nsea_floor = true\ndenoise = true\nsubdivision = 24\n";
    let given = relief(given).expect("relief");
    assert_eq!(given.surface, SurfaceKind::Blocks);
    assert_eq!(given.elevation, [folder.path("sat.tle")]);
    assert_eq!((given.tolerance_px, given.sea_floor), (0.0, true));
    let clipmap = "[earth]\nsurface = \"clipmap\"\n[earth.clipmap]\nsamples = 257\nlevels = 24\ntrimming = \"hexagon\"\n";
    let SurfaceSettings::Clipmap(options) = relief(clipmap).expect("relief").settings else {
        panic!("not a clipmap");
    };
    let told = (options.samples, options.levels, options.trim);
    assert_eq!(told, (257, 24, Trim::Hexagon));
    let grid = "[earth]\nsurface = \"projected-grid\"\nprojected_grid = { samples = [65, 1025], on_gpu = false }\n";
    let SurfaceSettings::ProjectedGrid(options) = relief(grid).expect("relief").settings else {
        panic!("not a grid");
    };
    assert_eq!((options.samples, options.on_gpu), ((65, 1025), false));
    // What is not said stays as it is, and the summary tells all of it.
    let scene = folder
        .load("[earth]\nsurface = \"clipmap\"\nclipmap = { levels = 6 }\n")
        .expect("good");
    let told = "{ samples = 129, levels = 6, trimming = \"diamond\" }";
    assert!(scene.summary().contains(told), "{}", scene.summary());
    assert!(given.denoise && !starter.denoise);
    let cast = "[earth]\nsurface = \"contours\"\ncontours = { drawn = \"cast\" }\n";
    let settings = relief(cast).expect("relief").settings;
    assert!(matches!(settings, SurfaceSettings::CastContours(_)));
    let summary = folder.load(cast).expect("good").summary();
    assert!(summary.contains("{ drawn = \"cast\" }"), "{summary}");
    for (text, words) in [
        (
            "surface = \"quadtree\"\ncontours = { drawn = \"cast\" }",
            ["contours", "for surface = \"contours\""],
        ),
        (
            "surface = \"contours\"\ncontours = { drawn = \"casts\" }",
            ["contours", "must be \"patches\" or \"cast\""],
        ),
        (
            "sea_floor = true",
            ["sea_floor", "is for ground with relief"],
        ),
        ("denoise = true", ["denoise", "is for ground with relief"]),
        (
            "tolerance_px = 2",
            ["tolerance_px", "is for ground with relief"],
        ),
        (
            "elevation = [\"no.tif\"]",
            ["elevation", "cannot be opened"],
        ),
        (
            "elevation = []\ntolerance_px = -1",
            ["tolerance_px", "from 0 to 1000"],
        ),
        (
            "elevation = []\nvisibility = \"paper\"",
            ["visibility", "behind the horizon"],
        ),
        (
            "surface = \"quadtree\"\nsubdivision = 6",
            ["subdivision", "tolerance_px"],
        ),
        (
            "surface = \"quadtree\"\nclipmap = { levels = 6 }",
            ["clipmap", "is for surface = \"clipmap\""],
        ),
        (
            "[earth.projected_grid]\non_gpu = false",
            ["projected_grid", "is for surface = \"projected-grid\""],
        ),
        (
            "surface = \"clipmap\"\nclipmap = 6",
            ["clipmap", "must be a table like { samples = 129"],
        ),
        (
            "surface = \"clipmap\"\nclipmap = { samples = 128 }",
            ["clipmap", "must be 65, 129 or 257"],
        ),
        (
            "surface = \"clipmap\"\n[earth.clipmap]\nlevels = 25",
            ["clipmap", "levels must be a whole number from 0 to 24"],
        ),
        (
            "surface = \"clipmap\"\nclipmap = { levels = 6.0 }",
            ["clipmap", "levels must be a whole number"],
        ),
        (
            "surface = \"clipmap\"\nclipmap = { trimming = \"square\" }",
            ["clipmap", "\"diamond\" or \"hexagon\""],
        ),
        (
            "surface = \"clipmap\"\nclipmap = { level = 6 }",
            ["clipmap", "samples, levels and trimming, not level"],
        ),
        (
            "surface = \"projected-grid\"\nprojected_grid = { samples = [1, 129] }",
            ["projected_grid", "whole numbers from 2 to 1025"],
        ),
        (
            "surface = \"projected-grid\"\nprojected_grid = { samples = 129 }",
            ["projected_grid", "[across, down]"],
        ),
        (
            "surface = \"projected-grid\"\nprojected_grid = { on_gpu = 1 }",
            ["projected_grid", "on_gpu must be true or false"],
        ),
        (
            "surface = \"projected-grid\"\nprojected_grid = { gpu = true }",
            ["projected_grid", "samples and on_gpu, not gpu"],
        ),
        (
            "surface = \"quadtre\"",
            ["surface", "did you mean \"quadtree\"?"],
        ),
    ] {
        let error = folder
            .load(format!("[earth]\n{text}\n"))
            .expect_err(text)
            .to_string();
        let tells = words.iter().all(|word| error.contains(word));
        assert!(tells && error.contains("scene.toml:"), "{text}: {error}");
    }
}

#[test]
fn a_pack_has_defaults_of_its_own() {
    let folder = Folder::new();
    let scene = folder.load("[earth]\npack = \"maps\"\n").expect("good");
    let pack = scene.earth.pack.as_ref().expect("a pack");
    assert_eq!(pack.folder, folder.path("maps"));
    assert_eq!((pack.levels, pack.texel_px), (LevelRule::Screen, 1.0));
    assert_eq!((pack.texture_mb, pack.upload_mb), (512.0, 8.0));
    assert_eq!((pack.storage, pack.water), (StorageChoice::Auto, true));
    let output = &scene.output;
    assert_eq!(
        (scene.earth.subdivision, output.wait_s),
        (Subdivision::Auto, 30.0)
    );
    let scene = folder
        .load("[earth]\npack = \"maps\"\nlevels = \"paper\"\nstorage = \"bc\"\nwater = false\nsubdivision = 6\n")
        .expect("good");
    let pack = scene.earth.pack.as_ref().expect("a pack");
    assert_eq!(
        (pack.levels, pack.storage),
        (LevelRule::Paper, StorageChoice::Bc)
    );
    assert_eq!(
        (pack.water, scene.earth.subdivision),
        (false, Subdivision::Cells(6))
    );
    assert!(scene.summary().contains("the pack"), "{}", scene.summary());
}

#[test]
fn the_mode_of_the_camera_follows_from_the_keys_that_are_given() {
    let place = scene("[camera]\nlat_deg = 10");
    assert_eq!(place.camera.mode, CameraMode::Geodetic);
    assert_eq!(place.camera.lon_deg, 0.0);
    assert_eq!(place.camera.height_km, 20_000.0);
    assert!(place.orbits.is_empty());

    let place = scene("[camera]\nmode = \"geodetic\"");
    assert_eq!((place.camera.lat_deg, place.camera.lon_deg), (0.0, 0.0));
    assert!(place.orbits.is_empty());

    // An orbit that is asked for is kept, and asking takes no more than the table's head.
    let kept = scene("[orbit]\n[camera]\nmode = \"geodetic\"").orbits;
    assert_eq!(kept.len(), 1);
    for mode in ["nadir", "horizon", "chase"] {
        let orbits = scene(&format!("[camera]\nmode = \"{mode}\"")).orbits;
        assert_eq!(orbits.len(), 1);
    }
}

#[test]
fn longitudes_come_into_a_half_turn() {
    let cases = [
        ("180", 180.0),
        ("-180", -180.0),
        ("181", -179.0),
        ("-270.5", 89.5),
        ("360", 0.0),
        ("-360", 0.0),
    ];
    for (written, lon_deg) in cases {
        let scene = scene(&format!("[camera]\nlon_deg = {written}"));
        assert_eq!(scene.camera.lon_deg, lon_deg, "{written}");
    }
}

#[test]
fn a_start_may_be_a_string_or_a_date_of_toml() {
    for written in [
        "\"2018-01-19T07:32:00Z\"",
        "2018-01-19T07:32:00Z",
        "2018-01-19 07:32:00Z",
        "2018-01-19T07:32Z",
        "\"2018-01-19T09:32:00+02:00\"",
        "2018-01-19T09:32:00+02:00",
    ] {
        let scene = scene(&format!("[time]\nstart = {written}"));
        let start = scene.time.start;
        assert_eq!(start, utc("2018-01-19T07:32:00Z"), "{written}");
    }
}

#[test]
fn the_shading_of_the_paper_has_no_night_lights_by_default() {
    assert!(!scene("[earth]\nshading = \"paper\"").earth.night_lights);
    assert!(scene("[earth]\nshading = \"sunlit\"").earth.night_lights);
}

#[test]
fn paths_are_relative_to_the_folder_of_the_scene() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("scenes")).expect("a folder");
    let path = folder.path("scenes/deep.toml");
    std::fs::write(&path, "[orbit]\nfile = \"../sat.tle\"").expect("a file");
    let scene = Scene::load(&path).expect("a good scene");
    let file = scene.orbits.into_iter().next().and_then(|orbit| orbit.file);
    assert_eq!(file, Some(folder.path("scenes/../sat.tle")));
}

#[test]
fn dates_outside_the_reach_of_the_orbit_are_refused() {
    let reach = (utc("2018-01-10T00:00:00Z"), utc("2018-01-20T00:00:00Z"));
    let refusal = |text| match scene(text).check_dates(reach) {
        Ok(()) => String::new(),
        Err(error) => error.to_string(),
    };
    for good in [
        "",
        "[time]\nstart = \"2018-01-10T00:00:00Z\"",
        "[time]\nstart = \"2018-01-20T00:00:00Z\"\nspeed = -60",
        "[time]\nstart = \"2018-01-19T00:00:00Z\"\nduration_s = 86400",
    ] {
        assert_eq!(refusal(good), "", "{good}");
    }
    let interval = "from 2018-01-10T00:00:00Z to 2018-01-20T00:00:00Z";
    let cases: [(&str, &str, &[&str]); 4] = [
        (
            "[time]\nstart = \"2019-01-15T12:00:00Z\"",
            "scene.toml:2: [time] start = 2019-01-15T12:00:00Z:",
            &["choose a start", "[orbit]"],
        ),
        (
            "[time]\nstart = \"2018-01-09T23:59:59Z\"",
            "scene.toml:2: [time] start = 2018-01-09T23:59:59Z:",
            &["choose a start"],
        ),
        (
            "[time]\nstart = \"2018-01-19T00:00:00Z\"\nduration_s = 86401",
            "scene.toml:3: [time] duration_s = 86401:",
            &["2018-01-20T00:00:01Z", "at most 86400 seconds"],
        ),
        (
            "[time]\nstart = \"2018-01-10T00:00:10Z\"\nspeed = -1",
            "scene.toml: [time] duration_s = 5580 (default):",
            &["2018-01-09T22:27:10Z", "at most 10 seconds"],
        ),
    ];
    for (text, start, needles) in cases {
        let message = refusal(text);
        assert!(message.starts_with(start), "{message}");
        for needle in needles.iter().chain([&interval]) {
            assert!(message.contains(needle), "{needle:?} is not in: {message}");
        }
    }
}

#[test]
fn the_summary_tells_values_origins_use_and_what_is_left_out() {
    let text = "[camera]\nfov_deg = 30\n[earth]\nclouds = false\natmosphere = \"none\"";
    let summary = scene(text).summary();
    let has = |words: &[&str]| {
        let mut lines = summary.lines();
        let found = lines.any(|line| words.iter().all(|word| line.contains(word)));
        assert!(found, "no line has all of {words:?}:\n{summary}");
    };
    has(&["scene.toml: good"]);
    has(&["fov_deg", "30", "line 2 of the file"]);
    has(&["speed", "60", "default"]);
    has(&["start", "\"2018-01-15T12:00:00Z\"", "default"]);
    has(&["lat_deg", "not used", "geodetic"]);
    has(&["playback", "2018-01-15T13:33:00Z", "2790 frames", "93.0 s"]);
    has(&["orbit", "built-in", "International Space Station"]);
    has(&["camera", "straight down", "30°"]);
    has(&["layers", "day map, normals, night lights", "starter pack"]);
    has(&["clouds: off: not loaded, not in the shader"]);
    has(&["atmosphere: off: not loaded, not in the shader"]);
    assert!(!summary.contains("night lights: off"), "{summary}");

    let summary = scene("").summary();
    assert!(summary.ends_with("leaves out\n  nothing\n"), "{summary}");
    assert!(summary.contains("billboard"), "{summary}");
}

fn config() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("config")
}

#[test]
fn all_scenes_of_the_config_folder_are_good() {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(config()).expect("config/") {
        let path = entry.expect("an entry").path();
        if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            match Scene::load(&path) {
                Ok(scene) => println!("{}", scene.summary()),
                Err(error) => panic!("{error}"),
            }
            let stem = path.file_stem().map(|stem| stem.to_string_lossy());
            names.extend(stem.map(|stem| stem.into_owned()));
        }
    }
    for wanted in ["geostationary", "iss", "minimal", "molniya", "paper"] {
        let found = names.iter().any(|name| name == wanted);
        assert!(found, "{wanted} is not in {names:?}");
    }
}

#[test]
fn the_minimal_scene_and_the_scene_of_the_paper_are_what_they_say() {
    let load = |name| Scene::load(&config().join(name)).unwrap_or_else(|error| panic!("{error}"));

    let earth = load("minimal.toml").earth;
    assert!(!earth.clouds && !earth.normals && !earth.night_lights);
    assert_eq!(earth.atmosphere, Atmosphere::None);

    let earth = load("paper.toml").earth;
    assert_eq!(earth.figure, Figure::Sphere);
    assert_eq!(earth.visibility, Visibility::Paper);
    assert_eq!(earth.shading, Shading::Paper);
    assert_eq!(earth.subdivision, Subdivision::Cells(6));
    assert!(earth.clouds && earth.normals);
    assert_eq!(earth.atmosphere, Atmosphere::Billboard);
}

/// Pieces from which texts are made that reach past the TOML reader.
#[rustfmt::skip]
const PIECES: &[&str] = &[
    "[time]", "[orbit]", "[camera]", "[earth]", "[output]", "[[time]]", "[time.start]", "start", "duration_s",
    "speed", "frame_rate_hz", "source", "file", "name", "mode", "fov_deg", "lat_deg", "lon_deg", "height_km",
    "figure", "subdivision", "clouds", "size", "samples", "=", ".", ",", "{", "}", "[", "]", "\n", "\n",
    "\"nadir\"", "\"tle\"", "true", "nan", "-inf", "1e308", "-1e-308", "0", "-9223372036854775808",
    "99999999999999999999", "0xff", "2018-01-15T12:00:00Z", "0001-01-01T00:00:00+23:59", "12:00:00",
    "\"9999-12-31T23:59:60.9999999999Z\"", "#", "\"\"\"", "\u{feff}", "é",
];

/// Table and key, known and unknown.
#[rustfmt::skip]
const KEYS: &[&str] = &[
    "time.start", "time.duration_s", "time.speed", "time.frame_rate_hz", "orbit.file", "orbit.name",
    "camera.mode", "camera.fov_deg", "camera.lat_deg", "camera.lon_deg", "camera.height_km", "earth.figure",
    "earth.subdivision", "earth.clouds", "earth.textures", "output.size", "output.samples", "time.zone", "sky.stars",
];

fn piece() -> impl Strategy<Value = String> {
    prop_oneof![
        8 => proptest::sample::select(PIECES).prop_map(str::to_owned),
        1 => any::<f64>().prop_map(|number| number.to_string()),
        1 => "\\PC{0,6}",
    ]
}

/// One key and one value: nearly always TOML.
fn assignment() -> impl Strategy<Value = String> {
    // Mostly real dates, some not.
    let date =
        || "[0-9]{4}-(0[1-9]|1[0-2])-[0-2][0-9]T[01][0-9]:[0-5][0-9]:[0-6][0-9](\\.[0-9]{1,12})?";
    let value = prop_oneof![
        any::<f64>().prop_map(|number| format!("{number:e}")),
        any::<i64>().prop_map(|number| number.to_string()),
        (any::<i64>(), any::<i64>()).prop_map(|(a, b)| format!("[{a}, {b}]")),
        "[a-z]{0,8}".prop_map(|word| format!("\"{word}\"")),
        date().prop_map(|date| format!("\"{date}Z\"")),
        date().prop_map(|date| format!("\"{date}+05:30\"")),
        date().prop_map(|date| format!("{date}Z")),
    ];
    (proptest::sample::select(KEYS), value).prop_map(|(key, value)| format!("{key} = {value}\n"))
}

/// What must hold of any text: no panic, and either a scene that can be told or one line of message.
fn holds(text: &str) -> Result<(), TestCaseError> {
    match Scene::from_toml(text, Path::new("scene.toml")) {
        Ok(scene) => {
            prop_assert!(scene.summary().contains("leaves out"));
            prop_assert!(scene.time.frame_count() >= 1);
            let start = scene.time.start;
            // Whether it is refused does not matter here: it must not panic.
            let _ = scene.check_dates((start, start));
        }
        Err(error) => {
            let message = error.to_string();
            prop_assert!(message.starts_with("scene.toml:"), "{}", message);
            prop_assert!(error.line().is_some(), "{}", message);
            prop_assert!(!message.chars().any(char::is_control), "{:?}", message);
        }
    }
    Ok(())
}

proptest! {
    // A failure is printed with its smallest text; nothing is left in the repository.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_text_panics(text in any::<String>()) {
        holds(&text)?;
    }

    #[test]
    fn no_mixture_of_pieces_panics(
        pieces in proptest::collection::vec(piece(), 0..40),
        gap in "[ \n]?",
    ) {
        holds(&pieces.join(&gap))?;
    }

    #[test]
    fn no_assignment_panics(lines in proptest::collection::vec(assignment(), 1..4)) {
        holds(&lines.concat())?;
    }

    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..64)) {
        let _ = Folder::new().load(bytes);
    }
}
