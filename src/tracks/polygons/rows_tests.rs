use super::*;
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::PI;

const STYLES: [FillStyle; 2] = [
    FillStyle {
        color: [255, 0, 0],
        opacity: 0.5,
    },
    FillStyle {
        color: [0, 0, 255],
        opacity: 0.5,
    },
];

/// Cells of equal width over `lon_deg`, with the style that `style` gives each by its number.
fn row(
    lat_deg: [f64; 2],
    lon_deg: [f64; 2],
    count: usize,
    style: impl Fn(usize) -> Option<usize>,
) -> FillRow {
    let [west, east] = lon_deg.map(f64::to_radians);
    let at = |index: usize| west + (east - west) * index as f64 / count as f64;
    let cells = (0..count).map(|index| FillCell {
        lon_rad: [at(index), at(index + 1)],
        style: style(index),
    });
    FillRow {
        lat_rad: lat_deg.map(f64::to_radians),
        cells: cells.collect(),
    }
}

fn layers(rows: &[FillRow]) -> Vec<Polygons> {
    let made = Polygons::of_rows(&STYLES, &Ellipsoid::WGS84, rows);
    made.unwrap_or_else(|error| panic!("{error}"))
}

fn area_m2(triangles: &[GroundTriangle]) -> f64 {
    let areas = triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.itrf_m;
        0.5 * (b - a).cross(c - a).length()
    });
    areas.sum()
}

/// Of a sphere's zone with the area of WGS 84: close enough for what is compared here.
fn zone_m2(lat_deg: [f64; 2], width_deg: f64) -> f64 {
    let [south, north] = lat_deg.map(|lat: f64| lat.to_radians().sin());
    6.371e6_f64.powi(2) * width_deg.to_radians() * (north - south)
}

/// How often each edge occurs, and how often it is soft, over all layers.
fn edges(layers: &[Polygons]) -> HashMap<[[i64; 3]; 2], (u32, u32)> {
    // To a tenth of a metre: where a row meets itself, meridians differ by a turn.
    let place = |point: DVec3| point.to_array().map(|m| (10.0 * m).round() as i64);
    let mut found: HashMap<_, (u32, u32)> = HashMap::new();
    for triangle in layers.iter().flat_map(|layer| layer.triangles.iter()) {
        for k in 0..3 {
            let mut ends = [1, 2].map(|on| place(triangle.itrf_m[(k + on) % 3]));
            ends.sort_unstable();
            // At a pole edges have no length.
            if ends[0] != ends[1] {
                let entry = found.entry(ends).or_default();
                *entry = (entry.0 + 1, entry.1 + (triangle.edges >> k & 1));
            }
        }
    }
    found
}

#[test]
fn cells_cover_the_area_of_their_rows() {
    let rows = [
        row([40.0, 50.0], [10.0, 30.0], 4, |_| Some(0)),
        row([50.0, 60.0], [10.0, 30.0], 3, |index| {
            (index != 1).then_some(1)
        }),
    ];
    let [low, high] = layers(&rows).try_into().expect("two layers");
    let close = |layer: &Polygons, expected: f64| {
        let area = area_m2(&layer.triangles);
        assert!((area / expected - 1.0).abs() < 0.01, "{area} {expected}");
    };
    close(&low, zone_m2([40.0, 50.0], 20.0));
    close(&high, zone_m2([50.0, 60.0], 40.0 / 3.0));
    assert_eq!((low.style(), high.style()), (STYLES[0], STYLES[1]));
}

