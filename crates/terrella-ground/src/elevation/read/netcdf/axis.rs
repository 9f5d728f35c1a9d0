//! Coordinates of rows and columns.

use super::stored::Shape;
use super::variable::{Variable, text};
use crate::elevation::read::HeightFileError;
use crate::elevation::read::error::FileContext;
use std::io::{BufRead, Seek};

/// Largest deviation of coordinates from equal steps, in steps; single precision causes that much.
const UNEVEN: f64 = 0.05;

/// Names of an axis.
pub(super) struct Axis {
    name: &'static str,
    /// Its units (CF Conventions 1.11, 4.1 and 4.2), in lower case.
    units: [&'static str; 6],
}

pub(super) const LATITUDE: Axis = Axis {
    name: "lat",
    units: [
        "degrees_north",
        "degree_north",
        "degrees_n",
        "degree_n",
        "degreesn",
        "degreen",
    ],
};
pub(super) const LONGITUDE: Axis = Axis {
    name: "lon",
    units: [
        "degrees_east",
        "degree_east",
        "degrees_e",
        "degree_e",
        "degreese",
        "degreee",
    ],
};

impl Axis {
    /// Whether a coordinate variable belongs to this axis.
    pub(super) fn is_of(&self, variable: &Variable) -> bool {
        let name = variable.name.to_ascii_lowercase();
        let unit = text(&variable.attributes, "units").map(|unit| unit.trim().to_ascii_lowercase());
        match unit.as_deref() {
            None | Some("degrees" | "degree" | "deg") => name.starts_with(self.name),
            Some(unit) => self.units.contains(&unit),
        }
    }

    /// First coordinate and step, degrees.
    pub(super) fn read<R: BufRead + Seek>(
        &self,
        reader: &mut R,
        variable: &Variable,
        count: u32,
        context: &FileContext,
    ) -> Result<(f64, f64), HeightFileError> {
        let name = &variable.name;
        if !self.is_of(variable) {
            return Err(context.other_coordinates(format!("the coordinates {name:?}")));
        }
        let shape = Shape {
            rows: 1,
            columns: count as usize,
            bytes: variable.kind.bytes(),
        };
        let values = variable.values.found(reader, &shape, context)?;
        // At most 8 × `MAX_SIDE` bytes.
        let mut degrees = vec![f64::NAN; count as usize];
        values.read(reader, &shape, context, &mut |_, first, bytes| {
            for (degree, value) in degrees[first..]
                .iter_mut()
                .zip(bytes.chunks_exact(shape.bytes))
            {
                *degree = variable.kind.number(value).unwrap_or(f64::NAN);
            }
            Ok::<_, HeightFileError>(())
        })?;
        if self.name == "lon" {
            // A step from 179 to −180 goes east.
            let mut turns = 0.0;
            let mut before = f64::NEG_INFINITY;
            for value in &mut degrees {
                if *value < before - 180.0 {
                    turns += 360.0;
                }
                before = *value;
                *value += turns;
            }
        }
        let first = degrees[0];
        let last = degrees[degrees.len() - 1];
        let step = (last - first) / f64::from(count - 1);
        let even = |(n, value): (usize, &f64)| {
            (value - (first + n as f64 * step)).abs() <= UNEVEN * step.abs()
        };
        let is_good = step.is_finite() && step != 0.0 && degrees.iter().enumerate().all(even);
        if !is_good || self.name == "lon" && step < 0.0 {
            return Err(context.rejected(
                format!("has coordinates {name:?} at unequal steps, or only one"),
                "equal steps, longitudes to the east",
                format!(
                    "`gdalwarp -t_srs EPSG:4326 {} OUT.tif`",
                    context.path().display()
                ),
            ));
        }
        Ok((first, step))
    }
}
