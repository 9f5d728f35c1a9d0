//! Coverage: how often and how long the sensors of satellites have cells of the ground in view.

use super::field_of_view::{AimedField, FieldOfView, FieldShape};
use super::{Feed, OrbitError};
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use terrella_frames::{Duration, Ellipsoid, Epoch, Geodetic, Orientation};

/// Most cells of a grid.
pub const MAX_CELLS: usize = 200_000;
/// Longest step, seconds.
const LONGEST_STEP_S: f64 = 10.0;
/// Shortest step, seconds.
const SHORTEST_STEP_S: f64 = 0.5;
/// A sensor passes over a place in this many steps or more.
const STEPS_ACROSS: f64 = 8.0;

/// Visibility by a sensor: the ground within its field of view where the satellite's elevation angle is large enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundSensor {
    /// Its field of view on a satellite that flies level.
    pub field: FieldOfView,
    /// Least elevation angle of the satellite above the ground's horizon, radians, 0 to π/2.
    pub min_elevation_rad: f64,
}

/// A part of the ground, by its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Its middle, radians.
    pub lat_rad: f64,
    /// The same.
    pub lon_rad: f64,
    /// From its southern to its northern edge, radians.
    pub height_rad: f64,
    /// From its western to its eastern edge, radians.
    pub width_rad: f64,
}

/// Cells of about the same area: rows of `step_rad`, in each as many as keep them about as wide. `region` is west, south, east and north, radians;
/// a west beyond the east goes across the date line.
pub fn coverage_grid(step_rad: f64, region: [f64; 4]) -> Vec<Cell> {
    let [west, south, east, north] = region;
    let turn = match east > west {
        true => (east - west).min(TAU),
        false => (east - west).rem_euclid(TAU),
    };
    let rows = ((north - south) / step_rad).ceil().max(1.0);
    let height_rad = (north - south) / rows;
    let mut cells = Vec::new();
    for row in 0..rows as usize {
        let lat_rad = south + (row as f64 + 0.5) * height_rad;
        let columns = (turn * lat_rad.cos() / step_rad).ceil().max(1.0);
        let width_rad = turn / columns;
        for column in 0..columns as usize {
            let lon_rad = west + (column as f64 + 0.5) * width_rad;
            cells.push(Cell {
                lat_rad,
                lon_rad: (lon_rad + PI).rem_euclid(TAU) - PI,
                height_rad,
                width_rad,
            });
            if cells.len() > MAX_CELLS {
                return cells;
            }
        }
    }
    cells
}

/// Coverage of a cell in a span.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellCoverage {
    /// Number of times in which at least one satellite sees it.
    pub accesses: u32,
    /// Seconds of these times.
    pub covered_s: f64,
    /// Longest time without view, seconds: the whole span for a cell that is never seen.
    pub longest_gap_s: f64,
    /// Mean time from the end of one view to the beginning of the next, seconds; `None` below two views.
    pub revisit_s: Option<f64>,
}

/// How the satellites cover the cells' middles from `span.0` to `span.1`. A feed that does not know an instant has nothing in view then, and
/// neither has a satellite that has decayed by then.
///
/// Each instant of a grid of time decides for each cell whether it is in view; ends of views are interpolated between the two instants by how
/// far the cell is within the sensor's limits. The step is at most 10 s, and an eighth of the time in which the sensor passes over a place.
/// A view that lies between two instants is missed: that of a field of some kilometres along the flight. Cells are best given row by row: a
/// satellite looks at no row that is out of its sight.
///
/// # Errors
/// What else a feed rejects within its validity.
pub fn coverage(
    cells: &[Cell],
    satellites: &[(&dyn Feed, GroundSensor)],
    ellipsoid: &Ellipsoid,
    orientation: &dyn Fn(Epoch) -> Orientation,
    span: (Epoch, Epoch),
) -> Result<Vec<CellCoverage>, OrbitError> {
    let all = coverage_while(&|| true, cells, satellites, ellipsoid, orientation, span)?;
    Ok(all.unwrap_or_default())
}

