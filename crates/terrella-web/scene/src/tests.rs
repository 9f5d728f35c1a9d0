use super::*;
use std::path::Path;

fn read(text: &str) -> PageScene {
    PageScene::of(text).unwrap_or_else(|fault| panic!("{fault}"))
}

fn fault(text: &str) -> String {
    PageScene::of(text).expect_err("a faulty scene").to_string()
}

#[test]
fn a_scene_is_what_the_page_shows() {
    let scene = read(
        r#"
        [time]
        start = "2026-06-01T12:00:00Z"
        speed = 60
        [[orbit]]
        file = "a.tle"
        name = "A"
        marker = true
        trail = { before_min = 30 }
        [[orbit]]
        source = "oem"
        file = "b.oem"
        ground_track = true
        [camera]
        mode = "horizon"
        follow = "A"
        fov_deg = 60
        [earth]
        look = "full"
        clouds = false
        atmosphere = "none"
        pack = "earth"
        [sky]
        stars = false
        sun = false
        moon = false
        [layers]
        coast_lines = true
        terminator = true
        [[station]]
        name = "Kourou"
        lat_deg = 5.25
        lon_deg = -52.8
        min_elevation_deg = 10
        [output]
        size = [640, 360]
        exposure_ev = "auto"
        "#,
    );
    assert_eq!(scene.missing, Vec::<String>::new());
    assert_eq!(scene.start.as_deref(), Some("2026-06-01T12:00:00Z"));
    assert_eq!(
        (scene.rate, scene.view, scene.fov_deg),
        (Some(60.0), None, 60.0)
    );
    assert_eq!(
        (scene.follow.as_str(), scene.look.as_str()),
        ("horizon", "full")
    );
    assert_eq!(scene.followed.as_deref(), Some("A"));
    assert_eq!(scene.hidden, ["clouds", "air", "sky"]);
    assert_eq!(scene.lines, ["coasts", "twilight"]);
    assert_eq!(scene.tracks, ["markers", "trails", "ground-tracks"]);
    assert_eq!(scene.exposure_ev, None);
    let satellites = [["a.tle", "A"], ["b.oem", ""]].map(|one| one.map(str::to_owned));
    assert_eq!(scene.satellites, satellites);
    let station = ("Kourou".to_owned(), [5.25, -52.8, 10.0, 0.0]);
    assert_eq!(scene.stations, [station]);
    assert_eq!(scene.pack.as_deref(), Some("earth"));
}

#[test]
fn defaults_are_those_of_scenes() {
    let scene = read("");
    assert_eq!(scene.start.as_deref(), Some(DEFAULT_START));
    assert_eq!((scene.rate, scene.exposure_ev), (None, Some(0.5)));
    assert_eq!((scene.follow.as_str(), scene.fov_deg), ("nadir", 45.0));
    // A place without a mode is a camera over the ground.
    let placed = read("camera.lat_deg = 10");
    assert_eq!(placed.view, Some([10.0, 0.0, 2e7, 0.0, -90.0]));
    assert_eq!(placed.follow, "");
    // With satellites the start is their own time.
    assert_eq!(read("orbit.file = \"a.tle\"").start, None);
}

#[test]
fn what_a_page_does_not_have_is_named() {
    let scene = read(
        "caption.text = \"A\"\n[earth]\nkp = 5\nlook = \"paper\"\n[camera]\nroll_deg = 3\n[[orbit]]\nsource = \"kepler\"\nsemi_major_axis_km = 7000\n",
    );
    let missing = [
        "orbit.source = \"kepler\"",
        "orbit.semi_major_axis_km",
        "camera.roll_deg",
        "earth.look = \"paper\"",
        "earth.kp",
        "caption",
    ];
    assert_eq!(scene.missing, missing);
}

#[test]
fn faults_are_named_with_their_key() {
    for (text, part) in [
        ("[time\n", "line 1"),
        (
            "camera.lat_deg = 100",
            "camera.lat_deg must be a number from -90 to 90",
        ),
        (
            "camera.mode = \"orbit\"",
            "camera.mode must be one of the words",
        ),
        ("earth = 3", "earth must be a table"),
        (
            "[[station]]\nname = \"A\"",
            "station.lat_deg must be a number",
        ),
        ("orbit.source = \"tel\"", "not \"tel\""),
        (
            "output.exposure_ev = nan",
            "output.exposure_ev must be a number",
        ),
        (
            "layers.borders = \"yes\"",
            "layers.borders must be true or false",
        ),
    ] {
        let said = fault(text);
        assert!(said.contains(part), "{text}: {said}");
    }
}

#[test]
fn every_scene_of_the_repository_is_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../config");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("config/") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|ending| ending != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("a scene");
        let scene =
            PageScene::of(&text).unwrap_or_else(|fault| panic!("{}: {fault}", path.display()));
        assert!(
            scene.view.is_some() != !scene.follow.is_empty(),
            "{}",
            path.display()
        );
        count += 1;
    }
    assert!(count > 20, "{count}");
}
