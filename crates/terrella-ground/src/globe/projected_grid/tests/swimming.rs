//! Changes of drawn heights at fixed places while the eye moves.

use super::*;

/// Rough ground: waves from 200 km down to 50 m, each half as long as the one before and 0.55 times as high.
struct Rough {
    /// Whether heights are averaged over the samples' spacing or read unfiltered.
    filtered: bool,
}

impl Elevation for Rough {
    fn height_m(&self, lat_rad: f64, lon_rad: f64, spacing_rad: f64) -> f64 {
        let n = Ellipsoid::normal(lat_rad, lon_rad) * R;
        let spacing_m = if self.filtered { spacing_rad * R } else { 0.0 };
        let mut sum = 800.0;
        let (mut height, mut length) = (500.0, 200e3);
        for octave in 0..13 {
            let turn = f64::from(octave) * 2.4;
            let k = std::f64::consts::TAU / length;
            let half = k * spacing_m;
            let left = if half < 1e-3 { 1.0 } else { half.sin() / half };
            for turn in [turn, turn + 1.3] {
                let across = DVec3::new(turn.cos(), turn.sin(), (2.0 * turn).cos()).normalize();
                sum += height * left * (k * n.dot(across) + turn).sin();
            }
            (height, length) = (height * 0.55, length * 0.5);
        }
        sum
    }

    fn range_m(&self, _: &Bounds) -> HeightRange {
        HeightRange {
            low_m: -1_500.0,
            high_m: 3_100.0,
        }
    }

    fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
        4e-6
    }
}

/// The height that a patch draws at a place, or `None` if no triangle covers it.
fn drawn(grid: &ProjectedGrid, lat: f64, lon: f64) -> Option<(f64, DVec3)> {
    let frame = grid.frame()?;
    let (columns, rows) = frame.samples;
    let caster = &frame.caster;
    let normal = Ellipsoid::normal(lat, lon);
    let place = (normal * caster.radii_m).normalize();
    let theta = place.cross(caster.up).length().atan2(place.dot(caster.up));
    let aside = (place - caster.up * place.dot(caster.up)).try_normalize()?;
    let at = caster.on_screen(&frame.screen, theta, aside);
    let cell = (at - frame.rect.low) / frame.rect.size()
        * DVec2::new(f64::from(columns - 1), f64::from(rows - 1));
    let foot = place * caster.radii_m - frame.eye_itrf_m;
    let east = DVec3::new(-normal.y, normal.x, 0.0).normalize();
    let north = normal.cross(east);
    let index = |i: i64, j: i64| (j * i64::from(columns) + i) as usize;
    let (i0, j0) = (cell.x.floor() as i64, cell.y.floor() as i64);
    // The cell itself first, then those around it.
    for reach in 0..=1 {
        for j in j0 - reach..=j0 + reach {
            for i in i0 - reach..=i0 + reach {
                let inside = (0..i64::from(columns) - 1).contains(&i)
                    && (0..i64::from(rows) - 1).contains(&j);
                if !inside {
                    continue;
                }
                for triangle in [
                    [index(i, j), index(i + 1, j), index(i + 1, j + 1)],
                    [index(i, j), index(i + 1, j + 1), index(i, j + 1)],
                ] {
                    let corners = triangle.map(|k| {
                        let off = grid.samples[k].foot_m - foot;
                        DVec2::new(off.dot(east), off.dot(north))
                    });
                    let [a, b, c] = corners;
                    let area = (b - a).perp_dot(c - a);
                    let parts = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)].map(|p| p / area);
                    if parts.into_iter().all(|part| part >= -1e-6) {
                        let height = (0..3)
                            .map(|k| parts[k] * grid.samples[triangle[k]].height_m)
                            .sum();
                        return Some((height, foot + normal * height));
                    }
                }
            }
        }
    }
    None
}

struct Scene {
    name: &'static str,
    look: Look,
    /// Degrees of latitude and of heading per frame.
    step: (f64, f64),
}

const FRAMES: usize = 8;