/// As [`coverage`], as long as it is wanted: that is asked at every instant, and `None` is answered once it is not.
///
/// # Errors
/// As [`coverage`].
pub fn coverage_while(
    is_wanted: &dyn Fn() -> bool,
    cells: &[Cell],
    satellites: &[(&dyn Feed, GroundSensor)],
    ellipsoid: &Ellipsoid,
    orientation: &dyn Fn(Epoch) -> Orientation,
    span: (Epoch, Epoch),
) -> Result<Option<Vec<CellCoverage>>, OrbitError> {
    let rows: Vec<_> = cells
        .chunk_by(|cell, next| cell.lat_rad == next.lat_rad)
        .map(|row| Row::new(row, ellipsoid))
        .collect();
    let length_s = (span.1 - span.0).to_seconds().max(0.0);
    let step_s = step(satellites, ellipsoid, span.0)?;
    let steps = (length_s / step_s).ceil().max(1.0) as u64;
    let mut views = vec![View::default(); cells.len()];
    let mut margins = vec![f64::NEG_INFINITY; cells.len()];
    for index in 0..=steps {
        if !is_wanted() {
            return Ok(None);
        }
        let t = (index as f64 * step_s).min(length_s);
        let epoch = span.0 + Duration::from_seconds(t);
        let orientation = orientation(epoch);
        margins.fill(f64::NEG_INFINITY);
        for (feed, sensor) in satellites {
            let state = match feed.state_at(epoch) {
                Ok(state) => state,
                Err(error) if is_unknown(&error) => continue,
                Err(error) => return Err(error),
            };
            let (place, flight) = state.inertial_in_itrf_axes(&orientation);
            if let Some(reach) = Reach::new(place, flight, sensor, ellipsoid) {
                reach.add(&rows, &mut margins);
            }
        }
        for (view, margin) in views.iter_mut().zip(&margins) {
            view.step(t, *margin);
        }
    }
    let ended = views.into_iter().map(|view| view.end(length_s));
    Ok(Some(ended.collect()))
}

/// Whether a feed has no state of an instant, and nothing is wrong with it.
fn is_unknown(error: &OrbitError) -> bool {
    use OrbitError::{Decayed, Impact, Lost, NotCovered, OutsideValidity};
    matches!(
        error,
        NotCovered { .. } | OutsideValidity { .. } | Decayed { .. } | Lost { .. } | Impact { .. }
    )
}

/// Successive cells of one latitude.
struct Row {
    lat_rad: f64,
    /// Middles of the cells on the ellipsoid, and the normals there.
    places: Vec<(DVec3, DVec3)>,
}

impl Row {
    fn new(cells: &[Cell], ellipsoid: &Ellipsoid) -> Self {
        let places = cells.iter().map(|cell| {
            let normal = Ellipsoid::normal(cell.lat_rad, cell.lon_rad);
            (ellipsoid.surface_point(normal), normal)
        });
        Self {
            lat_rad: cells.first().map_or(0.0, |cell| cell.lat_rad),
            places: places.collect(),
        }
    }
}

/// Seconds from instant to instant.
fn step(
    satellites: &[(&dyn Feed, GroundSensor)],
    ellipsoid: &Ellipsoid,
    epoch: Epoch,
) -> Result<f64, OrbitError> {
    let mut step_s = LONGEST_STEP_S;
    for (feed, sensor) in satellites {
        let (first, last) = feed.validity();
        let state = match feed.state_at(epoch.max(first).min(last)) {
            Ok(state) => state,
            Err(error) if is_unknown(&error) => continue,
            Err(error) => return Err(error),
        };
        let (radius_m, speed_m_s) = (state.position_m.length(), state.velocity_m_s.length());
        let height_m = radius_m - ellipsoid.polar_radius_m;
        let half_angle_rad = match sensor.field.shape {
            FieldShape::Cone { half_angle_rad } => half_angle_rad,
            FieldShape::Rectangle {
                along_rad,
                across_rad,
            } => along_rad.min(across_rad),
        };
        let width_rad = (2.0 * half_angle_rad.tan() * height_m / radius_m).min(1.0);
        step_s = step_s.min(width_rad * radius_m / speed_m_s / STEPS_ACROSS);
    }
    Ok(step_s.max(SHORTEST_STEP_S))
}

