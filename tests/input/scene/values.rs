//! Values of a scene: defaults, and values derived from the given keys.

use super::{Folder, scene, utc};
use glam::DVec3;
use std::path::Path;
use terrella::internals::earth::Shading;
use terrella::{Exposure, Grade, Tone};
use terrella_ground::air::Atmosphere;
use terrella_ground::globe::{Figure, LevelRule, Subdivision, Visibility};
use terrella_play::scene::{
    CameraKey, CameraMode, CaptionPlace, CoverageShow, CoverageTable, EarthTable, Look, Scene,
    StorageChoice, ToneTable,
};

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
fn light_is_shown_as_the_scene_says() {
    let output = |text: &str| scene(&format!("[output]\n{text}")).output;
    assert_eq!(output("").exposure, Exposure::Ev(Exposure::DEFAULT_EV));
    assert_eq!(output("exposure_ev = -20").exposure, Exposure::Ev(-20.0));
    assert_eq!(output("exposure_ev = 1.25").exposure, Exposure::Ev(1.25));
    assert_eq!(output("exposure_ev = \"auto\"").exposure, Exposure::Auto);
    let named = |text: &str| match output(text).tone {
        ToneTable::Named(tone) => tone,
        measured => panic!("{measured:?}"),
    };
    assert_eq!(named(""), Tone::Camera);
    assert_eq!(named("tone = \"neutral\""), Tone::Neutral);
    assert_eq!(named("tone = \"filmic\""), Tone::Filmic);
    assert_eq!(named("tone = \"linear\""), Tone::Linear);
}

#[test]
fn seasons_are_on_where_they_can_be() {
    let seasons = |text: &str| scene(&format!("[earth]\n{text}")).earth.seasons;
    assert!(seasons("") && seasons("look = \"full\"") && !seasons("seasons = false"));
    assert!(!seasons("look = \"paper\"") && !seasons("water = false"));
    assert!(!seasons("surface = \"quadtree\"\nelevation = []"));
}

#[test]
fn white_balance_and_grain_are_off_unless_they_are_given() {
    let grade = |text: &str| scene(&format!("[output]\n{text}")).output.grade;
    assert_eq!(grade(""), Grade::NONE);
    assert_eq!(grade("").balance(), None);
    let balanced = grade("white_balance_k = 5000")
        .white_balance
        .expect("given");
    assert_eq!((balanced.temperature_k, balanced.tint), (5000.0, 0.0));
    let tinted = grade("white_balance_k = 5000\ntint = -10").white_balance;
    assert_eq!(tinted.map(|balance| balance.tint), Some(-10.0));
    let grain = grade("grain = 0.02").grain;
    assert_eq!((grain.strength, grain.size_px, grain.seed), (0.02, 1.5, 0));
    let grain = grade("grain = 0.02\ngrain_size_px = 3\ngrain_seed = 4294967295").grain;
    assert_eq!((grain.size_px, grain.seed), (3.0, u32::MAX));
}

#[test]
fn a_measured_tone_is_read_when_it_is_needed() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/responses.txt");
    let table = |name: &str| {
        scene(&format!("[output]\ntone = {{ file = {file:?}{name} }}"))
            .output
            .tone
    };
    let gamma = table(", name = \"gamma 2.2\"").open().expect("a response");
    let shown = gamma.shown(DVec3::splat(0.5)).x;
    assert!((shown - 0.5).abs() < 0.01, "{shown}: nearly sRGB");
    let slide = table(", name = \"slide\"").open().expect("three curves");
    assert_ne!(gamma, slide);
    let error = table("").open().expect_err("which?").to_string();
    for words in [
        "responses.txt: ",
        "\"slide\", \"gamma 2.2\"",
        "tone in [output]",
    ] {
        assert!(error.contains(words), "{error}");
    }
    let error = table(", name = \"none\"").open().expect_err("not there");
    assert!(
        error
            .to_string()
            .contains("there is no response named \"none\""),
        "{error}"
    );
}

