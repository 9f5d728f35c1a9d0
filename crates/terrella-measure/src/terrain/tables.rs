//! The measurements, one table each.

use super::TerrainError;
use super::draw::{Canvas, SIZE};
use super::field::HeightField;
use super::qbernstein::{MAX_DEGREE, QBasis};
use super::quadtree::{ErrorMetric, GridQuadtree, Order, SelectedLeaves, TreeView};
use super::storage::Storage;
use super::table::Table;
use super::trees::{TreeBuilds, quadtree_options};
use crate::Quantiles;
use glam::DVec3;
use std::time::Instant;
use terrella_ground::globe::quadtree::SplitRule;

/// λ of the publication's table: metres of distance for a metre of error.
const LAMBDA: f64 = 300.0;
/// Number of times that a tree is built for its time; the minimum counts.
const BUILDS: usize = 3;
/// How often leaves are selected for their time.
const CHOICES: usize = 15;
/// How often a frame is drawn for its time, after one that is not counted.
const FRAMES: usize = 5;
/// Height of the eye over the middle of the southern edge, metres.
const EYE_M: f64 = 500.0;

/// Time of some work, seconds, and its result.
fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let begin = Instant::now();
    let answer = work();
    (begin.elapsed().as_secs_f64(), answer)
}

/// Median and least, milliseconds.
fn median_and_least_ms(count: usize, mut work: impl FnMut()) -> (f64, f64) {
    let times: Vec<f64> = (0..count).map(|_| 1e3 * timed(&mut work).0).collect();
    let least = times.iter().copied().fold(f64::INFINITY, f64::min);
    (Quantiles::of(&times).median, least)
}

/// Over the middle of the southern edge, looking north.
fn view(tree: &GridQuadtree, split_rule: SplitRule, is_culled: bool) -> TreeView {
    let (columns, rows) = tree.size();
    let post = (rows - 1) * columns + columns / 2;
    TreeView {
        eye_m: tree.post_m(post as u32) + EYE_M * DVec3::Z,
        split_rule,
        pixel_rad: 1.0 / f64::from(SIZE.1),
        tolerance_px: 1.0,
        metric: ErrorMetric::Midpoints,
        is_culled,
    }
}

/// Table 1 of the publication: leaves saved, and frames.
pub(super) fn rates() -> Table {
    let title = format!(
        "Quadtree (Table 1 of the publication): part of the cells that need no leaf of their own; triangles; time of choosing \
         the last ones; frames/s, of choosing, uploading and drawing together, at {} × {}. Each size holds every second post of \
         the one above it. The eye stands {EYE_M} m over the middle of the southern edge and looks north; λ = {LAMBDA}.",
        SIZE.0, SIZE.1
    );
    let head = [
        "ground",
        "size",
        "merged, %",
        "and λ, %",
        "and culled, %",
        "triangles, all",
        "merged",
        "and λ",
        "and culled",
        "choosing, ms",
        "frames/s, all",
        "merged",
        "and λ",
        "and culled",
    ];
    Table::new("rates", title, &head)
}

/// A row of [`rates`].
pub(super) fn rate(
    trees: &TreeBuilds<'_>,
    field: &HeightField,
    canvas: Option<&mut Canvas>,
    is_pictured: bool,
) -> Result<(Vec<String>, Option<image::RgbaImage>), TerrainError> {
    let options = quadtree_options(Order::default(), trees.threads, trees.memory_bytes);
    let tree = trees.quadtree(field, &options)?;
    trees.check_cancelled()?;
    let lambda = SplitRule::Paper { lambda: LAMBDA };
    let everything = SplitRule::Paper {
        lambda: f64::INFINITY,
    };
    let views = [
        view(&tree, everything, false),
        view(&tree, lambda, false),
        view(&tree, lambda, true),
    ];
    let (mut selected, mut indices) = (SelectedLeaves::default(), Vec::new());
    let mut row = vec![field.name.clone(), field.size()];
    let mut triangles = vec![2 * tree.cells()];
    for view in &views {
        tree.select(view, &mut selected);
        tree.triangles(&selected, &mut indices);
        let saved = 1.0 - selected.leaves().len() as f64 / tree.cells().max(1) as f64;
        row.push(format!("{:.1}", 100.0 * saved));
        triangles.push(indices.len() / 3);
    }
    row.extend(triangles.iter().map(usize::to_string));
    let (choosing_ms, _) = median_and_least_ms(CHOICES, || {
        tree.select(&views[2], &mut selected);
        tree.triangles(&selected, &mut indices);
    });
    row.push(format!("{choosing_ms:.2}"));
    let what = format!("frames of {}, {}", field.name, field.size());
    let mut picture = None;
    match canvas {
        Some(canvas) => {
            trees
                .progress
                .begin(&what, Some((views.len() as u64 + 1) * FRAMES as u64));
            let rates = frames(trees, &tree, &views, canvas);
            trees.progress.end();
            row.extend(rates?);
            if is_pictured {
                picture = Some(canvas.picture()?);
            }
        }
        None => row.extend(["-"; 4].map(str::to_owned)),
    }
    Ok((row, picture))
}

