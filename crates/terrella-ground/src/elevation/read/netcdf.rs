//! NetCDF classic (CDF-1, CDF-2): one variable over latitude and longitude.
//!
//! Format: Unidata, "The NetCDF Classic Format Specification". All numbers are big-endian, names and values are padded
//! to four bytes.

mod number;

use super::error::FileContext;
use super::missing::Missing;
use super::sidecar::HeightUnit;
use super::{Conversion, Header, HeightFileError};
use crate::elevation::{Georeference, GridError, MAX_SIDE, Registration};
use number::NumberType;
use std::io::{BufRead, Read, Seek, SeekFrom};
use terrella_files::printable;

/// Largest header, bytes, and most dimensions, attributes or variables of one list.
const HEADER_BYTES: u64 = 1 << 20;
const MAX_ENTRIES: u32 = 1024;
/// Longest name or text that is kept, bytes.
const TEXT_BYTES: u32 = 256;

/// How far coordinates may lie from equal steps, in steps: those of single precision stray that far.
const UNEVEN: f64 = 0.05;

/// An attribute's values: a text or numbers, as many as are kept.
enum AttributeValue {
    Text(String),
    Numbers(NumberType, Vec<f64>),
}

type Attributes = Vec<(String, AttributeValue)>;

fn numbers<'a>(attributes: &'a Attributes, name: &str) -> Option<(NumberType, &'a [f64])> {
    attributes.iter().find_map(|(n, value)| match value {
        AttributeValue::Numbers(kind, numbers) if n == name => Some((*kind, numbers.as_slice())),
        _ => None,
    })
}

fn number(attributes: &Attributes, name: &str) -> Option<f64> {
    numbers(attributes, name).and_then(|(_, numbers)| numbers.first().copied())
}

fn text<'a>(attributes: &'a Attributes, name: &str) -> Option<&'a str> {
    attributes.iter().find_map(|(n, value)| match value {
        // C programs write the end of their strings too.
        AttributeValue::Text(text) if n == name => Some(text.trim_end_matches('\0')),
        _ => None,
    })
}

struct Variable {
    name: String,
    dimensions: Vec<usize>,
    attributes: Attributes,
    kind: NumberType,
    begin: u64,
}

impl Variable {
    /// Whether its whole numbers are meant as unsigned, which the classic format has no types for (NetCDF Users Guide, `_Unsigned`).
    fn is_unsigned(&self) -> bool {
        text(&self.attributes, "_Unsigned").is_some_and(|word| word.eq_ignore_ascii_case("true"))
    }

    /// Numbers of an attribute as those of the variable are read.
    fn as_stored(&self, kind: NumberType, number: f64) -> f64 {
        match self.is_unsigned() && kind == self.kind {
            true => kind.unsigned(number),
            false => number,
        }
    }

    /// Stored numbers that mean no data (NetCDF Users Guide, appendix A); `None` for more than can be kept.
    fn missing(&self) -> Option<Missing> {
        let mut values = Vec::new();
        for name in ["_FillValue", "missing_value"] {
            if let Some((kind, numbers)) = numbers(&self.attributes, name) {
                values.extend(numbers.iter().map(|number| self.as_stored(kind, *number)));
            }
        }
        if number(&self.attributes, "_FillValue").is_none() {
            let fill = self.kind.default_fill();
            values.extend(fill.map(|fill| self.as_stored(self.kind, fill)));
        }
        values.dedup();
        let (lowest, highest) = self.valid();
        let missing = Missing::of_all(&values)?.outside(lowest, highest);
        let names = ["_FillValue", "missing_value"];
        let is_declared = names
            .iter()
            .any(|name| number(&self.attributes, name).is_some());
        Some(match is_declared {
            true => missing,
            false => missing.by_default(),
        })
    }

