//! Filled polygons on the ground: areas of a map, footprints, forecasts.

mod plane;
mod rows;
mod triangulation;

use super::TracksError;
use super::ink::Ink;
use super::projection::EyeProjection;
use crate::gpu::{PassFormat, Triangle};
use glam::DVec3;
pub use rows::{FillCell, FillRow};
use std::sync::Arc;
use terrella_frames::{Ellipsoid, Geodetic};
use triangulation::{CutPolygon, GroundTriangle, step_rad};

/// Largest number of triangles of all polygons of one [`Tracks`](super::Tracks), after the subdivision of large ones.
pub const MAX_TRIANGLES: usize = 300_000;
/// Number of triangles that are culled as a whole.
const PART_TRIANGLES: usize = 128;

/// How polygons are filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FillStyle {
    /// Display values (sRGB).
    pub color: [u8; 3],
    /// Above 0 to 1.
    pub opacity: f64,
}

impl FillStyle {
    fn check(&self) -> Result<(), TracksError> {
        match self.opacity > 0.0 && self.opacity <= 1.0 {
            true => Ok(()),
            false => Err(TracksError::Lines {
                what: "the opacity of a fill must be above 0 and at most 1",
            }),
        }
    }
}

/// Polygons of one style, Earth-fixed, for [`Tracks::set_polygons`](super::Tracks::set_polygons). Clones share their triangles.
///
/// Each polygon is triangulated in the plane of longitude and latitude, where its edges are straight, and subdivided to follow the ellipsoid. Its
/// edge is thus as sharp near the ground as from afar, whatever its size.
///
/// ```
/// use terrella::frames::{Ellipsoid, Geodetic};
/// use terrella::tracks::{FillStyle, Polygons};
///
/// let style = FillStyle { color: [255, 122, 89], opacity: 0.4 };
/// let ring = |corners: [(f64, f64); 4]| corners.map(|(lat, lon)| Geodetic::from_degrees(lat, lon, 0.0)).to_vec();
/// let area = ring([(8.0, 168.0), (8.0, -170.0), (22.0, -170.0), (22.0, 168.0)]);
/// let hole = ring([(12.0, 178.0), (12.0, -178.0), (16.0, -178.0), (16.0, 178.0)]);
/// let polygons = Polygons::on_ground(style, &Ellipsoid::WGS84, [vec![area, hole]])?;
/// // tracks.set_polygons(vec![polygons])?;
/// # Ok::<(), terrella::tracks::TracksError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Polygons {
    style: FillStyle,
    triangles: Arc<[GroundTriangle]>,
    parts: Arc<[Part]>,
    crossing: usize,
}

/// Consecutive triangles.
#[derive(Clone, Debug)]
struct Part {
    center_itrf_m: DVec3,
    radius_m: f64,
    first: usize,
    end: usize,
}

impl Polygons {
    /// Polygons on the ellipsoid. Each is an outer ring and the holes in it, given as positions whose heights are ignored; the last position of a
    /// ring may repeat the first. Edges are straight in latitude and longitude, as in GeoJSON (RFC 7946, 3.1.1), and take the shorter way around
    /// the Earth. Rings may have either winding. A ring around a pole encloses the pole of the hemisphere that contains most of its corners.
    ///
    /// # Errors
    /// A style out of range, a position that is not finite, or more than [`MAX_TRIANGLES`].
    pub fn on_ground(
        style: FillStyle,
        ellipsoid: &Ellipsoid,
        polygons: impl IntoIterator<Item = Vec<Vec<Geodetic>>>,
    ) -> Result<Self, TracksError> {
        style.check()?;
        let mut cut = Vec::new();
        for rings in polygons {
            let is_place =
                |place: &Geodetic| place.lat_rad.is_finite() && place.lon_rad.is_finite();
            if !rings.iter().flatten().all(is_place) {
                let what = "a latitude or longitude is not finite";
                return Err(TracksError::Lines { what });
            }
            cut.push(CutPolygon::new(&plane::flatten(&rings)));
        }
        let step_rad = step_rad(&cut);
        let mut triangles = Vec::new();
        for polygon in &cut {
            polygon.subdivide(step_rad, ellipsoid, MAX_TRIANGLES, &mut triangles);
            if triangles.len() > MAX_TRIANGLES {
                let what = "polygons have more than 300 000 triangles; leave some out";
                return Err(TracksError::Lines { what });
            }
        }
        let crossing = cut.iter().filter(|polygon| !polygon.is_sound).count();
        Ok(Self::of_triangles(style, triangles, crossing))
    }

    fn of_triangles(style: FillStyle, triangles: Vec<GroundTriangle>, crossing: usize) -> Self {
        let parts = triangles.chunks(PART_TRIANGLES).enumerate();
        let parts = parts.map(|(index, part)| Part::new(index * PART_TRIANGLES, part));
        Self {
            style,
            parts: parts.collect(),
            triangles: triangles.into(),
            crossing,
        }
    }

    /// Their fill style.
    pub fn style(&self) -> FillStyle {
        self.style
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Number of polygons whose rings cross themselves or each other: parts of them are not filled, or filled twice.
    pub fn crossing_count(&self) -> usize {
        self.crossing
    }
}

impl Part {
    fn new(first: usize, triangles: &[GroundTriangle]) -> Self {
        let corners = || triangles.iter().flat_map(|triangle| triangle.itrf_m);
        let center_itrf_m = corners().sum::<DVec3>() / (3 * triangles.len()).max(1) as f64;
        let reach = corners().map(|corner| corner.distance_squared(center_itrf_m));
        Self {
            center_itrf_m,
            radius_m: reach.fold(0.0, f64::max).sqrt(),
            first,
            end: first + triangles.len(),
        }
    }
}

/// Polygons, and their colour as the target stores it.
#[derive(Clone)]
pub(super) struct InkedPolygons {
    pub polygons: Polygons,
    colors: [[u16; 4]; 2],
}

impl InkedPolygons {
    pub fn new(polygons: Polygons, format: &PassFormat) -> Self {
        let FillStyle { color, opacity } = polygons.style;
        let colors = Ink::new(format, color, opacity < 1.0).at(opacity);
        Self { polygons, colors }
    }

    /// Adds the triangles of a frame: those of parts in sight.
    pub fn write(&self, eye: &EyeProjection<'_>, out: &mut Vec<Triangle>) {
        for part in self.polygons.parts.iter() {
            if eye.faces_away(part.center_itrf_m, part.radius_m)
                || eye.bounds(part.center_itrf_m, part.radius_m).is_none()
            {
                continue;
            }
            out.extend(
                self.polygons.triangles[part.first..part.end]
                    .iter()
                    .map(|triangle| {
                        let [a_m, b_m, c_m] = triangle
                            .itrf_m
                            .map(|corner| (corner - eye.itrf_m).as_vec3().to_array());
                        Triangle {
                            a_m,
                            edges: triangle.edges,
                            b_m,
                            c_m,
                            colors: self.colors,
                        }
                    }),
            );
        }
    }
}