/// Frames per second of all cells and of each view; "-" if the device cannot hold them.
fn frames(
    trees: &TreeBuilds<'_>,
    tree: &GridQuadtree,
    views: &[TreeView; 3],
    canvas: &mut Canvas,
) -> Result<Vec<String>, TerrainError> {
    let (mut selected, mut indices) = (SelectedLeaves::default(), Vec::new());
    let mut rates = Vec::new();
    if !canvas.set_posts(tree) {
        return Ok(vec!["-".to_owned(); 4]);
    }
    for view in [None].into_iter().chain(views.iter().map(Some)) {
        let mut times = Vec::new();
        for frame in 0..=FRAMES {
            trees.check_cancelled()?;
            let begin = Instant::now();
            // Nothing is selected if everything is drawn, nor uploaded again.
            match view {
                Some(view) => {
                    tree.select(view, &mut selected);
                    tree.triangles(&selected, &mut indices);
                }
                None if frame == 0 => tree.all_triangles(&mut indices),
                None => (),
            }
            if view.is_some() || frame == 0 {
                let fits = canvas.set_triangles(&indices);
                if !fits {
                    break;
                }
            }
            canvas.draw(views[0].eye_m)?;
            if frame > 0 {
                times.push(begin.elapsed().as_secs_f64());
                trees.progress.step();
            }
        }
        rates.push(match Quantiles::of(&times).median {
            0.0 => "-".to_owned(),
            median_s => format!("{:.1}", 1.0 / median_s),
        });
    }
    Ok(rates)
}

/// Sizes of storage formats.
pub(super) fn storage() -> Table {
    let title = "Storage in bytes: 16-bit samples, squares of one height (within the tolerance) merged in Morton order, contours \
                 (three f32 a leaf), q-Bézier patches as they are kept; and the largest distance of a sample from its contour's \
                 middle and from its patch. Contours end at single cells, patches at the samples themselves.";
    let head = [
        "ground",
        "size",
        "tolerance, m",
        "raw",
        "Morton quadtree",
        "contours",
        "patches",
        "contours off, m",
        "patches off, m",
    ];
    Table::new("storage", title, &head)
}

/// A row of [`storage`].
pub(super) fn stored(
    trees: &TreeBuilds<'_>,
    field: &HeightField,
    tolerance_m: f64,
) -> Result<Vec<String>, TerrainError> {
    let dem = field.dem().map_err(|error| field.rejected(error))?;
    // One after the other: both do not fit into the memory for one.
    let contours = trees.contours(field, &dem, tolerance_m, trees.threads)?;
    let contours = contours.stats;
    let options = trees.patch_options(tolerance_m, trees.threads);
    let patches = trees.patches(field, &dem, &options)?;
    let (patch_bytes, error_m) = (patches.packed_bytes(), patches.error_m);
    let bytes = Storage::count(&dem, tolerance_m, &contours, patch_bytes);
    let numbers = [bytes.raw, bytes.morton, bytes.contours, bytes.patches];
    let mut row = vec![field.name.clone(), field.size(), tolerance_m.to_string()];
    row.extend(numbers.iter().map(u64::to_string));
    row.push(format!("{:.2}", 0.5 * contours.thickest_m));
    row.push(format!("{error_m:.2}"));
    Ok(row)
}

/// Times of building.
pub(super) fn builds(threads: &[usize]) -> Table {
    let title = format!("Building, seconds, the least of {BUILDS} runs, and what the tree takes.");
    let mut table = Table::new("builds", title, &["ground", "size", "tree", "tolerance, m"]);
    for threads in threads {
        table.head.push(match threads {
            1 => "1 thread, s".to_owned(),
            _ => format!("{threads} threads, s"),
        });
    }
    table.head.push("memory, MB".to_owned());
    table
}

