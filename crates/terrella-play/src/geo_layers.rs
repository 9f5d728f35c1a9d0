//! `[[geojson]]` of a scene: its files as lines, polygons, marks and names on the globe, and their parts that are not drawn.

use super::error::PlayError;
use super::geojson::{GeoJson, GeoPolygon, GeoStyle, UsualStyle};
use super::maps::DroppedLayer;
use crate::scene::{GeojsonTable, Scene};
use std::path::PathBuf;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::tracks::{
    FillStyle, GroundMark, LineStyle, MAX_LINE_POINTS, MAX_PLACES, MAX_TRIANGLES, Polygons,
    Polylines,
};

/// Name of these files in lists of dropped layers.
const LAYER: &str = "geojson";
/// Least width that marks are drawn for, pixels: smaller rings look like dots.
const LEAST_MARK_PX: f64 = 1.5;

/// Elements of a scene's files.
#[derive(Default)]
pub(super) struct GeoLayers {
    pub lines: Vec<Polylines>,
    pub polygons: Vec<Polygons>,
    pub marks: Vec<GroundMark>,
    /// Name of each mark, empty if it has none.
    pub names: Vec<String>,
    /// Parts that are left out.
    pub dropped: Vec<DroppedLayer>,
    /// Parts whose style differs from the file.
    pub notes: Vec<String>,
}

/// The files of a scene's `[[geojson]]`.
pub(super) fn geo_files(scene: &Scene) -> Vec<PathBuf> {
    scene
        .geojson
        .iter()
        .map(|table| table.file.clone())
        .collect()
}

/// Reads a scene's files; `points_taken` is the number of points of its other lines.
///
/// # Errors
/// In a strict scene, the first error in a file.
pub(super) fn geo_layers(
    scene: &Scene,
    ellipsoid: &Ellipsoid,
    points_taken: usize,
) -> Result<GeoLayers, PlayError> {
    let mut layers = GeoLayers::default();
    let mut points_left = MAX_LINE_POINTS.saturating_sub(points_taken);
    for table in &scene.geojson {
        layers.add(scene, table, ellipsoid, &mut points_left)?;
    }
    Ok(layers)
}

impl GeoLayers {
    fn add(
        &mut self,
        scene: &Scene,
        table: &GeojsonTable,
        ellipsoid: &Ellipsoid,
        points_left: &mut usize,
    ) -> Result<(), PlayError> {
        let usual = UsualStyle {
            line: GeoStyle {
                color: table.color,
                opacity: table.opacity,
                width_px: table.width_px,
            },
            fill_opacity: table.fill_opacity,
        };
        let read = match GeoJson::read(&table.file, usual, table.name_key.as_deref()) {
            Ok(read) => read,
            Err(error) => return self.fault(scene, table, error.to_string(), false),
        };
        for remark in &read.remarks {
            self.fault(scene, table, remark.to_string(), remark.is_drawn)?;
        }
        if read.more_remarks > 0 {
            let what = format!("{} more remarks about features", read.more_remarks);
            self.fault(scene, table, what, false)?;
        }
        let name = table.file.display();
        if read.wrong_windings > 0 {
            self.notes.push(format!(
                "{name}: polygons of {} features are clockwise, against RFC 7946, 3.1.6; their outlines are the same",
                read.wrong_windings
            ));
        }
        if !read.ignored.is_empty() {
            self.notes.push(format!(
                "{name}: these properties are not drawn: {}",
                read.ignored.join(", ")
            ));
        }
        for (style, lines) in read.lines {
            let style = LineStyle {
                width_px: style.width_px as f32,
                ..LineStyle::thin(style.color, style.opacity)
            };
            // Polylines stop reading at their own limit.
            let lines = Polylines::on_ground(style, ellipsoid, lines)
                .ok()
                .filter(|lines| lines.point_count() <= *points_left);
            match lines {
                Some(lines) => {
                    *points_left -= lines.point_count();
                    self.lines.push(lines);
                }
                None => {
                    let what = format!(
                        "some lines are left out: the scene's lines have more than {MAX_LINE_POINTS} points"
                    );
                    self.fault(scene, table, what, false)?;
                }
            }
        }
        for (style, polygons) in read.fills {
            self.fill(scene, table, ellipsoid, style, polygons)?;
        }
        let room = MAX_PLACES - self.marks.len();
        if read.points.len() > room {
            let what = format!("it has more than {room} points and names; the rest is left out");
            self.fault(scene, table, what, false)?;
        }
        let mut points = read.points;
        // Names of points are written first.
        points.sort_by_key(|point| !point.is_marked);
        for point in points.into_iter().take(room) {
            self.marks.push(GroundMark {
                place: Geodetic {
                    height_m: 0.0,
                    ..point.place
                },
                color: point.color,
                opacity: table.opacity,
                width_px: table.width_px.max(LEAST_MARK_PX) as f32,
                is_marked: point.is_marked,
                is_named: point.name.is_some(),
            });
            self.names.push(point.name.unwrap_or_default());
        }
        Ok(())
    }

