//! Golden images: every scene in `tests/goldens/`, and some of `config/`, compared with the image of the same name in `tests/goldens/`. The scene
//! `pack` is drawn from a pack that is built for it; for `light` the radiance file is compared.
//!
//! The images are made by the command itself, `terrella frame`, on a software adapter if there is one. They are compared by FLIP, NVIDIA's
//! perceptual measure, because drivers round differently. A scene without its image fails, so does an image without its scene.
//! `TERRELLA_UPDATE_GOLDENS=1` writes the images instead: look at each before it is committed. A failing image is left in the target folder's
//! `goldens/` beside its FLIP map.

use image::RgbImage;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The tolerance of all golden images.
const MOST_MEAN: f32 = 0.008;
/// A pixel is an outlier above this FLIP value …
const OUTLIER: f32 = 0.15;
/// … and this share of outliers fails.
const MOST_OUTLIERS: f32 = 0.001;

/// Scenes of `config/`, drawn smaller.
const OF_CONFIG: [&str; 14] = [
    "aurora",
    "below_clouds",
    "between_clouds",
    "crescent",
    "eclipse",
    "eclipse_low",
    "full_disc",
    "glint",
    "inside_air",
    "moonrise",
    "night",
    "night_europe",
    "relief",
    "sunrise",
];
const SIZE_OF_CONFIG: &str = "320x180";

/// The scene whose `earth` is built from the starter pack's maps.
const OF_PACK: &str = "pack";
/// The scene that is drawn into a float target; its golden is that light, [`LIGHT_EV`] exposed and cut off.
const OF_RADIANCE: &str = "light";
/// Dark enough that nothing of the scene's mirrored Sun is cut off that an 8-bit picture would cut off.
const LIGHT_EV: i32 = -1;

struct Difference {
    mean: f32,
    outliers: f32,
    map: RgbImage,
}

impl Difference {
    fn between(golden: &RgbImage, picture: &RgbImage) -> Self {
        let (width, height) = golden.dimensions();
        let flip = nv_flip::flip(
            nv_flip::FlipImageRgb8::with_data(width, height, golden),
            nv_flip::FlipImageRgb8::with_data(width, height, picture),
            nv_flip::DEFAULT_PIXELS_PER_DEGREE,
        );
        let values = flip.to_vec();
        let count = values.len() as f32;
        Self {
            mean: values.iter().sum::<f32>() / count,
            outliers: values.iter().filter(|v| **v > OUTLIER).count() as f32 / count,
            map: RgbImage::from_raw(
                width,
                height,
                flip.apply_color_lut(&nv_flip::magma_lut()).to_vec(),
            )
            .expect("a map of the same size"),
        }
    }

    fn passes(&self) -> bool {
        self.mean <= MOST_MEAN && self.outliers <= MOST_OUTLIERS
    }
}

fn folder() -> PathBuf {
    Path::new(crate::REPOSITORY).join("tests/goldens")
}