    /// Lowest and highest stored number that are data.
    fn valid(&self) -> (f64, f64) {
        let first = |name| numbers(&self.attributes, name).map(|(kind, of)| (kind, of.first()));
        let (lowest, highest) = match numbers(&self.attributes, "valid_range") {
            Some((kind, [lowest, highest, ..])) => (Some((kind, lowest)), Some((kind, highest))),
            _ => {
                let bound = |name| first(name).and_then(|(kind, of)| Some((kind, of?)));
                (bound("valid_min"), bound("valid_max"))
            }
        };
        let scale = number(&self.attributes, "scale_factor").unwrap_or(1.0);
        let bound = |bound: Option<(NumberType, &f64)>, outwards: f64| match bound {
            Some((kind, number)) => {
                let stored = self.stored_bound(kind, *number);
                // A bound in one precision must not cut off the same number in another.
                stored + outwards * 1e-6 * (1.0 + stored.abs())
            }
            None => outwards * f64::INFINITY,
        };
        // Unpacked, a negative scale turns the range round.
        let is_turned = scale < 0.0
            && [lowest, highest]
                .iter()
                .flatten()
                .all(|(kind, _)| self.is_unpacked(*kind));
        match is_turned {
            true => (bound(highest, -1.0), bound(lowest, 1.0)),
            false => (bound(lowest, -1.0), bound(highest, 1.0)),
        }
    }

    fn stored_bound(&self, kind: NumberType, bound: f64) -> f64 {
        if !self.is_unpacked(kind) {
            return self.as_stored(kind, bound);
        }
        let scale = number(&self.attributes, "scale_factor").unwrap_or(1.0);
        let offset = number(&self.attributes, "add_offset").unwrap_or(0.0);
        (bound - offset) / scale
    }

    /// Whether a bound is one of unpacked numbers: it is of the type of scale and offset, and that is wider than the variable's.
    fn is_unpacked(&self, kind: NumberType) -> bool {
        let of = |name| numbers(&self.attributes, name).map(|(kind, _)| kind);
        let packing = [of("scale_factor"), of("add_offset")];
        let widest = packing.into_iter().flatten().max_by_key(|kind| kind.rank());
        widest.is_some_and(|widest| kind == widest && widest.rank() > self.kind.rank())
    }
}

/// Reads the header, byte by byte within its bound.
struct HeaderReader<'a, R> {
    reader: std::io::Take<&'a mut R>,
    context: &'a FileContext,
    has_64_bit_offsets: bool,
}

impl<R: Read> HeaderReader<'_, R> {
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], HeightFileError> {
        let mut bytes = [0; N];
        let read = self.reader.read_exact(&mut bytes);
        read.map_err(|error| self.context.reading(error))?;
        Ok(bytes)
    }

    fn word(&mut self) -> Result<u32, HeightFileError> {
        self.bytes().map(u32::from_be_bytes)
    }

    /// So many bytes and their padding; only the first [`TEXT_BYTES`] are kept.
    fn run(&mut self, bytes: u64) -> Result<Vec<u8>, HeightFileError> {
        let kept = bytes.min(u64::from(TEXT_BYTES));
        let mut run = vec![0; kept as usize];
        let read = self.reader.read_exact(&mut run);
        read.map_err(|error| self.context.reading(error))?;
        let rest = bytes.next_multiple_of(4) - kept;
        let skipped = std::io::copy(&mut (&mut self.reader).take(rest), &mut std::io::sink());
        if skipped.map_err(|error| self.context.reading(error))? < rest {
            return Err(self.context.damaged("the file ends too early"));
        }
        Ok(run)
    }

    fn name(&mut self) -> Result<String, HeightFileError> {
        let length = self.word()?;
        if length > TEXT_BYTES {
            return Err(self.context.damaged("a name of more than 256 bytes"));
        }
        let bytes = self.run(u64::from(length))?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// How many entries a list of this tag has.
    fn list(&mut self, tag: u32) -> Result<u32, HeightFileError> {
        let (found, count) = (self.word()?, self.word()?);
        match (found, count) {
            (0, 0) => Ok(0),
            (found, count) if found == tag && count <= MAX_ENTRIES => Ok(count),
            _ => Err(self.context.damaged("a list in the header is not one")),
        }
    }

    fn kind(&mut self) -> Result<NumberType, HeightFileError> {
        let code = self.word()?;
        NumberType::from_code(code)
            .ok_or_else(|| self.context.damaged("an unknown type of numbers"))
    }

    fn attributes(&mut self) -> Result<Attributes, HeightFileError> {
        let mut attributes = Vec::new();
        for _ in 0..self.list(12)? {
            let name = self.name()?;
            let kind = self.kind()?;
            let count = u64::from(self.word()?);
            let bytes = self.run(count * kind.bytes() as u64)?;
            let value = match kind {
                NumberType::Char => {
                    AttributeValue::Text(String::from_utf8_lossy(&bytes).into_owned())
                }
                // What follows the last number pads it to four bytes.
                kind => {
                    let numbers = bytes.chunks_exact(kind.bytes());
                    let numbers = numbers.filter_map(|bytes| kind.number(bytes));
                    let count = usize::try_from(count).unwrap_or(usize::MAX);
                    AttributeValue::Numbers(kind, numbers.take(count).collect())
                }
            };
            attributes.push((name, value));
        }
        Ok(attributes)
    }

    fn variable(&mut self, dimensions: usize) -> Result<Variable, HeightFileError> {
        let name = self.name()?;
        let count = self.word()?;
        if count > MAX_ENTRIES {
            return Err(self.context.damaged("a variable of too many dimensions"));
        }
        let mut of_variable = Vec::new();
        for _ in 0..count {
            let dimension = self.word()? as usize;
            if dimension >= dimensions {
                return Err(self
                    .context
                    .damaged("a variable of a dimension that is not there"));
            }
            of_variable.push(dimension);
        }
        let attributes = self.attributes()?;
        let kind = self.kind()?;
        // The size that follows is redundant.
        self.word()?;
        let begin = if self.has_64_bit_offsets {
            self.bytes().map(u64::from_be_bytes)?
        } else {
            u64::from(self.word()?)
        };
        Ok(Variable {
            name,
            dimensions: of_variable,
            attributes,
            kind,
            begin,
        })
    }
}