    /// Adds filled polygons of one style.
    fn fill(
        &mut self,
        scene: &Scene,
        table: &GeojsonTable,
        ellipsoid: &Ellipsoid,
        style: FillStyle,
        polygons: Vec<GeoPolygon>,
    ) -> Result<(), PlayError> {
        let taken: usize = self.polygons.iter().map(Polygons::triangle_count).sum();
        // Polygons stop subdividing at their own limit.
        let polygons = Polygons::on_ground(style, ellipsoid, polygons).ok();
        let Some(polygons) = polygons.filter(|new| taken + new.triangle_count() <= MAX_TRIANGLES)
        else {
            let what = format!(
                "some polygons are not filled: the scene's polygons have more than {MAX_TRIANGLES} triangles"
            );
            return self.fault(scene, table, what, false);
        };
        let crossing = polygons.crossing_count();
        self.polygons.push(polygons);
        match crossing {
            0 => Ok(()),
            _ => {
                let what = format!(
                    "{crossing} polygons have rings that cross; their filling has gaps or covers twice"
                );
                self.fault(scene, table, what, true)
            }
        }
    }

    /// Notes a fault, or rejects it in a strict scene.
    fn fault(
        &mut self,
        scene: &Scene,
        table: &GeojsonTable,
        what: String,
        is_drawn: bool,
    ) -> Result<(), PlayError> {
        if scene.earth.strict {
            return Err(PlayError::GeoJson {
                scene: scene.path.clone(),
                file: table.file.clone(),
                what,
            });
        }
        let said = format!("{}: {what}", table.file.display());
        match is_drawn {
            true => self.notes.push(said),
            false => self.dropped.push(DroppedLayer {
                layer: LAYER,
                missing: said,
            }),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(folder: &std::path::Path, head: &str) -> Scene {
        let text = format!("{head}[[geojson]]\nfile = \"a.geojson\"\nwidth_px = 1\n");
        let path = folder.join("a.toml");
        Scene::from_toml(&text, &path).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn faults_are_reported_by_kind_and_reject_a_strict_scene() {
        let folder = tempfile::tempdir().expect("a folder");
        let text = r#"{"type":"FeatureCollection","features":[
            {"type":"Feature","geometry":{"type":"Polygon","coordinates":[[[0,0],[0,1],[1,1]]]}},
            {"type":"Feature","geometry":{"type":"Point","coordinates":[0,99]}},
            {"type":"Feature","properties":{"title":"A"},"geometry":{"type":"Point","coordinates":[0,9]}}]}"#;
        std::fs::write(folder.path().join("a.geojson"), text).expect("written");
        let wgs84 = Ellipsoid::WGS84;
        let layers = geo_layers(&scene(folder.path(), ""), &wgs84, 0).expect("lenient");
        assert_eq!((layers.lines.len(), layers.marks.len()), (1, 1));
        assert_eq!(layers.names, ["A"]);
        assert!(layers.marks[0].is_named && layers.marks[0].is_marked);
        assert_eq!(layers.marks[0].width_px, 1.5);
        let [dropped] = layers.dropped.as_slice() else {
            panic!("{:?}", layers.dropped);
        };
        assert!(
            dropped
                .missing
                .contains("a.geojson: feature 1: latitude 99"),
            "{dropped:?}"
        );
        let notes = layers.notes.join("\n");
        assert!(notes.contains("feature 0: a ring is not closed"), "{notes}");
        assert!(
            notes.contains("polygons of 1 features are clockwise"),
            "{notes}"
        );
        let strict = scene(folder.path(), "[earth]\nstrict = true\n");
        let error = geo_layers(&strict, &wgs84, 0)
            .map(|_| ())
            .expect_err("strict");
        let said = error.to_string();
        assert!(
            said.contains("feature 0: a ring is not closed") && said.contains("strict = true"),
            "{said}"
        );
    }

    #[test]
    fn lines_beyond_the_limit_are_left_out() {
        let folder = tempfile::tempdir().expect("a folder");
        // 720 pieces of half a degree.
        let text = r#"{"type":"LineString","coordinates":[[-180,0],[180,0]]}"#;
        std::fs::write(folder.path().join("a.geojson"), text).expect("written");
        let scene = scene(folder.path(), "");
        let count = |taken| {
            let layers = geo_layers(&scene, &Ellipsoid::WGS84, taken).expect("lenient");
            (layers.lines.len(), layers.dropped.len())
        };
        assert_eq!(count(MAX_LINE_POINTS - 800), (1, 0));
        assert_eq!(count(MAX_LINE_POINTS - 600), (0, 1));
    }
}
