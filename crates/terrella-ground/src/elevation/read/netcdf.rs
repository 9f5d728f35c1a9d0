//! NetCDF: one variable over latitude and longitude. Other dimensions before them, such as time, must have length 1.
//!
//! The containers ([`classic`] and [`hdf5`]) list the variables and locate their values. The meaning of the variables is the same in both.

mod axis;
mod classic;
mod hdf5;
mod mapping;
mod number;
mod stored;
mod variable;

use super::error::FileContext;
use super::sidecar::HeightUnit;
use super::{Conversion, Header, HeightFileError};
use crate::elevation::{Georeference, GridError, MAX_SIDE, Registration};
use axis::{LATITUDE, LONGITUDE};
use number::NumberType;
use std::io::{BufRead, Seek};
use stored::{Found, Shape};
use terrella_files::printable;
use variable::{Contents, Variable, number, text};

/// A NetCDF file with a parsed header.
pub(super) struct NetCdf<R: BufRead + Seek> {
    reader: R,
    values: Found,
    shape: Shape,
    kind: NumberType,
    is_unsigned: bool,
}

impl<R: BufRead + Seek> NetCdf<R> {
    pub(super) fn open(
        mut reader: R,
        magic: &[u8],
        context: &FileContext,
        wanted: Option<&str>,
    ) -> Result<(Self, Header), HeightFileError> {
        let Contents {
            dimensions,
            attributes: of_file,
            variables,
        } = match magic {
            [b'C', ..] => classic::contents(&mut reader, context)?,
            _ => hdf5::contents(&mut reader, context)?,
        };

        let (chosen, [lat, lon]) = select_variable(&variables, &dimensions, wanted, context)?;
        mapping::check(&variables, chosen, context)?;
        let (rows, columns) = (dimensions[lat].1, dimensions[lon].1);
        // A length of 0 means the record dimension.
        let side = |length| u32::try_from(length).unwrap_or(u32::MAX);
        let (rows, columns) = (side(rows), side(columns));
        let sides = 1..=MAX_SIDE;
        if !sides.contains(&columns) || !sides.contains(&rows) {
            return Err(context.grid(GridError::Size { columns, rows }));
        }
        let coordinates = |dimension| coordinates(&variables, &dimensions, dimension);
        if coordinates(lat).is_some_and(|variable| LONGITUDE.is_of(variable)) {
            let (path, name) = (context.path().display(), &chosen.name);
            return Err(context.rejected(
                format!("has the variable {name:?} over longitude and latitude"),
                "rows from west to east: latitude, then longitude",
                format!(
                    "`ncpdq -a {},{} {path} OUT.nc`",
                    dimensions[lon].0, dimensions[lat].0
                ),
            ));
        }
        let mut axis = |dimension: usize, axis: &axis::Axis| {
            let count = if dimension == lat { rows } else { columns };
            coordinates(dimension)
                .map(|variable| axis.read(&mut reader, variable, count, context))
                .transpose()
        };
        let place = match (axis(lat, &LATITUDE)?, axis(lon, &LONGITUDE)?) {
            (Some(lat), Some(lon)) => Some((lat, lon)),
            _ => None,
        };
        let is_cells = [&of_file, &chosen.attributes]
            .iter()
            .any(|attributes| number(attributes, "node_offset") == Some(1.0));
        let unit = match text(&chosen.attributes, "units") {
            None | Some("") => None,
            Some(word) => Some(HeightUnit::from_word(word).ok_or_else(|| {
                context.rejected(
                    format!("has heights of the unit {word:?}"),
                    "metres or feet",
                    format!(
                        "`ncap2 -s '{0}={0}*METRES_PER_UNIT; {0}@units=\"m\"' {1} OUT.nc`",
                        chosen.name,
                        context.path().display()
                    ),
                )
            })?),
        };
        let header = Header {
            columns,
            rows,
            georeference: place.map(|((south, lat_step), (west, lon_step))| Georeference {
                columns,
                rows,
                registration: if is_cells {
                    Registration::Cells
                } else {
                    Registration::Posts
                },
                north_rad: if lat_step > 0.0 {
                    (south + f64::from(rows - 1) * lat_step).to_radians()
                } else {
                    south.to_radians()
                },
                lat_step_rad: lat_step.abs().to_radians(),
                west_rad: west.to_radians(),
                lon_step_rad: lon_step.to_radians(),
            }),
            plain: None,
            warp: None,
            is_south_first: place.is_some_and(|((_, lat_step), _)| lat_step > 0.0),
            unit,
            scale: match (
                chosen.is_depth(),
                number(&chosen.attributes, "scale_factor"),
            ) {
                (true, scale) => Some(-scale.unwrap_or(1.0)),
                (false, scale) => scale,
            },
            offset: number(&chosen.attributes, "add_offset").map(|offset| {
                match chosen.is_depth() {
                    true => -offset,
                    false => offset,
                }
            }),
            above: chosen.above(),
            missing: chosen.missing().ok_or_else(|| {
                context.rejected(
                    "names more than 4 missing values",
                    "a fill value, and few others",
                    format!(
                        "`ncatted -a missing_value,{},d,, {}` and nodata in a sidecar",
                        chosen.name,
                        context.path().display()
                    ),
                )
            })?,
        };
        let shape = Shape {
            rows: rows as usize,
            columns: columns as usize,
            bytes: chosen.kind.bytes(),
        };
        let file = Self {
            values: chosen.values.found(&mut reader, &shape, context)?,
            reader,
            shape,
            kind: chosen.kind,
            is_unsigned: chosen.is_unsigned(),
        };
        Ok((file, header))
    }

