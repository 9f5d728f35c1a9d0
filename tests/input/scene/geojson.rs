//! `[[geojson]]`.

use super::{Bad, Folder};
use terrella_play::scene::Scene;

#[rustfmt::skip]
const BAD: &[Bad] = &[
    ("[[geojson]]\ncolor = \"#ffffff\"", 2, &["[geojson] file: ", "needs its file"]),
    ("[[geojson]]\nfile = \"none.geojson\"", 2, &["[geojson] file", "none.geojson", "cannot be opened"]),
    ("[[geojson]]\nfile = \"\"", 2, &["[geojson] file", "must not be empty"]),
    ("[[geojson]]\nfile = \"sat.tle\"\nwidth_px = 0", 3, &["[geojson] width_px = 0:", "0.5 to 16"]),
    ("[[geojson]]\nfile = \"sat.tle\"\nopacity = 2", 3, &["[geojson] opacity = 2:", "0.01 to 1"]),
    ("[[geojson]]\nfile = \"sat.tle\"\ncolor = \"red\"", 3, &["[geojson] color", "six hexadecimal digits"]),
    ("[[geojson]]\nfile = \"sat.tle\"\nname_key = \"\"", 3, &["[geojson] name_key", "must not be empty"]),
    ("[[geojson]]\nfile = \"sat.tle\"\nfill = 0.5", 3, &["[geojson] fill: ", "drawn as outlines, without a fill"]),
    ("[areas]\nfile = \"sat.tle\"", 1, &["[areas]:", "did you mean [geojson]?"]),
];

#[test]
fn what_is_wrong_is_rejected_where_it_stands() {
    Folder::new().rejects(BAD);
}

#[test]
fn a_file_has_defaults_and_what_a_scene_says() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("a.geojson"), "{}").expect("written");
    let text = "[[geojson]]\nfile = \"a.geojson\"\n[[geojson]]\nfile = \"a.geojson\"\ncolor = \"#0180ff\"\nwidth_px = 3\nopacity = 0.5\nname_key = \"ADMIN\"\n";
    let scene = Scene::from_toml(text, &folder.path().join("scene.toml")).expect("a good scene");
    let [first, second] = scene.geojson.as_slice() else {
        panic!("{:?}", scene.geojson);
    };
    assert_eq!(
        (first.color, first.width_px, first.opacity),
        ([255, 209, 102], 1.5, 0.9)
    );
    assert_eq!(first.name_key, None);
    assert_eq!(
        (second.color, second.width_px, second.opacity),
        ([1, 128, 255], 3.0, 0.5)
    );
    assert_eq!(second.name_key.as_deref(), Some("ADMIN"));
    let summary = scene.summary();
    assert_eq!(summary.matches("\n[[geojson]]\n").count(), 2, "{summary}");
    assert!(
        summary.contains("\n  geojson        lines, polygons and points of "),
        "{summary}"
    );
}
