//! Terrain: when it is drawn, and with which surface.

use super::Folder;
use terrella_ground::globe::clipmap::Trim;
use terrella_ground::globe::quadtree::SplitRule;
use terrella_ground::globe::{SurfaceKind, SurfaceSettings};

#[test]
fn heights_of_a_pack_are_the_ground_if_asked_for() {
    let folder = Folder::new();
    let load = |text: &str| {
        folder
            .load(format!("[earth]\npack = \"maps\"\n{text}"))
            .expect("good")
    };
    assert_eq!(load("").earth.relief, None);
    let alone = load("pack_heights = true\n");
    let relief = alone.earth.relief.as_ref().expect("relief");
    assert_eq!(relief.surface, SurfaceKind::Quadtree);
    assert_eq!(
        (relief.elevation.len(), relief.pack_heights_mb),
        (0, Some(256.0))
    );
    assert!(
        alone
            .summary()
            .contains("quadtree from the pack's elevation data"),
        "{}",
        alone.summary()
    );
    let under = load("pack_heights = true\nground_mb = 64\nelevation = [\"sat.tle\"]\n");
    let relief = under.earth.relief.as_ref().expect("relief");
    assert_eq!(
        (relief.elevation.len(), relief.pack_heights_mb),
        (1, Some(64.0))
    );
    assert!(
        under
            .summary()
            .contains("one elevation file over the pack's"),
        "{}",
        under.summary()
    );
    let off = load("pack_heights = false\nelevation = []\n").earth.relief;
    assert_eq!(off.expect("relief").pack_heights_mb, None);
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
    let reported = (options.samples, options.levels, options.trim);
    assert_eq!(reported, (257, 24, Trim::Hexagon));
    let grid = "[earth]\nsurface = \"projected-grid\"\nprojected_grid = { samples = [65, 1025], on_gpu = false }\n";
    let SurfaceSettings::ProjectedGrid(options) = relief(grid).expect("relief").settings else {
        panic!("not a grid");
    };
    assert_eq!((options.samples, options.on_gpu), ((65, 1025), false));
    // Keys that are not given keep their defaults, and the summary lists everything.
    let scene = folder
        .load("[earth]\nsurface = \"clipmap\"\nclipmap = { levels = 6 }\n")
        .expect("good");
    let reported = "{ samples = 129, levels = 6, trimming = \"diamond\" }";
    assert!(scene.summary().contains(reported), "{}", scene.summary());
    assert!(given.denoise && !starter.denoise);
    let cast = "[earth]\nsurface = \"contours\"\ncontours = { drawn = \"cast\" }\n";
    let settings = relief(cast).expect("relief").settings;
    assert!(matches!(settings, SurfaceSettings::CastContours(_)));
    let summary = folder.load(cast).expect("good").summary();
    assert!(summary.contains("{ drawn = \"cast\" }"), "{summary}");
    let tree = "[earth]\nsurface = \"quadtree\"\n[earth.quadtree]\nlambda = 300\nculling = false\nmax_leaves = 512\n";
    let SurfaceSettings::Quadtree(options) = relief(tree).expect("relief").settings else {
        panic!("not a quadtree");
    };
    let reported = (options.split_rule, options.is_culled, options.max_leaves);
    assert_eq!(reported, (SplitRule::Paper { lambda: 300.0 }, false, 512));
    // The tolerance is in force for surfaces that look at it alone.
    let in_force = |text: &str| {
        let summary = folder.load(text).expect("good").full_summary();
        let line = summary.lines().find(|line| line.contains("tolerance_px"));
        !line.expect("a line").contains("not used")
    };
    assert!(in_force("[earth]\nelevation = []\n"));
    for text in [
        tree,
        "[earth]\nsurface = \"projected-grid\"\n",
        "[earth]\nsurface = \"blocks\"\nelevation = []\n",
    ] {
        assert!(
            !in_force(text),
            "{}",
            folder.load(text).expect("good").summary()
        );
    }
    for (text, words) in [
        (
            "surface = \"quadtree\"\nquadtree = { lambda = 0.5 }",
            ["quadtree", "lambda must be from 1 to 1000000"],
        ),
        (
            "surface = \"quadtree\"\nquadtree = { max_leaves = 100 }",
            ["quadtree", "max_leaves must be a whole number from 512"],
        ),
        (
            "surface = \"quadtree\"\nquadtree = { culling = 1 }",
            ["quadtree", "culling must be true or false"],
        ),
        (
            "surface = \"quadtree\"\nquadtree = { leaves = 1 }",
            ["quadtree", "lambda, culling and max_leaves, not leaves"],
        ),
        (
            "surface = \"clipmap\"\nquadtree = { culling = true }",
            ["quadtree", "is for surface = \"quadtree\""],
        ),
        (
            "surface = \"quadtree\"\ncontours = { drawn = \"cast\" }",
            ["contours", "for surface = \"contours\""],
        ),
        (
            "surface = \"contours\"\ncontours = { drawn = \"casts\" }",
            ["contours", "must be \"patches\" or \"cast\""],
        ),
        ("sea_floor = true", ["sea_floor", "is for terrain"]),
        ("denoise = true", ["denoise", "is for terrain"]),
        ("tolerance_px = 2", ["tolerance_px", "is for terrain"]),
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