/// The ground that a satellite sees at a time.
struct Reach {
    place_itrf_m: DVec3,
    field: AimedField,
    min_elevation_rad: f64,
    /// Cosine of the angle about the Earth's centre beyond which nothing is in view.
    least_cos: f64,
}

impl Reach {
    /// `None` if it sees nothing.
    fn new(
        place_itrf_m: DVec3,
        flight_itrf: DVec3,
        sensor: &GroundSensor,
        ellipsoid: &Ellipsoid,
    ) -> Option<Self> {
        // The horizon is acos(R/r) away; a degree more for the figure of the Earth.
        let ratio = (ellipsoid.polar_radius_m / place_itrf_m.length()).min(1.0);
        let farthest = ratio.acos() + PI / 180.0;
        Some(Self {
            place_itrf_m,
            field: sensor.field.aimed(place_itrf_m, flight_itrf, ellipsoid)?,
            min_elevation_rad: sensor.min_elevation_rad,
            least_cos: farthest.cos(),
        })
    }

    /// Raises the margin of each place to this satellite's: the smaller of the angles within the limits, radians.
    fn add(&self, rows: &[Row], margins: &mut [f64]) {
        let toward = self.place_itrf_m.normalize_or_zero();
        let lat_rad = toward.z.clamp(-1.0, 1.0).asin();
        let mut rest = margins;
        for row in rows {
            let (margins, after) = rest.split_at_mut(row.places.len());
            rest = after;
            // Two directions are at least as far apart as their latitudes.
            if (row.lat_rad - lat_rad).cos() >= self.least_cos {
                self.add_row(toward, &row.places, margins);
            }
        }
    }

    fn add_row(&self, toward: DVec3, places: &[(DVec3, DVec3)], margins: &mut [f64]) {
        for ((place, normal), margin) in places.iter().zip(margins) {
            if normal.dot(toward) < self.least_cos {
                continue;
            }
            let line = self.place_itrf_m - place;
            let distance = line.length().max(1e-3);
            let elevation = (line.dot(*normal) / distance).clamp(-1.0, 1.0).asin();
            let within = (elevation - self.min_elevation_rad).min(self.field.margin_rad(-line));
            *margin = margin.max(within);
        }
    }
}

/// The views of a cell so far.
#[derive(Clone, Copy, Default)]
struct View {
    found: CellCoverage,
    /// The last instant and its margin.
    before: Option<(f64, f64)>,
    /// When the present view or gap began.
    since_s: f64,
    /// Sum of the gaps between views.
    gaps_s: f64,
}

impl View {
    fn step(&mut self, t: f64, margin: f64) {
        let Some((before_t, before)) = self.before.replace((t, margin)) else {
            self.found.accesses = u32::from(margin >= 0.0);
            return;
        };
        if (before >= 0.0) == (margin >= 0.0) {
            return;
        }
        // Completely out of sight, the margin is not finite and cannot be interpolated.
        let part = match before.is_finite() && margin.is_finite() {
            true => before / (before - margin),
            false => 0.5,
        };
        let at = before_t + part * (t - before_t);
        self.close(at, before >= 0.0);
        self.found.accesses += u32::from(margin >= 0.0);
        self.since_s = at;
    }

    /// Ends the present view or gap.
    fn close(&mut self, at: f64, is_view: bool) {
        let length_s = at - self.since_s;
        if is_view {
            self.found.covered_s += length_s;
            return;
        }
        self.found.longest_gap_s = self.found.longest_gap_s.max(length_s);
        if self.found.accesses > 0 {
            self.gaps_s += length_s;
        }
    }