#[test]
fn a_camera_has_keys_in_their_order() {
    let text = "[[camera.keys]]\ntime_s = -5\nfov_deg = 40\n\
        [[camera.keys]]\ntime_s = 7.5\nlat_deg = 1\nlon_deg = 2.5\nheight_km = 3\nheading_deg = 4\npitch_deg = -5\nexposure_ev = 1\n";
    let camera = scene(text).camera;
    assert_eq!(
        camera.mode,
        CameraMode::Geodetic,
        "keys stand over the ground"
    );
    let keys = [
        CameraKey {
            time_s: -5.0,
            fov_deg: Some(40.0),
            ..CameraKey::default()
        },
        CameraKey {
            time_s: 7.5,
            place: Some([1.0, 2.5, 3.0]),
            facing_deg: Some([4.0, -5.0]),
            exposure_ev: Some(1.0),
            ..CameraKey::default()
        },
    ];
    assert_eq!(camera.keys, keys);
    // As the summary writes them.
    let summary = scene(text).summary();
    let line = summary.lines().find(|line| line.trim().starts_with("keys"));
    let line = line
        .expect("in the summary")
        .trim()
        .trim_start_matches("keys");
    let list = line.rsplit_once("line").expect("where from").0.trim();
    assert_eq!(scene(&format!("[camera]\nkeys = {list}")).camera.keys, keys);
    let at_satellite =
        "[camera]\nmode = \"horizon\"\n[[camera.keys]]\ntime_s = 0\nyaw_deg = 10\npitch_deg = 3";
    assert_eq!(
        scene(at_satellite).camera.keys[0].turn_deg,
        Some([10.0, 3.0])
    );
    let chasing = "[camera]\nmode = \"chase\"\nkeys = [{ time_s = 0, offset_m = [-30, 0, -5.5] }]";
    assert_eq!(
        scene(chasing).camera.keys[0].offset_m,
        Some([-30.0, 0.0, -5.5])
    );
}

#[test]
fn a_look_sets_what_the_scene_leaves_open() {
    let earth = |text: &str| scene(&format!("[earth]\n{text}")).earth;
    assert_eq!(earth("").look, Look::Standard);
    let paper = earth("look = \"paper\"");
    assert_eq!(paper.shading, Shading::Paper);
    assert!(!paper.night_lights);
    let own = earth("look = \"paper\"\nshading = \"sunlit\"");
    assert_eq!((own.shading, own.night_lights), (Shading::Sunlit, true));
    assert_eq!(paper.visibility, Visibility::Paper);
    assert_eq!(own.visibility, Visibility::Paper);
    let terrain = earth("look = \"paper\"\nsurface = \"clipmap\"");
    assert_eq!(terrain.visibility, Visibility::Conservative);
    let full = earth("look = \"full\"");
    assert_eq!(full.shading, Shading::Sunlit);
    let shadows = |earth: &EarthTable| earth.light.map(|light| light.cloud_shadows);
    assert_eq!(shadows(&full), Some(true));
    assert_eq!(shadows(&earth("")), Some(false));
    assert_eq!(
        shadows(&earth("look = \"full\"\ncloud_shadows = false")),
        Some(false)
    );
    assert_eq!(shadows(&paper), None);
    let detail = |earth: &EarthTable| {
        let light = earth.light?;
        Some((light.detail, light.directional_reflectance))
    };
    assert_eq!(detail(&full), Some((true, true)));
    assert_eq!(detail(&earth("")), Some((true, true)));
    assert_eq!(detail(&earth("detail = false")), Some((false, true)));
    assert_eq!(detail(&paper), None);
    let eclipses = |text: &str| scene(text).sky.eclipses;
    assert!(eclipses("") && !eclipses("[sky]\neclipses = false"));
    assert!(!eclipses("[earth]\nlook = \"paper\""));
    // Haze: that of a clear day by default, none in the paper's image, and the given value in both.
    let haze = |text: &str| earth(text).aerosol_optical_depth;
    assert_eq!((haze(""), haze("look = \"paper\"")), (0.1, 0.0));
    assert_eq!(haze("look = \"paper\"\naerosol_optical_depth = 5"), 5.0);
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
         footprint = true\nsensor_half_angle_deg = 30\nsensor_off_nadir_deg = 5\nsensor_azimuth_deg = 80\nsensor_lines = true\nswath = true\nfootprint_fill = true\n\
         model = \"sat.tle\"\nmodel_scale = 2\nmodel_length_px = 3\nmodel_axes = \"body\"\nattitude = \"inertial\"\n\
         [tracks]\nwidth_px = 4\n\
         [camera]\nmode = \"geodetic\"\nfov_deg = 179.999\nlat_deg = -90\nlon_deg = 350\n\
         height_km = 0.001\nheading_deg = -360\npitch_deg = 90\nroll_deg = -360\n\
         [earth]\nlook = \"paper\"\nstrict = true\nfigure = \"sphere\"\nsubdivision = 48\nvisibility = \"paper\"\n\
         shading = \"paper\"\nclouds = false\nnormals = false\nnight_lights = false\n\
         atmosphere = \"none\"\ntextures = \"maps\"\nsurface = \"blocks\"\n\
         water = false\nseasons = false\naerosol_optical_depth = 0\n\
         [output]\nsize = [16384, 1]\nsamples = 1\n\
         exposure_ev = 1.5\ntone = \"linear\"\n\
         [sky]\nstars = true\nmilky_way = false\nsun = true\nmoon = false\nglare = true\neclipses = false\nstar_gain = 7\nfolder = \"maps\"\n\
         [quality]\ntarget_ms = 20\nscale = 0.5\nladder = \"sat.tle\"\n\
         [station]\nname = \"A\"\nlat_deg = 1\nlon_deg = 2\nheight_m = 3\nmin_elevation_deg = 4\ncolor = \"#ffffff\"\n\
         [layers]\ngraticule = { step_deg = 5 }\ngraticule_color = \"#ffffff\"\ngraticule_opacity = 0.5\n\
         coast_lines = true\ncoast_lines_color = \"#ffffff\"\ncoast_lines_opacity = 0.5\n\
         borders = true\nborders_color = \"#ffffff\"\nborders_opacity = 0.5\n\
         terminator = true\nterminator_color = \"#ffffff\"\nterminator_opacity = 0.5\n\
         moon_shadow = true\nmoon_shadow_color = \"#ffffff\"\nmoon_shadow_opacity = 0.5\nplace_names = 9\nwidth_px = 2\nvector_map = \"sat.tle\"\n\
         [coverage]\nshow = \"count\"\nsatellites = [\"A\"]\nduration_h = 6\nmin_elevation_deg = 0\nstep_deg = 10\nregion_deg = [170, -10, -170, 10]\n\
         opacity = 0.25\nlegend = true\nlegend_place = \"top\"\n[lens]\nghosts = 1e-4\n",
    );
    let scene = scene.expect("a good scene");
    let sky = &scene.sky;
    let parts = sky.parts().map(|(_, is_on)| is_on);
    assert_eq!(
        (parts, sky.star_gain),
        ([true, false, true, false, true], 7.0)
    );
    assert_eq!(sky.folder, Some(folder.path("maps")));
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
    let coverage = CoverageTable {
        show: CoverageShow::Count,
        satellites: vec!["A".to_owned()],
        duration_h: 6.0,
        min_elevation_deg: 0.0,
        step_deg: 10.0,
        region_deg: [170.0, -10.0, -170.0, 10.0],
        opacity: 0.25,
        legend: Some(CaptionPlace::Top),
    };
    assert_eq!(scene.coverage, Some(coverage));
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
    assert_eq!(scene.line("output", "samples"), Some(57));
    let quality = &scene.quality;
    assert_eq!((quality.target_ms, quality.scale), (Some(20.0), 0.5));
    assert_eq!(quality.ladder, Some(folder.path("sat.tle")));
    assert_eq!(scene.layers.vector_map, Some(folder.path("sat.tle")));
    assert_eq!((scene.layers.width_px, scene.stations.len()), (2.0, 1));
    assert_eq!(scene.line("station", "lat_deg"), Some(75));
    let summary = scene.summary();
    assert!(!summary.contains("default"), "{summary}");
}