/// The rows of [`builds`] for a field.
pub(super) fn built(
    trees: &TreeBuilds<'_>,
    field: &HeightField,
    tolerance_m: f64,
    threads: &[usize],
) -> Result<Vec<Vec<String>>, TerrainError> {
    let dem = field.dem().map_err(|error| field.rejected(error))?;
    let memory_bytes = trees.memory_bytes;
    let row = |tree: &str, tolerance: String, times: Vec<f64>, memory_bytes: u64| {
        let mut row = vec![field.name.clone(), field.size(), tree.to_owned(), tolerance];
        row.extend(times.iter().map(|time| format!("{time:.2}")));
        row.push(format!("{:.1}", memory_bytes as f64 / 1e6));
        row
    };
    let (times, tree) = least(threads, |threads| {
        let options = quadtree_options(Order::default(), threads, memory_bytes);
        trees.quadtree(field, &options)
    })?;
    let memory = tree.resident_bytes() as u64;
    drop(tree);
    let quadtree = row("quadtree", "-".to_owned(), times, memory);
    let (times, tree) = least(threads, |threads| {
        trees.contours(field, &dem, tolerance_m, threads)
    })?;
    let memory = tree.stats.bytes;
    drop(tree);
    let contours = row("contours", tolerance_m.to_string(), times, memory);
    let (times, tree) = least(threads, |threads| {
        trees.patches(field, &dem, &trees.patch_options(tolerance_m, threads))
    })?;
    let patches = row("patches", tolerance_m.to_string(), times, tree.bytes());
    Ok(vec![quadtree, contours, patches])
}

/// The minimum time of some builds for each number of threads, and the result.
fn least<T>(
    threads: &[usize],
    build: impl Fn(usize) -> Result<T, TerrainError>,
) -> Result<(Vec<f64>, T), TerrainError> {
    let mut times = Vec::new();
    let mut last = None;
    for threads in threads {
        let mut least_s = f64::INFINITY;
        for _ in 0..BUILDS {
            // Two at a time would not fit into the memory for one.
            drop(last.take());
            let (time_s, tree) = timed(|| build(*threads));
            least_s = least_s.min(time_s);
            last = Some(tree?);
        }
        times.push(least_s);
    }
    // Without any number of threads nothing would be built.
    let tree = match last {
        Some(tree) => tree,
        None => build(1)?,
    };
    Ok((times, tree))
}

/// Times of choosing by the order of nodes in memory.
pub(super) fn orders() -> Table {
    let title = format!(
        "Order of the quadtree's nodes in memory: choosing the leaves of a view, milliseconds, median and least of {CHOICES} runs; \
         of everything, which visits each node, and with λ = {LAMBDA} as above."
    );
    let head = [
        "ground",
        "size",
        "order",
        "all, median",
        "all, least",
        "λ, median",
        "λ, least",
    ];
    Table::new("orders", title, &head)
}

/// The rows of [`orders`] for a field.
pub(super) fn ordered(
    trees: &TreeBuilds<'_>,
    field: &HeightField,
) -> Result<Vec<Vec<String>>, TerrainError> {
    let names = ["plain", "Morton", "Hilbert", "interleaved", "depth-first"];
    let mut rows = Vec::new();
    for (order, name) in Order::ALL.into_iter().zip(names) {
        let options = quadtree_options(order, trees.threads, trees.memory_bytes);
        let tree = trees.quadtree(field, &options)?;
        let mut selected = SelectedLeaves::default();
        let mut row = vec![field.name.clone(), field.size(), name.to_owned()];
        for lambda in [f64::INFINITY, LAMBDA] {
            let view = view(&tree, SplitRule::Paper { lambda }, false);
            tree.select(&view, &mut selected);
            let (median_ms, least_ms) =
                median_and_least_ms(CHOICES, || tree.select(&view, &mut selected));
            row.extend([median_ms, least_ms].map(|time| format!("{time:.3}")));
        }
        rows.push(row);
        trees.check_cancelled()?;
    }
    Ok(rows)
}

/// How much the q-Bernstein bases cost.
pub(super) fn conditions() -> Result<[Table; 2], TerrainError> {
    let mut head = vec!["q".to_owned()];
    head.extend((1..=MAX_DEGREE).map(|degree| format!("degree {degree}")));
    let words: Vec<&str> = head.iter().map(String::as_str).collect();
    let conversion = "q-Bernstein bases: common logarithm of the condition of their conversion to the Bernstein basis and back, \
                      in the norm of the largest row sum.";
    let basis = "The same of the basis itself: the most that Σ|B(t)| comes to, by which values of a curve amplify errors of its \
                 control values.";
    let mut tables = [
        Table::new("condition", conversion, &words),
        Table::new("lebesgue", basis, &words),
    ];
    for power in -6..=6 {
        let q = 10f64.powi(power);
        let mut rows = [vec![format!("1e{power}")], vec![format!("1e{power}")]];
        for degree in 1..=MAX_DEGREE {
            let condition = QBasis::new(degree, q)?.condition();
            rows[0].push(format!("{:.1}", condition.log10_rows));
            rows[1].push(format!("{:.1}", condition.log10_lebesgue));
        }
        for (table, row) in tables.iter_mut().zip(rows) {
            table.rows.push(row);
        }
    }
    Ok(tables)
}
