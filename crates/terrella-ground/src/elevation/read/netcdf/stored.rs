//! Location of a variable's values, and reading them row by row.

use super::hdf5::layout::{Layout, Place};
use crate::elevation::read::HeightFileError;
use crate::elevation::read::error::FileContext;
use std::io::{BufRead, Seek, SeekFrom};

/// Size of a variable of one or two dimensions, after other dimensions of length 1.
pub(super) struct Shape {
    /// 1 for one dimension.
    pub rows: usize,
    pub columns: usize,
    /// Bytes per value.
    pub bytes: usize,
}

/// Location of a variable's values.
pub(super) enum Values {
    /// Contiguous big-endian rows from this byte on.
    Plain {
        begin: u64,
    },
    Hdf5(Box<Layout>),
}

impl Values {
    /// Resolves what reading needs, such as the location of the chunks.
    pub(super) fn found<R: BufRead + Seek>(
        &self,
        reader: &mut R,
        shape: &Shape,
        context: &FileContext,
    ) -> Result<Found, HeightFileError> {
        match self {
            Self::Plain { begin } => Ok(Found {
                place: Place::Rows { begin: *begin },
                is_little: false,
            }),
            Self::Hdf5(layout) => {
                let place = layout.place(reader, (shape.rows, shape.columns), shape.bytes);
                Ok(Found {
                    place: place.map_err(|fault| fault.of_file(context))?,
                    is_little: layout.is_little,
                })
            }
        }
    }
}

/// Values with a resolved location.
pub(super) struct Found {
    place: Place,
    /// Whether values are little-endian.
    is_little: bool,
}

impl Found {
    /// Rows of a chunk.
    pub(super) fn chunk_rows(&self) -> usize {
        match &self.place {
            Place::Chunks(chunks) => chunks.chunk.0,
            Place::Rows { .. } | Place::Held(_) | Place::Fill(_) => 1,
        }
    }

    /// Peak memory of reading, bytes.
    pub(super) fn working_bytes(&self, shape: &Shape) -> u64 {
        let row = (shape.columns * shape.bytes) as u64;
        match &self.place {
            Place::Rows { .. } | Place::Fill(_) => row,
            Place::Held(bytes) => row + bytes.len() as u64,
            Place::Chunks(chunks) => row + chunks.working_bytes(),
        }
    }

    /// Passes on all values once, in stretches of a row: row, first column, and big-endian values.
    pub(super) fn read<R: BufRead + Seek, E: From<HeightFileError>>(
        &self,
        reader: &mut R,
        shape: &Shape,
        context: &FileContext,
        put: &mut impl FnMut(usize, usize, &[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut row = vec![0; shape.columns * shape.bytes];
        let mut put = |number: usize, column: usize, values: &mut [u8]| {
            if self.is_little {
                turn_round(values, shape.bytes);
            }
            put(number, column, values)
        };
        match &self.place {
            Place::Rows { begin } => {
                let start = reader.seek(SeekFrom::Start(*begin));
                start.map_err(|error| context.reading(error))?;
                for number in 0..shape.rows {
                    let read = reader.read_exact(&mut row);
                    read.map_err(|error| context.reading(error))?;
                    put(number, 0, &mut row)?;
                }
            }
            Place::Held(bytes) => {
                for (number, of_row) in bytes.chunks_exact(row.len()).enumerate() {
                    row.copy_from_slice(of_row);
                    put(number, 0, &mut row)?;
                }
            }
            Place::Fill(fill) => {
                for number in 0..shape.rows {
                    row.chunks_exact_mut(shape.bytes)
                        .for_each(|value| value.copy_from_slice(fill));
                    put(number, 0, &mut row)?;
                }
            }
            Place::Chunks(chunks) => {
                for number in 0..chunks.count() {
                    let chunk = chunks.chunk(reader, number);
                    let mut chunk = chunk.map_err(|fault| fault.of_file(context))?;
                    let (first_row, first_column) = chunks.first(number);
                    let rows = chunks.chunk.0.min(shape.rows - first_row);
                    let columns = chunks.chunk.1.min(shape.columns - first_column);
                    let stride = chunks.chunk.1 * shape.bytes;
                    for (n, of_row) in chunk.chunks_exact_mut(stride).take(rows).enumerate() {
                        let values = &mut of_row[..columns * shape.bytes];
                        put(first_row + n, first_column, values)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Reverses the bytes of each value.
fn turn_round(values: &mut [u8], bytes: usize) {
    match bytes {
        2 => values
            .chunks_exact_mut(2)
            .for_each(|value| value.swap(0, 1)),
        4 => values.chunks_exact_mut(4).for_each(<[u8]>::reverse),
        _ => values.chunks_exact_mut(bytes).for_each(<[u8]>::reverse),
    }
}
