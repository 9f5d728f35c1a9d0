//! Georeference in the tags of a GeoTIFF.

use terrella_ground::elevation::geo_tags::{GeoTags, RASTER_TYPE, System};

const RASTER_POINT: u16 = 2;

/// Texel positions of a map by its tags or its world file, in the unit of its system. It has the corner of the first texel, and the
/// size to the east and to the south.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TagGrid {
    pub left: f64,
    pub top: f64,
    pub scale_x: f64,
    pub scale_y: f64,
}

impl TagGrid {
    /// Flips a map that runs from south to north and has this many rows.
    pub(crate) fn north_up(self, rows: u32) -> Self {
        Self {
            top: self.top - self.scale_y * f64::from(rows),
            scale_y: -self.scale_y,
            ..self
        }
    }

    /// Converts to a unit that equals `unit` of the current ones.
    pub(crate) fn in_units_of(self, unit: f64) -> Self {
        Self {
            left: self.left / unit,
            top: self.top / unit,
            scale_x: self.scale_x / unit,
            scale_y: self.scale_y / unit,
        }
    }

    /// The complaint about a map with this grid in degrees, unless it is the whole globe with its left edge at 180° W, north up. `said_by` names the
    /// source of the grid.
    ///
    /// The tolerance is one texel, so maps with texels on whole degrees (grid-registered, 21 601 × 10 801) are accepted.
    pub(crate) fn complaint(&self, width: u32, height: u32, said_by: &str) -> Option<String> {
        let Self { left, top, .. } = *self;
        let (right, bottom) = (
            left + self.scale_x * f64::from(width),
            top - self.scale_y * f64::from(height),
        );
        let near = |value: f64, target: f64, texel: f64| (value - target).abs() <= texel * 1.001;
        let (texel_x, texel_y) = (360.0 / f64::from(width), 180.0 / f64::from(height));
        let fits = near(left, -180.0, texel_x)
            && near(right, 180.0, texel_x)
            && near(top, 90.0, texel_y)
            && near(bottom, -90.0, texel_y);
        (!fits).then(|| {
            format!(
                "covers longitudes {left:.4} to {right:.4} and latitudes {bottom:.4} to {top:.4} by {said_by}"
            )
        })
    }
}

/// Texel positions; `None` if the tags do not state them, an error if they rotate the map.
pub(crate) fn grid_of(tags: &GeoTags) -> Result<Option<TagGrid>, String> {
    if tags.is_unplaced() {
        return Ok(None);
    }
    let (scale_x, scale_y, left, top) = match (&tags.matrix, &tags.scale, &tags.tie) {
        (Some(m), ..) if m.len() == 16 => {
            if m[1] != 0.0 || m[4] != 0.0 {
                return Err("is rotated or sheared by its GeoTIFF matrix".to_string());
            }
            (m[0], -m[5], m[3], m[7])
        }
        (_, Some(scale), Some(tie)) if scale.len() >= 2 && tie.len() >= 6 => (
            scale[0],
            scale[1],
            tie[3] - tie[0] * scale[0],
            tie[4] + tie[1] * scale[1],
        ),
        _ => return Ok(None),
    };
    // The point may be the centre of the texel.
    let half = if tags.key(RASTER_TYPE) == Some(RASTER_POINT) {
        0.5
    } else {
        0.0
    };
    Ok(Some(TagGrid {
        left: left - half * scale_x,
        top: top + half * scale_y,
        scale_x,
        scale_y,
    }))
}

/// The complaint about a map that is not the whole globe in degrees of WGS84, as [`TagGrid::complaint`]. None without tags.
pub(crate) fn complaint_of(tags: &GeoTags, width: u32, height: u32) -> Option<String> {
    let unit_rad = match tags.system() {
        Ok(Some(System::Geographic { unit_rad, .. })) => unit_rad,
        Ok(Some(System::WebMercator)) => {
            return Some("is projected (EPSG:3857 by its GeoTIFF keys)".to_string());
        }
        Ok(None) => 1f64.to_radians(),
        Err(system) => return Some(in_other_system(&system)),
    };
    match grid_of(tags) {
        Ok(Some(grid)) => grid.in_units_of(1f64.to_radians() / unit_rad).complaint(
            width,
            height,
            "its GeoTIFF tags",
        ),
        Ok(None) => None,
        Err(complaint) => Some(complaint),
    }
}

/// Message about a map in an unsupported system.
pub(crate) fn in_other_system(system: &str) -> String {
    format!("lies in {system} by its GeoTIFF keys")
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella_ground::elevation::geo_tags::MODEL_TYPE;

    fn tags(scale: [f64; 2], tie: [f64; 4]) -> GeoTags {
        GeoTags {
            scale: Some(vec![scale[0], scale[1], 0.0]),
            tie: Some(vec![tie[0], tie[1], 0.0, tie[2], tie[3], 0.0]),
            keys: vec![(MODEL_TYPE, 2)],
            ..GeoTags::default()
        }
    }

    #[test]
    fn the_whole_globe_is_taken_and_others_are_named() {
        let whole = tags([0.5, 0.5], [0.0, 0.0, -180.0, 90.0]);
        assert_eq!(complaint_of(&whole, 720, 360), None);
        assert_eq!(complaint_of(&GeoTags::default(), 720, 360), None);
        // Pixels at their own indices mean nothing.
        let mut unplaced = tags([1.0, 1.0], [0.0; 4]);
        unplaced.keys.clear();
        assert_eq!(complaint_of(&unplaced, 720, 360), None);
        // Texels on whole degrees, declared as points: half a texel more on all sides.
        let mut grid = tags([0.5, 0.5], [0.0, 0.0, -180.0, 90.0]);
        grid.keys.push((RASTER_TYPE, RASTER_POINT));
        assert_eq!(complaint_of(&grid, 721, 361), None);

        let shifted = tags([0.5, 0.5], [0.0, 0.0, 0.0, 90.0]);
        assert!(
            complaint_of(&shifted, 720, 360)
                .unwrap()
                .contains("0.0000 to 360.0000")
        );
        let quarter = tags([0.25, 0.25], [0.0, 0.0, -180.0, 90.0]);
        assert!(complaint_of(&quarter, 720, 360).is_some());
        let mut projected = whole.clone();
        projected.keys = vec![(MODEL_TYPE, 1)];
        assert!(
            complaint_of(&projected, 720, 360)
                .unwrap()
                .contains("projected")
        );
        let south_up = GeoTags {
            matrix: Some(vec![
                0.5, 0.0, 0.0, -180.0, 0.0, 0.5, 0.0, -90.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0,
            ]),
            ..GeoTags::default()
        };
        assert!(complaint_of(&south_up, 720, 360).is_some());
        let not_a_number = tags([f64::NAN, 0.5], [0.0, 0.0, -180.0, 90.0]);
        assert!(complaint_of(&not_a_number, 720, 360).is_some());
    }
}
