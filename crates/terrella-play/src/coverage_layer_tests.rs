use super::*;
use std::path::Path;
use terrella_orbit::MAX_CELLS;

fn flight(coverage: &str) -> Result<Flight, PlayError> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config");
    let text = format!(
        "[time]\nstart = \"2018-01-15T00:00:00Z\"\n[orbit]\nfile = \"orbits/iss.tle\"\nname = \"ISS (ZARYA)\"\n\
         sensor_half_angle_deg = 40\nfootprint = false\n[coverage]\n{coverage}"
    );
    Flight::open(Scene::from_toml(&text, &folder.join("test.toml"))?)
}

fn drawn(flight: &Flight) -> Vec<Polygons> {
    let drawn = coverage_polygons(flight.scene(), flight);
    drawn.unwrap_or_else(|error| panic!("{error}"))
}

/// The map is the computation that `terrella coverage` prints, with the satellite's sensor: its cells by class are those of the table.
#[test]
fn the_map_is_the_one_that_the_command_computes() {
    let flight = flight("show = \"count\"\nduration_h = 6\nstep_deg = 10\nmin_elevation_deg = 0\n")
        .expect("opens");
    let legend = coverage_legend(flight.scene(), &flight).expect("computed");
    let legend = legend.expect("a legend");
    assert_eq!(legend.scale.title, "Views in 6 h");
    let sensor = GroundSensor {
        field: FieldOfView::nadir(40_f64.to_radians()),
        min_elevation_rad: 0.0,
    };
    let request = CoverageRequest {
        step_deg: 10.0,
        region_deg: [-180.0, -90.0, 180.0, 90.0],
        length: Some(Duration::from_hours(6.0)),
    };
    let sensors = [(&flight.satellites()[0], sensor)];
    let printed = CoverageMap::new(&flight, &sensors, &request)
        .expect("computed")
        .csv();
    let rows: Vec<Vec<&str>> = printed
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    let shared = flight.coverage().get().expect("kept");
    assert_eq!(shared.cells.len(), rows.len());
    for ((cell, one), row) in shared.cells.iter().zip(&rows) {
        assert_eq!(row[2], one.accesses.to_string());
        assert_eq!(row[0], format!("{:.4}", cell.lat_rad.to_degrees()));
    }
    let seen = shared
        .cells
        .iter()
        .filter(|(_, one)| one.accesses > 0)
        .count();
    assert!((20..rows.len()).contains(&seen), "{seen}");
    let layers = drawn(&flight);
    let classes = &legend.scale.classes;
    assert!(!layers.is_empty() && layers.len() <= classes.len());
    for layer in &layers {
        let style = layer.style();
        assert_eq!(style.opacity, 0.5);
        assert!(classes.iter().any(|class| class.color == style.color));
    }
}

/// Cells across the date line are drawn where they are: all of a small region, and nothing else.
#[test]
fn a_region_across_the_date_line_is_filled_once() {
    let text = "show = \"gap\"\nstep_deg = 5\nregion_deg = [170, -10, -170, 10]\n";
    let flight = flight(text).expect("opens");
    let table = flight.scene().coverage.clone().expect("a map");
    let cells = cells(&flight, &table).expect("computed").expect("at once");
    assert_eq!(cells.cells.len(), 16);
    // Whatever is in view: all cells in one style.
    let mut seen = cells.clone();
    for (_, one) in &mut seen.cells {
        one.accesses = 1;
        one.longest_gap_s = 60.0;
    }
    let scale = CoverageScale::of(&seen, table.show);
    let style = FillStyle {
        color: [1, 2, 3],
        opacity: 0.5,
    };
    let styles = vec![style; scale.classes.len()];
    let layers = polygons(&seen, &scale, &styles, &Ellipsoid::WGS84).expect("a map");
    assert_eq!(layers.len(), 1);
    // 20° × 20° of triangles whose sides are half a degree: two in a square, and some where rows differ.
    let count = layers[0].triangle_count();
    assert!((3_200..5_000).contains(&count), "{count}");
}

#[test]
fn what_cannot_be_computed_is_named() {
    let said = |text: &str| match flight(text) {
        Err(error) => error.to_string(),
        Ok(flight) => {
            let drawn = coverage_polygons(flight.scene(), &flight).map(|_| ());
            drawn.expect_err("cannot be drawn").to_string()
        }
    };
    let unknown = said("show = \"gap\"\nsatellites = [\"ISS (ZARIA)\"]\n");
    assert!(
        unknown.contains("[coverage] satellites") && unknown.contains("did you mean"),
        "{unknown}"
    );
    let fine = said("show = \"gap\"\nstep_deg = 0.1\n");
    assert!(
        fine.contains(&format!("more than {MAX_CELLS} cells")),
        "{fine}"
    );
}

/// Work that nobody wants any more ends, and its map is not kept.
#[cfg(feature = "window")]
#[test]
fn a_thread_computes_the_map_for_a_window_that_does_not_wait() {
    let flight = flight("show = \"gap\"\nstep_deg = 10\n").expect("opens");
    let (done, answers) = std::sync::mpsc::channel();
    std::thread::scope(|scope| {
        let done = move |failure: Option<PlayError>| {
            done.send(failure).expect("it is awaited");
        };
        let work = compute_behind(scope, &flight, done).expect("a thread");
        assert!(work.is_some());
        assert!(answers.recv().expect("an answer").is_none());
    });
    assert!(!drawn(&flight).is_empty());
    let other = self::flight("show = \"gap\"\nduration_h = 8784\n").expect("opens");
    let begin = std::time::Instant::now();
    std::thread::scope(|scope| {
        let work = compute_behind(scope, &other, |_| panic!("it is given up"));
        // Not there yet: nothing is drawn, and nobody waits.
        assert!(drawn(&other).is_empty());
        drop(work);
    });
    assert!(begin.elapsed().as_secs() < 60 && other.coverage().get().is_none());
}
