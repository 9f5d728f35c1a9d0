//! Position and units in the tags of a GeoTIFF (OGC 19-008r4, and GDAL's own tags).

use super::HeightFileError;
use super::error::FileContext;
use super::plain::PlainGrid;
use super::sidecar::HeightUnit;
use crate::elevation::geo_tags::{GEOGRAPHIC_TYPE, GeoTags, MODEL_TYPE, RASTER_TYPE, System};
use crate::elevation::geoid::VerticalDatum;
use crate::elevation::vertical_codes::{
    has_height, is_in_feet, is_in_us_survey_feet, is_of_depths,
};
use crate::elevation::warp::ProjectedGrid;
use crate::elevation::{Georeference, Registration};
use terrella_files::excerpt;

const VERTICAL_TYPE: u16 = 4096;
const VERTICAL_UNITS: u16 = 4099;
const USER_DEFINED: u16 = 32_767;

/// The tags of a file, including GDAL's.
#[derive(Clone, Debug, Default)]
pub(super) struct HeightTags {
    /// Tags of position and units.
    pub geo: GeoTags,
    /// GDAL's XML metadata.
    pub gdal: String,
    /// The band of the heights, from 0.
    pub band: u16,
}

/// Position of a file.
pub(super) enum FilePlacement {
    /// With a flag: the southern row comes first.
    Geographic(Georeference, bool),
    Projected(ProjectedGrid),
    /// A grid in a system that its keys do not name.
    Plain(PlainGrid),
}

impl HeightTags {
    /// The position of the file; `None` if not stated.
    pub(super) fn georeference(
        &self,
        columns: u32,
        rows: u32,
        context: &FileContext,
    ) -> Result<Option<FilePlacement>, HeightFileError> {
        let affine = match self.geo.is_unplaced() {
            true => None,
            false => self.affine(context)?,
        };
        let Some([left, top, right_step, down_step]) = affine else {
            if !self.geo.keys.is_empty() && self.geo.key(MODEL_TYPE).is_some_and(|model| model != 2)
            {
                // This also applies to a known projection: nothing states the position on it.
                self.check_coordinates(context)?;
            }
            return Ok(None);
        };
        let projection = self.geo.projection();
        let radians = match projection {
            Some(_) => Some(1.0),
            None => self.check_coordinates(context)?,
        };
        let registration = match self.geo.key(RASTER_TYPE) {
            None | Some(1) => Registration::Cells,
            Some(2) => Registration::Posts,
            Some(other) => {
                return Err(context.rejected(
                    format!("has the raster type {other}"),
                    "1 (areas) or 2 (points) in GTRasterTypeGeoKey",
                    "rewrite it with `gdal_translate`",
                ));
            }
        };
        // Offset of the first sample's centre from the reference: the corner of the first cell, or
        // the first point itself.
        let half = match registration {
            Registration::Cells => 0.5,
            Registration::Posts => 0.0,
        };
        if !(right_step > 0.0 && down_step != 0.0 && left.is_finite() && top.is_finite()) {
            return Err(context.rejected(
                "runs from east to west, or has steps of no size",
                "columns from west to east",
                format!(
                    "`gdalwarp -t_srs EPSG:4326 {} OUT.tif`",
                    context.path().display()
                ),
            ));
        }
        let is_south_first = down_step < 0.0;
        let first = top - half * down_step;
        if let Some(projection) = projection {
            return Ok(Some(FilePlacement::Projected(ProjectedGrid {
                projection,
                columns,
                rows,
                east_m: left + half * right_step,
                north_m: first,
                column_m: right_step,
                row_m: down_step,
                margin: half,
            })));
        }
        let Some(radians) = radians else {
            return Ok(Some(FilePlacement::Plain(PlainGrid {
                columns,
                rows,
                left: left + half * right_step,
                top: first,
                column: right_step,
                row: down_step,
                registration,
                needs_system: true,
            })));
        };
        let north = if is_south_first {
            first - f64::from(rows.saturating_sub(1)) * down_step
        } else {
            first
        };
        let place = Georeference {
            columns,
            rows,
            registration,
            north_rad: north * radians,
            lat_step_rad: down_step.abs() * radians,
            west_rad: (left + half * right_step) * radians,
            lon_step_rad: right_step * radians,
        };
        Ok(Some(FilePlacement::Geographic(place, is_south_first)))
    }