    fn end(mut self, length_s: f64) -> CellCoverage {
        let is_view = self.before.is_some_and(|(_, margin)| margin >= 0.0);
        let gaps_s = self.gaps_s;
        self.close(length_s, is_view);
        let between = self.found.accesses.saturating_sub(1);
        self.found.revisit_s = (between > 0).then(|| gaps_s / f64::from(between));
        self.found
    }
}

impl Cell {
    /// The corners, from the south-west eastwards, degrees of longitude and latitude; longitudes may exceed 180°.
    pub fn corners_deg(&self) -> [[f64; 2]; 4] {
        let (lat, lon) = (self.lat_rad.to_degrees(), self.lon_rad.to_degrees());
        let (up, out) = (
            0.5 * self.height_rad.to_degrees(),
            0.5 * self.width_rad.to_degrees(),
        );
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|[east, north]| [lon + east * out, (lat + north * up).clamp(-90.0, 90.0)])
    }

    /// Its area relative to that of all cells, up to a constant factor.
    pub fn weight(&self) -> f64 {
        self.lat_rad.cos() * self.height_rad * self.width_rad
    }

    /// Its middle.
    pub fn middle(&self) -> Geodetic {
        Geodetic {
            lat_rad: self.lat_rad,
            lon_rad: self.lon_rad,
            height_m: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AccessFrom, AccessRule, Observer, Sgp4Feed, accesses};
    use std::path::Path;
    use terrella_frames::utc_from_rfc3339;

    fn still(_: Epoch) -> Orientation {
        Orientation::default()
    }

    #[test]
    fn cells_have_about_the_same_area_and_cover_the_earth() {
        let whole = coverage_grid(0.1, [-PI, -0.5 * PI, PI, 0.5 * PI]);
        let area: f64 = whole.iter().map(Cell::weight).sum();
        assert!((area / (2.0 * TAU) - 1.0).abs() < 1e-3, "{area}");
        let middle = whole.iter().filter(|cell| cell.lat_rad.abs() < 1.2);
        assert!(
            middle
                .clone()
                .all(|cell| (0.008..0.0101).contains(&cell.weight()))
        );
        // Across the date line.
        let part = coverage_grid(0.1, [3.0, 0.0, -3.0, 0.2]);
        assert!(part.iter().all(|cell| cell.lon_rad.abs() > 3.0), "{part:?}");
        let [west, south] = part[0].corners_deg()[0];
        assert!((west - 3_f64.to_degrees()).abs() < 1e-9 && south.abs() < 1e-9);
        assert!(coverage_grid(1e-4, [-PI, -1.0, PI, 1.0]).len() == MAX_CELLS + 1);
    }

    /// A satellite over a day: what each instant decides and interpolates against the accesses of every cell by itself, which are found
    /// by bisection, put together by sorting their ends.
    #[test]
    fn every_cell_has_the_accesses_that_a_station_there_has() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/orbits");
        let iss = Sgp4Feed::from_file(&folder.join("iss.tle"), None).expect("released elements");
        let begin = utc_from_rfc3339("2018-01-20T00:00:00Z").expect("a date");
        let span = (begin, begin + Duration::from_days(1.0));
        let sensor = GroundSensor {
            field: FieldOfView::nadir(0.5 * PI),
            min_elevation_rad: 10_f64.to_radians(),
        };
        let cells = coverage_grid(0.8, [-PI, -1.2, PI, 1.2]);
        let satellites: [(&dyn Feed, GroundSensor); 1] = [(&iss, sensor)];
        let found = coverage(&cells, &satellites, &Ellipsoid::WGS84, &still, span).expect("known");
        let mut seen = 0;
        for (cell, covered) in cells.iter().zip(&found) {
            let mask = sensor.min_elevation_rad;
            let observer = Observer::new(cell.middle(), &Ellipsoid::WGS84, mask, &still);
            let from = AccessFrom::Station(&observer);
            let rule = AccessRule::default();
            let expected = accesses(from, &iss, &rule, &Ellipsoid::WGS84, &still, span);
            let expected = expected.expect("known");
            // A view shorter than a step may be missed.
            let is_long = |access: &&crate::Access| (access.end - access.begin).to_seconds() > 10.0;
            let count = expected.iter().filter(is_long).count();
            assert!(
                (count..=expected.len()).contains(&(covered.accesses as usize)),
                "{cell:?}"
            );
            let total: f64 = expected
                .iter()
                .map(|one| (one.end - one.begin).to_seconds())
                .sum();
            assert!(
                (covered.covered_s - total).abs() < 11.0,
                "{} {total}",
                covered.covered_s
            );
            let times = expected.iter().flat_map(|one| [one.begin, one.end]);
            let times = times.map(|epoch| (epoch - begin).to_seconds());
            let times: Vec<f64> = [0.0].into_iter().chain(times).chain([86_400.0]).collect();
            let gaps: Vec<f64> = times
                .as_chunks::<2>()
                .0
                .iter()
                .map(|[end, next]| next - end)
                .collect();
            let longest = gaps.iter().copied().fold(0.0, f64::max);
            if count == expected.len() {
                assert!(
                    (covered.longest_gap_s - longest).abs() < 2.0,
                    "{covered:?} {longest}"
                );
                if count > 1 {
                    let between = &gaps[1..gaps.len() - 1];
                    let mean = between.iter().sum::<f64>() / between.len() as f64;
                    let revisit = covered.revisit_s.expect("two views");
                    assert!((revisit - mean).abs() < 2.0, "{revisit} {mean}");
                    seen += 1;
                }
            }
        }
        assert!(seen > 8, "{seen} of {}", cells.len());
    }

    /// The width of the ground that a sensor passes over is that between the ground ranges of its edges, R (asin(r/R sin η) − η) at η off
    /// nadir.
    #[test]
    fn a_sensor_covers_its_swath() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/orbits");
        let iss = Sgp4Feed::from_file(&folder.join("iss.tle"), None).expect("released elements");
        let begin = utc_from_rfc3339("2018-01-20T21:00:00Z").expect("a date");
        let span = (begin, begin + Duration::from_seconds(1800.0));
        let tilted = FieldOfView {
            shape: FieldShape::Rectangle {
                along_rad: 10_f64.to_radians(),
                across_rad: 15_f64.to_radians(),
            },
            off_nadir_rad: 30_f64.to_radians(),
            azimuth_rad: 0.5 * PI,
        };
        let cells = coverage_grid(0.5_f64.to_radians(), [-PI, -0.95, PI, 0.95]);
        for (field, edges_deg) in [
            (FieldOfView::nadir(20_f64.to_radians()), [-20.0, 20.0]),
            (tilted, [15.0, 45.0]),
        ] {
            let sensor = GroundSensor {
                field,
                min_elevation_rad: 0.0,
            };
            let found = coverage(&cells, &[(&iss, sensor)], &Ellipsoid::WGS84, &still, span);
            let found = found.expect("known");
            let covered = cells.iter().zip(&found).filter(|(_, one)| one.accesses > 0);
            let area_m2: f64 =
                covered.map(|(cell, _)| cell.weight()).sum::<f64>() * 6.371e6_f64.powi(2);
            // Its ground track in Earth-fixed axes, at every ten seconds.
            let place = |t: f64| {
                let epoch = begin + Duration::from_seconds(t);
                iss.state_at(epoch).expect("known").position_itrf_m()
            };
            let swath: f64 = (0..180)
                .map(|k| {
                    let (a, b) = (place(10.0 * f64::from(k)), place(10.0 * f64::from(k + 1)));
                    let height = Ellipsoid::WGS84.geodetic_from_itrf(a).height_m;
                    let [near, far] = edges_deg.map(|deg: f64| {
                        let eta = deg.to_radians();
                        ((1.0 + height / 6.371e6) * eta.sin()).asin() - eta
                    });
                    // A zone between two circles parallel to the track is sin λ high.
                    (far.sin() - near.sin()) * 6.371e6 * a.angle_between(b) * 6.371e6
                })
                .sum();
            assert!((area_m2 / swath - 1.0).abs() < 0.05, "{area_m2} {swath}");
        }
    }
}