/// Change per frame, root mean square and largest, and error compared with the ground itself, root mean square; pixels.
fn swim(scene: &Scene, options: &GridOptions, ground: &Rough) -> (f64, f64, f64) {
    let flat = Ground::Flat(800.0);
    let mut grid = ProjectedGrid::new(options);
    let mut look = scene.look;
    // Places that the first image's rays hit, evenly over it.
    grid.prepare(&look.view(&flat), ground);
    let frame = *grid.frame().unwrap();
    let mut places = Vec::new();
    for j in 0..40 {
        for i in 0..40 {
            let at = (DVec2::new(f64::from(i), f64::from(j)) + 0.5) / 20.0 - 1.0;
            let direction = frame.screen.direction(at * 0.9);
            if frame.caster.nadir(direction) < frame.caster.limb_rad - 2e-3 {
                // The ray's own place, without the pull towards the limb.
                let mut straight = frame.caster;
                straight.spread_rad = 0.0;
                let normal = (straight.foot(direction).place / frame.caster.radii_m).normalize();
                places.push((normal.z.asin(), normal.y.atan2(normal.x)));
            }
        }
    }
    let mut last: Vec<Option<f64>> = vec![None; places.len()];
    let (mut squares, mut most, mut count) = (0.0, 0.0_f64, 0.0);
    let (mut off_squares, mut off_count) = (0.0, 0.0);
    for _ in 0..FRAMES {
        let view = look.view(&flat);
        grid.prepare(&view, ground);
        for (place, last) in places.iter().zip(&mut last) {
            let now = drawn(&grid, place.0, place.1);
            if let Some((height, from_eye)) = now {
                let normal = Ellipsoid::normal(place.0, place.1);
                let aside = normal.cross(from_eye.normalize()).length();
                let px = |metres: f64| metres.abs() * aside / from_eye.length() / view.pixel_rad;
                if let Some(before) = last {
                    let change = px(height - *before);
                    squares += change * change;
                    most = most.max(change);
                    count += 1.0;
                }
                let off = px(height - ground.height_m(place.0, place.1, 0.0));
                off_squares += off * off;
                off_count += 1.0;
            }
            *last = now.map(|(height, _)| height);
        }
        look.lat += scene.step.0;
        look.heading += scene.step.1;
    }
    assert!(count > 3_000.0, "{}: {count}", scene.name);
    (
        (squares / count).sqrt(),
        most,
        (off_squares / off_count).sqrt(),
    )
}

#[test]
fn heights_do_not_swim() {
    let scenes = [
        Scene {
            name: "400 km, 127 m a frame",
            look: Look {
                pitch: 50.0,
                ..LOOK
            },
            step: (127.0 / 111e3, 0.0),
        },
        Scene {
            name: "2 km, 2 m a frame",
            look: Look {
                height_m: 2e3,
                pitch: 75.0,
                ..LOOK
            },
            step: (2.0 / 111e3, 0.0),
        },
        Scene {
            name: "2 km, 0.1° of heading a frame",
            look: Look {
                height_m: 2e3,
                pitch: 75.0,
                ..LOOK
            },
            step: (0.0, 0.1),
        },
    ];
    let free = GridOptions::on_cpu();
    let filtered = Rough { filtered: true };
    println!("change a frame, px rms and most; error, px rms (720 lines)");
    for scene in &scenes {
        let unfiltered = swim(scene, &free, &Rough { filtered: false });
        println!("{}: not filtered: {unfiltered:.3?}", scene.name);
        let mut reported = Vec::new();
        for anchor in [Anchor::Direction, Anchor::Screen] {
            for footprint in [SampleFootprint::Mean, SampleFootprint::Longer] {
                let options = GridOptions {
                    anchor,
                    footprint,
                    ..free
                };
                let result = swim(scene, &options, &filtered);
                println!("{}: {anchor:?}, {footprint:?}: {result:.3?}", scene.name);
                reported.push(result);
            }
        }
        // The default, compared with the same grid with unfiltered heights.
        let chosen = reported[0];
        assert!(
            chosen.0 < 0.6 * unfiltered.0 && chosen.1 < 0.2,
            "{}",
            scene.name
        );
    }
}