fn names(extension: &str) -> Vec<String> {
    let mut names: Vec<_> = std::fs::read_dir(folder())
        .expect("tests/goldens")
        .map(|entry| entry.expect("a readable entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .map(|path| {
            path.file_stem()
                .expect("a name")
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    names
}

/// The end of a golden's name that shows the edges of triangles alone.
const EDGES: &str = "_edges";

/// Names of all scenes that have a golden. Terrain surfaces with triangles have another of their edges.
fn scenes() -> Vec<String> {
    let mut scenes = names("toml");
    let surfaces = scenes.iter().filter(|name| name.starts_with("surface_"));
    let with_edges = surfaces.filter(|name| !name.ends_with("_cast"));
    let edges: Vec<_> = with_edges.map(|name| format!("{name}{EDGES}")).collect();
    scenes.extend(edges);
    scenes.extend(OF_CONFIG.map(str::to_owned));
    scenes.sort();
    scenes
}

fn picture(name: &str, to: &Path, backend: Option<&str>) -> Result<RgbImage, String> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_terrella"));
    command.arg("frame").arg("-o").arg(to);
    let root = Path::new(crate::REPOSITORY);
    let scene = Path::new(name.strip_suffix(EDGES).unwrap_or(name)).with_extension("toml");
    let radiance = to.with_extension("npy");
    if OF_CONFIG.contains(&name) {
        command.args(["--size", SIZE_OF_CONFIG]);
        command.arg(root.join("config").join(scene));
    } else if name == OF_PACK {
        let beside = to.with_file_name("of_pack");
        build_pack(&beside.join("earth"))?;
        let text = std::fs::read(folder().join(&scene)).map_err(|e| e.to_string())?;
        std::fs::write(beside.join(&scene), text).map_err(|e| e.to_string())?;
        command.arg(beside.join(scene));
    } else {
        command.args(name.ends_with(EDGES).then_some("--wireframe"));
        command.arg(folder().join(scene));
    }
    if name == OF_RADIANCE {
        command.arg("--radiance").arg(&radiance);
    }
    command.env_remove("TERRELLA_TEXTURES");
    if let Some(adapter) = software_adapter() {
        command.args(["--adapter", &adapter]);
    }
    if let Some(backend) = backend {
        command.env("WGPU_BACKEND", backend);
    }
    let output = command.output().map_err(|e| e.to_string())?;
    if !output.status.success() {
        return Err(format!(
            "{}: {}",
            output.status,
            String::from_utf8_lossy(&output.stderr)
        ));
    }
    if name == OF_RADIANCE {
        let shown = of_light(&radiance);
        std::fs::remove_file(&radiance).map_err(|e| e.to_string())?;
        shown.save(to).map_err(|e| e.to_string())?;
        return Ok(shown);
    }
    Ok(image::open(to).map_err(|e| e.to_string())?.to_rgb8())
}

/// A small pack of the starter pack's day map and clouds.
fn build_pack(to: &Path) -> Result<(), String> {
    let textures = Path::new(crate::REPOSITORY).join("textures");
    let output = Command::new(env!("CARGO_BIN_EXE_terrella"))
        .args([
            "--quiet",
            "pack",
            "build",
            "--restart",
            "--storage",
            "plain",
        ])
        .args(["--pixels", "day=128,64,32", "--pixels", "clouds=64,32"])
        .arg("--day")
        .arg(textures.join("day.jpg"))
        .arg("--clouds")
        .arg(textures.join("clouds.jpg"))
        .arg("-o")
        .arg(to)
        .output()
        .map_err(|e| e.to_string())?;
    match output.status.success() {
        true => Ok(()),
        false => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
    }
}

/// Light that was written as an array, exposed, cut off at white and encoded in sRGB.
fn of_light(path: &Path) -> RgbImage {
    let (height, width, light) = crate::pictures::numpy(path);
    let exposed = 2_f32.powi(LIGHT_EV);
    let codes = light.into_iter().map(|light| {
        let shown = (light * exposed).clamp(0.0, 1.0);
        let code = match shown <= 0.003_130_8 {
            true => 12.92 * shown,
            false => 1.055 * shown.powf(1.0 / 2.4) - 0.055,
        };
        (255.0 * code).round() as u8
    });
    RgbImage::from_raw(width as u32, height as u32, codes.collect()).expect("of that size")
}

/// The name of a software adapter, or `TERRELLA_TEST_ADAPTER`.
fn software_adapter() -> Option<String> {
    std::env::var("TERRELLA_TEST_ADAPTER").ok().or_else(|| {
        let reports = pollster::block_on(terrella::internals::gpu::adapter_reports());
        reports
            .into_iter()
            .find(|report| report.kind == "software")
            .map(|report| report.name)
    })
}

#[test]
fn pictures_match_their_goldens() {
    let update = std::env::var_os("TERRELLA_UPDATE_GOLDENS").is_some();
    let scratch = Path::new(env!("CARGO_TARGET_TMPDIR")).join("goldens");
    std::fs::create_dir_all(&scratch).expect("a scratch folder");
    let scenes = scenes();
    assert!(scenes.len() >= 24, "scenes are missing: {scenes:?}");
    let mut failures = Vec::new();
    for name in &scenes {
        let drawn = scratch.join(name).with_extension("png");
        let picture = match picture(name, &drawn, None) {
            Ok(picture) => picture,
            Err(error) => {
                failures.push(format!("{name}: not drawn: {error}"));
                continue;
            }
        };
        let golden = folder().join(name).with_extension("png");
        if update {
            picture.save(&golden).expect("the golden can be written");
            continue;
        }
        let expected = match image::open(&golden) {
            Ok(expected) => expected.to_rgb8(),
            Err(error) => {
                failures.push(format!("{name}: no golden picture: {error}"));
                continue;
            }
        };
        if expected.dimensions() != picture.dimensions() {
            failures.push(format!(
                "{name}: {:?} instead of {:?}",
                picture.dimensions(),
                expected.dimensions()
            ));
            continue;
        }
        let difference = Difference::between(&expected, &picture);
        println!(
            "{name}: FLIP mean {:.4}, outliers {:.3} %",
            difference.mean,
            100.0 * difference.outliers
        );
        if difference.passes() {
            std::fs::remove_file(&drawn).expect("the scratch picture can be removed");
        } else {
            let map = scratch.join(format!("{name}_flip.png"));
            difference
                .map
                .save(&map)
                .expect("the FLIP map can be written");
            failures.push(format!(
                "{name}: FLIP mean {:.4} (at most {MOST_MEAN}), outliers {:.3} % (at most {:.3} %); see {} and {}",
                difference.mean,
                100.0 * difference.outliers,
                100.0 * MOST_OUTLIERS,
                drawn.display(),
                map.display()
            ));
        }
    }
    assert!(
        !update,
        "goldens written; look at each, then run again without TERRELLA_UPDATE_GOLDENS"
    );
    assert!(
        failures.is_empty(),
        "{} of {} pictures:\n{}",
        failures.len(),
        scenes.len(),
        failures.join("\n")
    );
}

/// OpenGL rounds depths more coarsely than the others; the air must not sink into the ground for that.
#[test]
fn opengl_draws_the_same_limb() {
    let reports = pollster::block_on(terrella::internals::gpu::adapter_reports());
    if !reports.iter().any(|report| report.backend == "gl") {
        eprintln!("SKIPPED: opengl_draws_the_same_limb: no OpenGL adapter here");
        return;
    }
    let scratch = Path::new(env!("CARGO_TARGET_TMPDIR")).join("limb_gl.png");
    let drawn = picture("limb", &scratch, Some("gl")).expect("a picture");
    let golden = image::open(folder().join("limb.png"))
        .expect("the golden")
        .to_rgb8();
    // Stricter than a golden: the fault is a few patches of ground without air.
    let differing = golden
        .pixels()
        .zip(drawn.pixels())
        .filter(|(a, b)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 8))
        .count();
    println!("limb on OpenGL: {differing} pixels differ");
    assert!(
        differing < 10,
        "{differing} pixels; see {}",
        scratch.display()
    );
}