    /// Longitude and latitude of column 0, row 0, and steps to the east and to the south.
    fn affine(&self, context: &FileContext) -> Result<Option<[f64; 4]>, HeightFileError> {
        if let Some(m) = self.geo.matrix.as_deref() {
            let [a, b, _, c, d, e, _, f, ..] = *m else {
                return Err(context.damaged("ModelTransformation of fewer than 16 numbers"));
            };
            if b != 0.0 || d != 0.0 {
                return Err(context.rotated());
            }
            return Ok(Some([c, f, a, -e]));
        }
        match (self.geo.scale.as_deref(), self.geo.tie.as_deref()) {
            (Some([x, y, ..]), Some([column, row, _, lon, lat, _])) => {
                Ok(Some([lon - column * x, lat + row * y, *x, *y]))
            }
            (Some(_), None) => Err(context.damaged("ModelPixelScale without ModelTiepoint")),
            (None, None) => Ok(None),
            _ => Err(context.rejected(
                "is placed by several points",
                "one point and a scale",
                format!(
                    "`gdalwarp -t_srs EPSG:4326 -r bilinear {} OUT.tif`",
                    context.path().display()
                ),
            )),
        }
    }

    /// Rejects systems that are not latitude and longitude of WGS84 or close to it. Returns radians per unit, `None` if no key
    /// states it.
    fn check_coordinates(&self, context: &FileContext) -> Result<Option<f64>, HeightFileError> {
        match self.geo.system() {
            Ok(Some(System::Geographic {
                unit_rad,
                is_named: true,
            })) => Ok(Some(unit_rad)),
            Ok(Some(System::Geographic { .. })) => {
                Err(context.other_coordinates("geographic coordinates without a name"))
            }
            Ok(Some(System::WebMercator)) => {
                Err(context.other_coordinates("the projected coordinates EPSG:3857"))
            }
            Err(crs) => Err(context.other_coordinates(crs)),
            Ok(None) => Ok(None),
        }
    }

    /// The unit of heights, `None` if the file does not state it.
    pub(super) fn unit(
        &self,
        context: &FileContext,
    ) -> Result<Option<HeightUnit>, HeightFileError> {
        let unknown = |what: String| {
            context.rejected(
                what,
                "metres or feet",
                format!(
                    "`gdal_edit.py -units m -scale METRES_PER_UNIT {}`",
                    context.path().display()
                ),
            )
        };
        if let Some(code) = self.geo.key(VERTICAL_TYPE).map(u32::from)
            && is_of_depths(code)
        {
            return Err(context.rejected(
                format!("has depths (EPSG:{code}), which grow downwards"),
                "heights, which grow upwards",
                format!(
                    "`gdal_calc.py -A {} --calc=-A --outfile=OUT.tif`, then `gdal_edit.py -a_srs EPSG:4326 OUT.tif`, and unit and above in a sidecar",
                    context.path().display()
                ),
            ));
        }
        match self.geo.key(VERTICAL_UNITS) {
            Some(9001) => return Ok(Some(HeightUnit::Metres)),
            Some(9002) => return Ok(Some(HeightUnit::Feet)),
            Some(9003) => return Ok(Some(HeightUnit::UsSurveyFeet)),
            Some(0 | USER_DEFINED) | None => {}
            Some(other) => return Err(unknown(format!("has heights of the unit EPSG:{other}"))),
        }
        if let Some(word) = self.gdal_item("unittype").filter(|word| !word.is_empty()) {
            let shown = excerpt(word);
            return HeightUnit::from_word(word)
                .map(Some)
                .ok_or_else(|| unknown(format!("has heights of the unit {shown:?}")));
        }
        let geographic = self.geo.key(GEOGRAPHIC_TYPE).map(u32::from);
        Ok(match self.geo.key(VERTICAL_TYPE).map(u32::from) {
            // EGM2008, EGM96, EGM84, mean sea level, NAVD88, EVRF2000 and 2007, DHHN2016, ODN.
            Some(3855 | 5773 | 5798 | 5714 | 5703 | 5730 | 5621 | 7837 | 5701) => {
                Some(HeightUnit::Metres)
            }
            Some(code) if is_in_feet(code) => Some(HeightUnit::Feet),
            Some(code) if is_in_us_survey_feet(code) => Some(HeightUnit::UsSurveyFeet),
            Some(code) if has_height(code) => Some(HeightUnit::Metres),
            _ => geographic
                .is_some_and(has_height)
                .then_some(HeightUnit::Metres),
        })
    }

    /// Vertical datum of the heights, `None` if the file does not state it.
    pub(super) fn above(&self) -> Option<VerticalDatum> {
        let codes = [VERTICAL_TYPE, GEOGRAPHIC_TYPE].map(|key| self.geo.key(key));
        codes.into_iter().flatten().find_map(VerticalDatum::of_code)
    }

    /// The text of the band's item with a role in GDAL's metadata.
    pub(super) fn gdal_item(&self, role: &str) -> Option<&str> {
        let role = format!("role=\"{role}\"");
        let sample = format!("sample=\"{}\"", self.band);
        let items = self.gdal.split("<Item ").skip(1);
        let of_role = items.filter_map(|item| item.split_once('>'));
        of_role
            .filter(|(head, _)| {
                head.contains(&role) && (head.contains(&sample) || !head.contains("sample="))
            })
            .find_map(|(_, rest)| rest.split('<').next())
            .map(str::trim)
    }
}