/// A NetCDF file whose header has been read.
pub(super) struct NetCdf<R: BufRead + Seek> {
    reader: R,
    columns: usize,
    rows: usize,
    kind: NumberType,
    is_unsigned: bool,
    begin: u64,
}

impl<R: BufRead + Seek> NetCdf<R> {
    pub(super) fn open(
        mut reader: R,
        context: &FileContext,
        wanted: Option<&str>,
    ) -> Result<(Self, Header), HeightFileError> {
        let mut head = HeaderReader {
            reader: (&mut reader).take(HEADER_BYTES),
            context,
            has_64_bit_offsets: false,
        };
        // The caller has seen the first three.
        let [_, _, _, version] = head.bytes()?;
        head.has_64_bit_offsets = version == 2;
        let _records = head.word()?;
        let mut dimensions = Vec::new();
        for _ in 0..head.list(10)? {
            let name = head.name()?;
            dimensions.push((name, head.word()?));
        }
        let of_file = head.attributes()?;
        let mut variables = Vec::new();
        for _ in 0..head.list(11)? {
            variables.push(head.variable(dimensions.len())?);
        }

        let chosen = select_variable(&variables, wanted, context)?;
        let (lat, lon) = (chosen.dimensions[0], chosen.dimensions[1]);
        let (rows, columns) = (dimensions[lat].1, dimensions[lon].1);
        // A length of 0 is that of records.
        let sides = 1..=MAX_SIDE;
        if !sides.contains(&columns) || !sides.contains(&rows) {
            return Err(context.grid(GridError::Size { columns, rows }));
        }
        let mut axis = |dimension: usize, axis: &Axis| {
            let (name, count) = &dimensions[dimension];
            let of_name = |v: &&Variable| v.name == *name && v.dimensions == [dimension];
            let variable = variables.iter().find(of_name);
            variable
                .map(|variable| axis.read(&mut reader, variable, *count, context))
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
            None => None,
            Some(word) => Some(HeightUnit::from_word(word).ok_or_else(|| {
                context.rejected(
                    format!("has heights of the unit {word:?}"),
                    "metres or feet",
                    format!(
                        "`ncatted -a units,{},d,, {}` and a unit in a sidecar",
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
            scale: number(&chosen.attributes, "scale_factor"),
            offset: number(&chosen.attributes, "add_offset"),
            above: None,
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
        let (kind, begin) = (chosen.kind, chosen.begin);
        let is_unsigned = chosen.is_unsigned();
        let file = Self {
            reader,
            columns: columns as usize,
            rows: rows as usize,
            kind,
            is_unsigned,
            begin,
        };
        Ok((file, header))
    }

    /// Bytes that reading holds at most: a row as it is stored and as metres.
    pub fn working_bytes(&self) -> u64 {
        self.columns as u64 * (self.kind.bytes() as u64 + 4)
    }

    /// Hands over all rows.
    pub fn read<E: From<HeightFileError>>(
        &mut self,
        context: &FileContext,
        conversion: &Conversion,
        put: &mut impl FnMut(usize, usize, &mut [f32]) -> Result<(), E>,
    ) -> Result<(), E> {
        let start = self.reader.seek(SeekFrom::Start(self.begin));
        start.map_err(|error| context.reading(error))?;
        let bytes = self.kind.bytes();
        let mut row = vec![0; self.columns * bytes];
        let mut heights_m = vec![0.0; self.columns];
        for number in 0..self.rows {
            let read = self.reader.read_exact(&mut row);
            read.map_err(|error| context.reading(error))?;
            for (height_m, value) in heights_m.iter_mut().zip(row.chunks_exact(bytes)) {
                let stored = self.kind.number(value);
                let stored = stored.map(|stored| match self.is_unsigned {
                    true => self.kind.unsigned(stored),
                    false => stored,
                });
                *height_m = stored.map_or(f32::NAN, |stored| conversion.metres(stored));
            }
            put(number, 0, &mut heights_m)?;
        }
        Ok(())
    }
}

/// The variable of heights: the one that is named, or the only one of two dimensions.
fn select_variable<'a>(
    variables: &'a [Variable],
    wanted: Option<&str>,
    context: &FileContext,
) -> Result<&'a Variable, HeightFileError> {
    let is_grid = |v: &&Variable| v.dimensions.len() == 2 && v.kind != NumberType::Char;
    let mut grids = variables.iter().filter(is_grid);
    let names = || {
        let names: Vec<_> = variables
            .iter()
            .filter(is_grid)
            .map(|v| v.name.as_str())
            .collect();
        printable(&names.join(", "))
    };
    let write = "write variable = \"NAME\" in the sidecar";
    match (wanted, grids.next(), grids.next()) {
        (Some(wanted), ..) => variables
            .iter()
            .filter(is_grid)
            .find(|v| v.name == wanted)
            .ok_or_else(|| {
                context.rejected(
                    format!("has no variable {wanted:?} over two dimensions"),
                    format!("one of: {}", names()),
                    write,
                )
            }),
        (None, Some(only), None) => Ok(only),
        (None, Some(_), Some(_)) => Err(context.rejected(
            "has several variables over two dimensions",
            format!("one of: {}", names()),
            write,
        )),
        (None, None, _) => Err(context.rejected(
            "has no variable over two dimensions",
            "heights over latitude and longitude",
            "take one time or level out of it (`ncks -d time,0`, then `ncwa -a time`)",
        )),
    }
}

/// What an axis is called.
struct Axis {
    name: &'static str,
    units: [&'static str; 3],
}

const LATITUDE: Axis = Axis {
    name: "lat",
    units: ["degrees_north", "degree_north", "degrees_n"],
};
const LONGITUDE: Axis = Axis {
    name: "lon",
    units: ["degrees_east", "degree_east", "degrees_e"],
};

impl Axis {
    /// First coordinate and step, degrees.
    fn read<R: BufRead + Seek>(
        &self,
        reader: &mut R,
        variable: &Variable,
        count: u32,
        context: &FileContext,
    ) -> Result<(f64, f64), HeightFileError> {
        let name = &variable.name;
        let is_named = name.to_ascii_lowercase().starts_with(self.name);
        let has_unit = text(&variable.attributes, "units").map(|unit| {
            self.units
                .contains(&unit.trim().to_ascii_lowercase().as_str())
        });
        if !has_unit.unwrap_or(is_named) {
            return Err(context.other_coordinates(format!("the coordinates {name:?}")));
        }
        let bytes = variable.kind.bytes();
        let start = reader.seek(SeekFrom::Start(variable.begin));
        start.map_err(|error| context.reading(error))?;
        // At most 8 × `MAX_SIDE`.
        let mut values = vec![0; count as usize * bytes];
        let read = reader.read_exact(&mut values);
        read.map_err(|error| context.reading(error))?;
        let mut degrees: Vec<f64> = values
            .chunks_exact(bytes)
            .map(|value| variable.kind.number(value).unwrap_or(f64::NAN))
            .collect();
        if self.name == "lon" {
            // 179, −180 is a step to the east.
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