#[test]
fn every_golden_has_its_scene() {
    assert_eq!(names("png"), scenes());
}

#[test]
fn the_comparison_can_fail() {
    let golden = image::open(folder().join("sahara.png"))
        .expect("the golden")
        .to_rgb8();
    let same = Difference::between(&golden, &golden);
    assert!(same.passes() && same.mean == 0.0);
    let (width, height) = golden.dimensions();
    let shifted = RgbImage::from_fn(width, height, |x, y| *golden.get_pixel((x + 2) % width, y));
    let darker = RgbImage::from_fn(width, height, |x, y| {
        golden
            .get_pixel(x, y)
            .0
            .map(|v| (f32::from(v) * 0.9) as u8)
            .into()
    });
    let seam = RgbImage::from_fn(width, height, |x, y| {
        if x == width / 2 {
            [0, 0, 0].into()
        } else {
            *golden.get_pixel(x, y)
        }
    });
    for (what, broken) in [
        ("upside down", image::imageops::flip_vertical(&golden)),
        ("mirrored", image::imageops::flip_horizontal(&golden)),
        ("two pixels aside", shifted),
        ("a tenth darker", darker),
        ("a one-pixel seam", seam),
    ] {
        let difference = Difference::between(&golden, &broken);
        println!(
            "{what}: FLIP mean {:.4}, outliers {:.3} %",
            difference.mean,
            100.0 * difference.outliers
        );
        assert!(!difference.passes(), "{what} passes");
    }
}