/// Rows of different numbers of cells, of which each meridian of a row lies within cells of the next: every edge inside has two triangles
/// with the same ends, and is hard; those around all are soft.
#[test]
fn rows_meet_without_gaps_and_seams() {
    let by = |period: usize| move |index: usize| Some(usize::from(index.is_multiple_of(period)));
    let rows: Vec<_> = [7, 11, 5]
        .into_iter()
        .enumerate()
        .map(|(index, count)| {
            let south = 40.0 + 3.0 * index as f64;
            row([south, south + 3.0], [10.0, 21.0], count, by(index + 2))
        })
        .collect();
    let layers = layers(&rows);
    let triangle_count: usize = layers.iter().map(Polygons::triangle_count).sum();
    assert!(triangle_count > 500, "{triangle_count}");
    let mut around = 0;
    for (count, soft) in edges(&layers).into_values() {
        assert!([(2, 0), (1, 1)].contains(&(count, soft)), "{count} {soft}");
        around += soft;
    }
    assert!(around > 20, "{around}");
    // Two cells of a degree with one between them that is not filled: two edges on each of their sides.
    let styles = |index: usize| (index != 1).then_some(index / 2);
    let layers = self::layers(&[row([0.0, 1.0], [0.0, 3.0], 3, styles)]);
    let soft = edges(&layers)
        .into_iter()
        .filter(|(_, (_, soft))| *soft == 1);
    let length_m = |ends: [[i64; 3]; 2]| {
        let [one, other] = ends.map(|end| DVec3::from_array(end.map(|part| part as f64 / 10.0)));
        one.distance(other)
    };
    let around_km = soft.map(|(ends, _)| length_m(ends)).sum::<f64>() / 1000.0;
    // Of a degree of the equator, of the parallel beside it, and twice of a meridian.
    let expected_km = 2.0 * (111.319 + 111.303 + 2.0 * 110.575);
    assert!(
        (around_km / expected_km - 1.0).abs() < 1e-4,
        "{around_km} {expected_km}"
    );
}

/// One style over the whole Earth has no soft edge at all: not at the date line, not at the poles.
#[test]
fn the_whole_earth_of_one_style_has_no_edge() {
    let rows: Vec<_> = (0..18)
        .map(|index| {
            let south = -90.0 + 10.0 * f64::from(index);
            let count = 3 + (index as usize * 5) % 7;
            row([south, south + 10.0], [-180.0, 180.0], count, |_| Some(0))
        })
        .collect();
    let layers = layers(&rows);
    assert_eq!(layers.len(), 1);
    let triangles = &layers[0].triangles;
    assert!(triangles.iter().all(|triangle| triangle.edges == 0));
    let expected = 4.0 * PI * 6.371e6_f64.powi(2);
    assert!((area_m2(triangles) / expected - 1.0).abs() < 1e-3);
    // At a pole triangles may have no area; then both sides of it are one edge.
    let mut all = edges(&layers).into_values();
    assert!(all.all(|(count, soft)| count % 2 == 0 && soft == 0));
}

#[test]
fn cells_that_make_no_map_are_rejected() {
    let good = row([0.0, 10.0], [0.0, 10.0], 2, |_| Some(0));
    let wrong = |change: &dyn Fn(&mut Vec<FillRow>)| {
        let mut rows = vec![good.clone(), row([10.0, 20.0], [0.0, 10.0], 2, |_| Some(1))];
        assert!(Polygons::of_rows(&STYLES, &Ellipsoid::WGS84, &rows).is_ok());
        change(&mut rows);
        Polygons::of_rows(&STYLES, &Ellipsoid::WGS84, &rows)
            .map(|_| ())
            .expect_err("is wrong")
            .to_string()
    };
    type Change<'c> = &'c dyn Fn(&mut Vec<FillRow>);
    let changes: [(&str, Change<'_>); 7] = [
        ("overlap", &|rows| rows.swap(0, 1)),
        ("no latitudes", &|rows| rows[1].lat_rad[1] = f64::NAN),
        ("no latitudes", &|rows| rows[1].lat_rad[1] = 2.0),
        ("three turns", &|rows| {
            rows[0].cells[0].lon_rad[0] = f64::NEG_INFINITY
        }),
        ("not in order", &|rows| rows[0].cells.swap(0, 1)),
        ("a style", &|rows| rows[0].cells[1].style = Some(2)),
        ("300 000", &|rows| {
            rows[1].lat_rad[1] = 1.5;
            rows[1].cells = (0..200_000_u32)
                .map(|index| FillCell {
                    lon_rad: [index, index + 1].map(|at| f64::from(at) * 3e-5),
                    style: Some(index as usize % 2),
                })
                .collect();
        }),
    ];
    for (said, change) in changes {
        let error = wrong(change);
        assert!(error.contains(said), "{said}: {error}");
    }
    let faint = FillStyle {
        opacity: 0.0,
        ..STYLES[0]
    };
    assert!(Polygons::of_rows(&[faint], &Ellipsoid::WGS84, &[good]).is_err());
}