    /// Bytes per stored value.
    #[cfg(test)]
    pub fn value_bytes(&self) -> usize {
        self.kind.bytes()
    }

    /// Rows of a chunk.
    pub fn chunk_rows(&self) -> usize {
        self.values.chunk_rows()
    }

    /// Peak memory of reading, bytes: the values' buffers, and a row as metres.
    pub fn working_bytes(&self) -> u64 {
        self.values.working_bytes(&self.shape) + self.shape.columns as u64 * 4
    }

    /// Passes on all rows.
    pub fn read<E: From<HeightFileError>>(
        &mut self,
        context: &FileContext,
        conversion: &Conversion,
        put: &mut impl FnMut(usize, usize, &mut [f32]) -> Result<(), E>,
    ) -> Result<(), E> {
        let (kind, is_unsigned) = (self.kind, self.is_unsigned);
        let mut heights_m = vec![0.0; self.shape.columns];
        let mut put_stored = |row: usize, column: usize, stored: &[u8]| {
            let count = stored.len() / kind.bytes();
            let heights_m = &mut heights_m[..count];
            for (height_m, value) in heights_m.iter_mut().zip(stored.chunks_exact(kind.bytes())) {
                let stored = kind.number(value);
                let stored = stored.map(|stored| match is_unsigned {
                    true => kind.unsigned(stored),
                    false => stored,
                });
                *height_m = stored.map_or(f32::NAN, |stored| conversion.metres(stored));
            }
            put(row, column, heights_m)
        };
        self.values
            .read(&mut self.reader, &self.shape, context, &mut put_stored)
    }
}

/// The coordinate variable of a dimension.
fn coordinates<'a>(
    variables: &'a [Variable],
    dimensions: &[(String, u64)],
    dimension: usize,
) -> Option<&'a Variable> {
    let of_name = |v: &&Variable| v.name == dimensions[dimension].0 && v.dimensions == [dimension];
    variables.iter().find(of_name)
}

/// The variable of heights with its dimensions of rows and columns. It is the named variable, the only one with two dimensions, or the
/// only such variable over latitude and longitude.
fn select_variable<'a>(
    variables: &'a [Variable],
    dimensions: &[(String, u64)],
    wanted: Option<&str>,
    context: &FileContext,
) -> Result<(&'a Variable, [usize; 2]), HeightFileError> {
    let grid = |v: &'a Variable| match v.dimensions.as_slice() {
        [others @ .., lat, lon]
            if v.kind != NumberType::Char && others.iter().all(|n| dimensions[*n].1 == 1) =>
        {
            Some((v, [*lat, *lon]))
        }
        _ => None,
    };
    let mut grids: Vec<_> = variables.iter().filter_map(grid).collect();
    let names = |grids: &[(&Variable, [usize; 2])]| {
        let names: Vec<_> = grids.iter().map(|(v, _)| v.name.as_str()).collect();
        printable(&names.join(", "))
    };
    let write = "write variable = \"NAME\" in the sidecar";
    if let Some(wanted) = wanted {
        let is_wanted = |(v, _): &&(&Variable, _)| v.name == wanted.trim_start_matches('/');
        return grids.iter().find(is_wanted).copied().ok_or_else(|| {
            context.rejected(
                format!("has no variable {wanted:?} over two dimensions"),
                format!("one of: {}", names(&grids)),
                write,
            )
        });
    }
    // Bounds of times and cells also have two dimensions.
    let is_placed = |(_, [lat, lon]): &(&Variable, [usize; 2])| {
        let is = |dimension, axis: &axis::Axis| {
            let coordinates = coordinates(variables, dimensions, dimension);
            coordinates.is_some_and(|variable| axis.is_of(variable))
        };
        is(*lat, &LATITUDE) && is(*lon, &LONGITUDE)
    };
    if grids.len() > 1 && grids.iter().any(is_placed) {
        grids.retain(is_placed);
    }
    match grids.as_slice() {
        [only] => Ok(*only),
        [_, _, ..] => Err(context.rejected(
            "has several variables over two dimensions",
            format!("one of: {}", names(&grids)),
            write,
        )),
        [] if variables.iter().any(|v| v.name == "x_range") => Err(context.rejected(
            "is a grid of GMT before version 4.1, of one dimension",
            "heights over latitude and longitude",
            format!("`gmt grdconvert {} OUT.nc`", context.path().display()),
        )),
        [] => Err(context.rejected(
            "has no variable over two dimensions",
            "heights over latitude and longitude, of one time or level",
            "take one time or level out of it (`ncks -d time,0`)",
        )),
    }
}