#[test]
fn a_pack_has_defaults_of_its_own() {
    let folder = Folder::new();
    let scene = folder.load("[earth]\npack = \"maps\"\n").expect("good");
    let pack = scene.earth.pack.as_ref().expect("a pack");
    assert_eq!(pack.folder, folder.path("maps"));
    assert_eq!((pack.levels, pack.texel_px), (LevelRule::Screen, 1.0));
    assert_eq!((pack.texture_mb, pack.upload_mb), (512.0, 4.0));
    assert_eq!(
        (pack.storage, scene.earth.water),
        (StorageChoice::Auto, true)
    );
    let output = &scene.output;
    assert_eq!(
        (scene.earth.subdivision, output.wait_s),
        (Subdivision::Auto, 30.0)
    );
    let paper = folder.load("[earth]\npack = \"maps\"\nlook = \"paper\"\n");
    let paper = paper.expect("good");
    let levels = paper.earth.pack.as_ref().map(|pack| pack.levels);
    assert_eq!((levels, paper.notices.len()), (Some(LevelRule::Paper), 0));
    let scene = folder
        .load("[earth]\npack = \"maps\"\nlevels = \"paper\"\nstorage = \"bc\"\nwater = false\nsubdivision = 6\n")
        .expect("good");
    let notice = scene.notices.concat();
    assert!(notice.starts_with("[earth] levels: deprecated"), "{notice}");
    let pack = scene.earth.pack.as_ref().expect("a pack");
    assert_eq!(
        (pack.levels, pack.storage),
        (LevelRule::Paper, StorageChoice::Bc)
    );
    assert_eq!(
        (scene.earth.water, scene.earth.subdivision),
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

    // An explicit orbit is kept, for which the head of the table suffices.
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
        "\"2018-01-19 07:32\"",
        "\"2018-01-19T07:32Z\"",
        "2018-01-19T07:32:00",
        "2018-01-19 07:32",
    ] {
        let scene = scene(&format!("[time]\nstart = {written}"));
        let start = scene.time.start;
        assert_eq!(start, utc("2018-01-19T07:32:00Z"), "{written}");
    }
    for midnight in ["\"2018-01-19\"", "2018-01-19"] {
        let scene = scene(&format!("[time]\nstart = {midnight}"));
        assert_eq!(scene.time.start, utc("2018-01-19T00:00:00Z"), "{midnight}");
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
